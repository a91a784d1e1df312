//! `takt drive commit`.

use clap::Args;
use serde::Deserialize;
use takt_client::{Client, Code, v1};

use crate::{
    commands::context,
    exit,
    failure::Failure,
    files,
    io::Io,
    render::{fit, friction},
};

/// Registers what an estimate or a fit proposes as a new revision of the robot.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  takt drive estimate ur5e telemetry.csv --json > estimate.json
  takt drive commit ur5e estimate.json
  takt drive fit ur5e log.csv --json | takt drive commit ur5e -
  takt drive commit ur5e estimate.json --validate-only          only whether it could be
  takt drive commit ur5e estimate.json --note 'after the gear was changed'

The new revision says where it comes from (`takt robot show ROBOT --description`, under `origin`), and plans use its
friction from then on; plans that name the old revision do not change. What every coefficient was and becomes is listed, of both
sides of the gear together, and the masses and rotors that a fit changes. The same answer a second time, with the same note, changes nothing and says so. A robot that has been changed since the estimate
began is not touched: estimate again on what is there now, or see `takt robot show ROBOT --revisions`.")]
pub(crate) struct CommitArgs {
    /// The robot.
    robot_id: String,
    /// The answer of `takt drive estimate --json` or `takt drive fit --json`; - for standard input.
    estimate: String,
    /// Words that stay with the revision.
    #[arg(long, value_name = "TEXT")]
    note: Option<String>,
    /// Check only, store nothing.
    #[arg(long)]
    validate_only: bool,
    /// Print the reply as it is.
    #[arg(long)]
    json: bool,
}

/// What an answer is read for.
#[derive(Deserialize)]
struct Answer {
    proposal: Option<v1::ModelProposal>,
    /// Of an estimate.
    #[serde(default)]
    warnings: Vec<String>,
    /// Of a fit, by its kind.
    motion: Option<Fit>,
    constant_speed: Option<Fit>,
}

/// What is read of a fit.
#[derive(Deserialize)]
struct Fit {
    #[serde(default)]
    warnings: Vec<String>,
    /// Of a fit to a motion.
    #[serde(default)]
    estimates: Vec<v1::ParameterEstimate>,
}

impl Answer {
    /// What the estimate or the fit warned of, to be said again before anything is stored.
    fn warnings(&self) -> Vec<String> {
        let fits = self.motion.iter().chain(&self.constant_speed);
        let fits = fits.flat_map(|fit| &fit.warnings);
        fits.chain(&self.warnings).cloned().collect()
    }
}

pub(super) async fn run(args: CommitArgs, client: &Client, io: &mut Io) -> Result<u8, Failure> {
    let text = files::read(&args.estimate, io)?;
    let answer: Answer = files::message(&args.estimate, last_line(&text))?;
    let warnings = answer.warnings();
    let Some(mut proposal) = answer.proposal else {
        let failure = Failure::usage(format!("{} proposes no change", args.estimate));
        return Err(failure.hint("its `missing` says what the motion would have to have, joint by joint"));
    };
    let mut description = proposal.description.take().unwrap_or_default();
    if let Some(note) = &args.note {
        let origin = description.origin.get_or_insert_default();
        origin.note = match origin.note.is_empty() {
            true => note.clone(),
            false => format!("{note}\n{}", origin.note),
        };
    }
    io.warn(warnings.iter().chain(&proposal.warnings))?;
    let request = v1::RegisterRobotRequest {
        robot_id: args.robot_id.clone(),
        description: Some(description),
        expected_revision: Some(proposal.base_revision.clone()),
        validate_only: args.validate_only.then_some(true),
    };
    let (reply, is_there) = match client.register_robot(request.clone()).await {
        Ok(reply) => (reply, false),
        Err(error) if error.code() == Code::Conflict => match is_there(client, request).await? {
            Some(reply) => (reply, true),
            None => {
                let failure = Failure::from(error);
                return Err(failure.hint("fit or estimate again, on the revision that is there now"));
            }
        },
        Err(error) => return Err(error.into()),
    };
    if args.json {
        context::print_json(&reply, io)?;
        return Ok(exit::OK);
    }
    let robot = reply.robot.unwrap_or_default();
    if is_there {
        io.print(&format!(
            "nothing to do: this is there already, {} revision {}\n",
            args.robot_id, robot.revision
        ))?;
        return Ok(exit::OK);
    }
    let done = if args.validate_only {
        "valid, nothing stored"
    } else {
        "committed"
    };
    let text = format!(
        "{done}: {} revision {} in place of {}, changed: {}\n",
        args.robot_id,
        robot.revision,
        proposal.base_revision,
        proposal.joints.join(", ")
    );
    io.print(&text)?;
    io.print(&friction::changes(&proposal.friction, &robot, io.terminal))?;
    let estimates = answer.motion.map(|fit| fit.estimates).unwrap_or_default();
    io.print(&fit::changes(&estimates, &robot, io.terminal))?;
    Ok(exit::OK)
}

/// The current revision, where it is what was to be committed: a revision is its content.
async fn is_there(
    client: &Client,
    request: v1::RegisterRobotRequest,
) -> Result<Option<v1::RegisterRobotResponse>, Failure> {
    let current = context::robot(client, &request.robot_id, None).await?;
    let wanted = v1::RegisterRobotRequest {
        expected_revision: None,
        validate_only: Some(true),
        ..request
    };
    let reply = client.register_robot(wanted).await?;
    let revision = reply.robot.as_ref().map(|robot| robot.revision.as_str());
    Ok((revision == Some(current.revision.as_str())).then_some(reply))
}

/// Of JSON lines the last one; else the text.
fn last_line(text: &str) -> &str {
    let mut lines = text.lines().filter(|line| !line.trim().is_empty());
    let last = lines.next_back().unwrap_or(text);
    match last.trim_start().starts_with('{') {
        true => last,
        false => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_lines_the_last_counts() {
        assert_eq!(last_line("{\"a\": 1}\n{\"b\": 2}\n\n"), "{\"b\": 2}");
        assert_eq!(last_line("{\n  \"a\": 1\n}\n"), "{\n  \"a\": 1\n}\n");
    }
}
