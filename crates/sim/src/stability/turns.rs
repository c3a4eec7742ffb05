//! Turns about the tool's axis, and postures of the arm at the start, along a path in stock: those
//! in which the cut has the largest margin.
//!
//! What the cutter meets does not depend on how the arm stands, so that engagements are found once;
//! each turn and each posture in which the arm can begin leads the arm along the path, and gives
//! the modes there. Turns are compared at the strongest engagement of each of a few stretches of
//! the path; the best few and the scenario's own are then looked at everywhere.

mod compared;
mod search;
#[cfg(test)]
mod tests;

use std::f64::consts::TAU;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use truecut_arm::{JointKind, Robot};
use truecut_recording::significant;
use truecut_scenario::{PathMillingSpec, ProcessSpec, Scenario};

use super::along::{PathPlace, PathRun, Study, path_run};
use crate::error::SimError;
use crate::robots::Robots;
use crate::run::RunError;
use compared::{Choice, Met};
use search::Search;

/// Turns that are looked at over a whole one.
const TURNS: usize = 36;
/// Stretches of the path at which turns are compared.
const STRETCHES: usize = 24;
/// How many of the best are then looked at everywhere.
const LOOKED_AT: usize = 6;

/// Margins within this factor of each other are equal: modes of an arm are not known better.
const EQUAL: f64 = 0.98;
/// A larger margin is no better than this one: coefficients and damping are not known to more than
/// a factor of two, and the tool's deflection counts then.
const PLENTY: f64 = 2.0;

const SPIN: &str = "process.path_milling.path.spin_deg";
const FILE: &str = "process.path_milling.path.file";

/// A turn and a posture at the start, and what they are worth.
#[derive(Debug, Clone, PartialEq)]
pub struct PathPosture {
    /// Turn about the tool's axis; `None`: as the scenario has it.
    pub spin_rad: Option<f64>,
    /// Of all joints at the start, rad and m.
    pub start: Vec<f64>,
    pub duration_s: f64,
    /// Limit over depth at the places at which turns are compared.
    pub margins: Vec<f64>,
    /// Deflection of the tool to expect, m: by the force of the cut, in the direction in which arm,
    /// tool and workpiece give way most, and by the arm's own acceleration on its way.
    pub bend_m: [f64; 2],
}

impl PathPosture {
    /// The place with the least margin and that margin.
    #[must_use]
    pub fn least(&self) -> (usize, f64) {
        let each = self.margins.iter().copied().enumerate();
        each.min_by(|a, b| a.1.total_cmp(&b.1))
            .unwrap_or((0, f64::INFINITY))
    }

    /// Whether it has the larger least margin or, where both are equal or there is plenty, the
    /// smaller deflection.
    #[must_use]
    pub fn is_better_than(&self, other: &PathPosture) -> bool {
        let [own, its] = [self, other].map(|one| one.least().1.min(PLENTY));
        let bends_less = self.bend_m.iter().sum::<f64>() < other.bend_m.iter().sum::<f64>();
        own * EQUAL > its || (own >= EQUAL * its && bends_less)
    }

    /// Keys that a scenario takes it by, in its units.
    fn keys(&self, robot: &Robot) -> Vec<(String, String)> {
        let of = |kind: JointKind, scale: f64| -> Vec<f64> {
            let joints = robot.chain.joints.iter().zip(&self.start);
            let joints = joints.filter(|(joint, _)| joint.kind == kind);
            joints
                .map(|(_, value)| (value * scale * 1e4).round() / 1e4)
                .collect()
        };
        let spin = self.spin_rad.map(|rad| format!("{:?}", degrees(rad)));
        let mut keys: Vec<_> = spin.into_iter().map(|deg| (SPIN.to_owned(), deg)).collect();
        for (key, kind, scale) in [
            ("robot.posture_deg", JointKind::Revolute, 1_f64.to_degrees()),
            ("robot.posture_mm", JointKind::Prismatic, 1e3),
        ] {
            let values = of(kind, scale);
            if !values.is_empty() {
                keys.push((key.to_owned(), format!("{values:?}")));
            }
        }
        keys
    }
}

/// Degrees without the dust of a conversion.
fn degrees(rad: f64) -> f64 {
    (rad.to_degrees() * 1e6).round() * 1e-6
}

/// What there is to choose along a path.
#[derive(Debug, Clone, PartialEq)]
pub struct PathPostures {
    /// Places at which turns are compared.
    pub compared: Vec<PathPlace>,
    /// The scenario's own, if the arm can follow the path so.
    pub own: Option<PathPosture>,
    /// Of each turn that the arm can follow, by angle, the posture with the largest least margin.
    pub turns: Vec<PathPosture>,
    /// Turns in which it cannot, rad, and why.
    pub refused: Vec<(f64, String)>,
    /// Of [`PathPostures::turns`] with the largest least margin, or one of two, which is as good,
    /// that in which the tool is deflected least.
    pub best: usize,
    /// Whether the scenario's own is as good.
    pub is_own: bool,
    /// Keys of the scenario, with their values, by which it takes the best.
    pub keys: Vec<(String, String)>,
    /// The whole path so, and as the scenario has it.
    pub best_places: Vec<PathPlace>,
    pub own_places: Vec<PathPlace>,
    pub notes: Vec<String>,
}

/// Looks at every turn. `progress` is told the part done.
///
/// # Errors
/// If the scenario is not one of milling along a path from CAM, or in no turn the arm can follow
/// the path.
pub fn path_postures(
    scenario: &Scenario,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<PathPostures, SimError> {
    let spec = path_of(scenario)?;
    let search = Search { scenario };
    let own = search.followed(&[]);
    let spins = (0..TURNS).map(|k| TAU * k as f64 / TURNS as f64).collect();
    let led = each(spins, (progress, [0.0, 0.3]), |spin_rad| {
        (spin_rad, search.starts(spin_rad))
    });
    let led = search.second_tries(led, (progress, [0.3, 0.4]));
    // What the cutter meets, by any way in which the arm can go.
    let can = led.iter().find(|(_, led)| led.is_ok());
    let keys = match (&own, can) {
        (Ok(_), _) => Vec::new(),
        (Err(_), Some((spin_rad, _))) => spin_key(*spin_rad),
        (Err(error), None) => return Err(none_reached(error)),
    };
    let met = search.met(&keys)?;
    let robot = Robots::new().robot(&scenario.robot)?;
    let study = Study {
        spec,
        robot: &robot,
        world_from_work: met.world_from_work.rotation.to_rotation_matrix(),
    };
    let all = Met {
        study: &study,
        places: met.places.iter().collect(),
    };
    let compared = all.strongest(STRETCHES);
    let judged = each(led, (progress, [0.4, 0.9]), |(spin_rad, led)| {
        let best = led.and_then(|led| compared.best(Some(spin_rad), &led));
        (spin_rad, best)
    });
    let (mut turns, mut refused) = (Vec::new(), Vec::new());
    for (spin_rad, best) in judged {
        match best {
            Ok(best) => turns.extend(best),
            Err(error) => refused.push((spin_rad, error)),
        }
    }
    if turns.is_empty() {
        let first = refused.first().map(|(_, error)| error);
        return Err(first.map_or_else(nothing_there, none_reached));
    }
    let of_own = own.as_ref().ok();
    let Choice { best, led, is_own } = all.choice(&search, &turns, of_own)?;
    progress(0.95);
    let mut notes = study.notes(&met.places)?;
    if let Err(fault) = &own {
        notes.push(format!("as the scenario has it the arm cannot go: {fault}"));
    }
    if is_own {
        notes.push("no turn is better than the scenario's own".to_owned());
    }
    let best_places = all.known(&led)?;
    let least = best_places
        .iter()
        .map(PathPlace::margin)
        .fold(f64::INFINITY, f64::min);
    if least < 1.0 {
        notes.push(format!(
            "in no posture that was looked at the cut is stable all along (least margin {}): take a smaller depth or \
             another speed, which `truecut lobes` proposes",
            significant(least, 3)
        ));
    }
    Ok(PathPostures {
        own: match of_own {
            Some(led) => compared.best(None, std::slice::from_ref(led))?,
            None => None,
        },
        own_places: of_own.map_or(Ok(Vec::new()), |led| all.known(led))?,
        best_places,
        compared: compared.known(&led)?,
        refused: (refused.into_iter())
            .map(|(spin_rad, error)| (spin_rad, error.to_string()))
            .collect(),
        keys: turns[best].keys(&robot),
        turns,
        best,
        is_own,
        notes,
    })
}

/// Does the same to each in parallel; the part done is told within a share.
fn each<T: Send, U: Send>(
    items: Vec<T>,
    (progress, [from, to]): (&(dyn Fn(f64) + Sync), [f64; 2]),
    work: impl Fn(T) -> U + Sync,
) -> Vec<U> {
    let (done, count) = (AtomicUsize::new(0), items.len() as f64);
    let worked = items.into_par_iter().map(|item| {
        let worked = work(item);
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        progress(from + (to - from) * done as f64 / count);
        worked
    });
    worked.collect()
}

/// Runs a scenario in the posture that is best for it, and as it is; `count` runs at most.
///
/// # Errors
/// Whatever makes the scenario unfit to run.
pub fn posture_runs(
    scenario: &Scenario,
    found: &PathPostures,
    count: usize,
) -> Result<Vec<PathRun>, RunError> {
    let failed = |error| RunError::of(scenario, error);
    let mut each = vec![found.keys.clone()];
    if found.own.is_some() {
        each.push(Vec::new());
    }
    each.truncate(count);
    let runs = each.par_iter().map(|keys| path_run(scenario, keys));
    let runs: Result<Vec<_>, SimError> = runs.collect();
    runs.map_err(failed)
}

fn none_reached(first: &SimError) -> SimError {
    let message = format!("in no turn about the tool's axis the arm can follow the path: {first}");
    SimError::scenario(SPIN, message)
}

fn nothing_there() -> SimError {
    SimError::scenario(FILE, "the path leads nowhere through stock")
}

fn spin_key(spin_rad: f64) -> Vec<(String, String)> {
    vec![(SPIN.to_owned(), format!("{:?}", degrees(spin_rad)))]
}

/// The path of a scenario whose turn can be chosen.
fn path_of(scenario: &Scenario) -> Result<&PathMillingSpec, SimError> {
    let ProcessSpec::PathMilling(spec) = &scenario.process else {
        let message = format!("the process is \"{}\"", scenario.process.name());
        return Err(SimError::scenario("process", message));
    };
    match spec.path.cam() {
        Ok(Some(_)) => Ok(spec),
        Ok(None) => {
            let file = spec.path.file.display();
            let message = format!(
                "{file} is a robot program, which leaves no posture to choose: give the path as CAM wrote it"
            );
            Err(SimError::scenario(FILE, message))
        }
        Err(error) => Err(SimError::scenario(FILE, error.to_string())),
    }
}
