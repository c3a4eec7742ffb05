//! What `truecut path` writes.

use std::path::{Path, PathBuf};

use truecut_plan::program::{Motion, Move, Program, jbi, rapid};
use truecut_plan::surface_path::{Contact, Part, Segment};
use truecut_scenario::path_job::{Carrier, DialectSpec};

use super::{Answer, figure};
use crate::failure::Failure;
use crate::outputs::write_file;

/// Writes the figure first, then the path, then the program.
pub fn write(answer: &Answer<'_>, out: &Path) -> Result<Vec<PathBuf>, Failure> {
    let program = program(answer)?;
    let folder = out.join(answer.job.stem());
    let (svg, csv) = (folder.join("path.svg"), folder.join("path.csv"));
    write_file(&svg, figure::figure(answer).to_svg().as_bytes())?;
    write_file(&csv, table(answer).as_bytes())?;
    let mut written = vec![svg, csv];
    for (name, text) in program {
        let file = folder.join(name);
        write_file(&file, text.as_bytes())?;
        written.push(file);
    }
    Ok(written)
}

/// Files of the program, by name.
fn program(answer: &Answer<'_>) -> Result<Vec<(String, String)>, Failure> {
    let (job, robot) = (answer.job, &answer.inputs.robot);
    let refused = |error: truecut_plan::program::ProgramError| -> Failure {
        job.problem("program", error.to_string()).into()
    };
    let program: &Program = &answer.program;
    match &job.program.dialect {
        DialectSpec::Jbi { date, pulses, .. } => {
            let [year, month, day, hour, minute] = *date;
            let small = |value: u16| u8::try_from(value).unwrap_or(u8::MAX);
            let date =
                jbi::JobDate::new(year, small(month), small(day), small(hour), small(minute))
                    .map_err(|error| job.problem("program.date", error.to_string()))?;
            let mut options = jbi::JbiOptions::new(date);
            if *pulses {
                options.format = jbi::PositionFormat::Pulse;
            }
            options.station_share = job.program.joint_share;
            if let Some(Carrier::Turntable { pulses_per_deg }) = job.symmetry.map(|one| one.carrier)
            {
                options.station_pulses_per_deg = pulses_per_deg;
            }
            let jobs = jbi::write(program, robot, &options).map_err(refused)?;
            let named = jobs
                .into_iter()
                .map(|one| (format!("{}.JBI", one.name), one.text));
            Ok(named.collect())
        }
        DialectSpec::Rapid { zone, .. } => {
            let mut options = rapid::RapidOptions::default();
            if let Some(zone) = zone {
                options.zone.clone_from(zone);
            }
            let text = rapid::write(program, robot, &options).map_err(refused)?;
            Ok(vec![(format!("{}.mod", program.name), text)])
        }
    }
}

/// A row for each path point, numbers only: where the tool stands in the world, the posture, and what the wheel does there.
fn table(answer: &Answer<'_>) -> String {
    let joints: Vec<String> = (1..=answer.inputs.robot.dof())
        .map(|j| format!("j{j}"))
        .collect();
    let mut text = format!(
        "point,copy,segment,contact,taught,x_mm,y_mm,z_mm,qw,qx,qy,qz,turntable_deg,{},feed_mm_per_s,joint_speed_percent,swath_mm,edge_gap_mm,depth_mm,psi_deg\n",
        joints.join(",")
    );
    let mut moves = answer.program.moves.iter();
    let before = answer
        .parts
        .iter()
        .take_while(|part| matches!(part.segment, Segment::Taught(_)));
    let before = before.count();
    for part in &answer.parts {
        let line = part.index.checked_sub(before);
        let line = line.and_then(|k| Some((answer.path.lines.get(k)?, answer.depth_m.get(k)?)));
        let count = match &part.segment {
            Segment::Planned(poses) => poses.len(),
            Segment::Taught(points) => points.postures.len(),
        };
        for (k, step) in moves.by_ref().take(count).enumerate() {
            // The first pose of a line is lifted.
            let contact = line
                .and_then(|(line, depths)| Some((line.get(k.checked_sub(1)?)?, *depths.get(k)?)));
            text.push_str(&row(&answer.program, part, step, contact));
        }
    }
    text
}

/// One row; a contact comes with the wheel's depth, m.
fn row(program: &Program, part: &Part, step: &Move, contact: Option<(&Contact, f64)>) -> String {
    let pose = program.world_from_base * step.base_from_tool;
    let (t, q) = (pose.translation.vector * 1e3, pose.rotation);
    let speed = match step.motion {
        Motion::Linear { speed_m_per_s } => format!("{:.3},", speed_m_per_s * 1e3),
        Motion::Joint { share } => format!(",{:.2}", share * 100.0),
    };
    let turned = step.turntable_rad.map(|a| format!("{:.6}", a.to_degrees()));
    let posture: Vec<String> = (step.posture.iter())
        .map(|a| format!("{:.6}", a.to_degrees()))
        .collect();
    let of_contact = contact.map_or(",,,".to_owned(), |(c, depth_m)| {
        format!(
            "{:.4},{:.4},{:.4},{:.3}",
            c.swath_m * 1e3,
            c.edge_gap_m * 1e3,
            depth_m * 1e3,
            c.psi_rad.to_degrees()
        )
    });
    format!(
        "{},{},{},{},{},{:.6},{:.6},{:.6},{:.9},{:.9},{:.9},{:.9},{},{},{speed},{of_contact}\n",
        step.path_point,
        part.copy + 1,
        part.index + 1,
        u8::from(contact.is_some()),
        u8::from(matches!(part.segment, Segment::Taught(_))),
        t.x,
        t.y,
        t.z,
        q.w,
        q.i,
        q.j,
        q.k,
        turned.unwrap_or_default(),
        posture.join(",")
    )
}
