use super::*;
use nalgebra::UnitQuaternion;

fn rebuilt(b: &Rotation3<f64>) -> Matrix3<f64> {
    let (a, alpha, c) = zxz_angles(b);
    let z = |angle| Rotation3::from_axis_angle(&Vector3::z_axis(), angle);
    let x = Rotation3::from_axis_angle(&Vector3::x_axis(), alpha);
    (z(a) * x * z(c)).into_inner()
}

#[test]
fn zxz_angles_rebuild_any_rotation() {
    for k in 0..500 {
        let t = f64::from(k);
        let b = UnitQuaternion::from_euler_angles(t * 0.37, t * 0.73 - 9.0, t * 1.11).to_rotation_matrix();
        assert!((rebuilt(&b) - b.matrix()).abs().max() < 1e-15 * 4.0);
    }
}

#[test]
fn zxz_angles_rebuild_parallel_opposite_and_nearly_parallel_axes() {
    for tilt in [
        0.0,
        2e-10,
        1e-300,
        1e-16,
        std::f64::consts::PI,
        std::f64::consts::PI - 2e-10,
    ] {
        for turn in [0.0, 0.4, -2.0, std::f64::consts::PI] {
            let b = Rotation3::from_axis_angle(&Vector3::y_axis(), tilt)
                * Rotation3::from_axis_angle(&Vector3::z_axis(), turn);
            assert!(
                (rebuilt(&b) - b.matrix()).abs().max() < 1e-15,
                "tilt {tilt}, turn {turn}: {}",
                rebuilt(&b) - b.matrix()
            );
        }
    }
}

#[test]
fn a_rotation_onto_an_axis_is_proper_and_ends_there() {
    for axis in [
        Vector3::new(0.0, 0.0, -1.0),
        Vector3::new(1.0, 0.0, 0.0),
        Vector3::new(0.0, -1.0, 0.0),
        Vector3::new(0.6, -0.64, 0.48),
    ] {
        let turn = rotation_onto(axis);
        assert!((turn * Vector3::z() - axis).norm() < 1e-15);
        assert!((turn.matrix().determinant() - 1.0).abs() < 1e-15);
    }
}
