//! Time histories within tolerances, as tables (M17.2).

use crate::dataset::ConditionId;
use crate::units::telling;

use super::{HistoryFinding, RequirementRole, Table, TimeHistories, ToleranceFinding};

/// Samples inside, and all of them.
type Counted = (f64, f64);

impl TimeHistories {
    /// The conditions that have records, in the order of their records.
    pub fn conditions(&self) -> Vec<ConditionId> {
        let mut conditions: Vec<ConditionId> = self.records.iter().map(|finding| finding.condition).collect();
        conditions.dedup();
        conditions
    }

    /// The findings of a condition and a role.
    pub fn of_role(&self, condition: ConditionId, role: RequirementRole) -> impl Iterator<Item = &HistoryFinding> {
        self.records.iter().filter(move |of| (of.condition, of.role) == (condition, role))
    }

    /// Share of the samples of all records of a condition that are inside a tolerance, 0 to 1.
    pub fn share_inside(&self, condition: ConditionId, role: RequirementRole, quantity: &str) -> Option<f64> {
        let counted = self.of_role(condition, role).filter_map(|finding| {
            let of = finding.tolerances.iter().find(|of| of.quantity == quantity)?;
            Some((of.share_inside * finding.samples as f64, finding.samples as f64))
        });
        let (inside, samples): Counted = counted.fold((0.0, 0.0), |sum, of| (sum.0 + of.0, sum.1 + of.1));
        (samples > 0.0).then(|| inside / samples)
    }

    /// `J_rms` of all records of a condition: the root of the mean square over their samples.
    pub fn j_rms(&self, condition: ConditionId, role: RequirementRole) -> Option<f64> {
        let squares = self.of_role(condition, role).filter_map(|finding| {
            let samples = finding.samples as f64;
            Some((finding.j_rms?.powi(2) * samples, samples))
        });
        let (squares, samples): Counted = squares.fold((0.0, 0.0), |sum, of| (sum.0 + of.0, sum.1 + of.1));
        (samples > 0.0).then(|| (squares / samples).sqrt())
    }

    /// The rows of the table of tolerances that were applied, in its order.
    fn quantities(&self) -> Vec<&str> {
        let rows = self.tolerance_table.rows().iter().map(|row| row.quantity.as_str());
        let is_applied =
            |name: &&str| self.records.iter().any(|finding| finding.tolerances.iter().any(|of| of.quantity == **name));
        rows.filter(is_applied).collect()
    }

    /// Share of time inside each tolerance over all records of every condition and model, and `J_rms`.
    pub fn share_table(&self) -> Table {
        let quantities = self.quantities();
        let columns = ["condition", "model", "records"].into_iter().chain(quantities.iter().copied());
        let mut table = Table::new("Share of time inside the tolerances [%]", columns.chain(["J_rms"]));
        for condition in self.conditions() {
            for role in RequirementRole::ALL {
                let records = self.of_role(condition, role).count();
                if records == 0 {
                    continue;
                }
                let share = |name: &&str| number(self.share_inside(condition, role, name).map(|of| 100.0 * of), 0);
                let head = [condition.to_string(), role.name().to_owned(), records.to_string()];
                let cells = head.into_iter().chain(quantities.iter().map(share));
                table.row(cells.chain([number(self.j_rms(condition, role), 2)]));
            }
        }
        table
    }

    /// Every record of a condition against every tolerance, model by model.
    pub fn record_table(&self, condition: ConditionId) -> Table {
        let columns = ["record", "quantity", "model", "inside [%]", "largest excess", "at [s]", "off-axis trend"];
        let mut table = Table::new(format!("Time histories of condition {condition}"), columns);
        let of_condition: Vec<&HistoryFinding> =
            self.records.iter().filter(|finding| finding.condition == condition).collect();
        for of_record in of_condition.chunk_by(|a, b| a.record == b.record) {
            for (row, quantity) in of_record[0].tolerances.iter().enumerate() {
                for finding in of_record {
                    table.row(record_cells(finding, &finding.tolerances[row], &quantity.quantity));
                }
            }
        }
        table
    }
}

fn record_cells(finding: &HistoryFinding, of: &ToleranceFinding, quantity: &str) -> [String; 7] {
    let held_out = if finding.held_out { " (held out)" } else { "" };
    [
        format!("{}{held_out}", finding.record),
        quantity.to_owned(),
        finding.role.name().to_owned(),
        number(Some(100.0 * of.share_inside), 1),
        if of.largest_excess > 0.0 { format!("{} {}", telling(of.largest_excess, 2), of.unit) } else { "none".into() },
        number(Some(of.largest_excess_at_s), 1),
        of.trend.map_or("", super::Trend::name).to_owned(),
    ]
}

/// A number, or a dash.
fn number(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.digits$}"))
}
