//! The fastest timing of a path under every limit.
//!
//! A path q(s) is given; what is free is when it is where. With a(s) = ṡ² the path acceleration is s̈ = a′/2 and the
//! duration ∫ ds/√a; each limit is linear in (a, a′) or nearly so (Verscheure et al. 2009).

pub(crate) mod coefficients;
pub(crate) mod grid;
pub(crate) mod law;
pub(crate) mod limits;
#[cfg(test)]
mod test_curves;
