//! Symmetric copies, one after another.

use super::shared::scalar;
use super::support::run;

/// Two copies to which the arm goes take twice the removal of one; that they stand elsewhere
/// changes the arm's compliance, and so the depth, by little.
#[test]
fn copies_are_finished_one_after_another() {
    let one = run(&[]);
    let two = run(&[("copies", "2")]);
    let ratio = |name: &str| scalar(&two, name) / scalar(&one, name);
    assert!((ratio("belt.removed_volume") - 2.0).abs() < 0.2);
    assert!((ratio("belt.contact_time") - 2.0).abs() < 0.1);
    assert!((ratio("belt.depth_mean") - 1.0).abs() < 0.1);
    assert_eq!(scalar(&one, "belt.copies_difference"), 0.0);
    let difference = scalar(&two, "belt.copies_difference");
    assert!(difference > 0.0 && difference < 0.2, "{difference}");
}
