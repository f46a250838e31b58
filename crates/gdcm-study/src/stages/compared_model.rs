//! A model prepared for comparison with a model from the other bundle.
//!
//! Prepared means: magnitude and phase of every response, the numerically zero responses (M6a)
//! removed, the reason for each missing response, and the coherence weights of an identified model.

use nalgebra::Complex;

use gdcm_method::correction::delta::mismatch_table;
use gdcm_method::fidelity::CoherenceWeights;
use gdcm_model::dataset::{BundleKind, Condition, Pair, PairTable};
use gdcm_model::response::{FrequencyGrid, PolarResponse};

use super::condition_responses::ConditionResponses;
use crate::results::caution::{GainOutOfRange, Undefined};
use crate::results::comparison::Mismatches;

/// Frequencies at which models are compared, and the minimum coherence.
#[derive(Clone, Copy)]
pub struct ComparisonGrid<'a> {
    pub grid: &'a FrequencyGrid,
    /// Minimum coherence at which a frequency counts; `None` ignores coherence (M4a).
    pub coherence: Option<f64>,
}

/// Why a response has no magnitude in dB at some frequency.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Absence {
    Zero,
    ZeroSomewhere,
    NotFinite,
}

impl Absence {
    /// Classifies a response that is zero or not finite at one or more frequencies: zero wherever
    /// it is finite; else, if it is finite everywhere, zero somewhere; else not finite.
    fn classify(values: &[Complex<f64>]) -> Self {
        let finite: Vec<&Complex<f64>> = values.iter().filter(|value| value.is_finite()).collect();
        if !finite.is_empty() && finite.iter().all(|value| value.norm() == 0.0) {
            Self::Zero
        } else if finite.len() == values.len() {
            Self::ZeroSomewhere
        } else {
            Self::NotFinite
        }
    }
}

/// A model prepared for comparison, without its numerically zero responses.
pub(crate) struct ComparedModel {
    pub(crate) polar: PolarResponse,
    /// Why the model lacks a response; `None` where it has the response, even if numerically zero.
    absent: PairTable<Option<Absence>>,
    /// The numerically zero responses (M6a).
    pub(crate) numerically_zero: PairTable<bool>,
    /// Frequency weights, where coherence is used.
    coherence_weights: Option<PairTable<CoherenceWeights>>,
}

impl ComparedModel {
    /// Prepares a bundle's model. An identified model gets coherence weights if a minimum coherence
    /// is set (M4a).
    pub(crate) fn new(
        condition: &Condition,
        responses: &ConditionResponses,
        kind: BundleKind,
        model: usize,
        grid: ComparisonGrid<'_>,
    ) -> Self {
        let response = responses.compared(kind, model);
        let mut polar = PolarResponse::new(&response);
        let absent = polar.curves().map(|pair, curve| match curve {
            Some(_) => None,
            None => Some(Absence::classify(response.curve(pair))),
        });
        let numerically_zero = polar.numerically_zero();
        polar.clear(&numerically_zero);
        let coherence = match kind {
            BundleKind::Identified => grid.coherence,
            BundleKind::Physics => None,
        };
        let dynamics = &condition.bundle(kind)[model].dynamics;
        Self {
            polar,
            absent,
            numerically_zero,
            coherence_weights: CoherenceWeights::of_model(dynamics, grid.grid.omega(), coherence),
        }
    }

    /// Computes the mismatches against a reference, response by response, with the reference's
    /// coherence weights.
    pub(crate) fn mismatches(&self, reference: &Self) -> Mismatches {
        mismatch_table(
            &self.polar,
            &reference.polar,
            reference.coherence_weights.as_ref(),
        )
    }

    /// Counts the frequencies with nonzero weight in a response; `None` where coherence is not
    /// used.
    pub(crate) fn weighted_frequencies(&self, pair: Pair) -> Option<usize> {
        let weights = self.coherence_weights.as_ref()?;
        Some(weights[pair].weights.len())
    }
}

/// Returns why a response has no G and no D: the first reason that applies, each checked for the
/// physics model first:
///
/// 1. numerically zero;
/// 2. zero, zero somewhere, or not finite;
/// 3. a gain out of range, if any frequency has weight;
/// 4. no frequency with weight.
pub(crate) fn why_undefined(
    physics: &ComparedModel,
    identified: &ComparedModel,
    pair: Pair,
) -> Undefined {
    let models = [
        (BundleKind::Physics, physics),
        (BundleKind::Identified, identified),
    ];
    for (bundle, model) in models {
        if model.numerically_zero[pair] {
            return Undefined::NumericallyZero(bundle);
        }
    }
    for (bundle, model) in models {
        match model.absent[pair] {
            Some(Absence::Zero) => return Undefined::Zero(bundle),
            Some(Absence::ZeroSomewhere) => return Undefined::ZeroSomewhere(bundle),
            Some(Absence::NotFinite) => return Undefined::NotFinite(bundle),
            None => {}
        }
    }
    match GainOutOfRange::of_pair(&physics.polar, &identified.polar, pair) {
        Some(gain) if identified.weighted_frequencies(pair) != Some(0) => {
            Undefined::GainOutOfRange(gain.power_of_ten)
        }
        // Both models have the response, but all its frequencies have weight zero.
        _ => Undefined::NotCoherent,
    }
}
