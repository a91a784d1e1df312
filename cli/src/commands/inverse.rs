//! `takt ik`.

use clap::Args;
use takt_client::{Client, v1};

use super::context;
use crate::{
    exit,
    failure::Failure,
    io::Io,
    numbers::{JointValues, Numbers},
    render::{
        table::{Cell, Table, Tone, number, paint},
        words::Units,
    },
};

/// Joint positions that bring the tool to a pose: every way there is, the nearest first.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  takt ik ur5e --pose 0.4,0.2,0.3 --rpy 180deg,0,0                     pointing down
  takt ik ur5e --pose 0.4,0.2,0.3,0,1,0,0                              position and quaternion x y z w
  takt ik ur5e --pose 0.4,0.1,0.3 --reference 0,-90deg,90deg,0,0,0 --degrees
  takt ik ur5e --pose … --all-turns --json

Exit code 3: the pose is out of reach, or only with a joint outside its range.")]
pub(crate) struct IkArgs {
    /// The robot.
    robot_id: String,
    /// Where the tool centre point is to be, m; its orientation as a quaternion, unless --rpy says it.
    #[arg(long, value_name = "X,Y,Z[,QX,QY,QZ,QW]", allow_hyphen_values = true)]
    pose: Numbers,
    /// Its orientation: turns about the fixed axes x, then y, then z, in rad or with a unit (90deg).
    #[arg(long, value_name = "ROLL,PITCH,YAW", allow_hyphen_values = true)]
    rpy: Option<JointValues>,
    /// A frame of the robot's description. Default: base-link axes.
    #[arg(long)]
    frame: Option<String>,
    /// Order solutions by their distance from here. Default: the middle of the ranges.
    #[arg(long, value_name = "Q1,Q2,…", allow_hyphen_values = true)]
    reference: Option<JointValues>,
    /// Also solutions that differ by whole turns.
    #[arg(long)]
    all_turns: bool,
    /// Plain numbers of joints and angles are degrees; the table shows degrees.
    #[arg(long)]
    degrees: bool,
    /// A revision other than the current one.
    #[arg(long)]
    revision: Option<String>,
    /// Print the reply as it is.
    #[arg(long)]
    json: bool,
}

pub(crate) async fn run(args: IkArgs, client: &Client, io: &mut Io) -> Result<u8, Failure> {
    let robot = context::robot(client, &args.robot_id, args.revision.as_deref()).await?;
    let request = v1::InverseKinematicsRequest {
        targets: vec![v1::PoseTarget {
            pose: Some(pose(&args)?),
            frame: args.frame.clone(),
        }],
        reference: args.reference.as_ref().map(|values| v1::JointPosition {
            position: context::si(values, args.degrees, Some(&robot)),
        }),
        all_turns: args.all_turns.then_some(true),
        robot_id: args.robot_id,
        revision: args.revision,
        tool: None,
    };
    let reply = client.inverse_kinematics(request).await?;
    let result = reply.results.first().cloned().unwrap_or_default();
    let is_reached = result.solutions.iter().any(|solution| solution.in_range);
    if args.json {
        context::print_json(&reply, io)?;
    } else {
        let units = Units { degrees: args.degrees };
        io.print(&render(&result, &robot, units, io.terminal.colour))?;
    }
    Ok(if is_reached { exit::OK } else { exit::NO })
}

fn pose(args: &IkArgs) -> Result<v1::Pose, Failure> {
    let numbers = &args.pose.0;
    let (position_m, orientation) = match (numbers.len(), &args.rpy) {
        (3, None) => (numbers.clone(), Vec::new()),
        (7, None) => (numbers[..3].to_vec(), numbers[3..].to_vec()),
        (3, Some(rpy)) => {
            let angles = context::si(rpy, args.degrees, None);
            let [roll, pitch, yaw] = <[f64; 3]>::try_from(angles)
                .map_err(|angles| Failure::usage(format!("--rpy has {} angles instead of 3", angles.len())))?;
            (numbers.clone(), quaternion(roll, pitch, yaw).to_vec())
        }
        (7, Some(_)) => return Err(Failure::usage("--pose has a quaternion already; leave it or --rpy out")),
        (count, _) => return Err(Failure::usage(format!("--pose has {count} numbers instead of 3 or 7"))),
    };
    Ok(v1::Pose {
        position_m,
        orientation,
    })
}

/// Rz(yaw)·Ry(pitch)·Rx(roll) as x y z w, as a URDF means it.
fn quaternion(roll: f64, pitch: f64, yaw: f64) -> [f64; 4] {
    let [(sr, cr), (sp, cp), (sy, cy)] = [roll, pitch, yaw].map(|angle| (angle / 2.0).sin_cos());
    [
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    ]
}

fn render(result: &v1::InverseKinematicsResult, robot: &v1::Robot, units: Units, colour: bool) -> String {
    let shown: Vec<_> = robot.joints.iter().map(|joint| units.of(robot, &joint.name)).collect();
    if let Some(far) = &result.out_of_reach {
        let list = far.nearest_position.iter().zip(&shown);
        let nearest: Vec<_> = list
            .map(|(q, unit)| format!("{:.4} {}", q * unit.factor, unit.position))
            .collect();
        return format!(
            "{} the pose is out of reach\n\nmissing     {} m, {} rad\nnearest     {}\n",
            paint("infeasible:", Tone::Bad, colour),
            number(far.missing_m, 4),
            number(far.missing_rad, 4),
            nearest.join(", ")
        );
    }
    let joints = robot.joints.iter().zip(&shown);
    let head = joints.map(|(joint, unit)| format!("{} [{}]", joint.name, unit.position));
    let mut table = Table::new(head.chain(["in range".to_owned(), "singular value".to_owned()])).numbers_from(0);
    for solution in &result.solutions {
        let values = solution.position.iter().zip(&shown);
        let cells = values.map(|(q, unit)| Cell::from(format!("{:.4}", q * unit.factor)));
        let in_range = match solution.in_range {
            true => Cell::from("yes"),
            false => Cell::new("NO", Tone::Bad),
        };
        let singular = Cell::from(number(solution.smallest_singular_value, 3));
        table.row(cells.chain([in_range, singular]).collect::<Vec<_>>());
    }
    table.render(colour)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;

    #[test]
    fn angles_are_those_of_a_urdf() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        for (angles, expected) in [
            ([PI, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]),
            ([0.0, FRAC_PI_2, 0.0], [0.0, half, 0.0, half]),
            ([0.0, 0.0, FRAC_PI_2], [0.0, 0.0, half, half]),
            // First about x, then about the fixed z: x goes to y, y to z, z to x.
            ([FRAC_PI_2, 0.0, FRAC_PI_2], [0.5, 0.5, 0.5, 0.5]),
        ] {
            let found = quaternion(angles[0], angles[1], angles[2]);
            let off = found
                .iter()
                .zip(expected)
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, f64::max);
            assert!(off < 1e-15, "{angles:?}: {found:?}");
        }
    }
}
