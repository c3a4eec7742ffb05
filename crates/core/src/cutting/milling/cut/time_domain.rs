//! Small oscillators against the cut, in the time domain, beside the stability theory.

use super::tests::parameters;
use super::*;
use crate::chatter::limit::{LimitSearch, first_limit};
use crate::chatter::planar::tests::PlanarSplit;
use crate::chatter::spectral_elements::SpectralElements;
use crate::chatter::{DirectionalMatrix, TipMode};
use crate::cutting::chamfer::CuttingCoefficients;
use crate::cutting::milling::cutter::Cutter;
use crate::cutting::milling::engagement::Engagement;
use crate::cutting::milling::examples::aluminium;
use crate::cutting::milling::nominal::NominalCut;
use nalgebra::{Matrix2, Vector2, Vector3, Vector4};

/// One direction x against its cut, RK4, in steps of which a whole number makes a tooth period.
struct Oscillator {
    omega_rad_s: f64,
    zeta: f64,
    mass_kg: f64,
}

impl Oscillator {
    /// Growth rate (1/s) of what is left when the periodic vibration is taken away: differences
    /// between states one tooth period apart. The tool sinks to depth within `ramp` tooth periods,
    /// so slowly that teeth keep cutting.
    fn growth_per_s(&self, p: &MillingParameters, period_s: f64, ramp: usize, run: usize) -> f64 {
        let steps = (period_s * self.omega_rad_s / TAU * 50.0).ceil().max(60.0) as usize;
        let dt = period_s / steps as f64;
        let per_s = p.cutter.pitch_rad() / period_s;
        let mut cut = MillingCut::new(*p, None);
        let (mut x, mut v) = (0.0, 0.0);
        let mut strobe: Vec<(f64, f64)> = Vec::new();
        for i in 0..(ramp + run) * steps {
            let state = |t: f64, x: f64| {
                let sunk = (t / (ramp as f64 * period_s)).min(1.0);
                let z = p.stock.top_m * (1.0 - sunk);
                ToolState {
                    // Not on a step, nor half of one: entry and exit must not be a matter of
                    // rounding.
                    rotation_rad: per_s * (t + 0.21 * dt),
                    displacement_m: Vector3::new(x, 0.0, z),
                    ..ToolState::default()
                }
            };
            let t = i as f64 * dt;
            if i % steps == 0 {
                let now = (x, v / self.omega_rad_s);
                if let Some((x0, v0)) = strobe.last()
                    && (now.0 - x0).hypot(now.1 - v0) > p.feed_per_tooth_m
                {
                    return f64::INFINITY;
                }
                strobe.push(now);
            }
            cut.commit(&state(t, x));
            let rate = |t: f64, x: f64, v: f64| {
                let force = cut.evaluate(&state(t, x)).force_on_tool_n.x;
                let w = self.omega_rad_s;
                (
                    v,
                    force / self.mass_kg - 2.0 * self.zeta * w * v - w * w * x,
                )
            };
            let k1 = rate(t, x, v);
            let k2 = rate(t + 0.5 * dt, x + 0.5 * dt * k1.0, v + 0.5 * dt * k1.1);
            let k3 = rate(t + 0.5 * dt, x + 0.5 * dt * k2.0, v + 0.5 * dt * k2.1);
            let k4 = rate(t + dt, x + dt * k3.0, v + dt * k3.1);
            x += dt / 6.0 * (k1.0 + 2.0 * k2.0 + 2.0 * k3.0 + k4.0);
            v += dt / 6.0 * (k1.1 + 2.0 * k2.1 + 2.0 * k3.1 + k4.1);
        }
        let changes: Vec<f64> = strobe
            .windows(2)
            .map(|w| (w[1].0 - w[0].0).hypot(w[1].1 - w[0].1))
            .collect();
        let window = run / 4;
        let level = |from: usize| {
            let part = &changes[from..from + window];
            part.iter().map(|c| c * c).sum::<f64>().sqrt()
        };
        let (early, late) = (ramp + window, changes.len() - window);
        if level(early) < 1e-6 * p.feed_per_tooth_m {
            return f64::NEG_INFINITY;
        }
        (level(late) / level(early)).ln() / ((late - early) as f64 * period_s)
    }
}

/// Benchmark 1 in the time domain at five speeds: depth limits by bisection on the growth rate
/// agree with spectral elements within 5 %, flips among them. Both sides are good for 1 %: the
/// bisection stops at 1 %.
#[test]
fn verify_time_domain_limits_agree_with_spectral_elements() {
    let tool = Oscillator {
        omega_rad_s: TAU * 922.0,
        zeta: 0.011,
        mass_kg: 0.03993,
    };
    let mode = TipMode::of_mass(tool.omega_rad_s, tool.zeta, tool.mass_kg, &Vector3::x());
    let cutter = Cutter::straight(10e-3, 2);
    for (immersion, rpm) in [
        (0.5, 5e3),
        (0.5, 10e3),
        (1.0, 12e3),
        (0.5, 16e3),
        (1.0, 20e3),
    ] {
        let down = Engagement::down(immersion * 20e-3, 20e-3).expect("partial");
        let process = DirectionalMatrix::planar(2, 6e8, 1.0 / 3.0, down);
        let period_s = 30.0 / rpm;
        let sdm = SpectralElements::new(&[mode], &process);
        let search = LimitSearch::to_depth(5e-3);
        let theory_m = first_limit(&sdm, period_s, &search)
            .expect("a limit")
            .depth_m;
        let grows = |depth_m: f64| {
            let p = MillingParameters {
                coefficients: process.coefficients,
                stock: down.stock(&cutter, depth_m),
                feed_per_tooth_m: 20e-6,
                ..parameters(cutter, down, depth_m)
            };
            tool.growth_per_s(&p, period_s, 60, 80) > 0.0
        };
        let (mut low, mut high) = (0.7 * theory_m, 1.3 * theory_m);
        assert!(!grows(low) && grows(high), "{immersion}, {rpm} rpm");
        while high - low > 0.01 * theory_m {
            let middle = 0.5 * (low + high);
            if grows(middle) {
                high = middle;
            } else {
                low = middle;
            }
        }
        let found_m = 0.5 * (low + high);
        assert!(
            (found_m / theory_m - 1.0).abs() <= 0.05,
            "a/D {immersion}, {rpm} rpm: {found_m} m instead of {theory_m} m"
        );
    }
}

/// The flutter of `docs/physics/stability.md`, Mode coupling: two directions of 500 kg, 0.9 and 1.0
/// N/µm, in a slot cut 0.3 mm deep by two teeth that meet the nominal surface.
struct Flutter {
    cut: MillingCut,
    rest_m: Vector2<f64>,
    spindle_rad_s: f64,
}

const FLUTTER_MASS_KG: f64 = 500.0;
const FLUTTER_DAMPING_N_S_PER_M: f64 = 871.8;
const FLUTTER_DEPTH_M: f64 = 0.3e-3;

fn flutter_stiffness() -> Matrix2<f64> {
    Matrix2::new(0.9e6, 0.0, 0.0, 1.0e6)
}

impl Flutter {
    fn new() -> Self {
        let coefficients = CuttingCoefficients {
            edge_tangential_n_per_m: 0.0,
            edge_radial_n_per_m: 0.0,
            radial_pa: 0.22 * 767e6,
            ..aluminium()
        };
        let nominal = NominalCut {
            cutter: Cutter::straight(10e-3, 2),
            coefficients,
            engagement: Engagement::SLOT,
            axial_depth_m: FLUTTER_DEPTH_M,
            feed_per_tooth_m: 0.1e-3,
        };
        let k = flutter_stiffness();
        let push = nominal.average_force_n();
        let rest_m = Vector2::new(push.x / k.m11, push.y / k.m22);
        let p = MillingParameters {
            coefficients,
            feed_per_tooth_m: nominal.feed_per_tooth_m,
            regeneration: false,
            steady_displacement_m: Vector3::new(rest_m.x, rest_m.y, 0.0),
            ..parameters(nominal.cutter, Engagement::SLOT, FLUTTER_DEPTH_M)
        };
        Self {
            cut: MillingCut::new(p, None),
            rest_m,
            spindle_rad_s: 2400.0 / 60.0 * TAU,
        }
    }

    /// Rate of (x, y, ẋ, ẏ).
    fn rate(&self, t: f64, y: &Vector4<f64>) -> Vector4<f64> {
        let state = ToolState {
            rotation_rad: self.spindle_rad_s * t + 0.0066,
            displacement_m: Vector3::new(y.x, y.y, 0.0),
            ..ToolState::default()
        };
        let force = self.cut.evaluate(&state).force_on_tool_n.xy();
        let rest = flutter_stiffness() * y.xy();
        let drag = FLUTTER_DAMPING_N_S_PER_M * Vector2::new(y.z, y.w);
        let a = (force - rest - drag) / FLUTTER_MASS_KG;
        Vector4::new(y.z, y.w, a.x, a.y)
    }

    /// States a tooth period apart over three seconds, a tenth of a micrometre off rest at first;
    /// RK4.
    fn run(&self) -> Vec<Vector4<f64>> {
        let dt = TAU / self.spindle_rad_s / 200.0;
        let mut y = Vector4::new(self.rest_m.x + 1e-7, self.rest_m.y, 0.0, 0.0);
        let mut states = Vec::new();
        for i in 0..200 * 40 * 3 {
            let t = f64::from(i) * dt;
            if i % 100 == 0 {
                states.push(y);
            }
            let k1 = self.rate(t, &y);
            let k2 = self.rate(t + 0.5 * dt, &(y + k1 * (0.5 * dt)));
            let k3 = self.rate(t + 0.5 * dt, &(y + k2 * (0.5 * dt)));
            let k4 = self.rate(t + dt, &(y + k3 * dt));
            y += (k1 + 2.0 * k2 + 2.0 * k3 + k4) * (dt / 6.0);
        }
        states
    }
}

/// Growth of 1.4715 /s at 7.04 Hz. The theory averages over the turning teeth; that and the
/// measurement leave 2 %.
#[test]
fn verify_time_domain_flutter_without_regeneration() {
    let flutter = Flutter::new();
    // Tooth-periodic vibration drops out of differences between samples a tooth period apart.
    let energy = |w: &[Vector4<f64>]| {
        let d = w[1] - w[0];
        let motion = Vector2::new(d.z, d.w);
        (flutter_stiffness() * d.xy()).dot(&d.xy()) + FLUTTER_MASS_KG * motion.norm_squared()
    };
    let energies: Vec<f64> = flutter.run().windows(2).map(energy).collect();
    // Averaged over half a second, three and a half cycles, and a second apart.
    let mean = |from: usize| energies[from..from + 40].iter().sum::<f64>() / 40.0;
    let growth = 0.5 * (mean(190) / mean(110)).ln();
    let matrix = DirectionalMatrix {
        coefficients: flutter.cut.parameters().coefficients,
        ..DirectionalMatrix::planar(2, 0.0, 0.0, Engagement::SLOT)
    };
    let block = matrix.average_pa().fixed_view::<2, 2>(0, 0).into_owned();
    let split = PlanarSplit::of(&(flutter_stiffness() - block * FLUTTER_DEPTH_M));
    let theory = split.rightmost_per_s(FLUTTER_MASS_KG, FLUTTER_DAMPING_N_S_PER_M);
    assert!((theory.re / 1.471451 - 1.0).abs() < 1e-5);
    assert!((growth / theory.re - 1.0).abs() < 0.02, "{growth} {theory}");
}
