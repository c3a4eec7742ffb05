//! A scenario file becomes its typed form: units, defaults, overrides.

use std::f64::consts::{FRAC_PI_4, PI, TAU};
use std::path::Path;

use truecut_core::cutting::chamfer::{ChipArea, CuttingCoefficients};
use truecut_core::friction::{FootFriction, FrictionLaw};
use truecut_recording::{ChannelSpec, Header, MetricSpec, Reducer, Unit};
use truecut_scenario::{
    ChamferSpec, DriveKind, FeedDirection, ProcessSpec, Regeneration, Scenario, ScenarioError,
};

const TEXT: &str = include_str!("chamfer_d.toml");

fn read(overrides: &[(&str, &str)]) -> Result<Scenario, ScenarioError> {
    let owned: Vec<(String, String)> = overrides
        .iter()
        .map(|(key, value)| ((*key).into(), (*value).into()))
        .collect();
    Scenario::from_str(Path::new("cell/test_d.toml"), TEXT, &owned)
}

fn chamfer(scenario: &Scenario) -> &ChamferSpec {
    match &scenario.process {
        ProcessSpec::Chamfer(chamfer) => chamfer,
        other => panic!("not chamfering but {}", other.name()),
    }
}

#[test]
fn every_quantity_arrives_in_si() {
    let scenario = read(&[]).unwrap();
    assert_eq!(scenario.robot.urdf, Path::new("cell/robots/arm.urdf"));
    assert_eq!(scenario.robot.posture_rad[4], 107.43_f64.to_radians());
    assert_eq!(scenario.robot.inertia_scale, 0.82);
    assert_eq!(scenario.run.time_step_s, Some(2.5e-4));
    assert_eq!(scenario.run.record_interval_s, Some(1e-3));

    let chamfer = chamfer(&scenario);
    assert_eq!(chamfer.direction, FeedDirection::Backward);
    assert!((chamfer.schedule.spindle_rad_s - 10.0 * PI).abs() < 1e-12);
    assert_eq!(chamfer.schedule.feed_m_per_rev, 5e-5);
    assert_eq!(chamfer.schedule.depth_m, 1e-3);
    assert_eq!(chamfer.chip, ChipArea::new(FRAC_PI_4));
    assert_eq!(chamfer.hole_radius_m, 0.021);
    assert_eq!(chamfer.coefficients.axial_pa, 1.96e9);
    let in_plane = CuttingCoefficients::from_resultant(1.96e9, 2.14e9, 20_f64.to_radians());
    assert_eq!(chamfer.coefficients.radial_pa, in_plane.radial_pa);
    assert_eq!(chamfer.coefficients.tangential_pa, in_plane.tangential_pa);

    let foot = chamfer.foot.as_ref().unwrap();
    assert_eq!(foot.cylinders.pressure_pa, 4.5e5);
    assert_eq!(
        foot.friction,
        FootFriction::Law(FrictionLaw::Coulomb { mu: 0.15 })
    );
}

#[test]
fn what_is_not_said_has_its_documented_default() {
    let scenario = read(&[]).unwrap();
    assert_eq!(scenario.robot.drive, DriveKind::Position);
    assert!(scenario.robot.gravity && scenario.robot.hold_against_sag);
    assert_eq!(
        (scenario.robot.stiffness_scale, scenario.robot.damping_scale),
        (1.0, 1.0)
    );
    assert_eq!(scenario.run.deflection_scale, 300.0);
    let chamfer = chamfer(&scenario);
    assert_eq!((chamfer.schedule.edges, chamfer.start_angle_rad), (1, 0.0));
    assert_eq!(chamfer.regeneration, Regeneration::Axial);
    assert_eq!(chamfer.coefficients.edge_tangential_n_per_m, 0.0);
    let foot = chamfer.foot.as_ref().unwrap();
    assert_eq!(
        (
            foot.cylinders.bore_m,
            foot.cylinders.count,
            foot.seal_stiction_n
        ),
        (0.032, 2.0, 97.0)
    );
    assert_eq!(foot.rod_stiffness_n_per_m, 5e7);
    assert_eq!(foot.axial_share, None);
    assert_eq!(
        (
            foot.cylinders.gas_length_m,
            foot.cylinders.polytropic_exponent
        ),
        (0.05, 1.4)
    );
}

/// The first cut is 0.05 mm deep; the other 0.95 mm take 19 revolutions, 3.8 s at 300 rpm; two more
/// to dwell.
#[test]
fn verify_a_chamfering_run_lasts_for_ramp_and_dwell() {
    let scenario = read(&[]).unwrap();
    let schedule = &chamfer(&scenario).schedule;
    assert!((schedule.ramp_s() - 3.8).abs() < 1e-12);
    assert!((scenario.run.duration_s - 4.2).abs() < 1e-12);
    let turned_rad = schedule.revolution_s() * schedule.spindle_rad_s;
    assert!((turned_rad - TAU).abs() < 1e-12);
}

/// Two pistons of 804.2 mm² at 0.3 MPa push with 482.5 N.
#[test]
fn verify_the_preload_of_two_32_mm_cylinders() {
    let scenario = read(&[("process.chamfer.foot.pressure_mpa", "0.3")]).unwrap();
    let foot = chamfer(&scenario).foot.as_ref().unwrap();
    assert!(
        (foot.cylinders.preload_n() - 482.5).abs() < 0.05,
        "{}",
        foot.cylinders.preload_n()
    );
}

#[test]
fn claims_become_metrics_with_si_bounds() {
    let scenario = read(&[]).unwrap();
    let [sticks, even] = &scenario.claims[..] else {
        panic!("{:?}", scenario.claims)
    };
    let MetricSpec::Reduced {
        reducer, channels, ..
    } = &sticks.metric
    else {
        panic!("{sticks:?}")
    };
    assert_eq!(*reducer, Reducer::DurationAbove { threshold: 0.5 });
    assert_eq!(channels[..], ["foot.sliding"]);
    assert_eq!((sticks.min, sticks.max), (None, Some(0.003)));
    assert_eq!(
        even.metric,
        MetricSpec::Scalar {
            name: "chamfer.width_spread".into()
        }
    );
    assert!((even.max.unwrap() - 5e-5).abs() < 1e-18);
}

#[test]
fn overrides_reach_numbers_words_lists_and_tables_that_the_file_does_not_have() {
    let scenario = read(&[
        ("robot.posture_deg.1", "60"),
        ("process.chamfer.direction", "forward"),
        ("process.chamfer.foot.friction.mu", "0.3"),
        ("process.chamfer.cutting.edge_axial_n_per_mm", "20"),
        ("run.deflection_scale", "100"),
        ("robot.gravity", "false"),
        ("claim.1.max", "0.1"),
        ("name", "7"),
    ])
    .unwrap();
    assert_eq!(scenario.robot.posture_rad[1], 60_f64.to_radians());
    assert_eq!(chamfer(&scenario).direction, FeedDirection::Forward);
    let foot = chamfer(&scenario).foot.as_ref().unwrap();
    assert_eq!(
        foot.friction,
        FootFriction::Law(FrictionLaw::Coulomb { mu: 0.3 })
    );
    assert_eq!(chamfer(&scenario).coefficients.edge_axial_n_per_m, 20e3);
    assert_eq!(scenario.run.deflection_scale, 100.0);
    assert!(!scenario.robot.gravity);
    assert!((scenario.claims[1].max.unwrap() - 1e-4).abs() < 1e-18);
    assert_eq!(scenario.name, "7");
}

/// Xacro takes texts: whole numbers and others as such, truths by their names; one may be empty.
#[test]
fn arguments_of_the_robots_file_become_texts() {
    let urdf = "urdf = \"robots/arm.urdf\"";
    let given =
        "arguments = { kind = \"ur10e\", prefix = \"\", safety = true, axes = 6, reach = 2.0 }";
    let text = TEXT.replacen(urdf, &format!("{urdf}\n{given}"), 1);
    let path = Path::new("cell/test_d.toml");
    let texts = |scenario: &Scenario| -> Vec<String> {
        let arguments = scenario.robot.arguments.iter();
        arguments
            .map(|(name, value)| format!("{name}={value}"))
            .collect()
    };
    let scenario = Scenario::from_str(path, &text, &[]).unwrap();
    let all = [
        "axes=6",
        "kind=ur10e",
        "prefix=",
        "reach=2.0",
        "safety=true",
    ];
    assert_eq!(texts(&scenario), all);

    // Overrides set them in a table that is there, and make one that is not.
    let set = [
        ("robot.arguments.prefix".to_owned(), "left_".to_owned()),
        ("robot.arguments.axes".to_owned(), "7".to_owned()),
    ];
    let over = scenario.with_overrides(&set).unwrap();
    assert_eq!(over.robot.arguments["prefix"], "left_");
    assert_eq!(over.robot.arguments["kind"], "ur10e");
    let made = Scenario::from_str(path, TEXT, &set).unwrap();
    assert_eq!(texts(&made), ["axes=7", "prefix=left_"]);
    let again = Scenario::from_str(path, &made.effective_text(), &[]).unwrap();
    assert_eq!(again.robot, made.robot);
    assert!(read(&[]).unwrap().robot.arguments.is_empty());

    let list = text.replacen("axes = 6", "axes = [6]", 1);
    let error = Scenario::from_str(path, &list, &[]).unwrap_err();
    let problem = error.problems().next().unwrap();
    assert_eq!(problem.key, "robot.arguments.axes");
    assert!(problem.message.ends_with("but is a list"), "{problem}");
}

#[test]
fn the_effective_text_is_the_same_scenario_without_overrides() {
    let text = TEXT.split("[process.chamfer.foot]").next().unwrap();
    let set = [
        (
            "process.chamfer.foot.pressure_mpa".to_owned(),
            "0.3".to_owned(),
        ),
        (
            "process.chamfer.foot.friction.law".to_owned(),
            "none".to_owned(),
        ),
        ("process.chamfer.spindle_rpm".to_owned(), "400".to_owned()),
    ];
    let path = Path::new("cell/test_d.toml");
    let changed = Scenario::from_str(path, text, &set).unwrap();
    let again = Scenario::from_str(path, &changed.effective_text(), &[]).unwrap();
    assert_eq!(again.process, changed.process);
    assert_eq!(again.run, changed.run);
    assert_eq!(
        chamfer(&again).foot.as_ref().unwrap().friction,
        FootFriction::Law(FrictionLaw::None)
    );
    assert!((chamfer(&again).schedule.spindle_rad_s - 400.0 * PI / 30.0).abs() < 1e-12);
}

#[test]
fn further_overrides_come_after_the_first() {
    let key = "process.chamfer.foot.pressure_mpa";
    let scenario = read(&[(key, "0.3")]).unwrap();
    let further = scenario
        .with_overrides(&[(key.into(), "0.5".into())])
        .unwrap();
    assert_eq!(
        chamfer(&further)
            .foot
            .as_ref()
            .unwrap()
            .cylinders
            .pressure_pa,
        5e5
    );
    assert_eq!(further.overrides().len(), 2);
}

const SWEEP: &str = r#"
[sweep]
axis = [
  { key = "process.chamfer.foot.friction.mu", values = [0.1, 0.2] },
  { key = "process.chamfer.depth_mm", from = 0.25, to = 1.0, steps = 3, spacing = "log" },
]
column = [{ name = "theory", scalar = "theory.paper_threshold_pressure", unit = "MPa" }]
claim = [{ name = "agree", column = "simulated", over = "theory", max = 1.02, reason = "r" }]

[sweep.bisect]
name = "simulated"
key = "process.chamfer.foot.pressure_mpa"
from = 0.05
to = 1.5
metric = "peak"
channel = "tool.displacement_y"
limit = 2
unit = "um"
"#;

fn sweep_text() -> String {
    format!("{}{SWEEP}", TEXT.split("[[claim]]").next().unwrap())
}

#[test]
fn a_sweep_has_axes_a_search_columns_and_claims() {
    let scenario = Scenario::from_str(Path::new("s.toml"), &sweep_text(), &[]).unwrap();
    let sweep = scenario.sweep.unwrap();
    assert_eq!(sweep.axes[0].values, [0.1, 0.2]);
    let log = &sweep.axes[1].values;
    assert!(
        (log[1] - 0.5).abs() < 1e-15 && log[0] == 0.25 && log[2] == 1.0,
        "{log:?}"
    );
    let bisect = sweep.bisect.unwrap();
    assert!((bisect.limit - 2e-6).abs() < 1e-21);
    assert_eq!(
        (bisect.from, bisect.to, bisect.tolerance),
        (0.05, 1.5, 0.002)
    );
    assert_eq!(
        (bisect.key_unit.symbol.as_str(), bisect.key_unit.si_factor),
        ("MPa", 1e6)
    );
    assert_eq!(sweep.axes[1].unit.symbol, "mm");
    assert_eq!(sweep.columns[0].unit.si_factor, 1e6);
    assert_eq!(sweep.claims[0].over.as_deref(), Some("theory"));
}

#[test]
fn metrics_are_checked_against_the_channels_with_the_place_of_the_mistake() {
    let header = Header {
        channels: vec![
            ChannelSpec::new("foot.sliding", Unit::One, ""),
            ChannelSpec::new("foot.slip_speed", Unit::MetrePerSecond, ""),
        ],
        ..Header::default()
    };
    read(&[]).unwrap().check_claims(&header).unwrap();

    let fault = |set: &[(&str, &str)]| {
        let error = read(set).unwrap().check_claims(&header).unwrap_err();
        let problem = error.problems().next().cloned().unwrap();
        (problem.key.clone(), problem.message.clone())
    };
    let (key, message) = fault(&[("claim.0.channel", "foot.slidng")]);
    assert_eq!(key, "claim.0.channel");
    assert!(
        message.contains("did you mean \"foot.sliding\"?"),
        "{message}"
    );
    let (key, message) = fault(&[("claim.0.unit", "mm")]);
    assert_eq!(key, "claim.0.unit");
    assert!(message.contains("\"mm\" does not fit"), "{message}");
    let (key, message) = fault(&[("claim.0.channel", "foot.slip_speed")]);
    assert_eq!(key, "claim.0.threshold");
    assert!(message.contains("`threshold_unit` may be m/s"), "{message}");
}

#[test]
fn the_published_schema_describes_every_key() {
    fn undescribed(schema: &serde_json::Value, path: &str, found: &mut Vec<String>) {
        let alternatives = schema["anyOf"].as_array().into_iter().flatten();
        alternatives.for_each(|one| undescribed(one, path, found));
        if schema.get("items").is_some() {
            undescribed(&schema["items"], path, found);
        }
        for (key, property) in schema["properties"].as_object().into_iter().flatten() {
            let path = format!("{path}.{key}");
            if property.get("description").is_none() {
                found.push(path.clone());
            }
            undescribed(property, &path, found);
        }
    }
    let schema = Scenario::json_schema();
    assert!(
        schema["properties"]["process"]["properties"]
            .get("chamfer")
            .is_some()
    );
    let mut found = Vec::new();
    undescribed(&schema, "", &mut found);
    assert_eq!(found, Vec::<String>::new());
}

/// Uncertain values are SI like all others; they are written back in the unit of their key.
#[test]
fn an_uncertain_value_arrives_in_si_and_is_written_in_its_keys_unit() {
    let entries = "[[uncertain]]\nkey = \"process.chamfer.depth_mm\"\nrelative = 0.1\n\
                   [[uncertain]]\nkey = \"process.chamfer.spindle_rpm\"\nabsolute = 6.0\n";
    let text = format!("{TEXT}\n{entries}");
    let scenario = Scenario::from_str(Path::new("d.toml"), &text, &[]).unwrap();
    let [depth, spindle] = scenario.uncertain.as_slice() else {
        panic!("two");
    };
    assert_eq!((depth.value, depth.sigma), (1e-3, 1e-4));
    assert!((spindle.value - 10.0 * PI).abs() < 1e-12 && (spindle.sigma - 0.2 * PI).abs() < 1e-12);
    assert_eq!(depth.written(2e-3), "2.0");
    let faster: f64 = spindle.written(20.0 * PI).parse().unwrap();
    assert!((faster - 600.0).abs() < 1e-9);
    let symbol = truecut_scenario::si_symbol;
    assert_eq!(symbol(&depth.key), "m");
    assert_eq!(symbol(&spindle.key), "rad/s");
    assert_eq!(symbol("process.polish.wheel.damping_pa_s_per_m"), "Pa s/m");
    assert_eq!(symbol("robot.stiffness_scale"), "1");
}
