//! Dose that is kept back until its contact has moved: spreading it over the cells in every step would cost more than the contact.

use nalgebra::Vector2;

/// Way between two times that a dose is spread, in cells: the total is kept, the place blurred by that much.
const SPREAD_EVERY_CELLS: f64 = 0.1;
/// Most steps whose dose is kept back.
const MOST_STEPS: usize = 40;

/// Dose of one contact, which is described by `T`.
#[derive(Debug, Clone, Copy)]
pub(super) struct KeptBack<T> {
    energy_j: f64,
    steps: usize,
    from_cells: Vector2<f64>,
    /// The contact in the last step, and where it was.
    last: Option<(T, Vector2<f64>)>,
}

/// A dose that is to be spread.
#[derive(Debug, Clone, Copy)]
pub(super) struct Dose<T> {
    pub energy_j: f64,
    /// Middle of the way on which it was given.
    pub at_cells: Vector2<f64>,
    /// As the contact was in its last step.
    pub contact: T,
}

impl<T> Default for KeptBack<T> {
    fn default() -> Self {
        Self {
            energy_j: 0.0,
            steps: 0,
            from_cells: Vector2::zeros(),
            last: None,
        }
    }
}

impl<T> KeptBack<T> {
    /// Adds the dose of a step; whether it is time to spread what there is.
    pub fn add(&mut self, energy_j: f64, at_cells: Vector2<f64>, contact: T) -> bool {
        if self.steps == 0 {
            self.from_cells = at_cells;
        }
        self.energy_j += energy_j;
        self.steps += 1;
        self.last = Some((contact, at_cells));
        let moved = (at_cells - self.from_cells).norm();
        moved >= SPREAD_EVERY_CELLS || self.steps >= MOST_STEPS
    }

    /// What is kept back, if anything; nothing is left.
    pub fn take(&mut self) -> Option<Dose<T>> {
        let kept = std::mem::take(self);
        kept.last.map(|(contact, at_cells)| Dose {
            energy_j: kept.energy_j,
            at_cells: 0.5 * (kept.from_cells + at_cells),
            contact,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dose_comes_due_by_way_or_by_steps_and_none_is_lost() {
        let mut kept = KeptBack::default();
        assert!(kept.take().is_none());
        assert!(!kept.add(1.0, Vector2::new(3.0, 0.0), "a"));
        assert!(kept.add(2.0, Vector2::new(3.2, 0.0), "b"));
        let dose = kept.take().expect("a dose");
        assert_eq!((dose.energy_j, dose.contact), (3.0, "b"));
        assert!((dose.at_cells - Vector2::new(3.1, 0.0)).norm() < 1e-15);
        let due = (0..MOST_STEPS).map(|_| kept.add(0.5, Vector2::zeros(), "c"));
        assert_eq!(due.filter(|due| *due).count(), 1);
        assert_eq!(kept.take().map(|dose| dose.energy_j), Some(20.0));
    }
}
