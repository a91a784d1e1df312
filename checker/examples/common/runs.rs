//! A long run: a range of seeds done chunk by chunk on some threads, each chunk a line of a file, so that it can be
//! interrupted and gone on with.

use std::fs::{self, OpenOptions};
use std::io::Write;
use std::ops::Range;
use std::sync::Mutex;
use std::time::Instant;

use serde::Serialize;
use serde::de::DeserializeOwned;

/// Chunks from one line of progress to the next.
const CHUNKS_A_LINE: u64 = 50;

/// What is asked of a run.
pub(crate) struct Arguments {
    seeds: Range<u64>,
    threads: usize,
    file: Option<String>,
}

/// What a run found, or a part of it.
pub(crate) trait Part: Default + Serialize + DeserializeOwned + Send {
    /// Its first seed.
    fn begin(&self) -> u64;

    /// How many seeds it has, and how many violations.
    fn progress(&self) -> (u64, usize);

    /// Adds another part.
    fn add(&mut self, part: &Self);
}

impl Arguments {
    /// Reads a range and options; `None` where they are none. Ranges begin at whole chunks.
    pub(crate) fn read(mut arguments: impl Iterator<Item = String>, chunk: u64) -> Option<Self> {
        let range = arguments.next()?;
        let (from, to) = range.split_once("..")?;
        let mut read = Self {
            seeds: from.parse().ok()?..to.parse().ok()?,
            threads: 1,
            file: None,
        };
        while let Some(name) = arguments.next() {
            let value = arguments.next()?;
            match name.as_str() {
                "--threads" => read.threads = value.parse().ok()?,
                "--file" => read.file = Some(value),
                _ => return None,
            }
        }
        // Chunks begin at the same seeds in every run, or a file could hold one twice.
        read.seeds.start.is_multiple_of(chunk).then_some(read)
    }
}

/// Does what of a range its file has not yet, and returns the sum of all that the file has.
pub(crate) fn run<P: Part>(arguments: &Arguments, chunk: u64, work: impl Fn(Range<u64>) -> P + Sync) -> P {
    let mut sum = P::default();
    let mut done: Vec<u64> = Vec::new();
    for part in arguments.file.iter().flat_map(|file| read_parts::<P>(file)) {
        done.push(part.begin());
        sum.add(&part);
    }
    let chunks = (arguments.seeds.start..arguments.seeds.end)
        .step_by(chunk as usize)
        .filter(|from| !done.contains(from));
    let chunks = Mutex::new(chunks);
    let began = Instant::now();
    let total = Mutex::new((sum, arguments.file.as_deref()));
    std::thread::scope(|scope| {
        for _ in 0..arguments.threads {
            scope.spawn(|| {
                loop {
                    let next = chunks.lock().expect("no thread fails").next();
                    let Some(from) = next else { break };
                    let part = work(from..(from + chunk).min(arguments.seeds.end));
                    let (sum, file) = &mut *total.lock().expect("no thread fails");
                    sum.add(&part);
                    if let Some(file) = file {
                        append(file, &part);
                    }
                    let (count, violations) = sum.progress();
                    if (count / chunk).is_multiple_of(CHUNKS_A_LINE) {
                        let seconds = began.elapsed().as_secs_f64();
                        println!("{count} done, {violations} violations, {seconds:.0} s");
                    }
                }
            });
        }
    });
    total.into_inner().expect("no thread failed").0
}

fn read_parts<P: Part>(file: &str) -> Vec<P> {
    let text = fs::read_to_string(file).unwrap_or_default();
    // A last line that was cut off is of a chunk that will be done again.
    text.lines()
        .filter_map(|line| serde_json::from_str(line).ok())
        .collect()
}

fn append<P: Part>(file: &str, part: &P) {
    let line = serde_json::to_string(part).expect("a tally is JSON");
    let mut file = OpenOptions::new()
        .create(true)
        .append(true)
        .open(file)
        .expect("the file can be written");
    writeln!(file, "{line}").expect("the file can be written");
}
