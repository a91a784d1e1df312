//! `takt plan batch`.

use std::{
    collections::BTreeMap,
    fs::File,
    io::{BufRead, BufReader},
    sync::{Arc, Mutex, PoisonError},
};

use clap::Args;
use futures::stream;
use takt_client::{
    Client,
    v1::{self, plan_batch_response::Answer, plan_move_response, plan_path_response},
};

use crate::{exit, failure::Failure, files, io::Io};

/// Answers between two lines about the progress.
const PROGRESS: u64 = 1000;

/// Plans many moves and programs over one call: JSON lines in, JSON lines out.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  takt plan batch ur5e moves.jsonl > plans.jsonl
  takt plan batch ur5e moves.jsonl --ordered | jq .move.plan.duration_s
  generate-moves | takt plan batch ur5e -

A line is a request with a name of its own:
  {\"id\": \"a\", \"move\": {\"start\": {\"position\": […]}, \"target\": {\"position\": […]}}}
  {\"id\": \"b\", \"path\": {\"start\": {\"position\": […]}, \"segments\": […]}}
A line without `id` is called by its number. Answers come as they are ready; what is wrong with a line is its answer,
and the others go on.

Exit code 2: a line was wrong. Exit code 3: none was wrong, but a motion is infeasible.")]
pub(crate) struct BatchArgs {
    /// The robot.
    robot_id: String,
    /// Requests, one a line; - for standard input.
    requests: String,
    /// Answer in the order of the requests.
    #[arg(long)]
    ordered: bool,
}

/// What became of the requests.
#[derive(Debug, Default)]
struct Tally {
    plans: u64,
    infeasible: u64,
    wrong: u64,
    failed: u64,
}

/// What is wrong with lines that could not be read, by the place of their request.
type Unreadable = Arc<Mutex<BTreeMap<u32, String>>>;

type Lines = Box<dyn Iterator<Item = std::io::Result<String>> + Send>;

pub(super) async fn run(args: BatchArgs, client: &Client, io: &mut Io) -> Result<u8, Failure> {
    let lines: Lines = if args.requests == "-" {
        let text = files::read("-", io)?;
        Box::new(
            text.lines()
                .map(|line| Ok(line.to_owned()))
                .collect::<Vec<_>>()
                .into_iter(),
        )
    } else {
        let name = &args.requests;
        let file = File::open(name).map_err(|error| Failure::usage(format!("cannot read {name}: {error}")))?;
        Box::new(BufReader::new(file).lines())
    };
    let unreadable = Unreadable::default();
    let requests = requests(lines, args.ordered, Arc::clone(&unreadable));
    let mut answers = client.plan_batch(&args.robot_id, stream::iter(requests)).await?;
    let mut tally = Tally::default();
    while let Some(mut answer) = answers.next().await? {
        say_what_was_unreadable(&mut answer, &unreadable);
        tally.count(&answer);
        let text = serde_json::to_string(&answer)
            .map_err(|error| Failure::service(format!("the answer cannot be written as JSON: {error}")))?;
        io.print(&(text + "\n"))?;
        if tally.total().is_multiple_of(PROGRESS) {
            io.remark(&format!("{} answered", tally.total()))?;
        }
    }
    io.remark(&tally.summary())?;
    Ok(tally.code())
}

/// The requests of the lines. A line that cannot be read is noted, and sent as a request for nothing: its answer then
/// has its place.
fn requests(lines: Lines, ordered: bool, unreadable: Unreadable) -> impl Iterator<Item = v1::PlanBatchRequest> + Send {
    let lines = (1_u64..)
        .zip(lines)
        .filter(|(_, line)| !matches!(line, Ok(line) if line.trim().is_empty()));
    (0_u32..).zip(lines).map(move |(place, (number, line))| {
        let read = line.map_err(|error| error.to_string()).and_then(|line| {
            serde_json::from_str::<v1::PlanBatchRequest>(line.trim()).map_err(|error| error.to_string())
        });
        let mut request = read.unwrap_or_else(|why| {
            let mut list = unreadable.lock().unwrap_or_else(PoisonError::into_inner);
            list.insert(place, format!("line {number} cannot be read: {why}"));
            v1::PlanBatchRequest::default()
        });
        if request.id.is_empty() {
            request.id = number.to_string();
        }
        request.ordered = Some(ordered);
        request
    })
}

/// The answer to a request for nothing says what was wrong with its line.
fn say_what_was_unreadable(answer: &mut v1::PlanBatchResponse, unreadable: &Unreadable) {
    let mut list = unreadable.lock().unwrap_or_else(PoisonError::into_inner);
    if let (Some(why), Some(Answer::Error(error))) = (list.remove(&answer.index), &mut answer.answer) {
        error.message = why;
        error.violations.clear();
    }
}

impl Tally {
    fn count(&mut self, answer: &v1::PlanBatchResponse) {
        /// Codes of gRPC that say that the service could not, and nothing of the request.
        const OF_THE_SERVICE: [i32; 5] = [1, 4, 8, 13, 14];
        let is_plan = match &answer.answer {
            Some(Answer::Move(reply)) => matches!(reply.outcome, Some(plan_move_response::Outcome::Plan(_))),
            Some(Answer::Path(reply)) => matches!(reply.outcome, Some(plan_path_response::Outcome::Plan(_))),
            Some(Answer::Error(error)) if OF_THE_SERVICE.contains(&error.code) => {
                self.failed += 1;
                return;
            }
            Some(Answer::Error(_)) | None => {
                self.wrong += 1;
                return;
            }
        };
        match is_plan {
            true => self.plans += 1,
            false => self.infeasible += 1,
        }
    }

    fn total(&self) -> u64 {
        self.plans + self.infeasible + self.wrong + self.failed
    }

    fn summary(&self) -> String {
        let mut text = format!("{} requests: {} plans", self.total(), self.plans);
        for (count, what) in [
            (self.infeasible, "infeasible"),
            (self.wrong, "wrong"),
            (self.failed, "failed"),
        ] {
            if count > 0 {
                text.push_str(&format!(", {count} {what}"));
            }
        }
        text
    }

    fn code(&self) -> u8 {
        match self {
            Self { failed: 1.., .. } => exit::SERVICE,
            Self { wrong: 1.., .. } => exit::USAGE,
            Self { infeasible: 1.., .. } => exit::NO,
            _ => exit::OK,
        }
    }
}
