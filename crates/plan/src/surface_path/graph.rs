//! Lines on a patch as graphs v(u), and a patch seen with its parameters turned.

use nalgebra::Vector3;

use super::contact::Contact;
use crate::motion::interpolation::hermite;
use crate::surface::{Domain, Jet, Surface};

/// A line as a graph v(u) over even places, cubic between them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct GraphLine {
    range: [f64; 2],
    v: Vec<f64>,
    /// dv/du.
    slope: Vec<f64>,
}

impl GraphLine {
    pub fn constant(range: [f64; 2], stations: usize, v: f64) -> Self {
        Self {
            range,
            v: vec![v; stations + 1],
            slope: vec![0.0; stations + 1],
        }
    }

    /// Slopes by differences: central within, one-sided at the ends.
    pub fn through(range: [f64; 2], v: Vec<f64>) -> Self {
        let last = v.len() - 1;
        let step = (range[1] - range[0]) / last as f64;
        let slope = (0..=last).map(|k| {
            let (a, b) = (k.saturating_sub(1), (k + 1).min(last));
            (v[b] - v[a]) / (step * (b - a) as f64)
        });
        let slope = slope.collect();
        Self { range, v, slope }
    }

    pub fn with_slopes(range: [f64; 2], v: Vec<f64>, slope: Vec<f64>) -> Self {
        Self { range, v, slope }
    }

    pub fn v(&self) -> &[f64] {
        &self.v
    }

    /// Place of a station.
    pub fn u(&self, k: usize) -> f64 {
        self.range[0] + self.step() * k as f64
    }

    fn step(&self) -> f64 {
        (self.range[1] - self.range[0]) / (self.v.len() - 1) as f64
    }

    /// v and dv/du at a place.
    pub fn at(&self, u: f64) -> [f64; 2] {
        let step = self.step();
        let along = (u - self.range[0]) / step;
        let k = (along.floor().max(0.0) as usize).min(self.v.len() - 2);
        let t = along - k as f64;
        let slopes = [k, k + 1].map(|k| self.slope[k] * step);
        let [v, slope] = hermite([self.v[k], self.v[k + 1]], slopes, t);
        [v, slope / step]
    }
}

/// A patch whose first parameter is the other's second: u' = v, v' runs against u. The normal stays
/// outward.
pub(super) struct Turned<'a>(pub &'a dyn Surface);

impl Turned<'_> {
    /// Parameters of the patch beneath.
    pub fn back(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let [low, high] = self.0.domain().u;
        [low + high - v, u]
    }

    /// Makes places on lines of this patch those of the patch beneath.
    pub fn all_back(&self, lines: &mut [Vec<Contact>]) {
        for contact in lines.iter_mut().flatten() {
            [contact.u, contact.v] = self.back([contact.u, contact.v]);
        }
    }
}

impl Surface for Turned<'_> {
    fn domain(&self) -> Domain {
        let Domain { u, v } = self.0.domain();
        Domain { u: v, v: u }
    }

    fn jet(&self, u: f64, v: f64) -> Jet {
        let [u, v] = self.back([u, v]);
        let jet = self.0.jet(u, v);
        let [ru, rv]: [Vector3<f64>; 2] = jet.first_m;
        let [ruu, ruv, rvv] = jet.second_m;
        Jet {
            point_m: jet.point_m,
            first_m: [rv, -ru],
            second_m: [rvv, -ruv, ruu],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::Forms;
    use crate::surface::spoke::Spoke;

    /// A cubic is its own Hermite interpolation.
    #[test]
    fn verify_a_cubic_line_is_met_between_its_stations() {
        let f = |u: f64| 0.2 + u * (0.3 + u * (-0.7 + 0.4 * u));
        let d = |u: f64| 0.3 + u * (-1.4 + 1.2 * u);
        let places: Vec<f64> = (0..=4).map(|k| 0.5 + 0.25 * f64::from(k)).collect();
        let slopes = places.iter().map(|u| d(*u)).collect();
        let line =
            GraphLine::with_slopes([0.5, 1.5], places.iter().map(|u| f(*u)).collect(), slopes);
        for u in [0.5, 0.61, 0.9, 1.13, 1.5] {
            let [v, slope] = line.at(u);
            assert!(
                (v - f(u)).abs() < 1e-14 && (slope - d(u)).abs() < 1e-13,
                "{u}"
            );
        }
    }

    /// Normal and curvatures do not depend on how parameters run.
    #[test]
    fn verify_a_turned_patch_is_the_same_surface() {
        let turned = Turned(&Spoke);
        for [u, v] in [[0.1, 0.3], [0.7, 0.9]] {
            let [bu, bv] = turned.back([u, v]);
            let (one, other) = (turned.jet(u, v), Spoke.jet(bu, bv));
            assert_eq!(one.point_m, other.point_m);
            let (a, b) = (
                Forms::of(&one).expect("forms"),
                Forms::of(&other).expect("forms"),
            );
            assert!((a.normal.into_inner() - b.normal.into_inner()).norm() < 1e-14);
            let (a, b) = (a.curvatures(), b.curvatures());
            assert!(
                (a.min_per_m - b.min_per_m).abs() < 1e-9
                    && (a.max_per_m - b.max_per_m).abs() < 1e-9
            );
            // r_u' is the derivative along u', by difference.
            let step = 1e-6;
            let along = (turned.point_m(u, v + step) - turned.point_m(u, v - step)) / (2.0 * step);
            assert!((along - one.first_m[1]).norm() < 1e-8);
        }
    }
}
