//! Matrices and metrics of an exported model, under their names in MATLAB and NumPy files.

use nalgebra::DMatrix;

use crate::export::exported_model::ExportedModel;
use crate::export::matlab_values::matrix;
use crate::formats::variables::Value;

/// A model metric's name in files, with the function that computes it.
pub(super) type Metric = (&'static str, fn(&ExportedModel) -> f64);

/// Model metrics, in file order.
pub(super) const METRICS: [Metric; 8] = [
    ("Ts", sample_time_s),
    ("condition", |model| model.condition.0 as f64),
    ("airspeed_kt", |model| model.airspeed_kt),
    ("pade_order", |model| model.pade_order as f64),
    ("phase_error_deg", ExportedModel::phase_error_deg),
    ("band_top_rad_s", |model| model.band_top_rad_s),
    (
        "not_valid_above_rad_s",
        ExportedModel::not_valid_above_rad_s,
    ),
    ("gain_above_band_db", ExportedModel::gain_above_band_db),
];

/// Returns MATLAB's `Ts` \[s\]: 0 in continuous time.
fn sample_time_s(model: &ExportedModel) -> f64 {
    model.model.timing().sample_time_s.unwrap_or(0.0)
}

pub(super) fn matrices(model: &ExportedModel) -> [(&'static str, &DMatrix<f64>); 4] {
    let model = &model.model;
    [
        ("A", model.a()),
        ("B", model.b()),
        ("C", model.c()),
        ("D", model.d()),
    ]
}

pub(super) fn array(values: &DMatrix<f64>) -> Value {
    // nalgebra and MATLAB both store matrices in column-major order.
    matrix(values.nrows(), values.ncols(), values.as_slice().to_vec())
}
