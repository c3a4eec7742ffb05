//! Geometry of an end mill.

use super::MillingError;
use super::flank::Flank;
use std::f64::consts::{PI, TAU};

/// Offset of the cutter's axis from the spindle's: tooth j runs at `r + e cos(φ0 − 2πj/N)`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Runout {
    /// e, m.
    pub offset_m: f64,
    /// φ0, angle of the offset from tooth 0 in the sense of rotation, rad.
    pub angle_rad: f64,
}

/// An end mill with equally spaced teeth: flat, bull-nose or ball.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cutter {
    pub radius_m: f64,
    /// r_c between end and upright part, m: 0 of a flat cutter, its radius of a ball. Straight
    /// cuts, closed forms and limits know flat cutters alone.
    pub corner_radius_m: f64,
    pub teeth: usize,
    /// β between cutting edge and axis, rad; positive if the edge lags behind with height.
    pub helix_angle_rad: f64,
    pub runout: Runout,
    pub flank: Flank,
    /// Whether the ends of its teeth cut, from the axis to the rim.
    pub centre_cutting: bool,
}

impl Cutter {
    /// A sharp cutter without helix and runout, whose ends do not cut.
    pub fn straight(radius_m: f64, teeth: usize) -> Self {
        Self {
            radius_m,
            corner_radius_m: 0.0,
            teeth,
            helix_angle_rad: 0.0,
            runout: Runout::default(),
            flank: Flank::default(),
            centre_cutting: false,
        }
    }

    /// # Errors
    /// If the cutter has no teeth, a radius that is not positive, a corner radius beyond it, a
    /// helix beyond 1.4 rad or more runout than half its radius.
    pub fn check(&self) -> Result<(), MillingError> {
        if self.teeth == 0 {
            return Err(MillingError::NoTeeth);
        }
        let radius_m = self.radius_m;
        if !(radius_m > 0.0 && radius_m.is_finite()) {
            return Err(MillingError::Radius { radius_m });
        }
        let corner_radius_m = self.corner_radius_m;
        if !(0.0..=radius_m).contains(&corner_radius_m) {
            return Err(MillingError::Corner {
                corner_radius_m,
                radius_m,
            });
        }
        let helix_angle_rad = self.helix_angle_rad;
        if !(-1.4..=1.4).contains(&helix_angle_rad) {
            return Err(MillingError::Helix { helix_angle_rad });
        }
        let runout_m = self.runout.offset_m;
        if runout_m.is_nan() || runout_m.abs() >= 0.5 * radius_m {
            return Err(MillingError::Runout { runout_m, radius_m });
        }
        Ok(())
    }

    /// Angle between neighbouring teeth, rad.
    pub fn pitch_rad(&self) -> f64 {
        TAU / self.teeth as f64
    }

    /// Radius on which tooth `tooth` runs, m. Counted against the rotation: tooth 1 follows tooth
    /// 0, and tooth numbers beyond N count on.
    pub fn tooth_radius_m(&self, tooth: usize) -> f64 {
        if self.runout.offset_m == 0.0 {
            return self.radius_m;
        }
        let behind = self.pitch_rad() * (tooth % self.teeth) as f64;
        self.radius_m + self.runout.offset_m * (self.runout.angle_rad + behind).cos()
    }

    /// Angle φ of a tooth's tip when the spindle has turned by `rotation_rad`, not wrapped: tooth 0
    /// stands at φ = 0 when the rotation is 0, tooth j follows by j pitches.
    pub fn tooth_angle_rad(&self, tooth: usize, rotation_rad: f64) -> f64 {
        rotation_rad - self.pitch_rad() * tooth as f64
    }

    /// Lag of the edge per height above the tip, tan β / r, rad/m.
    pub fn lag_rad_per_m(&self) -> f64 {
        self.helix_angle_rad.tan() / self.radius_m
    }

    /// Time between two teeth at a spindle speed in rad/s, s.
    pub fn tooth_period_s(&self, spindle_rad_s: f64) -> f64 {
        self.pitch_rad() / spindle_rad_s
    }
}

/// Spindle speed from the tooth period, rad/s.
pub fn spindle_rad_s(teeth: usize, tooth_period_s: f64) -> f64 {
    2.0 * PI / (teeth as f64 * tooth_period_s)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verify_runout_moves_each_tooth_by_the_projected_offset() {
        let cutter = Cutter {
            runout: Runout {
                offset_m: 1e-5,
                angle_rad: 0.3,
            },
            ..Cutter::straight(8e-3, 4)
        };
        // r_j = r + e cos(φ0 - 2πj/N) with j counted in the sense of rotation; here teeth are
        // counted as they pass.
        for tooth in 0..4 {
            let ahead = -(tooth as f64) * TAU / 4.0;
            let expected = 8e-3 + 1e-5 * (0.3 - ahead).cos();
            assert!((cutter.tooth_radius_m(tooth) - expected).abs() < 1e-18);
        }
        let mean: f64 = (0..4).map(|j| cutter.tooth_radius_m(j)).sum::<f64>() / 4.0;
        assert!((mean - 8e-3).abs() < 1e-17);
        assert_eq!(cutter.tooth_radius_m(1), cutter.tooth_radius_m(5));
    }

    #[test]
    fn impossible_cutters_are_refused() {
        assert_eq!(
            Cutter::straight(5e-3, 0).check(),
            Err(MillingError::NoTeeth)
        );
        assert!(Cutter::straight(-1.0, 2).check().is_err());
        assert!(Cutter::straight(f64::NAN, 2).check().is_err());
        let twisted = Cutter {
            helix_angle_rad: 1.5,
            ..Cutter::straight(5e-3, 2)
        };
        assert!(matches!(twisted.check(), Err(MillingError::Helix { .. })));
        let rounder = Cutter {
            corner_radius_m: 5.1e-3,
            ..Cutter::straight(5e-3, 2)
        };
        assert!(matches!(rounder.check(), Err(MillingError::Corner { .. })));
        assert!(Cutter::straight(5e-3, 2).check().is_ok());
    }
}
