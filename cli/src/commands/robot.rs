//! `takt robot`.

use clap::{Args, Subcommand};
use takt_client::{Client, v1};

use super::context::print_json;
use crate::{exit, failure::Failure, files, io::Io, render::robot as render};

/// Registers arms, and shows what is registered.
#[derive(Debug, Subcommand)]
pub(crate) enum RobotCommand {
    Register(Box<RegisterArgs>),
    List(ListArgs),
    Show(ShowArgs),
    Delete(DeleteArgs),
}

/// Registers an arm, or a new revision of it. The same content is the same revision.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  takt robot register ur5e --urdf ur5e.urdf
  takt robot register left --urdf cell.urdf --base left_base --tip left_flange --joints drives.yaml
  takt robot register arm --description arm.json
  takt robot register arm --description arm.yaml --validate-only
  takt robot register arm --urdf arm.urdf --expected-revision ''     only if there is none yet

A file of joints lists what a URDF does not know, by joint:
  - name: elbow_joint
    limits: {velocity: 3.1, acceleration: 15}
    drive:
      peak_torque: 150
      rated_torque: 56
      gear_ratio: 101
      rotor_inertia_kg_m2: 1.1e-4
      friction: [{side: JOINT, viscous: 8.0, coulomb_positive: 6.5, load_coulomb: 0.05, quadratic: 0.4}]")]
pub(crate) struct RegisterArgs {
    /// Its name: a-z, 0-9, dot, underscore, hyphen.
    robot_id: String,
    #[command(flatten)]
    source: Source,
    /// First link of the chain. Default: the root of the tree.
    #[arg(long, value_name = "LINK", requires = "urdf")]
    base: Option<String>,
    /// Last link of the chain. Default: the only leaf of the tree.
    #[arg(long, value_name = "LINK", requires = "urdf")]
    tip: Option<String>,
    /// Limits and drives by joint: a list in YAML, TOML or JSON.
    #[arg(long, value_name = "FILE", requires = "urdf")]
    joints: Option<String>,
    /// Read friction from the URDF's <dynamics>; most files carry a simulator's values there.
    #[arg(long, requires = "urdf")]
    use_urdf_dynamics: bool,
    /// Register only if this is the current revision; '' if there must be none yet.
    #[arg(long, value_name = "REVISION")]
    expected_revision: Option<String>,
    /// Check only, store nothing.
    #[arg(long)]
    validate_only: bool,
    /// Print the reply as it is.
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Args)]
#[group(required = true, multiple = false)]
struct Source {
    /// A URDF file; - for standard input.
    #[arg(long, value_name = "FILE")]
    urdf: Option<String>,
    /// A whole description in JSON, YAML or TOML; - for standard input.
    #[arg(long, value_name = "FILE")]
    description: Option<String>,
}

/// Lists the registered arms.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  takt robot list\n  takt robot list --json | jq -r '.robots[].robot_id'")]
pub(crate) struct ListArgs {
    /// Print the reply as JSON, all pages in one.
    #[arg(long)]
    json: bool,
}

/// Shows an arm: its joints, limits and drives, and what was odd in its description.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  takt robot show ur5e
  takt robot show ur5e --revisions
  takt robot show ur5e --urdf > ur5e.urdf              the chain as a URDF, for DH models too
  takt robot show ur5e --description > ur5e.json       as it was registered; can be registered again")]
pub(crate) struct ShowArgs {
    /// The robot.
    robot_id: String,
    /// A revision other than the current one.
    #[arg(long)]
    revision: Option<String>,
    /// Print the chain as a URDF.
    #[arg(long, group = "what")]
    urdf: bool,
    /// Print the description as it was registered, as JSON.
    #[arg(long, group = "what")]
    description: bool,
    /// List its revisions, newest first.
    #[arg(long, group = "what", conflicts_with = "revision")]
    revisions: bool,
    /// Print the reply as it is.
    #[arg(long, conflicts_with_all = ["urdf", "description"])]
    json: bool,
}

/// Deletes an arm with all its revisions.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  takt robot delete ur5e\n  takt robot delete ur5e --expected-revision 3f9a…")]
pub(crate) struct DeleteArgs {
    /// The robot.
    robot_id: String,
    /// Delete only if this is the current revision.
    #[arg(long, value_name = "REVISION")]
    expected_revision: Option<String>,
}

pub(crate) async fn run(command: RobotCommand, client: &Client, io: &mut Io) -> Result<u8, Failure> {
    match command {
        RobotCommand::Register(args) => register(*args, client, io).await?,
        RobotCommand::List(args) => list(&args, client, io).await?,
        RobotCommand::Show(args) => show(args, client, io).await?,
        RobotCommand::Delete(args) => {
            let robot_id = args.robot_id.clone();
            let request = v1::DeleteRobotRequest {
                robot_id: args.robot_id,
                expected_revision: args.expected_revision,
            };
            client.delete_robot(request).await?;
            io.print(&format!("deleted {robot_id}\n"))?;
        }
    }
    Ok(exit::OK)
}

async fn register(args: RegisterArgs, client: &Client, io: &mut Io) -> Result<(), Failure> {
    let description = description(&args, io)?;
    let request = v1::RegisterRobotRequest {
        robot_id: args.robot_id,
        description: Some(description),
        expected_revision: args.expected_revision,
        validate_only: args.validate_only.then_some(true),
    };
    let reply = client.register_robot(request).await?;
    if args.json {
        return print_json(&reply, io);
    }
    let robot = reply.robot.unwrap_or_default();
    let done = if args.validate_only {
        "valid, nothing stored"
    } else {
        "registered"
    };
    let head = format!(
        "{done}: {} revision {}, {} joints\n",
        robot.robot_id,
        robot.revision,
        robot.joints.len()
    );
    io.print(&head)?;
    for warning in &robot.warnings {
        io.remark(&format!("warning: {warning}"))?;
    }
    Ok(())
}

fn description(args: &RegisterArgs, io: &mut Io) -> Result<v1::RobotDescription, Failure> {
    if let Some(file) = &args.source.description {
        let text = files::read(file, io)?;
        return files::description(file, &text);
    }
    let urdf = args.source.urdf.as_deref().unwrap_or_default();
    if urdf == "-" && args.joints.as_deref() == Some("-") {
        return Err(Failure::usage(
            "the URDF and the joints cannot both come from standard input",
        ));
    }
    let joints = match &args.joints {
        Some(file) => files::joints(file, &files::read(file, io)?)?,
        None => Vec::new(),
    };
    Ok(v1::RobotDescription {
        urdf: files::read(urdf, io)?,
        base_link: args.base.clone().unwrap_or_default(),
        tip_link: args.tip.clone().unwrap_or_default(),
        joints,
        use_urdf_dynamics: args.use_urdf_dynamics.then_some(true),
        ..Default::default()
    })
}

async fn list(args: &ListArgs, client: &Client, io: &mut Io) -> Result<(), Failure> {
    let mut robots = Vec::new();
    let mut page_token = None;
    loop {
        let page = client
            .list_robots(v1::ListRobotsRequest {
                page_size: Some(1000),
                page_token,
            })
            .await?;
        robots.extend(page.robots);
        if page.next_page_token.is_empty() {
            break;
        }
        page_token = Some(page.next_page_token);
    }
    if args.json {
        return print_json(
            &v1::ListRobotsResponse {
                robots,
                next_page_token: String::new(),
            },
            io,
        );
    }
    if robots.is_empty() {
        return io.remark("no robots yet; register one with: takt robot register ROBOT_ID --urdf FILE");
    }
    io.print(&render::list(&robots, io.terminal.colour))
}

async fn show(args: ShowArgs, client: &Client, io: &mut Io) -> Result<(), Failure> {
    if args.revisions {
        return revisions(args, client, io).await;
    }
    let request = v1::GetRobotRequest {
        robot_id: args.robot_id,
        revision: args.revision,
        as_urdf: args.urdf.then_some(true),
    };
    let reply = client.get_robot(request).await?;
    if args.urdf {
        return io.print(reply.urdf.as_deref().unwrap_or_default());
    }
    if args.description {
        return print_json(&reply.description.unwrap_or_default(), io);
    }
    if args.json {
        return print_json(&reply, io);
    }
    let description = reply.description.unwrap_or_default();
    io.print(&render::show(
        &reply.robot.unwrap_or_default(),
        &description,
        io.terminal.colour,
    ))
}

async fn revisions(args: ShowArgs, client: &Client, io: &mut Io) -> Result<(), Failure> {
    let mut revisions = Vec::new();
    let mut page_token = None;
    loop {
        let request = v1::ListRevisionsRequest {
            robot_id: args.robot_id.clone(),
            page_size: Some(1000),
            page_token,
        };
        let page = client.list_revisions(request).await?;
        revisions.extend(page.revisions);
        if page.next_page_token.is_empty() {
            break;
        }
        page_token = Some(page.next_page_token);
    }
    if args.json {
        return print_json(
            &v1::ListRevisionsResponse {
                revisions,
                next_page_token: String::new(),
            },
            io,
        );
    }
    io.print(
        &revisions
            .iter()
            .map(|revision| format!("{revision}\n"))
            .collect::<String>(),
    )
}
