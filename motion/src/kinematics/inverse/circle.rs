//! Equations in the cosine and sine of one angle: what closed forms of inverse kinematics come down to.
//!
//! Turning a vector x by θ about a unit vector h gives rot(h, θ)·x = h·(h·x) + x⊥·cos θ + (h × x)·sin θ with
//! x⊥ = x − h·(h·x), so that every condition on a turned vector is linear in (c, s) = (cos θ, sin θ), and every condition
//! on a length at most quadratic (B. Paden 1986, W. Kahan 1983; A. J. Elias, J. T. Wen, "IK-Geo: Unified robot inverse
//! kinematics using subproblem decomposition", 2022).

use nalgebra::Vector3;

use super::quartic;
use crate::tolerance::{IK_CLAMP, IK_IDEAL, IK_NEARLY_FREE, IK_UNDETERMINED};

/// (cos θ, sin θ).
pub(super) type Direction = (f64, f64);

/// Up to four directions.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Directions {
    count: usize,
    entry: [Direction; 4],
}

impl Directions {
    pub(super) fn push(&mut self, direction: Direction) {
        if self.count < self.entry.len() {
            self.entry[self.count] = direction;
            self.count += 1;
        }
    }

    pub(super) fn as_slice(&self) -> &[Direction] {
        &self.entry[..self.count]
    }
}

/// What the equations of an arm that is not quite the ideal one let through, squared and over the circle's size.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slack {
    /// How far beyond the circle a solution may be.
    beyond: f64,
    /// How far apart two solutions are kept, so that Newton steps from them end at different ones.
    apart: f64,
}

impl Slack {
    /// Of an arm whose axes miss the ideal by `miss`, rad or over the arm's size.
    pub(super) fn of(miss: f64) -> Self {
        if miss <= IK_IDEAL {
            return Self {
                beyond: IK_CLAMP,
                apart: 0.0,
            };
        }
        let slack = IK_CLAMP.max(4.0 * miss);
        Self {
            beyond: slack,
            apart: slack,
        }
    }

    /// √x, where x may be below 0 by what is missing; `None` where it is further below.
    pub(super) fn root(&self, x: f64) -> Option<f64> {
        (x > -self.beyond).then(|| libm::sqrt(x.max(self.apart)))
    }
}

/// k.0 + k.1·c + k.2·s.
#[derive(Debug, Clone, Copy)]
pub(super) struct Linear(pub(super) f64, pub(super) f64, pub(super) f64);

/// A conic k + kc·c + ks·s + kcc·c² + kcs·c·s + kss·s².
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Conic {
    pub(super) k: f64,
    pub(super) kc: f64,
    pub(super) ks: f64,
    pub(super) kcc: f64,
    pub(super) kcs: f64,
    pub(super) kss: f64,
}

impl Linear {
    /// w·rot(h, θ)·x.
    pub(super) fn along_turned(w: &Vector3<f64>, h: &Vector3<f64>, x: &Vector3<f64>) -> Self {
        let fixed = w.dot(h) * h.dot(x);
        Self(fixed, w.dot(x) - fixed, w.dot(&h.cross(x)))
    }

    /// With θ turned round: s ↦ −s.
    pub(super) fn reversed(self) -> Self {
        Self(self.0, self.1, -self.2)
    }

    pub(super) fn at(&self, (c, s): Direction) -> f64 {
        self.0 + self.1 * c + self.2 * s
    }

    pub(super) fn scaled(self, by: f64) -> Self {
        Self(self.0 * by, self.1 * by, self.2 * by)
    }

    pub(super) fn minus(self, other: Self) -> Self {
        Self(self.0 - other.0, self.1 - other.1, self.2 - other.2)
    }

    /// |(kc, ks)|.
    pub(super) fn amplitude(&self) -> f64 {
        libm::sqrt(self.1 * self.1 + self.2 * self.2)
    }

    /// Where it is 0 on the circle. What misses the circle by little touches it: the arm is stretched there.
    pub(super) fn zeros(&self, slack: Slack) -> Directions {
        let mut zeros = Directions::default();
        let amplitude = self.amplitude();
        if amplitude <= 0.0 || !amplitude.is_finite() {
            return zeros;
        }
        // c·x + s·y = d with the unit vector (x, y): d·(x, y) ± √(1 − d²)·(−y, x)
        let (x, y, d) = (self.1 / amplitude, self.2 / amplitude, -self.0 / amplitude);
        let Some(w) = slack.root(1.0 - d * d) else {
            return zeros;
        };
        let norm = libm::sqrt(d * d + w * w);
        let (d, w) = (d / norm, w / norm);
        zeros.push((d * x - w * y, d * y + w * x));
        if w > 0.0 {
            zeros.push((d * x + w * y, d * y - w * x));
        }
        zeros
    }
}

impl Conic {
    /// Adds factor·f².
    pub(super) fn add_square(&mut self, f: Linear, factor: f64) {
        self.k += factor * f.0 * f.0;
        self.kc += factor * 2.0 * f.0 * f.1;
        self.ks += factor * 2.0 * f.0 * f.2;
        self.kcc += factor * f.1 * f.1;
        self.kcs += factor * 2.0 * f.1 * f.2;
        self.kss += factor * f.2 * f.2;
    }

    /// Adds factor·f.
    pub(super) fn add(&mut self, f: Linear, factor: f64) {
        self.k += factor * f.0;
        self.kc += factor * f.1;
        self.ks += factor * f.2;
    }

    fn at(&self, (c, s): Direction) -> f64 {
        self.k + self.kc * c + self.ks * s + self.kcc * c * c + self.kcs * c * s + self.kss * s * s
    }

    /// The same conic after c, s ↦ c·x − s·y, s·x + c·y: angles counted from the direction (x, y).
    fn turned(&self, (x, y): Direction) -> Self {
        Self {
            k: self.k,
            kc: self.kc * x + self.ks * y,
            ks: self.ks * x - self.kc * y,
            kcc: self.kcc * x * x + self.kcs * x * y + self.kss * y * y,
            kcs: 2.0 * (self.kss - self.kcc) * x * y + self.kcs * (x * x - y * y),
            kss: self.kcc * y * y - self.kcs * x * y + self.kss * x * x,
        }
    }

    /// Where it is 0 on the circle: with t = tan(θ/2), c = (1 − t²)/(1 + t²) and s = 2t/(1 + t²), a quartic in t. Angles
    /// are counted from where the conic is largest opposite, so that no root is near t = ∞.
    pub(super) fn zeros(&self, slack: Slack) -> Directions {
        // five places on the circle: a conic that is 0 at all of them is 0 on the whole circle
        const PLACES: [Direction; 5] = [
            (1.0, 0.0),
            (0.309_016_994_374_947_45, 0.951_056_516_295_153_5),
            (-0.809_016_994_374_947_5, 0.587_785_252_292_473_1),
            (-0.809_016_994_374_947_5, -0.587_785_252_292_473_1),
            (0.309_016_994_374_947_45, -0.951_056_516_295_153_5),
        ];
        let opposite = |(x, y): Direction| self.at((-x, -y)).abs();
        let from = PLACES.into_iter().fold(
            PLACES[0],
            |best, place| {
                if opposite(place) > opposite(best) { place } else { best }
            },
        );
        let f = self.turned(from);
        let polynomial = [
            f.k + f.kcc + f.kc,
            2.0 * (f.kcs + f.ks),
            2.0 * (f.k - f.kcc) + 4.0 * f.kss,
            2.0 * (f.ks - f.kcs),
            f.k + f.kcc - f.kc,
        ];
        let mut zeros = Directions::default();
        for t in quartic::nearly_real_roots(&polynomial, libm::sqrt(slack.beyond))
            .into_iter()
            .flatten()
        {
            let denominator = 1.0 + t * t;
            let (c, s) = ((1.0 - t * t) / denominator, 2.0 * t / denominator);
            zeros.push((c * from.0 - s * from.1, s * from.0 + c * from.1));
        }
        zeros
    }
}

/// The angle that turns one vector to another.
#[derive(Debug, Clone, Copy)]
pub(super) struct Turning {
    pub(super) direction: Direction,
    /// The vectors are so near to the axis that the angle may be any.
    pub(super) is_free: bool,
}

/// The angle that turns `from` to `to` about h; the reference's where one of them has nothing beside h that could be
/// turned. `size` is the length that they are measured against.
pub(super) fn turning(h: &Vector3<f64>, from: &Vector3<f64>, to: &Vector3<f64>, size: f64, reference: f64) -> Turning {
    let u = from - h * h.dot(from);
    let v = to - h * h.dot(to);
    let product = libm::sqrt(u.norm_squared() * v.norm_squared());
    let is_free = product <= IK_NEARLY_FREE * IK_NEARLY_FREE * size * size;
    if product <= IK_UNDETERMINED * IK_UNDETERMINED * size * size {
        let (s, c) = libm::sincos(reference);
        return Turning {
            direction: (c, s),
            is_free,
        };
    }
    let (c, s) = (u.dot(&v), h.dot(&u.cross(&v)));
    let norm = libm::sqrt(c * c + s * s);
    Turning {
        direction: (c / norm, s / norm),
        is_free,
    }
}

/// A unit vector at right angles to h.
pub(super) fn beside(h: &Vector3<f64>) -> Vector3<f64> {
    let a = h.abs();
    let other = if a.x <= a.y && a.x <= a.z {
        Vector3::x()
    } else if a.y <= a.z {
        Vector3::y()
    } else {
        Vector3::z()
    };
    let beside = h.cross(&other);
    beside / beside.norm()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use nalgebra::{Rotation3, Unit, Vector3};

    use super::{Conic, Linear, Slack, beside, turning};
    use crate::test_arms::random;

    fn vector(state: &mut u64) -> Vector3<f64> {
        Vector3::from_fn(|_, _| random(state))
    }

    /// How often the sign changes round the circle.
    fn sign_changes(f: impl Fn(f64, f64) -> f64) -> usize {
        let values: Vec<bool> = (0..=20_000)
            .map(|step| {
                let (s, c) = libm::sincos(TAU * f64::from(step) / 20_000.0);
                f(c, s) > 0.0
            })
            .collect();
        values.windows(2).filter(|pair| pair[0] != pair[1]).count()
    }

    #[test]
    fn conics_are_zero_where_they_change_sign() {
        let state = &mut 1;
        for _ in 0..200 {
            let mut conic = Conic {
                k: random(state),
                ..Conic::default()
            };
            conic.add_square(Linear(random(state), random(state), random(state)), 1.0);
            conic.add_square(Linear(random(state), random(state), random(state)), -1.0);
            conic.add(Linear(random(state), random(state), random(state)), 0.5);
            let zeros = conic.zeros(Slack::of(0.0));
            for &(c, s) in zeros.as_slice() {
                assert!((c * c + s * s - 1.0).abs() < 1e-14);
                assert!(conic.at((c, s)).abs() < 1e-12, "{conic:?}");
            }
            assert_eq!(
                zeros.as_slice().len(),
                sign_changes(|c, s| conic.at((c, s))),
                "{conic:?}"
            );
        }
    }

    #[test]
    fn lines_cut_the_circle_or_touch_it() {
        let line = Linear(-0.5, 0.6, 0.8);
        for &(c, s) in line.zeros(Slack::of(0.0)).as_slice() {
            assert!((0.6 * c + 0.8 * s - 0.5).abs() < 1e-15 && (c * c + s * s - 1.0).abs() < 1e-15);
        }
        assert_eq!(line.zeros(Slack::of(0.0)).as_slice().len(), 2);
        assert_eq!(
            Linear(1.0 + 1e-9, 0.6, 0.8).zeros(Slack::of(0.0)).as_slice(),
            [(-0.6, -0.8)]
        );
        assert_eq!(Linear(1.1, 0.6, 0.8).zeros(Slack::of(0.0)).as_slice(), []);
    }

    #[test]
    fn turns_are_nalgebras() {
        let state = &mut 2;
        for _ in 0..500 {
            let (h, x, w) = (vector(state).normalize(), vector(state), vector(state));
            let angle = 3.0 * random(state);
            let turned = Rotation3::from_axis_angle(&Unit::new_unchecked(h), angle) * x;
            let (s, c) = libm::sincos(angle);
            assert!((Linear::along_turned(&w, &h, &x).at((c, s)) - w.dot(&turned)).abs() < 1e-14);
            let found = turning(&h, &x, &turned, 1.0, 0.0);
            assert!((found.direction.0 - c).abs() < 1e-12 && (found.direction.1 - s).abs() < 1e-12);
            assert!(beside(&h).dot(&h).abs() < 1e-15 && (beside(&h).norm() - 1.0).abs() < 1e-15);
        }
        let (h, reference) = (Vector3::z(), 0.7);
        let found = turning(&h, &(h * 2.0), &Vector3::x(), 1.0, reference);
        assert!(found.is_free && found.direction == (libm::cos(reference), libm::sin(reference)));
    }
}
