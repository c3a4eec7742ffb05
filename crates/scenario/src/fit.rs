//! The `[fit]` table: the unknowns of a least-squares fit of drive forces (`truecut fit`).

use schemars::JsonSchema;
use serde::Deserialize;

use crate::check::Check;
use crate::fault::Fault;
use crate::process::ProcessSpec;
use crate::process::replay::ReplayMode;

/// What a fit of drive forces has as unknowns, for all joints at once.
#[derive(Debug, Clone, PartialEq)]
pub struct FitSpec {
    /// The unknowns.
    pub unknowns: Vec<Unknown>,
    /// Joints with rotors and friction to be found, counted from 0; `None` for all.
    pub joints: Option<Vec<usize>>,
    /// Motors that turn with several joints.
    pub coupled_motors: Vec<CoupledMotor>,
    /// A rotary joint below this speed stands, rad/s.
    pub standstill_rad_per_s: f64,
    /// The same of a prismatic joint, m/s.
    pub standstill_m_per_s: f64,
    /// Number of blocks of the record that are left out in turn.
    pub blocks: usize,
}

/// A kind of unknown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Unknown {
    /// The ten inertial parameters of every link, as far as drive forces show them.
    Links,
    /// The ten inertial parameters of a body on the last link; the links are known.
    Payload,
    /// The inertia of the rotor of every joint, on the joint's side.
    Rotors,
    /// Viscous friction of every joint.
    Viscous,
    /// Dry friction of every joint.
    Coulomb,
    /// A constant drive force of every joint.
    Offset,
}

/// A motor whose angle is a weighted sum of joint coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct CoupledMotor {
    /// The joints, counted from 0.
    pub joints: Vec<usize>,
    /// Angle of the motor per coordinate of each of them, reduced to the joints' side.
    pub ratios: Vec<f64>,
}

/// Unknowns of a fit of drive forces.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct FitTable {
    /// The unknowns.
    #[schemars(extend("minItems" = 1))]
    unknowns: Vec<Unknown>,
    /// Joints with rotors and friction to be found, counted from 1. Default: all.
    #[schemars(extend("minItems" = 1))]
    joints: Option<Vec<u16>>,
    /// Motors that turn with several joints.
    coupled_motor: Option<Vec<CoupledMotorTable>>,
    /// A rotary joint below this speed stands: what friction then holds is not known, and its drive
    /// torque is not fitted. Default: 0.02.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "a speed has a size"))]
    standstill_rad_per_s: Option<f64>,
    /// The same of a prismatic joint. Default: 0.005.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "a speed has a size"))]
    standstill_m_per_s: Option<f64>,
    /// Number of blocks of the record that are left out in turn, for the error on data that were
    /// not fitted and for intervals. Default: 10.
    #[schemars(extend("minimum" = 4, "maximum" = 100, "x-rule" = "intervals need some blocks, and blocks some data"))]
    blocks: Option<u16>,
}

/// A motor that turns with several joints.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct CoupledMotorTable {
    /// The joints, counted from 1.
    #[schemars(extend("minItems" = 2))]
    joints: Vec<u16>,
    /// Angle of the motor per coordinate of each joint, reduced to the joints' side. Default: 1 for
    /// each.
    ratios: Option<Vec<f64>>,
}

const STANDSTILL_RAD_PER_S: f64 = 0.02;
const STANDSTILL_M_PER_S: f64 = 0.005;
const BLOCKS: u16 = 10;

impl FitTable {
    pub(crate) fn resolve(self, process: Option<&ProcessSpec>, check: &mut Check) -> FitSpec {
        let inverse = |process: &ProcessSpec| match process {
            ProcessSpec::Replay(replay) => matches!(replay.mode, ReplayMode::Inverse { .. }),
            _ => false,
        };
        if process.is_some_and(|process| !inverse(process)) {
            let message = "[fit] needs [process.replay] with mode \"inverse\": drive forces are \
                           fitted to measured motion";
            check.refuse(Fault::key("fit", message.to_owned(), "nothing to fit"));
        }
        let has = |unknown: Unknown| self.unknowns.contains(&unknown);
        if has(Unknown::Links) && has(Unknown::Payload) {
            let is = "holds \"links\" and \"payload\", but a payload is a part of the last link";
            check.wrong("fit", "unknowns", is, "one or the other");
        }
        let unknowns = self.unknowns.iter().enumerate();
        let twice = unknowns.filter(|(i, one)| self.unknowns[..*i].contains(one));
        for (_, unknown) in twice {
            let name = format!("{unknown:?}").to_lowercase();
            let is = format!("holds \"{name}\" twice");
            check.wrong("fit", "unknowns", is, "each once");
        }
        let coupled_motors = (self
            .coupled_motor
            .unwrap_or_default()
            .into_iter()
            .enumerate())
        .map(|(index, one)| one.resolve(&format!("fit.coupled_motor.{index}"), check))
        .collect();
        FitSpec {
            joints: (self.joints).map(|joints| from_one("fit", joints, check)),
            unknowns: self.unknowns,
            coupled_motors,
            standstill_rad_per_s: self.standstill_rad_per_s.unwrap_or(STANDSTILL_RAD_PER_S),
            standstill_m_per_s: self.standstill_m_per_s.unwrap_or(STANDSTILL_M_PER_S),
            blocks: usize::from(self.blocks.unwrap_or(BLOCKS)),
        }
    }
}

impl CoupledMotorTable {
    fn resolve(self, table: &str, check: &mut Check) -> CoupledMotor {
        let joints = from_one(table, self.joints, check);
        let ratios = self.ratios.unwrap_or_else(|| vec![1.0; joints.len()]);
        if ratios.len() != joints.len() || ratios.contains(&0.0) {
            let is = format!(
                "is {ratios:?}, but must hold a number other than 0 for each of the {} joints",
                joints.len()
            );
            check.wrong(table, "ratios", is, "one for each joint");
        }
        CoupledMotor { joints, ratios }
    }
}

/// Joints counted from 0, each named once. That the chain has them is seen when it is read.
fn from_one(table: &str, joints: Vec<u16>, check: &mut Check) -> Vec<usize> {
    let twice = (joints.iter().enumerate()).any(|(i, joint)| joints[..i].contains(joint));
    if twice || joints.contains(&0) {
        let is = format!("is {joints:?}, but joints are counted from 1 and named once");
        check.wrong(table, "joints", is, "no such list of joints");
    }
    (joints.into_iter())
        .map(|joint| usize::from(joint).saturating_sub(1))
        .collect()
}
