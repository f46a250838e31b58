//! A page written from top to bottom, with numbered sections, tables, figures and a table of
//! contents. The markup is both HTML and well-formed XML.

use gdcm_model::message_text::sanitized;
use gdcm_plot::figure::drawing::Drawing;
use gdcm_plot::figure::{ColumnWidth, Figure};
use gdcm_plot::paper::{escaped, inline_svg};
use gdcm_words::Table;

use super::noted_table::NotedTable;
use super::wording::counted_are;

/// Maximum distance \[pt\] between a simplified line in a figure and its original points: less than
/// the thinnest line width, hence invisible. Simplifying reduces the file size to a quarter.
const TOLERANCE_PT: f64 = 0.1;
/// Maximum number of rows in a table; the result files contain all rows.
const MOST_ROWS: usize = 1000;
/// Maximum number of rows in a table that is kept on one page.
const ROWS_ON_A_SHEET: usize = 30;
/// Maximum number of characters in a cell that is kept on one line.
const LONGEST_LINE_OF_A_CELL: usize = 24;
/// Figure height \[pt\] above which plots are flattened: four such figures with their captions fill
/// an A4 or letter page.
const FIGURE_PT: f64 = 145.0;
/// Minimum ratio of height to width for a plot flattened to a quarter page.
const LEAST_ASPECT: f64 = 0.3;
const STYLE: &str = include_str!("style.css");
/// The page's security policy: no external resources and no scripts, whatever text it contains.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'";

/// A heading in the table of contents.
struct Heading {
    number: String,
    title: String,
}

/// A page under construction.
#[derive(Default)]
pub(super) struct Page {
    body: String,
    headings: Vec<Heading>,
    /// Position of the table of contents in `body`; at the beginning if `None`.
    contents_at: Option<usize>,
    section: usize,
    /// Number of appendices begun so far, which have letters.
    appendix: usize,
    subsection: usize,
    tables: usize,
    figures: usize,
}

impl Page {
    /// Begins a numbered section.
    pub(super) fn section(&mut self, title: &str) {
        self.section += 1;
        self.subsection = 0;
        self.heading("h2", self.section.to_string(), title);
    }

    /// Begins an appendix, lettered from A; its tables and texts are in small print.
    pub(super) fn appendix(&mut self, title: &str) {
        if self.appendix == 0 {
            self.body.push_str("<div class=\"appendix\">\n");
        }
        self.appendix += 1;
        self.subsection = 0;
        self.heading("h2", self.section_number(), title);
    }

    /// Begins a numbered subsection.
    pub(super) fn subsection(&mut self, title: &str) {
        self.subsection += 1;
        let number = format!("{}.{}", self.section_number(), self.subsection);
        self.heading("h3", number, title);
    }

    /// Returns the current section's number, or the current appendix's letter.
    fn section_number(&self) -> String {
        match self.appendix {
            0 => self.section.to_string(),
            count => appendix_letters(count),
        }
    }

    /// Places the table of contents here.
    pub(super) fn contents_here(&mut self) {
        self.contents_at = Some(self.body.len());
    }

    /// Adds a table with a row for each role, to be signed by hand.
    pub(super) fn signatures(&mut self, roles: &[&str]) {
        let columns = ["", "name", "organisation", "date", "signature"];
        self.body
            .push_str("<table class=\"signatures\">\n<thead>\n");
        self.body
            .push_str(&table_row("th", &columns.map(str::to_owned), &[""; 5]));
        self.body.push_str("</thead>\n<tbody>\n");
        for role in roles {
            let cells = [role, "", "", "", ""].map(str::to_owned);
            self.body.push_str(&table_row("td", &cells, &[""; 5]));
        }
        self.body.push_str("</tbody>\n</table>\n");
    }

    /// Begins a group of narrow tables, placed side by side where they fit.
    pub(super) fn begin_side_by_side(&mut self) {
        self.body.push_str("<div class=\"side\">\n");
    }

    /// Ends a group of narrow tables.
    pub(super) fn end_side_by_side(&mut self) {
        self.body.push_str("</div>\n");
    }

    fn heading(&mut self, tag: &str, number: String, title: &str) {
        self.body.push_str(&format!(
            "<{tag} id=\"s{number}\">{number} {}</{tag}>\n",
            markup_text(title)
        ));
        self.headings.push(Heading {
            number,
            title: title.to_owned(),
        });
    }

    /// Adds a heading within a subsection, which the table of contents omits.
    pub(super) fn heading_within(&mut self, title: &str) {
        self.body.push_str(&element("h4", title));
    }

    pub(super) fn paragraph(&mut self, text: &str) {
        self.body.push_str(&element("p", text));
    }

    /// Adds a list; nothing if `items` is empty.
    pub(super) fn list(&mut self, items: impl IntoIterator<Item = impl AsRef<str>>) {
        self.add_list("", items);
    }

    /// Adds a list in small print, for details.
    pub(super) fn fine_list(&mut self, items: impl IntoIterator<Item = impl AsRef<str>>) {
        self.add_list(" class=\"fine\"", items);
    }

    fn add_list(&mut self, class: &str, items: impl IntoIterator<Item = impl AsRef<str>>) {
        let mut elements = String::new();
        for item in items {
            elements.push_str(&element("li", item.as_ref()));
        }
        if !elements.is_empty() {
            self.body
                .push_str(&format!("<ul{class}>\n{elements}</ul>\n"));
        }
    }

    /// Adds a two-column table with names (left) and values (right), without headings.
    pub(super) fn facts<'a>(&mut self, facts: impl IntoIterator<Item = (&'a str, String)>) {
        self.body.push_str("<table class=\"facts\"><tbody>\n");
        for (name, value) in facts {
            self.body.push_str(&format!(
                "<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n",
                markup_text(name),
                markup_text(&value)
            ));
        }
        self.body.push_str("</tbody></table>\n");
    }

    /// Adds a table with at most [`MOST_ROWS`] rows under its title, as a [`NotedTable`]; the
    /// headings are repeated on every printed page. A table without rows is omitted.
    pub(super) fn table(&mut self, table: &Table) {
        if table.rows.is_empty() {
            return;
        }
        let NotedTable { table, notes } = NotedTable::new(table);
        let table = &table;
        self.tables += 1;
        let mut classes = Vec::with_capacity(table.columns.len());
        for column in 0..table.columns.len() {
            classes.push(class_of(table, column));
        }
        let class = if table.rows.len() <= ROWS_ON_A_SHEET {
            " class=\"whole\""
        } else {
            ""
        };
        let title = format!("Table {}. {}", self.tables, table.title);
        self.body.push_str(&format!(
            "<table{class}>\n{}<thead>\n",
            element("caption", &title)
        ));
        self.body
            .push_str(&table_row("th", &table.columns, &classes));
        self.body.push_str("</thead>\n<tbody>\n");
        for cells in table.rows.iter().take(MOST_ROWS) {
            self.body.push_str(&table_row("td", cells, &classes));
        }
        self.body.push_str("</tbody>\n</table>\n");
        if !notes.is_empty() {
            self.body.push_str(&classed("p", "notes", &notes.join(" ")));
        }
        if table.rows.len() > MOST_ROWS {
            let more = table.rows.len() - MOST_ROWS;
            self.paragraph(&format!("{} omitted here.", counted_are(more, "more row")));
        }
    }

    /// Adds a table in parts; each repeats the first column, followed by at most `columns` others.
    pub(super) fn wide_table(&mut self, table: &Table, columns: usize) {
        self.wide_table_behind(table, 1, columns);
    }

    /// Adds a table in parts; each repeats the first `heads` columns, followed by at most `columns`
    /// others.
    pub(super) fn wide_table_behind(&mut self, table: &Table, heads: usize, columns: usize) {
        for from in (heads..table.columns.len()).step_by(columns) {
            let to = from + columns;
            let heading = columns_between(&table.columns, heads, from, to);
            let mut sheet = Table::new(table.title.clone(), heading);
            for row in &table.rows {
                sheet.rows.push(columns_between(row, heads, from, to));
            }
            self.table(&sheet);
        }
    }

    /// Adds a numbered figure; `title` and `caption` replace the figure's own texts.
    pub(super) fn figure(&mut self, figure: &Figure, title: &str, caption: &str) {
        self.figures += 1;
        let bare = Figure {
            title: String::new(),
            caption: String::new(),
            ..figure.clone()
        };
        let drawing = quarter_page(bare).thinned(TOLERANCE_PT);
        let drawing = Drawing {
            title: title.to_owned(),
            ..drawing
        };
        let svg = inline_svg(&drawing, &format!("f{}-", self.figures));
        let caption = format!("Figure {}. {title}. {caption}", self.figures);
        self.body.push_str(&format!(
            "<figure>\n{svg}{}</figure>\n",
            element("figcaption", caption.trim_end())
        ));
    }

    /// Adds constant markup without escaping it.
    pub(super) fn fixed(&mut self, markup: &'static str) {
        self.body.push_str(markup);
    }

    /// Returns the whole page, with a title and `lines` below the title.
    pub(super) fn finish(self, title: &str, lines: &[String]) -> String {
        let mut below = String::new();
        for line in lines {
            below.push_str(&classed("p", "below", line));
        }
        let contents = self.contents();
        let head = markup_text(title);
        let style = STYLE.trim_end();
        let mut body = self.body;
        body.insert_str(self.contents_at.unwrap_or(0), &contents);
        if self.appendix > 0 {
            body.push_str("</div>\n");
        }
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\"/>\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n\
             <title>{head}</title>\n<style>\n{style}\n</style>\n</head>\n<body>\n<header>\n<h1>{head}</h1>\n{below}</header>\n\
             <main>\n{body}</main>\n</body>\n</html>\n"
        )
    }

    /// Returns the headings of the sections and appendices, with their numbers or letters.
    pub(super) fn section_headings(&self) -> Vec<String> {
        let mut headings = Vec::new();
        for Heading { number, title } in &self.headings {
            if !number.contains('.') {
                headings.push(format!("{number}  {title}"));
            }
        }
        headings
    }

    pub(super) fn table_count(&self) -> usize {
        self.tables
    }

    pub(super) fn figure_count(&self) -> usize {
        self.figures
    }

    fn contents(&self) -> String {
        let mut entries = String::new();
        for Heading { number, title } in &self.headings {
            let class = if number.contains('.') {
                "part"
            } else {
                "section"
            };
            entries.push_str(&format!(
                "<li class=\"{class}\"><a href=\"#s{number}\">{number} {}</a></li>\n",
                markup_text(title)
            ));
        }
        format!("<nav aria-label=\"Contents\">\n<h2>Contents</h2>\n<ul>\n{entries}</ul>\n</nav>\n")
    }
}

/// Returns an appendix's letter: A to Z, then A1, B1, …
fn appendix_letters(count: usize) -> String {
    let index = count - 1;
    let letter = char::from(b'A' + (index % 26) as u8);
    match index / 26 {
        0 => letter.to_string(),
        round => format!("{letter}{round}"),
    }
}

/// Draws a figure across the page width and at most a quarter page high: plots are flattened as far
/// as necessary, but not below [`LEAST_ASPECT`]. The height is linear in the aspect ratio, except
/// for tick label widths.
fn quarter_page(figure: Figure) -> Drawing {
    let [_, height] = figure.drawing(ColumnWidth::Double).size;
    if height <= FIGURE_PT {
        return figure.drawing(ColumnWidth::Double);
    }
    // The heights at two aspect ratios give the line on which the wanted height is found.
    let flatter = figure.clone().aspect(0.5 * figure.aspect);
    let [_, half_height] = flatter.drawing(ColumnWidth::Double).size;
    let per_aspect = (height - half_height) / (0.5 * figure.aspect);
    if per_aspect <= 0.0 {
        return flatter.drawing(ColumnWidth::Double);
    }
    let aspect = figure.aspect - (height - FIGURE_PT) / per_aspect;
    let least = LEAST_ASPECT.min(figure.aspect);
    figure
        .aspect(aspect.max(least))
        .drawing(ColumnWidth::Double)
}

/// Returns a table row; `classes` holds one class per column.
fn table_row(tag: &str, cells: &[String], classes: &[&str]) -> String {
    let mut row = String::from("<tr>\n");
    for (text, class) in cells.iter().zip(classes) {
        if class.is_empty() {
            row.push_str(&element(tag, text));
        } else {
            row.push_str(&classed(tag, class, text));
        }
    }
    row.push_str("</tr>\n");
    row
}

/// Returns a row's first `heads` cells and its cells with the indices `from..to`.
fn columns_between(cells: &[String], heads: usize, from: usize, to: usize) -> Vec<String> {
    let to = to.min(cells.len());
    [&cells[..heads], &cells[from..to]].concat()
}

/// Returns a column's CSS class: `n` for numbers, `s` for texts short enough for one line, none for
/// other texts.
fn class_of(table: &Table, column: usize) -> &'static str {
    let is_short = table
        .rows
        .iter()
        .all(|row| row[column].chars().count() <= LONGEST_LINE_OF_A_CELL);
    match (table.has_numbers(column), is_short) {
        (true, _) => "n",
        (false, true) => "s",
        (false, false) => "",
    }
}

/// Escapes a text from any source, so that it contains neither markup nor invisible characters.
fn markup_text(text: &str) -> String {
    escaped(&sanitized(text))
}

/// Returns an HTML element that contains `text`, escaped.
fn element(tag: &str, text: &str) -> String {
    format!("<{tag}>{}</{tag}>\n", markup_text(text))
}

/// Returns an HTML element with a class that contains `text`, escaped.
fn classed(tag: &str, class: &str, text: &str) -> String {
    format!("<{tag} class=\"{class}\">{}</{tag}>\n", markup_text(text))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use roxmltree::{Document, ParsingOptions};

    use gdcm_plot::figure::axis::Axis;
    use gdcm_plot::figure::figure::{Curve, Plot};
    use gdcm_plot::figure::{Panel, Role};

    use super::*;

    fn figure() -> Figure {
        let curve = Curve::new("a", Role::Nominal.stroke(false), [1.0, 2.0], [1.0, 2.0]).key("a");
        let panel = Panel::new(Axis::linear("x"), Axis::linear("y")).with(curve);
        Figure::new("").plot(Plot::new("").panel(panel.clone()).panel(panel))
    }

    fn page() -> String {
        let mut page = Page::default();
        page.section("First <of all>");
        page.subsection("A part");
        page.figure(&figure(), "One", "It has a caption.");
        page.figure(&figure(), "Two", "");
        page.section("Second");
        let mut table = Table::new("Gains & delays", ["model", "J [-]"]);
        table.row(["V+5kt", "1.5"]);
        page.table(&table);
        page.table(&Table::new("left out", ["nothing"]));
        page.finish("A <title>", &["below & so on".to_owned()])
    }

    /// Parses a page as XML. The document type is allowed: HTML's refers to no file.
    fn parsed(text: &str) -> Document<'_> {
        Document::parse_with_options(
            text,
            ParsingOptions {
                allow_dtd: true,
                ..ParsingOptions::default()
            },
        )
        .unwrap()
    }

    #[test]
    fn sections_tables_and_figures_are_numbered_and_the_contents_lead_to_them() {
        let text = page();
        let document = parsed(&text);
        let of = |tag: &'static str| {
            document
                .descendants()
                .filter(move |node| node.has_tag_name(tag))
        };
        let links: Vec<&str> = of("a").filter_map(|node| node.attribute("href")).collect();
        assert_eq!(links, ["#s1", "#s1.1", "#s2"]);
        let ids: BTreeSet<&str> = document
            .descendants()
            .filter_map(|node| node.attribute("id"))
            .collect();
        assert!(links.iter().all(|link| ids.contains(&link[1..])));
        let captions: Vec<&str> = of("figcaption").filter_map(|node| node.text()).collect();
        assert_eq!(
            captions,
            ["Figure 1. One. It has a caption.", "Figure 2. Two."]
        );
        assert_eq!(
            of("caption")
                .filter_map(|node| node.text())
                .collect::<Vec<_>>(),
            ["Table 1. Gains & delays"]
        );
    }

    #[test]
    fn no_two_parts_of_a_page_share_a_name_and_every_name_that_is_referred_to_is_there() {
        let text = page();
        let document = parsed(&text);
        let ids: Vec<&str> = document
            .descendants()
            .filter_map(|node| node.attribute("id"))
            .collect();
        assert_eq!(
            ids.iter().collect::<BTreeSet<_>>().len(),
            ids.len(),
            "{ids:?}"
        );
        let clips: Vec<&str> = document
            .descendants()
            .filter_map(|node| node.attribute("clip-path"))
            .collect();
        assert_eq!(clips.len(), 4);
        assert!(
            clips
                .iter()
                .all(|clip| ids.contains(&&clip["url(#".len()..clip.len() - 1])),
            "{clips:?}"
        );
    }

    #[test]
    fn a_figure_has_a_description_for_screen_readers() {
        let text = page();
        let document = parsed(&text);
        let labels: Vec<_> = document
            .descendants()
            .filter(|node| node.has_tag_name("svg"))
            .collect();
        let said = labels
            .iter()
            .map(|svg| (svg.attribute("role"), svg.attribute("aria-label")))
            .collect::<Vec<_>>();
        assert_eq!(
            said,
            [(Some("img"), Some("One")), (Some("img"), Some("Two"))]
        );
    }

    #[test]
    fn words_from_a_file_are_no_markup_and_hide_nothing() {
        let name = "<b onclick=\"x\">V+5kt & 'roll'\u{1b}[2J\u{202e}";
        let text = "&lt;b onclick=&quot;x&quot;&gt;V+5kt &amp; 'roll'\\u{1b}[2J\\u{202e}";
        assert_eq!(markup_text(name), text);
        assert_eq!(element("td", name), format!("<td>{text}</td>\n"));
    }

    #[test]
    fn letters_of_every_language_stay() {
        assert_eq!(markup_text("Höhe Δφ → 重量"), "Höhe Δφ → 重量");
    }
}
