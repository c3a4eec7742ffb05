//! Base parameters: what drive forces tell of the unknowns, whatever the motion.

use nalgebra::DVector;
use truecut_scenario::{FitSpec, Scenario};
use truecut_sim::{InverseModel, SimError};

use super::columns::columns;

/// Unknowns that no motion tells apart, as one.
#[derive(Debug, Clone)]
pub(crate) struct Group {
    /// Columns and their factors; the first has the factor 1 and stands for all.
    pub members: Vec<(usize, f64)>,
}

/// Base parameters of a set of columns.
#[derive(Debug)]
pub(crate) struct Base {
    pub groups: Vec<Group>,
}

/// States of the arm in which columns are compared.
const STATES: usize = 150;
/// A column of unit length of which less is left by those before it is a sum of them. Rounding
/// leaves 1e-13; the smallest parts of real parameters seen are 1e-3.
const NEW: f64 = 1e-8;
/// A member that shows so many times as much as the one that stands for its group takes its place.
const PLAINER: f64 = 2.0;
/// Factors of a sum below this are rounding.
const FACTOR: f64 = 1e-7;

impl Base {
    /// Columns in unrelated states, taken in turn, each less those before it (Gram and Schmidt,
    /// twice): where nothing is left it is regrouped into those (`gautier1990`). A column that is
    /// zero everywhere never shows and belongs to none.
    ///
    /// # Errors
    /// As [`columns`].
    pub fn new(
        scenario: &Scenario,
        model: &InverseModel,
        spec: &FitSpec,
    ) -> Result<Base, SimError> {
        let anywhere = columns(scenario, &any_state(model), spec, 1)?;
        let units: Vec<&str> = anywhere.iter().map(|column| column.unit).collect();
        let values: Vec<_> = anywhere.into_iter().map(|column| column.values).collect();
        let mut base = Base::of(&values, NEW);
        base.name_by_the_plainest(&units);
        Ok(base)
    }

    /// Lets each group stand for the member that shows most, of those of its unit that belong to it
    /// alone. Where an axis leans in its link, the first column may be one that hardly shows: a sum
    /// in which that one has the factor 1 has factors of thousands, and nobody can read it.
    fn name_by_the_plainest(&mut self, units: &[&str]) {
        let mut groups_of = vec![0; units.len()];
        for (column, _) in self.groups.iter().flat_map(|group| &group.members) {
            groups_of[*column] += 1;
        }
        for group in &mut self.groups {
            let first = group.members[0].0;
            let is_like = |at: &usize| {
                let (column, factor) = group.members[*at];
                groups_of[column] == 1 && units[column] == units[first] && factor.abs() > PLAINER
            };
            let size = |at: &usize| group.members[*at].1.abs();
            let plainest = (1..group.members.len()).filter(is_like);
            let plainest = plainest.reduce(|a, b| if size(&b) > size(&a) { b } else { a });
            let Some(at) = plainest else { continue };
            let (column, factor) = group.members.remove(at);
            for member in &mut group.members {
                member.1 /= factor;
            }
            group.members.insert(0, (column, 1.0));
        }
    }

    /// Of columns in unrelated states, `[column][channel][state]`. A column of unit length of which
    /// less than `least` is left by those before it is a sum of them.
    pub fn of(anywhere: &[Vec<Vec<f64>>], least: f64) -> Base {
        let joined = anywhere
            .iter()
            .map(|values| DVector::from_vec(values.concat()));
        let joined: Vec<DVector<f64>> = joined.collect();
        let largest = joined
            .iter()
            .map(|column| column.norm())
            .fold(0.0, f64::max);
        let mut base = Base { groups: Vec::new() };
        let mut kept: Vec<Direction> = Vec::new();
        for (index, column) in joined.iter().enumerate() {
            let norm = column.norm();
            if norm <= least * largest {
                continue;
            }
            let mut left = column / norm;
            let mut factors = DVector::zeros(kept.len());
            for _ in 0..2 {
                for earlier in &kept {
                    let share = earlier.direction.dot(&left);
                    left.axpy(-share, &earlier.direction, 1.0);
                    factors += share
                        * earlier
                            .of_columns
                            .clone()
                            .resize_vertically(kept.len(), 0.0);
                }
            }
            let rest = left.norm();
            if rest > least {
                let mut of_columns = -factors.resize_vertically(kept.len() + 1, 0.0);
                of_columns[kept.len()] = 1.0 / norm;
                kept.push(Direction {
                    direction: left / rest,
                    of_columns: of_columns / rest,
                });
                base.groups.push(Group {
                    members: vec![(index, 1.0)],
                });
            } else {
                for (group, factor) in base.groups.iter_mut().zip(factors.iter()) {
                    if (factor * norm).abs() > FACTOR.max(least) {
                        group.members.push((index, factor * norm));
                    }
                }
            }
        }
        base
    }
}

/// The arm in states in which columns are compared.
pub(crate) fn any_state(model: &InverseModel) -> InverseModel {
    model.in_any_state(STATES)
}

/// A direction of the space that the columns kept span.
struct Direction {
    direction: DVector<f64>,
    /// What it is of the columns kept so far.
    of_columns: DVector<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Columns 0 to 2 are one direction, of which 0 shows a hundredth of 2; 3 is another, 4 their
    /// sum, 5 is like 0 in another unit.
    #[test]
    fn a_group_stands_for_the_member_that_shows_most() {
        let one = |size: f64| vec![vec![size, 0.0, 0.0]];
        let other = vec![vec![0.0, 1.0, 0.0]];
        let sum = vec![vec![1.0, 1.0, 0.0]];
        let values = [one(0.01), one(0.5), one(-1.0), other, sum, one(7.0)];
        let mut base = Base::of(&values, NEW);
        assert_eq!(base.groups[0].members[0], (0, 1.0));
        base.name_by_the_plainest(&["kg m^2", "kg m^2", "kg m^2", "kg m^2", "kg m^2", "kg"]);
        let expected = [(2, 1.0), (0, -0.01), (1, -0.5), (4, -1.0), (5, -7.0)];
        for (found, expected) in base.groups[0].members.iter().zip(expected) {
            assert_eq!(found.0, expected.0);
            assert!((found.1 - expected.1).abs() < 1e-12, "{found:?}");
        }
        assert_eq!(base.groups[1].members.len(), 2);
        assert_eq!(base.groups[1].members[0], (3, 1.0));
    }
}
