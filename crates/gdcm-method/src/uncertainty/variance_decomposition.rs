//! Splits the scatter about a schedule into the parts that the bundles explain, and the unexplained
//! part (M13.5).
//!
//! ```text
//! S^2    <- sum e_c^2 / f                    scatter: residual variance, f = n - r
//! B_phys <- sum (1 - h_c) s_phys,c^2 / f     explained by the trim
//! B_id   <- sum (1 - h_c) s_id,c^2 / f       explained by the identification
//! B      <- B_phys + B_id
//! unexplained^2 <- max(0, S^2 - B)
//! ```
//!
//! The *bundles* are the conditions' physics models, whose spread shows the effect of the unknown
//! trim, and their identified models. `n` is the count of conditions, `r` that of fitted
//! coefficients. `e_c` and `h_c` are condition c's residual and hat value (`design`); `s_phys,c`
//! and `s_id,c` are the parts in its error bar (`bar`). If the bundles explain the scatter fully,
//! `S^2 / B` has Fisher's distribution.

use super::bar::Bar;
use super::design::{Design, sum_of_squares};
use super::distributions::{chi_squared_quantile, fisher_upper};
use super::variance_component::{VarianceComponent, satterthwaite};

/// Scatter about a fit, split into the parts that the bundles explain and the unexplained part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VarianceDecomposition {
    /// Degrees of freedom of the scatter, `f = n - r`.
    pub freedom: usize,
    /// Residual variance `S^2 = sum e^2 / f`.
    pub scatter: f64,
    /// `B_phys`, explained by the unknown trims.
    pub trim: f64,
    /// `B_id`, explained by the identification.
    pub identification: f64,
    /// Degrees of freedom of `B`; `None` if the bundles have no spread.
    pub degrees_of_freedom: Option<f64>,
}

impl VarianceDecomposition {
    /// Splits the scatter of the bars' values about the fit with `design`; `None` without degrees
    /// of freedom, or if there is not one bar for each condition.
    pub fn new(design: &Design, bars: &[Bar]) -> Option<Self> {
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

    /// Returns `max(0, S^2 - B)`, the variance that neither bundle explains.
    pub fn unexplained(&self) -> f64 {
        (self.scatter - self.explained()).max(0.0)
    }

    /// Returns the shares of trim, identification and unexplained part in `max(S^2, B)`; `None`
    /// without scatter and spread.
    pub fn shares(&self) -> Option<[f64; 3]> {
        let whole = self.scatter.max(self.explained());
        if whole > 0.0 {
            Some([self.trim, self.identification, self.unexplained()].map(|part| part / whole))
        } else {
            None
        }
    }

    /// Returns `sqrt(S^2 / B)`, the scatter over the explained scatter; `None` without spread.
    pub fn ratio(&self) -> Option<f64> {
        self.degrees_of_freedom?;
        Some((self.scatter / self.explained()).sqrt())
    }

    /// Returns the probability that a scatter this large arises if the bundles explain it fully;
    /// `None` without spread.
    pub fn p(&self) -> Option<f64> {
        fisher_upper(
            self.scatter / self.explained(),
            self.freedom as f64,
            self.degrees_of_freedom?,
        )
    }

    /// Returns the confidence interval for the unexplained standard deviation.
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
