//! Six turning joints whose axes lie so that their inverse kinematics has a closed form.
//!
//! Two families have one (D. L. Pieper, "The kinematics of manipulators under computer control", 1968): three axes in a
//! row that meet in a point, at the end of the chain, and three that are parallel, in its middle. Turning the chain
//! round, base for tool, gives the same families at its other end:
//!
//! ```text
//! e₁(q₁)…e₆(q₆) = E    ⇔    e₆(−q₆)…e₁(−q₁) = E⁻¹
//! ```
//!
//! with eᵢ the turn about axis i, and E the motion from the tool's pose at 0 to its target. Axes count as meeting or as
//! parallel within a tolerance that includes the calibrated kinematics of a real arm: the closed form is then that of
//! the ideal arm, and every answer is a start from which Newton steps lead to the real one's.

use nalgebra::{Matrix3, Vector3};

use super::circle::Direction;
use super::parallel::Parallel;
use super::screws::{Place, Screws, turn_by};
use super::wrist::Wrist;
use crate::tolerance::{IK_GEOMETRY, IK_IDEAL};

/// Joints of an arm with a closed form.
pub(super) const SIX: usize = 6;

/// A line in base-link axes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    pub(super) axis: Vector3<f64>,
    pub(super) point: Vector3<f64>,
}

/// x ↦ rotation·x + translation.
#[derive(Debug, Clone, Copy)]
pub(super) struct Motion {
    pub(super) rotation: Matrix3<f64>,
    pub(super) translation: Vector3<f64>,
}

/// Joint positions, and whether the pose leaves one of them free, or nearly so.
#[derive(Debug, Clone, Copy)]
pub(super) struct Candidate {
    pub(super) q: [f64; SIX],
    pub(super) is_free: bool,
}

/// The closed form of one arm.
#[derive(Debug, Clone)]
pub(super) struct ClosedForm {
    family: Family,
    /// The chain is solved from tool to base.
    is_reversed: bool,
    /// The axes lie as the family asks, but for rounding.
    pub(super) is_ideal: bool,
}

#[derive(Debug, Clone)]
enum Family {
    Wrist(Wrist),
    Parallel(Parallel),
}

impl ClosedForm {
    /// The closed form of a chain, where it has one.
    pub(super) fn new(screws: &Screws) -> Option<Self> {
        let lines: Vec<Line> = screws
            .joints
            .iter()
            .filter(|joint| joint.turns)
            .map(|joint| Line {
                axis: joint.axis,
                point: joint.point,
            })
            .collect();
        let forward: [Line; SIX] = lines.try_into().ok().filter(|_| screws.count() == SIX)?;
        let mut backward = forward.map(|line| Line {
            axis: -line.axis,
            point: line.point,
        });
        backward.reverse();
        for (lines, is_reversed) in [(&forward, false), (&backward, true)] {
            let wrist = Wrist::new(lines, screws.size).map(|(wrist, miss)| (Family::Wrist(wrist), miss));
            let parallel = || Parallel::new(lines, screws.size).map(|(form, miss)| (Family::Parallel(form), miss));
            if let Some((family, miss)) = wrist.or_else(parallel) {
                return Some(Self {
                    family,
                    is_reversed,
                    is_ideal: miss <= IK_IDEAL,
                });
            }
        }
        None
    }

    /// Every branch of the ideal arm. `reference` decides what the pose leaves free.
    pub(super) fn candidates(&self, screws: &Screws, target: &Place, reference: &[f64]) -> Vec<Candidate> {
        let Ok(mut reference) = <[f64; SIX]>::try_from(reference) else {
            return Vec::new();
        };
        let rotation = target.rotation * screws.home_rotation.transpose();
        let mut motion = Motion {
            rotation,
            translation: target.point - rotation * screws.home_point,
        };
        if self.is_reversed {
            motion = motion.inverse();
            reference.reverse();
        }
        let mut candidates = match &self.family {
            Family::Wrist(wrist) => wrist.candidates(&motion, &reference),
            Family::Parallel(parallel) => parallel.candidates(&motion, &reference),
        };
        if self.is_reversed {
            candidates.iter_mut().for_each(|candidate| candidate.q.reverse());
        }
        candidates
    }
}

impl Motion {
    fn inverse(&self) -> Self {
        let rotation = self.rotation.transpose();
        Self {
            rotation,
            translation: -(rotation * self.translation),
        }
    }

    pub(super) fn of(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.rotation * point + self.translation
    }
}

impl Line {
    /// rot(h, θ).
    pub(super) fn turn(&self, (c, s): Direction) -> Matrix3<f64> {
        turn_by(&self.axis, c, s)
    }

    /// Sine of the angle to another line.
    pub(super) fn sine(&self, other: &Self) -> f64 {
        self.axis.cross(&other.axis).norm()
    }

    /// The feet of the common perpendicular, on this line and on the other; of parallel lines the one through this
    /// line's own point.
    pub(super) fn feet(&self, other: &Self) -> (Vector3<f64>, Vector3<f64>) {
        let (h, g, d) = (self.axis, other.axis, other.point - self.point);
        let normal = h.cross(&g);
        let squared = normal.norm_squared();
        if squared <= IK_GEOMETRY * IK_GEOMETRY {
            return (self.point, other.point - g * g.dot(&d));
        }
        let on_self = d.cross(&g).dot(&normal) / squared;
        let on_other = d.cross(&h).dot(&normal) / squared;
        (self.point + h * on_self, other.point + g * on_other)
    }

    /// Distance of a point.
    pub(super) fn distance(&self, point: &Vector3<f64>) -> f64 {
        self.axis.cross(&(point - self.point)).norm()
    }
}

/// θ of (cos θ, sin θ).
pub(super) fn angle((c, s): Direction) -> f64 {
    libm::atan2(s, c)
}
