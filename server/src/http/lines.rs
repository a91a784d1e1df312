//! Streams as JSON lines: one document a line, in and out.
//!
//! A line that is too long is passed over, like one that cannot be read: it has an answer that says so. What goes wrong
//! once the answer has begun is its last line, in the form of a refusal: `{"error": …}`.

use std::{collections::VecDeque, sync::Arc};

use axum::{
    body::{Body, BodyDataStream},
    extract::Request,
    response::{IntoResponse, Response},
};
use bytes::{Bytes, BytesMut};
use futures::{Stream, StreamExt, stream};
use http::header;
use prost::Message;
use serde::{Serialize, de::DeserializeOwned};
use takt_proto::{route::JSON_LINES, v1};

use super::{
    Answered, Http,
    json::{self, ForRobot, JSON, Json},
};
use crate::{
    edge::Admission,
    error::ServiceError,
    service::{Arrived, Call, Incoming},
    stream::Feed,
};

/// What JSON lines are also called.
const LINES: [&str; 3] = [JSON_LINES, "application/jsonl", JSON];

impl Http {
    pub(super) async fn stream_setpoints(self: &Arc<Self>, request: Request, id: String, call: Call) -> Answered {
        let admission = admission_of(&request)?;
        let message: v1::StreamSetpointsRequest = self.json.read_for(request, id, call).await?;
        let feed = self.service.stream_setpoints(call, admission, message).await?;
        Ok(self.lines(feed, call))
    }

    pub(super) fn plan_batch(self: &Arc<Self>, request: Request, id: String, call: Call) -> Answered {
        let (admission, requests) = self.messages(request, id, call)?;
        let requests = requests.map(|read| read.map(|(request, bytes)| Incoming { request, bytes }));
        let feed = self.service.plan_batch(call, admission, requests);
        Ok(self.lines(feed, call))
    }

    pub(super) async fn estimate_friction(self: &Arc<Self>, request: Request, id: String, call: Call) -> Answered {
        let (admission, requests) = self.messages(request, id, call)?;
        let arrivals = requests.map(|read| read.map(|(request, bytes)| Arrived { request, bytes }));
        let feed = self.service.estimate_friction(call, admission, arrivals).await?;
        Ok(self.lines(feed, call))
    }

    /// The messages of a body, one a line, and the bytes that each holds.
    fn messages<T>(
        self: &Arc<Self>,
        request: Request,
        id: String,
        call: Call,
    ) -> Result<
        (
            Admission,
            impl Stream<Item = Result<Read<T>, ServiceError>> + Send + use<T>,
        ),
        ServiceError,
    >
    where
        T: DeserializeOwned + ForRobot + Send + 'static,
    {
        json::check_query(&request)?;
        json::check_kind(request.headers(), &LINES)?;
        let admission = admission_of(&request)?;
        let (http, id): (_, Arc<str>) = (Arc::clone(self), id.into());
        let lines = lines(
            request.into_body().into_data_stream(),
            self.json.max_bytes(),
            admission.clone(),
        );
        let messages = lines.then(move |line| {
            let (http, id) = (Arc::clone(&http), Arc::clone(&id));
            async move { Ok(http.json.read(line?, &id, call).await) }
        });
        Ok((admission, messages))
    }

    /// Answers in lines.
    fn lines<T>(self: &Arc<Self>, feed: Feed<T>, call: Call) -> Response
    where
        T: Serialize + Message + 'static,
    {
        let http = Arc::clone(self);
        let lines = feed.then(move |piece| {
            let http = Arc::clone(&http);
            async move {
                let text = match piece {
                    Ok(piece) => http.json.text_of(piece, call.of_item()).await,
                    Err(error) => Err(error),
                };
                let text = text.unwrap_or_else(|error| error.wire().to_json().to_string().into());
                let mut line = BytesMut::from(text);
                line.extend_from_slice(b"\n");
                Ok::<_, std::convert::Infallible>(line.freeze())
            }
        });
        ([(header::CONTENT_TYPE, JSON_LINES)], Body::from_stream(lines)).into_response()
    }
}

impl Json {
    async fn read<T>(&self, line: Line, id: &str, call: Call) -> Read<T>
    where
        T: DeserializeOwned + ForRobot + Send + 'static,
    {
        match line {
            Line::Whole(line) => {
                let bytes = line.len();
                (self.message_for(line, id, call.of_item()).await, bytes)
            }
            Line::TooLong => (Err(self.too_large("the line")), 0),
        }
    }
}

/// What a line says, or why it cannot be read; and the bytes that it holds.
type Read<T> = (Result<T, ServiceError>, usize);

fn admission_of(request: &Request) -> Result<Admission, ServiceError> {
    let admission = request.extensions().get::<Admission>().cloned();
    admission.ok_or_else(|| ServiceError::internal("the request has no place among those in work"))
}

/// A line without its end.
#[derive(Debug, PartialEq, Eq)]
enum Line {
    Whole(Bytes),
    TooLong,
}

/// The lines of a body that are not empty. What is passed over is not held any more.
fn lines(
    body: BodyDataStream,
    longest: usize,
    admission: Admission,
) -> impl Stream<Item = Result<Line, ServiceError>> + Send {
    let splitter = Splitter::new(longest);
    stream::unfold(Some((body, splitter, admission)), |state| async move {
        let (mut body, mut splitter, admission) = state?;
        loop {
            if let Some(line) = splitter.ready.pop_front() {
                return Some((Ok(line), Some((body, splitter, admission))));
            }
            match body.next().await {
                Some(Ok(bytes)) => {
                    splitter.add(&bytes);
                    admission.held().release(std::mem::take(&mut splitter.passed_over));
                }
                Some(Err(error)) => return Some((Err(json::ended_early(&error)), None)),
                None => {
                    splitter.end();
                    let last = splitter.ready.pop_front()?;
                    return Some((Ok(last), None));
                }
            }
        }
    })
}

/// Cuts bytes into lines.
#[derive(Debug)]
struct Splitter {
    longest: usize,
    line: Vec<u8>,
    is_too_long: bool,
    /// Bytes that are in no line.
    passed_over: usize,
    ready: VecDeque<Line>,
}

impl Splitter {
    fn new(longest: usize) -> Self {
        Self {
            longest,
            line: Vec::new(),
            is_too_long: false,
            passed_over: 0,
            ready: VecDeque::new(),
        }
    }

    fn add(&mut self, mut bytes: &[u8]) {
        while let Some(end) = bytes.iter().position(|byte| *byte == b'\n') {
            self.grow(&bytes[..end]);
            self.end();
            self.passed_over += 1;
            bytes = &bytes[end + 1..];
        }
        self.grow(bytes);
    }

    fn grow(&mut self, bytes: &[u8]) {
        if self.is_too_long || self.line.len() + bytes.len() > self.longest {
            self.is_too_long = true;
            self.passed_over += std::mem::take(&mut self.line).len() + bytes.len();
            return;
        }
        self.line.extend_from_slice(bytes);
    }

    fn end(&mut self) {
        let line = std::mem::take(&mut self.line);
        if std::mem::take(&mut self.is_too_long) {
            self.ready.push_back(Line::TooLong);
        } else if line.iter().all(u8::is_ascii_whitespace) {
            self.passed_over += line.len();
        } else {
            self.ready.push_back(Line::Whole(line.into()));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn split(pieces: &[&str], longest: usize) -> Vec<Line> {
        let mut splitter = Splitter::new(longest);
        pieces.iter().for_each(|piece| splitter.add(piece.as_bytes()));
        splitter.end();
        splitter.ready.into()
    }

    fn whole(text: &'static str) -> Line {
        Line::Whole(Bytes::from_static(text.as_bytes()))
    }

    #[test]
    fn lines_are_cut_wherever_the_bytes_are() {
        let expected = [whole("one"), whole("two\r"), whole("three")];
        assert_eq!(split(&["one\ntwo\r\n\n \nthree"], 9), expected);
        assert_eq!(split(&["o", "n", "e\nt", "wo\r", "\n", "three\n"], 9), expected);
        assert_eq!(split(&["\n", ""], 9), []);
    }

    #[test]
    fn every_byte_is_in_a_line_or_passed_over() {
        let mut splitter = Splitter::new(4);
        splitter.add(b"1234\n123456");
        splitter.add(b"7\n  \n12");
        let in_lines = splitter.ready.iter().map(|line| match line {
            Line::Whole(line) => line.len(),
            Line::TooLong => 0,
        });
        assert_eq!(
            (in_lines.sum::<usize>(), splitter.line.len(), splitter.passed_over),
            (4, 2, 12)
        );
    }

    #[test]
    fn a_line_that_is_too_long_is_passed_over() {
        let expected = [whole("1234"), Line::TooLong, whole("5")];
        assert_eq!(split(&["1234\n12345\n5"], 4), expected);
        assert_eq!(split(&["1234\n12", "345", "6789\n5\n"], 4), expected);
    }
}
