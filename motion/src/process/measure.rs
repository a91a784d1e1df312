//! What a transition of reach D costs, by its geometry alone: deviation, slowest moment, largest acceleration.
//!
//! With t = 2·ta·h and ta = D/Vs, velocity is dp/dh·Vs/(2D) and acceleration d²p/dh²·Vs²/(4D²).

use super::search::{largest, largest_that, power_within, smallest};
use super::transition::{Curve, Node};
use crate::path::request::Transition;

/// 3/16: the part of D that the quartic keeps from the taught point at h = ½, per unit of |t̂+ − t̂−|.
const QUARTIC_CUT: f64 = 0.1875;

/// Distance between the transition and the taught path, m: the larger of how far the tool gets from the taught segments
/// and how far the taught point is from the tool's way. (On a path that turns back on itself the first is 0, and yet
/// the tool never gets to the taught point.)
pub(super) fn deviation(node: &Node<'_>, form: Transition, reach: f64) -> f64 {
    let Curve::Polynomial(polynomial) = node.curve(form, reach) else {
        return 0.0;
    };
    let corner = node.corner();
    let off_corner = smallest(|h| (polynomial.position(h) - corner).norm());
    off_path(node, form, reach).max(off_corner)
}

/// How far the tool gets from the taught segments, m.
pub(super) fn off_path(node: &Node<'_>, form: Transition, reach: f64) -> f64 {
    match node.curve(form, reach) {
        Curve::Ramp(_) => 0.0,
        Curve::Polynomial(polynomial) => largest(|h| node.distance(&polynomial.position(h))),
    }
}

/// A reach, up to `most`, as large as may be whose deviation is within `tolerance`.
pub(super) fn reach_within(node: &Node<'_>, form: Transition, tolerance: f64, most: f64) -> f64 {
    if let Some(turn) = node.turn_of_lines() {
        return match node {
            Node::Seam(..) => most.min(tolerance / (QUARTIC_CUT * turn)),
            Node::Start(_) | Node::End(_) => most,
        };
    }
    power_within(most, tolerance, |reach| deviation(node, form, reach))
}

/// Lowest speed, as part of Vs.
pub(super) fn slowest(node: &Node<'_>, form: Transition, reach: f64) -> f64 {
    match (node, node.curve(form, reach)) {
        (Node::Start(_) | Node::End(_), _) | (_, Curve::Ramp(_)) => 0.0,
        (Node::Seam(..), Curve::Polynomial(polynomial)) => {
            // of the square, which has no kink where the speed is 0
            smallest(|h| polynomial.rates(h)[0].norm_squared()).max(0.0).sqrt() / (2.0 * reach)
        }
    }
}

/// Largest acceleration over Vs², 1/m.
pub(super) fn sharpest(node: &Node<'_>, form: Transition, reach: f64) -> f64 {
    let square = 4.0 * reach * reach;
    if let Some(turn) = node.turn_of_lines() {
        return 0.75 * turn / reach;
    }
    let within = match node.curve(form, reach) {
        Curve::Polynomial(polynomial) => largest(|h| polynomial.rates(h)[1].norm_squared()),
        Curve::Ramp(ramp) => {
            let curvature = node.taught_curvature();
            largest(|h| {
                let [first, second] = ramp.rates(h);
                let across = first * first * curvature;
                second * second + across * across
            })
        }
    };
    within.sqrt() / square
}

/// The smallest reach from `least` up to `most` whose acceleration over Vs² is within `bound`, 1/m; `most` where none
/// is.
pub(super) fn reach_gentle(node: &Node<'_>, form: Transition, bound: f64, least: f64, most: f64) -> f64 {
    if let Some(turn) = node.turn_of_lines() {
        return (0.75 * turn / bound).max(least).min(most);
    }
    if least >= most || sharpest(node, form, least) <= bound {
        return least.min(most);
    }
    // gentler with growing reach: what must still be added to `most` downwards
    most - largest_that(most - least, |spare| sharpest(node, form, most - spare) <= bound)
}
