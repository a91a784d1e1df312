//! From what is seen of a log to what is said of it.

use std::f64::consts::PI;

use super::{LogHints, Pair, Sums};
use crate::robot::spec::{JointKind, JointSpec};
use crate::tolerance::{
    LOG_CORRELATION_MIN, LOG_RANGE_EXCESS, LOG_RATIO_SLACK, LOG_SPEED_EXCESS, LOG_STEP_MAX, LOG_TORQUE_EXCESS,
    LOG_WINDOWS_MIN, LOG_WITHIN,
};

const DEGREES_IN_RADIAN: f64 = 180.0 / PI;
const MILLIMETRES_IN_METRE: f64 = 1000.0;

/// Units of time below a second, and how many are in one.
const CLOCKS: [(&str, &str, f64); 3] = [
    ("milliseconds", "t_ms", 1e3),
    ("microseconds", "t_us", 1e6),
    ("nanoseconds", "t_ns", 1e9),
];

/// What looks wrong with one joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Suspicion {
    PositionUnit,
    VelocityUnit,
    VelocitySign,
    TorqueSign,
    TorqueBeyond,
}

impl Pair {
    /// Whether one signal is the other but for a factor and noise.
    fn is_alike(&self) -> bool {
        self.count >= LOG_WINDOWS_MIN && self.correlation().abs() >= LOG_CORRELATION_MIN
    }

    fn correlation(&self) -> f64 {
        let product = libm::sqrt(self.reported) * libm::sqrt(self.expected);
        if product > 0.0 { self.both / product } else { 0.0 }
    }

    /// What was reported over what was expected, where they are alike.
    fn ratio(&self) -> Option<f64> {
        self.is_alike().then(|| self.both / self.expected)
    }
}

fn is_near(ratio: f64, factor: f64) -> bool {
    (ratio / factor - 1.0).abs() <= LOG_RATIO_SLACK
}

impl LogHints {
    /// What looks wrong, a sentence each; empty: nothing does.
    #[must_use]
    pub fn messages(&self) -> Vec<String> {
        if let Some(clock) = self.clock() {
            return vec![clock];
        }
        let joints = &self.robot.spec().joints;
        let found: Vec<(Suspicion, usize)> = self
            .joints
            .iter()
            .zip(joints)
            .enumerate()
            .filter_map(|(index, (sums, spec))| Some((suspicion(sums, spec)?, index)))
            .collect();
        let kinds = [
            Suspicion::PositionUnit,
            Suspicion::VelocityUnit,
            Suspicion::VelocitySign,
            Suspicion::TorqueSign,
            Suspicion::TorqueBeyond,
        ];
        let with = |kind| {
            found
                .iter()
                .filter(move |(one, _)| *one == kind)
                .map(|(_, joint)| *joint)
        };
        kinds
            .into_iter()
            .filter_map(|kind| {
                let joints: Vec<usize> = with(kind).collect();
                Some(self.sentence(kind, *joints.first()?, &joints))
            })
            .collect()
    }

    /// Times that are no seconds: by the speeds beside the positions of most joints, or by samples that are too far apart.
    fn clock(&self) -> Option<String> {
        let ratios: Vec<f64> = self.joints.iter().filter_map(|sums| sums.speed.ratio()).collect();
        for (unit, column, factor) in CLOCKS {
            let agree = ratios.iter().filter(|ratio| is_near(**ratio, factor)).count();
            // where two joints or more moved, one alone in other units is no clock
            if agree > 0 && 2 * agree > ratios.len() && (agree > 1 || self.joints.len() == 1 || ratios.len() == 1) {
                return Some(format!(
                    "speeds times time are {factor:e} times what positions change by: are times {unit}? They are taken as seconds; \
 `takt drive` reads a column called {column} in them"
                ));
            }
        }
        let (count, seconds) = self.steps;
        let step = seconds / f64::from(count.max(1));
        let is_slow = count >= LOG_WINDOWS_MIN && step >= LOG_STEP_MAX;
        is_slow.then(|| {
            format!("samples are {step:.3} s apart in the mean: are times milliseconds? They are taken as seconds; `takt drive` \
 reads a column called t_ms in them")
        })
    }

    fn sentence(&self, kind: Suspicion, first: usize, joints: &[usize]) -> String {
        let spec = self.robot.spec();
        let names: Vec<String> = joints
            .iter()
            .map(|joint| format!("\"{}\"", spec.joints[*joint].name))
            .collect();
        let who = match names.len() {
            1 => format!("joint {}", names[0]),
            _ => format!("joints {}", names.join(", ")),
        };
        let (sums, spec) = (&self.joints[first], &spec.joints[first]);
        let units = units(spec);
        let position = self.columns.position;
        match kind {
            Suspicion::PositionUnit => match sums.speed.ratio() {
                Some(ratio) if is_near(ratio, 1.0 / units.factor) => format!(
                    "{who}: `{position}` changes by {:.1} times what `velocity` says: is it in {}? It is taken as {}",
                    1.0 / ratio,
                    units.wrong,
                    units.right
                ),
                _ => format!(
                    "{who}: `{position}` of \"{}\" goes from {:.4} to {:.4}, its range is {} to {} {right}, and in {wrong} it would be \
                     within: is it in {wrong}? It is taken as {right}",
                    spec.name,
                    sums.lowest,
                    sums.highest,
                    bound(spec.limits.position_lower),
                    bound(spec.limits.position_upper),
                    right = units.right,
                    wrong = units.wrong,
                ),
            },
            Suspicion::VelocityUnit => format!(
                "{who}: `velocity` of \"{}\" reaches {:.4}{}: is it in {}/s? It is taken as {}/s",
                spec.name,
                sums.fastest,
                match sums.speed.ratio() {
                    Some(ratio) => format!(" and is {ratio:.1} times what `{position}` changes by"),
                    None => format!(", its limit is {} {}/s", bound(spec.limits.velocity), units.right),
                },
                units.wrong,
                units.right
            ),
            Suspicion::VelocitySign => format!(
                "{who}: `velocity` runs against `{position}` (correlation {:.2}): is the sign of one of them turned round?",
                sums.speed.correlation()
            ),
            Suspicion::TorqueSign => format!(
                "{who}: `{}` runs against the model's torque (correlation {:.2}): is its sign turned round? Positive drives the joint in \
                 its positive direction, and holds it up where gravity pulls it back",
                self.columns.torque,
                sums.torque.correlation()
            ),
            Suspicion::TorqueBeyond => format!(
                "{who}: the `{}` of \"{}\" is {:.4e} at the joint at {:.3} s, its peak torque {} (samples beyond {LOG_TORQUE_EXCESS} times that: {}): \
                 is it in another unit, or broken? It is taken as it is",
                self.columns.torque,
                spec.name,
                sums.strongest.torque,
                sums.strongest.time,
                bound(spec.drive.peak_torque),
                sums.strongest.beyond,
            ),
        }
    }
}

fn bound(value: Option<f64>) -> String {
    value.map_or_else(|| "unlimited".to_owned(), |value| format!("{value:.4}"))
}

/// What a joint is measured in, what it is taken for in its place, and how much of that is in one.
struct Units {
    right: &'static str,
    wrong: &'static str,
    factor: f64,
}

fn units(spec: &JointSpec) -> Units {
    match spec.kind {
        JointKind::Prismatic => Units {
            right: "m",
            wrong: "mm",
            factor: MILLIMETRES_IN_METRE,
        },
        JointKind::Revolute | JointKind::Continuous => Units {
            right: "rad",
            wrong: "degrees",
            factor: DEGREES_IN_RADIAN,
        },
    }
}

/// The first that looks wrong: what is wrong with positions makes speeds and torques wrong too.
fn suspicion(sums: &Sums, spec: &JointSpec) -> Option<Suspicion> {
    let units = units(spec);
    let ratio = sums.speed.ratio();
    if is_beyond(sums, spec, units.factor) || ratio.is_some_and(|ratio| is_near(ratio, 1.0 / units.factor)) {
        return Some(Suspicion::PositionUnit);
    }
    let too_fast = spec.limits.velocity.is_some_and(|limit| {
        sums.fastest > LOG_SPEED_EXCESS * limit && sums.fastest <= (1.0 + LOG_WITHIN) * limit * units.factor
    });
    // where positions change as speeds say, both are what they are
    let too_fast = too_fast && !ratio.is_some_and(|ratio| is_near(ratio, 1.0));
    if too_fast || ratio.is_some_and(|ratio| is_near(ratio, units.factor)) {
        return Some(Suspicion::VelocityUnit);
    }
    if ratio.is_some_and(|ratio| is_near(ratio, -1.0)) {
        return Some(Suspicion::VelocitySign);
    }
    if sums.strongest.beyond > 0 {
        return Some(Suspicion::TorqueBeyond);
    }
    let against = sums.torque.is_alike() && sums.torque.correlation() < 0.0;
    against.then_some(Suspicion::TorqueSign)
}

/// Whether positions are far out of their range and, over a factor, within.
fn is_beyond(sums: &Sums, spec: &JointSpec, factor: f64) -> bool {
    let (Some(lower), Some(upper)) = (spec.limits.position_lower, spec.limits.position_upper) else {
        return false;
    };
    let range = upper - lower;
    let excess = (lower - sums.lowest).max(sums.highest - upper);
    let slack = LOG_WITHIN * range;
    excess > LOG_RANGE_EXCESS * range && sums.lowest / factor >= lower - slack && sums.highest / factor <= upper + slack
}
