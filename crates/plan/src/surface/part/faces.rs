//! Faces: what triangles reach without crossing a crease.

use std::collections::VecDeque;

use nalgebra::{Unit, Vector3};
use serde::Serialize;

use super::cylinder::{self, Samples};
use super::topology::{NONE, Topology};
use super::weld::Welded;

/// A face is flat, or round, whose vertices lie within this share of the part's diagonal.
const SHAPE_SHARE: f64 = 1e-5;

/// What shape a face has, by its vertices.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum FaceKind {
    Planar,
    Cylindrical {
        radius_m: f64,
        axis: [f64; 3],
        /// A point of the axis, the nearest to the face's centre.
        axis_at_m: [f64; 3],
        /// The material is outside, as about a hole.
        hollow: bool,
    },
    Freeform,
}

/// A face of a part.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PartFace {
    /// From 1.
    pub number: usize,
    pub triangles: usize,
    pub area_m2: f64,
    /// Mean over the area.
    pub centre_m: [f64; 3],
    /// The middle of the triangle nearest to that, a point of the face.
    pub on_face_m: [f64; 3],
    /// Mean over the area, of length 1; zero where the face turns all round.
    pub normal: [f64; 3],
    #[serde(flatten)]
    pub shape: FaceKind,
    /// How far vertices lie off the plane or the cylinder at most; of a freeform face off its best
    /// plane.
    pub deviation_m: f64,
}

/// The faces, the largest first, and the face of each triangle.
pub(super) fn faces(
    mesh: &Welded,
    topology: &Topology,
    crease_rad: f64,
    weld_m: f64,
) -> (Vec<PartFace>, Vec<u32>) {
    let (mut face_of, members) = flood(topology, crease_rad);
    let [low, high] = super::extent(&mesh.vertices_m);
    let within_m = (SHAPE_SHARE * (high - low).norm()).max(weld_m);
    let mut faces: Vec<(usize, PartFace)> = (members.iter().enumerate())
        .map(|(index, triangles)| (index, describe(mesh, topology, triangles, within_m)))
        .collect();
    let by_area = |f: &(usize, PartFace)| f.1.area_m2;
    faces.sort_by(|a, b| by_area(b).total_cmp(&by_area(a)).then(a.0.cmp(&b.0)));
    let mut place = vec![0; faces.len()];
    for (number, (index, face)) in faces.iter_mut().enumerate() {
        face.number = number + 1;
        place[*index] = number as u32;
    }
    face_of
        .iter_mut()
        .for_each(|face| *face = place[*face as usize]);
    (faces.into_iter().map(|(_, face)| face).collect(), face_of)
}

/// A triangle too low to have a normal belongs to the face it is reached from, and is crossed with
/// that one's normal.
fn flood(topology: &Topology, crease_rad: f64) -> (Vec<u32>, Vec<Vec<u32>>) {
    let count = topology.neighbours.len();
    let least = crease_rad.cos() as f32;
    let zero = Vector3::zeros();
    let (mut face_of, mut members) = (vec![NONE; count], Vec::new());
    let mut queue = VecDeque::new();
    let has_normal = |triangle: &usize| topology.normals[*triangle] != zero;
    // Those without a normal begin faces only where nothing else reaches them.
    let seeds = (0..count).filter(has_normal);
    let seeds = seeds.chain((0..count).filter(|triangle| !has_normal(triangle)));
    for seed in seeds {
        if face_of[seed] != NONE {
            continue;
        }
        let face = members.len() as u32;
        let mut own = Vec::new();
        face_of[seed] = face;
        queue.push_back((seed as u32, topology.normals[seed]));
        while let Some((triangle, normal)) = queue.pop_front() {
            own.push(triangle);
            for next in topology.neighbours[triangle as usize] {
                if next == NONE || face_of[next as usize] != NONE {
                    continue;
                }
                let there = topology.normals[next as usize];
                let carried = if there == zero { normal } else { there };
                if carried == zero || carried.dot(&normal) > least {
                    face_of[next as usize] = face;
                    queue.push_back((next, carried));
                }
            }
        }
        own.sort_unstable();
        members.push(own);
    }
    (face_of, members)
}

fn describe(mesh: &Welded, topology: &Topology, triangles: &[u32], within_m: f64) -> PartFace {
    let mut samples = Samples::default();
    let (mut area_m2, mut centre, mut sum) = (0.0, Vector3::zeros(), Vector3::zeros());
    for triangle in triangles.iter().map(|t| *t as usize) {
        let area = topology.areas_m2[triangle];
        let normal: Vector3<f64> = topology.normals[triangle].cast();
        area_m2 += area;
        centre += mesh.middle(triangle) * area;
        sum += normal * area;
        samples.add(normal, area);
    }
    let least_m2 = f64::MIN_POSITIVE;
    centre = if area_m2 > least_m2 {
        centre / area_m2
    } else {
        mesh.middle(triangles[0] as usize)
    };
    let away = |triangle: &u32| (mesh.middle(*triangle as usize) - centre).norm_squared();
    let nearest = triangles.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
    let normal = sum.try_normalize(1e-6 * area_m2).unwrap_or_default();
    let mut vertices: Vec<u32> = (triangles.iter())
        .flat_map(|t| mesh.triangles[*t as usize])
        .collect();
    vertices.sort_unstable();
    vertices.dedup();
    let points = || vertices.iter().map(|i| mesh.vertices_m[*i as usize]);
    let off = |n: Vector3<f64>| {
        let heights = points().map(move |p| (p - centre).dot(&n));
        heights.fold((0.0_f64, 0.0_f64), |(low, high), h| {
            (low.min(h), high.max(h))
        })
    };
    let (below, above) = off(normal);
    let flat_m = above.max(-below);
    let round = || {
        let axis = Unit::new_normalize(samples.axis()?);
        let points: Vec<Vector3<f64>> = points().collect();
        let found = cylinder::fit(&points, &axis, &centre)?;
        (found.deviation_m <= within_m).then_some(found)
    };
    let (shape, deviation_m) = if flat_m <= within_m && normal != Vector3::zeros() {
        (FaceKind::Planar, flat_m)
    } else if let Some(found) = round() {
        let out = |t: &u32| {
            let spoke = mesh.middle(*t as usize) - found.axis_at_m;
            let normal: Vector3<f64> = topology.normals[*t as usize].cast();
            topology.areas_m2[*t as usize] * spoke.dot(&normal)
        };
        let shape = FaceKind::Cylindrical {
            radius_m: found.radius_m,
            axis: found.axis.into(),
            axis_at_m: found.axis_at_m.into(),
            hollow: triangles.iter().map(out).sum::<f64>() < 0.0,
        };
        (shape, found.deviation_m)
    } else {
        (FaceKind::Freeform, flat_m)
    };
    PartFace {
        number: 0,
        triangles: triangles.len(),
        area_m2,
        centre_m: centre.into(),
        on_face_m: mesh
            .middle(nearest.map_or(triangles[0], |t| *t) as usize)
            .into(),
        normal: normal.into(),
        shape,
        deviation_m,
    }
}
