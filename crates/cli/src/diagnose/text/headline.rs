//! The verdict with what it is about, to be read first.

use truecut_discrepancy::diagnose::{Diagnosis, Verdict};

use super::{name, names_of};

/// The verdict as text.
fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::NothingBeyondNoise => "nothing beyond noise",
        Verdict::Named => "cause named",
        Verdict::Ambiguous => "these cannot be told apart",
        Verdict::UnknownCause => "none of the causes known",
        Verdict::NotIdentifiable => "not identifiable from these data",
        Verdict::FitFailed => "the fit failed",
    }
}

/// The verdict with the causes that it is about: to be read first.
pub fn headline(diagnosis: &Diagnosis) -> String {
    let names: Vec<String> = diagnosis.causes.iter().map(name).collect();
    let rivals = diagnosis.alternatives.iter().map(names_of);
    let verdict = verdict(diagnosis.verdict).to_uppercase();
    match diagnosis.verdict {
        Verdict::Named => format!("{verdict}: {}", names.join(" and ")),
        Verdict::UnknownCause => unknown(diagnosis, &verdict),
        Verdict::Ambiguous => {
            let all: Vec<String> = std::iter::once(names.join(" and ")).chain(rivals).collect();
            format!("{verdict}: {}", all.join(" or "))
        }
        _ => verdict,
    }
}

/// The headline where the cause is unknown. What takes away no more than half of the discrepancy is
/// not its cause, unless most of a channel's error goes with it.
fn unknown(diagnosis: &Diagnosis, verdict: &str) -> String {
    // Beside a curve that does as much, a cause may have the odds against it.
    let causes = diagnosis.causes.iter();
    let likely = causes.filter(|cause| cause.evidence.log10_odds > 0.0);
    let names: Vec<String> = likely.map(name).collect();
    let likelier = diagnosis.alternatives.iter().map(names_of);
    let all: Vec<String> = std::iter::once(names.join(" and "))
        .chain(likelier)
        .collect();
    let changes = match diagnosis.changes.is_empty() {
        true => "",
        false => ", AND IT CHANGES OVER TIME",
    };
    match names.is_empty() {
        true => format!("{verdict}{changes}"),
        false if diagnosis.at_end.is_some() => format!(
            "{verdict} FITS{changes}; NEAREST, AT AN END OF ITS RANGE: {}",
            all.join(" or ")
        ),
        false if diagnosis.unexplained_fraction > 0.5 && diagnosis.most_fallen().is_none() => {
            format!("{verdict}{changes}; A SMALL PART: {}", all.join(" or "))
        }
        false => format!(
            "CAUSE NAMED, BUT NOT ALL OF IT{changes}: {}",
            all.join(" or ")
        ),
    }
}
