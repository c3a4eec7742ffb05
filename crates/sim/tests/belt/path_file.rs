//! A belt led along a file in the place of its job's lines.

use super::shared::{below, belt, column, run_with, scalar};
use super::support::WHEEL;
use nalgebra::Isometry3;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Uniform};
use std::path::Path;
use tempfile::tempdir;
use truecut_recording::Recording;
use truecut_scenario::{BeltSpec, ProcessSpec};

const PRESTON: f64 = 4e-12;
const BELT: f64 = 15.0;
/// Where the face of the job stands, which is the work frame of these files.
const WORK: &str = "[1000, -100, 450]";

fn led(file: &Path, more: &[(&str, &str)]) -> Recording {
    let file = format!("{:?}", file.display().to_string());
    let given = [("path.file", &*file), ("path.work_xyz_mm", WORK)];
    run_with(&belt(&[]), &below("process.belt", &[&given, more].concat()))
}

fn job() -> BeltSpec {
    match belt(&[]).process {
        ProcessSpec::Belt(spec) => *spec,
        _ => panic!("a belt"),
    }
}

/// A row of poses; without a feed it is one of rapid traverse.
fn row(pose: &Isometry3<f64>, feed_mm_per_s: Option<f64>) -> String {
    let [x, y, z] = (pose.translation.vector * 1e3).into();
    let q = pose.rotation;
    let feed = feed_mm_per_s.map_or_else(String::new, |feed| feed.to_string());
    format!(
        "{x:.6},{y:.6},{z:.6},{feed},{:.9},{:.9},{:.9},{:.9}\n",
        q.w, q.i, q.j, q.k
    )
}

/// The job's own lines as a file of poses do the same to the face: force, volume and depth. At the
/// ends of lines the corner between down and along is blended either way.
#[test]
fn the_jobs_lines_from_a_file_do_the_same() {
    let job = job().job;
    let patch = job.surface.face.load().unwrap();
    let lines = job.path.lines(&job.wheel, &patch).unwrap();
    let feed_mm_per_s = job.path.feed_m_per_s * 1e3;
    let mut poses = String::from("x_mm,y_mm,z_mm,feed_mm_per_s,qw,qx,qy,qz\n");
    for line in lines.poses(job.path.lift_m) {
        poses.push_str(&row(&line[0], None));
        (line[1..].iter()).for_each(|pose| poses.push_str(&row(pose, Some(feed_mm_per_s))));
    }
    let folder = tempdir().unwrap();
    let file = folder.path().join("lines.csv");
    std::fs::write(&file, poses).unwrap();
    let (of_file, of_job) = (led(&file, &[]), run_with(&belt(&[]), &[]));
    for (name, within) in [
        ("belt.removed_volume", 0.01),
        ("belt.mean_force", 0.01),
        ("belt.contact_time", 0.01),
        ("belt.depth_mean", 0.01),
        ("belt.depth_swept", 0.01),
    ] {
        let (file, job) = (scalar(&of_file, name), scalar(&of_job, name));
        println!("{name}: {file:.6e} along the file, {job:.6e} by the job");
        assert!((file / job - 1.0).abs() < within, "{name}: {file} {job}");
    }
}

/// G-code of the point of contact, at depths, feeds and lines drawn from seeds: the force is that
/// of the wheel's law at the indentation that the arm leaves, and what is removed is Preston's.
#[test]
fn verify_a_wheel_along_gcode_presses_and_removes_by_its_laws() {
    let mut random = ChaCha8Rng::seed_from_u64(3002);
    let mut draw = |low: f64, high: f64| Uniform::new(low, high).unwrap().sample(&mut random);
    let folder = tempdir().unwrap();
    for case in 0..3 {
        let (depth_mm, feed) = (draw(0.15, 0.4), draw(1200.0, 3600.0));
        let ys = [draw(6.0, 9.0), draw(11.0, 14.0)];
        let code = format!(
            "G21 G90 G0 X10 Y{0} Z5\nG1 Z-{depth_mm} F{feed}\nX50\nZ5\nG0 X10 Y{1}\nG1 Z-{depth_mm}\nX50\nZ5\nM30\n",
            ys[0], ys[1]
        );
        let file = folder.path().join(format!("case{case}.nc"));
        std::fs::write(&file, code).unwrap();
        // The place of the rim that presses, below the wheel's centre.
        let recording = led(
            &file,
            &[("path.tool_xyz_mm", "[0, 0, 20]"), ("path.spin_deg", "0")],
        );
        let depth = column(&recording, "belt.indentation");
        let normal = column(&recording, "belt.normal_force");
        let u = column(&recording, "belt.position_u");
        let mut looked_at = 0;
        for k in (0..depth.len()).step_by(37) {
            if depth[k] > 0.0 && (0.3..0.7).contains(&u[k]) {
                let law = WHEEL.normal_force_n(depth[k], WHEEL.radius_m);
                // The arm's tilt under the load makes the strips unequal.
                assert!(
                    (normal[k] / law - 1.0).abs() < 3e-3,
                    "{k}: {} {law}",
                    normal[k]
                );
                looked_at += 1;
            }
        }
        assert!(looked_at > 50, "{looked_at}");
        let impulse =
            scalar(&recording, "belt.mean_force") * scalar(&recording, "belt.contact_time");
        let volume = scalar(&recording, "belt.removed_volume");
        let off = volume / (PRESTON * BELT * impulse) - 1.0;
        println!("{depth_mm:.3} mm, {feed:.0} mm/min: volume off Preston's by {off:.2e}");
        assert!(off.abs() < feed / 6e4 / BELT, "{off}");
    }
}
