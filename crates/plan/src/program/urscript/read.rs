//! From a script to a program.

use std::collections::BTreeMap;
use std::path::Path;

use nalgebra::Vector3;
use truecut_arm::{Robot, ToolLoad};

use super::eval::{Arguments, Value, Variables, arguments, value};
use super::{JOINT_TOP_RAD_PER_S, POINT, SYNTAX, check_name};
use crate::program::dialect::{Frames, ReadText, Settings};
use crate::program::reading::{Goal, Notes, Step, follow};
use crate::program::source::{LINE_END, Source};
use crate::program::{Motion, Program, ProgramError, ProgramErrorKind, SpindleSwitch, Tool, Zone};

const WANTED: &str = "movej, movel, movep, movec, an assignment, a setting or end";
/// Functions that move nothing; they are left aside with a note, as are those whose names begin
/// with [`SETTING`].
const IDLE: &[&str] = &[
    "sleep",
    "sync",
    "textmsg",
    "popup",
    "stopl",
    "stopj",
    "zero_ftsensor",
];
/// What steers the program: what it leads to is not known before it runs.
const CONTROL: &[&str] = &[
    "if",
    "elif",
    "else",
    "while",
    "break",
    "continue",
    "return",
    "def",
    "thread",
    "run",
    "join",
    "kill",
    "switch",
    "case",
    "enter_critical",
    "exit_critical",
];
const SETTING: [&str; 3] = ["set_", "write_", "reset_"];
const OUTPUTS: [&str; 2] = ["set_standard_digital_out", "set_digital_out"];

struct ScriptReader<'a> {
    source: Source<'a>,
    variables: Variables,
    output: Option<u32>,
    /// Path points by the line that they stand before.
    points: BTreeMap<usize, usize>,
    next_point: usize,
    notes: Notes,
    head: Program,
    steps: Vec<Step>,
    /// Behind `halt`.
    has_halted: bool,
    has_tool: bool,
}

/// Reads a script.
///
/// # Errors
/// At the first piece that is not understood.
pub(super) fn read(
    file: &Path,
    text: &ReadText<'_>,
    robot: &Robot,
    frames: &Frames,
    settings: &Settings,
) -> Result<Program, ProgramError> {
    let text = text(file).map_err(|error| ProgramError::in_file(file, None, error.into()))?;
    let text = without_marks(&text);
    let output = settings.spindle_number();
    let output = output.map_err(ProgramErrorKind::from)?;
    let point = |(i, line): (usize, &str)| {
        let number = line.trim().strip_prefix(POINT)?;
        Some((i + 2, number.trim().parse().ok()?))
    };
    let mut reader = ScriptReader {
        source: Source::new(&text, file, &SYNTAX),
        variables: Variables::new(),
        output,
        points: text.lines().enumerate().filter_map(point).collect(),
        next_point: 0,
        notes: Notes::default(),
        head: Program {
            name: String::new(),
            comment: String::new(),
            tool: Tool {
                load: None,
                ..frames.tool.clone()
            },
            world_from_base: frames.world_from_base,
            moves: Vec::new(),
            spindle: Vec::new(),
            notes: Vec::new(),
        },
        steps: Vec::new(),
        has_halted: false,
        has_tool: false,
    };
    reader.script()?;
    reader.head.notes = reader.notes.texts();
    follow(reader.head, reader.steps, robot, file)
}

/// The text with the marks emptied by which PolyScope tells its tree's lines (`$ 3 "MoveL"`).
fn without_marks(text: &str) -> String {
    let line = |line: &str| match line.trim_start().starts_with('$') {
        true => "\n".to_owned(),
        false => format!("{line}\n"),
    };
    text.lines().map(line).collect()
}

impl ScriptReader<'_> {
    fn script(&mut self) -> Result<(), ProgramError> {
        self.source.expect(&["def"])?;
        let name = self.source.word("the program's name")?.to_owned();
        check_name(&name).map_err(|kind| self.fault(kind))?;
        self.source.expect(&["(", ")", ":", LINE_END])?;
        while self.statement()? {}
        // A call of the function may stand at the end.
        while !self.source.ended() {
            self.source.expect(&[&name, "(", ")", LINE_END])?;
        }
        self.head.name = name;
        self.note_overlaps();
        if let (false, Some(step)) = (self.has_tool, self.steps.first()) {
            let text = "no set_tcp stands in the script; the robot's own tool is taken";
            self.notes.add(step.line, text);
        }
        Ok(())
    }

    /// Where blends of two points on lines overlap, the controller skips one of the moves.
    fn note_overlaps(&mut self) {
        let place = |step: &Step| match (&step.goal, step.zone) {
            (Goal::Pose(pose, _) | Goal::Near(pose, _), Zone::Within(blend_m)) => {
                Some((pose.translation.vector, blend_m))
            }
            _ => None,
        };
        for pair in self.steps.windows(2) {
            let (Some((from, before)), Some((to, own))) = (place(&pair[0]), place(&pair[1])) else {
                continue;
            };
            if pair[1].via.is_none() && before + own > (to - from).norm() {
                let text = "its blend overlaps with that of the move before: the controller skips one of them";
                self.notes.add(pair[1].line, text);
            }
        }
    }

    fn fault(&self, kind: ProgramErrorKind) -> ProgramError {
        self.source.error(self.source.last_line(), kind)
    }

    /// Whether another one follows.
    fn statement(&mut self) -> Result<bool, ProgramError> {
        let line = self.source.line();
        let mut word = self.source.word(WANTED)?;
        if word == "end" {
            self.source.expect(&[LINE_END])?;
            return Ok(false);
        }
        if word == "halt" {
            if self.source.take("(") {
                self.source.expect(&[")"])?;
            }
            self.has_halted = true;
            self.source.expect(&[LINE_END])?;
            return Ok(true);
        }
        if CONTROL.contains(&word) {
            let kind = ProgramErrorKind::not_read(word, "what branches, loops or runs beside");
            return Err(self.fault(kind));
        }
        if matches!(word, "global" | "local") {
            word = self.source.word("a name")?;
        }
        if self.source.take("=") {
            let value = value(&mut self.source, &self.variables, 0)?;
            self.variables.insert(word.to_owned(), value);
        } else if self.source.comes("(") {
            self.call(word, line)?;
        } else {
            return Err(self.source.unexpected(WANTED));
        }
        self.source.expect(&[LINE_END])?;
        Ok(true)
    }

    fn call(&mut self, word: &str, line: usize) -> Result<(), ProgramError> {
        let moves = matches!(word, "movej" | "movel" | "movep" | "movec");
        let known = matches!(word, "set_tcp" | "set_payload" | "set_target_payload")
            || OUTPUTS.contains(&word);
        let is_setting = SETTING.iter().any(|begin| word.starts_with(begin)) && !known;
        if IDLE.contains(&word) || is_setting {
            self.notes.add(line, format!("{word} is left aside"));
            while !self.source.comes(LINE_END) {
                self.source.skip_one(LINE_END)?;
            }
            return Ok(());
        }
        if !(moves || known) {
            return Err(self.source.unexpected(WANTED));
        }
        let given = arguments(&mut self.source, &self.variables, 0)?;
        if self.has_halted {
            self.notes.add(line, "what stands behind halt is not run");
            return Ok(());
        }
        let done = match word {
            _ if moves => self.motion(word, &given, line),
            _ if OUTPUTS.contains(&word) => self.switch(&given, line),
            _ => self.setting(&given, line),
        };
        done.map_err(|kind| self.source.error(line, kind))
    }

    fn setting(&mut self, given: &Arguments, line: usize) -> Result<(), ProgramErrorKind> {
        let values: Vec<&Value> = given.iter().map(|(_, value)| value).collect();
        match values.as_slice() {
            [Value::Pose(tcp), ..] => {
                let tool = &mut self.head.tool.flange_from_tool;
                if !self.steps.is_empty() && tool != tcp {
                    let rule = "that of the moves before: one tool is read";
                    return Err(ProgramErrorKind::value("the tool", "another", rule));
                }
                *tool = *tcp;
                self.has_tool = true;
            }
            [Value::Number(mass_kg), rest @ ..] if *mass_kg > 0.0 => {
                let centre_m = match rest.first() {
                    Some(Value::List(parts)) if parts.len() == 3 => {
                        Vector3::from_column_slice(parts)
                    }
                    _ => Vector3::zeros(),
                };
                self.head.tool.load = Some(ToolLoad {
                    mass_kg: *mass_kg,
                    centre_m,
                });
            }
            _ => self
                .notes
                .add(line, "a tool or payload of another form is left aside"),
        }
        Ok(())
    }

    fn switch(&mut self, given: &Arguments, line: usize) -> Result<(), ProgramErrorKind> {
        let [(_, Value::Number(number)), (_, Value::Truth(on))] = given.as_slice() else {
            return Err(ProgramErrorKind::unexpected(
                "the arguments",
                "the number of an output, and True or False",
            ));
        };
        if self
            .output
            .is_some_and(|output| f64::from(output) == *number)
        {
            let before = self.steps.len();
            self.head.spindle.push(SpindleSwitch { before, on: *on });
        } else {
            self.notes
                .add(line, format!("output {number} is left aside"));
        }
        Ok(())
    }

    fn motion(
        &mut self,
        verb: &str,
        given: &Arguments,
        line: usize,
    ) -> Result<(), ProgramErrorKind> {
        let targets = if verb == "movec" { 2 } else { 1 };
        let (goals, numbers) = sorted(verb, targets, given)?;
        let wanted = if targets == 2 {
            "a point on the way and the end"
        } else {
            "one target"
        };
        let count = goals.len();
        let mut goals = goals.into_iter();
        let via = match (verb, count) {
            ("movec", 2) => match goals.next() {
                Some(Goal::Pose(via, _)) => Some(via),
                _ => return Err(ProgramErrorKind::unexpected("joints", "a pose on the way")),
            },
            (_, 1) if targets == 1 => None,
            _ => {
                return Err(ProgramErrorKind::unexpected(
                    &format!("{count} targets"),
                    wanted,
                ));
            }
        };
        let Some(goal) = goals.next() else {
            return Err(ProgramErrorKind::unexpected("no target", wanted));
        };
        if numbers.get("t").is_some_and(|time| *time != 0.0) {
            let rule = "0: a move is read by its speed";
            return Err(ProgramErrorKind::value("the time t", numbers["t"], rule));
        }
        let mode = numbers.get("mode").copied().unwrap_or_default();
        let rule = "0, evenly to the attitude of the end, or 1, with the tangent of the arc";
        let is_known = mode == 0.0 || mode == 1.0;
        ProgramErrorKind::unless(is_known, "the mode of movec", mode, rule)?;
        let (default, rule) = match verb {
            "movej" => (1.05, "above zero, in rad/s"),
            _ => (0.25, "above zero, in m/s"),
        };
        let speed = numbers.get("v").copied().unwrap_or(default);
        ProgramErrorKind::unless(speed > 0.0, "the speed v", speed, rule)?;
        let blend = numbers.get("r").copied().unwrap_or(0.0);
        ProgramErrorKind::unless(blend >= 0.0, "the blend r", blend, "zero or above, in m")?;
        if let Some(point) = self.points.get(&line) {
            self.next_point = *point;
        }
        ProgramErrorKind::unless_too_many(self.steps.len() + 1)?;
        self.steps.push(Step {
            line,
            path_point: Some(self.next_point),
            goal,
            via,
            with_tangent: mode == 1.0,
            motion: match verb {
                "movej" => Motion::Joint {
                    share: (speed / JOINT_TOP_RAD_PER_S).min(1.0),
                },
                _ => Motion::Linear {
                    speed_m_per_s: speed,
                },
            },
            zone: if blend > 0.0 {
                Zone::Within(blend)
            } else {
                Zone::Stop
            },
            turntable_rad: None,
        });
        self.next_point += 1;
        Ok(())
    }
}

/// The targets of a move, and its numbers by name.
fn sorted<'a>(
    verb: &str,
    targets: usize,
    given: &'a Arguments,
) -> Result<(Vec<Goal>, BTreeMap<&'a str, f64>), ProgramErrorKind> {
    let positions: &[&str] = match verb {
        "movec" => &["a", "v", "r", "mode"],
        "movep" => &["a", "v", "r"],
        _ => &["a", "v", "t", "r"],
    };
    let mut numbers: BTreeMap<&str, f64> = BTreeMap::new();
    let mut goals = Vec::new();
    for (i, (name, value)) in given.iter().enumerate() {
        let key = match name.as_deref() {
            Some(name) if name != "q" && name != "pose" && !name.starts_with("pose_") => Some(name),
            None if i >= targets => positions.get(i - targets).copied(),
            _ => None,
        };
        match (key, value) {
            (Some(key), Value::Number(number)) => {
                numbers.insert(key, *number);
            }
            (None, Value::Pose(pose) | Value::NearPose(pose, None)) => {
                goals.push(Goal::Pose(*pose, None))
            }
            (None, Value::NearPose(pose, Some(near))) => {
                goals.push(Goal::Near(*pose, near.clone()))
            }
            (None, Value::List(joints)) => goals.push(Goal::Joints(joints.clone())),
            _ => {
                let what = format!("argument {} of {verb}", i + 1);
                return Err(ProgramErrorKind::unexpected(&what, "a target or a number"));
            }
        }
    }
    Ok((goals, numbers))
}
