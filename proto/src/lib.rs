//! The wire schema of Takt, and the only conversions between it and the domain of [`takt_motion`].

#![warn(missing_docs)]

pub mod codec;
pub mod convert;
pub mod error;
pub mod id;
mod number;
pub mod route;

/// Generated messages, clients and servers of the package `takt.v1`, with the canonical JSON of the messages.
#[allow(
    missing_docs,
    rustdoc::broken_intra_doc_links,
    rustdoc::invalid_html_tags,
    unreachable_pub,
    clippy::all,
    clippy::restriction,
    clippy::pedantic,
    clippy::nursery
)]
pub mod v1 {
    tonic::include_proto!("takt.v1");
    include!(concat!(env!("OUT_DIR"), "/takt.v1.serde.rs"));
    include!(concat!(env!("OUT_DIR"), "/sparse/takt.v1.serde.rs"));
}

/// The encoded `FileDescriptorSet` of the schema, with comments: for reflection and the OpenAPI document.
pub const DESCRIPTOR: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/descriptor.bin"));
