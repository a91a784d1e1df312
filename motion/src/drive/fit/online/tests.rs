//! Online intervals of residuals whose truth is known.

use std::f64::consts::PI;

use super::*;
use crate::drive::fit::filter::LowPass;
use crate::test_arms::random;

const BAND: f64 = 5.0;
const PERIOD: f64 = 0.01;
const CONFIDENCE: f64 = 0.95;
const STATED: f64 = 1.96;
const MOVING: Stated = Stated {
    half_width: STATED,
    allowance: 0.0,
    speed: 1.0,
};
const RESTING: Stated = Stated {
    half_width: STATED,
    allowance: 5.0,
    speed: 0.0,
};

/// What can be wrong with a residual.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Normal,
    /// Its size wanders by a factor of two.
    Heavy,
    /// Larger at speed.
    Speed,
    /// Two sines: lighter tails than any Student's.
    Sines,
    /// A wrong body: seconds on one side.
    Body,
    /// Four times as large after a start, and for the half second after it.
    Start,
}

const KINDS: [Kind; 6] = [
    Kind::Normal,
    Kind::Heavy,
    Kind::Speed,
    Kind::Sines,
    Kind::Body,
    Kind::Start,
];

fn normal(state: &mut u64) -> f64 {
    // the sum of six uniform numbers of variance 1/3 is nearly normal
    (0..6).map(|_| random(state)).sum::<f64>() / 2.0_f64.sqrt()
}

/// Noise of deviation 1 that stays alike for a time, s.
fn alike(count: usize, time: f64, state: &mut u64) -> Vec<f64> {
    let keep = libm::exp(-2.0 * PERIOD / time);
    let mut x = normal(state);
    let step = |_| {
        x = keep * x + (1.0 - keep * keep).sqrt() * normal(state);
        x
    };
    (0..count).map(step).collect()
}

/// A residual within the band, its deviation 1 in the mean.
fn residual(kind: Kind, count: usize, state: &mut u64) -> Vec<f64> {
    let mut series = alike(count, 0.4, state);
    let slow = alike(count, 3.0, state);
    let phase = 3.0 * random(state);
    for (k, x) in series.iter_mut().enumerate() {
        let t = PERIOD * k as f64;
        *x = match kind {
            Kind::Normal => *x,
            Kind::Heavy => *x * libm::exp(0.7 * slow[k]),
            Kind::Speed => *x * (0.3 + libm::sin(2.0 * t + phase).abs()),
            Kind::Sines => libm::sin(5.0 * t + phase) + libm::sin(8.3 * t),
            Kind::Body => 0.6 * *x + slow[k],
            Kind::Start => *x * (1.0 + 3.0 * libm::exp(-t / 0.3)),
        };
    }
    LowPass::new(BAND, PERIOD).apply(&mut series);
    let square = series.iter().map(|x| x * x).sum::<f64>() / count as f64;
    series.iter().map(|x| x / square.sqrt()).collect()
}

fn interval() -> OnlineInterval {
    let stated = Residual {
        deviation: 1.0,
        correlation_time: 0.4,
        degrees_of_freedom: f64::INFINITY,
    };
    OnlineInterval::new(&stated, CONFIDENCE, BAND, PERIOD)
}

/// Part of the samples within, and the mean half width.
fn run(errors: &[f64]) -> (f64, f64) {
    let mut online = interval();
    let (mut within, mut widths) = (0.0, 0.0);
    for error in errors {
        let foretold = online.next(MOVING, *error);
        within += f64::from(u8::from(foretold.holds(*error)));
        widths += foretold.half_width;
    }
    (within / errors.len() as f64, widths / errors.len() as f64)
}

/// Narrowest constant half width that holds 95 %.
fn narrowest(errors: &[f64]) -> f64 {
    let mut sorted: Vec<f64> = errors.iter().map(|e| e.abs()).collect();
    sorted.sort_by(f64::total_cmp);
    sorted[(CONFIDENCE * errors.len() as f64).ceil() as usize - 1]
}

/// Half a minute, 12 seeds of each kind, the residual from half to twice as large as the model says: 93 to 98 % are within, at no more than 1.6
/// times the narrowest constant width; 1.75 times where the size wanders, since that it has grown is believed sooner than that it has shrunk.
#[test]
fn every_run_is_covered_as_stated_whatever_the_residual_is_like() {
    for kind in KINDS {
        for seed in 0..12 {
            let scale = [0.5, 0.8, 1.0, 2.0][seed as usize % 4];
            let errors: Vec<f64> = residual(kind, 3000, &mut (40 + seed))
                .iter()
                .map(|e| scale * e)
                .collect();
            let (within, half_width) = run(&errors);
            assert!((0.93..=0.98).contains(&within), "{kind:?} {seed}: {within}");
            let over = half_width / narrowest(&errors);
            let most = if kind == Kind::Heavy { 1.75 } else { 1.6 };
            assert!(over < most, "{kind:?} {seed}: {over}");
        }
    }
}

/// Five seconds hold some twelve independent errors: of constant intervals that are right in the mean, fewer runs are covered between 92 and
/// 98.5 % than of the online ones. Of sines, which repeat, all are.
#[test]
fn short_runs_are_covered_no_less_evenly_than_by_a_constant_interval() {
    for kind in KINDS {
        let (mut even, mut constant, runs) = (0, 0, 40);
        for seed in 0..runs {
            let errors = residual(kind, 4000, &mut (700 + seed));
            let stated = narrowest(&errors);
            let short = &errors[if kind == Kind::Start { 0..500 } else { 3000..3500 }];
            let part = short.iter().filter(|e| e.abs() <= stated).count() as f64 / 500.0;
            let is_even = |part: f64| u32::from((0.92..=0.985).contains(&part));
            even += is_even(run(short).0);
            constant += is_even(part);
        }
        assert!(
            even >= 28 && even >= constant,
            "{kind:?}: {even} and {constant} of {runs}"
        );
    }
}

/// A Coulomb torque that is wrong by twice the noise's deviation, on a joint that turns back every second: 93 to 98 % are within all along, and no fewer than
/// 90 % of the samples within the horizon of a turn.
#[test]
fn what_friction_errs_by_is_foretold_across_reversals() {
    for seed in 0..12 {
        let count = 6000;
        let speed = |k: usize| libm::sin(PI * PERIOD * k as f64);
        let mut errors: Vec<f64> = (0..count).map(|k| 2.0 * speed(k).signum()).collect();
        LowPass::new(BAND, PERIOD).apply(&mut errors);
        let noise = residual(Kind::Normal, count, &mut (900 + seed));
        errors.iter_mut().zip(&noise).for_each(|(e, x)| *e += x);
        let mut online = interval();
        let (mut within, mut turned) = (0, Vec::new());
        for (k, error) in errors.iter().enumerate() {
            let stated = Stated {
                speed: speed(k),
                ..MOVING
            };
            let holds = online.next(stated, *error).holds(*error);
            within += usize::from(holds);
            if online.since_turn < online.horizon && k > count / 10 {
                turned.push(f64::from(u8::from(holds)));
            }
        }
        let within = within as f64 / count as f64;
        assert!((0.93..=0.98).contains(&within), "{seed}: {within}");
        let turned = turned.iter().sum::<f64>() / turned.len() as f64;
        assert!(turned > 0.9, "{seed}: {turned}");
    }
}

/// A joint that trembles below the speed of rest does not turn back; one that goes on the same way after a rest does not either.
#[test]
fn a_joint_turns_back_only_where_it_moves() {
    let mut online = interval();
    let mut turned = |speed: f64| online.turned(speed);
    assert!(turned(1.0));
    for _ in 0..100 {
        turned(1.0);
    }
    for k in 0..100 {
        let trembling = if k % 2 == 0 { 0.01 } else { -0.01 };
        assert!(!turned(trembling));
    }
    assert!(!turned(0.5));
    assert!(turned(-0.5));
}

/// The bound of adaptive conformal inference holds for residuals made to break it: it jumps by a factor of ten every second.
#[test]
fn a_residual_that_jumps_is_covered_within_the_bound() {
    let state = &mut 9;
    let errors: Vec<f64> = (0..6000)
        .map(|k| random(state) * if k / 100 % 2 == 0 { 0.3 } else { 3.0 })
        .collect();
    let mut online = interval();
    let (mut outside, gain) = (0.0, online.gain);
    let mut thetas = vec![online.theta];
    for error in &errors {
        outside += f64::from(u8::from(!online.next(MOVING, *error).holds(*error)));
        thetas.push(online.theta);
    }
    let way = thetas[errors.len()] - thetas[0];
    let count = errors.len() as f64;
    let bound = way.abs() / (gain * count) + online.horizon as f64 / count;
    let off = outside / count - (1.0 - CONFIDENCE);
    assert!(off.abs() <= bound && bound < 0.02, "{off} of {bound}");
}

/// An error changes nothing that is foretold before the horizon, and something after it.
#[test]
fn nothing_younger_than_the_horizon_is_known() {
    let errors = residual(Kind::Normal, 400, &mut 3);
    let widths = |errors: &[f64]| -> Vec<(f64, f64)> {
        let mut online = interval();
        let foretold = errors.iter().map(|error| online.next(MOVING, *error));
        foretold
            .map(|foretold| (foretold.centre, foretold.half_width))
            .collect()
    };
    let plain = widths(&errors);
    let mut struck = errors;
    struck[200] += 50.0;
    let struck = widths(&struck);
    let after = 200 + horizon_samples(BAND, PERIOD);
    assert_eq!(after, 220);
    assert_eq!(plain[..after], struck[..after]);
    assert!(struck[after].0 > plain[after].0 && struck[after].1 > plain[after].1);
}

#[test]
fn at_rest_the_allowance_is_added_and_nothing_is_learnt() {
    let errors = residual(Kind::Normal, 300, &mut 4);
    let mut online = interval();
    for error in &errors {
        online.next(MOVING, *error);
    }
    // what the last samples of motion say comes in a horizon later
    for _ in 0..online.horizon {
        online.next(RESTING, 4.0);
    }
    let before = online.clone();
    for _ in 0..1000 {
        let foretold = online.next(RESTING, 4.0);
        assert!(foretold.half_width > 5.0 && foretold.centre == 0.0);
    }
    assert_eq!(
        (
            before.memories.map(|memory| (memory.spread(), memory.share())),
            before.theta
        ),
        (
            online.memories.map(|memory| (memory.spread(), memory.share())),
            online.theta
        )
    );
}

/// Whatever is fed, every interval is finite and the state as long as at the start.
#[test]
fn nothing_that_is_fed_breaks_it() {
    let stated = [0.0, 1.0e-300, 1.0e-3, 1.0, 1.0e9];
    let errors = [0.0, -1.0e9, 1.0e9, 1.0e-300, 1.0];
    let state = &mut 11;
    let mut online = interval();
    for _ in 0..20_000 {
        let of = |values: [f64; 5], state: &mut u64| values[((2.5 * (random(state) + 1.0)) as usize).min(4)];
        let foretold = online.next(
            Stated {
                half_width: of(stated, state),
                speed: of(errors, state),
                ..MOVING
            },
            of(errors, state),
        );
        assert!(foretold.centre.is_finite() && foretold.half_width.is_finite());
        assert!(online.seen.len() <= 2 * online.horizon);
    }
    let mut still = interval();
    for _ in 0..100_000 {
        still.next(MOVING, 0.0);
    }
    assert!(still.next(MOVING, 1.0).half_width.is_finite());
}
