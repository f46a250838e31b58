//! Identified responses on the constraint matrix's grid: standard deviation in magnitude and phase,
//! and partial coherence as a bar. The constraint matrix, elsewhere in the window, has a row for
//! each output and a column for each input.

use egui::{Align2, Color32, Rect, Role, ScrollArea, Sense, Stroke, StrokeKind, Ui, pos2, vec2};

use gdcm_model::dataset::Pair;
use gdcm_model::number_format::decimals;
use gdcm_model::statistics::median;
use gdcm_sysid::identification::Identification;

use super::page::Page;
use super::value_range::value_text;
use crate::gui::commands::command::Command;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::widgets::controls::{Asks, named_switch};
use crate::gui::widgets::elision::text_width;
use crate::gui::widgets::painted_text::{AT_RIGHT_END, painted_text};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, body, medium, small};

/// Heading height \[pt\].
const HEADING: f32 = 20.0;
/// Height of the row with input names \[pt\].
const INPUT_NAMES: f32 = 16.0;
/// Width of the column with output names \[pt\].
const OUTPUT_NAMES: f32 = 28.0;
/// Minimum cell height \[pt\].
const LEAST_CELL_HEIGHT: f32 = 19.0;
/// Maximum cell height \[pt\].
const MOST_CELL_HEIGHT: f32 = 27.0;
/// Minimum cell width \[pt\].
const LEAST_CELL_WIDTH: f32 = 58.0;
/// Count of rows that stay visible in a low column; the others scroll.
const LEAST_VISIBLE_ROWS: f32 = 3.0;
/// Gap between cells \[pt\].
const GAP: f32 = 3.0;
/// Notes that explain the cells; the first note that fits is shown.
const NOTES: [&str; 2] = ["± 1 σ, dB and deg; bar: coherence", "± 1 σ, dB and deg"];
/// Thickness of the coherence bar \[pt\].
const BAR: f32 = 2.5;

/// Values for an identified response.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct PairFigures {
    /// Standard deviation of the magnitude in the middle of the band \[dB\].
    sd_db: Option<f64>,
    /// Standard deviation of the phase in the middle of the band \[deg\].
    sd_deg: Option<f64>,
    /// Median of the partial coherence.
    coherence: Option<f64>,
    /// Whether the standard deviation of the magnitude in mid-band is at most 3 dB.
    is_identified: bool,
}

impl PairFigures {
    fn new(identification: &Identification, pair: Pair) -> Self {
        let mut figures = Self {
            is_identified: !identification
                .not_identified
                .contains(&(pair.output, pair.input)),
            ..Self::default()
        };
        if let Some(bands) = &identification.refined.bands {
            let middle = bands.omega().len() / 2;
            figures.sd_db = bands.sd_db()[pair].get(middle).copied();
            figures.sd_deg = bands.sd_deg()[pair].get(middle).copied();
        }
        let points = &identification.measured.points;
        figures.coherence = median_of(
            points
                .iter()
                .map(|point| point.partial_coherence[(pair.output, pair.input)]),
        );
        figures
    }
}

/// Returns the median of the finite values.
fn median_of(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut finite: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    if finite.is_empty() {
        return None;
    }
    Some(median(&mut finite))
}

/// Draws the grid within `available_height` \[pt\]; a click on a cell focuses its response. Cells
/// share height and width, within the limits of their size; a grid that does not fit scrolls.
pub(super) fn identified_grid_ui(
    ui: &mut Ui,
    page: Page<'_>,
    available_height: f32,
    commands: &mut Vec<Command>,
) {
    let palette = page.palette;
    let width = ui.available_width();
    let (heading, _) = ui.allocate_exact_size(vec2(width, HEADING), Sense::hover());
    let title = "Identified responses";
    let shown = painted_text(ui, heading, 0.0, title, medium(BODY_SIZE), palette.text);
    let note_room = heading.right() - shown.right() - 8.0;
    let note = NOTES
        .into_iter()
        .find(|note| text_width(ui, note, small()) <= note_room);
    if let Some(note) = note {
        painted_text(ui, heading, AT_RIGHT_END, note, small(), palette.dim_text);
    }
    let dataset = page.state.dataset();
    let outputs = dataset.outputs().len();
    let rows = outputs.max(1) as f32;
    let cells_height = available_height - HEADING - INPUT_NAMES;
    let cell_height = (cells_height / rows - GAP).clamp(LEAST_CELL_HEIGHT, MOST_CELL_HEIGHT);
    let grid_height = INPUT_NAMES + rows * (cell_height + GAP);
    let least_height = INPUT_NAMES + LEAST_VISIBLE_ROWS * (LEAST_CELL_HEIGHT + GAP);
    let visible_height = grid_height.min((cells_height + INPUT_NAMES).max(least_height));
    let inputs = dataset.inputs().len().max(1) as f32;
    let cell_width = ((width - OUTPUT_NAMES) / inputs - GAP).max(LEAST_CELL_WIDTH);
    ScrollArea::both()
        .id_salt("identified responses")
        .max_height(visible_height)
        .show(ui, |ui| {
            let grid_width = OUTPUT_NAMES + inputs * (cell_width + GAP) - GAP;
            let size = vec2(grid_width, grid_height);
            let (area, _) = ui.allocate_exact_size(size, Sense::hover());
            let grid = Grid {
                page,
                area,
                cell: vec2(cell_width, cell_height),
            };
            grid.show(ui, commands);
        });
}

struct Grid<'a> {
    page: Page<'a>,
    area: Rect,
    /// Cell size \[pt\].
    cell: egui::Vec2,
}

impl Grid<'_> {
    fn show(&self, ui: &Ui, commands: &mut Vec<Command>) {
        let Page { state, palette, .. } = self.page;
        let dataset = state.dataset();
        let focus = state.display.selection.pair;
        for (input, channel) in dataset.inputs().iter().enumerate() {
            let place = self.place(Pair { output: 0, input });
            let at = pos2(place.center().x, self.area.top() + 0.5 * INPUT_NAMES);
            let color = name_color(input == focus.input, palette);
            ui.painter()
                .text(at, Align2::CENTER_CENTER, &channel.name, small(), color);
        }
        for (output, channel) in dataset.outputs().iter().enumerate() {
            let place = self.place(Pair { output, input: 0 });
            let at = pos2(place.left() - 7.0, place.center().y);
            let color = name_color(output == focus.output, palette);
            ui.painter()
                .text(at, Align2::RIGHT_CENTER, &channel.name, small(), color);
            for input in 0..dataset.inputs().len() {
                self.cell_ui(ui, Pair { output, input }, commands);
            }
        }
    }

    fn place(&self, pair: Pair) -> Rect {
        let corner = pos2(
            self.area.left() + OUTPUT_NAMES + pair.input as f32 * (self.cell.x + GAP),
            self.area.top() + INPUT_NAMES + pair.output as f32 * (self.cell.y + GAP),
        );
        Rect::from_min_size(corner, self.cell)
    }

    fn cell_ui(&self, ui: &Ui, pair: Pair, commands: &mut Vec<Command>) {
        let Page {
            state,
            records,
            palette,
        } = self.page;
        let place = self.place(pair);
        let is_focus = state.display.selection.pair == pair;
        let name = state.dataset().pair_name(pair);
        let id = ui.scope_id().with(("identified", pair));
        let response = ui.interact(place, id, Sense::click());
        let response = named_switch(response, Role::Button, is_focus, format!("Response {name}"));
        let fill = if response.hovered() || response.has_focus() {
            palette.raised
        } else {
            Color32::TRANSPARENT
        };
        let outline = if is_focus {
            Stroke::new(2.0, palette.accent)
        } else {
            Stroke::new(1.0, palette.line)
        };
        ui.painter()
            .rect(place, 4.0, fill, outline, StrokeKind::Inside);
        let mut hint = name;
        if let Some(identification) = records.identification() {
            let figures = PairFigures::new(identification, pair);
            let is_outdated = self.page.is_outdated();
            self.paint_figures(ui, place, figures, is_outdated);
            hint = format!("{hint}: {}", figures.words());
        }
        response
            .on_hover_text(hint)
            .asks(SelectionCommand::FocusPair(pair), commands);
    }

    fn paint_figures(&self, ui: &Ui, place: Rect, figures: PairFigures, is_outdated: bool) {
        let palette = self.page.palette;
        let opacity = if is_outdated { 0.5 } else { 1.0 };
        let color = if figures.is_identified {
            palette.text
        } else {
            palette.warning
        };
        let color = color.gamma_multiply(opacity);
        let dim = if figures.is_identified {
            palette.dim_text.gamma_multiply(opacity)
        } else {
            color
        };
        let mut line = place.shrink2(vec2(6.0, 0.0));
        line.max.y -= 3.0;
        painted_text(ui, line, 0.0, &value_text(figures.sd_db, 1), body(), color);
        let phase = match figures.sd_deg {
            Some(deg) => format!("{}°", decimals(deg, 0)),
            None => "–".to_owned(),
        };
        painted_text(ui, line, AT_RIGHT_END, &phase, small(), dim);
        let room = place.width() - 8.0;
        let track = Rect::from_min_size(
            pos2(place.left() + 4.0, place.bottom() - 2.0 - BAR),
            vec2(room, BAR),
        );
        ui.painter()
            .rect_filled(track, 1.0, palette.line.gamma_multiply(opacity));
        if let Some(coherence) = figures.coherence {
            let share = coherence.clamp(0.0, 1.0) as f32;
            let bar = Rect::from_min_size(track.min, vec2(share * room, BAR));
            let fill = if figures.is_identified {
                palette.quiet_mark
            } else {
                palette.warning
            };
            ui.painter()
                .rect_filled(bar, 1.0, fill.gamma_multiply(opacity));
        }
    }
}

impl PairFigures {
    /// Describes the values: "± 0.50 dB and ± 3.0° (1 σ) in the middle of the band, …".
    fn words(&self) -> String {
        let mut words = format!(
            "± {} dB and ± {}° (1 σ) in the middle of the band, median partial coherence {}",
            value_text(self.sd_db, 2),
            value_text(self.sd_deg, 1),
            value_text(self.coherence, 2)
        );
        if !self.is_identified {
            words.push_str("; not identified: more than ± 3 dB");
        }
        words
    }
}

fn name_color(is_focus: bool, palette: &Palette) -> Color32 {
    if is_focus {
        palette.text
    } else {
        palette.dim_text
    }
}
