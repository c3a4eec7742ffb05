//! Teeth that runout lifts out of the cut, against a sum over surfaces.

use super::*;
use crate::cutting::milling::cutter::Runout;
use crate::cutting::milling::examples::aluminium;

/// Force and moment over a revolution, tooth by tooth and angle by angle: where the outermost of
/// the surfaces of `turns` revolutions before lies, and what stands beyond it. No rule of when a
/// tooth cuts.
fn summed(cut: &NominalCut, turns: usize) -> (Vector3<f64>, Vector3<f64>) {
    let (angles, teeth) = (40_000, cut.cutter.teeth);
    let (mut force, mut moment) = (Vector3::zeros(), Vector3::zeros());
    let Engagement {
        entry_rad,
        exit_rad,
    } = cut.engagement;
    let step = (exit_rad - entry_rad) / f64::from(angles);
    let radius_m = |tooth: usize| {
        let runout = cut.cutter.runout;
        let behind = TAU * (tooth % teeth) as f64 / teeth as f64;
        cut.cutter.radius_m + runout.offset_m * (runout.angle_rad + behind).cos()
    };
    for tooth in 0..teeth {
        for i in 0..angles {
            let angle = entry_rad + step * (f64::from(i) + 0.5);
            let (sin, cos) = angle.sin_cos();
            let surface = (1..=turns * teeth)
                .map(|p| {
                    radius_m(tooth + turns * teeth - p) - p as f64 * cut.feed_per_tooth_m * sin
                })
                .fold(f64::NEG_INFINITY, f64::max);
            let chip = radius_m(tooth) - surface;
            if chip <= 0.0 {
                continue;
            }
            let (b, r) = (cut.axial_depth_m, cut.cutter.radius_m);
            let sizes = cut.coefficients.forces_n(chip * b, b);
            let one = on_tool_n(angle, sizes.tangential_n, sizes.radial_n, sizes.axial_n);
            force += one * (step / TAU);
            moment += Vector3::new(r * sin, r * cos, 0.5 * b).cross(&one) * (step / TAU);
        }
    }
    (force, moment)
}

/// Two to five teeth, offsets from a tenth of the feed per tooth to three of it, so that teeth miss
/// parts of their arc, or all of it. The sum meets an entry to 1/40 000 of the engagement.
#[test]
fn verify_mean_force_with_teeth_that_are_lifted_out() {
    let engagements = [
        Engagement::SLOT,
        Engagement::down(5e-3, 16e-3).expect("partial"),
        Engagement::up(11e-3, 16e-3).expect("partial"),
    ];
    let mut largest = 0.0_f64;
    for (i, engagement) in engagements.into_iter().enumerate() {
        for teeth in 2..=5 {
            for share in [0.1, 0.6, 3.0] {
                let feed_per_tooth_m = 50e-6;
                let cut = NominalCut {
                    cutter: Cutter {
                        runout: Runout {
                            offset_m: share * feed_per_tooth_m,
                            angle_rad: 0.4 + 0.9 * i as f64,
                        },
                        ..Cutter::straight(8e-3, teeth)
                    },
                    coefficients: aluminium(),
                    engagement,
                    axial_depth_m: 2e-3,
                    feed_per_tooth_m,
                };
                let (force, moment) = summed(&cut, 2);
                let (ours, ours_moment) = (cut.average_force_n(), cut.average_moment_n_m());
                assert!(
                    (ours - force).norm() < 1e-4 * force.norm(),
                    "{ours} {force}"
                );
                let apart = (ours_moment - moment).norm();
                assert!(apart < 2e-4 * moment.norm(), "{ours_moment} {moment}");
                let true_running = NominalCut {
                    cutter: Cutter::straight(8e-3, teeth),
                    ..cut
                };
                let all_cut = true_running.average_force_n();
                largest = largest.max((ours - all_cut).norm() / ours.norm());
            }
        }
    }
    assert!(largest > 0.2, "teeth are lifted out: {largest}");
}
