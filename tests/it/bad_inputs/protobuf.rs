//! Messages over gRPC that are none.

use prost::{
    Message,
    encoding::{WireType, encode_key, encode_varint},
};
use takt_proto::{route::Rpc, v1};
use takt_tests::fixtures::good_move;

use super::{INVALID, Method, Over, Row, TOO_LARGE, UNIMPLEMENTED, method};

fn row(name: &str, message: Vec<u8>, fields: &[&str]) -> Row {
    let over = Over::Grpc(method(Rpc::PlanMove, message));
    Row::new(&format!("protobuf: {name}"), over, INVALID, fields)
}

/// The good move and something after it.
fn followed(name: &str, more: impl FnOnce(&mut Vec<u8>), fields: &[&str]) -> Row {
    let mut message = good_move().encode_to_vec();
    more(&mut message);
    row(name, message, fields)
}

/// A field of a length, with these bytes in it.
fn field(bytes: &mut Vec<u8>, tag: u32, content: &[u8]) {
    encode_key(tag, WireType::LengthDelimited, bytes);
    encode_varint(content.len() as u64, bytes);
    bytes.extend_from_slice(content);
}

/// Numbers of the fields of a move.
const REVISION: u32 = 2;
const START: u32 = 3;
const SPEED: u32 = 5;
const METHOD: u32 = 11;
const UNKNOWN: u32 = 1000;

pub(super) fn rows() -> Vec<Row> {
    let mut rows = vec![
        row("text", b"{\"start\": {}}".to_vec(), &[]),
        row("0xff, sixteen times", vec![0xff; 16], &[]),
        row("the field 0", vec![0, 0], &[]),
        followed("a key that goes on", |bytes| bytes.push(0x80), &[]),
        followed(
            "a number of eleven bytes",
            |bytes| {
                encode_key(METHOD, WireType::Varint, bytes);
                bytes.extend([0xff; 11]);
            },
            &[],
        ),
        followed(
            "half a double",
            |bytes| {
                encode_key(9, WireType::SixtyFourBit, bytes);
                bytes.extend([0; 4]);
            },
            &[],
        ),
        followed(
            "a text of a wire type of numbers",
            |bytes| {
                encode_key(REVISION, WireType::Varint, bytes);
                encode_varint(7, bytes);
            },
            &[],
        ),
        followed(
            "a message of a wire type of doubles",
            |bytes| {
                encode_key(START, WireType::SixtyFourBit, bytes);
                bytes.extend([0; 8]);
            },
            &[],
        ),
        followed("wire type 7", |bytes| bytes.push(0x0f), &[]),
        followed(
            "a length beyond the end",
            |bytes| {
                encode_key(REVISION, WireType::LengthDelimited, bytes);
                encode_varint(1 << 40, bytes);
            },
            &[],
        ),
        followed(
            "a length beyond 64 bits",
            |bytes| {
                encode_key(REVISION, WireType::LengthDelimited, bytes);
                encode_varint(u64::MAX, bytes);
            },
            &[],
        ),
        followed(
            "a text that is no UTF-8",
            |bytes| field(bytes, REVISION, b"\xff\xfe"),
            &[],
        ),
        followed("half a double in a list", |bytes| field(bytes, SPEED, &[0; 12]), &[]),
        followed(
            "a group that is not closed",
            |bytes| encode_key(UNKNOWN, WireType::StartGroup, bytes),
            &[],
        ),
        followed(
            "a group closed that was not opened",
            |bytes| encode_key(UNKNOWN, WireType::EndGroup, bytes),
            &[],
        ),
        followed(
            "groups nested 100,000 deep",
            |bytes| {
                for _ in 0..100_000 {
                    encode_key(UNKNOWN, WireType::StartGroup, bytes);
                }
            },
            &[],
        ),
        followed(
            "NaN in the middle of a list of doubles",
            |bytes| {
                let speeds = [1.0, f64::NAN, 1.0, 1.0, 1.0, 1.0];
                field(bytes, SPEED, &speeds.map(f64::to_le_bytes).concat());
            },
            &["target_velocity[1]"],
        ),
        followed(
            "a NaN with other bits",
            |bytes| {
                encode_key(10, WireType::SixtyFourBit, bytes);
                bytes.extend(0xfff8_dead_beef_0001_u64.to_le_bytes());
            },
            &["speed_scale"],
        ),
        followed(
            "a method beyond 32 bits",
            |bytes| {
                encode_key(METHOD, WireType::Varint, bytes);
                encode_varint(1 << 35, bytes);
            },
            &["method"],
        ),
        followed(
            "more than eight megabytes",
            |bytes| field(bytes, UNKNOWN, &vec![0; 8 << 20]),
            &[],
        )
        .refused(TOO_LARGE),
    ];
    for rpc in [
        Rpc::RegisterRobot,
        Rpc::CheckTrajectory,
        Rpc::InverseDynamics,
        Rpc::ForwardKinematics,
        Rpc::GetRobot,
    ] {
        let over = Over::Grpc(method(rpc, vec![0xff; 9]));
        rows.push(Row::new(
            &format!("protobuf: noise to {}", rpc.name()),
            over,
            INVALID,
            &[],
        ));
    }
    for path in [
        "/takt.v1.PlanService/Nope",
        "/takt.v1.Nope/PlanMove",
        "/takt.v2.PlanService/PlanMove",
        "/nope",
        "/v1/robots",
    ] {
        let over = Over::Grpc(Method {
            path: path.to_owned(),
            message: v1::PlanMoveRequest::default().encode_to_vec(),
        });
        rows.push(Row::new(&format!("protobuf: to {path}"), over, UNIMPLEMENTED, &[]));
    }
    rows
}
