//! What an identification is asked for.

use super::*;

/// The band, the channels, which records are held out, and what is tried. The defaults are those of M14, section 9: fixed on
/// five conditions of the example, and right on the other six, on fresh noise and on half the data.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Lower and upper end of the band \[rad/s\].
    pub band: [f64; 2],
    /// The channels, and how they are prepared.
    pub preparation: Preparation,
    /// How many of the inputs, the last ones, are no inputs of the model but recorded references that drove the loop from outside (M14.15).
    pub references: usize,
    /// Records that no model is fitted to, counted from 0: they judge the model.
    pub held_out: Vec<usize>,
    /// Orders that are tried; none: those that the records can carry (M14.13).
    pub orders: Option<Vec<usize>>,
    /// Laguerre poles over the upper end of the band.
    pub poles: Vec<f64>,
    /// Past windows: Laguerre projections that predict the next; none: those that the records can carry (M14.13).
    pub pasts: Option<Vec<usize>>,
}

impl Options {
    /// The defaults for a band \[rad/s\] and channels.
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

    /// Inputs of the model.
    pub(super) fn inputs(&self) -> usize {
        self.preparation.inputs.len().saturating_sub(self.references)
    }

    /// Names of the records that models are fitted to, but for the one of the number `without`.
    pub(super) fn fitted(&self, records: &[FlightRecord], without: Option<usize>) -> Vec<String> {
        let fitted = |index: &usize| !self.held_out.contains(index) && Some(*index) != without;
        (0..records.len()).filter(fitted).map(|index| records[index].name.clone()).collect()
    }

    /// A channel by its place, with its name.
    pub(super) fn signal(&self, role: ChannelSide, index: usize) -> Signal {
        let channels = if role == ChannelSide::Input { &self.preparation.inputs } else { &self.preparation.outputs };
        Signal { role, index, name: channels.get(index).map_or_else(String::new, |channel| channel.name.clone()) }
    }

    /// Lowest line used \[rad/s\]: half the lower end of the band.
    pub(super) fn lowest(&self) -> f64 {
        0.5 * self.band[0]
    }

    /// Highest line used \[rad/s\]: 4/3 of the upper end of the band.
    pub(super) fn highest(&self) -> f64 {
        4.0 / 3.0 * self.band[1]
    }
}

/// What is tried in place of the defaults; an empty list leaves them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SearchSpace {
    /// Orders.
    pub orders: Vec<usize>,
    /// Past windows, in Laguerre projections.
    pub pasts: Vec<usize>,
    /// Laguerre poles \[rad/s\].
    pub poles: Vec<f64>,
}

impl SearchSpace {
    /// Sets what is tried.
    pub fn set(&self, options: &mut Options) {
        let said = |list: &[usize]| (!list.is_empty()).then(|| list.to_vec());
        options.orders = said(&self.orders).or(options.orders.take());
        options.pasts = said(&self.pasts).or(options.pasts.take());
        if !self.poles.is_empty() {
            options.poles = self.poles.iter().map(|pole| pole / options.band[1]).collect();
        }
    }
}

// Why nothing could be identified.

/// The highest order that may be asked for.
pub const HIGHEST_ORDER: usize = 60;
/// The longest past window that may be asked for.
pub const LONGEST_PAST: usize = 60;

/// Why nothing could be identified.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum IdentificationError {
    /// The records cannot be prepared.
    #[error(transparent)]
    Preparation(#[from] PreparationError),
    /// The channels cannot be scaled.
    #[error(transparent)]
    Scaling(#[from] ScalingError),
    /// The response cannot be measured.
    #[error(transparent)]
    Measurement(#[from] LocalPolynomialError),
    /// The records are too short for the lower end of the band, and would do for a higher one.
    #[error(
        "the longest record lasts {longest_s:.0} s: {lowest:.2} rad/s needs {needed_s:.1} s, better {better_s:.0} s. From \
         {enough:.2} rad/s on the records would do"
    )]
    TooShort {
        /// Length of the longest \[s\].
        longest_s: f64,
        /// Lower end of the band \[rad/s\].
        lowest: f64,
        /// Length that it takes \[s\]: 1.5 periods.
        needed_s: f64,
        /// Length that is better \[s\]: 5 periods, or 3 an input where several are moved in one record.
        better_s: f64,
        /// Lower end of the band for which the records are long enough \[rad/s\].
        enough: f64,
    },
    /// Fewer figures than even a model of the first order takes.
    #[error(
        "the lines of the records in the band are {figures} real figures, and {needed} are needed, 5 for each of the {unknowns} \
         unknowns of a model of order 1: log longer or more records, widen the band, or leave out channels"
    )]
    TooFewFigures {
        /// Real figures.
        figures: usize,
        /// How many it takes.
        needed: usize,
        /// Unknowns of a model of order 1.
        unknowns: usize,
    },
    /// The band is no band.
    #[error(
        "a band from {lowest} to {highest} rad/s: its lower end must be greater than 0, and its upper end above it"
    )]
    Band {
        /// Lower end \[rad/s\].
        lowest: f64,
        /// Upper end \[rad/s\].
        highest: f64,
    },
    /// The records are sampled too slowly for the band.
    #[error(
        "the band ends at {highest} rad/s, but a sample time of {sample_time_s:.4} s is too long for that: \
         end the band below {limit:.1} rad/s, or log faster"
    )]
    SampledTooSlowly {
        /// Upper end \[rad/s\].
        highest: f64,
        /// The longest sample time \[s\].
        sample_time_s: f64,
        /// Highest upper end that can be had \[rad/s\].
        limit: f64,
    },
    /// No orders, past windows or poles, or impossible ones.
    #[error(
        "orders and past windows must be given, from 1 to {HIGHEST_ORDER} and from 1 to {LONGEST_PAST}, \
         and Laguerre poles greater than 0"
    )]
    Settings,
    /// All inputs are references.
    #[error("every input is given as a reference: at least one input of the model has to be left")]
    OnlyReferences,
    /// A held-out record is not there.
    #[error("record {} is to be held out, but there are only {records}", record + 1)]
    HeldOutMissing {
        /// Which, counted from 0.
        record: usize,
        /// Records there are.
        records: usize,
    },
    /// All records are held out, or cannot be used.
    #[error("no record is left to fit a model to: hold out fewer")]
    NothingToFit,
    /// Inputs that are copies of each other.
    #[error("{} move as one in every record: leave out all but one, or fly them apart", names(signals))]
    InputsDepend {
        /// The inputs.
        signals: Vec<Signal>,
    },
    /// Outputs whose noise cannot be told apart.
    #[error("the outputs depend on each other so closely that their noise cannot be weighed: leave out the copies")]
    OutputsDepend,
    /// No model could be made.
    #[error(
        "no model came of {lines} spectral lines in {seconds:.0} s of records: log longer or more records, \
         widen the band, or leave out channels"
    )]
    NoModel {
        /// SpectralLines of all records.
        lines: usize,
        /// Their length \[s\].
        seconds: f64,
    },
    /// It was stopped.
    #[error("the identification was stopped")]
    Stopped(#[from] Cancelled),
}
