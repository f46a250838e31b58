//! What the swaps of a condition's models do to its figures, and the bars that all conditions' swaps make.

use super::bar::{Bar, IdentificationSource};
use super::part::{Part, pooled};
use super::scalar::{Scalar, ScalarTable};

/// One figure of each kind, where it exists.
pub type Figures = ScalarTable<Option<f64>>;

/// What the flight's response is known by, besides the spread of several models of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReportedUncertainty {
    /// Its variance with its degrees of freedom.
    pub part: Part,
    /// Who says it.
    pub source: IdentificationSource,
}

/// The mean squares of one figure's changes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Changes {
    trim: Option<Part>,
    own: Option<Part>,
    left_out: usize,
}

/// How the figures of one condition change when other models of its bundles stand in for the representatives (M13.1).
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionSpread {
    changes: ScalarTable<Changes>,
}

impl ConditionSpread {
    /// The spread about the figures of the representatives: `trim` has the figures with each other physics model kept, `own` those
    /// with each other identified model kept; none where such a pair could not be analysed.
    pub fn of(representatives: &Figures, trim: &[Option<&Figures>], own: &[Option<&Figures>]) -> Self {
        let changes = representatives.map(|scalar, base| {
            let Some(base) = base else { return Changes::default() };
            let changed = |swaps: &[Option<&Figures>]| -> Vec<f64> {
                swaps.iter().filter_map(|figures| Some((*figures)?[scalar]? - base)).collect()
            };
            let (by_trim, by_own) = (changed(trim), changed(own));
            let left_out = trim.len() + own.len() - by_trim.len() - by_own.len();
            Changes { trim: Part::of_changes(&by_trim), own: Part::of_changes(&by_own), left_out }
        });
        Self { changes }
    }
}

/// Everything about one condition that its bars are made of.
#[derive(Clone, Debug)]
pub struct BarSource<'a> {
    /// The figures themselves.
    pub figures: Figures,
    /// How they change with the models.
    pub spread: &'a ConditionSpread,
    /// Errors that the identified representative tells of itself.
    pub told: ScalarTable<Option<ReportedUncertainty>>,
    /// Least and greatest delay of a channel \[s\].
    pub delay_bounds_s: [f64; 2],
}

/// The bars of every condition of an analysis (M13.2, M13.3), the identification part of each figure pooled over them all. None
/// where a figure does not exist.
pub fn bars(conditions: &[BarSource<'_>], prior_degrees: f64) -> Vec<ScalarTable<Option<Bar>>> {
    let Some(first) = conditions.first() else { return Vec::new() };
    let identification = first.figures.map(|scalar, _| {
        let own: Vec<Option<Part>> = conditions.iter().map(|of| of.spread.changes[scalar].own).collect();
        pooled(&own, prior_degrees)
    });
    let of_condition = |(place, of): (usize, &BarSource<'_>)| {
        of.figures.map(|scalar, value| {
            let changes = of.spread.changes[scalar];
            let spread = identification[scalar][place];
            let told = of.told[scalar].filter(|told| told.replaces(spread));
            Some(Bar {
                value: (*value)?,
                trim: changes.trim,
                identification: told.map_or(spread, |told| Some(told.part)),
                source: told.map_or(IdentificationSource::Spread, |told| told.source),
                left_out: changes.left_out,
                range: range(scalar, of.delay_bounds_s),
            })
        })
    };
    conditions.iter().enumerate().map(of_condition).collect()
}

impl ReportedUncertainty {
    /// Whether it takes the place of the spread: where it is the larger. Models that each leave one record out spread less than any of
    /// them errs, by about the root of the number of records (Efron's jackknife); the band that they carry does not.
    fn replaces(&self, spread: Option<Part>) -> bool {
        spread.is_none_or(|spread| self.part.variance > spread.variance)
    }
}

fn range(scalar: Scalar, delay_bounds_s: [f64; 2]) -> [f64; 2] {
    match scalar {
        Scalar::ChannelDelay(_) => delay_bounds_s,
        _ => [f64::NEG_INFINITY, f64::INFINITY],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_larger_of_the_spread_and_of_what_a_model_says_of_itself_counts() {
        let part = |variance: f64| Part { variance, degrees: 3.0 };
        for source in [IdentificationSource::ModelBand, IdentificationSource::Coherence] {
            let told = ReportedUncertainty { part: part(0.04), source };
            assert!(told.replaces(None) && told.replaces(Some(part(0.01))));
            assert!(!told.replaces(Some(part(0.09))));
        }
    }
}
