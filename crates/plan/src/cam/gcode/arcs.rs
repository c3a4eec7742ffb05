//! Arcs of G-code: by centre or radius, in the three planes.

use std::collections::BTreeMap;

use nalgebra::{UnitVector3, Vector3};

use super::ARC_CLOSES_M;
use super::state::{MotionMode, State};
use crate::arc::Arc;
use crate::cam::{CamPoint, direction};
use crate::program::ProgramErrorKind;

impl State<'_> {
    /// Adds an arc to the path, as points between which chords keep to the tolerance. Those before
    /// its end are passed without a stop.
    pub(super) fn arc(
        &mut self,
        values: &BTreeMap<char, f64>,
        to: Vector3<f64>,
        from_axis: UnitVector3<f64>,
        feed: Option<f64>,
        line: usize,
    ) -> Result<(), ProgramErrorKind> {
        if self.path.points.is_empty() {
            return Err(ProgramErrorKind::unexpected(
                "an arc",
                "a move to its start, before it,",
            ));
        }
        if let Some(turns) = values.get(&'P').filter(|turns| **turns != 1.0) {
            let rule = "1: arcs of more than one turn are not read";
            return Err(ProgramErrorKind::value(
                "the turns P of an arc",
                turns,
                rule,
            ));
        }
        // Right-handed about the normal is counter-clockwise, seen from its tip.
        let normal = match self.plane {
            17 => Vector3::z_axis(),
            18 => Vector3::y_axis(),
            _ => Vector3::x_axis(),
        };
        let clockwise = self.motion == MotionMode::Clockwise;
        let about = if clockwise { -normal } else { normal };
        let from = self.place_m;
        let centre = match values.get(&'R') {
            Some(radius) => {
                if ['I', 'J', 'K']
                    .iter()
                    .any(|letter| values.contains_key(letter))
                {
                    return Err(ProgramErrorKind::unexpected("R", "either R or I, J, K; it"));
                }
                centre_of(&about, from, to, radius * self.unit_m)?
            }
            None => self.centre(values, &normal)?,
        };
        let arc = Arc::about(&about, centre, from, to, true);
        let radius_m = arc.radius_m();
        ProgramErrorKind::unless_too_large(radius_m)?;
        ProgramErrorKind::unless(
            arc.growth_m.abs() <= ARC_CLOSES_M && radius_m > 1e-9,
            "the arc does not close: the difference of its radii at start and end, mm,",
            format!("{:.4}", arc.growth_m.abs() * 1e3),
            format!("at most {} mm apart, and above zero", ARC_CLOSES_M * 1e3),
        )?;
        let turned_rad = from_axis.angle(&self.axis);
        let count = arc
            .chords(self.options.chord_m)
            .max((turned_rad / 0.02).ceil() as usize);
        ProgramErrorKind::unless_too_many(self.path.points.len().saturating_add(count))?;
        for k in 1..count {
            let share = k as f64 / count as f64;
            let axis = from_axis.into_inner().lerp(&self.axis, share);
            let point = self.point(arc.at(share), direction(axis)?, feed, line);
            // A control stops where a block ends: how many chords an arc has is none of its.
            let passed = CamPoint {
                stops: false,
                ..point
            };
            self.path.points.push(passed);
        }
        self.push(to, self.axis, feed, line);
        Ok(())
    }

    /// From I, J, K of the plane.
    fn centre(
        &self,
        values: &BTreeMap<char, f64>,
        normal: &UnitVector3<f64>,
    ) -> Result<Vector3<f64>, ProgramErrorKind> {
        let mut centre = self.place_m;
        let mut given = false;
        for (k, letter) in ['I', 'J', 'K'].into_iter().enumerate() {
            let Some(value) = values.get(&letter) else {
                continue;
            };
            if normal[k] != 0.0 {
                // Posts that always write all three write a zero there.
                if *value == 0.0 && !self.absolute_centres {
                    continue;
                }
                let found = format!("{letter} of an arc");
                let wanted = format!("a centre in the plane G{}", self.plane);
                return Err(ProgramErrorKind::unexpected(&found, &wanted));
            }
            given = true;
            let value = value * self.unit_m;
            centre[k] = if self.absolute_centres {
                value
            } else {
                centre[k] + value
            };
        }
        if given {
            Ok(centre)
        } else {
            Err(ProgramErrorKind::unexpected(
                "an arc",
                "its centre by I, J, K or its radius R",
            ))
        }
    }
}

/// The centre of an arc of a radius about an axis: the short way round, or the long one for a
/// negative radius.
fn centre_of(
    about: &UnitVector3<f64>,
    from: Vector3<f64>,
    to: Vector3<f64>,
    radius_m: f64,
) -> Result<Vector3<f64>, ProgramErrorKind> {
    let way = to - from;
    let chord = way - about.into_inner() * about.dot(&way);
    let half_m = 0.5 * chord.norm();
    let rule = "above zero: a whole turn needs I, J, K";
    ProgramErrorKind::unless(
        half_m > 1e-9,
        "the chord of an arc with R in mm",
        half_m * 2e3,
        rule,
    )?;
    let short_m = half_m - radius_m.abs();
    ProgramErrorKind::unless(
        short_m <= ARC_CLOSES_M,
        "the arc does not close: its radius R in mm",
        radius_m * 1e3,
        format!("at least half of its chord, {:.4} mm", half_m * 1e3),
    )?;
    let height_m = (radius_m * radius_m - half_m * half_m).max(0.0).sqrt();
    let left = about.cross(&chord.normalize());
    let side = if radius_m > 0.0 { height_m } else { -height_m };
    Ok(from + 0.5 * chord + left * side)
}
