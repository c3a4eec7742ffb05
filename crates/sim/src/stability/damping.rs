//! What the choice of the arm's damping is worth, and what is to be said of it.

use std::f64::consts::TAU;

use truecut_core::chatter::TipMode;
use truecut_plan::modes_in_cut;

use super::{MillingStudy, in_scenario};
use crate::error::SimError;

/// Modes under the damping that the scenario did not choose.
#[derive(Debug, Clone, PartialEq)]
pub struct OtherDamping {
    /// What it is, to be put behind "with".
    pub name: String,
    pub modes: Vec<TipMode>,
}

impl MillingStudy {
    /// The modes at a posture with the other damping of the arm: one ratio in all its modes, that
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
        let axes = self.path.world_from_milling(0);
        let modes =
            modes_in_cut(&robot, posture, &axes, &self.cut.attached).map_err(in_scenario)?;
        let ratios = |modes: &[TipMode]| -> Vec<f64> {
            modes.iter().map(|mode| mode.damping_ratio).collect()
        };
        let own = ratios(&self.modes(posture)?);
        let differs = own
            .iter()
            .zip(ratios(&modes))
            .any(|(a, b)| (a - b).abs() > 1e-9);
        Ok(differs.then_some(OtherDamping { name, modes }))
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
