//! The set-points of a plan, once they have the form that they should have.

use takt_motion::path::outcome::{Location, PathPlan, PathSetpoints};
use takt_motion::plan::outcome::JointColumns;

use super::report::{FaultKind, PathReport};
use crate::tolerance;

/// Set-points at even times, all lists as long as each other, all figures numbers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Samples<'a> {
    setpoints: &'a PathSetpoints,
    step: f64,
}

/// Every joint in one state.
#[derive(Debug, Clone, Default)]
pub(super) struct State {
    pub(super) q: Vec<f64>,
    pub(super) qd: Vec<f64>,
    pub(super) qdd: Vec<f64>,
}

impl<'a> Samples<'a> {
    /// The set-points of a plan; what is wrong with their form goes into the report, and then there are none.
    pub(super) fn of(plan: &'a PathPlan, joint_count: usize, report: &mut PathReport) -> Option<Self> {
        let Some(setpoints) = &plan.setpoints else {
            report.fault(FaultKind::Lists, 0, 0.0, 0.0, 1.0);
            return None;
        };
        let times = &setpoints.samples.time;
        let count = times.len();
        let joints = &setpoints.samples.joints;
        let columns = joints.iter().flat_map(columns_of).map(<[f64]>::len);
        let lists = columns.chain([setpoints.locations.len(), setpoints.tool_speed.len()]);
        let odd = lists.into_iter().find(|length| *length != count);
        if joints.len() != joint_count || count < 1 || odd.is_some() {
            report.fault(
                FaultKind::Lists,
                0,
                0.0,
                odd.unwrap_or(joints.len()) as f64,
                count as f64,
            );
            return None;
        }
        let fractions = setpoints.locations.iter().map(|location| &location.fraction);
        let figures = joints.iter().flat_map(columns_of).flatten();
        let all = times
            .iter()
            .chain(&setpoints.tool_speed)
            .chain(fractions)
            .chain(figures);
        if let Some(none) = all.into_iter().find(|figure| !figure.is_finite()) {
            report.fault(FaultKind::Finite, 0, 0.0, *none, 0.0);
            return None;
        }
        let last = times[count - 1];
        let step = if count > 1 { last / (count - 1) as f64 } else { 0.0 };
        let even = |(index, time): (usize, &f64)| (time - step * index as f64).abs() <= tolerance::EVEN_TIMES * last;
        let uneven = times.iter().enumerate().position(|(index, time)| !even((index, time)));
        if uneven.is_some() || (count > 1 && step <= 0.0) {
            let at = uneven.unwrap_or(0);
            report.fault(FaultKind::Times, at, times[at], times[at], step * at as f64);
            return None;
        }
        Some(Self { setpoints, step })
    }

    pub(super) fn len(&self) -> usize {
        self.times().len()
    }

    /// From one set-point to the next, s; 0 where there is one alone.
    pub(super) fn step(&self) -> f64 {
        self.step
    }

    pub(super) fn times(&self) -> &'a [f64] {
        &self.setpoints.samples.time
    }

    pub(super) fn locations(&self) -> &'a [Location] {
        &self.setpoints.locations
    }

    pub(super) fn tool_speed(&self) -> &'a [f64] {
        &self.setpoints.tool_speed
    }

    pub(super) fn joints(&self) -> &'a [JointColumns] {
        &self.setpoints.samples.joints
    }

    /// The state at one set-point.
    pub(super) fn state(&self, index: usize, state: &mut State) {
        let fill = |list: &mut Vec<f64>, column: fn(&JointColumns) -> &Vec<f64>| {
            list.clear();
            list.extend(self.joints().iter().map(|joint| column(joint)[index]));
        };
        fill(&mut state.q, |joint| &joint.position);
        fill(&mut state.qd, |joint| &joint.velocity);
        fill(&mut state.qdd, |joint| &joint.acceleration);
    }

    /// The segments that the set-points from one to another are on, those passed over included.
    pub(super) fn segments(&self, from: usize, to: usize) -> std::ops::RangeInclusive<usize> {
        self.locations()[from].segment..=self.locations()[to].segment
    }
}

fn columns_of(joint: &JointColumns) -> [&[f64]; 4] {
    [&joint.position, &joint.velocity, &joint.acceleration, &joint.torque]
}
