//! Least squares over the conditions: split of the scatter about a fit (M13.5), bands of the
//! scheduled `ln k` (M13.6), and the test whether the schedule needs a second variable besides
//! airspeed (M13.7).

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use super::bar::Bar;
use super::distributions::{
    chi_squared_quantile, fisher_upper, student_quantile, student_two_sided,
};
use super::variance_component::{VarianceComponent, satterthwaite};

/// A column is linearly dependent if less than this fraction of its norm is orthogonal to the columns
/// before it.
const DEPENDENT: f64 = 1e-9;

/// Maximum number of columns in a design; a lookup table over more airspeeds has neither a variance
/// split nor bands.
pub const MOST_COLUMNS: usize = 200;

/// Design matrix `X` with full column rank, n conditions by r columns, stored as `Q R`.
#[derive(Clone, Debug, PartialEq)]
pub struct Design {
    q: DMatrix<f64>,
    r: DMatrix<f64>,
}

/// Least-squares fit to one value for each condition.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// Coefficient of each column.
    pub coefficients: Vec<f64>,
    /// Residual of each condition.
    pub residuals: Vec<f64>,
}

impl Design {
    /// Factorises the design, with a row for each condition. `None` if there are no columns, more
    /// columns than rows or than [`MOST_COLUMNS`], or linearly dependent columns.
    pub fn new(rows: &[Vec<f64>]) -> Option<Self> {
        let columns = rows.first()?.len();
        if rows.len() < columns || columns == 0 || columns > MOST_COLUMNS {
            return None;
        }
        let matrix = DMatrix::from_fn(rows.len(), columns, |row, column| rows[row][column]);
        let lengths: Vec<f64> = matrix.column_iter().map(|column| column.norm()).collect();
        let qr = matrix.qr();
        let q = qr.q();
        let r = qr.r();
        for (column, length) in lengths.iter().enumerate() {
            if r[(column, column)].abs() <= DEPENDENT * length {
                return None;
            }
        }
        Some(Self { q, r })
    }

    /// Returns the condition count, n.
    pub fn conditions(&self) -> usize {
        self.q.nrows()
    }

    /// Returns the column count, r.
    pub fn rank(&self) -> usize {
        self.q.ncols()
    }

    /// Returns the residuals' degrees of freedom, `f = n - r`.
    pub fn freedom(&self) -> usize {
        self.conditions() - self.rank()
    }

    /// Returns the hat values by condition, `h_c`: derivatives of the fitted values with respect to
    /// the condition's own value.
    pub fn hat_values(&self) -> Vec<f64> {
        (0..self.conditions())
            .map(|row| self.q.row(row).norm_squared().min(1.0))
            .collect()
    }

    /// Computes `x' (X'X)^-1 x` for any row `x`.
    pub fn leverage(&self, row: &[f64]) -> f64 {
        let row = DVector::from_column_slice(row);
        self.r
            .transpose()
            .solve_lower_triangular(&row)
            .map_or(f64::NAN, |solved| solved.norm_squared())
    }

    /// Returns the last diagonal entry of `(X'X)^-1`.
    pub fn last_variance(&self) -> f64 {
        let mut last = vec![0.0; self.rank()];
        last[self.rank() - 1] = 1.0;
        self.leverage(&last)
    }

    /// Fits the columns to one value for each condition.
    pub fn fit(&self, values: &[f64]) -> Fit {
        let values = DVector::from_column_slice(values);
        let projected = self.q.transpose() * &values;
        let residuals = &values - &self.q * &projected;
        let coefficients = self
            .r
            .solve_upper_triangular(&projected)
            .unwrap_or(projected);
        Fit {
            coefficients: coefficients.iter().copied().collect(),
            residuals: residuals.iter().copied().collect(),
        }
    }

    /// Computes the leave-one-out errors by condition, `e_c / (1 - h_c)`; `None` if the fit
    /// interpolates the condition, `h_c = 1`.
    pub fn left_out_errors(&self, values: &[f64]) -> Vec<Option<f64>> {
        let residuals = self.fit(values).residuals;
        let mut errors = Vec::with_capacity(residuals.len());
        for (residual, hat) in residuals.into_iter().zip(self.hat_values()) {
            errors.push(if 1.0 - hat > DEPENDENT {
                Some(residual / (1.0 - hat))
            } else {
                None
            });
        }
        errors
    }
}

/// Half-widths of the two bands about a scheduled `ln k` at an airspeed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandWidths {
    /// Half-width of the confidence band of the schedule itself.
    pub confidence: f64,
    /// Half-width of the band that is expected to contain a further condition.
    pub scatter: f64,
}

/// Bands of a schedule: `t(n - r) S' sqrt(h)` and `t(n - r) S' sqrt(1 + h)`, `S'^2 = max(S^2, B)`.
#[derive(Clone, Debug, PartialEq)]
pub struct ScheduleBand {
    design: Arc<Design>,
    /// `t(n - r) S'`.
    half: f64,
}

impl ScheduleBand {
    /// Computes the bands from the scatter about the fit with `design`, for a confidence level.
    pub fn of(design: &Arc<Design>, split: &VarianceDecomposition, level: f64) -> Self {
        let deviation = split.scatter.max(split.explained()).sqrt();
        Self {
            design: Arc::clone(design),
            half: student_quantile(level, split.freedom as f64) * deviation,
        }
    }

    /// Returns the half-widths of the bands at a design row.
    pub fn at(&self, row: &[f64]) -> BandWidths {
        let h = self.design.leverage(row);
        BandWidths {
            confidence: self.half * h.sqrt(),
            scatter: self.half * (1.0 + h).sqrt(),
        }
    }
}

/// Scatter about a fit, split into the parts expected from the bundles and the rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VarianceDecomposition {
    /// Degrees of freedom of the scatter, `f = n - r`.
    pub freedom: usize,
    /// Residual variance `S^2 = sum e^2 / f`.
    pub scatter: f64,
    /// `B_phys`, expected from the unknown trims.
    pub trim: f64,
    /// `B_id`, expected from the identification.
    pub identification: f64,
    /// Degrees of freedom of `B`; `None` if the bundles have no spread.
    pub degrees_of_freedom: Option<f64>,
}

impl VarianceDecomposition {
    /// Splits the scatter of the bars' values about the fit with `design`; `None` without degrees
    /// of freedom.
    pub fn of(design: &Design, bars: &[Bar]) -> Option<Self> {
        let freedom = design.freedom();
        if freedom == 0 || bars.len() != design.conditions() {
            return None;
        }
        let values: Vec<f64> = bars.iter().map(|bar| bar.value).collect();
        let f = freedom as f64;
        let mut trim: Vec<VarianceComponent> = Vec::new();
        let mut identification: Vec<VarianceComponent> = Vec::new();
        for (bar, hat) in bars.iter().zip(design.hat_values()) {
            let weight = (1.0 - hat) / f;
            trim.extend(bar.trim.map(|part| part.scaled(weight)));
            identification.extend(bar.identification.map(|part| part.scaled(weight)));
        }
        Some(Self {
            freedom,
            scatter: sum_of_squares(&design.fit(&values).residuals) / f,
            trim: trim.iter().map(|part| part.variance).sum(),
            identification: identification.iter().map(|part| part.variance).sum(),
            degrees_of_freedom: satterthwaite(trim.into_iter().chain(identification)),
        })
    }

    /// Returns `B = B_phys + B_id`.
    pub fn explained(&self) -> f64 {
        self.trim + self.identification
    }

    /// Returns `rest^2 = max(0, S^2 - B)`, the variance that neither bundle explains.
    pub fn unexplained(&self) -> f64 {
        (self.scatter - self.explained()).max(0.0)
    }

    /// Returns the shares of trim, identification and rest in `max(S^2, B)`; `None` without scatter
    /// and spread.
    pub fn shares(&self) -> Option<[f64; 3]> {
        let whole = self.scatter.max(self.explained());
        if whole > 0.0 {
            Some([self.trim, self.identification, self.unexplained()].map(|part| part / whole))
        } else {
            None
        }
    }

    /// Returns `sqrt(S^2 / B)`, the scatter as a multiple of the expected scatter; `None` without
    /// spread.
    pub fn ratio(&self) -> Option<f64> {
        self.degrees_of_freedom?;
        Some((self.scatter / self.explained()).sqrt())
    }

    /// Returns the probability that a scatter this large arises if the bundles explain it fully.
    pub fn p(&self) -> Option<f64> {
        fisher_upper(
            self.scatter / self.explained(),
            self.freedom as f64,
            self.degrees_of_freedom?,
        )
    }

    /// Returns the confidence interval of `rest`, the unexplained standard deviation.
    pub fn unexplained_interval(&self, level: f64) -> Option<[f64; 2]> {
        Some([
            self.unexplained_limit(0.5 * (1.0 + level))?,
            self.unexplained_limit(0.5 * (1.0 - level))?,
        ])
    }

    /// Returns `sqrt(max(0, f S^2 / chi^2_f(p) - B))`.
    fn unexplained_limit(&self, p: f64) -> Option<f64> {
        let f = self.freedom as f64;
        let quantile = chi_squared_quantile(p, f).filter(|quantile| *quantile > 0.0)?;
        let variance = f * self.scatter / quantile - self.explained();
        Some(variance.max(0.0).sqrt())
    }
}

fn sum_of_squares(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum()
}

/// A second variable's effect on a value, in addition to the schedule with airspeed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SecondVariableEffect {
    /// Change between the variable's lowest and highest value, `2 gamma`.
    pub effect: f64,
    /// Half-width of the confidence interval of `effect`, `2 t se`; smaller effects are not
    /// detectable.
    pub visible: f64,
    /// Probability that an effect this large arises without a true effect.
    pub p: f64,
    /// Rms leave-one-out error without the variable; `None` if no condition can be left out.
    pub left_out_without: Option<f64>,
    /// Rms leave-one-out error with the variable.
    pub left_out_with: Option<f64>,
}

/// Reason why a second variable's effect is unavailable.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SecondVariableError {
    /// A condition lacks the variable, or all values are equal.
    #[error("the conditions must have at least two different values")]
    NotVaried,
    /// The variable is a function of airspeed in these conditions.
    #[error("its effect cannot be separated from the effect of airspeed")]
    NotToldApart,
    /// The fit has too few degrees of freedom.
    #[error("there are too few conditions to separate its effect from the effect of airspeed")]
    TooFewConditions,
}

/// Scales values linearly to the range from -1 to 1; `None` if all are equal, or without values.
pub fn scaled(values: &[f64]) -> Option<Vec<f64>> {
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let greatest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let width = greatest - least;
    if width <= 0.0 || !width.is_finite() {
        return None;
    }
    let scaled = values
        .iter()
        .map(|value| (2.0 * value - least - greatest) / width)
        .collect();
    Some(scaled)
}

/// Designs without and with a second variable.
#[derive(Clone, Debug, PartialEq)]
pub struct SecondVariableDesign {
    without: Design,
    with: Design,
}

impl SecondVariableDesign {
    /// Appends the variable's value in each condition to `rows` as the last column.
    ///
    /// # Errors
    /// [`SecondVariableError`] if the effect cannot be estimated.
    pub fn of(rows: &[Vec<f64>], values: &[f64]) -> Result<Self, SecondVariableError> {
        let scaled = scaled(values).ok_or(SecondVariableError::NotVaried)?;
        let mut extended = rows.to_vec();
        for (row, value) in extended.iter_mut().zip(scaled) {
            row.push(value);
        }
        let without = Design::new(rows).ok_or(SecondVariableError::NotToldApart)?;
        if without.freedom() < 2 {
            return Err(SecondVariableError::TooFewConditions);
        }
        let with = Design::new(&extended).ok_or(SecondVariableError::NotToldApart)?;
        Ok(Self { without, with })
    }

    /// Estimates the effect on `values`, which has one value for each condition.
    pub fn effect(&self, values: &[f64], level: f64) -> SecondVariableEffect {
        let Self { without, with } = self;
        let fit = with.fit(values);
        let freedom = with.freedom() as f64;
        let variance = sum_of_squares(&fit.residuals) / freedom;
        let error = (variance * with.last_variance()).sqrt();
        let coefficient = fit.coefficients.last().copied().unwrap_or_default();
        // An exact fit without effect would give 0/0.
        let ratio = if coefficient == 0.0 {
            0.0
        } else {
            coefficient / error
        };
        // A condition that either of the two fits interpolates counts in neither error.
        let mut errors_without = Vec::new();
        let mut errors_with = Vec::new();
        let left_out = without
            .left_out_errors(values)
            .into_iter()
            .zip(with.left_out_errors(values));
        for errors in left_out {
            if let (Some(without), Some(with)) = errors {
                errors_without.push(without);
                errors_with.push(with);
            }
        }
        SecondVariableEffect {
            effect: 2.0 * coefficient,
            visible: 2.0 * student_quantile(level, freedom) * error,
            p: student_two_sided(ratio, freedom),
            left_out_without: rms(&errors_without),
            left_out_with: rms(&errors_with),
        }
    }
}

/// Returns the root mean square; `None` without values.
fn rms(values: &[f64]) -> Option<f64> {
    if values.is_empty() {
        return None;
    }
    Some((sum_of_squares(values) / values.len() as f64).sqrt())
}

/// Maximum ratio of the leave-one-out errors with and without a variable at which the variable
/// counts as needed.
const NOTABLE_RATIO: f64 = 0.9;

impl SecondVariableEffect {
    /// Decides whether the schedule needs the variable: the effect is significant after Holm's
    /// correction, and the rms leave-one-out error falls by 10 % or more.
    pub fn is_needed(&self, p_holm: f64, level: f64) -> bool {
        match (self.left_out_without, self.left_out_with) {
            (Some(without), Some(with)) => p_holm < 1.0 - level && with <= NOTABLE_RATIO * without,
            _ => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(places: &[f64]) -> Vec<Vec<f64>> {
        places.iter().map(|&place| vec![1.0, place]).collect()
    }

    #[test]
    fn hat_values_sum_to_the_column_count_and_predict_a_left_out_condition() {
        let places = [0.0, 1.0, 2.0, 4.0];
        let figures = [1.0, 1.5, 3.0, 3.5];
        let design = Design::new(&line(&places)).unwrap();
        assert!((design.hat_values().iter().sum::<f64>() - 2.0).abs() < 1e-14);
        let without_last = Design::new(&line(&places[..3]))
            .unwrap()
            .fit(&figures[..3])
            .coefficients;
        let predicted = without_last[0] + 4.0 * without_last[1];
        // The same small problem, solved in two ways: a few rounding errors.
        assert!((design.left_out_errors(&figures)[3].unwrap() - (3.5 - predicted)).abs() < 1e-13);
    }

    #[test]
    fn linearly_dependent_columns_are_no_design() {
        let rows: Vec<Vec<f64>> = [0.0, 1.0, 2.0, 3.0]
            .map(|x| vec![1.0, x, 2.0 - 3.0 * x])
            .to_vec();
        assert_eq!(Design::new(&rows), None);
        assert_eq!(Design::new(&line(&[1.0])), None);
        assert_eq!(Design::new(&[]), None);
    }

    #[test]
    fn an_interpolated_condition_has_no_leave_one_out_error() {
        let design = Design::new(&[vec![1.0, 0.0], vec![1.0, 0.0], vec![0.0, 1.0]]).unwrap();
        assert_eq!(design.left_out_errors(&[1.0, 2.0, 5.0])[2], None);
        assert!((design.left_out_errors(&[1.0, 2.0, 5.0])[1].unwrap() - 1.0).abs() < 1e-14);
    }
}
