//! The answer of a search in words of changes.

use super::answer::Verdict;
use crate::diagnose::{self, ChannelErrors, Diagnosis, NoiseSource, UnknownCurve};

/// What the search found, as a verdict on changes, and a sentence.
pub(super) fn verdict(found: &Diagnosis, undecided: &[String]) -> (Verdict, String) {
    use diagnose::Verdict as Of;
    let alike = "Several changes explain what differs alike.";
    match found.verdict {
        Of::NothingBeyondNoise if undecided.is_empty() => (
            Verdict::NothingChanged,
            format!(
                "Between the recordings nothing changed beyond noise ({}).",
                noise(found)
            ),
        ),
        Of::NothingBeyondNoise => (
            Verdict::Ambiguous,
            format!(
                "The second recording shows {}; the first does not show whether it was there before.",
                undecided.join(" and ")
            ),
        ),
        Of::Named => (
            Verdict::Changed,
            format!(
                "The changes named explain what differs up to noise ({}).",
                noise(found)
            ),
        ),
        Of::Ambiguous => (
            Verdict::Ambiguous,
            match found.further.as_slice() {
                [] => alike.to_owned(),
                further => format!(
                    "{alike} Less likely, and not excluded: {}.",
                    further.join(", ")
                ),
            },
        ),
        Of::UnknownCause => (Verdict::UnknownChange, unknown(found)),
        Of::NotIdentifiable => (
            Verdict::NotIdentifiable,
            "The recordings would show next to none of the changes at their typical size."
                .to_owned(),
        ),
        Of::FitFailed => (Verdict::FitFailed, found.reason.clone()),
    }
}

fn noise(found: &Diagnosis) -> String {
    let mut sources: Vec<&str> = (found.channels.values())
        .map(|errors| match errors.noise_source {
            NoiseSource::Bound => "known from nothing but what is left",
            source => source.description(),
        })
        .collect();
    sources.sort_unstable();
    sources.dedup();
    sources.join(", ")
}

fn unknown(found: &Diagnosis) -> String {
    let what = match found.causes.is_empty() {
        true => "Something changed that no effect known explains",
        false => "The changes named do not explain all that differs",
    };
    let along = |curve: &UnknownCurve| {
        let over = match curve.kind.as_str() {
            "joint_friction_by_speed" => "speed",
            _ => "position",
        };
        format!(
            "it looks like a {} that follows the {over} of {}",
            match curve.kind.as_str() {
                "joint_position_curve" => "force",
                _ => "friction",
            },
            curve.target
        )
    };
    let signal = found.ceiling.correlated_signals.first();
    let followed =
        signal.map(|one| format!("what is left of `{}` follows {}", one.channel, one.signal));
    let most = found.channels.iter().max_by(|a, b| {
        let ratio = |one: &ChannelErrors| one.after / one.noise_floor;
        ratio(a.1).total_cmp(&ratio(b.1))
    });
    let left = most.map(|(name, _)| format!("most is left of `{name}`"));
    match found.curve.as_ref().map(along).or(followed).or(left) {
        Some(told) => format!("{what}; {told}."),
        None => format!("{what}."),
    }
}
