//! Takt server.
