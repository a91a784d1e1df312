//! Lets other tasks go first.

use std::{
    pin::Pin,
    task::{Context, Poll},
};

/// A future that is polled one turn of its runtime's queue after it was woken.
///
/// A runtime polls a task that was just woken before those that wait already. The connection of many requests would so
/// write each answer by itself, one system call each, where those who have the other answers in hand are next in the
/// queue. With their turn before its own it writes all of them at once.
#[derive(Debug)]
pub(super) struct AfterOthers<F> {
    future: Pin<Box<F>>,
    has_waited: bool,
}

impl<F> AfterOthers<F> {
    pub(super) fn new(future: F) -> Self {
        Self {
            future: Box::pin(future),
            has_waited: false,
        }
    }
}

impl<F: Future> Future for AfterOthers<F> {
    type Output = F::Output;

    fn poll(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<F::Output> {
        self.has_waited = !self.has_waited;
        if self.has_waited {
            // Woken while it is polled, a task goes to the end of the queue.
            context.waker().wake_by_ref();
            return Poll::Pending;
        }
        self.future.as_mut().poll(context)
    }
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;

    use futures::future::{join, poll_fn};

    use super::*;

    #[tokio::test]
    async fn others_that_are_ready_go_first() {
        let order = RefCell::new(Vec::new());
        let note = |name| {
            let order = &order;
            poll_fn(move |_| {
                order.borrow_mut().push(name);
                Poll::Ready(())
            })
        };
        join(AfterOthers::new(note("connection")), note("request")).await;
        assert_eq!(*order.borrow(), ["request", "connection"]);
    }
}
