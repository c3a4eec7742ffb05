//! Triangles of a face: Delaunay's of its outline in the parameters, refined until chords lie on
//! the surface.

use std::collections::{HashMap, HashSet, VecDeque};

use nalgebra::Vector3;
use spade::handles::{FixedFaceHandle, FixedVertexHandle, InnerTag};
use spade::{
    ConstrainedDelaunayTriangulation, HasPosition, Point2, PositionInTriangulation, Triangulation,
};

use super::curve::Fineness;
use super::outline::Line;
use super::shape::Shape;

/// Times that triangles are refined.
const ROUNDS: usize = 40;
/// Share of the longest side about it within which a new vertex is beside one that is there.
const BESIDE: f64 = 0.05;
/// Most vertices of a face.
const MOST: usize = 400_000;

#[derive(Clone, Copy)]
struct Place {
    at: Point2<f64>,
    vertex: u32,
}

impl HasPosition for Place {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.at
    }
}

type Net = ConstrainedDelaunayTriangulation<Place>;

/// Triangles of a face, vertices of its inside added to the part's. `None` if its lines cross.
pub(super) fn triangles(
    shape: &Shape,
    lines: &[Line],
    vertices: &mut Vec<Vector3<f64>>,
    fine: &Fineness,
    is_along: bool,
) -> Option<Vec<[u32; 3]>> {
    let scale = scales(shape, lines);
    let spread = |uv: [f64; 2]| Point2::new(uv[0] * scale[0], uv[1] * scale[1]);
    let narrowed = |at: Point2<f64>| [at.x / scale[0], at.y / scale[1]];
    let mut net = Net::new();
    for line in lines {
        let mut handles: Vec<FixedVertexHandle> = Vec::with_capacity(line.len());
        for corner in line {
            let (at, vertex) = (spread(corner.uv), corner.vertex);
            handles.push(net.insert(Place { at, vertex }).ok()?);
        }
        handles.dedup();
        for (a, b) in handles.iter().zip(handles.iter().cycle().skip(1)) {
            if a != b && !net.exists_constraint(*a, *b) {
                let is_laid = !net.try_add_constraint(*a, *b).is_empty();
                if !is_laid {
                    return None;
                }
            }
        }
    }
    if !matches!(shape, Shape::Plane(_)) {
        for _ in 0..ROUNDS {
            let wanted = coarse(shape, &net, vertices, fine, &narrowed);
            if wanted.is_empty() || net.num_vertices() + wanted.len() > MOST {
                break;
            }
            let before = net.num_vertices();
            for at in wanted {
                let p = shape.at(narrowed(at));
                if is_beside(&net, at, &p, vertices) {
                    continue;
                }
                let (vertex, had) = (vertices.len() as u32, net.num_vertices());
                net.insert(Place { at, vertex }).ok()?;
                if net.num_vertices() > had {
                    vertices.push(p);
                }
            }
            if net.num_vertices() == before {
                break;
            }
        }
    }
    let inside = inside(&net);
    let corners = net.inner_faces().filter(|face| inside[face.fix().index()]);
    let turned = |t: [u32; 3]| if is_along { t } else { [t[0], t[2], t[1]] };
    let mut found: Vec<[u32; 3]> = corners
        .map(|face| turned(face.vertices().map(|vertex| vertex.data().vertex)))
        // Where a pole stands several times, triangles have no area.
        .filter(|[a, b, c]| a != b && b != c && c != a)
        .collect();
    without_flat(&mut found, vertices, 0.05 * fine.chord);
    Some(found)
}

/// Whether a place has a vertex beside it, for the size of the triangles there: both long sides of
/// a needle ask for their middles, of which one will do.
fn is_beside(net: &Net, at: Point2<f64>, p: &Vector3<f64>, vertices: &[Vector3<f64>]) -> bool {
    let mut corners: Vec<u32> = Vec::new();
    let mut add = |face: FixedFaceHandle<InnerTag>| {
        corners.extend(net.face(face).vertices().map(|v| v.data().vertex));
    };
    match net.locate(at) {
        PositionInTriangulation::OnVertex(_) => return true,
        PositionInTriangulation::OnFace(face) => add(face),
        PositionInTriangulation::OnEdge(edge) => {
            let edge = net.directed_edge(edge);
            for face in [edge.face(), edge.rev().face()] {
                face.as_inner().into_iter().for_each(|face| add(face.fix()));
            }
        }
        _ => return false,
    }
    let places = || corners.iter().map(|i| &vertices[*i as usize]);
    let longest = places().flat_map(|a| places().map(move |b| (a - b).norm()));
    let least = BESIDE * longest.fold(0.0, f64::max);
    places().any(|corner| (corner - p).norm() < least)
}

/// What a unit of each parameter is long, on average over the face.
fn scales(shape: &Shape, lines: &[Line]) -> [f64; 2] {
    let (mut low, mut high) = ([f64::INFINITY; 2], [-f64::INFINITY; 2]);
    for corner in lines.iter().flatten() {
        for k in 0..2 {
            low[k] = low[k].min(corner.uv[k]);
            high[k] = high[k].max(corner.uv[k]);
        }
    }
    [0, 1].map(|k| {
        let step = 1e-3 * (high[k] - low[k]);
        if step <= 0.0 {
            return 1.0;
        }
        let mut sum = 0.0;
        for i in 0..25 {
            let shares = [(i / 5) as f64 + 0.5, (i % 5) as f64 + 0.5];
            let mut uv = [0, 1].map(|k| low[k] + (high[k] - low[k]) * shares[k] / 5.0);
            let here = shape.at(uv);
            uv[k] += step;
            sum += (shape.at(uv) - here).norm() / step;
        }
        (sum / 25.0).max(1e-9)
    })
}

/// Which faces of the net lie within the lines: those an odd number of lines away from outside.
fn inside(net: &Net) -> Vec<bool> {
    let outer = net.outer_face();
    let mut known: Vec<Option<bool>> = vec![None; net.num_all_faces()];
    known[outer.fix().index()] = Some(false);
    let mut queue = VecDeque::new();
    for edge in net.convex_hull() {
        // Hull edges have the outer face on one side.
        let inner = if edge.is_outer_edge() {
            edge.rev()
        } else {
            edge
        };
        if let Some(face) = inner.face().as_inner() {
            let index = face.fix().index();
            if known[index].is_none() {
                known[index] = Some(edge.is_constraint_edge());
                queue.push_back(face.fix());
            }
        }
    }
    while let Some(face) = queue.pop_front() {
        let here = known[face.index()].unwrap_or(false);
        for edge in net.face(face).adjacent_edges() {
            if let Some(next) = edge.rev().face().as_inner() {
                let index = next.fix().index();
                if known[index].is_none() {
                    known[index] = Some(here != edge.is_constraint_edge());
                    queue.push_back(next.fix());
                }
            }
        }
    }
    known.into_iter().map(|is| is.unwrap_or(false)).collect()
}

/// Places at which triangles are to be parted: in the middle of that chord of each which lies
/// farthest off the surface, or turns too far.
fn coarse(
    shape: &Shape,
    net: &Net,
    vertices: &[Vector3<f64>],
    fine: &Fineness,
    narrowed: &dyn Fn(Point2<f64>) -> [f64; 2],
) -> Vec<Point2<f64>> {
    let inside = inside(net);
    let mut seen = HashSet::new();
    let mut wanted = Vec::new();
    for face in net.inner_faces().filter(|face| inside[face.fix().index()]) {
        let mut worst: Option<(f64, Point2<f64>)> = None;
        for edge in face.adjacent_edges() {
            if edge.is_constraint_edge() {
                continue;
            }
            let [a, b] = [edge.from(), edge.to()];
            let (pa, pb) = (a.position(), b.position());
            let middle = Point2::new(0.5 * (pa.x + pb.x), 0.5 * (pa.y + pb.y));
            let [from, to] = [a, b].map(|v| vertices[v.data().vertex as usize]);
            let off = off(shape.at(narrowed(middle)), from, to, fine);
            if off > 1.0 && worst.is_none_or(|(most, _)| off > most) {
                worst = Some((off, middle));
            }
        }
        if let Some((_, at)) = worst {
            if seen.insert((at.x.to_bits(), at.y.to_bits())) {
                wanted.push(at);
            }
            continue;
        }
        let corners = face.vertices();
        let at = corners.map(|v| v.position());
        let middle = Point2::new(
            (at[0].x + at[1].x + at[2].x) / 3.0,
            (at[0].y + at[1].y + at[2].y) / 3.0,
        );
        let [a, b, c] = corners.map(|v| vertices[v.data().vertex as usize]);
        let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
        let Some(normal) = (b - a)
            .cross(&(c - a))
            .try_normalize(1e-6 * longest * longest)
        else {
            continue;
        };
        if (shape.at(narrowed(middle)) - a).dot(&normal).abs() > fine.chord {
            wanted.push(middle);
        }
    }
    wanted
}

/// How far the surface lies off the middle of a chord, over what it may; a turn beside that, where
/// chords are not short already.
fn off(p: Vector3<f64>, from: Vector3<f64>, to: Vector3<f64>, fine: &Fineness) -> f64 {
    let Some(way) = (to - from).try_normalize(1e-9) else {
        return 0.0;
    };
    let length = (to - from).norm();
    let across = (p - from - way * (p - from).dot(&way)).norm();
    if length < fine.chord {
        return 0.0;
    }
    (across / fine.chord).max(8.0 * across / length / (2.0 * fine.turn))
}

/// Triangles whose corners lie on one line, as along straight borders by rounding, are turned into
/// the one beside them.
fn without_flat(triangles: &mut [[u32; 3]], vertices: &[Vector3<f64>], within: f64) {
    let at = |i: u32| vertices[i as usize];
    for _ in 0..4 {
        let mut beside: HashMap<(u32, u32), usize> = HashMap::new();
        for (index, [a, b, c]) in triangles.iter().enumerate() {
            for side in [(*a, *b), (*b, *c), (*c, *a)] {
                beside.insert(side, index);
            }
        }
        let mut touched = HashSet::new();
        let mut flipped = 0;
        for index in 0..triangles.len() {
            let own = triangles[index];
            let length = |k: usize| (at(own[(k + 1) % 3]) - at(own[k])).norm();
            let k = (0..3)
                .max_by(|a, b| length(*a).total_cmp(&length(*b)))
                .unwrap_or(0);
            let [a, c, b] = [own[k], own[(k + 1) % 3], own[(k + 2) % 3]];
            let height = (at(b) - at(a)).cross(&(at(c) - at(a))).norm() / length(k).max(1e-12);
            let Some(other) = beside.get(&(c, a)).copied().filter(|_| height < within) else {
                continue;
            };
            if other == index || touched.contains(&index) || touched.contains(&other) {
                continue;
            }
            let Some(d) = triangles[other].into_iter().find(|i| *i != a && *i != c) else {
                continue;
            };
            if d == b {
                continue;
            }
            triangles[index] = [a, d, b];
            triangles[other] = [d, c, b];
            touched.extend([index, other]);
            flipped += 1;
        }
        if flipped == 0 {
            return;
        }
    }
}
