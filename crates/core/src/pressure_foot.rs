//! The pressure foot: pneumatic cylinders that press a ring around the tool onto the workpiece.
//!
//! Normal force: `N = max(0, n p A + k_g x + s)`, where `x` is how far the foot's mounting has
//! advanced towards the workpiece since touch-down. The gas spring is adiabatic,
//! `k_g = n γ p_abs A / L`. The seals hold the rod by an elastic, perfectly plastic element: force
//! `s` grows with the held rod's stiffness and slips at the seals' stiction. `dong2018chamfering`
//! treats the foot once as a constant force (its eq. 12) and once as rigid (its eq. 23); both are
//! limits of this law (`docs/physics/pressure_foot.md`).

use std::f64::consts::PI;

/// Ambient pressure that turns a gauge pressure into an absolute one, Pa.
pub const AMBIENT_PRESSURE_PA: f64 = 101_325.0;

/// Geometry and supply of the cylinders.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cylinders {
    pub count: f64,
    pub bore_m: f64,
    /// Length of the enclosed gas column, m.
    pub gas_length_m: f64,
    /// Gauge pressure, Pa.
    pub pressure_pa: f64,
    /// Polytropic exponent: 1.4 adiabatic, 1.0 isothermal.
    pub polytropic_exponent: f64,
}

impl Cylinders {
    /// Piston area of one cylinder, m².
    pub fn piston_area_m2(&self) -> f64 {
        PI * self.bore_m * self.bore_m / 4.0
    }

    /// Force with which the foot presses at touch-down, N.
    pub fn preload_n(&self) -> f64 {
        self.count * self.pressure_pa * self.piston_area_m2()
    }

    /// Stiffness of the enclosed gas, N/m: `n γ p_abs A / L`.
    pub fn gas_stiffness_n_per_m(&self) -> f64 {
        self.count
            * self.polytropic_exponent
            * (self.pressure_pa + AMBIENT_PRESSURE_PA)
            * self.piston_area_m2()
            / self.gas_length_m
    }
}

/// Stiffness k of a foot that carries share `η = k / (k + k_arm)` (0 ≤ η < 1) of a change of axial
/// force beside an arm of stiffness `arm`, N/m.
pub fn stiffness_for_share(share: f64, arm_n_per_m: f64) -> f64 {
    arm_n_per_m * share / (1.0 - share)
}

/// The foot as a law of its advance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PressureFoot {
    /// Normal force at touch-down, N.
    pub preload_n: f64,
    /// Gas spring, N/m.
    pub gas_stiffness_n_per_m: f64,
    /// Stiction of all seals together, N. Zero frees the rod.
    pub seal_stiction_n: f64,
    /// Stiffness of the held rod, N/m.
    pub rod_stiffness_n_per_m: f64,
}

/// What the foot remembers: where the seals were last loaded.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FootMemory {
    /// Seal force, N.
    pub seal_force_n: f64,
    /// Advance at which that force was reached, m.
    pub advance_m: f64,
}

/// Normal force and its parts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FootForce {
    /// Force between foot and workpiece, N, not negative.
    pub normal_n: f64,
    /// Part carried by the seals, N.
    pub seal_n: f64,
    /// True when the foot has left the workpiece.
    pub lifted: bool,
}

impl PressureFoot {
    /// The foot when `left` of its gauge pressure is left. `gauge_share` is the part of the gas's
    /// absolute pressure that was gauge pressure, `p / (p + p_ambient)`: that part of the gas
    /// spring goes with it.
    pub fn at_pressure(&self, left: f64, gauge_share: f64) -> Self {
        Self {
            preload_n: self.preload_n * left,
            gas_stiffness_n_per_m: self.gas_stiffness_n_per_m * (1.0 - gauge_share * (1.0 - left)),
            ..*self
        }
    }

    /// Force at an advance (m, positive towards the workpiece), without touching the memory.
    pub fn force(&self, advance_m: f64, memory: &FootMemory) -> FootForce {
        let seal_n = (memory.seal_force_n
            + self.rod_stiffness_n_per_m * (advance_m - memory.advance_m))
            .clamp(-self.seal_stiction_n, self.seal_stiction_n);
        let total = self.preload_n + self.gas_stiffness_n_per_m * advance_m + seal_n;
        FootForce {
            normal_n: total.max(0.0),
            seal_n,
            lifted: total <= 0.0,
        }
    }

    /// The memory after the advance has been reached.
    pub fn commit(&self, advance_m: f64, memory: &FootMemory) -> FootMemory {
        FootMemory {
            seal_force_n: self.force(advance_m, memory).seal_n,
            advance_m,
        }
    }

    /// How a slowly growing axial force is shared between foot and arm.
    ///
    /// `axial_force_n` is the cutting force on the tool along the feed axis, positive towards the
    /// workpiece; `arm_n_per_m` is the arm's axial stiffness (with the foot's lateral motion held,
    /// if it is held). Returns (change of the normal force, force left to the arm), both N, for
    /// loading from touch-down in one direction.
    pub fn share_of_axial_force(&self, axial_force_n: f64, arm_n_per_m: f64) -> (f64, f64) {
        let springs = self.gas_stiffness_n_per_m + arm_n_per_m;
        let held = springs + self.held_rod_n_per_m();
        let mut advance = axial_force_n / held;
        let seal = self.held_rod_n_per_m() * advance;
        if seal.abs() > self.seal_stiction_n {
            advance = (axial_force_n - self.seal_stiction_n.copysign(axial_force_n)) / springs;
        }
        let arm = arm_n_per_m * advance;
        (
            (axial_force_n - arm).max(-self.preload_n),
            axial_force_n - (axial_force_n - arm).max(-self.preload_n),
        )
    }

    fn held_rod_n_per_m(&self) -> f64 {
        if self.seal_stiction_n > 0.0 {
            self.rod_stiffness_n_per_m
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cylinders() -> Cylinders {
        Cylinders {
            count: 2.0,
            bore_m: 0.032,
            gas_length_m: 0.05,
            pressure_pa: 0.3e6,
            polytropic_exponent: 1.4,
        }
    }

    fn foot() -> PressureFoot {
        PressureFoot {
            preload_n: 500.0,
            gas_stiffness_n_per_m: 1.8e4,
            seal_stiction_n: 97.0,
            rod_stiffness_n_per_m: 5e7,
        }
    }

    /// `docs/physics/pressure_foot.md`: two Ø32 cylinders at 0.3 MPa press with 482.5 N; their gas
    /// is a spring of 1.8e4 N/m and carries 2 % beside an arm of 8.646e5 N/m.
    #[test]
    fn verify_gas_spring_of_two_32_mm_cylinders() {
        let c = cylinders();
        assert!((c.preload_n() - 482.5).abs() < 0.1);
        assert!((c.gas_stiffness_n_per_m() / 1.8e4 - 1.0).abs() < 0.01);
        let gas = c.gas_stiffness_n_per_m();
        let share = gas / (gas + 8.646e5);
        assert!((share - 0.02).abs() < 0.001);
        let back = stiffness_for_share(share, 8.646e5);
        assert!((back / c.gas_stiffness_n_per_m() - 1.0).abs() < 1e-12);
    }

    /// A foot that has lost pressure is the foot of cylinders at the pressure that is left.
    #[test]
    fn verify_a_foot_after_loss_is_one_of_less_pressure() {
        let full = cylinders();
        let of = |c: &Cylinders| PressureFoot {
            preload_n: c.preload_n(),
            gas_stiffness_n_per_m: c.gas_stiffness_n_per_m(),
            ..foot()
        };
        let low = Cylinders {
            pressure_pa: 0.7 * full.pressure_pa,
            ..full
        };
        let share = full.pressure_pa / (full.pressure_pa + AMBIENT_PRESSURE_PA);
        let (got, expected) = (of(&full).at_pressure(0.7, share), of(&low));
        assert!((got.preload_n / expected.preload_n - 1.0).abs() < 1e-12);
        let ratio = got.gas_stiffness_n_per_m / expected.gas_stiffness_n_per_m;
        assert!((ratio - 1.0).abs() < 1e-12);
    }

    #[test]
    fn verify_seal_loop_encloses_four_stiction_strokes() {
        // One cycle of ±1 mm: the seals slide except for the elastic turn-arounds, so the loop
        // encloses 4 F (X - F/k), the area of an elastic, perfectly plastic loop.
        let foot = foot();
        let stroke = 1e-3;
        let mut memory = FootMemory::default();
        for i in 0..=1000 {
            memory = foot.commit(stroke * i as f64 / 1000.0, &memory);
        }
        let mut work = 0.0;
        let steps = 200_000;
        for i in 1..=steps {
            let phase = 2.0 * PI * i as f64 / steps as f64;
            let advance = stroke * phase.cos();
            let before = memory;
            memory = foot.commit(advance, &memory);
            work += 0.5
                * (before.seal_force_n + memory.seal_force_n)
                * (memory.advance_m - before.advance_m);
        }
        let expected = 4.0 * 97.0 * (stroke - 97.0 / 5e7);
        assert!((work / expected - 1.0).abs() < 1e-4, "{work} {expected}");
    }

    #[test]
    fn evaluating_twice_changes_nothing() {
        let (foot, memory) = (foot(), FootMemory::default());
        assert_eq!(foot.force(1e-6, &memory), foot.force(1e-6, &memory));
    }

    #[test]
    fn verify_lift_off_and_recontact() {
        let foot = PressureFoot {
            seal_stiction_n: 0.0,
            ..foot()
        };
        let lift = -500.0 / 1.8e4;
        let gone = foot.force(lift - 1e-3, &FootMemory::default());
        assert!(gone.lifted && gone.normal_n == 0.0);
        let back = foot.force(lift + 1e-3, &FootMemory::default());
        assert!(!back.lifted && (back.normal_n - 18.0).abs() < 1e-9);
    }

    #[test]
    fn verify_axial_force_is_shared_by_stiffness_until_the_seals_slip() {
        let foot = foot();
        let arm = 8.646e5;
        let (foot_part, arm_part) = foot.share_of_axial_force(50.0, arm);
        assert!((foot_part + arm_part - 50.0).abs() < 1e-12);
        assert!((arm_part - 50.0 * arm / (5e7 + 1.8e4 + arm)).abs() < 1e-9);
        let (_, slipped) = foot.share_of_axial_force(200.0, arm);
        assert!((slipped - 103.0 * arm / (1.8e4 + arm)).abs() < 1e-9);
        let (lifted, rest) = foot.share_of_axial_force(-40_000.0, arm);
        assert_eq!((lifted, rest), (-500.0, -39_500.0));
    }
}
