//! The motion service as a library: gRPC and HTTP/JSON on one port, the robot registry, and the limits that keep it
//! answering. [`Server::bind`], then [`Server::local_addr`], then [`Server::run`].

mod body;
mod compute;
mod config;
mod connection;
mod edge;
mod error;
mod examples;
mod form;
mod grpc;
mod health;
mod http;
mod limits;
mod openapi;
mod planner;
mod registry;
mod server;
mod service;
mod stream;
mod telemetry;

pub use config::{Config, ConfigError, ConnectionConfig, DrainConfig, Limits, PlannerConfig, StoreConfig};
pub use openapi::document as openapi_document;
pub use server::{BindError, Server};
pub use telemetry::{LogFormat, TelemetryError, init as init_telemetry};

/// The version that every answer's provenance names.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
