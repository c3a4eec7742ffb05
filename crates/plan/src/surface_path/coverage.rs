//! How much of a face no line covers.

use nalgebra::Vector3;

use super::contact::Contact;
use super::lines::SurfacePath;
use crate::surface::{Domain, Forms, PatchFile};

/// Cells along each parameter of the patch.
const CELLS: usize = 250;

/// Contacts are looked at this part of their length apart.
const PART_OF_REACH: f64 = 0.25;

/// How much further than half a contact's diagonal cells are looked for: the face is curved.
const FURTHER: f64 = 1.25;

/// Cells of a patch: their middles, and whether a contact has passed over them.
struct Cells {
    domain: Domain,
    middles_m: Vec<Vector3<f64>>,
    touched: Vec<bool>,
}

impl SurfacePath {
    /// Share of the face, its boundary and holes left out, that lies under no contact: cut into 250
    /// by 250 cells, each looked at in its middle. A contact covers the rectangle of its swath and
    /// its length along the feed.
    #[must_use]
    pub fn untouched_share(&self, patch: &PatchFile) -> f64 {
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
            let alone = match line.as_slice() {
                [only] => Some([only, only]),
                _ => None,
            };
            let pairs = line.windows(2).map(|pair| [&pair[0], &pair[1]]);
            for pair in pairs.chain(alone) {
                let way_m = (pair[1].point_m - pair[0].point_m).norm();
                let reach_m = pair[0].reach_m.min(pair[1].reach_m);
                let count = (way_m / (PART_OF_REACH * reach_m)).ceil().max(1.0) as usize;
                for k in 0..=count {
                    let t = k as f64 / count as f64;
                    let near = if t < 0.5 { pair[0] } else { pair[1] };
                    let [u, v] = [(pair[0].u, pair[1].u), (pair[0].v, pair[1].v)]
                        .map(|(a, b)| a + t * (b - a));
                    let jet = surface.jet(u, v);
                    cells.touch([u, v], &jet.point_m, jet.first_m, near);
                }
            }
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

    /// Marks what lies under a contact at a place, its size and directions those of `near`.
    fn touch(
        &mut self,
        at: [f64; 2],
        point_m: &Vector3<f64>,
        [ru, rv]: [Vector3<f64>; 2],
        near: &Contact,
    ) {
        let half_m = [0.5 * near.reach_m, 0.5 * near.swath_m];
        let side = near.normal.cross(&near.feed);
        // Parameters as far away as the contact's corner: along u that is r √(G/(EG − F²)).
        let area = ru.cross(&rv).norm();
        let far_m = FURTHER * half_m[0].hypot(half_m[1]);
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
                let from_m = self.middles_m[cell] - point_m;
                let under = from_m.dot(&near.feed).abs() <= half_m[0]
                    && from_m.dot(&side).abs() <= half_m[1];
                self.touched[cell] |= under;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Unit, Vector3};

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
            let askew = planned(&patch, planes(normal), 0.1e-3).untouched_share(&patch);
            let with_borders = Strategy::ParallelPlane {
                normal: Unit::new_normalize(normal),
                along_borders: true,
            };
            let left = planned(&patch, with_borders, 0.1e-3).untouched_share(&patch);
            assert!(left < 0.005, "seed {seed}, {turn}: {left} of {askew}");
            left_before = left_before.max(askew);
        }
        assert!(left_before > 0.1, "{left_before}");
    }

    /// A single line along a plane leaves what is not under its swath, to a cell on each side.
    #[test]
    fn verify_what_a_line_leaves_of_a_drawn_plane() {
        for seed in 0..10 {
            let (long_m, wide_m) = seeded(seed, &(0.05..0.2_f64, 0.03..0.1_f64));
            let (along, up) = (Vector3::x() * long_m, Vector3::y() * wide_m);
            let plane = PlanePatch::new(Vector3::zeros(), along, up).expect("a plane");
            let patch = of(plane);
            let mut path = planned(&patch, Strategy::IsoParametric, 0.1e-3);
            path.lines.truncate(1);
            let expected = 1.0 - path.lines[0][0].swath_m / wide_m;
            let found = path.untouched_share(&patch);
            assert!((found - expected).abs() < 1.0 / 250.0, "{found} {expected}");
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
            let left = path.untouched_share(&patch);
            let other = planned(&patch, Strategy::IsoParametric, 0.2e-3).untouched_share(&patch);
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
            let left = planned(&patch, planes(normal), 1e-3).untouched_share(&patch);
            let other = planned(&patch, Strategy::IsoParametric, 1e-3).untouched_share(&patch);
            assert!(
                left <= other + 0.01,
                "seed {seed}, {normal:?}: {left} {other}"
            );
        }
    }
}
