//! The largest force and torque of a run.
//!
//! An edge on a helix comes into the cut within less than a step or two, and its force has a kink where
//! all of it is in. Means over steps fall short of such a peak in proportion to the step: by 3 % at 40
//! steps a tooth in a pocket 1 mm deep, with a helix of 30 degrees. So steps whose mean comes near the largest
//! so far are looked at at more instants.

use truecut_core::cutting::milling::cut::MillingLoads;

/// Steps whose mean falls further short of the largest so far are not looked at: means fall short of
/// their peaks by a part of a tenth.
const MARGIN: f64 = 0.2;
/// Instants of a step that are.
const INSTANTS: usize = 16;

/// Largest values so far, at any instant.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Peak {
    pub force_n: f64,
    pub torque_n_m: f64,
}

impl Peak {
    /// A step with these means; `loads_at` tells what acts at a part of the step from its middle.
    pub fn add(&mut self, force_n: f64, torque_n_m: f64, loads_at: impl Fn(f64) -> MillingLoads) {
        let is_near = |mean: f64, largest: f64| mean > 0.0 && mean >= (1.0 - MARGIN) * largest;
        if !is_near(force_n, self.force_n) && !is_near(torque_n_m, self.torque_n_m) {
            return;
        }
        for instant in 0..INSTANTS {
            let loads = loads_at((instant as f64 + 0.5) / INSTANTS as f64 - 0.5);
            self.force_n = self.force_n.max(loads.force_on_tool_n.norm());
            self.torque_n_m = self.torque_n_m.max(loads.moment_on_tool_n_m.z.abs());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, Uniform};

    /// Edges that come in within less than a step or two and leave slowly, as in down-milling: their
    /// peak to half a hundredth, of which the means of steps miss several.
    #[test]
    fn verify_kinks_between_steps_are_found() {
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let mut draw = |low: f64, high: f64| Uniform::new(low, high).unwrap().sample(&mut random);
        let mut missed = 0;
        for _ in 0..40 {
            let (step, comes, height) = (draw(0.04, 0.08), draw(0.05, 0.12), draw(1.0, 300.0));
            let (entry, leaves) = (draw(0.0, 3.0), draw(0.7, 1.5));
            let value = |at: f64| {
                let way = (at - entry).rem_euclid(3.2);
                let rises = (way / comes).min(1.0);
                height * rises * (1.0 - (way - comes).max(0.0) / leaves).max(0.0)
            };
            let (mut peak, mut largest) = (Peak::default(), 0.0_f64);
            for k in 0..60 {
                let loads_at = |ahead: f64| MillingLoads {
                    force_on_tool_n: Vector3::x() * value(step * (f64::from(k) + ahead)),
                    ..MillingLoads::default()
                };
                let parts = (0..200).map(|part| (f64::from(part) + 0.5) / 200.0 - 0.5);
                let mean = parts
                    .map(|ahead| loads_at(ahead).force_on_tool_n.x)
                    .sum::<f64>()
                    / 200.0;
                largest = largest.max(mean);
                peak.add(mean, 0.0, loads_at);
            }
            missed += usize::from(largest < 0.98 * height);
            let found = peak.force_n / height;
            assert!((found - 1.0).abs() < 5e-3, "{found} of {height}");
        }
        assert!(missed > 5, "{missed}");
    }
}
