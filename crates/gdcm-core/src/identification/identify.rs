//! The identification of one flight condition from its records, and what is said of the recommended model (M14, sections 5 to 7).

use super::*;
use crate::dataset::{Dynamics, Model, ModelBands, Origin, Provenance};
use crate::executor::Executor;
use std::sync::Arc;

/// Methods, as models carry them and as their names begin (M14).
const REFINED: &str = "CT-PBSID, refined";
const UNREFINED: &str = "CT-PBSID";
/// Points of the bands.
const BAND_POINTS: usize = 60;
/// Upper end of the band that is offered where the highest order is not enough, over the present one.
const NARROWER: f64 = 0.7;
/// Standard deviation \[dB\] above which a response is not identified.
const NOT_IDENTIFIED: f64 = 3.0;

/// What was identified from the records of a flight condition, in the units of the records.
#[derive(Clone, Debug, PartialEq)]
pub struct Identification {
    /// The recommended model: CT-PBSID, refined, with the standard deviations of its response.
    pub refined: Model,
    /// CT-PBSID without refinement, of the same order.
    pub unrefined: Model,
    /// The bundle around the recommended model: the orders two less and two more, then without each record.
    pub bundle: Vec<Model>,
    /// The response estimated without a model.
    pub measured: ResponseEstimate,
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
    /// `J / (N - k)` over the records of the fit, per degree of freedom that the parameters leave; 1 is adequate.
    pub cost: f64,
    /// The same over the held-out records, where there are any.
    pub held_out_cost: Option<f64>,
    /// The same where the model may move within its own uncertainty: up to 1.3 good, above 2 not predicted (M14.17).
    pub held_out_normalised: Option<f64>,
    /// How much of the measured response was fed back (M14.14).
    pub feedback: Option<Feedback>,
    /// How far each record of the fit wants another model than the others; empty for one record (M14.16).
    pub contrasts: Vec<RecordContrast>,
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

/// Identifies one flight condition from its records (M14, section 7).
///
/// ```text
/// 1  segments of the records, scales, spectra, measured response, covariance of the noise                10 %
/// 2  CT-PBSID for each Laguerre pole and past window; models of all orders from the best two           40 %
/// 3  order by BIC of refined models; the chosen one refined further, records weighed by their noise  80 %
/// 4  covariance, bands, bundle, validation                                                            100 %
/// ```
///
/// The same to the last bit whoever carries out its pieces. `progress` is told a first model after step 2.
///
/// # Errors
/// Records that cannot be prepared, a band that they do not show, settings out of range, channels that depend on each other,
/// records too short for a model; or `progress` is cancelled.
pub fn identify(
    records: &[FlightRecord],
    options: &Options,
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<Identification, IdentificationError> {
    check(options)?;
    let progress = Shares::new(progress);
    progress.next(0.0, "records")?;
    let data = PreparedData::new(records, options, executor, &progress)?;
    let proposal = propose(&data, options, &progress)?;
    let refinement = refine(&data, &proposal, &progress)?;
    report(records, options, &data, proposal, &refinement, &progress)
}

fn check(options: &Options) -> Result<(), IdentificationError> {
    let [lowest, highest] = options.band;
    if !(lowest.is_finite() && highest.is_finite() && 0.0 < lowest && lowest < highest) {
        return Err(IdentificationError::Band { lowest, highest });
    }
    if options.inputs() == 0 && options.references > 0 {
        return Err(IdentificationError::OnlyReferences);
    }
    let within = |list: &Option<Vec<usize>>, most: usize| {
        list.as_ref().is_none_or(|list| !list.is_empty() && list.iter().all(|value| (1..=most).contains(value)))
    };
    let poles = !options.poles.is_empty() && options.poles.iter().all(|pole| pole.is_finite() && *pole > 0.0);
    let right = within(&options.orders, HIGHEST_ORDER) && within(&options.pasts, LONGEST_PAST) && poles;
    if right { Ok(()) } else { Err(IdentificationError::Settings) }
}

/// Uncertainty, bundle and validation of the recommended model.
fn report(
    records: &[FlightRecord],
    options: &Options,
    data: &PreparedData,
    proposal: Proposal,
    refinement: &Refinement,
    progress: &Shares,
) -> Result<Identification, IdentificationError> {
    let no_model = || data.no_model();
    progress.next(0.8, "uncertainty")?;
    let Refinement { search, fit, likelihood, .. } = refinement;
    let executor = likelihood.executor;
    let systems = fit.systems(likelihood).ok_or_else(no_model)?;
    let covariance = ParameterCovariance::of(likelihood, fit, &systems, fit.cost).ok_or_else(no_model)?;
    // By way of a reference the cost says nothing: what is known is what the lines as logged tell of this model (M14.15).
    let logged = match &data.direct {
        Some(direct) => Some(ParameterCovariance::of_lines(direct, fit).ok_or_else(no_model)?),
        None => None,
    };
    let known = logged.as_ref().unwrap_or(&covariance);
    // By way of a reference nothing is fed back, and every record is seen as the same reference shows it.
    let is_direct = options.references == 0;
    // Of inputs that were moved only together nothing tells what is fed back.
    let is_told = is_direct && !data.cautions.iter().any(IdentificationCaution::is_of_collinear_inputs);
    let feedback = Some(()).filter(|()| is_told).and_then(|()| Feedback::of(data, &fit.model, options.band, executor));
    let neighbours = search.neighbours();
    let omegas = log_spaced(options.band[0], options.band[1], BAND_POINTS);
    let bands = known.bands(&fit.model, &neighbours, feedback.as_ref(), &omegas, executor).ok_or_else(no_model)?;
    let bands = if is_direct { bands } else { data.measured.widened(&bands).ok_or_else(no_model)? };
    let not_identified = not_identified(&bands);

    progress.next(0.88, "models without each record")?;
    let without = without_each_record(likelihood, fit, &systems);
    progress.next(0.93, "validation")?;
    let fits = RecordFits::of(data, &fit.model, &covariance).ok_or_else(no_model)?;
    let diagnostics = Diagnostics { records, options, data, fit };
    let mut cautions = data.cautions.clone();
    cautions.extend(refinement.cautions.iter().cloned());
    let level = feedback.as_ref().map_or(FeedbackLevel::None, Feedback::level);
    cautions.extend(feedback.as_ref().filter(|_| level > FeedbackLevel::None).map(|of| {
        let (share, significance) = (of.share, of.significance);
        IdentificationCaution::Feedback { level, share, significance }
    }));
    let mut contrasts = Vec::new();
    if is_direct {
        cautions.extend(diagnostics.adequacy(&fits));
        let first = refinement.before_weighing.as_ref().unwrap_or(fit);
        let of_records = RecordContrasts::of(&data.likelihood, &data.spectra, first).ok_or_else(no_model)?;
        let contradiction = of_records.caution(level > FeedbackLevel::None, &diagnostics);
        cautions.retain(|of| contradiction.as_ref().is_none_or(|why| !why.explains(of)));
        cautions.extend(contradiction);
        contrasts = of_records.contrasts;
    }
    cautions.extend(diagnostics.departures());
    if search.still_falls {
        let narrower = [options.band[0], NARROWER * options.band[1]];
        cautions.push(IdentificationCaution::OrderLimit { order: search.order, narrower });
    }
    cautions.extend(diagnostics.unidentified_pairs(&not_identified));
    let unstable = fast_unstable_pole(&fit.model, options.highest());
    cautions.extend(unstable.map(|pole| IdentificationCaution::Unstable { pole, highest: options.highest() }));

    let unrefined = &proposal.starts.get(&search.order).ok_or_else(no_model)?.model;
    let model = |name: String, method: &str, model: &BlockModel, without: Option<usize>| {
        let dynamics = Dynamics::StateSpace(data.in_units(model)?);
        let origin = Origin::Identified { method: Some(method.to_owned()), order: Some(model.order()) };
        let source = Some(Provenance { records: options.fitted(records, without), ..Provenance::default() });
        Some(Model { source, ..Model::new(name, origin, dynamics) })
    };
    let of_order = |method: &str, of: &BlockModel| model(format!("{method}, order {}", of.order()), method, of, None);
    let mut refined = of_order(REFINED, &fit.model).ok_or_else(no_model)?;
    refined.bands = Some(Arc::new(bands));
    let mut bundle: Vec<Model> = neighbours.iter().filter_map(|of| of_order(REFINED, of)).collect();
    bundle.extend(without.iter().filter_map(|one| {
        let name = format!("{REFINED}, without {}", diagnostics.record_name(one.record));
        model(name, REFINED, &one.model, Some(one.record))
    }));
    let validation = match data.held_out_segments.as_slice() {
        [] => None,
        // An unstable pole that no line shows would end the windows after a few samples.
        _ if unstable.is_some() => None,
        segments => {
            let settings = ValidationSettings::filtered(options.highest());
            let model = data.in_units(&fit.model).ok_or_else(no_model)?;
            let validation = validate(&model, segments, &settings, executor);
            validation.map_err(|why| cautions.push(IdentificationCaution::NotValidated { why })).ok()
        }
    };
    progress.next(1.0, "done")?;
    Ok(Identification {
        refined,
        unrefined: of_order(UNREFINED, unrefined).ok_or_else(no_model)?,
        bundle,
        measured: data.measured.in_units(&data.scales),
        poles: known.poles(&fit.model, options.band[0]),
        stabilisation: proposal.stabilisation,
        laguerre_pole: proposal.laguerre_pole,
        past: proposal.past,
        criteria: search.criteria.iter().map(|(order, value)| (*order, *value)).collect(),
        cost: fits.cost,
        held_out_cost: fits.held_out.map(|(raw, _)| raw),
        held_out_normalised: fits.held_out.map(|(_, normalised)| normalised),
        feedback,
        contrasts,
        record_fits: fits.records,
        output_costs: fits.outputs,
        validation,
        record_uses: data.record_uses.clone(),
        not_identified,
        cautions,
    })
}

/// Output and input of the responses that are known too badly in the middle of the band.
fn not_identified(bands: &ModelBands) -> Vec<(usize, usize)> {
    let (outputs, inputs) = (bands.sd_db().outputs(), bands.sd_db().inputs());
    let pairs = (0..inputs).flat_map(|input| (0..outputs).map(move |output| Pair { output, input }));
    let is_wide = |pair: &Pair| bands.sd_db()[*pair][bands.omega().len() / 2] > NOT_IDENTIFIED;
    pairs.filter(is_wide).map(|pair| (pair.output, pair.input)).collect()
}
