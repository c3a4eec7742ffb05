//! A process that this workspace does not know, registered at run time: drilling.

use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::Deserialize;
use std::path::Path;
use truecut_recording::{ChannelSpec, Recording, Unit};
use truecut_scenario::{
    BrokenRule, Facts, Knob, ModesIn, Parts, PostureFrom, ProcessSpec, Processes, Scenario,
    ScenarioError,
};
use truecut_sim::SimError;
use truecut_sim::loads::{Attachment, ContactOutcomes, Loads, Wrench};
use truecut_sim::process::{
    ContactStiffness, Findings, OwnProcess, Process, ProcessSetup, SetupContext, ToolState,
};
use truecut_sim::run::Run;

/// A drill that is pressed on by a constant force, enough to see that a table arrives.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct Drill {
    /// Feed per revolution.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "without feed there is no chip"))]
    feed_mm_per_rev: f64,
    /// Thrust per feed.
    thrust_n_per_mm: f64,
    /// Diameter of the drill.
    diameter_mm: f64,
}

/// What could be changed at the machine.
const KNOBS: &[Knob] = &[Knob::new(
    "process.drilling.feed_mm_per_rev",
    "feed",
    &[0.5],
)];

impl OwnProcess for Drill {
    const NAME: &'static str = "drilling";

    fn facts(&self) -> Facts {
        Facts {
            rate_rad_s: Some(100.0),
            natural_duration_s: Some(0.05),
            signals: &["drilling.thrust"],
            knobs: KNOBS,
            files: &[],
            needs_drive: Some("drilling"),
            needs_robot: true,
            modes: ModesIn::Scenario,
            replays: false,
            posture: PostureFrom::Scenario,
            parts: Parts::NONE,
        }
    }

    fn check(&self) -> Result<(), BrokenRule> {
        if self.feed_mm_per_rev < self.diameter_mm {
            return Ok(());
        }
        Err(BrokenRule {
            key: "feed_mm_per_rev".to_owned(),
            message: format!(
                "`process.drilling.feed_mm_per_rev` is {}, but must be below the diameter of {} mm",
                self.feed_mm_per_rev, self.diameter_mm
            ),
        })
    }

    fn set_up(&self, context: &SetupContext<'_>) -> Result<ProcessSetup, SimError> {
        let thrust_n = self.thrust_n_per_mm * self.feed_mm_per_rev;
        Ok(ProcessSetup::new(Pressed { thrust_n }, context.posture()?))
    }
}

struct Pressed {
    thrust_n: f64,
}

impl Process for Pressed {
    fn channels(&self) -> Vec<ChannelSpec> {
        vec![ChannelSpec::new("drilling.thrust", Unit::Newton, "Thrust")]
    }

    fn evaluate(&self, _state: &ToolState) -> Loads {
        let mut loads = Loads::default();
        let force_n = Vector3::new(-self.thrust_n, 0.0, 0.0);
        loads
            .wrenches
            .push(Wrench::force(Attachment::Tool, force_n));
        loads
    }

    fn commit(&mut self, _: &ToolState, _: &Loads, _: &ContactOutcomes, _dt_s: f64) {}

    fn record(&self, row: &mut Vec<f64>) {
        row.push(self.thrust_n);
    }

    fn finish(&mut self) -> Findings {
        Findings::default()
    }

    fn contact_stiffness(&self) -> Vec<ContactStiffness> {
        Vec::new()
    }

    fn arrows(&self) -> Vec<(&'static str, Attachment, Vector3<f64>)> {
        Vec::new()
    }
}

const TEXT: &str = r#"
name = "Drilling"
[robot]
urdf = "../../assets/robots/irb6600_175_255/robot.urdf"
posture_deg = [-48.38, 54.82, 6.86, 54.16, 107.43, -21.95]
[process.drilling]
feed_mm_per_rev = 0.2
thrust_n_per_mm = 500
diameter_mm = 10
[[claim]]
name = "thrust"
metric = "mean"
channel = "drilling.thrust"
min = 99
max = 101
unit = "N"
reason = "500 N/mm times 0.2 mm"
"#;

fn processes() -> Processes {
    Processes::shipped().with(Drill::definition()).unwrap()
}

fn read(text: &str) -> Result<Scenario, ScenarioError> {
    let at = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/arm/of_a_test.toml");
    Scenario::from_str_with(&processes(), &at, text, &[])
}

fn run(scenario: &Scenario) -> Recording {
    let finished = Run::of(scenario)
        .execute()
        .unwrap_or_else(|e| panic!("{e}"));
    finished.recording
}

#[test]
fn it_is_read_run_and_recorded_like_those_of_the_workspace() {
    let scenario = read(TEXT).unwrap();
    assert_eq!(scenario.process.name(), "drilling");
    let ProcessSpec::Custom(custom) = &scenario.process else {
        panic!("{:?}", scenario.process)
    };
    assert_eq!(custom.table::<Drill>().unwrap().feed_mm_per_rev, 0.2);
    let recording = run(&scenario);
    let thrust = recording.channel("drilling.thrust").unwrap();
    assert!(thrust.iter().all(|force| *force == 100.0));
    assert!((recording.time_s.last().unwrap() - 0.05).abs() < 1e-3);
    let claim = &scenario.claims[0];
    assert_eq!(claim.name, "thrust");
}

#[test]
fn overrides_reach_its_table_and_the_scenario_keeps_its_processes() {
    let set = |feed: &str| {
        vec![(
            "process.drilling.feed_mm_per_rev".to_owned(),
            feed.to_owned(),
        )]
    };
    let scenario = read(TEXT).unwrap().with_overrides(&set("0.3")).unwrap();
    assert_eq!(scenario.processes().names().last(), Some("drilling"));
    let again = scenario.with_overrides(&set("0.1")).unwrap();
    assert_eq!(run(&again).channel("drilling.thrust").unwrap()[0], 50.0);
    assert_ne!(scenario.process, again.process);
    assert_eq!(scenario.process, scenario.clone().process);
}

#[test]
fn it_can_be_swept() {
    let axis = "[sweep]\n[[sweep.axis]]\nkey = \"process.drilling.feed_mm_per_rev\"\nvalues = [0.1, 0.2]\n\
                [[sweep.column]]\nname = \"thrust\"\nmetric = \"mean\"\nchannel = \"drilling.thrust\"\nunit = \"N\"\n";
    let text = TEXT.split("[[claim]]").next().unwrap().to_owned() + axis;
    let scenario = read(&text).unwrap();
    assert_eq!(scenario.sweep.unwrap().axes[0].values, [0.1, 0.2]);
}

fn refused(text: &str) -> (String, Option<usize>) {
    let error = read(text).unwrap_err();
    let line = error.problems().next().and_then(|problem| problem.line());
    (error.to_string(), line)
}

#[test]
fn mistakes_are_told_as_in_a_table_of_the_workspace() {
    assert_eq!(
        refused(&TEXT.replace("feed_mm_per_rev = 0.2", "feed_mm_per_rev = -1")),
        (
            "`process.drilling.feed_mm_per_rev` is -1, but must be greater than 0: without feed there is no chip"
                .to_owned(),
            Some(7)
        )
    );
    assert_eq!(
        refused(&TEXT.replace("diameter_mm", "diametre_mm")),
        (
            "unknown key `diametre_mm` in [process.drilling]; did you mean `diameter_mm`?"
                .to_owned(),
            Some(9)
        )
    );
    let (missing, _) = refused(&TEXT.replace("diameter_mm = 10\n", ""));
    assert_eq!(missing, "missing key `diameter_mm` in [process.drilling]");
    let (rule, line) = refused(&TEXT.replace("feed_mm_per_rev = 0.2", "feed_mm_per_rev = 20"));
    assert!(
        rule.ends_with("must be below the diameter of 10 mm"),
        "{rule}"
    );
    assert_eq!(line, Some(7));
    let (two, _) = refused(&TEXT.replace("[[claim]]", "[process.load]\n[[claim]]"));
    assert!(two.contains("2 processes (drilling, load)"), "{two}");
    assert!(two.contains("exactly one of [process.belt]"), "{two}");
    assert!(two.contains("[process.drilling], [process.load]"), "{two}");
}

#[test]
fn without_its_definition_the_table_is_unknown() {
    let error = Scenario::from_str(Path::new("a.toml"), TEXT, &[]).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("unknown key `drilling` in [process]")
    );
}

#[test]
fn a_name_taken_twice_is_refused() {
    let twice = processes().with(Drill::definition()).unwrap_err();
    assert_eq!(twice.to_string(), "there is a process `drilling` already");
}

#[test]
fn free_joints_are_refused_where_it_needs_a_drive() {
    let scenario = read(&TEXT.replace("[process.d", "drive = \"force\"\n[process.d")).unwrap();
    let error = Run::of(&scenario).execute().unwrap_err();
    assert!(
        error.to_string().contains("process.drilling presses"),
        "{error}"
    );
}
