//! The `[[uncertain]]` tables: nominal values that are not known exactly.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::check::Check;
use crate::fault::Fault;
use crate::sweep_check::check_key;
use crate::units::key_unit;

/// A nominal value that is not known exactly.
#[derive(Debug, Clone, PartialEq)]
pub struct UncertainSpec {
    /// Dotted key of the scenario.
    pub key: String,
    /// Its value in the scenario, SI.
    pub value: f64,
    /// Standard deviation, SI.
    pub sigma: f64,
}

impl UncertainSpec {
    /// The value as it is written in the file, in the key's own unit, for a value in SI.
    pub fn written(&self, value_si: f64) -> String {
        format!("{:?}", key_unit(&self.key).from_si(value_si))
    }
}

/// A nominal value that is not known exactly; it may be refitted before anything else is blamed.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct UncertainTable {
    /// Dotted key of the scenario.
    key: String,
    /// One standard deviation as a share of the value. Either this or absolute is needed.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "what is uncertain has a spread"))]
    relative: Option<f64>,
    /// One standard deviation in the key's own unit.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "what is uncertain has a spread"))]
    absolute: Option<f64>,
}

/// How fast the clock of the data goes beside that of the machine.
pub const CLOCK_RATE: &str = "data.clock_rate";

/// Factors whose value is 1 where the scenario does not give them.
const FACTORS: [&str; 4] = [
    CLOCK_RATE,
    "robot.inertia_scale",
    "robot.stiffness_scale",
    "robot.damping_scale",
];

/// Refuses a key that has a spread already: which of both would hold?
pub(crate) fn refuse_twice(all: &[UncertainSpec], check: &mut Check) {
    for (index, one) in all.iter().enumerate() {
        if all[..index].iter().any(|other| other.key == one.key) {
            let at = format!("uncertain.{index}.key");
            let message = format!("`{at}` is \"{}\", which has a spread already", one.key);
            check.refuse(Fault::value(&at, message, "given twice"));
        }
    }
}

/// Refuses an uncertain clock that nothing tells.
pub(crate) fn refuse_clock(all: &[UncertainSpec], replays: bool, check: &mut Check) {
    let Some(index) = all.iter().position(|one| one.key == CLOCK_RATE) else {
        return;
    };
    let why = match (replays, check.document().has("data")) {
        (true, _) => {
            "which a replay cannot tell: what drives the model is stamped by the clock of what it is \
             compared with"
        }
        (false, false) => "but the scenario has no [data] whose clock that could be",
        (false, true) => return,
    };
    let at = format!("uncertain.{index}.key");
    let message = format!("`{at}` is \"{CLOCK_RATE}\", {why}");
    let fault = Fault::value(&at, message, "nothing to tell it by");
    check.refuse(match replays {
        true => fault.with_help("in mode \"inverse\" the effect `clock_rate` is looked for"),
        false => fault,
    });
}

impl UncertainTable {
    /// `table` is the dotted path of this table. `None` after recording a fault.
    pub(crate) fn resolve(self, table: &str, check: &mut Check) -> Option<UncertainSpec> {
        let at = format!("{table}.key");
        (self.key == CLOCK_RATE || check_key(&self.key, &at, check)).then_some(())?;
        let written = check.document().number(&self.key);
        let default = FACTORS.contains(&self.key.as_str()).then_some(1.0);
        let Some(value) = written.or(default) else {
            let message = format!(
                "`{at}` is \"{}\", which the scenario does not give: write its nominal value into it",
                self.key
            );
            check.refuse(Fault::value(&at, message, "no nominal value"));
            return None;
        };
        let sigma = match (self.relative, self.absolute) {
            (Some(relative), None) if value != 0.0 => relative * value.abs(),
            (None, Some(absolute)) => absolute,
            (Some(_), None) => {
                let path = format!("{table}.relative");
                let message = format!("`{path}` has no meaning: `{}` is 0", self.key);
                let fault = Fault::value(&path, message, "a share of nothing");
                check.refuse(fault.with_help("give `absolute`"));
                return None;
            }
            (given, _) => {
                let message = format!("[{table}] needs either `relative` or `absolute`");
                let label = if given.is_some() { "both" } else { "neither" };
                check.refuse(Fault::key(&format!("{table}.relative"), message, label));
                return None;
            }
        };
        let factor = key_unit(&self.key).si_factor;
        Some(UncertainSpec {
            key: self.key,
            value: value * factor,
            sigma: sigma * factor,
        })
    }
}
