//! The table of models, and the list of what is to be completed.

use std::cmp::Ordering;

use egui::{Align, Button, Label, Layout, RichText, Role, ScrollArea, Sense, Ui, WidgetInfo, vec2};

use crate::view::command::Command;
use crate::view::palette::{Palette, SMALL_SIZE};
use gdcm_core::assembly::Part;
use gdcm_core::units::number;

use super::assembly_state::{AssemblingCommand, AssemblyState};
use super::details::columns_ui;

const ROW_HEIGHT: f32 = 20.0;

/// A column of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    /// Number of the condition.
    Condition,
    /// The role.
    Role,
    /// The name.
    Name,
    /// Airspeed.
    Airspeed,
    /// Altitude, class or figure.
    Altitude,
    /// Weight, class or mass.
    Weight,
    /// Offsets of the trim.
    Trim,
    /// What the model is: states, channels, frequencies.
    Model,
    /// File and variable.
    File,
}

impl Column {
    const ALL: [Self; 9] = [
        Self::Condition,
        Self::Role,
        Self::Name,
        Self::Airspeed,
        Self::Altitude,
        Self::Weight,
        Self::Trim,
        Self::Model,
        Self::File,
    ];

    fn heading(self) -> &'static str {
        match self {
            Self::Condition => "condition",
            Self::Role => "role",
            Self::Name => "name",
            Self::Airspeed => "airspeed",
            Self::Altitude => "altitude",
            Self::Weight => "weight",
            Self::Trim => "trim",
            Self::Model => "model",
            Self::File => "file",
        }
    }

    /// Part of the width that it gets.
    fn share(self) -> f32 {
        match self {
            Self::Condition | Self::Altitude | Self::Weight => 0.07,
            Self::Role | Self::Airspeed => 0.08,
            Self::Name | Self::Trim => 0.16,
            Self::Model => 0.13,
            Self::File => 0.18,
        }
    }

    /// The order of two models by this column; figures by value.
    pub(super) fn compare(self, a: &Part, b: &Part) -> Ordering {
        let figure = |a: Option<f64>, b: Option<f64>| a.unwrap_or(f64::INFINITY).total_cmp(&b.unwrap_or(f64::INFINITY));
        match self {
            Self::Condition => a.row.condition.cmp(&b.row.condition),
            Self::Role => a.row.role.cmp(&b.row.role),
            Self::Airspeed => figure(a.row.airspeed_kt, b.row.airspeed_kt),
            _ => cell_text(self, a).cmp(&cell_text(self, b)),
        }
    }
}

/// What stands in a cell; a question mark where it is still to be said.
pub fn cell_text(column: Column, part: &Part) -> String {
    let row = &part.row;
    let asked = |text: Option<String>| text.unwrap_or_else(|| "?".to_owned());
    match column {
        Column::Condition => asked(row.condition.map(|condition| condition.to_string())),
        Column::Role if row.left_out => "left out".to_owned(),
        Column::Role => asked(row.role.map(|role| role.word().to_owned())),
        Column::Name => row.name.clone(),
        Column::Airspeed => asked(row.airspeed_words()),
        Column::Altitude => row.altitude_words(),
        Column::Weight => row.weight_words(),
        Column::Trim => trim_text(part),
        Column::Model => part.found.words(),
        Column::File => part.found.key(),
    }
}

/// "roll_deg +5, airspeed_kt -10".
fn trim_text(part: &Part) -> String {
    let offset = |(coordinate, by): (&String, &f64)| {
        let sign = if *by > 0.0 { "+" } else { "" };
        format!("{coordinate} {sign}{}", number(*by))
    };
    part.row.perturbation.iter().map(offset).collect::<Vec<_>>().join(", ")
}

/// Draws the table; only the lines in view are laid out.
pub(super) fn table_ui(ui: &mut Ui, bench: &AssemblyState, palette: &Palette, commands: &mut Vec<Command>) {
    let width = ui.available_width() - 12.0;
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 0.0;
        for column in Column::ALL {
            heading_ui(ui, bench, (column, width * column.share()), palette, commands);
        }
    });
    let order = bench.order();
    let troubled: Vec<usize> = bench.assembly().problems().iter().filter_map(|problem| problem.part).collect();
    let area = ScrollArea::vertical().id_salt("models that are put together").auto_shrink(false);
    area.show_rows(ui, ROW_HEIGHT, order.len(), |ui, rows| {
        ui.spacing_mut().item_spacing.y = 0.0;
        for index in order[rows].iter().copied() {
            row_ui(ui, bench, (index, width, troubled.contains(&index)), palette, commands);
        }
    });
}

fn heading_ui(
    ui: &mut Ui,
    bench: &AssemblyState,
    (column, width): (Column, f32),
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let mark = match bench.sorting {
        Some((sorted, falls)) if sorted == column => {
            if falls {
                " ▼"
            } else {
                " ▲"
            }
        }
        _ => "",
    };
    let text = RichText::new(format!("{}{mark}", column.heading())).size(SMALL_SIZE).color(palette.dim_text);
    let size = vec2(width, ROW_HEIGHT);
    let layout = Layout::left_to_right(Align::Center);
    let button = ui.allocate_ui_with_layout(size, layout, |ui| {
        ui.set_min_size(size);
        ui.add(Button::new(text).frame(false))
    });
    let name = format!("Sort models by {}", column.heading());
    button.inner.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
    if button.inner.on_hover_text(&name).clicked() {
        commands.push(AssemblingCommand::Sort(column).into());
    }
}

fn row_ui(
    ui: &mut Ui,
    bench: &AssemblyState,
    (index, width, is_troubled): (usize, f32, bool),
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let part = &bench.assembly().parts()[index];
    let (rect, response) = ui.allocate_exact_size(vec2(width, ROW_HEIGHT), Sense::click());
    let key = part.found.key();
    response.widget_info(|| WidgetInfo::selected(Role::Row, true, bench.selected == index, format!("Model {key}")));
    if bench.selected == index {
        ui.painter().rect_filled(rect, 2.0, palette.selected);
    } else if response.contains_pointer() {
        ui.painter().rect_filled(rect, 2.0, palette.raised);
    }
    let mut left = rect.left();
    for column in Column::ALL {
        let room = width * column.share();
        let text = cell_text(column, part);
        let color = match () {
            () if text == "?" => palette.warning,
            () if part.row.left_out => palette.rejected,
            () if column == Column::File && is_troubled => palette.warning,
            () => palette.text,
        };
        let text = if column == Column::File && is_troubled { format!("⚠ {text}") } else { text };
        let font = egui::FontId::proportional(SMALL_SIZE);
        let mut job = egui::text::LayoutJob::single_section(text, egui::TextFormat::simple(font, color));
        job.wrap = egui::text::TextWrapping::truncate_at_width(room - 6.0);
        let galley = ui.painter().layout_job(job);
        let place = egui::pos2(left + 3.0, rect.center().y - 0.5 * galley.size().y);
        ui.painter().galley(place, galley, color);
        left += room;
    }
    if response.clicked() {
        commands.push(AssemblingCommand::Select(index).into());
    }
}

/// More lines than this are counted.
const MOST_LINES: usize = 200;
/// Tables of which no model came whose columns can be said here; the others follow as these are read.
const MOST_TABLES: usize = 5;

/// A line for each problem; a click shows its model.
pub(super) fn problems_ui(ui: &mut Ui, bench: &AssemblyState, palette: &Palette, commands: &mut Vec<Command>) {
    let assembly = bench.assembly();
    let line = |text: String, color| RichText::new(text).size(SMALL_SIZE).color(color);
    let problems = assembly.told();
    let heading = match problems.len() {
        0 => "Nothing is missing: the dataset can be made".to_owned(),
        1 => "1 thing is still to be said".to_owned(),
        count => format!("{count} things are still to be said"),
    };
    ui.label(RichText::new(heading).strong().color(if problems.is_empty() { palette.good } else { palette.warning }));
    ScrollArea::vertical().id_salt("problems").auto_shrink(false).show(ui, |ui| {
        for (part, words) in problems.iter().take(MOST_LINES) {
            let text = line(words.clone(), palette.text);
            let response = ui.add(Label::new(text).sense(Sense::click()).wrap());
            if let Some(part) = part.filter(|_| response.clicked()) {
                commands.push(AssemblingCommand::Select(part).into());
            }
        }
        if problems.len() > MOST_LINES {
            ui.label(line(format!("and {} more", problems.len() - MOST_LINES), palette.dim_text));
        }
        let not_taken = bench.faults.iter().map(|fault| (format!("not taken: {fault}"), palette.warning));
        let no_models = bench.passed_over.iter().map(|words| (format!("no model: {words}"), palette.dim_text));
        for (text, color) in not_taken.chain(no_models).take(MOST_LINES) {
            ui.add(Label::new(line(text, color)).wrap());
        }
        let parts = assembly.parts();
        let unread = bench.tables.keys().filter(|file| !parts.iter().any(|part| part.found.file() == file.as_str()));
        for file in unread.take(MOST_TABLES) {
            columns_ui(ui, bench, file, palette, commands);
        }
    });
}
