//! Estimates and commits.

use super::{call, exit, server};

/// Two joints without mass: their whole torque is friction, but for what their rotors take.
const BARE: &str = r#"
dh:
  convention: STANDARD
  links:
  - {name: a, type: REVOLUTE, a_m: 0.5, alpha_rad: 0, d_m: 0, theta_rad: 0}
  - {name: b.c, type: REVOLUTE, a_m: 0.5, alpha_rad: 0, d_m: 0, theta_rad: 0}
joints:
- {name: a, limits: {position_lower: -3, position_upper: 3, velocity: 3}, drive: {peak_torque: 80, rotor_inertia_kg_m2: 0.01}}
- {name: b.c, limits: {position_lower: -3, position_upper: 3, velocity: 4}, drive: {peak_torque: 30, rotor_inertia_kg_m2: 0.01}}
"#;

/// Coulomb and viscous friction of the joints.
const FRICTION: [(f64, f64); 2] = [(5.0, 7.0), (2.0, 3.0)];

pub(super) fn arm() -> String {
    let server = server();
    let said = call(&server, &["robot", "register", "arm", "--description", "-"], BARE);
    assert_eq!(said.code, exit::OK, "{}", said.errors);
    server
}

/// A log of 1 kHz: the first joint by number, the second by name.
pub(super) fn log(samples: u32) -> String {
    log_of_run(samples, 0.0)
}

/// The same of another run, whose motion begins elsewhere.
pub(super) fn log_of_run(samples: u32, phase: f64) -> String {
    let mut text = "t,q1,qd1,tau1,b.c.position,b.c.velocity,b.c.torque,temperature\n".to_owned();
    for index in 0..samples {
        let time = f64::from(index) * 1e-3;
        text.push_str(&format!("{time}"));
        for (rate, (coulomb, viscous)) in [1.3_f64, 1.9].into_iter().zip(FRICTION) {
            let (sin, cos) = (rate * time + phase).sin_cos();
            let (q, qd) = (0.8 * sin, 0.8 * rate * cos);
            text.push_str(&format!(
                ",{q},{qd},{}",
                coulomb * qd.signum() + viscous * qd - 0.01 * rate * rate * q
            ));
        }
        text.push_str(",31.5\n");
    }
    text
}

#[test]
fn friction_is_estimated_shown_and_committed() {
    let server = arm();
    let log = log(8000);
    let table = call(&server, &["drive", "estimate", "arm", "-", "--plot"], &log);
    assert_eq!(table.code, exit::OK, "{}", table.errors);
    for part in [
        "Coulomb",
        "viscous",
        "N m s/rad",
        "b.c",
        "8000 samples",
        "Coulomb torque [N m]",
    ] {
        assert!(table.output.contains(part), "{part}: {}", table.output);
    }
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (csv, estimate, picture) = (file("log.csv"), file("estimate.json"), file("friction.svg"));
    std::fs::write(&csv, &log).unwrap();
    for transport in ["grpc", "http"] {
        let line = [
            "--transport",
            transport,
            "drive",
            "estimate",
            "arm",
            &csv,
            "--json",
            "--svg",
            &picture,
        ];
        let said = call(&server, &line, "");
        assert_eq!(said.code, exit::OK, "{}", said.errors);
        let reply: serde_json::Value = serde_json::from_str(&said.output).unwrap();
        let viscous = reply["joints"][0]["coefficients"][1]["value"].as_f64().unwrap();
        assert!((viscous - FRICTION[0].1).abs() < 0.1, "{viscous}");
        std::fs::write(&estimate, said.output).unwrap();
    }
    assert!(std::fs::read_to_string(&picture).unwrap().starts_with("<svg"));
    let checked = call(&server, &["drive", "commit", "arm", &estimate, "--validate-only"], "");
    assert!(
        checked.output.starts_with("valid, nothing stored"),
        "{}{}",
        checked.output,
        checked.errors
    );
    let done = call(
        &server,
        &["drive", "commit", "arm", &estimate, "--note", "new gear"],
        "",
    );
    assert_eq!(done.code, exit::OK, "{}", done.errors);
    assert!(done.output.contains("changed: a, b.c"), "{}", done.output);
    let shown = call(&server, &["robot", "show", "arm", "--description"], "");
    assert!(
        shown.output.contains("new gear") && shown.output.contains("EstimateFriction"),
        "{}",
        shown.output
    );
    let again = call(
        &server,
        &["drive", "commit", "arm", &estimate, "--note", "new gear"],
        "",
    );
    assert_eq!(again.code, exit::OK, "{}", again.errors);
    let revision = done.output.split_whitespace().nth(3).unwrap();
    assert!(
        again.output.contains("there already") && again.output.contains(revision),
        "{}",
        again.output
    );
    let late = call(&server, &["drive", "commit", "arm", &estimate], "");
    assert_eq!(late.code, exit::USAGE, "with another note it is another revision");
    assert!(late.errors.contains("hint: fit or estimate again"), "{}", late.errors);
}

/// What an estimate has no term for is held while it is made, and stays.
#[test]
fn terms_that_were_not_estimated_stay_and_every_change_is_shown() {
    let server = server();
    let richer = BARE.replace(
        "rotor_inertia_kg_m2: 0.01}",
        "rotor_inertia_kg_m2: 0.01, friction: [{side: JOINT, viscous: 9, coulomb_positive: 3.5, coulomb_negative: 2.5, quadratic: 0.30000000000000004, \
         presliding_stiffness: 9000}]}",
    );
    let said = call(&server, &["robot", "register", "arm", "--description", "-"], &richer);
    assert_eq!(said.code, exit::OK, "{}", said.errors);
    let shown = call(&server, &["robot", "show", "arm"], "").output;
    for part in ["3.5", "2.5", " 0.3 ", "9000", "Coulomb −", "presliding"] {
        assert!(shown.contains(part), "{part}: {shown}");
    }
    let said = call(&server, &["drive", "estimate", "arm", "-", "--json"], &log(8000));
    assert_eq!(said.code, exit::OK, "{}", said.errors);
    let reply: serde_json::Value = serde_json::from_str(&said.output).unwrap();
    let viscous = &reply["joints"][0]["coefficients"][1];
    assert_eq!(viscous["model"], 9.0);
    assert_eq!(viscous["committed"], viscous["value"]);
    let done = call(&server, &["drive", "commit", "arm", "-"], &said.output);
    assert_eq!(done.code, exit::OK, "{}", done.errors);
    let line = |what: &str| {
        let found = done.output.lines().find(|line| line.contains(what));
        found.unwrap_or_else(|| panic!("{what}: {}", done.output)).to_owned()
    };
    for (what, stays) in [
        ("Coulomb +", false),
        ("Coulomb −", false),
        ("viscous", false),
        ("quadratic", true),
        ("presliding", true),
    ] {
        assert_eq!(line(what).contains("stays"), stays, "{}", done.output);
    }
    let warnings: Vec<&str> = done
        .errors
        .lines()
        .filter(|line| line.contains("both directions"))
        .collect();
    assert!(
        warnings.len() == 1 && warnings[0].contains("joints a, b.c"),
        "{}",
        done.errors
    );
    let shown = call(&server, &["robot", "show", "arm"], "").output;
    for part in [
        "9000",
        " 0.3 ",
        "uncertainty: covariance of",
        "origin: EstimateFriction on revision",
    ] {
        assert!(shown.contains(part), "{part}: {shown}");
    }
}

/// Each cell of a log but those of the time and the rest.
fn changed(log: &str, change: impl Fn(&str, f64) -> f64) -> String {
    let mut lines = log.lines();
    let head = lines.next().unwrap();
    let names: Vec<&str> = head.split(',').collect();
    let mut text = format!("{head}\n");
    for line in lines {
        let cells = line.split(',').zip(&names);
        let cells: Vec<String> = cells
            .map(|(cell, name)| change(name, cell.parse().unwrap()).to_string())
            .collect();
        text.push_str(&format!("{}\n", cells.join(",")));
    }
    text
}

#[test]
fn other_units_and_signs_are_hinted_at_by_estimates_and_fits() {
    let server = arm();
    let log = log(8000);
    let is = |name: &str, what: [&str; 2]| what.contains(&name);
    let degrees = changed(&log, |name, value| {
        value
            * if is(name, ["q1", "b.c.position"]) || is(name, ["qd1", "b.c.velocity"]) {
                180.0 / std::f64::consts::PI
            } else {
                1.0
            }
    });
    let against = changed(&log, |name, value| {
        value * if is(name, ["tau1", "b.c.torque"]) { -1.0 } else { 1.0 }
    });
    let slow = changed(&log, |name, value| value * if name == "t" { 1e3 } else { 1.0 });
    // Two joints without mass: their friction is all that the model's torque is.
    let friction = "rotor_inertia_kg_m2: 0.01, friction: [{side: JOINT, viscous: 2, coulomb_positive: 9}]}";
    let rough = BARE.replace("rotor_inertia_kg_m2: 0.01}", friction);
    let said = call(&server, &["robot", "register", "rough", "--description", "-"], &rough);
    assert_eq!(said.code, exit::OK, "{}", said.errors);
    for (text, part) in [
        (&degrees, "is it in degrees?"),
        (&against, "runs against the model's torque"),
        (&slow, "are times milliseconds?"),
        (&log, ""),
    ] {
        let said = call(&server, &["drive", "estimate", "rough", "-"], text);
        let hints: Vec<&str> = said
            .output
            .lines()
            .filter(|line| line.starts_with("warning") && line.contains('?'))
            .collect();
        assert_eq!(hints.len(), usize::from(!part.is_empty()), "{part}: {}", said.output);
        assert!(hints.iter().all(|hint| hint.contains(part)), "{hints:?}");
    }
    let unknown = call(&server, &["drive", "estimate", "arm", "-"], &against).output;
    assert!(unknown.contains("has the torque the right sign?"), "{unknown}");
    let said = call(
        &server,
        &["drive", "fit", "rough", "-", "--scope", "friction"],
        &against,
    );
    assert!(
        said.output.contains("runs against the model's torque"),
        "{}{}",
        said.output,
        said.errors
    );
}

#[test]
fn a_side_that_nothing_tells_apart_is_refused_with_what_would() {
    let server = arm();
    for side in ["joint", "motor"] {
        let said = call(&server, &["drive", "estimate", "arm", "-", "--side", side], &log(200));
        assert_eq!(said.code, exit::USAGE, "{}", said.output);
        for part in ["transmission_torque", "none on any joint", "side total"] {
            assert!(said.errors.contains(part), "{part}: {}", said.errors);
        }
    }
}

#[test]
fn values_that_are_no_numbers_are_counted_and_located() {
    let server = arm();
    let mut row = 0;
    let holes: String = log(6000)
        .lines()
        .map(|line| {
            row += 1;
            let mut cells: Vec<&str> = line.split(',').collect();
            if row % 1000 == 17 {
                cells[3] = "nan";
            }
            cells.join(",") + "\n"
        })
        .collect();
    let sentence = "joint a, torque: 6 values that are no numbers, the first in line 17";
    let fit = call(&server, &["drive", "fit", "arm", "-"], &holes);
    assert_eq!(fit.code, exit::USAGE, "{}", fit.output);
    assert!(fit.errors.contains(sentence), "{}", fit.errors);
    let estimate = call(&server, &["drive", "estimate", "arm", "-"], &holes);
    assert_eq!(estimate.code, exit::OK, "{}", estimate.errors);
    assert!(estimate.errors.contains(sentence), "{}", estimate.errors);
}

#[test]
fn an_estimate_goes_on_from_a_saved_state_and_comes_line_by_line() {
    let server = arm();
    let folder = tempfile::tempdir().unwrap();
    let state = folder.path().join("state.json").to_str().unwrap().to_owned();
    let said = call(
        &server,
        &["drive", "estimate", "arm", "-", "--save-state", &state],
        &log(3000),
    );
    assert_eq!(said.code, exit::OK, "{}{}", said.output, said.errors);
    let rest: String = log(6000)
        .lines()
        .enumerate()
        .filter(|(row, _)| *row == 0 || *row > 3000)
        .map(|(_, line)| format!("{line}\n"))
        .collect();
    let said = call(
        &server,
        &["drive", "estimate", "arm", "-", "--state", &state, "--lines"],
        &rest,
    );
    assert_eq!(said.code, exit::OK, "{}", said.errors);
    let last: serde_json::Value = serde_json::from_str(said.output.lines().next_back().unwrap()).unwrap();
    assert!(said.output.lines().count() > 25);
    assert_eq!(last["sample_count"], "6000");
}

#[test]
fn what_is_wrong_with_a_log_is_said_with_what_to_do() {
    let server = arm();
    for (line, text, code, part) in [
        (vec!["drive", "estimate", "arm", "-"], "x,y\n1,2\n", exit::USAGE, "hint"),
        (vec!["drive", "estimate", "arm", "-"], "t,q1,q3\n", exit::USAGE, "q3"),
        (
            vec!["drive", "estimate", "arm", "-"],
            "t,q1\n0,a\n",
            exit::USAGE,
            "line 2",
        ),
        (
            vec!["drive", "estimate", "arm", "-"],
            "t,q1\n0,1\n",
            exit::USAGE,
            "every joint or for none",
        ),
        (
            vec!["drive", "estimate", "nobody", "-"],
            "",
            exit::USAGE,
            "takt robot list",
        ),
        (vec!["drive", "fit", "arm", "-"], "", exit::USAGE, "empty"),
        (
            vec!["drive", "fit", "arm", "-", "--test", "9..8"],
            "",
            exit::USAGE,
            "not before",
        ),
        (
            vec!["drive", "commit", "arm", "-"],
            "{}",
            exit::USAGE,
            "proposes no change",
        ),
    ] {
        let said = call(&server, &line, text);
        assert_eq!(said.code, code, "{line:?}: {}", said.errors);
        assert!(said.errors.contains(part), "{line:?}: {}", said.errors);
    }
    // Who stands still is told what is missing.
    let still: String = (0..500)
        .map(|index| format!("{},0,0,1,0,0,1\n", f64::from(index) * 1e-3))
        .collect();
    let still = format!("t,q1,qd1,tau1,q2,qd2,tau2\n{still}");
    let said = call(&server, &["drive", "estimate", "arm", "-"], &still);
    assert_eq!(said.code, exit::NO);
    let missing: Vec<&str> = said.output.lines().filter(|line| line.contains("missing:")).collect();
    assert!(
        missing.len() == 1 && missing[0].contains("a, b.c"),
        "one for both: {}",
        said.output
    );
    assert!(said.output.contains("no sample counted"), "{}", said.output);
}
