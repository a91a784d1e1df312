//! Request bodies, counted: all requests in work together may hold only so many bytes.

use std::{
    error::Error as StdError,
    pin::Pin,
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
    task::{Context, Poll},
    time::Duration,
};

use bytes::Bytes;
use http_body::{Body, Frame, SizeHint};
use takt_proto::error::Error;

/// What a refused caller is told to wait.
const RETRY_AFTER: Duration = Duration::from_millis(500);

/// How many bytes requests in work hold.
#[derive(Debug)]
pub(crate) struct Budget {
    limit: usize,
    held: AtomicUsize,
}

/// The bytes of one request; they are given back when the last holder is gone.
#[derive(Debug)]
pub(crate) struct Held {
    budget: Arc<Budget>,
    bytes: AtomicUsize,
}

/// A body that counts what it hands out.
#[derive(Debug)]
pub(crate) struct Incoming {
    body: hyper::body::Incoming,
    held: Arc<Held>,
}

impl Budget {
    pub(crate) fn new(limit: usize) -> Arc<Self> {
        Arc::new(Self {
            limit,
            held: AtomicUsize::new(0),
        })
    }

    /// A body to be counted, and the hold on its bytes.
    pub(crate) fn counted(self: &Arc<Self>, body: hyper::body::Incoming) -> (Incoming, Arc<Held>) {
        let held = Arc::new(Held {
            budget: Arc::clone(self),
            bytes: AtomicUsize::new(0),
        });
        (
            Incoming {
                body,
                held: Arc::clone(&held),
            },
            held,
        )
    }
}

impl Held {
    fn add(&self, bytes: usize) -> Result<(), Error> {
        let before = self.budget.held.fetch_add(bytes, Ordering::Relaxed);
        self.bytes.fetch_add(bytes, Ordering::Relaxed);
        let limit = self.budget.limit;
        if before + bytes <= limit {
            return Ok(());
        }
        let message = format!("the requests in work hold {limit} bytes already");
        Err(Error::overloaded("limits.max_bytes_in_work", message, RETRY_AFTER))
    }

    /// Gives bytes back before the end: of a stream's request that has been read.
    pub(crate) fn release(&self, bytes: usize) {
        let less = |held: usize| Some(held.saturating_sub(bytes));
        // Never refused, as there always is a new value.
        let before = self.bytes.fetch_update(Ordering::Relaxed, Ordering::Relaxed, less);
        let released = before.unwrap_or(0).min(bytes);
        self.budget.held.fetch_sub(released, Ordering::Relaxed);
    }
}

impl Drop for Held {
    fn drop(&mut self) {
        let bytes = self.bytes.load(Ordering::Relaxed);
        self.budget.held.fetch_sub(bytes, Ordering::Relaxed);
    }
}

impl Body for Incoming {
    type Data = Bytes;
    type Error = Box<dyn StdError + Send + Sync>;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, Self::Error>>> {
        let frame = std::task::ready!(Pin::new(&mut self.body).poll_frame(context));
        let Some(Ok(frame)) = frame else {
            return Poll::Ready(frame.map(|frame| frame.map_err(Into::into)));
        };
        let bytes = frame.data_ref().map_or(0, Bytes::len);
        Poll::Ready(Some(match self.held.add(bytes) {
            Ok(()) => Ok(frame),
            // As a status: the gRPC side hands it on as it is.
            Err(error) => Err(error.to_status().into()),
        }))
    }

    fn is_end_stream(&self) -> bool {
        self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.body.size_hint()
    }
}
