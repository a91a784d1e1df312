//! How messages are read from gRPC: as protobuf, where a malformed one is the sender's fault.

use std::marker::PhantomData;

use bytes::{BufMut, Bytes};
use prost::Message;
use tonic::{
    Status,
    codec::{self, BufferSettings, DecodeBuf, EncodeBuf},
};

use crate::error::{Error, ErrorCode};

/// Protobuf. A message that cannot be decoded is INVALID_ARGUMENT, not INTERNAL as by default.
#[derive(Debug)]
pub struct Codec<T, U>(PhantomData<(T, U)>);

impl<T, U> Default for Codec<T, U> {
    fn default() -> Self {
        Self(PhantomData)
    }
}

impl<T, U> codec::Codec for Codec<T, U>
where
    T: Message + Send + 'static,
    U: Message + Default + Send + 'static,
{
    type Encode = T;
    type Decode = U;
    type Encoder = <tonic_prost::ProstCodec<T, U> as codec::Codec>::Encoder;
    type Decoder = Decoder<U>;

    fn encoder(&mut self) -> Self::Encoder {
        tonic_prost::ProstCodec::<T, U>::default().encoder()
    }

    fn decoder(&mut self) -> Self::Decoder {
        Decoder(PhantomData)
    }
}

/// Protobuf, where the answers are encoded already: by the thread that made them.
#[derive(Debug)]
pub struct Encoded<U>(PhantomData<U>);

impl<U> Default for Encoded<U> {
    fn default() -> Self {
        Self(PhantomData)
    }
}

impl<U> codec::Codec for Encoded<U>
where
    U: Message + Default + Send + 'static,
{
    type Encode = Bytes;
    type Decode = U;
    type Encoder = Copier;
    type Decoder = Decoder<U>;

    fn encoder(&mut self) -> Copier {
        Copier(())
    }

    fn decoder(&mut self) -> Decoder<U> {
        Decoder(PhantomData)
    }
}

/// What is taken for a message to begin with; longer ones take what they need. The usual request and answer are shorter,
/// and more would be written to and never used.
const BUFFER_BYTES: usize = 2 << 10;

fn buffer() -> BufferSettings {
    // A stream's pieces are sent together up to the same size as by default.
    BufferSettings::new(BUFFER_BYTES, 32 << 10)
}

/// Writes encoded messages.
#[derive(Debug)]
pub struct Copier(());

impl codec::Encoder for Copier {
    type Item = Bytes;
    type Error = Status;

    fn encode(&mut self, message: Bytes, buffer: &mut EncodeBuf<'_>) -> Result<(), Status> {
        buffer.put(message);
        Ok(())
    }

    fn buffer_settings(&self) -> BufferSettings {
        buffer()
    }
}

/// Reads messages.
#[derive(Debug)]
pub struct Decoder<U>(PhantomData<U>);

impl<U: Message + Default> codec::Decoder for Decoder<U> {
    type Item = U;
    type Error = Status;

    fn decode(&mut self, buffer: &mut DecodeBuf<'_>) -> Result<Option<U>, Status> {
        match U::decode(buffer) {
            Ok(message) => Ok(Some(message)),
            Err(error) => {
                let message = format!("the message is malformed: {error}");
                Err(Error::new(ErrorCode::InvalidRequest, message).to_status())
            }
        }
    }

    fn buffer_settings(&self) -> BufferSettings {
        buffer()
    }
}
