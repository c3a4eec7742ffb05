//! The scenario as a whole: from file and overrides to the typed form.

mod channels;
pub(crate) mod tables;
mod values;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::Value as Json;
use toml_edit::DocumentMut;
use truecut_core::chatter::AttachedModes;
use truecut_recording::{ClaimSpec, UserUnit};

use crate::check::Check;
use crate::claim::ClaimTable;
use crate::data::DataSpec;
use crate::document::Document;
use crate::effect::{Effect, table, text};
use crate::error::{ScenarioError, read_text};
use crate::excite::{ExciteSpec, PlannedMotion};
use crate::fault::Fault;
use crate::fit::FitSpec;
use crate::format::Format;
use crate::modes;
use crate::process::milling::PlannedPath;
use crate::process::{Definition, ProcessSpec};
use crate::processes::Processes;
use crate::relocate;
use crate::robot::{RobotSpec, RobotTable};
use crate::run::RunSpec;
use crate::sweep::SweepSpec;
use crate::uncertain::{self, UncertainSpec};
use crate::windows;
use tables::ScenarioTable;

/// A plant, a process and claims: everything that a run needs, in SI.
#[derive(Debug, Clone)]
pub struct Scenario {
    /// The scenario's name.
    pub name: String,
    /// What it shows.
    pub description: Option<String>,
    /// The arm; [`RobotSpec::NONE`] where a replay only observes.
    pub robot: RobotSpec,
    /// Duration and step.
    pub run: RunSpec,
    /// What the tool does.
    pub process: ProcessSpec,
    /// Modes of tool and workpiece beside the arm's, of processes that do not have them in their
    /// own table.
    pub attached: AttachedModes,
    /// File of what stands about the arm, for clearances.
    pub cell: Option<PathBuf>,
    /// What must hold of the run; empty if the scenario is a sweep.
    pub claims: Vec<ClaimSpec>,
    /// Values of keys to run at, if the scenario is a sweep.
    pub sweep: Option<SweepSpec>,
    /// What the nominal model leaves out, one of a kind for what it acts on.
    pub effects: Vec<Effect>,
    /// Whether each effect was given with the keys of a rotary joint; `None` where that is not
    /// said.
    effect_is_rotary: Vec<Option<bool>>,
    /// Measured data that drives the run or is compared with it.
    pub data: Option<DataSpec>,
    /// Nominal values that are not known exactly.
    pub uncertain: Vec<UncertainSpec>,
    /// Unknowns of a fit of drive forces, if the scenario says them.
    pub fit: Option<FitSpec>,
    /// A motion that is asked for; as without keys if the scenario says nothing of it.
    pub excite: ExciteSpec,
    /// Effects that were added in memory.
    added: Vec<Effect>,
    /// Values that were set in memory, SI, by key.
    set: Vec<(String, f64)>,
    document: Arc<Document>,
    processes: Processes,
    /// Units of thresholds, by the path of the table that holds the threshold.
    thresholds: Vec<(String, UserUnit)>,
}

impl Scenario {
    /// Reads a scenario file and applies overrides of its keys (`key` dotted, `value` as in TOML),
    /// in order.
    ///
    /// # Errors
    /// A file that cannot be read; every rule of the format that is broken, with its place.
    pub fn load(path: &Path, overrides: &[(String, String)]) -> Result<Scenario, ScenarioError> {
        Scenario::load_with(&Processes::shipped(), path, overrides)
    }

    /// As [`Scenario::load`], with processes of one's own.
    ///
    /// # Errors
    /// As [`Scenario::load`].
    pub fn load_with(
        processes: &Processes,
        path: &Path,
        overrides: &[(String, String)],
    ) -> Result<Scenario, ScenarioError> {
        let text = read_text("scenario", path)?;
        Scenario::from_str_with(processes, path, &text, overrides)
    }

    /// Whether a file is a scenario that lays its own way, for which there is a robot program; that
    /// it can be read as one is not said.
    pub fn lays_a_way(path: &Path) -> bool {
        let text = read_text("scenario", path).ok();
        let document = text.and_then(|text| text.parse::<DocumentMut>().ok());
        document.is_some_and(|document| {
            let process = document.get("process");
            let brush = process.and_then(|process| process.get("brush"));
            let polish = process.and_then(|process| process.get("surface_polish"));
            polish.is_some() || brush.and_then(|brush| brush.get("along")).is_some()
        })
    }

    /// Reads a scenario from a text. `path` names it in errors, and its folder resolves relative
    /// paths.
    ///
    /// # Errors
    /// Every rule of the format that is broken, with its place.
    pub fn from_str(
        path: &Path,
        text: &str,
        overrides: &[(String, String)],
    ) -> Result<Scenario, ScenarioError> {
        Scenario::from_str_with(&Processes::shipped(), path, text, overrides)
    }

    /// As [`Scenario::from_str`], with processes of one's own.
    ///
    /// # Errors
    /// As [`Scenario::from_str`].
    pub fn from_str_with(
        processes: &Processes,
        path: &Path,
        text: &str,
        overrides: &[(String, String)],
    ) -> Result<Scenario, ScenarioError> {
        let document = Document::parse(path, text, overrides, processes.schema())?;
        Scenario::read(document, processes)
    }

    /// Checks a document and resolves its tables.
    fn read(document: Document, processes: &Processes) -> Result<Scenario, ScenarioError> {
        let mut json = document.checked(Format::Scenario)?;
        let own = processes.take(&mut json);
        let table: ScenarioTable = document.tables(json)?;
        table.resolve(own, processes, document)
    }

    /// The same scenario with further overrides, applied after those it was loaded with; effects
    /// that were added in memory stay, and so do values that were set there.
    ///
    /// # Errors
    /// As [`Scenario::load`].
    pub fn with_overrides(&self, further: &[(String, String)]) -> Result<Scenario, ScenarioError> {
        self.resolved_anew(further)
    }

    /// The processes that scenarios like this one may have.
    pub fn processes(&self) -> &Processes {
        &self.processes
    }

    /// The scenario file, as it was named.
    pub fn path(&self) -> &Path {
        self.document.path()
    }

    /// The folder of the scenario file, against which its paths are resolved.
    pub fn folder(&self) -> PathBuf {
        self.document.folder()
    }

    /// Name of the scenario file without folder and extension; outputs are named by it.
    pub fn stem(&self) -> String {
        self.document.stem("scenario")
    }

    /// The overrides that were applied, in order.
    pub fn overrides(&self) -> Vec<(String, String)> {
        self.document.overrides()
    }

    /// What was read by another name than it is written with: a key or channel that was renamed.
    pub fn notes(&self) -> Vec<String> {
        self.document.notes()
    }

    /// The scenario as a TOML text with the overrides written into it, all names those of now.
    pub fn effective_text(&self) -> String {
        self.document.effective_text()
    }

    /// The same scenario with further effects, in memory: an effect of the same kind and target is
    /// replaced, others are appended. [`Scenario::effective_text`] stays as it was;
    /// [`Scenario::extended_text`] writes effects out.
    ///
    /// # Errors
    /// An effect that does not fit its kind.
    pub fn with_effects(&self, effects: &[Effect]) -> Result<Scenario, ScenarioError> {
        let mut extended = self.clone();
        extended.added.extend_from_slice(effects);
        for effect in effects {
            effect
                .check()
                .map_err(|error| self.problem("effect", error))?;
            let twin = |other: &Effect| other.kind == effect.kind && other.target == effect.target;
            match extended.effects.iter().position(twin) {
                Some(known) => extended.effects[known] = effect.clone(),
                None => {
                    extended.effects.push(effect.clone());
                    extended.effect_is_rotary.push(None);
                }
            }
        }
        Ok(extended)
    }

    /// The scenario as a TOML text for a file in `folder`, with a planned motion in the place of
    /// its data; overrides are written into it.
    pub fn excited_text(&self, folder: &Path, motion: &PlannedMotion) -> String {
        let mut document = self.document.effective_document().clone();
        // The motion lies in that folder: its path is not moved.
        document.remove("data");
        relocate::relocate(&mut document, &self.process.files(), &self.folder(), folder);
        motion.write(&mut document);
        document.to_string()
    }

    /// The scenario as a TOML text with the overrides and `effects` written into it as `[[effect]]`
    /// entries: one of the same kind and target takes the new values, others are appended; comments
    /// stay.
    ///
    /// `rotary` says of each joint of the chain whether it is rotary, which chooses the keys.
    pub fn extended_text(&self, effects: &[Effect], rotary: &[bool]) -> String {
        let mut document = self.document.effective_document().clone();
        text::write(&mut document, effects, rotary);
        document.to_string()
    }

    /// Whether `effects[index]` was given with the keys of a rotary joint; `None` if both kinds of
    /// joint share its keys, or if it did not come from a file.
    pub fn effect_is_rotary(&self, index: usize) -> Option<bool> {
        self.effect_is_rotary.get(index).copied().flatten()
    }

    /// The number that the scenario gives for a dotted key, in the key's own unit; `None` if it
    /// gives none.
    pub fn number(&self, key: &str) -> Option<f64> {
        self.document.number(key)
    }

    /// The scenario as a TOML text for a file in `folder`, overrides written into it, its milling
    /// path with the postures of a plan; comments and all other keys stay.
    pub fn planned_text(&self, folder: &Path, planned: &PlannedPath) -> String {
        self.moved(folder, |document| planned.write(document))
    }

    /// As [`Scenario::extended_text`], for a file in `folder`: relative paths lead from there to
    /// the same files.
    pub fn text_for_folder(&self, folder: &Path, effects: &[Effect], rotary: &[bool]) -> String {
        self.moved(folder, |document| text::write(document, effects, rotary))
    }

    /// The scenario as a TOML text for a file in `folder`, with what `write` changes in it.
    fn moved(&self, folder: &Path, write: impl FnOnce(&mut DocumentMut)) -> String {
        let mut document = self.document.effective_document().clone();
        write(&mut document);
        relocate::relocate(&mut document, &self.process.files(), &self.folder(), folder);
        document.to_string()
    }

    /// Whether the scenario gives a value for the dotted key, rather than leaving it to its
    /// default.
    pub fn gives(&self, key: &str) -> bool {
        self.document.has(key)
    }

    /// An error about the value of a dotted key that showed only later, e.g. a step too long for
    /// the arm. `message` quotes the value, the limit and the rule.
    pub fn problem(&self, key: &str, message: impl Into<String>) -> ScenarioError {
        self.document.problem(key, message)
    }

    /// JSON Schema of the scenario file, for editors. `x-rule` beside a bound gives its reason.
    pub fn json_schema() -> Json {
        Processes::shipped().json_schema().clone()
    }
}

impl ScenarioTable {
    fn resolve(
        self,
        own: Vec<(Arc<Definition>, Json)>,
        processes: &Processes,
        document: Document,
    ) -> Result<Scenario, ScenarioError> {
        let mut check = Check::new(&document);
        if self.name.chars().any(char::is_control) {
            let is = format!(
                "is {:?}, but must be one line without control characters",
                self.name
            );
            let fault = Fault::value("name", format!("`name` {is}"), "is printed and drawn");
            check.refuse(fault);
        }
        let folder = document.folder();
        let known: Vec<&str> = processes.names().collect();
        let process = self.process.resolve(own, &known, &folder, &mut check);
        let is_needed = (process.as_ref()).is_none_or(|process| process.facts().needs_robot);
        let mut robot = RobotTable::resolve_optional(self.robot, is_needed, &folder, &mut check);
        if let Some(process) = &process {
            process.lead(&mut robot, &mut check);
        }
        let touches = !matches!(process, Some(ProcessSpec::Load(_) | ProcessSpec::Replay(_)));
        let data = (self.data).and_then(|data| data.resolve(&folder, touches, &mut check));
        let uncertain: Vec<UncertainSpec> =
            (self.uncertain.unwrap_or_default().into_iter().enumerate())
                .filter_map(|(index, one)| one.resolve(&format!("uncertain.{index}"), &mut check))
                .collect();
        uncertain::refuse_twice(&uncertain, &mut check);
        let fit = (self.fit).map(|fit| fit.resolve(process.as_ref(), &mut check));
        let excite = (self.excite).map(|excite| excite.resolve(&mut check));
        let facts = process.as_ref().map(ProcessSpec::facts);
        let attached = facts
            .as_ref()
            .map(|facts| modes::attached(self.tool, self.workpiece, facts, &mut check));
        let replays = facts.as_ref().is_some_and(|facts| facts.replays);
        uncertain::refuse_clock(&uncertain, replays, &mut check);
        if replays {
            let because = "a replay takes the damping of the joints";
            check.ignored("robot", &["damping_ratio"], because);
            check_replayed(&mut check);
        }
        let natural_s = facts.map(|facts| facts.natural_duration_s);
        let run =
            natural_s.map(|natural_s| self.run.unwrap_or_default().resolve(natural_s, &mut check));
        if let (Some(process), Some(run)) = (&process, &run) {
            process.check_run(run, &mut check);
        }
        let claims = ClaimTable::resolve_all(self.claim, &mut check);
        let sweep = (self.sweep).map(|sweep| sweep.resolve(&uncertain, &mut check));
        if sweep.is_some() && !claims.is_empty() {
            let message = "a sweep has no [[claim]]: its claims are [[sweep.claim]]".to_owned();
            check.refuse(Fault::key("claim.0", message, "never judged"));
        }
        windows::check_windows(&claims, sweep.as_ref(), run.as_ref(), &mut check);
        let effects = table::resolve(self.effect.unwrap_or_default(), &mut check);
        let thresholds = std::mem::take(&mut check.thresholds);
        let faults = check.into_faults();
        document.refuse(faults)?;
        let (Some(process), Some(run)) = (process, run) else {
            return Err(document.problem("process", "the scenario has no process"));
        };
        Ok(Scenario {
            name: self.name,
            description: self.description,
            robot,
            run,
            process,
            attached: attached.unwrap_or_default(),
            cell: self.cell.map(|file| folder.join(file)),
            claims,
            sweep,
            effects: effects.effects,
            effect_is_rotary: effects.rotary,
            data,
            uncertain,
            fit,
            excite: excite.unwrap_or_default(),
            added: Vec::new(),
            set: Vec::new(),
            document: Arc::new(document),
            processes: processes.clone(),
            thresholds,
        })
    }
}

/// A replay has measured inputs and runs through all of them.
fn check_replayed(check: &mut Check) {
    if check.document().has("data.starts_s") {
        let message =
            "`data.starts_s` has no effect: a replay runs through all of the data".to_owned();
        check.refuse(Fault::key("data.starts_s", message, "has no effect here"));
    }
    if !check.document().has("data") {
        let message = "missing table `[data]`: a replay needs measured inputs".to_owned();
        check.refuse(Fault::key(
            "process.replay",
            message,
            "has nothing to replay",
        ));
    }
}
