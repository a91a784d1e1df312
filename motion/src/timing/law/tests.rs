use super::*;
use crate::timing::test_curves::square_at;

fn close(got: f64, expected: f64, tolerance: f64) {
    assert!(
        (got - expected).abs() <= tolerance * (1.0 + expected.abs()),
        "{got} {expected}"
    );
}

/// From rest at constant jerk, a cubic, a linear piece, and to rest: continuous in a where they meet.
fn law() -> TimeLaw {
    let cubic = [0.8, 1.5, -0.7, 0.1];
    let at = |x: f64| cubic[0] + x * (cubic[1] + x * (cubic[2] + x * cubic[3]));
    TimeLaw::new(vec![
        Piece {
            begin: 0.0,
            end: 0.3,
            form: Form::FromRest { end: 0.8 },
        },
        Piece {
            begin: 0.3,
            end: 1.3,
            form: Form::Polynomial(cubic),
        },
        Piece::linear(1.3, 2.0, [at(1.0), 1.1]),
        Piece {
            begin: 2.0,
            end: 2.5,
            form: Form::ToRest { begin: 1.1 },
        },
    ])
    .unwrap()
}

#[test]
fn velocity_acceleration_and_jerk_are_the_derivatives_of_the_position() {
    let law = law();
    let step = 1e-5;
    for k in 1..400 {
        let t = law.duration() * f64::from(k) / 400.0;
        if law.times().iter().any(|border| (border - t).abs() < 2.0 * step) {
            continue;
        }
        let (before, here, after) = (law.at(t - step), law.at(t), law.at(t + step));
        let rate = |of: fn(&PathState) -> f64| (of(&after) - of(&before)) / (2.0 * step);
        close(rate(|at| at.position), here.velocity, 1e-7);
        close(rate(|at| at.velocity), here.acceleration, 1e-7);
        close(rate(|at| at.acceleration), here.jerk, 1e-6);
        // near rest s̈ goes with the third root of the distance
        if here.velocity < 0.1 {
            continue;
        }
        let [a, b] = square_at(&law, here.position);
        close(a.sqrt(), here.velocity, 1e-12);
        close(b, here.acceleration, 1e-12);
    }
}

#[test]
fn times_and_places_are_inverse_to_each_other() {
    let law = law();
    for k in 0..=300 {
        let t = law.duration() * f64::from(k) / 300.0;
        // at rest the time goes with the third root of the distance
        close(law.time_at(law.at(t).position), t, 1e-6);
        let s = 2.5 * f64::from(k) / 300.0;
        close(law.at(law.time_at(s)).position, s, 1e-12);
    }
    assert_eq!(law.at(law.duration()).position, 2.5);
    assert_eq!(law.at(-1.0), law.at(0.0));
    assert_eq!(law.at(9.0 * law.duration()).velocity, 0.0);
}

/// ∫ dx/√(1 + x)² = ln(1 + x) and ∫ dx/√(1 + x) = 2·(√(1 + x) − 1).
#[test]
fn durations_are_those_of_closed_forms() {
    let polynomial = |c| Piece {
        begin: 0.0,
        end: 5.0,
        form: Form::Polynomial(c),
    };
    close(polynomial([1.0, 2.0, 1.0, 0.0]).time_to(5.0), 6f64.ln(), 1e-11);
    close(polynomial([1.0, 2.0, 1.0, 0.0]).time_to(0.7), 1.7f64.ln(), 1e-13);
    close(
        polynomial([1.0, 1.0, 0.0, 0.0]).time_to(50.0),
        2.0 * (51f64.sqrt() - 1.0),
        1e-14,
    );
    let rest = Piece {
        begin: 0.0,
        end: 0.5,
        form: Form::FromRest { end: 2.0 },
    };
    close(rest.time_to(0.5), 3.0 * 0.5 / 2f64.sqrt(), 1e-14);
}

/// ∫ dx/√(m + (x − p)²) = asinh((x − p)/√m): a speed that is as high at both ends of a piece as it is low in the middle.
#[test]
fn a_dip_of_the_speed_within_a_piece_takes_its_time() {
    for dip in [1.0, 0.1, 1e-2, 1e-4, 1e-6] {
        for place in [-0.2, 0.0, 0.3, 0.5, 0.9] {
            let square = dip * dip;
            let piece = Piece {
                begin: 0.0,
                end: 1.0,
                form: Form::Polynomial([square + place * place, -2.0 * place, 1.0, 0.0]),
            };
            let time = |x: f64| ((x - place) / dip).asinh() + (place / dip).asinh();
            for x in [1e-3, 0.1, 0.299, 0.3, 0.5, 0.77, 1.0] {
                // near the dip a itself is a difference of larger numbers
                close(piece.time_to(x), time(x), 1e-11f64.max(1e-16 / square));
            }
            // times grow with places, over the borders of panels too
            let times: Vec<f64> = (0..=4096).map(|at| piece.time_to(f64::from(at) / 4096.0)).collect();
            assert!(times.is_sorted_by(|a, b| a < b));
        }
    }
}

/// The velocity that is told is the one at which places pass, also where a(s) dips within a piece.
#[test]
fn places_pass_at_the_velocity_that_is_told() {
    let dip = Form::Polynomial([0.26, -1.0, 1.0, 0.0]);
    let law = TimeLaw::new(vec![Piece {
        begin: 0.0,
        end: 1.0,
        form: dip,
    }]);
    let law = law.unwrap();
    let step = law.duration() / 1000.0;
    for k in 1..1000 {
        let [before, after] = [-0.5, 0.5].map(|side| law.at(step * (f64::from(k) + side)));
        let mean = (after.position - before.position) / step;
        // Simpson's rule, whose error is of the fourth order
        let middle = law.at(step * f64::from(k));
        let told = (before.velocity + 4.0 * middle.velocity + after.velocity) / 6.0;
        close(mean, told, 1e-10);
    }
}

#[test]
fn a_slower_motion_is_at_the_same_places() {
    let law = law();
    let slow = law.slowed(0.8);
    close(slow.duration(), law.duration() / 0.8, 1e-14);
    for k in 0..=50 {
        let t = law.duration() * f64::from(k) / 50.0;
        let (fast, slow) = (law.at(t), slow.at(t / 0.8));
        close(slow.position, fast.position, 1e-12);
        close(slow.velocity, 0.8 * fast.velocity, 1e-9);
        close(slow.jerk, 0.512 * fast.jerk, 1e-7);
    }
    let whole = law.in_whole_cycles(0.008);
    let cycles = whole.duration() / 0.008;
    assert_eq!(cycles, cycles.round());
    assert!(whole.duration() >= law.duration() && whole.duration() < law.duration() + 0.008);
    assert_eq!(whole.in_whole_cycles(0.008).duration(), whole.duration());
}

#[test]
fn a_motion_that_stands_still_on_the_way_is_none() {
    assert_eq!(TimeLaw::linear(&[0.0, 1.0, 2.0, 3.0], &[0.0, 0.0, 1.0, 0.0]), None);
    let triangle = TimeLaw::linear(&[0.0, 1.0, 2.0], &[0.0, 2.0, 0.0]).unwrap();
    close(triangle.duration(), 2.0 * 2f64.sqrt(), 1e-15);
}
