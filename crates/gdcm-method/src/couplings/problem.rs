//! Data and settings for the coupling fit (M16.1, M16.2): an input mixing and an output feedback,
//! common to all conditions, that bring the physics models closer to flight. A condition's
//! *representatives* are the physics model and the identified model that stand for all of its
//! models (M5).

use std::sync::Arc;

use gdcm_model::dataset::{ConditionId, Pair, PairTable};
use gdcm_model::response::FrequencyResponse;

pub use super::error::CouplingError;
pub use super::flight_data::{
    coherence_deviation, mean_delays_s, response_deviation, without_delays_and_leads,
};

use crate::fidelity::CoherenceWeights;
use crate::schedule::Airspeeds;

/// Couplings applied at a physics model's inputs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum CouplingKind {
    /// An input mixing `M`.
    Mixing,
    /// A mixing, and a feedback `K` from outputs to inputs.
    #[default]
    MixingAndFeedback,
}

impl CouplingKind {
    /// Returns whether outputs are fed back.
    pub fn feeds_back(self) -> bool {
        self == Self::MixingAndFeedback
    }
}

/// A flight condition in the fit: its representatives on the band's frequencies.
#[derive(Clone, Debug)]
pub struct CouplingCondition {
    pub id: ConditionId,
    /// True airspeed \[kt\].
    pub airspeed_kt: f64,
    /// `H`, p x m: the physics representative, not finite where a response is missing.
    pub physics: Arc<FrequencyResponse>,
    /// `R'`, p x m: the identified representative without the channels' delays and leads
    /// ([`without_delays_and_leads`]); not finite where a response is missing.
    pub flight: FrequencyResponse,
    /// Responses available in both representatives (M6, M6a); the others have weight 0.
    pub usable: PairTable<bool>,
    /// Standard deviation of the identified model's `ln H` by frequency ([`response_deviation`]);
    /// `None` counts as 0.
    pub deviation: Option<PairTable<Vec<f64>>>,
    /// Weights from the identified representative's coherence (M4a); `None` if all frequencies have
    /// the same weight.
    pub coherence: Option<PairTable<CoherenceWeights>>,
}

/// Data for the coupling fit: the analysed conditions with both representatives, without the
/// conditions reserved for validation.
#[derive(Clone, Debug)]
pub struct CouplingProblem {
    pub kind: CouplingKind,
    /// The frequencies \[rad/s\] for all responses, ascending.
    pub omega: Arc<[f64]>,
    /// The on-axis responses, which have twice the weight `q` (`weighted_condition`).
    pub on_axis: PairTable<bool>,
    pub conditions: Vec<CouplingCondition>,
    pub options: CouplingOptions,
}

/// Settings for the coupling fit (M16.2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CouplingOptions {
    /// `rho`: regularisation towards M = I, K = 0, relative to each unknown's diagonal entry in the
    /// normal matrix. In the example, values from 2e-4 to 5e-3 give the same couplings.
    pub ridge: f64,
    /// Count of passes, each a linear least-squares problem. In the example, J after three passes
    /// and after six agrees within 0.1.
    pub passes: usize,
    /// Highest power of the scaled airspeed on the diagonal of `M` while it is fitted. The diagonal
    /// is the level of the inputs, which the channel gains take over afterwards (M16.3).
    pub degree: usize,
    /// Neighbouring airspeeds that differ by at most this \[kt\] count as equal (M11b).
    pub airspeed_tolerance_kt: f64,
}

impl Default for CouplingOptions {
    fn default() -> Self {
        Self {
            ridge: 1e-3,
            passes: 5,
            degree: 2,
            airspeed_tolerance_kt: 2.0,
        }
    }
}

impl CouplingProblem {
    /// Returns the output count, `p`.
    pub fn outputs(&self) -> usize {
        self.on_axis.outputs()
    }

    /// Returns the input count, `m`.
    pub fn inputs(&self) -> usize {
        self.on_axis.inputs()
    }

    /// Returns the problem without the condition at this index.
    pub fn without(&self, index: usize) -> Self {
        let mut others = self.clone();
        others.conditions.remove(index);
        others
    }

    /// Returns the conditions' airspeeds, centred and scaled.
    ///
    /// # Errors
    /// [`CouplingError::NothingToFit`] if there is no condition.
    pub(super) fn airspeeds(&self) -> Result<Airspeeds, CouplingError> {
        let airspeeds_kt = self
            .conditions
            .iter()
            .map(|condition| condition.airspeed_kt)
            .collect();
        let airspeeds = Airspeeds::new(airspeeds_kt, self.options.airspeed_tolerance_kt);
        airspeeds.ok_or(CouplingError::NothingToFit { conditions: 0 })
    }

    /// Returns the outputs with a column in `K`: all that the feedback can use, or none for a
    /// mixing alone.
    ///
    /// An input column in the equations needs every such output's flight response. An output that
    /// is missing for some input with data, at all frequencies in all conditions, is therefore left
    /// out, and so is an output missing from the physics models.
    pub(super) fn fed_back(&self) -> Vec<usize> {
        if !self.kind.feeds_back() {
            return Vec::new();
        }
        let inputs: Vec<usize> = (0..self.inputs())
            .filter(|&input| self.has_data(input))
            .collect();
        (0..self.outputs())
            .filter(|&output| {
                inputs
                    .iter()
                    .all(|&input| self.is_known(Pair::new(output, input)))
            })
            .collect()
    }

    /// Returns whether any response to an input is known ([`Self::is_known`]).
    fn has_data(&self, input: usize) -> bool {
        (0..self.outputs()).any(|output| self.is_known(Pair::new(output, input)))
    }

    /// Returns whether, at any frequency, the flight response exists and the physics model has all
    /// responses in the same output.
    fn is_known(&self, pair: Pair) -> bool {
        self.conditions.iter().any(|condition| {
            let flight = condition.flight.curve(pair);
            (0..flight.len())
                .any(|k| flight[k].is_finite() && condition.has_physics_row(pair.output, k))
        })
    }

    /// Checks that every table has a value for each response and frequency.
    ///
    /// # Errors
    /// [`CouplingError::Shape`] for the first table with another shape.
    pub(super) fn check(&self) -> Result<(), CouplingError> {
        let expected = [self.outputs(), self.inputs(), self.omega.len()];
        for condition in &self.conditions {
            for found in condition.table_shapes(self.omega.len()) {
                if found != expected {
                    return Err(CouplingError::Shape {
                        condition: condition.id,
                        expected,
                        found,
                    });
                }
            }
        }
        Ok(())
    }
}

impl CouplingCondition {
    /// Returns whether the physics model has an output's responses to all inputs at frequency `k`.
    pub(super) fn has_physics_row(&self, output: usize, k: usize) -> bool {
        (0..self.physics.inputs())
            .all(|input| self.physics.curve(Pair::new(output, input))[k].is_finite())
    }

    /// Returns each table's shape: outputs, inputs and frequencies; tables without frequencies
    /// count as having `points`.
    fn table_shapes(&self, points: usize) -> Vec<[usize; 3]> {
        let mut shapes = vec![
            self.physics.curves().curve_shape(points),
            self.flight.curves().curve_shape(points),
            [self.usable.outputs(), self.usable.inputs(), points],
        ];
        if let Some(deviation) = &self.deviation {
            shapes.push(deviation.curve_shape(points));
        }
        if let Some(coherence) = &self.coherence {
            shapes.push([coherence.outputs(), coherence.inputs(), points]);
        }
        shapes
    }
}
