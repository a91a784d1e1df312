//! Telemetry from a file or a pipe, in blocks, while it is read.

use std::{
    fs::File,
    io::{BufRead, BufReader, Read},
    sync::{Arc, Mutex, PoisonError},
    thread,
};

use futures::{Stream, stream};
use takt_client::v1;
use tokio::sync::mpsc;

use crate::{failure::Failure, io::Io, log::Header};

/// Samples of one block: a tenth of a second at 1 kHz.
const BLOCK_SAMPLES: usize = 100;

/// Longest time of one block, so that what is read live is known soon.
const BLOCK_S: f64 = 0.1;

/// Blocks that wait to be sent.
const BLOCKS_AHEAD: usize = 4;

/// What went wrong while reading; the blocks end there.
#[derive(Debug, Clone, Default)]
pub(crate) struct Troubles(Arc<Mutex<Option<Failure>>>);

impl Troubles {
    /// What went wrong, once the blocks have ended.
    pub(crate) fn take(&self) -> Option<Failure> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

/// The blocks of a file, or of standard input where the name is `-`, as they are read by a thread of its own.
pub(crate) fn blocks(
    name: &str,
    joints: Vec<String>,
    io: &mut Io,
) -> Result<(impl Stream<Item = v1::Telemetry> + Send + use<>, Troubles), Failure> {
    let source: Box<dyn Read + Send> = if name == "-" {
        std::mem::replace(&mut io.input, Box::new(std::io::empty()))
    } else {
        let file = File::open(name).map_err(|error| Failure::usage(format!("cannot read {name}: {error}")))?;
        Box::new(file)
    };
    let (sender, receiver) = mpsc::channel(BLOCKS_AHEAD);
    let troubles = Troubles::default();
    let (said, name) = (troubles.clone(), name.to_owned());
    thread::spawn(move || {
        if let Err(failure) = read(BufReader::new(source), &name, &joints, &sender) {
            *said.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(failure);
        }
    });
    let blocks = stream::unfold(receiver, |mut receiver| async move {
        let block = receiver.recv().await?;
        Some((block, receiver))
    });
    Ok((blocks, troubles))
}

/// Reads until the end, or until nobody takes any more.
fn read(
    source: impl BufRead,
    name: &str,
    joints: &[String],
    sender: &mpsc::Sender<v1::Telemetry>,
) -> Result<(), Failure> {
    let mut lines = source.lines().enumerate().map(|(index, line)| {
        let line = line.map_err(|error| Failure::usage(format!("cannot read {name}: {error}")))?;
        Ok::<_, Failure>((index + 1, line))
    });
    let first = lines.find(|line| !matches!(line, Ok((_, line)) if line.trim().is_empty()));
    let Some(first) = first else {
        return Err(Failure::usage(format!("{name} is empty")));
    };
    let (number, first) = first?;
    if first.trim_start().starts_with('{') {
        for line in std::iter::once(Ok((number, first))).chain(lines) {
            let (number, line) = line?;
            if line.trim().is_empty() {
                continue;
            }
            let block = serde_json::from_str(&line)
                .map_err(|error| Failure::usage(format!("line {number} is no telemetry: {error}")))?;
            if sender.blocking_send(block).is_err() {
                return Ok(());
            }
        }
        return Ok(());
    }
    let header = Header::read(&first, joints)?;
    let mut block = header.block();
    for line in lines {
        let (number, line) = line?;
        if line.trim().is_empty() {
            continue;
        }
        header.add(&line, number, &mut block)?;
        if is_full(&block) {
            let full = std::mem::replace(&mut block, header.block());
            if sender.blocking_send(full).is_err() {
                return Ok(());
            }
        }
    }
    if !block.time_s.is_empty() {
        // Whether anybody takes it makes no difference at the end.
        let _ = sender.blocking_send(block);
    }
    Ok(())
}

fn is_full(block: &v1::Telemetry) -> bool {
    let span = match (block.time_s.first(), block.time_s.last()) {
        (Some(first), Some(last)) => last - first,
        _ => 0.0,
    };
    block.time_s.len() >= BLOCK_SAMPLES || span >= BLOCK_S
}

#[cfg(test)]
mod tests {
    use super::*;

    fn blocks_of(text: &str) -> Result<Vec<v1::Telemetry>, Failure> {
        let joints = ["a".to_owned()];
        let (sender, mut receiver) = mpsc::channel(1000);
        read(text.as_bytes(), "log", &joints, &sender)?;
        drop(sender);
        let mut blocks = Vec::new();
        while let Some(block) = receiver.blocking_recv() {
            blocks.push(block);
        }
        Ok(blocks)
    }

    #[test]
    fn blocks_are_short_and_nothing_is_lost() {
        let rows: String = (0..250)
            .map(|index| format!("{},1\n", f64::from(index) * 0.001))
            .collect();
        let blocks = blocks_of(&format!("\nt,q1\n{rows}")).unwrap();
        let sizes: Vec<usize> = blocks.iter().map(|block| block.time_s.len()).collect();
        assert_eq!(sizes, [100, 100, 50]);
        let slow = blocks_of("t,q1\n0,1\n0.06,2\n0.12,3\n0.2,4\n").unwrap();
        assert_eq!(slow.len(), 2, "a block does not wait for longer than it may");
    }

    #[test]
    fn json_lines_are_blocks_as_they_are() {
        let line = r#"{"time_s": [0, 0.001], "joints": [{"joint": "a", "position": [1, "NaN"]}]}"#;
        let blocks = blocks_of(&format!("{line}\n\n{line}\n")).unwrap();
        assert_eq!(blocks.len(), 2);
        assert!(blocks[0].joints[0].position[1].is_nan());
        let said = blocks_of(&format!("{line}\n{{\"time\": 1}}\n"))
            .unwrap_err()
            .render(false);
        assert!(said.contains("line 2"), "{said}");
    }
}
