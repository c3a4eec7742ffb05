//! The batteries on both plants and on every shipped process.

use super::plant::Case;
use super::process::Subject;
use crate::Robots;
use crate::cell::Cell;
use crate::loads::{Attachment, ContactOutcomes, Loads};
use crate::plant::{Plant, RapierPlant, ReducedPlant};
use crate::process::{ContactStiffness, Findings, Process, ToolState};
use crate::run::Engine;
use nalgebra::Vector3;
use std::path::Path;
use std::sync::{Arc, LazyLock, Mutex};
use truecut_recording::{ChannelSpec, Field, Measured, MeasuredChannel, Outcome, Role, Unit};
use truecut_scenario::DriveKind;
use truecut_scenario::Scenario;
use truecut_scenario::effect::{Effect, EffectKind, Family, Target, TargetKind};

fn rapier(case: &Case) -> Box<dyn Plant> {
    let Case {
        robot, q, command, ..
    } = case;
    let gravity = case.gravity_m_s2;
    let plant = RapierPlant::new(robot, q, command, case.drive(), gravity, case.time_step_s);
    Box::new(plant)
}

fn reduced(case: &Case) -> Box<dyn Plant> {
    let plant = ReducedPlant::new(
        Arc::new(case.robot.clone()),
        &case.q,
        &case.command,
        (DriveKind::Position, case.drive()),
        case.gravity_m_s2,
        case.time_step_s,
        false,
    );
    Box::new(plant.expect("a mass matrix that can be inverted"))
}

crate::plant_contract!(rapier_plant, super::rapier);
crate::plant_contract!(reduced_plant, super::reduced);

/// Steps that a process lives through.
const STEPS: usize = 600;
/// Robots, and ways that were solved before.
static ROBOTS: LazyLock<Robots> = LazyLock::new(Robots::new);

fn scenario(name: &str, overrides: &[(&str, &str)]) -> Scenario {
    let at = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../scenarios")
        .join(name);
    let owned = overrides
        .iter()
        .map(|(key, value)| ((*key).to_owned(), (*value).to_owned()));
    let owned: Vec<_> = owned.collect();
    Scenario::load(&at, &owned).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// A command of both joints at 1 kHz, from rest.
fn measured() -> Measured {
    let time_s: Vec<f64> = (0..2000).map(|k| f64::from(k) * 1e-3).collect();
    let channels = (1..=2).map(|joint| {
        let start = [-40f64, 60.0][joint - 1].to_radians();
        let sway = |t: &f64| start + 0.05 * (1.0 - (3.0 * t).cos());
        MeasuredChannel {
            spec: ChannelSpec::new(format!("joint{joint}.command"), Unit::Radian, ""),
            role: Role::Input,
            valid: vec![true; time_s.len()],
            values: time_s.iter().map(sway).collect(),
            noise: None,
            white_kept: 1.0,
        }
    });
    Measured {
        source: "made".into(),
        channels: channels.collect(),
        time_s: time_s.clone(),
        ..Measured::default()
    }
}

fn cell(scenario: &Scenario) -> Result<Cell, crate::SimError> {
    let data = scenario.data.as_ref().map(|_| measured());
    Cell::build(scenario, data.as_ref(), &ROBOTS, Engine::REDUCED)
}

/// The process of a shipped scenario, the states that it meets on the linearised arm, and itself
/// with each neutral effect that acts on it.
fn subject(name: &str, overrides: &[(&str, &str)]) -> Subject {
    let scenario = scenario(name, overrides);
    let built = || cell(&scenario).unwrap_or_else(|error| panic!("{name}: {error}"));
    let states = Arc::new(Mutex::new(Vec::new()));
    let mut spied = built();
    let time_step_s = spied.time_step_s();
    let log = states.clone();
    spied.replace_process(|inner| Box::new(Spy { inner, log }));
    spied.end_after(STEPS as f64 * time_step_s);
    spied.run_rows(|_, _| ());
    let states = std::mem::take(&mut *states.lock().expect("no panic"));
    let mut subject = Subject::new(process(built()), time_step_s, states);
    subject.states.truncate(STEPS);
    subject.begun = true;
    subject.neutral = neutral(&scenario);
    subject
}

fn process(mut cell: Cell) -> Box<dyn Process> {
    let mut taken = None;
    cell.replace_process(|process| {
        taken = Some(process);
        Box::new(super::process::Gone)
    });
    taken.expect("it was given")
}

/// The process with each effect that acts on it, at its neutral size. Effects of arm and sensors
/// are not its own, those of other processes are refused.
fn neutral(scenario: &Scenario) -> Vec<(String, Box<dyn Process>)> {
    let own = [
        Family::Cutting,
        Family::Milling,
        Family::Foot,
        Family::Wheel,
    ];
    let kinds = EffectKind::ALL
        .iter()
        .filter(|kind| own.contains(&kind.family()));
    kinds
        .filter(|kind| kind.target() == TargetKind::Whole)
        .filter_map(|kind| {
            let effect = Effect::neutral(*kind, Target::Whole);
            let cell = cell(&scenario.with_effects(&[effect]).ok()?).ok()?;
            Some((kind.name().to_owned(), process(cell)))
        })
        .collect()
}

/// Tests of the process of one shipped scenario each.
macro_rules! shipped {
    ($($test:ident: $file:literal $overrides:expr;)*) => { $(
        crate::process_contract!($test, || super::subject($file, &$overrides));
    )*

    mod all {
        use truecut_scenario::ProcessSpec;

        /// A process that is added has its scenario here, too.
        #[test]
        fn every_process_is_under_contract() {
            let tested = [$(super::scenario($file, &$overrides)),*];
            for name in ProcessSpec::NAMES {
                let is_tested = tested.iter().any(|one| one.process.name() == *name);
                assert!(is_tested, "{name} has no contract tests");
            }
        }
    }
    };
}

const COARSE: (&str, &str) = ("process.polish.face.cell_mm", "2");

shipped! {
    belt: "finishing/hub_spoke_belt.toml" [];
    belt_held: "finishing/hub_spoke_belt_held.toml" [];
    brush: "finishing/block_edge_brush.toml" [];
    chamfer: "chamfer/backward_sufficient.toml" [];
    chamfer_rod_free: "chamfer/forward_rod_free.toml" [];
    load: "arm/static_load.toml" [];
    load_sweep: "arm/frequency_sweep.toml" [];
    milling_nominal: "milling/nominal_surface.toml" [];
    milling_own: "milling/own_surface.toml" [];
    path_milling: "milling/pocket.toml" [];
    polish: "finishing/mould_free.toml" [super::COARSE];
    replay: "diagnosis/elbow.toml" [];
    surface_polish: "finishing/cover_polish.toml" [];
    wheel: "wheel/plate.toml" [];
}

/// Writes down the states that a process meets.
struct Spy {
    inner: Box<dyn Process>,
    log: Arc<Mutex<Vec<ToolState>>>,
}

impl Process for Spy {
    fn channels(&self) -> Vec<ChannelSpec> {
        self.inner.channels()
    }

    fn evaluate(&self, state: &ToolState) -> Loads {
        self.inner.evaluate(state)
    }

    fn commit(&mut self, state: &ToolState, loads: &Loads, contacts: &ContactOutcomes, dt_s: f64) {
        self.log.lock().expect("no panic").push(*state);
        self.inner.commit(state, loads, contacts, dt_s);
    }

    fn ended(&self) -> Option<Outcome> {
        self.inner.ended()
    }

    fn record(&self, row: &mut Vec<f64>) {
        self.inner.record(row);
    }

    fn finish(&mut self) -> Findings {
        self.inner.finish()
    }

    fn contact_stiffness(&self) -> Vec<ContactStiffness> {
        self.inner.contact_stiffness()
    }

    fn feed_along_y_m_per_s(&self) -> f64 {
        self.inner.feed_along_y_m_per_s()
    }

    fn field(&self) -> Option<Field> {
        self.inner.field()
    }

    fn arrows(&self) -> Vec<(&'static str, Attachment, Vector3<f64>)> {
        self.inner.arrows()
    }
}
