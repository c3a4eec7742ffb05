//! Where along a path bodies come nearest to each other.

use std::collections::HashSet;

use nalgebra::Vector3;
use rayon::prelude::*;
use truecut_arm::Robot;

use super::cell::{Cell, Pair};
use super::motion::frames;
use crate::program::{Motion, Program, Replay};

/// A least clearance is found to this, m, or to this share of it, whichever is more.
pub const TOLERANCE_M: f64 = 1e-4;
pub const TOLERANCE_SHARE: f64 = 0.01;

/// Postures at which all pairs are looked at before the path is followed.
const SAMPLES: usize = 100;

/// The arm at one instant; from one to the next the joints go evenly.
#[derive(Debug, Clone, PartialEq)]
pub struct Station {
    /// Path point of the move under way.
    pub path_point: usize,
    pub posture: Vec<f64>,
    /// Whether the tool may touch the part on the way here.
    pub is_fed: bool,
}

/// A place on a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// The station before, and the share of the way to the next.
    pub station: usize,
    pub way: f64,
    /// Path point that the arm is on its way to.
    pub path_point: usize,
    /// Share of the stations of that move that are behind it.
    pub share: f64,
}

/// How near a pair of bodies comes.
#[derive(Debug, Clone, PartialEq)]
pub struct Approach {
    /// The body that moves, and the other.
    pub pair: [String; 2],
    pub least_m: f64,
    pub at: Place,
    /// The first place with less than is asked for, and how much there.
    pub first_below: Option<(Place, f64)>,
    /// Points nearest to each other where they come nearest, world; `None` where they touch.
    pub nearest_m: Option<[Vector3<f64>; 2]>,
}

/// What came of a path.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Clearances {
    /// The pair that comes nearest; `None` if there is no pair.
    pub least: Option<Approach>,
    /// Pairs that come nearer than asked, in the order of the path.
    pub below: Vec<Approach>,
    /// Pairs that were looked at.
    pub pairs: usize,
    /// Pairs that were left out.
    pub notes: Vec<String>,
}

impl Station {
    /// The places at which a program was run through; the tool may touch the part on lines. A line
    /// that `is_rapid` in the way to its path point is none of these, unless it leads from a feed
    /// or to one: there the tool leaves the part, or comes to it.
    #[must_use]
    pub fn of_replay(
        program: &Program,
        replay: &Replay,
        is_rapid: impl Fn(usize) -> bool,
    ) -> Vec<Self> {
        let moves = &program.moves;
        let is_line = |k: usize| matches!(moves[k].motion, Motion::Linear { .. });
        let is_feed = |k: usize| is_line(k) && !is_rapid(moves[k].path_point);
        let may_touch = |k: &usize| {
            let before = *k > 0 && is_feed(k - 1);
            let after = k + 1 < moves.len() && is_feed(k + 1);
            is_feed(*k) || (is_line(*k) && before != after)
        };
        let fed = (0..moves.len()).filter(may_touch);
        let fed: HashSet<usize> = fed.map(|k| moves[k].path_point).collect();
        let rows = replay.rows.iter().map(|row| Self {
            path_point: row.path_point,
            posture: row.posture.clone(),
            is_fed: fed.contains(&row.path_point),
        });
        rows.collect()
    }
}

/// A pair as it is followed along a path.
struct Followed<'a> {
    pair: &'a Pair,
    /// Least so far, with station and share of the way.
    least: (f64, usize, f64),
    first_below: Option<(f64, usize, f64)>,
}

impl Cell {
    /// Clearance of the nearest pair in one posture, m; infinite if there is none. `is_fed` says
    /// whether the tool may touch the part.
    #[must_use]
    pub fn clearance_m(&self, robot: &Robot, posture: &[f64], is_fed: bool) -> f64 {
        let frames = frames(robot, posture);
        let counts = self.pairs.iter().filter(|pair| !(is_fed && pair.may_cut));
        counts.fold(f64::INFINITY, |least_m, pair| {
            least_m.min(self.apart(pair, &frames, least_m).least_m)
        })
    }

    /// How near bodies come along a path. The least clearance is found to [`TOLERANCE_M`] or
    /// [`TOLERANCE_SHARE`] of it, and no pair that comes nearer than asked by more than that is
    /// missed.
    #[must_use]
    pub fn along(&self, robot: &Robot, stations: &[Station]) -> Clearances {
        let (mut followed, notes) = self.sampled(robot, stations);
        let nearest = followed.iter().map(|one| one.least.0);
        let bar_m = nearest.fold(f64::INFINITY, f64::min).max(self.least_m);
        followed
            .par_iter_mut()
            .for_each(|one| self.follow(robot, stations, one, bar_m));
        let told = |one: &Followed| {
            let (least_m, station, way) = one.least;
            let frames = frames(robot, &between(stations, station, way));
            Approach {
                pair: self.names(one.pair),
                least_m,
                at: place(stations, station, way),
                first_below: one
                    .first_below
                    .map(|(m, station, way)| (place(stations, station, way), m)),
                nearest_m: self.nearest_m(one.pair, &frames),
            }
        };
        let least = followed.iter().filter(|one| one.least.0.is_finite());
        let least = least.min_by(|a, b| a.least.0.total_cmp(&b.least.0));
        let below = followed.iter().filter(|one| one.first_below.is_some());
        let mut below: Vec<Approach> = below.map(told).collect();
        below.sort_by_key(|one| one.first_below.map(|(at, _)| at.station));
        Clearances {
            least: least.map(told),
            below,
            pairs: followed.len(),
            notes,
        }
    }

    /// All pairs at some stations. Bodies of the arm that touch at each of them are so near by
    /// their shapes, which are taken for more than they are: they are left out with a note.
    fn sampled(&self, robot: &Robot, stations: &[Station]) -> (Vec<Followed<'_>>, Vec<String>) {
        let every = stations.len().div_ceil(SAMPLES).max(1);
        let at: Vec<usize> = (0..stations.len()).step_by(every).collect();
        let distances: Vec<Vec<f64>> = at
            .par_iter()
            .map(|&station| self.at_station(robot, stations, station))
            .collect();
        let (mut followed, mut notes) = (Vec::new(), Vec::new());
        for (index, pair) in self.pairs.iter().enumerate() {
            if pair.is_own && !at.is_empty() && distances.iter().all(|row| row[index] == 0.0) {
                let [one, other] = self.names(pair);
                notes.push(format!(
                    "\"{one}\" and \"{other}\" touch in every posture by their shapes: this pair is left out"
                ));
                continue;
            }
            let each = at
                .iter()
                .zip(&distances)
                .map(|(at, row)| (row[index], *at, 0.0));
            let least = each.min_by(|a, b| a.0.total_cmp(&b.0));
            followed.push(Followed {
                pair,
                least: least.unwrap_or((f64::INFINITY, 0, 0.0)),
                first_below: None,
            });
        }
        (followed, notes)
    }

    /// Distances of all pairs at a station; of arm and carried body all, of others those that are
    /// less than any before, the rest infinite.
    fn at_station(&self, robot: &Robot, stations: &[Station], station: usize) -> Vec<f64> {
        let frames = frames(robot, &stations[station].posture);
        let mut bar_m = f64::INFINITY;
        let each = self.pairs.iter().map(|pair| {
            if stations[station].is_fed && pair.may_cut {
                return f64::INFINITY;
            }
            if station == 0 && self.begins_within(pair, &frames) {
                return 0.0;
            }
            let bar = if pair.is_own { f64::INFINITY } else { bar_m };
            let found_m = self.apart(pair, &frames, bar).least_m;
            bar_m = bar_m.min(found_m);
            found_m
        });
        each.collect()
    }

    /// Follows a pair along the whole path, from place to place as far as it cannot come nearer
    /// than `bar_m`, or than its least so far.
    fn follow(&self, robot: &Robot, stations: &[Station], one: &mut Followed<'_>, bar_m: f64) {
        let counts = |station: usize| !(one.pair.may_cut && stations[station].is_fed);
        let (mut station, mut way, mut budget_m, mut begins) = (0, 0.0, 0.0, true);
        while station < stations.len() {
            let is_last = station + 1 == stations.len();
            // The last station ends the way to it; where that does not count, neither does it.
            let is_over = is_last && (!begins || !counts(station));
            if is_over || (!is_last && !counts(station + 1)) {
                (station, way, begins) = (station + 1, 0.0, true);
                continue;
            }
            let posture = between(stations, station, way);
            let frames = frames(robot, &posture);
            if begins || budget_m <= 0.0 {
                let bar_m = match one.first_below {
                    Some(_) => one.least.0,
                    None => bar_m,
                };
                let is_within = begins && self.begins_within(one.pair, &frames);
                let apart = self.apart(one.pair, &frames, bar_m);
                let found_m = if is_within { 0.0 } else { apart.least_m };
                one.take(found_m, station, way, self.least_m);
                if one.first_below.is_some() && one.least.0 == 0.0 {
                    return;
                }
                let tolerance_m = TOLERANCE_M.max(TOLERANCE_SHARE * bar_m.min(apart.bound_m));
                budget_m = (apart.bound_m - bar_m).max(0.0) + 2.0 * tolerance_m;
                begins = false;
            }
            if is_last {
                break;
            }
            let ends = [posture.as_slice(), stations[station + 1].posture.as_slice()];
            let rest_m = self.motion_m(robot, one.pair, &frames, ends);
            if rest_m > budget_m {
                // Bodies of more than 100 m get no smaller steps than this.
                way += (1.0 - way) * (budget_m / rest_m).max(1e-4);
                budget_m = 0.0;
            } else {
                budget_m -= rest_m;
                (station, way) = (station + 1, 0.0);
            }
        }
    }
}

impl Followed<'_> {
    fn take(&mut self, apart_m: f64, station: usize, way: f64, asked_m: f64) {
        if apart_m < self.least.0 {
            self.least = (apart_m, station, way);
        }
        let is_below = apart_m < asked_m || apart_m <= 0.0;
        if is_below && self.first_below.is_none() {
            self.first_below = Some((apart_m, station, way));
        }
    }
}

/// The posture at a share of the way from a station to the next.
fn between(stations: &[Station], station: usize, way: f64) -> Vec<f64> {
    let from = &stations[station].posture;
    match stations.get(station + 1) {
        Some(to) if way > 0.0 => {
            let ends = from.iter().zip(&to.posture);
            ends.map(|(a, b)| a + way * (b - a)).collect()
        }
        _ => from.clone(),
    }
}

fn place(stations: &[Station], station: usize, way: f64) -> Place {
    let next = (station + 1).min(stations.len() - 1);
    let path_point = stations[if way > 0.0 { next } else { station }].path_point;
    let of_move = |at: &&Station| at.path_point == path_point;
    let behind = stations[..=station]
        .iter()
        .rev()
        .take_while(of_move)
        .count();
    let ahead = stations[station + 1..].iter().take_while(of_move).count();
    let share = (behind as f64 + way) / (behind + ahead).max(1) as f64;
    Place {
        station,
        way,
        path_point,
        share: share.min(1.0),
    }
}
