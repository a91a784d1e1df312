//! Plans a move of the example arm `ur5e` and reads the answer: `cargo run --package takt-client --example plan_move`.
//! A server must be running: `./demo`, or `takt serve --examples`.

#![allow(clippy::print_stdout, reason = "an example shows what it found")]

use std::time::Duration;

use takt_client::{Client, Error, v1, v1::plan_move_response::Outcome};

#[tokio::main(flavor = "current_thread")]
async fn main() -> Result<(), Error> {
    let url = std::env::var("TAKT_SERVER").unwrap_or_else(|_| "http://127.0.0.1:7171".to_owned());
    let client = Client::builder()
        .endpoint(url)
        .deadline(Duration::from_secs(2))
        .build()?;

    let request = v1::PlanMoveRequest {
        robot_id: "ur5e".to_owned(),
        start: Some(v1::JointPosition {
            position: vec![0.0, -1.57, 1.57, -1.57, -1.57, 0.0],
        }),
        target: Some(v1::JointPosition {
            position: vec![2.1, -1.05, 1.05, -1.57, -1.57, 1.57],
        }),
        sample_period_s: Some(0.002),
        ..Default::default()
    };
    let reply = client.plan_move(request).await?;

    match reply.outcome {
        Some(Outcome::Plan(plan)) => {
            println!("{:.3} s", plan.duration_s);
            for margin in &plan.torque_margins {
                let (name, left) = (&margin.joint, 100.0 * margin.margin);
                println!("{name}: {left:.1} % of the torque left at {:.3} s", margin.time_s);
            }
            let count = plan.setpoints.map_or(0, |setpoints| setpoints.time_s.len());
            println!("{count} set-points of 2 ms");
        }
        Some(Outcome::Infeasible(no)) => println!("{}: {}", no.joint, no.suggestion),
        None => println!("an answer of a newer server"),
    }
    Ok(())
}
