//! The checker's torques against published arms in other engines (`tests/vectors/robots/README.md`).

mod arms;

use arms::{Case, numbers};
use nalgebra::Vector3;
use serde_json::Value;
use takt_checker::{Arm, Workspace};
use takt_motion::robot::spec::RobotSpec;

/// Largest difference over the largest entry. The engines agree among themselves to 3e-15; sums over a chain round more.
const AGREEMENT: f64 = 1e-12;

/// Entries smaller than this are as good as none, N m: the floor that the oracle files use.
const SMALLEST: f64 = 1e-6;

struct Trial {
    arm: Arm,
    workspace: Workspace,
    worst: f64,
}

impl Trial {
    fn of(arm: Arm) -> Self {
        Self {
            arm,
            workspace: Workspace::default(),
            worst: 0.0,
        }
    }

    fn rigid(&mut self, q: &[f64], qd: &[f64], qdd: &[f64]) -> Vec<f64> {
        let mut tau = vec![0.0; q.len()];
        self.arm.rigid_torque(&mut self.workspace, q, qd, qdd, &mut tau);
        tau
    }

    fn compare(&mut self, found: &[f64], expected: &Value, what: &str) {
        let expected = numbers(expected);
        assert_eq!(found.len(), expected.len());
        let largest = expected.iter().fold(SMALLEST, |most: f64, value| most.max(value.abs()));
        for (joint, (found, expected)) in found.iter().zip(&expected).enumerate() {
            let difference = (found - expected).abs() / largest;
            assert!(
                difference <= AGREEMENT,
                "{what}, joint {joint}: {found}, the oracle has {expected}"
            );
            self.worst = self.worst.max(difference);
        }
    }
}

fn states(oracle: &Value) -> &[Value] {
    oracle["states"].as_array().expect("the file has states")
}

fn check(case: &Case) {
    let payload = arms::payload(&case.oracle).expect("the file has a payload");
    let mut bare = Trial::of(Arm::new(&case.spec, None));
    let mut weightless = Trial::of(Arm::new(
        &RobotSpec {
            gravity: Vector3::zeros(),
            ..case.spec.clone()
        },
        None,
    ));
    let mut loaded = Trial::of(Arm::new(&case.spec, Some(&payload)));
    for state in states(&case.oracle) {
        let [q, qd, qdd] = ["q", "qd", "qdd"].map(|key| numbers(&state[key]));
        let still = vec![0.0; q.len()];
        for (trial, suffix) in [(&mut bare, ""), (&mut loaded, "_payload")] {
            let tau = trial.rigid(&q, &qd, &qdd);
            trial.compare(&tau, &state[format!("tau{suffix}")], "torque");
            let gravity = trial.rigid(&q, &still, &still);
            trial.compare(&gravity, &state[format!("tau_gravity{suffix}")], "gravity torque");
        }
        let bias = bare.rigid(&q, &qd, &still);
        bare.compare(&bias, &state["tau_bias"], "bias torque");
        let matrix = state["mass_matrix"].as_array().expect("a matrix");
        for joint in 0..q.len() {
            let mut unit = still.clone();
            unit[joint] = 1.0;
            let column = weightless.rigid(&q, &still, &unit);
            // The matrix is symmetric: its rows are its columns.
            weightless.compare(&column, &matrix[joint], "mass matrix");
        }
    }
    report(&[bare, loaded, weightless]);
}

/// Shown with `--nocapture`.
#[allow(clippy::print_stdout, reason = "a test's own output")]
fn report(trials: &[Trial]) {
    let worst = trials.iter().map(|trial| trial.worst).fold(0.0, f64::max);
    println!("largest relative difference {worst:.1e}");
}

fn check_puma(case: &Case) {
    let mut trial = Trial::of(Arm::new(&case.spec, None));
    for state in states(&case.oracle) {
        let [q, qd, qdd] = ["q", "qd", "qdd"].map(|key| numbers(&state[key]));
        let mut tau = trial.rigid(&q, &qd, &qdd);
        trial.compare(&tau, &state["tau_rigid"], "rigid-body torque");
        trial.arm.rotor_torque(&qdd, &mut tau);
        trial.compare(&tau, &state["tau_rotor"], "rotor torque");
        let Trial { arm, workspace, .. } = &mut trial;
        arm.friction_torque(workspace, &q, &qd, &mut tau);
        trial.compare(&tau, &state["tau_friction"], "friction torque");
        let Trial { arm, workspace, .. } = &mut trial;
        arm.drive_torque(workspace, &q, &qd, &qdd, &qd, &mut tau);
        trial.compare(&tau, &state["tau_total"], "drive torque");
    }
    report(&[trial]);
}

#[test]
fn ur5e() {
    check(&arms::from_urdf("ur5e", "ur5e.urdf", "oracle.json"));
}

#[test]
fn fr3() {
    check(&arms::from_urdf("fr3", "fr3.urdf", "oracle.json"));
}

#[test]
fn fr3_with_position_dependent_speed_limits() {
    check(&arms::from_urdf("fr3_position_limits", "fr3.urdf", "oracle.json"));
}

#[test]
fn panda() {
    check(&arms::from_urdf("panda", "fer.urdf", "oracle.json"));
}

#[test]
fn denso_scara() {
    check(&arms::from_urdf("denso_hsr065", "denso_hsr065.urdf", "oracle.json"));
}

#[test]
fn stretch_with_head_and_wheels_held_still() {
    check(&arms::from_urdf("stretch_re1", "stretch_re1.urdf", "oracle_chain.json"));
}

#[test]
fn puma560_with_its_drives_from_its_table() {
    check_puma(&arms::puma_from_table());
}

#[test]
fn puma560_with_its_drives_from_its_urdf() {
    check_puma(&arms::puma_from_urdf());
}

#[test]
fn puma560_has_what_the_literature_prints() {
    // The dynamics notebook of Corke's toolbox at pose qn, to four digits: gravity load, and the diagonal of the
    // inertia matrix with the rotors.
    let case = arms::puma_from_table();
    let mut trial = Trial::of(Arm::new(&case.spec, None));
    let [load, diagonal] = [0, 1].map(|index| &case.oracle["known_answers"][index]);
    let still = [0.0; 6];
    let gravity = trial.rigid(&numbers(&load["q"]), &still, &still);
    for (found, printed) in gravity.iter().zip(numbers(&load["published"])) {
        assert!((found - printed).abs() < 5e-3, "{found}, printed {printed}");
    }
    let q = numbers(&diagonal["q"]);
    for (joint, printed) in numbers(&diagonal["published"]).iter().enumerate() {
        let mut unit = still;
        unit[joint] = 1.0;
        let mut tau = still;
        let Trial { arm, workspace, .. } = &mut trial;
        arm.drive_torque(workspace, &q, &still, &unit, &still, &mut tau);
        let found = tau[joint] - gravity[joint];
        assert!((found - printed).abs() < 5e-4 * printed, "{found}, printed {printed}");
    }
}
