//! Which figure is wanted: what the window shows, and what a command asks for.

use gdcm_core::correction::Channel;
use gdcm_core::dataset::Pair;
use gdcm_core::study::{AcrossRole, Analysis, AssessmentChoice, ConditionModes, Unobserved};
use gdcm_core::units::rad_s_to_hz;
use serde::{Deserialize, Serialize};

use super::assessment::{assessment_figure, usual_choice};
use super::bode::{BodeOptions, airspeeds_figure, bode_figure, overview_figure};
use super::condition_source::ConditionSource;
use super::error::error_figure;
use super::evidence::evidence_figure;
use super::figure::Figure;
use super::gains::{Across, Measure, channels_figure, net_gain_figure};
use super::poles::{poles_figure, zeros_of_model};

/// Which of the program's figures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FigureKind {
    /// Responses of one condition (Figures 2 and 5).
    Bode,
    /// What the fit sees of them.
    Error,
    /// Every response of one condition, small.
    Overview,
    /// Net gains against airspeed (Figures 6 and 7).
    NetGain,
    /// Gains or delays of the channels (Figures 3 and 4).
    Channels,
    /// What the scatter of the net gains is made of.
    Evidence,
    /// What the correction is worth (Figures 8 to 19).
    Assessment,
    /// Poles of every model of one condition.
    Poles,
    /// One response in every condition, coloured by airspeed.
    Airspeeds,
}

impl FigureKind {
    /// Every kind.
    pub const ALL: [Self; 9] = [
        Self::Bode,
        Self::Error,
        Self::Overview,
        Self::NetGain,
        Self::Channels,
        Self::Evidence,
        Self::Assessment,
        Self::Poles,
        Self::Airspeeds,
    ];

    /// Its name in a command and in the name of a file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bode => "bode",
            Self::Error => "error",
            Self::Overview => "overview",
            Self::NetGain => "net-gain",
            Self::Channels => "channels",
            Self::Evidence => "evidence",
            Self::Assessment => "assessment",
            Self::Poles => "poles",
            Self::Airspeeds => "airspeeds",
        }
    }

    /// Whether it is made of error bars, which are then computed for it.
    pub fn needs_bars(self) -> bool {
        self == Self::Evidence
    }

    /// Whether it is a figure of one condition.
    pub fn is_of_condition(self) -> bool {
        matches!(self, Self::Bode | Self::Error | Self::Overview | Self::Poles)
    }
}

/// Which figure is wanted.
#[derive(Clone, Debug, PartialEq)]
pub struct FigureRequest {
    /// Which.
    pub kind: FigureKind,
    /// The responses that it is of, where it is of some.
    pub pairs: Vec<Pair>,
    /// The channels that it is of, where it is of channels.
    pub channels: Vec<Channel>,
    /// What is shown of channels.
    pub measure: Measure,
    /// Over what.
    pub across: Across,
    /// What is assessed; the paper's choice where none is given.
    pub assessed: Option<AssessmentChoice>,
    /// Which model of each condition, where one of each is shown.
    pub across_role: AcrossRole,
    /// How responses are shown.
    pub bode: BodeOptions,
}

impl FigureRequest {
    /// A figure of these responses and channels, shown as usual.
    pub fn new(kind: FigureKind, pairs: Vec<Pair>, channels: Vec<Channel>) -> Self {
        let (measure, across) = (Measure::default(), Across::default());
        let (across_role, bode) = (AcrossRole::default(), BodeOptions::default());
        Self { kind, pairs, channels, measure, across, assessed: None, across_role, bode }
    }

    /// The figure; none where what it is made of is not there: the condition's source for those of one condition, else the
    /// analysis.
    pub fn figure(&self, analysis: Option<&Analysis>, condition: Option<&ConditionSource<'_>>) -> Option<Figure> {
        Some(match self.kind {
            FigureKind::Bode => bode_figure(condition?, &self.pairs, &self.bode),
            FigureKind::Error => error_figure(condition?, &self.pairs, &self.bode),
            FigureKind::Overview => overview_figure(condition?, &self.bode),
            FigureKind::NetGain => net_gain_figure(analysis?, analysis?.uncertainty.as_deref(), &self.pairs),
            FigureKind::Channels => {
                let shown = (self.measure, self.across);
                channels_figure(analysis?, analysis?.uncertainty.as_deref(), &self.channels, shown)
            }
            FigureKind::Evidence => return evidence_figure(analysis?, &self.pairs),
            FigureKind::Assessment => {
                let analysis = analysis?;
                assessment_figure(analysis, &self.pairs, self.assessed.unwrap_or_else(|| usual_choice(analysis)))
            }
            FigureKind::Poles => {
                let condition = condition?;
                let modes = ConditionModes::of(&condition.curves.condition, &Unobserved).ok()?;
                poles_figure(condition, &modes, &self.bode, &|id| match self.bode.zeros_of {
                    Some(pair) => zeros_of_model(condition, pair, id),
                    None => Vec::new(),
                })
            }
            FigureKind::Airspeeds => return airspeeds_figure(analysis?, &self.pairs, self.across_role, &self.bode),
        })
    }
}

/// The unit frequencies are shown in; inside they are always rad/s.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum FrequencyUnit {
    /// Angular frequency.
    #[default]
    RadPerSecond,
    /// Cycles per second.
    Hertz,
}

impl FrequencyUnit {
    /// The symbol of the unit.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::RadPerSecond => "rad/s",
            Self::Hertz => "Hz",
        }
    }

    /// The angular frequency `omega` \[rad/s\] in this unit.
    pub fn of_omega(self, omega: f64) -> f64 {
        match self {
            Self::RadPerSecond => omega,
            Self::Hertz => rad_s_to_hz(omega),
        }
    }

    /// An angular frequency as a reader wants it: "ω 2.05 rad/s" or "f 0.326 Hz".
    pub fn readout(self, omega: f64) -> String {
        let quantity = match self {
            Self::RadPerSecond => "ω",
            Self::Hertz => "f",
        };
        format!("{quantity} {} {}", three_digits(self.of_omega(omega)), self.symbol())
    }

    /// What stands beside the axis.
    pub fn axis_label(self) -> String {
        format!("Frequency [{}]", self.symbol())
    }
}

/// How the magnitude of a response is read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum MagnitudeUnit {
    /// Decibels.
    #[default]
    Decibel,
    /// The ratio of output to input, in their units.
    Ratio,
}

/// How the phase of a response is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum PhaseUnit {
    /// Continuous over frequency (M2).
    #[default]
    Unwrapped,
    /// Between −180° and 180°.
    Wrapped,
}

/// How a difference of phases is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum PhaseErrorUnit {
    /// Δφ.
    #[default]
    Degree,
    /// Δφ/ω: the delay that would make up for it.
    Millisecond,
}

/// Three significant digits.
fn three_digits(value: f64) -> String {
    let decimals = if value.abs() >= 100.0 {
        0
    } else if value.abs() >= 10.0 {
        1
    } else if value.abs() >= 1.0 {
        2
    } else {
        3
    };
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frequency_reads_in_its_unit() {
        assert_eq!(FrequencyUnit::RadPerSecond.readout(2.0494), "ω 2.05 rad/s");
        assert_eq!(FrequencyUnit::Hertz.readout(2.0494), "f 0.326 Hz");
    }
}
