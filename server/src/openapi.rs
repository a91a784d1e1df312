//! The OpenAPI document.

/// The OpenAPI document of the HTTP side.
#[must_use]
pub fn document() -> &'static str {
    "{}"
}
