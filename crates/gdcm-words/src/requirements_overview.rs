//! The overview of the requirements (M17): every condition's corrected model compared with the identified
//! model, requirement by requirement.
//!
//! ```text
//! bandwidth     100 (omega_BW / omega_BW of the identified model - 1) [%]
//! phase delay   tau_p - tau_p of the identified model [ms]
//! records       share of time inside each tolerance, except those of integrated outputs [%]
//! modes         number beyond their tolerance, and number of determined modes with a tolerance
//! ```

use gdcm_method::requirements::ModeVerdict;
use gdcm_model::dataset::{ConditionId, Dataset, Pair};
use gdcm_model::number_format::NO_VALUE;
use gdcm_model::units::{number, s_to_ms, signed};
use gdcm_study::decisions::requirement_settings::OverviewLimits;
use gdcm_study::results::required_bandwidth::BandwidthFinding;
use gdcm_study::results::requirement_role::RequirementRole;
use gdcm_study::results::requirements::Requirements;
use gdcm_study::results::time_histories::TimeHistories;

use crate::table::Table;
use crate::time_histories::percent_rounded_down;

/// Table that compares every condition's corrected model with the identified model.
#[derive(Clone, Debug, PartialEq)]
pub struct RequirementsOverview {
    /// A row for each requirement, with its limit, and a column for each condition; a dash marks a
    /// missing value.
    pub table: Table,
    /// Whether each cell is beyond its limit, row by row.
    outside: Vec<Vec<bool>>,
}

/// Columns that describe the requirement of a row.
const HEADS: [&str; 3] = ["requirement", "unit", "limit"];

/// A requirement in the overview, with its unit and its limit.
struct OverviewRow {
    requirement: String,
    unit: &'static str,
    limit: String,
}

/// Value of a cell, and whether it is beyond its limit.
struct Judged {
    text: String,
    is_outside: bool,
}

impl RequirementsOverview {
    /// Number of columns before the first condition.
    pub const HEADS: usize = HEADS.len();

    /// Compares every condition's corrected model with the identified model; with flight records,
    /// also the shares of time inside tolerances.
    pub fn new(
        requirements: &Requirements,
        dataset: &Dataset,
        histories: Option<&TimeHistories>,
        limits: &OverviewLimits,
    ) -> Self {
        let ids: Vec<ConditionId> = requirements
            .summary
            .iter()
            .filter(|finding| finding.role == RequirementRole::Corrected)
            .map(|finding| finding.condition)
            .collect();
        let mut columns = HEADS.map(str::to_owned).to_vec();
        columns.extend(ids.iter().map(ToString::to_string));
        let title = "Corrected models compared with identified models, condition by condition; \
            the limits are set in this program, not by a standard";
        let mut overview = Self {
            table: Table::new(title, columns),
            outside: Vec::new(),
        };
        for pair in dataset.measuring_pairs().marked() {
            if has_bandwidth(requirements, pair) {
                let name = dataset.pair_name(pair);
                overview.add_bandwidth(requirements, &ids, pair, &name, limits);
            }
        }
        if let Some(histories) = histories {
            overview.add_histories(histories, &ids, limits);
        }
        overview.add(
            OverviewRow {
                requirement: "modes beyond tolerance".to_owned(),
                unit: "of modes with a tolerance",
                limit: "0".to_owned(),
            },
            &ids,
            |id| modes_outside(requirements, id),
        );
        overview
    }

    /// Adds a response's bandwidth and phase delay.
    fn add_bandwidth(
        &mut self,
        requirements: &Requirements,
        ids: &[ConditionId],
        pair: Pair,
        name: &str,
        limits: &OverviewLimits,
    ) {
        let both = |id: ConditionId, value: fn(&BandwidthFinding) -> Option<f64>| {
            let corrected = requirements
                .bandwidth_of(id, pair, RequirementRole::Corrected)
                .and_then(value);
            let identified = requirements
                .bandwidth_of(id, pair, RequirementRole::Identified)
                .and_then(value);
            corrected.zip(identified)
        };
        let bandwidth = OverviewRow {
            requirement: format!("{name}: bandwidth"),
            unit: "%",
            limit: plus_minus(100.0 * limits.bandwidth),
        };
        self.add(bandwidth, ids, |id| {
            let (corrected, identified) = both(id, |finding| finding.omega_bw_rad_s)?;
            let change = corrected / identified - 1.0;
            Some(Judged {
                text: signed(100.0 * change, 0),
                is_outside: change.abs() > limits.bandwidth,
            })
        });
        let phase_delay = OverviewRow {
            requirement: format!("{name}: phase delay"),
            unit: "ms",
            limit: plus_minus(s_to_ms(limits.phase_delay_s)),
        };
        self.add(phase_delay, ids, |id| {
            let (corrected, identified) = both(id, |finding| finding.phase_delay_s)?;
            let change_s = corrected - identified;
            Some(Judged {
                text: signed(s_to_ms(change_s), 0),
                is_outside: change_s.abs() > limits.phase_delay_s,
            })
        });
    }

    /// Adds the share of time inside each tolerance, except tolerances of integrated outputs.
    fn add_histories(
        &mut self,
        histories: &TimeHistories,
        ids: &[ConditionId],
        limits: &OverviewLimits,
    ) {
        for quantity in histories.measured_quantities() {
            let row = OverviewRow {
                requirement: format!("{quantity} inside"),
                unit: "% of time",
                limit: format!("\u{2265} {}", rounded(100.0 * limits.share_inside)),
            };
            self.add(row, ids, |id| {
                let share = histories.share_inside(id, RequirementRole::Corrected, quantity)?;
                Some(Judged {
                    text: percent_rounded_down(Some(share)),
                    is_outside: share < limits.share_inside,
                })
            });
        }
    }

    /// Adds a requirement with a cell for each condition.
    fn add(
        &mut self,
        row: OverviewRow,
        ids: &[ConditionId],
        judge: impl Fn(ConditionId) -> Option<Judged>,
    ) {
        let mut cells = vec![row.requirement, row.unit.to_owned(), row.limit];
        let mut outside = vec![false; HEADS.len()];
        for id in ids {
            match judge(*id) {
                Some(judged) => {
                    cells.push(judged.text);
                    outside.push(judged.is_outside);
                }
                None => {
                    cells.push(NO_VALUE.to_owned());
                    outside.push(false);
                }
            }
        }
        self.table.row(cells);
        self.outside.push(outside);
    }

    /// Returns whether the value of a cell is outside its limit.
    pub fn is_outside(&self, row: usize, column: usize) -> bool {
        self.outside
            .get(row)
            .and_then(|row| row.get(column))
            .copied()
            .unwrap_or(false)
    }
}

/// Returns whether any model has a bandwidth or a phase delay in a response.
fn has_bandwidth(requirements: &Requirements, pair: Pair) -> bool {
    requirements.bandwidth.iter().any(|finding| {
        finding.pair == pair
            && (finding.omega_bw_rad_s.is_some() || finding.phase_delay_s.is_some())
    })
}

/// Counts the modes of the corrected model beyond their tolerance; `None` if no mode with a
/// tolerance is determined.
fn modes_outside(requirements: &Requirements, id: ConditionId) -> Option<Judged> {
    let mut within = 0;
    let mut outside = 0;
    for mode in &requirements.modes {
        if mode.condition != id {
            continue;
        }
        // Gains and delays do not move poles: without couplings, the corrected model has the poles
        // of the physics model.
        match mode.corrected_verdict.unwrap_or(mode.verdict) {
            ModeVerdict::Within => within += 1,
            ModeVerdict::Outside => outside += 1,
            ModeVerdict::NotDetermined | ModeVerdict::NoTolerance | ModeVerdict::NotPaired => {}
        }
    }
    if within + outside == 0 {
        return None;
    }
    Some(Judged {
        text: format!("{outside} of {}", within + outside),
        is_outside: outside > 0,
    })
}

/// Formats a symmetric limit: "±10".
fn plus_minus(value: f64) -> String {
    format!("\u{b1}{}", rounded(value))
}

/// Formats a limit without the floating-point noise of its unit conversion.
fn rounded(value: f64) -> String {
    number((1e6 * value).round() / 1e6)
}

#[cfg(test)]
mod tests {
    use gdcm_study::Execution;
    use gdcm_study::results::required_modes::KnownPoles;
    use gdcm_study::results::requirements::requirements_of;

    use super::*;
    use crate::example_tests::EXAMPLE;

    #[test]
    fn what_is_beyond_its_limit_is_marked_and_nothing_else() {
        let analysis = &*EXAMPLE;
        let dataset = &analysis.study.dataset;
        let found =
            requirements_of(analysis, &KnownPoles::default(), &Execution::sequential()).unwrap();
        let usual = RequirementsOverview::new(&found, dataset, None, &OverviewLimits::default());
        let heads = RequirementsOverview::HEADS;
        assert_eq!(usual.table.columns.len() - heads, analysis.conditions.len());
        let row = usual
            .table
            .rows
            .iter()
            .position(|row| row[0] == "LAT \u{2192} P: bandwidth")
            .unwrap();
        assert_eq!(usual.table.rows[row][1..heads], ["%", "\u{b1}10"]);
        let pair = found
            .bandwidth
            .iter()
            .find(|of| of.output == "P" && of.input == "LAT")
            .unwrap()
            .pair;
        for (column, id) in usual.table.columns.iter().enumerate().skip(heads) {
            let id = ConditionId(id.parse().unwrap());
            let of = |role| {
                found
                    .bandwidth_of(id, pair, role)
                    .and_then(|of| of.omega_bw_rad_s)
            };
            let change = of(RequirementRole::Corrected)
                .zip(of(RequirementRole::Identified))
                .map(|(of, by)| of / by - 1.0);
            let shown = usual.table.rows[row][column]
                .replace('\u{2212}', "-")
                .parse::<f64>()
                .ok();
            assert_eq!(shown, change.map(|change| (100.0 * change).round()), "{id}");
            assert_eq!(
                usual.is_outside(row, column),
                change.is_some_and(|change| change.abs() > 0.1)
            );
        }
        let strict = OverviewLimits {
            bandwidth: 1e-9,
            ..OverviewLimits::default()
        };
        let strict = RequirementsOverview::new(&found, dataset, None, &strict);
        let known = (heads..strict.table.columns.len())
            .find(|column| strict.table.rows[row][*column] != NO_VALUE)
            .unwrap();
        assert!(strict.is_outside(row, known) && !strict.is_outside(row, 0));
    }
}
