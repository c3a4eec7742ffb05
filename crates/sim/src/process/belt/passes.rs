//! Where a wheel that is led over a face touches it.

use super::geometry::{FaceGeometry, Section};
use nalgebra::{Isometry3, Point3, Unit, Vector3};
use std::sync::Arc;
use truecut_plan::surface::{Domain, PatchFile};
use truecut_plan::surface_path::{Contact, ContactWheel, SurfacePath};

/// What of a way over a face is told with what is done to it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Passes {
    /// Least and greatest u, and v, between the outermost passes and short of their ends: there a
    /// pass is whole.
    pub swept: [[f64; 2]; 2],
    /// Outward normal of the face where the wheel comes onto it first, in the patch's frame.
    pub first_normal: Unit<Vector3<f64>>,
    /// How far the straight lines of a program that is driven leave the way, m.
    pub chord_m: f64,
    /// How long the wheel is on the face, s.
    pub time_s: f64,
}

/// Why a way makes no passes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum NoPasses {
    /// The wheel stays so far away, m; `None` where nothing of the face lies under it.
    Above(Option<f64>),
    /// At this of the places its middle is pressed in so far, m.
    TooDeep(usize, f64),
}

/// A place where the wheel touches.
struct Touch {
    uv: [f64; 2],
    point_m: Point3<f64>,
    normal: Unit<Vector3<f64>>,
    /// Half of the width of the patch of contact along the way, m.
    half_width_m: f64,
}

impl Passes {
    /// Along the lines of a path job; none if it has none.
    pub fn of_lines(
        lines: &SurfacePath,
        patch: &PatchFile,
        wheel: &ContactWheel,
        feed_m_per_s: f64,
    ) -> Option<Self> {
        let first = lines.lines.iter().flatten().next()?;
        let touch = |contact: &Contact| Touch {
            uv: [contact.u, contact.v],
            point_m: contact.point_m.into(),
            normal: contact.normal,
            half_width_m: contact.half_width_m,
        };
        let passes = lines.lines.iter();
        let passes: Vec<Vec<Touch>> = passes
            .map(|line| line.iter().map(touch).collect())
            .collect();
        let chords = lines.chords(patch.surface.as_ref(), wheel);
        let chords = chords.iter().flatten().map(|chord| chord.largest_m());
        let length_m: f64 = (lines.lines.iter())
            .flat_map(|line| line.windows(2))
            .map(|pair: &[Contact]| (pair[1].point_m - pair[0].point_m).norm())
            .sum();
        Some(Self {
            swept: swept(&passes),
            first_normal: first.normal,
            chord_m: chords.fold(0.0, f64::max),
            time_s: length_m / feed_m_per_s,
        })
    }

    /// Of a wheel that stands at these places in the patch's frame, one after another; with the
    /// largest indentation of its middle, m.
    pub fn of_places(
        places: &[Isometry3<f64>],
        interval_s: f64,
        patch: Arc<PatchFile>,
        wheel: &ContactWheel,
        rubber_m: f64,
    ) -> Result<(Self, f64), NoPasses> {
        let face = FaceGeometry::new(patch);
        let (mut passes, mut touches): (Vec<Vec<Touch>>, bool) = (Vec::new(), false);
        let (mut deepest_m, mut least_m) = (0.0_f64, None::<f64>);
        let mut seed = None;
        for (index, place) in places.iter().enumerate() {
            let found = under(&face, place, wheel, seed);
            seed = found.as_ref().map(|section| section.uv);
            let depth_m = found.as_ref().map(|one| wheel.radius_m - one.distance_m);
            let pressed = found.as_ref().zip(depth_m.filter(|depth_m| *depth_m > 0.0));
            let Some((section, depth_m)) = pressed else {
                least_m = depth_m
                    .map(|depth| least_m.map_or(-depth, |m| m.min(-depth)))
                    .or(least_m);
                touches = false;
                continue;
            };
            if depth_m >= rubber_m {
                return Err(NoPasses::TooDeep(index, depth_m));
            }
            deepest_m = deepest_m.max(depth_m);
            if !std::mem::replace(&mut touches, true) {
                passes.push(Vec::new());
            }
            let touch = Touch {
                uv: section.uv,
                point_m: section.point_m,
                normal: section.normal,
                half_width_m: (wheel.radius_m * depth_m).sqrt(),
            };
            if let Some(pass) = passes.last_mut() {
                pass.push(touch);
            }
        }
        let Some(first) = passes.iter().flatten().next() else {
            return Err(NoPasses::Above(least_m));
        };
        let passes = Self {
            swept: swept(&passes),
            first_normal: first.normal,
            chord_m: 0.0,
            time_s: passes.iter().flatten().count() as f64 * interval_s,
        };
        Ok((passes, deepest_m))
    }
}

/// The face under the middle of a wheel, if there is any.
fn under(
    face: &FaceGeometry,
    place: &Isometry3<f64>,
    wheel: &ContactWheel,
    seed: Option<[f64; 2]>,
) -> Option<Section> {
    let centre = Point3::from(place.translation.vector);
    let axis = place.rotation * Vector3::y();
    let near = |seed| face.section(&centre, &axis, seed);
    let section = seed
        .and_then(near)
        .or_else(|| near(face.near(&centre, 2.0 * wheel.radius_m)?))?;
    let Domain { u, v, .. } = face.domain();
    let inside = |[low, high]: [f64; 2], at: f64| (low..=high).contains(&at);
    let faces = section.normal.dot(&section.to_axis) > 0.0 && section.distance_m > 0.0;
    let is_face = faces && inside(u, section.uv[0]) && inside(v, section.uv[1]);
    let along = axis.cross(&section.normal);
    (is_face && face.is_within(&section, &along, &axis)).then_some(section)
}

/// Parameters between the outermost passes and their ends, twice the half-width of the contact line
/// short of these: there a pass is whole.
fn swept(passes: &[Vec<Touch>]) -> [[f64; 2]; 2] {
    let inner = passes.iter().flat_map(|pass| {
        let ends = [pass.first(), pass.last()];
        pass.iter().filter(move |touch| {
            let clear_m = 2.0 * touch.half_width_m;
            let away = |end: &&Touch| (touch.point_m - end.point_m).norm() >= clear_m;
            ends.iter().flatten().all(away)
        })
    });
    let inner: Vec<&Touch> = inner.collect();
    [0, 1].map(|i| range(inner.iter().map(|touch| touch.uv[i])))
}

fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
        [low.min(x), high.max(x)]
    })
}
