//! Moves and trajectories at a confidence.

use super::course::{Course, JointState, Polynomials};
use super::demand::{Bands, Demand};
use super::hold::{Planner, Short, Tightening, hold};
use super::tightened::overrides;
use super::{Confidence, ConfidenceReport, Confident, suggestion};
use crate::budget::{Budget, Stopped};
use crate::dynamics::{self, Workspace};
use crate::plan::outcome::{CheckReport, Infeasible, InfeasibleReason, MoveOutcome, MovePlan};
use crate::plan::problem::{JointLimit, limits_in_force};
use crate::plan::request::{CheckRequest, MoveRequest};
use crate::plan::{self, Failure, read_trajectory};
use crate::robot::Robot;
use crate::tolerance::{BAND_PARTS_MIN, BAND_PATTERN_PARTS_MIN};
use crate::trajectory::Trajectory;

/// Plans a move whose torque limits hold at a confidence.
///
/// # Errors
/// A request or a confidence that is wrong, or a budget that ended.
pub fn plan_move(
    robot: &Robot,
    request: &MoveRequest,
    confidence: Confidence,
    budget: &Budget<'_>,
) -> Result<Confident<MoveOutcome>, Failure> {
    confidence.check(robot)?;
    let nominal = match plan::plan_move(robot, request, budget)? {
        MoveOutcome::Plan(plan) => *plan,
        infeasible @ MoveOutcome::Infeasible(_) => {
            return Ok(Confident {
                outcome: infeasible,
                report: None,
                band: None,
            });
        }
    };
    let loaded = robot.with_payload(&nominal.payload);
    let limits = limits_in_force(robot, &request.limits, request.torque_utilization, &mut Vec::new());
    let Some(bands) = Bands::new(&loaded, confidence) else {
        return Err(Failure::invalid(
            "confidence",
            "the model has no uncertainty".to_owned(),
        ));
    };
    let nominal_duration = nominal.duration;
    let torques: Vec<Option<f64>> = limits.iter().map(|limit| limit.torque).collect();
    let mut moves = Moves {
        robot,
        request,
        limits: &limits,
        bands,
        budget,
    };
    let held = match hold(&mut moves, nominal, &torques)? {
        Ok(held) => held,
        Err(short) => return Ok(moves.refusal(&short, confidence)),
    };
    let residuals = moves.bands.residuals();
    let report = ConfidenceReport::new(confidence, &held.demand, &held.aside, Some(nominal_duration), residuals);
    let mut plan = held.plan;
    // against the whole limits again
    for margin in &mut plan.torque_margins {
        if let Some(limit) = limits[margin.joint].torque {
            margin.limit = limit;
            margin.margin = (limit - margin.peak_torque.abs()) / limit;
        }
    }
    Ok(Confident {
        outcome: MoveOutcome::Plan(Box::new(plan)),
        report: Some(report),
        band: None,
    })
}

/// Finds the margins of a trajectory with their bands. It holds where every limit does, torques at the confidence.
///
/// # Errors
/// A request or a confidence that is wrong, or a budget that ended.
pub fn check_trajectory(
    robot: &Robot,
    request: &CheckRequest,
    confidence: Confidence,
    budget: &Budget<'_>,
) -> Result<Confident<CheckReport>, Failure> {
    confidence.check(robot)?;
    let mut outcome = plan::check_trajectory(robot, request, budget)?;
    let motion = read_trajectory(robot, &request.points, request.interpolation)?;
    let limits = limits_in_force(robot, &request.limits, request.torque_utilization, &mut Vec::new());
    let loaded = request
        .payload
        .as_ref()
        .map_or_else(|| robot.clone(), |payload| robot.with_payload(payload));
    let Some(mut bands) = Bands::new(&loaded, confidence) else {
        return Err(Failure::invalid(
            "confidence",
            "the model has no uncertainty".to_owned(),
        ));
    };
    let mut course = Polynomials {
        motion: &motion,
        limits: &limits,
        parts_min: BAND_PARTS_MIN,
    };
    let demand = bands.demand(&mut course, budget)?;
    let aside = vec![0.0; limits.len()];
    let report = ConfidenceReport::new(confidence, &demand, &aside, None, bands.residuals());
    outcome.holds &= report.holds;
    Ok(Confident {
        outcome,
        report: Some(report),
        band: None,
    })
}

struct Moves<'a> {
    robot: &'a Robot,
    request: &'a MoveRequest,
    limits: &'a [JointLimit],
    bands: Bands<'a>,
    budget: &'a Budget<'a>,
}

impl Planner for Moves<'_> {
    type Plan = MovePlan;

    fn plan(&mut self, tightening: &Tightening) -> Result<Option<MovePlan>, Failure> {
        let request = MoveRequest {
            limits: overrides(&self.request.limits, &self.robot.spec().joints, self.limits, tightening),
            target_velocity: self.request.target_velocity.as_ref().map(|speeds| {
                let speeds = speeds.iter().zip(&tightening.velocity);
                speeds.map(|(asked, most)| asked.min(*most)).collect()
            }),
            ..self.request.clone()
        };
        match plan::plan_move(self.robot, &request, self.budget)? {
            MoveOutcome::Plan(plan) => Ok(Some(*plan)),
            MoveOutcome::Infeasible(_) => Ok(None),
        }
    }

    fn demand(&mut self, plan: &MovePlan) -> Result<Demand, Stopped> {
        let motion = motion(self.request, plan);
        let mut course = Polynomials {
            motion: &motion,
            limits: self.limits,
            parts_min: BAND_PATTERN_PARTS_MIN,
        };
        self.bands.demand(&mut course, self.budget)
    }

    fn duration(&self, plan: &MovePlan) -> f64 {
        plan.duration
    }
}

/// A plan as polynomials; one that goes nowhere holds where it is.
fn motion(request: &MoveRequest, plan: &MovePlan) -> Trajectory {
    if plan.duration > 0.0 {
        return Trajectory::of_patterns(&request.start, &plan.patterns);
    }
    let held = request.start.iter().map(|start| [*start, 0.0, 0.0, 0.0, 0.0, 0.0]);
    Trajectory::new(request.start.len(), vec![0.0, 0.0], held.collect())
}

impl Moves<'_> {
    /// The evidence where a move holds at no speed.
    fn refusal(&self, short: &Short<MovePlan>, confidence: Confidence) -> Confident<MoveOutcome> {
        let Short { plan, joint, tightest } = short;
        let motion = motion(self.request, plan);
        let course = &mut Polynomials {
            motion: &motion,
            limits: self.limits,
            parts_min: BAND_PATTERN_PARTS_MIN,
        };
        let mut state = JointState::new(self.limits.len());
        course.set(tightest.stretch, tightest.time, &mut state);
        let robot = self.robot.with_payload(&plan.payload);
        let mut gravity = vec![0.0; state.position.len()];
        dynamics::gravity_torque(&robot, &mut Workspace::new(&robot), &state.position, &mut gravity);
        let rests = state.velocity.iter().all(|velocity| *velocity == 0.0);
        let infeasible = Infeasible {
            reason: if rests {
                InfeasibleReason::HoldingTorque
            } else {
                InfeasibleReason::MovingTorque
            },
            joint: *joint,
            time: tightest.time,
            location: part_of_way(self.request, &state.position),
            needed: tightest.torque + tightest.band.copysign(tightest.torque),
            available: tightest.limit,
            gravity_torque: gravity[*joint],
            suggestion: suggestion(confidence, &self.robot.spec().joints[*joint].name, tightest),
            feasible_payload: None,
        };
        Confident {
            outcome: MoveOutcome::Infeasible(infeasible),
            report: None,
            band: Some(tightest.band),
        }
    }
}

/// How much of the way a configuration lies behind, by the joint that goes farthest.
fn part_of_way(request: &MoveRequest, position: &[f64]) -> f64 {
    let ways = request.target.iter().zip(&request.start).zip(position);
    let (way, gone) = ways.fold((0.0_f64, 0.0), |(way, gone), ((target, start), position)| {
        let own = target - start;
        if own.abs() > way.abs() {
            (own, position - start)
        } else {
            (way, gone)
        }
    });
    if way == 0.0 { 0.0 } else { (gone / way).clamp(0.0, 1.0) }
}
