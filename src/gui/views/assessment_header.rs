//! Pages (bars or table) and options (responses, correction, model and cost) in the assessment
//! view.
//!
//! J is the cost of the difference between a model's response and the identified one (M4:
//! docs/method.md).

use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{Button, Grid, PopupCloseBehavior, Role, Ui};

use gdcm_method::fidelity::CostAverage;
use gdcm_study::AssessedCorrection;
use gdcm_study::results::assessment_table::AssessedModel;

use super::PageEntry;
use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::state::assessment_display::{AssessedPairs, AssessmentDisplay, CostPart};
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::{PageOption, PageWords, choice_ui};
use crate::gui::widgets::controls::named;
use crate::gui::widgets::palette::Palette;

pub fn assessment_pages(state: &State) -> Vec<PageEntry> {
    let shown = state.display.judging.assessed;
    let words = [
        PageWords {
            name: "Bars",
            short_name: "Bars",
            purpose: "A bar for each condition",
        },
        PageWords {
            name: "Table",
            short_name: "Table",
            purpose: "Responses down, conditions across",
        },
    ];
    let mut pages = Vec::new();
    for (as_table, words) in [false, true].into_iter().zip(words) {
        let page = AssessmentDisplay { as_table, ..shown };
        pages.push(PageEntry {
            words,
            is_shown: shown.as_table == as_table,
            command: DisplayCommand::Assess(page).into(),
        });
    }
    pages
}

/// Draws the options, from right to left: cost, correction, responses.
pub fn assessment_header_ui(
    ui: &mut Ui,
    state: &State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let shown = state.display.judging.assessed;
    let mut chosen = shown;
    cost_menu_ui(ui, &mut chosen, palette);
    correction_choice_ui(ui, &mut chosen, palette);
    pairs_choice_ui(ui, &mut chosen, palette);
    if chosen != shown {
        commands.push(DisplayCommand::Assess(chosen).into());
    }
}

/// Draws the menu with the assessed model, the average, and the part of J in the table.
fn cost_menu_ui(ui: &mut Ui, chosen: &mut AssessmentDisplay, palette: &Palette) {
    let model = match chosen.model {
        AssessedModel::Nominal => "nominal",
        AssessedModel::Representative => "representative",
    };
    let config = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    let text = PageOption::closed_text_of("model", &format!("{model} ▾"), palette);
    let button = MenuButton::from_button(Button::new(text)).config(config);
    let (button, _) = button.ui(ui, |ui| {
        Grid::new("assessed cost")
            .num_columns(2)
            .spacing([12.0, 6.0])
            .show(ui, |ui| {
                ui.label(palette.dim("Model"));
                model_choice_ui(ui, chosen);
                ui.end_row();
                ui.label(palette.dim("Average of J"));
                average_choice_ui(ui, chosen);
                ui.end_row();
                if chosen.as_table {
                    ui.label(palette.dim("Part of J"));
                    part_choice_ui(ui, chosen);
                    ui.end_row();
                }
            });
    });
    named(button, Role::Button, "Assessed model and cost");
}

fn part_choice_ui(ui: &mut Ui, chosen: &mut AssessmentDisplay) {
    let parts = [
        (CostPart::Total, "J after the correction minus J before"),
        (CostPart::Magnitude, "Magnitude part of ΔJ"),
        (CostPart::Phase, "Phase part of ΔJ"),
    ];
    let parts = parts.map(|(part, hint)| (part, part.symbol(), hint));
    choice_ui(ui, "Part of J", &mut chosen.part, &parts);
}

fn average_choice_ui(ui: &mut Ui, chosen: &mut AssessmentDisplay) {
    let averages = [
        (None, "as set", "Median or mean, as in the settings"),
        (
            Some(CostAverage::Median),
            "median",
            "J with medians over frequency (docs/method.md)",
        ),
        (
            Some(CostAverage::Mean),
            "mean",
            "J with means over frequency",
        ),
    ];
    let name = "Average of the assessment";
    choice_ui(ui, name, &mut chosen.average, &averages);
}

fn correction_choice_ui(ui: &mut Ui, chosen: &mut AssessmentDisplay, palette: &Palette) {
    let corrections = [
        (
            AssessedCorrection::Scheduled,
            "scheduled",
            "Schedule at the condition's airspeed",
        ),
        (
            AssessedCorrection::ScheduleOfOthers,
            "leave-one-out",
            "Schedule fitted without this condition",
        ),
        (
            AssessedCorrection::ScheduledWithoutLeads,
            "scheduled, no leads",
            "Schedule without its lead filters (docs/lead.md)",
        ),
        (
            AssessedCorrection::Own,
            "own optimum",
            "Correction optimised for the condition alone",
        ),
    ];
    let option = PageOption {
        name: "Correction assessed",
        label: "correction",
    };
    option.ui(ui, &mut chosen.correction, &corrections, palette);
}

fn model_choice_ui(ui: &mut Ui, chosen: &mut AssessmentDisplay) {
    let models = [
        (
            AssessedModel::Nominal,
            "nominal",
            "Physics model at the condition's own trim",
        ),
        (
            AssessedModel::Representative,
            "representative",
            "Physics model that represents the bundle",
        ),
    ];
    choice_ui(ui, "Model assessed", &mut chosen.model, &models);
}

fn pairs_choice_ui(ui: &mut Ui, chosen: &mut AssessmentDisplay, palette: &Palette) {
    let pairs = [
        (
            AssessedPairs::OnAxis,
            "on-axis",
            "The on-axis responses of the dataset",
        ),
        (AssessedPairs::OffAxis, "off-axis", "All other responses"),
        (
            AssessedPairs::Focused,
            "in focus",
            "Response selected in the matrix",
        ),
        (AssessedPairs::All, "all", "Every response"),
    ];
    let option = PageOption {
        name: "Responses assessed",
        label: "responses",
    };
    option.ui(ui, &mut chosen.pairs, &pairs, palette);
}
