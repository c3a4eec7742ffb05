//! The acceleration at an instant, from the two instants before.

use nalgebra::DVector;

/// Acceleration of the joints, foreseen to first order in the step.
pub(super) struct Foreseen {
    ahead: DVector<f64>,
    last: DVector<f64>,
}

impl Foreseen {
    pub fn new(length: usize) -> Self {
        Self {
            ahead: DVector::zeros(length),
            last: DVector::zeros(length),
        }
    }

    /// Takes note of the mean velocities after and before an instant; what is foreseen is of the
    /// next one.
    pub fn follow(&mut self, after: &DVector<f64>, before: &DVector<f64>, dt_s: f64) {
        for i in 0..after.len() {
            let now = (after[i] - before[i]) / dt_s;
            self.ahead[i] = 2.0 * now - self.last[i];
            self.last[i] = now;
        }
    }

    /// rad/s² or m/s².
    pub fn acceleration(&self) -> &DVector<f64> {
        &self.ahead
    }
}
