//! Modes of tool and workpiece in a run.
//!
//! Each is an oscillator of its own, stepped exactly ([`truecut_core::oscillator`]) beside the arm.
//! A tool mode stands on the arm's tool point, which its coordinate z counts from the path (in
//! milling; from the start elsewhere) like the point's own deflection x along the mode's direction
//! n:
//!
//! `m z'' + c z' + k z = nᵀF + c x' + k x`, deflection of the mode `s = z − x`.
//!
//! The arm then feels, in place of nᵀF, spring and damper and what it no longer accelerates itself
//! (m is a part of its mass): `k s + c s' + m x''`. The acceleration of the tool point is foreseen
//! from its last four places, which leaves an error of second order in the step on a part m/M of
//! the force, M being the arm's mass at its tool point. A workpiece mode is the same with x = 0 and
//! no part in what the arm feels; its deflection is that of the tool relative to it.

use nalgebra::{Matrix3, Vector3};
use truecut_core::chatter::{AttachedMode, AttachedModes};
use truecut_core::oscillator::{ExactStep, OscillatorState};
use truecut_recording::{ChannelSpec, Unit};

/// Where a tip or the arm's tool point stands off the path, and the rate of that; in the frame of
/// the process.
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
    /// Along `mode.direction` in the frame of the process.
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
        [frame_from_tool, frame_from_world]: [&Matrix3<f64>; 2],
        step_s: f64,
    ) -> Self {
        let of = |modes: &[AttachedMode], axes| -> Vec<Moving> {
            let moving = modes.iter().map(|mode| Moving::new(mode, axes, step_s));
            moving.collect()
        };
        Self {
            tool: of(&attached.tool, frame_from_tool),
            workpiece: of(&attached.workpiece, frame_from_world),
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
    pub fn turn(&mut self, frame_from_tool: &Matrix3<f64>) {
        for one in &mut self.tool {
            one.direction = frame_from_tool * one.mode.direction;
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

/// Channels of the modes beside the arm's, of a process by its name.
pub(super) fn channels(process: &str, attached: &AttachedModes) -> Vec<ChannelSpec> {
    let of = |whose: &'static str, foot: &'static str, modes: &[AttachedMode]| {
        (1..=modes.len()).map(move |number| {
            ChannelSpec::new(
                format!("{process}.{whose}_mode{number}_deflection"),
                Unit::Metre,
                format!(
                    "Deflection of mode {number} of the {whose} against {foot}, along its direction"
                ),
            )
        })
    };
    let tool = of("tool", "the arm's tool point", &attached.tool);
    // A workpiece that gives way is a tool that gets deeper into it.
    let workpiece = of("workpiece", "the ground, seen from it", &attached.workpiece);
    tool.chain(workpiece).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};
    use std::f64::consts::TAU;

    /// The arm's mass at its tool point, and its spring.
    const ARM_KG: f64 = 20.0;
    const ARM_HZ: f64 = 30.0;
    const STEP_S: f64 = 25e-6;
    const STEPS: usize = 8000;

    fn mode(damping_ratio: f64) -> AttachedMode {
        AttachedMode::new(1e3, damping_ratio, 1e7, [0.0, 1.0, 0.0])
    }

    fn modes(mode: AttachedMode) -> Modes {
        let attached = AttachedModes {
            tool: vec![mode],
            ..AttachedModes::default()
        };
        let unit = Matrix3::identity();
        Modes::new(&attached, [&unit, &unit], STEP_S)
    }

    /// Place and velocity of the arm, deflection and rate of the mode.
    type Row = [f64; 4];

    /// An arm of one spring, stepped as a leapfrog, and a mode on it, released from rest under 100
    /// N.
    fn released(mode: AttachedMode) -> Vec<Row> {
        let mut modes = modes(mode);
        let stiffness = ARM_KG * (TAU * ARM_HZ).powi(2);
        let at = |place: f64, rate: f64| TipMotion {
            deflection_m: Vector3::y() * place,
            rate_m_per_s: Vector3::y() * rate,
        };
        let mut place = 100.0 / stiffness;
        modes.rest(&at(place, 0.0), &(Vector3::y() * 100.0));
        let (mut half, mut before) = (0.0, 0.0);
        let still = Vector3::zeros();
        let mut rows = Vec::new();
        for step in 0..STEPS {
            let foreseen = at(place, 1.5 * half - 0.5 * before);
            let force = modes.on_arm_n(&foreseen, &still).map_or(0.0, |f| f.y) - stiffness * place;
            let kick = force / ARM_KG * STEP_S;
            if step == 0 {
                half = -0.5 * kick;
            }
            let after = half + kick;
            let now = at(place, 0.5 * (half + after));
            let relative = modes.deflection(&foreseen);
            rows.push([
                place,
                now.rate_m_per_s.y,
                relative.deflection_m.y,
                modes.tool[0].state.velocity - now.rate_m_per_s.y,
            ]);
            modes.advance(&now, &still);
            (before, half) = (half, after);
            place += after * STEP_S;
        }
        rows
    }

    /// The same by the exponential of the state matrix of M', D', K'.
    fn exact(mode: &AttachedMode) -> Vec<Row> {
        let (m, c, k) = (
            mode.mass_kg(),
            mode.damping_n_s_per_m(),
            mode.stiffness_n_per_m,
        );
        let arm = ARM_KG * (TAU * ARM_HZ).powi(2);
        let mass = DMatrix::from_row_slice(2, 2, &[ARM_KG, m, m, m]);
        let inverse = mass.try_inverse().expect("the arm is heavier");
        let diagonal = |a: f64, b: f64| DMatrix::from_diagonal(&DVector::from_vec(vec![a, b]));
        let mut state = DMatrix::zeros(4, 4);
        state.view_mut((0, 2), (2, 2)).fill_with_identity();
        (state.view_mut((2, 0), (2, 2))).copy_from(&(-&inverse * diagonal(arm, k)));
        (state.view_mut((2, 2), (2, 2))).copy_from(&(-&inverse * diagonal(0.0, c)));
        let step = (state * STEP_S).exp();
        let mut at = DVector::from_vec(vec![100.0 / arm, 100.0 / k, 0.0, 0.0]);
        let mut rows = Vec::new();
        for _ in 0..STEPS {
            rows.push([at[0], at[2], at[1], at[3]]);
            at = &step * at;
        }
        rows
    }

    /// Arm and mode are the assembled system: 200 periods of the mode, six of the arm.
    #[test]
    fn verify_arm_and_mode_move_as_the_assembled_system() {
        let mode = mode(0.01);
        let (found, expected) = (released(mode), exact(&mode));
        for part in [0, 2] {
            let largest = expected
                .iter()
                .fold(0.0_f64, |most, row| most.max(row[part].abs()));
            let apart = found
                .iter()
                .zip(&expected)
                .map(|(a, b)| (a[part] - b[part]).abs());
            let worst = apart.fold(0.0, f64::max);
            println!("{part}: {:.2e}", worst / largest);
            assert!(worst < 5e-3 * largest, "{part}: {}", worst / largest);
        }
    }

    /// Nothing is gained or lost without damping: kinetic energy of the assembled masses and both
    /// springs.
    #[test]
    fn verify_energy_of_arm_and_mode_is_kept() {
        let mode = mode(0.0);
        let (m, k) = (mode.mass_kg(), mode.stiffness_n_per_m);
        let arm = ARM_KG * (TAU * ARM_HZ).powi(2);
        let energy = |[x, v, s, w]: &Row| {
            0.5 * ARM_KG * v * v + m * v * w + 0.5 * m * w * w + 0.5 * arm * x * x + 0.5 * k * s * s
        };
        let rows = released(mode);
        let start = energy(&rows[0]);
        let worst = rows
            .iter()
            .map(|row| (energy(row) / start - 1.0).abs())
            .fold(0.0, f64::max);
        let end = energy(&rows[STEPS - 1]) / start - 1.0;
        println!("at most {worst:.2e}, at the end {end:.2e}");
        assert!(worst < 5e-3, "{worst}");
    }
}
