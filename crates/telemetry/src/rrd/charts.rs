//! Charts without a run, for the viewer: curves over anything, beside a text.

use std::path::Path;

use super::store::{Logged, Store};
use re_sdk_types::blueprint::components::PlayState;
use truecut_recording::SinkError;

use super::blueprint::{Layout, Part};
use super::chart::Chart;
use super::layout::chart_view;
use super::results::Drawn;
use super::{application, log_text, write_store};
use crate::error::failed;

/// Where the text is logged.
const TEXT: &str = "/text";
/// Charts that stand one above the other on a page; lower ones would have no room for the names of
/// their axes. The rest lie behind the last.
const MOST_ROWS: usize = 3;

/// Charts that stand one above the other.
#[derive(Debug, Clone, PartialEq)]
pub struct ChartPage {
    /// Title of its tab.
    pub title: String,
    /// From the top; from the third on behind each other if there are more than three.
    pub charts: Vec<Chart>,
}

/// Writes the file: at the left the text, at the right the pages as tabs.
///
/// # Errors
/// Where the file cannot be written.
pub fn write_charts(
    path: &Path,
    title: &str,
    text: &str,
    pages: &[ChartPage],
) -> Result<(), SinkError> {
    let log = |stream: &Store| {
        log_text(stream, TEXT, format!("# {title}\n\n```\n{text}\n```\n"))?;
        let layout = Layout::new(application(title))?;
        let words = layout.document(title, TEXT)?;
        let right = log_pages(stream, &layout, pages)?;
        let root = layout.side_by_side(vec![(0.6, words), (1.4, right)])?;
        layout.send(&root, PlayState::Paused, stream)
    };
    write_store(path, title, log).map_err(failed(path, "write the charts"))
}

/// Logs pages of charts and gives the part of the layout that shows them.
pub(super) fn log_pages(stream: &Store, layout: &Layout, pages: &[ChartPage]) -> Logged<Part> {
    let mut tabs = Vec::new();
    for (p, page) in pages.iter().enumerate() {
        let mut rows = Vec::new();
        for (c, chart) in page.charts.iter().enumerate() {
            let entity = format!("/charts/{p}/{c}");
            let drawn = Drawn::of(chart.clone(), stream, entity)?;
            rows.push(chart_view(layout, &drawn)?);
        }
        if rows.len() > MOST_ROWS {
            let behind = rows.split_off(MOST_ROWS - 1);
            rows.push(layout.tabs(&behind)?);
        }
        let rows = rows.into_iter().map(|row| (1.0, row)).collect();
        tabs.push(layout.titled_stack(&page.title, rows)?);
    }
    layout.pages(tabs)
}
