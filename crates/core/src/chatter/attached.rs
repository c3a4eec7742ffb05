//! Modes of what the arm holds, and of what it cuts.

use std::f64::consts::TAU;

use nalgebra::{Matrix3, Vector3};

use super::TipMode;

/// A mass `m = k/ω²` on a spring k and a damper `2ζωm` that moves along a direction
/// (`docs/physics/tool_modes.md`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AttachedMode {
    /// ω, undamped, with the foot of the spring held, rad/s.
    pub natural_frequency_rad_s: f64,
    /// ζ, below 1.
    pub damping_ratio: f64,
    /// k, as the force at the tip meets it.
    pub stiffness_n_per_m: f64,
    /// Of length 1, in the axes of the list that the mode stands in.
    pub direction: Vector3<f64>,
}

impl AttachedMode {
    /// Of a natural frequency (Hz), a damping ratio, a stiffness (N/m) and a direction of any
    /// length but zero.
    pub fn new(
        frequency_hz: f64,
        damping_ratio: f64,
        stiffness_n_per_m: f64,
        direction: [f64; 3],
    ) -> Self {
        Self {
            natural_frequency_rad_s: TAU * frequency_hz,
            damping_ratio,
            stiffness_n_per_m,
            direction: Vector3::from(direction).normalize(),
        }
    }

    /// m = k/ω².
    pub fn mass_kg(&self) -> f64 {
        self.stiffness_n_per_m / self.natural_frequency_rad_s.powi(2)
    }

    /// 2ζωm = 2ζk/ω, N s/m.
    pub fn damping_n_s_per_m(&self) -> f64 {
        2.0 * self.damping_ratio * self.stiffness_n_per_m / self.natural_frequency_rad_s
    }

    /// The same mode in other axes.
    #[must_use]
    pub fn turned(&self, axes: &Matrix3<f64>) -> Self {
        Self {
            direction: axes * self.direction,
            ..*self
        }
    }

    /// What the mode alone, its foot held, adds to the compliance at the tip, m/N.
    pub fn compliance_m_per_n(&self) -> Matrix3<f64> {
        self.direction * self.direction.transpose() / self.stiffness_n_per_m
    }

    /// The mode as the tip feels it with the foot of its spring held.
    pub fn held(&self) -> TipMode {
        TipMode::of_stiffness(
            self.natural_frequency_rad_s,
            self.damping_ratio,
            self.stiffness_n_per_m,
            &self.direction,
        )
    }
}

/// A tool mode whose bearings know how fast the spindle turns.
#[derive(Debug, Clone, PartialEq)]
pub struct SpeedTable {
    /// Which of the tool's modes.
    pub tool: usize,
    /// The mode at spindle speeds in rad/s, rising; the first is standstill.
    pub rows: Vec<(f64, AttachedMode)>,
}

impl SpeedTable {
    /// The mode at a speed: ω, ζ and k linear between the rows, the last row's beyond it.
    fn at(&self, spindle_rad_s: f64) -> Option<AttachedMode> {
        let above = self
            .rows
            .partition_point(|(speed, _)| *speed <= spindle_rad_s);
        let (slow, before) = self.rows.get(above.checked_sub(1)?)?;
        let Some((fast, after)) = self.rows.get(above) else {
            return Some(*before);
        };
        let share = (spindle_rad_s - slow) / (fast - slow);
        let mix = |a: f64, b: f64| a + (b - a) * share;
        Some(AttachedMode {
            natural_frequency_rad_s: mix(
                before.natural_frequency_rad_s,
                after.natural_frequency_rad_s,
            ),
            damping_ratio: mix(before.damping_ratio, after.damping_ratio),
            stiffness_n_per_m: mix(before.stiffness_n_per_m, after.stiffness_n_per_m),
            direction: before.direction,
        })
    }
}

/// The modes beside the arm's own in a cut.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct AttachedModes {
    /// Of tool, holder and spindle; the arm's tool frame is their foot, and gives their axes. Their
    /// masses are part of the arm's.
    pub tool: Vec<AttachedMode>,
    /// Of the workpiece, on the ground; world axes.
    pub workpiece: Vec<AttachedMode>,
    /// Of tool modes that change with the spindle's speed; `tool` has them at one speed.
    pub over_speed: Vec<SpeedTable>,
}

impl AttachedModes {
    /// Undamped frequency of the fastest mode, Hz; `None` without modes.
    #[must_use]
    pub fn fastest_hz(&self) -> Option<f64> {
        let modes = self.tool.iter().chain(&self.workpiece);
        let hz = modes.map(|mode| mode.natural_frequency_rad_s / std::f64::consts::TAU);
        hz.max_by(f64::total_cmp)
    }

    /// The modes at a spindle speed, rad/s.
    #[must_use]
    pub fn at(&self, spindle_rad_s: f64) -> Self {
        let mut modes = self.clone();
        for table in &self.over_speed {
            if let (Some(mode), Some(at)) =
                (modes.tool.get_mut(table.tool), table.at(spindle_rad_s))
            {
                *mode = at;
            }
        }
        modes
    }

    /// Speed at which the first of the tables ends, rad/s.
    pub fn known_to_rad_s(&self) -> Option<f64> {
        let ends = (self.over_speed.iter()).filter_map(|table| table.rows.last());
        ends.map(|(speed, _)| *speed).min_by(f64::total_cmp)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.tool.is_empty() && self.workpiece.is_empty()
    }

    /// All of them in world axes, the tool's first.
    pub fn in_world<'a>(
        &'a self,
        world_from_tool: &'a Matrix3<f64>,
    ) -> impl Iterator<Item = AttachedMode> + 'a {
        let tool = self.tool.iter().map(|mode| mode.turned(world_from_tool));
        tool.chain(self.workpiece.iter().copied())
    }

    /// What they add to the compliance between tool and workpiece, world axes, m/N.
    pub fn compliance_m_per_n(&self, world_from_tool: &Matrix3<f64>) -> Matrix3<f64> {
        let modes = self.in_world(world_from_tool);
        modes.fold(Matrix3::zeros(), |sum, mode| {
            sum + mode.compliance_m_per_n()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verify_mass_and_damper_of_a_mode() {
        // 10 N/µm at 1 kHz: 0.2533 kg.
        let mode = AttachedMode::new(1e3, 0.03, 1e7, [2.0, 0.0, 0.0]);
        assert!((mode.mass_kg() - 0.253_302_959).abs() < 1e-9);
        let critical = 2.0 * (mode.stiffness_n_per_m * mode.mass_kg()).sqrt();
        assert!((mode.damping_n_s_per_m() / critical - 0.03).abs() < 1e-12);
        let turn = nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), 0.5);
        let both = AttachedModes {
            tool: vec![mode],
            workpiece: vec![mode],
            ..AttachedModes::default()
        };
        let sum = both.compliance_m_per_n(turn.matrix());
        let (c, s) = (0.5_f64.cos(), 0.5_f64.sin());
        assert!((sum[(0, 0)] * 1e7 - (1.0 + c * c)).abs() < 1e-12);
        assert!((sum[(0, 1)] * 1e7 - c * s).abs() < 1e-12);
    }

    #[test]
    fn a_mode_follows_the_spindle_between_its_rows() {
        let rows = [
            (0.0, 1000.0, 0.03, 1e7),
            (600.0, 900.0, 0.04, 8e6),
            (1000.0, 700.0, 0.02, 7e6),
        ];
        let mode = |(_, hz, zeta, k)| AttachedMode::new(hz, zeta, k, [0.0, 1.0, 0.0]);
        let modes = AttachedModes {
            tool: vec![mode(rows[0]), mode(rows[0])],
            over_speed: vec![SpeedTable {
                tool: 1,
                rows: rows.iter().map(|row| (row.0, mode(*row))).collect(),
            }],
            ..AttachedModes::default()
        };
        let at = |speed: f64| {
            let found = modes.at(speed);
            assert_eq!(found.tool[0], modes.tool[0]);
            let mode = found.tool[1];
            [
                mode.natural_frequency_rad_s / TAU,
                mode.damping_ratio,
                mode.stiffness_n_per_m,
            ]
        };
        let expected = [
            (0.0, [1000.0, 0.03, 1e7]),
            (150.0, [975.0, 0.0325, 9.5e6]),
            (600.0, [900.0, 0.04, 8e6]),
            (800.0, [800.0, 0.03, 7.5e6]),
            (1000.0, [700.0, 0.02, 7e6]),
            (5000.0, [700.0, 0.02, 7e6]),
        ];
        for (speed, row) in expected {
            for (found, value) in at(speed).into_iter().zip(row) {
                assert!(
                    (found / value - 1.0).abs() < 1e-12,
                    "{speed}: {found}, {value}"
                );
            }
        }
        assert_eq!(modes.known_to_rad_s(), Some(1000.0));
    }
}
