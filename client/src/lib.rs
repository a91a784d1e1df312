//! Takt client.
