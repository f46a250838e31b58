//! A second start for records with missing inputs (M14.21).
//!
//! ```text
//! 1  the models of all orders refined on the records cut at the gaps: no missing samples to
//!    estimate, but a transient for each piece
//! 2  these as starts on the whole records, refined as usual
//! 3  of both results, the one with the lower V = J + 2 sum ln det C + k' ln N,
//!    k' with half of the transients' states (`counted_parameters`)
//! ```
//!
//! C is the noise covariance from each result's own residuals, and the sum runs over all lines, so
//! V is -2 ln L up to a constant and the penalty of BIC. J alone says nothing: each result
//! minimises it with its own weights.

use std::collections::BTreeMap;

use gdcm_model::progress::Shares;

use super::model_selection::{Proposal, Refinement, refine_from};
use super::order::counted_parameters;
use super::prepared_data::PreparedData;
use crate::identification_error::IdentificationError;
use crate::likelihood::cost::Likelihood;
use crate::likelihood::descent::{COMPARABLE, Fit};

/// Refines the proposed models. With missing inputs there are two starts, and the result with the
/// lower V is returned; errors from the second start are ignored, but not a cancellation.
pub(crate) fn refine<'a>(
    data: &PreparedData<'a>,
    proposal: &Proposal,
    progress: &Shares,
) -> Result<Refinement<'a>, IdentificationError> {
    let first = refine_from(data, &proposal.starts, progress)?;
    let Some(starts) = starts_from_pieces(data, proposal, progress)? else {
        return Ok(first);
    };
    // Steps 2 and 3.
    match refine_from(data, &starts, progress) {
        Ok(second) if deviance(&second) < deviance(&first) => Ok(second),
        Err(IdentificationError::Stopped(stopped)) => Err(stopped.into()),
        _ => Ok(first),
    }
}

/// Returns the models refined on the records cut at the gaps (step 1); `None` if no input misses
/// samples, or no model is left.
pub(super) fn starts_from_pieces(
    data: &PreparedData,
    proposal: &Proposal,
    progress: &Shares,
) -> Result<Option<BTreeMap<usize, Fit>>, IdentificationError> {
    let Some(pieces) = data.cut_at_missing_inputs() else {
        return Ok(None);
    };
    let proposed = evaluated(proposal.starts.values(), &pieces.likelihood);
    let Some(search) = pieces.search_order(&proposed, progress)? else {
        return Ok(None);
    };
    let converged = search
        .fits
        .values()
        .filter(|fit| fit.decrement < COMPARABLE);
    let starts = evaluated(converged, &data.likelihood);
    if starts.is_empty() {
        return Ok(None);
    }
    Ok(Some(starts))
}

/// Computes the models' costs over other lines; models without a finite cost are left out.
fn evaluated<'f>(
    fits: impl IntoIterator<Item = &'f Fit>,
    likelihood: &Likelihood,
) -> BTreeMap<usize, Fit> {
    let mut starts = BTreeMap::new();
    for fit in fits {
        if let Some(start) = Fit::start(likelihood, fit.model.clone()) {
            starts.insert(start.order(), start);
        }
    }
    starts
}

/// Computes V (step 3).
pub(super) fn deviance(refinement: &Refinement) -> f64 {
    let fit = &refinement.fit;
    let likelihood = &refinement.weights.likelihood;
    let k = counted_parameters(&fit.model, likelihood);
    let n = likelihood.freedom(fit.order()) as f64;
    let mut log_determinants = 0.0;
    for segment in &likelihood.segments {
        for weight in &segment.weights {
            // W is lower triangular, W^-1 W^-H = C / 2.
            let logs = weight.diagonal().map(|entry| entry.norm().ln());
            log_determinants -= 2.0 * logs.sum();
        }
    }
    fit.cost + 2.0 * log_determinants + k * n.ln()
}
