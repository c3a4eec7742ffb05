//! Forces of a vibrating tool whose axis turns.

use super::field::{DistanceField, heights_m};
use crate::cutting::chamfer::CuttingCoefficients;
use crate::cutting::milling::cutter::Cutter;
use crate::cutting::milling::earlier::{Asked, Axis, Ray, SwivelPass, Swivelled, Then};
use crate::cutting::milling::layered::cut::{REVOLUTIONS, SLICE_LAG_RAD, ToolPlace};
use crate::cutting::milling::layered::immersion::{Immersion, arcs};
use crate::cutting::milling::layered::round::{self, Piece};
use crate::cutting::milling::memory::Trace;
use crate::cutting::milling::profile::Lean;
use crate::cutting::milling::slice::{MillingLoads, Slice};
use nalgebra::{Matrix3, Rotation3, Vector2, Vector3};
use std::f64::consts::FRAC_PI_2;

/// A cut by a tool whose axis turns.
#[derive(Debug, Clone)]
pub struct SwivelCut {
    pub cutter: Cutter,
    pub coefficients: CuttingCoefficients,
    pub(super) stock: DistanceField,
    /// Places of the tip and directions of the axis.
    pub(super) tip: Trace,
    pub(super) direction: Trace,
    /// Fastest motion of the tip, and turn of the axis, in the stretch of memory now filled and in
    /// the one before, m/rad and rad/rad.
    fastest: [[f64; 2]; 2],
    stretch_rad: f64,
    /// Up to where the stock is cut.
    pub(super) cut_to_rad: Option<f64>,
    /// Those of the state last committed.
    pub(super) axes: Rotation3<f64>,
}

/// What all teeth share of a state.
struct Passes<'a> {
    at: &'a ToolPlace,
    now_from_work: Matrix3<f64>,
    /// So many pitches before.
    earlier: Vec<SwivelPass>,
    speed_m_per_rad: f64,
    turn_rad_per_rad: f64,
}

/// What earlier passes were at a height.
struct Seen<'a> {
    swivelled: Swivelled<'a>,
    passes: &'a [SwivelPass],
    off_m: Vec<Vector2<f64>>,
    speed_m_per_rad: f64,
}

impl SwivelCut {
    /// A tool at rest at a place outside of the stock.
    pub fn new(
        cutter: Cutter,
        coefficients: CuttingCoefficients,
        stock: DistanceField,
        start: &ToolPlace,
    ) -> Self {
        let pitch_rad = cutter.pitch_rad();
        let passes = REVOLUTIONS * cutter.teeth;
        // Teeth cut the stock a pitch at a time.
        let span_rad = pitch_rad * (passes as f64 + 3.5) + FRAC_PI_2.max(pitch_rad);
        Self {
            cutter,
            coefficients,
            stock,
            tip: Trace::new(span_rad, start.place_m),
            direction: Trace::new(span_rad, start.axis().into_inner()),
            fastest: [[0.0; 2]; 2],
            stretch_rad: f64::NEG_INFINITY,
            cut_to_rad: None,
            axes: start.axes,
        }
    }

    pub fn stock(&self) -> &DistanceField {
        &self.stock
    }

    pub(super) fn lag_rad(&self) -> f64 {
        self.cutter.pitch_rad() * (REVOLUTIONS * self.cutter.teeth) as f64
    }

    fn passes<'a>(&self, at: &'a ToolPlace) -> Passes<'a> {
        let pitch_rad = self.cutter.pitch_rad();
        let [now, before] = self.fastest;
        let now_from_work = at.axes.matrix().transpose();
        let then = |m: usize| {
            let then_rad = at.rotation_rad - pitch_rad * m as f64;
            let [tip_m, direction] =
                [&self.tip, &self.direction].map(|trace| trace.at(then_rad).displacement_m);
            SwivelPass {
                then_rad,
                tip_m: now_from_work * (tip_m - at.place_m),
                direction: now_from_work * direction,
            }
        };
        Passes {
            at,
            now_from_work,
            earlier: (1..=REVOLUTIONS * self.cutter.teeth).map(then).collect(),
            speed_m_per_rad: now[0].max(before[0]),
            turn_rad_per_rad: now[1].max(before[1]),
        }
    }

    fn seen<'a>(&'a self, passes: &'a Passes, height_m: f64) -> Seen<'a> {
        let swivelled = Swivelled {
            tip: &self.tip,
            direction: &self.direction,
            now_from_work: passes.now_from_work,
            tip_now_m: passes.at.place_m,
            height_m,
        };
        let each = passes.earlier.iter();
        Seen {
            passes: &passes.earlier,
            off_m: each.map(|pass| pass.off_m(height_m)).collect(),
            swivelled,
            speed_m_per_rad: passes.speed_m_per_rad + passes.turn_rad_per_rad * height_m,
        }
    }

    /// Loads on the tool at a state, in the work frame; changes nothing. Their part about the
    /// tool's axis brakes the spindle.
    pub fn evaluate(&self, at: &ToolPlace) -> MillingLoads {
        let mut loads = MillingLoads::default();
        let cutter = &self.cutter;
        let largest_m = cutter.radius_m + cutter.runout.offset_m.abs();
        let Some([low_m, high_m]) = self.heights_m(at, largest_m) else {
            return loads;
        };
        let passes = self.passes(at);
        let rate = passes.now_from_work * at.vibration_m_per_rad;
        let mut in_cut = vec![false; cutter.teeth];
        for piece in self.pieces([low_m, high_m]) {
            let middle_m = at.place_m + at.axes * (Vector3::z() * piece.height_m);
            if outside_m(&self.stock, &middle_m) > largest_m + piece.thick_m {
                continue;
            }
            let seen = self.seen(&passes, piece.height_m);
            let feed_m_per_rad = -seen.off_m[0] / cutter.pitch_rad();
            for (tooth, cuts) in in_cut.iter_mut().enumerate() {
                let tip_rad = cutter.tooth_angle_rad(tooth, at.rotation_rad);
                let Some((piece, chip_m)) = self.chip(tooth, tip_rad, &piece, at, &seen) else {
                    continue;
                };
                *cuts = true;
                let angle_rad = tip_rad - cutter.lag_rad_per_m() * piece.height_m;
                let slice = Slice {
                    reach_m: cutter.tooth_reach_m(tooth, piece.height_m),
                    angle_rad,
                    height_m: piece.height_m,
                    thick_m: piece.thick_m,
                    chip_m,
                    lean: piece.lean,
                    along_m_per_rad: feed_m_per_rad.dot(&Ray::at(angle_rad).along),
                };
                loads.add(cutter, &self.coefficients, &slice, &rate);
            }
        }
        loads.teeth_in_cut = in_cut.iter().filter(|cuts| **cuts).count();
        loads.force_on_tool_n = at.axes * loads.force_on_tool_n;
        loads.moment_on_tool_n_m = at.axes * loads.moment_on_tool_n_m;
        loads
    }

    /// Heights above the tip between which the edge may be in the block.
    fn heights_m(&self, at: &ToolPlace, radius_m: f64) -> Option<[f64; 2]> {
        let reached = self.stock.reached_by(&at.pose(), radius_m, 0.0)?;
        let [low_m, high_m] = heights_m(&reached, &at.place_m, &at.axis());
        (high_m > low_m.max(0.0)).then_some([low_m.max(0.0), high_m])
    }

    /// The edge between two heights above the tip in pieces no higher than the grid's spacing.
    fn pieces(&self, [low_m, high_m]: [f64; 2]) -> impl Iterator<Item = Piece> {
        let profile = self.cutter.profile();
        let lag = self.cutter.lag_rad_per_m();
        let corner = round::pieces(profile, [low_m, high_m], lag, SLICE_LAG_RAD);
        let low_m = low_m.max(profile.corner_radius_m);
        let count = match low_m < high_m {
            true => {
                let by_lag = lag.abs() * (high_m - low_m) / SLICE_LAG_RAD;
                let by_grid = (high_m - low_m) / self.stock.grid_m();
                (by_lag.max(by_grid).ceil() as usize).max(1)
            }
            false => 0,
        };
        let thick_m = (high_m - low_m) / count as f64;
        let upright = (0..count).map(move |slice| Piece {
            height_m: low_m + thick_m * (slice as f64 + 0.5),
            thick_m,
            lean: Lean::UPRIGHT,
        });
        corner.chain(upright)
    }

    /// What of a piece cuts, and its chip thickness on the ray, m.
    fn chip(
        &self,
        tooth: usize,
        tip_rad: f64,
        piece: &Piece,
        at: &ToolPlace,
        seen: &Seen,
    ) -> Option<(Piece, f64)> {
        let ray_at = |height_m: f64| Ray::at(tip_rad - self.cutter.lag_rad_per_m() * height_m);
        let ray = ray_at(piece.height_m);
        let reach_m = self.cutter.tooth_reach_m(tooth, piece.height_m);
        if reach_m <= 0.0 {
            return None;
        }
        let tip_m = on_ray(at, &ray, reach_m, piece.height_m);
        // No chip is thicker than the way since the tooth before, and its difference in radius.
        let before = &seen.passes[0];
        let moved_m = seen.off_m[0].norm();
        let shift_m = seen.speed_m_per_rad * FRAC_PI_2 * moved_m / reach_m;
        let above_m = before.above_m(&in_tool(&ray, reach_m, piece.height_m));
        let sunk_m = (piece.height_m - above_m).abs() * piece.lean.cos / piece.lean.sin;
        let most_m = moved_m + shift_m + 2.0 * self.cutter.runout.offset_m.abs() + sunk_m;
        if outside_m(&self.stock, &tip_m) > most_m + piece.thick_m / piece.lean.sin
            || self.stock.beyond_m(&tip_m) < -most_m - self.stock.grid_m()
        {
            return None;
        }
        let surface_m = self.surface_m(tooth, &ray, reach_m, seen);
        if surface_m >= reach_m {
            return None;
        }
        // From root to tip, and from the lower end of the piece to its upper one.
        let depth_m = (reach_m - surface_m).min(most_m);
        let place = |[along, up]: [f64; 2]| {
            let height_m = piece.height_m + (up - 0.5) * piece.thick_m;
            let reach_m = self.cutter.tooth_reach_m(tooth, height_m);
            let along_m = reach_m - (1.0 - along) * depth_m;
            on_ray(at, &ray_at(height_m), along_m, height_m)
        };
        let within = self.stock.within(place)?;
        let [root_m, tip_m] = [0.0, 1.0].map(|along| place([along, within.middle]));
        // Of what lies in the block teeth have taken a part, which is told half way up.
        let in_block_m = self.stock.block.length_m(&root_m, &tip_m);
        if in_block_m <= 0.0 {
            return None;
        }
        let left = self.stock.length_in_m(&root_m, &tip_m) / in_block_m;
        let chip_m = depth_m * left * within.area / within.height;
        let piece = Piece {
            height_m: piece.height_m + (within.middle - 0.5) * piece.thick_m,
            thick_m: piece.thick_m * within.height,
            ..*piece
        };
        (chip_m > 0.0).then_some((piece, chip_m))
    }

    fn surface_m(&self, tooth: usize, ray: &Ray, reach_m: f64, seen: &Seen) -> f64 {
        let asked = Asked {
            cutter: &self.cutter,
            tooth,
            ray,
            reach_m,
            now_m: Vector2::zeros(),
            speed_m_per_rad: seen.speed_m_per_rad,
        };
        let place_m = in_tool(ray, reach_m, seen.swivelled.height_m);
        let passes = seen.passes.iter().zip(&seen.off_m);
        asked.surface_m(passes.map(|(pass, off_m)| Then {
            axis: Axis::Swivelled(seen.swivelled),
            then_rad: pass.then_rad,
            off_m: *off_m,
            above_m: pass.above_m(&place_m),
        }))
    }

    /// The height above the tip by which a whole edge is looked at: half way up what may be in the
    /// block.
    fn looked_at_m(&self, at: &ToolPlace) -> f64 {
        let heights_m = self.heights_m(at, self.cutter.radius_m);
        heights_m.map_or(self.cutter.corner_radius_m, |[low_m, high_m]| {
            0.5 * (low_m + high_m)
        })
    }

    /// Where the tool was at a rotation not longer ago than a pitch, its vibration and axes as now.
    pub fn place_at(&self, rotation_rad: f64, now: &ToolPlace) -> ToolPlace {
        ToolPlace {
            rotation_rad,
            place_m: self.tip.at(rotation_rad).displacement_m,
            ..*now
        }
    }

    /// Whether tip and root of a straight edge's chip lie in stock, half way up.
    pub fn ends_in_stock(&self, tooth: usize, at: &ToolPlace) -> [bool; 2] {
        let height_m = self.looked_at_m(at);
        let ray = Ray::at(self.cutter.tooth_angle_rad(tooth, at.rotation_rad));
        let reach_m = self.cutter.tooth_reach_m(tooth, height_m);
        let is_in = |along_m: f64| self.stock.is_left(&on_ray(at, &ray, along_m, height_m));
        let tip = is_in(reach_m);
        if self.heights_m(at, 2.0 * reach_m).is_none() {
            return [tip; 2];
        }
        let passes = self.passes(at);
        let seen = self.seen(&passes, height_m);
        let surface_m = self.surface_m(tooth, &ray, reach_m, &seen);
        [tip, is_in(surface_m.min(reach_m))]
    }

    /// Where the rim of a tool that is fed along `feed` (work frame) is in stock, half way up.
    pub fn immersion(&self, at: &ToolPlace, feed: &Vector3<f64>) -> Option<Immersion> {
        let feed = at.axes.inverse() * feed;
        let height_m = self.looked_at_m(at);
        let radius_m = self.cutter.profile().radius_at_m(height_m);
        arcs(&feed.xy(), |angle_rad| {
            let ray = Ray::at(angle_rad);
            self.stock.is_left(&on_ray(at, &ray, radius_m, height_m))
        })
    }

    /// The tool has come to this state. To be called once a step, with rising rotation.
    pub fn commit(&mut self, at: &ToolPlace) {
        let axis = at.axis().into_inner();
        if let (Some((before_rad, before_m)), Some((_, before))) =
            (self.tip.last(), self.direction.last())
        {
            let turned_rad = at.rotation_rad - before_rad;
            let moved = [at.place_m - before_m, axis - before].map(|by| by.norm() / turned_rad);
            if at.rotation_rad - self.stretch_rad > 2.0 * self.lag_rad() {
                self.fastest = [[0.0; 2], self.fastest[0]];
                self.stretch_rad = at.rotation_rad;
            }
            for (fastest, moved) in self.fastest[0].iter_mut().zip(moved) {
                *fastest = fastest.max(moved);
            }
        }
        self.tip.commit(at.rotation_rad, at.place_m);
        self.direction.commit(at.rotation_rad, axis);
        self.axes = at.axes;
        self.cut_up_to(at.rotation_rad - self.lag_rad());
    }

    /// Whether a tooth's tip in the stock has come no further on its way since the last state: its
    /// path loops, and the law of forces ends.
    pub fn turns_back(&self, at: &ToolPlace) -> bool {
        let Some((before_rad, before_m)) = self.tip.last() else {
            return false;
        };
        let turned_rad = at.rotation_rad - before_rad;
        let moved_m = (at.axes.inverse() * (at.place_m - before_m)).xy();
        let height_m = self.looked_at_m(at);
        (0..self.cutter.teeth).any(|tooth| {
            let radius_m = self.cutter.tooth_reach_m(tooth, height_m);
            let advance_m = 2.0 * radius_m * (0.5 * turned_rad).sin();
            if moved_m.norm() < advance_m {
                return false;
            }
            let angle_rad = self.cutter.tooth_angle_rad(tooth, at.rotation_rad);
            let along = Ray::at(angle_rad - 0.5 * turned_rad).along;
            let tip_m = on_ray(at, &Ray::at(angle_rad), radius_m, height_m);
            moved_m.dot(&along) + advance_m <= 0.0 && self.stock.is_left(&tip_m)
        })
    }
}

/// A place on a ray from the axis, at a height above the tip.
fn in_tool(ray: &Ray, along_m: f64, height_m: f64) -> Vector3<f64> {
    let off = ray.outward * along_m;
    Vector3::new(off.x, off.y, height_m)
}

/// The same in the work frame.
fn on_ray(at: &ToolPlace, ray: &Ray, along_m: f64, height_m: f64) -> Vector3<f64> {
    at.place_m + at.axes * in_tool(ray, along_m, height_m)
}

/// How far a place lies outside of the block, m.
fn outside_m(stock: &DistanceField, place_m: &Vector3<f64>) -> f64 {
    let (least_m, most_m) = (stock.block.least_m, stock.block.most_m);
    (least_m - place_m)
        .sup(&(place_m - most_m))
        .sup(&Vector3::zeros())
        .norm()
}
