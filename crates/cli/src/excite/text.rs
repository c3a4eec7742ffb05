//! What a planned motion will tell, as text.

use std::path::PathBuf;

use truecut_discrepancy::excite::{ExciteReport, JointUse, Separation};
use truecut_recording::significant;

use crate::text::{Align, headed, table};

pub fn printed(report: &ExciteReport, note: Option<&str>, written: &[PathBuf]) -> String {
    let three = |value: f64| significant(value, 3);
    let mut text = format!(
        "{}\n  {} s, {} harmonics in {} periods; {} motions tried, criterion {}\n\n",
        report.scenario,
        significant(report.duration_s, 4),
        report.harmonics,
        report.periods,
        report.evaluations,
        report.criterion
    );
    text += &errors(report);
    let present = report
        .condition
        .present
        .map_or_else(String::new, |present| {
            format!(", {} in the data at hand", three(present))
        });
    text += &format!(
        "  standard errors are {} times those in random motions (geometric mean)\n  condition number {}, {} in random \
         motions{present}\n",
        three(report.mean_ratio),
        three(report.condition.planned),
        three(report.condition.random),
    );
    text.extend(report.separation.iter().map(separation));
    text += "\n";
    text += &joints(&report.joints);
    let assumed = report.noise.iter().filter(|one| !one.is_stated);
    let assumed: Vec<String> = assumed
        .map(|one| format!("{} {} {}", one.channel, three(one.noise), one.unit))
        .collect();
    if !assumed.is_empty() {
        text += &format!(
            "  note: noise assumed of a sample (say it with `noise` in [[data.channel]]): {}\n",
            assumed.join(", ")
        );
    }
    text.extend(note.map(|note| format!("  note: {note}\n")));
    for file in written {
        text += &format!("  {}\n", file.display());
    }
    text
}

fn errors(report: &ExciteReport) -> String {
    let three = |value: f64| significant(value, 3);
    let has_present = report.parameters.iter().any(|one| one.present.is_some());
    let rows = report.parameters.iter().map(|one| {
        let mut row = vec![three(one.planned), three(one.random)];
        row.extend(one.present.map(three));
        row.extend([one.unit.clone(), three(one.value), one.name.clone()]);
        row
    });
    let mut head = vec!["standard error", "in random motions"];
    head.extend(has_present.then_some("in the data at hand"));
    head.extend(["unit", "scenario's", ""]);
    let mut aligns = vec![Align::Right; head.len()];
    aligns[head.len() - 3] = Align::Left;
    aligns[head.len() - 1] = Align::Left;
    table(&aligns, &headed(&head, rows))
}

fn separation(one: &Separation) -> String {
    let told = |[distance, log10]: [f64; 2]| {
        let log10 = significant(log10, 3);
        format!(
            "{} deviations of the noise, odds 10^{log10}",
            significant(distance, 3)
        )
    };
    let present = one
        .present
        .map_or_else(String::new, |now| format!(" (now {})", told(now)));
    format!(
        "  {} and {} would be {} apart{present}\n",
        one.causes.join(" and "),
        one.alternative.join(" and "),
        told([one.planned, one.log10_odds])
    )
}

/// What the motion takes of the limits that it may use, angles in degrees.
fn joints(joints: &[JointUse]) -> String {
    let percent = |share: f64| match share > 0.0 {
        true => format!("{:.0} %", 100.0 * share),
        false => "–".to_owned(),
    };
    let rows = joints.iter().map(|one| {
        let (per_si, unit, effort) = match one.unit {
            "rad" => (1f64.to_degrees(), "°", "N m"),
            _ => (1e3, "mm", "N"),
        };
        let number = |value: f64| significant(per_si * value, 4);
        vec![
            one.joint.clone(),
            format!(
                "{} to {} {unit}",
                number(one.range[0]),
                number(one.range[1])
            ),
            format!("{} {unit}/s", number(one.speed)),
            percent(one.speed_share),
            format!("{} {unit}/s²", number(one.acceleration)),
            percent(one.acceleration_share),
            format!("{} {effort}", significant(one.effort, 4)),
            percent(one.effort_share),
        ]
    });
    let head = [
        "joint",
        "range",
        "speed",
        "of limit",
        "acceleration",
        "of limit",
        "drive",
        "of limit",
    ];
    use Align::{Left, Right};
    let aligns = [Left, Left, Right, Right, Right, Right, Right, Right];
    table(&aligns, &headed(&head, rows))
}
