//! What ways along a path are worth.

use nalgebra::{DVector, Matrix3, Vector3};
use rayon::prelude::*;
use truecut_arm::FrameId;
use truecut_core::chatter::TipMode;
use truecut_plan::modes_in_cut;

use super::super::along::{PathPlace, Study, known};
use super::super::in_scenario;
use super::search::Search;
use super::{LOOKED_AT, PLENTY, PathPosture, nothing_there};
use crate::error::SimError;
use crate::process::path_milling::along::{CutPlace, Followed};

/// The turn that is taken, and its way.
pub(super) struct Choice {
    /// Its index.
    pub best: usize,
    pub led: Followed,
    /// Whether the scenario's own is as good.
    pub is_own: bool,
}

/// Places of a path at which a cut is looked at.
pub(super) struct Met<'a> {
    pub study: &'a Study<'a>,
    pub places: Vec<&'a CutPlace>,
}

impl<'a> Met<'a> {
    /// The strongest engagement of each stretch of the path.
    pub fn strongest(&self, stretches: usize) -> Met<'a> {
        let ends = |k: usize| k * self.places.len() / stretches;
        let strongest = (0..stretches).filter_map(|k| {
            let each = self.places[ends(k)..ends(k + 1)].iter().copied();
            each.max_by(|a, b| a.weight().total_cmp(&b.weight()))
        });
        Met {
            study: self.study,
            places: strongest.collect(),
        }
    }

    pub fn known(&self, led: &Followed) -> Result<Vec<PathPlace>, SimError> {
        let places = self.places.par_iter().map(|place| {
            let here = CutPlace {
                posture: led.posture_at(place.along_m).to_vec(),
                ..(*place).clone()
            };
            let limit_m = self.study.limit_m(&here, here.spindle_rad_s)?;
            Ok(known(&here, limit_m))
        });
        places.collect()
    }

    /// Largest static compliance times the force of the thickest chip over the depth, m.
    fn bend_by_cut_m(&self, led: &Followed) -> Result<f64, SimError> {
        let each = self.places.par_iter().map(|place| {
            let posture = led.posture_at(place.along_m);
            let attached = self.study.spec.attached.at(place.spindle_rad_s);
            let axes = Matrix3::identity();
            let modes = modes_in_cut(self.study.robot, posture, &axes, &attached);
            let modes = modes.map_err(in_scenario)?;
            let of_mode = |mode: &TipMode| {
                let shape = mode.shape_per_sqrt_kg;
                shape * shape.transpose() / mode.natural_frequency_rad_s.powi(2)
            };
            let compliance: Matrix3<f64> = modes.iter().map(of_mode).sum();
            let chip_m2 = place.depth_m * place.feed_per_tooth_m;
            let pressure = &self.study.spec.coefficients;
            let force_n = chip_m2
                * Vector3::new(
                    pressure.tangential_pa,
                    pressure.radial_pa,
                    pressure.axial_pa,
                )
                .norm();
            Ok(compliance.symmetric_eigenvalues().max() * force_n)
        });
        let each: Vec<f64> = each.collect::<Result<_, SimError>>()?;
        Ok(each.into_iter().fold(0.0, f64::max))
    }

    /// Largest displacement of the tool by the acceleration of the links along the path, m: what
    /// transmissions give way by under `M(q) q̈` of the commanded motion.
    fn bend_by_motion_m(&self, led: &Followed) -> f64 {
        let ends = [self.places.first(), self.places.last()];
        let [Some(first), Some(last)] = ends else {
            return 0.0;
        };
        let (postures, interval_s) = led.between([first.along_m, last.along_m]);
        let robot = self.study.robot;
        let give: Vec<f64> = (robot.chain.joints.iter())
            .map(|joint| joint.transmission.stiffness.map_or(0.0, f64::recip))
            .collect();
        let mut largest_m = 0.0_f64;
        for three in postures.windows(3) {
            let [before, here, after] = three else {
                continue;
            };
            let acceleration = (0..here.len())
                .map(|j| (before[j] - 2.0 * here[j] + after[j]) / interval_s.powi(2));
            let acceleration = DVector::from_iterator(here.len(), acceleration);
            let torque = robot.mass_matrix(here) * acceleration;
            let turned = torque.component_mul(&DVector::from_column_slice(&give));
            let moved = robot.jacobian(here, FrameId::Tool).fixed_rows::<3>(0) * turned;
            largest_m = largest_m.max(moved.norm());
        }
        largest_m
    }

    /// Of the turns that are best at a few places the one that is best at all of them, and whether
    /// the scenario's own is as good.
    pub fn choice(
        &self,
        search: &Search<'_>,
        turns: &[PathPosture],
        own: Option<&Followed>,
    ) -> Result<Choice, SimError> {
        let mut order: Vec<usize> = (0..turns.len()).collect();
        let worth = |k: &usize| turns[*k].least().1.min(PLENTY);
        order.sort_by(|a, b| {
            let bends = |k: usize| turns[k].bend_m.iter().sum::<f64>();
            (worth(b).total_cmp(&worth(a))).then(bends(*a).total_cmp(&bends(*b)))
        });
        let mut best: Option<(usize, Followed, PathPosture)> = None;
        for &k in order.iter().take(LOOKED_AT) {
            let led = search.followed(&turns[k].keys(self.study.robot))?;
            let found = self.best(turns[k].spin_rad, std::slice::from_ref(&led))?;
            let Some(found) = found else { continue };
            if (best.as_ref()).is_none_or(|(_, _, best)| found.is_better_than(best)) {
                best = Some((k, led, found));
            }
        }
        let (best, led, found) = best.ok_or_else(nothing_there)?;
        let own = match own {
            Some(own) => self.best(None, std::slice::from_ref(own))?,
            None => None,
        };
        let is_own = own.is_some_and(|own| !found.is_better_than(&own));
        Ok(Choice { best, led, is_own })
    }

    /// The best of several ways.
    pub fn best(
        &self,
        spin_rad: Option<f64>,
        ways: &[Followed],
    ) -> Result<Option<PathPosture>, SimError> {
        let mut best: Option<PathPosture> = None;
        for led in ways {
            let found = PathPosture {
                spin_rad,
                start: led.start().to_vec(),
                duration_s: led.duration_s(),
                margins: self.known(led)?.iter().map(PathPlace::margin).collect(),
                bend_m: [self.bend_by_cut_m(led)?, self.bend_by_motion_m(led)],
            };
            if best.as_ref().is_none_or(|best| found.is_better_than(best)) {
                best = Some(found);
            }
        }
        Ok(best)
    }
}
