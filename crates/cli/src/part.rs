//! `truecut part`: what is understood of a part's mesh.

use std::collections::{BTreeMap, HashMap};
use std::path::Path;

use serde::Serialize;
use truecut_plan::surface::part::{FaceKind, Part, PartEdge, PartFace, PartOptions};
use truecut_recording::{Unit, significant};
use truecut_telemetry::{FaceShown, PartShown, write_part};

use crate::args::PartArguments;
use crate::exit_status::ExitStatus;
use crate::failure::Failure;
use crate::progress::Progress;
use crate::text::{self, Align, headed, show, table};

/// Faces and edges that are listed; JSON has all.
const LISTED: usize = 40;

/// The report as JSON.
#[derive(Serialize)]
struct Told<'a> {
    #[serde(flatten)]
    part: &'a Part,
    /// The viewer's file.
    rrd: &'a Path,
}

/// Prints the report and writes the viewer's file.
pub fn part(arguments: &PartArguments) -> Result<ExitStatus, Failure> {
    let file = &arguments.file;
    let options = PartOptions {
        unit_m: arguments.unit_m(),
        crease_rad: arguments.crease_deg.to_radians(),
        weld_m: arguments.weld_mm.map(|mm| mm * 1e-3),
    };
    let part = Progress::of_one("part", |progress| Part::load(file, &options, progress))
        .map_err(|error| Failure::message(error.to_string()))?;
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let printed = printed(&name, &part, arguments);
    let folder = (arguments.out).join(truecut_files::folder_name(file, "part"));
    std::fs::create_dir_all(&folder)
        .map_err(|error| Failure::at(&folder, format!("cannot make the folder: {error}")))?;
    let rrd = folder.join("part.rrd");
    draw(&format!("{name}: part"), &printed, &part, &rrd)?;
    if arguments.json {
        let rrd = &rrd;
        return crate::print(&text::json(&Told { part: &part, rrd })?);
    }
    crate::print(&format!("{printed}\n  {}\n", rrd.display()))
}

/// What keeps a part from having a volume.
fn why_no_volume(part: &Part) -> &'static str {
    let defects = &part.defects;
    match (defects.open_edges.count, defects.non_manifold_edges.count) {
        (0, 0) => "it is closed, but triangles are wound against the others",
        (0, _) => "edges belong to more than two triangles",
        _ => "it is not closed",
    }
}

fn printed(name: &str, part: &Part, arguments: &PartArguments) -> String {
    let sides: [f64; 3] = std::array::from_fn(|i| part.high_m[i] - part.low_m[i]);
    let size = sides.map(millimetres).join(" × ");
    let volume = match part.volume_m3 {
        Some(volume) => show(Unit::CubicMetre, volume),
        None => format!("none: {}", why_no_volume(part)),
    };
    let mut text = format!(
        "{name}\n  {size} mm, from {} mm, read in {}\n  {} triangles on {} vertices, {}\n  \
         area {}, volume {volume}\n",
        point(&part.low_m),
        arguments.unit,
        part.triangle_count,
        part.vertex_count,
        counted(part.shells, "piece"),
        show(Unit::SquareMetre, part.area_m2),
    );
    if let Some(other) = &part.suspected_unit {
        text.push_str(&format!(
            "  ✗ UNIT? the file may be in {}: {}; --unit says which it is\n",
            other.name, other.why
        ));
    }
    text.push_str(&defects(part));
    text.push_str(&modelled(part));
    text.push_str(&format!(
        "\n  {} parted where triangles turn by {} deg or more\n",
        counted(part.faces.len(), "face"),
        arguments.crease_deg
    ));
    text.push_str(&faces(&part.faces));
    text.push_str(&format!("\n  {}\n", counted(part.edges.len(), "edge")));
    text.push_str(&edges(&part.edges));
    text
}

fn defects(part: &Part) -> String {
    let mut text = String::new();
    for (name, defect) in part.defects.named() {
        if let Some(at) = &defect.first_at_m {
            let place = point(at);
            text.push_str(&format!(
                "  ✗ {}: {}, first at {place} mm\n",
                name, defect.count
            ));
        }
    }
    if part.defects.inside_out {
        text.push_str("  ✗ inside out: all triangles are wound clockwise seen from outside\n");
    }
    if text.is_empty() {
        text.push_str("  no defects\n");
    }
    text
}

/// Which surfaces the faces of a STEP file have.
fn modelled(part: &Part) -> String {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for face in &part.step_faces {
        *counts.entry(face.kind).or_default() += 1;
    }
    if counts.is_empty() {
        return String::new();
    }
    let kinds: Vec<String> = (counts.iter())
        .map(|(kind, count)| format!("{kind} {count}"))
        .collect();
    format!(
        "  {} in the file: {}; --json lists their areas\n",
        counted(part.step_faces.len(), "face"),
        kinds.join(", ")
    )
}

fn faces(all: &[PartFace]) -> String {
    let of = |face: &PartFace| {
        let (kind, radius) = match face.shape {
            FaceKind::Planar => ("planar", String::new()),
            FaceKind::Cylindrical {
                radius_m, hollow, ..
            } => (
                if hollow {
                    "cylindrical, hollow"
                } else {
                    "cylindrical"
                },
                millimetres(radius_m),
            ),
            FaceKind::Freeform => ("freeform", String::new()),
        };
        let direction = |d: [f64; 3]| d.map(|x| format!("{:.3}", x + 0.0)).join(" ");
        let towards = match face.shape {
            FaceKind::Cylindrical {
                axis, axis_at_m, ..
            } => format!("axis {} at {}", direction(axis), point(&axis_at_m)),
            FaceKind::Planar | FaceKind::Freeform => direction(face.normal),
        };
        vec![
            face.number.to_string(),
            kind.to_owned(),
            show(Unit::SquareMetre, face.area_m2),
            point(&face.on_face_m),
            towards,
            radius,
            face.triangles.to_string(),
        ]
    };
    let rows = all.iter().take(LISTED).map(of);
    let head = [
        "face",
        "shape",
        "area",
        "a point (mm)",
        "mean normal, or axis (mm)",
        "radius (mm)",
        "triangles",
    ];
    let left_right = [
        Align::Right,
        Align::Left,
        Align::Right,
        Align::Left,
        Align::Left,
        Align::Right,
        Align::Right,
    ];
    table(&left_right, &headed(&head, rows)) + &more(all.len())
}

fn edges(all: &[PartEdge]) -> String {
    if all.is_empty() {
        return String::new();
    }
    let of = |edge: &PartEdge| {
        let [one, other] = edge.faces;
        vec![
            edge.number.to_string(),
            format!("{one}, {other}"),
            millimetres(edge.length_m),
            significant(edge.dihedral_rad.to_degrees(), 5),
            if edge.closed { "closed" } else { "" }.to_owned(),
            point(&edge.ends_m[0]),
            point(&edge.ends_m[1]),
        ]
    };
    let rows = all.iter().take(LISTED).map(of);
    let head = [
        "edge",
        "faces",
        "length (mm)",
        "angle (deg)",
        "loop",
        "from (mm)",
        "to (mm)",
    ];
    let left_right = [
        Align::Right,
        Align::Left,
        Align::Right,
        Align::Right,
        Align::Left,
        Align::Left,
        Align::Left,
    ];
    table(&left_right, &headed(&head, rows)) + &more(all.len())
}

fn more(count: usize) -> String {
    match count.saturating_sub(LISTED) {
        0 => String::new(),
        rest => format!("    and {rest} smaller ones; --json lists all\n"),
    }
}

fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

fn millimetres(value_m: f64) -> String {
    format!("{:.3}", value_m * 1e3 + 0.0)
}

fn point(at_m: &[f64; 3]) -> String {
    format!("({})", at_m.map(millimetres).join(", "))
}

fn draw(title: &str, text: &str, part: &Part, rrd: &Path) -> Result<(), Failure> {
    let mut shown: Vec<FaceShown> = (part.faces.iter())
        .map(|face| FaceShown {
            number: face.number,
            at_m: face.on_face_m,
            ..FaceShown::default()
        })
        .collect();
    let mut known: Vec<HashMap<u32, u32>> = vec![HashMap::new(); shown.len()];
    for (triangle, face) in part.triangles().iter().zip(part.face_of()) {
        let (own, known) = (&mut shown[*face as usize], &mut known[*face as usize]);
        let corners = triangle.map(|vertex| {
            *known.entry(vertex).or_insert_with(|| {
                own.vertices_m
                    .push(part.vertices_m()[vertex as usize].into());
                own.vertices_m.len() as u32 - 1
            })
        });
        own.triangles.push(corners);
    }
    drop(known);
    let place = |edge: &PartEdge| edge.points_m.iter().map(|p| (*p).into()).collect();
    let edges: Vec<Vec<[f64; 3]>> = part.edges.iter().map(place).collect();
    let shown = PartShown {
        title,
        text,
        box_m: [part.low_m, part.high_m],
        faces: &shown,
        edges_m: &edges,
    };
    write_part(rrd, &shown).map_err(|error| Failure::message(error.to_string()))
}
