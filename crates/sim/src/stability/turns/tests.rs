use super::*;
use crate::stability::path_stability;
use crate::stability::tests::pocket;

/// What is told of a posture is what the scenario has that takes it by the keys that are told.
#[test]
fn margins_of_the_best_posture_are_those_of_the_scenario_that_takes_it() {
    let scenario = pocket(&[]);
    let found = path_postures(&scenario, &|_| {}).unwrap();
    let best = &found.turns[found.best];
    let others = found.turns.iter().chain(&found.own);
    assert!(others.clone().count() > 20);
    for turn in others {
        let small = 1.0 + 1e-9;
        let is_as_far = turn.least().1 * 0.98 <= best.least().1 * small || best.least().1 >= 2.0;
        assert!(is_as_far, "{turn:?}");
    }
    let taken = scenario.with_overrides(&found.keys).unwrap();
    let of_taken = path_stability(&taken, None, 2, &|_| {}).unwrap();
    let mut compared = 0;
    for place in &found.best_places {
        let near = of_taken.places.iter().min_by(|a, b| {
            let off = |one: &PathPlace| (one.along_m - place.along_m).abs();
            off(a).total_cmp(&off(b))
        });
        let near = near.unwrap();
        // The strongest place of a stretch may be another one by a step of the grid.
        if near.line == place.line && (near.along_m - place.along_m).abs() < 2e-4 {
            let off = near.margin() / place.margin() - 1.0;
            assert!(off.abs() < 0.03, "{near:?} {place:?}");
            compared += 1;
        }
    }
    assert!(2 * compared > found.best_places.len(), "{compared}");
}
