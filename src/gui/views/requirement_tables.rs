//! Tables on the pages about requirements, with cell colours.

use gdcm_method::fidelity::ACCEPTABLE;
use gdcm_method::requirements::ModeVerdict;
use gdcm_plot::figure::drawing::Hue;
use gdcm_study::results::requirements::Requirements;
use gdcm_words::Table;
use gdcm_words::requirements::{
    bandwidth_table, mode_table, mode_verdict_words, summary_of_row, summary_table,
};
use gdcm_words::requirements_overview::RequirementsOverview;

use super::requirement_history_jobs::time_histories_job;
use crate::gui::state::requirements_page::RequirementsPage;
use crate::gui::state::window_state::State;

/// Table on a page, with the data that determine its cell colours.
pub(super) struct PageTable<'a> {
    pub(super) table: Table,
    kind: TableKind<'a>,
}

/// Content of a table, which determines the cell colours.
enum TableKind<'a> {
    Bandwidth(&'a Requirements),
    Modes,
    Overview(RequirementsOverview),
    Summary(&'a Requirements),
}

/// Number of columns before the values in the bandwidth table.
const BANDWIDTH_HEADS: usize = 4;
/// Values in the bandwidth table, in column order.
const BANDWIDTH_NUMBERS: [&str; 5] = [
    "omega_bw_rad_s",
    "omega_phase_rad_s",
    "omega_gain_rad_s",
    "omega_180_rad_s",
    "phase_delay_s",
];

impl PageTable<'_> {
    /// Returns a cell's colour; `None` for the default.
    pub(super) fn hue(&self, row: usize, column: usize) -> Option<Hue> {
        match &self.kind {
            TableKind::Bandwidth(requirements) => bandwidth_hue(requirements, row, column),
            TableKind::Modes => self.mode_hue(row, column),
            TableKind::Overview(overview) => {
                if overview.is_outside(row, column) {
                    Some(Hue::Warning)
                } else {
                    None
                }
            }
            TableKind::Summary(requirements) => self.summary_hue(requirements, row, column),
        }
    }

    /// Returns the colour of a mode inside or outside its tolerance: grey without a verdict, `None`
    /// in other columns.
    fn mode_hue(&self, row: usize, column: usize) -> Option<Hue> {
        if !self.table.columns[column].ends_with(": tolerance") {
            return None;
        }
        let words = &self.table.rows[row][column];
        if words.starts_with(mode_verdict_words(ModeVerdict::Within)) {
            Some(Hue::Good)
        } else if words.starts_with(mode_verdict_words(ModeVerdict::Outside)) {
            Some(Hue::Warning)
        } else {
            Some(Hue::DimText)
        }
    }

    /// Returns the colour of a mean J within or beyond the acceptable limit; `None` in other
    /// columns.
    fn summary_hue(&self, requirements: &Requirements, row: usize, column: usize) -> Option<Hue> {
        let finding = summary_of_row(requirements, &self.table.rows[row])?;
        let cost = match self.table.columns[column].as_str() {
            "J on-axis" => finding.mean_j_on_axis?,
            "J of all" => finding.mean_j_all?,
            _ => return None,
        };
        if cost > ACCEPTABLE {
            Some(Hue::Warning)
        } else {
            Some(Hue::Good)
        }
    }
}

/// Returns grey for values that depend on the model above the band; `None` for other cells.
fn bandwidth_hue(requirements: &Requirements, row: usize, column: usize) -> Option<Hue> {
    let name = BANDWIDTH_NUMBERS.get(column.checked_sub(BANDWIDTH_HEADS)?)?;
    if requirements.bandwidth.get(row)?.rests_above(name) {
        Some(Hue::DimText)
    } else {
        None
    }
}

/// Returns the tables on the displayed page.
pub(super) fn page_tables<'a>(state: &State, requirements: &'a Requirements) -> Vec<PageTable<'a>> {
    let dataset = state.dataset();
    match state.display.judging.requirements_page {
        RequirementsPage::Bandwidth => vec![PageTable {
            table: bandwidth_table(requirements, dataset),
            kind: TableKind::Bandwidth(requirements),
        }],
        RequirementsPage::Modes => vec![PageTable {
            table: mode_table(requirements, state.condition().id()),
            kind: TableKind::Modes,
        }],
        RequirementsPage::Histories | RequirementsPage::Summary => {
            let mut histories = None;
            if time_histories_job(state).is_some() {
                histories = state.time_histories().map(AsRef::as_ref);
            }
            let limits = &state.study.requirements.overview;
            let overview = RequirementsOverview::new(requirements, dataset, histories, limits);
            vec![
                PageTable {
                    table: overview.table.clone(),
                    kind: TableKind::Overview(overview),
                },
                PageTable {
                    table: summary_table(requirements, histories),
                    kind: TableKind::Summary(requirements),
                },
            ]
        }
    }
}

/// Returns the tables of a page without a figure; `None` on a page with a figure, or until the
/// requirements are available.
pub fn requirement_tables(state: &State) -> Option<Vec<Table>> {
    match state.display.judging.requirements_page {
        RequirementsPage::Modes | RequirementsPage::Summary => {}
        RequirementsPage::Bandwidth | RequirementsPage::Histories => return None,
    }
    let requirements = state.requirements()?;
    let tables = page_tables(state, requirements);
    Some(tables.into_iter().map(|page| page.table).collect())
}
