//! Blocks of many triangles.

use std::fmt::Write;
use truecut_plan::surface::Mesh;

/// An OBJ file of the mould block with its triangles cut into four, so many times, and their
/// number. The upper face is bulged, so that no two triangles of it lie in one plane; the edge
/// y = 0 stays.
pub fn halved(mesh: &Mesh, times: usize, bulge_mm: f64) -> (String, usize) {
    let mut points: Vec<_> = mesh.vertices_m().to_vec();
    let mut triangles = mesh.triangles().to_vec();
    for _ in 0..times {
        let mut middles = std::collections::HashMap::new();
        let mut middle = |a: usize, b: usize| {
            *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                points.push(0.5 * (points[a] + points[b]));
                points.len() - 1
            })
        };
        let quarters = triangles.iter().flat_map(|[a, b, c]| {
            let [d, e, f] = [middle(*a, *b), middle(*b, *c), middle(*c, *a)];
            [[*a, d, f], [d, *b, e], [f, e, *c], [d, e, f]]
        });
        triangles = quarters.collect();
    }
    let mut text = String::new();
    for p in &points {
        let [x, y, z] = [p.x, p.y, p.z].map(|x| x * 1e3);
        let bulge = bulge_mm * y * (60.0 - y) / 900.0 * (z - 10.0) / 10.0;
        let _ = writeln!(text, "v {x} {y} {}", z + bulge);
    }
    for t in &triangles {
        let [a, b, c] = t.map(|i| i + 1);
        let _ = writeln!(text, "f {a} {b} {c}");
    }
    (text, triangles.len())
}
