//! Forces of a tool that vibrates against the surface that earlier teeth left.
//!
//! The tooth's tip runs on a circle about the displaced axis. Along the ray from the axis through
//! the tip, the material begins where the outermost of the remembered arcs ends: regeneration,
//! teeth that leave the cut and the several older surfaces that the next one then meets all follow
//! from that one rule. The chip is the part of the ray between that point and the tip which lies in
//! the stock; it is measured on true arcs, not on their linearisation.
//!
//! The edge is engaged from the tip up to the stock's upper face. A tool that sinks is engaged
//! deeper at once (the floor ahead is still whole), which is the depth feedback of mode coupling.
//! What the end teeth cut while the tool sinks, on its flat end, is not part of the model.

use super::dexel::FinishedSurface;
use super::earlier::{Axis, EarlierPass, Ray};
use super::memory::Trace;
pub use super::parameters::{MillingParameters, ToolState};
use super::sweep::on_tool_n;
use nalgebra::{Vector2, Vector3};
use std::f64::consts::{FRAC_PI_2, TAU};

/// What the cut does to the tool.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MillingLoads {
    /// Milling frame, N.
    pub force_on_tool_n: Vector3<f64>,
    /// About the tool point, milling frame, N m; its z part brakes the spindle.
    pub moment_on_tool_n_m: Vector3<f64>,
    /// Sum over all teeth of chip thickness times height, m².
    pub chip_area_m2: f64,
    /// Largest chip thickness of any slice, m.
    pub thickest_chip_m: f64,
    /// Teeth that cut anywhere along their edge.
    pub teeth_in_cut: usize,
}

/// A milling pass: parameters, and the memory of what has been cut.
#[derive(Debug, Clone, PartialEq)]
pub struct MillingCut {
    parameters: MillingParameters,
    trace: Trace,
    finished: Option<FinishedSurface>,
}

impl MillingCut {
    /// A pass before which the tool ran steadily displaced. `finished` collects walls and floor, if
    /// wanted.
    pub fn new(parameters: MillingParameters, finished: Option<FinishedSurface>) -> Self {
        // A pass and a half more than is read, for the shift along the arc.
        let span = parameters.cutter.pitch_rad() * (parameters.passes as f64 + 1.5);
        Self {
            parameters,
            trace: Trace::new(span, parameters.steady_displacement_m),
            finished,
        }
    }

    pub fn parameters(&self) -> &MillingParameters {
        &self.parameters
    }

    /// The walls and floor so far.
    pub fn finished(&self) -> Option<&FinishedSurface> {
        self.finished.as_ref()
    }

    /// Loads on the tool at a state; changes nothing.
    pub fn evaluate(&self, state: &ToolState) -> MillingLoads {
        let p = &self.parameters;
        let mut loads = MillingLoads {
            force_on_tool_n: Vector3::zeros(),
            moment_on_tool_n_m: Vector3::zeros(),
            chip_area_m2: 0.0,
            thickest_chip_m: 0.0,
            teeth_in_cut: 0,
        };
        let engaged_m = p.stock.top_m - state.displacement_m.z;
        if engaged_m <= 0.0 {
            return loads;
        }
        let lag = p.cutter.lag_rad_per_m();
        let slices = ((lag.abs() * engaged_m / p.slice_lag_rad).ceil() as usize).max(1);
        let slice_m = engaged_m / slices as f64;
        let passes = self.earlier_passes(state);
        let centre = Vector2::new(
            p.nominal_x_m(state.rotation_rad) + state.displacement_m.x,
            state.displacement_m.y,
        );
        for tooth in 0..p.cutter.teeth {
            let tip_rad = p.cutter.tooth_angle_rad(tooth, state.rotation_rad);
            let mut cuts = false;
            for slice in 0..slices {
                let height_m = slice_m * (slice as f64 + 0.5);
                let angle_rad = tip_rad - lag * height_m;
                let chip_m = self.chip_m(tooth, angle_rad, centre, &passes);
                if chip_m > 0.0 {
                    cuts = true;
                    self.add_slice(&mut loads, tooth, angle_rad, height_m, slice_m, chip_m);
                }
            }
            loads.teeth_in_cut += usize::from(cuts);
        }
        loads
    }

    /// The tool has come to this state: its teeth leave their surface. To be called once a step,
    /// with rising rotation.
    pub fn commit(&mut self, state: &ToolState) {
        if let (Some(finished), Some((rotation_rad, displacement_m))) =
            (&mut self.finished, self.trace.last())
        {
            let before = ToolState {
                rotation_rad,
                displacement_m,
            };
            finished.sweep(&self.parameters, &before, state);
        }
        self.trace.commit(state.rotation_rad, state.displacement_m);
    }

    fn earlier_passes(&self, state: &ToolState) -> Vec<EarlierPass<'_>> {
        let p = &self.parameters;
        let (count, axis) = if p.regeneration {
            (p.passes.max(1), Axis::Moved(&self.trace))
        } else {
            let steady_m = p.steady_displacement_m.xy();
            (p.cutter.teeth, Axis::Steady(steady_m))
        };
        let pitch_rad = p.cutter.pitch_rad();
        let none = Vector2::zeros();
        let pass = |m: usize| {
            let pass = EarlierPass {
                axis,
                then_rad: state.rotation_rad - pitch_rad * m as f64,
                now_m: state.displacement_m.xy(),
                fed_m: p.feed_per_tooth_m * m as f64,
                feed_m_per_rad: p.feed_per_revolution_m() / TAU,
                reach_rad: pitch_rad.min(FRAC_PI_2),
                unshifted: (none, none),
            };
            pass.placed()
        };
        (1..=count).map(pass).collect()
    }

    /// Chip thickness of a tooth at φ, m. No chip reaches further back than the axis.
    fn chip_m(
        &self,
        tooth: usize,
        angle_rad: f64,
        centre_m: Vector2<f64>,
        passes: &[EarlierPass<'_>],
    ) -> f64 {
        let p = &self.parameters;
        let teeth = p.cutter.teeth;
        let (sin, cos) = angle_rad.sin_cos();
        let ray = Ray {
            outward: Vector2::new(sin, cos),
            along: Vector2::new(cos, -sin),
        };
        let reach_m = p.cutter.tooth_radius_m(tooth);
        let tip_m = centre_m + ray.outward * reach_m;
        if p.stock.inside_m(centre_m, tip_m) == 0.0 {
            return 0.0;
        }
        let mut surface_m = 0.0_f64;
        for (i, pass) in passes.iter().enumerate() {
            let before = (tooth + teeth - (i + 1) % teeth) % teeth;
            let radius_m = p.cutter.tooth_radius_m(before);
            if let Some(left_m) = pass.left_m(radius_m, &ray) {
                surface_m = surface_m.max(left_m);
            }
            if surface_m >= reach_m {
                return 0.0;
            }
        }
        p.stock.inside_m(centre_m + ray.outward * surface_m, tip_m)
    }

    fn add_slice(
        &self,
        loads: &mut MillingLoads,
        tooth: usize,
        angle_rad: f64,
        height_m: f64,
        slice_m: f64,
        chip_m: f64,
    ) {
        let area = chip_m * slice_m;
        let k = &self.parameters.coefficients;
        let sizes = k.forces_n(area, slice_m);
        let force = on_tool_n(angle_rad, sizes.tangential_n, sizes.radial_n, sizes.axial_n);
        let (sin, cos) = angle_rad.sin_cos();
        let reach = self.parameters.cutter.tooth_radius_m(tooth);
        let arm = Vector3::new(reach * sin, reach * cos, height_m);
        loads.force_on_tool_n += force;
        loads.moment_on_tool_n_m += arm.cross(&force);
        loads.chip_area_m2 += area;
        loads.thickest_chip_m = loads.thickest_chip_m.max(chip_m);
    }
}

#[cfg(test)]
mod exact;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod time_domain;
