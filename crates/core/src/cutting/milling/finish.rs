//! Figures of a finished surface.

/// Figures of one row of the surface, all along the feed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FinishFigures {
    /// Surface location error: mean of what is left above the nominal surface, m; negative if too
    /// much was taken.
    pub location_error_m: f64,
    /// Largest minus smallest, m: the scallop of a steady cut.
    pub peak_to_valley_m: f64,
    /// Ra about the mean, m.
    pub arithmetic_deviation_m: f64,
    /// Rq about the mean, m.
    pub rms_deviation_m: f64,
}

/// Figures of a profile (m); `None` if it is empty or holds a ray that was never cut.
pub fn figures(left_m: &[f64]) -> Option<FinishFigures> {
    if left_m.is_empty() || left_m.iter().any(|x| !x.is_finite()) {
        return None;
    }
    let count = left_m.len() as f64;
    let mean = left_m.iter().sum::<f64>() / count;
    let squares = left_m.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
    Some(FinishFigures {
        location_error_m: mean,
        peak_to_valley_m: crate::roughness::spread(left_m),
        arithmetic_deviation_m: crate::roughness::arithmetic_mean_deviation(left_m),
        rms_deviation_m: (squares / count).sqrt(),
    })
}

#[cfg(test)]
pub(crate) mod tests;
