//! Every numeric key of a scenario changes what its run gives. A key that did not would be a
//! promise that the simulator does not keep.

use crate::support::repository;
use truecut_recording::Recording;
use truecut_scenario::Scenario;
use truecut_sim::run::{Claims, Run, RunError};

const CHAMFER: &str = include_str!("every_key/chamfer.toml");

const WHEEL: &str = include_str!("every_key/wheel.toml");

const MILLING: &str = include_str!("every_key/milling.toml");

const MILLING_FROM_THE_POSTURE: &str = include_str!("every_key/milling_from_the_posture.toml");

const LOAD: &str = include_str!("every_key/load.toml");

const LOAD_PATH: &str = include_str!("every_key/load_path.toml");

/// `turn_rpm` and `start_deg` are written so that they are not changed: edges hold the angle all
/// along this short way. They are changed in the text after this.
const POLISH: &str = include_str!("every_key/polish.toml");

const POLISH_HELD: &str = include_str!("every_key/polish_held.toml");

/// A belt run with further keys of its table, and a control table.
fn belt(keys: &str, control: &str) -> String {
    format!(
        r#"
name = "every key"
[robot]
urdf = "../../assets/robots/hp20/robot.urdf"
[run]
time_step_ms = 0.2
duration_s = 1.6
[process.belt]
job = "../finishing/hub_spoke.toml"
belt_m_per_s = 20
tension_n = 60
rubber_mm = 15
mu = 0.3
preston_per_pa = 4e-12
cell_mm = 2
{keys}
{control}
[process.belt.roughness]
start_um = 3.2
end_um = 0.4
dose_j_per_mm2 = 0.5
"#
    )
}

const BELT_KEYS: &str = "copies = 1
poisson = 0.48
damping_pa_s_per_m = 2000";

const BELT_HELD: &str = include_str!("every_key/belt_held.toml");

const BELT_COMPLIANT: &str = include_str!("every_key/belt_compliant.toml");

/// Roll and pitch of the work frame would lean the tool, and are left out.
const PATH_MILLING: &str = include_str!("every_key/path_milling.toml");

/// Worn flanks are not known of round corners.
const PATH_MILLING_ROUND: &str = include_str!("every_key/path_milling_round.toml");

const BRUSH: &str = include_str!("every_key/brush.toml");
/// Around a pocket: its sides are fed at the feed, in its corners the wrist is as fast as its share
/// lets it, and the step of points counts. The side to which it tilts is one of two, and written so
/// that it is not changed: this arm cannot follow to the other (`edge_path` has tests of both).
const BRUSH_ALONG: &str = include_str!("every_key/brush_along.toml");

/// Point, deviation and direction of the face are written so that they are not changed: another
/// point picks the same face, a fit that keeps a deviation keeps others, and a face of four sides
/// is laid along the one that is nearest.
const SURFACE_POLISH: &str = include_str!("every_key/surface_polish.toml");

/// Part of a run's time within which most keys show.
const BEGINNING: f64 = 0.2;

fn run(text: &str, overrides: &[(String, String)]) -> Result<Recording, RunError> {
    let at = repository().join("scenarios/arm/every_key.toml");
    let scenario = Scenario::from_str(&at, text, &[]).unwrap_or_else(|e| panic!("{e:?}"));
    let run = Run {
        overrides: overrides.to_vec(),
        claims: Claims::Ignore,
        ..Run::of(&scenario)
    };
    Ok(run.execute()?.recording)
}

/// What a run gives: all channels, scalars and profiles, to the bit.
fn differs(a: &Recording, b: &Recording) -> bool {
    let same = |a: &[f64], b: &[f64]| {
        a.iter()
            .map(|x| x.to_bits())
            .eq(b.iter().map(|x| x.to_bits()))
    };
    let columns = a.columns.len() != b.columns.len()
        || !(a.columns.iter().zip(&b.columns)).all(|(a, b)| same(a, b));
    let [of_a, of_b] = [a, b].map(|one| one.scalars.iter().map(|s| s.value).collect::<Vec<_>>());
    columns || a.profiles != b.profiles || !same(&of_a, &of_b)
}

/// Keys and their numbers, with the table they stand in; arrays are changed in their first element.
fn numeric_keys(text: &str) -> Vec<(String, String)> {
    let mut table = String::new();
    let mut keys = Vec::new();
    for line in text.lines() {
        if let Some(name) = line.strip_prefix("[[") {
            // A list within a list is that of its first entry.
            let name = name.trim_end_matches(']').replace(".mode.", ".mode.0.");
            table = format!("{name}.0");
        } else if let Some(name) = line.strip_prefix('[') {
            table = name.trim_end_matches(']').to_string();
        } else if let Some((key, value)) = line.split_once(" = ") {
            let changed = changed(key, value);
            if let Some(changed) = changed {
                keys.push((format!("{table}.{key}"), changed));
            }
        }
    }
    keys
}

fn changed(key: &str, value: &str) -> Option<String> {
    if value == "true" {
        return Some("false".into());
    }
    if let Some(inside) = value.strip_prefix('[') {
        let (first, rest) = inside.split_once(',')?;
        return Some(format!("[{}, {rest}", first.parse::<f64>().ok()? * 1.03));
    }
    let counts = [
        "edges",
        "cylinders",
        "strip_cells",
        "teeth",
        "copies",
        "bristles",
        "seed",
    ];
    if counts.contains(&key) {
        return Some((value.parse::<i64>().ok()? + 1).to_string());
    }
    let number: f64 = value.parse().ok()?;
    Some(match number {
        0.0 => "7.0".into(),
        _ => format!("{:?}", number * 1.03),
    })
}

/// A run that differs in its beginning differs; only where it does not is it run whole, as where
/// the beginning alone is shorter than the scenario allows.
fn check(text: &str, least: usize) {
    let whole =
        |set: &[(String, String)]| run(text, set).unwrap_or_else(|e| panic!("{set:?}: {e}"));
    let nominal = whole(&[]);
    let end_s = nominal.time_s.last().expect("rows") * BEGINNING;
    let beginning = ("run.duration_s".to_owned(), format!("{end_s:?}"));
    let nominal_beginning = run(text, std::slice::from_ref(&beginning)).ok();
    let keys = numeric_keys(text);
    assert!(keys.len() >= least, "{} keys found", keys.len());
    let (mut seen, mut in_vain) = (0, 0);
    for changed in keys {
        // Where keys show late, beginnings are run in vain.
        let early = nominal_beginning
            .as_ref()
            .filter(|_| changed.0 != beginning.0 && in_vain <= 2 + seen / 4);
        let shows_early = early.is_some_and(|nominal| {
            let other = run(text, &[beginning.clone(), changed.clone()]);
            other.is_ok_and(|other| differs(nominal, &other))
        });
        match shows_early {
            true => seen += 1,
            false => in_vain += usize::from(early.is_some()),
        }
        assert!(
            shows_early || differs(&nominal, &whole(std::slice::from_ref(&changed))),
            "`{}` = {} changes nothing",
            changed.0,
            changed.1
        );
    }
}

#[test]
fn every_key_of_chamfering_counts() {
    check(CHAMFER, 28);
}

#[test]
fn every_key_of_the_wheel_counts() {
    check(WHEEL, 12);
}

#[test]
fn every_key_of_milling_counts() {
    check(MILLING, 36);
    check(MILLING_FROM_THE_POSTURE, 12);
}

#[test]
fn every_key_of_milling_along_a_path_counts() {
    check(PATH_MILLING, 36);
    check(PATH_MILLING_ROUND, 16);
}

#[test]
fn every_key_of_polishing_counts() {
    check(POLISH, 34);
    check(POLISH_HELD, 37);
}

#[test]
fn every_key_of_polishing_a_surface_counts() {
    check(SURFACE_POLISH, 31);
}

#[test]
fn every_key_of_belt_finishing_counts() {
    check(&belt(BELT_KEYS, ""), 14);
    check(&belt("", BELT_HELD), 15);
    check(&belt("", BELT_COMPLIANT), 16);
}

#[test]
fn every_key_of_brushing_counts() {
    check(BRUSH, 17);
    check(BRUSH_ALONG, 23);
}

#[test]
fn every_key_of_given_loads_counts() {
    check(LOAD, 13);
    check(LOAD_PATH, 10);
}
