//! `truecut lobes`: the stability diagram of a milling scenario, with simulated runs.

mod figure;
mod files;
mod json;
mod text;

use std::f64::consts::TAU;
use std::path::PathBuf;

use truecut_core::chatter::averaged::zero_order_limit;
use truecut_plan::lobes::{LobeRequest, Lobes};
use truecut_scenario::Scenario;
use truecut_sim::stability::{MillingStudy, StabilityRun, damping_notes, stability_runs};

use crate::exit_status::ExitStatus;
use crate::failure::Failure;
use crate::progress::Progress;

/// `lobes`, resolved.
pub struct LobesPlan {
    pub scenario: Scenario,
    pub rpm: Option<[f64; 2]>,
    pub deepest_m: Option<f64>,
    /// Numbers of speeds and of depths.
    pub size: usize,
    pub runs: usize,
    /// Position of the tool along the path.
    pub at_m: f64,
    pub out: PathBuf,
}

/// The diagram of a scenario.
struct Diagram<'a> {
    scenario: &'a Scenario,
    study: MillingStudy,
    posture: Vec<f64>,
    lobes: Lobes,
    runs: Vec<StabilityRun>,
    /// Fastest speed up to which limits are known, rad/s, and what is missing beyond it.
    known: Option<(f64, String)>,
    /// The diagram with the arm's other damping, and what that is.
    other: Option<(String, Lobes)>,
    /// Sentences on the damping.
    notes: Vec<String>,
}

/// Default range of speeds, as fractions of the scenario's.
const RANGE: [f64; 2] = [0.1, 1.25];
/// Default largest depth, as a multiple of the limit at the scenario's speed, and of its depth.
const BEYOND_LIMIT: f64 = 1.2;
const BEYOND_DEPTH: f64 = 3.0;

/// Computes the diagram, simulates the runs, prints and writes.
pub fn lobes(plan: &LobesPlan) -> Result<ExitStatus, Failure> {
    let scenario = &plan.scenario;
    let failed = |error| Failure::sim(scenario, error);
    let study = MillingStudy::of(scenario).map_err(failed)?;
    let posture = posture_at(plan, &study)?;
    let modes = study.modes(&posture).map_err(failed)?;
    let known = study.known_to_rad_s(&modes);
    let request = request(plan, &study, &modes, known);
    let mut lobes = Progress::of_one("stability diagram", |progress| {
        truecut_plan::lobes::lobes(&modes, &study.cut, &request, progress)
    });
    if let Some(known_to_rad_s) = known {
        lobes = lobes.known_to(known_to_rad_s);
    }
    let other = study.other_damping(&posture).map_err(failed)?.map(|other| {
        let mut found = Progress::of_one("the other damping", |progress| {
            truecut_plan::lobes::lobes(&other.modes, &study.cut, &request, progress)
        });
        if let Some(known_to_rad_s) = known {
            found = found.known_to(known_to_rad_s);
        }
        (other.name, found)
    });
    let beyond = known.filter(|known| request.spindle_rad_s[1] > *known);
    let runs = Progress::of_one("runs", |progress| {
        stability_runs(scenario, &study, &lobes, plan.runs, progress)
    })?;
    let diagram = Diagram {
        scenario,
        other,
        notes: damping_notes(&modes),
        known: beyond.map(|known| (known, study.beyond_modes(&modes, known))),
        study,
        posture,
        lobes,
        runs,
    };
    let written = files::write(&diagram, &plan.out)?;
    crate::print(&text::printed(&diagram, &written))
}

/// The posture at the requested position.
fn posture_at(plan: &LobesPlan, study: &MillingStudy) -> Result<Vec<f64>, Failure> {
    let length_m = study.path.length_m();
    if plan.at_m > length_m {
        return Err(Failure::message(format!(
            "--at is {} mm, but must be at most the path's length of {} mm",
            plan.at_m * 1e3,
            length_m * 1e3
        )));
    }
    let path = (study.postures()).map_err(|error| Failure::sim(&plan.scenario, error))?;
    Ok(path.posture(plan.at_m))
}

fn request(
    plan: &LobesPlan,
    study: &MillingStudy,
    modes: &[truecut_core::chatter::TipMode],
    known_to_rad_s: Option<f64>,
) -> LobeRequest {
    let cut = &study.cut;
    let speed = cut.spindle_rad_s;
    let deepest = || {
        let average = cut.directional().average_pa();
        // Where limits are not known, that of the fastest speed at which they are.
        let at = known_to_rad_s.map_or(speed, |known| known.min(speed));
        let period_s = cut.nominal.cutter.tooth_period_s(at);
        let limit = zero_order_limit(modes, &average, period_s);
        let beyond = limit.map_or(0.0, |limit| BEYOND_LIMIT * limit.depth_m);
        beyond.max(BEYOND_DEPTH * cut.nominal.axial_depth_m)
    };
    LobeRequest {
        spindle_rad_s: plan.rpm.map_or(RANGE.map(|part| part * speed), |range| {
            range.map(|rpm| rpm * TAU / 60.0)
        }),
        deepest_m: plan.deepest_m.unwrap_or_else(deepest),
        speeds: plan.size,
        depths: plan.size,
    }
}

fn rpm(rad_s: f64) -> f64 {
    rad_s * 60.0 / TAU
}
