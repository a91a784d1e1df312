//! Rehearsals, and what motors are to do.

use super::{call, exit, program, server};

const MOVE: [&str; 8] = [
    "rehearse",
    "scara",
    "--from",
    "-1,1,0.1,0",
    "--to",
    "-0.5,0.6,0.12,0.4",
    "--friction",
    "1.5",
];

#[test]
fn a_move_is_rehearsed_side_by_side() {
    let server = server();
    let folder = tempfile::tempdir().unwrap();
    let svg = folder.path().join("a.svg").to_str().unwrap().to_owned();
    let more = ["--drift", "shoulder=0.1", "--settle", "200ms", "--plot", "--svg", &svg];
    let said = call(&server, &[&MOVE[..], &more].concat(), "");
    assert_eq!(said.code, exit::OK, "{}{}", said.output, said.errors);
    for part in [
        "model",
        "adapted",
        "planned",
        "at limit: time that the limit",
        "friction off: assumed less true",
        "tool off by",
        "off, adapted [rad]",
    ] {
        assert!(said.output.contains(part), "{part}: {}", said.output);
    }
    assert!(
        !said.output.contains("counts as stiff"),
        "every joint is rigid: {}",
        said.output
    );
    let picture = std::fs::read_to_string(svg).unwrap();
    assert!(picture.contains("distance from the plan") && !picture.contains("limit in force"));
    let json = call(&server, &[&MOVE[..], &["--json"]].concat(), "");
    let reply: serde_json::Value = serde_json::from_str(&json.output).unwrap();
    assert_eq!(reply["rehearsal"]["adapted"]["end"], "COMPLETED");
    let far = call(
        &server,
        &["rehearse", "scara", "--from", "-1,1,0.1,0", "--to", "9,0,0,0"],
        "",
    );
    assert_eq!(far.code, exit::USAGE, "{}", far.errors);
}

/// README's example: adaptation is worth seeing on an arm whose model has friction.
#[test]
fn the_example_of_the_readme_shows_what_adaptation_is_worth() {
    let server = server();
    let program = program("scara_pick_and_place");
    let line = [
        "rehearse",
        "scara",
        "--program",
        &program,
        "--friction",
        "150%",
        "--json",
    ];
    let said = call(&server, &line, "");
    assert_eq!(said.code, exit::OK, "{}{}", said.output, said.errors);
    let reply: serde_json::Value = serde_json::from_str(&said.output).unwrap();
    let error = |run: &str| reply["rehearsal"][run]["tool_error_rms_m"].as_f64().unwrap();
    assert!(
        error("adapted") < 0.3 * error("plain"),
        "{} {}",
        error("adapted"),
        error("plain")
    );
    let wrong = call(
        &server,
        &["rehearse", "scara", "--program", &program, "--friction", "much"],
        "",
    );
    assert_eq!(wrong.code, exit::USAGE);
    assert!(wrong.errors.contains("1.5 or 150%"), "{}", wrong.errors);
}

#[test]
fn joints_without_friction_are_named_once() {
    let server = server();
    let line = [
        "rehearse",
        "ur5e",
        "--from",
        "0,-1.5,0,0,0,0",
        "--to",
        "0.3,-1.2,0,0,0,0",
        "--friction",
        "1.5",
    ];
    let said = call(&server, &line, "");
    assert_eq!(said.code, exit::OK, "{}", said.errors);
    assert_eq!(said.output.matches("changes nothing").count(), 1, "{}", said.output);
    assert!(said.output.contains("\"wrist_3_joint\""), "{}", said.output);
}

#[test]
fn motors_have_columns_in_a_stream_as_in_a_plan() {
    let server = server();
    let more = ["--sample-period", "4ms", "--motors"];
    let of_scara = |command: &[&'static str]| [command, &["scara"][..], &MOVE[2..6]].concat();
    let plan = call(
        &server,
        &[&of_scara(&["plan", "move"])[..], &more, &["--csv"]].concat(),
        "",
    );
    assert_eq!(plan.code, exit::OK, "{}", plan.errors);
    assert!(plan.output.contains("shoulder.motor_torque"), "{}", plan.output);
    let stream = call(&server, &[&of_scara(&["setpoints"])[..], &more].concat(), "");
    assert_eq!(stream.output, plan.output, "{}", stream.errors);
    let warned = "warning: jerk limits do not apply";
    assert!(stream.errors.contains(warned), "{}", stream.errors);
}

#[test]
fn plain_numbers_are_degrees_where_asked_for() {
    let server = server();
    let degrees = ["--degrees", "--from", "-60,60,0.1,0", "--to", "-30,35,0.12,20"];
    let units = ["--from", "-60deg,60deg,0.1,0", "--to", "-30deg,35deg,0.12,20deg"];
    for (command, more) in [
        ("rehearse", &["--friction", "150%", "--json"][..]),
        ("setpoints", &["--sample-period", "20ms"]),
    ] {
        let ask = |motion: &[&str]| call(&server, &[&[command, "scara"], motion, more].concat(), "");
        let (asked, same) = (ask(&degrees), ask(&units));
        assert_eq!(asked.code, exit::OK, "{command}: {}", asked.errors);
        assert_eq!(asked.output, same.output, "{command}: those that slide stay in m");
    }
    let table = call(&server, &[&["rehearse", "scara"][..], &degrees].concat(), "");
    assert!(
        table.output.contains(" deg ") && !table.output.contains(" rad "),
        "{}",
        table.output
    );
}

#[test]
fn an_arm_that_does_not_follow_is_a_no_and_says_which_joint() {
    let server = server();
    let line = |friction| [&MOVE[..6], &["--friction", friction]].concat();
    let plain = call(&server, &line("50"), "");
    assert_eq!(plain.code, exit::USAGE, "{}", plain.output);
    assert!(
        plain.errors.contains("write it as 50% or 0.5; it is a ratio"),
        "{}",
        plain.errors
    );
    for json in [&[][..], &["--json"]] {
        let stuck = call(&server, &[&line("5000%")[..], json].concat(), "");
        assert_eq!(stuck.code, exit::NO, "{}{}", stuck.output, stuck.errors);
        assert!(
            stuck.errors.contains("did not follow: shoulder was"),
            "{}",
            stuck.errors
        );
    }
}
