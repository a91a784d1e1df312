//! From a nominal plan to one that holds its torque limits with their bands.
//!
//! Each round sets aside of a joint's torque limit the band b that the plan before had where |τ| + b exceeds T most. A slower plan has smaller
//! torques and, where inertias are what is not known, smaller bands: what turns out to be set aside needlessly is given back, and
//! between what holds and what does not the middle is tried.
//! Where a tightened limit leaves no plan, b is wide at another place than the torque: then the whole motion is slowed down, its
//! speeds by a part λ and its accelerations by λ², to the largest λ that holds: the motion as it was, and the last one with tightened limits,
//! and the faster of both is kept. No plan is returned that does not hold.

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
    let start = Pace::of(&nominal);
    let rounds = tighten(planner, nominal, limits, &none)?;
    if let Some(held) = rounds.held {
        return Ok(Ok(held));
    }
    let as_it_was = slow_down(planner, &start, &none)?;
    let Some(last) = rounds.short.filter(|last| last.aside != start.aside) else {
        return Ok(as_it_was);
    };
    let tightened = slow_down(planner, &Pace::of(&last), &none)?;
    Ok(match (as_it_was, tightened) {
        (Ok(a), Ok(b)) if planner.duration(&b.plan) < planner.duration(&a.plan) => Ok(b),
        (Err(_), Ok(b)) => Ok(b),
        (as_it_was, _) => as_it_was,
    })
}

/// What a motion is slowed down from: its rates at full speed, and what it left unused.
struct Pace {
    velocity: Vec<f64>,
    acceleration: Vec<f64>,
    aside: Vec<f64>,
}

impl Pace {
    fn of<P>(held: &Held<P>) -> Self {
        Self {
            velocity: held.demand.peak_velocity.clone(),
            acceleration: held.demand.peak_acceleration.clone(),
            aside: held.aside.clone(),
        }
    }

    fn slowed(&self, pace: f64) -> Tightening {
        let scaled = |rates: &[f64], factor: f64| -> Vec<f64> {
            let scaled = rates
                .iter()
                .map(|rate| if *rate > 0.0 { rate * factor } else { f64::INFINITY });
            scaled.collect()
        };
        Tightening {
            aside: self.aside.clone(),
            velocity: scaled(&self.velocity, pace),
            acceleration: scaled(&self.acceleration, pace * pace),
        }
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

/// How tightening went.
struct Rounds<P> {
    /// The fastest plan that holds.
    held: Option<Held<P>>,
    /// The last one that does not.
    short: Option<Held<P>>,
}

/// Tightens torque limits, round by round.
fn tighten<P: Planner>(
    planner: &mut P,
    nominal: Held<P::Plan>,
    limits: &[Option<f64>],
    none: &Tightening,
) -> Result<Rounds<P::Plan>, Failure> {
    let mut rounds = Rounds {
        held: None,
        short: None,
    };
    let mut next = Some(nominal);
    let mut loosenings = 0;
    for _ in 0..CONFIDENT_ROUNDS {
        let Some(current) = next else { break };
        let holds = current.demand.holds();
        loosenings += usize::from(holds);
        let aside = match &rounds.held {
            _ if holds => loosened(&current).filter(|_| loosenings <= CONFIDENT_LOOSENINGS),
            Some(held) => between(held, &current),
            None => Some(tightened(&current)),
        };
        let leaves_some = |aside: &Vec<f64>| {
            let mut joints = limits.iter().zip(aside);
            joints.all(|(limit, aside)| limit.is_none_or(|limit| *aside < limit))
        };
        next = match aside.filter(leaves_some) {
            Some(aside) => planned(planner, &Tightening { aside, ..none.clone() })?,
            None => None,
        };
        if !holds {
            rounds.short = Some(current);
            continue;
        }
        let duration = planner.duration(&current.plan);
        if rounds
            .held
            .as_ref()
            .is_none_or(|held| duration < planner.duration(&held.plan))
        {
            rounds.held = Some(current);
        }
    }
    Ok(rounds)
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
            // the excess alone would not do where the torque there is not at its limit
            band.max(aside + excess) + BAND_AHEAD * band
        })
        .collect()
}

/// What to set aside after one plan that holds and one that set aside too little; `None`, where they are next to each other.
fn between<P>(held: &Held<P>, short: &Held<P>) -> Option<Vec<f64>> {
    let joints = || held.aside.iter().zip(&short.aside);
    let is_apart = |(held, short): (&f64, &f64)| (held - short).abs() > CONFIDENT_SLACK * held.max(*short);
    joints()
        .any(is_apart)
        .then(|| joints().map(|(held, short)| 0.5 * (held + short)).collect())
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

/// Slows a motion down as a whole until limits hold, by halving the range of speeds that may.
fn slow_down<P: Planner>(planner: &mut P, from: &Pace, none: &Tightening) -> Result<Settled<P::Plan>, Failure> {
    let slowest = match planned(planner, &from.slowed(CONFIDENT_SLOWEST))? {
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
        match planned(planner, &from.slowed(middle))? {
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
