//! What the service costs beside the plan itself: CPU time of the server's process per PlanMove, 64 callers at once, in
//! a closed loop, against bare echoes of the same messages.
//!
//! ```text
//! cargo bench --package takt-tests --bench service -- [rounds]
//! ```
//!
//! The time that a server's threads ran is read before and after each round. Rounds of all servers take turns, and medians
//! over the rounds are compared, so that a busy machine disturbs all alike. The echoes read the same requests and answer with a plan made beforehand: tonic's generated
//! server for gRPC, axum's `Json` for HTTP. All of them have the log that `takt serve` has: without one, tonic's spans go to a
//! slower place. Linux only (`common/served.rs`).

#![allow(clippy::print_stdout, reason = "a program that prints a table")]

#[path = "common/served.rs"]
mod served;

use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use axum::routing::post;
use bytes::Bytes;
use http_body_util::{BodyExt, Full};
use hyper_util::client::legacy::Client;
use hyper_util::client::legacy::connect::HttpConnector;
use hyper_util::rt::TokioExecutor;
use served::{Failure, Served, ran};
use takt_motion::budget::Budget;
use takt_motion::plan::plan_move;
use takt_motion::plan::request::MoveRequest;
use takt_motion::robot::Robot;
use takt_proto::convert::{self, Findings, Path};
use takt_proto::v1;
use takt_proto::v1::plan_service_client::PlanServiceClient;
use takt_proto::v1::plan_service_server::{PlanService, PlanServiceServer};
use tonic::transport::Channel;

/// The allocator of the binary `takt`; the echoes have it too.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

const CALLERS: usize = 64;

/// gRPC connections that the callers share.
const CONNECTIONS: usize = 4;

/// Requests of one server in one round.
const REQUESTS: usize = 6000;

/// Different moves among them.
const MOVES: usize = 512;

const ROBOT: &str = include_str!("../../robots/ur5e.json");

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|name| name != "--bench").collect();
    let runtime = tokio::runtime::Runtime::new()?;
    if let [flag, server] = &arguments[..]
        && flag == served::SERVE
    {
        return runtime.block_on(served::until_told(serve(server)));
    }
    let rounds = arguments.first().and_then(|rounds| rounds.parse().ok()).unwrap_or(11);
    let robot = robot()?;
    let wire = requests(&robot);
    let moves: Vec<MoveRequest> = wire.iter().map(|wire| domain(wire, &robot)).collect();
    let mut servers = ["echo-tonic", "takt-grpc", "echo-axum", "takt-http"].map(Measured::start);
    let mut plans = Vec::new();
    for round in 0..=rounds {
        for server in &mut servers {
            let cost = runtime.block_on(server.round(&wire))?;
            // the first one warms up
            if round > 0 {
                server.costs.push(cost);
            }
        }
        plans.push(plan_alone(&robot, &moves));
    }
    let plan = median(&mut plans);
    let [echo_grpc, grpc, echo_http, http] = servers.each_mut().map(|server| {
        let cost = median(&mut server.costs);
        println!("{:<12} {cost:6.1} us of CPU a request", server.name);
        cost
    });
    println!("{:<12} {plan:6.1} us", "plan alone");
    println!("gRPC: service / (echo + plan) = {:.3}", grpc / (echo_grpc + plan));
    println!("HTTP: service / (echo + plan) = {:.3}", http / (echo_http + plan));
    Ok(())
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// CPU time of a plan with nothing around it, us: the mean over the moves, with a thread on every core, as the service
/// has it. Alone, a plan has a core's caches and execution units to itself and takes a tenth less.
fn plan_alone(robot: &Robot, moves: &[MoveRequest]) -> f64 {
    let plan_all = || {
        let before = ran("/proc/thread-self");
        for request in moves {
            std::hint::black_box(plan_move(robot, request, &Budget::unlimited())).ok();
        }
        (ran("/proc/thread-self") - before) * 1e6 / moves.len() as f64
    };
    let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let costs: Vec<f64> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..threads).map(|_| scope.spawn(plan_all)).collect();
        let costs = threads.into_iter().map(|thread| thread.join().expect("it plans"));
        costs.collect()
    });
    costs.iter().sum::<f64>() / costs.len() as f64
}

fn robot() -> Result<Robot, Failure> {
    let wire: v1::RobotDescription = serde_json::from_str(ROBOT)?;
    let mut findings = Findings::default();
    let description = convert::robot::description(&wire, Path::Root, &mut findings).ok_or("no description")?;
    let resolved = description.resolve().map_err(|wrong| format!("{wrong:?}"))?;
    Robot::new(resolved.spec, resolved.warnings).map_err(|wrong| format!("{wrong:?}").into())
}

/// Moves by up to 1.5 rad a joint.
fn requests(robot: &Robot) -> Vec<v1::PlanMoveRequest> {
    let mut state = 1_u64;
    let mut draw = || {
        // Knuth's linear congruence; its upper bits
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        3.0 * ((state >> 11) as f64 / (1_u64 << 53) as f64) - 1.5
    };
    (0..MOVES)
        .map(|_| {
            let start: Vec<f64> = (0..robot.joint_count()).map(|_| draw()).collect();
            let target = start.iter().map(|start| start + draw()).collect();
            v1::PlanMoveRequest {
                robot_id: "ur5e".to_owned(),
                start: Some(v1::JointPosition { position: start }),
                target: Some(v1::JointPosition { position: target }),
                ..v1::PlanMoveRequest::default()
            }
        })
        .collect()
}

fn domain(wire: &v1::PlanMoveRequest, robot: &Robot) -> MoveRequest {
    convert::plan::move_request(wire.clone(), Some(robot.spec()), &mut Findings::default())
}

/// The answer that the echoes give: as long as the service's.
fn answer() -> Result<v1::PlanMoveResponse, Failure> {
    let robot = robot()?;
    let request = &requests(&robot)[0];
    let outcome =
        plan_move(&robot, &domain(request, &robot), &Budget::unlimited()).map_err(|why| format!("{why:?}"))?;
    Ok(v1::PlanMoveResponse {
        outcome: Some(convert::plan::outcome_to_wire(outcome, robot.spec())),
        provenance: Some(v1::Provenance {
            revision: "0".repeat(64),
            version: takt_server::VERSION.to_owned(),
            request_hash: "0".repeat(64),
        }),
    })
}

/// A server in a process of its own.
struct Measured {
    name: &'static str,
    served: Served,
    callers: Callers,
    costs: Vec<f64>,
}

#[derive(Clone)]
enum Callers {
    Grpc(String, Vec<PlanServiceClient<Channel>>),
    Http(String, Box<Client<HttpConnector, Full<Bytes>>>),
}

impl Measured {
    fn start(name: &'static str) -> Self {
        let served = Served::start(name);
        let url = served.url.clone();
        let callers = match name {
            "echo-tonic" | "takt-grpc" => Callers::Grpc(url, Vec::new()),
            _ => Callers::Http(url, Box::new(Client::builder(TokioExecutor::new()).build_http())),
        };
        Self {
            name,
            served,
            callers,
            costs: Vec::new(),
        }
    }

    /// CPU time that the server takes for a request, us.
    async fn round(&mut self, requests: &[v1::PlanMoveRequest]) -> Result<f64, Failure> {
        if let Callers::Grpc(url, clients) = &mut self.callers {
            while clients.len() < CONNECTIONS {
                let channel = Channel::from_shared(url.clone())?.connect().await?;
                clients.push(PlanServiceClient::new(channel));
            }
        }
        let next = Arc::new(AtomicUsize::new(0));
        let requests: Arc<[v1::PlanMoveRequest]> = requests.into();
        let before = self.served.cpu_time();
        let callers: Vec<_> = (0..CALLERS)
            .map(|caller| {
                let (next, requests, callers) = (Arc::clone(&next), Arc::clone(&requests), self.callers.clone());
                tokio::spawn(async move {
                    loop {
                        let index = next.fetch_add(1, Ordering::Relaxed);
                        if index >= REQUESTS {
                            return Ok::<(), Failure>(());
                        }
                        callers.call(caller, &requests[index % requests.len()]).await?;
                    }
                })
            })
            .collect();
        for caller in callers {
            caller.await??;
        }
        Ok((self.served.cpu_time() - before) * 1e6 / REQUESTS as f64)
    }
}

impl Callers {
    async fn call(&self, caller: usize, request: &v1::PlanMoveRequest) -> Result<(), Failure> {
        match self {
            Self::Grpc(_, clients) => {
                let mut client = clients[caller % clients.len()].clone();
                client.plan_move(request.clone()).await?;
            }
            Self::Http(url, client) => {
                let request = http::Request::post(format!("{url}/v1/robots/ur5e:planMove"))
                    .header("content-type", "application/json")
                    .body(Full::from(serde_json::to_vec(request)?))?;
                let response = client.request(request).await?;
                if !response.status().is_success() {
                    return Err(response.status().to_string().into());
                }
                response.into_body().collect().await?;
            }
        }
        Ok(())
    }
}

/// Runs a server by its name.
async fn serve(server: &str) -> Result<(), Failure> {
    match server {
        "echo-tonic" => echo_tonic().await,
        "echo-axum" => echo_axum().await,
        _ => served::takt().await,
    }
}

async fn listen() -> Result<tokio::net::TcpListener, Failure> {
    let listener = tokio::net::TcpListener::bind(SocketAddr::from(([127, 0, 0, 1], 0))).await?;
    println!("{}", listener.local_addr()?);
    Ok(listener)
}

struct Echo(v1::PlanMoveResponse);

#[tonic::async_trait]
impl PlanService for Echo {
    async fn plan_move(
        &self,
        _: tonic::Request<v1::PlanMoveRequest>,
    ) -> Result<tonic::Response<v1::PlanMoveResponse>, tonic::Status> {
        Ok(tonic::Response::new(self.0.clone()))
    }

    async fn check_trajectory(
        &self,
        _: tonic::Request<v1::CheckTrajectoryRequest>,
    ) -> Result<tonic::Response<v1::CheckTrajectoryResponse>, tonic::Status> {
        Err(tonic::Status::unimplemented("an echo"))
    }

    async fn plan_path(
        &self,
        _: tonic::Request<v1::PlanPathRequest>,
    ) -> Result<tonic::Response<v1::PlanPathResponse>, tonic::Status> {
        Err(tonic::Status::unimplemented("an echo"))
    }

    type PlanBatchStream = futures::stream::Empty<Result<v1::PlanBatchResponse, tonic::Status>>;

    async fn plan_batch(
        &self,
        _: tonic::Request<tonic::Streaming<v1::PlanBatchRequest>>,
    ) -> Result<tonic::Response<Self::PlanBatchStream>, tonic::Status> {
        Err(tonic::Status::unimplemented("an echo"))
    }

    type StreamSetpointsStream = futures::stream::Empty<Result<v1::StreamSetpointsResponse, tonic::Status>>;

    async fn stream_setpoints(
        &self,
        _: tonic::Request<v1::StreamSetpointsRequest>,
    ) -> Result<tonic::Response<Self::StreamSetpointsStream>, tonic::Status> {
        Err(tonic::Status::unimplemented("an echo"))
    }
}

async fn echo_tonic() -> Result<(), Failure> {
    let listener = listen().await?;
    let incoming = tonic::transport::server::TcpIncoming::from(listener).with_nodelay(Some(true));
    tonic::transport::Server::builder()
        .add_service(PlanServiceServer::new(Echo(answer()?)))
        .serve_with_incoming(incoming)
        .await?;
    Ok(())
}

async fn echo_axum() -> Result<(), Failure> {
    let answer = answer()?;
    let echo = move |axum::Json(_): axum::Json<v1::PlanMoveRequest>| async move { axum::Json(answer) };
    let router = axum::Router::new().route("/{*path}", post(echo));
    Ok(axum::serve(listen().await?, router).await?)
}
