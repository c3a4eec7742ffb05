//! The planner's word against the simulator: the published path of 0.3 m in 45 steel at 600 rpm, each segment milled in rapier
//! at the planned angle and at a constant 120 degrees.
//!
//! A run is 5 s about the midpoint of a segment, 20 mm of path. What the planner calls stable must die away, what it calls
//! unstable must grow. Margins of the plan are above 80 %, those of the constant angle below −25 %, so that the nearness of a
//! limit decides nothing.

use std::path::{Path, PathBuf};

use rayon::prelude::*;
use truecut_plan::{Criterion, Plan, Planner, PlannerOptions};
use truecut_recording::Outcome;
use truecut_scenario::{PlannedPath, Scenario, TurnKnot};
use truecut_sim::Cell;
use truecut_sim::stability::MillingStudy;

const LENGTH_M: f64 = 0.02;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/milling")
}

fn shipped() -> Scenario {
    let path = folder().join("path_600.toml");
    Scenario::load(&path, &[]).unwrap_or_else(|e| panic!("{e:?}"))
}

fn read(text: &str) -> Scenario {
    Scenario::from_str(&folder().join("planned.toml"), text, &[])
        .unwrap_or_else(|e| panic!("{e:?}\n{text}"))
}

/// The scenario on `LENGTH_M` of path about a point of a plan, at that point's angle and branch.
fn about(scenario: &Scenario, study: &MillingStudy, plan: &Plan, along_m: f64) -> Scenario {
    let places = plan.points.iter();
    let off = |p: f64| (p - along_m).abs();
    let point = places
        .min_by(|a, b| off(a.along_m).total_cmp(&off(b.along_m)))
        .expect("points");
    let from_m = (point.along_m - 0.5 * LENGTH_M).max(0.0);
    let part = PlannedPath {
        start_m: study.path.point_m(from_m).into(),
        end_m: study.path.point_m(from_m + LENGTH_M).into(),
        turn: vec![TurnKnot {
            at_m: 0.0,
            redundancy_rad: point.angle_rad,
        }],
        posture_rad: point.posture.clone(),
        ..study.planned(plan)
    };
    read(&scenario.planned_text(&folder(), &part))
}

/// Growth rate of a run, 1/s, and its vibration beside the feed per tooth.
fn milled(scenario: &Scenario, study: &MillingStudy) -> (f64, f64) {
    let cell = Cell::build(scenario).unwrap_or_else(|e| panic!("{e}"));
    let end = cell.run_rows(|_, _| {});
    assert_eq!(end.outcome, Outcome::Completed);
    let value = |name: &str| {
        let found = end.scalars.iter().find(|s| s.name == name);
        found.unwrap_or_else(|| panic!("no scalar {name}")).value
    };
    let level = value("milling.vibration_level") / study.cut.nominal.feed_per_tooth_m;
    (value("milling.growth_rate"), level)
}

#[test]
fn verify_every_segment_is_as_stable_in_rapier_as_planned() {
    let scenario = shipped();
    let study = MillingStudy::of(&scenario).unwrap_or_else(|e| panic!("{e}"));
    let options = PlannerOptions {
        family: study.family(),
        ..PlannerOptions::default()
    };
    let planner = Planner::new(&study.robot, &study.path, &study.cut, &options).expect("in reach");
    let plan = planner.plan(Criterion::Regenerative).expect("a plan");
    let constant = planner
        .constant_angle(Criterion::Regenerative, 120_f64.to_radians())
        .expect("in reach");
    assert!(plan.points.iter().all(|p| p.assessment.margin > 0.8));
    assert!(constant.points.iter().all(|p| p.assessment.margin < -0.25));
    plan.segments.par_iter().for_each(|segment| {
        let at = segment.midpoint_m();
        let (growth, level) = milled(&about(&scenario, &study, &plan, at), &study);
        assert!(
            growth.is_nan() || growth < 0.0,
            "planned, {at} m: {growth} 1/s"
        );
        assert!(level < 0.02, "planned, {at} m: {level} of the feed");
        let (growth, level) = milled(&about(&scenario, &study, &constant, at), &study);
        assert!(
            growth > 0.0,
            "constant, {at} m: {growth} 1/s, {level} of the feed"
        );
    });
}

/// The plan as a scenario: read back, it asks for the plan's postures, whole turns included, and starts there.
#[test]
fn a_written_plan_is_the_plan() {
    let scenario = shipped();
    let study = MillingStudy::of(&scenario).unwrap_or_else(|e| panic!("{e}"));
    let options = PlannerOptions {
        family: study.family(),
        near: study.near(),
        ..PlannerOptions::default()
    };
    let planner = Planner::new(&study.robot, &study.path, &study.cut, &options).expect("in reach");
    let plan = planner.plan(Criterion::ModeCoupling).expect("a plan");
    let text = scenario.planned_text(&folder(), &study.planned(&plan));
    let planned = read(&text);
    let again = MillingStudy::of(&planned).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(again.family(), Some(plan.family));
    let (spacing_m, postures) = again.postures().unwrap_or_else(|e| panic!("{e}"));
    for point in &plan.points {
        let angle = again.angle_rad(point.along_m);
        assert!(
            (angle - point.angle_rad).abs() < 1e-9,
            "{angle} {}",
            point.angle_rad
        );
        let k = (point.along_m / spacing_m).round();
        if (k * spacing_m - point.along_m).abs() < 1e-9 {
            let found = postures[k as usize].iter().zip(&point.posture);
            let off = found.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-6, "{off} rad at {} m", point.along_m);
        }
    }
    // All else is as it was, comments too.
    assert!(text.starts_with("# The published path") && text.contains("spindle_rpm = 600"));
    assert!(!text.contains("redundancy_deg = 120") && !text.contains("data ="));
}
