//! What a chamfering pass reports: the cut of each step, the finished chamfer, its figures.

use super::{Chamfer, SlipTheory};
use crate::process::Foot;
use crate::process::quantity::{self, Quantity};
use nalgebra::Vector3;
use std::f64::consts::TAU;
use truecut_core::cutting::rim::Rim;
use truecut_core::roughness;
use truecut_recording::{Profile, Scalar, Unit};

impl Chamfer {
    /// What is recorded of the step last committed: the cut, the dynamometer under the workpiece,
    /// the foot if there is one.
    pub(super) fn quantities(&self) -> impl Iterator<Item = Quantity> {
        let (last, cutting) = (&self.last, self.last.force_on_tool_n);
        let foot = self.foot.as_ref();
        let dynamometer = foot.map_or_else(Vector3::zeros, Foot::force_on_workpiece_n) - cutting;
        let angle_rad = last.edge_angle_rad.rem_euclid(TAU);
        let cut = [
            Quantity::new("cutting.force_x", Unit::Newton, cutting.x)
                .text("Cutting force on the tool, process X"),
            Quantity::new("cutting.force_y", Unit::Newton, cutting.y)
                .text("Cutting force on the tool, process Y"),
            Quantity::new("cutting.force_z", Unit::Newton, cutting.z)
                .text("Cutting force on the tool, process Z"),
            Quantity::new("cutting.depth", Unit::Metre, last.depth_m)
                .text("Depth already cut by the feed, D(t)"),
            Quantity::new("cutting.engaged_depth", Unit::Metre, last.engaged_depth_m)
                .text("Depth of the first edge, vibration included"),
            Quantity::new("cutting.chip_area", Unit::SquareMetre, last.chip_area_m2)
                .text("Chip area of all edges"),
            Quantity::new("cutting.edge_angle", Unit::Radian, angle_rad)
                .text("Angle of the first edge, from process Y towards Z"),
            Quantity::new("cutting.torque", Unit::NewtonMetre, last.torque_n_m)
                .text("Torque of all edges about the spindle, at the rim of the hole"),
            Quantity::new("dynamometer.force_x", Unit::Newton, dynamometer.x)
                .text("Axial force on the workpiece: cutting and foot"),
            Quantity::new("dynamometer.force_y", Unit::Newton, dynamometer.y)
                .text("Force on the workpiece, process Y: cutting and foot friction"),
            Quantity::new("dynamometer.force_z", Unit::Newton, dynamometer.z)
                .text("Force on the workpiece, process Z: cutting and foot friction"),
        ];
        cut.into_iter()
            .chain(foot.into_iter().flat_map(Foot::quantities))
    }

    /// Volume of the chamfer: at each angle a triangle of legs `d` and `d tanθ` that is swept along
    /// the rim at the radius of its centroid, m³.
    fn removed_volume_m3(&self, surface: &Rim) -> f64 {
        let p = &self.parameters;
        let tan = p.cut.chip.tan();
        let step = TAU / surface.bins() as f64;
        (surface.depths_m().iter())
            .map(|d| 0.5 * d * d * tan * (p.cut.hole_radius_m + d * tan / 3.0) * step)
            .sum()
    }

    pub(super) fn width_profile(&self, surface: &Rim) -> Profile {
        let tan = self.parameters.cut.chip.tan();
        Profile {
            name: "chamfer.width".into(),
            description: "Radial width of the finished chamfer around the rim".into(),
            axis_name: "rim_angle".into(),
            axis_unit: Unit::Radian,
            axis: (0..surface.bins()).map(|i| surface.angle_rad(i)).collect(),
            unit: Unit::Metre,
            values: surface.depths_m().iter().map(|d| d * tan).collect(),
        }
    }

    pub(super) fn scalars(&self, surface: &Rim, width: &Profile) -> Vec<Scalar> {
        let metre = |name, value| Quantity::new(name, Unit::Metre, value);
        let values = &width.values;
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let spread = roughness::spread(values);
        let deviation =
            roughness::arithmetic_mean_deviation(values) * self.parameters.cut.chip.cos();
        let mut quantities = vec![
            metre("chamfer.width_mean", mean).text("Mean radial width of the chamfer"),
            metre("chamfer.width_min", low).text("Smallest width around the rim"),
            metre("chamfer.width_max", low + spread).text("Largest width around the rim"),
            metre("chamfer.width_spread", spread)
                .text("Largest minus smallest width around the rim"),
            metre("chamfer.vibration_roughness", deviation)
                .text("Ra that vibration leaves: mean deviation of the surface, along its normal, around the rim"),
            Quantity::new("chamfer.removed_volume", Unit::CubicMetre, self.removed_volume_m3(surface))
                .text("Volume of the finished chamfer"),
        ];
        if self.foot.is_some() {
            let slip_depth = (self.first_slip_s)
                .map_or(f64::NAN, |t| self.parameters.cut.schedule.depth_cut_m(t));
            quantities.push(
                metre("chamfer.first_slip_depth", slip_depth)
                    .text("Depth already cut when the foot first slipped for 3 ms or more"),
            );
        }
        quantities.extend(self.theory.iter().flat_map(predictions));
        quantity::scalars(quantities)
    }
}

fn predictions(t: &SlipTheory) -> [Quantity; 6] {
    let pascal = |name, value| Quantity::new(name, Unit::Pascal, value);
    [
        pascal("theory.paper_threshold_pressure", t.paper_threshold_pa)
            .text("Foot pressure that eq. (27) of Dong et al. 2018 asks for at the last tooth (backward feed only; 0: none needed)"),
        pascal("theory.exact_threshold_pressure", t.exact_threshold_pa)
            .text("Foot pressure at which friction balances the rotating force at the last tooth, in the plane; no regeneration"),
        pascal("theory.general_threshold_pressure", t.general_threshold_pa)
            .text("The same with the lateral force that the arm's axial load puts on the foot; no regeneration"),
        Quantity::new("theory.slip_depth", Unit::Metre, t.slip_depth_m)
            .text("Depth already cut at which the general condition is first broken; no regeneration"),
        Quantity::new("theory.axial_share", Unit::One, t.axial_share)
            .text("Share of the axial force that the foot carries while its seals hold"),
        Quantity::new("theory.lateral_per_axial", Unit::One, t.lateral_per_axial)
            .text("Lateral force on a held foot per newton of axial force in the arm"),
    ]
}
