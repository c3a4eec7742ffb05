//! Mean cutting forces of a run against the closed form.
//!
//! Chips are measured between true arcs, the closed form's are linear in the feed: they differ by
//! about c/2r, here 0.1 %.

use super::support::{RIG, run, scalar, scenario};

fn check(what: &str, overrides: &[(&str, String)]) {
    let end = run(&scenario(RIG, overrides));
    for axis in ["x", "y", "z"] {
        let mean = scalar(&end, &format!("milling.mean_force_{axis}"));
        let nominal = scalar(&end, &format!("milling.nominal_force_{axis}"));
        let error = (mean - nominal).abs();
        assert!(
            error <= 5e-3 * nominal.abs(),
            "{what}, {axis}: {mean} N instead of {nominal} N"
        );
    }
}

fn set(key: &'static str, value: &str) -> (&'static str, String) {
    (key, value.to_owned())
}

/// Runout moves chips from one tooth to the next, and takes none away; edge forces it would: a
/// tooth that stands back is out of the cut for longer.
#[test]
fn verify_mean_forces_with_runout() {
    check("runout", &[set("process.milling.cutter.runout_um", "3")]);
}

#[test]
fn verify_mean_forces_of_a_revolution() {
    let engagement = |name: &str| set("process.milling.engagement", name);
    let edges = [
        set("process.milling.cutting.edge_tangential_n_per_mm", "8"),
        set("process.milling.cutting.edge_radial_n_per_mm", "3"),
        set("process.milling.cutting.axial_mpa", "220"),
        set("process.milling.cutting.edge_axial_n_per_mm", "2"),
    ];
    let helix = set("process.milling.cutter.helix_deg", "30");
    let teeth = set("process.milling.cutter.teeth", "4");
    check("down", &[]);
    check("up", &[engagement("up")]);
    check("down, edges", &edges);
    let mut all = edges.to_vec();
    all.extend([helix, teeth, engagement("up")]);
    check("up, edges, helix, four teeth", &all);
    all.push(set("process.milling.lead_in_mm", "0.5"));
    all.push(set("process.milling.path.length_mm", "30"));
    check("through the face of the stock", &all);
    all.push(set("process.milling.ramp_mm", "3"));
    check("on a wedge", &all);
}
