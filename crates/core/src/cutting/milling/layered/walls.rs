//! Walls on rays.
//!
//! A station stands on the path as written, its ray points across it. Of the arcs of all teeth the
//! one counts that reaches furthest along the ray; a wall is not known better by a finer grid.

use super::arc::ToothArc;
use nalgebra::Vector2;

/// On which side of the path a wall lies, seen along it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Side {
    Left,
    Right,
}

/// A place of a wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Station {
    pub side: Side,
    pub layer: usize,
    /// Way along the path as written, m.
    pub along_m: f64,
    /// On the path.
    pub from_m: Vector2<f64>,
    /// Towards the wall, of length 1.
    pub outward: Vector2<f64>,
}

/// Stations and what teeth have left at them.
#[derive(Debug, Clone, PartialEq)]
pub struct Walls {
    radius_m: f64,
    stations: Vec<Station>,
    /// How far teeth have reached along each ray, m.
    reached_m: Vec<f64>,
    cell_m: f64,
    /// Cell with the least numbers, and how many there are along x and y.
    first_cell: [i64; 2],
    across: [i64; 2],
    /// By cell, x first: stations whose wall stands in it.
    cells: Vec<Vec<u32>>,
}

impl Walls {
    /// Of a path of a cutter with this radius: walls stand at it.
    pub fn new(stations: Vec<Station>, radius_m: f64) -> Self {
        let cell_m = 0.1 * radius_m;
        let cell_of = |one: &Station| cell(&(one.from_m + one.outward * radius_m), cell_m);
        let bound = |axis: usize| {
            let at = stations.iter().map(|one| cell_of(one)[axis]);
            let first = at.clone().min().unwrap_or(0);
            (first, at.max().unwrap_or(first - 1) + 1 - first)
        };
        let [(first_x, columns), (first_y, rows)] = [bound(0), bound(1)];
        let mut cells = vec![Vec::new(); (columns * rows) as usize];
        for (index, one) in stations.iter().enumerate() {
            let [x, y] = cell_of(one);
            cells[(x - first_x + columns * (y - first_y)) as usize].push(index as u32);
        }
        Self {
            radius_m,
            reached_m: vec![f64::NEG_INFINITY; stations.len()],
            stations,
            cell_m,
            first_cell: [first_x, first_y],
            across: [columns, rows],
            cells,
        }
    }

    /// Stations, with the material left at them, m: negative where too much was taken, infinite
    /// where no tooth has been.
    pub fn left_m(&self) -> impl Iterator<Item = (&Station, f64)> {
        let reached = self.reached_m.iter();
        let left = reached.map(|reached| self.radius_m - reached);
        self.stations.iter().zip(left)
    }

    pub(super) fn cut(&mut self, layer: usize, arc: &ToothArc) {
        if self.stations.is_empty() {
            return;
        }
        let [least, most] = arc.bounds([arc.radius_m, arc.radius_m]);
        let [from, to] = [
            cell(&least.add_scalar(-self.cell_m), self.cell_m),
            cell(&most.add_scalar(self.cell_m), self.cell_m),
        ];
        let within = |axis: usize| {
            let first = self.first_cell[axis];
            (from[axis] - first).max(0)..(to[axis] - first + 1).min(self.across[axis])
        };
        for x in within(0) {
            for y in within(1) {
                for &index in &self.cells[(x + self.across[0] * y) as usize] {
                    let station = &self.stations[index as usize];
                    if station.layer != layer {
                        continue;
                    }
                    if let Some(reached_m) = reached(station, arc, self.radius_m) {
                        let known = &mut self.reached_m[index as usize];
                        *known = known.max(reached_m);
                    }
                }
            }
        }
    }
}

fn cell(place_m: &Vector2<f64>, cell_m: f64) -> [i64; 2] {
    [place_m.x, place_m.y].map(|x| (x / cell_m).floor() as i64)
}

/// Where an arc crosses a ray: about the place where the wall should be, then about where it is.
fn reached(station: &Station, arc: &ToothArc, radius_m: f64) -> Option<f64> {
    let mut along_m = radius_m;
    for _ in 0..2 {
        let wall_m = station.from_m + station.outward * along_m;
        let (_, axis_m) = arc.at(&wall_m)?;
        let off_m = axis_m - station.from_m;
        let beside_m = off_m.x * station.outward.y - off_m.y * station.outward.x;
        let square = arc.radius_m * arc.radius_m - beside_m * beside_m;
        if square <= 0.0 {
            return None;
        }
        along_m = off_m.dot(&station.outward) + square.sqrt();
    }
    Some(along_m)
}
