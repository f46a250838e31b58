//! Delta gain and delta delay, the single gain and delay that a response needs, eq. (5), (9); and
//! the channel bounds from their spread over the band (M7).

use serde::{Deserialize, Serialize};

use gdcm_model::dataset::{Pair, PairTable};
use gdcm_model::response::PolarResponse;
use gdcm_model::statistics::quantile;
use gdcm_model::units::db_to_ratio;

use super::GainBounds;
use crate::fidelity::{CoherenceWeights, Mismatch};

/// Source models of G; D always comes from the representatives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum GainSource {
    /// The two representatives (eq. (5)).
    #[default]
    #[serde(rename = "representatives")]
    Representatives,
    /// Every pair of a kept physics model and a kept identified model: `G = exp(mean(ln G))`.
    #[serde(rename = "mean")]
    MeanOfPairs,
}

impl GainSource {
    /// Describes the source: "the representatives".
    pub fn words(self) -> &'static str {
        match self {
            Self::Representatives => "the representatives",
            Self::MeanOfPairs => "the mean over all kept pairs",
        }
    }
}

/// `G = median |H_ref| / |H_sim|` and `D = median Delta phi(H_sim, H_ref) / omega` for every
/// response (M6), and its band delay (M15.2).
///
/// `None` where the ratio is zero or not finite at some frequency, or where no frequency counts.
/// The medians are weighted where the reference is measured with coherence (M4a).
#[derive(Clone, Debug, PartialEq)]
pub struct Delta {
    /// G, `[output, input]`, dimensionless.
    pub gain: PairTable<Option<f64>>,
    /// D, `[output, input]` \[s\]; positive where the physics model leads, so that delay must be
    /// added.
    pub delay_s: PairTable<Option<f64>>,
    /// Band delay, `[output, input]` \[s\]: least squares straight line through the missing phase
    /// (M15.2).
    pub band_delay_s: PairTable<Option<f64>>,
}

impl Delta {
    /// Computes G and D from the mismatch between two representatives at the frequencies `omega`
    /// \[rad/s\].
    pub fn new(mismatch: &PairTable<Option<Mismatch>>, omega: &[f64]) -> Self {
        let phases = mismatch.map(|pair, _| {
            let entry = mismatch[pair].as_ref()?;
            Some(MissingPhase {
                mismatch: entry,
                phase: entry.phase_difference(omega),
                omega: entry.omega(omega),
            })
        });
        Self {
            gain: delta_gains(mismatch),
            delay_s: phases.map(|_, entry| Some(entry.as_ref()?.median_delay_s())),
            band_delay_s: phases.map(|_, entry| Some(entry.as_ref()?.band_delay_s())),
        }
    }
}

/// `Delta phi(H_sim, H_ref)` for a single response.
struct MissingPhase<'a> {
    mismatch: &'a Mismatch,
    /// Phase \[rad\] at each frequency.
    phase: Vec<f64>,
    /// Frequencies \[rad/s\].
    omega: &'a [f64],
}

impl MissingPhase<'_> {
    /// Computes D, eq. (9).
    fn median_delay_s(&self) -> f64 {
        self.mismatch.median(&mut delays(&self.phase, self.omega))
    }

    /// Computes the band delay (M15.2).
    fn band_delay_s(&self) -> f64 {
        let phase = self.phase.iter().copied();
        band_delay_s(phase, self.omega, self.mismatch.weights())
    }
}

/// Computes `G = median |H_ref| / |H_sim|` for every response (M6).
pub fn delta_gains(mismatch: &PairTable<Option<Mismatch>>) -> PairTable<Option<f64>> {
    mismatch.map(|_, entry| {
        let entry = entry.as_ref()?;
        Some(entry.median(&mut ratios(entry)))
    })
}

/// Computes `sum W omega phase / sum W omega^2` \[s\] for a phase \[rad\] at each frequency
/// \[rad/s\]: the delay that minimises the remaining mean square phase (M15.2). Linear in the
/// phase; W = 1 without weights.
pub(crate) fn band_delay_s(
    phase: impl Iterator<Item = f64>,
    omega: &[f64],
    weights: Option<&[f64]>,
) -> f64 {
    let mut moment = 0.0;
    let mut square = 0.0;
    for (place, (phase, omega)) in phase.zip(omega).enumerate() {
        let weight = match weights {
            Some(weights) => weights[place],
            None => 1.0,
        };
        moment += weight * omega * phase;
        square += weight * omega * omega;
    }
    moment / square
}

/// Ratios beyond this (1e50 and 1e-50), whose squares the objective cannot represent, count as
/// infinite or zero (M6).
pub const LARGEST_GAIN_DB: f64 = 1000.0;

/// Computes the mismatch of every response that both models have and whose ratio is finite and not
/// zero, at the frequencies that count: all where `coherence_weights` is `None` (M4a).
pub fn mismatch_table(
    simulated: &PolarResponse,
    reference: &PolarResponse,
    coherence_weights: Option<&PairTable<CoherenceWeights>>,
) -> PairTable<Option<Mismatch>> {
    simulated.curves().map(|pair, simulated| {
        let reference = reference.curves()[pair].as_ref()?;
        let weights = coherence_weights.map(|weights| &weights[pair]);
        let mismatch = Mismatch::new(simulated.as_ref()?, reference).coherence_weighted(weights)?;
        let is_defined = mismatch
            .magnitude_db
            .iter()
            .all(|error| error.abs() < LARGEST_GAIN_DB);
        if is_defined { Some(mismatch) } else { None }
    })
}

/// Computes `|H_ref| / |H_sim|` at each frequency.
fn ratios(mismatch: &Mismatch) -> Vec<f64> {
    mismatch
        .magnitude_db
        .iter()
        .map(|error| db_to_ratio(-error))
        .collect()
}

/// Computes `Delta phi(H_sim, H_ref) / omega` \[s\] at each frequency.
fn delays(phase: &[f64], omega: &[f64]) -> Vec<f64> {
    phase
        .iter()
        .zip(omega)
        .map(|(phase, omega)| phase / omega)
        .collect()
}

/// Selects the mismatches to pool: those marked in `measuring`, or all where no marked mismatch is
/// defined.
fn pooled<'a>(
    mismatch: &'a PairTable<Option<Mismatch>>,
    measuring: &PairTable<bool>,
) -> impl Iterator<Item = &'a Mismatch> + use<'a> {
    let marked: Vec<Pair> = measuring
        .marked()
        .filter(|&pair| mismatch[pair].is_some())
        .collect();
    let pairs = if marked.is_empty() {
        mismatch.pairs().collect()
    } else {
        marked
    };
    pairs.into_iter().filter_map(|pair| mismatch[pair].as_ref())
}

/// Computes `LB = min(1, q-quantile)` and `UB = max(1, (1-q)-quantile)` for `|H_ref| / |H_sim|`
/// pooled over frequency and pairs (M7).
pub fn gain_bounds(
    mismatch: &PairTable<Option<Mismatch>>,
    measuring: &PairTable<bool>,
    q: f64,
) -> GainBounds {
    let mut pool: Vec<f64> = pooled(mismatch, measuring).flat_map(ratios).collect();
    let lower = quantile(&mut pool, q).min(1.0);
    let upper = quantile(&mut pool, 1.0 - q).max(1.0);
    GainBounds { lower, upper }
}

/// Computes `UB = max(0, (1-q)-quantile)` \[s\] for `Delta phi / omega` pooled over frequency and
/// pairs (M7).
pub fn delay_upper_s(
    mismatch: &PairTable<Option<Mismatch>>,
    measuring: &PairTable<bool>,
    omega: &[f64],
    q: f64,
) -> f64 {
    let mut pool = Vec::new();
    for mismatch in pooled(mismatch, measuring) {
        let phase = mismatch.phase_difference(omega);
        pool.extend(delays(&phase, mismatch.omega(omega)));
    }
    quantile(&mut pool, 1.0 - q).max(0.0)
}
