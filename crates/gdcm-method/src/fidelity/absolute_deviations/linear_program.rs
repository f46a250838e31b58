//! Solves the least-absolute-deviations fit as a linear program (step 4 in `absolute_deviations`).

use gdcm_numerics::{CscMatrix, DefaultSettings, convex_program};

use super::FitError;

/// Step 4: solves the linear program `min sum t` subject to `x w - t <= y`, `-x w - t <= -y`, `w >=
/// 0`, and returns `w`. Columns: the weights `w`, then a `t` for each row. Rows: the three
/// inequality groups in this order.
pub(super) fn solve_linear_program(
    x: &[Vec<f64>],
    y: &[f64],
    unknowns: usize,
) -> Result<Vec<f64>, FitError> {
    let rows = x.len();
    let mut entries = Triplets::default();
    for (row, x) in x.iter().enumerate() {
        for (column, &value) in x.iter().enumerate() {
            if value != 0.0 {
                entries.push(row, column, value);
                entries.push(rows + row, column, -value);
            }
        }
        entries.push(row, unknowns + row, -1.0);
        entries.push(rows + row, unknowns + row, -1.0);
    }
    for column in 0..unknowns {
        entries.push(2 * rows + column, column, -1.0);
    }
    let a = CscMatrix::new_from_triplets(
        2 * rows + unknowns,
        unknowns + rows,
        entries.rows,
        entries.columns,
        entries.values,
    );
    let mut b = y.to_vec();
    b.extend(y.iter().map(|y| -y));
    b.extend(vec![0.0; unknowns]);
    let mut q = vec![0.0; unknowns];
    q.extend(vec![1.0; rows]);
    // These tolerances ensure that the nearest vertex is optimal, or one edge from an optimal
    // vertex.
    let settings = DefaultSettings {
        verbose: false,
        tol_gap_abs: 1e-11,
        tol_gap_rel: 1e-11,
        tol_feas: 1e-11,
        max_iter: 500,
        ..DefaultSettings::default()
    };
    let no_curvature = CscMatrix::zeros((q.len(), q.len()));
    match convex_program(&no_curvature, &q, &a, &b, settings) {
        Ok(solution) => Ok(solution[..unknowns].to_vec()),
        Err(status) => Err(FitError::NotSolved { status }),
    }
}

/// Entries in a sparse matrix: places and values.
#[derive(Default)]
struct Triplets {
    rows: Vec<usize>,
    columns: Vec<usize>,
    values: Vec<f64>,
}

impl Triplets {
    fn push(&mut self, row: usize, column: usize, value: f64) {
        self.rows.push(row);
        self.columns.push(column);
        self.values.push(value);
    }
}
