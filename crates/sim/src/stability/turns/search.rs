//! Ways in which an arm goes along a path.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use truecut_arm::{BranchOptions, FrameId, Robot};
use truecut_scenario::{PathMillingSpec, Scenario};

use super::{PathPosture, each, path_of, spin_key};
use crate::build::in_context;
use crate::error::SimError;
use crate::posture::posture;
use crate::process::SetupContext;
use crate::process::path_milling::along::{CutPlaces, Followed, followed, places};
use crate::robots::Robots;

/// Most postures at the start that are looked at for one turn: an arm with more joints than six has
/// any number of them.
const MOST_STARTS: usize = 8;

/// A turn about the tool's axis, rad, and the ways in which the arm can go with it.
pub(super) type Led = (f64, Result<Vec<Followed>, SimError>);

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
        let first = self.followed(&spin_key(spin_rad))?;
        let robot = Robots::new().robot(&self.scenario.robot)?;
        let begins = first.start().to_vec();
        let pose = robot.world_from_frame(&begins, FrameId::Tool);
        let is_first = |q: &[f64]| q.iter().zip(&begins).all(|(a, b)| (a - b).abs() < 1e-3);
        let others = self.ways_of_each(spin_rad, &robot, &pose, &is_first);
        let mut all = vec![first];
        all.extend(others);
        Ok(all)
    }

    /// Turns with what became of them, those that cannot be followed tried from other postures.
    pub fn second_tries(
        &self,
        led: Vec<Led>,
        progress: (&(dyn Fn(f64) + Sync), [f64; 2]),
    ) -> Vec<Led> {
        let (can, cannot): (Vec<_>, Vec<_>) = led.into_iter().partition(|(_, led)| led.is_ok());
        let known = can.first().and_then(|(spin_rad, led)| {
            let led = led.as_ref().ok()?;
            Some((*spin_rad, led.first()?))
        });
        let mut all: Vec<_> = match known {
            None => cannot,
            Some(known) => each(cannot, progress, |(spin_rad, fault)| {
                let beside = self.starts_beside(spin_rad, known);
                let beside = beside.ok().filter(|led| !led.is_empty());
                (spin_rad, beside.map_or(fault, Ok))
            }),
        };
        all.extend(can);
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all
    }

    /// The same where the way that begins nearest to the scenario's posture leads nowhere: from the
    /// other postures, told by the pose with which another turn begins.
    fn starts_beside(
        &self,
        spin_rad: f64,
        (its_rad, its): (f64, &Followed),
    ) -> Result<Vec<Followed>, SimError> {
        let robot = Robots::new().robot(&self.scenario.robot)?;
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), spin_rad - its_rad);
        let pose = robot.world_from_frame(its.start(), FrameId::Tool) * turn;
        Ok(self.ways_of_each(spin_rad, &robot, &pose, &|_| false))
    }

    /// From each posture of a pose, but for those that are known, the ways that the arm can go.
    fn ways_of_each(
        &self,
        spin_rad: f64,
        robot: &Robot,
        pose: &Isometry3<f64>,
        is_known: &dyn Fn(&[f64]) -> bool,
    ) -> Vec<Followed> {
        let postures = self.postures(robot, pose).unwrap_or_default();
        let fits = |q: &Vec<f64>| robot.check_posture(q).is_ok() && !is_known(q);
        let led = |start| {
            let way = PathPosture {
                spin_rad: Some(spin_rad),
                start,
                duration_s: 0.0,
                margins: Vec::new(),
                bend_m: [0.0; 2],
            };
            // One that leads out of reach is none.
            self.followed(&way.keys(robot)).ok()
        };
        let postures = postures.into_iter().filter(fits).take(MOST_STARTS);
        postures.filter_map(led).collect()
    }

    /// The postures of a pose, slides where the scenario has them.
    fn postures(&self, robot: &Robot, pose: &Isometry3<f64>) -> Result<Vec<Vec<f64>>, SimError> {
        let slides: Vec<usize> = robot.slides().collect();
        let of = |robot: &Robot| {
            (robot.ik_solver(&BranchOptions::default())).branches(pose, FrameId::Tool)
        };
        if slides.is_empty() {
            return Ok(of(robot));
        }
        let own = posture(&self.scenario.robot, robot)?;
        let places: Vec<f64> = slides.iter().map(|&at| own[at]).collect();
        let whole = |turned: Vec<f64>| {
            let mut turned = turned.into_iter();
            let each = own.iter().enumerate();
            each.map(|(at, value)| match slides.contains(&at) {
                true => *value,
                false => turned.next().unwrap_or(*value),
            })
            .collect()
        };
        let held = robot.with_slides_at(&places)?;
        Ok(of(&held).into_iter().map(whole).collect())
    }
}
