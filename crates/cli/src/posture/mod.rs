//! `truecut posture`: chooses the arm's postures along the path of a milling scenario.

mod figure;
mod files;
mod maps;
mod tell;

use std::path::PathBuf;

use truecut_plan::{Assessment, Criterion, MarginMap, Plan, PlanError, Planner, PlannerOptions};
use truecut_scenario::Scenario;
use truecut_sim::stability::{MillingStudy, in_scenario};

use crate::failure::Failure;
use crate::progress::Progress;
use crate::verdict::Verdict;

/// `posture`, resolved.
pub struct Request {
    pub scenario: Scenario,
    pub criterion: Criterion,
    /// Least decay by regeneration, as a part of that of the arm's slowest mode.
    pub least_decay: f64,
    pub maps: bool,
    pub out: PathBuf,
}

/// What was planned, and what each criterion says of it.
struct Answer<'a> {
    scenario: &'a Scenario,
    study: &'a MillingStudy,
    plan: Plan,
    /// By criterion, in the order of [`Criterion::ALL`].
    maps: Vec<MarginMap>,
    plan_assessed: Vec<Vec<Assessment>>,
    /// The scenario's own angles; none where the arm cannot follow them.
    own: Option<Own>,
}

/// The path with the scenario's own redundancy angles.
struct Own {
    plan: Plan,
    assessed: Vec<Vec<Assessment>>,
}

/// Columns of the maps over the path.
const MAP_COLUMNS: usize = 17;

/// Plans, prints and writes.
pub fn posture(request: &Request) -> Result<Verdict, Failure> {
    let scenario = &request.scenario;
    let study = MillingStudy::of(scenario).map_err(|error| Failure::sim(scenario, error))?;
    let answer =
        answer(request, &study).map_err(|error| Failure::sim(scenario, in_scenario(error)))?;
    let mut written = files::write(&answer, &request.out)?;
    if request.maps {
        written.push(maps::write(&answer, &request.out)?);
    }
    crate::print(&tell::tell(&answer, &written))
}

fn answer<'a>(request: &'a Request, study: &'a MillingStudy) -> Result<Answer<'a>, PlanError> {
    let stages = 2 + 2 * Criterion::ALL.len();
    let progress = Progress::new(stages, "posture plan");
    let options = PlannerOptions {
        family: study.family(),
        near: study.near(),
        least_decay: request.least_decay,
        ..PlannerOptions::default()
    };
    let told = progress.run();
    let planner = Planner::new(&study.robot, &study.path, &study.cut, &options)?;
    drop(told);
    let told = progress.run();
    let plan = planner.plan(request.criterion)?;
    drop(told);
    let of_each = |of: &dyn Fn(Criterion) -> Result<Vec<Assessment>, PlanError>| {
        Criterion::ALL
            .map(of)
            .into_iter()
            .collect::<Result<Vec<_>, _>>()
    };
    let maps = Criterion::ALL.map(|criterion| {
        let _told = progress.run();
        planner.map(criterion, plan.family, MAP_COLUMNS)
    });
    let plan_assessed = of_each(&|criterion| {
        let _told = progress.run();
        reassessed(&planner, &plan, criterion)
    })?;
    let own = planner.at_angles(request.criterion, &|at_m| study.angle_rad(at_m));
    let own = match own {
        Ok(own) => Some(Own {
            assessed: of_each(&|criterion| reassessed(&planner, &own, criterion))?,
            plan: own,
        }),
        Err(_) => None,
    };
    Ok(Answer {
        scenario: &request.scenario,
        study,
        maps: maps.into_iter().collect::<Result<_, _>>()?,
        plan_assessed,
        own,
        plan,
    })
}

/// What a criterion says of a plan; its own has said so already.
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

impl Answer<'_> {
    /// What regeneration says of the plan, and of the scenario's own angles.
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
