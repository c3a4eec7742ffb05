//! Stability along a path in stock: the limit depth of the engagement as it changes, and for each
//! piece of the path the spindle speed at which most of it is left.
//!
//! Limits are those of the slot and of side milling (spectral elements) with the engagement that
//! the rim has at the place, the feed's direction and the modes of the arm's posture there, and
//! with the floor, on which a tool that sinks is engaged deeper at once; all arcs of a rim count as
//! one from the first entry to the last exit.

use std::f64::consts::TAU;
use std::sync::atomic::{AtomicUsize, Ordering};

use nalgebra::{Matrix3, Rotation3, Vector3};
use rayon::prelude::*;
use truecut_arm::Robot;
use truecut_core::chatter::DirectionalMatrix;
use truecut_core::chatter::limit::first_depth_m;
use truecut_core::chatter::spectral_elements::SpectralElements;
use truecut_core::cutting::milling::engagement::Engagement;
use truecut_core::cutting::milling::nominal::NominalCut;
use truecut_plan::modes_in_cut;
use truecut_recording::{Outcome, Scalar};
use truecut_scenario::{PathMillingSpec, ProcessSpec, Scenario};

use super::in_scenario;
use crate::build::in_context;
use crate::error::SimError;
use crate::process::path_milling::along::{CutPlace, CutPlaces, places};
use crate::process::soft_note;
use crate::robots::Robots;
use crate::run::{Run, RunError};

/// Depths that are looked at, as parts of the cut's own.
const DEPTHS: [f64; 14] = [
    0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 1.0, 1.15, 1.35, 1.6, 2.0, 2.5, 3.0,
];
/// Relative width to which limits are narrowed.
const WIDTH: f64 = 1e-3;
/// Margin from which on no other speed is looked for.
const ENOUGH: f64 = 1.25;

/// A place of the path, the cutter in stock.
#[derive(Debug, Clone, PartialEq)]
pub struct PathPlace {
    /// Way so far, m.
    pub along_m: f64,
    /// The tip in the work frame, m.
    pub place_m: [f64; 3],
    /// Line of the file whose point the tool is on its way to; `None` of a robot program.
    pub line: Option<usize>,
    /// Where the rim is in stock, from the left of the feed towards it.
    pub engagement: Engagement,
    /// Height of the edge in stock, m.
    pub depth_m: f64,
    pub spindle_rad_s: f64,
    /// Limit depth, m; `None` where there is none down to three times the cut's depth.
    pub limit_m: Option<f64>,
}

impl PathPlace {
    /// Limit over depth: below 1 the cut chatters. At most 3, to where it is looked for.
    #[must_use]
    pub fn margin(&self) -> f64 {
        let most = DEPTHS[DEPTHS.len() - 1];
        self.limit_m.map_or(most, |limit_m| limit_m / self.depth_m)
    }
}

/// A piece of the path: the way of one line of the file, or to one point of a robot program.
#[derive(Debug, Clone, PartialEq)]
pub struct PathSegment {
    pub line: Option<usize>,
    pub from_m: f64,
    pub to_m: f64,
    /// The place with the least margin, its index.
    pub worst: usize,
    /// Where that is below 1.25 the speed at which the least margin of the piece is largest,
    /// of those looked at, rad/s, and that margin.
    pub proposed: Option<(f64, f64)>,
}

/// What there is to say of a path.
#[derive(Debug, Clone, PartialEq)]
pub struct PathStability {
    pub places: Vec<PathPlace>,
    pub segments: Vec<PathSegment>,
    pub notes: Vec<String>,
}

/// The speeds that are looked at for proposals: from and to, rad/s, and how many.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Speeds {
    range_rad_s: [f64; 2],
    count: usize,
}

impl Speeds {
    fn each(&self) -> impl Iterator<Item = f64> + use<> {
        let Self {
            range_rad_s: [from, to],
            count,
        } = *self;
        (0..count).map(move |k| from + (to - from) * k as f64 / (count - 1).max(1) as f64)
    }
}

/// A cut whose limits are asked for.
pub(super) struct Study<'a> {
    pub spec: &'a PathMillingSpec,
    pub robot: &'a Robot,
    pub world_from_work: Rotation3<f64>,
}

/// Margins along the path of a scenario, and proposals out of a range of speeds (rad/s, and how
/// many; by default a half to one and a quarter of the fastest of the path). `progress` is told the
/// part done.
///
/// # Errors
/// If the scenario is not one of milling along a path, or something is wrong with robot or path.
pub fn path_stability(
    scenario: &Scenario,
    range_rad_s: Option<[f64; 2]>,
    count: usize,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<PathStability, SimError> {
    let ProcessSpec::PathMilling(spec) = &scenario.process else {
        let message = format!("the process is \"{}\"", scenario.process.name());
        return Err(SimError::scenario("process", message));
    };
    let robots = Robots::new();
    let CutPlaces {
        places,
        world_from_work,
    } = in_context(scenario, &robots, |context| places(spec, context))?;
    let robot = robots.robot(&scenario.robot)?;
    let study = Study {
        spec,
        robot: &robot,
        world_from_work: world_from_work.rotation.to_rotation_matrix(),
    };
    let fastest = spec.spindle.fastest_rad_s();
    let speeds = Speeds {
        range_rad_s: range_rad_s.unwrap_or([0.5 * fastest, 1.25 * fastest]),
        count,
    };
    let done = AtomicUsize::new(0);
    let told = |part: &AtomicUsize, of: usize, share: [f64; 2]| {
        let done = part.fetch_add(1, Ordering::Relaxed) + 1;
        progress(share[0] + (share[1] - share[0]) * done as f64 / of as f64);
    };
    let limits: Vec<Option<f64>> = (places.par_iter())
        .map(|place| {
            let limit = study.limit_m(place, place.spindle_rad_s);
            told(&done, places.len(), [0.0, 0.5]);
            limit
        })
        .collect::<Result<_, SimError>>()?;
    let known: Vec<PathPlace> = (places.iter().zip(limits))
        .map(|(place, limit_m)| known(place, limit_m))
        .collect();
    let pieces = pieces(&places);
    let done = AtomicUsize::new(0);
    let segments = pieces.par_iter().map(|piece| {
        let segment = study.segment(&places, &known, piece.clone(), &speeds);
        told(&done, pieces.len(), [0.5, 1.0]);
        segment
    });
    Ok(PathStability {
        segments: segments.collect::<Result<_, SimError>>()?,
        notes: study.notes(&places)?,
        places: known,
    })
}

pub(super) fn known(place: &CutPlace, limit_m: Option<f64>) -> PathPlace {
    PathPlace {
        along_m: place.along_m,
        place_m: place.place_m.into(),
        line: place.line,
        engagement: place.engagement,
        depth_m: place.depth_m,
        spindle_rad_s: place.spindle_rad_s,
        limit_m,
    }
}

/// Places on the way to one point after another; points of one line (of an arc) are together.
fn pieces(places: &[CutPlace]) -> Vec<std::ops::Range<usize>> {
    let same = |one: &CutPlace, other: &CutPlace| {
        one.point == other.point || (one.line.is_some() && one.line == other.line)
    };
    let mut pieces: Vec<std::ops::Range<usize>> = Vec::new();
    for (index, place) in places.iter().enumerate() {
        match pieces.last_mut() {
            Some(last) if same(&places[last.start], place) => last.end = index + 1,
            _ => pieces.push(index..index + 1),
        }
    }
    pieces
}

impl Study<'_> {
    /// Limit depth at a place with a spindle speed, m.
    pub fn limit_m(&self, place: &CutPlace, spindle_rad_s: f64) -> Result<Option<f64>, SimError> {
        let feed = Vector3::new(place.feed.x, place.feed.y, 0.0);
        let axes = Matrix3::from_columns(&[feed, Vector3::z().cross(&feed), Vector3::z()]);
        let axes = self.world_from_work.matrix() * axes;
        let attached = self.spec.attached.at(spindle_rad_s);
        let modes =
            modes_in_cut(self.robot, &place.posture, &axes, &attached).map_err(in_scenario)?;
        let cutter = &self.spec.cutter;
        let process = DirectionalMatrix {
            teeth: cutter.teeth,
            coefficients: self.spec.coefficients,
            engagement: place.engagement,
            flank: cutter.flank,
            radius_m: cutter.radius_m,
            feed_per_tooth_m: place.feed_per_tooth_m,
        };
        let nominal = NominalCut {
            cutter: *cutter,
            coefficients: self.spec.coefficients,
            engagement: place.engagement,
            axial_depth_m: place.depth_m,
            feed_per_tooth_m: place.feed_per_tooth_m,
        };
        let elements = SpectralElements::new(&modes, &process).with_floor(&nominal);
        let at = elements.at(cutter.tooth_period_s(spindle_rad_s));
        let depths = DEPTHS.map(|part| part * place.depth_m);
        Ok(first_depth_m(&at, depths, WIDTH))
    }

    fn segment(
        &self,
        places: &[CutPlace],
        known: &[PathPlace],
        piece: std::ops::Range<usize>,
        speeds: &Speeds,
    ) -> Result<PathSegment, SimError> {
        let margin = |index: &usize| known[*index].margin();
        let worst = piece.clone().min_by(|a, b| margin(a).total_cmp(&margin(b)));
        let worst = worst.unwrap_or(piece.start);
        let mut proposed: Option<(f64, f64)> = None;
        if margin(&worst) < ENOUGH {
            for spindle_rad_s in speeds.each() {
                let limit_m = self.limit_m(&places[worst], spindle_rad_s)?;
                let margin = self::known(&places[worst], limit_m).margin();
                if proposed.is_none_or(|(_, best)| margin > best) {
                    proposed = Some((spindle_rad_s, margin));
                }
            }
        }
        // Of the other places of the piece, too.
        if let Some((spindle_rad_s, least)) = &mut proposed {
            for index in piece.clone() {
                let limit_m = self.limit_m(&places[index], *spindle_rad_s)?;
                *least = least.min(self::known(&places[index], limit_m).margin());
            }
        }
        Ok(PathSegment {
            line: places[worst].line,
            from_m: places[piece.start].along_m,
            to_m: places[piece.end - 1].along_m,
            worst,
            proposed,
        })
    }

    /// What a reader of limits should know.
    pub fn notes(&self, places: &[CutPlace]) -> Result<Vec<String>, SimError> {
        let mut notes: Vec<String> = soft_note(&self.spec.coefficients).into_iter().collect();
        if self.spec.cutter.helix_angle_rad != 0.0 {
            notes.push("limits are those of straight edges".to_owned());
        }
        let Some(place) = places
            .first()
            .filter(|_| self.spec.attached.tool.is_empty())
        else {
            return Ok(notes);
        };
        let axes = Matrix3::identity();
        let attached = &self.spec.attached;
        let modes =
            modes_in_cut(self.robot, &place.posture, &axes, attached).map_err(in_scenario)?;
        let rates = modes.iter().map(|mode| mode.natural_frequency_rad_s);
        let fastest = rates.fold(0.0, f64::max);
        let known = super::known::FASTEST_LOBE * fastest / self.spec.cutter.teeth as f64;
        if self.spec.spindle.fastest_rad_s() > known {
            notes.push(format!(
                "above {:.0} rpm teeth pass at more than twice the frequency of the fastest mode: tool, holder and spindle limit \
                 the cut there, and the scenario gives no modes of theirs ([[process.path_milling.cutter.mode]]), so that limits \
                 are far too deep",
                known * 60.0 / TAU
            ));
        }
        Ok(notes)
    }
}

/// A run of a scenario along its path.
#[derive(Debug, Clone, PartialEq)]
pub struct PathRun {
    /// Speed of the spindle, rad/s; `None`: as the scenario has it.
    pub spindle_rad_s: Option<f64>,
    pub outcome: Outcome,
    /// Largest change of the deflection from one tooth to the next by stretches of the path, root
    /// mean square, and the way to there, m; NaN where there is none.
    pub vibration_m: f64,
    pub at_m: f64,
}

/// Runs a scenario as it is and at the speeds that are proposed, `count` runs at most; none if none
/// is proposed. The feed stays, so that chips become thicker or thinner. `progress` is told the
/// part done.
///
/// # Errors
/// Whatever makes the scenario unfit to run at one of the speeds.
pub fn path_runs(
    scenario: &Scenario,
    found: &PathStability,
    count: usize,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Vec<PathRun>, RunError> {
    let mut speeds = vec![None];
    for segment in &found.segments {
        let proposed = segment.proposed.map(|(rad_s, _)| rad_s);
        if !speeds.contains(&proposed) {
            speeds.push(proposed);
        }
    }
    if speeds.len() == 1 {
        return Ok(Vec::new());
    }
    speeds.truncate(count);
    let done = AtomicUsize::new(0);
    let runs = speeds.par_iter().map(|spindle_rad_s| {
        let speed = spindle_rad_s.map(|rad_s| {
            let rpm = format!("{:?}", rad_s * 60.0 / TAU);
            ("process.path_milling.spindle_rpm".to_owned(), rpm)
        });
        let keys: Vec<_> = speed.into_iter().collect();
        let run = path_run(scenario, &keys).map(|run| PathRun {
            spindle_rad_s: *spindle_rad_s,
            ..run
        });
        progress((done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / speeds.len() as f64);
        run.map_err(|error| RunError::of(scenario, error))
    });
    runs.collect()
}

/// A run of a scenario with keys changed.
pub(super) fn path_run(
    scenario: &Scenario,
    keys: &[(String, String)],
) -> Result<PathRun, SimError> {
    let end = Run::of(&scenario.with_overrides(keys)?).end()?;
    let value = |name: &str| {
        let found = end.scalars.iter().find(|one: &&Scalar| one.name == name);
        found.map_or(f64::NAN, |one| one.value)
    };
    Ok(PathRun {
        spindle_rad_s: None,
        vibration_m: value("path_milling.vibration_level"),
        at_m: value("path_milling.vibration_at"),
        outcome: end.outcome,
    })
}

#[cfg(test)]
mod tests;
