//! Answers in pieces: made by a task of their own, no faster than the caller takes them.
//!
//! The task holds what the pieces are made from, and at most one piece is ready that nobody has taken. It ends when the
//! caller has gone, or takes nothing for `limits.stream_idle_s`.

use std::{
    pin::{Pin, pin},
    task::{Context, Poll, ready},
    time::Duration,
};

use futures::{Stream, StreamExt};
use takt_proto::error::ErrorCode;
use tokio::{
    sync::{mpsc, oneshot},
    time::timeout,
};
use tracing::Instrument;

use crate::error::ServiceError;

/// The pieces, as the caller takes them. An error is the last one.
#[derive(Debug)]
pub(crate) struct Feed<T> {
    pieces: mpsc::Receiver<T>,
    end: Option<oneshot::Receiver<Result<(), ServiceError>>>,
}

impl<T: Send + 'static> Feed<T> {
    /// Feeds these pieces to a caller; `hold` is let go at the end.
    pub(crate) fn of(
        pieces: impl Stream<Item = Result<T, ServiceError>> + Send + 'static,
        idle: Duration,
        hold: impl Send + 'static,
    ) -> Self {
        let (sender, receiver) = mpsc::channel(1);
        let (ended, end) = oneshot::channel();
        let feeding = async move {
            let outcome = tokio::select! {
                biased;
                () = sender.closed() => Ok(()),
                outcome = feed(pieces, &sender, idle) => outcome,
            };
            // Said before the channel closes, so that whoever sees that it is closed knows why.
            let _ = ended.send(outcome);
            drop((sender, hold));
        };
        tokio::spawn(feeding.in_current_span());
        Self {
            pieces: receiver,
            end: Some(end),
        }
    }
}

async fn feed<T>(
    pieces: impl Stream<Item = Result<T, ServiceError>>,
    sender: &mpsc::Sender<T>,
    idle: Duration,
) -> Result<(), ServiceError> {
    let mut pieces = pin!(pieces);
    while let Some(piece) = pieces.next().await {
        match timeout(idle, sender.send(piece?)).await {
            Ok(Ok(())) => {}
            Ok(Err(_)) => return Ok(()),
            Err(_) => {
                let message = format!(
                    "the caller took nothing for the {} s of `limits.stream_idle_s`",
                    idle.as_secs_f64()
                );
                return Err(ServiceError::new(ErrorCode::DeadlineExceeded, message));
            }
        }
    }
    Ok(())
}

impl<T> Stream for Feed<T> {
    type Item = Result<T, ServiceError>;

    fn poll_next(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Option<Self::Item>> {
        if let Some(piece) = ready!(self.pieces.poll_recv(context)) {
            return Poll::Ready(Some(Ok(piece)));
        }
        let Some(end) = &mut self.end else {
            return Poll::Ready(None);
        };
        let outcome = ready!(Pin::new(end).poll(context));
        self.end = None;
        Poll::Ready(match outcome {
            Ok(Ok(())) => None,
            Ok(Err(error)) => Some(Err(error)),
            // The task panicked.
            Err(_) => Some(Err(ServiceError::internal(
                "the stream broke off: this is a fault of the service",
            ))),
        })
    }
}

#[cfg(test)]
mod tests {
    use std::sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    };

    use futures::stream;

    use super::*;

    const LONG: Duration = Duration::from_secs(60);

    /// Numbers, counted as they are made.
    fn numbers(made: &Arc<AtomicUsize>) -> impl Stream<Item = Result<usize, ServiceError>> + Send + use<> {
        let made = Arc::clone(made);
        stream::iter(0..100_usize).map(move |number| {
            made.fetch_add(1, Ordering::Relaxed);
            Ok(number)
        })
    }

    #[tokio::test]
    async fn pieces_come_in_order_and_no_faster_than_they_are_taken() {
        let made = Arc::default();
        let mut feed = Feed::of(numbers(&made), LONG, ());
        for expected in 0..100 {
            assert_eq!(feed.next().await.unwrap().unwrap(), expected);
            assert!(made.load(Ordering::Relaxed) <= expected + 3);
        }
        assert!(feed.next().await.is_none());
    }

    #[tokio::test]
    async fn a_caller_who_leaves_ends_it() {
        let made = Arc::default();
        let (hold, held) = oneshot::channel::<()>();
        let mut feed = Feed::of(numbers(&made), LONG, hold);
        feed.next().await;
        drop(feed);
        assert!(held.await.is_err(), "what was held is let go");
        assert!(made.load(Ordering::Relaxed) < 5);
    }

    #[tokio::test(start_paused = true)]
    async fn a_caller_who_takes_nothing_is_told_why_it_ends() {
        let made = Arc::default();
        let (hold, held) = oneshot::channel::<()>();
        let mut feed = Feed::of(numbers(&made), LONG, hold);
        assert!(held.await.is_err(), "what was held is let go");
        assert_eq!(feed.next().await.unwrap().unwrap(), 0);
        let error = feed.next().await.unwrap().unwrap_err();
        assert_eq!(error.wire().code, ErrorCode::DeadlineExceeded);
        assert!(feed.next().await.is_none());
    }

    #[tokio::test]
    async fn an_error_and_a_panic_are_the_last_piece() {
        let pieces = stream::iter([Ok(1), Err(ServiceError::deadline())]);
        let found: Vec<_> = Feed::of(pieces, LONG, ()).collect().await;
        assert!(matches!(&found[..], [Ok(1), Err(_)]), "{found:?}");
        let pieces = stream::iter([1]).map(|_| panic!("broken"));
        let found: Vec<Result<(), _>> = Feed::of(pieces, LONG, ()).collect().await;
        assert!(
            matches!(&found[..], [Err(error)] if error.wire().code == ErrorCode::Internal),
            "{found:?}"
        );
    }
}
