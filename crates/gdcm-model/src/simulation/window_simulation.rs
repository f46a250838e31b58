//! Simulates a model in a record window, with the initial state and the output offsets that fit the
//! record best.

use nalgebra::{DMatrix, DVector, RowDVector};

use super::first_order_hold::FirstOrderHold;
use super::flight_record::centred;

/// Relative singular value below which a combination of unknowns is not estimated.
const RANK_TOLERANCE: f64 = 1e-9;

/// Simulates `inputs` about their means, with the initial state and offsets that minimise the
/// squared difference between the outputs and `measured`, each output divided by its standard
/// deviation in `std`; `None` if there is no such solution, or the outputs are not finite.
///
/// ```text
/// 1  forced: response to the inputs about their means, from a zero state
/// 2  x0, offset: least squares for free x0 + offset = measured - forced
/// 3  simulated = forced + free x0 + offset
/// ```
///
/// `free` contains [`FirstOrderHold::free_responses`] for at least as many samples.
pub(super) fn best_simulation(
    discretised: &FirstOrderHold,
    free: &DMatrix<f64>,
    inputs: DMatrix<f64>,
    measured: &DMatrix<f64>,
    std: &[f64],
) -> Option<DMatrix<f64>> {
    let (samples, outputs) = measured.shape();
    let states = free.ncols();
    // Step 1.
    let forced = discretised.simulate(&DVector::zeros(states), &centred(inputs));

    // Step 2. Rows: one per sample n and output o, divided by the output's standard deviation.
    // Columns: initial states, offsets, right-hand side.
    let mut rows = DMatrix::zeros(samples * outputs, states + outputs + 1);
    for n in 0..samples {
        for (o, std) in std.iter().enumerate() {
            let mut row = rows.row_mut(n * outputs + o);
            row.columns_mut(0, states)
                .copy_from(&(free.row(n * outputs + o) / *std));
            row[states + o] = 1.0 / std;
            row[states + outputs] = (measured[(n, o)] - forced[(n, o)]) / std;
        }
    }
    let unknowns = least_squares(rows)?;
    // Step 3.
    let free_part = free.rows(0, samples * outputs) * unknowns.rows(0, states);
    let simulated = DMatrix::from_fn(samples, outputs, |n, o| {
        forced[(n, o)] + free_part[n * outputs + o] + unknowns[states + o]
    });
    if simulated.iter().all(|y| y.is_finite()) {
        Some(simulated)
    } else {
        None
    }
}

/// Returns the least-squares solution `x` of `a x = b`, given as `[a | b]`; if there are several,
/// the one with minimum norm after scaling the columns of `a` to unit length. `None` if an entry is
/// not finite, or the singular values are not found.
fn least_squares(rows: DMatrix<f64>) -> Option<DVector<f64>> {
    let unknowns = rows.ncols() - 1;
    if !rows.norm().is_finite() {
        return None;
    }
    let r = rows.qr().unpack_r();
    let mut a = r.view((0, 0), (unknowns, unknowns)).into_owned();
    let lengths = RowDVector::from_fn(unknowns, |_, column| {
        let length = a.column(column).norm();
        if length > 0.0 { length } else { 1.0 }
    });
    for (mut column, length) in a.column_iter_mut().zip(lengths.iter()) {
        column /= *length;
    }
    let svd = a.try_svd(true, true, f64::EPSILON, 100 * (unknowns + 1))?;
    let tolerance = RANK_TOLERANCE * svd.singular_values.max();
    let solution = svd
        .solve(
            &r.view((0, unknowns), (unknowns, 1)).into_owned(),
            tolerance,
        )
        .ok()?;
    Some(solution.column(0).component_div(&lengths.transpose()))
}
