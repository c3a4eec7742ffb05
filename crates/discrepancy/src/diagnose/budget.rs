//! Simulations that a search may make, and those that it has made.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use super::problem::Problem;
use super::{Options, Progress, Stage};

/// One part in so many of the predictions is kept for the conclusion.
const KEPT_PART: usize = 10;

/// What a search is of a larger one.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Part {
    /// Whether units are checked.
    pub has_units: bool,
    /// Simulations made before it, of those that all of them may make.
    pub made: usize,
    /// Those that it may make itself.
    pub most: usize,
}

impl Part {
    /// The whole.
    pub fn all(options: &Options) -> Part {
        Part {
            has_units: true,
            made: 0,
            most: options.max_predictions,
        }
    }
}

pub(super) struct Budget<'a> {
    progress: &'a (dyn Fn(Progress) + Sync),
    /// Of all parts of a larger search.
    whole: usize,
    before: usize,
    most: usize,
    made: AtomicUsize,
    /// What is at work. Held while it is told, so that counts are told in their order.
    stage: Mutex<Stage>,
}

impl<'a> Budget<'a> {
    pub fn new(options: &Options, progress: &'a (dyn Fn(Progress) + Sync)) -> Budget<'a> {
        Budget {
            progress,
            whole: options.max_predictions,
            before: 0,
            most: options.max_predictions,
            made: AtomicUsize::new(0),
            stage: Mutex::new(Stage::Nominal),
        }
    }

    pub fn within(self, part: Part) -> Budget<'a> {
        Budget {
            before: part.made,
            most: part.most.min(self.whole.saturating_sub(part.made)),
            ..self
        }
    }
}

impl Problem<'_> {
    /// Tells that a stage begins.
    pub fn report(&self, stage: Stage) {
        self.tell(|_| stage);
    }

    /// Tells the stage that follows from the present one, and how far the work is.
    fn tell(&self, next: impl FnOnce(Stage) -> Stage) {
        let stage = self.budget.stage.lock();
        let mut stage = stage.unwrap_or_else(PoisonError::into_inner);
        *stage = next(*stage);
        (self.budget.progress)(Progress {
            stage: *stage,
            predictions: self.budget.before + self.predictions(),
            max_predictions: self.budget.whole,
        });
    }

    /// Predictions that were made.
    pub fn predictions(&self) -> usize {
        self.budget.made.load(Ordering::Relaxed)
    }

    /// Predictions that it may make.
    pub fn allowed(&self) -> usize {
        self.budget.most
    }

    /// Counts a prediction, and tells it: of a slow arm hundreds of them, made for one stage, take
    /// minutes.
    pub fn count_prediction(&self) {
        self.budget.made.fetch_add(1, Ordering::Relaxed);
        self.tell(|stage| stage);
    }

    /// Predictions that the search may still make; a part of those allowed is kept for the
    /// conclusion.
    pub fn left(&self) -> usize {
        let for_search = self.budget.most / KEPT_PART * (KEPT_PART - 1);
        for_search.saturating_sub(self.predictions())
    }
}
