//! The `[[link]]` entries and the `[masses]` table: what the URDF does not say of masses, or says
//! wrongly.

use nalgebra::{Isometry3, Matrix3, Translation3, Vector3};

use super::ConfigFile;
use super::raw::{RawLink, RawPayload};
use crate::bounds;
use crate::error::{ArmError, ArmErrorKind};
use crate::mass_sum::MassSum;
use crate::tree::{Tree, TreeLink};
use crate::urdf::known_names;

/// Part by which the links' masses may miss their stated sum; data sheets round to a kilogram.
const SUM_TOLERANCE: f64 = 5e-3;

impl ConfigFile<'_> {
    /// Enters masses, centres and inertias into `tree`, and checks their sum; adds what is wrong to
    /// `faults`.
    pub(crate) fn give_masses(&self, tree: &mut Tree, faults: &mut Vec<ArmError>) {
        let reader = self.reader();
        let before = faults.len();
        let mut seen: Vec<(&str, usize)> = Vec::new();
        for raw in &self.raw.link {
            let line = reader.line(raw.name.span().start);
            let name = raw.name.get_ref().as_str();
            let first = seen.iter().find(|(other, _)| *other == name);
            let entered = match first {
                Some((_, first_line)) => Err(ArmErrorKind::DuplicateName {
                    element: "link",
                    name: name.to_owned(),
                    first_line: *first_line,
                }),
                None => entered(raw, tree).map(|link| {
                    link.mass_place = Some((self.path.to_owned(), line.into()));
                }),
            };
            seen.push((name, line));
            if let Err(kind) = entered {
                faults.push(ArmError::in_file(self.path, line, kind));
            }
        }
        // With a wrong entry the sum is wrong, too.
        if faults.len() == before {
            faults.extend(self.check_sum(tree).err());
        }
        // The sum is that of the arm as it is sold.
        for raw in &self.raw.payload {
            if let Err(kind) = loaded(raw, tree) {
                let line = reader.line(raw.link.span().start);
                faults.push(ArmError::in_file(self.path, line, kind));
            }
        }
    }

    fn check_sum(&self, tree: &Tree) -> Result<(), ArmError> {
        let Some(masses) = &self.raw.masses else {
            return Ok(());
        };
        let total_kg = *masses.total_kg.get_ref();
        let sum_kg: f64 = tree.links.iter().map(|link| link.mass_kg).sum();
        if (sum_kg - total_kg).abs() <= SUM_TOLERANCE * total_kg {
            return Ok(());
        }
        let kind = ArmErrorKind::MassesDoNotSum { sum_kg, total_kg };
        let line = self.reader().line(masses.total_kg.span().start);
        Err(ArmError::in_file(self.path, line, kind))
    }
}

/// Enters the mass of one link; leaves the link as it is where that is wrong.
fn entered<'a>(raw: &RawLink, tree: &'a mut Tree) -> Result<&'a mut TreeLink, ArmErrorKind> {
    let at = numbered(raw.name.get_ref(), tree)?;
    let link = &mut tree.links[at];
    let given = given(
        link,
        raw.mass_kg,
        raw.center_m,
        raw.inertia_kg_m2,
        &raw.source,
    )?;
    *link = given;
    Ok(link)
}

/// A link with other mass, centre and inertia.
fn given(
    link: &TreeLink,
    mass_kg: f64,
    center_m: [f64; 3],
    inertia_kg_m2: [f64; 6],
    source: &str,
) -> Result<TreeLink, ArmErrorKind> {
    if source.trim().is_empty() {
        return Err(ArmErrorKind::LinkWithoutSource {
            link: link.name.clone(),
        });
    }
    let mut numbers = center_m.iter().chain(&inertia_kg_m2);
    if !(mass_kg.is_finite() && numbers.all(|value| value.is_finite())) {
        return Err(ArmErrorKind::LinkNotFinite {
            link: link.name.clone(),
        });
    }
    let [xx, yy, zz, xy, xz, yz] = inertia_kg_m2;
    let mut given = link.clone();
    given.mass_kg = mass_kg;
    given.link_from_inertial = Isometry3::from(Translation3::from(Vector3::from(center_m)));
    given.inertia_kg_m2 = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    given.mass_source = Some(source.trim().to_owned());
    let fault = bounds::link_fault(&given).or_else(|| bounds::tensor_fault(&given));
    match fault {
        Some((_, kind)) => Err(kind),
        None => Ok(given),
    }
}

/// Adds what a link carries to its own mass; leaves the link as it is where that is wrong.
fn loaded(raw: &RawPayload, tree: &mut Tree) -> Result<(), ArmErrorKind> {
    let name = raw.link.get_ref();
    let at = numbered(name, tree)?;
    let link = &tree.links[at];
    let load = given(
        link,
        raw.mass_kg,
        raw.center_m,
        raw.inertia_kg_m2,
        &raw.source,
    )?;
    if load.mass_kg == 0.0 {
        return Err(ArmErrorKind::Argument {
            quantity: "mass_kg of a payload",
            value: 0.0,
            rule: "above 0",
        });
    }
    let is_moved = link.parent_joint.is_some_and(|j| tree.joints[j].moves());
    if link.mass_kg == 0.0 && is_moved {
        // Else the load would pass for the link, of which nobody said what it weighs.
        return Err(ArmErrorKind::LoadWithoutLink { link: name.clone() });
    }
    let mut masses = MassSum::default();
    for part in [&load, link] {
        masses.add(part.mass_kg, &part.link_from_inertial, &part.inertia_kg_m2);
    }
    let (center_m, inertia_kg_m2) = masses.about_centre();
    let whole = &mut tree.links[at];
    whole.mass_kg = masses.mass_kg;
    whole.link_from_inertial = Isometry3::from(Translation3::from(center_m));
    whole.inertia_kg_m2 = inertia_kg_m2;
    tree.notes.push(format!(
        "link \"{name}\" carries {} kg more than its own mass: {}",
        raw.mass_kg,
        raw.source.trim()
    ));
    Ok(())
}

fn numbered(name: &str, tree: &Tree) -> Result<usize, ArmErrorKind> {
    let found = tree.links.iter().position(|link| link.name == name);
    found.ok_or_else(|| ArmErrorKind::UnknownConfigLink {
        link: name.to_owned(),
        hint: known_names(tree.links.iter().map(|link| link.name.as_str())),
    })
}
