//! From the models that CT-PBSID proposes to the recommended model (M14.7).

use std::collections::BTreeMap;

use gdcm_model::progress::Shares;

use super::order::OrderSearch;
use super::prepared_data::PreparedData;
use crate::diagnostics::cautions::IdentificationCaution;
use crate::diagnostics::record_fits::fits_of_records;
use crate::identification_error::IdentificationError;
use crate::likelihood::cost::Likelihood;
use crate::likelihood::refinement::{Fit, LEAST_GAIN};
use crate::options::Options;
use crate::subspace::stabilisation::{StabilisationPoint, stabilisation};

/// Maximum number of further steps at the chosen order, after the comparison of orders.
const FURTHER_STEPS: usize = 15;
/// Maximum number of steps after the records were reweighted.
const STEPS_AFTER_REWEIGHING: usize = 3;
/// Maximum ratio of the largest to the smallest cost per degree of freedom at which records keep
/// their weights.
const ALIKE: f64 = 1.5;

/// The models that CT-PBSID proposes.
pub(crate) struct Proposal {
    /// Best Laguerre pole \[rad/s\].
    pub(crate) laguerre_pole: f64,
    /// Best past window.
    pub(crate) past: usize,
    /// Model with the lowest cost at each order.
    pub(crate) starts: BTreeMap<usize, Fit>,
    /// Poles at each order, for the best Laguerre pole and past window.
    pub(crate) stabilisation: Vec<StabilisationPoint>,
}

/// The refined model of the chosen order, and the search for that order.
pub(crate) struct Refinement<'a> {
    /// The orders that were compared.
    pub(crate) search: OrderSearch,
    /// The recommended model.
    pub(crate) fit: Fit,
    /// The model before the reweighting, if the records were reweighted: the minimum of the cost
    /// with the measured noise.
    pub(crate) before_reweighing: Option<Fit>,
    /// The cost that `fit` minimises.
    pub(crate) likelihood: Likelihood<'a>,
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
    let first = OrderSearch::first(&starts, &data.likelihood).ok_or_else(|| data.no_model())?;
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

/// Chooses the order, refines its model further, and reweights the records once if they differ in
/// noise.
pub(crate) fn refine<'a>(
    data: &PreparedData<'a>,
    proposal: &Proposal,
    progress: &Shares,
) -> Result<Refinement<'a>, IdentificationError> {
    progress.next(0.4, "order")?;
    let search = data
        .search_order(&proposal.starts, progress)?
        .ok_or_else(|| data.no_model())?;
    let chosen = search
        .fits
        .get(&search.order)
        .ok_or_else(|| data.no_model())?
        .clone();
    progress.next(0.7, "refinement")?;
    let fit = chosen.refined(&data.likelihood, FURTHER_STEPS, LEAST_GAIN, progress)?;
    let Some(reweighing) = Reweighing::of_unlike_records(&data.likelihood, &fit) else {
        return Ok(Refinement {
            search,
            fit,
            before_reweighing: None,
            likelihood: data.likelihood.clone(),
            caution: None,
        });
    };
    let Reweighing {
        likelihood,
        start,
        ratio,
    } = reweighing;
    let refitted = start.refined(&likelihood, STEPS_AFTER_REWEIGHING, LEAST_GAIN, progress)?;
    Ok(Refinement {
        search,
        fit: refitted,
        before_reweighing: Some(fit),
        likelihood,
        caution: Some(IdentificationCaution::Reweighed(ratio)),
    })
}

/// Records weighted by their cost.
struct Reweighing<'a> {
    likelihood: Likelihood<'a>,
    /// The model at the new weights.
    start: Fit,
    /// Ratio of the largest to the smallest cost per degree of freedom, before the reweighting.
    ratio: f64,
}

impl<'a> Reweighing<'a> {
    /// Reweights records with different noise levels; `None` if the levels are similar.
    ///
    /// ```text
    /// Cv_r <- Cv_r (J_r/dof_r) / geometric mean of J/dof
    /// ```
    fn of_unlike_records(likelihood: &Likelihood<'a>, fit: &Fit) -> Option<Self> {
        let fits = fits_of_records(likelihood, &fit.model, &fit.parts, false);
        let costs: Vec<f64> = fits.iter().map(|record| record.cost).collect();
        let least = costs.iter().copied().fold(f64::INFINITY, f64::min);
        let greatest = costs.iter().copied().fold(0.0, f64::max);
        let are_unlike = least > 0.0 && greatest > ALIKE * least;
        if !are_unlike {
            return None;
        }
        let log_mean = costs.iter().map(|cost| cost.ln()).sum::<f64>() / costs.len() as f64;
        let mean = log_mean.exp();
        let records = likelihood.records();
        let mut segments = Vec::with_capacity(likelihood.segments.len());
        for segment in &likelihood.segments {
            let number = records.iter().position(|record| *record == segment.record);
            let reweighed = match number.and_then(|number| costs.get(number)) {
                Some(cost) => segment.with_noise(cost / mean),
                None => segment.clone(),
            };
            segments.push(reweighed);
        }
        let likelihood = Likelihood::new(segments, likelihood.executor);
        let start = Fit::start(&likelihood, fit.model.clone())?;
        Some(Self {
            likelihood,
            start,
            ratio: greatest / least,
        })
    }
}
