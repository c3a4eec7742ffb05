//! What a file without a body holds that comes nearest to one.

use std::collections::HashMap;

use super::BODIES;
use super::part21::{Fault, Part21};

/// Entities with a shape that are no bodies, and what to do about them: the nearest to a body
/// first.
const NEAR: &[(&[&str], &str)] = &[
    (
        &[
            "CSG_SOLID",
            "BOOLEAN_RESULT",
            "EXTRUDED_AREA_SOLID",
            "REVOLVED_AREA_SOLID",
            "SOLID_REPLICA",
            "BLOCK",
            "RIGHT_CIRCULAR_CYLINDER",
            "SPHERE",
        ],
        "what a solid is made by is not read: export the solid by its faces (B-rep)",
    ),
    (
        &[
            "TESSELLATED_SOLID",
            "TESSELLATED_SHELL",
            "COMPLEX_TRIANGULATED_FACE",
            "TRIANGULATED_FACE",
            "TRIANGULATED_SURFACE_SET",
        ],
        "triangles in STEP are not read: export the solid by its faces (B-rep), or the triangles as STL",
    ),
    (
        &[
            "FACE_BASED_SURFACE_MODEL",
            "CLOSED_SHELL",
            "OPEN_SHELL",
            "CONNECTED_FACE_SET",
            "ADVANCED_FACE",
            "FACE_SURFACE",
            "GEOMETRIC_SET",
            "CURVE_BOUNDED_SURFACE",
            "RECTANGULAR_TRIMMED_SURFACE",
            "B_SPLINE_SURFACE_WITH_KNOTS",
        ],
        "they belong to no body: sew the surfaces to a solid and export that",
    ),
    (
        &[
            "SHELL_BASED_WIREFRAME_MODEL",
            "EDGE_BASED_WIREFRAME_MODEL",
            "GEOMETRIC_CURVE_SET",
            "EDGE_CURVE",
            "COMPOSITE_CURVE",
            "TRIMMED_CURVE",
            "B_SPLINE_CURVE_WITH_KNOTS",
            "POLYLINE",
            "CIRCLE",
            "LINE",
        ],
        "wires hold no material: export the solid",
    ),
    (
        &["NEXT_ASSEMBLY_USAGE_OCCURRENCE", "DOCUMENT_FILE"],
        "an assembly without the shapes of its parts: export one part with its shape",
    ),
];
/// Kinds of entities that are named at most.
const MOST_NAMED: usize = 3;

/// The fault of a file that holds none of [`BODIES`]. Only names known here are told, so that it
/// stays short whatever the file holds.
pub(super) fn fault(file: &Part21<'_>) -> Fault {
    let mut counts: HashMap<&str, usize> = HashMap::new();
    for name in file.numbers.iter().filter_map(|n| file.name(*n)) {
        *counts.entry(name).or_default() += 1;
    }
    let all = NEAR
        .iter()
        .flat_map(|(names, advice)| names.iter().map(move |name| (*name, *advice)));
    let near: Vec<(String, &str)> = all
        .filter_map(|(name, advice)| Some((format!("{} {name}", counts.get(name)?), advice)))
        .take(MOST_NAMED)
        .collect();
    let held = match near.first() {
        None => "it has no solids, faces or wires of any kind: export the solid".to_owned(),
        Some((_, advice)) => {
            let named: Vec<&str> = near.iter().map(|(named, _)| named.as_str()).collect();
            format!("nearest to one it has {}; {advice}", named.join(", "))
        }
    };
    Fault::new(format!(
        "the file holds no body; {} are read as bodies; {held}",
        BODIES.join(", ")
    ))
}
