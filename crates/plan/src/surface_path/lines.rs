//! Iso-parametric paths whose spacing follows the effective swath.

use nalgebra::Isometry3;

use super::contact::{AxisRule, Contact};
use super::error::SurfacePathError;
use super::wheel::ContactWheel;
use crate::surface::{Forms, Surface};

/// Places along a line at which widths and distances are compared.
const STATIONS: usize = 64;

/// Steps of the trapezoidal rule by which the way from one line to another is measured.
const WAY_STEPS: usize = 8;

/// Bisections of a parameter range: to 1e-12 of it.
const BISECTIONS: usize = 40;

/// How a path covers a face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathOptions {
    pub rule: AxisRule,
    /// Share of the swath that the next line covers again, 0 to below 1.
    pub overlap: f64,
    /// Largest distance of points along a line, m.
    pub step_m: f64,
    /// Distance that the contact keeps from the borders of the patch, m.
    pub margin_m: f64,
}

/// Lines of contacts, fed to and fro.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfacePath {
    pub lines: Vec<Vec<Contact>>,
}

impl SurfacePath {
    /// Poses of the tool along each line, with one lifted along the normal before and after; the arm moves freely from line to line.
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

/// Lines v = const, fed along u and back in turn.
///
/// Two neighbours stand as far apart as half the swath of each covers, less the overlap, at the place where that is least; the
/// distance is measured across the feed, √(EG − F²)/√E for a step of v, which is |r_v| only where r_u and r_v are square. The first
/// and last line keep half their swath and the margin from the borders, and each line half its reach from its ends.
///
/// # Errors
/// If an option is out of its range, the wheel gouges or finds no axis somewhere, or the patch is too narrow for the contact.
pub fn plan_iso_parametric(
    surface: &dyn Surface,
    wheel: &ContactWheel,
    options: &PathOptions,
) -> Result<SurfacePath, SurfacePathError> {
    wheel.check()?;
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
    ];
    for (quantity, value, good, rule) in rules {
        if !good || !value.is_finite() {
            return Err(SurfacePathError::OutOfBounds {
                quantity,
                value,
                rule,
            });
        }
    }
    let plan = Plan {
        surface,
        wheel,
        options,
    };
    let [low, high] = surface.domain().v;
    let narrow = |line: &[Contact]| SurfacePathError::WiderThanFace {
        swath_mm: line.iter().map(|c| c.swath_m).fold(0.0, f64::max) * 1e3,
    };
    let [first, last] = [(low, high), (high, low)]
        .map(|(border, other)| plan.bisect(border, other, |v| plan.clear_of(border, v)));
    let (first, last) = match (first?, last?) {
        (Some(first), Some(last)) if first <= last => (first, last),
        _ => return Err(narrow(&plan.stations(0.5 * (low + high))?)),
    };
    let mut places = vec![first];
    let mut v = first;
    while v < last {
        let line = plan.stations(v)?;
        // Too far apart from here on; where even the last line is near enough it is the next.
        let beyond = plan.bisect(v, last, |next| Ok(!plan.joined(&line, next)?))?;
        let next = beyond.unwrap_or(last);
        if next - v < 1e-9 * (high - low) {
            return Err(narrow(&line));
        }
        places.push(next);
        v = next;
    }
    let lines = places.iter().enumerate();
    let lines = lines
        .map(|(k, v)| plan.line(*v, k % 2 == 1))
        .collect::<Result<_, _>>()?;
    Ok(SurfacePath { lines })
}

struct Plan<'a> {
    surface: &'a dyn Surface,
    wheel: &'a ContactWheel,
    options: &'a PathOptions,
}

impl Plan<'_> {
    /// The first parameter, on the way from one to another, at which a condition holds that holds from there on.
    fn bisect(
        &self,
        from: f64,
        to: f64,
        holds: impl Fn(f64) -> Result<bool, SurfacePathError>,
    ) -> Result<Option<f64>, SurfacePathError> {
        if !holds(to)? {
            return Ok(None);
        }
        let (mut before, mut after) = (from, to);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (before + after);
            if holds(middle)? {
                after = middle;
            } else {
                before = middle;
            }
        }
        Ok(Some(after))
    }

    /// Contacts at even parameters along a line, borders included.
    fn stations(&self, v: f64) -> Result<Vec<Contact>, SurfacePathError> {
        let [low, high] = self.surface.domain().u;
        let u = |k: usize| low + (high - low) * k as f64 / STATIONS as f64;
        self.contacts(v, (0..=STATIONS).map(u), 1.0)
    }

    fn contacts(
        &self,
        v: f64,
        places: impl Iterator<Item = f64>,
        direction: f64,
    ) -> Result<Vec<Contact>, SurfacePathError> {
        let mut contacts: Vec<Contact> = Vec::new();
        for u in places {
            let before = contacts.last().map(|c| &c.axis);
            let (rule, feed) = (self.options.rule, [direction, 0.0]);
            contacts.push(Contact::at(
                self.surface,
                self.wheel,
                rule,
                [u, v],
                feed,
                before,
            )?);
        }
        Ok(contacts)
    }

    /// Way across the feed from one line to another at a place, m.
    fn way_m(&self, u: f64, from: f64, to: f64) -> Result<f64, SurfacePathError> {
        let step = (to - from) / WAY_STEPS as f64;
        let mut way_m = 0.0;
        for k in 0..=WAY_STEPS {
            let v = from + step * k as f64;
            let [e, f, g] = Forms::at(&self.surface.jet(u, v), u, v)?.first_m2;
            let weight = if k == 0 || k == WAY_STEPS { 0.5 } else { 1.0 };
            way_m += weight * (g - f * f / e).max(0.0).sqrt() * step.abs();
        }
        Ok(way_m)
    }

    /// Whether a line keeps clear of a border along v everywhere.
    fn clear_of(&self, border: f64, v: f64) -> Result<bool, SurfacePathError> {
        for contact in self.stations(v)? {
            if self.way_m(contact.u, border, v)? < 0.5 * contact.swath_m + self.options.margin_m {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Whether a line and one further on leave nothing between them.
    fn joined(&self, line: &[Contact], next: f64) -> Result<bool, SurfacePathError> {
        let other = self.stations(next)?;
        for (a, b) in line.iter().zip(&other) {
            let covered_m = 0.5 * (a.swath_m + b.swath_m) * (1.0 - self.options.overlap);
            if self.way_m(a.u, a.v, next)? > covered_m {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// The contacts of a line, evenly spaced, its ends kept clear of the borders.
    fn line(&self, v: f64, backwards: bool) -> Result<Vec<Contact>, SurfacePathError> {
        let stations = self.stations(v)?;
        let mut along_m = vec![0.0];
        for pair in stations.windows(2) {
            let way_m =
                0.5 * (self.speed_m(&pair[0]) + self.speed_m(&pair[1])) * (pair[1].u - pair[0].u);
            along_m.push(along_m[along_m.len() - 1] + way_m);
        }
        let length_m = along_m[STATIONS];
        let inset_m = |c: &Contact| 0.5 * c.reach_m + self.options.margin_m;
        let begins = |k: &usize| along_m[*k] >= inset_m(&stations[*k]);
        let ends = |k: &usize| length_m - along_m[*k] >= inset_m(&stations[*k]);
        let (first, last) = ((0..=STATIONS).find(begins), (0..=STATIONS).rev().find(ends));
        let (Some(first), Some(last)) = (first, last) else {
            return Err(self.wide(&stations));
        };
        if first >= last {
            return Err(self.wide(&stations));
        }
        let way_m = along_m[last] - along_m[first];
        let count = (way_m / self.options.step_m).ceil().max(1.0) as usize;
        let place = |k: usize| {
            let k = if backwards { count - k } else { k };
            let at_m = along_m[first] + way_m * k as f64 / count as f64;
            let cell = along_m.partition_point(|a| *a <= at_m).clamp(1, STATIONS) - 1;
            let share = (at_m - along_m[cell]) / (along_m[cell + 1] - along_m[cell]);
            stations[cell].u + share * (stations[cell + 1].u - stations[cell].u)
        };
        // The axis keeps its sign from line to line, whichever way they are fed.
        self.contacts(
            v,
            (0..=count).map(place),
            if backwards { -1.0 } else { 1.0 },
        )
    }

    fn speed_m(&self, contact: &Contact) -> f64 {
        self.surface.jet(contact.u, contact.v).first_m[0].norm()
    }

    fn wide(&self, line: &[Contact]) -> SurfacePathError {
        let swath_m = line
            .iter()
            .map(|c| c.swath_m.max(c.reach_m))
            .fold(0.0, f64::max);
        SurfacePathError::WiderThanFace {
            swath_mm: swath_m * 1e3,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::PlanePatch;
    use crate::surface::spoke::Spoke;
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

    /// Every place between two lines is covered by one of them, with no line nearer than it need be at its tightest place.
    #[test]
    fn verify_lines_on_the_spoke_leave_no_gap_and_waste_none() {
        let path = plan_iso_parametric(&Spoke, &PUBLISHED, &OPTIONS).expect("a path");
        let plan = Plan {
            surface: &Spoke,
            wheel: &PUBLISHED,
            options: &OPTIONS,
        };
        let places: Vec<f64> = path.lines.iter().map(|line| line[0].v).collect();
        assert!(places.len() > 3, "{places:?}");
        for (k, pair) in places.windows(2).enumerate() {
            let [one, other] = [pair[0], pair[1]].map(|v| plan.stations(v).expect("a line"));
            let uses = one.iter().zip(&other).map(|(a, b)| {
                let way_m = plan.way_m(a.u, a.v, b.v).expect("a way");
                way_m / (0.4 * (a.swath_m + b.swath_m))
            });
            let used = uses.fold(0.0, f64::max);
            assert!(used < 1.0 + 1e-6, "line {k}: {used}");
            assert!(
                used > 1.0 - 1e-6 || k + 2 == places.len(),
                "line {k}: {used}"
            );
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

    /// On the mould block's top the axis stands across the feed, the swath is that of the wheel turned to the diagonal of its
    /// contact at most, and first and last line stand half a swath from the borders.
    #[test]
    fn verify_lines_on_a_plane_stand_a_swath_apart() {
        let plane = PlanePatch::new(Vector3::zeros(), Vector3::x() * 0.1, Vector3::y() * 0.06)
            .expect("a plane");
        let options = PathOptions {
            rule: AxisRule::LeastCurvature,
            overlap: 0.0,
            ..OPTIONS
        };
        let path = plan_iso_parametric(&plane, &PUBLISHED, &options).expect("a path");
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
        let told = plan_iso_parametric(&narrow, &PUBLISHED, &options).expect_err("narrow");
        assert!(told.to_string().contains("25.000 mm wide"), "{told}");
    }
}
