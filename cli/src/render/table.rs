//! Aligned tables and coloured text for the terminal.

use std::fmt::Write;

use crate::io::Terminal;

/// What a piece of text means; shown as a colour where there are colours, never by colour alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Tone {
    Plain,
    Bold,
    Dim,
    Good,
    Bad,
}

/// The text in its tone.
pub(crate) fn paint(text: &str, tone: Tone, colour: bool) -> String {
    let code = match tone {
        _ if !colour => return text.to_owned(),
        Tone::Plain => return text.to_owned(),
        Tone::Bold => "1",
        Tone::Dim => "2",
        Tone::Good => "32",
        Tone::Bad => "1;31",
    };
    format!("\x1b[{code}m{text}\x1b[0m")
}

/// One cell of a table.
#[derive(Debug, Clone)]
pub(crate) struct Cell {
    text: String,
    tone: Tone,
}

impl Cell {
    pub(crate) fn new(text: impl Into<String>, tone: Tone) -> Self {
        Self {
            text: text.into(),
            tone,
        }
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::new(text, Tone::Plain)
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::new(text, Tone::Plain)
    }
}

/// A table with a head.
#[derive(Debug)]
pub(crate) struct Table {
    head: Vec<String>,
    rows: Vec<Vec<Cell>>,
    first_number: usize,
}

/// Space between columns.
const GAP: &str = "  ";

/// Columns that stay however narrow the screen is.
const FEWEST: usize = 4;

impl Table {
    pub(crate) fn new<T: Into<String>>(head: impl IntoIterator<Item = T>) -> Self {
        let head: Vec<String> = head.into_iter().map(Into::into).collect();
        Self {
            first_number: head.len(),
            head,
            rows: Vec::new(),
        }
    }

    /// From this column on cells are numbers and stand at the right.
    pub(crate) fn numbers_from(mut self, column: usize) -> Self {
        self.first_number = column;
        self
    }

    pub(crate) fn row<T: Into<Cell>>(&mut self, cells: impl IntoIterator<Item = T>) {
        self.rows.push(cells.into_iter().map(Into::into).collect());
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// As [`Self::render`], without the last columns where all are too wide for the screen.
    pub(crate) fn render_for(&self, terminal: Terminal) -> String {
        let Some(room) = terminal.table_width else {
            return self.render(terminal.colour);
        };
        let widths = self.widths();
        let gap = GAP.chars().count();
        let mut shown = widths.len();
        while shown > FEWEST && widths[..shown].iter().sum::<usize>() + gap * (shown - 1) > room {
            shown -= 1;
        }
        if shown == widths.len() {
            return self.render(terminal.colour);
        }
        let narrow = Self {
            head: self.head[..shown].to_vec(),
            rows: self
                .rows
                .iter()
                .map(|row| row[..shown.min(row.len())].to_vec())
                .collect(),
            first_number: self.first_number,
        };
        let note = format!("in a wider window also: {}", self.head[shown..].join(", "));
        format!(
            "{}{}\n",
            narrow.render(terminal.colour),
            paint(&note, Tone::Dim, terminal.colour)
        )
    }

    fn widths(&self) -> Vec<usize> {
        let width = |column: usize| {
            let cells = self
                .rows
                .iter()
                .filter_map(|row| row.get(column))
                .map(|cell| cell.text.as_str());
            let texts = cells.chain([self.head[column].as_str()]);
            texts.map(|text| text.chars().count()).max().unwrap_or(0)
        };
        (0..self.head.len()).map(width).collect()
    }

    pub(crate) fn render(&self, colour: bool) -> String {
        let widths = self.widths();
        let mut out = String::new();
        let head: Vec<Cell> = self
            .head
            .iter()
            .map(|text| Cell::new(text.clone(), Tone::Bold))
            .collect();
        self.line(&mut out, &head, &widths, colour);
        let rule = widths
            .iter()
            .map(|&width| "─".repeat(width))
            .collect::<Vec<_>>()
            .join(GAP);
        let _ = writeln!(out, "{}", paint(&rule, Tone::Dim, colour));
        for row in &self.rows {
            self.line(&mut out, row, &widths, colour);
        }
        out
    }

    fn line(&self, out: &mut String, cells: &[Cell], widths: &[usize], colour: bool) {
        let mut line = String::new();
        for (column, (cell, &width)) in cells.iter().zip(widths).enumerate() {
            let padding = " ".repeat(width.saturating_sub(cell.text.chars().count()));
            let text = paint(&cell.text, cell.tone, colour);
            let (before, after) = if column < self.first_number {
                ("", &*padding)
            } else {
                (&*padding, "")
            };
            let gap = if column == 0 { "" } else { GAP };
            let _ = write!(line, "{gap}{before}{text}{after}");
        }
        out.push_str(line.trim_end());
        out.push('\n');
    }
}

/// Numbers of one column with the same count of decimals: about five digits for the largest of them.
pub(crate) fn aligned(values: &[Option<f64>]) -> Vec<String> {
    let largest = values
        .iter()
        .flatten()
        .fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let decimals = decimals_for(largest, 5);
    values
        .iter()
        .map(|value| match value {
            Some(value) => fixed(*value, decimals),
            None => "–".to_owned(),
        })
        .collect()
}

/// A single number with about so many digits.
pub(crate) fn number(value: f64, digits: i32) -> String {
    fixed(value, decimals_for(value.abs(), digits))
}

/// Decimals, never "-0.00".
pub(crate) fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(rest) if rest.chars().all(|digit| matches!(digit, '0' | '.')) => rest.to_owned(),
        _ => text,
    }
}

fn decimals_for(magnitude: f64, digits: i32) -> usize {
    if !(magnitude > 0.0 && magnitude.is_finite()) {
        return 1;
    }
    #[allow(clippy::cast_possible_truncation, reason = "a double's exponent is within ±324")]
    let before = magnitude.log10().floor() as i32 + 1;
    usize::try_from((digits - before).clamp(0, 6)).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_line_up_with_and_without_colour() {
        let mut table = Table::new(["joint", "torque [N m]"]).numbers_from(1);
        table.row([Cell::from("elbow"), Cell::from("-12.5")]);
        table.row([Cell::from("größe_joint"), Cell::new("3", Tone::Bad)]);
        let text = table.render(false);
        assert!(!text.contains('\x1b'));
        let ends: Vec<_> = text.lines().map(|line| line.chars().count()).collect();
        assert!(ends.windows(2).all(|pair| pair[0] == pair[1]), "{text}");
        let coloured = table.render(true);
        let bare = coloured.split('\x1b').map(|part| {
            part.split_once('m')
                .map_or(part, |(code, rest)| if code.starts_with('[') { rest } else { part })
        });
        assert_eq!(bare.collect::<String>(), text);
    }

    #[test]
    fn a_narrow_screen_loses_the_last_columns_and_is_told() {
        let mut table = Table::new(["one", "two", "three", "four", "five"]);
        table.row(["1", "2", "3", "4", "5"]);
        let terminal = |table_width| Terminal {
            width: 20,
            table_width,
            colour: false,
            error_colour: false,
        };
        assert_eq!(table.render_for(terminal(None)), table.render(false));
        assert_eq!(table.render_for(terminal(Some(27))), table.render(false));
        let narrow = table.render_for(terminal(Some(26)));
        assert!(narrow.ends_with("in a wider window also: five\n"), "{narrow}");
        assert!(narrow.starts_with("one  two  three  four\n"), "{narrow}");
    }

    #[test]
    fn numbers_of_a_column_share_their_decimals() {
        assert_eq!(
            aligned(&[Some(150.0), Some(-0.521), None, Some(-0.0001)]),
            ["150.00", "-0.52", "–", "0.00"]
        );
        assert_eq!(aligned(&[Some(0.0)]), ["0.0"]);
        assert_eq!(number(1e-9, 4), "0.000000");
        assert_eq!(number(123_456.7, 4), "123457");
        assert_eq!(number(f64::NAN, 4), "NaN");
    }
}
