//! Dose that is collected until its contact has moved: spreading it over the cells in every step
//! would cost more than the contact itself.

use nalgebra::Vector2;

/// Distance after which a dose is spread, in cells: the total is exact, its place is blurred by
/// that much.
const SPREAD_EVERY_CELLS: f64 = 0.1;
/// Most steps whose dose is pending.
const MOST_STEPS: usize = 40;

/// Dose of one contact, which is described by `T`.
#[derive(Debug, Clone, Copy)]
pub(super) struct PendingRemoval<T> {
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
    /// Middle of the path on which it was given.
    pub at_cells: Vector2<f64>,
    /// As the contact was in its last step.
    pub contact: T,
}

impl<T> Default for PendingRemoval<T> {
    fn default() -> Self {
        Self {
            energy_j: 0.0,
            steps: 0,
            from_cells: Vector2::zeros(),
            last: None,
        }
    }
}

impl<T> PendingRemoval<T> {
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

    /// The pending dose, if any; nothing is pending afterwards.
    pub fn take(&mut self) -> Option<Dose<T>> {
        let pending = std::mem::take(self);
        pending.last.map(|(contact, at_cells)| Dose {
            energy_j: pending.energy_j,
            at_cells: 0.5 * (pending.from_cells + at_cells),
            contact,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dose_comes_due_by_distance_or_by_steps_and_none_is_lost() {
        let mut pending = PendingRemoval::default();
        assert!(pending.take().is_none());
        assert!(!pending.add(1.0, Vector2::new(3.0, 0.0), "a"));
        assert!(pending.add(2.0, Vector2::new(3.2, 0.0), "b"));
        let dose = pending.take().expect("a dose");
        assert_eq!((dose.energy_j, dose.contact), (3.0, "b"));
        assert!((dose.at_cells - Vector2::new(3.1, 0.0)).norm() < 1e-15);
        let due = (0..MOST_STEPS).map(|_| pending.add(0.5, Vector2::zeros(), "c"));
        assert_eq!(due.filter(|due| *due).count(), 1);
        assert_eq!(pending.take().map(|dose| dose.energy_j), Some(20.0));
    }
}
