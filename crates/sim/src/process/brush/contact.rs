//! Brush and workpiece at one instant, bristle by bristle.
//!
//! The brush is looked at in rows along its axis ([`super::rows`]). In each, the workpiece is a
//! polygon ([`super::section`]); a bristle that would reach to the radius is held at the first side
//! that it meets, and presses along itself with the force of its law
//! ([`truecut_core::wheel::brush`]). Friction acts square to it, against the sliding of its tip. So
//! a bristle is taken also where a face stands askew to it, at an edge: its law is one of a tip
//! that is pressed back along the bristle.

use super::rows::{BristleRow, Corners, SLICES, Sections, is_in_reach};
use super::section::Side;
use super::{BrushSetup, RULES, Station};
use crate::process::ToolState;
use nalgebra::{Isometry3, Point3, Vector3};
use std::f64::consts::TAU;
use truecut_core::wheel::bristle::Bristle;
use truecut_core::wheel::brush::Brush;

/// An edge is reached over a face that stands by this sine at least to the bristles: along a face
/// that runs with them no tip slides.
const LEAST_FACING: f64 = 0.1;
/// A side that is narrower, and along which shortenings differ by a lesser factor, is even.
const NARROW_RAD: f64 = 0.1;
const LIKE: f64 = 1.5;
/// A tip that slides more slowly has no direction, m/s.
const LEAST_SPEED_M_PER_S: f64 = 1e-9;

/// Motion of the tool in its own frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Motion {
    pub tool_from_mesh: Isometry3<f64>,
    pub velocity_m_per_s: Vector3<f64>,
    /// The brush's own spin included.
    pub turning_rad_s: Vector3<f64>,
}

impl Motion {
    fn of(setup: &BrushSetup, state: &ToolState) -> Self {
        let tool_from_world = state.world_from_tool.inverse();
        let in_world = setup.process_from_world.inverse() * state.tool.velocity_m_per_s;
        Self {
            tool_from_mesh: tool_from_world * setup.world_from_mesh,
            velocity_m_per_s: tool_from_world.rotation * in_world,
            turning_rad_s: tool_from_world.rotation * state.tool_turning_rad_s
                + Vector3::y() * setup.spin_rad_s,
        }
    }

    /// Velocity of a tip that is held at a point, square to its bristle.
    fn sliding_m_per_s(&self, point_m: &Vector3<f64>, bristle: &Vector3<f64>) -> Vector3<f64> {
        let velocity = self.velocity_m_per_s + self.turning_rad_s.cross(point_m);
        velocity - bristle * velocity.dot(bristle)
    }
}

/// What a brush does at one instant; forces on the tool, in the tool's frame.
#[derive(Debug, Clone, Default)]
pub(super) struct BrushContact {
    pub force_n: Vector3<f64>,
    /// About the tool point.
    pub moment_n_m: Vector3<f64>,
    /// Sum of the forces of all bristles, each along itself.
    pub bristle_n: f64,
    /// Friction of all tips together.
    pub friction_n: Vector3<f64>,
    /// What friction takes.
    pub power_w: f64,
    /// By how much the bristle that is pressed in most is shortened.
    pub shortening_m: f64,
    /// Edge under the brush.
    pub edge_m: f64,
    /// Stations under the brush, and `ρ n v` there, W/m².
    pub doses_w_per_m2: Vec<(usize, f64)>,
}

impl BrushContact {
    pub fn of(setup: &BrushSetup, state: &ToolState) -> Self {
        let brush = setup.brush_at(state.time_s);
        let motion = Motion::of(setup, state);
        let mut contact = Self::default();
        let triangles = triangles(setup, &brush, &motion.tool_from_mesh);
        if triangles.is_empty() {
            return contact;
        }
        let mut sections = Sections::new(&triangles, brush.width_m, brush.radius_m);
        let mut nearest = Vec::new();
        for row in sections.rows(&RULES) {
            sections.nearest(row.y_m, &mut nearest);
            for side in &nearest {
                let nodes = match is_even(side, brush.radius_m, &setup.bristle) {
                    true => RULES.pair(),
                    false => RULES.by_sine(),
                };
                contact.press((&brush, &setup.bristle), &motion, nodes, &row, side);
            }
        }
        for place in under(&brush, &motion, &setup.stations) {
            // A station may lie beside the mesh's edge by what is rounded in its file.
            let nearer_m = brush.width_m / SLICES as f64;
            if !sections.hide(&place.point_m, nearer_m) {
                contact.pass_over(setup, &brush, &motion, &place);
            }
        }
        contact
    }

    /// Adds the bristles of a row over a side, at nodes of `[-1, 1]` with their weights.
    fn press(
        &mut self,
        (brush, law): (&Brush, &Bristle),
        motion: &Motion,
        nodes: &[(f64, f64)],
        row: &BristleRow,
        side: &Side,
    ) {
        let middle = 0.5 * (side.from_rad + side.to_rad);
        let half = 0.5 * (side.to_rad - side.from_rad);
        let per_rad = brush.bristles / TAU * row.share;
        let foot = Vector3::new(side.foot_rad.sin(), 0.0, side.foot_rad.cos());
        for (node, weight) in nodes {
            let (sine, cosine) = (middle + half * node).sin_cos();
            let count = per_rad * weight * half;
            let bristle = Vector3::new(sine, 0.0, cosine);
            let along_m = side.distance_m / bristle.dot(&foot);
            let point_m = bristle * along_m + Vector3::y() * row.y_m;
            let shortening_m = brush.radius_m - along_m;
            let force_n = count * law.force_n(shortening_m);
            let sliding = motion.sliding_m_per_s(&point_m, &bristle);
            let speed = sliding.norm();
            let friction_n = match speed > LEAST_SPEED_M_PER_S {
                true => sliding * (-brush.mu * force_n / speed),
                false => Vector3::zeros(),
            };
            let on_tool = friction_n - bristle * force_n;
            self.force_n += on_tool;
            self.moment_n_m += point_m.cross(&on_tool);
            self.bristle_n += force_n;
            self.friction_n += friction_n;
            self.power_w += brush.mu * force_n * speed;
            self.shortening_m = self.shortening_m.max(shortening_m);
        }
    }

    /// Adds the dose of a station.
    fn pass_over(&mut self, setup: &BrushSetup, brush: &Brush, motion: &Motion, place: &Place) {
        let bristle = Vector3::new(place.point_m.x, 0.0, place.point_m.z) / place.along_m;
        let per_m2 = brush.bristles / (TAU * place.along_m * brush.width_m);
        let speed = motion.sliding_m_per_s(&place.point_m, &bristle).norm();
        let force_n = setup.bristle.force_n(brush.radius_m - place.along_m);
        self.edge_m += setup.stations[place.station].length_m;
        self.doses_w_per_m2
            .push((place.station, per_m2 * force_n * speed));
    }
}

/// Whether a side is so narrow that its bristles are shortened nearly alike: forces, which begin
/// like a root, then change smoothly enough for two nodes, within a thousandth. Where tips begin to
/// lie along the face, the law has a corner.
fn is_even(side: &Side, reach_m: f64, law: &Bristle) -> bool {
    if side.to_rad - side.from_rad > NARROW_RAD {
        return false;
    }
    let foot_rad = side.foot_rad.clamp(side.from_rad, side.to_rad);
    let places = [side.from_rad, side.to_rad, foot_rad];
    let shortened = places.map(|angle| reach_m - side.along_bristle_m(angle));
    let least_m = shortened.into_iter().fold(f64::INFINITY, f64::min);
    let most_m = shortened.into_iter().fold(0.0, f64::max);
    let corner_m = law.lying_m();
    most_m < LIKE * least_m && (most_m <= corner_m || least_m >= corner_m)
}

/// A station within the brush's reach.
struct Place {
    station: usize,
    /// In the tool's frame.
    point_m: Vector3<f64>,
    /// Distance from the axis.
    along_m: f64,
}

/// The stations under the brush that face it.
fn under(brush: &Brush, motion: &Motion, stations: &[Station]) -> Vec<Place> {
    let to_tool = motion.tool_from_mesh.rotation.to_rotation_matrix();
    let place = |(index, station): (usize, &Station)| {
        let point_m = to_tool * station.point_m + motion.tool_from_mesh.translation.vector;
        if point_m.y.abs() > 0.5 * brush.width_m {
            return None;
        }
        let along_m = point_m.x.hypot(point_m.z);
        if along_m <= 0.0 || along_m >= brush.radius_m {
            return None;
        }
        let bristle = Vector3::new(point_m.x, 0.0, point_m.z) / along_m;
        let faces = station.normals.iter().map(|n| to_tool * n.into_inner());
        let facing = faces.map(|normal| -normal.dot(&bristle));
        (facing.fold(0.0, f64::max) >= LEAST_FACING).then_some(Place {
            station: index,
            point_m,
            along_m,
        })
    };
    stations.iter().enumerate().filter_map(place).collect()
}

/// Triangles within the bristles' reach, in the tool's frame.
fn triangles(setup: &BrushSetup, brush: &Brush, tool_from_mesh: &Isometry3<f64>) -> Vec<Corners> {
    let mesh = &setup.mesh;
    let mesh_from_tool = tool_from_mesh.inverse();
    (mesh.triangles_about_cylinder(&mesh_from_tool, brush.radius_m, brush.width_m))
        .map(|index| {
            let corners = mesh.triangles()[index].map(|i| Point3::from(mesh.vertices_m()[i]));
            corners.map(|corner| (tool_from_mesh * corner).coords)
        })
        .filter(|corners| is_in_reach(corners, brush.radius_m))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Sides drawn at random that count as even: two nodes give the force of many.
        #[test]
        fn verify_two_nodes_do_for_an_even_side(
            distance_m in 20e-3..60e-3_f64,
            foot_rad in -1.0..1.0_f64,
            from_rad in -0.5..0.5_f64,
            width_rad in 1e-4..0.1_f64,
        ) {
            let reach_m = 60e-3;
            let side = Side {
                from_rad: foot_rad + from_rad,
                to_rad: foot_rad + from_rad + width_rad,
                distance_m,
                foot_rad,
                triangle: 0,
            };
            let law = Bristle::new(25e-3, 3e9 * 3.07e-15, 0.3);
            prop_assume!(is_even(&side, reach_m, &law));
            let force = |angle: f64| law.force_n(reach_m - side.along_bristle_m(angle));
            let many: f64 = (0..2000)
                .map(|k| force(side.from_rad + width_rad * (f64::from(k) + 0.5) / 2000.0))
                .sum();
            let (middle, half) = (side.from_rad + 0.5 * width_rad, 0.5 * width_rad);
            let nodes = RULES.pair().iter();
            let two: f64 = nodes.map(|(x, w)| 0.5 * w * force(middle + half * x)).sum();
            let ratio = two / (many / 2000.0);
            // As near as rows are to many slices; the law is linear between 128 places.
            prop_assert!((ratio - 1.0).abs() < 1e-3, "{ratio}");
        }
    }
}
