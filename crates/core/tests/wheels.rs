//! Soft wheels on faces, held against contacts that Python solves by other methods
//! (`tests/reference/wheels.py`), drawn from a seed.

use nalgebra::Isometry2;
use truecut_core::wheel::belt::BeltWheel;
use truecut_core::wheel::face::Face;
use truecut_core::wheel::patch::Sliding;
use truecut_core::wheel::pneumatic::PneumaticWheel;
use truecut_core::wheel::quadrature::Quadrature;

/// Numbers of the rows of one kind.
fn rows(kind: &str) -> Vec<Vec<f64>> {
    let of_kind = |line: &str| {
        let numbers = line.strip_prefix(kind)?.strip_prefix(',')?;
        Some(numbers.split(',').map(|x| x.parse().unwrap()).collect())
    };
    include_str!("wheels.csv")
        .lines()
        .filter_map(of_kind)
        .collect()
}

fn pneumatic(row: &[f64]) -> PneumaticWheel {
    PneumaticWheel {
        radius_m: row[0],
        shell_thickness_m: row[1],
        poisson: row[2],
        youngs_modulus_pa: row[3],
        pressure_pa: row[4],
        damping_pa_s_per_m: 0.0,
    }
}

/// Slack, the layer's force; under tension a local bed stands for the rubber, which counts the more
/// the stiffer the belt is beside the rubber under the patch, N/(E* b).
#[test]
fn verify_belts_on_bonded_rubber() {
    let rows = rows("belt");
    assert_eq!(rows.len(), 16);
    for row in rows {
        let wheel = BeltWheel {
            radius_m: row[0],
            width_m: 1.0,
            contact_modulus_pa: row[3],
            poisson: row[2],
            rubber_m: row[1],
            tension_n: row[4],
            damping_pa_s_per_m: 0.0,
        };
        let off = wheel.normal_force_n(row[5], row[0]) / row[6] - 1.0;
        let patch = wheel.patch(&wheel.layer(), row[5], row[0]);
        let belt = row[4] / (row[3] * patch.undeformed_half_length_m());
        assert!(off.abs() < 2e-4 + 0.3 * belt, "{row:?}: {off} {belt}");
    }
}

#[test]
fn verify_shells_under_air() {
    let rows = rows("shell");
    assert_eq!(rows.len(), 12);
    for row in rows {
        let off = pneumatic(&row).normal_force_n(row[5]) / row[6] - 1.0;
        assert!(off.abs() < 2e-3, "{row:?}: {off}");
    }
}

/// The grid of the obstacle problem has an error of its own, of up to half of a per cent.
#[test]
fn verify_patches_that_an_edge_cuts() {
    let rows = rows("edge");
    assert_eq!(rows.len(), 18);
    let face = Face::rectangle(1.0, 1.0).unwrap();
    let offs = rows.iter().map(|row| {
        let wheel = pneumatic(row);
        let patch = wheel.patch(&wheel.shell(), row[5]);
        let pose = Isometry2::translation(row[6] - 1.0, -0.5);
        let (rest, rule) = (Sliding::default(), Quadrature::new(24));
        let loads = patch.loads(&face, &pose, &rest, &rule, |_| {});
        loads.normal_n / row[7] - 1.0
    });
    let offs: Vec<f64> = offs.collect();
    println!("{offs:.4?}");
    assert!(offs.iter().all(|off| off.abs() < 0.01), "{offs:.4?}");
}
