//! Modes of a tool from band-limited FRFs at its tip, and the limits that follow from them.

use std::f64::consts::TAU;

use nalgebra::{Complex, Vector3};
use truecut_arm::{FrameId, LinearArm, Load, Robot};
use truecut_core::chatter::limit::{LimitSearch, first_limit};
use truecut_core::chatter::spectral_elements::SpectralElements;
use truecut_core::chatter::{AttachedMode, AttachedModes, DirectionalMatrix, in_axes};
use truecut_core::cutting::milling::engagement::Engagement;
use truecut_discrepancy::identify::frf::Frf;
use truecut_discrepancy::identify::modal;
use truecut_discrepancy::identify::tool::{ToolError, ToolMode, tool_modes};
use truecut_scenario::RobotSpec;
use truecut_scenario::identification::{Axes, HammerPoint, MotionKind};
use truecut_sim::elastic::ElasticArm;

use crate::support::repository;

const POSTURE: [f64; 6] = [-0.8444, 0.9568, 0.1197, 0.9453, 1.8750, -0.3831];
const BAND_HZ: [f64; 2] = [500.0, 1800.0];
/// Standard deviation of the FRFs' noise over their largest value.
const NOISE: f64 = 2e-3;

fn robot_spec() -> RobotSpec {
    let folder = repository().join("assets/robots/irb6600_175_255");
    RobotSpec {
        urdf: folder.join("robot.urdf"),
        config: Some(folder.join("milling.toml")),
        posture_rad: POSTURE.to_vec(),
        gravity: false,
        ..RobotSpec::NONE
    }
}

fn robot() -> Robot {
    let spec = robot_spec();
    Robot::load(&spec.urdf, spec.config.as_deref(), None).expect("the asset loads")
}

fn mode(hz: f64, ratio: f64, n_per_um: f64, direction: [f64; 3]) -> AttachedMode {
    AttachedMode::new(hz, ratio, 1e6 * n_per_um, direction)
}

/// In the tool frame; the last one lies above the band.
fn truth() -> Vec<AttachedMode> {
    vec![
        mode(980.0, 0.03, 10.0, [1.0, 0.2, 0.0]),
        mode(1130.0, 0.025, 12.0, [-0.2, 1.0, 0.0]),
        mode(3600.0, 0.02, 150.0, [1.0, 1.0, 0.0]),
    ]
}

/// What a hammer would find at the tip along two directions of the tool frame.
fn frf(arm: &LinearArm, axes: &[Vector3<f64>; 2], [from, to]: [usize; 2]) -> Frf {
    let point = |axis: usize| HammerPoint {
        frame: FrameId::Tool,
        offset_m: [0.0; 3],
        direction: if axis == 0 {
            [1.0, 0.0, 0.0]
        } else {
            [0.0, 1.0, 0.0]
        },
    };
    let frequency_hz: Vec<f64> = (0..651).map(|i| BAND_HZ[0] + 2.0 * f64::from(i)).collect();
    let exact = frequency_hz.iter().map(|hz| {
        let omega = TAU * hz;
        let dynamic = (arm.stiffness).zip_zip_map(&arm.mass, &arm.damping, |k, m, d| {
            Complex::new(k - omega * omega * m, omega * d)
        });
        let [forced, seen] = [from, to].map(|axis| {
            let along = arm.tip_jacobian.transpose() * axes[axis];
            along.map(|v| Complex::new(v, 0.0))
        });
        seen.dot(&dynamic.lu().solve(&forced).expect("damped"))
    });
    let mut value: Vec<Complex<f64>> = exact.collect();
    let size = value.iter().fold(0.0_f64, |most, h| most.max(h.norm()));
    // A generator of its own (Lehmer's), so that the draws are the same everywhere.
    let mut state = 12_345 + 7919 * (3 * from + to) as u64;
    let mut draw = || {
        let mut sum = 0.0;
        for _ in 0..12 {
            state = state * 48_271 % 2_147_483_647;
            sum += state as f64 / 2_147_483_647.0;
        }
        sum - 6.0
    };
    for h in &mut value {
        *h += Complex::new(NOISE * size * draw(), NOISE * size * draw());
    }
    Frf {
        source: format!("frf_{from}{to}.csv"),
        frequency_hz,
        value,
        noise: None,
        coherence: None,
        kind: MotionKind::Displacement,
        excitation: point(from),
        response: point(to),
        notes: Vec::new(),
    }
}

fn measured(pairs: &[[usize; 2]]) -> Vec<Frf> {
    let robot = robot();
    let turn = robot.tool_axes(&POSTURE);
    let arm = robot
        .linearised(&POSTURE, FrameId::Tool, &Load::none())
        .expect("stiff");
    let in_world: Vec<AttachedMode> = truth().iter().map(|mode| mode.turned(&turn)).collect();
    let arm = arm.with_tool(&in_world).expect("light");
    let axes = [0, 1].map(|axis| turn.column(axis).into_owned());
    pairs.iter().map(|pair| frf(&arm, &axes, *pair)).collect()
}

fn found(frfs: &[Frf]) -> Result<Vec<ToolMode>, ToolError> {
    let keys: Vec<String> = (0..frfs.len())
        .map(|index| format!("modes.frf.{index}"))
        .collect();
    let arm = ElasticArm::load(&robot_spec()).expect("the asset loads");
    let fit = modal::fit(frfs, BAND_HZ, None, 0.0).expect("modes show");
    tool_modes(frfs, &keys, &fit, &arm, Axes::Tool)
}

/// Limits in a slot from 3000 to 20 000 rpm, m.
fn limits(tool: Vec<AttachedMode>) -> Vec<f64> {
    let robot = robot();
    let attached = AttachedModes {
        tool,
        ..AttachedModes::default()
    };
    let modes = robot.cutting_modes(&POSTURE, &attached).expect("light");
    let modes = in_axes(&modes, &robot.tool_axes(&POSTURE));
    let process = DirectionalMatrix::planar(2, 6e8, 1.0 / 3.0, Engagement::SLOT);
    let elements = SpectralElements::new(&modes, &process);
    let speeds = (0..35).map(|i| 3000.0 + 500.0 * f64::from(i));
    let limit = |rpm: f64| {
        let search = LimitSearch {
            scan_steps: 200,
            ..LimitSearch::to_depth(20e-3)
        };
        first_limit(&elements, 30.0 / rpm, &search).map_or(f64::INFINITY, |limit| limit.depth_m)
    };
    speeds.map(limit).collect()
}

#[test]
fn verify_limits_from_a_band_limited_frf_are_those_of_the_true_modes() {
    let found = found(&measured(&[[0, 0], [1, 1], [0, 1]])).expect("causal");
    assert_eq!(found.len(), 2, "{found:?}");
    for (mode, truth) in found.iter().zip(truth()) {
        let hz = truth.natural_frequency_rad_s / TAU;
        let along = Vector3::from(mode.direction).dot(&truth.direction).abs();
        println!("{mode:?}");
        assert!((mode.frequency_hz / hz - 1.0).abs() < 2e-3, "{mode:?}");
        assert!(
            (mode.damping_ratio / truth.damping_ratio - 1.0).abs() < 0.02,
            "{mode:?}"
        );
        assert!(
            (mode.stiffness_n_per_m / truth.stiffness_n_per_m - 1.0).abs() < 0.02,
            "{mode:?}"
        );
        assert!(along > 0.999, "{mode:?}");
    }
    let attached = found.iter().map(|one| {
        mode(
            one.frequency_hz,
            one.damping_ratio,
            one.stiffness_n_per_m * 1e-6,
            one.direction,
        )
    });
    let (from_frf, from_truth) = (limits(attached.collect()), limits(truth()));
    let mut worst = 0.0_f64;
    for (a, b) in from_frf.iter().zip(&from_truth) {
        assert!(b.is_finite() && *b < 20e-3, "{b}");
        worst = worst.max((a / b - 1.0).abs());
    }
    println!("limits within {:.2} %", 100.0 * worst);
    assert!(worst < 0.03, "{worst}");
}

#[test]
fn cross_terms_that_are_missing_are_asked_for() {
    let error = found(&measured(&[[0, 0], [1, 1]])).expect_err("no cross term");
    assert!(
        matches!(&error, ToolError::Data(data) if data.key == "modes.tool_modes"),
        "{error}"
    );
    assert!(
        error.to_string().contains("cross terms are missing"),
        "{error}"
    );
}

/// The phase of one FRF the other way round: time would run backwards.
#[test]
fn an_frf_that_is_not_causal_is_refused() {
    let mut frfs = measured(&[[0, 0], [1, 1], [0, 1]]);
    for value in &mut frfs[1].value {
        *value = -*value;
    }
    let error = found(&frfs).expect_err("not passive");
    assert!(
        matches!(&error, ToolError::Data(data) if data.key == "modes.frf.1.file"),
        "{error}"
    );
    assert!(error.to_string().contains("not causal"), "{error}");
}
