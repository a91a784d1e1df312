//! What pictures show: two quantities of every joint over time, against the limits in force where they have some. Of a plan these
//! are speed and torque.

use takt_client::v1;

use super::words::Units;

/// The curves of a plan, or of what became of one.
#[derive(Debug, Clone, Default)]
pub(crate) struct Curves {
    pub(crate) time: Vec<f64>,
    /// Of the tool as a whole, above the joints'.
    pub(crate) tool: Option<Curve>,
    pub(crate) joints: Vec<JointCurves>,
    pub(crate) subject: Subject,
}

/// What the curves are of, for the legend.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) enum Subject {
    #[default]
    Plan,
    /// Coefficients as they come to be known.
    Estimate,
    /// Distance of a rehearsed arm from its plan.
    Rehearsal,
}

impl Subject {
    /// What the line is.
    pub(crate) fn line(self) -> &'static str {
        match self {
            Self::Plan => "plan",
            Self::Estimate => "estimate so far",
            Self::Rehearsal => "distance from the plan",
        }
    }

    /// What the marked point is.
    pub(crate) fn mark(self) -> &'static str {
        match self {
            Self::Plan => "tightest moment",
            Self::Estimate | Self::Rehearsal => "largest value",
        }
    }
}

/// The curves of one joint.
#[derive(Debug, Clone)]
pub(crate) struct JointCurves {
    pub(crate) joint: String,
    pub(crate) left: Curve,
    pub(crate) right: Curve,
    /// End of the acceleration and beginning of the deceleration, s; `None` where the joint does not move.
    pub(crate) switches: Option<(f64, f64)>,
}

/// One curve with its limit.
#[derive(Debug, Clone)]
pub(crate) struct Curve {
    pub(crate) name: &'static str,
    pub(crate) unit: &'static str,
    pub(crate) values: Vec<f64>,
    pub(crate) limit: Limit,
}

/// The limit of a curve, either way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Limit {
    Known(f64),
    /// There may be one; the model does not say.
    Unknown,
    /// Nothing bounds this.
    None,
}

impl Limit {
    pub(crate) fn value(self) -> Option<f64> {
        match self {
            Self::Known(limit) => Some(limit),
            Self::Unknown | Self::None => None,
        }
    }
}

impl From<Option<f64>> for Limit {
    fn from(limit: Option<f64>) -> Self {
        limit.map_or(Self::Unknown, Self::Known)
    }
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
        let Some(limit) = self.limit.value() else {
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
        self.limit
            .value()
            .filter(|limit| *limit > 0.0)
            .map(|limit| peak.abs() / limit)
    }
}

impl Curves {
    /// Whether a limit is drawn anywhere.
    pub(crate) fn have_limits(&self) -> bool {
        let joints = self.joints.iter().flat_map(|joint| [&joint.left, &joint.right]);
        let mut curves = self.tool.iter().chain(joints);
        curves.any(|curve| curve.limit.value().is_some())
    }

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
        request: &v1::PlanPathRequest,
        units: Units,
    ) -> Option<Self> {
        let tightened = request.limits.as_ref().map_or(&[][..], |limits| &limits.joints);
        let parts = Parts {
            margins: &plan.torque_margins,
            patterns: &[],
            speed_scale: plan.speed_scale,
            robot,
            tightened,
            units,
        };
        let setpoints = plan.setpoints.as_ref()?;
        Some(Self {
            tool: Some(Curve {
                name: "speed of the tool",
                unit: "m/s",
                values: setpoints.tool_speed_m_per_s.clone(),
                limit: tool_limit(request),
            }),
            ..parts.curves(setpoints)
        })
    }
}

/// The limit of the tool's speed, where one holds for the whole program.
fn tool_limit(request: &v1::PlanPathRequest) -> Limit {
    let of = |limits: &Option<v1::PathLimits>| limits.as_ref().and_then(|limits| limits.tcp_velocity_m_per_s);
    let whole = of(&request.limits);
    let varies = request.segments.iter().any(|segment| of(&segment.limits).is_some());
    whole.filter(|_| !varies).map_or(Limit::None, Limit::Known)
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
                left: Curve {
                    name: "velocity",
                    unit: unit.velocity,
                    values: columns.velocity.iter().map(|value| value * unit.factor).collect(),
                    limit: speed.into(),
                },
                right: Curve {
                    name: "torque",
                    unit: unit.torque,
                    values: columns.torque.clone(),
                    limit: margin.map(|margin| margin.limit).into(),
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
            tool: None,
            subject: Subject::Plan,
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
        assert_eq!(curves.joints[0].left.limit.value(), Some(1.0));
        assert_eq!(curves.joints[1].left.limit.value(), Some(0.3));
        assert_eq!(curves.joints[0].right.limit.value(), Some(100.0));
        assert_eq!(curves.joints[0].left.limits_in_sight(), [1.0]);
        assert_eq!(curves.joints[1].left.limits_in_sight(), [-0.3]);
        assert_eq!(curves.joints[0].right.peak(), Some((0, 97.5)));
        plan.setpoints = None;
        assert!(Curves::of(&plan, &example::robot(), &[], Units::default()).is_none());
    }

    #[test]
    fn the_tool_has_the_limit_that_holds_for_the_whole_program() {
        let limits = |speed| {
            Some(v1::PathLimits {
                tcp_velocity_m_per_s: Some(speed),
                ..Default::default()
            })
        };
        let mut request = v1::PlanPathRequest {
            limits: limits(1.5),
            ..Default::default()
        };
        let tool = |request: &v1::PlanPathRequest| {
            let curves = Curves::of_path(&example::path(), &example::robot(), request, Units::default());
            curves.unwrap().tool.unwrap()
        };
        assert_eq!(tool(&request).limit, Limit::Known(1.5));
        request.segments = vec![v1::PathSegment {
            limits: limits(0.4),
            ..Default::default()
        }];
        assert_eq!(tool(&request).limit, Limit::None, "none holds for all of it");
    }
}
