//! Modes of tool and workpiece in a run.
//!
//! Each is an oscillator of its own, stepped exactly ([`truecut_core::oscillator`]) beside the arm.
//! A tool mode stands on the arm's tool point, which its coordinate z counts from the path like the
//! point's own deflection x along the mode's direction n:
//!
//! `m z'' + c z' + k z = nᵀF + c x' + k x`, deflection of the mode `s = z − x`.
//!
//! The arm then feels, in place of nᵀF, spring and damper and what it no longer accelerates itself
//! (m is a part of its mass): `k s + c s' + m x''`. The acceleration of the tool point is foreseen
//! from its last four places, which leaves an error of second order in the step on a part m/M of the
//! force, M being the arm's mass at its tool point. A workpiece mode is the same with x = 0 and no
//! part in what the arm feels; its deflection is that of the tool relative to it.

use nalgebra::{Matrix3, Vector3};
use truecut_core::chatter::{AttachedMode, AttachedModes};
use truecut_core::oscillator::{ExactStep, OscillatorState};

/// A force, and where the arm's tool point stands off the path with its rate; milling frame.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct TipMotion {
    pub deflection_m: Vector3<f64>,
    pub rate_m_per_s: Vector3<f64>,
}

/// The modes of a pass.
#[derive(Debug, Clone, Default)]
pub(super) struct Modes {
    tool: Vec<Moving>,
    workpiece: Vec<Moving>,
    step_s: f64,
    /// Places of the arm's tool point at the instants before, the latest first.
    places_m: [Vector3<f64>; 3],
    /// How many of them are known.
    known: usize,
}

/// One of them.
#[derive(Debug, Clone)]
struct Moving {
    mode: AttachedMode,
    /// Along `mode.direction` in the milling frame.
    direction: Vector3<f64>,
    step: ExactStep,
    state: OscillatorState,
}

impl Moving {
    fn new(mode: &AttachedMode, axes: &Matrix3<f64>, step_s: f64) -> Self {
        Self {
            mode: *mode,
            direction: axes * mode.direction,
            step: ExactStep::new(mode.natural_frequency_rad_s, mode.damping_ratio, step_s),
            state: OscillatorState::default(),
        }
    }

    /// Starts under a force at rest.
    fn rest(&mut self, foot: &TipMotion, force_n: &Vector3<f64>) {
        let (n, k) = (&self.direction, self.mode.stiffness_n_per_m);
        let position = n.dot(force_n) / k + n.dot(&foot.deflection_m);
        self.state = OscillatorState::new(position, n.dot(&foot.rate_m_per_s));
    }

    /// Deflection against the foot and its rate.
    fn against(&self, foot: &TipMotion) -> (f64, f64) {
        let n = &self.direction;
        (
            self.state.position - n.dot(&foot.deflection_m),
            self.state.velocity - n.dot(&foot.rate_m_per_s),
        )
    }

    fn advance(&mut self, foot: &TipMotion, force_n: &Vector3<f64>) {
        let (n, mode) = (&self.direction, &self.mode);
        let force = n.dot(force_n)
            + mode.stiffness_n_per_m * n.dot(&foot.deflection_m)
            + mode.damping_n_s_per_m() * n.dot(&foot.rate_m_per_s);
        self.state = self.step.next(&self.state, force / mode.mass_kg());
    }
}

impl Modes {
    /// Modes of a run that have not been placed yet.
    pub fn new(
        attached: &AttachedModes,
        [milling_from_tool, milling_from_world]: [&Matrix3<f64>; 2],
        step_s: f64,
    ) -> Self {
        let of = |modes: &[AttachedMode], axes| -> Vec<Moving> {
            let moving = modes.iter().map(|mode| Moving::new(mode, axes, step_s));
            moving.collect()
        };
        Self {
            tool: of(&attached.tool, milling_from_tool),
            workpiece: of(&attached.workpiece, milling_from_world),
            step_s,
            ..Self::default()
        }
    }

    /// At rest under a force, on a tool point at `foot`.
    pub fn rest(&mut self, foot: &TipMotion, force_n: &Vector3<f64>) {
        let still = TipMotion::default();
        self.tool.iter_mut().for_each(|one| one.rest(foot, force_n));
        let workpiece = self.workpiece.iter_mut();
        workpiece.for_each(|one| one.rest(&still, force_n));
    }

    /// Follows a tool that has turned.
    pub fn turn(&mut self, milling_from_tool: &Matrix3<f64>) {
        for one in &mut self.tool {
            one.direction = milling_from_tool * one.mode.direction;
        }
    }

    /// What all modes add to the deflection of the tip from the path on the workpiece.
    pub fn deflection(&self, foot: &TipMotion) -> TipMotion {
        let mut sum = TipMotion::default();
        let still = TipMotion::default();
        let tool = self.tool.iter().map(|one| (one, foot));
        for (one, foot) in tool.chain(self.workpiece.iter().map(|one| (one, &still))) {
            let (position, rate) = one.against(foot);
            sum.deflection_m += one.direction * position;
            sum.rate_m_per_s += one.direction * rate;
        }
        sum
    }

    /// Deflection of each mode along its direction, m: tool modes, then workpiece modes.
    pub fn each_m<'a>(&'a self, foot: &'a TipMotion) -> impl Iterator<Item = f64> + 'a {
        let tool = self.tool.iter().map(|one| one.against(foot).0);
        tool.chain(self.workpiece.iter().map(|one| one.state.position))
    }

    /// By what the force on the arm at its tool point differs from that on the tip; none without
    /// tool modes.
    pub fn on_arm_n(&self, foot: &TipMotion, force_n: &Vector3<f64>) -> Option<Vector3<f64>> {
        if self.tool.is_empty() {
            return None;
        }
        let mut differs = Vector3::zeros();
        let acceleration = self.acceleration(&foot.deflection_m);
        for one in &self.tool {
            let (n, mode) = (&one.direction, &one.mode);
            let (position, rate) = one.against(foot);
            let passed_on = mode.stiffness_n_per_m * position
                + mode.damping_n_s_per_m() * rate
                + mode.mass_kg() * n.dot(&acceleration);
            differs += n * (passed_on - n.dot(force_n));
        }
        Some(differs)
    }

    /// Acceleration of the arm's tool point at an instant, from its place there and at the three
    /// instants before; zero before these are known.
    fn acceleration(&self, place_m: &Vector3<f64>) -> Vector3<f64> {
        if self.known < self.places_m.len() {
            return Vector3::zeros();
        }
        let [first, second, third] = &self.places_m;
        (place_m * 2.0 - first * 5.0 + second * 4.0 - third) / (self.step_s * self.step_s)
    }

    /// A step under `force_n` on the tip, averaged over the step about the instant.
    pub fn advance(&mut self, foot: &TipMotion, force_n: &Vector3<f64>) {
        let still = TipMotion::default();
        let tool = self.tool.iter_mut();
        tool.for_each(|one| one.advance(foot, force_n));
        let workpiece = self.workpiece.iter_mut();
        workpiece.for_each(|one| one.advance(&still, force_n));
        let [first, second, _] = self.places_m;
        self.places_m = [foot.deflection_m, first, second];
        self.known = (self.known + 1).min(self.places_m.len());
    }
}
