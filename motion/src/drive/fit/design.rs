//! The equations of a fit: for every joint the torque that the unknowns must explain, and what each of them adds to it, sample by sample.
//!
//! Friction goes with a state z between −1 and 1 in place of the sign of the speed: on the way x of the joint
//! dz/dx = (1 − z·sgn ẋ)/x_s (P. Dahl, "A solid friction model", 1968, with exponent 1), so over a step Δx in one direction
//! z ← s + (z − s)·exp(−|Δx|/x_s), s = sgn Δx, exactly. x_s is the deflection over which a contact begins to slide; without
//! one z is sgn q̇. Coulomb torque is F₊·max(z, 0) + F₋·min(z, 0), its load-dependent part k·|g(q)|·z.

use super::report::Unknown;
use super::signals::Signals;
use super::unknowns::Unknowns;
use crate::budget::Budget;
use crate::dynamics::regressor::{self, BODY, PER_JOINT, Regressor};
use crate::error::Invalid;
use crate::plan::Failure;
use crate::robot::Robot;
use crate::robot::spec::{Parameter, ParameterKind};
use crate::tolerance::{BUDGET_STRIDE, FIT_ENTRIES_MAX};

/// One joint's equations.
#[derive(Debug, Clone)]
pub(crate) struct Rows {
    /// Which unknowns have a column.
    pub(crate) unknowns: Vec<usize>,
    /// One column an unknown, one value a sample, within the band.
    pub(crate) columns: Vec<Vec<f64>>,
    /// What they must add up to.
    pub(crate) target: Vec<f64>,
    /// Magnitude of the gravity torque, out of the band: for the columns of friction.
    gravity: Vec<f64>,
    /// Which of the columns are positive Coulomb, negative Coulomb and load-dependent Coulomb torque.
    coulomb: Option<[usize; 3]>,
}

/// The equations of all joints.
#[derive(Debug, Clone)]
pub(crate) struct Design {
    pub(crate) rows: Vec<Rows>,
}

/// Whether equations of this size may be set up.
pub(crate) fn check_size(signals: &Signals, unknowns: &Unknowns, joints: usize) -> Result<(), Failure> {
    let entries = signals.time.len() * (unknowns.count() * (joints + 1) / 2 + joints);
    if entries <= FIT_ENTRIES_MAX {
        return Ok(());
    }
    let message = format!(
        "{} samples at {:.4} s with {} unknowns are too many: give a shorter recording or a lower band",
        signals.time.len(),
        signals.period,
        unknowns.count()
    );
    Err(Failure::Invalid(vec![Invalid::new("time", message)]))
}

impl Design {
    /// Sets up the equations, with no deflection before sliding.
    pub(crate) fn new(
        robot: &Robot,
        signals: &Signals,
        unknowns: &Unknowns,
        budget: &Budget<'_>,
    ) -> Result<Self, Failure> {
        let (joint_count, count) = (robot.joint_count(), signals.time.len());
        let mut rows: Vec<Rows> = (0..joint_count).map(|i| Rows::empty(unknowns, i, count)).collect();
        let mut known = vec![vec![0.0; count]; joint_count];
        let fixed = Fixed::new(unknowns);
        let mut regressor = Regressor::new(robot);
        let mut state = [vec![0.0; joint_count], vec![0.0; joint_count], vec![0.0; joint_count]];
        for k in 0..count {
            if k % BUDGET_STRIDE == 0 {
                budget.check()?;
            }
            for (values, series) in state.iter_mut().zip([&signals.q, &signals.qd, &signals.qdd]) {
                for (value, series) in values.iter_mut().zip(series) {
                    *value = series[k];
                }
            }
            regressor.compute(robot, &state[0], &state[1], &state[2]);
            for (i, rows) in rows.iter_mut().enumerate() {
                let (row, payload) = (regressor.row(i), regressor.payload_row(i));
                for (column, unknown) in rows.columns.iter_mut().zip(&rows.unknowns) {
                    column[k] = match unknowns.list[*unknown] {
                        Unknown::Joint(parameter) => row[regressor::column(parameter)],
                        Unknown::Payload(part) => payload[part],
                    };
                }
                rows.gravity[k] = regressor.gravity_torque(i).abs();
                known[i][k] = fixed.torque(row, payload);
            }
        }
        for (i, rows) in rows.iter_mut().enumerate() {
            signals.filter.apply(&mut known[i]);
            rows.target = signals.torque[i].iter().zip(&known[i]).map(|(t, k)| t - k).collect();
            for column in &mut rows.columns {
                budget.check()?;
                signals.filter.apply(column);
            }
        }
        Ok(Self { rows })
    }

    /// Gives a joint's contacts a deflection before they slide.
    pub(crate) fn set_deflection(&mut self, signals: &Signals, joint: usize, deflection: Option<f64>) {
        let rows = &mut self.rows[joint];
        let Some(places) = rows.coulomb else { return };
        let columns = rows.friction(signals, joint, deflection);
        for (place, column) in places.into_iter().zip(columns) {
            rows.columns[place] = column;
        }
    }
}

impl Rows {
    fn empty(unknowns: &Unknowns, joint: usize, count: usize) -> Self {
        let reaches = |unknown: &Unknown| match unknown {
            Unknown::Payload(_) => true,
            Unknown::Joint(parameter) => {
                let is_body = regressor::column(*parameter) % PER_JOINT < BODY;
                parameter.joint == joint || is_body && parameter.joint > joint
            }
        };
        let list: Vec<usize> = (0..unknowns.count()).filter(|k| reaches(&unknowns.list[*k])).collect();
        let place = |kind| {
            list.iter()
                .position(|k| unknowns.list[*k] == Unknown::Joint(Parameter { joint, kind }))
        };
        use ParameterKind as K;
        let coulomb = place(K::CoulombPositive)
            .zip(place(K::CoulombNegative))
            .zip(place(K::LoadCoulomb))
            .map(|((a, b), c)| [a, b, c]);
        Self {
            columns: vec![vec![0.0; count]; list.len()],
            unknowns: list,
            target: vec![0.0; count],
            gravity: vec![0.0; count],
            coulomb,
        }
    }

    /// The three columns of Coulomb torque, within the band.
    pub(crate) fn friction(&self, signals: &Signals, joint: usize, deflection: Option<f64>) -> [Vec<f64>; 3] {
        let state = match deflection {
            Some(deflection) => presliding(&signals.q[joint], deflection),
            None => signals.qd[joint].iter().map(|qd| sign(*qd)).collect(),
        };
        let mut columns = [
            state.iter().map(|z| z.max(0.0)).collect(),
            state.iter().map(|z| z.min(0.0)).collect(),
            state
                .iter()
                .zip(&self.gravity)
                .map(|(z, g)| z * g)
                .collect::<Vec<f64>>(),
        ];
        for column in &mut columns {
            signals.filter.apply(column);
        }
        columns
    }

    /// Torque that a solution leaves unexplained, N m or N, from one sample to another.
    pub(crate) fn residual_of(&self, solution: &[f64], from: usize, to: usize) -> Vec<f64> {
        let mut residual = self.target[from..to].to_vec();
        for (column, unknown) in self.columns.iter().zip(&self.unknowns) {
            let value = solution[*unknown];
            for (residual, x) in residual.iter_mut().zip(&column[from..to]) {
                *residual -= value * x;
            }
        }
        residual
    }

    /// Variance of the torque that a covariance of all unknowns leaves at a sample.
    pub(crate) fn variance(&self, covariance: &[f64], count: usize, sample: usize) -> f64 {
        let mut sum = 0.0;
        for (a, (column, unknown)) in self.columns.iter().zip(&self.unknowns).enumerate() {
            let row = &covariance[unknown * count..(unknown + 1) * count];
            let mut product = 0.5 * row[*unknown] * column[sample];
            for (other, k) in self.columns[..a].iter().zip(&self.unknowns) {
                product += row[*k] * other[sample];
            }
            sum += 2.0 * column[sample] * product;
        }
        sum.max(0.0)
    }
}

/// What the parameters that are not fitted add to a torque.
struct Fixed {
    joints: Vec<f64>,
    payload: [f64; BODY],
}

impl Fixed {
    fn new(unknowns: &Unknowns) -> Self {
        let mut fixed = Self {
            joints: unknowns.joints.clone(),
            payload: unknowns.payload,
        };
        for unknown in &unknowns.list {
            match unknown {
                Unknown::Joint(parameter) => fixed.joints[regressor::column(*parameter)] = 0.0,
                Unknown::Payload(k) => fixed.payload[*k] = 0.0,
            }
        }
        fixed
    }

    fn torque(&self, row: &[f64], payload: &[f64; BODY]) -> f64 {
        let links: f64 = row.iter().zip(&self.joints).map(|(y, p)| y * p).sum();
        let load: f64 = payload.iter().zip(&self.payload).map(|(y, p)| y * p).sum();
        links + load
    }
}

/// The state z along positions.
pub(crate) fn presliding(positions: &[f64], deflection: f64) -> Vec<f64> {
    let mut z = 0.0;
    let mut before = positions.first().copied().unwrap_or(0.0);
    let along = positions.iter().map(|q| {
        let way = q - before;
        before = *q;
        let s = sign(way);
        if s != 0.0 {
            z = s + (z - s) * libm::exp(-way.abs() / deflection);
        }
        z
    });
    along.collect()
}

fn sign(x: f64) -> f64 {
    if x > 0.0 {
        return 1.0;
    }
    if x < 0.0 { -1.0 } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the closed form of Dahl's law after one reversal, whatever the steps.
    #[test]
    fn the_state_follows_dahl_s_law() {
        let deflection = 0.05;
        for steps in [10, 100, 1000] {
            let way = |k: usize| 0.2 * k as f64 / steps as f64;
            let mut positions: Vec<f64> = (0..=steps).map(way).collect();
            positions.extend((0..steps).rev().map(way));
            let z = presliding(&positions, deflection);
            let top = 1.0 - libm::exp(-0.2 / deflection);
            assert!((z[steps] - top).abs() < 1e-12);
            let back = -1.0 + (top + 1.0) * libm::exp(-0.2 / deflection);
            assert!((z[2 * steps] - back).abs() < 1e-12);
        }
    }

    #[test]
    fn at_rest_the_state_stays() {
        let z = presliding(&[0.0, 0.1, 0.1, 0.1, 0.1], 0.01);
        assert_eq!(z[1], z[4]);
        assert!(z[1] > 0.99);
    }
}
