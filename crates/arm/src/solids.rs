//! What of an arm takes up room, for questions of collision.

use nalgebra::{Isometry3, Vector3};

use crate::drawing::{RADIUS_PER_LENGTH, placed, rod};
use crate::meshes::LinkMesh;
use crate::model::{Robot, Shape, Solids};

/// What of a link takes up room, in its frame.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkSolids {
    /// Name of the link.
    pub link: String,
    pub shapes: Vec<(Shape, Isometry3<f64>)>,
    /// Corners of each body of its meshes.
    pub meshes_m: Vec<Vec<Vector3<f64>>>,
    /// Whether its files have no shape for it, so that a rod to the next joint stands for it.
    pub is_rod: bool,
}

impl Solids {
    /// Takes those of another link, too.
    pub(crate) fn take(&mut self, other: Self, own_from_other: &Isometry3<f64>) {
        let shapes = other.shapes.into_iter();
        let shapes = shapes.map(|(shape, pose)| (shape, own_from_other * pose));
        self.shapes.extend(shapes);
        let meshes = other.meshes.into_iter().map(|mesh| LinkMesh {
            link_from_mesh: own_from_other * mesh.link_from_mesh,
            ..mesh
        });
        self.meshes.extend(meshes);
    }
}

impl Robot {
    /// What takes up room of the base and of each link that moves ([`crate::Chain::moving`]): what
    /// the URDF has for collision, else what it has to be seen, else a rod to the next joint or to
    /// the flange. A note on every mesh that cannot be read.
    ///
    /// Reads the files of the meshes.
    #[must_use]
    pub fn solids(&self) -> (Vec<LinkSolids>, Vec<String>) {
        let mut notes = Vec::new();
        let radius_m = RADIUS_PER_LENGTH * self.ends().map(|end| end.norm()).sum::<f64>();
        let moving = self.chain.moving().map(|body| body.link);
        let links = std::iter::once(&self.chain.base).chain(moving);
        let solids = links.zip(self.ends()).map(|(link, end)| {
            let mut own = LinkSolids {
                link: link.name.clone(),
                shapes: link.solids.shapes.clone(),
                meshes_m: Vec::new(),
                is_rod: false,
            };
            for mesh in &link.solids.meshes {
                match placed(mesh) {
                    Ok(parts) => {
                        let corners = parts.into_iter().map(|part| part.triangles.concat());
                        own.meshes_m.extend(corners);
                    }
                    Err(why) => notes.push(format!(
                        "the mesh {} of link \"{}\" is left out of clearances: {why}",
                        mesh.path.display(),
                        link.name
                    )),
                }
            }
            own.is_rod = own.shapes.is_empty() && own.meshes_m.is_empty();
            if own.is_rod && end.norm() > radius_m {
                let rod = rod(&end, radius_m);
                own.shapes.push((rod.shape, rod.link_from_visual));
            }
            own
        });
        (solids.collect(), notes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;
    use std::path::Path;

    const LINKS: [&str; 4] = ["base", "one", "two", "three"];

    /// An arm of three joints along z, 0.4 m apart; `inner` of each link is its own.
    fn robot(folder: &Path, inner: [&str; 4]) -> Robot {
        let mut text = String::from("<robot name=\"r\">\n");
        for (name, inner) in LINKS.iter().zip(inner) {
            text += &format!("<link name=\"{name}\">{inner}</link>\n");
        }
        for (k, pair) in LINKS.windows(2).enumerate() {
            text += &format!(
                "<joint name=\"j{k}\" type=\"revolute\"><parent link=\"{}\"/><child link=\"{}\"/>\
                 <origin xyz=\"0 0 0.4\"/><axis xyz=\"0 0 1\"/>\
                 <limit lower=\"-3\" upper=\"3\" velocity=\"1\" effort=\"1\"/></joint>\n",
                pair[0], pair[1]
            );
        }
        let urdf = folder.join("robot.urdf");
        fs::write(&urdf, text + "</robot>\n").expect("written");
        Robot::load_kinematics(&urdf, None, None).expect("an arm")
    }

    #[test]
    fn shapes_for_collision_go_before_those_to_be_seen_and_both_before_rods() {
        let folder = tempfile::tempdir().expect("a folder");
        let triangle = "v 0 0 0\nv 1000 0 0\nv 0 1000 0\nf 1 2 3\n";
        fs::write(folder.path().join("link.obj"), triangle).expect("written");
        let box_of = |tag: &str, size: f64| {
            format!(
                "<{tag}><origin xyz=\"0 0 0.1\"/><geometry><box size=\"{size} {size} {size}\"/>\
                 </geometry></{tag}>"
            )
        };
        let mesh = "<collision><origin xyz=\"0 0 0.2\"/><geometry>\
                    <mesh filename=\"link.obj\" scale=\"0.001 0.001 0.001\"/></geometry></collision>";
        let both = box_of("visual", 0.3) + &box_of("collision", 0.2);
        let robot = robot(folder.path(), ["", &both, &box_of("visual", 0.3), mesh]);
        let (solids, notes) = robot.solids();
        assert!(notes.is_empty(), "{notes:?}");
        let names: Vec<&str> = solids.iter().map(|own| own.link.as_str()).collect();
        assert_eq!(names, LINKS);
        assert!(solids[0].is_rod, "the base is drawn from joint to joint");
        for (index, half) in [(1, 0.1), (2, 0.15)] {
            let [(Shape::Box { half_extents_m }, pose)] = solids[index].shapes[..] else {
                panic!("{:?}", solids[index]);
            };
            assert!((half_extents_m.x - half).abs() < 1e-12);
            assert!((pose.translation.z - 0.1).abs() < 1e-12);
        }
        let corner = solids[3].meshes_m[0][1];
        assert!((corner - Vector3::new(1.0, 0.0, 0.2)).norm() < 1e-12);
    }

    #[test]
    fn a_mesh_that_cannot_be_read_is_noted() {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("link.obj"), "v 0 0 0\nf 1 2 3\n").expect("written");
        let mesh = "<collision><geometry><mesh filename=\"link.obj\"/></geometry></collision>";
        let (solids, notes) = robot(folder.path(), ["", "", mesh, ""]).solids();
        assert!(
            notes[0].contains("link.obj") && notes[0].contains("two"),
            "{notes:?}"
        );
        assert!(solids[2].is_rod);
    }
}
