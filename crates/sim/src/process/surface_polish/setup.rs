//! From the table and its solved way to the process that runs.

use super::{SurfacePolish, SurfacePolishSetup};
use crate::effect::WheelEffects;
use crate::error::SimError;
use crate::motion::{self, PolishedFace, Target};
use crate::process::setup::{Departure, Motion};
use crate::process::{Cells, ProcessSetup, SetupContext, cells_within};
use crate::scene::{Tooling, shapes};
use std::sync::Arc;
use truecut_core::wheel::pneumatic::PneumaticWheel;
use truecut_plan::polish_path::FaceBorders;
use truecut_scenario::{ProcessSpec, SurfacePolishSpec};

/// Most cells: their map fits into memory and onto a screen.
const MOST_CELLS: usize = 4_000_000;

/// The process of a scenario along its way, and its workpiece.
pub(crate) fn setup(
    spec: &SurfacePolishSpec,
    context: &SetupContext<'_>,
) -> Result<ProcessSetup, SimError> {
    let robot = context.robot;
    let is_same = |other: &ProcessSpec| *other == context.scenario.process;
    let start = context.start_near()?;
    let solve = || motion::surface_polish::solve(spec, robot, &start);
    let path = context.planned(&start.key(), is_same, solve)?;
    let Target::Polished(face) = &path.target else {
        return Err(SimError::scenario(
            "process.surface_polish",
            "the motion is not solved",
        ));
    };
    let from = context.departure(&path);
    let setup = polish(spec, &context.effects.wheel, face, &from)?;
    let world_from_patch = spec.surface.world_from_patch;
    let process_from_body = from.world_from_process.inverse() * world_from_patch;
    let (drawn, part) = (face.body.clone(), face.body.clone());
    Ok(ProcessSetup::new(SurfacePolish::new(setup), from.posture)
        .holding(Tooling::ball(spec.wheel.radius_m))
        .on(move || shapes::body(&process_from_body, &drawn))
        .working_on(move || Ok(vec![(part.clone(), world_from_patch)]))
        .led_by(Motion::Planned(path)))
}

/// The process along a solved way.
fn polish(
    spec: &SurfacePolishSpec,
    effects: &WheelEffects,
    face: &PolishedFace,
    from: &Departure,
) -> Result<SurfacePolishSetup, SimError> {
    let cells = Cells::of(&face.patch, spec.cell_m);
    check_cells(spec, &cells)?;
    // A stiffer wheel presses more by all three of its springs: air, shell and tread.
    let wheel = PneumaticWheel {
        pressure_pa: spec.wheel.pressure_pa * effects.stiffness_factor,
        youngs_modulus_pa: spec.wheel.youngs_modulus_pa * effects.stiffness_factor,
        ..spec.wheel
    };
    let is_face = cells_within(&cells, face.patch.clone());
    let borders = FaceBorders::of(&face.patch)
        .map_err(|fault| SimError::scenario("process.surface_polish.surface", fault.to_string()))?;
    let is_inner = |cell: usize| {
        let [u, v] = cells.middle(cell);
        is_face[cell] && borders.hold(&face.patch.surface.jet(u, v), 2.0 * spec.laying.inset_m)
    };
    Ok(SurfacePolishSetup {
        shell: Arc::new(wheel.shell()),
        wheel,
        spin_rad_s: spec.spin_rad_s,
        eccentricity_m: effects.eccentricity_m,
        abrasive: effects.on_abrasive(spec.abrasive),
        control: effects.on_control(spec.control),
        patch: face.patch.clone(),
        world_from_patch: spec.surface.world_from_patch,
        process_from_world: from.process_from_world(),
        area_m2: Arc::new(cells.areas_m2(&face.patch)),
        is_inner: Arc::new((0..is_face.len()).map(is_inner).collect()),
        is_face: Arc::new(is_face),
        cells,
        indentation_m: spec.laying.indentation_m,
        first_normal: spec.surface.world_from_patch.rotation * face.first_normal,
        expected_depth_m: expected_depth_m(spec),
    })
}

/// The map must show a line beside the next: cells of half the lines' distance at most.
fn check_cells(spec: &SurfacePolishSpec, cells: &Cells) -> Result<(), SimError> {
    let key = "process.surface_polish.cell_mm";
    let given_mm = spec.cell_m * 1e3;
    let spacing_mm = spec.laying.spacing_m * 1e3;
    if given_mm > 0.5 * spacing_mm {
        return Err(SimError::scenario(
            key,
            format!(
                "`{key}` is {given_mm}, but must be at most {}, half of line_spacing_mm: larger cells show nothing of what is left between \
                 lines",
                0.5 * spacing_mm
            ),
        ));
    }
    let [columns, rows] = cells.count;
    if columns.saturating_mul(rows) <= MOST_CELLS {
        return Ok(());
    }
    Err(SimError::scenario(
        key,
        format!(
            "`{key}` is {given_mm}, which makes {columns} by {rows} cells, but a face has at most {MOST_CELLS}: their map fits into memory"
        ),
    ))
}

/// Preston's law for lines at their spacing on a plane: `k_p F v / (v_f s)`, v the sliding in the
/// middle of the patch.
fn expected_depth_m(spec: &SurfacePolishSpec) -> f64 {
    let laying = &spec.laying;
    let lever_m = (laying.radius_m - laying.indentation_m) * laying.tilt_rad.sin();
    let force_n =
        (spec.control.force_n()).unwrap_or_else(|| spec.wheel.normal_force_n(laying.indentation_m));
    let rubbed_w = force_n * spec.spin_rad_s.abs() * lever_m;
    spec.abrasive.preston_per_pa * rubbed_w / (laying.feed_m_per_s * laying.spacing_m)
}
