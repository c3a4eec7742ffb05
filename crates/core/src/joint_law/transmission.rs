//! What a transmission does with its wind-up.

use crate::roots::newton;

/// Spring of a transmission: dead zone, linear and cubic part. With the wind-up beyond the play
/// `d = w - clamp(w, -gap/2, gap/2)` the torque is `K d + K3 d³`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Elastic {
    /// K, N m/rad (N/m).
    pub stiffness: f64,
    /// K3, N m/rad³ (N/m³).
    pub cubic: f64,
    /// Full width of the play, rad (m).
    pub gap: f64,
}

/// Wind-up beyond a play of full width `gap`, rad (m); zero within it.
pub fn beyond_gap(windup: f64, gap: f64) -> f64 {
    if gap > 0.0 {
        windup - windup.clamp(-0.5 * gap, 0.5 * gap)
    } else {
        windup
    }
}

impl Elastic {
    /// Wind-up beyond the play, rad (m); zero within it.
    pub fn beyond_gap(&self, windup: f64) -> f64 {
        beyond_gap(windup, self.gap)
    }

    /// Whether motor and link touch. Without play they always do.
    pub fn engaged(&self, windup: f64) -> bool {
        self.gap <= 0.0 || windup.abs() > 0.5 * self.gap
    }

    /// Torque on the link, N m (N).
    pub fn torque(&self, windup: f64) -> f64 {
        let d = self.beyond_gap(windup);
        let linear = self.stiffness * d;
        if self.cubic == 0.0 {
            linear
        } else {
            linear + self.cubic * d * d * d
        }
    }

    /// Energy stored, J: `K d²/2 + K3 d⁴/4`.
    pub fn energy_j(&self, windup: f64) -> f64 {
        let d = self.beyond_gap(windup);
        let linear = 0.5 * self.stiffness * d * d;
        if self.cubic == 0.0 {
            linear
        } else {
            linear + 0.25 * self.cubic * d.powi(4)
        }
    }

    /// The wind-up at which the spring carries `torque`; the middle of the play for none. `None`
    /// where no wind-up on the rising part of the law does (a softening spring carries only so
    /// much).
    pub fn windup(&self, torque: f64) -> Option<f64> {
        let mut d = torque / self.stiffness;
        if self.cubic != 0.0 {
            // From the origin on, Newton on a law that stiffens or softens throughout stays on the
            // rising part; it has left it where the slope is not positive.
            let mut rising = true;
            let carried = |d: f64| self.stiffness * d + self.cubic * d * d * d;
            d = newton(d, 1e-15, |d| {
                let slope = self.stiffness + 3.0 * self.cubic * d * d;
                rising &= slope > 0.0;
                if rising {
                    (torque - carried(d)) / slope
                } else {
                    0.0
                }
            });
            if !rising || (carried(d) - torque).abs() > 1e-9 * torque.abs() {
                return None;
            }
        }
        let side = if torque == 0.0 { 0.0 } else { torque.signum() };
        Some(d + side * 0.5 * self.gap)
    }
}

/// Transmission error that repeats with the motor coordinate: the motor seems to stand at
/// `θ + C cos(n θ) + S sin(n θ)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ripple {
    /// C, rad (m).
    pub cosine: f64,
    /// S, rad (m).
    pub sine: f64,
    /// n, cycles per 2π rad (per metre, 2π n of phase).
    pub phase_per_coordinate: f64,
}

impl Ripple {
    /// The error at motor coordinate `motor`, rad (m).
    pub fn error(&self, motor: f64) -> f64 {
        let (sin, cos) = (self.phase_per_coordinate * motor).sin_cos();
        self.cosine * cos + self.sine * sin
    }

    /// Its change per motor coordinate. By virtual work the motor carries `1 + slope` times the
    /// transmission's torque.
    pub fn slope(&self, motor: f64) -> f64 {
        let (sin, cos) = (self.phase_per_coordinate * motor).sin_cos();
        self.phase_per_coordinate * (self.sine * cos - self.cosine * sin)
    }
}

/// Elastic-plastic friction: Bouc's law in Wen's form with n = 1 and no pinching, which is Dahl's,
/// `dz = (dw - |dw| z) / w_y`, torque `A z` with `|z| <= 1`. Rate-independent.
///
/// Sources: `bouc1967`; `wen1976`, A = β = 1, γ = 0, n = 1; `dahl1968`, i = 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoucWen {
    /// A, torque at which the loop saturates, N m (N).
    pub amplitude: f64,
    /// w_y, wind-up over which it builds up, rad (m).
    pub yield_windup: f64,
}

impl BoucWen {
    /// The state after the wind-up has changed by `change` in one direction: exact,
    /// `z⁺ = s + (z - s) exp(-|Δw| / w_y)`, `s` the sign of Δw, hence bounded at any step.
    pub fn advance(&self, state: f64, change: f64) -> f64 {
        if change == 0.0 {
            return state;
        }
        let goal = change.signum();
        goal + (state - goal) * (-change.abs() / self.yield_windup).exp()
    }

    /// Torque on the link, N m (N).
    pub fn torque(&self, state: f64) -> f64 {
        self.amplitude * state
    }

    /// Largest slope of the torque over the wind-up: where the motion turns round in saturation.
    pub fn largest_stiffness(&self) -> f64 {
        2.0 * self.amplitude / self.yield_windup
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verify_torque_is_the_slope_of_the_energy_and_windup_its_inverse() {
        for cubic in [0.0, 3e9, -2e7] {
            let spring = Elastic {
                stiffness: 1e6,
                cubic,
                gap: 2e-4,
            };
            let h = 1e-8;
            for w in [-3e-3, -2e-4, 1.5e-4, 5e-3] {
                let slope = (spring.energy_j(w + h) - spring.energy_j(w - h)) / (2.0 * h);
                let torque = spring.torque(w);
                assert!(
                    (torque - slope).abs() < 1e-6 * torque.abs().max(1.0),
                    "{w}: {torque} {slope}"
                );
                let back = spring.windup(torque).unwrap();
                assert!((back - w).abs() < 1e-12, "{w} {back}");
            }
        }
    }

    #[test]
    fn verify_nothing_acts_within_the_play() {
        let spring = Elastic {
            stiffness: 1e6,
            cubic: 1e9,
            gap: 1e-3,
        };
        for w in [-5e-4, -1e-4, 0.0, 5e-4] {
            assert_eq!((spring.torque(w), spring.engaged(w)), (0.0, false));
        }
        assert!(spring.engaged(5.001e-4));
        assert_eq!(spring.windup(0.0), Some(0.0));
    }

    /// A softening spring carries at most `2/3 K √(K / 3|K3|)`.
    #[test]
    fn verify_a_softening_spring_carries_only_so_much() {
        let (k, k3): (f64, f64) = (1e6, -1e11);
        let spring = Elastic {
            stiffness: k,
            cubic: k3,
            gap: 0.0,
        };
        let most = 2.0 / 3.0 * k * (k / (3.0 * -k3)).sqrt();
        assert!(spring.windup(0.99 * most).is_some());
        assert_eq!(spring.windup(1.01 * most), None);
    }

    #[test]
    fn verify_ripple_slope_is_its_derivative() {
        let ripple = Ripple {
            cosine: 2e-5,
            sine: -1e-5,
            phase_per_coordinate: 80.0,
        };
        let h = 1e-7;
        for q in [-1.0, 0.0, 0.013, 2.0] {
            let slope = (ripple.error(q + h) - ripple.error(q - h)) / (2.0 * h);
            assert!((ripple.slope(q) - slope).abs() < 1e-9, "{q}");
        }
    }

    /// The steady loop of half width X ends at `z = tanh(X / w_y)` and encloses
    /// `4 A (X - w_y tanh(X / w_y))`.
    #[test]
    fn verify_bouc_wen_loop_encloses_its_closed_form() {
        let law = BoucWen {
            amplitude: 50.0,
            yield_windup: 3e-4,
        };
        for half in [5e-5, 3e-4, 2e-3] {
            let (mut z, mut w) = (0.0, 0.0);
            let steps = 20_000;
            let mut work = 0.0;
            for i in 0..20 * steps {
                let next = half * (std::f64::consts::TAU * (i + 1) as f64 / steps as f64).sin();
                let after = law.advance(z, next - w);
                if i >= 19 * steps {
                    work += 0.5 * law.amplitude * (z + after) * (next - w);
                }
                (z, w) = (after, next);
            }
            let x = half / law.yield_windup;
            let expected = 4.0 * law.amplitude * (half - law.yield_windup * x.tanh());
            assert!(
                (work / expected - 1.0).abs() < 1e-5,
                "{half}: {work} {expected}"
            );
            assert!(work > 0.0, "friction takes energy");
        }
    }

    #[test]
    fn verify_bouc_wen_depends_on_the_path_not_on_its_pace() {
        let law = BoucWen {
            amplitude: 1.0,
            yield_windup: 1e-3,
        };
        let mut slow = 0.2;
        for _ in 0..1000 {
            slow = law.advance(slow, -3e-6);
        }
        assert!((slow - law.advance(0.2, -3e-3)).abs() < 1e-12);
        assert_eq!(law.advance(0.3, 0.0), 0.3);
        assert!(law.advance(-0.5, 1e6) <= 1.0, "bounded at any step");
        let h = 1e-9;
        let slope = (law.torque(law.advance(-1.0, h)) - law.torque(-1.0)) / h;
        assert!((slope / law.largest_stiffness() - 1.0).abs() < 1e-5);
    }
}
