//! At edges.

use super::shared::{column, scalar};
use super::support::run;

/// A raster along the edges of a small face.
const AT_EDGES: [(&str, &str); 4] = [
    ("face.length_mm", "30"),
    ("face.width_mm", "20"),
    ("path.inset_mm", "0"),
    ("path.line_spacing_mm", "10"),
];

/// The layer bends round the edge and presses along it; an edge force is there only where an edge
/// is in the patch.
#[test]
fn edges_press_where_they_are_in_the_patch() {
    let recording = run(&AT_EDGES);
    let edge = column(&recording, "polish.edge_force");
    let y = column(&recording, "polish.position_y");
    let x = column(&recording, "polish.position_x");
    let mut on_and_off = (0, 0);
    for row in 0..edge.len() {
        let inside = (x[row].min(30e-3 - x[row])).min(y[row].min(20e-3 - y[row]));
        if inside > 5e-3 {
            assert_eq!(edge[row], 0.0, "row {row}");
            on_and_off.1 += 1;
        } else if inside < 2e-3 {
            assert!(edge[row] > 0.0, "row {row}");
            on_and_off.0 += 1;
        }
    }
    assert!(on_and_off.0 > 500 && on_and_off.1 > 300, "{on_and_off:?}");
}

/// What the exact rule is for, on the arm as it moves in the run, deflected and filtered: nothing
/// moves inward over an edge. A steady turn does so about half of the time.
#[test]
fn exact_rule_leaves_no_inward_edge_on_the_moving_arm() {
    let free = run(&AT_EDGES);
    assert!(scalar(&free, "polish.inward_share") > 0.3);
    let mut exact = AT_EDGES.to_vec();
    exact.push(("precession.rule", "\"exact\""));
    exact.push(("precession.largest_rate_deg_per_s", "230"));
    exact.push(("precession.largest_acceleration_deg_per_s2", "700"));
    let held = run(&exact);
    assert!(scalar(&held, "polish.inward_share") < 1e-3);
    // the loads are the same but for their direction
    let mean = |name: &str, of: &truecut_recording::Recording| {
        let values = column(of, name);
        values.iter().sum::<f64>() / values.len() as f64
    };
    let ratio = mean("polish.edge_force", &held) / mean("polish.edge_force", &free);
    assert!((ratio - 1.0).abs() < 0.05, "{ratio}");
}
