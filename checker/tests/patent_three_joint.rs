//! The closed form of a three-joint arm, JP4358979B2 eq 9 to 32, term by term, against general dynamics.
//!
//! The arm (fig. 2): joint 1 turns about the vertical, joints 2 and 3 about parallel horizontal axes; z1 points up, x2
//! along the second link, y2 up when the link is level, and a positive angle of joint 2 raises the arm. `a1` is the way
//! from axis 1 to axis 2, `a2` from axis 2 to axis 3. The printed terms hold for a rigid arm with my1 = my2 = mz3 = 0,
//! Ixy2 = Ixz2 = Iyz2 = Ixz3 = Iyz3 = 0 and Ixy3 = +∫xy dm, so that the entry of the inertia tensor is −Ixy3. Gravity
//! enters eq 1 as G(θ)·g with g pointing up, [0, 0, +9.8]: eq 98 prints the other sign. G has a column for each
//! direction of g. The values of table 3 are lost; those below are of a size that fits an arm of half a metre a link.

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};
use takt_checker::draw::Draw;
use takt_checker::{Arm, Workspace};
use takt_motion::dynamics;
use takt_motion::robot::Robot;
use takt_motion::robot::spec::{Drive, Inertial, JointKind, JointSpec, Limits, RobotSpec};

/// Largest difference over the largest entry: roundings alone.
const AGREEMENT: f64 = 1e-12;

/// Parameters of table 3 that the printed terms use, with mz1 and Ix1, Iy1 beside, which they rightly leave out.
struct Parameters {
    a1: f64,
    a2: f64,
    m1: f64,
    m2: f64,
    m3: f64,
    mx1: f64,
    mz1: f64,
    mx2: f64,
    mz2: f64,
    mx3: f64,
    my3: f64,
    ix1: f64,
    iy1: f64,
    iz1: f64,
    ix2: f64,
    iy2: f64,
    iz2: f64,
    ix3: f64,
    iy3: f64,
    iz3: f64,
    ixy3: f64,
}

const ARM: Parameters = Parameters {
    a1: 0.16,
    a2: 0.55,
    m1: 21.0,
    m2: 12.5,
    m3: 9.2,
    mx1: 0.045,
    mz1: -0.11,
    mx2: 0.23,
    mz2: 0.085,
    mx3: 0.19,
    my3: 0.062,
    ix1: 0.41,
    iy1: 0.37,
    iz1: 0.29,
    ix2: 0.058,
    iy2: 0.63,
    iz2: 0.66,
    ix3: 0.047,
    iy3: 0.36,
    iz3: 0.38,
    ixy3: 0.021,
};

impl Parameters {
    /// Eq 9 to 18.
    fn inertia_matrix(&self, theta: [f64; 3]) -> Matrix3<f64> {
        let Self {
            a1,
            a2,
            m1,
            m2,
            m3,
            mx1,
            mx2,
            mz2,
            mx3,
            my3,
            ..
        } = *self;
        let Self {
            iz1,
            ix2,
            iy2,
            iz2,
            ix3,
            iy3,
            iz3,
            ixy3,
            ..
        } = *self;
        let [_, t2, t3] = theta;
        let t23 = t2 + t3;
        // eq 10
        let h11 = mx1.powi(2) * m1
            + (2.0 * a1 * mx2 * t2.cos() + 0.5 * mx2.powi(2) * (1.0 + (2.0 * t2).cos()) + a1.powi(2) + mz2.powi(2))
                * m2
            + (a1.powi(2)
                + 2.0 * (t2.cos() * a2 - my3 * t23.sin() + mx3 * t23.cos()) * a1
                + (-my3 * ((2.0 * t2 + t3).sin() + t3.sin()) + mx3 * ((2.0 * t2 + t3).cos() + t3.cos())) * a2
                - mx3 * my3 * (2.0 * t3 + 2.0 * t2).sin()
                + 0.5 * a2.powi(2) * (1.0 + (2.0 * t2).cos())
                - 0.5 * my3.powi(2) * ((2.0 * t3 + 2.0 * t2).cos() - 1.0)
                + 0.5 * mx3.powi(2) * ((2.0 * t3 + 2.0 * t2).cos() + 1.0))
                * m3
            + 0.5 * ix2 * (1.0 - (2.0 * t2).cos())
            + 0.5 * iy2 * (1.0 + (2.0 * t2).cos())
            + 0.5 * ix3 * (1.0 - (2.0 * t3 + 2.0 * t2).cos())
            + 0.5 * iy3 * ((2.0 * t3 + 2.0 * t2).cos() + 1.0)
            - ixy3 * (2.0 * t3 + 2.0 * t2).sin()
            + iz1;
        // eq 11, 12
        let h12 = -m2 * mz2 * mx2 * t2.sin();
        let h13 = 0.0;
        // eq 14, 15
        let h22 = m2 * mx2.powi(2)
            + (a2.powi(2) + 2.0 * (mx3 * t3.cos() - my3 * t3.sin()) * a2 + my3.powi(2) + mx3.powi(2)) * m3
            + iz3
            + iz2;
        let h23 = ((mx3 * t3.cos() - my3 * t3.sin()) * a2 + my3.powi(2) + mx3.powi(2)) * m3 + iz3;
        // eq 18
        let h33 = (my3.powi(2) + mx3.powi(2)) * m3 + iz3;
        // eq 13, 16, 17: symmetric
        Matrix3::new(h11, h12, h13, h12, h22, h23, h13, h23, h33)
    }

    /// Eq 19 to 22.
    fn velocity_torque(&self, theta: [f64; 3], rate: [f64; 3]) -> [f64; 3] {
        let Self {
            a1,
            a2,
            m2,
            m3,
            mx2,
            mz2,
            mx3,
            my3,
            ..
        } = *self;
        let Self {
            ix2,
            iy2,
            ix3,
            iy3,
            ixy3,
            ..
        } = *self;
        let [_, t2, t3] = theta;
        let [d1, d2, d3] = rate;
        let t23 = t2 + t3;
        let twice = 2.0 * t3 + 2.0 * t2;
        let elbow = 2.0 * t2 + t3;
        // eq 20
        let c1 = ((-mx2 * m2 * (mx2 * (2.0 * t2).sin() + 2.0 * a1 * t2.sin())
            + (-2.0 * a1 * (mx3 * t23.sin() + my3 * t23.cos() + a2 * t2.sin())
                - 2.0 * a2 * (mx3 * elbow.sin() + my3 * elbow.cos())
                - 2.0 * my3 * mx3 * twice.cos()
                + (my3.powi(2) - mx3.powi(2)) * twice.sin()
                - a2.powi(2) * (2.0 * t2).sin())
                * m3
            + (ix3 - iy3) * twice.sin()
            + (ix2 - iy2) * (2.0 * t2).sin()
            - 2.0 * ixy3 * twice.cos())
            * d2
            + (m3
                * (-2.0 * a1 * (my3 * t23.cos() + mx3 * t23.sin()) - 2.0 * my3 * mx3 * twice.cos()
                    + (my3.powi(2) - mx3.powi(2)) * twice.sin()
                    - a2 * (mx3 * (elbow.sin() + t3.sin()) + my3 * (elbow.cos() + t3.cos())))
                - 2.0 * ixy3 * twice.cos()
                - (iy3 - ix3) * twice.sin())
                * d3)
            * d1
            - m2 * mz2 * mx2 * t2.cos() * d2.powi(2);
        // eq 21
        let c2 = (0.5 * mx2 * m2 * (mx2 * (2.0 * t2).sin() + 2.0 * a1 * t2.sin())
            + 0.5 * (iy3 - ix3) * twice.sin()
            + 0.5 * (2.0 * t2).sin() * (iy2 - ix2)
            + ixy3 * twice.cos()
            + (a1 * (my3 * t23.cos() + mx3 * t23.sin())
                + a2 * (mx3 * elbow.sin() + my3 * elbow.cos())
                + 0.5 * a2.powi(2) * (2.0 * t2).sin()
                + 0.5 * (mx3.powi(2) - my3.powi(2)) * twice.sin()
                + my3 * mx3 * twice.cos()
                + a1 * a2 * t2.sin())
                * m3)
            * d1.powi(2)
            - 2.0 * m3 * a2 * (mx3 * t3.sin() + my3 * t3.cos()) * d2 * d3
            - m3 * a2 * (mx3 * t3.sin() + my3 * t3.cos()) * d3.powi(2);
        // eq 22
        let c3 = ((a1 * (my3 * t23.cos() + mx3 * t23.sin())
            + 0.5 * a2 * (mx3 * (elbow.sin() + t3.sin()) + my3 * (elbow.cos() + t3.cos()))
            + 0.5 * (mx3.powi(2) - my3.powi(2)) * twice.sin()
            + my3 * mx3 * twice.cos())
            * m3
            + 0.5 * (iy3 - ix3) * twice.sin()
            + ixy3 * twice.cos())
            * d1.powi(2)
            + m3 * a2 * (mx3 * t3.sin() + my3 * t3.cos()) * d2.powi(2);
        [c1, c2, c3]
    }

    /// Eq 23 to 32: row i times g is joint i's torque.
    fn gravity_matrix(&self, theta: [f64; 3]) -> Matrix3<f64> {
        let Self {
            a1,
            a2,
            m1,
            m2,
            m3,
            mx1,
            mx2,
            mz2,
            mx3,
            my3,
            ..
        } = *self;
        let [t1, t2, t3] = theta;
        let (plus, minus) = (t1 + t2, -t1 + t2);
        let (all, all_minus) = (t1 + t2 + t3, -t1 + t2 + t3);
        // eq 24
        let g11 = -t1.sin() * mx1 * m1 + (t1.cos() * mz2 - t1.sin() * a1 - 0.5 * mx2 * (plus.sin() - minus.sin())) * m2
            - t1.sin() * a1 * m3
            - 0.5
                * m3
                * ((plus.sin() - minus.sin()) * a2
                    + mx3 * (-all_minus.sin() + all.sin())
                    + my3 * (all.cos() - all_minus.cos()));
        // eq 25
        let g12 = t1.cos() * mx1 * m1
            + (t1.sin() * mz2 + t1.cos() * a1 + 0.5 * mx2 * (minus.cos() + plus.cos())) * m2
            + t1.cos() * a1 * m3
            + 0.5
                * m3
                * ((minus.cos() + plus.cos()) * a2
                    + mx3 * (all_minus.cos() + all.cos())
                    + my3 * (-all_minus.sin() - all.sin()));
        // eq 26
        let g13 = 0.0;
        // eq 27
        let g31 = 0.5 * m3 * (mx3 * (-all_minus.sin() - all.sin()) - my3 * (all_minus.cos() + all.cos()));
        // eq 28
        let g32 = 0.5 * m3 * (mx3 * (all.cos() - all_minus.cos()) - my3 * (-all_minus.sin() + all.sin()));
        // eq 29
        let g33 = m3 * (-my3 * (t2 + t3).sin() + mx3 * (t2 + t3).cos());
        // eq 30
        let g21 = 0.5 * mx2 * m2 * (-plus.sin() - minus.sin())
            + 0.5 * m3 * a2 * (-plus.sin() - minus.sin())
            + 0.5 * m3 * (mx3 * (-all_minus.sin() - all.sin()) - my3 * (all_minus.cos() + all.cos()));
        // eq 31
        let g22 = 0.5 * mx2 * m2 * (-minus.cos() + plus.cos())
            + 0.5 * m3 * a2 * (-minus.cos() + plus.cos())
            + 0.5 * m3 * (mx3 * (all.cos() - all_minus.cos()) - my3 * (-all_minus.sin() + all.sin()));
        // eq 32
        let g23 = m2 * mx2 * t2.cos() + t2.cos() * m3 * a2 + m3 * (-my3 * (t2 + t3).sin() + mx3 * (t2 + t3).cos());
        Matrix3::new(g11, g12, g13, g21, g22, g23, g31, g32, g33)
    }

    /// The same arm as a caller would describe it. `upwards` is the g of eq 1: the opposite of free fall.
    fn described(&self, upwards: Vector3<f64>) -> RobotSpec {
        // Level axes at θ = 0: x2 = x1, y2 = z1 (up), so z2 = −y1, and a positive angle lifts x2.
        let level = Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::FRAC_PI_2);
        let placed = |x: f64, rotation: Rotation3<f64>| {
            Isometry3::from_parts(
                Translation3::new(x, 0.0, 0.0),
                UnitQuaternion::from_rotation_matrix(&rotation),
            )
        };
        let joint = |name: &str, parent_from_joint, link| JointSpec {
            name: name.to_owned(),
            kind: JointKind::Revolute,
            parent_from_joint,
            axis: Vector3::z(),
            link,
            limits: Limits::default(),
            drive: Drive::default(),
        };
        let first = Inertial {
            mass: self.m1,
            center_of_mass: Vector3::new(self.mx1, 0.0, self.mz1),
            inertia: Matrix3::from_diagonal(&Vector3::new(self.ix1, self.iy1, self.iz1)),
        };
        let second = Inertial {
            mass: self.m2,
            center_of_mass: Vector3::new(self.mx2, 0.0, self.mz2),
            inertia: Matrix3::from_diagonal(&Vector3::new(self.ix2, self.iy2, self.iz2)),
        };
        let mut third = Inertial {
            mass: self.m3,
            center_of_mass: Vector3::new(self.mx3, self.my3, 0.0),
            inertia: Matrix3::from_diagonal(&Vector3::new(self.ix3, self.iy3, self.iz3)),
        };
        third.inertia[(0, 1)] = -self.ixy3;
        third.inertia[(1, 0)] = -self.ixy3;
        RobotSpec {
            joints: vec![
                joint("RJ1", Isometry3::identity(), first),
                joint("RJ2", placed(self.a1, level), second),
                joint("RJ3", placed(self.a2, Rotation3::identity()), third),
            ],
            link_from_tip: Isometry3::identity(),
            gravity: -upwards,
            payload: Inertial::zero(),
            tcp: Isometry3::identity(),
            frames: Vec::new(),
            uncertainty: None,
        }
    }
}

/// Rigid-body torque at (q, q̇, q̈) of one arm.
type Torque = Box<dyn FnMut([f64; 3], [f64; 3], [f64; 3]) -> [f64; 3]>;

/// The code on trial: makes such a torque of a description.
type Dynamics = fn(&RobotSpec) -> Torque;

const NONE: [f64; 3] = [0.0; 3];
const POSES: usize = 500;

fn draw_three(draw: &mut Draw, reach: f64) -> [f64; 3] {
    std::array::from_fn(|_| draw.between(-reach, reach))
}

fn assert_agree(found: &[f64], printed: &[f64], what: &str) {
    let largest = printed.iter().fold(1e-6, |most: f64, value| most.max(value.abs()));
    for (index, (found, printed)) in found.iter().zip(printed).enumerate() {
        let difference = (found - printed).abs() / largest;
        assert!(
            difference <= AGREEMENT,
            "{what}, entry {index}: {found} found, {printed} printed"
        );
    }
}

/// Columns of H, by unit accelerations of the arm at rest without gravity.
fn check_inertia_matrix(dynamics: Dynamics) {
    let mut torque = dynamics(&ARM.described(Vector3::zeros()));
    let mut draw = Draw::seeded(9);
    for _ in 0..POSES {
        let theta = draw_three(&mut draw, 4.0);
        let mut found = Matrix3::zeros();
        for column in 0..3 {
            let mut unit = NONE;
            unit[column] = 1.0;
            found.set_column(column, &torque(theta, NONE, unit).into());
        }
        let printed = ARM.inertia_matrix(theta);
        assert_agree(found.as_slice(), printed.as_slice(), "H");
    }
}

/// C, at constant velocity without gravity.
fn check_velocity_torque(dynamics: Dynamics) {
    let mut torque = dynamics(&ARM.described(Vector3::zeros()));
    let mut draw = Draw::seeded(19);
    for _ in 0..POSES {
        let theta = draw_three(&mut draw, 4.0);
        let rate = draw_three(&mut draw, 3.0);
        let printed = ARM.velocity_torque(theta, rate);
        assert_agree(&torque(theta, rate, NONE), &printed, "C");
    }
}

/// Columns of G, by gravity along each axis on the arm at rest.
fn check_gravity_matrix(dynamics: Dynamics) {
    let mut draw = Draw::seeded(23);
    let mut along: [Torque; 3] =
        std::array::from_fn(|axis| dynamics(&ARM.described(Matrix3::identity().column(axis).into_owned())));
    for _ in 0..POSES {
        let theta = draw_three(&mut draw, 4.0);
        let mut found = Matrix3::zeros();
        for (column, torque) in along.iter_mut().enumerate() {
            found.set_column(column, &torque(theta, NONE, NONE).into());
        }
        assert_agree(found.as_slice(), ARM.gravity_matrix(theta).as_slice(), "G");
    }
}

/// Eq 1 as a whole, with g = [0, 0, +9.8].
fn check_sum(dynamics: Dynamics) {
    let upwards = Vector3::new(0.0, 0.0, 9.8);
    let mut torque = dynamics(&ARM.described(upwards));
    let mut draw = Draw::seeded(1);
    for _ in 0..POSES {
        let theta = draw_three(&mut draw, 4.0);
        let rate = draw_three(&mut draw, 3.0);
        let second = draw_three(&mut draw, 20.0);
        let printed = ARM.inertia_matrix(theta) * Vector3::from(second)
            + Vector3::from(ARM.velocity_torque(theta, rate))
            + ARM.gravity_matrix(theta) * upwards;
        assert_agree(&torque(theta, rate, second), printed.as_slice(), "T");
    }
}

fn checker(spec: &RobotSpec) -> Torque {
    let arm = Arm::new(spec, None);
    let mut workspace = Workspace::default();
    Box::new(move |q, qd, qdd| {
        let mut tau = NONE;
        arm.rigid_torque(&mut workspace, &q, &qd, &qdd, &mut tau);
        tau
    })
}

fn planner(spec: &RobotSpec) -> Torque {
    let robot = Robot::new(spec.clone(), Vec::new()).expect("the arm is sound");
    let mut workspace = dynamics::Workspace::new(&robot);
    Box::new(move |q, qd, qdd| {
        let mut tau = NONE;
        dynamics::rigid_torque(&robot, &mut workspace, &q, &qd, &qdd, &mut tau);
        tau
    })
}

#[test]
fn checker_has_the_printed_inertia_matrix() {
    check_inertia_matrix(checker);
}

#[test]
fn checker_has_the_printed_velocity_torque() {
    check_velocity_torque(checker);
}

#[test]
fn checker_has_the_printed_gravity_matrix() {
    check_gravity_matrix(checker);
}

#[test]
fn checker_has_the_printed_sum() {
    check_sum(checker);
}

#[test]
fn planner_has_the_printed_inertia_matrix() {
    check_inertia_matrix(planner);
    let robot = Robot::new(ARM.described(Vector3::zeros()), Vec::new()).expect("the arm is sound");
    let mut workspace = dynamics::Workspace::new(&robot);
    let mut draw = Draw::seeded(56);
    for _ in 0..POSES {
        let theta = draw_three(&mut draw, 4.0);
        let mut found = [0.0; 9];
        dynamics::mass_matrix(&robot, &mut workspace, &theta, &mut found);
        assert_agree(&found, ARM.inertia_matrix(theta).as_slice(), "mass matrix");
    }
}

#[test]
fn planner_has_the_printed_velocity_torque() {
    check_velocity_torque(planner);
}

#[test]
fn planner_has_the_printed_gravity_matrix() {
    check_gravity_matrix(planner);
    let upwards = Vector3::new(0.0, 0.0, 9.8);
    let robot = Robot::new(ARM.described(upwards), Vec::new()).expect("the arm is sound");
    let mut workspace = dynamics::Workspace::new(&robot);
    let mut draw = Draw::seeded(33);
    for _ in 0..POSES {
        let theta = draw_three(&mut draw, 4.0);
        let mut found = NONE;
        dynamics::gravity_torque(&robot, &mut workspace, &theta, &mut found);
        let printed = ARM.gravity_matrix(theta) * upwards;
        assert_agree(&found, printed.as_slice(), "gravity torque");
    }
}

#[test]
fn planner_has_the_printed_sum() {
    check_sum(planner);
}

#[test]
fn a_raised_arm_is_held_from_below() {
    let tau = checker(&ARM.described(Vector3::new(0.0, 0.0, 9.8)))(NONE, NONE, NONE);
    assert!(tau[1] > 0.0, "level arm: joint 2 lifts with {} N m", tau[1]);
}

#[test]
fn the_sign_of_the_product_of_inertia_matters() {
    let theta = [0.3, 0.4, 0.5];
    let mut spec = ARM.described(Vector3::zeros());
    let right = checker(&spec)(theta, NONE, [1.0, 0.0, 0.0])[0];
    for entry in [(0, 1), (1, 0)] {
        spec.joints[2].link.inertia[entry] = ARM.ixy3;
    }
    let wrong = checker(&spec)(theta, NONE, [1.0, 0.0, 0.0])[0];
    let expected = 2.0 * ARM.ixy3 * (2.0_f64 * 0.9).sin();
    assert!((wrong - right - expected).abs() < 1e-13);
}
