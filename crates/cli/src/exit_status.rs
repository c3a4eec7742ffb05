//! Exit status of a command.

use std::process::ExitCode;

use truecut_recording::{ClaimResult, Outcome};
use truecut_sim::sweep::SweepTable;

/// How a command ended; the discriminant is the exit code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum ExitStatus {
    /// All claims hold.
    Good = 0,
    /// A claim does not hold.
    ClaimFailed = 1,
    /// Bad input, or a request that cannot be met.
    BadInput = 2,
    /// A run diverged.
    Diverged = 3,
    /// The two engines disagree.
    Disagrees = 4,
    /// A run ended in chatter.
    Chatter = 5,
    /// More was asked of a drive than it gives.
    Overloaded = 6,
    /// A run's masses or inertias are no arm's.
    Placeholders = 7,
    /// A run left what its model describes.
    BeyondModel = 8,
}

impl ExitStatus {
    /// ExitStatus of a run and its claims.
    pub fn of_run(outcome: &Outcome, claims: &[ClaimResult]) -> ExitStatus {
        ExitStatus::of_outcome(outcome).and(ExitStatus::of_claims(claims))
    }

    /// ExitStatus of a run, claims aside.
    pub fn of_outcome(outcome: &Outcome) -> ExitStatus {
        match outcome {
            Outcome::Completed => ExitStatus::Good,
            Outcome::Overloaded { .. } => ExitStatus::Overloaded,
            Outcome::Placeholders { .. } => ExitStatus::Placeholders,
            Outcome::BeyondModel { .. } => ExitStatus::BeyondModel,
            Outcome::Diverged { .. } | Outcome::Interrupted => ExitStatus::Diverged,
            Outcome::Chatter { .. } => ExitStatus::Chatter,
        }
    }

    /// ExitStatus of a sweep and its claims.
    pub fn of_sweep(table: &SweepTable, claims: &[ClaimResult]) -> ExitStatus {
        let faults = table.faults.iter().flatten();
        faults
            .map(|run| ExitStatus::of_outcome(&run.outcome))
            .fold(ExitStatus::of_claims(claims), ExitStatus::and)
    }

    fn of_claims(claims: &[ClaimResult]) -> ExitStatus {
        if claims.iter().all(|claim| claim.holds) {
            ExitStatus::Good
        } else {
            ExitStatus::ClaimFailed
        }
    }

    /// The more severe of two: bad input before divergence, chatter, overload, a run beyond its
    /// model, placeholders, disagreement and a failed claim.
    pub fn and(self, other: ExitStatus) -> ExitStatus {
        let gravity = |status| match status {
            ExitStatus::Good => 0,
            ExitStatus::ClaimFailed => 1,
            ExitStatus::Disagrees => 2,
            ExitStatus::Placeholders => 3,
            ExitStatus::BeyondModel => 4,
            ExitStatus::Overloaded => 5,
            ExitStatus::Chatter => 6,
            ExitStatus::Diverged => 7,
            ExitStatus::BadInput => 8,
        };
        if gravity(other) > gravity(self) {
            other
        } else {
            self
        }
    }
}

impl From<ExitStatus> for ExitCode {
    fn from(status: ExitStatus) -> ExitCode {
        ExitCode::from(status as u8)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gravest_status_wins_whatever_the_order() {
        use ExitStatus::*;
        let by_gravity = [
            Good,
            ClaimFailed,
            Disagrees,
            Placeholders,
            BeyondModel,
            Overloaded,
            Chatter,
            Diverged,
            BadInput,
        ];
        for (index, lesser) in by_gravity.iter().enumerate() {
            for greater in &by_gravity[index..] {
                assert_eq!(lesser.and(*greater), *greater);
                assert_eq!(greater.and(*lesser), *greater);
            }
        }
    }
}
