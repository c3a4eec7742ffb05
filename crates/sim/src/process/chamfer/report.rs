//! What a chamfering pass reports: channels, the finished chamfer, its figures.

use super::{Chamfer, SlipTheory};
use std::f64::consts::TAU;
use truecut_core::cutting::rim::Rim;
use truecut_core::roughness;
use truecut_recording::{ChannelSpec, Profile, Scalar, Unit};

/// Channels of the cut and of the dynamometer under the workpiece.
pub(super) fn channels() -> Vec<ChannelSpec> {
    let newton = |name: &str, text: &str| ChannelSpec::new(name, Unit::Newton, text);
    vec![
        newton("cutting.force_x", "Cutting force on the tool, process X"),
        newton("cutting.force_y", "Cutting force on the tool, process Y"),
        newton("cutting.force_z", "Cutting force on the tool, process Z"),
        ChannelSpec::new(
            "cutting.depth",
            Unit::Metre,
            "Depth already cut by the feed, D(t)",
        ),
        ChannelSpec::new(
            "cutting.engaged_depth",
            Unit::Metre,
            "Depth of the first edge, vibration included",
        ),
        ChannelSpec::new(
            "cutting.chip_area",
            Unit::SquareMetre,
            "Chip area of all edges",
        ),
        ChannelSpec::new(
            "cutting.edge_angle",
            Unit::Radian,
            "Angle of the first edge, from process Y towards Z",
        ),
        ChannelSpec::new(
            "cutting.torque",
            Unit::NewtonMetre,
            "Torque of all edges about the spindle, at the rim of the hole",
        ),
        newton(
            "dynamometer.force_x",
            "Axial force on the workpiece: cutting and foot",
        ),
        newton(
            "dynamometer.force_y",
            "Force on the workpiece, process Y: cutting and foot friction",
        ),
        newton(
            "dynamometer.force_z",
            "Force on the workpiece, process Z: cutting and foot friction",
        ),
    ]
}

impl Chamfer {
    /// Volume of the chamfer: at each angle a triangle of legs `d` and `d tanθ` that is swept along the rim
    /// at the radius of its centroid, m³.
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
        let metre =
            |name: &str, value: f64, text: &str| Scalar::new(name, Unit::Metre, value, text);
        let values = &width.values;
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let to_normal = self.parameters.cut.chip.cos();
        let slip_depth = self
            .first_slip_s
            .map_or(f64::NAN, |t| self.parameters.cut.schedule.depth_cut_m(t));
        let mut scalars = vec![
            metre(
                "chamfer.width_mean",
                mean,
                "Mean radial width of the chamfer",
            ),
            metre("chamfer.width_min", low, "Smallest width around the rim"),
            metre(
                "chamfer.width_max",
                low + roughness::spread(values),
                "Largest width around the rim",
            ),
            metre(
                "chamfer.width_spread",
                roughness::spread(values),
                "Largest minus smallest width around the rim",
            ),
            metre(
                "chamfer.vibration_roughness",
                roughness::arithmetic_mean_deviation(values) * to_normal,
                "Ra that vibration leaves: mean deviation of the surface, along its normal, around the rim",
            ),
        ];
        scalars.push(Scalar::new(
            "chamfer.removed_volume",
            Unit::CubicMetre,
            self.removed_volume_m3(surface),
            "Volume of the finished chamfer",
        ));
        if self.foot.is_some() {
            scalars.push(metre(
                "chamfer.first_slip_depth",
                slip_depth,
                "Depth already cut when the foot first slipped for 3 ms or more",
            ));
        }
        scalars.extend(self.theory.iter().flat_map(theory_scalars));
        scalars
    }
}

fn theory_scalars(theory: &SlipTheory) -> Vec<Scalar> {
    let pascal = |name: &str, value: f64, text: &str| Scalar::new(name, Unit::Pascal, value, text);
    vec![
        pascal(
            "theory.paper_threshold_pressure",
            theory.paper_threshold_pa,
            "Foot pressure that source A's eq. (27) asks for at the last tooth (backward feed only; 0: none needed)",
        ),
        pascal(
            "theory.exact_threshold_pressure",
            theory.exact_threshold_pa,
            "Foot pressure at which friction balances the rotating force at the last tooth, in the plane; no regeneration",
        ),
        pascal(
            "theory.general_threshold_pressure",
            theory.general_threshold_pa,
            "The same with the lateral force that the arm's axial load puts on the foot; no regeneration",
        ),
        Scalar::new(
            "theory.slip_depth",
            Unit::Metre,
            theory.slip_depth_m,
            "Depth already cut at which the general condition is first broken; no regeneration",
        ),
        Scalar::new(
            "theory.axial_share",
            Unit::One,
            theory.axial_share,
            "Share of the axial force that the foot carries while its seals hold",
        ),
        Scalar::new(
            "theory.lateral_per_axial",
            Unit::One,
            theory.lateral_per_axial,
            "Lateral force on a held foot per newton of axial force in the arm",
        ),
    ]
}
