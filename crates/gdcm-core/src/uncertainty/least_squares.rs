//! Least squares of a few conditions, and the bands of a schedule of `ln k` that they give (M13.6).

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use super::{VarianceDecomposition, student_quantile};

/// A column of which less than this is left beside the others is a combination of them.
const DEPENDENT: f64 = 1e-9;

/// Columns of a design at most: a table over more airspeeds has neither a split nor bands.
pub const MOST_COLUMNS: usize = 200;

/// A design matrix `X` of full column rank, n conditions by r columns, as `Q R`.
#[derive(Clone, Debug, PartialEq)]
pub struct Design {
    q: DMatrix<f64>,
    r: DMatrix<f64>,
}

/// What least squares leave of one figure of each condition.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// Coefficient of each column.
    pub coefficients: Vec<f64>,
    /// Residual of each condition.
    pub residuals: Vec<f64>,
}

impl Design {
    /// The design with these rows, one for each condition; none where a column is a combination of the others, where there are
    /// fewer rows than columns, or none, or more than [`MOST_COLUMNS`].
    pub fn new(rows: &[Vec<f64>]) -> Option<Self> {
        let columns = rows.first()?.len();
        if rows.len() < columns || columns == 0 || columns > MOST_COLUMNS {
            return None;
        }
        let matrix = DMatrix::from_fn(rows.len(), columns, |row, column| rows[row][column]);
        let lengths: Vec<f64> = matrix.column_iter().map(|column| column.norm()).collect();
        let qr = matrix.qr();
        let (q, r) = (qr.q(), qr.r());
        let depends = (0..columns).any(|column| r[(column, column)].abs() <= DEPENDENT * lengths[column]);
        (!depends).then_some(Self { q, r })
    }

    /// Number of conditions, n.
    pub fn conditions(&self) -> usize {
        self.q.nrows()
    }

    /// Number of columns, r.
    pub fn rank(&self) -> usize {
        self.q.ncols()
    }

    /// Degrees of freedom of the residuals, `f = n - r`.
    pub fn freedom(&self) -> usize {
        self.conditions() - self.rank()
    }

    /// Hat value `h_c` of each condition: how much of its own figure the fit follows.
    pub fn hat_values(&self) -> Vec<f64> {
        (0..self.conditions()).map(|row| self.q.row(row).norm_squared().min(1.0)).collect()
    }

    /// `x' (X'X)^-1 x` of a row that need not be one of the conditions'.
    pub fn leverage(&self, row: &[f64]) -> f64 {
        let row = DVector::from_column_slice(row);
        self.r.transpose().solve_lower_triangular(&row).map_or(f64::NAN, |solved| solved.norm_squared())
    }

    /// `[(X'X)^-1]` of the last column.
    pub fn last_variance(&self) -> f64 {
        let mut last = vec![0.0; self.rank()];
        last[self.rank() - 1] = 1.0;
        self.leverage(&last)
    }

    /// The fit to one figure of each condition.
    pub fn fit(&self, figures: &[f64]) -> Fit {
        let figures = DVector::from_column_slice(figures);
        let projected = self.q.transpose() * &figures;
        let residuals = &figures - &self.q * &projected;
        let coefficients = self.r.solve_upper_triangular(&projected).unwrap_or(projected);
        Fit { coefficients: coefficients.iter().copied().collect(), residuals: residuals.iter().copied().collect() }
    }

    /// Leave-one-condition-out error `e_c / (1 - h_c)` of each condition; none where the fit goes through it whatever it is.
    pub fn left_out_errors(&self, figures: &[f64]) -> Vec<Option<f64>> {
        let residuals = self.fit(figures).residuals;
        let hats = self.hat_values();
        let error = |(residual, hat): (f64, f64)| (1.0 - hat > DEPENDENT).then(|| residual / (1.0 - hat));
        residuals.into_iter().zip(hats).map(error).collect()
    }
}

/// Half-widths of the two bands about a scheduled `ln k` at one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandWidths {
    /// Of the schedule itself.
    pub confidence: f64,
    /// Of another condition's figure.
    pub scatter: f64,
}

/// The bands of one figure's schedule: `t(n - r) S' sqrt(h)` and `t(n - r) S' sqrt(1 + h)`, `S'^2 = max(S^2, B)`.
#[derive(Clone, Debug, PartialEq)]
pub struct ScheduleBand {
    design: Arc<Design>,
    /// `t(n - r) S'`.
    half: f64,
}

impl ScheduleBand {
    /// The bands about the fit whose scatter is split so.
    pub fn of(design: &Arc<Design>, split: &VarianceDecomposition, level: f64) -> Self {
        let deviation = split.scatter.max(split.explained()).sqrt();
        Self { design: Arc::clone(design), half: student_quantile(level, split.freedom as f64) * deviation }
    }

    /// The half-widths at the place that has this row of the design.
    pub fn at(&self, row: &[f64]) -> BandWidths {
        let h = self.design.leverage(row);
        BandWidths { confidence: self.half * h.sqrt(), scatter: self.half * (1.0 + h).sqrt() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(places: &[f64]) -> Vec<Vec<f64>> {
        places.iter().map(|&place| vec![1.0, place]).collect()
    }

    #[test]
    fn hat_values_sum_to_the_number_of_columns_and_foresee_the_condition_left_out() {
        let (places, figures) = ([0.0, 1.0, 2.0, 4.0], [1.0, 1.5, 3.0, 3.5]);
        let design = Design::new(&line(&places)).unwrap();
        assert!((design.hat_values().iter().sum::<f64>() - 2.0).abs() < 1e-14);
        let without_last = Design::new(&line(&places[..3])).unwrap().fit(&figures[..3]).coefficients;
        let foreseen = without_last[0] + 4.0 * without_last[1];
        // Two solutions of the same small problem.
        assert!((design.left_out_errors(&figures)[3].unwrap() - (3.5 - foreseen)).abs() < 1e-13);
    }

    #[test]
    fn a_column_that_is_a_combination_of_the_others_is_no_design() {
        let rows: Vec<Vec<f64>> = [0.0, 1.0, 2.0, 3.0].map(|x| vec![1.0, x, 2.0 - 3.0 * x]).to_vec();
        assert_eq!(Design::new(&rows), None);
        assert_eq!(Design::new(&line(&[1.0])), None);
        assert_eq!(Design::new(&[]), None);
    }

    #[test]
    fn a_condition_that_the_fit_must_follow_has_no_error() {
        let design = Design::new(&[vec![1.0, 0.0], vec![1.0, 0.0], vec![0.0, 1.0]]).unwrap();
        assert_eq!(design.left_out_errors(&[1.0, 2.0, 5.0])[2], None);
        assert!((design.left_out_errors(&[1.0, 2.0, 5.0])[1].unwrap() - 1.0).abs() < 1e-14);
    }
}
