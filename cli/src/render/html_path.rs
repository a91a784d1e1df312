//! A timed path as one HTML file: key figures, where the time goes, margins, curves, and what it was computed from.

use takt_client::v1;

use super::{
    curves::Curves,
    html::{begin, card, end, facts, margins, table},
    path,
    svg::escape,
    table::number,
};

/// The report on a path; `request` is what was asked, as JSON.
pub(crate) fn render(
    plan: &v1::PathPlan,
    provenance: &v1::Provenance,
    robot: &v1::Robot,
    curves: &Curves,
    request: &str,
) -> String {
    let title = format!("{}: a program in {:.3} s", robot.robot_id, plan.duration_s);
    let mut out = begin(&title, provenance);
    cards(&mut out, plan);
    facts(&mut out, &path::facts(plan), &plan.warnings);
    segments(&mut out, plan);
    limits(&mut out, plan);
    margins(&mut out, &plan.torque_margins, robot);
    end(&mut out, curves, request);
    out
}

fn cards(out: &mut String, plan: &v1::PathPlan) {
    out.push_str("<div class=\"cards\">\n");
    card(out, &format!("{:.3} s", plan.duration_s), "duration");
    card(out, &plan.segments.len().to_string(), "segments");
    if let Some(cost) = plan.limit_costs.first() {
        let name = format!("of the time at one limit: {}", path::limit(cost.kind(), &cost.joint));
        card(out, &format!("{:.0} %", 100.0 * cost.time_s / plan.duration_s), &name);
    }
    if let Some(tightest) = plan.torque_margins.iter().min_by(|a, b| a.margin.total_cmp(&b.margin)) {
        let name = format!("smallest torque margin: {} at {:.3} s", tightest.joint, tightest.time_s);
        card(out, &format!("{:.1} %", 100.0 * tightest.margin), &name);
    }
    out.push_str("</div>\n");
}

fn segments(out: &mut String, plan: &v1::PathPlan) {
    out.push_str("<section>\n<h2>Segments</h2>\n");
    let head = ["segment", "from", "to", "takes", "tool's way"];
    let rows = plan.segments.iter().enumerate().map(|(index, segment)| {
        [
            index.to_string(),
            format!("{:.3} s", segment.begin_s),
            format!("{:.3} s", segment.end_s),
            format!("{:.3} s", segment.end_s - segment.begin_s),
            format!("{:.4} m", segment.tool_length_m),
        ]
    });
    table(out, head, rows);
    out.push_str("</section>\n");
}

fn limits(out: &mut String, plan: &v1::PathPlan) {
    out.push_str("<section>\n<h2>The tightest moment of every limit</h2>\n");
    let head = ["limit", "peak", "allowed", "margin", "at", "segment", "part of it"];
    let rows = plan.limit_uses.iter().map(|one| {
        let place = one.location.unwrap_or_default();
        [
            escape(&path::limit(one.kind(), &one.joint)),
            number(one.value, 5),
            number(one.limit, 5),
            format!("{:.1} %", 100.0 * one.margin),
            format!("{:.3} s", one.time_s),
            place.segment.to_string(),
            format!("{:.1} %", 100.0 * place.fraction),
        ]
    });
    table(out, head, rows);
    out.push_str("</section>\n");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::{example, words::Units};

    #[test]
    fn the_report_is_whole() {
        let (plan, robot) = (example::path(), example::robot());
        let curves = Curves::of_path(&plan, &robot, &v1::PlanPathRequest::default(), Units::default()).unwrap();
        let html = render(&plan, &example::provenance(), &robot, &curves, "{}");
        assert!(html.starts_with("<!doctype html>") && html.ends_with("</html>\n"));
        assert_eq!((html.matches("<svg ").count(), html.matches("<script").count()), (1, 0));
        for part in ["60 %", "Segments", "speed of the tool", "Torque margins"] {
            assert!(html.contains(part), "{part:?} is not in the report");
        }
        for tag in ["section", "table", "tr", "td", "th", "dl", "div", "span"] {
            let open = html.matches(&format!("<{tag}>")).count() + html.matches(&format!("<{tag} ")).count();
            assert_eq!(open, html.matches(&format!("</{tag}>")).count(), "{tag}");
        }
    }
}
