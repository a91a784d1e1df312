//! Telemetry from a file or a pipe, in blocks, while it is read.

use std::{
    fs::File,
    io::{BufRead, BufReader, Read},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    thread,
};

use futures::{Stream, stream};
use takt_client::v1;
use tokio::sync::mpsc;

use crate::{
    failure::Failure,
    io::Io,
    log::{Header, Missing},
};

/// Samples of one block: a tenth of a second at 1 kHz.
const BLOCK_SAMPLES: usize = 100;

/// Longest time of one block, so that what is read live is known soon.
const BLOCK_S: f64 = 0.1;

/// Blocks that wait to be sent.
const BLOCKS_AHEAD: usize = 4;

/// What is to be said of the file, once the blocks have ended.
#[derive(Debug, Clone, Default)]
pub(crate) struct Troubles(Arc<Mutex<Said>>);

#[derive(Debug, Default)]
struct Said {
    failure: Option<Failure>,
    remarks: Vec<String>,
}

impl Troubles {
    /// What went wrong while reading; the blocks ended there.
    pub(crate) fn take(&self) -> Option<Failure> {
        self.lock().failure.take()
    }

    /// What is odd: columns that were passed over, values that are no numbers.
    pub(crate) fn remarks(&self) -> Vec<String> {
        std::mem::take(&mut self.lock().remarks)
    }

    fn lock(&self) -> MutexGuard<'_, Said> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
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
        let mut remarks = Vec::new();
        let read = read(BufReader::new(source), &name, &joints, &sender, &mut remarks);
        let mut said = said.lock();
        (said.failure, said.remarks) = (read.err(), remarks);
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
    remarks: &mut Vec<String>,
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
    if !header.ignored.is_empty() {
        remarks.push(format!("columns passed over: {}", header.ignored.join(", ")));
    }
    let mut missing = Missing::default();
    let mut block = header.block();
    for line in lines {
        let (number, line) = line?;
        if line.trim().is_empty() {
            continue;
        }
        header.add(&line, number, &mut block)?;
        missing.count(&header, &mut block, number);
        if is_full(&block) {
            let full = std::mem::replace(&mut block, header.block());
            if sender.blocking_send(full).is_err() {
                return Ok(());
            }
        }
    }
    remarks.extend(missing.sentences(joints));
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
        read(text.as_bytes(), "log", &joints, &sender, &mut Vec::new())?;
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
