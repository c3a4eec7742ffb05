//! Frames at the flange and the load that a controller is told of.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use toml::Spanned;

use super::{ConfigFile, ConfigReader, RawFrame};
use crate::doubts;
use crate::error::{ArmError, ArmErrorKind};
use crate::model::ToolLoad;

impl ConfigFile<'_> {
    /// What speaks against the angles of the frames.
    pub(super) fn frame_doubts(&self) -> Vec<String> {
        let frames = [
            ("tool", &self.raw.frames.tool),
            ("foot", &self.raw.frames.foot),
        ];
        let doubts = frames.into_iter().filter_map(|(name, frame)| {
            let rpy_deg = frame.as_ref()?.rpy_deg.as_ref()?;
            doubts::of_frame_angles(name, *rpy_deg.get_ref())
        });
        doubts.collect()
    }

    pub(super) fn tool_load(&self, faults: &mut Vec<ArmError>) -> Option<ToolLoad> {
        let raw = self.raw.tool_load.as_ref()?;
        let before = faults.len();
        let mut refuse = |place: usize, key: &str, value: f64, rule: &str| {
            let text = format!("`tool_load.{key}` is {value}; it must be {rule}");
            faults.push(self.reader().error(place, ArmErrorKind::Toml(text)));
        };
        let (mass_kg, center_m) = (*raw.mass_kg.get_ref(), *raw.center_m.get_ref());
        if !(mass_kg.is_finite() && mass_kg > 0.0) {
            let place = raw.mass_kg.span().start;
            refuse(place, "mass_kg", mass_kg, "above 0 and finite");
        }
        if let Some(bad) = center_m.iter().find(|part| !part.is_finite()) {
            refuse(raw.center_m.span().start, "center_m", *bad, "finite");
        }
        (faults.len() == before).then(|| ToolLoad {
            mass_kg,
            centre_m: center_m.into(),
        })
    }
}

impl ConfigReader<'_> {
    pub(super) fn frame(
        &self,
        name: &'static str,
        raw: Option<&RawFrame>,
        faults: &mut Vec<ArmError>,
    ) -> Option<Isometry3<f64>> {
        let raw = raw?;
        let mut numbers = |key: &'static str, value: &Option<Spanned<[f64; 3]>>| {
            let Some(value) = value else {
                return [0.0; 3];
            };
            if let Some(&bad) = value.get_ref().iter().find(|v| !v.is_finite()) {
                let kind = ArmErrorKind::FrameValue {
                    frame: name,
                    key,
                    value: bad,
                };
                faults.push(self.error(value.span().start, kind));
            }
            *value.get_ref()
        };
        let millimetres = Vector3::from(numbers("xyz_mm", &raw.xyz_mm));
        let xyz_m = Vector3::from(numbers("xyz_m", &raw.xyz_m)) + millimetres / 1e3;
        let [roll, pitch, yaw] = numbers("rpy_deg", &raw.rpy_deg).map(f64::to_radians);
        if let (Some(_), Some(second)) = (&raw.xyz_m, &raw.xyz_mm) {
            let text = format!("frame `{name}` has its origin twice: xyz_m and xyz_mm");
            faults.push(self.error(second.span().start, ArmErrorKind::Toml(text)));
        }
        Some(Isometry3::from_parts(
            Translation3::from(xyz_m),
            UnitQuaternion::from_euler_angles(roll, pitch, yaw),
        ))
    }
}
