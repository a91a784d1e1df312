//! Measurements of one joint on the bench in CSV: a head that names the columns, in any order, and one row a measurement.

use crate::{failure::Failure, render::csv::cells};

/// A column of a sheet.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Column {
    /// Every name that it may have, the proper one first.
    pub(crate) names: &'static [&'static str],
    /// The column may be missing, and so may a cell of it.
    pub(crate) optional: bool,
}

/// Reads the rows of a sheet; a cell is `None` where nothing was measured.
pub(crate) fn rows<const N: usize>(text: &str, columns: [Column; N]) -> Result<Vec<[Option<f64>; N]>, Failure> {
    let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    let (_, head) = lines.next().ok_or_else(|| Failure::usage("the file is empty"))?;
    let head = cells(head.trim_start_matches('\u{feff}').trim_end());
    let mut places = [None; N];
    for (place, column) in places.iter_mut().zip(columns) {
        *place = head.iter().position(|name| column.names.contains(&name.trim()));
        if place.is_none() && !column.optional {
            let failure = Failure::usage(format!("the file has no column {}", column.names[0]));
            return Err(failure.hint(form(&columns)));
        }
    }
    let mut rows = Vec::new();
    for (index, line) in lines {
        let cells = cells(line.trim_end());
        let mut row = [None; N];
        for ((value, place), column) in row.iter_mut().zip(places).zip(columns) {
            let text = place.and_then(|place| cells.get(place)).map_or("", |cell| cell.trim());
            if text.is_empty() && column.optional {
                continue;
            }
            let read = text.parse().map_err(|_| {
                let name = column.names[0];
                Failure::usage(format!("line {}, column {name}: {text:?} is no number", index + 1))
            });
            *value = Some(read?);
        }
        rows.push(row);
    }
    Ok(rows)
}

fn form(columns: &[Column]) -> String {
    let names = columns.iter().map(|column| match column.optional {
        true => format!("{} (may be left out)", column.names[0]),
        false => column.names[0].to_owned(),
    });
    let names: Vec<String> = names.collect();
    format!("the first line names the columns: {}", names.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    const COLUMNS: [Column; 2] = [
        Column {
            names: &["time_s", "t"],
            optional: false,
        },
        Column {
            names: &["deformation"],
            optional: true,
        },
    ];

    #[test]
    fn columns_are_found_by_name_and_may_be_left_out() {
        let read = rows("note,deformation,t\nx,2,1\n\ny,,3\n", COLUMNS).unwrap();
        assert_eq!(read, [[Some(1.0), Some(2.0)], [Some(3.0), None]]);
        assert_eq!(rows("time_s\n4\n", COLUMNS).unwrap(), [[Some(4.0), None]]);
    }

    #[test]
    fn what_is_missing_or_no_number_is_said_with_its_place() {
        for (text, part) in [
            ("", "empty"),
            ("deformation\n1\n", "no column time_s"),
            ("t\n1\nsoon\n", "line 3, column time_s: \"soon\""),
            ("t,deformation\n,1\n", "line 2, column time_s: \"\""),
            ("t,deformation\n1,x\n", "line 2, column deformation: \"x\""),
        ] {
            let said = rows(text, COLUMNS).unwrap_err().render(false);
            assert!(said.contains(part), "{text:?}: {said}");
        }
    }
}
