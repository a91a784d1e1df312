//! Splines through taught points, in joint space and in tool space.

use nalgebra::{Isometry3, Vector4};

use super::fault::Fault;
use super::request::{Spline, SplineKind};
use super::shape::ToolCurve;
use super::spline::spline;
use super::taught::Teacher;
use super::track::Track;
use crate::budget::Budget;
use crate::tolerance::{BLEND_ANGLE_MAX, PACE_MIN, SEGMENT_MIN, TURN_LENGTH};

impl Teacher<'_> {
    /// A spline of the joints; chords are measured in time at full speed.
    pub(super) fn joint_spline(
        &mut self,
        segment: usize,
        path: &str,
        asked: &Spline,
        budget: &Budget<'_>,
    ) -> Result<Option<Track>, Fault> {
        let mut points = vec![self.q.clone()];
        for target in &asked.points {
            budget.check()?;
            let before = &points[points.len() - 1];
            points.push(self.joints_of(segment, target, before)?);
        }
        let scaled: Vec<Vec<f64>> = points
            .iter()
            .map(|point| point.iter().zip(&self.speeds).map(|(q, speed)| q / speed).collect())
            .collect();
        let Some(distances) = distances(path, asked.kind, &scaled)? else {
            return Ok(None);
        };
        let curve = spline(asked.kind, &points, &distances);
        if let Some(end) = points.pop() {
            self.q = end;
        }
        let track = Track::of_joints(&self.arm, segment, curve, &self.speeds, budget)?;
        self.check_pace(path, &track, budget)?;
        Ok(Some(track))
    }

    /// A spline of the tool; chords are measured in metres, with a turn counted as a length.
    pub(super) fn tool_spline(&self, path: &str, asked: &Spline) -> Result<Option<ToolCurve>, Fault> {
        let mut points = vec![coordinates(&self.pose(), None)];
        for (index, target) in asked.points.iter().enumerate() {
            let before = &points[points.len() - 1];
            let point = coordinates(&self.pose_of(target), Some(before));
            // twice the angle between the quaternions
            let angle = 2.0 * libm::acos(dot(&point[3..], &before[3..]).clamp(-1.0, 1.0));
            if angle > BLEND_ANGLE_MAX {
                let message = format!(
                    "the orientation is {angle:.4} rad from that of the point before, the most is {BLEND_ANGLE_MAX}"
                );
                return Err(Fault::invalid(format!("{path}.points[{index}]"), message));
            }
            points.push(point);
        }
        let scaled: Vec<Vec<f64>> = points
            .iter()
            .map(|point| {
                let turn = point[3..].iter().map(|part| 2.0 * TURN_LENGTH * part);
                point[..3].iter().copied().chain(turn).collect()
            })
            .collect();
        let distances = distances(path, asked.kind, &scaled)?;
        Ok(distances.map(|distances| ToolCurve::Spline(spline(asked.kind, &points, &distances).stretched(1.0))))
    }

    /// A curve that stops or has a cusp cannot be run through.
    pub(super) fn check_pace(&self, path: &str, track: &Track, budget: &Budget<'_>) -> Result<(), Fault> {
        let (pace, part) = track.slowest(&self.arm, &self.speeds, budget)?;
        if pace >= PACE_MIN {
            return Ok(());
        }
        let message = format!(
            "the spline comes to a stop or turns back on itself at {:.2} % of its way; move its points apart, or end a \
             segment there",
            100.0 * part
        );
        Err(Fault::invalid(format!("{path}.points"), message))
    }
}

/// Position, then quaternion w x y z, on the side of the one before.
fn coordinates(pose: &Isometry3<f64>, before: Option<&Vec<f64>>) -> Vec<f64> {
    let q = pose.rotation.quaternion();
    let turn = Vector4::new(q.w, q.i, q.j, q.k);
    let flipped = before.is_some_and(|before| dot(turn.as_slice(), &before[3..]) < 0.0);
    let turn = if flipped { -turn } else { turn };
    pose.translation.vector.iter().chain(turn.iter()).copied().collect()
}

fn dot(one: &[f64], other: &[f64]) -> f64 {
    one.iter().zip(other).map(|(a, b)| a * b).sum()
}

/// Distances between neighbours; `None` where all points are one. Only control points may repeat.
fn distances(path: &str, kind: SplineKind, points: &[Vec<f64>]) -> Result<Option<Vec<f64>>, Fault> {
    let between = |pair: &[Vec<f64>]| {
        let squares = pair[0].iter().zip(&pair[1]).map(|(a, b)| (b - a) * (b - a));
        squares.sum::<f64>().sqrt()
    };
    let distances: Vec<f64> = points.windows(2).map(between).collect();
    if distances.iter().all(|distance| *distance < SEGMENT_MIN) {
        return Ok(None);
    }
    if matches!(kind, SplineKind::BSpline | SplineKind::Bezier) {
        return Ok(Some(distances));
    }
    match distances.iter().position(|distance| *distance < SEGMENT_MIN) {
        None => Ok(Some(distances)),
        Some(index) => {
            let message = "it coincides with the point before; leave one of them out";
            Err(Fault::invalid(format!("{path}.points[{index}]"), message))
        }
    }
}
