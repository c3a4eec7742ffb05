//! Random recordings come back from both formats as they were written, to the bit.

use proptest::collection::vec;
use proptest::prelude::*;
use truecut_recording::{
    ChannelSpec, Header, Outcome, Profile, Recorder, Recording, Scalar, Summary, Unit,
};
use truecut_telemetry::{IpcSink, ParquetSink, read_ipc_stream, read_parquet, write_parquet};

const UNITS: [Unit; 8] = [
    Unit::One,
    Unit::Metre,
    Unit::Radian,
    Unit::NewtonMetrePerRadian,
    Unit::KilogramSquareMetre,
    Unit::Kelvin,
    Unit::RadianPerNewtonMetre,
    Unit::NewtonMetrePerCubicRadian,
];

/// Any number, with those that are none, that are infinite, and that a text would spoil.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        8 => any::<f64>(),
        1 => prop::sample::select(vec![f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -0.0, f64::MIN_POSITIVE, 5e-324]),
        4 => -1.0..1.0_f64,
    ]
}

fn finite() -> impl Strategy<Value = f64> {
    number().prop_map(|value| if value.is_finite() { value } else { 0.1 + 0.2 })
}

/// Any text of a person or of a file, with quotes, breaks and characters beyond ASCII.
fn text() -> impl Strategy<Value = String> {
    prop_oneof![".{0,20}", "[\"\\\\\\n\\t\\r{}=#,µ°ß漢\\u{0}]{0,12}"]
}

fn unit() -> impl Strategy<Value = Unit> {
    prop::sample::select(UNITS.to_vec())
}

fn outcome() -> impl Strategy<Value = Outcome> {
    prop_oneof![
        Just(Outcome::Completed),
        Just(Outcome::Interrupted),
        text().prop_map(|signs| Outcome::Placeholders { signs }),
        (text(), number(), number(), text()).prop_map(|(quantity, value, limit, rule)| {
            Outcome::BeyondModel {
                quantity,
                value,
                limit,
                rule,
            }
        }),
        (finite(), text(), number(), text()).prop_map(|(time_s, joint, share, limit)| {
            Outcome::Overloaded {
                time_s,
                joint,
                share,
                limit,
            }
        }),
        (finite(), text(), number(), number(), text()).prop_map(
            |(time_s, quantity, value, limit, rule)| Outcome::Diverged {
                time_s,
                quantity,
                value,
                limit,
                rule
            }
        ),
        (finite(), number(), text()).prop_map(|(time_s, amplitude_m, rule)| Outcome::Chatter {
            time_s,
            amplitude_m,
            rule
        }),
    ]
}

fn scalar() -> impl Strategy<Value = Scalar> {
    (text(), unit(), number(), text())
        .prop_map(|(name, unit, value, about)| Scalar::new(name, unit, value, about))
}

fn profile() -> impl Strategy<Value = Profile> {
    let values = vec((number(), number()), 0..6);
    (text(), text(), unit(), unit(), values).prop_map(
        |(name, description, axis_unit, unit, values)| {
            let (axis, values) = values.into_iter().unzip();
            Profile {
                axis_name: name.clone(),
                name,
                description,
                axis_unit,
                axis,
                unit,
                values,
            }
        },
    )
}

prop_compose! {
    /// Names of channels are told apart; rows fill none, one or several groups and chunks.
    fn recording()(
        (texts, notes) in ((text(), text()), vec(text(), 0..4)),
        channels in vec((text(), unit(), text()), 0..4),
        rows in prop_oneof![Just(0_usize), 1..40_usize, 4090..4102_usize],
        seeds in vec(number(), 1..50),
        end in (outcome(), vec(scalar(), 0..4), vec(profile(), 0..3)),
    ) -> Recording {
        let channels: Vec<ChannelSpec> = (channels.into_iter().enumerate())
            .map(|(k, (name, unit, about))| ChannelSpec::new(format!("{k}{name}"), unit, about))
            .collect();
        let column = |of: usize| (0..rows).map(|row| seeds[(of + 7 * row) % seeds.len()]).collect();
        Recording {
            columns: (0..channels.len()).map(column).collect(),
            time_s: (0..rows).map(|row| row as f64 * 0.1).collect(),
            header: Header {
                scenario_name: texts.0,
                scenario_text: texts.1,
                channels,
                notes,
                ..Header::default()
            },
            outcome: end.0,
            scalars: end.1,
            profiles: end.2,
        }
    }
}

/// All of it as text, in which numbers are told apart to the bit and none are none.
fn told(recording: &Recording) -> String {
    let bits =
        |column: &Vec<f64>| -> Vec<u64> { column.iter().map(|value| value.to_bits()).collect() };
    let columns: Vec<_> = recording
        .columns
        .iter()
        .chain([&recording.time_s])
        .map(bits)
        .collect();
    let header = &recording.header;
    format!(
        "{:?} {:?} {:?} {:?} {:?} {:?} {:?} {columns:?}",
        header.scenario_name,
        header.scenario_text,
        header.channels,
        header.notes,
        recording.outcome,
        recording.scalars,
        recording.profiles,
    )
}

/// Through the sinks, as a run writes.
fn run(recording: &Recording, folder: &std::path::Path) {
    let sinks: Vec<Box<dyn truecut_recording::Sink + Send>> = vec![
        Box::new(IpcSink::new(folder.join("run.arrows"))),
        Box::new(ParquetSink::new(folder.join("run.parquet"))),
    ];
    let mut recorder = Recorder::new(recording.header.clone(), sinks).unwrap();
    for (row, time_s) in recording.time_s.iter().enumerate() {
        let values: Vec<f64> = recording.columns.iter().map(|column| column[row]).collect();
        recorder.push_row(*time_s, &values).unwrap();
    }
    let end = (
        recording.scalars.clone(),
        recording.profiles.clone(),
        recording.outcome.clone(),
    );
    let (made, sinks) = recorder.finish(end.0, end.1, end.2).unwrap();
    sinks.close(&made, &[]).unwrap();
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn recordings_come_back_to_the_bit(written in recording()) {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        write_parquet(&at("whole.parquet"), &written).unwrap();
        run(&written, folder.path());
        for read in [
            read_parquet(&at("whole.parquet")).unwrap(),
            read_parquet(&at("run.parquet")).unwrap(),
            read_ipc_stream(&at("run.arrows")).unwrap(),
        ] {
            prop_assert_eq!(told(&read), told(&written));
        }
        let bytes = |name: &str| std::fs::read(at(name)).unwrap();
        prop_assert!(bytes("whole.parquet") == bytes("run.parquet"));
    }

    /// And `summary.json`, in which a number that is none or infinite is null.
    #[test]
    fn summaries_come_back(written in recording()) {
        let summary = Summary::new(&written, &[]);
        let json = serde_json::to_string(&summary).unwrap();
        let read: Summary = serde_json::from_str(&json).unwrap();
        prop_assert_eq!(format!("{read:?}"), format!("{summary:?}"));
    }
}
