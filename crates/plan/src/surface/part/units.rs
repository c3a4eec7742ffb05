//! Whether a file may have another unit than it is read in. No format says its unit; what is
//! looked at is how large the part comes out, and which unit makes its sides round numbers.

use nalgebra::Vector3;
use serde::Serialize;

/// Longest side of what a robot machines, m.
const LIKELY_M: [f64; 2] = [5e-3, 10.0];
/// Sides in single precision are round to this share.
const ROUND: f64 = 1e-5;

/// Another unit that a file may have.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SuspectedUnit {
    /// "another unit" where it is none of those that are known.
    pub name: &'static str,
    /// Of a unit that is known.
    pub unit_m: Option<f64>,
    pub why: String,
}

const INCH: (&str, f64) = ("inch", 0.0254);

/// The unit that speaks against the one that is assumed, if any does; `sides` are those of the box
/// about the part, in the file's unit.
pub(super) fn suspected(sides: &Vector3<f64>, unit_m: f64) -> Option<SuspectedUnit> {
    let longest = sides.max();
    let likely = |unit_m: f64| (LIKELY_M[0]..=LIKELY_M[1]).contains(&(longest * unit_m));
    let suspect = |(name, unit_m): (&'static str, f64), why: String| SuspectedUnit {
        name,
        unit_m: Some(unit_m),
        why,
    };
    if !likely(unit_m) {
        // The one that brings it closest to the middle of what is likely, in ratio.
        let middle_m = (LIKELY_M[0] * LIKELY_M[1]).sqrt();
        let far = |unit_m: f64| (longest * unit_m / middle_m).ln().abs();
        let others = [("m", 1.0), INCH, ("mm", 1e-3), ("µm", 1e-6)];
        let others = others.into_iter().filter(|(_, unit_m)| likely(*unit_m));
        let size_mm = longest * unit_m * 1e3;
        let Some(other) = others.min_by(|a, b| far(a.1).total_cmp(&far(b.1))) else {
            return Some(of_no_size(size_mm));
        };
        let why = format!("the longest side would be {size_mm:.4} mm as it is read");
        return Some(suspect(other, why));
    }
    // Sides of a model in mm that was written in inches are round only in mm, and the other way.
    let round = |step: f64| {
        let steps = sides.map(|side| side / step);
        let off = steps.map(|s| (s - s.round()).abs());
        (steps.min() > 0.5)
            && off
                .iter()
                .zip(steps.iter())
                .all(|(off, s)| *off <= ROUND * s)
    };
    let is_inch = (unit_m - INCH.1).abs() < 1e-9;
    let (mm_in_inches, sixteenth) = (0.5 / 25.4, 1.0 / 16.0);
    if (unit_m - 1e-3).abs() < 1e-9 && likely(INCH.1) && !round(0.5) {
        let why = if round(mm_in_inches) {
            "all sides are multiples of 0.5 mm if the file is in inches, and not as it is read"
        } else if round(sixteenth) {
            "all sides are multiples of 1/16, and not of 1/2, as inches would be"
        } else {
            return None;
        };
        return Some(suspect(INCH, why.to_owned()));
    }
    // Multiples of 5 are common in mm and rare in inches.
    if is_inch && likely(1e-3) && round(5.0) && longest > 20.0 {
        let why = "all sides are multiples of 5 if the file is in mm, and as inches it is large";
        return Some(suspect(("mm", 1e-3), why.to_owned()));
    }
    None
}

/// A part that is of a likely size in no unit: too small for every tool, or a landscape.
fn of_no_size(size_mm: f64) -> SuspectedUnit {
    let [least_mm, most_mm] = LIKELY_M.map(|m| 1e3 * m);
    SuspectedUnit {
        name: "another unit",
        unit_m: None,
        why: format!(
            "the longest side would be {size_mm:.1e} mm as it is read, but parts that robots machine have {least_mm} \
             to {most_mm} mm, and would have them in none of m, inches, mm and µm"
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inches_and_metres_are_suspected_where_sizes_speak_for_them() {
        let name = |sides: [f64; 3], unit_m| suspected(&sides.into(), unit_m).map(|s| s.name);
        assert_eq!(name([0.1, 0.06, 0.02], 1e-3), Some("m"));
        assert_eq!(name([100.0, 60.0, 20.0], 1e-3), None);
        let inches = [100.0, 60.0, 20.0].map(|mm| mm / 25.4);
        assert_eq!(name(inches, 1e-3), Some("inch"));
        assert_eq!(name([0.3, 0.06, 0.02], 1e-3), Some("m"));
        assert_eq!(
            name([250.0 / 25.4, 60.0 / 25.4, 20.0 / 25.4], 1e-3),
            Some("inch")
        );
        assert_eq!(name([6.0, 2.25, 0.75], 1e-3), Some("inch"));
        assert_eq!(name([100.0, 60.0, 20.0], 0.0254), Some("mm"));
        assert_eq!(name([6.0, 2.25, 0.75], 0.0254), None);
        assert_eq!(name([36.0, 24.0, 2.5], 0.0254), None);
        // Too small, and too large, in every unit: 0.12 µm and 120 km.
        for (side, size) in [(1.2e-4, "1.2e-4 mm"), (1.2e8, "1.2e8 mm")] {
            let told = suspected(&[side, 0.5 * side, 0.3 * side].into(), 1e-3).unwrap();
            assert_eq!((told.name, told.unit_m), ("another unit", None));
            assert!(
                told.why.contains(size) && told.why.contains("5 to 10000 mm"),
                "{}",
                told.why
            );
        }
    }
}
