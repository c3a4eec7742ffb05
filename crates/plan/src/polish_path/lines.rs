//! Lines over a face, and the wheel's places on them.

use truecut_core::roots::bisect;
use truecut_core::wheel::curved::Curved;

use super::{FaceBorders, MOST_LINES, Place, PolishLaying, PolishPath, PolishPathError, Stop};
use crate::cam::{Attitude, CamPath, CamPoint};
use crate::program::MOST_POINTS;
use crate::surface::{Forms, Jet, Surface, SurfaceFault};

/// Places along a line at which it is looked at before its ends are sought.
const STATIONS: usize = 256;
/// Steps of the trapezoidal rule by which the width is measured.
const WIDTH_STEPS: usize = 64;
/// Bisections of a line's end between two stations.
const END_BISECTIONS: usize = 30;
/// The spin axis turns by this at most from point to point: on the cone of its tilt the arc between
/// them bulges by less than a tenth of a degree.
const MOST_TURN_RAD: f64 = 10.0 * std::f64::consts::PI / 180.0;
/// Shortest piece of a line that is polished, spacings: the wheel would hardly be let down.
const SHORTEST: f64 = 0.5;

/// What lines are laid from.
pub(super) struct Task<'a> {
    laying: &'a PolishLaying,
    surface: &'a dyn Surface,
    borders: &'a FaceBorders,
    /// At each station the way from border to border along the second parameter, to even places
    /// of it, m.
    ways_m: Vec<[f64; WIDTH_STEPS + 1]>,
}

impl<'a> Task<'a> {
    pub fn new(
        laying: &'a PolishLaying,
        surface: &'a dyn Surface,
        borders: &'a FaceBorders,
    ) -> Self {
        Self {
            laying,
            surface,
            borders,
            ways_m: (0..=STATIONS).map(|k| ways_m(surface, k)).collect(),
        }
    }

    pub fn path(&self) -> Result<PolishPath, PolishPathError> {
        let laying = self.laying;
        let widths = self.ways_m.iter().map(|ways_m| ways_m[WIDTH_STEPS]);
        let width_m = widths.fold(0.0, f64::max);
        let no_room = PolishPathError::NoRoom {
            width_m,
            inset_m: laying.inset_m,
        };
        let between_m = width_m - 2.0 * laying.inset_m;
        if between_m < 0.0 {
            return Err(no_room);
        }
        let gaps = (between_m / laying.spacing_m - 1e-9).ceil().max(1.0);
        if gaps >= MOST_LINES as f64 {
            return Err(PolishPathError::TooManyLines { count: gaps + 1.0 });
        }
        let mut path = PolishPath {
            path: CamPath::default(),
            contacts_m: Vec::new(),
            chord_m: 0.0,
            unalike: 1.0,
        };
        let mut fed_m = 0.0;
        for line in 0..=gaps as usize {
            let share = line as f64 / gaps;
            let mut pieces = self.pieces(share);
            if line % 2 == 1 {
                pieces.iter_mut().for_each(|piece| piece.reverse());
                pieces.reverse();
            }
            for [from, to] in pieces {
                self.piece(share, [from, to], &mut fed_m, &mut path)?;
            }
        }
        if path.path.points.is_empty() {
            return Err(no_room);
        }
        Ok(path)
    }

    /// The second parameter of a line that takes a share of the width between the insets, at a
    /// whole station.
    fn v_at(&self, station: usize, share: f64) -> f64 {
        let ways_m = &self.ways_m[station];
        let whole_m = ways_m[WIDTH_STEPS];
        // Where the face is narrower than both insets there is no line; it is cut there.
        let inset_m = self.laying.inset_m.min(0.5 * whole_m);
        let at_m = inset_m + share * (whole_m - 2.0 * inset_m);
        let cell = ways_m
            .partition_point(|way_m| *way_m <= at_m)
            .clamp(1, WIDTH_STEPS);
        let within = (at_m - ways_m[cell - 1]) / (ways_m[cell] - ways_m[cell - 1]);
        let [low, high] = self.surface.domain().v;
        low + (high - low) * (cell as f64 - 1.0 + within) / WIDTH_STEPS as f64
    }

    /// The same between stations.
    fn v(&self, station: f64, share: f64) -> f64 {
        let before = (station as usize).min(STATIONS - 1);
        let [from, to] = [before, before + 1].map(|k| self.v_at(k, share));
        from + (to - from) * (station - before as f64)
    }

    fn jet(&self, station: f64, share: f64) -> (Jet, [f64; 2]) {
        let u = u_at(self.surface, station);
        let v = self.v(station, share);
        (self.surface.jet(u, v), [u, v])
    }

    fn place(&self, station: f64, share: f64) -> Option<(Place, Forms)> {
        let (jet, _) = self.jet(station, share);
        let forms = Forms::of(&jet)?;
        let place = Place {
            point_m: jet.point_m,
            normal: forms.normal.into_inner(),
            along: jet.first_m[0].normalize(),
        };
        Some((place, forms))
    }

    /// Whether the whole contact lies on the face.
    fn holds(&self, station: f64, share: f64) -> bool {
        let (jet, _) = self.jet(station, share);
        let Some(forms) = Forms::of(&jet) else {
            return false;
        };
        let laying = self.laying;
        let curvatures = forms.curvatures();
        let both = [curvatures.min_per_m, curvatures.max_per_m];
        // A place that is too curved is told where the line is laid.
        let contact_m = Curved::new(laying.radius_m, both)
            .map_or(0.0, |curved| curved.contact_m(laying.contact_m));
        self.borders.hold(&jet, laying.inset_m.max(contact_m))
    }

    /// Where a line runs over the face, in stations.
    fn pieces(&self, share: f64) -> Vec<[f64; 2]> {
        let holds: Vec<bool> = (0..=STATIONS)
            .map(|k| self.holds(k as f64, share))
            .collect();
        let end = |inside: usize, outside: usize| {
            let ends = [outside as f64, inside as f64];
            bisect(ends, END_BISECTIONS, |at| self.holds(at, share))[1]
        };
        let mut pieces = Vec::new();
        let mut k = 0;
        while k <= STATIONS {
            if !holds[k] {
                k += 1;
                continue;
            }
            let from = if k == 0 { 0.0 } else { end(k, k - 1) };
            while k < STATIONS && holds[k + 1] {
                k += 1;
            }
            let to = if k == STATIONS {
                STATIONS as f64
            } else {
                end(k, k + 1)
            };
            pieces.push([from, to]);
            k += 1;
        }
        pieces
    }

    /// Adds a piece of a line, the wheel let down before and lifted after.
    fn piece(
        &self,
        share: f64,
        ends: [f64; 2],
        fed_m: &mut f64,
        path: &mut PolishPath,
    ) -> Result<(), PolishPathError> {
        let laying = self.laying;
        let stations = self.even(share, ends)?;
        let Some(stations) = stations else {
            return Ok(());
        };
        let mut stops: Vec<Stop> = Vec::new();
        for &station in &stations {
            let place = self.touched(station, share, path)?;
            let way_m = stops
                .last()
                .map_or(0.0, |before| (place.point_m - before.place.point_m).norm());
            *fed_m += way_m;
            stops.push(Stop {
                place,
                angle_rad: laying.start_rad + laying.turn_rad_s * *fed_m / laying.feed_m_per_s,
                lift_m: 0.0,
                fed_m: way_m,
            });
        }
        for pair in stations.windows(2) {
            let middle = self.place(0.5 * (pair[0] + pair[1]), share);
            let height_m = laying.radius_m - laying.indentation_m;
            let ends = [pair[0], pair[1]].map(|at| self.place(at, share));
            if let (Some((middle, _)), [Some((a, _)), Some((b, _))]) = (middle, ends) {
                let centre = |place: &Place| place.point_m + place.normal * height_m;
                let off_m = 0.5 * (centre(&a) + centre(&b)) - centre(&middle);
                path.chord_m = path.chord_m.max(off_m.dot(&middle.normal).abs());
            }
        }
        path.contacts_m
            .push(stops.iter().map(|stop| stop.place.point_m).collect());
        let lifted = |stop: &Stop, fed_m: f64| Stop {
            lift_m: laying.lift_m,
            fed_m,
            ..*stop
        };
        let (first, last) = (stops[0], stops[stops.len() - 1]);
        stops[0].fed_m = laying.lift_m;
        stops.insert(0, lifted(&first, 0.0));
        stops.push(lifted(&last, laying.lift_m));
        self.add(&stops, path)
    }

    fn add(&self, stops: &[Stop], path: &mut PolishPath) -> Result<(), PolishPathError> {
        let (laying, line) = (self.laying, path.contacts_m.len());
        let poses: Vec<_> = stops.iter().map(|stop| laying.stop(stop)).collect();
        let last = stops.len() - 1;
        for (k, (place_m, rotation)) in poses.iter().enumerate() {
            path.path.points.push(CamPoint {
                line,
                place_m: *place_m,
                attitude: Attitude::Whole(*rotation),
                // Over a curved face the centre has another way than the contact.
                feed_m_per_s: (k > 0).then(|| {
                    let centre_m = (place_m - poses[k - 1].0).norm();
                    laying.feed_m_per_s * centre_m / stops[k].fed_m
                }),
                stops: k <= 1 || k + 1 >= last,
            });
        }
        let count = path.path.points.len();
        if count > MOST_POINTS {
            return Err(PolishPathError::TooMany {
                count: count as f64,
            });
        }
        Ok(())
    }

    /// A place at which the wheel touches.
    fn touched(
        &self,
        station: f64,
        share: f64,
        path: &mut PolishPath,
    ) -> Result<Place, PolishPathError> {
        let Some((place, forms)) = self.place(station, share) else {
            let (_, [u, v]) = self.jet(station, share);
            return Err(SurfaceFault::NoNormal { u, v }.into());
        };
        let curvatures = forms.curvatures();
        let curvatures_per_m = [curvatures.min_per_m, curvatures.max_per_m];
        let (at_m, radius_m) = (place.point_m, self.laying.radius_m);
        let Some(curved) = Curved::new(radius_m, curvatures_per_m) else {
            return Err(PolishPathError::TooHollow {
                at_m,
                hollow_m: -1.0 / curvatures.min_per_m,
                radius_m,
            });
        };
        let unalike = curved.unalike();
        if unalike > Curved::MOST_UNALIKE {
            return Err(PolishPathError::TooUnalike {
                at_m,
                curvatures_per_m,
                unalike,
            });
        }
        path.unalike = path.unalike.max(unalike);
        Ok(place)
    }

    /// Evenly spaced places of a piece, in stations in their order; `None` of one that is too
    /// short.
    fn even(&self, share: f64, [from, to]: [f64; 2]) -> Result<Option<Vec<f64>>, PolishPathError> {
        let laying = self.laying;
        let at = |k: usize| from + (to - from) * k as f64 / STATIONS as f64;
        let point_m = |station: f64| self.jet(station, share).0.point_m;
        let mut along_m = vec![0.0];
        let mut before = point_m(from);
        for k in 1..=STATIONS {
            let here = point_m(at(k));
            along_m.push(along_m[k - 1] + (here - before).norm());
            before = here;
        }
        let length_m = along_m[STATIONS];
        if length_m < SHORTEST * laying.spacing_m {
            return Ok(None);
        }
        let turn_m = MOST_TURN_RAD * laying.feed_m_per_s / laying.turn_rad_s.abs();
        let count = (length_m / laying.step_m.min(turn_m)).ceil();
        if count > MOST_POINTS as f64 {
            return Err(PolishPathError::TooMany { count });
        }
        let place = |k: usize| {
            let at_m = length_m * k as f64 / count;
            let cell = along_m
                .partition_point(|way_m| *way_m <= at_m)
                .clamp(1, STATIONS);
            let whole_m = along_m[cell] - along_m[cell - 1];
            let within = (at_m - along_m[cell - 1]) / whole_m;
            from + (to - from) * (cell as f64 - 1.0 + within) / STATIONS as f64
        };
        Ok(Some((0..=count as usize).map(place).collect()))
    }
}

/// The first parameter at a station.
fn u_at(surface: &dyn Surface, station: f64) -> f64 {
    let [low, high] = surface.domain().u;
    low + (high - low) * station / STATIONS as f64
}

/// Ways along the second parameter at a station, m.
fn ways_m(surface: &dyn Surface, station: usize) -> [f64; WIDTH_STEPS + 1] {
    let u = u_at(surface, station as f64);
    let [low, high] = surface.domain().v;
    let step = (high - low) / WIDTH_STEPS as f64;
    let speed = |k: usize| surface.jet(u, low + step * k as f64).first_m[1].norm();
    let mut ways_m = [0.0; WIDTH_STEPS + 1];
    let mut before = speed(0);
    for k in 1..=WIDTH_STEPS {
        let here = speed(k);
        ways_m[k] = ways_m[k - 1] + 0.5 * (before + here) * step;
        before = here;
    }
    ways_m
}
