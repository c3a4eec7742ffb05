//! From the polishing table to the process that runs.

use crate::effect::WheelEffects;
use crate::error::SimError;
use crate::loads::{Attachment, Wrench, stacked};
use crate::motion;
use crate::motion::polish::indentation_m;
use crate::process::setup::{Departure, Motion};
use crate::process::{Polish, PolishSetup, Process, ProcessSetup, SetupContext, ToolState};
use crate::scene::{Tooling, shapes};
use nalgebra::{Point2, Translation3, Vector2, Vector3};
use std::sync::Arc;
use truecut_arm::{FrameId, Load, Robot};
use truecut_core::wheel::face::Face;
use truecut_core::wheel::pneumatic::PneumaticWheel;
use truecut_scenario::{PolishSpec, ProcessSpec};

/// Rounds in which the force at rest and the arm's deflection under it are found; each gains the
/// ratio of their stiffnesses, two digits or so.
const ROUNDS: usize = 12;

impl PolishSetup {
    /// Outward normal of the edge nearest to a point of the boundary.
    pub(super) fn outward(&self, at: Point2<f64>) -> Vector2<f64> {
        let face = &self.spec.face;
        let (length, width) = (face.length_m, face.width_m);
        let sides = [
            (at.x.abs(), -Vector2::x()),
            ((length - at.x).abs(), Vector2::x()),
            (at.y.abs(), -Vector2::y()),
            ((width - at.y).abs(), Vector2::y()),
        ];
        let nearest = sides.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.map_or_else(Vector2::zeros, |(_, outward)| outward)
    }

    /// Distance from a point of the face's plane to the nearest edge, positive inside, m.
    pub(super) fn inside_m(&self, at: Point2<f64>) -> f64 {
        let face = &self.spec.face;
        let (length, width) = (face.length_m, face.width_m);
        at.x.min(length - at.x).min(at.y).min(width - at.y)
    }
}

/// The process of a scenario along its path, and its workpiece.
pub(crate) fn setup(
    spec: &PolishSpec,
    context: &SetupContext<'_>,
) -> Result<ProcessSetup, SimError> {
    let robot = context.robot;
    let near = context.posture()?;
    let is_same = |other: &ProcessSpec| *other == context.scenario.process;
    let path = context.planned(&near, is_same, || motion::polish::solve(spec, robot, &near))?;
    let from = context.departure(&path);
    let setup = polish(spec, &context.effects.wheel, robot, &from)?;
    let process_from_face = from.world_from_process.inverse() * setup.world_from_face;
    let (length_m, width_m) = (spec.face.length_m, spec.face.width_m);
    let surface_normal = Some(setup.world_from_face.rotation * Vector3::z());
    let made = ProcessSetup {
        surface_normal,
        ..ProcessSetup::new(Polish::new(setup), from.posture)
    };
    Ok(made
        .holding(Tooling::ball(spec.wheel.radius_m))
        .on(move || shapes::block(&process_from_face, length_m, width_m))
        .led_by(Motion::Planned(path)))
}

/// The process of a scenario on an arm at the first posture of its path.
fn polish(
    spec: &PolishSpec,
    effects: &WheelEffects,
    robot: &Robot,
    from: &Departure,
) -> Result<PolishSetup, SimError> {
    let face = Face::rectangle(spec.face.length_m, spec.face.width_m)
        .map_err(|error| SimError::scenario("process.polish.face", error.to_string()))?;
    let altered = altered(spec, effects);
    let mut setup = PolishSetup {
        world_from_face: spec.face.world_from_face(),
        process_from_world: from.process_from_world(),
        face,
        indentation_m: indentation_m(spec)?,
        duration_s: from.duration_s,
        expected_depth_m: expected_depth_m(spec)?,
        resting: Wrench::force(Attachment::Tool, Vector3::zeros()),
        jamming_share: effects.jamming_share,
        shell: Arc::new(altered.wheel.shell()),
        spec: altered,
    };
    setup.resting = resting(&setup, robot, from)?;
    Ok(setup)
}

/// Preston's law for lines at their spacing: `k_p F v / (v_f s)`, v the sliding in the middle of
/// the patch.
fn expected_depth_m(spec: &PolishSpec) -> Result<f64, SimError> {
    let depth_m = indentation_m(spec)?;
    let lever_m = (spec.wheel.radius_m - depth_m) * spec.tilt_rad.sin();
    let sliding_m_per_s = spec.spin_rad_s.abs() * lever_m;
    let spacing_m =
        (spec.face.width_m - 2.0 * spec.path.inset_m) / (spec.path.lines - 1).max(1) as f64;
    let line_n = spec.wheel.normal_force_n(depth_m) * sliding_m_per_s / spec.path.feed_m_per_s;
    Ok(spec.abrasive.preston_per_pa * line_n / spacing_m)
}

/// What runs where the scenario's effects act on what it says. A stiffer wheel presses more by all
/// three of its springs: air, shell and tread.
fn altered(spec: &PolishSpec, effects: &WheelEffects) -> PolishSpec {
    let (eccentricity_m, eccentricity_angle_rad) = eccentricity(spec, effects);
    PolishSpec {
        wheel: PneumaticWheel {
            pressure_pa: spec.wheel.pressure_pa * effects.stiffness_factor,
            youngs_modulus_pa: spec.wheel.youngs_modulus_pa * effects.stiffness_factor,
            ..spec.wheel
        },
        control: effects.on_control(spec.control),
        abrasive: effects.on_abrasive(spec.abrasive),
        eccentricity_m,
        eccentricity_angle_rad,
        ..spec.clone()
    }
}

/// Distance of the wheel's middle from the spin axis, and its angle at the start from the tool's x
/// axis towards its y axis.
fn eccentricity(spec: &PolishSpec, effects: &WheelEffects) -> (f64, f64) {
    let [x, y] = effects.eccentricity_m;
    if [x, y] == [0.0; 2] {
        return (spec.eccentricity_m, spec.eccentricity_angle_rad);
    }
    let (sine, cosine) = spec.eccentricity_angle_rad.sin_cos();
    let (x, y) = (
        x + spec.eccentricity_m * cosine,
        y + spec.eccentricity_m * sine,
    );
    (x.hypot(y), y.atan2(x))
}

/// The wrench on a tool at rest at the start, deflected by it, the wheel spinning.
fn resting(setup: &PolishSetup, robot: &Robot, from: &Departure) -> Result<Wrench, SimError> {
    let posture = &from.posture;
    let compliance = robot.cartesian_compliance(posture, FrameId::Tool, &Load::none())?;
    let process = Polish::new(setup.clone());
    let undeflected = robot.world_from_frame(posture, FrameId::Tool);
    let turn = from.world_from_process.rotation;
    let mut wrench = setup.resting;
    for _ in 0..ROUNDS {
        let (force_n, moment_n_m) = (turn * wrench.force_n, turn * wrench.moment_n_m);
        let load = stacked(&force_n, &moment_n_m);
        let deflection: Vector3<f64> = (compliance * load).fixed_rows::<3>(0).into();
        let state = ToolState {
            world_from_tool: Translation3::from(deflection) * undeflected,
            ..ToolState::default()
        };
        wrench = process.evaluate(&state).wrenches[0];
    }
    Ok(wrench)
}
