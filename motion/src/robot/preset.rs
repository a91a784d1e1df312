//! The accelerations of the conventional pattern, where a model gives none.
//!
//! They are derived once per revision so that they are safe in nearly every pose: along the vector V of the joints' speed
//! limits, k is the 1st percentile over [`POSES`] low-discrepancy poses of
//!
//! ```text
//! min over joints of (T − |g| − F − k·|g| − c·V − d·V²) / Σ|M|·V
//! ```
//!
//! with friction of Coulomb F, of load k, viscous c and quadratic d, and M the mass matrix, rotors included; poses that cannot be held are left out. Then A = D = k·V.

use super::spec::{JointKind, RobotSpec};
use crate::dynamics::chain::Chain;
use crate::dynamics::composite::{self, Composite};
use crate::dynamics::drive::DriveTerms;
use crate::dynamics::rnea::{LinkWrench, rnea};
use crate::dynamics::solve_symmetric;
use crate::error::Invalid;

/// How many poses are looked at.
const POSES: usize = 4096;

/// Part of the poses in which the derived accelerations may be too large.
const PERCENTILE: f64 = 0.01;

/// Range that stands in for a joint without position limits, rad or m either way.
const UNLIMITED_RANGE: f64 = std::f64::consts::PI;

/// How many poses are tried for a mass matrix that is not singular.
const REGULAR_POSES: usize = 8;

/// Accelerations of the conventional pattern of one joint, positive, in rad/s² or m/s².
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Preset {
    /// At the start.
    pub acceleration: f64,
    /// At the end.
    pub deceleration: f64,
    /// Derived from the torque limits, or taken from the acceleration limits.
    pub derived: bool,
}

/// The presets of every joint, as given or derived.
///
/// # Errors
/// A mass matrix that is singular in every pose looked at.
pub(super) fn derive(
    spec: &RobotSpec,
    chain: &Chain,
    drives: &[DriveTerms],
    warnings: &mut Vec<String>,
) -> Result<Vec<Option<Preset>>, Vec<Invalid>> {
    let mut pose = Pose::new(spec, chain, drives);
    if !(1..=REGULAR_POSES).any(|index| pose.is_regular(index)) {
        let message = "the mass matrix is singular: some joint moves no mass, so no torque belongs to its acceleration; \
                       give the links after it mass and inertia, or its drive a rotor inertia";
        return Err(vec![Invalid::new("", message)]);
    }
    let needed = spec
        .joints
        .iter()
        .any(|joint| joint.limits.preset_acceleration.is_none());
    let mut reserves: Vec<f64> = Vec::new();
    if needed
        && spec
            .joints
            .iter()
            .any(|j| j.drive.peak_torque.is_some() && j.limits.velocity.is_some())
    {
        reserves.extend((1..=POSES).filter_map(|index| pose.reserve(index)));
        reserves.sort_by(f64::total_cmp);
        if reserves.is_empty() {
            warnings.push(
                "no pose that was looked at can be held at full speed: the conventional pattern's accelerations cannot \
                 be derived"
                    .to_owned(),
            );
        }
    }
    let rank = (PERCENTILE * reserves.len() as f64) as usize;
    let k = reserves.get(rank).copied();
    Ok(spec
        .joints
        .iter()
        .map(|joint| {
            let limits = &joint.limits;
            if let Some(acceleration) = limits.preset_acceleration {
                return Some(Preset {
                    acceleration,
                    deceleration: limits.preset_deceleration.unwrap_or(acceleration),
                    derived: false,
                });
            }
            let derived = k.zip(limits.velocity).map(|(k, velocity)| k * velocity);
            let within = |limit: Option<f64>| match (derived, limit) {
                (Some(a), Some(b)) => Some(a.min(b)),
                (a, b) => a.or(b),
            };
            let acceleration = within(limits.acceleration)?;
            Some(Preset {
                acceleration,
                deceleration: limits
                    .preset_deceleration
                    .or_else(|| within(limits.deceleration.or(limits.acceleration)))?,
                derived: true,
            })
        })
        .collect())
}

/// Scratch for looking at one pose after the other.
struct Pose<'a> {
    spec: &'a RobotSpec,
    chain: &'a Chain,
    drives: &'a [DriveTerms],
    steps: Vec<f64>,
    q: Vec<f64>,
    zeros: Vec<f64>,
    gravity: Vec<f64>,
    unused: Vec<f64>,
    links: Vec<LinkWrench<f64>>,
    composites: Vec<Composite>,
    matrix: Vec<f64>,
}

impl<'a> Pose<'a> {
    fn new(spec: &'a RobotSpec, chain: &'a Chain, drives: &'a [DriveTerms]) -> Self {
        let count = drives.len();
        Self {
            spec,
            chain,
            drives,
            steps: additive_recurrence(count),
            q: vec![0.0; count],
            zeros: vec![0.0; count],
            gravity: vec![0.0; count],
            unused: vec![0.0; count],
            links: vec![LinkWrench::zero(0.0); count],
            composites: vec![Composite::zero(); count],
            matrix: vec![0.0; count * count],
        }
    }

    /// Goes to a pose and computes its mass matrix, rotors included.
    fn go_to(&mut self, index: usize) {
        for ((q, joint), step) in self.q.iter_mut().zip(&self.spec.joints).zip(&self.steps) {
            let limited = joint.kind != JointKind::Continuous;
            let limits = &joint.limits;
            let lower = limits.position_lower.filter(|_| limited).unwrap_or(-UNLIMITED_RANGE);
            let upper = limits.position_upper.filter(|_| limited).unwrap_or(UNLIMITED_RANGE);
            let part = (0.5 + step * index as f64).fract();
            *q = lower + (upper - lower) * part;
        }
        composite::mass_matrix(self.chain, &self.q, &mut self.composites, &mut self.matrix);
        let count = self.drives.len();
        for (i, drive) in self.drives.iter().enumerate() {
            self.matrix[i * count + i] += drive.armature;
        }
    }

    fn is_regular(&mut self, index: usize) -> bool {
        self.go_to(index);
        solve_symmetric(&mut self.matrix, &mut self.unused)
    }

    /// Acceleration along the vector of speed limits that every joint's torque still allows, per unit of that vector;
    /// `None` where the pose cannot be held while moving at full speed.
    fn reserve(&mut self, index: usize) -> Option<f64> {
        self.go_to(index);
        rnea::<f64, false>(
            self.chain,
            &self.q,
            &self.zeros,
            &self.zeros,
            &mut self.links,
            &mut self.gravity,
            &mut self.unused,
        );
        let count = self.drives.len();
        let speed = |j: usize| self.spec.joints[j].limits.velocity.unwrap_or(0.0);
        let mut reserve = f64::INFINITY;
        for (i, drive) in self.drives.iter().enumerate() {
            let Some(peak) = self.spec.joints[i].drive.peak_torque else {
                continue;
            };
            let coulomb = drive.coulomb_positive.max(drive.coulomb_negative);
            let gravity = self.gravity[i].abs();
            let left =
                peak - gravity * (1.0 + drive.load_coulomb) - coulomb - drive.viscous * speed(i) - drive.drag(speed(i));
            if left <= 0.0 {
                return None;
            }
            let row = &self.matrix[i * count..(i + 1) * count];
            let needed: f64 = row.iter().enumerate().map(|(j, m)| m.abs() * speed(j)).sum();
            if needed > 0.0 {
                reserve = reserve.min(left / needed);
            }
        }
        reserve.is_finite().then_some(reserve)
    }
}

/// Steps of a low-discrepancy sequence in `dimensions` dimensions: powers of 1/φ, with φ the positive root of
/// φ^(d+1) = φ + 1 (Roberts 2018, the generalised golden ratio).
fn additive_recurrence(dimensions: usize) -> Vec<f64> {
    let exponent = dimensions as f64 + 1.0;
    let phi = (0..64).fold(2.0, |phi: f64, _| libm::pow(1.0 + phi, 1.0 / exponent));
    (1..=dimensions).map(|k| libm::pow(phi, -(k as f64))).collect()
}
