//! Requirements over time: flight records with their corridors and the models' responses; without
//! records, a step or a doublet (M17.2).

use egui::{CollapsingHeader, Label, Panel, ScrollArea, Ui, Vec2, vec2};

use gdcm_method::requirements::{TestInput, TestInputShape};
use gdcm_model::units::number;
use gdcm_plot::figure::{Figure, OverTime};
use gdcm_study::results::condition_answers::RecordHistory;
use gdcm_study::results::record_comparison::Trend;
use gdcm_words::time_histories::record_history_table;

use super::figures::figure_of;
use super::over_time::{over_time, record_job};
use super::requirement_limits::{decided, tolerances_ui};
use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::commands::form::FormCommand;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::plot::canvas::figure_legend_ui;
use crate::gui::plot::{FigureScene, FigureWords, figure_ui};
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::choice_ui;
use crate::gui::widgets::controls::{number_entry_ui, restore_panel_size};
use crate::gui::widgets::palette::Palette;
use crate::gui::widgets::tables::{TableLook, table_grid_ui};

/// Least size of a plot \[pt\].
const LEAST_PLOT: Vec2 = vec2(220.0, 96.0);
/// Least size of a record with the difference from flight below it \[pt\].
const LEAST_RECORD: Vec2 = vec2(260.0, 190.0);
/// Initial share of the height taken by the table.
const TABLE_PART: f32 = 0.32;

/// Draws the flown record, or the test input, and the models' responses.
pub fn histories_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    subject_ui(ui, state, palette, commands);
    let title = CollapsingHeader::new("Tolerances").id_salt("edited tolerances");
    title.show(ui, |ui| tolerances_ui(ui, state, palette, commands));
    let found = match over_time(state) {
        Some(Ok(found)) => found,
        Some(Err(why)) => return drop(ui.label(palette.small_warning(why))),
        None => return drop(ui.label(palette.dim(state.results.absence()))),
    };
    if let OverTime::Record(history, _) = &found {
        restore_panel_size(ui, "tolerances");
        let size = TABLE_PART * ui.available_height();
        let panel = Panel::bottom("tolerances")
            .resizable(true)
            .default_size(size)
            .min_size(60.0);
        panel.show(ui, |ui| shares_ui(ui, state, history, palette, commands));
    }
    let figure: Figure = figure_of(state, View::Requirements).unwrap_or_default();
    ui.add(Label::new(palette.small(&figure.caption)).wrap());
    figure_legend_ui(ui, &figure, palette);
    let mut view = state
        .display
        .figures
        .remove(&View::Requirements)
        .unwrap_or_default();
    view.set_subject(&figure.title);
    let accented = match &found {
        OverTime::Test(_) => Some(1 + state.display.selection.pair.output),
        OverTime::Record(..) => None,
    };
    let least = if accented.is_some() {
        LEAST_PLOT
    } else {
        LEAST_RECORD
    };
    let words = HistoryWords(&figure);
    let scene = FigureScene::new(
        "requirements in time",
        &figure,
        least,
        "There is nothing to show",
        &words,
    );
    let scene = FigureScene {
        zooms: true,
        accented,
        ..scene
    };
    figure_ui(ui, &scene, &mut view, palette);
    state.display.figures.insert(View::Requirements, view);
}

/// Draws the selection of a record of the condition, or of a test input.
fn subject_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let records = state.records.conditions.get(&state.condition().id());
    let rows = records.into_iter().flat_map(|records| records.used_rows());
    let mut choices: Vec<(Option<usize>, &str, &str)> = rows
        .map(|(index, row)| {
            (
                Some(index),
                row.table.name.as_str(),
                "A flight record of this condition",
            )
        })
        .collect();
    if choices.is_empty() {
        let words = match &state.records.reading {
            Some(reading) => format!("reading {} …", reading),
            None => "No flight record of this condition is used (view Records): a test input in its place.".to_owned(),
        };
        ui.label(palette.small(words));
    } else {
        choices.push((
            None,
            "test input",
            "A step or a doublet of the input in focus, from rest",
        ));
        let shown = records
            .map(|records| records.chosen)
            .filter(|_| !state.display.judging.shows_test);
        let mut chosen = shown;
        choice_ui(ui, "What models answer to", &mut chosen, &choices);
        if chosen != shown {
            commands.push(DisplayCommand::ShowTest(chosen.is_none()).into());
            commands.extend(chosen.map(|index| RecordsCommand::Choose(index).into()));
        }
    }
    if record_job(state).is_none() {
        test_ui(ui, state, palette, commands);
    }
}

/// Draws the share of time inside the corridor and the largest excess of every quantity and model.
fn shares_ui(
    ui: &mut Ui,
    state: &mut State,
    history: &RecordHistory,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let table = record_history_table(history);
    let is_outside = |row: usize| table.rows[row][5] != "none";
    let color = |row: usize, column: usize| match column {
        4 | 5 => Some(if is_outside(row) {
            palette.warning
        } else {
            palette.good
        }),
        7 if table.rows[row][7] == Trend::Opposite.name() => Some(palette.warning),
        _ => None,
    };
    let look = TableLook {
        color: &color,
        ..TableLook::PLAIN
    };
    ScrollArea::vertical()
        .id_salt("tolerances")
        .auto_shrink(false)
        .show(ui, |ui| {
            ui.label(palette.small(&table.title));
            let mut sorting = state.display.judging.requirements_sorting;
            table_grid_ui(ui, &table, &mut sorting[0], &look, palette, commands);
            state.display.judging.requirements_sorting = sorting;
        });
}

/// Draws shape, size and duration of the test input.
fn test_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let test = state.study.requirements.test;
    let input = &state.dataset().inputs()[state.display.selection.pair.input];
    let decide =
        |what: &'static str, test: TestInput, commands: &mut Vec<Command>| match test.checked() {
            Ok(test) => commands.push(decided(state, what, |settings| settings.test = test)),
            Err(why) => commands.push(FormCommand::Refuse(why.to_string()).into()),
        };
    ui.horizontal_wrapped(|ui| {
        let mut shape = test.shape;
        let choices = [
            (
                TestInputShape::Step,
                "step",
                "Held for the whole of its duration, then back to trim",
            ),
            (
                TestInputShape::Doublet,
                "doublet",
                "The first half of its duration to one side, the second to the other",
            ),
        ];
        choice_ui(ui, "Course of the test input", &mut shape, &choices);
        if shape != test.shape {
            decide(
                "course of the test input",
                TestInput { shape, ..test },
                commands,
            );
        }
        ui.label(palette.small(format!("of {}, the input in focus, by", input.name)));
        let size = number_entry_ui(
            ui,
            "Size of the test input",
            &number(test.size),
            "",
            56.0,
            commands,
        );
        if let Some(size) = size.flatten() {
            decide(
                "size of the test input",
                TestInput { size, ..test },
                commands,
            );
        }
        ui.label(palette.small(format!("{} for", input.unit)));
        let duration = number_entry_ui(
            ui,
            "Duration of the test input",
            &number(test.duration_s),
            "",
            56.0,
            commands,
        );
        if let Some(duration_s) = duration.flatten() {
            decide(
                "duration of the test input",
                TestInput { duration_s, ..test },
                commands,
            );
        }
        ui.label(palette.small("s"));
    });
}

/// Descriptions of the plots over time.
struct HistoryWords<'a>(&'a Figure);

impl FigureWords for HistoryWords<'_> {
    fn plot(&self, plot: usize) -> String {
        format!("{} over time", self.0.plots[plot].title)
    }
}
