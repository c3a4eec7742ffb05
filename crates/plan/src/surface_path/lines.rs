//! How lines are laid on a face: iso-parametric lines here, others beside.

use nalgebra::Isometry3;
use truecut_core::roots::illinois;

use super::contact::Contact;
use super::error::SurfacePathError;
use super::graph::{GraphLine, Turned};
use super::layout::{Layout, STATIONS, check_distance, narrow};
use super::options::{FeedAlong, PathOptions, Strategy};
use super::spacing::{Laid, evenly};
use super::wheel::ContactWheel;
use super::{borders, planes, scallop};
use crate::bounds::OutOfBounds;
use crate::surface::{Boundary, Surface};

/// Part of what is allowed to which the distance of two lines is found.
const SAME: f64 = 1e-10;

/// Lines of contacts, fed to and fro.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfacePath {
    pub lines: Vec<Vec<Contact>>,
}

impl SurfacePath {
    /// Poses of the tool along each line, with one lifted along the normal before and after; the
    /// arm moves freely from line to line.
    #[must_use]
    pub fn poses(&self, lift_m: f64) -> Vec<Vec<Isometry3<f64>>> {
        let lifted = |contact: &Contact| {
            let mut pose = contact.pose();
            pose.translation.vector += contact.normal.into_inner() * lift_m;
            pose
        };
        let line = |line: &Vec<Contact>| {
            let ends = [line.first().map(lifted), line.last().map(lifted)];
            let between = line.iter().map(Contact::pose);
            ends[0].into_iter().chain(between).chain(ends[1]).collect()
        };
        self.lines.iter().map(line).collect()
    }
}

/// Lines on a patch, within its boundary if it has one, fed to and fro. A line that leaves the
/// boundary is cut there and goes on where it comes back; between its pieces the wheel is lifted as
/// between lines.
///
/// # Errors
/// If an option is out of its range, the wheel gouges or finds no axis somewhere, the face is too
/// narrow for the contact, or planes do not cross the patch from border to border.
pub fn plan_path(
    surface: &dyn Surface,
    boundary: Option<&Boundary>,
    wheel: &ContactWheel,
    strategy: Strategy,
    feed_along: FeedAlong,
    options: &PathOptions,
) -> Result<SurfacePath, SurfacePathError> {
    check(wheel, strategy, options)?;
    let turned = Turned(surface);
    let across = match strategy {
        Strategy::ParallelPlane { normal, .. } => planes::along_v(surface, &normal),
        _ => feed_along == FeedAlong::V,
    };
    let layout = Layout {
        surface: if across { &turned } else { surface },
        boundary,
        wheel,
        options,
    };
    let mut lines = match strategy {
        Strategy::IsoParametric => iso_parametric(&layout)?,
        Strategy::IsoScallop { scallop_m } => scallop::lines(&layout, scallop_m)?,
        Strategy::ParallelPlane { normal, .. } => planes::lines(&layout, &normal)?,
    };
    if lines.is_empty() {
        let [low, high] = layout.surface.domain().v;
        return Err(narrow(
            &layout.stations(&layout.constant(0.5 * (low + high)))?,
        ));
    }
    if across {
        turned.all_back(&mut lines);
    }
    if let Strategy::ParallelPlane {
        along_borders: true,
        ..
    } = strategy
    {
        lines.extend(borders::lines(&Layout { surface, ..layout })?);
    }
    Ok(SurfacePath { lines })
}

fn check(
    wheel: &ContactWheel,
    strategy: Strategy,
    options: &PathOptions,
) -> Result<(), SurfacePathError> {
    wheel.check()?;
    let scallop_m = match strategy {
        Strategy::IsoScallop { scallop_m } => scallop_m,
        _ => f64::MIN_POSITIVE,
    };
    let rules = [
        (
            "the overlap",
            options.overlap,
            (0.0..1.0).contains(&options.overlap),
            "from 0 to below 1",
        ),
        (
            "the step along a line (m)",
            options.step_m,
            options.step_m > 0.0,
            "above 0",
        ),
        (
            "the margin (m)",
            options.margin_m,
            options.margin_m >= 0.0,
            "at least 0",
        ),
        (
            "the height of the ridges (m)",
            scallop_m,
            scallop_m > 0.0,
            "above 0",
        ),
    ];
    for (quantity, value, good, rule) in rules {
        OutOfBounds::unless(good && value.is_finite(), quantity, value, rule)?;
    }
    Ok(())
}

/// Lines v = const, fed along u and back in turn.
///
/// Two neighbours stand as far apart as half the swath of each covers, less the overlap, at the
/// place where that is least, or as one share of that, the same for all, with which the last line
/// comes out; the distance is measured across the feed, √(EG − F²)/√E for a step of v, which is
/// |r_v| only where r_u and r_v are square. The first and last line keep half their swath and the
/// margin from the borders, and each line half its reach from its ends.
fn iso_parametric(layout: &Layout<'_>) -> Result<Vec<Vec<Contact>>, SurfacePathError> {
    let ends = layout.outermost()?;
    let places = evenly(|share| places(layout, ends, share))?;
    let graphs = places.iter().map(|v| layout.constant(*v));
    to_and_fro(layout, graphs)
}

/// Places of lines v = const, each gap a share of what is allowed.
fn places(
    layout: &Layout<'_>,
    [first, last]: [f64; 2],
    share: f64,
) -> Result<Laid<f64>, SurfacePathError> {
    let [low, high] = layout.surface.domain().v;
    let (mut lines, mut last_gap) = (vec![first], share);
    let mut v = first;
    while last - v > 1e-9 * (high - low) {
        let line = layout.stations(&layout.constant(v))?;
        let to_last = taken(layout, &line, last)?;
        // Where even the last line is near enough it is the next.
        let next = if to_last > share {
            farthest(layout, &line, [v, last], [share, to_last])?
        } else {
            last_gap = to_last;
            last
        };
        if next - v < 1e-9 * (high - low) {
            return Err(narrow(&line));
        }
        if next < last {
            check_distance((next - v) / (last - first))?;
        }
        lines.push(next);
        v = next;
    }
    Ok(Laid { lines, last_gap })
}

/// Courses from end to end, every other one backwards.
pub(super) fn to_and_fro(
    layout: &Layout<'_>,
    graphs: impl Iterator<Item = GraphLine>,
) -> Result<Vec<Vec<Contact>>, SurfacePathError> {
    let mut lines = Vec::new();
    for (k, graph) in graphs.enumerate() {
        lines.extend(layout.pieces(&graph, k % 2 == 1, &[true; STATIONS + 1])?);
    }
    Ok(lines)
}

/// How far from a line, on the way from it to the last, a line may stand that takes no more than a
/// share of what is allowed; the last one takes more.
fn farthest(
    layout: &Layout<'_>,
    line: &[Contact],
    [v, last]: [f64; 2],
    [share, to_last]: [f64; 2],
) -> Result<f64, SurfacePathError> {
    let (mut reached, mut refused) = (0.0_f64, None);
    illinois([0.0, 1.0], [share, share - to_last], SAME, |way| {
        let left = match taken(layout, line, v + way * (last - v)) {
            Ok(taken) => share - taken,
            Err(error) => {
                refused = Some(error);
                0.0
            }
        };
        if left >= -SAME {
            reached = reached.max(way);
        }
        left
    });
    refused.map_or(Ok(v + reached * (last - v)), Err)
}

/// The distance of a line and one further on as a part of what both cover, where that is most; up
/// to 1 they leave nothing between them.
fn taken(layout: &Layout<'_>, line: &[Contact], next: f64) -> Result<f64, SurfacePathError> {
    let other = layout.stations(&layout.constant(next))?;
    let mut most = 0.0_f64;
    for (a, b) in line.iter().zip(&other) {
        let covered_m = 0.5 * (a.swath_m + b.swath_m) * (1.0 - layout.options.overlap);
        most = most.max(layout.path_m(a.u, 0.0, a.v, next)? / covered_m);
    }
    Ok(most)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::PlanePatch;
    use crate::surface::drawn::{self, seeded};
    use crate::surface::spoke::Spoke;
    use crate::surface_path::AxisRule;
    use crate::surface_path::wheel::tests::PUBLISHED;
    use nalgebra::Vector3;

    const OPTIONS: PathOptions = PathOptions {
        rule: AxisRule::WidestSwath {
            edge_gap_limit_m: 0.5e-3,
        },
        overlap: 0.2,
        step_m: 1e-3,
        margin_m: 0.0,
    };

    fn planned(
        surface: &dyn Surface,
        options: &PathOptions,
    ) -> Result<SurfacePath, SurfacePathError> {
        let strategy = Strategy::IsoParametric;
        plan_path(surface, None, &PUBLISHED, strategy, FeedAlong::U, options)
    }

    /// What each gap takes of what its two lines cover, where that is most.
    fn taken_by(surface: &dyn Surface, options: &PathOptions, path: &SurfacePath) -> Vec<f64> {
        let (boundary, wheel) = (None, &PUBLISHED);
        let layout = Layout {
            surface,
            boundary,
            wheel,
            options,
        };
        let gap = |pair: &[Vec<Contact>]| {
            let line = layout.stations(&layout.constant(pair[0][0].v));
            taken(&layout, &line.expect("a line"), pair[1][0].v).expect("a distance")
        };
        path.lines.windows(2).map(gap).collect()
    }

    /// All of the same share to 1 %, none above 1, and one line less would be too few.
    fn assert_even(shares: &[f64], what: &str) {
        let least = shares.iter().copied().fold(f64::INFINITY, f64::min);
        let most = shares.iter().copied().fold(0.0, f64::max);
        assert!(
            most <= 1.0 + 1e-6 && least > 0.99 * most,
            "{what}: {shares:?}"
        );
        let fewer = shares.len() as f64 - 1.0;
        assert!(most * (fewer + 1.0) > 0.99 * fewer, "{what}: {shares:?}");
    }

    /// Parallelograms and wheels drawn at random: lines stand evenly in mm, no further apart than
    /// the swath less the overlap.
    #[test]
    fn verify_lines_on_drawn_planes_share_the_width_evenly() {
        for seed in 0..20 {
            let sides = (0.03..0.3_f64, -0.1..0.1_f64, 0.0..0.5_f64);
            let (high_m, slant_m, overlap) = seeded(seed, &sides);
            let (along, up) = (Vector3::x() * 0.2, Vector3::new(slant_m, high_m, 0.0));
            let plane = PlanePatch::new(Vector3::zeros(), along, up).expect("a plane");
            let options = PathOptions {
                rule: AxisRule::LeastCurvature,
                overlap,
                ..OPTIONS
            };
            let path = planned(&plane, &options).expect("a path");
            let places = path.lines.iter().map(|line| line[0].point_m.y);
            let places: Vec<f64> = places.collect();
            let swath_m = path.lines[0][0].swath_m;
            assert!((places[0] - 0.5 * swath_m).abs() < 1e-9, "seed {seed}");
            let end_m = places[places.len() - 1];
            assert!((high_m - end_m - 0.5 * swath_m).abs() < 1e-9, "seed {seed}");
            let allowed_m = swath_m * (1.0 - overlap);
            let shares = places.windows(2).map(|p| (p[1] - p[0]) / allowed_m);
            let shares: Vec<f64> = shares.collect();
            let needed = ((end_m - places[0]) / allowed_m - 1e-9).ceil() as usize;
            assert_eq!(shares.len(), needed, "seed {seed}: {places:?}");
            assert_even(&shares, &format!("seed {seed}"));
        }
    }

    /// The same share of what is allowed everywhere, on curved patches drawn at random.
    #[test]
    fn verify_lines_on_drawn_patches_share_the_width_evenly() {
        for seed in 0..10 {
            let patch = drawn::patch(&drawn::heights(seed), 6e-3, 0.0);
            let options = PathOptions {
                rule: AxisRule::WidestSwath {
                    edge_gap_limit_m: 2e-3,
                },
                ..OPTIONS
            };
            let path = planned(&patch, &options).expect("a path");
            let shares = taken_by(&patch, &options, &path);
            assert!(shares.len() > 2, "{shares:?}");
            assert_even(&shares, &format!("seed {seed}"));
        }
    }

    /// Every place between two lines is covered by one of them, with no line nearer than it need be
    /// at its tightest place.
    #[test]
    fn verify_lines_on_the_spoke_leave_no_gap_and_waste_none() {
        let path = planned(&Spoke, &OPTIONS).expect("a path");
        let shares = taken_by(&Spoke, &OPTIONS, &path);
        assert!(shares.len() > 3, "{shares:?}");
        assert_even(&shares, "the spoke");
        for pair in path.lines.windows(2) {
            let (end, next) = (pair[0][pair[0].len() - 1], pair[1][0]);
            // Fed to and fro, the axis points to the same side of the face.
            assert!(end.axis.dot(&next.axis) > 0.5);
            assert!(end.feed.dot(&next.feed) < 0.0);
        }
        for line in &path.lines {
            assert!(
                line.windows(2)
                    .all(|w| (w[1].point_m - w[0].point_m).norm() < 1.02e-3)
            );
            assert!(
                line.windows(2).all(|w| w[0].axis.dot(&w[1].axis) > 0.99),
                "the axis never flips"
            );
        }
    }

    /// On the mould block's top the axis stands across the feed, the swath is that of the wheel
    /// turned to the diagonal of its contact at most, first and last line stand half a swath from
    /// the borders, and the others share what is between them.
    #[test]
    fn verify_lines_on_a_plane_stand_evenly_within_half_a_swath_of_its_borders() {
        let plane = PlanePatch::new(Vector3::zeros(), Vector3::x() * 0.1, Vector3::y() * 0.06)
            .expect("a plane");
        let options = PathOptions {
            rule: AxisRule::LeastCurvature,
            overlap: 0.0,
            ..OPTIONS
        };
        let path = planned(&plane, &options).expect("a path");
        let y: Vec<f64> = path
            .lines
            .iter()
            .map(|line| line[0].point_m.y * 1e3)
            .collect();
        let expected = [12.5, 30.0, 47.5];
        assert_eq!(y.len(), 3, "{y:?}");
        assert!(
            y.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-4),
            "{y:?}"
        );
        let narrow = PlanePatch::new(Vector3::zeros(), Vector3::x() * 0.1, Vector3::y() * 0.024)
            .expect("a plane");
        let told = planned(&narrow, &options).expect_err("narrow");
        assert!(told.to_string().contains("25.000 mm wide"), "{told}");
    }
}
