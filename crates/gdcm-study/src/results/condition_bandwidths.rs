//! Computes bandwidth and phase delay for a condition's models, with intervals (M17.1).
//!
//! A *role* is a version of the model: the physics representative, the same corrected by its own
//! correction or by the schedule, or the identified representative. A *swap* replaces a
//! representative by another kept model.
//!
//! Source of the intervals, by role; the scheduled model has none, because no schedule is fitted to
//! the swaps:
//!
//! ```text
//! physics     each other kept physics model instead of the representative, uncorrected   (M13.1)
//! corrected   each swap of a physics or identified model, with the resulting correction  (M13.1)
//! identified  standard deviations that the model contains, to first order                (M14)
//! ```

use std::borrow::Cow;
use std::collections::BTreeMap;

use gdcm_method::correction::Pade;
use gdcm_method::requirements::AttitudeOutput;
use gdcm_method::requirements::attitude_response::{
    AttitudeResponse, AttitudeResponseError, ResponseAt, search_frequencies,
};
use gdcm_method::requirements::bandwidth::{
    AboveBand, Bandwidth, BandwidthSettings, PairUncertainty, substitution_bar,
};
use gdcm_method::requirements::sampled_response::SampledResponse;
use gdcm_model::dataset::model::ModelBands;
use gdcm_model::dataset::{Band, BundleKind, Dynamics, Pair};

use super::bandwidth_correction::BandwidthCorrection;
use super::model_swap::ModelSwap;
use super::requested_condition::RequestedCondition;
use super::required_bandwidth::{
    BandwidthFinding, METRICS, MetricValues, NoBandwidth, metric_values, metrics,
};
use super::requirement_role::RequirementRole;

/// Computes a condition's on-axis bandwidths for every role; a response without a bandwidth has the
/// reason instead.
pub(crate) fn bandwidth_findings(requested: &RequestedCondition<'_>) -> Vec<BandwidthFinding> {
    let models = ConditionBandwidths::new(requested);
    let mut findings = Vec::new();
    for pair in requested.analysis.study.dataset.measuring_pairs().marked() {
        for role in requested.roles() {
            findings.push(models.finding(pair, role));
        }
    }
    findings
}

/// A model prepared for evaluating its responses.
struct EvaluatedModel<'a> {
    dynamics: Cow<'a, Dynamics>,
    /// Standard deviations of the response over frequency, if the model contains them.
    deviations: Option<&'a ModelBands>,
    sampled: SampledResponse,
}

impl<'a> EvaluatedModel<'a> {
    fn new(dynamics: Cow<'a, Dynamics>, deviations: Option<&'a ModelBands>, band: Band) -> Self {
        let sampled = SampledResponse::new(&dynamics, band);
        Self {
            dynamics,
            deviations,
            sampled,
        }
    }
}

/// How a model is evaluated between the grid frequencies.
#[derive(Clone, Copy, PartialEq)]
enum Evaluation {
    Exact,
    /// By interpolation, for models that only contribute to a metric's scatter.
    Interpolated,
}

/// A response's bandwidth, and its phase \[deg\] at the band's lowest frequency where that
/// indicates a reversed channel.
struct MeasuredBandwidth {
    bandwidth: Bandwidth,
    reversed_phase_deg: Option<f64>,
}

/// A condition's models, prepared for bandwidths.
struct ConditionBandwidths<'a> {
    requested: &'a RequestedCondition<'a>,
    /// The physics representative's index.
    physics: usize,
    /// The physics representative and the models that replace it in swaps, by index.
    plain: BTreeMap<usize, EvaluatedModel<'a>>,
    /// The models in `plain` with the couplings, where these can be applied; empty without
    /// couplings.
    coupled: BTreeMap<usize, EvaluatedModel<'a>>,
    identified: EvaluatedModel<'a>,
    swaps: &'a [ModelSwap],
}

impl<'a> ConditionBandwidths<'a> {
    fn new(requested: &'a RequestedCondition<'a>) -> Self {
        let band = requested.analysis.study.settings.band;
        let physics = requested.result.comparison.physics.model;
        let swaps = swaps_of(requested);
        let mut used = vec![physics];
        for swap in swaps {
            if swap.bundle == BundleKind::Physics {
                used.push(swap.model);
            }
        }
        let models = requested.result.condition.bundle(BundleKind::Physics);
        let mut plain = BTreeMap::new();
        let mut coupled = BTreeMap::new();
        for index in used {
            let dynamics = &models[index].dynamics;
            plain.insert(
                index,
                EvaluatedModel::new(Cow::Borrowed(dynamics), None, band),
            );
            if let Some(dynamics) = coupled_dynamics(requested, index) {
                coupled.insert(index, EvaluatedModel::new(Cow::Owned(dynamics), None, band));
            }
        }
        let flight = requested
            .result
            .representative_model(BundleKind::Identified);
        let identified = EvaluatedModel::new(
            Cow::Borrowed(&flight.dynamics),
            flight.bands.as_deref(),
            band,
        );
        Self {
            requested,
            physics,
            plain,
            coupled,
            identified,
            swaps,
        }
    }

    fn finding(&self, pair: Pair, role: RequirementRole) -> BandwidthFinding {
        let (output, input) = self
            .requested
            .analysis
            .study
            .dataset
            .output_and_input_name(pair);
        let mut finding = BandwidthFinding {
            condition: self.requested.id(),
            airspeed_kt: self.requested.airspeed_kt(),
            pair,
            output,
            input,
            role,
            model: self.requested.model_name(role),
            ..BandwidthFinding::default()
        };
        match self.bandwidth(pair, role) {
            Err(why) => {
                for (name, _) in finding.quantities() {
                    finding.absent.insert(name, why.clone());
                }
            }
            Ok(measured) => {
                finding.reversed_phase_deg = measured.reversed_phase_deg;
                finding.store(&measured.bandwidth);
                self.add_intervals(&mut finding, &measured.bandwidth);
            }
        }
        finding
    }

    /// Returns a role's bandwidth, or why it has none.
    fn bandwidth(
        &self,
        pair: Pair,
        role: RequirementRole,
    ) -> Result<MeasuredBandwidth, NoBandwidth> {
        let correction = match self.requested.correction(role) {
            None => BandwidthCorrection::NONE,
            Some(correction) => BandwidthCorrection::from_correction(correction, pair)
                .ok_or(NoBandwidth::NetGainNotPositive)?,
        };
        let model = match role {
            RequirementRole::Identified => &self.identified,
            _ => self.physics_model(role, self.physics)?,
        };
        self.measure(model, pair, correction, Evaluation::Exact)
            .map_err(NoBandwidth::NoAttitudeResponse)
    }

    /// Returns the physics model for a role: with the couplings, if the role has a correction.
    fn physics_model(
        &self,
        role: RequirementRole,
        index: usize,
    ) -> Result<&EvaluatedModel<'a>, NoBandwidth> {
        if role == RequirementRole::Physics || self.requested.result.coupled.is_none() {
            return Ok(&self.plain[&index]);
        }
        self.coupled.get(&index).ok_or(NoBandwidth::NotCoupled)
    }

    /// Computes a response's bandwidth and phase delay under a correction.
    fn measure(
        &self,
        model: &EvaluatedModel<'_>,
        pair: Pair,
        correction: BandwidthCorrection,
        evaluation: Evaluation,
    ) -> Result<MeasuredBandwidth, AttitudeResponseError> {
        let study = &self.requested.analysis.study;
        let band = study.settings.band;
        let channel = &study.dataset.outputs()[pair.output];
        let output = AttitudeOutput::classify(channel)?;
        let exact = model.sampled.exact(pair, correction.multiplier);
        let interpolated = model.sampled.interpolated(pair, correction.multiplier);
        let attitude = match &*model.dynamics {
            Dynamics::Measured(measured) => {
                AttitudeResponse::new(&exact, output, measured.omega(), band)?
            }
            Dynamics::StateSpace(_) => {
                let response: &ResponseAt<'_> = match evaluation {
                    Evaluation::Exact => &exact,
                    Evaluation::Interpolated => &interpolated,
                };
                // The phase delay is computed from 400 points. The end points, like the crossings,
                // are evaluated with `response`; the points between them are always interpolated.
                AttitudeResponse::new(response, output, &search_frequencies(band), band)?
                    .sampled_by(&interpolated)
            }
        };
        let settings = BandwidthSettings {
            command: study.requirements.command_of(&channel.name),
            band,
            // A model corrected with leads is not valid above the band (M15.6).
            above_band: if correction.has_leads {
                AboveBand::Refused
            } else {
                AboveBand::Marked
            },
        };
        let deviation = model
            .deviations
            .map(|bands| PairUncertainty { bands, pair });
        Ok(MeasuredBandwidth {
            bandwidth: Bandwidth::read(&attitude, &settings, deviation),
            reversed_phase_deg: attitude.reversed_phase_deg(),
        })
    }

    /// Adds the intervals of the metrics (bandwidth, the frequencies behind it, and phase delay);
    /// if there are none although a metric is defined, adds why.
    fn add_intervals(&self, finding: &mut BandwidthFinding, bandwidth: &Bandwidth) {
        let level = self.requested.analysis.study.settings.uncertainty.level;
        let why_none = match finding.role {
            RequirementRole::Physics | RequirementRole::Corrected => {
                self.add_swap_intervals(finding, bandwidth, level);
                if self.requested.analysis.uncertainty.is_some() {
                    NoBandwidth::NoOtherModel
                } else {
                    NoBandwidth::BarsNotComputed
                }
            }
            RequirementRole::Scheduled => NoBandwidth::ScheduleNotRefitted,
            RequirementRole::Identified => {
                finding.add_deviation_intervals(bandwidth, level);
                match (&*self.identified.dynamics, self.identified.deviations) {
                    (_, Some(_)) => NoBandwidth::DeviationsTooNarrow,
                    (Dynamics::Measured(_), None) => NoBandwidth::MeasuredWithoutDeviations,
                    (Dynamics::StateSpace(_), None) => NoBandwidth::ModelWithoutDeviations,
                }
            }
        };
        if finding.interval.is_empty() && metrics(bandwidth).iter().any(Result::is_ok) {
            finding.absent.insert("interval", why_none);
        }
    }

    /// Adds the intervals from swaps, in which another model replaces a representative (M13.1).
    fn add_swap_intervals(
        &self,
        finding: &mut BandwidthFinding,
        bandwidth: &Bandwidth,
        level: f64,
    ) {
        let physics = self.swapped_values(finding, BundleKind::Physics);
        let identified = match finding.role {
            RequirementRole::Corrected => self.swapped_values(finding, BundleKind::Identified),
            _ => Vec::new(),
        };
        for (index, value) in metric_values(bandwidth).into_iter().enumerate() {
            let Some(value) = value else { continue };
            let physics_values: Vec<Option<f64>> = physics.iter().map(|swap| swap[index]).collect();
            let identified_values: Vec<Option<f64>> =
                identified.iter().map(|swap| swap[index]).collect();
            let bar = substitution_bar(value, &physics_values, &identified_values);
            if let Some(interval) = bar.interval(level) {
                finding.interval.insert(METRICS[index], interval);
            }
            if bar.left_out > 0 {
                finding.swaps_left_out.insert(METRICS[index], bar.left_out);
            }
        }
    }

    /// Computes a response's metrics after each swap in a bundle; no values where that is
    /// impossible.
    fn swapped_values(&self, finding: &BandwidthFinding, bundle: BundleKind) -> Vec<MetricValues> {
        let mut values = Vec::new();
        for swap in self.swaps {
            if swap.bundle == bundle {
                let swapped = self.swapped(swap, finding.pair, finding.role);
                values.push(swapped.unwrap_or_default());
            }
        }
        values
    }

    /// Computes a response's metrics after a swap; `None` where that is impossible.
    fn swapped(&self, swap: &ModelSwap, pair: Pair, role: RequirementRole) -> Option<MetricValues> {
        let correction = match role {
            RequirementRole::Corrected => {
                // Only the design of these lead filters is used; the leads are the swap's, given by
                // its negative delays.
                let leads = self.requested.result.correction.leads.as_ref();
                BandwidthCorrection::from_scalars(swap.figures.as_deref()?, pair, leads)?
            }
            _ => BandwidthCorrection::NONE,
        };
        let index = match swap.bundle {
            BundleKind::Physics => swap.model,
            BundleKind::Identified => self.physics,
        };
        let model = self.physics_model(role, index).ok()?;
        let measured = self
            .measure(model, pair, correction, Evaluation::Interpolated)
            .ok()?;
        Some(metric_values(&measured.bandwidth))
    }
}

/// Returns a condition's swaps; empty without error bars.
fn swaps_of<'a>(requested: &RequestedCondition<'a>) -> &'a [ModelSwap] {
    let Some(uncertainty) = requested.analysis.uncertainty.as_deref() else {
        return &[];
    };
    match uncertainty.conditions.get(&requested.id()) {
        Some(condition) => &condition.swaps.swaps,
        None => &[],
    }
}

/// Returns a physics model with the couplings; `None` without couplings, and where they cannot be
/// applied to it.
fn coupled_dynamics(requested: &RequestedCondition<'_>, index: usize) -> Option<Dynamics> {
    requested.result.coupled.as_ref()?;
    let model = &requested.result.condition.bundle(BundleKind::Physics)[index];
    let coupled = requested
        .result
        .coupled_model(model.state_space()?, Pade::default())
        .ok()?;
    Some(Dynamics::StateSpace(coupled.into_owned()))
}
