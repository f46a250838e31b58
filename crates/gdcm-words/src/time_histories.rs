//! Tables that compare time histories within tolerances (M17.2).
//!
//! A tolerance forms a corridor about the measured output. `J_rms` is the weighted root mean square
//! of the error, Theil's coefficient the error relative to the signals, 0 to 1 (M17.4). A role is a
//! version of the model: physics, corrected, scheduled or identified.

use std::collections::BTreeSet;

use gdcm_method::requirements::Tolerance;
use gdcm_model::dataset::ConditionId;
use gdcm_model::number_format::{NO_VALUE, decimals_or_dash, with_minus_sign};
use gdcm_model::units::{number, telling};
use gdcm_study::results::record_comparison::Trend;
use gdcm_study::results::record_history::RecordHistory;
use gdcm_study::results::requirement_role::RequirementRole;
use gdcm_study::results::time_histories::{HistoryFinding, TimeHistories, ToleranceFinding};

use crate::table::Table;

/// Tabulates the share of time inside each tolerance over each condition's records, for every
/// model.
pub fn share_table(histories: &TimeHistories) -> Table {
    let mut columns = ["condition", "records", "quantity"]
        .map(str::to_owned)
        .to_vec();
    columns.extend(RequirementRole::ALL.map(|role| format!("{} [%]", role.name())));
    let mut table = Table::new("Share of time inside the tolerances", columns);
    for (condition, records) in histories.conditions() {
        for quantity in histories.quantities() {
            let mut cells = vec![
                condition.to_string(),
                records.to_string(),
                quantity.to_owned(),
            ];
            for role in RequirementRole::ALL {
                cells.push(percent_rounded_down(
                    histories.share_inside(condition, role, quantity),
                ));
            }
            table.row(cells);
        }
    }
    table
}

/// Returns the headings above [`cost_cells`].
pub(crate) fn cost_heads(histories: &TimeHistories) -> Vec<String> {
    let mut heads = vec!["J_rms".to_owned()];
    for output in histories.moved_outputs() {
        heads.push(format!("Theil {output}"));
    }
    heads
}

/// Formats a model's `J_rms`, and Theil's coefficient for each output in
/// [`TimeHistories::moved_outputs`].
pub(crate) fn cost_cells(
    histories: &TimeHistories,
    condition: ConditionId,
    role: RequirementRole,
) -> Vec<String> {
    let mut cells = vec![decimals_or_dash(histories.j_rms(condition, role), 2)];
    for output in histories.moved_outputs() {
        cells.push(decimals_or_dash(
            histories.theil(condition, role, output),
            2,
        ));
    }
    cells
}

/// Tabulates `J_rms` and Theil's coefficients over all records, by condition and model.
pub fn history_cost_table(histories: &TimeHistories) -> Table {
    let mut columns = ["condition", "records", "model"]
        .map(str::to_owned)
        .to_vec();
    columns.extend(cost_heads(histories));
    let title = format!(
        "J_rms and Theil's coefficients; {}",
        output_weights_text(histories)
    );
    let mut table = Table::new(title, columns);
    for (condition, records) in histories.conditions() {
        for role in RequirementRole::ALL {
            let mut cells = vec![
                condition.to_string(),
                records.to_string(),
                role.name().to_owned(),
            ];
            cells.extend(cost_cells(histories, condition, role));
            table.row(cells);
        }
    }
    table
}

/// Tabulates a condition's records for every tolerance: each model's share of time inside, and its
/// largest excess with the time. Rows in which every model stays inside, with the correct trend
/// off-axis, are omitted and counted.
pub fn record_table(histories: &TimeHistories, condition: ConditionId) -> Table {
    let mut columns = ["record", "quantity"].map(str::to_owned).to_vec();
    columns.extend(RequirementRole::ALL.map(|role| format!("{}: inside [%]", role.name())));
    let mut table = Table::new("", columns);
    let findings: Vec<&HistoryFinding> = histories
        .records
        .iter()
        .filter(|finding| finding.condition == condition)
        .collect();
    let mut row_count = 0;
    // Two records may have the same name; a new record starts where the role does not increase.
    for models in findings.chunk_by(|a, b| a.record == b.record && a.role < b.role) {
        let held_out = if models[0].held_out {
            " (held out)"
        } else {
            ""
        };
        for (row, first) in models[0].tolerances.iter().enumerate() {
            row_count += 1;
            let found = RequirementRole::ALL.map(|role| finding_of_role(models, role, row));
            if !found
                .iter()
                .flatten()
                .any(|finding| is_exceptional(finding))
            {
                continue;
            }
            let mut cells = vec![
                format!("{}{held_out}", models[0].record),
                first.quantity.clone(),
            ];
            cells.extend(found.map(|finding| match finding {
                Some(finding) => excess_words(finding),
                None => NO_VALUE.to_owned(),
            }));
            table.row(cells);
        }
    }
    table.title = format!(
        "Records of condition {condition}: share of time inside, and largest excess beyond the \
        corridor with its time; rows omitted, because every model is always inside: {} of \
        {row_count}",
        row_count - table.rows.len()
    );
    table
}

/// Returns the result for the model in a role, in a tolerance row; `None` without such a model.
fn finding_of_role<'a>(
    models: &[&'a HistoryFinding],
    role: RequirementRole,
    row: usize,
) -> Option<&'a ToleranceFinding> {
    models
        .iter()
        .filter(|finding| finding.role == role)
        .find_map(|finding| finding.tolerances.get(row))
}

/// Returns whether a model leaves its corridor, or has the opposite trend.
fn is_exceptional(finding: &ToleranceFinding) -> bool {
    finding.largest_excess > 0.0 || finding.trend == Some(Trend::Opposite)
}

/// Describes the output weights in `J_rms`, and the outputs excluded from it.
pub fn output_weights_text(histories: &TimeHistories) -> String {
    let mut excluded: BTreeSet<&str> = BTreeSet::new();
    for finding in &histories.records {
        excluded.extend(finding.j_rms_left_out.iter().map(String::as_str));
    }
    let without = if excluded.is_empty() {
        String::new()
    } else {
        format!("; without {}", Vec::from_iter(excluded).join(", "))
    };
    format!("equal weights for deg, deg/s, ft/s and ft/s\u{b2}{without}")
}

/// Formats a result: share of time inside \[%\], largest excess, and the trend if it is incorrect:
/// "85.2; 0.84 deg/s at 12.3 s; opposite trend".
fn excess_words(finding: &ToleranceFinding) -> String {
    let mut words = vec![percent_rounded_down(Some(finding.share_inside))];
    if finding.largest_excess > 0.0 {
        words.push(format!(
            "{} {} at {:.1} s",
            telling(finding.largest_excess, 2),
            finding.unit,
            finding.largest_excess_at_s
        ));
    }
    if finding.trend == Some(Trend::Opposite) {
        words.push("opposite trend".to_owned());
    }
    words.join("; ")
}

/// Describes a tolerance: "±10 % or ±3 deg/s".
pub fn tolerance_text(tolerance: &Tolerance) -> String {
    let absolute = format!("±{} {}", number(tolerance.absolute), tolerance.unit);
    match tolerance.relative {
        Some(relative) => format!("±{} % or {absolute}", number(100.0 * relative)),
        None => absolute,
    }
}

/// Tabulates a record: share of time inside, largest excess and its time, for each quantity and
/// model; off-axis also whether the trend is correct.
pub fn record_history_table(history: &RecordHistory) -> Table {
    let columns = [
        "quantity",
        "tolerance",
        "entry",
        "model",
        "inside [%]",
        "largest excess",
        "at [s]",
        "off-axis trend",
        "correlation",
    ];
    let held_out = if history.held_out { ", held out" } else { "" };
    let title = format!("{}{held_out}: within tolerances", history.record);
    let mut table = Table::new(title, columns);
    for quantity in &history.quantities {
        for (role, check) in &quantity.models {
            let excess = check.worst().filter(|worst| worst.largest_excess > 0.0);
            let (excess, excess_at_s) = match excess {
                Some(worst) => (
                    format!("{} {}", telling(worst.largest_excess, 2), quantity.unit),
                    telling(worst.largest_excess_at_s, 1),
                ),
                None => ("none".to_owned(), String::new()),
            };
            let correlation = check.correlation();
            let trend = match Trend::from_correlation(correlation, quantity.on_axis) {
                Some(trend) => trend.name().to_owned(),
                None => String::new(),
            };
            let correlation = match correlation {
                Some(correlation) => with_minus_sign(&telling(correlation, 2)),
                None => String::new(),
            };
            table.row([
                quantity.tolerance.quantity.clone(),
                tolerance_text(&quantity.tolerance),
                quantity.tolerance.entry.clone(),
                role.name().to_owned(),
                percent_rounded_down(Some(check.share_inside())),
                excess,
                excess_at_s,
                trend,
                correlation,
            ]);
        }
    }
    table
}

/// Formats a share in percent, rounded down: only the whole is displayed as 100.
pub(crate) fn percent_rounded_down(share: Option<f64>) -> String {
    decimals_or_dash(share.map(|share| (1e3 * share).floor() / 10.0), 1)
}
