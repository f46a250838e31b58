//! Figures: their description, independent of any screen, and their layout for print.
//!
//! A [`Figure`] has plots side by side, a title, a legend and a caption; a [`Plot`](figure::Plot)
//! has panels below one another; a [`Panel`] has two axes and [marks]. [`Figure::drawing`] lays it
//! out at the width of a journal column, in sizes that are readable in print, and in lines that are
//! distinguishable without colours; [`Figure::tables`] returns its numbers.
//!
//! | files | contents |
//! |---|---|
//! | [`figure`], [`marks`], [`legend`] | describe a figure |
//! | [`axis`], `range`, `ticks`, `display_units` | axes, their ticks and units |
//! | [`role`], `color`, `stroke` | line styles and colours by meaning |
//! | [`drawing`], `area` | shapes and texts on paper |
//! | [`bode`], [`error`], [`gains`], [`assessment`], [`poles`], [`leads`], [`requirements`] | a figure for each view |
//! | [`condition_source`], [`responses`] | curves for a condition, from models and corrections |
//! | `airspeed_response`, `uncertainty_band`, `reference_line`, `error_references` | curves over all conditions, bands and lines about them |
//! | [`layout`], [`letters`], [`label_places`] | places for panels, letters and labels |
//! | [`paint`], `paint_axes`, `paint_marks`, `paint_dots`, `dot_style`, `paint_words` | shapes at their places |
//! | [`thinning`], [`tables`] | omission of invisible points; values of a figure |
//!
//! Every view in the window has a function here that describes its figure, and the command `gdcm
//! figure` calls the same function through [`FigureRequest::figure`].
//!
//! ```
//! use gdcm_plot::figure::axis::Axis;
//! use gdcm_plot::figure::figure::Plot;
//! use gdcm_plot::figure::marks::Curve;
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

mod airspeed_response;
mod area;
mod arrow;
pub mod assessment;
pub mod axis;
pub mod bode;
mod bode_curve;
mod bode_options;
mod change_table;
mod coherence;
mod color;
mod condition_classes;
pub mod condition_source;
mod couplings;
mod damping_grid;
mod display_units;
mod dot_style;
pub mod drawing;
pub mod error;
mod error_cache;
mod error_references;
mod evidence;
#[expect(
    clippy::module_inception,
    reason = "the folder and the file of its main type have the same name"
)]
pub mod figure;
mod figure_format;
mod frequency_panels;
mod gain_panel;
mod gain_quantity;
pub mod gains;
pub mod label_places;
pub mod layout;
pub mod leads;
pub mod legend;
pub mod letters;
pub mod marks;
mod muad;
pub mod paint;
mod paint_axes;
mod paint_dots;
mod paint_marks;
mod paint_words;
mod placed;
pub mod poles;
mod range;
mod reference_line;
pub mod requirements;
pub mod responses;
pub mod role;
mod stroke;
pub mod tables;
pub mod thinning;
mod ticks;
mod time_histories;
mod uncertainty_band;

pub use axis::Range;
pub use condition_source::ConditionSource;
pub use drawing::Color;
pub use figure::{Figure, Panel};
pub use figure_format::{ColumnWidth, FigureFormat};
pub use gains::all_channels;
pub use marks::{Mark, MarkId};
pub use role::Role;

use std::sync::Arc;

use gdcm_method::correction::Channel;
use gdcm_model::dataset::{ModelId, Pair};
use gdcm_model::progress::Unobserved;
use gdcm_study::jobs::curve_jobs::{AcrossRole, ConditionModes};
use gdcm_study::results::analysis::Analysis;
use gdcm_study::results::assessment_table::AssessmentChoice;
use gdcm_study::results::couplings_assessment::CouplingsAssessment;
use gdcm_study::results::record_history::RecordHistory;
use gdcm_study::results::requirements::Requirements;
use gdcm_study::results::test_input_responses::TestAnswers;

use assessment::{assessment_figure, evidence_figure, usual_choice};
use bode::{BodeOptions, airspeeds_figure, bode_figure, overview_figure};
use error::error_figure;
use gains::{Across, GainAxes, Measure, channels_figure, net_gain_figure};
use leads::leads_figure;
use poles::{PoleContents, couplings_figure, poles_figure, zeros_of_model};
use requirements::{record_history_figure, requirements_figure, test_answers_figure};

/// Kinds of figure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum FigureKind {
    /// Responses in a condition (Figures 2 and 5).
    #[default]
    Bode,
    /// Deviations of these responses from the reference, as used by the fit.
    Error,
    /// Overview of all responses in a condition.
    Overview,
    /// Net gains against airspeed (Figures 6 and 7).
    NetGain,
    /// Channel gains or delays (Figures 3 and 4).
    Channels,
    /// Contributions to the scatter of net gains.
    Evidence,
    /// Change in J due to the correction (Figures 8 to 19).
    Assessment,
    /// Poles of all models in a condition.
    Poles,
    /// Delay or lead of each channel in a condition, up to ten times the upper end of the band.
    Leads,
    /// Effect of couplings on the loop that they close, and on the poles in a condition.
    Couplings,
    /// Phase delay over bandwidth of attitude responses, or model responses over time.
    Requirements,
    /// A response in every condition, coloured by airspeed.
    Airspeeds,
}

impl FigureKind {
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

    /// Returns the name used in commands and file names.
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

    /// Returns whether the figure requires error bars, so that they must be computed for it.
    pub fn needs_bars(self) -> bool {
        matches!(self, Self::Evidence | Self::Requirements)
    }

    /// Returns whether the figure shows error bars if these are available.
    pub fn takes_bars(self) -> bool {
        matches!(self, Self::NetGain | Self::Channels)
    }

    /// Returns whether the figure shows a single condition.
    pub fn is_of_condition(self) -> bool {
        matches!(
            self,
            Self::Bode | Self::Error | Self::Overview | Self::Poles | Self::Leads
        )
    }
}

/// Model responses over time, with their excitation.
#[derive(Clone, Debug, PartialEq)]
pub enum OverTime {
    /// Responses to a test input.
    Test(Arc<TestAnswers>),
    /// Responses to the inputs of a flight record; the index selects the drawn input.
    Record(Arc<RecordHistory>, usize),
}

/// A request for a figure: its kind, contents and options. Each kind uses only the fields relevant
/// to it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FigureRequest {
    pub kind: FigureKind,
    pub pairs: Vec<Pair>,
    pub channels: Vec<Channel>,
    /// Quantity drawn for each channel: gain or delay.
    pub measure: Measure,
    /// Quantity on the horizontal axis of a figure of channels.
    pub across: Across,
    /// Choice for [`FigureKind::Assessment`]; [`usual_choice`] if `None`.
    pub assessed: Option<AssessmentChoice>,
    /// Role of the model drawn for each condition in [`FigureKind::Airspeeds`].
    pub across_role: AcrossRole,
    pub bode: BodeOptions,
    pub couplings: Option<Arc<CouplingsAssessment>>,
    pub requirements: Option<Arc<Requirements>>,
    /// Model responses that [`FigureKind::Requirements`] shows instead of bandwidths.
    pub over_time: Option<OverTime>,
}

impl FigureRequest {
    /// Creates a request for these responses and channels with default options.
    pub fn new(kind: FigureKind, pairs: Vec<Pair>, channels: Vec<Channel>) -> Self {
        Self {
            kind,
            pairs,
            channels,
            ..Self::default()
        }
    }

    /// Returns the figure, described from the analysis or, if it shows a single condition, from the
    /// condition's source. `None` if the source or the contents are missing.
    pub fn figure(
        &self,
        analysis: Option<&Analysis>,
        condition: Option<&ConditionSource<'_>>,
    ) -> Option<Figure> {
        match self.kind {
            FigureKind::Bode => Some(bode_figure(condition?, &self.pairs, &self.bode)),
            FigureKind::Error => Some(error_figure(condition?, &self.pairs, &self.bode)),
            FigureKind::Overview => Some(overview_figure(condition?, &self.bode)),
            FigureKind::NetGain => {
                let analysis = analysis?;
                let uncertainty = analysis.uncertainty.as_deref();
                Some(net_gain_figure(analysis, uncertainty, &self.pairs))
            }
            FigureKind::Channels => self.channels_figure(analysis?),
            FigureKind::Evidence => evidence_figure(analysis?, &self.pairs),
            FigureKind::Assessment => {
                let analysis = analysis?;
                let choice = self.assessed.unwrap_or_else(|| usual_choice(analysis));
                Some(assessment_figure(analysis, &self.pairs, choice))
            }
            FigureKind::Poles => self.poles_figure(condition?),
            FigureKind::Leads => Some(leads_figure(condition?, &self.pairs)),
            FigureKind::Requirements => self.requirements_figure(analysis?),
            FigureKind::Couplings => {
                let shown = condition.map(|source| source.curves.condition.id());
                couplings_figure(self.couplings.as_deref()?, shown, self.bode.unit)
            }
            FigureKind::Airspeeds => {
                airspeeds_figure(analysis?, &self.pairs, self.across_role, &self.bode)
            }
        }
    }

    fn channels_figure(&self, analysis: &Analysis) -> Option<Figure> {
        Some(channels_figure(
            analysis,
            analysis.uncertainty.as_deref(),
            &self.channels,
            GainAxes {
                measure: self.measure,
                across: self.across,
            },
        ))
    }

    /// Computes and plots modes and zeros of all models.
    fn poles_figure(&self, source: &ConditionSource<'_>) -> Option<Figure> {
        let modes = ConditionModes::compute(&source.curves.condition, &Unobserved).ok()?;
        let zeros = |id: &ModelId| match self.bode.zeros_of {
            Some(pair) => zeros_of_model(source, pair, id),
            None => Vec::new(),
        };
        let shifts = match source.analysis {
            Some(analysis) => analysis.pole_shifts(),
            None => Vec::new(),
        };
        let contents = PoleContents {
            modes: &modes,
            zeros_of: &zeros,
            shifts: &shifts,
        };
        Some(poles_figure(source, contents, &self.bode))
    }

    /// Plots model responses over time if requested, otherwise bandwidths.
    fn requirements_figure(&self, analysis: &Analysis) -> Option<Figure> {
        let study = &analysis.study;
        match &self.over_time {
            Some(OverTime::Test(answers)) => Some(test_answers_figure(answers, &study.dataset)),
            Some(OverTime::Record(history, input)) => {
                Some(record_history_figure(history, &study.dataset, *input))
            }
            None => Some(requirements_figure(
                self.requirements.as_deref()?,
                &study.dataset,
                &study.requirements.levels,
            )),
        }
    }
}
