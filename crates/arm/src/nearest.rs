//! Names that were most likely meant.

/// Jaro-Winkler's likeness from which a name is taken for a slip of another.
const LIKE: f64 = 0.85;

/// The known name that is most like `name`, if it may be a slip of it.
pub(crate) fn nearest<'k>(name: &str, known: impl Iterator<Item = &'k str>) -> Option<&'k str> {
    let likeness = known.map(|own| (strsim::jaro_winkler(own, name), own));
    let best = likeness.max_by(|a, b| a.0.total_cmp(&b.0));
    best.filter(|(likeness, _)| *likeness > LIKE)
        .map(|(_, own)| own)
}
