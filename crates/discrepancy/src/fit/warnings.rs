//! Estimates that no machine has, and what they hint at.

use nalgebra::{DVector, Matrix3, Vector3};
use truecut_recording::significant;

use super::base::Base;
use super::columns::Column;
use super::solve::Solution;
use super::{NOT_SEPARABLE, Parameter};

/// What makes estimates impossible that fit well.
const HINT: &str = "a law that is left out of [fit], or a delay between motion and drive force, goes into it; \
                    `truecut diagnose` looks for both";

/// One sentence for each estimate, or body, that cannot be. `half` is how many deviations an
/// interval reaches.
pub(super) fn warnings(
    base: &Base,
    columns: &[Column],
    parameters: &[Parameter],
    solution: &Solution,
    half: f64,
) -> Vec<String> {
    let groups = base.groups.iter().zip(parameters);
    let mut found: Vec<String> = groups
        .filter(|(group, one)| group.members.len() == 1 && one.seen)
        .filter_map(|(group, one)| negative(columns[group.members[0].0].never_negative?, one))
        .collect();
    found.extend(payload(base, columns, parameters, solution, half));
    found
}

fn negative(what: &str, one: &Parameter) -> Option<String> {
    let [low, high] = one.interval?;
    if one.value >= 0.0 {
        return None;
    }
    let three = |value| significant(value, 3);
    let Parameter { name, unit, .. } = one;
    let value = three(one.value);
    Some(if high < 0.0 {
        format!("`{name}` is {value} {unit}, but {what} is never negative: {HINT}")
    } else {
        format!(
            "`{name}` is {value} {unit}, and {what} is never negative: within its interval, {} to {}, these data \
             do not tell it from 0",
            three(low),
            three(high)
        )
    })
}

/// A payload by itself is a body: no second moment of its mass about its centre,
/// `tr(I)/2 - I - m c cᵀ`, is negative, from which the rules of moments of inertia follow.
fn payload(
    base: &Base,
    columns: &[Column],
    parameters: &[Parameter],
    solution: &Solution,
    half: f64,
) -> Option<String> {
    let first = columns.iter().position(|one| one.name == "payload mass")?;
    let single = |column: usize| {
        let alone =
            |group: &super::base::Group| matches!(group.members[..], [(c, _)] if c == column);
        base.groups.iter().position(alone)
    };
    let places: Option<Vec<usize>> = (first..first + 10).map(single).collect();
    let places = places?;
    if !places.iter().all(|&i| parameters[i].seen) || parameters[places[0]].value <= 0.0 {
        return None;
    }
    let nominal: Vec<f64> = places.iter().map(|&i| parameters[i].nominal).collect();
    let least = |x: &DVector<f64>| {
        let own: Vec<f64> = (places.iter().zip(&nominal))
            .map(|(i, nominal)| x[*i] + nominal)
            .collect();
        least_moment(&own)
    };
    let value = least(&solution.found);
    let reach = half * solution.deviation(least);
    let exchanged = (0..parameters.len())
        .filter(|j| parameters[*j].seen && !places.contains(j))
        .flat_map(|j| places.iter().map(move |&i| (i, j)))
        .find(|&(i, j)| solution.correlation(i, j).abs() >= NOT_SEPARABLE);
    let exchanged = exchanged.map_or_else(String::new, |(i, j)| {
        let [own, other] = [i, j].map(|k| &parameters[k].name);
        format!("; or `{own}` is too large or small for what `{other}` lacks, since these data do not separate them")
    });
    (value + reach < 0.0).then(|| {
        format!(
            "mass, centre and inertia of the payload are those of no body (least second moment about the centre \
             {} kg m^2, {} to {}; of a body none is below 0): {HINT}{exchanged}",
            significant(value, 3),
            significant(value - reach, 3),
            significant(value + reach, 3)
        )
    })
}

/// Least second moment of the mass about its centre in any direction, kg m².
fn least_moment(own: &[f64]) -> f64 {
    let &[m, x, y, z, xx, yy, zz, xy, xz, yz] = own else {
        return 0.0;
    };
    let inertia = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    let second = Matrix3::identity() * (0.5 * inertia.trace()) - inertia;
    let first = Vector3::new(x, y, z);
    let about_centre = second - first * first.transpose() / m;
    about_centre.symmetric_eigenvalues().min()
}
