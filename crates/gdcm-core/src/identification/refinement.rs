//! From models that CT-PBSID proposes to the recommended one (M14, section 7).

use super::candidate::{Candidate, SubspaceSettings};
use super::evidence::PreparedData;
use super::identification_caution::IdentificationCaution;
use super::likelihood::Likelihood;
use super::order::{OrderSearch, search_order};
use super::polish::Fit;
use super::record_fit::fits_of_records;
use super::stabilisation::{StabilisationPoint, stabilisation};
use super::steps::Steps;
use super::{IdentificationError, Options, StateSpaceMatrices};
use std::collections::BTreeMap;

/// Steps of the polish for the chosen order, after those of the comparison.
const FURTHER_STEPS: usize = 5;
/// Steps after records were weighed anew.
const STEPS_AFTER_WEIGHING: usize = 3;
/// Greatest over least cost per degree of freedom of records that weigh alike.
const ALIKE: f64 = 1.5;

/// The models that CT-PBSID proposes.
pub(super) struct Proposal {
    /// Best Laguerre pole \[rad/s\].
    pub(super) laguerre_pole: f64,
    /// Best past window.
    pub(super) past: usize,
    /// The cheapest model of each order.
    pub(super) starts: BTreeMap<usize, Fit>,
    /// Poles over orders at the best pole and past window.
    pub(super) stabilisation: Vec<StabilisationPoint>,
}

/// The chosen order, refined.
pub(super) struct Refinement<'a> {
    /// The orders that were compared.
    pub(super) search: OrderSearch,
    /// The recommended model.
    pub(super) fit: Fit,
    /// The cost that it is the minimum of.
    pub(super) likelihood: Likelihood<'a>,
    /// What was done to the weights.
    pub(super) cautions: Vec<IdentificationCaution>,
}

/// Runs CT-PBSID for every pole and past window; shows a first model.
pub(super) fn propose(
    evidence: &PreparedData,
    options: &Options,
    steps: &Steps,
) -> Result<Proposal, IdentificationError> {
    let mut orders = options.orders.clone();
    orders.sort_unstable();
    orders.dedup();
    let settings = SubspaceSettings {
        highest: options.band[1],
        poles: options.poles.iter().map(|pole| pole * options.band[1]).collect(),
        pasts: options.pasts.clone(),
        orders,
    };
    steps.next(0.1, "projections")?;
    let candidates = settings.candidates(&evidence.pieces, &evidence.likelihood, steps)?;
    steps.next(0.3, "models of all orders")?;
    let best = candidates.first().ok_or_else(|| evidence.no_model())?;
    let starts = settings.starts(&candidates, &evidence.likelihood);
    let first = OrderSearch::first(&starts).ok_or_else(|| evidence.no_model())?;
    steps.show(&in_units(evidence, &first.model.matrices()));
    let stabilisation = stabilisation(&settings.poles_by_order(best, evidence.likelihood.executor));
    let &Candidate { pole: laguerre_pole, past, .. } = best;
    Ok(Proposal { laguerre_pole, past, starts, stabilisation })
}

/// Chooses the order and polishes its model further.
pub(super) fn refine<'a>(
    evidence: &PreparedData<'a>,
    proposal: &Proposal,
    steps: &Steps,
) -> Result<Refinement<'a>, IdentificationError> {
    steps.next(0.4, "order")?;
    let search = search_order(&proposal.starts, &evidence.likelihood, &evidence.held_out, steps)?;
    let search = search.ok_or_else(|| evidence.no_model())?;
    let chosen = search.fits.get(&search.order).ok_or_else(|| evidence.no_model())?.clone();
    steps.next(0.7, "refinement")?;
    let fit = chosen.polished(&evidence.likelihood, FURTHER_STEPS, steps)?;
    let (likelihood, fit, cautions) = match reweighed(&evidence.likelihood, &fit, steps)? {
        Some((likelihood, fit, caution)) => (likelihood, fit, vec![caution]),
        None => (evidence.likelihood.clone(), fit, Vec::new()),
    };
    Ok(Refinement { search, fit, likelihood, cautions })
}

/// Weighs records of unlike turbulence by what the model leaves of them, once; none where they are alike.
///
/// ```text
/// Cv_r <- Cv_r (J_r/dof_r) / geometric mean of J/dof
/// ```
fn reweighed<'a>(
    likelihood: &Likelihood<'a>,
    fit: &Fit,
    steps: &Steps,
) -> Result<Option<(Likelihood<'a>, Fit, IdentificationCaution)>, IdentificationError> {
    let costs: Vec<f64> =
        fits_of_records(likelihood, &fit.model, &fit.parts, false).iter().map(|record| record.cost).collect();
    let (least, greatest) = costs.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), cost| (a.min(*cost), b.max(*cost)));
    if !(least > 0.0 && greatest > ALIKE * least) {
        return Ok(None);
    }
    let mean = (costs.iter().map(|cost| cost.ln()).sum::<f64>() / costs.len() as f64).exp();
    let records = likelihood.records();
    let weigh = |piece: &super::likelihood::Lines| {
        let cost = records.iter().position(|record| *record == piece.record).and_then(|k| costs.get(k));
        cost.map_or_else(|| piece.clone(), |cost| piece.with_noise(cost / mean))
    };
    let weighed = Likelihood { pieces: likelihood.pieces.iter().map(weigh).collect(), executor: likelihood.executor };
    let Some(start) = Fit::start(&weighed, fit.model.clone()) else { return Ok(None) };
    let fit = start.polished(&weighed, STEPS_AFTER_WEIGHING, steps)?;
    Ok(Some((weighed, fit, IdentificationCaution::Reweighed { ratio: greatest / least })))
}

/// A model in the units of the records.
pub(super) fn in_units(evidence: &PreparedData, model: &StateSpaceMatrices) -> StateSpaceMatrices {
    model.in_units(&evidence.scales.inputs, &evidence.scales.outputs)
}
