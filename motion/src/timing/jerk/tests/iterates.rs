//! What the interior point does on the way.

use super::*;

/// The last iterate of every solve, good or bad, obeys every row, and more iterations make the motion faster.
#[test]
fn every_iterate_obeys_every_row() {
    let arm = with_drives(&ur5e());
    let mut stretch = with_jerk(own_limits(&arm), 15.0, 150.0);
    stretch.tool_velocity = Some(1.5);
    stretch.tool_acceleration = Some(8.0);
    let limits = Limits::uniform(stretch);
    let curve = random_walk(6, 2, &[3.1; 6], 5);
    let tcp = Isometry3::translation(0.05, 0.0, 0.1);
    let task = Task {
        robot: &arm,
        tcp: &tcp,
        curve: &curve,
        limits: &limits,
        end_speeds: [0.0; 2],
        intervals: 80,
    };
    let budget = Budget::unlimited();
    let fixed = fixed_nodes(task.curve, task.limits);
    let mut level = Level::new(&task, nodes::even(&fixed, 80), &fixed, &budget)
        .unwrap()
        .unwrap();
    let start = level.first(START_COLD);
    let mut durations = Vec::new();
    for gap in [1e9, 3.0, 1.0, 0.3, 0.1, 1e-2, 1e-3, 1e-4] {
        let mut x = start.clone();
        let accuracy = Accuracy { gap, ..COLD };
        let ended = Solver::new(&level.problem)
            .improve(&mut level.problem, &mut x, &accuracy, &budget)
            .unwrap();
        assert!(ended.converged && ended.iterations > 0, "{ended:?}");
        for (k, sample) in level.problem.samples.iter().enumerate() {
            let room = level
                .problem
                .rows
                .uniform_speed(k, sample.form.apply(&x), 1.0, f64::INFINITY);
            assert!(room > 1.0, "{gap} {k} {room}");
        }
        durations.push(ended.duration);
    }
    assert!(
        durations.is_sorted_by(|slower, faster| slower >= faster),
        "{durations:?}"
    );
    let [.., at_1e3, at_1e4] = durations[..] else {
        unreachable!()
    };
    assert!(at_1e3 < (1.0 + 1e-3) * at_1e4, "{durations:?}");
}

/// A start that breaks a row is left as it is.
#[test]
fn a_start_beyond_the_limits_is_refused() {
    let arm = robot(planar());
    let limits = Limits::uniform(with_jerk(own_limits(&arm), 40.0, 400.0));
    let swing = Polynomials::new(vec![vec![-1.0, 1.5], vec![0.4]], 1.0);
    let tcp = Isometry3::identity();
    let task = Task {
        robot: &arm,
        tcp: &tcp,
        curve: &swing,
        limits: &limits,
        end_speeds: [0.0; 2],
        intervals: 40,
    };
    let budget = Budget::unlimited();
    let fixed = fixed_nodes(task.curve, task.limits);
    let mut level = Level::new(&task, nodes::even(&fixed, 40), &fixed, &budget)
        .unwrap()
        .unwrap();
    for target in [1.2, f64::NAN] {
        let mut x = level.first(0.6);
        for x in &mut x {
            *x *= target / 0.36;
        }
        let before = x.clone();
        let ended = Solver::new(&level.problem)
            .improve(&mut level.problem, &mut x, &COLD, &budget)
            .unwrap();
        assert!(!ended.converged && ended.iterations == 0);
        assert!(x.iter().zip(&before).all(|(x, before)| x.to_bits() == before.to_bits()));
    }
}
