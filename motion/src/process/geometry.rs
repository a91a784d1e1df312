//! Taught lines and circular arcs of the tool centre point by their arc length σ, base axes, m.
//!
//! ```text
//! line   p = from + t̂·σ
//! arc    p = start + sin φ·(n × o) − (1 − cos φ)·o        φ = σ/r,  o = start − centre ⟂ n      (Rodrigues 1840)
//! ```
//!
//! 1 − cos φ is 2·sin²(φ/2): it keeps its figures on an arc that is nearly straight.

use std::f64::consts::TAU;

use nalgebra::Vector3;

use crate::jet::Jet;
use crate::tolerance::{ARC_PLANE_SLACK, PROCESS_LENGTH_MIN};

/// One taught segment of a process path, in base axes, m.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum ProcessSegment {
    /// A straight line.
    Line {
        /// Where it begins.
        from: Vector3<f64>,
        /// Where it ends.
        to: Vector3<f64>,
    },
    /// A circular arc; a full circle and more than one are allowed.
    Arc {
        /// Of the circle.
        center: Vector3<f64>,
        /// Of its plane, of any length; turning is right-handed about it.
        normal: Vector3<f64>,
        /// Where it begins.
        start: Vector3<f64>,
        /// How far it turns, rad; negative turns the other way.
        angle: f64,
    },
}

/// Where a path is and how it runs on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathFrame {
    /// m.
    pub position: Vector3<f64>,
    /// Unit vector along the path.
    pub tangent: Vector3<f64>,
    /// d²p/dσ², 1/m: towards the centre, one over the radius long; 0 on a line.
    pub curvature: Vector3<f64>,
}

/// A taught segment, ready to compute with.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Segment {
    start: Vector3<f64>,
    /// m.
    pub(super) length: f64,
    form: Form,
}

#[derive(Debug, Clone, PartialEq)]
enum Form {
    Line {
        tangent: Vector3<f64>,
    },
    Arc {
        /// o: from the centre to the start.
        out: Vector3<f64>,
        /// n × o: the tangent at the start, as long as the radius.
        along: Vector3<f64>,
        normal: Vector3<f64>,
        radius: f64,
        angle: f64,
    },
}

impl Segment {
    /// Or what is wrong with it.
    pub(super) fn new(taught: &ProcessSegment) -> Result<Self, String> {
        let segment = match *taught {
            ProcessSegment::Line { from, to } => {
                let way = to - from;
                let length = way.norm();
                let form = Form::Line { tangent: way / length };
                Self {
                    start: from,
                    length,
                    form,
                }
            }
            ProcessSegment::Arc {
                center,
                normal,
                start,
                angle,
            } => Self::arc(&center, &normal, start, angle)?,
        };
        // written so that NaN is refused too
        if !(segment.length >= PROCESS_LENGTH_MIN && segment.length.is_finite()) {
            return Err(format!(
                "is {} m long; a constant speed needs {PROCESS_LENGTH_MIN} m or more",
                segment.length
            ));
        }
        Ok(segment)
    }

    fn arc(center: &Vector3<f64>, normal: &Vector3<f64>, start: Vector3<f64>, angle: f64) -> Result<Self, String> {
        let longest = normal.amax();
        if !(longest > 0.0 && longest.is_finite()) {
            return Err("has no plane: its normal is zero".to_owned());
        }
        let normal = (normal / longest).normalize() * angle.signum();
        let from_center = start - center;
        let height = normal.dot(&from_center);
        let out = from_center - normal * height;
        let radius = out.norm();
        if !(radius >= PROCESS_LENGTH_MIN && radius.is_finite()) {
            return Err(format!("has the radius {radius} m"));
        }
        if height.abs() > ARC_PLANE_SLACK * radius {
            return Err(format!("has its start {} m outside the circle's plane", height.abs()));
        }
        let along = normal.cross(&out);
        let angle = angle.abs();
        let form = Form::Arc {
            out,
            along,
            normal,
            radius,
            angle,
        };
        Ok(Self {
            start,
            length: radius * angle,
            form,
        })
    }

    /// The point at an arc length that changes with time.
    pub(super) fn point(&self, way: Jet) -> [Jet; 3] {
        match &self.form {
            Form::Line { tangent } => std::array::from_fn(|axis| way * tangent[axis] + self.start[axis]),
            Form::Arc { out, along, radius, .. } => {
                let (sin, cos) = (way * (0.5 / radius)).sin_cos();
                let (around, inward) = (sin * cos * 2.0, sin * sin * 2.0);
                std::array::from_fn(|axis| around * along[axis] - inward * out[axis] + self.start[axis])
            }
        }
    }

    /// Position, tangent and curvature at an arc length.
    pub(super) fn frame(&self, way: f64) -> PathFrame {
        let [x, y, z] = self.point(Jet::variable(way, 1.0)).map(Jet::derivatives);
        let column = |order: usize| Vector3::new(x[order], y[order], z[order]);
        PathFrame {
            position: column(0),
            tangent: column(1),
            curvature: column(2),
        }
    }

    /// p(σ + δ) − p(σ), without the rounding of a difference of two points.
    pub(super) fn chord(&self, way: f64, change: f64) -> Vector3<f64> {
        let frame = self.frame(way);
        match self.form {
            Form::Line { .. } => frame.tangent * change,
            Form::Arc { radius, .. } => {
                let half_sine = libm::sin(0.5 * change / radius);
                let inward = 2.0 * radius * radius * half_sine * half_sine;
                frame.tangent * (radius * libm::sin(change / radius)) + frame.curvature * inward
            }
        }
    }

    /// 1/r; 0 on a line.
    pub(super) fn curvature(&self) -> f64 {
        match self.form {
            Form::Line { .. } => 0.0,
            Form::Arc { radius, .. } => 1.0 / radius,
        }
    }

    pub(super) fn is_line(&self) -> bool {
        matches!(self.form, Form::Line { .. })
    }

    /// Distance of a point from the nearest of the segment.
    pub(super) fn distance(&self, point: &Vector3<f64>) -> f64 {
        match &self.form {
            Form::Line { tangent } => {
                let from_start = point - self.start;
                let way = from_start.dot(tangent).clamp(0.0, self.length);
                (from_start - tangent * way).norm()
            }
            Form::Arc {
                out,
                along,
                normal,
                radius,
                angle,
            } => {
                let from_center = point - self.start + out;
                let (x, y) = (from_center.dot(out) / radius, from_center.dot(along) / radius);
                let turned = libm::atan2(y, x);
                let turned = if turned < 0.0 { turned + TAU } else { turned };
                if turned <= *angle {
                    let height = from_center.dot(normal);
                    let outward = (x * x + y * y).sqrt() - radius;
                    return (outward * outward + height * height).sqrt();
                }
                let to_end = point - self.frame(self.length).position;
                (point - self.start).norm().min(to_end.norm())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    fn arc(angle: f64) -> Segment {
        Segment::new(&ProcessSegment::Arc {
            center: Vector3::new(0.3, -0.1, 0.5),
            normal: Vector3::new(0.0, 0.0, 2.0),
            start: Vector3::new(0.4, -0.1, 0.5),
            angle,
        })
        .unwrap()
    }

    #[test]
    fn an_arc_turns_right_handed_about_its_normal() {
        let quarter = arc(PI / 2.0);
        assert!((quarter.length - 0.05 * PI).abs() < 1e-15);
        let end = quarter.frame(quarter.length);
        assert!((end.position - Vector3::new(0.3, 0.0, 0.5)).norm() < 1e-15, "{end:?}");
        assert!((end.tangent - Vector3::new(-1.0, 0.0, 0.0)).norm() < 1e-15, "{end:?}");
        assert!(
            (end.curvature - Vector3::new(0.0, -10.0, 0.0)).norm() < 1e-13,
            "{end:?}"
        );
        let back = arc(-PI / 2.0);
        let end = back.frame(back.length).position;
        assert!((end - Vector3::new(0.3, -0.2, 0.5)).norm() < 1e-15, "{end}");
    }

    #[test]
    fn distances_are_those_of_the_nearest_point() {
        let half = arc(PI);
        for (point, expected) in [
            (Vector3::new(0.3, -0.1, 0.5), 0.1),
            (Vector3::new(0.3, 0.2, 0.5), 0.2),
            (Vector3::new(0.3, 0.0, 0.6), 0.1),
            (Vector3::new(0.4, -0.4, 0.5), 0.3),
            (Vector3::new(0.15, -0.1, 0.5), 0.05),
        ] {
            let got = half.distance(&point);
            assert!((got - expected).abs() < 1e-15, "{point}: {got}");
        }
        let line = Segment::new(&ProcessSegment::Line {
            from: Vector3::zeros(),
            to: Vector3::new(2.0, 0.0, 0.0),
        })
        .unwrap();
        for (point, expected) in [
            (Vector3::new(1.0, 3.0, 4.0), 5.0),
            (Vector3::new(-3.0, 4.0, 0.0), 5.0),
            (Vector3::new(5.0, 0.0, 4.0), 5.0),
        ] {
            assert!((line.distance(&point) - expected).abs() < 1e-15);
        }
    }

    #[test]
    fn chords_are_differences_of_points() {
        let half = arc(PI);
        for (way, change) in [(0.0, 0.2), (half.length, -0.3), (0.1, 1e-9), (0.2, 0.0)] {
            let expected = half.frame(way + change).position - half.frame(way).position;
            assert!((half.chord(way, change) - expected).norm() < 1e-15);
        }
    }

    /// A nearly straight arc bends by σ²/(2r): half of a nanometre here, of which rounding in the centre would leave
    /// nothing.
    #[test]
    fn a_nearly_straight_arc_keeps_its_figures() {
        let (radius, way) = (1.0e6, 0.03125);
        let arc = Segment::new(&ProcessSegment::Arc {
            center: Vector3::new(-radius, 0.0, 0.0),
            normal: Vector3::z(),
            start: Vector3::zeros(),
            angle: 1.0e-6,
        })
        .unwrap();
        let point = arc.frame(way).position;
        assert!((point.x / (-way * way / (2.0 * radius)) - 1.0).abs() < 1e-12, "{point}");
    }

    #[test]
    fn what_is_no_segment_is_refused() {
        let line = |from, to| Segment::new(&ProcessSegment::Line { from, to }).unwrap_err();
        let origin = Vector3::zeros();
        assert!(line(origin, origin).contains("is 0 m long"));
        assert!(line(origin, Vector3::new(f64::NAN, 0.0, 0.0)).contains("NaN m long"));
        let arc = |normal, start, angle| {
            let center = Vector3::zeros();
            Segment::new(&ProcessSegment::Arc {
                center,
                normal,
                start,
                angle,
            })
            .unwrap_err()
        };
        assert!(arc(origin, Vector3::x(), 1.0).contains("normal is zero"));
        assert!(arc(Vector3::z(), origin, 1.0).contains("has the radius 0 m"));
        assert!(arc(Vector3::z(), Vector3::new(1.0, 0.0, 0.2), 1.0).contains("outside the circle's plane"));
        assert!(arc(Vector3::z(), Vector3::x(), 0.0).contains("is 0 m long"));
        assert!(arc(Vector3::z(), Vector3::x(), f64::NAN).contains("NaN"));
    }
}
