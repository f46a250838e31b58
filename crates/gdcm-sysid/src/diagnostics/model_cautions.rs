//! Cautions about the recommended model, for each record and each response (M14.10, M14.17).

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::simulation::FlightRecord;

use super::cautions::IdentificationCaution;
use super::departure::{Departure, MeasuredData, predict_points};
use super::record_fits::{RecordFit, RecordFits};
use crate::likelihood::descent::Fit;
use crate::options::Options;

/// Cost per degree of freedom above which a model is not adequate (M14.6); 1 if only noise remains.
const ADEQUATE: f64 = 1.5;
/// Ratio between a record's cost per degree of freedom and that over all fitted records above which
/// the record is unlike the others: the ratio from which records are weighed by their own noise.
const UNLIKE: f64 = 1.5;
/// Normalised cost up to which held-out records are predicted well. See [`NOT_PREDICTED`].
pub const PREDICTED_WELL: f64 = 1.3;
/// Normalised cost above which held-out records are not predicted (M14.17).
///
/// The normalised cost is the held-out cost per degree of freedom with the model free to move
/// within its uncertainty, because a short fit that predicts a loud record badly need not be wrong:
///
/// ```text
/// (e'e - g' (Cov^-1 + G_o)^-1 g) / dof
/// ```
///
/// with the whitened residual `e` of the held-out records, their normal equations `G_o`, `g`, and
/// the covariance `Cov` of the model's parameters.
pub const NOT_PREDICTED: f64 = 2.0;

/// The recommended model, with the data from which cautions about it are derived.
pub(crate) struct ModelCautions<'a> {
    pub(crate) records: &'a [FlightRecord],
    pub(crate) options: &'a Options,
    pub(crate) data: MeasuredData<'a>,
    pub(crate) fit: &'a Fit,
}

impl ModelCautions<'_> {
    /// Returns a record's name; empty if it does not exist.
    pub(crate) fn record_name(&self, record: usize) -> String {
        self.records
            .get(record)
            .map_or_else(String::new, |record| record.name.clone())
    }

    /// Returns cautions about costs per degree of freedom beyond their limits:
    ///
    /// - over all fitted records, above [`ADEQUATE`];
    /// - in a fitted record, above [`ADEQUATE`] and above [`UNLIKE`] times the cost over all;
    /// - over the held-out records, normalised, above [`NOT_PREDICTED`].
    pub(crate) fn adequacy(&self, fits: &RecordFits) -> Vec<IdentificationCaution> {
        let (held_out, fitted): (Vec<&RecordFit>, Vec<&RecordFit>) =
            fits.records.iter().partition(|fit| fit.held_out);
        let mut cautions = Vec::new();
        let worst = fitted.iter().max_by(|a, b| a.cost.total_cmp(&b.cost));
        if let Some(worst) = worst
            && fits.cost > ADEQUATE
        {
            cautions.push(IdentificationCaution::Inadequate {
                cost: fits.cost,
                record: self.record_name(worst.record),
                signal: self
                    .options
                    .signal(ChannelSide::Output, last_index_of_maximum(&fits.outputs)),
            });
        }
        for fit in fitted {
            if fit.cost > ADEQUATE.max(UNLIKE * fits.cost) {
                cautions.push(IdentificationCaution::UnlikeRecord {
                    record: fit.record,
                    name: self.record_name(fit.record),
                    cost: fit.cost,
                });
            }
        }
        if let Some(cost) = fits.held_out
            && cost.normalised > NOT_PREDICTED
        {
            cautions.push(IdentificationCaution::HeldOut {
                records: held_out
                    .iter()
                    .map(|fit| self.record_name(fit.record))
                    .collect(),
                raw: cost.raw,
                normalised: cost.normalised,
            });
        }
        cautions
    }

    /// Returns the caution about responses that are not identified; `pairs` are outputs and inputs.
    pub(crate) fn unidentified_pairs(
        &self,
        pairs: &[(usize, usize)],
    ) -> Option<IdentificationCaution> {
        if pairs.is_empty() {
            return None;
        }
        let mut signals = Vec::with_capacity(pairs.len());
        for &(output, input) in pairs {
            signals.push([
                self.options.signal(ChannelSide::Output, output),
                self.options.signal(ChannelSide::Input, input),
            ]);
        }
        Some(IdentificationCaution::PairsNotIdentified(signals))
    }

    /// Returns a caution for each response that departs from its measured points.
    pub(crate) fn departures(&self) -> Vec<IdentificationCaution> {
        let (outputs, inputs) = self.fit.model.d().shape();
        let predicted = predict_points(&self.fit.model, &self.data, self.options);
        let mut cautions = Vec::new();
        for input in 0..inputs {
            for output in 0..outputs {
                let departure = Departure::measure(
                    &predicted,
                    self.data.measured,
                    self.options.band,
                    (output, input),
                );
                if let Some(band) = departure.band {
                    cautions.push(IdentificationCaution::LeavesPoints {
                        output: self.options.signal(ChannelSide::Output, output),
                        input: self.options.signal(ChannelSide::Input, input),
                        band: band.ends,
                        strength: band.strength,
                    });
                }
            }
        }
        cautions
    }
}

/// Returns the last index of the maximum; 0 if `values` is empty.
fn last_index_of_maximum(values: &[f64]) -> usize {
    let greatest = values.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
    greatest.map_or(0, |(place, _)| place)
}
