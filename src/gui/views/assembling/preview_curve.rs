//! Curve for a response in a model file: measured, or computed from the state space.

use std::sync::Arc;

use nalgebra::Complex;

use gdcm_model::assembly::FoundModel;
use gdcm_model::dataset::{Band, BundleKind, ConditionId, Dynamics, ModelId, Pair, StateSpace};
use gdcm_model::response::response_shape::ResponseShape;
use gdcm_model::response::{FrequencyGrid, PreparedModel};

use crate::gui::plot::{BodeCurve, CurveId, Role};

/// Number of points on a state-space model's curve.
const POINTS: usize = 300;

/// Factor by which the curve extends beyond the comparison band at either end.
const BEYOND: f64 = 3.0;

/// Returns the curve for a response index and the comparison band \[rad/s\]; `None` if it cannot be
/// computed.
pub(super) fn curve(
    found: &FoundModel,
    response_index: usize,
    band: (f64, f64),
) -> Option<BodeCurve> {
    let PairResponse { omega, values } = match found.response() {
        Some(_) => measured_response(found, response_index)?,
        None => model_response(found, pair(found, response_index), band)?,
    };
    let shape = ResponseShape::new(&values);
    // A model in a file belongs to no condition yet: only the name of this id has a meaning.
    let model = ModelId::new(ConditionId(0), BundleKind::Physics, found.key());
    Some(BodeCurve {
        id: CurveId::Model(model),
        label: found.key(),
        detail: found.words(),
        role: Role::Representative,
        rejected: false,
        highlighted: false,
        hidden: false,
        omega: Arc::from(omega),
        magnitude_db: shape.magnitude_db,
        phase_deg: shape.phase_deg,
    })
}

/// Returns the pair for a response index, which is `output * inputs + input`.
pub(super) fn pair(found: &FoundModel, response_index: usize) -> Pair {
    let inputs = found.inputs.len().max(1);
    Pair::new(response_index / inputs, response_index % inputs)
}

/// Response from an input to an output.
struct PairResponse {
    /// Frequencies \[rad/s\].
    omega: Vec<f64>,
    values: Vec<Complex<f64>>,
}

/// Returns a response measured in the file, in which each pair's values are contiguous and the
/// pairs are ordered as in [`pair`]; `None` without measured responses.
fn measured_response(found: &FoundModel, response_index: usize) -> Option<PairResponse> {
    let measured = found.response()?;
    let count = measured.omega.len();
    let range = response_index * count..(response_index + 1) * count;
    let re = measured.re.values.get(range.clone())?;
    let im = measured.im.values.get(range)?;
    let values = re.iter().zip(im).map(|(re, im)| Complex::new(*re, *im));
    Some(PairResponse {
        omega: measured.omega.clone(),
        values: values.collect(),
    })
}

/// Computes a state-space model's response over the extended band; `None` if the matrices are
/// incomplete or inconsistent, or if the extended band exceeds the limits of [`Band::new`].
fn model_response(found: &FoundModel, pair: Pair, band: (f64, f64)) -> Option<PairResponse> {
    let [a, b, c, d] = found.draft.matrices.clone();
    let model = StateSpace::new(a?, b?, c?, d?)
        .ok()?
        .timed(found.draft.timing.clone())
        .ok()?;
    let wide = Band::new(band.0 / BEYOND, band.1 * BEYOND).ok()?;
    let grid = FrequencyGrid::logarithmic(wide, POINTS);
    let response = PreparedModel::new(&Dynamics::StateSpace(model)).response(&grid);
    Some(PairResponse {
        omega: grid.omega().to_vec(),
        values: response.curve(pair).to_vec(),
    })
}
