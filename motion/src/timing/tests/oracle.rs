//! Against engines that nobody here wrote, on the same discretised problem: toppra 0.6.10 (constraints by Pinocchio 4.1.0,
//! interpolation scheme, Seidel's solver) and the second-order cone program solved by Clarabel 0.11.1, both in Python.
//!
//! UR5e of the test vectors without rotors and friction, polynomial paths over s in [0, 1] with 200 even intervals, its own
//! limits of speed and torque, or of speed and 12 rad/s² of every joint.

use super::super::rows::{RowPlaces, Rows};
use super::*;

const FIRST: [[f64; 5]; 6] = [
    [-0.4, 1.2, 0.8, -1.5, 0.6],
    [-1.3, -0.9, 1.4, 0.3, -0.5],
    [1.1, 0.7, -2.2, 1.6, -0.3],
    [-0.8, 1.5, -0.4, -1.1, 0.7],
    [0.9, -1.3, 1.7, -0.6, 0.2],
    [0.2, 2.0, -1.1, 0.4, -0.9],
];

const SECOND: [[f64; 5]; 6] = [
    [0.7, -2.1, 1.3, 2.4, -2.2],
    [-0.9, 1.1, -2.6, 2.3, -0.8],
    [-1.2, 0.4, 3.1, -2.9, 0.5],
    [0.3, -0.8, -1.9, 3.4, -1.2],
    [-1.0, 2.2, 0.6, -2.7, 1.1],
    [1.4, -1.7, 0.9, 0.8, -1.6],
];

/// Nodes at which a is compared.
const NODES: [usize; 7] = [20, 50, 80, 100, 130, 160, 190];

fn curve(joints: &[[f64; 5]; 6]) -> Polynomials {
    Polynomials::new(joints.iter().map(|joint| joint.to_vec()).collect(), 1.0)
}

fn velocity_and_torque() -> Limits {
    Limits::uniform(own_limits(&ur5e()))
}

fn velocity_and_acceleration() -> Limits {
    let mut stretch = own_limits(&ur5e());
    for joint in &mut stretch.joints {
        (joint.torque, joint.acceleration) = (None, Some(12.0));
    }
    Limits::uniform(stretch)
}

/// The fastest a on 200 even intervals, without reserve and without tightening.
fn plain(curve: &Polynomials, limits: &Limits, parts: usize, ends: [f64; 2]) -> (Vec<f64>, f64) {
    let arm = ur5e();
    let fixed = fixed_nodes(curve, limits);
    let grid = Grid::new(even(&fixed, 200), &fixed, parts);
    let budget = Budget::unlimited();
    let coefficients =
        Coefficients::compute(&arm, &Isometry3::identity(), curve, limits, &grid.places, &budget).unwrap();
    let rooms = Rooms {
        reserve: 0.0,
        ..Rooms::full(&coefficients)
    };
    let places = RowPlaces::new(&grid, parts);
    let rows = Rows::new(&coefficients, limits, &rooms, &places, None);
    let squares = reach::fastest(&grid, &rows, ends, &budget).unwrap().unwrap();
    let duration = TimeLaw::linear(&grid.nodes, &squares).unwrap().duration();
    (squares, duration)
}

fn check_toppra(joints: &[[f64; 5]; 6], limits: &Limits, duration: f64, squares: [f64; 7]) {
    let (found, found_duration) = plain(&curve(joints), limits, 1, [0.0; 2]);
    for (node, expected) in NODES.into_iter().zip(squares) {
        assert!(
            (found[node] - expected).abs() < 2e-6 * expected,
            "{node} {} {expected}",
            found[node]
        );
    }
    assert!(
        (found_duration - duration).abs() < 1e-6 * duration,
        "{found_duration} {duration}"
    );
}

#[test]
fn toppra_agrees_under_velocity_and_acceleration_limits() {
    let squares = [
        1.4075678, 3.9063399, 3.2534093, 2.8339247, 2.2776837, 1.8239072, 0.6174148,
    ];
    check_toppra(&FIRST, &velocity_and_acceleration(), 0.876_107_326, squares);
    let squares = [
        1.0633200, 2.3201275, 3.0841399, 3.1559503, 3.0201029, 2.2663252, 0.3833212,
    ];
    check_toppra(&SECOND, &velocity_and_acceleration(), 0.946_428_114, squares);
}

#[test]
fn toppra_agrees_under_velocity_and_torque_limits() {
    let squares = [
        3.0858188, 4.5751362, 6.0846224, 7.1486492, 9.9121809, 12.4042358, 2.2518167,
    ];
    check_toppra(&FIRST, &velocity_and_torque(), 0.471_683_250, squares);
    let squares = [
        1.9610394, 2.3201275, 3.5576100, 3.9786768, 5.8086829, 2.4654283, 0.9001791,
    ];
    check_toppra(&SECOND, &velocity_and_torque(), 0.667_713_514, squares);
}

#[test]
fn toppra_agrees_between_speeds_at_both_ends() {
    for (joints, duration) in [(&FIRST, 0.452_891_964), (&SECOND, 0.651_191_332)] {
        let (squares, found) = plain(&curve(joints), &velocity_and_torque(), 1, [0.25, 0.49]);
        assert!((found - duration).abs() < 1e-6 * duration, "{found} {duration}");
        assert_eq!((squares[0], squares[200]), (0.25, 0.49));
    }
}

/// Rows at both ends and in the middle of each interval: the convex optimum of ∫ ds/√a.
#[test]
fn the_cone_program_has_the_same_optimum() {
    for (joints, duration) in [(&FIRST, 0.471_705_403), (&SECOND, 0.667_739_219)] {
        let (_, found) = plain(&curve(joints), &velocity_and_torque(), 2, [0.0; 2]);
        assert!((found / duration - 1.0).abs() < 1e-4, "{found} {duration}");
    }
}

/// The benchmark measures the same problem.
#[test]
fn the_benchmark_times_what_toppra_times() {
    let found = measured::interpolated(&ur5e(), &curve(&FIRST), 200).unwrap();
    assert!((found - 0.471_683_250).abs() < 1e-6, "{found}");
    let certified = measured::certified(&ur5e(), &curve(&FIRST), 200).unwrap();
    assert!(certified > found && certified < 1.01 * found, "{certified} {found}");
}
