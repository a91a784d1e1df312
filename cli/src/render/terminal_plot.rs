//! Curves in the terminal, drawn with braille characters: each holds two by four dots.

use super::{
    curves::{Curve, Curves},
    scale::Axis,
    table::{Tone, number, paint},
};

/// Lines of one plot's picture.
const ROWS: usize = 7;
/// Columns left of the picture, for the values.
const GUTTER: usize = 9;
/// From this width on, speed and torque stand side by side.
const SIDE_BY_SIDE: usize = 100;
const GAP: usize = 3;
const NARROWEST: usize = 40;
const WIDEST: usize = 200;

/// Two curves of every joint against their limits.
pub(crate) fn render(curves: &Curves, width: usize, colour: bool) -> String {
    let width = width.clamp(NARROWEST, WIDEST);
    let mut out = String::new();
    if let Some(tool) = &curves.tool {
        out.push_str(&paint("tool", Tone::Bold, colour));
        out.push('\n');
        for line in plot(&curves.time, tool, width, colour) {
            push_line(&mut out, &line.text);
        }
        out.push('\n');
    }
    for joint in &curves.joints {
        out.push_str(&paint(&joint.joint, Tone::Bold, colour));
        out.push('\n');
        if width >= SIDE_BY_SIDE {
            let each = (width - GAP) / 2;
            let left = plot(&curves.time, &joint.left, each, colour);
            let right = plot(&curves.time, &joint.right, each, colour);
            for (left, right) in left.iter().zip(&right) {
                let space = " ".repeat((each + GAP).saturating_sub(left.width));
                push_line(&mut out, &format!("{}{space}{}", left.text, right.text));
            }
        } else {
            for line in [&joint.left, &joint.right]
                .map(|curve| plot(&curves.time, curve, width, colour))
                .concat()
            {
                push_line(&mut out, &line.text);
            }
        }
        out.push('\n');
    }
    let legend = match curves.have_limits() {
        true => format!(
            "{} limit in force; peaks in % of it",
            paint(LIMIT_SAMPLE, Tone::Bad, colour)
        ),
        false => format!("each curve: {}", curves.subject.line()),
    };
    push_line(&mut out, &legend);
    out
}

const LIMIT_SAMPLE: &str = "⠉⠁⠉⠁⠉⠁";

fn push_line(out: &mut String, line: &str) {
    out.push_str(line.trim_end());
    out.push('\n');
}

/// A line of text and the columns it takes on the screen.
#[derive(Debug, Clone)]
struct Line {
    text: String,
    width: usize,
}

fn line(text: String) -> Line {
    Line {
        width: text.chars().count(),
        text,
    }
}

fn plot(time: &[f64], curve: &Curve, width: usize, colour: bool) -> Vec<Line> {
    let columns = width.saturating_sub(GUTTER + 1).max(1);
    let limits = curve.limits_in_sight();
    let values = curve.values.iter().copied();
    let axis = Axis::around(values.chain(limits.iter().copied()).chain([0.0]));
    let end = time.last().copied().unwrap_or(0.0);

    let mut canvas = Canvas::new(columns, ROWS);
    canvas.horizontal(axis.part(0.0), 5, Layer::Zero);
    for limit in &limits {
        canvas.horizontal(axis.part(*limit), 2, Layer::Limit);
    }
    let span = Axis::around([0.0, end]);
    let points: Vec<(f64, f64)> = time
        .iter()
        .zip(&curve.values)
        .map(|(time, value)| (span.part(*time), axis.part(*value)))
        .collect();
    canvas.curve(&points);

    let use_of_limit = curve
        .use_of_limit()
        .map_or_else(String::new, |part| format!(" ({:.1} %)", 100.0 * part));
    let peak = curve.peak().map_or(0.0, |(_, peak)| peak);
    let peak = format!("peak {}{use_of_limit}", number(peak, 4));
    let title = format!("{}{} [{}]  ", " ".repeat(GUTTER + 1), curve.name, curve.unit);
    // Where it would be cut it begins above the values already.
    let title = match title.chars().count() + peak.chars().count() <= width {
        true => title + &peak,
        false => format!("{} [{}] {peak}", curve.name, curve.unit),
    };
    let title: String = title.chars().take(width).collect();

    let mut lines = vec![line(title)];
    for row in 0..ROWS {
        let label = match row {
            0 => number(axis.high, 4),
            row if row == ROWS - 1 => number(axis.low, 4),
            row if row == zero_row(axis) => "0".to_owned(),
            _ => String::new(),
        };
        let label: String = label.chars().take(GUTTER - 1).collect();
        let picture = canvas.row(row, colour);
        lines.push(Line {
            text: format!("{label:>0$} │{picture}", GUTTER - 1),
            width: GUTTER + 1 + columns,
        });
    }
    let end = format!("{end:.3} s");
    let left = " ".repeat(GUTTER) + "└0";
    let rule = "─".repeat((GUTTER + 1 + columns).saturating_sub(left.chars().count() + end.chars().count()));
    lines.push(line(format!("{left}{rule}{end}")));
    lines
}

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "a few rows"
)]
fn zero_row(axis: Axis) -> usize {
    ((1.0 - axis.part(0.0)) * (ROWS as f64 - 1.0))
        .round()
        .clamp(0.0, ROWS as f64) as usize
}

/// What a dot belongs to; later ones are drawn over earlier ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Layer {
    Zero,
    Limit,
    Curve,
}

struct Canvas {
    columns: usize,
    rows: usize,
    cells: Vec<(u8, Option<Layer>)>,
}

impl Canvas {
    fn new(columns: usize, rows: usize) -> Self {
        Self {
            columns,
            rows,
            cells: vec![(0, None); columns * rows],
        }
    }

    /// Sets a dot; x from the left, y from the top.
    fn dot(&mut self, x: usize, y: usize, layer: Layer) {
        const BITS: [[u8; 2]; 4] = [[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]];
        let Some(cell) = self.cells.get_mut((y / 4) * self.columns + x / 2) else {
            return;
        };
        cell.0 |= BITS[y % 4][x % 2];
        cell.1 = cell.1.max(Some(layer));
    }

    /// The dot row of a part of the height, 0 at the bottom.
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "clamped to the picture"
    )]
    fn y(&self, part: f64) -> usize {
        let most = (4 * self.rows - 1) as f64;
        ((1.0 - part) * most).round().clamp(0.0, most) as usize
    }

    fn horizontal(&mut self, part: f64, gap: usize, layer: Layer) {
        let y = self.y(part);
        for x in (0..2 * self.columns)
            .filter(|x| x % (gap + 1) < gap.min(3) && (layer == Layer::Limit || x % (gap + 1) == 0))
        {
            self.dot(x, y, layer);
        }
    }

    /// A line through points given as parts of width and height, in the order of x.
    #[allow(clippy::cast_precision_loss, reason = "a few hundred columns")]
    fn curve(&mut self, points: &[(f64, f64)]) {
        let last = (2 * self.columns - 1).max(1) as f64;
        let mut before: Option<usize> = None;
        let mut next = 0;
        for x in 0..2 * self.columns {
            let (from, to) = ((x as f64 - 0.5) / last, (x as f64 + 0.5) / last);
            // Everything that happens within this column of dots, so that no peak is lost.
            let mut ys: Vec<usize> = interpolate(points, x as f64 / last)
                .map(|part| self.y(part))
                .into_iter()
                .collect();
            while next < points.len() && points[next].0 < to {
                if points[next].0 >= from && points[next].1.is_finite() {
                    ys.push(self.y(points[next].1));
                }
                next += 1;
            }
            let (Some(&top), Some(&bottom)) = (ys.iter().min(), ys.iter().max()) else {
                before = None;
                continue;
            };
            let (mut top, mut bottom) = (top, bottom);
            if let Some(before) = before {
                // Steps are joined.
                top = top.min(before + 1);
                bottom = bottom.max(before.saturating_sub(1));
            }
            for y in top..=bottom {
                self.dot(x, y, Layer::Curve);
            }
            before = ys.first().copied();
        }
    }

    fn row(&self, row: usize, colour: bool) -> String {
        let mut out = String::new();
        for (bits, layer) in &self.cells[row * self.columns..(row + 1) * self.columns] {
            let character = match bits {
                0 => ' ',
                bits => char::from_u32(0x2800 + u32::from(*bits)).unwrap_or(' '),
            };
            let code = match layer {
                Some(Layer::Curve) => "36",
                Some(Layer::Limit) => "31",
                Some(Layer::Zero) => "2",
                None => "",
            };
            if colour && !code.is_empty() {
                out.push_str(&format!("\x1b[{code}m{character}\x1b[0m"));
            } else {
                out.push(character);
            }
        }
        out
    }
}

/// The value at x between the points around it.
fn interpolate(points: &[(f64, f64)], x: f64) -> Option<f64> {
    let after = points.partition_point(|point| point.0 < x);
    let (a, b) = (points.get(after.checked_sub(1)?)?, points.get(after)?);
    let part = if b.0 > a.0 { (x - a.0) / (b.0 - a.0) } else { 0.0 };
    Some(a.1 + part * (b.1 - a.1)).filter(|value| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::{example, words::Units};

    fn curves() -> Curves {
        Curves::of(&example::plan(), &example::robot(), &[], Units::default()).unwrap()
    }

    #[test]
    fn no_line_is_wider_than_the_screen() {
        for width in [0, 40, 60, 99, 100, 140, 5000] {
            let text = render(&curves(), width, false);
            let widest = text.lines().map(|line| line.chars().count()).max().unwrap();
            assert!(widest <= width.clamp(NARROWEST, WIDEST), "{width}: {widest}\n{text}");
            assert!(!text.contains('\x1b'));
        }
    }

    #[test]
    fn titles_name_quantity_unit_and_use() {
        let text = render(&curves(), 60, false);
        assert!(text.contains("turn\n"), "{text}");
        assert!(text.contains("velocity [rad/s]  peak 1.500 (75.0 %)"), "{text}");
        assert!(text.contains("torque [N]  peak -20.00 (40.0 %)"), "{text}");
    }

    #[test]
    fn a_curve_reaches_from_edge_to_edge_and_keeps_its_peak() {
        let mut canvas = Canvas::new(10, 2);
        canvas.curve(&[(0.0, 0.0), (0.501, 0.0), (0.502, 1.0), (0.503, 0.0), (1.0, 0.0)]);
        let (top, bottom) = (canvas.row(0, false), canvas.row(1, false));
        assert!(top.trim() != "", "the peak is drawn: {top:?}");
        assert!(!bottom.contains(' '), "{bottom:?}");
    }

    #[test]
    fn odd_numbers_draw_nothing_and_break_nothing() {
        let mut odd = curves();
        odd.time = vec![0.0, f64::NAN, 1.0];
        odd.joints[0].right.values = vec![f64::NAN, f64::INFINITY, 1.0];
        odd.joints[1].right.values.clear();
        render(&odd, 80, true);
        render(&Curves::default(), 80, false);
    }
}
