//! What other programs, and people, write for units.

use super::SYMBOLS;
use crate::names::nearest;

/// What other programs write for a unit, and can mean nothing else by, in small letters.
const SYNONYMS: [(&str, &str); 8] = [
    ("degree", "deg"),
    ("degrees", "deg"),
    ("°/s", "deg/s"),
    ("°/s^2", "deg/s^2"),
    ("sec", "s"),
    ("sek", "s"),
    ("1/min", "rpm"),
    ("u/min", "rpm"),
];

/// What may mean a unit whose symbol is spelt less like it than that of another: "Grad" is nearer
/// to "rad" than to "deg". A "grad" is a hundredth of a right angle, too.
const WORDS: [(&str, &str); 2] = [("grad", "deg"), ("grad/s", "deg/s")];

/// The symbol that was meant by a text that is none: by its word, else by its spelling.
pub(super) fn meant(text: &str) -> Option<&'static str> {
    let lower = text.to_lowercase();
    let mut words = SYNONYMS.iter().chain(&WORDS);
    let word = words.find(|(word, _)| *word == lower);
    word.map(|(_, symbol)| *symbol)
        .or_else(|| run_together(text))
        .or_else(|| nearest(text, SYMBOLS.iter().map(|entry| entry.0)))
}

/// The symbol for what a file writes, if that can mean nothing else.
pub(super) fn in_files(text: &str) -> Option<&'static str> {
    let plain = text.trim().replace('²', "^2").replace('³', "^3");
    let plain = plain.replace(['·', '⋅', '*'], " ");
    let mut symbols = SYMBOLS.iter().map(|entry| entry.0);
    symbols.find(|symbol| *symbol == plain).or_else(|| {
        let lower = plain.to_lowercase();
        let found = SYNONYMS.iter().find(|(word, _)| *word == lower);
        found
            .map(|(_, symbol)| *symbol)
            .or_else(|| run_together(&plain))
    })
}

/// The symbol of a product whose blanks were left out: "kNm".
fn run_together(text: &str) -> Option<&'static str> {
    let mut symbols = SYMBOLS.iter().map(|entry| entry.0);
    let without = |symbol: &str| symbol.replace(' ', "");
    symbols.find(|symbol| symbol.contains(' ') && without(symbol) == without(text))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_files_write_is_a_symbol_if_it_can_mean_nothing_else() {
        for (written, symbol) in [
            ("N·m", "N m"),
            (" mm ", "mm"),
            ("m/s²", "m/s^2"),
            ("°/s²", "deg/s^2"),
            ("1/min", "rpm"),
            ("U/min", "rpm"),
            ("mm³", "mm^3"),
            ("Degrees", "deg"),
            ("kNm", "kN m"),
            ("kN*m", "kN m"),
        ] {
            assert_eq!(in_files(written), Some(symbol), "{written}");
        }
        for other in ["grad", "Mm", "°C", "", "x", "n m"] {
            assert_eq!(in_files(other), None, "{other}");
        }
        for (_, symbol) in SYNONYMS.iter().chain(&WORDS) {
            assert!(SYMBOLS.iter().any(|entry| entry.0 == *symbol), "{symbol}");
        }
    }
}
