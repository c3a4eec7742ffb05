//! Plots that are known beforehand.

use super::Place;

/// A plot that is known beforehand.
pub(super) struct Template {
    pub(super) title: &'static str,
    pub(super) place: Place,
    /// What is smaller than this, SI, is as good as nothing: the axis must not enlarge it.
    pub(super) least: f64,
    /// How the names of its channels begin, with `joint3.` read as `joint.`.
    pub(super) beginnings: &'static [&'static str],
}

const fn front(
    title: &'static str,
    place: Place,
    least: f64,
    beginnings: &'static [&'static str],
) -> Template {
    Template {
        title,
        place,
        least,
        beginnings,
    }
}

const fn behind(title: &'static str, beginnings: &'static [&'static str]) -> Template {
    Template {
        title,
        place: Place::Behind,
        least: 0.0,
        beginnings,
    }
}

/// Where tools follow a path, their displacement since touch-down shows that path, and this what
/// the process does to the arm.
pub(super) const DEFLECTION: &str = "Deflection of the tool from its path";

/// In the order in which plots appear. A channel goes to the first that fits.
pub(super) const TEMPLATES: &[Template] = &[
    front(
        DEFLECTION,
        Place::FrontWithSpectrum,
        1e-6,
        &["tool.deflection_", "milling.deflection_"],
    ),
    front(
        "Tool displacement, process frame",
        Place::FrontWithSpectrum,
        1e-5,
        &["tool.displacement_"],
    ),
    front(
        "Dynamometer: lateral force on the workpiece",
        Place::FrontWithSpectrum,
        10.0,
        &["dynamometer.force_y", "dynamometer.force_z"],
    ),
    front(
        "Pressure foot on the workpiece",
        Place::Front,
        10.0,
        &["foot.normal_force", "foot.friction_"],
    ),
    front(
        "Cutting force on the tool, milling frame",
        Place::Front,
        10.0,
        &["milling.force_"],
    ),
    front(
        "Cutting force on the tool, work frame",
        Place::Front,
        10.0,
        &["path_milling.force_"],
    ),
    // The arm's deflection along its path and this share directions, and hence colours.
    front(
        "Deflection of the tool's tip, work frame",
        Place::Front,
        1e-6,
        &["path_milling.deflection_"],
    ),
    front(
        "Left on the wall",
        Place::Front,
        1e-6,
        &["milling.wall_error"],
    ),
    front(
        "Wheel on the workpiece",
        Place::Front,
        1.0,
        &["wheel.normal_force", "wheel.friction_force"],
    ),
    front(
        "Polishing wheel on the face",
        Place::Front,
        1.0,
        &[
            "polish.normal_force",
            "polish.edge_force",
            "polish.inward_edge_force",
            "polish.friction_",
            "surface_polish.normal_force",
            "surface_polish.friction_",
        ],
    ),
    front(
        "Belt on the face",
        Place::Front,
        1.0,
        &["belt.normal_force", "belt.edge_force", "belt.friction_"],
    ),
    front(
        "Brush on the workpiece",
        Place::Front,
        1.0,
        &["brush.bristle_force", "brush.friction_force"],
    ),
    front(
        "Acceleration of the tool, face axes",
        Place::FrontWithSpectrum,
        1e-3,
        &["polish.acceleration_"],
    ),
    front(
        "Load on the tool, process frame",
        Place::FrontWithSpectrum,
        1.0,
        &["load.force_"],
    ),
    behind(
        "Depth",
        &[
            "cutting.depth",
            "cutting.engaged_depth",
            "wheel.indentation",
            "polish.indentation",
            "surface_polish.indentation",
            "belt.indentation",
            "brush.shortening",
        ],
    ),
    behind(
        "Cutting force on the tool, process frame",
        &["cutting.force_"],
    ),
    behind(
        "Dynamometer: axial force on the workpiece",
        &["dynamometer.force_x"],
    ),
    behind("Chip area", &["cutting.chip_area"]),
    behind("Slip speed of the foot", &["foot.slip_speed"]),
    behind("Tool velocity, process frame", &["tool.velocity_"]),
    behind("Tool position, world", &["tool.position_"]),
    behind("Torque in the transmission", &["joint.transmission_torque"]),
    behind("Joint angle", &["joint.angle"]),
    behind("Joint position", &["joint.position"]),
    behind("Joint velocity", &["joint.velocity"]),
    behind("Joint command", &["joint.command"]),
    behind("Energy", &["energy."]),
];
