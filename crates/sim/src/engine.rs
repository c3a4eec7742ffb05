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
        /// Default steps in one period of the fastest mode, at least 4. Where no joint has play.
        steps_per_period: f64,
    },
}

impl Engine {
    /// Steps of the reduced plant in one period of the fastest mode, unless told otherwise.
    pub const STEPS_PER_PERIOD: f64 = 20.0;

    /// The reduced plant, whatever step it needs.
    pub const REDUCED: Engine = Engine::Reduced {
        shortest_step_s: 0.0,
        steps_per_period: Engine::STEPS_PER_PERIOD,
    };
}
