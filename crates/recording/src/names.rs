//! Finding the name that was meant.

/// The candidate nearest to `wanted` by edit distance, upper and lower case taken as equal, if it
/// is near enough to be what was meant: at most a third of the letters differ, or one of them
/// contains the other.
pub fn nearest<'a>(wanted: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let folded = wanted.to_lowercase();
    let letters = folded.chars().count();
    let holds = |name: &str| !folded.is_empty() && name.to_lowercase().contains(&folded);
    // As many letters must come or go as the lengths differ by: most names need no distance, and
    // a word of a million letters costs nothing.
    let may_be_near = |name: &&str| {
        let other = name.chars().count();
        letters.abs_diff(other) * 3 <= letters.max(other) || holds(name)
    };
    let scored = (candidates.into_iter())
        .filter(may_be_near)
        .map(|name| (distance(&folded, &name.to_lowercase()), name));
    let (edits, name) = scored.min_by_key(|(edits, _)| *edits)?;
    let length = letters.max(name.chars().count());
    let contained = holds(name);
    (edits * 3 <= length || (edits == 1 && length > 1) || contained).then_some(name)
}

/// Edits that turn one text into the other: insertion, deletion, substitution, and exchange of
/// neighbours.
fn distance(from: &str, to: &str) -> usize {
    strsim::damerau_levenshtein(from, to)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_of_the_pen_is_found() {
        let names = [
            "tool.displacement_x",
            "tool.displacement_y",
            "foot.normal_force",
        ];
        assert_eq!(
            nearest("tool.displacment_y", names),
            Some("tool.displacement_y")
        );
        assert_eq!(nearest("foot.normal", names), Some("foot.normal_force"));
        assert_eq!(
            nearest("spindle_rpm", names),
            None,
            "nothing near: no guess"
        );
        assert_eq!(nearest("x", std::iter::empty()), None);
        // The distance of this one would take minutes.
        assert_eq!(nearest(&"imagina".repeat(100_000), names), None);
    }
}
