//! How far the straight lines that a robot program drives from contact to contact leave the face.

use nalgebra::{Matrix2, Vector2, Vector3};

use super::contact::Contact;
use super::lines::SurfacePath;
use super::wheel::ContactWheel;
use crate::surface::Surface;

/// Largest distance of places at which a straight line is held against the face, m: between two of
/// them s²/8 κ more may be missed, 2.5 µm where radii are 50 mm.
const APART_M: f64 = 1e-3;

/// Most places on one line from contact to contact.
const MOST_PLACES: f64 = 2000.0;

/// Steps of Newton's iteration to the foot of a point on the face; two or three do.
const STEPS: usize = 8;

/// A straight line from one contact to the next.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Chord {
    /// How much deeper than at the contacts the wheel's middle runs, at most, m.
    pub deeper_m: f64,
    /// How far it stands off from where the contacts have it, at most, m.
    pub off_m: f64,
}

impl Chord {
    /// The larger of both, m.
    #[must_use]
    pub fn largest_m(&self) -> f64 {
        self.deeper_m.max(self.off_m)
    }
}

impl SurfacePath {
    /// For each line, what its straight lines from contact to contact leave of the face on which it
    /// was laid: `[line][contact]`, to the contact after.
    #[must_use]
    pub fn chords(&self, surface: &dyn Surface, wheel: &ContactWheel) -> Vec<Vec<Chord>> {
        let each = |line: &Vec<Contact>| {
            let pairs = line.windows(2);
            pairs
                .map(|pair| chord(surface, wheel, [&pair[0], &pair[1]]))
                .collect()
        };
        self.lines.iter().map(each).collect()
    }
}

fn chord(surface: &dyn Surface, wheel: &ContactWheel, [from, to]: [&Contact; 2]) -> Chord {
    let way_m = to.centre_m - from.centre_m;
    let count = (way_m.norm() / APART_M).ceil().clamp(2.0, MOST_PLACES) as usize;
    let height_m = wheel.radius_m - wheel.indentation_m;
    let mut found = Chord::default();
    for k in 1..count {
        let t = k as f64 / count as f64;
        let centre_m = from.centre_m + way_m * t;
        let guess = [from.u + t * (to.u - from.u), from.v + t * (to.v - from.v)];
        let off_m = height_over_m(surface, &centre_m, guess) - height_m;
        found.off_m = found.off_m.max(off_m);
        found.deeper_m = found.deeper_m.max(-off_m);
    }
    found
}

/// Height of a point over the face, along the normal at its foot.
fn height_over_m(surface: &dyn Surface, point_m: &Vector3<f64>, [u, v]: [f64; 2]) -> f64 {
    let domain = surface.domain();
    let mut uv = Vector2::new(u, v);
    let mut jet = surface.jet(u, v);
    for _ in 0..STEPS {
        let ([ru, rv], [ruu, ruv, rvv]) = (jet.first_m, jet.second_m);
        let d = point_m - jet.point_m;
        let slope = Matrix2::new(
            ru.dot(&ru) - d.dot(&ruu),
            ru.dot(&rv) - d.dot(&ruv),
            ru.dot(&rv) - d.dot(&ruv),
            rv.dot(&rv) - d.dot(&rvv),
        );
        let Some(inverse) = slope.try_inverse() else {
            break;
        };
        let step = inverse * Vector2::new(d.dot(&ru), d.dot(&rv));
        let next = uv + step;
        uv = Vector2::new(
            next.x.clamp(domain.u[0], domain.u[1]),
            next.y.clamp(domain.v[0], domain.v[1]),
        );
        jet = surface.jet(uv.x, uv.y);
    }
    let normal = jet.first_m[0].cross(&jet.first_m[1]).normalize();
    (point_m - jet.point_m).dot(&normal)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::cylinder::CylinderPatch;
    use crate::surface::drawn::seeded;
    use crate::surface_path::wheel::tests::PUBLISHED;
    use crate::surface_path::{AxisRule, FeedAlong, PathOptions, Strategy, plan_path};

    /// Round a bar of radius ρ the centre runs on a circle of ρ + R − h, and a straight line of φ
    /// lies (ρ + R − h)(1 − cos φ/2) within it; in a bore it stands off by as much with the
    /// circle's radius ρ − R + h.
    #[test]
    fn verify_straight_lines_about_drawn_bars_and_bores_leave_them_by_the_sagitta() {
        for seed in 0..20 {
            let (radius_m, step_m) = seeded(seed, &(0.06..0.3_f64, 3e-3..20e-3_f64));
            let hollow = seed % 2 == 1;
            let signed_m = if hollow { -radius_m } else { radius_m };
            let bar = CylinderPatch::new(
                Vector3::zeros(),
                Vector3::y_axis(),
                Vector3::z_axis(),
                signed_m,
                [-0.6, 0.6],
                0.15,
            );
            let options = PathOptions {
                rule: AxisRule::WidestSwath {
                    edge_gap_limit_m: 1e-3,
                },
                overlap: 0.0,
                step_m,
                margin_m: 0.0,
            };
            // Fed round the bar, its axis along the bar.
            let (strategy, along) = (Strategy::IsoParametric, FeedAlong::U);
            let path = plan_path(&bar, None, &PUBLISHED, strategy, along, &options);
            let path = path.expect("a path");
            let height_m = PUBLISHED.radius_m - PUBLISHED.indentation_m;
            let circle_m = if hollow {
                radius_m - height_m
            } else {
                radius_m + height_m
            };
            for (line, chords) in path.lines.iter().zip(path.chords(&bar, &PUBLISHED)) {
                for (pair, chord) in line.windows(2).zip(chords) {
                    let half_m = 0.5 * (pair[1].centre_m - pair[0].centre_m).norm();
                    let sagitta_m = circle_m - (circle_m * circle_m - half_m * half_m).sqrt();
                    let (found_m, other_m) = match hollow {
                        true => (chord.off_m, chord.deeper_m),
                        false => (chord.deeper_m, chord.off_m),
                    };
                    // An odd number of places has none in the middle.
                    let missed_m = APART_M * APART_M / (8.0 * circle_m);
                    assert!(found_m <= sagitta_m + 1e-12, "seed {seed}");
                    assert!(
                        found_m >= sagitta_m - 1.01 * missed_m,
                        "seed {seed}: {found_m} {sagitta_m}"
                    );
                    assert!(other_m < 1e-12, "seed {seed}");
                }
            }
        }
    }
}
