//! The page: head, contents, sections, and the scripts at its end, after everything readable.

use std::fmt::Write as _;

use crate::document::{Block, Report, Section};
use crate::error::Error;
use crate::figure;
use crate::html::{escape, escape_json};
use crate::plot::Plot;
use crate::small_print;
use crate::tile::Tile;

const STYLE: &str = include_str!("../assets/page.css");
const WATCH: &str = include_str!("../assets/watch.js");
const SCRIPT: &str = include_str!("../assets/page.js");
const PLOTLY: &str = include_str!("../assets/plotly/plotly-cartesian.min.js");

/// The browser refuses to fetch anything, to send a form anywhere, and to resolve addresses
/// against another base; the last two do not fall back to `default-src`. Pictures come only from
/// the page's own canvas, for the button that saves a plot.
const POLICY: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; \
                      img-src data: blob:; form-action 'none'; base-uri 'none'";

/// More sections than this get a table of contents.
const SECTIONS_WITHOUT_CONTENTS: usize = 4;

const PANEL_HEIGHT_PX: u32 = 190;
const SINGLE_HEIGHT_PX: u32 = 340;
/// Axis titles, ticks and legend.
const FRAME_HEIGHT_PX: u32 = 110;
const BAR_HEIGHT_PX: u32 = 24;

pub(crate) fn render(report: &Report) -> Result<String, Error> {
    let mut page = head(report);
    let mut figures = Figures::default();
    for (index, section) in report.sections.iter().enumerate() {
        page.push_str(&section_html(section, index + 1, &mut figures)?);
    }
    page.push_str("</main>\n");
    if figures.count > 0 {
        push(&mut page, format_args!("<script>{}</script>\n", without_links(PLOTLY)));
    }
    push(&mut page, format_args!("<script>\n{SCRIPT}</script>\n</body>\n</html>\n"));
    Ok(page)
}

fn head(report: &Report) -> String {
    let title = escape(&report.title);
    let mut out = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{title}</title>\n<style>\n{STYLE}</style>\n\
         <script>\n{WATCH}</script>\n\
         <noscript><style>.views {{ display: none; }}</style></noscript>\n\
         </head>\n<body>\n<main>\n<header>\n<h1>{title}</h1>\n"
    );
    if !report.subtitle.is_empty() {
        push(&mut out, format_args!("<p class=\"subtitle\">{}</p>\n", escape(&report.subtitle)));
    }
    if !report.facts.is_empty() {
        out.push_str("<dl class=\"facts\">\n");
        for (name, value) in &report.facts {
            let (name, value) = (escape(name), escape(value));
            push(&mut out, format_args!("<div><dt>{name}</dt><dd>{value}</dd></div>\n"));
        }
        out.push_str("</dl>\n");
    }
    out.push_str(
        "</header>\n<noscript><p class=\"note\">The plots of this report need JavaScript; \
         text and tables do not.</p></noscript>\n",
    );
    if report.sections.len() > SECTIONS_WITHOUT_CONTENTS {
        out.push_str("<nav>\n<ol>\n");
        for (index, section) in report.sections.iter().enumerate() {
            let heading = escape(&section.heading);
            push(&mut out, format_args!("<li><a href=\"#s{}\">{heading}</a></li>\n", index + 1));
        }
        out.push_str("</ol>\n</nav>\n");
    }
    out
}

/// Figures are counted through the whole report.
#[derive(Default)]
struct Figures {
    count: usize,
}

fn section_html(section: &Section, number: usize, figures: &mut Figures) -> Result<String, Error> {
    let mut out = format!("<section id=\"s{number}\">\n<h2>{}</h2>\n", escape(&section.heading));
    for block in &section.blocks {
        match block {
            Block::Text(text) => {
                for paragraph in text.split("\n\n") {
                    push(&mut out, format_args!("<p>{}</p>\n", escape(paragraph)));
                }
            }
            Block::Heading(text) => {
                push(&mut out, format_args!("<h3>{}</h3>\n", escape(text)));
            }
            Block::Preformatted(text) => {
                push(&mut out, format_args!("<pre>{}</pre>\n", escape(text)));
            }
            Block::Note(text) => {
                push(&mut out, format_args!("<p class=\"note\">{}</p>\n", escape(text)));
            }
            Block::Warning(text) => {
                let text = escape(text);
                push(&mut out, format_args!("<p class=\"warning\" role=\"alert\">{text}</p>\n"));
            }
            Block::Tiles(tiles) => {
                let tiles: String = tiles.iter().map(Tile::html).collect();
                push(&mut out, format_args!("<dl class=\"tiles\">\n{tiles}</dl>\n"));
            }
            Block::Table(table) => out.push_str(&table.html()?),
            Block::Plots(plots) => {
                out.push_str("<div class=\"figures\">\n");
                for plot in plots {
                    out.push_str(&figures.html(plot)?);
                }
                out.push_str("</div>\n");
            }
        }
    }
    out.push_str("</section>\n");
    Ok(out)
}

impl Figures {
    fn html(&mut self, plot: &Plot) -> Result<String, Error> {
        plot.check()?;
        self.count += 1;
        let number = self.count;
        let height = plot.height_px.unwrap_or_else(|| default_height(plot));
        let mut out = format!(
            "<figure id=\"f{number}\"{}>\n<figcaption><b>Figure {number}.</b> {}</figcaption>\n",
            if plot.marked { " class=\"marked\"" } else { "" },
            escape(&plot.title)
        );
        push(&mut out, format_args!("<div class=\"views zooms-{}\">\n", plot.zooms.len().min(2)));
        let captions = plot.zooms.iter().map(|zoom| zoom.caption.as_str());
        let first = if plot.zooms.is_empty() { "" } else { "whole" };
        for caption in std::iter::once(first).chain(captions) {
            let caption = escape(caption);
            push(
                &mut out,
                format_args!(
                    "<div class=\"view\"><p>{caption}</p>\
                     <div class=\"canvas\" style=\"height:{height}px\"></div></div>\n"
                ),
            );
        }
        out.push_str("</div>\n");
        if !plot.caption.is_empty() {
            push(&mut out, format_args!("<p class=\"caption\">{}</p>\n", escape(&plot.caption)));
        }
        for line in small_print::lines(plot) {
            push(&mut out, format_args!("<p class=\"small-print\">{}</p>\n", escape(&line)));
        }
        let views: serde_json::Value = std::iter::once(figure::view(plot, None))
            .chain(plot.zooms.iter().map(|zoom| figure::view(plot, Some(zoom))))
            .collect();
        let json = escape_json(&views.to_string());
        push(
            &mut out,
            format_args!("<script type=\"application/json\">{json}</script>\n</figure>\n"),
        );
        Ok(out)
    }
}

fn default_height(plot: &Plot) -> u32 {
    let bars = figure::bar_names(plot).len();
    match (bars, plot.panels.len() as u32) {
        (0, 1) => SINGLE_HEIGHT_PX,
        (0, panels) => FRAME_HEIGHT_PX + PANEL_HEIGHT_PX * panels,
        (bars, _) => FRAME_HEIGHT_PX + BAR_HEIGHT_PX * bars as u32,
    }
}

/// Breaks every address in the embedded library: its logo link, help texts and map server are not
/// used, and what is not an address cannot be opened. Name spaces are names and stay.
fn without_links(script: &str) -> String {
    const NAME_SPACES: &str = "www.w3.org/";
    let mut out = String::with_capacity(script.len());
    let mut rest = script;
    while let Some(at) = rest.find("://") {
        let (before, after) = rest.split_at(at + 3);
        let scheme = ["https://", "http://"].into_iter().find(|s| before.ends_with(s));
        match scheme {
            Some(scheme) if !after.starts_with(NAME_SPACES) => {
                out.push_str(&before[..before.len() - scheme.len()]);
                out.push_str("offline:");
            }
            _ => out.push_str(before),
        }
        rest = after;
    }
    out.push_str(rest);
    out
}

fn push(out: &mut String, text: std::fmt::Arguments<'_>) {
    // Writing to a string cannot fail.
    let _ = out.write_fmt(text);
}

#[cfg(test)]
mod tests {
    use super::{PLOTLY, without_links};

    #[test]
    fn links_break_and_name_spaces_stay() {
        assert_eq!(
            without_links("a https://x.y/z 'http://www.w3.org/2000/svg' (http://q) file:// b://"),
            "a offline:x.y/z 'http://www.w3.org/2000/svg' (offline:q) file:// b://"
        );
    }

    #[test]
    fn the_library_keeps_its_licence_and_cannot_end_its_element() {
        let script = without_links(PLOTLY);
        assert!(script.contains("Licensed under the MIT license"));
        assert!(!script.to_ascii_lowercase().contains("</script"));
        assert!(!script.contains("<!--"));
    }
}
