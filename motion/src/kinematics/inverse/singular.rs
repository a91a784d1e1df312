//! How near to a singularity the arm is: the smallest singular value of its Jacobian.
//!
//! σ² is the smallest eigenvalue of J·Jᵀ (of JᵀJ for fewer than six joints), found with Jacobi's rotations (C. G. J.
//! Jacobi 1846; G. H. Golub, C. F. Van Loan, "Matrix Computations", section 8.5). Without unit: linear rows are divided
//! by the arm's length. It is true to about 1e-8 of the largest.

use super::gap::Gap;
use super::newton::Newton;
use super::screws::{Place, Screws};

/// What is missing at `q`, and the smallest singular value there.
pub(super) fn look(screws: &Screws, q: &[f64], target: &Place) -> (Gap, f64) {
    let mut newton = Newton::new(screws, *target);
    let gap = newton.gap(q);
    (gap, libm::sqrt(newton.normal_matrix().smallest_eigenvalue().max(0.0)))
}
