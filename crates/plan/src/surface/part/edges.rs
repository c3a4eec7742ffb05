//! Edges between faces.

use std::collections::BTreeMap;

use nalgebra::Vector3;
use serde::Serialize;

use super::topology::{NONE, Topology};
use super::weld::Welded;

/// An edge along which two faces meet in a crease.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PartEdge {
    /// From 1.
    pub number: usize,
    /// Numbers of the two faces, the lower first; the same twice where a face meets itself.
    pub faces: [usize; 2],
    pub length_m: f64,
    /// Angle between the faces through the material, mean over the length: below π where the edge
    /// stands out, above where it lies in a corner.
    pub dihedral_rad: f64,
    /// Whether it ends where it begins.
    pub closed: bool,
    /// Once along it.
    #[serde(skip)]
    pub points_m: Vec<Vector3<f64>>,
    pub ends_m: [[f64; 3]; 2],
}

/// Vertices of an edge's piece, and the angle through the material there.
type Piece = ([u32; 2], f64);

/// All edges, the longest first.
pub(super) fn edges(
    mesh: &Welded,
    topology: &Topology,
    face_of: &[u32],
    crease_rad: f64,
) -> Vec<PartEdge> {
    let mut between: BTreeMap<[u32; 2], Vec<Piece>> = BTreeMap::new();
    for (triangle, neighbours) in topology.neighbours.iter().enumerate() {
        for (k, next) in neighbours.iter().enumerate() {
            if *next == NONE || *next as usize <= triangle {
                continue;
            }
            let other = *next as usize;
            let pair = [face_of[triangle], face_of[other]];
            let [one, two] = [triangle, other].map(|t| topology.normals[t].cast::<f64>());
            let turn = one.cross(&two).norm().atan2(one.dot(&two));
            if pair[0] == pair[1] && turn < crease_rad {
                continue;
            }
            let corners = mesh.triangles[triangle];
            let ends = [corners[k], corners[(k + 1) % 3]];
            // The far corner of the other triangle lies below this one where the edge stands out.
            let far = mesh.triangles[other].iter().find(|i| !ends.contains(i));
            let place = |i: u32| mesh.vertices_m[i as usize];
            let height = far.map_or(0.0, |far| (place(*far) - place(ends[0])).dot(&one));
            let angle = std::f64::consts::PI - turn.copysign(-height);
            let key = [pair[0].min(pair[1]), pair[0].max(pair[1])];
            between.entry(key).or_default().push((ends, angle));
        }
    }
    let mut found = Vec::new();
    for (pair, pieces) in &between {
        for chain in chains(pieces) {
            found.push(edge(mesh, *pair, pieces, &chain));
        }
    }
    found.sort_by(|a, b| b.length_m.total_cmp(&a.length_m));
    for (index, edge) in found.iter_mut().enumerate() {
        edge.number = index + 1;
    }
    found
}

/// A way along pieces: its vertices, and the pieces between them.
struct Chain {
    vertices: Vec<u32>,
    pieces: Vec<usize>,
}

/// Pieces joined end to end; where more than two meet, chains end.
fn chains(pieces: &[Piece]) -> Vec<Chain> {
    let mut at: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (index, (ends, _)) in pieces.iter().enumerate() {
        ends.iter()
            .for_each(|end| at.entry(*end).or_default().push(index));
    }
    let mut used = vec![false; pieces.len()];
    let mut found = Vec::new();
    let is_end = |vertex: u32| at[&vertex].len() != 2;
    // From the ends first; what is left is closed.
    let starts = at.iter().filter(|(vertex, _)| is_end(**vertex));
    let starts = starts.chain(at.iter().filter(|(vertex, _)| !is_end(**vertex)));
    for (start, around) in starts {
        for first in around {
            if used[*first] {
                continue;
            }
            let mut chain = Chain {
                vertices: vec![*start],
                pieces: Vec::new(),
            };
            let mut next = Some(*first);
            let mut here = *start;
            while let Some(piece) = next {
                used[piece] = true;
                let ends = pieces[piece].0;
                here = if ends[0] == here { ends[1] } else { ends[0] };
                chain.vertices.push(here);
                chain.pieces.push(piece);
                let onwards = at[&here].iter().find(|piece| !used[**piece]);
                next = onwards.copied().filter(|_| !is_end(here));
            }
            found.push(chain);
        }
    }
    found
}

fn edge(mesh: &Welded, pair: [u32; 2], pieces: &[Piece], chain: &Chain) -> PartEdge {
    let place = |i: &u32| mesh.vertices_m[*i as usize];
    let points_m: Vec<Vector3<f64>> = chain.vertices.iter().map(place).collect();
    let lengths = points_m.windows(2).map(|w| (w[1] - w[0]).norm());
    let length_m: f64 = lengths.clone().sum();
    let angles = chain.pieces.iter().map(|piece| pieces[*piece].1);
    let turned: f64 = lengths
        .zip(angles)
        .map(|(length, angle)| length * angle)
        .sum();
    PartEdge {
        number: 0,
        faces: pair.map(|face| face as usize + 1),
        length_m,
        dihedral_rad: turned / length_m.max(f64::MIN_POSITIVE),
        closed: chain.vertices.first() == chain.vertices.last(),
        ends_m: [points_m[0].into(), points_m[points_m.len() - 1].into()],
        points_m,
    }
}
