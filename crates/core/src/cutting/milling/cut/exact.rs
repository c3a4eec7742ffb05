//! Chatter of one mode against a solver that keeps the teeth's paths in the workpiece, point by
//! point, and cuts the ray with the straight lines between them.

use super::tests::parameters;
use super::*;
use crate::cutting::chamfer::CuttingCoefficients;
use crate::cutting::milling::cutter::Cutter;
use crate::cutting::milling::engagement::Engagement;
use nalgebra::Vector3;
use std::f64::consts::PI;

const RADIUS_M: f64 = 10e-3;
const FEED_M: f64 = 0.1e-3;
const PERIOD_S: f64 = 30.0 / 7000.0;
const MASS_KG: f64 = 0.03993;
const OMEGA_RAD_S: f64 = TAU * 922.0;
const ZETA: f64 = 0.011;
const TANGENTIAL_PA: f64 = 600e6;
const RADIAL_PA: f64 = 200e6;
const IMMERSION: f64 = 0.3;
const PASSES: usize = 4;

/// Deflection along the feed over time, one value a step.
type Motion = Vec<f64>;

/// Two teeth, up-milling, from rest in a surface that a rigid tool left; explicit central
/// differences.
fn exact(depth_m: f64, steps: usize, periods: usize) -> Motion {
    let dt = PERIOD_S / steps as f64;
    let angle = |tooth: i64, step: i64| PI * (step as f64 / steps as f64 - tooth as f64);
    let axis_m = |step: i64, x: f64| FEED_M * step as f64 / steps as f64 + x;
    let mut x = vec![0.0];
    let mut v = 0.0;
    for now in 0..(periods * steps) as i64 {
        let deflection = |step: i64| if step < 0 { 0.0 } else { x[step as usize] };
        let centre_x = axis_m(now, deflection(now));
        let mut force = 0.0;
        // The tooth between entry (0) and half a turn; its angle, not that of any turn.
        let tooth = now.div_euclid(steps as i64);
        let phi = angle(tooth, now);
        let (sin, cos) = phi.sin_cos();
        let inner = (RADIUS_M * (1.0 - 2.0 * IMMERSION)) / cos;
        if cos > 0.0 && inner < RADIUS_M {
            let mut surface: f64 = 0.0;
            for m in 1..=PASSES as i64 {
                // In axes along the ray and across it, about the axis of now.
                let tip = |step: i64| {
                    let a = angle(tooth - m, step);
                    let px = axis_m(step, deflection(step)) + RADIUS_M * a.sin() - centre_x;
                    let py = RADIUS_M * a.cos();
                    (px * sin + py * cos, px * cos - py * sin)
                };
                let middle = now - m * steps as i64;
                let window = (steps / 6) as i64;
                let mut last = tip(middle - window);
                for step in middle - window + 1..=middle + window {
                    let next = tip(step);
                    if (last.1 <= 0.0) != (next.1 <= 0.0) {
                        let share = last.1 / (last.1 - next.1);
                        surface = surface.max(last.0 + share * (next.0 - last.0));
                    }
                    last = next;
                }
            }
            let chip = (RADIUS_M - surface.max(inner)).max(0.0);
            force = -depth_m * chip * (TANGENTIAL_PA * cos + RADIAL_PA * sin);
        }
        let here = x[now as usize];
        let rate = force / MASS_KG - OMEGA_RAD_S * OMEGA_RAD_S * here;
        // Damping implicit in the velocity at the middle of the step.
        let damped = ZETA * OMEGA_RAD_S * dt;
        v = ((1.0 - damped) * v + dt * rate) / (1.0 + damped);
        x.push(here + dt * v);
    }
    x
}

fn with_the_program(depth_m: f64, steps: usize, periods: usize) -> Motion {
    let cutter = Cutter::straight(RADIUS_M, 2);
    let up = Engagement::up(IMMERSION * 2.0 * RADIUS_M, 2.0 * RADIUS_M).expect("partial");
    let p = MillingParameters {
        coefficients: CuttingCoefficients {
            tangential_pa: TANGENTIAL_PA,
            radial_pa: RADIAL_PA,
            axial_pa: 0.0,
            edge_tangential_n_per_m: 0.0,
            edge_radial_n_per_m: 0.0,
            edge_axial_n_per_m: 0.0,
        },
        feed_per_tooth_m: FEED_M,
        passes: PASSES,
        ..parameters(cutter, up, depth_m)
    };
    let dt = PERIOD_S / steps as f64;
    let mut cut = MillingCut::new(p, None);
    let (mut x, mut v) = (0.0, 0.0);
    let mut motion = vec![x];
    for i in 0..periods * steps {
        let state = |t: f64, x: f64| ToolState {
            rotation_rad: PI * t / PERIOD_S,
            displacement_m: Vector3::new(x, 0.0, 0.0),
            ..ToolState::default()
        };
        let t = i as f64 * dt;
        cut.commit(&state(t, x));
        let rate = |t: f64, x: f64, v: f64| {
            let loads = cut.evaluate(&state(t, x));
            assert!(loads.thickest_chip_m <= RADIUS_M);
            let damping = 2.0 * ZETA * OMEGA_RAD_S * v + OMEGA_RAD_S * OMEGA_RAD_S * x;
            (v, loads.force_on_tool_n.x / MASS_KG - damping)
        };
        let k1 = rate(t, x, v);
        let k2 = rate(t + 0.5 * dt, x + 0.5 * dt * k1.0, v + 0.5 * dt * k1.1);
        let k3 = rate(t + 0.5 * dt, x + 0.5 * dt * k2.0, v + 0.5 * dt * k2.1);
        let k4 = rate(t + dt, x + dt * k3.0, v + dt * k3.1);
        x += dt / 6.0 * (k1.0 + 2.0 * k2.0 + 2.0 * k3.0 + k4.0);
        v += dt / 6.0 * (k1.1 + 2.0 * k2.1 + 2.0 * k3.1 + k4.1);
        motion.push(x);
    }
    motion
}

/// Half of what lies between the extremes, in windows of ten tooth periods (some 42 ms).
fn amplitudes_m(motion: &Motion, steps: usize) -> Vec<f64> {
    let windows = motion[1..].chunks_exact(10 * steps);
    windows
        .map(|part| {
            let high = part.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let low = part.iter().copied().fold(f64::INFINITY, f64::min);
            0.5 * (high - low)
        })
        .collect()
}

fn rms(motion: &Motion) -> f64 {
    (motion.iter().map(|x| x * x).sum::<f64>() / motion.len() as f64).sqrt()
}

/// Beyond the limit (1.072 mm) and below it, teeth in and out of the cut: the first five windows
/// and the root mean square over 0.4 s.
#[test]
fn verify_chatter_of_one_mode_against_paths_in_the_workpiece() {
    for depth_m in [1.15e-3, 1.0e-3] {
        let periods = 100;
        let [coarse, fine] = [1000, 2000].map(|steps| exact(depth_m, steps, periods));
        let own = with_the_program(depth_m, 200, periods);
        let [coarse_m, fine_m] = [(&coarse, 1000), (&fine, 2000)].map(|(m, n)| amplitudes_m(m, n));
        let own_m = amplitudes_m(&own, 200);
        for (name, all) in [("1000", &coarse_m), ("2000", &fine_m), ("own", &own_m)] {
            let um: Vec<String> = all.iter().map(|a| format!("{:.1}", a * 1e6)).collect();
            println!("{depth_m} {name}: {}", um.join(" "));
        }
        let (own_rms, fine_rms, coarse_rms) = (rms(&own), rms(&fine), rms(&coarse));
        println!(
            "rms {:.2} {:.2} {:.2} um",
            own_rms * 1e6,
            fine_rms * 1e6,
            coarse_rms * 1e6
        );
        for i in 0..5 {
            assert!(
                (coarse_m[i] / fine_m[i] - 1.0).abs() < 0.02,
                "not converged"
            );
            assert!((own_m[i] / fine_m[i] - 1.0).abs() < 0.05, "window {i}");
        }
        assert!((own_rms / fine_rms - 1.0).abs() < 0.1);
    }
}
