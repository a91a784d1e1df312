//! The smallest server: `cargo run --example serve -- 127.0.0.1:7171 [STORE.db]`.

use std::{error::Error, path::PathBuf};

use takt_server::{Config, LogFormat, Server, StoreConfig, init_telemetry};

#[tokio::main]
async fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let listen = arguments.next().map(|address| address.parse()).transpose()?;
    let store = arguments.next().map(PathBuf::from);
    init_telemetry(
        LogFormat::Json,
        &std::env::var("TAKT_LOG").unwrap_or_else(|_| "info".to_owned()),
    )?;
    let config = Config {
        listen,
        store: store.map_or(StoreConfig::Memory, StoreConfig::Sqlite),
        examples: true,
        ..Config::default()
    };
    let server = Server::bind(config).await?;
    let stop = async {
        // Without the signal the process ends anyway.
        let _ = tokio::signal::ctrl_c().await;
    };
    server.run(stop).await;
    Ok(())
}
