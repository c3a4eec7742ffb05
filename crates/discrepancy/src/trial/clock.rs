//! How fast the clock of the data goes beside the machine's.
//!
//! Where the scenario itself says what moves or pushes the arm, that goes by the machine's clock,
//! and the samples were stamped by a logger's: a sweep to 25 Hz over 3 s is 2° off at its end by a
//! clock that goes 1e-4 fast. No cause is looked for behind so little. A replay of measured inputs
//! has one clock for all.

use truecut_scenario::{CLOCK_RATE, Scenario, UncertainSpec};

use super::{Trial, mode};

/// Standard deviation of the rate of two clocks: quartz oscillators are sold within 20 to 100 parts
/// in a million.
const SIGMA: f64 = 1e-4;

/// The rate as an unknown, unless the scenario says how well it is known.
pub(super) fn unknown(scenario: &Scenario) -> Option<UncertainSpec> {
    let data = scenario.data.as_ref()?;
    let is_said = scenario.uncertain.iter().any(|one| one.key == CLOCK_RATE);
    (mode(scenario).is_none() && !is_said).then(|| UncertainSpec {
        key: CLOCK_RATE.to_owned(),
        value: data.mapping.clock_rate,
        sigma: SIGMA,
    })
}

impl Trial {
    /// The rate that nominal parameters have, over that by which the data were read.
    pub(super) fn clock_rate(&self, nominal: &[f64]) -> f64 {
        (self.scenario.uncertain.iter().zip(nominal))
            .find(|(parameter, _)| parameter.key == CLOCK_RATE)
            .map_or(1.0, |(parameter, value)| value / parameter.value)
    }

    /// Nominal parameters of a run, which knows nothing of the data's clock.
    pub(super) fn without_clock(&self, nominal: &[f64]) -> Vec<f64> {
        (self.scenario.uncertain.iter().zip(nominal))
            .map(|(parameter, value)| match parameter.key == CLOCK_RATE {
                true => parameter.value,
                false => *value,
            })
            .collect()
    }
}
