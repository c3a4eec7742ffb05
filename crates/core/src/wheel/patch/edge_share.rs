//! What part of the line reaction that planes across an edge give the edge bears.
//!
//! The layer curves along the edge on its whole way out, not only where it leaves, and off the face
//! it lifts the layer on it: the layer's equation in two dimensions gives less than planes do. For
//! a straight edge under a point patch on Hertz's bed the ratio depends on two numbers, how much
//! the layer is stretched, `N / 2 R q(u0)`, and where the edge lies. The table is the solution of
//! the obstacle problem (`tests/reference/edge_share.py`), between its nodes linear; for a layer
//! that is stretched more than the last row (it presses 26 times as hard as the bed: a touch) the
//! last row stands. At a corner each side has its own.

/// `√(N/2Rq) / (1 + √(N/2Rq))` of the rows.
const STRETCH: [f64; 8] = [
    0.0, 0.075615, 0.166662, 0.285590, 0.414380, 0.533308, 0.624385, 0.72,
];
/// Distance of the edge from the patch's middle, in half lengths of the undeformed contact, of the
/// columns; positive where the middle is on the face.
const PLACE: [f64; 7] = [
    -0.951362, -0.806526, -0.538903, -0.189238, 0.189238, 0.538903, 0.806526,
];
/// Where an edge bears less than a hundredth of the force, the column beside stands.
const SHARE: [[f64; 7]; 8] = [
    [1.0; 7],
    [0.9812, 0.9878, 0.9905, 0.9925, 0.9928, 0.9918, 0.9873],
    [0.9379, 0.9633, 0.9707, 0.9747, 0.9783, 0.9832, 0.9880],
    [0.8853, 0.9181, 0.9306, 0.9372, 0.9472, 0.9527, 0.9527],
    [0.8284, 0.8594, 0.8744, 0.8811, 0.8953, 0.9063, 0.9063],
    [0.8029, 0.8076, 0.8226, 0.8240, 0.8394, 0.8526, 0.8526],
    [0.7624, 0.7690, 0.7762, 0.7778, 0.7941, 0.7941, 0.7941],
    [0.7240, 0.7197, 0.7227, 0.7227, 0.7385, 0.7385, 0.7385],
];

/// The share at `N/2Rq(u0)` and at the distance of an edge from the middle in half lengths of the
/// undeformed contact.
pub(super) fn edge_share(layer: f64, place: f64) -> f64 {
    let root = layer.max(0.0).sqrt();
    let (row, down) = between(&STRETCH, root / (1.0 + root));
    let (column, across) = between(&PLACE, place);
    let along = |row: usize| {
        let [a, b] = [SHARE[row][column], SHARE[row][column + 1]];
        a + across * (b - a)
    };
    let [a, b] = [along(row), along(row + 1)];
    a + down * (b - a)
}

/// The interval of a value and how far through it, as a part; beyond the ends the end.
fn between(nodes: &[f64], value: f64) -> (usize, f64) {
    let above = nodes.partition_point(|node| *node <= value);
    let interval = above.clamp(1, nodes.len() - 1) - 1;
    let (from, to) = (nodes[interval], nodes[interval + 1]);
    (interval, ((value - from) / (to - from)).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slack_layer_bears_all_and_the_table_is_met_at_its_nodes_and_ends() {
        for place in [-2.0, -0.5, 0.3, 2.0] {
            assert_eq!(edge_share(0.0, place), 1.0);
            assert_eq!(edge_share(1e9, place), edge_share(8.0, place));
        }
        for (row, stretch) in STRETCH.iter().enumerate().skip(1) {
            let layer = (stretch / (1.0 - stretch)).powi(2);
            for (column, place) in PLACE.iter().enumerate() {
                let off = edge_share(layer, *place) - SHARE[row][column];
                assert!(off.abs() < 1e-9, "{row} {column}: {off}");
            }
            assert!((edge_share(layer, -1.0) - SHARE[row][0]).abs() < 1e-9);
        }
    }
}
