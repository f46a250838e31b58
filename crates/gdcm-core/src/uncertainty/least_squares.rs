//! Least squares of a few conditions: what the scatter of one figure about them is made of (M13.5), the bands of a schedule of `ln k`
//! that they give (M13.6), and whether a second variable says something of the gains that airspeed does not (M13.7).

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use super::{
    Bar, VarianceComponent, chi_squared_quantile, fisher_upper, satterthwaite, student_quantile, student_two_sided,
};

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

/// The scatter of one figure about a fit, split into what the bundles make of it and the rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VarianceDecomposition {
    /// Degrees of freedom of the scatter, `f = n - r`.
    pub freedom: usize,
    /// `S^2 = sum e^2 / f`.
    pub scatter: f64,
    /// `B_phys`, expected from not knowing the trims.
    pub trim: f64,
    /// `B_id`, expected from the identification.
    pub identification: f64,
    /// Degrees of freedom of `B`; none where the bundles have no spread.
    pub degrees_of_freedom: Option<f64>,
}

impl VarianceDecomposition {
    /// The split of these conditions' figures about the fit of `design`; none where it leaves no degrees of freedom.
    pub fn of(design: &Design, bars: &[Bar]) -> Option<Self> {
        let freedom = design.freedom();
        if freedom == 0 || bars.len() != design.conditions() {
            return None;
        }
        let figures: Vec<f64> = bars.iter().map(|bar| bar.value).collect();
        let f = freedom as f64;
        let square: f64 = design.fit(&figures).residuals.iter().map(|residual| residual * residual).sum();
        let hats = design.hat_values();
        let expected = |part: fn(&Bar) -> Option<VarianceComponent>| -> Vec<VarianceComponent> {
            let of_bar = |(bar, hat): (&Bar, &f64)| Some(part(bar)?.scaled((1.0 - hat) / f));
            bars.iter().zip(&hats).filter_map(of_bar).collect()
        };
        let (trim, identification) = (expected(|bar| bar.trim), expected(|bar| bar.identification));
        let sum = |parts: &[VarianceComponent]| parts.iter().map(|part| part.variance).sum::<f64>();
        Some(Self {
            freedom,
            scatter: square / f,
            trim: sum(&trim),
            identification: sum(&identification),
            degrees_of_freedom: satterthwaite(trim.into_iter().chain(identification)),
        })
    }

    /// `B = B_phys + B_id`.
    pub fn explained(&self) -> f64 {
        self.trim + self.identification
    }

    /// `rest^2 = max(0, S^2 - B)`: what neither bundle makes.
    pub fn unexplained(&self) -> f64 {
        (self.scatter - self.explained()).max(0.0)
    }

    /// Shares of trim, identification and rest in `max(S^2, B)`; none where there is neither scatter nor spread.
    pub fn shares(&self) -> Option<[f64; 3]> {
        let whole = self.scatter.max(self.explained());
        (whole > 0.0).then(|| [self.trim, self.identification, self.unexplained()].map(|part| part / whole))
    }

    /// `sqrt(F)`, `F = S^2 / B`: multiple of what is expected; none where they have no spread.
    pub fn ratio(&self) -> Option<f64> {
        self.degrees_of_freedom.map(|_| (self.scatter / self.explained()).sqrt())
    }

    /// How likely so great a scatter is where the bundles explain all of it.
    pub fn p(&self) -> Option<f64> {
        fisher_upper(self.scatter / self.explained(), self.freedom as f64, self.degrees_of_freedom?)
    }

    /// Interval of the rest, as a standard deviation: `sqrt(max(0, f S^2 / chi^2_f(p) - B))` at `p = (1 +- level) / 2`.
    pub fn unexplained_interval(&self, level: f64) -> Option<[f64; 2]> {
        let f = self.freedom as f64;
        let end = |p: f64| {
            let quantile = chi_squared_quantile(p, f).filter(|quantile| *quantile > 0.0)?;
            Some((f * self.scatter / quantile - self.explained()).max(0.0).sqrt())
        };
        Some([end(0.5 * (1.0 + level))?, end(0.5 * (1.0 - level))?])
    }
}

/// The effect of a second variable on one figure, beside the schedule with airspeed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SecondVariableEffect {
    /// From the lowest to the highest value, `2 gamma`.
    pub effect: f64,
    /// Half-width `2 t se` of its interval: an effect smaller than that could not have been seen.
    pub visible: f64,
    /// How likely so great an effect is where there is none.
    pub p: f64,
    /// Leave-one-condition-out error, rms over the conditions, without the variable; none where no condition can be left out.
    pub left_out_without: Option<f64>,
    /// The same with it.
    pub left_out_with: Option<f64>,
}

/// Why there is no effect to tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SecondVariableError {
    /// A condition does not say it, or all say the same.
    #[error("the conditions do not carry two values of it")]
    NotVaried,
    /// It is a function of airspeed in these conditions.
    #[error("its effect and that of airspeed cannot be told apart")]
    NotToldApart,
    /// As many coefficients as conditions.
    #[error("there are too few conditions to see it beside the airspeed")]
    TooFewConditions,
}

/// The values scaled to -1 to 1; none where there are not two.
pub fn scaled(values: &[f64]) -> Option<Vec<f64>> {
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let greatest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let width = greatest - least;
    (width > 0.0 && width.is_finite())
        .then(|| values.iter().map(|value| (2.0 * value - least - greatest) / width).collect())
}

/// The columns of a schedule without and with a second variable.
#[derive(Clone, Debug, PartialEq)]
pub struct SecondVariableDesign {
    without: Design,
    with: Design,
}

impl SecondVariableDesign {
    /// `values`, one for each condition, beside the columns of `rows`.
    ///
    /// # Errors
    /// [`SecondVariableError`] where their effect cannot be told.
    pub fn of(rows: &[Vec<f64>], values: &[f64]) -> Result<Self, SecondVariableError> {
        let scaled = scaled(values).ok_or(SecondVariableError::NotVaried)?;
        let extended: Vec<Vec<f64>> =
            rows.iter().zip(scaled).map(|(row, value)| row.iter().copied().chain([value]).collect()).collect();
        let without = Design::new(rows).ok_or(SecondVariableError::NotToldApart)?;
        if without.freedom() < 2 {
            return Err(SecondVariableError::TooFewConditions);
        }
        let with = Design::new(&extended).ok_or(SecondVariableError::NotToldApart)?;
        Ok(Self { without, with })
    }

    /// The effect on these figures, one for each condition.
    pub fn effect(&self, figures: &[f64], level: f64) -> SecondVariableEffect {
        let Self { without, with } = self;
        let fit = with.fit(figures);
        let freedom = with.freedom() as f64;
        let variance = fit.residuals.iter().map(|residual| residual * residual).sum::<f64>() / freedom;
        let error = (variance * with.last_variance()).sqrt();
        let coefficient = fit.coefficients.last().copied().unwrap_or_default();
        // An exact fit leaves nothing that chance could have made.
        let ratio = if coefficient == 0.0 { 0.0 } else { coefficient / error };
        let errors = (without.left_out_errors(figures), with.left_out_errors(figures));
        let both: Vec<(f64, f64)> = errors.0.iter().zip(&errors.1).filter_map(|(a, b)| Some(((*a)?, (*b)?))).collect();
        let rms = |of: fn(&(f64, f64)) -> f64| {
            let square: f64 = both.iter().map(|pair| of(pair).powi(2)).sum();
            (!both.is_empty()).then(|| (square / both.len() as f64).sqrt())
        };
        SecondVariableEffect {
            effect: 2.0 * coefficient,
            visible: 2.0 * student_quantile(level, freedom) * error,
            p: student_two_sided(ratio, freedom),
            left_out_without: rms(|pair| pair.0),
            left_out_with: rms(|pair| pair.1),
        }
    }
}

impl SecondVariableEffect {
    /// Whether the schedule needs the variable: improbable by chance after Holm's correction, and it foresees a condition that
    /// is left out better by 10 % or more.
    pub fn is_needed(&self, p_holm: f64, level: f64) -> bool {
        /// What is left of the leave-one-condition-out error, at most.
        const LEFT: f64 = 0.9;
        let foresees = self.left_out_without.zip(self.left_out_with);
        p_holm < 1.0 - level && foresees.is_some_and(|(without, with)| with <= LEFT * without)
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
