//! What is said of the recommended model (M14, sections 5 and 6).

use super::blocks::BlockModel;
use super::bundle::{WithoutRecord, without_each_record};
use super::evidence::PreparedData;
use super::examination::Diagnostics;
use super::normal_system::NormalSystem;
use super::order::effective_parameters;
use super::record_fit::{fits_of_records, mean_cost, output_costs};
use super::refinement::{Proposal, Refinement, in_units};
use super::steps::Steps;
use super::uncertainty::{Bands, ParameterCovariance};
use super::{
    FlightRecord, Identification, IdentificationCaution, IdentificationError, IdentifiedModel, Options, Origin,
    ValidationSettings, log_spaced, validate,
};

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
