//! `truecut lobes`: the stability diagram of a milling scenario, with simulated runs.

mod along;
mod figure;
mod files;
mod json;
mod text;
mod uncertain;

pub use along::{margin, shade};

use std::f64::consts::TAU;

use truecut_arm::{JointKind, Robot};
use truecut_core::chatter::TipMode;
use truecut_plan::lobes::{LobeRequest, Lobes};
use truecut_scenario::{ProcessSpec, Scenario};
use truecut_sim::stability::{MillingStudy, StabilityRun, in_scenario, stability_runs};

use crate::args::LobesArguments;
use crate::exit_status::ExitStatus;
use crate::failure::Failure;
use crate::progress::Progress;

/// The diagram of a scenario.
struct Diagram<'a> {
    scenario: &'a Scenario,
    study: MillingStudy,
    posture: Vec<f64>,
    lobes: Lobes,
    /// At the scenario's own speed, which need not be one of the diagram's.
    own: Lobes,
    runs: Vec<StabilityRun>,
    /// Fastest speed up to which limits are known, rad/s, and what is missing beyond it.
    known: Option<(f64, String)>,
    other: Option<Other>,
    uncertain: Option<uncertain::Uncertain>,
    /// Sentences on the damping.
    notes: Vec<String>,
}

impl Diagram<'_> {
    /// The posture's joints of one kind, in chain order, rad or m.
    fn joints(&self, kind: JointKind) -> Vec<f64> {
        let joints = self.study.robot.chain.joints.iter().zip(&self.posture);
        let joints = joints.filter(|(joint, _)| joint.kind == kind);
        joints.map(|(_, value)| *value).collect()
    }
}

/// The diagram with the arm's other damping.
struct Other {
    /// What that is.
    name: String,
    lobes: Lobes,
    /// At the scenario's own speed.
    own: Lobes,
}

/// Fewest depths that are tried at the scenario's own speed.
const OWN_DEPTHS: usize = 100;

/// Computes the diagram, simulates the runs, prints and writes.
pub fn lobes(arguments: &LobesArguments) -> Result<ExitStatus, Failure> {
    let scenario = &arguments.common.load(&arguments.scenario)?;
    if let ProcessSpec::PathMilling(_) = &scenario.process {
        return along::lobes(arguments, scenario);
    }
    let failed = |error| Failure::sim(scenario, error);
    let study = MillingStudy::of(scenario).map_err(failed)?;
    let posture = posture_at(scenario, arguments.at, &study)?;
    let modes = study.modes(&posture).map_err(failed)?;
    let known = study.known_to_rad_s(&modes);
    let range = arguments.rpm.map(|range| range.map(|rpm| rpm * TAU / 60.0));
    let deepest_m = arguments.deepest.map(|mm| mm * 1e-3);
    let request = study.request(range, deepest_m, arguments.size.into(), &modes);
    check_known(arguments, &study, &modes, known, &request)?;
    let own_request = LobeRequest {
        spindle_rad_s: [study.cut.spindle_rad_s; 2],
        speeds: 1,
        depths: request.depths.max(OWN_DEPTHS),
        ..request
    };
    let computed = |what: &str, robot: &Robot, request: &LobeRequest| {
        let modes = |speed: f64| study.modes_of(robot, &posture, speed);
        let lobes = Progress::of_one(what, |progress| {
            truecut_plan::lobes::lobes(&modes, &study.cut, request, progress)
        });
        let lobes = lobes.map_err(|error| failed(in_scenario(error)))?;
        Ok::<_, Failure>(lobes.known_to(known.unwrap_or(f64::INFINITY)))
    };
    let lobes = computed("stability diagram", &study.robot, &request)?;
    let own = computed("limits at the own speed", &study.robot, &own_request)?;
    let other = match study.other_damping(&posture).map_err(failed)? {
        Some(other) => Some(Other {
            lobes: computed("the other damping", &other.robot, &request)?,
            own: computed("the other damping", &other.robot, &own_request)?,
            name: other.name,
        }),
        None => None,
    };
    let uncertain = uncertain::uncertain(scenario, &study, &posture, &lobes, known)?;
    let beyond = known.filter(|known| request.spindle_rad_s[1] > *known);
    let runs = Progress::of_one("runs", |progress| {
        stability_runs(scenario, &study, &lobes, arguments.runs.into(), progress)
    })?;
    let diagram = Diagram {
        scenario,
        other,
        uncertain,
        notes: (study.notes(&modes).into_iter())
            .chain(study.beyond_table(request.spindle_rad_s[1]))
            .collect(),
        known: beyond.map(|known| (known, study.beyond_modes(&modes, known))),
        study,
        posture,
        lobes,
        own,
        runs,
    };
    let written = files::write(&diagram, &arguments.out)?;
    crate::print(&text::printed(&diagram, &written))
}

/// The posture at the requested position.
fn posture_at(
    scenario: &Scenario,
    at_mm: Option<f64>,
    study: &MillingStudy,
) -> Result<Vec<f64>, Failure> {
    let (at_m, length_m) = (at_mm.unwrap_or(0.0) * 1e-3, study.path.length_m());
    if at_m > length_m {
        return Err(Failure::message(format!(
            "--at is {} mm, but must be at most the path's length of {} mm",
            at_m * 1e3,
            length_m * 1e3
        )));
    }
    let path = (study.postures()).map_err(|error| Failure::sim(scenario, error))?;
    Ok(path.posture(at_m))
}

/// A range that was asked for must begin where limits are known.
fn check_known(
    arguments: &LobesArguments,
    study: &MillingStudy,
    modes: &[TipMode],
    known_to_rad_s: Option<f64>,
    request: &LobeRequest,
) -> Result<(), Failure> {
    let begin_rad_s = request.spindle_rad_s[0];
    match known_to_rad_s {
        Some(known) if begin_rad_s > known && arguments.rpm.is_some() => {
            let text = format!(
                "--rpm begins at {:.0} rpm, where no limit is known: {}",
                rpm(begin_rad_s),
                study.beyond_modes(modes, known)
            );
            Err(Failure::at(&arguments.scenario, text))
        }
        _ => Ok(()),
    }
}

fn rpm(rad_s: f64) -> f64 {
    rad_s * 60.0 / TAU
}
