//! How much of a face no line covers.

use nalgebra::Vector3;

use super::contact::Contact;
use super::lines::SurfacePath;
use crate::surface::{Domain, Forms, Jet, PatchFile, Surface};

/// Cells along each parameter of the patch.
const CELLS: usize = 250;

/// Contacts are led straight on for this part of their length.
const PART_OF_REACH: f64 = 0.25;

/// How much further than half a contact's diagonal cells are looked for: the face is curved.
const FURTHER: f64 = 1.25;

/// What of a contact counts: two directions in the tangent plane, square to each other, and how far
/// it goes along them to either side.
type Footprint = [(Vector3<f64>, f64); 2];

/// The strip that a contact is, as long as the wheel is wide along its axis.
fn strip(contact: &Contact) -> Footprint {
    let (sin, cos) = contact.psi_rad.sin_cos();
    let half_m = contact.half_width_m;
    // Of the wheel: the swath is W sin ψ + 2 b cos ψ, the length W cos ψ + 2 b sin ψ.
    let width_m = contact.swath_m * sin + contact.reach_m * cos - 4.0 * half_m * sin * cos;
    let across = contact.normal.cross(&contact.axis);
    [(across, half_m), (contact.axis.into_inner(), 0.5 * width_m)]
}

/// Cells of a patch: their middles, and whether a contact has passed over them.
struct Cells {
    domain: Domain,
    middles_m: Vec<Vector3<f64>>,
    touched: Vec<bool>,
}

impl SurfacePath {
    /// Share of the face, its boundary and holes left out, that lies under no contact: cut into 250
    /// by 250 cells, each looked at in its middle. A contact is a strip along the wheel's axis;
    /// where that is askew to the feed, it leaves triangles at the ends of a line.
    #[must_use]
    pub fn untouched_share(&self, patch: &PatchFile) -> f64 {
        self.left(patch, strip)
    }

    fn left(&self, patch: &PatchFile, footprint: fn(&Contact) -> Footprint) -> f64 {
        let (surface, domain) = (patch.surface.as_ref(), patch.surface.domain());
        let mut cells = Cells {
            domain,
            middles_m: Vec::with_capacity(CELLS * CELLS),
            touched: vec![false; CELLS * CELLS],
        };
        let mut areas = Vec::with_capacity(CELLS * CELLS);
        for cell in 0..CELLS * CELLS {
            let [u, v] = cells.middle(cell);
            let jet = surface.jet(u, v);
            let [ru, rv] = jet.first_m;
            let is_face = patch.boundary.as_ref().is_none_or(|boundary| {
                Forms::of(&jet).is_some_and(|forms| {
                    let along = ru.normalize();
                    let axes = [along, forms.normal.cross(&along)];
                    boundary.holds_rectangle(&jet.point_m, axes, [0.0; 2])
                })
            });
            cells.middles_m.push(jet.point_m);
            areas.push(if is_face { ru.cross(&rv).norm() } else { 0.0 });
        }
        for line in &self.lines {
            cells.pass(surface, line, footprint);
        }
        let whole: f64 = areas.iter().sum();
        let left = areas.iter().zip(&cells.touched);
        let left: f64 = left
            .filter(|(_, touched)| !**touched)
            .fold(0.0, |sum, (area, _)| sum + area);
        if whole > 0.0 { left / whole } else { 0.0 }
    }
}

impl Cells {
    fn middle(&self, cell: usize) -> [f64; 2] {
        let at = |range: [f64; 2], k: usize| {
            range[0] + (range[1] - range[0]) * (k as f64 + 0.5) / CELLS as f64
        };
        [
            at(self.domain.u, cell / CELLS),
            at(self.domain.v, cell % CELLS),
        ]
    }

    /// Marks what a line passes over.
    fn pass(
        &mut self,
        surface: &dyn Surface,
        line: &[Contact],
        footprint: fn(&Contact) -> Footprint,
    ) {
        let alone = match line {
            [only] => Some([only, only]),
            _ => None,
        };
        let pairs = line.windows(2).map(|pair| [&pair[0], &pair[1]]);
        for pair in pairs.chain(alone) {
            let way_m = pair[1].point_m - pair[0].point_m;
            let reach_m = pair[0].reach_m.min(pair[1].reach_m);
            let count = (way_m.norm() / (PART_OF_REACH * reach_m)).ceil().max(1.0);
            for k in 0..count as usize {
                let t = (k as f64 + 0.5) / count;
                let near = if t < 0.5 { pair[0] } else { pair[1] };
                let [u, v] =
                    [(pair[0].u, pair[1].u), (pair[0].v, pair[1].v)].map(|(a, b)| a + t * (b - a));
                let half_way_m = way_m * (0.5 / count);
                self.touch([u, v], &surface.jet(u, v), &footprint(near), &half_way_m);
            }
        }
    }

    /// Marks what lies under a contact on its way from before a place to behind it.
    fn touch(&mut self, at: [f64; 2], jet: &Jet, footprint: &Footprint, half_way_m: &Vector3<f64>) {
        let [ru, rv] = jet.first_m;
        let [(_, first_m), (_, second_m)] = footprint;
        // Parameters as far away as the contact's corner: along u that is r √(G/(EG − F²)).
        let area = ru.cross(&rv).norm();
        let far_m = FURTHER * first_m.hypot(*second_m) + half_way_m.norm();
        let far = [far_m * rv.norm() / area, far_m * ru.norm() / area];
        let ranges = [self.domain.u, self.domain.v];
        let [us, vs] = [0, 1].map(|i| {
            let [low, high] = ranges[i];
            let cell = |p: f64| (p - low) / (high - low) * CELLS as f64;
            let first = cell(at[i] - far[i]).floor().max(0.0) as usize;
            first..(cell(at[i] + far[i]).ceil().max(0.0) as usize).min(CELLS)
        });
        for i in us {
            for cell in i * CELLS + vs.start..i * CELLS + vs.end.max(vs.start) {
                let from_m = self.middles_m[cell] - jet.point_m;
                self.touched[cell] |= passes_over(footprint, &from_m, half_way_m);
            }
        }
    }
}

/// Whether a contact passes over a place (from the middle of its way) as it moves from one end of
/// the way to the other: whether there is a time from −1 to 1 at which the place is within its size
/// along both directions.
fn passes_over(footprint: &Footprint, from_m: &Vector3<f64>, half_way_m: &Vector3<f64>) -> bool {
    let (mut since, mut until) = (-1.0_f64, 1.0_f64);
    for (direction, half_m) in footprint {
        let (off_m, speed_m) = (from_m.dot(direction), half_way_m.dot(direction));
        if speed_m == 0.0 {
            if off_m.abs() > *half_m {
                return false;
            }
            continue;
        }
        let times = [-1.0, 1.0].map(|side| (off_m + side * half_m) / speed_m);
        since = since.max(times[0].min(times[1]));
        until = until.min(times[0].max(times[1]));
    }
    since <= until
}

#[cfg(test)]
mod tests {
    use nalgebra::{Unit, Vector3};

    use super::{Contact, Footprint};
    use crate::surface::drawn::{self, seeded};
    use crate::surface::{MeshFace, MeshFile, PatchFile, PlanePatch, Surface};
    use crate::surface_path::{
        AxisRule, ContactWheel, FeedAlong, PathOptions, Strategy, SurfacePath, plan_path,
    };

    const WHEEL: ContactWheel = ContactWheel {
        radius_m: 0.04,
        width_m: 0.012,
        indentation_m: 0.3e-3,
        line_load_n_per_m: 1200.0,
        modulus_pa: 8e6,
    };

    /// The rectangle of swath and length along the feed about a contact, by which lines are laid.
    fn swath(contact: &Contact) -> Footprint {
        let side = contact.normal.cross(&contact.feed);
        [
            (contact.feed.into_inner(), 0.5 * contact.reach_m),
            (side, 0.5 * contact.swath_m),
        ]
    }

    fn planned(patch: &PatchFile, strategy: Strategy, limit_m: f64) -> SurfacePath {
        let options = PathOptions {
            rule: AxisRule::WidestSwath {
                edge_gap_limit_m: limit_m,
            },
            overlap: 0.1,
            step_m: 2e-3,
            margin_m: 0.0,
        };
        let (surface, boundary) = (patch.surface.as_ref(), patch.boundary.as_ref());
        let along = FeedAlong::U;
        plan_path(surface, boundary, &WHEEL, strategy, along, &options).expect("a path")
    }

    fn of(surface: impl Surface + Send + 'static) -> PatchFile {
        PatchFile {
            surface: Box::new(surface),
            boundary: None,
            fit: None,
        }
    }

    fn planes(normal: Vector3<f64>) -> Strategy {
        Strategy::ParallelPlane {
            normal: Unit::new_normalize(normal),
            along_borders: false,
        }
    }

    /// Planes of normals drawn all round on faces drawn at random, turned anyhow: with a line along
    /// each border none of the triangles that they leave there is left. Closed form of what is left
    /// without, on a flat face of sides a and b under lines that lean by θ: each line of swath s
    /// leaves triangles of s²/2 (tan or cot of θ) at both ends, beside what is left in corners.
    #[test]
    fn lines_along_borders_take_what_planes_askew_to_them_leave() {
        let mut left_before = 0.0_f64;
        for seed in 0..12 {
            let (long_m, wide_m, turn) =
                seeded(seed, &(0.08..0.2_f64, 0.05..0.1_f64, 0.05..1.5_f64));
            let place = nalgebra::Rotation3::new(Vector3::new(turn, 1.0 - turn, 0.3 * turn) * 2.0);
            let (along, up) = (place * Vector3::x() * long_m, place * Vector3::y() * wide_m);
            let plane = PlanePatch::new(Vector3::zeros(), along, up).expect("a plane");
            let patch = of(plane);
            let normal = place * Vector3::new(turn.sin(), turn.cos(), 0.0);
            let askew = planned(&patch, planes(normal), 0.1e-3).left(&patch, swath);
            let with_borders = Strategy::ParallelPlane {
                normal: Unit::new_normalize(normal),
                along_borders: true,
            };
            let left = planned(&patch, with_borders, 0.1e-3).left(&patch, swath);
            assert!(left < 0.005, "seed {seed}, {turn}: {left} of {askew}");
            left_before = left_before.max(askew);
        }
        assert!(left_before > 0.1, "{left_before}");
    }

    /// A single line along a plane leaves what is not under its swath, to a cell on each side, and
    /// triangles at both ends: the wheel's axis stands at ψ to the feed, so that those beside its
    /// strip's long and short sides are W²/2 and (2 b)²/2 times sin ψ cos ψ.
    #[test]
    fn verify_what_a_line_leaves_of_a_drawn_plane() {
        for seed in 0..10 {
            let (long_m, wide_m) = seeded(seed, &(0.05..0.2_f64, 0.03..0.1_f64));
            let (along, up) = (Vector3::x() * long_m, Vector3::y() * wide_m);
            let plane = PlanePatch::new(Vector3::zeros(), along, up).expect("a plane");
            let patch = of(plane);
            let mut path = planned(&patch, Strategy::IsoParametric, 0.1e-3);
            path.lines.truncate(1);
            let contact = path.lines[0][0];
            let of_swath = 1.0 - contact.swath_m / wide_m;
            let by_swath = path.left(&patch, swath);
            let off = (by_swath - of_swath).abs();
            assert!(off < 1.0 / 250.0, "{by_swath} {of_swath}");
            let (sin, cos) = contact.psi_rad.sin_cos();
            let sides_m = [WHEEL.width_m, 2.0 * contact.half_width_m];
            let triangles_m2 = sides_m.map(|side_m| side_m.powi(2) * sin * cos);
            let triangles = triangles_m2.iter().sum::<f64>() / (long_m * wide_m);
            let more = path.untouched_share(&patch) - by_swath;
            let off = (more - triangles).abs();
            assert!(off < 0.3 * triangles, "{more} instead of {triangles}");
        }
    }

    /// The crowned block, whose swath differs along the border: planes along it leave no more than
    /// lines of constant parameters, and all lines lead along the whole face. Planes that lean by a
    /// fifth cross the border by that of the crown's rise of 5 mm, 1 mm of 60 on each side.
    #[test]
    fn planes_along_a_crowned_block_leave_no_strip() {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let file = root.join("assets/surfaces/crowned_block.obj");
        let face = MeshFace {
            mesh: MeshFile { file, unit_m: 1e-3 },
            point_m: Vector3::new(0.05, 0.03, 0.0245),
            crease_rad: 0.5,
            deviation_m: 0.03e-3,
            u_along: None,
        };
        let patch = face.load().expect("a face");
        let leaning = Vector3::new(0.0, 1.0, 0.2);
        for (normal, more) in [
            (Vector3::y(), 0.005),
            (Vector3::x(), 0.005),
            (leaning, 0.033),
        ] {
            let path = planned(&patch, planes(normal), 0.2e-3);
            let least = path.lines.iter().map(Vec::len).min().unwrap_or(0);
            assert!(least > 20, "{normal:?}: {least}");
            let left = path.left(&patch, swath);
            let other = planned(&patch, Strategy::IsoParametric, 0.2e-3);
            let other = other.left(&patch, swath);
            assert!(left <= other + more, "{normal:?}: {left} {other}");
        }
    }

    /// Faces drawn at random, planes of normals drawn at random that lie along a border seen from
    /// above: no more is left than lines of constant parameters leave.
    #[test]
    fn planes_on_drawn_faces_leave_no_more_than_constant_parameters() {
        for seed in 0..6 {
            let patch = of(drawn::patch(&drawn::heights(seed), 5e-3, 0.0));
            let (lean, is_across) = seeded(seed, &(-0.3..0.3_f64, proptest::bool::ANY));
            let normal = match is_across {
                true => Vector3::new(1.0, 0.0, lean),
                false => Vector3::new(0.0, 1.0, lean),
            };
            let left = planned(&patch, planes(normal), 1e-3).left(&patch, swath);
            let other = planned(&patch, Strategy::IsoParametric, 1e-3);
            let other = other.left(&patch, swath);
            assert!(
                left <= other + 0.01,
                "seed {seed}, {normal:?}: {left} {other}"
            );
        }
    }
}
