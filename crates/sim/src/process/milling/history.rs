//! What is kept of a milling pass for its report.

use nalgebra::Vector3;

/// Samples of the motion that are kept per tooth period, at least.
const KEPT_PER_TOOTH: f64 = 100.0;
/// Samples per period of the fastest mode, at least.
const KEPT_PER_CYCLE: f64 = 20.0;

/// What is kept for the report.
#[derive(Debug, Clone, Default)]
pub(super) struct History {
    /// Steps between two samples.
    pub stride: usize,
    pub steps: usize,
    /// Of the settled cut.
    pub deflection_m: Vec<Vector3<f64>>,
    pub velocity_m_per_s: Vec<Vector3<f64>>,
    pub force: ForceSums,
}

impl History {
    /// A step's motion, which is kept if it is its turn.
    pub fn add(&mut self, deflection_m: &Vector3<f64>, velocity_m_per_s: &Vector3<f64>) {
        if self.steps.is_multiple_of(self.stride) {
            self.deflection_m.push(*deflection_m);
            self.velocity_m_per_s.push(*velocity_m_per_s);
        }
        self.steps += 1;
    }
}

/// Sums over whole revolutions of the settled cut.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ForceSums {
    from_rad: f64,
    turns: u64,
    sum_n: Vector3<f64>,
    square_n2: Vector3<f64>,
    count: u64,
    /// The same at the end of the last whole revolution.
    pub whole: (Vector3<f64>, Vector3<f64>, u64),
}

/// Steps between two samples, of so many in a tooth period in which the fastest mode makes so many
/// cycles: a whole part of them where they are a whole number, so that motions one tooth apart are
/// compared sample by sample.
pub(super) fn stride(per_tooth: f64, cycles: f64) -> usize {
    let kept = KEPT_PER_TOOTH.max(KEPT_PER_CYCLE * cycles);
    let longest = ((per_tooth / kept) as usize).max(1);
    let whole = per_tooth.round();
    if (per_tooth - whole).abs() > 1e-6 {
        return longest;
    }
    let divides = |stride: &usize| (whole as usize).is_multiple_of(*stride);
    (1..=longest).rev().find(divides).unwrap_or(1)
}

impl ForceSums {
    pub fn add(&mut self, rotation_rad: f64, force_n: &Vector3<f64>) {
        if self.count == 0 {
            self.from_rad = rotation_rad;
        }
        let turned = (rotation_rad - self.from_rad) / std::f64::consts::TAU;
        let turns = (turned + 1e-9).floor() as u64;
        if turns > self.turns {
            self.turns = turns;
            self.whole = (self.sum_n, self.square_n2, self.count);
        }
        self.sum_n += force_n;
        self.square_n2 += force_n.component_mul(force_n);
        self.count += 1;
    }
}
