//! The end-pose method of JP4358979B2 (fig. 4), written a second time and on the checker's own dynamics, so that what
//! its check of the two end poses lets through can be measured, and the planner's patterns compared.
//!
//! Nothing here looks at the motion between the ends; [`crate::recheck()`] does.

use takt_motion::plan::outcome::{Fallback, Pattern};
use takt_motion::robot::spec::RobotSpec;

use crate::arm::{Arm, Workspace};
use crate::bounds::Bounds;
use crate::draw::{self, Draw};
use crate::statistics::quantile;
use crate::tolerance;

/// What the method starts from, one entry a joint, all magnitudes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Preset {
    /// Taught speed, rad/s or m/s.
    pub velocity: Vec<f64>,
    /// Acceleration that is safe in every pose.
    pub acceleration: Vec<f64>,
    /// Deceleration that is safe in every pose.
    pub deceleration: Vec<f64>,
}

/// A move by the end-pose method.
#[derive(Debug, Clone, PartialEq)]
pub struct EndpointMove {
    /// One a joint.
    pub patterns: Vec<Pattern>,
    /// s.
    pub duration: f64,
    /// Duration of the preset pattern (eq 41 to 51 and 67 to 69), s.
    pub preset_duration: f64,
    /// Which fallback was needed.
    pub fallback: Fallback,
}

/// One of the two end poses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// The start.
    Start,
    /// The target.
    Target,
}

/// No acceleration keeps the torque limits at an end pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NoAcceleration {
    /// At which pose.
    pub end: End,
}

/// The trapezoid or triangle of one joint over the way `distance ≥ 0` (eq 41 to 51), all magnitudes.
fn first_calculation(distance: f64, velocity: f64, acceleration: f64, deceleration: f64) -> Pattern {
    if distance == 0.0 {
        return Pattern::default();
    }
    let ramps = velocity / acceleration + velocity / deceleration;
    let ramp_distance = 0.5 * velocity * ramps;
    // Too short for the speed: the triangle of the same slopes and this area (eq 46).
    let part = (distance / ramp_distance).sqrt().min(1.0);
    let peak = velocity * part;
    Pattern {
        displacement: distance,
        peak_velocity: peak,
        acceleration,
        deceleration,
        acceleration_time: peak / acceleration,
        cruise_time: ((distance - ramp_distance) / velocity).max(0.0),
        deceleration_time: peak / deceleration,
    }
}

/// The pattern of the same way in exactly `duration` with the same accelerations (eq 90 to 97); `None` where there is
/// none, or only a faster one than `velocity`.
fn second_calculation(pattern: &Pattern, duration: f64, velocity: f64) -> Option<Pattern> {
    let (up, down) = (pattern.acceleration, pattern.deceleration);
    let harmonic = up * down / (up + down);
    let squared = duration * duration;
    let left = squared - 2.0 * pattern.displacement / harmonic;
    let cruise_time = match left.abs() <= tolerance::SAME_TIME * squared {
        true => 0.0,
        false => left.sqrt(),
    };
    let peak_velocity = (duration - cruise_time) * harmonic;
    if cruise_time.is_nan() || peak_velocity > velocity * (1.0 + tolerance::SAME_TIME) {
        return None;
    }
    Some(Pattern {
        peak_velocity,
        acceleration_time: peak_velocity / up,
        cruise_time,
        deceleration_time: peak_velocity / down,
        ..*pattern
    })
}

/// The pattern drawn out to `duration` (eq 67 to 69).
fn drawn_out(pattern: &Pattern, duration: f64) -> Pattern {
    let own = time_of(pattern);
    if own == 0.0 {
        return *pattern;
    }
    let ratio = own / duration;
    Pattern {
        displacement: pattern.displacement,
        peak_velocity: pattern.peak_velocity * ratio,
        acceleration: pattern.acceleration * ratio * ratio,
        deceleration: pattern.deceleration * ratio * ratio,
        acceleration_time: pattern.acceleration_time / ratio,
        cruise_time: pattern.cruise_time / ratio,
        deceleration_time: pattern.deceleration_time / ratio,
    }
}

fn time_of(pattern: &Pattern) -> f64 {
    pattern.acceleration_time + pattern.cruise_time + pattern.deceleration_time
}

fn longest(patterns: &[Pattern]) -> (usize, f64) {
    patterns
        .iter()
        .map(time_of)
        .enumerate()
        .fold((0, 0.0), |most, own| if own.1 > most.1 { own } else { most })
}

fn signed(pattern: &Pattern, sign: f64) -> Pattern {
    Pattern {
        displacement: pattern.displacement * sign,
        peak_velocity: pattern.peak_velocity * sign,
        acceleration: pattern.acceleration * sign,
        deceleration: pattern.deceleration * sign,
        ..*pattern
    }
}

/// Plans a move by the end-pose method, with the fallback of steps S9 and S10 (`Resynchronized`) or of paragraph 0091
/// (`Rebased`) where one is needed.
///
/// # Errors
/// [`NoAcceleration`] where gravity, friction and velocity torques leave no room at an end pose, or nothing bounds the
/// acceleration.
pub fn plan(
    arm: &Arm,
    bounds: &[Bounds],
    preset: &Preset,
    start: &[f64],
    target: &[f64],
    preferred: Fallback,
) -> Result<EndpointMove, NoAcceleration> {
    let signs: Vec<f64> = start.iter().zip(target).map(|(s, e)| (e - s).signum()).collect();
    // S2, S3
    let own: Vec<Pattern> = (0..start.len())
        .map(|joint| {
            first_calculation(
                (target[joint] - start[joint]).abs(),
                preset.velocity[joint],
                preset.acceleration[joint],
                preset.deceleration[joint],
            )
        })
        .collect();
    let (slowest, preset_duration) = longest(&own);
    let together: Vec<Pattern> = own.iter().map(|one| drawn_out(one, preset_duration)).collect();
    // S4, S5
    let velocity: Vec<f64> = (0..start.len())
        .map(|joint| together[joint].peak_velocity * signs[joint])
        .collect();
    let acceleration: Vec<f64> = (0..start.len())
        .map(|joint| together[joint].acceleration * signs[joint])
        .collect();
    let braking: Vec<f64> = (0..start.len())
        .map(|joint| -together[joint].deceleration * signs[joint])
        .collect();
    let cap_up: Vec<Option<f64>> = bounds.iter().map(|one| one.acceleration).collect();
    let cap_down: Vec<Option<f64>> = bounds.iter().map(|one| one.deceleration).collect();
    let up = largest_factor(arm, bounds, start, &velocity, &acceleration, &cap_up)
        .ok_or(NoAcceleration { end: End::Start })?;
    let down = largest_factor(arm, bounds, target, &velocity, &braking, &cap_down)
        .ok_or(NoAcceleration { end: End::Target })?;
    // S6 to S10
    let fastest: Vec<Pattern> = together
        .iter()
        .zip(&preset.velocity)
        .map(|(one, velocity)| {
            first_calculation(
                one.displacement,
                *velocity,
                one.acceleration * up,
                one.deceleration * down,
            )
        })
        .collect();
    let (patterns, fallback) = synchronize(&fastest, &preset.velocity, slowest, preferred);
    let (_, duration) = longest(&patterns);
    Ok(EndpointMove {
        patterns: patterns
            .iter()
            .zip(&signs)
            .map(|(one, sign)| signed(one, *sign))
            .collect(),
        duration,
        preset_duration,
        fallback,
    })
}

/// Steps S6 to S10: everyone in the time of joint `base`, or of whoever is slower than that.
fn synchronize(fastest: &[Pattern], velocity: &[f64], base: usize, preferred: Fallback) -> (Vec<Pattern>, Fallback) {
    let in_time_of = |base: usize| -> Vec<Option<Pattern>> {
        let duration = time_of(&fastest[base]);
        fastest
            .iter()
            .enumerate()
            .map(|(joint, one)| match joint == base || one.displacement == 0.0 {
                true => Some(*one),
                false => second_calculation(one, duration, velocity[joint]),
            })
            .collect()
    };
    let first = in_time_of(base);
    if let Some(patterns) = first.iter().copied().collect() {
        return (patterns, Fallback::None);
    }
    if preferred == Fallback::Resynchronized {
        let mixed: Vec<Pattern> = first
            .iter()
            .zip(fastest)
            .map(|(found, own)| found.unwrap_or(*own))
            .collect();
        let (_, duration) = longest(&mixed);
        let patterns = mixed.iter().map(|one| drawn_out(one, duration)).collect();
        return (patterns, Fallback::Resynchronized);
    }
    let (slowest, duration) = longest(fastest);
    // A joint as slow as the slowest fails by a rounding: its own pattern has the time already.
    let patterns = in_time_of(slowest)
        .iter()
        .zip(fastest)
        .map(|(found, own)| found.unwrap_or_else(|| drawn_out(own, duration)))
        .collect();
    (patterns, Fallback::Rebased)
}

/// The largest factor of `acceleration` that keeps every torque limit at pose `q` and speed `qd` (eq 70 to 88, as
/// intervals that are intersected) and every cap; `None` where there is no positive one, or none that is largest.
fn largest_factor(
    arm: &Arm,
    bounds: &[Bounds],
    q: &[f64],
    qd: &[f64],
    acceleration: &[f64],
    caps: &[Option<f64>],
) -> Option<f64> {
    let mut workspace = Workspace::default();
    let still = vec![0.0; q.len()];
    let mut bias = still.clone();
    let mut full = still.clone();
    arm.drive_torque(&mut workspace, q, qd, &still, qd, &mut bias);
    arm.drive_torque(&mut workspace, q, qd, acceleration, qd, &mut full);
    let mut low = 0.0_f64;
    let mut high = f64::INFINITY;
    for joint in 0..q.len() {
        if let Some(cap) = caps[joint]
            && acceleration[joint] != 0.0
        {
            high = high.min(cap / acceleration[joint].abs());
        }
        let Some(limit) = bounds[joint].torque else {
            continue;
        };
        let gain = full[joint] - bias[joint];
        let ends = [(-limit - bias[joint]) / gain, (limit - bias[joint]) / gain];
        if gain == 0.0 {
            if bias[joint].abs() > limit {
                return None;
            }
            continue;
        }
        low = low.max(ends[0].min(ends[1]));
        high = high.min(ends[0].max(ends[1]));
    }
    // A factor that must not be too small means that the bias alone exceeds the limit.
    (low == 0.0 && high > 0.0 && high.is_finite()).then_some(high)
}

/// Preset accelerations along the joint speeds, safe in all but the tightest hundredth of `pose_count` random poses: k
/// times the speeds, k = min over joints of (limit − |gravity| − friction at full speed) / Σ |M| speeds; poses that
/// cannot be held are left out. `None` where a joint has no speed limit, or no pose can be held.
#[must_use]
pub fn derive_preset(spec: &RobotSpec, arm: &Arm, bounds: &[Bounds], pose_count: usize) -> Option<Preset> {
    let velocity: Vec<f64> = bounds.iter().map(|one| one.velocity).collect::<Option<_>>()?;
    let joint_count = velocity.len();
    let mut draw = Draw::seeded(1);
    let mut workspace = Workspace::default();
    let still = vec![0.0; joint_count];
    let mut gravity = still.clone();
    let mut torque = still.clone();
    let mut unit = still.clone();
    let mut friction = [still.clone(), still.clone()];
    let backwards: Vec<f64> = velocity.iter().map(|speed| -speed).collect();
    let mut factors = Vec::new();
    for _ in 0..pose_count {
        let q = draw::pose_within(&mut draw, spec);
        arm.rigid_torque(&mut workspace, &q, &still, &still, &mut gravity);
        arm.friction_torque(&mut workspace, &q, &velocity, &mut friction[0]);
        arm.friction_torque(&mut workspace, &q, &backwards, &mut friction[1]);
        let mut swept = vec![0.0; joint_count];
        for joint in 0..joint_count {
            unit[joint] = velocity[joint];
            arm.drive_torque(&mut workspace, &q, &still, &unit, &still, &mut torque);
            unit[joint] = 0.0;
            for (swept, (torque, gravity)) in swept.iter_mut().zip(torque.iter().zip(&gravity)) {
                *swept += (torque - gravity).abs();
            }
        }
        let factor = (0..joint_count)
            .filter_map(|joint| {
                let rub = friction[0][joint].max(-friction[1][joint]);
                let left = bounds[joint].torque? - gravity[joint].abs() - rub;
                Some(left / swept[joint])
            })
            .fold(f64::INFINITY, f64::min);
        if factor > 0.0 && factor.is_finite() {
            factors.push(factor);
        }
    }
    factors.sort_by(f64::total_cmp);
    let factor = quantile(&factors, 0.01);
    let acceleration: Vec<f64> = velocity.iter().map(|speed| factor * speed).collect();
    (factor > 0.0).then_some(Preset {
        velocity,
        deceleration: acceleration.clone(),
        acceleration,
    })
}
