//! HTTP/1.1 by the byte: what is sent need not be JSON, nor a request that anybody would write.

use std::net::SocketAddr;

use serde_json::Value;
use takt_proto::error::Error;
use tokio::{
    io::{AsyncBufReadExt, AsyncReadExt, AsyncWriteExt, BufReader},
    net::TcpStream,
};

/// Bodies from this size on are sent when the server asks for them: one that refuses the head need not read them.
const LARGE_BODY_BYTES: usize = 64 << 10;

/// One connection, kept alive.
#[derive(Debug)]
pub struct Connection {
    address: SocketAddr,
    stream: BufReader<TcpStream>,
    is_closed: bool,
    opened_count: usize,
}

/// An answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Reply {
    /// The status code.
    pub status: u16,
    /// Names in lower case.
    pub headers: Vec<(String, String)>,
    /// As it came.
    pub body: Vec<u8>,
}

impl Reply {
    /// The value of a header.
    #[must_use]
    pub fn header(&self, name: &str) -> Option<&str> {
        let found = self.headers.iter().find(|(key, _)| key == name);
        found.map(|(_, value)| value.as_str())
    }

    /// The body, read as JSON.
    #[must_use]
    pub fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|error| panic!("{error}: {}", self.text()))
    }

    /// The body, read as text.
    #[must_use]
    pub fn text(&self) -> String {
        String::from_utf8_lossy(&self.body).into_owned()
    }

    /// The body, read as JSON lines.
    #[must_use]
    pub fn json_lines(&self) -> Vec<Value> {
        let lines = self.body.split(|byte| *byte == b'\n').filter(|line| !line.is_empty());
        lines
            .map(|line| serde_json::from_slice(line).unwrap_or_else(|error| panic!("{error}: {}", self.text())))
            .collect()
    }

    /// The refusal in the body.
    #[must_use]
    pub fn error(&self) -> Error {
        Error::from_json(&self.body).unwrap_or_else(|| panic!("no error: {} {}", self.status, self.text()))
    }
}

impl Connection {
    pub(crate) async fn open(address: SocketAddr) -> Self {
        Self {
            address,
            stream: connect(address).await,
            is_closed: false,
            opened_count: 1,
        }
    }

    /// How many times it had to be opened: a server closes it that has left a body unread.
    #[must_use]
    pub fn opened_count(&self) -> usize {
        self.opened_count
    }

    /// Asks for a page.
    pub async fn get(&mut self, path: &str) -> Reply {
        self.request("GET", path, &[], b"").await
    }

    /// Sends JSON.
    pub async fn post(&mut self, path: &str, json: &str) -> Reply {
        self.request("POST", path, &[("content-type", "application/json")], json.as_bytes())
            .await
    }

    /// Sends JSON.
    pub async fn put(&mut self, path: &str, json: &str) -> Reply {
        self.request("PUT", path, &[("content-type", "application/json")], json.as_bytes())
            .await
    }

    /// Sends a request and waits for the answer.
    pub async fn request(&mut self, method: &str, path: &str, headers: &[(&str, &str)], body: &[u8]) -> Reply {
        let waits = body.len() >= LARGE_BODY_BYTES;
        let chunked = headers.iter().any(|(name, _)| *name == "transfer-encoding");
        let mut head = format!("{method} {path} HTTP/1.1\r\nhost: takt\r\n");
        for (name, value) in headers {
            head.push_str(&format!("{name}: {value}\r\n"));
        }
        if waits {
            head.push_str("expect: 100-continue\r\n");
        }
        if !chunked {
            head.push_str(&format!("content-length: {}\r\n", body.len()));
        }
        head.push_str("\r\n");
        let mut bytes = head.into_bytes();
        if !waits {
            bytes.extend_from_slice(body);
        }
        self.send(&bytes).await;
        let mut reply = self.receive(method).await;
        if reply.status == 100 {
            self.send(body).await;
            reply = self.receive(method).await;
        }
        self.is_closed = reply.header("connection") == Some("close") || (waits && reply.status >= 400);
        reply
    }

    /// Sends bytes as they are; opens the connection again where the server has closed it.
    pub async fn send(&mut self, bytes: &[u8]) {
        if self.is_closed {
            self.stream = connect(self.address).await;
            self.is_closed = false;
            self.opened_count += 1;
        }
        self.stream.write_all(bytes).await.expect("the server reads");
    }

    /// Waits for an answer; `method` says whether it has a body.
    pub async fn receive(&mut self, method: &str) -> Reply {
        let mut reply = self.receive_head().await;
        let has_body = reply.status >= 200 && !matches!(reply.status, 204 | 304) && method != "HEAD";
        if has_body && reply.header("transfer-encoding") == Some("chunked") {
            while let Some(chunk) = self.receive_chunk().await {
                reply.body.extend_from_slice(&chunk);
            }
        } else if has_body {
            let length = reply.header("content-length").expect("an answer says how long it is");
            reply.body = vec![0; length.parse().expect("a length is a number")];
            let read = self.stream.read_exact(&mut reply.body).await;
            read.expect("an answer is as long as it says");
        }
        reply
    }

    /// Sends the head of a request whose body follows in chunks.
    pub async fn begin(&mut self, path: &str, kind: &str) {
        let head =
            format!("POST {path} HTTP/1.1\r\nhost: takt\r\ncontent-type: {kind}\r\ntransfer-encoding: chunked\r\n\r\n");
        self.send(head.as_bytes()).await;
    }

    /// Sends a chunk of the body; an empty one ends it.
    pub async fn send_chunk(&mut self, bytes: &[u8]) {
        let mut chunk = format!("{:x}\r\n", bytes.len()).into_bytes();
        chunk.extend_from_slice(bytes);
        chunk.extend_from_slice(b"\r\n");
        self.send(&chunk).await;
    }

    /// Waits for a chunk of an answer; `None` is its end.
    pub async fn receive_chunk(&mut self) -> Option<Vec<u8>> {
        let length = usize::from_str_radix(&self.line().await, 16).expect("a chunk has a length");
        let mut chunk = vec![0; length + 2];
        let read = self.stream.read_exact(&mut chunk).await;
        read.expect("a chunk is as long as it says");
        chunk.truncate(length);
        (length > 0).then_some(chunk)
    }

    /// Waits for the head of an answer.
    pub async fn receive_head(&mut self) -> Reply {
        let line = self.line().await;
        let status = line.split(' ').nth(1).and_then(|status| status.parse().ok());
        let status = status.unwrap_or_else(|| panic!("{line:?} is no status line"));
        let mut reply = Reply {
            status,
            headers: Vec::new(),
            body: Vec::new(),
        };
        loop {
            let line = self.line().await;
            if line.is_empty() {
                break;
            }
            let (name, value) = line.split_once(':').expect("a header has a colon");
            reply.headers.push((name.to_ascii_lowercase(), value.trim().to_owned()));
        }
        reply
    }

    /// Everything until the server closes.
    pub async fn rest(&mut self) -> Vec<u8> {
        let mut rest = Vec::new();
        // Closed, or reset because of what was not read.
        let _ = self.stream.read_to_end(&mut rest).await;
        rest
    }

    async fn line(&mut self) -> String {
        let mut line = String::new();
        let read = self.stream.read_line(&mut line).await;
        assert!(read.is_ok_and(|count| count > 0), "the server closed the connection");
        line.trim_end().to_owned()
    }
}

async fn connect(address: SocketAddr) -> BufReader<TcpStream> {
    let stream = TcpStream::connect(address).await.expect("the server listens");
    stream.set_nodelay(true).expect("the socket is open");
    BufReader::new(stream)
}
