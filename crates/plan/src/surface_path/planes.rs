//! Sections of a patch with parallel planes.

use nalgebra::{Unit, Vector3};
use truecut_core::roots::bisect;

use super::contact::Contact;
use super::error::SurfacePathError;
use super::graph::GraphLine;
use super::layout::{Layout, STATIONS, check_distance, narrow};
use super::outer::outer;
use super::spacing::{Laid, evenly};
use crate::surface::{Boundary, Domain, Forms, Surface, outline};

/// Bisections by which a section is found: to 1e-12 of the range.
const BISECTIONS: usize = 40;

/// Places, along each parameter, at which the planes are checked to cross the patch.
const CHECKED: usize = 33;

/// Whether sections run along v rather than u: whether u changes faster from plane to plane.
pub(super) fn along_v(surface: &dyn Surface, normal: &Unit<Vector3<f64>>) -> bool {
    let Domain { u, v } = surface.domain();
    let jet = surface.jet(0.5 * (u[0] + u[1]), 0.5 * (v[0] + v[1]));
    let [along_u, along_v] = jet.first_m.map(|r| (r.dot(normal) / r.norm()).abs());
    along_u > along_v
}

/// Sections with planes normal · r = c, from one end of the patch to the other.
pub(super) fn lines(
    layout: &Layout<'_>,
    normal: &Unit<Vector3<f64>>,
) -> Result<Vec<Vec<Contact>>, SurfacePathError> {
    let sections = Sections::new(layout.surface, normal)?;
    // Without a boundary the outline of the patch itself is one: sections meet its borders at any
    // angle.
    let outline = match layout.boundary {
        Some(_) => None,
        None => Some(Boundary::new(&outline(layout.surface))?),
    };
    let layout = Layout {
        boundary: layout.boundary.or(outline.as_ref()),
        ..*layout
    };
    let [low_m, high_m] = sections.range_m;
    let pieces = |c_m: f64, backwards: bool| {
        layout.pieces(&sections.graph(c_m), backwards, &[true; STATIONS + 1])
    };
    let some = |c_m: f64| Ok(!pieces(c_m, false)?.is_empty());
    let middle_m = 0.5 * (low_m + high_m);
    let (first, last) = (
        layout.bisect(low_m, middle_m, some)?,
        layout.bisect(high_m, middle_m, some)?,
    );
    let (Some(first_m), Some(last_m)) = (first, last) else {
        return Err(narrow(&layout.stations(&sections.graph(middle_m))?));
    };
    let first_m = outer(&layout, &sections, first_m, middle_m)?;
    let last_m = outer(&layout, &sections, last_m, middle_m)?;
    let at_m = evenly(|share| sections.laid(&layout, [first_m, last_m], share))?;
    let mut lines = Vec::new();
    for (k, c_m) in at_m.into_iter().enumerate() {
        lines.extend(pieces(c_m, k % 2 == 1)?);
    }
    Ok(lines)
}

/// A patch and the planes that cut it.
pub(super) struct Sections<'a> {
    surface: &'a dyn Surface,
    normal: &'a Unit<Vector3<f64>>,
    /// Least and greatest distance of the patch from the plane through the origin, m.
    range_m: [f64; 2],
}

impl<'a> Sections<'a> {
    /// # Errors
    /// If a plane runs along v somewhere, so that its section is no graph over u.
    fn new(
        surface: &'a dyn Surface,
        normal: &'a Unit<Vector3<f64>>,
    ) -> Result<Self, SurfacePathError> {
        let Domain { u, v } = surface.domain();
        let place = |range: [f64; 2], k: usize| {
            range[0] + (range[1] - range[0]) * k as f64 / (CHECKED - 1) as f64
        };
        let mut range_m = [f64::INFINITY, f64::NEG_INFINITY];
        let mut sign = 0.0;
        for k in 0..CHECKED * CHECKED {
            let at = [place(u, k / CHECKED), place(v, k % CHECKED)];
            let jet = surface.jet(at[0], at[1]);
            let rise = jet.first_m[1].dot(normal);
            if sign == 0.0 {
                sign = rise.signum();
            }
            if rise * sign <= 1e-6 * jet.first_m[1].norm() {
                let point_m = jet.point_m;
                return Err(SurfacePathError::PlaneAlong { point_m });
            }
            let c_m = jet.point_m.dot(normal);
            range_m = [range_m[0].min(c_m), range_m[1].max(c_m)];
        }
        Ok(Self {
            surface,
            normal,
            range_m,
        })
    }

    /// v of the plane at a place; beyond the borders as if the patch went on straight.
    fn v(&self, u: f64, c_m: f64) -> f64 {
        let [low, high] = self.surface.domain().v;
        let excess = |v: f64| self.surface.point_m(u, v).dot(self.normal) - c_m;
        let [at_low, at_high] = [low, high].map(excess);
        let rising = at_high > at_low;
        for (border, at_border) in [(low, at_low), (high, at_high)] {
            let beyond = (at_border > 0.0) == (rising == (border == low));
            if beyond && at_border != 0.0 {
                let rise = self.surface.jet(u, border).first_m[1].dot(self.normal);
                return border - at_border / rise;
            }
        }
        let [a, b] = bisect([low, high], BISECTIONS, |v| (excess(v) > 0.0) == rising);
        0.5 * (a + b)
    }

    pub fn graph(&self, c_m: f64) -> GraphLine {
        let range = self.surface.domain().u;
        let u = |k: usize| range[0] + (range[1] - range[0]) * k as f64 / STATIONS as f64;
        let v: Vec<f64> = (0..=STATIONS).map(|k| self.v(u(k), c_m)).collect();
        let slope = v.iter().enumerate().map(|(k, v)| {
            let [ru, rv] = self.surface.jet(u(k), *v).first_m;
            -ru.dot(self.normal) / rv.dot(self.normal)
        });
        let slope = slope.collect();
        GraphLine::with_slopes(range, v, slope)
    }

    /// Distances of planes, each gap a share of what is allowed.
    fn laid(
        &self,
        layout: &Layout<'_>,
        [first_m, last_m]: [f64; 2],
        share: f64,
    ) -> Result<Laid<f64>, SurfacePathError> {
        let whole_m = self.range_m[1] - self.range_m[0];
        let mut laid = Laid {
            lines: vec![first_m],
            last_gap: share,
        };
        let mut c_m = first_m;
        while last_m - c_m > 1e-6 * whole_m {
            let here_m = self.apart_m(layout, c_m)?;
            let mut next_m = (c_m + share * here_m).min(last_m);
            // The next section may allow less than this one.
            let mut both_m = here_m;
            for _ in 0..8 {
                both_m = 0.5 * (here_m + self.apart_m(layout, next_m)?);
                next_m = next_m.min(c_m + share * both_m);
            }
            if next_m - c_m < 1e-9 * whole_m {
                return Err(narrow(&layout.stations(&self.graph(c_m))?));
            }
            if next_m < last_m {
                check_distance((next_m - c_m) / whole_m)?;
            }
            laid.last_gap = (next_m - c_m) / both_m;
            laid.lines.push(next_m);
            c_m = next_m;
        }
        Ok(laid)
    }

    /// Distance to the next plane that a section allows: the swath, less the overlap, times the
    /// share of the normal that lies in the surface, at the place where that is least, m.
    pub fn apart_m(&self, layout: &Layout<'_>, c_m: f64) -> Result<f64, SurfacePathError> {
        let [low, high] = self.surface.domain().v;
        let mut least_m = f64::INFINITY;
        for contact in layout.stations(&self.graph(c_m))? {
            if !(low..=high).contains(&contact.v) {
                continue;
            }
            let jet = self.surface.jet(contact.u, contact.v);
            let forms = Forms::at(&jet, contact.u, contact.v)?;
            let across = forms.normal.dot(self.normal);
            let share = (1.0 - across * across).max(0.0).sqrt();
            least_m = least_m.min(contact.swath_m * share * (1.0 - layout.options.overlap));
        }
        Ok(if least_m.is_finite() { least_m } else { 0.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::PlanePatch;
    use crate::surface::cylinder::CylinderPatch;
    use crate::surface::spoke::Spoke;
    use crate::surface_path::wheel::tests::PUBLISHED;
    use crate::surface_path::{AxisRule, FeedAlong, PathOptions, Strategy, plan_path};

    const OPTIONS: PathOptions = PathOptions {
        rule: AxisRule::WidestSwath {
            edge_gap_limit_m: 1e-3,
        },
        overlap: 0.0,
        step_m: 2e-3,
        margin_m: 0.0,
    };

    fn planned(
        surface: &dyn Surface,
        normal: Vector3<f64>,
        boundary: Option<&Boundary>,
    ) -> Vec<Vec<Contact>> {
        let normal = Unit::new_normalize(normal);
        let strategy = Strategy::ParallelPlane {
            normal,
            along_borders: false,
        };
        let path = plan_path(
            surface,
            boundary,
            &PUBLISHED,
            strategy,
            FeedAlong::U,
            &OPTIONS,
        );
        path.expect("a path").lines
    }

    fn plane() -> PlanePatch {
        PlanePatch::new(Vector3::zeros(), Vector3::x() * 0.1, Vector3::y() * 0.06).expect("a plane")
    }

    /// All points of a line lie in its plane, on a face cut askew too.
    #[test]
    fn verify_points_lie_in_parallel_planes() {
        let normal = Vector3::new(0.25, 1.0, 0.1);
        for line in planned(&Spoke, normal, None) {
            let c = |contact: &Contact| contact.point_m.dot(&normal) / normal.norm();
            let first = c(&line[0]);
            for contact in &line {
                assert!((c(contact) - first).abs() < 2e-6, "{}", c(contact) - first);
            }
        }
    }

    /// On a plane cut along its side lines stand evenly, a swath apart at most; on a round bar
    /// planes across the chord stand the same share of swath · cos φ apart, at the mean of both
    /// lines, so that no strip is left.
    #[test]
    fn verify_planes_stand_as_far_apart_as_the_swath_seen_along_them() {
        let lines = planned(&plane(), Vector3::y(), None);
        let y: Vec<f64> = lines.iter().map(|line| line[0].point_m.y).collect();
        let swath_m = lines[0][0].swath_m;
        assert_eq!(y.len(), ((0.06 - swath_m) / swath_m).ceil() as usize + 1);
        for pair in y.windows(2) {
            let even_m = (y[y.len() - 1] - y[0]) / (y.len() - 1) as f64;
            assert!(((pair[1] - pair[0]) / even_m - 1.0).abs() < 0.01, "{y:?}");
        }
        assert!((y[0] - 0.5 * swath_m).abs() < 1e-5, "{y:?}");
        let bar = CylinderPatch::new(
            Vector3::zeros(),
            Unit::new_normalize(Vector3::x()),
            Unit::new_normalize(Vector3::z()),
            0.1,
            [-0.9, 0.9],
            0.15,
        );
        let lines = planned(&bar, Vector3::y(), None);
        let places: Vec<[f64; 2]> = lines
            .iter()
            .map(|line| {
                let p = line[line.len() / 2].point_m;
                [p.y, p.y.atan2(p.z)]
            })
            .collect();
        assert!(places.len() > 4, "{places:?}");
        let swath_m = lines[0][0].swath_m;
        let share = |pair: &[[f64; 2]]| {
            let [[y0, a0], [y1, a1]] = [pair[0], pair[1]];
            (y1 - y0).abs() / (0.5 * swath_m * (a0.cos() + a1.cos()))
        };
        let shares: Vec<f64> = places.windows(2).map(share).collect();
        for share in &shares {
            // Lines differ by what axes nearly as wide as the widest give away.
            assert!(*share < 1.03 && share / shares[0] > 0.97, "{shares:?}");
        }
        let fewer = shares.len() as f64 - 1.0;
        assert!(shares[0] * (fewer + 1.0) > 0.97 * fewer, "{shares:?}");
    }

    /// Lines end where the contact would lie over the boundary, and a notch cuts them in two.
    #[test]
    fn verify_a_notch_cuts_lines_in_two() {
        let corners = [
            [0.0, 0.0],
            [100.0, 0.0],
            [100.0, 60.0],
            [60.0, 60.0],
            [60.0, 30.0],
            [40.0, 30.0],
            [40.0, 60.0],
            [0.0, 60.0],
            [0.0, 0.0],
        ];
        let points: Vec<_> = corners
            .iter()
            .map(|[x, y]| Vector3::new(*x, *y, 0.0) * 1e-3)
            .collect();
        let notched = Boundary::new(&points).expect("a boundary");
        let lines = planned(&plane(), Vector3::y(), Some(&notched));
        let whole = planned(&plane(), Vector3::y(), None);
        assert!(lines.len() > whole.len(), "{} {}", lines.len(), whole.len());
        let mut in_two = 0;
        for line in &lines {
            for contact in line {
                let axes = [
                    contact.feed.into_inner(),
                    contact.normal.cross(&contact.feed),
                ];
                let half_m = [0.5 * contact.reach_m - 1e-6, 0.5 * contact.swath_m - 1e-6];
                assert!(notched.holds_rectangle(&contact.point_m, axes, half_m));
            }
            let ends = [line[0], line[line.len() - 1]].map(|c| c.point_m.x);
            if ends[0].max(ends[1]) < 0.04 {
                in_two += 1;
                // The contact ends at the notch: half its reach before 40 mm.
                let expected_m = 0.04 - 0.5 * line[0].reach_m;
                assert!((ends[0].max(ends[1]) - expected_m).abs() < 1e-6, "{ends:?}");
            }
        }
        assert!(in_two > 0);
    }

    #[test]
    fn planes_along_the_face_are_refused() {
        let normal = Unit::new_normalize(Vector3::z());
        let strategy = Strategy::ParallelPlane {
            normal,
            along_borders: false,
        };
        let refused = plan_path(&plane(), None, &PUBLISHED, strategy, FeedAlong::U, &OPTIONS);
        let told = refused.expect_err("planes along the face").to_string();
        assert!(told.contains("along the face"), "{told}");
    }
}
