//! What a set-point at constant tool speed takes, ns: median and fastest of many batches, one line each.
//!
//! ```text
//! cargo bench --package takt-motion --bench generator
//! ```
//!
//! On an arc: by the constant rotation, against computing sine and cosine of the angle in every cycle, and against
//! computing the rotation matrix from them in every cycle, which JPH0743606B2 sets out from; and in a transition. As in
//! `kernels.rs` a batch is short, and ratios are what to read.

#![allow(clippy::print_stdout, reason = "a program that prints a table")]

use std::hint::black_box;
use std::time::Instant;

use takt_motion::nalgebra::{Matrix3, Vector3};
use takt_motion::process::generator::{CircleGenerator, TransitionGenerator};

/// Set-points of one batch.
const POINTS: u32 = 1000;

const BATCHES: usize = 2000;

const RADIUS: f64 = 0.1;

/// 0.25 m/s, every ms.
const STEP: f64 = 0.25e-3;

fn main() {
    let center = Vector3::new(0.4, -0.2, 0.3);
    let normal = Vector3::new(0.6, 0.0, 0.8);
    let out = Vector3::new(0.0, RADIUS, 0.0);
    let start = center + out;
    let generator = CircleGenerator::new(center, normal, start, STEP).expect("the circle is sound");
    measure("arc/constant_rotation", || {
        let mut generator = black_box(generator.clone());
        for _ in 0..POINTS {
            black_box(generator.next());
        }
    });
    let along = normal.cross(&out);
    measure("arc/sine_and_cosine", || {
        let rate = black_box(STEP / RADIUS);
        for index in 0..POINTS {
            let angle = rate * f64::from(index + 1);
            black_box(center + out * libm::cos(angle) + along * libm::sin(angle));
        }
    });
    measure("arc/sine_and_cosine_one_by_one", || {
        let rate = black_box(STEP / RADIUS);
        let (mut angle, mut point) = (0.0, start);
        for _ in 0..POINTS {
            // 0·x: this set-point waits for the one before it, as a servo's does, and as the rotation's must
            angle += rate + 0.0 * point.x;
            point = center + out * libm::cos(angle) + along * libm::sin(angle);
            black_box(point);
        }
    });
    measure("arc/sine_and_cosine_of_the_system", || {
        let rate = black_box(STEP / RADIUS);
        for index in 0..POINTS {
            let (sin, cos) = (rate * f64::from(index + 1)).sin_cos();
            black_box(center + out * cos + along * sin);
        }
    });
    let cross = normal.cross_matrix();
    let square = cross * cross;
    measure("arc/rotation_matrix", || {
        let rate = black_box(STEP / RADIUS);
        for index in 0..POINTS {
            let angle = rate * f64::from(index + 1);
            let turn = Matrix3::identity() + cross * libm::sin(angle) + square * (1.0 - libm::cos(angle));
            black_box(center + turn * out);
        }
    });

    let (before, after) = (start - Vector3::x() * 0.01, start + Vector3::y() * 0.01);
    let generator = TransitionGenerator::source(&before, &start, &after, POINTS);
    measure("transition/polynomial", || {
        let mut generator = black_box(generator.clone());
        for _ in 0..POINTS {
            black_box(generator.next());
        }
    });
}

fn measure(name: &str, mut batch: impl FnMut()) {
    let mut times: Vec<f64> = (0..BATCHES)
        .map(|_| {
            let began = Instant::now();
            batch();
            began.elapsed().as_nanos() as f64 / f64::from(POINTS)
        })
        .collect();
    times.sort_by(f64::total_cmp);
    println!("{name} {:.2} {:.2}", times[BATCHES / 2], times[0]);
}
