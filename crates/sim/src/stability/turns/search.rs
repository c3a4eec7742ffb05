//! Ways in which an arm goes along a path.

use truecut_arm::{BranchOptions, FrameId};
use truecut_scenario::{PathMillingSpec, Scenario};

use super::{PathPosture, path_of, spin_key};
use crate::build::in_context;
use crate::error::SimError;
use crate::process::SetupContext;
use crate::process::path_milling::along::{CutPlaces, Followed, followed, places};
use crate::robots::Robots;

/// Most postures at the start that are looked at for one turn: an arm with more joints than six has
/// any number of them.
const MOST_STARTS: usize = 8;

/// A scenario whose keys are changed.
pub(super) struct Search<'a> {
    pub scenario: &'a Scenario,
}

impl Search<'_> {
    /// With keys of the scenario changed.
    fn with<T>(
        &self,
        keys: &[(String, String)],
        ask: impl FnOnce(&PathMillingSpec, &SetupContext<'_>) -> Result<T, SimError>,
    ) -> Result<T, SimError> {
        let varied = self.scenario.with_overrides(keys)?;
        let spec = path_of(&varied)?;
        // Each has its own robot: those that are kept remember every path that they were led along.
        in_context(&varied, &Robots::new(), |context| ask(spec, context))
    }

    pub fn followed(&self, keys: &[(String, String)]) -> Result<Followed, SimError> {
        self.with(keys, followed)
    }

    pub fn met(&self, keys: &[(String, String)]) -> Result<CutPlaces, SimError> {
        self.with(keys, places)
    }

    /// The arm led along from each posture in which it can begin with a turn; the first fault if
    /// from none of them.
    pub fn starts(&self, spin_rad: f64) -> Result<Vec<Followed>, SimError> {
        let keys = spin_key(spin_rad);
        let first = self.followed(&keys);
        let begins = match &first {
            Ok(led) => Some(led.start().to_vec()),
            Err(_) => None,
        };
        let Some(begins) = begins else {
            return first.map(|led| vec![led]);
        };
        let robot = Robots::new().robot(&self.scenario.robot)?;
        let pose = robot.world_from_frame(&begins, FrameId::Tool);
        let others = (robot.ik_solver(&BranchOptions::default())).branches(&pose, FrameId::Tool);
        let is_other = |q: &Vec<f64>| {
            robot.check_posture(q).is_ok()
                && (q.iter().zip(&begins)).any(|(a, b)| (a - b).abs() > 1e-3)
        };
        let others = others.into_iter().filter(is_other).take(MOST_STARTS - 1);
        let mut all: Vec<Followed> = first.into_iter().collect();
        for start in others {
            let posture = PathPosture {
                spin_rad: Some(spin_rad),
                start,
                duration_s: 0.0,
                margins: Vec::new(),
                bend_m: [0.0; 2],
            };
            // One that leads out of reach is none.
            all.extend(self.followed(&posture.keys(&robot)));
        }
        Ok(all)
    }
}
