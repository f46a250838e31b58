//! The bar of one figure (M13.3).

use super::part::{Part, satterthwaite};
use super::quantiles::student_quantile;

/// Why a part is what it is, where that is not the spread of the models.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum IdentificationSource {
    /// The spread of the identified models, with that of the other conditions (M13.2).
    Spread,
    /// The coherence of the measured response, which says more than the spread.
    Coherence,
    /// The band that the identified model carries, which says more than the spread.
    ModelBand,
}

/// What is known of how sure one figure is.
///
/// Of a gain the figure is its natural logarithm, of a delay \[s\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bar {
    /// The figure itself, `q_0`.
    pub value: f64,
    /// What not knowing the trim flown makes, `s_phys`; none where no other physics model is kept.
    pub trim: Option<Part>,
    /// What not knowing the flight's response better makes, `s_id`; none where nothing says it.
    pub identification: Option<Part>,
    /// Where the identification part comes from.
    pub source: IdentificationSource,
    /// Swaps in which the figure does not exist.
    pub left_out: usize,
    /// Least and greatest value that the figure can have.
    pub range: [f64; 2],
}

impl Bar {
    /// `u^2 = s_phys^2 + s_id^2`.
    pub fn variance(&self) -> f64 {
        self.parts().map(|part| part.variance).sum()
    }

    /// `u`.
    pub fn deviation(&self) -> f64 {
        self.variance().sqrt()
    }

    /// The parts that are known.
    pub fn parts(&self) -> impl Iterator<Item = Part> + use<> {
        [self.trim, self.identification].into_iter().flatten()
    }

    /// Degrees of freedom of `u`; none where the bundle has no spread.
    pub fn degrees(&self) -> Option<f64> {
        satterthwaite(self.parts())
    }

    /// Half-width `h = t(max(nu, 1)) u` of the whole bar; none where there is no spread, or none is known.
    pub fn half_width(&self, level: f64) -> Option<f64> {
        self.degrees().map(|degrees| student_quantile(level, degrees) * self.deviation())
    }

    /// Half-width of the inner bar, "for this physics model": `t(nu_id) s_id`.
    pub fn inner_half_width(&self, level: f64) -> Option<f64> {
        let part = self.identification.filter(|part| part.variance > 0.0)?;
        Some(student_quantile(level, part.degrees) * part.variance.sqrt())
    }

    /// The whole bar, cut to the values that the figure can have.
    pub fn interval(&self, level: f64) -> Option<[f64; 2]> {
        self.half_width(level).map(|half| self.about(half))
    }

    /// The inner bar, cut likewise.
    pub fn inner_interval(&self, level: f64) -> Option<[f64; 2]> {
        self.inner_half_width(level).map(|half| self.about(half))
    }

    fn about(&self, half: f64) -> [f64; 2] {
        let [least, greatest] = self.range;
        [(self.value - half).clamp(least, greatest), (self.value + half).clamp(least, greatest)]
    }

    /// Share of the trim in the variance, from 0 to 1; none where there is no spread.
    pub fn trim_share(&self) -> Option<f64> {
        let variance = self.variance();
        (variance > 0.0).then(|| self.trim.map_or(0.0, |part| part.variance) / variance)
    }

    /// What the bar does not include, or why there is none, in words.
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
            IdentificationSource::ModelBand => remarks.push("identification from the model's own band"),
        }
        remarks
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bar(trim: f64, identification: f64) -> Bar {
        Bar {
            value: 0.1,
            trim: Some(Part { variance: trim * trim, degrees: 4.0 }),
            identification: Some(Part { variance: identification * identification, degrees: 5.0 }),
            source: IdentificationSource::Spread,
            left_out: 0,
            range: [f64::NEG_INFINITY, f64::INFINITY],
        }
    }

    /// Case A of the reference, condition 1 (independent numpy code).
    #[test]
    fn a_bar_is_student_s_quantile_of_both_parts() {
        let bar = bar(0.0316227766017, 0.0206881608656);
        let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        near(bar.deviation(), 0.0377888872554);
        near(bar.degrees().unwrap(), 7.11417375578);
        near(bar.half_width(0.9).unwrap(), 0.071421529124);
        near(bar.trim_share().unwrap(), 0.001 / 0.001428);
        assert_eq!(bar.remarks(), Vec::<&str>::new());
    }

    #[test]
    fn identical_models_have_no_bar_and_one_model_says_what_is_missing() {
        let none = bar(0.0, 0.0);
        assert_eq!((none.half_width(0.9), none.remarks()), (None, vec!["the bundle has no spread"]));
        let alone = Bar { trim: None, identification: None, ..none };
        assert_eq!(alone.remarks(), ["trim not included", "identification not included"]);
        assert_eq!(alone.interval(0.9), None);
    }

    #[test]
    fn a_delay_s_bar_ends_at_its_bounds() {
        let cut = Bar { value: 0.0, range: [0.0, 0.01], ..bar(0.03, 0.02) };
        assert_eq!(cut.interval(0.9), Some([0.0, 0.01]));
    }
}
