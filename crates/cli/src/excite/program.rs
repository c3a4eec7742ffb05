//! A planned motion as a robot program: moves by joints through places on the way.

use serde_json::{Map, Value};
use truecut_arm::{FrameId, Masses, Robot};
use truecut_discrepancy::excite::Excitation;
use truecut_plan::program::{
    DIALECTS, Dialect, Motion, Move, Program, ProgramFile, Settings, Zone, dialect_for,
    dialect_named, maker_note,
};
use truecut_scenario::Scenario;

use crate::args::ExciteArguments;
use crate::failure::Failure;

/// Most time between the places of a program, s.
const BETWEEN_S: f64 = 0.2;
/// Places in a period of the fastest wave, at least.
const PLACES_A_WAVE: f64 = 10.0;
/// Share of the top speed of the move to the start.
const TO_THE_START: f64 = 0.1;
/// Least share of the top speed that a move has: a controller that rounds it to nothing stops.
const LEAST_SHARE: f64 = 0.005;
const NAME: &str = "EXCITE";

/// The language of the program, if one is asked for or the robot's name tells it.
pub struct Language {
    robot: Robot,
    dialect: Option<&'static dyn Dialect>,
    is_asked: bool,
    settings: Settings,
}

impl Language {
    /// # Errors
    /// A language that there is not; options that it does not have; a robot that cannot be loaded.
    pub fn of(scenario: &Scenario, arguments: &ExciteArguments) -> Result<Language, Failure> {
        let spec = &scenario.robot;
        let robot = Robot::read(&spec.urdf, &spec.reading(Masses::Needed))
            .map_err(|error| Failure::sim(scenario, error.into()))?;
        let dialect = match &arguments.dialect {
            None => dialect_for(&robot),
            Some(name) => Some(dialect_named(name).ok_or_else(|| {
                let known: Vec<&str> = DIALECTS.iter().map(|one| one.name()).collect();
                Failure::message(format!(
                    "--dialect is \"{name}\", but must be one of {}",
                    known.join(", ")
                ))
            })?),
        };
        let options: Map<String, Value> = (arguments.program_options.iter())
            .map(|(key, value)| {
                let parsed = serde_json::from_str(value);
                (
                    key.clone(),
                    parsed.unwrap_or_else(|_| Value::from(value.as_str())),
                )
            })
            .collect();
        let is_asked = arguments.dialect.is_some();
        if let Some(dialect) = dialect.filter(|_| is_asked || !options.is_empty()) {
            dialect.check(&options).map_err(|fault| {
                Failure::with_help(
                    format!("--dialect {}: {fault}", dialect.name()),
                    "give its options with --program-option KEY=VALUE",
                )
            })?;
        }
        Ok(Language {
            robot,
            dialect,
            is_asked,
            settings: Settings {
                options,
                ..Settings::default()
            },
        })
    }

    /// The files of the program, and what is to be said of it.
    ///
    /// # Errors
    /// What the language cannot say, where it was asked for.
    pub fn write(
        &self,
        planned: &Excitation,
    ) -> Result<(Vec<ProgramFile>, Option<String>), Failure> {
        let Some(dialect) = self.dialect else {
            let note = "no robot program: the robot's name does not tell its language; name it with --dialect";
            return Ok((Vec::new(), Some(note.to_owned())));
        };
        let tool = dialect.tool(&self.robot, &self.settings.options);
        let written = tool.map_err(|fault| fault.to_string()).and_then(|tool| {
            let program = self.program(planned, tool);
            let files = dialect.write(&program, &self.robot, &self.settings);
            files.map_err(|error| error.to_string())
        });
        match written {
            Ok(files) => Ok((files, maker_note(dialect, &self.robot))),
            Err(error) if self.is_asked => Err(Failure::message(format!(
                "--dialect {}: {error}",
                dialect.name()
            ))),
            Err(error) => Ok((
                Vec::new(),
                Some(format!("no robot program in {}: {error}", dialect.name())),
            )),
        }
    }

    fn program(&self, planned: &Excitation, tool: truecut_plan::program::Tool) -> Program {
        let interval_s = planned.time_s[1] - planned.time_s[0];
        let last = planned.time_s.len() - 1;
        let report = &planned.report;
        let fastest_s = report.duration_s / (report.periods * report.harmonics) as f64;
        let between_s = BETWEEN_S.min(fastest_s / PLACES_A_WAVE);
        let every = ((between_s / interval_s).round() as usize).clamp(1, last);
        let mut rows: Vec<usize> = (0..last).step_by(every).collect();
        rows.push(last);
        let posture = |row: usize| -> Vec<f64> {
            planned
                .motion
                .position
                .iter()
                .map(|joint| joint[row])
                .collect()
        };
        let mut moves: Vec<Move> = Vec::with_capacity(rows.len());
        for (path_point, &row) in rows.iter().enumerate() {
            let here = posture(row);
            let share = match moves.last() {
                None => TO_THE_START,
                Some(before) => {
                    let time_s = planned.time_s[row] - planned.time_s[rows[path_point - 1]];
                    let least_s = truecut_plan::motion::joints::slowest_joint_s(
                        &self.robot,
                        &before.posture,
                        &here,
                        1.0,
                    );
                    (least_s / time_s).clamp(LEAST_SHARE, 1.0)
                }
            };
            let flange = self.robot.world_from_frame(&here, FrameId::Flange);
            moves.push(Move {
                path_point,
                base_from_tool: flange * tool.flange_from_tool,
                motion: Motion::Joint { share },
                zone: match path_point == 0 || row == last {
                    true => Zone::Stop,
                    false => Zone::Unstated,
                },
                turntable_rad: None,
                posture: here,
            });
        }
        Program {
            name: NAME.to_owned(),
            comment: format!("{:.3} s", planned.report.duration_s),
            tool,
            world_from_base: nalgebra::Isometry3::identity(),
            moves,
            spindle: Vec::new(),
            notes: Vec::new(),
        }
    }
}
