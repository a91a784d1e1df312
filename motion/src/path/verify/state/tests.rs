//! Directions of motion against paths written by hand.

use super::*;
use crate::timing::law::Piece;

/// Joints that go as polynomials of s, by their coefficients, over one unit of length.
struct Polynomials(Vec<[f64; 4]>);

impl Curve for Polynomials {
    fn joint_count(&self) -> usize {
        self.0.len()
    }

    fn length(&self) -> f64 {
        1.0
    }

    fn knots(&self) -> &[f64] {
        &[0.0, 1.0]
    }

    fn evaluate(&self, s: f64, _: Side, point: &mut CurvePoint) {
        for (joint, [c0, c1, c2, c3]) in self.0.iter().enumerate() {
            point.position[joint] = c0 + s * (c1 + s * (c2 + s * c3));
            point.first[joint] = c1 + s * (2.0 * c2 + 3.0 * s * c3);
            point.second[joint] = 2.0 * c2 + 6.0 * s * c3;
            point.third[joint] = 6.0 * c3;
        }
    }
}

/// From rest to rest in 2 s, with and without a jump of the acceleration at the ends.
fn laws() -> [TimeLaw; 2] {
    let [middle, end] = [0.5, 1.0];
    let soft = vec![
        Piece {
            begin: 0.0,
            end: middle,
            form: crate::timing::law::Form::FromRest { end: 1.0 },
        },
        Piece {
            begin: middle,
            end,
            form: crate::timing::law::Form::ToRest { begin: 1.0 },
        },
    ];
    let hard = TimeLaw::linear(&[0.0, middle, end], &[0.0, 1.0, 0.0]);
    [hard.unwrap(), TimeLaw::new(soft).unwrap()]
}

fn directions(curve: &Polynomials, law: &TimeLaw, time: f64, side: Side) -> Vec<f64> {
    let mut state = State::new(curve.0.len());
    state.set(curve, law, time, side);
    state
        .direction
        .iter()
        .map(|way| if *way == 0.0 { 0.0 } else { way.signum() })
        .collect()
}

#[test]
fn a_joint_sets_out_as_its_first_derivative_that_is_not_zero_says() {
    let curve = Polynomials(vec![
        [0.3, 0.7, -0.2, 0.0],
        [0.3, -0.7, 2.0, 0.0],
        [0.1, 0.0, -0.5, 1.0],
        [0.1, 0.0, 0.5, -1.0],
        [0.0, 0.0, 0.0, 2.0],
        [0.0, 0.0, 0.0, -2.0],
        [0.4, 0.0, 0.0, 0.0],
        // a rounding where it should be zero
        [0.0, -1e-17, 0.5, 0.0],
    ]);
    for law in laws() {
        let found = directions(&curve, &law, 0.0, Side::After);
        assert_eq!(found, [1.0, -1.0, -1.0, 1.0, 1.0, -1.0, 0.0, 1.0]);
    }
}

#[test]
fn a_joint_arrives_as_it_moved_just_before() {
    // about s = 1: q = c1·(s − 1) + c2·(s − 1)² + c3·(s − 1)³
    let about = |c1: f64, c2: f64, c3: f64| [0.0, c1 - 2.0 * c2 + 3.0 * c3, c2 - 3.0 * c3, c3];
    let curve = Polynomials(vec![
        about(0.5, 1.0, 0.0),
        about(0.0, 1.0, 0.0),
        about(0.0, -1.0, 0.5),
        about(-0.25, 0.0, 0.0),
    ]);
    for law in laws() {
        let found = directions(&curve, &law, law.duration(), Side::Before);
        assert_eq!(found, [1.0, -1.0, 1.0, -1.0]);
    }
}

#[test]
fn a_joint_that_turns_back_has_a_direction_of_either_side() {
    // turns at s = 1/2, where q″ is not zero; the other one stands
    let curve = Polynomials(vec![[0.0, 1.0, -1.0, 0.0], [0.2, 0.0, 0.0, 0.0]]);
    for law in laws() {
        let time = law.time_at(0.5);
        let mut state = State::new(2);
        state.set(&curve, &law, time, Side::After);
        assert_eq!(state.velocity, [0.0; 2]);
        assert_eq!(directions(&curve, &law, time, Side::Before), [1.0, 0.0]);
        assert_eq!(directions(&curve, &law, time, Side::After), [-1.0, 0.0]);
        assert_eq!(directions(&curve, &law, 0.9 * time, Side::After), [1.0, 0.0]);
        assert_eq!(directions(&curve, &law, 1.1 * time, Side::After), [-1.0, 0.0]);
    }
}

#[test]
fn an_arm_at_rest_moves_nowhere() {
    let mut state = State::new(1);
    state.set(&Polynomials(vec![[0.0, 1.0, 0.0, 0.0]]), &laws()[0], 0.5, Side::After);
    assert_ne!(state.direction, [0.0]);
    state.rest_at(&[0.3]);
    assert_eq!(
        (state.position[0], state.velocity[0], state.direction[0]),
        (0.3, 0.0, 0.0)
    );
}

#[test]
fn a_joint_slower_than_the_others_has_a_velocity_until_all_rest() {
    let curve = Polynomials(vec![[0.0, 1e-6, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]]);
    for law in laws() {
        let mut state = State::new(2);
        let before = law.duration() * (1.0 - 3e-5);
        state.set(&curve, &law, before, Side::After);
        assert!(state.velocity.iter().all(|velocity| *velocity > 0.0), "{state:?}");
        state.set(&curve, &law, law.duration(), Side::Before);
        assert_eq!(state.velocity, [0.0, 0.0]);
    }
}
