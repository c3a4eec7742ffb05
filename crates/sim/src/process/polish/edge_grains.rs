//! Grains of the wheel that run over the face's edges: who comes when, what they do to wheel and
//! edge ([`truecut_core::wheel::edge_grains`]).
//!
//! On a piece of edge dl grains come at the rate `n dl |v_across|`, independent of one another
//! (Poisson), each with a protrusion of its own. What they bear on the face is in the mean what the
//! patch presses there; here it fluctuates by what each brings onto the face or takes off it and
//! its neighbours do not make up for, fading while a grain crosses the patch, with no mean. Grains
//! that jam or climb push against the wheel besides. Numbers are drawn in `commit` for the step
//! that follows; it gets the mean over the step of what acts in it, whatever part of a pulse that
//! is. What is lost by the mean is the level above the step: with independent events Campbell's
//! theorem gives the variance `rate ∫F² dt`, less that of the means.

use super::{PolishContact, PolishSetup};
use crate::process::quantity::Quantity;
use nalgebra::{Point2, Vector2, Vector3};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Poisson, StandardNormal, StandardUniform};
use std::f64::consts::FRAC_PI_4;
use truecut_core::wheel::edge_grains::{BondedGrains, Corner, Pulse};
use truecut_core::wheel::patch::EdgePoint;
use truecut_recording::{Profile, Unit};
use truecut_scenario::GrainSpec;

/// Force on the face and its moment about the face's origin.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct GrainLoad {
    pub force_n: Vector3<f64>,
    moment_n_m: Vector3<f64>,
}

impl GrainLoad {
    pub fn add(&mut self, at: Point2<f64>, force_n: Vector3<f64>) {
        self.force_n += force_n;
        self.moment_n_m += Vector3::new(at.x, at.y, 0.0).cross(&force_n);
    }

    /// Moment about a point, N m.
    pub fn moment_about_n_m(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.moment_n_m - point.cross(&self.force_n)
    }
}

/// A pulse under way; before its beginning `time_s` is negative.
#[derive(Debug, Clone, Copy)]
struct UnderWay {
    pulse: Pulse,
    time_s: f64,
    at: Point2<f64>,
    direction: Vector2<f64>,
}

/// What has happened so far.
#[derive(Debug, Clone, Copy, Default)]
struct Tally {
    inward: f64,
    outward: f64,
    jammed: f64,
    shed: f64,
    /// Time with an edge run over inward.
    inward_s: f64,
    /// `∫F² dt` of all pulses, and of their means over steps.
    square_n2_s: f64,
    stepped_n2_s: f64,
}

/// The grains of a run, and the edges.
#[derive(Debug, Clone)]
pub(super) struct EdgeGrains {
    spec: GrainSpec,
    law: BondedGrains,
    mu: f64,
    /// Area of the wheel that comes by the face.
    band_m2: f64,
    per_m2: f64,
    edges: Edges,
    rng: ChaCha8Rng,
    under_way: Vec<UnderWay>,
    fluctuation: GrainLoad,
    tally: Tally,
    /// Mean over the coming step.
    pub load: GrainLoad,
}

impl EdgeGrains {
    pub fn new(setup: &PolishSetup) -> Option<Self> {
        let spec = setup.spec.grains?;
        let wheel = &setup.spec.wheel;
        let width_m = 2.0 * wheel.patch(&setup.shell, setup.indentation_m).contact_m();
        Some(Self {
            law: spec.law(wheel),
            mu: setup.spec.abrasive.mu,
            band_m2: setup.spec.touching_circumference_m() * width_m,
            per_m2: spec.per_m2,
            edges: Edges::new(setup, spec.edge_radius_m),
            rng: ChaCha8Rng::seed_from_u64(u64::from(spec.seed)),
            under_way: Vec::new(),
            fluctuation: GrainLoad::default(),
            tally: Tally::default(),
            load: GrainLoad::default(),
            spec,
        })
    }

    pub fn jammed(&self) -> f64 {
        self.tally.jammed
    }

    pub fn shed(&self) -> f64 {
        self.tally.shed
    }

    /// Draws what comes in the next step, and averages over it.
    pub fn step(&mut self, contact: &PolishContact, edges: &[EdgePoint], dt_s: f64) {
        let speed = contact.sliding.velocity_m_per_s.norm();
        let crossing_s = 2.0 * contact.patch.contact_m() / speed;
        let kept = (-dt_s / crossing_s).exp();
        self.fluctuation.force_n *= kept;
        self.fluctuation.moment_n_m *= kept;
        let mut inward = false;
        for point in edges {
            inward |= self.cross(contact, point, dt_s);
        }
        if inward {
            self.tally.inward_s += dt_s;
        }
        self.load = self.fluctuation;
        for event in &mut self.under_way {
            let before = event.pulse.given_n_s(event.time_s);
            event.time_s += dt_s;
            let mean_n = (event.pulse.given_n_s(event.time_s) - before) / dt_s;
            self.tally.stepped_n2_s += mean_n * mean_n * dt_s;
            let force = event.direction * mean_n;
            self.load.add(event.at, Vector3::new(force.x, force.y, 0.0));
        }
        self.under_way
            .retain(|event| event.time_s < event.pulse.length_s);
    }

    /// Grains over a piece of edge; whether it is pressed and run over inward.
    fn cross(&mut self, contact: &PolishContact, point: &EdgePoint, dt_s: f64) -> bool {
        let pressure_pa = contact.patch.pressure_pa(point.at_m.x, point.at_m.y);
        let v = (contact.sliding).at_m_per_s(point.at_m.x, point.at_m.y);
        let across = v.dot(&point.outward);
        let expected = self.per_m2 * point.length_m * across.abs() * dt_s;
        if pressure_pa <= 0.0 || expected <= 0.0 {
            return false;
        }
        let station = self
            .edges
            .station(contact.at_m + point.at_m.coords, &point.outward);
        let gap_m = self.law.gap_m(pressure_pa, self.per_m2);
        let bed = (contact.patch).bed_stiffness_pa_per_m(point.at_m.x, point.at_m.y);
        let place = Place {
            at: contact.at_m + point.at_m.coords,
            station,
            gap_m,
            unshared: self.law.unshared(bed, gap_m, self.per_m2),
            corner: Corner {
                radius_m: self.edges.radius_m(station),
                mu: self.mu,
                velocity_m_per_s: [across, point.outward.perp(&v)],
            },
            along: v / v.norm(),
            outward: point.outward,
        };
        let jam_m = self.law.jam_depth_m(&place.corner);
        let [bears, jammed_bear] = self.law.mean_forces_n(place.gap_m, jam_m);
        let brings = if across < 0.0 {
            bears - self.spec.shed_share * jammed_bear
        } else {
            -bears
        };
        self.bring(&place, -brings * expected);
        let count = Poisson::new(expected).map_or(0.0, |law| law.sample(&mut self.rng));
        for _ in 0..count as u64 {
            self.meet(&place, dt_s);
        }
        across < 0.0
    }

    /// A load that comes onto the face, and its friction.
    fn bring(&mut self, place: &Place, bears_n: f64) {
        let normal_n = place.unshared * bears_n;
        let rubbed = place.along * (self.mu * normal_n);
        let force_n = Vector3::new(rubbed.x, rubbed.y, -normal_n);
        self.fluctuation.add(place.at, force_n);
    }

    /// One grain.
    fn meet(&mut self, place: &Place, dt_s: f64) {
        let off: f64 = StandardNormal.sample(&mut self.rng);
        let depth_m = self.law.protrusion_m + off * self.law.spread_m - place.gap_m;
        if depth_m <= 0.0 {
            return;
        }
        let bears_n = self.law.normal_n_per_m * depth_m;
        let Some(pulse) = self.law.pulse(depth_m, &place.corner) else {
            self.tally.outward += 1.0;
            self.bring(place, -bears_n);
            return;
        };
        self.tally.inward += 1.0;
        self.tally.square_n2_s += pulse.square_n2_s();
        let after: f64 = StandardUniform.sample(&mut self.rng);
        self.under_way.push(UnderWay {
            pulse,
            time_s: -after * dt_s,
            at: place.at,
            direction: if pulse.jams {
                place.along
            } else {
                -place.outward
            },
        });
        if pulse.jams {
            self.tally.jammed += 1.0;
            self.edges.chip(place.station, self.spec.chip_m3);
            let lot: f64 = StandardUniform.sample(&mut self.rng);
            if lot < self.spec.shed_share {
                self.tally.shed += 1.0;
                self.per_m2 = (self.per_m2 - 1.0 / self.band_m2).max(0.0);
                return;
            }
        }
        self.bring(place, bears_n);
    }

    /// Scalars of the run.
    pub fn quantities(&self) -> [Quantity; 10] {
        let tally = &self.tally;
        let count = |name, value| Quantity::new(name, Unit::One, value);
        let force =
            |name, square: f64| Quantity::new(name, Unit::Newton, (square / tally.inward_s).sqrt());
        let [mean_m, largest_m, worn_m3] = self.edges.wear(self.spec.edge_radius_m);
        [
            count("polish.grains_inward", tally.inward)
                .text("Grains that bear and run inward over an edge"),
            count("polish.grains_outward", tally.outward)
                .text("Grains that bear and run outward over an edge"),
            count("polish.grains_jammed", tally.jammed).text("Grains that jam at an edge"),
            count("polish.jammed_share", tally.jammed / tally.inward)
                .text("Share of the grains running inward over an edge that jam"),
            count("polish.grains_shed", tally.shed).text("Grains that the wheel loses at edges"),
            force("polish.grain_force", tally.stepped_n2_s).text(
                "Deviation of the force of grains against the wheel while an edge is run over \
                 inward, by means over the step",
            ),
            force(
                "polish.grain_force_above_step",
                (tally.square_n2_s - tally.stepped_n2_s).max(0.0),
            )
            .text("Deviation of that force about its means over the step (Campbell's theorem)"),
            Quantity::new("polish.edge_radius_mean", Unit::Metre, mean_m)
                .text("Mean radius of the edges at the end"),
            Quantity::new("polish.edge_radius_largest", Unit::Metre, largest_m)
                .text("Largest radius of an edge at the end"),
            Quantity::new("polish.edge_chipped_volume", Unit::CubicMetre, worn_m3)
                .text("Volume that grains break off the edges"),
        ]
    }

    /// Radius of the edges around the face.
    pub fn profile(&self) -> Profile {
        self.edges.profile()
    }
}

/// Where grains meet an edge.
#[derive(Debug, Clone, Copy)]
struct Place {
    at: Point2<f64>,
    station: usize,
    gap_m: f64,
    /// Part of a grain's load that its neighbours do not take over.
    unshared: f64,
    corner: Corner,
    /// Direction in which the wheel's surface slides.
    along: Vector2<f64>,
    outward: Vector2<f64>,
}

/// Stations along the face's four edges, from its origin around it along x first, and the section
/// that is off each.
#[derive(Debug, Clone)]
struct Edges {
    counts: [usize; 2],
    lengths_m: [f64; 2],
    sections_m2: Vec<f64>,
}

/// Section that a fillet of radius 1 takes off a right angle.
const FILLET: f64 = 1.0 - FRAC_PI_4;

impl Edges {
    fn new(setup: &PolishSetup, radius_m: f64) -> Self {
        let counts = setup.spec.cells();
        let (length_m, width_m) = (setup.spec.face.length_m, setup.spec.face.width_m);
        let stations = 2 * (counts[0] + counts[1]);
        Self {
            counts,
            lengths_m: [length_m / counts[0] as f64, width_m / counts[1] as f64],
            sections_m2: vec![FILLET * radius_m * radius_m; stations],
        }
    }

    /// The station at a place on the edge with an outward normal.
    fn station(&self, at: Point2<f64>, outward: &Vector2<f64>) -> usize {
        let [columns, rows] = self.counts;
        let part = |place: f64, side: usize| {
            let cell = (place / self.lengths_m[side]).max(0.0) as usize;
            cell.min(self.counts[side] - 1)
        };
        if outward.y < -0.5 {
            part(at.x, 0)
        } else if outward.x > 0.5 {
            columns + part(at.y, 1)
        } else if outward.y > 0.5 {
            2 * columns + rows - 1 - part(at.x, 0)
        } else {
            2 * (columns + rows) - 1 - part(at.y, 1)
        }
    }

    fn length_m(&self, station: usize) -> f64 {
        let [columns, rows] = self.counts;
        self.lengths_m[usize::from(station % (columns + rows) >= columns)]
    }

    fn radius_m(&self, station: usize) -> f64 {
        (self.sections_m2[station] / FILLET).sqrt()
    }

    fn chip(&mut self, station: usize, volume_m3: f64) {
        self.sections_m2[station] += volume_m3 / self.length_m(station);
    }

    /// Mean and largest radius, m, and the volume off edges that began with a radius, m³.
    fn wear(&self, from_m: f64) -> [f64; 3] {
        let stations = 0..self.sections_m2.len();
        let (mut mean, mut largest, mut volume, mut around) = (0.0, 0.0_f64, 0.0, 0.0);
        for station in stations {
            let (radius_m, length_m) = (self.radius_m(station), self.length_m(station));
            mean += radius_m * length_m;
            around += length_m;
            largest = largest.max(radius_m);
            volume += (self.sections_m2[station] - FILLET * from_m * from_m) * length_m;
        }
        [mean / around, largest, volume]
    }

    fn profile(&self) -> Profile {
        let mut place = 0.0;
        let middles = (0..self.sections_m2.len()).map(|station| {
            place += self.length_m(station);
            place - 0.5 * self.length_m(station)
        });
        Profile {
            name: "polish.edge_radius".into(),
            description: "Radius of the edges, from the face's origin around it along x first"
                .into(),
            axis_name: "edge_s".into(),
            axis_unit: Unit::Metre,
            axis: middles.collect(),
            unit: Unit::Metre,
            values: (0..self.sections_m2.len())
                .map(|station| self.radius_m(station))
                .collect(),
        }
    }
}
