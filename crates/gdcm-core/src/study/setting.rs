//! One change of a setting, its range, and its name.

use crate::correction::{GainBounds, GainObjective, GainSource};
use crate::dataset::{Band, Dataset, Pair, PairTable};
use crate::fidelity::CostAverage;
use crate::response::LeadOrder;
use crate::schedule::{HIGHEST_DEGREE, ScheduleKind, ScheduleSettings};
use crate::uncertainty::{GREATEST_MEASUREMENT, GREATEST_PRIOR, LEVELS, UncertaintySettings};
use crate::units::number;

use super::edit::EditRefusal;
use super::settings::{
    DelayFrom, GREATEST_AGREEMENT_DB, GREATEST_DELAY_S, GREATEST_GAIN, GREATEST_QUANTILE, LARGEST_ALPHA, LEAD_LIMITS,
    LEAD_POLES, LEAST_GAIN, LEAST_POINTS, MOST_POINTS, PhaseCorrection, Settings,
};

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
