//! Data and settings for the parameter fit (M18.2): which named parameters of the physics model
//! would have to move so that it matches flight. A *representative* is the model that stands for a
//! condition's physics or identified models (M5). A parameter's *plausible standard deviation* is
//! the change that the engineer considers plausible.

use std::sync::Arc;

use gdcm_model::dataset::{ConditionId, PairTable};
use gdcm_model::response::FrequencyResponse;

pub use super::error::PhysicsError;

use super::family::ModelFamily;
use crate::fidelity::CoherenceWeights;

/// Maximum magnitude that a parameter value can have, in plausible standard deviations. A value at
/// this bound is not plausible: another parameter with a similar effect may be the cause (M18.4).
pub const GREATEST_VALUE: f64 = 3.0;

/// A flight condition in the fit.
#[derive(Clone, Debug)]
pub struct PhysicsCondition {
    pub id: ConditionId,
    /// The physics representative for any parameter values; p x m responses.
    pub family: Arc<ModelFamily>,
    /// `R`, p x m: the identified representative, not finite where a response is missing.
    pub flight: Arc<FrequencyResponse>,
    /// The bundle's other identified models, from which the spread follows (M18.4).
    pub others: Vec<Arc<FrequencyResponse>>,
    /// Responses available in both representatives (M6, M6a); the others have weight 0.
    pub usable: PairTable<bool>,
    /// Standard deviation of the identified model's `ln H` by frequency; `None` counts as 0.
    pub deviation: Option<PairTable<Vec<f64>>>,
    /// Weights from the identified representative's coherence (M4a); `None` if all frequencies have
    /// the same weight.
    pub coherence: Option<PairTable<CoherenceWeights>>,
}

/// How a parameter that is switched on gets its value.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ParameterValue {
    /// Found by the fit.
    #[default]
    Fitted,
    /// Set by hand, in plausible standard deviations.
    Held(f64),
}

/// Data for the fit: the conditions with runs for all parameters that are switched on.
#[derive(Clone, Debug)]
pub struct PhysicsProblem {
    /// The frequencies \[rad/s\] for all responses, ascending (by default 40 logarithmically spaced
    /// points in the band).
    pub omega: Arc<[f64]>,
    /// The on-axis responses, which have twice the weight.
    pub on_axis: PairTable<bool>,
    /// The parameters, ordered as in the families.
    pub parameters: Vec<ParameterValue>,
    pub conditions: Vec<PhysicsCondition>,
    pub options: PhysicsOptions,
}

/// Settings for the fit (M18.2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhysicsOptions {
    /// Prior standard deviation of the channels' ln gains in each condition (0.2: 20 %); 0: no
    /// gains. A smaller value blames calibration errors on the parameters, a larger one leaves less
    /// to them.
    pub gain_sd: f64,
    /// Prior standard deviation of the channels' delays \[s\], with the same effect; 0: no delays.
    pub delay_sd_s: f64,
    /// `nu`: how many independent frequencies a response counts as. In trials, 1 to 16 gave the
    /// same parameter values.
    pub independent_frequencies: f64,
    /// Maximum number of passes.
    pub passes: usize,
    /// Confidence level for the intervals.
    pub level: f64,
}

impl Default for PhysicsOptions {
    fn default() -> Self {
        Self {
            gain_sd: 0.2,
            delay_sd_s: 0.05,
            independent_frequencies: 4.0,
            passes: 20,
            level: 0.9,
        }
    }
}

impl PhysicsProblem {
    /// Returns the output count, `p`.
    pub fn outputs(&self) -> usize {
        self.on_axis.outputs()
    }

    /// Returns the input count, `m`.
    pub fn inputs(&self) -> usize {
        self.on_axis.inputs()
    }

    /// Returns the fitted parameters' indices, ascending.
    pub(super) fn fitted_parameters(&self) -> Vec<usize> {
        let mut fitted = Vec::new();
        for (index, value) in self.parameters.iter().enumerate() {
            if *value == ParameterValue::Fitted {
                fitted.push(index);
            }
        }
        fitted
    }

    /// Returns the values before the first pass: zero, or the values set by hand.
    pub(super) fn initial_values(&self) -> Vec<f64> {
        self.parameters
            .iter()
            .map(|value| match value {
                ParameterValue::Fitted => 0.0,
                ParameterValue::Held(z) => *z,
            })
            .collect()
    }

    /// Returns the problem with only these parameters fitted, and the others at zero.
    pub fn with_fitted(&self, parameters: &[usize]) -> Self {
        let mut problem = self.clone();
        for (index, value) in problem.parameters.iter_mut().enumerate() {
            *value = if parameters.contains(&index) {
                ParameterValue::Fitted
            } else {
                ParameterValue::Held(0.0)
            };
        }
        problem
    }

    /// Checks settings and values, and that every table has a value for each response and
    /// frequency.
    ///
    /// # Errors
    /// [`PhysicsError::NoParameters`], [`PhysicsError::HeldValue`], [`PhysicsError::Option`],
    /// [`PhysicsError::ParameterCount`] and [`PhysicsError::Shape`].
    pub(super) fn check(&self) -> Result<(), PhysicsError> {
        if self.parameters.is_empty() {
            return Err(PhysicsError::NoParameters);
        }
        for (index, value) in self.parameters.iter().enumerate() {
            if let ParameterValue::Held(value) = *value
                && !value.is_finite()
            {
                return Err(PhysicsError::HeldValue {
                    parameter: index + 1,
                    value,
                });
            }
        }
        self.options.check()?;
        for condition in &self.conditions {
            if condition.family.parameters() != self.parameters.len() {
                return Err(PhysicsError::ParameterCount {
                    condition: condition.id,
                    expected: self.parameters.len(),
                    found: condition.family.parameters(),
                });
            }
            let expected = [self.outputs(), self.inputs(), self.omega.len()];
            for found in condition.table_shapes(self.omega.len()) {
                if found != expected {
                    return Err(PhysicsError::Shape {
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

impl PhysicsOptions {
    fn check(&self) -> Result<(), PhysicsError> {
        for (setting, value) in [
            ("gain_sd", self.gain_sd),
            ("delay_sd_s", self.delay_sd_s),
            ("independent_frequencies", self.independent_frequencies),
        ] {
            if !value.is_finite() || value < 0.0 {
                return Err(PhysicsError::Option { setting, value });
            }
        }
        Ok(())
    }
}

impl PhysicsCondition {
    /// Returns each table's shape: outputs, inputs and frequencies; tables without frequencies
    /// count as having `points`.
    fn table_shapes(&self, points: usize) -> Vec<[usize; 3]> {
        let family = &self.family;
        let mut shapes = vec![
            [
                family.outputs(),
                family.inputs(),
                family.points().unwrap_or(points),
            ],
            self.flight.curves().curve_shape(points),
            [self.usable.outputs(), self.usable.inputs(), points],
        ];
        for other in &self.others {
            shapes.push(other.curves().curve_shape(points));
        }
        if let Some(deviation) = &self.deviation {
            shapes.push(deviation.curve_shape(points));
        }
        if let Some(coherence) = &self.coherence {
            shapes.push([coherence.outputs(), coherence.inputs(), points]);
        }
        shapes
    }
}
