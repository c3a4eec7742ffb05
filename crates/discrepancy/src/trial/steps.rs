//! The step of a search's runs.
//!
//! *Milling*: a force that follows chips is met to the second order of the step, and its default
//! step is that of a run that is looked at, not of one that is held against a thousand samples
//! with noise of a hundredth of it. Then an effect whose only merit is a shorter step (a base that
//! hardly gives) fits better. So the longest step is taken of which halving shows that it leaves
//! no more than a small part of what an output varies. Samples that are not looked at, at a jump
//! of the force at the beginning or end of the data, say nothing of it.
//!
//! *Replays*: the default step follows from the arm's fastest mode, which is often that of a stiff
//! wrist with little behind it, ten times faster than anything in the data. The scheme is exact for
//! it at any step. So the longest step is taken that moves the outputs, over all of their samples
//! together, by no more than a part of one deviation of what they differ by from sample to sample:
//! of the nominal arm and of one with dry friction in every joint, whose sticking a long step would
//! miss. Not where a joint has play: of when its flanks meet half as many steps tell so little that
//! a gap of 1.2 mrad came out 2 µrad smaller.

use std::borrow::Cow;

use truecut_scenario::effect::{Effect, EffectKind};
use truecut_scenario::{ProcessSpec, Scenario};
use truecut_sim::SimError;
use truecut_sim::run::{self, Engine, StepsPerPeriod};

use super::{Kind, Trial, reduced};
use crate::model::Columns;
use crate::stats::spectrum::line;
use crate::stats::{ratio, rms};

/// What the step leaves may be no more than this part of an output's deviation from a line.
const LARGEST_ERROR: f64 = 5e-4;
/// Of the error of a step, which is of second order, so much goes with halving it.
const GONE_BY_HALVING: f64 = 0.75;
/// The step is halved no more often: a run takes longer each time.
const MOST_HALVINGS: usize = 3;
/// What fewer steps leave may move a size that is found by no more than this part of its deviation:
/// an interval then holds the truth in 94 instead of 95 of 100.
const LARGEST_BIAS: f64 = 0.3;
/// Steps in one period of the fastest mode that are tried in replays, the fewest first. Along its
/// path, and with effects, the arm's fastest mode is faster than at the start; of four steps in a
/// period its velocity can no longer be read.
const FEWER: [f64; 3] = [6.0, 9.0, 13.0];
/// Steps that differ by no more than this part of them are equal.
const ROUNDING: f64 = 1e-9;

impl Trial {
    /// Finds the longest step that the search may take.
    ///
    /// # Errors
    /// Whatever makes the scenario unfit to run.
    pub(super) fn find_step(&mut self) -> Result<(), SimError> {
        if self.scenario.run.time_step_s.is_some() {
            return Ok(());
        }
        match self.scenario.process {
            ProcessSpec::Milling(_) => self.find_step_of_cut(),
            ProcessSpec::Replay(_) if matches!(self.engine, Kind::Forward) => {
                self.find_step_of_replay();
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn find_step_of_replay(&mut self) {
        let dry: Vec<Effect> = (self.candidates.iter())
            .filter(|one| one.kind == EffectKind::JointCoulomb)
            .map(|one| Effect {
                kind: one.kind,
                target: one.target.clone(),
                values: one.scale.clone(),
            })
            .collect();
        let runs = |trial: &Trial| -> Option<Vec<Columns>> {
            let run = |effects: &&[Effect]| {
                let scenario = trial.scenario.with_effects(effects).ok()?;
                let rows = trial.run(&scenario, trial.reduced(), None).ok()?;
                Some(trial.at_the_data(&rows, 1.0))
            };
            [&[][..], &dry].iter().map(run).collect()
        };
        let Some(default) = runs(self) else {
            return;
        };
        for steps_per_period in FEWER {
            self.steps_per_period.without_play = steps_per_period;
            let now = runs(self);
            if now.is_some_and(|now| self.is_unseen(&default, &now)) {
                return;
            }
        }
        self.steps_per_period = StepsPerPeriod::DEFAULT;
    }

    /// Whether no run is moved by more than a part of one deviation of what the samples differ by,
    /// over all of them in all outputs: by no more is any size that is found, in its deviations.
    fn is_unseen(&self, before: &[Columns], now: &[Columns]) -> bool {
        let moved = |(before, now): (&Columns, &Columns)| -> f64 {
            let outputs = self.observation.outputs.iter();
            let squares = outputs.zip(before.iter().zip(now)).map(|(output, (a, b))| {
                let valid = output.valid.iter();
                let moved = (valid.zip(a.iter().zip(b)))
                    .filter(|(valid, _)| **valid)
                    .map(|(_, (a, b))| (a - b).powi(2))
                    .sum::<f64>();
                // What is measured itself may change from sample to sample, as where flanks rattle.
                let stated = output.noise.unwrap_or(f64::INFINITY);
                let noise = from_sample_to_sample(&output.values, &output.valid).min(stated);
                ratio(moved, noise.powi(2))
            });
            squares.sum::<f64>().sqrt()
        };
        before
            .iter()
            .zip(now)
            .all(|pair| moved(pair) <= LARGEST_BIAS)
    }

    fn find_step_of_cut(&mut self) -> Result<(), SimError> {
        let mut step_s = reduced(&self.scenario, &self.measured, &self.robots).time_step_s()?;
        let Some(mut before) = self.nominal_run() else {
            return Ok(());
        };
        for _ in 0..MOST_HALVINGS {
            let longer_s = self.longest_step_s;
            step_s *= 0.5;
            self.longest_step_s = step_s;
            self.shortest_step_s = self.shortest_step_s.min(step_s * (1.0 - ROUNDING));
            let now = self.nominal_run();
            let moved = now.as_ref().map_or(0.0, |now| self.moved(&before, now));
            let Some(now) = now.filter(|_| moved >= GONE_BY_HALVING * LARGEST_ERROR) else {
                self.longest_step_s = longer_s;
                break;
            };
            before = now;
        }
        Ok(())
    }

    /// By what part of its deviation an output is moved at most, where there are data.
    fn moved(&self, before: &Columns, now: &Columns) -> f64 {
        let outputs = self.observation.outputs.iter();
        let parts = outputs
            .zip(before.iter().zip(now))
            .map(|(output, (before, now))| {
                let valid = |column: &[f64]| -> Vec<f64> {
                    let pairs = column.iter().zip(&output.valid);
                    pairs
                        .filter(|(_, valid)| **valid)
                        .map(|(x, _)| *x)
                        .collect()
                };
                let (before, now) = (valid(before), valid(now));
                apart(&now, &before) / from_a_line(&now).max(f64::MIN_POSITIVE)
            });
        parts.fold(0.0, f64::max)
    }

    /// `None` where it fails: the search tells.
    fn nominal_run(&self) -> Option<Columns> {
        let rows = self.run(&self.scenario, Engine::REDUCED, None).ok()?;
        Some(self.at_the_data(&rows, 1.0))
    }

    /// The scenario with a step that a run may take: a whole part of the default one.
    pub(super) fn with_step<'a>(
        &self,
        scenario: &'a Scenario,
        run: &run::Run<'_>,
    ) -> Result<Cow<'a, Scenario>, SimError> {
        if self.longest_step_s == f64::INFINITY {
            return Ok(Cow::Borrowed(scenario));
        }
        let own_s = run.time_step_s()?;
        let parts = (own_s / self.longest_step_s * (1.0 - ROUNDING)).ceil();
        if parts <= 1.0 {
            return Ok(Cow::Borrowed(scenario));
        }
        let mut stepped = scenario.clone();
        stepped.run.time_step_s = Some(own_s / parts);
        Ok(Cow::Owned(stepped))
    }
}

/// Deviation of white noise whose second differences are as large as those of the values.
fn from_sample_to_sample(values: &[f64], valid: &[bool]) -> f64 {
    let bends: Vec<f64> = (values.array_windows().zip(valid.array_windows()))
        .filter(|(_, valid)| **valid == [true; 3])
        .map(|([before, now, after], _)| before - 2.0 * now + after)
        .collect();
    rms(&bends) / 6f64.sqrt()
}

/// Deviation from the line that fits best.
fn from_a_line(values: &[f64]) -> f64 {
    let (mean, slope, middle) = line(values, &vec![true; values.len()]);
    let rows = values.iter().enumerate();
    let left: Vec<f64> = rows
        .map(|(row, value)| value - mean - slope * (row as f64 - middle))
        .collect();
    rms(&left)
}

/// Root mean square of the differences.
fn apart(one: &[f64], other: &[f64]) -> f64 {
    let differences: Vec<f64> = one.iter().zip(other).map(|(a, b)| a - b).collect();
    rms(&differences)
}

#[cfg(test)]
mod tests {
    use truecut_recording::{ChannelSpec, Measured, MeasuredChannel, Role, Unit};

    use super::*;
    use crate::testing::milling;

    impl Trial {
        fn nominal_of_search(&self) -> Columns {
            let rows = self
                .run(&self.scenario, self.reduced(), None)
                .expect("it runs");
            self.at_the_data(&rows, 1.0)
        }
    }

    /// A machine of 21 kg at 17 Hz that cuts with three teeth, 31 a second.
    fn milled(step: Option<(&str, &str)>) -> Trial {
        let changes = [
            ("robot.inertia_scale", "530"),
            ("robot.stiffness_scale", "0.18"),
            ("robot.damping_scale", "35"),
            ("process.milling.spindle_rpm", "610"),
            ("process.milling.axial_depth_mm", "0.03"),
            ("process.milling.engagement", "down"),
            ("process.milling.radial_depth_mm", "8"),
            ("process.milling.ramp_mm", "0.02"),
            ("process.milling.start_angle_deg", "0"),
            ("process.milling.cutter.teeth", "3"),
            ("process.milling.path.length_mm", "4"),
            ("run.duration_s", "0.6"),
        ];
        let changes: Vec<_> = changes.into_iter().chain(step).collect();
        let scenario = milling(&changes);
        let channel = |name: &str, unit, size: f64| MeasuredChannel {
            spec: ChannelSpec::new(name, unit, ""),
            role: Role::Output,
            values: (0..600).map(|k| size * f64::from(k).sin()).collect(),
            valid: vec![true; 600],
            noise: None,
            white_kept: 1.0,
        };
        let measured = Measured {
            source: "made".into(),
            time_s: (0..600).map(|k| 1e-3 * f64::from(k)).collect(),
            channels: vec![
                channel("milling.force_x", Unit::Newton, 1.0),
                channel("joint1.position", Unit::Metre, 1e-5),
            ],
            ..Measured::default()
        };
        Trial::new(&scenario, &measured).unwrap_or_else(|e| panic!("{e}"))
    }

    /// What a search is told of forces and slide errs by less than half a thousandth of what
    /// varies, which the default step misses by far. A step that the scenario asks for stays.
    #[test]
    fn verify_error_of_a_search_by_a_step_of_a_hundredth_of_a_millisecond() {
        let mut trial = milled(None);
        let mut told = |longest_step_s: Option<f64>| {
            trial.longest_step_s = longest_step_s.unwrap_or(trial.longest_step_s);
            trial.nominal_run().expect("a cut that does not chatter")
        };
        let found = told(None);
        let [exact, coarse] = [0.01e-3, f64::INFINITY].map(|step_s| told(Some(step_s)));
        let [found, coarse] = [found, coarse].map(|one| trial.moved(&one, &exact));
        assert!(found < LARGEST_ERROR, "{found}");
        assert!(coarse > 2.0 * LARGEST_ERROR, "{coarse}");
        let asked = milled(Some(("run.time_step_ms", "0.3")));
        assert_eq!(asked.longest_step_s, f64::INFINITY);
    }

    /// An IRB 6600 whose joints swing by half a radian, and white noise of such a deviation.
    fn swung(noise_n_m: f64) -> Trial {
        let mut text = String::from(
            "name = \"swung\"\n[robot]\nurdf = \"../../assets/robots/irb6600_175_255/robot.urdf\"\ndrive = \"position\"\n\
             posture_deg = [0, 10, 20, 0, 30, 0]\n[process.replay]\nmode = \"forward\"\n[data]\ntime = \"t\"\n",
        );
        let mut channels = Vec::new();
        let start = [0.0f64, 10.0, 20.0, 0.0, 30.0, 0.0];
        for (joint, start) in start.iter().enumerate() {
            let number = joint + 1;
            let [command, torque] =
                ["command", "transmission_torque"].map(|one| format!("joint{number}.{one}"));
            text += &format!(
                "[[data.channel]]\ncolumn = \"c{number}\"\nchannel = \"{command}\"\nunit = \"rad\"\nrole = \"input\"\n\
                 [[data.channel]]\ncolumn = \"m{number}\"\nchannel = \"{torque}\"\nunit = \"N m\"\n"
            );
            let swing = |k: i32| {
                let t = f64::from(k) / 250.0;
                start.to_radians() + 0.25 * (1.0 - (2.5 * t * (1.0 + 0.1 * number as f64)).cos())
            };
            let noise = crate::testing::noise(crate::testing::Colour::White, 750, number as u64);
            let series = [
                (
                    command,
                    Unit::Radian,
                    Role::Input,
                    (0..750).map(swing).collect(),
                ),
                (
                    torque,
                    Unit::NewtonMetre,
                    Role::Output,
                    noise.iter().map(|x| noise_n_m * x).collect::<Vec<f64>>(),
                ),
            ];
            channels.extend(series.map(|(name, unit, role, values)| MeasuredChannel {
                spec: ChannelSpec::new(&name, unit, ""),
                role,
                values,
                valid: vec![true; 750],
                noise: None,
                white_kept: 1.0,
            }));
        }
        let at = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../../scenarios/replay/of_a_test.toml");
        let scenario = Scenario::from_str(&at, &text, &[]).unwrap_or_else(|e| panic!("{e:?}"));
        let measured = Measured {
            source: "made".into(),
            time_s: (0..750).map(|k| f64::from(k) / 250.0).collect(),
            channels,
            ..Measured::default()
        };
        Trial::new(&scenario, &measured).unwrap_or_else(|e| panic!("{e}"))
    }

    /// Fewer steps are taken the more noise hides them, and what they leave weighs no more than a
    /// part of one deviation of it over all samples, against steps that are a tenth as long.
    #[test]
    fn verify_error_of_a_replay_by_a_step_of_a_fiftieth_of_a_millisecond() {
        let chosen = [1e-9, 20.0].map(|noise| {
            let mut trial = swung(noise);
            let found = trial.nominal_of_search();
            (trial.longest_step_s, trial.shortest_step_s) = (0.02e-3, 0.0);
            let exact = trial.nominal_of_search();
            let pairs = found.iter().flatten().zip(exact.iter().flatten());
            let moved: f64 = pairs.map(|(a, b)| (a - b).powi(2)).sum();
            assert!(
                noise < 1.0 || moved.sqrt() < 1.1 * LARGEST_BIAS * noise,
                "{moved} {noise}"
            );
            trial.steps_per_period
        });
        assert_eq!(chosen[0], StepsPerPeriod::DEFAULT);
        assert!(chosen[1].without_play < 15.0, "{:?}", chosen[1]);
    }

    #[test]
    fn verify_deviation_of_noise_from_sample_to_sample() {
        let noise = crate::testing::noise(crate::testing::Colour::White, 20_000, 3);
        let on_a_slope: Vec<f64> = (noise.iter().enumerate())
            .map(|(k, x)| 3.0 * x + 0.7 * k as f64)
            .collect();
        let found = from_sample_to_sample(&on_a_slope, &vec![true; noise.len()]);
        assert!((found / 3.0 - 1.0).abs() < 0.03, "{found}");
    }

    #[test]
    fn verify_deviation_from_a_line() {
        let values: Vec<f64> = (0..1000)
            .map(|k| 5.0 - 0.3 * f64::from(k) + if k % 2 == 0 { 2.0 } else { -2.0 })
            .collect();
        assert!((from_a_line(&values) - 2.0).abs() < 1e-4);
    }
}
