//! Masses, centres and inertias held against what a body of the arm can have: files come with
//! inertias in kg mm² and centres in mm, and a run with them gives numbers like any other.
//!
//! The mass of a body of the arm lies within the arm, so neither its centre nor its radius of
//! gyration is farther than the arm is long: what is, is refused. And of all bodies with a mass and
//! no more than a density the ball has the least inertia: what has less is a placeholder.

use nalgebra::{Isometry3, Vector3};

use crate::doubts::{FEWEST_JOINTS, MOST_REACH_M};
use crate::drawing::placed;
use crate::error::{ArmError, ArmErrorKind};
use crate::estimate::short;
use crate::estimated::is_estimate;
use crate::model::{Link, Shape, Solids};
use crate::tree::{Freedom, Tree, TreeLink};

/// Densest element: osmium at room temperature, kg/m³ (CRC Handbook of Chemistry and Physics).
const DENSEST_KG_PER_M3: f64 = 22_590.0;
/// Steel, kg/m³: a link has hollows and light alloys in it. Of 1038 links of the robots of
/// `example-robot-data` with a part in the mass none is as compact as a ball of it but for those
/// whose inertia is a placeholder; the nearest come to 6700.
const STEEL_KG_PER_M3: f64 = 7850.0;
/// Units of inertia in which programs of design write, in kg m².
const INERTIA_UNITS: [(&str, f64); 7] = [
    ("kg mm^2", 1e-6),
    ("kg cm^2", 1e-4),
    ("g mm^2", 1e-9),
    ("g cm^2", 1e-7),
    ("lb in^2", 2.926_397e-4),
    ("lb ft^2", 0.042_140_11),
    ("t m^2", 1e3),
];
/// Units of length in which centres are written, in m.
const LENGTH_UNITS: [(&str, f64); 3] = [("mm", 1e-3), ("cm", 1e-2), ("inches", 0.0254)];

/// What bodies of a chain are held against.
pub(crate) struct Yardstick {
    length_m: f64,
    /// Whether it is an arm; a rig of fewer joints may be of any build.
    is_arm: bool,
}

/// A body by what is judged of it.
struct Body<'a> {
    name: &'a str,
    mass_kg: f64,
    center_m: f64,
    /// Half of the inertia's trace is `∫ r² dm` about the centre, kg m².
    second_moment_kg_m2: f64,
    /// Whether its mass is an estimate, spread by volume: a rare data sheet makes small links
    /// dense.
    is_estimate: bool,
}

/// What is wrong with a body: the element of the URDF, and the sentence.
type Found = (&'static str, String);

impl Yardstick {
    /// That of a tree; `moving` is how many joints the chain has.
    pub(crate) fn of(tree: &Tree, moving: usize) -> Yardstick {
        let is_arm = moving >= FEWEST_JOINTS;
        let length_m = length_m(tree, reach_of_shapes);
        Yardstick {
            length_m: if is_arm {
                length_m
            } else {
                length_m.max(MOST_REACH_M)
            },
            is_arm,
        }
    }

    /// Judges a body that moves as one, made of the links `parts`: a doubt, if any.
    ///
    /// # Errors
    /// Inertia or centre that no body has, at the link that brings it.
    pub(crate) fn judge(
        &mut self,
        tree: &Tree,
        link: &Link,
        parts: &[usize],
    ) -> Result<Option<String>, ArmError> {
        let whole = Body {
            name: &link.name,
            mass_kg: link.mass_kg,
            center_m: link.com_m.norm(),
            second_moment_kg_m2: 0.5 * link.inertia_about_com_kg_m2.trace(),
            is_estimate: parts.iter().all(|index| is_estimated(&tree.links[*index])),
        };
        if whole.impossible(self.length_m).is_some() {
            // Meshes are files of their own, and read only for this.
            let with_meshes = length_m(tree, |solids| {
                reach_of_shapes(solids).max(reach_of_meshes(solids))
            });
            self.length_m = self.length_m.max(with_meshes);
        }
        // What follows nothing may be as long as all before it: its file does not say.
        let is_end = parts.iter().all(|index| {
            let mut following = tree.links[*index].child_joints.iter();
            following.all(|joint| parts.contains(&tree.joints[*joint].child))
        });
        let has_frame = parts.len() > 1;
        let length_m = if is_end && !has_frame { 2.0 } else { 1.0 } * self.length_m;
        if let Some(found) = whole.impossible(length_m) {
            return Err(self.error(tree, parts, length_m, found));
        }
        let is_judged = self.is_arm && link.mass_kg > 0.0;
        Ok(is_judged.then(|| whole.doubtful(length_m)).flatten())
    }

    /// The error at the part that is wrong by itself, else at the heaviest.
    fn error(&self, tree: &Tree, parts: &[usize], length_m: f64, found: Found) -> ArmError {
        let wrong = parts.iter().find_map(|index| {
            let link = &tree.links[*index];
            let body = Body {
                name: &link.name,
                mass_kg: link.mass_kg,
                center_m: link.link_from_inertial.translation.vector.norm(),
                second_moment_kg_m2: 0.5 * link.inertia_kg_m2.trace(),
                is_estimate: is_estimated(link),
            };
            Some((*index, body.impossible(length_m)?))
        });
        let heaviest = || {
            let parts = parts.iter().copied();
            parts.max_by(|a, b| tree.links[*a].mass_kg.total_cmp(&tree.links[*b].mass_kg))
        };
        let (index, (element, said)) =
            wrong.unwrap_or_else(|| (heaviest().unwrap_or(tree.root), found));
        let kind = ArmErrorKind::Implausible(said);
        match &tree.links[index].mass_place {
            Some((path, line)) => ArmError::in_file(path, *line, kind),
            None => tree.link_error(index, element, kind),
        }
    }
}

impl Body<'_> {
    /// Root mean square of the distance of the mass from its centre.
    fn gyration_m(&self) -> f64 {
        (self.second_moment_kg_m2 / self.mass_kg).sqrt()
    }

    /// The least that a body of this mass has, whose parts are no denser: that of a ball,
    /// `sqrt(3/5) (3 m / (4 π ρ))^(1/3)`.
    fn ball_m(&self, density_kg_per_m3: f64) -> f64 {
        let volume_m3 = self.mass_kg / density_kg_per_m3;
        0.6_f64.sqrt() * (0.75 * volume_m3 / std::f64::consts::PI).cbrt()
    }

    /// A mass in a point is what tables of masses have for want of more, and no unit makes one.
    fn has_no_size(&self) -> bool {
        self.second_moment_kg_m2 == 0.0 || self.is_estimate
    }

    fn impossible(&self, length_m: f64) -> Option<Found> {
        if self.mass_kg <= 0.0 {
            return None;
        }
        let gyration_m = self.gyration_m();
        if self.center_m > length_m {
            let said = format!(
                "link \"{}\": the centre of mass is {} m from the link's frame, farther than the whole arm is long \
                 ({} m from its root to its farthest end, travel included): centres are given in m{}",
                self.name,
                short(self.center_m),
                short(length_m),
                self.in_other_lengths(length_m),
            );
            return Some(("origin", said));
        }
        if gyration_m > length_m {
            let said = format!(
                "{}, more than the whole arm is long ({} m from its root to its farthest end, travel included): \
                 inertias are given in kg m^2, about the centre of mass{}",
                self.described(),
                short(length_m),
                self.in_other_units(length_m),
            );
            return Some(("inertia", said));
        }
        None
    }

    /// What no link known has, though a body might.
    fn doubtful(&self, length_m: f64) -> Option<String> {
        let gyration_m = self.gyration_m();
        if 2.0 * gyration_m > length_m {
            return Some(format!(
                "{}: so has a dumb-bell as long as the whole arm ({} m), and no link{}",
                self.described(),
                short(length_m),
                self.in_other_units(length_m),
            ));
        }
        if self.has_no_size() {
            return None;
        }
        // A small number stands for want of a better one in many a URDF: none of these is refused.
        let balls = [
            (DENSEST_KG_PER_M3, "osmium", "; nothing is denser"),
            (STEEL_KG_PER_M3, "steel", ""),
        ];
        balls.iter().find_map(|(density, material, why)| {
            let least_m = self.ball_m(*density);
            (gyration_m < least_m).then(|| {
                format!(
                    "{}, less than a solid ball of {material} of that mass has ({} m{why}){}",
                    self.described(),
                    short(least_m),
                    self.in_other_units(length_m),
                )
            })
        })
    }

    fn described(&self) -> String {
        format!(
            "link \"{}\": the radius of gyration about its centre is {} m (principal moments that sum to {} kg m^2, \
             over twice {} kg)",
            self.name,
            short(self.gyration_m()),
            short(2.0 * self.second_moment_kg_m2),
            short(self.mass_kg),
        )
    }

    /// Units in which the inertia would be one of a link.
    fn in_other_units(&self, length_m: f64) -> String {
        let least_m = self.ball_m(STEEL_KG_PER_M3);
        let read = INERTIA_UNITS.iter().filter_map(|(unit, kg_m2)| {
            let gyration_m = self.gyration_m() * kg_m2.sqrt();
            let fits = (least_m..=0.5 * length_m).contains(&gyration_m);
            fits.then(|| format!("in {unit} it were {} m", short(gyration_m)))
        });
        listed(read.collect())
    }

    fn in_other_lengths(&self, length_m: f64) -> String {
        let read = LENGTH_UNITS.iter().filter_map(|(unit, metres)| {
            let center_m = self.center_m * metres;
            (center_m <= 0.5 * length_m).then(|| format!("in {unit} it were {} m", short(center_m)))
        });
        listed(read.collect())
    }
}

fn is_estimated(link: &TreeLink) -> bool {
    link.mass_kg == 0.0 || link.mass_source.as_deref().is_some_and(is_estimate)
}

fn listed(read: Vec<String>) -> String {
    if read.is_empty() {
        return String::new();
    }
    format!("; {}", read.join(", "))
}

/// From the root to the farthest end of the tree, stretched out, with all travel of slides and what
/// the largest body sticks out. Infinite with a slide of no limits.
fn length_m(tree: &Tree, reach: impl Fn(&Solids) -> f64) -> f64 {
    let offset = |joint: usize| {
        let joint = &tree.joints[joint];
        let travel = match (joint.freedom, joint.limits) {
            (Freedom::Prismatic, Some(limits)) => limits.upper.abs().max(limits.lower.abs()),
            (Freedom::Prismatic, None) => f64::INFINITY,
            _ => 0.0,
        };
        joint.parent_from_joint.translation.vector.norm() + travel
    };
    let depth = |link: usize| {
        let (mut at, mut sum) = (link, 0.0);
        while let Some(joint) = tree.links[at].parent_joint {
            sum += offset(joint);
            at = tree.joints[joint].parent;
        }
        sum
    };
    let deepest = (0..tree.links.len()).map(depth).fold(0.0, f64::max);
    let links = tree.links.iter();
    deepest
        + links
            .map(|link| reach(&link.solids))
            .fold(0.0_f64, f64::max)
}

/// From the frame of a link to what of its shapes is farthest.
fn reach_of_shapes(solids: &Solids) -> f64 {
    let reach = |(shape, pose): &(Shape, Isometry3<f64>)| {
        let own = match shape {
            Shape::Box { half_extents_m } => half_extents_m.norm(),
            Shape::Cylinder { radius_m, length_m } => radius_m.hypot(0.5 * length_m),
            Shape::Capsule { radius_m, length_m } => radius_m + 0.5 * length_m,
            Shape::Sphere { radius_m } => *radius_m,
        };
        pose.translation.vector.norm() + own
    };
    solids.shapes.iter().map(reach).fold(0.0, f64::max)
}

/// Likewise of its meshes; those that cannot be read are left out.
fn reach_of_meshes(solids: &Solids) -> f64 {
    let parts = solids
        .meshes
        .iter()
        .filter_map(|mesh| placed(mesh).ok())
        .flatten();
    let corners = parts.flat_map(|part| part.triangles).flatten();
    corners
        .map(|corner: Vector3<f64>| corner.norm())
        .fold(0.0, f64::max)
}
