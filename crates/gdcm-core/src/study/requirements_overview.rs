//! The corrected model of every condition against the identified one, requirement by requirement (M17): one table.
//!
//! ```text
//! bandwidth     100 (omega_BW / omega_BW of the identified model - 1) [%]
//! phase delay   tau_p - tau_p of the identified model [ms]
//! records       share of time inside each tolerance that is not of an integral [%]
//! modes         those beyond their tolerance, of those that have one and are determined
//! ```

use crate::dataset::{ConditionId, Dataset, Pair};
use crate::requirements::ModeVerdict;
use crate::units::{number, s_to_ms};

use super::time_history_tables::percent;
use super::{BandwidthFinding, OverviewLimits, RequirementRole, Requirements, Table, TimeHistories};

/// The corrected model of every condition against the identified one.
#[derive(Clone, Debug, PartialEq)]
pub struct RequirementsOverview {
    /// A row for each requirement with its limit, a column for each condition; a dash where there is no number.
    pub table: Table,
    /// Whether a cell is beyond its limit, row by row.
    outside: Vec<Vec<bool>>,
}

/// Columns that say what a row is of.
const HEADS: [&str; 3] = ["requirement", "unit", "limit"];

impl RequirementsOverview {
    /// Whether a cell is beyond its limit.
    pub fn is_outside(&self, row: usize, column: usize) -> bool {
        self.outside.get(row).and_then(|row| row.get(column)).copied().unwrap_or(false)
    }

    /// Columns before the first condition.
    pub const HEADS: usize = HEADS.len();
}

/// A value of a cell, and whether it is beyond its limit.
type Judged = (String, bool);

/// One requirement.
struct Requirement<'a> {
    heads: [String; 3],
    /// What stands in the column of a condition; none where there is no number.
    cell: Box<dyn Fn(ConditionId) -> Option<Judged> + 'a>,
}

impl<'a> Requirement<'a> {
    fn new(
        name: impl Into<String>,
        (unit, limit): (&str, String),
        cell: impl Fn(ConditionId) -> Option<Judged> + 'a,
    ) -> Self {
        Self { heads: [name.into(), unit.to_owned(), limit], cell: Box::new(cell) }
    }
}

impl Requirements {
    /// The corrected model of every condition against the identified one; with the answers to flight records their shares inside too.
    pub fn overview(
        &self,
        dataset: &Dataset,
        histories: Option<&TimeHistories>,
        limits: &OverviewLimits,
    ) -> RequirementsOverview {
        let ids: Vec<ConditionId> =
            self.summary.iter().filter(|of| of.role == RequirementRole::Corrected).map(|of| of.condition).collect();
        let mut requirements: Vec<Requirement<'_>> = Vec::new();
        for pair in dataset.measuring_pairs().marked() {
            requirements.extend(self.of_bandwidth(pair, dataset, limits));
        }
        requirements.extend(histories.into_iter().flat_map(|of| of_records(of, limits)));
        let of_modes = ("of those with a tolerance", "0".to_owned());
        requirements.push(Requirement::new("modes beyond tolerance", of_modes, |id| self.modes_outside(id)));

        let columns = HEADS.map(str::to_owned).into_iter().chain(ids.iter().map(ToString::to_string));
        let title =
            "Corrected against identified models, condition by condition; the limits are the program's, of no standard";
        let mut overview = RequirementsOverview { table: Table::new(title, columns), outside: Vec::new() };
        for Requirement { heads, cell } in requirements {
            let judged: Vec<Option<Judged>> = ids.iter().map(|id| cell(*id)).collect();
            let is_outside = judged.iter().map(|cell| cell.as_ref().is_some_and(|(_, is_outside)| *is_outside));
            overview.outside.push([false; HEADS.len()].into_iter().chain(is_outside).collect());
            let cells = judged.into_iter().map(|cell| cell.map_or_else(|| "-".to_owned(), |(text, _)| text));
            overview.table.row(heads.into_iter().chain(cells));
        }
        overview
    }

    /// Bandwidth and phase delay of a response that some model has one of.
    fn of_bandwidth<'a>(&'a self, pair: Pair, dataset: &Dataset, limits: &OverviewLimits) -> Vec<Requirement<'a>> {
        let has_number = |of: &BandwidthFinding| of.omega_bw_rad_s.is_some() || of.phase_delay_s.is_some();
        if !self.bandwidth.iter().any(|of| of.pair == pair && has_number(of)) {
            return Vec::new();
        }
        let both = move |id: ConditionId, value: fn(&BandwidthFinding) -> Option<f64>| {
            let of = |role| self.bandwidth_of(id, pair, role).and_then(value);
            of(RequirementRole::Corrected).zip(of(RequirementRole::Identified))
        };
        let name = dataset.pair_name(pair);
        let OverviewLimits { bandwidth, phase_delay_s, .. } = *limits;
        let of_bandwidth = move |id| {
            let (corrected, identified) = both(id, |of| of.omega_bw_rad_s)?;
            let change = corrected / identified - 1.0;
            Some((signed(100.0 * change), change.abs() > bandwidth))
        };
        let of_delay = move |id| {
            let (corrected, identified) = both(id, |of| of.phase_delay_s)?;
            let change_s = corrected - identified;
            Some((signed(s_to_ms(change_s)), change_s.abs() > phase_delay_s))
        };
        let about = |value: f64| format!("\u{b1}{}", limit(value));
        vec![
            Requirement::new(format!("{name}: bandwidth"), ("%", about(100.0 * bandwidth)), of_bandwidth),
            Requirement::new(format!("{name}: phase delay"), ("ms", about(s_to_ms(phase_delay_s))), of_delay),
        ]
    }

    /// How many modes of the corrected model are beyond their tolerance; none where no mode with a tolerance is determined.
    fn modes_outside(&self, id: ConditionId) -> Option<Judged> {
        let of_condition = self.modes.iter().filter(|of| of.condition == id);
        // Gains and delays move no pole: without couplings the physics model's are those of the corrected one.
        let verdicts: Vec<ModeVerdict> = of_condition.map(|of| of.corrected_verdict.unwrap_or(of.verdict)).collect();
        let count = |verdict| verdicts.iter().filter(|of| **of == verdict).count();
        let (within, outside) = (count(ModeVerdict::Within), count(ModeVerdict::Outside));
        (within + outside > 0).then(|| (format!("{outside} of {}", within + outside), outside > 0))
    }
}

/// Share of time inside each tolerance of what is measured itself.
fn of_records<'a>(histories: &'a TimeHistories, limits: &OverviewLimits) -> Vec<Requirement<'a>> {
    let least = limits.share_inside;
    let of_quantity = |quantity: &'a str| {
        let share = move |id| {
            let share = histories.share_inside(id, RequirementRole::Corrected, quantity)?;
            Some((percent(Some(share)), share < least))
        };
        let at_least = format!("\u{2265} {}", limit(100.0 * least));
        Requirement::new(format!("{quantity} inside"), ("% of time", at_least), share)
    };
    histories.measured_quantities().map(of_quantity).collect()
}

/// A limit without the last digits of its unit.
fn limit(value: f64) -> String {
    number((1e6 * value).round() / 1e6)
}

/// A difference in whole numbers with its sign, as text that is sorted by value.
fn signed(value: f64) -> String {
    let rounded = format!("{value:+.0}");
    if rounded[1..] == *"0" { "0".to_owned() } else { rounded.replace('-', "\u{2212}") }
}

#[cfg(test)]
mod tests {
    use super::super::couplings_example_tests::EXAMPLE;
    use super::super::{Execution, KnownPoles, requirements_of};
    use super::*;

    #[test]
    fn what_is_beyond_its_limit_is_marked_and_nothing_else() {
        let analysis = &EXAMPLE.analysis;
        let dataset = &analysis.study.dataset;
        let found = requirements_of(analysis, &KnownPoles::default(), &Execution::sequential()).unwrap();
        let usual = found.overview(dataset, None, &OverviewLimits::default());
        let heads = RequirementsOverview::HEADS;
        assert_eq!(usual.table.columns.len() - heads, analysis.conditions.len());
        let row = usual.table.rows.iter().position(|row| row[0] == "LAT \u{2192} P: bandwidth").unwrap();
        assert_eq!(usual.table.rows[row][1..heads], ["%", "\u{b1}10"]);
        let pair = found.bandwidth.iter().find(|of| of.output == "P" && of.input == "LAT").unwrap().pair;
        for (column, id) in usual.table.columns.iter().enumerate().skip(heads) {
            let id = ConditionId(id.parse().unwrap());
            let of = |role| found.bandwidth_of(id, pair, role).and_then(|of| of.omega_bw_rad_s);
            let change =
                of(RequirementRole::Corrected).zip(of(RequirementRole::Identified)).map(|(of, by)| of / by - 1.0);
            let shown = usual.table.rows[row][column].replace('\u{2212}', "-").parse::<f64>().ok();
            assert_eq!(shown, change.map(|change| (100.0 * change).round()), "{id}");
            assert_eq!(usual.is_outside(row, column), change.is_some_and(|change| change.abs() > 0.1));
        }
        let strict = OverviewLimits { bandwidth: 1e-9, ..OverviewLimits::default() };
        let strict = found.overview(dataset, None, &strict);
        let known = (heads..strict.table.columns.len()).find(|column| strict.table.rows[row][*column] != "-").unwrap();
        assert!(strict.is_outside(row, known) && !strict.is_outside(row, 0));
    }
}
