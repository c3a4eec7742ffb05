//! Jobs that call jobs: read in the order in which the controller runs them.

use std::collections::BTreeMap;
use std::path::Path;
use std::rc::Rc;

use super::JbiJob;
use crate::program::{Program, ProgramError, ProgramErrorKind, SpindleSwitch};

/// How deep jobs may call each other, as procedures in RAPID.
const CALL_DEPTH: usize = 16;
/// How many calls are followed: jobs without moves would otherwise multiply without end.
const MOST_CALLS: usize = 10_000;

/// Follows the calls of a job.
pub(super) struct Calls<'a> {
    pub load: &'a dyn Fn(&Path) -> Result<JbiJob, ProgramError>,
    /// A job's own moves, without those that it calls.
    pub own: &'a dyn Fn(&JbiJob) -> Result<Program, ProgramError>,
    /// Number of the output that switches the spindle.
    pub spindle: Option<u32>,
    read: BTreeMap<String, Rc<(JbiJob, Program)>>,
    /// Jobs under way.
    stack: Vec<String>,
    count: usize,
    /// Tool of the jobs that move.
    tool: Option<u8>,
}

impl<'a> Calls<'a> {
    pub fn new(
        load: &'a dyn Fn(&Path) -> Result<JbiJob, ProgramError>,
        own: &'a dyn Fn(&JbiJob) -> Result<Program, ProgramError>,
        spindle: Option<u32>,
    ) -> Self {
        Self {
            load,
            own,
            spindle,
            read: BTreeMap::new(),
            stack: Vec::new(),
            count: 0,
            tool: None,
        }
    }

    /// The program of the job in a file, with what it calls at the places of the calls.
    ///
    /// # Errors
    /// At the line of a call that cannot be followed: of a job that is under way, or that cannot be
    /// read; where a job is at fault, there.
    pub fn run(mut self, file: &Path) -> Result<Program, ProgramError> {
        let job = (self.load)(file)?;
        let own = (self.own)(&job)?;
        let mut whole = Program {
            moves: Vec::new(),
            spindle: Vec::new(),
            notes: Vec::new(),
            ..own.clone()
        };
        let name = file.file_stem().unwrap_or_default();
        self.stack.push(name.to_string_lossy().to_uppercase());
        self.add(&job, &own, &mut whole)?;
        Ok(whole)
    }

    fn add(
        &mut self,
        job: &JbiJob,
        own: &Program,
        whole: &mut Program,
    ) -> Result<(), ProgramError> {
        let is_new = |note: &&String| !whole.notes.contains(note);
        let notes: Vec<String> = own.notes.iter().filter(is_new).cloned().collect();
        whole.notes.extend(notes);
        if !own.moves.is_empty() {
            whole.tool.number = *self.tool.get_or_insert(own.tool.number);
        }
        let (mut moves, mut outputs) = (0, 0);
        for call in &job.calls {
            self.piece(
                job,
                own,
                [moves, call.moves],
                [outputs, call.outputs],
                whole,
            );
            (moves, outputs) = (call.moves, call.outputs);
            let at = |kind| ProgramError::in_file(&job.path, call.line, kind);
            let called = self
                .called(&job.path, &call.name)
                .map_err(|fault| match fault {
                    Fault::Here(kind) => at(kind),
                    Fault::There(error) => error,
                })?;
            ProgramErrorKind::unless_too_many(whole.moves.len() + called.1.moves.len())
                .map_err(at)?;
            self.same_tool(&called.1).map_err(at)?;
            self.stack.push(call.name.to_uppercase());
            self.add(&called.0, &called.1, whole)?;
            self.stack.pop();
        }
        let ends = [own.moves.len(), job.outputs.len()];
        self.piece(job, own, [moves, ends[0]], [outputs, ends[1]], whole);
        Ok(())
    }

    /// As in one job, positions of a second tool are not read.
    fn same_tool(&self, called: &Program) -> Result<(), ProgramErrorKind> {
        let Some(tool) = self.tool.filter(|_| !called.moves.is_empty()) else {
            return Ok(());
        };
        let (what, found) = ("///TOOL of the job that is called", called.tool.number);
        let rule = format!("{tool}, as of the moves before: one tool is read");
        ProgramErrorKind::unless(found == tool, what, found, rule)
    }

    /// Adds moves and outputs of a job between two of its calls.
    fn piece(
        &self,
        job: &JbiJob,
        own: &Program,
        moves: [usize; 2],
        outputs: [usize; 2],
        whole: &mut Program,
    ) {
        let start = whole.moves.len();
        whole
            .moves
            .extend_from_slice(&own.moves[moves[0]..moves[1]]);
        let switches = job.outputs[outputs[0]..outputs[1]].iter();
        let switches = switches.filter(|(_, number, _)| Some(*number) == self.spindle);
        whole
            .spindle
            .extend(switches.map(|(before, _, on)| SpindleSwitch {
                before: start + before - moves[0],
                on: *on,
            }));
    }

    fn called(&mut self, caller: &Path, name: &str) -> Result<Rc<(JbiJob, Program)>, Fault> {
        let key = name.to_uppercase();
        if self.stack.contains(&key) {
            let rule = "one that is not under way: the jobs would call each other without end";
            return Err(ProgramErrorKind::value("the job that is called", name, rule).into());
        }
        let depth = self.stack.len();
        let rule = format!("at most {CALL_DEPTH}");
        ProgramErrorKind::unless(depth <= CALL_DEPTH, "the depth of calls", depth, rule)?;
        self.count += 1;
        let rule = format!("at most {MOST_CALLS}");
        ProgramErrorKind::unless(
            self.count <= MOST_CALLS,
            "the number of calls",
            self.count,
            rule,
        )?;
        if let Some(known) = self.read.get(&key) {
            return Ok(known.clone());
        }
        let file = caller.with_file_name(format!("{name}.JBI"));
        let job = (self.load)(&file).map_err(|error| match error.kind() {
            ProgramErrorKind::Unreadable(why) => {
                let rule = format!("one that lies beside: {}: {why}", file.display());
                Fault::Here(ProgramErrorKind::value(
                    "the job that is called",
                    name,
                    rule,
                ))
            }
            _ => Fault::There(error),
        })?;
        let own = (self.own)(&job).map_err(Fault::There)?;
        let read = Rc::new((job, own));
        self.read.insert(key, read.clone());
        Ok(read)
    }
}

/// What is wrong with a call: with itself, or in the job that it calls.
enum Fault {
    Here(ProgramErrorKind),
    There(ProgramError),
}

impl From<ProgramErrorKind> for Fault {
    fn from(kind: ProgramErrorKind) -> Self {
        Self::Here(kind)
    }
}
