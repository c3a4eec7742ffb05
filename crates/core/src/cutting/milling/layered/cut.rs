//! Forces of a vibrating tool in layered stock.
//!
//! The law of chips is that of the straight cut: along the ray from the axis through a tooth's tip
//! the material begins where the outermost of the arcs of earlier passes ends, each found to
//! rounding from the stored motion of the axis, which here is its place in the plane and not its
//! distance from a line. Of the ray between there and the tip counts what lies in stock that no
//! tooth had been to before the stored motion begins.

use super::round::{self, Piece};
use super::stock::LayeredStock;
use super::walls::Walls;
use crate::cutting::chamfer::CuttingCoefficients;
use crate::cutting::milling::cutter::Cutter;
use crate::cutting::milling::earlier::{Asked, Axis, Ray, Then};
use crate::cutting::milling::memory::Trace;
use crate::cutting::milling::profile::Lean;
use crate::cutting::milling::slice::{MillingLoads, Slice};
use nalgebra::{Isometry3, Rotation3, Translation3, Unit, Vector2, Vector3};
use std::f64::consts::FRAC_PI_2;

/// Revolutions of which the motion is kept.
pub(in crate::cutting::milling) const REVOLUTIONS: usize = 2;
/// Edges with a helix are cut into slices that lag by no more than this, rad.
pub(in crate::cutting::milling) const SLICE_LAG_RAD: f64 = 0.02;

/// Where the tool is.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ToolPlace {
    /// Angle by which the spindle has turned, rad, not wrapped.
    pub rotation_rad: f64,
    /// The tip's centre, m.
    pub place_m: Vector3<f64>,
    /// Its vibration's change with rotation, m/rad; only a worn flank asks for it.
    pub vibration_m_per_rad: Vector3<f64>,
    /// Whether the path leads down there, so that ends cut. On a level path they, being ground
    /// hollow, stand clear of the floor but for their corners.
    pub sinks: bool,
    /// From the tool's axes, z against it, to those of the work frame; where its axis stays upright
    /// they are the same.
    pub axes: Rotation3<f64>,
}

impl ToolPlace {
    /// Direction from the tip up into the spindle.
    pub fn axis(&self) -> Unit<Vector3<f64>> {
        self.axes * Vector3::z_axis()
    }

    /// Tip and axes.
    pub fn pose(&self) -> Isometry3<f64> {
        Isometry3::from_parts(Translation3::from(self.place_m), self.axes.into())
    }
}

/// A cut on any path.
#[derive(Debug, Clone)]
pub struct LayeredCut {
    pub cutter: Cutter,
    pub coefficients: CuttingCoefficients,
    pub(super) stock: LayeredStock,
    /// As it was at the start, of cutters with a round corner.
    pub(super) whole: Option<LayeredStock>,
    pub(super) walls: Walls,
    /// Lowest place of the tip over each node, m.
    pub(super) floor_m: Vec<f64>,
    /// How high the stock stands at each node at the start, m; −∞ where there is none.
    pub(super) top_m: Vec<f64>,
    pub(super) trace: Trace,
    /// Fastest motion of the axis in the stretch of memory now filled and in the one before, m/rad.
    fastest_m_per_rad: [f64; 2],
    stretch_rad: f64,
    /// Up to where the stock is cut.
    pub(super) cut_to: Option<(f64, Vector3<f64>)>,
}

/// What all teeth share of a state.
pub(super) struct Passes {
    /// Rotation and place of the axis so many pitches before.
    pub(super) earlier: Vec<(f64, Vector3<f64>)>,
    pub(super) speed_m_per_rad: f64,
    /// From where the tip has come down on a level path, m.
    pub(super) highest_m: f64,
}

impl LayeredCut {
    /// A tool at rest at a place outside of the stock.
    pub fn new(
        cutter: Cutter,
        coefficients: CuttingCoefficients,
        stock: LayeredStock,
        walls: Walls,
        start_m: Vector3<f64>,
    ) -> Self {
        let pitch_rad = cutter.pitch_rad();
        let passes = REVOLUTIONS * cutter.teeth;
        let span_rad = pitch_rad * (passes as f64 + 1.5) + FRAC_PI_2.max(pitch_rad);
        let nodes = stock.nodes();
        Self {
            cutter,
            coefficients,
            floor_m: vec![f64::INFINITY; nodes[0] * nodes[1]],
            top_m: (0..nodes[0] * nodes[1])
                .map(|node| {
                    let mut downwards = stock.layers().iter().rev();
                    let stands = downwards.find(|layer| layer.values()[node] > 0.0);
                    stands.map_or(f64::NEG_INFINITY, |layer| layer.top_m)
                })
                .collect(),
            whole: (!cutter.is_flat()).then(|| stock.clone()),
            stock,
            walls,
            trace: Trace::new(span_rad, start_m),
            fastest_m_per_rad: [0.0; 2],
            stretch_rad: f64::NEG_INFINITY,
            cut_to: None,
        }
    }

    pub fn stock(&self) -> &LayeredStock {
        &self.stock
    }

    pub fn walls(&self) -> &Walls {
        &self.walls
    }

    /// Lowest place of the tip over each node, m; infinite where it has not been.
    pub fn floor_m(&self) -> &[f64] {
        &self.floor_m
    }

    fn lag_rad(&self) -> f64 {
        self.cutter.pitch_rad() * (REVOLUTIONS * self.cutter.teeth) as f64
    }

    /// Loads on the tool at a state; changes nothing.
    pub fn evaluate(&self, at: &ToolPlace) -> MillingLoads {
        let mut loads = MillingLoads::default();
        let (cutter, axis_m) = (&self.cutter, at.place_m.xy());
        let away_m = self.stock.block.outside_m(&axis_m);
        let largest_m = cutter.radius_m + cutter.runout.offset_m.abs();
        if away_m >= largest_m || at.place_m.z >= self.stock.block.most_m.z {
            return loads;
        }
        let passes = self.passes(at);
        let feed_m_per_rad = (at.place_m - passes.earlier[0].1).xy() / cutter.pitch_rad();
        let mut in_cut = vec![false; cutter.teeth];
        let mut ends_m = f64::NEG_INFINITY;
        if self.ends_cut(at, &passes) {
            // Up to where the tooth before stood it is they that cut.
            ends_m = passes.earlier[0].1.z;
            self.add_ends(&mut loads, at, &passes, &mut in_cut);
        }
        for (layer, [low_m, high_m]) in self.engaged(at.place_m.z) {
            // A corner cuts beside the ends from the tip on.
            let low_m = if cutter.is_flat() {
                low_m.max(ends_m)
            } else {
                low_m
            };
            if low_m >= high_m {
                continue;
            }
            for piece in self.pieces([low_m, high_m], at.place_m.z) {
                for (tooth, cuts) in in_cut.iter_mut().enumerate() {
                    let tip_rad = cutter.tooth_angle_rad(tooth, at.rotation_rad);
                    let angle_rad = tip_rad - cutter.lag_rad_per_m() * piece.height_m;
                    let chip_m = self.chip_m(layer, tooth, angle_rad, &piece, at, &passes);
                    if chip_m <= 0.0 {
                        continue;
                    }
                    *cuts = true;
                    let slice = Slice {
                        reach_m: cutter.tooth_reach_m(tooth, piece.height_m),
                        angle_rad,
                        height_m: piece.height_m,
                        thick_m: piece.thick_m,
                        chip_m,
                        lean: piece.lean,
                        along_m_per_rad: feed_m_per_rad.dot(&Ray::at(angle_rad).along),
                    };
                    loads.add(cutter, &self.coefficients, &slice, &at.vibration_m_per_rad);
                }
            }
        }
        loads.teeth_in_cut = in_cut.iter().filter(|cuts| **cuts).count();
        loads
    }

    /// The edge of a cutter with its tip at a height, between two heights of a layer, in pieces.
    fn pieces(&self, [low_m, high_m]: [f64; 2], tip_m: f64) -> impl Iterator<Item = Piece> {
        let profile = self.cutter.profile();
        let lag = self.cutter.lag_rad_per_m();
        let corner = (!profile.is_flat()).then(|| {
            let heights_m = [low_m - tip_m, high_m - tip_m];
            round::pieces(profile, heights_m, lag, SLICE_LAG_RAD)
        });
        let low_m = match profile.is_flat() {
            true => low_m,
            false => low_m.max(tip_m + profile.corner_radius_m),
        };
        let count = match low_m < high_m {
            true => ((lag.abs() * (high_m - low_m) / SLICE_LAG_RAD).ceil() as usize).max(1),
            false => 0,
        };
        let thick_m = (high_m - low_m) / count as f64;
        let upright = (0..count).map(move |slice| Piece {
            height_m: low_m + thick_m * (slice as f64 + 0.5) - tip_m,
            thick_m,
            lean: Lean::UPRIGHT,
        });
        corner.into_iter().flatten().chain(upright)
    }

    /// Where the tool was at a rotation not longer ago than a pitch, its vibration changing as now.
    pub fn place_at(&self, rotation_rad: f64, now: &ToolPlace) -> ToolPlace {
        ToolPlace {
            rotation_rad,
            place_m: self.trace.at(rotation_rad).displacement_m,
            ..*now
        }
    }

    /// Whether tip and root of a straight edge's chip lie in stock, at the lowest layer that it
    /// reaches.
    pub fn ends_in_stock(&self, tooth: usize, at: &ToolPlace) -> [bool; 2] {
        let Some((layer, height_m)) = self.looked_at(at) else {
            return [false; 2];
        };
        let angle_rad = self.cutter.tooth_angle_rad(tooth, at.rotation_rad);
        let ray = Ray::at(angle_rad);
        let reach_m = self.cutter.tooth_reach_m(tooth, height_m);
        let axis_m = at.place_m.xy();
        let is_in = |along_m: f64| self.stock.is_left(layer, &(axis_m + ray.outward * along_m));
        let tip = is_in(reach_m);
        if self.stock.block.outside_m(&axis_m) >= 2.0 * reach_m {
            return [tip; 2];
        }
        let surface_m = self.surface_m(tooth, &ray, height_m, at, &self.passes(at));
        [tip, is_in(surface_m.min(reach_m))]
    }

    /// The tool has come to this state. To be called once a step, with rising rotation.
    pub fn commit(&mut self, at: &ToolPlace) {
        if let Some((before_rad, before_m)) = self.trace.last() {
            let speed = (at.place_m - before_m).xy().norm() / (at.rotation_rad - before_rad);
            if at.rotation_rad - self.stretch_rad > 2.0 * self.lag_rad() {
                self.fastest_m_per_rad = [0.0, self.fastest_m_per_rad[0]];
                self.stretch_rad = at.rotation_rad;
            }
            self.fastest_m_per_rad[0] = self.fastest_m_per_rad[0].max(speed);
        }
        self.trace.commit(at.rotation_rad, at.place_m);
        self.cut_up_to(at.rotation_rad - self.lag_rad());
    }

    /// Cuts the stock by all of the motion.
    pub fn finish(&mut self) {
        if let Some((rotation_rad, _)) = self.trace.last() {
            self.cut_up_to(rotation_rad);
        }
    }

    /// Whether a tooth's tip in the stock has come no further on its way since the last state: its
    /// path loops, and the law of forces ends.
    pub fn turns_back(&self, at: &ToolPlace) -> bool {
        let Some((before_rad, before_m)) = self.trace.last() else {
            return false;
        };
        let Some((layer, height_m)) = self.looked_at(at) else {
            return false;
        };
        let turned_rad = at.rotation_rad - before_rad;
        let moved_m = (at.place_m - before_m).xy();
        (0..self.cutter.teeth).any(|tooth| {
            let radius_m = self.cutter.tooth_reach_m(tooth, height_m);
            let advance_m = 2.0 * radius_m * (0.5 * turned_rad).sin();
            if moved_m.norm() < advance_m {
                return false;
            }
            let angle_rad = self.cutter.tooth_angle_rad(tooth, at.rotation_rad);
            let along = Ray::at(angle_rad - 0.5 * turned_rad).along;
            let tip_m = at.place_m.xy() + radius_m * Ray::at(angle_rad).outward;
            moved_m.dot(&along) + advance_m <= 0.0 && self.stock.is_left(layer, &tip_m)
        })
    }

    /// Layers that the edge reaches, from the lowest, with the heights between which it does.
    pub(super) fn engaged(&self, tip_m: f64) -> impl Iterator<Item = (usize, [f64; 2])> + '_ {
        let (flat, round) = match self.cutter.is_flat() {
            true => (Some(self.stock.engaged(tip_m)), None),
            false => (None, Some(self.stock.reached(tip_m))),
        };
        (flat.into_iter().flatten()).chain(round.into_iter().flatten())
    }

    fn passes(&self, at: &ToolPlace) -> Passes {
        let pitch_rad = self.cutter.pitch_rad();
        let then = |m: usize| {
            let then_rad = at.rotation_rad - pitch_rad * m as f64;
            (then_rad, self.trace.at(then_rad).displacement_m)
        };
        let [now, before] = self.fastest_m_per_rad;
        let earlier: Vec<_> = (1..=REVOLUTIONS * self.cutter.teeth).map(then).collect();
        let heights_m = earlier.iter().map(|(_, then_m)| then_m.z);
        Passes {
            highest_m: match at.sinks {
                true => at.place_m.z,
                false => heights_m.fold(at.place_m.z, f64::max),
            },
            earlier,
            speed_m_per_rad: now.max(before),
        }
    }

    fn chip_m(
        &self,
        layer: usize,
        tooth: usize,
        angle_rad: f64,
        piece: &Piece,
        at: &ToolPlace,
        passes: &Passes,
    ) -> f64 {
        let ray = Ray::at(angle_rad);
        let reach_m = self.cutter.tooth_reach_m(tooth, piece.height_m);
        if reach_m <= 0.0 {
            return 0.0;
        }
        let axis_m = at.place_m.xy();
        let tip_m = axis_m + ray.outward * reach_m;
        // No chip is thicker than the way since the tooth before, and its difference in radius.
        let moved_m = (passes.earlier[0].1 - at.place_m).xy().norm();
        let shift_m = passes.speed_m_per_rad * FRAC_PI_2 * moved_m / reach_m;
        let sunk_m = self.sunk_chip_m(piece, at, passes);
        let most_m = moved_m + shift_m + 2.0 * self.cutter.runout.offset_m.abs() + sunk_m;
        if self.stock.block.outside_m(&tip_m) > most_m {
            return 0.0;
        }
        let by_heights = piece.lean.is_shallow() || self.dives(layer, passes);
        let aside_m = ray.outward * self.to_middle_m(layer, piece, at.place_m.z);
        let beyond_m = |place_m: Vector2<f64>| self.stock.beyond_m(layer, &(place_m + aside_m));
        if !by_heights && beyond_m(tip_m) < -most_m - self.stock.grid_m() {
            return 0.0;
        }
        let surface_m = self.surface_m(tooth, &ray, piece.height_m, at, passes);
        if surface_m >= reach_m {
            return 0.0;
        }
        let root_m = axis_m + ray.outward * surface_m;
        let inside_m = match by_heights {
            true => self.under_m(layer, at.place_m.z + piece.height_m, &root_m, &tip_m),
            false => (self.stock).length_in_m(&root_m, &tip_m, |place_m| beyond_m(*place_m)),
        };
        inside_m.min(reach_m - surface_m)
    }

    /// How far from the axis the surface begins that earlier teeth have left, m.
    fn surface_m(
        &self,
        tooth: usize,
        ray: &Ray,
        height_m: f64,
        at: &ToolPlace,
        passes: &Passes,
    ) -> f64 {
        let asked = Asked {
            cutter: &self.cutter,
            tooth,
            ray,
            reach_m: self.cutter.tooth_reach_m(tooth, height_m),
            now_m: at.place_m.xy(),
            speed_m_per_rad: passes.speed_m_per_rad,
        };
        asked.surface_m(passes.earlier.iter().map(|(then_rad, then_m)| Then {
            axis: Axis::Moved(&self.trace),
            then_rad: *then_rad,
            off_m: (then_m - at.place_m).xy(),
            above_m: at.place_m.z + height_m - then_m.z,
        }))
    }
}
