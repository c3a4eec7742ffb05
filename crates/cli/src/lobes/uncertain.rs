//! How the limits of a diagram spread with what is uncertain.

use std::time::Instant;

use serde::Serialize;
use truecut_plan::PlanError;
use truecut_plan::lobes::Lobes;
use truecut_plan::spread::{LimitOf, Spread};
use truecut_recording::{Unit, significant};
use truecut_scenario::Scenario;
use truecut_sim::stability::{Draws, MillingStudy, in_scenario};

use super::{Diagram, rpm};
use crate::failure::Failure;
use crate::figure::{BLACK, BLUE, Layer, Panel};
use crate::progress::Progress;
use crate::spread::{self, SpreadJson, Spreads};
use crate::text;

/// About as many speeds as a band is drawn through.
const SPEEDS: usize = 40;
/// Depth looked at for the scenario's own cut, at least, as a multiple of its depth.
const BEYOND: f64 = 1.5;

/// Limits with what is uncertain drawn.
pub struct Uncertain {
    pub keys: Vec<String>,
    /// At the scenario's own speed; none where limits are not known.
    pub own: Option<Spread>,
    /// By speed, rad/s.
    pub over_speed: Spreads,
    effort: String,
}

/// Draws what a scenario says is uncertain; none if it says nothing of it.
pub fn uncertain(
    scenario: &Scenario,
    study: &MillingStudy,
    posture: &[f64],
    lobes: &Lobes,
    known_to_rad_s: Option<f64>,
) -> Result<Option<Uncertain>, Failure> {
    let since = Instant::now();
    let Some(draws) = Draws::of(scenario).map_err(|error| Failure::sim(scenario, error))? else {
        return Ok(None);
    };
    let of = LimitOf {
        posture,
        world_from_milling: study.path.world_from_milling(0),
        regeneration: study.regeneration(),
    };
    let deepest_m = lobes.depth_m.last().copied().unwrap_or(0.0);
    let own_deepest_m = deepest_m.max(BEYOND * study.cut.nominal.axial_depth_m);
    let is_known = |speed: &f64| known_to_rad_s.is_none_or(|known| *speed <= known);
    let every = lobes.spindle_rad_s.len().div_ceil(SPEEDS);
    let speeds: Vec<f64> = (lobes.spindle_rad_s.iter().step_by(every).copied())
        .filter(is_known)
        .collect();
    let own = Some(study.cut.spindle_rad_s).filter(is_known);
    let found = Progress::of_one("what is uncertain", |progress| {
        let count = (speeds.len() + 1) as f64;
        let own = own.map(|speed| of.at_speed(&draws.sets, speed, own_deepest_m));
        let over_speed = speeds.iter().enumerate().map(|(k, speed)| {
            progress((k + 1) as f64 / count);
            let spread = of.at_speed(&draws.sets, *speed, deepest_m)?;
            Ok::<_, PlanError>((*speed, spread))
        });
        Ok::<_, PlanError>((
            own.transpose()?,
            over_speed.collect::<Result<Spreads, _>>()?,
        ))
    });
    let (own, over_speed) = found.map_err(|error| Failure::sim(scenario, in_scenario(error)))?;
    let all = over_speed.iter().map(|(_, spread)| spread).chain(&own);
    Ok(Some(Uncertain {
        effort: spread::effort(all, since),
        keys: draws.keys,
        own,
        over_speed,
    }))
}

/// What is told of it.
pub fn told(uncertain: &Uncertain, diagram: &Diagram<'_>) -> String {
    let mut text = format!(
        "  uncertain: {} ({})\n",
        spread::keys(&uncertain.keys),
        uncertain.effort
    );
    let Some(own) = &uncertain.own else {
        return text;
    };
    let depth = |m: f64| match m.is_finite() {
        true => text::show(Unit::Metre, m),
        false => "no limit that was found".to_owned(),
    };
    let [low, median, high] = own.quantiles.map(depth);
    text.push_str(&format!(
        "    at {} rpm 5 to 95 % of the limits lie from {low} to {high}, \
         half of them below {median}\n    \
         the cut of {} is {}\n",
        significant(rpm(diagram.study.cut.spindle_rad_s), 4),
        text::show(Unit::Metre, diagram.study.cut.nominal.axial_depth_m),
        spread::stable(own)
    ));
    text
}

/// The band of limits.
pub fn band(uncertain: &Uncertain, deepest_mm: f64) -> Layer {
    let scale = [rpm(1.0), 1e3];
    spread::band(
        "5 to 95 % of what is uncertain",
        &uncertain.over_speed,
        scale,
        deepest_mm,
        BLUE,
    )
}

/// The probability that the scenario's depth is stable.
pub fn probability(uncertain: &Uncertain, depth_mm: f64) -> Panel {
    let points = spread::probability(&uncertain.over_speed, rpm(1.0));
    Panel::new(
        format!(
            "Probability that {} mm are stable",
            significant(depth_mm, 3)
        ),
        "spindle speed [rpm]",
        "probability [%]",
        vec![Layer::line("", points, BLACK)],
    )
}

/// For other programs, in SI.
#[derive(Serialize)]
pub struct UncertainJson<'a> {
    keys: &'a [String],
    /// At the scenario's own speed.
    own: Option<SpreadJson>,
    speeds: Vec<AtSpeed>,
}

#[derive(Serialize)]
struct AtSpeed {
    spindle_rad_s: f64,
    #[serde(flatten)]
    limit_m: SpreadJson,
}

impl<'a> From<&'a Uncertain> for UncertainJson<'a> {
    fn from(uncertain: &'a Uncertain) -> Self {
        let at_speed = |(speed, spread): &(f64, Spread)| AtSpeed {
            spindle_rad_s: *speed,
            limit_m: spread.into(),
        };
        Self {
            keys: &uncertain.keys,
            own: uncertain.own.as_ref().map(SpreadJson::from),
            speeds: uncertain.over_speed.iter().map(at_speed).collect(),
        }
    }
}
