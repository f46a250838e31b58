//! Selects the recommended model from those that CT-PBSID proposes (M14.7).
//!
//! CT-PBSID (`subspace`) proposes models for pairs of a Laguerre pole and a past window
//! (`candidates`). A record's *noise factor* multiplies its noise power, so that records with
//! unlike noise are weighed by their own (`noise_weights`). A *start* is a model with its cost,
//! from which a descent begins (`descent`).

use std::collections::BTreeMap;

use gdcm_model::progress::Shares;

use super::noise_weights::NoiseWeights;
use super::order::OrderSearch;
use super::prepared_data::PreparedData;
use crate::diagnostics::cautions::IdentificationCaution;
use crate::identification_error::IdentificationError;
use crate::likelihood::descent::{CONVERGED, Fit, Limits};
use crate::likelihood::schur_model::SchurModel;
use crate::options::Options;
use crate::subspace::stabilisation::{StabilisationPoint, stabilisation};

/// The models that CT-PBSID proposes.
pub(crate) struct Proposal {
    /// Laguerre pole of the model with the lowest cost \[rad/s\].
    pub(crate) laguerre_pole: f64,
    /// Past window of the model with the lowest cost \[Laguerre projections\].
    pub(crate) past: usize,
    /// Model with the lowest cost at each order.
    pub(crate) starts: BTreeMap<usize, Fit>,
    /// Poles at each order, for `laguerre_pole` and `past`.
    pub(crate) stabilisation: Vec<StabilisationPoint>,
}

impl Proposal {
    /// Returns the unrefined model with `order` states, else that of the next lower order, else
    /// that of the lowest.
    pub(crate) fn unrefined(&self, order: usize) -> Option<&Fit> {
        let lower = self.starts.range(..=order).next_back();
        let nearest = lower.or_else(|| self.starts.iter().next());
        nearest.map(|(_, fit)| fit)
    }
}

/// The refined model at the chosen order, and the search for that order.
pub(crate) struct Refinement<'a> {
    pub(crate) search: OrderSearch<'a>,
    /// Models of the nearest orders whose BIC is within 10 % of the chosen order's.
    pub(crate) neighbours: Vec<SchurModel>,
    /// The recommended model.
    pub(crate) fit: Fit,
    /// The model refined without the records' own noise factors; `None` if no record was
    /// reweighted.
    pub(crate) before_reweighing: Option<Fit>,
    /// The weights for which `fit` was refined.
    pub(crate) weights: NoiseWeights<'a>,
    /// Caution about the changed weights.
    pub(crate) caution: Option<IdentificationCaution>,
}

/// Runs CT-PBSID for every Laguerre pole and past window, and reports a first model to `progress`.
pub(crate) fn propose(
    data: &PreparedData,
    options: &Options,
    progress: &Shares,
) -> Result<Proposal, IdentificationError> {
    let settings = data.subspace_settings(options);
    progress.next(0.1, "projections")?;
    let candidates = settings.candidates(&data.segments, &data.likelihood, progress)?;
    progress.next(0.3, "models of all orders")?;
    let best = candidates.first().ok_or_else(|| data.no_model())?;
    let starts = settings.starts(&candidates, &data.likelihood);
    let first = OrderSearch::first(&starts, &data.likelihood)
        .and_then(|order| starts.get(&order))
        .ok_or_else(|| data.no_model())?;
    if let Some(first) = data.in_units(&first.model) {
        progress.progress().first_model(&first);
    }
    let poles_by_order = settings.poles_by_order(best, data.likelihood.executor);
    Ok(Proposal {
        laguerre_pole: best.pole,
        past: best.past,
        starts,
        stabilisation: stabilisation(&poles_by_order),
    })
}

/// Chooses the order and refines its model.
///
/// ```text
/// 1  the order, with its model (`order`)
/// 2  weights from its residuals over all records, with noise factors if records are unlike
/// 3  descent to the minimum of the cost with these weights
/// 4  with noise factors: also to the minimum without them, where the records are compared
/// ```
pub(crate) fn refine_from<'a>(
    data: &PreparedData<'a>,
    starts: &BTreeMap<usize, Fit>,
    progress: &Shares,
) -> Result<Refinement<'a>, IdentificationError> {
    // Step 1.
    progress.next(0.4, "order")?;
    let search = data
        .search_order(starts, progress)?
        .ok_or_else(|| data.no_model())?;
    let chosen = search
        .fits
        .get(&search.order)
        .ok_or_else(|| data.no_model())?
        .clone();
    // Step 2. The search may have used a part of the records only, so that the model is evaluated
    // over all of them before its residuals give the new weights.
    progress.next(0.7, "refinement")?;
    let search_weights = search
        .weights
        .over_all_records(data)
        .ok_or_else(|| data.no_model())?;
    let over_all_records =
        Fit::start(&search_weights.likelihood, chosen.model).ok_or_else(|| data.no_model())?;
    let weights = search_weights
        .updated(data, &over_all_records)
        .ok_or_else(|| data.no_model())?;
    // Step 3.
    let start =
        Fit::start(&weights.likelihood, over_all_records.model).ok_or_else(|| data.no_model())?;
    let fit = start.descended(&weights.likelihood, Limits::to(CONVERGED), progress)?;
    // Step 4.
    let before_reweighing = match weights.ratio {
        Some(_) => {
            let start = Fit::start(&weights.without_factors, fit.model.clone())
                .ok_or_else(|| data.no_model())?;
            Some(start.descended(&weights.without_factors, Limits::to(CONVERGED), progress)?)
        }
        None => None,
    };
    Ok(Refinement {
        neighbours: search.neighbours(),
        fit,
        before_reweighing,
        caution: weights.ratio.map(IdentificationCaution::Reweighed),
        search,
        weights,
    })
}
