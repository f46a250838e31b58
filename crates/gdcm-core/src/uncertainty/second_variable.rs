//! Whether a second variable says something of the gains that airspeed does not (M13.7).

use super::{Design, student_quantile, student_two_sided};

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
