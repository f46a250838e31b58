//! From an identification to the identified bundle of a condition.

use std::sync::Arc;

use crate::dataset::{
    ConditionRecord, Dynamics, MeasuredResponse, Model, ModelBands, Origin, Pair, PairTable, Provenance, StateSpace,
};
use crate::identification::{
    Bands, FlightRecord, Identification, MeasuredPoint, Origin as IdentifiedOrigin, RecordUse, StateSpaceMatrices,
    Treatment,
};

use super::AdoptedModels;

/// Methods, as models carry them (M14).
const REFINED: &str = "CT-PBSID, refined";
const PLAIN: &str = "CT-PBSID";
const MEASURED: &str = "local polynomial method";

/// Which models of an identification are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OfferedModels {
    /// The refined model, its neighbours in order, and the models without each record (M14, section 5).
    pub refined: bool,
    /// CT-PBSID as it is.
    pub plain: bool,
    /// The measured response itself, with its coherence (M4a).
    pub measured: bool,
}

impl OfferedModels {
    /// The bundle that M14 gives to M5.
    pub const REFINED: Self = Self { refined: true, plain: false, measured: false };
    /// The same, and CT-PBSID as it is.
    pub const WITH_PLAIN: Self = Self { refined: true, plain: true, measured: false };
    /// The measured response alone.
    pub const MEASURED: Self = Self { refined: false, plain: false, measured: true };
}

/// The offered models of an identification of `records`, the recommended one first; those that are no model of the program are
/// left out, which `identify` itself refuses to make.
pub fn identified_bundle(
    found: &Identification,
    offered: OfferedModels,
    records: Vec<ConditionRecord>,
) -> AdoptedModels {
    let names = |without: Option<usize>| {
        let used = records.iter().enumerate().filter(|(index, record)| !record.held_out && Some(*index) != without);
        used.map(|(_, record)| record.name.clone()).collect::<Vec<String>>()
    };
    let model = |name: &str, method: &str, matrices: &StateSpaceMatrices, without: Option<usize>| {
        let StateSpaceMatrices { a, b, c, d } = matrices.clone();
        let order = Some(a.nrows());
        let dynamics = Dynamics::StateSpace(StateSpace::new(a, b, c, d).ok()?);
        let origin = Origin::Identified { method: Some(method.to_owned()), order };
        let source = Some(Provenance { records: names(without), ..Provenance::default() });
        Some(Model { source, ..Model::new(name, origin, dynamics) })
    };
    let mut models = Vec::new();
    if offered.refined {
        models.extend(std::iter::once(&found.refined).chain(&found.bundle).filter_map(|of| {
            let without = match of.origin {
                IdentifiedOrigin::WithoutRecord(record) => Some(record),
                IdentifiedOrigin::Refined | IdentifiedOrigin::Plain | IdentifiedOrigin::Neighbour => None,
            };
            let bands = (of.origin == IdentifiedOrigin::Refined).then(|| model_bands(&found.bands)).flatten();
            Some(Model { bands: bands.map(Arc::new), ..model(&of.name, REFINED, &of.matrices, without)? })
        }));
    }
    if offered.plain {
        models.extend(model(&found.plain.name, PLAIN, &found.plain.matrices, None));
    }
    if offered.measured {
        models.extend(measured_response(found).map(|response| {
            let origin = Origin::Identified { method: Some(MEASURED.to_owned()), order: None };
            let source = Some(Provenance { records: names(None), ..Provenance::default() });
            Model { source, ..Model::new("measured", origin, Dynamics::Measured(response)) }
        }));
    }
    AdoptedModels { models, records }
}

/// First and last time \[s\] of each piece of a record between what was cut out of it.
pub fn pieces_used(flight: &FlightRecord, found: &RecordUse) -> Vec<[f64; 2]> {
    let cut: Vec<_> = found.gaps.iter().filter(|gap| gap.treatment == Treatment::CutOut).collect();
    let finite = || flight.time_s.iter().copied().filter(|time| time.is_finite());
    let (Some(first), Some(last)) = (finite().next(), finite().next_back()) else { return Vec::new() };
    let starts = std::iter::once(first).chain(cut.iter().map(|gap| gap.end_s));
    let ends = cut.iter().map(|gap| gap.start_s).chain([last]);
    starts.zip(ends).filter(|(start, end)| start < end).map(|(start, end)| [start, end]).collect()
}

/// The bands of the recommended model as models carry them.
fn model_bands(bands: &Bands) -> Option<ModelBands> {
    let (outputs, inputs) = bands.sd_db.first()?.shape();
    let table = |matrices: &[nalgebra::DMatrix<f64>]| {
        PairTable::from_fn(outputs, inputs, |pair| matrices.iter().map(|of| of[(pair.output, pair.input)]).collect())
    };
    ModelBands::new(bands.omega.clone(), table(&bands.sd_db), table(&bands.sd_deg)).ok()
}

/// The response measured without a model, weighed by its partial coherence: what each input explains of what the others leave.
fn measured_response(found: &Identification) -> Option<MeasuredResponse> {
    let points = &found.measured.points;
    let (outputs, inputs) = points.first()?.response.shape();
    let table = |value: &dyn Fn(&MeasuredPoint, Pair) -> f64| {
        PairTable::from_fn(outputs, inputs, |pair| points.iter().map(|point| value(point, pair)).collect::<Vec<f64>>())
    };
    let entry = |point: &MeasuredPoint, pair: Pair| point.response[(pair.output, pair.input)];
    let re = table(&|point, pair| entry(point, pair).re);
    let im = table(&|point, pair| entry(point, pair).im);
    let coherence = table(&|point, pair| point.partial_coherence[(pair.output, pair.input)].clamp(0.0, 1.0));
    MeasuredResponse::new(points.iter().map(|point| point.omega).collect(), &re, &im, Some(coherence)).ok()
}
