//! The run that is asked for, and what it comes to.

use std::borrow::Cow;
use std::sync::atomic::AtomicBool;

use truecut_recording::{ClaimResult, Measured, Outcome, PartMesh, Recording, Sink, SinkError};
use truecut_scenario::{Scenario, ScenarioError};

use super::error::RunError;
use super::runs::Runs;
use super::scalars;
use crate::cell::Cell;
use crate::engine::Engine;
use crate::error::SimError;
use crate::robots::Robots;

/// What becomes of a scenario's claims.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Claims {
    /// Checked against channels and scalars before the run, so that a slip in a claim does not
    /// cost it; judged after it.
    Judge,
    /// Checked only.
    Check,
    /// Left alone.
    Ignore,
}

/// Which channels a run's recording has in the end. Sinks take all of them in any case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Keep {
    /// All.
    All,
    /// Those alone that the scenario's claims and sweep ask for, and the joints' positions where a
    /// cell stands about the arm: of a long run the rest is on the disk.
    Judged,
}

/// Reads the measured data of a scenario that names some; `None` for one that needs none.
pub type ReadData = fn(&Scenario) -> Result<Option<Measured>, RunError>;

/// What a run comes to if it reaches its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Extent {
    /// Steps of the plant.
    pub steps: usize,
    /// Rows of the recording.
    pub rows: usize,
    /// Channels of the recording, without the time.
    pub channels: usize,
    /// How many of them are kept in memory: see [`Keep`].
    pub kept: usize,
}

impl Extent {
    /// Bytes of the rows and their times, eight for each number: what the recording takes, while
    /// the run goes on, in its stream on the disk.
    pub fn bytes(&self) -> u64 {
        self.bytes_of(self.channels)
    }

    /// Bytes of what is kept in memory, times included.
    pub fn memory_bytes(&self) -> u64 {
        self.bytes_of(self.kept)
    }

    fn bytes_of(&self, channels: usize) -> u64 {
        let numbers = self.rows as u64 * (channels as u64 + 1);
        8 * numbers
    }

    /// Refuses rows that take more memory than may be used.
    pub(super) fn check_memory(&self) -> Result<(), SimError> {
        let limit = truecut_files::memory_limit();
        if self.memory_bytes() <= limit {
            return Ok(());
        }
        let message = format!(
            "`run.record_interval_ms`: {} rows of {} channels take {} bytes in memory, but at most {limit} may be \
             used (--max-memory): record fewer rows, or a shorter run",
            self.rows,
            self.kept,
            self.memory_bytes()
        );
        Err(SimError::scenario("run.record_interval_ms", message))
    }
}

/// A run that is to be made; write what differs from [`Run::of`].
pub struct Run<'a> {
    /// What runs.
    pub scenario: &'a Scenario,
    /// Keys and values that are changed in it, as for `--set`.
    pub overrides: Vec<(String, String)>,
    /// The measured data that a replay is driven by; other processes make no use of it.
    pub measured: Option<&'a Measured>,
    /// Reads data that nobody has read yet: this scenario's if `measured` is none, and that of the
    /// scenarios that claims refer to. Without it those that replay data cannot run.
    pub read_data: Option<ReadData>,
    /// What integrates the arm.
    pub engine: Engine,
    /// Robots that have been read already.
    pub robots: Option<&'a Robots>,
    /// What becomes of the claims.
    pub claims: Claims,
    /// Which channels the recording keeps.
    pub keep: Keep,
    /// Runs that claims refer to: give the same to all runs that may refer to each other.
    pub references: Option<&'a Runs>,
    /// What takes the rows while the run goes on.
    pub sinks: Vec<Box<dyn Sink + Send>>,
    /// Is told the part done, from 0 to 1; more than once from the start if claims refer to other
    /// runs.
    pub progress: &'a dyn Fn(f64),
    /// Is told what the run will come to before its first step, and may refuse it; not of a
    /// scenario that is predicted without a plant.
    pub before: &'a dyn Fn(&Extent) -> Result<(), SinkError>,
    /// Stops the run at the next step once it is set, from another thread or a signal. The
    /// recording then ends there with [`Outcome::Interrupted`], its files are whole, and no claim
    /// is judged. It has that outcome, with all its rows, where a run that a claim refers to was
    /// stopped.
    pub stop: Option<&'a AtomicBool>,
}

/// A run that has ended.
#[derive(Debug, Clone)]
pub struct Finished {
    /// All its rows, of the channels that are kept, scalars and profiles. A run that diverged ends
    /// with a recording, too.
    pub recording: Recording,
    /// The claims, in the scenario's order; none unless they were to be judged.
    pub claims: Vec<ClaimResult>,
    /// Time step, s; the sampling interval of the data where no plant ran.
    pub time_step_s: f64,
    /// Time by the clock on the wall from the scenario to a plant that is ready to step, s.
    pub build_s: f64,
    /// Time by the clock on the wall of the run itself, without what sinks do after its end, s.
    pub run_s: f64,
    /// The measured data in the form that the recording is to be compared with, where no plant ran:
    /// filtered as the prediction is.
    pub compared: Option<Measured>,
    /// The workpiece as it is left, if the process keeps it as a body.
    pub part: Option<PartMesh>,
}

impl Finished {
    /// Whether the run came to its end and every claim holds.
    pub fn holds(&self) -> bool {
        self.recording.outcome == Outcome::Completed && self.claims.iter().all(|claim| claim.holds)
    }
}

impl<'a> Run<'a> {
    /// The scenario as it is, in rapier, its claims judged, nothing on disk.
    pub fn of(scenario: &'a Scenario) -> Run<'a> {
        Run {
            scenario,
            overrides: Vec::new(),
            measured: None,
            read_data: None,
            engine: Engine::Rapier,
            robots: None,
            claims: Claims::Judge,
            keep: Keep::All,
            references: None,
            sinks: Vec::new(),
            progress: &|_| {},
            before: &|_| Ok(()),
            stop: None,
        }
    }

    /// Runs to the end, or until the run diverges; judges the claims; closes the sinks. The table
    /// of a sweep is left alone: see [`crate::sweep`].
    ///
    /// # Errors
    /// Whatever makes the scenario unfit to run, at its place in the file; data that cannot be
    /// read; a claim that cannot be judged; what cannot be written.
    pub fn execute(mut self) -> Result<Finished, RunError> {
        let scenario = self.resolved()?;
        let sinks = std::mem::take(&mut self.sinks);
        let read = self.read(&scenario)?;
        let measured = self.measured.or(read.as_ref());
        let at = |error| RunError::of(&scenario, error);
        let mut recorded = self.record(&scenario, measured, sinks).map_err(at)?;
        let stopped = recorded.recording.outcome == Outcome::Interrupted;
        let judged = match self.claims {
            Claims::Judge if !stopped => self.judge_in(&scenario, &recorded.recording),
            _ => Ok(Vec::new()),
        };
        let (claims, unjudged) = match judged {
            Ok(claims) => (claims, None),
            Err(RunError::Stopped) => {
                recorded.recording.outcome = Outcome::Interrupted;
                (Vec::new(), None)
            }
            Err(error) => (Vec::new(), Some(Box::new(error))),
        };
        let closed = recorded.sinks.close(&recorded.recording, &claims);
        closed.map_err(RunError::Sink)?;
        if let Some(error) = unjudged {
            let recording = Box::new(recorded.recording);
            return Err(RunError::Unjudged { error, recording });
        }
        Ok(Finished {
            recording: recorded.recording,
            claims,
            time_step_s: recorded.time_step_s,
            build_s: recorded.build_s,
            run_s: recorded.run_s,
            compared: recorded.compared,
            part: recorded.part,
        })
    }

    /// Builds what would run and checks the claims and metrics against its channels and scalars,
    /// without a run.
    ///
    /// # Errors
    /// As [`Run::execute`] before the first step.
    pub fn check(&self) -> Result<(), RunError> {
        let scenario = self.resolved()?;
        let read = self.read(&scenario)?;
        let cell = self.cell(&scenario, self.measured.or(read.as_ref()));
        let cell = cell.map_err(|error| RunError::of(&scenario, error))?;
        scenario.check_bands(cell.row_interval_s())?;
        scenario.check_claims(&cell.header())?;
        if scalars::are_claimed(&scenario) || scalars::are_swept(&scenario) {
            let checked = scalars::check(&scenario, scalars::made(&scenario, cell));
            checked.map_err(|error| RunError::of(&scenario, error))?;
        }
        Ok(())
    }

    /// The recording alone, with what claims and sweep ask for: claims are left alone, sinks take
    /// nothing.
    pub(crate) fn recording(mut self) -> Result<Recording, SimError> {
        self.claims = Claims::Ignore;
        self.keep = Keep::Judged;
        let scenario = self.resolved()?;
        let recorded = self.record(&scenario, self.measured, Vec::new())?;
        Ok(recorded.recording)
    }

    /// The scenario with the overrides.
    pub(super) fn resolved(&self) -> Result<Cow<'a, Scenario>, ScenarioError> {
        if self.overrides.is_empty() {
            return Ok(Cow::Borrowed(self.scenario));
        }
        Ok(Cow::Owned(self.scenario.with_overrides(&self.overrides)?))
    }

    fn read(&self, scenario: &Scenario) -> Result<Option<Measured>, RunError> {
        match (self.measured, self.read_data) {
            (None, Some(read)) => read(scenario),
            _ => Ok(None),
        }
    }

    /// The cell that runs.
    pub(super) fn cell(
        &self,
        scenario: &Scenario,
        measured: Option<&Measured>,
    ) -> Result<Cell, SimError> {
        let own = Robots::new();
        Cell::build(scenario, measured, self.robots.unwrap_or(&own), self.engine)
    }
}
