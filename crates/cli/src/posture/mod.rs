//! `truecut posture`: chooses postures along the path of a milling scenario, straight or from CAM.

mod along;
mod figure;
mod files;
mod maps;
mod text;
mod uncertain;

use std::time::Instant;

use truecut_plan::{
    Assessment, Criterion, MarginMap, Plan, PlanError, Planner, PlannerOptions, modes_in_cut,
};
use truecut_scenario::{ProcessSpec, Scenario};
use truecut_sim::stability::{Draws, MillingStudy, in_scenario};

use crate::args::PostureArguments;
use crate::exit_status::ExitStatus;
use crate::failure::Failure;
use crate::progress::Progress;

/// The plan, and its assessment by each criterion.
struct PostureAnswer<'a> {
    scenario: &'a Scenario,
    study: &'a MillingStudy,
    plan: Plan,
    /// By criterion, in the order of [`Criterion::ALL`].
    maps: Vec<MarginMap>,
    plan_assessed: Vec<Vec<Assessment>>,
    /// The scenario's own postures; none where the arm cannot follow its path.
    own: Option<Own>,
    uncertain: Option<uncertain::Uncertain>,
    /// What is missing where the cut is faster than the modes that are given.
    missing: Option<String>,
}

/// The path in the scenario's own postures.
struct Own {
    plan: Plan,
    assessed: Vec<Vec<Assessment>>,
}

/// Columns of the maps over the path.
const MAP_COLUMNS: usize = 17;

/// Plans, prints and writes.
pub fn posture(arguments: &PostureArguments) -> Result<ExitStatus, Failure> {
    let scenario = &arguments.common.load(&arguments.scenario)?;
    if let ProcessSpec::PathMilling(_) = &scenario.process {
        return along::posture(arguments, scenario);
    }
    if arguments.runs.is_some() {
        let text = "--runs is for milling along a path: the plan of a straight cut is run as a scenario of its own";
        return Err(Failure::at(&arguments.scenario, text));
    }
    let failed = |error| Failure::sim(scenario, error);
    let study = MillingStudy::of(scenario).map_err(failed)?;
    let since = Instant::now();
    let draws = Draws::of(scenario).map_err(failed)?;
    let answer = answer(
        scenario,
        arguments,
        &study,
        draws.map(|draws| (draws, since)),
    )
    .map_err(|error| failed(in_scenario(error)))?;
    let mut written = files::write(&answer, &arguments.out)?;
    if arguments.maps {
        written.push(maps::write(&answer, &arguments.out)?);
    }
    crate::print(&text::printed(&answer, &written))
}

fn answer<'a>(
    scenario: &'a Scenario,
    arguments: &PostureArguments,
    study: &'a MillingStudy,
    draws: Option<(Draws, Instant)>,
) -> Result<PostureAnswer<'a>, PlanError> {
    let criterion = arguments.criterion.into();
    let stages = 2 + 2 * Criterion::ALL.len();
    let progress = Progress::new(stages, "posture plan");
    let options = PlannerOptions {
        branch: study.branch(),
        near: study.near(),
        least_decay: arguments.least_decay,
        ..PlannerOptions::default()
    };
    let run = progress.run();
    let planner = Planner::new(&study.robot, &study.path, &study.cut, &options)?;
    drop(run);
    let run = progress.run();
    let plan = planner.plan(criterion)?;
    drop(run);
    let of_each = |of: &dyn Fn(Criterion) -> Result<Vec<Assessment>, PlanError>| {
        let all = Criterion::ALL.iter().copied();
        all.map(of).collect::<Result<Vec<_>, _>>()
    };
    let maps = Criterion::ALL.iter().map(|&criterion| {
        let _told = progress.run();
        planner.map(criterion, plan.family, MAP_COLUMNS)
    });
    let maps = maps.collect::<Result<_, _>>()?;
    let plan_assessed = of_each(&|criterion| {
        let _told = progress.run();
        reassessed(&planner, &plan, criterion)
    })?;
    let own = match study.postures() {
        Ok(path) => {
            let angle = |at_m| study.angle_rad(at_m);
            let own = planner.at_postures(criterion, &angle, &|at_m| path.posture(at_m))?;
            Some(Own {
                assessed: of_each(&|criterion| reassessed(&planner, &own, criterion))?,
                plan: own,
            })
        }
        Err(_) => None,
    };
    drop(progress);
    let of_draws = |draws| uncertain::uncertain(draws, &planner, &plan, own.as_ref());
    Ok(PostureAnswer {
        uncertain: draws.map(of_draws).transpose()?,
        missing: missing(study, &plan)?,
        scenario,
        study,
        maps,
        plan_assessed,
        own,
        plan,
    })
}

/// What is to be said of a cut that is too fast for the arm's modes at the start of the plan.
fn missing(study: &MillingStudy, plan: &Plan) -> Result<Option<String>, PlanError> {
    let axes = study.path.world_from_milling(0);
    let first = &plan.points[0].posture;
    let modes = modes_in_cut(&study.robot, first, &axes, &study.cut.attached)?;
    let known = study.known_to_rad_s(&modes);
    let beyond = known.filter(|known| study.cut.spindle_rad_s > *known);
    Ok(beyond.map(|known| study.beyond_modes(&modes, known)))
}

/// Assessment of a plan by a criterion; that by its own is known already.
fn reassessed(
    planner: &Planner<'_>,
    plan: &Plan,
    criterion: Criterion,
) -> Result<Vec<Assessment>, PlanError> {
    if criterion == plan.criterion {
        return Ok(plan.points.iter().map(|p| p.assessment).collect());
    }
    planner.reassessed(plan, criterion)
}

impl PostureAnswer<'_> {
    /// Assessment by regeneration of the plan, and of the scenario's own postures.
    fn regenerative<'a>(&self, assessed: &'a [Vec<Assessment>]) -> &'a [Assessment] {
        let all = Criterion::ALL.iter().zip(assessed);
        let mut found = all.filter(|(criterion, _)| **criterion == Criterion::Regenerative);
        found.next().map_or(&[], |(_, assessed)| assessed)
    }

    /// Index of the plan's criterion.
    fn chosen(&self) -> usize {
        let all = Criterion::ALL.iter();
        let mut found = all.enumerate().filter(|(_, c)| **c == self.plan.criterion);
        found.next().map_or(0, |(index, _)| index)
    }
}
