//! Torques, mass matrices and Jacobians, for a person at a terminal.

use takt_client::v1;

use super::{
    table::{Table, Tone, aligned, paint},
    words::{self, Units},
};

/// One block a state.
pub(crate) fn torques(reply: &v1::InverseDynamicsResponse, robot: &v1::Robot, colour: bool) -> String {
    let names: Vec<&str> = robot.joints.iter().map(|joint| joint.name.as_str()).collect();
    let unit = words::common(names.iter().map(|name| Units::default().of(robot, name).torque));
    let mut out = String::new();
    for (index, result) in reply.results.iter().enumerate() {
        if reply.results.len() > 1 {
            let gap = if index == 0 { "" } else { "\n" };
            out.push_str(&format!(
                "{gap}{}\n",
                paint(&format!("state {}", index + 1), Tone::Bold, colour)
            ));
        }
        out.push_str(&table(result, robot, &unit).render(colour));
        let count = result.torque.len();
        let rigid = match result.rigid_mass_matrix == result.mass_matrix {
            // No rotor inertia: the same again.
            true => &Vec::new(),
            false => &result.rigid_mass_matrix,
        };
        for (title, values, rows) in [
            (
                "mass matrix, with the reflected rotor inertias",
                &result.mass_matrix,
                count,
            ),
            ("mass matrix, rigid bodies alone", rigid, count),
            (
                "Jacobian of the tool centre point: vx vy vz wx wy wz",
                &result.jacobian,
                6,
            ),
        ] {
            if !values.is_empty() && rows > 0 {
                out.push_str(&format!(
                    "\n{}\n{}",
                    paint(title, Tone::Bold, colour),
                    matrix(values, rows)
                ));
            }
        }
    }
    out
}

fn table(result: &v1::InverseDynamicsResult, robot: &v1::Robot, unit: &str) -> Table {
    let column = |values: &[f64]| aligned(&values.iter().copied().map(Some).collect::<Vec<_>>());
    let total = column(&result.torque);
    let parts = [
        &result.rigid_torque,
        &result.gravity_torque,
        &result.rotor_torque,
        &result.friction_torque,
    ]
    .map(|values| column(values));
    let mut table = Table::new([
        "joint".to_owned(),
        format!("torque [{unit}]"),
        "of peak".to_owned(),
        "rigid bodies".to_owned(),
        "(gravity)".to_owned(),
        "rotor".to_owned(),
        "friction".to_owned(),
    ])
    .numbers_from(1);
    for (index, torque) in result.torque.iter().enumerate() {
        let joint = robot.joints.get(index);
        let peak = joint
            .and_then(|joint| joint.drive.as_ref())
            .and_then(|drive| drive.peak_torque);
        let used = peak.map_or_else(
            || "–".to_owned(),
            |peak| format!("{:.1} %", 100.0 * torque.abs() / peak),
        );
        let name = joint.map_or_else(|| (index + 1).to_string(), |joint| joint.name.clone());
        let mut cells = vec![name, total[index].clone(), used];
        cells.extend(parts.iter().map(|part| part.get(index).cloned().unwrap_or_default()));
        table.row(cells);
    }
    table
}

fn matrix(values: &[f64], rows: usize) -> String {
    let cells = aligned(&values.iter().copied().map(Some).collect::<Vec<_>>());
    let width = cells.iter().map(String::len).max().unwrap_or(0);
    let mut out = String::new();
    for row in cells.chunks((values.len() / rows).max(1)) {
        let row: Vec<String> = row.iter().map(|cell| format!("{cell:>width$}")).collect();
        out.push_str(&row.join("  "));
        out.push('\n');
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::example;

    #[test]
    fn torques_and_matrices_are_laid_out() {
        let result = v1::InverseDynamicsResult {
            torque: vec![50.0, -5.0],
            rigid_torque: vec![40.0, -4.0],
            gravity_torque: vec![30.0, 0.0],
            rotor_torque: vec![5.0, -0.5],
            friction_torque: vec![5.0, -0.5],
            mass_matrix: vec![2.0, 0.5, 0.5, 1.0],
            ..Default::default()
        };
        let reply = v1::InverseDynamicsResponse {
            results: vec![result],
            provenance: None,
        };
        let text = torques(&reply, &example::robot(), false);
        assert!(text.contains("50.0 %") && text.contains("10.0 %"), "{text}");
        assert!(
            text.lines()
                .any(|line| line.split_whitespace().eq(["2.0000", "0.5000"])),
            "{text}"
        );
        torques(
            &v1::InverseDynamicsResponse {
                results: vec![Default::default()],
                provenance: None,
            },
            &v1::Robot::default(),
            true,
        );
    }
}
