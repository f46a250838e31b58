//! What the columns of a frequency response hold, from their numbers alone.

use super::columns::TextTable;
use super::frequency_columns::{
    FrequencyColumn, FrequencyColumns, FrequencyUnit, MagnitudeUnit, PhaseUnit, RecognisedResponse, ResponseParts,
    unrecognised,
};
use super::response_columns::{ResponseColumns, magnitude_by_numbers, phase_by_numbers};
use crate::text::frequency_columns::is_increasing;
use crate::variables::VariableFault;

/// Decides by the numbers: the first column (or the one named so) is the frequency, pairs of columns behind it are responses, with a
/// coherence behind each pair where every third column lies between 0 and 1. Never certain.
pub(super) fn guess(table: &TextTable) -> Result<FrequencyColumns, VariableFault> {
    let (mut notes, mut certain) = (Vec::new(), false);
    let frequency = frequency(table, &mut notes, &mut certain)?;
    let rest: Vec<usize> = (0..table.columns.len()).filter(|&column| column != frequency.column).collect();
    let size = group_size(table, &rest)?;
    let mut responses = Vec::with_capacity(rest.len() / size);
    for group in rest.chunks_exact(size) {
        let parts = parts(table, group[0], group[1], &mut notes);
        let coherence = group.get(2).copied();
        if let Some(column) = coherence {
            notes.push(format!("column {} is read as coherence: all its numbers lie between 0 and 1", column + 1));
        }
        responses.push(RecognisedResponse { output: None, input: None, parts, coherence });
    }
    Ok(FrequencyColumns { frequency, responses, notes, certain: false })
}

fn frequency(table: &TextTable, notes: &mut Vec<String>, certain: &mut bool) -> Result<FrequencyColumn, VariableFault> {
    if let Ok(frequency) = ResponseColumns::of(table).frequency(table, notes, certain) {
        return Ok(frequency);
    }
    match table.columns.first() {
        Some(values) if is_increasing(values) => {
            notes.push("column 1 is read as the frequency in rad/s: its numbers increase".to_owned());
            Ok(FrequencyColumn { column: 0, unit: FrequencyUnit::RadianPerSecond })
        }
        _ => Err(unrecognised("no frequency")),
    }
}

/// How many columns a response has: 3 with a coherence, else 2.
fn group_size(table: &TextTable, rest: &[usize]) -> Result<usize, VariableFault> {
    let with_coherence = rest.len().is_multiple_of(3)
        && !rest.is_empty()
        && rest.iter().skip(2).step_by(3).all(|&column| is_coherence(&table.columns[column]));
    match rest.len() {
        _ if with_coherence => Ok(3),
        0 => Err(unrecognised("only a frequency")),
        count if count.is_multiple_of(2) => Ok(2),
        _ => Err(unrecognised("no names, and an odd number of columns")),
    }
}

fn is_coherence(values: &[f64]) -> bool {
    values.iter().all(|value| (0.0..=1.0).contains(value))
}

fn parts(table: &TextTable, first: usize, second: usize, notes: &mut Vec<String>) -> ResponseParts {
    let (sizes, angles) = (&table.columns[first], &table.columns[second]);
    let (polar, reason) = looks_polar(sizes, angles);
    let (one, two) = (first + 1, second + 1);
    if !polar {
        notes.push(format!("columns {one} and {two} are read as real and imaginary parts: {reason}"));
        return ResponseParts::Rectangular { re: first, im: second };
    }
    let mut certain = false;
    let (magnitude_unit, size_reason) = magnitude_by_numbers(sizes, &mut certain);
    let (phase_unit, angle_reason) = phase_by_numbers(angles, &mut certain);
    let size = if magnitude_unit == MagnitudeUnit::Decibel { "magnitude in dB" } else { "absolute magnitude" };
    let angle = if phase_unit == PhaseUnit::Degree { "deg" } else { "rad" };
    notes.push(format!("column {one} is read as {size}: {reason}, and {size_reason}"));
    notes.push(format!("column {two} is read as phase in {angle}: {reason}, and {angle_reason}"));
    ResponseParts::Polar { magnitude: first, magnitude_unit, phase: second, phase_unit }
}

/// Whether two columns are rather magnitude and phase than real and imaginary part, and why.
///
/// A phase jumps by a turn where it is wrapped and stays within bounds; an unwrapped one is large compared with decibels, and does
/// not shrink where the magnitude does. Real and imaginary parts cross zero, and grow and shrink together.
fn looks_polar(sizes: &[f64], angles: &[f64]) -> (bool, &'static str) {
    if wraps(angles, 360.0) || wraps(angles, std::f64::consts::TAU) {
        return (true, "the second jumps by a turn");
    }
    let largest = |values: &[f64]| values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let (size, angle) = (largest(sizes), largest(angles));
    let crosses = |values: &[f64]| values.iter().any(|&v| v < 0.0) && values.iter().any(|&v| v > 0.0);
    if fades_together(sizes, angles) {
        return (false, "they shrink together");
    }
    if crosses(sizes) && crosses(angles) && size < 4.0 * angle && angle < 4.0 * size {
        return (false, "both cross zero and are of the same size");
    }
    if angle > 60.0 && angle < 4000.0 && sizes.iter().all(|size| (-200.0..=100.0).contains(size)) {
        return (true, "the second has the range of degrees, the first that of decibels or gains");
    }
    (false, "nothing speaks for magnitude and phase")
}

/// Whether values within one turn jump by nearly a turn between neighbours that are otherwise close.
fn wraps(values: &[f64], turn: f64) -> bool {
    let within = values.iter().all(|value| value.abs() <= 1.001 * turn);
    let spread =
        values.iter().fold(f64::NEG_INFINITY, |a, &b| a.max(b)) - values.iter().fold(f64::INFINITY, |a, &b| a.min(b));
    let jumps = values.windows(2).filter(|pair| (pair[1] - pair[0]).abs() > 0.85 * turn).count();
    within && spread <= 1.001 * turn && jumps > 0 && 5 * jumps <= values.len()
}

/// Whether both columns are, at their smaller end, less than a twentieth of what they are at the other.
fn fades_together(first: &[f64], second: &[f64]) -> bool {
    let part = (first.len() / 8).max(1);
    let mean = |values: &[f64]| values.iter().map(|value| value.abs()).sum::<f64>() / part as f64;
    let ends = |values: &[f64]| (mean(&values[..part]), mean(&values[values.len() - part..]));
    let ((a, b), (c, d)) = (ends(first), ends(second));
    (20.0 * b < a && 20.0 * d < c) || (20.0 * a < b && 20.0 * c < d)
}

#[cfg(test)]
mod tests {
    use super::super::columns::read_table;
    use super::*;
    use crate::variables::MemoryBudget;

    /// A lag of second order with a delay of 0.1 s at 40 frequencies: omega, re, im.
    fn response() -> Vec<(f64, f64, f64)> {
        let omegas = (0..40).map(|index| 0.3 * 100_f64.powf(f64::from(index) / 39.0));
        omegas
            .map(|w| {
                let (size, angle) = (50.0 / (4.0 - w * w).hypot(2.0 * w), -(2.0 * w).atan2(4.0 - w * w) - 0.1 * w);
                (w, size * angle.cos(), size * angle.sin())
            })
            .collect()
    }

    fn recognised(row: impl Fn((f64, f64, f64)) -> String) -> FrequencyColumns {
        let text: String = response().into_iter().map(|point| row(point) + "\n").collect();
        let table = read_table(&text, &MemoryBudget::new(1 << 20, &|_| false)).unwrap();
        FrequencyColumns::recognise(&table).unwrap()
    }

    #[test]
    fn real_and_imaginary_parts_are_told_by_their_range() {
        let found = recognised(|(w, re, im)| format!("{w},{re},{im}"));
        assert_eq!(found.responses[0].parts, ResponseParts::Rectangular { re: 1, im: 2 });
        assert!(!found.certain);
        assert!(found.notes[0].starts_with("column 1 is read as the frequency in rad/s"));
    }

    #[test]
    fn decibels_and_degrees_are_told_wrapped_or_not() {
        let expected = ResponseParts::Polar {
            magnitude: 1,
            magnitude_unit: MagnitudeUnit::Decibel,
            phase: 2,
            phase_unit: PhaseUnit::Degree,
        };
        let db = |re: f64, im: f64| 20.0 * re.hypot(im).log10();
        let wrapped = recognised(|(w, re, im)| format!("{w} {} {}", db(re, im), im.atan2(re).to_degrees()));
        assert_eq!(wrapped.responses[0].parts, expected);
        let unwrapped = recognised(|(w, re, im)| {
            let angle = im.atan2(re);
            let angle = if angle > 0.0 { angle - std::f64::consts::TAU } else { angle };
            format!("{w} {} {}", db(re, im), angle.to_degrees())
        });
        assert_eq!(unwrapped.responses[0].parts, expected);
    }

    #[test]
    fn a_third_column_between_zero_and_one_is_the_coherence() {
        let found = recognised(|(w, re, im)| format!("{w},{re},{im},0.9,{re},{im},0.8"));
        assert_eq!(found.responses.iter().map(|r| r.coherence).collect::<Vec<_>>(), [Some(3), Some(6)]);
    }

    #[test]
    fn what_cannot_be_told_is_refused() {
        let table = |text: &str| read_table(text, &MemoryBudget::new(1 << 20, &|_| false)).unwrap();
        let message = |text: &str| FrequencyColumns::recognise(&table(text)).unwrap_err().to_string();
        assert!(message("1,2\n2,3\n").contains("odd number of columns"));
        assert!(message("2,2,2\n1,3,3\n").contains("no frequency"));
        assert!(message("1\n2\n").contains("only a frequency"));
    }
}
