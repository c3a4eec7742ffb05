//! Tests that every [`Dialect`] must pass, ours and a user's own (feature `contract`).
//!
//! [`dialect_contract!`](crate::dialect_contract) makes a `#[test]` of each:
//!
//! ```text
//! truecut_plan::dialect_contract!(mine, Subject { dialect: &Mine, robot: robot(), options });
//! ```
//!
//! Programs are random, from seeds: a walk in joint space away from singularities, limits and whole
//! quarters of a turn (at which flags of branches change), lines and moves by joints, with and
//! without a turntable. A failure names its seed.

mod random;

use std::path::{Path, PathBuf};

use nalgebra::Isometry3;
use serde_json::Value;
use truecut_arm::{FrameId, Robot};

use super::dialect::{Dialect, Frames, Options, ProgramFile, Settings, TurntableUnit};
use super::error::ProgramError;
use super::moves::{Motion, Move, Program, Zone};
use random::Random;

/// Seeds of the random programs.
const SEEDS: std::ops::Range<u64> = 0..40;
/// Of a program that is damaged everywhere.
const MOVES_WHEN_DAMAGED: usize = 3;
/// Pulses per degree of the turntable, where the dialect holds pulses.
const PULSES_PER_DEG: f64 = 1000.0;
/// What inverse kinematics leave, m and rad.
const KINEMATICS: f64 = 1e-8;
/// Two branches or turns of a regular posture differ by more than this in some joint, rad; what the
/// printed decimals do to a joint is far less.
const SAME_BRANCH_RAD: f64 = 0.02;

/// A dialect under test.
pub struct Subject {
    pub dialect: &'static dyn Dialect,
    /// An arm that the dialect can write for.
    pub robot: Robot,
    /// Options with which it writes.
    pub options: Options,
}

/// What is written is read back as the same program, within the resolution that the dialect states.
///
/// # Panics
/// If it is not.
pub fn written_programs_come_back(subject: &Subject) {
    for seed in SEEDS {
        let mut random = Random(seed);
        let count = 1 + random.below(30);
        let written = subject.program(&mut random, count);
        let files = subject.write(&written);
        let read = subject.read(&files, &written);
        let read = read.unwrap_or_else(|error| panic!("seed {seed}: {error}"));
        compare(subject, &written, &read, seed);
    }
}

/// The same program is written as the same files, of names with the dialect's endings, each once.
///
/// # Panics
/// If it is not.
pub fn files_are_named_and_repeatable(subject: &Subject) {
    let written = subject.program(&mut Random(1), 12);
    let files = subject.write(&written);
    assert!(!files.is_empty(), "no file");
    assert_eq!(files, subject.write(&written));
    for (k, file) in files.iter().enumerate() {
        let name = Path::new(&file.name);
        let ending = name.extension().and_then(|ending| ending.to_str());
        let known = subject.dialect.extensions();
        assert!(known.iter().any(|one| Some(*one) == ending), "{name:?}");
        assert!(files[..k].iter().all(|other| other.name != file.name));
    }
}

/// A text that ends too early is an error with its place, wherever it ends.
///
/// # Panics
/// If it is read.
pub fn a_truncated_text_is_an_error(subject: &Subject) {
    let written = subject.program(&mut Random(2), MOVES_WHEN_DAMAGED);
    let mut files = subject.write(&written);
    let whole = files[0].text.trim_end().to_owned();
    for end in 0..whole.len() {
        files[0].text = whole[..end].to_owned();
        let error = subject.read(&files, &written);
        let error = error.expect_err(&format!("cut after {end} of {} bytes", whole.len()));
        assert!(error.path().is_some(), "{error}: without its file");
    }
}

/// A text with a wrong character is read, or refused with its place; nothing panics.
///
/// # Panics
/// If a fault has no place.
pub fn a_damaged_text_is_no_panic(subject: &Subject) {
    let written = subject.program(&mut Random(3), MOVES_WHEN_DAMAGED);
    let mut files = subject.write(&written);
    let whole = files[0].text.clone();
    let mut random = Random(4);
    for place in 0..whole.len() {
        let mut text = whole.clone().into_bytes();
        text[place] = b' ' + random.below(95) as u8;
        files[0].text = String::from_utf8_lossy(&text).into_owned();
        if let Err(error) = subject.read(&files, &written) {
            assert!(error.path().is_some(), "{error}: without its file");
        }
    }
}

/// A file that is not there is an error with its name.
///
/// # Panics
/// If it is not.
pub fn a_missing_file_is_an_error(subject: &Subject) {
    let written = subject.program(&mut Random(5), 1);
    let name = subject.write(&written)[0].name.clone();
    let missing = ProgramFile {
        name: format!("another_{name}"),
        text: String::new(),
    };
    let (settings, frames) = (subject.settings(), frames(&written));
    let none = |_: &Path| Err(std::io::ErrorKind::NotFound.into());
    let read = (subject.dialect).read(
        missing.name.as_ref(),
        &none,
        &subject.robot,
        &frames,
        &settings,
    );
    let error = read.expect_err("a file that is not there");
    assert_eq!(error.path(), Some(Path::new(&missing.name)));
}

/// A program that contradicts itself is refused.
///
/// # Panics
/// If it is written.
pub fn a_contradictory_program_is_refused(subject: &Subject) {
    let good = subject.program(&mut Random(6), 4);
    let faults: [fn(&mut Move); 4] = [
        |step| step.posture[0] += 0.1,
        |step| step.motion = Motion::Joint { share: f64::NAN },
        |step| step.path_point = 0,
        |step| {
            step.turntable_rad = match step.turntable_rad {
                Some(_) => None,
                None => Some(0.0),
            };
        },
    ];
    for (k, fault) in faults.into_iter().enumerate() {
        let mut program = good.clone();
        fault(&mut program.moves[2]);
        let written = (subject.dialect).write(&program, &subject.robot, &subject.settings());
        assert!(written.is_err(), "fault {k} was written");
    }
}

/// The options' schema is a table whose keys are all optional, and only they are taken.
///
/// # Panics
/// If it is not.
pub fn options_are_declared(subject: &Subject) {
    let schema = subject.dialect.options();
    let declared = schema.get("properties").and_then(Value::as_object);
    let required = schema.get("required").and_then(Value::as_array);
    assert!(required.is_none_or(Vec::is_empty), "a required option");
    for key in subject.options.keys() {
        assert!(declared.is_some_and(|keys| keys.contains_key(key)), "{key}");
    }
    subject.dialect.check(&subject.options).expect("options");
    let mut more = subject.options.clone();
    more.insert("no_such_option".to_owned(), Value::Bool(true));
    assert!(subject.dialect.check(&more).is_err(), "an unknown option");
}

/// No two dialects have one name, or one ending of files.
///
/// # Panics
/// If two have.
pub fn names_are_unique(dialects: &[&dyn Dialect]) {
    for (k, one) in dialects.iter().enumerate() {
        assert!(!one.name().is_empty() && !one.extensions().is_empty());
        for other in &dialects[..k] {
            assert_ne!(one.name(), other.name());
            for ending in one.extensions() {
                let mut others = other.extensions().iter();
                assert!(
                    !others.any(|known| known.eq_ignore_ascii_case(ending)),
                    "both {} and {} have files .{ending}",
                    one.name(),
                    other.name()
                );
            }
        }
    }
}

/// A `#[test]` of each demand on a dialect, in a module of the given name.
#[macro_export]
macro_rules! dialect_contract {
    ($module:ident, $subject:expr) => {
        $crate::dialect_contract!(@each $module, $subject,
            written_programs_come_back files_are_named_and_repeatable a_truncated_text_is_an_error
            a_damaged_text_is_no_panic a_missing_file_is_an_error
            a_contradictory_program_is_refused options_are_declared);
    };
    (@each $module:ident, $subject:expr, $($case:ident)*) => {
        mod $module {
            use super::*;
            $(
                #[test]
                fn $case() {
                    $crate::program::contract::$case(&$subject);
                }
            )*
        }
    };
}

impl Subject {
    fn settings(&self) -> Settings {
        let written = |signal: &&&str| {
            let program = self.program(&mut Random(7), 1);
            let settings = self.settings_with(signal);
            (self.dialect)
                .write(&program, &self.robot, &settings)
                .is_ok()
        };
        // Outputs have names here and numbers there.
        let signal = ["7", "doSpindle"].iter().find(written);
        self.settings_with(signal.copied().unwrap_or("7"))
    }

    fn settings_with(&self, signal: &str) -> Settings {
        Settings {
            options: self.options.clone(),
            pulses_per_deg: match self.dialect.turntable() {
                TurntableUnit::Pulses => Some(PULSES_PER_DEG),
                TurntableUnit::Degrees | TurntableUnit::None => None,
            },
            turntable_share: 0.5,
            spindle_signal: Some(signal.to_owned()),
        }
    }

    fn write(&self, program: &Program) -> Vec<ProgramFile> {
        let files = (self.dialect).write(program, &self.robot, &self.settings());
        files.expect("a program that is in order")
    }

    /// From files in a folder that is not there.
    fn read(&self, files: &[ProgramFile], written: &Program) -> Result<Program, ProgramError> {
        let folder = Path::new("folder");
        let text = |path: &Path| {
            let wanted = |file: &&ProgramFile| path == folder.join(&file.name);
            let found = files.iter().find(wanted).map(|file| file.text.clone());
            found.ok_or_else(|| std::io::ErrorKind::NotFound.into())
        };
        let main: PathBuf = folder.join(&files[0].name);
        let settings = self.settings();
        (self.dialect).read(&main, &text, &self.robot, &frames(written), &settings)
    }
}

fn frames(program: &Program) -> Frames {
    Frames {
        tool: program.tool.clone(),
        world_from_base: program.world_from_base,
    }
}

/// Zones that leave less between them may meet when they are rounded, m.
const NEARLY_M: f64 = 1e-5;

fn compare(subject: &Subject, written: &Program, read: &Program, seed: u64) {
    let within = subject.dialect.resolution();
    assert_eq!(written.moves.len(), read.moves.len(), "seed {seed}");
    assert_eq!(written.spindle, read.spindle, "seed {seed}: spindle");
    for (k, (wanted, found)) in written.moves.iter().zip(&read.moves).enumerate() {
        let at = format!("seed {seed}, path point {}", wanted.path_point);
        assert_eq!(wanted.path_point, found.path_point, "{at}");
        let (position_m, attitude_rad) = apart(&wanted.base_from_tool, &found.base_from_tool);
        assert!(
            position_m <= within.position_m + KINEMATICS,
            "{at}: {position_m} m"
        );
        assert!(
            attitude_rad <= within.attitude_rad + KINEMATICS,
            "{at}: {attitude_rad} rad"
        );
        let flange = (subject.robot).world_from_frame(&found.posture, FrameId::Flange);
        let tool = read.world_from_base.inverse() * flange * read.tool.flange_from_tool;
        let (position_m, attitude_rad) = apart(&tool, &found.base_from_tool);
        assert!(
            position_m.max(attitude_rad) <= 1e-6,
            "{at}: posture and pose differ"
        );
        let joints = wanted.posture.iter().zip(&found.posture);
        let joint_rad = joints.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(
            joint_rad <= SAME_BRANCH_RAD,
            "{at}: another branch, {joint_rad} rad"
        );
        match (wanted.motion, found.motion) {
            (Motion::Joint { share: a }, Motion::Joint { share: b }) => {
                assert!((a - b).abs() <= within.share + 1e-12, "{at}: {a}, {b}");
            }
            (Motion::Linear { speed_m_per_s: a }, Motion::Linear { speed_m_per_s: b }) => {
                assert!(
                    (a - b).abs() <= within.speed_m_per_s + 1e-12,
                    "{at}: {a}, {b} m/s"
                );
            }
            other => panic!("{at}: {other:?}"),
        }
        match (wanted.zone, found.zone, within.zone_m) {
            (Zone::Within(a), Zone::Within(b), Some(apart_m)) => {
                let smaller = within.parts_zones && meets_another(written, k, NEARLY_M);
                let holds = (a - b).abs() <= apart_m + 1e-12 || (smaller && b < a);
                assert!(holds, "{at}: zones {a}, {b} m");
                let meets = within.parts_zones && meets_another(read, k, 0.0);
                assert!(!meets, "{at}: a zone of {b} m overlaps with another");
            }
            (Zone::Within(_), Zone::Unstated, None) | (Zone::Stop, Zone::Stop, _) => {}
            other => panic!("{at}: zones {other:?}"),
        }
        let angles = [wanted, found].map(|step| step.turntable_rad);
        let pulse_rad = match subject.dialect.turntable() {
            TurntableUnit::Pulses => (0.5 / PULSES_PER_DEG).to_radians(),
            TurntableUnit::Degrees | TurntableUnit::None => 0.0,
        };
        match angles {
            [Some(a), Some(b)] => {
                let bound = within.turntable_rad + pulse_rad + 1e-12;
                assert!((a - b).abs() <= bound, "{at}: turntable {a}, {b} rad");
            }
            other => assert_eq!(other, [None, None], "{at}: turntable"),
        }
    }
}

/// Whether the zone of a move comes so near to that of the move before or after.
fn meets_another(program: &Program, k: usize, within_m: f64) -> bool {
    let zone_m = |step: &Move| match step.zone {
        Zone::Within(zone_m) => zone_m,
        Zone::Stop | Zone::Unstated => 0.0,
    };
    let near = program.moves[k.saturating_sub(1)..].windows(2);
    near.take(1 + k.min(1)).any(|pair| {
        let (way_m, _) = apart(&pair[0].base_from_tool, &pair[1].base_from_tool);
        zone_m(&pair[0]) + zone_m(&pair[1]) + within_m >= way_m
    })
}

/// Distance (m) and angle (rad) between two poses.
fn apart(a: &Isometry3<f64>, b: &Isometry3<f64>) -> (f64, f64) {
    let distance_m = (a.translation.vector - b.translation.vector).norm();
    (distance_m, a.rotation.angle_to(&b.rotation))
}
