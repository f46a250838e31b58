//! Requirements in addition to J, as in a qualification, evaluated for the physics, corrected,
//! scheduled and identified models side by side (M17).

use std::sync::Arc;

use egui::{CollapsingHeader, Label, Panel, ScrollArea, Ui};

use gdcm_model::dataset::{ConditionId, Dataset};
use gdcm_plot::figure::Color;
use gdcm_study::jobs::requirement_jobs::RequirementsJob;
use gdcm_study::results::requirements::Requirements;
use gdcm_words::Table;
use gdcm_words::missing_results::{missing_reason_text, reversed_phase_text};

use super::PageEntry;
use super::bandwidth::{bandwidth_plots_ui, bandwidth_row_commands};
use super::bandwidth_settings::bandwidth_inputs_ui;
use super::need::{Need, current_analysis};
use super::requirement_histories::histories_ui;
use super::requirement_history_jobs::{over_time_need, time_histories_job};
use super::requirement_limits::{mode_tolerances_ui, overview_limits_ui};
use super::requirement_tables::page_tables;
use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::state::requirements_page::RequirementsPage;
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::PageWords;
use crate::gui::widgets::palette::Palette;
use crate::gui::widgets::panel_layout::restore_panel_size;
use crate::gui::widgets::tables::{TableClick, TableLook, table_grid_ui};

/// Text above every page.
pub(super) const NOT_A_QUALIFICATION: &str =
    "These values describe models and do not replace a qualification (docs/requirements.md)";
/// Initial table height, as a share of the view's height.
const TABLE_PART: f32 = 0.34;

/// Returns the pages, in display order.
pub fn requirements_pages(state: &State) -> Vec<PageEntry> {
    let shown = state.display.judging.requirements_page;
    let pages = [
        (
            RequirementsPage::Bandwidth,
            "bandwidth",
            "Bandwidth and phase delay of the attitudes (ADS-33E-PRF)",
        ),
        (
            RequirementsPage::Histories,
            "in time",
            "Flight records with tolerances, or responses to a step or a doublet",
        ),
        (
            RequirementsPage::Modes,
            "modes",
            "Modes of the condition and their tolerances",
        ),
        (
            RequirementsPage::Summary,
            "summary",
            "Corrected models compared with identified models: mean J, shares of the band inside \
            the MUAD envelopes, deviations over time",
        ),
    ];
    let mut entries = Vec::new();
    for (page, name, purpose) in pages {
        entries.push(PageEntry {
            words: PageWords {
                name,
                short_name: name,
                purpose,
            },
            is_shown: page == shown,
            command: DisplayCommand::ShowRequirements(page).into(),
        });
    }
    entries
}

/// Returns the job for the displayed requirements; `None` until there is an analysis.
pub fn requirements_job(state: &State) -> Option<RequirementsJob> {
    let analysis = current_analysis(state)?;
    Some(RequirementsJob {
        analysis: analysis.into(),
        uncertainty: state.uncertainty().cloned().map(Into::into),
        settings: Arc::clone(&state.study.requirements),
        known: state.records.known_poles(),
    })
}

/// Returns the computations needed by the selected page.
pub fn requirements_needs(state: &State) -> Vec<Need> {
    let page = state.display.judging.requirements_page;
    if page == RequirementsPage::Histories {
        return over_time_need(state).into_iter().collect();
    }
    let mut needs = Vec::new();
    needs.extend(requirements_job(state).map(Need::Requirements));
    if page == RequirementsPage::Summary {
        needs.extend(time_histories_job(state).map(Need::TimeHistories));
    }
    needs
}

/// Draws the selected page below the notes that concern all pages.
pub fn requirements_view_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    if state.display.judging.requirements_page == RequirementsPage::Histories {
        return histories_ui(ui, state, palette, commands);
    }
    let Some(requirements) = state.requirements().cloned() else {
        ui.label(palette.dim(state.results.absence()));
        return;
    };
    let view = RequirementsView {
        requirements: &requirements,
        palette,
    };
    view.reservations_ui(ui, state.dataset());
    match state.display.judging.requirements_page {
        RequirementsPage::Bandwidth => {
            bandwidth_inputs_ui(ui, state, palette, commands);
            restore_panel_size(ui, "requirements");
            let size = TABLE_PART * ui.available_height();
            let panel = Panel::bottom("requirements")
                .resizable(true)
                .default_size(size)
                .min_size(60.0);
            panel.show(ui, |ui| view.tables_ui(ui, state, commands));
            bandwidth_plots_ui(ui, state, &requirements, palette, commands);
        }
        RequirementsPage::Modes => {
            let title =
                CollapsingHeader::new("Tolerances of modes").id_salt("edited tolerances of modes");
            title.show(ui, |ui| mode_tolerances_ui(ui, state, palette, commands));
            view.tables_ui(ui, state, commands);
        }
        RequirementsPage::Histories | RequirementsPage::Summary => {
            let title = CollapsingHeader::new("Limits of the overview")
                .id_salt("edited limits of the overview");
            title.show(ui, |ui| overview_limits_ui(ui, state, palette, commands));
            view.tables_ui(ui, state, commands);
        }
    }
}

/// Context for drawing the computed requirements.
struct RequirementsView<'a> {
    requirements: &'a Requirements,
    palette: &'a Palette,
}

impl RequirementsView<'_> {
    /// Draws a line for each kind of missing result, and the reservations about the available
    /// results.
    fn reservations_ui(&self, ui: &mut Ui, dataset: &Dataset) {
        let mut lines = Vec::new();
        for missing in &self.requirements.missing {
            let condition = match missing.condition {
                Some(id) => format!("Condition {id}: "),
                None => String::new(),
            };
            let why = missing_reason_text(&missing.why);
            lines.push(format!("{condition}no {}: {why}", missing.what));
        }
        for caution in &self.requirements.cautions {
            lines.push(format!(
                "⚠ Condition {}: {}",
                caution.condition,
                reversed_phase_text(caution, dataset)
            ));
        }
        for line in lines {
            ui.add(Label::new(self.palette.small_warning(&line)).truncate())
                .on_hover_text(line);
        }
    }

    /// Draws the tables of the page; a click on a row shows its response or condition.
    fn tables_ui(&self, ui: &mut Ui, state: &mut State, commands: &mut Vec<Command>) {
        let condition = state.condition().id();
        let mut sortings = state.display.judging.requirements_sorting;
        ScrollArea::both()
            .id_salt("requirement tables")
            .auto_shrink(false)
            .show(ui, |ui| {
                let pages = page_tables(state, self.requirements);
                for (page, sorting) in pages.into_iter().zip(&mut sortings) {
                    let table = &page.table;
                    ui.add(Label::new(self.palette.small(&table.title)).extend());
                    if table.rows.is_empty() {
                        ui.label(self.palette.dim(self.absence_of_rows(state)));
                        continue;
                    }
                    let look = TableLook {
                        color: &|row, column| {
                            let hue = page.hue(row, column)?;
                            Some(self.palette.color(Color::new(hue)))
                        },
                        selected: &|row| {
                            table.columns[0] == "condition"
                                && table.rows[row][0] == condition.to_string()
                        },
                    };
                    let click = table_grid_ui(ui, table, sorting, &look, self.palette, commands);
                    if let Some(click) = click {
                        commands.extend(self.click_commands(state, table, click));
                    }
                    ui.add_space(8.0);
                }
            });
        state.display.judging.requirements_sorting = sortings;
    }

    /// Returns why a table has no rows.
    fn absence_of_rows(&self, state: &State) -> String {
        if state.display.judging.requirements_page == RequirementsPage::Modes
            && let Some(why) = self.requirements.no_modes(state.condition().id())
        {
            return missing_reason_text(why);
        }
        "No condition has a result".to_owned()
    }

    /// Returns the commands for a click on a row.
    fn click_commands(&self, state: &State, table: &Table, click: TableClick) -> Vec<Command> {
        match state.display.judging.requirements_page {
            RequirementsPage::Bandwidth => bandwidth_row_commands(self.requirements, click.row),
            RequirementsPage::Histories | RequirementsPage::Summary => {
                match clicked_condition(table, click) {
                    Some(id) => vec![SelectionCommand::SelectCondition(id).into()],
                    None => Vec::new(),
                }
            }
            RequirementsPage::Modes => vec![LayoutCommand::ShowView(View::Poles).into()],
        }
    }
}

/// Returns the clicked condition, which is a row in the summary and a column in the overview.
fn clicked_condition(table: &Table, click: TableClick) -> Option<ConditionId> {
    if let Some(cells) = table.rows.get(click.row)
        && let Ok(id) = cells[0].parse()
    {
        return Some(ConditionId(id));
    }
    table.columns[click.column].parse().ok().map(ConditionId)
}
