//! Requirements over time: flight records with their corridors and the models' responses; without
//! records, a step or a doublet (M17.2).

use egui::{CollapsingHeader, Color32, Label, Panel, ScrollArea, Ui, Vec2, vec2};

use gdcm_method::requirements::{TestInput, TestInputShape};
use gdcm_model::units::number;
use gdcm_plot::figure::Figure;
use gdcm_plot::figure::request::OverTime;
use gdcm_study::decisions::requirement_settings::RequirementPart;
use gdcm_study::results::record_comparison::Trend;
use gdcm_words::Table;
use gdcm_words::time_histories::record_history_table;

use super::figures::figure_of;
use super::requirement_history_jobs::{over_time, record_job};
use super::requirement_limits::{requirement_edit, tolerances_ui};
use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::commands::form::FormCommand;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::plot::figure_legend::figure_legend_ui;
use crate::gui::plot::{FigureScene, FigureWords, figure_ui};
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::choice_ui;
use crate::gui::widgets::number_entry::number_entry_ui;
use crate::gui::widgets::palette::Palette;
use crate::gui::widgets::panel_layout::restore_panel_size;
use crate::gui::widgets::tables::{Sorting, TableLook, table_grid_ui};
use crate::message::Message;

/// Minimum plot size \[pt\].
const LEAST_PLOT: Vec2 = vec2(220.0, 96.0);
/// Minimum size of a record's plot, with the difference from flight below it \[pt\].
const LEAST_RECORD: Vec2 = vec2(260.0, 190.0);
/// Initial table height, as a share of the view's height.
const TABLE_PART: f32 = 0.32;

/// Draws the flight record or the test input, and the models' responses.
pub fn histories_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    subject_ui(ui, state, palette, commands);
    let title = CollapsingHeader::new("Tolerances").id_salt("edited tolerances");
    title.show(ui, |ui| tolerances_ui(ui, state, palette, commands));
    let responses = match over_time(state) {
        Some(Ok(responses)) => responses,
        Some(Err(why)) => {
            ui.label(palette.small_warning(why));
            return;
        }
        None => {
            ui.label(palette.dim(state.results.absence()));
            return;
        }
    };
    if let OverTime::Record(history, _) = &responses {
        let table = record_history_table(history);
        shares_panel_ui(ui, state, &table, palette, commands);
    }
    plots_ui(ui, state, &responses, palette);
}

/// Draws the table of the shares of time inside the corridor, in a panel below the plots.
fn shares_panel_ui(
    ui: &mut Ui,
    state: &mut State,
    table: &Table,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    restore_panel_size(ui, "tolerances");
    let size = TABLE_PART * ui.available_height();
    let panel = Panel::bottom("tolerances")
        .resizable(true)
        .default_size(size)
        .min_size(60.0);
    panel.show(ui, |ui| {
        let shares = SharesTable { table, palette };
        let sorting = &mut state.display.judging.requirements_sorting[0];
        shares.ui(ui, sorting, commands);
    });
}

/// Draws the responses over time below their caption and legend.
fn plots_ui(ui: &mut Ui, state: &mut State, responses: &OverTime, palette: &Palette) {
    let figure: Figure = figure_of(state, View::Requirements).unwrap_or_default();
    ui.add(Label::new(palette.small(&figure.caption)).wrap());
    figure_legend_ui(ui, &figure, palette);
    // The scene borrows the state, so the view is taken out of it while the figure is drawn.
    let mut view = state
        .display
        .figures
        .remove(&View::Requirements)
        .unwrap_or_default();
    view.set_subject(&figure.title);
    let words = HistoryWords(&figure);
    let mut scene = FigureScene {
        zooms: true,
        ..FigureScene::new(
            "requirements in time",
            &figure,
            LEAST_RECORD,
            "No response over time",
            &words,
        )
    };
    if let OverTime::Test(_) = responses {
        // `1 +`: the first plot shows the input.
        scene.accented = Some(1 + state.display.selection.pair.output);
        scene.least_plot_size = LEAST_PLOT;
    }
    figure_ui(ui, &scene, &mut view, palette);
    state.display.figures.insert(View::Requirements, view);
}

/// Draws the selector between the condition's records and a test input.
fn subject_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let records = state.records.conditions.get(&state.condition().id());
    let mut choices: Vec<(Option<usize>, &str, &str)> = Vec::new();
    if let Some(records) = records {
        for (index, row) in records.used_rows() {
            let name = row.table.name.as_str();
            choices.push((Some(index), name, "A flight record of this condition"));
        }
    }
    if choices.is_empty() {
        let words = match &state.records.reading {
            Some(reading) => format!("reading {reading} …"),
            None => "No flight record of this condition is in use (view Records): responses to a \
                test input are shown instead"
                .to_owned(),
        };
        ui.label(palette.small(words));
    } else {
        choices.push((
            None,
            "test input",
            "A step or a doublet of the input in focus, from rest",
        ));
        let mut shown = None;
        if !state.display.judging.shows_test {
            shown = records.map(|records| records.chosen);
        }
        let mut chosen = shown;
        choice_ui(ui, "Record or test input", &mut chosen, &choices);
        if chosen != shown {
            commands.push(DisplayCommand::ShowTest(chosen.is_none()).into());
            if let Some(index) = chosen {
                commands.push(RecordsCommand::Choose(index).into());
            }
        }
    }
    if record_job(state).is_none() {
        test_ui(ui, state, palette, commands);
    }
}

/// Indices of the columns with the share of time inside the corridor, the largest excess, and the
/// trend.
const SHARE: usize = 4;
const EXCESS: usize = 5;
const TREND: usize = 7;

/// Table with the share of time inside the corridor and the largest excess, for every quantity and
/// model.
struct SharesTable<'a> {
    table: &'a Table,
    palette: &'a Palette,
}

impl SharesTable<'_> {
    fn ui(&self, ui: &mut Ui, sorting: &mut Sorting, commands: &mut Vec<Command>) {
        let look = TableLook {
            color: &|row, column| self.color(row, column),
            ..TableLook::PLAIN
        };
        ScrollArea::vertical()
            .id_salt("tolerances")
            .auto_shrink(false)
            .show(ui, |ui| {
                ui.label(self.palette.small(&self.table.title));
                table_grid_ui(ui, self.table, sorting, &look, self.palette, commands);
            });
    }

    /// Returns a cell's colour: the warning colour outside the corridor, and for an opposite trend.
    fn color(&self, row: usize, column: usize) -> Option<Color32> {
        let cells = &self.table.rows[row];
        match column {
            SHARE | EXCESS if cells[EXCESS] == "none" => Some(self.palette.good),
            SHARE | EXCESS => Some(self.palette.warning),
            TREND if cells[TREND] == Trend::Opposite.name() => Some(self.palette.warning),
            _ => None,
        }
    }
}

/// Draws the fields of the test input: shape, size and duration.
fn test_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let test = state.study.requirements.test;
    let input = &state.dataset().inputs()[state.display.selection.pair.input];
    ui.horizontal_wrapped(|ui| {
        let mut shape = test.shape;
        let choices = [
            (
                TestInputShape::Step,
                "step",
                "Constant for its whole duration, then back to trim",
            ),
            (
                TestInputShape::Doublet,
                "doublet",
                "To one side for the first half of its duration, to the other side for the second \
                half",
            ),
        ];
        choice_ui(ui, "Shape of the test input", &mut shape, &choices);
        if shape != test.shape {
            let changed = TestInput { shape, ..test };
            commands.push(set_test_input(state, RequirementPart::TestShape, changed));
        }
        ui.label(palette.small(format!("of {}, the input in focus, by", input.name)));
        let size = test_number_ui(ui, "Size of the test input", test.size, commands);
        if let Some(size) = size {
            let changed = TestInput { size, ..test };
            commands.push(set_test_input(state, RequirementPart::TestSize, changed));
        }
        ui.label(palette.small(format!("{} for", input.unit)));
        let duration_s =
            test_number_ui(ui, "Duration of the test input", test.duration_s, commands);
        if let Some(duration_s) = duration_s {
            let changed = TestInput { duration_s, ..test };
            commands.push(set_test_input(
                state,
                RequirementPart::TestDuration,
                changed,
            ));
        }
        ui.label(palette.small("s"));
    });
}

/// Draws a number field; returns the typed number.
fn test_number_ui(ui: &mut Ui, name: &str, value: f64, commands: &mut Vec<Command>) -> Option<f64> {
    number_entry_ui(ui, name, &number(value), "", 56.0, commands)?
}

/// Returns the command that changes the test input, or that reports why it is refused.
fn set_test_input(state: &State, part: RequirementPart, test: TestInput) -> Command {
    match test.checked() {
        Ok(test) => requirement_edit(state, part, |settings| settings.test = test),
        Err(why) => FormCommand::Refuse(Message::new("wrong-test-input", why.to_string())).into(),
    }
}

/// Accessible names of the plots over time.
struct HistoryWords<'a>(&'a Figure);

impl FigureWords for HistoryWords<'_> {
    fn plot_name(&self, plot: usize) -> String {
        format!("{} over time", self.0.plots[plot].title)
    }
}
