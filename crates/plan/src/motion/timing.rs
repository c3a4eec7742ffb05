//! Timing laws: how a path's clock runs.
//!
//! A path has times of its own, at which its speed is the one asked for. A timing law says which of
//! them is reached when, so that the path starts, or starts and ends, at rest.

/// From rest to full speed: the clock's rate rises as 3x² − 2x³ over the lead-in and is 1 from then
/// on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeadIn {
    /// Time in which the clock comes up to speed, s.
    pub duration_s: f64,
}

impl LeadIn {
    /// The path's own time at `time_s` after the start, s: half a lead-in late after the lead-in,
    /// and 0 before the start.
    #[must_use]
    pub fn own_s(&self, time_s: f64) -> f64 {
        let x = (time_s / self.duration_s).clamp(0.0, 1.0);
        self.duration_s * (x.powi(3) - 0.5 * x.powi(4)) + (time_s - self.duration_s).max(0.0)
    }

    /// Rate of [`own_s`](Self::own_s), 0 to 1.
    #[must_use]
    pub fn rate(&self, time_s: f64) -> f64 {
        let x = (time_s / self.duration_s).clamp(0.0, 1.0);
        x * x * (3.0 - 2.0 * x)
    }
}

/// How a path begins and ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TimingLaw {
    /// A lead-in at the start; the path ends, and goes straight on, at full speed.
    FromRest(LeadIn),
    /// A lead-in at the start and the same backwards at the end. A path that is shorter than its
    /// lead-in is nothing else.
    RestToRest(LeadIn),
}

impl TimingLaw {
    /// Time that a path takes which has a time of its own of `own_s`, s.
    #[must_use]
    pub fn duration_s(&self, own_s: f64) -> f64 {
        match self {
            Self::FromRest(lead_in) => own_s + 0.5 * lead_in.duration_s,
            Self::RestToRest(lead_in) => own_s + within(lead_in, own_s).duration_s,
        }
    }

    /// The path's own time at `time_s` after the start, s.
    #[must_use]
    pub fn own_s(&self, time_s: f64, own_s: f64) -> f64 {
        match self {
            Self::FromRest(lead_in) => lead_in.own_s(time_s),
            Self::RestToRest(lead_in) => {
                let lead_in = within(lead_in, own_s);
                let left_s = self.duration_s(own_s) - time_s;
                if time_s < left_s {
                    lead_in.own_s(time_s)
                } else {
                    own_s - lead_in.own_s(left_s)
                }
            }
        }
    }
}

fn within(lead_in: &LeadIn, own_s: f64) -> LeadIn {
    LeadIn {
        duration_s: lead_in.duration_s.min(own_s),
    }
}

/// From `a` to `b` at a share `u` of the way, as 3u² − 2u³: it leaves and arrives with no slope.
#[must_use]
pub fn smooth_between(a: f64, b: f64, u: f64) -> f64 {
    a + (b - a) * u * u * (3.0 - 2.0 * u)
}

/// Share of a move from rest to rest at a share `x` of its time, 0 to 1: 10x³ − 15x⁴ + 6x⁵, the way
/// of least jerk (Flash and Hogan 1985, eq. 3).
#[must_use]
pub fn least_jerk(x: f64) -> f64 {
    x.powi(3) * (10.0 + x * (6.0 * x - 15.0))
}

/// Largest rate of [`least_jerk`], at x = 1/2.
pub const LEAST_JERK_PEAK: f64 = 1.875;

#[cfg(test)]
mod tests {
    use super::*;

    /// The rate is the derivative, and full after the lead-in.
    #[test]
    fn verify_rate_of_a_lead_in() {
        let lead_in = LeadIn { duration_s: 0.4 };
        let h = 1e-6;
        for time_s in [0.01, 0.13, 0.2, 0.39, 0.5] {
            let slope = (lead_in.own_s(time_s + h) - lead_in.own_s(time_s - h)) / (2.0 * h);
            assert!((slope - lead_in.rate(time_s)).abs() < 1e-9, "{time_s}");
        }
        assert!((lead_in.own_s(1.0) - 0.8).abs() < 1e-15);
        assert_eq!((lead_in.own_s(-1.0), lead_in.rate(-1.0)), (0.0, 0.0));
    }

    /// A path from rest to rest is the same backwards.
    #[test]
    fn verify_rest_to_rest_is_symmetric() {
        let law = TimingLaw::RestToRest(LeadIn { duration_s: 0.3 });
        for own_s in [0.1, 0.3, 2.0] {
            let whole_s = law.duration_s(own_s);
            for k in 0..=20 {
                let time_s = whole_s * f64::from(k) / 20.0;
                let sum_s = law.own_s(time_s, own_s) + law.own_s(whole_s - time_s, own_s);
                assert!((sum_s - own_s).abs() < 1e-12, "{own_s} {time_s}");
            }
        }
    }

    #[test]
    fn verify_peak_rate_of_least_jerk() {
        let h = 1e-5;
        let peak = (least_jerk(0.5 + h) - least_jerk(0.5 - h)) / (2.0 * h);
        assert!((peak - LEAST_JERK_PEAK).abs() < 1e-8);
        assert_eq!((least_jerk(0.0), least_jerk(1.0)), (0.0, 1.0));
    }
}
