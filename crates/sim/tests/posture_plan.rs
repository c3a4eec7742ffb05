//! The planner's word against the simulator: the published path of 0.3 m in 45 steel at 600 rpm,
//! each segment milled in rapier at the planned angle and at a constant 120 degrees.
//!
//! A run is 5 s about the midpoint of a segment. What the planner calls stable must die away, what
//! it calls unstable must grow, and each at the rate of semi-discretisation with the floor. At the
//! scenario's feed 120 degrees chatter in the first half of the path and are marginal in the
//! second; at a tenth of it the floor, which grows with the feed, hardly matters, and they chatter
//! all along.

use std::path::{Path, PathBuf};

use rayon::prelude::*;
use truecut_arm::{ArmBranch, OpwGeometry};
use truecut_core::chatter::spectral_elements::SpectralElements;
use truecut_plan::{Criterion, Plan, PlanPoint, Planner, PlannerOptions, Stability};
use truecut_recording::Outcome;
use truecut_scenario::{PathStart, PlannedPath, Scenario, TurnKnot};
use truecut_sim::run::{Claims, Run};
use truecut_sim::stability::MillingStudy;

const SLOW_MM_PER_TOOTH: f64 = 0.01;
const FULL_MM_PER_TOOTH: f64 = 0.1;
/// Path of a run per feed: 5 s at 40 teeth a second.
const TEETH: f64 = 200.0;
/// What a growth rate may be off, 1/s: a tenth of what the floor does at the full feed.
const RATE_PER_S: f64 = 0.09;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/milling")
}

fn shipped(feed_mm_per_tooth: f64) -> Scenario {
    let path = folder().join("path_600.toml");
    let feed = "process.milling.feed_mm_per_tooth".to_owned();
    let changed = [(feed, format!("{feed_mm_per_tooth:?}"))];
    Scenario::load(&path, &changed).unwrap_or_else(|e| panic!("{e:?}"))
}

fn read(text: &str) -> Scenario {
    Scenario::from_str(&folder().join("planned.toml"), text, &[])
        .unwrap_or_else(|e| panic!("{e:?}\n{text}"))
}

/// The point of a plan at a place.
fn point(plan: &Plan, along_m: f64) -> &PlanPoint {
    let off = |p: f64| (p - along_m).abs();
    let nearest = plan.points.iter();
    let nearest = nearest.min_by(|a, b| off(a.along_m).total_cmp(&off(b.along_m)));
    nearest.expect("points")
}

/// The plan by regeneration, and the scenario's own path at a constant 120 degrees.
fn plans(study: &MillingStudy) -> [Plan; 2] {
    let options = PlannerOptions {
        branch: study.branch(),
        ..PlannerOptions::default()
    };
    let planner = Planner::new(&study.robot, &study.path, &study.cut, &options).expect("in reach");
    let plan = planner.plan(Criterion::Regenerative).expect("a plan");
    let own = study.postures().unwrap_or_else(|e| panic!("{e}"));
    let angle = |at_m| study.angle_rad(at_m);
    let constant = planner
        .at_postures(Criterion::Regenerative, &angle, &|at_m| own.posture(at_m))
        .expect("modes");
    [plan, constant]
}

/// The scenario on 5 s of path about a place, at the plan's angle and branch there.
fn about(scenario: &Scenario, study: &MillingStudy, plan: &Plan, along_m: f64) -> Scenario {
    let point = point(plan, along_m);
    let length_m = TEETH * study.cut.nominal.feed_per_tooth_m;
    let from_m = point.along_m - 0.5 * length_m;
    let start = PathStart {
        point_m: study.path.point_m(from_m).into(),
        turn: vec![TurnKnot {
            at_m: 0.0,
            redundancy_rad: point.angle_rad,
        }],
        ..study.planned(plan).start
    };
    let part = PlannedPath {
        start,
        end_m: study.path.point_m(from_m + length_m).into(),
        posture_rad: point.posture.clone(),
    };
    read(&scenario.planned_text(&folder(), &part))
}

/// Growth rate by semi-discretisation at the plan's posture and the scenario's depth, 1/s, without
/// and with the floor's feedback.
fn theory(study: &MillingStudy, plan: &Plan, along_m: f64) -> [f64; 2] {
    let posture = &point(plan, along_m).posture;
    let modes = study.modes(posture).unwrap_or_else(|e| panic!("{e}"));
    let period_s = study.cut.tooth_period_s();
    let without = SpectralElements::new(&modes, &study.cut.directional());
    let with = without.clone().with_floor(&study.cut.nominal);
    let depth_m = study.cut.nominal.axial_depth_m;
    [without, with].map(|prepared| {
        let multiplier = prepared.at(period_s).multiplier(depth_m);
        multiplier.growth_per_s(period_s)
    })
}

/// Growth rate of a run, 1/s.
fn milled(scenario: &Scenario) -> f64 {
    let run = Run {
        claims: Claims::Ignore,
        ..Run::of(scenario)
    };
    let recording = run.execute().unwrap_or_else(|e| panic!("{e}")).recording;
    assert_eq!(recording.outcome, Outcome::Completed);
    let found = recording.scalar("milling.growth_rate");
    found.expect("a growth rate").value
}

/// Mills every segment at the planned angle and at 120 degrees and holds each run against the
/// planner and the theory. Gives what the planner says of the segments at 120 degrees.
fn hold_segments_against_theory(feed_mm_per_tooth: f64) -> Vec<Stability> {
    let scenario = shipped(feed_mm_per_tooth);
    let study = MillingStudy::of(&scenario).unwrap_or_else(|e| panic!("{e}"));
    let [plan, constant] = plans(&study);
    assert!(plan.points.iter().all(|p| p.assessment.margin > 0.6));
    assert!(
        plan.points
            .iter()
            .all(|p| p.assessment.decay_per_s() > Some(1.3))
    );
    let segments = plan.segments.par_iter().map(|segment| {
        let at = segment.midpoint_m();
        for plan in [&plan, &constant] {
            let growth = milled(&about(&scenario, &study, plan, at));
            let [without, with] = theory(&study, plan, at);
            println!(
                "{at:.3} m: {growth:.3} 1/s; theory {with:.3}, without the floor {without:.3}"
            );
            assert!(
                (growth - with).abs() < RATE_PER_S,
                "{at} m: {growth} {with}"
            );
            match point(plan, at).assessment.stability() {
                Stability::Stable => assert!(growth < 0.0, "{at} m: {growth} 1/s"),
                Stability::Unstable => assert!(growth > 0.0, "{at} m: {growth} 1/s"),
                Stability::Marginal => {}
            }
            if feed_mm_per_tooth == FULL_MM_PER_TOOTH {
                assert!((growth - without).abs() > 0.1, "{at} m: {growth} {without}");
            }
        }
        point(&constant, at).assessment.stability()
    });
    segments.collect()
}

#[test]
fn verify_every_segment_is_as_stable_in_rapier_as_planned() {
    use Stability::{Marginal, Unstable};
    let constant = hold_segments_against_theory(FULL_MM_PER_TOOTH);
    assert_eq!(constant, [[Unstable; 3], [Marginal; 3]].concat());
}

#[test]
fn verify_every_segment_at_a_tenth_of_the_feed() {
    let constant = hold_segments_against_theory(SLOW_MM_PER_TOOTH);
    assert!(
        constant.iter().all(|found| *found == Stability::Unstable),
        "{constant:?}"
    );
}

/// The plan as a scenario: read back, it asks for the plan's postures, whole turns included, and
/// starts there.
#[test]
fn a_written_plan_is_the_plan() {
    let scenario = shipped(SLOW_MM_PER_TOOTH);
    let study = MillingStudy::of(&scenario).unwrap_or_else(|e| panic!("{e}"));
    let options = PlannerOptions {
        branch: study.branch(),
        near: study.near(),
        ..PlannerOptions::default()
    };
    let planner = Planner::new(&study.robot, &study.path, &study.cut, &options).expect("in reach");
    let plan = planner.plan(Criterion::ModeCoupling).expect("a plan");
    let text = scenario.planned_text(&folder(), &study.planned(&plan));
    let planned = read(&text);
    let again = MillingStudy::of(&planned).unwrap_or_else(|e| panic!("{e}"));
    let asked = again.branch();
    assert_eq!(asked.shoulder, Some(plan.family.shoulder));
    assert_eq!(asked.elbow, Some(plan.family.elbow));
    let path = again.postures().unwrap_or_else(|e| panic!("{e}"));
    for point in &plan.points {
        let angle = again.angle_rad(point.along_m);
        assert!(
            (angle - point.angle_rad).abs() < 1e-9,
            "{angle} {}",
            point.angle_rad
        );
        let found = path.posture(point.along_m);
        let found = found.iter().zip(&point.posture);
        let off = found.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-6, "{off} rad at {} m", point.along_m);
    }
    // All else is as it was, comments too.
    assert!(text.starts_with("# The published path") && text.contains("spindle_rpm = 600"));
    assert!(!text.contains("redundancy_deg = 120") && !text.contains("data ="));
}

/// Each word for a branch acts without the others: candidates are those that it allows, all of
/// them, and the scenario's own path takes it.
#[test]
fn each_word_for_a_branch_acts_alone() {
    let text = std::fs::read_to_string(folder().join("path_600.toml")).expect("shipped");
    let bare = text.replace("shoulder = \"front\"\nelbow = \"upper\"\n", "");
    assert_ne!(bare, text);
    let study = |words: &str| {
        let angle = "redundancy_deg = 120\n";
        let scenario = read(&bare.replace(angle, &format!("{angle}{words}")));
        MillingStudy::of(&scenario).unwrap_or_else(|e| panic!("{e}"))
    };
    let candidates = |study: &MillingStudy| -> Vec<ArmBranch> {
        let options = PlannerOptions {
            branch: study.branch(),
            angle_step_rad: 0.2,
            ..PlannerOptions::default()
        };
        let planner = Planner::new(&study.robot, &study.path, &study.cut, &options);
        let planner = planner.unwrap_or_else(|e| panic!("{e}"));
        let cells = planner.reach().columns.iter().flat_map(|c| &c.cells);
        cells.flatten().map(|c| c.branch).collect()
    };
    let free = study("");
    let any = candidates(&free);
    let mut chosen = 0;
    for words in [
        "elbow = \"upper\"\n",
        "elbow = \"lower\"\n",
        "shoulder = \"front\"\n",
        "wrist = \"positive\"\n",
        "wrist = \"negative\"\n",
    ] {
        let wish = study(words).branch();
        let allowed: Vec<_> = any.iter().copied().filter(|b| wish.allows(*b)).collect();
        if allowed.is_empty() {
            continue;
        }
        chosen += usize::from(allowed.len() < any.len());
        let asked = study(words);
        assert_eq!(candidates(&asked), allowed, "{words}");
        let own = asked.postures().unwrap_or_else(|e| panic!("{words}: {e}"));
        let geometry = OpwGeometry::of(&asked.robot).expect("a spherical wrist");
        assert!(own.knots.iter().all(|q| wish.allows(geometry.branch(q))));
    }
    assert!(chosen >= 2, "{chosen} words choose");
}
