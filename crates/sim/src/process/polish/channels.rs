//! What a polishing run records of every step.

use super::PolishStep;
use truecut_recording::{ChannelSpec, Unit};

/// Channels in the order of [`record`].
pub(super) fn specs() -> Vec<ChannelSpec> {
    let spec =
        |name: &str, unit, text: &str| ChannelSpec::new(format!("polish.{name}"), unit, text);
    vec![
        spec(
            "normal_force",
            Unit::Newton,
            "Force with which the wheel presses on the face",
        ),
        spec(
            "edge_force",
            Unit::Newton,
            "Part of the normal force that acts along edges",
        ),
        spec(
            "inward_edge_force",
            Unit::Newton,
            "Part of the edge force on edges over which the wheel's surface moves inward",
        ),
        spec(
            "friction_x",
            Unit::Newton,
            "Friction on the face, along its length",
        ),
        spec(
            "friction_y",
            Unit::Newton,
            "Friction on the face, along its width",
        ),
        spec(
            "penetration",
            Unit::Metre,
            "How far the undeformed wheel reaches into the face",
        ),
        spec(
            "position_x",
            Unit::Metre,
            "Middle of the patch, along the face's length",
        ),
        spec(
            "position_y",
            Unit::Metre,
            "Middle of the patch, along the face's width",
        ),
        spec(
            "precession_angle",
            Unit::Radian,
            "Where the spin axis leans, from the face's x axis, -180 to 180 degrees",
        ),
        spec(
            "carrier_offset",
            Unit::Metre,
            "Offset of the force control's carrier towards the face",
        ),
        spec(
            "acceleration_x",
            Unit::MetrePerSecondSquared,
            "Acceleration of the tool along the face's length",
        ),
        spec(
            "acceleration_y",
            Unit::MetrePerSecondSquared,
            "Acceleration of the tool along the face's width",
        ),
        spec(
            "acceleration_z",
            Unit::MetrePerSecondSquared,
            "Acceleration of the tool along the face's normal",
        ),
        spec("removed_volume", Unit::CubicMetre, "Volume removed so far"),
    ]
}

/// The values of a step; `removed_m3` is the volume removed so far.
pub(super) fn record(last: &PolishStep, removed_m3: f64, row: &mut Vec<f64>) {
    row.extend([
        last.normal_n,
        last.edge_n,
        last.inward_n,
        last.friction_n.x,
        last.friction_n.y,
        last.indentation_m,
        last.at_m.x,
        last.at_m.y,
        last.lean_rad,
        last.carrier_m,
    ]);
    row.extend(last.acceleration_m_s2.iter());
    row.push(removed_m3);
}
