//! An arm whose slides stand still: a linear track is driven to a place, and the arm works there.

use nalgebra::{Isometry3, Translation3};

use crate::error::{ArmError, ArmErrorKind};
use crate::mass_sum::MassSum;
use crate::meshes::LinkMesh;
use crate::model::{JointKind, Link, Robot, Visual};
use crate::moving::motion;

/// What stands still does not move with a joint that others take along.
const NO_FOLLOWERS: &str = "slides of such an arm cannot be held";

impl Robot {
    /// Which joints are slides.
    pub fn slides(&self) -> impl Iterator<Item = usize> {
        let joints = self.chain.joints.iter().enumerate();
        joints.filter_map(|(at, joint)| (joint.kind == JointKind::Prismatic).then_some(at))
    }

    /// The arm with its slides held at places, m, in chain order: links that they move are one with
    /// the links before, and they are no joints any more.
    ///
    /// # Errors
    /// Another number of places than slides, a place outside the limits, an arm of slides alone, or
    /// one with joints that others take along.
    pub fn with_slides_at(&self, at_m: &[f64]) -> Result<Robot, ArmError> {
        self.refuse_followers(NO_FOLLOWERS)?;
        let slides: Vec<usize> = self.slides().collect();
        if slides.len() != at_m.len() {
            let (found, expected) = (at_m.len(), slides.len());
            return Err(ArmErrorKind::PostureLength { found, expected }.into());
        }
        if slides.len() == self.dof() {
            return Err(ArmErrorKind::Argument {
                quantity: "the number of rotary joints",
                value: 0.0,
                rule: "at least 1, for an arm whose slides are held",
            }
            .into());
        }
        let mut robot = self.clone();
        // From the tip on, so that the numbers of those before stay.
        for (&index, &place_m) in slides.iter().zip(at_m).rev() {
            robot.hold(index, place_m)?;
        }
        Ok(robot)
    }

    fn hold(&mut self, index: usize, place_m: f64) -> Result<(), ArmError> {
        let chain = &mut self.chain;
        let joint = chain.joints.remove(index);
        let link = chain.links.remove(index);
        if let Some(limits) = joint.limits
            && !(limits.lower..=limits.upper).contains(&place_m)
        {
            return Err(ArmErrorKind::OutsideLimits {
                joint: joint.name,
                value: place_m,
                lower: limits.lower,
                upper: limits.upper,
                unit: joint.kind.coordinate_unit(),
            }
            .into());
        }
        let before_from_link = joint.parent_from_joint * motion(joint.kind, &joint.axis, place_m);
        match chain.joints.get_mut(index) {
            Some(next) => next.parent_from_joint = before_from_link * next.parent_from_joint,
            None => {
                let flange = self.frames.last_link_from_flange;
                self.frames.last_link_from_flange = before_from_link * flange;
            }
        }
        let before = match index.checked_sub(1) {
            Some(before) => &mut chain.links[before],
            None => &mut chain.base,
        };
        before.take(link, &before_from_link);
        chain.notes.push(format!(
            "slide \"{}\" stands still at {:.1} mm",
            joint.name,
            place_m * 1e3
        ));
        Ok(())
    }
}

impl Link {
    /// Makes another link part of this one.
    fn take(&mut self, other: Link, own_from_other: &Isometry3<f64>) {
        let mut masses = MassSum::default();
        let own_centre = Isometry3::from(Translation3::from(self.com_m));
        let other_centre = own_from_other * Isometry3::from(Translation3::from(other.com_m));
        masses.add(self.mass_kg, &own_centre, &self.inertia_about_com_kg_m2);
        masses.add(other.mass_kg, &other_centre, &other.inertia_about_com_kg_m2);
        self.mass_kg = masses.mass_kg;
        (self.com_m, self.inertia_about_com_kg_m2) = masses.about_centre();
        let visuals = other.visuals.into_iter().map(|visual| Visual {
            link_from_visual: own_from_other * visual.link_from_visual,
            ..visual
        });
        self.visuals.extend(visuals);
        let meshes = other.meshes.into_iter().map(|mesh| LinkMesh {
            link_from_mesh: own_from_other * mesh.link_from_mesh,
            ..mesh
        });
        self.meshes.extend(meshes);
        self.solids.take(other.solids, own_from_other);
    }
}
