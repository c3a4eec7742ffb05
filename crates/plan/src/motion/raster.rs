//! A raster over a rectangular face, with round corners.

use std::f64::consts::FRAC_PI_2;

use nalgebra::Vector2;

/// Lines to and fro along a face's length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Raster {
    /// Number of lines, one at least.
    pub lines: usize,
    /// Distance that the path keeps from the face's edges, m.
    pub inset_m: f64,
    /// Radius of the corners, at most half of the lines' distance, m.
    pub corner_radius_m: f64,
    /// Speed along the path, m/s.
    pub feed_m_per_s: f64,
}

/// Pieces of a quarter circle: the direction turns by 4.5 degrees from one to the next, which the
/// command smooths.
const PIECES: usize = 20;

/// Points closer than this are one, m.
const SAME_PLACE_M: f64 = 1e-9;

/// Vertices of the path of the patch's middle in the plane of a face of length and width (m).
pub(super) fn vertices([length_m, width_m]: [f64; 2], raster: &Raster) -> Vec<Vector2<f64>> {
    let ends = [raster.inset_m, length_m - raster.inset_m];
    let spacing_m = (width_m - 2.0 * raster.inset_m) / (raster.lines - 1).max(1) as f64;
    let corners: Vec<Vector2<f64>> = (0..raster.lines)
        .flat_map(|line| {
            let y = raster.inset_m + spacing_m * line as f64;
            let [from, to] = if line % 2 == 0 {
                ends
            } else {
                [ends[1], ends[0]]
            };
            [Vector2::new(from, y), Vector2::new(to, y)]
        })
        .collect();
    let mut found = vec![corners[0]];
    for corner in corners.windows(3) {
        let towards = (corner[1] - corner[0]).normalize();
        let away = (corner[2] - corner[1]).normalize();
        let radius_m = raster.corner_radius_m;
        let centre = corner[1] + (away - towards) * radius_m;
        for piece in 0..=PIECES {
            let (sine, cosine) = (FRAC_PI_2 * piece as f64 / PIECES as f64).sin_cos();
            push(
                &mut found,
                centre + (towards * sine - away * cosine) * radius_m,
            );
        }
    }
    push(&mut found, corners[corners.len() - 1]);
    found
}

fn push(found: &mut Vec<Vector2<f64>>, point: Vector2<f64>) {
    if found
        .last()
        .is_none_or(|last| (point - last).norm() > SAME_PLACE_M)
    {
        found.push(point);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    const FACE_M: [f64; 2] = [0.1, 0.06];

    /// Each corner of radius r takes (2 − π/2) r off; a polygon of n pieces is shorter than its arc
    /// by (π/2n)²/24 of it.
    #[test]
    fn verify_length_of_the_raster() {
        let r = 1.5e-3;
        let raster = Raster {
            lines: 16,
            inset_m: 0.0,
            corner_radius_m: r,
            feed_m_per_s: 0.02,
        };
        let path = vertices(FACE_M, &raster);
        let length: f64 = path.windows(2).map(|w| (w[1] - w[0]).norm()).sum();
        let expected = 1.66 - 30.0 * (2.0 - 0.5 * PI) * r;
        let chords = 30.0 * 0.5 * PI * r * (0.5 * PI / PIECES as f64).powi(2) / 24.0;
        assert!(
            (length - expected + chords).abs() < 1e-8,
            "{length} {expected}"
        );
    }

    /// With corners of half the spacing, lines end in half circles; nothing leaves the inset
    /// rectangle.
    #[test]
    fn corners_may_meet() {
        let raster = Raster {
            lines: 11,
            inset_m: 5e-3,
            corner_radius_m: 2.5e-3,
            feed_m_per_s: 0.02,
        };
        let path = vertices(FACE_M, &raster);
        let within = |x: f64, from: f64, to: f64| x >= from - 1e-12 && x <= to + 1e-12;
        assert!(
            path.iter()
                .all(|p| within(p.x, 5e-3, 0.095) && within(p.y, 5e-3, 0.055))
        );
        assert!(path.windows(2).all(|w| w[0] != w[1]));
        let steepest = (path.windows(3))
            .map(|w| (w[1] - w[0]).angle(&(w[2] - w[1])))
            .fold(0.0, f64::max);
        assert!(steepest < 0.08, "{steepest}");
    }
}
