//! Unknowns as parameters that some motion tells apart, and which of them are asked for.

use nalgebra::DMatrix;
use truecut_sim::SimError;

use super::information::Information;
use super::model::{Jacobian, Model};
use super::unknowns::refused;
use crate::fit::base::{Base, Group};
use crate::fit::sum_of;

/// Parameters, each led by one unknown.
pub(super) struct Parameters {
    /// The unknown that leads each.
    pub leaders: Vec<usize>,
    pub names: Vec<String>,
    pub units: Vec<String>,
    /// Values about which they are looked at, SI.
    pub values: Vec<f64>,
    /// Parameters asked for.
    pub asked: Vec<usize>,
    /// What is known of the others beforehand: one over the square of a deviation, or 0.
    pub precisions: Vec<f64>,
}

/// A fit gives directions no change of which singular values, columns scaled, are below this part
/// of the largest: angles that a URDF rounds to four decimals leave parts of 1e-6 of what no motion
/// shows.
const LEAST_SHOWN: f64 = 1e-4;

impl Parameters {
    /// Of drive forces those that unrelated states tell apart; of runs all.
    ///
    /// # Errors
    /// A parameter asked for that no motion can show, or tell from the others.
    pub fn new(model: &Model) -> Result<Parameters, SimError> {
        let groups = match model.anywhere()? {
            Some(columns) => Base::of(&columns, LEAST_SHOWN).groups,
            None => (0..model.names.len())
                .map(|unknown| Group {
                    members: vec![(unknown, 1.0)],
                })
                .collect(),
        };
        check_shown(model, &groups)?;
        let mut parameters = Parameters {
            leaders: groups.iter().map(|group| group.members[0].0).collect(),
            names: Vec::new(),
            units: Vec::new(),
            values: Vec::new(),
            asked: Vec::new(),
            precisions: Vec::new(),
        };
        for (index, group) in groups.iter().enumerate() {
            let terms = group.members.iter();
            let name =
                sum_of(terms.map(|(unknown, factor)| (*factor, model.names[*unknown].as_str())));
            parameters.names.push(name);
            let leader = group.members[0].0;
            parameters.units.push(model.units[leader].clone());
            let values = group
                .members
                .iter()
                .map(|(unknown, factor)| factor * model.values[*unknown]);
            parameters.values.push(values.sum());
            let is_asked = group
                .members
                .iter()
                .any(|(unknown, _)| is_asked(model, *unknown));
            if is_asked {
                parameters.asked.push(index);
            }
            let extra = leader
                .checked_sub(model.of_fit)
                .map(|own| &model.unknowns.extra[own]);
            let sigma = extra.and_then(|extra| extra.sigma).filter(|_| !is_asked);
            parameters
                .precisions
                .push(sigma.map_or(0.0, |sigma| sigma.powi(-2)));
        }
        if parameters.asked.is_empty() {
            return Err(refused("names nothing that a motion can show".to_owned()));
        }
        Ok(parameters)
    }

    /// Information of a motion, with `noise` of a sample of each channel.
    pub fn information(&self, jacobian: &Jacobian, noise: &[f64]) -> Information {
        let mut information = Information::none(self.leaders.len());
        for (channel, (counts, noise)) in jacobian.counts.iter().zip(noise).enumerate() {
            let rows: Vec<usize> = (0..counts.len()).filter(|row| counts[*row]).collect();
            let deviation = noise * jacobian.noise_share;
            let weighted = DMatrix::from_fn(rows.len(), self.leaders.len(), |row, parameter| {
                jacobian.columns[self.leaders[parameter]][channel][rows[row]] / deviation
            });
            information.add(&weighted);
        }
        information
    }
}

/// Whether an unknown is asked for.
fn is_asked(model: &Model, unknown: usize) -> bool {
    if let Some(extra) = unknown.checked_sub(model.of_fit) {
        return model.unknowns.extra[extra].is_asked;
    }
    match &model.unknowns.asked_of_fit {
        None => true,
        Some(names) => {
            let name = &model.names[unknown];
            names
                .iter()
                .any(|asked| asked == name || is_of_kind(name, asked))
        }
    }
}

/// Whether a parameter of a fit is of a kind: `link 2 m x` of `links`.
fn is_of_kind(name: &str, kind: &str) -> bool {
    let first = name.split(' ').next().unwrap_or_default();
    first == kind || first == kind.trim_end_matches('s')
}

/// Refuses what is asked for and is shown by no motion, or not apart from the others.
fn check_shown(model: &Model, groups: &[Group]) -> Result<(), SimError> {
    for (index, extra) in model.unknowns.extra.iter().enumerate() {
        if !extra.is_asked {
            continue;
        }
        let unknown = model.of_fit + index;
        let mut of = groups
            .iter()
            .filter(|group| group.members.iter().any(|one| one.0 == unknown));
        match of.next() {
            None => {
                return Err(refused(format!(
                    "is \"{}\", which no motion can show: it changes none of the outputs in any state of the arm",
                    extra.name
                )));
            }
            Some(group) if group.members[0].0 != unknown => {
                return Err(refused(format!(
                    "is \"{}\", which no motion can tell from {}: they change the outputs alike in every state of the arm",
                    extra.name, model.names[group.members[0].0]
                )));
            }
            Some(_) => {}
        }
    }
    for asked in model.unknowns.asked_of_fit.iter().flatten() {
        let own = |unknown: usize| {
            let name = &model.names[unknown];
            unknown < model.of_fit && (name == asked || is_of_kind(name, asked))
        };
        if !(0..model.of_fit).any(own) {
            return Err(refused(format!(
                "is \"{asked}\", which is no parameter of [fit]"
            )));
        }
        let shown = groups
            .iter()
            .any(|group| group.members.iter().any(|one| own(one.0)));
        if !shown {
            return Err(refused(format!(
                "is \"{asked}\", which no motion can show: it changes none of the outputs in any state of the arm"
            )));
        }
    }
    Ok(())
}
