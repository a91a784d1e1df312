//! Whether the service takes requests: a question to every endpoint, asked once.

use http::StatusCode;
use tokio::time::timeout;

use crate::{
    client::{Client, Endpoint},
    connection,
    error::{Code, Error},
};

impl Client {
    /// Asks every endpoint whether it takes requests. Not tried again: whoever asks wants to know how it is now.
    ///
    /// # Errors
    ///
    /// The first endpoint that cannot be reached, does not answer in time, or says that it is not ready.
    pub async fn ready(&self) -> Result<(), Error> {
        for endpoint in &self.shared.endpoints {
            let asked = timeout(self.deadline, self.ask_ready(endpoint)).await;
            asked
                .unwrap_or_else(|_| Err(Error::deadline(self.deadline, None)))
                .map_err(|error| error.at(&endpoint.name))?;
        }
        Ok(())
    }

    async fn ask_ready(&self, endpoint: &Endpoint) -> Result<(), Error> {
        let request = self.shared.http1.get(format!("{}/readyz", endpoint.name));
        let reply = request.send().await.map_err(|error| {
            let (message, _) = connection::describe(&error);
            Error::transport(message, error)
        })?;
        match reply.status() {
            StatusCode::OK => Ok(()),
            StatusCode::SERVICE_UNAVAILABLE => Err(Error::answered(Code::Unavailable, "not ready")),
            other => Err(Error::answered(
                Code::Internal,
                format!("answered {other}, but not as a Takt server does"),
            )),
        }
    }
}
