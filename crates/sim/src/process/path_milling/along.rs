//! Where along its path a cutter stands in how much stock, teeth at rest: what stability asks.

use std::sync::Arc;

use super::nominal::NominalPath;
use super::setup::{FILE, motion, parameters};
use super::written::Written;
use super::{LEVEL, PathMillingSetup};
use crate::error::SimError;
use crate::motion::{KNOT_INTERVAL_S, PlannedMotion, Target};
use crate::process::SetupContext;
use nalgebra::{Isometry3, Vector2, Vector3};
use truecut_core::cutting::milling::engagement::Engagement;
use truecut_core::cutting::milling::layered::stock::LayeredStock;
use truecut_scenario::PathMillingSpec;

/// The rim is looked at where the tool has gone on by this part of the grid.
const CHORD: f64 = 1.0;
/// Most stretches of a path of which the strongest engagement is kept.
const STRETCHES: f64 = 200.0;
/// Engagements over a smaller angle are none, rad.
const LEAST_RAD: f64 = 0.03;

/// A place of the path at which the cutter is in stock.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CutPlace {
    /// Way so far, m.
    pub along_m: f64,
    /// The tip, work frame, m.
    pub place_m: Vector3<f64>,
    /// Line of the file whose point the tool is on its way to.
    pub line: Option<usize>,
    /// Number of that point.
    pub point: usize,
    pub posture: Vec<f64>,
    /// Direction of the feed in the work frame's plane.
    pub feed: Vector2<f64>,
    /// From the left of the feed towards it: all arcs as one.
    pub engagement: Engagement,
    /// Height of the edge in stock, m.
    pub depth_m: f64,
    pub spindle_rad_s: f64,
    pub feed_per_tooth_m: f64,
}

/// Places of a path in their order, and the frame that they are in.
pub(crate) struct CutPlaces {
    pub places: Vec<CutPlace>,
    pub world_from_work: Isometry3<f64>,
}

/// The strongest engagement of each stretch of a path. Where the tool sinks nothing is said.
pub(crate) fn places(
    spec: &PathMillingSpec,
    context: &SetupContext<'_>,
) -> Result<CutPlaces, SimError> {
    if !spec.cutter.is_flat() {
        let message = "limits are those of upright edges: a cutter with a round corner has none here; runs tell where it \
                       chatters (path_milling.vibration)";
        let key = "process.path_milling.cutter.corner_radius_mm";
        return Err(SimError::scenario(key, message));
    }
    let motion = motion(spec, context)?;
    let setup = parameters(spec, context, &motion)?;
    Ok(CutPlaces {
        places: setup.places(&motion.knots)?,
        world_from_work: setup.world_from_work,
    })
}

/// An arm led along a path, without a cut.
pub(crate) struct Followed {
    motion: Arc<PlannedMotion>,
    nominal: NominalPath,
}

impl Followed {
    /// The posture in which it begins.
    pub fn start(&self) -> &[f64] {
        &self.motion.knots[0]
    }

    pub fn duration_s(&self) -> f64 {
        self.motion.duration_s
    }

    /// Postures at even times, from one way along the path to another, m, and the time between two.
    pub fn between(&self, [from_m, to_m]: [f64; 2]) -> (&[Vec<f64>], f64) {
        let ends = [from_m, to_m].map(|along_m| self.nominal.knot_at(along_m));
        (&self.motion.knots[ends[0]..=ends[1]], KNOT_INTERVAL_S)
    }

    /// The posture at a way along the path, that of the nearest knot, m.
    pub fn posture_at(&self, along_m: f64) -> &[f64] {
        &self.motion.knots[self.nominal.knot_at(along_m)]
    }
}

/// Leads the arm along a path, if it can follow it.
pub(crate) fn followed(
    spec: &PathMillingSpec,
    context: &SetupContext<'_>,
) -> Result<Followed, SimError> {
    let motion = motion(spec, context)?;
    let Target::Way(way) = &motion.target else {
        return Err(SimError::scenario(FILE, "the path is not solved"));
    };
    let work_from_world = way.world_from_work.inverse();
    let knots = &motion.knots;
    let nominal = NominalPath::new(
        context.robot,
        knots,
        KNOT_INTERVAL_S,
        &work_from_world,
        false,
    );
    Ok(Followed { motion, nominal })
}

impl CutPlace {
    /// How much of the edge is in stock: height times angle.
    pub fn weight(&self) -> f64 {
        self.depth_m * arc_rad(&self.engagement)
    }
}

impl PathMillingSetup {
    fn places(&self, knots: &[Vec<f64>]) -> Result<Vec<CutPlace>, SimError> {
        let Written::Upright { meant, .. } = &self.written else {
            let message = "the tool leans on its way: limits along a path are those of an upright tool; runs tell where \
                           it chatters (path_milling.vibration)";
            return Err(SimError::scenario(FILE, message));
        };
        let mut left = meant.stock.clone();
        let radius_m = self.spec.cutter.radius_m;
        let chord_m = CHORD * left.grid_m();
        let stretch_m = (self.nominal.length_m() / STRETCHES).max(chord_m);
        let mut places: Vec<CutPlace> = Vec::new();
        let (mut from, mut from_s) = (self.nominal.at(0.0), 0.0);
        for (knot, posture) in knots.iter().enumerate().skip(1) {
            let time_s = knot as f64 * KNOT_INTERVAL_S;
            let on = self.nominal.at(time_s);
            let way_m = on.place_m - from.place_m;
            if way_m.norm() < chord_m && knot + 1 < knots.len() {
                continue;
            }
            let is_level = way_m.z.abs() <= LEVEL * way_m.norm() && way_m.norm() > 0.0;
            if is_level
                && let Some((engagement, depth_m)) =
                    engaged(&left, &on.place_m, radius_m, &way_m.xy())
            {
                let point = self
                    .reached_s
                    .partition_point(|reached_s| *reached_s < time_s);
                let point = point.min(self.lines.len() - 1);
                let spindle_rad_s = self.spindle.rad_s(time_s);
                let speed_m_per_s = way_m.norm() / (time_s - from_s);
                let place = CutPlace {
                    along_m: on.along_m,
                    place_m: on.place_m,
                    line: self.lines[point],
                    point,
                    posture: posture.clone(),
                    feed: way_m.xy().normalize(),
                    engagement,
                    depth_m,
                    spindle_rad_s,
                    feed_per_tooth_m: speed_m_per_s * self.spec.tooth_period_at_s(spindle_rad_s),
                };
                let same = |one: &CutPlace| {
                    let stretch = |along_m: f64| (along_m / stretch_m).floor();
                    one.point == point && stretch(one.along_m) == stretch(on.along_m)
                };
                match places.last_mut().filter(|one| same(one)) {
                    Some(one) if one.weight() >= place.weight() => {}
                    Some(one) => *one = place,
                    None => places.push(place),
                }
            }
            left.cut_leg(
                [from.place_m, on.place_m],
                &self.spec.cutter.profile(),
                false,
            );
            (from, from_s) = (on, time_s);
        }
        Ok(places)
    }
}

/// Where the rim of a tool that has come to a place is in stock, and over which height.
fn engaged(
    left: &LayeredStock,
    place_m: &Vector3<f64>,
    radius_m: f64,
    feed: &Vector2<f64>,
) -> Option<(Engagement, f64)> {
    let (mut widest, mut depth_m) = (None::<Engagement>, 0.0);
    for (layer, [low_m, high_m]) in left.engaged(place_m.z) {
        let Some(found) = left.immersion(layer, &place_m.xy(), radius_m, feed) else {
            continue;
        };
        if found.engaged_rad < LEAST_RAD {
            continue;
        }
        depth_m += high_m - low_m;
        let here = Engagement {
            entry_rad: found.entry_rad,
            exit_rad: found.exit_rad,
        };
        if widest.is_none_or(|widest| arc_rad(&widest) < arc_rad(&here)) {
            widest = Some(here);
        }
    }
    widest.map(|engagement| (engagement, depth_m))
}

fn arc_rad(engagement: &Engagement) -> f64 {
    engagement.exit_rad - engagement.entry_rad
}
