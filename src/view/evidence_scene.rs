//! What speaks for one form of the schedule or another, made of what was computed.

use std::sync::Arc;

use gdcm_core::dataset::{ConditionId, Pair};
use gdcm_core::schedule::{Evidence, KindEvidence, LeadEvidence, LeadFit, ScheduleKind};
use gdcm_core::study::{Analysis, Table};
use gdcm_core::units::{s_to_ms, signed};

use super::net_gain_scene::net_gain_pairs;
use super::state::State;

/// The evidence for every form of the schedule, kept while the analysis is the same.
#[derive(Debug, Default)]
pub struct CachedEvidence {
    analysis: Option<Arc<Analysis>>,
    found: Option<(Vec<ConditionId>, Evidence)>,
    leads: Vec<LeadEvidence>,
}

impl CachedEvidence {
    /// Makes it anew where the analysis is another one.
    pub fn refresh(&mut self, state: &State) {
        let Some(analysis) = state.results.analysis.as_ref().filter(|_| state.analysis().is_some()) else {
            *self = Self::default();
            return;
        };
        if !self.analysis.as_ref().is_some_and(|known| Arc::ptr_eq(known, analysis)) {
            self.leads = analysis.lead_evidence();
            self.found = analysis.evidence().ok().map(|evidence| (analysis.scheduled(), evidence));
            self.analysis = Some(Arc::clone(analysis));
        }
    }

    /// The evidence for each degree of the signed delays.
    pub fn leads(&self) -> &[LeadEvidence] {
        &self.leads
    }

    /// The conditions of the schedule, and the evidence in their order.
    pub fn found(&self) -> Option<(&[ConditionId], &Evidence)> {
        self.found.as_ref().map(|(conditions, evidence)| (conditions.as_slice(), evidence))
    }
}

/// For each degree of the scheduled signed delays what it misses of each response shown, and what it would have missed of a condition
/// that it has not seen; none where there are no leads.
pub fn lead_evidence_table(state: &State, evidence: &[LeadEvidence]) -> Option<Table> {
    let pairs = net_gain_pairs(state);
    let names = pairs.iter().flat_map(|pair| {
        let name = state.dataset().pair_name(*pair);
        [format!("{name}, fit [ms]"), format!("{name}, unseen [ms]")]
    });
    let columns = std::iter::once("signed delays".to_owned()).chain(names);
    let mut table = Table::new("Errors of each degree of the signed delays", columns);
    for of in evidence {
        let figure =
            |error_s: Option<f64>| error_s.map_or("–".to_owned(), |error_s| format!("{:.2}", s_to_ms(error_s)));
        let cells = pairs.iter().flat_map(|pair| {
            let LeadFit { rms_s, left_out_rms_s } = of.pairs[*pair];
            [figure(Some(rms_s)), figure(left_out_rms_s)]
        });
        table.row(std::iter::once(kind_name(ScheduleKind::Polynomial { degree: of.degree })).chain(cells));
    }
    (!evidence.is_empty()).then_some(table)
}

/// What a form of the schedule is called in the table.
fn kind_name(kind: ScheduleKind) -> String {
    match kind {
        ScheduleKind::Polynomial { degree: 0 } => "constant".to_owned(),
        ScheduleKind::Polynomial { degree } => format!("degree {degree}"),
        ScheduleKind::Table => "table".to_owned(),
    }
}

/// A root mean square of `ln k` as a part of the gain \[%\].
fn percent(rms_ln: Option<f64>) -> String {
    rms_ln.map_or_else(|| "–".to_owned(), |rms| format!("{:.2}", 100.0 * rms))
}

/// For each form of the schedule what it misses of each response shown, and what it would have missed of a condition that it has
/// not seen.
pub fn evidence_table(state: &State, evidence: &Evidence) -> (Table, Vec<ScheduleKind>) {
    let pairs = net_gain_pairs(state);
    let names = pairs.iter().map(|pair| format!("{} [%]", state.dataset().pair_name(*pair)));
    let columns = ["schedule".to_owned(), "fit [%]".to_owned(), "unseen [%]".to_owned()].into_iter().chain(names);
    let mut table = Table::new("Errors of each form of the schedule", columns);
    let mut kinds = Vec::new();
    for kind in &evidence.kinds {
        let unseen = pairs.iter().map(|pair| percent(kind.pairs[*pair].left_out_rms_ln()));
        let whole =
            [kind_name(kind.kind), percent(fit(kind, &pairs)), percent(kind.left_out_rms_ln(pairs.iter().copied()))];
        table.row(whole.into_iter().chain(unseen));
        kinds.push(kind.kind);
    }
    (table, kinds)
}

/// Root mean square of the residuals over these responses.
fn fit(kind: &KindEvidence, pairs: &[Pair]) -> Option<f64> {
    let squares = pairs.iter().map(|pair| kind.pairs[*pair].rms_ln().map(|rms| rms * rms));
    let squares: Vec<f64> = squares.collect::<Option<_>>()?;
    (!squares.is_empty()).then(|| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
}

/// Residual of each condition under the schedule as it is set, for each response shown \[% of the scheduled gain\].
pub fn residual_table(state: &State, conditions: &[ConditionId], evidence: &Evidence) -> Option<Table> {
    let kind = evidence.of(state.study.settings.schedule.kind)?;
    let pairs = net_gain_pairs(state);
    let names = pairs.iter().map(|pair| format!("{} [%]", state.dataset().pair_name(*pair)));
    let mut table = Table::new("Residuals of the schedule", std::iter::once("condition".to_owned()).chain(names));
    for (index, condition) in conditions.iter().enumerate() {
        let cell = |pair: &Pair| {
            let residual = kind.pairs[*pair].residuals.get(index).copied().flatten();
            residual.map_or_else(|| "–".to_owned(), |residual| signed(residual.percent, 2))
        };
        table.row(std::iter::once(condition.to_string()).chain(pairs.iter().map(cell)));
    }
    Some(table)
}

/// The coefficients of the schedule, channel by channel; none without a schedule.
pub fn coefficient_table(state: &State) -> Option<Table> {
    let schedule = state.analysis()?.schedule.as_ref().ok()?;
    let (inputs, outputs) = state.dataset().names_of_channels();
    let found = schedule.coefficients(&inputs, &outputs);
    let title = if found.scale.is_empty() { "Schedule".to_owned() } else { format!("Schedule, {}", found.scale) };
    let mut table = Table::new(title, std::iter::once("of".to_owned()).chain(found.columns));
    for row in found.rows {
        let figures = row.figures.iter().map(|figure| format!("{figure:.5}").replace('-', "\u{2212}"));
        table.row(std::iter::once(row.name).chain(figures));
    }
    Some(table)
}
