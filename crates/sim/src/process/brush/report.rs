//! What a brush run ends with: force, burrs and radii along the edges; and how these are drawn.

use super::contact::BrushContact;
use super::{BrushSetup, Station};
use crate::process::Findings;
use crate::process::quantity::{self, Quantity};
use nalgebra::{Isometry3, Vector3};
use truecut_recording::{Field, Outcome, Profile, Unit};

/// Half the width at which an edge is drawn, m, and its height over the faces.
const DRAWN_HALF_M: f64 = 2e-3;
const DRAWN_ABOVE_M: f64 = 1e-4;
/// Rows of the ribbon that is drawn: on one face, on the edge, on the other.
const ROWS: usize = 3;
/// Radius at which the colours of an edge without a burr end, tips.
const FULL_SCALE_TIPS: f64 = 1.0;

/// What is summed up while the run goes on.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Watch {
    /// Time in contact, s.
    contact_s: f64,
    /// `∫ F dt`, N s.
    impulse_n_s: f64,
    largest_n: f64,
    shortening_m: f64,
    work_j: f64,
    /// Since the start, s.
    time_s: f64,
}

impl Watch {
    pub fn step(&mut self, contact: &BrushContact, dt_s: f64) {
        self.time_s += dt_s;
        if contact.bristle_n > 0.0 {
            self.contact_s += dt_s;
        }
        self.impulse_n_s += contact.bristle_n * dt_s;
        self.work_j += contact.power_w * dt_s;
        self.largest_n = self.largest_n.max(contact.bristle_n);
        self.shortening_m = self.shortening_m.max(contact.shortening_m);
    }
}

/// Volume taken off the edges so far, m³.
pub(super) fn removed_m3(stations: &[Station], dose_j_per_m2: &[f64]) -> f64 {
    let stations = stations.iter().zip(dose_j_per_m2);
    stations
        .map(|(station, dose)| station.length_m * station.wear.removed_m2(*dose))
        .sum()
}

/// Length of the edges on which a burr is left, m.
pub(super) fn burred_m(stations: &[Station], dose_j_per_m2: &[f64]) -> f64 {
    let stations = stations.iter().zip(dose_j_per_m2);
    let burred = stations.filter(|(station, dose)| station.wear.burr_left_m(**dose) > 0.0);
    // A sum of nothing would be -0.
    burred.fold(0.0, |sum, (station, _)| sum + station.length_m)
}

/// What is left of an edge, weighed by length.
#[derive(Debug, Clone, Copy)]
struct Edges {
    length_m: f64,
    burred_m: f64,
    burr_mean_m: f64,
    burr_largest_m: f64,
    radius_mean_m: f64,
    radius_least_m: f64,
    radius_largest_m: f64,
    removed_m3: f64,
}

impl Edges {
    fn of(stations: &[Station], dose_j_per_m2: &[f64]) -> Self {
        let each: Vec<[f64; 3]> = (stations.iter().zip(dose_j_per_m2))
            .map(|(station, dose)| {
                let wear = &station.wear;
                [
                    station.length_m,
                    wear.burr_left_m(*dose),
                    wear.radius_m(*dose),
                ]
            })
            .collect();
        let length_m: f64 = each.iter().map(|[length, ..]| length).sum();
        let sum = |k: usize| each.iter().map(|one| one[0] * one[k]).sum::<f64>();
        let largest = |k: usize| each.iter().map(|one| one[k]).fold(0.0, f64::max);
        let least = |k: usize| each.iter().map(|one| one[k]).fold(f64::INFINITY, f64::min);
        Self {
            length_m,
            burred_m: burred_m(stations, dose_j_per_m2),
            burr_mean_m: sum(1) / length_m,
            burr_largest_m: largest(1),
            radius_mean_m: sum(2) / length_m,
            radius_least_m: least(2),
            radius_largest_m: largest(2),
            removed_m3: removed_m3(stations, dose_j_per_m2),
        }
    }
}

pub(super) fn findings(setup: &BrushSetup, dose_j_per_m2: &[f64], watch: &Watch) -> Findings {
    let edges = Edges::of(&setup.stations, dose_j_per_m2);
    let quantities = pressing(setup, watch).into_iter().chain(left(&edges));
    let count = setup.stations.last().map_or(0, |last| last.edge + 1);
    let profiles = (0..count).flat_map(|edge| along(setup, dose_j_per_m2, edge));
    Findings {
        scalars: quantity::scalars(quantities),
        profiles: profiles.collect(),
        beyond: too_deep(setup, watch).or_else(|| too_round(setup, dose_j_per_m2, watch)),
        idle: never_touches(watch),
        ..Findings::default()
    }
}

/// A bristle whose tip lies along the face is not held at its end, as the law of its force has it.
fn too_deep(setup: &BrushSetup, watch: &Watch) -> Option<Outcome> {
    let (value, limit) = (watch.shortening_m, setup.brush.bristle().lying_m());
    (value > limit).then(|| Outcome::BeyondModel {
        quantity: "the largest shortening of a bristle (m)".to_owned(),
        value,
        limit,
        rule:
            "its tip lies along the face and no law of its force is known; lead the brush less deep"
                .to_owned(),
    })
}

/// The edges stay where they were: what is taken off is not taken off under the brush. That
/// holds while the middle of the rounding, `r (1 / sin(α/2) − 1)` behind an edge of the wedge α,
/// lies less deep than the bristles press in.
fn too_round(setup: &BrushSetup, dose_j_per_m2: &[f64], watch: &Watch) -> Option<Outcome> {
    let stations = setup.stations.iter().zip(dose_j_per_m2);
    let recess_m = stations.map(|(station, dose)| {
        let wear = &station.wear;
        wear.radius_m(*dose) * (1.0 / (0.5 * wear.wedge_rad).sin() - 1.0)
    });
    let value = recess_m.fold(0.0, f64::max);
    let limit = watch.shortening_m;
    (value > limit).then(|| Outcome::BeyondModel {
        quantity: "the largest depth of an edge's rounding behind the edge (m)".to_owned(),
        value,
        limit,
        rule: "the bristles would no longer touch what is left, but the edge keeps its form under them; check \
               process.brush.preston_per_pa"
            .to_owned(),
    })
}

/// Most of the time that a brush may be clear of its workpiece.
const MOST_CLEAR: f64 = 0.9999;

/// A brush that is led past its workpiece brushes nothing.
fn never_touches(watch: &Watch) -> Option<Outcome> {
    let value = 1.0 - watch.contact_s / watch.time_s;
    (value > MOST_CLEAR).then(|| Outcome::BeyondModel {
        quantity: "the part of the time in which the brush is clear of the workpiece".to_owned(),
        value,
        limit: MOST_CLEAR,
        rule: "nothing is brushed; check the taught postures or the path, and where the workpiece stands"
            .to_owned(),
    })
}

/// How the brush pressed.
fn pressing(setup: &BrushSetup, watch: &Watch) -> [Quantity; 5] {
    let shortening = watch.shortening_m / setup.brush.free_length_m;
    // Where it never touches there is none.
    let mean_n = watch.impulse_n_s / watch.contact_s.max(f64::MIN_POSITIVE);
    [
        Quantity::new("brush.largest_force", Unit::Newton, watch.largest_n)
            .text("Largest sum of the forces of the bristles"),
        Quantity::new("brush.contact_time", Unit::Second, watch.contact_s)
            .text("Time that the brush touches the workpiece"),
        Quantity::new("brush.friction_work", Unit::Joule, watch.work_j)
            .text("Work of the friction of the tips"),
        Quantity::new("brush.largest_shortening", Unit::One, shortening)
            .text("Largest shortening of a bristle over its free length; from about 0.54 on its tip would lie along the face"),
        Quantity::new("brush.mean_force", Unit::Newton, mean_n)
            .text("Mean sum of the forces of the bristles while the brush touches"),
    ]
}

/// What is left of burrs and edges.
fn left(edges: &Edges) -> [Quantity; 8] {
    [
        Quantity::new("brush.edge_length", Unit::Metre, edges.length_m).text("Length of all edges"),
        Quantity::new("brush.burred_length", Unit::Metre, edges.burred_m)
            .text("Length of edge on which a burr is left"),
        Quantity::new("brush.burr_mean", Unit::Metre, edges.burr_mean_m)
            .text("Mean height of the burr that is left, over all edges"),
        Quantity::new("brush.burr_largest", Unit::Metre, edges.burr_largest_m)
            .text("Largest height of the burr that is left"),
        Quantity::new("brush.radius_mean", Unit::Metre, edges.radius_mean_m)
            .text("Mean radius of the edges; 0 where a burr is left"),
        Quantity::new("brush.radius_least", Unit::Metre, edges.radius_least_m)
            .text("Least radius of an edge"),
        Quantity::new("brush.radius_largest", Unit::Metre, edges.radius_largest_m)
            .text("Largest radius of an edge"),
        Quantity::new("brush.removed_volume", Unit::CubicMetre, edges.removed_m3)
            .text("Volume removed from the edges, burrs included"),
    ]
}

/// Burr and radius over the distance along an edge.
fn along(setup: &BrushSetup, dose_j_per_m2: &[f64], edge: usize) -> [Profile; 2] {
    let of_edge = || {
        let stations = setup.stations.iter().zip(dose_j_per_m2);
        stations.filter(move |(station, _)| station.edge == edge)
    };
    let mut end_m = 0.0;
    let axis: Vec<f64> = of_edge()
        .map(|(station, _)| {
            end_m += station.length_m;
            end_m - 0.5 * station.length_m
        })
        .collect();
    let number = edge + 1;
    let profile = |name: &str, text: &str, values: Vec<f64>| Profile {
        name: format!("brush.edge{number}.{name}"),
        description: format!("{text} edge {number}"),
        axis_name: "along_the_edge".into(),
        axis_unit: Unit::Metre,
        axis: axis.clone(),
        unit: Unit::Metre,
        values,
    };
    let burr = of_edge().map(|(station, dose)| station.wear.burr_left_m(*dose));
    let radius = of_edge().map(|(station, dose)| station.wear.radius_m(*dose));
    [
        profile("burr", "Height of the burr that is left on", burr.collect()),
        profile("radius", "Radius of", radius.collect()),
    ]
}

/// Where there is a burr on what is drawn it is drawn as it is left; else the radius.
fn has_burr(setup: &BrushSetup) -> bool {
    let heights = drawn(setup).iter().map(|one| one.wear.burr_height_m);
    heights.fold(0.0, f64::max) > 0.0
}

/// The first edge as it is drawn: a ribbon over both its faces.
pub(super) fn field(setup: &BrushSetup) -> Field {
    let first = drawn(setup);
    let origin = first[0].point_m;
    let vertices_m = (0..ROWS).flat_map(|row| {
        first.iter().map(move |station| {
            let [one, other] = station.normals.map(|normal| normal.into_inner());
            let out = (one + other).normalize() * DRAWN_ABOVE_M;
            // On a face, away from the edge: against the other face's normal, within the face.
            let into = |face: Vector3<f64>, other: Vector3<f64>| {
                (face * face.dot(&other) - other).normalize() * DRAWN_HALF_M + face * DRAWN_ABOVE_M
            };
            let aside = match row {
                0 => into(one, other),
                1 => out,
                _ => into(other, one),
            };
            (station.point_m + aside - origin).into()
        })
    });
    let full_scale = match has_burr(setup) {
        true => first
            .iter()
            .map(|s| s.wear.burr_height_m)
            .fold(0.0, f64::max),
        false => FULL_SCALE_TIPS * setup.brush.bristle_diameter_m,
    };
    let corner = Isometry3::translation(origin.x, origin.y, origin.z);
    Field {
        path: match has_burr(setup) {
            true => "burr_left".into(),
            false => "edge_radius".into(),
        },
        world_from_field: crate::scene::pose(&(setup.world_from_mesh * corner)),
        size_m: [
            first.iter().map(|station| station.length_m).sum(),
            2.0 * DRAWN_HALF_M,
        ],
        cells: [first.len(), ROWS],
        full_scale,
        unit: Unit::Metre,
        vertices_m: vertices_m.collect(),
    }
}

/// Stations of the first edge.
fn drawn(setup: &BrushSetup) -> &[Station] {
    let end = setup.stations.iter().position(|station| station.edge > 0);
    &setup.stations[..end.unwrap_or(setup.stations.len())]
}

pub(super) fn field_values(setup: &BrushSetup, dose_j_per_m2: &[f64]) -> Vec<f32> {
    let has_burr = has_burr(setup);
    let values: Vec<f32> = (drawn(setup).iter().zip(dose_j_per_m2))
        .map(|(station, dose)| match has_burr {
            true => station.wear.burr_left_m(*dose) as f32,
            false => station.wear.radius_m(*dose) as f32,
        })
        .collect();
    values.repeat(ROWS)
}
