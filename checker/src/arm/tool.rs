//! Where the tool centre point is and how it moves, in base axes.
//!
//! It is fixed to the last moving link, whose origin, angular velocity ω, angular acceleration α, velocity v and
//! acceleration a are known. With r from that origin to the tool centre point, in base axes,
//!
//! ```text
//! p = o + r        ṗ = v + ω × r        p̈ = a + α × r + ω × (ω × r)
//! ```

use nalgebra::{Isometry3, Matrix3, Vector3};
use takt_motion::robot::spec::RobotSpec;

use super::{Arm, Workspace};

/// A tool centre point on the last moving link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tool {
    /// In the last moving link's frame, m.
    offset: Vector3<f64>,
    /// Its axes in the last moving link's frame.
    axes: Matrix3<f64>,
}

/// The tool centre point at one moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ToolMotion {
    /// m.
    pub position: Vector3<f64>,
    /// The tool's axes, in columns.
    pub axes: Matrix3<f64>,
    /// m/s.
    pub velocity: Vector3<f64>,
    /// Of the tool, rad/s.
    pub angular_velocity: Vector3<f64>,
    /// m/s².
    pub acceleration: Vector3<f64>,
}

impl Tool {
    /// The tool centre point whose pose in the tip link's frame is `tcp`; `None`: the description's own.
    #[must_use]
    pub fn new(spec: &RobotSpec, tcp: Option<&Isometry3<f64>>) -> Self {
        let tcp = tcp.unwrap_or(&spec.tcp);
        let tip = &spec.link_from_tip;
        let axes = tip.rotation.to_rotation_matrix().into_inner();
        Self {
            offset: tip.translation.vector + axes * tcp.translation.vector,
            axes: axes * tcp.rotation.to_rotation_matrix().into_inner(),
        }
    }
}

impl Arm {
    /// The tool centre point in one state of the joints, whose lists are in model order.
    pub fn tool_motion(
        &self,
        workspace: &mut Workspace,
        tool: &Tool,
        q: &[f64],
        qd: &[f64],
        qdd: &[f64],
    ) -> ToolMotion {
        self.move_links(workspace, q, qd, qdd);
        let Some(link) = workspace.links.last() else {
            // Without joints the last link is the base.
            return ToolMotion {
                position: tool.offset,
                axes: tool.axes,
                velocity: Vector3::zeros(),
                angular_velocity: Vector3::zeros(),
                acceleration: Vector3::zeros(),
            };
        };
        let arm = link.axes * tool.offset;
        let swept = link.angular_velocity.cross(&arm);
        ToolMotion {
            position: link.origin + arm,
            axes: link.axes * tool.axes,
            velocity: link.velocity + swept,
            angular_velocity: link.angular_velocity,
            acceleration: link.acceleration
                + link.angular_acceleration.cross(&arm)
                + link.angular_velocity.cross(&swept),
        }
    }
}
