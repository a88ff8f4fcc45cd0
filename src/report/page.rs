//! A run as one page that opens from the disk: figures, tables, and how it was made.
//!
//! It asks for no other file, so that it can be sent and kept. Every text of a run is escaped: names and reasons are data.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::{FrontPoint, OutcomeCount, front_table};

/// What a page says of a run.
#[derive(Clone, Debug)]
pub struct ReportPage<'a> {
    /// Its name.
    pub title: &'a str,
    /// One paragraph: what was searched, how, and what came of it.
    pub summary: &'a str,
    /// One paragraph for a paper's supplement: every setting that decides the result.
    pub methods: &'a str,
    /// Its front.
    pub front: &'a [FrontPoint],
    /// The front walked again as solids; may be empty.
    pub solids: &'a [FrontPoint],
    /// How candidates ended.
    pub outcomes: &'a [OutcomeCount],
    /// Captions and SVG texts, made by this room.
    pub figures: &'a [(&'a str, String)],
    /// Of some designs their names and a picture (PNG).
    pub designs: &'a [(String, Vec<u8>)],
    /// Files as they are in the folder, with their names.
    pub files: &'a [(&'a str, String)],
}

const STYLE: &str = "
body { font: 16px/1.5 sans-serif; color: #222; max-width: 60rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.6rem; } h2 { font-size: 1.2rem; margin-top: 2.5rem; }
figure { margin: 1.5rem 0; } figure svg, figure img { max-width: 100%; height: auto; background: #fff; }
figcaption { color: #555; }
pre { background: #f4f4f4; padding: 1rem; overflow-x: auto; font-size: 13px; line-height: 1.4; }
table { border-collapse: collapse; } td, th { padding: .15rem .8rem; text-align: right; }
td:first-child, th:first-child { text-align: left; } tr:nth-child(even) { background: #f4f4f4; }
";

impl ReportPage<'_> {
    /// The page as HTML, without scripts.
    #[must_use]
    pub fn html(&self) -> String {
        html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width";
                    meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'; img-src data:";
                    title { (self.title) }
                    style { (PreEscaped(STYLE)) }
                }
                body { (self.body()) }
            }
        }
        .into_string()
    }

    fn body(&self) -> Markup {
        html! {
            h1 { (self.title) }
            p { (self.summary) }
            @for (caption, svg) in self.figures {
                figure {
                    (PreEscaped(svg))
                    figcaption { (caption) }
                }
            }
            @if !self.designs.is_empty() {
                h2 { "Designs of the front" }
                @for (name, png) in self.designs {
                    figure {
                        img alt=(format!("{name} at rest, bent and blocked")) src=(data_uri(png));
                        figcaption { (name) }
                    }
                }
            }
            h2 { "The front" }
            pre { (front_table(self.front)) }
            @if !self.solids.is_empty() {
                h2 { "The front as solids" }
                pre { (front_table(self.solids)) }
            }
            h2 { "How candidates ended" }
            table {
                tr { th { "outcome" } th { "candidates" } }
                @for row in self.outcomes {
                    tr {
                        td { (row.outcome) @if row.rejected { " (rejected)" } }
                        td { (row.candidates) }
                    }
                }
            }
            h2 { "Methods" }
            p { (self.methods) }
            @for (name, text) in self.files {
                h2 { (name) }
                pre { (text) }
            }
        }
    }
}

/// A picture within the page itself.
fn data_uri(png: &[u8]) -> String {
    format!("data:image/png;base64,{}", STANDARD.encode(png))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_of_a_run_are_no_markup() {
        let markup = "<script>alert(1)</script>";
        let point = FrontPoint {
            id: markup.to_owned(),
            flags: markup.to_owned(),
            ..FrontPoint::of([1.0, 2.0])
        };
        let outcome = OutcomeCount { outcome: markup.to_owned(), rejected: true, candidates: 7 };
        let page = ReportPage {
            title: markup,
            summary: markup,
            methods: markup,
            front: std::slice::from_ref(&point),
            solids: std::slice::from_ref(&point),
            outcomes: &[outcome],
            figures: &[("a caption", "<svg></svg>".to_owned())],
            designs: &[(markup.to_owned(), vec![0, 255])],
            files: &[("run.toml", markup.to_owned())],
        };
        let html = page.html();
        assert!(!html.contains("<script"), "{html}");
        // Title twice, summary, methods, outcome, file, a design twice, and id and flags of both tables.
        assert_eq!(html.matches("&lt;script&gt;").count(), 12);
        assert!(html.contains("src=\"data:image/png;base64,AP8=\""));
        assert!(html.contains("<svg></svg>"));
        // Nothing is fetched from elsewhere.
        assert!(!html.contains("http://") && !html.contains("https://"));
    }
}
