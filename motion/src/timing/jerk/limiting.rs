//! Which limit is the tightest on each interval of a profile.

use super::certificate::Certificate;
use super::uses::Rates;
use crate::path::outcome::PathLimit;
use crate::timing::limiting::Limiting;

/// The point of a cell that speaks for it: next to its middle.
const MIDDLE: usize = 4;

impl Certificate<'_> {
    /// The tightest limit in the middle of each interval, of the profile that was measured last.
    pub(crate) fn limiting(&self) -> Vec<Limiting> {
        let intervals = self.rates.iter().enumerate();
        intervals
            .map(|(interval, rates)| self.tightest(interval, rates))
            .collect()
    }

    fn tightest(&self, cell: usize, rates: &Rates) -> Limiting {
        let at = &self.at;
        let place = Self::place(cell, MIDDLE);
        let stretch = &self.limits.stretches[at.stretch[place]];
        let [velocity, square, acceleration, jerk] =
            [&rates.velocity, &rates.square, &rates.acceleration, &rates.jerk].map(|column| column[MIDDLE]);
        let mut tightest = Limiting::default();
        let mut add = |kind, joint, value: f64, limit: Option<f64>| {
            let ratio = limit.map_or(0.0, |limit| value.abs() / limit);
            if ratio > tightest.ratio {
                tightest = Limiting { kind, joint, ratio };
            }
        };
        for (joint, limits) in stretch.joints.iter().enumerate() {
            let entry = joint * at.stride + place;
            let [q1, q2, q3] = [&at.terms.first, &at.terms.second, &at.third].map(|column| column[entry]);
            let (of, terms) = (Some(joint), &at.terms);
            add(PathLimit::Velocity, of, q1 * velocity, limits.velocity);
            add(
                PathLimit::Acceleration,
                of,
                q1 * acceleration + q2 * square,
                limits.acceleration,
            );
            let third = q1 * jerk + 3.0 * q2 * velocity * acceleration + q3 * velocity * square;
            add(PathLimit::Jerk, of, third, limits.jerk);
            let smooth = terms.mass[entry] * acceleration
                + terms.velocity[entry] * square
                + at.viscous[entry] * velocity
                + terms.gravity[entry];
            add(PathLimit::Torque, of, smooth + at.coulomb_high[entry], limits.torque);
            add(PathLimit::Torque, of, smooth + at.coulomb_low[entry], limits.torque);
        }
        let length = |v: [f64; 3]| (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
        if stretch.tool_velocity.is_some() || stretch.tool_acceleration.is_some() {
            let (p1, p2) = (at.tool_first(place), at.tool_second(place));
            let bend: [f64; 3] = std::array::from_fn(|axis| p1[axis] * acceleration + p2[axis] * square);
            add(
                PathLimit::ToolVelocity,
                None,
                length(p1) * velocity,
                stretch.tool_velocity,
            );
            add(
                PathLimit::ToolAcceleration,
                None,
                length(bend),
                stretch.tool_acceleration,
            );
        }
        tightest
    }
}
