//! Parts that the pages of several commands have.

use maud::{Markup, html};
use truecut_recording::{ClaimResult, Scalar};
use truecut_scenario::Scenario;

use crate::text::{show, with_note};

/// A table under its title; nothing where it has no rows. A row is its cells.
pub fn table(title: &str, head: &[impl AsRef<str>], rows: impl Iterator<Item = Markup>) -> Markup {
    let mut rows = rows.peekable();
    if rows.peek().is_none() {
        return html! {};
    }
    html! {
        h2 { (title) }
        table {
            tr { @for cell in head { th { (cell.as_ref()) } } }
            @for row in rows { tr { (row) } }
        }
    }
}

/// Cells of a row, numbers to the right.
pub fn cells(texts: &[impl AsRef<str>]) -> Markup {
    html! {
        @for text in texts.iter().map(AsRef::as_ref) {
            td.n[text.parse::<f64>().is_ok()] { (text) }
        }
    }
}

/// Claims under a title: whether each holds, its value and bounds, and why it must hold.
pub fn claims(title: &str, claims: &[ClaimResult]) -> Markup {
    let rows = claims.iter().map(|claim| {
        let holds = if claim.holds {
            "✓ holds"
        } else {
            "✗ fails"
        };
        cells(&[holds, &claim.name, &with_note(claim), &claim.reason])
    });
    table(title, &["", "claim", "found", "why it must hold"], rows)
}

/// Single results, with what they are.
pub fn scalars(scalars: &[Scalar]) -> Markup {
    let rows = scalars.iter().map(|one| {
        let value = show(one.unit, one.value);
        html! { td { (one.name) } td.n { (value) } td { (one.description) } }
    });
    table("Results", &["result", "value", "what it is"], rows)
}

/// How a printed note begins.
pub const NOTE: &str = "  note: ";

/// What a reader should know: assumptions made, and what was done.
pub fn notes(notes: &[impl AsRef<str>]) -> Markup {
    html! {
        @if !notes.is_empty() {
            h2 { "Assumptions and notes" }
            ul { @for note in notes { li { (note.as_ref()) } } }
        }
    }
}

/// The call that gives this again, and the scenario that it reads, as it was read.
pub fn reproduce(call: &str, scenario: &Scenario) -> Markup {
    let name = format!("{}.toml", scenario.stem());
    html! {
        (repeat(call, &name))
        details {
            summary { (name) ", with everything that was set on the command line" }
            pre { (scenario.effective_text()) }
        }
    }
}

/// The call as it was made, of a command whose options say all.
pub fn called() -> Markup {
    let words = std::env::args_os().skip(1);
    let words = words.map(|word| quoted(&word.to_string_lossy()));
    repeat("truecut", &words.collect::<Vec<_>>().join(" "))
}

/// A word as a shell takes it for one.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_./=:,+@%".contains(c);
    match !word.is_empty() && word.chars().all(is_plain) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', r"'\''")),
    }
}

/// The call alone.
pub fn repeat(call: &str, name: &str) -> Markup {
    html! {
        h2 { "How to reproduce" }
        p { code { (call) " " (name) } ", version " (env!("CARGO_PKG_VERSION")) "." }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_stay_words_in_a_shell() {
        assert_eq!(quoted("--work-xyz-mm=1,2,-3.5"), "--work-xyz-mm=1,2,-3.5");
        assert_eq!(quoted("my part.nc"), "'my part.nc'");
        assert_eq!(quoted("it's $(x)"), r"'it'\''s $(x)'");
        assert_eq!(quoted(""), "''");
    }
}
