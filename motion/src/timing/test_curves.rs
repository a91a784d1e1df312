//! Paths for tests: joint moves with rounded corners.

use crate::curve::{Curve, CurvePoint, Side};
use crate::jet::Jet;
use crate::robot::Robot;
use crate::robot::description::{Description, Kinematics};
use crate::test_arms::random;
use crate::timing::law::TimeLaw;

pub(super) fn set(point: &mut CurvePoint, joint: usize, value: Jet) {
    [
        point.position[joint],
        point.first[joint],
        point.second[joint],
        point.third[joint],
    ] = value.derivatives();
}

/// Straight joint moves between points, each corner rounded over half of the shorter of its two moves. On straight parts
/// the fastest joint has its given speed, so that s is about a time.
pub(crate) struct Rounded {
    points: Vec<Vec<f64>>,
    directions: Vec<Vec<f64>>,
    lengths: Vec<f64>,
    begins: Vec<f64>,
    overlaps: Vec<f64>,
    knots: Vec<f64>,
}

impl Rounded {
    pub(crate) fn new(points: Vec<Vec<f64>>, speeds: &[f64]) -> Self {
        let moves = || points.windows(2).map(|pair| (&pair[0], &pair[1]));
        let longest = |(from, to): (&Vec<f64>, &Vec<f64>)| {
            let times = from.iter().zip(to).zip(speeds).map(|((a, b), v)| (b - a).abs() / v);
            times.fold(0.0, f64::max)
        };
        let lengths: Vec<f64> = moves().map(longest).collect();
        let direction = |((from, to), length): ((&Vec<f64>, &Vec<f64>), &f64)| {
            from.iter().zip(to).map(|(a, b)| (b - a) / length).collect()
        };
        let directions = moves().zip(&lengths).map(direction).collect();
        let overlaps: Vec<f64> = lengths.windows(2).map(|pair| 0.5 * pair[0].min(pair[1])).collect();
        let mut begins = vec![0.0];
        for (length, overlap) in lengths.iter().zip(&overlaps) {
            begins.push(begins[begins.len() - 1] + length - overlap);
        }
        let mut knots = vec![0.0];
        for (begin, overlap) in begins[1..].iter().zip(&overlaps) {
            knots.extend([*begin, begin + overlap]);
        }
        knots.push(begins[begins.len() - 1] + lengths[lengths.len() - 1]);
        knots.dedup_by(|a, b| (*a - *b).abs() < 1e-12);
        Self {
            points,
            directions,
            lengths,
            begins,
            overlaps,
            knots,
        }
    }

    fn straight(&self, index: usize, joint: usize, s: Jet) -> Jet {
        (s + -self.begins[index]) * self.directions[index][joint] + self.points[index][joint]
    }
}

impl Curve for Rounded {
    fn joint_count(&self) -> usize {
        self.points[0].len()
    }

    fn length(&self) -> f64 {
        self.knots[self.knots.len() - 1]
    }

    fn knots(&self) -> &[f64] {
        &self.knots
    }

    fn evaluate(&self, s: f64, _: Side, point: &mut CurvePoint) {
        let s = s.clamp(0.0, self.length());
        let index = self.begins.partition_point(|begin| *begin <= s).max(1) - 1;
        let s = Jet::variable(s, 1.0);
        for joint in 0..self.joint_count() {
            let here = self.straight(index, joint, s);
            let mixed = match index.checked_sub(1) {
                Some(before) if s.value() < self.begins[index] + self.overlaps[before] => {
                    let x = (s + -self.begins[index]) * (1.0 / self.overlaps[before]);
                    let x2 = x * x;
                    let weight = x2 * x2 * (x * (x * (x * -20.0 + 70.0) + -84.0) + 35.0);
                    let there = self.straight(before, joint, s);
                    there + weight * (here - there)
                }
                _ => here,
            };
            set(point, joint, mixed);
        }
    }
}

impl std::fmt::Debug for Rounded {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Rounded").field("lengths", &self.lengths).finish()
    }
}

/// A rounded path of a random walk of the joints.
pub(crate) fn random_walk(count: usize, corners: usize, speeds: &[f64], seed: u64) -> Rounded {
    let state = &mut seed.clone();
    let mut points: Vec<Vec<f64>> = vec![(0..count).map(|_| 1.2 * random(state)).collect()];
    for _ in 0..=corners {
        let from = &points[points.len() - 1];
        points.push(from.iter().map(|q| (q + random(state)).clamp(-2.5, 2.5)).collect());
    }
    Rounded::new(points, speeds)
}

/// UR5e of the test vectors, without friction or rotors unless the description has them.
pub(crate) fn ur5e() -> Robot {
    from_urdf(
        include_str!("../../../tests/vectors/robots/ur5e/ur5e.urdf"),
        include_str!("../../../tests/vectors/robots/ur5e/oracle.json"),
    )
}

/// PUMA 560 of the test vectors.
pub(crate) fn puma560() -> Robot {
    from_urdf(
        include_str!("../../../tests/vectors/robots/puma560/puma560.urdf"),
        include_str!("../../../tests/vectors/robots/puma560/oracle.json"),
    )
}

fn from_urdf(text: &str, oracle: &str) -> Robot {
    let oracle: serde_json::Value = serde_json::from_str(oracle).unwrap();
    let link = |key: &str| oracle[key].as_str().map(str::to_owned);
    let description = Description {
        gravity: Some([0.0, 0.0, -9.81].into()),
        ..Description::new(Kinematics::Urdf {
            text: text.to_owned(),
            base_link: link("root_link"),
            tip_link: link("tip_link"),
        })
    };
    let resolved = description.resolve().unwrap();
    Robot::new(resolved.spec, resolved.warnings).unwrap()
}

/// ṡ² and s̈ at a place.
pub(super) fn square_at(law: &TimeLaw, s: f64) -> [f64; 2] {
    let at = law.at(law.time_at(s));
    [at.velocity * at.velocity, at.acceleration]
}
