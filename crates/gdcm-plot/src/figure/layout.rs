//! Placement of the panels of a figure on paper, with their numbers and labels.

use skrifa::instance::{LocationRef, Size};
use skrifa::{FontRef, GlyphId, MetadataProvider};

use gdcm_model::message_text::sanitized;

use super::axis::{Axis, Range, Tick};
use super::drawing::Area;
use super::figure::{Figure, Panel};
use super::marks::Along;

/// Font size of numbers at ticks, of the legend, of the caption and of texts at dots \[pt\]: the
/// minimum that journals accept.
pub(super) const SMALL_PT: f64 = 7.0;
/// Font size of axis labels and plot titles \[pt\].
pub(super) const LABEL_PT: f64 = 7.5;
/// Height of a line of labels \[pt\].
pub(super) const LABEL_LINE: f64 = 10.0;
/// Height of a line of small text \[pt\].
pub(super) const SMALL_LINE: f64 = 9.0;
/// Length of a tick \[pt\].
pub(super) const TICK: f64 = 2.2;

/// Space between plots side by side \[pt\].
const COLUMN_GAP: f64 = 9.0;
/// Space between plots below one another \[pt\].
const ROW_GAP: f64 = 5.0;
/// Space between the panels of a plot \[pt\].
const PANEL_GAP: f64 = 4.0;
/// Room to the right of the frames for half a number \[pt\].
const RIGHT: f64 = 6.0;
/// Minimum width of a plot, including the numbers at its left \[pt\].
const LEAST_WIDTH: f64 = 88.0;
/// Minimum width of a plot in a dense figure \[pt\].
const LEAST_DENSE_WIDTH: f64 = 40.0;
/// Minimum height of the frames of a plot \[pt\].
const LEAST_HEIGHT: f64 = 22.0;
/// Maximum height, which leaves room for a caption on an A4 page \[pt\].
const MOST_HEIGHT: f64 = 640.0;
/// Minimum distance between numbers on a vertical axis \[pt\].
const VERTICAL_GAP: f64 = 11.0;

/// A panel at its place.
#[derive(Debug)]
pub(super) struct Placed<'f> {
    pub(super) panel: &'f Panel,
    /// Title of its plot, if shown above this panel.
    pub(super) title: &'f str,
    pub(super) frame: Area,
    pub(super) x: Side,
    pub(super) y: Side,
    /// Font size in the panel \[pt\].
    pub(super) letters_pt: f64,
}

/// Visible range, ticks and label of an axis.
#[derive(Debug)]
pub(super) struct Side {
    pub(super) range: Range,
    pub(super) ticks: Vec<Tick>,
    pub(super) has_numbers: bool,
    pub(super) has_label: bool,
    /// Room for the numbers across the axis \[pt\].
    pub(super) depth: f64,
}

/// Panels at their places, from `top` down.
#[derive(Debug)]
pub(super) struct Layout<'f> {
    pub(super) panels: Vec<Placed<'f>>,
    /// Lower end \[pt\].
    pub(super) bottom: f64,
}

impl<'f> Layout<'f> {
    /// Places the panels of `figure` on paper `width_pt` wide, from `top` down.
    ///
    /// ```text
    /// guess the frames' width; twice:
    ///     heights follow from it; ticks from heights; room for numbers from ticks; the frames' width from what is left
    /// ```
    pub(super) fn of(figure: &'f Figure, width_pt: f64, top: f64) -> Self {
        let table = Table::of(figure, width_pt);
        let mut frame_width = 0.8 * width_pt / table.columns as f64;
        for _ in 0..2 {
            let gutters: f64 = (0..table.columns)
                .map(|column| table.gutter(column, frame_width, top))
                .sum();
            let gaps = COLUMN_GAP * (table.columns - 1) as f64 + RIGHT;
            frame_width = ((width_pt - gutters - gaps) / table.columns as f64).max(LEAST_HEIGHT);
        }
        table.place(frame_width, top)
    }
}

/// The plots in rows and columns.
struct Table<'f> {
    figure: &'f Figure,
    columns: usize,
    rows: usize,
}

impl<'f> Table<'f> {
    fn of(figure: &'f Figure, width_pt: f64) -> Self {
        let least = if figure.dense {
            LEAST_DENSE_WIDTH
        } else {
            LEAST_WIDTH
        };
        let room = ((width_pt / least) as usize).max(1);
        let count = figure.plots.len().max(1);
        let columns = figure.columns.min(count).min(room).max(1);
        Self {
            figure,
            columns,
            rows: count.div_ceil(columns),
        }
    }

    /// Returns the total height of the frames of a plot.
    fn plot_height(&self, frame_width: f64, top: f64) -> f64 {
        let rows = self.rows as f64;
        let around: f64 = (0..self.rows)
            .map(|row| self.above(row) + self.below(row))
            .sum();
        let room = (MOST_HEIGHT - top - around - ROW_GAP * (rows - 1.0)) / rows;
        (self.figure.aspect * frame_width)
            .min(room)
            .max(LEAST_HEIGHT)
    }

    /// Returns the room above the frames of a row, for titles.
    fn above(&self, row: usize) -> f64 {
        let has_title = self
            .row(row)
            .any(|index| !self.figure.plots[index].title.is_empty());
        if has_title { LABEL_LINE + 2.0 } else { 3.0 }
    }

    /// Returns the room below the frames of a row, for numbers and labels.
    fn below(&self, row: usize) -> f64 {
        let has_numbers = self.row(row).any(|index| self.has_x_numbers(index));
        if has_numbers {
            TICK + SMALL_LINE + LABEL_LINE
        } else {
            0.0
        }
    }

    fn row(&self, row: usize) -> impl Iterator<Item = usize> + use<'f> {
        let from = row * self.columns;
        from..(from + self.columns).min(self.figure.plots.len())
    }

    /// Returns whether the horizontal axis of a plot has numbers: its own, or as the last of its
    /// column.
    fn has_x_numbers(&self, index: usize) -> bool {
        !self.figure.shared.x || index + self.columns >= self.figure.plots.len()
    }

    fn has_y_numbers(&self, index: usize) -> bool {
        !self.figure.shared.y || index.is_multiple_of(self.columns)
    }

    /// Returns whether the vertical axis has a label: at the left of each row, and wherever its
    /// quantity differs from that.
    fn has_y_label(&self, index: usize, panel: usize) -> bool {
        let first = index - index % self.columns;
        let label = |plot: usize| {
            self.figure.plots[plot]
                .panels
                .get(panel)
                .map(|panel| &panel.y.label)
        };
        index == first || label(index) != label(first)
    }

    fn x_range(&self, index: usize) -> Range {
        let plots = if self.figure.shared.x {
            &self.figure.plots[..]
        } else {
            &self.figure.plots[index..=index]
        };
        let ranges = plots
            .iter()
            .flat_map(|plot| &plot.panels)
            .map(|panel| panel.shown(Along::X));
        ranges.reduce(Range::union).unwrap_or(Range::new(0.0, 1.0))
    }

    fn y_range(&self, index: usize, panel: usize) -> Range {
        let plots = if self.figure.shared.y {
            &self.figure.plots[..]
        } else {
            &self.figure.plots[index..=index]
        };
        let ranges = plots
            .iter()
            .filter_map(|plot| plot.panels.get(panel))
            .map(|panel| panel.shown(Along::Y));
        ranges.reduce(Range::union).unwrap_or(Range::new(0.0, 1.0))
    }

    /// Returns the heights of the frames of a plot's panels.
    fn heights(&self, index: usize, plot_height: f64) -> Vec<f64> {
        let panels = &self.figure.plots[index].panels;
        let room = plot_height - PANEL_GAP * panels.len().saturating_sub(1) as f64;
        let weights: f64 = panels.iter().map(|panel| panel.weight).sum();
        panels
            .iter()
            .map(|panel| room * panel.weight / weights)
            .collect()
    }

    fn y_side(&self, index: usize, panel: usize, height: f64) -> Side {
        let range = self.y_range(index, panel);
        let axis = &self.figure.plots[index].panels[panel].y;
        let ticks = axis.ticks(range, height, VERTICAL_GAP);
        let has_numbers = self.has_y_numbers(index);
        let depth = if has_numbers {
            TICK + 2.0 + SMALL_PT * widest(&ticks)
        } else {
            TICK
        };
        Side {
            range,
            ticks,
            has_numbers,
            has_label: self.has_y_label(index, panel),
            depth,
        }
    }

    fn x_side(&self, index: usize, panel: usize, frame_width: f64) -> Side {
        let plot = &self.figure.plots[index];
        let is_lowest = panel + 1 == plot.panels.len();
        let range = self.x_range(index);
        let has_numbers = is_lowest && self.has_x_numbers(index);
        let ticks = horizontal_ticks(&plot.panels[panel].x, range, frame_width);
        // With narrow frames, the label of the first in a row serves for all.
        let has_room = LABEL_PT * width(&plot.panels[panel].x.label) <= frame_width + COLUMN_GAP;
        let has_label = has_numbers && (has_room || index.is_multiple_of(self.columns));
        Side {
            range,
            ticks,
            has_numbers,
            has_label,
            depth: TICK + SMALL_LINE,
        }
    }

    /// Returns the room at the left of a column of frames, for numbers and labels.
    fn gutter(&self, column: usize, frame_width: f64, top: f64) -> f64 {
        let plot_height = self.plot_height(frame_width, top);
        let plots = (column..self.figure.plots.len()).step_by(self.columns);
        let sides = plots.flat_map(|index| {
            let heights = self.heights(index, plot_height);
            heights
                .into_iter()
                .enumerate()
                .map(move |(panel, height)| self.y_side(index, panel, height))
        });
        sides
            .map(|side| side.depth + if side.has_label { LABEL_LINE } else { 0.0 })
            .fold(0.0, f64::max)
    }

    fn place(&self, frame_width: f64, top: f64) -> Layout<'f> {
        let plot_height = self.plot_height(frame_width, top);
        let gutters: Vec<f64> = (0..self.columns)
            .map(|column| self.gutter(column, frame_width, top))
            .collect();
        let mut panels = Vec::new();
        let mut y = top;
        for row in 0..self.rows {
            y += self.above(row);
            let mut x = 0.0;
            for (index, gutter) in self.row(row).zip(&gutters) {
                x += gutter;
                self.place_plot(index, [x, y], [frame_width, plot_height], &mut panels);
                x += frame_width + COLUMN_GAP;
            }
            y += plot_height + self.below(row) + ROW_GAP;
        }
        Layout {
            panels,
            bottom: y - ROW_GAP,
        }
    }

    fn place_plot(
        &self,
        index: usize,
        [x, y]: [f64; 2],
        [width, height]: [f64; 2],
        panels: &mut Vec<Placed<'f>>,
    ) {
        let plot = &self.figure.plots[index];
        let mut top = y;
        for (at, (panel, height)) in plot
            .panels
            .iter()
            .zip(self.heights(index, height))
            .enumerate()
        {
            panels.push(Placed {
                panel,
                title: if at == 0 { &plot.title } else { "" },
                frame: Area::new(x, top, width, height),
                x: self.x_side(index, at, width),
                y: self.y_side(index, at, height),
                letters_pt: SMALL_PT,
            });
            top += height + PANEL_GAP;
        }
    }
}

/// Returns the width of the widest label, relative to the font size.
fn widest(ticks: &[Tick]) -> f64 {
    ticks
        .iter()
        .filter_map(|tick| tick.label.as_deref())
        .map(width)
        .fold(0.0, f64::max)
}

/// Returns ticks with labels that do not touch.
fn horizontal_ticks(axis: &Axis, range: Range, length_pt: f64) -> Vec<Tick> {
    let apart = |ticks: &[Tick]| SMALL_PT * widest(ticks) + 5.0;
    let close = axis.ticks(range, length_pt, 12.0);
    let ticks = axis.ticks(range, length_pt, apart(&close).max(12.0));
    match &axis.names {
        // Names have a fixed width: the first guess includes all of them.
        Some(_) => ticks,
        None => axis.ticks(range, length_pt, apart(&ticks).max(12.0)),
    }
}

/// The fonts, with the names by which an SVG viewer may find them.
pub const FONTS: [(&str, &[u8]); 2] = [
    ("Ubuntu", epaint_default_fonts::UBUNTU_LIGHT),
    ("Hack", epaint_default_fonts::HACK_REGULAR),
];

/// A glyph of a font.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Letter {
    pub character: char,
    /// Index of the font in [`FONTS`].
    pub font: usize,
    /// Glyph index in that font; 0 for a character that no font has.
    pub glyph: u16,
    /// Advance to the next letter, relative to the font size.
    pub advance: f64,
}

/// Returns the letters of a line of text, in order; characters without a shape are spelled out.
pub fn letters(words: &str) -> Vec<Letter> {
    let fonts: Vec<FontRef<'_>> = FONTS
        .iter()
        .filter_map(|(_, bytes)| FontRef::new(bytes).ok())
        .collect();
    sanitized(words)
        .chars()
        .filter_map(|character| letter(&fonts, character))
        .collect()
}

fn letter(fonts: &[FontRef<'_>], character: char) -> Option<Letter> {
    let found = fonts
        .iter()
        .enumerate()
        .find_map(|(font, face)| Some((font, face.charmap().map(character)?)));
    let (font, glyph) = found.unwrap_or((0, GlyphId::NOTDEF));
    let metrics = fonts
        .get(font)?
        .glyph_metrics(Size::new(1.0), LocationRef::default());
    let advance = f64::from(metrics.advance_width(glyph)?);
    Some(Letter {
        character,
        font,
        glyph: u16::try_from(glyph.to_u32()).ok()?,
        advance,
    })
}

/// Returns the width of a line of text relative to the font size.
pub fn width(words: &str) -> f64 {
    letters(words).iter().map(|letter| letter.advance).sum()
}

/// Breaks a text between words into lines no wider than `most`, relative to the font size.
pub(super) fn wrapped(text: &str, most: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ').filter(|word| !word.is_empty()) {
        match lines.last_mut() {
            Some(line) if width(line) + width(" ") + width(word) <= most => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sign_that_figures_use_has_a_glyph() {
        for letter in letters("aZ0 Δατωφλζ → − ° ² · … – × ± ≤ ≥ ● ◆ [rad/s]")
        {
            assert_ne!(letter.glyph, 0, "{}", letter.character);
        }
        let arrow = letters("→")[0];
        assert_eq!(FONTS[arrow.font].0, "Hack", "the first font has no arrows");
    }

    #[test]
    fn a_letter_that_no_font_has_takes_room_all_the_same() {
        let unknown = letters("永")[0];
        assert!(unknown.glyph == 0 && unknown.advance > 0.0);
    }

    #[test]
    fn lines_are_no_wider_than_they_may_be() {
        let text = "settings that matter to the figure ".repeat(8);
        let lines = wrapped(&text, 20.0);
        assert!(lines.len() > 3 && lines.iter().all(|line| width(line) <= 20.0));
        assert_eq!(lines.join(" "), text.trim_end());
    }
}
