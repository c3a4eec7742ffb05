//! A record that begins while the arm moves.

use nalgebra::{DMatrix, DVector};
use truecut_recording::measured::{Measured, MeasuredChannel};
use truecut_recording::significant;
use truecut_scenario::{DriveKind, ReplayMode, Scenario};

use super::noise::without_memory;

/// First samples of a command, through which a parabola tells its speed at the first one.
const FIRST: usize = 8;
/// Part of its largest speed below which a command stands still.
const STILL: f64 = 0.05;
/// Deviations of the parabola's speed that noise of the command may make.
const BY_NOISE: f64 = 4.0;

/// A sentence on commands of a replay that move in the first sample: a run begins at rest, and what
/// swings until that is forgotten is no cause.
pub fn begins_in_motion(scenario: &Scenario, measured: &Measured) -> Option<String> {
    let is_led = super::mode(scenario) == Some(ReplayMode::Forward)
        && scenario.robot.drive != DriveKind::Force;
    let commands = measured.inputs().filter(|one| {
        let joint = one.spec.name.strip_prefix("joint");
        is_led && joint.is_some_and(|rest| rest.ends_with(".command"))
    });
    let moving = commands.filter_map(|one| {
        let part = part_of_largest_speed(one)?;
        let percent = significant(100.0 * part, 2);
        Some(format!("`{}` at {percent} %", one.spec.name))
    });
    let moving: Vec<String> = moving.collect();
    (!moving.is_empty()).then(|| {
        format!(
            "the record begins in motion ({} of its largest speed), and a run begins at rest: what swings until that \
             is forgotten is no cause. Let the record begin where the arm stands",
            moving.join(", ")
        )
    })
}

/// The speed in the first sample as a part of the largest, where that is no rest.
fn part_of_largest_speed(command: &MeasuredChannel) -> Option<f64> {
    let (values, valid) = (&command.values, &command.valid);
    if values.len() < 2 * FIRST || !valid[..FIRST].iter().all(|valid| *valid) {
        return None;
    }
    let design = DMatrix::from_fn(FIRST, 3, |row, power| (row as f64).powi(power as i32));
    let inverse = (design.transpose() * &design).try_inverse()?;
    let first = DVector::from_column_slice(&values[..FIRST]);
    let speed = (&inverse * design.transpose() * first)[1].abs();
    let by_noise = without_memory(values, valid) * inverse[(1, 1)].sqrt();
    // Over as many samples, so that noise and steps of the command are none of its speed.
    let apart = values.windows(FIRST).map(|run| run[FIRST - 1] - run[0]);
    let largest = apart.fold(0.0, |most: f64, way| most.max(way.abs())) / (FIRST - 1) as f64;
    (largest > 0.0 && speed > STILL * largest && speed > BY_NOISE * by_noise)
        .then(|| speed / largest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Colour, noise};
    use truecut_recording::measured::Role;
    use truecut_recording::{ChannelSpec, Unit};

    fn command(values: Vec<f64>) -> MeasuredChannel {
        MeasuredChannel {
            spec: ChannelSpec::new("joint1.command", Unit::Radian, ""),
            role: Role::Input,
            valid: vec![true; values.len()],
            values,
            noise: None,
            white_kept: 1.0,
        }
    }

    /// Motions from rest, smooth or with a jump of the acceleration, noisy, in steps; and the same
    /// cut off at a drawn place where they move.
    #[test]
    fn verify_speed_of_the_first_sample() {
        for seed in 0..60_u64 {
            let drawn = noise(Colour::White, 4000, seed);
            let pace = 2e-3 * (1.0 + (seed % 7) as f64);
            let level = [0.0, 1e-4, 1e-3][seed as usize % 3];
            let jumps = seed % 2 == 0;
            let at = |k: usize| -> f64 {
                let turn = pace * k as f64;
                match jumps {
                    true => 1.0 - turn.cos(),
                    false => turn - turn.sin(),
                }
            };
            let motion: Vec<f64> = (0..4000).map(|k| at(k) + level * drawn[k]).collect();
            let rounded = motion.iter().map(|x| (x / 1e-4).round() * 1e-4);
            for from_rest in [motion.clone(), rounded.collect()] {
                assert_eq!(part_of_largest_speed(&command(from_rest)), None, "{seed}");
            }
            let cut = (1.5 / pace) as usize;
            let part = part_of_largest_speed(&command(motion[cut..].to_vec()));
            let exact = match jumps {
                true => 1.5_f64.sin(),
                false => (1.0 - 1.5_f64.cos()) / 2.0,
            };
            let tolerance = 0.1 + 40.0 * level / pace / FIRST as f64;
            match part {
                Some(part) => assert!((part - exact).abs() < tolerance, "{seed}: {part} {exact}"),
                None => assert!(level > 0.0, "{seed}"),
            }
        }
    }
}
