//! Set-ups that people mistake for one another, and what drive forces would be in them.

use std::f64::consts::PI;

use nalgebra::Vector3;
use rayon::prelude::*;
use truecut_sim::InverseModel;

use super::parallel::picked;
use crate::diagnose::Observation;
use crate::model::SetUp;

/// Ways in which an arm stands or hangs: where gravity points in the world of the scenario.
const GRAVITIES: [(&str, [f64; 3]); 6] = [
    ("upside down, from a ceiling", [0.0, 0.0, 1.0]),
    ("upright, on the floor", [0.0, 0.0, -1.0]),
    ("on a wall, its x axis down", [1.0, 0.0, 0.0]),
    ("on a wall, its x axis up", [-1.0, 0.0, 0.0]),
    ("on a wall, its y axis down", [0.0, 1.0, 0.0]),
    ("on a wall, its y axis up", [0.0, -1.0, 0.0]),
];
/// By how much a clock is mistaken: half or double rates, rates of usual loggers, minutes for
/// seconds, seconds for milliseconds.
const CLOCKS: [f64; 6] = [2.0, 4.0, 5.0, 10.0, 60.0, 1000.0];
/// Units that coordinates are mistaken in: whether of turns, by how much the larger is the larger.
const UNITS: [(bool, f64, [&str; 2]); 2] = [
    (true, 180.0 / PI, ["rad", "deg"]),
    (false, 1e3, ["m", "mm"]),
];
/// Most pairs of joints that are tried as swapped: those of eight joints.
const MOST_PAIRS: usize = 28;

/// Drive forces in other set-ups, every so many-th sample of the data.
pub(super) fn of_drive_forces(
    model: &InverseModel,
    every: usize,
    data: &Observation,
) -> Vec<SetUp> {
    let Some(down) = model.gravity_direction() else {
        return Vec::new();
    };
    let hangs = GRAVITIES.iter().map(|(how, direction)| {
        let told = format!("the arm hangs or stands {how} (turn its base so in the robot's file)");
        (told, Vector3::from(*direction), 1.0)
    });
    let clocks = CLOCKS.iter().flat_map(|factor| [*factor, 1.0 / factor]);
    let clocks = clocks.map(|speed| {
        let times = match speed > 1.0 {
            true => format!("{speed} times as fast as"),
            false => format!("{} times slower than", 1.0 / speed),
        };
        let told = format!(
            "the motion is {times} the times of the data say (data.time_unit, data.rate_hz)"
        );
        (told, down, speed)
    });
    let others = hangs.filter(|(_, direction, _)| (direction - down).norm() > 0.5);
    let others = others.chain(clocks).map(|(told, direction, speed)| {
        let made = move || (model.set_up(direction, speed), None);
        (told, Box::new(made) as Other)
    });
    let reversed = (model.joints().iter().enumerate()).flat_map(|(channel, &joint)| {
        let number = joint + 1;
        [
            (
                format!(
                    "the sign of joint {number}'s coordinate looks reversed (scale = -1 in its [[data.channel]], or check \
                     the column)"
                ),
                Box::new(move || (model.reversed(joint), None)) as Other,
            ),
            (
                format!(
                    "the axis of joint {number} looks reversed (it points the other way in the robot's file than in the \
                     data: the signs of its coordinate and of its drive force)"
                ),
                Box::new(move || (model.reversed(joint), Some(channel))) as Other,
            ),
        ]
    });
    let all = others.chain(reversed).chain(swapped(model));
    let all: Vec<(String, Other)> = all.chain(in_units(model)).collect();
    let made = all.into_par_iter().filter_map(|(told, other)| {
        let (other, opposite) = other();
        let predicted = other.predict(&[]).ok()?;
        let predicted = predicted.iter().enumerate().map(|(channel, column)| {
            let mut column = picked(column, every);
            if opposite == Some(channel) {
                column.iter_mut().for_each(|force| *force = -*force);
            }
            with_friction(&other, channel, every, data, &column)
        });
        Some(SetUp {
            told,
            predicted: predicted.collect(),
        })
    });
    made.collect()
}

/// Joints of which one is taken for another: two of a kind.
fn swapped(model: &InverseModel) -> impl Iterator<Item = (String, Other<'_>)> {
    let rotary = model.rotary();
    let pairs = (0..rotary.len()).flat_map(|b| (0..b).map(move |a| (a, b)));
    let alike = pairs.filter(move |&(a, b)| rotary[a] == rotary[b]);
    alike.take(MOST_PAIRS).map(move |(a, b)| {
        let told = format!(
            "the coordinates of joint {} and joint {} are swapped (column in their [[data.channel]])",
            a + 1,
            b + 1
        );
        let made = move || (model.swapped(a, b), None);
        (told, Box::new(made) as Other)
    })
}

/// The coordinates of all joints of a kind in another unit than the scenario says.
fn in_units(model: &InverseModel) -> impl Iterator<Item = (String, Other<'_>)> {
    let units = UNITS
        .into_iter()
        .flat_map(|(turns, factor, [large, small])| {
            [
                (turns, factor, large, small),
                (turns, 1.0 / factor, small, large),
            ]
        });
    let rotary = model.rotary();
    units.filter_map(move |(turns, factor, meant, said)| {
        let joints = (0..rotary.len()).filter(|joint| rotary[*joint] == turns);
        let joints: Vec<usize> = joints.collect();
        let what = if turns { "angles" } else { "positions" };
        let told = format!(
            "the {what} of the joints are in {meant} and taken for {said} (unit in their [[data.channel]])"
        );
        let has_some = !joints.is_empty();
        let made = move || (model.scaled(&joints, factor), None);
        has_some.then(|| (told, Box::new(made) as Other))
    })
}

/// What makes the arm in another set-up, and the channel whose drive force has the other sign
/// there.
type Other<'a> = Box<dyn Fn() -> (InverseModel, Option<usize>) + Send + Sync + 'a>;

/// The prediction of a channel with the viscous and dry friction and the offset of its joint that
/// fit best: no set-up is judged by what it says nothing about.
fn with_friction(
    model: &InverseModel,
    channel: usize,
    every: usize,
    data: &Observation,
    predicted: &[f64],
) -> Vec<f64> {
    let velocity = model.velocity(model.joints()[channel]);
    let signs: Vec<f64> = velocity.iter().map(|v| v.signum()).collect();
    let viscous = picked(&model.filtered(velocity), every);
    let dry = picked(&model.filtered(&signs), every);
    let constant = vec![1.0; predicted.len()];
    data.outputs[channel].fitted(predicted, &[viscous, dry, constant])
}
