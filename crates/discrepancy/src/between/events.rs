//! What happens within one recording: it sets in there, and may stop again. That is no change of
//! the machine from the one to the other, and looks a little like one.

use truecut_scenario::effect::Effect;

use super::answer::{Changes, Event, Recording, Verdict};
use super::{Between, Motion};
use crate::diagnose::{Change, Diagnosis, courses};
use crate::model::{Columns, Model};
use crate::trial::Trial;

/// Moments that are no further apart than this part of what is explained are one.
const SAME: f64 = 0.02;
/// The recording in which a stretch stands out by more than this part of all that does so is the
/// one in which something happens.
const MOSTLY: f64 = 0.7;

/// Where a recording lies in the times of what is explained, s.
struct Part {
    recording: Recording,
    from_s: f64,
    until_s: f64,
    /// Its own times less those.
    later_s: f64,
}

impl Part {
    /// A change over time as far as it is in this part. What is another all along sets in nowhere,
    /// and what is so from end to end is what changed from one recording to the other.
    fn event(&self, change: &Change, slack_s: f64) -> Option<Event> {
        let from_s = change.from_s?;
        let until_s = change.until_s.unwrap_or(f64::INFINITY);
        let begins = from_s > self.from_s + slack_s;
        let ends = until_s < self.until_s - slack_s;
        let is_beside = until_s <= self.from_s + slack_s || from_s >= self.until_s - slack_s;
        (!is_beside && (begins || ends)).then(|| Event {
            recording: self.recording,
            change: Change {
                from_s: Some(from_s.max(self.from_s) + self.later_s),
                until_s: ends.then_some(until_s + self.later_s),
                ..change.clone()
            },
        })
    }
}

/// What the search `found` to change over time, by the recording in which it happens. `of_first` is
/// the diagnosis of the first alone; both are predicted with these numbers and with what they
/// share.
pub(super) fn events(
    pair: &Between,
    [found, of_first]: [&Diagnosis; 2],
    numbers: &[Vec<f64>; 2],
    shared: &[Effect],
) -> Vec<Event> {
    let time_s = &pair.observation.time_s;
    let (Some(&begins_s), Some(&ends_s)) = (time_s.first(), time_s.last()) else {
        return Vec::new();
    };
    let slack_s = SAME * (ends_s - begins_s);
    let Motion::Repeated { later_s, .. } = pair.motion else {
        let rows = pair.first.observation.time_s.len();
        let parts = one_after_the_other(time_s, rows, &pair.second.observation.time_s);
        let changes = found.changes.iter();
        let events = changes.flat_map(|change| {
            let parts = parts.iter();
            parts.filter_map(move |part| part.event(change, slack_s))
        });
        return events.collect();
    };
    if found.changes.is_empty() {
        return Vec::new();
    }
    let left = left(pair, numbers, shared);
    let of_first_s = pair.first.observation.time_s[pair.overlap.first] - begins_s;
    let all = found.changes.iter().filter_map(|change| {
        let known = of_first.changes.iter();
        let is_of_first = known
            .filter(|own| own.channel == change.channel)
            .any(|own| have_a_moment(own, change, of_first_s, slack_s));
        let share = || share_of_second(pair, change, left.as_ref()?);
        let recording = match is_of_first {
            true => Recording::First,
            false if share().is_some_and(|share| share > MOSTLY) => Recording::Second,
            false => Recording::OneOfBoth,
        };
        let part = Part {
            recording,
            from_s: begins_s,
            until_s: ends_s,
            later_s: match recording {
                Recording::Second => of_first_s + later_s,
                Recording::First | Recording::OneOfBoth => of_first_s,
            },
        };
        part.event(change, slack_s)
    });
    all.collect()
}

/// Parts of the first recording, of so many rows, and of the second behind it.
fn one_after_the_other(time_s: &[f64], rows: usize, second_s: &[f64]) -> Vec<Part> {
    let (Some(&from_s), Some(&until_s)) = (time_s.first(), time_s.last()) else {
        return Vec::new();
    };
    let (Some(&border_s), Some(&begins_s)) = (time_s.get(rows), second_s.first()) else {
        return Vec::new();
    };
    let part = |recording, from_s, until_s, later_s| Part {
        recording,
        from_s,
        until_s,
        later_s,
    };
    vec![
        part(Recording::First, from_s, border_s, 0.0),
        part(Recording::Second, border_s, until_s, begins_s - border_s),
    ]
}

/// Whether two changes have a moment in common, the second `later_s` later in the times of the
/// first.
fn have_a_moment(one: &Change, other: &Change, later_s: f64, slack_s: f64) -> bool {
    let moments = |change: &Change| change.from_s.into_iter().chain(change.until_s);
    moments(one).any(|a| moments(other).any(|b| (a - b - later_s).abs() <= slack_s))
}

/// What is left of both recordings, row by row of their difference, with what they share and
/// nothing else; `None` where that cannot be simulated.
fn left(pair: &Between, numbers: &[Vec<f64>; 2], shared: &[Effect]) -> Option<[Columns; 2]> {
    let of = |trial: &Trial, numbers: &[f64], from: usize| -> Option<Columns> {
        let rows = from..from + pair.overlap.count;
        let predicted = trial.predict(numbers, shared).ok()?;
        let outputs = trial.observation.outputs.iter().zip(&predicted);
        let left = outputs.map(|(output, predicted)| {
            let pairs = output.values.iter().zip(predicted);
            let left: Vec<f64> = pairs.map(|(y, p)| y - p).collect();
            left[rows.clone()].to_vec()
        });
        Some(left.collect())
    };
    Some([
        of(&pair.first, &numbers[0], pair.overlap.first)?,
        of(&pair.second, &numbers[1], pair.overlap.second)?,
    ])
}

fn share_of_second(pair: &Between, change: &Change, left: &[Columns; 2]) -> Option<f64> {
    let mut channels = pair.second.channels().iter();
    let c = channels.position(|spec| spec.name == change.channel)?;
    let (from_s, until_s) = (change.from_s?, change.until_s.unwrap_or(f64::INFINITY));
    let inside: Vec<bool> = (pair.observation.time_s.iter())
        .map(|t| (from_s..until_s).contains(t))
        .collect();
    let valid = &pair.observation.outputs[c].valid;
    share([&left[0][c], &left[1][c]], valid, &inside)
}

/// How much of what makes the difference of two signals larger inside of a stretch than outside of
/// it is the second's. Noise and errors of the model are outside as well, and cancel in the mean.
fn share([first, second]: [&[f64]; 2], valid: &[bool], inside: &[bool]) -> Option<f64> {
    let mut rows = [0.0; 2];
    let mut sums = [[0.0; 2]; 2];
    for k in (0..first.len()).filter(|&k| valid[k]) {
        let place = usize::from(inside[k]);
        let apart = second[k] - first[k];
        rows[place] += 1.0;
        sums[place][0] -= first[k] * apart;
        sums[place][1] += second[k] * apart;
    }
    if rows.contains(&0.0) {
        return None;
    }
    let beyond = |which: usize| sums[1][which] / rows[1] - sums[0][which] / rows[0];
    let all = beyond(0) + beyond(1);
    (all > 0.0).then(|| beyond(1) / all)
}

/// Tells what happens within a recording before whatever else the reason says.
pub(super) fn tell(found: &mut Changes) {
    if found.verdict == Verdict::FitFailed {
        found.events.clear();
    }
    if found.events.is_empty() {
        return;
    }
    if found.verdict == Verdict::NothingChanged {
        found.verdict = Verdict::UnknownChange;
    }
    let places = [
        (Recording::First, "the first recording"),
        (Recording::Second, "the second recording"),
        (
            Recording::OneOfBoth,
            "one of the recordings (which of them does not show; times are those of the first)",
        ),
    ];
    let told = places.iter().filter_map(|(recording, place)| {
        let own = found.events.iter();
        let own = own.filter(|one| one.recording == *recording);
        let own: Vec<Change> = own.map(|one| one.change.clone()).collect();
        (!own.is_empty()).then(|| format!("Within {place} {}.", courses(&own)))
    });
    let named = match found.changes.is_empty() {
        true => "",
        false => ", and what is named beside it may stand for a part of it",
    };
    found.reason = format!(
        "{} What happens within a recording is no change of all of it{named}. {}",
        told.collect::<Vec<_>>().join(" "),
        found.reason
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    fn change(from_s: f64, until_s: Option<f64>) -> Change {
        Change {
            channel: "joint1.drive_torque".into(),
            from_s: Some(from_s),
            until_s,
            what: "joint_coulomb of joint1".into(),
        }
    }

    /// Of two recordings of 10 s, the second of which begins at 1 s of its own, what is another in
    /// a part of one happens there; what is so from the border on is the second itself.
    #[test]
    fn an_event_is_in_the_recording_that_it_begins_or_ends_in() {
        let time_s: Vec<f64> = (0..200).map(|k| 0.1 * f64::from(k)).collect();
        let second_s: Vec<f64> = (0..100).map(|k| 1.0 + 0.1 * f64::from(k)).collect();
        let parts = one_after_the_other(&time_s, 100, &second_s);
        let found = |from_s: f64, until_s: Option<f64>| -> Vec<(Recording, f64, Option<f64>)> {
            let change = change(from_s, until_s);
            let events = parts.iter().filter_map(|part| part.event(&change, 0.4));
            let places = events.map(|one| {
                let rounded = |time_s: f64| (10.0 * time_s).round() / 10.0;
                let Change {
                    from_s, until_s, ..
                } = one.change;
                (
                    one.recording,
                    rounded(from_s.unwrap()),
                    until_s.map(rounded),
                )
            });
            places.collect()
        };
        let (first, second) = (Recording::First, Recording::Second);
        assert_eq!(found(4.0, Some(6.0)), [(first, 4.0, Some(6.0))]);
        assert_eq!(found(14.0, Some(16.0)), [(second, 5.0, Some(7.0))]);
        assert_eq!(found(14.0, None), [(second, 5.0, None)]);
        assert_eq!(found(10.1, Some(16.0)), [(second, 1.1, Some(7.0))]);
        assert_eq!(found(4.0, Some(9.9)), [(first, 4.0, None)]);
        assert_eq!(
            found(4.0, Some(16.0)),
            [(first, 4.0, None), (second, 1.0, Some(7.0))]
        );
        // It stays, so that all of the second is as the end of the first.
        assert_eq!(found(4.0, None), [(first, 4.0, None)]);
        assert!(found(10.1, None).is_empty());
        assert!(found(9.8, Some(19.8)).is_empty());
    }

    /// Beside an error of the model that both have, and twice as large, the recording that has
    /// something in a stretch is told.
    #[test]
    fn what_stands_out_in_a_stretch_is_of_the_recording_that_has_it() {
        let count = 400;
        let common = |k: usize| 2.0 * (0.11 * k as f64).cos();
        let event = |k: usize| match (100..160).contains(&k) {
            true => (0.37 * k as f64).sin().signum(),
            false => 0.0,
        };
        let valid = vec![true; count];
        let inside: Vec<bool> = (0..count).map(|k| (100..160).contains(&k)).collect();
        let with = |factor: f64| -> Vec<f64> {
            (0..count).map(|k| common(k) + factor * event(k)).collect()
        };
        let share = |first: f64, second: f64| {
            share([&with(first), &with(second)], &valid, &inside).unwrap()
        };
        assert!(share(0.0, 1.0) > MOSTLY, "{}", share(0.0, 1.0));
        assert!(share(1.0, 0.0) < 1.0 - MOSTLY, "{}", share(1.0, 0.0));
        let none = vec![false; count];
        assert_eq!(super::share([&with(0.0), &with(1.0)], &valid, &none), None);
    }

    #[test]
    fn an_event_is_told_first_with_its_recording() {
        let mut found = Changes {
            verdict: Verdict::NothingChanged,
            reason: "The rest.".into(),
            events: vec![Event {
                recording: Recording::Second,
                change: change(5.0, Some(7.0)),
            }],
            ..Changes::default()
        };
        tell(&mut found);
        assert_eq!(found.verdict, Verdict::UnknownChange);
        assert_eq!(
            found.reason,
            "Within the second recording `joint1.drive_torque` is another from about 5.00 s until about 7.00 s, most as \
             if joint_coulomb of joint1 was another there. What happens within a recording is no change of all of it. The \
             rest."
        );
    }
}
