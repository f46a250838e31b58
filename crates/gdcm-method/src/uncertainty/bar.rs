//! Error bar of one value (M13.3) with its settings and variance components, the significance of differences between two conditions
//! (M13.4), and quantiles of Student's, Fisher's and the chi-squared distribution.

use serde::{Deserialize, Serialize};
use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor, Normal, StudentsT};

use super::spread::Measurement;

/// Source of the identification part of a bar.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum IdentificationSource {
    /// The spread of the identified models, with that of the other conditions (M13.2).
    Spread,
    /// The coherence of the measured response, where its error is larger than the spread.
    Coherence,
    /// The confidence band of the identified model, where it is wider than the spread.
    ModelBand,
}

/// Uncertainty of one value: the natural logarithm of a gain, or a delay in s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bar {
    /// Value with both representatives, `q_0`.
    pub value: f64,
    /// Variance due to the unknown trim, `s_phys^2`; `None` where no other physics model is kept.
    pub trim: Option<VarianceComponent>,
    /// Variance due to the identification, `s_id^2`; `None` without a second identified model in any condition and without a
    /// reported error.
    pub identification: Option<VarianceComponent>,
    /// Source of the identification part.
    pub source: IdentificationSource,
    /// Number of substitutions in which the value does not exist.
    pub left_out: usize,
    /// Smallest and largest admissible value.
    pub range: [f64; 2],
}

impl Bar {
    /// Returns `u^2 = s_phys^2 + s_id^2`.
    pub fn variance(&self) -> f64 {
        self.parts().map(|part| part.variance).sum()
    }

    /// Returns the combined standard deviation `u`.
    pub fn deviation(&self) -> f64 {
        self.variance().sqrt()
    }

    /// Iterates over the known variance components.
    pub fn parts(&self) -> impl Iterator<Item = VarianceComponent> + use<> {
        [self.trim, self.identification].into_iter().flatten()
    }

    /// Returns the degrees of freedom of `u`; `None` where the bundles have no spread.
    pub fn degrees_of_freedom(&self) -> Option<f64> {
        satterthwaite(self.parts())
    }

    /// Returns the half-width `h = t(max(nu, 1)) u` of the whole bar; `None` without a known spread.
    pub fn half_width(&self, level: f64) -> Option<f64> {
        self.degrees_of_freedom()
            .map(|degrees| student_quantile(level, degrees) * self.deviation())
    }

    /// Returns the half-width `t(nu_id) s_id` of the inner bar, which holds for the chosen physics model.
    pub fn inner_half_width(&self, level: f64) -> Option<f64> {
        let part = self.identification.filter(|part| part.variance > 0.0)?;
        Some(student_quantile(level, part.degrees_of_freedom) * part.variance.sqrt())
    }

    /// Returns the interval of the whole bar, clamped to the admissible values.
    pub fn interval(&self, level: f64) -> Option<[f64; 2]> {
        self.half_width(level).map(|half| self.about(half))
    }

    /// Returns the interval of the inner bar, clamped to the admissible values.
    pub fn inner_interval(&self, level: f64) -> Option<[f64; 2]> {
        self.inner_half_width(level).map(|half| self.about(half))
    }

    fn about(&self, half: f64) -> [f64; 2] {
        let [least, greatest] = self.range;
        [
            (self.value - half).clamp(least, greatest),
            (self.value + half).clamp(least, greatest),
        ]
    }

    /// Returns the share of the trim in the variance, from 0 to 1; `None` without spread.
    pub fn trim_share(&self) -> Option<f64> {
        let variance = self.variance();
        (variance > 0.0).then(|| self.trim.map_or(0.0, |part| part.variance) / variance)
    }

    /// Describes missing parts, a missing spread, and a source other than the spread of the models.
    pub fn remarks(&self) -> Vec<&'static str> {
        let mut remarks = Vec::new();
        if self.trim.is_none() {
            remarks.push("trim not included");
        }
        if self.identification.is_none() {
            remarks.push("identification not included");
        }
        if self.parts().next().is_some() && self.variance() == 0.0 {
            remarks.push("the bundle has no spread");
        }
        match self.source {
            IdentificationSource::Spread => {}
            IdentificationSource::Coherence => remarks.push("identification from the coherence"),
            IdentificationSource::ModelBand => {
                remarks.push("identification from the model's own band")
            }
        }
        remarks
    }
}

/// A variance with its degrees of freedom: of the natural logarithm of a gain, or of a delay in s^2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VarianceComponent {
    /// The mean square.
    pub variance: f64,
    /// Degrees of freedom, at least 1; infinite for a variance taken as known.
    pub degrees_of_freedom: f64,
}

/// Changes up to this size, in natural logarithms or s, are rounding errors of the solver and count as zero.
const ROUNDING: f64 = 1e-9;

impl VarianceComponent {
    /// Computes the mean square of the changes from the representative's value (M13.1); `None` without changes.
    ///
    /// Not a variance about the mean, and never divided by the number of models: a further model does not make the trim flown
    /// better known, and identified models share records. For independent identified models this is about twice the variance
    /// of their errors. The surplus keeps the level of the bars while up to half of the error variance is common to all models
    /// (measured in `docs/uncertainty.md`).
    pub fn of_changes(changes: &[f64]) -> Option<Self> {
        let degrees = changes.len() as f64;
        let beyond_rounding = changes.iter().filter(|change| change.abs() > ROUNDING);
        let square: f64 = beyond_rounding.map(|change| change * change).sum();
        (!changes.is_empty()).then(|| Self {
            variance: square / degrees,
            degrees_of_freedom: degrees,
        })
    }

    /// Multiplies the variance and keeps the degrees of freedom.
    pub fn scaled(self, factor: f64) -> Self {
        Self {
            variance: factor * self.variance,
            ..self
        }
    }
}

/// Computes the degrees of freedom `u^4 / sum(s^4 / nu)` of a sum of variances; `None` where all are zero.
///
/// F. E. Satterthwaite, "An approximate distribution of estimates of variance components", Biometrics Bulletin 2 (1946).
pub fn satterthwaite(parts: impl IntoIterator<Item = VarianceComponent>) -> Option<f64> {
    let parts: Vec<VarianceComponent> = parts
        .into_iter()
        .filter(|part| part.variance > 0.0)
        .collect();
    // Relative to the largest, because squares of small variances underflow.
    let greatest = parts.iter().map(|part| part.variance).fold(0.0, f64::max);
    let mut sum = 0.0;
    let mut spread = 0.0;
    for part in &parts {
        let share = part.variance / greatest;
        sum += share;
        spread += share * share / part.degrees_of_freedom;
    }
    (!parts.is_empty()).then(|| sum * sum / spread)
}

/// Computes the pooled identification part of every condition (M13.2): `(n s_own^2 + d_0 s_pooled^2) / (n + d_0)` with
/// `d_0 = min(prior, sum of the others' n)`. `None` where no condition has two identified models.
///
/// `own` holds the mean square of each condition. A condition with one identified model has `None` and takes the pooled variance.
pub fn pooled(
    own: &[Option<VarianceComponent>],
    prior_degrees: f64,
) -> Vec<Option<VarianceComponent>> {
    let count: f64 = own
        .iter()
        .flatten()
        .map(|part| part.degrees_of_freedom)
        .sum();
    let square: f64 = own
        .iter()
        .flatten()
        .map(|part| part.degrees_of_freedom * part.variance)
        .sum();
    let of_condition = |own: &Option<VarianceComponent>| {
        let (n, variance) = own.map_or((0.0, 0.0), |own| (own.degrees_of_freedom, own.variance));
        let borrowed = prior_degrees.min(count - n);
        let degrees = n + borrowed;
        // Without borrowing, a condition with one model has no estimate.
        (count > 0.0 && degrees > 0.0).then(|| VarianceComponent {
            variance: (n * variance + borrowed * square / count) / degrees,
            degrees_of_freedom: degrees,
        })
    };
    own.iter().map(of_condition).collect()
}

/// Settings of the error bars; no gain and no delay depends on them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct UncertaintySettings {
    /// Confidence level `L` of every bar, interval and test.
    pub level: f64,
    /// Largest number of degrees of freedom that a condition's identification part borrows from the other conditions; 0 uses
    /// the condition alone.
    pub prior_degrees: f64,
    /// Number of independent averages of measured responses whose files do not give it; without it their coherence is not used.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub averages: Option<f64>,
    /// Window length in s of measured responses whose files do not give it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub window_s: Option<f64>,
    /// Whether those windows overlap by half: `C_epsilon` is then `sqrt(0.55)` instead of 1.
    #[serde(default)]
    pub half_overlap: bool,
}

impl Default for UncertaintySettings {
    fn default() -> Self {
        Self {
            level: 0.9,
            prior_degrees: 4.0,
            averages: None,
            window_s: None,
            half_overlap: false,
        }
    }
}

impl UncertaintySettings {
    /// Combines the data of a measured response with these defaults; `None` without a number of averages.
    pub fn measurement(&self, averages: Option<f64>, window_s: Option<f64>) -> Option<Measurement> {
        let averages = averages
            .or(self.averages)
            .filter(|averages| *averages > 0.0)?;
        let window_s = window_s
            .or(self.window_s)
            .filter(|window_s| *window_s > 0.0);
        let factor = if self.half_overlap {
            0.55_f64.sqrt()
        } else {
            1.0
        };
        Some(Measurement {
            averages,
            window_s,
            factor,
        })
    }
}

/// Difference of one value between two conditions, with the standard deviation expected from both bars.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// `delta = q_c - q_c'`.
    pub delta: f64,
    /// Expected standard deviation `u_delta`, from the parts of both bars.
    pub deviation: f64,
    /// Degrees of freedom; `None` where neither condition has a spread.
    pub degrees_of_freedom: Option<f64>,
}

impl Difference {
    /// Computes the difference of the values of two bars.
    pub fn of(first: &Bar, second: &Bar) -> Self {
        let deviation = (first.variance() + second.variance()).sqrt();
        Self {
            delta: first.value - second.value,
            deviation,
            degrees_of_freedom: satterthwaite(first.parts().chain(second.parts())),
        }
    }

    /// Returns `|delta| / u_delta`, the multiple of the expected difference; `None` without spread.
    pub fn ratio(&self) -> Option<f64> {
        self.degrees_of_freedom
            .map(|_| self.delta.abs() / self.deviation)
    }

    /// Returns the probability of a ratio this large without a true difference.
    pub fn p(&self) -> Option<f64> {
        Some(student_two_sided(self.ratio()?, self.degrees_of_freedom?))
    }
}

/// Applies Holm's correction for multiple tests; the result is in the order of the argument.
///
/// S. Holm, "A simple sequentially rejective multiple test procedure", Scandinavian Journal of Statistics 6 (1979).
pub fn holm(probabilities: &[f64]) -> Vec<f64> {
    let mut rising: Vec<usize> = (0..probabilities.len()).collect();
    rising.sort_by(|&a, &b| probabilities[a].total_cmp(&probabilities[b]));
    let mut corrected = vec![0.0; probabilities.len()];
    let mut most = 0.0_f64;
    for (rank, place) in rising.into_iter().enumerate() {
        most = most
            .max((probabilities.len() - rank) as f64 * probabilities[place])
            .min(1.0);
        corrected[place] = most;
    }
    corrected
}

/// Degrees of freedom above which the normal distribution replaces Student's: they differ by 2e-8 there.
const NORMAL_FROM: f64 = 1e8;

/// Degrees of freedom above which Student's quantile is expanded about the normal one. Four terms have an error of 1e-12 there, and
/// the inverse of the incomplete beta function does not converge for some larger values.
const EXPANDED_FROM: f64 = 1e3;

/// Computes Student's quantile `t(nu)` at `(1 + level) / 2` for any real `nu`, at least 1; the normal quantile for infinite `nu`.
///
/// Above a thousand degrees by M. Abramowitz, I. A. Stegun, "Handbook of Mathematical Functions", 26.7.5.
pub fn student_quantile(level: f64, degrees: f64) -> f64 {
    let p = 0.5 * (1.0 + level);
    match StudentsT::new(0.0, 1.0, degrees.max(1.0)) {
        Ok(student) if degrees < EXPANDED_FROM => student.inverse_cdf(p),
        _ => expanded(Normal::standard().inverse_cdf(p), degrees),
    }
}

fn expanded(z: f64, degrees: f64) -> f64 {
    let square = z * z;
    let terms = [
        (square + 1.0) / 4.0,
        ((5.0 * square + 16.0) * square + 3.0) / 96.0,
        (((3.0 * square + 19.0) * square + 17.0) * square - 15.0) / 384.0,
        ((((79.0 * square + 776.0) * square + 1482.0) * square - 1920.0) * square - 945.0)
            / 92160.0,
    ];
    z * terms
        .iter()
        .rev()
        .fold(0.0, |sum, term| (sum + term) / degrees)
        + z
}

/// Computes the two-sided probability `2 (1 - T_nu(|ratio|))` of Student's distribution.
pub fn student_two_sided(ratio: f64, degrees: f64) -> f64 {
    match StudentsT::new(0.0, 1.0, degrees.max(1.0)) {
        Ok(student) if degrees < NORMAL_FROM => 2.0 * student.sf(ratio.abs()),
        _ => 2.0 * Normal::standard().sf(ratio.abs()),
    }
}

/// Computes the upper tail `1 - F_(above, below)(ratio)` of Fisher's distribution, for the ratio of two equal variances.
pub fn fisher_upper(ratio: f64, above: f64, below: f64) -> Option<f64> {
    Some(FisherSnedecor::new(above, below).ok()?.sf(ratio))
}

/// Computes the chi-squared quantile at `p`.
pub fn chi_squared_quantile(p: f64, degrees: f64) -> Option<f64> {
    Some(ChiSquared::new(degrees).ok()?.inverse_cdf(p))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bar(trim: f64, identification: f64) -> Bar {
        Bar {
            value: 0.1,
            trim: Some(VarianceComponent {
                variance: trim * trim,
                degrees_of_freedom: 4.0,
            }),
            identification: Some(VarianceComponent {
                variance: identification * identification,
                degrees_of_freedom: 5.0,
            }),
            source: IdentificationSource::Spread,
            left_out: 0,
            range: [f64::NEG_INFINITY, f64::INFINITY],
        }
    }

    /// Case A of the reference, condition 1 (independent numpy code).
    #[test]
    fn a_bar_is_student_s_quantile_of_both_parts() {
        let bar = bar(0.0316227766017, 0.0206881608656);
        let near = |found: f64, expected: f64| {
            assert!((found - expected).abs() < 1e-9, "{found} {expected}")
        };
        near(bar.deviation(), 0.0377888872554);
        near(bar.degrees_of_freedom().unwrap(), 7.11417375578);
        near(bar.half_width(0.9).unwrap(), 0.071421529124);
        near(bar.trim_share().unwrap(), 0.001 / 0.001428);
        assert_eq!(bar.remarks(), Vec::<&str>::new());
    }

    #[test]
    fn identical_models_have_no_bar_and_one_model_says_what_is_missing() {
        let none = bar(0.0, 0.0);
        assert_eq!(
            (none.half_width(0.9), none.remarks()),
            (None, vec!["the bundle has no spread"])
        );
        let alone = Bar {
            trim: None,
            identification: None,
            ..none
        };
        assert_eq!(
            alone.remarks(),
            ["trim not included", "identification not included"]
        );
        assert_eq!(alone.interval(0.9), None);
    }

    #[test]
    fn a_delay_s_bar_ends_at_its_bounds() {
        let cut = Bar {
            value: 0.0,
            range: [0.0, 0.01],
            ..bar(0.03, 0.02)
        };
        assert_eq!(cut.interval(0.9), Some([0.0, 0.01]));
    }

    fn own(variances: &[f64], counts: &[f64]) -> Vec<Option<VarianceComponent>> {
        let part = |(&variance, &degrees): (&f64, &f64)| {
            (degrees > 0.0).then_some(VarianceComponent {
                variance,
                degrees_of_freedom: degrees,
            })
        };
        variances.iter().zip(counts).map(part).collect()
    }

    /// Case E of the reference (independent numpy code).
    #[test]
    fn few_identified_models_borrow_from_the_other_conditions() {
        let five = pooled(
            &own(
                &[0.0009, 0.0001, 0.0, 0.0004, 0.0025],
                &[2.0, 2.0, 0.0, 1.0, 3.0],
            ),
            4.0,
        );
        let expected = [
            (0.001125, 6.0),
            (0.000858333333333, 6.0),
            (0.0012375, 4.0),
            (0.00107, 5.0),
            (0.00177857142857, 7.0),
        ];
        for (part, (variance, degrees)) in five.iter().zip(expected) {
            let part = part.unwrap();
            // The reference has twelve digits.
            assert!(
                (part.variance - variance).abs() < 1e-14 && part.degrees_of_freedom == degrees,
                "{part:?}"
            );
        }
        let two = pooled(&own(&[0.0009, 0.0], &[2.0, 0.0]), 4.0);
        assert_eq!(
            two,
            vec![
                Some(VarianceComponent {
                    variance: 0.0009,
                    degrees_of_freedom: 2.0
                });
                2
            ]
        );
    }

    #[test]
    fn without_two_identified_models_anywhere_there_is_no_identification_part() {
        assert_eq!(pooled(&[None, None], 4.0), [None, None]);
    }

    #[test]
    fn a_prior_of_nothing_trusts_the_condition_alone() {
        let alone = pooled(&own(&[0.0009, 0.0001, 0.0], &[2.0, 2.0, 0.0]), 0.0);
        assert_eq!(
            alone[1],
            Some(VarianceComponent {
                variance: 0.0001,
                degrees_of_freedom: 2.0
            })
        );
        assert_eq!(alone[2], None, "one model says nothing by itself");
    }

    #[test]
    fn parts_of_nothing_have_no_degrees() {
        assert_eq!(
            satterthwaite(
                [VarianceComponent {
                    variance: 0.0,
                    degrees_of_freedom: 4.0
                }; 2]
            ),
            None
        );
        let only = satterthwaite([
            VarianceComponent {
                variance: 0.0,
                degrees_of_freedom: 4.0,
            },
            VarianceComponent {
                variance: 1e-200,
                degrees_of_freedom: 5.0,
            },
        ]);
        assert!((only.unwrap() - 5.0).abs() < 1e-12);
    }

    #[test]
    fn holm_multiplies_the_least_by_all_and_never_falls() {
        assert_eq!(holm(&[0.03, 0.01, 0.04, 0.5]), [0.09, 0.04, 0.09, 0.5]);
        assert_eq!(holm(&[0.6, 0.7]), [1.0, 1.0]);
        assert_eq!(holm(&[]), Vec::<f64>::new());
    }

    /// Quantiles by SciPy (independent numpy code).
    #[test]
    fn quantiles_are_those_of_the_tables() {
        let t_95 = [
            (1.0, 6.31375151468),
            (1.7, 3.30361514324),
            (2.0, 2.91998558035),
            (3.4, 2.24467111039),
            (6.0, 1.94318028052),
            (12.3, 1.77867254624),
            (24.0, 1.71088207991),
            (48.6, 1.67681682504),
            (999.0, 1.64638034543),
            (1000.0, 1.64637881729),
            (2.5e5, 1.64485972205),
            (1.8e7, 1.64485371161),
            (f64::INFINITY, 1.64485362695),
            (1e12, 1.64485362695),
        ];
        for (degrees, expected) in t_95 {
            // The reference has twelve digits.
            assert!(
                (student_quantile(0.9, degrees) - expected).abs() < 1e-9,
                "t of {degrees}"
            );
        }
        assert_eq!(
            student_quantile(0.9, 0.3),
            student_quantile(0.9, 1.0),
            "never fewer than one degree"
        );
        for (ratio, degrees, expected) in [
            (2.1, 6.0, 0.0804776876047),
            (5.4, 26.3, 1.13128376312e-05),
            (-0.4, 3.2, 0.714374785591),
        ] {
            assert!(
                (student_two_sided(ratio, degrees) / expected - 1.0).abs() < 1e-9,
                "p of {ratio}"
            );
        }
        for (ratio, above, below, expected) in [
            (2.31, 6.0, 72.5, 0.0426460967923),
            (0.9, 8.0, 100.0, 0.51965499353),
            (7.4, 6.0, 40.2, 2.2368214366e-05),
        ] {
            assert!(
                (fisher_upper(ratio, above, below).unwrap() / expected - 1.0).abs() < 1e-8,
                "F of {ratio}"
            );
        }
        for (p, degrees, expected) in [
            (0.05, 1.0, 0.00393214000002),
            (0.05, 2.0, 0.102586588775),
            (0.05, 6.0, 1.63538289433),
            (0.05, 8.0, 2.7326367935),
            (0.95, 1.0, 3.84145882069),
            (0.95, 2.0, 5.99146454711),
            (0.95, 6.0, 12.5915872437),
            (0.95, 8.0, 15.5073130559),
        ] {
            assert!(
                (chi_squared_quantile(p, degrees).unwrap() / expected - 1.0).abs() < 1e-8,
                "chi of {p}, {degrees}"
            );
        }
    }
}
