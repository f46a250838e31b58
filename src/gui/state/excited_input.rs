//! The input that a flight record excites most, found by comparison with the condition's other
//! records: an input's unit and trim have no influence.
//!
//! The record that excites the input in focus is displayed first, unless the engineer has chosen
//! another.

use std::sync::Arc;

use gdcm_model::dataset::condition::RecordKind;
use gdcm_model::simulation::FlightRecord;
use gdcm_sysid::records::LaidOutRecord;

use super::condition_records::{ConditionRecords, RowSearch};

/// Share of the largest standard deviation among the records from which an input counts as
/// excited. A compromise: a larger share would drop smaller sweeps of the input, a smaller one
/// would count records in which the pilot moves it only to compensate.
const EXCITED_SHARE: f64 = 0.5;

/// Excitation of the inputs by a record: each input's standard deviation, relative to the largest
/// among the records, 0 to 1.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Excitation(Vec<f64>);

impl Excitation {
    /// Returns each record's excitation, compared with the other records:
    ///
    /// ```text
    /// s_ri   standard deviation of input i in record r
    /// share of input i in record r = s_ri / max_r s_ri
    /// ```
    pub fn compare_records(flights: &[Arc<FlightRecord>]) -> Vec<Self> {
        let deviations: Vec<Vec<f64>> = flights
            .iter()
            .map(|flight| input_deviations(flight))
            .collect();
        let mut largest_by_input: Vec<f64> = Vec::new();
        for record in &deviations {
            let inputs = largest_by_input.len().max(record.len());
            largest_by_input.resize(inputs, 0.0);
            for (largest, deviation) in largest_by_input.iter_mut().zip(record) {
                *largest = largest.max(*deviation);
            }
        }
        let mut excitations = Vec::with_capacity(flights.len());
        for record in deviations {
            let mut shares = Vec::with_capacity(record.len());
            for (deviation, largest) in record.into_iter().zip(&largest_by_input) {
                let share = if *largest > 0.0 {
                    deviation / largest
                } else {
                    0.0
                };
                shares.push(share);
            }
            excitations.push(Self(shares));
        }
        excitations
    }

    /// Returns whether an input's share is at least `EXCITED_SHARE`.
    pub fn excites(&self, input: usize) -> bool {
        self.share(input) >= EXCITED_SHARE
    }

    /// Returns an input's share, 0 to 1; 0 for an input that the record lacks.
    fn share(&self, input: usize) -> f64 {
        self.0.get(input).copied().unwrap_or(0.0)
    }

    /// Returns the input in focus if it is excited, otherwise the most excited input; `None` if no
    /// input moves.
    pub fn excited_input(&self, focus: usize) -> Option<usize> {
        if self.excites(focus) {
            return Some(focus);
        }
        let mut most_excited = None;
        let mut largest_share = 0.0;
        for (input, share) in self.0.iter().enumerate() {
            if *share > largest_share {
                largest_share = *share;
                most_excited = Some(input);
            }
        }
        most_excited
    }
}

/// Returns each input's standard deviation over its finite samples.
fn input_deviations(flight: &FlightRecord) -> Vec<f64> {
    let mut deviations = Vec::with_capacity(flight.inputs.ncols());
    for column in flight.inputs.column_iter() {
        let samples: Vec<f64> = column
            .iter()
            .copied()
            .filter(|value| value.is_finite())
            .collect();
        let count = samples.len().max(1) as f64;
        let mean = samples.iter().sum::<f64>() / count;
        let variance = samples
            .iter()
            .map(|value| (value - mean).powi(2))
            .sum::<f64>()
            / count;
        deviations.push(variance.sqrt());
    }
    deviations
}

/// A record that excites an input.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    /// Index of the record's row.
    row: usize,
    is_sweep: bool,
    /// The input's share, 0 to 1.
    share: f64,
}

impl Candidate {
    /// Returns whether this record shows the input better: sweeps come before other manoeuvres,
    /// then the largest share counts.
    fn is_better_than(self, other: Self) -> bool {
        if self.is_sweep == other.is_sweep {
            self.share > other.share
        } else {
            self.is_sweep
        }
    }
}

impl ConditionRecords {
    /// Displays the fitted record that shows an input best (`best_row_for_input`), if any. Does
    /// nothing if the engineer has chosen a record, or if the same search was made before.
    pub fn open_on_input(&mut self, input: usize) {
        let search = RowSearch {
            input,
            row_count: self.rows.len(),
        };
        if self.is_chosen || self.latest_search == Some(search) {
            return;
        }
        self.latest_search = Some(search);
        if let Some(row) = self.best_row_for_input(input) {
            self.choose(row);
        }
    }

    /// Returns the row of the fitted record that shows an input best, among those that excite it: a
    /// sweep if there is one, and then the record with the largest share. `None` if no record
    /// excites it.
    fn best_row_for_input(&self, input: usize) -> Option<usize> {
        let rows: Vec<(usize, &LaidOutRecord)> = self.used_rows().collect();
        let flights: Vec<Arc<FlightRecord>> = rows
            .iter()
            .filter_map(|(_, row)| row.flight.clone())
            .collect();
        let excitations = Excitation::compare_records(&flights);
        // The largest share decides among sweeps, because a sweep on another input may excite this
        // one too, by the pilot's compensation.
        let mut best: Option<Candidate> = None;
        for ((index, row), excitation) in rows.into_iter().zip(excitations) {
            if row.guess.held_out || !excitation.excites(input) {
                continue;
            }
            let candidate = Candidate {
                row: index,
                is_sweep: row.guess.kind == RecordKind::Sweep,
                share: excitation.share(input),
            };
            if best.is_none_or(|best| candidate.is_better_than(best)) {
                best = Some(candidate);
            }
        }
        best.map(|best| best.row)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;

    fn record(amplitudes: [f64; 2]) -> Arc<FlightRecord> {
        let samples = 50;
        let inputs = DMatrix::from_fn(samples, 2, |sample, input| {
            100.0 + amplitudes[input] * (0.3 * sample as f64).sin()
        });
        Arc::new(FlightRecord {
            name: "record".to_owned(),
            time_s: (0..samples).map(|sample| 0.02 * sample as f64).collect(),
            outputs: DMatrix::zeros(samples, 1),
            inputs,
        })
    }

    #[test]
    fn the_excited_input_is_found_whatever_the_units() {
        // The second input has a unit in which it always moves more than the first.
        let records = [[1.0, 20.0], [0.1, 100.0], [0.0, 0.0], [0.9, 90.0]].map(record);
        let excitations = Excitation::compare_records(&records);
        let inputs: Vec<[Option<usize>; 2]> = excitations
            .iter()
            .map(|excitation| [0, 1].map(|focus| excitation.excited_input(focus)))
            .collect();
        assert_eq!(
            inputs,
            [
                [Some(0), Some(0)],
                [Some(1), Some(1)],
                [None, None],
                [Some(0), Some(1)]
            ],
            "the input in focus if both are excited"
        );
    }
}
