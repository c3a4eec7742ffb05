//! From the tables of a path job to what plans its lines: shared by `truecut path` and by runs along a job.

use nalgebra::{Isometry3, Unit, UnitQuaternion, Vector3};
use truecut_plan::surface::PatchFile;
use truecut_plan::surface_path::{
    AxisRule, ContactWheel, FeedAlong, PathOptions, Strategy, SurfacePath, SurfacePathError,
    Symmetry, plan_path,
};
use truecut_scenario::path_job::{
    self, AxisSpec, Carrier, ContactWheelSpec, PathSpec, PlaceSpec, StrategySpec, SymmetrySpec,
};

/// Lines of contacts on a patch, in its frame.
///
/// # Errors
/// As [`plan_path`].
pub fn lines(
    path: &PathSpec,
    wheel: &ContactWheelSpec,
    patch: &PatchFile,
) -> Result<SurfacePath, SurfacePathError> {
    let (strategy, overlap) = match path.strategy {
        StrategySpec::IsoParametric { overlap } => (Strategy::IsoParametric, overlap),
        StrategySpec::IsoScallop { scallop_m, overlap } => {
            (Strategy::IsoScallop { scallop_m }, overlap)
        }
        StrategySpec::ParallelPlane { overlap, normal } => {
            let normal = Unit::new_normalize(Vector3::from(normal));
            (Strategy::ParallelPlane { normal }, overlap)
        }
    };
    let options = PathOptions {
        rule: match path.axis {
            AxisSpec::LeastCurvature => AxisRule::LeastCurvature,
            AxisSpec::WidestSwath { edge_gap_limit_m } => {
                AxisRule::WidestSwath { edge_gap_limit_m }
            }
        },
        overlap,
        step_m: path.step_m,
        margin_m: path.margin_m,
    };
    let along = match path.feed_along {
        path_job::FeedAlong::U => FeedAlong::U,
        path_job::FeedAlong::V => FeedAlong::V,
    };
    plan_path(
        patch.surface.as_ref(),
        patch.boundary.as_ref(),
        &contact_wheel(wheel),
        strategy,
        along,
        &options,
    )
}

/// The wheel as a planner sees it.
#[must_use]
pub fn contact_wheel(wheel: &ContactWheelSpec) -> ContactWheel {
    ContactWheel {
        radius_m: wheel.radius_m,
        width_m: wheel.width_m,
        indentation_m: wheel.indentation_m,
        line_load_n_per_m: wheel.line_load_n_per_m,
        modulus_pa: wheel.modulus_pa,
    }
}

/// Copies about an axis.
#[must_use]
pub fn symmetry(spec: &SymmetrySpec) -> Symmetry {
    Symmetry {
        count: spec.count,
        centre_m: spec.centre_m.into(),
        axis: Unit::new_normalize(spec.axis.into()),
        turntable: matches!(spec.carrier, Carrier::Turntable { .. }),
    }
}

/// Where something stands, as a transform.
#[must_use]
pub fn pose(place: &PlaceSpec) -> Isometry3<f64> {
    let [roll, pitch, yaw] = place.rpy_rad;
    let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
    Isometry3::from_parts(Vector3::from(place.xyz_m).into(), rotation)
}
