//! What a criterion says of a posture.

use nalgebra::{Matrix2, Matrix3};
use truecut_arm::{FrameId, Load, Robot, translational};
use truecut_core::chatter::averaged::mode_coupling_limit;
use truecut_core::chatter::limit::{LimitSearch, first_depth_m, first_limit};
use truecut_core::chatter::planar::coalescence_limit_m;
use truecut_core::chatter::spectral_elements::{AtSpeed, SpectralElements};
use truecut_core::chatter::{AttachedModes, TipMode, in_axes};

use crate::assessment::{Assessment, Decay};
use crate::criterion::{Criterion, Cut};
use crate::error::PlanError;
use crate::section::free_anisotropy;

/// Depths up to this many times the cut's are looked at for a regenerative limit.
const DEEPEST: f64 = 3.0;
/// Steps of that scan, and the relative width to which a limit is narrowed.
const SCAN_STEPS: usize = 6;
const NARROWED: f64 = 4e-3;

/// Modes between tool and workpiece in the axes of the cut: those of the arm with its tool's,
/// slowest first, then the workpiece's; motors stand still, without gravity.
///
/// # Errors
/// If a joint has no stiffness, the arm is singular there, or the tool's modes weigh more than it.
pub fn modes_in_cut(
    robot: &Robot,
    posture: &[f64],
    world_from_milling: &Matrix3<f64>,
    attached: &AttachedModes,
) -> Result<Vec<TipMode>, PlanError> {
    let modes = robot.cutting_modes(posture, attached)?;
    Ok(in_axes(&modes, world_from_milling))
}

/// What a criterion says of a posture in a cut whose milling frame stands in the world as
/// `world_from_milling`. `least_decay` is asked by [`Criterion::Regenerative`] only: the least
/// decay at the cut's own depth, as a part of that of the arm's slowest decaying mode.
///
/// # Errors
/// If the arm has no compliance or modes there.
pub fn assess(
    criterion: Criterion,
    robot: &Robot,
    posture: &[f64],
    world_from_milling: &Matrix3<f64>,
    cut: &Cut,
    least_decay: f64,
) -> Result<Assessment, PlanError> {
    let frame = world_from_milling;
    assess_by(
        regenerative,
        criterion,
        (robot, posture, frame),
        cut,
        least_decay,
    )
}

/// The same without an error of the limit, which takes more than the limit.
pub(crate) fn assess_without_error(
    criterion: Criterion,
    place: (&Robot, &[f64], &Matrix3<f64>),
    cut: &Cut,
    least_decay: f64,
) -> Result<Assessment, PlanError> {
    assess_by(regenerative_alone, criterion, place, cut, least_decay)
}

/// What regeneration says of modes in a cut.
struct Regenerative {
    /// First depth that it makes unstable, infinite if none is, and by how much the discretisation
    /// in time puts it wrong, m.
    limit_m: f64,
    error_m: Option<f64>,
    /// Growth rate at the cut's own depth, 1/s.
    growth_per_s: f64,
}

fn assess_by(
    regenerative: fn(&[TipMode], &Cut) -> Regenerative,
    criterion: Criterion,
    (robot, posture, world_from_milling): (&Robot, &[f64], &Matrix3<f64>),
    cut: &Cut,
    least_decay: f64,
) -> Result<Assessment, PlanError> {
    let (mut decay, mut error_m) = (None, None);
    let value = match criterion {
        Criterion::Anisotropy => {
            let compliance = tool_compliance(robot, posture, &cut.attached)?;
            free_anisotropy(&compliance, world_from_milling)
        }
        Criterion::Flutter => {
            let compliance = tool_compliance(robot, posture, &cut.attached)?;
            planar_limit_m(&compliance, world_from_milling, cut)
        }
        Criterion::ModeCoupling => {
            let modes = modes_in_cut(robot, posture, world_from_milling, &cut.attached)?;
            let limit = mode_coupling_limit(&modes, cut.averaged());
            limit.map_or(f64::INFINITY, |limit| limit.depth_m)
        }
        Criterion::Regenerative => {
            let modes = modes_in_cut(robot, posture, world_from_milling, &cut.attached)?;
            let found = regenerative(&modes, cut);
            decay = Some(Decay {
                growth_per_s: found.growth_per_s,
                least_per_s: least_decay * slowest_decay_per_s(&modes),
            });
            error_m = found.error_m;
            found.limit_m
        }
    };
    Ok(Assessment {
        value,
        margin: value / criterion.needed(cut) - 1.0,
        decay,
        error_m,
    })
}

/// How fast the mode that rings longest dies away when nothing is cut, ζω, 1/s.
fn slowest_decay_per_s(modes: &[TipMode]) -> f64 {
    let own = modes
        .iter()
        .map(|m| m.damping_ratio * m.natural_frequency_rad_s);
    own.fold(f64::INFINITY, f64::min)
}

/// Translational compliance between tool and workpiece, world axes, rotation free, m/N.
fn tool_compliance(
    robot: &Robot,
    posture: &[f64],
    attached: &AttachedModes,
) -> Result<Matrix3<f64>, PlanError> {
    let compliance = robot.cartesian_compliance(posture, FrameId::Tool, &Load::none())?;
    let axes = robot.tool_axes(posture);
    Ok(translational(&compliance) + attached.compliance_m_per_n(&axes))
}

/// Undamped limit of the cutting plane alone, m; infinite if no depth makes its two frequencies
/// meet.
fn planar_limit_m(
    compliance_m_per_n: &Matrix3<f64>,
    world_from_milling: &Matrix3<f64>,
    cut: &Cut,
) -> f64 {
    let turned = world_from_milling.transpose() * compliance_m_per_n * world_from_milling;
    let block = |m: &Matrix3<f64>| -> Matrix2<f64> { m.fixed_view::<2, 2>(0, 0).into_owned() };
    let average = block(&cut.directional().average_pa());
    let stiffness = block(&turned).try_inverse();
    let limit = stiffness.and_then(|k| coalescence_limit_m(&k, &average));
    limit.unwrap_or(f64::INFINITY)
}

/// Regeneration with the floor.
fn regenerative(modes: &[TipMode], cut: &Cut) -> Regenerative {
    let (period_s, elements) = (cut.tooth_period_s(), with_floor(modes, cut));
    let search = LimitSearch {
        deepest_m: DEEPEST * cut.nominal.axial_depth_m,
        scan_steps: SCAN_STEPS,
        relative_width: NARROWED,
    };
    let limit = first_limit(&elements, period_s, &search);
    Regenerative {
        limit_m: limit.map_or(f64::INFINITY, |limit| limit.depth_m),
        error_m: limit.map(|limit| limit.error_m),
        growth_per_s: growth_per_s(&elements.at(period_s), cut),
    }
}

/// The same without the limit's error.
fn regenerative_alone(modes: &[TipMode], cut: &Cut) -> Regenerative {
    let elements = with_floor(modes, cut);
    let at = elements.at(cut.tooth_period_s());
    let step_m = DEEPEST * cut.nominal.axial_depth_m / SCAN_STEPS as f64;
    let depths_m = (1..=SCAN_STEPS).map(|i| step_m * i as f64);
    Regenerative {
        limit_m: first_depth_m(&at, depths_m, NARROWED).unwrap_or(f64::INFINITY),
        error_m: None,
        growth_per_s: growth_per_s(&at, cut),
    }
}

fn with_floor(modes: &[TipMode], cut: &Cut) -> SpectralElements {
    SpectralElements::new(modes, &cut.directional()).with_floor(&cut.nominal)
}

fn growth_per_s(at: &AtSpeed<'_>, cut: &Cut) -> f64 {
    let multiplier = at.multiplier(cut.nominal.axial_depth_m);
    multiplier.growth_per_s(at.tooth_period_s())
}
