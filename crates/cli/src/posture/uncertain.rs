//! How stability along a plan spreads with what is uncertain.

use std::time::Instant;

use serde::Serialize;
use truecut_plan::spread::Spread;
use truecut_plan::{Criterion, Plan, PlanError, Planner};
use truecut_recording::Unit;
use truecut_sim::stability::Draws;

use super::text::runs;
use super::{MAP_COLUMNS, Own, PostureAnswer, figure};
use crate::failure::Failure;
use crate::figure::{BLACK, BLUE, Layer, PINK, Panel};
use crate::progress::Progress;
use crate::spread::{self, SpreadJson, Spreads};
use crate::text;

/// Probability from which on an angle is told.
const LIKELY: f64 = 0.95;

/// What the plan's criterion says with what is uncertain drawn.
pub struct Uncertain {
    keys: Vec<String>,
    /// By place along the path, m.
    pub plan: Spreads,
    own: Option<Spreads>,
    /// By redundancy angle at mid-path, rad.
    angles: Spreads,
    effort: String,
}

/// What the draws say; `since` is when they were begun.
pub fn uncertain(
    (draws, since): (Draws, Instant),
    planner: &Planner<'_>,
    plan: &Plan,
    own: Option<&Own>,
) -> Result<Uncertain, PlanError> {
    let sets = &draws.sets;
    let middle_m = 0.5 * plan.points[plan.points.len() - 1].along_m;
    let along = |plan: &Plan, progress: &dyn Fn(f64)| {
        planner.spread_along(plan, sets, MAP_COLUMNS, progress)
    };
    let (plan, own, angles) = Progress::of_one("what is uncertain", |progress| {
        let part = |from: f64| move |done: f64| progress((from + done) / 3.0);
        let planned = along(plan, &part(0.0))?;
        let own = own.map(|own| along(&own.plan, &part(1.0))).transpose()?;
        let which = (plan.criterion, plan.family);
        let angles = planner.spread_over_angles(which, middle_m, sets, &part(2.0))?;
        Ok::<_, PlanError>((planned, own, angles))
    })?;
    let lists = [Some(&plan), own.as_ref(), Some(&angles)];
    let all = lists.into_iter().flatten().flatten();
    Ok(Uncertain {
        effort: spread::effort(all.map(|(_, spread)| spread), since),
        keys: draws.keys,
        plan,
        own,
        angles,
    })
}

/// Unit of a criterion's value.
fn value_unit(criterion: Criterion) -> Unit {
    match criterion {
        Criterion::Anisotropy => Unit::One,
        _ => Unit::Metre,
    }
}

impl Uncertain {
    /// What is told of it.
    pub fn told(&self, answer: &PostureAnswer<'_>) -> String {
        let mut text = format!(
            "\n  uncertain: {} ({})\n",
            spread::keys(&self.keys),
            self.effort
        );
        let unit = value_unit(answer.plan.criterion);
        let whose = [
            ("the plan", Some(&self.plan)),
            ("the scenario's own postures", self.own.as_ref()),
        ];
        for (name, spreads) in whose {
            let Some((at, least)) = spreads.and_then(least_likely) else {
                continue;
            };
            let show = |value: f64| match value.is_finite() {
                true => text::show(unit, value),
                false => "no limit that was found".to_owned(),
            };
            text.push_str(&format!(
                "    {name}: {} at {} from the start, where that is least\n      \
                 5 to 95 % of the values there lie from {} to {}\n",
                spread::stable(least),
                text::show(Unit::Metre, *at),
                show(least.quantiles[0]),
                show(least.quantiles[2]),
            ));
        }
        let likely = self
            .angles
            .iter()
            .map(|(angle, spread)| (angle.to_degrees(), spread.stable.value >= LIKELY));
        text.push_str(&format!(
            "    angles at mid-path that are stable with a probability of {:.0} % or more, \
             deg: {}\n",
            100.0 * LIKELY,
            runs(likely)
        ));
        text
    }

    /// Limits and probabilities along the path, probabilities over the angle.
    pub fn panels(&self, answer: &PostureAnswer<'_>) -> Vec<Panel> {
        let unit = value_unit(answer.plan.criterion);
        let (scale, symbol) = match unit {
            Unit::Metre => (1e3, "mm"),
            _ => (1.0, "1"),
        };
        let over = "along the path [mm]";
        let lists = [
            ("plan", Some(&self.plan), BLUE),
            ("scenario", self.own.as_ref(), PINK),
        ];
        let lists = || {
            lists
                .iter()
                .filter_map(|(name, list, colour)| Some((*name, (*list)?, *colour)))
        };
        let bands = lists().flat_map(|(name, list, colour)| {
            let middle = list
                .iter()
                .map(|(at, s)| (at * 1e3, s.quantiles[1] * scale));
            [
                spread::band(
                    &format!("{name}, 5 to 95 %"),
                    list,
                    [1e3, scale],
                    f64::NAN,
                    colour,
                ),
                Layer::line("", middle, colour),
            ]
        });
        let probabilities = lists()
            .map(|(name, list, colour)| Layer::line(name, spread::probability(list, 1e3), colour));
        let needed = answer.plan.criterion.needed(&answer.study.cut) * scale;
        let ends = [0.0, 1e3 * answer.study.path.length_m()];
        let needed = Layer::dashed("needed", ends.map(|x| (x, needed)), BLACK);
        let turn = 1_f64.to_degrees();
        vec![
            Panel::new(
                "With what is uncertain",
                over,
                format!("{} [{symbol}]", figure::name(answer.plan.criterion)),
                bands.chain([needed]).collect(),
            ),
            Panel::new(
                "",
                over,
                "probability of being stable [%]",
                probabilities.collect(),
            ),
            Panel::new(
                "At mid-path",
                "redundancy angle [deg]",
                "probability of being stable [%]",
                vec![Layer::line(
                    "",
                    spread::probability(&self.angles, turn),
                    BLUE,
                )],
            ),
        ]
    }

    /// For other programs, in SI.
    pub fn json(&self, answer: &PostureAnswer<'_>) -> Result<String, Failure> {
        let along = |list: &Spreads| list.iter().map(Along::from).collect();
        text::json(&Report {
            scenario: &answer.scenario.name,
            criterion: figure::name(answer.plan.criterion),
            keys: &self.keys,
            plan: along(&self.plan),
            own: self.own.as_ref().map(along),
            angles_at_mid_path: self.angles.iter().map(AtAngle::from).collect(),
        })
    }
}

/// The place where a cut is least likely stable.
fn least_likely(spreads: &Spreads) -> Option<&(f64, Spread)> {
    let stable = |one: &&(f64, Spread)| one.1.stable.value;
    spreads
        .iter()
        .min_by(|a, b| stable(a).total_cmp(&stable(b)))
}

#[derive(Serialize)]
struct Report<'a> {
    scenario: &'a str,
    criterion: &'a str,
    keys: &'a [String],
    plan: Vec<Along>,
    /// The scenario's own postures; none where the arm cannot follow its path.
    own: Option<Vec<Along>>,
    angles_at_mid_path: Vec<AtAngle>,
}

#[derive(Serialize)]
struct Along {
    along_m: f64,
    #[serde(flatten)]
    spread: SpreadJson,
}

#[derive(Serialize)]
struct AtAngle {
    redundancy_rad: f64,
    #[serde(flatten)]
    spread: SpreadJson,
}

impl From<&(f64, Spread)> for Along {
    fn from((along_m, spread): &(f64, Spread)) -> Self {
        Self {
            along_m: *along_m,
            spread: spread.into(),
        }
    }
}

impl From<&(f64, Spread)> for AtAngle {
    fn from((redundancy_rad, spread): &(f64, Spread)) -> Self {
        Self {
            redundancy_rad: *redundancy_rad,
            spread: spread.into(),
        }
    }
}
