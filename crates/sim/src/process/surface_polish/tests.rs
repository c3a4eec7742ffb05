use super::*;
use crate::loads::Loads;
use crate::process::cells_within;
use nalgebra::{Matrix3, Point3, Rotation3};
use std::path::Path;
use truecut_core::roughness::Polishing;
use truecut_core::wheel::curved::Curved;
use truecut_plan::surface::Forms;

const WHEEL: PneumaticWheel = PneumaticWheel {
    radius_m: 20e-3,
    pressure_pa: 0.1e6,
    shell_thickness_m: 5e-3,
    youngs_modulus_pa: 4e6,
    poisson: 0.49,
    damping_pa_s_per_m: 0.0,
};
const MU: f64 = 0.3;
const SPIN: f64 = 60.0;
const PRESSED_M: f64 = 0.3e-3;

fn patch(text: &str) -> PatchFile {
    PatchFile::from_text(text, Path::new("face.toml")).unwrap()
}

fn plane() -> PatchFile {
    patch(
        "kind = \"plane\"\noutside = [0, 0, 1]\ncorner_mm = [0, 0, 0]\nside_u_mm = [60, 0, 0]\n\
         side_v_mm = [0, 40, 0]\n",
    )
}

fn spoke() -> PatchFile {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/surfaces");
    PatchFile::load(&folder.join("hub_spoke.toml")).unwrap()
}

fn process(patch: PatchFile, world_from_patch: Isometry3<f64>) -> SurfacePolish {
    let cells = Cells::of(&patch, 1e-3);
    let patch = Arc::new(patch);
    let is_face = Arc::new(cells_within(&cells, patch.clone()));
    SurfacePolish::new(SurfacePolishSetup {
        shell: Arc::new(WHEEL.shell()),
        wheel: WHEEL,
        spin_rad_s: SPIN,
        eccentricity_m: [0.0; 2],
        abrasive: Abrasive {
            mu: MU,
            preston_per_pa: 2e-12,
            polishing: Polishing {
                initial_m: 0.8e-6,
                final_m: 0.1e-6,
                dose_j_per_m2: 5e4,
            },
        },
        control: ForceControl::Position,
        world_from_patch,
        process_from_world: UnitQuaternion::from_euler_angles(0.2, -0.1, 0.7),
        area_m2: Arc::new(cells.areas_m2(&patch)),
        is_inner: is_face.clone(),
        is_face,
        cells,
        patch,
        indentation_m: PRESSED_M,
        first_normal: world_from_patch.rotation * Vector3::z(),
        expected_depth_m: 1e-6,
    })
}

/// The wheel over a place, its axis leaning by a tilt towards an angle from the first parameter.
fn over(patch: &PatchFile, uv: [f64; 2], [tilt, angle]: [f64; 2]) -> Isometry3<f64> {
    let jet = patch.surface.jet(uv[0], uv[1]);
    let n = Forms::of(&jet).unwrap().normal.into_inner();
    let x = jet.first_m[0].normalize();
    let away = n * tilt.cos() + (x * angle.cos() + n.cross(&x) * angle.sin()) * tilt.sin();
    let z = -away;
    let side = (x - z * z.dot(&x)).normalize();
    let axes = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[side, z.cross(&side), z]));
    let centre = Point3::from(jet.point_m + n * (WHEEL.radius_m - PRESSED_M));
    Isometry3::from_parts(
        centre.coords.into(),
        UnitQuaternion::from_rotation_matrix(&axes),
    )
}

fn state(world_from_patch: &Isometry3<f64>, patch_from_tool: Isometry3<f64>) -> ToolState {
    ToolState {
        world_from_tool: world_from_patch * patch_from_tool,
        ..ToolState::default()
    }
}

/// Force and moment of the loads, back in the patch's frame.
fn in_patch(process: &SurfacePolish, loads: &Loads) -> [Vector3<f64>; 2] {
    let p = &process.setup;
    let back = p.world_from_patch.rotation.inverse() * p.process_from_world.inverse();
    [
        back * loads.wrenches[0].force_n,
        back * loads.wrenches[0].moment_n_m,
    ]
}

/// On a plane, wherever it stands and the axis leans, the force is the wheel's on a plane; the
/// wheel's surface slides square to the lean at `ω (R − d) sin θ`, and rubs the face that way. The
/// moment about the tool's point is that of the friction at its lever, and the spin about the
/// normal.
#[test]
fn verify_forces_on_a_plane() {
    let stands = Isometry3::new(Vector3::new(1.0, 0.2, 0.4), Vector3::new(0.4, -0.3, 1.1));
    let process = process(plane(), stands);
    for (tilt, angle) in [(0.35, 0.4), (0.6, 2.5), (0.2, -2.0)] {
        let patch_from_tool = over(&process.setup.patch, [0.4, 0.6], [tilt, angle]);
        let loads = process.evaluate(&state(&stands, patch_from_tool));
        let [force, moment] = in_patch(&process, &loads);
        let expected_n = WHEEL.normal_force_n(PRESSED_M);
        assert!((force.z / expected_n - 1.0).abs() < 1e-3, "{}", force.z);
        // ω × (−h z), ω = ω0 (sin θ cos α, sin θ sin α, cos θ).
        let slides = Vector3::new(-angle.sin(), angle.cos(), 0.0);
        let on_tool = -force.xy().dot(&slides.xy());
        // What of the patch slides otherwise than its middle takes a little of it.
        let share = on_tool / (MU * force.z);
        assert!((0.97..1.0).contains(&share), "{share}");
        let across = force.x * angle.cos() + force.y * angle.sin();
        assert!(across.abs() < 1e-9 * force.z, "{across}");
        let height_m = WHEEL.radius_m - PRESSED_M;
        let lever = Vector3::new(0.0, 0.0, -height_m).cross(&Vector3::new(force.x, force.y, 0.0));
        let left = moment - lever;
        assert!(left.xy().norm() < 1e-9, "{left}");
        assert!(left.z < 0.0, "friction holds the spin back: {}", left.z);
    }
}

/// On a bumpy face the wheel, set down along the normal, finds its place again and presses along
/// the normal as by similarity at the curvatures there.
#[test]
fn verify_forces_on_a_bumpy_face_are_those_of_its_curvatures() {
    let stands = Isometry3::translation(0.9, 0.0, 0.3);
    let process = process(spoke(), stands);
    let patch = process.setup.patch.clone();
    let mut differs = 0;
    for (u, v) in [(0.1, 0.5), (0.3, 0.7), (0.52, 0.35), (0.8, 0.5)] {
        let jet = patch.surface.jet(u, v);
        let forms = Forms::of(&jet).unwrap();
        let curvatures = forms.curvatures();
        let both = [curvatures.min_per_m, curvatures.max_per_m];
        let curved = Curved::new(WHEEL.radius_m, both).unwrap();
        let expected_n = curved
            .wheel(&WHEEL)
            .normal_force_n(curved.indentation_m(PRESSED_M));
        let loads = process.evaluate(&state(&stands, over(&patch, [u, v], [0.3, 1.0])));
        let [force, _] = in_patch(&process, &loads);
        let normal_n = force.dot(&forms.normal);
        assert!(
            (normal_n / expected_n - 1.0).abs() < 1e-3,
            "{normal_n} {expected_n}"
        );
        let off_plane = expected_n / WHEEL.normal_force_n(PRESSED_M) - 1.0;
        differs += usize::from(off_plane.abs() > 0.02);
    }
    assert!(differs >= 2, "the face is curved");
}

/// What Preston's integral gives is taken off the face, nothing lost on the way over it.
#[test]
fn verify_what_is_rubbed_is_taken_off() {
    let stands = Isometry3::translation(0.9, 0.0, 0.3);
    let mut process = process(spoke(), stands);
    let dt_s = 1e-3;
    for step in 0..400 {
        let along = 0.3 + 0.3 * f64::from(step) / 400.0;
        let pose = over(
            &process.setup.patch,
            [along, 0.5],
            [0.3, 0.02 * f64::from(step)],
        );
        let state = ToolState {
            time_s: f64::from(step) * dt_s,
            ..state(&stands, pose)
        };
        let loads = process.evaluate(&state);
        process.commit(&state, &loads, &ContactOutcomes::default(), dt_s);
    }
    let found = process.finish().scalars;
    let value = |name: &str| found.iter().find(|one| one.name == name).unwrap().value;
    let removed_m3 = value("surface_polish.removed_volume");
    let preston_m3 = value("surface_polish.preston_volume");
    assert!(removed_m3 > 0.0 && (removed_m3 / preston_m3 - 1.0).abs() < 1e-9);
    // k_p F v t with the sliding of the middle.
    let force_n = value("surface_polish.mean_force");
    let slid_m = SPIN * (WHEEL.radius_m - PRESSED_M) * 0.3_f64.sin() * 0.4;
    let expected_m3 = 2e-12 * force_n * slid_m;
    assert!(
        (removed_m3 / expected_m3 - 1.0).abs() < 0.02,
        "{removed_m3} {expected_m3}"
    );
    assert!((value("surface_polish.contact_time") - 400.0 * dt_s).abs() < 1e-9);
}
