//! Effects on edge, foot and wheel, as numbers that the processes take.

use truecut_scenario::effect::{Effect, EffectKind};

/// Effects on the cut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CuttingEffects {
    /// Times all coefficients per chip area.
    pub coefficient_factor: f64,
    /// Beyond the edge coefficients: axial, radial, tangential, N/m.
    pub edge_n_per_m: [f64; 3],
    /// Offset of the tool from its axis of rotation: towards the first edge, a quarter of a turn ahead, m.
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
    pub(super) fn add(&mut self, effect: &Effect) {
        let v = &effect.values;
        match effect.kind {
            EffectKind::CuttingCoefficient => self.coefficient_factor = v[0],
            EffectKind::CuttingEdgeForce => self.edge_n_per_m = [v[0], v[1], v[2]],
            EffectKind::CuttingRunout => self.runout_m = [v[0], v[1]],
            EffectKind::CuttingHoleOffset => self.hole_offset_m = [v[0], v[1]],
            EffectKind::CuttingWornTooth => self.recess_m = v[0],
            EffectKind::CuttingWear => self.wear_per_m = v[0],
            EffectKind::CuttingDepthOffset => self.depth_offset_m = v[0],
            EffectKind::SpindleSpeed => self.spindle_factor = v[0],
            _ => {}
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
    pub(super) fn add(&mut self, effect: &Effect) {
        let v = &effect.values;
        match effect.kind {
            EffectKind::FootFriction => self.friction_factor = v[0],
            EffectKind::FootFrictionFalling => self.falling = Some((v[0], v[1])),
            EffectKind::FootPressureLoss => self.pressure_loss_per_s = v[0],
            EffectKind::FootSealStiction => self.seal_stiction_n = v[0],
            _ => {}
        }
    }
}

/// Effects on the wheel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WheelEffects {
    pub stiffness_factor: f64,
    /// Runout at the contact when the wheel starts, and a quarter of a turn later, m; of a wheel in precession the place of its
    /// middle when it starts, along the tool's x and y axes.
    pub eccentricity_m: [f64; 2],
    pub friction_factor: f64,
    pub removal_factor: f64,
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
            force_offset_n: 0.0,
            force_stiction_n: 0.0,
        }
    }
}

impl WheelEffects {
    pub(super) fn add(&mut self, effect: &Effect) {
        let v = &effect.values;
        match effect.kind {
            EffectKind::WheelStiffness => self.stiffness_factor = v[0],
            EffectKind::WheelEccentricity => self.eccentricity_m = [v[0], v[1]],
            EffectKind::WheelFriction => self.friction_factor = v[0],
            EffectKind::WheelRemoval => self.removal_factor = v[0],
            EffectKind::WheelForceOffset => self.force_offset_n = v[0],
            EffectKind::WheelForceStiction => self.force_stiction_n = v[0],
            _ => {}
        }
    }
}
