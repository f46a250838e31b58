//! Delta gain and delta delay: the gain and delay by which a single response would have to be
//! corrected, eq. (5), (9).
//!
//! ```text
//! G    = median |H_ref| / |H_sim|                       D = median Delta phi(H_sim, H_ref) / omega
//! band delay = sum W omega Delta phi / sum W omega^2    W: coherence weight, otherwise 1 (M15.2)
//! ```
//!
//! `H_sim` is the physics model's response, `H_ref` the identified model's, `Delta phi` the phase
//! by which the physics model leads; medians and sums are over the frequencies. The *mismatch* is
//! the difference between both in dB and in phase.

use serde::{Deserialize, Serialize};

use gdcm_model::dataset::PairTable;
use gdcm_model::response::PolarResponse;
use gdcm_model::units::db_to_ratio;

use crate::fidelity::{CoherenceWeights, Mismatch};

/// Magnitude \[dB\] beyond which a ratio (above 1e50 or below 1e-50) is regarded as infinite or
/// zero, so that its square, and products of such squares in the objective, neither overflow nor
/// underflow.
pub const LARGEST_GAIN_DB: f64 = 1000.0;

/// Models from which G is computed; D is always computed from the representatives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum GainSource {
    /// The two representatives, eq. (5).
    #[default]
    #[serde(rename = "representatives")]
    Representatives,
    /// All pairs of an accepted physics model and an accepted identified model (neither rejected
    /// nor set aside): `G = exp(mean(ln G))`.
    #[serde(rename = "mean")]
    MeanOfPairs,
}

/// Delta gain `G = median |H_ref| / |H_sim|`, delta delay `D = median Delta phi(H_sim, H_ref) /
/// omega` (M6), and band delay (M15.2) for every response.
///
/// `None` if a model lacks the response, if the ratio is zero or not finite at a frequency that
/// counts, or if no frequency counts. The medians are weighted if the mismatch has coherence
/// weights (M4a).
#[derive(Clone, Debug, PartialEq)]
pub struct Delta {
    /// G, `[output, input]`; a ratio, not in dB.
    pub gain: PairTable<Option<f64>>,
    /// D, `[output, input]` \[s\]; positive if the physics model leads, so that a delay must be
    /// added.
    pub delay_s: PairTable<Option<f64>>,
    /// Band delay, `[output, input]` \[s\]: slope of the line through the origin that fits `Delta
    /// phi` over `omega` best, in least squares (M15.2).
    pub band_delay_s: PairTable<Option<f64>>,
}

impl Delta {
    /// Computes G, D and the band delay from the mismatch between two representatives at the
    /// frequencies `omega` \[rad/s\].
    pub fn new(mismatch: &PairTable<Option<Mismatch>>, omega: &[f64]) -> Self {
        let phases = mismatch.map(|pair, _| {
            let mismatch = mismatch[pair].as_ref()?;
            Some(PhaseDifference {
                mismatch,
                phase: mismatch.phase_difference(omega),
                omega: mismatch.omega(omega),
            })
        });
        Self {
            gain: delta_gains(mismatch),
            delay_s: phases.map(|_, entry| Some(entry.as_ref()?.median_delay_s())),
            band_delay_s: phases.map(|_, entry| Some(entry.as_ref()?.band_delay_s())),
        }
    }
}

/// Phase difference `Delta phi(H_sim, H_ref)` in a single response.
struct PhaseDifference<'a> {
    mismatch: &'a Mismatch,
    /// Phase \[rad\] at each frequency.
    phase: Vec<f64>,
    /// The frequencies that count \[rad/s\].
    omega: &'a [f64],
}

impl PhaseDifference<'_> {
    /// Computes D \[s\], eq. (9).
    fn median_delay_s(&self) -> f64 {
        self.mismatch.median(&mut delays(&self.phase, self.omega))
    }

    /// Computes the band delay \[s\] (M15.2).
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

/// Computes `sum W omega phase / sum W omega^2` \[s\] from the phase \[rad\] at each frequency
/// \[rad/s\]: the delay that minimises the mean square phase that remains (M15.2). It is linear in
/// the phase; W = 1 without weights.
pub(crate) fn band_delay_s(
    phase: impl Iterator<Item = f64>,
    omega: &[f64],
    weights: Option<&[f64]>,
) -> f64 {
    let mut moment = 0.0;
    let mut square = 0.0;
    for (index, (phase, omega)) in phase.zip(omega).enumerate() {
        let weight = match weights {
            Some(weights) => weights[index],
            None => 1.0,
        };
        moment += weight * omega * phase;
        square += weight * omega * omega;
    }
    moment / square
}

/// Computes the mismatch for every response that both models contain and whose ratio is finite and
/// not zero, at the frequencies that count; `coherence_weights` selects and weights them, otherwise
/// all count (M4a).
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

/// Returns `|H_ref| / |H_sim|` at each frequency.
pub(super) fn ratios(mismatch: &Mismatch) -> Vec<f64> {
    mismatch
        .magnitude_db
        .iter()
        .map(|error| db_to_ratio(-error))
        .collect()
}

/// Returns `Delta phi(H_sim, H_ref) / omega` \[s\] at each frequency.
pub(super) fn delays(phase: &[f64], omega: &[f64]) -> Vec<f64> {
    phase
        .iter()
        .zip(omega)
        .map(|(phase, omega)| phase / omega)
        .collect()
}
