//! Selects the records from which the order is searched: among many, a part that moves every input
//! (M14.19).

use std::collections::BTreeSet;

use crate::spectra::spectrum::Spectrum;

/// Up to this many records, all are used.
const ALL_UP_TO: usize = 16;
/// With more records, one out of this many is used.
const ONE_OF: usize = 3;
/// Minimum share of each input's power over all records that the used records must hold.
const LEAST_SHARE: f64 = 0.25;

/// Returns the indices of the segments to search the order with, ascending.
///
/// ```text
/// 1  up to 16 records: all segments
/// 2  otherwise every third record
/// 3  for each input whose power over these is below a quarter of its power over all: the records
///    with most of its power are added until it is not
/// ```
///
/// The model at the chosen order is refined over all records afterwards.
pub(crate) fn search_segments(spectra: &[Spectrum]) -> Vec<usize> {
    let mut records: Vec<usize> = spectra.iter().map(|spectrum| spectrum.record).collect();
    records.dedup();
    // Steps 1 and 2.
    let mut used: BTreeSet<usize> = if records.len() <= ALL_UP_TO {
        records.into_iter().collect()
    } else {
        records.into_iter().step_by(ONE_OF).collect()
    };
    // Step 3.
    let inputs = spectra
        .first()
        .map_or(0, |spectrum| spectrum.inputs.nrows());
    for input in 0..inputs {
        add_records_that_move(input, spectra, &mut used);
    }
    let mut segments = Vec::new();
    for (number, spectrum) in spectra.iter().enumerate() {
        if used.contains(&spectrum.record) {
            segments.push(number);
        }
    }
    segments
}

/// Adds the records in which an input has most power until a quarter of its power is used (step 3).
fn add_records_that_move(input: usize, spectra: &[Spectrum], used: &mut BTreeSet<usize>) {
    let mut powers: Vec<(usize, f64)> = Vec::new();
    for spectrum in spectra {
        let power = spectrum.inputs.row(input).norm_squared();
        match powers.last_mut() {
            Some((record, sum)) if *record == spectrum.record => *sum += power,
            _ => powers.push((spectrum.record, power)),
        }
    }
    let whole: f64 = powers.iter().map(|(_, power)| power).sum();
    let mut held: f64 = powers
        .iter()
        .filter(|(record, _)| used.contains(record))
        .map(|(_, power)| power)
        .sum();
    powers.sort_by(|a, b| b.1.total_cmp(&a.1));
    for (record, power) in powers {
        if held >= LEAST_SHARE * whole {
            return;
        }
        if used.insert(record) {
            held += power;
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Complex, DMatrix};

    use super::*;

    /// Returns a record of three inputs for each entry in `moved`, which is the input that it
    /// moves.
    fn records(moved: &[usize]) -> Vec<Spectrum> {
        let spectrum = |(record, input): (usize, &usize)| {
            let mut inputs = DMatrix::zeros(3, 4);
            inputs.row_mut(*input).fill(Complex::from(1.0));
            Spectrum {
                record,
                duration_s: 60.0,
                omega: vec![1.0, 2.0, 3.0, 4.0],
                inputs,
                outputs: DMatrix::zeros(1, 4),
                hats: Vec::new(),
            }
        };
        moved.iter().enumerate().map(spectrum).collect()
    }

    #[test]
    fn few_records_are_all_used() {
        assert_eq!(search_segments(&records(&[0; 16])).len(), 16);
    }

    #[test]
    fn every_input_is_moved_in_the_records_used() {
        // Every third record moves input 0; only two records move input 2.
        let mut moved = [0, 1, 1].repeat(10);
        moved[1] = 2;
        moved[2] = 2;
        let used = search_segments(&records(&moved));
        let count = |input: usize| {
            used.iter()
                .filter(|record| moved[**record] == input)
                .count()
        };
        assert_eq!(count(0), 10);
        assert_eq!(count(1), 5);
        assert_eq!(count(2), 1);
    }
}
