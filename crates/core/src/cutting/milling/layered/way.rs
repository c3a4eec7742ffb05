//! The path of a milling tool as it is written: its depths, what it must not do, what it leaves.

use super::block::{Block, Hole};
use super::round;
use super::sinking;
use super::solid::Solid;
use super::stock::{LayeredStock, MOST_SUNK_M};
use super::walls::{Side, Station};
use crate::cutting::milling::profile::Profile;
use nalgebra::{Vector2, Vector3};

/// Heights that differ by no more are one depth, m.
pub(super) const SAME_DEPTH_M: f64 = 1e-6;
/// Pieces of a slanted leg that are looked at, each at its lower end.
pub(super) const PIECES: usize = 40;
/// Grids are no coarser than this part of the cutter's radius.
pub const COARSEST: f64 = 0.125;
/// Grids are no coarser than this part of the radius of its corner, if that is round.
pub const COARSEST_OF_CORNER: f64 = 0.25;
/// Most nodes of a grid.
pub const MOST_NODES: f64 = 16e6;
/// Most stations of walls.
const MOST_STATIONS: f64 = 20_000.0;

/// A straight piece of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leg {
    pub from_m: Vector3<f64>,
    pub to_m: Vector3<f64>,
    /// Whether it is one of rapid traverse, or of joints.
    pub rapid: bool,
    /// Point of the path that it leads to.
    pub point: usize,
}

impl Leg {
    pub(super) fn is_level(&self) -> bool {
        (self.to_m.z - self.from_m.z).abs() <= SAME_DEPTH_M
    }

    fn length_m(&self) -> f64 {
        (self.to_m - self.from_m).norm()
    }
}

/// What a path does that a cutter cannot.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum WayFault {
    #[error("the tool starts in the stock; it must start beside or above it")]
    StartsInStock,
    #[error(
        "rapid traverse leads through the stock, to ({:.3}, {:.3}, {:.3}) mm; it must keep clear of it",
        to_m.x * 1e3, to_m.y * 1e3, to_m.z * 1e3
    )]
    Rapid { point: usize, to_m: Vector3<f64> },
    #[error(
        "the depth changes by {:.4} mm in the stock; it must not: the ends of the teeth do not cut, so the cutter \
         cannot plunge or ramp. Enter from beside the stock, or through a [[process.path_milling.stock.hole]]; a cutter \
         whose teeth cut to its axis has centre_cutting = true",
        drop_m * 1e3
    )]
    Plunge { point: usize, drop_m: f64 },
    #[error(
        "the tool goes down along its axis in the stock, by {:.4} of its way at ({:.3}, {:.3}, {:.3}) mm; it must not where \
         it leans: its flat end does not cut. Lean it forwards, towards the feed, enter from beside the stock, or take \
         a ball",
        sinks, at_m.x * 1e3, at_m.y * 1e3, at_m.z * 1e3
    )]
    LeadsDown {
        point: usize,
        at_m: Vector3<f64>,
        /// Way down along the axis, over the whole.
        sinks: f64,
    },
    #[error("the path never cuts the stock; it must reach into it")]
    Misses,
    #[error(
        "the path ends in air over {:.3} mm of its feed beyond the stock at ({:.3}, {:.3}) mm; the stock is smaller than the path",
        air_m * 1e3, at_m.x * 1e3, at_m.y * 1e3
    )]
    Beyond {
        point: usize,
        air_m: f64,
        at_m: Vector2<f64>,
    },
}

impl WayFault {
    /// Point of the path that it is about, if it is about one.
    pub fn point(&self) -> Option<usize> {
        match self {
            Self::StartsInStock => Some(0),
            Self::Misses => None,
            Self::Rapid { point, .. }
            | Self::Plunge { point, .. }
            | Self::LeadsDown { point, .. }
            | Self::Beyond { point, .. } => Some(*point),
        }
    }
}

/// What a path means for a block.
#[derive(Debug, Clone, PartialEq)]
pub struct Meant {
    /// The stock before the first cut.
    pub stock: LayeredStock,
    /// What a cutter that does not vibrate leaves of it on the path as written.
    pub target: LayeredStock,
    /// Walls that it leaves.
    pub stations: Vec<Station>,
    /// Lowest place of the tip over each node, m, infinite where it is not led; only of a path
    /// that sinks in stock. Where a round corner leads up beside the tip: the floor.
    pub floor_m: Option<Vec<f64>>,
    /// cos κ of the cutter where it leaves that floor, of one with a round corner.
    pub floor_cos: Option<Vec<f64>>,
    /// Depths at which the path feeds level, m, rising.
    pub levels_m: Vec<f64>,
}

/// Farthest that feed may go on beyond the stock, in diameters.
const MOST_AIR: f64 = 4.0;

impl Meant {
    /// Whether a tool at a height is at one of the levels, or above it by so little that it has not
    /// left it.
    pub fn is_at_level(&self, tip_m: f64) -> bool {
        let above_m = |level: &f64| tip_m - level;
        let mut above = self.levels_m.iter().map(above_m);
        above.any(|above_m| (-SAME_DEPTH_M..MOST_SUNK_M).contains(&above_m))
    }
}

/// Follows a path through stock with a cutter of this outline, whose ends cut or do not: a block,
/// or what of it lies in a solid.
///
/// # Errors
/// The first thing that the cutter cannot do.
pub fn follow(
    legs: &[Leg],
    block: Block,
    holes: &[Hole],
    solid: Option<&Solid>,
    profile: &Profile,
    grid_m: f64,
    ends_cut: bool,
) -> Result<Meant, WayFault> {
    let radius_m = profile.radius_m;
    let levels_m = depths_m(legs);
    let mut depths = levels_m.clone();
    if let Some(solid) = solid {
        depths.extend(solid.depths_m(grid_m));
        sorted(&mut depths);
    }
    let about_corners = match profile.is_flat() {
        true => Vec::new(),
        false => round::depths_m(&levels_m, profile, &block, grid_m),
    };
    let whole = |depths: &[f64]| {
        let divided = divided(depths.to_vec(), &about_corners, &block);
        let mut stock = LayeredStock::new(block, holes, grid_m, &divided);
        if let Some(solid) = solid {
            stock.keep_within(solid);
        }
        stock
    };
    let mut stock = whole(&depths);
    let mut sinks = vec![false; legs.len()];
    if ends_cut {
        sinks = sinking::sinking(legs, &mut stock, profile);
        let sunk = sinking::depths_m(legs, &sinks, &block, &stock, profile);
        if profile.is_flat() {
            depths.extend(sunk);
            sorted(&mut depths);
        } else {
            depths = divided(depths, &sunk, &block);
        }
        stock = whole(&depths);
    }
    let piece_m = sinking::piece_m(&stock, profile);
    let mut target = stock.clone();
    let mut cuts = false;
    if let Some(first) = legs.first() {
        let at = [first.from_m, first.from_m];
        if target.cut_leg(at, profile, true) {
            return Err(WayFault::StartsInStock);
        }
    }
    for (leg, sinks) in legs.iter().zip(&sinks) {
        let way = [leg.from_m, leg.to_m];
        if *sinks {
            check_air(leg, &block, radius_m)?;
            for piece in leg.pieces(piece_m) {
                cuts |= target.cut_leg(piece, profile, false);
            }
            continue;
        }
        if leg.rapid || !leg.is_level() {
            let at = |piece: usize| leg.from_m.lerp(&leg.to_m, piece as f64 / PIECES as f64);
            let pieces = if leg.is_level() { 1 } else { PIECES };
            let touches = match pieces {
                1 => target.cut_leg(way, profile, true),
                _ => (0..pieces).any(|k| target.cut_leg([at(k), at(k + 1)], profile, true)),
            };
            if !touches {
                continue;
            }
            return Err(match leg.rapid {
                true => WayFault::Rapid {
                    point: leg.point,
                    to_m: leg.to_m,
                },
                false => WayFault::Plunge {
                    point: leg.point,
                    drop_m: leg.to_m.z - leg.from_m.z,
                },
            });
        }
        check_air(leg, &block, radius_m)?;
        cuts |= target.cut_leg(way, profile, false);
    }
    if !cuts {
        return Err(WayFault::Misses);
    }
    let stations = stations(legs, &stock, &target, profile);
    let (floor_m, floor_cos) = match (profile.is_flat(), sinks.contains(&true)) {
        (true, false) => (None, None),
        (true, true) => (Some(sinking::floor_m(legs, &sinks, &stock, radius_m)), None),
        (false, _) => {
            let (floor_m, floor_cos) = round::floor(legs, &sinks, &stock, profile);
            (Some(floor_m), Some(floor_cos))
        }
    };
    Ok(Meant {
        floor_m,
        floor_cos,
        levels_m,
        stock,
        target,
        stations,
    })
}

/// Refuses feed at depth far beyond the stock.
fn check_air(leg: &Leg, block: &Block, radius_m: f64) -> Result<(), WayFault> {
    if leg.to_m.z >= block.most_m.z {
        return Ok(());
    }
    let at_m = leg.to_m.xy();
    let air_m = block.outside_m(&at_m);
    if air_m <= 2.0 * MOST_AIR * radius_m {
        return Ok(());
    }
    Err(WayFault::Beyond {
        point: leg.point,
        air_m,
        at_m,
    })
}

/// Depths of the path at which it feeds level.
fn depths_m(legs: &[Leg]) -> Vec<f64> {
    let level = legs.iter().filter(|leg| !leg.rapid && leg.is_level());
    let mut depths: Vec<f64> = level.map(|leg| leg.from_m.z).collect();
    sorted(&mut depths);
    depths
}

/// Of the block's diagonal: a layer that corners and slopes are divided by is no thinner, or the
/// triangles of its sides pass for faults of the mesh.
const LEAST_LAYER: f64 = 2e-4;

/// Layers divided at further heights, but those so near to one that is there, or to a face of the
/// block, that a layer would be too thin. Rising order before and after.
fn divided(mut depths: Vec<f64>, further: &[f64], block: &Block) -> Vec<f64> {
    let (least, most) = (block.least_m, block.most_m);
    let least_m = LEAST_LAYER * (most - least).norm();
    for &z in further {
        let at = depths.partition_point(|there| *there < z);
        let below = at
            .checked_sub(1)
            .map_or(least.z, |before| depths[before].max(least.z));
        let above = depths.get(at).map_or(most.z, |next| next.min(most.z));
        if z - below >= least_m && above - z >= least_m {
            depths.insert(at, z);
        }
    }
    depths
}

/// Heights in rising order, each once.
fn sorted(depths: &mut Vec<f64>) {
    depths.sort_by(f64::total_cmp);
    depths.dedup_by(|a, b| (*a - *b).abs() <= SAME_DEPTH_M);
}

/// Walls beside level feed: where the cutter's rim, across the path, ends what is cut.
fn stations(
    legs: &[Leg],
    stock: &LayeredStock,
    target: &LayeredStock,
    profile: &Profile,
) -> Vec<Station> {
    let radius_m = profile.radius_m;
    let whole_m: f64 = legs.iter().map(Leg::length_m).sum();
    let grid_m = stock.grid_m();
    let spacing_m = grid_m.max(whole_m / MOST_STATIONS);
    let mut found = Vec::new();
    let mut begun_m = 0.0;
    for leg in legs {
        let length_m = leg.length_m();
        let level = !leg.rapid && leg.is_level() && length_m > 0.0;
        if level && leg.from_m.z < stock.block.most_m.z {
            let along = (leg.to_m - leg.from_m).xy() / length_m;
            let left = Vector2::new(-along.y, along.x);
            let first = (begun_m / spacing_m).ceil() * spacing_m - begun_m;
            let count = ((length_m - first) / spacing_m).floor() + 1.0;
            for k in 0..count.max(0.0) as usize {
                let way_m = first + spacing_m * k as f64;
                let from_m = leg.from_m.xy() + along * way_m;
                for (side, outward) in [(Side::Left, left), (Side::Right, -left)] {
                    let wall_m = from_m + outward * radius_m;
                    // Upright walls: a round corner's are floors.
                    let upright_m = leg.from_m.z + profile.corner_radius_m - SAME_DEPTH_M;
                    let is_wall = |layer: &usize| {
                        profile.is_flat() || stock.layers()[*layer].bottom_m >= upright_m
                    };
                    let layers = stock.taken_by(leg.from_m.z, profile).filter(is_wall);
                    found.extend(layers.filter_map(|layer| {
                        let behind_m = wall_m + outward * grid_m;
                        // In a corner the other leg takes more: by no more than the grid's own
                        // error, or the mean would depend on the grid.
                        let stands = stock.is_left(layer, &behind_m)
                            && target.is_left(layer, &behind_m)
                            && target.beyond_m(layer, &wall_m) > -0.5 * grid_m * grid_m / radius_m;
                        stands.then_some(Station {
                            side,
                            layer,
                            along_m: begun_m + way_m,
                            from_m,
                            outward,
                        })
                    }));
                }
            }
        }
        begun_m += length_m;
    }
    found
}
