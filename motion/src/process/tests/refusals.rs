//! What is refused, and that everything else has an answer.

use super::*;

#[test]
fn what_cannot_be_is_refused_by_name() {
    let sound = [line([0.0; 3], [1.0, 0.0, 0.0])];
    let request = |segments| asked(segments, 0.25, 0.05);
    let point = [line([1.0; 3], [1.0; 3]), line([1.0; 3], [2.0, 1.0, 1.0])];
    assert_eq!(
        refusals(&request(&point)),
        ["segments[0]: is 0 m long; a constant speed needs 0.000001 m or more"]
    );
    let apart = [line([0.0; 3], [1.0, 0.0, 0.0]), line([1.0, 0.1, 0.0], [2.0, 0.0, 0.0])];
    assert_eq!(
        refusals(&request(&apart)),
        ["segments[1]: begins 0.1 m from where the one before it ends"]
    );
    assert_eq!(refusals(&request(&[])), ["segments: has no segment"]);
    let wrong = ProcessRequest {
        speed: -1.0,
        transition_time: Some(0.0),
        tolerance: Some(f64::NAN),
        acceleration: Some(f64::INFINITY),
        cycle_time: Some(0.0),
        slow_down: 0.0,
        seam_reach: &[None, Some(0.0)],
        ..request(&sound)
    };
    let paths: Vec<String> = refusals(&wrong)
        .iter()
        .map(|wrong| wrong.split(':').next().unwrap().to_owned())
        .collect();
    let all = [
        "speed",
        "transition_time",
        "tolerance",
        "acceleration",
        "cycle_time",
        "seam_reach[1]",
        "slow_down",
    ];
    assert_eq!(paths, all);
    // transitions of an hour and more leave a speed that never ends
    let endless = refusals(&asked(&sound, 0.25, 1.0e6));
    assert!(endless[0].starts_with("speed: takes 4000000 s"), "{endless:?}");
    assert!(refusals(&asked(&sound, 1.0e4, 0.05))[0].contains("must be 1000 m/s or less"));
    assert!(refusals(&asked(&sound, 1.0e-12, 0.05))[0].starts_with("speed: takes"));
}

/// Whatever is asked, an answer: no panic, no value that is not finite.
#[test]
fn any_numbers_end_in_an_answer() {
    let draw = &mut 4;
    let wild = |draw: &mut u64| 10.0_f64.powf(8.0 * random(draw));
    let mut answered = 0;
    for index in 0..400 {
        let mut segments = random_chain(1 + index % 3, draw);
        if index % 4 == 0 {
            segments = vec![ProcessSegment::Arc {
                center: vector(draw) * wild(draw),
                normal: Vector3::z() * wild(draw),
                start: vector(draw),
                angle: wild(draw),
            }];
            if let ProcessSegment::Arc { center, start, .. } = &mut segments[0] {
                center.z = start.z;
            }
        }
        let request = ProcessRequest {
            transition_time: (index % 2 == 0).then(|| wild(draw)),
            tolerance: (index % 3 == 0).then(|| wild(draw)),
            acceleration: (index % 5 == 0).then(|| wild(draw)),
            cycle_time: (index % 7 == 0).then(|| wild(draw)),
            form: if index % 2 == 0 {
                Transition::Smooth
            } else {
                Transition::Source
            },
            ..asked(&segments, wild(draw), 0.0)
        };
        let Ok((motion, report)) = constant_speed(&request, &Budget::unlimited()) else {
            continue;
        };
        answered += 1;
        assert!(report.speed > 0.0 && report.speed <= report.asked);
        for transition in &report.transitions {
            let values = [
                transition.deviation,
                transition.velocity_jump,
                transition.acceleration_jump,
                transition.lowest_speed,
            ];
            assert!(
                values.iter().all(|value| value.is_finite() && *value >= 0.0),
                "{transition:?}"
            );
            if request.form == Transition::Smooth {
                assert_eq!(
                    (transition.velocity_jump, transition.acceleration_jump),
                    (0.0, 0.0),
                    "{request:?}"
                );
            }
        }
        for step in 0..=50 {
            let state = state(&motion, motion.duration() * f64::from(step) / 50.0, Side::After);
            assert!(state.iter().all(|v| v.iter().all(|x| x.is_finite())));
        }
    }
    assert!(answered > 100, "{answered}");
}

#[test]
fn a_stopped_budget_stops() {
    let segments = corner(90.0);
    let stopped = Budget::until(&|| true);
    assert!(matches!(
        constant_speed(&asked(&segments, 0.25, 0.05), &stopped),
        Err(Failure::Stopped)
    ));
}
