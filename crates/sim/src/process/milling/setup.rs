//! From the milling table to the process that runs.

use crate::error::SimError;
use crate::loads::stacked;
use crate::motion::straight;
use crate::process::setup::Motion;
use crate::process::{Milling, MillingSetup, ProcessSetup, SetupContext, soft_note};
use crate::scene::{Tooling, shapes};
use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};
use std::f64::consts::{PI, TAU};
use truecut_arm::{FrameId, Load, Robot};
use truecut_core::chatter::averaged::{Crossing, mode_coupling_limit, zero_order_limit};
use truecut_core::chatter::limit::{LimitSearch, first_limit};
use truecut_core::chatter::spectral_elements::{MOST_MODES, SpectralElements};
use truecut_core::chatter::{DirectionalMatrix, TipMode, in_axes};
use truecut_core::cutting::milling::cut::MillingParameters;
use truecut_core::cutting::milling::dexel::Wall;
use truecut_core::cutting::milling::engagement::{Engagement, Stock};
use truecut_core::cutting::milling::nominal::NominalCut;
use truecut_scenario::MillingSpec;

/// Edges with a helix are cut into slices that lag by no more than this, rad.
const SLICE_LAG_RAD: f64 = 0.02;
/// Revolutions that the surface is remembered for: a tooth that misses its cut for longer finds the
/// oldest.
const REMEMBERED_REVOLUTIONS: usize = 2;
/// Most periods of the fastest mode between two teeth: limits need steps in each of them.
const MOST_CYCLES: f64 = 2000.0;
/// Largest cosine between feed and tool axis.
const LARGEST_COSINE: f64 = 1e-6;

/// What the theories are asked for: the nominal cut, by the modes of the arm at its start.
#[derive(Debug, Clone, PartialEq)]
pub struct TheoryInputs {
    modes: Vec<TipMode>,
    cut: NominalCut,
    tooth_period_s: f64,
}

/// What the averaged theories predict at the posture of the start; published beside the result.
/// Depths in m, infinite if no depth is unstable; frequencies in Hz.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MillingTheory {
    /// Teeth that meet the nominal surface.
    pub coupling_depth_m: f64,
    pub coupling_hz: f64,
    /// Teeth that meet their own surface, to zero order.
    pub regenerative_depth_m: f64,
    pub regenerative_hz: f64,
    /// First limit by spectral elements, the first up to twice that to zero order.
    pub stability_depth_m: f64,
    pub stability_hz: f64,
    /// Its estimated error by discretisation in time.
    pub stability_error_m: f64,
}

/// The process of a scenario along its path, and its workpiece.
pub(crate) fn setup(
    spec: &MillingSpec,
    context: &SetupContext<'_>,
) -> Result<ProcessSetup, SimError> {
    let robot = context.robot;
    let path = straight::solve(&spec.path, robot, &context.posture()?)?;
    let posture = path.knots[0].clone();
    let world_from_process = robot.world_from_process(&posture);
    let actual = context.effects.milling.on(spec);
    let setup = milling([spec, &actual], robot, &posture, &world_from_process)?;
    let cut = spec.cut;
    let radius_m = cut.cutter.radius_m;
    let stock = cut.engagement.stock(&cut.cutter, cut.axial_depth_m);
    let milled = shapes::Milled {
        length_m: spec.path.length_m,
        cutter_radius_m: radius_m,
        across_m: [stock.y_min_m, stock.y_max_m].map(|y| y.clamp(-radius_m, radius_m)),
        depth_m: cut.axial_depth_m,
    };
    let turn = UnitQuaternion::from_rotation_matrix(&setup.process_from_milling);
    let process_from_milling = Isometry3::from_parts(Translation3::identity(), turn);
    Ok(ProcessSetup::new(Milling::new(setup), posture)
        .holding(Tooling::end_mill(
            radius_m,
            cut.axial_depth_m.max(2.0 * radius_m) + 2.0 * radius_m,
        ))
        .on(move || milled.shapes(&process_from_milling))
        .led_by(Motion::Straight(path, spec.feed_m_per_s)))
}

/// The pass of a scenario, nominal and as effects make it, by an arm at the first posture of its
/// path.
fn milling(
    [nominal, spec]: [&MillingSpec; 2],
    robot: &Robot,
    posture: &[f64],
    world_from_process: &Isometry3<f64>,
) -> Result<MillingSetup, SimError> {
    let process_from_milling = process_from_milling(spec, world_from_process)?;
    let cut = &spec.cut;
    cut.cutter
        .check()
        .map_err(|error| SimError::scenario("process.milling.cutter", error.to_string()))?;
    let world_from_milling =
        world_from_process.rotation.to_rotation_matrix() * process_from_milling;
    let mean_load = (cut.average_force_n(), cut.average_moment_n_m());
    let compliance = robot.cartesian_compliance(posture, FrameId::Tool, &Load::none())?;
    let (force_n, moment_n_m) = (
        world_from_milling * mean_load.0,
        world_from_milling * mean_load.1,
    );
    let wrench = stacked(&force_n, &moment_n_m);
    let deflection: Vector3<f64> = (compliance * wrench).fixed_rows::<3>(0).into();
    let tool_axes = robot.tool_axes(posture);
    let of_modes = spec.attached.compliance_m_per_n(&tool_axes) * force_n;
    let deflection = world_from_milling.inverse() * (deflection + of_modes);
    // A tool that sinks by z under the force F cuts deeper: F (b - z)/b, of which z is the
    // deflection.
    let deeper = 1.0 / (1.0 + deflection.z / cut.axial_depth_m).max(0.1);
    let modes_of = |spec: &MillingSpec| -> Result<Vec<TipMode>, SimError> {
        let modes = robot.cutting_modes(posture, &spec.attached)?;
        Ok(in_axes(&modes, world_from_milling.matrix()))
    };
    let modes = modes_of(spec)?;
    check_cycles(&modes, spec)?;
    let arm = robot.linearised(posture, FrameId::Tool, &Load::none())?;
    let tool: Vec<_> = (spec.attached.tool.iter())
        .map(|mode| mode.turned(&tool_axes))
        .collect();
    Ok(MillingSetup {
        parameters: parameters(spec),
        process_from_milling,
        nominal_force_n: mean_load.0,
        mean_load: (mean_load.0 * deeper, mean_load.1 * deeper),
        mean_deflection_m: deflection * deeper,
        finished_walls: finished_walls(&cut.engagement),
        theory: TheoryInputs {
            modes: modes_of(nominal)?,
            cut: nominal.cut,
            tooth_period_s: nominal.tooth_period_s(),
        },
        mode_share: arm.largest_share(&tool),
        fastest_mode_hz: modes
            .iter()
            .map(|mode| mode.natural_frequency_rad_s / TAU)
            .fold(0.0, f64::max),
        milling_from_world: *world_from_milling.inverse().matrix(),
        milling_from_tool: world_from_milling.inverse().matrix() * tool_axes,
        spec: spec.clone(),
    })
}

/// Refuses teeth that pass too seldom for the modes.
fn check_cycles(modes: &[TipMode], spec: &MillingSpec) -> Result<(), SimError> {
    let rates = modes.iter().map(|mode| mode.natural_frequency_rad_s / TAU);
    let fastest_hz = rates.fold(0.0, f64::max);
    let cycles = fastest_hz * spec.tooth_period_s();
    if cycles <= MOST_CYCLES {
        return Ok(());
    }
    let rpm = spec.spindle_rad_s * 60.0 / TAU;
    Err(SimError::scenario(
        "process.milling.spindle_rpm",
        format!(
            "`process.milling.spindle_rpm` is {rpm}, but must be at least {}: between two teeth there are {cycles:.0} periods of the \
             fastest mode, at {fastest_hz:.1} Hz, and limits are found for {MOST_CYCLES} at most",
            truecut_recording::significant(rpm * cycles / MOST_CYCLES, 4)
        ),
    ))
}

/// Axes of the milling frame in the process frame: x the feed, z against process X.
fn process_from_milling(
    spec: &MillingSpec,
    world_from_process: &Isometry3<f64>,
) -> Result<Rotation3<f64>, SimError> {
    let feed = world_from_process.rotation.inverse() * Vector3::from(spec.path.direction);
    if feed.x.abs() > LARGEST_COSINE {
        return Err(SimError::scenario(
            "process.milling.path.direction",
            format!(
                "the path leads {:.4} degrees out of the plane across the tool axis at the robot's posture, but must lie in it: \
                 an end mill is fed sideways",
                feed.x.asin().to_degrees().abs()
            ),
        ));
    }
    let x = Vector3::new(0.0, feed.y, feed.z).normalize();
    let z = -Vector3::x();
    let axes = Matrix3::from_columns(&[x, z.cross(&x), z]);
    Ok(Rotation3::from_matrix_unchecked(axes))
}

/// Walls that the teeth finish, the one of down-milling first.
fn finished_walls(engagement: &Engagement) -> Vec<Wall> {
    let mut walls = Vec::new();
    if (engagement.exit_rad - PI).abs() < 1e-9 {
        walls.push(Wall::Exit);
    }
    if engagement.entry_rad.abs() < 1e-9 {
        walls.push(Wall::Entry);
    }
    walls
}

fn parameters(spec: &MillingSpec) -> MillingParameters {
    let cut = &spec.cut;
    let mut parameters = MillingParameters {
        cutter: cut.cutter,
        coefficients: cut.coefficients,
        stock: cut.engagement.stock(&cut.cutter, cut.axial_depth_m),
        feed_per_tooth_m: cut.feed_per_tooth_m,
        regeneration: spec.regeneration,
        steady_displacement_m: Vector3::zeros(),
        passes: REMEMBERED_REVOLUTIONS * cut.cutter.teeth,
        slice_lag_rad: SLICE_LAG_RAD,
    };
    if let Some(lead_m) = spec.lead_in_m {
        // The cut counts from rotation 0.
        let origin_m = parameters.nominal_x_m(spec.start_angle_rad);
        parameters.stock = Stock {
            x_min_m: origin_m + lead_m + cut.cutter.radius_m,
            ..parameters.stock
        };
    }
    parameters
}

/// What a reader should know of a cut.
pub(crate) fn notes(cut: &NominalCut) -> Vec<String> {
    let (helix_rad, k) = (cut.cutter.helix_angle_rad, &cut.coefficients);
    let mut notes: Vec<String> = soft_note(k).into_iter().collect();
    if helix_rad != 0.0 && k.axial_pa == 0.0 && k.edge_axial_n_per_m == 0.0 {
        notes.push(format!(
            "the edges have a helix of {} degrees, but the coefficients have no axial part (axial_mpa): \
             forces along the spindle are left out",
            helix_rad.to_degrees()
        ));
    }
    notes
}

impl TheoryInputs {
    /// Limits with the modes of arm, tool and workpiece, gravity aside. They take as long as many
    /// revolutions of a run.
    pub fn limits(&self) -> MillingTheory {
        let (modes, tooth_period_s) = (&self.modes, self.tooth_period_s);
        let matrix = DirectionalMatrix::from(&self.cut);
        let average = matrix.averaged(tooth_period_s);
        let coupling = mode_coupling_limit(modes, average);
        let regenerative = zero_order_limit(modes, average, tooth_period_s);
        let depth = |c: Option<Crossing>| c.map_or(f64::INFINITY, |c| c.depth_m);
        let hz = |c: Option<Crossing>| c.map_or(f64::NAN, |c| c.frequency_hz);
        let elements = (modes.len() <= MOST_MODES).then(|| SpectralElements::new(modes, &matrix));
        let limit = regenerative.zip(elements.as_ref());
        let limit = limit.and_then(|(zero_order, elements)| {
            let search = LimitSearch::to_depth(2.0 * zero_order.depth_m);
            let limit = first_limit(elements, tooth_period_s, &search)?;
            Some((limit, elements.at(tooth_period_s).chatter_hz(limit.depth_m)))
        });
        MillingTheory {
            stability_depth_m: limit.map_or(f64::INFINITY, |(limit, _)| limit.depth_m),
            stability_hz: limit.map_or(f64::NAN, |(_, hz)| hz),
            stability_error_m: limit.map_or(f64::NAN, |(limit, _)| limit.error_m),
            coupling_depth_m: depth(coupling),
            coupling_hz: hz(coupling),
            regenerative_depth_m: depth(regenerative),
            regenerative_hz: hz(regenerative),
        }
    }
}
