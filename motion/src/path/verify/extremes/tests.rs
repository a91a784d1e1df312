//! The search against maxima known in closed form.

use super::*;

const NONE: [f64; 2] = [0.0; 2];

/// Every span between evenly spaced samples of `node`, bends as the verifier forms them.
fn spans(nodes: &[Node]) -> Vec<Span> {
    let last = nodes.len() - 1;
    let second = |middle: usize| {
        let middle = middle.clamp(1, last - 1);
        let bend = |way: usize| {
            let [before, here, after] = [middle - 1, middle, middle + 1].map(|at| nodes[at].parts[way]);
            (before - 2.0 * here + after).abs()
        };
        bend(0).max(bend(1)).max(bend(2))
    };
    let span = |at: usize| Span {
        ends: [nodes[at], nodes[at + 1]],
        bend: (at.saturating_sub(1)..(at + 3).min(last + 1))
            .map(second)
            .fold(0.0, f64::max),
        limit: 1.0,
    };
    (0..last).map(span).collect()
}

/// The largest value found from samples at eleven moments in [0, 1], and how many more were taken.
fn found(node: impl Fn(f64) -> Node) -> (f64, usize) {
    let samples: Vec<Node> = (0..=10).map(|at| node(f64::from(at) / 10.0)).collect();
    let mut known = samples
        .iter()
        .map(|node| node.parts[node.way].abs())
        .fold(0.0, f64::max);
    let mut count = 0;
    let evaluate = |_: &Span, time: f64| {
        let node = node(time);
        count += 1;
        known = known.max(node.parts[node.way].abs());
        node
    };
    let start = samples
        .iter()
        .map(|node| node.parts[node.way].abs())
        .fold(0.0, f64::max);
    search(spans(&samples), start, f64::abs, evaluate, &Budget::unlimited()).unwrap();
    (known, count)
}

fn smooth(value: impl Fn(f64) -> f64) -> impl Fn(f64) -> Node {
    move |time| Node {
        time,
        parts: [value(time); 3],
        way: 1,
        rates: NONE,
    }
}

/// A torque with friction of 0.3 against a velocity and its derivative.
fn rubbed(torque: impl Fn(f64) -> f64, velocity: impl Fn(f64) -> [f64; 2]) -> impl Fn(f64) -> Node {
    move |time| Node {
        time,
        parts: [-0.3, 0.0, 0.3].map(|friction| torque(time) + friction),
        way: way(velocity(time)[0]),
        rates: velocity(time),
    }
}

#[track_caller]
fn check((value, count): (f64, usize), expected: f64, most: usize) {
    assert!(
        value <= expected + 1e-14 && value >= expected - EXTREME_GAIN,
        "{value} {expected}"
    );
    assert!(count <= most, "{count}");
}

#[test]
fn smooth_maxima_are_found_wherever_they_are() {
    for shift in 0..50 {
        let top = f64::from(shift) / 49.0;
        // of either sign, and more than one of a height
        check(found(smooth(|t| 0.9 - (t - top) * (t - top))), 0.9, 60);
        check(found(smooth(|t| (3.0 * (t - top)).powi(2) - 0.2 - 9.0)), 9.2, 60);
        let wave = std::f64::consts::TAU;
        check(found(smooth(|t| 0.8 * (2.0 * wave * (t - top)).cos())), 0.8, 400);
    }
}

#[test]
fn a_lower_sample_beside_a_higher_maximum_is_not_passed_by() {
    // samples see 0.98 at t = 0.1 and 0.97 at most around t = 0.75, where the maximum is 1
    let hump = |t: f64, at: f64, width: f64| (-((t - at) / width).powi(2)).exp();
    let value = |t: f64| 0.98 * hump(t, 0.1, 0.15) + hump(t, 0.75, 0.25);
    let dense = (0..=1_000_000)
        .map(|at| value(f64::from(at) * 1e-6))
        .fold(0.0, f64::max);
    let (value, count) = found(smooth(value));
    assert!(
        (value - dense).abs() < EXTREME_GAIN && count < 100,
        "{value} {dense} {count}"
    );
}

#[test]
fn nothing_is_computed_where_nothing_can_be_larger() {
    assert_eq!(found(smooth(|t| 0.5 + 0.3 * t)), (0.8, 0));
    assert_eq!(found(smooth(|_| f64::NAN)), (0.0, 0));
}

#[test]
fn friction_is_taken_on_both_sides_of_a_reversal() {
    for shift in 1..40 {
        let turn = f64::from(shift) / 40.0 + 1e-4;
        // backwards, then forwards from there; without friction the torque falls: the largest is just after
        let found = found(rubbed(|t| 0.6 - 0.5 * t, |t| [t - turn, 1.0]));
        check(found, 0.6 - 0.5 * turn + 0.3, 120);
    }
}

#[test]
fn a_joint_that_turns_twice_between_samples_is_seen() {
    // a moment's motion backwards takes 0.9, all the rest 0.3
    let twice = found(rubbed(|_| -0.6, |t| [(t - 0.55).powi(2) - 4e-4, 2.0 * (t - 0.55)]));
    check(twice, 0.9, 60);
    let never = found(rubbed(|_| -0.6, |t| [(t - 0.56).powi(2) + 1e-6, 2.0 * (t - 0.56)]));
    check(never, 0.3, 60);
}

#[test]
fn a_search_ends_where_nobody_waits() {
    let stop = || true;
    let budget = Budget::until(&stop);
    let samples: Vec<Node> = (0..=10).map(|at| smooth(f64::cos)(f64::from(at))).collect();
    let node = |_: &Span, time| smooth(f64::cos)(time);
    assert!(search(spans(&samples), 0.0, f64::abs, node, &budget).is_err());
}
