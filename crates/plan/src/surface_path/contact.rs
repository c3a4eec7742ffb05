//! The wheel at one place of a surface.

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, Unit, UnitQuaternion, Vector3};

use super::axis::{AxisTrial, Place, widest_along};
use super::error::SurfacePathError;
use super::wheel::ContactWheel;
use crate::surface::{Forms, Surface, continue_line};

/// Where the wheel's axis points within the tangent plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AxisRule {
    /// Along the least curvature in magnitude, the published rule. It does not look at the feed:
    /// where that runs along the least curvature too, the wheel travels along its own axis and its
    /// swath shrinks to the contact width. At umbilics the axis before is kept, at the first point
    /// that across the feed.
    LeastCurvature,
    /// The widest effective swath among axes that do not gouge and whose edge gap keeps a limit,
    /// less what a line as a whole gives away for an axis that does not jump.
    WidestSwath { edge_gap_limit_m: f64 },
}

/// The wheel's place and what it does there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    pub u: f64,
    pub v: f64,
    pub point_m: Vector3<f64>,
    /// Outward normal.
    pub normal: Unit<Vector3<f64>>,
    /// Direction of the feed.
    pub feed: Unit<Vector3<f64>>,
    /// Direction of the wheel's axis; its sign follows the point before.
    pub axis: Unit<Vector3<f64>>,
    /// Centre of the wheel, O = P + (R − k h) n, m.
    pub centre_m: Vector3<f64>,
    /// ψ, angle between feed and axis, 0 to π/2, rad.
    pub psi_rad: f64,
    /// Effective swath across the feed, W sin ψ + 2 b cos ψ, m.
    pub swath_m: f64,
    /// Length of the contact along the feed, W cos ψ + 2 b sin ψ, m.
    pub reach_m: f64,
    /// |κ| W²/8 along the axis: gap under the wheel's edges where the surface is convex, depth that
    /// they cut where it is hollow, m.
    pub edge_gap_m: f64,
    /// Normal curvature across the axis, 1/m.
    pub curvature_across_per_m: f64,
    /// Half-width of the contact line, m.
    pub half_width_m: f64,
    /// Curvature of the gap that the wheel, as it passes, leaves across the feed, 1/m: at a
    /// distance s from the line the gap is half of that times s². Negative where the surface is
    /// hollow across the feed.
    pub gap_curvature_per_m: f64,
    /// Whether the surface has no direction of least curvature here.
    pub umbilic: bool,
}

impl Contact {
    /// The contact at parameters (u, v) with the feed along (du, dv), the sign of the axis after
    /// `before` (without it, along r_u; if the axis is square to that, n × r_u).
    ///
    /// # Errors
    /// If the surface has no normal there, the wheel gouges, or no axis keeps the rule's limits.
    pub fn at(
        surface: &dyn Surface,
        wheel: &ContactWheel,
        rule: AxisRule,
        uv: [f64; 2],
        feed: [f64; 2],
        before: Option<&Unit<Vector3<f64>>>,
    ) -> Result<Self, SurfacePathError> {
        let place = [Place::at(surface, uv, feed)?];
        let chosen = match rule {
            AxisRule::LeastCurvature => vec![flattest(&place[0], wheel, before)?],
            AxisRule::WidestSwath { edge_gap_limit_m } => {
                widest_along(&place, wheel, edge_gap_limit_m)?
            }
        };
        let [place] = place;
        let mut all = chosen
            .into_iter()
            .map(|one| Self::of(&place, wheel, one, before));
        all.next()
            .ok_or(SurfacePathError::WiderThanFace { swath_mm: 0.0 })
    }

    /// Contacts along a line, at parameters (u, v) with the feed along (du, dv); the axes are those
    /// of the line as a whole, and keep their sign.
    ///
    /// # Errors
    /// As [`Contact::at`], at the first place where that is so.
    pub fn along(
        surface: &dyn Surface,
        wheel: &ContactWheel,
        rule: AxisRule,
        line: impl Iterator<Item = [[f64; 2]; 2]>,
    ) -> Result<Vec<Self>, SurfacePathError> {
        let places = line.map(|[uv, feed]| Place::at(surface, uv, feed));
        let places = places.collect::<Result<Vec<Place>, _>>()?;
        let mut contacts: Vec<Self> = Vec::with_capacity(places.len());
        let mut widest = match rule {
            AxisRule::LeastCurvature => Vec::new(),
            AxisRule::WidestSwath { edge_gap_limit_m } => {
                widest_along(&places, wheel, edge_gap_limit_m)?
            }
        }
        .into_iter();
        for place in &places {
            let before = contacts.last().map(|contact| contact.axis);
            let before = before.as_ref();
            let chosen = match widest.next() {
                Some(chosen) => chosen,
                None => flattest(place, wheel, before)?,
            };
            contacts.push(Self::of(place, wheel, chosen, before));
        }
        Ok(contacts)
    }

    /// The contact at a place with its axis.
    fn of(
        place: &Place,
        wheel: &ContactWheel,
        chosen: AxisTrial,
        before: Option<&Unit<Vector3<f64>>>,
    ) -> Self {
        let Place {
            uv: [u, v],
            jet,
            forms,
            feed,
        } = place;
        let along = Unit::new_normalize(jet.first_m[0]);
        let axis = match before {
            Some(before) => continue_line(before, chosen.axis),
            None if along.dot(&chosen.axis).abs() > 1e-9 => continue_line(&along, chosen.axis),
            None => continue_line(
                &Unit::new_normalize(forms.normal.cross(&along)),
                chosen.axis,
            ),
        };
        let (sin, cos) = chosen.psi_rad.sin_cos();
        let lift_m = wheel.radius_m - wheel.indentation_m;
        Self {
            u: *u,
            v: *v,
            point_m: jet.point_m,
            normal: forms.normal,
            feed: *feed,
            axis,
            centre_m: jet.point_m + forms.normal.into_inner() * lift_m,
            psi_rad: chosen.psi_rad,
            swath_m: chosen.swath_m,
            reach_m: wheel.width_m * cos + 2.0 * chosen.half_width_m * sin,
            edge_gap_m: chosen.edge_gap_m,
            curvature_across_per_m: chosen.across_per_m,
            half_width_m: chosen.half_width_m,
            gap_curvature_per_m: gap_curvature_per_m(forms, wheel.radius_m, feed, &axis),
            umbilic: forms.curvatures().flattest().is_none(),
        }
    }

    /// Distance of lines that leave a ridge of this height between them, √(8 h/κ) with κ the gap's
    /// curvature, m; infinite where the gap is flat. Where the surface is hollow across the feed
    /// its edges cut by as much as the middle would stand off, and κ counts by magnitude.
    #[must_use]
    pub fn ridge_spacing_m(&self, scallop_m: f64) -> f64 {
        (8.0 * scallop_m / self.gap_curvature_per_m.abs()).sqrt()
    }

    /// Pose of the tool, its point at the wheel's centre: y along the axis, z into the surface, x =
    /// y × z.
    #[must_use]
    pub fn pose(&self) -> Isometry3<f64> {
        wheel_pose(self.centre_m, &self.axis, &self.normal)
    }
}

/// Pose of the tool of a wheel with its centre there: y along the axis, z against the normal of the
/// surface, x = y × z.
#[must_use]
pub fn wheel_pose(
    centre_m: Vector3<f64>,
    axis: &Unit<Vector3<f64>>,
    normal: &Unit<Vector3<f64>>,
) -> Isometry3<f64> {
    let (y, z) = (axis.into_inner(), -normal.into_inner());
    let axes = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[y.cross(&z), y, z]));
    let rotation = UnitQuaternion::from_rotation_matrix(&axes);
    Isometry3::from_parts(Translation3::from(centre_m), rotation)
}

/// Curvature across the feed of the gap that is left when the wheel has passed.
///
/// To second order the gap between wheel and surface is ½ xᵀ D x about the contact, D = K + (1 − a
/// aᵀ)/R with K the surface's curvature and a the axis. What is left at s across the feed f is the
/// least of it along the feed, ½ (D_ss − D_fs²/D_ff) s².
fn gap_curvature_per_m(
    forms: &Forms,
    radius_m: f64,
    feed: &Unit<Vector3<f64>>,
    axis: &Unit<Vector3<f64>>,
) -> f64 {
    let side = forms.normal.cross(feed);
    let [af, across] = [axis.dot(feed), axis.dot(&side)];
    let [kf, ks] = [feed.as_ref(), &side].map(|d| forms.curvature_along_per_m(d));
    let kfs = forms.curvature_along_per_m(&(feed.as_ref() + side)) - 0.5 * (kf + ks);
    let dff = kf + (1.0 - af * af) / radius_m;
    let dss = ks + (1.0 - across * across) / radius_m;
    let dfs = kfs - af * across / radius_m;
    if dff > 0.0 {
        dss - dfs * dfs / dff
    } else {
        dss
    }
}

/// The axis along the least curvature; at an umbilic that before, at the first point across the
/// feed.
fn flattest(
    place: &Place,
    wheel: &ContactWheel,
    before: Option<&Unit<Vector3<f64>>>,
) -> Result<AxisTrial, SurfacePathError> {
    let kept = || before.and_then(|axis| place.forms.tangent(axis));
    let axis = place.forms.curvatures().flattest().or_else(kept);
    let found = place.trial(wheel, axis.unwrap_or_else(|| place.across()));
    found.map_err(|across_per_m| place.gouge(wheel, across_per_m))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    use crate::surface::PlanePatch;
    use crate::surface::cylinder::CylinderPatch;
    use crate::surface::spoke::Spoke;
    use crate::surface_path::wheel::tests::PUBLISHED;

    fn at(rule: AxisRule, u: f64, v: f64) -> Contact {
        Contact::at(&Spoke, &PUBLISHED, rule, [u, v], [1.0, 0.0], None).expect("a contact")
    }

    /// `docs/physics/surfaces.md`: wheel centres to 1e-3 mm, ψ to the digit given, edge gaps of 286
    /// to 482 µm, and the swath trap: 6.1 mm of a 25 mm wheel.
    #[test]
    fn verify_wheel_centres_and_the_swath_trap() {
        let rows = [
            (0.25, 0.25, [39.433, -27.822, 52.826], 3.2),
            (0.5, 0.5, [100.0, 0.0, 64.5], 0.0),
            (0.75, 0.8, [160.111, 30.764, 53.098], 14.0),
        ];
        for (u, v, centre_mm, psi_deg) in rows {
            let found = at(AxisRule::LeastCurvature, u, v);
            let off = (found.centre_m * 1e3 - Vector3::from(centre_mm)).amax();
            assert!(off < 1e-3, "{off}");
            assert!(
                (found.psi_rad.to_degrees() - psi_deg).abs() < 0.05,
                "{}",
                found.psi_rad
            );
        }
        let gaps = rows.map(|(u, v, ..)| at(AxisRule::LeastCurvature, u, v).edge_gap_m * 1e6);
        assert!(
            (gaps[2] - 286.0).abs() < 0.5 && (gaps[1] - 482.0).abs() < 0.5,
            "{gaps:?}"
        );
        let swath_mm = at(AxisRule::LeastCurvature, 0.25, 0.25).swath_m * 1e3;
        assert!((swath_mm - 6.1).abs() < 0.05, "{swath_mm}");
    }

    /// With 0.5 mm of edge gap allowed, the rule makes the swath at least twice as wide at the
    /// trap's place.
    #[test]
    fn verify_the_widest_swath_keeps_its_limit_and_is_wider() {
        let rule = AxisRule::WidestSwath {
            edge_gap_limit_m: 0.5e-3,
        };
        for (u, v) in [(0.25, 0.25), (0.5, 0.5), (0.75, 0.8)] {
            let (paper, wide) = (at(AxisRule::LeastCurvature, u, v), at(rule, u, v));
            assert!(wide.edge_gap_m <= 0.5e-3);
            assert!(
                wide.swath_m > paper.swath_m,
                "{} {}",
                wide.swath_m,
                paper.swath_m
            );
        }
        assert!(
            at(rule, 0.25, 0.25).swath_m > 2.0 * at(AxisRule::LeastCurvature, 0.25, 0.25).swath_m
        );
        let tight = AxisRule::WidestSwath {
            edge_gap_limit_m: 0.1e-3,
        };
        let refused = Contact::at(&Spoke, &PUBLISHED, tight, [0.5, 0.5], [1.0, 0.0], None);
        let told = refused.expect_err("too tight").to_string();
        assert!(
            told.contains("u = 0.5000") && told.contains("0.4819 mm"),
            "{told}"
        );
    }

    #[test]
    fn verify_an_umbilic_keeps_the_axis_before() {
        let plane = PlanePatch::new(Vector3::zeros(), Vector3::x() * 0.1, Vector3::y() * 0.1)
            .expect("a plane");
        let rule = AxisRule::LeastCurvature;
        let contact = |before| {
            Contact::at(&plane, &PUBLISHED, rule, [0.5, 0.5], [1.0, 0.0], before).expect("flat")
        };
        let alone = contact(None);
        assert!(alone.umbilic && (alone.psi_rad - FRAC_PI_2).abs() < 1e-12);
        let before = Unit::new_normalize(Vector3::new(-1.0, -1.0, 0.3));
        let after = contact(Some(&before));
        assert!((after.axis.xy() + Vector3::new(1.0, 1.0, 0.0).xy().normalize()).norm() < 1e-12);
    }

    /// A bore takes a wheel smaller than itself along its axis, and no larger one.
    #[test]
    fn a_wheel_larger_than_the_bore_is_refused() {
        let bore = |radius_m: f64| {
            CylinderPatch::new(
                Vector3::zeros(),
                Vector3::y_axis(),
                Vector3::z_axis(),
                -radius_m,
                [-0.5, 0.5],
                0.1,
            )
        };
        let lay = |radius_m| {
            let (rule, feed) = (AxisRule::LeastCurvature, [1.0, 0.0]);
            Contact::at(&bore(radius_m), &PUBLISHED, rule, [0.5, 0.5], feed, None)
        };
        assert!(lay(0.0401).is_ok());
        let told = lay(0.0399).expect_err("gouges").to_string();
        assert!(
            told.contains("39.900 mm") && told.contains("u = 0.5000"),
            "{told}"
        );
        let wide = AxisRule::WidestSwath {
            edge_gap_limit_m: 1.0,
        };
        let far = Contact::at(
            &bore(0.0399),
            &PUBLISHED,
            wide,
            [0.5, 0.5],
            [1.0, 0.0],
            None,
        );
        assert!(
            far.is_ok_and(|c| c.curvature_across_per_m > -25.0),
            "turned, it fits"
        );
    }
}
