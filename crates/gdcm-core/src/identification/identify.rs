//! The identification of one flight condition from its records.

use super::*;
use crate::executor::Executor;
use std::sync::{Mutex, PoisonError};

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

// What was identified from the records of a flight condition.

/// Where a model comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// The recommended one: CT-PBSID, refined.
    Refined,
    /// CT-PBSID as it is, of the same order.
    Plain,
    /// Refined, of the order two less or more.
    Neighbour,
    /// Refined without the record of this number, counted from 0.
    WithoutRecord(usize),
}

/// An identified model in the units of the records.
#[derive(Clone, Debug, PartialEq)]
pub struct IdentifiedModel {
    /// Its name, for people.
    pub name: String,
    /// Where it comes from.
    pub origin: Origin,
    /// The model.
    pub matrices: StateSpaceMatrices,
}

/// What was identified from the records of a flight condition, in the units of the records.
#[derive(Clone, Debug, PartialEq)]
pub struct Identification {
    /// The recommended model.
    pub refined: IdentifiedModel,
    /// CT-PBSID without refinement, of the same order.
    pub plain: IdentifiedModel,
    /// The bundle around the recommended model: the neighbouring orders, then without each record.
    pub bundle: Vec<IdentifiedModel>,
    /// Standard deviations of the recommended model's response.
    pub bands: Bands,
    /// The response measured without a model.
    pub measured: MeasuredResponse,
    /// Poles of the recommended model.
    pub poles: Vec<PoleEstimate>,
    /// Poles of the unrefined models of all orders at the best Laguerre pole and past window.
    pub stabilisation: Vec<StabilisationPoint>,
    /// Best Laguerre pole \[rad/s\].
    pub laguerre_pole: f64,
    /// Best past window.
    pub past: usize,
    /// BIC of every order that was refined, ascending.
    pub criteria: Vec<(usize, f64)>,
    /// `J` per degree of freedom over the records of the fit; 1 is adequate.
    pub cost: f64,
    /// The same over the held-out records, where there are any.
    pub held_out_cost: Option<f64>,
    /// The same of every record that was used, in the order of the records.
    pub record_fits: Vec<RecordFit>,
    /// The same of every output, over the records of the fit.
    pub output_costs: Vec<f64>,
    /// The recommended model against the held-out records in time.
    pub validation: Option<Validation>,
    /// What was used of every record.
    pub record_uses: Vec<RecordUse>,
    /// Output and input of the responses with a standard deviation over 3 dB in the middle of the band.
    pub not_identified: Vec<(usize, usize)>,
    /// What the engineer should know.
    pub cautions: Vec<IdentificationCaution>,
}

// What is said of the recommended model (M14, sections 5 and 6).

/// Points of the bands.
const BAND_POINTS: usize = 60;
/// Upper end of the band that is offered where the highest order is not enough, over the present one.
const NARROWER: f64 = 0.7;
/// Standard deviation \[dB\] above which a response is not identified.
const NOT_IDENTIFIED: f64 = 3.0;

/// Uncertainty, bundle and validation of the recommended model.
pub(super) fn report(
    records: &[FlightRecord],
    options: &Options,
    evidence: &PreparedData,
    proposal: Proposal,
    refinement: &Refinement,
    steps: &Steps,
) -> Result<Identification, IdentificationError> {
    steps.next(0.8, "uncertainty")?;
    let Refinement { search, fit, likelihood, .. } = refinement;
    let executor = likelihood.executor;
    let systems = fit.systems(likelihood).ok_or_else(|| evidence.no_model())?;
    let freedom = likelihood.freedom(fit.model.order());
    let spare =
        freedom.checked_sub(effective_parameters(fit)).filter(|spare| *spare > 0).ok_or_else(|| evidence.no_model())?;
    let mut system = NormalSystem::zero(fit.model.parameters());
    systems.iter().for_each(|part| system.add(part));
    let covariance = ParameterCovariance::new(&system, fit.cost / spare as f64).ok_or_else(|| evidence.no_model())?;
    let neighbours = search.neighbours();
    let omegas = log_spaced(options.band[0], options.band[1], BAND_POINTS);
    let bands = covariance.bands(&fit.model, &neighbours, &omegas, executor);
    let not_identified = not_identified(&bands);

    steps.next(0.88, "models without each record")?;
    let without = without_each_record(likelihood, fit, &systems);
    steps.next(0.93, "validation")?;
    let parts = evidence.likelihood.parts(&fit.model).ok_or_else(|| evidence.no_model())?;
    let held_out_parts = evidence.held_out.parts(&fit.model).ok_or_else(|| evidence.no_model())?;
    let mut record_fits = fits_of_records(&evidence.likelihood, &fit.model, &parts, false);
    let cost = mean_cost(&record_fits).ok_or_else(|| evidence.no_model())?;
    let held_out_fits = fits_of_records(&evidence.held_out, &fit.model, &held_out_parts, true);
    let held_out_cost = mean_cost(&held_out_fits);
    record_fits.extend(held_out_fits);
    record_fits.sort_by_key(|fit| fit.record);
    let output_costs = output_costs(&evidence.likelihood, &fit.model, &parts);
    let examination = Diagnostics { records, options, evidence, fit, without: &without };
    let mut cautions = evidence.cautions.clone();
    cautions.extend(refinement.cautions.iter().cloned());
    cautions.extend(examination.adequacy(cost, held_out_cost, &record_fits, &output_costs));
    cautions.extend(examination.decisive_records(&omegas, &not_identified));
    cautions.extend(examination.late_channel(&record_fits));
    if search.still_falls {
        let narrower = [options.band[0], NARROWER * options.band[1]];
        cautions.push(IdentificationCaution::OrderLimit { order: search.order, narrower });
    }
    cautions.extend(examination.unidentified_pairs(&not_identified));

    let named = |name: String, origin: Origin, model: &BlockModel| IdentifiedModel {
        name,
        origin,
        matrices: in_units(evidence, &model.matrices()),
    };
    let refined = |model: &BlockModel| format!("CT-PBSID, refined, order {}", model.order());
    let main = named(refined(&fit.model), Origin::Refined, &fit.model);
    let validation = match evidence.held_out_pieces.as_slice() {
        [] => None,
        pieces => {
            let validation =
                validate(&main.matrices, pieces, &ValidationSettings::filtered(options.highest()), executor);
            validation.map_err(|why| cautions.push(IdentificationCaution::NotValidated { why })).ok()
        }
    };
    let mut bundle: Vec<_> = neighbours.iter().map(|model| named(refined(model), Origin::Neighbour, model)).collect();
    bundle.extend(without.iter().map(|one: &WithoutRecord| {
        let name = format!("CT-PBSID, refined, without {}", examination.record_name(one.record));
        named(name, Origin::WithoutRecord(one.record), &one.model)
    }));
    let plain = &proposal.starts.get(&search.order).ok_or_else(|| evidence.no_model())?.model;
    let poles = covariance.poles(&fit.model, options.band[0]);
    steps.next(1.0, "done")?;
    Ok(Identification {
        refined: main,
        plain: named(format!("CT-PBSID, order {}", plain.order()), Origin::Plain, plain),
        bundle,
        bands,
        measured: evidence.measured.in_units(&evidence.scales),
        poles,
        stabilisation: proposal.stabilisation,
        laguerre_pole: proposal.laguerre_pole,
        past: proposal.past,
        criteria: search.criteria.iter().map(|(order, value)| (*order, *value)).collect(),
        cost,
        held_out_cost,
        record_fits,
        output_costs,
        validation,
        record_uses: evidence.record_uses.clone(),
        not_identified,
        cautions,
    })
}

/// Output and input of the responses that are known too badly in the middle of the band.
fn not_identified(bands: &Bands) -> Vec<(usize, usize)> {
    let Some(middle) = bands.sd_db.get(bands.sd_db.len() / 2) else { return Vec::new() };
    let pairs = (0..middle.len()).map(|at| (at % middle.nrows(), at / middle.nrows()));
    pairs.filter(|pair| middle[*pair] > NOT_IDENTIFIED).collect()
}

// How far a long computation is.

/// Tells a [`Watch`] of every step, never backwards, and stops between two of them.
pub(super) struct Steps<'a> {
    watch: &'a dyn Watch,
    done: Mutex<f64>,
}

impl<'a> Steps<'a> {
    pub(super) fn new(watch: &'a dyn Watch) -> Self {
        Self { watch, done: Mutex::new(0.0) }
    }

    /// The next step, with `done` (0 to 1) of the whole done before it.
    pub(super) fn next(&self, done: f64, what: &str) -> Result<(), IdentificationError> {
        let mut last = self.done.lock().unwrap_or_else(PoisonError::into_inner);
        self.tell(&mut last, done, what)
    }

    /// A step of `share` of the whole, for work of which steps end in any order.
    pub(super) fn advance(&self, share: f64, what: &str) -> Result<(), IdentificationError> {
        let mut last = self.done.lock().unwrap_or_else(PoisonError::into_inner);
        let done = *last + share;
        self.tell(&mut last, done, what)
    }

    /// Shows the first model, in the units of the records.
    pub(super) fn show(&self, model: &StateSpaceMatrices) {
        self.watch.first_model(model);
    }

    /// Whether the work was stopped.
    pub(super) fn is_stopped(&self) -> bool {
        self.watch.is_stopped()
    }

    fn tell(&self, last: &mut f64, done: f64, what: &str) -> Result<(), IdentificationError> {
        if self.is_stopped() {
            return Err(IdentificationError::Stopped);
        }
        *last = last.max(done.min(1.0));
        self.watch.progress(*last, what);
        Ok(())
    }
}

// Who watches a long computation: hears how far it is, and may stop it.

/// Hears how far a computation is, and may stop it between two steps.
pub trait Watch: Sync {
    /// `done` (0 to 1) of the work is done; the next step is `what`.
    fn progress(&self, done: f64, what: &str);
    /// Whether the computation is to stop.
    fn is_stopped(&self) -> bool;
    /// A first model is there, in the units of the records; a better one follows.
    fn first_model(&self, _model: &StateSpaceMatrices) {}
}

/// Nobody watches: progress is not told, and nothing stops.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unwatched;

impl Watch for Unwatched {
    fn progress(&self, _done: f64, _what: &str) {}

    fn is_stopped(&self) -> bool {
        false
    }
}
