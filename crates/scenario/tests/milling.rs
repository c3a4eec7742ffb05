//! The milling table: what arrives, what is refused.

use std::f64::consts::{FRAC_PI_2, PI};
use std::path::Path;

use truecut_arm::{Elbow, Shoulder};
use truecut_core::cutting::milling::engagement::Engagement;
use truecut_scenario::{MillingSpec, ProcessSpec, Scenario, TurnKnot};

const TEXT: &str = include_str!("slot.toml");

/// A folder of the repository from which material files are reached.
fn place() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/arm/slot.toml")
}

fn milling(text: &str) -> MillingSpec {
    let scenario = Scenario::from_str(&place(), text, &[]).unwrap_or_else(|e| panic!("{e}"));
    match scenario.process {
        ProcessSpec::Milling(milling) => *milling,
        other => panic!("not milling but {}", other.name()),
    }
}

/// The only problem of the text in which `from` is replaced by `to`.
fn fault(from: &str, to: &str) -> String {
    let text = TEXT.replacen(from, to, 1);
    assert_ne!(text, TEXT, "\"{from}\" is not in the scenario");
    let error = Scenario::from_str(&place(), &text, &[]).expect_err("accepted");
    let problems: Vec<_> = error.problems().collect();
    let [problem] = &problems[..] else {
        panic!("{problems:?}")
    };
    problem.message.clone()
}

#[test]
fn every_quantity_arrives_in_si() {
    let spec = milling(TEXT);
    assert!((spec.spindle_rad_s - 80.0 * PI).abs() < 1e-12);
    let cut = &spec.cut;
    assert_eq!((spec.feed_m_per_s, cut.axial_depth_m), (0.016, 3e-4));
    assert_eq!(cut.engagement, Engagement::down(0.01, 0.02).unwrap());
    assert!(spec.regeneration && spec.lead_in_m.is_none());
    assert_eq!((cut.cutter.radius_m, cut.cutter.teeth), (0.01, 4));
    assert_eq!(cut.cutter.helix_angle_rad, 30_f64.to_radians());
    assert_eq!(cut.cutter.runout.offset_m, 5e-6);
    assert_eq!(cut.cutter.runout.angle_rad, FRAC_PI_2);
    assert_eq!(cut.coefficients.tangential_pa, 2e9);
    assert_eq!(cut.coefficients.edge_tangential_n_per_m, 2e4);
    let start = spec.path.start.as_ref().unwrap();
    assert_eq!(start.point_m, [1.05, -1.45, 0.87]);
    assert_eq!(start.tool_axis, [0.0, 0.0, -1.0]);
    assert_eq!(start.turn[0].redundancy_rad, 120_f64.to_radians());
    assert_eq!(
        (start.shoulder, start.elbow),
        (Some(Shoulder::Front), Some(Elbow::Upper))
    );
    assert_eq!(spec.path.direction, [1.0, 0.0, 0.0]);
}

/// Four teeth at 2400 rpm: 6.25 ms from tooth to tooth, 0.1 mm of feed at 16 mm/s; 300 mm take
/// 18.75 s. Half immersion in down-milling: 90 to 180 degrees.
#[test]
fn verify_times_and_angles_of_a_pass() {
    let spec = milling(TEXT);
    assert!((spec.tooth_period_s() - 6.25e-3).abs() < 1e-15);
    assert!((spec.cut.feed_per_tooth_m - 1e-4).abs() < 1e-15);
    assert!((spec.pass_s() - 18.75).abs() < 1e-12);
    let angles = spec.cut.engagement;
    assert!((angles.entry_rad - FRAC_PI_2).abs() < 1e-15 && angles.exit_rad == PI);
    let per_tooth = TEXT.replace("feed_mm_per_s = 16", "feed_mm_per_tooth = 0.1");
    assert!((milling(&per_tooth).feed_m_per_s - 0.016).abs() < 1e-15);
}

#[test]
fn coefficients_come_from_a_material_file() {
    let inline = "[process.milling.cutting]\ntangential_mpa = 2000\nradial_mpa = 600\nedge_tangential_n_per_mm = 20\n";
    let from = |table: &str| TEXT.replace(inline, table);
    let table = |file: &str, set: &str| {
        format!("[process.milling.material]\nfile = \"../../assets/materials/{file}.toml\"\n{set}")
    };
    let spec = milling(&from(&table("al7075_t6", "set = \"al7075_767\"")));
    let k = spec.cut.coefficients;
    assert_eq!(
        (k.tangential_pa, k.radial_pa, k.axial_pa),
        (767e6, 168.8e6, 222e6)
    );
    assert_eq!(
        (k.edge_tangential_n_per_m, k.edge_radial_n_per_m),
        (27.7e3, 26.6e3)
    );
    assert_eq!(
        milling(&from(&table("al6061", "")))
            .cut
            .coefficients
            .tangential_pa,
        243.8e6
    );

    let refused = |table: &str| {
        let error = Scenario::from_str(&place(), &from(table), &[]).expect_err("accepted");
        let problem = error.problems().next().expect("one").clone();
        format!("{} {}", problem.message, problem.help.unwrap_or_default())
    };
    let message = refused(&table("steel_46", ""));
    assert!(message.contains("cannot read material") && message.contains("steel_45.toml"));
    let message = refused(&table("steel_45", ""));
    assert!(message.contains("missing key `set`") && message.contains("steel45_linear"));
    let message = refused(&table("steel_45", "set = \"steel46\""));
    assert!(
        message.contains("steel46") && message.contains("steel45_linear"),
        "{message}"
    );
    let message = refused("[process.milling.material]\nfile = \"../../Cargo.toml\"\n");
    assert!(message.contains("no material file"), "{message}");
    let message = refused("");
    assert!(
        message.contains("missing cutting force coefficients"),
        "{message}"
    );
}

/// Every material of the repository is readable by each of its sets.
#[test]
fn materials_of_the_repository_are_read() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/materials");
    let mut sets = 0;
    for entry in std::fs::read_dir(&folder).unwrap() {
        let file = entry.unwrap().path();
        let text = std::fs::read_to_string(&file).unwrap();
        for id in text.lines().filter_map(|line| line.strip_prefix("id = ")) {
            let overrides = [
                (
                    "process.milling.material.file".into(),
                    file.display().to_string(),
                ),
                (
                    "process.milling.material.set".into(),
                    id.trim_matches('"').into(),
                ),
            ];
            let inline = TEXT.find("[process.milling.cutting]").unwrap();
            let path = TEXT.find("[process.milling.path]").unwrap();
            let bare = format!("{}{}", &TEXT[..inline], &TEXT[path..]);
            Scenario::from_str(&place(), &bare, &overrides).unwrap_or_else(|e| panic!("{id}: {e}"));
            sets += 1;
        }
    }
    assert!(sets >= 10, "{sets}");
}

#[test]
fn what_cannot_be_cut_is_refused_with_value_and_rule() {
    for (from, to, expected) in [
        (
            "teeth = 4",
            "teeth = 0",
            "must be at least 1: a cutter has 1 to 64 teeth",
        ),
        (
            "radial_depth_mm = 10",
            "radial_depth_mm = 21",
            "is 21, but must be at most the cutter's diameter of 20 mm",
        ),
        (
            "radial_depth_mm = 10\n",
            "",
            "missing key `radial_depth_mm`",
        ),
        (
            "engagement = \"down\"",
            "engagement = \"slot\"",
            "`process.milling.radial_depth_mm` has no effect",
        ),
        ("feed_mm_per_s = 16\n", "", "missing key `feed_mm_per_s`"),
        (
            "feed_mm_per_s = 16",
            "feed_mm_per_s = 320.1",
            "a tenth of the diameter",
        ),
        (
            "feed_mm_per_s = 16",
            "feed_mm_per_s = 16\nfeed_mm_per_tooth = 0.1",
            "`process.milling.feed_mm_per_tooth` has no effect",
        ),
        (
            "runout_um = 5",
            "runout_um = 5000",
            "less than half the cutter's radius",
        ),
        (
            "runout_um = 5\n",
            "",
            "`process.milling.cutter.runout_angle_deg` has no effect",
        ),
        (
            "end_mm = [1350, -1450, 870]",
            "end_mm = [1350, -1450, 880]",
            "degrees out of the plane across the tool axis",
        ),
        (
            "end_mm = [1350, -1450, 870]",
            "end_mm = [1050, -1450, 870]",
            "it has no length",
        ),
        (
            "end_mm = [1350, -1450, 870]",
            "direction = [1, 0, 0]",
            "missing key `length_mm`",
        ),
        (
            "end_mm = [1350, -1450, 870]",
            "end_mm = [1350, -1450, 870]\nlength_mm = 3",
            "`process.milling.path.length_mm` has no effect",
        ),
        ("redundancy_deg = 120\n", "", "missing key `redundancy_deg`"),
        (
            "redundancy_deg = 120",
            "redundancy_deg = 120\nzero_direction = [0, 0, 2]",
            "is along the tool axis",
        ),
        (
            "redundancy_deg = 120",
            "redundancy_deg = 120\ntool_axis = [0, 0, 0]",
            "it is a direction",
        ),
        (
            "axial_depth_mm = 0.3",
            "axial_depth_mm = 0.3\nlead_in_mm = 300",
            "must be before the path's end at 300 mm",
        ),
        (
            "[process.milling]",
            "[run]\nduration_s = 20\n[process.milling]",
            "ends after 18.75 s",
        ),
    ] {
        let message = fault(from, to);
        assert!(message.contains(expected), "{to}: {message}");
    }
    let between = "engagement = \"between\"\nentry_deg = 90\nexit_deg = 60";
    let message = fault("engagement = \"down\"\nradial_depth_mm = 10", between);
    assert!(
        message.contains("must be greater than entry_deg = 90"),
        "{message}"
    );
}

/// Angles rest at their knots and pass half way between them at half the angle.
#[test]
fn verify_redundancy_angles_along_a_path() {
    let turn = "turn = [{ at_mm = 0, redundancy_deg = 60 }, { at_mm = 100, redundancy_deg = 40 }]";
    let spec = milling(&TEXT.replace("redundancy_deg = 120", turn));
    let start = spec.path.start.unwrap();
    let at = |mm: f64| start.redundancy_rad(mm * 1e-3).to_degrees();
    assert_eq!(
        start.turn[1],
        TurnKnot {
            at_m: 0.1,
            redundancy_rad: 40_f64.to_radians()
        }
    );
    for (mm, deg) in [
        (-5.0, 60.0),
        (0.0, 60.0),
        (50.0, 50.0),
        (100.0, 40.0),
        (300.0, 40.0),
    ] {
        assert!((at(mm) - deg).abs() < 1e-9, "{mm}: {}", at(mm));
    }
    assert!((at(1e-3) - 60.0).abs() < 1e-7 && (at(99.999) - 40.0).abs() < 1e-7);
    let falling = turn.replace("at_mm = 100", "at_mm = 0");
    assert!(
        fault("redundancy_deg = 120", &falling).contains("must be greater than the one before")
    );
    let beyond = turn.replace("at_mm = 100", "at_mm = 400");
    assert!(fault("redundancy_deg = 120", &beyond).contains("path's length of 300 mm"));
}

#[test]
fn a_path_may_start_at_the_robots_posture() {
    let path = TEXT.find("[process.milling.path]").unwrap();
    let text = format!(
        "{}[process.milling.path]\ndirection = [0, 3, 0]\nlength_mm = 50\n",
        &TEXT[..path]
    );
    let spec = milling(&text);
    assert_eq!(spec.path.start, None);
    assert_eq!(spec.path.direction, [0.0, 1.0, 0.0]);
    let scenario = Scenario::from_str(&place(), &format!("{text}redundancy_deg = 3\n"), &[]);
    let message = scenario.expect_err("accepted").to_string();
    assert!(
        message.contains("`process.milling.path.redundancy_deg` has no effect"),
        "{message}"
    );
}
