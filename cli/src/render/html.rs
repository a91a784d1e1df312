//! A plan as one HTML file with nothing outside it: key figures, margins, curves, and what it was computed from.

use std::fmt::Write;

use takt_client::v1;

use super::{
    curves::Curves,
    plan,
    svg::{self, escape},
    table::{Tone, number},
    words::{self, Units},
};

const STYLE: &str = "\
body{font:15px/1.5 system-ui,'Segoe UI','Helvetica Neue',Arial,sans-serif;color:#1d2430;background:#f4f6f8;margin:0}\
main{max-width:1160px;margin:0 auto;padding:28px 20px 48px}h1{font-size:24px;margin:0 0 4px}h2{font-size:17px;margin:0 0 12px}\
section{background:#fff;border:1px solid #dfe3e8;border-radius:8px;padding:18px 20px;margin-top:18px;overflow-x:auto}\
.note{color:#4b5563;margin:0}.cards{display:flex;flex-wrap:wrap;gap:12px;margin-top:18px}\
.card{flex:1 1 200px;background:#fff;border:1px solid #dfe3e8;border-radius:8px;padding:12px 16px}\
.card b{display:block;font-size:24px;line-height:1.3}.card span{color:#4b5563;font-size:13px}\
table{border-collapse:collapse;width:100%;font-variant-numeric:tabular-nums;font-size:14px}th,td{padding:6px 9px;text-align:right;\
border-bottom:1px solid #e7eaee;white-space:nowrap}th:first-child,td:first-child{text-align:left}\
th{color:#4b5563;font-weight:600;font-size:13px}.bar{display:inline-block;width:90px;height:10px;background:#e7eaee;\
border-radius:5px;vertical-align:middle;overflow:hidden}.bar i{display:block;height:100%;background:#0072b2}\
.bar.over i{background:#d55e00}.bad{color:#b34700;font-weight:600}svg{max-width:100%;height:auto}\
dl{display:grid;grid-template-columns:max-content 1fr;gap:4px 18px;margin:0}dt{color:#4b5563}dd{margin:0}\
pre{margin:8px 0 0;white-space:pre-wrap;overflow-wrap:anywhere;font-size:13px}summary{cursor:pointer}\
@media print{body{background:#fff}section,.card{break-inside:avoid}}";

/// The report on a plan; `request` is what was asked, as JSON.
pub(crate) fn render(
    plan: &v1::MovePlan,
    provenance: &v1::Provenance,
    robot: &v1::Robot,
    curves: &Curves,
    units: Units,
    request: &str,
) -> String {
    let title = format!("{}: a move in {:.3} s", robot.robot_id, plan.duration_s);
    let mut out = begin(&title, provenance);
    cards(&mut out, plan);
    facts(&mut out, &plan::facts(plan), &plan.warnings);
    margins(&mut out, &plan.torque_margins, robot);
    motion(&mut out, plan, robot, units);
    end(&mut out, curves, request);
    out
}

/// The head of a report.
pub(super) fn begin(title: &str, provenance: &v1::Provenance) -> String {
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n<title>{0}</title>\n\
         <style>{STYLE}</style>\n</head>\n<body>\n<main>\n<h1>{0}</h1>\n\
         <p class=\"note\">revision {1}, takt {2}, request {3}</p>\n",
        escape(title),
        escape(&provenance.revision),
        escape(&provenance.version),
        escape(&provenance.request_hash)
    )
}

/// The curves, and what was asked.
pub(super) fn end(out: &mut String, curves: &Curves, request: &str) {
    out.push_str("<section>\n<h2>Speed and torque</h2>\n");
    out.push_str(&svg::render(curves, None));
    out.push_str("</section>\n");
    let _ = write!(
        out,
        "<section>\n<details>\n<summary>The request that gives this plan again</summary>\n<pre>{}</pre>\n</details>\n\
         </section>\n</main>\n</body>\n</html>\n",
        escape_block(request)
    );
}

/// As [`escape`], but line breaks stay.
fn escape_block(text: &str) -> String {
    text.lines().map(escape).collect::<Vec<_>>().join("\n")
}

pub(super) fn card(out: &mut String, value: &str, name: &str) {
    let _ = writeln!(
        out,
        "<div class=\"card\"><b>{}</b><span>{}</span></div>",
        escape(value),
        escape(name)
    );
}

fn cards(out: &mut String, plan: &v1::MovePlan) {
    out.push_str("<div class=\"cards\">\n");
    card(out, &format!("{:.3} s", plan.duration_s), "duration");
    if let Some(preset) = plan.preset_duration_s.filter(|preset| *preset > 0.0) {
        let name = format!("against {preset:.3} s by the conventional pattern");
        card(
            out,
            &format!("{:+.1} %", 100.0 * (plan.duration_s / preset - 1.0)),
            &name,
        );
    }
    if let Some(tightest) = plan.torque_margins.iter().min_by(|a, b| a.margin.total_cmp(&b.margin)) {
        let name = format!("smallest torque margin: {} at {:.3} s", tightest.joint, tightest.time_s);
        card(out, &format!("{:.1} %", 100.0 * tightest.margin), &name);
    }
    let mass = plan.payload.as_ref().and_then(|payload| payload.mass_kg).unwrap_or(0.0);
    card(out, &format!("{mass} kg"), "payload");
    out.push_str("</div>\n");
}

/// What is said above the tables, by name.
pub(super) fn facts(out: &mut String, facts: &[(&'static str, String, Tone)], warnings: &[String]) {
    out.push_str("<section>\n<h2>What decides the time</h2>\n<dl>\n");
    for (name, value, _) in facts {
        let _ = writeln!(out, "<dt>{name}</dt><dd>{}</dd>", escape(value));
    }
    for warning in warnings {
        let _ = writeln!(out, "<dt>warning</dt><dd>{}</dd>", escape(warning));
    }
    out.push_str("</dl>\n</section>\n");
}

/// A table; cells are HTML already.
pub(super) fn table<const N: usize>(out: &mut String, head: [&str; N], rows: impl Iterator<Item = [String; N]>) {
    out.push_str("<table>\n<tr>");
    for cell in head {
        let _ = write!(out, "<th>{}</th>", escape(cell));
    }
    out.push_str("</tr>\n");
    for row in rows {
        out.push_str("<tr>");
        for cell in row {
            let _ = write!(out, "<td>{cell}</td>");
        }
        out.push_str("</tr>\n");
    }
    out.push_str("</table>\n");
}

pub(super) fn margins(out: &mut String, margins: &[v1::TorqueMargin], robot: &v1::Robot) {
    if margins.is_empty() {
        return;
    }
    out.push_str("<section>\n<h2>Torque margins</h2>\n");
    let head = [
        "joint",
        "used",
        "margin",
        "peak torque",
        "limit",
        "at",
        "while",
        "RMS",
        "rated",
        "motor speed",
        "power",
    ];
    let rows = margins.iter().map(|margin| {
        let unit = Units::default().of(robot, &margin.joint).torque;
        let used = 100.0 * (1.0 - margin.margin);
        let (over, class) = if margin.margin < 0.0 {
            (" over", " class=\"bad\"")
        } else {
            ("", "")
        };
        [
            escape(&margin.joint),
            format!(
                "<span class=\"bar{over}\"><i style=\"width:{:.0}%\"></i></span>",
                used.clamp(0.0, 100.0)
            ),
            format!("<span{class}>{:.1} %</span>", 100.0 * margin.margin),
            format!("{} {unit}", number(margin.peak_torque, 5)),
            format!("{} {unit}", number(margin.limit, 5)),
            format!("{:.3} s", margin.time_s),
            words::phase(margin.phase()).to_owned(),
            format!("{} {unit}", number(margin.rms_torque, 4)),
            margin
                .rated_torque
                .map_or_else(|| "–".to_owned(), |rated| format!("{} {unit}", number(rated, 4))),
            format!("{} rad/s", number(margin.peak_motor_speed, 4)),
            format!("{} W", number(margin.peak_power_w, 4)),
        ]
    });
    table(out, head, rows);
    out.push_str("</section>\n");
}

fn motion(out: &mut String, plan: &v1::MovePlan, robot: &v1::Robot, units: Units) {
    out.push_str("<section>\n<h2>Velocity patterns</h2>\n");
    let head = [
        "joint",
        "move",
        "peak speed",
        "acceleration",
        "deceleration",
        "speeding up",
        "cruise",
        "slowing down",
    ];
    let rows = plan.patterns.iter().map(|pattern| {
        let unit = units.of(robot, &pattern.joint);
        let show = |value: f64, unit_name: &str| format!("{} {unit_name}", number(unit.factor * value, 4));
        [
            escape(&pattern.joint),
            show(pattern.displacement, unit.position),
            show(pattern.peak_velocity, unit.velocity),
            show(pattern.acceleration, &format!("{}²", unit.velocity)),
            show(pattern.deceleration, &format!("{}²", unit.velocity)),
            format!("{:.3} s", pattern.acceleration_time_s),
            format!("{:.3} s", pattern.cruise_time_s),
            format!("{:.3} s", pattern.deceleration_time_s),
        ]
    });
    table(out, head, rows);
    out.push_str("</section>\n");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::example;

    #[test]
    fn the_report_is_whole_and_self_contained() {
        let (plan, robot) = (example::plan(), example::robot());
        let curves = Curves::of(&plan, &robot, &[], Units::default()).unwrap();
        let html = render(
            &plan,
            &example::provenance(),
            &robot,
            &curves,
            Units::default(),
            "{\n  \"a\": \"</pre><script>\"\n}",
        );
        assert!(html.starts_with("<!doctype html>") && html.ends_with("</html>\n"));
        assert_eq!(html.matches("<svg ").count(), 1);
        assert_eq!(html.matches("<script").count(), 0);
        for outside in ["src=", "href=", "url(", "@import"] {
            assert!(!html.contains(outside), "{outside}");
        }
        for part in [
            "-20.0 %",
            "2.5 %",
            "Torque margins",
            "jerk limits do not apply",
            "&lt;/pre&gt;",
        ] {
            assert!(html.contains(part), "{part:?} is not in the report");
        }
        for tag in ["section", "table", "tr", "td", "th", "dl", "div", "span"] {
            let open = html.matches(&format!("<{tag}>")).count() + html.matches(&format!("<{tag} ")).count();
            assert_eq!(open, html.matches(&format!("</{tag}>")).count(), "{tag}");
        }
    }
}
