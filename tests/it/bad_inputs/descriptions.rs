//! Descriptions of arms that cannot be.

use takt_proto::v1::{
    DhLink, DhTable, Drive, Frame, Friction, JointDescription, JointLimits, JointType, Payload, Pose,
    RegisterRobotRequest, RobotDescription, Tool, friction::Side,
};
use takt_tests::fixtures::two_joints;

use super::{AND_MORE, CONFLICT, Row, fits};

const NAN: f64 = f64::NAN;
const INF: f64 = f64::INFINITY;

fn registration() -> RegisterRobotRequest {
    RegisterRobotRequest {
        robot_id: "arm".to_owned(),
        description: Some(two_joints(5.0)),
        ..Default::default()
    }
}

fn request(name: &str, change: impl FnOnce(&mut RegisterRobotRequest), fields: &[&str]) -> Row {
    let mut request = registration();
    change(&mut request);
    Row::message(&format!("description: {name}"), &request, fields)
}

/// A change of the description; the fields are below it.
pub(super) fn row(name: &str, change: impl FnOnce(&mut RobotDescription), fields: &[&str]) -> Row {
    let fields: Vec<String> = fields
        .iter()
        .map(|field| match *field {
            AND_MORE => AND_MORE.to_owned(),
            field => format!("description.{field}"),
        })
        .collect();
    let fields: Vec<&str> = fields.iter().map(String::as_str).collect();
    request(name, |m| change(m.description.get_or_insert_default()), &fields)
}

fn table(description: &mut RobotDescription) -> &mut DhTable {
    description.dh.get_or_insert_default()
}

fn link(name: &str, change: impl FnOnce(&mut DhLink), field: &str) -> Row {
    let field = format!("dh.links[1].{field}");
    row(&format!("link: {name}"), |d| change(&mut table(d).links[1]), &[&field])
}

fn limits(name: &str, change: impl FnOnce(&mut JointLimits), field: &str) -> Row {
    let field = format!("joints[1].limits.{field}");
    let change = |d: &mut RobotDescription| change(d.joints[1].limits.get_or_insert_default());
    row(&format!("limits: {name}"), change, &[&field])
}

fn drive(name: &str, change: impl FnOnce(&mut Drive), field: &str) -> Row {
    let field = format!("joints[1].drive.{field}");
    let change = |d: &mut RobotDescription| change(d.joints[1].drive.get_or_insert_default());
    row(&format!("drive: {name}"), change, &[&field])
}

fn friction(name: &str, change: impl FnOnce(&mut Friction), field: &str) -> Row {
    let mut friction = Friction {
        side: Side::Joint.into(),
        ..Default::default()
    };
    change(&mut friction);
    drive(&format!("friction: {name}"), |d| d.friction = vec![friction], field)
}

fn payload(name: &str, payload: Payload, field: &str) -> Row {
    row(&format!("payload: {name}"), |d| d.payload = Some(payload), &[field])
}

fn frame(name: &str) -> Frame {
    Frame {
        name: name.to_owned(),
        pose: Some(Pose::default()),
    }
}

pub(super) fn rows() -> Vec<Row> {
    let mut rows = wholes();
    rows.extend(links());
    rows.extend(joints());
    rows.extend(drives());
    rows.extend(surroundings());
    rows.extend(fits::rows());
    rows
}

fn wholes() -> Vec<Row> {
    vec![
        request("none", |m| m.description = None, &["description"]),
        request(
            "empty",
            |m| m.description = Some(RobotDescription::default()),
            &["description"],
        ),
        request(
            "robot without a name",
            |m| m.robot_id = "My Arm".to_owned(),
            &["robot_id"],
        ),
        request(
            "nothing is right",
            |m| {
                m.robot_id = "My Arm".to_owned();
                m.description = None;
            },
            &["robot_id", "description"],
        ),
        request(
            "another revision is expected",
            |m| m.expected_revision = Some("r1".to_owned()),
            &[],
        )
        .refused(CONFLICT),
        request(
            "no revision is expected",
            |m| m.expected_revision = Some(String::new()),
            &[],
        )
        .refused(CONFLICT),
        request(
            "another revision is expected, to validate",
            |m| {
                m.expected_revision = Some("r1".to_owned());
                m.validate_only = Some(true);
            },
            &[],
        )
        .refused(CONFLICT),
        row("a table and a URDF", |d| d.urdf = "<robot/>".to_owned(), &["dh"]),
        row(
            "a base link beside a table",
            |d| d.base_link = "base".to_owned(),
            &["base_link"],
        ),
        row(
            "a tip link beside a table",
            |d| d.tip_link = "tip".to_owned(),
            &["tip_link"],
        ),
        row("no links", |d| table(d).links.clear(), &["dh.links"]),
        row(
            "33 links",
            |d| {
                d.joints.clear();
                table(d).links = (0..33).map(numbered).collect();
            },
            &["dh.links"],
        ),
        row(
            "a convention that says nothing",
            |d| table(d).convention = 0,
            &["dh.convention"],
        ),
        unknown(
            "convention 3",
            |d| table(d).convention = 3,
            "/dh/convention",
            3,
            "dh.convention",
        ),
        unknown(
            "type -1",
            |d| table(d).links[0].r#type = -1,
            "/dh/links/0/type",
            -1,
            "dh.links[0].type",
        ),
        unknown(
            "type 17",
            |d| table(d).links[1].r#type = 17,
            "/dh/links/1/type",
            17,
            "dh.links[1].type",
        ),
    ]
}

fn numbered(index: usize) -> DhLink {
    DhLink {
        name: format!("joint_{index}"),
        r#type: JointType::Revolute.into(),
        mass_kg: 1.0,
        ..Default::default()
    }
}

/// No JSON writer writes an unknown value, so it is put in by hand.
fn unknown(name: &str, change: fn(&mut RobotDescription), pointer: &str, value: i32, field: &str) -> Row {
    let mut message = registration();
    if let Some(friction_at) = pointer.strip_suffix("/side") {
        assert!(friction_at.starts_with("/joints/0/drive"));
        message.description.get_or_insert_default().joints[0].drive = Some(Drive {
            friction: vec![Friction {
                side: Side::Motor.into(),
                ..Default::default()
            }],
            ..Default::default()
        });
    }
    let mut json = serde_json::to_value(&message).expect("a request can be written");
    let place = json["description"].pointer_mut(pointer).expect("the place is there");
    *place = value.into();
    change(message.description.get_or_insert_default());
    let field = format!("description.{field}");
    let json = json.to_string().into_bytes();
    Row::message_and_json(&format!("description: {name} *"), &message, json, &[&field])
}

fn links() -> Vec<Row> {
    vec![
        link("no name", |l| l.name.clear(), "name"),
        link("a megabyte of name", |l| l.name = "x".repeat(1 << 20), "name"),
        link("the name of the other", |l| l.name = "a".to_owned(), "name"),
        link("no type", |l| l.r#type = 0, "type"),
        link("turning for ever", |l| l.r#type = JointType::Continuous.into(), "type"),
        link("length NaN", |l| l.a_m = NAN, "a_m"),
        link("length infinite", |l| l.a_m = INF, "a_m"),
        link("length in micrometres", |l| l.a_m = 4e5, "a_m"),
        link("offset 1e300", |l| l.d_m = 1e300, "d_m"),
        link("twist minus infinite", |l| l.alpha_rad = -INF, "alpha_rad"),
        link("angle 1e9", |l| l.theta_rad = 1e9, "theta_rad"),
        link("mass negative", |l| l.mass_kg = -1.0, "mass_kg"),
        link("mass NaN", |l| l.mass_kg = NAN, "mass_kg"),
        link("mass in micrograms", |l| l.mass_kg = 5e9, "mass_kg"),
        link(
            "center of two",
            |l| l.center_of_mass_m = vec![0.0; 2],
            "center_of_mass_m",
        ),
        link("center NaN", |l| l.center_of_mass_m[2] = NAN, "center_of_mass_m[2]"),
        link(
            "center 1e200",
            |l| l.center_of_mass_m[0] = -1e200,
            "center_of_mass_m[0]",
        ),
        link("inertia of nine", |l| l.inertia_kg_m2 = vec![0.1; 9], "inertia_kg_m2"),
        link("inertia infinite", |l| l.inertia_kg_m2[3] = INF, "inertia_kg_m2[3]"),
        link("inertia in g mm²", |l| l.inertia_kg_m2[0] = 1e12, "inertia_kg_m2[0]"),
    ]
}

fn joints() -> Vec<Row> {
    let named = |name: &str| JointDescription {
        name: name.to_owned(),
        ..Default::default()
    };
    vec![
        row(
            "joint: not there",
            |d| d.joints[1].name = "c".to_owned(),
            &["joints[1].name"],
        ),
        row("joint: no name", |d| d.joints[1].name.clear(), &["joints[1].name"]),
        row(
            "joint: twice",
            |d| d.joints[1].name = "a".to_owned(),
            &["joints[1].name"],
        ),
        row(
            "joint: a megabyte of name",
            |d| d.joints[1].name = "é".repeat(1 << 19),
            &["joints[1].name"],
        ),
        row(
            "joint: a thousand and one",
            |d| d.joints = vec![named("a"); 1001],
            &["joints"],
        ),
        row(
            "joint: a hundred that are not there",
            |d| d.joints = (0..100).map(|index| named(&format!("j{index}"))).collect(),
            &["joints[0].name", "joints[1].name", AND_MORE],
        ),
        limits("speed 0", |l| l.velocity = Some(0.0), "velocity"),
        limits("speed negative", |l| l.velocity = Some(-3.0), "velocity"),
        limits("speed NaN", |l| l.velocity = Some(NAN), "velocity"),
        limits("speed infinite", |l| l.velocity = Some(INF), "velocity"),
        limits("acceleration 1e12", |l| l.acceleration = Some(1e12), "acceleration"),
        limits("deceleration 0", |l| l.deceleration = Some(0.0), "deceleration"),
        limits("jerk infinite", |l| l.jerk = Some(INF), "jerk"),
        limits(
            "preset acceleration negative",
            |l| l.preset_acceleration = Some(-1.0),
            "preset_acceleration",
        ),
        limits(
            "preset deceleration NaN",
            |l| l.preset_deceleration = Some(NAN),
            "preset_deceleration",
        ),
        limits(
            "lower position infinite",
            |l| l.position_lower = Some(-INF),
            "position_lower",
        ),
        limits("upper position 1e9", |l| l.position_upper = Some(1e9), "position_upper"),
        limits(
            "lower above upper",
            |l| {
                l.position_lower = Some(1.0);
                l.position_upper = Some(-1.0);
            },
            "position_lower",
        ),
    ]
}

fn drives() -> Vec<Row> {
    vec![
        drive("torque 0", |d| d.peak_torque = Some(0.0), "peak_torque"),
        drive("torque negative", |d| d.peak_torque = Some(-10.0), "peak_torque"),
        drive("torque infinite", |d| d.peak_torque = Some(INF), "peak_torque"),
        drive("rated torque NaN", |d| d.rated_torque = Some(NAN), "rated_torque"),
        drive("gear ratio 0", |d| d.gear_ratio = Some(0.0), "gear_ratio"),
        drive("gear ratio 1e9", |d| d.gear_ratio = Some(-1e9), "gear_ratio"),
        drive("gear ratio NaN", |d| d.gear_ratio = Some(NAN), "gear_ratio"),
        drive(
            "rotor negative",
            |d| d.rotor_inertia_kg_m2 = Some(-1e-4),
            "rotor_inertia_kg_m2",
        ),
        drive(
            "rotor 1e300",
            |d| d.rotor_inertia_kg_m2 = Some(1e300),
            "rotor_inertia_kg_m2",
        ),
        drive(
            "torque constant 0",
            |d| d.torque_constant_nm_per_a = Some(0.0),
            "torque_constant_nm_per_a",
        ),
        drive("stiffness of nine terms", |d| d.stiffness = vec![1.0; 9], "stiffness"),
        drive("stiffness 0", |d| d.stiffness = vec![0.0], "stiffness[0]"),
        drive("stiffness NaN", |d| d.stiffness = vec![1.0, NAN], "stiffness[1]"),
        drive("damping negative", |d| d.damping = Some(-1.0), "damping"),
        friction("a side that says nothing", |f| f.side = 0, "friction[0].side"),
        friction("viscous negative", |f| f.viscous = Some(-1.0), "friction[0].viscous"),
        friction("viscous infinite", |f| f.viscous = Some(INF), "friction[0].viscous"),
        friction(
            "Coulomb NaN",
            |f| f.coulomb_positive = Some(NAN),
            "friction[0].coulomb_positive",
        ),
        friction(
            "Coulomb negative",
            |f| f.coulomb_negative = Some(-2.0),
            "friction[0].coulomb_negative",
        ),
        friction(
            "load Coulomb negative",
            |f| f.load_coulomb = Some(-0.1),
            "friction[0].load_coulomb",
        ),
        friction(
            "load Coulomb in percent of percent",
            |f| f.load_coulomb = Some(101.0),
            "friction[0].load_coulomb",
        ),
        friction("quadratic NaN", |f| f.quadratic = Some(NAN), "friction[0].quadratic"),
        friction(
            "quadratic negative",
            |f| f.quadratic = Some(-1.0),
            "friction[0].quadratic",
        ),
        friction(
            "presliding stiffness 0",
            |f| f.presliding_stiffness = Some(0.0),
            "friction[0].presliding_stiffness",
        ),
        drive(
            "friction: twice the same side",
            |d| {
                d.friction = vec![
                    Friction {
                        side: Side::Motor.into(),
                        ..Default::default()
                    };
                    2
                ];
            },
            "friction[1].side",
        ),
        unknown(
            "friction on side 9",
            |d| {
                d.joints[0].drive = Some(Drive {
                    friction: vec![Friction {
                        side: 9,
                        ..Default::default()
                    }],
                    ..Default::default()
                });
            },
            "/joints/0/drive/friction/0/side",
            9,
            "joints[0].drive.friction[0].side",
        ),
    ]
}

fn surroundings() -> Vec<Row> {
    let heavy = |mass_kg: f64| Payload {
        mass_kg: Some(mass_kg),
        ..Default::default()
    };
    let tool = |position_m: Vec<f64>, orientation: Vec<f64>| Tool {
        tcp: Some(Pose {
            position_m,
            orientation,
        }),
    };
    vec![
        row(
            "gravity of two",
            |d| d.gravity_m_per_s2 = vec![0.0, -9.81],
            &["gravity_m_per_s2"],
        ),
        row(
            "gravity NaN",
            |d| d.gravity_m_per_s2 = vec![0.0, NAN, 0.0],
            &["gravity_m_per_s2[1]"],
        ),
        row(
            "gravity in mm/s²",
            |d| d.gravity_m_per_s2 = vec![0.0, 0.0, -9806.65],
            &["gravity_m_per_s2"],
        ),
        row(
            "gravity 1e200",
            |d| d.gravity_m_per_s2 = vec![1e200; 3],
            &["gravity_m_per_s2"],
        ),
        payload("no mass", Payload::default(), "payload.mass_kg"),
        payload("mass negative", heavy(-2.0), "payload.mass_kg"),
        payload("mass infinite", heavy(INF), "payload.mass_kg"),
        payload("mass 1e12", heavy(1e12), "payload.mass_kg"),
        payload(
            "inertia without mass",
            Payload {
                inertia_kg_m2: vec![0.1, 0.1, 0.1, 0.0, 0.0, 0.0],
                ..heavy(0.0)
            },
            "payload.inertia_kg_m2",
        ),
        payload(
            "center of four",
            Payload {
                center_of_mass_m: vec![0.0; 4],
                ..heavy(1.0)
            },
            "payload.center_of_mass_m",
        ),
        row(
            "tool position NaN",
            |d| d.tool = Some(tool(vec![0.0, 0.0, NAN], vec![])),
            &["tool.tcp.position_m[2]"],
        ),
        row(
            "tool position 1e9",
            |d| d.tool = Some(tool(vec![1e9, 0.0, 0.0], vec![])),
            &["tool.tcp.position_m[0]"],
        ),
        row(
            "tool orientation zero",
            |d| d.tool = Some(tool(vec![], vec![0.0; 4])),
            &["tool.tcp.orientation"],
        ),
        row(
            "tool orientation of three",
            |d| d.tool = Some(tool(vec![], vec![1.0; 3])),
            &["tool.tcp.orientation"],
        ),
        row(
            "frame without a name",
            |d| d.frames = vec![frame("")],
            &["frames[0].name"],
        ),
        row(
            "frame twice",
            |d| d.frames = vec![frame("table"), frame("table")],
            &["frames[1].name"],
        ),
        row(
            "frame without a pose",
            |d| {
                d.frames = vec![Frame {
                    name: "table".to_owned(),
                    pose: None,
                }];
            },
            &["frames[0].pose"],
        ),
        row(
            "frame with a megabyte of name",
            |d| d.frames = vec![frame(&"x".repeat(1 << 20))],
            &["frames[0].name"],
        ),
        row(
            "a thousand and one frames",
            |d| d.frames = (0..1001).map(|index| frame(&index.to_string())).collect(),
            &["frames"],
        ),
    ]
}
