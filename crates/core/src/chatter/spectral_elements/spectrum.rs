//! At which of its frequencies a vibration is strongest.
//!
//! A multiplier μ leaves open by how many turns in a tooth period the vibration is ahead: motion is
//! `e^(λt) p(t)` with λ = ln μ / T and p of the teeth's period, and has all the frequencies
//! `(arg μ + 2πk) / T`. Two of them may stand at either side of a natural frequency, equally far
//! from it, of which the mode alone cannot say which is the strong one. The force can: it follows
//! from the positions at the nodes, is nothing between the elements with teeth in the cut, and its
//! part at each frequency is the sum of a quadrature. The modes answer to it by their receptance.
//!
//! The force is that of regeneration, of which the positions of now and of a tooth period before
//! are in the ratio of μ to 1. What worn flanks and the floor add to it has the same frequencies
//! and is left out.

use std::f64::consts::TAU;

use nalgebra::{Complex, DMatrix};

use super::AtSpeed;
use crate::chatter::krylov::dominant_eigenpair;

/// Frequencies are looked at up to so many times the highest natural one.
const HIGHEST: f64 = 1.5;

/// A moment at which the force is known.
#[derive(Debug, Clone)]
pub(super) struct Moment {
    /// Since the start of the period, s.
    pub time_s: f64,
    /// Of the quadrature, s; 1 of a kick.
    pub weight: f64,
    /// Modal force, or impulse, per depth and remembered position: modes × positions.
    pub force: DMatrix<f64>,
}

impl AtSpeed<'_> {
    /// Frequency at which the tool point moves most in the cutting plane, in the vibration of the
    /// dominant multiplier at an axial depth of `depth_m`, Hz.
    pub fn chatter_hz(&self, depth_m: f64) -> f64 {
        let map = self.period_map(depth_m);
        let (multiplier, vector) = dominant_eigenpair(map.length(), |from, to| map.apply(from, to));
        let exponent_per_s = multiplier.ln() / self.tooth_period_s;
        let positions = &vector[map.states..];
        let passing = TAU / self.tooth_period_s;
        let natural = (self.of.modes.iter()).map(|mode| mode.natural_frequency_rad_s);
        let highest = HIGHEST * natural.fold(0.0, f64::max);
        let most = (highest / passing).ceil() as i32 + 1;
        let frequencies = (-most..=most).map(|k| exponent_per_s.im + passing * f64::from(k));
        let strength = |omega: f64| {
            let at = Complex::new(exponent_per_s.re, omega);
            self.moves(&self.force(positions, at), omega)
        };
        let strongest = frequencies
            .filter(|omega| omega.abs() <= highest)
            .map(|omega| (strength(omega), omega))
            .max_by(|a, b| a.0.total_cmp(&b.0));
        strongest.map_or(0.0, |(_, omega)| omega.abs() / TAU)
    }

    /// The part of the modal forces that goes with e^(at).
    fn force(&self, positions: &[Complex<f64>], at: Complex<f64>) -> Vec<Complex<f64>> {
        let mut sum = vec![Complex::default(); self.of.modes.len()];
        let mut rest = positions;
        for moment in &self.moments {
            let (own, later) = rest.split_at(moment.force.ncols());
            rest = later;
            let turned = (-at * moment.time_s).exp() * moment.weight;
            for (mode, sum) in sum.iter_mut().enumerate() {
                for (column, position) in own.iter().enumerate() {
                    *sum += turned * position * moment.force[(mode, column)];
                }
            }
        }
        sum
    }

    /// How much the remembered positions move under modal forces at a frequency.
    fn moves(&self, force: &[Complex<f64>], omega: f64) -> f64 {
        let modal: Vec<Complex<f64>> = (self.of.modes.iter().zip(force))
            .map(|(mode, force)| mode.receptance_s2(omega) * force)
            .collect();
        let remembered = self.moments.first().map_or(0, |one| one.force.ncols());
        let rows = (0..remembered).map(|row| {
            let parts = modal.iter().enumerate();
            let sum: Complex<f64> = parts
                .map(|(mode, moved)| moved * self.of.outputs.positions[(row, mode)])
                .sum();
            sum.norm_sqr()
        });
        rows.sum::<f64>().sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chatter::averaged::zero_order_limit;
    use crate::chatter::limit::{LimitSearch, first_limit};
    use crate::chatter::spectral_elements::SpectralElements;
    use crate::chatter::{DirectionalMatrix, TipMode};
    use crate::cutting::milling::engagement::Engagement;
    use nalgebra::Vector3;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, Uniform};

    fn drawn(rng: &mut ChaCha8Rng, low: f64, high: f64) -> f64 {
        Uniform::new(low, high).expect("a range").sample(rng)
    }

    /// A slot with four teeth pushes with a constant force per displacement, so that the vibration
    /// has one frequency, that of the zero-order solution, which is exact there. At most of these
    /// speeds another one is as near to the natural frequency.
    #[test]
    fn verify_a_constant_cut_has_one_frequency() {
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        let axes = [Vector3::x(), Vector3::y()];
        let modes = axes.map(|axis| TipMode::of_mass(TAU * 900.0, 0.03, 0.125, &axis));
        let process = DirectionalMatrix::planar(4, 7e8, 0.3, Engagement::SLOT);
        let elements = SpectralElements::new(&modes, &process);
        for case in 0..60 {
            let rpm = match case {
                0 => 9000.0,
                1 => 9030.0,
                2 => 13_300.0,
                3 => 5400.0,
                _ => drawn(&mut rng, 4e3, 2e4),
            };
            let period_s = 60.0 / (rpm * 4.0);
            let expected = zero_order_limit(&modes, process.averaged(period_s), period_s);
            let expected = expected.expect("a limit");
            let search = LimitSearch::to_depth(2.0 * expected.depth_m);
            let limit = first_limit(&elements, period_s, &search).expect("a limit");
            let found_hz = elements.at(period_s).chatter_hz(limit.depth_m);
            assert!(
                (found_hz / expected.frequency_hz - 1.0).abs() < 1e-3,
                "{rpm} rpm: {found_hz} Hz, zero order {} Hz",
                expected.frequency_hz
            );
        }
    }

    /// Motion of one mode in a cut from a push on, a displacement every so many steps of a tooth
    /// period.
    fn stepped(
        of: &SpectralElements,
        depth_m: f64,
        period_s: f64,
        steps: usize,
        periods: usize,
    ) -> Vec<f64> {
        let [mode] = of.modes.as_slice() else {
            panic!("one mode");
        };
        let pitch = TAU / of.process.teeth as f64;
        let force: Vec<f64> = (0..steps)
            .map(|step| {
                let angle = pitch * (step as f64 + 0.5) / steps as f64;
                of.modal(&of.process.at_pa(angle, &of.cutting_teeth(angle)))[(0, 0)]
            })
            .collect();
        let (omega, dt) = (mode.natural_frequency_rad_s, period_s / steps as f64);
        let (mut q, mut rate) = (1.0, 0.3 * omega);
        let mut course = vec![0.0; steps];
        for step in 0..steps * periods {
            let before = course[step];
            let push = depth_m * force[step % steps] * (q - before);
            rate += dt * (push - omega * omega * q - 2.0 * mode.damping_ratio * omega * rate);
            q += dt * rate;
            course.push(q);
        }
        course
    }

    /// Teeth that come and go: the strongest line of a vibration that is stepped in time.
    #[test]
    fn verify_the_strongest_line_of_an_interrupted_cut() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let mut flips = 0;
        for case in 0..30 {
            let immersion = drawn(&mut rng, 0.08, 0.6);
            let arc = match case % 2 {
                0 => Engagement::down(immersion, 1.0),
                _ => Engagement::up(immersion, 1.0),
            };
            let mode = TipMode::of_mass(TAU * 922.0, 0.02, 0.04, &Vector3::x());
            let process = DirectionalMatrix::planar(2, 6e8, 1.0 / 3.0, arc.expect("partial"));
            let elements = SpectralElements::new(&[mode], &process);
            let period_s = 30.0 / drawn(&mut rng, 5e3, 2.4e4);
            let search = LimitSearch::to_depth(20e-3);
            let Some(limit) = first_limit(&elements, period_s, &search) else {
                continue;
            };
            let at = elements.at(period_s);
            let depth_m = 1.02 * limit.depth_m;
            let (steps, periods, last) = (500, 260, 60);
            let course = stepped(&elements, depth_m, period_s, steps, periods);
            let course = &course[course.len() - steps * last..];
            let growth = at.multiplier(depth_m).growth_per_s(period_s);
            let dt = period_s / steps as f64;
            let amplitude = |hz: f64| {
                let sum: Complex<f64> = (course.iter().enumerate())
                    .map(|(step, q)| {
                        let part = step as f64 / course.len() as f64;
                        let window = 0.5 - 0.5 * (TAU * part).cos();
                        let time_s = step as f64 * dt;
                        Complex::from_polar(
                            window * q * (-growth * time_s).exp(),
                            -TAU * hz * time_s,
                        )
                    })
                    .sum();
                sum.norm()
            };
            let multiplier = at.multiplier(depth_m);
            flips += usize::from(multiplier.value.im == 0.0);
            let lines = multiplier.frequencies_rad_s(period_s, 1.5 * TAU * 922.0);
            let most = lines
                .iter()
                .map(|omega| amplitude(omega / TAU))
                .fold(0.0, f64::max);
            let found = at.chatter_hz(depth_m);
            assert!(
                amplitude(found) > 0.95 * most,
                "case {case}: {found} Hz, {} of {most}",
                amplitude(found)
            );
        }
        assert!(flips > 2, "{flips}");
    }
}
