//! What speaks against the recommended model, record by record and channel by channel (M14, section 10).

use super::bundle::{WithoutRecord, distance, median};
use super::channel_delay::channel_delay;
use super::evidence::PreparedData;
use super::polish::Fit;
use super::{FlightRecord, IdentificationCaution, Options, RecordFit, Role, Spectrum};

/// Cost per degree of freedom above which a model is not adequate.
const ADEQUATE: f64 = 1.5;
/// Cost per degree of freedom of a record over that of all above which it is unlike the others.
const UNLIKE: f64 = 1.5;
/// Cost per degree of freedom of held-out records over that of the fit, at most.
const HELD_OUT: f64 = 1.15;
/// Distance of a model without a record over the median of the others above which the record is named.
const DECISIVE: f64 = 10.0;
/// Models without a record among which one can stand out.
const COMPARED: usize = 5;

/// The recommended model and what it is examined with.
pub(super) struct Diagnostics<'a> {
    /// For their names.
    pub(super) records: &'a [FlightRecord],
    /// For names of channels.
    pub(super) options: &'a Options,
    /// What the model was made from.
    pub(super) evidence: &'a PreparedData<'a>,
    /// The model.
    pub(super) fit: &'a Fit,
    /// The models without each record.
    pub(super) without: &'a [WithoutRecord],
}

impl Diagnostics<'_> {
    /// The name of a record.
    pub(super) fn record_name(&self, record: usize) -> String {
        self.records.get(record).map_or_else(String::new, |record| record.name.clone())
    }

    /// What the costs say.
    pub(super) fn adequacy(
        &self,
        cost: f64,
        held_out_cost: Option<f64>,
        fits: &[RecordFit],
        outputs: &[f64],
    ) -> Vec<IdentificationCaution> {
        let mut cautions = Vec::new();
        let fitted = || fits.iter().filter(|fit| !fit.held_out);
        let worst = fitted().max_by(|a, b| a.cost.total_cmp(&b.cost));
        let output = outputs.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(output, _)| output);
        if let Some(worst) = worst.filter(|_| cost > ADEQUATE) {
            let (record, signal) = (self.record_name(worst.record), self.options.signal(Role::Output, output));
            cautions.push(IdentificationCaution::Inadequate { cost, record, signal });
        }
        for fit in fitted().filter(|fit| fit.cost > ADEQUATE.max(UNLIKE * cost)) {
            let name = self.record_name(fit.record);
            cautions.push(IdentificationCaution::UnlikeRecord { record: fit.record, name, cost: fit.cost });
        }
        if let Some(ratio) = held_out_cost.map(|held_out| held_out / cost).filter(|ratio| *ratio > HELD_OUT) {
            cautions.push(IdentificationCaution::HeldOut { ratio });
        }
        cautions
    }

    /// Records without which the model is another.
    pub(super) fn decisive_records(&self, omegas: &[f64], left_out: &[(usize, usize)]) -> Vec<IdentificationCaution> {
        let (outputs, inputs) = self.fit.model.d.shape();
        let pairs = (0..inputs).flat_map(|input| (0..outputs).map(move |output| (output, input)));
        let pairs: Vec<_> = pairs.filter(|pair| !left_out.contains(pair)).collect();
        let of = |one: &WithoutRecord| distance(&one.model, &self.fit.model, omegas, &pairs);
        let distances: Vec<f64> = self.without.iter().map(of).collect();
        if distances.len() < COMPARED {
            return Vec::new();
        }
        let caution = |(k, one): (usize, &WithoutRecord)| {
            let others = distances.iter().enumerate().filter(|(other, _)| *other != k).map(|(_, distance)| *distance);
            let ratio = distances[k] / median(others.collect());
            let (record, name) = (one.record, self.record_name(one.record));
            let stands_out = ratio.is_finite() && ratio > DECISIVE;
            stands_out.then_some(IdentificationCaution::DecisiveRecord { record, name, ratio })
        };
        self.without.iter().enumerate().filter_map(caution).collect()
    }

    /// The channel that seems to be late in a record that the model does not fit, of several the one that explains most: it
    /// spoils the models for the others.
    pub(super) fn late_channel(&self, fits: &[RecordFit]) -> Option<IdentificationCaution> {
        let fitted = fits.iter().filter(|fit| !fit.held_out);
        let least = fitted.map(|fit| fit.cost).fold(f64::INFINITY, f64::min);
        let late = |fit: &RecordFit| {
            let spectra: Vec<&Spectrum> =
                self.evidence.spectra.iter().filter(|spectrum| spectrum.record == fit.record).collect();
            let model = &self.without.iter().find(|one| one.record == fit.record)?.model;
            Some((fit.record, channel_delay(&spectra, &self.evidence.noise, model)?))
        };
        let unlike = fits.iter().filter(|fit| !fit.held_out && fit.cost > UNLIKE * least);
        let (record, late) = unlike.filter_map(late).max_by(|a, b| a.1.gain.total_cmp(&b.1.gain))?;
        let (name, signal) = (self.record_name(record), self.options.signal(late.role, late.index));
        Some(IdentificationCaution::Late { record, name, signal, delay_s: late.delay_s })
    }

    /// Responses that are not identified, in words.
    pub(super) fn unidentified_pairs(&self, pairs: &[(usize, usize)]) -> Option<IdentificationCaution> {
        let named = |&(output, input): &(usize, usize)| {
            [self.options.signal(Role::Output, output), self.options.signal(Role::Input, input)]
        };
        (!pairs.is_empty())
            .then(|| IdentificationCaution::PairsNotIdentified { pairs: pairs.iter().map(named).collect() })
    }
}
