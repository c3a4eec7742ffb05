//! How lines are laid on a face: iso-parametric lines here, others beside.

use nalgebra::Isometry3;

use super::contact::Contact;
use super::error::SurfacePathError;
use super::graph::{GraphLine, Turned};
use super::layout::{Layout, STATIONS, check_distance, narrow};
use super::options::{FeedAlong, PathOptions, Strategy};
use super::wheel::ContactWheel;
use super::{planes, scallop};
use crate::bounds::OutOfBounds;
use crate::surface::{Boundary, Surface};

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
        Strategy::ParallelPlane { normal } => planes::along_v(surface, &normal),
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
        Strategy::ParallelPlane { normal } => planes::lines(&layout, &normal)?,
    };
    if lines.is_empty() {
        let [low, high] = layout.surface.domain().v;
        return Err(narrow(
            &layout.stations(&layout.constant(0.5 * (low + high)))?,
        ));
    }
    if across {
        for contact in lines.iter_mut().flatten() {
            [contact.u, contact.v] = turned.back([contact.u, contact.v]);
        }
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
/// place where that is least; the distance is measured across the feed, √(EG − F²)/√E for a step of
/// v, which is |r_v| only where r_u and r_v are square. The first and last line keep half their
/// swath and the margin from the borders, and each line half its reach from its ends.
fn iso_parametric(layout: &Layout<'_>) -> Result<Vec<Vec<Contact>>, SurfacePathError> {
    let [low, high] = layout.surface.domain().v;
    let [first, last] = layout.outermost()?;
    let mut places = vec![first];
    let mut v = first;
    while v < last {
        let line = layout.stations(&layout.constant(v))?;
        // Too far apart from here on; where even the last line is near enough it is the next.
        let beyond = layout.bisect(v, last, |next| Ok(!joined(layout, &line, next)?))?;
        let next = beyond.unwrap_or(last);
        if next - v < 1e-9 * (high - low) {
            return Err(narrow(&line));
        }
        if next < last {
            check_distance((next - v) / (last - first))?;
        }
        places.push(next);
        v = next;
    }
    let graphs = places.iter().map(|v| layout.constant(*v));
    to_and_fro(layout, graphs)
}

/// Courses from end to end, every other one backwards.
fn to_and_fro(
    layout: &Layout<'_>,
    graphs: impl Iterator<Item = GraphLine>,
) -> Result<Vec<Vec<Contact>>, SurfacePathError> {
    let mut lines = Vec::new();
    for (k, graph) in graphs.enumerate() {
        lines.extend(layout.pieces(&graph, k % 2 == 1, &[true; STATIONS + 1])?);
    }
    Ok(lines)
}

/// Whether a line and one further on leave nothing between them.
fn joined(layout: &Layout<'_>, line: &[Contact], next: f64) -> Result<bool, SurfacePathError> {
    let other = layout.stations(&layout.constant(next))?;
    for (a, b) in line.iter().zip(&other) {
        let covered_m = 0.5 * (a.swath_m + b.swath_m) * (1.0 - layout.options.overlap);
        if layout.path_m(a.u, 0.0, a.v, next)? > covered_m {
            return Ok(false);
        }
    }
    Ok(true)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::PlanePatch;
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

    /// Every place between two lines is covered by one of them, with no line nearer than it need be
    /// at its tightest place.
    #[test]
    fn verify_lines_on_the_spoke_leave_no_gap_and_waste_none() {
        let path = planned(&Spoke, &OPTIONS).expect("a path");
        let plan = Layout {
            surface: &Spoke,
            boundary: None,
            wheel: &PUBLISHED,
            options: &OPTIONS,
        };
        let places: Vec<f64> = path.lines.iter().map(|line| line[0].v).collect();
        assert!(places.len() > 3, "{places:?}");
        for (k, pair) in places.windows(2).enumerate() {
            let [one, other] =
                [pair[0], pair[1]].map(|v| plan.stations(&plan.constant(v)).expect("a line"));
            let uses = one.iter().zip(&other).map(|(a, b)| {
                let path_m = plan.path_m(a.u, 0.0, a.v, b.v).expect("a distance");
                path_m / (0.4 * (a.swath_m + b.swath_m))
            });
            let used = uses.fold(0.0, f64::max);
            assert!(used < 1.0 + 1e-6, "line {k}: {used}");
            assert!(
                used > 1.0 - 1e-6 || k + 2 == places.len(),
                "line {k}: {used}"
            );
        }
        for pair in path.lines.windows(2) {
            let first = |k: usize| pair[k][0];
            // Fed to and fro, the axis points to the same side of the face.
            assert!(first(0).axis.dot(&first(1).axis) > 0.5);
            assert!(first(0).feed.dot(&first(1).feed) < 0.0);
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
    /// turned to the diagonal of its contact at most, and first and last line stand half a swath
    /// from the borders.
    #[test]
    fn verify_lines_on_a_plane_stand_a_swath_apart() {
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
        let expected = [12.5, 37.5, 47.5];
        assert_eq!(y.len(), 3, "{y:?}");
        assert!(
            y.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6),
            "{y:?}"
        );
        let narrow = PlanePatch::new(Vector3::zeros(), Vector3::x() * 0.1, Vector3::y() * 0.024)
            .expect("a plane");
        let told = planned(&narrow, &options).expect_err("narrow");
        assert!(told.to_string().contains("25.000 mm wide"), "{told}");
    }
}
