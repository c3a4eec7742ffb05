//! Effects on the build of the robot.

use super::entry::{Entry, same};
use super::{Family, TargetKind};
use truecut_recording::Unit;

pub(super) const PAYLOAD: Entry = Entry {
    name: "payload",
    family: Family::Robot,
    target: TargetKind::Whole,
    description: "A mass at the flange.",
    parameters: &[
        same("mass_kg", Unit::Kilogram, 0.0, -1000.0, 10000.0, "Mass"),
        same(
            "center_x_m",
            Unit::Metre,
            0.0,
            -5.0,
            5.0,
            "Its centre in the flange frame",
        )
        .shape(),
        same(
            "center_y_m",
            Unit::Metre,
            0.0,
            -5.0,
            5.0,
            "Its centre in the flange frame",
        )
        .shape(),
        same(
            "center_z_m",
            Unit::Metre,
            0.0,
            -5.0,
            5.0,
            "Its centre in the flange frame",
        )
        .shape(),
    ],
};

pub(super) const BASE_COMPLIANCE: Entry = Entry {
    name: "base_compliance",
    family: Family::Robot,
    target: TargetKind::Axis,
    description: "The base tilts about a world axis under load.",
    parameters: &[same(
        "compliance_rad_per_n_m",
        Unit::RadianPerNewtonMetre,
        0.0,
        0.0,
        1.0,
        "Tilt per moment",
    )],
};
