//! An end mill along a file at the speeds that the file gives.

use super::support::{run, scenario};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Uniform};
use std::f64::consts::{PI, TAU};
use tempfile::tempdir;
use truecut_recording::Recording;
use truecut_scenario::Scenario;

const DIAMETER_M: f64 = 10e-3;
const DEPTH_M: f64 = 1e-3;
/// Of a material so soft that the arm stays on its path: it would cut a hundredth deeper in metal.
const TANGENTIAL_PA: f64 = 6e6;
/// Where the speed changes, in the work frame, mm.
const CHANGE_MM: f64 = 20.0;

/// A slot through a block from x = 0 to 40 mm.
fn slot(file: &str, spindle: &str) -> Scenario {
    let text = format!(
        r#"
name = "slot"
[robot]
urdf = "../../assets/robots/irb6600_175_255/robot.urdf"
config = "../../assets/robots/irb6600_175_255/milling.toml"
[process.path_milling]
{spindle}
[process.path_milling.cutter]
diameter_mm = 10
teeth = 2
[process.path_milling.cutting]
tangential_mpa = 6
radial_mpa = 2
[process.path_milling.path]
file = "{file}"
work_xyz_mm = [1050, -1450, 870]
[process.path_milling.stock]
corner_mm = [0, -10, -10]
size_mm = [40, 20, 10]
grid_mm = 0.5
"#
    );
    scenario(&text, &[])
}

fn values(recording: &Recording, name: &str) -> Vec<f64> {
    let values = recording.channel(name).unwrap_or_else(|e| panic!("{e}"));
    values.to_vec()
}

/// Speed of the spindle in each step, 1/s, from its angle.
fn speeds(recording: &Recording) -> Vec<f64> {
    let angle = values(recording, "path_milling.spindle_angle");
    let step_s = recording.time_s[1] - recording.time_s[0];
    let each = angle.windows(2);
    each.map(|pair| (pair[1] - pair[0]).rem_euclid(TAU) / TAU / step_s)
        .collect()
}

/// Two speeds in one cut, drawn from a seed: the new one comes on where the file says it, and on
/// either side of it the mean torque of a slot is `K_t a d v / w`, with `pi f / (4 d)` of it added,
/// since chips that are measured inwards from the rim have `h (R - h/2)` of area.
#[test]
fn verify_speeds_of_a_file_come_on_where_it_says_and_take_their_torque() {
    let mut random = ChaCha8Rng::seed_from_u64(3001);
    let mut draw = |low: f64, high: f64| Uniform::new(low, high).unwrap().sample(&mut random);
    let folder = tempdir().unwrap();
    for case in 0..4 {
        let rpm = [draw(4000.0, 12000.0).round(), draw(4000.0, 12000.0).round()];
        let feed_m_per_s = draw(10e-3, 25e-3);
        let file = folder.path().join(format!("slot{case}.nc"));
        let feed = feed_m_per_s * 6e4;
        let code = format!(
            "G90 G21 S{} M3\nG0 X-8 Y0 Z-1\nG1 X{CHANGE_MM} F{feed}\nS{}\nX45\nM30\n",
            rpm[0], rpm[1]
        );
        std::fs::write(&file, code).unwrap();
        let recording = run(&slot(&file.display().to_string(), ""));
        let along_mm: Vec<f64> = values(&recording, "path_milling.position_x")
            .iter()
            .map(|x| x * 1e3)
            .collect();
        let speed = speeds(&recording);
        let torque = values(&recording, "path_milling.torque");
        let middle = 0.5 * (rpm[0] + rpm[1]) / 60.0;
        let rises = rpm[1] > rpm[0];
        let change = speed.iter().position(|&one| (one > middle) == rises);
        let at_mm = along_mm[change.expect("the speed changes")];
        println!("{rpm:?} 1/min, {feed:.1} mm/min: the speed changes at {at_mm:.4} mm");
        // The arm is some micrometres off, the step is 5 um long at most.
        assert!((at_mm - CHANGE_MM).abs() < 0.05, "{at_mm}");
        for (rpm, [from_mm, to_mm]) in rpm.into_iter().zip([[4.0, 19.0], [21.0, 34.0]]) {
            let rad_s = rpm / 60.0 * TAU;
            let within = |k: &usize| (from_mm..to_mm).contains(&along_mm[*k]);
            let rows: Vec<usize> = (0..speed.len()).filter(within).collect();
            let mean = |of: &[f64]| rows.iter().map(|k| of[*k]).sum::<f64>() / rows.len() as f64;
            assert!((mean(&speed) / (rpm / 60.0) - 1.0).abs() < 1e-3);
            let tooth_m = feed_m_per_s * TAU / rad_s / 2.0;
            let thicker = 1.0 + PI * tooth_m / (4.0 * DIAMETER_M);
            let wanted = TANGENTIAL_PA * DEPTH_M * DIAMETER_M * feed_m_per_s / rad_s * thicker;
            let off = mean(&torque) / wanted - 1.0;
            println!(
                "  {rpm} 1/min: torque {:.5} N m, off by {off:.2e}",
                mean(&torque)
            );
            assert!(off.abs() < 2e-3, "{off}");
        }
    }
}

/// A speed that the scenario gives counts all along: the run is the same to the bit as one of a
/// file that gives that speed alone.
#[test]
fn a_speed_of_the_scenario_counts_all_along() {
    let folder = tempdir().unwrap();
    let written = |name: &str, words: [&str; 2]| {
        let file = folder.path().join(name);
        let code = format!(
            "G90 G21 {} M3\nG0 X-8 Y0 Z-1\nG1 X10 F1200\n{}\nX20\nM30\n",
            words[0], words[1]
        );
        std::fs::write(&file, code).unwrap();
        file.display().to_string()
    };
    let one = run(&slot(&written("one.nc", ["S9000", "(as before)"]), ""));
    let two = written("two.nc", ["S5000", "S7000"]);
    let over = run(&slot(&two, "spindle_rpm = 9000"));
    let of_file = run(&slot(&two, ""));
    let torque = |run: &Recording| values(run, "path_milling.torque");
    assert_eq!(torque(&one), torque(&over));
    assert_ne!(torque(&one), torque(&of_file));
}
