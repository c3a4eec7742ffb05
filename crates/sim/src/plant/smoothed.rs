//! Forces that are known at the instants only, to a higher order.
//!
//! The recurrence holds a force over the step about its instant. What a smooth force does to the
//! positions is its mean under a hat of two steps, `f + (dt²/12) f''`; with the second difference
//! taken backwards to second order this is Störmer's explicit rule of fourth order,
//! `(14 f₀ - 5 f₁ + 4 f₂ - f₃) / 12` (`hairer1993`, III.10). Without it a cutting process's
//! stiffness is out of tune by (w dt)²/24. After a jump the corrections add up to nothing.

use nalgebra::DVector;

/// Values before the present one.
const BEFORE: usize = 3;

/// A force with its past.
pub(super) struct Smoothed {
    /// The present value first.
    values: [DVector<f64>; BEFORE + 1],
    known: usize,
}

impl Smoothed {
    pub fn new(length: usize) -> Self {
        Self {
            values: std::array::from_fn(|_| DVector::zeros(length)),
            known: 0,
        }
    }

    /// Makes room for the next value, which is zero until it is written.
    pub fn advance(&mut self) {
        for i in (1..self.values.len()).rev() {
            self.values.swap(i, i - 1);
        }
        self.values[0].fill(0.0);
        self.known = (self.known + 1).min(self.values.len());
    }

    /// The present value.
    pub fn now(&mut self) -> &mut DVector<f64> {
        &mut self.values[0]
    }

    /// Adds what acts over the step about the present instant.
    pub fn add_to(&self, force: &mut DVector<f64>) {
        for (i, force) in force.iter_mut().enumerate() {
            *force += self.values[0][i];
            *force += self.curvature(i) / 12.0;
        }
    }

    /// `dt² f''` of one component at the present instant; zero before enough values are known.
    pub fn curvature(&self, i: usize) -> f64 {
        if self.known <= BEFORE {
            return 0.0;
        }
        let [now, first, second, third] = &self.values;
        2.0 * now[i] - 5.0 * first[i] + 4.0 * second[i] - third[i]
    }
}
