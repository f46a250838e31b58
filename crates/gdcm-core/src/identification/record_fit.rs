//! How well a model fits each record and each output.

use super::blocks::BlockModel;
use super::likelihood::{Likelihood, PieceCost};

/// How well the recommended model fits a record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecordFit {
    /// Which record, counted from 0.
    pub record: usize,
    /// `J` per degree of freedom; 1 is adequate.
    pub cost: f64,
    /// Degrees of freedom.
    pub freedom: usize,
    /// Whether the record was held out.
    pub held_out: bool,
}

/// The fit of each record that has degrees of freedom, by record.
pub(super) fn fits_of_records(
    likelihood: &Likelihood,
    model: &BlockModel,
    parts: &[PieceCost],
    held_out: bool,
) -> Vec<RecordFit> {
    let of_record = |record: usize| {
        let pieces = || likelihood.pieces.iter().zip(parts).filter(move |(piece, _)| piece.record == record);
        let freedom = pieces().map(|(piece, _)| piece.freedom(model.order())).sum();
        let cost = pieces().map(|(_, part)| part.cost).sum::<f64>() / freedom as f64;
        (freedom > 0).then_some(RecordFit { record, cost, freedom, held_out })
    };
    likelihood.records().into_iter().filter_map(of_record).collect()
}

/// `J` per degree of freedom over records; none where they have none.
pub(super) fn mean_cost(fits: &[RecordFit]) -> Option<f64> {
    let freedom: f64 = fits.iter().map(|fit| fit.freedom as f64).sum();
    let cost: f64 = fits.iter().map(|fit| fit.cost * fit.freedom as f64).sum();
    (freedom > 0.0).then(|| cost / freedom)
}

/// `J` per degree of freedom of each output by itself: `sum |E_o|^2 / (Cv_oo / 2)` over its share of the degrees of freedom.
pub(super) fn output_costs(likelihood: &Likelihood, model: &BlockModel, parts: &[PieceCost]) -> Vec<f64> {
    let outputs = model.c.nrows();
    let freedom = likelihood.freedom(model.order()) as f64 / outputs as f64;
    let mut sums = vec![0.0; outputs];
    for (piece, part) in likelihood.pieces.iter().zip(parts) {
        for (weight, residual) in piece.weights.iter().zip(part.residual.column_iter()) {
            // The Cholesky factor of Cv / 2, by which the residual goes back to its outputs.
            let Some(factor) = weight.solve_lower_triangular(&nalgebra::DMatrix::identity(outputs, outputs)) else {
                continue;
            };
            for (o, sum) in sums.iter_mut().enumerate() {
                let back: nalgebra::Complex<f64> = (0..=o).map(|k| residual[k] * factor[(o, k)]).sum();
                *sum += back.norm_sqr() / factor.row(o).norm_squared();
            }
        }
    }
    sums.into_iter().map(|sum| if freedom > 0.0 { sum / freedom } else { 0.0 }).collect()
}
