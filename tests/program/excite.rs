//! `truecut excite` as a user meets it: its files, the same for the same seed, and its keys.

use super::*;

use std::collections::{BTreeMap, BTreeSet};

use truecut_discrepancy::diagnose::{Alternative, Cause, Diagnosis, Evidence, Parameter, Verdict};
use truecut_discrepancy::excite::{self, Outlook};

/// Joints of the two-joint arm, whose files do not limit it.
const LIMITS: &str = "[[excite.joint]]\njoint = 1\nlower_deg = -60\nupper_deg = 60\nspeed_deg_per_s = 90\n\
                      acceleration_deg_per_s2 = 400\n[[excite.joint]]\njoint = 2\nlower_deg = -90\nupper_deg = 90\n\
                      speed_deg_per_s = 120\nacceleration_deg_per_s2 = 600\n";

fn root() -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    root.canonicalize().unwrap()
}

/// Puts the shipped example of a forward replay on a desk, with further tables.
fn forward(desk: &Desk, keys: &str) {
    let folder = root().join("scenarios/diagnosis");
    let text = std::fs::read_to_string(folder.join("elbow.toml")).unwrap();
    let text = text.replace("../../assets", &root().join("assets").display().to_string());
    let text = format!("{text}\n[excite]\n{keys}\n{LIMITS}");
    std::fs::write(desk.path("elbow.toml"), text).unwrap();
    std::fs::copy(folder.join("elbow.csv"), desk.path("elbow.csv")).unwrap();
}

/// Inverse dynamics of the same arm.
fn inverse(desk: &Desk) {
    let urdf = root().join("assets/robots/arm_2r/robot.urdf");
    let channel = |joint: usize| {
        format!(
            "[[data.channel]]\ncolumn = \"q{joint}\"\nchannel = \"joint{joint}.angle\"\nunit = \"rad\"\nrole = \"input\"\n\
             [[data.channel]]\ncolumn = \"f{joint}\"\nchannel = \"joint{joint}.drive_torque\"\nunit = \"N m\"\n"
        )
    };
    let text = format!(
        "name = \"Inverse\"\n[robot]\nurdf = '{}'\n[process.replay]\nmode = \"inverse\"\n[data]\ntime = \"t\"\n{}{}\
         [fit]\nunknowns = [\"links\", \"viscous\", \"coulomb\"]\n[excite]\nduration_s = 6\nevaluations = 100\n{LIMITS}",
        urdf.display(),
        channel(1),
        channel(2)
    );
    std::fs::write(desk.path("arm.toml"), text).unwrap();
}

fn report(desk: &Desk, name: &str) -> serde_json::Value {
    let file = desk.path(&format!("out/{name}/excitation.json"));
    serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap()
}

/// Commands of two joints are planned so that play in one of them shows; the scenario that comes of
/// it runs as it is.
#[test]
fn a_motion_in_forward_mode_is_a_scenario_that_runs() {
    let desk = Desk::new();
    forward(&desk, "duration_s = 3\nevaluations = 24");
    let asked = "joint_backlash.2,robot.inertia_scale";
    let told = desk.ends(0, &["excite", "elbow.toml", "--for", asked]);
    assert!(told.contains("joint_backlash.2 gap_rad"), "{told}");
    assert!(told.contains("in the data at hand"), "{told}");
    let report = report(&desk, "elbow");
    let parameters = report["parameters"].as_array().unwrap();
    assert_eq!(parameters.len(), 2);
    assert!(
        parameters
            .iter()
            .all(|one| one["present"].as_f64().unwrap() > 0.0)
    );
    assert!(report["mean_ratio"].as_f64().unwrap() < 1.0, "{told}");
    desk.ends(
        0,
        &["run", "out/elbow/excited.toml", "--no-rrd", "--out", "runs"],
    );
}

/// The data are there, expected ones: a fit of them gives back what the scenario has.
#[test]
fn a_motion_in_inverse_mode_is_a_scenario_that_can_be_fitted() {
    let desk = Desk::new();
    inverse(&desk);
    desk.ends(0, &["excite", "arm.toml"]);
    desk.ends(0, &["fit", "out/arm/excited.toml", "--out", "fits"]);
    let text = std::fs::read_to_string(desk.path("fits/excited/fit.json")).unwrap();
    let fit: serde_json::Value = serde_json::from_str(&text).unwrap();
    let expected = report(&desk, "arm");
    let pairs = fit["parameters"].as_array().unwrap().iter();
    for (one, told) in pairs.zip(expected["parameters"].as_array().unwrap()) {
        assert_eq!(one["name"], told["name"]);
        let [value, nominal] = ["value", "nominal"].map(|key| one[key].as_f64().unwrap());
        // Without noise nothing is left but what filters do: less than would show in noise of a
        // hundredth.
        let shows = 2.0 * told["planned"].as_f64().unwrap();
        assert!((value - nominal).abs() < shows, "{one} {told}");
    }
}

#[test]
fn the_same_seed_gives_the_same_motion_and_every_key_another_answer() {
    let desk = Desk::new();
    inverse(&desk);
    let answer = |sets: &[&str]| {
        let sets = sets.iter().flat_map(|set| ["--set", set]);
        let arguments: Vec<&str> = ["excite", "arm.toml"].into_iter().chain(sets).collect();
        desk.ends(0, &arguments);
        let read = |name| std::fs::read(desk.path(&format!("out/arm/{name}"))).unwrap();
        (read("motion.csv"), read("excitation.json"))
    };
    let mut seen = BTreeSet::from([answer(&[])]);
    assert!(!seen.insert(answer(&[])), "the same again");
    for set in [
        "excite.duration_s=7",
        "excite.rate_hz=120",
        "excite.harmonics=4",
        "excite.periods=2",
        "excite.criterion=e",
        "excite.limit_share=0.8",
        "excite.noise_share=0.02",
        "excite.seed=2",
        "excite.evaluations=160",
        "excite.for=[\"coulomb 2\"]",
        "excite.joint.0.lower_deg=-50",
        "excite.joint.0.upper_deg=50",
        "excite.joint.0.speed_deg_per_s=80",
        "excite.joint.0.acceleration_deg_per_s2=100",
        "excite.joint.0.torque_n_m=900",
    ] {
        assert!(seen.insert(answer(&[set])), "{set} changes nothing");
    }
}

#[test]
fn what_is_asked_on_the_command_line_is_refused_there() {
    let desk = Desk::new();
    inverse(&desk);
    std::fs::write(desk.path("diagnosis.json"), "{}").unwrap();
    for (option, value, said) in [
        (
            "--for",
            "joint_stribeck.3",
            "--for: names joint_stribeck of joint 3, but the chain has 2",
        ),
        (
            "--dialect",
            "basic",
            "--dialect is \"basic\", but must be one of",
        ),
        (
            "--diagnosis",
            "diagnosis.json",
            "diagnosis.json: is no diagnosis.json",
        ),
    ] {
        desk.refused(&["excite", "arm.toml", option, value], &[said]);
    }
}

/// An effect of a joint as a diagnosis names it.
fn cause(kind: &str, key: &str, value: f64) -> Cause {
    let parameter = Parameter {
        value,
        low: None,
        high: None,
        unit: String::new(),
    };
    Cause {
        kind: kind.to_owned(),
        target: Some("joint2".to_owned()),
        parameters: BTreeMap::from([(key.to_owned(), parameter)]),
        evidence: Evidence {
            likelihood_gain: 9.0,
            log10_odds: 1.0,
            validation_t: 2.0,
            practical_gain: 0.1,
        },
    }
}

/// Two frictions that a diagnosis could not tell apart: the motion shows both, and the odds that it
/// tells are those of the distance that it tells.
#[test]
fn a_motion_tells_the_causes_of_an_ambiguous_diagnosis_apart() {
    let desk = Desk::new();
    inverse(&desk);
    let diagnosis = Diagnosis {
        verdict: Verdict::Ambiguous,
        causes: vec![cause("joint_viscous", "viscous_n_m_s_per_rad", 4.0)],
        alternatives: vec![Alternative {
            causes: vec![cause("joint_coulomb", "friction_n_m", 3.0)],
            angle_deg: 5.0,
            behind_t: 0.5,
            criterion_difference: 1.0,
        }],
        ..Diagnosis::default()
    };
    let text = serde_json::to_string(&diagnosis).unwrap();
    std::fs::write(desk.path("diagnosis.json"), text).unwrap();
    let arguments = ["excite", "arm.toml", "--diagnosis", "diagnosis.json"];
    let told = desk.ends(0, &arguments);
    let apart = "joint_viscous.2 and joint_coulomb.2 would be";
    assert!(told.contains(apart), "{told}");
    let report = report(&desk, "arm");
    let names: Vec<&str> = (report["parameters"].as_array().unwrap().iter())
        .map(|one| one["name"].as_str().unwrap())
        .collect();
    let expected = [
        "joint_viscous.2 viscous_n_m_s_per_rad",
        "joint_coulomb.2 friction_n_m",
    ];
    assert_eq!(names, expected);
    let number = |key: &str| report["separation"][key].as_f64().unwrap();
    let (distance, odds) = (number("planned"), number("log10_odds"));
    assert!(distance > 1.0, "{told}");
    assert!((odds - 0.5 * distance * distance / std::f64::consts::LN_10).abs() < 1e-9 * odds);
}

/// Offsets of a drive and of its sensor are one in every state: no motion is proposed. Two
/// frictions are not.
#[test]
fn what_no_motion_tells_apart_is_not_proposed() {
    let desk = Desk::new();
    inverse(&desk);
    let scenario = truecut_scenario::Scenario::load(&desk.path("arm.toml"), &[]).unwrap();
    let outlook = |first: Cause, other: Cause| {
        let diagnosis = Diagnosis {
            verdict: Verdict::Ambiguous,
            causes: vec![first],
            alternatives: vec![Alternative {
                causes: vec![other],
                angle_deg: 0.0,
                behind_t: 0.0,
                criterion_difference: 0.0,
            }],
            ..Diagnosis::default()
        };
        excite::outlook(&scenario, &diagnosis)
    };
    let drive = || cause("joint_offset", "force_n_m", -30.0);
    let sensor = Cause {
        target: Some("joint2.drive_torque".to_owned()),
        ..cause("sensor_offset", "offset", 30.0)
    };
    assert_eq!(outlook(drive(), sensor), Outlook::CannotTell);
    let friction = cause("joint_coulomb", "friction_n_m", 3.0);
    assert_eq!(outlook(drive(), friction), Outlook::MayTell);
}
