//! What noise of measured motion makes of drive forces that are predicted from it.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use truecut_recording::measured::{Measured, MeasuredChannel, Role};
use truecut_scenario::Scenario;
use truecut_sim::{InverseModel, SimError};

use super::without_memory;
use crate::stats::{mean, quiet_density};

/// The noise added is the same in every diagnosis.
const SEED: u64 = 0x696e_7075_7473;

/// Standard deviation of what the noise of the inputs makes of each drive force that `model`
/// predicts from them, filtered: how much the prediction changes if as much noise comes to each
/// input again. Neither standstill nor repetition of the outputs shows it, and rounding of an input
/// comes again with the motion. Of links and rotors alone: friction, which changes its sign at
/// standstill, would make it large at a few samples.
///
/// # Errors
/// A joint that goes too far beyond its limits with that noise.
pub(crate) fn of_inputs(
    model: &InverseModel,
    scenario: &Scenario,
    measured: &Measured,
) -> Result<Vec<f64>, SimError> {
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let mut noisy = measured.clone();
    let inputs = noisy.channels.iter_mut();
    for input in inputs.filter(|one| one.role == Role::Input) {
        let size = input.noise.unwrap_or_else(|| size_in_band(input));
        for value in &mut input.values {
            let drawn: f64 = StandardNormal.sample(&mut random);
            *value += size * drawn;
        }
    }
    let again = InverseModel::new(scenario, &noisy)?.without_friction();
    let columns = model.without_friction().into_iter().zip(again);
    let sizes = columns.zip(model.measured().outputs());
    let sizes = sizes.map(|((as_is, again), output)| {
        let rows = as_is.iter().zip(&again).zip(&output.valid);
        let squares: Vec<f64> = rows
            .filter(|(_, valid)| **valid)
            .map(|((a, b), _)| (a - b).powi(2))
            .collect();
        mean(&squares).sqrt()
    });
    Ok(sizes.collect())
}

/// Differences that take the motion away, and leave noise so much at each frequency.
const DIFFERENCES: i32 = 4;
/// Samples of a segment of which densities are taken.
const SEGMENT: usize = 64;
/// Bands in cycles per sample, below what thinning leaves of a faster file: at the end of the last
/// nine tenths, at 0.38 a third.
const BANDS: [f64; 4] = [0.10, 0.16, 0.22, 0.28];

/// Standard deviation of white noise with the density that the noise of an input has below the
/// cutoff of what thinned it: the least of several bands, since each takes what is left of the
/// motion for noise.
fn size_in_band(input: &MeasuredChannel) -> f64 {
    let (mut differences, mut valid) = (input.values.clone(), input.valid.clone());
    for _ in 0..DIFFERENCES {
        differences = differences
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .collect();
        valid = valid.windows(2).map(|pair| pair[0] && pair[1]).collect();
    }
    let Some(found) = quiet_density(&differences, &valid, SEGMENT, 0.5) else {
        return without_memory(&input.values, &input.valid);
    };
    let densities = BANDS.windows(2).map(|band| {
        let bins = (0..=SEGMENT / 2).map(|bin| (bin, bin as f64 / SEGMENT as f64));
        let inside = bins.filter(|(_, cycles)| (band[0]..band[1]).contains(cycles));
        let before = inside.map(|(bin, cycles)| {
            let gain = 2.0 * (std::f64::consts::PI * cycles).sin();
            found[bin] / gain.powi(2 * DIFFERENCES)
        });
        mean(&before.collect::<Vec<_>>())
    });
    densities.fold(f64::INFINITY, f64::min).sqrt()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use truecut_recording::{ChannelSpec, Unit};

    use super::*;
    use crate::testing::{Colour, noise};

    const RATE_HZ: f64 = 250.0;
    const SAMPLES: usize = 2500;

    fn slide() -> Scenario {
        sliding("")
    }

    fn sliding(effect: &str) -> Scenario {
        let text = r#"
name = "a slide"
[robot]
urdf = "../../assets/robots/emps/robot.urdf"
gravity = false
[process.replay]
mode = "inverse"
differentiate_cutoff_hz = 15
compare_cutoff_hz = 8
[data]
time = "t"
[[data.channel]]
column = "q"
channel = "joint1.position"
unit = "m"
role = "input"
[[data.channel]]
column = "f"
channel = "joint1.drive_force"
unit = "N"
"#;
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let at = root.join("../../scenarios/replay/of_a_test.toml");
        Scenario::from_str(&at, &format!("{text}{effect}"), &[]).unwrap_or_else(|e| panic!("{e:?}"))
    }

    /// What the noise of these places makes of the force.
    fn found(scenario: &Scenario, measured: &Measured) -> f64 {
        let model = InverseModel::new(scenario, measured).unwrap_or_else(|e| panic!("{e}"));
        of_inputs(&model, scenario, measured).unwrap()[0]
    }

    fn moved(place: impl Fn(usize) -> f64) -> Measured {
        let channel = |name: &str, unit, role, values| MeasuredChannel {
            spec: ChannelSpec::new(name, unit, ""),
            role,
            values,
            valid: vec![true; SAMPLES],
            noise: None,
            white_kept: 1.0,
        };
        let places = (0..SAMPLES).map(place).collect();
        let (input, output) = (Role::Input, Role::Output);
        Measured {
            source: "made".into(),
            time_s: (0..SAMPLES).map(|k| k as f64 / RATE_HZ).collect(),
            channels: vec![
                channel("joint1.position", Unit::Metre, input, places),
                channel(
                    "joint1.drive_force",
                    Unit::Newton,
                    output,
                    vec![0.0; SAMPLES],
                ),
            ],
            ..Measured::default()
        }
    }

    fn swing(k: usize) -> f64 {
        let t = k as f64 / RATE_HZ;
        0.1 + 0.06 * (3.1 * t).sin() + 0.02 * (7.3 * t + 1.0).cos()
    }

    /// How much the force errs that follows from these places, RMS.
    fn errs(measured: &Measured) -> f64 {
        let [as_is, clean] = [measured, &moved(swing)].map(|data| {
            let model = InverseModel::new(&slide(), data).unwrap_or_else(|e| panic!("{e}"));
            let force = model.predict(&[]).unwrap().swap_remove(0);
            let valid = model.measured().channels[0].valid.clone();
            let rows = force.into_iter().zip(valid);
            let kept: Vec<f64> = rows.filter(|(_, valid)| *valid).map(|(f, _)| f).collect();
            kept
        });
        let squares = as_is.iter().zip(&clean).map(|(a, b)| (a - b).powi(2));
        mean(&squares.collect::<Vec<_>>()).sqrt()
    }

    #[test]
    fn verify_noise_and_rounding_of_places_are_what_the_force_errs_by() {
        for seed in 0..8 {
            let size = [1e-6, 1e-5, 1e-4][seed as usize % 3];
            let drawn = noise(Colour::White, SAMPLES, seed);
            let noisy = moved(|k| swing(k) + size * drawn[k]);
            let ratio = found(&slide(), &noisy) / errs(&noisy);
            assert!((0.8..1.25).contains(&ratio), "noise, seed {seed}: {ratio}");
        }
        for step in [3e-5, 1e-4, 3e-4] {
            let rounded = moved(|k| (swing(k) / step).round() * step);
            let ratio = found(&slide(), &rounded) / errs(&rounded);
            assert!((0.7..1.4).contains(&ratio), "step {step}: {ratio}");
        }
        let exact = found(&slide(), &moved(swing));
        let moving = errs(&moved(|_| 0.1));
        assert!(exact < 1e-6 * moving, "{exact} N of {moving} N");
    }

    /// It changes its sign at standstill, and noise moves that by a few samples.
    #[test]
    fn friction_that_is_known_adds_nothing() {
        let drawn = noise(Colour::White, SAMPLES, 40);
        let noisy = moved(|k| swing(k) + 1e-5 * drawn[k]);
        let rubbing = "[[effect]]\nkind = \"joint_coulomb\"\njoint = 1\nfriction_n = 300\n";
        let [with, without] = [rubbing, ""].map(|effect| found(&sliding(effect), &noisy));
        assert_eq!(with.to_bits(), without.to_bits());
    }
}
