//! What looks like a placeholder rather than a value: files are published so, and a run with them
//! gives numbers like any other.

use crate::model::{Chain, Link};

/// Fewest joints of what is an arm; a rig of one or two may have any masses.
const FEWEST_JOINTS: usize = 4;
/// Moving mass over the square of the reach, kg/m², of machines that there are: 15 of light
/// collaborating arms, 450 of the heaviest.
const LEAST_KG_PER_M2: f64 = 5.0;
const MOST_KG_PER_M2: f64 = 1000.0;

/// What speaks against the values of an arm.
pub(crate) struct Doubts {
    pub(crate) notes: Vec<String>,
    /// Why masses and inertias are not the arm's own: two signs of three, since one alone may be
    /// chance, or a machine like no other.
    pub(crate) placeholders: Option<String>,
}

/// Looks at masses, inertias and damping for values that no machine has.
pub(crate) fn of(chain: &Chain) -> Doubts {
    let mut signs = Vec::new();
    let has_masses = chain.moving().all(|body| body.link.mass_kg > 0.0);
    if chain.joints.len() >= FEWEST_JOINTS && has_masses {
        if all_alike(&chain.links, |link| link.mass_kg) {
            let (count, mass_kg) = (chain.links.len(), chain.links[0].mass_kg);
            signs.push(format!(
                "all {count} moving links have the same mass, {mass_kg} kg"
            ));
        }
        let trace = |link: &Link| link.inertia_about_com_kg_m2.trace();
        if all_alike(&chain.links, trace) {
            signs.push("all moving links have the same inertia".to_owned());
        }
        signs.extend(of_total(chain));
    }
    let note = |sign: &String| format!("{sign}: a placeholder, it seems");
    let mut notes: Vec<String> = signs.iter().map(note).collect();
    let transmissions = chain.joints.iter().map(|joint| &joint.transmission);
    let mut elastic = transmissions.filter(|t| t.stiffness.is_some()).peekable();
    if elastic.peek().is_some() && elastic.all(|t| t.damping == 0.0) {
        notes.push("no joint has damping: vibration never dies away".to_owned());
    }
    Doubts {
        notes,
        placeholders: (signs.len() >= 2).then(|| signs.join("; ")),
    }
}

fn all_alike(links: &[Link], of: impl Fn(&Link) -> f64) -> bool {
    let first = of(&links[0]);
    links
        .iter()
        .all(|link| (of(link) - first).abs() <= 1e-6 * first.abs())
}

fn of_total(chain: &Chain) -> Option<String> {
    let mass_kg: f64 = chain.moving().map(|body| body.link.mass_kg).sum();
    let offsets = chain.moving().skip(1);
    let reach_m: f64 = offsets
        .map(|joint| joint.parent_from_joint.translation.vector.norm())
        .sum();
    let density = mass_kg / reach_m.powi(2);
    let what = if density < LEAST_KG_PER_M2 {
        "less"
    } else if density > MOST_KG_PER_M2 {
        "more"
    } else {
        return None;
    };
    Some(format!(
        "{mass_kg:.3} kg move over a reach of {reach_m:.2} m, {what} than in any machine known (or \
         it is in another unit)"
    ))
}
