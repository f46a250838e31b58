//! Time histories within tolerances, as tables (M17.2).

use std::collections::BTreeSet;

use gdcm_model::dataset::ConditionId;
use gdcm_model::units::telling;

use super::requirements::RequirementRole;
use super::table::Table;
use super::time_histories::{HistoryFinding, TimeHistories, ToleranceFinding, Trend};

impl TimeHistories {
    /// Returns the conditions with records, and the number of records of each.
    pub fn conditions(&self) -> Vec<(ConditionId, usize)> {
        let of_condition = self
            .records
            .chunk_by(|a, b| a.condition == b.condition)
            .map(|of| of[0].condition);
        // A model may be missing; two records may have the same name.
        let records = |id| {
            RequirementRole::ALL
                .map(|role| self.of_role(id, role).count())
                .into_iter()
                .max()
        };
        of_condition
            .map(|id| (id, records(id).unwrap_or_default()))
            .collect()
    }

    /// Returns the findings of a condition and a role.
    pub fn of_role(
        &self,
        condition: ConditionId,
        role: RequirementRole,
    ) -> impl Iterator<Item = &HistoryFinding> {
        self.records
            .iter()
            .filter(move |of| (of.condition, of.role) == (condition, role))
    }

    /// Returns the share of samples inside a tolerance over all records of a condition, 0 to 1.
    pub fn share_inside(
        &self,
        condition: ConditionId,
        role: RequirementRole,
        quantity: &str,
    ) -> Option<f64> {
        let share = |finding: &HistoryFinding| {
            finding
                .tolerances
                .iter()
                .find(|of| of.quantity == quantity)
                .map(|of| of.share_inside)
        };
        self.mean(condition, role, share)
    }

    /// Returns `J_rms` over all records of a condition: the root mean square over their samples.
    pub fn j_rms(&self, condition: ConditionId, role: RequirementRole) -> Option<f64> {
        self.mean(condition, role, |finding| Some(finding.j_rms?.powi(2)))
            .map(f64::sqrt)
    }

    /// Averages a quantity over the records of a condition that have it, weighted by samples.
    fn mean(
        &self,
        condition: ConditionId,
        role: RequirementRole,
        value: impl Fn(&HistoryFinding) -> Option<f64>,
    ) -> Option<f64> {
        let known = self
            .of_role(condition, role)
            .filter_map(|of| Some((value(of)?, of.samples as f64)));
        let sums = known.fold([0.0, 0.0], |[sum, all], (value, samples)| {
            [sum + value * samples, all + samples]
        });
        (sums[1] > 0.0).then(|| sums[0] / sums[1])
    }

    /// Returns the applied rows of the table of tolerances, in its order.
    fn quantities(&self) -> impl Iterator<Item = &str> {
        let rows = self
            .tolerance_table
            .rows()
            .iter()
            .map(|row| row.quantity.as_str());
        let is_applied = |finding: &HistoryFinding, name: &str| {
            finding.tolerances.iter().any(|of| of.quantity == name)
        };
        rows.filter(move |name| self.records.iter().any(|finding| is_applied(finding, name)))
    }

    /// Returns the applied rows without integrals.
    pub(crate) fn measured_quantities(&self) -> impl Iterator<Item = &str> {
        let is_integral = |name: &str| {
            self.tolerance_table
                .rows()
                .iter()
                .any(|row| row.integrated && row.quantity == name)
        };
        self.quantities().filter(move |name| !is_integral(name))
    }

    /// Tabulates the share of time inside each tolerance over all records of each condition, model
    /// by model.
    pub fn share_table(&self) -> Table {
        let heads = ["condition", "records", "quantity"].map(str::to_owned);
        let columns = heads
            .into_iter()
            .chain(RequirementRole::ALL.map(|role| format!("{} [%]", role.name())));
        let mut table = Table::new("Share of time inside the tolerances", columns);
        for (condition, records) in self.conditions() {
            for quantity in self.quantities() {
                let shares =
                    RequirementRole::ALL.map(|role| self.share_inside(condition, role, quantity));
                let heads = [
                    condition.to_string(),
                    records.to_string(),
                    quantity.to_owned(),
                ];
                table.row(heads.into_iter().chain(shares.map(percent)));
            }
        }
        table
    }

    /// Returns Theil's coefficient of an output over all records of a condition: the mean weighted
    /// by samples.
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

    /// Returns the outputs with a Theil coefficient.
    fn moved_outputs(&self) -> BTreeSet<&str> {
        self.records
            .iter()
            .flat_map(|finding| finding.theil.keys())
            .map(String::as_str)
            .collect()
    }

    /// Returns the headings of [`TimeHistories::costs`].
    pub(crate) fn cost_heads(&self) -> Vec<String> {
        let theil = self
            .moved_outputs()
            .into_iter()
            .map(|output| format!("Theil {output}"));
        std::iter::once("J_rms".to_owned()).chain(theil).collect()
    }

    /// Formats `J_rms` of a condition's model, and Theil's coefficient of every output.
    pub(crate) fn costs(&self, condition: ConditionId, role: RequirementRole) -> Vec<String> {
        let theil = self
            .moved_outputs()
            .into_iter()
            .map(|output| self.theil(condition, role, output));
        std::iter::once(self.j_rms(condition, role))
            .chain(theil)
            .map(|value| number(value, 2))
            .collect()
    }

    /// Tabulates `J_rms` and Theil's coefficients over all records of each condition and model.
    pub fn cost_table(&self) -> Table {
        let columns = ["condition", "records", "model"]
            .map(str::to_owned)
            .into_iter()
            .chain(self.cost_heads());
        let mut table = Table::new(
            format!("J_rms and Theil's coefficients; {}", self.weights_words()),
            columns,
        );
        for (condition, records) in self.conditions() {
            for role in RequirementRole::ALL {
                let heads = [
                    condition.to_string(),
                    records.to_string(),
                    role.name().to_owned(),
                ];
                table.row(heads.into_iter().chain(self.costs(condition, role)));
            }
        }
        table
    }

    /// Tabulates the records of a condition against every tolerance: largest excess of each model,
    /// and its time. Rows where every model is inside throughout, and off-axis has the correct
    /// trend, are omitted and counted.
    pub fn record_table(&self, condition: ConditionId) -> Table {
        let heads = ["record", "quantity"].map(str::to_owned);
        let columns = heads
            .into_iter()
            .chain(RequirementRole::ALL.map(|role| format!("{}: inside [%]", role.name())));
        let mut table = Table::new("", columns);
        let of_condition: Vec<&HistoryFinding> = self
            .records
            .iter()
            .filter(|finding| finding.condition == condition)
            .collect();
        let mut all = 0;
        // Two records may have the same name: the roles ascend within each record.
        for of_record in of_condition.chunk_by(|a, b| a.record == b.record && a.role < b.role) {
            for (row, first) in of_record[0].tolerances.iter().enumerate() {
                all += 1;
                let of_role = |role| {
                    of_record
                        .iter()
                        .filter(move |of| of.role == role)
                        .find_map(|of| of.tolerances.get(row))
                };
                let found = RequirementRole::ALL.map(of_role);
                if found
                    .iter()
                    .flatten()
                    .any(|of| of.largest_excess > 0.0 || of.trend == Some(Trend::Opposite))
                {
                    let held_out = if of_record[0].held_out {
                        " (held out)"
                    } else {
                        ""
                    };
                    let heads = [
                        format!("{}{held_out}", of_record[0].record),
                        first.quantity.clone(),
                    ];
                    table.row(
                        heads
                            .into_iter()
                            .chain(found.map(|of| of.map_or("-".to_owned(), excess_words))),
                    );
                }
            }
        }
        table.title = format!(
            "Records of condition {condition}: share of time inside, largest excess beyond the corridor and when; {} of {all} rows, of which \
             every model is always inside, are left out",
            all - table.rows.len()
        );
        table
    }

    /// Describes the weights of the outputs in `J_rms`, and the outputs excluded from it.
    pub fn weights_words(&self) -> String {
        let left_out: BTreeSet<&str> = self
            .records
            .iter()
            .flat_map(|of| &of.j_rms_left_out)
            .map(String::as_str)
            .collect();
        let without = if left_out.is_empty() {
            String::new()
        } else {
            format!("; without {}", Vec::from_iter(left_out).join(", "))
        };
        format!("deg, deg/s, ft/s and ft/s\u{b2} weighing the same{without}")
    }
}

/// Formats a result: "85.2; 0.84 deg/s at 12.3 s; opposite": share of time inside, largest excess,
/// and an incorrect trend.
fn excess_words(of: &ToleranceFinding) -> String {
    let mut words = vec![percent(Some(of.share_inside))];
    if of.largest_excess > 0.0 {
        let at_s = number(Some(of.largest_excess_at_s), 1);
        words.push(format!(
            "{} {} at {at_s} s",
            telling(of.largest_excess, 2),
            of.unit
        ));
    }
    words.extend((of.trend == Some(Trend::Opposite)).then(|| "opposite trend".to_owned()));
    words.join("; ")
}

/// Formats a share in percent, rounded down: 100 means the whole.
pub(crate) fn percent(share: Option<f64>) -> String {
    number(share.map(|share| (1e3 * share).floor() / 10.0), 1)
}

/// Formats a number, or a dash.
fn number(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.digits$}"))
}
