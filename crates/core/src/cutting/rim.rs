//! The rim of the hole: chamfer depth by angle, as earlier passes left it.
//!
//! A cut is a continuous curve "depth over angle" of which the simulation knows one point per step.
//! Bins of the rim receive the linear interpolation of that curve at their own angle, one bin
//! behind the edge: what an edge reads ahead of itself was therefore always left by the *previous*
//! pass.

use std::collections::VecDeque;
use std::f64::consts::TAU;

/// How far behind the edge, in bins, a bin must lie to be written. A little more than one, so that
/// rounding cannot bring the bin that the edge is still reading within reach.
const WRITE_LAG: f64 = 1.001;

/// Depth around the rim, m, on equally spaced bins from process Y towards Z.
#[derive(Debug, Clone, PartialEq)]
pub struct Rim {
    depth_m: Vec<f64>,
    edges: Vec<EdgeTrace>,
}

/// Where one edge last was: unwrapped bin coordinate and depth, and the next bin that waits for it.
#[derive(Debug, Clone, PartialEq)]
struct EdgeTrace {
    position: f64,
    depth_m: f64,
    next_bin: i64,
    /// Bins that the edge has passed by less than the lag, with the depth they will receive.
    held: VecDeque<(i64, f64)>,
}

impl Rim {
    /// A rim of `bins` bins with initial depth given by angle, for `edges` edges that start at the
    /// given angles (rad), each at a depth of its own.
    pub fn new(
        bins: usize,
        initial_depth_m: impl Fn(f64) -> f64,
        edge_angles_rad: &[f64],
        edge_depth_m: impl Fn(usize) -> f64,
    ) -> Self {
        let depth_m = (0..bins)
            .map(|i| initial_depth_m(TAU * i as f64 / bins as f64))
            .collect();
        let edges = edge_angles_rad
            .iter()
            .enumerate()
            .map(|(edge, angle)| {
                let position = angle / TAU * bins as f64;
                EdgeTrace {
                    position,
                    depth_m: edge_depth_m(edge),
                    next_bin: position.ceil() as i64,
                    held: VecDeque::new(),
                }
            })
            .collect();
        Self { depth_m, edges }
    }

    /// Number of bins.
    pub fn bins(&self) -> usize {
        self.depth_m.len()
    }

    /// Depth by bin, m.
    pub fn depths_m(&self) -> &[f64] {
        &self.depth_m
    }

    /// Angle of a bin, rad.
    pub fn angle_rad(&self, bin: usize) -> f64 {
        TAU * bin as f64 / self.bins() as f64
    }

    /// Depth that earlier passes left at an angle, m, linear between bins.
    pub fn depth_at_m(&self, angle_rad: f64) -> f64 {
        let n = self.bins();
        let x = (angle_rad / TAU).rem_euclid(1.0) * n as f64;
        let low = (x.floor() as usize).min(n - 1);
        let part = x - low as f64;
        self.depth_m[low] * (1.0 - part) + self.depth_m[(low + 1) % n] * part
    }

    /// Edge `edge` has come to `angle_rad` (unwrapped, never decreasing) at `depth_m`: bins that
    /// lie at least one bin behind it are deepened to the curve between this point and the one
    /// before. An edge above the surface leaves the surface alone.
    pub fn cut(&mut self, edge: usize, angle_rad: f64, depth_m: f64) {
        let n = self.bins() as i64;
        let x = angle_rad / TAU * n as f64;
        let trace = &mut self.edges[edge];
        let (x0, d0) = (trace.position, trace.depth_m);
        while (trace.next_bin as f64) <= x {
            let along = trace.next_bin as f64 - x0;
            let depth = if x > x0 {
                d0 + (depth_m - d0) * along / (x - x0)
            } else {
                depth_m
            };
            trace.held.push_back((trace.next_bin, depth));
            trace.next_bin += 1;
        }
        while let Some(&(bin, depth)) = trace.held.front()
            && bin as f64 <= x - WRITE_LAG
        {
            deepen(&mut self.depth_m, bin, depth);
            trace.held.pop_front();
        }
        trace.position = x;
        trace.depth_m = depth_m;
    }

    /// Writes what the edges still hold back: the state after the tool has left.
    pub fn finish(&mut self) {
        for trace in &mut self.edges {
            for (bin, depth) in trace.held.drain(..) {
                deepen(&mut self.depth_m, bin, depth);
            }
        }
    }
}

fn deepen(depths: &mut [f64], bin: i64, depth_m: f64) {
    let i = bin.rem_euclid(depths.len() as i64) as usize;
    depths[i] = depths[i].max(depth_m);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A helix read one revolution later gives the feed per revolution everywhere.
    #[test]
    fn verify_previous_pass_of_a_helix_is_one_feed_shallower() {
        let feed = 5e-5;
        let bins = 720;
        // The pass before the first: depth grows from 0 to one feed around the rim.
        let mut rim = Rim::new(bins, |angle| feed * angle / TAU, &[0.0], |_| feed);
        let steps_per_rev = 777; // not a multiple of the bins
        for i in 1..(3 * steps_per_rev) {
            let angle = TAU * i as f64 / steps_per_rev as f64;
            let depth = feed * angle / TAU + feed;
            let thickness = depth - rim.depth_at_m(angle);
            // Where the helix steps from one revolution to the next (within two bins of angle zero)
            // the surface has a real step of one feed, which linear interpolation smears over a
            // bin.
            let from_step = (angle / TAU).fract() * bins as f64;
            if from_step > 2.0 && from_step < bins as f64 - 2.0 {
                assert!(
                    (thickness / feed - 1.0).abs() < 1e-9,
                    "{angle}: {thickness}"
                );
            }
            rim.cut(0, angle, depth);
        }
    }

    #[test]
    fn an_edge_never_reads_what_it_has_just_cut() {
        for steps_per_rev in [97, 719, 720, 721, 5000] {
            let mut rim = Rim::new(720, |_| 0.0, &[0.0], |_| 1.0);
            for i in 1..steps_per_rev {
                let angle = TAU * i as f64 / steps_per_rev as f64;
                if angle > TAU * (1.0 - 1.5 / 720.0) {
                    break; // the bin ahead is now the one where the cut began
                }
                assert_eq!(rim.depth_at_m(angle), 0.0, "{steps_per_rev} {i}");
                rim.cut(0, angle, 1.0);
            }
            rim.finish();
            let cut = rim.depths_m().iter().filter(|d| **d == 1.0).count();
            assert!(cut + 720 / steps_per_rev >= 717, "{steps_per_rev}: {cut}");
        }
    }

    #[test]
    fn verify_a_lifted_edge_leaves_the_surface() {
        let mut rim = Rim::new(90, |_| 2e-4, &[0.0], |_| 0.0);
        for i in 1..200 {
            rim.cut(0, TAU * i as f64 / 100.0, 1e-4);
        }
        rim.finish();
        assert!(rim.depths_m().iter().all(|d| *d == 2e-4));
    }

    #[test]
    fn verify_second_edge_reads_the_cut_of_the_first() {
        let half = std::f64::consts::PI;
        let mut rim = Rim::new(360, |_| 0.0, &[0.0, half], |_| 1e-4);
        for i in 1..=500 {
            let angle = half * i as f64 / 500.0;
            rim.cut(0, angle, 1e-4);
        }
        assert!((rim.depth_at_m(0.5 * half) - 1e-4).abs() < 1e-18);
    }
}
