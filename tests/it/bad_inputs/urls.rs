//! Paths, queries and headers that lead nowhere, and what is the same over gRPC.

use prost::Message;
use takt_proto::{route::Rpc, v1};

use super::{CONFLICT, HttpRequest, INVALID, NOT_ALLOWED, NOT_FOUND, Over, Refusal, Row, method};

fn http(method: &'static str, path: &str, header: Option<(&'static str, &str)>) -> HttpRequest {
    HttpRequest {
        method,
        path: path.to_owned(),
        headers: header
            .map(|(name, value)| (name, value.to_owned()))
            .into_iter()
            .collect(),
        body: Vec::new(),
    }
}

fn row(method: &'static str, path: &str, refusal: Refusal, fields: &[&str]) -> Row {
    let over = Over::Http(http(method, path, None));
    Row::new(&format!("URL: {method} {path:.60}"), over, refusal, fields)
}

fn headed(method: &'static str, path: &str, header: (&'static str, &str), refusal: Refusal, fields: &[&str]) -> Row {
    let over = Over::Http(http(method, path, Some(header)));
    let (name, value) = header;
    Row::new(&format!("URL: {method} {path}, {name}: {value}"), over, refusal, fields)
}

/// The same request over both protocols.
fn both<M: Message>(rpc: Rpc, message: &M, path: &str, refusal: Refusal, fields: &[&str]) -> Row {
    let verb = match rpc {
        Rpc::DeleteRobot => "DELETE",
        _ => "GET",
    };
    let over = Over::Both(method(rpc, message.encode_to_vec()), http(verb, path, None));
    Row::new(&format!("{}: {path:.60}", rpc.name()), over, refusal, fields)
}

fn list(page_size: Option<u32>, page_token: Option<&str>, path: &str, fields: &[&str]) -> Row {
    let message = v1::ListRobotsRequest {
        page_size,
        page_token: page_token.map(str::to_owned),
    };
    both(Rpc::ListRobots, &message, path, INVALID, fields)
}

fn revisions(
    robot_id: &str,
    page_size: Option<u32>,
    page_token: Option<&str>,
    query: &str,
) -> v1::ListRevisionsRequest {
    let _ = query;
    v1::ListRevisionsRequest {
        robot_id: robot_id.to_owned(),
        page_size,
        page_token: page_token.map(str::to_owned),
    }
}

fn get(robot_id: &str, revision: Option<&str>) -> v1::GetRobotRequest {
    v1::GetRobotRequest {
        robot_id: robot_id.to_owned(),
        revision: revision.map(str::to_owned),
        as_urdf: None,
    }
}

fn delete(robot_id: &str, expected_revision: Option<&str>) -> v1::DeleteRobotRequest {
    v1::DeleteRobotRequest {
        robot_id: robot_id.to_owned(),
        expected_revision: expected_revision.map(str::to_owned),
    }
}

pub(super) fn rows() -> Vec<Row> {
    let long = "x".repeat(64);
    let long_path = format!("/v1/robots/{long}");
    let mut rows = vec![
        list(Some(0), None, "/v1/robots?page_size=0", &["page_size"]),
        list(Some(1001), None, "/v1/robots?page_size=1001", &["page_size"]),
        list(Some(u32::MAX), None, "/v1/robots?pageSize=4294967295", &["page_size"]),
        list(
            None,
            Some("nonsense"),
            "/v1/robots?page_token=nonsense",
            &["page_token"],
        ),
        list(None, Some("ff"), "/v1/robots?page_token=ff", &["page_token"]),
        list(None, Some("é"), "/v1/robots?page_token=%C3%A9", &["page_token"]),
        list(
            Some(0),
            Some("2E2E"),
            "/v1/robots?page_size=0&page_token=2E2E",
            &["page_size", "page_token"],
        ),
        both(
            Rpc::ListRevisions,
            &revisions("ur5e", Some(0), None, ""),
            "/v1/robots/ur5e:revisions?page_size=0",
            INVALID,
            &["page_size"],
        ),
        both(
            Rpc::ListRevisions,
            &revisions("ur5e", None, Some("7a"), ""),
            "/v1/robots/ur5e:revisions?page_token=7a",
            INVALID,
            &["page_token"],
        ),
        both(
            Rpc::ListRevisions,
            &revisions("nobody", None, None, ""),
            "/v1/robots/nobody:revisions",
            NOT_FOUND,
            &[],
        ),
        both(
            Rpc::ListRevisions,
            &revisions("No Body", Some(2000), None, ""),
            "/v1/robots/No%20Body:revisions?page_size=2000",
            INVALID,
            &["robot_id", "page_size"],
        ),
        both(Rpc::GetRobot, &get("nobody", None), "/v1/robots/nobody", NOT_FOUND, &[]),
        both(
            Rpc::GetRobot,
            &get("UR5E", None),
            "/v1/robots/UR5E",
            INVALID,
            &["robot_id"],
        ),
        both(Rpc::GetRobot, &get(&long, None), &long_path, INVALID, &["robot_id"]),
        both(
            Rpc::GetRobot,
            &get("é", None),
            "/v1/robots/%C3%A9",
            INVALID,
            &["robot_id"],
        ),
        both(
            Rpc::GetRobot,
            &get("ur5e", Some("r9")),
            "/v1/robots/ur5e?revision=r9",
            NOT_FOUND,
            &[],
        ),
        both(
            Rpc::GetRobot,
            &get("ur5e", Some("")),
            "/v1/robots/ur5e?revision=",
            NOT_FOUND,
            &[],
        ),
        both(
            Rpc::DeleteRobot,
            &delete("nobody", None),
            "/v1/robots/nobody",
            NOT_FOUND,
            &[],
        ),
        both(
            Rpc::DeleteRobot,
            &delete("Ur5e", None),
            "/v1/robots/Ur5e",
            INVALID,
            &["robot_id"],
        ),
        both(
            Rpc::DeleteRobot,
            &delete("ur5e", Some("r9")),
            "/v1/robots/ur5e?expected_revision=r9",
            CONFLICT,
            &[],
        ),
        both(
            Rpc::DeleteRobot,
            &delete("ur5e", Some("")),
            "/v1/robots/ur5e?expected_revision=",
            CONFLICT,
            &[],
        ),
    ];
    for (method, path) in [
        ("GET", "/nope"),
        ("GET", "/v1"),
        ("GET", "/v1/robots/"),
        ("GET", "/v1/robots/a/b"),
        ("GET", "/v2/robots"),
        ("GET", "/v1/robots/../../etc/passwd"),
        ("GET", "//v1/robots"),
        ("POST", "/v1/robots/ur5e:fly"),
        ("POST", "/v1/robots/ur5e:planmove"),
        ("POST", "/healthz"),
        ("GET", "/takt.v1.PlanService/PlanMove"),
    ] {
        rows.push(row(method, path, NOT_FOUND, &[]));
    }
    for (method, path) in [
        ("GET", "/v1/robots/ur5e:planMove"),
        ("PUT", "/v1/robots/ur5e:planMove"),
        ("DELETE", "/v1/robots"),
        ("POST", "/v1/robots"),
        ("POST", "/v1/robots/ur5e"),
        ("PATCH", "/v1/robots/ur5e"),
        ("OPTIONS", "/v1/robots/ur5e"),
        ("BREW", "/v1/robots/ur5e"),
    ] {
        rows.push(row(method, path, NOT_ALLOWED, &[]));
    }
    for (path, field) in [
        ("/v1/robots?page_size=x", "page_size"),
        ("/v1/robots?page_size=-1", "page_size"),
        ("/v1/robots?page_size=1e1", "page_size"),
        ("/v1/robots?page_size=4294967296", "page_size"),
        ("/v1/robots?page_size=1&page_size=2", "page_size"),
        ("/v1/robots?other=1", "?"),
        ("/v1/robots?%ff=1", "?"),
        ("/v1/robots/ur5e?as_urdf=maybe", "as_urdf"),
        ("/v1/robots/ur5e?as_urdf=", "as_urdf"),
        ("/v1/robots/%00", "robot_id"),
        ("/v1/robots/%ff%fe", "robot_id"),
        ("/v1/robots/a%20b", "robot_id"),
    ] {
        rows.push(row("GET", path, INVALID, &[field]));
    }
    for timeout in ["soon", "-1", "NaN", "1s"] {
        let header = ("request-timeout", timeout);
        rows.push(headed("GET", "/v1/robots", header, INVALID, &["request-timeout"]));
    }
    for tag in ["r1", "\"a\", \"b\"", "\"", "*"] {
        rows.push(headed(
            "DELETE",
            "/v1/robots/ur5e",
            ("if-match", tag),
            INVALID,
            &["if-match"],
        ));
    }
    rows.push(headed(
        "DELETE",
        "/v1/robots/ur5e",
        ("if-match", "\"r9\""),
        CONFLICT,
        &[],
    ));
    rows
}
