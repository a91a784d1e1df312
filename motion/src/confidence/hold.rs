//! From a nominal plan to one that holds its torque limits with their bands.
//!
//! Each round tightens a joint's torque limit by the largest excess |τ| + b − T of the plan before. A slower plan has smaller
//! torques and, where inertias are what is not known, smaller bands: what turns out to be set aside needlessly is given back.
//! Where a tightened limit leaves no plan, b is wide at another place than the torque: then the whole motion is slowed down, its
//! speeds by a part λ and its accelerations by λ², to the largest λ that holds. No plan is returned that does not hold.

use super::demand::{Demand, Tightest};
use crate::budget::Stopped;
use crate::plan::Failure;
use crate::tolerance::{
    BAND_AHEAD, CONFIDENT_HALVINGS, CONFIDENT_LOOSENINGS, CONFIDENT_ROUNDS, CONFIDENT_SLACK, CONFIDENT_SLOWEST,
};

/// What a plan is asked to leave unused.
#[derive(Debug, Clone)]
pub(crate) struct Tightening {
    /// By joint: taken off every torque limit.
    pub(crate) aside: Vec<f64>,
    /// By joint: largest speed and acceleration; infinite where they are as they were.
    pub(crate) velocity: Vec<f64>,
    pub(crate) acceleration: Vec<f64>,
}

/// A planner, taken as it is.
pub(crate) trait Planner {
    type Plan;

    /// Plans within tightened limits; `None`, where there is no plan.
    fn plan(&mut self, tightening: &Tightening) -> Result<Option<Self::Plan>, Failure>;

    /// What a plan asks of the drives.
    fn demand(&mut self, plan: &Self::Plan) -> Result<Demand, Stopped>;

    fn duration(&self, plan: &Self::Plan) -> f64;
}

/// A plan that holds.
#[derive(Debug)]
pub(crate) struct Held<P> {
    pub(crate) plan: P,
    pub(crate) demand: Demand,
    /// By joint.
    pub(crate) aside: Vec<f64>,
}

/// A plan that does not hold, and where.
#[derive(Debug)]
pub(crate) struct Short<P> {
    pub(crate) plan: P,
    pub(crate) joint: usize,
    pub(crate) tightest: Tightest,
}

/// How planning until limits hold ends.
pub(crate) type Settled<P> = Result<Held<P>, Short<P>>;

/// Plans until limits hold; the slowest plan tried, where they do not.
pub(crate) fn hold<P: Planner>(
    planner: &mut P,
    nominal: P::Plan,
    limits: &[Option<f64>],
) -> Result<Settled<P::Plan>, Failure> {
    let demand = planner.demand(&nominal)?;
    let none = Tightening::none(limits.len());
    let nominal = Held {
        plan: nominal,
        demand,
        aside: none.aside.clone(),
    };
    if nominal.demand.holds() {
        return Ok(Ok(nominal));
    }
    let rates = nominal.demand.clone();
    match tighten(planner, nominal, limits, &none)? {
        Some(held) => Ok(Ok(held)),
        None => slow_down(planner, &rates, &none),
    }
}

impl Tightening {
    fn none(joint_count: usize) -> Self {
        Self {
            aside: vec![0.0; joint_count],
            velocity: vec![f64::INFINITY; joint_count],
            acceleration: vec![f64::INFINITY; joint_count],
        }
    }
}

/// Tightens torque limits, round by round; `None`, where that leaves no plan.
fn tighten<P: Planner>(
    planner: &mut P,
    nominal: Held<P::Plan>,
    limits: &[Option<f64>],
    none: &Tightening,
) -> Result<Option<Held<P::Plan>>, Failure> {
    let mut current = nominal;
    let mut best: Option<Held<P::Plan>> = None;
    let mut loosenings = 0;
    for _ in 0..CONFIDENT_ROUNDS {
        let holds = current.demand.holds();
        let aside = if holds {
            loosened(&current)
        } else {
            Some(tightened(&current))
        };
        if holds {
            let faster = best
                .as_ref()
                .is_none_or(|best| planner.duration(&current.plan) < planner.duration(&best.plan));
            if faster {
                best = Some(current);
            }
            loosenings += 1;
            if loosenings > CONFIDENT_LOOSENINGS {
                break;
            }
        }
        let Some(aside) = aside else { break };
        let leaves_some = limits
            .iter()
            .zip(&aside)
            .all(|(limit, aside)| limit.is_none_or(|limit| *aside < limit));
        if !leaves_some {
            break;
        }
        let tightening = Tightening { aside, ..none.clone() };
        let Some(next) = planned(planner, &tightening)? else {
            break;
        };
        current = next;
    }
    Ok(best)
}

/// What to set aside after a plan that does not hold.
fn tightened<P>(current: &Held<P>) -> Vec<f64> {
    let joints = current.aside.iter().zip(&current.demand.excess).enumerate();
    joints
        .map(|(joint, (aside, excess))| {
            if *excess <= 0.0 {
                return *aside;
            }
            let band = current.demand.tightest[joint].map_or(0.0, |tightest| tightest.band);
            aside + excess + BAND_AHEAD * band
        })
        .collect()
}

/// What to set aside after a plan that holds; `None`, where there is nothing to give back.
fn loosened<P>(current: &Held<P>) -> Option<Vec<f64>> {
    let spare = |aside: f64, excess: f64| aside > 0.0 && -excess > CONFIDENT_SLACK * aside;
    let joints = || current.aside.iter().zip(&current.demand.excess);
    if !joints().any(|(aside, excess)| spare(*aside, *excess)) {
        return None;
    }
    let given_back = joints().map(|(aside, excess)| {
        if spare(*aside, *excess) {
            (aside + excess).max(0.0)
        } else {
            *aside
        }
    });
    Some(given_back.collect())
}

/// Slows the motion down as a whole until limits hold, by halving the range of speeds that may. `nominal` is what the plan asks at
/// full speed.
fn slow_down<P: Planner>(planner: &mut P, nominal: &Demand, none: &Tightening) -> Result<Settled<P::Plan>, Failure> {
    let scaled = |rates: &[f64], factor: f64| -> Vec<f64> {
        let scaled = rates
            .iter()
            .map(|rate| if *rate > 0.0 { rate * factor } else { f64::INFINITY });
        scaled.collect()
    };
    let at = |pace: f64| Tightening {
        aside: none.aside.clone(),
        velocity: scaled(&nominal.peak_velocity, pace),
        acceleration: scaled(&nominal.peak_acceleration, pace * pace),
    };
    let slowest = match planned(planner, &at(CONFIDENT_SLOWEST))? {
        Some(slowest) => Some(slowest),
        None => planned(planner, none)?,
    };
    let Some(mut held) = slowest else {
        let message = "a plan was found once and then no more: this is a fault of the planner";
        return Err(Failure::invalid("confidence", message.to_owned()));
    };
    if let Some((joint, tightest)) = held.demand.shortfall() {
        let plan = held.plan;
        return Ok(Err(Short { plan, joint, tightest }));
    }
    let (mut low, mut high) = (CONFIDENT_SLOWEST, 1.0);
    for _ in 0..CONFIDENT_HALVINGS {
        let middle = libm::sqrt(low * high);
        match planned(planner, &at(middle))? {
            Some(slower) if slower.demand.holds() => (low, held) = (middle, slower),
            _ => high = middle,
        }
    }
    Ok(Ok(held))
}

fn planned<P: Planner>(planner: &mut P, tightening: &Tightening) -> Result<Option<Held<P::Plan>>, Failure> {
    let Some(plan) = planner.plan(tightening)? else {
        return Ok(None);
    };
    let demand = planner.demand(&plan)?;
    Ok(Some(Held {
        plan,
        demand,
        aside: tightening.aside.clone(),
    }))
}
