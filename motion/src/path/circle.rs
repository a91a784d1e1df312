//! The circle of an arc: through three points, about a centre, or of a radius.

use std::f64::consts::TAU;

use nalgebra::Vector3;

use super::shape::Circle;
use crate::tolerance::{ARC_MISFIT, COLLINEAR};

/// What is wrong with an arc: which of its fields, and why.
pub(super) type Misfit = (&'static str, String);

/// From `a` through `b` to `c`; all the way round where `full`.
pub(super) fn through(a: &Vector3<f64>, b: &Vector3<f64>, c: &Vector3<f64>, full: bool) -> Result<Circle, Misfit> {
    let (u, v) = (b - a, c - a);
    let normal = u.cross(&v);
    let (uu, vv) = (u.norm_squared(), v.norm_squared());
    let square = normal.norm_squared();
    if square <= COLLINEAR * COLLINEAR * uu * vv || (u - v).norm_squared() <= COLLINEAR * COLLINEAR * uu {
        let message = "start, via point and end lie on one line, or two of them coincide";
        return Err((".via", message.to_owned()));
    }
    // the centre of a triangle's circumcircle, from a (Coxeter 1969, section 1.5)
    let center = a + (v * uu - u * vv).cross(&normal) * (0.5 / square);
    let sweep = if full {
        TAU
    } else {
        angle(&(a - center), &(c - center), &normal.normalize())
    };
    Ok(about(a, center, &normal.normalize(), sweep))
}

/// About `center` from `a` to `c`, or all the way round. The centre is moved to be as far from both.
pub(super) fn around(
    a: &Vector3<f64>,
    center: &Vector3<f64>,
    c: Option<&Vector3<f64>>,
    normal: Option<&Vector3<f64>>,
    long_way: bool,
) -> Result<Circle, Misfit> {
    let radius = (a - center).norm();
    let Some(c) = c else {
        let normal = upright(normal.unwrap_or(&Vector3::zeros()), &(a - center))?;
        return positive_radius(radius, about(a, *center, &normal, TAU));
    };
    let misfit = (c - center).norm() - radius;
    if misfit.abs() > ARC_MISFIT * radius {
        let message = format!(
            "the centre is {radius:.6} m from the start and {:.6} m from the end",
            radius + misfit
        );
        return Err((".center_m", message));
    }
    let chord = c - a;
    let center = if chord.norm_squared() > 0.0 {
        center + chord * ((0.5 * (a + c) - center).dot(&chord) / chord.norm_squared())
    } else {
        *center
    };
    let (from, to) = (a - center, c - center);
    let given = match normal {
        Some(normal) => {
            let normal = upright(normal, &from)?;
            if normal.dot(&to).abs() > ARC_MISFIT * radius {
                return Err((
                    ".normal",
                    "it is not square to the plane of start, centre and end".to_owned(),
                ));
            }
            normal
        }
        None => {
            let normal = from.cross(&to);
            if normal.norm() <= COLLINEAR * radius * radius {
                let message = "start, centre and end lie on one line, so the arc needs a normal";
                return Err((".normal", message.to_owned()));
            }
            normal.normalize() * if long_way { -1.0 } else { 1.0 }
        }
    };
    let sweep = angle(&from, &to, &given);
    if normal.is_some() && long_way && sweep < 0.5 * TAU {
        return Err((
            ".long_way",
            "about the normal, the end is reached the short way".to_owned(),
        ));
    }
    // both ends are in the plane exactly
    let exact = if normal.is_some() && from.cross(&to).norm() > ARC_MISFIT * radius * radius {
        let plane = from.cross(&to).normalize();
        plane * plane.dot(&given).signum()
    } else {
        given
    };
    positive_radius(radius, about(a, center, &exact, sweep))
}

/// Of a radius, right-handed about `normal` from `a` to `c`.
pub(super) fn of_radius(
    a: &Vector3<f64>,
    c: &Vector3<f64>,
    radius: f64,
    normal: &Vector3<f64>,
    long_way: bool,
) -> Result<Circle, Misfit> {
    let chord = c - a;
    let length = chord.norm();
    if length <= COLLINEAR * radius {
        return Err((".target", "start and end coincide, so any circle would do".to_owned()));
    }
    let normal = upright(normal, &chord)?;
    let half = 0.5 * length;
    if half > radius * (1.0 + ARC_MISFIT) {
        let message = format!("{radius} m is too small: start and end are {length:.6} m apart");
        return Err((".radius_m", message));
    }
    let height = (radius * radius - half * half).max(0.0).sqrt();
    let left = normal.cross(&chord) / length;
    let center = a + chord * 0.5 + left * if long_way { -height } else { height };
    let sweep = angle(&(a - center), &(c - center), &normal);
    Ok(about(a, center, &normal, sweep))
}

fn positive_radius(radius: f64, circle: Circle) -> Result<Circle, Misfit> {
    if radius > COLLINEAR {
        return Ok(circle);
    }
    Err((".center_m", format!("the centre is the start, within {radius} m")))
}

fn about(start: &Vector3<f64>, center: Vector3<f64>, normal: &Vector3<f64>, sweep: f64) -> Circle {
    let radial = start - center;
    Circle {
        center,
        radial,
        tangent: normal.cross(&radial),
        sweep,
    }
}

/// The unit vector square to `line` that is nearest to `normal`; both must be square already, but for rounding.
fn upright(normal: &Vector3<f64>, line: &Vector3<f64>) -> Result<Vector3<f64>, Misfit> {
    let (size, square) = (normal.norm(), line.norm_squared());
    let tilt = if square > 0.0 { normal.dot(line) / square } else { 0.0 };
    if tilt.abs() * square.sqrt() > ARC_MISFIT * size {
        return Err((".normal", "it is not square to the plane of the arc".to_owned()));
    }
    Ok((normal - line * tilt).normalize())
}

/// The angle from one vector to another, right-handed about a unit vector, above 0 up to a full turn.
fn angle(from: &Vector3<f64>, to: &Vector3<f64>, normal: &Vector3<f64>) -> f64 {
    let angle = libm::atan2(from.cross(to).dot(normal), from.dot(to));
    if angle > 0.0 { angle } else { angle + TAU }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;
    use crate::test_arms::{random, values};

    fn point(circle: &Circle, v: f64) -> Vector3<f64> {
        let (sin, cos) = (v * circle.sweep).sin_cos();
        circle.center + circle.radial * cos + circle.tangent * sin
    }

    fn vector(state: &mut u64) -> Vector3<f64> {
        Vector3::from_iterator(values(3, 1.0, state))
    }

    /// Every way to give it finds the circle that the points were taken from.
    #[test]
    fn finds_the_circle_again() {
        let state = &mut 2;
        for _ in 0..500 {
            let (center, radius) = (vector(state), 0.05 + 0.5 * (1.0 + random(state)));
            let normal = vector(state).normalize();
            let radial = normal.cross(&vector(state)).normalize() * radius;
            let sweep = PI + 3.0 * random(state);
            let circle = Circle {
                center,
                radial,
                tangent: normal.cross(&radial),
                sweep,
            };
            let (a, b, c) = (point(&circle, 0.0), point(&circle, 0.4), point(&circle, 1.0));
            let found = [
                through(&a, &b, &c, false).unwrap(),
                around(&a, &center, Some(&c), Some(&normal), false).unwrap(),
                around(&a, &center, Some(&c), None, sweep > PI).unwrap(),
                of_radius(&a, &c, radius, &normal, sweep > PI).unwrap(),
            ];
            for found in found {
                // near a full or half turn the chord, or the height over it, is short: digits are lost
                let slack = 1e-12
                    / (sweep / 2.0)
                        .sin()
                        .abs()
                        .min((sweep / 2.0).cos().abs())
                        .min(0.1)
                        .powi(2);
                for v in [0.0, 0.3, 0.7, 1.0] {
                    let error = (point(&found, v) - point(&circle, v)).norm();
                    assert!(error < slack, "{error} at {v} of {sweep}");
                }
            }
        }
    }

    #[test]
    fn a_full_circle_closes() {
        let (a, b, c) = (Vector3::x(), Vector3::y(), -Vector3::x());
        let full = through(&a, &b, &c, true).unwrap();
        assert!((point(&full, 1.0) - a).norm() < 1e-15);
        assert!((point(&full, 0.25) - b).norm() < 1e-15);
        let full = around(&a, &Vector3::zeros(), None, Some(&-Vector3::z()), false).unwrap();
        assert!((point(&full, 0.25) + b).norm() < 1e-15);
    }

    #[test]
    fn what_is_no_circle_is_refused() {
        let (x, y, o) = (Vector3::x(), Vector3::y(), Vector3::zeros());
        let field = |misfit: Result<Circle, Misfit>| misfit.unwrap_err().0;
        assert_eq!(field(through(&o, &x, &(2.0 * x), false)), ".via");
        assert_eq!(field(through(&o, &o, &x, false)), ".via");
        assert_eq!(field(through(&o, &x, &x, false)), ".via");
        assert_eq!(field(through(&o, &x, &o, false)), ".via");
        assert_eq!(field(around(&x, &o, Some(&(1.1 * y)), None, false)), ".center_m");
        assert_eq!(field(around(&x, &o, Some(&-x), None, false)), ".normal");
        assert_eq!(field(around(&x, &o, Some(&y), Some(&x), false)), ".normal");
        assert_eq!(field(around(&x, &o, Some(&y), Some(&Vector3::z()), true)), ".long_way");
        assert_eq!(field(around(&x, &x, Some(&x), Some(&y), false)), ".center_m");
        assert_eq!(field(of_radius(&o, &x, 0.49, &Vector3::z(), false)), ".radius_m");
        assert_eq!(field(of_radius(&o, &x, 1.0, &x, false)), ".normal");
        assert_eq!(field(of_radius(&o, &o, 1.0, &x, false)), ".target");
    }

    /// Right-handed about z from x to y is a quarter, about −z the rest.
    #[test]
    fn the_normal_decides_the_way() {
        let (x, y, o) = (Vector3::x(), Vector3::y(), Vector3::zeros());
        let sweep = |normal: &Vector3<f64>| around(&x, &o, Some(&y), Some(normal), false).unwrap().sweep;
        assert!((sweep(&Vector3::z()) - FRAC_PI_2).abs() < 1e-15);
        assert!((sweep(&-Vector3::z()) - 3.0 * FRAC_PI_2).abs() < 1e-15);
        // a half turn at the limit of the radius
        let half = of_radius(&x, &-x, 1.0, &Vector3::z(), false).unwrap();
        assert!((half.sweep - PI).abs() < 1e-7);
    }
}
