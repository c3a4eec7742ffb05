use super::*;
use crate::stability::tests::pocket;
use truecut_core::chatter::limit::{LimitSearch, first_limit};

/// Along the pocket's first slot the rim is in stock over half a turn, and the limit is that of
/// a slot with the modes there, by another search.
#[test]
fn verify_limit_in_a_slot_of_the_path() {
    for rpm in ["12000", "9400"] {
        let scenario = pocket(&[("process.path_milling.spindle_rpm", rpm)]);
        let found = path_stability(&scenario, None, 2, &|_| {}).unwrap();
        // N60 leads out of the hole, x from 0 to 14 mm at y = 0.
        let slot = found.places.iter().find(|place| {
            let [x, y, _] = place.place_m;
            (8e-3..11e-3).contains(&x) && y.abs() < 1e-4
        });
        let slot = slot.unwrap();
        assert_eq!(slot.line, Some(8));
        assert!((slot.depth_m - 0.5e-3).abs() < 1e-9, "{}", slot.depth_m);
        let arc = slot.engagement;
        let off_rad = arc
            .entry_rad
            .abs()
            .max((arc.exit_rad - std::f64::consts::PI).abs());
        assert!(off_rad < 0.06, "{arc:?}");

        let ProcessSpec::PathMilling(spec) = &scenario.process else {
            panic!("not along a path");
        };
        let robots = Robots::new();
        let CutPlaces {
            places,
            world_from_work,
        } = in_context(&scenario, &robots, |context| places(spec, context)).unwrap();
        let near = places
            .iter()
            .find(|one| one.along_m == slot.along_m)
            .unwrap();
        let axes = world_from_work.rotation.to_rotation_matrix();
        let robot = robots.robot(&scenario.robot).unwrap();
        // 20 mm/s, two teeth.
        let slot_feed_m = 20e-3 * spec.cutter.tooth_period_s(slot.spindle_rad_s);
        let modes = modes_in_cut(&robot, &near.posture, axes.matrix(), &spec.attached).unwrap();
        let process = DirectionalMatrix {
            teeth: 2,
            coefficients: spec.coefficients,
            engagement: Engagement::SLOT,
            flank: spec.cutter.flank,
            radius_m: 6e-3,
            feed_per_tooth_m: f64::INFINITY,
        };
        let nominal = NominalCut {
            cutter: spec.cutter,
            coefficients: spec.coefficients,
            engagement: Engagement::SLOT,
            axial_depth_m: 0.5e-3,
            feed_per_tooth_m: slot_feed_m,
        };
        let elements = SpectralElements::new(&modes, &process).with_floor(&nominal);
        let period_s = spec.cutter.tooth_period_s(slot.spindle_rad_s);
        let limit = first_limit(&elements, period_s, &LimitSearch::to_depth(1.5e-3));
        match (slot.limit_m, limit) {
            (Some(found_m), Some(limit)) => {
                let off = found_m / limit.depth_m - 1.0;
                assert!(off.abs() < 0.02, "{rpm}: {found_m} {limit:?}");
            }
            (found, limit) => assert_eq!(found, limit.map(|limit| limit.depth_m), "{rpm}"),
        }
    }
}

/// Round the pocket lines come in their order, and each is a piece.
#[test]
fn pieces_of_the_path_are_its_lines() {
    let found = path_stability(&pocket(&[]), None, 2, &|_| {}).unwrap();
    let lines: Vec<_> = found.segments.iter().filter_map(|one| one.line).collect();
    // N60 to N100, the arc of N80 as one.
    assert_eq!(lines, [8, 9, 10, 11, 12]);
    for pair in found.segments.windows(2) {
        assert!(pair[0].to_m < pair[1].from_m + 1e-9);
    }
}
