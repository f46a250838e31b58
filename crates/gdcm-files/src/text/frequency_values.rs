//! The numbers of a frequency response, out of the columns of a table.

use super::columns::{TextTable, line_fault};
use super::frequency_columns::{
    FrequencyColumns, FrequencyUnit, MagnitudeUnit, PhaseUnit, RecognisedResponse, ResponseParts, unrecognised,
};
use super::response_columns::place;
use crate::variables::VariableFault;

/// A frequency response, point by point.
#[derive(Clone, Debug, PartialEq)]
pub struct ResponsePoints {
    /// Frequencies \[rad/s\], strictly increasing.
    pub omega: Vec<f64>,
    /// Real parts.
    pub re: Vec<f64>,
    /// Imaginary parts.
    pub im: Vec<f64>,
    /// Coherence as it stands in the table, NaN where it is missing.
    pub coherence: Option<Vec<f64>>,
    /// Rows in which this response has no numbers at all, as others in the table do; they are left out.
    pub left_out: usize,
}

impl FrequencyColumns {
    /// The points of every response, in rad/s and as complex numbers.
    ///
    /// A frequency that is missing, negative, or not above the one before is refused with its line, and so is half a number.
    pub fn values(&self, table: &TextTable) -> Result<Vec<ResponsePoints>, VariableFault> {
        let omega = self.omega(table)?;
        self.responses.iter().map(|response| points(table, response, &omega)).collect()
    }

    fn omega(&self, table: &TextTable) -> Result<Vec<f64>, VariableFault> {
        let column = column(table, self.frequency.column)?;
        let place = place(table, self.frequency.column);
        let mut before = f64::NEG_INFINITY;
        for (&value, &line) in column.iter().zip(&table.lines) {
            let fault = |what: &str| Err(line_fault(line, format!("the frequency in {place} {what}")));
            if !value.is_finite() {
                return fault("is missing or infinite; complete it or take the line out");
            }
            if value < 0.0 {
                return fault(&format!("is negative ({value}); take the line out"));
            }
            if value == before {
                return fault(&format!("stands twice ({value}); take one of the lines out"));
            }
            if value < before {
                return fault(&format!(
                    "is below the one before ({value} after {before}); sort the lines by frequency"
                ));
            }
            before = value;
        }
        let factor = match self.frequency.unit {
            FrequencyUnit::RadianPerSecond => 1.0,
            FrequencyUnit::Hertz => std::f64::consts::TAU,
        };
        Ok(column.iter().map(|value| factor * value).collect())
    }
}

/// A column that a person may have chosen.
fn column(table: &TextTable, index: usize) -> Result<&[f64], VariableFault> {
    table.columns.get(index).map(Vec::as_slice).ok_or_else(|| unrecognised(&format!("no column {}", index + 1)))
}

fn points(table: &TextTable, response: &RecognisedResponse, omega: &[f64]) -> Result<ResponsePoints, VariableFault> {
    let (first, second) = response.parts.columns();
    let (first_values, second_values) = (column(table, first)?, column(table, second)?);
    let coherence = response.coherence.map(|index| column(table, index)).transpose()?;
    let mut points = ResponsePoints {
        omega: Vec::with_capacity(omega.len()),
        re: Vec::with_capacity(omega.len()),
        im: Vec::with_capacity(omega.len()),
        coherence: coherence.map(|_| Vec::with_capacity(omega.len())),
        left_out: 0,
    };
    for (row, (&omega, &line)) in omega.iter().zip(&table.lines).enumerate() {
        if first_values[row].is_nan() && second_values[row].is_nan() {
            points.left_out += 1;
            continue;
        }
        for (value, index) in [(first_values[row], first), (second_values[row], second)] {
            if !value.is_finite() {
                let what =
                    format!("{} has no finite number; complete it or empty its other half too", place(table, index));
                return Err(line_fault(line, what));
            }
        }
        let (re, im) = complex_at(table, response.parts, row);
        if !(re.is_finite() && im.is_finite()) {
            let what = format!("{} is too large for a magnitude; is it in dB?", place(table, first));
            return Err(line_fault(line, what));
        }
        points.omega.push(omega);
        points.re.push(re);
        points.im.push(im);
        if let (Some(all), Some(values)) = (&mut points.coherence, coherence) {
            all.push(values[row]);
        }
    }
    Ok(points)
}

impl ResponseParts {
    fn columns(self) -> (usize, usize) {
        match self {
            ResponseParts::Polar { magnitude, phase, .. } => (magnitude, phase),
            ResponseParts::Rectangular { re, im } => (re, im),
        }
    }
}

/// Real and imaginary part in a row of a table that has the columns.
pub(super) fn complex_at(table: &TextTable, parts: ResponseParts, row: usize) -> (f64, f64) {
    let at = |column: usize| table.columns[column][row];
    match parts {
        ResponseParts::Rectangular { re, im } => (at(re), at(im)),
        ResponseParts::Polar { magnitude, magnitude_unit, phase, phase_unit } => {
            let size = match magnitude_unit {
                MagnitudeUnit::Decibel => 10_f64.powf(at(magnitude) / 20.0),
                MagnitudeUnit::Absolute => at(magnitude),
            };
            let angle = match phase_unit {
                PhaseUnit::Degree => at(phase).to_radians(),
                PhaseUnit::Radian => at(phase),
            };
            (size * angle.cos(), size * angle.sin())
        }
    }
}

/// Whether numbers can be frequencies: none negative, each above the one before.
pub(super) fn is_increasing(values: &[f64]) -> bool {
    values.first().is_some_and(|&first| first >= 0.0) && values.windows(2).all(|pair| pair[0] < pair[1])
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::columns::read_table;
    use super::*;
    use crate::variables::MemoryBudget;

    fn values(text: &str) -> Result<Vec<ResponsePoints>, VariableFault> {
        let table = read_table(text, &MemoryBudget::new(1 << 20, &|_| false)).unwrap();
        FrequencyColumns::recognise(&table).unwrap().values(&table)
    }

    #[test]
    fn hertz_decibels_and_degrees_become_complex_numbers_over_radians_per_second() {
        let points = values("f [Hz],mag [dB],phase [deg],coh\n1,20,-90,0.5\n2,0,180,1\n").unwrap().remove(0);
        assert_eq!(points.omega, [std::f64::consts::TAU, 2.0 * std::f64::consts::TAU]);
        assert!((points.im[0] + 10.0).abs() < 1e-14 && points.re[0].abs() < 1e-14);
        assert!((points.re[1] + 1.0).abs() < 1e-14);
        assert_eq!(points.coherence.unwrap(), [0.5, 1.0]);
    }

    #[test]
    fn frequencies_out_of_order_are_refused_with_their_line() {
        let message = |frequencies: [&str; 3]| {
            let rows: String = frequencies.iter().map(|omega| format!("{omega},1,2\n")).collect();
            values(&format!("omega,re,im\n{rows}")).unwrap_err().to_string()
        };
        let start = "the frequency in column 1 (\"omega\")";
        assert_eq!(message(["1", "2", "2"]), format!("line 4: {start} stands twice (2); take one of the lines out"));
        assert!(message(["1", "3", "2"]).starts_with(&format!("line 4: {start} is below the one before (2 after 3)")));
        assert!(message(["1", "", "2"]).starts_with(&format!("line 3: {start} is missing")));
        assert!(message(["-1", "1", "2"]).starts_with(&format!("line 2: {start} is negative")));
    }

    #[test]
    fn a_response_may_miss_rows_but_not_half_a_number() {
        let points = values("omega,re a,im a,re b,im b\n1,1,2,,\n2,1,2,3,4\n").unwrap();
        assert_eq!((points[0].left_out, points[1].left_out), (0, 1));
        assert_eq!(points[1].omega, [2.0]);
        let half = values("omega,re,im\n1,1,2\n2,1,\n").unwrap_err().to_string();
        assert!(half.starts_with("line 3: column 3 (\"im\") has no finite number"), "{half}");
    }

    #[test]
    fn a_chosen_column_that_is_not_there_is_refused() {
        let table = read_table("omega,re,im\n1,1,2\n2,1,2\n", &MemoryBudget::new(1 << 20, &|_| false)).unwrap();
        let mut columns = FrequencyColumns::recognise(&table).unwrap();
        columns.frequency.column = 7;
        assert!(columns.values(&table).unwrap_err().to_string().contains("no column 8"));
    }

    proptest! {
        #[test]
        fn rectangular_numbers_come_back_to_the_last_digit(numbers in prop::collection::vec((-1e9..1e9, -1e9..1e9), 2..20)) {
            let rows: String =
                numbers.iter().enumerate().map(|(row, (re, im))| format!("{};{re:e};{im:e}\n", row + 1)).collect();
            let points = values(&format!("w;Re;Im\n{rows}")).unwrap().remove(0);
            let back: Vec<(f64, f64)> = points.re.iter().copied().zip(points.im.iter().copied()).collect();
            prop_assert_eq!(back, numbers);
        }
    }
}
