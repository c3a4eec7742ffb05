//! Where bodies stand: modellers write a part as an assembly of one, placed in it.

use std::collections::{HashMap, HashSet};

use nalgebra::Vector3;

use super::entities::{Frame, Model, get, list, reference};
use super::part21::Fault;

/// Assemblies within each other that are followed.
const DEEPEST: usize = 32;

/// From one frame to another.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    from: Frame,
    to: Frame,
}

/// A chain of places.
pub(super) struct Chain(Vec<Place>);

impl Chain {
    pub(super) fn at(&self, p: &Vector3<f64>) -> Vector3<f64> {
        self.0.iter().fold(*p, |p, place| {
            let local = place.from.local(&p);
            place.to.at(local.x, local.y, local.z)
        })
    }
}

/// Representations, what they hold, and how they stand in each other.
pub(super) struct Places {
    /// The representation of each body.
    of: HashMap<u64, u64>,
    /// Those that a representation is placed in.
    within: HashMap<u64, Vec<(u64, Place)>>,
    /// Those that are the same, in the same place.
    same: HashMap<u64, Vec<u64>>,
}

impl Places {
    pub(super) fn new(model: &Model<'_>) -> Result<Self, Fault> {
        let mut places = Self {
            of: HashMap::new(),
            within: HashMap::new(),
            same: HashMap::new(),
        };
        for number in &model.file.numbers {
            match model.file.name(*number) {
                Some(name) if name.ends_with("SHAPE_REPRESENTATION") => {
                    let entity = model.file.entity(*number)?;
                    // CONTEXT_DEPENDENT_SHAPE_REPRESENTATION has no items.
                    let Some((_, values)) = entity.parts.first().filter(|(_, v)| v.len() > 2)
                    else {
                        continue;
                    };
                    for item in list(&entity, get(&entity, values, 1)?)? {
                        places.of.insert(reference(&entity, item)?, *number);
                    }
                }
                Some("SHAPE_REPRESENTATION_RELATIONSHIP") | None => {
                    places.relate(model, *number)?;
                }
                Some(_) => {}
            }
        }
        Ok(places)
    }

    fn relate(&mut self, model: &Model<'_>, number: u64) -> Result<(), Fault> {
        let entity = model.file.entity(number)?;
        let plain = entity.part("SHAPE_REPRESENTATION_RELATIONSHIP");
        let plain = plain.filter(|values| values.len() >= 4);
        let Some(values) = plain.or_else(|| entity.part("REPRESENTATION_RELATIONSHIP")) else {
            return Ok(());
        };
        let one = reference(&entity, get(&entity, values, 2)?)?;
        let other = reference(&entity, get(&entity, values, 3)?)?;
        let Some(by) = entity.part("REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION") else {
            self.same.entry(one).or_default().push(other);
            self.same.entry(other).or_default().push(one);
            return Ok(());
        };
        let by = model.follow(&entity, get(&entity, by, 0)?)?;
        let values = model.simple(&by, "ITEM_DEFINED_TRANSFORMATION")?;
        let place = Place {
            from: model.frame(reference(&by, get(&by, values, 2)?)?)?,
            to: model.frame(reference(&by, get(&by, values, 3)?)?)?,
        };
        self.within.entry(one).or_default().push((other, place));
        Ok(())
    }

    /// Where a body stands in the outermost assembly.
    pub(super) fn of(&self, model: &Model<'_>, body: u64) -> Result<Chain, Fault> {
        let mut chain = Vec::new();
        let Some(mut at) = self.of.get(&body).copied() else {
            return Ok(Chain(chain));
        };
        for _ in 0..DEEPEST {
            // All that are the same as this one.
            let (mut alike, mut seen) = (vec![at], HashSet::from([at]));
            let mut k = 0;
            while k < alike.len() {
                let others = self.same.get(&alike[k]).into_iter().flatten().copied();
                let new: Vec<u64> = others.filter(|other| seen.insert(*other)).collect();
                alike.extend(new);
                k += 1;
            }
            let mut places = alike
                .iter()
                .flat_map(|r| self.within.get(r).into_iter().flatten());
            let Some((next, place)) = places.next() else {
                return Ok(Chain(chain));
            };
            if places.next().is_some() {
                let entity = model.file.entity(body)?;
                return Err(entity.fault(
                    "the body stands at several places of an assembly; export one part alone",
                ));
            }
            chain.push(*place);
            at = *next;
        }
        Err(Fault::new(format!(
            "assemblies stand within each other more than {DEEPEST} deep"
        )))
    }
}
