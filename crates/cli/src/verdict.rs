//! What a command comes to, and its exit code.

use std::process::ExitCode;

/// How a command ended; the discriminant is the exit code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Verdict {
    /// Everything holds.
    Good = 0,
    /// A claim does not hold.
    ClaimFailed = 1,
    /// The input is bad, or something that was asked for cannot be had.
    BadInput = 2,
    /// A run diverged.
    Diverged = 3,
    /// The two engines disagree.
    Disagrees = 4,
}

impl Verdict {
    /// The graver of two: bad input (nothing is known) before divergence, disagreement and a failed claim.
    pub fn and(self, other: Verdict) -> Verdict {
        let gravity = |verdict| match verdict {
            Verdict::Good => 0,
            Verdict::ClaimFailed => 1,
            Verdict::Disagrees => 2,
            Verdict::Diverged => 3,
            Verdict::BadInput => 4,
        };
        if gravity(other) > gravity(self) {
            other
        } else {
            self
        }
    }
}

impl From<Verdict> for ExitCode {
    fn from(verdict: Verdict) -> ExitCode {
        ExitCode::from(verdict as u8)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gravest_verdict_wins_whatever_the_order() {
        use Verdict::{BadInput, ClaimFailed, Disagrees, Diverged, Good};
        let by_gravity = [Good, ClaimFailed, Disagrees, Diverged, BadInput];
        for (index, lesser) in by_gravity.iter().enumerate() {
            for greater in &by_gravity[index..] {
                assert_eq!(lesser.and(*greater), *greater);
                assert_eq!(greater.and(*lesser), *greater);
            }
        }
    }
}
