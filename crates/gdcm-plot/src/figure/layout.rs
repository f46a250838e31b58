//! Places a figure's panels on paper, with room for tick labels and axis labels.

pub use super::letters::width;

use super::axis::{Axis, Range, Tick};
use super::drawing::Area;
use super::figure::{Figure, Plot};
use super::marks::Along;
use super::placed::{Placed, Side};

/// Font size for tick labels, legend, caption and texts at dots \[pt\]: the minimum that journals
/// accept.
pub(super) const SMALL_PT: f64 = 7.0;
/// Font size for axis labels and plot titles \[pt\].
pub(super) const LABEL_PT: f64 = 7.5;
/// Line height for labels \[pt\].
pub(super) const LABEL_LINE: f64 = 10.0;
/// Line height for small text \[pt\].
pub(super) const SMALL_LINE: f64 = 9.0;
/// Tick length \[pt\].
pub(super) const TICK: f64 = 2.2;

/// Space between plots side by side \[pt\].
const COLUMN_GAP: f64 = 9.0;
/// Space between plots below one another \[pt\].
const ROW_GAP: f64 = 5.0;
/// Space between a plot's panels \[pt\].
const PANEL_GAP: f64 = 4.0;
/// Space to the right of the frames, for half a tick label \[pt\].
const RIGHT: f64 = 6.0;
/// Minimum plot width, including the tick labels to the left \[pt\].
const LEAST_WIDTH: f64 = 88.0;
/// Minimum plot width, including tick labels, in a dense figure \[pt\].
const LEAST_DENSE_WIDTH: f64 = 40.0;
/// Minimum width and minimum total height of a plot's frames \[pt\].
const LEAST_FRAME: f64 = 22.0;
/// Maximum distance from the top of the paper to the lower end of the panels \[pt\]; it leaves room
/// for a caption on an A4 page.
const MOST_HEIGHT: f64 = 640.0;
/// Minimum distance between tick labels on a vertical axis \[pt\].
const VERTICAL_GAP: f64 = 11.0;
/// Minimum distance between the centres of tick labels on a horizontal axis \[pt\].
const HORIZONTAL_GAP: f64 = 12.0;
/// Minimum space between neighbouring tick labels on a horizontal axis \[pt\].
const NUMBER_SPACE: f64 = 5.0;
/// Space between a row's titles and its frames \[pt\].
const TITLE_SPACE: f64 = 2.0;
/// Space above a row of frames without titles, for half a tick label \[pt\].
const UNTITLED_SPACE: f64 = 3.0;
/// Space between a tick and its label on a vertical axis \[pt\].
const TICK_LABEL_SPACE: f64 = 2.0;
/// Share of the paper width assumed for the frames before the room beside them is known.
const FIRST_GUESS: f64 = 0.8;
/// Axis range used if a figure has no panels.
const EMPTY: Range = Range { min: 0.0, max: 1.0 };

/// Panels at their positions.
#[derive(Debug)]
pub(super) struct Layout<'f> {
    pub(super) panels: Vec<Placed<'f>>,
    /// Lower end of the panels with their axis labels \[pt\].
    pub(super) bottom: f64,
}

impl<'f> Layout<'f> {
    /// Places the panels in `figure` on paper `width_pt` wide, from `top` down.
    ///
    /// ```text
    /// rows and columns: as many columns as requested, if the paper is wide enough
    /// guess the frame width
    /// twice:
    ///     frame heights, from the width                                                 (gutters)
    ///     vertical ticks, from the heights
    ///     room for numbers and labels beside each column, the gutters, from the ticks
    ///     frame width, from the remaining room
    /// place the panels row by row                                                         (place)
    /// ```
    pub(super) fn new(figure: &'f Figure, width_pt: f64, top: f64) -> Self {
        let table = PlotTable::new(figure, width_pt, top);
        let columns = table.columns as f64;
        let mut frame_width = FIRST_GUESS * width_pt / columns;
        for _ in 0..2 {
            let gutters: f64 = table.gutters(frame_width).iter().sum();
            let gaps = COLUMN_GAP * (table.columns - 1) as f64 + RIGHT;
            frame_width = ((width_pt - gutters - gaps) / columns).max(LEAST_FRAME);
        }
        table.place(frame_width)
    }
}

/// The plots in rows and columns. In its methods, `index` numbers the plots in reading order, and
/// `panel` counts a plot's panels from the top.
struct PlotTable<'f> {
    figure: &'f Figure,
    columns: usize,
    rows: usize,
    /// Upper end of the table, titles included \[pt\].
    top: f64,
}

impl<'f> PlotTable<'f> {
    fn new(figure: &'f Figure, width_pt: f64, top: f64) -> Self {
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
            top,
        }
    }

    /// Returns the height of a plot's frames with the gaps between them \[pt\].
    fn plot_height(&self, frame_width: f64) -> f64 {
        let rows = self.rows as f64;
        let around: f64 = (0..self.rows)
            .map(|row| self.above(row) + self.below(row))
            .sum();
        let room = (MOST_HEIGHT - self.top - around - ROW_GAP * (rows - 1.0)) / rows;
        (self.figure.aspect * frame_width)
            .min(room)
            .max(LEAST_FRAME)
    }

    /// Returns the height \[pt\] that the titles above a row's frames need.
    fn above(&self, row: usize) -> f64 {
        let has_title = self
            .row(row)
            .any(|index| !self.figure.plots[index].title.is_empty());
        if has_title {
            LABEL_LINE + TITLE_SPACE
        } else {
            UNTITLED_SPACE
        }
    }

    /// Returns the height \[pt\] that tick labels and axis labels below a row's frames need.
    fn below(&self, row: usize) -> f64 {
        let has_numbers = self.row(row).any(|index| self.has_x_numbers(index));
        if has_numbers {
            TICK + SMALL_LINE + LABEL_LINE
        } else {
            0.0
        }
    }

    /// Returns the plot indices in a row.
    fn row(&self, row: usize) -> std::ops::Range<usize> {
        let from = row * self.columns;
        from..(from + self.columns).min(self.figure.plots.len())
    }

    /// Returns whether a plot's horizontal axis has tick labels: always if it is not shared,
    /// otherwise only at the bottom of each column.
    fn has_x_numbers(&self, index: usize) -> bool {
        !self.figure.shared.x || index + self.columns >= self.figure.plots.len()
    }

    /// Returns whether a plot's vertical axis has tick labels: always if it is not shared,
    /// otherwise only at the left of each row.
    fn has_y_numbers(&self, index: usize) -> bool {
        !self.figure.shared.y || index.is_multiple_of(self.columns)
    }

    /// Returns whether a panel's vertical axis has a label: in the first plot of each row, and in
    /// each plot whose label differs from that in the first plot.
    fn has_y_label(&self, index: usize, panel: usize) -> bool {
        let first = index - index % self.columns;
        index == first || self.y_label(index, panel) != self.y_label(first, panel)
    }

    fn y_label(&self, index: usize, panel: usize) -> Option<&str> {
        let panel = self.figure.plots[index].panels.get(panel)?;
        Some(&panel.y.label)
    }

    /// Returns the plots that share an axis range with a plot, including the plot itself.
    fn sharing(&self, index: usize, is_shared: bool) -> &'f [Plot] {
        if is_shared {
            &self.figure.plots
        } else {
            &self.figure.plots[index..=index]
        }
    }

    /// Returns the horizontal range shared by a plot's panels.
    fn x_range(&self, index: usize) -> Range {
        self.sharing(index, self.figure.shared.x)
            .iter()
            .flat_map(|plot| &plot.panels)
            .map(|panel| panel.shown(Along::X))
            .reduce(Range::union)
            .unwrap_or(EMPTY)
    }

    /// Returns a panel's vertical range; `panel` counts from the top of the plot.
    fn y_range(&self, index: usize, panel: usize) -> Range {
        self.sharing(index, self.figure.shared.y)
            .iter()
            .filter_map(|plot| plot.panels.get(panel))
            .map(|panel| panel.shown(Along::Y))
            .reduce(Range::union)
            .unwrap_or(EMPTY)
    }

    /// Returns the height of each frame in a plot \[pt\].
    fn heights(&self, index: usize, plot_height: f64) -> Vec<f64> {
        let panels = &self.figure.plots[index].panels;
        let room = plot_height - PANEL_GAP * panels.len().saturating_sub(1) as f64;
        let weights: f64 = panels.iter().map(|panel| panel.weight).sum();
        panels
            .iter()
            .map(|panel| room * panel.weight / weights)
            .collect()
    }

    /// Returns a panel's vertical axis, with its ticks and the room that they need.
    fn y_side(&self, index: usize, panel: usize, height: f64) -> Side {
        let range = self.y_range(index, panel);
        let axis = &self.figure.plots[index].panels[panel].y;
        let ticks = axis.ticks(range, height, VERTICAL_GAP);
        let has_numbers = self.has_y_numbers(index);
        let depth = if has_numbers {
            TICK + TICK_LABEL_SPACE + SMALL_PT * widest(&ticks)
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

    /// Returns a panel's horizontal axis; only the lowest panel of a plot shows tick labels.
    fn x_side(&self, index: usize, panel: usize, frame_width: f64) -> Side {
        let plot = &self.figure.plots[index];
        let axis = &plot.panels[panel].x;
        let is_lowest = panel + 1 == plot.panels.len();
        let range = self.x_range(index);
        let has_numbers = is_lowest && self.has_x_numbers(index);
        // If the frames are too narrow for the label, only the row's first plot shows it.
        let has_room = LABEL_PT * width(&axis.label) <= frame_width + COLUMN_GAP;
        Side {
            range,
            ticks: horizontal_ticks(axis, range, frame_width),
            has_numbers,
            has_label: has_numbers && (has_room || index.is_multiple_of(self.columns)),
            depth: TICK + SMALL_LINE,
        }
    }

    /// Returns the width \[pt\] to the left of each column that tick labels and axis labels need.
    fn gutters(&self, frame_width: f64) -> Vec<f64> {
        let plot_height = self.plot_height(frame_width);
        (0..self.columns)
            .map(|column| self.gutter(column, plot_height))
            .collect()
    }

    /// Returns the width \[pt\] to the left of a column: the largest that any of its panels needs.
    fn gutter(&self, column: usize, plot_height: f64) -> f64 {
        let mut most = 0.0;
        for index in (column..self.figure.plots.len()).step_by(self.columns) {
            let heights = self.heights(index, plot_height);
            for (panel, height) in heights.into_iter().enumerate() {
                let side = self.y_side(index, panel, height);
                let label = if side.has_label { LABEL_LINE } else { 0.0 };
                most = f64::max(most, side.depth + label);
            }
        }
        most
    }

    /// Places all panels, row by row from the top.
    fn place(&self, frame_width: f64) -> Layout<'f> {
        let plot_height = self.plot_height(frame_width);
        let gutters = self.gutters(frame_width);
        let mut panels = Vec::new();
        let mut top = self.top;
        for row in 0..self.rows {
            top += self.above(row);
            let mut left = 0.0;
            for (index, gutter) in self.row(row).zip(&gutters) {
                left += gutter;
                let frames = Area::new(left, top, frame_width, plot_height);
                panels.extend(self.place_plot(index, frames));
                left += frame_width + COLUMN_GAP;
            }
            top += plot_height + self.below(row) + ROW_GAP;
        }
        Layout {
            panels,
            bottom: top - ROW_GAP,
        }
    }

    /// Places a plot's panels below one another within `frames`.
    fn place_plot(&self, index: usize, frames: Area) -> Vec<Placed<'f>> {
        let plot = &self.figure.plots[index];
        let heights = self.heights(index, frames.height);
        let mut placed = Vec::new();
        let mut top = frames.top;
        for (number, (panel, height)) in plot.panels.iter().zip(heights).enumerate() {
            placed.push(Placed {
                panel,
                title: if number == 0 { &plot.title } else { "" },
                frame: Area::new(frames.left, top, frames.width, height),
                x: self.x_side(index, number, frames.width),
                y: self.y_side(index, number, height),
                font_size_pt: SMALL_PT,
            });
            top += height + PANEL_GAP;
        }
        placed
    }
}

/// Returns the width of the widest tick label, relative to the font size.
fn widest(ticks: &[Tick]) -> f64 {
    ticks
        .iter()
        .filter_map(|tick| tick.label.as_deref())
        .map(width)
        .fold(0.0, f64::max)
}

/// Returns ticks whose labels do not touch. How many ticks fit depends on the label widths, which
/// in turn depend on the ticks: two iterations suffice.
fn horizontal_ticks(axis: &Axis, range: Range, length_pt: f64) -> Vec<Tick> {
    let close = axis.ticks(range, length_pt, HORIZONTAL_GAP);
    let ticks = axis.ticks(range, length_pt, label_gap(&close));
    match &axis.names {
        // Named ticks have the same text at any spacing: a single iteration suffices.
        Some(_) => ticks,
        None => axis.ticks(range, length_pt, label_gap(&ticks)),
    }
}

/// Returns the distance between ticks \[pt\] at which these labels do not touch.
fn label_gap(ticks: &[Tick]) -> f64 {
    (SMALL_PT * widest(ticks) + NUMBER_SPACE).max(HORIZONTAL_GAP)
}
