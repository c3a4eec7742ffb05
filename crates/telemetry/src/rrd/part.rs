//! A part for the viewer: its faces in colours with their numbers, and its edges.

use std::path::Path;

use super::store::Store;
use re_sdk_types::archetypes::{LineStrips3D, Mesh3D, Points3D};
use re_sdk_types::blueprint::components::PlayState;
use re_sdk_types::components::{Color, Radius};
use truecut_recording::{Camera, SinkError};

use super::blueprint::Layout;
use super::layout::looking_at;
use super::surface::Surface;
use super::{Logged, SCENE, application, log_text, write_store};
use crate::error::failed;

const TEXT: &str = "/text";
/// Most faces that carry their number; more would hide the part.
const MOST_NUMBERS: usize = 200;

/// A face of a part, m.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FaceShown {
    /// Its number.
    pub number: usize,
    /// Where the number stands.
    pub at_m: [f64; 3],
    /// Its own vertices.
    pub vertices_m: Vec<[f64; 3]>,
    /// Indices of them.
    pub triangles: Vec<[u32; 3]>,
}

/// A part and what is said of it.
pub struct PartShown<'a> {
    /// What it is about.
    pub title: &'a str,
    /// What came of it.
    pub text: &'a str,
    /// Corners of the box about it, m.
    pub box_m: [[f64; 3]; 2],
    /// Its faces; the first get their numbers.
    pub faces: &'a [FaceShown],
    /// Its edges.
    pub edges_m: &'a [Vec<[f64; 3]>],
}

/// Writes the file.
///
/// # Errors
/// Where the file cannot be written.
pub fn write_part(path: &Path, shown: &PartShown<'_>) -> Result<(), SinkError> {
    write_store(path, shown.title, |store| log(store, shown))
        .map_err(failed(path, "write the part"))
}

fn log(stream: &Store, shown: &PartShown<'_>) -> Logged<()> {
    log_text(stream, TEXT, format!("```\n{}\n```\n", shown.text))?;
    log_faces(stream, shown.faces)?;
    let single = |point: &[f64; 3]| point.map(|value| value as f32);
    let strips = shown.edges_m.iter();
    let strips = strips.map(|edge| edge.iter().map(single).collect::<Vec<_>>());
    let edges = LineStrips3D::new(strips)
        .with_colors([Color::from_rgb(15, 15, 15)])
        .with_radii([Radius::new_ui_points(1.0)]);
    stream.log_static(format!("{SCENE}/edges"), &edges)?;
    let numbered = || shown.faces.iter().take(MOST_NUMBERS);
    let numbers = Points3D::new(numbered().map(|face| single(&face.at_m)))
        .with_labels(numbered().map(|face| face.number.to_string()))
        .with_radii([Radius::new_ui_points(1.5)])
        .with_show_labels(true);
    stream.log_static(format!("{SCENE}/numbers"), &numbers)?;
    let layout = Layout::new(application(shown.title))?;
    let camera = camera(&shown.box_m);
    let queries = ["$origin/**".to_owned()];
    let view = looking_at(&layout, "Part", &queries, camera, [0.0, 0.0, 1.0])?;
    let words = layout.document("Faces and edges", TEXT)?;
    let root = layout.side_by_side(vec![(1.4, view), (1.0, words)])?;
    layout.send(&root, PlayState::Paused, stream)
}

/// All faces as one mesh, so that parts of many faces stay quick to draw.
fn log_faces(stream: &Store, faces: &[FaceShown]) -> Logged<()> {
    let single = |point: &[f64; 3]| point.map(|value| value as f32);
    let (mut places, mut normals) = (Vec::<[f32; 3]>::new(), Vec::<[f32; 3]>::new());
    let (mut corners, mut colors) = (Vec::<[u32; 3]>::new(), Vec::new());
    for face in faces {
        let shaded = Surface::new(&face.vertices_m, &face.triangles).shaded();
        let first = places.len() as u32;
        corners.extend(shaded.2.iter().map(|t| t.map(|i| first + i)));
        let [r, g, b] = color(face.number);
        colors.resize(places.len() + shaded.0.len(), Color::from_rgb(r, g, b));
        places.extend(shaded.0.iter().map(single));
        normals.extend(shaded.1.iter().map(single));
    }
    let mesh = Mesh3D::new(places)
        .with_vertex_normals(normals)
        .with_vertex_colors(colors)
        .with_triangle_indices(corners);
    stream.log_static(format!("{SCENE}/part"), &mesh)
}

/// Hues a golden angle apart, so that neighbours in number differ well.
fn color(number: usize) -> [u8; 3] {
    let hue = (number as f64 * 0.618_033_988_75).fract() * 6.0;
    let ramp = |shift: f64| {
        let away = ((hue + shift).rem_euclid(6.0) - 3.0).abs() - 1.0;
        (70.0 + 160.0 * away.clamp(0.0, 1.0)).round() as u8
    };
    [ramp(0.0), ramp(4.0), ramp(2.0)]
}

/// From above and aside, with room about the part.
fn camera([low, high]: &[[f64; 3]; 2]) -> Camera {
    let target_m: [f64; 3] = std::array::from_fn(|i| (low[i] + high[i]) / 2.0);
    let diagonal = (0..3)
        .map(|i| (high[i] - low[i]).powi(2))
        .sum::<f64>()
        .sqrt();
    let from = [0.7, -1.0, 0.8];
    Camera {
        position_m: std::array::from_fn(|i| target_m[i] + diagonal * from[i]),
        target_m,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_in_number_differ_in_colour() {
        for number in 1..50 {
            let [one, next] = [number, number + 1].map(color);
            let apart: i32 = (0..3)
                .map(|i| (i32::from(one[i]) - i32::from(next[i])).abs())
                .sum();
            assert!(apart > 120, "{number}: {one:?} {next:?}");
        }
    }

    #[test]
    fn a_part_is_written() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("part.rrd");
        let corners = [[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.1, 0.0]];
        let face = FaceShown {
            number: 1,
            at_m: [0.03, 0.03, 0.0],
            vertices_m: corners.to_vec(),
            triangles: vec![[0, 1, 2]],
        };
        let shown = PartShown {
            title: "a part",
            text: "one face",
            box_m: [[0.0; 3], [0.1, 0.1, 0.0]],
            faces: &[face],
            edges_m: &[corners.to_vec()],
        };
        write_part(&path, &shown).expect("written");
        assert!(std::fs::metadata(&path).expect("a file").len() > 1000);
        let nowhere = folder.path().join("none").join("part.rrd");
        assert!(write_part(&nowhere, &shown).is_err());
    }
}
