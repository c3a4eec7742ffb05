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
use super::profile::Lean;
pub use super::slice::MillingLoads;
use super::slice::Slice;
use nalgebra::Vector2;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Part of a tooth's radius beyond which its chip is not looked for at a face.
const THICKEST: f64 = 0.1;

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
        let pitch_rad = parameters.cutter.pitch_rad();
        // More than is read by half a pitch and the shift along the arc.
        let span = pitch_rad * (parameters.passes as f64 + 0.5) + FRAC_PI_2.max(pitch_rad);
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

    /// Collects walls and floor no longer.
    pub fn drop_finished(&mut self) {
        self.finished = None;
    }

    /// Loads on the tool at a state; changes nothing.
    pub fn evaluate(&self, state: &ToolState) -> MillingLoads {
        let p = &self.parameters;
        let mut loads = MillingLoads::default();
        let engaged_m = p.stock.top_m - state.displacement_m.z;
        if engaged_m <= 0.0 {
            return loads;
        }
        let lag = p.cutter.lag_rad_per_m();
        let slices = self.slices(engaged_m);
        let slice_m = engaged_m / slices as f64;
        let centre = self.centre_m(state);
        for tooth in 0..p.cutter.teeth {
            let tip_rad = p.cutter.tooth_angle_rad(tooth, state.rotation_rad);
            let mut cuts = false;
            for slice in 0..slices {
                let height_m = slice_m * (slice as f64 + 0.5);
                let angle_rad = tip_rad - lag * height_m;
                let chip_m = self.chip_m(tooth, angle_rad, centre, state);
                if chip_m > 0.0 {
                    cuts = true;
                    let slice = Slice {
                        reach_m: p.cutter.tooth_radius_m(tooth),
                        angle_rad,
                        height_m,
                        thick_m: slice_m,
                        chip_m,
                        lean: Lean::UPRIGHT,
                        along_m_per_rad: p.feed_per_revolution_m() / TAU * angle_rad.cos(),
                    };
                    let rate = &state.displacement_m_per_rad;
                    loads.add(&p.cutter, &p.coefficients, &slice, rate);
                }
            }
            loads.teeth_in_cut += usize::from(cuts);
        }
        loads
    }

    /// Whether tip and root of a straight edge's chip lie within the faces of the stock. Where no
    /// face is near the tip the root is taken to be where that is.
    pub fn ends_in_stock(&self, tooth: usize, state: &ToolState) -> [bool; 2] {
        let p = &self.parameters;
        if p.stock.top_m <= state.displacement_m.z {
            return [false; 2];
        }
        let ray = Ray::at(p.cutter.tooth_angle_rad(tooth, state.rotation_rad));
        let centre_m = self.centre_m(state);
        let reach_m = p.cutter.tooth_radius_m(tooth);
        let is_in = |along_m: f64| p.stock.contains(centre_m + ray.outward * along_m);
        let tip = is_in(reach_m);
        if is_in((1.0 - THICKEST) * reach_m) == tip {
            return [tip; 2];
        }
        [tip, is_in(self.surface_m(tooth, &ray, state).min(reach_m))]
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
                ..ToolState::default()
            };
            finished.sweep(&self.parameters, &before, state);
        }
        self.trace.commit(state.rotation_rad, state.displacement_m);
    }

    /// Whether a tooth's tip in the stock has come no further on its way since the last committed
    /// state: its path loops. The tool then vibrates faster than its teeth cut, and the law of
    /// forces knows nothing of edges that move back first.
    pub fn turns_back(&self, state: &ToolState) -> bool {
        let p = &self.parameters;
        let engaged_m = p.stock.top_m - state.displacement_m.z;
        let Some((before_rad, before_m)) = self.trace.last().filter(|_| engaged_m > 0.0) else {
            return false;
        };
        let turned_rad = state.rotation_rad - before_rad;
        let fed_m = p.nominal_x_m(state.rotation_rad) - p.nominal_x_m(before_rad);
        let moved_m = (state.displacement_m - before_m).xy() + Vector2::new(fed_m, 0.0);
        let advance_m = |tooth| 2.0 * p.cutter.tooth_radius_m(tooth) * (0.5 * turned_rad).sin();
        let mut fast_teeth =
            (0..p.cutter.teeth).filter(|tooth| moved_m.norm() >= advance_m(*tooth));
        let slices = self.slices(engaged_m);
        let lag_rad = p.cutter.lag_rad_per_m() * engaged_m / slices as f64;
        fast_teeth.any(|tooth| {
            (0..slices).any(|slice| {
                let tip_rad = p.cutter.tooth_angle_rad(tooth, state.rotation_rad);
                let angle_rad = tip_rad - lag_rad * (slice as f64 + 0.5);
                let (sin, cos) = (angle_rad - 0.5 * turned_rad).sin_cos();
                let on_m = moved_m.dot(&Vector2::new(cos, -sin)) + advance_m(tooth);
                let (sin, cos) = angle_rad.sin_cos();
                let arm_m = p.cutter.tooth_radius_m(tooth) * Vector2::new(sin, cos);
                on_m <= 0.0 && p.stock.contains(self.centre_m(state) + arm_m)
            })
        })
    }

    /// Whether the tool has left the nominal surface, if its teeth meet that, by more than its
    /// radius: rays to its teeth then begin in stock that is not there any more.
    pub fn is_off_the_surface(&self, state: &ToolState) -> bool {
        let p = &self.parameters;
        let off_m = (state.displacement_m - p.steady_displacement_m).xy();
        !p.regeneration && off_m.norm() > p.cutter.radius_m
    }

    /// Half of the way between the extremes of the tool's motion in the memory, m.
    pub fn amplitude_m(&self) -> f64 {
        self.trace.amplitude_m()
    }

    /// Slices into which the edge is cut.
    fn slices(&self, engaged_m: f64) -> usize {
        let p = &self.parameters;
        let lag_rad = p.cutter.lag_rad_per_m().abs() * engaged_m;
        ((lag_rad / p.slice_lag_rad).ceil() as usize).max(1)
    }

    /// The axis on the plane across it, m.
    fn centre_m(&self, state: &ToolState) -> Vector2<f64> {
        let nominal_m = self.parameters.nominal_x_m(state.rotation_rad);
        Vector2::new(nominal_m, 0.0) + state.displacement_m.xy()
    }

    /// Earlier passes that a tooth may meet.
    fn pass_count(&self) -> usize {
        let p = &self.parameters;
        match p.regeneration {
            true => p.passes.max(1),
            false => p.cutter.teeth,
        }
    }

    /// The pass of the m-th tooth before.
    fn earlier_pass(&self, m: usize, state: &ToolState) -> EarlierPass<'_> {
        let p = &self.parameters;
        let pitch_rad = p.cutter.pitch_rad();
        // What a tooth that moves has ahead of now it has not left yet.
        let (axis, ahead_rad) = if p.regeneration {
            (Axis::Moved(&self.trace), pitch_rad)
        } else {
            (Axis::Steady(p.steady_displacement_m.xy()), FRAC_PI_2)
        };
        EarlierPass {
            axis,
            then_rad: state.rotation_rad - pitch_rad * m as f64,
            now_m: state.displacement_m.xy(),
            fed_m: p.feed_per_tooth_m * m as f64,
            feed_m_per_rad: p.feed_per_revolution_m() / TAU,
            reach_rad: (ahead_rad * m as f64).min(FRAC_PI_2),
        }
    }

    /// Chip thickness of a tooth at φ, m. No chip reaches further back than the axis.
    fn chip_m(
        &self,
        tooth: usize,
        angle_rad: f64,
        centre_m: Vector2<f64>,
        state: &ToolState,
    ) -> f64 {
        let p = &self.parameters;
        let ray = Ray::at(angle_rad);
        let reach_m = p.cutter.tooth_radius_m(tooth);
        let tip_m = centre_m + ray.outward * reach_m;
        if p.stock.inside_m(centre_m, tip_m) == 0.0 {
            return 0.0;
        }
        let surface_m = self.surface_m(tooth, &ray, state);
        if surface_m >= reach_m {
            return 0.0;
        }
        // No longer than its ray, by rounding either.
        (p.stock.inside_m(centre_m + ray.outward * surface_m, tip_m)).min(reach_m - surface_m)
    }

    /// How far from the axis the surface begins that earlier teeth have left, m; where it lies
    /// beyond the tooth, at the tooth or further out.
    fn surface_m(&self, tooth: usize, ray: &Ray, state: &ToolState) -> f64 {
        let p = &self.parameters;
        let teeth = p.cutter.teeth;
        let reach_m = p.cutter.tooth_radius_m(tooth);
        let mut surface_m = 0.0_f64;
        for m in 1..=self.pass_count() {
            let pass = self.earlier_pass(m, state);
            let before = (tooth + teeth - m % teeth) % teeth;
            let radius_m = p.cutter.tooth_radius_m(before);
            if pass.at_most_m(radius_m, ray) <= surface_m {
                continue;
            }
            if let Some(left_m) = pass.left_m(radius_m, ray) {
                surface_m = surface_m.max(left_m);
            }
            if surface_m >= reach_m {
                break;
            }
        }
        surface_m
    }
}

#[cfg(test)]
mod exact;
#[cfg(test)]
mod looping;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod time_domain;
