//! Selectors in the header of the assessment view: form, part of J, average, correction, model and
//! responses.

use egui::Ui;

use gdcm_method::fidelity::CostAverage;
use gdcm_study::AssessedCorrection;
use gdcm_study::results::assessment_table::AssessedModel;

use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::state::assessment_display::{AssessedPairs, AssessmentDisplay, CostPart};
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::choice_ui;

/// Draws the selectors in the header, from right to left.
pub fn assessment_header_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let shown = state.display.judging.assessed;
    let mut chosen = shown;
    let forms = [
        (false, "bars", "A bar for each condition"),
        (true, "table", "Responses down, conditions across"),
    ];
    choice_ui(ui, "Form of the assessment", &mut chosen.as_table, &forms);
    if chosen.as_table {
        let parts = [
            (CostPart::Total, "J after the correction minus J before"),
            (CostPart::Magnitude, "Magnitude part of ΔJ"),
            (CostPart::Phase, "Phase part of ΔJ"),
        ];
        let parts = parts.map(|(part, hint)| (part, part.symbol(), hint));
        choice_ui(ui, "Part of J", &mut chosen.part, &parts);
    }
    average_choice_ui(ui, &mut chosen);
    correction_choice_ui(ui, &mut chosen);
    model_choice_ui(ui, &mut chosen);
    pairs_choice_ui(ui, &mut chosen);
    if chosen != shown {
        commands.push(DisplayCommand::Assess(chosen).into());
    }
}

fn average_choice_ui(ui: &mut Ui, chosen: &mut AssessmentDisplay) {
    let averages = [
        (None, "as set", "Median or mean, as in the settings"),
        (
            Some(CostAverage::Median),
            "median",
            "J with medians over frequency (M4)",
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

fn correction_choice_ui(ui: &mut Ui, chosen: &mut AssessmentDisplay) {
    let corrections = [
        (
            AssessedCorrection::Scheduled,
            "scheduled",
            "Schedule at the condition's airspeed",
        ),
        (
            AssessedCorrection::ScheduleOfOthers,
            "of the others",
            "Schedule fitted without this condition",
        ),
        (
            AssessedCorrection::ScheduledWithoutLeads,
            "scheduled, no leads",
            "Schedule without its lead filters (M15)",
        ),
        (
            AssessedCorrection::Own,
            "own optimum",
            "Correction optimised for the condition alone",
        ),
    ];
    let name = "Correction assessed";
    choice_ui(ui, name, &mut chosen.correction, &corrections);
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

fn pairs_choice_ui(ui: &mut Ui, chosen: &mut AssessmentDisplay) {
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
    choice_ui(ui, "Responses assessed", &mut chosen.pairs, &pairs);
}
