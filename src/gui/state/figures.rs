//! Figures of the views for paper, and the button that copies or saves them.

use egui::containers::menu::MenuButton;
use egui::{Button, Role, Ui};

use gdcm_plot::figure::bode::BodeOptions;
use gdcm_plot::figure::{Figure, FigureFormat, FigureKind, FigureRequest, all_channels};
use gdcm_words::Table;

use super::window_state::State;
use crate::gui::commands::command::Command;
use crate::gui::plot::BodeView;
use crate::gui::plot::bode::PANES;
use crate::gui::views::couplings::shown_couplings;
use crate::gui::views::frequency::{bode_options, condition_source};
use crate::gui::views::histories::shown_over_time;
use crate::gui::views::requirements::{requirement_tables, shown_requirements};
use crate::gui::views::{View, ViewFigure, assessment_choice};
use crate::gui::widgets::controls::named;

/// Returns the figure of a view; `None` until its results are available.
pub fn figure_of(state: &State, view: View) -> Option<Figure> {
    let bars = !state.display.hide_bars || view.figure().is_some_and(FigureKind::needs_bars);
    let with_bars = if bars {
        state.analysis_with_bars()
    } else {
        state.analysis().cloned()
    };
    // The live answer does not depend on the inputs of the requirements and may be older than
    // these.
    let with_bars = with_bars.map(|analysis| analysis.asked_with(&state.study.requirements));
    let analysis = with_bars.as_ref();
    let source = condition_source(state);
    request(state, view)?.figure(analysis, source.as_ref())
}

/// Returns a file name for a view's figure: `bode-10-LON-Q`.
pub fn figure_name(state: &State, view: View) -> String {
    let kind = view.figure();
    let mut parts: Vec<String> = kind.iter().map(|kind| kind.name().to_owned()).collect();
    if kind.is_some_and(FigureKind::is_of_condition) {
        parts.push(state.condition().id().to_string());
    }
    if matches!(view, View::Bode | View::Error | View::Across | View::Leads) {
        let (output, input) = state.dataset().channel_names(state.display.pair);
        parts.extend([input, output]);
    }
    let is_plain = |letter: char| letter.is_alphanumeric() || letter == '-';
    parts
        .join("-")
        .chars()
        .map(|letter| if is_plain(letter) { letter } else { '_' })
        .collect()
}

/// Returns the views that have a figure.
pub fn views_with_figure() -> impl Iterator<Item = View> {
    View::ALL.into_iter().filter(|view| view.figure().is_some())
}

/// Returns the figure request of a view, the same as of the command `gdcm figure`.
pub(crate) fn request(state: &State, view: View) -> Option<FigureRequest> {
    let ViewFigure { kind, pairs } = view.kind().figure?;
    let display = &state.display;
    let (measure, across) = display.channel_values;
    let plot = match view {
        View::Bode => Some(&display.bode),
        View::Error => Some(&display.error),
        View::Across => Some(&display.across),
        _ => None,
    };
    // Axis ranges chosen by the engineer.
    let values = PANES.map(|pane| plot.and_then(|plot| plot.chosen_values(pane)));
    let bode = BodeOptions {
        omega: plot.and_then(BodeView::chosen_omega),
        values,
        ..bode_options(state)
    };
    let assessed = Some(assessment_choice(state));
    let usual = FigureRequest::new(kind, pairs(state), all_channels(state.dataset()));
    let requirements = shown_requirements(state, kind);
    let over_time = shown_over_time(state, kind);
    let couplings = shown_couplings(state).filter(|_| view == View::Couplings);
    Some(FigureRequest {
        measure,
        across,
        assessed,
        across_role: display.across_role,
        bode,
        couplings,
        requirements,
        over_time,
        ..usual
    })
}

/// Returns the tables that a view shows instead of a figure; `None` if it shows a figure.
pub fn tables_in_place(state: &State, view: View) -> Option<Vec<Table>> {
    (view == View::Requirements)
        .then(|| requirement_tables(state))
        .flatten()
}

/// Draws the button that copies or saves the content of a view.
pub(crate) fn figure_button_ui(
    ui: &mut Ui,
    state: &State,
    view: View,
    commands: &mut Vec<Command>,
) {
    if view.figure().is_none() {
        return;
    }
    let has_figure = tables_in_place(state, view).is_none();
    let (button, _) = MenuButton::from_button(Button::new("Save").frame(false)).ui(ui, |ui| {
        if ui
            .button("Copy the numbers")
            .on_hover_text("As CSV, to the clipboard")
            .clicked()
        {
            commands.push(Command::CopyFigure(view));
            ui.close();
        }
        for format in FigureFormat::ALL
            .into_iter()
            .filter(|format| has_figure || *format == FigureFormat::Csv)
        {
            let text = format!("Save as {}…", format.extension().to_uppercase());
            if ui.button(text).on_hover_text(format.words()).clicked() {
                commands.push(Command::AskSaveFigure(view, format));
                ui.close();
            }
        }
    });
    let button = named(
        button,
        Role::Button,
        format!("Save or copy {}", view.name()),
    );
    button.on_hover_text("This plot on paper, or its numbers: copy, CSV, SVG, PNG, PDF");
}
