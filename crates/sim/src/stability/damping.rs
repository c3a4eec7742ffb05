//! What the choice of the arm's damping is worth, and what is to be said of it.

use std::f64::consts::TAU;

use truecut_arm::Robot;
use truecut_core::chatter::TipMode;

use super::{MillingStudy, in_scenario};
use crate::error::SimError;

/// The arm with the damping that the scenario did not choose.
#[derive(Debug, Clone)]
pub struct OtherDamping {
    /// What it is, to be put behind "with".
    pub name: String,
    pub robot: Robot,
}

impl MillingStudy {
    /// The arm with its other damping: one ratio in all its modes, that
    /// of the slowest, where the scenario takes the transmissions' damping; the transmissions'
    /// where it gives ratios. `None` for an arm that has the same by both.
    ///
    /// # Errors
    /// As [`Self::modes`].
    pub fn other_damping(&self, posture: &[f64]) -> Result<Option<OtherDamping>, SimError> {
        let mut robot = (*self.robot).clone();
        let name = if robot.damping_ratios.is_empty() {
            let slowest = robot.modes(posture, None)?.damping_ratio[0];
            robot.damping_ratios = vec![slowest];
            format!("{:.2} % in every mode of the arm", 100.0 * slowest)
        } else {
            robot.damping_ratios.clear();
            "the damping of the joints".to_owned()
        };
        let modes = self.modes_of(&robot, posture, self.cut.spindle_rad_s);
        let modes = modes.map_err(in_scenario)?;
        let ratios = |modes: &[TipMode]| -> Vec<f64> {
            modes.iter().map(|mode| mode.damping_ratio).collect()
        };
        let own = ratios(&self.modes(posture)?);
        let differs = own
            .iter()
            .zip(ratios(&modes))
            .any(|(a, b)| (a - b).abs() > 1e-9);
        Ok(differs.then_some(OtherDamping { name, robot }))
    }
}

/// Sentences on modes whose damping a reader should know of.
pub(super) fn damping_notes(modes: &[TipMode]) -> Vec<String> {
    let beyond = modes.iter().filter(|mode| mode.damping_ratio >= 1.0);
    let mut notes: Vec<String> = beyond
        .map(|mode| {
            format!(
                "the mode at {:.1} Hz is damped by {:.0} %: it does not vibrate; damping that grows with frequency, as that of joints \
                 does, may be no measured one (robot.damping_ratio)",
                mode.natural_frequency_rad_s / TAU,
                100.0 * mode.damping_ratio
            )
        })
        .collect();
    if modes.iter().any(|mode| mode.damping_ratio == 0.0) {
        notes.push(
            "there are modes without damping: limits depend on it and are far too low".to_owned(),
        );
    }
    notes
}
