//! Tables about the schedule: errors of each form, errors of the signed delays for each polynomial
//! degree, residuals, and coefficients; with a cache for the comparisons. The net-gain view and the
//! evidence view draw them.
//!
//! A *form* of the schedule is a polynomial degree over airspeed, or a table. *Fit* is a form's
//! error in the conditions to which it is fitted, *left out* its error in each condition if it is
//! fitted to the others. A *signed delay* is a delay or, if negative, a lead.

use std::sync::Arc;

use egui::Ui;

use gdcm_method::schedule::ScheduleKind;
use gdcm_method::schedule::form_comparison::{FormComparison, FormFit};
use gdcm_method::schedule::lead_degree_comparison::LeadDegreeFit;
use gdcm_model::dataset::{ConditionId, Pair};
use gdcm_model::number_format::{NO_VALUE, decimals};
use gdcm_model::units::{s_to_ms, signed};
use gdcm_study::decisions::setting_table;
use gdcm_words::Table;

use super::net_gain_pairs::net_gain_pairs;
use crate::gui::commands::command::Command;
use crate::gui::state::evidence_cache::CachedEvidence;
use crate::gui::state::window_state::State;
use crate::gui::widgets::palette::Palette;
use crate::gui::widgets::tables::{Sorting, TableLook, table_ui};

/// Errors of each schedule form; the residuals are in the order of `conditions`.
#[derive(Clone, Copy)]
pub(super) struct ScheduleEvidence<'a> {
    pub(super) conditions: &'a [ConditionId],
    pub(super) forms: &'a FormComparison,
}

impl CachedEvidence {
    /// Recomputes the evidence after the analysis has changed; clears it without an analysis.
    pub(super) fn refresh(&mut self, state: &State) {
        let (Some(analysis), Some(_)) = (&state.results.analysis, state.analysis()) else {
            *self = Self::default();
            return;
        };
        if let Some(known) = &self.analysis
            && Arc::ptr_eq(known, analysis)
        {
            return;
        }
        self.leads = analysis.compare_lead_degrees();
        self.found = match analysis.compare_forms() {
            Ok(forms) => Some((analysis.scheduled(), forms)),
            Err(_) => None,
        };
        self.analysis = Some(Arc::clone(analysis));
    }

    /// Returns the evidence; `None` until it is computed, or without a schedule.
    pub(super) fn evidence(&self) -> Option<ScheduleEvidence<'_>> {
        let (conditions, forms) = self.found.as_ref()?;
        Some(ScheduleEvidence { conditions, forms })
    }
}

/// Table that compares schedule forms.
pub(super) struct FormsTable<'a> {
    pub(super) state: &'a State,
    pub(super) forms: &'a FormComparison,
    pub(super) palette: &'a Palette,
}

impl FormsTable<'_> {
    /// Draws the table; a click on a form selects it.
    pub(super) fn ui(self, ui: &mut Ui, sorting: &mut Sorting, commands: &mut Vec<Command>) {
        let fits = &self.forms.fits;
        let table = forms_table(self.state, self.forms);
        let current = self.state.study.settings.schedule.kind;
        let look = TableLook {
            selected: &|row| fits.get(row).is_some_and(|form| form.kind == current),
            ..TableLook::PLAIN
        };
        let click = table_ui(ui, &table, sorting, &look, self.palette, commands);
        if let Some(click) = click
            && let Some(form) = fits.get(click.row)
        {
            commands.push(setting_table::SCHEDULE.to(form.kind).into());
        }
    }
}

/// Tabulates each form's root mean square error \[%\]: over the displayed responses in fitted and
/// in left-out conditions, then for each response in left-out conditions.
fn forms_table(state: &State, forms: &FormComparison) -> Table {
    let pairs = net_gain_pairs(state);
    let mut columns = vec![
        "schedule".to_owned(),
        "fit [%]".to_owned(),
        "left out [%]".to_owned(),
    ];
    for pair in &pairs {
        columns.push(format!("{} [%]", state.dataset().pair_name(*pair)));
    }
    let mut table = Table::new("Errors of each form of the schedule", columns);
    for form in &forms.fits {
        let mut cells = vec![
            kind_name(form.kind),
            percent_text(fit_rms_ln(form, &pairs)),
            percent_text(form.left_out_rms_ln(pairs.iter().copied())),
        ];
        for pair in &pairs {
            cells.push(percent_text(form.pairs[*pair].left_out_rms_ln()));
        }
        table.row(cells);
    }
    table
}

fn kind_name(kind: ScheduleKind) -> String {
    match kind {
        ScheduleKind::Polynomial { degree: 0 } => "constant".to_owned(),
        ScheduleKind::Polynomial { degree } => format!("degree {degree}"),
        ScheduleKind::Table => "table".to_owned(),
    }
}

/// Formats a root mean square error in the logarithm of the net gain as a relative error \[%\]; "–"
/// for `None`.
fn percent_text(rms_ln: Option<f64>) -> String {
    match rms_ln {
        Some(rms_ln) => format!("{:.2}", 100.0 * rms_ln),
        None => NO_VALUE.to_owned(),
    }
}

/// Formats a delay error \[s\] in milliseconds; "–" for `None`.
fn delay_text(error_s: Option<f64>) -> String {
    match error_s {
        Some(error_s) => format!("{:.2}", s_to_ms(error_s)),
        None => NO_VALUE.to_owned(),
    }
}

/// Computes the root mean square residual in the logarithm of the net gain over these responses;
/// `None` without responses, or if a response has no residuals.
fn fit_rms_ln(form: &FormFit, pairs: &[Pair]) -> Option<f64> {
    if pairs.is_empty() {
        return None;
    }
    let mut squares = Vec::new();
    for pair in pairs {
        let rms = form.pairs[*pair].rms_ln()?;
        squares.push(rms * rms);
    }
    Some((squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
}

/// Tabulates the errors in the scheduled signed delays \[ms\] for each polynomial degree: for each
/// displayed response, in fitted and in left-out conditions. `None` without leads.
pub(super) fn lead_degrees_table(state: &State, degrees: &[LeadDegreeFit]) -> Option<Table> {
    if degrees.is_empty() {
        return None;
    }
    let pairs = net_gain_pairs(state);
    let mut columns = vec!["signed delays".to_owned()];
    for pair in &pairs {
        let name = state.dataset().pair_name(*pair);
        columns.push(format!("{name}, fit [ms]"));
        columns.push(format!("{name}, left out [ms]"));
    }
    let mut table = Table::new("Errors of each degree of the signed delays", columns);
    for fit in degrees {
        let mut cells = vec![kind_name(ScheduleKind::Polynomial { degree: fit.degree })];
        for pair in &pairs {
            let errors = &fit.pairs[*pair];
            cells.push(delay_text(Some(errors.rms_s)));
            cells.push(delay_text(errors.left_out_rms_s));
        }
        table.row(cells);
    }
    Some(table)
}

/// Tabulates each condition's residuals from the current schedule, for each displayed response \[%
/// of the scheduled gain\]. `None` unless the current form is among the compared forms.
pub(super) fn residual_table(state: &State, evidence: ScheduleEvidence<'_>) -> Option<Table> {
    let form = evidence.forms.form(state.study.settings.schedule.kind)?;
    let pairs = net_gain_pairs(state);
    let mut columns = vec!["condition".to_owned()];
    for pair in &pairs {
        columns.push(format!("{} [%]", state.dataset().pair_name(*pair)));
    }
    let mut table = Table::new("Residuals of the schedule", columns);
    for (index, condition) in evidence.conditions.iter().enumerate() {
        let mut cells = vec![condition.to_string()];
        for pair in &pairs {
            cells.push(match form.pairs[*pair].residuals.get(index) {
                Some(Some(residual)) => signed(residual.percent, 2),
                _ => NO_VALUE.to_owned(),
            });
        }
        table.row(cells);
    }
    Some(table)
}

/// Tabulates the schedule's coefficients, channel by channel; `None` without a schedule.
pub(super) fn coefficient_table(state: &State) -> Option<Table> {
    let schedule = state.analysis()?.schedule.as_ref().ok()?;
    let (inputs, outputs) = state.dataset().input_and_output_names();
    let coefficients = schedule.coefficients(&inputs, &outputs);
    let title = if coefficients.scale.is_empty() {
        "Schedule".to_owned()
    } else {
        format!("Schedule, {}", coefficients.scale)
    };
    let mut columns = vec!["quantity".to_owned()];
    columns.extend(coefficients.columns);
    let mut table = Table::new(title, columns);
    for row in coefficients.rows {
        let mut cells = vec![row.name];
        for figure in &row.values {
            cells.push(decimals(*figure, 5));
        }
        table.row(cells);
    }
    Some(table)
}
