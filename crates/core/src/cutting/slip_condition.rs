//! When does a pressed foot hold the tool? The published conditions and their corrections.
//!
//! | rule | condition for no motion |
//! | --- | --- |
//! | paper, its eq. (27) | `4 μ N > π M`, from an amplitude that becomes imaginary |
//! | exact, plane | `μ N ≥ M`: friction is one vector and must oppose the whole rotating force |
//! | general | `max over a revolution of |M e(t) + S F_arm - K r0| ≤ μ N` |
//!
//! Over a whole revolution `e(t)` takes every direction, so the maximum of the general form is
//! `M + |S F_arm - K r0|`.

use super::chamfer::{ChipArea, CuttingCoefficients};
use crate::pressure_foot::PressureFoot;
use crate::roots::bisect;
use nalgebra::Vector2;
use std::f64::consts::PI;

/// Cutting data that the conditions need.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cut {
    pub chip: ChipArea,
    pub coefficients: CuttingCoefficients,
    /// Feed per revolution of the one cutting edge, m.
    pub feed_m: f64,
    /// +1 backward (the cut pulls the foot on), -1 forward.
    pub axial_sign: f64,
}

impl Cut {
    /// Rotating force M, N, with depth `d` (m) already cut.
    pub fn rotating_force_n(&self, depth_m: f64) -> f64 {
        self.forces(depth_m).0
    }

    /// Size of the axial force, N.
    pub fn axial_force_n(&self, depth_m: f64) -> f64 {
        self.forces(depth_m).1
    }

    fn forces(&self, depth_m: f64) -> (f64, f64) {
        let area = self.chip.nominal_m2(depth_m, self.feed_m);
        let length = self.chip.edge_length_m(depth_m + self.feed_m);
        let f = self.coefficients.forces_n(area, length);
        (f.radial_n.hypot(f.tangential_n), f.axial_n)
    }

    /// Eq. (27) of `dong2018chamfering`: pressure above which it predicts no vibration, Pa. It
    /// takes the whole axial force as carried by the foot. `total_piston_area_m2` is the area of
    /// all cylinders together.
    pub fn paper_threshold_pa(&self, depth_m: f64, mu: f64, total_piston_area_m2: f64) -> f64 {
        (PI / (4.0 * mu) * self.rotating_force_n(depth_m) - self.axial_force_n(depth_m))
            / total_piston_area_m2
    }

    /// Exact threshold in the plane, Pa, when the foot carries share `axial_share` of the axial
    /// force: `p = (K_rt/μ - s η K_fc) A_c / A` (`docs/physics/chamfering.md`).
    pub fn exact_threshold_pa(
        &self,
        depth_m: f64,
        mu: f64,
        axial_share: f64,
        total_piston_area_m2: f64,
    ) -> f64 {
        (self.rotating_force_n(depth_m) / mu
            - self.axial_sign * axial_share * self.axial_force_n(depth_m))
            / total_piston_area_m2
    }
}

/// The arm behind the foot, as the general condition sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArmCoupling {
    /// Axial stiffness with the lateral motion held, N/m.
    pub axial_stiffness_n_per_m: f64,
    /// `S = (C_YZ,YZ)⁻¹ C_YZ,X`: lateral force that a held foot must take per newton of axial force
    /// carried by the arm.
    pub lateral_per_axial: Vector2<f64>,
    /// `K r0`: lateral force stored in the arm at touch-down, N; zero for a foot set down unloaded.
    pub stored_lateral_n: Vector2<f64>,
}

/// Lateral demand on the foot and what friction offers, N, at a depth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlipBalance {
    /// `M + |S F_arm - K r0|`.
    pub demand_n: f64,
    /// `μ N`.
    pub capacity_n: f64,
}

impl SlipBalance {
    /// The general condition at depth `d` (m) for a foot of coefficient `mu`.
    pub fn at_depth(
        cut: &Cut,
        foot: &PressureFoot,
        arm: &ArmCoupling,
        mu: f64,
        depth_m: f64,
    ) -> Self {
        let axial = cut.axial_sign * cut.axial_force_n(depth_m);
        let (foot_change, arm_force) =
            foot.share_of_axial_force(axial, arm.axial_stiffness_n_per_m);
        let lateral = arm.lateral_per_axial * arm_force - arm.stored_lateral_n;
        Self {
            demand_n: cut.rotating_force_n(depth_m) + lateral.norm(),
            capacity_n: mu * (foot.preload_n + foot_change).max(0.0),
        }
    }

    /// True while the foot can hold.
    pub fn holds(&self) -> bool {
        self.demand_n <= self.capacity_n
    }
}

/// Depth already cut at which the foot first slips by the general condition, m; `None` if it holds
/// down to `full_depth_m`. Demand and capacity are continuous in the depth and the first crossing
/// is bracketed on a fine scan, so a later re-stick does not hide it.
pub fn first_slip_depth_m(
    cut: &Cut,
    foot: &PressureFoot,
    arm: &ArmCoupling,
    mu: f64,
    full_depth_m: f64,
) -> Option<f64> {
    let slips = |d: f64| !SlipBalance::at_depth(cut, foot, arm, mu, d).holds();
    let scan = 400;
    let crossing = (0..=scan).find(|i| slips(full_depth_m * *i as f64 / scan as f64))?;
    if crossing == 0 {
        return Some(0.0);
    }
    let ends = [crossing - 1, crossing].map(|i| full_depth_m * i as f64 / scan as f64);
    Some(bisect(ends, 60, slips)[1])
}

/// Pressure at which the general condition is just met at depth `d`, Pa, for a foot family given by
/// `foot_at(pressure)`. The capacity grows with pressure; bisection between 0 and
/// `max_pressure_pa`. 0 if no pressure is needed; `None` if even the largest does not hold.
pub fn general_threshold_pa(
    cut: &Cut,
    foot_at: impl Fn(f64) -> PressureFoot,
    arm: &ArmCoupling,
    mu: f64,
    depth_m: f64,
    max_pressure_pa: f64,
) -> Option<f64> {
    let holds = |p: f64| SlipBalance::at_depth(cut, &foot_at(p), arm, mu, depth_m).holds();
    if !holds(max_pressure_pa) {
        return None;
    }
    if holds(0.0) {
        return Some(0.0);
    }
    let [_, least_pa] = bisect([0.0, max_pressure_pa], 60, holds);
    Some(least_pa)
}

#[cfg(test)]
mod tests {
    use super::*;

    const AREA_M2: f64 = 2.0 * 8.042_477_193e-4;

    fn cut(axial_sign: f64) -> Cut {
        Cut {
            chip: ChipArea::new(45f64.to_radians()),
            coefficients: CuttingCoefficients::from_resultant(1.96e9, 2.14e9, 0.0),
            feed_m: 0.05e-3,
            axial_sign,
        }
    }

    fn foot(pressure_pa: f64) -> PressureFoot {
        PressureFoot {
            preload_n: pressure_pa * AREA_M2,
            gas_stiffness_n_per_m: 0.0,
            seal_stiction_n: 0.0,
            rod_stiffness_n_per_m: 0.0,
        }
    }

    const UNCOUPLED: ArmCoupling = ArmCoupling {
        axial_stiffness_n_per_m: 8.646e5,
        lateral_per_axial: Vector2::new(0.0, 0.0),
        stored_lateral_n: Vector2::new(0.0, 0.0),
    };

    /// `docs/physics/chamfering.md`, When a foot holds, with 1 mm already cut and μ = 0.15: 0.295,
    /// 0.392, 0.455 MPa; at the last tooth of a chamfer that is set to 1 mm: 0.280, 0.373, 0.432.
    #[test]
    fn verify_threshold_pressures_of_the_three_rules() {
        let c = cut(1.0);
        let mpa = |p: f64| (p / 1e3).round() / 1e3;
        assert_eq!(mpa(c.paper_threshold_pa(1e-3, 0.15, AREA_M2)), 0.295);
        assert_eq!(mpa(c.exact_threshold_pa(1e-3, 0.15, 1.0, AREA_M2)), 0.392);
        assert_eq!(mpa(c.exact_threshold_pa(1e-3, 0.15, 0.0, AREA_M2)), 0.455);
        let met_m = 1e-3 - 5e-5;
        assert_eq!(mpa(c.paper_threshold_pa(met_m, 0.15, AREA_M2)), 0.28);
        assert_eq!(mpa(c.exact_threshold_pa(met_m, 0.15, 1.0, AREA_M2)), 0.373);
        assert_eq!(mpa(c.exact_threshold_pa(met_m, 0.15, 0.0, AREA_M2)), 0.432);
    }

    /// `docs/physics/chamfering.md`, When a foot holds: the exact pressure is 1.31–1.42 (η = 1) to
    /// 1.44–1.96 (η = 0) times the paper's for μ = 0.1–0.3.
    #[test]
    fn verify_paper_rule_is_too_low_by_the_stated_factors() {
        let c = cut(1.0);
        let factor = |mu, eta| {
            c.exact_threshold_pa(1e-3, mu, eta, AREA_M2) / c.paper_threshold_pa(1e-3, mu, AREA_M2)
        };
        for (mu, eta, expected) in [
            (0.1, 1.0, 1.31),
            (0.3, 1.0, 1.42),
            (0.1, 0.0, 1.44),
            (0.3, 0.0, 1.96),
        ] {
            assert!((factor(mu, eta) - expected).abs() < 0.011, "{mu} {eta}");
        }
    }

    /// `docs/physics/chamfering.md`, First slip: at 0.3 MPa sliding starts at d = 0.651 mm without
    /// a share of the axial force and at 0.759 mm if the foot carries all of it (backward).
    #[test]
    fn verify_first_slip_depth_in_the_plane() {
        let d = first_slip_depth_m(&cut(1.0), &foot(0.3e6), &UNCOUPLED, 0.15, 1e-3).unwrap();
        assert!((d - 0.651e-3).abs() < 1e-6, "{d}");
        let rigid = PressureFoot {
            seal_stiction_n: 1e9,
            rod_stiffness_n_per_m: 1e15,
            ..foot(0.3e6)
        };
        let d = first_slip_depth_m(&cut(1.0), &rigid, &UNCOUPLED, 0.15, 1e-3).unwrap();
        assert!((d - 0.759e-3).abs() < 1e-6, "{d}");
        assert!(first_slip_depth_m(&cut(1.0), &foot(0.5e6), &UNCOUPLED, 0.15, 1e-3).is_none());
    }

    #[test]
    fn verify_general_threshold_reduces_to_the_exact_one_without_coupling() {
        let c = cut(-1.0);
        let general =
            general_threshold_pa(&c, foot, &UNCOUPLED, 0.2, 1e-3, 5e6).expect("holds at 5 MPa");
        let exact = c.exact_threshold_pa(1e-3, 0.2, 0.0, AREA_M2);
        assert!((general / exact - 1.0).abs() < 1e-9);
    }

    /// A share of the axial force large enough for friction alone: no pressure is needed, and not
    /// some 1e-10 Pa.
    #[test]
    fn verify_a_foot_that_holds_by_itself_needs_no_pressure() {
        let rigid = |pressure_pa: f64| PressureFoot {
            seal_stiction_n: 1e9,
            rod_stiffness_n_per_m: 1e15,
            ..foot(pressure_pa)
        };
        let threshold = |mu| general_threshold_pa(&cut(1.0), rigid, &UNCOUPLED, mu, 1e-3, 5e6);
        assert_eq!(threshold(1.2), Some(0.0));
        assert!(threshold(0.2).is_some_and(|pressure| pressure > 1e5));
    }

    #[test]
    fn verify_coupling_and_stored_force_add_to_the_demand() {
        let arm = ArmCoupling {
            lateral_per_axial: Vector2::new(0.3, 0.4),
            stored_lateral_n: Vector2::new(0.0, 0.0),
            ..UNCOUPLED
        };
        let b = SlipBalance::at_depth(&cut(1.0), &foot(0.3e6), &arm, 0.15, 0.5e-3);
        let f = cut(1.0).axial_force_n(0.5e-3);
        assert!((b.demand_n - cut(1.0).rotating_force_n(0.5e-3) - 0.5 * f).abs() < 1e-9);
    }
}
