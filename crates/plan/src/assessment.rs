//! What a criterion says of a posture.

/// Least decay of a cut by regeneration, as a part of the decay of the arm's slowest decaying mode
/// when nothing is cut: what the cut may take of the arm's own damping is the other half.
///
/// A choice, no law: near the limit every disturbance rings on, and damping, which decides there,
/// is what is known least of an arm. A part of 1 would be too much to ask: a mode in which the tool
/// does not move dies away at its own rate, whatever is cut.
pub const LEAST_DECAY: f64 = 0.5;

/// How vibration at the cut's own depth behaves by regeneration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Decay {
    /// Growth rate of vibration, 1/s; below zero it dies away.
    pub growth_per_s: f64,
    /// Decay that is asked for, 1/s.
    pub least_per_s: f64,
}

/// Three answers to whether a cut is stable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stability {
    Stable,
    /// Vibration does not grow, but dies away too slowly to rely on, or would grow in a shallower
    /// cut. Plans keep away from it, and nobody should expect chatter either.
    Marginal,
    Unstable,
}

/// What a criterion says of a posture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Assessment {
    /// r of [`crate::Criterion::Anisotropy`], else the limit depth in m; infinite if no depth is
    /// unstable, or none up to three times the cut's for [`crate::Criterion::Regenerative`].
    pub value: f64,
    /// value / needed − 1. −0.3 says that 30 % are missing.
    pub margin: f64,
    /// Of [`crate::Criterion::Regenerative`] only.
    pub decay: Option<Decay>,
    /// Of its limit, where there is one: by how much the discretisation in time puts it wrong, m.
    pub error_m: Option<f64>,
}

impl Assessment {
    pub fn stability(&self) -> Stability {
        let grows = match self.decay {
            Some(decay) => decay.growth_per_s >= 0.0 || decay.growth_per_s.is_nan(),
            None => self.margin < 0.0,
        };
        match self.reserve() >= 0.0 {
            _ if grows => Stability::Unstable,
            true => Stability::Stable,
            false => Stability::Marginal,
        }
    }

    pub fn is_stable(&self) -> bool {
        self.stability() == Stability::Stable
    }

    /// The lesser of the margins of depth and of decay, each over what is needed: stable from 0 on.
    pub fn reserve(&self) -> f64 {
        let of_decay = |decay: Decay| -decay.growth_per_s / decay.least_per_s - 1.0;
        self.decay
            .map_or(self.margin, |decay| of_decay(decay).min(self.margin))
    }

    /// Decay of vibration at the cut's own depth, 1/s; none by a criterion that knows none.
    pub fn decay_per_s(&self) -> Option<f64> {
        self.decay.map(|decay| -decay.growth_per_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(margin: f64, growth_per_s: f64) -> Assessment {
        Assessment {
            value: 1.0,
            margin,
            decay: Some(Decay {
                growth_per_s,
                least_per_s: 0.4,
            }),
            error_m: None,
        }
    }

    #[test]
    fn three_answers() {
        use Stability::{Marginal, Stable, Unstable};
        let cases = [
            (0.8, -1.2, Stable, 0.8),
            (3.0, -0.6, Stable, 0.5),
            (0.8, -0.3, Marginal, -0.25),
            // Stable at this depth, not at half of it.
            (-0.4, -0.8, Marginal, -0.4),
            (-0.5, 0.2, Unstable, -1.5),
        ];
        for (margin, growth, expected, reserve) in cases {
            let found = found(margin, growth);
            assert_eq!(found.stability(), expected, "{margin} {growth}");
            assert!((found.reserve() - reserve).abs() < 1e-12);
        }
        let without = |margin| Assessment {
            decay: None,
            ..found(margin, 0.0)
        };
        assert_eq!(without(0.1).stability(), Stable);
        assert_eq!(without(-0.1).stability(), Unstable);
    }
}
