//! Chip area and cutting forces of hole chamfering, after `dong2018chamfering`, eqs. (1)–(5).
//!
//! Axes: X along the spindle, from the robot into the workpiece; the rim lies in the Y–Z plane;
//! angles run from Y towards Z. The chamfer has legs `d` (axial depth) and `d tanθ` (radial width),
//! θ being the angle between cutting edge and spindle axis, so the material removed down to depth
//! `d` is `½ d² tanθ` per unit of rim.

use nalgebra::Vector3;

/// The chip of a straight edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChipArea {
    half_angle_rad: f64,
    tan: f64,
}

impl ChipArea {
    /// For an edge at the angle θ to the spindle axis, rad.
    pub fn new(half_angle_rad: f64) -> Self {
        Self {
            half_angle_rad,
            tan: half_angle_rad.tan(),
        }
    }

    /// tanθ: radial width of the chamfer over its axial depth.
    pub fn tan(&self) -> f64 {
        self.tan
    }

    /// cosθ: axial depth of the chamfer over the length of its face.
    pub fn cos(&self) -> f64 {
        self.half_angle_rad.cos()
    }

    /// Area that an edge at `depth` removes where `previous` has been cut before, m²:
    /// `½ tanθ (d² - d_prev²)`, zero where the edge does not reach the surface.
    pub fn between_m2(&self, depth_m: f64, previous_m: f64) -> f64 {
        let (d, p) = (depth_m.max(0.0), previous_m.max(0.0));
        (0.5 * self.tan * (d * d - p * p)).max(0.0)
    }

    /// Eq. (1) of `dong2018chamfering`: depth `d` already cut, feed `f` per tooth: `(d + f/2) f
    /// tanθ`, m².
    pub fn nominal_m2(&self, depth_m: f64, feed_m: f64) -> f64 {
        self.between_m2(depth_m + feed_m, depth_m)
    }

    /// Length of the engaged edge, m: `d / cosθ`.
    pub fn edge_length_m(&self, depth_m: f64) -> f64 {
        depth_m.max(0.0) / self.cos()
    }
}

/// Linear-edge force model: `F = K A + K_e b` in the feed, radial and tangential directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CuttingCoefficients {
    /// K_fc, Pa.
    pub axial_pa: f64,
    /// K_rc, Pa.
    pub radial_pa: f64,
    /// K_tc, Pa.
    pub tangential_pa: f64,
    /// Edge forces per length of engaged edge, N/m.
    pub edge_axial_n_per_m: f64,
    pub edge_radial_n_per_m: f64,
    pub edge_tangential_n_per_m: f64,
}

impl CuttingCoefficients {
    /// From the published K_fc and resultant K_rt = √(K_rc² + K_tc²), split by β = atan(K_rc /
    /// K_tc). The paper gives no β; with one edge it only turns the rotating force by a constant
    /// angle.
    pub fn from_resultant(axial_pa: f64, in_plane_pa: f64, in_plane_angle_rad: f64) -> Self {
        Self {
            axial_pa,
            radial_pa: in_plane_pa * in_plane_angle_rad.sin(),
            tangential_pa: in_plane_pa * in_plane_angle_rad.cos(),
            edge_axial_n_per_m: 0.0,
            edge_radial_n_per_m: 0.0,
            edge_tangential_n_per_m: 0.0,
        }
    }

    /// Of a straight edge at the angle θ to the spindle, from those of the edge of an end mill: the
    /// tangential force stays, the one across edge and motion, radial at an end mill, is turned
    /// towards the spindle by θ. Forces along the edge, which a helix brings, are left out.
    #[must_use]
    pub fn of_straight_edge(&self, half_angle_rad: f64) -> Self {
        let (sin, cos) = half_angle_rad.sin_cos();
        Self {
            axial_pa: self.radial_pa * sin,
            radial_pa: self.radial_pa * cos,
            tangential_pa: self.tangential_pa,
            edge_axial_n_per_m: self.edge_radial_n_per_m * sin,
            edge_radial_n_per_m: self.edge_radial_n_per_m * cos,
            edge_tangential_n_per_m: self.edge_tangential_n_per_m,
        }
    }

    /// K_rt, Pa.
    pub fn in_plane_pa(&self) -> f64 {
        self.radial_pa.hypot(self.tangential_pa)
    }

    /// Forces of one edge on the tool in (axial, radial, tangential) size, N.
    pub fn forces_n(&self, area_m2: f64, edge_length_m: f64) -> EdgeForces {
        let rubbing = if area_m2 > 0.0 { edge_length_m } else { 0.0 };
        EdgeForces {
            axial_n: self.axial_pa * area_m2 + self.edge_axial_n_per_m * rubbing,
            radial_n: self.radial_pa * area_m2 + self.edge_radial_n_per_m * rubbing,
            tangential_n: self.tangential_pa * area_m2 + self.edge_tangential_n_per_m * rubbing,
        }
    }

    /// What an edge in the cut does without its chip, N.
    pub(crate) fn edge_forces_n(&self, edge_length_m: f64) -> EdgeForces {
        EdgeForces {
            axial_n: self.edge_axial_n_per_m * edge_length_m,
            radial_n: self.edge_radial_n_per_m * edge_length_m,
            tangential_n: self.edge_tangential_n_per_m * edge_length_m,
        }
    }
}

/// Sizes of the force of one edge in its own directions, N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgeForces {
    pub axial_n: f64,
    pub radial_n: f64,
    pub tangential_n: f64,
}

impl EdgeForces {
    /// All parts times a factor.
    pub fn times(&self, factor: f64) -> Self {
        Self {
            axial_n: self.axial_n * factor,
            radial_n: self.radial_n * factor,
            tangential_n: self.tangential_n * factor,
        }
    }

    /// Force on the tool in (X, Y, Z) for an edge at angle φ: back along the feed, inwards, and
    /// against the edge's motion.
    ///
    /// `axial_sign` is -1 for forward chamfering (the workpiece pushes the tool back) and +1 for
    /// backward (it pulls the tool on). In the plane the paper's eq. (5) prints the opposite,
    /// outwards and along the motion: that is the force on the *workpiece*, which a dynamometer
    /// measures. With a nominal or an axial chip the difference is half a turn of phase; with a
    /// chip that sees radial motion the wrong sign would make every cut feed itself.
    ///
    /// In the principal frame the force on the workpiece is `F_Yq = -M sin(φ - α - β)` and
    /// `F_Zq = +M cos(φ - α - β)`; the paper's eq. (16) has the sign of F_Zq reversed, a force that
    /// would turn against the spindle (`docs/physics/chamfering.md`, Signs).
    pub fn on_tool_n(&self, angle_rad: f64, axial_sign: f64) -> Vector3<f64> {
        self.on_tool_towards_n(angle_rad.sin_cos(), axial_sign)
    }

    /// [`EdgeForces::on_tool_n`] for an edge of whose angle sine and cosine are known.
    pub fn on_tool_towards_n(&self, (s, c): (f64, f64), axial_sign: f64) -> Vector3<f64> {
        Vector3::new(
            axial_sign * self.axial_n,
            -self.radial_n * c + self.tangential_n * s,
            -self.radial_n * s - self.tangential_n * c,
        )
    }
}

/// The feed as a function of time: a ramp to full depth, then a dwell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FeedSchedule {
    /// Spindle speed, rad/s.
    pub spindle_rad_s: f64,
    /// Feed per revolution, m.
    pub feed_m_per_rev: f64,
    /// Number of equally spaced edges.
    pub edges: usize,
    /// Depth of the finished chamfer, m.
    pub depth_m: f64,
    /// Revolutions turned at full depth.
    pub dwell_revolutions: f64,
}

impl FeedSchedule {
    /// Feed per tooth, m.
    pub fn feed_per_tooth_m(&self) -> f64 {
        self.feed_m_per_rev / self.edges as f64
    }

    /// Time of one revolution, s.
    pub fn revolution_s(&self) -> f64 {
        std::f64::consts::TAU / self.spindle_rad_s
    }

    /// Time between two edges at one place of the rim, s.
    pub fn tooth_period_s(&self) -> f64 {
        self.revolution_s() / self.edges as f64
    }

    /// Duration of the ramp, s.
    pub fn ramp_s(&self) -> f64 {
        (self.depth_m - self.feed_per_tooth_m()) / self.feed_m_per_rev * self.revolution_s()
    }

    /// Ramp and dwell, s.
    pub fn duration_s(&self) -> f64 {
        self.ramp_s() + self.dwell_revolutions * self.revolution_s()
    }

    /// Depth already cut, D(t) = n f t / 60, m, held at the end of the ramp; negative before t = 0,
    /// which is the depth that the virtual pass before the first one would have had.
    pub fn depth_cut_m(&self, t_s: f64) -> f64 {
        let rate = self.feed_m_per_rev / self.revolution_s();
        (rate * t_s).min(self.depth_m - self.feed_per_tooth_m())
    }

    /// Depth of the edge, D(t) + f per tooth, m.
    pub fn edge_depth_m(&self, t_s: f64) -> f64 {
        self.depth_cut_m(t_s) + self.feed_per_tooth_m()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_4;

    const K: f64 = 1.0;

    fn source_a() -> (ChipArea, CuttingCoefficients) {
        (
            ChipArea::new(45f64.to_radians()),
            CuttingCoefficients::from_resultant(1.96e9, 2.14e9, 0.35),
        )
    }

    /// `docs/physics/chamfering.md`, Chip and forces: M = 109.68 N and F_X = 100.45 N at 1 mm
    /// depth.
    #[test]
    fn verify_source_a_forces_at_full_depth() {
        let (chip, k) = source_a();
        let area = chip.nominal_m2(1e-3, 0.05e-3);
        let f = k.forces_n(area, chip.edge_length_m(1e-3));
        assert!((f.radial_n.hypot(f.tangential_n) - 109.68).abs() < 0.01);
        assert!((f.axial_n - 100.45).abs() < 0.01);
        assert!((area / ((1e-3 + 0.025e-3) * 0.05e-3) - K).abs() < 1e-12);
    }

    /// The force turns with the spindle, in its sense: F_Yq = -M sin(φ-β), F_Zq = M cos(φ-β) at α =
    /// 0.
    #[test]
    fn verify_rotating_force_turns_with_the_spindle() {
        let (chip, k) = source_a();
        let f = k.forces_n(chip.nominal_m2(0.5e-3, 0.05e-3), 0.0);
        let m = f.radial_n.hypot(f.tangential_n);
        let beta = (k.radial_pa / k.tangential_pa).atan();
        for i in 0..12 {
            let phi = i as f64 * 0.55;
            let v = -f.on_tool_n(phi, -1.0); // on the workpiece
            assert!((v.y + m * (phi - beta).sin()).abs() < 1e-9 * m);
            assert!((v.z - m * (phi - beta).cos()).abs() < 1e-9 * m);
            let later = -f.on_tool_n(phi + 1e-3, -1.0);
            let turned = v.y * later.z - v.z * later.y; // positive: from Y towards Z
            assert!(turned > 0.0);
        }
    }

    /// The workpiece pushes the tool inwards and against its motion: a cut does not feed itself.
    #[test]
    fn verify_force_on_the_tool_opposes_the_cut() {
        let (chip, k) = source_a();
        let f = k.forces_n(chip.nominal_m2(0.5e-3, 0.05e-3), 0.0);
        for phi in [0.0, 1.0, 2.5, 4.0] {
            let force = f.on_tool_n(phi, -1.0);
            let (s, c) = f64::sin_cos(phi);
            assert!((force.y * c + force.z * s + f.radial_n).abs() < 1e-9);
            assert!((-force.y * s + force.z * c + f.tangential_n).abs() < 1e-9);
        }
    }

    /// `docs/physics/chamfering.md`, Chip and forces: with two or more equispaced edges the
    /// rotating resultant cancels.
    #[test]
    fn verify_equispaced_edges_cancel_in_the_plane() {
        let (chip, k) = source_a();
        let f = k.forces_n(chip.nominal_m2(0.5e-3, 0.025e-3), 0.0);
        for n in 2..6 {
            let sum: Vector3<f64> = (0..n)
                .map(|e| f.on_tool_n(std::f64::consts::TAU * e as f64 / n as f64 + 0.3, 1.0))
                .sum();
            assert!(sum.y.hypot(sum.z) < 1e-12 * n as f64 * f.tangential_n);
            assert!((sum.x - n as f64 * f.axial_n).abs() < 1e-9);
        }
    }

    #[test]
    fn verify_chip_areas_of_all_passes_add_up_to_the_chamfer() {
        let (chip, _) = source_a();
        let total: f64 = (0..20)
            .map(|i| chip.nominal_m2(0.05e-3 * i as f64, 0.05e-3))
            .sum();
        assert!((total / (0.5 * 1e-6) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn verify_schedule_ends_at_full_depth() {
        let s = FeedSchedule {
            spindle_rad_s: 10.0 * std::f64::consts::PI,
            feed_m_per_rev: 0.05e-3,
            edges: 1,
            depth_m: 1e-3,
            dwell_revolutions: 2.0,
        };
        assert!((s.ramp_s() - 3.8).abs() < 1e-12);
        assert!((s.duration_s() - 4.2).abs() < 1e-12);
        assert!((s.edge_depth_m(10.0) - 1e-3).abs() < 1e-18);
        assert!((s.depth_cut_m(1.0) - 0.25e-3).abs() < 1e-18);
        assert!((s.depth_cut_m(-0.1) + 0.025e-3).abs() < 1e-18);
    }

    /// `docs/physics/chamfering.md`, Coefficients of milling: 45 steel at 45°; and at any angle the
    /// force across the edge stays square to it, and as large.
    #[test]
    fn verify_coefficients_of_a_turned_edge() {
        let edge = CuttingCoefficients {
            radial_pa: 1065e6,
            tangential_pa: 3550e6,
            axial_pa: 300e6,
            edge_axial_n_per_m: 1e3,
            edge_radial_n_per_m: 2e4,
            edge_tangential_n_per_m: 3e4,
        };
        let turned = edge.of_straight_edge(FRAC_PI_4);
        assert!((turned.axial_pa / 753.1e6 - 1.0).abs() < 1e-4);
        assert!((turned.in_plane_pa() / 3629.0e6 - 1.0).abs() < 1e-4);
        for degrees in [1.0_f64, 20.0, 60.0, 89.0] {
            let half_angle_rad = degrees.to_radians();
            let k = edge.of_straight_edge(half_angle_rad);
            let (sin, cos) = half_angle_rad.sin_cos();
            // From the tip towards the spindle an edge gains cos θ in height and sin θ in radius;
            // radial forces point inwards.
            assert!((k.axial_pa * cos - k.radial_pa * sin).abs() < 1.0);
            assert!((k.axial_pa.hypot(k.radial_pa) - edge.radial_pa).abs() < 1.0);
            let across = k.edge_axial_n_per_m.hypot(k.edge_radial_n_per_m);
            assert!((across - edge.edge_radial_n_per_m).abs() < 1e-9);
        }
    }

    #[test]
    fn verify_edge_forces_act_only_in_cut() {
        let mut k = source_a().1;
        k.edge_tangential_n_per_m = 2.0e4;
        assert_eq!(k.forces_n(0.0, 1e-3).tangential_n, 0.0);
        let with = k.forces_n(1e-9, 1e-3).tangential_n;
        assert!((with - k.tangential_pa * 1e-9 - 20.0).abs() < 1e-9);
    }
}
