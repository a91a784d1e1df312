//! The report on a trajectory, for a person at a terminal.

use std::fmt::Write;

use takt_client::v1;

use super::{
    confidence, plan,
    table::{Cell, Table, Tone, aligned, paint},
    words,
};
use crate::io::Terminal;

/// Whether it holds, the tightest limits, the torque margins.
pub(crate) fn report(reply: &v1::CheckTrajectoryResponse, robot: &v1::Robot, terminal: Terminal) -> String {
    let colour = terminal.colour;
    let mut out = String::new();
    let broken = reply.limit_uses.iter().filter(|limit| limit.excess > 0.0).count();
    let verdict = match (reply.holds, broken) {
        (true, _) => paint("holds", Tone::Good, colour) + "  every limit that is known",
        (false, 0) => paint("does not hold", Tone::Bad, colour) + "  limits hold, but not at the confidence",
        (false, 1) => paint("does not hold", Tone::Bad, colour) + "  1 limit is broken",
        (false, count) => paint("does not hold", Tone::Bad, colour) + &format!("  {count} limits are broken"),
    };
    let _ = writeln!(out, "{verdict}");
    let interpolation = match reply.interpolation() {
        v1::Interpolation::Unspecified => "",
        v1::Interpolation::Linear => ", straight lines between the points",
        v1::Interpolation::Cubic => ", cubic between the points",
        v1::Interpolation::Quintic => ", quintic between the points",
    };
    let _ = writeln!(
        out,
        "{}  {:.3} s{interpolation}",
        paint("duration  ", Tone::Bold, colour),
        reply.duration_s
    );
    let is_curve = matches!(
        reply.interpolation(),
        v1::Interpolation::Cubic | v1::Interpolation::Quintic
    );
    if broken > 0 && is_curve {
        let _ = writeln!(
            out,
            "{}  the curve is drawn through the points: where a plan without jerk limits lets the acceleration jump between two of them it overshoots, and \
             the plan itself does not; a shorter period or jerk limits bring both together",
            paint("note      ", Tone::Bold, colour),
        );
    }
    if let Some(report) = &reply.confidence {
        let (name, text, tone) = confidence::fact(report, None);
        let _ = writeln!(
            out,
            "{}  {}",
            paint(name, Tone::Bold, colour),
            paint(&text, tone, colour)
        );
    }
    if let Some(safety) = &reply.override_safe {
        let (text, good) = words::override_safety(safety);
        let tone = if good { Tone::Plain } else { Tone::Bad };
        let _ = writeln!(
            out,
            "{}  {}",
            paint("override  ", Tone::Bold, colour),
            paint(&text, tone, colour)
        );
    }
    let uses = limit_uses(&reply.limit_uses);
    if !uses.is_empty() {
        out.push('\n');
        out.push_str(&uses.render_for(terminal));
    }
    let margins = plan::margins(&reply.torque_margins, robot);
    if !margins.is_empty() {
        out.push('\n');
        out.push_str(&margins.render_for(terminal));
    }
    if let Some(report) = &reply.confidence {
        out.push('\n');
        out.push_str(&confidence::table(report, robot).render_for(terminal));
    }
    out.push_str(&plan::warnings(&reply.warnings, colour));
    out
}

/// How many limits that hold are shown below those that do not.
const SHOWN: usize = 12;

fn limit_uses(uses: &[v1::LimitUse]) -> Table {
    use v1::limit_use::Limit;
    let broken = uses.iter().filter(|limit| limit.excess > 0.0).count();
    let shown = &uses[..uses.len().min(broken + SHOWN)];
    let values = aligned(&shown.iter().map(|limit| Some(limit.value)).collect::<Vec<_>>());
    let limits = aligned(&shown.iter().map(|limit| Some(limit.limit)).collect::<Vec<_>>());
    let mut table = Table::new(["joint", "limit of", "value", "limit", "at [s]", "verdict"]).numbers_from(2);
    for (index, limit) in shown.iter().enumerate() {
        let kind = match limit.limit_kind() {
            Limit::Unspecified => "",
            Limit::Torque => "torque",
            Limit::Velocity => "velocity",
            Limit::Acceleration => "acceleration",
            Limit::Deceleration => "deceleration",
            Limit::PositionLower => "position, lower",
            Limit::PositionUpper => "position, upper",
            Limit::Jerk => "jerk",
        };
        let verdict = if limit.excess > 0.0 {
            Cell::new(format!("{:.1} % over", 100.0 * limit.excess), Tone::Bad)
        } else {
            Cell::from("holds")
        };
        table.row([
            Cell::from(limit.joint.clone()),
            Cell::from(kind),
            Cell::from(values[index].clone()),
            Cell::from(limits[index].clone()),
            Cell::from(format!("{:.3}", limit.time_s)),
            verdict,
        ]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::example;

    #[test]
    fn broken_limits_come_with_how_much_and_when() {
        let reply = v1::CheckTrajectoryResponse {
            holds: false,
            duration_s: 1.0,
            limit_uses: vec![v1::LimitUse {
                limit_kind: v1::limit_use::Limit::Velocity.into(),
                joint: "turn".to_owned(),
                value: 2.2,
                limit: 2.0,
                time_s: 0.5,
                excess: 0.1,
            }],
            ..Default::default()
        };
        let text = report(&reply, &example::robot(), example::PAPER);
        assert!(text.starts_with("does not hold  1 limit is broken"), "{text}");
        assert!(text.contains("10.0 % over") && text.contains("0.500"), "{text}");
    }
}
