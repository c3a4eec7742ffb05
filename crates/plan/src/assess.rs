//! What a criterion says of a posture.

use nalgebra::{Matrix2, Matrix3};
use truecut_arm::{FrameId, Load, Robot, translational};
use truecut_core::chatter::averaged::mode_coupling_limit;
use truecut_core::chatter::limit::{FirstLimit, LimitSearch, first_limit};
use truecut_core::chatter::planar::coalescence_limit_m;
use truecut_core::chatter::spectral_elements::SpectralElements;
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
            let limit = mode_coupling_limit(&modes, &cut.directional().average_pa());
            limit.map_or(f64::INFINITY, |limit| limit.depth_m)
        }
        Criterion::Regenerative => {
            let modes = modes_in_cut(robot, posture, world_from_milling, &cut.attached)?;
            let (limit, growth_per_s) = regenerative(&modes, cut);
            decay = Some(Decay {
                growth_per_s,
                least_per_s: least_decay * slowest_decay_per_s(&modes),
            });
            error_m = limit.map(|limit| limit.error_m);
            limit.map_or(f64::INFINITY, |limit| limit.depth_m)
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

/// First depth that regeneration makes unstable, and the growth rate at the cut's own depth, 1/s;
/// both with the floor.
fn regenerative(modes: &[TipMode], cut: &Cut) -> (Option<FirstLimit>, f64) {
    let (depth_m, period_s) = (cut.nominal.axial_depth_m, cut.tooth_period_s());
    let elements = SpectralElements::new(modes, &cut.directional()).with_floor(&cut.nominal);
    let growth_per_s = elements
        .multiplier(period_s, depth_m)
        .growth_per_s(period_s);
    let search = LimitSearch {
        deepest_m: DEEPEST * depth_m,
        scan_steps: SCAN_STEPS,
        relative_width: NARROWED,
    };
    (first_limit(&elements, period_s, &search), growth_per_s)
}
