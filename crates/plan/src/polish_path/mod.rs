//! A spherical wheel's way over a freeform face, its spin axis in precession.
//!
//! Lines run along the patch's first parameter and share the width at every place of it evenly, a
//! spacing apart at most. Each is cut where the contact would come nearer to the boundary of the
//! face, or to a hole, than the inset. The wheel's centre, the tool's origin, stands over the face
//! by its radius less the indentation, along the normal. Its spin axis leans by the tilt from the
//! normal towards an angle from the first parameter's tangent, which turns with the way that was
//! fed; the tool's z runs along it into the face, its x as nearly along that tangent as it can.

mod lines;

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use thiserror::Error;
use truecut_core::wheel::curved::Curved;

use crate::cam::CamPath;
use crate::program::MOST_POINTS;
use crate::surface::{Boundary, Forms, Jet, PatchFile, SurfaceFault, outline};

/// Most lines: more take longer than anyone would wait.
const MOST_LINES: usize = 2_000;
/// By this part lines may come nearer to the boundary than the inset: they run along it.
const ALONG: f64 = 1e-3;

/// How a wheel is led over a face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PolishLaying {
    /// Of the unloaded wheel.
    pub radius_m: f64,
    /// How far the undeformed wheel reaches into the face.
    pub indentation_m: f64,
    /// Angle between spin axis and normal.
    pub tilt_rad: f64,
    /// Rate at which the spin axis turns about the normal while the wheel is fed, from the first
    /// parameter's tangent towards the second's; negative: the other way.
    pub turn_rad_s: f64,
    /// Angle towards which it leans at the start.
    pub start_rad: f64,
    /// Largest distance of lines.
    pub spacing_m: f64,
    /// Radius of the contact on a plane.
    pub contact_m: f64,
    /// Distance of the middle of the contact from the boundary, at least; where the contact is
    /// wider, its radius.
    pub inset_m: f64,
    /// Largest distance of points along a line.
    pub step_m: f64,
    /// How far the wheel is lifted before and after each line.
    pub lift_m: f64,
    /// Along the face, down to it and off it.
    pub feed_m_per_s: f64,
}

/// A way over a face.
#[derive(Debug, Clone, PartialEq)]
pub struct PolishPath {
    /// In the patch's frame. The line of a point is the number of its piece of a line, from 1.
    pub path: CamPath,
    /// Points of contact on the face, piece by piece.
    pub contacts_m: Vec<Vec<Vector3<f64>>>,
    /// How far the straight lines from point to point leave the height over the face, at most, m.
    pub chord_m: f64,
    /// Largest ratio of the relative radii of wheel and face.
    pub unalike: f64,
}

/// Why no way is laid.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PolishPathError {
    #[error(
        "at ({}) mm the face is hollow with a radius of {:.3} mm, but the wheel's is {:.3} mm: it touches with its sides",
        mm(at_m), hollow_m * 1e3, radius_m * 1e3
    )]
    TooHollow {
        at_m: Vector3<f64>,
        hollow_m: f64,
        radius_m: f64,
    },
    #[error(
        "at ({}) mm the face is curved by {:.4} and {:.4} per mm across one another, which gives the wheel relative radii in the ratio {unalike:.3}, but it must be at most {}: the contact law takes the patch to be round",
        mm(at_m), curvatures_per_m[0] * 1e-3, curvatures_per_m[1] * 1e-3, Curved::MOST_UNALIKE
    )]
    TooUnalike {
        at_m: Vector3<f64>,
        curvatures_per_m: [f64; 2],
        unalike: f64,
    },
    #[error(
        "no line fits on the face, which is {:.3} mm wide at most across its lines: the middle of the contact stays {:.3} mm from every border", width_m * 1e3, inset_m * 1e3
    )]
    NoRoom { width_m: f64, inset_m: f64 },
    #[error("{count:.0} lines are too many; at most {MOST_LINES} are planned")]
    TooManyLines { count: f64 },
    #[error("{count:.0} points are too many; at most {MOST_POINTS} are planned")]
    TooMany { count: f64 },
    #[error(transparent)]
    Surface(#[from] SurfaceFault),
}

fn mm(at_m: &Vector3<f64>) -> String {
    let at: Vec<String> = at_m.iter().map(|m| format!("{:.3}", m * 1e3)).collect();
    at.join(", ")
}

/// A place on the face.
#[derive(Debug, Clone, Copy)]
struct Place {
    point_m: Vector3<f64>,
    normal: Vector3<f64>,
    /// Tangent of the first parameter, of length 1.
    along: Vector3<f64>,
}

/// A place of a line, the wheel lifted by a height.
#[derive(Debug, Clone, Copy)]
struct Stop {
    place: Place,
    angle_rad: f64,
    lift_m: f64,
    /// Way along the face, or down, from the one before.
    fed_m: f64,
}

impl PolishLaying {
    /// The way over a face, in its patch's frame.
    ///
    /// # Errors
    /// If the face is too curved for the wheel on a line, no line fits, or there would be too many.
    pub fn path(&self, patch: &PatchFile) -> Result<PolishPath, PolishPathError> {
        let borders = FaceBorders::of(patch)?;
        lines::Task::new(self, patch.surface.as_ref(), &borders).path()
    }

    fn stop(&self, stop: &Stop) -> (Vector3<f64>, UnitQuaternion<f64>) {
        let Place {
            point_m,
            normal,
            along,
        } = stop.place;
        let (sine, cosine) = self.tilt_rad.sin_cos();
        let (across, turned) = (normal.cross(&along), stop.angle_rad.sin_cos());
        let z = -(normal * cosine + (along * turned.1 + across * turned.0) * sine);
        let x = (along - z * z.dot(&along)).normalize();
        let axes = Matrix3::from_columns(&[x, z.cross(&x), z]);
        let rotation =
            UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes));
        let height_m = self.radius_m - self.indentation_m + stop.lift_m;
        (point_m + normal * height_m, rotation)
    }
}

/// The lines that bound a face: its outline, else that of its patch, and its holes.
#[derive(Debug)]
pub struct FaceBorders {
    boundary: Boundary,
    sides: Vec<[Vector3<f64>; 2]>,
}

impl FaceBorders {
    /// Those of a patch.
    ///
    /// # Errors
    /// If the outline of the patch crosses itself.
    pub fn of(patch: &PatchFile) -> Result<Self, SurfaceFault> {
        let boundary = match &patch.boundary {
            Some(boundary) => boundary.clone(),
            None => Boundary::new(&outline(patch.surface.as_ref()))?,
        };
        let loops = std::iter::once(boundary.corners_m())
            .chain(boundary.holes_m().iter().map(Vec::as_slice));
        let sides = loops.flat_map(|corners| {
            let next = corners.iter().cycle().skip(1);
            corners.iter().zip(next).map(|(a, b)| [*a, *b])
        });
        Ok(Self {
            sides: sides.collect(),
            boundary,
        })
    }

    /// Whether a place of the face lies within, and as far from every side.
    #[must_use]
    pub fn hold(&self, jet: &Jet, away_m: f64) -> bool {
        let Some(forms) = Forms::of(jet) else {
            return false;
        };
        let along = jet.first_m[0].normalize();
        let axes = [along, forms.normal.cross(&along)];
        let off = |[a, b]: &[Vector3<f64>; 2]| {
            let (way, from) = (b - a, jet.point_m - a);
            let share = (from.dot(&way) / way.norm_squared()).clamp(0.0, 1.0);
            (from - way * share).norm_squared()
        };
        let square = (away_m * (1.0 - ALONG)).powi(2);
        self.boundary.holds_rectangle(&jet.point_m, axes, [0.0; 2])
            && self.sides.iter().all(|side| off(side) >= square)
    }
}

#[cfg(test)]
mod tests;
