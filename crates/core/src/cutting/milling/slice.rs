//! The force of a thin piece of an edge on the tool.

use super::cutter::Cutter;
use super::profile::Lean;
use super::sweep::on_tool_n;
use crate::cutting::chamfer::{CuttingCoefficients, EdgeForces};
use nalgebra::Vector3;

/// What the cut does to the tool.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MillingLoads {
    /// In the frame of the cut: z against the tool, angles from y towards x; N.
    pub force_on_tool_n: Vector3<f64>,
    /// About the tool point, same frame, N m; its z part brakes the spindle.
    pub moment_on_tool_n_m: Vector3<f64>,
    /// Sum over all teeth of chip thickness times height, m².
    pub chip_area_m2: f64,
    /// Volume that teeth take off while the spindle turns, m³/rad.
    pub removal_m3_per_rad: f64,
    /// Largest chip thickness of any slice, m.
    pub thickest_chip_m: f64,
    /// Teeth that cut anywhere along their edge.
    pub teeth_in_cut: usize,
}

/// A piece of a tooth's edge, thin enough to have one angle.
pub(super) struct Slice {
    /// Radius on which the tooth runs.
    pub reach_m: f64,
    pub angle_rad: f64,
    /// Above the tip.
    pub height_m: f64,
    pub thick_m: f64,
    /// Across the axis.
    pub chip_m: f64,
    /// How the edge stands to the axis.
    pub lean: Lean,
    /// Way of the axis along the tooth's motion, m/rad.
    pub along_m_per_rad: f64,
}

impl Slice {
    /// Of the chip, along the tooth's way; it is thinner along the normal by sin κ than across the
    /// axis, and as much wider.
    fn area_m2(&self) -> f64 {
        self.chip_m * self.thick_m
    }

    /// Forces against the tooth's motion, inwards and along the axis, N.
    fn sizes_n(&self, cutter: &Cutter, coefficients: &CuttingCoefficients) -> [f64; 3] {
        let turned = |sizes: &EdgeForces, lean: Lean| {
            [
                sizes.tangential_n,
                sizes.radial_n * lean.sin - sizes.axial_n * lean.cos,
                sizes.radial_n * lean.cos + sizes.axial_n * lean.sin,
            ]
        };
        let length_m = self.thick_m / self.lean.sin;
        if self.lean == Lean::UPRIGHT {
            return turned(&coefficients.forces_n(self.area_m2(), length_m), self.lean);
        }
        let chip = coefficients.forces_n(self.area_m2(), 0.0);
        let edge = coefficients.edge_forces_n(length_m);
        let chip = turned(&chip, self.chip_lean(cutter.corner_radius_m));
        let edge = turned(&edge, self.lean);
        std::array::from_fn(|k| chip[k] + edge[k])
    }

    /// How the edge stands whose normal runs through the middle of the chip. The chip is measured
    /// across the axis, inwards from the edge, where normals of lower pieces run: by half of its
    /// length over the corner's radius.
    fn chip_lean(&self, corner_radius_m: f64) -> Lean {
        let beside_m = (corner_radius_m * self.lean.sin - 0.5 * self.chip_m).max(0.0);
        let below_m = corner_radius_m * self.lean.cos;
        let off_m = beside_m.hypot(below_m);
        Lean {
            sin: beside_m / off_m,
            cos: below_m / off_m,
        }
    }
}

impl MillingLoads {
    /// Adds a slice of the edge of a tool that moves by `rate_m_per_rad`.
    pub(super) fn add(
        &mut self,
        cutter: &Cutter,
        coefficients: &CuttingCoefficients,
        slice: &Slice,
        rate_m_per_rad: &Vector3<f64>,
    ) {
        let area = slice.area_m2();
        let upright = slice.lean.sin;
        let [tangential_n, inward_n, along_axis_n] = slice.sizes_n(cutter, coefficients);
        let mut force = on_tool_n(slice.angle_rad, tangential_n, inward_n, along_axis_n);
        let (sin, cos) = slice.angle_rad.sin_cos();
        let reach = slice.reach_m;
        if !cutter.flank.is_sharp() {
            let slope = (rate_m_per_rad.x * sin + rate_m_per_rad.y * cos) / reach;
            let flank = cutter.flank.per_outward_slope();
            let sizes = flank.forces_n(slope.max(0.0) * slice.thick_m, 0.0);
            force += on_tool_n(slice.angle_rad, sizes.tangential_n, sizes.radial_n, 0.0);
        }
        let arm = Vector3::new(reach * sin, reach * cos, slice.height_m);
        self.force_on_tool_n += force;
        self.moment_on_tool_n_m += arm.cross(&force);
        self.chip_area_m2 += area;
        self.removal_m3_per_rad += area * (reach - 0.5 * slice.chip_m + slice.along_m_per_rad);
        self.thickest_chip_m = self.thickest_chip_m.max(slice.chip_m * upright);
    }

    /// Adds a piece of the end of a tooth: on a radius, with a length along it, m. The coefficients
    /// are those of an edge across the spindle.
    pub(super) fn add_end(
        &mut self,
        coefficients: &CuttingCoefficients,
        angle_rad: f64,
        [radius_m, length_m]: [f64; 2],
        chip_m: f64,
    ) {
        let area = chip_m * length_m;
        let sizes = coefficients.forces_n(area, length_m);
        let force = on_tool_n(angle_rad, sizes.tangential_n, sizes.radial_n, sizes.axial_n);
        let (sin, cos) = angle_rad.sin_cos();
        let arm = Vector3::new(radius_m * sin, radius_m * cos, 0.0);
        self.force_on_tool_n += force;
        self.moment_on_tool_n_m += arm.cross(&force);
        self.chip_area_m2 += area;
        self.removal_m3_per_rad += area * radius_m;
        self.thickest_chip_m = self.thickest_chip_m.max(chip_m);
    }
}
