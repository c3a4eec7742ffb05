//! Lines between which ridges of one height are left.

use super::contact::Contact;
use super::error::SurfacePathError;
use super::graph::GraphLine;
use super::layout::{Layout, STATIONS, check_distance, narrow};
use truecut_core::roots::try_bisect;

/// Bisections of the way to the next line at one station: to 1e-9 of it.
const BISECTIONS: usize = 30;

/// Stations to either side over which a line is smoothed.
const SMOOTHED: usize = 2;

/// How often a line that came out too far away is drawn nearer, by a fiftieth each time.
const DRAWN_NEARER: usize = 20;

/// The first line keeps clear of one border with v = const, each further one stands at its own
/// distance at every place, and what reaches the line that keeps clear of the other border goes
/// along it, once.
pub(super) fn lines(
    layout: &Layout<'_>,
    scallop_m: f64,
) -> Result<Vec<Vec<Contact>>, SurfacePathError> {
    let [first, last] = layout.outermost()?;
    let whole = last - first;
    let mut graph = layout.constant(first);
    let mut lines = layout.pieces(&graph, false, &[true; STATIONS + 1])?;
    let mut backwards = true;
    while graph.v().iter().any(|v| last - v > 1e-9 * whole) {
        let next = next_line(layout, scallop_m, &graph, [first, last])?;
        let least = graph.v().iter().zip(next.v()).map(|(a, b)| b - a);
        let moved = least.fold(0.0, f64::max);
        if moved < 1e-9 * whole {
            return Err(narrow(&layout.stations(&graph)?));
        }
        if next.v().iter().all(|v| *v < last) {
            check_distance(moved / whole)?;
        }
        // Where the line before has reached the last one already there is nothing left to do.
        let mut keeps = [true; STATIONS + 1];
        for (keep, v) in keeps.iter_mut().zip(graph.v()) {
            *keep = last - v > 1e-9 * whole;
        }
        lines.extend(layout.pieces(&next, backwards, &keeps)?);
        backwards = !backwards;
        graph = next;
    }
    Ok(lines)
}

/// Way to the next line that a contact allows, m.
fn allowed_m(layout: &Layout<'_>, scallop_m: f64, contact: &Contact) -> f64 {
    let covered_m = contact.swath_m * (1.0 - layout.options.overlap);
    contact.ridge_spacing_m(scallop_m).min(covered_m)
}

fn next_line(
    layout: &Layout<'_>,
    scallop_m: f64,
    graph: &GraphLine,
    [first, last]: [f64; 2],
) -> Result<GraphLine, SurfacePathError> {
    let stations = layout.stations(graph)?;
    let mut steps = Vec::with_capacity(STATIONS + 1);
    for contact in &stations {
        let slope = graph.at(contact.u)[1];
        let allowed_m = allowed_m(layout, scallop_m, contact);
        if layout.path_m(contact.u, slope, contact.v, last)? > allowed_m {
            let [near, _] = try_bisect([contact.v, last], BISECTIONS, |v| {
                let path_m = layout.path_m(contact.u, slope, contact.v, v);
                path_m.map(|path_m| path_m > allowed_m)
            })?;
            steps.push(near - contact.v);
        } else {
            // The last line is within reach; how far the step would go on without it, so that
            // smoothing does not stop short of it.
            let back = 1e-3 * (last - first);
            let per_v_m = layout.path_m(contact.u, slope, contact.v - back, contact.v)? / back;
            steps.push((last - contact.v).max(allowed_m / per_v_m));
        }
    }
    let mut steps = smoothed(&steps);
    let range = layout.surface.domain().u;
    for _ in 0..DRAWN_NEARER {
        let v = graph.v().iter().zip(&steps);
        let next = GraphLine::through(range, v.map(|(v, step)| (v + step).min(last)).collect());
        // The next line's own contacts may allow less than those of the line before.
        let there = layout.stations(&next)?;
        let mut good = true;
        for (k, (a, b)) in stations.iter().zip(&there).enumerate() {
            let slope = graph.at(a.u)[1];
            let path_m = layout.path_m(a.u, slope, a.v, b.v)?;
            let both_m = 0.5 * (allowed_m(layout, scallop_m, a) + allowed_m(layout, scallop_m, b));
            if path_m > both_m * (1.0 + 1e-9) {
                good = false;
                let from = k.saturating_sub(SMOOTHED);
                for step in &mut steps[from..=(k + SMOOTHED).min(STATIONS)] {
                    *step *= 0.98;
                }
            }
        }
        if good {
            return Ok(next);
        }
    }
    // So narrow a place ahead that the average does not come down to it: half of what this line
    // allows.
    let v = graph.v().iter().zip(&steps);
    let next = v.map(|(v, step)| (v + 0.5 * step).min(last)).collect();
    Ok(GraphLine::through(range, next))
}

/// The mean of neighbours' least steps, which is above no step: the lines do not take over what the
/// choice of the axis makes jump.
fn smoothed(steps: &[f64]) -> Vec<f64> {
    let around = |k: usize, of: &[f64]| {
        of[k.saturating_sub(SMOOTHED)..=(k + SMOOTHED).min(of.len() - 1)].to_vec()
    };
    let least: Vec<f64> = (0..steps.len())
        .map(|k| around(k, steps).into_iter().fold(f64::INFINITY, f64::min))
        .collect();
    let mean = |k: usize| {
        let near = around(k, &least);
        near.iter().sum::<f64>() / near.len() as f64
    };
    (0..steps.len()).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use nalgebra::{Unit, Vector3};

    use crate::surface::cylinder::CylinderPatch;
    use crate::surface::{PlanePatch, Surface};
    use crate::surface_path::wheel::tests::PUBLISHED;
    use crate::surface_path::{AxisRule, FeedAlong, PathOptions, Strategy, SurfacePath, plan_path};

    fn planned(surface: &dyn Surface, scallop_m: f64) -> SurfacePath {
        let options = PathOptions {
            rule: AxisRule::WidestSwath {
                edge_gap_limit_m: 1e-3,
            },
            overlap: 0.0,
            step_m: 2e-3,
            margin_m: 0.0,
        };
        let strategy = Strategy::IsoScallop { scallop_m };
        plan_path(surface, None, &PUBLISHED, strategy, FeedAlong::U, &options).expect("a path")
    }

    /// A wheel fed along a round bar of radius ρ, axis across the feed, touches it along facets
    /// whose ridges stand ρ (1/cos(φ/2) − 1) high for facets φ apart.
    #[test]
    fn verify_ridges_on_a_round_bar_have_the_height_asked_for() {
        let (radius_m, scallop_m) = (0.1, 0.05e-3);
        let bar = CylinderPatch::new(
            Vector3::zeros(),
            Unit::new_normalize(Vector3::x()),
            Unit::new_normalize(Vector3::z()),
            radius_m,
            [-0.6, 0.6],
            0.15,
        );
        // u turns, v runs along the bar: lines are fed along v.
        let options = PathOptions {
            rule: AxisRule::WidestSwath {
                edge_gap_limit_m: 1e-3,
            },
            overlap: 0.0,
            step_m: 2e-3,
            margin_m: 0.0,
        };
        let strategy = Strategy::IsoScallop { scallop_m };
        let path = plan_path(&bar, None, &PUBLISHED, strategy, FeedAlong::V, &options);
        let path = path.expect("a path");
        let angle = |k: usize| {
            let p = path.lines[k][0].point_m;
            p.y.atan2(p.z)
        };
        let count = path.lines.len();
        assert!(count > 8, "{count}");
        for k in 0..count - 2 {
            let apart = (angle(k + 1) - angle(k)).abs();
            let height_m = radius_m * (1.0 / (0.5 * apart).cos() - 1.0);
            // √(8 h/κ) is exact to second order: the chord's next term is 5 (φ/2)²/12, 1e-4 here.
            // Axes nearly as wide as the widest are taken, so that no more than 2 % of the width, 4
            // % of the height, is given away.
            let ratio = height_m / scallop_m;
            assert!(ratio < 1.001 && ratio > 0.95, "line {k}: {ratio}");
        }
    }

    /// On a plane no ridge is left and lines stand a swath apart: those of the iso-parametric path.
    #[test]
    fn verify_a_plane_has_no_ridges() {
        let plane = PlanePatch::new(Vector3::zeros(), Vector3::x() * 0.1, Vector3::y() * 0.06)
            .expect("a plane");
        let path = planned(&plane, 1e-6);
        let apart_mm: Vec<f64> = path.lines.iter().map(|l| l[0].point_m.y * 1e3).collect();
        let swath_mm = path.lines[0][0].swath_m * 1e3;
        // Nothing but rounding of 1/R.
        assert!(path.lines[0][0].gap_curvature_per_m.abs() < 1e-12);
        assert!(
            (apart_mm[1] - apart_mm[0] - swath_mm).abs() < 0.02 * swath_mm,
            "{apart_mm:?} {swath_mm}"
        );
    }

    /// On the bumpy spoke neighbours are nowhere further apart than the half-spacings of both
    /// together: the ridge stands where their gaps are equal, at √(2 h/κ) from each.
    #[test]
    fn ridges_on_the_spoke_keep_the_limit() {
        use crate::surface::spoke::Spoke;
        let scallop_m = 0.1e-3;
        let path = planned(&Spoke, scallop_m);
        assert!(path.lines.len() > 5);
        let reach_m =
            |c: &crate::surface_path::Contact| 0.5 * c.ridge_spacing_m(scallop_m).min(c.swath_m);
        let mut looked_at = 0;
        for pair in path.lines.windows(2) {
            // A line may end where its neighbour goes on.
            for contact in pair[0].iter().filter(|c| (c.u - 0.5).abs() < 0.3) {
                let near = pair[1]
                    .iter()
                    .map(|c| ((c.point_m - contact.point_m).norm(), c));
                let nearest = near.min_by(|a, b| a.0.total_cmp(&b.0));
                let beside = nearest.filter(|(_, c)| (c.u - contact.u).abs() < 0.02);
                let Some((apart_m, other)) = beside else {
                    continue;
                };
                // Points 2 mm apart: the nearest one stands 1 mm along the line at most, so that
                // √(g² + 1) mm may be found for g.
                let allowed_m = reach_m(contact) + reach_m(other);
                assert!(
                    apart_m < 1.03 * allowed_m.hypot(1e-3),
                    "{apart_m} {allowed_m}"
                );
                looked_at += 1;
            }
        }
        assert!(looked_at > 100, "{looked_at}");
    }
}
