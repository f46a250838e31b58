//! A correction as a table of gains and delays over airspeed, in text.

use std::fmt::Write;

use super::breakpoint_table::{BreakpointColumn, BreakpointTable};
use super::export_fault::ExportFault;
use super::heading::heading;
use super::number::number;
use super::quoted::comment;
use super::scheduled_correction::{NamedCurve, ScheduledCorrection};

/// Writes a table (CSV) of all gains and delays at the airspeeds `breakpoints_kt`, for lookup tables that are linear between them.
/// Lines that begin with # say what it is and how far each column lies from its curve at most.
pub fn table_csv(correction: &ScheduledCorrection, breakpoints_kt: &[f64]) -> Result<String, ExportFault> {
    let table = BreakpointTable::of(correction, breakpoints_kt)?;
    let mut text = String::new();
    for line in heading(correction) {
        let _ = writeln!(text, "# {line}");
    }
    text.push_str(
        "# Greatest error of linear interpolation in this table, end values outside it, against the curves:\n",
    );
    for column in &table.columns {
        let _ = writeln!(text, "# {}: {}", comment(&column.of.words()), column.error_words());
    }
    text.push_str("airspeed [kt]");
    if let Some(second) = &correction.second {
        let _ = write!(text, ",{}", second.words);
    }
    for BreakpointColumn { of, .. } in &table.columns {
        let unit = if of.is_time() { " [s]" } else { " [-]" };
        let NamedCurve { side, kind, name, .. } = of;
        let _ = write!(text, ",\"{kind} of {side} {}{unit}\"", comment(name).replace('"', "\"\""));
    }
    text.push('\n');
    for (row, (airspeed, second)) in table.rows().into_iter().enumerate() {
        text.push_str(&number(airspeed));
        if let Some(second) = second {
            let _ = write!(text, ",{}", number(second));
        }
        for column in &table.columns {
            let _ = write!(text, ",{}", number(column.values[row]));
        }
        text.push('\n');
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::super::curve::Curve;
    use super::super::scheduled_correction::tests::example;
    use super::*;
    use crate::text::read_table;
    use crate::variables::MemoryBudget;

    const POINTS: [f64; 5] = [0.0, 20.0, 40.0, 60.0, 80.0];

    #[test]
    fn the_table_holds_the_curves_at_its_airspeeds() {
        let correction = example();
        let text = table_csv(&correction, &POINTS).unwrap();
        let table = read_table(&text, &MemoryBudget::new(1 << 20, &|_| false)).unwrap();
        assert_eq!(table.columns[0], POINTS);
        assert_eq!(table.columns.len(), 7);
        assert_eq!(table.units[2].as_deref(), Some("s"));
        for (named, column) in correction.curves().zip(&table.columns[1..]) {
            let expected: Vec<f64> = POINTS.iter().map(|&point| named.curve.at(correction.cut(point))).collect();
            assert_eq!(column, &expected);
        }
    }

    #[test]
    fn the_greatest_error_stands_above_the_table() {
        let mut correction = example();
        correction.inputs.truncate(1);
        correction.outputs.clear();
        correction.inputs[0].name = "LAT".to_owned();
        let coefficients = vec![0.0, 0.0, 0.16];
        correction.inputs[0].delay_s = Curve::Polynomial { of_logarithm: false, coefficients };
        let text = table_csv(&correction, &[0.0, 80.0]).unwrap();
        assert!(text.contains("# delay of input LAT: 1.600e2 ms at 40.000 kt"), "{text}");
        assert_eq!(table_csv(&correction, &[]), Err(ExportFault::Breakpoints));
    }
}
