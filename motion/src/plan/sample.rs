//! Samples of a plan: set-points on the caller's cycle, or a trace for looking at.

use super::Failure;
use super::outcome::{JointColumns, Pattern, Setpoints};
use super::problem::Problem;
use super::request::Sampling;
use crate::budget::Budget;
use crate::dynamics::sweep::Sweep;
use crate::trajectory::{self, Trajectory};

/// Samples computed at once: it bounds the scratch memory.
const BLOCK: usize = 1024;

/// One moment of a plan, in the segment whose values it takes; `None`: at rest at the target.
type Moment = (f64, Option<usize>);

/// Samples a plan as asked; `None` where no samples were asked for.
pub(super) fn setpoints(
    problem: &Problem,
    patterns: &[Pattern],
    target: &[f64],
    sampling: Sampling,
    budget: &Budget<'_>,
) -> Result<Option<Setpoints>, Failure> {
    let duration = trajectory::duration(patterns);
    let motion = (duration > 0.0).then(|| Trajectory::of_patterns(&problem.start, patterns));
    let moments = match (sampling, &motion) {
        (Sampling::None, _) => return Ok(None),
        (_, None) => vec![(0.0, None)],
        (Sampling::Period(period), Some(motion)) => on_cycle(motion, duration, period),
        (Sampling::Trace(points), Some(motion)) => evenly(motion, duration, points),
    };
    let count = patterns.len();
    let mut setpoints = Setpoints {
        time: moments.iter().map(|(time, _)| *time).collect(),
        joints: vec![JointColumns::with_capacity(moments.len()); count],
    };
    let mut sweep = Sweep::default();
    for block in moments.chunks(BLOCK) {
        budget.check()?;
        sweep.reset(count, block.len());
        for (sample, (time, segment)) in block.iter().enumerate() {
            match (segment, &motion) {
                (Some(segment), Some(motion)) => {
                    sweep.set(sample, motion.segment(*segment), time - motion.times()[*segment]);
                }
                _ => sweep.set_position(sample, target),
            }
        }
        sweep.compute(problem.robot.chain());
        for (joint, columns) in setpoints.joints.iter_mut().enumerate() {
            let drive = &problem.robot.drives()[joint];
            for (sample, (_, segment)) in block.iter().enumerate() {
                let entry = sweep.column(joint) + sample;
                let (velocity, acceleration) = (sweep.velocity[entry], sweep.acceleration[entry]);
                let moving = segment.is_some() && patterns[joint].moves();
                let direction = if moving { patterns[joint].displacement } else { 0.0 };
                let friction =
                    drive.viscous * velocity + drive.drag(velocity) + drive.coulomb(direction, sweep.gravity[entry]);
                let added = drive.armature * acceleration + friction;
                columns.position.push(sweep.position[entry]);
                columns.velocity.push(velocity);
                columns.acceleration.push(acceleration);
                columns.torque.push(sweep.torque[entry] + added);
            }
        }
    }
    Ok(Some(setpoints))
}

/// Every whole number of periods. The plan was stretched to end on one, where it is at rest.
fn on_cycle(motion: &Trajectory, duration: f64, period: f64) -> Vec<Moment> {
    let cycles = (duration / period).round() as usize;
    (0..cycles)
        .map(|k| {
            let time = period * k as f64;
            (time, Some(segment_after(motion, time)))
        })
        .chain([(period * cycles as f64, None)])
        .collect()
}

/// Evenly spaced, and both sides of every switching time.
fn evenly(motion: &Trajectory, duration: f64, points: usize) -> Vec<Moment> {
    let step = duration / (points - 1) as f64;
    let inner = (0..points - 1).map(|k| {
        let time = step * k as f64;
        (time, Some(segment_after(motion, time)))
    });
    let switches = (1..motion.segment_count())
        .flat_map(|segment| [segment - 1, segment].map(|side| (motion.times()[segment], Some(side))));
    let mut moments: Vec<Moment> = inner.chain(switches).collect();
    moments.push((duration, Some(motion.segment_count() - 1)));
    moments.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    moments.dedup();
    moments.push((duration, None));
    moments
}

/// The segment that holds just after a time.
fn segment_after(motion: &Trajectory, time: f64) -> usize {
    motion
        .times()
        .partition_point(|t| *t <= time)
        .clamp(1, motion.segment_count())
        - 1
}

impl JointColumns {
    fn with_capacity(samples: usize) -> Self {
        Self {
            position: Vec::with_capacity(samples),
            velocity: Vec::with_capacity(samples),
            acceleration: Vec::with_capacity(samples),
            torque: Vec::with_capacity(samples),
        }
    }
}
