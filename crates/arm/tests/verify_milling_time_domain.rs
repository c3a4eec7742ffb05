//! A milling arm in the time domain, six modes against a cut with teeth and surface, beside the
//! stability theory.
//!
//! Steel, four teeth, full slot, 2400 rpm, at five redundancy angles. Teeth that meet the nominal
//! surface must agree with the averaged 6-DoF theory of mode coupling, teeth that meet their own
//! surface with semi-discretisation: stable at 0.9 of the limit and unstable at 1.1 of it. The two
//! limits differ by a factor of five to twenty.

use std::f64::consts::TAU;

use crate::milling_arm::robot;
use nalgebra::{DVector, Vector3};
use truecut_arm::{BranchOptions, Elbow, FrameId, Shoulder, tool_pose};
use truecut_core::chatter::averaged::mode_coupling_limit;
use truecut_core::chatter::limit::{LimitSearch, first_limit};
use truecut_core::chatter::spectral_elements::SpectralElements;
use truecut_core::chatter::{DirectionalMatrix, TipMode};
use truecut_core::cutting::milling::cut::{MillingCut, MillingParameters, ToolState};
use truecut_core::cutting::milling::cutter::Cutter;
use truecut_core::cutting::milling::engagement::Engagement;
use truecut_core::cutting::milling::nominal::NominalCut;

const TEETH: usize = 4;
const PERIOD_S: f64 = 60.0 / (2400.0 * TEETH as f64);
const STEPS: usize = 40;
/// Motion from one tooth to the next at which vibration counts as grown: a tenth of the feed.
const GROWN_M: f64 = 1e-5;

/// The arm of the posture study (`verify_milling_postures.rs`), its modes at P1 with ζ = 0.02,
/// world axes; the feed is along world x.
fn modes(angle_deg: f64) -> Vec<TipMode> {
    let robot = robot();
    let point = Vector3::new(1.050, -1.450, 0.870);
    let down = -Vector3::z_axis();
    let pose = tool_pose(&point, &down, &Vector3::x(), angle_deg.to_radians()).expect("square");
    let solver = robot.ik_solver(&BranchOptions::default());
    let geometry = solver.geometry().expect("ortho-parallel");
    let upper_front = |q: &Vec<f64>| {
        let branch = geometry.branch(q);
        (branch.shoulder, branch.elbow) == (Shoulder::Front, Elbow::Upper)
    };
    let postures = solver.branches(&pose, FrameId::Tool);
    let q = postures.into_iter().find(upper_front).expect("in reach");
    let mut modes = robot.tip_modes(&q, FrameId::Tool, None).expect("stiffness");
    modes.iter_mut().for_each(|m| m.damping_ratio = 0.02);
    modes
}

fn process() -> DirectionalMatrix {
    DirectionalMatrix::planar(TEETH, 2e9, 0.3, Engagement::SLOT)
}

/// The arm in the cut: modal coordinates and rates.
struct Run<'a> {
    modes: &'a [TipMode],
    cut: MillingCut,
}

impl<'a> Run<'a> {
    /// A cut that begins steadily, the arm deflected by the mean force.
    fn new(modes: &'a [TipMode], depth_m: f64, regeneration: bool) -> (Self, DVector<f64>) {
        let cutter = Cutter::straight(10e-3, TEETH);
        let nominal = NominalCut {
            cutter,
            coefficients: process().coefficients,
            engagement: Engagement::SLOT,
            axial_depth_m: depth_m,
            feed_per_tooth_m: 0.1e-3,
        };
        let push = nominal.average_force_n();
        let n = modes.len();
        let rest = DVector::from_fn(2 * n, |i, _| {
            if i < n {
                let mode = &modes[i];
                mode.shape_per_sqrt_kg.dot(&push) / mode.natural_frequency_rad_s.powi(2)
            } else {
                0.0
            }
        });
        let p = MillingParameters {
            cutter,
            coefficients: nominal.coefficients,
            stock: Engagement::SLOT.stock(&cutter, depth_m),
            feed_per_tooth_m: nominal.feed_per_tooth_m,
            regeneration,
            steady_displacement_m: displacement(modes, &rest),
            passes: 2 * TEETH,
            slice_lag_rad: 0.02,
        };
        let cut = MillingCut::new(p, None);
        (Self { modes, cut }, rest)
    }

    fn state(&self, t: f64, y: &DVector<f64>) -> ToolState {
        let mut displacement_m = displacement(self.modes, y);
        // The study's forces see the plane only: the depth is held.
        displacement_m.z = 0.0;
        ToolState {
            // A fifth of a step off, so that entry and exit are not a matter of rounding.
            rotation_rad: TAU / TEETH as f64 * (t / PERIOD_S + 0.21 / STEPS as f64),
            displacement_m,
            ..ToolState::default()
        }
    }

    fn rate(&self, t: f64, y: &DVector<f64>) -> DVector<f64> {
        let n = self.modes.len();
        let force = self.cut.evaluate(&self.state(t, y)).force_on_tool_n;
        DVector::from_fn(2 * n, |i, _| {
            if i < n {
                return y[n + i];
            }
            let mode = &self.modes[i - n];
            let omega = mode.natural_frequency_rad_s;
            let push = mode.shape_per_sqrt_kg.dot(&force);
            push - 2.0 * mode.damping_ratio * omega * y[i] - omega * omega * y[i - n]
        })
    }

    /// Growth rate (1/s) of vibration that is not periodic with the teeth, from a tenth of a
    /// micrometre on; infinite once it has grown a hundredfold, before teeth leave the cut. RK4.
    fn growth_per_s(&mut self, rest: &DVector<f64>, periods: usize) -> f64 {
        let dt = PERIOD_S / STEPS as f64;
        let mut y = rest.clone();
        y[0] *= 1.0 + 1e-4;
        let mut sizes = Vec::new();
        let mut last = y.clone();
        for i in 0..periods * STEPS {
            let t = i as f64 * dt;
            if i % STEPS == 0 {
                let change = &y - &last;
                if displacement(self.modes, &change).norm() > GROWN_M {
                    return f64::INFINITY;
                }
                sizes.push(self.energy(&change));
                last.clone_from(&y);
            }
            let state = self.state(t, &y);
            self.cut.commit(&state);
            let k1 = self.rate(t, &y);
            let k2 = self.rate(t + 0.5 * dt, &(&y + &k1 * (0.5 * dt)));
            let k3 = self.rate(t + 0.5 * dt, &(&y + &k2 * (0.5 * dt)));
            let k4 = self.rate(t + dt, &(&y + &k3 * dt));
            y += (k1 + k2 * 2.0 + k3 * 2.0 + k4) * (dt / 6.0);
        }
        let window = periods / 5;
        let mean = |from: usize| sizes[from..from + window].iter().sum::<f64>();
        let (early, late) = (2 * window, periods - window);
        0.5 * (mean(late) / mean(early)).ln() / ((late - early) as f64 * PERIOD_S)
    }

    fn energy(&self, y: &DVector<f64>) -> f64 {
        let n = self.modes.len();
        let modes = self.modes.iter().enumerate();
        let parts =
            modes.map(|(j, m)| (m.natural_frequency_rad_s * y[j]).powi(2) + y[n + j].powi(2));
        parts.sum()
    }
}

fn displacement(modes: &[TipMode], y: &DVector<f64>) -> Vector3<f64> {
    let modes = modes.iter().zip(y.iter());
    modes.map(|(mode, q)| mode.shape_per_sqrt_kg * *q).sum()
}

fn growth_per_s(modes: &[TipMode], depth_m: f64, regeneration: bool) -> f64 {
    let (mut run, rest) = Run::new(modes, depth_m, regeneration);
    // Regenerative growth 10 % above the limit is as slow as 0.4 /s, and slow modes must first die
    // away.
    let periods = if regeneration { 2000 } else { 400 };
    run.growth_per_s(&rest, periods)
}

#[test]
fn verify_arm_without_regeneration_has_the_limit_of_mode_coupling() {
    for angle_deg in [20.0, 60.0, 120.0, 160.0, 220.0] {
        let modes = modes(angle_deg);
        let theory = mode_coupling_limit(&modes, &process().average_pa()).expect("a limit");
        let growth = |share: f64| growth_per_s(&modes, share * theory.depth_m, false);
        let (below, above) = (growth(0.9), growth(1.1));
        assert!(
            below < 0.0 && above > 0.0,
            "{angle_deg} deg: {below} and {above} /s"
        );
    }
}

#[test]
fn verify_arm_with_regeneration_has_the_limit_of_spectral_elements() {
    for angle_deg in [20.0, 60.0, 120.0, 160.0, 220.0] {
        let modes = modes(angle_deg);
        let elements = SpectralElements::new(&modes, &process());
        let search = LimitSearch::to_depth(5e-3);
        let theory = first_limit(&elements, PERIOD_S, &search).expect("a limit");
        let coupling = mode_coupling_limit(&modes, &process().average_pa()).expect("a limit");
        assert!(theory.depth_m > 4.0 * coupling.depth_m, "{angle_deg} deg");
        let growth = |share: f64| growth_per_s(&modes, share * theory.depth_m, true);
        let (below, above) = (growth(0.9), growth(1.1));
        assert!(
            below < 0.0 && above > 0.0,
            "{angle_deg} deg: {below} and {above} /s"
        );
    }
}
