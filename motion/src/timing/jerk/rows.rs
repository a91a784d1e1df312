//! What bounds (a, b, c) at every sample, each row divided by its limit:
//!
//! ```text
//! jerk          1/√a ∓ (q′·c + 3q″·b + q‴·a)/J        ≥ 0     the jerk limit, divided by ṡ
//! acceleration  1 ∓ (q′·b + q″·a)/A                   ≥ 0
//! torque        u± ∓ (m·b + k·a + f_v·√a)/T           ≥ 0     u± = 1 ∓ (g + Coulomb)/T, f_v = viscous·q′
//! speed         1 − a/a_max                           ≥ 0
//! tool          1 − |p′·b + p″·a|²/A_tool²            ≥ 0
//! ```
//!
//! Joints without a limit have no row. Samples lie in blocks of eight, row beside row: a sweep over them reads straight
//! through memory, eight samples at a time.

use crate::scalar::LANES_MAX;
use crate::tolerance::TORQUE_ROOM_MIN;

/// One number at each of eight samples.
pub(crate) type Block = [f64; LANES_MAX];

/// Rows of one kind with `C` coefficients, block by block.
#[derive(Debug, Clone)]
pub(crate) struct Group<const C: usize> {
    /// Rows (pairs ±, of joints) at a sample.
    pub(crate) count: usize,
    /// Entry `block * count + row`.
    pub(crate) rows: Vec<[Block; C]>,
}

/// Every row of a grid. What is not set is a row that never binds.
#[derive(Debug, Clone)]
pub(crate) struct Rows {
    pub(crate) blocks: usize,
    /// q′/J, 3q″/J, q‴/J.
    pub(crate) jerk: Group<3>,
    /// q′/A, q″/A.
    pub(crate) acceleration: Group<2>,
    /// m/T, k/T, f_v/T, u₊, u₋.
    pub(crate) torque: Group<5>,
    /// |p′|², p′·p″, |p″|², over A_tool²: one row or none.
    pub(crate) tool: Group<3>,
    /// 1/a_max.
    pub(crate) speed: Group<1>,
}

/// How many rows of each kind a sample has.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Counts {
    pub(crate) jerk: usize,
    pub(crate) acceleration: usize,
    pub(crate) torque: usize,
    pub(crate) tool: bool,
}

/// Parts of the limits that are left after tightening, at one sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Tightening {
    pub(crate) jerk: f64,
    /// Joint and tool acceleration.
    pub(crate) acceleration: f64,
    pub(crate) torque: f64,
    /// Of a_max.
    pub(crate) speed: f64,
}

impl Tightening {
    pub(crate) const NONE: Self = Self {
        jerk: 1.0,
        acceleration: 1.0,
        torque: 1.0,
        speed: 1.0,
    };
}

impl<const C: usize> Group<C> {
    fn new(count: usize, blocks: usize, fill: [f64; C]) -> Self {
        Self {
            count,
            rows: vec![fill.map(|value| [value; LANES_MAX]); count * blocks],
        }
    }

    pub(crate) fn set(&mut self, sample: usize, row: usize, values: [f64; C]) {
        let (block, lane) = (sample / LANES_MAX, sample % LANES_MAX);
        for (column, value) in self.rows[block * self.count + row].iter_mut().zip(values) {
            column[lane] = value;
        }
    }

    pub(crate) fn get(&self, sample: usize, row: usize) -> [f64; C] {
        let (block, lane) = (sample / LANES_MAX, sample % LANES_MAX);
        self.rows[block * self.count + row].map(|column| column[lane])
    }

    fn multiply(&mut self, sample: usize, factor: f64) {
        for row in 0..self.count {
            self.set(sample, row, self.get(sample, row).map(|value| value * factor));
        }
    }
}

impl Rows {
    pub(crate) fn new(blocks: usize, counts: Counts) -> Self {
        Self {
            blocks,
            jerk: Group::new(counts.jerk, blocks, [0.0; 3]),
            acceleration: Group::new(counts.acceleration, blocks, [0.0; 2]),
            torque: Group::new(counts.torque, blocks, [0.0, 0.0, 0.0, 1.0, 1.0]),
            tool: Group::new(usize::from(counts.tool), blocks, [0.0; 3]),
            speed: Group::new(1, blocks, [0.0]),
        }
    }

    /// How many joints have rows.
    pub(crate) fn joint_count(&self) -> usize {
        self.jerk.count.max(self.acceleration.count).max(self.torque.count)
    }

    /// Inequalities of one lane of every block together.
    pub(crate) fn row_count(&self) -> usize {
        2 * (self.jerk.rows.len() + self.acceleration.rows.len() + self.torque.rows.len())
            + self.tool.rows.len()
            + self.speed.rows.len()
    }

    /// Multiplies the limits at one sample. Torque keeps a part of what friction and gravity leave.
    pub(crate) fn tighten(&mut self, sample: usize, by: &Tightening) {
        self.jerk.multiply(sample, 1.0 / by.jerk);
        self.acceleration.multiply(sample, 1.0 / by.acceleration);
        self.tool.multiply(sample, 1.0 / (by.acceleration * by.acceleration));
        self.speed.multiply(sample, 1.0 / by.speed);
        let less = 1.0 - by.torque;
        for row in 0..self.torque.count {
            let [m, k, f, up, down] = self.torque.get(sample, row);
            let lower = |room: f64| (room - less).max(TORQUE_ROOM_MIN * room);
            self.torque.set(sample, row, [m, k, f, lower(up), lower(down)]);
        }
    }

    /// The largest λ up to `most` at which (λ²a, λ²b, λ²c) uses at most the part `target` of every limit at a sample:
    /// the same motion, run λ times as fast.
    pub(crate) fn uniform_speed(&self, sample: usize, [a, b, c]: [f64; 3], target: f64, most: f64) -> f64 {
        let root = a.sqrt();
        let mut cubed = 0.0_f64;
        for row in 0..self.jerk.count {
            let [q1, q2, q3] = self.jerk.get(sample, row);
            cubed = cubed.max((q1 * c + q2 * b + q3 * a).abs() * root);
        }
        let mut speed = most.min(libm::cbrt(target / cubed));
        let [a_max] = self.speed.get(sample, 0);
        let mut squared = a * a_max;
        for row in 0..self.acceleration.count {
            let [q1, q2] = self.acceleration.get(sample, row);
            squared = squared.max((q1 * b + q2 * a).abs());
        }
        if self.tool.count > 0 {
            let [bb, ab, aa] = self.tool.get(sample, 0);
            squared = squared.max((bb * b * b + 2.0 * ab * a * b + aa * a * a).sqrt());
        }
        speed = speed.min((target / squared).sqrt());
        for row in 0..self.torque.count {
            let [m, k, f, up, down] = self.torque.get(sample, row);
            let (inertial, viscous) = (m * b + k * a, f * root);
            speed = speed.min(torque_speed(inertial, viscous, up * target));
            speed = speed.min(torque_speed(-inertial, -viscous, down * target));
        }
        speed
    }
}

/// The smallest λ > 0 at which d·λ² + f·λ reaches the room; infinite where it never does.
pub(crate) fn torque_speed(d: f64, f: f64, room: f64) -> f64 {
    let discriminant = f * f + 4.0 * d * room;
    if discriminant < 0.0 {
        return f64::INFINITY;
    }
    let denominator = f + discriminant.sqrt();
    if denominator > 0.0 {
        2.0 * room / denominator
    } else {
        f64::INFINITY
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_arms::random;

    #[test]
    fn torque_speed_is_the_first_crossing() {
        let state = &mut 1;
        for _ in 0..200 {
            let [d, f, room] = [random(state), random(state), 0.5 + 0.4 * random(state)];
            let value = |l: f64| d * l * l + f * l;
            let speed = torque_speed(d, f, room);
            if speed.is_finite() {
                assert!((value(speed) - room).abs() < 1e-9 * (1.0 + speed * speed));
            }
            let end = speed.min(100.0);
            assert!((1..100).all(|k| value(end * f64::from(k) / 100.0) < room));
        }
    }

    /// At the speed that is found one row is exactly at the target, and none above it.
    #[test]
    fn uniform_speed_reaches_one_limit() {
        let state = &mut 2;
        let counts = Counts {
            jerk: 3,
            acceleration: 3,
            torque: 3,
            tool: true,
        };
        for _ in 0..100 {
            let mut rows = Rows::new(1, counts);
            for row in 0..3 {
                rows.jerk.set(2, row, [(); 3].map(|()| random(state)));
                rows.acceleration.set(2, row, [(); 2].map(|()| random(state)));
                let room = 0.7 * random(state);
                rows.torque.set(
                    2,
                    row,
                    [random(state), random(state), random(state), 1.0 - room, 1.0 + room],
                );
            }
            rows.tool.set(2, 0, [1.0, 0.3 * random(state), 0.5]);
            rows.speed.set(2, 0, [0.5 + 0.4 * random(state)]);
            let abc = [1.0 + 0.5 * random(state), random(state), random(state)];
            let speed = rows.uniform_speed(2, abc, 0.6, 1e9);
            let again = rows.uniform_speed(2, abc.map(|value| value * speed * speed), 0.6, 1e9);
            assert!((again - 1.0).abs() < 1e-9, "{again}");
        }
    }
}
