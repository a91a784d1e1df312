use nalgebra::{Isometry3, Matrix3, Quaternion, UnitQuaternion, Vector3};

use crate::robot::bounds::{MAX_FRAMES, MAX_JOINT_ENTRIES};
use crate::robot::description::{Description, DhConvention, DhLink, DriveEntry, FrictionEntry, JointEntry, Kinematics};
use crate::robot::rotation;
use crate::robot::spec::{Drive, Friction, Inertial, JointKind, Limits};

/// Two joints, of which the first has everything that a URDF can state, the second nothing.
const URDF: &str = "<robot name='r'>
<link name='base'/>
<link name='upper'><inertial><mass value='2'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>
<link name='lower'><inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>
<joint name='shoulder' type='revolute'><parent link='base'/><child link='upper'/>
  <limit lower='-1' upper='1' effort='10' velocity='2'/><dynamics damping='0.5' friction='0.25'/></joint>
<joint name='elbow' type='continuous'><parent link='upper'/><child link='lower'/></joint>
</robot>";

fn description() -> Description {
    Description {
        use_urdf_dynamics: true,
        ..Description::new(Kinematics::Urdf {
            text: URDF.to_owned(),
            base_link: None,
            tip_link: None,
        })
    }
}

fn entry(name: &str, limits: Limits, drive: DriveEntry) -> JointEntry {
    JointEntry {
        name: name.to_owned(),
        limits,
        drive,
    }
}

fn refused(description: &Description) -> Vec<String> {
    let errors = description.resolve().expect_err("should be refused");
    errors.iter().map(ToString::to_string).collect()
}

fn check_warned(description: &Description, part: &str) {
    let warnings = description.resolve().unwrap().warnings;
    assert!(
        warnings.iter().any(|warning| warning.contains(part)),
        "{part:?} in {warnings:#?}"
    );
}

#[test]
fn defaults_are_the_designs() {
    let spec = description().resolve().unwrap().spec;
    assert_eq!(spec.gravity, Vector3::new(0.0, 0.0, -9.80665));
    assert_eq!(spec.payload, Inertial::zero());
    assert_eq!(spec.tcp, Isometry3::identity());
    let elbow = &spec.joints[1];
    assert_eq!(elbow.limits, Limits::default());
    assert_eq!(elbow.drive, Drive::default());
}

#[test]
fn what_is_unknown_is_warned_of() {
    let resolved = description().resolve().unwrap();
    assert_eq!(
        resolved.warnings,
        [
            "joint \"elbow\": peak torque unknown, its torque is not checked",
            "joint \"elbow\": speed limit unknown, a request must bring one",
            "joint \"elbow\": neither torque nor acceleration limit known, a move is refused unless it brings one",
        ]
    );
}

#[test]
fn an_entry_takes_the_place_of_what_the_urdf_states() {
    let mut description = description();
    let limits = Limits {
        position_lower: Some(-0.5),
        velocity: Some(1.5),
        acceleration: Some(9.0),
        ..Limits::default()
    };
    let drive = DriveEntry {
        rated_torque: Some(4.0),
        gear_ratio: Some(-62.6),
        rotor_inertia: Some(2e-4),
        motor_friction: Some(FrictionEntry {
            coulomb_positive: Some(0.4),
            ..FrictionEntry::default()
        }),
        joint_friction: Some(FrictionEntry {
            coulomb_negative: Some(0.75),
            ..FrictionEntry::default()
        }),
        stiffness: vec![1e4, -10.0],
        ..DriveEntry::default()
    };
    description.joints = vec![entry("shoulder", limits, drive)];
    let spec = description.resolve().unwrap().spec;
    let shoulder = &spec.joints[0];
    assert_eq!(
        shoulder.limits,
        Limits {
            position_upper: Some(1.0),
            ..limits
        }
    );
    assert_eq!(
        shoulder.drive,
        Drive {
            peak_torque: Some(10.0),
            rated_torque: Some(4.0),
            gear_ratio: -62.6,
            rotor_inertia: 2e-4,
            motor_friction: Friction {
                viscous: 0.0,
                coulomb_positive: 0.4,
                coulomb_negative: 0.4,
                ..Friction::default()
            },
            joint_friction: Friction {
                viscous: 0.5,
                coulomb_positive: 0.25,
                coulomb_negative: 0.75,
                ..Friction::default()
            },
            stiffness: vec![1e4, -10.0],
            ..Drive::default()
        }
    );
}

#[test]
fn entries_must_name_each_joint_once() {
    let mut description = description();
    description.joints = ["elbow", "Elbow", "elbow"]
        .map(|name| entry(name, Limits::default(), DriveEntry::default()))
        .to_vec();
    assert_eq!(
        refused(&description),
        [
            "joints[1].name: \"Elbow\" is not a joint of the chain: \"shoulder\", \"elbow\"",
            "joints[2].name: \"elbow\" is the name of joints[0] too",
        ]
    );
    description.joints = vec![entry("elbow", Limits::default(), DriveEntry::default()); MAX_JOINT_ENTRIES + 1];
    assert_eq!(refused(&description), ["joints: 1001 entries must be at most 1000"]);
}

#[test]
fn a_range_on_a_continuous_joint_makes_it_revolute() {
    let mut description = description();
    let limits = Limits {
        position_lower: Some(-3.0),
        position_upper: Some(3.0),
        ..Limits::default()
    };
    description.joints = vec![entry("elbow", limits, DriveEntry::default())];
    assert_eq!(description.resolve().unwrap().spec.joints[1].kind, JointKind::Revolute);
    check_warned(
        &description,
        "continuous in the URDF, revolute with the position limits",
    );
}

#[test]
fn a_range_that_crosses_the_urdfs_is_refused_where_it_was_stated() {
    for (lower, upper, field) in [
        (Some(1.5), None, "position_lower"),
        (None, Some(-1.5), "position_upper"),
        (Some(1.5), Some(-1.5), "position_lower"),
    ] {
        let mut description = description();
        let limits = Limits {
            position_lower: lower,
            position_upper: upper,
            ..Limits::default()
        };
        description.joints = vec![entry("shoulder", limits, DriveEntry::default())];
        let errors = refused(&description);
        assert_eq!(errors.len(), 1);
        assert!(
            errors[0].starts_with(&format!("joints[0].limits.{field}: lower limit")),
            "{errors:?}"
        );
    }
}

#[test]
fn every_number_out_of_bounds_is_named_at_once() {
    let nan = Some(f64::NAN);
    let mut description = description();
    let limits = Limits {
        position_lower: nan,
        position_upper: Some(1e6),
        velocity: Some(0.0),
        acceleration: Some(-1.0),
        deceleration: Some(f64::INFINITY),
        jerk: Some(1e13),
        preset_acceleration: Some(0.0),
        preset_deceleration: nan,
    };
    let friction = Some(FrictionEntry {
        viscous: Some(-1.0),
        coulomb_positive: nan,
        coulomb_negative: Some(1e10),
        load_coulomb: Some(-0.1),
        quadratic: Some(f64::INFINITY),
        presliding_stiffness: Some(0.0),
    });
    let drive = DriveEntry {
        peak_torque: Some(0.0),
        rated_torque: Some(-1.0),
        gear_ratio: Some(0.0),
        rotor_inertia: Some(-1e-4),
        motor_friction: friction,
        joint_friction: friction,
        torque_constant: Some(0.0),
        stiffness: vec![0.0, f64::NAN],
        damping: Some(-1.0),
    };
    description.joints = vec![entry("elbow", limits, drive)];
    description.gravity = Some(Vector3::new(0.0, f64::NAN, 0.0));
    description.payload = Some(Inertial {
        mass: -1.0,
        center_of_mass: Vector3::new(0.0, 0.0, 1e6),
        inertia: Matrix3::from_diagonal_element(f64::NAN),
    });
    description.tcp = Some(Isometry3::from_parts(
        Vector3::new(f64::INFINITY, 0.0, 0.0).into(),
        UnitQuaternion::new_unchecked(Quaternion::new(0.0, 0.0, 0.0, 0.5)),
    ));
    let paths: Vec<String> = description
        .resolve()
        .unwrap_err()
        .into_iter()
        .map(|error| error.path)
        .collect();
    assert_eq!(
        paths,
        [
            "joints[0].limits.position_lower",
            "joints[0].limits.position_upper",
            "joints[0].limits.velocity",
            "joints[0].limits.acceleration",
            "joints[0].limits.deceleration",
            "joints[0].limits.jerk",
            "joints[0].limits.preset_acceleration",
            "joints[0].limits.preset_deceleration",
            "joints[0].drive.peak_torque",
            "joints[0].drive.rated_torque",
            "joints[0].drive.rotor_inertia_kg_m2",
            "joints[0].drive.torque_constant_nm_per_a",
            "joints[0].drive.damping",
            "joints[0].drive.gear_ratio",
            "joints[0].drive.motor_friction.viscous",
            "joints[0].drive.motor_friction.coulomb_positive",
            "joints[0].drive.motor_friction.coulomb_negative",
            "joints[0].drive.motor_friction.load_coulomb",
            "joints[0].drive.motor_friction.quadratic",
            "joints[0].drive.motor_friction.presliding_stiffness",
            "joints[0].drive.joint_friction.viscous",
            "joints[0].drive.joint_friction.coulomb_positive",
            "joints[0].drive.joint_friction.coulomb_negative",
            "joints[0].drive.joint_friction.load_coulomb",
            "joints[0].drive.joint_friction.quadratic",
            "joints[0].drive.joint_friction.presliding_stiffness",
            "joints[0].drive.stiffness[1]",
            "joints[0].drive.stiffness[0]",
            "gravity_m_per_s2[1]",
            "payload.mass_kg",
            "payload.center_of_mass_m[2]",
            "payload.inertia_kg_m2[0]",
            "payload.inertia_kg_m2[1]",
            "payload.inertia_kg_m2[2]",
            "tool.tcp.position_m[0]",
            "tool.tcp.orientation",
        ]
    );
}

#[test]
fn friction_may_grow_less_and_less_but_not_fall_within_the_speed_limit() {
    let of = |velocity, quadratic, gear_ratio| {
        let friction = Some(FrictionEntry {
            viscous: Some(4.0),
            quadratic: Some(quadratic),
            ..FrictionEntry::default()
        });
        let limits = Limits {
            velocity,
            ..Limits::default()
        };
        let drive = DriveEntry {
            gear_ratio: Some(gear_ratio),
            motor_friction: friction,
            joint_friction: friction,
            ..DriveEntry::default()
        };
        let mut description = description();
        description.joints = vec![entry("elbow", limits, drive)];
        description
    };
    of(Some(2.0), -1.0, 1.0).resolve().unwrap();
    let errors = refused(&of(Some(2.0), -1.001, 1.0));
    assert_eq!(errors.len(), 2);
    assert!(
        errors[1].starts_with("joints[0].drive.joint_friction.quadratic: -1.001 must be at least -1.0"),
        "{errors:?}"
    );
    let errors = refused(&of(Some(2.0), -0.5, -4.0));
    assert_eq!(errors.len(), 1);
    assert!(
        errors[0].starts_with("joints[0].drive.motor_friction.quadratic: -0.5 must be at least -0.25"),
        "{errors:?}"
    );
}

#[test]
fn entries_are_checked_beside_a_broken_urdf() {
    let mut description = description();
    description.kinematics = Kinematics::Urdf {
        text: "<robot".to_owned(),
        base_link: None,
        tip_link: None,
    };
    let limits = Limits {
        velocity: Some(-1.0),
        ..Limits::default()
    };
    description.joints = vec![entry("elbow", limits, DriveEntry::default())];
    let errors = refused(&description);
    assert_eq!(errors.len(), 2);
    assert!(errors[0].starts_with("urdf: not well-formed XML"), "{errors:?}");
    assert!(errors[1].starts_with("joints[0].limits.velocity"), "{errors:?}");
}

#[test]
fn gravity_may_be_zero_but_not_a_hundred_times_the_earths() {
    let mut description = description();
    description.gravity = Some(Vector3::zeros());
    description.resolve().unwrap();
    description.gravity = Some(Vector3::new(0.0, -1000.0, 0.0));
    description.resolve().unwrap();
    description.gravity = Some(Vector3::new(0.0, -1000.0, 100.0));
    assert!(refused(&description)[0].starts_with("gravity_m_per_s2: 1004.98"));
}

#[test]
fn a_payload_may_be_a_point_but_not_inertia_without_mass() {
    let mut description = description();
    let mut payload = Inertial {
        mass: 5.0,
        ..Inertial::zero()
    };
    description.payload = Some(payload);
    assert!(
        !description
            .resolve()
            .unwrap()
            .warnings
            .iter()
            .any(|warning| warning.contains("payload"))
    );
    payload.inertia = Matrix3::from_diagonal(&Vector3::new(0.1, 0.1, 0.3));
    description.payload = Some(payload);
    check_warned(&description, "payload: principal moments");
    payload.mass = 0.0;
    description.payload = Some(payload);
    assert_eq!(
        refused(&description),
        ["payload.inertia_kg_m2: must be zero where mass_kg is 0"]
    );
}

#[test]
fn frames_have_names_of_their_own() {
    let mut description = description();
    let frame = |name: &str| (name.to_owned(), Isometry3::identity());
    description.frames = vec![frame("table"), frame(""), frame("table")];
    description.frames[1].1 = rotation::pose(Vector3::new(0.0, 1e9, 0.0), UnitQuaternion::identity());
    assert_eq!(
        refused(&description),
        [
            "frames[1].name: must not be empty",
            "frames[1].pose.position_m[1]: 1000000000.0 m must be at most 100000.0 m",
            "frames[2].name: \"table\" is the name of frames[0] too",
        ]
    );
    description.frames = vec![frame("table"); MAX_FRAMES + 1];
    assert_eq!(refused(&description), ["frames: 1001 frames must be at most 1000"]);
}

#[test]
fn odd_combinations_are_warned_of() {
    let mut description = description();
    let limits = Limits {
        acceleration: Some(5.0),
        preset_acceleration: Some(6.0),
        preset_deceleration: Some(7.0),
        ..Limits::default()
    };
    let drive = DriveEntry {
        rated_torque: Some(11.0),
        ..DriveEntry::default()
    };
    description.joints = vec![entry("shoulder", limits, drive)];
    check_warned(&description, "rated torque 11.0 is above peak torque 10.0");
    check_warned(&description, "preset acceleration 6.0 is above its limit 5.0");
    check_warned(&description, "preset deceleration 7.0 is above its limit 5.0");
    let Kinematics::Urdf { text, .. } = &mut description.kinematics else {
        unreachable!()
    };
    *text = URDF.replace("value='2'", "value='4879'");
    check_warned(&description, "weigh 4880.0 kg");
}

#[test]
fn a_dh_table_takes_its_limits_and_drives_from_entries() {
    let mut description = description();
    description.kinematics = Kinematics::Dh {
        convention: DhConvention::Modified,
        links: vec![DhLink {
            name: "j".to_owned(),
            prismatic: true,
            a: 0.0,
            alpha: 0.0,
            d: 0.5,
            theta: 0.0,
            mass: 1.0,
            center_of_mass: Vector3::zeros(),
            inertia: Matrix3::identity(),
        }],
    };
    let limits = Limits {
        position_upper: Some(0.3),
        velocity: Some(1.0),
        ..Limits::default()
    };
    let drive = DriveEntry {
        peak_torque: Some(900.0),
        ..DriveEntry::default()
    };
    description.joints = vec![entry("j", limits, drive)];
    let resolved = description.resolve().unwrap();
    assert_eq!(resolved.warnings, ["use_urdf_dynamics says nothing to a DH table"]);
    assert_eq!(resolved.spec.joints[0].limits, limits);
    assert_eq!(resolved.spec.joints[0].drive.peak_torque, Some(900.0));
}
