//! Other experiments that could be made with a scenario: what a person could change at the machine.

use truecut_scenario::{Knob, Scenario};

use crate::model::Experiment;

/// Variations of the keys that the scenario gives, one at a time.
pub(super) fn experiments(scenario: &Scenario) -> Vec<Experiment> {
    let variation = |knob: &Knob, factor: f64| {
        let now = scenario.number(knob.key).or(knob.default);
        now.map(|now| Experiment {
            description: format!("{} {} instead of {now}", knob.words, factor * now),
            overrides: vec![(knob.key.to_owned(), format!("{:?}", factor * now))],
        })
    };
    let knobs = scenario.process.facts().knobs;
    (knobs.iter())
        .flat_map(|knob| knob.factors.iter().filter_map(move |f| variation(knob, *f)))
        .collect()
}
