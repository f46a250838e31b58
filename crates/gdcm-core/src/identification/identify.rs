//! The identification of one flight condition from its records.

use super::evidence::PreparedData;
use super::identification_error::{HIGHEST_ORDER, LONGEST_PAST};
use super::refinement::{propose, refine};
use super::report::report;
use super::steps::Steps;
use super::{FlightRecord, Identification, IdentificationError, Options, Watch};
use crate::executor::Executor;

/// Identifies one flight condition from its records (M14, section 7).
///
/// ```text
/// 1  pieces of the records, scales, spectra, measured response, covariance of the noise                10 %
/// 2  CT-PBSID for each Laguerre pole and past window; models of all orders from the best two           40 %
/// 3  order by BIC of polished models; the chosen one polished further, records weighed by their noise  80 %
/// 4  covariance, bands, bundle, validation                                                            100 %
/// ```
///
/// The same to the last bit whoever carries out its pieces. A first model is shown to `watch` after step 2.
///
/// # Errors
/// Records that cannot be prepared, a band that they do not show, settings out of range, channels that depend on each other,
/// records too short for a model; or `watch` stopped it.
pub fn identify(
    records: &[FlightRecord],
    options: &Options,
    executor: &dyn Executor,
    watch: &dyn Watch,
) -> Result<Identification, IdentificationError> {
    check(options)?;
    let steps = Steps::new(watch);
    steps.next(0.0, "records")?;
    let evidence = PreparedData::new(records, options, executor, &steps)?;
    let proposal = propose(&evidence, options, &steps)?;
    let refinement = refine(&evidence, &proposal, &steps)?;
    report(records, options, &evidence, proposal, &refinement, &steps)
}

fn check(options: &Options) -> Result<(), IdentificationError> {
    let [lowest, highest] = options.band;
    if !(lowest.is_finite() && highest.is_finite() && 0.0 < lowest && lowest < highest) {
        return Err(IdentificationError::Band { lowest, highest });
    }
    let some = !options.orders.is_empty() && !options.poles.is_empty() && !options.pasts.is_empty();
    let orders = options.orders.iter().all(|order| (1..=HIGHEST_ORDER).contains(order));
    let pasts = options.pasts.iter().all(|past| (1..=LONGEST_PAST).contains(past));
    let poles = options.poles.iter().all(|pole| pole.is_finite() && *pole > 0.0);
    if some && orders && pasts && poles { Ok(()) } else { Err(IdentificationError::Settings) }
}
