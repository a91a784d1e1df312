//! The planner's threads. They take jobs in order, sleep while there is none, and hand answers over several at a time.
//!
//! Whoever waits for an answer is woken on another thread. Where every core computes, that thread takes one of them away
//! from the next calculation, and both find the caches full of the other's work. So a thread keeps the answers to brief
//! jobs back while more jobs wait, a few of them and not for long, and then wakes all who wait for them at once.

use std::{
    collections::VecDeque,
    fmt, io, mem,
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError},
    thread,
    time::{Duration, Instant},
};

use tokio::runtime::Handle;

/// Most answers that are kept back: an eighth of a wake-up for each is little beside the job, and with more the callers
/// would wait longer for less.
pub(super) const ANSWERS_TOGETHER: usize = 8;

/// How old an answer may be before those kept back are handed over: the time that as many usual moves take. A caller sees
/// it at most once, and under load alone.
const KEPT_FOR: Duration = Duration::from_micros(500);

/// Hands an answer over to who waits for it.
pub(super) type Handover = Box<dyn FnOnce() + Send>;

/// A calculation that waits for a thread.
pub(super) struct Job {
    /// Whether answers may be kept back meanwhile, and its own afterwards.
    pub(super) is_brief: bool,
    pub(super) run: Box<dyn FnOnce() -> Handover + Send>,
}

/// The threads. They end when this is dropped, each after the job that it is at; nobody waits for them.
#[derive(Debug)]
pub(super) struct Threads(Arc<Queue>);

#[derive(Default)]
struct Queue {
    state: Mutex<State>,
    more: Condvar,
}

#[derive(Default)]
struct State {
    jobs: VecDeque<Job>,
    asleep: usize,
    is_closed: bool,
}

impl Threads {
    /// Starts threads. Who waits for answers is woken on the runtime.
    pub(super) fn start(count: usize, runtime: &Handle) -> io::Result<Self> {
        let threads = Self(Arc::default());
        for _ in 0..count {
            let (queue, runtime) = (Arc::clone(&threads.0), runtime.clone());
            let thread = thread::Builder::new().name("planner".to_owned());
            thread.spawn(move || queue.work(&runtime))?;
        }
        Ok(threads)
    }

    /// Adds a job behind those that wait.
    pub(super) fn add(&self, job: Job) {
        let mut state = self.0.lock();
        state.jobs.push_back(job);
        // To notify is a system call, also where nobody is asleep.
        let is_needed = state.asleep > 0;
        drop(state);
        if is_needed {
            self.0.more.notify_one();
        }
    }
}

impl Drop for Threads {
    fn drop(&mut self) {
        let mut state = self.0.lock();
        state.is_closed = true;
        let waiting = mem::take(&mut state.jobs);
        drop(state);
        self.0.more.notify_all();
        drop(waiting);
    }
}

impl Queue {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A thread's life.
    fn work(&self, runtime: &Handle) {
        let mut kept = Kept::default();
        loop {
            let waiting = self.lock().jobs.pop_front();
            let next = waiting.or_else(|| {
                kept.hand_over(runtime);
                self.wait()
            });
            let Some(job) = next else {
                return;
            };
            if !job.is_brief {
                kept.hand_over(runtime);
            }
            kept.add((job.run)());
            if !job.is_brief || kept.is_due() {
                kept.hand_over(runtime);
            }
        }
    }

    /// The next job when there is one, or nothing at the end.
    fn wait(&self) -> Option<Job> {
        let mut state = self.lock();
        loop {
            if state.is_closed || !state.jobs.is_empty() {
                return state.jobs.pop_front();
            }
            state.asleep += 1;
            state = self.more.wait(state).unwrap_or_else(PoisonError::into_inner);
            state.asleep -= 1;
        }
    }
}

impl fmt::Debug for Queue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Queue").finish_non_exhaustive()
    }
}

/// Answers that are ready and not handed over.
#[derive(Default)]
struct Kept {
    answers: Vec<Handover>,
    since: Option<Instant>,
}

impl Kept {
    fn add(&mut self, answer: Handover) {
        self.since.get_or_insert_with(Instant::now);
        self.answers.push(answer);
    }

    fn is_due(&self) -> bool {
        self.answers.len() >= ANSWERS_TOGETHER || self.since.is_some_and(|since| since.elapsed() >= KEPT_FOR)
    }

    fn hand_over(&mut self, runtime: &Handle) {
        self.since = None;
        if self.answers.len() > 1 {
            let answers = mem::take(&mut self.answers);
            // One task is woken from here, and that task wakes those who wait, on its own thread.
            runtime.spawn(async move { answers.into_iter().for_each(|hand_over| hand_over()) });
        } else if let Some(hand_over) = self.answers.pop() {
            hand_over();
        }
    }
}
