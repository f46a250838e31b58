//! Changes of a condition's values when its models are substituted (M13.1), the error bars of all conditions, and the error of a
//! measured response from its coherence (M13.2).

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::ops::Index;

use gdcm_model::dataset::Pair;
use gdcm_model::statistics::median;

use super::bar::{Bar, IdentificationSource, VarianceComponent, pooled};
use crate::correction::Channel;

/// Every scalar of a condition; `None` where it does not exist.
pub type Figures = ScalarTable<Option<f64>>;

/// Error that an identified model or a measured response reports about itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReportedUncertainty {
    /// Variance with its degrees of freedom.
    pub part: VarianceComponent,
    /// Coherence or confidence band.
    pub source: IdentificationSource,
}

/// Mean squares of the changes of one scalar.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Changes {
    trim: Option<VarianceComponent>,
    own: Option<VarianceComponent>,
    left_out: usize,
}

/// Changes of the scalars of one condition when other models of its bundles replace the representatives (M13.1).
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionSpread {
    changes: ScalarTable<Changes>,
}

impl ConditionSpread {
    /// Computes the mean squares about the scalars of the representatives. `trim` has an entry for each other kept physics model,
    /// `own` for each other kept identified model; `None` where the analysis of that pair failed.
    pub fn of(
        representatives: &Figures,
        trim: &[Option<&Figures>],
        own: &[Option<&Figures>],
    ) -> Self {
        let changes = representatives.map(|scalar, base| {
            let Some(base) = base else {
                return Changes::default();
            };
            let changed = |swaps: &[Option<&Figures>]| -> Vec<f64> {
                swaps
                    .iter()
                    .filter_map(|figures| Some((*figures)?[scalar]? - base))
                    .collect()
            };
            let by_trim = changed(trim);
            let by_own = changed(own);
            let left_out = trim.len() + own.len() - by_trim.len() - by_own.len();
            Changes {
                trim: VarianceComponent::of_changes(&by_trim),
                own: VarianceComponent::of_changes(&by_own),
                left_out,
            }
        });
        Self { changes }
    }
}

/// Input of the bars of one condition.
#[derive(Clone, Debug)]
pub struct BarSource<'a> {
    /// Scalars with both representatives.
    pub figures: Figures,
    /// Their changes under substitution.
    pub spread: &'a ConditionSpread,
    /// Errors reported by the identified representative itself.
    pub told: ScalarTable<Option<ReportedUncertainty>>,
    /// Lower and upper bound of a channel delay in s.
    pub delay_bounds_s: [f64; 2],
}

/// Computes the bars of all conditions of an analysis (M13.2, M13.3). The identification part of each scalar is pooled over the
/// conditions. A scalar that does not exist has no bar.
pub fn bars(conditions: &[BarSource<'_>], prior_degrees: f64) -> Vec<ScalarTable<Option<Bar>>> {
    let Some(first) = conditions.first() else {
        return Vec::new();
    };
    let identification = first.figures.map(|scalar, _| {
        let own: Vec<Option<VarianceComponent>> = conditions
            .iter()
            .map(|of| of.spread.changes[scalar].own)
            .collect();
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
                range: match scalar {
                    Scalar::ChannelDelay(_) => of.delay_bounds_s,
                    _ => [f64::NEG_INFINITY, f64::INFINITY],
                },
            })
        })
    };
    conditions.iter().enumerate().map(of_condition).collect()
}

impl ReportedUncertainty {
    /// Whether the reported error replaces the spread, because it is larger. Models that each leave one record out spread less than
    /// each of them errs, by about the root of the number of records (Efron's jackknife); their bands do not have this defect.
    fn replaces(&self, spread: Option<VarianceComponent>) -> bool {
        spread.is_none_or(|spread| self.part.variance > spread.variance)
    }
}

/// Scalar result of the analysis of a condition, `q` of M13.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Scalar {
    /// `ln G` of a response.
    Gain(Pair),
    /// `D` of a response \[s\] by eq. (9).
    Delay(Pair),
    /// `D` of a response \[s\] by the line through its phase (M15.2).
    BandDelay(Pair),
    /// `ln k_o k_i` of a response.
    NetGain(Pair),
    /// `ln k` of a channel.
    ChannelGain(Channel),
    /// `tau` of a channel \[s\].
    ChannelDelay(Channel),
}

impl Scalar {
    /// Whether the scalar is a time in s; otherwise it is the natural logarithm of a gain.
    pub fn is_delay(self) -> bool {
        matches!(
            self,
            Self::Delay(_) | Self::BandDelay(_) | Self::ChannelDelay(_)
        )
    }
}

/// Table with one entry for each scalar of a condition with `p` outputs and `m` inputs.
#[derive(Clone, Debug, PartialEq)]
pub struct ScalarTable<T>(BTreeMap<Scalar, T>);

impl<T> ScalarTable<T> {
    /// Builds the table by calling `entry` for each scalar.
    pub fn from_fn(outputs: usize, inputs: usize, mut entry: impl FnMut(Scalar) -> T) -> Self {
        Self(
            scalars(outputs, inputs)
                .map(|scalar| (scalar, entry(scalar)))
                .collect(),
        )
    }

    /// Iterates over the scalars with their entries.
    pub fn iter(&self) -> impl Iterator<Item = (Scalar, &T)> {
        self.0.iter().map(|(scalar, entry)| (*scalar, entry))
    }

    /// Applies `f` to each entry.
    pub fn map<U>(&self, mut f: impl FnMut(Scalar, &T) -> U) -> ScalarTable<U> {
        ScalarTable(
            self.iter()
                .map(|(scalar, entry)| (scalar, f(scalar, entry)))
                .collect(),
        )
    }
}

impl<T> Index<Scalar> for ScalarTable<T> {
    type Output = T;

    fn index(&self, scalar: Scalar) -> &T {
        &self.0[&scalar]
    }
}

/// Iterates over all scalars of a condition.
fn scalars(outputs: usize, inputs: usize) -> impl Iterator<Item = Scalar> {
    let of_pair: [fn(Pair) -> Scalar; 4] = [
        Scalar::Gain,
        Scalar::Delay,
        Scalar::BandDelay,
        Scalar::NetGain,
    ];
    let of_channel: [fn(Channel) -> Scalar; 2] = [Scalar::ChannelGain, Scalar::ChannelDelay];
    let pairs = move |of: fn(Pair) -> Scalar| {
        (0..outputs)
            .flat_map(move |output| (0..inputs).map(move |input| of(Pair::new(output, input))))
    };
    let channels = move |of| Channel::all(inputs, outputs).map(of);
    of_pair
        .into_iter()
        .flat_map(pairs)
        .chain(of_channel.into_iter().flat_map(channels))
}

/// Data of a measured response for the Bendat-Piersol error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// Number of independent averages, `n_d`.
    pub averages: f64,
    /// Window length `T_w` in s. Without it all frequencies of the band share one error.
    pub window_s: Option<f64>,
    /// `C_epsilon`: 1, or `sqrt(0.55)` for windows that overlap by half.
    pub factor: f64,
}

/// Standard deviations of `ln G` and D from the coherence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoherenceError {
    /// Standard deviation of `ln G`.
    pub ln_gain: f64,
    /// Standard deviation of D in s.
    pub delay_s: f64,
}

impl Measurement {
    /// Returns the degrees of freedom of the error, `2 n_d`.
    pub fn degrees_of_freedom(&self) -> f64 {
        2.0 * self.averages
    }

    /// Computes `epsilon = C sqrt(1 - gamma^2) / (|gamma| sqrt(2 n_d))`: standard deviation of `ln |H|` and, in rad, of `arg H`.
    ///
    /// J. S. Bendat and A. G. Piersol, *Random Data*, 4th ed. (2010), section 9.
    pub fn deviation(&self, coherence: f64) -> f64 {
        self.factor * ((1.0 - coherence) / (coherence * 2.0 * self.averages)).sqrt()
    }

    /// Computes `kappa = sqrt(min(1, (pi/2) sum f_j^2))` with `f_j` the share of the frequencies \[rad/s\] with
    /// `floor(omega T_w / (4 pi)) = j`: errors of frequencies closer than `4 pi / T_w` are one error.
    fn averaging(&self, omega: &[f64]) -> f64 {
        let Some(window_s) = self.window_s else {
            return 1.0;
        };
        let cell = |omega: &f64| (omega * window_s / (4.0 * PI)).floor();
        let shares = omega
            .chunk_by(|a, b| cell(a) == cell(b))
            .map(|chunk| chunk.len() as f64 / omega.len() as f64);
        (0.5 * PI * shares.map(|share| share * share).sum::<f64>())
            .min(1.0)
            .sqrt()
    }

    /// Computes the error over a band from the coherence at ascending frequencies `omega` in rad/s. Frequencies with a coherence of
    /// zero or below `threshold` are left out; `None` where no frequency remains.
    pub fn error(
        &self,
        omega: &[f64],
        coherence: &[f64],
        threshold: f64,
    ) -> Option<CoherenceError> {
        let is_measured = |coherence: f64| coherence > 0.0 && coherence >= threshold;
        let measured = || {
            omega
                .iter()
                .zip(coherence)
                .filter(|(_, coherence)| is_measured(**coherence))
        };
        let mut gains: Vec<f64> = measured()
            .map(|(_, &coherence)| self.deviation(coherence))
            .collect();
        let mut delays: Vec<f64> = measured()
            .map(|(omega, &coherence)| self.deviation(coherence) / omega)
            .collect();
        if gains.is_empty() || self.averages.is_nan() || self.averages <= 0.0 {
            return None;
        }
        let kappa = self.averaging(omega);
        Some(CoherenceError {
            ln_gain: kappa * median(&mut gains),
            delay_s: kappa * median(&mut delays),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_larger_of_the_spread_and_of_what_a_model_says_of_itself_counts() {
        let part = |variance: f64| VarianceComponent {
            variance,
            degrees_of_freedom: 3.0,
        };
        for source in [
            IdentificationSource::ModelBand,
            IdentificationSource::Coherence,
        ] {
            let told = ReportedUncertainty {
                part: part(0.04),
                source,
            };
            assert!(told.replaces(None) && told.replaces(Some(part(0.01))));
            assert!(!told.replaces(Some(part(0.09))));
        }
    }
}

#[cfg(test)]
mod scalar_tests {
    use super::*;

    #[test]
    fn every_figure_has_a_place_of_its_own() {
        let table = ScalarTable::from_fn(3, 2, |scalar| scalar);
        assert!(
            table
                .iter()
                .all(|(scalar, entry)| scalar == *entry && table[scalar] == scalar)
        );
        assert_eq!(table.iter().count(), 4 * 6 + 2 * 5);
    }
}
