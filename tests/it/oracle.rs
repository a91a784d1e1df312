//! Dynamics and kinematics of published arms against other engines (`tests/vectors/robots/README.md`), through the
//! server and over both protocols.

use serde_json::Value;
use takt_client::{Client, v1};
use takt_tests::{
    Protocol, TestServer,
    compare::assert_close,
    fixtures::{json, numbers, text},
};

/// The engines agree among themselves to 3e-15; this is what the service promises.
const TOLERANCE: f64 = 1e-9;

const FOLDER: &str = "tests/vectors/robots";

/// An arm as it is registered, and the values that other engines computed for it.
struct Case {
    description: v1::RobotDescription,
    oracle: Value,
}

impl Case {
    /// The chain that an oracle file names, out of a URDF.
    fn urdf(folder: &str, urdf: &str, oracle: &str) -> Self {
        let oracle = json(&format!("{FOLDER}/{folder}/{oracle}"));
        let link = |key: &str| oracle[key].as_str().expect("the oracle names its links").to_owned();
        let description = v1::RobotDescription {
            urdf: text(&format!("{FOLDER}/{folder}/{urdf}")),
            base_link: link("root_link"),
            tip_link: link("tip_link"),
            gravity_m_per_s2: numbers(&oracle["gravity"]),
            ..Default::default()
        };
        Self { description, oracle }
    }

    /// The PUMA with its drives, from its table or from its URDF.
    fn puma(from_table: bool) -> Self {
        let file = json(&format!("{FOLDER}/puma560/puma560.json"));
        let links = file["links"].as_array().expect("the file has links");
        let mut case = Self::urdf("puma560", "puma560.urdf", "oracle.json");
        case.description.joints = links.iter().map(puma_joint).collect();
        if from_table {
            let description = &mut case.description;
            for text in [
                &mut description.urdf,
                &mut description.base_link,
                &mut description.tip_link,
            ] {
                text.clear();
            }
            description.dh = Some(v1::DhTable {
                convention: v1::dh_table::Convention::Standard.into(),
                links: links.iter().map(puma_link).collect(),
            });
        }
        case
    }

    fn states(&self) -> &[Value] {
        self.oracle["states"].as_array().expect("the oracle has states")
    }

    fn payload(&self) -> Option<v1::Payload> {
        let payload = self.oracle.get("payload")?;
        // The files have [xx xy xz yy yz zz], the wire xx yy zz xy xz yz.
        let [xx, xy, xz, yy, yz, zz] = numbers(&payload["inertia"])[..] else {
            panic!("an inertia tensor has six entries");
        };
        Some(v1::Payload {
            mass_kg: payload["mass"].as_f64(),
            center_of_mass_m: numbers(&payload["com"]),
            inertia_kg_m2: vec![xx, yy, zz, xy, xz, yz],
        })
    }
}

fn puma_link(link: &Value) -> v1::DhLink {
    let number = |key: &str| link[key].as_f64().unwrap_or(0.0);
    // The file has [xx yy zz xy yz xz].
    let [xx, yy, zz, xy, yz, xz] = numbers(&link["inertia"])[..] else {
        panic!("an inertia tensor has six entries");
    };
    v1::DhLink {
        name: name(link),
        r#type: v1::JointType::Revolute.into(),
        a_m: number("a"),
        alpha_rad: number("alpha"),
        d_m: number("d"),
        theta_rad: number("theta"),
        mass_kg: number("mass"),
        center_of_mass_m: numbers(&link["com"]),
        inertia_kg_m2: vec![xx, yy, zz, xy, xz, yz],
    }
}

fn puma_joint(link: &Value) -> v1::JointDescription {
    let number = |key: &str| link[key].as_f64();
    let coulomb = numbers(&link["coulomb"]);
    v1::JointDescription {
        name: name(link),
        limits: None,
        drive: Some(v1::Drive {
            gear_ratio: number("gear_ratio"),
            rotor_inertia_kg_m2: number("rotor_inertia"),
            friction: vec![v1::Friction {
                side: v1::friction::Side::Motor.into(),
                viscous: number("viscous"),
                coulomb_positive: Some(coulomb[0]),
                coulomb_negative: Some(-coulomb[1]),
                ..Default::default()
            }],
            ..Default::default()
        }),
    }
}

fn name(link: &Value) -> String {
    link["joint"].as_str().expect("a joint has a name").to_owned()
}

/// One arm at a server, asked over one protocol.
struct Asked<'a> {
    client: Client,
    case: &'a Case,
}

impl Asked<'_> {
    /// What the service says of every state; `fields` of it are sent.
    async fn dynamics(&self, fields: &[&str], payload: Option<v1::Payload>) -> Vec<v1::InverseDynamicsResult> {
        use v1::inverse_dynamics_request::Quantity;
        let states = self.case.states().iter().map(|state| {
            let field = |key: &str| match fields.contains(&key) {
                true => numbers(&state[key]),
                false => Vec::new(),
            };
            v1::JointState {
                position: field("q"),
                velocity: field("qd"),
                acceleration: field("qdd"),
            }
        });
        let request = v1::InverseDynamicsRequest {
            robot_id: "arm".to_owned(),
            states: states.collect(),
            payload,
            r#return: vec![Quantity::MassMatrix.into(), Quantity::Jacobian.into()],
            ..Default::default()
        };
        let reply = self
            .client
            .inverse_dynamics(request)
            .await
            .expect("the request is right");
        assert_eq!(reply.results.len(), self.case.states().len());
        reply.results
    }

    /// Asserts that a quantity is the oracle's in every state.
    fn compare<'r>(
        &self,
        results: &'r [v1::InverseDynamicsResult],
        key: &str,
        quantity: impl Fn(&'r v1::InverseDynamicsResult) -> &'r [f64],
    ) {
        for (index, (result, state)) in results.iter().zip(self.case.states()).enumerate() {
            let expected = numbers(&state[key]);
            assert_close(
                &format!("{key} of state {index}"),
                quantity(result),
                &expected,
                TOLERANCE,
            );
        }
    }

    async fn check_poses(&self) {
        let states = self.case.states().iter().map(|state| v1::JointPosition {
            position: numbers(&state["q"]),
        });
        let request = v1::ForwardKinematicsRequest {
            robot_id: "arm".to_owned(),
            states: states.collect(),
            ..Default::default()
        };
        let reply = self
            .client
            .forward_kinematics(request)
            .await
            .expect("the request is right");
        assert_eq!(reply.results.len(), self.case.states().len());
        for (result, state) in reply.results.iter().zip(self.case.states()) {
            let pose = result.pose.as_ref().expect("a result has a pose");
            assert_close(
                "tip position",
                &pose.position_m,
                &numbers(&state["tip_position"]),
                TOLERANCE,
            );
            let rotation = rotation_matrix(&pose.orientation);
            assert_close("tip rotation", &rotation, &numbers(&state["tip_rotation"]), TOLERANCE);
        }
    }

    /// An arm without drives: the rigid bodies alone, with and without the oracle's payload.
    async fn check_rigid_bodies(&self) {
        let bare = self.dynamics(&["q", "qd", "qdd"], None).await;
        self.compare(&bare, "tau", |result| &result.torque);
        self.compare(&bare, "tau", |result| &result.rigid_torque);
        self.compare(&bare, "tau_gravity", |result| &result.gravity_torque);
        self.compare(&bare, "mass_matrix", |result| &result.mass_matrix);
        self.compare(&bare, "mass_matrix", |result| &result.rigid_mass_matrix);
        self.compare(&bare, "jacobian", |result| &result.jacobian);
        let unaccelerated = self.dynamics(&["q", "qd"], None).await;
        self.compare(&unaccelerated, "tau_bias", |result| &result.torque);
        let still = self.dynamics(&["q"], None).await;
        self.compare(&still, "tau_gravity", |result| &result.torque);
        let payload = self.case.payload().expect("the oracle has a payload");
        let loaded = self.dynamics(&["q", "qd", "qdd"], Some(payload)).await;
        self.compare(&loaded, "tau_payload", |result| &result.torque);
        self.compare(&loaded, "tau_gravity_payload", |result| &result.gravity_torque);
    }

    /// An arm with drives: every part of the torque by itself.
    async fn check_drives(&self) {
        let results = self.dynamics(&["q", "qd", "qdd"], None).await;
        self.compare(&results, "tau_rigid", |result| &result.rigid_torque);
        self.compare(&results, "tau_gravity", |result| &result.gravity_torque);
        self.compare(&results, "tau_rotor", |result| &result.rotor_torque);
        self.compare(&results, "tau_friction", |result| &result.friction_torque);
        self.compare(&results, "tau_total", |result| &result.torque);
        self.compare(&results, "mass_matrix_rigid", |result| &result.rigid_mass_matrix);
        self.compare(&results, "mass_matrix_total", |result| &result.mass_matrix);
        self.compare(&results, "jacobian", |result| &result.jacobian);
    }
}

/// Row by row, of a quaternion x y z w.
fn rotation_matrix(quaternion: &[f64]) -> [f64; 9] {
    let [x, y, z, w] = *quaternion else {
        panic!("a quaternion has four entries: {quaternion:?}");
    };
    assert!(w >= 0.0, "{quaternion:?}");
    [
        w * w + x * x - y * y - z * z,
        2.0 * (x * y - w * z),
        2.0 * (x * z + w * y),
        2.0 * (x * y + w * z),
        w * w - x * x + y * y - z * z,
        2.0 * (y * z - w * x),
        2.0 * (x * z - w * y),
        2.0 * (y * z + w * x),
        w * w - x * x - y * y + z * z,
    ]
}

async fn check(case: Case) {
    let server = TestServer::with(takt_server::Config::default()).await;
    let registration = v1::RegisterRobotRequest {
        robot_id: "arm".to_owned(),
        description: Some(case.description.clone()),
        ..Default::default()
    };
    let client = server.client(Protocol::Grpc);
    client.register_robot(registration).await.expect("the arm is sound");
    for protocol in Protocol::BOTH {
        let asked = Asked {
            client: server.client(protocol),
            case: &case,
        };
        asked.check_poses().await;
        if case.payload().is_some() {
            asked.check_rigid_bodies().await;
        } else {
            asked.check_drives().await;
        }
    }
}

#[tokio::test]
async fn ur5e() {
    check(Case::urdf("ur5e", "ur5e.urdf", "oracle.json")).await;
}

#[tokio::test]
async fn fr3() {
    check(Case::urdf("fr3", "fr3.urdf", "oracle.json")).await;
}

#[tokio::test]
async fn fr3_with_position_dependent_speed_limits() {
    check(Case::urdf("fr3_position_limits", "fr3.urdf", "oracle.json")).await;
}

#[tokio::test]
async fn panda() {
    check(Case::urdf("panda", "fer.urdf", "oracle.json")).await;
}

#[tokio::test]
async fn denso_scara() {
    check(Case::urdf("denso_hsr065", "denso_hsr065.urdf", "oracle.json")).await;
}

#[tokio::test]
async fn stretch_with_head_and_wheels_held_still() {
    check(Case::urdf("stretch_re1", "stretch_re1.urdf", "oracle_chain.json")).await;
}

#[tokio::test]
async fn puma_with_its_drives_from_its_table() {
    check(Case::puma(true)).await;
}

#[tokio::test]
async fn puma_with_its_drives_from_its_urdf() {
    check(Case::puma(false)).await;
}
