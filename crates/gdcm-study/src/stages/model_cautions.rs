//! Cautions about the models alone: responses that cannot be computed or compared in the band, and
//! channels assigned by position because the files do not name them. Cautions about the two models
//! that are compared are in `comparison_cautions`.

use gdcm_method::fidelity::distance::MeasuredPairs;
use gdcm_model::dataset::{BundleKind, Condition, ConditionId, Dynamics, Pair};
use gdcm_model::progress::Cancelled;
use gdcm_model::response::PolarResponse;

use super::bundle_metrics::ComparableBundle;
use super::condition_responses::ConditionResponses;
use crate::decisions::choices::{BundleChoice, ConditionChoice};
use crate::decisions::study::Study;
use crate::execution::Execution;
use crate::results::caution::{BundleModel, Caution, GainOutOfRange, NotFinite};

/// A condition's bundle and the data from which its cautions are derived.
pub(crate) struct BundleCautions<'a> {
    pub(crate) condition: &'a Condition,
    pub(crate) kind: BundleKind,
    pub(crate) choice: &'a BundleChoice,
    pub(crate) responses: &'a ConditionResponses,
    /// The pairs in which the bundle's models are compared, and those that each model lacks.
    pub(crate) pairs: &'a MeasuredPairs,
    /// The band's upper end \[rad/s\].
    pub(crate) band_top: f64,
}

impl BundleCautions<'_> {
    /// Returns the cautions about the models that are not rejected: first model by model, then
    /// about channels assigned by position.
    pub(crate) fn find(&self) -> Vec<Caution> {
        let mut cautions = Vec::new();
        for index in 0..self.condition.bundle(self.kind).len() {
            self.add_of_model(index, &mut cautions);
        }
        cautions.extend(self.channels_by_position());
        cautions
    }

    /// Adds the cautions about a model that is not rejected:
    ///
    /// 1. if it is a measured response: responses that are zero at all measured frequencies, except
    ///    those in 2;
    /// 2. if it lacks responses that another model of the bundle has: it is set aside (M5b);
    /// 3. otherwise: responses that are not finite in the band.
    fn add_of_model(&self, index: usize, cautions: &mut Vec<Caution>) {
        let model = &self.condition.bundle(self.kind)[index];
        if self.choice.rejected.contains(&model.name) {
            return;
        }
        let bundle_model = BundleModel::new(self.condition, self.kind, index);
        let response = &self.responses.bundle(self.kind)[index];
        let zero = response.zero_where_finite();
        let lacking = self.pairs.lacks[index].clone();
        // A response that is zero at all measured frequencies is absent: it would not be added by a
        // wider measurement.
        let mut not_finite = response.not_finite();
        not_finite.retain(|pair| !zero.contains(pair));
        // Case 1.
        if matches!(model.dynamics, Dynamics::Measured(_)) {
            let missing: Vec<Pair> = zero
                .iter()
                .copied()
                .filter(|pair| !lacking.contains(pair))
                .collect();
            if !missing.is_empty() {
                cautions.push(Caution::MissingResponses {
                    model: bundle_model.clone(),
                    responses: missing,
                });
            }
        }
        // Cases 2 and 3.
        let why = NotFinite::new(&model.dynamics, self.band_top);
        if !lacking.is_empty() {
            let is_not_finite = lacking.iter().any(|pair| not_finite.contains(pair));
            cautions.push(Caution::SetAside {
                model: bundle_model,
                zero: lacking
                    .iter()
                    .copied()
                    .filter(|pair| zero.contains(pair))
                    .collect(),
                why: if is_not_finite { Some(why) } else { None },
                lacks: lacking,
                pinned: self.choice.pinned.as_ref() == Some(&model.name),
            });
        } else if !not_finite.is_empty() {
            cautions.push(Caution::NotFinite {
                model: bundle_model,
                responses: not_finite,
                why,
            });
        }
    }

    /// Returns the caution about kept models whose channels were assigned by position; `None`
    /// without such models.
    fn channels_by_position(&self) -> Option<Caution> {
        let mut models = Vec::new();
        for model in self.condition.bundle(self.kind) {
            let is_by_position = model
                .source
                .as_ref()
                .is_some_and(|source| !source.by_position.is_empty());
            if is_by_position && !self.choice.rejected.contains(&model.name) {
                models.push(model.name.clone());
            }
        }
        if models.is_empty() {
            return None;
        }
        Some(Caution::ChannelsByPosition {
            bundle: self.kind,
            models,
        })
    }
}

/// Returns the cautions about the models and about gains outside the computable range, condition by
/// condition, in the study's band.
///
/// # Errors
/// [`Cancelled`] where `execution` is cancelled.
pub fn cautions_of_models(
    study: &Study,
    execution: &Execution<'_>,
) -> Result<Vec<(ConditionId, Caution)>, Cancelled> {
    let band = study.settings.band;
    let measuring = study.dataset.measuring_pairs();
    let mut found = Vec::new();
    for condition in study.dataset.conditions() {
        let id = condition.id();
        let choice = study.choice(id);
        let responses =
            ConditionResponses::compute(condition, (band, study.settings.points), execution)?;
        for kind in BundleKind::BOTH {
            let bundle = ComparableBundle::new(responses.bundle(kind), &measuring, execution)?;
            let cautions = BundleCautions {
                condition,
                kind,
                choice: choice.bundle(kind),
                responses: &responses,
                pairs: &bundle.pairs,
                band_top: band.max(),
            };
            for caution in cautions.find() {
                found.push((id, caution));
            }
        }
        if let Some(caution) = gains_out_of_range(condition, &responses, choice) {
            found.push((id, caution));
        }
    }
    Ok(found)
}

/// Returns the gains outside the computable range between the nominal physics model and the first
/// kept identified model that has any.
fn gains_out_of_range(
    condition: &Condition,
    responses: &ConditionResponses,
    choice: &ConditionChoice,
) -> Option<Caution> {
    let nominal = condition.nominal();
    let physics = PolarResponse::new(&responses.bundle(BundleKind::Physics)[nominal]);
    let models = condition.bundle(BundleKind::Identified);
    for (model, response) in models.iter().zip(responses.bundle(BundleKind::Identified)) {
        if choice.identified.rejected.contains(&model.name) {
            continue;
        }
        let responses = GainOutOfRange::of_models(&physics, &PolarResponse::new(response));
        if !responses.is_empty() {
            return Some(Caution::GainsOutOfRange {
                physics: condition.bundle(BundleKind::Physics)[nominal].name.clone(),
                identified: model.name.clone(),
                responses,
            });
        }
    }
    None
}
