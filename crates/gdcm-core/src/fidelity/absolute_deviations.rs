//! Linear fits of least absolute deviations, with weights that are not negative.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettingsBuilder, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus};

use super::vertex::{Fit, Vertex};

/// Why there is no fit.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FitError {
    /// The linear program did not end at its optimum.
    #[error("the fit of least absolute deviations ended with {status}")]
    NotSolved {
        /// The solver's own word.
        status: String,
    },
    /// It was cancelled.
    #[error("the fit of least absolute deviations was cancelled")]
    Cancelled,
}

/// `argmin sum_i |x_i w - y_i|` over `w >= 0`; of equally good vertices the one of least `sum_i (sqrt(x_i w) - sqrt(y_i))^2`.
///
/// ```text
/// 1  vertex <- that of the constraints x_i w = y_i, w_k = 0 which the fit of least squares meets best
/// 2  an edge along which the sum falls: give up one constraint of the basis, go to where the sum stops falling,
///    take in the constraint met there; again from 2
/// 3  edges along which it stays the same: over all vertices that they lead to, again from 2
/// 4  where more constraints meet than a basis holds, edges may hide a way down: the linear program
///    min sum t,  -t <= x w - y <= t,  w >= 0  is solved, and 2 and 3 go on from the vertex nearest to its solution
/// ```
///
/// The simplex method of Barrodale and Roberts (SIAM J. Numer. Anal. 10(5), 1973): exact, and the same on every machine.
/// `x` and `y` must not be negative. It ends without a result at the first vertex at which it is `cancelled`.
pub fn least_absolute_deviations(
    x: &[Vec<f64>],
    y: &[f64],
    cancelled: &dyn Fn() -> bool,
) -> Result<Vec<f64>, FitError> {
    let unknowns = x.first().map_or(0, Vec::len);
    let scale = y.iter().copied().fold(0.0, f64::max);
    if scale == 0.0 {
        return Ok(vec![0.0; unknowns]);
    }
    let scaled: Vec<f64> = y.iter().map(|y| y / scale).collect();
    let fit = Fit::new(x, &scaled);
    let start = Vertex::nearest(&fit, &fit.least_squares()).unwrap_or_else(|| Vertex::origin(&fit));
    let mut best = best_vertex(&fit, start, cancelled)?;
    if best.is_degenerate(&fit) {
        let weights = solve_linear_program(x, &scaled, unknowns)?;
        let other = Vertex::nearest(&fit, &weights).map(|vertex| best_vertex(&fit, vertex, cancelled)).transpose()?;
        let better = other.filter(|other| fit.deviations(&other.weights) < fit.deviations(&best.weights));
        best = better.unwrap_or(best);
    }
    Ok(best.weights.iter().map(|weight| weight.max(0.0) * scale).collect())
}

/// Goes along descending edges to the optimum, then over all equally good vertices.
fn best_vertex(fit: &Fit<'_>, start: Vertex, cancelled: &dyn Fn() -> bool) -> Result<Vertex, FitError> {
    /// Far more than the vertices of a face in a few unknowns; only a bound on time.
    const MOST_VERTICES: usize = 300;
    let misfit = |vertex: &Vertex| fit.squared_root_deviations(&vertex.weights);
    let mut best = start.clone();
    let mut equal = vec![start];
    let mut next = 0;
    while next < equal.len() && equal.len() < MOST_VERTICES {
        if cancelled() {
            return Err(FitError::Cancelled);
        }
        let neighbours = equal[next].neighbours(fit);
        if let Some(better) = neighbours.better {
            best = better.clone();
            equal = vec![better];
            next = 0;
            continue;
        }
        for vertex in neighbours.equal {
            if !equal.iter().any(|known| known.is_at(&vertex)) {
                if misfit(&vertex) < misfit(&best) {
                    best = vertex.clone();
                }
                equal.push(vertex);
            }
        }
        next += 1;
    }
    Ok(best)
}

/// The linear program `min sum t` subject to `x w - t <= y`, `-x w - t <= -y`, `w >= 0`.
fn solve_linear_program(x: &[Vec<f64>], y: &[f64], unknowns: usize) -> Result<Vec<f64>, FitError> {
    let rows = x.len();
    let (mut i, mut j, mut v) = (Vec::new(), Vec::new(), Vec::new());
    let mut entry = |row: usize, column: usize, value: f64| {
        i.push(row);
        j.push(column);
        v.push(value);
    };
    for (row, x) in x.iter().enumerate() {
        for (column, &value) in x.iter().enumerate().filter(|(_, value)| **value != 0.0) {
            entry(row, column, value);
            entry(rows + row, column, -value);
        }
        entry(row, unknowns + row, -1.0);
        entry(rows + row, unknowns + row, -1.0);
    }
    for column in 0..unknowns {
        entry(2 * rows + column, column, -1.0);
    }
    let a = CscMatrix::new_from_triplets(2 * rows + unknowns, unknowns + rows, i, j, v);
    let b: Vec<f64> = y.iter().copied().chain(y.iter().map(|y| -y)).chain(vec![0.0; unknowns]).collect();
    let q: Vec<f64> = vec![0.0; unknowns].into_iter().chain(vec![1.0; rows]).collect();
    let failed = |status: String| FitError::NotSolved { status };
    // Close enough that the nearest vertex is an optimal one, or one edge from it.
    let settings = DefaultSettingsBuilder::default()
        .verbose(false)
        .tol_gap_abs(1e-11)
        .tol_gap_rel(1e-11)
        .tol_feas(1e-11)
        .max_iter(500)
        .build()
        .map_err(|error| failed(error.to_string()))?;
    let p = CscMatrix::zeros((q.len(), q.len()));
    let cones = [NonnegativeConeT(b.len())];
    let mut solver = DefaultSolver::new(&p, &q, &a, &b, &cones, settings).map_err(|error| failed(error.to_string()))?;
    solver.solve();
    match solver.solution.status {
        SolverStatus::Solved => Ok(solver.solution.x[..unknowns].to_vec()),
        status => Err(failed(format!("{status:?}"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn least_absolute_deviations_ignore_an_outlying_row() {
        // y = 2 x1 + 3 x2, one row far off: the exact weights come back.
        let x: Vec<Vec<f64>> = (0..9).map(|k| vec![f64::from(k % 3), f64::from(k / 3)]).collect();
        let mut y: Vec<f64> = x.iter().map(|x| 2.0 * x[0] + 3.0 * x[1]).collect();
        y[8] = 100.0;
        let weights = least_absolute_deviations(&x, &y, &|| false).unwrap();
        // A vertex is solved for, not iterated to: a few roundings of numbers up to 100.
        assert!((weights[0] - 2.0).abs() < 1e-12 && (weights[1] - 3.0).abs() < 1e-12);
    }

    proptest::proptest! {
        #[test]
        fn the_search_along_edges_ends_where_the_linear_program_does(
            offsets in proptest::collection::vec((-2_i8..=2, -2_i8..=2, -2_i8..=2), 6..12),
            noise in proptest::collection::vec(0.0_f64..2.0, 66),
        ) {
            let pairs = (0..offsets.len()).flat_map(|a| (a + 1..offsets.len()).map(move |b| (a, b)));
            let square = |a: i8, b: i8| f64::from(a - b).powi(2);
            let x: Vec<Vec<f64>> = pairs
                .map(|(a, b)| (offsets[a], offsets[b]))
                .map(|(a, b)| vec![square(a.0, b.0), square(a.1, b.1), square(a.2, b.2)])
                .collect();
            let y: Vec<f64> = x.iter().zip(&noise).map(|(x, noise)| (3.0 * x[0] + 0.5 * x[1] + x[2]) * noise).collect();
            let largest = y.iter().copied().fold(0.0, f64::max);
            proptest::prop_assume!(largest > 0.0);
            let scaled: Vec<f64> = y.iter().map(|y| y / largest).collect();
            let fit = Fit::new(&x, &scaled);
            let weights = |weights: Vec<f64>| weights.iter().map(|weight| weight / largest).collect::<Vec<f64>>();
            let found = fit.deviations(&weights(least_absolute_deviations(&x, &y, &|| false).unwrap()));
            let program = fit.deviations(&solve_linear_program(&x, &scaled, 3).unwrap());
            // The program is solved to 1e-11 relative; the search is exact.
            proptest::prop_assert!(found <= program * (1.0 + 1e-9) + 1e-12, "{found} {program}");
        }
    }

    #[test]
    fn a_cancelled_fit_ends_without_a_result() {
        let x = vec![vec![1.0], vec![2.0], vec![3.0]];
        assert_eq!(least_absolute_deviations(&x, &[1.0, 2.0, 4.0], &|| true), Err(FitError::Cancelled));
    }

    #[test]
    fn weights_do_not_go_below_zero() {
        let x = vec![vec![1.0, 1.0], vec![1.0, 2.0], vec![1.0, 3.0]];
        let weights = least_absolute_deviations(&x, &[3.0, 2.0, 1.0], &|| false).unwrap();
        assert!(weights.iter().all(|&weight| weight >= 0.0));
    }

    #[test]
    fn of_equally_good_vertices_the_one_nearest_in_square_roots_is_taken() {
        // Every w from 4 to 9 is a median of these. Square roots 0, 2, 3, 4: from 2 the squares add to 9, from 3 to 11;
        // square roots 1, 2, 3, 5: from 2 they add to 11, from 3 to 9. (A vertex is solved for: a few roundings.)
        let fit = |y: &[f64]| {
            let x = [vec![1.0], vec![1.0], vec![1.0], vec![1.0]];
            least_absolute_deviations(&x, y, &|| false).unwrap()[0]
        };
        assert!((fit(&[0.0, 4.0, 9.0, 16.0]) - 4.0).abs() < 1e-13);
        assert!((fit(&[1.0, 4.0, 9.0, 25.0]) - 9.0).abs() < 1e-13);
    }
}
