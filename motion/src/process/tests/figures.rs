//! A line and two arcs that meet at corners, against SciPy 1.17.1: seams by `BPoly.from_derivatives` in time, arcs by
//! `Rotation.from_rotvec`, extremes by `minimize_scalar` after a dense look, and where the nearest segment changes by
//! `brentq`.

use super::*;

const SPEED: f64 = 0.25;
const HALF_TIME: f64 = 0.05;

fn chain() -> [ProcessSegment; 3] {
    let out = [Vector3::new(0.15, 0.08, -0.06), Vector3::new(0.06, 0.1, 0.08)];
    let normal = [Vector3::new(0.0, 0.6, 0.8), Vector3::new(0.8, 0.0, -0.6)];
    let taught = Vector3::new(0.0, 0.0, 0.1);
    let first = ProcessSegment::Arc {
        center: taught - out[0],
        normal: normal[0],
        start: taught,
        angle: 1.9,
    };
    let segment = Segment::new(&first).unwrap();
    let end = segment.frame(segment.length).position;
    let second = ProcessSegment::Arc {
        center: end - out[1],
        normal: normal[1],
        start: end,
        angle: -4.4,
    };
    [line([-0.3, 0.05, 0.1], [0.0, 0.0, 0.1]), first, second]
}

/// Seam, h, then position, velocity, acceleration, jerk.
type Row = (usize, f64, [[f64; 3]; 4]);

const SEAMS: [Row; 4] = [
    (
        1,
        0.2,
        [
            [-0.007672297303574747, 0.0013841362632776978, 0.09990883596942061],
            [0.20686827231755658, -0.019324453455659266, -0.013125689775555694],
            [-3.6876211494362297, 1.9988884212603972, -1.203248138795662],
            [-141.28230085535935, 73.3023248623393, -43.879812003642805],
        ],
    ),
    (
        1,
        0.85,
        [
            [-0.005150252431992118, 0.005791829345299142, 0.09566575111143491],
            [-0.12493158150122388, 0.14835864322125528, -0.1131415896307165],
            [-3.2477829028402603, 1.4119968916272267, -0.8231878713042945],
            [160.9166732126972, -88.10640604814672, 53.133384285812355],
        ],
    ),
    (
        2,
        0.5,
        [
            [-0.29269276902275576, 0.01083981847026865, 0.0917872360126551],
            [-0.13120751341197923, 0.008323189419671763, -0.012932810375659421],
            [0.733275433831759, 4.7874344443998975, -3.9651729858399865],
            [-10.09447009536212, -3.3573283254888437, -8.359532164890787],
        ],
    ),
    (
        2,
        0.85,
        [
            [-0.296936383687066, 0.013788801539618315, 0.08904724179494958],
            [-0.11479182864794288, 0.1452364469792365, -0.13371449996046472],
            [0.14199677493906157, 2.2270392565767745, -2.2558680512235956],
            [-20.854513627250263, -142.06721690481012, 108.34386149576657],
        ],
    ),
];

#[test]
fn seams_are_those_of_scipy() {
    let segments = chain();
    let (motion, report) = run(&asked(&segments, SPEED, HALF_TIME));
    assert!((motion.duration() - 5.175677860512607).abs() < 1e-13);
    for (seam, h, expected) in SEAMS {
        let time = report.transitions[seam].begin_time + 2.0 * HALF_TIME * h;
        let got = state(&motion, time, Side::After);
        for (order, (got, expected)) in got.iter().zip(expected).enumerate() {
            // rounding grows by 1/(2·ta) with every derivative
            let tolerance = 1e-13 * 10.0_f64.powi(i32::try_from(order).unwrap());
            assert!(
                (got - Vector3::from(expected)).norm() < tolerance,
                "{seam} {h} {order}: {got}"
            );
        }
    }
}

#[test]
fn stretches_and_ramps_are_those_of_scipy() {
    let segments = chain();
    let (motion, report) = run(&asked(&segments, SPEED, HALF_TIME));
    let [position, velocity, ..] = state(&motion, 2.0886181968654336, Side::After);
    assert!((position - Vector3::new(-0.17822417401783464, 0.06244357985057465, 0.05316731511206904)).norm() < 1e-14);
    assert!((velocity - Vector3::new(-0.24691713029418075, -0.03131190973197577, 0.023483932298981828)).norm() < 1e-14);
    let time = report.transitions[3].begin_time + 2.0 * HALF_TIME * 0.35;
    let [position, ..] = state(&motion, time, Side::After);
    assert!((position - Vector3::new(-0.3169628765352505, -0.2202439162798881, 0.06244445580396478)).norm() < 1e-14);
}

#[test]
fn extremes_are_those_of_scipy() {
    let segments = chain();
    let (_, report) = run(&asked(&segments, SPEED, HALF_TIME));
    let taught: Vec<_> = segments.iter().map(|taught| Segment::new(taught).unwrap()).collect();
    let nodes = nodes(&taught);
    for (seam, corner, slowest, sharpest) in [
        (1, 0.0042666646479104725, 0.10211633017713102, 6.897015524691416),
        (2, 0.00400721446708062, 0.1321033983796498, 6.259611963878089),
    ] {
        let transition = report.transitions[seam];
        // the taught point is farther from the tool's way than that is from the taught path (1.7 and 2.1 mm)
        assert!((transition.deviation - corner).abs() < 1e-9, "{transition:?}");
        assert!((transition.lowest_speed - slowest).abs() < 1e-9, "{transition:?}");
        let got = SPEED * SPEED * measure::sharpest(&nodes[seam], Transition::Smooth, SPEED * HALF_TIME);
        assert!((got - sharpest).abs() < 1e-9, "{got}");
    }
    for (seam, expected) in [(1, 0.0017472000963887448), (2, 0.00210744416602046)] {
        let got = measure::off_path(&nodes[seam], Transition::Smooth, SPEED * HALF_TIME);
        assert!((got - expected).abs() < 1e-12, "{seam}: {got}");
    }
}
