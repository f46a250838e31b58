//! Paints a whole figure on paper, or a single panel on any canvas: shapes and texts at their
//! positions.

pub use super::dot_style::DotStyle;

use super::axis::Range;
use super::drawing::{Anchor, Area, Color, Drawing, PT_PER_MM, Shape, Stroke, Text};
use super::figure::{Figure, Panel};
use super::figure_format::ColumnWidth;
use super::layout::{LABEL_LINE, LABEL_PT, Layout, SMALL_LINE, SMALL_PT};
use super::legend::{Entry, Sample};
use super::letters::{HALF_LETTER_HEIGHT, width, wrapped};
use super::marks::Mark;
use super::paint_axes::{grid, horizontal_axis, vertical_axis};
use super::paint_dots::dots_and_labels;
use super::paint_marks::{backgrounds, envelope_areas, mark_lines};
use super::paint_words::{mark_words, rule_label};
use super::placed::{Placed, Side};

/// Margin around the whole figure \[pt\].
const MARGIN: f64 = 3.0;
/// Space above the legend \[pt\].
const LEGEND_GAP: f64 = 3.0;
/// Space above the caption \[pt\].
const CAPTION_GAP: f64 = 1.0;
/// Line around a panel's frame.
const FRAME: Stroke = Stroke::solid(Color::DIM, 0.6);
/// Width of a line sample in the legend \[pt\].
const LINE_SAMPLE: f64 = 22.0;
/// Width of a dot sample or a shaded sample in the legend \[pt\].
const SAMPLE: f64 = 9.0;
/// Height of a shaded sample in the legend \[pt\].
const PATCH: f64 = 6.0;
/// Space between a sample and its text in the legend \[pt\].
const SAMPLE_GAP: f64 = 4.0;
/// Space between legend entries in a line \[pt\].
const ENTRY_GAP: f64 = 10.0;
/// Space between a panel's frame and its title \[pt\].
const TITLE_GAP: f64 = 4.0;

const TITLE: TextStyle = TextStyle {
    size_pt: 8.5,
    line_pt: 11.0,
    color: Color::INK,
};
const CAPTION: TextStyle = TextStyle {
    size_pt: SMALL_PT,
    line_pt: SMALL_LINE,
    color: Color::DIM,
};

/// Font size, line height and colour for a text block.
struct TextStyle {
    size_pt: f64,
    /// Line height \[pt\].
    line_pt: f64,
    color: Color,
}

impl Figure {
    /// Lays the figure out on paper with this width and paints it: title, panels, legend and
    /// caption below one another.
    pub fn drawing(&self, width: ColumnWidth) -> Drawing {
        let width_pt = width.mm() * PT_PER_MM;
        let mut page = Page {
            shapes: Vec::new(),
            inner_pt: width_pt - 2.0 * MARGIN,
            cursor_y: MARGIN,
        };
        page.write(&self.title, TITLE);
        let labels_left_out = page.paint_panels(self);
        page.cursor_y += LEGEND_GAP;
        page.paint_legend(&self.legend());
        page.cursor_y += CAPTION_GAP;
        page.write(&self.printed_caption(labels_left_out), CAPTION);
        Drawing {
            title: self.title.clone(),
            size: [width_pt, page.cursor_y + MARGIN],
            shapes: page.shapes,
        }
    }

    /// Returns the caption; if labels were omitted, their number is appended.
    fn printed_caption(&self, labels_left_out: usize) -> String {
        match labels_left_out {
            0 => self.caption.clone(),
            count => format!("{} Labels omitted for lack of room: {count}.", self.caption),
        }
    }
}

/// A page under construction; content is added from the top down, and y grows downwards.
struct Page {
    shapes: Vec<Shape>,
    /// Width between the margins \[pt\].
    inner_pt: f64,
    /// Lower end of the content so far, where the next block starts \[pt\].
    cursor_y: f64,
}

impl Page {
    /// Writes a text, broken into lines as wide as the page.
    fn write(&mut self, words: &str, style: TextStyle) {
        let lines = wrapped(words, self.inner_pt / style.size_pt);
        let top = self.cursor_y;
        self.cursor_y = top + style.line_pt * lines.len() as f64;
        for (line, words) in lines.into_iter().enumerate() {
            let middle = top + style.line_pt * (line as f64 + 0.5);
            // A text is placed at its base line.
            let place = [MARGIN, middle + HALF_LETTER_HEIGHT * style.size_pt];
            let text = Text::new(place, words, style.size_pt).colored(style.color);
            self.shapes.push(Shape::Text(text));
        }
    }

    /// Paints a figure's panels; returns how many labels were omitted for lack of room.
    fn paint_panels(&mut self, figure: &Figure) -> usize {
        let layout = Layout::new(figure, self.inner_pt, self.cursor_y);
        let mut labels_left_out = 0;
        for mut placed in layout.panels {
            placed.frame.left += MARGIN;
            let painted = paint_with_axes(&placed);
            self.shapes.extend(painted.shapes);
            labels_left_out += painted.labels_left_out;
        }
        self.cursor_y = layout.bottom;
        labels_left_out
    }

    /// Paints the legend, broken into lines as wide as the page.
    fn paint_legend(&mut self, entries: &[Entry]) {
        if entries.is_empty() {
            return;
        }
        let mut x = 0.0;
        let mut y = self.cursor_y + 0.5 * LABEL_LINE;
        for entry in entries {
            let sample_width = match entry.sample {
                Sample::Line(_) => LINE_SAMPLE,
                Sample::Dot { .. } | Sample::Ground(_) => SAMPLE,
            };
            let entry_width = sample_width + SAMPLE_GAP + SMALL_PT * width(&entry.text);
            if x > 0.0 && x + entry_width > self.inner_pt {
                x = 0.0;
                y += LABEL_LINE;
            }
            let start = MARGIN + x;
            let sample = sample_shapes(entry.sample, [start, y], sample_width);
            self.shapes.extend(sample);
            let place = [
                start + sample_width + SAMPLE_GAP,
                y + HALF_LETTER_HEIGHT * SMALL_PT,
            ];
            let text = Text::new(place, &entry.text, SMALL_PT);
            self.shapes.push(Shape::Text(text));
            x += entry_width + ENTRY_GAP;
        }
        self.cursor_y = y + 0.5 * LABEL_LINE;
    }
}

/// Paints a sample from its left end, vertically centred at `y`.
fn sample_shapes(sample: Sample, [start, y]: [f64; 2], sample_width: f64) -> Vec<Shape> {
    match sample {
        Sample::Line(stroke) => {
            vec![Shape::line([[start, y], [start + sample_width, y]], stroke)]
        }
        Sample::Dot {
            shape,
            color,
            filled,
        } => {
            let style = DotStyle {
                shape,
                size: 1.0,
                color,
                filled,
            };
            style.shapes([start + 0.5 * sample_width, y])
        }
        Sample::Ground(color) => {
            let patch = Area::new(start, y - 0.5 * PATCH, sample_width, PATCH);
            vec![Shape::rectangle(patch, Some(color), None)]
        }
    }
}

/// Shapes of a painted panel.
#[derive(Clone, Debug)]
pub struct PaintedPanel {
    pub shapes: Vec<Shape>,
    /// Number of labels omitted for lack of room.
    pub labels_left_out: usize,
}

/// Paints a panel with its frame, axes and title, from the lowest layer to the topmost:
///
/// 1. clipped to the frame: backgrounds (shaded strips, spans and envelopes), grid, lines;
/// 2. frame, axes, title;
/// 3. dots, labels and texts, which may cross the frame.
fn paint_with_axes(placed: &Placed<'_>) -> PaintedPanel {
    let panel = placed.panel;
    let frame = placed.frame;
    let mut clipped = backgrounds(placed);
    clipped.extend(grid(placed));
    for mark in &panel.marks {
        clipped.extend(mark_lines(placed, mark));
    }
    let mut shapes = vec![Shape::Clipped {
        area: frame,
        shapes: clipped,
    }];
    shapes.push(Shape::rectangle(frame, None, Some(FRAME)));
    shapes.extend(horizontal_axis(&placed.x, &panel.x, frame));
    shapes.extend(vertical_axis(&placed.y, &panel.y, frame));
    if !placed.title.is_empty() {
        let [x, y] = frame.at(0.5, 1.0);
        let title = Text::new([x, y - TITLE_GAP], placed.title, LABEL_PT).anchored(Anchor::Middle);
        shapes.push(Shape::Text(title));
    }
    paint_over_lines(placed, shapes)
}

/// Adds dots, labels and texts (layer 3 of [`paint_with_axes`]) to a panel's lower layers.
fn paint_over_lines(placed: &Placed<'_>, mut shapes: Vec<Shape>) -> PaintedPanel {
    let dots = dots_and_labels(placed);
    shapes.extend(dots.shapes);
    for mark in &placed.panel.marks {
        if let Mark::Rule(rule) = mark {
            shapes.extend(rule_label(placed, rule));
        }
    }
    for mark in &placed.panel.marks {
        shapes.extend(mark_words(placed, mark));
    }
    PaintedPanel {
        shapes,
        labels_left_out: dots.labels_left_out,
    }
}

impl Panel {
    /// Paints the marks in `frame` \[pt\] with these x and y ranges; `font_size_pt` is the font
    /// size \[pt\].
    ///
    /// For a canvas that draws frame, axes, grid and title itself (the window). The other
    /// difference from a panel on paper: an envelope with edges is a shaded area instead of two
    /// lines.
    pub fn shapes(&self, frame: Area, [x, y]: [Range; 2], font_size_pt: f64) -> PaintedPanel {
        let placed = Placed {
            panel: self,
            title: "",
            frame,
            x: Side::bare(x),
            y: Side::bare(y),
            font_size_pt,
        };
        let mut clipped = backgrounds(&placed);
        for mark in &self.marks {
            match mark {
                Mark::Envelope(envelope) if envelope.edge.is_some() => {
                    clipped.extend(envelope_areas(&placed, envelope));
                }
                mark => clipped.extend(mark_lines(&placed, mark)),
            }
        }
        let lines = vec![Shape::Clipped {
            area: frame,
            shapes: clipped,
        }];
        paint_over_lines(&placed, lines)
    }
}
