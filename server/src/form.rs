//! How an answer leaves the planner's thread. What has just made it writes it, as its numbers are in that processor's
//! caches and its memory goes back to the thread that took it.

use bytes::Bytes;
use prost::Message;
use serde::Serialize;

use crate::error::ServiceError;

/// A form of answers.
pub(crate) trait Form<M>: 'static {
    /// The answer in this form.
    type Written: Send + 'static;

    fn write(message: M) -> Result<Self::Written, ServiceError>;
}

/// As a message.
#[derive(Debug)]
pub(crate) struct Plain;

/// As its protobuf encoding.
#[derive(Debug)]
pub(crate) struct Protobuf;

/// As JSON text.
#[derive(Debug)]
pub(crate) struct JsonText;

impl<M: Send + 'static> Form<M> for Plain {
    type Written = M;

    fn write(message: M) -> Result<M, ServiceError> {
        Ok(message)
    }
}

impl<M: Message> Form<M> for Protobuf {
    type Written = Bytes;

    fn write(message: M) -> Result<Bytes, ServiceError> {
        Ok(message.encode_to_vec().into())
    }
}

impl<M: Serialize> Form<M> for JsonText {
    type Written = Bytes;

    fn write(message: M) -> Result<Bytes, ServiceError> {
        json_text(&message)
    }
}

/// A message as JSON text.
pub(crate) fn json_text<M: Serialize>(message: &M) -> Result<Bytes, ServiceError> {
    let text = serde_json::to_vec(message);
    let text = text.map_err(|error| ServiceError::internal("the answer cannot be written as JSON").caused_by(error))?;
    Ok(text.into())
}
