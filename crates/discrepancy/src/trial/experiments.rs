//! Other experiments that could be made with a scenario: what a person could change at the machine.

use truecut_scenario::{ProcessSpec, Scenario};

use crate::model::Experiment;

/// A key that may be varied, and by which factors.
struct Knob {
    key: &'static str,
    words: &'static str,
    factors: &'static [f64],
}

const CHAMFER: &[Knob] = &[
    Knob {
        key: "process.chamfer.spindle_rpm",
        words: "spindle speed",
        factors: &[0.6, 1.6],
    },
    Knob {
        key: "process.chamfer.feed_mm_per_rev",
        words: "feed per revolution",
        factors: &[0.5, 2.0],
    },
    Knob {
        key: "process.chamfer.depth_mm",
        words: "depth",
        factors: &[0.5, 1.5],
    },
    Knob {
        key: "process.chamfer.foot.pressure_mpa",
        words: "foot pressure",
        factors: &[0.6, 1.5],
    },
];

const WHEEL: &[Knob] = &[
    Knob {
        key: "process.wheel.speed_rpm",
        words: "wheel speed",
        factors: &[0.5, 1.5],
    },
    Knob {
        key: "process.wheel.normal_force_n",
        words: "normal force",
        factors: &[0.5, 2.0],
    },
    Knob {
        key: "process.wheel.feed_mm_per_s",
        words: "feed",
        factors: &[0.5, 2.0],
    },
];

const POLISH: &[Knob] = &[
    Knob {
        key: "process.polish.spin_rpm",
        words: "spin",
        factors: &[0.5, 2.0],
    },
    Knob {
        key: "process.polish.control.penetration_mm",
        words: "penetration",
        factors: &[0.6, 1.6],
    },
    Knob {
        key: "process.polish.control.force_n",
        words: "force",
        factors: &[0.5, 2.0],
    },
];

const MILLING: &[Knob] = &[
    Knob {
        key: "process.milling.spindle_rpm",
        words: "spindle speed",
        factors: &[0.5, 2.0],
    },
    Knob {
        key: "process.milling.axial_depth_mm",
        words: "axial depth",
        factors: &[0.5, 2.0],
    },
];

const REPLAY: &[Knob] = &[
    Knob {
        key: "process.replay.amplitude_factor",
        words: "amplitude of the inputs",
        factors: &[0.3, 2.0],
    },
    Knob {
        key: "process.replay.speed_factor",
        words: "speed of the inputs",
        factors: &[0.3, 2.0],
    },
];

/// Variations of the keys that the scenario gives, one at a time.
pub(super) fn experiments(scenario: &Scenario) -> Vec<Experiment> {
    let knobs = match &scenario.process {
        ProcessSpec::Chamfer(_) => CHAMFER,
        ProcessSpec::Wheel(_) => WHEEL,
        ProcessSpec::Replay(_) => REPLAY,
        ProcessSpec::Milling(_) => MILLING,
        ProcessSpec::Polish(_) => POLISH,
        ProcessSpec::Belt(_) | ProcessSpec::Brush(_) | ProcessSpec::Load(_) => &[],
    };
    let variation = |knob: &Knob, factor: f64| {
        let replay = matches!(scenario.process, ProcessSpec::Replay(_));
        let now = if replay {
            Some(1.0)
        } else {
            scenario.number(knob.key)
        };
        now.map(|now| Experiment {
            description: format!("{} {} instead of {now}", knob.words, factor * now),
            overrides: vec![(knob.key.to_owned(), format!("{:?}", factor * now))],
        })
    };
    (knobs.iter())
        .flat_map(|knob| knob.factors.iter().filter_map(move |f| variation(knob, *f)))
        .collect()
}
