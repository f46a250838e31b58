//! Identification options (M14.9).
//!
//! *Laguerre poles* and *past windows* are settings of the subspace method (M14.3): the time scale
//! of the functions on which it projects the signals, and how many projections predict the next.

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::simulation::{FlightRecord, Signal};

use crate::identification_error::{HIGHEST_ORDER, IdentificationError, LONGEST_PAST};
use crate::spectra::preparation_settings::Preparation;

/// Lowest spectral line used, relative to the lower end of the band. Lines beyond both ends support
/// the fit at the ends from either side.
const LOWEST_LINE: f64 = 0.5;
/// Highest spectral line used, relative to the upper end of the band. A higher line would need
/// faster sampling: filters and minimum sample rate are multiples of it (M14.1, M14.11).
const HIGHEST_LINE: f64 = 4.0 / 3.0;

/// The band, the channels, the held-out records, and the orders, poles and windows to try.
///
/// M14.9 lists the defaults. They were chosen on five conditions of the example, and confirmed on
/// the other six, on fresh noise and on half the data.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Lower and upper end of the band \[rad/s\].
    pub band: [f64; 2],
    /// The channels and their preparation.
    pub preparation: Preparation,
    /// How many references follow the model inputs: recorded signals that drove the loop from
    /// outside and are no part of the model (M14.15).
    pub references: usize,
    /// Records reserved for validation, by index from 0: no model is fitted to them.
    pub held_out: Vec<usize>,
    /// Orders to try; `None` for all that the amount of data allows (M14.13).
    pub orders: Option<Vec<usize>>,
    /// Laguerre poles to try, relative to the upper end of the band.
    pub poles: Vec<f64>,
    /// Past windows to try, in Laguerre projections; `None` for the windows that the amount of data
    /// allows (M14.13).
    pub pasts: Option<Vec<usize>>,
}

impl Options {
    /// Creates the default options for a band \[rad/s\] and channels.
    #[must_use]
    pub fn new(band: [f64; 2], preparation: Preparation) -> Self {
        Self {
            band,
            preparation,
            references: 0,
            held_out: Vec::new(),
            orders: None,
            poles: vec![0.375, 0.54, 0.75],
            pasts: None,
        }
    }

    /// Returns an error for invalid options.
    pub(crate) fn check(&self) -> Result<(), IdentificationError> {
        let [lowest, highest] = self.band;
        if !(lowest.is_finite() && highest.is_finite() && 0.0 < lowest && lowest < highest) {
            return Err(IdentificationError::Band { lowest, highest });
        }
        if self.inputs() == 0 && self.references > 0 {
            return Err(IdentificationError::OnlyReferences);
        }
        let poles_are_valid = !self.poles.is_empty()
            && self
                .poles
                .iter()
                .all(|pole| pole.is_finite() && *pole > 0.0);
        if is_within(&self.orders, HIGHEST_ORDER)
            && is_within(&self.pasts, LONGEST_PAST)
            && poles_are_valid
        {
            Ok(())
        } else {
            Err(IdentificationError::Settings)
        }
    }

    /// Counts the model inputs, without references.
    pub(crate) fn inputs(&self) -> usize {
        self.preparation
            .inputs
            .len()
            .saturating_sub(self.references)
    }

    /// Names the records to which a model is fitted. `without` is the record, by index, that a
    /// model in the bundle leaves out (M14.5); `None` for a model fitted to all.
    pub(crate) fn fitted_records(
        &self,
        records: &[FlightRecord],
        without: Option<usize>,
    ) -> Vec<String> {
        let mut names = Vec::new();
        for (number, record) in records.iter().enumerate() {
            if !self.held_out.contains(&number) && Some(number) != without {
                names.push(record.name.clone());
            }
        }
        names
    }

    /// Returns a channel with its name; the name is empty for a channel that does not exist.
    pub(crate) fn signal(&self, role: ChannelSide, index: usize) -> Signal {
        let channels = role.pick(&self.preparation.inputs, &self.preparation.outputs);
        Signal {
            role,
            index,
            name: channels
                .get(index)
                .map_or_else(String::new, |channel| channel.name.clone()),
        }
    }

    /// Returns the lowest line used, half the lower end of the band \[rad/s\].
    pub(crate) fn lowest(&self) -> f64 {
        LOWEST_LINE * self.band[0]
    }

    /// Returns the highest line used, 4/3 times the upper end of the band \[rad/s\].
    pub(crate) fn highest(&self) -> f64 {
        HIGHEST_LINE * self.band[1]
    }
}

/// Returns whether a list, if given, is not empty and holds integers from 1 to `most`.
fn is_within(list: &Option<Vec<usize>>, most: usize) -> bool {
    match list {
        None => true,
        Some(list) => !list.is_empty() && list.iter().all(|value| (1..=most).contains(value)),
    }
}

/// User settings that replace the defaults to try; an empty list keeps the default.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SearchSpace {
    pub orders: Vec<usize>,
    /// Past windows, in Laguerre projections.
    pub pasts: Vec<usize>,
    /// Laguerre poles \[rad/s\].
    pub poles: Vec<f64>,
}

impl SearchSpace {
    /// Replaces the defaults in `options` by the lists that are not empty. The band in `options`
    /// must be final, because poles are stored relative to its upper end.
    pub fn set(&self, options: &mut Options) {
        if !self.orders.is_empty() {
            options.orders = Some(self.orders.clone());
        }
        if !self.pasts.is_empty() {
            options.pasts = Some(self.pasts.clone());
        }
        if !self.poles.is_empty() {
            options.poles = self
                .poles
                .iter()
                .map(|pole| pole / options.band[1])
                .collect();
        }
    }
}
