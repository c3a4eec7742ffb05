//! Samples beside jumps of a milling force.
//!
//! The force jumps where a tooth enters or leaves with a chip. A sample there says when the tooth
//! does, to a part of a step, and how fast the sensor follows; of anything else it says as much as
//! the samples around it. Simulation and sensor agree about it to a part of the jump only, which is
//! larger than the noise. So these samples are bridged, measured and predicted ones alike: a line
//! between the samples before and after takes their place.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::ops::Range;

use truecut_recording::measured::Measured;
use truecut_scenario::{MillingSpec, ProcessSpec, Scenario};
use truecut_sim::SimError;
use truecut_sim::run::Run;

use super::noise::runs;
use super::sampling;

/// A tooth enters or leaves with a jump if it cuts more than this part of its largest force there.
/// With noise of a hundredth, hundreds of jumps show what is left out here.
const LEAST_JUMP: f64 = 1e-3;
/// A helical edge enters over a time. In more steps than these, the force rises, it does not jump.
const MOST_STEPS: f64 = 8.0;
/// A run's rows are means over a step, the cubic between them reaches to the second row.
const REACH_STEPS: f64 = 2.5;
/// And a sample may be the mean of what was since the last one.
const REACH_SAMPLES: f64 = 1.0;
/// Where more than this part of the samples lies beside jumps, none is bridged.
const MOST_BRIDGED: f64 = 0.5;

/// Angles that differ by less are the same: a tooth enters or leaves on the wall that it makes.
const MADE_RAD: f64 = 1e-12;

/// How far the tool was off its path in a run, along the feed and across it, m.
#[derive(Default)]
struct Way {
    time_s: Vec<f64>,
    off_m: Vec<[f64; 2]>,
}

/// Channels of [`Way`].
const OFF: [&str; 2] = ["milling.deflection_x", "milling.deflection_y"];

impl Way {
    /// Of the nominal run, as far as it goes; none where it cannot be run: what is wrong is told by
    /// whoever needs it.
    fn of(run: &Run<'_>) -> Way {
        let Ok(rows) = run.rows(&OFF, None) else {
            return Way::default();
        };
        let [x, y] = [&rows.columns[0], &rows.columns[1]];
        Way {
            off_m: x.iter().zip(y).map(|(x, y)| [*x, *y]).collect(),
            time_s: rows.time_s,
        }
    }

    /// At some times, in order.
    fn at(&self, times_s: &[f64]) -> Vec<[f64; 2]> {
        if self.off_m.is_empty() {
            return vec![[0.0; 2]; times_s.len()];
        }
        let [x, y] = [0, 1].map(|axis| {
            let column: Vec<f64> = self.off_m.iter().map(|off_m| off_m[axis]).collect();
            sampling::at(&self.time_s, &column, times_s)
        });
        x.into_iter().zip(y).map(|(x, y)| [x, y]).collect()
    }
}

/// What is bridged.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Jumps {
    /// Samples of all stretches, one after another; before and after each range is another sample
    /// of its stretch.
    bridges: Vec<Range<usize>>,
    /// Where a stretch begins or ends beside a jump.
    open: Vec<Range<usize>>,
}

impl Jumps {
    /// Those of a scenario and its data in a nominal run, and the data with them bridged.
    ///
    /// # Errors
    /// Whatever makes the scenario unfit to run.
    pub fn bridged(
        scenario: &Scenario,
        measured: &Measured,
        nominal: &Run<'_>,
    ) -> Result<(Jumps, Measured), SimError> {
        let (step_s, way) = (nominal.time_step_s()?, Way::of(nominal));
        let jumps = Jumps::new(scenario, &measured.stretches_s(), step_s, &way);
        let mut bridged = measured.clone();
        let mut outputs = measured.outputs();
        if jumps.count() > 0 && outputs.any(|one| jumps.concern(&one.spec.name)) {
            bridged.notes.push(format!(
                "{} samples lie beside jumps of the cutting force, where a tooth enters or leaves; lines bridge them, measured \
                 and simulated",
                jumps.count()
            ));
            jumps.bridge_measured(&mut bridged);
        }
        Ok((jumps, bridged))
    }

    /// Those of a scenario at the times of measured samples.
    fn new(scenario: &Scenario, stretches_s: &[Vec<f64>], step_s: f64, way: &Way) -> Jumps {
        let ProcessSpec::Milling(milling) = &scenario.process else {
            return Jumps::default();
        };
        let lag_s = edge_lag_rad(milling) / milling.spindle_rad_s;
        if lag_s > MOST_STEPS * step_s {
            return Jumps::default();
        }
        let pitch_rad = TAU / milling.cut.cutter.teeth as f64;
        let mut jumps = Jumps::default();
        let mut first = 0;
        for times in stretches_s {
            let reach_s = (REACH_STEPS * step_s).max(REACH_SAMPLES * interval_s(times));
            let is_beside = |(time_s, [x_m, y_m]): (f64, [f64; 2])| {
                let turned = milling.start_angle_rad + milling.spindle_rad_s * time_s;
                let fed_m = milling.feed_m_per_s * time_s + x_m;
                jumps_rad(milling, [fed_m, y_m]).any(|angle| {
                    // Since the tip of the last tooth passed; the rest of its edge follows.
                    let since_s = (turned - angle).rem_euclid(pitch_rad) / milling.spindle_rad_s;
                    let period_s = pitch_rad / milling.spindle_rad_s;
                    since_s <= lag_s + reach_s || period_s - since_s <= reach_s
                })
            };
            let places = times.iter().copied().zip(way.at(times));
            let beside: Vec<bool> = places.map(is_beside).collect();
            for run in runs(&beside) {
                let has_ends = run.start > 0 && run.end < times.len();
                let list = match has_ends {
                    true => &mut jumps.bridges,
                    false => &mut jumps.open,
                };
                list.push(first + run.start..first + run.end);
            }
            first += times.len();
        }
        if jumps.count() as f64 > MOST_BRIDGED * first as f64 {
            return Jumps::default();
        }
        jumps
    }

    /// Number of samples that are bridged.
    fn count(&self) -> usize {
        self.bridges.iter().map(ExactSizeIterator::len).sum()
    }

    /// Whether a channel of the run jumps with the teeth.
    pub fn concern(&self, channel: &str) -> bool {
        JUMPING.contains(&channel)
    }

    /// Bridges a column that is predicted.
    pub fn bridge(&self, values: &mut [f64]) {
        for range in &self.bridges {
            line(values, range);
        }
    }

    /// Bridges the outputs that were measured. What has no valid sample on both sides is not valid.
    fn bridge_measured(&self, measured: &mut Measured) {
        let outputs = measured.channels.iter_mut();
        for output in outputs.filter(|one| self.concern(&one.spec.name)) {
            for range in &self.bridges {
                let valid = output.valid[range.start - 1] && output.valid[range.end];
                output.valid[range.clone()].fill(valid);
                if valid {
                    line(&mut output.values, range);
                }
            }
            for range in &self.open {
                output.valid[range.clone()].fill(false);
            }
        }
    }
}

/// Channels of a milling pass that follow the chips.
const JUMPING: [&str; 7] = [
    "milling.force_x",
    "milling.force_y",
    "milling.force_z",
    "milling.torque",
    "milling.chip_thickness",
    "milling.teeth_in_cut",
    "milling.in_cut",
];

/// Angles at which teeth enter or leave with a jump of their force, of a cutter so far along its
/// path and beside it.
fn jumps_rad(milling: &MillingSpec, place_m: [f64; 2]) -> impl Iterator<Item = f64> {
    let cut = &milling.cut;
    let k = &cut.coefficients;
    let chip_n_per_m = k.tangential_pa.hypot(k.radial_pa) * cut.feed_per_tooth_m;
    let edge_n_per_m = k.edge_tangential_n_per_m.hypot(k.edge_radial_n_per_m);
    let arc = &cut.engagement;
    // On the wall that it makes, where the nominal chip is nothing, a tooth still cuts the ridge
    // that the one before it left, within a small part of a step.
    let ridge = 0.5 * cut.feed_per_tooth_m / cut.cutter.radius_m;
    let size = move |angle: f64| {
        let chip = angle.sin().max(0.0) + ridge * angle.cos().powi(2);
        chip_n_per_m * chip + edge_n_per_m
    };
    let thickest_rad = FRAC_PI_2.clamp(arc.entry_rad, arc.exit_rad);
    let least = LEAST_JUMP * size(thickest_rad);
    let angles = in_the_stock(milling, place_m).into_iter().flatten();
    angles.filter(move |angle| size(*angle) > least)
}

/// Angles at which teeth enter and leave the stock: between its faces beside the path, and beyond
/// the one through which the cutter comes. None before it has come to that.
fn in_the_stock(milling: &MillingSpec, [fed_m, y_m]: [f64; 2]) -> Option<[f64; 2]> {
    let arc = &milling.cut.engagement;
    let radius_m = milling.cut.cutter.radius_m;
    // A wall that teeth make moves with them.
    let beside = |nominal_rad: f64, wall_rad: f64| match (nominal_rad - wall_rad).abs() < MADE_RAD {
        true => wall_rad,
        false => (nominal_rad.cos() - y_m / radius_m).clamp(-1.0, 1.0).acos(),
    };
    // Of the axis before the face.
    let before_m = milling
        .lead_in_m
        .map_or(0.0, |lead_m| lead_m + radius_m - fed_m);
    if before_m > radius_m {
        return None;
    }
    let behind_rad = (before_m.max(0.0) / radius_m).asin();
    let entry_rad = beside(arc.entry_rad, 0.0).max(behind_rad);
    let exit_rad = beside(arc.exit_rad, PI).min(PI - behind_rad);
    (entry_rad < exit_rad).then_some([entry_rad, exit_rad])
}

/// By how much the edge at the top of the cut lags behind the tip.
fn edge_lag_rad(milling: &MillingSpec) -> f64 {
    let cutter = &milling.cut.cutter;
    cutter.lag_rad_per_m().abs() * milling.cut.axial_depth_m
}

fn interval_s(times_s: &[f64]) -> f64 {
    match times_s {
        [first, .., last] => (last - first) / (times_s.len() - 1) as f64,
        _ => 0.0,
    }
}

fn line(values: &mut [f64], range: &Range<usize>) {
    let (before, after) = (values[range.start - 1], values[range.end]);
    let count = range.len() as f64 + 1.0;
    for (i, value) in values[range.clone()].iter_mut().enumerate() {
        *value = before + (after - before) * (i as f64 + 1.0) / count;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::milling;

    fn scenario(engagement: &str, helix_deg: f64, rpm: f64) -> Scenario {
        let [helix, rpm] = [helix_deg, rpm].map(|number| number.to_string());
        let mut changes = vec![
            ("process.milling.engagement", engagement),
            ("process.milling.cutter.helix_deg", &helix),
            ("process.milling.spindle_rpm", &rpm),
            ("process.milling.cutter.teeth", "3"),
        ];
        if engagement != "slot" {
            changes.push(("process.milling.radial_depth_mm", "8"));
        }
        milling(&changes)
    }

    fn times() -> Vec<Vec<f64>> {
        vec![(0..1001).map(|k| 1e-3 * f64::from(k)).collect()]
    }

    /// Up-milling at half immersion: teeth leave at a quarter of a turn, three a turn, the first
    /// 70° after the start, and enter, with the ridge of the tooth before, a quarter of a turn
    /// earlier; so they do in a slot, and leave with such a ridge half a turn later.
    #[test]
    fn verify_samples_beside_entry_and_exit_are_bridged() {
        for (engagement, jumps_deg) in [("up", [70.0, -20.0]), ("slot", [-20.0, 160.0])] {
            let jumps = Jumps::new(
                &scenario(engagement, 0.0, 300.0),
                &times(),
                0.5e-3,
                &Way::default(),
            );
            let is_near = |row: &usize| {
                jumps_deg.iter().any(|deg| {
                    let (turn_s, period_s) = (0.2, 0.2 / 3.0);
                    let apart_s = (1e-3 * *row as f64 - deg / 360.0 * turn_s).rem_euclid(period_s);
                    apart_s.min(period_s - apart_s) <= 1.25e-3
                })
            };
            let expected: Vec<usize> = (0..1001).filter(is_near).collect();
            let found: Vec<usize> = jumps.bridges.iter().cloned().flatten().collect();
            assert_eq!(found, expected, "{engagement}");
        }
    }

    /// Down-milling through a face at half immersion, 1 mm of air first: no tooth cuts before; then
    /// teeth enter and leave where the face crosses their circle, until the axis is past it. A tool
    /// that the cut pushes off its path meets both faces elsewhere: by half a millimetre of a
    /// radius of eight, four degrees.
    #[test]
    fn verify_samples_beside_the_face_are_bridged() {
        let mut scenario = scenario("down", 0.0, 300.0);
        let ProcessSpec::Milling(milling) = &mut scenario.process else {
            panic!("a milling scenario");
        };
        milling.lead_in_m = Some(1e-3);
        let entry_rad = milling.cut.engagement.entry_rad;
        let (radius_m, feed_m_per_s) = (8e-3, 3.0 * 0.1e-3 * 5.0);
        let times: Vec<f64> = (0..8001).map(|k| 1e-3 * f64::from(k)).collect();
        for off_m in [[0.0, 0.0], [0.2e-3, -0.5e-3]] {
            let way = Way {
                time_s: vec![0.0, 8.0],
                off_m: vec![off_m; 2],
            };
            let jumps = Jumps::new(&scenario, std::slice::from_ref(&times), 0.5e-3, &way);
            let found: Vec<usize> = jumps.bridges.iter().cloned().flatten().collect();
            // A tip is in the stock if it is beyond the face and on the arc.
            let cuts = |time_s: f64, tooth: f64| {
                let turned = 20f64.to_radians() + TAU * 5.0 * time_s;
                let angle = (turned - tooth * TAU / 3.0).rem_euclid(TAU);
                let [x_m, y_m] = [angle.sin(), angle.cos()].map(|part| radius_m * part);
                let beyond_m = x_m + off_m[0] + feed_m_per_s * time_s - 1e-3 - radius_m;
                beyond_m > 0.0 && y_m + off_m[1] <= radius_m * entry_rad.cos() && angle < PI
            };
            let is_within = |steps: i32, time_s: f64| {
                let about = || (-steps..=steps).map(|k| time_s + 5e-6 * f64::from(k));
                (0..3).any(|tooth| {
                    let states: Vec<bool> = about().map(|t| cuts(t, f64::from(tooth))).collect();
                    states.windows(2).any(|pair| pair[0] != pair[1])
                })
            };
            // Of the first contacts a chip is hardly left; the last rows have no neighbour.
            for (row, time_s) in times.iter().enumerate().take(7990).skip(900) {
                let is_bridged = found.contains(&row);
                // Two and a half steps are 250 of these; over them the face comes nearer.
                let [surely, perhaps] = [246, 254].map(|steps| is_within(steps, *time_s));
                assert!(!surely || is_bridged, "{off_m:?}, row {row}");
                assert!(!is_bridged || perhaps, "{off_m:?}, row {row}");
            }
            assert!(found.iter().all(|row| times[*row] * feed_m_per_s > 0.79e-3));
            assert!(found.len() > 400, "{}", found.len());
        }
    }

    #[test]
    fn what_does_not_jump_is_left_alone() {
        for (scenario, why) in [
            (scenario("up", 40.0, 30.0), "a helical edge leaves slowly"),
            (scenario("up", 0.0, 6000.0), "teeth pass every third sample"),
        ] {
            let jumps = Jumps::new(&scenario, &times(), 0.2e-3, &Way::default());
            assert_eq!(jumps.count(), 0, "{why}");
        }
    }

    /// A line stays a line, whatever its samples beside jumps were.
    #[test]
    fn verify_a_line_is_bridged_by_itself() {
        let jumps = Jumps::new(
            &scenario("down", 0.0, 300.0),
            &times(),
            0.5e-3,
            &Way::default(),
        );
        let straight: Vec<f64> = (0..1001).map(|k| 3.0 - 0.01 * f64::from(k)).collect();
        let mut values = straight.clone();
        for range in &jumps.bridges {
            values[range.clone()].fill(f64::NAN);
        }
        assert!(jumps.count() > 40);
        jumps.bridge(&mut values);
        for (found, expected) in values.iter().zip(&straight) {
            assert!((found - expected).abs() < 1e-12);
        }
    }
}
