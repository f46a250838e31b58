//! Bandwidth and phase delay of the models of a condition, with intervals (M17.1).
//!
//! ```text
//! physics     the other kept physics models in its place, as they are                             (M13.1)
//! corrected   each swap of a physics or an identified model, under the correction that it leads to (M13.1)
//! identified  standard deviations of the response that the model carries, to first order          (M14)
//! ```

use std::borrow::Cow;
use std::collections::BTreeMap;

use serde::Serialize;

use gdcm_method::correction::leads::ChannelLeads;
use gdcm_method::correction::{Channel, ChannelCorrection, Pade};
use gdcm_method::requirements::attitude_response::{
    AttitudeResponse, AttitudeResponseError, ResponseAt, SampledModel, search_frequencies,
};
use gdcm_method::requirements::bandwidth::{
    AboveBand, Bandwidth, BandwidthSettings, Metric, NoMetric, PairBand, PhaseLine,
    substitution_bar,
};
use gdcm_method::requirements::{AttitudeOutput, BandwidthRule};
use gdcm_method::uncertainty::spread::Figures;
use gdcm_method::uncertainty::{Scalar, student_quantile};
use gdcm_model::dataset::model::ModelBands;
use gdcm_model::dataset::{Band, BundleKind, ConditionId, Dynamics, Pair};
use gdcm_model::response::GainDelay;

use super::requirements::{AskedCondition, RequirementRole};
use crate::stages::substitutions::Swap;

/// Bandwidth and phase delay of one response of one model of a condition.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct BandwidthFinding {
    pub condition: ConditionId,
    /// Its true airspeed \[kt\].
    pub airspeed_kt: f64,
    #[serde(skip)]
    pub pair: Pair,
    pub output: String,
    pub input: String,
    pub role: RequirementRole,
    pub model: String,
    /// The bandwidth \[rad/s\].
    pub omega_bw_rad_s: Option<f64>,
    /// Frequency of -135 deg \[rad/s\].
    pub omega_phase_rad_s: Option<f64>,
    /// Frequency of 6 dB of gain margin \[rad/s\].
    pub omega_gain_rad_s: Option<f64>,
    /// Frequency of -180 deg \[rad/s\].
    pub omega_180_rad_s: Option<f64>,
    /// Phase delay \[s\].
    pub phase_delay_s: Option<f64>,
    /// The margin that determines the bandwidth.
    pub rule: Option<BandwidthRule>,
    /// Whether the gain margin is reached before the phase margin, of which the standard warns.
    pub gain_limited: bool,
    /// Largest deviation of the phase from a straight line between `omega_180` and `2 omega_180`
    /// \[deg\].
    pub phase_departure_deg: Option<f64>,
    /// Whether the phase delay is computed from the least-squares line, because the phase is not
    /// straight.
    pub phase_delay_of_line: bool,
    /// Names of the numbers that depend on the response above the band.
    pub rests_above_band: Vec<&'static str>,
    /// Names of the numbers that depend on the response below the band.
    pub rests_below_band: Vec<&'static str>,
    /// Interval of each number, by name, where there is one.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub interval: BTreeMap<&'static str, [f64; 2]>,
    /// Number of swaps without a value, excluded from the interval, by name.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub swaps_left_out: BTreeMap<&'static str, usize>,
    /// Phase \[deg\] at the lowest frequency of the band, where it indicates a reversed channel.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reversed_phase_deg: Option<f64>,
    /// Why a number, or every interval ("interval"), is absent, by its name.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub absent: BTreeMap<&'static str, String>,
}

/// Names of the numbers computed from a response, in the order of [`metrics`].
const METRICS: [&str; 5] = [
    "omega_bw_rad_s",
    "omega_phase_rad_s",
    "omega_gain_rad_s",
    "omega_180_rad_s",
    "phase_delay_s",
];
/// Name of the deviation of the phase from a straight line.
const DEPARTURE: &str = "phase_departure_deg";

impl BandwidthFinding {
    /// Returns the numbers with their names.
    pub fn quantities(&self) -> [(&'static str, Option<f64>); 6] {
        let [bandwidth, phase, gain, neutral, delay] = METRICS;
        [
            (bandwidth, self.omega_bw_rad_s),
            (phase, self.omega_phase_rad_s),
            (gain, self.omega_gain_rad_s),
            (neutral, self.omega_180_rad_s),
            (delay, self.phase_delay_s),
            (DEPARTURE, self.phase_departure_deg),
        ]
    }

    /// Returns whether a number depends on the response above the band.
    pub fn rests_above(&self, name: &str) -> bool {
        self.rests_above_band.contains(&name)
    }
}

/// Computes the bandwidths of every on-axis response of a condition, role by role; for responses
/// without a bandwidth, the reason.
pub(crate) fn bandwidth_findings(asked: &AskedCondition<'_>) -> Vec<BandwidthFinding> {
    let models = PreparedModels::of(asked);
    let pairs = asked.analysis.study.dataset.measuring_pairs();
    let roles = || asked.roles();
    pairs
        .marked()
        .flat_map(|pair| {
            roles()
                .map(|role| models.finding(pair, role))
                .collect::<Vec<_>>()
        })
        .collect()
}

/// A model prepared for the evaluation of its response.
struct ReadModel<'a> {
    dynamics: Cow<'a, Dynamics>,
    /// Uncertainty of its response, where the model contains it.
    bands: Option<&'a ModelBands>,
    sampled: SampledModel,
}

/// Evaluation of a model between the grid frequencies of the search.
#[derive(Clone, Copy, PartialEq)]
enum Between {
    Exact,
    /// By interpolation, for models used only for the scatter of a number.
    Interpolated,
}

impl<'a> ReadModel<'a> {
    fn of(dynamics: Cow<'a, Dynamics>, bands: Option<&'a ModelBands>, band: Band) -> Self {
        let sampled = SampledModel::of(&dynamics, band);
        Self {
            dynamics,
            bands,
            sampled,
        }
    }
}

/// Effect of a correction on one response.
#[derive(Clone, Copy)]
struct PairCorrection {
    multiplier: GainDelay,
    /// Whether it includes a lead filter: above the band the result does not model the aircraft.
    has_leads: bool,
}

impl PairCorrection {
    const NONE: Self = Self {
        multiplier: GainDelay::NONE,
        has_leads: false,
    };

    /// Returns `None` where the net gain is not positive.
    fn of(correction: &ChannelCorrection, pair: Pair) -> Option<Self> {
        let has_leads = Channel::of(pair)
            .into_iter()
            .any(|channel| correction.lead(channel).is_some());
        Some(Self {
            multiplier: correction.on(pair)?,
            has_leads,
        })
    }

    /// Returns the effect for the figures of a swap; `None` where one of them does not exist.
    fn of_swap(figures: &Figures, pair: Pair, leads: Option<&ChannelLeads>) -> Option<Self> {
        let gain = figures[Scalar::NetGain(pair)]?.exp();
        let [output_s, input_s] =
            Channel::of(pair).map(|channel| figures[Scalar::ChannelDelay(channel)]);
        let taus_s = [output_s?, input_s?];
        let filters = taus_s.map(|tau_s| leads.and_then(|leads| leads.design.filter(tau_s)));
        let delay_s = taus_s.iter().map(|tau_s| tau_s.max(0.0)).sum();
        let has_leads = filters.iter().any(Option::is_some);
        Some(Self {
            multiplier: GainDelay::new(gain, delay_s).led(filters),
            has_leads,
        })
    }
}

/// Values of the numbers of one response, where they exist, in the order of [`METRICS`].
type MetricValues = [Option<f64>; 5];

/// The models of a condition for bandwidths.
struct PreparedModels<'a> {
    asked: &'a AskedCondition<'a>,
    physics: usize,
    /// The physics representative and its substitutes.
    of_physics: BTreeMap<usize, ReadModel<'a>>,
    /// The same models with the couplings, where they have matrices; empty without couplings.
    of_coupled: BTreeMap<usize, ReadModel<'a>>,
    identified: ReadModel<'a>,
    swaps: &'a [Swap],
}

impl<'a> PreparedModels<'a> {
    fn of(asked: &'a AskedCondition<'a>) -> Self {
        let uncertainty = asked.analysis.uncertainty.as_deref();
        let of_condition =
            uncertainty.and_then(|uncertainty| uncertainty.conditions.get(&asked.id()));
        let swaps: &[Swap] = of_condition.map_or(&[], |of| &of.substitutions.substitutions);
        let bundle = |kind| asked.result.condition.bundle(kind);
        let physics = asked.result.comparison.physics.model;
        let others = swaps
            .iter()
            .filter(|(kind, ..)| *kind == BundleKind::Physics)
            .map(|(_, model, _)| *model);
        let models: Vec<usize> = std::iter::once(physics).chain(others).collect();
        let band = asked.analysis.study.settings.band;
        let prepared = |&model: &usize| {
            let dynamics = &bundle(BundleKind::Physics)[model].dynamics;
            (model, ReadModel::of(Cow::Borrowed(dynamics), None, band))
        };
        let of_physics = models.iter().map(prepared).collect();
        let coupled = |&model: &usize| {
            let matrices = bundle(BundleKind::Physics)[model].state_space()?;
            let of = asked
                .result
                .coupled_model(matrices, Pade::default())
                .ok()?
                .into_owned();
            Some((
                model,
                ReadModel::of(Cow::Owned(Dynamics::StateSpace(of)), None, band),
            ))
        };
        let is_coupled = asked.result.coupled.is_some();
        let of_coupled = models
            .iter()
            .filter(|_| is_coupled)
            .filter_map(coupled)
            .collect();
        let flight = asked.result.representative_model(BundleKind::Identified);
        let identified = ReadModel::of(
            Cow::Borrowed(&flight.dynamics),
            flight.bands.as_deref(),
            band,
        );
        Self {
            asked,
            physics,
            of_physics,
            of_coupled,
            identified,
            swaps,
        }
    }

    /// Computes bandwidth and phase delay of a response of a model under a correction, and its
    /// phase where that indicates a reversed channel.
    fn read(
        &self,
        model: &ReadModel<'_>,
        pair: Pair,
        correction: PairCorrection,
        between: Between,
    ) -> Result<(Bandwidth, Option<f64>), AttitudeResponseError> {
        let study = &self.asked.analysis.study;
        let band = study.settings.band;
        let channel = &study.dataset.outputs()[pair.output];
        let output = AttitudeOutput::of(channel)?;
        let exact = model.sampled.exact(pair, correction.multiplier);
        let interpolated = model.sampled.interpolated(pair, correction.multiplier);
        let (response, omega): (&ResponseAt<'_>, _) = match (&*model.dynamics, between) {
            (Dynamics::StateSpace(_), Between::Exact) => (&exact, search_frequencies(band)),
            (Dynamics::StateSpace(_), Between::Interpolated) => {
                (&interpolated, search_frequencies(band))
            }
            (Dynamics::Measured(measured), _) => (&exact, measured.omega().to_vec()),
        };
        let attitude = AttitudeResponse::new(response, output, &omega, band)?;
        // Interpolate, among the 400 points of the line for the phase delay, those between its
        // ends; evaluate ends and crossings with the model itself.
        let attitude = match *model.dynamics {
            Dynamics::StateSpace(_) => attitude.sampled_by(&interpolated),
            Dynamics::Measured(_) => attitude,
        };
        let above_band = if correction.has_leads {
            AboveBand::Refused
        } else {
            AboveBand::Marked
        };
        let settings = BandwidthSettings {
            command: study.requirements.command_of(&channel.name),
            band,
            above_band,
        };
        let deviation = model.bands.map(|bands| PairBand { bands, pair });
        Ok((
            Bandwidth::of(&attitude, &settings, deviation),
            attitude.reversed_phase_deg(),
        ))
    }

    fn finding(&self, pair: Pair, role: RequirementRole) -> BandwidthFinding {
        let (output, input) = self.asked.analysis.study.dataset.channel_names(pair);
        let mut finding = BandwidthFinding {
            condition: self.asked.id(),
            airspeed_kt: self.asked.airspeed_kt(),
            pair,
            output,
            input,
            role,
            model: self.asked.model_name(role),
            ..BandwidthFinding::default()
        };
        match self.bandwidth(pair, role) {
            Err(why) => {
                finding.absent = finding
                    .quantities()
                    .into_iter()
                    .map(|(name, _)| (name, why.clone()))
                    .collect();
            }
            Ok((bandwidth, reversed_phase_deg)) => {
                finding.reversed_phase_deg = reversed_phase_deg;
                finding.take(&bandwidth);
                self.add_intervals(&mut finding, &bandwidth);
            }
        }
        finding
    }

    /// Returns the bandwidth of the model of a role, or why it has none.
    fn bandwidth(
        &self,
        pair: Pair,
        role: RequirementRole,
    ) -> Result<(Bandwidth, Option<f64>), String> {
        let correction = match self.asked.correction(role) {
            None => PairCorrection::NONE,
            Some(of) => PairCorrection::of(of, pair).ok_or("the net gain is not positive")?,
        };
        let model = match role {
            RequirementRole::Identified => &self.identified,
            _ => self.physics_of(role, self.physics)?,
        };
        self.read(model, pair, correction, Between::Exact)
            .map_err(|error| error.to_string())
    }

    /// Returns a physics model as used in a role: with the couplings where it is corrected.
    fn physics_of(
        &self,
        role: RequirementRole,
        model: usize,
    ) -> Result<&ReadModel<'a>, &'static str> {
        if role == RequirementRole::Physics || self.asked.result.coupled.is_none() {
            return Ok(&self.of_physics[&model]);
        }
        self.of_coupled
            .get(&model)
            .ok_or("the physics model has no matrices that couplings can be put into")
    }

    fn add_intervals(&self, finding: &mut BandwidthFinding, bandwidth: &Bandwidth) {
        let why = match finding.role {
            RequirementRole::Physics | RequirementRole::Corrected => {
                self.add_swapped(finding, bandwidth);
                "no other model of the bundles gives a spread"
            }
            RequirementRole::Scheduled => "the schedule is not made again for each swap of models",
            RequirementRole::Identified => {
                finding.take_deviations(
                    bandwidth,
                    self.asked.analysis.study.settings.uncertainty.level,
                );
                match (&*self.identified.dynamics, self.identified.bands) {
                    (_, Some(_)) => "the band of the identified model does not reach so far",
                    (Dynamics::Measured(_), None) => "the measured response carries no band",
                    (Dynamics::StateSpace(_), None) => "the identified model carries no band",
                }
            }
        };
        if finding.interval.is_empty() && metrics(bandwidth).iter().any(|metric| metric.is_ok()) {
            finding.absent.insert("interval", why.to_owned());
        }
    }

    /// Adds the intervals from swapped models.
    fn add_swapped(&self, finding: &mut BandwidthFinding, bandwidth: &Bandwidth) {
        let level = self.asked.analysis.study.settings.uncertainty.level;
        let of_bundle = |kind: BundleKind| -> Vec<MetricValues> {
            let swaps = self.swaps.iter().filter(|(of, ..)| *of == kind);
            swaps
                .map(|swap| self.swapped(swap, finding.pair, finding.role))
                .collect()
        };
        let physics = of_bundle(BundleKind::Physics);
        let is_corrected = finding.role == RequirementRole::Corrected;
        let identified = if is_corrected {
            of_bundle(BundleKind::Identified)
        } else {
            Vec::new()
        };
        for (index, metric) in metrics(bandwidth).into_iter().enumerate() {
            let Ok(metric) = metric else { continue };
            let of_metric = |swaps: &[MetricValues]| {
                swaps.iter().map(|values| values[index]).collect::<Vec<_>>()
            };
            let bar = substitution_bar(metric.value, &of_metric(&physics), &of_metric(&identified));
            if let Some(interval) = bar.interval(level) {
                finding.interval.insert(METRICS[index], interval);
            }
            if bar.left_out > 0 {
                finding.swaps_left_out.insert(METRICS[index], bar.left_out);
            }
        }
    }

    /// Computes the numbers of a response after a swap.
    fn swapped(
        &self,
        (kind, model, figures): &Swap,
        pair: Pair,
        role: RequirementRole,
    ) -> MetricValues {
        let leads = self.asked.result.correction.leads.as_ref();
        let correction = match role {
            RequirementRole::Corrected => figures
                .as_ref()
                .and_then(|figures| PairCorrection::of_swap(figures, pair, leads)),
            _ => Some(PairCorrection::NONE),
        };
        let model = self.physics_of(role, kind.pick(*model, self.physics)).ok();
        let bandwidth = correction.zip(model).and_then(|(correction, model)| {
            self.read(model, pair, correction, Between::Interpolated)
                .ok()
        });
        bandwidth.map_or([None; 5], |(bandwidth, _)| {
            metrics(&bandwidth).map(|of| of.ok().map(|of| of.value))
        })
    }
}

impl BandwidthFinding {
    /// Stores the numbers computed from a response.
    fn take(&mut self, bandwidth: &Bandwidth) {
        let read = metrics(bandwidth);
        let [omega_bw, omega_phase, omega_gain, omega_180, phase_delay] =
            read.map(|of| of.ok().map(|of| of.value));
        (
            self.omega_bw_rad_s,
            self.omega_phase_rad_s,
            self.omega_gain_rad_s,
        ) = (omega_bw, omega_phase, omega_gain);
        (self.omega_180_rad_s, self.phase_delay_s) = (omega_180, phase_delay);
        (self.rule, self.gain_limited) = (bandwidth.rule, bandwidth.is_gain_limited());
        // Where leads invalidate the phase delay, its line depends on them too.
        let line = bandwidth.phase_line.filter(|_| phase_delay.is_some());
        self.phase_departure_deg = line.map(|line| line.departure_deg);
        self.phase_delay_of_line = line.is_some_and(|line: PhaseLine| !line.is_straight());
        for (name, metric) in METRICS.into_iter().zip(read) {
            match metric {
                Ok(metric) => {
                    self.rests_above_band
                        .extend(metric.rests_above_band.then_some(name));
                    self.rests_below_band
                        .extend(metric.rests_below_band.then_some(name));
                }
                Err(why) => {
                    self.absent.insert(name, why.to_string());
                }
            }
        }
        if let Err(why) = bandwidth.phase_delay_s {
            self.absent.insert(DEPARTURE, why.to_string());
        }
    }

    /// Adds intervals from standard deviations: normal, and not below zero.
    fn take_deviations(&mut self, bandwidth: &Bandwidth, level: f64) {
        let factor = student_quantile(level, f64::INFINITY);
        for (name, metric) in METRICS.into_iter().zip(metrics(bandwidth)) {
            if let Ok(Metric {
                value,
                deviation: Some(deviation),
                ..
            }) = metric
            {
                let half = factor * deviation;
                self.interval
                    .insert(name, [(value - half).max(0.0), value + half]);
            }
        }
    }
}

/// Computes the numbers of a response, in the order of [`METRICS`].
fn metrics(bandwidth: &Bandwidth) -> [Result<Metric, NoMetric>; 5] {
    [
        bandwidth.omega_bw,
        bandwidth.omega_phase,
        bandwidth.omega_gain,
        bandwidth.omega_180,
        bandwidth.phase_delay_s,
    ]
}
