//! Numbers set in memory: the same scenario as with overrides, and the same refusals.

use std::path::Path;

use truecut_scenario::{Scenario, ScenarioError, key_unit};

const TEXT: &str = include_str!("chamfer_d.toml");

const MORE: &str = r#"
[[effect]]
kind = "payload"
mass_kg = 1.0

[[effect]]
kind = "joint_backlash"
joint = 2
gap_rad = 1e-4

[[robot.link]]
name = "link_3"
mass_factor = 1.1

[[robot.joint]]
name = "joint_1"
"#;

fn scenario(more: &str) -> Scenario {
    let text = format!("{TEXT}{MORE}{more}");
    Scenario::from_str(Path::new("d.toml"), &text, &[]).unwrap_or_else(|e| panic!("{e:?}"))
}

fn written(key: &str, value_si: f64) -> (String, String) {
    let value = key_unit(key).from_si(value_si);
    (key.to_owned(), format!("{value:?}"))
}

fn assert_same(a: &Scenario, b: &Scenario, about: &str) {
    assert_eq!(a.robot, b.robot, "{about}");
    assert_eq!(a.process, b.process, "{about}");
    assert_eq!(a.run, b.run, "{about}");
    assert_eq!(a.effects, b.effects, "{about}");
    assert_eq!(a.claims, b.claims, "{about}");
}

/// Keys of each kind, with values that are as good in the key's unit as in SI.
const GOOD: [(&str, f64); 14] = [
    ("robot.inertia_scale", 1.05),
    ("robot.stiffness_scale", 0.93),
    ("robot.damping_scale", 0.0),
    ("robot.link.0.mass_factor", 1.25),
    ("robot.link.0.center_y_mm", 0.25),
    ("robot.joint.0.rotor_inertia_factor", 0.75),
    ("robot.joint.0.stiffness_factor", 1.5),
    ("robot.joint.0.damping_factor", 0.0),
    ("effect.0.mass_kg", 2.5),
    ("effect.0.center_z_m", 0.125),
    ("effect.1.gap_rad", 3e-4),
    ("process.chamfer.depth_mm", 0.5),
    ("process.chamfer.cutting.axial_mpa", 2.0e9),
    ("run.time_step_ms", 0.5e-3),
];

#[test]
fn a_number_set_in_memory_makes_the_scenario_that_an_override_makes() {
    let scenario = scenario("");
    for (key, value) in GOOD {
        let set = scenario.with_values(&[(key, value)]).unwrap();
        let overridden = scenario.with_overrides(&[written(key, value)]).unwrap();
        assert_same(&set, &overridden, key);
        assert_eq!(set.effective_text(), scenario.effective_text(), "{key}");
        assert_eq!(set.overrides(), scenario.overrides(), "{key}");
    }
    let all = scenario.with_values(&GOOD).unwrap();
    let overrides = GOOD.map(|(key, value)| written(key, value));
    assert_same(&all, &scenario.with_overrides(&overrides).unwrap(), "all");
}

#[test]
fn numbers_set_in_memory_stay_until_they_are_set_again() {
    let scenario = scenario("");
    let (scale, depth) = ("robot.inertia_scale", "process.chamfer.depth_mm");
    let set = scenario.with_values(&[(scale, 2.0)]).unwrap();
    let both = set.with_values(&[(depth, 0.5)]).unwrap();
    assert_eq!(both.robot.inertia_scale, 2.0);
    let thrice = both.with_values(&[(scale, 3.0)]).unwrap();
    assert_eq!(thrice.robot.inertia_scale, 3.0);
    assert_eq!(thrice.process, both.process);
    let longer = both
        .with_overrides(&[("run.time_step_ms".into(), "0.5".into())])
        .unwrap();
    assert_eq!(longer.robot.inertia_scale, 2.0);
    assert_eq!(longer.process, both.process);
    let back = both.with_overrides(&[written(scale, 1.0)]).unwrap();
    assert_eq!(back.robot.inertia_scale, 1.0);
}

#[test]
fn what_an_override_may_not_be_is_refused_in_memory_too() {
    let scenario = scenario("");
    for (key, value) in [
        ("robot.inertia_scale", 0.0),
        ("robot.inertia_scale", f64::INFINITY),
        ("robot.damping_scale", -0.1),
        ("robot.link.0.mass_factor", -1.0),
        ("robot.link.0.center_x_mm", 1e20),
        ("robot.link.1.mass_factor", 1.0),
        ("robot.stifness_scale", 1.0),
        ("robot.gravity", 1.0),
        ("effect.1.gap_rad", -1e-4),
        ("effect.1.gap_m", 1e-4),
        ("effect.2.gap_rad", 1e-4),
        ("process.chamfer.depth_mm", -1.0),
        ("process.milling.depth_mm", 1.0),
        ("run.duration_s", 0.0),
    ] {
        let refusal = |made: Result<Scenario, ScenarioError>| made.err().map(|e| e.to_string());
        let set = refusal(scenario.with_values(&[(key, value)]));
        let overridden = refusal(scenario.with_overrides(&[written(key, value)]));
        assert!(
            set.is_some() && set == overridden,
            "{key}: {set:?}, {overridden:?}"
        );
    }
}

#[test]
fn free_joints_have_no_stiffness_to_set() {
    let text = TEXT.replace("[robot]", "[robot]\ndrive = \"force\"");
    let free = Scenario::from_str(Path::new("d.toml"), &text, &[]).unwrap();
    for key in ["robot.stiffness_scale", "robot.damping_scale"] {
        let error = free.with_values(&[(key, 1.5)]).err().map(|e| e.to_string());
        assert!(error.is_some_and(|e| e.contains("has no effect")), "{key}");
    }
    assert!(free.with_values(&[("robot.inertia_scale", 1.5)]).is_ok());
}

#[test]
fn the_range_of_a_key_is_in_si() {
    let scenario = scenario("");
    assert_eq!(scenario.range("robot.joint.0.stiffness_factor")[0], 0.0);
    let [least, most] = scenario.range("process.chamfer.depth_mm");
    assert!(least == 0.0 && most.is_finite());
    let [least, most] = scenario.range("robot.link.0.center_x_mm");
    assert!(least < -1e9 && most > 1e9);
}
