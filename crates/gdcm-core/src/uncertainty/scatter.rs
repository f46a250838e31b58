//! What the scatter of one figure over the conditions is made of (M13.5).

use super::{Bar, Design, VarianceComponent, chi_squared_quantile, fisher_upper, satterthwaite};

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
