//! A correction as a table of gains and delays over airspeed.

use std::fmt::Write;

use super::export_fault::ExportFault;
use super::number::number;
use super::python_module::heading;
use super::quoted::comment;
use super::scheduled_correction::{NamedCurve, ScheduledCorrection};
use super::table_error::TableError;

/// Writes a table (CSV) of all gains and delays at the airspeeds `breakpoints_kt`, for lookup tables that are linear between them.
/// Lines that begin with # say what it is and how far each column lies from its curve at most.
pub fn table_csv(correction: &ScheduledCorrection, breakpoints_kt: &[f64]) -> Result<String, ExportFault> {
    correction.check()?;
    let increasing = breakpoints_kt.windows(2).all(|pair| pair[0] < pair[1]);
    if breakpoints_kt.len() < 2 || !increasing || !breakpoints_kt.iter().all(|point| point.is_finite()) {
        return Err(ExportFault::Breakpoints);
    }
    let mut text = String::new();
    for line in heading(correction) {
        let _ = writeln!(text, "# {line}");
    }
    text.push_str(
        "# Greatest error of linear interpolation in this table, end values outside it, against the curves:\n",
    );
    for curve in correction.curves() {
        let _ = writeln!(text, "# {}", error_words(correction, breakpoints_kt, &curve));
    }
    text.push_str("airspeed [kt]");
    for NamedCurve { side, kind, name, .. } in correction.curves() {
        let unit = if kind == "delay" { " [s]" } else { " [-]" };
        let _ = write!(text, ",\"{kind} of {side} {}{unit}\"", comment(name).replace('"', "\"\""));
    }
    text.push('\n');
    for &airspeed in breakpoints_kt {
        text.push_str(&number(airspeed));
        let at = correction.cut(airspeed);
        for named in correction.curves() {
            let _ = write!(text, ",{}", number(named.curve.at(at)));
        }
        text.push('\n');
    }
    Ok(text)
}

fn error_words(correction: &ScheduledCorrection, points: &[f64], named: &NamedCurve) -> String {
    let NamedCurve { side, kind, name, curve } = named;
    let truth = |airspeed: f64| curve.at(correction.cut(airspeed));
    let range = correction.airspeed_range_kt;
    let (found, unit) = if *kind == "delay" {
        let milliseconds = |value: f64, truth: f64| 1e3 * (value - truth).abs();
        (TableError::greatest(points, range, truth, milliseconds), "ms")
    } else {
        // Both zero: no error; a table that misses a zero has no error in percent.
        let percent =
            |value: f64, truth: f64| if value == truth { 0.0 } else { 100.0 * ((value - truth) / truth).abs() };
        (TableError::greatest(points, range, truth, percent), "%")
    };
    let place = if found.error > 0.0 { format!(" at {:.3} kt", found.airspeed_kt) } else { String::new() };
    format!("{kind} of {side} {}: {:.3e} {unit}{place}", comment(name), found.error)
}

#[cfg(test)]
mod tests {
    use super::super::scheduled_correction::tests::example;
    use super::*;
    use crate::io::text::read_table;
    use crate::io::variables::Meter;

    const POINTS: [f64; 5] = [0.0, 20.0, 40.0, 60.0, 80.0];

    #[test]
    fn the_table_holds_the_curves_at_its_airspeeds() {
        let correction = example();
        let text = table_csv(&correction, &POINTS).unwrap();
        let table = read_table(&text, &Meter::new(1 << 20, &|| false)).unwrap();
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
        let parabola = vec![0.0, 0.0, 0.16];
        correction.inputs[0].delay_s =
            super::super::Curve::Polynomial { of_logarithm: false, coefficients: parabola, least: None, most: None };
        let text = table_csv(&correction, &[0.0, 80.0]).unwrap();
        assert!(text.contains("# delay of input LAT: 1.600e2 ms at 40.000 kt"), "{text}");
        assert_eq!(table_csv(&correction, &[1.0]), Err(ExportFault::Breakpoints));
    }
}
