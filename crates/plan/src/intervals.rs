//! Stable intervals of the redundancy angle at one place of a path.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use truecut_core::roots::try_bisect;

use rayon::prelude::*;

use crate::assessment::Assessment;
use crate::error::PlanError;
use crate::reach::{Candidate, Column, Family, Surveyor, are_joined};

/// Bisections of the step in which an interval ends.
const REFINEMENTS: usize = 6;

/// A range of redundancy angles in which the arm reaches the place, the cut is stable, and
/// vibration decays well enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// Sheet of [`crate::Reach`] in which it lies.
    pub sheet: usize,
    pub from_rad: f64,
    /// At least `from_rad`, a turn more at most.
    pub to_rad: f64,
}

impl Interval {
    pub fn width_rad(&self) -> f64 {
        self.to_rad - self.from_rad
    }

    pub fn middle_rad(&self) -> f64 {
        0.5 * (self.from_rad + self.to_rad)
    }

    /// The same interval, turned by whole turns as near to an angle as it goes.
    pub(crate) fn turned_to(&self, angle_rad: f64) -> Self {
        let turn = std::f64::consts::TAU;
        let shift = turn * ((angle_rad - self.middle_rad()) / turn).round();
        Self {
            from_rad: self.from_rad + shift,
            to_rad: self.to_rad + shift,
            ..*self
        }
    }

    /// Whether two intervals have angles and sheet in common.
    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        let other = other.turned_to(self.middle_rad());
        let common = self.to_rad.min(other.to_rad) - self.from_rad.max(other.from_rad);
        self.sheet == other.sheet && common > 0.0
    }

    /// By how much the ends differ: the larger of the two.
    pub(crate) fn ends_apart_rad(&self, other: &Self) -> f64 {
        let other = other.turned_to(self.middle_rad());
        let from = (self.from_rad - other.from_rad).abs();
        from.max((self.to_rad - other.to_rad).abs())
    }
}

/// What was found at one place.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Standing {
    pub intervals: Vec<Interval>,
    /// Angle (rad) and assessment that are best, stable or not.
    pub best: (f64, Assessment),
}

/// Assesses the postures of one place.
pub(crate) type Assessor<'a> = dyn Fn(&Candidate) -> Result<Assessment, PlanError> + Sync + 'a;

/// Assessments of a column by angle and family: all sheets of a family share them.
pub(crate) fn assessments(
    column: &Column,
    assess: &Assessor<'_>,
) -> Result<Vec<BTreeMap<Family, Assessment>>, PlanError> {
    let of_cell = |cell: &Vec<Candidate>| {
        let mut found = BTreeMap::new();
        for candidate in cell {
            if let Entry::Vacant(entry) = found.entry(candidate.branch.into()) {
                entry.insert(assess(candidate)?);
            }
        }
        Ok(found)
    };
    column.cells.par_iter().map(of_cell).collect()
}

/// Intervals of a column, by sheet: stable angles that decay at least by `best_part` as fast as the
/// best of their sheet.
pub(crate) fn standing(
    surveyor: &Surveyor<'_>,
    column: &Column,
    angles_rad: &[f64],
    best_part: f64,
    assess: &Assessor<'_>,
) -> Result<Standing, PlanError> {
    let found = assessments(column, assess)?;
    let all = angles_rad.iter().zip(&found);
    let all = all.flat_map(|(angle, of)| of.values().map(move |a| (*angle, *a)));
    let best = all.max_by(|a, b| a.1.reserve().total_cmp(&b.1.reserve()));
    let best = best.ok_or(PlanError::OutOfReach {
        along_m: column.along_m,
        point_m: surveyor.path.point_m(column.along_m),
    })?;
    let by_sheet = stable_rows(column, &found);
    let search = Ends {
        surveyor,
        along_m: column.along_m,
        step_rad: std::f64::consts::TAU / angles_rad.len() as f64,
        assess,
    };
    let intervals = by_sheet.par_iter().map(|(sheet, row)| {
        let decays = row.iter().flatten().filter_map(|(_, a)| a.decay_per_s());
        let least = decays
            .max_by(f64::total_cmp)
            .map_or(0.0, |best| best_part * best);
        let decays_well = |a: &Assessment| a.decay_per_s().is_none_or(|decay| decay >= least);
        let taken = row.iter().map(|cell| match cell {
            Some((candidate, found)) if decays_well(found) => Some(*candidate),
            _ => None,
        });
        let taken: Vec<Option<&Candidate>> = taken.collect();
        let is_good = |a: &Assessment| a.is_stable() && decays_well(a);
        search.runs(*sheet, &taken, &is_good)
    });
    let intervals: Vec<Vec<Interval>> = intervals.collect::<Result<_, PlanError>>()?;
    Ok(Standing {
        intervals: intervals.concat(),
        best,
    })
}

/// Stable candidates of a sheet by angle.
type Row<'a> = Vec<Option<(&'a Candidate, Assessment)>>;

fn stable_rows<'a>(
    column: &'a Column,
    found: &[BTreeMap<Family, Assessment>],
) -> BTreeMap<usize, Row<'a>> {
    let mut by_sheet: BTreeMap<usize, Row<'a>> = BTreeMap::new();
    for (i, cell) in column.cells.iter().enumerate() {
        for candidate in cell {
            let assessment = found[i].get(&candidate.branch.into());
            if let Some(stable) = assessment.filter(|a| a.is_stable()) {
                let row = by_sheet.entry(candidate.sheet).or_default();
                row.resize(found.len(), None);
                row[i] = Some((candidate, *stable));
            }
        }
    }
    by_sheet
}

/// Whether an angle belongs to an interval.
type Good<'a> = dyn Fn(&Assessment) -> bool + 'a;

/// Looks for the ends of runs of good angles.
struct Ends<'a> {
    surveyor: &'a Surveyor<'a>,
    along_m: f64,
    step_rad: f64,
    assess: &'a Assessor<'a>,
}

impl Ends<'_> {
    /// Runs of good angles around the turn.
    fn runs(
        &self,
        sheet: usize,
        row: &[Option<&Candidate>],
        is_good: &Good<'_>,
    ) -> Result<Vec<Interval>, PlanError> {
        let n = row.len();
        let at = |i: usize| row[i % n];
        let Some(gap) = (0..n).find(|i| row[*i].is_none()) else {
            return Ok(vec![Interval {
                sheet,
                from_rad: 0.0,
                to_rad: std::f64::consts::TAU,
            }]);
        };
        let mut runs = Vec::new();
        let mut i = gap;
        while i < gap + n {
            let Some(first) = at(i) else {
                i += 1;
                continue;
            };
            let begin = i;
            let mut last = first;
            while let Some(candidate) = at(i) {
                last = candidate;
                i += 1;
            }
            let (from, to) = (begin as f64 * self.step_rad, (i - 1) as f64 * self.step_rad);
            let from_rad = self.end(first, from, -self.step_rad, is_good)?;
            let to_rad = self.end(last, to, self.step_rad, is_good)?;
            let whole = Interval {
                sheet,
                from_rad,
                to_rad,
            };
            runs.push(whole.turned_to(std::f64::consts::PI));
        }
        Ok(runs)
    }

    /// Where an interval or reach ends between a good angle and the next of the grid.
    fn end(
        &self,
        inside: &Candidate,
        angle_rad: f64,
        step_rad: f64,
        is_good: &Good<'_>,
    ) -> Result<f64, PlanError> {
        let mut nearest = inside.clone();
        let [_, good] = try_bisect([angle_rad + step_rad, angle_rad], REFINEMENTS, |angle| {
            let candidates = self.surveyor.candidates(self.along_m, angle)?;
            let Some(joined) = candidates.into_iter().find(|c| are_joined(c, &nearest)) else {
                return Ok::<_, PlanError>(false);
            };
            let good = is_good(&(self.assess)(&joined)?);
            if good {
                nearest = joined;
            }
            Ok(good)
        })?;
        Ok(good)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::TAU;

    fn interval(from_rad: f64, width: f64) -> Interval {
        Interval {
            sheet: 0,
            from_rad,
            to_rad: from_rad + width,
        }
    }

    proptest! {
        /// Two arcs meet if and only if the end of one lies in the other, whatever turns they are
        /// counted in.
        #[test]
        fn overlap_does_not_depend_on_turns(
            a in 0.0..TAU, b in 0.0..TAU, wide in 0.01..3.0_f64, wider in 0.01..3.0_f64,
            turns in -3..3_i32,
        ) {
            let (one, other) = (interval(a, wide), interval(b + TAU * f64::from(turns), wider));
            let within = |x: f64, from: f64, width: f64| (x - from).rem_euclid(TAU) < width;
            let expected = within(b, a, wide) || within(a, b, wider);
            let near = [(b - a).rem_euclid(TAU) - wide, (a - b).rem_euclid(TAU) - wider];
            prop_assume!(near.iter().all(|d| d.abs() > 1e-9));
            prop_assert_eq!(one.overlaps(&other), expected);
            prop_assert_eq!(other.overlaps(&one), expected);
        }

        #[test]
        fn ends_of_a_shifted_interval_are_as_far_apart_as_the_shift(
            a in 0.0..TAU, wide in 0.01..3.0_f64, shift in -0.5..0.5_f64, turns in -3..3_i32,
        ) {
            let moved = interval(a + shift + TAU * f64::from(turns), wide);
            let apart = interval(a, wide).ends_apart_rad(&moved);
            prop_assert!((apart - shift.abs()).abs() < 1e-9);
        }
    }
}
