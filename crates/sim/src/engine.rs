//! What integrates the arm.

/// What integrates the arm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Engine {
    /// The full model: a multibody in rapier.
    Rapier,
    /// The arm linearised and exactly stepped ([`crate::plant::ReducedPlant`]): many times as fast.
    Reduced {
        /// Runs that need a shorter step are refused, s; 0 refuses none.
        shortest_step_s: f64,
        /// Default steps in one period of the fastest mode.
        steps_per_period: StepsPerPeriod,
    },
}

impl Engine {
    /// The reduced plant, whatever step it needs.
    pub const REDUCED: Engine = Engine::Reduced {
        shortest_step_s: 0.0,
        steps_per_period: StepsPerPeriod::DEFAULT,
    };
}

/// Default steps of the reduced plant in one period of the fastest mode, at least 4. The scheme
/// keeps every mode in tune at any step; what it needs are enough samples of the motion for
/// contacts, records and friction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepsPerPeriod {
    /// Where no joint has play.
    pub without_play: f64,
    /// Where one has: of what happens when flanks meet a step must see enough.
    pub with_play: f64,
}

impl StepsPerPeriod {
    /// Those of a run of which nothing else is known.
    pub const DEFAULT: StepsPerPeriod = StepsPerPeriod {
        without_play: 20.0,
        with_play: 40.0,
    };
}
