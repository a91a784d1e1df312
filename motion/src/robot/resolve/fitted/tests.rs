use nalgebra::{Isometry3, Matrix3, Vector3};

use super::{COVARIANCE_ROUNDING, at_diagonal, negative_pivot};
use crate::robot::description::{Description, DhConvention, DhLink, Kinematics, LinkEntry, UncertaintyEntry};
use crate::robot::spec::{Inertial, Parameter, ParameterKind, Residual};

fn description() -> Description {
    let link = |name: &str| DhLink {
        name: name.to_owned(),
        prismatic: false,
        a: 0.5,
        alpha: 0.0,
        d: 0.0,
        theta: 0.0,
        mass: 2.0,
        center_of_mass: Vector3::zeros(),
        inertia: Matrix3::identity(),
    };
    Description {
        tcp: Some(Isometry3::identity()),
        ..Description::new(Kinematics::Dh {
            convention: DhConvention::Standard,
            links: vec![link("a"), link("b")],
        })
    }
}

fn body(mass: f64) -> Inertial {
    Inertial {
        mass,
        center_of_mass: Vector3::new(0.1, 0.2, 0.3),
        inertia: Matrix3::identity() * 0.5,
    }
}

fn residual(deviation: f64) -> Residual {
    Residual {
        deviation,
        correlation_time: 0.2,
        degrees_of_freedom: f64::INFINITY,
    }
}

fn uncertainty() -> UncertaintyEntry {
    UncertaintyEntry {
        parameters: vec![
            ("b".to_owned(), ParameterKind::Viscous),
            ("a".to_owned(), ParameterKind::FirstMoment(1)),
        ],
        covariance: vec![4.0, 2.0, 1.0],
        residuals: vec![("b".to_owned(), residual(0.5)), ("a".to_owned(), residual(0.25))],
    }
}

fn refused(change: impl FnOnce(&mut Description)) -> Vec<String> {
    let mut description = description();
    description.uncertainty = Some(uncertainty());
    change(&mut description);
    let errors = description.resolve().expect_err("should be refused");
    errors.iter().map(ToString::to_string).collect()
}

fn check_refused(change: impl FnOnce(&mut Description), parts: &[&str]) {
    let errors = refused(change);
    assert_eq!(errors.len(), parts.len(), "{errors:#?}");
    for (error, part) in errors.iter().zip(parts) {
        assert!(error.contains(part), "{part:?} is not in {error:?}");
    }
}

fn change_of(change: impl FnOnce(&mut UncertaintyEntry)) -> impl FnOnce(&mut Description) {
    |description| {
        description.uncertainty.iter_mut().for_each({
            let mut change = Some(change);
            move |entry| change.take().into_iter().for_each(|change| change(entry))
        })
    }
}

#[test]
fn a_fitted_body_takes_the_place_of_the_chains() {
    let mut description = description();
    description.link_inertia = vec![LinkEntry {
        joint: "b".to_owned(),
        body: body(3.0),
    }];
    let before = super::super::Description {
        link_inertia: Vec::new(),
        ..description.clone()
    };
    let (before, after) = (before.resolve().unwrap().spec, description.resolve().unwrap().spec);
    assert_eq!(after.joints[0], before.joints[0]);
    assert_ne!(after.joints[1].link, before.joints[1].link);
    assert_eq!(after.joints[1].link, body(3.0));
}

#[test]
fn an_uncertainty_stands_in_model_order() {
    let mut description = description();
    description.uncertainty = Some(uncertainty());
    let found = description.resolve().unwrap().spec.uncertainty.unwrap();
    let parameter = |joint, kind| Parameter { joint, kind };
    assert_eq!(
        found.parameters,
        [
            parameter(1, ParameterKind::Viscous),
            parameter(0, ParameterKind::FirstMoment(1))
        ]
    );
    assert_eq!(found.covariance, [4.0, 2.0, 1.0]);
    assert_eq!(found.residuals, [residual(0.25), residual(0.5)]);
}

#[test]
fn what_a_fit_states_wrongly_is_named() {
    let entry = |joint: &str, mass| LinkEntry {
        joint: joint.to_owned(),
        body: body(mass),
    };
    check_refused(
        |d| d.link_inertia = vec![entry("c", -1.0), entry("a", 1.0), entry("a", 1.0)],
        &[
            "link_inertia[0].mass_kg: -1.0 kg must be at least",
            "link_inertia[0].joint: \"c\" is not a joint of the chain: \"a\", \"b\"",
            "link_inertia[2].joint: \"a\" is the joint of link_inertia[1] too",
        ],
    );
    check_refused(
        change_of(|u| u.parameters[1] = u.parameters[0].clone()),
        &["uncertainty.parameters[1]: is the same as uncertainty.parameters[0]"],
    );
    check_refused(
        change_of(|u| u.parameters[1].0 = "z".to_owned()),
        &["uncertainty.parameters[1].joint: \"z\" is not a joint"],
    );
    check_refused(
        change_of(|u| u.covariance.truncate(2)),
        &["uncertainty.covariance: has 2 values, the lower triangle of 2 parameters has 3"],
    );
    check_refused(
        change_of(|u| u.covariance[2] = -1.0),
        &["uncertainty.covariance[2]: a variance of -1.0 must not be negative"],
    );
    check_refused(
        change_of(|u| u.covariance[1] = 2.1),
        &["uncertainty.covariance: is not positive semidefinite: parameters[0] to parameters[1]"],
    );
    check_refused(
        change_of(|u| u.covariance[0] = f64::NAN),
        &["uncertainty.covariance[0]: NaN must be a finite number"],
    );
    check_refused(
        change_of(|u| u.residuals[1].0 = "b".to_owned()),
        &[
            "uncertainty.residuals[1].joint: \"b\" is the joint of uncertainty.residuals[0] too",
            "uncertainty.residuals: must have an entry for every joint, has none for \"a\"",
        ],
    );
    check_refused(
        change_of(|u| {
            u.residuals[0].1.deviation = -0.1;
            u.residuals[0].1.correlation_time = 0.0;
            u.residuals[0].1.degrees_of_freedom = 1.0;
        }),
        &[
            "residuals[0].deviation",
            "residuals[0].correlation_time_s",
            "residuals[0].degrees_of_freedom",
        ],
    );
}

/// The lower triangle of Gᵀ·G with a small multiple of another matrix's taken off its diagonal, by a plain double loop.
fn gram(rows: &[Vec<f64>], less: f64) -> Vec<f64> {
    let count = rows[0].len();
    let mut triangle = Vec::new();
    for i in 0..count {
        for j in 0..=i {
            let product: f64 = rows.iter().map(|row| row[i] * row[j]).sum();
            triangle.push(if i == j { product * (1.0 - less) } else { product });
        }
    }
    triangle
}

#[test]
fn semidefinite_is_told_from_indefinite_at_any_scale() {
    // Pseudo-random rows, fewer than columns: eigenvalues of 0; columns of sizes from 1e-6 to 1e6.
    let mut state = 7_u64;
    let mut draw = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    for count in [1_usize, 2, 5, 12, 30] {
        let size = |column: usize| libm::pow(10.0, (column % 7) as f64 * 2.0 - 6.0);
        let rows: Vec<Vec<f64>> = (0..count.div_ceil(2))
            .map(|_| (0..count).map(|column| draw() * size(column)).collect())
            .collect();
        assert_eq!(negative_pivot(&gram(&rows, 0.0), count), None, "{count} parameters");
        if count > 1 {
            let worse = gram(&rows, 10.0 * COVARIANCE_ROUNDING);
            assert!(negative_pivot(&worse, count).is_some(), "{count} parameters");
        }
    }
    // without variance there is none to share
    let mut triangle = vec![1.0, 0.0, 0.0];
    assert_eq!(negative_pivot(&triangle, 2), None);
    triangle[1] = 1e-9;
    assert_eq!(negative_pivot(&triangle, 2), Some(1));
    assert_eq!([at_diagonal(0), at_diagonal(1), at_diagonal(2)], [0, 2, 5]);
}
