//! The limits at samples as pairs of rows that are linear in a = ṡ² and b = s̈.
//!
//! ```text
//! a₊·a + b·β ≤ c₊        a₋·a − b·β ≤ c₋
//! ```
//!
//! Two things are not linear and are replaced by something stricter. Viscous torque goes with √a, which is concave: where
//! it costs torque its tangent √a ≤ √a₀/2 + a/(2·√a₀) stands for it, where it helps the chord √a ≥ a/√a_max. And the tool's
//! acceleration, at most A in every direction, stays within a regular polygon inscribed in that circle.

use super::coefficients::Coefficients;
use super::grid::Grid;
use super::limits::Limits;
use crate::tolerance::{TIMING_RESERVE, TOOL_FACETS};

/// The samples that have rows: those of a grid at both ends of its intervals and some in between.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RowPlaces {
    /// Which samples of the grid.
    pub(crate) samples: Vec<usize>,
    /// Rows of interval i are at `samples[first[i]]` to `samples[first[i] + parts]`, both included.
    pub(crate) first: Vec<usize>,
    /// Into how many parts they divide an interval.
    pub(crate) parts: usize,
}

impl RowPlaces {
    /// Rows that divide each interval of a grid into `parts`, which divides the grid's own.
    pub(crate) fn new(grid: &Grid, parts: usize) -> Self {
        let every = grid.parts / parts;
        let mut places = Self {
            samples: Vec::with_capacity(grid.interval_count() * (parts + 1)),
            first: Vec::with_capacity(grid.interval_count()),
            parts,
        };
        for first in &grid.first {
            if places.samples.last() != Some(first) {
                places.samples.push(*first);
            }
            places.first.push(places.samples.len() - 1);
            places.samples.extend((1..=parts).map(|part| first + part * every));
        }
        places
    }
}

/// Two rows with opposite β.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pair {
    /// Coefficient of b.
    pub(crate) b: f64,
    /// Coefficients of a: of the upper row, and of the lower one.
    pub(crate) a: [f64; 2],
    /// Right sides, positive.
    pub(crate) c: [f64; 2],
}

/// Which part of its room each limit may use at each sample: 1 at first, less where a timing turned out to break the limit
/// between samples.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Rooms {
    /// Of what gravity and Coulomb friction leave of the torque: entry `joint * stride + sample`.
    pub(crate) torque: Vec<f64>,
    /// Of the acceleration: entry `joint * stride + sample`.
    pub(crate) acceleration: Vec<f64>,
    /// Of the largest ṡ²: one a sample.
    pub(crate) speed: Vec<f64>,
    /// Of the tool's acceleration: one a sample.
    pub(crate) tool_acceleration: Vec<f64>,
    /// Part of every limit that is left unused from the beginning.
    pub(crate) reserve: f64,
}

impl Rooms {
    /// All of it, but for a reserve.
    pub(crate) fn full(coefficients: &Coefficients) -> Self {
        let entries = coefficients.joint_count * coefficients.stride;
        Self {
            torque: vec![1.0; entries],
            acceleration: vec![1.0; entries],
            speed: vec![1.0; coefficients.places.len()],
            tool_acceleration: vec![1.0; coefficients.places.len()],
            reserve: TIMING_RESERVE,
        }
    }
}

/// The rows at their places, but those of the speed.
#[derive(Debug)]
pub(crate) struct Rows<'a> {
    pub(crate) places: &'a RowPlaces,
    per_sample: usize,
    pairs: Vec<Pair>,
    /// Largest ṡ², one a place.
    pub(crate) speed_bound: Vec<f64>,
    /// Whether viscous torque is in a row, so that the rows depend on where its tangents are.
    pub(crate) viscous: bool,
}

/// What bounds nothing.
const NOTHING: Pair = Pair {
    b: 0.0,
    a: [0.0; 2],
    c: [f64::INFINITY; 2],
};

impl<'a> Rows<'a> {
    /// The rows, with the tangents of viscous torque at `reference`, an a for each place; without one, where speed alone
    /// would bound it.
    pub(crate) fn new(
        coefficients: &Coefficients,
        limits: &Limits,
        rooms: &Rooms,
        places: &'a RowPlaces,
        reference: Option<&[f64]>,
    ) -> Self {
        let any = |bounds: &dyn Fn(usize, usize) -> bool| -> Vec<usize> {
            let stretches = 0..limits.stretches.len();
            let bounded = |joint: &usize| stretches.clone().any(|stretch| bounds(stretch, *joint));
            (0..coefficients.joint_count).filter(bounded).collect()
        };
        let torque = any(&|stretch, joint| limits.stretches[stretch].joints[joint].torque.is_some());
        let acceleration = any(&|stretch, joint| limits.stretches[stretch].joints[joint].acceleration.is_some());
        let facets = if limits
            .stretches
            .iter()
            .any(|stretch| stretch.tool_acceleration.is_some())
        {
            TOOL_FACETS / 4
        } else {
            0
        };
        let per_sample = torque.len() + acceleration.len() + facets;
        let count = places.samples.len();
        let speed = (1.0 - rooms.reserve) * (1.0 - rooms.reserve);
        let bound = |sample: &usize| coefficients.speed_bound[*sample] * rooms.speed[*sample] * speed;
        let speed_bound: Vec<f64> = places.samples.iter().map(bound).collect();
        let mut rows = Self {
            places,
            per_sample,
            pairs: vec![NOTHING; per_sample * count],
            speed_bound,
            viscous: false,
        };
        for (row, joint) in torque.iter().enumerate() {
            rows.add_torque(coefficients, limits, rooms, reference, *joint, row);
        }
        for (row, joint) in acceleration.iter().enumerate() {
            rows.add_acceleration(coefficients, limits, rooms, *joint, torque.len() + row);
        }
        if facets > 0 {
            rows.add_facets(coefficients, limits, rooms, per_sample - facets);
        }
        rows
    }

    /// The pairs of a place.
    pub(crate) fn at(&self, place: usize) -> &[Pair] {
        &self.pairs[place * self.per_sample..(place + 1) * self.per_sample]
    }

    /// The most lines that bound b from one side on an interval: two of each pair, one of the speed at each place, one of what
    /// follows.
    pub(crate) fn lines_of_interval(&self) -> usize {
        (self.places.parts + 1) * (2 * self.per_sample + 1) + 1
    }

    fn add_torque(
        &mut self,
        coefficients: &Coefficients,
        limits: &Limits,
        rooms: &Rooms,
        reference: Option<&[f64]>,
        joint: usize,
        row: usize,
    ) {
        let terms = &coefficients.terms;
        for (place, sample) in self.places.samples.iter().copied().enumerate() {
            let Some(limit) = limits.stretches[coefficients.stretch[sample]].joints[joint].torque else {
                continue;
            };
            let entry = joint * coefficients.stride + sample;
            let limit = limit * (1.0 - rooms.reserve);
            let (gravity, room) = (terms.gravity[entry], rooms.torque[entry]);
            let high = room * (limit - gravity - coefficients.coulomb_high[entry]);
            let low = room * (limit + gravity + coefficients.coulomb_low[entry]);
            let (mass, velocity, viscous) = (terms.mass[entry], terms.velocity[entry], coefficients.viscous[entry]);
            let mut pair = Pair {
                b: mass,
                a: [velocity, -velocity],
                c: [high, low],
            };
            if viscous != 0.0 {
                self.viscous = true;
                let (costly, helpful) = if viscous > 0.0 { (0, 1) } else { (1, 0) };
                let c = viscous.abs();
                // a tangent that takes half of the room at a = 0 leaves standing still feasible
                let tangent = reference.map_or(self.speed_bound[place], |reference| reference[place]);
                let root = tangent.sqrt().min(pair.c[costly] / c);
                pair.a[costly] += c / (2.0 * root);
                pair.c[costly] -= 0.5 * c * root;
                pair.a[helpful] -= c / self.speed_bound[place].sqrt();
            }
            self.pairs[place * self.per_sample + row] = pair;
        }
    }

    fn add_acceleration(
        &mut self,
        coefficients: &Coefficients,
        limits: &Limits,
        rooms: &Rooms,
        joint: usize,
        row: usize,
    ) {
        for (place, sample) in self.places.samples.iter().copied().enumerate() {
            let Some(limit) = limits.stretches[coefficients.stretch[sample]].joints[joint].acceleration else {
                continue;
            };
            let entry = joint * coefficients.stride + sample;
            let second = coefficients.terms.second[entry];
            self.pairs[place * self.per_sample + row] = Pair {
                b: coefficients.terms.first[entry],
                a: [second, -second],
                c: [limit * (1.0 - rooms.reserve) * rooms.acceleration[entry]; 2],
            };
        }
    }

    /// In the plane of p′ and p″, with x along p′, the acceleration is (|p′|·b + p″ₓ·a, p″_y·a) with p″_y ≥ 0; so only facets
    /// with normals in the upper half plane bound it, and they come in pairs at angles φ and π − φ.
    fn add_facets(&mut self, coefficients: &Coefficients, limits: &Limits, rooms: &Rooms, row: usize) {
        let step = 2.0 * std::f64::consts::PI / TOOL_FACETS as f64;
        let inscribed = libm::cos(0.5 * step);
        let normals: Vec<(f64, f64)> = (0..TOOL_FACETS / 4)
            .map(|facet| libm::sincos((facet as f64 + 0.5) * step))
            .collect();
        for (place, sample) in self.places.samples.iter().copied().enumerate() {
            let Some(limit) = limits.stretches[coefficients.stretch[sample]].tool_acceleration else {
                continue;
            };
            let [length, along, across] = plane(coefficients.tool_first(sample), coefficients.tool_second(sample));
            let c = limit * (1.0 - rooms.reserve) * rooms.tool_acceleration[sample] * inscribed;
            for (facet, (sin, cos)) in normals.iter().enumerate() {
                self.pairs[place * self.per_sample + row + facet] = Pair {
                    b: cos * length,
                    a: [cos * along + sin * across, sin * across - cos * along],
                    c: [c; 2],
                };
            }
        }
    }
}

/// |p′|, and the parts of p″ along p′ and across.
fn plane(first: [f64; 3], second: [f64; 3]) -> [f64; 3] {
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let length = dot(first, first).sqrt();
    if length <= 0.0 {
        return [0.0, 0.0, dot(second, second).sqrt()];
    }
    let along = dot(first, second) / length;
    let across = std::array::from_fn(|k| second[k] - along * (first[k] / length));
    [length, along, dot(across, across).sqrt()]
}

#[cfg(test)]
mod tests;
