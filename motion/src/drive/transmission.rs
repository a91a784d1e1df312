//! The elastic transmission of one joint: torque of a deformation, deformation of a torque.
//!
//! ```text
//! τE(Φ) = Σ kⱼ·Φ^(2j−1),  j = 1 … P       K(Φ) = dτE/dΦ = Σ (2j−1)·kⱼ·Φ^(2j−2)       τJ = τE(Φ) + D·Φ̇
//! ```
//!
//! Φ = Θ − q in rad (m), τ in N m (N), at the joint ("controlling a robot arm based on adaptive friction", eq 3 to 6).
//! With a negative kⱼ the polynomial may rise only up to some deformation, where K is 0; beyond it a torque has no deformation,
//! and the description is out of its range. The inverse is refused there.

use crate::robot::bounds::MAX_STIFFNESS_TERMS;
use crate::robot::spec::Drive;
use crate::tolerance::{TRANSMISSION_BISECTIONS, TRANSMISSION_ROUNDING, TRANSMISSION_ROUNDS};

/// A transmission that flexes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transmission {
    /// kⱼ; 0 beyond the last.
    coefficients: [f64; MAX_STIFFNESS_TERMS],
    damping: f64,
    /// Deformation at which the polynomial stops to rise, and the torque there; infinite where it rises for ever.
    largest: Point,
}

/// A deformation with its torque.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// rad or m.
    pub deformation: f64,
    /// N m or N.
    pub torque: f64,
}

impl Transmission {
    /// The transmission of a drive; `None` where it has no stiffness: it is rigid.
    #[must_use]
    pub fn new(drive: &Drive) -> Option<Self> {
        let count = drive.stiffness.len();
        let sound = count <= MAX_STIFFNESS_TERMS && drive.stiffness.first().is_some_and(|linear| *linear > 0.0);
        if !sound {
            return None;
        }
        let mut coefficients = [0.0; MAX_STIFFNESS_TERMS];
        coefficients[..count].copy_from_slice(&drive.stiffness);
        let mut transmission = Self {
            coefficients,
            damping: drive.damping.unwrap_or(0.0),
            largest: Point {
                deformation: f64::INFINITY,
                torque: f64::INFINITY,
            },
        };
        let mut slope = coefficients;
        for (j, coefficient) in slope.iter_mut().enumerate() {
            *coefficient *= (2 * j + 1) as f64;
        }
        if let Some(square) = first_positive_root(&slope) {
            let deformation = square.sqrt();
            transmission.largest = Point {
                deformation,
                torque: transmission.torque(deformation),
            };
        }
        Some(transmission)
    }

    /// τE.
    #[must_use]
    #[inline]
    pub fn torque(&self, deformation: f64) -> f64 {
        let square = deformation * deformation;
        deformation * self.coefficients.iter().rev().fold(0.0, |sum, k| sum * square + k)
    }

    /// K, the slope of τE.
    #[must_use]
    pub fn stiffness(&self, deformation: f64) -> f64 {
        let square = deformation * deformation;
        let terms = self.coefficients.iter().enumerate().rev();
        terms.fold(0.0, |sum, (j, k)| sum * square + (2 * j + 1) as f64 * k)
    }

    /// dK/dΦ.
    #[must_use]
    pub fn stiffness_slope(&self, deformation: f64) -> f64 {
        let square = deformation * deformation;
        let terms = self.coefficients.iter().enumerate().skip(1).rev();
        deformation * terms.fold(0.0, |sum, (j, k)| sum * square + (2 * j * (2 * j + 1)) as f64 * k)
    }

    /// Potential energy of a deformation, ∫ τE dΦ, J.
    #[must_use]
    pub fn energy(&self, deformation: f64) -> f64 {
        let square = deformation * deformation;
        let terms = self.coefficients.iter().enumerate().rev();
        square * terms.fold(0.0, |sum, (j, k)| sum * square + k / (2 * j + 2) as f64)
    }

    /// D, N m s/rad or N s/m.
    #[must_use]
    pub fn damping(&self) -> f64 {
        self.damping
    }

    /// The largest deformation that the polynomial describes, and its torque; infinite where it rises for ever.
    #[must_use]
    pub fn largest(&self) -> Point {
        self.largest
    }

    /// τE⁻¹: the deformation that passes a torque; `None` beyond the largest.
    ///
    /// Newton's method within a bracket that shrinks in every round, so that it ends wherever the polynomial rises.
    #[must_use]
    pub fn deformation(&self, torque: f64) -> Option<f64> {
        let asked = torque.abs();
        if !(asked < self.largest.torque) {
            return None;
        }
        let (mut low, mut high) = (0.0, self.largest.deformation);
        let mut found = asked / self.coefficients[0];
        for _ in 0..TRANSMISSION_ROUNDS {
            if !(found > low && found < high) {
                // towards an open end by doubling: a polynomial that rises for ever gets there
                found = if high.is_finite() {
                    0.5 * (low + high)
                } else {
                    2.0 * low
                };
            }
            let excess = self.torque(found) - asked;
            if excess > 0.0 {
                high = found;
            } else {
                low = found;
            }
            let next = found - excess / self.stiffness(found);
            let settled = (next - found).abs() <= TRANSMISSION_ROUNDING * found.abs();
            found = next;
            if settled {
                break;
            }
        }
        Some(found.copysign(torque))
    }
}

/// The smallest x > 0 where Σ aᵢ·xⁱ, positive at 0, becomes negative.
fn first_positive_root(coefficients: &[f64]) -> Option<f64> {
    let degree = coefficients.iter().rposition(|a| *a != 0.0)?;
    let leading = coefficients[degree];
    if coefficients[..=degree].iter().all(|a| *a >= 0.0) {
        return None;
    }
    // Cauchy: no root is larger
    let bound = 1.0
        + coefficients[..degree]
            .iter()
            .fold(0.0, |most: f64, a| most.max((a / leading).abs()));
    let roots = sign_changes(&coefficients[..=degree], bound);
    roots.first().copied()
}

/// Where a polynomial changes its sign in (0, bound), in order: between the sign changes of its derivative it is monotone.
fn sign_changes(coefficients: &[f64], bound: f64) -> Vec<f64> {
    if coefficients.len() < 2 {
        return Vec::new();
    }
    let derivative: Vec<f64> = (1..coefficients.len()).map(|i| i as f64 * coefficients[i]).collect();
    let mut edges = vec![0.0];
    edges.extend(sign_changes(&derivative, bound));
    edges.push(bound);
    let value = |x: f64| coefficients.iter().rev().fold(0.0, |sum, a| sum * x + a);
    let crossing = |ends: &[f64]| {
        let (mut low, mut high) = (ends[0], ends[1]);
        let rising = value(high) > 0.0;
        if (value(low) > 0.0) == rising {
            return None;
        }
        for _ in 0..TRANSMISSION_BISECTIONS {
            let middle = 0.5 * (low + high);
            if (value(middle) > 0.0) == rising {
                high = middle;
            } else {
                low = middle;
            }
        }
        Some(low)
    };
    edges.windows(2).filter_map(crossing).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_arms::random;

    fn transmission(stiffness: &[f64]) -> Transmission {
        let drive = Drive {
            stiffness: stiffness.to_vec(),
            damping: Some(2.0),
            ..Drive::default()
        };
        Transmission::new(&drive).unwrap()
    }

    #[test]
    fn a_drive_without_stiffness_is_rigid() {
        assert_eq!(Transmission::new(&Drive::default()), None);
    }

    /// Slope, slope's slope and energy against central differences.
    #[test]
    fn the_derivatives_are_those_of_the_torque() {
        let elastic = transmission(&[1.0e4, 3.0e7, -2.0e9, 5.0e12]);
        for k in -10..=10 {
            let (at, step) = (1.0e-3 * f64::from(k), 1.0e-6);
            let difference = |f: &dyn Fn(f64) -> f64| (f(at + step) - f(at - step)) / (2.0 * step);
            let slope = difference(&|x| elastic.torque(x));
            assert!((elastic.stiffness(at) - slope).abs() < 1e-6 * slope);
            let bend = difference(&|x| elastic.stiffness(x));
            assert!((elastic.stiffness_slope(at) - bend).abs() < 1e-6 * (1.0e4 + bend.abs()));
            let force = difference(&|x| elastic.energy(x));
            assert!((elastic.torque(at) - force).abs() < 1e-6 * (1.0 + force.abs()));
        }
    }

    #[test]
    fn the_inverse_is_the_inverse() {
        let state = &mut 7;
        for _ in 0..2000 {
            let scale = libm::pow(10.0, 3.0 * random(state));
            let (linear, cubic) = (1.0e4 * scale, 1.0e9 * scale * random(state));
            let elastic = transmission(&[linear, cubic, 1.0e13 * (1.0 + random(state))]);
            let reach = elastic.largest().deformation.min(0.05);
            let at = 0.999 * reach * random(state);
            let found = elastic.deformation(elastic.torque(at)).unwrap();
            // near the largest torque the curve is flat and many deformations have the same torque to within rounding
            let slack = 1e-12 * at.abs() + 1e-14 * elastic.torque(at).abs() / elastic.stiffness(at).max(1e-3);
            assert!((found - at).abs() <= slack, "{found} {at} {elastic:?}");
        }
    }

    /// τ = k·Φ − c·Φ³ rises up to Φ = √(k/3c), where it is 2/3·k·Φ.
    #[test]
    fn a_torque_beyond_the_first_maximum_has_no_deformation() {
        let elastic = transmission(&[3.0e4, -1.0e8]);
        let largest = elastic.largest();
        assert!((largest.deformation - 0.01).abs() < 1e-15);
        assert!((largest.torque - 200.0).abs() < 1e-9);
        assert_eq!(elastic.deformation(200.001), None);
        assert_eq!(elastic.deformation(-201.0), None);
        assert!(elastic.deformation(199.999).is_some());
        assert_eq!(elastic.deformation(f64::NAN), None);
        // it falls and rises again: what is beyond the dip is not reached through it
        let dip = transmission(&[1.0e4, -2.0e8, 1.5e12]);
        assert!(dip.largest().deformation < 0.01 && dip.deformation(dip.largest().torque * 1.01).is_none());
    }
}
