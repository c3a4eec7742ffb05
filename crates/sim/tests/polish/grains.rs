//! Grains at edges, texture.

use super::shared::{column, mean, scalar};
use super::support::{run, run_with_tables};
use truecut_recording::Recording;

/// Soft grains' rubber of the tests' wheel: 8 per mm² jam at 0.3 where they meet an edge squarely.
const GRAINS: &str = "
[process.polish.grains]
radius_um = 40
protrusion_um = 30
protrusion_spread_um = 8
number_per_mm2 = 8
strength_n = 0.04
shed_share = 0.001
edge_radius_um = 5
specific_energy_j_per_mm3 = 10
";

/// One line along an edge, over which the wheel runs inward; outward with the spin reversed.
const ALONG_AN_EDGE: [(&str, &str); 6] = [
    ("face.length_mm", "30"),
    ("face.width_mm", "20"),
    ("path.inset_mm", "0"),
    ("path.line_spacing_mm", "20"),
    ("precession.turn_rpm", "0.001"),
    ("mu", "0.5"),
];

fn along(extra: &[(&str, &str)], tables: &str) -> Recording {
    let mut overrides = ALONG_AN_EDGE.to_vec();
    overrides.extend_from_slice(extra);
    run_with_tables(tables, &overrides)
}

/// Rows on the first line, far from its ends.
fn first_line(recording: &Recording) -> Vec<usize> {
    let [x, y] = ["polish.position_x", "polish.position_y"].map(|name| column(recording, name));
    (0..x.len())
        .filter(|row| y[*row].abs() < 1e-4 && x[*row] > 6e-3 && x[*row] < 24e-3)
        .collect()
}

/// Grains jam where the wheel runs inward and drag the edge along; the mean normal force is that
/// without grains; nothing jams outward.
#[test]
fn verify_grains_jam_inward_only_and_leave_the_mean_force() {
    let plain = along(&[], "");
    let with = along(&[], GRAINS);
    let (inward, jammed) = (
        scalar(&with, "polish.grains_inward"),
        scalar(&with, "polish.grains_jammed"),
    );
    assert!(inward > 5000.0 && jammed > 500.0, "{inward} {jammed}");
    let (a, b) = (
        column(&plain, "polish.normal_force"),
        column(&with, "polish.normal_force"),
    );
    assert!((mean(b) / mean(a) - 1.0).abs() < 0.01);
    let extra = mean(column(&with, "polish.grain_force_z"));
    assert!(extra.abs() < 0.01 * mean(a), "{extra}");
    // What jams drags the edge y = 0 along with it.
    let pushed = column(&with, "polish.grain_force_y");
    let rows = first_line(&with);
    assert!(rows.iter().map(|row| pushed[*row]).sum::<f64>() > 0.0);
    let outward = along(&[("spin_rpm", "-1000")], GRAINS);
    let (jammed, rows) = (
        column(&outward, "polish.grains_jammed"),
        first_line(&outward),
    );
    let met = jammed[rows[rows.len() - 1]] - jammed[rows[0]];
    assert_eq!(met, 0.0, "outward over the first edge");
    assert!(scalar(&outward, "polish.grains_outward") > 5000.0);
}

#[test]
fn rounded_edges_are_silent_and_jams_round_them() {
    let sharp = along(&[], GRAINS);
    let round = along(&[("grains.edge_radius_um", "120")], GRAINS);
    assert_eq!(scalar(&round, "polish.grains_jammed"), 0.0);
    assert_eq!(scalar(&round, "polish.edge_chipped_volume"), 0.0);
    let (mean_m, largest_m) = (
        scalar(&sharp, "polish.edge_radius_mean"),
        scalar(&sharp, "polish.edge_radius_largest"),
    );
    assert!(mean_m > 5e-6 && largest_m > 1.2 * mean_m && largest_m < 60e-6);
    let chip_m3 = 0.04 * 40e-6 / 10e9;
    let expected = scalar(&sharp, "polish.grains_jammed") * chip_m3;
    assert!((scalar(&sharp, "polish.edge_chipped_volume") / expected - 1.0).abs() < 1e-6);
    let force = |of: &Recording| scalar(of, "polish.grain_force");
    assert!(force(&sharp) > 1.5 * force(&round));
}

/// Half the step moves force from above the step into it; both together stay, and so does what
/// jams.
#[test]
fn verify_the_level_in_all_does_not_depend_on_the_step() {
    let level = |step: &str| {
        let recording = run_at(step);
        let parts = ["polish.grain_force", "polish.grain_force_above_step"]
            .map(|name| scalar(&recording, name));
        (
            parts,
            parts[0].hypot(parts[1]),
            scalar(&recording, "polish.jammed_share"),
        )
    };
    let (coarse, fine) = (level("0.2"), level("0.05"));
    assert!(fine.0[0] > coarse.0[0] && fine.0[1] < coarse.0[1]);
    assert!(
        (fine.1 / coarse.1 - 1.0).abs() < 0.03,
        "{coarse:?} {fine:?}"
    );
    assert!(
        (fine.2 / coarse.2 - 1.0).abs() < 0.05,
        "{coarse:?} {fine:?}"
    );
}

fn run_at(step_ms: &str) -> Recording {
    // The radius stays, so that both runs meet the same edge.
    let whole = GRAINS.to_owned() + "ploughing_um = 0\n";
    let text = super::support::with_step(&whole, step_ms);
    let overrides = super::shared::below("process.polish", &ALONG_AN_EDGE);
    super::shared::run_with(&super::shared::scenario(&text), &overrides)
}

#[test]
fn seeds_decide_and_grains_without_an_edge_change_no_bit() {
    let runs =
        ["1", "1", "2"].map(|seed| along(&[("grains.seed", seed)], &format!("{GRAINS}seed = 1\n")));
    assert_eq!(runs[0].columns, runs[1].columns);
    assert_ne!(runs[0].columns, runs[2].columns);
    let (plain, grains) = (run(&[]), run_with_tables(GRAINS, &[]));
    for channel in &plain.header.channels {
        assert_eq!(
            column(&plain, &channel.name),
            column(&grains, &channel.name),
            "{}",
            channel.name
        );
    }
}

/// The indentation follows the texture, which comes round with every turn of the wheel.
#[test]
fn verify_texture_comes_round_with_the_wheel() {
    let tables = "\n[process.polish.texture]\nrms_um = 20\nlength_mm = 6\n";
    // an axis that leans steadily: a precession carries the patch around the wheel
    let steady = [("precession.turn_rpm", "0.001")];
    let (plain, uneven) = (run(&steady), run_with_tables(tables, &steady));
    let depth = |of: &Recording| column(of, "polish.indentation").to_vec();
    let (a, b) = (depth(&plain), depth(&uneven));
    // rows of a turn at 1000 rpm
    let turn = (0.06 / (plain.time_s[1] - plain.time_s[0])).round() as usize;
    let off: Vec<f64> = b.iter().zip(&a).map(|(b, a)| b - a).skip(1000).collect();
    let square = |of: &mut dyn Iterator<Item = f64>| of.map(|x| x * x).sum::<f64>();
    let all = square(&mut off.iter().copied());
    let round = square(&mut off.windows(turn + 1).map(|w| w[turn] - w[0]));
    let half = square(&mut off.windows(turn / 2 + 1).map(|w| w[turn / 2] - w[0]));
    assert!(
        round < 0.1 * all && half > 5.0 * round,
        "{turn}: {round} {half} {all}"
    );
    let rms = (all / off.len() as f64).sqrt();
    assert!(rms > 4e-6 && rms < 30e-6, "{rms}");
}
