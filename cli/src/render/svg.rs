//! Curves as one SVG: the tool's in a row of its own, then a row a joint with two panels, speed and torque, each against its limits.
//!
//! Colours are two of Okabe and Ito's palette, which colour-blind readers tell apart; limits are dashed besides.

use std::fmt::Write;

use super::{
    curves::{Curve, Curves, JointCurves, Limit, Subject},
    scale::{Axis, thinned},
    table::number,
};

/// What stands above the curves; a picture inside a report needs nothing.
#[derive(Debug, Clone, Default)]
pub(crate) struct Heading {
    pub(crate) title: String,
    pub(crate) lines: Vec<String>,
}

const WIDTH: f64 = 1120.0;
const PANEL_WIDTH: f64 = 424.0;
const PANEL_HEIGHT: f64 = 132.0;
const PANELS_LEFT: [f64; 2] = [68.0, 622.0];
/// The one panel of a row that has no second: up to where the second would end.
const WIDE_PANEL: f64 = PANELS_LEFT[1] + PANEL_WIDTH - PANELS_LEFT[0];
/// Characters of a title and of a line below it that fit the width in the widest font of the style.
const TITLE_CHARACTERS: usize = 90;
const LINE_CHARACTERS: usize = 150;
/// Height of a joint's row: its name, the titles, the panel, the tick labels.
const ROW: f64 = 214.0;
const NAME_ABOVE: f64 = 30.0;

const STYLE: &str = "\
text{font-family:system-ui,'Segoe UI','Helvetica Neue',Arial,'DejaVu Sans',sans-serif;fill:#1d2430;font-size:12px}\
.title{font-size:20px;font-weight:600}.sub{fill:#4b5563;font-size:13px}.joint{font-size:15px;font-weight:600}\
.tick{font-size:11px;fill:#4b5563}.right{text-anchor:end}.mid{text-anchor:middle}\
.panel{fill:#fff;stroke:#c4cad3}.grid{stroke:#e7eaee;stroke-width:1}.zero{stroke:#9aa3af;stroke-width:1}\
.phase{fill:#1d2430;fill-opacity:.045}.rule{stroke:#e7eaee}\
.curve{fill:none;stroke:#0072b2;stroke-width:2;stroke-linejoin:round;stroke-linecap:round}\
.limit{stroke:#d55e00;stroke-width:1.6;stroke-dasharray:7 4}.limit-text{fill:#b34700;font-size:11px}\
.peak{fill:#fff;stroke:#0072b2;stroke-width:2}.peak-text{fill:#00527f;font-size:11px;font-weight:600;paint-order:stroke;\
stroke:#fff;stroke-width:3px;stroke-linejoin:round}";

/// The picture: a document of its own where it has a heading, else a part of one.
pub(crate) fn render(curves: &Curves, heading: Option<&Heading>) -> String {
    let title = heading.map_or("speed and torque of every joint", |heading| heading.title.as_str());
    let above = heading.map_or_else(Vec::new, |heading| {
        let titles = wrapped(&heading.title, TITLE_CHARACTERS)
            .into_iter()
            .map(|line| ("title", line));
        let lines = heading.lines.iter().flat_map(|line| wrapped(line, LINE_CHARACTERS));
        titles.chain(lines.map(|line| ("sub", line))).collect()
    });
    #[allow(clippy::cast_precision_loss, reason = "a few lines and joints")]
    let (lines, rows) = (
        above.len() as f64,
        (curves.joints.len() + usize::from(curves.tool.is_some())) as f64,
    );
    let legend_at = if above.is_empty() { 18.0 } else { 43.0 + 19.0 * lines };
    let top = legend_at + 20.0;
    let height = top + ROW * rows + 26.0;
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height}\" width=\"{WIDTH}\" \
         height=\"{height}\" role=\"img\">\n<title>{}</title>\n<style>{STYLE}</style>\n\
         <rect width=\"{WIDTH}\" height=\"{height}\" fill=\"#fff\"/>\n",
        escape(title)
    );
    for ((class, line), row) in above.iter().zip(0_u32..) {
        text(&mut out, 20.0, 36.0 + 19.0 * f64::from(row), class, line);
    }
    legend(&mut out, legend_at, curves);
    let mut y = top;
    if let Some(tool) = &curves.tool {
        name(&mut out, "tool", y);
        let frame = Frame::at(PANELS_LEFT[0], WIDE_PANEL, y);
        panel(&mut out, &curves.time, tool, None, frame, upright(&[tool]));
        y += ROW;
    }
    for joint in &curves.joints {
        row(&mut out, curves, joint, y);
        y += ROW;
    }
    for left in PANELS_LEFT {
        text(&mut out, left + PANEL_WIDTH / 2.0, y + 8.0, "sub mid", "time [s]");
    }
    out.push_str("</svg>\n");
    out
}

/// What a text needs to stand in XML; characters that XML has no form for are left out.
pub(crate) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\n' | '\t' => out.push(' '),
            character if character.is_control() => {}
            character => out.push(character),
        }
    }
    out
}

fn text(out: &mut String, x: f64, y: f64, class: &str, content: &str) {
    let _ = writeln!(
        out,
        "<text x=\"{x:.1}\" y=\"{y:.1}\" class=\"{class}\">{}</text>",
        escape(content)
    );
}

fn line(out: &mut String, class: &str, [x1, y1, x2, y2]: [f64; 4]) {
    let _ = writeln!(
        out,
        "<line class=\"{class}\" x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\"/>"
    );
}

/// A text in lines of so many characters at most, broken between words; a word that is longer is broken itself.
fn wrapped(text: &str, most: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        let fits = |line: &String| line.chars().count() + 1 + word.chars().count() <= most;
        match lines.last_mut() {
            Some(line) if fits(line) => {
                line.push(' ');
                line.push_str(word);
            }
            _ => {
                let characters: Vec<char> = word.chars().collect();
                lines.extend(characters.chunks(most).map(|part| part.iter().collect::<String>()));
            }
        }
    }
    lines
}

fn legend(out: &mut String, y: f64, curves: &Curves) {
    /// About what a character of the legend is wide.
    const CHARACTER: f64 = 6.6;
    let mut x = 20.0;
    let mut item = |out: &mut String, mark: &dyn Fn(&mut String, f64), words: &str| {
        mark(out, x);
        text(out, x + 35.0, y, "sub", words);
        #[allow(clippy::cast_precision_loss, reason = "a few words")]
        let wide = words.chars().count() as f64;
        x += 35.0 + CHARACTER * wide + 24.0;
    };
    let stroke =
        |class: &'static str| move |out: &mut String, x: f64| line(out, class, [x, y - 4.0, x + 28.0, y - 4.0]);
    item(out, &stroke("curve"), curves.subject.line());
    if curves.have_limits() {
        item(out, &stroke("limit"), "limit in force");
    }
    let mark = |out: &mut String, x: f64| {
        let (x, y) = (x + 22.0, y - 4.0);
        let _ = writeln!(out, "<circle class=\"peak\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\"/>");
    };
    item(out, &mark, curves.subject.mark());
    if curves.joints.iter().any(|joint| joint.switches.is_some()) {
        let phase = |out: &mut String, x: f64| {
            let _ = writeln!(
                out,
                "<rect x=\"{x:.1}\" y=\"{:.1}\" width=\"28\" height=\"14\" class=\"phase\" stroke=\"#c4cad3\"/>",
                y - 12.0
            );
        };
        item(out, &phase, "speeding up, slowing down");
    }
}

fn name(out: &mut String, name: &str, y: f64) {
    line(out, "rule", [20.0, y - 2.0, WIDTH - 20.0, y - 2.0]);
    text(out, 20.0, y + 20.0, "joint", name);
}

fn row(out: &mut String, curves: &Curves, joint: &JointCurves, y: f64) {
    name(out, &joint.joint, y);
    let both = [&joint.left, &joint.right];
    for (curve, left) in both.into_iter().zip(PANELS_LEFT) {
        // Of a rehearsal both are the same quantity, and to be compared.
        let up = match curves.subject {
            Subject::Rehearsal => upright(&both),
            Subject::Plan | Subject::Estimate => upright(&[curve]),
        };
        let frame = Frame::at(left, PANEL_WIDTH, y);
        panel(out, &curves.time, curve, joint.switches, frame, up);
    }
}

/// The upright axis on which curves and their limits are in sight.
fn upright(curves: &[&Curve]) -> Axis {
    let values = curves.iter().flat_map(|curve| {
        let limits = curve.limits_in_sight();
        curve.values.iter().copied().chain(limits)
    });
    Axis::around(values.chain([0.0])).padded(0.08)
}

/// Where a panel is.
#[derive(Debug, Clone, Copy)]
struct Frame {
    left: f64,
    top: f64,
    width: f64,
}

impl Frame {
    /// In the row that begins at `y`.
    fn at(left: f64, width: f64, y: f64) -> Self {
        let top = y + NAME_ABOVE + 20.0;
        Self { left, top, width }
    }
}

fn panel(out: &mut String, time: &[f64], curve: &Curve, switches: Option<(f64, f64)>, frame: Frame, up: Axis) {
    let Frame { left, top, width } = frame;
    let end = time.last().copied().unwrap_or(0.0);
    let limits = curve.limits_in_sight();
    let across = Axis::around([0.0, end]);
    let x = |value: f64| left + width * across.part(value);
    let y = |value: f64| top + PANEL_HEIGHT * (1.0 - up.part(value));
    let (right, bottom) = (left + width, top + PANEL_HEIGHT);

    text(out, left, top - 8.0, "", &format!("{} [{}]", curve.name, curve.unit));
    let summary = match (curve.use_of_limit(), curve.limit) {
        (Some(part), _) => format!("{:.1} % of the limit", 100.0 * part),
        (None, Limit::None) => String::new(),
        (None, Limit::Known(_) | Limit::Unknown) => "no limit known".to_owned(),
    };
    text(out, right, top - 8.0, "sub right", &summary);

    let _ = writeln!(
        out,
        "<rect class=\"panel\" x=\"{left:.1}\" y=\"{top:.1}\" width=\"{width}\" height=\"{PANEL_HEIGHT}\"/>"
    );
    if let Some((accelerated, decelerating)) = switches {
        for (from, to) in [(0.0, accelerated), (decelerating, end)] {
            let (from, to) = (x(from.clamp(0.0, end)), x(to.clamp(0.0, end)));
            let _ = writeln!(
                out,
                "<rect class=\"phase\" x=\"{from:.1}\" y=\"{top:.1}\" width=\"{:.1}\" height=\"{PANEL_HEIGHT}\"/>",
                (to - from).max(0.0)
            );
        }
    }
    for (value, label) in up.ticks(5) {
        line(
            out,
            if value == 0.0 { "zero" } else { "grid" },
            [left, y(value), right, y(value)],
        );
        text(out, left - 7.0, y(value) + 4.0, "tick right", &label);
    }
    for (value, label) in across.ticks(8) {
        line(out, "grid", [x(value), bottom, x(value), bottom + 4.0]);
        text(out, x(value), bottom + 17.0, "tick mid", &label);
    }
    for limit in limits {
        line(out, "limit", [left, y(limit), right, y(limit)]);
        text(out, right + 6.0, y(limit) + 4.0, "limit-text", &number(limit, 4));
    }
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a constant of some hundred"
    )]
    let points = thinned(time, &curve.values, width as usize);
    if !points.is_empty() {
        out.push_str("<polyline class=\"curve\" points=\"");
        for (time, value) in &points {
            let _ = write!(out, "{:.1},{:.1} ", x(*time), y(*value));
        }
        out.truncate(out.trim_end().len());
        out.push_str("\"/>\n");
    }
    if let Some((index, value)) = curve.peak().filter(|(_, value)| *value != 0.0) {
        let at = time.get(index).copied().unwrap_or(0.0);
        let label = format!("{} at {at:.3} s", number(value, 4));
        peak(out, (x(at), y(value)), value > 0.0, [left, right, top, bottom], &label);
    }
}

/// The mark of the tightest moment; its words stay inside the panel, on the side that has room.
fn peak(out: &mut String, (x, y): (f64, f64), rises: bool, [left, right, top, bottom]: [f64; 4], label: &str) {
    const WORDS: f64 = 110.0;
    let _ = writeln!(out, "<circle class=\"peak\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\"/>");
    let (text_x, class) = if x + WORDS > right && x - WORDS > left {
        (x - 8.0, "peak-text right")
    } else {
        (x + 8.0, "peak-text")
    };
    let (above, below) = (y - 9.0, y + 17.0);
    // Outside of the curve, unless the frame is there.
    let text_y = match rises {
        true if above > top + 12.0 => above,
        false if below < bottom - 4.0 => below,
        true => below,
        false => above,
    };
    text(out, text_x, text_y, class, label);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::{example, words::Units};

    fn picture() -> String {
        let mut curves = Curves::of(&example::plan(), &example::robot(), &[], Units::default()).unwrap();
        curves.joints[1].joint = "<slide> & \"co\"".to_owned();
        render(
            &curves,
            Some(&Heading {
                title: "arm <1>".to_owned(),
                lines: vec!["1.000 s".to_owned()],
            }),
        )
    }

    #[test]
    fn every_joint_has_two_panels_with_curve_limit_peak_and_units() {
        let svg = picture();
        assert_eq!(svg.matches("class=\"panel\"").count(), 4);
        assert_eq!(svg.matches("<polyline class=\"curve\"").count(), 4);
        assert_eq!(svg.matches("class=\"limit-text\"").count(), 6);
        for part in [
            "velocity [rad/s]",
            "torque [N]",
            "time [s]",
            "97.5 % of the limit",
            "97.50 at 0.000 s",
        ] {
            assert!(svg.contains(part), "{part:?} is not in the picture");
        }
    }

    #[test]
    fn the_legend_is_that_of_what_is_shown() {
        let mut curves = Curves::of(&example::plan(), &example::robot(), &[], Units::default()).unwrap();
        let svg = render(&curves, None);
        for part in ["plan", "limit in force", "tightest moment", "speeding up"] {
            assert!(svg.contains(&format!(">{part}")), "{part}");
        }
        curves.subject = Subject::Rehearsal;
        for joint in &mut curves.joints {
            joint.switches = None;
            for curve in [&mut joint.left, &mut joint.right] {
                curve.limit = Limit::None;
            }
        }
        let svg = render(&curves, None);
        assert!(
            svg.contains(">distance from the plan<") && svg.contains(">largest value<"),
            "{svg}"
        );
        for part in [">limit in force", "no limit known", ">speeding up", "class=\"limit\""] {
            assert!(!svg.contains(part), "{part}");
        }
    }

    #[test]
    fn what_is_rehearsed_twice_has_one_scale() {
        let curve = |values: [f64; 2]| Curve {
            name: "off",
            unit: "rad",
            values: values.into(),
            limit: Limit::None,
        };
        let curves = |subject| Curves {
            time: vec![0.0, 1.0],
            tool: None,
            joints: vec![JointCurves {
                joint: "a".to_owned(),
                left: curve([0.0, 0.1]),
                right: curve([0.0, 10.0]),
                switches: None,
            }],
            subject,
        };
        let ticks = |subject| render(&curves(subject), None).matches(">10<").count();
        assert_eq!((ticks(Subject::Rehearsal), ticks(Subject::Plan)), (2, 1));
    }

    #[test]
    fn a_heading_is_broken_and_not_cut() {
        let long = "joint ".repeat(60);
        assert!(wrapped(&long, 150).iter().all(|line| line.chars().count() <= 150));
        assert_eq!(wrapped(&long, 150).join(" "), long.trim_end());
        assert_eq!(wrapped("ab cdefg h", 3), ["ab", "cde", "fg", "h"]);
    }

    #[test]
    fn names_cannot_break_the_document() {
        let svg = picture();
        assert!(svg.contains("&lt;slide&gt; &amp; &quot;co&quot;"));
        assert!(svg.contains("<title>arm &lt;1&gt;</title>"));
        assert_eq!(escape("a\u{0}\u{1b}[1mb\nc"), "a[1mb c");
    }

    #[test]
    fn every_coordinate_is_a_number_inside_the_picture() {
        let mut curves = Curves::of(&example::plan(), &example::robot(), &[], Units::default()).unwrap();
        curves.joints[0].right.values = vec![f64::NAN; 5];
        curves.joints[0].left.values = vec![0.0; 5];
        curves.joints[1].right.values.clear();
        let svg = render(&curves, None);
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        render(&Curves::default(), Some(&Heading::default()));
    }
}
