//! How deep the wheel lies in the workpiece, at the points of a path and on the straight lines that
//! the program drives between them.

use nalgebra::{Isometry3, Vector3};
use rayon::prelude::*;
use truecut_plan::surface::Mesh;
use truecut_plan::surface_path::{AxisRule, Chord, ContactWheel, SurfacePath};
use truecut_scenario::PathJob;

use super::inputs::Inputs;
use crate::failure::Failure;
use crate::progress::Progress;

/// Poses between two updates of the progress bar.
const CHUNK: usize = 64;

/// Apparent indentation of a wheel that just touches: the error of the triangle mesh.
const TOUCHING_M: f64 = 20e-6;

/// What wheels that stand apart on a straight line may miss of what the wheel on its way cuts, as
/// much as the triangles miss: s²/(8 R) for steps s.
const MISSED_M: f64 = 7e-6;

/// Most places between two points.
const MOST_BETWEEN: f64 = 5000.0;

/// Indentation of the whole wheel in patch and body, m.
pub struct Depths {
    /// At each pose of each line: `[line][pose]`.
    pub at_m: Vec<Vec<f64>>,
    /// Between each pose and the next, largest and least.
    between_m: Vec<Vec<[f64; 2]>>,
}

impl Depths {
    /// At poses, and between them at places so near that no more than [`MISSED_M`] is missed.
    ///
    /// # Errors
    /// Where the wheel lies deeper than the job allows.
    pub fn of(
        job: &PathJob,
        inputs: &Inputs,
        poses: &[Vec<Isometry3<f64>>],
        progress: &Progress,
    ) -> Result<Self, Failure> {
        let run = progress.run();
        let meshes: Vec<&Mesh> = std::iter::once(&inputs.patch_mesh)
            .chain(&inputs.body)
            .collect();
        let wheel = &job.wheel;
        let depth_m = |pose: &Isometry3<f64>| {
            let each = meshes.iter();
            let each = each.map(|m| m.wheel_depth_m(pose, wheel.radius_m, wheel.width_m));
            each.fold(0.0, f64::max)
        };
        // Each pose with the way to the next of its line, if there is one.
        let all: Vec<(Isometry3<f64>, Option<Isometry3<f64>>)> = poses
            .iter()
            .flat_map(|line| {
                let next = line.iter().skip(1).map(|pose| Some(*pose));
                line.iter().copied().zip(next.chain([None]))
            })
            .collect();
        let mut found: Vec<(f64, [f64; 2])> = Vec::with_capacity(all.len());
        for chunk in all.chunks(CHUNK) {
            found.par_extend(chunk.par_iter().map(|(pose, next)| {
                let places = next.iter().flat_map(|next| between(wheel, pose, next));
                let range = places.map(|place| depth_m(&place));
                let range = range.fold([0.0_f64, f64::INFINITY], |[most, least], depth| {
                    [most.max(depth), least.min(depth)]
                });
                (depth_m(pose), range)
            }));
            run.set(found.len() as f64 / all.len() as f64);
        }
        let mut rest = found.into_iter();
        let (mut at_m, mut between_m) = (Vec::new(), Vec::new());
        for line in poses {
            let (at, between): (Vec<f64>, Vec<[f64; 2]>) = rest.by_ref().take(line.len()).unzip();
            at_m.push(at);
            between_m.push(between);
        }
        let depths = Self { at_m, between_m };
        depths.check_points(job, poses)?;
        depths.check_between(job, poses)?;
        Ok(depths)
    }

    /// Least and greatest on the lines, between points too, m.
    pub fn on_lines_m(&self) -> [f64; 2] {
        let at = (self.at_m.iter())
            .flat_map(|line| &line[1..line.len() - 1])
            .map(|depth| [*depth; 2]);
        // What leads down to the first contact and up from the last is no line.
        let between = (self.between_m.iter())
            .flat_map(|line| &line[1..line.len().saturating_sub(2).max(1)])
            .copied();
        at.chain(between)
            .fold([f64::INFINITY, 0.0], |[least, most], [deep, shallow]| {
                [least.min(shallow), most.max(deep)]
            })
    }

    fn check_points(&self, job: &PathJob, poses: &[Vec<Isometry3<f64>>]) -> Result<(), Failure> {
        for (line, (poses, depths)) in poses.iter().zip(&self.at_m).enumerate() {
            let last = poses.len() - 1;
            for (point, (pose, depth_m)) in poses.iter().zip(depths).enumerate() {
                let lifted = point == 0 || point == last;
                let limit_m = if lifted { 0.0 } else { job.path.gouge_limit_m };
                if *depth_m > limit_m + TOUCHING_M {
                    let rule = if lifted {
                        "it is lifted here and must be clear".to_owned()
                    } else {
                        allowed(limit_m)
                    };
                    let message = format!(
                        "the wheel gouges: on line {}, point {point}, its centre at {} in the \
                         patch's frame, it lies {:.4} mm deep in the workpiece; {rule}",
                        line + 1,
                        place(&pose.translation.vector),
                        depth_m * 1e3
                    );
                    return Err(job.problem("wheel.radius_mm", message).into());
                }
            }
        }
        Ok(())
    }

    fn check_between(&self, job: &PathJob, poses: &[Vec<Isometry3<f64>>]) -> Result<(), Failure> {
        let limit_m = job.path.gouge_limit_m;
        for (line, (poses, depths)) in poses.iter().zip(&self.between_m).enumerate() {
            for (point, [most_m, _]) in depths.iter().enumerate() {
                if *most_m > limit_m + TOUCHING_M {
                    let message = format!(
                        "the wheel gouges between points {point} and {} of line {}, its centre \
                         from {} in the patch's frame: the program leads it straight from one to \
                         the other, up to {:.4} mm deep in the workpiece; {}, and shorter steps \
                         keep to the face",
                        point + 1,
                        line + 1,
                        place(&poses[point].translation.vector),
                        most_m * 1e3,
                        allowed(limit_m)
                    );
                    return Err(job.problem("path.step_mm", message).into());
                }
            }
        }
        Ok(())
    }
}

fn allowed(limit_m: f64) -> String {
    format!("`path.gouge_limit_mm` allows {:.4} mm", limit_m * 1e3)
}

fn place(at_m: &Vector3<f64>) -> String {
    let at = at_m * 1e3;
    format!("({:.3}, {:.3}, {:.3}) mm", at.x, at.y, at.z)
}

/// Poses on the straight way from one to another, the ends left out: none of the wheel's points
/// moves further from one to the next than a step that misses [`MISSED_M`].
fn between(
    wheel: &ContactWheel,
    from: &Isometry3<f64>,
    to: &Isometry3<f64>,
) -> impl Iterator<Item = Isometry3<f64>> {
    let step_m = (8.0 * wheel.radius_m * MISSED_M).sqrt();
    let turn_m = from.rotation.angle_to(&to.rotation) * wheel.radius_m.hypot(0.5 * wheel.width_m);
    let way_m = (to.translation.vector - from.translation.vector).norm() + turn_m;
    let count = (way_m / step_m).ceil().clamp(1.0, MOST_BETWEEN);
    let (from, to) = (*from, *to);
    (1..count as usize).map(move |k| from.lerp_slerp(&to, k as f64 / count))
}

/// Where the wheel stands off between points, its edges do so by as much more.
pub fn check_edge_gaps(
    job: &PathJob,
    path: &SurfacePath,
    chords: &[Vec<Chord>],
) -> Result<(), Failure> {
    let AxisRule::WidestSwath { edge_gap_limit_m } = job.path.options.rule else {
        return Ok(());
    };
    for (line, (contacts, chords)) in path.lines.iter().zip(chords).enumerate() {
        for (point, (pair, chord)) in contacts.windows(2).zip(chords).enumerate() {
            let gap_m = pair[0].edge_gap_m.max(pair[1].edge_gap_m) + chord.off_m;
            if gap_m > edge_gap_limit_m + TOUCHING_M {
                let message = format!(
                    "the wheel's edges stand off by up to {:.4} mm between points {} and {} of \
                     line {}, from {} in the patch's frame: the program leads it straight from one \
                     to the other, up to {:.4} mm off; `path.edge_gap_limit_mm` allows {:.4} mm, \
                     and shorter steps keep to the face",
                    gap_m * 1e3,
                    point + 1,
                    point + 2,
                    line + 1,
                    place(&pair[0].point_m),
                    chord.off_m * 1e3,
                    edge_gap_limit_m * 1e3
                );
                return Err(job.problem("path.step_mm", message).into());
            }
        }
    }
    Ok(())
}
