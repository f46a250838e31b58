//! Suggests which physics parameters to move first in reruns, from the observed pattern in
//! couplings, leads and gains (M18.4).
//!
//! | pattern | parameters |
//! |---|---|
//! | the cyclic inputs mix with opposite signs | swashplate phase |
//! | rates feed the crossed cyclic input | wake curvature, inflow time constant, hinge offset |
//! | equal leads on all inputs, or on all outputs | actuators; sensors |
//! | pedal gain with yaw damping | tail rotor, fin, fuselage |
//! | pitch gain that changes with airspeed | tail lift, wake on the tail |
//!
//! A pattern only says what is worth trying: parameters with similar effects produce the same
//! pattern. The cyclic inputs (longitudinal and lateral stick) are the two inputs whose only
//! on-axis response is a rate. Couplings are a mixing of the inputs and a feedback from outputs to
//! inputs; one `may_be_zero` if its error bar includes zero (M16). G is the gain that would match
//! a response (M6).
//!
//! A value is *notable* above a limit below which it would not justify a run. The limits are a
//! compromise: lower ones suggest more runs.

use gdcm_method::correction::Channels;
use gdcm_method::couplings::coupling_shares::{cyclic_inputs, feedback_shares};
use gdcm_method::physics::OfferedParameter;
use gdcm_model::dataset::Pair;

use super::analysis::{Analysis, ConditionAnalysis};
use super::coupling_remark_search::is_rate;
use super::couplings_assessment::CouplingsAssessment;
use crate::decisions::settings::PhaseCorrection;

/// Minimum mixing between the cyclic inputs, and minimum share of the stick used by a feedback.
const NOTABLE_SHARE: f64 = 0.01;
/// Minimum mean lead in a channel group \[s\].
const NOTABLE_LEAD_S: f64 = 0.005;
/// Maximum ratio of standard deviation to mean at which leads count as equal.
const EQUAL_LEADS: f64 = 0.5;
/// Minimum magnitude of the mean ln G over the conditions, or of half its range over them, for the
/// rate commanded by the pedals.
const NOTABLE_LN_GAIN: f64 = 0.1;
/// Difference in ln G between fast and slow conditions from which runs are suggested.
const NOTABLE_LN_CHANGE: f64 = 0.08;

/// The observed pattern that suggests runs.
#[derive(Clone, Debug, PartialEq)]
pub enum RunPattern {
    /// Each cyclic input receives a share from the other, with opposite signs.
    CrossedCyclic {
        /// The cyclic inputs.
        inputs: [usize; 2],
        /// Share that the first input receives from the second, and the reverse.
        shares: [f64; 2],
    },
    /// A rate on one cyclic axis is fed to the other cyclic input.
    CrossedRate {
        input: usize,
        output: usize,
        /// Peak share of the stick used by the feedback.
        share: f64,
    },
    /// All inputs, or all outputs, need nearly the same lead.
    EqualLeads {
        side: LeadSide,
        /// Mean signed delay \[s\], negative.
        mean_s: f64,
        /// Standard deviation over the channels \[s\].
        deviation_s: f64,
    },
    /// The rate commanded by the pedals needs another gain and, where couplings are assessed, a
    /// damping feedback.
    PedalGainAndYawDamping {
        pair: Pair,
        /// Geometric mean of G over the conditions.
        gain: f64,
        /// Peak share of the stick used by the feedback; `None` without assessed couplings.
        damping_share: Option<f64>,
    },
    /// The pitch rate's G differs between fast and slow conditions.
    PitchGainOverAirspeed {
        pair: Pair,
        /// Geometric mean of G in the slower half of the conditions.
        slow: f64,
        /// Geometric mean of G in the faster half.
        fast: f64,
    },
}

/// The channels that need equal leads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LeadSide {
    Inputs,
    Outputs,
    /// Both, where only the responses are known.
    Responses,
}

impl RunPattern {
    /// Returns the stable code, for files, programs and tests.
    pub fn code(&self) -> &'static str {
        match self {
            Self::CrossedCyclic { .. } => "crossed-cyclic",
            Self::CrossedRate { .. } => "crossed-rate",
            Self::EqualLeads {
                side: LeadSide::Inputs,
                ..
            } => "equal-leads-of-inputs",
            Self::EqualLeads {
                side: LeadSide::Outputs,
                ..
            } => "equal-leads-of-outputs",
            Self::EqualLeads {
                side: LeadSide::Responses,
                ..
            } => "equal-leads-of-responses",
            Self::PedalGainAndYawDamping { .. } => "pedal-gain-and-yaw-damping",
            Self::PitchGainOverAirspeed { .. } => "pitch-gain-over-airspeed",
        }
    }

    /// Returns the parameters worth a run.
    pub fn parameters(&self) -> &'static [RunParameter] {
        match self {
            Self::CrossedCyclic { .. } => &SWASHPLATE,
            Self::CrossedRate { .. } => &RATE_COUPLING,
            Self::EqualLeads { side, .. } => match side {
                LeadSide::Inputs => &BANDWIDTHS[..1],
                LeadSide::Outputs => &BANDWIDTHS[1..],
                LeadSide::Responses => &BANDWIDTHS,
            },
            Self::PedalGainAndYawDamping { .. } => &YAW,
            Self::PitchGainOverAirspeed { .. } => &PITCH,
        }
    }
}

/// A parameter worth a run, with a usual step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunParameter {
    /// Proposed name in the dataset.
    pub name: &'static str,
    pub meaning: &'static str,
    pub step: f64,
    pub unit: &'static str,
}

/// Creates a parameter whose step is in percent of its value.
const fn percent(name: &'static str, meaning: &'static str, step: f64) -> RunParameter {
    RunParameter {
        name,
        meaning,
        step,
        unit: "%",
    }
}

static SWASHPLATE: [RunParameter; 1] = [RunParameter {
    name: "swashplate_phase",
    meaning: "control phase of the swashplate",
    step: 2.0,
    unit: "deg",
}];

static RATE_COUPLING: [RunParameter; 3] = [
    RunParameter {
        name: "wake_curvature",
        meaning: "wake curvature: inflow that depends on rates",
        step: 0.25,
        unit: "1",
    },
    percent(
        "inflow_mass",
        "apparent mass of the inflow, which sets its time constant",
        10.0,
    ),
    percent("hinge_offset", "offset of the flapping hinge", 5.0),
];

static BANDWIDTHS: [RunParameter; 2] = [
    percent("actuator_bandwidth", "bandwidth of all actuators", 20.0),
    percent("sensor_bandwidth", "bandwidth of all sensors", 20.0),
];

static YAW: [RunParameter; 3] = [
    percent("tail_rotor", "effectiveness of the tail rotor", 10.0),
    percent("fin_lift", "lift slope of the fin", 10.0),
    percent("fuselage_yaw", "yaw moment of the fuselage", 10.0),
];

static PITCH: [RunParameter; 2] = [
    percent("tail_lift", "lift slope of the tailplane", 10.0),
    RunParameter {
        name: "tail_wake",
        meaning: "downwash of the rotor wake on the tailplane",
        step: 0.15,
        unit: "1",
    },
];

/// A suggestion: a pattern, and the parameters for which the dataset has no run yet.
#[derive(Clone, Debug, PartialEq)]
pub struct SuggestedRuns {
    pub pattern: RunPattern,
    pub parameters: Vec<RunParameter>,
}

/// Lists the runs worth making first, in the order of the table above, without parameters for which
/// the dataset already has runs.
pub fn suggested_runs(
    analysis: &Analysis,
    couplings: Option<&CouplingsAssessment>,
) -> Vec<SuggestedRuns> {
    let pattern_search = PatternSearch {
        analysis,
        couplings,
        results: analysis.conditions.values().flatten().collect(),
    };
    let offered = OfferedParameter::list(&analysis.study.dataset);
    let mut suggestions = Vec::new();
    for pattern in pattern_search.patterns() {
        let mut parameters = pattern.parameters().to_vec();
        parameters.retain(|parameter| offered.iter().all(|other| other.name != parameter.name));
        if !parameters.is_empty() {
            suggestions.push(SuggestedRuns {
                pattern,
                parameters,
            });
        }
    }
    suggestions
}

/// Data in which the patterns are searched.
struct PatternSearch<'a> {
    analysis: &'a Analysis,
    couplings: Option<&'a CouplingsAssessment>,
    results: Vec<&'a ConditionAnalysis>,
}

impl PatternSearch<'_> {
    fn patterns(&self) -> Vec<RunPattern> {
        let mut patterns = Vec::new();
        patterns.extend(self.crossed_cyclic());
        patterns.extend(self.crossed_rate());
        patterns.extend(self.equal_leads());
        patterns.extend(self.pedal_gain());
        patterns.extend(self.pitch_gain());
        patterns
    }

    fn is_rate(&self, output: usize) -> bool {
        is_rate(&self.analysis.study.dataset.outputs()[output])
    }

    /// Returns the two cyclic inputs; `None` unless exactly two inputs qualify.
    fn cyclic(&self) -> Option<[usize; 2]> {
        cyclic_inputs(self.analysis.study.dataset.on_axis(), |output| {
            self.is_rate(output)
        })
    }

    /// Finds a mixing with opposite signs between the cyclic inputs: the larger share is notable,
    /// and not both are within their error bars.
    fn crossed_cyclic(&self) -> Option<RunPattern> {
        let couplings = self.couplings?;
        let inputs = self.cyclic()?;
        let [first, second] = inputs;
        let mixing = couplings.mixing(couplings.mean_airspeed_kt());
        let into_first = &mixing[(first, second)];
        let into_second = &mixing[(second, first)];
        let larger = into_first.value.abs().max(into_second.value.abs());
        let is_notable =
            larger >= NOTABLE_SHARE && !(into_first.may_be_zero && into_second.may_be_zero);
        if is_notable && into_first.value * into_second.value < 0.0 {
            Some(RunPattern::CrossedCyclic {
                inputs,
                shares: [into_first.value, into_second.value],
            })
        } else {
            None
        }
    }

    /// Finds the largest notable feedback, outside its error bar, from a rate on one cyclic axis to
    /// the other cyclic input.
    fn crossed_rate(&self) -> Option<RunPattern> {
        let couplings = self.couplings?;
        let cyclic = self.cyclic()?;
        let on_axis = self.analysis.study.dataset.on_axis();
        let feedback = couplings.feedback();
        let shares = feedback_shares(&couplings.fitted.problem, couplings.fitted.matrices());
        // In descending order: the first that qualifies is the largest.
        for path in shares {
            let is_crossed = cyclic.contains(&path.input)
                && self.is_rate(path.output)
                && cyclic
                    .iter()
                    .any(|&other| other != path.input && on_axis[Pair::new(path.output, other)]);
            let is_significant =
                path.share >= NOTABLE_SHARE && !feedback[(path.input, path.output)].may_be_zero;
            if is_crossed && is_significant {
                return Some(RunPattern::CrossedRate {
                    input: path.input,
                    output: path.output,
                    share: path.share,
                });
            }
        }
        None
    }

    /// Finds equal leads: in the channels where leads are requested, otherwise in the on-axis
    /// responses.
    fn equal_leads(&self) -> Vec<RunPattern> {
        if self.results.is_empty() {
            return Vec::new();
        }
        let mut found = Vec::new();
        if self.analysis.study.settings.phase == PhaseCorrection::Lead {
            let means_s = self.mean_channel_delays_s();
            found.extend(equal_lead(LeadSide::Inputs, &means_s.inputs));
            found.extend(equal_lead(LeadSide::Outputs, &means_s.outputs));
        } else {
            found.extend(equal_lead(
                LeadSide::Responses,
                &self.mean_response_delays_s(),
            ));
        }
        found
    }

    /// Returns each channel's mean signed delay over the conditions \[s\].
    fn mean_channel_delays_s(&self) -> Channels<f64> {
        let count = self.results.len() as f64;
        let dataset = &self.analysis.study.dataset;
        let mut means_s = Channels {
            inputs: vec![0.0; dataset.inputs().len()],
            outputs: vec![0.0; dataset.outputs().len()],
        };
        for result in &self.results {
            let delays_s = result.correction.signed_delays_s();
            for (mean_s, delay_s) in means_s.inputs.iter_mut().zip(&delays_s.inputs) {
                *mean_s += delay_s / count;
            }
            for (mean_s, delay_s) in means_s.outputs.iter_mut().zip(&delays_s.outputs) {
                *mean_s += delay_s / count;
            }
        }
        means_s
    }

    /// Returns each on-axis response's mean D over the band, over the conditions that have it
    /// \[s\].
    fn mean_response_delays_s(&self) -> Vec<f64> {
        let mut means_s = Vec::new();
        for pair in self.analysis.study.dataset.on_axis().marked() {
            let mut delays_s = Vec::new();
            for result in &self.results {
                delays_s.extend(result.comparison.delta.band_delay_s[pair]);
            }
            means_s.extend(mean(&delays_s));
        }
        means_s
    }

    /// Finds the rate commanded by the pedals (the first on-axis rate of an input that is not
    /// cyclic) if its G is notable ([`NOTABLE_LN_GAIN`]) and, where couplings are assessed, its
    /// feedback is outside the error bar.
    fn pedal_gain(&self) -> Option<RunPattern> {
        let cyclic = self.cyclic()?;
        let dataset = &self.analysis.study.dataset;
        let pair = dataset
            .on_axis()
            .marked()
            .find(|pair| !cyclic.contains(&pair.input) && self.is_rate(pair.output))?;
        let gain = mean(&self.ln_gains(pair))?;
        if gain.abs() < NOTABLE_LN_GAIN && self.half_range_of_gain(pair) < NOTABLE_LN_GAIN {
            return None;
        }
        let damping_share = match self.couplings {
            None => None,
            Some(couplings) => {
                let entry = &couplings.feedback()[(pair.input, pair.output)];
                if entry.may_be_zero {
                    return None;
                }
                feedback_shares(&couplings.fitted.problem, couplings.fitted.matrices())
                    .into_iter()
                    .find(|share| share.input == pair.input && share.output == pair.output)
                    .map(|share| share.share)
            }
        };
        Some(RunPattern::PedalGainAndYawDamping {
            pair,
            gain: gain.exp(),
            damping_share,
        })
    }

    /// Returns half the range that ln G spans over the conditions; 0 without values.
    fn half_range_of_gain(&self, pair: Pair) -> f64 {
        let gains = self.ln_gains(pair);
        let least = gains.iter().copied().fold(f64::INFINITY, f64::min);
        let most = gains.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        (0.5 * (most - least)).max(0.0)
    }

    /// Finds a notable difference in the pitch rate's mean ln G between the slower and the faster
    /// half of the conditions.
    fn pitch_gain(&self) -> Option<RunPattern> {
        let dataset = &self.analysis.study.dataset;
        let pair = dataset.on_axis().marked().find(|pair| {
            let name = dataset.outputs()[pair.output].name.to_lowercase();
            self.is_rate(pair.output) && (name == "q" || name.contains("pitch"))
        })?;
        let mut gains = Vec::new();
        for result in &self.results {
            if let Some(gain) = result.comparison.delta.gain[pair] {
                let airspeed_kt = result.condition.flight_state().airspeed_kt;
                gains.push(GainAtAirspeed {
                    airspeed_kt,
                    ln_gain: gain.ln(),
                });
            }
        }
        gains.sort_by(|a, b| a.airspeed_kt.total_cmp(&b.airspeed_kt));
        let (slow, fast) = gains.split_at(gains.len() / 2);
        let [slow, fast] = [slow, fast].map(|gains| {
            let gains: Vec<f64> = gains.iter().map(|gain| gain.ln_gain).collect();
            mean(&gains)
        });
        let slow = slow?;
        let fast = fast?;
        if (fast - slow).abs() < NOTABLE_LN_CHANGE {
            return None;
        }
        Some(RunPattern::PitchGainOverAirspeed {
            pair,
            slow: slow.exp(),
            fast: fast.exp(),
        })
    }

    /// Returns a response's ln G in the conditions that have it.
    fn ln_gains(&self, pair: Pair) -> Vec<f64> {
        let mut gains = Vec::new();
        for result in &self.results {
            gains.extend(result.comparison.delta.gain[pair].map(f64::ln));
        }
        gains
    }
}

/// A condition's ln G at its airspeed.
struct GainAtAirspeed {
    airspeed_kt: f64,
    ln_gain: f64,
}

fn mean(values: &[f64]) -> Option<f64> {
    if values.is_empty() {
        None
    } else {
        Some(values.iter().sum::<f64>() / values.len() as f64)
    }
}

/// Returns the pattern if no signed delay (of two or more) is positive, all are nearly equal, and
/// their mean lead is notable.
fn equal_lead(side: LeadSide, delays_s: &[f64]) -> Option<RunPattern> {
    let mean_s = mean(delays_s)?;
    let squares: Vec<f64> = delays_s
        .iter()
        .map(|delay_s| (delay_s - mean_s).powi(2))
        .collect();
    let deviation_s = mean(&squares)?.sqrt();
    let is_lead = mean_s <= -NOTABLE_LEAD_S && delays_s.iter().all(|delay_s| *delay_s <= 0.0);
    if delays_s.len() >= 2 && is_lead && deviation_s <= EQUAL_LEADS * mean_s.abs() {
        Some(RunPattern::EqualLeads {
            side,
            mean_s,
            deviation_s,
        })
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leads_of_nearly_the_same_size_are_equal() {
        let side = LeadSide::Inputs;
        assert!(equal_lead(side, &[-0.03, -0.025, -0.035, -0.02]).is_some());
        assert_eq!(equal_lead(side, &[-0.03, -0.001, -0.035, 0.0]), None);
        assert_eq!(equal_lead(side, &[-0.03, 0.01]), None);
        assert_eq!(equal_lead(side, &[-0.002, -0.002]), None);
        assert_eq!(equal_lead(side, &[-0.03]), None);
        assert_eq!(equal_lead(side, &[]), None);
    }
}
