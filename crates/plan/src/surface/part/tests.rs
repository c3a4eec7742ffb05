use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::*;
use crate::surface::mesh::tests::block;

const OPTIONS: PartOptions = PartOptions {
    unit_m: 1e-3,
    crease_rad: PI / 6.0,
    weld_m: None,
};

/// Triangles as a soup, each with its own corners, in mm and in single precision as an STL has.
fn soup(vertices_m: &[Vector3<f64>], triangles: &[[usize; 3]]) -> MeshData {
    let corners = triangles.iter().flatten();
    let vertices = corners.map(|i| (vertices_m[*i] * 1e3).map(|x| f64::from(x as f32)));
    let count = triangles.len() as u32;
    MeshData {
        vertices: vertices.collect(),
        triangles: (0..count).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
        against_stated_normal: Vec::new(),
    }
}

fn look(data: MeshData) -> Part {
    Part::of(data, &OPTIONS, &|_| {}).expect("a part")
}

/// A tube along z, inner and outer radius, its walls cut into slices.
fn tube(inner_m: f64, outer_m: f64, length_m: f64, slices: usize) -> MeshData {
    let ring = |radius: f64, z: f64| {
        (0..slices).map(move |k| {
            let (s, c) = (TAU * k as f64 / slices as f64).sin_cos();
            Vector3::new(radius * c, radius * s, z)
        })
    };
    let rings = [
        (outer_m, 0.0),
        (outer_m, length_m),
        (inner_m, length_m),
        (inner_m, 0.0),
    ];
    let vertices: Vec<_> = rings.iter().flat_map(|(r, z)| ring(*r, *z)).collect();
    let mut triangles = Vec::new();
    for (from, to) in [(0, 1), (1, 2), (2, 3), (3, 0)] {
        for k in 0..slices {
            let next = (k + 1) % slices;
            let [a, b] = [from * slices + k, from * slices + next];
            let [c, d] = [to * slices + next, to * slices + k];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    soup(&vertices, &triangles)
}

#[test]
fn verify_a_block_has_six_flat_faces_and_twelve_right_edges() {
    let (vertices, triangles) = block();
    let part = look(soup(&vertices, &triangles));
    assert_eq!(
        (part.vertex_count, part.shells, part.faces.len()),
        (8, 1, 6)
    );
    assert!((part.area_m2 / (2.0 * (6e-3 + 1.2e-3 + 2e-3)) - 1.0).abs() < 1e-7);
    assert!((part.volume_m3.expect("closed") / 1.2e-4 - 1.0).abs() < 1e-7);
    assert!(
        part.defects
            .named()
            .iter()
            .all(|(_, defect)| defect.count == 0)
    );
    assert_eq!(part.suspected_unit, None);
    let top = &part.faces[1];
    assert!(part.faces.iter().all(|face| face.shape == FaceKind::Planar));
    assert!((top.area_m2 / 6e-3 - 1.0).abs() < 1e-7 && (top.normal[2].abs() - 1.0).abs() < 1e-7);
    assert_eq!(part.edges.len(), 12);
    assert!((part.edges[0].length_m - 0.1).abs() < 1e-8);
    for edge in &part.edges {
        assert!((edge.dihedral_rad - FRAC_PI_2).abs() < 1e-6 && !edge.closed);
    }
}

#[test]
fn verify_a_tube_has_a_hollow_and_a_full_wall_and_four_closed_edges() {
    let slices = 96;
    let part = look(tube(0.02, 0.05, 0.03, slices));
    let round: Vec<_> = (part.faces.iter())
        .filter_map(|face| match face.shape {
            FaceKind::Cylindrical {
                radius_m,
                axis,
                hollow,
                ..
            } => Some((radius_m, axis, hollow)),
            _ => None,
        })
        .collect();
    assert_eq!((part.faces.len(), round.len()), (4, 2));
    for ((radius_m, axis, hollow), expected) in round.iter().zip([(0.05, false), (0.02, true)]) {
        assert!((radius_m / expected.0 - 1.0).abs() < 1e-6 && *hollow == expected.1);
        assert!((axis[2].abs() - 1.0).abs() < 1e-6);
    }
    // Of the prism that the tube is cut into.
    let share = (TAU / slices as f64).sin() / (TAU / slices as f64);
    let volume = PI * (0.05_f64.powi(2) - 0.02_f64.powi(2)) * 0.03 * share;
    assert!((part.volume_m3.expect("closed") / volume - 1.0).abs() < 1e-6);
    assert_eq!(part.edges.len(), 4);
    let chord = 2.0 * (PI / slices as f64).sin() * slices as f64;
    for (edge, radius) in part.edges.iter().zip([0.05, 0.05, 0.02, 0.02]) {
        assert!(edge.closed && (edge.length_m / (chord * radius) - 1.0).abs() < 1e-6);
        assert!((edge.dihedral_rad - FRAC_PI_2).abs() < 1e-5);
    }
}

#[test]
fn an_edge_in_a_corner_has_more_than_half_a_turn_of_material() {
    // A step: the profile of a stair, drawn out along y.
    let profile = [
        [0.0, 0.0],
        [0.02, 0.0],
        [0.02, 0.01],
        [0.01, 0.01],
        [0.01, 0.02],
        [0.0, 0.02],
    ];
    let at = |y: f64| profile.iter().map(move |[x, z]| Vector3::new(*x, y, *z));
    let vertices: Vec<_> = at(0.0).chain(at(0.03)).collect();
    let mut triangles = Vec::new();
    for k in 0..6 {
        let next = (k + 1) % 6;
        triangles.extend([[k, next + 6, next], [k, k + 6, next + 6]]);
    }
    for [a, b, c] in [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]] {
        triangles.extend([[a, b, c], [a + 6, c + 6, b + 6]]);
    }
    let part = look(soup(&vertices, &triangles));
    assert_eq!((part.faces.len(), part.edges.len()), (8, 18));
    assert!((part.volume_m3.expect("closed") / 9e-6 - 1.0).abs() < 1e-6);
    let inner: Vec<_> = part.edges.iter().filter(|e| e.dihedral_rad > PI).collect();
    assert_eq!(inner.len(), 1);
    assert!((inner[0].dihedral_rad - 1.5 * PI).abs() < 1e-6);
}

#[test]
fn each_defect_is_counted_with_its_place() {
    let (vertices, triangles) = block();
    let defects = |vertices: &[_], triangles: &[_]| look(soup(vertices, triangles)).defects;
    let open = defects(&vertices, &triangles[1..]);
    assert_eq!(open.open_edges.count, 3);
    let at: Vector3<f64> = open.open_edges.first_at_m.expect("a place").into();
    assert!(vertices.iter().any(|v| (v - at).norm() < 0.06), "{at}");
    let mut turned = triangles.clone();
    turned[4].swap(0, 1);
    let inverted = defects(&vertices, &turned);
    assert_eq!(inverted.inverted_triangles.count, 1);
    assert_eq!((inverted.open_edges.count, inverted.inside_out), (0, false));
    let inward: Vec<_> = triangles.iter().map(|t| [t[1], t[0], t[2]]).collect();
    assert!(defects(&vertices, &inward).inside_out);
    let mut more = vertices.clone();
    more.push(Vector3::new(0.05, 0.03, 0.05));
    let mut fin = triangles.clone();
    fin.push([0, 1, 8]);
    assert_eq!(defects(&more, &fin).non_manifold_edges.count, 1);
    let mut twice = triangles.clone();
    twice.push(triangles[3]);
    let twice = defects(&vertices, &twice);
    assert_eq!(
        (
            twice.duplicate_triangles.count,
            twice.non_manifold_edges.count
        ),
        (1, 0)
    );
    more[8] = vertices[0] + Vector3::repeat(5e-8);
    let mut near = triangles.clone();
    near[0][0] = 8;
    let near = defects(&more, &near);
    assert_eq!((near.welded_vertices.count, near.open_edges.count), (1, 0));
    let mut needle = triangles.clone();
    needle.push([0, 0, 3]);
    assert_eq!(defects(&vertices, &needle).degenerate_triangles.count, 1);
    // All sides of some 7 um, on a part of 118 mm.
    let (mut small, corner) = (vertices.clone(), vertices[0]);
    small.extend([5e-6, 10e-6].map(|x| corner + Vector3::new(x, x, 0.0)));
    small[9].y = corner.y;
    let mut tiny = triangles.clone();
    tiny.push([0, 8, 9]);
    assert_eq!(defects(&small, &tiny).tiny_triangles.count, 1);
    let mut stated = soup(&vertices, &triangles);
    stated.against_stated_normal = vec![2, 7];
    assert_eq!(look(stated).defects.against_stated_normal.count, 2);
}

#[test]
fn a_sheet_that_bends_is_freeform_and_parts_at_no_crease() {
    let (rows, mut triangles) = (40, Vec::new());
    let at = |i: usize, j: usize| {
        let [x, y] = [i, j].map(|k| 0.1 * k as f64 / rows as f64);
        Vector3::new(x, y, 0.3 * (x * x - y * y) + 0.1 * x * y)
    };
    let index = |i: usize, j: usize| i * (rows + 1) + j;
    let vertices: Vec<_> = (0..=rows)
        .flat_map(|i| (0..=rows).map(move |j| at(i, j)))
        .collect();
    for (i, j) in (0..rows).flat_map(|i| (0..rows).map(move |j| (i, j))) {
        let [a, b] = [index(i, j), index(i + 1, j)];
        let [c, d] = [index(i + 1, j + 1), index(i, j + 1)];
        triangles.extend([[a, b, c], [a, c, d]]);
    }
    let part = look(soup(&vertices, &triangles));
    assert_eq!((part.faces.len(), part.edges.len()), (1, 0));
    assert_eq!(part.faces[0].shape, FaceKind::Freeform);
    assert_eq!(part.defects.open_edges.count, 4 * rows);
    assert_eq!(part.volume_m3, None);
}
