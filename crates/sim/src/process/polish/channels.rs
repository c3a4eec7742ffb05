//! What a polishing run records of every step.

use super::PolishStep;
use super::edge_grains::EdgeGrains;
use crate::process::quantity::Quantity;
use truecut_recording::Unit;

impl PolishStep {
    /// The step in numbers; `removed_m3` is the volume removed so far.
    pub(super) fn quantities(&self, removed_m3: f64) -> Vec<Quantity> {
        let [x, y, z] = self.acceleration_m_s2.into();
        vec![
            Quantity::new("polish.normal_force", Unit::Newton, self.normal_n)
                .text("Force with which the wheel presses on the face"),
            Quantity::new("polish.edge_force", Unit::Newton, self.edge_n)
                .text("Part of the normal force that acts along edges"),
            Quantity::new("polish.inward_edge_force", Unit::Newton, self.inward_n).text(
                "Part of the edge force on edges over which the wheel's surface moves inward",
            ),
            Quantity::new("polish.friction_x", Unit::Newton, self.friction_n.x)
                .text("Friction on the face, along its length"),
            Quantity::new("polish.friction_y", Unit::Newton, self.friction_n.y)
                .text("Friction on the face, along its width"),
            Quantity::new("polish.indentation", Unit::Metre, self.indentation_m)
                .text("How far the undeformed wheel reaches into the face"),
            Quantity::new("polish.position_x", Unit::Metre, self.at_m.x)
                .text("Middle of the patch, along the face's length"),
            Quantity::new("polish.position_y", Unit::Metre, self.at_m.y)
                .text("Middle of the patch, along the face's width"),
            Quantity::new("polish.precession_angle", Unit::Radian, self.lean_rad)
                .text("Where the spin axis leans, from the face's x axis, -180 to 180 degrees"),
            Quantity::new("polish.carrier_offset", Unit::Metre, self.carrier_m)
                .text("Offset of the force control's carrier towards the face"),
            Quantity::new("polish.acceleration_x", Unit::MetrePerSecondSquared, x)
                .text("Acceleration of the tool along the face's length"),
            Quantity::new("polish.acceleration_y", Unit::MetrePerSecondSquared, y)
                .text("Acceleration of the tool along the face's width"),
            Quantity::new("polish.acceleration_z", Unit::MetrePerSecondSquared, z)
                .text("Acceleration of the tool along the face's normal"),
            Quantity::new(
                "polish.acceleration_in_plane",
                Unit::MetrePerSecondSquared,
                x.hypot(y),
            )
            .text("Size of the tool's acceleration in the plane of the face"),
            Quantity::new(
                "polish.acceleration_outward",
                Unit::MetrePerSecondSquared,
                self.outward_m_s2,
            )
            .text("Acceleration of the tool along the outward normal of the nearest edge"),
            Quantity::new("polish.removed_volume", Unit::CubicMetre, removed_m3)
                .text("Volume removed so far"),
        ]
    }
}

/// What is recorded of grains at edges.
pub(super) fn of_grains(grains: &EdgeGrains) -> [Quantity; 5] {
    let force = grains.load.force_n;
    [
        Quantity::new("polish.grain_force_x", Unit::Newton, force.x)
            .text("Force of single grains at edges on the face, along its length"),
        Quantity::new("polish.grain_force_y", Unit::Newton, force.y)
            .text("Force of single grains at edges on the face, along its width"),
        Quantity::new("polish.grain_force_z", Unit::Newton, -force.z)
            .text("What single grains at edges press more than the mean"),
        Quantity::new("polish.grains_jammed", Unit::One, grains.jammed())
            .text("Grains that have jammed at edges so far"),
        Quantity::new("polish.grains_shed", Unit::One, grains.shed())
            .text("Grains that the wheel has lost at edges so far"),
    ]
}
