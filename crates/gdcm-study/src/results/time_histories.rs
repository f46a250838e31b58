//! Comparisons between every condition's models and its flight records, within tolerances (M17.2);
//! `record_simulations::time_histories_of` computes them.
//!
//! ```text
//! y, y^             flown and simulated output, n_t samples of n_o outputs
//! J_rms             sqrt(1/(n_t n_o) sum (y - y^)' W (y - y^)),   W = 1 for deg, deg/s, ft/s, ft/s^2
//! Theil coefficient rms(y - y^) / (rms y + rms y^), about the mean of y
//! ```

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use serde::Serialize;

use gdcm_method::requirements::{Tolerance, ToleranceTable};
use gdcm_model::dataset::ConditionId;
use gdcm_model::simulation::FlightRecord;
use gdcm_sysid::identification::Preparation;
use gdcm_sysid::records::LaidOutRecord;

use super::missing_finding::MissingFinding;
use super::record_comparison::Trend;
use super::requirement_role::RequirementRole;
use crate::shared::Shared;

/// A flight record with which models are compared.
#[derive(Clone, Debug, PartialEq)]
pub struct HistoryRecord {
    pub flight: Shared<FlightRecord>,
    /// Whether the record was excluded from the models' identification.
    pub held_out: bool,
}

/// A condition's flight records, and their preparation.
#[derive(Clone, Debug, PartialEq)]
pub struct HistoryRecords {
    pub condition: ConditionId,
    pub records: Vec<HistoryRecord>,
    pub preparation: Preparation,
}

impl HistoryRecords {
    /// Collects a condition's `records` that are in use, with their preparation.
    pub fn from_used<'r>(
        condition: ConditionId,
        records: impl IntoIterator<Item = &'r LaidOutRecord>,
        preparation: Preparation,
    ) -> Self {
        let mut used = Vec::new();
        for record in records {
            if let Some(flight) = record.used_flight() {
                used.push(HistoryRecord {
                    flight: Arc::clone(flight).into(),
                    held_out: record.guess.held_out,
                });
            }
        }
        Self {
            condition,
            records: used,
            preparation,
        }
    }

    /// Returns the step count for `record_simulations::time_histories_of`: one step to prepare each
    /// record, and one for each role's simulation with it.
    pub fn steps(records: &[Self]) -> usize {
        let count: usize = records
            .iter()
            .map(|condition| condition.records.len())
            .sum();
        (1 + RequirementRole::ALL.len()) * count
    }
}

/// A model's result for a record and a tolerance row.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ToleranceFinding {
    /// Compared quantity ("bank angle").
    pub quantity: String,
    /// Output from which the quantity is computed.
    pub output: String,
    /// Whether the output is integrated from the start of each window.
    pub integrated: bool,
    pub unit: String,
    /// Share of time inside the tolerance, 0 to 1.
    pub share_inside: f64,
    /// Maximum distance beyond the corridor, in `unit`; negative where all samples are inside.
    pub largest_excess: f64,
    /// Time of the largest excess, on the record's time axis \[s\].
    pub largest_excess_at_s: f64,
    /// Maximum error as a multiple of the tolerance at the same sample; above 1 where a sample is
    /// outside.
    pub peak_error: f64,
    /// Time of the peak error, on the record's time axis \[s\].
    pub peak_error_at_s: f64,
    /// Correlation of simulated and measured signal about their means; `None` where either is
    /// constant.
    pub correlation: Option<f64>,
    /// Whether the output is on-axis to the input with the largest variation; `None` where that
    /// input cannot be determined.
    pub on_axis: Option<bool>,
    /// Trend of an off-axis output, from the sign of the correlation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub trend: Option<Trend>,
}

impl ToleranceFinding {
    /// Returns the values with their export names.
    pub fn quantities(&self) -> [(&'static str, Option<f64>); 6] {
        [
            ("share_inside", Some(self.share_inside)),
            ("largest_excess", Some(self.largest_excess)),
            ("largest_excess_at_s", Some(self.largest_excess_at_s)),
            ("peak_error", Some(self.peak_error)),
            ("peak_error_at_s", Some(self.peak_error_at_s)),
            ("correlation", self.correlation),
        ]
    }
}

/// A model's result for a record.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HistoryFinding {
    pub condition: ConditionId,
    /// The condition's true airspeed \[kt\].
    pub airspeed_kt: f64,
    pub record: String,
    /// Whether the record was excluded from the models' identification.
    pub held_out: bool,
    pub role: RequirementRole,
    pub model: String,
    /// Input with the largest variation; `None` where the inputs have different units.
    pub moved_input: Option<String>,
    /// Number of compared samples.
    pub samples: usize,
    /// Number of windows that contain these samples.
    pub windows: usize,
    /// The longest window's length \[s\].
    pub window_s: f64,
    /// Weighted rms error (M17.4) \[deg, deg/s, ft/s, ft/s^2\]; `None` where no output has such a
    /// unit.
    pub j_rms: Option<f64>,
    /// Outputs excluded from `j_rms`, because they have no such unit.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub j_rms_left_out: Vec<String>,
    /// Theil's coefficient by output name, 0 to 1; constant outputs have none.
    pub theil: BTreeMap<String, f64>,
    /// Result for each applicable tolerance row.
    pub tolerances: Vec<ToleranceFinding>,
}

impl HistoryFinding {
    /// Returns the peak error in a tolerance row's quantity, as a multiple of the tolerance; `None`
    /// where the quantity was not compared.
    pub fn peak_error(&self, tolerance: &Tolerance) -> Option<f64> {
        let found = self.tolerances.iter().find(|found| {
            found.quantity == tolerance.quantity && found.output == tolerance.channel
        })?;
        Some(found.peak_error)
    }
}

/// Comparisons between simulations and all flight records, in the export format.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TimeHistories {
    pub tolerance_table: ToleranceTable,
    /// One result for each record and simulated model.
    pub records: Vec<HistoryFinding>,
    pub missing: Vec<MissingFinding>,
}

impl TimeHistories {
    /// Returns the conditions with records, and each condition's record count.
    pub fn conditions(&self) -> Vec<(ConditionId, usize)> {
        let mut conditions = Vec::new();
        for findings in self.records.chunk_by(|a, b| a.condition == b.condition) {
            let id = findings[0].condition;
            // A model may be missing, and two records may have the same name; the maximum over the
            // roles counts correctly.
            let records = RequirementRole::ALL
                .map(|role| self.of_role(id, role).count())
                .into_iter()
                .max();
            conditions.push((id, records.unwrap_or_default()));
        }
        conditions
    }

    /// Returns a role's findings in a condition.
    pub fn of_role(
        &self,
        condition: ConditionId,
        role: RequirementRole,
    ) -> impl Iterator<Item = &HistoryFinding> {
        self.records
            .iter()
            .filter(move |finding| finding.condition == condition && finding.role == role)
    }

    /// Returns the share of time inside a tolerance over a condition's records, 0 to 1.
    pub fn share_inside(
        &self,
        condition: ConditionId,
        role: RequirementRole,
        quantity: &str,
    ) -> Option<f64> {
        self.mean(condition, role, |finding| {
            let tolerance = finding
                .tolerances
                .iter()
                .find(|tolerance| tolerance.quantity == quantity)?;
            Some(tolerance.share_inside)
        })
    }

    /// Returns `J_rms` over a condition's records: the root mean square over the samples.
    pub fn j_rms(&self, condition: ConditionId, role: RequirementRole) -> Option<f64> {
        self.mean(condition, role, |finding| Some(finding.j_rms?.powi(2)))
            .map(f64::sqrt)
    }

    /// Returns an output's Theil coefficient over a condition's records: the mean, weighted by
    /// sample count.
    pub fn theil(
        &self,
        condition: ConditionId,
        role: RequirementRole,
        output: &str,
    ) -> Option<f64> {
        self.mean(condition, role, |finding| {
            finding.theil.get(output).copied()
        })
    }

    /// Averages a quantity over a condition's records that have it, weighted by sample count.
    fn mean(
        &self,
        condition: ConditionId,
        role: RequirementRole,
        value: impl Fn(&HistoryFinding) -> Option<f64>,
    ) -> Option<f64> {
        let mut sum = 0.0;
        let mut samples = 0.0;
        for finding in self.of_role(condition, role) {
            if let Some(value) = value(finding) {
                sum += value * finding.samples as f64;
                samples += finding.samples as f64;
            }
        }
        if samples > 0.0 {
            Some(sum / samples)
        } else {
            None
        }
    }

    /// Returns the outputs that move in a record: those with a Theil coefficient, which constant
    /// outputs lack.
    pub fn moved_outputs(&self) -> BTreeSet<&str> {
        self.records
            .iter()
            .flat_map(|finding| finding.theil.keys())
            .map(String::as_str)
            .collect()
    }

    /// Returns the quantities in the applied tolerance rows, in table order.
    pub fn quantities(&self) -> impl Iterator<Item = &str> {
        self.applied_rows().map(|row| row.quantity.as_str())
    }

    /// Returns the quantities in the applied tolerance rows without integrated outputs.
    pub fn measured_quantities(&self) -> impl Iterator<Item = &str> {
        self.quantities().filter(|quantity| {
            let rows = self.tolerance_table.rows();
            !rows
                .iter()
                .any(|row| row.integrated && row.quantity == *quantity)
        })
    }

    fn applied_rows(&self) -> impl Iterator<Item = &Tolerance> {
        self.tolerance_table.rows().iter().filter(|row| {
            self.records
                .iter()
                .flat_map(|finding| &finding.tolerances)
                .any(|applied| applied.quantity == row.quantity)
        })
    }
}
