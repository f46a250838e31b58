//! G as the geometric mean over all pairs of a kept physics and a kept identified model (M6),
//! instead of the two representatives' G.

use gdcm_method::correction::delta::delta_gains;
use gdcm_method::fidelity::representative::Representative;
use gdcm_model::dataset::{BundleKind, PairTable};

use super::compared_model::ComparedModel;
use super::comparison_input::ComparisonInput;
use crate::results::comparison::Comparison;

impl Comparison {
    /// Returns the comparison with each response's G replaced by its geometric mean over all pairs of
    /// a kept physics model and a kept identified model that have the response.
    pub(crate) fn with_mean_gains(mut self, input: &ComparisonInput<'_>) -> Self {
        let physics = kept_models(input, BundleKind::Physics, &self.physics);
        let identified = kept_models(input, BundleKind::Identified, &self.identified);
        let mut means: PairTable<MeanLogarithm> =
            self.delta.gain.map(|_, _| MeanLogarithm::default());
        for compared_physics in &physics {
            for compared_identified in &identified {
                for (pair, gain) in
                    delta_gains(&compared_physics.mismatches(compared_identified)).iter()
                {
                    if let Some(gain) = gain {
                        means[pair].add(*gain);
                    }
                }
            }
        }
        self.delta.gain = self.delta.gain.map(|pair, gain| {
            // Where the representatives have G, they are among the counted pairs: the count is
            // positive.
            gain.as_ref()?;
            Some(means[pair].value())
        });
        self
    }
}

/// Prepares a bundle's kept models.
fn kept_models(
    input: &ComparisonInput<'_>,
    kind: BundleKind,
    representative: &Representative,
) -> Vec<ComparedModel> {
    let mut models = Vec::new();
    for (index, score) in representative.scores.iter().enumerate() {
        if score.is_some() {
            models.push(input.compared(kind, index));
        }
    }
    models
}

/// Accumulator for a geometric mean of gains.
#[derive(Default)]
struct MeanLogarithm {
    sum: f64,
    count: usize,
}

impl MeanLogarithm {
    fn add(&mut self, gain: f64) {
        self.sum += gain.ln();
        self.count += 1;
    }

    fn value(&self) -> f64 {
        (self.sum / self.count as f64).exp()
    }
}
