//! What path milling leaves, taken up by the rest of the program.

use std::path::Path;

use serde_json::Value;
use truecut_recording::Summary;
use truecut_telemetry::read_parquet;

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

/// Mills the plate along a path; what the run comes to.
fn mill(desk: &Desk, name: &str, way: &str, cutter: &str) -> Summary {
    write(desk, name, way, cutter);
    desk.ends(0, &["run", &format!("{name}.toml")]);
    summary(desk, name)
}

/// The plate, a path and further keys of the cutter.
fn write(desk: &Desk, name: &str, way: &str, cutter: &str) {
    let file = match way.starts_with("PARTNO") {
        true => "way.apt",
        false => "way.nc",
    };
    std::fs::write(desk.path(file), way).unwrap();
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
{cutter}
[process.path_milling.cutting]
tangential_mpa = 600
radial_mpa = 200
[process.path_milling.path]
file = "{file}"
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
    std::fs::write(desk.path(&format!("{name}.toml")), scenario).unwrap();
}

fn summary(desk: &Desk, name: &str) -> Summary {
    let path = desk.path(&format!("out/{name}/summary.json"));
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// The part, in which `truecut part` finds no defect.
fn part_without_defects(desk: &Desk, name: &str) -> Value {
    let told = desk.ends(0, &["part", &format!("out/{name}/part.stl"), "--json"]);
    let part: Value = serde_json::from_str(&told).unwrap();
    let defects = part["defects"].as_object().unwrap();
    assert!(defects.len() > 8, "{defects:?}");
    for (name, defect) in defects {
        let none = defect == &Value::Bool(false) || defect["count"] == 0;
        assert!(none, "{name}: {defect}");
    }
    part
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
    let summary = mill(&desk, "plate", WAY, "");
    let part = part_without_defects(&desk, "plate");
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
    let summary = self::summary(&desk, "brushed");
    assert_eq!(summary.metrics["brush.burred_length"], Some(0.0));
}

/// Down into full stock at 10 mm/s, 0.025 mm a tooth, and up again: thrust and torque of two ends
/// in the share that the tool sinks slower, and a round hole.
#[test]
fn a_plunge_has_the_thrust_of_its_ends() {
    let desk = Desk::new();
    let way = "%\nG21 G90 G94 G17\nG0 X30. Y15. Z1.\nG61\nG1 Z-3. F600.\nG0 Z5.\nM30\n%\n";
    let summary = mill(&desk, "plunge", way, "centre_cutting = true");
    let found = |name: &str| summary.metrics[&format!("path_milling.{name}")].unwrap();
    let (radius_m, chip_m) = (6e-3_f64, 25e-6);
    let thrust_n = 2.0 * 200e6 * chip_m * radius_m;
    let torque_n_m = 600e6 * chip_m * radius_m * radius_m;
    let hole_m3 = std::f64::consts::PI * radius_m * radius_m * 3e-3;
    let near = |found: f64, expected: f64, by: f64| {
        assert!((found / expected - 1.0).abs() < by, "{found} {expected}");
    };
    // The arm swings as the cut begins, and the path slows down at its end: forces follow.
    let rows = read_parquet(&desk.path("out/plunge/recording.parquet")).unwrap();
    let heights = rows.channel("path_milling.position_z").unwrap();
    let first = heights.iter().position(|z_m| *z_m < -1e-3).unwrap();
    let end = heights.iter().position(|z_m| *z_m < -2.7e-3).unwrap();
    let sunk_m = heights[first] - heights[end];
    let share = sunk_m / (rows.time_s[end] - rows.time_s[first]) / 10e-3;
    let mean = |name: &str| {
        let values = &rows.channel(name).unwrap()[first..end];
        values.iter().sum::<f64>() / values.len() as f64
    };
    near(mean("path_milling.force_z"), share * thrust_n, 0.02);
    near(mean("path_milling.torque"), share * torque_n_m, 0.02);
    near(found("stock_removed"), hole_m3, 0.01);
    near(found("chip_volume"), hole_m3, 0.02);
    part_without_defects(&desk, "plunge");
}

/// A ball of 12 mm, 2 mm deep into the plate from its side up to its middle, out of it on a slope:
/// the slot's section times its length with half a cap, and a groove; limits of balls are not
/// known.
#[test]
fn a_ball_leaves_its_groove_and_has_no_limits() {
    let desk = Desk::new();
    let slot = "%\nG21 G90 G94 G17\nG0 X-12. Y15. Z-2.\nG61\nG1 X30. F1200.\nG0 Z5.\nM30\n%\n";
    let (r, depth) = (6e-3_f64, 2e-3_f64);
    let summary = mill(&desk, "ball", slot, "corner_radius_mm = 6");
    let found = |summary: &Summary, name: &str| summary.metrics[&format!("path_milling.{name}")];
    let half_rad = (1.0 - depth / r).acos();
    let section_m2 = r * r * (half_rad - half_rad.sin() * half_rad.cos());
    let cap_m3 = std::f64::consts::PI * depth * depth * (r - depth / 3.0);
    let exact_m3 = section_m2 * 30e-3 + 0.5 * cap_m3;
    for (name, within) in [
        ("target_removed", 5e-3),
        ("stock_removed", 0.01),
        ("chip_volume", 0.01),
    ] {
        let found_m3 = found(&summary, name).unwrap();
        assert!(
            (found_m3 / exact_m3 - 1.0).abs() < within,
            "{name}: {found_m3} {exact_m3}"
        );
    }
    part_without_defects(&desk, "ball");
    desk.refused(
        &["lobes", "ball.toml"],
        &["corner_radius_mm", "upright edges"],
    );

    let slope = slot.replace("G0 Z5.", "X50. Z1.\nG0 Z5.");
    let summary = mill(&desk, "slope", &slope, "corner_radius_mm = 6");
    let [removed, target] =
        ["stock_removed", "target_removed"].map(|name| found(&summary, name).unwrap());
    assert!((removed / target - 1.0).abs() < 0.01, "{removed} {target}");
    assert!(target > exact_m3, "{target} {exact_m3}");
    part_without_defects(&desk, "slope");
}

/// The same groove by a ball that leans by 10 to 25 degrees and turns on its way, its middle on the
/// line of above: as much stock, chips and a part without defects; a heel that drags is refused.
#[test]
fn a_ball_that_leans_leaves_the_groove_of_one_that_stands() {
    let desk = Desk::new();
    let (r_mm, depth_mm) = (6.0_f64, 2.0);
    let goto = |x_mm: f64, lean_deg: f64| {
        let (sin, cos) = lean_deg.to_radians().sin_cos();
        // Forwards and to the side alike.
        let axis = [sin * 0.6, sin * 0.8, cos];
        let middle = [x_mm, 15.0, r_mm - depth_mm];
        let tip: [f64; 3] = std::array::from_fn(|k| middle[k] - r_mm * axis[k]);
        let words = tip.iter().chain(&axis).map(|one| format!("{one:.7}"));
        format!("GOTO/{}\n", words.collect::<Vec<_>>().join(","))
    };
    let mut way = String::from("PARTNO/GROOVE\nUNITS/MM\nMULTAX/ON\nRAPID\n");
    way += &goto(-12.0, 10.0);
    way += "FEDRAT/1200,MMPM\n";
    for k in 0..=20 {
        let share = f64::from(k) / 20.0;
        way += &goto(-12.0 + 42.0 * share, 10.0 + 15.0 * share);
    }
    way += "FINI\n";
    let summary = mill(&desk, "leans", &way, "corner_radius_mm = 6");
    let found = |name: &str| summary.metrics[&format!("path_milling.{name}")].unwrap();
    let half_rad = (1.0 - depth_mm / r_mm).acos();
    let section_mm2 = r_mm * r_mm * (half_rad - half_rad.sin() * half_rad.cos());
    let cap_mm3 = std::f64::consts::PI * depth_mm * depth_mm * (r_mm - depth_mm / 3.0);
    let exact_m3 = (section_mm2 * 30.0 + 0.5 * cap_mm3) * 1e-9;
    for (name, within) in [
        ("target_removed", 5e-3),
        ("stock_removed", 0.01),
        ("chip_volume", 0.01),
    ] {
        let found_m3 = found(name);
        assert!(
            (found_m3 / exact_m3 - 1.0).abs() < within,
            "{name}: {found_m3} {exact_m3}"
        );
    }
    assert!(found("surface_error_rms") < 60e-6);
    part_without_defects(&desk, "leans");
    desk.refused(&["lobes", "leans.toml"], &["corner_radius_mm"]);
    write(&desk, "leans", &way, "");
    desk.refused(&["lobes", "leans.toml"], &["way.apt", "leans"]);
}

/// Modes at 1 and 1.04 kHz.
const MODES: &str = "
[[process.path_milling.cutter.mode]]
frequency_hz = 1000
damping_ratio = 0.03
stiffness_n_per_um = 10
direction = [1, 0, 0]
[[process.path_milling.cutter.mode]]
frequency_hz = 1040
damping_ratio = 0.03
stiffness_n_per_um = 10
direction = [0, 1, 0]";

/// A slot deeper than its limit chatters; at the speed that is proposed for it the run is quiet.
#[test]
fn lobes_along_a_path_propose_a_speed_that_runs_prove() {
    let desk = Desk::new();
    let way = "%\nG21 G90 G94 G17\nG0 X-12. Y15. Z-2.\nG61\nG1 X24. F1800.\nG0 Z5.\nM30\n%\n";
    write(&desk, "slot", way, MODES);
    let range = ["--rpm", "9000,16000", "--size", "36", "--runs", "2"];
    desk.ends(0, &[&["lobes", "slot.toml"][..], &range].concat());
    let read = |name: &str| std::fs::read_to_string(desk.path(&format!("out/slot/{name}")));
    let told: Value = serde_json::from_str(&read("lobes.json").unwrap()).unwrap();
    let segment = &told["segments"][0];
    assert_eq!(segment["line"], 5);
    let number = |of: &Value, key: &str| of[key].as_f64().unwrap();
    assert!(number(segment, "margin") < 0.9, "{segment}");
    assert!(number(segment, "proposed_margin") > 1.1, "{segment}");
    let runs = told["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 2);
    assert_eq!(runs[1]["spindle_rad_s"], segment["proposed_rad_s"]);
    assert_eq!(runs[1]["outcome"], "completed", "{told}");
    let level = |run: &Value| run["vibration_m"].as_f64().unwrap_or(f64::INFINITY);
    assert!(
        level(&runs[0]) > 4.0 * level(&runs[1]),
        "{:?}",
        told["runs"]
    );
    assert!(read("lobes.svg").unwrap().contains("Path by margin"));
    desk.refused(
        &["lobes", "slot.toml", "--at", "3"],
        &["--at", "all along it"],
    );
}
