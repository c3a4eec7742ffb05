//! Arguments of `lobes` and `posture`.

use std::path::PathBuf;

use clap::Args;
use truecut_plan::{Criterion, LEAST_DECAY};

use super::Common;
use super::number::{above_zero, above_zero_to, number};

#[derive(Debug, Args)]
pub struct LobesArguments {
    /// Scenario file, with [process.milling] or [process.path_milling]
    pub scenario: PathBuf,
    /// Slowest and fastest spindle speed [default: a tenth of the scenario's (along a path a half)
    /// and one and a quarter of it]
    #[arg(long, value_name = "FROM,TO", value_parser = parse_range)]
    pub rpm: Option<[f64; 2]>,
    /// Deepest cut, at most 1000 as in a scenario [default: three times the scenario's, or a fifth
    /// more than its limit]
    #[arg(long, value_name = "MM", value_parser = parse_depth)]
    pub deepest: Option<f64>,
    /// How many speeds and depths the diagram has; along a path, how many speeds are looked at
    #[arg(long, value_name = "N", default_value = "100", value_parser = clap::value_parser!(u16).range(2..=1000))]
    pub size: u16,
    /// How many runs are simulated, just below and just above the limit in turns; along a path at
    /// its own speeds and at those proposed; 0 for none
    #[arg(long, value_name = "N", default_value = "12", value_parser = clap::value_parser!(u16).range(0..=1000))]
    pub runs: u16,
    /// Where on the path the arm stands, from its start [default: 0]
    #[arg(long, value_name = "MM", value_parser = parse_distance)]
    pub at: Option<f64>,
    /// Folder for outputs; the scenario gets a folder of its own in it
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    #[command(flatten)]
    pub common: Common,
}

#[derive(Debug, Args)]
pub struct PostureArguments {
    /// Scenario file, with [process.milling], or with [process.path_milling] along a path from CAM:
    /// then the turn about the tool's axis and the posture at the start are chosen by the least
    /// margin against chatter
    pub scenario: PathBuf,
    /// By what a posture counts as stable
    #[arg(long, value_enum, default_value_t = CriterionName::Regenerative)]
    pub criterion: CriterionName,
    /// Least decay of vibration in the cut, as a part of that of the arm's slowest mode when
    /// nothing is cut; from 0 to less than 1
    #[arg(long, value_name = "PART", default_value_t = LEAST_DECAY, value_parser = parse_part)]
    pub least_decay: f64,
    /// Draw the maps of stiffness and limit over joints 2 and 3 too
    #[arg(long)]
    pub maps: bool,
    /// Along a path: how many runs are simulated, one in the best posture and one as the scenario
    /// has it [default: 2]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(0..=2))]
    pub runs: Option<u16>,
    /// Folder for outputs; the scenario gets a folder of its own in it
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    #[command(flatten)]
    pub common: Common,
}

/// By what a posture counts as stable.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum CriterionName {
    /// (k_max - k_min)/k_max at least 0.1: a published rule, no stability bound
    Anisotropy,
    /// Undamped planar mode coupling
    Flutter,
    /// Mode coupling of all modes, teeth meeting the nominal surface
    ModeCoupling,
    /// Regeneration of all modes, teeth meeting the surface that earlier ones left, with the floor
    Regenerative,
}

impl From<CriterionName> for Criterion {
    fn from(name: CriterionName) -> Criterion {
        match name {
            CriterionName::Anisotropy => Criterion::Anisotropy,
            CriterionName::Flutter => Criterion::Flutter,
            CriterionName::ModeCoupling => Criterion::ModeCoupling,
            CriterionName::Regenerative => Criterion::Regenerative,
        }
    }
}

fn parse_distance(text: &str) -> Result<f64, String> {
    number(text, |value| value >= 0.0, "must be a number, 0 or above")
}

/// A depth of cut as deep as a scenario's may be, mm.
fn parse_depth(text: &str) -> Result<f64, String> {
    above_zero_to(text, 1000.0)
}

fn parse_part(text: &str) -> Result<f64, String> {
    let rule = "must be a number from 0 to less than 1: a mode in which the tool does not move \
                decays as without a cut";
    number(text, |value| (0.0..1.0).contains(&value), rule)
}

fn parse_range(text: &str) -> Result<[f64; 2], String> {
    let ends = text.split_once(',');
    match ends.map(|(from, to)| [from, to].map(|end| above_zero(end.trim()))) {
        Some([Ok(from), Ok(to)]) if from < to => Ok([from, to]),
        _ => Err("write FROM,TO, two numbers above 0 that rise, e.g. 300,3000".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_rise_and_distances_are_not_negative() {
        assert_eq!(parse_range("300, 3000"), Ok([300.0, 3000.0]));
        for wrong in ["300", "3000,300", "0,300", "a,b", "300,inf"] {
            assert!(parse_range(wrong).is_err(), "{wrong}");
        }
        assert_eq!(parse_distance("0"), Ok(0.0));
        assert_eq!(parse_depth("1000"), Ok(1000.0));
        for wrong in ["0", "-1", "1000.1", "1e308"] {
            let told = parse_depth(wrong).unwrap_err();
            assert!(told.contains("at most 1000"), "{wrong}: {told}");
        }
        assert_eq!(parse_part("0.3"), Ok(0.3));
        assert!(parse_part("1").is_err() && parse_part("-0.1").is_err());
        assert!(parse_distance("-1").is_err() && parse_distance("nan").is_err());
    }
}
