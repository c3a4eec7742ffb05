//! From a program to jobs.

use nalgebra::Isometry3;
use truecut_arm::{OpwGeometry, Robot};

use super::{
    JbiOptions, LAST_TOOL, NAME_CHARS, PositionFormat, Rconf, TURN_JOINTS, V_MM_PER_S, VJ_PERCENT,
    check_comment, check_name, pulses_per_unit, rconf_text,
};
use crate::program::dialect::NOT_LOADED;
use crate::program::number::fixed;
use crate::program::{Motion, Move, Program, ProgramError, ProgramErrorKind, ProgramFile, Zone};

/// Writes a program as one job; as several and one that calls them in turn if it has more
/// instruction lines than fit.
///
/// # Errors
/// If the name, the comment, the tool number or a speed is one that the dialect cannot hold, a
/// joint stands where the manipulator type cannot say it, pulses are wanted and not known, or the
/// program contradicts itself.
pub fn write(
    program: &Program,
    robot: &Robot,
    options: &JbiOptions,
) -> Result<Vec<ProgramFile>, ProgramError> {
    check_name(&program.name)?;
    check_comment(&program.comment)?;
    let (tool, lines) = (program.tool.number, options.lines_per_job);
    let rule = format!("from 0 to {LAST_TOOL}");
    ProgramErrorKind::unless(tool <= LAST_TOOL, "the tool number", tool, rule)?;
    let rule = "at least 5: NOP, a comment, a move with its point, END";
    ProgramErrorKind::unless(lines >= 5, "lines per job", lines, rule)?;
    program.check(robot)?;
    let writer = JobWriter::new(program, robot, options)?;
    let parts = writer.parts();
    if parts.len() <= 1 {
        return Ok(vec![writer.job(&program.name, &program.moves, 0)?]);
    }
    let names = part_names(&program.name, parts.len())?;
    let mut files = vec![writer.caller(&names)];
    let mut first = 0;
    for (name, part) in names.iter().zip(&parts) {
        files.push(writer.job(name, part, first)?);
        first += part.len();
    }
    Ok(files)
}

/// Names of the parts: as much of the program's name as leaves room for a number of two digits or
/// more.
fn part_names(name: &str, count: usize) -> Result<Vec<String>, ProgramErrorKind> {
    let digits = count.to_string().len().max(2);
    let stem: String = name.chars().take(NAME_CHARS - digits).collect();
    let names: Vec<String> = (1..=count).map(|i| format!("{stem}{i:0digits$}")).collect();
    let alone = names.iter().all(|part| part != name);
    let rule = "one that the names of the parts into which the job is split do not repeat";
    ProgramErrorKind::unless(alone, "the job name", format!("\"{name}\""), rule)?;
    Ok(names)
}

/// Jobs that a caller names and that are parts of the program of this name, as [`part_names`] has
/// them. Others that it calls belong to somebody else.
pub(super) fn parts_called(name: &str, caller: &str) -> Vec<String> {
    let lines = caller.lines().map(str::trim);
    let called = lines.filter_map(|line| line.strip_prefix("CALL JOB:"));
    let is_part = |job: &&str| {
        (2..NAME_CHARS).any(|digits| {
            let stem: String = name.chars().take(NAME_CHARS - digits).collect();
            let number = job.strip_prefix(&*stem).unwrap_or_default();
            number.len() == digits && number.bytes().all(|c| c.is_ascii_digit())
        })
    };
    called.filter(is_part).map(str::to_owned).collect()
}

struct JobWriter<'a> {
    program: &'a Program,
    robot: &'a Robot,
    options: &'a JbiOptions,
    geometry: Option<OpwGeometry>,
    with_station: bool,
}

impl<'a> JobWriter<'a> {
    fn new(
        program: &'a Program,
        robot: &'a Robot,
        options: &'a JbiOptions,
    ) -> Result<Self, ProgramErrorKind> {
        let geometry = match options.format {
            PositionFormat::Pulse => None,
            PositionFormat::Rectangular => Some(
                OpwGeometry::of(robot)
                    .ok_or_else(|| ProgramErrorKind::not_ortho_parallel(robot))?,
            ),
        };
        let with_station = program.moves.iter().any(|m| m.turntable_rad.is_some());
        if with_station {
            let pulses = options.station_pulses_per_deg;
            let per_deg = pulses.ok_or(ProgramErrorKind::NoStationPulses)?;
            let what = "the station's pulses per degree";
            let counts = per_deg.is_finite() && per_deg > 0.0;
            ProgramErrorKind::unless(counts, what, per_deg, "above zero and finite")?;
            percent("the station's speed", options.station_share)?;
        }
        Ok(Self {
            program,
            robot,
            options,
            geometry,
            with_station,
        })
    }

    /// The moves, cut so that NOP, points, moves and END fit into a job.
    fn parts(&self) -> Vec<&'a [Move]> {
        // Without NOP, the comment after it and END.
        let room = self.options.lines_per_job - 3;
        let moves = &self.program.moves;
        let mut parts = Vec::new();
        let (mut start, mut lines) = (0, 0);
        for i in 0..moves.len() {
            let switches = self.program.switches(i).count()
                + match i + 1 == moves.len() {
                    true => self.program.switches(moves.len()).count(),
                    false => 0,
                };
            let needs = |first| 1 + usize::from(names_point(moves, i, first)) + switches;
            if lines + needs(start) > room && i > start {
                parts.push(&moves[start..i]);
                (start, lines) = (i, 0);
            }
            lines += needs(start);
        }
        parts.push(&moves[start..]);
        parts
    }

    fn head(&self, name: &str, positions: usize) -> Vec<String> {
        let stations = if self.with_station { positions } else { 0 };
        vec![
            "/JOB".to_owned(),
            format!("//NAME {name}"),
            "//POS".to_owned(),
            format!("///NPOS {positions},0,{stations},0,0,0"),
        ]
    }

    fn foot(&self, instructions: impl IntoIterator<Item = String>) -> Vec<String> {
        let mut lines = vec![
            "//INST".to_owned(),
            format!("///DATE {}", self.options.date),
        ];
        if !self.program.comment.is_empty() {
            lines.push(format!("///COMM {}", self.program.comment));
        }
        lines.extend(["///ATTR SC,RW".to_owned(), "///GROUP1 RB1".to_owned()]);
        if self.with_station {
            lines.push("///GROUP2 ST1".to_owned());
        }
        lines.push("NOP".to_owned());
        lines.push(format!("'{}", NOT_LOADED.to_uppercase()));
        lines.extend(instructions);
        lines.push("END".to_owned());
        lines
    }

    fn caller(&self, names: &[String]) -> ProgramFile {
        let mut lines = self.head(&self.program.name, 0);
        lines.extend(self.foot(names.iter().map(|name| format!("CALL JOB:{name}"))));
        file(&self.program.name, &lines)
    }

    fn job(
        &self,
        name: &str,
        moves: &[Move],
        first: usize,
    ) -> Result<ProgramFile, ProgramErrorKind> {
        let mut lines = self.head(name, moves.len());
        lines.push(format!("///TOOL {}", self.program.tool.number));
        match &self.geometry {
            Some(geometry) => self.rectangular(geometry, moves, &mut lines)?,
            None => {
                lines.extend(["///POSTYPE PULSE".to_owned(), "///PULSE".to_owned()]);
                for (i, step) in moves.iter().enumerate() {
                    lines.push(format!("C{i:05}={}", self.pulses(step)?));
                }
            }
        }
        if self.with_station {
            if self.geometry.is_some() {
                lines.extend(["///POSTYPE PULSE".to_owned(), "///PULSE".to_owned()]);
            }
            let per_deg = self.options.station_pulses_per_deg.unwrap_or_default();
            for (i, step) in moves.iter().enumerate() {
                let angle = step.turntable_rad.unwrap_or_default().to_degrees();
                lines.push(format!("EC{i:05}={}", fixed(angle * per_deg, 0)));
            }
        }
        let mut instructions = Vec::with_capacity(moves.len());
        for (i, step) in moves.iter().enumerate() {
            instructions.extend(self.spindle(first + i));
            if names_point(&self.program.moves, first + i, first) {
                instructions.push(format!("'POINT {}", step.path_point));
            }
            instructions.push(self.instruction(i, step)?);
        }
        if first + moves.len() == self.program.moves.len() {
            instructions.extend(self.spindle(first + moves.len()));
        }
        lines.extend(self.foot(instructions));
        Ok(file(name, &lines))
    }

    /// Instructions that switch the spindle before a move; comments where no output is named.
    fn spindle(&self, before: usize) -> impl Iterator<Item = String> {
        let output = self.options.spindle_output;
        self.program.switches(before).map(move |on| {
            let state = if on { "ON" } else { "OFF" };
            output.map_or_else(
                || format!("'SPINDLE {state}"),
                |number| format!("DOUT OT#({number}) {state}"),
            )
        })
    }

    fn rectangular(
        &self,
        geometry: &OpwGeometry,
        moves: &[Move],
        lines: &mut Vec<String>,
    ) -> Result<(), ProgramErrorKind> {
        lines.extend(["///POSTYPE BASE".to_owned(), "///RECTAN".to_owned()]);
        let mut last = None;
        for (i, step) in moves.iter().enumerate() {
            self.check_turns(step)?;
            let rconf = Rconf::of(geometry, &step.posture);
            if last != Some(rconf) {
                lines.push(format!("///RCONF {}", rconf_text(&rconf)));
                last = Some(rconf);
            }
            lines.push(format!("C{i:05}={}", pose_text(&step.base_from_tool)));
        }
        Ok(())
    }

    /// The flags tell turns apart to ±360°.
    fn check_turns(&self, step: &Move) -> Result<(), ProgramErrorKind> {
        let joints = &self.robot.chain.joints;
        let beyond = TURN_JOINTS.into_iter().find(|&joint| {
            let deg = step.posture[joint].to_degrees();
            !(deg > -360.0 && deg <= 360.0)
        });
        beyond.map_or(Ok(()), |joint| {
            Err(ProgramErrorKind::Unspeakable {
                path_point: step.path_point,
                joint: joints[joint].name.clone(),
                value_deg: step.posture[joint].to_degrees(),
                rule: "the manipulator type tells angles above -360 to 360 deg apart",
            })
        })
    }

    fn pulses(&self, step: &Move) -> Result<String, ProgramErrorKind> {
        let joints = self.robot.chain.joints.iter().zip(&step.posture);
        let counts = joints.map(|(joint, q)| Ok(fixed(q * pulses_per_unit(joint)?, 0)));
        let counts: Result<Vec<String>, ProgramErrorKind> = counts.collect();
        Ok(counts?.join(","))
    }

    fn instruction(&self, i: usize, step: &Move) -> Result<String, ProgramErrorKind> {
        let mut text = match step.motion {
            Motion::Joint { share } => {
                format!("MOVJ C{i:05} VJ={}", percent("the speed VJ", share)?)
            }
            Motion::Linear { speed_m_per_s } => {
                let mm_per_s = speed_m_per_s * 1e3;
                let (low, high) = V_MM_PER_S;
                if !(low..=high).contains(&mm_per_s) {
                    let rule = format!("from {low} to {high} mm/s");
                    return Err(ProgramErrorKind::at_point(
                        step.path_point,
                        "speed V",
                        mm_per_s,
                        &rule,
                    ));
                }
                format!("MOVL C{i:05} V={}", fixed(mm_per_s, 1))
            }
        };
        if step.zone == Zone::Stop {
            text.push_str(" PL=0");
        }
        if self.with_station {
            let share = percent("the station's speed", self.options.station_share)?;
            text.push_str(&format!(" +MOVJ EC{i:05} VJ={share}"));
        }
        Ok(text)
    }
}

/// Whether the point of a move is named: at the start of a job whose first point is not 0, and
/// where numbers leap.
fn names_point(moves: &[Move], i: usize, first: usize) -> bool {
    let expected = if i == first {
        0
    } else {
        moves[i - 1].path_point + 1
    };
    moves[i].path_point != expected
}

fn percent(what: &str, share: f64) -> Result<String, ProgramErrorKind> {
    let (low, high) = VJ_PERCENT;
    let percent = share * 100.0;
    let rule = format!("from {low} to {high} %");
    ProgramErrorKind::unless((low..=high).contains(&percent), what, percent, rule)?;
    Ok(fixed(percent, 2))
}

/// `X,Y,Z,Rx,Ry,Rz`: mm, and degrees about the base's fixed axes x, then y, then z.
fn pose_text(pose: &Isometry3<f64>) -> String {
    let mm = (pose.translation.vector * 1e3).map(|v| fixed(v, 3));
    let (rx, ry, rz) = pose.rotation.euler_angles();
    let deg = [rx, ry, rz].map(|angle| fixed(angle.to_degrees(), 4));
    format!("{},{},{},{}", mm[0], mm[1], mm[2], deg.join(","))
}

fn file(name: &str, lines: &[String]) -> ProgramFile {
    ProgramFile {
        name: format!("{name}.JBI"),
        text: lines.join("\r\n") + "\r\n",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever parts a job is split into, its caller's lines name them all, and no other job.
    #[test]
    fn parts_are_known_by_their_caller() {
        for name in ["C", "SPOKE", "SPOKE12", "POCKET_A", "A123456X"] {
            for count in [1, 9, 10, 99, 100, 250] {
                let parts = part_names(name, count).expect("names");
                let line = |job: &String| format!("CALL JOB:{job}\r\n");
                let own: String = parts.iter().map(line).collect();
                let caller =
                    format!("NOP\r\nCALL JOB:GRIP\r\n{own}CALL JOB:{name}\r\nCALL JOB:12\r\n");
                assert_eq!(parts_called(name, &caller), parts, "{name}, {count}");
            }
        }
    }
}
