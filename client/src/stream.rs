//! Answers that come in pieces, over either transport.

use std::{
    pin::Pin,
    sync::{Mutex, PoisonError},
    task::{Context, Poll},
    time::Duration,
};

use bytes::{Bytes, BytesMut};
use futures::{Stream, StreamExt, stream::BoxStream};
use http_body::{Body, Frame};
use serde::de::DeserializeOwned;
use serde_json::Value;
use takt_proto::{
    error as wire,
    v1::{self, stream_setpoints_response::Part},
};
use tokio::time::timeout;

use crate::{
    error::{Code, Error},
    grpc, http_json, lenient,
};

/// Pieces as they arrive.
pub(crate) enum Pieces<T> {
    Grpc(Box<tonic::Streaming<T>>),
    Http(Lines),
}

impl<T: DeserializeOwned> Pieces<T> {
    async fn next(&mut self, deadline: Duration) -> Result<Option<T>, Error> {
        let next = async {
            match self {
                Self::Grpc(pieces) => pieces.message().await.map_err(|status| grpc::from_status(&status)),
                Self::Http(lines) => match lines.next().await? {
                    Some(line) => read(&line).map(Some),
                    None => Ok(None),
                },
            }
        };
        let next = timeout(deadline, next).await;
        next.unwrap_or_else(|_| Err(Error::deadline(deadline, None)))
    }
}

/// A line is a piece, or the refusal that ends the stream.
fn read<T: DeserializeOwned>(line: &[u8]) -> Result<T, Error> {
    let is_refusal = |line: &Value| {
        line.as_object()
            .is_some_and(|line| line.len() == 1 && line.contains_key("error"))
    };
    if line.starts_with(br#"{"error""#)
        && serde_json::from_slice(line).is_ok_and(|line| is_refusal(&line))
        && let Some(error) = wire::Error::from_json(line)
    {
        return Err(Error::from_wire(error));
    }
    lenient::from_slice(line).map_err(|error| {
        Error::answered(
            Code::Internal,
            format!("a line of the reply is not understood: {error}"),
        )
    })
}

/// The lines of a reply.
pub(crate) struct Lines {
    reply: reqwest::Response,
    rest: BytesMut,
    /// How much of the rest has no line end.
    searched: usize,
    longest: usize,
}

impl Lines {
    pub(crate) fn of(reply: reqwest::Response, longest: usize) -> Self {
        Self {
            reply,
            rest: BytesMut::new(),
            searched: 0,
            longest,
        }
    }

    async fn next(&mut self) -> Result<Option<Bytes>, Error> {
        loop {
            if let Some(end) = self.rest[self.searched..].iter().position(|byte| *byte == b'\n') {
                let line = self.rest.split_to(self.searched + end + 1).freeze();
                self.searched = 0;
                return Ok(Some(line.slice(..line.len() - 1)));
            }
            self.searched = self.rest.len();
            if self.searched > self.longest {
                let message = format!("a line of the reply is over {} bytes", self.longest);
                return Err(Error::answered(Code::TooLarge, message));
            }
            match self.reply.chunk().await.map_err(http_json::broken)? {
                Some(chunk) => self.rest.extend_from_slice(&chunk),
                None if self.rest.is_empty() => return Ok(None),
                None => return Err(broken_off()),
            }
        }
    }
}

fn broken_off() -> Error {
    let message = "the stream broke off before its end";
    Error::transport(message, message)
}

/// A body that is made while it is sent. The mutex is never locked: it makes of what can be sent between threads
/// something that may be shared by them, which the HTTP client asks for.
pub(crate) struct Outgoing(Mutex<BoxStream<'static, serde_json::Result<Bytes>>>);

impl Outgoing {
    pub(crate) fn of(lines: impl Stream<Item = serde_json::Result<Bytes>> + Send + 'static) -> Self {
        Self(Mutex::new(lines.boxed()))
    }
}

impl Body for Outgoing {
    type Data = Bytes;
    type Error = serde_json::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, serde_json::Error>>> {
        let lines = self.0.get_mut().unwrap_or_else(PoisonError::into_inner);
        lines.poll_next_unpin(context).map_ok(Frame::data)
    }
}

/// Set-points as they are asked for, after the plan that they are of.
pub struct SetpointStream {
    header: v1::SetpointsHeader,
    pieces: Pieces<v1::StreamSetpointsResponse>,
    deadline: Duration,
    received: u32,
}

impl std::fmt::Debug for SetpointStream {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SetpointStream")
            .field("header", &self.header)
            .field("received", &self.received)
            .finish_non_exhaustive()
    }
}

impl SetpointStream {
    pub(crate) async fn begin(
        mut pieces: Pieces<v1::StreamSetpointsResponse>,
        deadline: Duration,
    ) -> Result<Self, Error> {
        match pieces.next(deadline).await?.and_then(|piece| piece.part) {
            Some(Part::Header(header)) => Ok(Self {
                header,
                pieces,
                deadline,
                received: 0,
            }),
            Some(Part::Chunk(_)) => Err(Error::answered(
                Code::Internal,
                "the stream does not begin with a header",
            )),
            None => Err(broken_off()),
        }
    }

    /// The plan, without its set-points; or that there is none.
    #[must_use]
    pub fn header(&self) -> &v1::SetpointsHeader {
        &self.header
    }

    /// The next set-points; `None` after the last ones.
    ///
    /// # Errors
    ///
    /// See [`Error`]. Also where a set-point is missing: whoever gets to the end has all of them, in order.
    pub async fn next(&mut self) -> Result<Option<v1::SetpointsChunk>, Error> {
        let Some(piece) = self.pieces.next(self.deadline).await? else {
            return match self.received == self.header.setpoint_count {
                true => Ok(None),
                false => Err(broken_off()),
            };
        };
        let Some(Part::Chunk(chunk)) = piece.part else {
            return Err(Error::answered(
                Code::Internal,
                "a piece of the stream holds no set-points",
            ));
        };
        let count = chunk.setpoints.as_ref().map_or(0, |setpoints| setpoints.time_s.len());
        if chunk.first != self.received {
            let message = format!("set-point {} came where {} was due", chunk.first, self.received);
            return Err(Error::answered(Code::Internal, message));
        }
        self.received = self.received.saturating_add(u32::try_from(count).unwrap_or(u32::MAX));
        Ok(Some(chunk))
    }
}

/// The answers to a batch, as they arrive.
pub struct BatchAnswers {
    pieces: Pieces<v1::PlanBatchResponse>,
    deadline: Duration,
}

impl std::fmt::Debug for BatchAnswers {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("BatchAnswers").finish_non_exhaustive()
    }
}

impl BatchAnswers {
    pub(crate) fn new(pieces: Pieces<v1::PlanBatchResponse>, deadline: Duration) -> Self {
        Self { pieces, deadline }
    }

    /// The next answer; `None` when the requests have ended and all are answered.
    ///
    /// # Errors
    ///
    /// See [`Error`]. Answers that came before stand.
    pub async fn next(&mut self) -> Result<Option<v1::PlanBatchResponse>, Error> {
        self.pieces.next(self.deadline).await
    }
}

/// Estimates of friction, as they arrive.
pub struct FrictionEstimates {
    pieces: Pieces<v1::EstimateFrictionResponse>,
    deadline: Duration,
    is_complete: bool,
}

impl std::fmt::Debug for FrictionEstimates {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("FrictionEstimates")
            .field("is_complete", &self.is_complete)
            .finish_non_exhaustive()
    }
}

impl FrictionEstimates {
    pub(crate) fn new(pieces: Pieces<v1::EstimateFrictionResponse>, deadline: Duration) -> Self {
        Self {
            pieces,
            deadline,
            is_complete: false,
        }
    }

    /// The next estimate; `None` after the last one, which has the state to go on from.
    ///
    /// # Errors
    ///
    /// See [`Error`]. What ends the stream early is an error after the last estimate.
    pub async fn next(&mut self) -> Result<Option<v1::EstimateFrictionResponse>, Error> {
        match self.pieces.next(self.deadline).await? {
            Some(estimate) => {
                self.is_complete = estimate.last;
                Ok(Some(estimate))
            }
            None if self.is_complete => Ok(None),
            None => Err(broken_off()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refusal_is_told_from_an_answer_with_an_error() {
        let refusal = br#"{"error":{"code":4,"status":"DEADLINE_EXCEEDED","message":"late","details":[]}}"#;
        assert_eq!(
            read::<v1::PlanBatchResponse>(refusal).unwrap_err().code(),
            Code::DeadlineExceeded
        );
        let answer = br#"{"error":{"code":3,"message":"bad"},"id":"a","index":7,"new":1}"#;
        let answer: v1::PlanBatchResponse = read(answer).unwrap();
        assert_eq!(answer.index, 7);
        assert!(read::<v1::PlanBatchResponse>(b"<html>").is_err());
    }
}
