use super::*;
use crate::surface::drawn::{self, seeded};
use crate::surface::part::PartOptions;
use crate::surface::{NurbsPatch, PlanePatch, Surface};
use crate::surface_path::{
    AxisRule, ContactWheel, FeedAlong, PathOptions, Strategy, SurfacePath, plan_path,
};
use nalgebra::{Isometry3, Translation3, UnitQuaternion};
use proptest::prelude::*;
use truecut_arm::MeshData;

const CREASE_RAD: f64 = 0.52;

/// A closed mesh.
struct Body {
    vertices: Vec<Vector3<f64>>,
    triangles: Vec<[u32; 3]>,
}

impl Body {
    /// A grid of points, seen from above row by row along x then y, on a bottom at z = 0.
    fn under(points: &[Vec<Vector3<f64>>]) -> Self {
        let (rows, columns) = (points.len(), points[0].len());
        let mut vertices: Vec<Vector3<f64>> = points.iter().flatten().copied().collect();
        let below = vertices.len() as u32;
        let low: Vec<_> = vertices
            .iter()
            .map(|p| Vector3::new(p.x, p.y, 0.0))
            .collect();
        vertices.extend(low);
        let at = |i: usize, j: usize| (i * columns + j) as u32;
        let mut triangles = Vec::new();
        for i in 1..rows {
            for j in 1..columns {
                let [a, b, c, d] = [at(i - 1, j - 1), at(i, j - 1), at(i, j), at(i - 1, j)];
                triangles.extend([[a, b, c], [a, c, d]]);
                let [a, b, c, d] = [a, b, c, d].map(|k| k + below);
                triangles.extend([[a, c, b], [a, d, c]]);
            }
        }
        let mut around: Vec<u32> = (0..rows - 1).map(|i| at(i, 0)).collect();
        around.extend((0..columns - 1).map(|j| at(rows - 1, j)));
        around.extend((1..rows).rev().map(|i| at(i, columns - 1)));
        around.extend((1..columns).rev().map(|j| at(0, j)));
        for k in 0..around.len() {
            let (a, b) = (around[k], around[(k + 1) % around.len()]);
            triangles.extend([[a, a + below, b + below], [a, b + below, b]]);
        }
        Self {
            vertices,
            triangles,
        }
    }

    /// A ring 10 mm thick about z.
    fn ring(outer_m: f64, inner_m: f64, corners: usize) -> Self {
        let point = |radius: f64, z: f64, k: usize| {
            let (sin, cos) = (std::f64::consts::TAU * k as f64 / corners as f64).sin_cos();
            Vector3::new(radius * cos, radius * sin, z)
        };
        let mut vertices = Vec::new();
        for (radius, z) in [
            (outer_m, 0.01),
            (inner_m, 0.01),
            (inner_m, 0.0),
            (outer_m, 0.0),
        ] {
            vertices.extend((0..corners).map(|k| point(radius, z, k)));
        }
        let at = |circle: usize, k: usize| ((circle % 4) * corners + k % corners) as u32;
        let mut triangles = Vec::new();
        for circle in 0..4 {
            for k in 0..corners {
                let (a, b) = (at(circle, k), at(circle, k + 1));
                let (c, d) = (at(circle + 1, k + 1), at(circle + 1, k));
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        Self {
            vertices,
            triangles,
        }
    }

    fn moved(mut self, by: &Isometry3<f64>) -> Self {
        self.vertices
            .iter_mut()
            .for_each(|p| *p = by * nalgebra::Point3::from(*p) - nalgebra::Point3::origin());
        self
    }

    fn part(&self) -> Part {
        let options = PartOptions {
            unit_m: 1.0,
            crease_rad: CREASE_RAD,
            weld_m: None,
        };
        let data = MeshData {
            vertices: self.vertices.clone(),
            triangles: self.triangles.clone(),
            ..MeshData::default()
        };
        Part::of(data, &options, &|_| {}).expect("a part")
    }
}

fn face_at(point_m: Vector3<f64>) -> MeshFace {
    MeshFace {
        mesh: MeshFile {
            file: "drawn.stl".into(),
            unit_m: 1.0,
        },
        point_m,
        crease_rad: CREASE_RAD,
        deviation_m: 0.03e-3,
        u_along: None,
    }
}

/// Places from 0 to 1, the inner ones moved at random by up to a third of a gap.
fn jittered(seed: u8, gaps: usize) -> Vec<f64> {
    let moves: Vec<f64> = seeded(seed, &prop::collection::vec(-0.33..0.33_f64, gaps + 1));
    let place = |k: usize| match k {
        0 => 0.0,
        k if k == gaps => 1.0,
        k => (k as f64 + moves[k]) / gaps as f64,
    };
    (0..=gaps).map(place).collect()
}

fn meshed(surface: &dyn Surface, seed: u8, gaps: [usize; 2]) -> Body {
    let (us, vs) = (
        jittered(seed, gaps[0]),
        jittered(seed.wrapping_add(99), gaps[1]),
    );
    let row = |u: &f64| vs.iter().map(|v| surface.point_m(*u, *v)).collect();
    Body::under(&us.iter().map(row).collect::<Vec<_>>())
}

fn drawn_place(seed: u8) -> Isometry3<f64> {
    let six = prop::collection::vec(-3.0..3.0_f64, 6);
    let by = seeded(seed, &six);
    Isometry3::from_parts(
        Translation3::new(by[0] * 0.1, by[1] * 0.1, by[2] * 0.1),
        UnitQuaternion::from_euler_angles(by[3], by[4], by[5]),
    )
}

/// Distance of a point from a patch by Newton's method from the nearest of a grid.
fn distance_m(patch: &NurbsPatch, point_m: &Vector3<f64>) -> f64 {
    let away = |uv: &[f64; 2]| (patch.point_m(uv[0], uv[1]) - point_m).norm();
    let grid = (0..13 * 13).map(|k| [(k / 13) as f64 / 12.0, (k % 13) as f64 / 12.0]);
    let mut uv = grid
        .min_by(|a, b| away(a).total_cmp(&away(b)))
        .expect("a place");
    for _ in 0..30 {
        let jet = patch.jet(uv[0], uv[1]);
        let way = point_m - jet.point_m;
        let [ru, rv] = jet.first_m;
        let (e, f, g) = (ru.dot(&ru), ru.dot(&rv), rv.dot(&rv));
        let (p, q) = (way.dot(&ru), way.dot(&rv));
        let det = e * g - f * f;
        uv[0] = (uv[0] + (g * p - f * q) / det).clamp(0.0, 1.0);
        uv[1] = (uv[1] + (e * q - f * p) / det).clamp(0.0, 1.0);
    }
    away(&uv)
}

/// Bodies under B-spline surfaces drawn at random, meshed unevenly, turned anyhow in space: the
/// patch keeps the limit, which the chords of the meshes keep, too, and lies no farther from the
/// true surface than it says of the mesh.
#[test]
fn verify_faces_of_drawn_bodies_lie_within_their_stated_deviation() {
    for seed in (0..10).chain(140..150) {
        let (rise_m, bow_m, fine) = seeded(seed, &(0.0..4e-3, -0.01..0.02, 90..120_usize));
        let truth = drawn::patch(&drawn::heights(seed), rise_m, bow_m);
        let place = drawn_place(seed);
        let body = meshed(&truth, seed, [2 * fine, fine]).moved(&place);
        let on = place * nalgebra::Point3::from(truth.point_m(0.5, 0.5));
        let patch = face_at(on.coords).of(&body.part()).expect("a face");
        let fit = patch.fit.as_ref().expect("a fit");
        assert!(
            fit.has_four_sides && patch.boundary.is_none(),
            "seed {seed}: {fit:?}"
        );
        assert!(fit.deviation_m <= 0.03e-3 && fit.at_vertices_m <= fit.deviation_m);
        let mut most_m = 0.0_f64;
        for k in 0..25 * 25 {
            let at = patch
                .surface
                .point_m((k / 25) as f64 / 24.0, (k % 25) as f64 / 24.0);
            let back = place.inverse() * nalgebra::Point3::from(at);
            most_m = most_m.max(distance_m(&truth, &back.coords));
        }
        assert!(
            most_m <= fit.deviation_m,
            "seed {seed}: {most_m} of {fit:?}"
        );
        // u runs along the longer side: 160 mm by 100.
        let way = patch.surface.point_m(1.0, 0.5) - patch.surface.point_m(0.0, 0.5);
        assert!(way.norm() > 0.15, "seed {seed}: {way:?}");
    }
}

const WHEEL: ContactWheel = ContactWheel {
    radius_m: 0.02,
    width_m: 0.012,
    indentation_m: 0.0,
    line_load_n_per_m: 1200.0,
    modulus_pa: 8e6,
};

fn lines(patch: &PatchFile, margin_m: f64) -> SurfacePath {
    let options = PathOptions {
        rule: AxisRule::WidestSwath {
            edge_gap_limit_m: 1e-3,
        },
        overlap: 0.1,
        step_m: 2e-3,
        margin_m,
    };
    let (surface, boundary) = (patch.surface.as_ref(), patch.boundary.as_ref());
    plan_path(
        surface,
        boundary,
        &WHEEL,
        Strategy::IsoParametric,
        FeedAlong::U,
        &options,
    )
    .expect("a path")
}

/// On arches and slanted planes drawn at random, meshed and fitted, all gaps of lines are the same
/// to 1 %, measured across them in mm.
#[test]
fn verify_lines_on_faces_of_drawn_meshes_are_spaced_evenly() {
    for seed in 0..10 {
        let (bow_m, wide_m, fine) = seeded(seed, &(0.0..0.02, 0.04..0.12, 30..60_usize));
        let truth = Arch { bow_m, wide_m };
        let place = drawn_place(seed);
        let body = meshed(&truth, seed, [2 * fine, fine]).moved(&place);
        let on = place * nalgebra::Point3::from(truth.point_m(0.5, 0.5));
        let patch = face_at(on.coords).of(&body.part()).expect("a face");
        let path = lines(&patch, 0.0);
        let across = place.rotation * Vector3::y();
        let at =
            |line: &Vec<crate::surface_path::Contact>| line[line.len() / 2].point_m.dot(&across);
        let gaps: Vec<f64> = path
            .lines
            .windows(2)
            .map(|w| (at(&w[1]) - at(&w[0])).abs())
            .collect();
        assert!(gaps.len() > 2, "seed {seed}: {gaps:?}");
        let mean = gaps.iter().sum::<f64>() / gaps.len() as f64;
        assert!(
            gaps.iter().all(|gap| (gap / mean - 1.0).abs() < 0.01),
            "seed {seed}: {gaps:?}"
        );
    }
}

/// An arch along x over 200 mm.
struct Arch {
    bow_m: f64,
    wide_m: f64,
}

impl Surface for Arch {
    fn domain(&self) -> crate::surface::Domain {
        crate::surface::Domain::UNIT
    }

    fn jet(&self, u: f64, v: f64) -> crate::surface::Jet {
        let [slope, bend] = [4.0 * self.bow_m * (1.0 - 2.0 * u), -8.0 * self.bow_m];
        let z = 0.03 + 4.0 * self.bow_m * u * (1.0 - u);
        crate::surface::Jet {
            point_m: Vector3::new(0.2 * u, self.wide_m * v, z),
            first_m: [Vector3::new(0.2, 0.0, slope), Vector3::y() * self.wide_m],
            second_m: [Vector3::z() * bend, Vector3::zeros(), Vector3::zeros()],
        }
    }
}

/// Discs and rings drawn at random: no contact reaches over the rim or into the hole.
#[test]
fn lines_on_rings_keep_clear_of_rim_and_hole() {
    for seed in 0..8 {
        let (outer_m, share, corners) = seeded(seed, &(0.06..0.15, 0.15..0.4, 90..200_usize));
        let inner_m = share * outer_m;
        let place = drawn_place(seed);
        let body = Body::ring(outer_m, inner_m, corners).moved(&place);
        let on = place * nalgebra::Point3::new(0.5 * (inner_m + outer_m), 0.0, 0.01);
        let patch = face_at(on.coords).of(&body.part()).expect("a face");
        let fit = patch.fit.as_ref().expect("a fit");
        assert!(
            !fit.has_four_sides && fit.holes == 1,
            "seed {seed}: {fit:?}"
        );
        assert!(fit.deviation_m < 1e-7, "a plane, seed {seed}: {fit:?}");
        let path = lines(&patch, 1e-3);
        assert!(path.lines.len() > 4, "seed {seed}: {}", path.lines.len());
        for contact in path.lines.iter().flatten() {
            let across = contact.normal.cross(&contact.feed) * (0.5 * contact.swath_m);
            let along = contact.feed.into_inner() * (0.5 * contact.reach_m);
            for corner in [
                along + across,
                along - across,
                across - along,
                -along - across,
            ] {
                let at = place.inverse() * nalgebra::Point3::from(contact.point_m + corner);
                let radius_m = at.coords.xy().norm();
                let apothem_m = inner_m * (std::f64::consts::PI / corners as f64).cos();
                assert!(
                    radius_m >= apothem_m && radius_m <= outer_m,
                    "seed {seed}: {radius_m}"
                );
            }
        }
    }
}

/// u follows the direction that is asked for, whichever way the face lies.
#[test]
fn u_follows_the_direction_asked_for() {
    let plane = PlanePatch::new(Vector3::z() * 0.02, Vector3::x() * 0.1, Vector3::y() * 0.06)
        .expect("a plane");
    let part = meshed(&plane, 3, [5, 4]).part();
    for way in [Vector3::x(), Vector3::y(), -Vector3::x(), -Vector3::y()] {
        let face = MeshFace {
            u_along: Some(way),
            ..face_at(Vector3::new(0.03, 0.03, 0.02))
        };
        let patch = face.of(&part).expect("a face");
        let jet = patch.surface.jet(0.4, 0.7);
        assert!(jet.first_m[0].normalize().dot(&way) > 1.0 - 1e-9, "{jet:?}");
        assert!(jet.first_m[0].cross(&jet.first_m[1]).z > 0.0);
    }
}

#[test]
fn faces_that_cannot_be_fitted_are_refused() {
    let refuse =
        |body: &Body, face: &MeshFace| face.of(&body.part()).expect_err("no face").to_string();
    let ring = Body::ring(0.05, 0.02, 60);
    let on = face_at(Vector3::new(0.035, 0.0, 0.01));
    let told = refuse(&ring, &face_at(Vector3::new(0.035, 0.0, 0.012)));
    assert!(told.contains("2.0000 mm off the part"), "{told}");
    // Its outer wall goes all round.
    let told = refuse(&ring, &face_at(Vector3::new(0.05, 0.0, 0.005)));
    assert!(told.contains("closes on itself"), "{told}");
    let open = Body {
        triangles: ring.triangles[1..].to_vec(),
        vertices: ring.vertices.clone(),
    };
    let told = refuse(&open, &on);
    assert!(told.contains("3 open edges"), "{told}");
    let inside_out = Body {
        triangles: ring
            .triangles
            .iter()
            .map(|[a, b, c]| [*a, *c, *b])
            .collect(),
        vertices: ring.vertices.clone(),
    };
    assert!(refuse(&inside_out, &on).contains("inverted normals"));
    // A coarse mesh of an arch tells the face no nearer than its chords.
    let arch = Arch {
        bow_m: 0.02,
        wide_m: 0.1,
    };
    let told = refuse(
        &meshed(&arch, 1, [12, 12]),
        &face_at(arch.point_m(0.5, 0.5)),
    );
    assert!(told.contains("the limit is 0.0300 mm"), "{told}");
    // It meets the walls at its ends by less than the crease angle, so that they belong to it.
    let steep = Arch {
        bow_m: 0.25,
        wide_m: 0.1,
    };
    let told = refuse(
        &meshed(&steep, 2, [120, 8]),
        &face_at(steep.point_m(0.5, 0.5)),
    );
    assert!(told.contains("stands at 90.0 deg"), "{told}");
    assert!(told.contains("by 75 deg"), "{told}");
}
