//! What is left of layered stock: areas, volume, and its surface as a closed solid.
//!
//! Outlines run straight through the cells of the grid, from where they cross one of its lines to
//! where they cross the next. The crossings lie on a lattice finer than the grid: two are one
//! place or stand apart, whoever looks at them, so that triangles meet at whole edges and not two
//! solids at one edge, in the single precision of mesh files, too. Cells whose material meets at
//! opposite corners only are joined.
//!
//! An upright end mill cuts all layers above its tip. So no layer reaches out beyond the one below
//! it: what vibration and helix make of that, by micrometres, is left out, and ledges narrower than
//! the lattice likewise.

use super::stock::LayeredStock;
use nalgebra::{Vector2, Vector3};

/// Step of the lattice, as a part of the block's diagonal: programs that read a mesh take vertices
/// for one that are nearer by some times.
const STEP: f64 = 1e-5;
/// The same, as a part of the farthest coordinate: some roundings of single precision.
const STEP_FAR: f64 = 1e-6;
/// Fewest steps from a node to the next.
const FEWEST_STEPS: f64 = 4.0;
/// An outline about a node that is nearer than this, in steps, is drawn away from it, its
/// direction kept: triangles smaller than ten of them count as tiny.
const LEAST_CORNER: f64 = 11.0;

/// A place on the lattice: steps from the block's least corner.
type Place = [i64; 2];

/// A corner of what is left in a cell: a node, or where the outline crosses the side between two
/// nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Corner {
    at: Place,
    crosses: bool,
}

/// What is left in a cell, its corners anticlockwise: convex.
type Piece = Vec<Corner>;

/// What a triangle of the surface belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Facing {
    /// Looks up.
    Floor,
    /// Looks down: the block's underside.
    Under,
    /// Stands upright in a layer.
    Wall { layer: usize },
}

/// A triangle of the surface, m, its corners anticlockwise seen from outside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Triangle {
    pub corners_m: [Vector3<f64>; 3],
    pub facing: Facing,
}

/// The outlines of a stock.
struct Outlines<'a> {
    stock: &'a LayeredStock,
    /// Steps from a node to the next.
    steps: [i64; 2],
    step_m: Vector2<f64>,
    /// How far nodes lie beyond what is cut, m, by layer: not further than in the layers below, and
    /// as far where it is by less than a step.
    beyond_m: Vec<Vec<f64>>,
}

impl LayeredStock {
    /// Volume of what is left, m³: that of [`Self::surface`].
    pub fn volume_m3(&self) -> f64 {
        let outlines = Outlines::of(self);
        let layers = self.layers().iter().enumerate();
        layers
            .map(|(layer, one)| outlines.area_m2(layer) * one.height_m())
            .sum()
    }

    /// The surface of what is left: closed, every edge between two triangles.
    pub fn surface(&self) -> Vec<Triangle> {
        let outlines = Outlines::of(self);
        let mut surface = Vec::new();
        for layer in 0..self.layers().len() {
            for cell in 0..outlines.cell_count() {
                outlines.add(&mut surface, layer, cell);
            }
        }
        surface
    }
}

impl<'a> Outlines<'a> {
    fn of(stock: &'a LayeredStock) -> Self {
        let (least, most) = (stock.block.least_m, stock.block.most_m);
        let farthest_m = least.amax().max(most.amax());
        let step_m = (STEP * (most - least).norm()).max(STEP_FAR * farthest_m);
        let cells = stock.nodes().map(|count| (count - 1) as f64);
        let spacing_m = (most - least).xy().component_div(&Vector2::from(cells));
        let steps = spacing_m.map(|spacing_m| (spacing_m / step_m).floor().max(FEWEST_STEPS));
        let step_m = spacing_m.component_div(&steps);
        let mut beyond_m: Vec<Vec<f64>> = Vec::with_capacity(stock.layers().len());
        for layer in stock.layers() {
            let mut own_m = layer.values().to_vec();
            if let Some(below) = beyond_m.last() {
                for (own_m, below_m) in own_m.iter_mut().zip(below) {
                    if *own_m > below_m - step_m.max() {
                        *own_m = *below_m;
                    }
                }
            }
            beyond_m.push(own_m);
        }
        Self {
            stock,
            steps: [steps.x as i64, steps.y as i64],
            step_m,
            beyond_m,
        }
    }

    /// Area of what is left of a layer, m².
    fn area_m2(&self, layer: usize) -> f64 {
        let cells = 0..self.cell_count();
        let twice: i64 = cells.map(|cell| twice_area(&self.piece(layer, cell))).sum();
        0.5 * twice as f64 * self.step_m.product()
    }

    fn cell_count(&self) -> usize {
        (self.stock.nodes()[0] - 1) * (self.stock.nodes()[1] - 1)
    }

    /// Nodes of a cell, anticlockwise from the least.
    fn corners(&self, cell: usize) -> [usize; 4] {
        let [columns, _] = self.stock.nodes();
        let first = cell / (columns - 1) * columns + cell % (columns - 1);
        [first, first + 1, first + columns + 1, first + columns]
    }

    fn beyond_m(&self, layer: usize, node: usize) -> f64 {
        self.beyond_m[layer][node]
    }

    fn node(&self, node: usize) -> Place {
        let columns = self.stock.nodes()[0];
        [
            (node % columns) as i64 * self.steps[0],
            (node / columns) as i64 * self.steps[1],
        ]
    }

    fn piece(&self, layer: usize, cell: usize) -> Piece {
        let corners = self.corners(cell);
        let values = corners.map(|node| self.beyond_m(layer, node));
        let mut piece = Vec::with_capacity(6);
        for k in 0..4 {
            let next = (k + 1) % 4;
            if values[k] > 0.0 {
                piece.push(Corner {
                    at: self.node(corners[k]),
                    crosses: false,
                });
            }
            if (values[k] > 0.0) != (values[next] > 0.0) {
                let (low, high) = (corners[k].min(corners[next]), corners[k].max(corners[next]));
                let axis = k % 2;
                let mut at = self.node(low);
                at[axis] += self.crossing(layer, axis, [low, high]);
                piece.push(Corner { at, crosses: true });
            }
        }
        piece
    }

    /// Steps from a node to where the outline crosses the side to the next one along an axis: not
    /// further out than in the layers below.
    fn crossing(&self, layer: usize, axis: usize, [low, high]: [usize; 2]) -> i64 {
        let mut found: Option<i64> = None;
        for layer in 0..=layer {
            let is_left = [low, high].map(|node| self.beyond_m(layer, node) > 0.0);
            if is_left[0] == is_left[1] {
                continue;
            }
            let own = self.own_crossing(layer, axis, [low, high]);
            found = Some(match found {
                Some(below) if is_left[0] => own.min(below),
                Some(below) => own.max(below),
                None => own,
            });
        }
        found.unwrap_or_default()
    }

    fn own_crossing(&self, layer: usize, axis: usize, [low, high]: [usize; 2]) -> i64 {
        let steps = self.steps[axis];
        let leg = self.leg(layer, axis, [low, high]);
        let from_high = steps as f64 - leg;
        let at = match (leg <= from_high, leg.min(from_high) < LEAST_CORNER) {
            (true, true) => leg.max(1.0) * self.widening(layer, axis, low, leg),
            (false, true) => {
                let wider = self.widening(layer, axis, high, from_high);
                steps as f64 - from_high.max(1.0) * wider
            }
            _ => leg,
        };
        (at.round() as i64).clamp(1, steps - 1)
    }

    /// Steps from a node to where the outline crosses the side to another, as it is.
    fn leg(&self, layer: usize, axis: usize, [from, to]: [usize; 2]) -> f64 {
        let [here, there] = [from, to].map(|node| self.beyond_m(layer, node));
        here / (here - there) * self.steps[axis] as f64
    }

    /// By what factor a short leg from a node becomes longer, so that no corner about the node is
    /// smaller than the least, with the legs along the other axis.
    fn widening(&self, layer: usize, axis: usize, node: usize, leg: f64) -> f64 {
        let other = 1 - axis;
        if (self.steps[0].min(self.steps[1]) as f64) < 4.0 * LEAST_CORNER {
            return 1.0;
        }
        let [columns, rows] = self.stock.nodes();
        let (at, count, stride) = match other {
            0 => (node % columns, columns, 1),
            _ => (node / columns, rows, columns),
        };
        let before = (at > 0).then(|| node - stride);
        let after = (at + 1 < count).then(|| node + stride);
        let is_left = |node: usize| self.beyond_m(layer, node) > 0.0;
        let crossed = [before, after].into_iter().flatten();
        let crossed = crossed.filter(|next| is_left(*next) != is_left(node));
        crossed.fold(1.0, |widest, next| {
            let longer = self.leg(layer, other, [node, next]).max(leg).max(1.0);
            widest.max(LEAST_CORNER / longer)
        })
    }

    fn place_m(&self, at: Place, z: f64) -> Vector3<f64> {
        let from_m = self.stock.block.least_m;
        let along = |axis: usize| from_m[axis] + self.step_m[axis] * at[axis] as f64;
        Vector3::new(along(0), along(1), z)
    }

    /// Floors and walls of a layer in a cell.
    fn add(&self, surface: &mut Vec<Triangle>, layer: usize, cell: usize) {
        let piece = self.piece(layer, cell);
        if piece.is_empty() {
            return;
        }
        let one = &self.stock.layers()[layer];
        let on_it = match layer + 1 < self.stock.layers().len() {
            true => self.piece(layer + 1, cell),
            false => Piece::new(),
        };
        for part in without(&piece, &on_it) {
            self.level(surface, &part, one.top_m, Facing::Floor);
        }
        if layer == 0 {
            let whole: Vec<Place> = piece.iter().map(|corner| corner.at).collect();
            self.level(surface, &whole, one.bottom_m, Facing::Under);
        }
        for (from, to) in sides(&piece) {
            let stands = (from.crosses && to.crosses) || self.on_face(from.at, to.at);
            if !stands {
                continue;
            }
            // On the block's faces the layer above may end on the way.
            let mut above = vec![from.at];
            above.extend(
                (on_it.iter().map(|corner| corner.at)).filter(|at| between(*at, from.at, to.at)),
            );
            above.push(to.at);
            let top = |k: usize| self.place_m(above[k], one.top_m);
            let bottom = [from.at, to.at].map(|at| self.place_m(at, one.bottom_m));
            let mut push = |corners_m: [Vector3<f64>; 3]| {
                let facing = Facing::Wall { layer };
                surface.push(Triangle { corners_m, facing });
            };
            push([bottom[0], bottom[1], top(above.len() - 1)]);
            for k in (1..above.len()).rev() {
                push([bottom[0], top(k), top(k - 1)]);
            }
        }
    }

    /// A convex level part, seen from where it faces.
    fn level(&self, surface: &mut Vec<Triangle>, part: &[Place], z: f64, facing: Facing) {
        let scale =
            |at: Place| Vector2::new(at[0] as f64, at[1] as f64).component_mul(&self.step_m);
        let count = part.len();
        let corner = |apex: usize, k: usize| part[(apex + k) % count];
        // Of the corners that the triangles may share, the one whose lowest triangle is highest.
        let lowest_m = |apex: usize| {
            let each = (1..count - 1).map(|k| {
                let [a, b, c] = [0, k, k + 1].map(|k| scale(corner(apex, k)));
                let longest_m = (b - a).norm().max((c - b).norm()).max((a - c).norm());
                (b - a).perp(&(c - a)) / longest_m
            });
            each.fold(f64::INFINITY, f64::min)
        };
        let apex = (0..count).max_by(|a, b| lowest_m(*a).total_cmp(&lowest_m(*b)));
        let apex = apex.unwrap_or(0);
        for k in 1..count - 1 {
            let corners = match facing {
                Facing::Under => [0, k + 1, k],
                _ => [0, k, k + 1],
            };
            surface.push(Triangle {
                corners_m: corners.map(|k| self.place_m(corner(apex, k), z)),
                facing,
            });
        }
    }

    /// Whether a side lies on one of the block's upright faces.
    fn on_face(&self, from: Place, to: Place) -> bool {
        (0..2).any(|axis| {
            let last = (self.stock.nodes()[axis] - 1) as i64 * self.steps[axis];
            from[axis] == to[axis] && (from[axis] == 0 || from[axis] == last)
        })
    }
}

/// Sides of a piece, anticlockwise.
fn sides(piece: &Piece) -> impl Iterator<Item = (Corner, Corner)> + '_ {
    let next = piece.iter().cycle().skip(1);
    piece.iter().copied().zip(next.copied())
}

/// Twice the area of the triangle of three places, positive where they stand anticlockwise.
fn turn(a: Place, b: Place, c: Place) -> i64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

fn twice_area(piece: &Piece) -> i64 {
    let Some(first) = piece.first() else {
        return 0;
    };
    sides(piece)
        .map(|(from, to)| turn(first.at, from.at, to.at))
        .sum()
}

/// Whether a place lies on the way between two others, and is neither.
fn between(at: Place, from: Place, to: Place) -> bool {
    let ahead = |a: Place, b: Place, axis: usize| (b[axis] - a[axis]).signum();
    turn(from, to, at) == 0
        && at != from
        && at != to
        && (0..2).all(|axis| ahead(from, at, axis) == ahead(at, to, axis))
}

/// What of a piece the one that stands on it, and not beyond it, leaves free: convex parts.
fn without(piece: &Piece, on_it: &Piece) -> Vec<Vec<Place>> {
    if on_it.is_empty() {
        return vec![piece.iter().map(|corner| corner.at).collect()];
    }
    // Free is what lies beyond a line on which the upper one ends within the cell.
    let ends = sides(on_it).filter(|(from, to)| from.crosses && to.crosses);
    let parts = ends.map(|(from, to)| beyond(piece, from.at, to.at));
    parts.filter(|part| part.len() > 2).collect()
}

/// The part of a piece to the right of a line that ends on two sides of its cell. The line leaves
/// the piece there alone, at its own ends.
fn beyond(piece: &Piece, from: Place, to: Place) -> Vec<Place> {
    let mut part = Vec::with_capacity(piece.len() + 1);
    for (a, b) in sides(piece) {
        let [here, there] = [a.at, b.at].map(|at| turn(from, to, at).signum());
        if here <= 0 {
            part.push(a.at);
        }
        if here * there < 0 {
            part.extend([from, to].into_iter().find(|end| between(*end, a.at, b.at)));
        }
    }
    part
}
