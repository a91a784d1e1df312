//! Streams of set-points that lack some of them.

use takt_client::{Code, ErrorKind, Transport, v1};

use super::{Act, BOTH, Fake, client};

/// A stream of five set-points, or what is left of it.
pub(super) fn pieces(fault: &str) -> Vec<v1::StreamSetpointsResponse> {
    use v1::stream_setpoints_response::Part;
    let chunk = |first: u32, count: u8, last: bool| {
        Part::Chunk(v1::SetpointsChunk {
            first,
            last,
            setpoints: Some(v1::Setpoints {
                time_s: (0..count).map(f64::from).collect(),
                ..Default::default()
            }),
        })
    };
    let header = Part::Header(v1::SetpointsHeader {
        setpoint_count: 5,
        ..Default::default()
    });
    let parts = match fault {
        "headless" => vec![chunk(0, 5, true)],
        "short" => vec![header, chunk(0, 2, false)],
        "gap" => vec![header, chunk(0, 2, false), chunk(3, 2, true)],
        "twice" => vec![header, chunk(0, 2, false), chunk(0, 2, false)],
        _ => vec![header, chunk(0, 2, false), chunk(2, 3, true)],
    };
    let parts = parts.into_iter();
    parts
        .map(|part| v1::StreamSetpointsResponse { part: Some(part) })
        .collect()
}

/// How many set-points come before the end of a stream, and how it ends.
async fn taken(transport: Transport, fault: &'static str) -> (usize, Result<(), takt_client::Error>) {
    let fake = Fake::new(fault, &[Act::Unavailable, Act::Answer]);
    let url = fake.serve().await;
    let request = v1::StreamSetpointsRequest {
        robot_id: "arm".to_owned(),
        ..Default::default()
    };
    let mut count = 0;
    let mut stream = match client(transport, &[&url]).stream_setpoints(request).await {
        Ok(stream) => stream,
        Err(error) => return (count, Err(error)),
    };
    loop {
        match stream.next().await {
            Ok(Some(chunk)) => count += chunk.setpoints.unwrap().time_s.len(),
            Ok(None) => return (count, Ok(())),
            Err(error) => return (count, Err(error)),
        }
    }
}

#[tokio::test]
async fn a_stream_without_all_its_set_points_does_not_end_well() {
    for transport in BOTH {
        let (count, end) = taken(transport, "whole").await;
        assert_eq!(count, 5);
        assert!(end.is_ok(), "{end:?}");
        let (count, end) = taken(transport, "short").await;
        assert_eq!((count, end.unwrap_err().kind()), (2, ErrorKind::Transport));
        for (fault, before) in [("gap", 2), ("twice", 2), ("headless", 0)] {
            let (count, end) = taken(transport, fault).await;
            assert_eq!((count, end.unwrap_err().code()), (before, Code::Internal), "{fault}");
        }
    }
}
