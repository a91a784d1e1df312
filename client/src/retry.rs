//! Which calls are tried again, when, and where.
//!
//! The delay before round k is random between 0 and min(longest, first · 2^k): exponential backoff with full jitter
//! (M. Brooker, "Exponential Backoff and Jitter", AWS Architecture Blog, 2015). A delay that the server asks for is a
//! lower bound of it.

use std::{
    future::Future,
    hash::{BuildHasher, RandomState},
    time::Duration,
};

use tokio::time::{Instant, sleep_until, timeout_at};

use crate::error::Error;

/// How often and how patiently a call is tried again.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RetryPolicy {
    /// Tries in all, the first one counted. Every endpoint gets one in any case. Default: 5.
    pub max_tries: u32,
    /// Upper end of the first delay. Default: 50 ms.
    pub first_backoff: Duration,
    /// Upper end of every delay. Default: 2 s.
    pub longest_backoff: Duration,
}

impl Default for RetryPolicy {
    fn default() -> Self {
        Self {
            max_tries: 5,
            first_backoff: Duration::from_millis(50),
            longest_backoff: Duration::from_secs(2),
        }
    }
}

impl RetryPolicy {
    /// Never tries again, except at the next endpoint.
    #[must_use]
    pub fn none() -> Self {
        Self {
            max_tries: 1,
            ..Self::default()
        }
    }

    /// Delay before the round of tries that follows `rounds` failed ones; `random` lies in [0, 1).
    fn backoff(&self, rounds: u32, random: f64) -> Duration {
        let factor = 2_u32.saturating_pow(rounds.saturating_sub(1).min(31));
        self.first_backoff
            .saturating_mul(factor)
            .min(self.longest_backoff)
            .mul_f64(random)
    }
}

/// What a second execution of the same request would do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Safety {
    /// Nothing that the first one did not.
    Repeatable,
    /// Something else: it may leave only once.
    Once,
}

/// Tries a request until it has an answer, may not be tried again, or the time is up.
///
/// `order` lists the endpoints to try; `attempt` sends to one of them and gets the time that is left.
pub(crate) async fn run<T, F, A>(
    policy: &RetryPolicy,
    safety: Safety,
    deadline: Duration,
    order: &[usize],
    attempt: A,
) -> Result<T, Error>
where
    F: Future<Output = Result<T, Error>>,
    A: Fn(usize, Duration) -> F,
{
    let end = Instant::now() + deadline;
    let rounds_of = u32::try_from(order.len().max(1)).unwrap_or(u32::MAX);
    let max_tries = policy.max_tries.max(rounds_of);
    let mut last: Option<Error> = None;
    let mut tries = 0;
    for &endpoint in order.iter().cycle() {
        let left = end.saturating_duration_since(Instant::now());
        tries += 1;
        let error = match timeout_at(end, attempt(endpoint, left)).await {
            Ok(Ok(answer)) => return Ok(answer),
            Ok(Err(error)) => error,
            Err(_) => return Err(Error::deadline(deadline, last.as_ref()).with_tries(tries)),
        };
        let error = error.with_tries(tries);
        let again =
            error.retryable() && (safety == Safety::Repeatable || !error.may_have_been_sent()) && tries < max_tries;
        if !again {
            return Err(error);
        }
        let resume = Instant::now() + delay(policy, &error, tries, rounds_of);
        if resume >= end {
            // Waiting would only turn this answer into a worse one.
            return Err(error);
        }
        sleep_until(resume).await;
        last = Some(error);
    }
    Err(Error::refused("endpoint", "no endpoint given"))
}

/// How long to wait after the failed try number `tries`: the next endpoint of a round is tried at once, unless the
/// server asks for time.
fn delay(policy: &RetryPolicy, error: &Error, tries: u32, rounds_of: u32) -> Duration {
    let round_is_over = tries.is_multiple_of(rounds_of);
    match error.retry_after() {
        Some(asked) => asked + policy.backoff(tries.div_ceil(rounds_of), random()),
        None if round_is_over => policy.backoff(tries / rounds_of, random()),
        None => Duration::ZERO,
    }
}

/// A number in [0, 1). The standard library seeds its hashers from the system's random source; that is enough to
/// spread clients out.
fn random() -> f64 {
    let bits = RandomState::new().hash_one(0_u8) >> 11;
    #[allow(clippy::cast_precision_loss, reason = "53 bits fit a double exactly")]
    let value = bits as f64;
    value / 2_f64.powi(53)
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU32, Ordering};

    use super::*;
    use crate::error::{Code, ErrorKind};

    const LONG: Duration = Duration::from_secs(60);

    fn unavailable() -> Error {
        Error::answered(Code::Unavailable, "starting")
    }

    /// Runs with every try failing as `error` says; returns the outcome, the endpoints asked, and the time passed.
    async fn failing(
        safety: Safety,
        deadline: Duration,
        order: &[usize],
        error: impl Fn() -> Error,
    ) -> (Error, Vec<usize>, Duration) {
        let asked = std::sync::Mutex::new(Vec::new());
        let begin = Instant::now();
        let attempt = |endpoint, _| {
            asked.lock().unwrap().push(endpoint);
            std::future::ready(Err::<(), _>(error()))
        };
        let error = run(&RetryPolicy::default(), safety, deadline, order, attempt)
            .await
            .unwrap_err();
        (error, asked.into_inner().unwrap(), begin.elapsed())
    }

    #[tokio::test(start_paused = true)]
    async fn an_unavailable_service_is_tried_until_the_tries_are_used_up() {
        let (error, asked, _) = failing(Safety::Repeatable, LONG, &[0], unavailable).await;
        assert_eq!(asked.len(), 5);
        assert_eq!(error.tries(), 5);
        assert_eq!(error.kind(), ErrorKind::Service);
    }

    #[tokio::test(start_paused = true)]
    async fn the_endpoints_of_a_round_are_tried_without_waiting() {
        let (_, asked, passed) = failing(Safety::Repeatable, LONG, &[2, 0, 1, 4, 3], unavailable).await;
        assert_eq!(asked, [2, 0, 1, 4, 3]);
        assert_eq!(passed, Duration::ZERO);
    }

    #[tokio::test(start_paused = true)]
    async fn a_request_that_may_have_left_is_not_repeated_where_that_matters() {
        let (_, asked, _) = failing(Safety::Once, LONG, &[0, 1], unavailable).await;
        assert_eq!(asked.len(), 1);
        let (_, asked, _) = failing(Safety::Once, LONG, &[0, 1], || {
            Error::transport("cannot connect", "x").unsent()
        })
        .await;
        assert_eq!(asked.len(), 5);
    }

    #[tokio::test(start_paused = true)]
    async fn a_wrong_request_is_sent_once() {
        for code in [
            Code::InvalidRequest,
            Code::NotFound,
            Code::Conflict,
            Code::Internal,
            Code::DeadlineExceeded,
        ] {
            let (_, asked, _) = failing(Safety::Repeatable, LONG, &[0, 1], || Error::answered(code, "no")).await;
            assert_eq!(asked.len(), 1, "{code:?}");
        }
    }

    #[tokio::test(start_paused = true)]
    async fn the_delay_that_the_server_asks_for_is_kept() {
        let overloaded = || Error::answered(Code::Overloaded, "full").with_retry_after(Some(Duration::from_secs(3)));
        let (_, asked, passed) = failing(Safety::Repeatable, LONG, &[0, 1], overloaded).await;
        assert_eq!(asked.len(), 5);
        assert!(passed >= Duration::from_secs(12), "{passed:?}");
    }

    #[tokio::test(start_paused = true)]
    async fn no_one_waits_for_a_try_that_the_deadline_forbids() {
        let overloaded = || Error::answered(Code::Overloaded, "full").with_retry_after(Some(Duration::from_secs(3)));
        let (error, asked, passed) = failing(Safety::Repeatable, Duration::from_secs(2), &[0], overloaded).await;
        assert_eq!(asked.len(), 1);
        assert_eq!(passed, Duration::ZERO);
        assert_eq!(error.code(), Code::Overloaded);
    }

    #[tokio::test(start_paused = true)]
    async fn the_deadline_covers_all_tries_and_each_is_told_what_is_left() {
        let tries = AtomicU32::new(0);
        let left_at_last = std::sync::Mutex::new(Duration::ZERO);
        let begin = Instant::now();
        let error = run(
            &RetryPolicy::default(),
            Safety::Repeatable,
            Duration::from_secs(10),
            &[0],
            |_, left| {
                let first = tries.fetch_add(1, Ordering::Relaxed) == 0;
                *left_at_last.lock().unwrap() = left;
                async move {
                    tokio::time::sleep(if first { Duration::from_secs(6) } else { LONG }).await;
                    Err::<(), _>(unavailable())
                }
            },
        )
        .await
        .unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Deadline);
        assert_eq!(error.tries(), 2);
        assert!(error.message().contains("starting"), "{error}");
        assert!(*left_at_last.lock().unwrap() <= Duration::from_secs(4));
        // The paused clock is exact; no machine's speed is measured here.
        assert_eq!(begin.elapsed().as_secs(), 10);
    }

    #[test]
    fn backoff_doubles_up_to_its_longest() {
        let policy = RetryPolicy::default();
        let upper: Vec<_> = (1..8).map(|round| policy.backoff(round, 1.0).as_millis()).collect();
        assert_eq!(upper, [50, 100, 200, 400, 800, 1600, 2000]);
        assert_eq!(policy.backoff(u32::MAX, 1.0), Duration::from_secs(2));
        assert_eq!(policy.backoff(3, 0.0), Duration::ZERO);
        assert!((0..1000).map(|_| random()).all(|value| (0.0..1.0).contains(&value)));
    }
}
