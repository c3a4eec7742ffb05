//! A process that truecut does not know, in the user's own code: drilling with thrust and torque.
//!
//! `cargo run --release -p truecut --example own_process`
//!
//! The table `[process.drilling]` is read, checked, overridden, swept, claimed and recorded like
//! those of truecut. Everything that is needed stands in this file: the table ([`Drilling`]), its
//! facts, the process ([`TwistDrill`]), and at the end the tests that every process must pass
//! (`truecut` with the feature `contract` among the dev-dependencies).
//!
//! # Law
//!
//! A twist drill has two lips. Each takes a chip of thickness `f/2 · sin κ` and width `d/2 / sin κ`
//! at full engagement, so that both together cut an area `A = f d/2`, whatever the point angle
//! `2κ`. With the specific cutting pressures `K_t` along the cutting speed and `K_f` along the
//! feed, and the force of each lip in its middle, a quarter of the diameter off the axis:
//!
//! - torque `M = K_t f d²/8`,
//! - thrust `F = K_f f d/2`.
//!
//! While the point enters, over a depth `h = d/2 / tan κ`, the lips are engaged to a part `e` of
//! their radius: the area grows with `e`, the torque with `e²`. (Y. Altintas, *Manufacturing
//! Automation*, 2nd edition, Cambridge 2012, mechanics of drilling, without the chisel edge.)

use std::error::Error;
use std::f64::consts::TAU;
use std::path::Path;

use schemars::JsonSchema;
use serde::Deserialize;
use truecut::external::nalgebra::Vector3;
use truecut::recording::{ChannelSpec, Scalar, Unit};
use truecut::scenario::{
    BrokenRule, Facts, Knob, ModesIn, Parts, PostureFrom, Processes, Scenario,
};
use truecut::sim::SimError;
use truecut::sim::loads::{Attachment, ContactOutcomes, Loads, Wrench};
use truecut::sim::process::{
    ContactStiffness, Findings, OwnProcess, Process, ProcessSetup, SetupContext, ToolState,
};
use truecut::{Outputs, Run, sweep};

/// Drilling a hole with a twist drill.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct Drilling {
    /// Spindle speed.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the spindle turns"))]
    spindle_rpm: f64,
    /// Feed per revolution.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "without feed there is no chip"))]
    feed_mm_per_rev: f64,
    /// Diameter of the drill.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a drill has a diameter"))]
    diameter_mm: f64,
    /// Angle between the lips.
    #[schemars(extend(
        "exclusiveMinimum" = 0.0,
        "exclusiveMaximum" = 180.0,
        "x-rule" = "at 180 the drill has no point"
    ))]
    point_angle_deg: f64,
    /// Depth of the hole, from the first touch of the point.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a hole has a depth"))]
    depth_mm: f64,
    /// Specific cutting pressure along the cutting speed, K_t.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "cutting resists the rotation"))]
    cutting_mpa: f64,
    /// Specific cutting pressure along the feed, K_f.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "cutting resists the feed"))]
    feed_mpa: f64,
}

impl Drilling {
    fn drill(&self) -> TwistDrill {
        let radius_m = 0.5e-3 * self.diameter_mm;
        TwistDrill {
            feed_m_per_rev: 1e-3 * self.feed_mm_per_rev,
            revolutions_per_s: self.spindle_rpm / 60.0,
            diameter_m: 2.0 * radius_m,
            point_m: radius_m / (0.5 * self.point_angle_deg).to_radians().tan(),
            cutting_pa: 1e6 * self.cutting_mpa,
            feed_pa: 1e6 * self.feed_mpa,
            last: Cut::default(),
            largest: Cut::default(),
        }
    }
}

/// What could be changed at the machine.
const KNOBS: &[Knob] = &[
    Knob::new("process.drilling.feed_mm_per_rev", "feed", &[0.5, 2.0]),
    Knob::new("process.drilling.spindle_rpm", "spindle speed", &[0.6, 1.6]),
];

impl OwnProcess for Drilling {
    const NAME: &'static str = "drilling";

    fn facts(&self) -> Facts {
        let revolutions_per_s = self.spindle_rpm / 60.0;
        Facts {
            rate_rad_s: Some(TAU * revolutions_per_s),
            natural_duration_s: Some(self.depth_mm / (self.feed_mm_per_rev * revolutions_per_s)),
            // What a difference from measured data is held against.
            signals: &["drilling.depth", "drilling.thrust"],
            knobs: KNOBS,
            // No key of the table names a file.
            files: &[],
            // It presses, so that free joints are refused, by this key below `process`.
            needs_drive: Some("drilling"),
            needs_robot: true,
            // Tool and workpiece may bend: `[[tool.mode]]`, `[[workpiece.mode]]`.
            modes: ModesIn::Scenario,
            // Measured commands do not lead it.
            replays: false,
            // The arm starts in `robot.posture_deg`.
            posture: PostureFrom::Scenario,
            // It has no foot, cutter or wheel of truecut's for effects to act on.
            parts: Parts::NONE,
        }
    }

    // Ranges of single keys stand in the table's schema; what two keys must keep stands here.
    fn check(&self) -> Result<(), BrokenRule> {
        let point_mm = 1e3 * self.drill().point_m;
        if self.depth_mm >= point_mm {
            return Ok(());
        }
        Err(BrokenRule {
            key: "depth_mm".to_owned(),
            message: format!(
                "{} is less than {point_mm:.2}, the height of the point: the hole never has its \
                 diameter",
                self.depth_mm
            ),
        })
    }

    fn set_up(&self, context: &SetupContext<'_>) -> Result<ProcessSetup, SimError> {
        Ok(ProcessSetup::new(self.drill(), context.posture()?))
    }
}

/// What the drill cuts at one time.
#[derive(Debug, Clone, Copy, Default)]
struct Cut {
    depth_m: f64,
    thrust_n: f64,
    torque_n_m: f64,
}

/// The drill that runs.
struct TwistDrill {
    feed_m_per_rev: f64,
    revolutions_per_s: f64,
    diameter_m: f64,
    /// Height of the point.
    point_m: f64,
    cutting_pa: f64,
    feed_pa: f64,
    last: Cut,
    largest: Cut,
}

impl TwistDrill {
    /// Thrust at full engagement, N.
    fn full_thrust_n(&self) -> f64 {
        self.feed_pa * self.feed_m_per_rev * self.diameter_m / 2.0
    }

    /// Torque at full engagement, N m.
    fn full_torque_n_m(&self) -> f64 {
        self.cutting_pa * self.feed_m_per_rev * self.diameter_m.powi(2) / 8.0
    }

    fn at(&self, time_s: f64) -> Cut {
        let depth_m = self.feed_m_per_rev * self.revolutions_per_s * time_s.max(0.0);
        let engaged = (depth_m / self.point_m).min(1.0);
        Cut {
            depth_m,
            thrust_n: self.full_thrust_n() * engaged,
            torque_n_m: self.full_torque_n_m() * engaged * engaged,
        }
    }
}

impl Process for TwistDrill {
    fn channels(&self) -> Vec<ChannelSpec> {
        vec![
            ChannelSpec::new("drilling.depth", Unit::Metre, "Depth of the point"),
            ChannelSpec::new("drilling.thrust", Unit::Newton, "Thrust on the drill"),
            ChannelSpec::new(
                "drilling.torque",
                Unit::NewtonMetre,
                "Torque that brakes the drill",
            ),
        ]
    }

    fn evaluate(&self, state: &ToolState) -> Loads {
        let cut = self.at(state.time_s);
        let mut loads = Loads::default();
        // Loads and the tool's motion are in process axes: X runs along the spindle into the
        // workpiece, Y is horizontal, Z = X × Y. Thrust pushes the tool back.
        loads.wrenches.push(Wrench {
            frame: Attachment::Tool,
            force_n: Vector3::new(-cut.thrust_n, 0.0, 0.0),
            moment_n_m: Vector3::new(-cut.torque_n_m, 0.0, 0.0),
        });
        loads
    }

    fn commit(&mut self, state: &ToolState, _: &Loads, _: &ContactOutcomes, _dt_s: f64) {
        self.last = self.at(state.time_s);
        if self.last.thrust_n >= self.largest.thrust_n {
            self.largest = self.last;
        }
    }

    fn record(&self, row: &mut Vec<f64>) {
        row.extend([self.last.depth_m, self.last.thrust_n, self.last.torque_n_m]);
    }

    fn finish(&mut self) -> Findings {
        let thrust_n = self.largest.thrust_n;
        Findings {
            scalars: vec![Scalar::new(
                "drilling.largest_thrust",
                Unit::Newton,
                thrust_n,
                "Largest thrust",
            )],
            ..Findings::default()
        }
    }

    fn contact_stiffness(&self) -> Vec<ContactStiffness> {
        Vec::new()
    }

    fn arrows(&self) -> Vec<(&'static str, Attachment, Vector3<f64>)> {
        let force_n = Vector3::new(-self.last.thrust_n, 0.0, 0.0);
        vec![("thrust", Attachment::Tool, force_n)]
    }
}

const SCENARIO: &str = r#"
name = "Drilling a plate"

[robot]
urdf = "../../../assets/robots/irb6600_175_255/robot.urdf"
posture_deg = [-48.38, 54.82, 6.86, 54.16, 107.43, -21.95]

[process.drilling]
spindle_rpm = 1200
feed_mm_per_rev = 0.2
diameter_mm = 10
point_angle_deg = 118
depth_mm = 8
cutting_mpa = 800
feed_mpa = 400

[[claim]]
name = "thrust at full engagement"
metric = "mean"
channel = "drilling.thrust"
from_s = 1.0
min = 399.9
max = 400.1
unit = "N"
reason = "K_f f d/2 = 400 MPa * 0.2 mm * 5 mm"

[[claim]]
name = "deflection under the thrust"
metric = "mean"
channel = "tool.displacement_x"
from_s = 1.0
min = -0.467
max = -0.458
unit = "mm"
reason = "400 N on an arm of 0.8648 N/um along the spindle"
"#;

const SWEEP: &str = r#"
[sweep]

[[sweep.axis]]
key = "process.drilling.feed_mm_per_rev"
values = [0.1, 0.2, 0.4]

[[sweep.column]]
name = "largest_thrust"
metric = "peak"
channel = "drilling.thrust"
unit = "N"
"#;

/// Reads a scenario that may have the process of this file. Relative paths start from the folder of
/// this file.
fn read(text: &str) -> Result<Scenario, Box<dyn Error>> {
    let processes = Processes::shipped().with(Drilling::definition())?;
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/drilling.toml");
    Ok(Scenario::from_str_with(&processes, &file, text, &[])?)
}

/// One hole: every row against the law, the claims judged, the recording written.
fn one_hole(out: &Path) -> Result<(), Box<dyn Error>> {
    let scenario = read(SCENARIO)?;
    // Without a file for the viewer.
    let outputs = Outputs::prepare(out, &scenario, false)?;
    let finished = Run {
        sinks: outputs.sinks(),
        ..Run::of(&scenario)
    }
    .execute()?;
    // What an earlier run left in the folder is replaced only now.
    outputs.finish(&finished.recording, &finished.claims)?;
    for claim in &finished.claims {
        println!("{}: {}", claim.name, claim.shown);
    }
    assert!(finished.holds());
    let recording = &finished.recording;
    let (thrust, torque) = (400.0, 800e6 * 0.2e-3 * 10e-3_f64.powi(2) / 8.0);
    let point_m = 5e-3 / 59_f64.to_radians().tan();
    for row in 0..recording.time_s.len() {
        let depth_m = recording.channel("drilling.depth")?[row];
        let engaged = (depth_m / point_m).min(1.0);
        let is = |name: &str, expected: f64| -> Result<(), Box<dyn Error>> {
            let value = recording.channel(name)?[row];
            assert!((value - expected).abs() <= 1e-9 * expected.max(1.0));
            Ok(())
        };
        is("drilling.thrust", thrust * engaged)?;
        is("drilling.torque", torque * engaged * engaged)?;
    }
    println!(
        "{} rows in {}",
        recording.time_s.len(),
        outputs.recording().display()
    );
    assert!(outputs.recording().is_file());
    Ok(())
}

/// Three feeds: thrust is in proportion to them.
fn three_feeds() -> Result<(), Box<dyn Error>> {
    let without_claims = SCENARIO.split("[[claim]]").next().unwrap_or_default();
    let table = sweep(&read(&format!("{without_claims}{SWEEP}"))?, &|_| ())?;
    for row in &table.rows {
        let [feed_mm, thrust_n] = row[..] else {
            return Err("a row has a feed and a thrust".into());
        };
        println!("feed {feed_mm} mm/rev: thrust {thrust_n:.1} N");
        assert!((thrust_n - 400.0 * feed_mm * 5.0).abs() < 1e-9 * thrust_n);
    }
    assert_eq!(table.rows.len(), 3);
    Ok(())
}

pub fn main() -> Result<(), Box<dyn Error>> {
    let slip = SCENARIO.replace("feed_mm_per_rev = 0.2", "feed_mm_per_rev = 0");
    let refused = read(&slip).expect_err("a feed of 0 is refused");
    println!("{refused}");
    assert!(
        refused
            .to_string()
            .ends_with("without feed there is no chip")
    );
    let shallow = SCENARIO.replace("depth_mm = 8", "depth_mm = 2");
    let refused = read(&shallow).expect_err("the point is 3 mm high");
    println!("{refused}");
    assert!(refused.to_string().contains("2 is less than 3.00"));
    one_hole(&std::env::temp_dir().join("truecut_own_process"))?;
    three_feeds()
}

/// The rules that every process keeps, a test each.
#[cfg(test)]
mod tests {
    use super::{Drilling, TwistDrill, Vector3};
    use truecut::contract::process::Subject;
    use truecut::contract::process_contract;
    use truecut::sim::process::{FrameMotion, ToolState};

    const TIME_STEP_S: f64 = 1e-3;

    fn drill() -> TwistDrill {
        let table = Drilling {
            spindle_rpm: 1200.0,
            feed_mm_per_rev: 0.2,
            diameter_mm: 10.0,
            point_angle_deg: 118.0,
            depth_mm: 8.0,
            cutting_mpa: 800.0,
            feed_mpa: 400.0,
        };
        table.drill()
    }

    /// The drill, and what it lives through: the point enters while thrust pushes the tool back.
    pub fn subject() -> Subject {
        let state = |step: u32| {
            let time_s = TIME_STEP_S * f64::from(step);
            let pushed_m = -1e-4 * (1.0 - (-time_s / 0.1).exp());
            ToolState {
                time_s,
                tool: FrameMotion {
                    displacement_m: Vector3::new(pushed_m, 0.0, 0.0),
                    velocity_m_per_s: Vector3::zeros(),
                },
                ..ToolState::default()
            }
        };
        Subject::new(
            Box::new(drill()),
            TIME_STEP_S,
            (0..1000).map(state).collect(),
        )
    }

    process_contract!(twist_drill, super::subject);
}
