use super::*;

const ANGLE_MAX: f64 = 1.0e6;

/// Angles of every size, and the hard ones: near multiples of π/2.
fn angles() -> Vec<f64> {
    let mut angles = vec![0.0, -0.0, 1e-300, -1e-9, 0.5, ANGLE_MAX, -ANGLE_MAX];
    for k in -4000..4000 {
        let near = f64::from(k) * std::f64::consts::FRAC_PI_2;
        angles.extend([near, near + 1e-9, near - 1e-3, near + 0.37]);
        angles.push(f64::from(k) * 250.0 * 0.999);
    }
    angles
}

#[test]
fn sine_and_cosine_agree_with_a_correctly_rounded_library() {
    for x in angles() {
        let (sin, cos) = x.sine_cosine();
        let (true_sin, true_cos) = libm::sincos(x);
        assert!((sin - true_sin).abs() <= 2.3e-16, "sin {x}: {sin} {true_sin}");
        assert!((cos - true_cos).abs() <= 2.3e-16, "cos {x}: {cos} {true_cos}");
    }
}

struct Side<'a>(&'a [f64]);

impl pulp::WithSimd for Side<'_> {
    type Output = Vec<(f64, f64)>;

    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let mut out = Vec::new();
        for chunk in self.0.chunks_exact(LANES_MAX) {
            for part in chunk.chunks_exact(S::F64_LANES) {
                let (sin, cos) = Lanes::load(simd, part).sine_cosine();
                let (mut sins, mut coss) = ([0.0; LANES_MAX], [0.0; LANES_MAX]);
                sin.store(&mut sins);
                cos.store(&mut coss);
                out.extend(sins.into_iter().zip(coss).take(S::F64_LANES));
            }
        }
        out
    }
}

#[test]
fn a_lane_has_the_bits_of_the_scalar() {
    let angles = angles();
    let side_by_side = pulp::Arch::new().dispatch(Side(&angles));
    assert!(!side_by_side.is_empty());
    for (x, (sin, cos)) in angles.iter().zip(side_by_side) {
        let alone = x.sine_cosine();
        assert_eq!(
            (sin.to_bits(), cos.to_bits()),
            (alone.0.to_bits(), alone.1.to_bits()),
            "{x}"
        );
    }
}
