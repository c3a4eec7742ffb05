//! What a brush makes of an edge: the burr that it takes off, and the radius that follows.
//!
//! **Who bears.** A burr stands out of its edge, and after it the sharp edge itself: while any part
//! of a bristle's tip is over it, it bears that bristle alone. Of tips of diameter t, ρ of them per
//! area, those are over a strip of width w whose middles lie within (t + w)/2 of its own: ρ (t + w)
//! per length. With Preston's law for each tip the section taken off grows by
//!
//! `dA = k_p (t + w) dD`,   `D = ∫ ρ n v dt`,
//!
//! n the force of a bristle and v the speed of its tip, whichever way it runs. D is the dose of a
//! face that would lie there (J/m²).
//!
//! **Burr.** Of height h and thickness s, w = s: it falls by `k_p (t + s)/s` per dose, and is gone
//! at `D_b = h s / (k_p (t + s))`.
//!
//! **Radius.** Between faces that enclose the angle β a fillet of radius r has taken off
//! `A = c r²`, `c = cot(β/2) - (π - β)/2`, and is `w = a r`, `a = 2 cos(β/2)`, wide as seen along
//! the bisector. Then `2 c r dr = k_p (t + a r) dD`, which integrates to
//!
//! `(2c/a) (r - (t/a) ln(1 + a r/t)) = k_p (D - D_b)`.
//!
//! While r is small beside the tips that is `r = √(k_p t (D - D_b)/c)`: an edge blunts like a root,
//! fast at first.
//!
//! Left out: a burr that bends away or breaks off whole, and that bristles of a dense brush lean on
//! one another.

use crate::roots::newton;
use std::f64::consts::PI;

/// An edge and what stands on it before brushing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgeWear {
    /// 0 for an edge without a burr.
    pub burr_height_m: f64,
    pub burr_thickness_m: f64,
    /// Angle between the faces, through the material; below π.
    pub wedge_rad: f64,
    /// Diameter of a bristle's tip.
    pub tip_m: f64,
    /// Preston coefficient.
    pub preston_per_pa: f64,
}

impl EdgeWear {
    /// Section that a fillet of radius 1 takes off, `c`.
    fn fillet(&self) -> f64 {
        1.0 / (0.5 * self.wedge_rad).tan() - 0.5 * (PI - self.wedge_rad)
    }

    /// What a dose takes off where nothing is left to stand out: `k_p D` beyond what the burr took,
    /// m.
    fn depth_beyond_burr_m(&self, dose_j_per_m2: f64) -> f64 {
        self.preston_per_pa * dose_j_per_m2 - self.depth_of_burr_m()
    }

    /// `k_p D` at which the burr is gone, m.
    fn depth_of_burr_m(&self) -> f64 {
        let section = self.burr_height_m * self.burr_thickness_m;
        section / (self.tip_m + self.burr_thickness_m)
    }

    /// Height of the burr that is left after a dose, m.
    pub fn burr_left_m(&self, dose_j_per_m2: f64) -> f64 {
        if self.burr_height_m == 0.0 {
            return 0.0;
        }
        let part = self.preston_per_pa * dose_j_per_m2 / self.depth_of_burr_m();
        self.burr_height_m * (1.0 - part).max(0.0)
    }

    /// Radius of the edge after a dose, m; 0 while there is a burr.
    pub fn radius_m(&self, dose_j_per_m2: f64) -> f64 {
        let depth_m = self.depth_beyond_burr_m(dose_j_per_m2);
        if depth_m <= 0.0 {
            return 0.0;
        }
        let (c, t) = (self.fillet(), self.tip_m);
        let a = 2.0 * (0.5 * self.wedge_rad).cos();
        // With x = a r / t: x - ln(1 + x) = y. Convex, so that Newton's iteration comes down from a
        // start above: x²/2 - x³/3 < y < x²/2.
        let y = depth_m * a * a / (2.0 * c * t);
        let start = (2.0 * y).sqrt() + y;
        let x = newton(start, 1e-14, |x| (y - (x - x.ln_1p())) * (1.0 + x) / x);
        x * t / a
    }

    /// Section taken off by a dose, burr and fillet, m².
    pub fn removed_m2(&self, dose_j_per_m2: f64) -> f64 {
        let burr_m2 =
            (self.burr_height_m - self.burr_left_m(dose_j_per_m2)) * self.burr_thickness_m;
        burr_m2 + self.fillet() * self.radius_m(dose_j_per_m2).powi(2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    fn edge() -> EdgeWear {
        EdgeWear {
            burr_height_m: 0.2e-3,
            burr_thickness_m: 0.05e-3,
            wedge_rad: FRAC_PI_2,
            tip_m: 0.5e-3,
            preston_per_pa: 1e-11,
        }
    }

    /// Section by section, in small steps of the dose: burr and radius are those of the closed
    /// form, sharp and blunt wedges.
    #[test]
    fn verify_edge_wear_integrates_prestons_law_over_who_bears() {
        for wedge_deg in [60.0_f64, 90.0, 135.0] {
            let e = EdgeWear {
                wedge_rad: wedge_deg.to_radians(),
                ..edge()
            };
            let (whole, steps) = (4e7, 400_000);
            let step = whole / f64::from(steps);
            let (mut height, mut section) = (e.burr_height_m, 0.0_f64);
            for k in 1..=steps {
                if height > 0.0 {
                    height -= e.preston_per_pa * (e.tip_m + e.burr_thickness_m)
                        / e.burr_thickness_m
                        * step;
                } else {
                    // Heun's rule: the width grows within a step.
                    let rate = |section: f64| {
                        let radius = (section.max(0.0) / e.fillet()).sqrt();
                        let width = 2.0 * (0.5 * e.wedge_rad).cos() * radius;
                        e.preston_per_pa * (e.tip_m + width)
                    };
                    let first = rate(section);
                    section += 0.5 * step * (first + rate(section + step * first));
                }
                if k % 40_000 != 0 {
                    continue;
                }
                let dose = f64::from(k) * step;
                assert!((e.burr_left_m(dose) - height.max(0.0)).abs() < 1e-4 * e.burr_height_m);
                let radius = (section / e.fillet()).sqrt();
                assert!((e.radius_m(dose) - radius).abs() < 1e-3 * radius.max(1e-5));
            }
            assert!(e.radius_m(whole) > 0.3e-3);
        }
    }

    #[test]
    fn verify_a_right_angled_fillet_and_its_root_like_growth() {
        let e = EdgeWear {
            burr_height_m: 0.0,
            ..edge()
        };
        assert!((e.fillet() - (1.0 - PI / 4.0)).abs() < 1e-15);
        let small = |dose: f64| (e.preston_per_pa * e.tip_m * dose / e.fillet()).sqrt();
        for dose in [1e2, 1e3] {
            assert!((e.radius_m(dose) / small(dose) - 1.0).abs() < 0.02);
        }
        assert_eq!((e.radius_m(0.0), e.removed_m2(0.0)), (0.0, 0.0));
        let with_burr = edge();
        let gone = with_burr.depth_of_burr_m() / with_burr.preston_per_pa;
        assert!(with_burr.burr_left_m(gone) < 1e-18 && with_burr.radius_m(gone) < 1e-9);
        let burr = with_burr.burr_height_m * with_burr.burr_thickness_m;
        assert!((with_burr.removed_m2(gone) / burr - 1.0).abs() < 1e-9);
    }
}
