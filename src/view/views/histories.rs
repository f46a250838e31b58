//! Requirements in time: what the models of the condition shown answer to a step or a doublet of the input in focus (M17.2).

use std::sync::Arc;

use egui::{Label, Ui, Vec2, vec2};
use gdcm_core::requirements::{TestInput, TestInputShape};
use gdcm_core::study::{Edit, RequirementSettings, TestAnswers, TestAnswersJob};
use gdcm_core::units::number;
use gdcm_files::figure::{Figure, FigureKind, MarkId};

use super::{RequirementsPage, View};
use crate::view::command::Command;
use crate::view::controls::number_entry_ui;
use crate::view::figures::figure_of;
use crate::view::palette::Palette;
use crate::view::plot::{FigureScene, FigureWords, figure_legend_ui, figure_ui};
use crate::view::settings_panel::choice_ui;
use crate::view::state::State;

/// A plot is never smaller \[pt\].
const LEAST_PLOT: Vec2 = vec2(220.0, 96.0);

/// The job of the answers to the test input; none until there is an analysis.
pub fn test_answers_job(state: &State) -> Option<TestAnswersJob> {
    let analysis = state.results.analysis.clone().filter(|_| state.analysis().is_some())?;
    Some(TestAnswersJob { analysis, condition: state.condition().id(), input: state.display.pair.input })
}

/// The answers to the test input, for a figure of them.
pub fn shown_test_answers(state: &State, kind: FigureKind) -> Option<Arc<TestAnswers>> {
    let is_shown = kind == FigureKind::Requirements && state.display.requirements_page == RequirementsPage::Histories;
    state.test_answers().filter(|_| is_shown)?.as_ref().ok().cloned()
}

/// The test, and the answers of the models.
pub fn histories_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    test_ui(ui, state, palette, commands);
    let figure: Figure = match state.test_answers() {
        Some(Ok(_)) => figure_of(state, View::Requirements).unwrap_or_default(),
        Some(Err(why)) => return drop(ui.label(palette.small_warning(why))),
        None => return drop(ui.label(palette.dim(state.results.absence()))),
    };
    ui.add(Label::new(palette.small(&figure.caption)).wrap());
    figure_legend_ui(ui, &figure, palette);
    let mut view = state.display.figures.remove(&View::Requirements).unwrap_or_default();
    let scene = FigureScene {
        name: "requirements in time",
        figure: &figure,
        selected: None,
        highlighted: None,
        columns: &[],
        zooms: true,
        is_compact: false,
        accented: Some(1 + state.display.pair.output),
        least: LEAST_PLOT,
        message: "There is nothing to show",
        words: (&HistoryWords { figure: &figure }, 0),
    };
    figure_ui(ui, &scene, &mut view, palette);
    state.display.figures.insert(View::Requirements, view);
}

/// Course, size and duration of the test input.
fn test_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let test = state.study.requirements.test;
    let input = &state.dataset().inputs()[state.display.pair.input];
    let decide = |what: &'static str, test: TestInput, commands: &mut Vec<Command>| match test.checked() {
        Ok(test) => {
            let settings = RequirementSettings { test, ..RequirementSettings::clone(&state.study.requirements) };
            commands.push(Edit::SetRequirements(what, Arc::new(settings)).into());
        }
        Err(why) => commands.push(Command::Refuse(why.to_string())),
    };
    ui.horizontal_wrapped(|ui| {
        let mut shape = test.shape;
        let choices = [
            (TestInputShape::Step, "step", "Held for the whole of its duration, then back to trim"),
            (TestInputShape::Doublet, "doublet", "The first half of its duration to one side, the second to the other"),
        ];
        choice_ui(ui, "Course of the test input", &mut shape, &choices);
        if shape != test.shape {
            decide("course of the test input", TestInput { shape, ..test }, commands);
        }
        ui.label(palette.small(format!("of {}, the input in focus, by", input.name)));
        let size = number_entry_ui(ui, "Size of the test input", &number(test.size), "", 56.0, commands);
        if let Some(size) = size.flatten() {
            decide("size of the test input", TestInput { size, ..test }, commands);
        }
        ui.label(palette.small(format!("{} for", input.unit)));
        let duration = number_entry_ui(ui, "Duration of the test input", &number(test.duration_s), "", 56.0, commands);
        if let Some(duration_s) = duration.flatten() {
            decide("duration of the test input", TestInput { duration_s, ..test }, commands);
        }
        ui.label(palette.small("s"));
    });
}

/// What the plots over time say.
struct HistoryWords<'a> {
    figure: &'a Figure,
}

impl FigureWords for HistoryWords<'_> {
    fn plot(&self, plot: usize) -> String {
        self.figure.plots.get(plot).map_or_else(String::new, |plot| format!("{} over time", plot.title))
    }

    fn pointed_ui(&self, _: &mut Ui, _: usize, _: &MarkId, _: [f64; 2]) {}
}
