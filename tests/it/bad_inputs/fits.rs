//! What a fit cannot have found.

use takt_proto::v1::{
    FittedParameter, JointResidual, LinkInertia, ModelOrigin, ModelUncertainty, fitted_parameter::Kind,
};

use super::{Row, descriptions::row};

const NAN: f64 = f64::NAN;
const INF: f64 = f64::INFINITY;

/// What a fit committed, as it should be.
fn known() -> ModelUncertainty {
    let residual = |joint: &str| JointResidual {
        joint: joint.to_owned(),
        deviation: 0.5,
        correlation_time_s: 0.2,
        degrees_of_freedom: Some(5.0),
    };
    let parameter = |joint: &str, kind: Kind| FittedParameter {
        joint: joint.to_owned(),
        kind: kind.into(),
    };
    ModelUncertainty {
        parameters: vec![parameter("a", Kind::Viscous), parameter("b", Kind::Mass)],
        covariance: vec![1.0, 0.5, 1.0],
        residuals: vec![residual("a"), residual("b")],
    }
}

fn uncertain(name: &str, change: impl FnOnce(&mut ModelUncertainty), field: &str) -> Row {
    let mut uncertainty = known();
    change(&mut uncertainty);
    let field = format!("uncertainty.{field}");
    row(
        &format!("uncertainty: {name}"),
        |d| d.uncertainty = Some(uncertainty),
        &[&field],
    )
}

fn body(name: &str, bodies: Vec<LinkInertia>, field: &str) -> Row {
    let field = format!("link_inertia{field}");
    row(&format!("link inertia: {name}"), |d| d.link_inertia = bodies, &[&field])
}

pub(super) fn rows() -> Vec<Row> {
    let of = |joint: &str, mass_kg: Option<f64>| LinkInertia {
        joint: joint.to_owned(),
        mass_kg,
        ..Default::default()
    };
    let shaped = |center: Vec<f64>, inertia: Vec<f64>| LinkInertia {
        center_of_mass_m: center,
        inertia_kg_m2: inertia,
        ..of("a", Some(1.0))
    };
    vec![
        body("without a joint", vec![of("", Some(1.0))], "[0].joint"),
        body("of another joint", vec![of("z", Some(1.0))], "[0].joint"),
        body("twice", vec![of("a", Some(1.0)), of("a", Some(1.0))], "[1].joint"),
        body("without mass", vec![of("a", None)], "[0].mass_kg"),
        body("mass negative", vec![of("a", Some(-1.0))], "[0].mass_kg"),
        body("mass NaN", vec![of("a", Some(NAN))], "[0].mass_kg"),
        body(
            "center of two",
            vec![shaped(vec![0.0; 2], vec![])],
            "[0].center_of_mass_m",
        ),
        body(
            "inertia of five",
            vec![shaped(vec![], vec![1.0; 5])],
            "[0].inertia_kg_m2",
        ),
        body("thirty-three", vec![of("a", Some(1.0)); 33], ""),
        uncertain(
            "a parameter of another joint",
            |u| u.parameters[1].joint = "z".to_owned(),
            "parameters[1].joint",
        ),
        uncertain(
            "a parameter of no kind",
            |u| u.parameters[0].kind = 0,
            "parameters[0].kind",
        ),
        uncertain(
            "a parameter twice",
            |u| u.parameters[1] = u.parameters[0].clone(),
            "parameters[1]",
        ),
        uncertain("a covariance too short", |u| u.covariance.truncate(2), "covariance"),
        uncertain(
            "a covariance that is not finite",
            |u| u.covariance[1] = INF,
            "covariance[1]",
        ),
        uncertain("a negative variance", |u| u.covariance[0] = -1.0, "covariance[0]"),
        uncertain("a correlation above 1", |u| u.covariance[1] = 1.1, "covariance"),
        uncertain("a residual too few", |u| u.residuals.truncate(1), "residuals"),
        row(
            "uncertainty: a residual of another joint",
            |d| {
                d.uncertainty = Some(known());
                d.uncertainty.get_or_insert_default().residuals[1].joint = "z".to_owned();
            },
            &["uncertainty.residuals[1].joint", "uncertainty.residuals"],
        ),
        uncertain(
            "a negative deviation",
            |u| u.residuals[1].deviation = -1.0,
            "residuals[1].deviation",
        ),
        uncertain(
            "no correlation time",
            |u| u.residuals[0].correlation_time_s = 0.0,
            "residuals[0].correlation_time_s",
        ),
        uncertain(
            "no degree of freedom",
            |u| u.residuals[0].degrees_of_freedom = Some(0.0),
            "residuals[0].degrees_of_freedom",
        ),
        row(
            "origin: a note of a megabyte",
            |d| {
                d.origin = Some(ModelOrigin {
                    note: "x".repeat(1 << 20),
                    ..Default::default()
                });
            },
            &["origin.note"],
        ),
    ]
}
