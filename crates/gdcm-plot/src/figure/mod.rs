//! Figures: contents of plots, independent of any screen, and their layout for print.
//!
//! A [`Figure`] has plots side by side, a title, a legend and a caption; a [`Plot`](figure::Plot)
//! has vertically stacked panels; a [`Panel`] has two axes and marks. [`Figure::drawing`] lays it
//! out at the width of a journal's column, in sizes that are readable in print, and in lines that
//! are distinguishable without colours; [`Figure::tables`] returns its numbers. Every view of the
//! window has a function here that builds its figure, and the command `gdcm figure` calls the same
//! function.
//!
//! ```
//! use gdcm_plot::figure::axis::Axis;
//! use gdcm_plot::figure::figure::{Curve, Plot};
//! use gdcm_plot::figure::{ColumnWidth, Figure, Panel, Role};
//!
//! let omega = [0.5, 1.0, 2.0];
//! let nominal = Curve::new("nominal", Role::Nominal.stroke(false), omega, [3.0, 1.0, -4.0]).key("nominal");
//! let panel = Panel::new(Axis::logarithmic("Frequency [rad/s]"), Axis::linear("Magnitude [dB]")).with(nominal);
//! let figure = Figure::new("LON → Q, condition 10").caption("Simulated data.").plot(Plot::new("LON → Q").panel(panel));
//! assert_eq!(figure.tables()[0].columns, ["Frequency [rad/s]", "nominal [dB]"]);
//! assert_eq!(figure.legend()[0].text, "nominal");
//! // 84 mm are 238 pt.
//! assert_eq!(figure.drawing(ColumnWidth::Single).size[0].round(), 238.0);
//! ```

use std::sync::Arc;

use gdcm_method::correction::Channel;
use gdcm_model::dataset::{ModelId, Pair};
use gdcm_model::progress::Unobserved;
use gdcm_study::jobs::curve_jobs::ConditionModes;
use gdcm_study::results::assessment_table::AssessmentChoice;
use gdcm_study::results::condition_answers::{RecordHistory, TestAnswers};
use gdcm_study::results::couplings_assessment::CouplingsAssessment;
use gdcm_study::results::requirements::Requirements;
use gdcm_study::{AcrossRole, Analysis, ConditionAnalysis};

pub mod assessment;
pub mod axis;
pub mod bode;
pub mod condition_source;
pub mod drawing;
pub mod error;
#[expect(
    clippy::module_inception,
    reason = "the room is named by what it makes"
)]
pub mod figure;
pub mod gains;
pub mod label_places;
pub mod layout;
pub mod leads;
pub mod paint;
pub mod poles;
pub mod requirements;
pub mod responses;
pub mod role;
pub mod tables;
pub mod thinning;

pub use axis::Range;
pub use condition_source::ConditionSource;
pub use drawing::Color;
pub use figure::{ColumnWidth, Figure, FigureFormat, Mark, MarkId, Panel};
pub use gains::all_channels;
pub use role::Role;

use assessment::{assessment_figure, evidence_figure, usual_choice};
use bode::{BodeOptions, airspeeds_figure, bode_figure, overview_figure};
use error::error_figure;
use gains::{Across, Measure, channels_figure, net_gain_figure};
use leads::leads_figure;
use poles::{couplings_figure, poles_figure, zeros_of_model};
use requirements::{record_history_figure, requirements_figure, test_answers_figure};

/// Kind of figure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum FigureKind {
    /// Responses of one condition (Figures 2 and 5).
    #[default]
    Bode,
    /// Errors of these responses as the fit sees them.
    Error,
    /// All responses of one condition, small.
    Overview,
    /// Net gains against airspeed (Figures 6 and 7).
    NetGain,
    /// Gains or delays of the channels (Figures 3 and 4).
    Channels,
    /// Contributions to the scatter of the net gains.
    Evidence,
    /// Value of the correction (Figures 8 to 19).
    Assessment,
    /// Poles of all models of one condition.
    Poles,
    /// Delay or lead of each channel of one condition, up to ten times the band.
    Leads,
    /// Effect of couplings on their loop and on the poles of a condition.
    Couplings,
    /// Phase delay over bandwidth of the attitude responses.
    Requirements,
    /// A response in every condition, coloured by airspeed.
    Airspeeds,
}

impl FigureKind {
    /// All kinds.
    pub const ALL: [Self; 12] = [
        Self::Bode,
        Self::Error,
        Self::Overview,
        Self::NetGain,
        Self::Channels,
        Self::Evidence,
        Self::Assessment,
        Self::Poles,
        Self::Leads,
        Self::Couplings,
        Self::Requirements,
        Self::Airspeeds,
    ];

    /// Returns its name in commands and file names.
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
            Self::Leads => "leads",
            Self::Couplings => "couplings",
            Self::Requirements => "requirements",
            Self::Airspeeds => "airspeeds",
        }
    }

    /// Returns whether the figure requires error bars, which are then computed for it.
    pub fn needs_bars(self) -> bool {
        matches!(self, Self::Evidence | Self::Requirements)
    }

    /// Returns whether the figure shows error bars if they are available.
    pub fn takes_bars(self) -> bool {
        matches!(self, Self::NetGain | Self::Channels)
    }

    /// Returns whether it is a figure of one condition.
    pub fn is_of_condition(self) -> bool {
        matches!(
            self,
            Self::Bode | Self::Error | Self::Overview | Self::Poles | Self::Leads
        )
    }
}

/// Responses of models over time.
#[derive(Clone, Debug, PartialEq)]
pub enum OverTime {
    /// To a test input.
    Test(Arc<TestAnswers>),
    /// To a flight record, with the index of the drawn input.
    Record(Arc<RecordHistory>, usize),
}

/// Contents and options of a requested figure.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FigureRequest {
    pub kind: FigureKind,
    /// The responses, if the kind needs some.
    pub pairs: Vec<Pair>,
    /// The channels, if the kind needs some.
    pub channels: Vec<Channel>,
    /// Quantity of channels.
    pub measure: Measure,
    /// Horizontal axis.
    pub across: Across,
    /// Choice for the assessment; the paper's choice if `None`.
    pub assessed: Option<AssessmentChoice>,
    /// The model of each condition, in a figure with one model of each.
    pub across_role: AcrossRole,
    /// Options for responses.
    pub bode: BodeOptions,
    /// Effect of the couplings, for their figure.
    pub couplings: Option<Arc<CouplingsAssessment>>,
    /// Requirements, for their figure.
    pub requirements: Option<Arc<Requirements>>,
    /// Responses over time, shown instead of bandwidths.
    pub over_time: Option<OverTime>,
}

impl FigureRequest {
    /// Creates a figure of these responses and channels with default options.
    pub fn new(kind: FigureKind, pairs: Vec<Pair>, channels: Vec<Channel>) -> Self {
        Self {
            kind,
            pairs,
            channels,
            ..Self::default()
        }
    }

    /// Builds the figure; `None` if its source is missing: the condition's source for a figure of
    /// one condition, otherwise the analysis.
    pub fn figure(
        &self,
        analysis: Option<&Analysis>,
        condition: Option<&ConditionSource<'_>>,
    ) -> Option<Figure> {
        Some(match self.kind {
            FigureKind::Bode => bode_figure(condition?, &self.pairs, &self.bode),
            FigureKind::Error => error_figure(condition?, &self.pairs, &self.bode),
            FigureKind::Overview => overview_figure(condition?, &self.bode),
            FigureKind::NetGain => {
                net_gain_figure(analysis?, analysis?.uncertainty.as_deref(), &self.pairs)
            }
            FigureKind::Channels => {
                let shown = (self.measure, self.across);
                channels_figure(
                    analysis?,
                    analysis?.uncertainty.as_deref(),
                    &self.channels,
                    shown,
                )
            }
            FigureKind::Evidence => return evidence_figure(analysis?, &self.pairs),
            FigureKind::Assessment => {
                let analysis = analysis?;
                assessment_figure(
                    analysis,
                    &self.pairs,
                    self.assessed.unwrap_or_else(|| usual_choice(analysis)),
                )
            }
            FigureKind::Poles => {
                let condition = condition?;
                let modes = ConditionModes::of(&condition.curves.condition, &Unobserved).ok()?;
                let zeros = |id: &ModelId| match self.bode.zeros_of {
                    Some(pair) => zeros_of_model(condition, pair, id),
                    None => Vec::new(),
                };
                let shifts = condition
                    .analysis
                    .map(ConditionAnalysis::pole_shifts)
                    .unwrap_or_default();
                poles_figure(condition, &modes, &self.bode, (&zeros, &shifts))
            }
            FigureKind::Leads => leads_figure(condition?, &self.pairs),
            FigureKind::Requirements => {
                let study = &analysis?.study;
                match &self.over_time {
                    Some(OverTime::Test(answers)) => test_answers_figure(answers, &study.dataset),
                    Some(OverTime::Record(history, input)) => {
                        record_history_figure(history, &study.dataset, *input)
                    }
                    None => {
                        let requirements = self.requirements.as_deref()?;
                        requirements_figure(
                            requirements,
                            &study.dataset,
                            &study.requirements.levels,
                        )
                    }
                }
            }
            FigureKind::Couplings => {
                let shown = condition.map(|of| of.curves.condition.id());
                return couplings_figure(self.couplings.as_deref()?, shown, self.bode.unit);
            }
            FigureKind::Airspeeds => {
                return airspeeds_figure(analysis?, &self.pairs, self.across_role, &self.bode);
            }
        })
    }
}
