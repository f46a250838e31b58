//! Tables of couplings, their costs and their poles (M16.4).
//!
//! Couplings are a mixing of the inputs and a feedback from outputs to inputs, fitted to all
//! conditions (M16). *Others* are the off-axis responses. J is the mismatch cost (M4), without a
//! correction (*uncorrected*), with each condition's *own* gains and delays, with those from the
//! schedule over airspeed (*scheduled*), or with couplings and schedule fitted without the
//! condition (*left out*).

use nalgebra::{Complex, DMatrix};

use gdcm_method::couplings::PoleShift;
use gdcm_model::dataset::{Channel, Dataset};
use gdcm_model::number_format::{NO_VALUE, conjugate_pair, counted, with_minus_sign};
use gdcm_model::units::{number, telling};
use gdcm_study::results::correction_costs::{AxisCost, CorrectionCost, CorrectionCosts};
use gdcm_study::results::couplings_assessment::{CouplingEntry, CouplingsAssessment};

use crate::table::Table;

/// Returns the heading: "mixing and feedback fitted to 11 conditions; relative residual of the
/// normal equations 3e-16".
pub fn couplings_heading(assessment: &CouplingsAssessment) -> String {
    format!(
        "{} fitted to {}; relative residual of the normal equations {:.0e}",
        assessment.couplings.name(),
        counted(assessment.fitted.problem.conditions.len(), "condition"),
        assessment.fitted.fit.residual
    )
}

/// Tabulates J on-axis and off-axis, without and with couplings.
pub fn coupling_cost_table(assessment: &CouplingsAssessment) -> Table {
    cost_table(&assessment.costs, AxisCost::default())
}

/// Headings of the table of J in narrow panels: each "with" refers to the column before it.
pub const NARROW_COST_COLUMNS: [&str; 5] = ["mean J", "on-axis", "with", "others", "with"];

/// Tabulates mean J on-axis and off-axis, without and with couplings or physics parameters;
/// `with_uncorrected` is J with these, but without gains and delays.
pub(crate) fn cost_table(costs: &CorrectionCosts, with_uncorrected: AxisCost) -> Table {
    let columns = [
        "mean J",
        "on-axis, without",
        "on-axis, with",
        "others, without",
        "others, with",
    ];
    let mut table = Table::new("", columns);
    let uncorrected = CorrectionCost {
        without: costs.uncorrected,
        with: with_uncorrected,
    };
    table.row(cost_cells("uncorrected", uncorrected));
    table.row(cost_cells("own correction", costs.own));
    table.row(cost_cells("scheduled", costs.scheduled));
    if let Some(left_out) = costs.left_out {
        table.row(cost_cells("condition left out", left_out));
    }
    table
}

fn cost_cells(name: &str, cost: CorrectionCost) -> [String; 5] {
    let cell = |cost: Option<f64>| match cost {
        Some(cost) => format!("{cost:.1}"),
        None => NO_VALUE.to_owned(),
    };
    [
        name.to_owned(),
        cell(cost.without.on_axis),
        cell(cost.with.on_axis),
        cell(cost.without.others),
        cell(cost.with.others),
    ]
}

/// Tabulates the mixing at the mean airspeed and, unless it is zero, the feedback: a row for each
/// receiving input, a column for each input or output that acts on it. An entry that does not
/// exceed its error bar is in brackets.
pub fn coupling_matrix_tables(assessment: &CouplingsAssessment, dataset: &Dataset) -> Vec<Table> {
    let airspeed_kt = assessment.mean_airspeed_kt();
    let (inputs, outputs) = dataset.input_and_output_names();
    let bar_words = if assessment.left_out_fits.is_empty() {
        String::new()
    } else {
        format!(
            ", ± {} % error bar; entries in brackets do not exceed it",
            number(100.0 * assessment.level)
        )
    };
    let title = format!(
        "Mixing at {} kt: share of each input (column) that an input (row) receives{bar_words}",
        telling(airspeed_kt, 0)
    );
    let mixing = assessment.mixing(airspeed_kt);
    let mut tables = vec![matrix_table(title, &inputs, &inputs, &mixing)];
    let feedback = assessment.feedback();
    if feedback.iter().any(|entry| entry.value != 0.0) {
        let to = with_units(&inputs, dataset.inputs());
        let from = with_units(&outputs, dataset.outputs());
        let title = format!(
            "Feedback: units of an input (row) per unit of an output \
            (column){bar_words}"
        );
        tables.push(matrix_table(title, &to, &from, &feedback));
    }
    tables
}

/// Appends each channel's unit to its name: "LON [%]".
fn with_units(names: &[String], channels: &[Channel]) -> Vec<String> {
    names
        .iter()
        .zip(channels)
        .map(|(name, channel)| format!("{name} [{}]", channel.unit))
        .collect()
}

fn matrix_table(
    title: String,
    to: &[String],
    from: &[String],
    entries: &DMatrix<CouplingEntry>,
) -> Table {
    let mut columns = vec!["to".to_owned()];
    columns.extend_from_slice(from);
    let mut table = Table::new(title, columns);
    for (row, name) in to.iter().enumerate() {
        let mut cells = vec![name.clone()];
        cells.extend((0..from.len()).map(|column| entry_words(&entries[(row, column)])));
        table.row(cells);
    }
    table
}

/// Formats an entry: "0.047 ± 0.011"; in brackets if it does not exceed its error bar.
fn entry_words(entry: &CouplingEntry) -> String {
    let mut text = with_minus_sign(&telling(entry.value, 3));
    if let Some(half_width) = entry.half_width
        && half_width > 0.0
    {
        text.push_str(&format!(" ± {}", telling(half_width, 3)));
    }
    if entry.may_be_zero && entry.value != 0.0 {
        format!("({text})")
    } else {
        text
    }
}

/// Tabulates each physics representative's poles without and with couplings; within each condition,
/// the largest shift comes first.
pub fn pole_table(assessment: &CouplingsAssessment) -> Table {
    let columns = [
        "condition",
        "before [rad/s]",
        "after [rad/s]",
        "moved by [rad/s]",
    ];
    let mut table = Table::new(
        "Poles of the physics representatives, without and with couplings",
        columns,
    );
    for (id, condition) in &assessment.conditions {
        let mut shifts: Vec<&PoleShift> = condition.poles.iter().flatten().collect();
        shifts.sort_by(|a, b| {
            b.distance_rad_s()
                .unwrap_or(0.0)
                .total_cmp(&a.distance_rad_s().unwrap_or(0.0))
        });
        for shift in shifts {
            let before = match shift.before {
                Some(before) => pole_cell(before),
                None => NO_VALUE.to_owned(),
            };
            let distance = match shift.distance_rad_s() {
                Some(distance_rad_s) => telling(distance_rad_s, 3),
                None => NO_VALUE.to_owned(),
            };
            table.row([id.to_string(), before, pole_cell(shift.after), distance]);
        }
    }
    table
}

/// Formats a pole in a table: "−0.300 ± j1.200".
fn pole_cell(pole: Complex<f64>) -> String {
    conjugate_pair(pole.re, pole.im, 3)
}
