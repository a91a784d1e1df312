//! Two segments mixed over their overlap, in joint space or in tool space before inverse kinematics.
//!
//! ```text
//! q = q₁(u₁) + w·(q₂(u₂) − q₁(u₁))        u₁ = L₁ − b + b·x,  u₂ = c·x
//! ```
//!
//! In tool space position and orientation are mixed ([`super::tool`]), and of the joints only those that are led.

use super::arm::Arm;
use super::follow::{Guide, Halt, Seeds, follow};
use super::inverse::Followers;
use super::outcome::Location;
use super::pace::slowest;
use super::passage::Passage;
use super::request::Weight;
use super::tool::ToolPoint;
use super::track::{Joints, Track};
use super::weight::weight;
use crate::budget::{Budget, Stopped};
use crate::curve::Side;
use crate::jet::Jet;
use crate::tolerance::PACE_SAMPLES;

/// A blend of two tracks.
#[derive(Debug)]
pub(super) struct Mix {
    passage: Passage,
    weight: Weight,
    /// In tool space: which joints follow the tool, and their seeds by s from the blend's beginning.
    follow: Option<(Followers, Seeds)>,
}

/// Two tracks and their blend.
#[derive(Debug, Clone, Copy)]
pub(super) struct Corner<'a> {
    pub(super) arm: &'a Arm,
    pub(super) first: &'a Track,
    pub(super) second: &'a Track,
}

impl Corner<'_> {
    /// The largest angle between the orientations of both tracks where they overlap, rad; of samples.
    pub(super) fn largest_angle(&self, passage: &Passage) -> f64 {
        let cosine = |i: usize| {
            let x = i as f64 / PACE_SAMPLES as f64;
            let u1 = self.first.length - passage.before * (1.0 - x);
            let one = self.first.tool(self.arm, Jet::constant(u1), Side::After);
            let other = self
                .second
                .tool(self.arm, Jet::constant(passage.after * x), Side::After);
            one.cosine(&other).abs()
        };
        let least = (0..=PACE_SAMPLES).map(cosine).fold(1.0, f64::min);
        2.0 * libm::acos(least)
    }
}

/// The mixed tool, with the joints that are led.
struct MixedTool<'a> {
    corner: Corner<'a>,
    passage: Passage,
    weight: Weight,
    followers: &'a Followers,
}

impl Guide for MixedTool<'_> {
    fn aim(&self, s: Jet, side: Side, q: &mut Joints) -> ToolPoint {
        let Corner { arm, first, second } = self.corner;
        let (u1, u2, w) = parts(&self.passage, self.weight, first, s.value());
        if self.followers.leads() {
            let (mut one, mut other) = (Joints::default(), Joints::default());
            first.joints(arm, u1, side, &mut one);
            second.joints(arm, u2, side, &mut other);
            for joint in (0..arm.joint_count()).filter(|joint| !self.followers.has(*joint)) {
                q[joint] = one[joint] + w * (other[joint] - one[joint]);
            }
        }
        first.tool(arm, u1, side).mixed(&second.tool(arm, u2, side), w)
    }
}

/// The parameters of both tracks, and the weight, at s from the blend's beginning.
fn parts(passage: &Passage, kind: Weight, first: &Track, s: f64) -> (Jet, Jet, Jet) {
    let x = passage.at(s);
    (
        x * passage.before + (first.length - passage.before),
        x * passage.after,
        x.compose(weight(kind, x.value())),
    )
}

impl Mix {
    pub(super) fn in_joint_space(passage: Passage, weight: Weight) -> Self {
        Self {
            passage,
            weight,
            follow: None,
        }
    }

    /// Follows the mixed tool on the branch of the first track.
    pub(super) fn in_tool_space(
        corner: Corner<'_>,
        passage: Passage,
        weight: Weight,
        followers: Followers,
        budget: &Budget<'_>,
    ) -> Result<Result<Self, Halt>, Stopped> {
        let Corner { arm, first, .. } = corner;
        let guide = MixedTool {
            corner,
            passage,
            weight,
            followers: &followers,
        };
        let mut q = Joints::default();
        first.joints(arm, Jet::constant(first.length - passage.before), Side::After, &mut q);
        let seeds = follow(arm, &guide, &followers, passage.length(), &q, budget)?;
        Ok(seeds.map(|seeds| Self {
            passage,
            weight,
            follow: Some((followers, seeds)),
        }))
    }

    pub(super) fn passage(&self) -> Passage {
        self.passage
    }

    /// Parameter of the first track where the blend begins.
    pub(super) fn first_begin(&self, first: &Track) -> f64 {
        first.length - self.passage.before
    }

    /// The joints at s from the blend's beginning.
    pub(super) fn joints(&self, corner: Corner<'_>, s: f64, side: Side, q: &mut Joints) {
        let Corner { arm, first, second } = corner;
        if let Some((followers, seeds)) = &self.follow {
            let guide = MixedTool {
                corner,
                passage: self.passage,
                weight: self.weight,
                followers,
            };
            seeds.at(s, q);
            let aim = guide.aim(Jet::variable(s, 1.0), side, q);
            followers.solve(arm, &aim, q);
            return;
        }
        let (u1, u2, w) = parts(&self.passage, self.weight, first, s);
        let mut other = Joints::default();
        first.joints(arm, u1, side, q);
        second.joints(arm, u2, side, &mut other);
        for (q, other) in q.iter_mut().zip(&other).take(arm.joint_count()) {
            *q = *q + w * (*other - *q);
        }
    }

    /// The joints where it ends, as they were followed; `None` in joint space.
    pub(super) fn followed_end(&self) -> Option<Vec<f64>> {
        self.follow.as_ref().map(|(_, seeds)| seeds.end())
    }

    /// The slowest that the blend passes anywhere, and where.
    pub(super) fn slowest(
        &self,
        corner: Corner<'_>,
        speeds: &[f64],
        budget: &Budget<'_>,
    ) -> Result<(f64, f64), Stopped> {
        slowest(self.passage.length(), PACE_SAMPLES, speeds, budget, |s, q| {
            self.joints(corner, s, Side::After, q);
        })
    }
}

/// Where on the request's segments a point of a blend is: on the first one up to the middle.
pub(super) fn location(passage: &Passage, first: &Track, second: &Track, s: f64) -> Location {
    let x = passage.at(s).value();
    let (track, u) = if x < 0.5 {
        (first, first.length - passage.before * (1.0 - x))
    } else {
        (second, passage.after * x)
    };
    Location {
        segment: track.segment,
        fraction: (u / track.length).clamp(0.0, 1.0),
    }
}
