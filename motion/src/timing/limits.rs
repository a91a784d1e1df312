//! What bounds the motion along a path: limits of the joints and of the tool, stretch by stretch.

use crate::curve::Side;

/// Limits of one joint in force on a stretch of path, "rad or m"; all positive. `None` does not bound.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct JointLimits {
    /// Largest speed.
    pub(crate) velocity: Option<f64>,
    /// Largest acceleration, speeding up and slowing down.
    pub(crate) acceleration: Option<f64>,
    /// Largest jerk.
    pub(crate) jerk: Option<f64>,
    /// Largest drive torque, N m or N.
    pub(crate) torque: Option<f64>,
}

/// The limits in force up to some place on the path.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Stretch {
    /// Path position where the stretch ends.
    pub(crate) end: f64,
    /// One a joint.
    pub(crate) joints: Vec<JointLimits>,
    /// Largest speed of the tool centre point, m/s.
    pub(crate) tool_velocity: Option<f64>,
    /// Largest acceleration of the tool centre point, m/s².
    pub(crate) tool_acceleration: Option<f64>,
}

/// The limits along a whole path: at least one stretch, in order; the last one holds to the end whatever its `end` says.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Limits {
    pub(crate) stretches: Vec<Stretch>,
}

impl Limits {
    /// The same limits everywhere.
    pub(crate) fn uniform(stretch: Stretch) -> Self {
        Self {
            stretches: vec![stretch],
        }
    }

    /// Which stretch a place belongs to.
    pub(crate) fn stretch_at(&self, s: f64, side: Side) -> usize {
        let within = |stretch: &Stretch| match side {
            Side::Before => stretch.end < s,
            Side::After => stretch.end <= s,
        };
        self.stretches
            .partition_point(within)
            .min(self.stretches.len().saturating_sub(1))
    }

    /// Whether anything bounds the tool anywhere.
    pub(crate) fn bound_the_tool(&self) -> bool {
        self.stretches
            .iter()
            .any(|stretch| stretch.tool_velocity.is_some() || stretch.tool_acceleration.is_some())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_border_belongs_to_the_stretch_of_its_side() {
        let ends = |ends: &[f64]| Limits {
            stretches: ends
                .iter()
                .map(|end| Stretch {
                    end: *end,
                    ..Stretch::default()
                })
                .collect(),
        };
        let limits = ends(&[1.0, 2.0, 3.0]);
        assert_eq!(limits.stretch_at(0.0, Side::After), 0);
        assert_eq!(limits.stretch_at(1.0, Side::Before), 0);
        assert_eq!(limits.stretch_at(1.0, Side::After), 1);
        assert_eq!(limits.stretch_at(1.5, Side::Before), 1);
        assert_eq!(limits.stretch_at(3.0, Side::Before), 2);
        assert_eq!(limits.stretch_at(3.5, Side::After), 2);
        assert_eq!(ends(&[1.0]).stretch_at(7.0, Side::After), 0);
    }
}
