//! What the drives of an arm would report: sines in every joint, with the torque that its bodies and a known friction take.

use takt_motion::{
    dynamics::{self, Workspace},
    robot::Robot,
};
use takt_proto::{
    convert::{self, Findings, Path},
    v1,
};

use crate::fixtures::example;

/// Friction of the telemetry, joint by joint: N m, and N m s/rad.
pub const COULOMB: [f64; 6] = [9.0, 8.0, 6.0, 2.0, 1.5, 1.0];
/// Viscous friction of the telemetry.
pub const VISCOUS: [f64; 6] = [12.0, 10.0, 8.0, 3.0, 2.5, 2.0];

/// The robot that the telemetry is of.
pub const ROBOT: &str = "ur5e";

/// Reports of the UR5e at 1 kHz.
#[derive(Debug)]
pub struct Reporter {
    robot: Robot,
    workspace: Workspace,
    names: Vec<String>,
    sent: u32,
}

impl Default for Reporter {
    fn default() -> Self {
        let mut findings = Findings::default();
        let wire = example(ROBOT);
        let description = convert::robot::description(&wire, Path::Root, &mut findings);
        let resolved = description.expect("the example is one").resolve().expect("it is sound");
        let names = resolved.spec.joints.iter().map(|joint| joint.name.clone());
        let names = names.collect();
        let robot = Robot::new(resolved.spec, Vec::new()).expect("it is a robot");
        Self {
            workspace: Workspace::new(&robot),
            robot,
            names,
            sent: 0,
        }
    }
}

impl Reporter {
    /// The next samples: position, velocity, and the motor's torque as seen from the joint.
    #[must_use]
    pub fn block(&mut self, samples: u32) -> v1::Telemetry {
        let columns = self.names.iter().map(|joint| v1::TelemetryColumns {
            joint: joint.clone(),
            ..Default::default()
        });
        let mut block = v1::Telemetry {
            time_s: Vec::new(),
            joints: columns.collect(),
        };
        for _ in 0..samples {
            let time = f64::from(self.sent) * 1e-3;
            self.sent += 1;
            block.time_s.push(time);
            let (mut q, mut qd, mut qdd) = ([0.0; 6], [0.0; 6], [0.0; 6]);
            for joint in 0..6 {
                // No two joints in step, and speeds from a standstill to 1.5 rad/s.
                let rate = 1.1 + 0.3 * [0.0, 1.0, 2.0, 3.0, 4.0, 5.0][joint];
                let (sin, cos) = (rate * time).sin_cos();
                q[joint] = [0.0, -1.2, 1.2, -1.5, -1.5, 0.0][joint] + 0.6 * sin;
                qd[joint] = 0.6 * rate * cos;
                qdd[joint] = -0.6 * rate * rate * sin;
            }
            let mut torque = [0.0; 6];
            dynamics::rigid_torque(&self.robot, &mut self.workspace, &q, &qd, &qdd, &mut torque);
            for (joint, columns) in block.joints.iter_mut().enumerate() {
                columns.position.push(q[joint]);
                columns.velocity.push(qd[joint]);
                let friction = COULOMB[joint] * qd[joint].signum() + VISCOUS[joint] * qd[joint];
                columns.torque.push(torque[joint] + friction);
            }
        }
        block
    }

    /// So many blocks of 100 ms.
    #[must_use]
    pub fn blocks(&mut self, count: usize) -> Vec<v1::Telemetry> {
        (0..count).map(|_| self.block(100)).collect()
    }
}
