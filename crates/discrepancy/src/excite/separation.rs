//! How far the explanations of a diagnosis would be told apart.

use nalgebra::DVector;

use super::information::Information;
use super::model::Model;
use super::parameters::Parameters;
use super::report::Separation;
use super::unknowns::{What, effect_of, name_of};
use crate::diagnose::{Cause, Diagnosis};

/// Of the causes named and the first alternative; `None` without one.
pub(super) fn separation(
    diagnosis: &Diagnosis,
    model: &Model,
    parameters: &Parameters,
    planned: &Information,
    present: Option<&Information>,
) -> Option<Separation> {
    let alternative = diagnosis.alternatives.first()?;
    let names = |causes: &[Cause]| -> Vec<String> {
        causes
            .iter()
            .filter_map(effect_of)
            .map(|effect| name_of(&effect))
            .collect()
    };
    let (causes, rivals) = (names(&diagnosis.causes), names(&alternative.causes));
    let mut change = DVector::zeros(parameters.leaders.len());
    let mut others = Vec::new();
    for (index, leader) in parameters.leaders.iter().enumerate() {
        let extra = &model.unknowns.extra[leader.checked_sub(model.of_fit)?];
        let What::Effect { effect, parameter } = extra.what else {
            others.push(index);
            continue;
        };
        let effect = &model.unknowns.effects[effect];
        let name = name_of(effect);
        if rivals.contains(&name) {
            others.push(index);
        } else if causes.contains(&name) {
            let info = &effect.kind.parameters()[parameter];
            if info.is_size {
                change[index] = extra.value - info.neutral;
            }
        }
    }
    let told = |information: &Information| {
        let known = information.clone().with_prior(&parameters.precisions);
        let squared = known.separation(&change, &others);
        [squared.sqrt(), 0.5 * squared / std::f64::consts::LN_10]
    };
    let [distance, log10_odds] = told(planned);
    Some(Separation {
        causes,
        alternative: rivals,
        planned: distance,
        log10_odds,
        present: present.map(told),
    })
}
