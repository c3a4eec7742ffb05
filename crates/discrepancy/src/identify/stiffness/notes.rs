//! Notes on an identification of stiffness.

use truecut_recording::significant;

use super::doubts::of_units;
use super::{Status, StiffnessReport};

pub(super) fn notes(
    report: &StiffnessReport,
    beyond_noise: bool,
    unknown_zero: bool,
) -> Vec<String> {
    let mut notes = Vec::new();
    if let (true, Some(times)) = (beyond_noise, report.residual_over_noise) {
        notes.push(format!(
            "the residual is {} times the stated noise: something other than constant joint \
             stiffness bends, slips or \
             was mismeasured; the intervals are widened by it",
            significant(times, 3)
        ));
    }
    if let Some(worst) = report.outliers.first() {
        let more = match report.outliers.len() {
            1 => String::new(),
            count => format!(", and {} more stand out", count - 1),
        };
        notes.push(format!(
            "{} of {} is {} times the typical residual off{more}: it was used all the same",
            worst.place,
            report.source,
            significant(worst.sigmas, 3)
        ));
    }
    let contradictory = |joint: &&super::JointStiffness| joint.status == Status::Contradictory;
    if report.joints.iter().any(|joint| contradictory(&joint)) {
        notes.push(
            "a compliance is below zero by more than noise: loads act on the arm (not on what it \
             presses against), \
             and displacements count in the same axes; is a sign or an axis the other way round?"
                .to_owned(),
        );
    }
    notes.extend(of_units(report));
    if unknown_zero {
        notes.push("a zero was estimated for each posture and component".to_owned());
    }
    notes
}
