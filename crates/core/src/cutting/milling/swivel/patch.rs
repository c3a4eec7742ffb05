//! What of the area that a piece of an edge cuts lies in the block.
//!
//! A face that a tool meets askew ends the chip at another height at its tip than at its root.

use super::field::DistanceField;
use nalgebra::Vector3;

/// A part of the unit square.
#[derive(Debug, Clone, Copy)]
pub(super) struct Within {
    pub area: f64,
    /// Its extent along the second side, and the middle of that.
    pub height: f64,
    pub middle: f64,
}

impl Within {
    fn of(patch: &[[f64; 2]]) -> Option<Self> {
        let next = |k: usize| patch[(k + 1) % patch.len()];
        let twice = |(k, a): (usize, &[f64; 2])| a[0] * next(k)[1] - a[1] * next(k)[0];
        let area = 0.5 * patch.iter().enumerate().map(twice).sum::<f64>();
        let up = || patch.iter().map(|corner| corner[1]);
        let [low, high] = [
            up().fold(f64::INFINITY, f64::min),
            up().fold(f64::NEG_INFINITY, f64::max),
        ];
        (area > 0.0 && high > low).then_some(Self {
            area,
            height: high - low,
            middle: 0.5 * (low + high),
        })
    }
}

/// What of a patch of the unit square lies where a value is positive that is given at the square's
/// corners (Sutherland and Hodgman).
fn cut_off(patch: &[[f64; 2]], corners: &[f64; 4]) -> Vec<[f64; 2]> {
    let value = |[along, up]: [f64; 2]| {
        let low = corners[0] * (1.0 - along) + corners[1] * along;
        let high = corners[3] * (1.0 - along) + corners[2] * along;
        low * (1.0 - up) + high * up
    };
    let mut left = Vec::with_capacity(patch.len() + 1);
    for (k, from) in patch.iter().enumerate() {
        let to = patch[(k + 1) % patch.len()];
        let (before, after) = (value(*from), value(to));
        if before >= 0.0 {
            left.push(*from);
        }
        if (before >= 0.0) != (after >= 0.0) {
            let share = before / (before - after);
            left.push([0, 1].map(|side| from[side] + share * (to[side] - from[side])));
        }
    }
    left
}

impl DistanceField {
    /// What of a patch between four corners lies in the block: `place` is asked for the corners of
    /// the unit square, between which it is taken to be even. `None` if nothing does.
    pub(super) fn within(&self, place: impl Fn([f64; 2]) -> Vector3<f64>) -> Option<Within> {
        const CORNERS: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let places_m = CORNERS.map(&place);
        let mut patch = CORNERS.to_vec();
        for axis in 0..3 {
            for (sign, face_m) in [(1.0, self.block.least_m), (-1.0, self.block.most_m)] {
                let inside_m = places_m.map(|place| sign * (place[axis] - face_m[axis]));
                if inside_m.iter().all(|inside_m| *inside_m >= 0.0) {
                    continue;
                }
                patch = cut_off(&patch, &inside_m);
                if patch.len() < 3 {
                    return None;
                }
            }
        }
        Within::of(&patch)
    }
}
