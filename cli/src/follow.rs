//! Whether a rehearsed arm followed its motion: what decides the exit code of `takt rehearse`.
//!
//! Followed is: the run ended as planned, |q − q_d| was never above [`Bounds::FAR`], and at the end it is not above
//! [`Bounds::ARRIVED`]. Motors at their limit alone are not a no: an arm may catch up.

use takt_client::v1::{self, rehearsal_run::End};

use crate::render::{table::number, words::Units};

/// A distance of a joint that turns (rad) and of one that slides (m).
struct Bounds {
    turns: f64,
    slides: f64,
}

impl Bounds {
    /// Largest distance from the plan at any time: 11°, or a hand's width; whatever stands beside the path is hit by then. Friction
    /// one and a half times the model's makes it 1 to 5 mrad (docs/rehearsal.md).
    const FAR: Self = Self {
        turns: 0.2,
        slides: 0.1,
    };

    /// Largest distance from the place at the end: 3°, with a reach of a metre 50 mm, where nothing can be gripped. A light wrist without
    /// adaptation is 20 mrad off after the examples' programs with friction one and a half times the model's; that is no stuck arm.
    const ARRIVED: Self = Self {
        turns: 0.05,
        slides: 0.01,
    };

    fn of(&self, unit: &str) -> f64 {
        match unit {
            "m" => self.slides,
            _ => self.turns,
        }
    }
}

/// What keeps the runs from having followed, a sentence a run and joint; empty where both followed.
pub(crate) fn lost(rehearsal: &v1::Rehearsal, robot: &v1::Robot) -> Vec<String> {
    let runs = [
        (&rehearsal.plain, "the model's friction"),
        (&rehearsal.adapted, "adapted friction"),
    ];
    let mut sentences = Vec::new();
    for (run, label) in runs {
        let Some(run) = run.as_ref().filter(|run| run.end() == End::Completed) else {
            sentences.push(format!("with {label} the simulated arm did not get to the end"));
            continue;
        };
        sentences.extend(
            run.joints
                .iter()
                .filter_map(|joint| of_joint(joint, robot))
                .map(|what| format!("with {label} the simulated arm did not follow: {what}")),
        );
    }
    sentences
}

fn of_joint(run: &v1::JointRun, robot: &v1::Robot) -> Option<String> {
    let unit = Units::default().of(robot, &run.joint).position;
    let (far, arrived) = (Bounds::FAR.of(unit), Bounds::ARRIVED.of(unit));
    let (peak, end) = (run.position_error_peak, run.position_error_end.abs());
    // Written so that what is no number has not followed.
    let off = if !(end <= arrived) {
        format!("{} {unit} off at the end, above {arrived}", number(end, 3))
    } else if !(peak <= far) {
        format!(
            "{} {unit} off at {:.3} s, above {far}",
            number(peak, 3),
            run.position_error_time_s
        )
    } else {
        return None;
    };
    let limited = match run.limited_time_s > 0.0 {
        true => format!("; its motor was at its limit for {:.3} s", run.limited_time_s),
        false => String::new(),
    };
    Some(format!("{} was {off}{limited}", run.joint))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn robot() -> v1::Robot {
        let joint = |name: &str, kind: v1::JointType| v1::JointSummary {
            name: name.to_owned(),
            r#type: kind.into(),
            ..Default::default()
        };
        v1::Robot {
            joints: vec![
                joint("turn", v1::JointType::Revolute),
                joint("slide", v1::JointType::Prismatic),
            ],
            ..Default::default()
        }
    }

    fn run(joint: &str, peak: f64, end: f64) -> Option<String> {
        let run = v1::JointRun {
            joint: joint.to_owned(),
            position_error_peak: peak,
            position_error_end: end,
            ..Default::default()
        };
        of_joint(&run, &robot())
    }

    #[test]
    fn a_joint_has_followed_up_to_the_bounds_of_its_kind() {
        assert_eq!(run("turn", 0.2, -0.05), None);
        assert_eq!(run("slide", 0.1, 0.01), None);
        assert!(run("turn", 0.3, -0.06).unwrap().contains("at the end"));
        assert!(run("turn", 0.21, 0.0).unwrap().contains("above 0.2"));
        assert!(run("slide", 0.02, -0.011).unwrap().contains("0.0110 m off at the end"));
        assert!(run("turn", f64::NAN, 0.0).is_some());
    }

    #[test]
    fn a_run_that_ended_early_has_not_followed() {
        let whole = |end: End| {
            Some(v1::RehearsalRun {
                end: end.into(),
                ..Default::default()
            })
        };
        let rehearsal = |plain, adapted| v1::Rehearsal {
            plain: whole(plain),
            adapted: whole(adapted),
            ..Default::default()
        };
        assert!(lost(&rehearsal(End::Completed, End::Completed), &robot()).is_empty());
        assert_eq!(lost(&rehearsal(End::Diverged, End::Completed), &robot()).len(), 1);
        assert_eq!(lost(&rehearsal(End::Completed, End::TooStiff), &robot()).len(), 1);
    }
}
