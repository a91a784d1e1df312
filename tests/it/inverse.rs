//! Inverse kinematics over both protocols: what comes back gives the pose that was asked for.

use takt_client::v1;
use takt_tests::{
    Protocol, TestServer,
    compare::assert_close,
    fixtures::{example, good_target},
};

/// Joint positions of the example arms, inside their ranges and away from singularities.
const CONFIGURATIONS: [(&str, &[f64]); 4] = [
    ("ur5e", &[0.3, -1.2, 1.4, -1.7, -1.3, 0.4]),
    ("puma560", &[0.4, 0.5, -0.6, 0.3, 0.7, -0.4]),
    ("scara", &[-0.5, 0.9, 0.12, 0.6]),
    ("fr3", &[0.2, -0.7, 0.3, -2.1, 0.2, 1.7, 0.6]),
];

#[tokio::test]
async fn every_solution_gives_the_pose_and_one_is_where_it_came_from() {
    let server = TestServer::start().await;
    for protocol in Protocol::BOTH {
        let client = server.client(protocol);
        for (robot_id, position) in CONFIGURATIONS {
            let state = |position: &[f64]| v1::JointPosition {
                position: position.to_vec(),
            };
            let poses = |states| v1::ForwardKinematicsRequest {
                robot_id: robot_id.to_owned(),
                states,
                ..Default::default()
            };
            let there = client.forward_kinematics(poses(vec![state(position)])).await.unwrap();
            let pose = there.results[0].pose.clone().unwrap();
            let request = v1::InverseKinematicsRequest {
                robot_id: robot_id.to_owned(),
                targets: vec![v1::PoseTarget {
                    pose: Some(pose.clone()),
                    frame: None,
                }],
                reference: Some(state(position)),
                ..Default::default()
            };
            let reply = client.inverse_kinematics(request).await.unwrap();
            assert!(!reply.provenance.unwrap().request_hash.is_empty());
            let result = &reply.results[0];
            assert!(result.out_of_reach.is_none(), "{robot_id}");
            assert_close(robot_id, &result.solutions[0].position, position, 1e-6);
            let found = result.solutions.iter().map(|solution| state(&solution.position));
            let back = client.forward_kinematics(poses(found.collect())).await.unwrap();
            for other in back.results {
                let other = other.pose.unwrap();
                assert_close(robot_id, &other.position_m, &pose.position_m, 1e-7);
                // Where w is 0 either sign is the same rotation.
                let same: f64 = other
                    .orientation
                    .iter()
                    .zip(&pose.orientation)
                    .map(|(a, b)| a * b)
                    .sum();
                assert!(same.abs() >= 1.0 - 1e-9, "{robot_id}: {other:?}");
            }
        }
    }
}

#[tokio::test]
async fn a_pose_out_of_reach_has_the_evidence_and_others_their_answers() {
    let server = TestServer::start().await;
    for protocol in Protocol::BOTH {
        let client = server.client(protocol);
        let mut request = good_target();
        let far = v1::Pose {
            position_m: vec![5.0, 0.0, 0.3],
            ..Default::default()
        };
        request.targets.push(v1::PoseTarget {
            pose: Some(far),
            frame: None,
        });
        let reply = client.inverse_kinematics(request).await.unwrap();
        let [reached, missed] = &reply.results[..] else {
            panic!("{} results", reply.results.len());
        };
        assert!(reached.solutions.len() > 1 && reached.method.is_some());
        let nearest = missed.out_of_reach.as_ref().unwrap();
        assert!(missed.solutions.is_empty());
        assert_eq!(nearest.nearest_position.len(), 6);
        // The arm is less than a metre long.
        assert!(nearest.missing_m > 3.5, "{nearest:?}");
    }
}

#[tokio::test]
async fn frames_tools_and_turns_are_what_they_are_called() {
    let server = TestServer::start().await;
    let mut description = example("ur5e");
    let table = v1::Pose {
        position_m: vec![0.4, 0.2, 0.0],
        orientation: vec![],
    };
    description.frames = vec![v1::Frame {
        name: "table".to_owned(),
        pose: Some(table),
    }];
    for protocol in Protocol::BOTH {
        let client = server.client(protocol);
        let register = v1::RegisterRobotRequest {
            robot_id: "cell".to_owned(),
            description: Some(description.clone()),
            ..Default::default()
        };
        client.register_robot(register).await.unwrap();
        let solve = async |request: v1::InverseKinematicsRequest| {
            let reply = client.inverse_kinematics(request).await.unwrap();
            reply.results[0].solutions.clone()
        };
        let plain = solve(good_target()).await;
        let pose = |height_m: f64| v1::Pose {
            position_m: vec![0.0, 0.0, height_m],
            orientation: vec![0.0, 1.0, 0.0, 0.0],
        };
        let on_table = |height_m: f64, length_m: f64| v1::InverseKinematicsRequest {
            robot_id: "cell".to_owned(),
            targets: vec![v1::PoseTarget {
                pose: Some(pose(height_m)),
                frame: Some("table".to_owned()),
            }],
            tool: (length_m > 0.0).then(|| v1::Tool {
                tcp: Some(v1::Pose {
                    position_m: vec![0.0, 0.0, length_m],
                    orientation: vec![],
                }),
            }),
            ..Default::default()
        };
        let framed = solve(on_table(0.3, 0.0)).await;
        assert_close("in the frame", &framed[0].position, &plain[0].position, 1e-9);
        // The tool points down: a longer one reaches a lower point from the same place.
        let longer = solve(on_table(0.2, 0.1)).await;
        assert_close("with the tool", &longer[0].position, &plain[0].position, 1e-9);
        let turned = v1::InverseKinematicsRequest {
            all_turns: Some(true),
            ..good_target()
        };
        let turned = solve(turned).await;
        // Every joint of this arm has two turns, but for the elbow with its one.
        assert!(turned.len() > 8 * plain.len(), "{} of {}", turned.len(), plain.len());
    }
}
