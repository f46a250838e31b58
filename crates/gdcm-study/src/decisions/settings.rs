//! Settings common to all conditions, with their values as stored in files. Names, ranges and
//! controls are in [`super::setting`].
//!
//! G and D are the gain and the delay that would match a response, J the cost of the mismatch,
//! alpha the weight that holds the output gains near 1 and the output delays near 0 (M4 to M9).

use std::fmt;

use serde::{Deserialize, Serialize};

use gdcm_method::correction::delta::GainSource;
use gdcm_method::correction::lead_design::LeadSettings;
use gdcm_method::correction::{GainBounds, GainObjective};
use gdcm_method::couplings::CouplingKind;
use gdcm_method::fidelity::CostAverage;
use gdcm_method::schedule::{DelayScheduling, ScheduleSettings};
use gdcm_method::uncertainty::settings::UncertaintySettings;
use gdcm_model::dataset::limits::MOST_PAIRS;
use gdcm_model::dataset::{Band, Dataset, PairTable};
use gdcm_model::whole_number::whole;

use super::physics_settings::{PhysicsCorrection, PhysicsSettings};

/// Default for the maximum mismatch around a loop that counts as consistent \[dB\].
const DEFAULT_AGREEMENT_DB: f64 = 0.05;

/// Default for the minimum coherence (M4a).
pub const DEFAULT_COHERENCE: f64 = 0.6;

/// Phase correction method.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PhaseCorrection {
    /// No phase correction: gains only.
    None,
    /// By delays (the paper, M9).
    #[default]
    Delay,
    /// By one signed delay for each channel, which a lead filter realises where it is negative
    /// (M15).
    Lead,
}

/// Correction for couplings and modes in the physics models, applied before the channel correction
/// (M16).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum CouplingCorrection {
    /// No correction: the physics models are unchanged (the paper).
    #[default]
    None,
    /// The inputs are mixed.
    Mixing,
    /// The inputs are mixed, and outputs are fed back to inputs.
    #[serde(rename = "feedback")]
    MixingAndFeedback,
}

impl CouplingCorrection {
    /// Returns the name in sentences; "no couplings" for none.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "no couplings",
            Self::Mixing => "mixing",
            Self::MixingAndFeedback => "mixing and feedback",
        }
    }

    /// Returns which couplings to fit; `None` without couplings.
    pub fn kind(self) -> Option<CouplingKind> {
        match self {
            Self::None => None,
            Self::Mixing => Some(CouplingKind::Mixing),
            Self::MixingAndFeedback => Some(CouplingKind::MixingAndFeedback),
        }
    }
}

/// Definition of the D to which the delays are fitted. Leads are always fitted to the band delay
/// (M15.5).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DelayFrom {
    /// The median of `Delta phi / omega`, eq. (9) (the paper).
    #[default]
    Median,
    /// The band delay: the least-squares line through `Delta phi` (M15.2).
    Band,
}

impl fmt::Display for DelayFrom {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Median => "median of Δφ/ω, eq. (9)",
            Self::Band => "line through Δφ over the band",
        })
    }
}

/// Responses by channel names, output first, as stored in files.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "Vec<(String, String)>")]
pub struct ResponseNames(pub Vec<(String, String)>);

impl TryFrom<Vec<(String, String)>> for ResponseNames {
    type Error = String;

    fn try_from(names: Vec<(String, String)>) -> Result<Self, String> {
        let found = names.len();
        if found > MOST_PAIRS {
            return Err(format!(
                "expected at most {MOST_PAIRS} entries, found {found}"
            ));
        }
        Ok(Self(names))
    }
}

/// Settings common to all conditions in a study; requirement settings are separate. `R` is the type
/// for a set of responses: a table over the dataset, or names in files. A setting that an older
/// file does not contain has its field's default, which may differ from its value in a new study
/// ([`Settings::for_dataset`]).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings<R = PairTable<bool>> {
    #[serde(rename = "band_rad_s")]
    pub band: Band,
    /// Number of logarithmically spaced frequencies in the band, both ends included (M2).
    #[serde(deserialize_with = "whole")]
    pub points: usize,
    /// Regularisation weight for the output gains, eq. (7).
    pub alpha_gain: f64,
    /// Regularisation weight for the output delays, eq. (11), or for all signed delays (M15.4).
    pub alpha_delay: f64,
    /// Quantile from which the bounds are computed, together with its complement (M7).
    pub quantile: f64,
    /// The responses constrained exactly; initially the on-axis pairs.
    pub constrained: R,
    /// The responses that the objective ignores (weight 0); it fits the others (weight 1).
    pub ignored: R,
    /// Average over frequency in J: the median (the paper) or the mean (Tischler) (M4).
    pub cost_average: CostAverage,
    /// Minimum coherence \[-\] at which a frequency counts, if the reference carries coherence;
    /// coherence then also weights J, G and D. `None` ignores coherence (M4a).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coherence_threshold: Option<f64>,
    pub gain_objective: GainObjective,
    /// Manual bounds on every channel gain, instead of the quantiles.
    pub gain_bounds: Option<GainBounds>,
    /// Manual upper bound on every channel delay \[s\], instead of the quantile.
    pub delay_upper_s: Option<f64>,
    /// Phase correction (M9, M15).
    #[serde(default)]
    pub phase: PhaseCorrection,
    /// Definition of the D to which the delays are fitted (M15.2).
    #[serde(default)]
    pub delay_from: DelayFrom,
    /// Parameters common to all lead filters (M15.3).
    #[serde(default, skip_serializing_if = "is_default")]
    pub lead: LeadSettings,
    /// How couplings and modes are corrected (M16).
    #[serde(default, skip_serializing_if = "is_default")]
    pub couplings: CouplingCorrection,
    /// Which physics parameters move the physics models (M18.5).
    #[serde(default, skip_serializing_if = "is_default")]
    pub physics: PhysicsCorrection,
    /// Decisions about the physics parameters (M18).
    #[serde(default, skip_serializing_if = "is_default")]
    pub physics_parameters: PhysicsSettings,
    /// Maximum mismatch \[dB\] between constrained gains around a loop at which they count as
    /// consistent: each is then constrained at the nearest consistent value.
    #[serde(default = "default_agreement_db")]
    pub agreement_db: f64,
    /// How channel gains depend on airspeed (M11).
    #[serde(default)]
    pub schedule: ScheduleSettings,
    /// Whether the schedule has delays too (M11). Files from earlier versions only contain
    /// `schedule.delays` ([`Settings::complete_delay_scheduling`]).
    #[serde(default = "never_scheduled")]
    pub schedule_delays: DelayScheduling,
    /// The models from which G is computed.
    #[serde(default, rename = "gain_from")]
    pub gain_source: GainSource,
    /// Options for error bars (M13).
    #[serde(default, rename = "error_bars")]
    pub uncertainty: UncertaintySettings,
}

fn never_scheduled() -> DelayScheduling {
    DelayScheduling::Never
}

fn default_agreement_db() -> f64 {
    DEFAULT_AGREEMENT_DB
}

pub(crate) fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// How a response is marked in the settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResponseMark {
    /// Constrained.
    Held,
    /// Excluded from the objective.
    Ignored,
}

impl<R> Settings<R> {
    /// Returns the same settings with another type for sets of responses. `convert` converts a set;
    /// its first argument says how the responses in the set are marked.
    pub fn with_responses<Q>(&self, mut convert: impl FnMut(ResponseMark, &R) -> Q) -> Settings<Q> {
        Settings {
            band: self.band,
            points: self.points,
            alpha_gain: self.alpha_gain,
            alpha_delay: self.alpha_delay,
            quantile: self.quantile,
            constrained: convert(ResponseMark::Held, &self.constrained),
            ignored: convert(ResponseMark::Ignored, &self.ignored),
            cost_average: self.cost_average,
            coherence_threshold: self.coherence_threshold,
            gain_objective: self.gain_objective,
            gain_bounds: self.gain_bounds,
            delay_upper_s: self.delay_upper_s,
            phase: self.phase,
            delay_from: self.delay_from,
            lead: self.lead,
            couplings: self.couplings,
            physics: self.physics,
            physics_parameters: self.physics_parameters.clone(),
            agreement_db: self.agreement_db,
            schedule: self.schedule,
            schedule_delays: self.schedule_delays,
            gain_source: self.gain_source,
            uncertainty: self.uncertainty,
        }
    }

    /// Sets whether the schedule has delays, and the corresponding flag for earlier program
    /// versions.
    pub fn set_delay_scheduling(&mut self, scheduling: DelayScheduling) {
        self.schedule_delays = scheduling;
        self.schedule.delays = scheduling == DelayScheduling::Always;
    }

    /// Adopts `schedule.delays` from a file that lacks the newer setting: `true` becomes always,
    /// `false` becomes never. A file that has the newer setting is unaffected, because
    /// [`Self::set_delay_scheduling`] keeps both consistent.
    pub fn complete_delay_scheduling(&mut self) {
        if self.schedule_delays == DelayScheduling::Never {
            self.set_delay_scheduling(self.schedule.delays.into());
        }
    }
}

impl Settings {
    /// Returns the settings for a new study of `dataset`.
    pub fn for_dataset(dataset: &Dataset) -> Self {
        let none = PairTable::filled(dataset.outputs().len(), dataset.inputs().len(), false);
        Self {
            band: dataset.band(),
            points: 200,
            alpha_gain: 1.0,
            alpha_delay: 1.0,
            quantile: 0.05,
            constrained: dataset.on_axis().clone(),
            ignored: none,
            cost_average: CostAverage::Median,
            coherence_threshold: dataset.has_coherence().then_some(DEFAULT_COHERENCE),
            gain_objective: GainObjective::Ratio,
            gain_bounds: None,
            delay_upper_s: None,
            phase: PhaseCorrection::default(),
            delay_from: DelayFrom::default(),
            lead: LeadSettings::default(),
            couplings: CouplingCorrection::default(),
            physics: PhysicsCorrection::default(),
            physics_parameters: PhysicsSettings::default(),
            agreement_db: DEFAULT_AGREEMENT_DB,
            schedule: ScheduleSettings::default(),
            schedule_delays: DelayScheduling::default(),
            gain_source: GainSource::default(),
            uncertainty: UncertaintySettings::default(),
        }
    }

    /// Returns the settings with responses by channel names, as stored in files.
    pub fn named(&self, dataset: &Dataset) -> Settings<ResponseNames> {
        self.with_responses(|_, table| {
            ResponseNames(
                table
                    .marked()
                    .map(|pair| dataset.output_and_input_name(pair))
                    .collect(),
            )
        })
    }

    /// Returns the responses that the objective fits.
    pub fn fitted(&self) -> PairTable<bool> {
        self.ignored.map(|_, ignored| !ignored)
    }

    /// Returns whether [`GainSource::MeanOfPairs`] is requested but has no effect: with leads, the
    /// gains are fitted to the representatives' difference after the leads (M15.5).
    pub fn is_gain_source_idle(&self) -> bool {
        self.gain_source == GainSource::MeanOfPairs && self.phase == PhaseCorrection::Lead
    }
}
