//! Patches from TOML files.
//!
//! ```toml
//! kind = "nurbs"
//! outside = [0.0, 0.0, 1.0]        # a direction within 90° of every normal
//! degree = [3, 3]                  # in u and v
//! knots_u = [0, 0, 0, 0, 1, 1, 1, 1]
//! knots_v = [0, 0, 0, 0, 1, 1, 1, 1]
//! control_points_mm = [[[0, 0, 0]]]  # a row for each u, a point for each v
//! weights = [[1]]                  # optional, of the same shape
//! boundary_mm = [[0, 0, 0]]        # optional closed line around the face, ends where it begins
//! ```
//!
//! `kind = "plane"` takes `corner_mm`, `side_u_mm` and `side_v_mm` instead.

use std::path::Path;

use nalgebra::{Unit, Vector3};
use schemars::JsonSchema;
use serde::Deserialize;
use toml::Spanned;

use super::error::{SurfaceError, SurfaceFault};
use super::{Boundary, FaceFit, Forms, NurbsPatch, PlanePatch, Surface};

use crate::bounds::OutOfBounds;

/// Normals are checked at this many places along each parameter.
const CHECKED: usize = 25;

/// What a patch may be: a rational B-spline surface, a parallelogram.
const NURBS: &str = "nurbs";
const PLANE: &str = "plane";

/// A patch of a surface: a B-spline surface or a plane, in a frame of its own.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "truecut surface")]
struct RawPatch {
    /// What the patch is: a rational B-spline surface (nurbs) or a parallelogram (plane).
    #[schemars(with = "String", extend("enum" = [NURBS, PLANE]))]
    kind: Spanned<String>,
    /// A direction out of the part, of any length, less than 90 degrees from every normal.
    #[schemars(with = "[f64; 3]")]
    outside: Spanned<[f64; 3]>,
    /// Degrees along u and v, 1 to 25 (nurbs).
    #[schemars(with = "Option<[usize; 2]>")]
    degree: Option<Spanned<[usize; 2]>>,
    /// Knots along u, as many as points and degree and one, none below the one before (nurbs).
    #[schemars(with = "Option<Vec<f64>>")]
    knots_u: Option<Spanned<Vec<f64>>>,
    /// Knots along v (nurbs).
    #[schemars(with = "Option<Vec<f64>>")]
    knots_v: Option<Spanned<Vec<f64>>>,
    /// A row for each u, in it a point for each v (nurbs).
    #[schemars(with = "Option<Vec<Vec<[f64; 3]>>>")]
    control_points_mm: Option<Spanned<Vec<Vec<[f64; 3]>>>>,
    /// Weights of the control points, of the same shape, above 0. Default: all 1 (nurbs).
    #[schemars(with = "Option<Vec<Vec<f64>>>")]
    weights: Option<Spanned<Vec<Vec<f64>>>>,
    /// The corner u = v = 0 (plane).
    #[schemars(with = "Option<[f64; 3]>")]
    corner_mm: Option<Spanned<[f64; 3]>>,
    /// The side along u, from the corner (plane).
    #[schemars(with = "Option<[f64; 3]>")]
    side_u_mm: Option<Spanned<[f64; 3]>>,
    /// The side along v, from the corner (plane).
    #[schemars(with = "Option<[f64; 3]>")]
    side_v_mm: Option<Spanned<[f64; 3]>>,
    /// Corners of a closed line on the face, the first repeated at the end. Default: the borders of
    /// the patch bound the face.
    #[schemars(with = "Option<Vec<[f64; 3]>>")]
    boundary_mm: Option<Spanned<Vec<[f64; 3]>>>,
}

/// A patch with the boundary of its face, as read from a file or fitted to a mesh.
pub struct PatchFile {
    pub surface: Box<dyn Surface + Send>,
    pub boundary: Option<Boundary>,
    /// How near it comes to a face of a mesh that it was fitted to.
    pub fit: Option<FaceFit>,
}

impl std::fmt::Debug for PatchFile {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let domain = self.surface.domain();
        write!(f, "PatchFile over {domain:?}, boundary {:?}", self.boundary)
    }
}

impl PatchFile {
    /// JSON Schema of a patch's file, for editors.
    #[must_use]
    pub fn json_schema() -> serde_json::Value {
        schemars::schema_for!(RawPatch).to_value()
    }

    /// Reads a patch.
    ///
    /// # Errors
    /// One error, with file, line, key and rule, for the first fault found.
    pub fn load(path: &Path) -> Result<Self, SurfaceError> {
        let text = truecut_files::read_text(path)
            .map_err(|e| SurfaceError::in_file(path, None, SurfaceFault::Unreadable(e)))?;
        Self::from_text(&text, path)
    }

    /// As [`PatchFile::load`], from a text already read; errors name `path`.
    ///
    /// # Errors
    /// As [`PatchFile::load`].
    pub fn from_text(text: &str, path: &Path) -> Result<Self, SurfaceError> {
        let line = |at: usize| text[..at.min(text.len())].matches('\n').count() + 1;
        let error = |at: Option<usize>, fault| SurfaceError::in_file(path, at.map(line), fault);
        if let Some(at) = truecut_files::too_deep(text) {
            let most = truecut_files::MOST_NESTED;
            let rule = format!("arrays and inline tables nest more than {most} deep");
            return Err(error(Some(at), SurfaceFault::Syntax(rule)));
        }
        let raw: RawPatch = toml::from_str(text).map_err(|e: toml::de::Error| {
            let fault = SurfaceFault::Syntax(e.message().replace('\n', "; "));
            error(e.span().map(|s| s.start), fault)
        })?;
        let place = |fault: SurfaceFault| {
            let at = raw.place_of(&fault);
            error(Some(at), fault)
        };
        let surface = raw.surface().map_err(place)?;
        check_normals(surface.as_ref(), *raw.outside.get_ref()).map_err(place)?;
        let boundary = match &raw.boundary_mm {
            Some(points) => {
                let points: Vec<_> = points.get_ref().iter().map(|p| metres(*p)).collect();
                let made = Boundary::new(&points);
                Some(made.map_err(|fault| error(Some(points_at(&raw.boundary_mm)), fault))?)
            }
            None => None,
        };
        Ok(Self {
            surface,
            boundary,
            fit: None,
        })
    }
}

impl RawPatch {
    fn surface(&self) -> Result<Box<dyn Surface + Send>, SurfaceFault> {
        let of_nurbs = [
            ("degree", self.degree.is_some()),
            ("knots_u", self.knots_u.is_some()),
            ("knots_v", self.knots_v.is_some()),
            ("control_points_mm", self.control_points_mm.is_some()),
            ("weights", self.weights.is_some()),
        ];
        let of_planes = [
            ("corner_mm", self.corner_mm.is_some()),
            ("side_u_mm", self.side_u_mm.is_some()),
            ("side_v_mm", self.side_v_mm.is_some()),
        ];
        match self.kind.get_ref().as_str() {
            NURBS => {
                idle(NURBS, &of_planes)?;
                self.nurbs()
            }
            PLANE => {
                idle(PLANE, &of_nurbs)?;
                let need = |value: &Option<Spanned<[f64; 3]>>, key| {
                    get(value, key, PLANE).map(|mm| metres(*mm))
                };
                Ok(Box::new(PlanePatch::new(
                    need(&self.corner_mm, "corner_mm")?,
                    need(&self.side_u_mm, "side_u_mm")?,
                    need(&self.side_v_mm, "side_v_mm")?,
                )?))
            }
            other => {
                let (found, rule) = (format!("\"{other}\""), "\"nurbs\" or \"plane\"");
                Err(OutOfBounds::new("\"kind\"", found, rule).into())
            }
        }
    }

    fn nurbs(&self) -> Result<Box<dyn Surface + Send>, SurfaceFault> {
        let points = get(&self.control_points_mm, "control_points_mm", NURBS)?;
        let points: Vec<Vec<_>> = points
            .iter()
            .map(|row| row.iter().map(|p| metres(*p)).collect())
            .collect();
        let ones = || points.iter().map(|row| vec![1.0; row.len()]).collect();
        let weights = self
            .weights
            .as_ref()
            .map_or_else(ones, |w| w.get_ref().clone());
        let knots = [
            get(&self.knots_u, "knots_u", NURBS)?.clone(),
            get(&self.knots_v, "knots_v", NURBS)?.clone(),
        ];
        let degree = *get(&self.degree, "degree", NURBS)?;
        Ok(Box::new(NurbsPatch::new(degree, knots, &points, &weights)?))
    }

    /// Where in the text the value stands that a fault is about.
    fn place_of(&self, fault: &SurfaceFault) -> usize {
        let kind = self.kind.span().start;
        let knots = |direction: &str| match direction {
            "u" => points_at(&self.knots_u),
            _ => points_at(&self.knots_v),
        };
        match fault {
            SurfaceFault::KnotCount { direction, .. }
            | SurfaceFault::KnotsFall { direction, .. }
            | SurfaceFault::KnotsWithoutSpan { direction, .. }
            | SurfaceFault::KnotRepeated { direction, .. } => knots(direction),
            SurfaceFault::NotFinite {
                what: "knot of u", ..
            } => knots("u"),
            SurfaceFault::NotFinite {
                what: "knot of v", ..
            } => knots("v"),
            SurfaceFault::NotFinite { what: "corner", .. } => points_at(&self.corner_mm),
            SurfaceFault::NotFinite { what: "side u", .. } => points_at(&self.side_u_mm),
            SurfaceFault::NotFinite { what: "side v", .. } => points_at(&self.side_v_mm),
            SurfaceFault::NotFinite { .. } | SurfaceFault::TooFewPoints { .. } => {
                points_at(&self.control_points_mm)
            }
            SurfaceFault::Ragged {
                what: "control points",
                ..
            } => points_at(&self.control_points_mm),
            SurfaceFault::Ragged { .. } => points_at(&self.weights),
            SurfaceFault::OutOfBounds(number) => match &number.quantity {
                quantity if quantity.contains("weight") => points_at(&self.weights),
                quantity if quantity.contains("degree") => points_at(&self.degree),
                quantity if quantity.contains("outside") => self.outside.span().start,
                _ => kind,
            },
            SurfaceFault::InvertedNormal { .. } => self.outside.span().start,
            _ => kind,
        }
    }
}

fn points_at<T>(value: &Option<Spanned<T>>) -> usize {
    value.as_ref().map_or(0, |v| v.span().start)
}

fn get<'a, T>(
    value: &'a Option<Spanned<T>>,
    key: &'static str,
    kind: &'static str,
) -> Result<&'a T, SurfaceFault> {
    let found = value.as_ref().map(Spanned::get_ref);
    found.ok_or(SurfaceFault::MissingKey { key, kind })
}

fn idle(kind: &'static str, keys: &[(&'static str, bool)]) -> Result<(), SurfaceFault> {
    match keys.iter().find(|(_, given)| *given) {
        Some((key, _)) => Err(SurfaceFault::NoEffect { key, kind }),
        None => Ok(()),
    }
}

fn metres(mm: [f64; 3]) -> Vector3<f64> {
    Vector3::from(mm) * 1e-3
}

/// Normals exist everywhere on a grid (the border included) and stand within 90° of the outside.
pub(super) fn check_normals(surface: &dyn Surface, outside: [f64; 3]) -> Result<(), SurfaceFault> {
    let Some(outward) = Unit::try_new(Vector3::from(outside), 1e-9).filter(|u| u.x.is_finite())
    else {
        let (given, rule) = (format!("{outside:?}"), "a direction: finite and not 0");
        return Err(OutOfBounds::new("\"outside\"", given, rule).into());
    };
    let domain = surface.domain();
    for i in 0..CHECKED * CHECKED {
        let share = |k: usize| k as f64 / (CHECKED - 1) as f64;
        let at = |range: [f64; 2], k: usize| range[0] + share(k) * (range[1] - range[0]);
        let (u, v) = (at(domain.u, i / CHECKED), at(domain.v, i % CHECKED));
        let forms = Forms::at(&surface.jet(u, v), u, v)?;
        let cosine = forms.normal.dot(&outward);
        if cosine <= 0.0 {
            return Err(SurfaceFault::InvertedNormal {
                u,
                v,
                angle_deg: cosine.clamp(-1.0, 1.0).acos().to_degrees(),
            });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asset(name: &str) -> (String, std::path::PathBuf) {
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../../assets/surfaces")
            .join(name);
        (std::fs::read_to_string(&path).expect("the asset"), path)
    }

    #[test]
    fn assets_are_read() {
        for name in ["hub_spoke.toml", "mould_top.toml"] {
            let (text, path) = asset(name);
            let patch = PatchFile::from_text(&text, &path).expect("a patch");
            assert!(patch.boundary.is_some() == name.starts_with("mould"));
        }
        let (text, path) = asset("hub_spoke.toml");
        let spoke = PatchFile::from_text(&text, &path).expect("a patch").surface;
        let k = |u, v| Forms::of(&spoke.jet(u, v)).expect("regular").curvatures();
        let at = |i: usize| k((i / 20) as f64 / 19.0, (i % 20) as f64 / 19.0);
        let all: Vec<_> = (0..400).map(at).collect();
        assert!(
            all.iter().any(|k| k.min_per_m * k.max_per_m < 0.0),
            "bumps have saddles between them"
        );
        assert!(
            all.iter().all(|k| k.min_per_m > -1.0 / 0.05),
            "a wheel of 50 mm radius fits"
        );
    }

    /// The schema knows the keys that are read, each with what it means.
    #[test]
    fn the_schema_has_every_key() {
        let schema = PatchFile::json_schema();
        let known = schema["properties"].as_object().expect("properties");
        let is_told = |key: &serde_json::Value| key["description"].is_string();
        assert!(known.values().all(is_told), "{schema}");
        assert_eq!(schema["required"], serde_json::json!(["kind", "outside"]));
        for name in ["hub_spoke.toml", "mould_top.toml"] {
            let table: toml::Table = asset(name).0.parse().expect("a table");
            assert!(table.keys().all(|key| known.contains_key(key)), "{table}");
        }
        // A key that the schema knows is read: of a wrong type it is refused at its line.
        for key in known.keys() {
            let odd = format!("{key} = {{ odd = 1 }}\n");
            let refused = PatchFile::from_text(&odd, Path::new("odd.toml"));
            let told = refused.expect_err("another type").to_string();
            assert!(told.starts_with("odd.toml:1: invalid type"), "{told}");
        }
    }

    #[test]
    fn patches_of_the_documentation_are_read() {
        let page = include_str!("../../../../docs/plan_a_belt_path.md");
        let blocks = page.split("```toml\n").skip(1);
        let texts: Vec<&str> = blocks.filter_map(|rest| rest.split("```").next()).collect();
        assert_eq!(texts.len(), 2);
        for text in texts {
            PatchFile::from_text(text, Path::new("page.toml")).expect("a patch");
        }
    }

    /// One fault a case, put into the asset's text; the answer names the line, the value and the
    /// rule.
    #[test]
    fn faults_are_told_with_line_and_rule() {
        let (text, _) = asset("hub_spoke.toml");
        let refuse = |text: &str| {
            let refused = PatchFile::from_text(text, Path::new("spoke.toml"));
            refused.expect_err("a fault").to_string()
        };
        let with = |from: &str, to: &str| {
            assert!(text.contains(from), "{from}");
            refuse(&text.replacen(from, to, 1))
        };
        let line = |key: &str| text.lines().position(|l| l.starts_with(key)).expect("key") + 1;
        let place = |key| format!("spoke.toml:{}:", line(key));
        let nan = with("[[[0.0", "[[[nan");
        assert!(nan.contains("control point 1 is not finite"), "{nan}");
        let falls = with("knots_v = [0, 0, 0, 0, ", "knots_v = [0, 0, 0, 0.9, ");
        assert!(
            falls.contains(&place("knots_v")) && falls.contains("must not fall"),
            "{falls}"
        );
        let weight = with("weights = [[1,", "weights = [[-1,");
        assert!(
            weight.contains(&place("weights")) && weight.contains("above 0"),
            "{weight}"
        );
        let inverted = with("outside = [0.0, 0.0, 1.0]", "outside = [0.0, 0.0, -1.0]");
        assert!(
            inverted.contains(&place("outside")) && inverted.contains("inverted normals"),
            "{inverted}"
        );
        assert!(with("kind = \"nurbs\"", "kind = \"mesh\"").contains("\"nurbs\" or \"plane\""));
        assert!(with("degree = ", "corner_mm = [0, 0, 0]\ndegree = ").contains("no effect"));
        assert!(with("degree = ", "degre = ").contains("degre"));
        let (mould, _) = asset("mould_top.toml");
        let open = refuse(&mould.replacen(", [0.0, 0.0, 20.0]]", "]", 1));
        assert!(open.contains("is open"), "{open}");
    }
}
