//! Error bar for a value (M13.3).
//!
//! ```text
//! whole bar: q_0 +- t(nu) u,   u^2 = s_phys^2 + s_id^2,   nu by Satterthwaite's formula
//! inner bar: q_0 +- t(nu_id) s_id
//! ```
//!
//! A *representative* is the model that stands for a condition's physics or identified models.
//! `q_0` is the value with both representatives. `s_phys` and `s_id` are the standard deviations
//! due to the unknown trim and the identification, the bar's *parts*; they are found by
//! *substitution*: another accepted model takes the place of a representative. `nu_id` are the
//! degrees of freedom of `s_id`, and `t` is Student's quantile at the confidence level.
//!
//! A bar has *no spread* if no part has a positive variance, because a part is missing or all
//! models give the same value; it then has no width.

use super::distributions::student_quantile;
use super::variance_component::{VarianceComponent, satterthwaite};

/// Source of a bar's identification part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum IdentificationSource {
    /// Spread among the identified models, pooled with the other conditions (M13.2).
    Spread,
    /// The measured response's coherence; the resulting standard error replaces a smaller or
    /// missing spread.
    Coherence,
    /// The standard deviations that the identified model carries over frequency, which replace a
    /// smaller or missing spread.
    ModelBand,
}

/// A value with its uncertainty: a gain's natural logarithm, or a delay \[s\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bar {
    /// Value with both representatives, `q_0`.
    pub value: f64,
    /// Variance due to the unknown trim, `s_phys^2`; `None` if no other accepted physics model
    /// yields a value.
    pub trim: Option<VarianceComponent>,
    /// Variance from the identification, `s_id^2`; `None` if there is neither a spread, own or
    /// borrowed from other conditions, nor a standard error from coherence or from the model.
    pub identification: Option<VarianceComponent>,
    pub source: IdentificationSource,
    /// Count of substitutions for which the value does not exist.
    pub left_out: usize,
    /// Minimum and maximum admissible value.
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

    /// Iterates over the variances of the available parts.
    pub fn parts(&self) -> impl Iterator<Item = VarianceComponent> + use<> {
        [self.trim, self.identification].into_iter().flatten()
    }

    /// Returns the degrees of freedom of `u`; `None` without spread.
    pub fn degrees_of_freedom(&self) -> Option<f64> {
        satterthwaite(self.parts())
    }

    /// Returns the whole bar's half-width, `h = t(max(nu, 1)) u`; `None` without spread.
    pub fn half_width(&self, level: f64) -> Option<f64> {
        let degrees = self.degrees_of_freedom()?;
        Some(student_quantile(level, degrees) * self.deviation())
    }

    /// Returns the inner bar's half-width, `t(nu_id) s_id`, the uncertainty for a fixed physics
    /// model; `None` if the identification part is missing or zero.
    pub fn inner_half_width(&self, level: f64) -> Option<f64> {
        let part = self.identification.filter(|part| part.variance > 0.0)?;
        Some(student_quantile(level, part.degrees_of_freedom) * part.variance.sqrt())
    }

    /// Returns the whole bar's interval, clamped to the admissible values; `None` without spread.
    pub fn interval(&self, level: f64) -> Option<[f64; 2]> {
        Some(self.clamped_interval(self.half_width(level)?))
    }

    /// Returns the inner bar's interval, clamped to the admissible values; `None` if the
    /// identification part is missing or zero.
    pub fn inner_interval(&self, level: f64) -> Option<[f64; 2]> {
        Some(self.clamped_interval(self.inner_half_width(level)?))
    }

    fn clamped_interval(&self, half_width: f64) -> [f64; 2] {
        let [least, greatest] = self.range;
        [
            (self.value - half_width).clamp(least, greatest),
            (self.value + half_width).clamp(least, greatest),
        ]
    }

    /// Returns the trim's share of the variance, from 0 to 1; `None` without spread.
    pub fn trim_share(&self) -> Option<f64> {
        let variance = self.variance();
        if variance > 0.0 {
            let trim = self.trim.map_or(0.0, |part| part.variance);
            Some(trim / variance)
        } else {
            None
        }
    }

    /// Returns remarks on missing parts, a missing spread, and a source other than the models'
    /// spread.
    pub fn remarks(&self) -> Vec<BarRemark> {
        let mut remarks = Vec::new();
        if self.trim.is_none() {
            remarks.push(BarRemark::NoTrim);
        }
        if self.identification.is_none() {
            remarks.push(BarRemark::NoIdentification);
        }
        if self.parts().next().is_some() && self.variance() == 0.0 {
            remarks.push(BarRemark::NoSpread);
        }
        match self.source {
            IdentificationSource::Spread => {}
            IdentificationSource::Coherence => remarks.push(BarRemark::FromCoherence),
            IdentificationSource::ModelBand => remarks.push(BarRemark::FromModelBand),
        }
        remarks
    }
}

/// Remark on an error bar.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BarRemark {
    /// The trim's uncertainty is not included.
    NoTrim,
    /// The identification's uncertainty is not included.
    NoIdentification,
    /// All available models give the same value.
    NoSpread,
    /// The identification part is computed from the coherence.
    FromCoherence,
    /// The identification part is computed from the identified model's standard deviations.
    FromModelBand,
}

impl BarRemark {
    /// Returns the stable code, for programs and tests.
    pub fn code(self) -> &'static str {
        match self {
            Self::NoTrim => "no-trim",
            Self::NoIdentification => "no-identification",
            Self::NoSpread => "no-spread",
            Self::FromCoherence => "from-coherence",
            Self::FromModelBand => "from-model-band",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bar(trim_deviation: f64, identification_deviation: f64) -> Bar {
        Bar {
            value: 0.1,
            trim: Some(VarianceComponent {
                variance: trim_deviation * trim_deviation,
                degrees_of_freedom: 4.0,
            }),
            identification: Some(VarianceComponent {
                variance: identification_deviation * identification_deviation,
                degrees_of_freedom: 5.0,
            }),
            source: IdentificationSource::Spread,
            left_out: 0,
            range: [f64::NEG_INFINITY, f64::INFINITY],
        }
    }

    /// Reference results from independent numpy code: case A, condition 1.
    #[test]
    fn a_bar_combines_both_parts_with_student_s_quantile() {
        let bar = bar(0.0316227766017, 0.0206881608656);
        for (found, expected) in [
            (bar.deviation(), 0.0377888872554),
            (bar.degrees_of_freedom().unwrap(), 7.11417375578),
            (bar.half_width(0.9).unwrap(), 0.071421529124),
            (bar.trim_share().unwrap(), 0.001 / 0.001428),
        ] {
            assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        }
        assert_eq!(bar.remarks(), []);
    }

    #[test]
    fn identical_models_have_no_bar_and_a_single_model_has_remarks() {
        let none = bar(0.0, 0.0);
        assert_eq!(
            (none.half_width(0.9), none.remarks()),
            (None, vec![BarRemark::NoSpread])
        );
        let alone = Bar {
            trim: None,
            identification: None,
            ..none
        };
        assert_eq!(
            alone.remarks(),
            [BarRemark::NoTrim, BarRemark::NoIdentification]
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
}
