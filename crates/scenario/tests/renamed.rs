//! Keys and channels that had another name before are read, and a note says what they are called.

use std::path::Path;

use truecut_recording::{MetricSpec, UserUnit};
use truecut_scenario::{Processes, Scenario, ScenarioError};

/// With present names; their order is that of [`BEFORE`] and of what is made from it.
const NOW: &str = r#"
name = "plate"
[robot]
urdf = "arm.urdf"
posture_deg = [0, 0]
[process.wheel]
radius_mm = 75
width_mm = 25
speed_rpm = 1200
spin = "climb"
stiffness_n_per_mm = 40
normal_force_n = 30
mu = 0.4
feed_mm_per_s = 50
strip_length_mm = 200
preston_per_pa = 4e-11
# The bearing is worn.
eccentricity_um = 60 # measured
[sweep]
axis = [{ key = "process.wheel.eccentricity_um", values = [20, 60] }]
[[sweep.column]]
name = "wheel.penetration"
metric = "max"
channel = "wheel.indentation" # of the wheel
unit = "um"
[[sweep.column]]
name = "whirl"
metric = "peak_norm"
channels = ["wheel.position", "wheel.indentation"]
unit = "um"
[[uncertain]]
key = "process.wheel.eccentricity_um"
relative = 0.1
"#;

fn read(text: &str, overrides: &[(&str, &str)]) -> Result<Scenario, ScenarioError> {
    let owned: Vec<(String, String)> = (overrides.iter())
        .map(|(key, value)| ((*key).into(), (*value).into()))
        .collect();
    Scenario::from_str(Path::new("plate.toml"), text, &owned)
}

/// The text with the names of before.
fn before() -> String {
    (NOW.replace("eccentricity_um", "runout_um")).replace("wheel.indentation", "wheel.penetration")
}

const NOTES: [&str; 2] = [
    "`process.wheel.runout_um` is called `process.wheel.eccentricity_um` now",
    "`wheel.penetration` is called `wheel.indentation` now",
];

#[test]
fn a_file_with_names_of_before_is_read_as_one_with_those_of_now() {
    let (now, before) = (read(NOW, &[]).unwrap(), read(&before(), &[]).unwrap());
    assert_eq!(now.notes(), Vec::<String>::new());
    assert_eq!(before.notes(), NOTES);
    assert_eq!(before.process, now.process);
    assert_eq!(before.sweep, now.sweep);
    assert_eq!(before.uncertain, now.uncertain);
    // Comments stay, and so does a name that is the user's own.
    assert_eq!(before.effective_text(), now.effective_text());
    assert!(before.gives("process.wheel.eccentricity_um"));
}

#[test]
fn overrides_and_values_may_have_names_of_before() {
    let key = "process.wheel.runout_um";
    let set = read(NOW, &[(key, "10")]).unwrap();
    assert_eq!(
        set.process,
        read(&before(), &[(key, "10")]).unwrap().process
    );
    assert_eq!(set.number("process.wheel.eccentricity_um"), Some(10.0));
    assert_eq!(set.notes(), NOTES[..1]);
    let now = "process.wheel.eccentricity_um";
    let with = |key| read(NOW, &[]).unwrap().with_values(&[(key, 1e-5)]).unwrap();
    assert_eq!(with(key).process, with(now).process);
    // The last one counts, whatever its name.
    let both = read(&before(), &[(key, "10"), (now, "20")]).unwrap();
    assert_eq!(both.number(now), Some(20.0));
}

#[test]
fn scalars_and_claims_may_have_names_of_before() {
    let text = before();
    let (process, _) = text.split_once("[sweep]").unwrap();
    let claims = "[[claim]]\nname = \"hub\"\nscalar = \"belt.largest_penetration\"\nmax = 1\n\
                  unit = \"1\"\nreason = \"r\"\n\
                  [[claim]]\nname = \"deep\"\nmetric = \"max\"\nchannel = \"polish.penetration\"\n\
                  max = 1\nunit = \"mm\"\nreason = \"r\"\n";
    let scenario = read(&format!("{process}{claims}"), &[]).unwrap();
    let [hub, deep] = scenario.claims.as_slice() else {
        panic!("two");
    };
    let scalar = MetricSpec::Scalar {
        name: "belt.largest_indentation".into(),
    };
    assert_eq!(hub.metric, scalar);
    assert!(deep.metric.to_string().contains("polish.indentation"));
    assert_eq!(deep.unit, UserUnit::parse("mm").unwrap());
    assert_eq!(scenario.notes().len(), 3);
}

#[test]
fn a_fault_at_a_name_of_before_stands_in_its_line_and_tells_the_present_one() {
    let text = before().replace("runout_um = 60", "runout_um = -60");
    let error = read(&text, &[]).unwrap_err();
    let problem = error.problems().next().unwrap();
    assert_eq!(
        problem.to_string(),
        "`process.wheel.eccentricity_um` is -60, but must be at least 0: an eccentricity is a distance"
    );
    assert_eq!(problem.line(), Some(18));
    assert_eq!(problem.help.as_deref(), Some(NOTES[0]));
    let error = read(NOW, &[("process.wheel.runout_um", "-1")]).unwrap_err();
    assert!(error.to_string().ends_with("(given by --set)"), "{error}");
}

/// A table with both names says two things.
#[test]
fn a_table_with_both_names_is_refused() {
    let text = NOW.replace("mu = 0.4", "mu = 0.4\nrunout_um = 60");
    let told = read(&text, &[]).unwrap_err().to_string();
    assert!(
        told.starts_with("unknown key `runout_um` in [process.wheel]"),
        "{told}"
    );
}

/// What the published schema took, it takes; the keys are marked, and are no suggestions.
#[test]
fn the_published_schema_takes_names_of_before() {
    let schema = Processes::shipped().json_schema().clone();
    let process = "/properties/process/properties";
    let of = |pointer: &str| schema.pointer(&format!("{process}{pointer}")).cloned();
    let wheel = of("/wheel").unwrap().to_string();
    assert!(wheel.contains("\"runout_um\"") && wheel.contains("\"deprecated\":true"));
    for name in ["polish", "belt"] {
        let text = of(&format!("/{name}")).unwrap().to_string();
        assert!(text.contains("\"penetration_mm\"") && text.contains("\"deprecated\":true"));
    }
    let text = NOW.replace("mu = 0.4", "mu = 0.4\nnonsense = 60");
    let error = read(&text, &[]).unwrap_err();
    let help = error.problems().next().unwrap().help.clone();
    assert!(!help.unwrap().contains("runout_um"));
}
