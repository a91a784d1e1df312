//! The client of Takt: one set of calls, over gRPC or over HTTP/JSON.
//!
//! ```no_run
//! use std::time::Duration;
//! use takt_client::{Client, Transport, v1};
//!
//! # async fn example() -> Result<(), takt_client::Error> {
//! let client = Client::builder()
//!     .endpoint("http://127.0.0.1:7171")
//!     .transport(Transport::Grpc)
//!     .deadline(Duration::from_secs(2))
//!     .build()?;
//! let reply = client
//!     .plan_move(v1::PlanMoveRequest {
//!         robot_id: "ur5e".to_owned(),
//!         start: Some(v1::JointPosition { position: vec![0.0, -1.5, 1.5, 0.0, 0.0, 0.0] }),
//!         target: Some(v1::JointPosition { position: vec![1.0, -1.0, 1.0, 0.5, 0.0, 0.0] }),
//!         ..Default::default()
//!     })
//!     .await?;
//! match reply.outcome {
//!     Some(v1::plan_move_response::Outcome::Plan(plan)) => println!("{} s", plan.duration_s),
//!     Some(v1::plan_move_response::Outcome::Infeasible(no)) => println!("{}", no.suggestion),
//!     None => {}
//! }
//! # Ok(())
//! # }
//! ```
//!
//! # Why the wire's types
//!
//! Calls take and return the generated messages of [`takt_proto::v1`] (re-exported as [`v1`]), not types of their own.
//! What was sent is then exactly what the server saw: a request hash can be compared, a reply stored and replayed, and
//! a field that an older client does not know is a field it does not show, not a conversion that fails. A second set
//! of types would have to be kept equal to the first for no gain.
//!
//! # What happens when something goes wrong
//!
//! - Every call has a **deadline** over all its tries, and the server is told what is left of it. No call waits for
//!   ever: connecting has its own limit, and dead peers are found by keep-alive.
//! - Calls that change nothing (reading, planning, checking) and registrations, which are idempotent by content, are
//!   **tried again** when the service is unreachable, unavailable or overloaded: with exponential backoff and full
//!   jitter, or after the delay the server asks for. A registration with an expected revision, and a deletion, are
//!   tried again only where they certainly never left.
//! - With several **endpoints**, calls start at each in turn and move on to the next when one cannot be reached or is
//!   unavailable.
//! - **Streams** have the deadline for their beginning and for each piece. A stream of set-points is tried again up to its
//!   header; a piece that is missing, or an end before the last set-point, is an error and not an end. Streams of requests are
//!   sent once.
//! - Every failure is one [`Error`], which tells four kinds apart: the request is wrong, the service could not, the
//!   service could not be reached, the time was up. *Infeasible* is none of them: it is an answer.

#![warn(missing_docs)]

mod builder;
mod client;
mod connection;
mod error;
mod grpc;
mod http_json;
mod lenient;
mod ready;
mod retry;
mod rpc;
mod stream;

pub use builder::{Builder, Transport};
pub use client::Client;
pub use error::{Code, Error, ErrorKind, FieldViolation};
pub use retry::RetryPolicy;
pub use stream::{BatchAnswers, FrictionEstimates, SetpointStream};
pub use takt_proto::v1;
