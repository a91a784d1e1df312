//! How near to a singularity the arm is: the smallest singular value of its Jacobian.
//!
//! σ² is the smallest eigenvalue of J·Jᵀ (of JᵀJ for fewer than six joints). Without unit: linear rows are divided by the
//! arm's length. Squaring leaves it true to about 1e-8.

use super::gap::Gap;
use super::newton::Newton;

/// What is missing at `q`, and the smallest singular value there.
pub(super) fn look(newton: &mut Newton<'_>, q: &[f64]) -> (Gap, f64) {
    let gap = newton.gap(q);
    (gap, libm::sqrt(newton.normal_matrix().smallest_eigenvalue().max(0.0)))
}
