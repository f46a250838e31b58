//! What an identification found, as its file says it.

use nalgebra::Complex;

use gdcm_core::assembly::{ChannelLabel, ChannelRule, Facts, FoundModel};
use gdcm_core::dataset::{BandsDraft, ModelDraft, Origin, Pair, PairTable, Provenance, ResponseArray, Timing};
use gdcm_core::identification::{
    Bands, FlightRecord, Identification, IdentifiedModel, MeasuredPoint, MeasuredResponse, Options,
    Origin as IdentifiedOrigin, StateSpaceMatrices,
};
use gdcm_core::records::{RecordChannels, RecordTable};
use gdcm_core::study::pieces_used;
use gdcm_core::units::neper_to_db;
use gdcm_files::{IdentifiedModels, IdentifiedValidation, MeasuredEstimate, PoleEstimate, RecordReport};

/// Methods, as models carry them (M14).
const REFINED: &str = "CT-PBSID, refined";
const PLAIN: &str = "CT-PBSID";

/// What an identification of `records` found: the recommended model first, then CT-PBSID as it is, then the rest of the bundle.
pub(super) fn identified_models(
    found: &Identification,
    options: &Options,
    records: &[(&FlightRecord, &RecordTable)],
    channels: &RecordChannels,
) -> IdentifiedModels {
    let of = |model: &IdentifiedModel, method: &str| {
        let without = match model.origin {
            IdentifiedOrigin::WithoutRecord(record) => Some(record),
            IdentifiedOrigin::Refined | IdentifiedOrigin::Plain | IdentifiedOrigin::Neighbour => None,
        };
        let fitted = |index: &usize| !options.held_out.contains(index) && Some(*index) != without;
        let names = (0..records.len()).filter(fitted).map(|index| records[index].0.name.clone());
        found_model(model, method, names.collect(), channels)
    };
    let mut models = vec![of(&found.refined, REFINED), of(&found.plain, PLAIN)];
    models[0].draft.bands = bands(&found.bands);
    models.extend(found.bundle.iter().map(|model| of(model, REFINED)));
    let pole = |of: &gdcm_core::identification::PoleEstimate| PoleEstimate {
        re: of.pole.re,
        im: of.pole.im,
        sd: of.sd_re.hypot(of.sd_im),
        determined: of.determined,
    };
    IdentifiedModels {
        models,
        measured: Some(measured(&found.measured)),
        poles: found.poles.iter().map(pole).collect(),
        validation: validation(found),
        records: records.iter().enumerate().map(|(index, record)| report(found, options, index, record)).collect(),
        cautions: found.cautions.iter().map(ToString::to_string).collect(),
    }
}

fn found_model(model: &IdentifiedModel, method: &str, records: Vec<String>, channels: &RecordChannels) -> FoundModel {
    let StateSpaceMatrices { a, b, c, d } = model.matrices.clone();
    let label = |rule: &ChannelRule| ChannelLabel {
        name: Some(rule.name.clone()),
        unit: Some(rule.unit.clone()).filter(|unit| !unit.is_empty()),
    };
    let order = Some(a.nrows());
    FoundModel {
        draft: ModelDraft {
            name: model.name.clone(),
            origin: Origin::Identified { method: Some(method.to_owned()), order },
            matrices: [Some(a), Some(b), Some(c), Some(d)],
            timing: Timing::default(),
            response: None,
            source: Some(Provenance { records, ..Provenance::default() }),
            states: Vec::new(),
            bands: None,
        },
        inputs: channels.inputs.iter().map(label).collect(),
        outputs: channels.outputs.iter().map(label).collect(),
        facts: Facts::default(),
        notes: Vec::new(),
    }
}

fn bands(bands: &Bands) -> Option<BandsDraft> {
    let (outputs, inputs) = bands.sd_db.first()?.shape();
    let array = |matrices: &[nalgebra::DMatrix<f64>]| {
        let pairs = (0..outputs).flat_map(|output| (0..inputs).map(move |input| (output, input)));
        let values = pairs.flat_map(|pair| matrices.iter().map(move |of| of[pair])).collect();
        ResponseArray { shape: [outputs, inputs, matrices.len()], values }
    };
    Some(BandsDraft { omega: bands.omega.clone(), sd_db: array(&bands.sd_db), sd_deg: array(&bands.sd_deg) })
}

fn measured(measured: &MeasuredResponse) -> MeasuredEstimate {
    let points = &measured.points;
    let (outputs, inputs) = points.first().map_or((0, 0), |point| point.response.shape());
    let table = |value: &dyn Fn(&MeasuredPoint, (usize, usize)) -> f64| {
        PairTable::from_fn(outputs, inputs, |Pair { output, input }| {
            points.iter().map(|point| value(point, (output, input))).collect::<Vec<f64>>()
        })
    };
    let neper =
        |point: &MeasuredPoint, at: (usize, usize)| (0.5 * point.variance[at]).sqrt() / point.response[at].norm();
    let values = PairTable::from_fn(outputs, inputs, |Pair { output, input }| {
        points.iter().map(|point| point.response[(output, input)]).collect::<Vec<Complex<f64>>>()
    });
    MeasuredEstimate {
        omega: points.iter().map(|point| point.omega).collect(),
        values,
        coherence: (0..outputs).map(|output| points.iter().map(|point| point.coherence[output]).collect()).collect(),
        partial_coherence: table(&|point, at| point.partial_coherence[at]),
        sd_db: table(&|point, at| neper_to_db(neper(point, at))),
        sd_deg: table(&|point, at| neper(point, at).to_degrees()),
    }
}

/// The costs, and fit and Theil's coefficient of the held-out records in time (M14, section 6).
fn validation(found: &Identification) -> IdentifiedValidation {
    let in_time = found.validation.as_ref();
    let figures = |of: Option<&Vec<Option<f64>>>| {
        of.map_or_else(Vec::new, |of| of.iter().map(|figure| figure.unwrap_or(f64::NAN)).collect())
    };
    IdentifiedValidation {
        fit_per_dof: Some(found.cost),
        held_out_per_dof: found.held_out_cost,
        fit_percent: figures(in_time.map(|of| &of.fit_percent)),
        theil: figures(in_time.map(|of| &of.theil)),
    }
}

fn report(
    found: &Identification,
    options: &Options,
    index: usize,
    (flight, table): &(&FlightRecord, &RecordTable),
) -> RecordReport {
    let used = found.record_uses.get(index);
    let gaps: Vec<String> = used.iter().flat_map(|used| &used.gaps).map(ToString::to_string).collect();
    RecordReport {
        name: flight.name.clone(),
        file: table.source.file.clone(),
        sha256: table.source.sha256.clone(),
        variable: table.source.variable.clone(),
        held_out: options.held_out.contains(&index),
        used_s: used.map_or_else(Vec::new, |used| pieces_used(flight, used)),
        why_not: Some(gaps.join("; ")).filter(|words| !words.is_empty()),
    }
}
