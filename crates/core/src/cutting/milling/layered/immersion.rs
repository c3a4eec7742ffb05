//! Where the rim of a tool is in stock.

use super::cut::{LayeredCut, ToolPlace};
use super::stock::LayeredStock;
use crate::cutting::milling::earlier::Ray;
use nalgebra::Vector2;
use std::f64::consts::{FRAC_PI_2, PI};

/// Angles at which the rim is looked at for where it enters and leaves.
const LOOKED_AT: usize = 180;
/// Halvings that find such an angle.
const HALVINGS: usize = 30;

/// Where the rim is in stock, from +y' towards the feed x' (y' = z × x').
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Immersion {
    /// Where the first arc begins, rad.
    pub entry_rad: f64,
    /// Where the last one ends, rad.
    pub exit_rad: f64,
    /// All arcs together, rad.
    pub engaged_rad: f64,
}

impl LayeredCut {
    /// Where the rim of a tool that is fed along `feed` is in stock at the layer of its tip; of one
    /// with a round corner at the highest layer at which it is in stock, on its radius there.
    pub fn immersion(&self, at: &ToolPlace, feed: &Vector2<f64>) -> Option<Immersion> {
        let axis_m = at.place_m.xy();
        if self.cutter.is_flat() {
            let (layer, _) = self.engaged(at.place_m.z).next()?;
            return (self.stock).immersion(layer, &axis_m, self.cutter.radius_m, feed);
        }
        let layers = self.stock.taken_by(at.place_m.z, &self.cutter.profile());
        layers.rev().find_map(|layer| {
            let height_m = self.stock.layers()[layer].middle_m() - at.place_m.z;
            let radius_m = self.cutter.profile().radius_at_m(height_m);
            self.stock.immersion(layer, &axis_m, radius_m, feed)
        })
    }
}

impl LayeredStock {
    /// Where a rim about an axis that is fed along `feed` is in a layer.
    pub fn immersion(
        &self,
        layer: usize,
        axis_m: &Vector2<f64>,
        radius_m: f64,
        feed: &Vector2<f64>,
    ) -> Option<Immersion> {
        arcs(feed, |angle| {
            let place = axis_m + radius_m * Ray::at(angle).outward;
            self.is_left(layer, &place)
        })
    }
}

/// Where a rim that is fed along `feed` is in stock, which is asked for at angles of the frame in
/// which the feed is given.
pub(in crate::cutting::milling) fn arcs(
    feed: &Vector2<f64>,
    is_left: impl Fn(f64) -> bool,
) -> Option<Immersion> {
    let left_rad = feed.x.atan2(feed.y) - FRAC_PI_2;
    let is_in = |angle: f64| is_left(left_rad + angle);
    let step = PI / LOOKED_AT as f64;
    let mut found: Option<Immersion> = None;
    let mut add = |from: f64, to: f64| {
        let arc = found.get_or_insert(Immersion {
            entry_rad: from,
            ..Immersion::default()
        });
        arc.exit_rad = to;
        arc.engaged_rad += to - from;
    };
    let mut before = (1e-6, is_in(1e-6));
    for k in 1..=LOOKED_AT {
        let angle = (step * k as f64).min(PI - 1e-6);
        let now = (angle, is_in(angle));
        match (before.1, now.1) {
            (true, true) => add(before.0, now.0),
            (false, false) => {}
            (starts, _) => {
                let (mut low, mut high) = (before.0, now.0);
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (low + high);
                    match is_in(middle) == starts {
                        true => low = middle,
                        false => high = middle,
                    }
                }
                match starts {
                    true => add(before.0, low),
                    false => add(high, now.0),
                }
            }
        }
        before = now;
    }
    found
}
