//! The server killed in the middle of registrations: whatever it acknowledged is there when it comes back.

use std::{
    io::{BufRead, BufReader},
    path::Path,
    process::{Child, Command, Stdio},
};

use takt_client::{Client, RetryPolicy, v1};
use tokio::{sync::mpsc, task::JoinSet};

/// Times that it is killed.
const ROUNDS: u64 = 8;

/// Robots that are registered at once, each by its own caller.
const CALLERS: u32 = 4;

/// Sequence of Lehmer: which acknowledgement is the last of a round.
fn draw(seed: u64) -> u64 {
    (seed * 48_271 + 11) % 2_147_483_647 % 60
}

struct Serving {
    process: Child,
    url: String,
}

impl Serving {
    fn start(store: &Path) -> Self {
        let mut process = Command::new(env!("CARGO_BIN_EXE_takt"))
            .args(["serve", "--listen", "127.0.0.1:0", "--log", "error", "--store"])
            .arg(store)
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut line = String::new();
        let output = process.stdout.take().unwrap();
        BufReader::new(output).read_line(&mut line).unwrap();
        let url = line
            .trim()
            .strip_prefix("listening on ")
            .unwrap_or_else(|| panic!("{line:?}"));
        Self {
            url: url.to_owned(),
            process,
        }
    }

    fn client(&self) -> Client {
        let builder = Client::builder().endpoint(&self.url).retry(RetryPolicy::none());
        builder.build().unwrap()
    }

    /// SIGKILL.
    fn kill(mut self) {
        self.process.kill().unwrap();
        self.process.wait().unwrap();
    }
}

impl Drop for Serving {
    fn drop(&mut self) {
        // Killed already, mostly.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// An arm whose mass makes it another content each time.
fn description(mass_kg: f64) -> v1::RobotDescription {
    v1::RobotDescription {
        dh: Some(v1::DhTable {
            convention: v1::dh_table::Convention::Standard.into(),
            links: vec![v1::DhLink {
                name: "a".to_owned(),
                r#type: v1::JointType::Revolute.into(),
                a_m: 0.5,
                mass_kg,
                center_of_mass_m: vec![-0.2, 0.0, 0.0],
                inertia_kg_m2: vec![0.1, 0.1, 0.1, 0.0, 0.0, 0.0],
                ..Default::default()
            }],
        }),
        ..Default::default()
    }
}

/// What one caller was told.
#[derive(Debug)]
struct Acknowledged {
    robot_id: String,
    revision: String,
    description: v1::RobotDescription,
}

/// Registers one arm after another until the server is gone.
async fn register_on(client: Client, robot_id: String, round: u64, told: mpsc::UnboundedSender<Acknowledged>) {
    for count in 1.. {
        let mass = round as f64 + f64::from(count) / 1024.0;
        let description = description(mass);
        let request = v1::RegisterRobotRequest {
            robot_id: robot_id.clone(),
            description: Some(description.clone()),
            ..Default::default()
        };
        let Ok(reply) = client.register_robot(request).await else {
            return;
        };
        let acknowledged = Acknowledged {
            robot_id: robot_id.clone(),
            revision: reply.robot.unwrap().revision,
            description,
        };
        if told.send(acknowledged).is_err() {
            return;
        }
    }
}

/// Every acknowledged revision is there as it was sent; the current one is the last acknowledged or the one in flight.
async fn check(client: &Client, acknowledged: &[Acknowledged]) {
    for one in acknowledged {
        let request = v1::GetRobotRequest {
            robot_id: one.robot_id.clone(),
            revision: Some(one.revision.clone()),
            as_urdf: None,
        };
        let got = client
            .get_robot(request)
            .await
            .unwrap_or_else(|error| panic!("{error}: {one:?}"));
        assert_eq!(got.description.as_ref(), Some(&one.description));
        assert_eq!(got.robot.unwrap().revision, one.revision);
    }
    for caller in 0..CALLERS {
        let robot_id = format!("arm-{caller}");
        let Some(last) = acknowledged.iter().rev().find(|one| one.robot_id == robot_id) else {
            continue;
        };
        let request = v1::ListRevisionsRequest {
            robot_id,
            ..Default::default()
        };
        let listed = client.list_revisions(request).await.unwrap().revisions;
        let place = listed.iter().position(|revision| *revision == last.revision);
        assert!(
            place.is_some_and(|place| place <= 1),
            "{last:?} is not among the last two: {listed:?}"
        );
    }
}

#[tokio::test]
async fn acknowledged_registrations_survive_kill_9() {
    let directory = tempfile::TempDir::new().unwrap();
    let store = directory.path().join("robots.db");
    let mut acknowledged: Vec<Acknowledged> = Vec::new();
    for round in 1..=ROUNDS {
        let serving = Serving::start(&store);
        check(&serving.client(), &acknowledged).await;
        let (tell, mut told) = mpsc::unbounded_channel();
        let mut callers = JoinSet::new();
        for caller in 0..CALLERS {
            let robot_id = format!("arm-{caller}");
            callers.spawn(register_on(serving.client(), robot_id, round, tell.clone()));
        }
        drop(tell);
        for _ in 0..=draw(round) {
            acknowledged.push(told.recv().await.unwrap());
        }
        serving.kill();
        while callers.join_next().await.is_some() {}
        // Answers that were on their way.
        while let Some(one) = told.recv().await {
            acknowledged.push(one);
        }
    }
    assert!(acknowledged.len() > 50, "{}", acknowledged.len());
    check(&Serving::start(&store).client(), &acknowledged).await;
}
