//! Shows how much the data determine each parameter, and which parameters cannot be told apart
//! (step 11 in `physics`, M18.3).
//!
//! ```text
//! learned about k          1 - (P^-1)_kk,     P = F + I
//! channels can take of k   1 - F_kk / F°_kk,  F° as F, but with the channels known
//! correlation of k and l   (P^-1)_kl / sqrt((P^-1)_kk (P^-1)_ll)
//! ```
//!
//! `F` is the parameters' normal matrix after eliminating delays and ln gains (`shared_system`):
//! the information in the data. `I` is the prior's, because the values are in plausible standard
//! deviations. With the channels "known", their gains and delays are not unknowns.

use nalgebra::{Cholesky, DMatrix};

use super::pass_equations::{PassEquations, singular};
use super::problem::PhysicsError;

/// Correlation magnitude above which two parameters cannot be told apart: each then explains more
/// than 64 % of the other's variance, the square of this value.
pub const INSEPARABLE: f64 = 0.8;
/// Share of a parameter's effect that channels can take over, above which its value rests on the
/// delay prior: less than a twentieth of the information about it remains. The bandwidth of all
/// actuators is such a parameter (M18.4).
pub const ACTS_LIKE_CHANNELS: f64 = 0.95;
/// Limit on the least singular value of `F`; below it, the data say less about the parameter
/// combination that belongs to this value than the prior, whose information is `I`, and the
/// combination is reported.
const WEAK_DIRECTION: f64 = 1.0;

/// Two parameters and their correlation in `P^-1`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParameterPair {
    /// Indices among the problem's parameters, ascending.
    pub parameters: [usize; 2],
    pub correlation: f64,
}

/// The parameter combination that the data determine least.
#[derive(Clone, Debug, PartialEq)]
pub struct WeakDirection {
    /// Singular value of `F`, below 1.
    pub singular_value: f64,
    /// Unit vector over the fitted parameters; its largest component is positive.
    pub direction: Vec<f64>,
}

/// How well the data determine the fitted parameters, in their order.
#[derive(Clone, Debug, PartialEq)]
pub struct Identifiability {
    /// `F`.
    pub information: DMatrix<f64>,
    /// `P^-1`.
    pub(super) inverse: DMatrix<f64>,
    /// Singular values of `F`, descending.
    pub singular_values: Vec<f64>,
    /// Present if the least singular value is below 1.
    pub weak_direction: Option<WeakDirection>,
    /// `1 - (P^-1)_kk`.
    pub learned: Vec<f64>,
    /// Share of each parameter's effect that gains and delays can take over; `None` without effect.
    pub channels_can_take: Vec<Option<f64>>,
    /// Correlation between every two parameters.
    pub correlation: DMatrix<f64>,
}

impl Identifiability {
    /// Computes all fields from the equations at the solution.
    ///
    /// # Errors
    /// [`PhysicsError::SingularNormalMatrix`] if a matrix has no Cholesky factors.
    pub(super) fn new(equations: &PassEquations) -> Result<Self, PhysicsError> {
        let size = equations.counts.parameters;
        let information = equations
            .system
            .parameter_information()
            .ok_or(singular(equations.counts))?;
        let posterior_information = &information + DMatrix::identity(size, size);
        let inverse = Cholesky::new(posterior_information)
            .ok_or(singular(equations.counts))?
            .inverse();
        // `F°`.
        let mut with_known_channels = DMatrix::zeros(size, size);
        for condition in &equations.conditions {
            with_known_channels +=
                condition.parameter_information(equations.counts, equations.scale);
        }
        let mut learned = Vec::with_capacity(size);
        let mut channels_can_take = Vec::with_capacity(size);
        for k in 0..size {
            learned.push(1.0 - inverse[(k, k)]);
            let with_known = with_known_channels[(k, k)];
            channels_can_take.push(if with_known > 0.0 {
                Some(1.0 - information[(k, k)] / with_known)
            } else {
                None
            });
        }
        let correlation = DMatrix::from_fn(size, size, |row, column| {
            inverse[(row, column)] / (inverse[(row, row)] * inverse[(column, column)]).sqrt()
        });
        let directions = Directions::new(&information);
        Ok(Self {
            information,
            inverse,
            singular_values: directions.singular_values,
            weak_direction: directions.weak,
            learned,
            channels_can_take,
            correlation,
        })
    }

    /// Lists the pairs whose correlation has a magnitude above 0.8, the strongest first.
    pub(super) fn pairs(&self, fitted: &[usize]) -> Vec<ParameterPair> {
        let mut pairs = Vec::new();
        for second in 0..fitted.len() {
            for first in 0..second {
                let correlation = self.correlation[(first, second)];
                if correlation.abs() > INSEPARABLE {
                    pairs.push(ParameterPair {
                        parameters: [fitted[first], fitted[second]],
                        correlation,
                    });
                }
            }
        }
        pairs.sort_by(|a, b| b.correlation.abs().total_cmp(&a.correlation.abs()));
        pairs
    }

    /// Returns the strongest correlation that the parameter at `index` among the fitted parameters
    /// has with another; `None` for a single parameter.
    pub(super) fn strongest_pair(&self, index: usize, fitted: &[usize]) -> Option<ParameterPair> {
        let mut strongest: Option<ParameterPair> = None;
        for other in 0..fitted.len() {
            let correlation = self.correlation[(index, other)];
            let is_stronger = match &strongest {
                Some(pair) => correlation.abs() > pair.correlation.abs(),
                None => true,
            };
            if other != index && is_stronger {
                let mut parameters = [fitted[index], fitted[other]];
                parameters.sort_unstable();
                strongest = Some(ParameterPair {
                    parameters,
                    correlation,
                });
            }
        }
        strongest
    }
}

/// Singular values of a symmetric matrix without negative eigenvalues, which are these eigenvalues,
/// and the direction that belongs to the least.
struct Directions {
    singular_values: Vec<f64>,
    weak: Option<WeakDirection>,
}

impl Directions {
    fn new(information: &DMatrix<f64>) -> Self {
        let eigen = information.clone().symmetric_eigen();
        let mut order: Vec<usize> = (0..eigen.eigenvalues.len()).collect();
        order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
        // Only rounding makes an eigenvalue of `F` negative.
        let singular_values: Vec<f64> = order
            .iter()
            .map(|&index| eigen.eigenvalues[index].max(0.0))
            .collect();
        let weak = match (order.last(), singular_values.last()) {
            (Some(&index), Some(&singular_value)) if singular_value < WEAK_DIRECTION => {
                let mut direction: Vec<f64> =
                    eigen.eigenvectors.column(index).iter().copied().collect();
                let mut largest = 0.0_f64;
                for component in &direction {
                    if component.abs() > largest.abs() {
                        largest = *component;
                    }
                }
                for component in &mut direction {
                    *component *= largest.signum();
                }
                Some(WeakDirection {
                    singular_value,
                    direction,
                })
            }
            _ => None,
        };
        Self {
            singular_values,
            weak,
        }
    }
}
