//! Laws that every [`Process`] keeps, along states that the maker of the subject gives.

use crate::loads::{ContactOutcome, Loads};
use crate::process::{Findings, Process, Start, ToolState};
use nalgebra::Vector2;
use std::collections::BTreeSet;

/// A process, and what it is to live through.
pub struct Subject {
    pub process: Box<dyn Process>,
    pub start: Start,
    /// Whether it, and those with effects, have begun already.
    pub begun: bool,
    /// One state a step, a time step apart.
    pub states: Vec<ToolState>,
    /// The same process with an effect at its neutral size, by the effect's name; for a process
    /// without effects none.
    pub neutral: Vec<(String, Box<dyn Process>)>,
}

impl Subject {
    /// A process without effects that begins where an arm without load would have it.
    pub fn new(process: Box<dyn Process>, time_step_s: f64, states: Vec<ToolState>) -> Self {
        let start = Start {
            time_step_s,
            tool_offset_m: nalgebra::Vector3::zeros(),
        };
        Self {
            process,
            start,
            begun: false,
            states,
            neutral: Vec::new(),
        }
    }
}

/// Makes the subject, alike each time.
pub type Make = fn() -> Subject;

/// Every contact that was asked for holds without a force.
fn held(loads: &Loads) -> crate::loads::ContactOutcomes {
    let held = |_| ContactOutcome {
        friction_n: Vector2::zeros(),
        velocity_m_per_s: Vector2::zeros(),
        sliding: false,
    };
    loads.contacts.iter().map(held).collect()
}

fn commit(process: &mut dyn Process, state: &ToolState, loads: &Loads, start: &Start) {
    process.commit(state, loads, &held(loads), start.time_step_s);
}

/// Lives through the states; one row a step, as bits.
fn rows(process: &mut dyn Process, subject: &Subject) -> Vec<Vec<u64>> {
    begin(process, subject);
    let states = subject.states.iter();
    states
        .map(|state| {
            let loads = process.evaluate(state);
            commit(process, state, &loads, &subject.start);
            let mut row = Vec::new();
            process.record(&mut row);
            row.iter().map(|value| value.to_bits()).collect()
        })
        .collect()
}

fn begin(process: &mut dyn Process, subject: &Subject) {
    if !subject.begun {
        process.begin(&subject.start);
    }
}

/// Takes the process out of a subject.
fn split(mut subject: Subject) -> (Box<dyn Process>, Subject) {
    let gone = Box::new(Gone);
    (std::mem::replace(&mut subject.process, gone), subject)
}

/// All digits of what a process asks for: equal texts are equal bits.
fn told(loads: &Loads) -> String {
    format!("{loads:?}")
}

/// A row has as many values as there are channels, all of them numbers, and is appended.
pub fn rows_have_a_value_for_every_channel(make: Make) {
    let (mut process, subject) = split(make());
    begin(process.as_mut(), &subject);
    let channels = process.channels();
    assert!(!subject.states.is_empty(), "a subject has states");
    for state in &subject.states {
        let loads = process.evaluate(state);
        commit(process.as_mut(), state, &loads, &subject.start);
        let mut row = vec![f64::MAX];
        process.record(&mut row);
        assert_eq!(row[0], f64::MAX, "a row is appended to");
        assert_eq!(row.len() - 1, channels.len(), "{} s", state.time_s);
        for (channel, value) in channels.iter().zip(&row[1..]) {
            assert!(value.is_finite(), "{} at {} s", channel.name, state.time_s);
        }
    }
    assert_eq!(
        channels,
        process.channels(),
        "channels are the same at the end"
    );
}

/// No name twice, none empty, each with its meaning.
pub fn channels_are_named_once_and_described(make: Make) {
    let channels = make().process.channels();
    let names: BTreeSet<_> = channels.iter().map(|channel| &channel.name).collect();
    assert_eq!(names.len(), channels.len(), "{names:?}");
    for channel in &channels {
        assert!(
            !channel.name.is_empty() && !channel.description.is_empty(),
            "{channel:?}"
        );
    }
}

/// A step may be tried as often as the solver likes, at other states, too.
pub fn evaluating_twice_changes_nothing(make: Make) {
    let (mut process, subject) = split(make());
    let (mut once, _) = split(make());
    begin(process.as_mut(), &subject);
    begin(once.as_mut(), &subject);
    for (index, state) in subject.states.iter().enumerate() {
        let expected = once.evaluate(state);
        let trial = subject.states[(index + 7) % subject.states.len()];
        process.evaluate(&trial);
        let first = process.evaluate(state);
        let second = process.evaluate(state);
        assert_eq!(told(&first), told(&second), "{} s", state.time_s);
        assert_eq!(told(&first), told(&expected), "{} s", state.time_s);
        commit(process.as_mut(), state, &second, &subject.start);
        commit(once.as_mut(), state, &expected, &subject.start);
    }
}

/// Rows are read, not consumed.
pub fn recording_twice_changes_nothing(make: Make) {
    let (mut process, subject) = split(make());
    begin(process.as_mut(), &subject);
    for state in &subject.states {
        let loads = process.evaluate(state);
        commit(process.as_mut(), state, &loads, &subject.start);
        let mut rows = [Vec::new(), Vec::new()];
        rows.iter_mut().for_each(|row| process.record(row));
        let [first, second] = rows.map(|row| row.iter().map(|v| v.to_bits()).collect::<Vec<_>>());
        assert_eq!(first, second, "{} s", state.time_s);
    }
}

/// Two processes made alike answer alike, to the bit.
pub fn the_same_states_give_the_same_rows(make: Make) {
    let [first, second] = [(); 2].map(|()| {
        let (mut process, subject) = split(make());
        rows(process.as_mut(), &subject)
    });
    assert_eq!(first, second);
}

fn findings(process: &mut dyn Process, subject: &Subject) -> Findings {
    rows(process, subject);
    process.finish()
}

/// Scalars and profiles are named once. A run as short as this may have none to tell of some
/// things, which is not a number; infinite it is not.
pub fn findings_are_finite_and_named_once(make: Make) {
    let (mut process, subject) = split(make());
    let Findings {
        scalars, profiles, ..
    } = findings(process.as_mut(), &subject);
    let names: BTreeSet<_> = scalars.iter().map(|scalar| &scalar.name).collect();
    assert_eq!(names.len(), scalars.len(), "{names:?}");
    for scalar in &scalars {
        assert!(!scalar.value.is_infinite(), "{}", scalar.name);
    }
    for profile in &profiles {
        assert_eq!(profile.axis.len(), profile.values.len(), "{}", profile.name);
    }
}

/// What only findings need may be left out; rows do not notice.
pub fn rows_alone_are_the_same_rows(make: Make) {
    let (mut whole, subject) = split(make());
    let (mut alone, _) = split(make());
    alone.keep_rows_only();
    assert_eq!(
        rows(whole.as_mut(), &subject),
        rows(alone.as_mut(), &subject)
    );
}

/// At its neutral size an effect changes no bit.
pub fn neutral_effects_change_no_bit(make: Make) {
    let (mut process, mut subject) = split(make());
    let neutral = std::mem::take(&mut subject.neutral);
    let nominal = rows(process.as_mut(), &subject);
    for (effect, mut process) in neutral {
        assert_eq!(nominal, rows(process.as_mut(), &subject), "{effect}");
    }
}

/// What a step is chosen by is positive; springs have directions.
pub fn times_and_springs_are_positive(make: Make) {
    let process = make().process;
    let times = [
        ("tooth period", process.tooth_period_s()),
        ("quickest", process.quickest_s()),
        ("highest frequency", process.highest_frequency_hz()),
    ];
    for (name, time) in times {
        assert!(
            time.is_none_or(|time| time > 0.0 && time.is_finite()),
            "{name}: {time:?}"
        );
    }
    for spring in process.contact_stiffness() {
        assert!(spring.stiffness_n_per_m >= 0.0, "{spring:?}");
        assert!((spring.direction.norm() - 1.0).abs() < 1e-9, "{spring:?}");
    }
    assert!(process.feed_along_y_m_per_s().is_finite());
}

/// A field that is drawn has as many values as cells; without one there are none.
pub fn the_field_has_a_value_for_every_cell(make: Make) {
    let (mut process, subject) = split(make());
    let cells = process
        .field()
        .map_or(0, |field| field.cells.iter().product());
    assert_eq!(process.field_values().len(), cells, "at the start");
    rows(process.as_mut(), &subject);
    let values = process.field_values();
    assert_eq!(values.len(), cells, "at the end");
    assert!(values.iter().all(|value| value.is_finite()));
}

/// Stands where a process was taken away.
pub(crate) struct Gone;

impl Process for Gone {
    fn channels(&self) -> Vec<truecut_recording::ChannelSpec> {
        Vec::new()
    }

    fn evaluate(&self, _: &ToolState) -> Loads {
        Loads::default()
    }

    fn commit(&mut self, _: &ToolState, _: &Loads, _: &crate::loads::ContactOutcomes, _: f64) {}

    fn record(&self, _: &mut Vec<f64>) {}

    fn finish(&mut self) -> Findings {
        Findings::default()
    }

    fn contact_stiffness(&self) -> Vec<crate::process::ContactStiffness> {
        Vec::new()
    }

    fn arrows(
        &self,
    ) -> Vec<(
        &'static str,
        crate::loads::Attachment,
        nalgebra::Vector3<f64>,
    )> {
        Vec::new()
    }
}
