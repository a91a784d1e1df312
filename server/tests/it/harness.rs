//! A running server, and a client of each protocol that hides nothing.

use std::{collections::HashMap, net::SocketAddr};

use serde_json::Value;
use takt_server::{Config, Server};
use tokio::{
    io::{AsyncReadExt, AsyncWriteExt},
    net::TcpStream,
    sync::oneshot,
    task::JoinHandle,
};
use tonic::transport::{Channel, Endpoint};

/// A server that stops when told to.
pub(crate) struct Running {
    pub(crate) address: SocketAddr,
    stop: Option<oneshot::Sender<()>>,
    task: JoinHandle<()>,
}

/// An HTTP answer.
#[derive(Debug)]
pub(crate) struct Reply {
    pub(crate) status: u16,
    pub(crate) headers: HashMap<String, String>,
    pub(crate) body: Vec<u8>,
}

impl Reply {
    pub(crate) fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|error| panic!("{error}: {self:?}"))
    }

    /// The fields of the violations.
    pub(crate) fn fields(&self) -> Vec<String> {
        let json = self.json();
        let details = json["error"]["details"].as_array().unwrap();
        let violations = details
            .iter()
            .filter_map(|detail| detail["field_violations"].as_array());
        let fields = violations
            .flatten()
            .map(|violation| violation["field"].as_str().unwrap().to_owned());
        fields.collect()
    }
}

impl Running {
    /// A server with the example robots.
    pub(crate) async fn start() -> Self {
        Self::with(Config::default()).await
    }

    pub(crate) async fn with(config: Config) -> Self {
        let config = Config {
            examples: true,
            ..config
        };
        let server = Server::bind(config).await.unwrap();
        let address = server.local_addr();
        let (stop, stopped) = oneshot::channel();
        let task = tokio::spawn(server.run(async {
            let _ = stopped.await;
        }));
        Self {
            address,
            stop: Some(stop),
            task,
        }
    }

    /// Asks the server to stop.
    pub(crate) fn stop(&mut self) {
        let _ = self.stop.take().map(|stop| stop.send(()));
    }

    /// Waits for the server's end.
    pub(crate) async fn ended(mut self) {
        self.stop();
        self.task.await.unwrap();
    }

    pub(crate) async fn channel(&self) -> Channel {
        let endpoint = Endpoint::from_shared(format!("http://{}", self.address)).unwrap();
        endpoint.connect().await.unwrap()
    }

    pub(crate) async fn get(&self, path: &str) -> Reply {
        self.http("GET", path, &[], b"").await
    }

    pub(crate) async fn post(&self, path: &str, body: &str) -> Reply {
        self.http("POST", path, &[("content-type", "application/json")], body.as_bytes())
            .await
    }

    pub(crate) async fn put(&self, path: &str, body: &str) -> Reply {
        self.http("PUT", path, &[("content-type", "application/json")], body.as_bytes())
            .await
    }

    /// One request on a connection of its own.
    pub(crate) async fn http(&self, method: &str, path: &str, headers: &[(&str, &str)], body: &[u8]) -> Reply {
        let mut head = format!("{method} {path} HTTP/1.1\r\nhost: takt\r\nconnection: close\r\n");
        for (name, value) in headers {
            head.push_str(&format!("{name}: {value}\r\n"));
        }
        head.push_str(&format!("content-length: {}\r\n\r\n", body.len()));
        let mut stream = TcpStream::connect(self.address).await.unwrap();
        stream.write_all(head.as_bytes()).await.unwrap();
        // A server that refuses the head need not read the body.
        let _ = stream.write_all(body).await;
        let mut reply = Vec::new();
        let _ = stream.read_to_end(&mut reply).await;
        parse(&reply)
    }
}

fn parse(reply: &[u8]) -> Reply {
    let end = reply.windows(4).position(|bytes| bytes == b"\r\n\r\n").expect("a head");
    let head = std::str::from_utf8(&reply[..end]).unwrap();
    let mut lines = head.lines();
    let status = lines.next().unwrap().split(' ').nth(1).unwrap().parse().unwrap();
    let headers = lines.filter_map(|line| line.split_once(": "));
    Reply {
        status,
        headers: headers
            .map(|(name, value)| (name.to_owned(), value.to_owned()))
            .collect(),
        body: reply[end + 4..].to_vec(),
    }
}

/// A description of an arm with two joints; `mass` makes it another content.
pub(crate) fn two_joints(mass: f64) -> Value {
    serde_json::json!({
        "dh": {"convention": "STANDARD", "links": [
            {"name": "a", "type": "REVOLUTE", "a_m": 0.5, "mass_kg": mass, "center_of_mass_m": [-0.2, 0, 0], "inertia_kg_m2": [0.1, 0.1, 0.1, 0, 0, 0]},
            {"name": "b", "type": "REVOLUTE", "a_m": 0.4, "mass_kg": 2, "center_of_mass_m": [-0.2, 0, 0], "inertia_kg_m2": [0.1, 0.1, 0.1, 0, 0, 0]},
        ]},
        "joints": [
            {"name": "a", "limits": {"velocity": 3}, "drive": {"peak_torque": 200}},
            {"name": "b", "limits": {"velocity": 3}, "drive": {"peak_torque": 100}},
        ],
    })
}

pub(crate) fn registration(mass: f64) -> String {
    serde_json::json!({"description": two_joints(mass)}).to_string()
}
