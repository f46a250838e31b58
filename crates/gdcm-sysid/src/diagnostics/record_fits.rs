//! How well a model fits each record and each output, for the cautions and the report (M14.6).
//!
//! `J` is the weighted square of the residual over the spectral lines (`cost`); per degree of
//! freedom it is 1 if only noise remains. A *held-out* record is not fitted, but reserved for
//! validation. Its *normalised* cost is that with the model free to move within its uncertainty:
//! a short fit that predicts a loud record badly need not be wrong (M14.17).

use nalgebra::{Complex, DMatrix};

use crate::likelihood::cost::{Likelihood, SegmentCost};
use crate::likelihood::covariance::ParameterCovariance;
use crate::likelihood::schur_model::SchurModel;

/// How well the recommended model fits a record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecordFit {
    /// Record index, from 0.
    pub record: usize,
    /// `J` per degree of freedom, corrected for the model's parameters if the record was fitted; 1
    /// is adequate.
    pub cost: f64,
    /// Number of real values in the lines, less the unknowns in the transients.
    pub freedom: usize,
    pub held_out: bool,
}

/// Held-out cost per degree of freedom.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HeldOutCost {
    pub(crate) raw: f64,
    /// Cost with the model free to move within its uncertainty (M14.17).
    pub(crate) normalised: f64,
}

/// How well a model fits all records, each record and each output.
pub(crate) struct RecordFits {
    /// Fits for the records that have degrees of freedom, in record order. A fitted record's cost
    /// is corrected for the k parameters of the model: `(J_r / dof_r) N / (N - k)`, N degrees of
    /// freedom over all fitted records.
    pub(crate) records: Vec<RecordFit>,
    /// `J` per degree of freedom for each output, over the fitted records, corrected as in
    /// `records`.
    pub(crate) outputs: Vec<f64>,
    /// `J` per degree of freedom over the fitted records, corrected as in `records`.
    pub(crate) cost: f64,
    /// Costs over the held-out records; `None` if no record is held out.
    pub(crate) held_out: Option<HeldOutCost>,
}

impl RecordFits {
    /// Computes a model's fits; `None` if a cost is not finite or there are no degrees of freedom.
    pub(crate) fn new(
        fitted: &Likelihood,
        held_out_records: &Likelihood,
        model: &SchurModel,
        covariance: &ParameterCovariance,
    ) -> Option<Self> {
        let parts = fitted.parts(model)?;
        let held_out_parts = held_out_records.parts(model)?;
        let freedom = fitted.freedom(model.order());
        let parameters = model.parameters();
        let spare = freedom.checked_sub(parameters)?;
        if spare == 0 {
            return None;
        }
        let correction = freedom as f64 / spare as f64;
        let mut outputs = output_costs(fitted, model, &parts);
        for cost in &mut outputs {
            *cost *= correction;
        }
        let mut records = fits_of_records(fitted, model, &parts, false);
        for fit in &mut records {
            fit.cost *= correction;
        }
        let cost = mean_cost(&records)?;
        let held_out = fits_of_records(held_out_records, model, &held_out_parts, true);
        let normalised =
            covariance.cost_within_uncertainty(held_out_records, model, &held_out_parts);
        let held_out_cost = held_out_cost(&held_out, normalised);
        records.extend(held_out);
        records.sort_by_key(|fit| fit.record);
        Some(Self {
            records,
            outputs,
            cost,
            held_out: held_out_cost,
        })
    }
}

/// Divides held-out costs by their degrees of freedom; `total_normalised` is the total cost with
/// the model free to move within its uncertainty; without it, `normalised` is `raw`.
fn held_out_cost(held_out: &[RecordFit], total_normalised: Option<f64>) -> Option<HeldOutCost> {
    let raw = mean_cost(held_out)?;
    let freedom: usize = held_out.iter().map(|fit| fit.freedom).sum();
    let normalised = match total_normalised {
        Some(total) => total / freedom as f64,
        None => raw,
    };
    Some(HeldOutCost { raw, normalised })
}

/// Computes the fit to each record that has degrees of freedom, in record order.
pub(crate) fn fits_of_records(
    likelihood: &Likelihood,
    model: &SchurModel,
    parts: &[SegmentCost],
    held_out: bool,
) -> Vec<RecordFit> {
    let mut fits = Vec::new();
    for record in likelihood.records() {
        let mut freedom = 0;
        let mut costs = Vec::new();
        for (segment, part) in likelihood.segments.iter().zip(parts) {
            if segment.record == record {
                freedom += segment.freedom(model.order());
                costs.push(part.cost);
            }
        }
        if freedom > 0 {
            fits.push(RecordFit {
                record,
                cost: costs.iter().sum::<f64>() / freedom as f64,
                freedom,
                held_out,
            });
        }
    }
    fits
}

/// Returns `J` per degree of freedom over all records; `None` without degrees of freedom.
fn mean_cost(fits: &[RecordFit]) -> Option<f64> {
    let freedom: f64 = fits.iter().map(|fit| fit.freedom as f64).sum();
    let cost: f64 = fits.iter().map(|fit| fit.cost * fit.freedom as f64).sum();
    if freedom > 0.0 {
        Some(cost / freedom)
    } else {
        None
    }
}

/// Computes `J` per degree of freedom for each output: `sum |E_o|^2 / (Cv_oo / 2)` over its share
/// of the degrees of freedom; E is the residual in output units, Cv the noise covariance.
fn output_costs(likelihood: &Likelihood, model: &SchurModel, parts: &[SegmentCost]) -> Vec<f64> {
    let outputs = model.c().nrows();
    let freedom = likelihood.freedom(model.order()) as f64 / outputs as f64;
    let mut sums = vec![0.0; outputs];
    for (segment, part) in likelihood.segments.iter().zip(parts) {
        for (weight, residual) in segment.weights.iter().zip(part.residual.column_iter()) {
            // The Cholesky factor of Cv / 2 turns the whitened residual back into output units.
            let identity = DMatrix::identity(outputs, outputs);
            let Some(factor) = weight.solve_lower_triangular(&identity) else {
                continue;
            };
            for (o, sum) in sums.iter_mut().enumerate() {
                let own: Complex<f64> = (0..=o).map(|k| residual[k] * factor[(o, k)]).sum();
                *sum += own.norm_sqr() / factor.row(o).norm_squared();
            }
        }
    }
    if freedom > 0.0 {
        sums.iter().map(|sum| sum / freedom).collect()
    } else {
        vec![0.0; outputs]
    }
}
