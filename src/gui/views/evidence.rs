//! Evidence view: significant differences between net gains at equal airspeed, sources of their
//! scatter, and the scheduling variables and schedule form that they require (M13:
//! docs/error-bars.md). A difference is significant if the uncertainty of trim and identification
//! does not explain it at the confidence level.

use egui::{RichText, ScrollArea, Ui, vec2};

use gdcm_study::results::uncertainty::{AirspeedDifference, Uncertainty};
use gdcm_words::Table;
use gdcm_words::uncertainty::{
    difference_table, difference_verdict, differences_summary, second_variable_table,
};

use super::PageEntry;
use super::scatter_bars::ScatterBars;
use super::schedule_tables::FormsTable;
use crate::gui::commands::command::Command;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::state::view_pages::{EvidencePage, ViewPage};
use crate::gui::state::window_state::State;
use crate::gui::widgets::palette::{BODY_SIZE, Palette, SMALL_SIZE, medium};
use crate::gui::widgets::tables::{Sorting, TableLook, table_block_ui, table_height, table_ui};

/// Maximum table height \[pt\]; longer tables scroll.
const MOST_TABLE: f32 = 330.0;

pub fn evidence_pages(state: &State) -> Vec<PageEntry> {
    let shown = state.display.pages.evidence;
    [
        EvidencePage::Findings,
        EvidencePage::Differences,
        EvidencePage::Forms,
    ]
    .map(|page| PageEntry::new(ViewPage::Evidence(page), page == shown))
    .into()
}

/// Shows the findings (significant differences, a superfluous second variable, sources of the
/// scatter), or the table of differences, or the tables about second variables and schedule forms.
pub fn evidence_view_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let Some(uncertainty) = state.uncertainty().cloned() else {
        ui.label(RichText::new(state.results.absence_of_error_bars()).color(palette.dim_text));
        return;
    };
    let page = EvidenceTables {
        uncertainty: &uncertainty,
        palette,
    };
    let mut sortings = state.display.gains.evidence_tables;
    let [differences, second_variables, forms] = &mut sortings;
    let shown = state.display.pages.evidence;
    ScrollArea::vertical()
        .id_salt(("evidence", shown as usize))
        .auto_shrink(false)
        .show(ui, |ui| match shown {
            EvidencePage::Findings => {
                let summary = differences_summary(&uncertainty);
                ui.label(RichText::new(summary).font(medium(BODY_SIZE)));
                page.differences_ui(ui, state, commands);
                page.second_variable_ui(ui, state);
                let bars = ScatterBars {
                    uncertainty: &uncertainty,
                    palette,
                };
                bars.ui(ui, state);
            }
            EvidencePage::Differences => {
                page.difference_table_ui(ui, state, differences, commands);
            }
            EvidencePage::Forms => {
                page.second_variable_table_ui(ui, state, second_variables, commands);
                page.forms_table_ui(ui, state, forms, commands);
            }
        });
    state.display.gains.evidence_tables = sortings;
}

struct EvidenceTables<'a> {
    uncertainty: &'a Uncertainty,
    palette: &'a Palette,
}

impl EvidenceTables<'_> {
    fn is_significant(&self, difference: &AirspeedDifference) -> bool {
        difference.is_significant(self.uncertainty.level)
    }

    /// Draws a table with the significant differences, below an explanation of the first; nothing
    /// without any.
    fn differences_ui(&self, ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
        let significant: Vec<&AirspeedDifference> = self
            .uncertainty
            .differences
            .iter()
            .filter(|difference| self.is_significant(difference))
            .collect();
        if let Some(first) = significant.first() {
            let verdict = difference_verdict(first, self.uncertainty.level);
            ui.label(self.palette.small(format!(
                "{verdict}; \"expected\" is the difference expected from the uncertainty of trim \
                and identification"
            )));
        }
        if significant.is_empty() {
            return;
        }
        let columns = ["response", "conditions", "difference", "ratio"];
        let mut table = Table::new("Significant differences", columns);
        for difference in significant {
            table.row(difference_cells(state, difference));
        }
        table_block_ui(ui, &table, &TableLook::PLAIN, self.palette, commands);
    }

    /// Draws a note if the schedule has a second variable although no response needs it.
    fn second_variable_ui(&self, ui: &mut Ui, state: &State) {
        if let Some(variable) = state.study.settings.schedule.second {
            let is_needed = self
                .uncertainty
                .second_variables
                .iter()
                .any(|test| test.variable == variable && test.needed);
            if !is_needed {
                ui.label(self.palette.small_warning(format!(
                    "The schedule depends on airspeed and {variable}, but no response depends \
                    significantly on {variable}"
                )));
            }
        }
        ui.add_space(4.0);
    }

    /// Draws all differences at equal airspeed, significant ratios in the warning colour; a click
    /// selects the first condition and the response.
    fn difference_table_ui(
        &self,
        ui: &mut Ui,
        state: &State,
        sorting: &mut Sorting,
        commands: &mut Vec<Command>,
    ) {
        /// Index of the column with the ratio of found to expected difference.
        const RATIO: usize = 6;
        let (table, differences) = difference_table(state.dataset(), self.uncertainty);
        heading_ui(ui, &table.title);
        let look = TableLook {
            color: &|row, column| match differences.get(row) {
                Some(difference) if column == RATIO && self.is_significant(difference) => {
                    Some(self.palette.warning)
                }
                _ => None,
            },
            ..TableLook::PLAIN
        };
        let click = with_height_of_rows(ui, table.rows.len(), |ui| {
            table_ui(ui, &table, sorting, &look, self.palette, commands)
        });
        if let Some(click) = click
            && let Some(difference) = differences.get(click.row)
        {
            commands.push(SelectionCommand::SelectCondition(difference.conditions[0]).into());
            commands.push(SelectionCommand::FocusPair(difference.pair).into());
        }
    }

    /// Draws the tests for a second scheduling variable.
    fn second_variable_table_ui(
        &self,
        ui: &mut Ui,
        state: &State,
        sorting: &mut Sorting,
        commands: &mut Vec<Command>,
    ) {
        let table = second_variable_table(state.dataset(), self.uncertainty);
        heading_ui(ui, &table.title);
        let look = TableLook::PLAIN;
        with_height_of_rows(ui, table.rows.len(), |ui| {
            table_ui(ui, &table, sorting, &look, self.palette, commands)
        });
    }

    /// Draws each schedule form's root mean square error, in fitted and in left-out conditions.
    fn forms_table_ui(
        &self,
        ui: &mut Ui,
        state: &mut State,
        sorting: &mut Sorting,
        commands: &mut Vec<Command>,
    ) {
        // The table borrows the state: take the cache out while it is drawn.
        let mut cached = std::mem::take(&mut state.display.gains.evidence);
        cached.refresh(state);
        if let Some(evidence) = cached.evidence() {
            heading_ui(
                ui,
                "Error of each form of the schedule in fitted and in left-out conditions [% of \
                    the net gain]",
            );
            let table = FormsTable {
                state,
                forms: evidence.forms,
                palette: self.palette,
            };
            with_height_of_rows(ui, evidence.forms.fits.len(), |ui| {
                table.ui(ui, sorting, commands);
            });
        }
        state.display.gains.evidence = cached;
    }
}

/// Returns the cells: response, conditions, relative difference, and the ratio of found to expected
/// difference.
fn difference_cells(state: &State, found: &AirspeedDifference) -> [String; 4] {
    let [first, second] = found.conditions;
    [
        state.dataset().pair_name(found.pair),
        format!(
            "conditions {first} and {second} ({:.0} kt)",
            found.airspeed_kt
        ),
        format!("{:.0} %", 100.0 * found.difference.delta.abs()),
        match found.difference.ratio() {
            Some(ratio) => format!("{ratio:.1} × expected"),
            None => String::new(),
        },
    ]
}

fn heading_ui(ui: &mut Ui, text: &str) {
    ui.label(RichText::new(text).size(SMALL_SIZE).strong());
}

/// Draws a table no higher than its rows, because other tables follow in the same scroll area.
fn with_height_of_rows<R>(ui: &mut Ui, rows: usize, add: impl FnOnce(&mut Ui) -> R) -> R {
    let height = table_height(ui, rows).min(MOST_TABLE);
    ui.allocate_ui(vec2(ui.available_width(), height), add)
        .inner
}
