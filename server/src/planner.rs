//! The threads that compute: a pool of its own behind a bounded queue. Nothing else in the service computes for long.
//!
//! A full queue refuses at once. A calculation whose caller went away, or whose deadline passed, is skipped while it
//! waits and stopped while it runs. A panic is an internal error of that one request.

use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    sync::Arc,
    time::{Duration, Instant},
};

use takt_motion::budget::Budget;
use takt_proto::error::{Error, ErrorCode};
use tokio::{
    runtime::{Builder, Runtime},
    sync::{OwnedSemaphorePermit, Semaphore, oneshot},
};

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
    /// A runtime for the sake of its blocking threads: they take work in order and sleep while there is none, where
    /// threads that steal work look around first, which cost a short plan a twentieth of its time.
    threads: Option<Runtime>,
    thread_count: usize,
    places: Arc<Semaphore>,
    capacity: usize,
}

impl Drop for Pool {
    fn drop(&mut self) {
        // What still runs may end; nobody waits for it, least of all an async thread.
        if let Some(threads) = self.threads.take() {
            threads.shutdown_background();
        }
    }
}

impl Pool {
    pub(crate) fn new(config: &PlannerConfig) -> std::io::Result<Self> {
        let capacity = config.queue_capacity();
        let threads = Builder::new_current_thread()
            .max_blocking_threads(config.threads())
            .thread_name("planner")
            .build()?;
        Ok(Self {
            threads: Some(threads),
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
    pub(crate) async fn run<T, J>(&self, deadline: Instant, job: J) -> Result<(T, Timing), ServiceError>
    where
        T: Send + 'static,
        J: FnOnce(&Budget<'_>) -> Result<T, ServiceError> + Send + 'static,
    {
        let Ok(place) = Arc::clone(&self.places).try_acquire_owned() else {
            let message = format!("{} calculations run or wait already", self.capacity);
            return Err(Error::overloaded("planner.queue_capacity", message, RETRY_AFTER).into());
        };
        self.run_in(place, deadline, job).await
    }

    /// The same for a caller who waits for a place in the queue, up to the deadline.
    pub(crate) async fn run_in_turn<T, J>(&self, deadline: Instant, job: J) -> Result<(T, Timing), ServiceError>
    where
        T: Send + 'static,
        J: FnOnce(&Budget<'_>) -> Result<T, ServiceError> + Send + 'static,
    {
        let place = Arc::clone(&self.places).acquire_owned();
        match tokio::time::timeout_at(deadline.into(), place).await {
            Ok(Ok(place)) => self.run_in(place, deadline, job).await,
            Ok(Err(_)) => Err(ServiceError::internal("the planner has ended")),
            Err(_) => Err(ServiceError::deadline()),
        }
    }

    async fn run_in<T, J>(
        &self,
        place: OwnedSemaphorePermit,
        deadline: Instant,
        job: J,
    ) -> Result<(T, Timing), ServiceError>
    where
        T: Send + 'static,
        J: FnOnce(&Budget<'_>) -> Result<T, ServiceError> + Send + 'static,
    {
        let (answer, result) = oneshot::channel();
        let queued = Instant::now();
        let span = tracing::Span::current();
        let threads = self
            .threads
            .as_ref()
            .ok_or_else(|| ServiceError::internal("the planner has ended"))?;
        threads.spawn_blocking(move || {
            let started = Instant::now();
            if answer.is_closed() || started >= deadline {
                return;
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
            let _ = answer.send((result, timing));
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
        let failed = pool.run::<(), _>(later(), |_| panic!("broken")).await;
        assert_eq!(failed.unwrap_err().wire().code, ErrorCode::Internal);
        assert_eq!(pool.run(later(), |_| Ok(7)).await.unwrap().0, 7);
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
            busy.run(later(), job).await
        });
        begun.await.unwrap();
        let refused = pool.run(later(), |_| Ok(())).await.unwrap_err();
        assert_eq!(refused.wire().code, ErrorCode::Overloaded);
        assert!(refused.wire().retry_after.is_some());
        release.send(()).unwrap();
        assert!(first.await.unwrap().is_ok());
    }

    #[tokio::test]
    async fn who_waits_for_a_turn_gets_it() {
        let pool = pool(1, 1);
        let waiting = (0..20).map(|number| pool.run_in_turn(later(), move |_| Ok(number)));
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
            busy.run(later(), job).await
        });
        begun.await.unwrap();
        task.abort();
        end.await.unwrap();
    }

    #[tokio::test]
    async fn work_whose_deadline_passed_is_skipped() {
        let pool = pool(1, 4);
        let result = pool.run(Instant::now(), |_| Ok(())).await;
        assert_eq!(result.unwrap_err().wire().code, ErrorCode::DeadlineExceeded);
    }
}
