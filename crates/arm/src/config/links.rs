//! The `[[link]]` entries and the `[masses]` table: what the URDF does not say of masses, or says
//! wrongly.

use nalgebra::{Isometry3, Matrix3, Translation3, Vector3};

use super::ConfigFile;
use crate::bounds;
use crate::error::{ArmError, ArmErrorKind};
use crate::tree::Tree;
use crate::urdf::known_names;

/// Part by which the links' masses may miss their stated sum; data sheets round to a kilogram.
const SUM_TOLERANCE: f64 = 5e-3;

impl ConfigFile<'_> {
    /// Enters masses, centres and inertias into `tree`, and checks their sum.
    pub(crate) fn give_masses(&self, tree: &mut Tree) -> Result<(), ArmError> {
        let reader = self.reader();
        let mut seen: Vec<(&str, usize)> = Vec::new();
        for raw in &self.raw.link {
            let (name, at) = (raw.name.get_ref(), raw.name.span().start);
            let line = reader.line(at);
            let error = |kind| ArmError::in_file(self.path, line, kind);
            if let Some((_, first_line)) = seen.iter().find(|(other, _)| other == name) {
                return Err(error(ArmErrorKind::DuplicateName {
                    element: "link",
                    name: name.clone(),
                    first_line: *first_line,
                }));
            }
            seen.push((name, line));
            let names = tree.links.iter().map(|link| link.name.as_str());
            let hint = known_names(names);
            let Some(link) = tree.links.iter_mut().find(|link| link.name == *name) else {
                return Err(error(ArmErrorKind::UnknownConfigLink {
                    link: name.clone(),
                    hint,
                }));
            };
            if raw.source.trim().is_empty() {
                return Err(error(ArmErrorKind::LinkWithoutSource {
                    link: name.clone(),
                }));
            }
            let finite = |value: &f64| value.is_finite();
            let all = raw.center_m.iter().chain(&raw.inertia_kg_m2);
            if !(raw.mass_kg.is_finite() && all.clone().all(finite)) {
                return Err(error(ArmErrorKind::LinkNotFinite { link: name.clone() }));
            }
            let [xx, yy, zz, xy, xz, yz] = raw.inertia_kg_m2;
            link.mass_kg = raw.mass_kg;
            link.link_from_inertial = Isometry3::from_parts(
                Translation3::from(Vector3::from(raw.center_m)),
                nalgebra::UnitQuaternion::identity(),
            );
            link.inertia_kg_m2 = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
            link.mass_source = Some(raw.source.trim().to_owned());
            if let Some((_, kind)) = bounds::link_fault(link).or_else(|| bounds::tensor_fault(link))
            {
                return Err(error(kind));
            }
        }
        self.check_sum(tree)
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
