//! Bad inputs, over both protocols: each is refused with its code and names its field, and the same connection goes on.

mod bodies;
mod descriptions;
mod drives;
mod fits;
mod moves;
mod programs;
mod protobuf;
mod states;
mod streams;
mod trajectories;
mod urdf;
mod urls;

use std::collections::HashSet;

use prost::Message;
use serde::Serialize;
use takt_proto::{
    error::Error,
    route::{Route, Rpc},
    v1,
};
use takt_tests::{
    TestServer,
    fixtures::{good_move, two_joints},
    grpc, http,
};
use tonic::Code;

/// A request, and what is said to it.
struct Row {
    name: String,
    over: Over,
    refusal: Refusal,
    /// The fields of the violations, all of them in order; after `AND_MORE` there may be others.
    fields: Vec<String>,
}

/// What stands for further fields.
const AND_MORE: &str = "…";

/// Which protocols carry it.
enum Over {
    Both(Method, HttpRequest),
    Grpc(Method),
    Http(HttpRequest),
}

/// A call over gRPC.
struct Method {
    path: String,
    message: Vec<u8>,
}

/// A call over HTTP.
struct HttpRequest {
    method: &'static str,
    path: String,
    headers: Vec<(&'static str, String)>,
    body: Vec<u8>,
}

/// How a request is refused: the code over gRPC, its name, the status over HTTP.
#[derive(Debug, Clone, Copy)]
struct Refusal(Code, &'static str, u16);

const INVALID: Refusal = Refusal(Code::InvalidArgument, "INVALID_ARGUMENT", 400);
const NOT_FOUND: Refusal = Refusal(Code::NotFound, "NOT_FOUND", 404);
const CONFLICT: Refusal = Refusal(Code::Aborted, "ABORTED", 409);
const TOO_LARGE: Refusal = Refusal(Code::OutOfRange, "OUT_OF_RANGE", 413);
const NOT_ALLOWED: Refusal = Refusal(Code::Unimplemented, "UNIMPLEMENTED", 405);
const UNIMPLEMENTED: Refusal = Refusal(Code::Unimplemented, "UNIMPLEMENTED", 501);

/// A message that has a body over HTTP.
trait Request: Message + Serialize + Default + Clone {
    const RPC: Rpc;
    fn robot_id(&self) -> &str;
}

macro_rules! requests {
    ($($message:ident: $rpc:ident,)*) => {
        $(impl Request for v1::$message {
            const RPC: Rpc = Rpc::$rpc;

            fn robot_id(&self) -> &str {
                &self.robot_id
            }
        })*
    };
}

requests! {
    RegisterRobotRequest: RegisterRobot,
    PlanMoveRequest: PlanMove,
    PlanPathRequest: PlanPath,
    StreamSetpointsRequest: StreamSetpoints,
    CheckTrajectoryRequest: CheckTrajectory,
    InverseDynamicsRequest: InverseDynamics,
    ForwardKinematicsRequest: ForwardKinematics,
    InverseKinematicsRequest: InverseKinematics,
    EstimateFrictionRequest: EstimateFriction,
    RehearseRequest: Rehearse,
}

impl Row {
    fn new(name: &str, over: Over, refusal: Refusal, fields: &[&str]) -> Self {
        Self {
            name: name.to_owned(),
            over,
            refusal,
            fields: fields.iter().map(|field| (*field).to_owned()).collect(),
        }
    }

    /// A message over both protocols.
    fn message<M: Request>(name: &str, message: &M, fields: &[&str]) -> Self {
        Self::message_and_json(name, message, canonical_json(message), fields)
    }

    /// A message over gRPC, and JSON that stands for it over HTTP: for what no JSON writer writes.
    fn message_and_json<M: Request>(name: &str, message: &M, json: Vec<u8>, fields: &[&str]) -> Self {
        let over = Over::Both(method_of(message), json_of(message, json));
        Self::new(name, over, INVALID, fields)
    }

    fn refused(self, refusal: Refusal) -> Self {
        Self { refusal, ..self }
    }
}

/// The canonical JSON: numbers that are not finite are texts, where the JSON writer knows only `null`. They travel through
/// it as finite numbers that stand nowhere else.
fn canonical_json<M: Request>(message: &M) -> Vec<u8> {
    let stand_ins = [
        (f64::NAN, -1.234_567_890_123e-301, "\"NaN\""),
        (f64::INFINITY, -1.234_567_890_123e-302, "\"Infinity\""),
        (f64::NEG_INFINITY, -1.234_567_890_123e-303, "\"-Infinity\""),
    ];
    let mut bytes = message.encode_to_vec();
    for (value, stand_in, _) in stand_ins {
        let [value, stand_in] = [value, stand_in].map(f64::to_le_bytes);
        for at in 0..bytes.len().saturating_sub(7) {
            if bytes[at..at + 8] == value {
                bytes[at..at + 8].copy_from_slice(&stand_in);
            }
        }
    }
    let message = M::decode(&*bytes).expect("the message has kept its form");
    let mut json = serde_json::to_string(&message).expect("the message can be written as JSON");
    for (_, stand_in, text) in stand_ins {
        let stand_in = serde_json::to_string(&stand_in).expect("a number can be written");
        json = json.replace(&stand_in, text);
    }
    json.into_bytes()
}

fn method_of<M: Request>(message: &M) -> Method {
    method(M::RPC, message.encode_to_vec())
}

fn method(rpc: Rpc, message: Vec<u8>) -> Method {
    Method {
        path: format!("/{}/{}", Route::of(rpc).service, rpc.name()),
        message,
    }
}

fn json_of<M: Request>(message: &M, json: Vec<u8>) -> HttpRequest {
    let route = Route::of(M::RPC);
    HttpRequest {
        method: route.method.as_str(),
        path: route.path_for(&escaped(message.robot_id())),
        headers: vec![("content-type", "application/json".to_owned())],
        body: json,
    }
}

fn escaped(text: &str) -> String {
    let bytes = text.bytes();
    bytes
        .map(|byte| match byte {
            b'a'..=b'z' | b'0'..=b'9' | b'.' | b'_' | b'-' => char::from(byte).to_string(),
            _ => format!("%{byte:02X}"),
        })
        .collect()
}

/// A server, a connection of each protocol, and a move that can be planned with its answers.
struct Bench {
    grpc: grpc::Connection,
    http: http::Connection,
    good: (Method, HttpRequest),
    answers: (Vec<u8>, Vec<u8>),
    _server: TestServer,
}

impl Bench {
    async fn set_up() -> Self {
        let server = TestServer::start().await;
        let (grpc, mut http) = (server.grpc(), server.http().await);
        // For what is said of a robot that exists.
        let registered = v1::RegisterRobotRequest {
            robot_id: "arm".to_owned(),
            description: Some(two_joints(5.0)),
            ..Default::default()
        };
        let register = method_of(&registered);
        grpc.unary(&register.path, register.message)
            .await
            .expect("the arm is sound");
        let message = good_move();
        let json = serde_json::to_vec(&message).expect("a request can be written");
        let good = (method_of(&message), json_of(&message, json));
        let over_grpc = grpc.unary(&good.0.path, good.0.message.clone()).await;
        let over_http = send(&mut http, &good.1).await;
        assert_eq!(over_http.status, 200, "{}", over_http.text());
        Self {
            answers: (over_grpc.expect("the move is good").to_vec(), over_http.body),
            grpc,
            http,
            good,
            _server: server,
        }
    }

    /// Sends the row, then the good move; what is not as it should be.
    async fn check(&mut self, row: &Row) -> Result<(), String> {
        let (method, request) = match &row.over {
            Over::Both(method, request) => (Some(method), Some(request)),
            Over::Grpc(method) => (Some(method), None),
            Over::Http(request) => (None, Some(request)),
        };
        let mut over_grpc = None;
        if let Some(method) = method {
            let answer = self.grpc.unary(&method.path, method.message.clone()).await;
            let status = answer.err().ok_or("gRPC: accepted")?;
            let error = Error::from_status(&status);
            let Refusal(code, ..) = row.refusal;
            if status.code() != code {
                return Err(format!("gRPC: {:?}: {}", status.code(), status.message()));
            }
            check_fields(&error, &row.fields).map_err(|found| format!("gRPC: {found}"))?;
            self.go_on_over_grpc().await?;
            over_grpc = Some(error);
        }
        if let Some(request) = request {
            let reply = send(&mut self.http, request).await;
            let Refusal(code, name, status) = row.refusal;
            if reply.status != status {
                return Err(format!("HTTP: {}: {:.200}", reply.status, reply.text()));
            }
            let (error, body) = (reply.error(), reply.json());
            if body["error"]["status"] != name || body["error"]["code"] != i32::from(code) {
                return Err(format!("HTTP: {body}"));
            }
            check_fields(&error, &row.fields).map_err(|found| format!("HTTP: {found}"))?;
            self.go_on_over_http().await?;
            if let Some(other) = over_grpc
                && other != error
                && !row.name.ends_with(OTHER_WORDS)
            {
                return Err(format!("the protocols differ: {other:?} and {error:?}"));
            }
        }
        Ok(())
    }

    async fn go_on_over_grpc(&self) -> Result<(), String> {
        let good = &self.good.0;
        let answer = self.grpc.unary(&good.path, good.message.clone()).await;
        let answer = answer.map_err(|status| format!("gRPC, the good move: {status}"))?;
        let same = answer == self.answers.0;
        same.then_some(())
            .ok_or("gRPC: the good move has another answer".to_owned())
    }

    async fn go_on_over_http(&mut self) -> Result<(), String> {
        let reply = send(&mut self.http, &self.good.1).await;
        let same = reply.status == 200 && reply.body == self.answers.1;
        same.then_some(())
            .ok_or_else(|| format!("HTTP: the good move has another answer: {:.200}", reply.text()))
    }
}

/// Ends the name of a row whose refusals say the same in other words: one protocol cannot even carry the mistake.
const OTHER_WORDS: &str = "*";

async fn send(connection: &mut http::Connection, request: &HttpRequest) -> http::Reply {
    let headers: Vec<(&str, &str)> = request
        .headers
        .iter()
        .map(|(name, value)| (*name, value.as_str()))
        .collect();
    connection
        .request(request.method, &request.path, &headers, &request.body)
        .await
}

fn check_fields(error: &Error, expected: &[String]) -> Result<(), String> {
    let found: Vec<&str> = error
        .violations
        .iter()
        .map(|violation| violation.path.as_str())
        .collect();
    let same = match expected.split_last() {
        Some((last, first)) if last == AND_MORE => found.len() > first.len() && found.starts_with_all(first),
        _ => found == expected,
    };
    if same {
        return Ok(());
    }
    Err(format!("names {found:?}: {}", error.message))
}

trait StartsWithAll {
    fn starts_with_all(&self, first: &[String]) -> bool;
}

impl StartsWithAll for Vec<&str> {
    fn starts_with_all(&self, first: &[String]) -> bool {
        first.iter().zip(self).all(|(expected, found)| expected == found)
    }
}

/// Checks every row of a table and reports all that are not as they should be.
async fn check(rows: Vec<Row>) {
    let mut bench = Bench::set_up().await;
    let mut wrong = Vec::new();
    for row in &rows {
        if let Err(found) = bench.check(row).await {
            wrong.push(format!(
                "{}: expected {:?} {:?}\n    {found}",
                row.name, row.refusal, row.fields
            ));
        }
    }
    let list = wrong.join("\n");
    assert!(wrong.is_empty(), "{} of {} rows:\n{list}", wrong.len(), rows.len());
}

#[tokio::test]
async fn moves_are_refused() {
    check(moves::rows()).await;
}

#[tokio::test]
async fn programs_are_refused() {
    check(programs::rows()).await;
}

#[tokio::test]
async fn streams_are_refused() {
    check(streams::rows()).await;
}

#[tokio::test]
async fn drives_are_refused() {
    check(drives::rows()).await;
}

#[tokio::test]
async fn trajectories_are_refused() {
    check(trajectories::rows()).await;
}

#[tokio::test]
async fn states_are_refused() {
    check(states::rows()).await;
}

#[tokio::test]
async fn descriptions_are_refused() {
    check(descriptions::rows()).await;
}

#[tokio::test]
async fn hostile_urdfs_are_refused() {
    check(urdf::rows()).await;
}

#[tokio::test]
async fn bodies_that_are_no_messages_are_refused() {
    check(bodies::rows()).await;
}

#[tokio::test]
async fn bytes_that_are_no_messages_are_refused() {
    check(protobuf::rows()).await;
}

#[tokio::test]
async fn urls_are_refused() {
    check(urls::rows()).await;
}

/// The table is large, and no row stands in it twice.
#[test]
fn the_table_is_complete() {
    let tables = [
        moves::rows(),
        programs::rows(),
        streams::rows(),
        drives::rows(),
        trajectories::rows(),
        states::rows(),
        descriptions::rows(),
        urdf::rows(),
        bodies::rows(),
        protobuf::rows(),
        urls::rows(),
    ];
    let rows: Vec<&Row> = tables.iter().flatten().collect();
    let over_both = rows.iter().filter(|row| matches!(row.over, Over::Both(..))).count();
    let names: HashSet<&str> = rows.iter().map(|row| row.name.as_str()).collect();
    assert_eq!(names.len(), rows.len(), "a name stands twice");
    assert!(
        over_both >= 150,
        "{over_both} of {} rows go over both protocols",
        rows.len()
    );
}
