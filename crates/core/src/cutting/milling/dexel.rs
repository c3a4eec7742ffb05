//! The finished surface as dexels: rows of parallel rays, each keeping where the tool has cut it
//! off.
//!
//! A wall has one row of rays along y for each height looked at, the floor one row of rays along z
//! for each line looked at. Rays stand on an even grid along the feed.

use super::parameters::{MillingParameters, ToolState};
use nalgebra::Vector2;
use std::f64::consts::{PI, TAU};

/// Even grid along the feed on which rays stand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayGrid {
    pub start_m: f64,
    pub spacing_m: f64,
    pub count: usize,
}

impl RayGrid {
    /// x of a ray, m.
    pub fn x_m(&self, ray: usize) -> f64 {
        self.start_m + self.spacing_m * ray as f64
    }

    /// Rays between two positions.
    fn between(&self, a_m: f64, b_m: f64) -> std::ops::Range<usize> {
        let index = |x: f64| (x - self.start_m) / self.spacing_m;
        let low = index(a_m.min(b_m)).ceil().max(0.0) as usize;
        let high = (index(a_m.max(b_m)).floor() + 1.0).max(0.0) as usize;
        low..high.min(self.count).max(low)
    }
}

/// A row of dexels: how far material is left above the nominal surface, m, by ray; NaN where
/// nothing has been cut.
#[derive(Debug, Clone, PartialEq)]
pub struct DexelRow {
    left_m: Vec<f64>,
}

impl DexelRow {
    fn new(count: usize) -> Self {
        Self {
            left_m: vec![f64::NAN; count],
        }
    }

    /// Material left above the nominal surface by ray, m; negative where too much was taken, NaN
    /// where none was.
    pub fn left_m(&self) -> &[f64] {
        &self.left_m
    }

    fn cut(&mut self, ray: usize, left_m: f64) {
        // `min` takes the number where the other is NaN.
        self.left_m[ray] = self.left_m[ray].min(left_m);
    }
}

/// Which wall of the cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wall {
    /// At y = −r, where teeth leave: the wall of down-milling.
    Exit,
    /// At y = +r, where teeth enter: the wall of up-milling.
    Entry,
}

/// Walls and floor that a pass leaves.
#[derive(Debug, Clone, PartialEq)]
pub struct FinishedSurface {
    grid: RayGrid,
    walls: Vec<WallRow>,
    floors: Vec<FloorRow>,
}

#[derive(Debug, Clone, PartialEq)]
struct WallRow {
    wall: Wall,
    height_m: f64,
    row: DexelRow,
}

#[derive(Debug, Clone, PartialEq)]
struct FloorRow {
    y_m: f64,
    row: DexelRow,
    /// Where a tooth last crossed the line ahead of the axis and behind it: x, height, m.
    last: [Option<(f64, f64)>; 2],
}

impl FinishedSurface {
    /// Rays on `grid` for the walls that `walls` names, at heights above the nominal floor, and for
    /// floor lines at the given y.
    pub fn new(grid: RayGrid, walls: &[(Wall, f64)], floor_lines_y_m: &[f64]) -> Self {
        let wall = |&(wall, height_m): &(Wall, f64)| WallRow {
            wall,
            height_m,
            row: DexelRow::new(grid.count),
        };
        let floor = |&y_m: &f64| FloorRow {
            y_m,
            row: DexelRow::new(grid.count),
            last: [None, None],
        };
        Self {
            grid,
            walls: walls.iter().map(wall).collect(),
            floors: floor_lines_y_m.iter().map(floor).collect(),
        }
    }

    pub fn grid(&self) -> &RayGrid {
        &self.grid
    }

    /// Row of a wall, in the order given to [`FinishedSurface::new`].
    pub fn wall(&self, index: usize) -> &DexelRow {
        &self.walls[index].row
    }

    /// Row of a floor line, in the order given to [`FinishedSurface::new`].
    pub fn floor(&self, index: usize) -> &DexelRow {
        &self.floors[index].row
    }

    /// The teeth have moved from one state to the next.
    pub(super) fn sweep(&mut self, p: &MillingParameters, from: &ToolState, to: &ToolState) {
        for tooth in 0..p.cutter.teeth {
            let radius_m = p.cutter.tooth_radius_m(tooth);
            for wall in &mut self.walls {
                let at = |state: &ToolState| TipState::at(p, tooth, state, wall.height_m);
                if let (Some(from), Some(to)) = (at(from), at(to)) {
                    wall.sweep(&self.grid, p, radius_m, from, to);
                }
            }
            for floor in &mut self.floors {
                let tip = |s: &ToolState| TipState::at(p, tooth, s, s.displacement_m.z);
                if let (Some(a), Some(b)) = (tip(from), tip(to)) {
                    let heights = (from.displacement_m.z, to.displacement_m.z);
                    floor.sweep(&self.grid, radius_m, (a, b), heights);
                }
            }
        }
    }
}

/// A point of an edge: its angle and the axis.
#[derive(Debug, Clone, Copy)]
struct TipState {
    angle_rad: f64,
    centre_m: Vector2<f64>,
}

impl TipState {
    /// At a height above the nominal floor; `None` where the edge does not cut.
    fn at(p: &MillingParameters, tooth: usize, state: &ToolState, height_m: f64) -> Option<Self> {
        let above_tip = height_m - state.displacement_m.z;
        if above_tip < 0.0 || height_m > p.stock.top_m {
            return None;
        }
        let tip_rad = p.cutter.tooth_angle_rad(tooth, state.rotation_rad);
        let x = p.nominal_x_m(state.rotation_rad) + state.displacement_m.x;
        Some(Self {
            angle_rad: tip_rad - p.cutter.lag_rad_per_m() * above_tip,
            centre_m: Vector2::new(x, state.displacement_m.y),
        })
    }

    fn towards(&self, other: &Self, share: f64) -> Self {
        Self {
            angle_rad: self.angle_rad + (other.angle_rad - self.angle_rad) * share,
            centre_m: self.centre_m.lerp(&other.centre_m, share),
        }
    }

    fn x_m(&self, radius_m: f64) -> f64 {
        self.centre_m.x + radius_m * self.angle_rad.sin()
    }
}

/// Shares of the way from `from` to `to` at which the angle stands between `low` and `high`, any
/// turn.
fn within(from: &TipState, to: &TipState, low_rad: f64, high_rad: f64) -> Option<(f64, f64)> {
    let width = to.angle_rad - from.angle_rad;
    if width <= 0.0 {
        return None;
    }
    let turn = TAU * ((from.angle_rad - high_rad) / TAU).ceil();
    let enter = (low_rad + turn - from.angle_rad) / width;
    let leave = (high_rad + turn - from.angle_rad) / width;
    (enter < 1.0).then_some((enter.max(0.0), leave.min(1.0)))
}

impl WallRow {
    fn sweep(
        &mut self,
        grid: &RayGrid,
        p: &MillingParameters,
        radius_m: f64,
        from: TipState,
        to: TipState,
    ) {
        // Beyond two revolutions' feed from the apex a tooth is far inside what others leave.
        let reach = 2.0 * p.feed_per_revolution_m() + 2.0 * grid.spacing_m;
        let half = (reach / radius_m).min(1.0);
        let (apex, side) = match self.wall {
            Wall::Exit => (PI, -1.0),
            Wall::Entry => (0.0, 1.0),
        };
        let Some((enter, leave)) = within(&from, &to, apex - half, apex + half) else {
            return;
        };
        let (a, b) = (from.towards(&to, enter), from.towards(&to, leave));
        let (xa, xb) = (a.x_m(radius_m), b.x_m(radius_m));
        for ray in grid.between(xa, xb) {
            let x = grid.x_m(ray);
            let share = if xa == xb { 0.0 } else { (x - xa) / (xb - xa) };
            let centre = a.towards(&b, share).centre_m;
            let along = x - centre.x;
            let across = (radius_m * radius_m - along * along).max(0.0).sqrt();
            let beyond = side * centre.y + across;
            self.row.cut(ray, p.cutter.radius_m - beyond);
        }
    }
}

impl FloorRow {
    /// Teeth scratch the floor where their tips cross the line; between one tooth's crossing and
    /// the next the floor runs straight.
    fn sweep(
        &mut self,
        grid: &RayGrid,
        radius_m: f64,
        (from, to): (TipState, TipState),
        heights_m: (f64, f64),
    ) {
        let across = (self.y_m - from.centre_m.y) / radius_m;
        if across.abs() >= 1.0 {
            return;
        }
        for (side, angle) in [across.acos(), TAU - across.acos()].into_iter().enumerate() {
            let Some((share, _)) = within(&from, &to, angle, angle) else {
                continue;
            };
            if share <= 0.0 {
                continue;
            }
            let x = from.towards(&to, share).x_m(radius_m);
            let z = heights_m.0 + (heights_m.1 - heights_m.0) * share;
            if let Some((x0, z0)) = self.last[side] {
                for ray in grid.between(x0, x) {
                    let part = (grid.x_m(ray) - x0) / (x - x0);
                    self.row.cut(ray, z0 + (z - z0) * part);
                }
            }
            self.last[side] = Some((x, z));
        }
    }
}

#[cfg(test)]
mod tests;
