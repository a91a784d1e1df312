//! What the integration tests stand on: a running server, a client of each protocol that hides nothing, robots and
//! moves that are known to be good, and comparisons.

pub mod compare;
pub mod fixtures;
pub mod grpc;
pub mod http;
pub mod server;
pub mod telemetry;

pub use server::TestServer;

/// The two protocols of the port.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Protocol {
    /// Protobuf over HTTP/2.
    Grpc,
    /// JSON over HTTP/1.1.
    Http,
}

impl Protocol {
    /// Both of them.
    pub const BOTH: [Self; 2] = [Self::Grpc, Self::Http];
}
