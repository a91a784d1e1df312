//! What an encoder shows: the position with noise, rounded to whole steps. The same seed shows the same.

/// Normal noise from a generator of its own.
#[derive(Debug, Clone)]
pub(crate) struct Noise {
    state: u64,
}

impl Noise {
    pub(crate) fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// Uniform in (0, 1) (SplitMix64; Steele, Lea and Flood 2014).
    fn uniform(&mut self) -> f64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (((z ^ (z >> 31)) >> 12) as f64 + 0.5) / (1u64 << 52) as f64
    }

    /// Normal with deviation 1 (Box and Muller 1958).
    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * libm::log(self.uniform())).sqrt();
        radius * libm::cos(2.0 * std::f64::consts::PI * self.uniform())
    }

    /// What an encoder with a step and a deviation shows.
    pub(crate) fn shown(&mut self, position: f64, step: f64, deviation: f64) -> f64 {
        let noisy = if deviation > 0.0 {
            position + deviation * self.normal()
        } else {
            position
        };
        if step > 0.0 {
            (noisy / step).round() * step
        } else {
            noisy
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_normal_and_repeats() {
        let (mut noise, mut again) = (Noise::new(5), Noise::new(5));
        let values: Vec<f64> = (0..100_000).map(|_| noise.shown(1.0, 0.0, 0.1)).collect();
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let moment = |power: i32| values.iter().map(|v| ((v - mean) / 0.1).powi(power)).sum::<f64>() / count;
        // four standard errors of each
        assert!((mean - 1.0).abs() < 4.0 * 0.1 / count.sqrt());
        assert!((moment(2) - 1.0).abs() < 4.0 * (2.0 / count).sqrt());
        assert!((moment(4) - 3.0).abs() < 4.0 * (96.0 / count).sqrt());
        assert!(values.iter().all(|v| *v == again.shown(1.0, 0.0, 0.1)));
    }

    #[test]
    fn positions_are_rounded_to_steps() {
        let mut noise = Noise::new(0);
        assert_eq!(noise.shown(0.1249, 0.25, 0.0), 0.0);
        assert_eq!(noise.shown(-0.126, 0.25, 0.0), -0.25);
        assert_eq!(noise.shown(0.3, 0.0, 0.0), 0.3);
    }
}
