//! A wheel brush on the mould block, on the rig of three slides in rapier: force of the bristles,
//! friction, burr and radius of an edge.

#[path = "../support/halved.rs"]
mod halved;
use crate::support as shared;

use shared::{below, brush, column, run, run_with, scalar};
use std::f64::consts::{PI, TAU};
use std::path::Path;
use truecut_core::wheel::brush::Brush;
use truecut_core::wheel::edge_wear::EdgeWear;
use truecut_plan::surface::{Mesh, MeshUse};
use truecut_recording::{Outcome, Recording};
use truecut_scenario::effect::{Effect, EffectKind, Target};
use truecut_sim::run::Run;

const BRUSH: Brush = Brush {
    radius_m: 30e-3,
    width_m: 10e-3,
    bristles: 3000.0,
    bristle_diameter_m: 0.4e-3,
    free_length_m: 12e-3,
    youngs_modulus_pa: 3e9,
    mu: 0.3,
};
const SPIN_RAD_S: f64 = 2000.0 * TAU / 60.0;
const FEED_M_PER_S: f64 = 20e-3;
/// The face of the block, along world x.
const FACE_M: f64 = 0.38;
/// Its edge, along world z.
const EDGE_M: f64 = -0.05;

fn whole(kind: EffectKind, values: &[f64]) -> Effect {
    Effect {
        kind,
        target: Target::Whole,
        values: values.to_vec(),
    }
}

/// Bristles of a brush whose axis stands `height` over the face, one after another all around,
/// those that meet the face between the angles from the perpendicular.
fn bristle_by_bristle(brush: &Brush, height: f64, from: f64, to: f64) -> f64 {
    let count = 300_000;
    let each = brush.bristles / f64::from(count);
    let angles = (0..count).map(|k| TAU * (f64::from(k) + 0.5) / f64::from(count) - PI);
    let bristle = brush.bristle();
    angles
        .filter(|angle| (from..to).contains(angle) && angle.cos() > 0.0)
        .map(|angle| each * bristle.force_n(brush.radius_m - height / angle.cos()))
        .sum()
}

/// Rows at which the tool is fed along y.
fn fed(recording: &Recording) -> Vec<usize> {
    let speed = column(recording, "tool.velocity_y");
    let is_fed = |row: &usize| (speed[*row] / FEED_M_PER_S - 1.0).abs() < 1e-3;
    (0..speed.len()).filter(is_fed).collect()
}

#[test]
fn verify_a_face_bears_the_sum_of_its_bristles_and_drags_them() {
    let recording = run_with(&brush("over_face.csv", &[]), &[]);
    let x = column(&recording, "tool.position_x");
    let force = column(&recording, "brush.bristle_force");
    let friction = column(&recording, "brush.friction_force");
    let z = column(&recording, "tool.displacement_z");
    let rows = fed(&recording);
    assert!(rows.len() > 40, "{}", rows.len());
    for row in rows.into_iter().step_by(9) {
        let expected = bristle_by_bristle(&BRUSH, FACE_M - x[row], -PI, PI);
        let presses = force[row] / expected;
        assert!((presses - 1.0).abs() < 1e-3, "{row}: {presses}");
        // All tips run one way, nearly.
        let drags = friction[row] / (BRUSH.mu * force[row]);
        assert!(drags < 1.0 && drags > 0.98, "{row}: {drags}");
        // The tips run down, so that they are held back upwards, tool and all.
        assert!(z[row] > 0.0);
    }
    let turned = brush(
        "over_face.csv",
        &below("process.brush", &[("speed_rpm", "-2000")]),
    );
    let turned = run_with(&turned, &[]);
    let other = column(&turned, "tool.displacement_z");
    for row in fed(&turned).into_iter().step_by(9) {
        let mirrored = -other[row] / z[row];
        assert!((mirrored - 1.0).abs() < 1e-5, "{row}: {mirrored}");
    }
}

/// Over an edge whose second face runs along the bristles, only those on the first face press.
#[test]
fn verify_half_of_the_bristles_press_over_an_edge() {
    let recording = run_with(&brush("over_edge.csv", &[]), &[]);
    let x = column(&recording, "tool.position_x");
    let z = column(&recording, "tool.position_z");
    let force = column(&recording, "brush.bristle_force");
    let length = column(&recording, "brush.contact_length");
    for row in fed(&recording).into_iter().step_by(37) {
        let height = FACE_M - x[row];
        // Angles turn towards the tool's x axis, which points down; the face is above the edge.
        let edge = ((z[row] - EDGE_M) / height).atan();
        let expected = bristle_by_bristle(&BRUSH, height, -PI, edge);
        let presses = force[row] / expected;
        assert!((presses - 1.0).abs() < 2e-3, "{row}: {presses}");
        assert!((length[row] - BRUSH.width_m).abs() < 0.26e-3);
    }
}

/// Every place of the edge is passed by the width of the brush at the feed: burr and radius are
/// those of the closed form for that dose.
#[test]
fn the_run_applies_edge_wear_to_its_dose() {
    let recording = run_with(&brush("over_edge.csv", &[]), &[]);
    let radius = |name: &str| {
        let profile = recording.profiles.iter().find(|p| p.name == name);
        profile.expect("a profile").clone()
    };
    let (radii, burrs) = (radius("brush.edge1.radius"), radius("brush.edge1.burr"));
    let x = column(&recording, "tool.position_x");
    let fed = fed(&recording);
    let mean_m = fed.iter().map(|row| x[*row]).sum::<f64>() / fed.len() as f64;
    let along_m = FACE_M - mean_m;
    let per_m2 = BRUSH.bristles / (TAU * along_m * BRUSH.width_m);
    let speed = (SPIN_RAD_S * along_m).hypot(FEED_M_PER_S);
    let time_s = BRUSH.width_m / FEED_M_PER_S;
    let dose = per_m2 * BRUSH.bristle().force_n(BRUSH.radius_m - along_m) * speed * time_s;
    let wear = EdgeWear {
        burr_height_m: 0.03e-3,
        burr_thickness_m: 0.04e-3,
        wedge_rad: 0.5 * PI,
        tip_m: BRUSH.bristle_diameter_m,
        preston_per_pa: 1e-10,
    };
    let expected = wear.radius_m(dose);
    assert!(expected > 0.05e-3);
    // Where the whole brush passed: 10 mm within the way of 30 mm; the edge is 60 mm long, its
    // middle at 0.
    let passed = radii.axis.iter().zip(&radii.values);
    let passed: Vec<f64> = passed
        .filter(|(along, _)| (**along - 30e-3).abs() < 8e-3)
        .map(|(_, radius)| *radius)
        .collect();
    assert!(passed.len() > 50);
    for radius in passed {
        assert!(
            (radius / expected - 1.0).abs() < 2e-3,
            "{radius} {expected}"
        );
    }
    // Where it never was, the burr is as it was.
    assert!((burrs.values[0] / wear.burr_height_m - 1.0).abs() < 1e-12);
    let burred = scalar(&recording, "brush.burred_length");
    assert!((burred - 20e-3).abs() < 4e-3, "{burred}");
}

/// An eccentric brush reaches further by C cos + S sin of its turning: its force is that of a brush
/// of this radius.
#[test]
fn the_run_applies_the_bristles_law_on_the_long_side() {
    let [c, s] = [0.2e-3, -0.1e-3];
    let with = run(
        &brush("over_face.csv", &[]),
        &[
            whole(EffectKind::WheelEccentricity, &[c, s]),
            whole(EffectKind::WheelStiffness, &[1.4]),
            whole(EffectKind::WheelFriction, &[0.5]),
        ],
    );
    let x = column(&with, "tool.position_x");
    let force = column(&with, "brush.bristle_force");
    let mut least_most = [f64::INFINITY, 0.0_f64];
    for row in fed_roughly(&with).into_iter().step_by(7) {
        let (sin, cos) = (SPIN_RAD_S * with.time_s[row]).sin_cos();
        let reaching = Brush {
            radius_m: BRUSH.radius_m + c * cos + s * sin,
            youngs_modulus_pa: 1.4 * BRUSH.youngs_modulus_pa,
            mu: 0.5 * BRUSH.mu,
            ..BRUSH
        };
        let expected = bristle_by_bristle(&reaching, FACE_M - x[row], -PI, PI);
        let presses = force[row] / expected;
        assert!((presses - 1.0).abs() < 1e-3, "{row}: {presses}");
        least_most = [least_most[0].min(expected), least_most[1].max(expected)];
    }
    assert!(least_most[1] > 1.2 * least_most[0]);
}

/// As [`fed`], where the tool shakes.
fn fed_roughly(recording: &Recording) -> Vec<usize> {
    let speed = column(recording, "tool.velocity_y");
    let is_fed = |row: &usize| (speed[*row] / FEED_M_PER_S - 1.0).abs() < 0.1;
    (0..speed.len()).filter(is_fed).collect()
}

#[test]
fn verify_removal_goes_with_its_factor_until_the_burr_is_gone() {
    let scenario = brush(
        "over_edge.csv",
        &below("process.brush", &[("preston_per_pa", "1e-12")]),
    );
    let nominal = run(&scenario, &[]);
    let more = run(&scenario, &[whole(EffectKind::WheelRemoval, &[1.25])]);
    let volume = |recording: &Recording| scalar(recording, "brush.removed_volume");
    assert!(volume(&nominal) > 0.0);
    assert!((volume(&more) / volume(&nominal) - 1.25).abs() < 1e-9);
}

/// Shorter bristles, pressed in as deep: in their law up to where a tip lies along the face, beyond
/// it the run says so.
#[test]
fn a_brush_that_is_pressed_beyond_its_bristles_law_leaves_the_model() {
    let nominal = run(&brush("over_face.csv", &[]), &[]);
    let pressed_mm = 12.0 * scalar(&nominal, "brush.largest_shortening");
    let lying = BRUSH.bristle().lying_m() / BRUSH.free_length_m;
    for share in [0.9, 1.1] {
        let free_length_mm = pressed_mm / (share * lying);
        let key = "process.brush.free_length_mm".to_owned();
        let scenario = brush("over_face.csv", &[(key, format!("{free_length_mm:?}"))]);
        let finished = Run::of(&scenario).execute().expect("a run");
        match finished.recording.outcome {
            Outcome::Completed => assert!(share < 1.0, "{share}"),
            Outcome::BeyondModel { value, limit, .. } => {
                assert!(share > 1.0, "{share}");
                assert!((limit / (1e-3 * free_length_mm * lying) - 1.0).abs() < 1e-12);
                assert!(
                    (value / limit / share - 1.0).abs() < 0.05,
                    "{value} {limit}"
                );
            }
            other => panic!("{other:?}"),
        }
    }
}

/// Half the step changes the mean radius by less than a thousandth, a quarter by less than a
/// quarter of that more.
#[test]
fn regress_the_time_step_hardly_shows() {
    let radius = |step_ms: &str| {
        let overrides = [("run.time_step_ms".to_owned(), step_ms.to_owned())];
        scalar(
            &run_with(&brush("over_edge.csv", &overrides), &[]),
            "brush.radius_mean",
        )
    };
    let [coarse, middle, fine] = ["1", "0.5", "0.25"].map(radius);
    assert!((coarse / fine - 1.0).abs() < 1e-3);
    assert!((middle - fine).abs() < 0.6 * (coarse - fine).abs() + 1e-9 * fine);
}

/// Three moves at the feed, on a clock with its ramps and the filter's window; it ends where it was
/// taught.
#[test]
fn verify_the_way_is_that_of_the_taught_postures() {
    let recording = run_with(&brush("over_face.csv", &[]), &[]);
    let way_m = 2.0 * 6.5e-3 + 6e-3;
    let expected_s = way_m / FEED_M_PER_S + 0.3 + 0.1;
    let last = recording.time_s.len() - 1;
    assert!((recording.time_s[last] - expected_s).abs() < 6e-3);
    let end =
        ["x", "y", "z"].map(|axis| column(&recording, &format!("tool.position_{axis}"))[last]);
    for (found, taught) in end.into_iter().zip([0.345, 0.003, 0.0]) {
        assert!((found - taught).abs() < 2e-6, "{found} {taught}");
    }
}

/// A block in 12 288 triangles presses as one in twelve, though its upper face, bulged by 1e-5 mm,
/// is one of many sides.
#[test]
fn verify_a_fine_mesh_presses_as_a_coarse_one() {
    let at = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/surfaces/mould_block.obj");
    let block = Mesh::load(&at, 1e-3, MeshUse::Body).expect("the asset");
    let folder = tempfile::tempdir().expect("a folder");
    let force = |halvings: usize| {
        let (text, triangles) = halved::halved(&block, halvings, 1e-5);
        assert_eq!(triangles, 12 * 4_usize.pow(halvings as u32));
        let file = folder.path().join(format!("{halvings}.obj"));
        std::fs::write(&file, text).expect("written");
        let mesh = format!("{:?}", file.to_str().expect("a name"));
        let mesh = below("process.brush", &[("workpiece.mesh", &mesh)]);
        let recording = run_with(&brush("over_edge.csv", &mesh), &[]);
        ["brush.bristle_force", "brush.friction_force"]
            .map(|name| column(&recording, name).to_vec())
    };
    for (coarse, fine) in force(0).iter().zip(&force(5)) {
        let most = coarse.iter().copied().fold(0.0, f64::max);
        assert!(most > 0.1);
        let off = coarse.iter().zip(fine).map(|(a, b)| (a - b).abs() / most);
        let off = off.fold(0.0, f64::max);
        assert!(off < 1e-3, "{off}");
    }
}

/// Under a plate of 2 mm bristles that are pressed in by 3 mm would reach its lower edge; its face
/// holds them. The last posture is the one before, as rounding may leave it.
#[test]
fn verify_a_hidden_edge_keeps_its_burr() {
    let over_plate = |place: &str, edge: &str| {
        let plate = [
            ("workpiece.mesh", "\"plate.obj\""),
            ("workpiece.xyz_mm", place),
            ("edge.0.points_mm", edge),
        ];
        run_with(
            &brush("over_plate.csv", &below("process.brush", &plate)),
            &[],
        )
    };
    let recording = over_plate("[382, -30, -50]", "[[0, 0, 0], [0, 60, 0]]");
    assert!(scalar(&recording, "brush.largest_force") > 1.0);
    let burred = scalar(&recording, "brush.burred_length");
    assert!((burred - 60e-3).abs() < 1e-12, "{burred}");
    assert_eq!(scalar(&recording, "brush.radius_largest"), 0.0);
    assert_eq!(scalar(&recording, "brush.removed_volume"), 0.0);
    // The upper edge is met where the brush hangs over it.
    let recording = over_plate("[382, -30, -40]", "[[0, 0, 2], [0, 60, 2]]");
    assert!(scalar(&recording, "brush.radius_largest") > 0.05e-3);
}
