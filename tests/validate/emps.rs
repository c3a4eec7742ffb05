//! Diagnosis of one prismatic servo axis: what the frictionless model of the EMPS lacks.

use crate::support::{
    NoData, PUBLISHED_FILTER, data_file, diagnosed, extended, measured, named, relative, residual,
    scenario,
};
use truecut_discrepancy::diagnose::Verdict;
use truecut_scenario::effect::EffectKind;
use truecut_sim::InverseModel;

/// Published: mass 95.1 kg, Coulomb friction 20.4 N, viscous friction 203.5 N s/m in the mean of
/// both directions, which differ. Stribeck's excess gains next to nothing. Published error on the
/// recording with pulses: 5.5 %.
pub fn validate_emps_friction_is_named_and_stribeck_is_not() -> Result<(), NoData> {
    let fitted = data_file("emps/DATA_EMPS.csv")?;
    let held_out = data_file("emps/DATA_EMPS_PULSES.csv")?;
    let nominal = scenario("emps_inverse.toml");
    let answer = diagnosed(&nominal, &fitted);
    assert_eq!(answer.diagnosis.verdict, Verdict::Named);
    let expected = [EffectKind::JointAsymmetricViscous, EffectKind::JointCoulomb];
    let expected: Vec<_> = expected.iter().map(|kind| (*kind, Some(0))).collect();
    assert_eq!(named(&answer), expected);

    let of = |kind: EffectKind| {
        &answer
            .effects
            .iter()
            .find(|e| e.kind == kind)
            .unwrap()
            .values
    };
    let viscous = of(EffectKind::JointAsymmetricViscous);
    let found = [
        ("mass, kg", 95.1 * answer.nominal[0], 95.1),
        ("Coulomb, N", of(EffectKind::JointCoulomb)[0], 20.4),
        ("viscous, N s/m", 0.5 * (viscous[0] + viscous[1]), 203.5),
    ];
    for (what, found, published) in found {
        eprintln!("{what}: {found:.2}, published {published}");
        assert!((found / published - 1.0).abs() < 0.05, "{what}: {found}");
    }
    assert!(
        viscous[1] > 1.3 * viscous[0],
        "the slow direction: {viscous:?}"
    );

    let filter = PUBLISHED_FILTER.map(|(key, value)| (key.to_owned(), value.to_owned()));
    let wide = extended(&nominal.with_overrides(&filter).unwrap(), &answer);
    let test = InverseModel::new(&wide, &measured(&wide, &held_out)).unwrap();
    let all = 0..test.measured().time_s.len();
    let error = relative(&test, 0, &residual(&test, 0, &[]), all);
    eprintln!("held out: {:.2} %", 100.0 * error);
    assert!(error < 0.058, "held out: {error}");
    Ok(())
}
