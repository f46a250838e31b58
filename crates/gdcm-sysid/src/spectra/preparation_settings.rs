//! Settings for preparing flight records: the channels, their delays, gaps (M14.1).
//!
//! *Stairs* are runs of equal samples in a channel that moves; [`Hold`] says what they mean.

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::simulation::Signal;

use super::signal_names::names;

/// Longest plausible delay or hold in a channel \[s\].
const LONGEST_SHIFT_S: f64 = 10.0;
/// Longest gap that may be bridged, in samples.
const LONGEST_BRIDGE: usize = 1000;

/// Meaning of stairs in a channel that is logged more often than it changes (M14.1).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Hold {
    /// A continuous signal; stairs raise a caution.
    #[default]
    None,
    /// The stairs act on the aircraft, or are the sensor's resolution: the samples are correct as
    /// logged.
    Acts,
    /// A command held for `hold_s` \[s\] and logged when it begins: it acts `hold_s / 2` later.
    Command { hold_s: f64 },
    /// A sensor with the sample time `hold_s` \[s\] whose samples are repeated by a faster logger:
    /// a stamp is on average `hold_s / 2` later than the measurement.
    SlowSensor { hold_s: f64 },
    /// A sensor slower than the logger: only new samples count, with straight lines between them.
    FreshSamples,
}

/// How a channel is prepared: delay to remove, kind of hold, plausible range.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChannelPreparation {
    pub name: String,
    /// Sensor or bus delay to remove \[s\], as stated by the engineer.
    pub delay_s: f64,
    pub hold: Hold,
    /// Largest plausible modulus in the channel's unit; a larger value raises a caution about the
    /// unit.
    pub limit: Option<f64>,
}

impl ChannelPreparation {
    /// Returns a channel that is used as logged.
    #[must_use]
    pub fn named(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            ..Self::default()
        }
    }

    /// Returns how much later \[s\] a sample is stamped than the channel had its value: the delay,
    /// less half the hold of a command, or plus half the hold of a slow sensor.
    pub(crate) fn shift_s(&self) -> f64 {
        match self.hold {
            Hold::Command { hold_s } => self.delay_s - 0.5 * hold_s,
            Hold::SlowSensor { hold_s } => self.delay_s + 0.5 * hold_s,
            Hold::None | Hold::Acts | Hold::FreshSamples => self.delay_s,
        }
    }

    /// Returns the stated hold \[s\]; 0 if none is stated.
    fn hold_s(&self) -> f64 {
        match self.hold {
            Hold::Command { hold_s } | Hold::SlowSensor { hold_s } => hold_s,
            Hold::None | Hold::Acts | Hold::FreshSamples => 0.0,
        }
    }
}

/// Settings for preparing flight records.
#[derive(Clone, Debug, PartialEq)]
pub struct Preparation {
    /// Inputs, in column order.
    pub inputs: Vec<ChannelPreparation>,
    /// Outputs, in column order.
    pub outputs: Vec<ChannelPreparation>,
    /// Whether a record with uneven sample times may be interpolated.
    pub resample: bool,
    /// Whether an output's samples are used while it is constant and another channel moves;
    /// otherwise they are a gap.
    pub keep_frozen: bool,
    /// Longest gap, in samples, that is bridged by a straight line; longer gaps split the record,
    /// unless their samples can be estimated (M14.21).
    pub longest_bridge: usize,
    /// Minimum segment length \[s\].
    pub least_segment_s: f64,
}

impl Preparation {
    /// Creates the default settings: every channel as logged, gaps up to 3 samples bridged,
    /// segments at least 10 s long.
    #[must_use]
    pub fn new(inputs: &[&str], outputs: &[&str]) -> Self {
        Self {
            inputs: named_channels(inputs),
            outputs: named_channels(outputs),
            resample: false,
            keep_frozen: false,
            longest_bridge: 3,
            least_segment_s: 10.0,
        }
    }

    /// Returns the inputs, then the outputs.
    pub(crate) fn channels(&self) -> impl Iterator<Item = (Signal, &ChannelPreparation)> {
        self.channels_of(ChannelSide::Input)
            .chain(self.channels_of(ChannelSide::Output))
    }

    /// Returns the inputs or the outputs.
    pub(crate) fn channels_of(
        &self,
        role: ChannelSide,
    ) -> impl Iterator<Item = (Signal, &ChannelPreparation)> {
        let channels = role.pick(&self.inputs, &self.outputs).iter().enumerate();
        channels.map(move |(index, channel)| {
            let signal = Signal {
                role,
                index,
                name: channel.name.clone(),
            };
            (signal, channel)
        })
    }

    /// Returns a channel's settings; `None` if the channel does not exist.
    pub fn channel(&self, signal: &Signal) -> Option<&ChannelPreparation> {
        signal
            .role
            .pick(&self.inputs, &self.outputs)
            .get(signal.index)
    }

    /// Returns a channel's settings for editing; `None` if the channel does not exist.
    pub fn channel_mut(&mut self, signal: &Signal) -> Option<&mut ChannelPreparation> {
        signal
            .role
            .pick(&mut self.inputs, &mut self.outputs)
            .get_mut(signal.index)
    }

    /// Checks that there are inputs and outputs, and that delays, holds, the longest bridge and the
    /// minimum segment are possible.
    pub(crate) fn check(&self) -> Result<(), PreparationError> {
        for role in [ChannelSide::Input, ChannelSide::Output] {
            if role.pick(&self.inputs, &self.outputs).is_empty() {
                return Err(PreparationError::NoChannels(role));
            }
        }
        for (signal, channel) in self.channels() {
            for seconds in [channel.delay_s, channel.hold_s()] {
                if !seconds.is_finite() || seconds.abs() > LONGEST_SHIFT_S {
                    return Err(PreparationError::Shift { signal, seconds });
                }
            }
        }
        if !(self.least_segment_s.is_finite() && self.least_segment_s > 0.0) {
            return Err(PreparationError::LeastSegment(self.least_segment_s));
        }
        if self.longest_bridge > LONGEST_BRIDGE {
            return Err(PreparationError::Bridge(self.longest_bridge));
        }
        Ok(())
    }
}

fn named_channels(names: &[&str]) -> Vec<ChannelPreparation> {
    names
        .iter()
        .map(|name| ChannelPreparation::named(*name))
        .collect()
}

/// Why flight records cannot be prepared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PreparationError {
    #[error("there are no flight records; add at least one")]
    NoRecords,
    #[error("no {0} is given: identification needs at least one input and one output")]
    NoChannels(ChannelSide),
    /// A record has another number of channels than the settings.
    #[error("record {record}: expected {named} {role}s, found {found}")]
    ChannelsDiffer {
        record: String,
        role: ChannelSide,
        found: usize,
        named: usize,
    },
    /// A record's columns differ in length.
    #[error(
        "record {record} has {stamps} time stamps, {inputs} input samples and {outputs} output samples; \
        the numbers must be equal"
    )]
    LengthsDiffer {
        record: String,
        stamps: usize,
        inputs: usize,
        outputs: usize,
    },
    /// A delay or a hold is not finite or too long.
    #[error(
        "{signal}: expected a delay or hold from -{LONGEST_SHIFT_S} to {LONGEST_SHIFT_S} s, found \
        {seconds} s"
    )]
    Shift { signal: Signal, seconds: f64 },
    #[error("minimum length of a part without gaps: expected more than 0 s, found {0} s")]
    LeastSegment(f64),
    #[error("gaps of {0} samples are too long to be bridged; the maximum is {LONGEST_BRIDGE}")]
    Bridge(usize),
    #[error(
        "record {record}: time goes from {previous_s} s to {time_s} s in row {}. Sort the rows, or delete repeated rows",
        row + 1
    )]
    TimeNotIncreasing {
        record: String,
        /// Row with the later stamp, counted from 0.
        row: usize,
        previous_s: f64,
        time_s: f64,
    },
    #[error(
        "record {record}: the sample time varies by {percent:.0} %, more than 20 %. If the stamps are right, give the rate to which the record is interpolated (--resample)"
    )]
    UnevenSampling {
        record: String,
        /// The steps' deviation from multiples of the median sample time, 95th percentile \[%\].
        percent: f64,
    },
    /// No segment is long enough.
    #[error(
        "no usable part of the records: the longest part without a gap lasts {longest_s:.1} s, less than {least_s:.1} s. \
         Log longer records, fill the gaps, or leave out the channel with gaps"
    )]
    NothingLeft { longest_s: f64, least_s: f64 },
    #[error("{} never moved in any record: leave {} out", names(.0), if .0.len() == 1 { "it" } else { "them" })]
    Constant(Vec<Signal>),
}

impl PreparationError {
    /// Returns the stable code by which scripts and tests distinguish the errors.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NoRecords => "no-records",
            Self::NoChannels(..) => "no-channels",
            Self::ChannelsDiffer { .. } => "channels-differ",
            Self::LengthsDiffer { .. } => "lengths-differ",
            Self::Shift { .. } => "channel-shift",
            Self::LeastSegment(..) => "least-segment",
            Self::Bridge(..) => "bridge",
            Self::TimeNotIncreasing { .. } => "time-not-increasing",
            Self::UnevenSampling { .. } => "uneven-sampling",
            Self::NothingLeft { .. } => "nothing-left",
            Self::Constant(..) => "constant-channels",
        }
    }
}
