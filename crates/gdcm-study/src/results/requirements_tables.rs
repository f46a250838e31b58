//! Tables of the requirements, and their job beside the live answer (M17). One table compares the
//! corrected model of every condition with the identified one, requirement by requirement:
//!
//! ```text
//! bandwidth     100 (omega_BW / omega_BW of the identified model - 1) [%]
//! phase delay   tau_p - tau_p of the identified model [ms]
//! records       share of time inside each tolerance that is not of an integral [%]
//! modes         those beyond their tolerance, of those that have one and are determined
//! ```

use std::sync::Arc;

use gdcm_method::requirements::{BandwidthRule, ModeVerdict, NamedBy};
use gdcm_model::dataset::{ConditionId, Dataset, Pair};
use gdcm_model::executor::Executor;
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_model::units::{number, s_to_ms, signed, telling};

use super::analysis::Analysis;
use super::required_bandwidth::BandwidthFinding;
use super::required_modes::{KnownPoles, ModeNumbers};
use super::requirements::{
    MissingFinding, OverviewLimits, RequirementRole, RequirementSettings, Requirements,
    SummaryFinding, requirements_of,
};
use super::table::Table;
use super::time_histories::TimeHistories;
use super::time_history_tables::percent;
use crate::jobs::job::{Job, Shared};
use crate::stages::execution::Execution;
use crate::stages::uncertainty::Uncertainty;

/// Requirements on the models of an analysis, with error bars where they are known.
#[derive(Clone, Debug, PartialEq)]
pub struct RequirementsJob {
    pub analysis: Shared<Analysis>,
    /// Error bars of its values.
    pub uncertainty: Option<Shared<Uncertainty>>,
    /// Settings of the requirements, on which the analysis does not depend.
    pub settings: Arc<RequirementSettings>,
    pub known: KnownPoles,
}

impl Job for RequirementsJob {
    /// Executor of the pieces.
    type Tools = Box<dyn Executor>;
    type Output = Arc<Requirements>;

    fn run(
        &self,
        executor: &mut Self::Tools,
        progress: &dyn Progress,
    ) -> Result<Self::Output, Cancelled> {
        let analysis = Analysis {
            uncertainty: self.uncertainty.as_deref().cloned(),
            ..self.analysis.asked_with(&self.settings)
        };
        let execution = Execution::new(executor.as_ref(), progress, analysis.conditions.len());
        Ok(Arc::new(requirements_of(
            &analysis,
            &self.known,
            &execution,
        )?))
    }
}

/// Heading of the modulus of a pole.
const MODULUS: &str = "|\u{3bb}| [rad/s]";

fn cell(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(
        || "-".to_owned(),
        |value| format!("{value:.digits$}").replace('-', "\u{2212}"),
    )
}

/// Formats modulus, damping ratio and period of a mode; dashes where there is none.
fn mode_cells(of: Option<&ModeNumbers>) -> [String; 3] {
    [
        cell(
            of.map(|of| of.pole_real_rad_s.hypot(of.pole_imaginary_rad_s)),
            2,
        ),
        cell(of.and_then(|of| of.values.damping_ratio), 2),
        cell(of.and_then(|of| of.values.period_s), 1),
    ]
}

impl Requirements {
    /// Returns bandwidth and phase delay of every on-axis response of every condition and model,
    /// with cautions.
    pub fn bandwidth_table(&self, dataset: &Dataset) -> Table {
        let columns = [
            "condition",
            "airspeed [kt]",
            "response",
            "model",
            "ω_BW [rad/s]",
            "ω_phase [rad/s]",
            "ω_gain [rad/s]",
            "ω180 [rad/s]",
            "τ_p [ms]",
            "remark",
        ];
        let mut table = Table::new("Bandwidth and phase delay of the attitudes", columns);
        for of in &self.bandwidth {
            let crossings = [
                of.omega_bw_rad_s,
                of.omega_phase_rad_s,
                of.omega_gain_rad_s,
                of.omega_180_rad_s,
            ];
            let [bandwidth, phase, gain, neutral] = crossings.map(|value| cell(value, 2));
            table.row([
                of.condition.to_string(),
                telling(of.airspeed_kt, 0),
                dataset.pair_name(of.pair),
                of.role.name().to_owned(),
                bandwidth,
                phase,
                gain,
                neutral,
                cell(of.phase_delay_s.map(s_to_ms), 0),
                of.remark(),
            ]);
        }
        table
    }

    /// Returns why a condition has no modes to compare; `None` where it has.
    pub fn no_modes(&self, condition: ConditionId) -> Option<&str> {
        let is_of = |of: &&MissingFinding| {
            of.condition == Some(condition) && matches!(of.what, "modes" | "all")
        };
        self.missing.iter().find(is_of).map(|of| of.why.as_str())
    }

    /// Returns the modes of a condition: identified, of the physics representative, and with the
    /// couplings of the study where there are any.
    pub fn mode_table(&self, condition: ConditionId) -> Table {
        let modes = || self.modes.iter().filter(|of| of.condition == condition);
        let is_coupled = modes().any(|of| of.corrected_verdict.is_some());
        let heads =
            |model: &str| [MODULUS, "\u{3b6}", "period [s]"].map(|what| format!("{model} {what}"));
        let verdict_of = |model: &str| format!("{model}: tolerance");
        let mut columns = vec!["mode".to_owned(), "named by".to_owned()];
        columns.extend(
            heads("flown")
                .into_iter()
                .chain(heads("physics"))
                .chain([verdict_of("physics")]),
        );
        if is_coupled {
            columns.extend(
                heads("corrected")
                    .into_iter()
                    .chain([verdict_of("corrected")]),
            );
        }
        let deviations = if modes().any(|of| of.identified_deviation.is_some()) {
            "standard deviations of flown modes known"
        } else {
            "standard deviations of flown modes not known (they are of a model identified in this session): not determined is what lies below \
             the band"
        };
        let mut table = Table::new(
            format!("Modes of condition {condition}; {deviations}"),
            columns,
        );
        for of in modes() {
            let name = of
                .name
                .map_or_else(|| format!("mode {}", of.number), |name| name.to_string());
            let named_by = if of.named_by == NamedBy::States {
                "states"
            } else {
                "frequency"
            };
            let entry = of
                .tolerance
                .as_ref()
                .map_or_else(String::new, |of| format!(" ({})", of.entry));
            let verdict = |of: ModeVerdict| format!("{}{entry}", mode_verdict_words(of));
            let mut cells = vec![name, named_by.to_owned()];
            cells.extend(mode_cells(Some(&of.identified)));
            cells.extend(
                mode_cells(of.physics.as_ref())
                    .into_iter()
                    .chain([verdict(of.verdict)]),
            );
            if let Some(corrected) = of.corrected_verdict {
                cells.extend(
                    mode_cells(of.corrected.as_ref())
                        .into_iter()
                        .chain([verdict(corrected)]),
                );
            }
            table.row(cells);
        }
        table
    }

    /// Returns mean J, and the share of the band inside the envelopes of unnoticeable added
    /// dynamics, of every condition and model; with the responses to flight records, also `J_rms`
    /// and Theil's coefficients.
    pub fn summary_table(&self, histories: Option<&TimeHistories>) -> Table {
        let heads = [
            "condition",
            "airspeed [kt]",
            "model",
            "J on-axis",
            "J of all",
            "in MUAD on-axis [%]",
            "in MUAD of all [%]",
        ];
        let of_records = histories.filter(|of| !of.records.is_empty());
        let columns = heads
            .map(str::to_owned)
            .into_iter()
            .chain(of_records.into_iter().flat_map(|of| of.cost_heads()));
        let weights = match of_records {
            Some(of) => format!(
                "; J_rms over all records of a condition, {}",
                of.weights_words()
            ),
            None => String::new(),
        };
        let mut table = Table::new(format!("Summary: models against flight{weights}"), columns);
        let over_time = |id, role| {
            of_records
                .into_iter()
                .flat_map(move |found| found.costs(id, role))
        };
        for of in &self.summary {
            let [on_axis, all] = [of.mean_j_on_axis, of.mean_j_all].map(|value| cell(value, 1));
            let shares = [of.muad_share_on_axis, of.muad_share_all];
            let [on_axis_share, all_share] =
                shares.map(|value| cell(value.map(|share| 100.0 * share), 0));
            let head = [
                of.condition.to_string(),
                telling(of.airspeed_kt, 0),
                of.role.name().to_owned(),
            ];
            let numbers = [on_axis, all, on_axis_share, all_share];
            table.row(
                head.into_iter()
                    .chain(numbers)
                    .chain(over_time(of.condition, of.role)),
            );
        }
        // The other models are compared with the identified model: only time histories say anything
        // about it.
        let role = RequirementRole::Identified;
        for of in of_records
            .into_iter()
            .flat_map(|found| found.records.iter().filter(|of| of.role == role))
        {
            let head = [
                of.condition.to_string(),
                telling(of.airspeed_kt, 0),
                role.name().to_owned(),
            ];
            let row = head
                .into_iter()
                .chain([(); 4].map(|()| "-".to_owned()))
                .chain(over_time(of.condition, role));
            let row: Vec<String> = row.collect();
            if !table.rows.contains(&row) {
                table.row(row);
            }
        }
        table
            .rows
            .sort_by_key(|row| row[0].parse::<i64>().unwrap_or(i64::MAX));
        table
    }

    /// Returns the summary of a row of [`Requirements::summary_table`]; `None` for the identified
    /// model, the reference of the others.
    pub fn summary_of(&self, row: &[String]) -> Option<&SummaryFinding> {
        let [condition, _, role, ..] = row else {
            return None;
        };
        self.summary
            .iter()
            .find(|of| of.condition.to_string() == *condition && of.role.name() == role)
    }

    /// Returns the bandwidth of a response of a condition's model.
    pub fn bandwidth_of(
        &self,
        condition: ConditionId,
        pair: gdcm_model::dataset::Pair,
        role: RequirementRole,
    ) -> Option<&BandwidthFinding> {
        self.bandwidth
            .iter()
            .find(|of| (of.condition, of.pair, of.role) == (condition, pair, role))
    }
}

impl BandwidthFinding {
    /// Returns the cautions about the finding, or why it has no number.
    pub fn remark(&self) -> String {
        let mut words = Vec::new();
        if let Some(why) = self
            .absent
            .get("omega_bw_rad_s")
            .or_else(|| self.absent.get("phase_delay_s"))
        {
            words.push(why.clone());
        }
        let limit = self.rule.map(|rule| match rule {
            BandwidthRule::Gain => "gain-limited: the standard warns of it",
            BandwidthRule::Phase => "of the phase margin",
            BandwidthRule::PhaseGainUnknown => "of the phase margin; the gain margin is not known",
        });
        words.extend(
            limit
                .filter(|_| self.gain_limited || words.is_empty())
                .map(str::to_owned),
        );
        if !self.rests_above_band.is_empty() {
            words.push("rests on the model above the band".to_owned());
        }
        if !self.rests_below_band.is_empty() {
            words.push("rests on the model below the band".to_owned());
        }
        if self.phase_delay_of_line {
            words.push("τ_p of the least-squares line".to_owned());
        }
        words.join("; ")
    }
}

/// Returns the words for the verdict on a mode.
#[must_use]
pub fn mode_verdict_words(verdict: ModeVerdict) -> &'static str {
    match verdict {
        ModeVerdict::Within => "within",
        ModeVerdict::Outside => "outside",
        ModeVerdict::NotDetermined => "not determined by flight",
        ModeVerdict::NoTolerance => "no tolerance",
        ModeVerdict::NotPaired => "unpaired",
    }
}

/// The corrected model of every condition against the identified one.
#[derive(Clone, Debug, PartialEq)]
pub struct RequirementsOverview {
    /// A row for each requirement with its limit, a column for each condition; a dash where there
    /// is no number.
    pub table: Table,
    /// Whether a cell is beyond its limit, row by row.
    outside: Vec<Vec<bool>>,
}

/// Columns that identify the requirement of a row.
const HEADS: [&str; 3] = ["requirement", "unit", "limit"];

impl RequirementsOverview {
    /// Returns whether a cell is beyond its limit.
    pub fn is_outside(&self, row: usize, column: usize) -> bool {
        self.outside
            .get(row)
            .and_then(|row| row.get(column))
            .copied()
            .unwrap_or(false)
    }

    /// Number of columns before the first condition.
    pub const HEADS: usize = HEADS.len();
}

/// A value of a cell, and whether it is beyond its limit.
type Judged = (String, bool);

impl Requirements {
    /// Compares the corrected model of every condition with the identified one; with the responses
    /// to flight records, also their shares inside.
    pub fn overview(
        &self,
        dataset: &Dataset,
        histories: Option<&TimeHistories>,
        limits: &OverviewLimits,
    ) -> RequirementsOverview {
        let ids: Vec<ConditionId> = self
            .summary
            .iter()
            .filter(|of| of.role == RequirementRole::Corrected)
            .map(|of| of.condition)
            .collect();
        let columns = HEADS
            .map(str::to_owned)
            .into_iter()
            .chain(ids.iter().map(ToString::to_string));
        let title = "Corrected against identified models, condition by condition; the limits are the program's, of no standard";
        let mut overview = RequirementsOverview {
            table: Table::new(title, columns),
            outside: Vec::new(),
        };
        let mut row = |heads: [String; 3], cell: &dyn Fn(ConditionId) -> Option<Judged>| {
            let judged: Vec<Option<Judged>> = ids.iter().map(|id| cell(*id)).collect();
            let is_outside = judged
                .iter()
                .map(|cell| cell.as_ref().is_some_and(|(_, is_outside)| *is_outside));
            overview
                .outside
                .push([false; HEADS.len()].into_iter().chain(is_outside).collect());
            let cells = judged
                .into_iter()
                .map(|cell| cell.map_or_else(|| "-".to_owned(), |(text, _)| text));
            overview.table.row(heads.into_iter().chain(cells));
        };
        let about = |value: f64| format!("\u{b1}{}", limit(value));
        let has_number =
            |of: &BandwidthFinding| of.omega_bw_rad_s.is_some() || of.phase_delay_s.is_some();
        let is_known = |pair: &Pair| {
            self.bandwidth
                .iter()
                .any(|of| of.pair == *pair && has_number(of))
        };
        for pair in dataset.measuring_pairs().marked().filter(is_known) {
            let both = |id: ConditionId, value: fn(&BandwidthFinding) -> Option<f64>| {
                let of = |role| self.bandwidth_of(id, pair, role).and_then(value);
                of(RequirementRole::Corrected).zip(of(RequirementRole::Identified))
            };
            let name = dataset.pair_name(pair);
            row(
                [
                    format!("{name}: bandwidth"),
                    "%".to_owned(),
                    about(100.0 * limits.bandwidth),
                ],
                &|id| {
                    let (corrected, identified) = both(id, |of| of.omega_bw_rad_s)?;
                    let change = corrected / identified - 1.0;
                    Some((signed(100.0 * change, 0), change.abs() > limits.bandwidth))
                },
            );
            row(
                [
                    format!("{name}: phase delay"),
                    "ms".to_owned(),
                    about(s_to_ms(limits.phase_delay_s)),
                ],
                &|id| {
                    let (corrected, identified) = both(id, |of| of.phase_delay_s)?;
                    let change_s = corrected - identified;
                    Some((
                        signed(s_to_ms(change_s), 0),
                        change_s.abs() > limits.phase_delay_s,
                    ))
                },
            );
        }
        // Only tolerances of measured quantities, not of integrals.
        for quantity in histories
            .into_iter()
            .flat_map(TimeHistories::measured_quantities)
        {
            let at_least = format!("\u{2265} {}", limit(100.0 * limits.share_inside));
            row(
                [
                    format!("{quantity} inside"),
                    "% of time".to_owned(),
                    at_least,
                ],
                &|id| {
                    let share =
                        histories?.share_inside(id, RequirementRole::Corrected, quantity)?;
                    Some((percent(Some(share)), share < limits.share_inside))
                },
            );
        }
        let of_modes = ["modes beyond tolerance", "of those with a tolerance", "0"];
        row(of_modes.map(str::to_owned), &|id| self.modes_outside(id));
        overview
    }

    /// Counts the modes of the corrected model beyond their tolerance; `None` where no mode with a
    /// tolerance is determined.
    fn modes_outside(&self, id: ConditionId) -> Option<Judged> {
        let of_condition = self.modes.iter().filter(|of| of.condition == id);
        // Gains and delays move no pole: without couplings the corrected model has the poles of the
        // physics model.
        let verdicts: Vec<ModeVerdict> = of_condition
            .map(|of| of.corrected_verdict.unwrap_or(of.verdict))
            .collect();
        let count = |verdict| verdicts.iter().filter(|of| **of == verdict).count();
        let within = count(ModeVerdict::Within);
        let outside = count(ModeVerdict::Outside);
        (within + outside > 0).then(|| (format!("{outside} of {}", within + outside), outside > 0))
    }
}

/// Formats a limit without floating-point noise from its unit.
fn limit(value: f64) -> String {
    number((1e6 * value).round() / 1e6)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::couplings_tests::EXAMPLE;
    use crate::results::required_modes::KnownPoles;
    use crate::results::requirements::requirements_of;
    use crate::stages::execution::Execution;

    #[test]
    fn what_is_beyond_its_limit_is_marked_and_nothing_else() {
        let analysis = &EXAMPLE.analysis;
        let dataset = &analysis.study.dataset;
        let found =
            requirements_of(analysis, &KnownPoles::default(), &Execution::sequential()).unwrap();
        let usual = found.overview(dataset, None, &OverviewLimits::default());
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
        let strict = found.overview(dataset, None, &strict);
        let known = (heads..strict.table.columns.len())
            .find(|column| strict.table.rows[row][*column] != "-")
            .unwrap();
        assert!(strict.is_outside(row, known) && !strict.is_outside(row, 0));
    }
}
