use super::*;
use crate::chatter::DirectionalMatrix;
use crate::cutting::milling::cutter::Cutter;
use crate::cutting::milling::cutter::Runout;
use crate::cutting::milling::engagement::Engagement;
use crate::cutting::milling::examples::aluminium;
use crate::cutting::milling::flank::Flank;
use crate::cutting::milling::nominal::NominalCut;
use nalgebra::Vector3;
use std::f64::consts::{FRAC_PI_2, PI};

pub(super) fn parameters(
    cutter: Cutter,
    engagement: Engagement,
    depth_m: f64,
) -> MillingParameters {
    MillingParameters {
        cutter,
        coefficients: aluminium(),
        stock: engagement.stock(&cutter, depth_m),
        feed_per_tooth_m: 0.05e-3,
        regeneration: true,
        steady_displacement_m: Vector3::zeros(),
        passes: 3 * cutter.teeth,
        slice_lag_rad: 0.01,
    }
}

fn still(rotation_rad: f64) -> ToolState {
    ToolState {
        rotation_rad,
        displacement_m: Vector3::zeros(),
        ..ToolState::default()
    }
}

/// Mean force over a revolution against the closed form, all three components, with helix and edge
/// forces. With runout the edges do not rub where a tooth that stands back misses its thin
/// first and last chips, so that this case goes without edge forces: what one tooth leaves the next
/// one takes. The closed form takes chips as linear in the feed; true arcs differ by c/2r of the
/// force, here 0.03 %, which is ten times as much of a component in which tangential and radial
/// parts nearly cancel.
#[test]
fn verify_mean_force_over_a_revolution() {
    let engagements = [
        Engagement::SLOT,
        Engagement::down(5e-3, 16e-3).expect("partial"),
        Engagement::up(8e-3, 16e-3).expect("partial"),
        Engagement::down(12e-3, 16e-3).expect("partial"),
    ];
    for engagement in engagements {
        for (teeth, helix_deg, runout_m) in [(2, 0.0, 0.0), (4, 30.0, 0.0), (3, 40.0, 1e-6)] {
            let cutter = Cutter {
                helix_angle_rad: f64::to_radians(helix_deg),
                runout: Runout {
                    offset_m: runout_m,
                    angle_rad: 0.4,
                },
                ..Cutter::straight(8e-3, teeth)
            };
            let mut p = parameters(cutter, engagement, 6e-3);
            p.feed_per_tooth_m = 5e-6;
            if runout_m > 0.0 {
                p.coefficients.edge_tangential_n_per_m = 0.0;
                p.coefficients.edge_radial_n_per_m = 0.0;
                p.coefficients.edge_axial_n_per_m = 0.0;
            }
            let cut = MillingCut::new(p, None);
            let samples = 3600;
            let mean = (0..samples)
                .map(|i| TAU * (f64::from(i) + 0.5) / f64::from(samples))
                .map(|rotation| cut.evaluate(&still(rotation)).force_on_tool_n)
                .sum::<Vector3<f64>>()
                / f64::from(samples);
            let expected = NominalCut {
                cutter,
                coefficients: p.coefficients,
                engagement,
                axial_depth_m: 6e-3,
                feed_per_tooth_m: p.feed_per_tooth_m,
            }
            .average_force_n();
            for axis in 0..3 {
                assert!(
                    (mean[axis] / expected[axis] - 1.0).abs() <= 5e-3,
                    "{engagement:?}, {teeth} teeth, {helix_deg} deg: {mean} instead of {expected}"
                );
            }
        }
    }
}

/// At any angle, too, it is the nominal cut that a still tool meets.
#[test]
fn verify_force_at_an_angle_is_the_nominal_one() {
    let cutter = Cutter {
        helix_angle_rad: 0.5,
        ..Cutter::straight(8e-3, 4)
    };
    let mut p = parameters(cutter, Engagement::SLOT, 6e-3);
    p.feed_per_tooth_m = 5e-6;
    p.slice_lag_rad = 1e-3;
    let cut = MillingCut::new(p, None);
    let nominal = NominalCut {
        cutter,
        coefficients: p.coefficients,
        engagement: Engagement::SLOT,
        axial_depth_m: 6e-3,
        feed_per_tooth_m: p.feed_per_tooth_m,
    };
    for i in 0..100 {
        let rotation = 0.0637 * f64::from(i);
        let loads = cut.evaluate(&still(rotation));
        let expected = nominal.force_n(rotation);
        assert!((loads.force_on_tool_n - expected).norm() < 2e-3 * expected.norm());
        // The spindle brakes with the tangential force at the radius.
        assert!(loads.moment_on_tool_n_m.z > 0.0);
    }
}

/// A slot by one tooth without helix at φ = 90°: chip c plus what the tool has moved ahead since
/// the last pass, and whatever earlier passes left standing if the last one had drawn back further.
#[test]
fn verify_chip_after_passes_that_drew_back() {
    let mut p = parameters(Cutter::straight(8e-3, 1), Engagement::SLOT, 1e-3);
    p.passes = 4;
    let c = p.feed_per_tooth_m;
    let run = |depths: [f64; 4], now: f64| {
        let mut cut = MillingCut::new(p, None);
        for i in 0..1600 {
            let rotation = TAU * f64::from(i) / 400.0;
            let pass = (i / 400) as usize;
            cut.commit(&ToolState {
                rotation_rad: rotation,
                displacement_m: Vector3::new(depths[pass], 0.0, 0.0),
                ..ToolState::default()
            });
        }
        let state = ToolState {
            rotation_rad: 4.0 * TAU + FRAC_PI_2,
            displacement_m: Vector3::new(now, 0.0, 0.0),
            ..ToolState::default()
        };
        let before = cut.clone();
        let loads = cut.evaluate(&state);
        assert_eq!(before, cut, "evaluating changes nothing");
        loads.thickest_chip_m
    };
    let close = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12, "{found}");
    close(run([0.0; 4], 0.0), c);
    close(run([0.0; 4], 0.3 * c), 1.3 * c);
    close(run([0.0, 0.0, 0.0, 0.3 * c], 0.0), 0.7 * c);
    // The last pass drew back by 1.5 c and cut nothing: two feeds and no more are left.
    close(run([0.0, 0.0, 0.0, -1.5 * c], 0.0), 2.0 * c);
    // Two passes missed, and one that had dug 2.4 c deep.
    close(run([0.0, 0.0, -3.0 * c, -3.0 * c], 0.0), 3.0 * c);
    close(run([0.0, 2.4 * c, 0.0, 0.0], 0.0), 0.6 * c);
    close(run([0.0, 3.5 * c, 0.0, 0.0], 0.0), 0.0);
}

/// Teeth meet the nominal surface: the memory has no part, the tool's own displacement has.
#[test]
fn verify_without_regeneration_the_surface_is_nominal() {
    let mut p = parameters(Cutter::straight(8e-3, 2), Engagement::SLOT, 1e-3);
    p.regeneration = false;
    let mut cut = MillingCut::new(p, None);
    for i in 0..4000 {
        cut.commit(&ToolState {
            rotation_rad: 0.005 * f64::from(i),
            displacement_m: Vector3::new(2e-5 * (0.3 * f64::from(i)).sin(), 1e-5, 0.0),
            ..ToolState::default()
        });
    }
    for angle in [0.4, 1.2, FRAC_PI_2, 2.6] {
        let d = Vector3::new(7e-6, -4e-6, 0.0);
        let loads = cut.evaluate(&ToolState {
            rotation_rad: 4.0 * TAU + angle,
            displacement_m: d,
            ..ToolState::default()
        });
        let expected = (p.feed_per_tooth_m + d.x) * angle.sin() + d.y * angle.cos();
        // Arcs: (c cos φ)²/2r, 0.16 µm at most.
        assert!((loads.thickest_chip_m - expected).abs() < 2.1e-7);
    }
}

/// Runout larger than the feed: one of two teeth does not cut, the other takes the feed of
/// both.
#[test]
fn verify_runout_takes_teeth_out_of_the_cut() {
    let chips = |offset_m: f64| {
        let cutter = Cutter {
            runout: Runout {
                offset_m,
                angle_rad: 0.0,
            },
            ..Cutter::straight(8e-3, 2)
        };
        let p = parameters(cutter, Engagement::SLOT, 1e-3);
        let cut = MillingCut::new(p, None);
        [0.0, PI].map(|turned| {
            cut.evaluate(&still(4.0 * PI + FRAC_PI_2 + turned))
                .thickest_chip_m
        })
    };
    let c = 0.05e-3;
    let [first, second] = chips(0.01e-3);
    assert!((first - (c + 0.02e-3)).abs() < 1e-12 && (second - (c - 0.02e-3)).abs() < 1e-12);
    let [first, second] = chips(0.04e-3);
    assert!((first - 2.0 * c).abs() < 1e-12 && second == 0.0);
}

/// `docs/physics/milling_forces.md`, Floor: a tool that sinks into a slot's floor meets ∂F/∂z =
/// (f_rev/4) (−K_rc, K_tc) per depth, at once and whatever the depth of cut.
#[test]
fn verify_floor_depth_feedback() {
    // A large cutter, on which arcs differ from the formula's linear chips by c/2r = 0.1 % only.
    let mut p = parameters(Cutter::straight(50e-3, 4), Engagement::SLOT, 0.3e-3);
    p.coefficients.edge_tangential_n_per_m = 0.0;
    p.coefficients.edge_radial_n_per_m = 0.0;
    p.feed_per_tooth_m = 0.1e-3;
    let mean = |z: f64| {
        let cut = MillingCut::new(p, None);
        let forces = (0..3600).map(|i| {
            let state = ToolState {
                rotation_rad: TAU * (f64::from(i) + 0.5) / 3600.0,
                displacement_m: Vector3::new(0.0, 0.0, z),
                ..ToolState::default()
            };
            cut.evaluate(&state).force_on_tool_n
        });
        forces.sum::<Vector3<f64>>() / 3600.0
    };
    let per_depth = (mean(-1e-5) - mean(1e-5)) / 2e-5;
    let f_rev = 0.4e-3;
    let expected = (
        -0.25 * f_rev * p.coefficients.radial_pa,
        0.25 * f_rev * p.coefficients.tangential_pa,
    );
    assert!((per_depth.x / expected.0 - 1.0).abs() < 5e-3, "{per_depth}");
    assert!((per_depth.y / expected.1 - 1.0).abs() < 5e-3, "{per_depth}");
    // A tool lifted off meets nothing.
    assert_eq!(mean(0.4e-3), Vector3::zeros());
}

/// A tool that enters the stock from its side: the first chip is where the stock begins.
#[test]
fn verify_teeth_meet_nothing_before_the_stock() {
    let mut p = parameters(Cutter::straight(8e-3, 2), Engagement::SLOT, 1e-3);
    p.stock.x_min_m = 8e-3 + 10.25 * p.feed_per_tooth_m;
    let cut = MillingCut::new(p, None);
    let chip = |pass: i32| {
        let turned = PI * f64::from(pass) + FRAC_PI_2;
        cut.evaluate(&still(turned)).thickest_chip_m
    };
    // The nominal tip at the apex of pass n is at r + c (n + 1/2).
    assert_eq!(chip(9), 0.0);
    assert!((chip(10) - 0.25 * p.feed_per_tooth_m).abs() < 1e-12);
    assert!((chip(11) - p.feed_per_tooth_m).abs() < 1e-12);
}

/// What worn flanks add to the force on a tool that moves, meaned over a revolution and over both
/// senses of a velocity, is the averaged cut's part that follows velocity; helix and tangential
/// friction included. A tooth that moves inwards is free.
#[test]
fn verify_worn_flanks_resist_the_velocity() {
    let (spindle_rad_s, depth_m) = (TAU * 10.0, 3e-3);
    let velocity = Vector3::new(2e-3, -1e-3, 0.7e-3);
    let engagements = [
        Engagement::SLOT,
        Engagement::down(5e-3, 16e-3).expect("partial"),
    ];
    for (engagement, (helix_angle_rad, teeth)) in engagements.into_iter().zip([(0.5, 3), (0.0, 1)])
    {
        let cutter = Cutter {
            helix_angle_rad,
            flank: Flank::worn(4e13, 0.15e-3, 0.3),
            ..Cutter::straight(8e-3, teeth)
        };
        let cut = MillingCut::new(parameters(cutter, engagement, depth_m), None);
        let samples = 1440;
        let mut mean = Vector3::zeros();
        for i in 0..samples {
            let still = still(TAU * f64::from(i) / f64::from(samples) + 1e-3);
            let moving = |sense: f64| ToolState {
                displacement_m_per_rad: velocity * sense / spindle_rad_s,
                ..still
            };
            let [out, back, rested] = [moving(1.0), moving(-1.0), still]
                .map(|state| cut.evaluate(&state).force_on_tool_n);
            if helix_angle_rad == 0.0 && cutter.teeth == 1 {
                assert!(out == rested || back == rested);
            }
            mean += 0.5 * (out - back) / f64::from(samples);
        }
        let nominal = NominalCut {
            cutter,
            coefficients: aluminium(),
            engagement,
            axial_depth_m: depth_m,
            feed_per_tooth_m: 0.05e-3,
        };
        let matrix = DirectionalMatrix::from(&nominal);
        let averaged = matrix.averaged(cutter.tooth_period_s(spindle_rad_s));
        let expected = averaged.on_rate_pa_s * velocity * depth_m;
        assert!(
            (mean - expected).norm() < 3e-3 * expected.norm(),
            "{mean} {expected}"
        );
        assert!(expected.dot(&velocity) < 0.0);
    }
}
