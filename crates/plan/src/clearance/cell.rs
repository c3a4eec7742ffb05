//! Bodies about an arm, and the pairs of them that must not touch.

use nalgebra::{Isometry3, Vector3};
use truecut_arm::{LinkSolids, Robot};

use super::body::{Body, Piece, of_hull, of_shape, piece};
use super::error::{CellError, CellFault};
use super::solid::Solid;
use super::{CellSetup, Tool, hull};
use crate::surface::Mesh;

/// What a job brings beside a cell's file.
#[derive(Default)]
pub struct Own<'a> {
    /// The part, at every place where a copy of it stands in the world.
    pub part: Vec<(&'a Mesh, Isometry3<f64>)>,
    pub tools: Vec<Tool>,
}

/// What something that stands is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Fixture,
    Part,
    OwnPart,
}

/// Two bodies, by index; the second moves, and its frame comes after the first's.
pub(super) struct Pair {
    pub bodies: [usize; 2],
    /// Whether they may touch where the tool is fed.
    pub may_cut: bool,
    /// Both belong to the arm.
    pub is_own: bool,
}

/// An arm, what it carries and what stands about it.
pub struct Cell {
    pub(super) bodies: Vec<Body>,
    pub(super) pairs: Vec<Pair>,
    pub(super) least_m: f64,
    carried: Vec<(String, Solid, Isometry3<f64>)>,
    notes: Vec<String>,
}

/// Something to be drawn: its name, its form, and where that is in its frame.
pub type Drawn<'a> = (&'a str, &'a Solid, &'a Isometry3<f64>);

impl Cell {
    /// Reads what a setup names and puts it about an arm.
    ///
    /// # Errors
    /// With the key: a mesh that cannot be read or has no size, a name that stands twice or that
    /// nothing has, a fixture within the part, a part within a fixture.
    pub fn new(robot: &Robot, setup: &CellSetup, own: &Own<'_>) -> Result<Self, CellError> {
        let (links, mut notes) = robot.solids();
        if setup.part.is_none() && setup.fixtures.is_empty() && setup.carried.is_empty() {
            let text =
                "the cell's file names no part, no fixture and nothing that the flange carries";
            notes.push(text.to_owned());
        }
        let mut cell = Self {
            bodies: Vec::new(),
            pairs: Vec::new(),
            least_m: setup.least_m,
            carried: Vec::new(),
            notes,
        };
        for (frame, link) in links.iter().enumerate() {
            cell.take_link(frame, link);
        }
        let last = links.len() - 1;
        let flange = robot.frames.last_link_from_flange;
        for (index, one) in setup.carried.iter().enumerate() {
            let solid = one.form.load();
            let solid = solid.map_err(|fault| at(&format!("carried.{index}.shape.mesh"), fault))?;
            check_reach(&one.name, &solid, &one.flange_from_form)
                .map_err(|fault| at(&format!("carried.{index}.name"), fault))?;
            cell.notes.extend(solid.doubts(&one.name));
            let place = flange * one.flange_from_form;
            cell.take_carried((&one.name, one.cuts), &solid, last, &place);
            cell.carried.push((one.name.clone(), solid, place));
        }
        for tool in &own.tools {
            // It is drawn by the job.
            let place = flange * tool.flange_from_solid;
            cell.take_carried((&tool.name, true), &tool.solid, last, &place);
        }
        for (mesh, world_from_mesh) in &own.part {
            let solid = Solid::of_mesh(mesh);
            cell.take_standing(PART, solid, world_from_mesh, Kind::OwnPart);
        }
        if let Some(part) = &setup.part {
            let solid = part
                .form
                .load()
                .map_err(|fault| at("part.shape.mesh", fault))?;
            check_reach(&part.name, &solid, &part.world_from_form)
                .map_err(|fault| at("part.shape", fault))?;
            cell.notes.extend(solid.doubts(&part.name));
            cell.take_standing(&part.name, solid, &part.world_from_form, Kind::Part);
        }
        for (index, one) in setup.fixtures.iter().enumerate() {
            let solid = one.form.load();
            let solid = solid.map_err(|fault| at(&format!("fixture.{index}.shape.mesh"), fault))?;
            check_reach(&one.name, &solid, &one.world_from_form)
                .map_err(|fault| at(&format!("fixture.{index}.name"), fault))?;
            cell.notes.extend(solid.doubts(&one.name));
            cell.take_standing(&one.name, solid, &one.world_from_form, Kind::Fixture);
        }
        cell.check_names(setup)?;
        cell.check_within(setup)?;
        cell.pair(setup, last);
        Ok(cell)
    }

    /// Clearance that is asked for, m.
    #[must_use]
    pub fn least_m(&self) -> f64 {
        self.least_m
    }

    /// What was left out, or stands for something else.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// What stands, in the world, but for the part that a job brings.
    pub fn standing(&self) -> impl Iterator<Item = Drawn<'_>> {
        let foreign = self.bodies.iter().filter(|body| !body.is_own);
        foreign.filter_map(|body| {
            let (solid, at) = body.solid.as_ref()?;
            Some((body.name.as_str(), solid, at))
        })
    }

    /// What is carried, in the frame of the last link.
    pub fn carried(&self) -> impl Iterator<Item = Drawn<'_>> {
        let each = self.carried.iter();
        each.map(|(name, solid, at)| (name.as_str(), solid, at))
    }

    fn take_link(&mut self, frame: usize, link: &LinkSolids) {
        let mut pieces: Vec<Piece> = (link.shapes.iter())
            .map(|(shape, at)| of_shape(shape, at))
            .collect();
        let is_near = |points: &&Vec<Vector3<f64>>| {
            // What is not a number is not near, either.
            points.iter().all(|point| point.norm() <= FURTHEST_M)
        };
        let hulls = link.meshes_m.iter().filter(is_near);
        pieces.extend(hulls.filter_map(|points| Some(of_hull(hull::of_points(points)?, None))));
        if link.is_rod && !pieces.is_empty() {
            self.notes.push(format!(
                "link \"{}\" has no shape in the robot's files: a rod to the next joint stands for it",
                link.link
            ));
        }
        self.bodies.push(Body {
            name: link.link.clone(),
            frame,
            pieces,
            solid: None,
            is_part: false,
            is_own: false,
            cuts: false,
        });
    }

    fn take_carried(
        &mut self,
        (name, cuts): (&str, bool),
        solid: &Solid,
        frame: usize,
        at: &Isometry3<f64>,
    ) {
        let piece = match solid {
            Solid::Mesh { vertices_m, .. } => {
                hull::of_points(vertices_m).map(|hull| of_hull(hull, Some(at)))
            }
            _ => solid.shape().map(|(shape, own)| piece(shape, &(at * own))),
        };
        self.bodies.push(Body {
            name: name.to_owned(),
            frame,
            pieces: piece.into_iter().collect(),
            solid: None,
            is_part: false,
            is_own: false,
            cuts,
        });
    }

    fn take_standing(&mut self, name: &str, solid: Solid, at: &Isometry3<f64>, kind: Kind) {
        let piece = solid.shape().map(|(shape, own)| piece(shape, &(at * own)));
        self.bodies.push(Body {
            name: name.to_owned(),
            frame: 0,
            pieces: piece.into_iter().collect(),
            solid: Some((solid, *at)),
            is_part: kind != Kind::Fixture,
            is_own: kind == Kind::OwnPart,
            cuts: false,
        });
    }

    fn check_names(&self, setup: &CellSetup) -> Result<(), CellError> {
        let names: Vec<&str> = self.bodies.iter().map(|body| body.name.as_str()).collect();
        let keys = (setup.carried.iter().enumerate())
            .map(|(k, one)| (format!("carried.{k}.name"), &one.name));
        let fixtures = (setup.fixtures.iter().enumerate())
            .map(|(k, one)| (format!("fixture.{k}.name"), &one.name));
        for (key, name) in keys.chain(fixtures) {
            if names.iter().filter(|own| *own == name).count() > 1 {
                return Err(at(&key, CellFault::Twice { name: name.clone() }));
            }
        }
        for (k, one) in setup.fixtures.iter().enumerate() {
            let moves = |body: &&Body| body.solid.is_none();
            let known = |name: &String| self.bodies.iter().filter(moves).any(|b| b.name == *name);
            if let Some(name) = one.may_touch.iter().find(|name| !known(name)) {
                let all: Vec<&str> = (self.bodies.iter().filter(moves))
                    .map(|body| body.name.as_str())
                    .collect();
                let fault = CellFault::UnknownBody {
                    name: name.clone(),
                    known: all.join(", "),
                };
                return Err(at(&format!("fixture.{k}.may_touch"), fault));
            }
        }
        Ok(())
    }

    /// Refuses a fixture within the part, and the other way round.
    fn check_within(&self, setup: &CellSetup) -> Result<(), CellError> {
        let standing: Vec<&Body> = (self.bodies.iter())
            .filter(|body| body.solid.is_some())
            .collect();
        let fixtures = &standing[standing.len() - setup.fixtures.len()..];
        for (k, fixture) in fixtures.iter().enumerate() {
            for part in standing.iter().filter(|body| body.is_part) {
                for [outer, inner] in [[part, fixture], [fixture, part]] {
                    let (Some((out, out_at)), Some((inn, inn_at))) = (&outer.solid, &inner.solid)
                    else {
                        continue;
                    };
                    if let Some(corners) = out.holds_all(out_at, inn, inn_at) {
                        let fault = CellFault::Inside {
                            inner: inner.name.clone(),
                            outer: outer.name.clone(),
                            corners,
                        };
                        return Err(at(&format!("fixture.{k}.name"), fault));
                    }
                }
            }
        }
        Ok(())
    }

    /// Which bodies must not touch: all that moves and all that stands; and what is carried and the
    /// links from the base to three joints before the flange, since its neighbours are always near.
    fn pair(&mut self, setup: &CellSetup, last: usize) {
        let may_touch = |standing: &Body, moving: &Body| {
            let fixture = (setup.fixtures.iter()).find(|one| one.name == standing.name);
            fixture.is_some_and(|one| !standing.is_part && one.may_touch.contains(&moving.name))
        };
        let mut pairs = Vec::new();
        for (b, moving) in self.bodies.iter().enumerate() {
            if moving.frame == 0 || moving.pieces.is_empty() {
                continue;
            }
            let is_carried = b > last;
            for (a, other) in self.bodies.iter().enumerate() {
                let stands = other.solid.is_some();
                let is_far = is_carried && a <= last && other.frame + 3 <= moving.frame;
                let counts = match stands {
                    true => !may_touch(other, moving),
                    false => is_far,
                };
                if counts && !other.pieces.is_empty() {
                    pairs.push(Pair {
                        bodies: [a, b],
                        may_cut: other.is_part && moving.cuts,
                        is_own: !stands,
                    });
                }
            }
        }
        self.pairs = pairs;
    }

    /// Names of a pair, what moves first.
    pub(super) fn names(&self, pair: &Pair) -> [String; 2] {
        let [a, b] = pair.bodies;
        [self.bodies[b].name.clone(), self.bodies[a].name.clone()]
    }
}

/// The name of the part that a job gives.
const PART: &str = "part";

/// How far bodies may reach, m: further than any cell.
const FURTHEST_M: f64 = 1e4;

fn check_reach(name: &str, solid: &Solid, at: &Isometry3<f64>) -> Result<(), CellFault> {
    let corners = solid.corners_m();
    let corners = corners.iter().map(|corner| corner.norm());
    let away_m = corners.fold(at.translation.vector.norm(), f64::max);
    match away_m <= FURTHEST_M {
        true => Ok(()),
        false => Err(CellFault::TooFar {
            name: name.to_owned(),
            away_m,
            limit_m: FURTHEST_M,
        }),
    }
}

fn at(key: &str, fault: CellFault) -> CellError {
    CellError {
        key: key.to_owned(),
        fault,
    }
}
