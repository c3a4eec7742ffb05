//! Effects on belt and contact wheel.

use super::shared::{belt, column, run};
use super::support::WHEEL;
use truecut_core::wheel::belt::BeltWheel;
use truecut_recording::Recording;
use truecut_scenario::Scenario;
use truecut_scenario::effect::{Effect, EffectKind, Target};

/// Down onto the first line and along half of it.
fn scenario() -> Scenario {
    belt(&[("run.duration_s".to_owned(), "1.2".to_owned())])
}

fn whole(kind: EffectKind, values: &[f64]) -> Effect {
    Effect {
        kind,
        target: Target::Whole,
        values: values.to_vec(),
    }
}

fn taken_m3(recording: &Recording) -> f64 {
    *column(recording, "belt.removed_volume")
        .last()
        .expect("rows")
}

/// The wheel's law with rubber of the modulus times the factor and the belt's tension as it was,
/// Coulomb's friction with its own; Preston's volume is in proportion, and what is removed does not
/// act back.
#[test]
fn the_run_applies_the_factors_of_a_belt() {
    let pressing = [
        whole(EffectKind::WheelStiffness, &[1.3]),
        whole(EffectKind::WheelFriction, &[1.5]),
    ];
    let removing = [whole(EffectKind::WheelRemoval, &[0.8])];
    let nominal = run(&scenario(), &[]);
    let with = run(&scenario(), &pressing);
    let stiffer = BeltWheel {
        contact_modulus_pa: 1.3 * WHEEL.contact_modulus_pa,
        ..WHEEL
    };
    let normal = column(&with, "belt.normal_force");
    let depth = column(&with, "belt.indentation");
    let friction = column(&with, "belt.friction_run");
    let u = column(&with, "belt.position_u");
    let on_line = (0..normal.len()).filter(|i| depth[*i] > 0.0 && (0.2..0.8).contains(&u[*i]));
    let mut looked_at = 0;
    for row in on_line.step_by(53) {
        let expected = stiffer.normal_force_n(depth[row], stiffer.radius_m);
        let [presses, rubs] = [normal[row] / expected, friction[row] / (0.45 * normal[row])];
        assert!((presses - 1.0).abs() < 2e-3, "{row}: {presses}");
        assert!((rubs - 1.0).abs() < 1e-3, "{row}: {rubs}");
        looked_at += 1;
    }
    assert!(looked_at > 30, "{looked_at}");
    let less = run(&scenario(), &removing);
    assert!((taken_m3(&less) / taken_m3(&nominal) - 0.8).abs() < 1e-12);
}

/// A wheel that runs out reaches in by `C cos φ + S sin φ` more, φ by belt speed over radius, less
/// what the arm gives way.
#[test]
fn verify_an_eccentric_wheel_reaches_in_once_per_revolution() {
    let [c, s] = [2e-5, -3e-5];
    let effects = [whole(EffectKind::WheelEccentricity, &[c, s])];
    let (nominal, with) = (run(&scenario(), &[]), run(&scenario(), &effects));
    // Process X points into the face.
    let given = |recording| column(recording, "tool.displacement_x");
    let depth = |recording| column(recording, "belt.indentation");
    let pairs = depth(&nominal).iter().zip(depth(&with));
    let mut looked_at = 0;
    for (i, (without, eccentric)) in pairs.enumerate() {
        if *without < 5e-5 || *eccentric < 5e-5 {
            continue;
        }
        let phase = 15.0 / WHEEL.radius_m * nominal.time_s[i];
        let beyond = c * phase.cos() + s * phase.sin();
        let off = eccentric - without - (beyond + given(&with)[i] - given(&nominal)[i]);
        assert!(off.abs() < 1e-9, "{i}: {off:.2e}");
        looked_at += 1;
    }
    assert!(looked_at > 300, "{looked_at}");
}
