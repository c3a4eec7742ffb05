//! Tools that lean and turn against quadrature, the law of upright tools, and volumes.

use super::cut::SwivelCut;
use super::field::DistanceField;
use super::way::{SwivelLeg, follow, turned_to};
use crate::cutting::milling::cutter::{Cutter, Runout};
use crate::cutting::milling::examples::aluminium;
use crate::cutting::milling::layered::block::Block;
use crate::cutting::milling::layered::cut::{LayeredCut, ToolPlace};
use crate::cutting::milling::layered::stock::LayeredStock;
use crate::cutting::milling::layered::walls::Walls;
use crate::cutting::milling::layered::way::WayFault;
use crate::cutting::milling::profile::Profile;
use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, Unit, Vector3};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Uniform};
use std::collections::HashMap;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

mod paths;
mod surface;

const BLOCK: Block = Block {
    least_m: Vector3::new(0.0, 6e-3, -5e-3),
    most_m: Vector3::new(40e-3, 24e-3, 0.0),
};
/// Steps of a revolution.
const STEPS: usize = 120;

fn draws(seed: u64) -> impl FnMut(f64, f64) -> f64 {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    move |low, high| Uniform::new(low, high).unwrap().sample(&mut random)
}

fn stock(grid_m: f64) -> DistanceField {
    DistanceField::new(&LayeredStock::new(BLOCK, &[], grid_m, &[]), grid_m)
}

/// Axes of a tool that leans forwards along x and to the side along y, rad.
fn leaning(forwards_rad: f64, aside_rad: f64) -> Rotation3<f64> {
    let axis = Vector3::new(forwards_rad.tan(), aside_rad.tan(), 1.0);
    turned_to(&Rotation3::identity(), &Unit::new_normalize(axis))
}

fn pose(place_mm: [f64; 3], axes: Rotation3<f64>) -> Isometry3<f64> {
    let place_m = Vector3::from(place_mm) * 1e-3;
    Isometry3::from_parts(Translation3::from(place_m), axes.into())
}

fn leg(from: Isometry3<f64>, to: Isometry3<f64>) -> SwivelLeg {
    SwivelLeg {
        from,
        to,
        rapid: false,
        point: 1,
    }
}

fn with_corner(profile: Profile, teeth: usize, helix_angle_rad: f64) -> Cutter {
    Cutter {
        corner_radius_m: profile.corner_radius_m,
        helix_angle_rad,
        ..Cutter::straight(profile.radius_m, teeth)
    }
}

/// Flat, ball and bull nose in turn.
fn drawn(seed: u64, draw: &mut impl FnMut(f64, f64) -> f64) -> Profile {
    let radius_m = draw(3e-3, 5e-3);
    let corner_radius_m = match seed % 3 {
        0 => 0.0,
        1 => radius_m,
        _ => radius_m * draw(0.3, 0.7),
    };
    Profile {
        radius_m,
        corner_radius_m,
    }
}

/// Leads a tool along a leg; `each` sees every state before it is committed.
fn lead(
    cut: &mut SwivelCut,
    leg: &SwivelLeg,
    feed_per_tooth_m: f64,
    mut each: impl FnMut(&SwivelCut, &ToolPlace),
) {
    let way_m = (leg.to.translation.vector - leg.from.translation.vector).norm();
    let step_m = feed_per_tooth_m * cut.cutter.teeth as f64 / STEPS as f64;
    let mut axes = leg.from.rotation.to_rotation_matrix();
    for k in 0..(way_m / step_m) as usize {
        let on = leg.at(step_m * k as f64 / way_m);
        axes = turned_to(&axes, &(on.rotation * Vector3::z_axis()));
        let at = ToolPlace {
            rotation_rad: TAU * k as f64 / STEPS as f64,
            place_m: on.translation.vector,
            axes,
            ..ToolPlace::default()
        };
        each(cut, &at);
        cut.commit(&at);
    }
    cut.finish();
}

fn at_start(leg: &SwivelLeg) -> ToolPlace {
    ToolPlace {
        place_m: leg.from.translation.vector,
        axes: leg.from.rotation.to_rotation_matrix(),
        ..ToolPlace::default()
    }
}

/// Mean force of a revolution of a tool that goes straight ahead along a feed (work frame) through
/// stock with its face at z = 0, its tip at a height, by quadrature over its edges: the chip along
/// the normal is h = c f·n where that is positive, over db = dz/sin κ (Engin and Altintas 2001;
/// their matrix, an axial coefficient that is positive into the spindle).
fn mean_n(
    cutter: &Cutter,
    axes: &Rotation3<f64>,
    c_m: f64,
    feed: &Vector3<f64>,
    tip_m: f64,
) -> Vector3<f64> {
    let (r, corner) = (cutter.radius_m, cutter.corner_radius_m);
    let feed = axes.inverse() * feed;
    let k = aluminium();
    let mut sum = Vector3::zeros();
    let mut add = |radius_m: f64, height_m: f64, kappa: f64, db: f64| {
        let count = 720;
        for i in 0..count {
            let phi = TAU * (f64::from(i) + 0.5) / f64::from(count);
            let out = Vector3::new(phi.sin(), phi.cos(), 0.0);
            let normal = out * kappa.sin() - Vector3::z() * kappa.cos();
            let place = axes * (out * radius_m + Vector3::z() * height_m);
            let h = c_m * feed.dot(&normal);
            if h <= 0.0 || tip_m + place.z > 0.0 {
                continue;
            }
            let [t, n, a] = [
                (k.tangential_pa, k.edge_tangential_n_per_m),
                (k.radial_pa, k.edge_radial_n_per_m),
                (k.axial_pa, k.edge_axial_n_per_m),
            ]
            .map(|(cutting, edge)| (cutting * h + edge) * db);
            let (sin, cos) = phi.sin_cos();
            let rows = Matrix3::new(
                -sin * kappa.sin(),
                -cos,
                sin * kappa.cos(),
                -cos * kappa.sin(),
                sin,
                cos * kappa.cos(),
                kappa.cos(),
                0.0,
                kappa.sin(),
            );
            sum += rows * Vector3::new(n, t, a) * (TAU / f64::from(count));
        }
    };
    let count = 500;
    if corner > 0.0 {
        let step = FRAC_PI_2 / f64::from(count);
        for i in 0..count {
            let kappa = step * (f64::from(i) + 0.5);
            let radius_m = r - corner + corner * kappa.sin();
            add(radius_m, corner * (1.0 - kappa.cos()), kappa, corner * step);
        }
    }
    let step_m = 10e-3 / f64::from(count);
    for i in 0..count {
        add(r, corner + step_m * (f64::from(i) + 0.5), FRAC_PI_2, step_m);
    }
    axes * sum * (cutter.teeth as f64 / TAU)
}

/// Slots of tools that lean forwards and to either side: flat ones, balls and bull noses.
#[test]
fn verify_mean_force_of_slots_of_leaning_tools() {
    for seed in 200..206 {
        let mut draw = draws(seed);
        let profile = drawn(seed, &mut draw);
        let cutter = with_corner(profile, 2 + seed as usize % 2, draw(0.0, 0.6));
        let axes = leaning(draw(0.03, 0.35), draw(-0.35, 0.35));
        // Chips are linear in the feed but for c/2r.
        let c_m = draw(8e-6, 15e-6);
        let (depth_mm, grid_m) = (draw(1.0, 2.5), draw(0.12e-3, 0.18e-3));
        let at = |x_mm: f64| pose([x_mm, 15.0, -depth_mm], axes);
        let before = follow(&[leg(at(-12.0), at(12.0))], stock(grid_m), &profile).unwrap();
        let on = leg(at(12.0), at(12.0 + 15.5e3 * c_m * cutter.teeth as f64));
        let mut cut = SwivelCut::new(cutter, aluminium(), before.target, &at_start(&on));
        let mut found: Vec<Vector3<f64>> = Vec::new();
        lead(&mut cut, &on, c_m, |cut, at| {
            if at.rotation_rad > 10.0 * TAU - 1e-9 {
                found.push(cut.evaluate(at).force_on_tool_n);
            }
        });
        let count = found.len() / STEPS * STEPS;
        assert!(count >= 4 * STEPS);
        let found = found[..count].iter().sum::<Vector3<f64>>() / count as f64;
        let expected = mean_n(&cutter, &axes, c_m, &Vector3::x(), -depth_mm * 1e-3);
        let error = (found - expected).norm() / expected.norm();
        println!("{seed}: {:.3} %", error * 100.0);
        assert!(error < 0.01, "{seed}: {found:?} {expected:?}");
    }
}

/// An upright tool that vibrates meets the law of upright tools: forces are equal but for the grid.
#[test]
fn verify_an_upright_tool_has_the_forces_of_layers() {
    for seed in 220..225 {
        let mut draw = draws(seed);
        let (r_m, depth_m, c_m) = (draw(4e-3, 6e-3), draw(0.5e-3, 3e-3), draw(0.06e-3, 0.15e-3));
        let y_m = 20e-3 + draw(-0.6, 0.8) * r_m;
        let cutter = Cutter {
            helix_angle_rad: draw(0.1, 0.6),
            runout: Runout {
                offset_m: draw(0.0, 4e-6),
                angle_rad: draw(0.0, 6.0),
            },
            ..Cutter::straight(r_m, 3)
        };
        let block = Block {
            most_m: Vector3::new(40e-3, 20e-3, 0.0),
            ..BLOCK
        };
        let (turn, size_m) = (draw(0.3, 3.0), draw(1e-6, 4e-6));
        let layers = LayeredStock::new(block, &[], 0.1e-3, &[-depth_m]);
        let start = ToolPlace {
            place_m: Vector3::new(-r_m - 1e-3, y_m, -depth_m),
            ..ToolPlace::default()
        };
        let field = DistanceField::new(&layers, 0.1e-3);
        let walls = Walls::new(Vec::new(), r_m);
        let mut upright = LayeredCut::new(cutter, aluminium(), layers, walls, start.place_m);
        let mut swivelled = SwivelCut::new(cutter, aluminium(), field, &start);
        let (mut sums_n, mut squares_n2) = ([Vector3::zeros(); 2], [0.0; 2]);
        // No step lies at the same angles again: through faces edges on a helix go slice by slice.
        let steps = STEPS as f64 + 0.37;
        let step_m = c_m * 3.0 / steps;
        for k in 0..((r_m + 5e-3) / step_m) as usize {
            let rotation_rad = TAU * k as f64 / steps;
            let (sin, cos) = (turn * rotation_rad).sin_cos();
            let off = Vector3::new(step_m * k as f64 + size_m * sin, size_m * cos, 0.0);
            let at = ToolPlace {
                rotation_rad,
                place_m: start.place_m + off,
                ..ToolPlace::default()
            };
            let forces =
                [upright.evaluate(&at), swivelled.evaluate(&at)].map(|l| l.force_on_tool_n);
            squares_n2[0] += forces[0].norm_squared();
            squares_n2[1] += (forces[0] - forces[1]).norm_squared();
            for (sum, force) in sums_n.iter_mut().zip(forces) {
                *sum += force;
            }
            upright.commit(&at);
            swivelled.commit(&at);
        }
        let error = (sums_n[0] - sums_n[1]).norm() / sums_n[0].norm();
        let off = (squares_n2[1] / squares_n2[0]).sqrt();
        println!("{seed}: mean {error:.2e}, root mean square {off:.2e}");
        assert!(off < 0.03, "{seed}: {off}");
        assert!(error < 2e-3, "{seed}: {error}");
    }
}
