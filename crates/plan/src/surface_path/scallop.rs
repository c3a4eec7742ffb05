//! Lines between which ridges of one height are left.

use super::contact::Contact;
use super::error::SurfacePathError;
use super::graph::GraphLine;
use super::layout::{Layout, STATIONS, check_distance, narrow};
use super::spacing::{Laid, evenly};
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
    let graphs = evenly(|share| {
        let allowed = Allowed { scallop_m, share };
        laid(layout, &allowed, [first, last])
    })?;
    let mut lines = layout.pieces(&graphs[0], false, &[true; STATIONS + 1])?;
    for (k, pair) in graphs.windows(2).enumerate() {
        // Where the line before has reached the last one already there is nothing left to do.
        let mut keeps = [true; STATIONS + 1];
        for (keep, v) in keeps.iter_mut().zip(pair[0].v()) {
            *keep = last - v > 1e-9 * (last - first);
        }
        lines.extend(layout.pieces(&pair[1], k % 2 == 0, &keeps)?);
    }
    Ok(lines)
}

/// Lines until all of the last one is reached, each gap a share of what is allowed.
fn laid(
    layout: &Layout<'_>,
    allowed: &Allowed,
    [first, last]: [f64; 2],
) -> Result<Laid<GraphLine>, SurfacePathError> {
    let whole = last - first;
    let mut graph = layout.constant(first);
    let mut laid = Laid {
        lines: vec![graph.clone()],
        last_gap: allowed.share,
    };
    while graph.v().iter().any(|v| last - v > 1e-9 * whole) {
        let next = next_line(layout, allowed, &graph, [first, last])?;
        let steps = graph.v().iter().zip(next.v()).map(|(a, b)| b - a);
        let moved = steps.fold(0.0, f64::max);
        if moved < 1e-9 * whole {
            return Err(narrow(&layout.stations(&graph)?));
        }
        if next.v().iter().all(|v| *v < last) {
            check_distance(moved / whole)?;
        }
        laid.last_gap = allowed.taken(layout, &graph, &next)?;
        laid.lines.push(next.clone());
        graph = next;
    }
    Ok(laid)
}

/// What is allowed between lines, and the share of it that is taken.
struct Allowed {
    scallop_m: f64,
    share: f64,
}

impl Allowed {
    /// Way to the next line that a contact allows, m.
    fn whole_m(&self, layout: &Layout<'_>, contact: &Contact) -> f64 {
        let covered_m = contact.swath_m * (1.0 - layout.options.overlap);
        contact.ridge_spacing_m(self.scallop_m).min(covered_m)
    }

    /// The share of it that is taken, m.
    fn way_m(&self, layout: &Layout<'_>, contact: &Contact) -> f64 {
        self.share * self.whole_m(layout, contact)
    }

    /// The distance of two lines as a part of what is allowed, where that is most.
    fn taken(
        &self,
        layout: &Layout<'_>,
        one: &GraphLine,
        other: &GraphLine,
    ) -> Result<f64, SurfacePathError> {
        let mut most = 0.0_f64;
        for (a, b) in layout.stations(one)?.iter().zip(layout.stations(other)?) {
            let path_m = layout.path_m(a.u, one.at(a.u)[1], a.v, b.v)?;
            let both_m = 0.5 * (self.whole_m(layout, a) + self.whole_m(layout, &b));
            most = most.max(path_m / both_m);
        }
        Ok(most)
    }
}

fn next_line(
    layout: &Layout<'_>,
    allowed: &Allowed,
    graph: &GraphLine,
    [first, last]: [f64; 2],
) -> Result<GraphLine, SurfacePathError> {
    let stations = layout.stations(graph)?;
    let mut steps = Vec::with_capacity(STATIONS + 1);
    for contact in &stations {
        let slope = graph.at(contact.u)[1];
        let allowed_m = allowed.way_m(layout, contact);
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
            let both_m = 0.5 * (allowed.way_m(layout, a) + allowed.way_m(layout, b));
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
    use crate::surface::drawn::seeded;
    use crate::surface::{Domain, Jet, PlanePatch, Surface};
    use crate::surface_path::wheel::tests::PUBLISHED;
    use crate::surface_path::{
        AxisRule, Contact, FeedAlong, PathOptions, Strategy, SurfacePath, plan_path,
    };

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
        let apart = |k: usize| (angle(k + 1) - angle(k)).abs();
        let mean = (angle(count - 1) - angle(0)).abs() / (count - 1) as f64;
        let height_m = |apart: f64| radius_m * (1.0 / (0.5 * apart).cos() - 1.0);
        for k in 0..count - 1 {
            assert!((apart(k) / mean - 1.0).abs() < 0.01, "line {k}");
            // √(8 h/κ) is exact to second order: the chord's next term is 5 (φ/2)²/12, 1e-4 here.
            assert!(height_m(apart(k)) < 1.001 * scallop_m, "line {k}");
        }
        // One line less would leave more. Axes nearly as wide as the widest are taken, so that no
        // more than 2 % of the width is given away.
        let fewer = 1.02 * mean * (count - 1) as f64 / (count - 2) as f64;
        assert!(height_m(fewer) > scallop_m, "{count}");
    }

    /// A wheel fed along a round bar with its axis along it leaves hollows of its own radius r;
    /// their circles meet (ρ + r) cos(φ/2) − √(r² − (ρ + r)² sin²(φ/2)) from the bar's axis. One
    /// that rolls over a ball leaves facets about it, as along a bar, ρ (1/cos(φ/2) − 1) high.
    #[test]
    fn verify_ridges_on_drawn_bars_and_balls_have_the_height_of_the_closed_form() {
        for seed in 0..20 {
            let range = (0.05..0.4_f64, 0.01e-3..0.1e-3_f64, -0.9..0.9_f64);
            let (radius_m, scallop_m, at) = seeded(seed, &range);
            let bar = CylinderPatch::new(
                Vector3::zeros(),
                Unit::new_normalize(Vector3::x()),
                Unit::new_normalize(Vector3::z()),
                radius_m,
                [-1.0, 1.0],
                0.15,
            );
            let ball = Ball { radius_m };
            let rule = AxisRule::LeastCurvature;
            let spacing_m = |surface: &dyn Surface, place, feed| {
                let contact = Contact::at(surface, &PUBLISHED, rule, place, feed, None);
                contact.expect("a contact").ridge_spacing_m(scallop_m)
            };
            let half = 0.5 * spacing_m(&bar, [0.5, 0.5], [0.0, 1.0]) / radius_m;
            let (own_m, both_m) = (PUBLISHED.radius_m, PUBLISHED.radius_m + radius_m);
            let meet_m =
                both_m * half.cos() - (own_m.powi(2) - (both_m * half.sin()).powi(2)).sqrt();
            let ratio = (meet_m - radius_m) / scallop_m;
            assert!((ratio - 1.0).abs() < 0.02, "seed {seed}, bar: {ratio}");
            let half = 0.5 * spacing_m(&ball, [0.3, at], [1.0, 0.0]) / radius_m;
            let ratio = radius_m * (1.0 / half.cos() - 1.0) / scallop_m;
            assert!((ratio - 1.0).abs() < 0.02, "seed {seed}, ball: {ratio}");
        }
    }

    /// u turns about z, v is the latitude.
    struct Ball {
        radius_m: f64,
    }

    impl Surface for Ball {
        fn domain(&self) -> Domain {
            Domain {
                u: [0.0, 1.0],
                v: [-1.0, 1.0],
            }
        }

        fn jet(&self, u: f64, v: f64) -> Jet {
            let ([su, cu], [sv, cv]) = ([u.sin(), u.cos()], [v.sin(), v.cos()]);
            let vector = |x: f64, y: f64, z: f64| Vector3::new(x, y, z) * self.radius_m;
            Jet {
                point_m: vector(cu * cv, su * cv, sv),
                first_m: [
                    vector(-su * cv, cu * cv, 0.0),
                    vector(-cu * sv, -su * sv, cv),
                ],
                second_m: [
                    vector(-cu * cv, -su * cv, 0.0),
                    vector(su * sv, -cu * sv, 0.0),
                    vector(-cu * cv, -su * cv, -sv),
                ],
            }
        }
    }

    /// On a plane no ridge is left and the swath alone counts: lines of the iso-parametric path.
    #[test]
    fn verify_a_plane_has_no_ridges() {
        let plane = PlanePatch::new(Vector3::zeros(), Vector3::x() * 0.1, Vector3::y() * 0.06)
            .expect("a plane");
        let path = planned(&plane, 1e-6);
        let apart_mm: Vec<f64> = path.lines.iter().map(|l| l[0].point_m.y * 1e3).collect();
        let swath_mm = path.lines[0][0].swath_m * 1e3;
        // Nothing but rounding of 1/R.
        assert!(path.lines[0][0].gap_curvature_per_m.abs() < 1e-12);
        // 60 mm, less half a swath at either border, in as few gaps as the swath allows.
        let gaps = ((60.0 - swath_mm) / swath_mm).ceil();
        let expected_mm = (60.0 - swath_mm) / gaps;
        assert_eq!(apart_mm.len(), gaps as usize + 1);
        for pair in apart_mm.windows(2) {
            let off = (pair[1] - pair[0]) / expected_mm - 1.0;
            assert!(off.abs() < 0.01, "{apart_mm:?} {swath_mm}");
        }
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
