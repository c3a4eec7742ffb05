//! Simple shapes as triangles.

use std::f64::consts::{PI, TAU};

use truecut_recording::Geometry;

use super::thin::Surface;

/// Sides of what is round.
const SIDES: usize = 24;
/// Rings of a half ball.
const RINGS: usize = 6;

/// The triangles of a form; none of a line.
pub fn surface(geometry: &Geometry) -> Option<Surface> {
    Some(match geometry {
        Geometry::Box { half_extents_m } => cuboid(half_extents_m),
        Geometry::Cylinder { radius_m, length_m } => {
            let half_m = 0.5 * length_m;
            let ends = [(0.0, -half_m), (*radius_m, -half_m)];
            turned(&[ends[0], ends[1], (*radius_m, half_m), (0.0, half_m)])
        }
        Geometry::Capsule { radius_m, length_m } => round(*radius_m, 0.5 * length_m),
        Geometry::Sphere { radius_m } => round(*radius_m, 0.0),
        Geometry::Mesh {
            vertices_m,
            triangles,
        } => Surface {
            corners_m: vertices_m.clone(),
            triangles: triangles.clone(),
            values: Vec::new(),
        },
        Geometry::Line { .. } => return None,
    })
}

fn cuboid(half_m: &[f64; 3]) -> Surface {
    let corner = |k: usize| {
        std::array::from_fn(|axis| match (k >> axis) & 1 {
            0 => -half_m[axis],
            _ => half_m[axis],
        })
    };
    let faces = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let halves = faces
        .iter()
        .flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
    Surface {
        corners_m: (0..8).map(corner).collect(),
        triangles: halves.collect(),
        values: Vec::new(),
    }
}

/// Half balls on a cylinder along z.
fn round(radius_m: f64, half_m: f64) -> Surface {
    let at = |end_m: f64, from_rad: f64| {
        (0..=RINGS).map(move |k| {
            let angle = from_rad + 0.5 * PI * k as f64 / RINGS as f64;
            // On the axis to the bit, where a pole is one corner.
            let out = if angle.cos() < 1e-9 { 0.0 } else { angle.cos() };
            (radius_m * out, end_m + radius_m * angle.sin())
        })
    };
    turned(
        &at(-half_m, -0.5 * PI)
            .chain(at(half_m, 0.0))
            .collect::<Vec<_>>(),
    )
}

/// A line of radius and height, from the lowest up, turned about z. Points on the axis are poles.
fn turned(line: &[(f64, f64)]) -> Surface {
    let mut made = Surface::default();
    let mut rings: Vec<Vec<u32>> = Vec::new();
    for (radius_m, z_m) in line {
        let count = if *radius_m > 0.0 { SIDES } else { 1 };
        let first = made.corners_m.len() as u32;
        rings.push((0..SIDES).map(|k| first + (k % count) as u32).collect());
        made.corners_m.extend((0..count).map(|k| {
            let angle = TAU * k as f64 / SIDES as f64;
            [radius_m * angle.cos(), radius_m * angle.sin(), *z_m]
        }));
    }
    for pair in rings.windows(2) {
        for k in 0..SIDES {
            let next = (k + 1) % SIDES;
            let [a, b, c, d] = [pair[0][k], pair[0][next], pair[1][next], pair[1][k]];
            made.triangles.extend(
                [[a, b, c], [a, c, d]]
                    .into_iter()
                    .filter(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]),
            );
        }
    }
    made
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Volume by the divergence theorem: each triangle with the origin, seen from outside.
    fn volume_m3(surface: &Surface) -> f64 {
        let at = |k: u32| surface.corners_m[k as usize];
        let parts = surface.triangles.iter().map(|[a, b, c]| {
            let (a, b, c) = (at(*a), at(*b), at(*c));
            let cross = [
                b[1] * c[2] - b[2] * c[1],
                b[2] * c[0] - b[0] * c[2],
                b[0] * c[1] - b[1] * c[0],
            ];
            (a[0] * cross[0] + a[1] * cross[1] + a[2] * cross[2]) / 6.0
        });
        parts.sum()
    }

    /// Closed and looking outwards: volumes are those of the forms, those of round ones a little
    /// less (a regular polygon of n sides has n / 2π sin(2π / n) of its circle's area).
    #[test]
    fn verify_forms_enclose_their_volumes() {
        let polygon = SIDES as f64 / TAU * (TAU / SIDES as f64).sin();
        let volume = |geometry| volume_m3(&surface(&geometry).unwrap());
        let half_extents_m = [0.1, 0.2, 0.3];
        assert!((volume(Geometry::Box { half_extents_m }) - 0.048).abs() < 1e-12);
        let (radius_m, length_m) = (0.2, 0.7);
        let cylinder = PI * radius_m * radius_m * length_m;
        let found = volume(Geometry::Cylinder { radius_m, length_m });
        assert!(
            (found / (cylinder * polygon) - 1.0).abs() < 1e-12,
            "{found}"
        );
        let ball = 4.0 / 3.0 * PI * f64::powi(radius_m, 3);
        let found = volume(Geometry::Sphere { radius_m });
        assert!((0.95 * ball..ball).contains(&found), "{found} of {ball}");
        let capsule = volume(Geometry::Capsule { radius_m, length_m });
        assert!((capsule - found - cylinder * polygon).abs() < 1e-12);
    }
}
