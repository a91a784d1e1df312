//! Whole commands, in-process, against a server in the same process.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

#[path = "commands/drive.rs"]
mod drive;
#[path = "commands/fit.rs"]
mod fit;
#[path = "commands/rehearse.rs"]
mod rehearse;

use std::{
    ffi::OsString,
    io::{self, Cursor, Write},
    sync::{Arc, Mutex, mpsc},
    thread,
};

use takt_cli::{Io, Terminal, exit, run};
use takt_server::{Config, Server};

/// What a command said.
struct Said {
    code: u8,
    output: String,
    errors: String,
}

#[derive(Clone, Default)]
struct Sink(Arc<Mutex<Vec<u8>>>);

impl Sink {
    fn text(&self) -> String {
        String::from_utf8(self.0.lock().unwrap().clone()).unwrap()
    }
}

impl Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap().extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// A reader that went away.
struct Gone;

impl Write for Gone {
    fn write(&mut self, _: &[u8]) -> io::Result<usize> {
        Err(io::ErrorKind::BrokenPipe.into())
    }

    fn flush(&mut self) -> io::Result<()> {
        Err(io::ErrorKind::BrokenPipe.into())
    }
}

fn call(server: &str, line: &[&str], input: &str) -> Said {
    let (output, errors) = (Sink::default(), Sink::default());
    let code = call_into(server, line, input, Box::new(output.clone()), Box::new(errors.clone()));
    Said {
        code,
        output: output.text(),
        errors: errors.text(),
    }
}

fn call_into(server: &str, line: &[&str], input: &str, output: Box<dyn Write>, errors: Box<dyn Write>) -> u8 {
    let mut io = Io {
        input: Box::new(Cursor::new(input.to_owned())),
        output,
        errors,
        terminal: Terminal {
            width: 80,
            table_width: None,
            colour: false,
            error_colour: false,
        },
    };
    let all = ["takt", "--server", server]
        .into_iter()
        .chain(line.iter().copied())
        .map(OsString::from);
    run(all, &mut io)
}

/// Starts a server that lives as long as the test's process.
fn server() -> String {
    let (tell, told) = mpsc::channel();
    thread::spawn(move || {
        let runtime = tokio::runtime::Builder::new_multi_thread()
            .worker_threads(1)
            .enable_all()
            .build()
            .unwrap();
        runtime.block_on(async {
            let config = Config {
                examples: true,
                ..Config::default()
            };
            let server = Server::bind(config).await.unwrap();
            tell.send(server.local_addr()).unwrap();
            server.run(std::future::pending()).await;
        });
    });
    format!("http://{}", told.recv().unwrap())
}

/// Two joints in a vertical plane.
const ARM: &str = r#"
dh:
  convention: STANDARD
  links:
  - {name: shoulder, type: REVOLUTE, a_m: 0.5, alpha_rad: 0, d_m: 0, theta_rad: 0, mass_kg: 4,
     center_of_mass_m: [-0.25, 0, 0], inertia_kg_m2: [0.01, 0.08, 0.08, 0, 0, 0]}
  - {name: elbow, type: REVOLUTE, a_m: 0.5, alpha_rad: 0, d_m: 0, theta_rad: 0, mass_kg: 2,
     center_of_mass_m: [-0.25, 0, 0], inertia_kg_m2: [0.01, 0.04, 0.04, 0, 0, 0]}
joints:
- {name: shoulder, limits: {position_lower: -3, position_upper: 3, velocity: 3}, drive: {peak_torque: 80}}
- {name: elbow, limits: {position_lower: -3, position_upper: 3, velocity: 4}, drive: {peak_torque: 30}}
gravity_m_per_s2: [0, -9.81, 0]
"#;

const MOVE: [&str; 7] = ["plan", "move", "arm", "--from", "-90deg,0", "--to", "0.2,-0.5rad"];

fn with<'a>(line: &[&'a str], more: &[&'a str]) -> Vec<&'a str> {
    line.iter().chain(more).copied().collect()
}

/// A server that knows the arm.
fn cell() -> String {
    let server = server();
    let said = call(&server, &["robot", "register", "arm", "--description", "-"], ARM);
    assert_eq!(said.code, exit::OK, "{}", said.errors);
    assert!(said.output.starts_with("registered: arm revision "), "{}", said.output);
    server
}

#[test]
fn a_robot_is_registered_shown_and_deleted_over_both_transports() {
    let server = cell();
    for transport in ["grpc", "http"] {
        let ask = |line: &[&str]| call(&server, &with(&["--transport", transport], line), "");
        assert!(ask(&["robot", "list"]).output.contains("arm "));
        assert!(ask(&["robot", "show", "arm"]).output.contains("elbow"));
        assert_eq!(ask(&["robot", "show", "arm", "--revisions"]).output.lines().count(), 1);
        let again = ask(&["robot", "show", "arm", "--description"]).output;
        let twin = call(&server, &["robot", "register", "twin", "--description", "-"], &again);
        assert_eq!(twin.code, exit::OK, "{}", twin.errors);
        let wrong = ask(&["robot", "delete", "twin", "--expected-revision", "0"]);
        assert_eq!(wrong.code, exit::USAGE);
        assert_eq!(ask(&["robot", "delete", "twin"]).output, "deleted twin\n");
        let gone = ask(&["robot", "show", "twin"]);
        assert_eq!(gone.code, exit::USAGE);
        assert!(gone.errors.contains("takt robot list"), "{}", gone.errors);
    }
}

#[test]
fn a_plan_is_told_drawn_and_written() {
    let server = cell();
    let folder = tempfile::tempdir().unwrap();
    let (svg, html) = (folder.path().join("a.svg"), folder.path().join("a.html"));
    let files = [
        "--plot",
        "--svg",
        svg.to_str().unwrap(),
        "--html",
        html.to_str().unwrap(),
    ];
    let said = call(&server, &with(&MOVE, &files), "");
    assert_eq!(said.code, exit::OK, "{}", said.errors);
    for part in [
        "duration",
        "by the conventional pattern",
        "limited by",
        "margin",
        "velocity [rad/s]",
        "⠉",
    ] {
        assert!(said.output.contains(part), "{part:?} is not in\n{}", said.output);
    }
    assert_eq!(std::fs::read_to_string(svg).unwrap().matches("<polyline").count(), 4);
    assert!(std::fs::read_to_string(html).unwrap().contains("Torque margins"));
}

/// The example programs, as they stand in the documentation.
const PROGRAMS: [&str; 3] = ["pick_and_place", "welding_seam", "glue_bead"];

fn program(name: &str) -> String {
    format!("{}/../examples/{name}.yaml", env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn the_example_programs_can_be_run() {
    let server = server();
    for name in PROGRAMS {
        let said = call(&server, &["plan", "path", "ur5e", &program(name)], "");
        assert_eq!(said.code, exit::OK, "{name}: {}{}", said.output, said.errors);
        for part in ["duration", "segments", "taught [m]", "margin", "ur5e revision"] {
            assert!(
                said.output.contains(part),
                "{name}: {part:?} is not in\n{}",
                said.output
            );
        }
    }
}

#[test]
fn a_program_is_drawn_written_and_printed_for_controllers() {
    let server = server();
    let folder = tempfile::tempdir().unwrap();
    let (svg, html) = (folder.path().join("a.svg"), folder.path().join("a.html"));
    let program = program("glue_bead");
    let line = ["plan", "path", "ur5e", &program];
    let files = [
        "--plot",
        "--svg",
        svg.to_str().unwrap(),
        "--html",
        html.to_str().unwrap(),
    ];
    let said = call(&server, &with(&line, &files), "");
    assert_eq!(said.code, exit::OK, "{}", said.errors);
    assert!(said.output.contains("velocity [rad/s]"), "{}", said.output);
    let svg = std::fs::read_to_string(svg).unwrap();
    assert_eq!(svg.matches("<polyline").count(), 1 + 12, "the tool and six joints");
    assert!(svg.contains("speed of the tool [m/s]") && said.output.contains("speed of the tool [m/s]"));
    assert!(
        std::fs::read_to_string(html)
            .unwrap()
            .contains("tightest moment of every limit")
    );
    let csv = call(&server, &with(&line, &["--sample-period", "8ms", "--csv"]), "").output;
    assert!(
        csv.lines()
            .next()
            .unwrap()
            .ends_with("segment,fraction,tool_speed_m_per_s")
    );
    let ros = call(&server, &with(&line, &["--sample-period", "8ms", "--ros"]), "").output;
    let ros: serde_json::Value = serde_json::from_str(&ros).unwrap();
    assert_eq!(ros["points"].as_array().unwrap().len(), csv.lines().count() - 1);
    assert_eq!(ros["points"][1]["time_from_start"]["nanosec"], 8_000_000);
    let stream = ["setpoints", "ur5e", "--program", &program, "--sample-period", "8ms"];
    for transport in ["grpc", "http"] {
        let streamed = call(&server, &with(&["--transport", transport], &stream), "");
        assert_eq!(
            (streamed.code, &streamed.output),
            (exit::OK, &csv),
            "{}",
            streamed.errors
        );
    }
    let parts = call(&server, &with(&stream, &["--json", "--chunk", "100"]), "").output;
    let mut parts = parts
        .lines()
        .map(|part| serde_json::from_str::<serde_json::Value>(part).unwrap());
    let header = parts.next().unwrap();
    assert!(header["path"]["plan"]["duration_s"].is_number());
    let counts = parts.map(|chunk| chunk["setpoints"]["time_s"].as_array().unwrap().len());
    assert_eq!(counts.sum::<usize>(), csv.lines().count() - 1);
    let asked = call(&server, &with(&line, &["--ros"]), "");
    assert_eq!(asked.code, exit::USAGE);
    assert!(asked.errors.contains("--sample-period"), "{}", asked.errors);
}

#[test]
fn a_program_that_cannot_be_run_says_where() {
    let server = server();
    let text = std::fs::read_to_string(program("pick_and_place")).unwrap();
    let far = text.replace("[-0.45, -0.25, 0.12]", "[-4.5, -0.25, 0.12]");
    assert_ne!(text, far);
    let said = call(&server, &["plan", "path", "ur5e", "-"], &far);
    assert_eq!(said.code, exit::NO, "{}", said.errors);
    assert!(
        said.output.contains("infeasible") && said.output.contains("segment 4"),
        "{}",
        said.output
    );
    let heavy = text.replace("mass_kg: 1.5", "mass_kg: 40");
    assert_ne!(text, heavy);
    let said = call(&server, &["plan", "path", "ur5e", "-"], &heavy);
    assert_eq!(said.code, exit::NO, "{}", said.errors);
    assert!(
        said.output.contains("kg would do") && said.output.contains("carry at most"),
        "{}",
        said.output
    );
    let wrong = text.replace("blend: {radius_m: 0.05}", "blend: {radius: 0.05}");
    let said = call(&server, &["plan", "path", "ur5e", "-"], &wrong);
    assert_eq!(said.code, exit::USAGE);
    assert!(said.errors.contains("radius"), "{}", said.errors);
    let streamed = call(
        &server,
        &["setpoints", "ur5e", "--program", "-", "--sample-period", "8ms"],
        &far,
    );
    assert_eq!((streamed.code, streamed.output.as_str()), (exit::NO, ""));
    assert!(streamed.errors.contains("infeasible"), "{}", streamed.errors);
}

#[test]
fn a_pose_has_its_solutions() {
    let server = server();
    let ask = |line: &[&str]| call(&server, &with(&["ik", "ur5e"], line), "");
    let down = ask(&["--pose", "-0.4,-0.2,0.3", "--rpy", "180deg,0,0"]);
    assert_eq!(down.code, exit::OK, "{}", down.errors);
    assert!(down.output.lines().count() > 4, "{}", down.output);
    let same = ask(&["--pose", "-0.4,-0.2,0.3,1,0,0,0"]);
    assert_eq!(same.output, down.output);
    let degrees = ask(&["--pose", "-0.4,-0.2,0.3", "--rpy", "180,0,0", "--degrees"]);
    assert!(degrees.output.contains("[deg]"), "{}", degrees.output);
    let far = ask(&["--pose", "4,0,0"]);
    assert_eq!(far.code, exit::NO);
    assert!(far.output.contains("out of reach"), "{}", far.output);
    for wrong in [&["--pose", "1,2"][..], &["--pose", "0,0,0,0,0,0,1", "--rpy", "0,0,0"]] {
        assert_eq!(ask(wrong).code, exit::USAGE);
    }
}

#[test]
fn a_batch_is_answered_line_by_line() {
    let server = cell();
    let line = |id: &str, to: f64| {
        format!(
            r#"{{"id": "{id}", "move": {{"start": {{"position": [-1.5, 0]}}, "target": {{"position": [{to}, -0.5]}}}}}}"#
        )
    };
    let good = [line("a", 0.1), line("b", 0.2)].join("\n");
    let said = call(&server, &["plan", "batch", "arm", "-", "--ordered"], &good);
    assert_eq!(said.code, exit::OK, "{}", said.errors);
    let ids: Vec<String> = said
        .output
        .lines()
        .map(|line| {
            serde_json::from_str::<serde_json::Value>(line).unwrap()["id"]
                .as_str()
                .unwrap()
                .to_owned()
        })
        .collect();
    assert_eq!(ids, ["a", "b"]);
    assert_eq!(said.errors, "2 requests: 2 plans\n");
    let mixed = format!("{good}\n{}\nnonsense\n{}", line("far", 99.0), line("c", 0.3));
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("moves.jsonl");
    std::fs::write(&file, mixed).unwrap();
    for transport in ["grpc", "http"] {
        let said = call(
            &server,
            &["--transport", transport, "plan", "batch", "arm", file.to_str().unwrap()],
            "",
        );
        assert_eq!(said.code, exit::USAGE, "{}", said.errors);
        assert_eq!(said.output.lines().count(), 5);
        let unread = said
            .output
            .lines()
            .find(|answer| answer.contains("line 4 cannot be read"));
        let unread: serde_json::Value = serde_json::from_str(unread.unwrap()).unwrap();
        assert_eq!(unread["index"], 3);
        assert!(
            said.errors.ends_with("5 requests: 3 plans, 2 wrong\n"),
            "{}",
            said.errors
        );
    }
}

#[test]
fn both_transports_print_the_same_reply() {
    let server = cell();
    let line = with(&MOVE, &["--sample-period", "4ms", "--json"]);
    let grpc = call(&server, &with(&["--transport", "grpc"], &line), "");
    let http = call(&server, &with(&["--transport", "http"], &line), "");
    assert_eq!(grpc.code, exit::OK, "{}", grpc.errors);
    assert_eq!(grpc.output, http.output);
    let reply: serde_json::Value = serde_json::from_str(&grpc.output).unwrap();
    assert!(reply["plan"]["setpoints"]["time_s"].as_array().unwrap().len() > 10);
}

#[test]
fn a_plan_can_be_checked_as_json_and_as_csv() {
    let server = cell();
    let gentle = with(&MOVE, &["--utilization", "0.6", "--sample-period", "4ms"]);
    for form in ["--json", "--csv"] {
        let plan = call(&server, &with(&gentle, &[form]), "");
        assert_eq!(plan.code, exit::OK, "{}", plan.errors);
        let said = call(
            &server,
            &["check", "arm", "-", "--interpolation", "cubic"],
            &plan.output,
        );
        assert_eq!(said.code, exit::OK, "{form}: {}{}", said.output, said.errors);
        assert!(said.output.starts_with("holds"), "{}", said.output);
        let tight = call(
            &server,
            &["check", "arm", "-", "--limit", "elbow.velocity=0.1"],
            &plan.output,
        );
        assert_eq!(tight.code, exit::NO);
        assert!(
            tight.output.contains("does not hold") && tight.output.contains("% over"),
            "{}",
            tight.output
        );
    }
    let trace = call(&server, &with(&MOVE, &["--trace", "50", "--csv"]), "");
    let said = call(&server, &["check", "arm", "-"], &trace.output);
    assert_eq!(said.code, exit::USAGE);
    assert!(said.errors.contains("--sample-period"), "{}", said.errors);
}

#[test]
fn an_infeasible_move_shows_its_evidence_and_exits_with_no() {
    let server = cell();
    let said = call(&server, &with(&MOVE, &["--payload", "50"]), "");
    assert_eq!(said.code, exit::NO, "{}", said.errors);
    for part in ["infeasible:", "needed", "available", "remedy"] {
        assert!(said.output.contains(part), "{part:?} is not in\n{}", said.output);
    }
    let json = call(&server, &with(&MOVE, &["--payload", "50", "--json"]), "");
    assert_eq!(json.code, exit::NO);
    assert!(json.output.contains("\"infeasible\""));
    let csv = call(&server, &with(&MOVE, &["--payload", "50", "--csv", "--trace", "9"]), "");
    assert_eq!((csv.code, csv.output.as_str()), (exit::NO, ""));
}

#[test]
fn a_request_can_come_from_standard_input() {
    let server = cell();
    let request = r#"{"start": {"position": [0, 0]}, "target": {"position": [0.5, 0.5]}, "speed_scale": 0.5}"#;
    let said = call(&server, &["plan", "move", "arm", "--request", "-", "--json"], request);
    assert_eq!(said.code, exit::OK, "{}", said.errors);
    assert!(said.output.contains("\"speed_scale\": 0.5"), "{}", said.output);
    let wrong = call(&server, &["plan", "move", "arm", "--request", "-"], r#"{"starts": {}}"#);
    assert_eq!(wrong.code, exit::USAGE);
    assert!(
        wrong.errors.contains("standard input") && wrong.errors.contains("starts"),
        "{}",
        wrong.errors
    );
}

#[test]
fn dynamics_and_poses_are_tabled() {
    let server = cell();
    let said = call(
        &server,
        &["dynamics", "arm", "--degrees", "--position", "0,0", "--mass-matrix"],
        "",
    );
    assert_eq!(said.code, exit::OK, "{}", said.errors);
    // (4 · 0.25 + 2 · 0.75) · 9.81 N m at the shoulder.
    assert!(
        said.output.contains("24.525") && said.output.contains("mass matrix"),
        "{}",
        said.output
    );
    let said = call(&server, &["pose", "arm", "--position", "0,0"], "");
    assert!(said.output.contains("1.000000"), "{}", said.output);
}

#[test]
fn every_wrong_field_is_named_on_its_own_line() {
    let server = cell();
    for transport in ["grpc", "http"] {
        let line = [
            "--transport",
            transport,
            "plan",
            "move",
            "arm",
            "--from",
            "0,0",
            "--to",
            "9,-9",
        ];
        let said = call(&server, &line, "");
        assert_eq!(said.code, exit::USAGE);
        assert!(
            said.errors.lines().any(|line| line.starts_with("  target.position[1]")),
            "{}",
            said.errors
        );
        assert_eq!(said.output, "");
    }
}

#[test]
fn exit_codes_tell_the_failures_apart() {
    let nowhere = {
        let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
        format!("http://{}", listener.local_addr().unwrap())
    };
    for (line, code, part) in [
        (&["robot", "list"][..], exit::SERVICE, "takt serve --examples"),
        (&["robot", "register", "a"], exit::USAGE, "--urdf"),
        (
            &["robot", "register", "a", "--urdf", "/no/such.urdf"],
            exit::USAGE,
            "/no/such.urdf",
        ),
        (
            &["plan", "move", "a", "--from", "0,x", "--to", "1"],
            exit::USAGE,
            "\"x\" is no number",
        ),
        (
            &["plan", "move", "a", "--from", "0", "--to", "1", "--csv"],
            exit::USAGE,
            "--sample-period",
        ),
        (
            &["plan", "move", "a", "--from", "0", "--to", "1", "--json", "--csv"],
            exit::USAGE,
            "--csv",
        ),
        (&["--timeout", "0", "robot", "list"], exit::USAGE, "longer than zero"),
        (&["fly"], exit::USAGE, "fly"),
    ] {
        let said = call(&nowhere, line, "");
        assert_eq!(said.code, code, "{line:?}: {}", said.errors);
        assert!(said.errors.contains(part), "{line:?}: {}", said.errors);
        assert_eq!(said.output, "", "{line:?}");
    }
    let said = call("https://127.0.0.1:1", &["robot", "list"], "");
    assert_eq!(said.code, exit::USAGE);
    let said = call(&nowhere, &["plan", "move", "--help"], "");
    assert_eq!(said.code, exit::OK);
    assert!(said.output.contains("Examples:") && said.errors.is_empty());
}

#[test]
fn a_reader_that_went_away_is_no_failure() {
    let server = cell();
    for line in [&["robot", "list"][..], &["completions", "bash"], &["--help"]] {
        let errors = Sink::default();
        let code = call_into(&server, line, "", Box::new(Gone), Box::new(errors.clone()));
        assert_eq!((code, errors.text().as_str()), (exit::OK, ""), "{line:?}");
    }
}
