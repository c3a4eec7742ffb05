//! The `[[link]]` entries and the `[masses]` table: what the URDF does not say of masses, or says
//! wrongly.

use nalgebra::{Isometry3, Matrix3, Translation3, Vector3};

use super::ConfigFile;
use super::raw::RawLink;
use crate::bounds;
use crate::error::{ArmError, ArmErrorKind};
use crate::tree::Tree;
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
                None => entered(raw, tree),
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
fn entered(raw: &RawLink, tree: &mut Tree) -> Result<(), ArmErrorKind> {
    let name = raw.name.get_ref();
    let names = tree.links.iter().map(|link| link.name.as_str());
    let hint = known_names(names);
    let Some(link) = tree.links.iter_mut().find(|link| link.name == *name) else {
        return Err(ArmErrorKind::UnknownConfigLink {
            link: name.clone(),
            hint,
        });
    };
    if raw.source.trim().is_empty() {
        return Err(ArmErrorKind::LinkWithoutSource { link: name.clone() });
    }
    let mut numbers = raw.center_m.iter().chain(&raw.inertia_kg_m2);
    if !(raw.mass_kg.is_finite() && numbers.all(|value| value.is_finite())) {
        return Err(ArmErrorKind::LinkNotFinite { link: name.clone() });
    }
    let [xx, yy, zz, xy, xz, yz] = raw.inertia_kg_m2;
    let mut given = link.clone();
    given.mass_kg = raw.mass_kg;
    given.link_from_inertial = Isometry3::from_parts(
        Translation3::from(Vector3::from(raw.center_m)),
        nalgebra::UnitQuaternion::identity(),
    );
    given.inertia_kg_m2 = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    given.mass_source = Some(raw.source.trim().to_owned());
    let fault = bounds::link_fault(&given).or_else(|| bounds::tensor_fault(&given));
    if let Some((_, kind)) = fault {
        return Err(kind);
    }
    *link = given;
    Ok(())
}
