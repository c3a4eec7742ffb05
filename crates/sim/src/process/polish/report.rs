//! What a polishing run ends with: vibration at edges and inside, removal at edges and inside,
//! roughness.

use super::surface::Surface;
use super::{PolishSetup, PolishStep};
use crate::process::Findings;
use crate::process::quantity::{self, Quantity};
use nalgebra::Vector3;
use truecut_recording::{Profile, Unit};

/// Length of the windows in which the deviation of the acceleration is taken, s.
const WINDOW_S: f64 = 0.25;
/// Windows that begin earlier belong to the lead-in, s.
const SETTLED_S: f64 = 1.0;
/// Windows in which the wheel leaves its line by more belong to the raster's corners, which shake
/// the arm by themselves, m.
const STRAIGHT_M: f64 = 0.2e-3;
/// Width of the band along edges whose depth is compared with the middle's, m.
const BAND_M: f64 = 1e-3;

/// What is watched while the run goes on.
#[derive(Debug, Clone, Default)]
pub(super) struct Watch {
    /// Largest reach of the patch.
    reach_m: f64,
    velocity_m_per_s: Option<Vector3<f64>>,
    time_s: f64,
    window: Window,
    at_edges: Deviations,
    in_middle: Deviations,
    edge_n_s: f64,
    inward_n_s: f64,
}

/// Sums of one window.
#[derive(Debug, Clone, Copy, Default)]
struct Window {
    begin_s: f64,
    samples: f64,
    /// Sums and squares of the acceleration along the face's length, width and normal, and along
    /// the outward normal of the nearest edge.
    sums: [[f64; 2]; 4],
    touched_an_edge: bool,
    turned: bool,
    from_y_m: Option<f64>,
    left_the_middle: bool,
}

/// Squares of the standard deviations of many windows: along the normal, in the plane, along the
/// outward normal of the nearest edge.
#[derive(Debug, Clone, Copy, Default)]
struct Deviations {
    windows: f64,
    squares: [f64; 3],
    largest: [f64; 3],
}

const NORMAL: usize = 0;
const IN_PLANE: usize = 1;
const OUTWARD: usize = 2;

impl Deviations {
    fn add(&mut self, window: &Window) {
        let [x, y, normal, outward] = window.sums.map(|[sum, squares]| {
            let mean = sum / window.samples;
            (squares / window.samples - mean * mean).max(0.0)
        });
        self.windows += 1.0;
        for (k, variance) in [normal, x + y, outward].into_iter().enumerate() {
            self.squares[k] += variance;
            self.largest[k] = self.largest[k].max(variance.sqrt());
        }
    }

    /// Root of the mean square; NaN without windows.
    fn rms(&self, direction: usize) -> f64 {
        (self.squares[direction] / self.windows).sqrt()
    }
}

impl Watch {
    pub fn new(setup: &PolishSetup) -> Self {
        let d = setup.indentation_m;
        Self {
            reach_m: (d * (2.0 * setup.spec.wheel.radius_m - d)).sqrt(),
            ..Self::default()
        }
    }

    /// Difference quotient of the velocity, half a step late.
    pub fn acceleration_m_s2(&mut self, velocity_m_per_s: Vector3<f64>, dt_s: f64) -> Vector3<f64> {
        let before = self.velocity_m_per_s.replace(velocity_m_per_s);
        before.map_or_else(Vector3::zeros, |before| (velocity_m_per_s - before) / dt_s)
    }

    /// `inside_m` is how far inside the nearest edge the middle of the patch is.
    pub fn step(&mut self, last: &PolishStep, inside_m: f64, dt_s: f64) {
        self.edge_n_s += last.edge_n * dt_s;
        self.inward_n_s += last.inward_n * dt_s;
        let [x, y, normal] = last.acceleration_m_s2.into();
        let window = &mut self.window;
        window.samples += 1.0;
        for (sum, value) in (window.sums.iter_mut()).zip([x, y, normal, last.outward_m_s2]) {
            sum[0] += value;
            sum[1] += value * value;
        }
        let from_y_m = *window.from_y_m.get_or_insert(last.at_m.y);
        window.turned |= (last.at_m.y - from_y_m).abs() > STRAIGHT_M;
        window.touched_an_edge |= last.edge_n > 0.0;
        window.left_the_middle |= inside_m < 2.0 * self.reach_m;
        self.time_s += dt_s;
        if self.time_s - window.begin_s < WINDOW_S {
            return;
        }
        let done = std::mem::replace(
            &mut self.window,
            Window {
                begin_s: self.time_s,
                ..Window::default()
            },
        );
        if done.begin_s < SETTLED_S || done.turned {
            return;
        }
        if done.touched_an_edge {
            self.at_edges.add(&done);
        } else if !done.left_the_middle {
            self.in_middle.add(&done);
        }
    }
}

/// Mean depths of a band along the edges and of what lies further inside than a patch is wide.
fn depths(setup: &PolishSetup, surface: &Surface, watch: &Watch) -> (f64, f64) {
    let (mut band, mut middle) = ((0.0, 0.0), (0.0, 0.0));
    for (cell, depth) in surface.grid.removed_m().iter().enumerate() {
        let at = surface.middle_m(cell);
        let inside = (at.x.min(setup.spec.face.length_m - at.x))
            .min(at.y.min(setup.spec.face.width_m - at.y));
        let sum = if inside < BAND_M {
            &mut band
        } else if inside > 2.0 * watch.reach_m {
            &mut middle
        } else {
            continue;
        };
        *sum = (sum.0 + depth, sum.1 + 1.0);
    }
    (band.0 / band.1, middle.0 / middle.1)
}

pub(super) fn findings(setup: &PolishSetup, surface: &Surface, watch: &Watch) -> Findings {
    let removed = removal(setup, surface, watch);
    Findings {
        scalars: quantity::scalars(
            removed
                .into_iter()
                .chain(pressing(watch))
                .chain(plane(watch)),
        ),
        profiles: vec![across(setup, surface)],
        ..Findings::default()
    }
}

/// What is off the face.
fn removal(setup: &PolishSetup, surface: &Surface, watch: &Watch) -> [Quantity; 7] {
    let (band_m, middle_m) = depths(setup, surface, watch);
    let roughness: Vec<f64> = (surface.grid.dose_j_per_m2().iter())
        .map(|dose| setup.spec.abrasive.polishing.ra_m(*dose))
        .collect();
    let mean_ra = roughness.iter().sum::<f64>() / roughness.len() as f64;
    let largest_ra = roughness.iter().copied().fold(0.0, f64::max);
    let (removed_m3, preston_m3) = (surface.grid.volume_m3(), surface.preston_m3(setup));
    [
        Quantity::new("polish.removed_volume", Unit::CubicMetre, removed_m3)
            .text("Volume removed from the face"),
        Quantity::new("polish.preston_volume", Unit::CubicMetre, preston_m3)
            .text("Preston's integral k_p ∫ p v dA dt"),
        Quantity::new("polish.depth_middle", Unit::Metre, middle_m)
            .text("Mean depth further inside than the patch is wide"),
        Quantity::new("polish.depth_edge", Unit::Metre, band_m)
            .text("Mean depth within 1 mm of the edges"),
        Quantity::new("polish.edge_excess", Unit::One, band_m / middle_m - 1.0)
            .text("Depth within 1 mm of the edges over that of the middle, less 1"),
        Quantity::new("polish.roughness_mean", Unit::Metre, mean_ra).text("Mean Ra of the cells"),
        Quantity::new("polish.roughness_largest", Unit::Metre, largest_ra)
            .text("Largest Ra of a cell"),
    ]
}

/// How the wheel ran.
fn pressing(watch: &Watch) -> [Quantity; 5] {
    let (edge, middle) = (watch.at_edges.rms(NORMAL), watch.in_middle.rms(NORMAL));
    let inward = watch.inward_n_s / watch.edge_n_s;
    let burst = watch.at_edges.largest[NORMAL] / middle;
    let acceleration = |name, value| Quantity::new(name, Unit::MetrePerSecondSquared, value);
    [
        acceleration("polish.acceleration_edge", edge).text(
            "Standard deviation of the normal acceleration, rms over windows of 0.25 s on straight \
             lines with an edge in the patch",
        ),
        acceleration("polish.acceleration_middle", middle)
            .text("The same over windows whose patch stays a patch's width inside"),
        Quantity::new("polish.acceleration_ratio", Unit::One, edge / middle)
            .text("Edge over middle"),
        Quantity::new("polish.acceleration_burst", Unit::One, burst)
            .text("Largest window with an edge in the patch over the middle's"),
        Quantity::new("polish.inward_share", Unit::One, inward)
            .text("Share of the edge force, over time, on edges over which the wheel moves inward"),
    ]
}

/// Vibration in the plane of the face, as along its normal.
fn plane(watch: &Watch) -> [Quantity; 7] {
    let rms = |direction| [&watch.at_edges, &watch.in_middle].map(|of| of.rms(direction));
    let [edge, middle] = rms(IN_PLANE);
    let [out_edge, out_middle] = rms(OUTWARD);
    let burst = watch.at_edges.largest[IN_PLANE] / middle;
    let acceleration = |name, value| Quantity::new(name, Unit::MetrePerSecondSquared, value);
    [
        acceleration("polish.in_plane_edge", edge).text(
            "Standard deviation of the acceleration in the plane, rms over windows of 0.25 s on \
             straight lines with an edge in the patch",
        ),
        acceleration("polish.in_plane_middle", middle)
            .text("The same over windows whose patch stays a patch's width inside"),
        Quantity::new("polish.in_plane_ratio", Unit::One, edge / middle).text("Edge over middle"),
        Quantity::new("polish.in_plane_burst", Unit::One, burst)
            .text("Largest window with an edge in the patch over the middle's"),
        acceleration("polish.outward_edge", out_edge)
            .text("Of in_plane_edge the part along the outward normal of the nearest edge"),
        acceleration("polish.outward_middle", out_middle)
            .text("Of in_plane_middle the part along the outward normal of the nearest edge"),
        Quantity::new("polish.outward_ratio", Unit::One, out_edge / out_middle)
            .text("Edge over middle"),
    ]
}

/// Mean depth of each row over the middle half of the length.
fn across(setup: &PolishSetup, surface: &Surface) -> Profile {
    let rows = surface.grid.rows();
    Profile {
        name: "polish.removed_depth".into(),
        description: "Depth removed across the face, mean over the middle half of its length"
            .into(),
        axis_name: "face_y".into(),
        axis_unit: Unit::Metre,
        axis: (0..rows)
            .map(|row| (row as f64 + 0.5) * setup.spec.face.width_m / rows as f64)
            .collect(),
        unit: Unit::Metre,
        values: surface.grid.middle_means_m(),
    }
}
