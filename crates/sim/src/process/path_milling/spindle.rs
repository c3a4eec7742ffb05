//! How far a spindle has turned that runs at one speed after another.

use truecut_plan::cam::SpindleSpeed;

/// Most speeds of a file that are told one by one.
const MOST_TOLD: usize = 6;

/// A stretch of one speed.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Stretch {
    from_s: f64,
    from_rad: f64,
    rad_s: f64,
}

/// Rotation of a spindle over time. A new speed is there at once: how a drive comes up to it is not
/// known.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SpindleCourse(Vec<Stretch>);

impl SpindleCourse {
    /// From an angle on, at speeds (rad/s) with the times (s) from which on they hold, which rise.
    pub fn new(start_rad: f64, speeds: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let mut stretches: Vec<Stretch> = Vec::new();
        for (from_s, rad_s) in speeds {
            let last = stretches.last();
            let turned = last.map(|last| last.from_rad + last.rad_s * (from_s - last.from_s));
            stretches.push(Stretch {
                from_s,
                from_rad: turned.unwrap_or(start_rad),
                rad_s,
            });
        }
        Self(stretches)
    }

    /// Which of the speeds holds.
    pub fn index(&self, time_s: f64) -> usize {
        let come = self.0.partition_point(|one| one.from_s <= time_s);
        come.saturating_sub(1)
    }

    pub fn rad_s(&self, time_s: f64) -> f64 {
        self.0[self.index(time_s)].rad_s
    }

    /// Not wrapped, rad.
    pub fn rotation_rad(&self, time_s: f64) -> f64 {
        let one = self.0[self.index(time_s)];
        one.from_rad + one.rad_s * (time_s - one.from_s)
    }

    pub fn speeds_rad_s(&self) -> impl Iterator<Item = f64> {
        self.0.iter().map(|one| one.rad_s)
    }
}

/// Speeds of the spindle that a file gives, with their lines.
pub(super) fn speeds_told(speeds: &[SpindleSpeed]) -> String {
    let each = speeds.iter();
    let each = each.map(|one| format!("{} 1/min (line {})", one.rpm, one.line));
    let mut told: Vec<String> = each.take(MOST_TOLD + 1).collect();
    if speeds.len() > MOST_TOLD {
        let others = speeds.len() - MOST_TOLD;
        told[MOST_TOLD] = format!("{others} more");
    }
    let changes = match speeds.len() {
        0 | 1 => "",
        _ => "; each is there at once",
    };
    format!(
        "the spindle turns as the file says, {}{changes}",
        told.join(", ")
    )
}

#[cfg(test)]
mod tests {
    use super::SpindleCourse;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, Uniform};

    /// The rotation is the integral of the speed, taken here in 100 000 steps.
    #[test]
    fn verify_rotation_is_the_integral_of_the_speed() {
        let mut random = ChaCha8Rng::seed_from_u64(30);
        let mut draw = |low: f64, high: f64| Uniform::new(low, high).unwrap().sample(&mut random);
        for _ in 0..20 {
            let (mut at, start_rad) = (0.0, draw(-3.0, 3.0));
            let speeds: Vec<(f64, f64)> = (0..5)
                .map(|_| {
                    let one = (at, draw(50.0, 2000.0));
                    at += draw(0.0, 2.0);
                    one
                })
                .collect();
            let course = SpindleCourse::new(start_rad, speeds);
            let end_s = at + 1.0;
            let steps = 100_000;
            let dt_s = end_s / f64::from(steps);
            let middles = (0..steps).map(|k| (f64::from(k) + 0.5) * dt_s);
            let turned: f64 = middles.map(|t| course.rad_s(t) * dt_s).sum();
            let off = course.rotation_rad(end_s) - start_rad - turned;
            // Each change falls into one step.
            assert!(off.abs() < 4.0 * 2000.0 * dt_s, "{off}");
        }
    }
}
