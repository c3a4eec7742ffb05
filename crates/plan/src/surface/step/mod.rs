//! Bodies of STEP files (ISO 10303, AP203, AP214, AP242) as closed meshes.
//!
//! Edges are cut once, so that faces meet in the same vertices; each face is triangulated in the
//! parameters of its surface. Lengths come out in mm, whatever the file's unit, which it says
//! itself.

mod curve;
mod entities;
mod no_body;
mod outline;
mod part21;
mod patch;
mod places;
mod shape;
mod spline;
#[cfg(test)]
mod tests;
mod triangles;

use std::collections::HashMap;

use nalgebra::Vector3;
use serde::Serialize;
use truecut_arm::MeshData;

use curve::{Curve, Fineness, sense};
use entities::{Model, get, is_true, list, reference};
use outline::Off;
use part21::{Entity, Fault, Part21, Value};
use places::Places;
use shape::Shape;

/// Farthest that a chord lies off edge or surface, share of the part's diagonal.
const CHORD_SHARE: f64 = 5e-5;
/// Angle from a chord to the next, rad: the area of a round face is off by its square over 24.
const TURN_RAD: f64 = 0.07;
/// How finely a body is cut for its size alone.
const ROUGH: Fineness = Fineness {
    chord: f64::INFINITY,
    turn: 1.0,
};

/// Entities that are bodies.
const BODIES: [&str; 4] = [
    "MANIFOLD_SOLID_BREP",
    "BREP_WITH_VOIDS",
    "FACETED_BREP",
    "SHELL_BASED_SURFACE_MODEL",
];

/// A face as the modeller has it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StepFace {
    /// Number of the entity.
    pub entity: u64,
    /// Its surface, in a word.
    pub kind: &'static str,
    /// Of the triangles that stand for it.
    pub area_m2: f64,
}

/// A body, mm.
#[derive(Debug)]
pub(super) struct StepBody {
    pub(super) mesh: MeshData,
    pub(super) faces: Vec<StepFace>,
}

/// Reads what a STEP file holds: line and reason if it cannot be.
///
/// # Errors
/// If the text is damaged, or holds entities that are not read, which are named.
pub(super) fn read(bytes: &[u8]) -> Result<StepBody, (Option<usize>, String)> {
    body(bytes).map_err(|fault| (fault.line, fault.message))
}

fn body(bytes: &[u8]) -> Result<StepBody, Fault> {
    let file = Part21::new(bytes)?;
    let named = |name: &str| {
        file.numbers
            .iter()
            .filter(|n| file.name(**n) == Some(name))
            .count()
    };
    if named("MAPPED_ITEM") > 0 {
        return Err(Fault::new(
            "MAPPED_ITEM: the file holds a body that is used at several places; export one part alone",
        ));
    }
    let mut names = file.numbers.iter().filter_map(|n| file.name(*n));
    if !names.any(|name| BODIES.contains(&name)) {
        return Err(no_body::fault(&file));
    }
    let model = Model::new(&file)?;
    let places = Places::new(&model)?;
    let mut mesh = MeshData::default();
    let mut faces = Vec::new();
    for number in &file.numbers {
        let Some(name) = file.name(*number).filter(|name| BODIES.contains(name)) else {
            continue;
        };
        let entity = file.entity(*number)?;
        let shells = shells(&model, &entity, name)?;
        let mut rough = Builder::new(&model, ROUGH);
        for (shell, is_along) in &shells {
            rough.shell(shell, *is_along)?;
        }
        let size = rough.diagonal();
        let fine = Fineness {
            chord: CHORD_SHARE * size,
            turn: TURN_RAD,
        };
        let mut builder = Builder::new(&model, fine);
        builder.size = size;
        for (shell, is_along) in &shells {
            builder.shell(shell, *is_along)?;
        }
        let place = places.of(&model, *number)?;
        let first = mesh.vertices.len() as u32;
        mesh.vertices
            .extend(builder.vertices.iter().map(|p| place.at(p)));
        let moved = builder.triangles.iter().map(|t| t.map(|i| i + first));
        mesh.triangles.extend(moved);
        faces.extend(builder.faces);
    }
    if mesh.triangles.is_empty() {
        return Err(Fault::new("the file's bodies have no faces"));
    }
    Ok(StepBody { mesh, faces })
}

/// The shells of a body, and whether their faces look outside as they stand.
fn shells(model: &Model<'_>, body: &Entity, name: &str) -> Result<Vec<(Entity, bool)>, Fault> {
    let values = body.part(name).unwrap_or_default();
    let mut own: Vec<&Value> = match get(body, values, 1)? {
        Value::List(shells) => shells.iter().collect(),
        one => vec![one],
    };
    if name == "BREP_WITH_VOIDS" {
        own.extend(list(body, get(body, values, 2)?)?);
    }
    let mut found = Vec::new();
    for shell in own {
        let shell = model.follow(body, shell)?;
        found.push(match shell.part("ORIENTED_CLOSED_SHELL") {
            Some(values) => {
                let is_along = is_true(&shell, get(&shell, values, 3)?)?;
                (model.follow(&shell, get(&shell, values, 2)?)?, is_along)
            }
            None => (shell, true),
        });
    }
    Ok(found)
}

struct Builder<'a> {
    model: &'a Model<'a>,
    fine: Fineness,
    /// Diagonal of the box about the body, mm.
    size: f64,
    vertices: Vec<Vector3<f64>>,
    triangles: Vec<[u32; 3]>,
    faces: Vec<StepFace>,
    /// Vertices of VERTEX_POINTs and of points of polygons.
    known: HashMap<u64, u32>,
    /// Vertices along EDGE_CURVEs.
    edges: HashMap<u64, Vec<u32>>,
}

impl<'a> Builder<'a> {
    fn new(model: &'a Model<'a>, fine: Fineness) -> Self {
        Self {
            model,
            fine,
            // Until it is known nothing is held against it.
            size: f64::INFINITY,
            vertices: Vec::new(),
            triangles: Vec::new(),
            faces: Vec::new(),
            known: HashMap::new(),
            edges: HashMap::new(),
        }
    }

    fn diagonal(&self) -> f64 {
        let first = self.vertices.first().copied().unwrap_or_default();
        let low = self.vertices.iter().fold(first, |low, v| low.inf(v));
        let high = self.vertices.iter().fold(first, |high, v| high.sup(v));
        (high - low).norm()
    }

    fn shell(&mut self, shell: &Entity, is_along: bool) -> Result<(), Fault> {
        let values = ["CLOSED_SHELL", "OPEN_SHELL"];
        let values = values.iter().find_map(|name| shell.part(name));
        let values = values.ok_or_else(|| shell.fault("shells of this kind are not read"))?;
        for face in list(shell, get(shell, values, 1)?)? {
            let mut face = self.model.follow(shell, face)?;
            let mut is_along = is_along;
            if let Some(values) = face.part("ORIENTED_FACE") {
                is_along ^= !is_true(&face, get(&face, values, 3)?)?;
                face = self.model.follow(&face, get(&face, values, 2)?)?;
            }
            self.face(&face, is_along)?;
        }
        Ok(())
    }

    fn face(&mut self, face: &Entity, is_outside: bool) -> Result<(), Fault> {
        let is_rough = self.size.is_infinite();
        let values = ["ADVANCED_FACE", "FACE_SURFACE"];
        let values = values.iter().find_map(|name| face.part(name));
        let values = values.ok_or_else(|| face.fault("faces of this kind are not read"))?;
        let surface = reference(face, get(face, values, 2)?)?;
        let shape = Shape::read(self.model, surface).map_err(|fault| within(face, fault))?;
        let is_along = is_true(face, get(face, values, 3)?)?;
        let mut lines = Vec::new();
        for bound in list(face, get(face, values, 1)?)? {
            let bound = self.model.follow(face, bound)?;
            let line = self.bound(&bound).map_err(|fault| within(face, fault))?;
            if line.len() > 1 {
                lines.push(line);
            }
        }
        if is_rough {
            // Edges tell the size, but for a ball or a ring, which has none.
            let [us, vs] = shape.whole().unwrap_or([[0.0; 2]; 2]);
            for k in 0..16 {
                let at = |[low, high]: [f64; 2], k: usize| low + (high - low) * k as f64 / 3.0;
                if us[1] > us[0] {
                    self.vertices.push(shape.at([at(us, k % 4), at(vs, k / 4)]));
                }
            }
            return Ok(());
        }
        let (fine, size) = (self.fine, self.size);
        let laid = outline::laid(&shape, &lines, &mut self.vertices, size, is_along);
        let laid = laid.map_err(|off| {
            face.fault(match off {
                Off::Edge(mm) => format!(
                    "an edge lies {mm:.4} mm off its surface; the limit is {:.4} mm, a thousandth of the part",
                    1e-3 * size
                ),
                Off::Round => format!(
                    "its lines go round the {} so that they bound no face that is read",
                    shape.kind()
                ),
            })
        })?;
        let crossed = || face.fault("the lines around it cross each other");
        let mut own = triangles::triangles(&shape, &laid, &mut self.vertices, &fine, is_along)
            .ok_or_else(crossed)?;
        if !is_outside {
            own.iter_mut().for_each(|t| t.swap(1, 2));
        }
        let at = |i: u32| self.vertices[i as usize];
        let areas = own.iter().map(|t| {
            let [a, b, c] = t.map(at);
            0.5 * (b - a).cross(&(c - a)).norm()
        });
        self.faces.push(StepFace {
            entity: face.number,
            kind: shape.kind(),
            area_m2: 1e-6 * areas.sum::<f64>(),
        });
        self.triangles.extend(own);
        Ok(())
    }

    /// Vertices of a closed line, the first not repeated.
    fn bound(&mut self, bound: &Entity) -> Result<Vec<u32>, Fault> {
        let values = ["FACE_OUTER_BOUND", "FACE_BOUND"];
        let values = values.iter().find_map(|name| bound.part(name));
        let values = values.ok_or_else(|| bound.fault("bounds of this kind are not read"))?;
        let line = self.model.follow(bound, get(bound, values, 1)?)?;
        let mut vertices: Vec<u32> = if let Some(values) = line.part("POLY_LOOP") {
            let points = list(&line, get(&line, values, 1)?)?.iter();
            let points: Vec<u64> = points
                .map(|p| reference(&line, p))
                .collect::<Result<_, _>>()?;
            let own = points.iter().map(|p| self.point_vertex(*p));
            own.collect::<Result<_, _>>()?
        } else if line.part("VERTEX_LOOP").is_some() {
            Vec::new()
        } else {
            self.edge_loop(&line)?
        };
        if !is_true(bound, get(bound, values, 2)?)? {
            vertices.reverse();
        }
        Ok(vertices)
    }

    fn point_vertex(&mut self, number: u64) -> Result<u32, Fault> {
        if let Some(vertex) = self.known.get(&number) {
            return Ok(*vertex);
        }
        let vertex = self.vertices.len() as u32;
        self.vertices.push(self.model.point(number)?);
        self.known.insert(number, vertex);
        Ok(vertex)
    }

    fn edge_loop(&mut self, line: &Entity) -> Result<Vec<u32>, Fault> {
        let values = self.model.simple(line, "EDGE_LOOP")?;
        let mut vertices: Vec<u32> = Vec::new();
        let mut first_end = None;
        for edge in list(line, get(line, values, 1)?)? {
            let oriented = self.model.follow(line, edge)?;
            let values = self.model.simple(&oriented, "ORIENTED_EDGE")?;
            let edge = reference(&oriented, get(&oriented, values, 3)?)?;
            let mut own = self.edge(edge)?;
            if !is_true(&oriented, get(&oriented, values, 4)?)? {
                own.reverse();
            }
            let start = own.first().copied();
            if first_end.is_some() && first_end != start {
                return Err(line.fault(format_args!(
                    "edge #{edge} does not begin where the one before it ends"
                )));
            }
            first_end = own.pop();
            vertices.extend(own);
        }
        if first_end != vertices.first().copied() {
            return Err(line.fault("its last edge does not end where the first begins"));
        }
        Ok(vertices)
    }

    /// Vertices along an edge, both ends included.
    fn edge(&mut self, number: u64) -> Result<Vec<u32>, Fault> {
        if let Some(known) = self.edges.get(&number) {
            return Ok(known.clone());
        }
        let edge = self.model.file.entity(number)?;
        let values = self.model.simple(&edge, "EDGE_CURVE")?;
        let mut ends = [0; 2];
        for (k, end) in ends.iter_mut().enumerate() {
            let vertex = self.model.follow(&edge, get(&edge, values, k + 1)?)?;
            let inner = self.model.simple(&vertex, "VERTEX_POINT")?;
            let at = reference(&vertex, get(&vertex, inner, 1)?)?;
            // Vertices stand for themselves: two at one point are welded later.
            *end = match self.known.get(&vertex.number) {
                Some(known) => *known,
                None => {
                    self.vertices.push(self.model.point(at)?);
                    let new = self.vertices.len() as u32 - 1;
                    self.known.insert(vertex.number, new);
                    new
                }
            };
        }
        let curve = Curve::read(self.model, reference(&edge, get(&edge, values, 3)?)?)
            .map_err(|fault| within(&edge, fault))?;
        let is_along = sense(&edge, values, 4)?;
        let places = ends.map(|end| self.vertices[end as usize]);
        let points = curve.points(places, is_along, &self.fine);
        let mut own = vec![ends[0]];
        for p in &points[1..points.len() - 1] {
            own.push(self.vertices.len() as u32);
            self.vertices.push(*p);
        }
        own.push(ends[1]);
        self.edges.insert(number, own.clone());
        Ok(own)
    }
}

/// A fault of what an entity is made of, with the entity.
fn within(entity: &Entity, mut fault: Fault) -> Fault {
    fault.message = format!(
        "{} (of #{}, {})",
        fault.message,
        entity.number,
        entity.kind()
    );
    fault
}
