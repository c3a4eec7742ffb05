//! Contacts along lines: spacing, distances, and where lines end.

use super::contact::Contact;
use super::error::SurfacePathError;
use super::graph::GraphLine;
use super::options::PathOptions;
use super::wheel::ContactWheel;
use crate::surface::{Boundary, Forms, Surface};
use truecut_core::roots::{bisect, try_bisect};

/// Places along a line at which widths and distances are compared.
pub(super) const STATIONS: usize = 64;

/// Steps of the trapezoidal rule by which the way from one line to another is measured.
const WAY_STEPS: usize = 8;

/// Most contacts of a line, and most lines: more take longer than anyone would wait, and more than
/// memory holds.
const MOST_CONTACTS: usize = 100_000;
const MOST_LINES: usize = 2_000;

/// Refuses lines whose distance is so small a part of the face.
pub(super) fn check_distance(part: f64) -> Result<(), SurfacePathError> {
    if part * MOST_LINES as f64 >= 1.0 {
        return Ok(());
    }
    Err(SurfacePathError::TooClose {
        part,
        most: MOST_LINES,
    })
}

/// Bisections of a parameter range: to 1e-12 of it.
const BISECTIONS: usize = 40;

/// Bisections of one interval between stations: to 1e-6 of it.
const END_BISECTIONS: usize = 20;

/// A face, a wheel, and how one is led over the other.
pub(super) struct Layout<'a> {
    pub surface: &'a dyn Surface,
    /// Lines are cut where the contact would lie over it.
    pub boundary: Option<&'a Boundary>,
    pub wheel: &'a ContactWheel,
    pub options: &'a PathOptions,
}

impl Layout<'_> {
    /// The first parameter, on the way from one to another, at which a condition holds that holds
    /// from there on.
    pub fn bisect(
        &self,
        from: f64,
        to: f64,
        holds: impl Fn(f64) -> Result<bool, SurfacePathError>,
    ) -> Result<Option<f64>, SurfacePathError> {
        if !holds(to)? {
            return Ok(None);
        }
        let [_, first] = try_bisect([from, to], BISECTIONS, holds)?;
        Ok(Some(first))
    }

    /// The line v = const.
    pub fn constant(&self, v: f64) -> GraphLine {
        GraphLine::constant(self.surface.domain().u, STATIONS, v)
    }

    /// Contacts at even parameters along a line, borders included.
    pub fn stations(&self, graph: &GraphLine) -> Result<Vec<Contact>, SurfacePathError> {
        self.contacts(graph, (0..=STATIONS).map(|k| graph.u(k)))
    }

    fn contacts(
        &self,
        graph: &GraphLine,
        places: impl Iterator<Item = f64>,
    ) -> Result<Vec<Contact>, SurfacePathError> {
        let line = places.map(|u| {
            let [v, slope] = graph.at(u);
            [[u, v], [1.0, slope]]
        });
        Contact::along(self.surface, self.wheel, self.options.rule, line)
    }

    /// Way across a feed along (1, slope) from one v to another at a place, m.
    pub fn path_m(&self, u: f64, slope: f64, from: f64, to: f64) -> Result<f64, SurfacePathError> {
        let step = (to - from) / WAY_STEPS as f64;
        let mut path_m = 0.0;
        for k in 0..=WAY_STEPS {
            let v = from + step * k as f64;
            let [e, f, g] = Forms::at(&self.surface.jet(u, v), u, v)?.first_m2;
            let weight = if k == 0 || k == WAY_STEPS { 0.5 } else { 1.0 };
            let along = e + slope * (2.0 * f + slope * g);
            path_m += weight * ((e * g - f * f).max(0.0) / along).sqrt() * step.abs();
        }
        Ok(path_m)
    }

    /// Whether a line v = const keeps clear of a border along v everywhere.
    pub fn clear_of(&self, border: f64, v: f64) -> Result<bool, SurfacePathError> {
        for contact in self.stations(&self.constant(v))? {
            let path_m = self.path_m(contact.u, 0.0, border, v)?;
            if path_m < 0.5 * contact.swath_m + self.options.margin_m {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// First and last line v = const that keep clear of both borders.
    pub fn outermost(&self) -> Result<[f64; 2], SurfacePathError> {
        let [low, high] = self.surface.domain().v;
        let [first, last] = [(low, high), (high, low)]
            .map(|(border, other)| self.bisect(border, other, |v| self.clear_of(border, v)));
        match (first?, last?) {
            (Some(first), Some(last)) if first <= last => Ok([first, last]),
            _ => Err(narrow(&self.stations(&self.constant(0.5 * (low + high)))?)),
        }
    }

    /// At which stations of a line the contact lies within the face.
    pub fn inside(&self, graph: &GraphLine) -> Result<Vec<bool>, SurfacePathError> {
        let stations = self.stations(graph)?;
        let line = RawLine::new(self, graph, &stations);
        Ok((0..=STATIONS).map(|k| line.holds(self, k, 0.0)).collect())
    }

    /// The contacts of a line, evenly spaced, cut into pieces whose contacts lie within the face;
    /// `keeps` says which stations are wanted. Ends keep half their reach and the margin from the
    /// ends of the patch.
    pub fn pieces(
        &self,
        graph: &GraphLine,
        backwards: bool,
        keeps: &[bool],
    ) -> Result<Vec<Vec<Contact>>, SurfacePathError> {
        let stations = self.stations(graph)?;
        let line = RawLine::new(self, graph, &stations);
        let inside: Vec<bool> = (0..=STATIONS)
            .map(|k| keeps[k] && line.holds(self, k, 0.0))
            .collect();
        let mut runs: Vec<[f64; 2]> = Vec::new();
        let mut k = 0;
        while k <= STATIONS {
            if !inside[k] {
                k += 1;
                continue;
            }
            let first = k;
            while k < STATIONS && inside[k + 1] {
                k += 1;
            }
            let begin = if first > 0 && keeps[first - 1] {
                line.edge(self, first - 1, true)
            } else {
                first as f64
            };
            let end = if k < STATIONS && keeps[k + 1] {
                line.edge(self, k, false)
            } else {
                k as f64
            };
            if end > begin {
                runs.push([begin, end]);
            }
            k += 1;
        }
        let mut pieces = Vec::new();
        for run in runs {
            let places = line.even(run, self.options.step_m)?;
            let mut piece = self.contacts(graph, places.into_iter())?;
            level(&mut piece);
            if backwards {
                // The axis is chosen from the same end whichever way a line is fed: neighbours were
                // compared so.
                piece.reverse();
                piece
                    .iter_mut()
                    .for_each(|contact| contact.feed = -contact.feed);
            }
            pieces.push(piece);
        }
        if backwards {
            pieces.reverse();
        }
        Ok(pieces)
    }
}

/// Turns the axes of a whole piece so that they point from right to left of the feed where they lie
/// across it, along it where they lie along: the wheel, and with it the sense in which its belt
/// runs, keeps its sense from line to line.
fn level(piece: &mut [Contact]) {
    let Some(first) = piece.first() else {
        return;
    };
    let left = first.axis.dot(&first.normal.cross(&first.feed));
    let against = if left.abs() > 0.5 {
        left < 0.0
    } else {
        first.axis.dot(&first.feed) < 0.0
    };
    if against {
        piece.iter_mut().for_each(|c| c.axis = -c.axis);
    }
}

/// That a contact is wider than the face, by its widest place.
pub(super) fn narrow(line: &[Contact]) -> SurfacePathError {
    let widest = |c: &Contact| c.swath_m.max(c.reach_m);
    SurfacePathError::WiderThanFace {
        swath_mm: line.iter().map(widest).fold(0.0, f64::max) * 1e3,
    }
}

/// A line with its length.
struct RawLine<'a> {
    graph: &'a GraphLine,
    stations: &'a [Contact],
    /// Length from the start at each station, m.
    along_m: Vec<f64>,
}

impl<'a> RawLine<'a> {
    fn new(layout: &Layout<'_>, graph: &'a GraphLine, stations: &'a [Contact]) -> Self {
        let speed_m = |contact: &Contact| {
            let [ru, rv] = layout.surface.jet(contact.u, contact.v).first_m;
            (ru + rv * graph.at(contact.u)[1]).norm()
        };
        let mut along_m = vec![0.0];
        for pair in stations.windows(2) {
            let path_m = 0.5 * (speed_m(&pair[0]) + speed_m(&pair[1])) * (pair[1].u - pair[0].u);
            along_m.push(along_m[along_m.len() - 1] + path_m);
        }
        Self {
            graph,
            stations,
            along_m,
        }
    }

    /// Whether the contact at a share of the way from station k to the next lies within the face.
    fn holds(&self, layout: &Layout<'_>, k: usize, share: f64) -> bool {
        let next = (k + 1).min(STATIONS);
        let between = |a: f64, b: f64| a + share * (b - a);
        let (one, other) = (&self.stations[k], &self.stations[next]);
        let margin_m = layout.options.margin_m;
        let half_reach_m = 0.5 * between(one.reach_m, other.reach_m) + margin_m;
        let at_m = between(self.along_m[k], self.along_m[next]);
        if at_m < half_reach_m || self.along_m[STATIONS] - at_m < half_reach_m {
            return false;
        }
        let Some(boundary) = layout.boundary else {
            return true;
        };
        let u = between(one.u, other.u);
        let [v, slope] = self.graph.at(u);
        let jet = layout.surface.jet(u, v);
        let [low, high] = layout.surface.domain().v;
        let Some(forms) = Forms::of(&jet).filter(|_| (low..=high).contains(&v)) else {
            return false;
        };
        let feed = (jet.first_m[0] + jet.first_m[1] * slope).normalize();
        let half_swath_m = 0.5 * between(one.swath_m, other.swath_m) + margin_m;
        let axes = [feed, forms.normal.cross(&feed)];
        boundary.holds_rectangle(&jet.point_m, axes, [half_reach_m, half_swath_m])
    }

    /// Where between station k and the next the face begins (`entering`) or ends, in stations.
    fn edge(&self, layout: &Layout<'_>, k: usize, entering: bool) -> f64 {
        let ends = if entering { [0.0, 1.0] } else { [1.0, 0.0] };
        let [_, inside] = bisect(ends, END_BISECTIONS, |at| self.holds(layout, k, at));
        k as f64 + inside
    }

    /// Evenly spaced parameters from one place to another, both in stations.
    fn even(&self, [from, to]: [f64; 2], step_m: f64) -> Result<Vec<f64>, SurfacePathError> {
        let length_m = |station: f64| {
            let k = (station as usize).min(STATIONS - 1);
            self.along_m[k] + (station - k as f64) * (self.along_m[k + 1] - self.along_m[k])
        };
        let (start_m, end_m) = (length_m(from), length_m(to));
        let count = ((end_m - start_m) / step_m).ceil().max(1.0);
        if count > MOST_CONTACTS as f64 {
            return Err(SurfacePathError::TooFine {
                length_mm: (end_m - start_m) * 1e3,
                contacts: count,
                most: MOST_CONTACTS,
            });
        }
        let count = count as usize;
        let place = |k: usize| {
            let at_m = start_m + (end_m - start_m) * k as f64 / count as f64;
            let cell = self
                .along_m
                .partition_point(|a| *a <= at_m)
                .clamp(1, STATIONS)
                - 1;
            let share = (at_m - self.along_m[cell]) / (self.along_m[cell + 1] - self.along_m[cell]);
            self.stations[cell].u + share * (self.stations[cell + 1].u - self.stations[cell].u)
        };
        Ok((0..=count).map(place).collect())
    }
}
