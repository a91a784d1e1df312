//! A body's ten parameters as one matrix, and how far two bodies are apart.
//!
//! ```text
//! P = [Σ h; hᵀ m],  Σ = ½·tr(I)·1 − I        a rigid body's if and only if P is positive definite
//! d(P, P₀) = tr(P₀⁻¹·P) − ln det(P₀⁻¹·P) − 4
//! ```
//!
//! with the mass m, first moment h and inertia tensor I about the frame's origin (P. Wensing, S. Kim, J.-J. Slotine, "Linear matrix
//! inequalities for physically consistent inertial parameter identification", 2018). d is a distance that units and the
//! choice of the frame do not change, is convex in the parameters, and has no end where a body ceases to be one: it draws
//! towards P₀ and keeps bodies physical at once (T. Lee, P. Wensing, F. Park, "Geometric robot dynamic identification: a
//! convex programming approach", 2020).

use nalgebra::{Matrix3, Matrix4, SymmetricEigen, Vector3};

use crate::dynamics::regressor::{BODY, body_parameters};
use crate::robot::spec::Inertial;
use crate::tolerance::GYRATION_MIN;

/// The matrix of ten parameters.
pub(crate) fn matrix(p: &[f64]) -> Matrix4<f64> {
    let half_trace = 0.5 * (p[4] + p[5] + p[6]);
    Matrix4::new(
        half_trace - p[4],
        -p[7],
        -p[8],
        p[1],
        -p[7],
        half_trace - p[5],
        -p[9],
        p[2],
        -p[8],
        -p[9],
        half_trace - p[6],
        p[3],
        p[1],
        p[2],
        p[3],
        p[0],
    )
}

/// The body that a description says, or where it is none (moments that break the triangle inequality, a point), the nearest
/// whose radii of gyration are at least [`GYRATION_MIN`]. `None`: it has no mass.
pub(crate) fn sound(body: &Inertial) -> Option<[f64; BODY]> {
    if body.mass <= 0.0 {
        return None;
    }
    let spread = Matrix3::identity() * (0.5 * body.inertia.trace()) - body.inertia;
    let eigen = SymmetricEigen::new(spread);
    let least = body.mass * GYRATION_MIN * GYRATION_MIN;
    if eigen.eigenvalues.iter().all(|value| *value >= least) {
        return Some(body_parameters(body));
    }
    let raised = eigen.eigenvalues.map(|value| value.max(least));
    let mut about_center = Matrix3::zeros();
    for (axis, value) in eigen.eigenvectors.column_iter().zip(raised.iter()) {
        let axis: Vector3<f64> = axis.into_owned();
        about_center += axis * axis.transpose() * *value;
    }
    Some(body_parameters(&Inertial {
        inertia: Matrix3::identity() * about_center.trace() - about_center,
        ..*body
    }))
}

/// A body drawn towards another by d.
#[derive(Debug, Clone)]
pub(crate) struct Pull {
    inverse: Matrix4<f64>,
}

impl Pull {
    /// Towards a sound body.
    pub(crate) fn towards(parameters: &[f64]) -> Option<Self> {
        let inverse = matrix(parameters).cholesky()?.inverse();
        Some(Self { inverse })
    }

    /// d up to a constant; `None` where the parameters are no body's.
    pub(crate) fn distance(&self, parameters: &[f64]) -> Option<f64> {
        let p = matrix(parameters);
        let factor = p.cholesky()?;
        let ln_det: f64 = (0..4).map(|i| 2.0 * libm::log(factor.l_dirty()[(i, i)])).sum();
        let distance = trace_of_product(&self.inverse, &p) - ln_det;
        distance.is_finite().then_some(distance)
    }

    /// Gradient and Hessian (row by row) of d.
    pub(crate) fn derivatives(&self, parameters: &[f64]) -> Option<([f64; BODY], [[f64; BODY]; BODY])> {
        let inverse = matrix(parameters).cholesky()?.inverse();
        let basis: [Matrix4<f64>; BODY] = std::array::from_fn(|k| {
            let mut unit = [0.0; BODY];
            unit[k] = 1.0;
            matrix(&unit)
        });
        let products = basis.map(|b| inverse * b);
        let gradient = std::array::from_fn(|k| trace_of_product(&self.inverse, &basis[k]) - products[k].trace());
        let hessian =
            std::array::from_fn(|k| std::array::from_fn(|l| trace_of_product(&products[k], &products[l].transpose())));
        Some((gradient, hessian))
    }
}

/// tr(Aᵀ·B), which is tr(A·B) for a symmetric A.
fn trace_of_product(a: &Matrix4<f64>, b: &Matrix4<f64>) -> f64 {
    a.iter().zip(b.iter()).map(|(a, b)| a * b).sum()
}

/// Whether parameters are those of a rigid body.
#[cfg(test)]
pub(crate) fn is_body(parameters: &[f64; BODY]) -> bool {
    parameters[0] > 0.0 && matrix(parameters).cholesky().is_some()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::regressor::body_of;
    use crate::test_arms::{random_arm, values};

    #[test]
    fn gradient_and_hessian_are_the_differences_of_the_distance() {
        let arm = random_arm(2, 4);
        let [here, there] = [0, 1].map(|j: usize| sound(&arm.joints[j].link).unwrap());
        let pull = Pull::towards(&there).unwrap();
        let (gradient, hessian) = pull.derivatives(&here).unwrap();
        for k in 0..BODY {
            let step = 1e-7;
            let moved = |by: f64| {
                let mut p = here;
                p[k] += by;
                p
            };
            let slope = (pull.distance(&moved(step)).unwrap() - pull.distance(&moved(-step)).unwrap()) / (2.0 * step);
            assert!(
                (slope - gradient[k]).abs() < 1e-5 * (1.0 + slope.abs()),
                "{k}: {slope} {}",
                gradient[k]
            );
            let (ahead, behind) = (
                pull.derivatives(&moved(step)).unwrap().0,
                pull.derivatives(&moved(-step)).unwrap().0,
            );
            for l in 0..BODY {
                let bend = (ahead[l] - behind[l]) / (2.0 * step);
                assert!((bend - hessian[k][l]).abs() < 1e-5 * (1.0 + bend.abs()));
            }
        }
    }

    #[test]
    fn the_distance_is_least_at_its_aim_whatever_the_units() {
        let arm = random_arm(1, 9);
        let aim = sound(&arm.joints[0].link).unwrap();
        let pull = Pull::towards(&aim).unwrap();
        let (gradient, _) = pull.derivatives(&aim).unwrap();
        assert!(gradient.iter().all(|g| g.abs() < 1e-9));
        let least = pull.distance(&aim).unwrap();
        let state = &mut 3;
        for _ in 0..50 {
            let off = values(BODY, 1e-3, state);
            let other: Vec<f64> = aim.iter().zip(&off).map(|(a, b)| a + b).collect();
            assert!(pull.distance(&other).is_none_or(|d| d > least));
        }
    }

    #[test]
    fn a_body_that_is_none_is_made_sound_and_keeps_mass_and_centre() {
        let broken = Inertial {
            mass: 2.0,
            center_of_mass: Vector3::new(0.1, 0.0, 0.2),
            inertia: Matrix3::from_diagonal(&Vector3::new(0.01, 0.02, 0.05)),
        };
        let parameters = sound(&broken).unwrap();
        assert!(is_body(&parameters) && !is_body(&body_parameters(&broken)));
        let back = body_of(&parameters);
        assert!((back.center_of_mass - broken.center_of_mass).norm() < 1e-12 && back.mass == 2.0);
        assert!(sound(&Inertial::zero()).is_none());
    }
}
