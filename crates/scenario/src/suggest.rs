//! What a person most likely meant when a key is not known.

use crate::units::{quantity, split_suffix};

/// The keys of `known` that are `name` with a unit behind it, or with another unit than `name` has.
pub(crate) fn same_quantity<'a>(
    name: &str,
    known: impl IntoIterator<Item = &'a str>,
) -> Vec<(&'a str, &'static str)> {
    let stem = quantity(name);
    known
        .into_iter()
        .filter_map(|candidate| {
            let (candidate_stem, unit) = split_suffix(candidate)?;
            (candidate_stem == stem || candidate_stem == name).then_some((candidate, unit))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_or_other_unit_finds_the_quantity() {
        let known = ["pressure_mpa", "bore_mm", "cylinders"];
        assert_eq!(same_quantity("pressure", known), [("pressure_mpa", "MPa")]);
        assert_eq!(same_quantity("bore_um", known), [("bore_mm", "mm")]);
        assert_eq!(
            same_quantity("pressure_bar", known),
            [("pressure_mpa", "MPa")]
        );
        for foreign in ["bore_inch", "bore_in", "pressure_psi"] {
            assert_eq!(same_quantity(foreign, known).len(), 1, "{foreign}");
        }
        assert!(same_quantity("cylinders", known).is_empty());
        assert!(same_quantity("presure_mpa", known).is_empty());
    }
}
