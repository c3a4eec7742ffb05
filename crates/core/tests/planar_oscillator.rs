//! A planar oscillator with one friction contact, against closed forms for oscillators under
//! rotating forces and dry friction.

use std::f64::consts::PI;

use nalgebra::{Matrix2, Vector2};
use truecut_core::friction::{Approach, FrictionLaw, solve_planar};

use crate::vibration_tables;

/// Radius of the circle on which an undamped isotropic oscillator runs under a rotating force `M`
/// against Coulomb friction `μN`: `√(M² - (μN)²) / |k - mω²|`, and zero once `μN ≥ M`
/// (`docs/physics/vibration.md`). Friction opposes the velocity, which is at right angles to the
/// elastic and inertial forces: the three form a right triangle with `M` as its hypotenuse.
fn circular_friction_radius(
    rotating_force: f64,
    friction_force: f64,
    stiffness: f64,
    mass: f64,
    omega: f64,
) -> f64 {
    let rest = rotating_force * rotating_force - friction_force * friction_force;
    rest.max(0.0).sqrt() / (stiffness - mass * omega * omega).abs()
}

/// Amplitude of `dong2018chamfering` (eqs. 22–25): `√(M² - (4μN/π)²) / |k - mω²|`, `None` where it
/// is imaginary.
fn paper_amplitude(
    force: f64,
    friction_force: f64,
    stiffness: f64,
    mass: f64,
    omega: f64,
) -> Option<f64> {
    let rest = force * force - (4.0 * friction_force / PI).powi(2);
    (rest >= 0.0).then(|| rest.sqrt() / (stiffness - mass * omega * omega).abs())
}

/// Den Hartog's amplitude (`denhartog1931`) of an undamped oscillator with Coulomb friction under a
/// harmonic force, as a multiple of `F/k`, for motion without stops: `√(V² - ρ²U²)`,
/// `V = 1/(1-r²)`, `U = sin(π/r) / (r (1 + cos(π/r)))`, with `r = ω/ω_n` and `ρ = F_f/F`. `None`
/// where it is imaginary.
fn den_hartog_amplification(frequency_ratio: f64, friction_ratio: f64) -> Option<f64> {
    let r = frequency_ratio;
    let v = 1.0 / (1.0 - r * r);
    let u = (PI / r).sin() / (r * (1.0 + (PI / r).cos()));
    let rest = v * v - (friction_ratio * u).powi(2);
    (rest >= 0.0).then(|| rest.sqrt())
}

/// Two uncoupled oscillators in a plane with one friction contact: the model of
/// `docs/physics/vibration.md`.
#[derive(Debug, Clone, Copy)]
struct PlanarOscillator {
    mass_kg: f64,
    stiffness_n_per_m: Vector2<f64>,
    damping_n_s_per_m: Vector2<f64>,
    law: FrictionLaw,
    normal_force_n: f64,
}

impl PlanarOscillator {
    /// Runs from rest under `force(t)` with Moreau–Jean stepping (`docs/physics/friction.md`) and
    /// shows every state (time, position, velocity) to `observe`.
    fn run(
        &self,
        force_n: impl Fn(f64) -> Vector2<f64>,
        dt_s: f64,
        duration_s: f64,
        mut observe: impl FnMut(f64, &Vector2<f64>, &Vector2<f64>),
    ) {
        let inverse_mass = Matrix2::identity() / self.mass_kg;
        let (mut x, mut v) = (Vector2::zeros(), Vector2::zeros());
        let steps = (duration_s / dt_s).round() as usize;
        for i in 0..steps {
            let t = i as f64 * dt_s;
            let smooth = force_n(t)
                - self.stiffness_n_per_m.component_mul(&x)
                - self.damping_n_s_per_m.component_mul(&v);
            let free = v + smooth * (dt_s / self.mass_kg);
            let body = Approach {
                inverse_mass,
                velocity_before_m_per_s: v,
                free_velocity_m_per_s: free,
            };
            let contact = solve_planar(&body, self.law, self.normal_force_n, dt_s);
            v = contact.velocity_m_per_s;
            x += v * dt_s;
            observe(t + dt_s, &x, &v);
        }
    }
}

const MASS: f64 = 557.3;
const K2: f64 = 1.078e6;
const K3: f64 = 1.394e6;
const M: f64 = 109.68;

fn rotating(omega: f64) -> impl Fn(f64) -> Vector2<f64> {
    move |t| M * Vector2::new((omega * t).cos(), (omega * t).sin())
}

fn steady_amplitude(rho: f64, rpm: f64, zeta: f64, k: Vector2<f64>) -> Vector2<f64> {
    let omega = rpm / 60.0 * 2.0 * PI;
    let oscillator = PlanarOscillator {
        mass_kg: MASS,
        stiffness_n_per_m: k,
        damping_n_s_per_m: k.map(|k| 2.0 * zeta * (k * MASS).sqrt()),
        law: FrictionLaw::Coulomb { mu: rho },
        normal_force_n: M,
    };
    let period = 60.0 / rpm;
    let revolutions = if zeta > 0.0 { 60.0 } else { 400.0 };
    let (mut low, mut high) = (Vector2::repeat(f64::MAX), Vector2::repeat(f64::MIN));
    oscillator.run(
        rotating(omega),
        period / 4000.0,
        revolutions * period,
        |t, x, _| {
            if t > (revolutions - 2.0) * period {
                low = low.inf(x);
                high = high.sup(x);
            }
        },
    );
    (high - low) / 2.0
}

/// The same in µm, of two oscillators of different stiffness with the damping of the tables.
fn steady_um(rho: f64, rpm: f64) -> (f64, f64) {
    let amplitude = steady_amplitude(rho, rpm, 0.02, Vector2::new(K2, K3)) * 1e6;
    (amplitude.x, amplitude.y)
}

#[test]
fn verify_steady_amplitude_table_300_rpm() {
    vibration_tables::check_300_rpm(|rho| steady_um(rho, 300.0));
}

#[test]
fn verify_steady_amplitude_400_rpm() {
    vibration_tables::check_400_rpm(|rho| steady_um(rho, 400.0));
}

/// Isotropic closed form: 179.9, 128.7, 90.5 µm, and the integrator on it.
#[test]
fn verify_circular_motion_against_friction() {
    let omega = 10.0 * PI;
    for (rho, um) in [(0.5, 179.9), (0.785, 128.7), (0.9, 90.5)] {
        let r = circular_friction_radius(M, rho * M, K2, MASS, omega) * 1e6;
        assert!((r - um).abs() < 0.06, "{rho}: {r}");
        let a = steady_amplitude(rho, 300.0, 0.0, Vector2::repeat(K2)) * 1e6;
        assert!((a.x / um - 1.0).abs() < 0.01, "{rho}: {}", a.x);
    }
    assert_eq!(circular_friction_radius(M, M, K2, MASS, omega), 0.0);
}

/// `docs/physics/vibration.md`, Den Hartog at r = 5/7: 1.984, 1.800, 1.533; the integrator
/// agrees to 0.5 % while motion has no stops, and at ρ = 0.85, where stops appear, gives 1.10
/// instead of the formula's 1.22.
#[test]
fn verify_den_hartog() {
    let r = 5.0 / 7.0;
    let simulate = |rho: f64| {
        let natural = (K2 / MASS).sqrt();
        let omega = r * natural;
        let period = 2.0 * PI / omega;
        let oscillator = PlanarOscillator {
            mass_kg: MASS,
            stiffness_n_per_m: Vector2::repeat(K2),
            damping_n_s_per_m: Vector2::zeros(),
            law: FrictionLaw::Coulomb { mu: rho },
            normal_force_n: M,
        };
        let (mut low, mut high) = (f64::MAX, f64::MIN);
        let duration = 400.0 * period;
        oscillator.run(
            |t| Vector2::new(M * (omega * t).cos(), 0.0),
            period / 4000.0,
            duration,
            |t, x, _| {
                if t > duration - 2.0 * period {
                    low = low.min(x.x);
                    high = high.max(x.x);
                }
            },
        );
        (high - low) / 2.0 * K2 / M
    };
    for (rho, expected) in [(0.25, 1.984), (0.5, 1.800), (0.7, 1.533)] {
        let formula = den_hartog_amplification(r, rho).expect("real amplitude");
        assert!((formula - expected).abs() < 6e-4, "{rho}: {formula}");
        let got = simulate(rho);
        assert!((got / formula - 1.0).abs() < 0.005, "{rho}: {got}");
    }
    assert!((den_hartog_amplification(r, 0.85).unwrap() - 1.22).abs() < 0.01);
    assert!((simulate(0.85) - 1.10).abs() < 0.01);
}

/// The paper's amplitude at the same loads, for the record of where it departs.
#[test]
fn verify_paper_amplitude_column() {
    let omega = 10.0 * PI;
    for (rho, um) in [(0.0, 207.7), (0.5, 160.2), (0.7, 94.2), (0.785, 6.6)] {
        let a = paper_amplitude(M, rho * M, K2, MASS, omega).expect("real") * 1e6;
        assert!((a - um).abs() < 0.1, "{rho}: {a}");
    }
    assert!(paper_amplitude(M, 0.9 * M, K2, MASS, omega).is_none());
}
