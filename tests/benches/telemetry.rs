//! What a stream of telemetry costs: CPU time of the server's process per second of one arm of 6 joints at 1 kHz, in blocks
//! of 100 ms with an answer each, and how many such arms one core holds. Every sample must have been taken in.
//!
//! ```text
//! cargo bench --package takt-tests --bench telemetry -- [arms] [seconds] [rounds]
//! ```
//!
//! Callers send as fast as the server takes it, so that it never waits. Linux only (`common/served.rs`).

#![allow(clippy::print_stdout, reason = "a program that prints a table")]

#[path = "common/served.rs"]
mod served;

use futures::stream;
use served::{Failure, Served};
use takt_client::{Client, Transport, v1};
use takt_tests::telemetry::{ROBOT, Reporter};

/// The allocator of the binary `takt`.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// Blocks of telemetry in a second.
const BLOCKS_A_SECOND: usize = 10;

/// Clients, each with a connection of its own: arms are spread over them.
const CLIENTS: usize = 8;

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|name| name != "--bench").collect();
    let runtime = tokio::runtime::Runtime::new()?;
    if arguments.first().is_some_and(|flag| flag == served::SERVE) {
        return runtime.block_on(served::until_told(served::takt()));
    }
    let number = |index: usize, default: usize| {
        arguments
            .get(index)
            .and_then(|text| text.parse().ok())
            .unwrap_or(default)
    };
    let (arms, seconds, rounds) = (number(0, 200), number(1, 5), number(2, 7));
    let blocks = Reporter::default().blocks(seconds * BLOCKS_A_SECOND);
    for transport in [Transport::Grpc, Transport::Http] {
        let server = Served::start("takt");
        let mut costs = Vec::new();
        for round in 0..=rounds {
            let before = server.cpu_time();
            runtime.block_on(stream_all(&server.url, transport, arms, &blocks))?;
            let cost = (server.cpu_time() - before) / (arms * seconds) as f64;
            // The first one warms up.
            if round > 0 {
                costs.push(cost);
            }
        }
        costs.sort_by(f64::total_cmp);
        let median = costs[costs.len() / 2];
        println!(
            "{transport:?}: {:6.2} ms of CPU a second of an arm ({:.2} to {:.2}): {:.0} arms a core; {arms} at once, nothing dropped",
            1e3 * median,
            1e3 * costs[0],
            1e3 * costs[costs.len() - 1],
            1.0 / median
        );
    }
    Ok(())
}

/// Streams of all arms at once, each to its end.
async fn stream_all(url: &str, transport: Transport, arms: usize, blocks: &[v1::Telemetry]) -> Result<(), Failure> {
    let clients = (0..CLIENTS)
        .map(|_| Client::builder().endpoint(url).transport(transport).build())
        .collect::<Result<Vec<_>, _>>()?;
    let streams: Vec<_> = (0..arms)
        .map(|arm| {
            let (client, blocks) = (clients[arm % CLIENTS].clone(), blocks.to_vec());
            tokio::spawn(async move { stream_one(&client, blocks).await })
        })
        .collect();
    for stream in streams {
        stream.await??;
    }
    Ok(())
}

async fn stream_one(client: &Client, blocks: Vec<v1::Telemetry>) -> Result<(), Failure> {
    let sent: usize = blocks.iter().map(|block| block.time_s.len()).sum();
    let expected = blocks.len();
    let header = v1::EstimateHeader::default();
    let mut answers = client.estimate_friction(ROBOT, header, stream::iter(blocks)).await?;
    let (mut count, mut taken) = (0, 0);
    while let Some(answer) = answers.next().await? {
        count += 1;
        taken = answer.sample_count;
    }
    // An answer a block but for the first, and the last one.
    if usize::try_from(taken)? != sent || count + 2 < expected {
        return Err(format!("{taken} of {sent} samples taken in, {count} answers to {expected} blocks").into());
    }
    Ok(())
}
