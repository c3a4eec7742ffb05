//! The workpiece in a plane across the brush's axis, as the bristles see it: what each meets first.
//!
//! Angles turn from z to x, as the brush does that turns right-handed about y: `r = (sin φ, cos φ)`
//! in (x, z).

use std::f64::consts::{PI, TAU};

/// Angles no further apart are one, but for rounding.
const SAME_ANGLE_RAD: f64 = 1e-12;
/// Lines whose distances differ by no more of themselves, and whose feet by no larger angle, are
/// one.
const SAME_LINE: f64 = 1e-9;

/// A side of the section that faces the axis, over the angles at which it is within the brush's
/// reach. Its distance along a bristle is `distance / cos(φ - foot)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Side {
    pub from_rad: f64,
    pub to_rad: f64,
    /// Distance of its line from the axis.
    pub distance_m: f64,
    /// Angle of its line's nearest point.
    pub foot_rad: f64,
    /// The triangle that it is cut from.
    pub triangle: usize,
}

impl Side {
    /// A straight side of a triangle between two points (x, z), as far as it is within `reach_m` of
    /// the axis.
    pub fn new(triangle: usize, ends_m: [[f64; 2]; 2], reach_m: f64) -> Option<Side> {
        let [[px, pz], [qx, qz]] = ends_m;
        let (dx, dz) = (qx - px, qz - pz);
        let length = dx.hypot(dz);
        let distance_m = (px * qz - pz * qx).abs() / length;
        // A side that runs through the axis, or has no length, has no angle.
        if !(length > 0.0 && distance_m > 1e-9 * reach_m && distance_m < reach_m) {
            return None;
        }
        let part = -(px * dx + pz * dz) / (length * length);
        let foot_rad = (px + part * dx).atan2(pz + part * dz);
        let (sine, cosine) = foot_rad.sin_cos();
        // Along the line in the sense of rising angles, no further than bristles reach.
        let most = (distance_m / reach_m).acos();
        let chord_m = reach_m * (1.0 - (distance_m / reach_m).powi(2)).sqrt();
        let angle = |x: f64, z: f64| {
            let along_m = x * cosine - z * sine;
            match along_m.abs() < chord_m {
                true => (along_m / distance_m).atan(),
                false => most.copysign(along_m),
            }
        };
        let (one, other) = (angle(px, pz), angle(qx, qz));
        let (from, to) = (one.min(other), one.max(other));
        (to > from).then_some(Side {
            from_rad: foot_rad + from,
            to_rad: foot_rad + to,
            distance_m,
            foot_rad,
            triangle,
        })
    }

    /// Where a bristle at the angle meets the line.
    pub fn along_bristle_m(&self, angle_rad: f64) -> f64 {
        self.distance_m / (angle_rad - self.foot_rad).cos()
    }

    /// Whether two sides are parts of one line, as two triangles of a face give them.
    fn is_in_line_with(&self, other: &Side) -> bool {
        let apart_m = (self.distance_m - other.distance_m).abs();
        apart_m <= SAME_LINE * self.distance_m
            && (self.foot_rad - other.foot_rad).abs() <= SAME_LINE
    }

    /// The same side with its angles between -π and π: of one that reaches across, both parts.
    fn unwound(self) -> [Option<Side>; 2] {
        let turned = |by: f64| Side {
            from_rad: self.from_rad + by,
            to_rad: self.to_rad + by,
            foot_rad: self.foot_rad + by,
            ..self
        };
        let cut = |side: Side| {
            let (from_rad, to_rad) = (side.from_rad.max(-PI), side.to_rad.min(PI));
            (to_rad > from_rad).then_some(Side {
                from_rad,
                to_rad,
                ..side
            })
        };
        let other = if self.to_rad > PI { -TAU } else { TAU };
        [cut(self), cut(turned(other))]
    }
}

/// The sides that bristles meet first, by rising angle and without overlap.
pub(super) fn nearest_sides(sides: &[Side], nearest: &mut Vec<Side>) {
    nearest.clear();
    // Nothing hides a side that is alone and does not reach behind the axis.
    if let [one] = sides
        && one.from_rad >= -PI
        && one.to_rad <= PI
    {
        nearest.push(*one);
        return;
    }
    let mut all: Vec<Side> = (sides.iter().flat_map(|side| side.unwound()))
        .flatten()
        .collect();
    all.sort_by(|a, b| a.from_rad.total_cmp(&b.from_rad));
    let mut borders: Vec<f64> = all.iter().flat_map(|s| [s.from_rad, s.to_rad]).collect();
    borders.sort_by(f64::total_cmp);
    // Those that have begun, less those that have ended before.
    let (mut over, mut begun): (Vec<&Side>, usize) = (Vec::new(), 0);
    for pair in borders.windows(2) {
        let (from_rad, to_rad) = (pair[0], pair[1]);
        if to_rad - from_rad < SAME_ANGLE_RAD {
            continue;
        }
        let middle = 0.5 * (from_rad + to_rad);
        while begun < all.len() && all[begun].from_rad <= middle {
            over.push(&all[begun]);
            begun += 1;
        }
        over.retain(|side| middle <= side.to_rad);
        let along_m = |side: &&&Side| side.along_bristle_m(middle);
        let first = (over.iter()).min_by(|a, b| along_m(a).total_cmp(&along_m(b)));
        let Some(first) = first.copied() else {
            continue;
        };
        match nearest.last_mut() {
            Some(last)
                if from_rad - last.to_rad < SAME_ANGLE_RAD && last.is_in_line_with(first) =>
            {
                last.to_rad = to_rad;
            }
            _ => nearest.push(Side {
                from_rad,
                to_rad,
                ..*first
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verify_a_flat_face_is_met_over_the_chord() {
        let side = Side::new(0, [[-1.0, 0.9], [1.0, 0.9]], 1.0).unwrap();
        let half = 0.9_f64.acos();
        assert!((side.from_rad + half).abs() < 1e-12 && (side.to_rad - half).abs() < 1e-12);
        assert!((side.along_bristle_m(0.2) - 0.9 / 0.2_f64.cos()).abs() < 1e-15);
        assert_eq!(Side::new(0, [[-1.0, 1.1], [1.0, 1.1]], 1.0), None);
        // It begins at x = 0, square below the axis.
        let half_face = Side::new(0, [[0.0, 0.9], [1.0, 0.9]], 1.0).unwrap();
        assert!(half_face.from_rad.abs() < 1e-15);
    }

    /// A step of 0.02 hides what lies behind it: the side behind begins where the bristle over the
    /// step's corner meets it.
    #[test]
    fn verify_what_is_nearer_hides_what_is_behind() {
        let near = Side::new(0, [[-1.0, 0.9], [0.1, 0.9]], 1.0).unwrap();
        let behind = Side::new(0, [[-1.0, 0.92], [1.0, 0.92]], 1.0).unwrap();
        let mut nearest = Vec::new();
        nearest_sides(&[behind, near], &mut nearest);
        let corner = (0.1_f64 / 0.9).atan();
        let at = |distance_m: f64| -> Vec<&Side> {
            let near = nearest
                .iter()
                .filter(|s| (s.distance_m - distance_m).abs() < 1e-12);
            near.collect()
        };
        let (first, second) = (at(0.9), at(0.92));
        assert!((first.last().unwrap().to_rad - corner).abs() < 1e-12);
        assert!((second[0].from_rad - corner).abs() < 1e-12);
        assert!(
            nearest
                .windows(2)
                .all(|w| w[0].to_rad <= w[1].from_rad + 1e-12)
        );
    }

    /// Behind the wheel, at angles about π, nothing is lost and nothing doubled.
    #[test]
    fn verify_a_face_behind_the_axis_is_met_over_the_same_angle() {
        let side = Side::new(0, [[1.0, -0.9], [-1.0, -0.9]], 1.0).unwrap();
        let mut nearest = Vec::new();
        nearest_sides(&[side], &mut nearest);
        let whole: f64 = nearest.iter().map(|s| s.to_rad - s.from_rad).sum();
        assert!((whole - 2.0 * 0.9_f64.acos()).abs() < 1e-12);
        assert!(nearest.iter().all(|s| s.from_rad >= -PI && s.to_rad <= PI));
    }
}
