//! What zones do to a program: time lost at stops, and corners that are cut.
//!
//! A zone is passed at constant acceleration from a point its radius before the corner to one its
//! radius behind it: a parabola, run through in the time that the two legs take. With directions
//! `u` and `w` before and behind it lies at most r/4 |u × w| off the legs. Zones reach no further
//! than half of the shorter leg. A stop costs v/a: half of it to brake, half to speed up, where the
//! legs are long enough for that.

use nalgebra::Vector3;

use super::moves::{Motion, Move, Program, Zone};

/// What zones do.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ZoneReport {
    /// Points on lines at which the tool stops, the first and the last left out.
    pub stops: usize,
    /// Time lost to speed up and to brake on lines, s; `None` if no acceleration is known.
    pub lost_s: Option<f64>,
    /// Largest distance of a cut corner from its legs (m), and its path point.
    pub corner: Option<(f64, usize)>,
}

impl Program {
    /// What the zones do, where lines meet; `acceleration_m_per_s2` is that of the tool on lines.
    #[must_use]
    pub fn zones(&self, acceleration_m_per_s2: Option<f64>) -> ZoneReport {
        let mut report = ZoneReport::default();
        let way = |pair: &[Move]| {
            pair[1].base_from_tool.translation.vector - pair[0].base_from_tool.translation.vector
        };
        let last = self.moves.len().saturating_sub(1);
        let stands = |i: usize| {
            let line_next = self.moves.get(i + 1).is_some_and(is_line);
            i == 0
                || i == last
                || self.moves[i].zone == Zone::Stop
                || !is_line(&self.moves[i])
                || !line_next
        };
        let mut lost_s = 0.0;
        for (i, pair) in self.moves.windows(2).enumerate() {
            let Motion::Linear { speed_m_per_s } = pair[1].motion else {
                continue;
            };
            if i + 1 < last && pair[1].zone == Zone::Stop {
                report.stops += 1;
            }
            if let Some(acceleration) = acceleration_m_per_s2 {
                let ends = usize::from(stands(i)) + usize::from(stands(i + 1));
                lost_s += ramp_loss_s(way(pair).norm(), speed_m_per_s, acceleration, ends);
            }
        }
        report.lost_s = acceleration_m_per_s2.map(|_| lost_s);
        for three in self.moves.windows(3) {
            let Zone::Within(zone_m) = three[1].zone else {
                continue;
            };
            if !(is_line(&three[1]) && is_line(&three[2])) {
                continue;
            }
            let legs = [way(&three[..2]), way(&three[1..])];
            let cut_m = cut_m(&legs, zone_m);
            if report.corner.is_none_or(|(most, _)| cut_m > most) {
                report.corner = Some((cut_m, three[1].path_point));
            }
        }
        report
    }
}

fn is_line(step: &Move) -> bool {
    matches!(step.motion, Motion::Linear { .. })
}

/// How far the parabola lies off the legs of a corner.
fn cut_m(legs: &[Vector3<f64>; 2], zone_m: f64) -> f64 {
    let lengths = legs.map(|leg| leg.norm());
    let radius_m = zone_m.min(0.5 * lengths[0]).min(0.5 * lengths[1]);
    if radius_m <= 0.0 {
        return 0.0;
    }
    0.25 * radius_m * (legs[0] / lengths[0]).cross(&(legs[1] / lengths[1])).norm()
}

/// What a line takes longer than at its speed all the way, with `ends` of it at rest.
fn ramp_loss_s(length_m: f64, speed: f64, acceleration: f64, ends: usize) -> f64 {
    let ramp_m = 0.5 * speed * speed / acceleration;
    let needed_m = ramp_m * ends as f64;
    if ends == 0 || length_m <= 0.0 {
        return 0.0;
    }
    if length_m >= needed_m {
        return 0.5 * speed / acceleration * ends as f64;
    }
    // Too short for its speed: up and down again, or up all the way.
    let time_s = match ends {
        1 => (2.0 * length_m / acceleration).sqrt(),
        _ => 2.0 * (length_m / acceleration).sqrt(),
    };
    time_s - length_m / speed
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line of 1 m from rest to rest at 0.5 m/s and 1 m/s²: 0.5 s up, 0.5 s down on a quarter of
    /// a metre, 1.5 s between; 2.5 s in place of 2. One of 0.16 m only gets to 0.4 m/s: 0.8 s.
    #[test]
    fn verify_ramps_take_the_time_of_constant_acceleration() {
        assert!((ramp_loss_s(1.0, 0.5, 1.0, 2) - 0.5).abs() < 1e-12);
        assert!((ramp_loss_s(0.16, 0.5, 1.0, 2) - (0.8 - 0.32)).abs() < 1e-12);
        assert!((ramp_loss_s(1.0, 0.5, 1.0, 1) - 0.25).abs() < 1e-12);
        assert!(ramp_loss_s(1.0, 0.5, 1.0, 0).abs() < 1e-15);
    }

    /// The parabola with its control points r before the corner, at it and r behind it, taken at a
    /// thousand places: its greatest distance from the nearer leg.
    #[test]
    fn verify_cut_corners_lie_a_quarter_of_the_radius_off() {
        for angle in [0.3_f64, 1.0, 1.5, std::f64::consts::FRAC_PI_2] {
            let (u, w) = (Vector3::x(), Vector3::new(angle.cos(), angle.sin(), 0.0));
            let r = 0.01;
            let mut most: f64 = 0.0;
            for k in 0..=1000 {
                let t = f64::from(k) / 1000.0;
                let place = -u * (r * (1.0 - t) * (1.0 - t)) + w * (r * t * t);
                let off = |leg: Vector3<f64>| (place - leg * place.dot(&leg)).norm();
                most = most.max(off(u).min(off(w)));
            }
            let cut = cut_m(&[u * 0.1, w * 0.1], r);
            assert!((cut - most).abs() < 1e-5 * r, "{cut} {most}");
        }
    }
}
