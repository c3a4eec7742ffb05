//! Bounds of effects that the machine itself sets.

use truecut_scenario::effect::{EffectKind, ParameterInfo, Target};

use super::{Kind, Trial};
use crate::model::Candidate;

impl Trial {
    /// The parameters of a candidate. From a rotor no more can be missing than the robot's file
    /// gives: what asks for less than none is another cause.
    pub(super) fn bounds(&self, candidate: &Candidate) -> Vec<ParameterInfo> {
        let mut infos = candidate.kind.parameters().to_vec();
        let (EffectKind::JointRotor, Target::Joint(joint)) = (candidate.kind, &candidate.target)
        else {
            return infos;
        };
        let Kind::Inverse { model, .. } = &self.engine else {
            return infos;
        };
        let of_file = model.robot().chain.joints.get(*joint);
        if let (Some(of_file), Some(inertia)) = (of_file, infos.first_mut()) {
            inertia.min = inertia.min.max(-of_file.transmission.rotor_inertia);
        }
        infos
    }
}
