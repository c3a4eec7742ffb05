//! Where the outermost of parallel planes stand.
//!
//! The swath differs along a line, and a border need not run along the planes. The first plane in
//! which a contact lies within the face holds it at a few places only, and the strip along the rest
//! of the border would be left to the next plane, which stands too far off. So a little further in
//! a line leaves less. What a line at c leaves at a place whose border allows one from c₀ on is c −
//! c₀, or, if c₀ is beyond, what the next line leaves: c + d − c₀, d the distance of lines. The
//! first line stands where the sum of that along the border is least.

use super::error::SurfacePathError;
use super::layout::{Layout, STATIONS};
use super::planes::Sections;

/// Planes that are tried, evenly over the distance of two lines.
const TRIED: usize = 64;

/// The outermost plane on the way from the first that holds a contact within the face to the
/// middle, m.
pub(super) fn outer(
    layout: &Layout<'_>,
    sections: &Sections<'_>,
    from_m: f64,
    middle_m: f64,
) -> Result<f64, SurfacePathError> {
    let way_m = middle_m - from_m;
    let apart_m = sections.apart_m(layout, from_m)?.min(way_m.abs());
    let at_m = |k: usize| from_m + way_m.signum() * apart_m * k as f64 / TRIED as f64;
    let inside = |c_m: f64| layout.inside(&sections.graph(c_m));
    let mut first: Vec<Option<usize>> = vec![None; STATIONS + 1];
    for k in 0..=TRIED {
        for (first, inside) in first.iter_mut().zip(inside(at_m(k))?) {
            if inside && first.is_none() {
                *first = Some(k);
            }
        }
    }
    let left = |k: usize| {
        let each = first.iter().flatten();
        let strips = each.map(|from| {
            if *from <= k {
                k - from
            } else {
                k + TRIED - from
            }
        });
        strips.sum::<usize>()
    };
    let best = (0..=TRIED).min_by_key(|k| left(*k)).unwrap_or(0);
    if best == 0 {
        return Ok(from_m);
    }
    let wanted = inside(at_m(best))?;
    let holds_all = |c_m: f64| {
        let held = inside(c_m)?;
        Ok(wanted
            .iter()
            .zip(held)
            .all(|(wanted, held)| held || !wanted))
    };
    let found = layout.bisect(at_m(best - 1), at_m(best), holds_all)?;
    Ok(found.unwrap_or(at_m(best)))
}
