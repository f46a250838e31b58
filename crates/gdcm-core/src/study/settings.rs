//! Every setting that changes a result.

use crate::correction::{GainBounds, GainObjective, GainSource, LeadSettings};
use crate::dataset::{Band, Dataset, Pair, PairTable};
use crate::fidelity::CostAverage;
use crate::response::LeadOrder;
use crate::schedule::{HIGHEST_DEGREE, ScheduleKind, ScheduleSettings};
use crate::uncertainty::{GREATEST_MEASUREMENT, GREATEST_PRIOR, LEVELS, UncertaintySettings};
use crate::units::number;

use super::EditRefusal;

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

/// Widest gap \[kt\] within which airspeeds may be taken as one.
const LARGEST_TOLERANCE_KT: f64 = 100.0;

/// The new value of one setting.
#[derive(Clone, Debug, PartialEq)]
pub enum Setting {
    /// Hold a response exactly, or free it.
    Constrained(Pair, bool),
    /// Fit a response, or ignore it.
    Fitted(Pair, bool),
    /// Weight of the regularisation of the output gains.
    AlphaGain(f64),
    /// Weight of the regularisation of the output delays.
    AlphaDelay(f64),
    /// Band of comparison.
    Band(Band),
    /// Number of frequencies in the band.
    Points(usize),
    /// Median or mean in J.
    CostAverage(CostAverage),
    /// Least coherence that counts; `None` lets coherence count for nothing.
    Coherence(Option<f64>),
    /// Which models G is taken from.
    GainSource(GainSource),
    /// How the phase is corrected.
    Phase(PhaseCorrection),
    /// Which D the delays are fitted to.
    DelayFrom(DelayFrom),
    /// Order of the lead filters.
    LeadOrder(LeadOrder),
    /// `n` of the lead filters.
    LeadPole(f64),
    /// Greatest gain of a lead filter at high frequency.
    LeadLimit(f64),
    /// What the gains minimise.
    GainObjective(GainObjective),
    /// Quantile that sets the bounds.
    Quantile(f64),
    /// Bounds of the gains by hand; `None` goes back to the quantiles.
    GainBounds(Option<GainBounds>),
    /// Upper bound of the delays by hand \[s\]; `None` goes back to the quantile.
    DelayUpper(Option<f64>),
    /// Mismatch of a loop of held gains that counts as agreement \[dB\].
    Agreement(f64),
    /// How gains are scheduled.
    Schedule(ScheduleSettings),
    /// How bars are made.
    Uncertainty(UncertaintySettings),
}

impl Setting {
    /// The change in a few words, for the undo list: "free LON → Q".
    pub fn label(&self, dataset: &Dataset) -> String {
        let (verb, pair) = match self {
            Setting::Constrained(pair, true) => ("hold", pair),
            Setting::Constrained(pair, false) => ("free", pair),
            Setting::Fitted(pair, true) => ("fit", pair),
            Setting::Fitted(pair, false) => ("ignore", pair),
            _ => return self.name().to_owned(),
        };
        format!("{verb} {}", dataset.pair_name(*pair))
    }

    fn name(&self) -> &'static str {
        match self {
            Setting::Constrained(..) => "held responses",
            Setting::Fitted(..) => "fitted responses",
            Setting::AlphaGain(_) => "α of the gains",
            Setting::AlphaDelay(_) => "α of the delays",
            Setting::Band(_) => "frequency band",
            Setting::Points(_) => "number of frequencies",
            Setting::CostAverage(_) => "average in J",
            Setting::Coherence(_) => "coherence threshold",
            Setting::GainSource(_) => "source of G",
            Setting::Phase(_) => "phase correction",
            Setting::DelayFrom(_) => "D of the delays",
            Setting::LeadOrder(_) => "order of the lead filters",
            Setting::LeadPole(_) => "n of the lead filters",
            Setting::LeadLimit(_) => "R_max of the lead filters",
            Setting::GainObjective(_) => "objective of the gains",
            Setting::Quantile(_) => "quantile of the bounds",
            Setting::GainBounds(_) => "gain bounds",
            Setting::DelayUpper(_) => "upper delay bound",
            Setting::Agreement(_) => "agreement tolerance",
            Setting::Schedule(_) => "schedule",
            Setting::Uncertainty(_) => "error bars",
        }
    }

    /// Whether two changes in a row are one to the engineer: two positions of the same slider.
    pub fn continues(&self, earlier: &Setting) -> bool {
        let slides = !matches!(self, Setting::Constrained(..) | Setting::Fitted(..));
        slides && std::mem::discriminant(self) == std::mem::discriminant(earlier)
    }

    fn check_range(&self, what: &str, found: f64, least: f64, most: f64) -> Result<(), EditRefusal> {
        if (least..=most).contains(&found) {
            return Ok(());
        }
        let expected = format!("{what} from {} to {}", number(least), number(most));
        Err(EditRefusal::OutOfRange { setting: self.name(), expected, found })
    }

    fn check(&self) -> Result<(), EditRefusal> {
        match self {
            Setting::AlphaGain(alpha) | Setting::AlphaDelay(alpha) => {
                self.check_range("a number", *alpha, 0.0, LARGEST_ALPHA)
            }
            Setting::LeadPole(pole) => self.check_range("a number", *pole, LEAD_POLES[0], LEAD_POLES[1]),
            Setting::LeadLimit(limit) => self.check_range("a ratio", *limit, LEAD_LIMITS[0], LEAD_LIMITS[1]),
            Setting::Schedule(ScheduleSettings { kind, airspeed_tolerance_kt, tau_degree, .. }) => {
                self.check_range("a whole number", *tau_degree as f64, 0.0, HIGHEST_DEGREE as f64)?;
                if let ScheduleKind::Polynomial { degree } = kind {
                    self.check_range("a whole number", *degree as f64, 0.0, HIGHEST_DEGREE as f64)?;
                }
                self.check_range("a number", *airspeed_tolerance_kt, 0.0, LARGEST_TOLERANCE_KT)
            }
            Setting::Points(points) => {
                self.check_range("a whole number", *points as f64, LEAST_POINTS as f64, MOST_POINTS as f64)
            }
            Setting::Coherence(Some(threshold)) => self.check_range("a number", *threshold, 0.0, 1.0),
            Setting::Quantile(quantile) => self.check_range("a number", *quantile, 0.0, GREATEST_QUANTILE),
            Setting::GainBounds(Some(GainBounds { lower, upper })) => {
                self.check_range("a lower bound", *lower, LEAST_GAIN, GREATEST_GAIN)?;
                self.check_range("an upper bound", *upper, *lower, GREATEST_GAIN)
            }
            Setting::DelayUpper(Some(upper)) => self.check_range("a number of seconds", *upper, 0.0, GREATEST_DELAY_S),
            Setting::Agreement(tolerance) => self.check_range("a number of dB", *tolerance, 0.0, GREATEST_AGREEMENT_DB),
            Setting::Uncertainty(UncertaintySettings { level, prior_degrees, averages, window_s, .. }) => {
                self.check_range("a level", *level, LEVELS[0], LEVELS[1])?;
                self.check_range("a number of degrees of freedom", *prior_degrees, 0.0, GREATEST_PRIOR)?;
                let measured = [("a number of averages", averages), ("a number of seconds", window_s)];
                measured.into_iter().try_for_each(|(what, found)| {
                    found.map_or(Ok(()), |found| self.check_range(what, found, 1e-6, GREATEST_MEASUREMENT))
                })
            }
            // A band is checked where it is made.
            _ => Ok(()),
        }
    }
}

impl Settings {
    /// Changes one setting, or refuses a value outside its range and leaves the settings as they were.
    pub fn apply(&mut self, setting: &Setting) -> Result<(), EditRefusal> {
        setting.check()?;
        match setting {
            Setting::Constrained(pair, held) => mark(&mut self.constrained, *pair, *held)?,
            Setting::Fitted(pair, fitted) => mark(&mut self.fitted, *pair, *fitted)?,
            Setting::AlphaGain(alpha) => self.alpha_gain = *alpha,
            Setting::AlphaDelay(alpha) => self.alpha_delay = *alpha,
            Setting::Band(band) => self.band = *band,
            Setting::Points(points) => self.points = *points,
            Setting::CostAverage(average) => self.cost_average = *average,
            Setting::Coherence(threshold) => self.coherence_threshold = *threshold,
            Setting::GainSource(source) => self.gain_source = *source,
            Setting::Phase(phase) => self.phase = *phase,
            Setting::DelayFrom(from) => self.delay_from = *from,
            Setting::LeadOrder(order) => self.lead.order = *order,
            Setting::LeadPole(pole) => self.lead.pole = *pole,
            Setting::LeadLimit(limit) => self.lead.limit = *limit,
            Setting::GainObjective(objective) => self.gain_objective = *objective,
            Setting::Quantile(quantile) => self.quantile = *quantile,
            Setting::GainBounds(bounds) => self.gain_bounds = *bounds,
            Setting::DelayUpper(upper) => self.delay_upper_s = *upper,
            Setting::Agreement(tolerance) => self.agreement_db = *tolerance,
            Setting::Schedule(schedule) => self.schedule = *schedule,
            Setting::Uncertainty(uncertainty) => self.uncertainty = *uncertainty,
        }
        Ok(())
    }
}

fn mark(table: &mut PairTable<bool>, pair: Pair, value: bool) -> Result<(), EditRefusal> {
    if pair.output >= table.outputs() || pair.input >= table.inputs() {
        return Err(EditRefusal::NoResponse { pair });
    }
    table[pair] = value;
    Ok(())
}
