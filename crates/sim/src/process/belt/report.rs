//! What a belt run ends with: force, removal and its evenness, roughness; and how the face is
//! drawn.

use super::BeltSetup;
use super::contact::BeltContact;
use super::surface::{Cells, Worn, middles};
use crate::process::Findings;
use crate::process::pressing::Pressing;
use crate::process::quantity::{self, Quantity};
use nalgebra::{Isometry3, Matrix3, Rotation3, UnitQuaternion, Vector3};
use truecut_core::wheel::force_control::ForceControl;
use truecut_plan::surface::PatchFile;
use truecut_recording::{Field, Outcome, Profile, Unit};

/// Depth at which the colours end, over the mean that is expected.
pub(super) const FULL_SCALE: f64 = 2.0;
/// Height over the face at which the depth is drawn, so that its outline does not shine through, m.
const DRAWN_ABOVE_M: f64 = 1e-4;

/// What is summed up while the run goes on.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Watch {
    /// `∫ p |v| dA dt`, J.
    preston_j: f64,
    pressing: Pressing,
    indentation_m: f64,
}

impl Watch {
    pub fn step(&mut self, contact: &BeltContact, at_stop: bool, dt_s: f64) {
        self.preston_j += contact.sliding_w * dt_s;
        self.pressing.step(contact.normal_n, at_stop, dt_s);
        let depths = contact.strips.iter().map(|strip| strip.indentation_m);
        self.indentation_m = depths.fold(self.indentation_m, f64::max);
    }

    /// Volume that Preston's law takes off by what was given so far, m³.
    pub fn preston_m3(&self, setup: &BeltSetup) -> f64 {
        setup.abrasive.preston_per_pa * self.preston_j
    }
}

/// Sums over cells of all copies, by their areas.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::process) struct Sums {
    pub area: f64,
    depth: f64,
    square: f64,
    pub roughness: f64,
    least: Option<f64>,
    pub largest: f64,
    pub roughest: f64,
    /// Area of cells from which nothing is taken.
    pub untouched: f64,
}

impl Sums {
    pub fn add(&mut self, area: f64, depth: f64, roughness: f64) {
        self.area += area;
        self.depth += area * depth;
        self.square += area * depth * depth;
        self.roughness += area * roughness;
        self.least = Some(self.least.map_or(depth, |least| least.min(depth)));
        self.largest = self.largest.max(depth);
        self.roughest = self.roughest.max(roughness);
        self.untouched += if depth > 0.0 { 0.0 } else { area };
    }

    pub fn mean_m(&self) -> f64 {
        self.depth / self.area
    }

    /// Standard deviation of the depth over its mean.
    pub fn unevenness(&self) -> f64 {
        let mean = self.mean_m();
        (self.square / self.area - mean * mean).max(0.0).sqrt() / mean
    }
}

/// Sums over the face, and over what the lines sweep, of one copy.
fn sums(setup: &BeltSetup, worn: &Worn) -> (Sums, Sums) {
    let (mut face, mut swept) = (Sums::default(), Sums::default());
    let cells = worn.grid.removed_m().iter().zip(worn.grid.dose_j_per_m2());
    for (cell, (depth, dose)) in cells.enumerate() {
        if !setup.is_face[cell] {
            continue;
        }
        let (area, roughness) = (setup.area_m2[cell], setup.abrasive.polishing.ra_m(*dose));
        face.add(area, *depth, roughness);
        let middle = setup.cells.middle(cell);
        let within = |i: usize| (setup.swept[i][0]..=setup.swept[i][1]).contains(&middle[i]);
        if within(0) && within(1) {
            swept.add(area, *depth, roughness);
        }
    }
    (face, swept)
}

fn joined(all: impl Iterator<Item = Sums>) -> Sums {
    all.fold(Sums::default(), |a, b| Sums {
        area: a.area + b.area,
        depth: a.depth + b.depth,
        square: a.square + b.square,
        roughness: a.roughness + b.roughness,
        least: match (a.least, b.least) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        },
        largest: a.largest.max(b.largest),
        roughest: a.roughest.max(b.roughest),
        untouched: a.untouched + b.untouched,
    })
}

pub(super) fn findings(setup: &BeltSetup, worn: &[Worn], watch: &Watch) -> Findings {
    let each: Vec<(Sums, Sums)> = worn.iter().map(|one| sums(setup, one)).collect();
    let face = joined(each.iter().map(|one| one.0));
    let swept = joined(each.iter().map(|one| one.1));
    let means = each.iter().map(|one| one.0.mean_m());
    let (least, most) = means.fold((f64::INFINITY, 0.0_f64), |(l, m), x| (l.min(x), m.max(x)));
    let volume_m3 = worn.iter().map(|one| one.grid.volume_m3()).sum();
    let mut quantities = pressing(setup, watch);
    quantities.extend(removed(volume_m3, watch.preston_m3(setup)));
    quantities.extend(depths(&face, &swept, (most - least) / face.mean_m()));
    quantities.extend(left_over(setup, &face));
    quantities.extend(roughness(&swept));
    Findings {
        scalars: quantity::scalars(quantities),
        profiles: worn
            .first()
            .map(|one| across(setup, one))
            .into_iter()
            .collect(),
        beyond: too_deep(setup, [&face, &swept]),
        overload: watch.pressing.at_stop(&setup.control),
        ..Findings::default()
    }
}

/// The face stays where it was: what is taken off is not taken off under the wheel. That holds for
/// depths below what the path presses in by; where a force is held, below the wheel's radius.
fn too_deep(setup: &BeltSetup, sums: [&Sums; 2]) -> Option<Outcome> {
    let pressed_in = setup.control == ForceControl::Position && setup.indentation_m > 0.0;
    let (limit, rule) = match pressed_in {
        true => (
            setup.indentation_m,
            "the wheel would no longer touch what is left",
        ),
        false => (
            setup.wheel.radius_m,
            "the face would have another form under the wheel",
        ),
    };
    let value = sums.map(|one| one.largest).into_iter().fold(0.0, f64::max);
    (value > limit).then(|| Outcome::BeyondModel {
        quantity: "the largest depth taken off a cell of the face (m)".to_owned(),
        value,
        limit,
        rule: format!("{rule}, whose shape is that before the run; check process.belt.removal"),
    })
}

/// How the belt pressed.
fn pressing(setup: &BeltSetup, watch: &Watch) -> Vec<Quantity> {
    let pressing = &watch.pressing;
    let indentation = watch.indentation_m / setup.wheel.rubber_m;
    let mut quantities = vec![
        Quantity::new("belt.mean_force", Unit::Newton, pressing.mean_n())
            .text("Mean normal force while the belt is on the face"),
        Quantity::new("belt.force_spread", Unit::Newton, pressing.spread_n())
            .text("Standard deviation of the normal force while the belt is on the face, setting down and lifting included"),
        Quantity::new("belt.largest_force", Unit::Newton, pressing.largest_n)
            .text("Largest normal force"),
        Quantity::new("belt.contact_time", Unit::Second, pressing.contact_s)
            .text("Time that the belt is on the face"),
        Quantity::new("belt.largest_indentation", Unit::One, indentation)
            .text("Largest indentation of the wheel over the thickness of its rubber; from 1 on the hub would be on the face"),
    ];
    if setup.control != ForceControl::Position {
        quantities.push(Quantity::new("belt.carrier_at_stop", Unit::One, pressing.stopped())
            .text("Part of the time on the face during which the carrier stands at an end of its stroke, and the force is not the one asked for"));
    }
    quantities
}

fn removed(volume_m3: f64, preston_m3: f64) -> [Quantity; 2] {
    [
        Quantity::new("belt.removed_volume", Unit::CubicMetre, volume_m3)
            .text("Volume removed from all copies"),
        Quantity::new("belt.preston_volume", Unit::CubicMetre, preston_m3)
            .text("Preston's integral k_p ∫ p v dA dt"),
    ]
}

fn depths(face: &Sums, swept: &Sums, copies_difference: f64) -> [Quantity; 6] {
    [
        Quantity::new("belt.depth_mean", Unit::Metre, face.mean_m())
            .text("Mean depth over the whole face, all copies"),
        Quantity::new("belt.depth_swept", Unit::Metre, swept.mean_m())
            .text("Mean depth between the outermost lines and short of their ends, where every pass is whole"),
        Quantity::new("belt.depth_least", Unit::Metre, swept.least.unwrap_or(0.0))
            .text("Least depth of a cell there"),
        Quantity::new("belt.depth_largest", Unit::Metre, swept.largest)
            .text("Largest depth of a cell there"),
        Quantity::new("belt.unevenness", Unit::One, swept.unevenness())
            .text("Standard deviation of the depth over its mean there"),
        Quantity::new("belt.copies_difference", Unit::One, copies_difference)
            .text("Mean depth of the copy worn most less that of the copy worn least, over the mean of all"),
    ]
}

/// What the lines leave, and what the run leaves out of account.
fn left_over(setup: &BeltSetup, face: &Sums) -> [Quantity; 2] {
    [
        Quantity::new("belt.untouched", Unit::One, face.untouched / face.area)
            .text("Share of the whole face, all copies, from which nothing is taken"),
        Quantity::new("belt.chord_deviation", Unit::Metre, setup.chord_m)
            .text("Largest distance between the face, which this run follows, and the straight lines that the job's program drives from point to point"),
    ]
}

fn roughness(swept: &Sums) -> [Quantity; 2] {
    [
        Quantity::new(
            "belt.roughness_mean",
            Unit::Metre,
            swept.roughness / swept.area,
        )
        .text("Mean Ra between the outermost lines and short of their ends"),
        Quantity::new("belt.roughness_largest", Unit::Metre, swept.roughest)
            .text("Largest Ra of a cell there"),
    ]
}

/// Mean depth of each row over the middle half of the first copy's columns, over the distance along
/// v in the middle of u.
fn across(setup: &BeltSetup, worn: &Worn) -> Profile {
    let [columns, rows] = setup.cells.count;
    let place = |row: usize| {
        let [u, v] = setup.cells.middle(row * columns + columns / 2);
        setup.patch.surface.point_m(u, v)
    };
    let mut along_m = 0.5 * (place(rows.min(2) - 1) - place(0)).norm();
    let axis = (0..rows).map(|row| {
        along_m += (place(row) - place(row.saturating_sub(1))).norm();
        along_m
    });
    Profile {
        name: "belt.removed_depth".into(),
        description: "Depth removed from the first copy across its first parameter, mean over the middle half of that".into(),
        axis_name: "face_v".into(),
        axis_unit: Unit::Metre,
        axis: axis.collect(),
        unit: Unit::Metre,
        values: worn.grid.middle_means_m(),
    }
}

/// A face as it is drawn, of a belt's copies the first: cells at their middles, in a frame that
/// looks onto the middle of the face.
pub(in crate::process) fn field(
    cells: &Cells,
    patch: &PatchFile,
    world_from_patch: &Isometry3<f64>,
    full_scale: f64,
) -> Field {
    let domain = patch.surface.domain();
    let jet = (patch.surface).jet(
        0.5 * (domain.u[0] + domain.u[1]),
        0.5 * (domain.v[0] + domain.v[1]),
    );
    let x = jet.first_m[0].normalize();
    let z = jet.first_m[0].cross(&jet.first_m[1]).normalize();
    let axes = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, z.cross(&x), z]));
    let turn = UnitQuaternion::from_rotation_matrix(&axes);
    let points = middles(cells, patch);
    let flat: Vec<Vector3<f64>> = points.iter().map(|p| turn.inverse() * p.coords).collect();
    let bound =
        |pick: fn(f64, f64) -> f64, i: usize, from: f64| flat.iter().map(|p| p[i]).fold(from, pick);
    let low = [0, 1].map(|i| bound(f64::min, i, f64::INFINITY));
    let high = [0, 1].map(|i| bound(f64::max, i, f64::NEG_INFINITY));
    let middle = turn.inverse() * jet.point_m;
    let origin = Vector3::new(low[0], low[1], middle.z);
    let patch_from_field = Isometry3::from_parts((turn * origin).into(), turn);
    Field {
        path: "removed_depth".into(),
        world_from_field: crate::scene::pose(&(world_from_patch * patch_from_field)),
        size_m: [high[0] - low[0], high[1] - low[1]],
        cells: cells.count,
        full_scale,
        unit: Unit::Metre,
        vertices_m: flat
            .iter()
            .map(|p| (p - origin + Vector3::z() * DRAWN_ABOVE_M).into())
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{WHEEL, plane};
    use super::*;

    const HELD: ForceControl = ForceControl::ConstantForce {
        force_n: 15.0,
        damping_n_s_per_m: 500.0,
        fastest_m_per_s: 0.05,
        stroke_m: 2e-3,
        stiction_n: 0.0,
    };

    /// Removal within what the path presses in by, or below the wheel's radius under a held force,
    /// is what the model is for; beyond, the outcome says so, with value and bound.
    #[test]
    fn removal_deeper_than_the_model_holds_for_fails_the_run() {
        let by_path = plane(WHEEL);
        let held = BeltSetup {
            control: HELD,
            ..by_path.clone()
        };
        for (setup, bound_m) in [(&by_path, by_path.indentation_m), (&held, WHEEL.radius_m)] {
            let outcome = |largest| {
                let sums = Sums {
                    largest,
                    ..Sums::default()
                };
                too_deep(setup, [&Sums::default(), &sums])
            };
            assert_eq!(outcome(0.99 * bound_m), None);
            let Some(Outcome::BeyondModel { value, limit, .. }) = outcome(5078.0) else {
                panic!("{:?}", outcome(5078.0));
            };
            assert_eq!([value, limit], [5078.0, bound_m]);
            assert!(outcome(1.01 * bound_m).is_some());
        }
    }
}
