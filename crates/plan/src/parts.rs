//! Parts of a path: how it is cut into segments, and these into halves.

use crate::intervals::Interval;
use crate::motion::timing::smooth_between;
use crate::options::PlannerOptions;
use crate::plan::Plan;
use crate::tool_path::ToolPath;

/// A segment as it is being chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Part {
    pub leg: usize,
    pub from_m: f64,
    pub to_m: f64,
    /// How often it may still be halved.
    pub halvings: u32,
}

impl Part {
    pub fn midpoint_m(&self) -> f64 {
        0.5 * (self.from_m + self.to_m)
    }
}

pub(crate) fn first_parts(path: &ToolPath, options: &PlannerOptions) -> Vec<Part> {
    let of_leg = |(leg, (from, to)): (usize, (f64, f64))| {
        let count = ((to - from) / options.segment_m - 1e-9).ceil().max(1.0) as usize;
        let at = move |i: usize| from + (to - from) * i as f64 / count as f64;
        (0..count).map(move |i| Part {
            leg,
            from_m: at(i),
            to_m: at(i + 1),
            halvings: options.halvings,
        })
    };
    path.legs_m().enumerate().flat_map(of_leg).collect()
}

/// Ends and midpoints of the shortest segments.
pub(crate) fn stations(path: &ToolPath, options: &PlannerOptions) -> Vec<f64> {
    let count = 2_usize.pow(options.halvings + 1);
    let parts = first_parts(path, options);
    let inner = parts.iter().flat_map(|part| {
        let at = move |i: usize| part.from_m + (part.to_m - part.from_m) * i as f64 / count as f64;
        (0..count).map(at)
    });
    let mut all: Vec<f64> = inner.collect();
    all.push(path.length_m());
    all
}

/// The parts, those halved that are asked for and may be.
pub(crate) fn halved(parts: &[Part], asked: impl Fn(usize) -> bool) -> Vec<Part> {
    let halve = |(k, part): (usize, &Part)| {
        let middle = part.midpoint_m();
        let halves = [(part.from_m, middle), (middle, part.to_m)];
        if part.halvings == 0 || !asked(k) {
            return vec![*part];
        }
        let half = |(from_m, to_m)| Part {
            from_m,
            to_m,
            halvings: part.halvings - 1,
            ..*part
        };
        halves.map(half).to_vec()
    };
    parts.iter().enumerate().flat_map(halve).collect()
}

/// Parts that can be halved and beside which an end of the interval moves too far. At a corner it
/// jumps with the feed's direction, whatever the lengths.
pub(crate) fn shifted(parts: &[Part], chain: &[Interval], most_rad: f64) -> Vec<bool> {
    let mut found = vec![false; parts.len()];
    for k in 1..parts.len() {
        let corner = parts[k - 1].leg != parts[k].leg;
        if !corner && chain[k - 1].ends_apart_rad(&chain[k]) > most_rad {
            for at in [k - 1, k] {
                found[at] |= parts[at].halvings > 0;
            }
        }
    }
    found
}

/// Parts that can be halved and hold a point that is not stable.
pub(crate) fn unstable(parts: &[Part], plan: &Plan) -> Vec<bool> {
    let holds = |part: &Part| {
        let inside = plan
            .points
            .iter()
            .filter(|p| (part.from_m - 1e-9..=part.to_m + 1e-9).contains(&p.along_m));
        inside.into_iter().any(|p| !p.assessment.is_stable())
    };
    parts.iter().map(|p| p.halvings > 0 && holds(p)).collect()
}

/// Between knots (place, value): at rest at each of them, from one to the next as 3u² − 2u³, so
/// that joint speeds have no jumps. Constant beyond the ends.
pub(crate) fn between(knots: &[(f64, f64)], at: f64) -> f64 {
    let after = knots.partition_point(|(place, _)| *place <= at);
    match (after.checked_sub(1).map(|i| knots[i]), knots.get(after)) {
        (Some((x0, y0)), Some((x1, y1))) => {
            let u = (at - x0) / (x1 - x0);
            smooth_between(y0, *y1, u)
        }
        (Some((_, y)), None) => y,
        (None, Some((_, y))) => *y,
        (None, None) => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    fn path() -> ToolPath {
        let points = [[0.0, 0.0, 0.0], [0.12, 0.0, 0.0], [0.12, 0.03, 0.0]].map(Vector3::from);
        ToolPath::new(&points, -Vector3::z_axis(), Vector3::x()).expect("a path")
    }

    /// Midpoints of segments are stations, however often segments are halved; corners are ends of
    /// segments.
    #[test]
    fn verify_midpoints_of_all_segments_are_stations() {
        let options = PlannerOptions::default();
        let stations = stations(&path(), &options);
        assert!(stations.is_sorted() && stations.len() == 4 * 16 + 1);
        let mut parts = first_parts(&path(), &options);
        assert_eq!(parts.len(), 4);
        for _ in 0..=options.halvings {
            assert!(parts.iter().any(|p| (p.to_m - 0.12).abs() < 1e-12));
            for part in &parts {
                let middle = part.midpoint_m();
                assert!(stations.iter().any(|s| (s - middle).abs() < 1e-12));
            }
            parts = halved(&parts, |_| true);
        }
        assert_eq!(parts.len(), 32, "no shorter than allowed");
    }

    #[test]
    fn only_neighbours_of_a_shift_are_halved() {
        let parts = first_parts(&path(), &PlannerOptions::default());
        let interval = |from_rad: f64| Interval {
            sheet: 0,
            from_rad,
            to_rad: from_rad + 1.0,
        };
        // The last part lies behind the corner.
        let chain = [0.0, 0.1, 0.4, 0.9].map(interval);
        assert_eq!(shifted(&parts, &chain, 0.2), [false, true, true, false]);
    }

    #[test]
    fn verify_angles_between_knots() {
        let knots = [(1.0, 10.0), (2.0, 20.0), (4.0, 0.0)];
        let values = [0.0, 1.0, 1.25, 1.5, 3.0, 5.0].map(|at| between(&knots, at));
        assert_eq!(values, [10.0, 10.0, 11.5625, 15.0, 10.0, 0.0]);
    }
}
