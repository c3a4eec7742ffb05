use super::*;
use crate::cutting::chamfer::CuttingCoefficients;
use crate::cutting::milling::cut::MillingCut;
use crate::cutting::milling::cutter::{Cutter, Runout};
use crate::cutting::milling::engagement::Engagement;
use crate::cutting::milling::finish::figures;
use crate::cutting::milling::finish::tests::{feed_mark_height_m, strongest_wave};
use nalgebra::Vector3;

const FEED_M: f64 = 0.2e-3;
const RADIUS_M: f64 = 8e-3;

fn grid() -> RayGrid {
    RayGrid {
        start_m: 1e-3,
        spacing_m: 4e-6,
        count: 500,
    }
}

/// A pass of a given displacement over rotation, in coarse steps of 2.5 degrees.
fn mill(cutter: Cutter, displacement: impl Fn(f64) -> Vector3<f64>) -> FinishedSurface {
    let engagement = Engagement::SLOT;
    let p = MillingParameters {
        cutter,
        coefficients: CuttingCoefficients::from_resultant(0.0, 1e9, 0.3),
        stock: engagement.stock(&cutter, 2e-3),
        feed_per_tooth_m: FEED_M,
        regeneration: true,
        steady_displacement_m: Vector3::zeros(),
        passes: 4,
        slice_lag_rad: 0.02,
    };
    let walls = [
        (Wall::Exit, 1e-3),
        (Wall::Entry, 1e-3),
        (Wall::Exit, 1.8e-3),
    ];
    let surface = FinishedSurface::new(grid(), &walls, &[0.0, 3e-3]);
    let mut cut = MillingCut::new(p, Some(surface));
    // From half a radius before the rays until the rear of the tool has crossed them.
    let revolutions = (grid().x_m(grid().count) + 2.0 * RADIUS_M) / p.feed_per_revolution_m();
    let first = (-2.0 * RADIUS_M / p.feed_per_revolution_m()) as i64 * 144;
    for i in first..(revolutions * 144.0) as i64 {
        let rotation_rad = TAU * i as f64 / 144.0;
        cut.commit(&ToolState {
            rotation_rad,
            displacement_m: displacement(rotation_rad),
            ..ToolState::default()
        });
    }
    cut.finished().expect("asked for").clone()
}

fn cutter(teeth: usize) -> Cutter {
    Cutter {
        helix_angle_rad: 0.5,
        ..Cutter::straight(RADIUS_M, teeth)
    }
}

/// A tool that does not vibrate leaves feed marks of height c²/8r on both walls, whatever the step,
/// and a flat floor.
#[test]
fn verify_feed_marks_of_a_still_tool() {
    let surface = mill(cutter(2), |_| Vector3::zeros());
    let expected = feed_mark_height_m(RADIUS_M, FEED_M);
    for wall in 0..3 {
        let found = figures(surface.wall(wall).left_m()).expect("cut everywhere");
        // Rays 4 µm apart meet a mark's crest to within 2 µm: 2 % of its half-width, 4 % of its
        // height.
        assert!(
            (found.peak_to_valley_m / expected - 1.0).abs() < 0.05,
            "{found:?} {expected}"
        );
        // Parabolas: the mean stands at a third of the height.
        assert!((found.location_error_m / (expected / 3.0) - 1.0).abs() < 0.05);
        let wave = strongest_wave(surface.wall(wall).left_m(), 4e-6, 0.5 * FEED_M).expect("marks");
        assert!((wave.wavelength_m / FEED_M - 1.0).abs() < 0.02, "{wave:?}");
    }
    for line in 0..2 {
        let found = figures(surface.floor(line).left_m()).expect("cut everywhere");
        assert_eq!(found.peak_to_valley_m, 0.0);
        assert_eq!(found.location_error_m, 0.0);
    }
}

/// Runout beyond the feed marks: one tooth makes the surface, marks are those of the feed per
/// revolution, and the wall stands further out by the runout.
#[test]
fn verify_runout_makes_marks_of_a_whole_revolution() {
    let runout = Runout {
        offset_m: 5e-6,
        angle_rad: 0.0,
    };
    let surface = mill(
        Cutter {
            runout,
            ..cutter(2)
        },
        |_| Vector3::zeros(),
    );
    let found = figures(surface.wall(0).left_m()).expect("cut");
    let expected = feed_mark_height_m(RADIUS_M, 2.0 * FEED_M);
    assert!((found.peak_to_valley_m / expected - 1.0).abs() < 0.05);
    assert!((found.location_error_m - (expected / 3.0 - 5e-6)).abs() < 0.05 * expected);
}

/// A tool pushed aside by 20 µm leaves one wall 20 µm too far out and the other 20 µm too far in.
#[test]
fn verify_surface_location_error_of_a_deflected_tool() {
    let surface = mill(cutter(4), |_| Vector3::new(0.0, 20e-6, 0.0));
    let marks = feed_mark_height_m(RADIUS_M, FEED_M) / 3.0;
    let error = |wall: usize| {
        figures(surface.wall(wall).left_m())
            .expect("cut")
            .location_error_m
    };
    assert!((error(0) - (20e-6 + marks)).abs() < 0.1 * marks, "exit");
    assert!((error(1) - (marks - 20e-6)).abs() < 0.1 * marks, "entry");
}

/// A slow vibration along the axis leaves a wave in the floor and none in the walls; the floor ends
/// at what the deeper of the two crossings, ahead of and behind the axis, has left.
#[test]
fn verify_slow_axial_vibration_is_copied_into_the_floor() {
    // One wave every 1 mm of feed: 2.5 revolutions of two teeth.
    let per_rad = TAU * (2.0 * FEED_M / TAU) / 1e-3;
    let amplitude = 10e-6;
    let surface = mill(cutter(2), |rotation| {
        Vector3::new(0.0, 0.0, amplitude * (per_rad * rotation).sin())
    });
    // The line at y = 3 mm is crossed ahead of the axis by √(r² − y²) and behind it by as much.
    let reach = (RADIUS_M.powi(2) - 3e-3_f64.powi(2)).sqrt();
    let wave = |x: f64| amplitude * (TAU * x / 1e-3).sin();
    let row = surface.floor(1).left_m();
    let mut worst = 0.0_f64;
    for (ray, left) in row.iter().enumerate() {
        let x = grid().x_m(ray);
        let expected = wave(x - reach).min(wave(x + reach));
        worst = worst.max((left - expected).abs());
    }
    // Straight between crossings 0.2 mm apart, a fifth of the wave: 1 − cos(π/5) of the amplitude.
    assert!(worst < 0.2 * amplitude, "{worst}");
    let marks = feed_mark_height_m(RADIUS_M, FEED_M);
    let wall = figures(surface.wall(0).left_m()).expect("cut");
    assert!((wall.peak_to_valley_m / marks - 1.0).abs() < 0.1);
}

#[test]
fn rays_that_no_tooth_reached_stay_uncut() {
    let p = MillingParameters {
        cutter: cutter(2),
        coefficients: CuttingCoefficients::from_resultant(0.0, 1e9, 0.3),
        stock: Engagement::SLOT.stock(&cutter(2), 2e-3),
        feed_per_tooth_m: FEED_M,
        regeneration: true,
        steady_displacement_m: Vector3::zeros(),
        passes: 4,
        slice_lag_rad: 0.02,
    };
    let surface = FinishedSurface::new(grid(), &[(Wall::Exit, 1e-3)], &[0.0]);
    let cut = MillingCut::new(p, Some(surface));
    let finished = cut.finished().expect("asked for");
    assert!(finished.wall(0).left_m().iter().all(|x| x.is_nan()));
    assert!(figures(finished.floor(0).left_m()).is_none());
}
