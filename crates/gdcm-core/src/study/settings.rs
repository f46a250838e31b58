//! Every setting that changes a result.

use crate::correction::{GainBounds, GainObjective, GainSource, LeadSettings};
use crate::dataset::{Band, Dataset, PairTable};
use crate::fidelity::CostAverage;
use crate::schedule::ScheduleSettings;
use crate::uncertainty::UncertaintySettings;

/// Fewest frequencies of a band.
pub const LEAST_POINTS: usize = 2;
/// Most frequencies of a band.
pub const MOST_POINTS: usize = 5000;
/// Largest weight of the regularisation; beyond it the optimum no longer moves.
pub const LARGEST_ALPHA: f64 = 1e6;
/// Greatest quantile of the bounds: the median.
pub const GREATEST_QUANTILE: f64 = 0.5;
/// Greatest upper bound of a channel delay \[s\].
pub const GREATEST_DELAY_S: f64 = 1e3;
/// Least lower bound of a channel gain (-120 dB).
pub const LEAST_GAIN: f64 = 1e-6;
/// Greatest upper bound of a channel gain (120 dB).
pub const GREATEST_GAIN: f64 = 1e6;

/// Greatest mismatch of a loop of held gains that may count as agreement \[dB\].
pub const GREATEST_AGREEMENT_DB: f64 = 3.0;
/// Mismatch of a loop of held gains that counts as agreement \[dB\] before any decision.
pub const DEFAULT_AGREEMENT_DB: f64 = 0.05;

/// Least coherence of a frequency that counts before any decision (M4a).
pub const DEFAULT_COHERENCE: f64 = 0.6;

/// Least and greatest `n` of the lead filters, of which the lag time constant is `1 / (n omega_B)` (M15.3).
pub const LEAD_POLES: [f64; 2] = [2.0, 10.0];
/// Least and greatest limit of the gain of a lead filter at high frequency (0 and 40 dB).
pub const LEAD_LIMITS: [f64; 2] = [1.0, 100.0];

/// How the phase is corrected.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum PhaseCorrection {
    /// Not at all: gains alone.
    None,
    /// By delays (the paper, M9).
    #[default]
    Delay,
    /// By one signed delay a channel: a delay, or a lead filter where it is negative (M15).
    Lead,
}

impl PhaseCorrection {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::None, Self::Delay, Self::Lead];

    /// Its name in files and on a command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Delay => "delay",
            Self::Lead => "lead",
        }
    }

    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Delay => "delay",
            Self::Lead => "delay or lead",
        }
    }
}

/// Which D the delays are fitted to. Leads are always fitted to the band delay (M15.5).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum DelayFrom {
    /// The median of `Delta phi / omega`, eq. (9) (the paper).
    #[default]
    Median,
    /// The band delay: the straight line of least squares through `Delta phi` (M15.2).
    Band,
}

impl DelayFrom {
    /// Both of them.
    pub const ALL: [Self; 2] = [Self::Median, Self::Band];

    /// Its name in files and on a command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Median => "median",
            Self::Band => "band",
        }
    }

    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Median => "median of Δφ/ω, eq. (9)",
            Self::Band => "line through Δφ over the band",
        }
    }
}

/// Every setting that changes a result; the same for all conditions of a study.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Band over which models are compared.
    pub band: Band,
    /// Number of logarithmically spaced frequencies in the band, both ends included (M2).
    pub points: usize,
    /// Whether J takes the median over frequency (the paper) or the mean (Tischler) (M4).
    pub cost_average: CostAverage,
    /// Least coherence of a frequency that counts, where the reference is measured with coherence, which then weighs J, G and D
    /// too; none: coherence counts for nothing (M4a).
    pub coherence_threshold: Option<f64>,
    /// Weight of the regularisation of the output gains, eq. (7).
    pub alpha_gain: f64,
    /// Weight of the regularisation of the output delays, eq. (11), or of all signed delays (M15.4).
    pub alpha_delay: f64,
    /// Which models G is taken from.
    pub gain_source: GainSource,
    /// How the phase is corrected (M9, M15).
    pub phase: PhaseCorrection,
    /// Which D the delays are fitted to (M15.2).
    pub delay_from: DelayFrom,
    /// What lead filters have in common (M15.3).
    pub lead: LeadSettings,
    /// What the gains minimise.
    pub gain_objective: GainObjective,
    /// Which responses are held exactly; they start as the on-axis pairs.
    pub constrained: PairTable<bool>,
    /// Which responses the objective fits (weight 1) and which it ignores (weight 0).
    pub fitted: PairTable<bool>,
    /// Quantile that sets the bounds, and its complement (M7).
    pub quantile: f64,
    /// Bounds of every channel gain set by hand, in place of the quantiles.
    pub gain_bounds: Option<GainBounds>,
    /// Upper bound of every channel delay \[s\] set by hand, in place of the quantile.
    pub delay_upper_s: Option<f64>,
    /// Mismatch \[dB\] up to which a loop of held gains counts as agreeing: each is then held at the nearest that does.
    pub agreement_db: f64,
    /// How channel gains are scheduled with airspeed (M11).
    pub schedule: ScheduleSettings,
    /// How bars are made (M13).
    pub uncertainty: UncertaintySettings,
}

impl Settings {
    /// Which models G is taken from, in words; and that the setting has no effect where the gains are found on what leads leave,
    /// which is a matter of the representatives (M15.5).
    pub fn gain_source_words(&self) -> String {
        let words = self.gain_source.words();
        if self.gain_source == GainSource::MeanOfPairs && self.phase == PhaseCorrection::Lead {
            return format!("{words}, without effect: with leads, G is that of what they leave of the representatives");
        }
        words.to_owned()
    }

    /// The settings a dataset starts with.
    pub fn of(dataset: &Dataset) -> Self {
        let (outputs, inputs) = (dataset.outputs().len(), dataset.inputs().len());
        Self {
            band: dataset.band(),
            points: 200,
            cost_average: CostAverage::Median,
            coherence_threshold: dataset.has_coherence().then_some(DEFAULT_COHERENCE),
            alpha_gain: 1.0,
            alpha_delay: 1.0,
            gain_source: GainSource::default(),
            phase: PhaseCorrection::default(),
            delay_from: DelayFrom::default(),
            lead: LeadSettings::default(),
            gain_objective: GainObjective::Ratio,
            constrained: dataset.on_axis().clone(),
            fitted: PairTable::filled(outputs, inputs, true),
            quantile: 0.05,
            gain_bounds: None,
            delay_upper_s: None,
            agreement_db: DEFAULT_AGREEMENT_DB,
            schedule: ScheduleSettings::default(),
            uncertainty: UncertaintySettings::default(),
        }
    }
}
