//! What path milling leaves, taken up by the rest of the program.

use std::path::Path;

use serde_json::Value;
use truecut_recording::Summary;

use super::Desk;

/// A plate of 60 x 30 x 5 mm: a side milled off in two depths, and a slot along it.
const WAY: &str = "%
G21 G90 G94 G17
G0 X-12. Y0. Z5.
G61
G1 Z-2.5 F1800.
X72.
Z-5.
X-12.
Z-2.
Y15.
X72.
G0 Z5.
M30
%
";

fn asset(path: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../..")
        .join(path);
    path.canonicalize().unwrap().display().to_string()
}

fn mill(desk: &Desk) {
    std::fs::write(desk.path("way.nc"), WAY).unwrap();
    let scenario = format!(
        r#"
name = "Milled plate"
[robot]
urdf = '{}'
config = '{}'
[process.path_milling]
spindle_rpm = 12000
[process.path_milling.cutter]
diameter_mm = 12
teeth = 2
helix_deg = 30
[process.path_milling.cutting]
tangential_mpa = 600
radial_mpa = 200
[process.path_milling.path]
file = "way.nc"
work_xyz_mm = [1050, -1450, 870]
rapid_mm_per_s = 40
[process.path_milling.stock]
corner_mm = [0, 0, -5]
size_mm = [60, 30, 5]
grid_mm = 0.5
"#,
        asset("assets/robots/irb6600_175_255/robot.urdf"),
        asset("assets/robots/irb6600_175_255/milling.toml"),
    );
    std::fs::write(desk.path("plate.toml"), scenario).unwrap();
    desk.ends(0, &["run", "plate.toml"]);
}

/// Points on the upper edge of the side that is milled off, as the tool has left it.
fn upper_edge_mm(stl: &Path) -> Vec<[f32; 3]> {
    let bytes = std::fs::read(stl).unwrap();
    let float = |at: &[u8]| f32::from_le_bytes(at.try_into().unwrap());
    let triangles = bytes[84..].chunks_exact(50).map(|one| &one[12..48]);
    let corners = triangles.flat_map(|all| all.chunks_exact(12));
    let mut points: Vec<[f32; 3]> = corners
        .map(|corner| [0, 4, 8].map(|at| float(&corner[at..at + 4])))
        .filter(|[x, y, z]| *z == 0.0 && (y - 6.0).abs() < 0.4 && *x > 1.0 && *x < 59.0)
        .collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    points.dedup();
    points.into_iter().step_by(8).collect()
}

/// The part has no defects, the volume that the run reports, and an edge that a brush deburrs.
#[test]
fn a_milled_part_is_a_solid_that_can_be_brushed() {
    let desk = Desk::new();
    mill(&desk);
    let told = desk.ends(0, &["part", "out/plate/part.stl", "--json"]);
    let part: Value = serde_json::from_str(&told).unwrap();
    let defects = part["defects"].as_object().unwrap();
    assert!(defects.len() > 8, "{defects:?}");
    for (name, defect) in defects {
        let none = defect == &Value::Bool(false) || defect["count"] == 0;
        assert!(none, "{name}: {defect}");
    }
    let summary = std::fs::read_to_string(desk.path("out/plate/summary.json")).unwrap();
    let summary: Summary = serde_json::from_str(&summary).unwrap();
    let removed_m3 = summary.metrics["path_milling.stock_removed"].unwrap();
    let left_m3 = 60.0 * 30.0 * 5.0 * 1e-9 - removed_m3;
    let volume_m3 = part["volume_m3"].as_f64().unwrap();
    assert!(
        (volume_m3 / left_m3 - 1.0).abs() < 1e-6,
        "{volume_m3} {left_m3}"
    );

    let points = upper_edge_mm(&desk.path("out/plate/part.stl"));
    let scenario = format!(
        r#"
name = "Brushed plate"
[robot]
urdf = '{}'
[run]
time_step_ms = 0.5
[process.brush]
radius_mm = 60
width_mm = 20
speed_rpm = 1500
bristles = 8000
bristle_diameter_mm = 0.5
free_length_mm = 25
youngs_modulus_mpa = 3000
mu = 0.3
preston_per_pa = 1.5e-10
[process.brush.path]
file = '{}'
work_xyz_mm = [1000, -30, 400]
tool_xyz_mm = [0, 0, 57]
spin_deg = 90
[process.brush.workpiece]
mesh = "out/plate/part.stl"
xyz_mm = [1000, -36, 420]
[[process.brush.edge]]
points_mm = {points:?}
burr_height_mm = 0.15
burr_thickness_mm = 0.05
"#,
        asset("assets/robots/hp20/robot.urdf"),
        asset("scenarios/finishing/block_edge.nc"),
    );
    std::fs::write(desk.path("brushed.toml"), scenario).unwrap();
    desk.ends(0, &["run", "brushed.toml"]);
    let summary = std::fs::read_to_string(desk.path("out/brushed/summary.json")).unwrap();
    let summary: Summary = serde_json::from_str(&summary).unwrap();
    assert_eq!(summary.metrics["brush.burred_length"], Some(0.0));
}
