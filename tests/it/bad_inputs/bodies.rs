//! Bodies over HTTP that are no message.

use takt_tests::fixtures::good_move;

use super::{HttpRequest, INVALID, Over, Row, TOO_LARGE};

const JSON: &str = "application/json";

fn sent(name: &str, path: &str, kind: &str, body: impl Into<Vec<u8>>, fields: &[&str]) -> Row {
    let request = HttpRequest {
        method: "POST",
        path: path.to_owned(),
        headers: vec![("content-type", kind.to_owned())],
        body: body.into(),
    };
    Row::new(&format!("body: {name}"), Over::Http(request), INVALID, fields)
}

fn row(name: &str, body: impl Into<Vec<u8>>, fields: &[&str]) -> Row {
    sent(name, "/v1/robots/ur5e:planMove", JSON, body, fields)
}

/// The good move with one member more.
fn with(name: &str, member: &str, field: &str) -> Row {
    let good = good();
    let body = format!("{},{member}}}", good.trim_end_matches('}').to_owned() + "}");
    let fields: &[&str] = if field.is_empty() { &[] } else { &[field] };
    row(name, body, fields)
}

fn good() -> String {
    let request = takt_proto::v1::PlanMoveRequest {
        robot_id: String::new(),
        ..good_move()
    };
    let mut json = serde_json::to_value(request).expect("a request can be written");
    let object = json.as_object_mut().expect("a message is an object");
    object.retain(|name, _| name == "start" || name == "target");
    json.to_string()
}

pub(super) fn rows() -> Vec<Row> {
    let mut rows = documents();
    rows.extend(members());
    rows.extend(sizes());
    rows.extend(kinds());
    rows
}

fn documents() -> Vec<Row> {
    let nested = |open: &str, close: &str| open.repeat(100_000) + &close.repeat(100_000);
    let mut utf16 = vec![0xff, 0xfe];
    utf16.extend(good().encode_utf16().flat_map(u16::to_le_bytes));
    let mut cut = good();
    cut.truncate(30);
    vec![
        row("nothing", "", &[]),
        row("a blank", " ", &[]),
        row("a word", "nonsense", &[]),
        row("null", "null", &[]),
        row("a number", "7", &[]),
        row("a text", "\"start\"", &[]),
        row("a list", "[]", &[]),
        row("a brace", "{", &[]),
        row("half a body", cut, &["start.position"]),
        row("two documents", good() + &good(), &[]),
        row("a comma at the end", good().replace("}}", "},}"), &[]),
        row("a comment", format!("/* */{}", good()), &[]),
        row("single quotes", good().replace('"', "'"), &[]),
        row("a byte order mark", format!("\u{feff}{}", good()), &[]),
        row("UTF-16", utf16, &[]),
        row("protobuf", prost::Message::encode_to_vec(&good_move()), &[]),
        row("XML", "<start/>", &[]),
        row("100,000 lists in each other", nested("[", "]"), &[]),
        row(
            "100,000 objects in each other",
            nested("{\"start\":", "}"),
            &["start.start"],
        ),
        row(
            "100,000 lists in an unknown field",
            format!("{{\"x\":{}}}", nested("[", "]")),
            &["x"],
        ),
        row("a megabyte of blanks", " ".repeat(1 << 20), &[]),
    ]
}

fn members() -> Vec<Row> {
    vec![
        with("an unknown field", "\"color\": 1", "color"),
        with(
            "a megabyte of an unknown field",
            &format!("\"{}\": 1", "x".repeat(1 << 20)),
            "",
        ),
        with("a field twice", "\"start\": {}", "start"),
        with(
            "a field in both its names",
            "\"speed_scale\": 1, \"speedScale\": 1",
            "speedScale",
        ),
        with("a text for a number", "\"speed_scale\": \"half\"", "speed_scale"),
        with("NaN as a text", "\"speed_scale\": \"NaN\"", "speed_scale"),
        with("Infinity as a text", "\"cycle_time_s\": \"-Infinity\"", "cycle_time_s"),
        with("NaN as a word", "\"speed_scale\": NaN", "speed_scale"),
        with("a number beyond doubles", "\"cycle_time_s\": 1e999", "cycle_time_s"),
        with("a number in hexadecimal", "\"cycle_time_s\": 0x10", ""),
        with("a number with a zero before", "\"cycle_time_s\": 010", "cycle_time_s"),
        with("a number with a plus", "\"cycle_time_s\": +1", "cycle_time_s"),
        with("true for a number", "\"speed_scale\": true", "speed_scale"),
        with("a list for a number", "\"speed_scale\": [1]", "speed_scale"),
        with("an object for a list", "\"limits\": {}", "limits"),
        with("a number for a list", "\"target_velocity\": 1", "target_velocity"),
        with("a number for an object", "\"payload\": 1", "payload"),
        with(
            "a null in a list",
            "\"target_velocity\": [1, null]",
            "target_velocity[1]",
        ),
        with("a list in a list", "\"target_velocity\": [[1]]", "target_velocity[0]"),
        with(
            "a text in a list",
            "\"target_velocity\": [1, 1, \"x\"]",
            "target_velocity[2]",
        ),
        with(
            "an unknown field further down",
            "\"payload\": {\"mass\": 1}",
            "payload.mass",
        ),
        with(
            "an unknown field in a list",
            "\"limits\": [{\"joint\": \"a\"}, {\"name\": 1}]",
            "limits[1].name",
        ),
        with("a negative count", "\"trace_points\": -1", "trace_points"),
        with("half a count", "\"trace_points\": 1.5", "trace_points"),
        with("a count beyond 32 bits", "\"trace_points\": 4294967296", "trace_points"),
        with("a method that is not there", "\"method\": \"FASTEST\"", "method"),
        with("a method in small letters", "\"method\": \"verified\"", "method"),
        with("a method that is half", "\"method\": 1.5", "method"),
        with("a method that is true", "\"method\": true", "method"),
        with(
            "a method that says nothing",
            "\"method\": \"METHOD_UNSPECIFIED\"",
            "method",
        ),
        with("half a surrogate", "\"revision\": \"\\ud800\"", "revision"),
        with("an escape that is none", "\"revision\": \"\\x41\"", "revision"),
        with("a line break in a text", "\"revision\": \"a\nb\"", "revision"),
        with("another robot", "\"robot_id\": \"fr3\"", "robot_id"),
        with("a number for a name", "\"robot_id\": 5", "robot_id"),
        row(
            "bytes that are no UTF-8",
            b"{\"revision\": \"\xff\xfe\"}".to_vec(),
            &["revision"],
        ),
    ]
}

fn sizes() -> Vec<Row> {
    let huge = format!("{}{}", good(), " ".repeat(8 << 20));
    let chunked = HttpRequest {
        method: "POST",
        path: "/v1/robots/ur5e:planMove".to_owned(),
        headers: vec![
            ("content-type", JSON.to_owned()),
            ("transfer-encoding", "chunked".to_owned()),
        ],
        body: format!("{:x}\r\n{huge}\r\n0\r\n\r\n", huge.len()).into_bytes(),
    };
    vec![
        row("more than eight megabytes", huge, &[]).refused(TOO_LARGE),
        Row::new(
            "body: more than eight megabytes in chunks",
            Over::Http(chunked),
            TOO_LARGE,
            &[],
        ),
    ]
}

fn kinds() -> Vec<Row> {
    let path = "/v1/robots/ur5e:planMove";
    let mut rows: Vec<Row> = [
        "text/plain",
        "text/json",
        "application/xml",
        "application/x-www-form-urlencoded",
        "multipart/form-data; boundary=x",
        "",
    ]
    .into_iter()
    .map(|kind| sent(&format!("of the kind {kind:?}"), path, kind, good(), &["content-type"]))
    .collect();
    rows.push(sent("with a query", &format!("{path}?method=1"), JSON, good(), &["?"]));
    for (verb, body, field) in [
        (
            "checkTrajectory",
            "{\"trajectory\": {\"points\": [{\"time\": 0}]}}",
            "trajectory.points[0].time",
        ),
        ("checkTrajectory", "{\"trajectory\": []}", "trajectory"),
        (
            "inverseDynamics",
            "{\"states\": [{\"position\": 1}]}",
            "states[0].position",
        ),
        ("inverseDynamics", "{\"return\": [\"ALL\"]}", "return[0]"),
        ("forwardKinematics", "{\"states\": [{}, {\"q\": []}]}", "states[1].q"),
        (
            "forwardKinematics",
            "{\"tool\": {\"tcp\": {\"position_m\": [\"a\"]}}}",
            "tool.tcp.position_m[0]",
        ),
    ] {
        let path = format!("/v1/robots/ur5e:{verb}");
        rows.push(sent(&format!("{body} to {verb}"), &path, JSON, body, &[field]));
    }
    rows
}
