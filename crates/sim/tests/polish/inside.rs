//! Away from edges: closed forms hold.

use super::shared::{SPRUNG, column, mean, scalar};
use super::support::{WHEEL, run, run_under};

/// What is pressed is the wheel's law at the indentation that the arm leaves; friction is Coulomb's
/// and turns with the precession; the arm yields by what the commanded indentation lacks.
#[test]
fn the_run_applies_the_wheel_s_law_and_coulomb_s() {
    let recording = run(&[]);
    let normal = column(&recording, "polish.normal_force");
    let depth = column(&recording, "polish.indentation");
    let friction = ["polish.friction_x", "polish.friction_y"].map(|name| column(&recording, name));
    let lean = column(&recording, "polish.precession_angle");
    assert!(normal.len() > 3000);
    for row in (0..normal.len()).step_by(97) {
        // quadrature of the patch
        assert!(
            (normal[row] / WHEEL.normal_force_n(depth[row]) - 1.0).abs() < 1e-3,
            "{row}"
        );
        let size = friction[0][row].hypot(friction[1][row]);
        assert!(
            size < 0.3 * normal[row] && size > 0.25 * normal[row],
            "{row}: {size}"
        );
        // the middle slides a quarter of a turn ahead of the lean
        let ahead = friction[1][row].atan2(friction[0][row]) - lean[row];
        assert!((ahead.sin() - 1.0).abs() < 0.02, "{row}: {ahead}");
    }
    assert!(
        column(&recording, "polish.edge_force")
            .iter()
            .all(|force| *force == 0.0)
    );
    let lacking = 0.6e-3 - mean(depth);
    assert!(lacking > 2e-6 && lacking < 60e-6, "{lacking}");
}

/// The arm starts at rest in contact: the force begins without a jump and follows what the lead-in
/// asks of the arm.
#[test]
fn the_start_is_at_rest() {
    let recording = run(&[("precession.turn_rpm", "1")]);
    let normal = column(&recording, "polish.normal_force");
    let change = |rows: std::ops::Range<usize>| {
        let changes = normal[rows].iter().map(|n| (n / normal[0] - 1.0).abs());
        changes.fold(0.0, f64::max)
    };
    assert!(change(0..5) < 2e-4, "{}", change(0..5));
    assert!(change(0..100) < 2e-2, "{}", change(0..100));
}

/// Preston: the volume on the grid is the integral of the patch, on any grid; the volume is
/// `k_p ∫ F v dt`, v the mean sliding over the patch, between that of the middle and 1.2 times it.
#[test]
fn verify_removed_volume_is_prestons_integral_on_two_grids() {
    let volumes = ["0.5", "1.0"].map(|cell| {
        let recording = run(&[("face.cell_mm", cell)]);
        let volume = scalar(&recording, "polish.removed_volume");
        assert!((volume / scalar(&recording, "polish.preston_volume") - 1.0).abs() < 1e-9);
        let normal = column(&recording, "polish.normal_force");
        let time = recording.time_s[recording.time_s.len() - 1];
        let lever = 19.4e-3 * 20f64.to_radians().sin();
        let middle = 4e-12 * mean(normal) * 1000.0 * std::f64::consts::TAU / 60.0 * lever * time;
        assert!(
            volume > middle && volume < 1.2 * middle,
            "{volume} {middle}"
        );
        volume
    });
    assert!((volumes[0] / volumes[1] - 1.0).abs() < 1e-6);
}

/// The middle of the wheel runs around the spin axis: the part along the normal is `e sin θ` at
/// spin frequency. At 40 Hz, between modes at 28 and 62 Hz, the arm, some fifty times as stiff as
/// the wheel, answers by a few percent of it.
#[test]
fn verify_eccentric_wheel_swings_the_indentation() {
    let hz = 40.0;
    let swing = |eccentricity: &str| {
        let recording = run(&[("spin_rpm", "2400"), ("eccentricity_um", eccentricity)]);
        let depth = column(&recording, "polish.indentation");
        // Whole turns in the middle of the last line.
        let rows = depth.len() - 901..depth.len() - 301;
        let level = mean(&depth[rows.clone()]);
        let (mut sine, mut cosine) = (0.0, 0.0);
        for row in rows.clone() {
            let (s, c) = (recording.time_s[row] * hz * std::f64::consts::TAU).sin_cos();
            sine += (depth[row] - level) * s * 2.0 / rows.len() as f64;
            cosine += (depth[row] - level) * c * 2.0 / rows.len() as f64;
        }
        sine.hypot(cosine)
    };
    let (none, some) = (swing("0"), swing("50"));
    let expected = 50e-6 * 20f64.to_radians().sin();
    assert!((some / expected - 1.0).abs() < 0.15, "{some} {expected}");
    assert!(none < 0.05 * expected, "{none}");
}

/// A carrier holds the force that is asked for; the arm's own motion is taken up.
#[test]
fn force_control_holds_the_force() {
    let held = run_under(
        "law = \"constant_force\"\nforce_n = 4\ndamping_n_s_per_mm = 0.2\nfastest_mm_per_s = 20\n",
    );
    let force = &column(&held, "polish.normal_force")[500..];
    assert!((mean(force) / 4.0 - 1.0).abs() < 2e-3, "{}", mean(force));
    let sprung = run_under(SPRUNG);
    let (force, offset) = ("polish.normal_force", "polish.carrier_offset");
    let (force, offset) = (
        &column(&sprung, force)[500..],
        &column(&sprung, offset)[500..],
    );
    // at rest on the mean: F = F0 - k x
    let balance = mean(force) - 4.0 + 200.0 * mean(offset);
    assert!(balance.abs() < 0.01, "{balance}");
    assert!((mean(force) / 4.0 - 1.0).abs() < 0.05, "{}", mean(force));
}
