//! What all pictures of a plan show: speed and torque of every joint over time, against the limits in force.

use takt_client::v1;

use super::words::Units;

/// The curves of a plan.
#[derive(Debug, Clone, Default)]
pub(crate) struct Curves {
    pub(crate) time: Vec<f64>,
    pub(crate) joints: Vec<JointCurves>,
}

/// The curves of one joint.
#[derive(Debug, Clone)]
pub(crate) struct JointCurves {
    pub(crate) joint: String,
    pub(crate) velocity: Curve,
    pub(crate) torque: Curve,
    /// End of the acceleration and beginning of the deceleration, s; `None` where the joint does not move.
    pub(crate) switches: Option<(f64, f64)>,
}

/// One curve with its limit.
#[derive(Debug, Clone)]
pub(crate) struct Curve {
    pub(crate) name: &'static str,
    pub(crate) unit: &'static str,
    pub(crate) values: Vec<f64>,
    /// Either way; `None` where it is unknown.
    pub(crate) limit: Option<f64>,
}

impl Curve {
    /// The value of largest magnitude, and its index.
    pub(crate) fn peak(&self) -> Option<(usize, f64)> {
        let values = self
            .values
            .iter()
            .copied()
            .enumerate()
            .filter(|(_, value)| value.is_finite());
        values.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()).then(b.0.cmp(&a.0)))
    }

    /// The limits on the sides where the curve goes; both where it stays at zero.
    pub(crate) fn limits_in_sight(&self) -> Vec<f64> {
        let Some(limit) = self.limit else {
            return Vec::new();
        };
        // Less than this part of the limit is noise around zero, not a direction.
        let noise = 1e-3 * limit;
        let goes_up = self.values.iter().any(|value| *value > noise);
        let goes_down = self.values.iter().any(|value| *value < -noise);
        let mut list = Vec::new();
        if goes_up || !goes_down {
            list.push(limit);
        }
        if goes_down || !goes_up {
            list.push(-limit);
        }
        list
    }

    /// How much of the limit the peak uses, for a title.
    pub(crate) fn use_of_limit(&self) -> Option<f64> {
        let (_, peak) = self.peak()?;
        self.limit.filter(|limit| *limit > 0.0).map(|limit| peak.abs() / limit)
    }
}

impl Curves {
    /// The curves of a plan; `None` where it came without samples.
    pub(crate) fn of(
        plan: &v1::MovePlan,
        robot: &v1::Robot,
        tightened: &[v1::LimitOverride],
        units: Units,
    ) -> Option<Self> {
        let parts = Parts {
            margins: &plan.torque_margins,
            patterns: &plan.patterns,
            speed_scale: plan.speed_scale,
            robot,
            tightened,
            units,
        };
        Some(parts.curves(plan.setpoints.as_ref()?))
    }

    /// The curves of a path; `None` where it came without samples. Limits are those of the whole path.
    pub(crate) fn of_path(
        plan: &v1::PathPlan,
        robot: &v1::Robot,
        tightened: &[v1::LimitOverride],
        units: Units,
    ) -> Option<Self> {
        let parts = Parts {
            margins: &plan.torque_margins,
            patterns: &[],
            speed_scale: plan.speed_scale,
            robot,
            tightened,
            units,
        };
        Some(parts.curves(plan.setpoints.as_ref()?))
    }
}

/// What stands beside the samples.
struct Parts<'a> {
    margins: &'a [v1::TorqueMargin],
    patterns: &'a [v1::Pattern],
    speed_scale: f64,
    robot: &'a v1::Robot,
    tightened: &'a [v1::LimitOverride],
    units: Units,
}

impl Parts<'_> {
    fn curves(&self, setpoints: &v1::Setpoints) -> Curves {
        let joints = setpoints.joints.iter().map(|columns| {
            let name = &columns.joint;
            let unit = self.units.of(self.robot, name);
            let model = self.robot.joints.iter().find(|joint| joint.name == *name);
            let own = self.tightened.iter().find(|limit| limit.joint == *name);
            let speed = own
                .and_then(|limit| limit.velocity)
                .or_else(|| model?.limits.as_ref()?.velocity)
                .map(|speed| speed * self.speed_scale * unit.factor);
            let margin = self.margins.iter().find(|margin| margin.joint == *name);
            let pattern = self.patterns.iter().find(|pattern| pattern.joint == *name);
            JointCurves {
                joint: name.clone(),
                velocity: Curve {
                    name: "velocity",
                    unit: unit.velocity,
                    values: columns.velocity.iter().map(|value| value * unit.factor).collect(),
                    limit: speed,
                },
                torque: Curve {
                    name: "torque",
                    unit: unit.torque,
                    values: columns.torque.clone(),
                    limit: margin.map(|margin| margin.limit),
                },
                switches: pattern.filter(|pattern| pattern.displacement != 0.0).map(|pattern| {
                    (
                        pattern.acceleration_time_s,
                        pattern.acceleration_time_s + pattern.cruise_time_s,
                    )
                }),
            }
        });
        Curves {
            joints: joints.collect(),
            time: setpoints.time_s.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::example;

    #[test]
    fn limits_in_force_stand_beside_the_curves() {
        let mut plan = example::plan();
        plan.speed_scale = 0.5;
        let tightened = [v1::LimitOverride {
            joint: "slide".to_owned(),
            velocity: Some(0.6),
            ..Default::default()
        }];
        let curves = Curves::of(&plan, &example::robot(), &tightened, Units::default()).unwrap();
        assert_eq!(curves.joints[0].velocity.limit, Some(1.0));
        assert_eq!(curves.joints[1].velocity.limit, Some(0.3));
        assert_eq!(curves.joints[0].torque.limit, Some(100.0));
        assert_eq!(curves.joints[0].velocity.limits_in_sight(), [1.0]);
        assert_eq!(curves.joints[1].velocity.limits_in_sight(), [-0.3]);
        assert_eq!(curves.joints[0].torque.peak(), Some((0, 97.5)));
        plan.setpoints = None;
        assert!(Curves::of(&plan, &example::robot(), &[], Units::default()).is_none());
    }
}
