//! From the belt table and its solved lines to the process that runs.

use crate::effect::WheelEffects;
use crate::error::SimError;
use crate::motion::{self, BeltLines, Target};
use crate::process::setup::{Departure, Motion, StandingPart};
use crate::process::{Belt, BeltSetup, Cells, ProcessSetup, SetupContext, cells_within};
use crate::scene::{Tooling, shapes};
use std::sync::Arc;
use truecut_core::wheel::belt::BeltWheel;
use truecut_plan::surface::{Mesh, MeshUse, PatchFile, SurfaceError};
use truecut_scenario::{BeltJob, BeltSpec, ProcessSpec};

/// Most cells of all copies: their maps fit into memory and onto a screen.
const MOST_CELLS: usize = 4_000_000;

/// The process of a scenario along the lines of its job, and its workpiece.
pub(crate) fn setup(spec: &BeltSpec, context: &SetupContext<'_>) -> Result<ProcessSetup, SimError> {
    let robot = context.robot;
    let near = context.posture()?;
    // What the belt does to the face along its job's lines does not change them.
    let is_same = |other: &ProcessSpec| {
        matches!(other, ProcessSpec::Belt(other)
            if spec.job == other.job && spec.copies == other.copies && spec.cell_m == other.cell_m
                && spec.path == other.path)
    };
    let path = context.planned(&near, is_same, || motion::belt::solve(spec, robot, &near))?;
    let Target::Lines(lines) = &path.target else {
        return Err(SimError::scenario(
            "process.belt",
            "the lines are not solved",
        ));
    };
    let from = context.departure(&path);
    let setup = belt(spec, &context.effects.wheel, lines, &from)?;
    let process_from_patch = from.world_from_process.inverse() * setup.copies[0].world_from_patch;
    let border_m = outline(lines);
    let (job, patch) = (spec.job.clone(), lines.patch.clone());
    let tooling = Tooling::drum([setup.wheel.radius_m, setup.wheel.width_m]);
    Ok(ProcessSetup::new(Belt::new(setup), from.posture)
        .holding(tooling)
        .on(move || shapes::outline(&process_from_patch, &border_m))
        .working_on(move || part(&job, &patch))
        .led_by(Motion::Planned(path)))
}

/// The part of a job with all its copies: its body, else its face.
fn part(job: &BeltJob, patch: &PatchFile) -> Result<StandingPart, SimError> {
    let mesh = match &job.surface.body {
        Some(body) => Mesh::load(&body.file, body.unit_m, MeshUse::Body),
        None => Mesh::of_patch(patch.surface.as_ref()).map_err(SurfaceError::from),
    };
    let mesh = Arc::new(mesh.map_err(|error| {
        let file = job.file.display();
        SimError::scenario(
            "process.belt.job",
            format!("{file}: `surface.body`: {error}"),
        )
    })?);
    let at = job.surface.world_from_patch;
    let copies = (job.symmetry.iter()).flat_map(|symmetry| symmetry.places());
    let mut places: Vec<_> = copies.map(|copy| copy * at).collect();
    if places.is_empty() {
        places.push(at);
    }
    Ok(places
        .into_iter()
        .map(|place| (mesh.clone(), place))
        .collect())
}

/// The process along a solved path.
fn belt(
    spec: &BeltSpec,
    effects: &WheelEffects,
    path: &BeltLines,
    from: &Departure,
) -> Result<BeltSetup, SimError> {
    let cells = Cells::of(&path.patch, spec.cell_m);
    check_cells(spec, &cells)?;
    let area_m2 = cells.areas_m2(&path.patch);
    let is_face = cells_within(&cells, path.patch.clone());
    let of_face = area_m2.iter().zip(&is_face).filter(|(_, within)| **within);
    let face_m2: f64 = of_face.map(|(area, _)| area).sum();
    let copies = path.copies.clone();
    Ok(BeltSetup {
        // A stiffer wheel has stiffer rubber; the belt's tension is another matter.
        wheel: BeltWheel {
            contact_modulus_pa: spec.wheel.contact_modulus_pa * effects.stiffness_factor,
            ..spec.wheel
        },
        layer: Arc::new(spec.wheel.layer()),
        control: effects.on_control(spec.control),
        abrasive: effects.on_abrasive(spec.abrasive),
        eccentricity: effects.eccentricity(),
        belt_m_per_s: spec.belt_m_per_s,
        patch: path.patch.clone(),
        process_from_world: from.process_from_world(),
        swept: path.passes.swept,
        indentation_m: spec.job.wheel.indentation_m,
        first_normal: copies[0].world_from_patch.rotation * path.passes.first_normal.into_inner(),
        chord_m: path.passes.chord_m,
        expected_depth_m: expected_depth_m(spec, path, face_m2),
        area_m2: Arc::new(area_m2),
        is_face: Arc::new(is_face),
        cells,
        copies,
    })
}

/// The map must show a line beside the next: cells of half a wheel's width at most.
fn check_cells(spec: &BeltSpec, cells: &Cells) -> Result<(), SimError> {
    let most_m = 0.5 * spec.wheel.width_m;
    if spec.cell_m > most_m {
        return Err(SimError::scenario(
            "process.belt.cell_mm",
            format!(
                "`process.belt.cell_mm` is {}, but must be at most {}, half the wheel's width: larger cells \
                 show nothing of what is left between lines",
                spec.cell_m * 1e3,
                most_m * 1e3
            ),
        ));
    }
    let [columns, rows] = cells.count;
    let count = columns.saturating_mul(rows).saturating_mul(spec.copies);
    if count <= MOST_CELLS {
        return Ok(());
    }
    Err(SimError::scenario(
        "process.belt.cell_mm",
        format!(
            "`process.belt.cell_mm` is {}, which makes {columns} by {rows} cells on each of {} copies, but all have at most {MOST_CELLS}: \
             their maps fit into memory",
            spec.cell_m * 1e3,
            spec.copies
        ),
    ))
}

/// Preston's law for the job's line load over all passes, spread over the face:
/// `k_p v F t / A`.
fn expected_depth_m(spec: &BeltSpec, path: &BeltLines, face_m2: f64) -> f64 {
    let force_n = spec.job.wheel.line_load_n_per_m * spec.job.wheel.width_m;
    let time_s = path.passes.time_s;
    spec.abrasive.preston_per_pa * spec.belt_m_per_s.abs() * force_n * time_s / face_m2
}

/// The boundary of the face, or the border of its patch, closed, in the patch's frame.
fn outline(path: &BeltLines) -> Vec<[f64; 3]> {
    let surface = path.patch.surface.as_ref();
    if let Some(boundary) = &path.patch.boundary {
        let corners = boundary.corners_m();
        let closed = corners.iter().chain(corners.first());
        return closed.map(|corner| (*corner).into()).collect();
    }
    let domain = surface.domain();
    let side = 40;
    let mix = |range: [f64; 2], part: f64| range[0] + part * (range[1] - range[0]);
    (0..=4 * side)
        .map(|k| {
            let part = (k % side) as f64 / side as f64;
            let (u, v) = match k / side {
                0 => (part, 0.0),
                1 => (1.0, part),
                2 => (1.0 - part, 1.0),
                3 => (0.0, 1.0 - part),
                _ => (0.0, 0.0),
            };
            surface.point_m(mix(domain.u, u), mix(domain.v, v)).into()
        })
        .collect()
}
