//! Reports as one HTML page, for every command: self-contained, with figures that can be zoomed.
//!
//! A page holds its data, its styles and its script (uPlot, `uplot/LICENSE`, and `draw.js`) and
//! loads nothing. Its content security policy names the hashes of style and script, so that nothing
//! else can run, whatever names a scenario has; texts are escaped where they are written.

mod figures;
mod parts;
mod space;

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use sha2::{Digest, Sha256};

use crate::figure::Figure;

pub use figures::POINTS as MOST_POINTS;
pub use parts::{called, cells, claims, notes, repeat, reproduce, scalars, table};
pub use space::Space;

/// Name of the file, in a command's folder.
pub const REPORT: &str = "report.html";

const STYLE: &str = concat!(
    include_str!("uplot/uPlot.min.css"),
    include_str!("page.css")
);
const SCRIPT: &str = concat!(
    "/*\n",
    include_str!("uplot/LICENSE"),
    "*/\n",
    include_str!("uplot/uPlot.iife.min.js"),
    include_str!("colours.js"),
    include_str!("draw.js"),
    include_str!("space/space.js")
);

/// What a report says, in its order.
pub struct Page {
    title: String,
    command: &'static str,
    body: Vec<Block>,
}

enum Block {
    Text(Markup),
    Figure(Figure),
}

impl Page {
    /// An empty page of a command.
    pub fn new(command: &'static str, title: impl Into<String>) -> Page {
        Page {
            title: title.into(),
            command,
            body: Vec::new(),
        }
    }

    /// The result in a sentence or two; `good` or not.
    pub fn verdict(&mut self, good: bool, headline: &str, detail: &str) {
        let class = if good { "verdict" } else { "verdict bad" };
        self.text(html! { p class=(class) { b { (headline) } br; (detail) } });
    }

    /// What the program prints: notes as a list, the rest as it stands there.
    pub fn told(&mut self, printed: &str) {
        let (notes, rest): (Vec<&str>, Vec<&str>) = printed
            .lines()
            .partition(|line| line.starts_with(parts::NOTE));
        let rest = rest.join("\n");
        self.text(html! { pre { (rest.trim_matches('\n')) } });
        let notes = notes
            .iter()
            .map(|note| note.trim_start_matches(parts::NOTE));
        self.text(parts::notes(&notes.collect::<Vec<_>>()));
    }

    /// More text.
    pub fn text(&mut self, markup: Markup) {
        self.body.push(Block::Text(markup));
    }

    /// Figures under a heading; nothing without any.
    pub fn figures(&mut self, heading: &str, figures: impl IntoIterator<Item = Figure>) {
        let mut figures = figures.into_iter().peekable();
        if figures.peek().is_some() {
            self.text(html! {
                h2 { (heading) }
                p.hint { "Draw a box to zoom in, click twice to see all; a name in the legend hides its curve." }
            });
        }
        self.body.extend(figures.map(Block::Figure));
    }

    /// Something to be looked at from all sides, under a heading; nothing where there is none.
    pub fn space(&mut self, heading: &str, space: Space) {
        if space.is_empty() {
            return;
        }
        self.text(html! {
            h2 { (heading) }
            p.hint {
                "Drag to turn, with Shift to move; after a click the wheel, + and − come nearer. A name below shows or hides."
            }
        });
        self.text(space.markup());
    }

    /// The page as HTML.
    pub fn html(&self) -> String {
        let text = |block: &Block| match block {
            Block::Text(markup) => markup.0.len(),
            Block::Figure(_) => 0,
        };
        let beside = self.body.iter().map(text).sum();
        let most = figures::most_points(self.body.iter().filter_map(Block::figure), beside);
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta http-equiv="Content-Security-Policy" content=(policy());
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    meta name="generator" content={ "truecut " (env!("CARGO_PKG_VERSION")) };
                    title { (self.title) }
                    style { (PreEscaped(STYLE)) }
                }
                body {
                    h1 { (self.title) }
                    @for block in &self.body {
                        @match block {
                            Block::Text(markup) => { (markup) }
                            Block::Figure(figure) => { (figures::markup(figure, most)) }
                        }
                    }
                    footer {
                        "truecut " (self.command) ", version " (env!("CARGO_PKG_VERSION"))
                        ". Figures by uPlot (MIT licence)."
                    }
                    script { (PreEscaped(SCRIPT)) }
                }
            }
        };
        page.into_string()
    }
}

impl Block {
    fn figure(&self) -> Option<&Figure> {
        match self {
            Block::Text(_) => None,
            Block::Figure(figure) => Some(figure),
        }
    }
}

/// Nothing is loaded, and only this style and this script are used.
fn policy() -> String {
    let hash = |text: &str| BASE64_STANDARD.encode(Sha256::digest(text));
    format!(
        "default-src 'none'; script-src 'sha256-{}'; style-src 'sha256-{}'; base-uri 'none'; form-action 'none'",
        hash(SCRIPT),
        hash(STYLE)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::{Layer, Legend, Panel};
    use truecut_recording::Scene;

    const NAME: &str = "</script><script>alert(1)</script>";

    /// A page on which everything has a bad name.
    fn page(points: usize) -> String {
        let wave = (0..points).map(|k| (k as f64, (0.01 * k as f64).sin()));
        let layer = Layer::line(NAME, wave, 0);
        let figure = Figure {
            title: NAME.into(),
            panels: vec![Panel::new(NAME, NAME, NAME, vec![layer])],
            columns: 1,
            legend: Legend::Above,
        };
        let mut page = Page::new("run", NAME);
        page.verdict(false, NAME, NAME);
        page.text(notes(&[NAME.to_owned()]));
        page.text(repeat(NAME, NAME));
        page.told(&format!("{NAME}\n  note: {NAME}"));
        page.figures(NAME, [figure]);
        let mut space = Space::of_scene(NAME, &Scene::default(), &[]);
        space.lines(NAME, [0; 3], vec![vec![[0.0; 3], [1.0; 3]]]);
        page.space(NAME, space);
        page.html()
    }

    #[test]
    fn names_cannot_leave_their_place() {
        let html = page(50);
        assert!(!html.contains("<script>alert"), "{html}");
        // One script with code, two blocks of data.
        assert_eq!(html.matches("<script").count(), 3);
        assert_eq!(html.matches("</script>").count(), 3);
        assert!(!html.contains("http://") && html.contains("default-src 'none'"));
    }

    #[test]
    fn a_page_of_long_recordings_stays_small() {
        let html = page(1_000_000);
        assert!(html.len() < 3_000_000, "{}", html.len());
        let data = html.split("application/json\">").nth(1).unwrap();
        let data = data.split("</script>").next().unwrap();
        let panel: serde_json::Value = serde_json::from_str(data).unwrap();
        let layer = &panel["layers"][0];
        let points = layer["x"].as_array().unwrap().len();
        assert!((15_000..=20_000).contains(&points), "{points}");
        assert_eq!(layer["label"], NAME);
    }
}
