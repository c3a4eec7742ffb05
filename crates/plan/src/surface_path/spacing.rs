//! Lines that share the width of a face evenly.

use super::error::SurfacePathError;

/// How near the last gap comes to the share of the others.
const EVEN: f64 = 1e-6;

/// Trials of a share; each but a few of the first halves what is left.
const TRIALS: usize = 40;

/// Lines laid one after the other from the first, each as far from the one before as a share of
/// what is allowed, until the last.
pub(super) struct Laid<T> {
    pub lines: Vec<T>,
    /// What the last gap takes of what is allowed.
    pub last_gap: f64,
}

impl<T> Laid<T> {
    /// Gaps of the share that the lines are laid with, the last one in part.
    fn gaps(&self, share: f64) -> f64 {
        self.lines.len() as f64 - 2.0 + self.last_gap / share
    }
}

/// As few lines as are allowed, each gap with the same share of what is allowed there: laid as far
/// apart as allowed they would leave any remainder to the last gap.
///
/// # Errors
/// As `lay`.
pub(super) fn evenly<T>(
    lay: impl Fn(f64) -> Result<Laid<T>, SurfacePathError>,
) -> Result<Vec<T>, SurfacePathError> {
    let mut best = lay(1.0)?;
    let count = best.lines.len();
    if count < 3 {
        return Ok(best.lines);
    }
    let whole = count as f64 - 1.0;
    // A little more than needed: the remainder shall not become a line of its own.
    let wanted = whole - 0.5 * EVEN;
    let (mut short, mut enough) = (0.5, 1.0);
    let mut gaps = best.gaps(1.0);
    let mut share = 1.0;
    for _ in 0..TRIALS {
        if best.gaps(enough) >= whole - EVEN {
            break;
        }
        // Gaps are as many as their share is small, but for what changes over the face.
        share *= gaps / wanted;
        if !(short < share && share < enough) {
            share = 0.5 * (short + enough);
        }
        let laid = lay(share)?;
        gaps = laid.gaps(share);
        if laid.lines.len() > count {
            short = share;
        } else {
            (best, enough) = (laid, share);
        }
    }
    Ok(best.lines)
}
