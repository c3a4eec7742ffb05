//! Maps that a run leaves: what a process took off, cell by cell.

use std::path::Path;

use super::Desk;

/// The first second of the shipped polish, on cells of 2 mm: the map's depths, over the area of a
/// cell, are the volume that the run tells, and its places lie on the face.
#[test]
fn a_polished_face_is_written_as_a_table_and_a_mesh() {
    let desk = Desk::new();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let shipped = root.join("scenarios/finishing/mould_constrained.toml");
    let text = std::fs::read_to_string(shipped).unwrap();
    // Without its claim, which is of the whole path.
    let text = text.split("[[claim]]").next().unwrap();
    let text = text.replace("../..", root.canonicalize().unwrap().to_str().unwrap());
    std::fs::write(desk.path("mould.toml"), text).unwrap();
    let cut = [
        "--set",
        "run.duration_s=1.5",
        "--set",
        "process.polish.face.cell_mm=2",
    ];
    let out = desk.ends(0, &[&["run", "mould.toml", "--no-rrd"][..], &cut].concat());
    assert!(out.contains("map.ply"), "{out}");
    let csv = std::fs::read_to_string(desk.path("out/mould/map.csv")).unwrap();
    let mut rows = csv.lines();
    assert_eq!(
        rows.next(),
        Some("column,row,x (m),y (m),z (m),removed_depth (m)")
    );
    let rows: Vec<Vec<f64>> = rows
        .map(|row| row.split(',').map(|cell| cell.parse().unwrap()).collect())
        .collect();
    assert_eq!(rows.len(), 50 * 30);
    let volume_m3: f64 = rows.iter().map(|row| row[5] * 4e-6).sum();
    let summary = std::fs::read_to_string(desk.path("out/mould/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    let told = find(&summary, "polish.removed_volume").expect("a volume");
    assert!(
        told > 0.0 && (volume_m3 / told - 1.0).abs() < 1e-2,
        "{volume_m3} {told}"
    );
    let on_face = |row: &Vec<f64>| {
        (1.0..1.1).contains(&row[2]) && row[3].abs() < 0.03 && (row[4] - 0.4).abs() < 1e-3
    };
    assert!(rows.iter().all(on_face));
    let mesh = std::fs::read_to_string(desk.path("out/mould/map.ply")).unwrap();
    assert!(mesh.contains("property double removed_depth") && mesh.contains("element face 2842"));
    assert!(desk.path("out/mould/map.parquet").is_file());

    // A run without a face leaves none, and takes those of an earlier one away.
    desk.scenario("mould", "duration_s = 0.02", "");
    let out = desk.ends(0, &["run", "mould.toml", "--no-rrd"]);
    assert!(
        !out.contains("map.ply") && !desk.path("out/mould/map.csv").exists(),
        "{out}"
    );
}

/// The value of a scalar, wherever the summary has it.
fn find(json: &serde_json::Value, name: &str) -> Option<f64> {
    match json {
        serde_json::Value::Object(map) => match map.get(name) {
            Some(found) => found.as_f64().or_else(|| found.get("value")?.as_f64()),
            None if map.get("name").and_then(|own| own.as_str()) == Some(name) => {
                map.get("value")?.as_f64()
            }
            None => map.values().find_map(|inner| find(inner, name)),
        },
        serde_json::Value::Array(all) => all.iter().find_map(|inner| find(inner, name)),
        _ => None,
    }
}
