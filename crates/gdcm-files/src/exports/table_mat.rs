//! A correction as a table of gains and delays over airspeed, for MATLAB.

use super::breakpoint_table::{BreakpointColumn, BreakpointTable};
use super::export_fault::ExportFault;
use super::fields::{Fields, cell_of_texts, column, matrix, scalar, text};
use super::heading::heading;
use super::scheduled_correction::ScheduledCorrection;
use crate::variables::{Value, Variable};

/// The variable `gdcm_table`: the airspeeds `breakpoints_kt`, and for each input and output a column of gains and one of delays \[s\],
/// where there are leads one of their numerators \[s\] too, to be interpolated linearly between them; with the greatest error of that.
pub(super) fn table_variable(
    correction: &ScheduledCorrection,
    breakpoints_kt: &[f64],
) -> Result<Variable, ExportFault> {
    let table = BreakpointTable::of(correction, breakpoints_kt)?;
    let rows = table.rows().len();
    let of = |side: &str, kind: &str| -> Vec<&BreakpointColumn<'_>> {
        table.columns.iter().filter(|column| column.of.side == side && column.of.kind == kind).collect()
    };
    let mut fields = Fields::default();
    fields.add("about", cell_of_texts(heading(correction)));
    fields.add("airspeed_kt", column(table.rows().into_iter().map(|(airspeed, _)| airspeed)));
    if let Some(second) = &correction.second {
        fields.add(second.name, column(table.rows().into_iter().filter_map(|(_, second)| second)));
    }
    for (side, channels) in [("input", &correction.inputs), ("output", &correction.outputs)] {
        fields.add(&format!("{side}s"), cell_of_texts(channels.iter().map(|channel| channel.name.clone())));
        let kinds = [("gain", "gain", "percent"), ("delay", "delay", "ms"), ("lead numerator", "lead_numerator", "ms")];
        for (kind, field, unit) in kinds.into_iter().take(if correction.lead.is_some() { 3 } else { 2 }) {
            let columns = of(side, kind);
            let values = columns.iter().flat_map(|column| column.values.iter().copied()).collect();
            let suffix = if kind == "gain" { "" } else { "_s" };
            fields.add(&format!("{side}_{field}s{suffix}"), matrix(rows, columns.len(), values));
            let errors = columns.iter().map(|column| column.error.error);
            fields.add(&format!("{side}_{field}_error_{unit}"), column_of_row(errors));
        }
    }
    if let Some(lead) = correction.lead {
        fields.add("lead_order", scalar(lead.order as f64));
        fields.add("lead_lag_s", scalar(lead.lag_s));
    }
    fields.add("interpolation", text("linear between the airspeeds, the end values outside"));
    Ok(Variable { name: "gdcm_table".to_owned(), value: fields.record() })
}

fn column_of_row(values: impl Iterator<Item = f64>) -> Value {
    let values: Vec<f64> = values.collect();
    matrix(1, values.len(), values)
}

#[cfg(test)]
mod tests {
    use super::super::scheduled_correction::tests::example;
    use super::*;

    #[test]
    fn each_channel_has_a_column_of_gains_and_one_of_delays() {
        let correction = example();
        let points = [0.0, 30.0, 80.0];
        let Value::Struct(table) = table_variable(&correction, &points).unwrap().value else { panic!("no struct") };
        for (field, curve) in
            [("input_gains", &correction.inputs[1].gain), ("input_delays_s", &correction.inputs[1].delay_s)]
        {
            let Some([Value::Array(array)]) = table.field(field) else { panic!("no {field}") };
            assert_eq!(array.shape, [3, 2]);
            assert_eq!(array.re[3..], points.map(|point| curve.at(correction.cut(point))), "{field}, second column");
        }
        let Some([Value::Array(errors)]) = table.field("output_delay_error_ms") else { panic!("no errors") };
        assert_eq!(errors.shape, [1, 1]);
    }
}
