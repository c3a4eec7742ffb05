//! Where a wheel's sections meet the face: nearest points of a patch, found anew in every step.
//!
//! A strip of the wheel lies in the plane across its axis through the strip's middle. The face's
//! section with that plane is nearest to the axis where `(r - c)·a = 0` and `(r - c)·(N × a) = 0`,
//! N = r_u × r_v, c on the axis a. Newton's iteration with the patch's own derivatives takes two or
//! three steps. Beyond the patch's borders the surface goes on as its Taylor polynomial of second
//! order, so that a wheel that overhangs has a nearest point, too, and the border a place.

use nalgebra::{Matrix2, Point3, Unit, Vector2, Vector3};
use std::sync::Arc;
use truecut_plan::surface::{Domain, Forms, Jet, PatchFile};

/// Samples along each parameter from which a search starts.
const SAMPLES: usize = 33;
/// Most steps of Newton's iteration.
const MOST_STEPS: usize = 20;
/// A step shorter than this part of the domain ends it.
const SMALL_STEP: f64 = 1e-11;

/// The face under a wheel, in the patch's frame.
#[derive(Debug, Clone)]
pub(in crate::process) struct FaceGeometry {
    patch: Arc<PatchFile>,
    domain: Domain,
    samples: Vec<(Point3<f64>, [f64; 2])>,
    /// No point of the face is further from a sample, m.
    apart_m: f64,
}

/// Where a section of the wheel is nearest to the face.
#[derive(Debug, Clone, Copy)]
pub(in crate::process) struct Section {
    pub uv: [f64; 2],
    pub point_m: Point3<f64>,
    /// Outward normal of the face.
    pub normal: Unit<Vector3<f64>>,
    /// r_u and r_v.
    pub first_m: [Vector3<f64>; 2],
    /// From the face to the axis, square to the axis, of length 1.
    pub to_axis: Vector3<f64>,
    /// Distance of the face from the axis in the section.
    pub distance_m: f64,
    /// Curvature of the section, convex positive.
    pub curvature_per_m: f64,
}

/// The point of the face nearest to another.
#[derive(Debug, Clone, Copy)]
pub(in crate::process) struct Foot {
    pub uv: [f64; 2],
    pub point_m: Point3<f64>,
    /// r_u and r_v.
    pub first_m: [Vector3<f64>; 2],
    /// Outward normal of the face.
    pub normal: Unit<Vector3<f64>>,
    /// Height of the other over the face, along the normal.
    pub height_m: f64,
    /// Principal curvatures, convex positive.
    pub curvatures_per_m: [f64; 2],
}

impl Section {
    /// Parameters of the place where a short way from here leads, to first order.
    pub fn moved_uv(&self, way_m: &Vector3<f64>) -> [f64; 2] {
        let [ru, rv] = self.first_m;
        let across = ru.cross(&rv);
        let square = across.norm_squared();
        let [u, v] = self.uv;
        [
            u + way_m.cross(&rv).dot(&across) / square,
            v + ru.cross(way_m).dot(&across) / square,
        ]
    }
}

impl FaceGeometry {
    pub fn new(patch: Arc<PatchFile>) -> Self {
        let domain = patch.surface.domain();
        let at = |range: [f64; 2], k: usize| {
            range[0] + (range[1] - range[0]) * k as f64 / (SAMPLES - 1) as f64
        };
        let samples: Vec<(Point3<f64>, [f64; 2])> = (0..SAMPLES * SAMPLES)
            .map(|i| {
                let uv = [at(domain.u, i / SAMPLES), at(domain.v, i % SAMPLES)];
                (patch.surface.point_m(uv[0], uv[1]).into(), uv)
            })
            .collect();
        let corner = |i: usize, j: usize| samples[i * SAMPLES + j].0;
        let cells = (0..SAMPLES - 1).flat_map(|i| (0..SAMPLES - 1).map(move |j| (i, j)));
        let diagonals = cells.map(|(i, j)| {
            let [one, other] = [
                corner(i + 1, j + 1) - corner(i, j),
                corner(i + 1, j) - corner(i, j + 1),
            ];
            one.norm().max(other.norm())
        });
        // Half of it would do on a plane.
        let apart_m = diagonals.fold(0.0, f64::max);
        Self {
            patch,
            domain,
            samples,
            apart_m,
        }
    }

    pub fn domain(&self) -> Domain {
        self.domain
    }

    /// Parameters near a point; none if every point of the face is further away than `reach_m`.
    pub fn near(&self, point_m: &Point3<f64>, reach_m: f64) -> Option<[f64; 2]> {
        let square = |sample: &Point3<f64>| (sample - point_m).norm_squared();
        let all = self.samples.iter().map(|(at, uv)| (square(at), *uv));
        let (nearest, uv) = all.min_by(|a, b| a.0.total_cmp(&b.0))?;
        (nearest.sqrt() <= reach_m + self.apart_m).then_some(uv)
    }

    /// Point and derivatives, continued beyond the borders.
    fn jet(&self, [u, v]: [f64; 2]) -> Jet {
        let (inner_u, inner_v) = (
            u.clamp(self.domain.u[0], self.domain.u[1]),
            v.clamp(self.domain.v[0], self.domain.v[1]),
        );
        let mut jet = self.patch.surface.jet(inner_u, inner_v);
        let (du, dv) = (u - inner_u, v - inner_v);
        if du != 0.0 || dv != 0.0 {
            let [ru, rv] = jet.first_m;
            let [ruu, ruv, rvv] = jet.second_m;
            let bend = ruu * (0.5 * du * du) + ruv * (du * dv) + rvv * (0.5 * dv * dv);
            jet.point_m += ru * du + rv * dv + bend;
            jet.first_m = [ru + ruu * du + ruv * dv, rv + ruv * du + rvv * dv];
        }
        jet
    }

    /// The section through `centre_m` across `axis`, sought from `seed`; none if there is no
    /// nearest point in reach.
    pub fn section(
        &self,
        centre_m: &Point3<f64>,
        axis: &Vector3<f64>,
        seed: [f64; 2],
    ) -> Option<Section> {
        let step = |jet: &Jet| newton_step(jet, centre_m, axis);
        self.converged(seed, step, |uv, jet| {
            Self::resolved(uv, jet, centre_m, axis)
        })
    }

    /// What is found at the place to which Newton's steps lead.
    fn converged<T>(
        &self,
        seed: [f64; 2],
        step: impl Fn(&Jet) -> Option<Vector2<f64>>,
        found: impl Fn([f64; 2], &Jet) -> Option<T>,
    ) -> Option<T> {
        let spans = [self.domain.u, self.domain.v].map(|range| range[1] - range[0]);
        let mut uv = seed;
        for _ in 0..MOST_STEPS {
            let jet = self.jet(uv);
            let step = step(&jet)?;
            // Converged: what the step would still change is less than rounding leaves.
            if (0..2).all(|i| step[i].abs() <= SMALL_STEP * spans[i]) {
                return found(uv, &jet);
            }
            for i in 0..2 {
                uv[i] += step[i].clamp(-0.25 * spans[i], 0.25 * spans[i]);
                // Further out there is nothing of the face that a wheel could reach.
                let range = [self.domain.u, self.domain.v][i];
                uv[i] = uv[i].clamp(range[0] - 0.5 * spans[i], range[1] + 0.5 * spans[i]);
            }
        }
        None
    }

    fn resolved(
        uv: [f64; 2],
        jet: &Jet,
        centre_m: &Point3<f64>,
        axis: &Vector3<f64>,
    ) -> Option<Section> {
        let forms = Forms::of(jet)?;
        let normal = forms.normal;
        let off_axis = normal.dot(axis);
        let to_axis = (normal.into_inner() - axis * off_axis).try_normalize(1e-6)?;
        let across = axis.cross(&normal).try_normalize(1e-6)?;
        // Meusnier: the section stands askew to the normal.
        let curvature_per_m = forms.curvature_along_per_m(&across) / normal.dot(&to_axis);
        let point_m = Point3::from(jet.point_m);
        Some(Section {
            uv,
            point_m,
            normal,
            first_m: jet.first_m,
            distance_m: (centre_m - point_m).dot(&to_axis),
            to_axis,
            curvature_per_m,
        })
    }

    /// The point nearest to another, sought from `seed`; none if the search does not come to one.
    pub fn foot(&self, point_m: &Point3<f64>, seed: [f64; 2]) -> Option<Foot> {
        self.converged(
            seed,
            |jet| foot_step(jet, point_m),
            |uv, jet| {
                let forms = Forms::of(jet)?;
                let curvatures = forms.curvatures();
                Some(Foot {
                    uv,
                    point_m: jet.point_m.into(),
                    first_m: jet.first_m,
                    normal: forms.normal,
                    height_m: (point_m.coords - jet.point_m).dot(&forms.normal),
                    curvatures_per_m: [curvatures.min_per_m, curvatures.max_per_m],
                })
            },
        )
    }

    /// Whether a point of the face lies within the boundary of its patch, if that has one.
    pub fn is_within(
        &self,
        section: &Section,
        along: &Vector3<f64>,
        across: &Vector3<f64>,
    ) -> bool {
        self.patch.boundary.as_ref().is_none_or(|boundary| {
            boundary.holds_rectangle(&section.point_m.coords, [*along, *across], [0.0; 2])
        })
    }
}

/// Newton's step in (u, v) towards the nearest point of the section.
fn newton_step(jet: &Jet, centre_m: &Point3<f64>, axis: &Vector3<f64>) -> Option<Vector2<f64>> {
    let [ru, rv] = jet.first_m;
    let [ruu, ruv, rvv] = jet.second_m;
    let from_centre = jet.point_m - centre_m.coords;
    let tangent = ru.cross(&rv).cross(axis);
    let turned_u = (ruu.cross(&rv) + ru.cross(&ruv)).cross(axis);
    let turned_v = (ruv.cross(&rv) + ru.cross(&rvv)).cross(axis);
    let misses = Vector2::new(from_centre.dot(axis), from_centre.dot(&tangent));
    let slopes = Matrix2::new(
        ru.dot(axis),
        rv.dot(axis),
        ru.dot(&tangent) + from_centre.dot(&turned_u),
        rv.dot(&tangent) + from_centre.dot(&turned_v),
    );
    // Rows of different dimensions: each by its own size.
    let sizes = [slopes.row(0).norm(), slopes.row(1).norm()];
    if sizes.iter().any(|size| !size.is_normal()) {
        return None;
    }
    let scaled = Matrix2::new(
        slopes[(0, 0)] / sizes[0],
        slopes[(0, 1)] / sizes[0],
        slopes[(1, 0)] / sizes[1],
        slopes[(1, 1)] / sizes[1],
    );
    let inverse = scaled.try_inverse()?;
    Some(-(inverse * Vector2::new(misses.x / sizes[0], misses.y / sizes[1])))
}

/// Newton's step in (u, v) towards the nearest point of the face.
fn foot_step(jet: &Jet, point_m: &Point3<f64>) -> Option<Vector2<f64>> {
    let ([ru, rv], [ruu, ruv, rvv]) = (jet.first_m, jet.second_m);
    let off = point_m.coords - jet.point_m;
    let mixed = ru.dot(&rv) - off.dot(&ruv);
    let slopes = Matrix2::new(
        ru.dot(&ru) - off.dot(&ruu),
        mixed,
        mixed,
        rv.dot(&rv) - off.dot(&rvv),
    );
    let inverse = slopes.try_inverse()?;
    Some(inverse * Vector2::new(off.dot(&ru), off.dot(&rv)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn asset(name: &str) -> FaceGeometry {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/surfaces");
        FaceGeometry::new(Arc::new(PatchFile::load(&folder.join(name)).unwrap()))
    }

    /// A wheel set over a place of the bumpy spoke along the normal finds that place, its curvature
    /// and its distance again; tilted and shifted it finds a point that is square to section and
    /// axis.
    #[test]
    fn verify_nearest_points_on_the_spoke() {
        let face = asset("hub_spoke.toml");
        for [u, v] in [[0.1, 0.5], [0.4, 0.2], [0.61, 0.5], [0.93, 0.8]] {
            let jet = face.jet([u, v]);
            let forms = Forms::of(&jet).unwrap();
            let axis = jet.first_m[1].normalize();
            let centre = Point3::from(jet.point_m + forms.normal.into_inner() * 39.5e-3);
            let seed = face.near(&centre, 40e-3).unwrap();
            let found = face.section(&centre, &axis, seed).unwrap();
            assert!((found.uv[0] - u).abs() < 1e-9 && (found.uv[1] - v).abs() < 1e-9);
            assert!((found.distance_m - 39.5e-3).abs() < 1e-12);
            let across = axis.cross(&forms.normal);
            let curvature = forms.curvature_along_per_m(&across);
            assert!((found.curvature_per_m / curvature - 1.0).abs() < 1e-9);
            let foot = face.foot(&(centre + jet.first_m[0].normalize() * 1e-9), seed);
            let foot = foot.unwrap();
            assert!((foot.height_m - 39.5e-3).abs() < 1e-12);
            assert!((foot.point_m.coords - jet.point_m).norm() < 5e-9);
            let beside = centre + axis * 10e-3;
            let strip = face.section(&beside, &axis, found.uv).unwrap();
            let way = beside - strip.point_m;
            assert!(way.dot(&axis).abs() < 1e-12);
            assert!((way.norm() - strip.distance_m).abs() < 1e-12);
        }
    }

    /// Beyond the border the nearest point has parameters outside the domain; far above there is
    /// none to look at.
    #[test]
    fn a_wheel_beside_the_face_or_far_above_is_told() {
        let face = asset("mould_top.toml");
        let domain = face.domain();
        let (middle, normal) = {
            let jet = face.jet([domain.u[1], 0.5 * (domain.v[0] + domain.v[1])]);
            (jet, Forms::of(&jet).unwrap().normal.into_inner())
        };
        let axis = middle.first_m[1].normalize();
        let off = middle.first_m[0].normalize() * 3e-3;
        let centre = Point3::from(middle.point_m + off + normal * 39.5e-3);
        let seed = face.near(&centre, 42e-3).unwrap();
        let found = face.section(&centre, &axis, seed).unwrap();
        assert!(found.uv[0] > domain.u[1]);
        assert!(face.near(&(centre + normal * 0.1), 42e-3).is_none());
    }
}
