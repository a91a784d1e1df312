use super::*;
use crate::test_arms::random;

fn residual(nu: f64) -> Residual {
    Residual {
        deviation: 0.3,
        correlation_time: 0.2,
        degrees_of_freedom: nu,
    }
}

/// A standard normal number (Box and Muller).
fn gauss(state: &mut u64) -> f64 {
    let uniform = 0.5 * (random(state) + 1.0);
    let angle = std::f64::consts::PI * random(state);
    (-2.0 * libm::log(uniform.max(1e-300))).sqrt() * libm::cos(angle)
}

#[test]
fn bands_are_those_of_the_normal_and_of_students_distribution() {
    // SciPy 1.17.1: norm.isf(0.025), and t.isf(0.025, 5)/sqrt(5/3), which is larger from about 97 % on alone
    let normal = Width::at_sample(0.95, &residual(f64::INFINITY));
    assert!((normal.band(0.4) - 1.9599639845400545 * 0.5).abs() < 1e-12);
    let student = Width::at_sample(0.999, &residual(5.0));
    let expected = 6.868826625877123 * (3.0_f64 / 5.0).sqrt() * 0.5;
    let raised = student.band(0.4) / expected - 1.0;
    assert!((raised - MIXTURE_RESERVE).abs() < 1e-9, "{raised}");
}

#[test]
fn bands_grow_with_the_level_the_joints_and_the_duration() {
    for nu in [2.5, 5.0, f64::INFINITY] {
        let mut before = [0.0; 2];
        for level in [0.6, 0.8, 0.95, 0.99, 0.9999] {
            let sample = Width::at_sample(level, &residual(nu)).band(0.2);
            let moved = Width::over_move(level, &residual(nu), 6, 1.0, 2.0).band(0.2);
            assert!(
                sample > before[0] && moved > before[1] && moved > sample,
                "{nu} {level}"
            );
            before = [sample, moved];
        }
        let one = Width::over_move(0.95, &residual(nu), 6, 1.0, 2.0).band(0.2);
        assert!(Width::over_move(0.95, &residual(nu), 7, 1.0, 2.0).band(0.2) > one);
        assert!(Width::over_move(0.95, &residual(nu), 6, 1.1, 2.0).band(0.2) > one);
        assert!(Width::over_move(0.95, &residual(nu), 6, 1.0, 2.1).band(0.2) > one);
    }
}

#[test]
fn samples_of_the_sum_leave_their_band_as_seldom_as_it_says() {
    const DRAWS: usize = 100_000;
    let state = &mut 5;
    for nu in [3.0_f64, 5.0] {
        for deviation in [0.0, 0.1, 0.3, 1.0] {
            for level in [0.6, 0.9, 0.97, 0.99] {
                let width = Width::at_sample(level, &residual(nu));
                let band = width.band(deviation);
                let outside = (0..DRAWS)
                    .filter(|_| {
                        let square: f64 = (0..nu as usize).map(|_| gauss(state)).map(|z| z * z).sum();
                        let student = gauss(state) / (square / nu).sqrt() * ((nu - 2.0) / nu).sqrt();
                        (deviation * gauss(state) + 0.3 * student).abs() > band
                    })
                    .count();
                // four deviations of the binomial count above what is allowed
                let allowed = DRAWS as f64 * (1.0 - level);
                assert!(
                    (outside as f64) < allowed + 4.0 * (allowed * level).sqrt(),
                    "{nu} {deviation} {level}: {outside} of {allowed}"
                );
            }
        }
    }
}
