//! Fits: of a whole arm from a recording, and of one joint from the bench.

use super::{
    call,
    drive::{arm, log, log_of_run},
    exit, server,
};

const FIT: [&str; 6] = ["drive", "fit", "arm", "-", "--scope", "friction"];

#[test]
fn a_recording_is_fitted_and_compared() {
    let server = arm();
    let log = log(9000);
    let line = [&FIT[..], &["--identify", "0..6", "--test", "6.5..8.5"]].concat();
    let said = call(&server, &line, &log);
    assert_eq!(said.code, exit::OK, "{}{}", said.output, said.errors);
    for part in [
        "before, after: on the test part (",
        "viscous",
        "Coulomb +",
        "told: part of the value",
        "takt drive commit arm",
    ] {
        assert!(said.output.contains(part), "{part}: {}", said.output);
    }
    assert!(!said.output.contains("is used of"), "{}", said.output);
    assert!(said.errors.contains("temperature"), "{}", said.errors);
    let json = call(&server, &[&line[..], &["--json"]].concat(), &log);
    let done = call(&server, &["drive", "commit", "arm", "-"], &json.output);
    assert_eq!(done.code, exit::OK, "{}", done.errors);
    assert!(!done.output.contains("bodies"), "{}", done.output);
}

#[test]
fn what_a_fit_changes_of_rotors_is_listed_by_the_commit() {
    let server = arm();
    let line = ["drive", "fit", "arm", "-", "--scope", "rotors", "--json"];
    let json = call(&server, &line, &log(9000));
    let done = call(&server, &["drive", "commit", "arm", "-"], &json.output);
    assert_eq!(done.code, exit::OK, "{}", done.errors);
    for part in ["rotor, reflected", "becomes", "robot show arm --description"] {
        assert!(done.output.contains(part), "{part}: {}", done.output);
    }
}

#[test]
fn what_a_fit_warns_of_is_said_beside_json_and_before_a_commit() {
    let server = arm();
    let line = [&FIT[..], &["--identify", "0..6", "--test", "6.5..20", "--json"]].concat();
    let json = call(&server, &line, &log(9000));
    assert_eq!(json.code, exit::OK, "{}", json.errors);
    let warning = "is used of the 6.5 to 20 s";
    assert!(
        json.errors.contains("warning: ") && json.errors.contains(warning),
        "{}",
        json.errors
    );
    let reply: serde_json::Value = serde_json::from_str(&json.output).unwrap();
    assert!(reply["proposal"].is_object(), "standard output is the reply alone");
    let done = call(&server, &["drive", "commit", "arm", "-"], &json.output);
    assert_eq!(done.code, exit::OK, "{}", done.errors);
    assert_eq!(done.errors.matches(warning).count(), 1, "{}", done.errors);
}

#[test]
fn without_a_test_part_there_are_no_columns_of_one() {
    let said = call(&arm(), &FIT, &log(6000));
    assert_eq!(said.code, exit::OK, "{}{}", said.output, said.errors);
    assert!(!said.output.contains("covered"), "{}", said.output);
    assert!(said.output.contains("--identify and --test"), "{}", said.output);
}

#[test]
fn a_test_part_that_was_fitted_is_refused_and_a_log_that_ends_early_is_told() {
    let server = arm();
    let log = log(9000);
    let ask = |more: &[&str]| call(&server, &[&FIT[..], more].concat(), &log);
    let both = ask(&["--identify", "0..6", "--test", "5..8"]);
    assert_eq!(both.code, exit::USAGE, "{}", both.output);
    assert!(both.errors.contains("5 to 6 s are in both"), "{}", both.errors);
    let alone = ask(&["--test", "5..8"]);
    assert_eq!(alone.code, exit::USAGE);
    assert!(alone.errors.contains("--identify"), "{}", alone.errors);
    let colon = ask(&["--identify", "0:6"]);
    assert!(colon.errors.contains("as in 0..8 or 500ms..2s"), "{}", colon.errors);
    let late = ask(&["--identify", "0 .. 6s", "--test", "6.5..20"]);
    assert_eq!(late.code, exit::OK, "{}", late.errors);
    assert!(
        late.output.contains("test: 6.5 to 8.999 s is used of the 6.5 to 20 s"),
        "{}",
        late.output
    );
}

#[test]
fn another_log_is_compared_with_in_its_own_times() {
    let server = arm();
    let folder = tempfile::tempdir().unwrap();
    let other = folder.path().join("other.csv");
    std::fs::write(&other, log_of_run(3000, 0.4)).unwrap();
    let other = other.to_str().unwrap();
    let log = log(6000);
    let ask = |more: &[&str]| call(&server, &[&FIT[..], &["--test-log", other], more].concat(), &log);
    let whole = ask(&[]);
    assert_eq!(whole.code, exit::OK, "{}{}", whole.output, whole.errors);
    assert!(
        whole.output.contains(&format!("on the log {other} (")),
        "{}",
        whole.output
    );
    let late = ask(&["--test", "0.5..20"]);
    assert_eq!(late.code, exit::OK, "{}", late.errors);
    assert!(
        late.output.contains("test: 0.5 to 2.999 s is used of the 0.5 to 20 s"),
        "{}",
        late.output
    );
    std::fs::write(other, &log).unwrap();
    let fitted = ask(&["--identify", "0..4", "--test", "3..5"]);
    assert_eq!(fitted.code, exit::USAGE, "{}", fitted.output);
    assert!(
        fitted.errors.contains("has the samples of `recording`") && fitted.errors.contains("3 to 4 s are in both"),
        "{}",
        fitted.errors
    );
    std::fs::write(other, "t,q1,q2\n0,,1\n1,nan,1\n").unwrap();
    let broken = ask(&[]);
    assert_eq!(broken.code, exit::USAGE, "{}", broken.output);
    for part in ["2 values that are no numbers", "of the test log"] {
        assert!(broken.errors.contains(part), "{part}: {}", broken.errors);
    }
}

/// A spring of 12 kN m/rad with a cube, and a torque sensor that is off by half a newton metre.
fn spring() -> String {
    let rows = (-10..=10).map(|step| {
        let at = f64::from(step) * 1e-4;
        format!("{},{at}\n", 12_000.0 * at + 3e9 * at.powi(3) + 0.5)
    });
    format!("torque,deformation\n{}", rows.collect::<String>())
}

/// Maxima that fall by a fifth each time, without Coulomb friction.
fn swing() -> String {
    let rows = (0..5).map(|step| format!("{},{}\n", 0.02 * f64::from(step), 1e-3 * 0.8_f64.powi(step)));
    format!("t,amplitude\n{}", rows.collect::<String>())
}

/// 3 N m s/rad, 5 N m one way and 4 N m the other.
fn runs() -> String {
    let rows = [-2.0, -1.0, -0.5, 0.5, 1.0, 2.0_f64]
        .map(|speed| format!("{},{speed}\n", 3.0 * speed + if speed > 0.0 { 5.0 } else { -4.0 }));
    format!("motor_torque,speed\n{}", rows.concat())
}

#[test]
fn one_joint_on_the_bench_is_fitted_and_committed() {
    let server = server();
    let line = |kind| ["drive", kind, "scara", "-", "--joint", "shoulder"];
    for (kind, more, text, parts) in [
        (
            "fit-stiffness",
            &["--terms", "2"][..],
            spring(),
            ["12000", "N m/rad^3", "taken off: 0.500 N m"],
        ),
        (
            "fit-damping",
            &[],
            swing(),
            ["damping of the transmission", "N m s/rad", "period 20.00 ms"],
        ),
        (
            "fit-constant-speed",
            &[],
            runs(),
            ["3.0000", "5.0000", "not told apart"],
        ),
    ] {
        let line = [&line(kind)[..], more].concat();
        let said = call(&server, &line, &text);
        assert_eq!(said.code, exit::OK, "{kind}: {}{}", said.output, said.errors);
        for part in parts.into_iter().chain(["changes shoulder"]) {
            assert!(said.output.contains(part), "{kind}: {part}: {}", said.output);
        }
        for transport in ["grpc", "http"] {
            let line = [&["--transport", transport], &line[..], &["--json"]].concat();
            let fit = call(&server, &line, &text);
            let valid = call(
                &server,
                &["drive", "commit", "scara", "-", "--validate-only"],
                &fit.output,
            );
            assert_eq!(valid.code, exit::OK, "{kind}: {}", valid.errors);
        }
    }
}

#[test]
fn what_the_bench_does_not_tell_is_said() {
    let server = server();
    let ask =
        |kind: &str, joint: &str, text: &str| call(&server, &["drive", kind, "scara", "-", "--joint", joint], text);
    let two = ask("fit-damping", "shoulder", "time_s,amplitude\n0,0.001\n0.02,0.0008\n");
    assert_eq!(two.code, exit::NO, "{}", two.errors);
    assert!(two.output.contains("measurements do not say enough"), "{}", two.output);
    for (kind, joint, text, part) in [
        ("fit-damping", "shoulder", "time_s\n0\n", "no column amplitude"),
        (
            "fit-stiffness",
            "shoulder",
            "torque,deformation\n1,\n",
            "line 2, column deformation",
        ),
        ("fit-stiffness", "tail", &spring(), "no joint"),
        (
            "fit-constant-speed",
            "shoulder",
            "speed,motor_torque\nfast,1\n",
            "\"fast\" is no number",
        ),
    ] {
        let said = ask(kind, joint, text);
        assert_eq!(said.code, exit::USAGE, "{kind}: {}", said.output);
        assert!(said.errors.contains(part), "{kind}: {}", said.errors);
    }
}
