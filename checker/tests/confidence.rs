//! Plans that hold at a confidence, checked by bands that share nothing with the planner's.

use takt_checker::Workspace;
use takt_checker::band::{At, Bands};
use takt_checker::draw::{self, Draw};
use takt_checker::motion::{duration, part_at, state_in};
use takt_motion::budget::Budget;
use takt_motion::confidence::{Confidence, Over, plan_move};
use takt_motion::plan::outcome::{MoveOutcome, Pattern};
use takt_motion::plan::request::MoveRequest;
use takt_motion::robot::Robot;
use takt_motion::robot::spec::{Parameter, ParameterKind, Residual, RobotSpec, Uncertainty};

/// Level and z: `scipy.stats.norm.isf(0.05)` of SciPy 1.17.1.
const LEVEL: f64 = 0.9;
const MULTIPLIER: f64 = 1.644_853_626_951_472_9;

/// Enough to hold the drawn arms in most poses, and little enough to bound their moves, N m.
const PEAK_TORQUE: f64 = 300.0;

/// Samples of a move, besides those just beside its switching times.
const SAMPLES: usize = 400;

/// Ten parameters of every body and six of every drive.
fn parameters(joint_count: usize) -> Vec<Parameter> {
    use ParameterKind as K;
    let mut kinds = vec![K::Mass];
    kinds.extend((0..3).map(K::FirstMoment));
    kinds.extend((0..6).map(K::Inertia));
    kinds.extend([K::Armature, K::Viscous, K::CoulombPositive, K::CoulombNegative]);
    kinds.extend([K::LoadCoulomb, K::Quadratic]);
    let of = |joint| kinds.clone().into_iter().map(move |kind| Parameter { joint, kind });
    (0..joint_count).flat_map(of).collect()
}

/// An arm that is known within a drawn covariance, and whose residuals are normal.
fn uncertain(draw: &mut Draw, joint_count: usize) -> RobotSpec {
    let mut spec = draw::arm(draw, joint_count);
    for joint in &mut spec.joints {
        joint.limits.velocity = Some(2.0);
        joint.limits.acceleration = Some(40.0);
        joint.drive.peak_torque = Some(PEAK_TORQUE);
    }
    let parameters = parameters(joint_count);
    let count = parameters.len();
    let size = |kind: ParameterKind| match kind {
        ParameterKind::Mass => 0.05,
        ParameterKind::FirstMoment(_) => 0.01,
        ParameterKind::Inertia(_) => 3e-3,
        ParameterKind::LoadCoulomb => 0.01,
        _ => 0.02,
    };
    let root: Vec<Vec<f64>> = parameters
        .iter()
        .map(|parameter| {
            let reach = size(parameter.kind) / (count as f64).sqrt();
            draw::values(draw, count, reach * 3.0_f64.sqrt())
        })
        .collect();
    let product = |i: usize, j: usize| root[i].iter().zip(&root[j]).map(|(a, b)| a * b).sum::<f64>();
    let residual = Residual {
        deviation: 0.3,
        correlation_time: 0.1,
        degrees_of_freedom: f64::INFINITY,
    };
    spec.uncertainty = Some(Uncertainty {
        covariance: (0..count)
            .flat_map(|i| (0..=i).map(move |j| (i, j)))
            .map(|(i, j)| product(i, j))
            .collect(),
        parameters,
        residuals: vec![residual; joint_count],
    });
    spec
}

fn request(start: Vec<f64>, target: Vec<f64>) -> MoveRequest {
    MoveRequest::new(start, target)
}

/// The least room that torque and band leave along a move, as part of the limit.
fn least_margin(spec: &RobotSpec, start: &[f64], patterns: &[Pattern]) -> f64 {
    let bands = Bands::new(spec, None).expect("the arm carries its uncertainty");
    let known = spec.uncertainty.as_ref().expect("the arm carries its uncertainty");
    let workspace = &mut Workspace::default();
    let whole = patterns.iter().map(duration).fold(0.0, f64::max);
    let beside = patterns.iter().flat_map(|pattern| {
        let switches = [
            0.0,
            pattern.acceleration_time,
            pattern.acceleration_time + pattern.cruise_time,
            whole,
        ];
        switches.map(|time| [time - 1e-9 * whole, time + 1e-9 * whole])
    });
    let even = (0..SAMPLES).map(|k| whole * (k as f64 + 0.5) / SAMPLES as f64);
    let times = beside.flatten().chain(even).filter(|time| *time > 0.0 && *time < whole);
    let mut least = f64::INFINITY;
    for time in times {
        let states = patterns
            .iter()
            .map(|pattern| state_in(pattern, part_at(pattern, time), time));
        let states: Vec<_> = states.collect();
        let q: Vec<f64> = states
            .iter()
            .zip(start)
            .map(|(state, start)| start + state.travelled)
            .collect();
        let qd: Vec<f64> = states.iter().map(|state| state.velocity).collect();
        let qdd: Vec<f64> = states.iter().map(|state| state.acceleration).collect();
        let direction: Vec<f64> = patterns.iter().map(|pattern| pattern.displacement).collect();
        let at = At {
            q: &q,
            qd: &qd,
            qdd: &qdd,
            direction: &direction,
        };
        let (torque, deviation) = bands.at(workspace, at);
        for (joint, spec) in spec.joints.iter().enumerate() {
            let Some(limit) = spec.drive.peak_torque else { continue };
            let band = MULTIPLIER * deviation[joint].hypot(known.residuals[joint].deviation);
            least = least.min((limit - torque[joint].abs() - band) / limit);
        }
    }
    least
}

#[test]
fn torque_and_band_stay_within_the_limit_and_close_to_the_margin_stated() {
    let mut draw = Draw::seeded(31);
    let (mut planned, mut costly) = (0, 0);
    for _ in 0..12 {
        let spec = uncertain(&mut draw, 4);
        let (start, target) = (draw::pose_within(&mut draw, &spec), draw::pose_within(&mut draw, &spec));
        let robot = Robot::new(spec.clone(), Vec::new()).expect("random arms are sound");
        let confidence = Confidence {
            level: LEVEL,
            over: Over::Sample,
        };
        let asked = request(start.clone(), target);
        let answer = plan_move(&robot, &asked, confidence, &Budget::unlimited()).expect("a sound request");
        let (MoveOutcome::Plan(plan), Some(report)) = (answer.outcome, answer.report) else {
            continue;
        };
        planned += 1;
        costly += usize::from(report.joints.iter().any(|joint| joint.set_aside > 0.0));
        let least = least_margin(&spec, &start, &plan.patterns);
        let stated = report
            .joints
            .iter()
            .map(|joint| joint.margin)
            .fold(f64::INFINITY, f64::min);
        assert!(least > -1e-6, "{least}");
        // rests count for the planner and not here; samples miss less than a thousandth of a limit
        assert!(stated <= least + 1e-3, "{stated} stated, {least} found");
    }
    assert!(planned > 6 && costly > 3, "{planned} {costly}");
}
