//! One example request for every operation with a body. They fit the example robot `ur5e`.

use serde_json::{Value, json};
use takt_proto::route::Rpc;

/// The body of an example request.
pub(super) fn request(rpc: Rpc) -> Value {
    match rpc {
        Rpc::RegisterRobot => json!({"description": {
            "dh": {"convention": "STANDARD", "links": [
                {"name": "shoulder", "type": "REVOLUTE", "a_m": 0.4, "mass_kg": 8.0, "center_of_mass_m": [-0.2, 0.0, 0.0],
                 "inertia_kg_m2": [0.02, 0.15, 0.15, 0.0, 0.0, 0.0]},
                {"name": "elbow", "type": "REVOLUTE", "a_m": 0.3, "mass_kg": 4.0, "center_of_mass_m": [-0.15, 0.0, 0.0],
                 "inertia_kg_m2": [0.01, 0.05, 0.05, 0.0, 0.0, 0.0]},
            ]},
            "joints": [
                {"name": "shoulder", "limits": {"position_lower": -2.5, "position_upper": 2.5, "velocity": 4.0},
                 "drive": {"peak_torque": 120.0, "gear_ratio": 100.0, "rotor_inertia_kg_m2": 0.0001}},
                {"name": "elbow", "limits": {"position_lower": -2.5, "position_upper": 2.5, "velocity": 5.0},
                 "drive": {"peak_torque": 60.0, "gear_ratio": 80.0, "rotor_inertia_kg_m2": 0.00005}},
            ],
            "gravity_m_per_s2": [0.0, -9.80665, 0.0],
        }}),
        Rpc::PlanMove => json!({
            "start": {"position": [0.0, -1.57, 1.57, -1.57, -1.57, 0.0]},
            "target": {"position": [1.2, -1.0, 1.0, -1.2, -1.57, 0.5]},
            "payload": {"mass_kg": 2.0, "center_of_mass_m": [0.0, 0.0, 0.05]},
        }),
        Rpc::CheckTrajectory => json!({"trajectory": {"interpolation": "CUBIC", "points": [
            {"time_s": 0.0, "position": [0.0, -1.57, 1.57, -1.57, -1.57, 0.0], "velocity": [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]},
            {"time_s": 1.0, "position": [1.0, -1.2, 1.2, -1.57, -1.57, 0.3], "velocity": [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]},
        ]}}),
        Rpc::InverseDynamics => json!({
            "states": [{"position": [0.0, -1.57, 1.57, -1.57, -1.57, 0.0], "velocity": [0.5, 0.0, 0.0, 0.0, 0.0, 0.0]}],
            "return": ["MASS_MATRIX", "JACOBIAN"],
        }),
        Rpc::ForwardKinematics => json!({"states": [{"position": [0.0, -1.57, 1.57, -1.57, -1.57, 0.0]}]}),
        Rpc::PlanPath => path(),
        Rpc::PlanBatch => json!({
            "id": "move-1",
            "move": {
                "start": {"position": [0.0, -1.57, 1.57, -1.57, -1.57, 0.0]},
                "target": {"position": [1.2, -1.0, 1.0, -1.2, -1.57, 0.5]},
            },
        }),
        Rpc::StreamSetpoints => json!({
            "move": {
                "start": {"position": [0.0, -1.57, 1.57, -1.57, -1.57, 0.0]},
                "target": {"position": [1.2, -1.0, 1.0, -1.2, -1.57, 0.5]},
            },
            "sample_period_s": 0.008,
        }),
        Rpc::EstimateFriction => json!({
            "header": {"method": "LEAST_SQUARES", "half_life_s": 60.0, "report_period_s": 0.1},
        }),
        Rpc::FitDrive => recording(),
        Rpc::Rehearse => json!({
            "move": {
                "start": {"position": [0.0, -1.57, 1.57, -1.57, -1.57, 0.0]},
                "target": {"position": [1.2, -1.0, 1.0, -1.2, -1.57, 0.5]},
            },
            "friction": [{"coulomb_scale": 1.5, "viscous_scale": 1.5}],
            "settle_s": 0.5,
        }),
        Rpc::InverseKinematics => json!({
            "targets": [{"pose": {"position_m": [0.4, 0.2, 0.3], "orientation": [0.0, 1.0, 0.0, 0.0]}}],
            "reference": {"position": [0.0, -1.57, 1.57, -1.57, -1.57, 0.0]},
        }),
        Rpc::ListRobots | Rpc::GetRobot | Rpc::DeleteRobot | Rpc::ListRevisions => Value::Null,
    }
}

/// Too short to say anything: what a fit needs is in the answer.
fn recording() -> Value {
    let joint = |at: f64| json!({"position": [at, at + 0.001, at + 0.002], "torque": [0.5, 0.6, 0.7]});
    let joints: Vec<Value> = [0.0, -1.57, 1.57, -1.57, -1.57, 0.0].map(joint).into();
    json!({"motion": {"recording": {"time_s": [0.0, 0.01, 0.02], "joints": joints}, "scope": "FRICTION"}})
}

/// To a part, along a line to it, and back over a blended corner.
fn path() -> Value {
    let above = json!({"pose": {"position_m": [0.45, 0.1, 0.25], "orientation": [0.0, 1.0, 0.0, 0.0]}});
    let part = json!({"pose": {"position_m": [0.45, 0.1, 0.15], "orientation": [0.0, 1.0, 0.0, 0.0]}});
    json!({
        "start": {"position": [0.0, -1.57, 1.57, -1.57, -1.57, 0.0]},
        "segments": [
            {"joint": {"target": above}, "blend": {"radius_m": 0.03}},
            {"line": {"target": part}, "limits": {"tcp_velocity_m_per_s": 0.25}, "dwell_s": 0.2},
            {"line": {"target": above}, "blend": {"radius_m": 0.03}},
            {"joint": {"target": {"position": [0.0, -1.57, 1.57, -1.57, -1.57, 0.0]}}},
        ],
    })
}

/// Whether a body is a request of this operation.
#[cfg(test)]
pub(super) fn reads(rpc: Rpc, body: &str) -> bool {
    use takt_proto::v1;
    fn is<T: serde::de::DeserializeOwned>(body: &str) -> bool {
        serde_json::from_str::<T>(body).is_ok()
    }
    match rpc {
        Rpc::RegisterRobot => is::<v1::RegisterRobotRequest>(body),
        Rpc::PlanMove => is::<v1::PlanMoveRequest>(body),
        Rpc::CheckTrajectory => is::<v1::CheckTrajectoryRequest>(body),
        Rpc::InverseDynamics => is::<v1::InverseDynamicsRequest>(body),
        Rpc::ForwardKinematics => is::<v1::ForwardKinematicsRequest>(body),
        Rpc::PlanPath => is::<v1::PlanPathRequest>(body),
        Rpc::PlanBatch => is::<v1::PlanBatchRequest>(body),
        Rpc::StreamSetpoints => is::<v1::StreamSetpointsRequest>(body),
        Rpc::EstimateFriction => is::<v1::EstimateFrictionRequest>(body),
        Rpc::FitDrive => is::<v1::FitDriveRequest>(body),
        Rpc::Rehearse => is::<v1::RehearseRequest>(body),
        Rpc::InverseKinematics => is::<v1::InverseKinematicsRequest>(body),
        Rpc::ListRobots | Rpc::GetRobot | Rpc::DeleteRobot | Rpc::ListRevisions => body == "null",
    }
}
