//! Every setting that changes a result.

use crate::correction::{GainBounds, GainObjective};
use crate::dataset::{Band, Dataset, PairTable};
use crate::fidelity::CostAverage;
use crate::schedule::ScheduleSettings;

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
    /// Weight of the regularisation of the output delays, eq. (11).
    pub alpha_delay: f64,
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
}

impl Settings {
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
            gain_objective: GainObjective::Ratio,
            constrained: dataset.on_axis().clone(),
            fitted: PairTable::filled(outputs, inputs, true),
            quantile: 0.05,
            gain_bounds: None,
            delay_upper_s: None,
            agreement_db: DEFAULT_AGREEMENT_DB,
            schedule: ScheduleSettings::default(),
        }
    }
}
