//! Telegrams of KUKA.RobotSensorInterface, as the computer at the other end of its line logs them.
//!
//! The controller sends `<Rob Type="KUKA"><RIst X="…" …/><AIPos A1="…" …/>…<IPOC>…</IPOC></Rob>`
//! every 4 or 12 ms, and may be answered by `<Sen …><RKorr …/>…<IPOC>…</IPOC></Sen>` with the same
//! time stamp. A log has one after the other, with or without lines and words between them.

use std::collections::{BTreeSet, HashMap};

use roxmltree::{Document, Node};
use truecut_recording::measured::{Column, Table};

use crate::error::Reason;

/// Time stamp of a telegram, ms.
const IPOC: &str = "IPOC";
/// Most columns.
const MOST_COLUMNS: usize = 1024;
/// Cells that may be empty beside each that holds a number, and so many at least: elements that
/// come and go make tables far larger than their file.
const MOST_EMPTY: (usize, usize) = (16, 1_000_000);
/// The first telegram begins within so many bytes.
const HEAD: usize = 4096;

/// Whether a text is a log of telegrams.
pub(super) fn are_in(text: &str) -> bool {
    next(text, 0).is_some_and(|(_, at)| at < HEAD)
}

/// The telegrams as a table: a column for each attribute, `AIPos.A1`, and `IPOC` first.
///
/// # Errors
/// A telegram that is no XML, or that begins before the one before it ended; a value that is no
/// number where the ones before it were.
pub(super) fn table(text: &str) -> Result<Table, Reason> {
    let mut rows = Rows::default();
    let (mut from, mut line, mut counted) = (0, 1, 0);
    while let Some((kind, at)) = next(text, from) {
        line += text[counted..at].matches('\n').count();
        counted = at;
        let close = format!("</{kind}>");
        let length = text[at..].find(&close);
        let end = length.map_or(text.len(), |length| at + length + close.len());
        if let Some((_, inner)) = next(&text[..end], at + 1) {
            let line = line + text[at..inner].matches('\n').count();
            let message = "a telegram begins before the one before it has ended".to_owned();
            return Err(Reason::Line { line, message });
        }
        if length.is_none() {
            let cut = format!("the last telegram, at line {line}, is cut off");
            rows.notes.push(cut);
            break;
        }
        rows.telegram(kind, &text[at..end], line)?;
        from = end;
    }
    rows.table()
}

/// The next telegram: its kind, and where it begins.
fn next(text: &str, mut from: usize) -> Option<(&'static str, usize)> {
    loop {
        let at = from + text.get(from..)?.find('<')?;
        let after = &text[at + 1..];
        let found = ["Rob", "Sen"].into_iter().find(|kind| {
            let rest = after
                .strip_prefix(kind)
                .and_then(|rest| rest.chars().next());
            rest.is_some_and(|next| next.is_whitespace() || next == '>')
        });
        if let Some(kind) = found {
            return Some((kind, at));
        }
        from = at + 1;
    }
}

/// What the telegrams held so far.
#[derive(Default)]
struct Rows {
    /// Line of each.
    lines: Vec<usize>,
    names: Vec<String>,
    columns: Vec<Vec<f64>>,
    index: HashMap<String, usize>,
    /// Names of what never held a number.
    texts: BTreeSet<String>,
    numbers: usize,
    /// Answers that belong to no telegram.
    astray: usize,
    notes: Vec<String>,
}

impl Rows {
    fn telegram(&mut self, kind: &str, text: &str, line: usize) -> Result<(), Reason> {
        // The parser compares each attribute of an element with all before it.
        if text.bytes().filter(|byte| *byte == b'=').count() > MOST_COLUMNS {
            let message = format!("more than {MOST_COLUMNS} attributes in one telegram");
            return Err(Reason::Line { line, message });
        }
        let document = Document::parse(text).map_err(|error| Reason::Line {
            line: line + error.pos().row.saturating_sub(1) as usize,
            message: format!("the telegram is no XML: {error}"),
        })?;
        let root = document.root_element();
        if kind == "Rob" {
            self.lines.push(line);
            let complete = self.lines.len();
            for element in root.descendants().filter(Node::is_element).skip(1) {
                self.element(&element, line)?;
            }
            let cells = complete.saturating_mul(self.names.len());
            let (factor, least) = MOST_EMPTY;
            if cells > least.max(factor * self.numbers) {
                let message = "elements differ from telegram to telegram".to_owned();
                return Err(Reason::Line { line, message });
            }
            return Ok(());
        }
        let is_stamp = |node: &Node| node.tag_name().name() == IPOC;
        let stamp = (root.descendants())
            .find(is_stamp)
            .and_then(|node| node.text())
            .and_then(|text| truecut_files::number(text.trim(), false));
        if stamp.is_none() || stamp != self.last(IPOC) {
            self.astray += 1;
            return Ok(());
        }
        let elements = root.descendants().filter(Node::is_element).skip(1);
        for element in elements.filter(|node| !is_stamp(node)) {
            self.element(&element, line)?;
        }
        Ok(())
    }

    /// The number in a column of the telegram that was read last.
    fn last(&self, name: &str) -> Option<f64> {
        let column = &self.columns[*self.index.get(name)?];
        (column.len() == self.lines.len()).then(|| column.last().copied())?
    }

    fn element(&mut self, element: &Node, line: usize) -> Result<(), Reason> {
        let tag = element.tag_name().name();
        for attribute in element.attributes() {
            let name = format!("{tag}.{}", attribute.name());
            self.value(name, attribute.value(), line)?;
        }
        match element.text().map(str::trim) {
            Some(text) if !text.is_empty() && element.attributes().len() == 0 => {
                self.value(tag.to_owned(), text, line)
            }
            _ => Ok(()),
        }
    }

    fn value(&mut self, name: String, text: &str, line: usize) -> Result<(), Reason> {
        if self.texts.contains(&name) {
            return Ok(());
        }
        let known = self.index.get(&name).copied();
        let Some(value) = truecut_files::number(text.trim(), false) else {
            if known.is_some() {
                return Err(Reason::Cell {
                    line,
                    column: name,
                    value: text.to_owned(),
                });
            }
            self.texts.insert(name);
            return Ok(());
        };
        let place = match known {
            Some(place) => place,
            None if self.names.len() == MOST_COLUMNS => {
                let message = format!("more than {MOST_COLUMNS} different elements");
                return Err(Reason::Line { line, message });
            }
            None => {
                self.index.insert(name.clone(), self.names.len());
                self.names.push(name);
                self.columns.push(Vec::new());
                self.names.len() - 1
            }
        };
        let column = &mut self.columns[place];
        // An element that stands twice in a telegram: the first counts.
        if column.len() < self.lines.len() {
            column.resize(self.lines.len() - 1, f64::NAN);
            column.push(value);
            self.numbers += 1;
        }
        Ok(())
    }

    fn table(mut self) -> Result<Table, Reason> {
        if self.names.is_empty() {
            let text = "there is no whole telegram <Rob …> … </Rob> with a number in it";
            return Err(Reason::NotATable(text.to_owned()));
        }
        let mut notes = vec!["telegrams of KUKA.RobotSensorInterface: mm, deg, ms".to_owned()];
        let has = |name: &str| self.names.iter().any(|one| one == name);
        if !has(IPOC) {
            notes.push("they have no time stamp IPOC: give `rate_hz`, 250 or 83.333".to_owned());
        }
        if self.names.iter().any(|name| name.starts_with("MACur.")) {
            notes.push("MACur is in the controller's own unit: give `scale`".to_owned());
        }
        if !self.texts.is_empty() {
            let texts: Vec<&str> = self.texts.iter().map(String::as_str).collect();
            notes.push(format!("no numbers, and left out: {}", texts.join(", ")));
        }
        if self.astray > 0 {
            notes.push(format!(
                "{} answers <Sen> have not the IPOC of the telegram before them, and are left out",
                self.astray
            ));
        }
        notes.append(&mut self.notes);
        let rows = self.lines.len();
        let named = self.names.into_iter().zip(self.columns);
        let column = |(name, mut values): (String, Vec<f64>)| {
            values.resize(rows, f64::NAN);
            Column { name, values }
        };
        let mut columns: Vec<Column> = named.map(column).collect();
        columns.sort_by_key(|column| column.name != IPOC);
        let units = columns
            .iter()
            .filter_map(|column| Some((column.name.clone(), unit(&column.name)?.to_owned())));
        Ok(Table {
            units: units.collect(),
            columns,
            lines: self.lines,
            notes,
            ..Table::default()
        })
    }
}

/// Unit of an attribute. External axes may turn or slide, and currents are the controller's.
fn unit(name: &str) -> Option<&'static str> {
    if name == IPOC {
        return Some("ms");
    }
    let (element, attribute) = name.split_once('.')?;
    match (element, attribute.chars().next()?) {
        ("RIst" | "RSol" | "RKorr", 'X' | 'Y' | 'Z') => Some("mm"),
        ("RIst" | "RSol" | "RKorr", 'A' | 'B' | 'C') => Some("deg"),
        ("AIPos" | "ASPos" | "AKorr" | "AK", 'A') => Some("deg"),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rob(ipoc: u32, a1: f64) -> String {
        format!(
            "<Rob Type=\"KUKA\"><RIst X=\"1.5\" A=\"-90.0\"/><AIPos A1=\"{a1:?}\" A2=\"-0.0\"/>\
             <MACur A1=\"0.25\"/><Delay D=\"0\"/><EStr>ok</EStr><IPOC>{ipoc}</IPOC></Rob>"
        )
    }

    #[test]
    fn regress_telegrams_are_rows() {
        let answer = "<Sen Type=\"PC\"><RKorr X=\"0.125\"/><IPOC>4</IPOC></Sen>";
        let late = "<Sen Type=\"PC\"><RKorr X=\"9\"/><IPOC>4</IPOC></Sen>";
        let log = format!(
            "10:00:00.001 {}\n{answer}\n\n10:00:00.005 {}{late}\n{}\n{}",
            rob(4, 10.0),
            rob(8, 10.25),
            rob(12, 10.5),
            "<Rob Type=\"KUKA\"><RIst X="
        );
        assert!(are_in(&log) && !are_in("t,x\n1,2\n") && !are_in("<Robot name=\"x\"/>"));
        let table = table(&log).unwrap();
        assert_eq!(table.columns[0].name, "IPOC");
        assert_eq!(table.column("IPOC").unwrap(), [4.0, 8.0, 12.0]);
        assert_eq!(table.column("AIPos.A1").unwrap(), [10.0, 10.25, 10.5]);
        let korr = table.column("RKorr.X").unwrap();
        assert!(korr[0] == 0.125 && korr[1].is_nan() && korr[2].is_nan());
        assert_eq!(table.lines, [1, 4, 5]);
        let unit = |name: &str| table.units.get(name).map(String::as_str);
        assert_eq!(unit("IPOC"), Some("ms"));
        assert_eq!(unit("RIst.X"), Some("mm"));
        assert_eq!(unit("RIst.A"), Some("deg"));
        assert_eq!(unit("AIPos.A2"), Some("deg"));
        assert_eq!(unit("MACur.A1"), None);
        let told = table.notes.join("\n");
        for part in ["left out: EStr", "1 answers", "at line 6, is cut off"] {
            assert!(told.contains(part), "{told}");
        }
    }

    #[test]
    fn regress_what_is_wrong_has_its_line() {
        let said = |log: String| table(&log).unwrap_err().to_string();
        let two = format!("{}\n{}", rob(4, 1.0), rob(8, 2.0));
        let text = said(two.replace("2.0", "two"));
        assert_eq!(text, "line 2, column \"AIPos.A1\": \"two\" is not a number");
        let text = said(two.replacen("</Rob>", "", 1));
        assert!(
            text.starts_with("line 2: a telegram begins before"),
            "{text}"
        );
        let text = said(two.replace(
            "A2=\"-0.0\"/><MACur A1=\"0.25\"/><Delay D=\"0\"/><EStr>ok</EStr><IPOC>8",
            "A2=<IPOC>8",
        ));
        assert!(text.starts_with("line 2: the telegram is no XML"), "{text}");
        assert!(said("<Rob></Rob>".to_owned()).contains("no whole telegram"));
    }
}
