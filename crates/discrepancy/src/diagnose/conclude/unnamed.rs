//! What has no name, in the answer.

use crate::diagnose::DiagnoseError;
use crate::diagnose::answer::{Diagnosis, Verdict, names};
use crate::diagnose::curve::{Shown, shown};
use crate::diagnose::fit::Fit;
use crate::diagnose::floor::NoiseSource;
use crate::diagnose::problem::Problem;
use crate::diagnose::search::Outcome;
use crate::diagnose::validate::rms;
use crate::stats::ratio;

/// The curve that shows what the causes leave: on any joint where the cause is unknown, or what is
/// left is noise only if noise has a long memory, or a signal foretells much of it (`is_hinted`);
/// on those that have a cause where causes are named, whose shape it may not be.
pub(super) fn curve(
    problem: &Problem,
    outcome: &Outcome,
    fits: [&Fit; 2],
    is_hinted: bool,
    diagnosis: &Diagnosis,
) -> Result<Option<Shown>, DiagnoseError> {
    match diagnosis.verdict {
        Verdict::UnknownCause => shown(problem, outcome, fits, false),
        Verdict::Named => shown(problem, outcome, fits, true),
        Verdict::NothingBeyondNoise if is_hinted || is_doubtful(diagnosis) => {
            shown(problem, outcome, fits, false)
        }
        Verdict::NothingBeyondNoise
        | Verdict::Ambiguous
        | Verdict::NotIdentifiable
        | Verdict::FitFailed => Ok(None),
    }
}

/// What is left may be so many times what it would be without memory, and pass for noise.
const BY_MEMORY: f64 = 2.0;

/// Whether no one knows how much of what is left is noise, and most of it follows from what came
/// before.
fn is_doubtful(diagnosis: &Diagnosis) -> bool {
    let mut channels = diagnosis.channels.values();
    channels.any(|errors| {
        errors.noise_source == NoiseSource::Bound
            && errors.after > BY_MEMORY * errors.noise_without_memory
    })
}

/// The verdict with a curve: where it stands, how sure it is, and what it takes away on data that
/// it was not fitted to.
pub(super) fn tell(problem: &Problem, last: &Fit, shown: &Shown, diagnosis: &mut Diagnosis) {
    let curve = &shown.curve;
    let what = match (curve.kind.as_str(), curve.unit.as_str()) {
        ("joint_position_curve", "N") => "a force that follows the position",
        ("joint_position_curve", _) => "a torque that follows the position",
        ("joint_friction_by_position", _) => "a friction that follows the position",
        _ => "a friction that follows the speed",
    };
    let test = &problem.split.test;
    let [without, with] = [last, &shown.fit].map(|fit| rms(&fit.residual, test));
    let gain = |c: &usize| ratio(without[*c], with[*c]);
    let most = (0..without.len()).max_by(|a, b| gain(a).total_cmp(&gain(b)));
    // Where the law is not met it follows the noise a little.
    let told = most.filter(|c| with[*c] < without[*c]).map(|c| {
        let spec = &problem.model.channels()[c];
        let number = |x: f64| truecut_recording::significant(x, 3);
        format!(
            " On data it was not fitted to, the error of `{}` falls from {} to {} {}.",
            spec.name,
            number(without[c]),
            number(with[c]),
            spec.unit
        )
    });
    let instead = match (diagnosis.verdict, last.point.effects.is_empty()) {
        (Verdict::Named, _) => format!(
            "{} would explain the discrepancy, but not its shape: it",
            names(problem, &last.point).join(" + ")
        ),
        (_, true) => "No effect known explains the discrepancy; it".to_owned(),
        (_, false) => "The effects known do not explain the discrepancy; what is left".to_owned(),
    };
    diagnosis.verdict = Verdict::UnknownCause;
    diagnosis.reason = format!(
        "{instead} looks like {what} of {}, shown as a curve (odds against the model without it {}).{}",
        curve.target,
        match curve.log10_odds {
            6.0.. => "more than 1e6 : 1".to_owned(),
            log10 => format!("{:.0} : 1", 10_f64.powf(log10)),
        },
        told.unwrap_or_else(|| {
            " The last part of the data does not show it; blocks before that it was not fitted to do."
                .to_owned()
        })
    );
    diagnosis.curve = Some(curve.clone());
}
