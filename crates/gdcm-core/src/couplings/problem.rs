//! What couplings are fitted to (M16.1).

use std::sync::Arc;

use super::CouplingError;
use crate::dataset::{ConditionId, Pair, PairTable};
use crate::fidelity::CoherenceWeights;
use crate::response::FrequencyResponse;
use crate::schedule::Airspeeds;

/// Which couplings are put at the inputs of a physics model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum CouplingKind {
    /// A mixing `M` of the inputs.
    Mixing,
    /// A mixing, and a feedback `K` of outputs to inputs.
    #[default]
    MixingAndFeedback,
}

impl CouplingKind {
    /// Whether outputs are fed back.
    pub fn feeds_back(self) -> bool {
        self == Self::MixingAndFeedback
    }
}

/// One flight condition of the fit: its representatives on the frequencies of the band.
#[derive(Clone, Debug)]
pub struct CouplingCondition {
    /// Which it is.
    pub id: ConditionId,
    /// True airspeed \[kt\].
    pub airspeed_kt: f64,
    /// `H`, p x m: the physics representative, not finite where it has no response.
    pub physics: Arc<FrequencyResponse>,
    /// `R'`, p x m: the identified representative without the channels' delays and leads, see [`super::without_channels`]; not finite
    /// where it has no response.
    pub flight: FrequencyResponse,
    /// The responses that both representatives have (M6, M6a); the others have weight 0.
    pub usable: PairTable<bool>,
    /// Standard deviation of the identified model's `ln H`, one value for each frequency, see [`super::response_deviation`]; none: 0.
    pub deviation: Option<PairTable<Vec<f64>>>,
    /// Frequencies that count by the coherence of the identified representative, and how much (M4a); none: all alike.
    pub coherence: Option<PairTable<CoherenceWeights>>,
}

/// What couplings are fitted to: those conditions that are analysed and not held out, and have both representatives.
#[derive(Clone, Debug)]
pub struct CouplingProblem {
    /// Which couplings.
    pub kind: CouplingKind,
    /// The frequencies of every response \[rad/s\], rising.
    pub omega: Arc<[f64]>,
    /// The on-axis responses, which weigh twice.
    pub on_axis: PairTable<bool>,
    /// The conditions.
    pub conditions: Vec<CouplingCondition>,
    /// How it is fitted.
    pub options: CouplingOptions,
}

/// How couplings are fitted (M16.2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CouplingOptions {
    /// `rho`: how strongly the entries are drawn to M = I, K = 0, as a share of what the responses say of each.
    pub ridge: f64,
    /// Number of linear least-squares problems, one after the other.
    pub solves: usize,
    /// Highest power of the scaled airspeed in the diagonal of `M`.
    pub degree: usize,
    /// Airspeeds within this of the next one \[kt\] are one (M11b).
    pub airspeed_tolerance_kt: f64,
}

impl Default for CouplingOptions {
    fn default() -> Self {
        Self { ridge: 1e-3, solves: 5, degree: 2, airspeed_tolerance_kt: 2.0 }
    }
}

impl CouplingProblem {
    /// Number of outputs, `p`.
    pub fn outputs(&self) -> usize {
        self.on_axis.outputs()
    }

    /// Number of inputs, `m`.
    pub fn inputs(&self) -> usize {
        self.on_axis.inputs()
    }

    /// The same without one condition.
    pub fn without(&self, place: usize) -> Self {
        let kept = self.conditions.iter().enumerate().filter(|(at, _)| *at != place);
        Self {
            kind: self.kind,
            omega: Arc::clone(&self.omega),
            on_axis: self.on_axis.clone(),
            conditions: kept.map(|(_, condition)| condition.clone()).collect(),
            options: self.options,
        }
    }

    /// The airspeeds of the conditions, centred and scaled.
    ///
    /// # Errors
    /// [`CouplingError::NothingToFit`] where there is no condition.
    pub(super) fn airspeeds(&self) -> Result<Airspeeds, CouplingError> {
        let airspeeds_kt = self.conditions.iter().map(|condition| condition.airspeed_kt).collect();
        let airspeeds = Airspeeds::new(airspeeds_kt, self.options.airspeed_tolerance_kt);
        airspeeds.ok_or(CouplingError::NothingToFit { conditions: 0 })
    }

    /// The outputs of which `K` has a column: all that the feedback can use, none of a mixing alone.
    ///
    /// An input column of the equations needs the flight response of every such output. An output that some input would have at no
    /// frequency of no condition is therefore left out, and so is one that the physics models do not have.
    pub(super) fn fed_back(&self) -> Vec<usize> {
        if !self.kind.feeds_back() {
            return Vec::new();
        }
        let inputs: Vec<usize> = (0..self.inputs()).filter(|&input| self.has_data(input)).collect();
        let is_known = |output: usize| inputs.iter().all(|&input| self.is_known(Pair::new(output, input)));
        (0..self.outputs()).filter(|&output| is_known(output)).collect()
    }

    /// Whether flight tells anything of an input.
    fn has_data(&self, input: usize) -> bool {
        (0..self.outputs()).any(|output| self.is_known(Pair::new(output, input)))
    }

    /// Whether a response of flight is known at some frequency at which the physics model has all responses of its output.
    fn is_known(&self, pair: Pair) -> bool {
        self.conditions.iter().any(|condition| {
            let has_row = |k: usize| {
                (0..self.inputs()).all(|input| condition.physics.curve(Pair::new(pair.output, input))[k].is_finite())
            };
            let flight = condition.flight.curve(pair);
            (0..flight.len()).any(|k| flight[k].is_finite() && has_row(k))
        })
    }

    /// Whether every table has a value for each response and frequency.
    ///
    /// # Errors
    /// [`CouplingError::Shape`] of the first that has not, [`CouplingError::NothingToFit`] where there is no condition.
    pub(super) fn check(&self) -> Result<(), CouplingError> {
        let (outputs, inputs, points) = (self.outputs(), self.inputs(), self.omega.len());
        let expected = (outputs, inputs, points);
        for condition in &self.conditions {
            let shape = |of: &FrequencyResponse| (of.outputs(), of.inputs(), points_of(of.curves(), points));
            let usable = (condition.usable.outputs(), condition.usable.inputs(), points);
            let deviation = condition.deviation.as_ref();
            let deviation = deviation.map(|of| (of.outputs(), of.inputs(), points_of(of, points)));
            let coherence = condition.coherence.as_ref().map(|of| (of.outputs(), of.inputs(), points));
            let found =
                [Some(shape(&condition.physics)), Some(shape(&condition.flight)), Some(usable), deviation, coherence];
            if let Some(wrong) = found.into_iter().flatten().find(|found| *found != expected) {
                return Err(CouplingError::Shape {
                    condition: condition.id,
                    expected_outputs: outputs,
                    expected_inputs: inputs,
                    expected_points: points,
                    outputs: wrong.0,
                    inputs: wrong.1,
                    points: wrong.2,
                });
            }
        }
        if self.conditions.is_empty() { Err(CouplingError::NothingToFit { conditions: 0 }) } else { Ok(()) }
    }
}

/// `expected` where every curve has as many values, else how many the first has that has not.
fn points_of<T>(curves: &PairTable<Vec<T>>, expected: usize) -> usize {
    curves.iter().map(|(_, curve)| curve.len()).find(|&points| points != expected).unwrap_or(expected)
}
