//! Settings as the files of studies and of results say them.

use serde::{Deserialize, Serialize};

use gdcm_core::correction::{GainBounds, GainObjective, GainSource, LeadSettings};
use gdcm_core::dataset::limits::MOST_PAIRS;
use gdcm_core::dataset::{Band, Dataset, Location, PairTable};
use gdcm_core::fidelity::CostAverage;
use gdcm_core::response::LeadOrder;
use gdcm_core::schedule::{DEFAULT_TOLERANCE_KT, ScheduleKind, ScheduleSettings, ScheduledQuantity, SecondVariable};
use gdcm_core::study::{DEFAULT_AGREEMENT_DB, DelayFrom, EditRefusal, PhaseCorrection, Setting, Settings};
use gdcm_core::uncertainty::UncertaintySettings;

use crate::file_error::ContentError;
use crate::file_error::ContentFault;
use crate::json_text::list;

/// Every setting that changes a result.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SettingsEntry {
    /// Band of comparison \[rad/s\].
    pub band_rad_s: [f64; 2],
    /// Number of frequencies.
    pub points: usize,
    /// Weight of the regularisation of the gains.
    pub alpha_gain: f64,
    /// Weight of the regularisation of the delays.
    pub alpha_delay: f64,
    /// Quantile that sets the bounds.
    pub quantile: f64,
    /// Responses to be held, `[output, input]`.
    #[serde(deserialize_with = "list::<MOST_PAIRS, _, _>")]
    pub constrained: Vec<(String, String)>,
    /// Responses that the objective ignores, `[output, input]`.
    #[serde(deserialize_with = "list::<MOST_PAIRS, _, _>")]
    pub ignored: Vec<(String, String)>,
    /// `median` or `mean`: the average over frequency in J.
    #[serde(with = "CostAverageWord")]
    pub cost_average: CostAverage,
    /// Least coherence that counts; without it coherence counts for nothing, as in files of older programs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coherence_threshold: Option<f64>,
    /// `ratio` or `dB`: what the gains minimise.
    #[serde(with = "GainObjectiveWord")]
    pub gain_objective: GainObjective,
    /// Gain bounds set by hand.
    pub gain_bounds: Option<[f64; 2]>,
    /// Upper bound of the delays set by hand \[s\].
    pub delay_upper_s: Option<f64>,
    /// `none`, `delay` or `lead`: how the phase is corrected; files of older programs do not say it.
    #[serde(default, with = "PhaseWord")]
    pub phase: PhaseCorrection,
    /// `median` or `band`: which D the delays are fitted to; files of older programs do not say it.
    #[serde(default, with = "DelayFromWord")]
    pub delay_from: DelayFrom,
    /// What lead filters have in common; absent where that is what it is before any decision.
    #[serde(default, skip_serializing_if = "LeadSettingsEntry::is_default")]
    pub lead: LeadSettingsEntry,
    /// Mismatch up to which a loop of held gains counts as agreeing \[dB\]; files of older programs do not say it.
    #[serde(default = "default_agreement_db")]
    pub agreement_db: f64,
    /// How gains are scheduled; results of older programs do not say it.
    #[serde(default)]
    pub schedule: ScheduleEntry,
    /// `representatives` or `mean`: what G is taken from; files of older programs do not say it.
    #[serde(default, with = "GainSourceWord")]
    pub gain_from: GainSource,
    /// How error bars are made; files of older programs do not say it.
    #[serde(default)]
    pub error_bars: ErrorBarsEntry,
}

/// How error bars are made.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ErrorBarsEntry {
    /// Level of every bar, interval and test.
    pub level: f64,
    /// Degrees of freedom that a condition's identification part borrows at most.
    pub prior_degrees: f64,
    /// Averages of measured responses that do not say it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub averages: Option<f64>,
    /// Length of the windows of measured responses that do not say it \[s\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub window_s: Option<f64>,
    /// Whether those windows overlap by half.
    #[serde(default)]
    pub half_overlap: bool,
}

impl Default for ErrorBarsEntry {
    fn default() -> Self {
        Self::of(UncertaintySettings::default())
    }
}

impl ErrorBarsEntry {
    fn of(settings: UncertaintySettings) -> Self {
        let UncertaintySettings { level, prior_degrees, averages, window_s, half_overlap } = settings;
        Self { level, prior_degrees, averages, window_s, half_overlap }
    }

    fn settings(&self) -> UncertaintySettings {
        let Self { level, prior_degrees, averages, window_s, half_overlap } = *self;
        UncertaintySettings { level, prior_degrees, averages, window_s, half_overlap }
    }
}

/// How gains are scheduled with airspeed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScheduleEntry {
    /// `polynomial` or `table`.
    pub kind: KindWord,
    /// Degree of the polynomial; none for a table.
    pub degree: Option<usize>,
    /// `ln k` or `k`.
    #[serde(with = "QuantityWord")]
    pub of: ScheduledQuantity,
    /// Whether delays are scheduled too.
    pub delays: bool,
    /// Airspeeds nearer to one another are one \[kt\].
    #[serde(default = "default_tolerance_kt")]
    pub airspeed_tolerance_kt: f64,
    /// `altitude` or `mass`: what is scheduled beside airspeed, where something is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub second_variable: Option<SecondVariableWord>,
    /// Degree of the polynomial of signed delays; absent where it is 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub tau_degree: usize,
}

/// What lead filters have in common (M15.3).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LeadSettingsEntry {
    /// Order, 1 or 2.
    pub order: usize,
    /// `n`: the lag time constant is `1 / (n omega_B)`.
    pub n: f64,
    /// Greatest gain of a filter at high frequency (ratio).
    pub r_max: f64,
}

impl Default for LeadSettingsEntry {
    fn default() -> Self {
        Self::of(LeadSettings::default())
    }
}

impl LeadSettingsEntry {
    fn of(settings: LeadSettings) -> Self {
        Self { order: settings.order.number(), n: settings.pole, r_max: settings.limit }
    }

    fn is_default(&self) -> bool {
        *self == Self::default()
    }

    fn order(&self) -> Result<LeadOrder, ContentError> {
        let orders = [LeadOrder::First, LeadOrder::Second];
        orders.into_iter().find(|order| order.number() == self.order).ok_or_else(|| {
            let (expected, found) = ("1 or 2".to_owned(), self.order as f64);
            let refusal = EditRefusal::OutOfRange { setting: "order of the lead filters", expected, found };
            ContentError::new(Location::entry("settings, lead, order"), refusal)
        })
    }
}

fn is_zero(count: &usize) -> bool {
    *count == 0
}

impl Default for ScheduleEntry {
    fn default() -> Self {
        Self::of(ScheduleSettings::default())
    }
}

fn default_agreement_db() -> f64 {
    DEFAULT_AGREEMENT_DB
}

fn default_tolerance_kt() -> f64 {
    DEFAULT_TOLERANCE_KT
}

/// The form of a schedule.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum KindWord {
    /// A polynomial in airspeed.
    Polynomial,
    /// A lookup table.
    Table,
}

#[derive(Serialize, Deserialize)]
#[serde(remote = "CostAverage", rename_all = "lowercase")]
enum CostAverageWord {
    Median,
    Mean,
}

/// A variable besides airspeed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SecondVariableWord {
    /// Altitude.
    Altitude,
    /// Mass.
    Mass,
}

impl SecondVariableWord {
    pub(super) fn of(variable: SecondVariable) -> Self {
        match variable {
            SecondVariable::Altitude => Self::Altitude,
            SecondVariable::Mass => Self::Mass,
        }
    }

    fn variable(self) -> SecondVariable {
        match self {
            Self::Altitude => SecondVariable::Altitude,
            Self::Mass => SecondVariable::Mass,
        }
    }
}

#[derive(Serialize, Deserialize)]
#[serde(remote = "GainSource")]
enum GainSourceWord {
    #[serde(rename = "representatives")]
    Representatives,
    #[serde(rename = "mean")]
    MeanOfPairs,
}

#[derive(Serialize, Deserialize)]
#[serde(remote = "PhaseCorrection", rename_all = "lowercase")]
enum PhaseWord {
    None,
    Delay,
    Lead,
}

#[derive(Serialize, Deserialize)]
#[serde(remote = "DelayFrom", rename_all = "lowercase")]
enum DelayFromWord {
    Median,
    Band,
}

#[derive(Serialize, Deserialize)]
#[serde(remote = "GainObjective")]
enum GainObjectiveWord {
    #[serde(rename = "ratio")]
    Ratio,
    #[serde(rename = "dB")]
    Decibel,
}

#[derive(Serialize, Deserialize)]
#[serde(remote = "ScheduledQuantity")]
enum QuantityWord {
    #[serde(rename = "ln k")]
    LnGain,
    #[serde(rename = "k")]
    Gain,
}

impl SettingsEntry {
    /// The settings of a study of `dataset`, responses by the names of their channels.
    pub(super) fn of(settings: &Settings, dataset: &Dataset) -> Self {
        let names = |table: &PairTable<bool>| table.marked().map(|pair| dataset.channel_names(pair)).collect();
        Self {
            band_rad_s: [settings.band.min(), settings.band.max()],
            points: settings.points,
            alpha_gain: settings.alpha_gain,
            alpha_delay: settings.alpha_delay,
            quantile: settings.quantile,
            constrained: names(&settings.constrained),
            ignored: names(&settings.fitted.map(|_, fitted| !fitted)),
            cost_average: settings.cost_average,
            coherence_threshold: settings.coherence_threshold,
            gain_objective: settings.gain_objective,
            gain_bounds: settings.gain_bounds.map(|bounds| [bounds.lower, bounds.upper]),
            delay_upper_s: settings.delay_upper_s,
            phase: settings.phase,
            delay_from: settings.delay_from,
            lead: LeadSettingsEntry::of(settings.lead),
            agreement_db: settings.agreement_db,
            schedule: ScheduleEntry::of(settings.schedule),
            gain_from: settings.gain_source,
            error_bars: ErrorBarsEntry::of(settings.uncertainty),
        }
    }

    /// Takes everything but the two lists of responses into `settings`; each value has to be within its range.
    pub(super) fn take_into(&self, settings: &mut Settings) -> Result<(), ContentError> {
        let place = |key: &str| Location::entry(format!("settings, {key}"));
        let [min, max] = self.band_rad_s;
        let band = Band::new(min, max).map_err(|error| ContentError::new(place("band_rad_s"), error))?;
        let bounds = self.gain_bounds.map(|[lower, upper]| GainBounds { lower, upper });
        let decided = [
            ("band_rad_s", Setting::Band(band)),
            ("points", Setting::Points(self.points)),
            ("cost_average", Setting::CostAverage(self.cost_average)),
            ("coherence_threshold", Setting::Coherence(self.coherence_threshold)),
            ("alpha_gain", Setting::AlphaGain(self.alpha_gain)),
            ("alpha_delay", Setting::AlphaDelay(self.alpha_delay)),
            ("gain_objective", Setting::GainObjective(self.gain_objective)),
            ("quantile", Setting::Quantile(self.quantile)),
            ("gain_bounds", Setting::GainBounds(bounds)),
            ("delay_upper_s", Setting::DelayUpper(self.delay_upper_s)),
            ("phase", Setting::Phase(self.phase)),
            ("delay_from", Setting::DelayFrom(self.delay_from)),
            ("lead, order", Setting::LeadOrder(self.lead.order()?)),
            ("lead, n", Setting::LeadPole(self.lead.n)),
            ("lead, r_max", Setting::LeadLimit(self.lead.r_max)),
            ("agreement_db", Setting::Agreement(self.agreement_db)),
            ("schedule", Setting::Schedule(self.schedule.settings()?)),
            ("gain_from", Setting::GainSource(self.gain_from)),
            ("error_bars", Setting::Uncertainty(self.error_bars.settings())),
        ];
        for (key, setting) in decided {
            settings.apply(&setting).map_err(|refusal| ContentError::new(place(key), refusal))?;
        }
        Ok(())
    }
}

impl ScheduleEntry {
    fn of(settings: ScheduleSettings) -> Self {
        let (kind, degree) = match settings.kind {
            ScheduleKind::Polynomial { degree } => (KindWord::Polynomial, Some(degree)),
            ScheduleKind::Table => (KindWord::Table, None),
        };
        let ScheduleSettings { quantity: of, delays, airspeed_tolerance_kt, tau_degree, second, .. } = settings;
        let second_variable = second.map(SecondVariableWord::of);
        Self { kind, degree, of, delays, airspeed_tolerance_kt, tau_degree, second_variable }
    }

    fn settings(&self) -> Result<ScheduleSettings, ContentError> {
        let kind = match (self.kind, self.degree) {
            (KindWord::Table, _) => ScheduleKind::Table,
            (KindWord::Polynomial, Some(degree)) => ScheduleKind::Polynomial { degree },
            (KindWord::Polynomial, None) => {
                let fault = ContentFault::MissingKey { key: "degree".to_owned() };
                return Err(ContentError::new(Location::entry("settings, schedule"), fault));
            }
        };
        let Self { of: quantity, delays, airspeed_tolerance_kt, tau_degree, .. } = *self;
        let second = self.second_variable.map(SecondVariableWord::variable);
        Ok(ScheduleSettings { kind, quantity, delays, airspeed_tolerance_kt, tau_degree, second })
    }
}
