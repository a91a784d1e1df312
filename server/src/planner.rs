//! The threads that compute: a pool of its own behind a bounded queue. Nothing else in the service computes for long.
//!
//! A full queue refuses at once. A calculation whose caller went away, or whose deadline passed, is skipped while it
//! waits and stopped while it runs. A panic is an internal error of that one request.

mod threads;

use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    sync::Arc,
    time::{Duration, Instant},
};

use takt_motion::budget::Budget;
use takt_proto::error::{Error, ErrorCode};
use tokio::{
    runtime::Handle,
    sync::{OwnedSemaphorePermit, Semaphore, oneshot},
};

use self::threads::{Handover, Job, Threads};
use crate::{config::PlannerConfig, error::ServiceError};

/// What a refused caller is told to wait.
const RETRY_AFTER: Duration = Duration::from_millis(100);

/// How long a calculation waited and ran.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Timing {
    pub(crate) queue: Duration,
    pub(crate) compute: Duration,
}

/// The pool.
#[derive(Debug)]
pub(crate) struct Pool {
    threads: Threads,
    thread_count: usize,
    places: Arc<Semaphore>,
    capacity: usize,
}

/// How long a calculation takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Length {
    /// About as long as it takes to wake who waits for it: the answer may be kept back for others to go with it.
    Brief,
    /// Any time.
    Any,
}

impl Pool {
    /// Starts the threads. To be called on the runtime on which callers wait.
    pub(crate) fn new(config: &PlannerConfig) -> std::io::Result<Self> {
        let capacity = config.queue_capacity();
        let runtime = Handle::try_current().map_err(std::io::Error::other)?;
        Ok(Self {
            threads: Threads::start(config.threads(), &runtime)?,
            thread_count: config.threads(),
            places: Arc::new(Semaphore::new(capacity)),
            capacity,
        })
    }

    /// How many calculations run at once.
    pub(crate) fn thread_count(&self) -> usize {
        self.thread_count
    }

    /// Runs a calculation. Dropping the returned future gives it up.
    pub(crate) async fn run<T, J>(&self, deadline: Instant, length: Length, job: J) -> Result<(T, Timing), ServiceError>
    where
        T: Send + 'static,
        J: FnOnce(&Budget<'_>) -> Result<T, ServiceError> + Send + 'static,
    {
        let Ok(place) = Arc::clone(&self.places).try_acquire_owned() else {
            let message = format!("{} calculations run or wait already", self.capacity);
            return Err(Error::overloaded("planner.queue_capacity", message, RETRY_AFTER).into());
        };
        self.run_in(place, deadline, length, job).await
    }

    /// The same for a caller who waits for a place in the queue, up to the deadline.
    pub(crate) async fn run_in_turn<T, J>(
        &self,
        deadline: Instant,
        length: Length,
        job: J,
    ) -> Result<(T, Timing), ServiceError>
    where
        T: Send + 'static,
        J: FnOnce(&Budget<'_>) -> Result<T, ServiceError> + Send + 'static,
    {
        let place = Arc::clone(&self.places).acquire_owned();
        match tokio::time::timeout_at(deadline.into(), place).await {
            Ok(Ok(place)) => self.run_in(place, deadline, length, job).await,
            Ok(Err(_)) => Err(ServiceError::internal("the planner has ended")),
            Err(_) => Err(ServiceError::deadline()),
        }
    }

    async fn run_in<T, J>(
        &self,
        place: OwnedSemaphorePermit,
        deadline: Instant,
        length: Length,
        job: J,
    ) -> Result<(T, Timing), ServiceError>
    where
        T: Send + 'static,
        J: FnOnce(&Budget<'_>) -> Result<T, ServiceError> + Send + 'static,
    {
        let (answer, result) = oneshot::channel();
        let queued = Instant::now();
        let span = tracing::Span::current();
        let run = move || -> Handover {
            let started = Instant::now();
            if answer.is_closed() || started >= deadline {
                return Box::new(move || drop(answer));
            }
            let should_stop = || answer.is_closed() || Instant::now() >= deadline;
            let result = span.in_scope(|| {
                let budget = Budget::until(&should_stop);
                catch_unwind(AssertUnwindSafe(|| job(&budget)))
            });
            let timing = Timing {
                queue: started - queued,
                compute: started.elapsed(),
            };
            drop(place);
            // Nobody may be waiting any more.
            Box::new(move || drop(answer.send((result, timing))))
        };
        self.threads.add(Job {
            is_brief: length == Length::Brief,
            run: Box::new(run),
        });
        match result.await {
            Ok((Ok(Ok(value)), timing)) => Ok((value, timing)),
            Ok((Ok(Err(error)), _)) => Err(error),
            Ok((Err(panic), _)) => Err(panicked(panic.as_ref())),
            // Skipped: its deadline had passed.
            Err(_) => Err(ServiceError::deadline()),
        }
    }
}

/// A calculation that was stopped: by its deadline, or because nobody waits for it.
pub(crate) fn stopped(deadline: Instant) -> ServiceError {
    if Instant::now() >= deadline {
        return ServiceError::deadline();
    }
    ServiceError::new(ErrorCode::Cancelled, "the caller gave up")
}

pub(crate) fn panicked(panic: &(dyn std::any::Any + Send)) -> ServiceError {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
    let cause = std::io::Error::other(format!("panic: {}", text.unwrap_or("without a message")));
    ServiceError::internal("the calculation failed: this is a fault of the service").caused_by(cause)
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc;

    use super::*;

    fn pool(threads: usize, capacity: usize) -> Arc<Pool> {
        let config = PlannerConfig {
            threads: Some(threads),
            queue_capacity: Some(capacity),
            cached_robots: None,
        };
        Arc::new(Pool::new(&config).unwrap())
    }

    fn later() -> Instant {
        Instant::now() + Duration::from_secs(60)
    }

    #[tokio::test]
    async fn a_panic_is_an_error_and_the_pool_goes_on() {
        let pool = pool(1, 4);
        let failed = pool.run::<(), _>(later(), Length::Any, |_| panic!("broken")).await;
        assert_eq!(failed.unwrap_err().wire().code, ErrorCode::Internal);
        assert_eq!(pool.run(later(), Length::Any, |_| Ok(7)).await.unwrap().0, 7);
    }

    #[tokio::test]
    async fn a_full_queue_refuses_at_once() {
        let pool = pool(1, 1);
        let (release, wait) = mpsc::channel::<()>();
        let busy = Arc::clone(&pool);
        let (started, begun) = oneshot::channel();
        let first = tokio::spawn(async move {
            let job = move |_: &Budget<'_>| {
                let _ = started.send(());
                let _ = wait.recv();
                Ok(())
            };
            busy.run(later(), Length::Any, job).await
        });
        begun.await.unwrap();
        let refused = pool.run(later(), Length::Any, |_| Ok(())).await.unwrap_err();
        assert_eq!(refused.wire().code, ErrorCode::Overloaded);
        assert!(refused.wire().retry_after.is_some());
        release.send(()).unwrap();
        assert!(first.await.unwrap().is_ok());
    }

    #[tokio::test]
    async fn who_waits_for_a_turn_gets_it() {
        let pool = pool(1, 1);
        let waiting = (0..20).map(|number| pool.run_in_turn(later(), Length::Brief, move |_| Ok(number)));
        let answers = futures::future::join_all(waiting).await;
        let numbers: Vec<i32> = answers.into_iter().map(|answer| answer.unwrap().0).collect();
        assert_eq!(numbers, (0..20).collect::<Vec<_>>());
    }

    #[tokio::test]
    async fn a_caller_who_leaves_stops_the_calculation() {
        let pool = pool(1, 4);
        let (started, begun) = oneshot::channel();
        let (ended, end) = oneshot::channel();
        let busy = Arc::clone(&pool);
        let task = tokio::spawn(async move {
            let job = move |budget: &Budget<'_>| {
                let _ = started.send(());
                while budget.check().is_ok() {
                    std::thread::yield_now();
                }
                let _ = ended.send(());
                Ok(())
            };
            busy.run(later(), Length::Any, job).await
        });
        begun.await.unwrap();
        task.abort();
        end.await.unwrap();
    }

    #[tokio::test]
    async fn work_whose_deadline_passed_is_skipped() {
        let pool = pool(1, 4);
        let result = pool.run(Instant::now(), Length::Any, |_| Ok(())).await;
        assert_eq!(result.unwrap_err().wire().code, ErrorCode::DeadlineExceeded);
    }

    /// Runs jobs one behind the other on one thread, all of which wait before the first begins. Once the answer to
    /// `first` is there, the last one may end.
    async fn behind_each_other(first: (Length, usize), last: Length) {
        let pool = pool(1, 64);
        let (open, gate) = mpsc::channel::<()>();
        let (release, wait) = mpsc::channel::<()>();
        let gate = pool.run(later(), Length::Any, move |_| Ok(gate.recv()));
        let (length, count) = first;
        let answers = (0..count).map(|number| pool.run(later(), length, move |_| Ok(number)));
        let answers = async {
            let answers = futures::future::join_all(answers).await;
            release.send(()).unwrap();
            answers
        };
        let last = pool.run(later(), last, move |_| Ok(wait.recv()));
        // Each is polled once in this order, which adds its job.
        let (_, answers, last, ()) = tokio::join!(gate, answers, last, async { open.send(()).unwrap() });
        let numbers: Vec<usize> = answers.into_iter().map(|answer| answer.unwrap().0).collect();
        assert_eq!(numbers, (0..count).collect::<Vec<_>>());
        assert!(last.unwrap().0.is_ok());
    }

    #[tokio::test]
    async fn no_answer_is_kept_back_during_a_long_job() {
        behind_each_other((Length::Brief, 1), Length::Any).await;
    }

    #[tokio::test]
    async fn answers_kept_back_go_when_there_are_enough() {
        behind_each_other((Length::Brief, threads::ANSWERS_TOGETHER), Length::Brief).await;
    }

    #[tokio::test]
    async fn the_answer_to_a_long_job_is_not_kept_back() {
        behind_each_other((Length::Any, 2), Length::Brief).await;
    }
}
