//! Linear least-absolute-deviations fits with non-negative weights, `min sum_i |x_i w - y_i|` over
//! `w >= 0`, by a search over the fit's vertices and the edges between them.
//!
//! With `n` unknowns `w_k`, the *constraints* are `x_i w = y_i` (the rows) and `w_k = 0`. `n`
//! independent constraints, a *basis*, meet in a *vertex*; some vertex attains the minimum. An
//! *edge* leaves a vertex in a direction in which all but one of its basis's constraints remain
//! satisfied; the sum is convex and piecewise linear along it.
//!
//! | file | content |
//! |---|---|
//! | `fit_constraints` | the constraints, deviations and their sums |
//! | `vertex` | the vertex of a basis, and the vertex nearest to given weights |
//! | `edge` | edges of a vertex along which the sum does not grow, and their ends |
//! | `linear_program` | the same minimum by a linear program |

mod edge;
mod fit_constraints;
mod linear_program;
mod vertex;

use edge::Neighbours;
use fit_constraints::Fit;
use linear_program::solve_linear_program;
use vertex::Vertex;

/// Reasons why a fit is unavailable.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FitError {
    /// The linear program did not reach its optimum.
    #[error("the least-absolute-deviations fit failed ({status})")]
    NotSolved { status: String },
    #[error("the least-absolute-deviations fit was cancelled")]
    Cancelled,
}

/// Minimises `sum_i |x_i w - y_i|` over `w >= 0`; among equally good vertices, returns the vertex
/// with the smallest `sum_i (sqrt(x_i w) - sqrt(y_i))^2`.
///
/// ```text
/// 1  vertex <- intersection of those constraints that the least squares fit satisfies best
/// 2  edge along which the sum falls: release a constraint in the basis, move to where the sum
///    stops falling, add the constraint met there; again from 2
/// 3  edges along which the sum stays the same: compare all vertices that they lead to; again
///    from 2
/// 4  where more constraints meet than a basis holds, edges may hide a descent: solve the linear
///    program  min sum t,  -t <= x w - y <= t,  w >= 0,  and repeat 2 and 3 from the vertex nearest
///    to its solution
/// ```
///
/// Barrodale and Roberts' simplex method (SIAM J. Numer. Anal. 10(5), 1973): exact, and identical
/// on every machine. `x` (rows with equal length) and `y` must not be negative. If all `y` are
/// zero, so are the weights.
///
/// # Errors
/// [`FitError::Cancelled`] at the first vertex at which the search is `cancelled`,
/// [`FitError::NotSolved`] if the linear program in step 4 fails.
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
    // Fit `y / scale`, and multiply the weights by `scale` at the end.
    let scaled: Vec<f64> = y.iter().map(|y| y / scale).collect();
    let fit = Fit::new(x, &scaled);
    // Step 1
    let start = Vertex::nearest(&fit, &fit.least_squares()).unwrap_or_else(|| Vertex::origin(&fit));
    // Steps 2 and 3
    let mut best = best_vertex(&fit, start, cancelled)?;
    // Step 4
    if best.is_degenerate(&fit) {
        let weights = solve_linear_program(x, &scaled, unknowns)?;
        if let Some(vertex) = Vertex::nearest(&fit, &weights) {
            let other = best_vertex(&fit, vertex, cancelled)?;
            if fit.sum_of_deviations(&other.weights) < fit.sum_of_deviations(&best.weights) {
                best = other;
            }
        }
    }
    Ok(best
        .weights
        .iter()
        .map(|weight| weight.max(0.0) * scale)
        .collect())
}

/// Steps 2 and 3: follows descending edges to the optimum, then compares all equally good vertices.
fn best_vertex(
    fit: &Fit<'_>,
    start: Vertex,
    cancelled: &dyn Fn() -> bool,
) -> Result<Vertex, FitError> {
    /// Limit on the compared vertices, which limits the run time. With few unknowns there are far
    /// fewer equally good vertices; beyond it, the best vertex so far is returned.
    const MOST_VERTICES: usize = 300;
    let mut best = start.clone();
    // Equally good vertices; the edges from those before `next` have been followed.
    let mut equal = vec![start];
    let mut next = 0;
    while next < equal.len() && equal.len() < MOST_VERTICES {
        if cancelled() {
            return Err(FitError::Cancelled);
        }
        let equally_good = match equal[next].neighbours(fit) {
            Neighbours::Better(better) => {
                best = better.clone();
                equal = vec![better];
                next = 0;
                continue;
            }
            Neighbours::Equal(vertices) => vertices,
        };
        for vertex in equally_good {
            if !equal.iter().any(|known| known.coincides_with(&vertex)) {
                if fit.sum_of_squared_root_deviations(&vertex.weights)
                    < fit.sum_of_squared_root_deviations(&best.weights)
                {
                    best = vertex.clone();
                }
                equal.push(vertex);
            }
        }
        next += 1;
    }
    Ok(best)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn least_absolute_deviations_ignore_an_outlying_row() {
        // y = 2 x1 + 3 x2 with one outlier: the fit recovers the exact weights.
        let x: Vec<Vec<f64>> = (0..9)
            .map(|k| vec![f64::from(k % 3), f64::from(k / 3)])
            .collect();
        let mut y: Vec<f64> = x.iter().map(|x| 2.0 * x[0] + 3.0 * x[1]).collect();
        y[8] = 100.0;
        let weights = least_absolute_deviations(&x, &y, &|| false).unwrap();
        // A vertex is the direct solution of a linear system: a few rounding errors of numbers up
        // to 100.
        assert!((weights[0] - 2.0).abs() < 1e-12 && (weights[1] - 3.0).abs() < 1e-12);
    }

    /// Squared differences between every two offsets, coordinate by coordinate.
    fn squared_differences(offsets: &[[i8; 3]]) -> Vec<Vec<f64>> {
        let mut rows = Vec::new();
        for (place, a) in offsets.iter().enumerate() {
            for b in &offsets[place + 1..] {
                rows.push(
                    a.iter()
                        .zip(b)
                        .map(|(a, b)| f64::from(a - b).powi(2))
                        .collect(),
                );
            }
        }
        rows
    }

    proptest::proptest! {
        #[test]
        fn the_search_along_edges_ends_where_the_linear_program_does(
            offsets in proptest::collection::vec([-2_i8..=2, -2_i8..=2, -2_i8..=2], 6..12),
            noise in proptest::collection::vec(0.0_f64..2.0, 66),
        ) {
            let x = squared_differences(&offsets);
            let y: Vec<f64> = x.iter().zip(&noise).map(|(x, noise)| (3.0 * x[0] + 0.5 * x[1] + x[2]) * noise).collect();
            let largest = y.iter().copied().fold(0.0, f64::max);
            proptest::prop_assume!(largest > 0.0);
            let scaled: Vec<f64> = y.iter().map(|y| y / largest).collect();
            let fit = Fit::new(&x, &scaled);
            let weights = least_absolute_deviations(&x, &y, &|| false).unwrap();
            let scaled_weights: Vec<f64> = weights.iter().map(|weight| weight / largest).collect();
            let found = fit.sum_of_deviations(&scaled_weights);
            let program = fit.sum_of_deviations(&solve_linear_program(&x, &scaled, 3).unwrap());
            // The linear program is solved to a relative tolerance of 1e-11; the search is exact.
            proptest::prop_assert!(found <= program * (1.0 + 1e-9) + 1e-12, "{found} {program}");
        }
    }

    #[test]
    fn a_cancelled_fit_ends_without_a_result() {
        let x = vec![vec![1.0], vec![2.0], vec![3.0]];
        assert_eq!(
            least_absolute_deviations(&x, &[1.0, 2.0, 4.0], &|| true),
            Err(FitError::Cancelled)
        );
    }

    #[test]
    fn weights_do_not_go_below_zero() {
        let x = vec![vec![1.0, 1.0], vec![1.0, 2.0], vec![1.0, 3.0]];
        let weights = least_absolute_deviations(&x, &[3.0, 2.0, 1.0], &|| false).unwrap();
        assert!(weights.iter().all(|&weight| weight >= 0.0));
    }

    #[test]
    fn equally_good_vertices_are_compared_in_square_roots() {
        // Every w from 4 to 9 is a median of these values; the squared differences of the square
        // roots decide. Square roots 0, 2, 3, 4: they sum to 9 from 2, and to 11 from 3. Square
        // roots 1, 2, 3, 5: they sum to 11 from 2, and to 9 from 3. The tolerance covers a few
        // rounding errors.
        let x = [vec![1.0], vec![1.0], vec![1.0], vec![1.0]];
        for (y, expected) in [([0.0, 4.0, 9.0, 16.0], 4.0), ([1.0, 4.0, 9.0, 25.0], 9.0)] {
            let weights = least_absolute_deviations(&x, &y, &|| false).unwrap();
            assert!((weights[0] - expected).abs() < 1e-13, "{weights:?}");
        }
    }
}
