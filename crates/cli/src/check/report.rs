//! What was checked as a page, beside the JUnit XML.

use std::path::{Path, PathBuf};

use maud::{Markup, html};
use truecut::outputs::write_file;
use truecut_recording::ClaimResult;

use super::{Checked, Judgement, status_of};
use crate::exit_status::ExitStatus;
use crate::failure::Failure;
use crate::page::{Page, cells, claims, notes, repeat, table};
use crate::text::seconds;

/// Writes the page; where the XML has its name already, with `.html` behind it.
pub fn write(checked: &[Checked], junit: &Path) -> Result<PathBuf, Failure> {
    let beside = junit.with_extension("html");
    let path = match beside == junit {
        true => junit.with_extension("html.html"),
        false => beside,
    };
    Failure::if_read(&path)?;
    write_file(&path, html(checked).as_bytes())?;
    Ok(path)
}

fn html(checked: &[Checked]) -> String {
    let held = checked.iter().filter(|one| holds(one)).count();
    let title = "Scenarios checked";
    let mut page = Page::new("check", title);
    let headline = format!("{held} of {} scenarios hold", checked.len());
    let judged = checked.iter().filter_map(|one| one.result.judged());
    let all: Vec<&ClaimResult> = judged.flat_map(|judged| &judged.claims).collect();
    let kept = all.iter().filter(|claim| claim.holds).count();
    let detail = format!("{kept} of {} claims hold", all.len());
    page.verdict(held == checked.len(), &headline, &detail);
    page.text(scenarios(checked));
    for one in checked {
        let judged = one.result.judged();
        page.text(claims(
            &one.name,
            judged.map_or(&[], |judged| &judged.claims),
        ));
    }
    let told = checked.iter().flat_map(|one| {
        let file = one.file.display();
        one.notes.iter().map(move |note| format!("{file}: {note}"))
    });
    page.text(notes(&told.collect::<Vec<_>>()));
    let files: Vec<String> = checked
        .iter()
        .map(|one| one.file.display().to_string())
        .collect();
    page.text(repeat("truecut check", &files.join(" ")));
    page.html()
}

/// Whether a scenario was judged and is good.
fn holds(one: &Checked) -> bool {
    one.result.judged().is_some() && status_of(one) == ExitStatus::Good
}

fn scenarios(checked: &[Checked]) -> Markup {
    let rows = checked.iter().map(|one| {
        let mark = if holds(one) { "✓ holds" } else { "✗ fails" };
        let outcome = match &one.result {
            Judgement::Judged(judged) => html! { (judged.outcome) },
            Judgement::Refused(report) => html! { pre { (report) } },
            Judgement::Stopped(how) => html! { (how) },
        };
        let file = one.file.display().to_string();
        let took = seconds(one.took.as_secs_f64());
        html! { (cells(&[mark, &one.name, &file])) td { (outcome) } td.n { (took) } }
    });
    table(
        "Scenarios",
        &["", "scenario", "file", "outcome", "took"],
        rows,
    )
}
