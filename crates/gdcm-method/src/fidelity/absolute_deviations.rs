//! Linear least-absolute-deviations fits with non-negative weights, `min sum_i |x_i w - y_i|` over
//! `w >= 0`, by a search over the vertices of the fit and the edges between them.
//!
//! With `n` unknowns `w_k`, the *constraints* are `x_i w = y_i` (the rows) and `w_k = 0`. `n`
//! independent constraints, a *basis*, meet in a *vertex*; some vertex attains the minimum. An
//! *edge* leaves a vertex in the direction in which all constraints of its basis but one remain
//! satisfied; the sum is convex and piecewise linear along it.

use std::cmp::Ordering;

use nalgebra::{DMatrix, DVector};

use gdcm_numerics::{CscMatrix, DefaultSettings, convex_program};

/// Deviations and weights below this count as zero; the right-hand sides are scaled to at most 1.
const ZERO: f64 = 1e-11;
/// Relative change in the summed deviations below which an edge counts as flat.
const FLAT: f64 = 1e-10;
/// Smallest singular value of independent constraints, whose coefficients are of order 1.
const INDEPENDENT: f64 = 1e-6;

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
/// 2  edge along which the sum falls: release a constraint in the basis, move to where the sum stops falling,
///    add the constraint met there; again from 2
/// 3  edges along which the sum stays the same: compare all vertices that they lead to; again from 2
/// 4  where more constraints meet than a basis holds, edges may hide a descent: solve the linear program
///    min sum t,  -t <= x w - y <= t,  w >= 0,  and repeat 2 and 3 from the vertex nearest to its solution
/// ```
///
/// Barrodale and Roberts' simplex method (SIAM J. Numer. Anal. 10(5), 1973): exact, and identical
/// on every machine. `x` (rows with equal length) and `y` must not be negative. The search ends
/// without a result at the first vertex at which it is `cancelled`.
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
    let start = Vertex::nearest(&fit, &fit.least_squares()).unwrap_or_else(|| Vertex::origin(&fit));
    let mut best = best_vertex(&fit, start, cancelled)?;
    if best.is_degenerate(&fit) {
        let weights = solve_linear_program(x, &scaled, unknowns)?;
        if let Some(vertex) = Vertex::nearest(&fit, &weights) {
            let other = best_vertex(&fit, vertex, cancelled)?;
            if fit.deviations(&other.weights) < fit.deviations(&best.weights) {
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
    /// Maximum number of compared vertices, to limit the run time: far more than a face with few
    /// unknowns has.
    const MOST_VERTICES: usize = 300;
    let mut best = start.clone();
    // Equally good vertices; the edges of those before `next` have been followed.
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
                if fit.squared_root_deviations(&vertex.weights)
                    < fit.squared_root_deviations(&best.weights)
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

/// Step 4: solves the linear program `min sum t` subject to `x w - t <= y`, `-x w - t <= -y`,
/// `w >= 0`. Columns: the weights `w`, then a `t` for each row. Rows: the three groups of
/// inequalities in this order.
fn solve_linear_program(x: &[Vec<f64>], y: &[f64], unknowns: usize) -> Result<Vec<f64>, FitError> {
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

/// Entries of a sparse matrix.
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

/// The constraints of a fit: `x_i w = y_i` (the rows), then `w_k = 0` (the weights), counted in
/// this order.
struct Fit<'a> {
    /// The rows `x_i`, row-major.
    x: Vec<f64>,
    unknowns: usize,
    y: &'a [f64],
}

/// A vertex: its weights, and the constraints that define it.
#[derive(Clone, Debug)]
struct Vertex {
    /// The weights, non-negative up to rounding.
    weights: Vec<f64>,
    /// Constraint indices: rows first, then weights.
    basis: Vec<usize>,
}

/// Destinations along a vertex's edges.
enum Neighbours {
    /// End vertex of an edge along which the deviations decrease.
    Better(Vertex),
    /// End vertices of the edges along which the deviations do not change.
    Equal(Vec<Vertex>),
}

impl<'a> Fit<'a> {
    /// Creates the constraints for fitting `y` by `x`.
    fn new(x: &[Vec<f64>], y: &'a [f64]) -> Self {
        Self {
            x: x.concat(),
            unknowns: x.first().map_or(0, Vec::len),
            y,
        }
    }

    /// Returns the number of constraints.
    fn count(&self) -> usize {
        self.y.len() + self.unknowns
    }

    fn row(&self, row: usize) -> &[f64] {
        &self.x[row * self.unknowns..(row + 1) * self.unknowns]
    }

    /// Returns a constraint's left-hand side at `w`, or its change along a direction `w`.
    fn left(&self, constraint: usize, w: &[f64]) -> f64 {
        if self.is_weight(constraint) {
            return w[constraint - self.y.len()];
        }
        self.row(constraint).iter().zip(w).map(|(x, w)| x * w).sum()
    }

    /// Returns a constraint's right-hand side.
    fn right(&self, constraint: usize) -> f64 {
        self.y.get(constraint).copied().unwrap_or(0.0)
    }

    fn deviation(&self, constraint: usize, w: &[f64]) -> f64 {
        self.left(constraint, w) - self.right(constraint)
    }

    /// Returns whether a constraint is `w_k = 0`.
    fn is_weight(&self, constraint: usize) -> bool {
        constraint >= self.y.len()
    }

    /// Returns the coefficients of these constraints, a matrix row each: from `x` for a row, from
    /// the identity for a weight.
    fn matrix(&self, constraints: &[usize]) -> DMatrix<f64> {
        DMatrix::from_fn(
            constraints.len(),
            self.unknowns,
            |row, column| match constraints[row].checked_sub(self.y.len()) {
                None => self.row(constraints[row])[column],
                Some(weight) => f64::from(weight == column),
            },
        )
    }

    /// Computes `sum_i |x_i w - y_i|`.
    fn deviations(&self, w: &[f64]) -> f64 {
        (0..self.y.len())
            .map(|row| self.deviation(row, w).abs())
            .sum()
    }

    /// Returns the least-squares weights with negative values set to zero, close to the optimal
    /// vertex; zero weights where the normal equations are singular.
    fn least_squares(&self) -> Vec<f64> {
        let x = DMatrix::from_row_slice(self.y.len(), self.unknowns, &self.x);
        let Some(normal) = x.tr_mul(&x).cholesky() else {
            return vec![0.0; self.unknowns];
        };
        let weights = normal.solve(&x.tr_mul(&DVector::from_column_slice(self.y)));
        weights.iter().map(|weight| weight.max(0.0)).collect()
    }

    /// Computes `sum_i (sqrt(x_i w) - sqrt(y_i))^2`.
    fn squared_root_deviations(&self, w: &[f64]) -> f64 {
        (0..self.y.len())
            .map(|row| (self.left(row, w).max(0.0).sqrt() - self.y[row].sqrt()).powi(2))
            .sum()
    }
}

/// An edge that leaves a vertex.
struct Edge {
    /// The released constraint's position in the vertex's basis.
    leaving: usize,
    direction: Vec<f64>,
    /// Rate of change of the summed deviations along the edge.
    slope: f64,
    /// Maximum possible magnitude of `slope`.
    scale: f64,
}

impl Edge {
    fn relative_slope(&self) -> f64 {
        if self.scale > 0.0 {
            self.slope / self.scale
        } else {
            0.0
        }
    }
}

/// Intersection of an edge and a constraint.
struct Crossing {
    constraint: usize,
    /// Distance along the edge.
    step: f64,
    /// Half the change of the edge's slope at this intersection.
    change: f64,
}

impl Crossing {
    /// Orders crossings along the edge; ties by constraint index.
    fn compare(&self, other: &Self) -> Ordering {
        self.step
            .total_cmp(&other.step)
            .then(self.constraint.cmp(&other.constraint))
    }
}

/// Returns the constraint at the first crossing along an edge at which the slope has risen by at
/// least `rise`, the sum of twice the changes up to there: a weighted median, found by bisection
/// rather than by sorting.
fn crossing_at(mut crossings: Vec<Crossing>, rise: f64) -> Option<usize> {
    // `candidates` contains the crossing; the slope has risen by `risen` before them.
    let mut candidates = crossings.as_mut_slice();
    let mut risen = 0.0;
    while candidates.len() > 1 {
        let (near, _, _) =
            candidates.select_nth_unstable_by(candidates.len() / 2, Crossing::compare);
        let middle = near.len();
        let rise_of_near: f64 = near.iter().map(|crossing| 2.0 * crossing.change).sum();
        if risen + rise_of_near >= rise {
            candidates = &mut candidates[..middle];
        } else {
            risen += rise_of_near;
            candidates = &mut candidates[middle..];
        }
    }
    let last = candidates.first()?;
    if risen + 2.0 * last.change >= rise {
        Some(last.constraint)
    } else {
        None
    }
}

impl Vertex {
    /// Returns the vertex of the constraints that `weights` satisfies best; `None` if these
    /// constraints define no vertex, or a vertex with a negative weight.
    fn nearest(fit: &Fit<'_>, weights: &[f64]) -> Option<Self> {
        let deviations: Vec<f64> = (0..fit.count())
            .map(|constraint| fit.deviation(constraint, weights).abs())
            .collect();
        let mut order: Vec<usize> = (0..fit.count()).collect();
        order.sort_unstable_by(|&a, &b| deviations[a].total_cmp(&deviations[b]).then(a.cmp(&b)));
        let mut basis = Vec::new();
        for constraint in order {
            basis.push(constraint);
            if fit.matrix(&basis).rank(INDEPENDENT) < basis.len() {
                basis.pop();
            }
            if basis.len() == fit.unknowns {
                break;
            }
        }
        Self::from_basis(fit, basis)
    }

    /// Returns the vertex with all weights zero.
    fn origin(fit: &Fit<'_>) -> Self {
        let basis = (fit.y.len()..fit.count()).collect();
        Self {
            weights: vec![0.0; fit.unknowns],
            basis,
        }
    }

    /// Returns the intersection of the constraints in a basis; `None` if they do not intersect in a
    /// point, or at a negative weight.
    fn from_basis(fit: &Fit<'_>, basis: Vec<usize>) -> Option<Self> {
        let matrix = fit.matrix(&basis);
        if !matrix.is_square() {
            return None;
        }
        let right = DVector::from_iterator(
            basis.len(),
            basis.iter().map(|&constraint| fit.right(constraint)),
        );
        let weights: Vec<f64> = matrix.lu().solve(&right)?.iter().copied().collect();
        if weights.iter().all(|&weight| weight > -ZERO) {
            Some(Self { weights, basis })
        } else {
            None
        }
    }

    /// Returns whether two vertices coincide.
    fn coincides_with(&self, other: &Self) -> bool {
        self.weights
            .iter()
            .zip(&other.weights)
            .all(|(a, b)| (a - b).abs() <= ZERO)
    }

    /// Returns the end vertices of the edges along which the deviations do not grow. Among
    /// descending edges the steepest is taken: with many rows, the first descending edge would need
    /// ten times as many steps.
    fn neighbours(&self, fit: &Fit<'_>) -> Neighbours {
        let deviations = self.deviations(fit);
        let mut edges = self.edges(fit, &deviations);
        edges.retain(|edge| edge.relative_slope() <= FLAT);
        edges.sort_by(|a, b| a.relative_slope().total_cmp(&b.relative_slope()));
        let mut equal = Vec::new();
        for edge in &edges {
            if let Some(end) = self.end_of_edge(fit, edge, &deviations) {
                if edge.relative_slope() < -FLAT {
                    return Neighbours::Better(end);
                }
                equal.push(end);
            }
        }
        Neighbours::Equal(equal)
    }

    /// Returns the edges of this vertex. Each releases a constraint of the basis: a row in either
    /// direction, a weight only upwards. Column `leaving` of the inverse basis matrix changes the
    /// left-hand side of that constraint at rate 1, and no other in the basis.
    fn edges(&self, fit: &Fit<'_>, deviations: &[f64]) -> Vec<Edge> {
        let Some(inverse) = fit.matrix(&self.basis).try_inverse() else {
            return Vec::new();
        };
        let mut edges = Vec::with_capacity(2 * self.basis.len());
        for leaving in 0..self.basis.len() {
            let upwards: Vec<f64> = inverse.column(leaving).iter().copied().collect();
            let rates = EdgeRates::new(fit, deviations, &upwards);
            let against: Vec<f64> = upwards.iter().map(|entry| -entry).collect();
            edges.push(Edge {
                leaving,
                direction: upwards,
                slope: rates.along,
                scale: rates.scale,
            });
            if !fit.is_weight(self.basis[leaving]) {
                edges.push(Edge {
                    leaving,
                    direction: against,
                    slope: rates.against,
                    scale: rates.scale,
                });
            }
        }
        edges
    }

    /// Returns every constraint's deviation, exactly zero for the constraints that define the
    /// vertex.
    fn deviations(&self, fit: &Fit<'_>) -> Vec<f64> {
        let mut deviations: Vec<f64> = (0..fit.count())
            .map(|constraint| fit.deviation(constraint, &self.weights))
            .collect();
        for &constraint in &self.basis {
            deviations[constraint] = 0.0;
        }
        deviations
    }

    /// Returns the vertex along an edge at which the summed deviations stop falling.
    ///
    /// Each row whose deviation changes sign along the edge raises the slope of the sum by twice
    /// its rate of change; the sum stops falling where the slope is no longer negative.
    fn end_of_edge(&self, fit: &Fit<'_>, edge: &Edge, deviations: &[f64]) -> Option<Self> {
        let mut crossings = Vec::new();
        for (constraint, deviation) in deviations.iter().enumerate() {
            if self.basis.contains(&constraint) {
                continue;
            }
            let slope = fit.left(constraint, &edge.direction);
            let step = -deviation / slope;
            // A weight that reaches zero ends the edge, whatever the rate.
            let change = if fit.is_weight(constraint) {
                f64::INFINITY
            } else {
                slope.abs()
            };
            if slope.abs() > ZERO && step > ZERO {
                crossings.push(Crossing {
                    constraint,
                    step,
                    change,
                });
            }
        }
        let entering = crossing_at(crossings, -FLAT * edge.scale - edge.slope)?;
        let mut basis = self.basis.clone();
        basis[edge.leaving] = entering;
        Self::from_basis(fit, basis)
    }

    /// Returns whether more constraints meet in this vertex than it needs; its edges may then miss
    /// a descent direction.
    fn is_degenerate(&self, fit: &Fit<'_>) -> bool {
        let meeting = (0..fit.count())
            .filter(|&constraint| fit.deviation(constraint, &self.weights).abs() <= ZERO)
            .count();
        meeting > fit.unknowns
    }
}

/// Rates of change of the summed deviations along a direction and against it: a row whose deviation
/// is zero adds `|change|` in both, another row adds its change times the sign of its deviation.
struct EdgeRates {
    along: f64,
    against: f64,
    /// Maximum possible magnitude of the rates.
    scale: f64,
}

impl EdgeRates {
    fn new(fit: &Fit<'_>, deviations: &[f64], direction: &[f64]) -> Self {
        let mut growing = 0.0;
        let mut signed = 0.0;
        let mut scale = 0.0;
        for (row, deviation) in deviations[..fit.y.len()].iter().enumerate() {
            let change = fit.left(row, direction);
            if deviation.abs() <= ZERO {
                // A zero deviation grows in either direction.
                growing += change.abs();
            } else {
                signed += change * deviation.signum();
            }
            scale += change.abs();
        }
        Self {
            along: growing + signed,
            against: growing - signed,
            scale,
        }
    }
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
            let found = fit.deviations(&scaled_weights);
            let program = fit.deviations(&solve_linear_program(&x, &scaled, 3).unwrap());
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
