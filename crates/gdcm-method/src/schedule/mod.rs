//! One correction for all airspeeds, signed delays included, its assessment, and its benefit (M11,
//! M12, M15.5).

pub mod assessment;
pub mod regression;
pub mod second_variable;

pub use assessment::{
    CostChange, FormComparison, FormFit, LeadDegreeFit, LeadFit, SCHEDULE_KINDS, assess,
    corrected_cost,
};
pub use regression::{Airspeeds, Regression, airspeed_indicators};
pub use second_variable::SecondVariable;

use std::fmt;
use std::sync::Arc;

use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

use gdcm_model::dataset::ConditionId;
use gdcm_model::dataset::condition::FlightState;
use gdcm_model::units::{s_to_ms, signed, told_apart};
use gdcm_model::whole_number::{whole, whole_or_none};

use crate::correction::leads::{ChannelLeads, LeadDesign};
use crate::correction::{Channel, ChannelCorrection, Channels, LeadPrice};
use regression::design;
use second_variable::SecondTerm;

/// Number of steps over the airspeed range at which a schedule is inspected.
const STEPS: u32 = 100;

/// Highest degree of a polynomial schedule (M11).
pub const HIGHEST_DEGREE: usize = 3;

/// Tolerance of a cluster of airspeeds \[kt\] (M11b).
pub const DEFAULT_TOLERANCE_KT: f64 = 2.0;

/// The form of the schedule.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ScheduleKind {
    /// A least squares polynomial.
    Polynomial {
        /// Degree, 0 to [`HIGHEST_DEGREE`].
        degree: usize,
    },
    /// A lookup table: the mean of each cluster of airspeeds, with linear interpolation.
    Table,
}

/// Quantity regressed on airspeed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum ScheduledQuantity {
    /// `ln k`: the product of two channels' regressions is the regression of their product.
    #[serde(rename = "ln k")]
    LnGain,
    #[serde(rename = "k")]
    Gain,
}

/// Net delay \[s\] of a constrained response above which delays are scheduled automatically (M11).
pub const NOTABLE_DELAY_S: f64 = 5e-4;

/// Whether the schedule has delays besides gains (M11).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum DelayScheduling {
    /// Where a constrained response has a net delay above [`NOTABLE_DELAY_S`] in a scheduled
    /// condition.
    #[default]
    Automatic,
    /// In every study.
    Always,
    /// In none (the paper).
    Never,
}

impl From<bool> for DelayScheduling {
    /// Value of the flag of older program versions.
    fn from(flag: bool) -> Self {
        if flag { Self::Always } else { Self::Never }
    }
}

impl<'de> Deserialize<'de> for DelayScheduling {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(DelaySchedulingVisitor)
    }
}

/// Reads a word, or the flag of older program versions.
struct DelaySchedulingVisitor;

impl Visitor<'_> for DelaySchedulingVisitor {
    type Value = DelayScheduling;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("\"automatic\", \"always\" or \"never\"")
    }

    fn visit_bool<E: Error>(self, flag: bool) -> Result<DelayScheduling, E> {
        Ok(flag.into())
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<DelayScheduling, E> {
        match word {
            "automatic" => Ok(DelayScheduling::Automatic),
            "always" => Ok(DelayScheduling::Always),
            "never" => Ok(DelayScheduling::Never),
            _ => Err(E::unknown_variant(word, &["automatic", "always", "never"])),
        }
    }
}

/// Settings of the schedule of the channel gains.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "ScheduleEntry", into = "ScheduleEntry")]
pub struct ScheduleSettings {
    pub kind: ScheduleKind,
    pub quantity: ScheduledQuantity,
    /// Whether this schedule has delays too: the outcome of [`DelayScheduling`] for the conditions
    /// at hand. In the settings of a study, older program versions read this field; it is `true`
    /// where delays are always scheduled.
    pub delays: bool,
    /// Degree of the polynomial of signed delays, where leads are requested, 0 to
    /// [`HIGHEST_DEGREE`]: servo, sensor and computing lags do not depend on airspeed (M15.5).
    pub tau_degree: usize,
    /// Airspeeds within this distance of the next higher one form a cluster \[kt\] (M11b).
    pub airspeed_tolerance_kt: f64,
    /// Variable whose effect on the gains is scheduled besides the effect of airspeed (M13.7).
    pub second: Option<SecondVariable>,
}

/// [`ScheduleSettings`] in files, where the degree is a field next to the form.
#[derive(Serialize, Deserialize)]
struct ScheduleEntry {
    kind: FormEntry,
    #[serde(default, deserialize_with = "whole_or_none")]
    degree: Option<usize>,
    of: ScheduledQuantity,
    delays: bool,
    #[serde(default = "default_tolerance_kt")]
    airspeed_tolerance_kt: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    second_variable: Option<SecondVariable>,
    #[serde(default, skip_serializing_if = "is_zero", deserialize_with = "whole")]
    tau_degree: usize,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum FormEntry {
    Polynomial,
    Table,
}

fn default_tolerance_kt() -> f64 {
    DEFAULT_TOLERANCE_KT
}

fn is_zero(count: &usize) -> bool {
    *count == 0
}

impl TryFrom<ScheduleEntry> for ScheduleSettings {
    type Error = String;

    fn try_from(entry: ScheduleEntry) -> Result<Self, String> {
        let kind = match (entry.kind, entry.degree) {
            (FormEntry::Table, _) => ScheduleKind::Table,
            (FormEntry::Polynomial, Some(degree)) if degree <= HIGHEST_DEGREE => {
                ScheduleKind::Polynomial { degree }
            }
            (FormEntry::Polynomial, Some(degree)) => {
                return Err(format!(
                    "degree: expected a whole number from 0 to {HIGHEST_DEGREE}, found {degree}"
                ));
            }
            // Same wording as serde's own error, so that readers treat it alike.
            (FormEntry::Polynomial, None) => return Err("missing field `degree`".to_owned()),
        };
        let ScheduleEntry {
            of: quantity,
            delays,
            airspeed_tolerance_kt,
            second_variable: second,
            tau_degree,
            ..
        } = entry;
        Ok(Self {
            kind,
            quantity,
            delays,
            tau_degree,
            airspeed_tolerance_kt,
            second,
        })
    }
}

impl From<ScheduleSettings> for ScheduleEntry {
    fn from(settings: ScheduleSettings) -> Self {
        let (kind, degree) = match settings.kind {
            ScheduleKind::Polynomial { degree } => (FormEntry::Polynomial, Some(degree)),
            ScheduleKind::Table => (FormEntry::Table, None),
        };
        let ScheduleSettings {
            quantity: of,
            delays,
            airspeed_tolerance_kt,
            tau_degree,
            second,
            ..
        } = settings;
        Self {
            kind,
            degree,
            of,
            delays,
            airspeed_tolerance_kt,
            second_variable: second,
            tau_degree,
        }
    }
}

impl Default for ScheduleSettings {
    fn default() -> Self {
        Self {
            kind: ScheduleKind::Polynomial { degree: 2 },
            quantity: ScheduledQuantity::LnGain,
            delays: false,
            tau_degree: 0,
            airspeed_tolerance_kt: DEFAULT_TOLERANCE_KT,
            second: None,
        }
    }
}

/// One condition's optimum, as input to the schedule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScheduledPoint<'a> {
    /// True airspeed \[kt\].
    pub airspeed_kt: f64,
    /// The condition's own correction.
    pub correction: &'a ChannelCorrection,
    /// The condition's upper bound of the delays \[s\].
    pub delay_upper_s: f64,
    /// The condition's value of the second variable, if any.
    pub second: Option<f64>,
}

/// Every channel's gain (and delay, where requested) as a function of airspeed.
#[derive(Clone, Debug, PartialEq)]
pub struct Schedule {
    pub settings: ScheduleSettings,
    /// Airspeeds of the conditions.
    pub airspeeds: Airspeeds,
    /// Regression of each channel's gain, or of its logarithm.
    pub gains: Channels<Regression>,
    /// Contribution of the second variable to each regression, if any.
    pub second: Option<SecondTerm>,
    /// Delays as functions of airspeed, where delays are scheduled.
    pub delays: Option<DelaySchedule>,
    /// Signed delays as functions of airspeed, where the conditions' corrections have leads (M15).
    pub leads: Option<LeadSchedule>,
    pub cautions: Vec<ScheduleCaution>,
}

/// Every channel's delay as a function of airspeed.
#[derive(Clone, Debug, PartialEq)]
pub struct DelaySchedule {
    /// Regression of each channel's delay \[s\].
    pub taus_s: Channels<Regression>,
    /// The conditions' upper bounds \[s\], interpolated linearly: no scheduled delay exceeds them.
    pub upper_s: Regression,
}

/// Cautions about a schedule.
#[derive(Clone, Debug, PartialEq)]
pub enum ScheduleCaution {
    /// The requested degree needs more airspeeds than there are (M11b).
    DegreeLowered {
        /// Requested degree.
        asked: usize,
        /// Number of clusters of airspeeds.
        clusters: usize,
    },
    /// A gain leaves the range of the conditions' gains by more than half its width, between two
    /// clusters (M11b).
    Overshoot {
        channel: Channel,
        /// Mean airspeeds of the clusters on either side \[kt\].
        between_kt: [f64; 2],
        /// Airspeed of the largest excursion \[kt\].
        airspeed_kt: f64,
        /// Gain at that airspeed.
        gain: f64,
        /// Least and greatest of the conditions' gains.
        range: [f64; 2],
    },
    /// A channel's signed delay in one condition is far from the others, or has another sign
    /// (M15.6).
    SignedDelayApart {
        channel: Channel,
        condition: ConditionId,
        /// Signed delay in this condition \[s\].
        tau_s: f64,
        /// Mean signed delay in the other conditions \[s\].
        elsewhere_s: f64,
    },
    /// A gain is not positive at some intermediate airspeed, possible only in a regression of `k`
    /// itself.
    NotPositive,
    /// The scheduled correction gives a condition much more J than its own correction does (M12).
    CostsMore(ScheduledCost),
}

/// Mean J of the on-axis responses of one physics model of a condition (M12).
#[derive(Clone, Debug, PartialEq)]
pub struct ScheduledCost {
    pub condition: ConditionId,
    /// Name of the physics model: the nominal one, or the representative where the nominal one is
    /// rejected.
    pub model: String,
    /// J under the schedule.
    pub scheduled: f64,
    /// J under the condition's own correction.
    pub own: f64,
}

impl ScheduledCost {
    /// Ratio of scheduled J to own J that triggers a caution.
    const NOTABLE_RATIO: f64 = 2.0;
    /// Scheduled J below which no caution is raised: 1 is 0.2 dB.
    const LEAST_NOTABLE: f64 = 1.0;

    /// Whether the scheduled J is more than twice the condition's own.
    pub fn is_notable(&self) -> bool {
        self.scheduled > Self::LEAST_NOTABLE && self.scheduled > Self::NOTABLE_RATIO * self.own
    }
}

impl ScheduleCaution {
    /// Whether the caution applies to a condition: the cost of the schedule in one condition does
    /// not concern another.
    pub fn concerns(&self, condition: ConditionId) -> bool {
        match self {
            ScheduleCaution::CostsMore(cost) => cost.condition == condition,
            _ => true,
        }
    }

    /// Code of the caution in files.
    pub fn code(&self) -> &'static str {
        match self {
            ScheduleCaution::DegreeLowered { .. } => "degree-lowered",
            ScheduleCaution::Overshoot { .. } => "schedule-overshoots",
            ScheduleCaution::SignedDelayApart { .. } => "signed-delay-apart",
            ScheduleCaution::NotPositive => "scheduled-gain-not-positive",
            ScheduleCaution::CostsMore(_) => "scheduled-cost-doubled",
        }
    }

    /// Describes the caution with these channel names.
    pub fn words(&self, inputs: &[String], outputs: &[String]) -> String {
        match self {
            ScheduleCaution::DegreeLowered { asked, clusters } => format!(
                "degree {asked} takes {} distinct airspeeds, the conditions have {clusters}: the schedule has degree {}",
                asked + 1,
                clusters - 1
            ),
            ScheduleCaution::Overshoot {
                channel,
                between_kt: [low, high],
                airspeed_kt,
                gain,
                range: [least, most],
            } => {
                let name = channel.name(inputs, outputs);
                format!(
                    "between {low:.1} and {high:.1} kt the gain of {name} overshoots: {gain:.3} at {airspeed_kt:.1} kt, \
                     where the conditions' gains go from {least:.3} to {most:.3}; lower the degree or take a table"
                )
            }
            ScheduleCaution::SignedDelayApart {
                channel,
                condition,
                tau_s,
                elsewhere_s,
            } => format!(
                "{}: {} ms in condition {condition} against {} ms elsewhere: not schedulable over airspeed",
                channel.name(inputs, outputs),
                signed(s_to_ms(*tau_s), 0),
                signed(s_to_ms(*elsewhere_s), 0)
            ),
            ScheduleCaution::NotPositive => {
                "a scheduled gain is not positive somewhere in this range".to_owned()
            }
            ScheduleCaution::CostsMore(cost) => {
                let (scheduled, own) = told_apart(cost.scheduled, cost.own, 0);
                format!(
                    "condition {}, model {}: mean on-axis J {scheduled} with the schedule, {own} with the condition's own correction",
                    cost.condition, cost.model
                )
            }
        }
    }
}

/// Reason why there is no schedule.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ScheduleError {
    /// No condition was chosen, or none could be solved.
    #[error("no schedule: no condition that could be solved is chosen for it")]
    NoCondition,
    /// A condition has no value of the second variable.
    #[error("no schedule with {0}: a condition that is chosen for it does not say its {0}")]
    NoSecondValue(SecondVariable),
    /// The second variable is a function of airspeed in these conditions, or the same in all of
    /// them.
    #[error(
        "no schedule with {0}: these conditions cannot tell its effect and that of airspeed apart"
    )]
    NotToldApart(SecondVariable),
}

impl Schedule {
    /// Fits the schedule of these conditions' corrections and checks it between them.
    pub fn of(
        points: &[ScheduledPoint<'_>],
        settings: ScheduleSettings,
    ) -> Result<Self, ScheduleError> {
        let mut schedule = Self::fitted(points, settings)?;
        schedule.cautions = schedule.find_cautions(points);
        Ok(schedule)
    }

    /// Like [`Schedule::of`], but without checks between the conditions.
    pub(super) fn fitted(
        points: &[ScheduledPoint<'_>],
        settings: ScheduleSettings,
    ) -> Result<Self, ScheduleError> {
        let airspeeds = Airspeeds::new(
            points.iter().map(|point| point.airspeed_kt).collect(),
            settings.airspeed_tolerance_kt,
        );
        let airspeeds = airspeeds.ok_or(ScheduleError::NoCondition)?;
        let fit = |figures: &[f64]| match settings.kind {
            ScheduleKind::Polynomial { degree } => {
                Regression::polynomial(&airspeeds, figures, degree)
            }
            ScheduleKind::Table => Regression::table(&airspeeds, figures),
        };
        let quantity = |gain: f64| match settings.quantity {
            ScheduledQuantity::LnGain => gain.ln(),
            ScheduledQuantity::Gain => gain,
        };
        let first = points[0].correction;
        let figures = |of: &dyn Fn(&ChannelCorrection) -> f64| -> Vec<f64> {
            points.iter().map(|point| of(point.correction)).collect()
        };
        let gains =
            first.channels(|channel| figures(&|correction| quantity(correction.gain(channel))));
        let second = settings.second.map(|variable| {
            let values: Option<Vec<f64>> = points.iter().map(|point| point.second).collect();
            let values = values.ok_or(ScheduleError::NoSecondValue(variable))?;
            SecondTerm::of(variable, values, &design(&airspeeds, settings.kind), &gains)
        });
        let second = second.transpose()?;
        let gains = gains.map(|channel, figures| {
            let Some(SecondTerm { scaled, slopes, .. }) = &second else {
                return fit(figures);
            };
            let left = figures
                .iter()
                .zip(scaled)
                .map(|(figure, scaled)| figure - slopes[channel] * scaled);
            fit(&left.collect::<Vec<f64>>())
        });
        let leads = LeadSchedule::of(points, &airspeeds, settings.tau_degree);
        let delays = (settings.delays && leads.is_none()).then(|| DelaySchedule {
            taus_s: first
                .channels(|channel| fit(&figures(&|correction| correction.pure_delay_s(channel)))),
            upper_s: Regression::table(
                &airspeeds,
                &points
                    .iter()
                    .map(|point| point.delay_upper_s)
                    .collect::<Vec<_>>(),
            ),
        });
        Ok(Self {
            settings,
            airspeeds,
            gains,
            second,
            delays,
            leads,
            cautions: Vec::new(),
        })
    }

    /// Whether delays, or delays and leads, are scheduled.
    pub fn has_delays(&self) -> bool {
        self.delays.is_some() || self.leads.is_some()
    }

    /// Price of the scheduled leads: for each channel the maximum over the airspeeds. `None` for a
    /// schedule without lead filters.
    pub fn lead_price(&self) -> Option<LeadPrice> {
        let leads = self.leads.as_ref()?;
        let steps = if leads.degree() == 0 { 0 } else { STEPS };
        let prices = (0..=steps)
            .filter_map(|step| LeadPrice::of(&leads.at(&self.airspeeds, self.step_kt(step))));
        prices.reduce(|most, other| most.or_more(&other))
    }

    /// Airspeed \[kt\] of an inspection step between the least and the greatest airspeed.
    fn step_kt(&self, step: u32) -> f64 {
        let part = f64::from(step) / f64::from(STEPS);
        self.airspeeds.min_kt + part * (self.airspeeds.max_kt - self.airspeeds.min_kt)
    }

    /// Degree of the polynomial, possibly less than requested; `None` for a table.
    pub fn degree(&self) -> Option<usize> {
        match self.settings.kind {
            ScheduleKind::Polynomial { degree } => {
                Some(degree.min(self.airspeeds.clusters.len().saturating_sub(1)))
            }
            ScheduleKind::Table => None,
        }
    }

    /// Whether interpolation between the conditions is unreliable: a gain overshoots there, or is
    /// not positive.
    pub fn interpolation_fails(&self) -> bool {
        let fails = |caution: &ScheduleCaution| {
            matches!(
                caution,
                ScheduleCaution::Overshoot { .. } | ScheduleCaution::NotPositive
            )
        };
        self.cautions.iter().any(fails)
    }

    fn find_cautions(&self, points: &[ScheduledPoint<'_>]) -> Vec<ScheduleCaution> {
        let mut cautions = Vec::new();
        let clusters = self.airspeeds.clusters.len();
        if let ScheduleKind::Polynomial { degree: asked } = self.settings.kind
            && asked >= clusters
        {
            cautions.push(ScheduleCaution::DegreeLowered { asked, clusters });
        }
        let channels = self.gains.iter().map(|(channel, _)| channel);
        cautions.extend(channels.filter_map(|channel| self.overshoot(points, channel)));
        let is_positive = |step: u32| {
            let correction = self.at(self.step_kt(step));
            correction
                .input_gains
                .iter()
                .chain(&correction.output_gains)
                .all(|gain| *gain > 0.0)
        };
        if !(0..=STEPS).all(is_positive) {
            cautions.push(ScheduleCaution::NotPositive);
        }
        cautions
    }

    /// Finds the point where a channel's gain is farthest outside the range of the conditions'
    /// gains, between two clusters.
    fn overshoot(
        &self,
        points: &[ScheduledPoint<'_>],
        channel: Channel,
    ) -> Option<ScheduleCaution> {
        let gains = points.iter().map(|point| point.correction.gain(channel));
        let range = gains.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], gain| {
            [least.min(gain), most.max(gain)]
        });
        // Where all gains are equal, rounding is no overshoot.
        let mut farthest = 0.5 * (range[1] - range[0]) + 1e-9 * range[1];
        let mut found = None;
        let clusters = self.airspeeds.clusters_kt();
        for between in clusters.windows(2) {
            for step in 1..STEPS {
                let airspeed_kt =
                    between[0] + (between[1] - between[0]) * f64::from(step) / f64::from(STEPS);
                let gain = self.at(airspeed_kt).gain(channel);
                let outside = (range[0] - gain).max(gain - range[1]);
                if outside > farthest {
                    let between_kt = [between[0], between[1]];
                    farthest = outside;
                    found = Some(ScheduleCaution::Overshoot {
                        channel,
                        between_kt,
                        airspeed_kt,
                        gain,
                        range,
                    });
                }
            }
        }
        found
    }

    /// Evaluates the scheduled correction at an airspeed \[kt\]; outside the conditions' range the
    /// end value applies.
    ///
    /// Scheduled delays are limited to their bounds: from zero to the conditions' upper bounds,
    /// interpolated linearly. A second variable is in the middle of its range.
    pub fn at(&self, airspeed_kt: f64) -> ChannelCorrection {
        self.evaluate(airspeed_kt, None)
    }

    /// Evaluates the scheduled correction at the airspeed and the second variable of a condition.
    pub fn at_state(&self, state: &FlightState) -> ChannelCorrection {
        self.evaluate(
            state.airspeed_kt,
            self.settings
                .second
                .and_then(|variable| variable.value(state)),
        )
    }

    /// Like [`Schedule::at`], at a value of the second variable; beyond the conditions' range the
    /// end value applies.
    pub fn evaluate(&self, airspeed_kt: f64, second: Option<f64>) -> ChannelCorrection {
        let scaled = self
            .second
            .as_ref()
            .zip(second)
            .map(|(term, value)| (term, term.scale(value)));
        let gains = self.gains.map(|channel, regression| {
            let beside = scaled.map_or(0.0, |(term, scaled)| term.slopes[channel] * scaled);
            let value = regression.at(&self.airspeeds, airspeed_kt) + beside;
            match self.settings.quantity {
                ScheduledQuantity::LnGain => value.exp(),
                ScheduledQuantity::Gain => value,
            }
        });
        if let Some(leads) = &self.leads {
            return ChannelCorrection::of_leads(gains, leads.at(&self.airspeeds, airspeed_kt));
        }
        let delays_s = match &self.delays {
            Some(DelaySchedule { taus_s, upper_s }) => {
                let upper_s = upper_s.at(&self.airspeeds, airspeed_kt);
                taus_s.map(|_, tau_s| tau_s.at(&self.airspeeds, airspeed_kt).min(upper_s).max(0.0))
            }
            None => gains.map(|_, _| 0.0),
        };
        ChannelCorrection::of_delays(gains, delays_s)
    }
}

/// Every channel's signed delay as a function of airspeed: the sum of two regressions is the
/// regression of the sum, so the net lead of every response is scheduled exactly.
#[derive(Clone, Debug, PartialEq)]
pub struct LeadSchedule {
    /// Design that gives the filter of a signed delay.
    pub design: Arc<LeadDesign>,
    /// Regression of each channel's signed delay \[s\].
    pub taus_s: Channels<Regression>,
    /// The widest of the conditions' bounds \[s\]: no scheduled signed delay is outside.
    pub bounds_s: [f64; 2],
    /// Leads that are the same for all airspeeds, if they are, so that the filters are computed
    /// once.
    constant: Option<ChannelLeads>,
}

impl LeadSchedule {
    /// Fits the schedule of these conditions' signed delays; `None` where a condition has none.
    pub(super) fn of(
        points: &[ScheduledPoint<'_>],
        airspeeds: &Airspeeds,
        degree: usize,
    ) -> Option<Self> {
        let leads = points.iter().map(|point| point.correction.leads.as_ref());
        let leads = leads.collect::<Option<Vec<&ChannelLeads>>>()?;
        let figures = |channel| {
            leads
                .iter()
                .map(|leads| leads.taus_s[channel])
                .collect::<Vec<f64>>()
        };
        let taus_s = leads
            .first()?
            .taus_s
            .map(|channel, _| Regression::polynomial(airspeeds, &figures(channel), degree));
        let design = Arc::clone(&leads.first()?.design);
        let upper_s = points
            .iter()
            .map(|point| point.delay_upper_s)
            .fold(0.0, f64::max);
        let lower_s = leads
            .iter()
            .map(|leads| leads.design.lower_s())
            .fold(0.0, f64::min);
        let mut schedule = Self {
            design,
            taus_s,
            bounds_s: [lower_s, upper_s],
            constant: None,
        };
        schedule.constant =
            (schedule.degree() == 0).then(|| schedule.made_at(airspeeds, airspeeds.mean_kt));
        Some(schedule)
    }

    /// Degree of its polynomials.
    pub fn degree(&self) -> usize {
        let degrees = self
            .taus_s
            .iter()
            .map(|(_, regression)| regression.figures().len().saturating_sub(1));
        degrees.max().unwrap_or(0)
    }

    /// Signed delays at an airspeed \[kt\], limited to the bounds.
    pub fn at(&self, airspeeds: &Airspeeds, airspeed_kt: f64) -> ChannelLeads {
        self.constant
            .clone()
            .unwrap_or_else(|| self.made_at(airspeeds, airspeed_kt))
    }

    fn made_at(&self, airspeeds: &Airspeeds, airspeed_kt: f64) -> ChannelLeads {
        let [lower_s, upper_s] = self.bounds_s;
        let cut = |_, regression: &Regression| {
            regression
                .at(airspeeds, airspeed_kt)
                .clamp(lower_s, upper_s)
        };
        ChannelLeads::new(Arc::clone(&self.design), self.taus_s.map(cut))
    }
}

#[cfg(test)]
mod tests {
    use gdcm_model::dataset::Pair;

    use super::*;

    fn correction(gain: f64) -> ChannelCorrection {
        ChannelCorrection {
            input_gains: vec![gain],
            output_gains: vec![gain * gain],
            input_delays_s: vec![0.01],
            output_delays_s: vec![0.0],
            leads: None,
        }
    }

    /// Points of a schedule of these corrections at these airspeeds.
    pub(super) fn points<'a>(
        airspeeds_kt: &[f64],
        corrections: &'a [ChannelCorrection],
        delay_upper_s: f64,
    ) -> Vec<ScheduledPoint<'a>> {
        let pairs = airspeeds_kt.iter().zip(corrections);
        let point = |(&airspeed_kt, correction)| ScheduledPoint {
            airspeed_kt,
            correction,
            delay_upper_s,
            second: None,
        };
        pairs.map(point).collect()
    }

    #[test]
    fn regressing_the_logarithm_makes_the_product_the_regression_of_the_product() {
        let corrections: Vec<_> = [0.8, 1.1, 0.9, 1.3].into_iter().map(correction).collect();
        let airspeeds_kt = [40.0, 70.0, 100.0, 140.0];
        let points = points(&airspeeds_kt, &corrections, 1.0);
        let schedule = Schedule::of(&points, ScheduleSettings::default()).unwrap();
        let products: Vec<f64> = corrections
            .iter()
            .map(|c| c.net_gain(Pair::new(0, 0)).ln())
            .collect();
        let direct = Regression::polynomial(&schedule.airspeeds, &products, 2);
        for airspeed in [40.0, 88.0, 140.0] {
            let product = schedule.at(airspeed).net_gain(Pair::new(0, 0));
            // Linear least squares with another order of rounding.
            assert!((product / direct.at(&schedule.airspeeds, airspeed).exp() - 1.0).abs() < 1e-13);
        }
    }

    #[test]
    fn without_a_condition_there_is_no_schedule() {
        assert_eq!(
            Schedule::of(&[], ScheduleSettings::default()),
            Err(ScheduleError::NoCondition)
        );
    }

    #[test]
    fn a_parabola_through_two_near_airspeeds_and_a_far_one_is_cautioned_of_where_it_overshoots() {
        let corrections: Vec<_> = [1.0, 1.1, 1.0].into_iter().map(correction).collect();
        let of = |airspeeds_kt: [f64; 3], airspeed_tolerance_kt| {
            let points = points(&airspeeds_kt, &corrections, 1.0);
            Schedule::of(
                &points,
                ScheduleSettings {
                    airspeed_tolerance_kt,
                    ..ScheduleSettings::default()
                },
            )
            .unwrap()
        };
        assert_eq!(
            of([60.0, 90.0, 120.0], 2.0).cautions,
            [],
            "through its points, in the range between"
        );
        // 1 at 60 and 120 kt, 1.1 at 63 kt: ln k = ln 1.1 (v^2 - 1) / (0.9^2 - 1), 1.65 at 90 kt.
        let wild = of([60.0, 63.0, 120.0], 2.0);
        let ScheduleCaution::Overshoot {
            channel,
            between_kt,
            airspeed_kt,
            gain,
            range,
        } = &wild.cautions[0]
        else {
            panic!("{:?}", wild.cautions);
        };
        assert_eq!(
            (*channel, *between_kt, *range),
            (Channel::Input(0), [63.0, 120.0], [1.0, 1.1])
        );
        assert!(
            (airspeed_kt - 90.0).abs() < 1.0
                && (gain / 1.1_f64.powf(1.0 / 0.19) - 1.0).abs() < 0.01
        );
        assert!(wild.interpolation_fails());
        let lowered = of([60.0, 61.0, 120.0], 2.0);
        assert_eq!(
            lowered.cautions,
            [ScheduleCaution::DegreeLowered {
                asked: 2,
                clusters: 2
            }]
        );
        assert_eq!(
            (lowered.degree(), lowered.interpolation_fails()),
            (Some(1), false)
        );
    }

    #[test]
    fn delays_are_scheduled_only_where_asked_for() {
        let own = correction(1.0);
        let points = [ScheduledPoint {
            airspeed_kt: 60.0,
            correction: &own,
            delay_upper_s: 1.0,
            second: None,
        }];
        assert_eq!(
            Schedule::of(&points, ScheduleSettings::default())
                .unwrap()
                .at(60.0)
                .input_delays_s,
            [0.0]
        );
        let settings = ScheduleSettings {
            delays: true,
            ..ScheduleSettings::default()
        };
        assert_eq!(
            Schedule::of(&points, settings)
                .unwrap()
                .at(60.0)
                .input_delays_s,
            [0.01]
        );
    }
    #[test]
    fn a_scheduled_delay_stays_within_the_bounds_of_the_conditions() {
        // Delays of 0, 0, 30 and 30 ms: a cubic through them swings to both sides. Bounds of 10,
        // 20, 30 and 30 ms.
        let delays_s = [0.0, 0.0, 0.03, 0.03];
        let corrections = delays_s.map(|delay| ChannelCorrection {
            input_delays_s: vec![delay],
            ..correction(1.0)
        });
        let points: Vec<_> = [60.0, 80.0, 100.0, 120.0]
            .into_iter()
            .zip(&corrections)
            .zip([0.01, 0.02, 0.03, 0.03])
            .map(
                |((airspeed_kt, correction), delay_upper_s)| ScheduledPoint {
                    airspeed_kt,
                    correction,
                    delay_upper_s,
                    second: None,
                },
            )
            .collect();
        let kind = ScheduleKind::Polynomial { degree: 3 };
        let settings = ScheduleSettings {
            kind,
            delays: true,
            ..ScheduleSettings::default()
        };
        let schedule = Schedule::of(&points, settings).unwrap();
        let delay_at = |airspeed_kt: f64| schedule.at(airspeed_kt).input_delays_s[0];
        assert_eq!(
            (delay_at(70.0), delay_at(110.0)),
            (0.0, 0.03),
            "cut to 0 and to the bound"
        );
        assert!(
            (delay_at(90.0) - 0.015).abs() < 1e-15,
            "half way, by symmetry"
        );
        let uncut =
            schedule.delays.as_ref().unwrap().taus_s.inputs[0].at(&schedule.airspeeds, 70.0);
        assert!(uncut < -0.001, "{uncut}");
    }
}

#[cfg(test)]
mod lead_schedule_tests {
    use super::tests::points;
    use super::*;
    use crate::correction::ChannelCorrection;
    use crate::correction::leads::LeadSettings;

    fn corrections(taus_s: &[[f64; 2]]) -> Vec<ChannelCorrection> {
        let design = Arc::new(LeadDesign::new(
            LeadSettings::default(),
            [0.5, 3.0, 12.0].into(),
        ));
        let of = |&[input_s, output_s]: &[f64; 2]| ChannelCorrection {
            input_gains: vec![1.0],
            output_gains: vec![1.0],
            input_delays_s: vec![0.0],
            output_delays_s: vec![0.0],
            leads: Some(ChannelLeads::new(
                Arc::clone(&design),
                Channels {
                    inputs: vec![input_s],
                    outputs: vec![output_s],
                },
            )),
        };
        taus_s.iter().map(of).collect()
    }

    #[test]
    fn the_sum_of_two_channels_is_the_regression_of_the_sums() {
        let airspeeds_kt = [60.0, 80.0, 100.0, 130.0];
        let taus_s = [
            [-0.02, -0.03],
            [-0.04, 0.004],
            [-0.01, -0.02],
            [-0.03, -0.05],
        ];
        let corrections = corrections(&taus_s);
        let airspeeds = Airspeeds::new(airspeeds_kt.to_vec(), 2.0).unwrap();
        for degree in 0..=2 {
            let schedule = LeadSchedule::of(
                &points(&airspeeds_kt, &corrections, 0.01),
                &airspeeds,
                degree,
            )
            .unwrap();
            let sums: Vec<f64> = taus_s
                .iter()
                .map(|[input, output]| input + output)
                .collect();
            let direct = Regression::polynomial(&airspeeds, &sums, degree);
            let at = schedule.at(&airspeeds, 93.0);
            // Least squares with another order of rounding.
            assert!(
                (at.taus_s.inputs[0] + at.taus_s.outputs[0] - direct.at(&airspeeds, 93.0)).abs()
                    < 1e-15
            );
            assert_eq!(schedule.degree(), degree);
        }
    }

    #[test]
    fn a_scheduled_signed_delay_stays_within_the_widest_bounds() {
        let corrections =
            corrections(&[[-0.09, 0.01], [-0.09, 0.01], [0.01, -0.05], [0.01, -0.05]]);
        let airspeeds_kt = [60.0, 80.0, 100.0, 120.0];
        let airspeeds = Airspeeds::new(airspeeds_kt.to_vec(), 2.0).unwrap();
        let schedule =
            LeadSchedule::of(&points(&airspeeds_kt, &corrections, 0.01), &airspeeds, 3).unwrap();
        let uncut_s = schedule.taus_s.inputs[0].at(&airspeeds, 110.0);
        assert!(uncut_s > 0.011, "the cubic swings over: {uncut_s}");
        assert_eq!(schedule.at(&airspeeds, 110.0).taus_s.inputs, [0.01]);
    }
}
