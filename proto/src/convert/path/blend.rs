//! How a program goes from one segment into the next.

use takt_motion::path::request::{Blend, Extent, Space, Weight};

use super::request::{SPACES, optional_enum, space_or};
use crate::{
    convert::{Findings, Path},
    v1,
};

/// Steepness of the sigmoid where none is given: the source's figure.
const STEEPNESS: f64 = 5.0;

const WEIGHTS: &str = "SMOOTHSTEP, TAN_SIGMOID";

/// Reads a blend; where it does not say its space, that is `default`.
pub(super) fn read(wire: v1::Blend, default: Space, at: Path<'_>, findings: &mut Findings) -> Blend {
    let lengths = wire.before.is_some() || wire.after.is_some();
    let ways = [wire.radius_m.is_some(), wire.fraction.is_some(), lengths];
    if ways.iter().filter(|given| **given).count() != 1 {
        findings.push(
            at,
            "must have exactly one of `radius_m`, `fraction`, `before` and `after`",
        );
    }
    let extent = if let Some(radius) = findings.positive_option(at.field("radius_m"), wire.radius_m, " m") {
        Extent::Radius(radius)
    } else if let Some(fraction) = wire.fraction {
        let fraction_at = at.field("fraction");
        if fraction >= 1.0 {
            findings.push(fraction_at, format!("{fraction} must be below 1"));
        }
        Extent::Fraction(findings.fraction(fraction_at, Some(fraction.min(1.0))))
    } else if !lengths {
        // Stands for what is missing, as the finding says.
        Extent::Fraction(0.5)
    } else {
        let mut length = |name: &'static str, value: Option<f64>| {
            if value.is_none() {
                findings.push(at.field(name), "must be given too");
            }
            findings.positive_option(at.field(name), value, "").unwrap_or(0.0)
        };
        Extent::Lengths {
            before: length("before", wire.before),
            after: length("after", wire.after),
        }
    };
    let space = optional_enum(findings, at.field("space"), wire.space, SPACES);
    let weight = optional_enum(findings, at.field("weight"), wire.weight, WEIGHTS);
    let steepness_at = at.field("steepness");
    let steepness = findings.positive_option(steepness_at, wire.steepness, "");
    let weight = match weight {
        Some(v1::blend::Weight::TanSigmoid) => Weight::TanSigmoid {
            a: steepness.unwrap_or(STEEPNESS),
        },
        Some(v1::blend::Weight::Smoothstep | v1::blend::Weight::Unspecified) | None => {
            if steepness.is_some() {
                findings.push(
                    steepness_at,
                    "is the steepness of TAN_SIGMOID, and that is not the weight",
                );
            }
            Weight::Smoothstep
        }
    };
    Blend {
        extent,
        space: space_or(space, default),
        weight,
    }
}
