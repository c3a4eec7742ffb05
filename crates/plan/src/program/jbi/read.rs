//! From a job's text to its positions and moves.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::fields::{IDLE, fields, missing, numbered, position_type, rconf, unexpected};
use super::job::{JbiCall, JbiJob, JbiMove, JbiPosition, JbiPositionValue};
use super::{LAST_LEVEL, LAST_TOOL, Rconf, V_MM_PER_S, VJ_PERCENT, check_read_name};
use crate::program::number::{finite, whole};
use crate::program::reading::Notes;
use crate::program::{Motion, ProgramError, ProgramErrorKind};

/// Where in the file the reader stands.
#[derive(PartialEq, Clone, Copy)]
enum JobSection {
    Job,
    Name,
    Pos,
    Positions,
    Head,
    Instructions,
    End,
}

struct JobReader<'a> {
    job: JbiJob,
    section: JobSection,
    line: usize,
    /// Line of `///NPOS`, positions and stations that it announces.
    announced: Option<(usize, usize, usize)>,
    kind: Option<&'a str>,
    rconf: Option<Rconf>,
    next_point: usize,
    notes: Notes,
}

/// What changes nothing of a move's way but its pace.
fn is_pace(word: &str) -> bool {
    word == "NWAIT" || word.starts_with("ACC=") || word.starts_with("DEC=")
}

impl JbiJob {
    /// Reads a job.
    ///
    /// # Errors
    /// At the first line that the dialect does not have, and if positions and moves do not belong
    /// together.
    pub fn parse(text: &str, path: &Path) -> Result<Self, ProgramError> {
        let mut reader = JobReader {
            job: Self {
                path: path.to_owned(),
                name: String::new(),
                comment: String::new(),
                tool: 0,
                positions: BTreeMap::new(),
                stations: BTreeMap::new(),
                moves: Vec::new(),
                calls: Vec::new(),
                outputs: Vec::new(),
                notes: Vec::new(),
            },
            notes: Notes::default(),
            section: JobSection::Job,
            line: 0,
            announced: None,
            kind: None,
            rconf: None,
            next_point: 0,
        };
        for (i, line) in text.lines().enumerate() {
            reader.line = i + 1;
            let line = line.trim();
            if !line.is_empty() {
                let read = reader.read(line);
                read.map_err(|kind| ProgramError::in_file(path, i + 1, kind))?;
            }
        }
        let line = reader.line.max(1);
        reader
            .whole()
            .map_err(|(at, kind)| ProgramError::in_file(path, at.unwrap_or(line), kind))?;
        reader.job.notes = reader.notes.texts();
        Ok(reader.job)
    }
}

impl<'a> JobReader<'a> {
    fn read(&mut self, line: &'a str) -> Result<(), ProgramErrorKind> {
        match self.section {
            JobSection::Job => self.marker(line, "/JOB", JobSection::Name),
            JobSection::Name => {
                let name = line.strip_prefix("//NAME ");
                let name = name.ok_or_else(|| unexpected(line, "//NAME"))?.trim();
                check_read_name(name)?;
                name.clone_into(&mut self.job.name);
                self.section = JobSection::Pos;
                Ok(())
            }
            JobSection::Pos if line.starts_with("///FOLDERNAME") => Ok(()),
            JobSection::Pos => self.marker(line, "//POS", JobSection::Positions),
            JobSection::Positions => self.in_positions(line),
            JobSection::Head => self.instruction_head(line),
            JobSection::Instructions => self.instruction(line),
            JobSection::End => Err(unexpected(line, "the end of the file, after END,")),
        }
    }

    fn marker(
        &mut self,
        line: &str,
        wanted: &str,
        next: JobSection,
    ) -> Result<(), ProgramErrorKind> {
        if line != wanted {
            return Err(unexpected(line, wanted));
        }
        self.section = next;
        Ok(())
    }

    fn in_positions(&mut self, line: &'a str) -> Result<(), ProgramErrorKind> {
        let (word, rest) = line.split_once(' ').unwrap_or((line, ""));
        match word {
            "//INST" => self.section = JobSection::Head,
            "///NPOS" => {
                let counts = fields(rest, "///NPOS", &[6])?;
                let counts = counts.iter().map(|text| whole::<usize>(text, "///NPOS"));
                let counts: Vec<usize> = counts.collect::<Result<_, _>>()?;
                let others = [1, 3, 4, 5].map(|kind| counts[kind]);
                let rule = "C and EC positions only: BC, P, BP and EX must be 0";
                ProgramErrorKind::unless(others == [0; 4], "///NPOS", rest, rule)?;
                self.announced = Some((self.line, counts[0], counts[2]));
            }
            "///TOOL" => {
                let number = whole(rest, "///TOOL")?;
                if !self.job.positions.is_empty() && number != self.job.tool {
                    let rule = format!("{}, as before: one tool is read", self.job.tool);
                    return Err(ProgramErrorKind::value("///TOOL", number, rule));
                }
                self.job.tool = number;
                let rule = format!("from 0 to {LAST_TOOL}");
                ProgramErrorKind::unless(self.job.tool <= LAST_TOOL, "///TOOL", rest, rule)?;
            }
            // The frame of positions of the type USER, which are refused by their type.
            "///USER" => {}
            "///POSTYPE" => self.kind = Some(position_type(rest.trim())?),
            "///RECTAN" | "///PULSE" => {
                let fits = self.kind == Some(if word == "///PULSE" { "PULSE" } else { "BASE" });
                if !fits {
                    return Err(unexpected(word, "the form that ///POSTYPE announces"));
                }
            }
            "///RCONF" => self.rconf = Some(rconf(rest)?),
            _ if line.starts_with("EC") || line.starts_with('C') => self.position(line)?,
            _ => return Err(unexpected(line, "a position or //INST")),
        }
        Ok(())
    }

    fn position(&mut self, line: &str) -> Result<(), ProgramErrorKind> {
        let (name, values) = line
            .split_once('=')
            .ok_or_else(|| unexpected(line, "a position `C00000=...`"))?;
        let kind = self
            .kind
            .ok_or_else(|| unexpected(line, "///POSTYPE, before any position,"))?;
        let station = name.starts_with("EC");
        let number: u32 = whole(name.trim_start_matches(['E', 'C']), "the position's number")?;
        let known = if station {
            self.job.stations.get(&number).map(|(_, line)| *line)
        } else {
            self.job.positions.get(&number).map(|known| known.line)
        };
        if let Some(first_line) = known {
            let what = name.to_owned();
            return Err(ProgramErrorKind::Twice { what, first_line });
        }
        if station {
            if kind != "PULSE" {
                return Err(unexpected(
                    name,
                    "///POSTYPE PULSE, before a station's position,",
                ));
            }
            let text = fields(values, name, &[1])?[0];
            let pulses: i64 = whole(text, name)?;
            self.job.stations.insert(number, (pulses as f64, self.line));
            return Ok(());
        }
        ProgramErrorKind::unless_too_many(self.job.positions.len() + 1)?;
        let value = if kind == "PULSE" {
            let pulses = values
                .split(',')
                .map(|text| Ok(whole::<i64>(text, name)? as f64));
            JbiPositionValue::Pulses(pulses.collect::<Result<_, ProgramErrorKind>>()?)
        } else {
            let texts = fields(values, name, &[6])?;
            let mut numbers = [0.0; 6];
            for (number, text) in numbers.iter_mut().zip(texts) {
                *number = finite(text, name)?;
            }
            let [x, y, z, rx, ry, rz] = numbers;
            let rconf = self.rconf;
            JbiPositionValue::Rectangular {
                xyz_mm: [x, y, z],
                rxyz_deg: [rx, ry, rz],
                rconf: rconf.ok_or_else(|| unexpected(name, "///RCONF, before a pose,"))?,
            }
        };
        let line = self.line;
        self.job
            .positions
            .insert(number, JbiPosition { line, value });
        Ok(())
    }

    fn instruction_head(&mut self, line: &str) -> Result<(), ProgramErrorKind> {
        let (word, rest) = line.split_once(' ').unwrap_or((line, ""));
        match word {
            "NOP" => self.section = JobSection::Instructions,
            "///COMM" => {
                rest.clone_into(&mut self.job.comment);
            }
            "///DATE" | "///ATTR" | "///GROUP1" | "///GROUP2" | "///LVARS" => {}
            _ => {
                return Err(unexpected(
                    line,
                    "///DATE, ///COMM, ///ATTR, ///GROUP1, ///GROUP2 or NOP",
                ));
            }
        }
        Ok(())
    }

    fn instruction(&mut self, line: &str) -> Result<(), ProgramErrorKind> {
        if line == "END" {
            self.section = JobSection::End;
        } else if let Some(point) = line.strip_prefix("'POINT ") {
            self.next_point = whole(point, "the path point")?;
        } else if let Some(name) = line.strip_prefix("CALL JOB:") {
            check_read_name(name)?;
            self.job.calls.push(JbiCall {
                line: self.line,
                name: name.to_owned(),
                moves: self.job.moves.len(),
                outputs: self.job.outputs.len(),
            });
        } else if let Some(output) = line.strip_prefix("DOUT OT#(") {
            let wanted = "DOUT OT#(number) ON or OFF";
            let parts = output.split_once(") ");
            let (number, state) = parts.ok_or_else(|| unexpected(line, wanted))?;
            let on = match state.trim() {
                "ON" => true,
                "OFF" => false,
                _ => return Err(unexpected(line, wanted)),
            };
            let before = self.job.moves.len();
            let number = whole(number, "the number of an output")?;
            self.job.outputs.push((before, number, on));
        } else if let Some(idle) = IDLE.iter().find(|idle| line.starts_with(**idle)) {
            self.notes
                .add(self.line, format!("{} is left aside", idle.trim()));
        } else if !line.starts_with('\'') {
            for word in line.split_whitespace().filter(|word| is_pace(word)) {
                let text = format!("{word} of a move is left aside");
                self.notes.add(self.line, text);
            }
            ProgramErrorKind::unless_too_many(self.job.moves.len() + 1)?;
            let step = self.move_of(line)?;
            self.job.moves.push(step);
            self.next_point += 1;
        }
        Ok(())
    }

    fn move_of(&self, line: &str) -> Result<JbiMove, ProgramErrorKind> {
        let words = line.split_whitespace().filter(|word| !is_pace(word));
        let words: Vec<&str> = words.collect();
        let (main, mut beside) = words.split_at(words.len().min(3));
        let mut level = None;
        if let [first, rest @ ..] = beside
            && let Some(text) = first.strip_prefix("PL=")
        {
            let number: u8 = whole(text, "PL")?;
            ProgramErrorKind::unless(number <= LAST_LEVEL, "PL", number, "from 0 to 8")?;
            (level, beside) = (Some(number), rest);
        }
        let &[verb, position, speed] = main else {
            return Err(unexpected(line, "MOVJ, MOVL, CALL or END"));
        };
        let in_range =
            |text: &str, key: &str, (low, high): (f64, f64)| -> Result<f64, ProgramErrorKind> {
                let value = text.strip_prefix(key).and_then(|t| t.strip_prefix('='));
                let value = value.ok_or_else(|| unexpected(text, &format!("{key}=")))?;
                let number = finite(value, key)?;
                let rule = format!("from {low} to {high}");
                ProgramErrorKind::unless((low..=high).contains(&number), key, value, rule)?;
                Ok(number)
            };
        let motion = match verb {
            "MOVL" => Motion::Linear {
                speed_m_per_s: in_range(speed, "V", V_MM_PER_S)? * 1e-3,
            },
            "MOVJ" => Motion::Joint {
                share: in_range(speed, "VJ", VJ_PERCENT)? * 1e-2,
            },
            _ => {
                return Err(unexpected(verb, "MOVJ, MOVL, CALL or END"));
            }
        };
        let station = match beside {
            [] => None,
            ["+MOVJ", station, speed] => {
                in_range(speed, "VJ", VJ_PERCENT)?;
                let number = numbered(station, "EC")?;
                let known = self.job.stations.contains_key(&number);
                Some(known.then_some(number).ok_or_else(|| missing(station))?)
            }
            _ => {
                return Err(unexpected(
                    &beside.join(" "),
                    "+MOVJ EC... VJ=... or nothing",
                ));
            }
        };
        let number = numbered(position, "C")?;
        if !self.job.positions.contains_key(&number) {
            return Err(missing(position));
        }
        Ok(JbiMove {
            line: self.line,
            path_point: self.next_point,
            motion,
            position: number,
            station,
            level,
        })
    }

    /// What only the whole job shows, with the line if it is not the last.
    fn whole(&self) -> Result<(), (Option<usize>, ProgramErrorKind)> {
        if self.section != JobSection::End {
            let missing = match self.section {
                JobSection::Job => "/JOB",
                JobSection::Name => "//NAME",
                JobSection::Pos => "//POS",
                JobSection::Positions => "//INST",
                JobSection::Head => "NOP",
                _ => "END",
            };
            let missing = missing.to_owned();
            return Err((None, ProgramErrorKind::Truncated { missing }));
        }
        let job = &self.job;
        let Some((line, said, said_stations)) = self.announced else {
            let missing = "///NPOS".to_owned();
            return Err((None, ProgramErrorKind::Truncated { missing }));
        };
        let counts = [
            ("///NPOS", said, job.positions.len()),
            ("///NPOS (EC)", said_stations, job.stations.len()),
        ];
        for (what, said, found) in counts {
            if said != found {
                return Err((Some(line), ProgramErrorKind::Count { what, said, found }));
            }
        }
        let used: BTreeSet<u32> = job.moves.iter().map(|step| step.position).collect();
        let idle = job
            .positions
            .iter()
            .find(|(number, _)| !used.contains(number));
        let idle = idle.map(|(number, position)| (format!("C{number:05}"), position.line));
        let used: BTreeSet<u32> = job.moves.iter().filter_map(|step| step.station).collect();
        let still = job
            .stations
            .iter()
            .find(|(number, _)| !used.contains(number));
        let still = still.map(|(number, (_, line))| (format!("EC{number:05}"), *line));
        idle.or(still).map_or(Ok(()), |(name, line)| {
            Err((Some(line), ProgramErrorKind::UnusedPosition { name }))
        })
    }
}
