//! Quantities drawn over the conditions: net gains, channel gains and channel delays.

use gdcm_method::correction::{Channel, ChannelCorrection};
use gdcm_method::schedule::Schedule;
use gdcm_method::uncertainty::Scalar;
use gdcm_model::dataset::Pair;
use gdcm_model::dataset::condition::FlightState;
use gdcm_model::number_format::decimals;
use gdcm_model::units::s_to_ms;
use gdcm_study::results::analysis::{Analysis, ConditionAnalysis};

/// Number of intervals into which samples divide a schedule.
const SAMPLES: usize = 120;

/// Whether a quantity is a gain or a delay.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Measure {
    /// Ratio; 1 without correction.
    #[default]
    Gain,
    /// Delay \[ms\]; 0 without correction.
    Delay,
}

impl Measure {
    /// Formats a gain with three decimals, or a delay with one and its unit.
    pub fn text(self, value: f64) -> String {
        match self {
            Self::Gain => decimals(value, 3),
            Self::Delay => format!("{} ms", decimals(value, 1)),
        }
    }

    /// Returns the value that means no correction: 1 for a gain, 0 for a delay.
    pub fn uncorrected(self) -> f64 {
        match self {
            Self::Gain => 1.0,
            Self::Delay => 0.0,
        }
    }

    /// Returns the minimum height that an axis shows, in the measure's unit.
    pub fn least_height(self) -> f64 {
        match self {
            Self::Gain => 0.1,
            Self::Delay => 10.0,
        }
    }

    /// Returns the schedule if it can be drawn: it contains this measure, and the horizontal axis
    /// is the airspeed.
    pub fn schedule_of(self, analysis: &Analysis, across: Across) -> Option<&Schedule> {
        let schedule = analysis.schedule.as_ref().ok()?;
        let has_values = self == Self::Gain || schedule.has_delays();
        if across == Across::Airspeed && has_values {
            Some(schedule)
        } else {
            None
        }
    }

    /// Returns the axis label: quantity and unit.
    pub fn axis_label(self) -> &'static str {
        match self {
            Self::Gain => "Gain [-]",
            Self::Delay => "Delay [ms]",
        }
    }
}

/// Quantity on the horizontal axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Across {
    /// True airspeed \[kt\].
    #[default]
    Airspeed,
    /// Conditions in file order, at 0, 1, 2, …
    Conditions,
}

/// Quantities on both axes in a figure over channels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GainAxes {
    pub measure: Measure,
    pub across: Across,
}

/// A quantity defined by each condition's correction and by the schedule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GainQuantity {
    /// Net gain of a response: the product of its output channel's and its input channel's gain.
    NetGain(Pair),
    Gain(Channel),
    Delay(Channel),
}

impl GainQuantity {
    /// Returns the channel's gain or delay, as `measure` requires.
    pub fn of_channel(channel: Channel, measure: Measure) -> Self {
        match measure {
            Measure::Gain => Self::Gain(channel),
            Measure::Delay => Self::Delay(channel),
        }
    }

    /// Returns whether the quantity is a gain or a delay.
    pub fn measure(self) -> Measure {
        match self {
            Self::NetGain(_) | Self::Gain(_) => Measure::Gain,
            Self::Delay(_) => Measure::Delay,
        }
    }

    /// Returns the quantity's value in a correction, in the measure's unit.
    pub fn value_in(self, correction: &ChannelCorrection) -> f64 {
        match self {
            Self::NetGain(pair) => correction.net_gain(pair),
            Self::Gain(channel) => correction.gain(channel),
            Self::Delay(channel) => s_to_ms(correction.delay_s(channel)),
        }
    }

    /// Returns the corresponding scalar in the uncertainty analysis.
    pub fn scalar(self) -> Scalar {
        match self {
            Self::NetGain(pair) => Scalar::NetGain(pair),
            Self::Gain(channel) => Scalar::ChannelGain(channel),
            Self::Delay(channel) => Scalar::ChannelDelay(channel),
        }
    }

    /// Returns the search bounds for a condition's optimum, in the measure's unit; `None` for a net
    /// gain, which has no bounds.
    pub fn bounds(self, result: &ConditionAnalysis) -> Option<[f64; 2]> {
        match self {
            Self::NetGain(_) => None,
            Self::Gain(_) => {
                let bounds = result.gain_bounds();
                Some([bounds.lower, bounds.upper])
            }
            Self::Delay(_) => Some(result.delay_bounds_s().map(s_to_ms)),
        }
    }

    /// Samples the scheduled quantity from the lowest to the highest airspeed as `[airspeed,
    /// value]`, airspeed in kt.
    pub(super) fn samples(self, schedule: &Schedule) -> Vec<[f64; 2]> {
        let from = schedule.airspeeds.min_kt;
        let to = schedule.airspeeds.max_kt;
        let mut samples = Vec::new();
        for sample in 0..=SAMPLES {
            let airspeed_kt = from + (to - from) * sample as f64 / SAMPLES as f64;
            samples.push([airspeed_kt, self.value_in(&schedule.at(airspeed_kt))]);
        }
        samples
    }
}

/// A condition's result, with its position on the horizontal axis.
pub(super) struct PlacedResult<'a> {
    pub(super) x: f64,
    pub(super) state: &'a FlightState,
    pub(super) result: &'a ConditionAnalysis,
}

/// Returns the available results, in file order.
pub(super) fn placed_results(analysis: &Analysis, across: Across) -> Vec<PlacedResult<'_>> {
    let mut placed = Vec::new();
    for (index, condition) in analysis.study.dataset.conditions().iter().enumerate() {
        if let Some(result) = analysis.condition(condition.id()) {
            let state = condition.flight_state();
            let x = match across {
                Across::Airspeed => state.airspeed_kt,
                Across::Conditions => index as f64,
            };
            placed.push(PlacedResult { x, state, result });
        }
    }
    placed
}
