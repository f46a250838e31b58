//! Normal equations in a pass, summed over the conditions, and their solution (steps 6 and 7 in
//! `physics`, M18.2). A *block* holds the weighted products of a response's residuals and
//! derivatives in one third of the frequencies (`pair_blocks`).
//!
//! `R` is the identified response, `H^` the physics response with parameters and channels at the
//! present point, `q` a weight, `s` the misfit. The factor `w` makes a response count as `nu`
//! independent frequencies, not as the `N` in the grid, and relates the squares to the misfit.

use nalgebra::DVector;

use gdcm_model::statistics::mean;

use super::condition_equations::{
    ConditionEquations, DataPart, EquationScale, ReducedEquations, UnknownCounts,
};
use super::pair_blocks::ConditionBlocks;
use super::point::FitPoint;
use super::problem::{GREATEST_VALUE, PhysicsError, PhysicsProblem};
use super::shared_system::SharedSystem;
use crate::correction::Channels;

/// Least misfit `s`, ln units (1 % in magnitude, 0.6 deg in phase): exact data must not get an
/// unlimited weight against the priors.
const LEAST_MISFIT: f64 = 0.01;

/// Normal equations for all conditions at a point.
#[derive(Debug)]
pub(super) struct PassEquations {
    /// By condition, as are `conditions` and `reduced`.
    pub(super) blocks: Vec<ConditionBlocks>,
    pub(super) counts: UnknownCounts,
    pub(super) scale: EquationScale,
    /// Prior standard deviation of a delay \[s\].
    delay_sd_s: f64,
    pub(super) conditions: Vec<ConditionEquations>,
    /// The conditions' equations after the elimination of their ln gains.
    pub(super) reduced: Vec<ReducedEquations>,
    pub(super) system: SharedSystem,
    /// `s^2`.
    pub(super) misfit_square: f64,
    /// `sum q^2 |ln(R / H^)|^2`.
    pub(super) weighted_square: f64,
}

impl PassEquations {
    /// Sums the conditions' blocks to equations.
    ///
    /// ```text
    /// 1  s^2 <- max(sum q^2 |ln(R / H^)|^2 / (2 sum q^2), 0.01^2),   w <- nu / (N s^2)
    /// 2  for each condition: equations, and the same with its ln gains eliminated (`condition_equations`)
    /// 3  system <- sum of the latter over the conditions (`shared_system`)
    /// ```
    ///
    /// # Errors
    /// [`PhysicsError::NothingToFit`] without any weight, [`PhysicsError::SingularNormalMatrix`] if
    /// a condition's ln gains are not determined.
    pub(super) fn new(
        problem: &PhysicsProblem,
        parameters: usize,
        blocks: Vec<ConditionBlocks>,
    ) -> Result<Self, PhysicsError> {
        // Step 1
        let mut weighted_square = 0.0;
        let mut weight = 0.0;
        for condition_blocks in &blocks {
            let sums = condition_blocks.sums();
            weighted_square += sums.squared_error;
            weight += sums.weight;
        }
        if weight.is_nan() || weight <= 0.0 {
            return Err(PhysicsError::NothingToFit {
                conditions: blocks.len(),
            });
        }
        let misfit_square = (weighted_square / (2.0 * weight)).max(LEAST_MISFIT.powi(2));
        let counts = UnknownCounts {
            parameters,
            outputs: problem.outputs(),
            inputs: problem.inputs(),
        };
        let options = &problem.options;
        let scale = EquationScale {
            weight: options.independent_frequencies / (problem.omega.len() as f64 * misfit_square),
            gain_sd: options.gain_sd,
        };
        // Steps 2 and 3
        let mut system = SharedSystem::new(counts, options.delay_sd_s);
        let mut conditions = Vec::with_capacity(blocks.len());
        let mut reduced = Vec::with_capacity(blocks.len());
        for condition_blocks in &blocks {
            let equations = ConditionEquations::new(condition_blocks, counts, None);
            let without_gains = equations.reduced(scale).ok_or(singular(counts))?;
            system.add(&without_gains);
            conditions.push(equations);
            reduced.push(without_gains);
        }
        Ok(Self {
            blocks,
            counts,
            scale,
            delay_sd_s: options.delay_sd_s,
            conditions,
            reduced,
            system,
            misfit_square,
            weighted_square,
        })
    }

    /// Returns the solution, with parameter values limited to
    /// [`GREATEST_VALUE`](super::problem::GREATEST_VALUE) in magnitude; parameters that are not
    /// fitted stay.
    ///
    /// # Errors
    /// [`PhysicsError::SingularNormalMatrix`] if the system has no Cholesky factors.
    pub(super) fn solution(
        &self,
        point: &FitPoint,
        fitted: &[usize],
    ) -> Result<FitPoint, PhysicsError> {
        let x = self.system.solve().ok_or(singular(self.counts))?;
        let mut solution = point.clone();
        for (value, &parameter) in x.iter().zip(fitted) {
            solution.z[parameter] = value.clamp(-GREATEST_VALUE, GREATEST_VALUE);
        }
        solution.delays_s = self.channels(&x, self.counts.parameters);
        for (index, ln_gains) in solution.ln_gains.iter_mut().enumerate() {
            let gains = self.conditions[index].ln_gains(&self.reduced[index], self.scale, &x);
            *ln_gains = self.channels(&gains, 0);
        }
        Ok(solution)
    }

    /// Returns the channel values in a vector of unknowns, outputs first, from index `first`.
    fn channels(&self, values: &DVector<f64>, first: usize) -> Channels<f64> {
        let values = values.as_slice();
        let outputs = first + self.counts.outputs;
        Channels {
            outputs: values[first..outputs].to_vec(),
            inputs: values[outputs..outputs + self.counts.inputs].to_vec(),
        }
    }

    /// Counts the conditions with any weight.
    pub(super) fn count_conditions_with_data(&self) -> usize {
        let mut count = 0;
        for blocks in &self.blocks {
            if blocks.sums().weight > 0.0 {
                count += 1;
            }
        }
        count
    }

    /// Returns whether a part of the data has any weight.
    pub(super) fn has_data(&self, part: DataPart) -> bool {
        for blocks in &self.blocks {
            for (pair, thirds) in blocks.responses.iter() {
                for (third, block) in thirds.iter().enumerate() {
                    if part.contains(pair, third) && block.weight > 0.0 {
                        return true;
                    }
                }
            }
        }
        false
    }

    /// Returns the spread, ln units: the weighted root mean square distance between the other
    /// identified models and their representatives; `None` without other models.
    pub(super) fn spread(&self) -> Option<f64> {
        let squares: Vec<f64> = self
            .blocks
            .iter()
            .flat_map(|blocks| blocks.other_squares.iter().copied())
            .collect();
        if squares.is_empty() {
            return None;
        }
        Some(mean(&squares).sqrt())
    }

    /// Returns the shared equations without a part of the data in all conditions; `None` if they
    /// cannot be reduced.
    pub(super) fn system_without(&self, part: DataPart) -> Option<SharedSystem> {
        let mut system = SharedSystem::new(self.counts, self.delay_sd_s);
        for blocks in &self.blocks {
            let equations = ConditionEquations::new(blocks, self.counts, Some(part));
            system.add(&equations.reduced(self.scale)?);
        }
        Some(system)
    }
}

/// Returns the error for a normal matrix without Cholesky factors.
pub(super) fn singular(counts: UnknownCounts) -> PhysicsError {
    PhysicsError::SingularNormalMatrix {
        parameters: counts.parameters,
    }
}
