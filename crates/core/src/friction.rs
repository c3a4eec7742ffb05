//! Friction in a plane: laws, and the impulse of one time step.
//!
//! The impulse is that of Moreau's time stepping: over a step of length `dt` the contact may
//! exchange any impulse up to `mu N dt`. If that suffices to bring the sliding velocity to zero the
//! contact sticks and the velocity *is* zero; otherwise the impulse has its full size and opposes
//! the velocity at mid-step. Nothing is regularised, so a held contact does not creep.
//!
//! Moreau's own rule opposes the velocity *after* the step. On a circling motion that lags by half
//! a step's turn and costs an order of accuracy; with the mean of the velocities before and after,
//! sliding is of second order and the work of friction over the step is exactly `p · v_mid`, never
//! positive.
//!
//! The contact sees the body through its inverse effective mass `W = J M⁻¹ Jᵀ` (2×2, in general not
//! isotropic): `v = v_free + W p`.

use crate::roots::{illinois, newton};
use nalgebra::{Matrix2, Vector2};

/// A friction law in the contact plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FrictionLaw {
    /// No tangential force at all.
    None,
    /// Coulomb: `|F| <= mu N`, and `F = -mu N v/|v|` while sliding.
    Coulomb { mu: f64 },
    /// A viscous force `F = -c v` of given coefficient in N s/m. The equivalent viscous law of
    /// `dong2018chamfering` is this with a coefficient renewed every revolution; see
    /// [`EquivalentViscous`].
    Viscous { coefficient_n_s_per_m: f64 },
    /// Stribeck: sticks up to `mu_static N`; while sliding
    /// `mu(v) = mu + (mu_static - mu) exp(-(|v|/v_s)²)`.
    Stribeck {
        mu: f64,
        mu_static: f64,
        stribeck_speed_m_per_s: f64,
    },
    /// Stribeck's law (Coulomb's with `mu_static = mu`) times `1 - drop (1 - exp(-|v|/v_d))`:
    /// friction that keeps falling with the speed.
    Falling {
        mu: f64,
        mu_static: f64,
        stribeck_speed_m_per_s: f64,
        drop: f64,
        falling_speed_m_per_s: f64,
    },
}

impl FrictionLaw {
    /// The largest tangential force per newton of normal force that holds a contact at rest.
    pub fn holding_coefficient(&self) -> f64 {
        match *self {
            Self::None | Self::Viscous { .. } => 0.0,
            Self::Coulomb { mu } => mu,
            Self::Stribeck { mu_static, .. } | Self::Falling { mu_static, .. } => mu_static,
        }
    }
}

/// What one contact does in one step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanarContact {
    /// Impulse on the body, N s.
    pub impulse_n_s: Vector2<f64>,
    /// Sliding velocity of the body at the contact after the step, m/s.
    pub velocity_m_per_s: Vector2<f64>,
    /// True when the contact slides (always, for laws that cannot hold).
    pub sliding: bool,
}

/// A body as one contact sees it over one step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Approach {
    /// `W`, 1/kg, symmetric positive definite.
    pub inverse_mass: Matrix2<f64>,
    /// Sliding velocity before the step, m/s.
    pub velocity_before_m_per_s: Vector2<f64>,
    /// Sliding velocity that the step would end with without this contact, m/s.
    pub free_velocity_m_per_s: Vector2<f64>,
}

/// Solves one contact for one step; `normal_force_n` counts as zero where it is negative.
///
/// Numeric method after `moreau1988`, with the mid-step velocity; see also
/// `docs/physics/friction.md`, of which this is the form for a body whose effective mass depends on
/// direction.
pub fn solve_planar(
    body: &Approach,
    law: FrictionLaw,
    normal_force_n: f64,
    dt_s: f64,
) -> PlanarContact {
    let normal_impulse = normal_force_n.max(0.0) * dt_s;
    match law {
        FrictionLaw::None => free(&body.free_velocity_m_per_s),
        FrictionLaw::Viscous {
            coefficient_n_s_per_m,
        } => viscous(body, coefficient_n_s_per_m * dt_s),
        FrictionLaw::Coulomb { mu } => bounded(body, mu * normal_impulse),
        FrictionLaw::Stribeck {
            mu,
            mu_static,
            stribeck_speed_m_per_s,
        } => stribeck(body, normal_impulse, |speed| {
            mu + (mu_static - mu) * (-(speed / stribeck_speed_m_per_s).powi(2)).exp()
        }),
        FrictionLaw::Falling {
            mu,
            mu_static,
            stribeck_speed_m_per_s,
            drop,
            falling_speed_m_per_s,
        } => stribeck(body, normal_impulse, |speed| {
            let level = mu + (mu_static - mu) * (-(speed / stribeck_speed_m_per_s).powi(2)).exp();
            level * (1.0 + drop * (-speed / falling_speed_m_per_s).exp_m1())
        }),
    }
}

fn free(velocity: &Vector2<f64>) -> PlanarContact {
    PlanarContact {
        impulse_n_s: Vector2::zeros(),
        velocity_m_per_s: *velocity,
        sliding: true,
    }
}

/// `p = -c dt v` with the velocity after the step, hence unconditionally stable.
fn viscous(body: &Approach, c_dt: f64) -> PlanarContact {
    let system = Matrix2::identity() + body.inverse_mass * c_dt;
    let velocity = solve_2x2(&system, &body.free_velocity_m_per_s);
    PlanarContact {
        impulse_n_s: -velocity * c_dt,
        velocity_m_per_s: velocity,
        sliding: true,
    }
}

/// Impulse of at most `bound`: stick if possible, else slide with the full bound.
fn bounded(body: &Approach, bound: f64) -> PlanarContact {
    let (w, v_free) = (&body.inverse_mass, &body.free_velocity_m_per_s);
    if bound <= 0.0 {
        return free(v_free);
    }
    let holding = -solve_2x2(w, v_free);
    if holding.norm() <= bound {
        return PlanarContact {
            impulse_n_s: holding,
            velocity_m_per_s: Vector2::zeros(),
            sliding: false,
        };
    }
    // v_mid = ½ (v_before + v_free) + ½ W p: the same problem with half of W.
    let half = w * 0.5;
    let middle = (body.velocity_before_m_per_s + v_free) * 0.5;
    let impulse = if solve_2x2(&half, &middle).norm() > bound {
        sliding_impulse(&half, &middle, bound)
    } else {
        // The motion turns round within the step and has no direction at its middle; what is left
        // of it afterwards has one.
        sliding_impulse(w, v_free, bound)
    };
    PlanarContact {
        impulse_n_s: impulse,
        velocity_m_per_s: v_free + w * impulse,
        sliding: true,
    }
}

/// A step so small beside λ is the last: convergence is quadratic, three are usual.
const LAST_STEP: f64 = 1e-8;

/// The sliding impulse `p` with `|p| = bound` opposite to the velocity `v + W p`:
/// `p = -(W + λ I)⁻¹ v`, `λ > 0`, for which that velocity is `-λ p`. The scalar equation
/// `1/|p(λ)| = 1/bound` is nearly linear in λ, so Newton on it (as in trust-region methods)
/// converges in a few steps from below. It begins where `λ` would be if all of `W` were its largest
/// eigenvalue, which is never above the root.
fn sliding_impulse(w: &Matrix2<f64>, v: &Vector2<f64>, bound: f64) -> Vector2<f64> {
    let per_bound = 1.0 / bound;
    let (a, b, d) = (w[(0, 0)], w[(0, 1)], w[(1, 1)]);
    let largest = 0.5 * (a + d) + (0.25 * (a - d) * (a - d) + b * b).sqrt();
    let start = (v.norm() * per_bound - largest).max(0.0);
    // Of `(W + λ I)⁻¹ v` what stands over the determinant.
    let over = |lambda: f64, x: &Vector2<f64>| {
        let (a, d) = (a + lambda, d + lambda);
        Vector2::new(d * x.x - b * x.y, a * x.y - b * x.x)
    };
    let lambda = newton(start, LAST_STEP, |lambda| {
        let determinant = (a + lambda) * (d + lambda) - b * b;
        let q = over(lambda, v);
        let square = q.norm_squared();
        (square.sqrt() * per_bound - determinant) * square / over(lambda, &q).dot(&q)
    });
    let q = over(lambda, v);
    q * (-bound / q.norm())
}

/// The part of a sliding speed to which it and the bound must agree.
const SAME_SPEED: f64 = 1e-12;

/// Speed-dependent bound: the sliding speed after the step and the bound must agree. The speed
/// falls as the bound grows, so the agreement is bracketed between the static bound and no
/// friction. A contact that the static bound cannot hold slides.
fn stribeck(
    body: &Approach,
    normal_impulse: f64,
    mu_of_speed: impl Fn(f64) -> f64,
) -> PlanarContact {
    let at_speed = |speed: f64| bounded(body, mu_of_speed(speed) * normal_impulse);
    let static_try = at_speed(0.0);
    if !static_try.sliding {
        return static_try;
    }
    let excess = |contact: &PlanarContact, speed: f64| contact.velocity_m_per_s.norm() - speed;
    let fastest = body.free_velocity_m_per_s.norm();
    let mut contact = at_speed(fastest);
    let values = [excess(&static_try, 0.0), excess(&contact, fastest)];
    illinois([0.0, fastest], values, SAME_SPEED, |speed| {
        contact = at_speed(speed);
        excess(&contact, speed)
    });
    // The last trial may have been a hair on the holding side; a sliding contact stays one.
    PlanarContact {
        sliding: true,
        ..contact
    }
}

fn solve_2x2(a: &Matrix2<f64>, b: &Vector2<f64>) -> Vector2<f64> {
    let det = a[(0, 0)] * a[(1, 1)] - a[(0, 1)] * a[(1, 0)];
    Vector2::new(
        (a[(1, 1)] * b.x - a[(0, 1)] * b.y) / det,
        (a[(0, 0)] * b.y - a[(1, 0)] * b.x) / det,
    )
}

/// Equivalent viscous friction (`dong2018chamfering`, eq. 13): `c_e = 4 F_f / (π ω X_f)`.
///
/// The amplitude `X_f` is what is being computed, so it is taken from the motion: the peak lateral
/// excursion of the revolution just finished, and not below a floor. One revolution later the
/// amplitude is `M / (c_e ω) = X_f · π M / (4 F_f)`: it grows from the floor where `4 F_f < π M`
/// and falls back to it elsewhere, which is the threshold the paper draws from its amplitude
/// becoming imaginary.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EquivalentViscous {
    /// Friction coefficient.
    pub mu: f64,
    /// Vibration frequency ω, rad/s (the spindle's).
    pub frequency_rad_s: f64,
    /// Smallest amplitude that the coefficient is computed for, m.
    pub amplitude_floor_m: f64,
}

/// Friction of a pressure foot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FootFriction {
    /// A law without memory.
    Law(FrictionLaw),
    /// The published viscous equivalent, whose coefficient follows the amplitude of the last
    /// revolution.
    Equivalent(EquivalentViscous),
}

impl EquivalentViscous {
    /// The viscous coefficient in N s/m for the amplitude of the last revolution.
    pub fn coefficient_n_s_per_m(&self, normal_force_n: f64, amplitude_m: f64) -> f64 {
        let amplitude = amplitude_m.max(self.amplitude_floor_m);
        4.0 * self.mu * normal_force_n.max(0.0)
            / (std::f64::consts::PI * self.frequency_rad_s * amplitude)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// The three statements that define the law, on random anisotropic bodies: the bound is
        /// kept, a held contact does not move, a sliding one is pushed back by the whole bound
        /// against its velocity at mid-step (or after the step, where it turns round within it).
        #[test]
        fn verify_coulomb_impulse_meets_its_definition(
            a in 1e-4..1e-1f64, b in 1e-4..1e-1f64, turn in 0.0..3.0f64,
            vx in -1.0..1.0f64, vy in -1.0..1.0f64, bx in -1.0..1.0f64, by in -1.0..1.0f64,
            mu in 0.01..1.0f64, n in 0.0..5e3f64,
        ) {
            let r = nalgebra::Rotation2::new(turn);
            let w = r.matrix() * Matrix2::new(a, 0.0, 0.0, b) * r.matrix().transpose();
            let v_free = Vector2::new(vx, vy);
            let before = Vector2::new(bx, by);
            let dt = 2.5e-4;
            let body = Approach {
                inverse_mass: w,
                velocity_before_m_per_s: before,
                free_velocity_m_per_s: v_free,
            };
            let c = solve_planar(&body, FrictionLaw::Coulomb { mu }, n, dt);
            prop_assert!(c.impulse_n_s.norm() <= mu * n * dt * (1.0 + 1e-12));
            if c.sliding && n > 1.0 {
                prop_assert!((c.impulse_n_s.norm() - mu * n * dt).abs() <= 1e-12 * mu * n * dt);
                let p = c.impulse_n_s.normalize();
                let middle = ((before + c.velocity_m_per_s) * 0.5).normalize();
                let after = c.velocity_m_per_s.normalize();
                prop_assert!((p + middle).norm() < 1e-6 || (p + after).norm() < 1e-6, "{p} {middle}");
            }
            if !c.sliding {
                prop_assert_eq!(c.velocity_m_per_s, Vector2::zeros());
                prop_assert!((v_free + w * c.impulse_n_s).norm() <= 1e-12 * v_free.norm());
            }
        }
    }

    /// A body that arrives with the velocity that it would keep.
    fn steady(inverse_mass: Matrix2<f64>, velocity: Vector2<f64>) -> Approach {
        Approach {
            inverse_mass,
            velocity_before_m_per_s: velocity,
            free_velocity_m_per_s: velocity,
        }
    }

    #[test]
    fn verify_stribeck_with_equal_coefficients_is_coulomb() {
        let w = Matrix2::new(2e-3, 3e-4, 3e-4, 1e-3);
        let v = Vector2::new(0.02, -0.05);
        let coulomb = solve_planar(
            &steady(w, v),
            FrictionLaw::Coulomb { mu: 0.2 },
            300.0,
            2.5e-4,
        );
        let law = FrictionLaw::Stribeck {
            mu: 0.2,
            mu_static: 0.2,
            stribeck_speed_m_per_s: 1e-3,
        };
        let stribeck = solve_planar(&steady(w, v), law, 300.0, 2.5e-4);
        assert!((coulomb.impulse_n_s - stribeck.impulse_n_s).norm() < 1e-12);
    }

    #[test]
    fn verify_stribeck_force_lies_on_its_curve() {
        let w = Matrix2::identity() * 2e-3;
        let (mu, mu_static, v_s, n, dt) = (0.15, 0.3, 5e-3, 400.0, 2.5e-4);
        let law = FrictionLaw::Stribeck {
            mu,
            mu_static,
            stribeck_speed_m_per_s: v_s,
        };
        for speed in [1e-3, 4e-3, 2e-2] {
            let c = solve_planar(&steady(w, Vector2::new(speed, 0.0)), law, n, dt);
            if c.sliding {
                let v = c.velocity_m_per_s.norm();
                let expected = mu + (mu_static - mu) * (-(v / v_s).powi(2)).exp();
                let got = c.impulse_n_s.norm() / (n * dt);
                assert!((got - expected).abs() < 1e-6, "{speed}: {got} {expected}");
            }
        }
        assert!(!solve_planar(&steady(w, Vector2::new(4e-5, 0.0)), law, n, dt).sliding);
    }

    #[test]
    fn verify_falling_friction_lies_on_its_curve_and_holds_at_rest() {
        let w = Matrix2::identity() * 2e-3;
        let (mu, drop, v_d, n, dt) = (0.2, 0.6, 4e-3, 400.0, 2.5e-4);
        let law = FrictionLaw::Falling {
            mu,
            mu_static: mu,
            stribeck_speed_m_per_s: 1.0,
            drop,
            falling_speed_m_per_s: v_d,
        };
        for speed in [1e-3, 4e-3, 2e-2] {
            let c = solve_planar(&steady(w, Vector2::new(0.0, -speed)), law, n, dt);
            let v = c.velocity_m_per_s.norm();
            let expected = mu * (1.0 - drop * (1.0 - (-v / v_d).exp()));
            let got = c.impulse_n_s.norm() / (n * dt);
            assert!((got - expected).abs() < 1e-6, "{speed}: {got} {expected}");
        }
        let held = 0.99 * mu * n * dt * 2e-3;
        assert!(!solve_planar(&steady(w, Vector2::new(held, 0.0)), law, n, dt).sliding);
    }

    #[test]
    fn verify_no_friction_leaves_the_velocity_alone() {
        let w = Matrix2::identity();
        let v = Vector2::new(1.0, 2.0);
        for law in [FrictionLaw::None, FrictionLaw::Coulomb { mu: 0.0 }] {
            let c = solve_planar(&steady(w, v), law, 100.0, 1e-3);
            assert_eq!(c.velocity_m_per_s, v);
            assert_eq!(c.impulse_n_s, Vector2::zeros());
        }
    }
}
