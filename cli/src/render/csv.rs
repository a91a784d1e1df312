//! Set-points and trajectories as CSV (RFC 4180): one row a time, one column a joint and quantity.
//!
//! Numbers have as many digits as it takes to read the same double back.

use std::fmt::Write;

use takt_client::v1;

use crate::failure::Failure;

const TIME: &str = "time_s";

type Column = fn(&v1::JointColumns) -> &Vec<f64>;

/// The first four are always there, the others where they were asked for.
const QUANTITIES: [(&str, Column); 6] = [
    ("position", |joint| &joint.position),
    ("velocity", |joint| &joint.velocity),
    ("acceleration", |joint| &joint.acceleration),
    ("torque", |joint| &joint.torque),
    ("motor_torque", |joint| &joint.motor_torque),
    ("motor_current", |joint| &joint.motor_current_a),
];

/// What stands in the columns of a joint.
fn quantities(joint: &v1::JointColumns) -> impl Iterator<Item = (&'static str, Column)> {
    let all = QUANTITIES.into_iter().enumerate();
    let given = all.filter(|(index, (_, column))| *index < 4 || !column(joint).is_empty());
    given.map(|(_, quantity)| quantity)
}

/// `time_s,JOINT.position,JOINT.velocity,JOINT.acceleration,JOINT.torque,…`; of a path also
/// `segment,fraction,tool_speed_m_per_s`.
pub(crate) fn setpoints(setpoints: &v1::Setpoints) -> String {
    head(setpoints) + &rows(setpoints)
}

/// The names of the columns.
pub(crate) fn head(setpoints: &v1::Setpoints) -> String {
    let mut out = TIME.to_owned();
    for joint in &setpoints.joints {
        for (name, _) in quantities(joint) {
            let _ = write!(out, ",{}", quoted(&format!("{}.{name}", joint.joint)));
        }
    }
    if !setpoints.segment.is_empty() {
        out.push_str(",segment,fraction,tool_speed_m_per_s");
    }
    out.push('\n');
    out
}

/// One row a sample.
pub(crate) fn rows(setpoints: &v1::Setpoints) -> String {
    let mut out = String::new();
    let cell = |out: &mut String, value: Option<&f64>| match value {
        Some(value) => {
            let _ = write!(out, ",{value:?}");
        }
        None => out.push(','),
    };
    for (index, time) in setpoints.time_s.iter().enumerate() {
        let _ = write!(out, "{time:?}");
        for joint in &setpoints.joints {
            for (_, column) in quantities(joint) {
                cell(&mut out, column(joint).get(index));
            }
        }
        if let Some(segment) = setpoints.segment.get(index) {
            let _ = write!(out, ",{segment}");
            cell(&mut out, setpoints.fraction.get(index));
            cell(&mut out, setpoints.tool_speed_m_per_s.get(index));
        }
        out.push('\n');
    }
    out
}

fn quoted(text: &str) -> String {
    if text.contains(['"', ',', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

/// Whether a text looks like our CSV rather than JSON, YAML or TOML.
pub(crate) fn looks_like_csv(text: &str) -> bool {
    text.trim_start_matches('\u{feff}')
        .trim_start()
        .trim_start_matches('"')
        .starts_with(TIME)
}

/// Reads a trajectory; `joints` are the robot's in model order, whatever the order of the columns.
pub(crate) fn trajectory(text: &str, joints: &[String]) -> Result<v1::Trajectory, Failure> {
    let mut lines = text
        .trim_start_matches('\u{feff}')
        .lines()
        .enumerate()
        .filter(|(_, line)| !line.trim().is_empty());
    let head = lines.next().map(|(_, line)| cells(line)).unwrap_or_default();
    let column = |name: &str| head.iter().position(|cell| cell.trim() == name);
    let Some(time) = column(TIME) else {
        return Err(Failure::usage(format!(
            "the first column of a trajectory in CSV is {TIME}"
        )));
    };
    let columns = |quantity: &str| -> Vec<Option<usize>> {
        joints
            .iter()
            .map(|joint| column(&format!("{joint}.{quantity}")))
            .collect()
    };
    let [position, velocity, acceleration] = ["position", "velocity", "acceleration"].map(columns);
    if let Some(missing) = joints.iter().zip(&position).find(|(_, column)| column.is_none()) {
        return Err(Failure::usage(format!("no column {}.position", missing.0))
            .hint(format!("this robot's joints are: {}", joints.join(", "))));
    }
    // All joints or none: half a state is no state.
    let whole = |columns: &[Option<usize>], quantity: &str| -> Result<Vec<usize>, Failure> {
        let found: Vec<usize> = columns.iter().flatten().copied().collect();
        if !found.is_empty() && found.len() < joints.len() {
            return Err(Failure::usage(format!(
                "columns of {quantity} for some joints, but not for all"
            )));
        }
        Ok(found)
    };
    let position = whole(&position, "position")?;
    let velocity = whole(&velocity, "velocity")?;
    let acceleration = whole(&acceleration, "acceleration")?;

    let mut points = Vec::new();
    for (index, line) in lines {
        let cells = cells(line);
        let read = |column: usize| -> Result<f64, Failure> {
            let text = cells.get(column).map_or("", |cell| cell.trim());
            text.parse().map_err(|_| {
                let name = head.get(column).map_or("", String::as_str);
                Failure::usage(format!("line {}, column {name}: {text:?} is no number", index + 1))
            })
        };
        let row = |columns: &[usize]| {
            columns
                .iter()
                .map(|&column| read(column))
                .collect::<Result<Vec<f64>, _>>()
        };
        points.push(v1::TrajectoryPoint {
            time_s: read(time)?,
            position: row(&position)?,
            velocity: row(&velocity)?,
            acceleration: row(&acceleration)?,
        });
    }
    Ok(v1::Trajectory {
        points,
        interpolation: None,
    })
}

/// The cells of one line; cells never hold line breaks here.
pub(crate) fn cells(line: &str) -> Vec<String> {
    let mut cells = vec![String::new()];
    let mut inside = false;
    let mut characters = line.chars().peekable();
    while let Some(character) = characters.next() {
        let last = cells.len() - 1;
        match character {
            '"' if inside && characters.peek() == Some(&'"') => {
                characters.next();
                cells[last].push('"');
            }
            '"' => inside = !inside,
            ',' if !inside => cells.push(String::new()),
            _ => cells[last].push(character),
        }
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::example;

    fn names(list: &[&str]) -> Vec<String> {
        list.iter().map(|&name| name.to_owned()).collect()
    }

    #[test]
    fn set_points_survive_the_way_out_and_back_bit_by_bit() {
        let mut given = example::plan().setpoints.unwrap();
        given.joints[0].position[1] = 0.1 + 0.2;
        given.joints[1].joint = "odd, \"name\"".to_owned();
        let joints: Vec<String> = given.joints.iter().map(|joint| joint.joint.clone()).collect();
        let text = setpoints(&given);
        assert!(looks_like_csv(&text));
        let read = trajectory(&text, &joints).unwrap();
        assert_eq!(read.points.len(), given.time_s.len());
        assert_eq!(read.points[1].position[0].to_bits(), (0.1_f64 + 0.2).to_bits());
        assert_eq!(read.points[2].acceleration[1], given.joints[1].acceleration[2]);
    }

    #[test]
    fn columns_are_found_by_name() {
        let text = "b.position,time_s,a.position\r\n2,0,1\r\n4,0.5,3\r\n";
        let read = trajectory(text, &names(&["a", "b"])).unwrap();
        assert_eq!(read.points[1].position, [3.0, 4.0]);
        assert_eq!(read.points[1].time_s, 0.5);
        assert!(read.points[0].velocity.is_empty());
    }

    #[test]
    fn mistakes_are_named_with_their_place() {
        for (text, part) in [
            ("t,a.position\n0,1\n", "time_s"),
            ("time_s,b.position\n0,1\n", "a.position"),
            ("time_s,a.position\n0,x\n", "line 2, column a.position: \"x\""),
            ("time_s,a.position\n0\n", "line 2"),
            ("", "time_s"),
        ] {
            let failure = trajectory(text, &names(&["a"])).unwrap_err().render(false);
            assert!(failure.contains(part), "{text:?}: {failure}");
        }
        let half = "time_s,a.position,b.position,a.velocity\n0,1,2,3\n";
        assert!(trajectory(half, &names(&["a", "b"])).is_err());
    }
}
