//! Requirements in addition to J, as in a qualification: a grid of requirements and conditions
//! above details about the selected cell (M17, docs/requirements.md).

use std::sync::Arc;

use egui::{Align, Layout, Ui, vec2};

use gdcm_model::dataset::Dataset;
use gdcm_study::jobs::requirement_jobs::RequirementsJob;
use gdcm_study::results::requirement_grid::RequirementGrid;
use gdcm_study::results::requirements::Requirements;
use gdcm_words::missing_results::{missing_finding_text, reversed_phase_text};
use gdcm_words::requirement_grid::{count_details_text, met_text};

use super::need::{Need, current_analysis};
use super::requirement_cells::grid_legend_ui;
use super::requirement_details::details_ui;
use super::requirement_grid::grid_ui;
use super::requirement_history_jobs::{over_time_need, time_histories_job};
use super::requirement_limits_menu::limits_menu_ui;
use super::requirement_selection::shown_grid;
use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::state::requirements_display::RequirementsDisplay;
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::choice_ui;
use crate::gui::widgets::palette::{BODY_SIZE, Palette, medium};
use crate::gui::widgets::panel_layout::in_line_ui;

/// Height of the line with the counts \[pt\].
const COUNTS: f32 = 24.0;

/// Returns the text beside the title: the compared models, and that this is no qualification.
pub fn requirements_words(_: &State) -> String {
    "corrected vs identified models, and vs held-out records; not a qualification".to_owned()
}

/// Draws, from right to left, the limits menu and the choice between own and scheduled correction.
pub fn requirements_tools_ui(
    ui: &mut Ui,
    state: &State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    limits_menu_ui(ui, state, palette, commands);
    let display = state.display.judging.requirements;
    let mut judges_schedule = display.judges_schedule;
    let choices = [
        (
            false,
            "own",
            "Models with the correction of their own condition",
        ),
        (
            true,
            "schedule",
            "Models with the correction scheduled over airspeed",
        ),
    ];
    choice_ui(ui, "Correction", &mut judges_schedule, &choices);
    ui.label(palette.small("correction"));
    if judges_schedule != display.judges_schedule {
        let display = RequirementsDisplay {
            judges_schedule,
            ..display
        };
        commands.push(DisplayCommand::ShowRequirements(display).into());
    }
}

/// Returns the job for the displayed requirements; `None` until there is an analysis.
pub fn requirements_job(state: &State) -> Option<RequirementsJob> {
    let analysis = current_analysis(state)?;
    Some(RequirementsJob {
        analysis: analysis.into(),
        uncertainty: state.uncertainty().cloned().map(Into::into),
        settings: Arc::clone(&state.study.requirements),
        identified_poles: state.records.identified_poles(),
    })
}

/// Returns the computations needed by the grid and by the details.
pub fn requirements_needs(state: &State) -> Vec<Need> {
    let mut needs = Vec::new();
    needs.extend(requirements_job(state).map(Need::Requirements));
    // Wait until all records are read; otherwise the grid would be computed again for each
    // condition.
    if state.records.reading.is_none() {
        needs.extend(time_histories_job(state).map(Need::TimeHistories));
    }
    if !state.display.judging.requirements.are_details_hidden {
        needs.extend(over_time_need(state));
    }
    needs
}

/// Draws the drawer with the details at the bottom, which must come first because counts and grid
/// take the rest; then the counts and the grid. Without results, only the reason.
pub fn requirements_view_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let Some(requirements) = state.requirements().cloned() else {
        ui.label(palette.dim(state.results.absence()));
        return;
    };
    let Some(grid) = shown_grid(state) else {
        return;
    };
    if !state.display.judging.requirements.are_details_hidden {
        details_ui(ui, state, &grid, &requirements, palette, commands);
    }
    let header = RequirementsHeader {
        grid: &grid,
        requirements: &requirements,
        palette,
    };
    header.ui(ui, state.dataset());
    grid_ui(ui, state, &grid, palette, commands);
}

/// Line above the grid.
struct RequirementsHeader<'a> {
    grid: &'a RequirementGrid,
    requirements: &'a Requirements,
    palette: &'a Palette,
}

impl RequirementsHeader<'_> {
    /// Draws the counts at the left, and the legend at the right.
    fn ui(&self, ui: &mut Ui, dataset: &Dataset) {
        let palette = self.palette;
        let width = ui.available_width();
        let size = vec2(width, COUNTS);
        let (row, _) = ui.allocate_exact_size(size, egui::Sense::hover());
        let from_right = true;
        let legend = in_line_ui(ui, row, from_right, |ui| grid_legend_ui(ui, palette));
        let rest = row.with_max_x(legend.response.rect.left() - 8.0);
        let layout = Layout::left_to_right(Align::Center);
        let builder = egui::UiBuilder::new().max_rect(rest).layout(layout);
        ui.scope_builder(builder, |ui| {
            ui.spacing_mut().item_spacing.x = 6.0;
            let count = self.grid.count();
            let met = egui::RichText::new(met_text(count)).font(medium(BODY_SIZE));
            ui.label(met);
            ui.label(palette.dim(count_details_text(count)));
            let notes = self.notes(dataset);
            if !notes.is_empty() {
                let words = match notes.len() {
                    1 => "\u{26a0} 1 note".to_owned(),
                    count => format!("\u{26a0} {count} notes"),
                };
                ui.label(palette.small_warning(words))
                    .on_hover_text(notes.join("\n"));
            }
        });
    }

    /// Returns a line for each kind of missing result, and for each caveat about the available
    /// results.
    fn notes(&self, dataset: &Dataset) -> Vec<String> {
        let mut lines = Vec::new();
        for missing in &self.requirements.missing {
            let condition = match missing.condition {
                Some(id) => format!("Condition {id}: "),
                None => String::new(),
            };
            lines.push(format!("{condition}{}", missing_finding_text(missing)));
        }
        for caution in &self.requirements.cautions {
            let text = reversed_phase_text(caution, dataset);
            lines.push(format!("Condition {}: {text}", caution.condition));
        }
        lines
    }
}
