//! What lowers the speed or shortens a transition, and what is refused.

use super::*;
use crate::tolerance::TRANSITION_ACCELERATION;

/// Largest acceleration and speed of the tool, sampled.
fn extremes(motion: &ConstantSpeedMotion) -> [f64; 2] {
    (0..=20_000)
        .map(|step| motion.duration() * f64::from(step) / 20_000.0)
        .map(|time| state(motion, time, Side::After))
        .fold([0.0, 0.0], |[most, fastest], [_, velocity, acceleration, _]| {
            [acceleration.norm().max(most), velocity.norm().max(fastest)]
        })
}

/// n = ⌈(L/Vs − 2·ta)/Δt⌉, Vs = L/(n·Δt + 2·ta).
#[test]
fn whole_cycles_lower_the_speed() {
    let segments = [arc(0.1, 2.0)];
    let request = ProcessRequest {
        cycle_time: Some(0.004),
        ..asked(&segments, 0.25, 0.05)
    };
    // (0.08/0.25 − 0.1)/0.004 is 55, and computed 55.000000000000014: that is no 56th cycle
    let rounded = [arc(0.1, 0.8)];
    let (_, report) = run(&ProcessRequest {
        segments: &rounded,
        ..request.clone()
    });
    assert!((report.speed / 0.25 - 1.0).abs() < 1e-14, "{report:?}");
    let (motion, report) = run(&request);
    // (0.2/0.25 − 0.1)/0.004 = 175, as it is
    assert_eq!((report.speed, report.lowered.as_deref()), (0.25, None));
    assert!((motion.duration() - 0.9).abs() < 1e-12);
    let request = ProcessRequest { speed: 0.24, ..request };
    let (motion, report) = run(&request);
    // (0.2/0.24 − 0.1)/0.004 = 183.3…
    assert!((report.speed - 0.2 / (184.0 * 0.004 + 0.1)).abs() < 1e-15, "{report:?}");
    assert_eq!((report.asked, report.lowered.as_deref()), (0.24, Some("whole cycles")));
    let [begin, end] = [report.transitions[0].end_time, report.transitions[1].begin_time];
    assert!(((end - begin) / 0.004 - 184.0).abs() < 1e-9);
    assert!((motion.duration() - (184.0 * 0.004 + 0.2)).abs() < 1e-12);
    // without a cycle nothing is lowered
    let request = ProcessRequest {
        cycle_time: None,
        ..request
    };
    assert_eq!(run(&request).1.speed, 0.24);
}

/// One speed for a chain: what is between its first transition and its last is whole.
#[test]
fn chains_take_whole_cycles_as_a_whole() {
    let draw = &mut 1;
    for (index, half_time) in [Some(0.04), None].into_iter().cycle().take(40).enumerate() {
        let segments = random_chain(1 + index % 5, draw);
        let request = ProcessRequest {
            cycle_time: Some(0.002),
            transition_time: half_time,
            ..asked(&segments, 0.4 + 0.3 * random(draw), 0.0)
        };
        let (motion, report) = run(&request);
        let last = report.transitions.len() - 1;
        let cycles = (report.transitions[last].begin_time - report.transitions[0].end_time) / 0.002;
        assert!((cycles - cycles.round()).abs() < 1e-6, "{cycles}");
        // chosen transitions take whole cycles as well, so that the motion does
        let all = motion.duration() / 0.002;
        assert!((all - all.round()).abs() < 1e-6, "{all}");
        let (_, free) = run(&ProcessRequest {
            cycle_time: None,
            ..request
        });
        let kept = report.speed / free.speed;
        assert!(kept <= 1.0 + 1e-12 && kept > 0.95, "{kept}");
    }
}

/// L < 2·Vs·ta: Vs = L/(2·ta), and the transitions meet.
#[test]
fn a_short_segment_lowers_the_speed() {
    let short = [arc(0.1, 0.2)];
    let (motion, report) = run(&asked(&short, 0.25, 0.05));
    assert!((report.speed - 0.02 / 0.1).abs() < 1e-15, "{report:?}");
    assert!((motion.duration() - 0.2).abs() < 1e-15);
    assert_eq!(motion.knots().len(), 3);
    assert!(report.lowered.unwrap().contains("segment 0"));
    // an edge of 4 mm in a long chain takes all of it down to 0.004/(2·0.05)
    let segments = [
        line([0.0, 0.0, 0.0], [0.5, 0.0, 0.0]),
        line([0.5, 0.0, 0.0], [0.5, 0.004, 0.0]),
        line([0.5, 0.004, 0.0], [1.0, 0.004, 0.0]),
    ];
    let (_, report) = run(&asked(&segments, 0.25, 0.05));
    assert!((report.speed - 0.04).abs() < 1e-15, "{report:?}");
    // an edge of 10 mm beside rest leaves 8 mm for its ramp, where a tolerance bounds the seam to D = 2 mm
    let beside_rest = [
        line([0.0, 0.0, 0.0], [0.01, 0.0, 0.0]),
        line([0.01, 0.0, 0.0], [0.01, 0.5, 0.0]),
    ];
    let request = ProcessRequest {
        tolerance: Some(0.375 * 0.002 * 0.5_f64.sqrt()),
        ..asked(&beside_rest, 0.25, 0.05)
    };
    let (_, report) = run(&request);
    assert!((report.speed / 0.16 - 1.0).abs() < 1e-9, "{report:?}");
    // the short edge in the long chain has room once a tolerance shortens its transitions: D = 2 mm is ⅜·D·sin 45° off
    let request = ProcessRequest {
        tolerance: Some(0.375e-3),
        ..asked(&segments, 0.25, 0.05)
    };
    let (_, report) = run(&request);
    assert_eq!(report.speed, 0.25, "{report:?}");
    assert!((report.transitions[1].deviation / 0.375e-3 - 1.0).abs() < 1e-9);
}

#[test]
fn a_tolerance_shortens_transitions_and_holds() {
    let draw = &mut 2;
    for index in 0..60 {
        let segments = random_chain(1 + index % 4, draw);
        let form = if index % 2 == 0 {
            Transition::Smooth
        } else {
            Transition::Source
        };
        let tolerance = 10.0_f64.powf(-4.0 + 1.5 * random(draw));
        let free = ProcessRequest {
            form,
            ..asked(&segments, 0.2, 0.1)
        };
        let bound = ProcessRequest {
            tolerance: Some(tolerance),
            ..free.clone()
        };
        let ((_, free), (motion, bound)) = (run(&free), run(&bound));
        for (free, bound) in free.transitions.iter().zip(&bound.transitions) {
            assert!(bound.deviation <= tolerance, "{tolerance} {bound:?}");
            let [free_time, time] = [free, bound].map(|transition| transition.end_time - transition.begin_time);
            if free.deviation <= tolerance {
                continue;
            }
            assert!(time < free_time);
            assert!(
                (bound.deviation / tolerance - 1.0).abs() < 1e-5,
                "{tolerance} {bound:?}"
            );
        }
        // and what is reported is what a dense look finds
        for transition in &bound.transitions {
            let worst = (0..=2000)
                .map(|step| {
                    let part = f64::from(step) / 2000.0;
                    let time = transition.begin_time + part * (transition.end_time - transition.begin_time);
                    let [position, ..] = state(&motion, time, Side::After);
                    let distances = segments
                        .iter()
                        .map(|taught| Segment::new(taught).unwrap().distance(&position));
                    distances.fold(f64::INFINITY, f64::min)
                })
                .fold(0.0, f64::max);
            assert!(worst <= transition.deviation + 1e-12, "{worst} {transition:?}");
        }
    }
}

/// Without ta it is chosen so that the ramp from rest peaks at the acceleration given: ¾·Vs/ta.
#[test]
fn acceleration_chooses_the_transitions() {
    let segments = corner(60.0);
    let request = ProcessRequest {
        transition_time: None,
        acceleration: Some(2.0),
        ..asked(&segments, 0.25, 0.0)
    };
    let (motion, report) = run(&request);
    let times = report
        .transitions
        .iter()
        .map(|transition| transition.end_time - transition.begin_time);
    for time in times {
        // at 60° |t̂+ − t̂−| is 1: the seam takes as long as the ramps
        assert!((time / (2.0 * 0.75 * 0.25 / 2.0) - 1.0).abs() < 1e-9, "{time}");
    }
    let [most, fastest] = extremes(&motion);
    assert!(
        most <= 2.0 && most > 1.999 && fastest <= 0.25 + 1e-12,
        "{most} {fastest}"
    );
    // a sharper corner takes longer, as far as there is length
    let sharp = corner(120.0);
    let (motion, report) = run(&ProcessRequest {
        segments: &sharp,
        ..request.clone()
    });
    let seam = report.transitions[1];
    assert!(((seam.end_time - seam.begin_time) / (1.5 * 0.25 * 3.0_f64.sqrt() / 2.0) - 1.0).abs() < 1e-9);
    assert!(extremes(&motion)[0] <= 2.0);
    // where nobody says, by a default that lowers nothing
    let (_, report) = run(&ProcessRequest {
        acceleration: None,
        ..request
    });
    let first = report.transitions[0];
    assert!((first.end_time / (1.5 * 0.25 / TRANSITION_ACCELERATION) - 1.0).abs() < 1e-9);
    assert_eq!(report.lowered, None);
}

#[test]
fn the_tool_keeps_its_acceleration() {
    let draw = &mut 3;
    let mut lowered = 0;
    for index in 0..60 {
        let segments = random_chain(1 + index % 4, draw);
        let limit = 10.0_f64.powf(0.5 * random(draw));
        let request = ProcessRequest {
            transition_time: (index % 3 == 0).then_some(0.1),
            tolerance: (index % 2 == 0).then_some(1e-3),
            acceleration: Some(limit),
            form: if index % 5 == 0 {
                Transition::Source
            } else {
                Transition::Smooth
            },
            ..asked(&segments, 0.8, 0.0)
        };
        let (motion, report) = run(&request);
        let [most, _] = extremes(&motion);
        assert!(most <= limit, "{most} {limit}");
        if report.speed < 0.8 {
            lowered += 1;
            // as far as needed and no farther
            let length_alone = report
                .lowered
                .as_deref()
                .is_some_and(|reason| !reason.contains("acceleration"));
            assert!(length_alone || most > 0.99 * limit, "{most} {limit} {report:?}");
        }
    }
    assert!(lowered > 20, "{lowered}");
}

#[test]
fn a_reach_bounds_its_seam_alone() {
    let segments = corner(90.0);
    let request = ProcessRequest {
        seam_reach: &[Some(0.005)],
        ..asked(&segments, 0.25, 0.05)
    };
    let (_, report) = run(&request);
    let times: Vec<f64> = report
        .transitions
        .iter()
        .map(|transition| transition.end_time - transition.begin_time)
        .collect();
    assert!(
        (times[1] - 0.04).abs() < 1e-12 && (times[0] - 0.1).abs() < 1e-12,
        "{times:?}"
    );
    assert_eq!(report.speed, 0.25);
}

/// The same curve, slower: every acceleration falls with the square.
#[test]
fn slowing_down_keeps_the_curve() {
    let draw = &mut 5;
    for half_time in [Some(0.08), None] {
        let segments = random_chain(5, draw);
        let full = ProcessRequest {
            transition_time: half_time,
            ..asked(&segments, 0.4, 0.0)
        };
        let slow = ProcessRequest {
            slow_down: 0.25,
            ..full.clone()
        };
        let ((fast, _), (slow, report)) = (run(&full), run(&slow));
        assert!((slow.duration() / fast.duration() - 4.0).abs() < 1e-12);
        assert_eq!(report.lowered.as_deref(), Some("slowed down"));
        for step in 0..=300 {
            let time = fast.duration() * f64::from(step) / 300.0;
            let (fast, slow) = (state(&fast, time, Side::After), state(&slow, 4.0 * time, Side::After));
            for order in 0..4 {
                let scale = 0.25_f64.powi(i32::try_from(order).unwrap());
                assert!((fast[order] * scale - slow[order]).norm() < 1e-7, "{order} {time}");
            }
        }
    }
}
