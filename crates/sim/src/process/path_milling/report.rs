//! What a pass along a path reports: channels; forces, vibration, walls and floor by place.

use super::PathMilling;
use super::cut::Cut;
use super::kept::Stretch;
use super::left::{floor_left_m, part};
use super::space;
use super::written::Written;
use crate::process::Findings;
use crate::process::quantity::{self, Quantity};
use nalgebra::{Isometry3, Vector3};
use std::f64::consts::TAU;
use truecut_core::cutting::milling::layered::cut::LayeredCut;
use truecut_core::cutting::milling::layered::walls::{Side, Station};
use truecut_recording::{Field, Profile, Scalar, Unit};

/// Most cells along a side of what is drawn.
const DRAWN: usize = 240;
/// Height over the stock at which it is drawn, m.
const DRAWN_ABOVE_M: f64 = 1e-4;

/// What is recorded of a step: the cut, with its chips and immersion at the instant.
pub(super) fn quantities(milling: &PathMilling) -> impl Iterator<Item = Quantity> {
    let last = &milling.last;
    let (force, torque) = (last.force_on_tool_n, last.torque_n_m());
    let immersion = last.at.and_then(|at| {
        let feed = at.axes.inverse() * last.feed_m_per_s;
        (feed.xy().norm() > 1e-9).then(|| milling.cut.immersion(&at, &last.feed_m_per_s))?
    });
    let immersion = immersion.unwrap_or_default();
    let (chip_m, teeth) = (last.loads.thickest_chip_m, last.loads.teeth_in_cut);
    let nominal_m = milling.setup.nominal.at(0.0).place_m;
    let place = last.at.map_or(nominal_m, |at| at.place_m);
    let rotation_rad = last.at.map_or(0.0, |at| at.rotation_rad.rem_euclid(TAU));
    let deflection = last.deflection_m;
    [
        Quantity::new("path_milling.force_x", Unit::Newton, force.x)
            .text("Cutting force on the tool, work frame x"),
        Quantity::new("path_milling.force_y", Unit::Newton, force.y)
            .text("Cutting force on the tool, work frame y"),
        Quantity::new("path_milling.force_z", Unit::Newton, force.z)
            .text("Cutting force on the tool, work frame z, into the spindle"),
        Quantity::new("path_milling.torque", Unit::NewtonMetre, torque)
            .text("Torque of the cut about the tool axis; positive brakes the spindle"),
        Quantity::new("path_milling.position_x", Unit::Metre, place.x)
            .text("Tip of the tool, work frame x"),
        Quantity::new("path_milling.position_y", Unit::Metre, place.y)
            .text("Tip of the tool, work frame y"),
        Quantity::new("path_milling.position_z", Unit::Metre, place.z)
            .text("Tip of the tool, work frame z"),
        Quantity::new("path_milling.deflection_x", Unit::Metre, deflection.x)
            .text("Tip of the tool minus its commanded place, work frame x"),
        Quantity::new("path_milling.deflection_y", Unit::Metre, deflection.y)
            .text("Tip of the tool minus its commanded place, work frame y"),
        Quantity::new("path_milling.deflection_z", Unit::Metre, deflection.z)
            .text("Tip of the tool minus its commanded place, work frame z"),
        Quantity::new("path_milling.path_distance", Unit::Metre, last.along_m)
            .text("Commanded way so far"),
        Quantity::new("path_milling.chip_thickness", Unit::Metre, chip_m)
            .text("Thickest chip of all teeth"),
        Quantity::new("path_milling.teeth_in_cut", Unit::One, teeth as f64).text("Teeth that cut"),
        Quantity::new(
            "path_milling.entry_angle",
            Unit::Radian,
            immersion.entry_rad,
        )
        .text("Where the rim enters the stock, from the left of the feed towards it; 0 in air"),
        Quantity::new("path_milling.exit_angle", Unit::Radian, immersion.exit_rad)
            .text("Where it leaves the stock, likewise"),
        Quantity::new(
            "path_milling.engaged_angle",
            Unit::Radian,
            immersion.engaged_rad,
        )
        .text("Angle over which the rim is in stock, of all arcs together"),
        Quantity::new(
            "path_milling.removed_volume",
            Unit::CubicMetre,
            last.removed_m3,
        )
        .text("Volume of all chips so far"),
        Quantity::new("path_milling.spindle_angle", Unit::Radian, rotation_rad)
            .text("Angle of the first tooth, from the work frame's y towards its x, 0 to 2 pi"),
    ]
    .into_iter()
}

/// What ended a run that chatters, with the place.
pub(super) fn broken_rule(milling: &PathMilling) -> String {
    let at = milling.last.at.unwrap_or_default().place_m;
    let setup = &milling.setup;
    let off_m = |place: &Vector3<f64>, from: &Vector3<f64>, to: &Vector3<f64>| {
        let along = to - from;
        let share = (place - from).dot(&along) / along.norm_squared().max(1e-18);
        (place - from - along * share.clamp(0.0, 1.0)).norm()
    };
    let nearest = (setup.written.legs().into_iter())
        .map(|([from_m, to_m], point)| (off_m(&at, &from_m, &to_m), point))
        .min_by(|a, b| a.0.total_cmp(&b.0));
    let line = nearest.and_then(|(_, point)| setup.lines.get(point).copied().flatten());
    let line = line.map_or(String::new(), |line| format!(" (line {line} of the path)"));
    format!(
        "teeth in the stock move forwards; at ({:.2}, {:.2}, {:.2}) mm{line} one moves backwards: paths of teeth loop",
        at.x * 1e3,
        at.y * 1e3,
        at.z * 1e3
    )
}

/// Scalars, profiles and the part at the end of the run.
pub(super) fn findings(milling: &PathMilling) -> Findings {
    let mut findings = Findings::default();
    sizes(milling, &mut findings);
    by_place(milling, &mut findings);
    match (&milling.cut, &milling.setup.written) {
        (Cut::Upright(cut), Written::Upright { legs, meant }) => {
            walls(cut, &mut findings);
            let radius_m = milling.setup.spec.cutter.radius_m;
            let floors = floor_left_m(cut, legs, meant, radius_m);
            floor(&floors, &mut findings);
            findings.part = Some(part(cut, meant, &floors));
        }
        (Cut::Swivel(cut), Written::Swivel { meant, .. }) => {
            space::findings(cut, meant, &mut findings);
        }
        // A cut is made of what is written.
        _ => {}
    }
    findings
}

fn sizes(milling: &PathMilling, findings: &mut Findings) {
    let kept = &milling.kept;
    let [whole_m3, meant_m3] = milling.setup.written.volumes_m3();
    let removed_m3 = whole_m3 - milling.cut.volume_m3();
    let target_m3 = whole_m3 - meant_m3;
    let torque_n_m = kept.torques_n_m().fold(0.0, f64::max);
    let each = kept.torques_n_m().zip(milling.setup.spindle.speeds_rad_s());
    let power_w = each
        .map(|(torque, rad_s)| torque * rad_s)
        .fold(0.0, f64::max);
    let (at_m, level_m) = kept.strongest().unwrap_or((f64::NAN, f64::NAN));
    findings.scalars.extend(quantity::scalars([
        Quantity::new("path_milling.stock_removed", Unit::CubicMetre, removed_m3)
            .text("Volume that teeth have taken of the stock, down to the depths of the path"),
        Quantity::new("path_milling.target_removed", Unit::CubicMetre, target_m3)
            .text("Volume that the path as written takes of it"),
        Quantity::new("path_milling.chip_volume", Unit::CubicMetre, milling.last.removed_m3)
            .text("Volume of all chips"),
        Quantity::new("path_milling.largest_force", Unit::Newton, kept.force_n.largest)
            .text("Largest cutting force at any instant"),
        Quantity::new("path_milling.largest_torque", Unit::NewtonMetre, torque_n_m)
            .text("Largest torque of the cut"),
        Quantity::new("path_milling.largest_power", Unit::Watt, power_w)
            .text("Largest power of the cut"),
        Quantity::new("path_milling.largest_deflection", Unit::Metre, kept.largest_deflection_m)
            .text("Largest deflection in the plane of cut while teeth cut"),
        Quantity::new("path_milling.vibration_level", Unit::Metre, level_m)
            .text("Change of the deflection from one tooth to the next (with runout: one revolution), root mean square where it is largest"),
        Quantity::new("path_milling.vibration_at", Unit::Metre, at_m)
            .text("Way along the path to where that is"),
    ]));
}

fn by_place(milling: &PathMilling, findings: &mut Findings) {
    let kept = &milling.kept;
    let mut add = |name: &str, text: &str, unit: Unit, of: fn(&Stretch) -> f64| {
        let each = kept.stretches.iter().enumerate();
        let known = each.filter_map(|(k, one)| {
            let value = of(one);
            (value.is_finite()).then_some(((k as f64 + 0.5) * kept.stretch_m, value))
        });
        let (axis, values) = known.unzip();
        findings
            .profiles
            .push(profile(name, text, "path_position", axis, (unit, values)));
    };
    let text = "Cutting force by place, root mean square";
    add("force", text, Unit::Newton, Stretch::force_n);
    let text = "Deflection in the plane of cut by place while teeth cut, root mean square";
    add("deflection", text, Unit::Metre, Stretch::deflection_m);
    let text =
        "Change of the deflection from one tooth to the next by place, root mean square: chatter";
    add("vibration", text, Unit::Metre, Stretch::vibration_m);
}

fn profile(
    name: &str,
    text: &str,
    axis_name: &str,
    axis: Vec<f64>,
    (unit, values): (Unit, Vec<f64>),
) -> Profile {
    Profile {
        name: format!("path_milling.{name}"),
        description: text.to_owned(),
        axis_name: axis_name.into(),
        axis_unit: Unit::Metre,
        axis,
        unit,
        values,
    }
}

fn walls(cut: &LayeredCut, findings: &mut Findings) {
    let cut: Vec<(&Station, f64)> = (cut.walls().left_m())
        .filter(|(_, left_m)| left_m.is_finite())
        .collect();
    let left: Vec<f64> = cut.iter().map(|(_, left)| *left).collect();
    spread(findings, "wall_error", "the walls", &left);
    for (side, name) in [(Side::Left, "left_wall"), (Side::Right, "right_wall")] {
        let mut axis: Vec<f64> = Vec::new();
        let mut values = Vec::new();
        // Of the layers that a place of the path walls, the lowest comes first.
        for (station, left_m) in cut.iter().filter(|(station, _)| station.side == side) {
            if axis.last() != Some(&station.along_m) {
                axis.push(station.along_m);
                values.push(*left_m);
            }
        }
        if axis.is_empty() {
            continue;
        }
        let text = format!(
            "Material left on the wall on the {} of the path as written, at half the depth of its layer",
            if side == Side::Left { "left" } else { "right" }
        );
        let values = (Unit::Metre, values);
        findings
            .profiles
            .push(profile(name, &text, "path_position", axis, values));
    }
}

fn floor(left_m: &[f64], findings: &mut Findings) {
    let finite = left_m.iter().filter(|left| left.is_finite());
    let left: Vec<f64> = finite.copied().collect();
    spread(findings, "floor_error", "the floors", &left);
}

/// Mean, root mean square and extremes of what is left.
pub(super) fn spread(findings: &mut Findings, name: &str, of: &str, left_m: &[f64]) {
    let count = left_m.len() as f64;
    let or_nan = |value: f64| if left_m.is_empty() { f64::NAN } else { value };
    let mean = left_m.iter().sum::<f64>() / count;
    let rms = (left_m.iter().map(|left| left * left).sum::<f64>() / count).sqrt();
    let most = or_nan(left_m.iter().copied().fold(f64::NEG_INFINITY, f64::max));
    let least = or_nan(left_m.iter().copied().fold(f64::INFINITY, f64::min));
    let figures = [
        ("", mean, "Mean of the material"),
        ("_rms", rms, "Root mean square of the material"),
        ("_largest", most, "Most material"),
        (
            "_least",
            least,
            "Least material (negative: too much was taken)",
        ),
    ];
    for (suffix, value, text) in figures {
        let text = format!("{text} left on {of} beyond the path as written");
        let name = format!("path_milling.{name}{suffix}");
        findings
            .scalars
            .push(Scalar::new(name, Unit::Metre, value, text));
    }
}

/// The stock from above, by what has been taken of it.
pub(super) fn field(milling: &PathMilling) -> Field {
    let setup = &milling.setup;
    let block = setup.spec.stock.block;
    let size = block.most_m - block.least_m;
    let corner = Vector3::new(
        block.least_m.x,
        block.least_m.y,
        block.most_m.z + DRAWN_ABOVE_M,
    );
    let deepest_m = (setup.written.legs().into_iter())
        .map(|([_, to_m], _)| block.most_m.z - to_m.z.max(block.least_m.z))
        .fold(0.0, f64::max);
    Field {
        path: "milled_depth".into(),
        world_from_field: crate::scene::pose(
            &(setup.world_from_work * Isometry3::translation(corner.x, corner.y, corner.z)),
        ),
        size_m: [size.x, size.y],
        cells: drawn(columns_and_rows(&milling.cut)),
        full_scale: deepest_m,
        unit: Unit::Metre,
        vertices_m: Vec::new(),
    }
}

/// Of the grid, seen from above.
fn columns_and_rows(cut: &Cut) -> [usize; 2] {
    match cut {
        Cut::Upright(cut) => cut.stock().nodes(),
        Cut::Swivel(cut) => {
            let [columns, rows, _] = cut.stock().nodes();
            [columns, rows]
        }
    }
}

fn drawn(nodes: [usize; 2]) -> [usize; 2] {
    nodes.map(|count| count.min(DRAWN))
}

/// How deep the stock has been cut at a node, m.
fn cut_depth_m(cut: &Cut, [column, row]: [usize; 2]) -> f64 {
    match cut {
        Cut::Upright(cut) => {
            let floor_m = cut.floor_m()[column + cut.stock().nodes()[0] * row];
            match floor_m.is_finite() {
                true => (cut.stock().block.most_m.z - floor_m).max(0.0),
                false => 0.0,
            }
        }
        Cut::Swivel(cut) => space::depth_m(cut.stock(), [column, row]),
    }
}

pub(super) fn field_values(milling: &PathMilling) -> Vec<f32> {
    let [columns, rows] = columns_and_rows(&milling.cut);
    let [across, up] = drawn([columns, rows]);
    let at = |k: usize, drawn: usize, count: usize| k * (count - 1) / (drawn - 1).max(1);
    let mut values = Vec::with_capacity(across * up);
    for row in 0..up {
        for column in 0..across {
            let node = [at(column, across, columns), at(row, up, rows)];
            values.push(cut_depth_m(&milling.cut, node) as f32);
        }
    }
    values
}
