//! Effects on edge, foot and wheel, as numbers that the processes take.

use truecut_core::chatter::AttachedMode;
use truecut_core::wheel::abrasive::Abrasive;
use truecut_core::wheel::eccentricity::Eccentricity;
use truecut_core::wheel::force_control::ForceControl;
use truecut_scenario::MillingSpec;
use truecut_scenario::effect::{CuttingEffect, FootEffect, MillingEffect, WheelEffect};

/// Effects on the cut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CuttingEffects {
    /// Times all coefficients per chip area.
    pub coefficient_factor: f64,
    /// Beyond the edge coefficients: axial, radial, tangential, N/m.
    pub edge_n_per_m: [f64; 3],
    /// Offset of the tool from its axis of rotation: towards the first edge, a quarter of a turn
    /// ahead, m.
    pub runout_m: [f64; 2],
    /// Offset of the hole, process Y and Z, m.
    pub hole_offset_m: [f64; 2],
    /// How far the first edge stands back along the feed, m.
    pub recess_m: f64,
    /// Growth of all forces per path that the edge has cut, 1/m.
    pub wear_per_m: f64,
    /// Additional depth, m.
    pub depth_offset_m: f64,
    /// Times the spindle speed; the feed in time stays.
    pub spindle_factor: f64,
}

impl Default for CuttingEffects {
    fn default() -> Self {
        Self {
            coefficient_factor: 1.0,
            edge_n_per_m: [0.0; 3],
            runout_m: [0.0; 2],
            hole_offset_m: [0.0; 2],
            recess_m: 0.0,
            wear_per_m: 0.0,
            depth_offset_m: 0.0,
            spindle_factor: 1.0,
        }
    }
}

impl CuttingEffects {
    pub(super) fn add(&mut self, effect: CuttingEffect) {
        match effect {
            CuttingEffect::Coefficient { factor } => self.coefficient_factor = factor,
            CuttingEffect::EdgeForce {
                axial_n_per_m,
                radial_n_per_m,
                tangential_n_per_m,
            } => self.edge_n_per_m = [axial_n_per_m, radial_n_per_m, tangential_n_per_m],
            CuttingEffect::Runout { cosine_m, sine_m } => self.runout_m = [cosine_m, sine_m],
            CuttingEffect::HoleOffset { y_m, z_m } => self.hole_offset_m = [y_m, z_m],
            CuttingEffect::WornTooth { recess_m } => self.recess_m = recess_m,
            CuttingEffect::Wear { growth_per_m } => self.wear_per_m = growth_per_m,
            CuttingEffect::DepthOffset { depth_m } => self.depth_offset_m = depth_m,
            CuttingEffect::SpindleSpeed { factor } => self.spindle_factor = factor,
        }
    }

    /// Whether an edge meets another depth than the schedule's.
    pub fn shift_depth(&self) -> bool {
        self.runout_m != [0.0; 2]
            || self.hole_offset_m != [0.0; 2]
            || self.recess_m != 0.0
            || self.depth_offset_m != 0.0
    }
}

/// Effects on an end mill.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MillingEffects {
    /// Beyond the nominal flank, N/m.
    per_slope_n_per_m: f64,
    /// Beside the nominal modes.
    tool_modes: Vec<AttachedMode>,
}

impl MillingEffects {
    pub(super) fn add(&mut self, effect: MillingEffect) {
        match effect {
            MillingEffect::ProcessDamping { per_slope_n_per_m } => {
                self.per_slope_n_per_m = per_slope_n_per_m;
            }
            MillingEffect::ToolMode {
                compliance_m_per_n,
                frequency_hz,
                damping_ratio,
            } => {
                let along = |direction: [f64; 3]| {
                    let stiffness_n_per_m = 1.0 / compliance_m_per_n;
                    AttachedMode::new(frequency_hz, damping_ratio, stiffness_n_per_m, direction)
                };
                self.tool_modes = vec![along([1.0, 0.0, 0.0]), along([0.0, 1.0, 0.0])];
            }
        }
    }

    /// The pass as it is.
    pub fn on(&self, nominal: &MillingSpec) -> MillingSpec {
        let mut spec = nominal.clone();
        spec.cut.cutter.flank.per_slope_n_per_m += self.per_slope_n_per_m;
        spec.attached.tool.extend(&self.tool_modes);
        spec
    }
}

/// Effects on the foot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FootEffects {
    pub friction_factor: f64,
    /// Part of the friction lost at high speed, and the speed over which it falls, m/s.
    pub falling: Option<(f64, f64)>,
    /// Part of the pressure lost per second, 1/s.
    pub pressure_loss_per_s: f64,
    /// Beyond the nominal seal stiction, N.
    pub seal_stiction_n: f64,
}

impl Default for FootEffects {
    fn default() -> Self {
        Self {
            friction_factor: 1.0,
            falling: None,
            pressure_loss_per_s: 0.0,
            seal_stiction_n: 0.0,
        }
    }
}

impl FootEffects {
    pub(super) fn add(&mut self, effect: FootEffect) {
        match effect {
            FootEffect::Friction { factor } => self.friction_factor = factor,
            FootEffect::FrictionFalling {
                drop,
                speed_m_per_s,
            } => self.falling = Some((drop, speed_m_per_s)),
            FootEffect::PressureLoss { rate_per_s } => self.pressure_loss_per_s = rate_per_s,
            FootEffect::SealStiction { force_n } => self.seal_stiction_n = force_n,
        }
    }
}

/// Effects on the wheel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WheelEffects {
    pub stiffness_factor: f64,
    /// Eccentricity at the contact when the wheel starts, and a quarter of a turn later, m; of a
    /// wheel in precession the place of its middle when it starts, along the tool's x and y axes.
    pub eccentricity_m: [f64; 2],
    pub friction_factor: f64,
    pub removal_factor: f64,
    /// Mean force of jammed grains per normal force of an edge that is run over inward.
    pub jamming_share: f64,
    /// Beyond the force that the control is told to hold, N.
    pub force_offset_n: f64,
    /// Dry friction of the control's carrier, N.
    pub force_stiction_n: f64,
}

impl Default for WheelEffects {
    fn default() -> Self {
        Self {
            stiffness_factor: 1.0,
            eccentricity_m: [0.0; 2],
            friction_factor: 1.0,
            removal_factor: 1.0,
            jamming_share: 0.0,
            force_offset_n: 0.0,
            force_stiction_n: 0.0,
        }
    }
}

impl WheelEffects {
    /// The abrasive as it is.
    pub fn on_abrasive(&self, nominal: Abrasive) -> Abrasive {
        Abrasive {
            mu: nominal.mu * self.friction_factor,
            preston_per_pa: nominal.preston_per_pa * self.removal_factor,
            ..nominal
        }
    }

    /// The eccentricity of a wheel that turns about an axis along its face.
    pub fn eccentricity(&self) -> Eccentricity {
        let [at_start_m, quarter_later_m] = self.eccentricity_m;
        Eccentricity {
            at_start_m,
            quarter_later_m,
        }
    }

    /// The force control as it is.
    pub fn on_control(&self, nominal: ForceControl) -> ForceControl {
        nominal.disturbed(self.force_offset_n, self.force_stiction_n)
    }

    pub(super) fn add(&mut self, effect: WheelEffect) {
        match effect {
            WheelEffect::Stiffness { factor } => self.stiffness_factor = factor,
            WheelEffect::Eccentricity { cosine_m, sine_m } => {
                self.eccentricity_m = [cosine_m, sine_m];
            }
            WheelEffect::Friction { factor } => self.friction_factor = factor,
            WheelEffect::Removal { factor } => self.removal_factor = factor,
            WheelEffect::EdgeGrains { share } => self.jamming_share = share,
            WheelEffect::ForceOffset { force_n } => self.force_offset_n = force_n,
            WheelEffect::ForceStiction { force_n } => self.force_stiction_n = force_n,
        }
    }
}
