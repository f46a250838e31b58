//! Linear least-absolute-deviations fits with non-negative weights, by a search over the vertices
//! of the fit and the edges between them.

use nalgebra::{DMatrix, DVector};

use gdcm_numerics::{CscMatrix, DefaultSettings, convex_program};

/// Reasons for a missing fit.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FitError {
    /// The linear program did not reach its optimum.
    #[error("the fit of least absolute deviations ended with {status}")]
    NotSolved {
        /// Status reported by the solver.
        status: String,
    },
    #[error("the fit of least absolute deviations was cancelled")]
    Cancelled,
}

/// Minimises `sum_i |x_i w - y_i|` over `w >= 0`; among equally good vertices, returns the one with
/// the smallest `sum_i (sqrt(x_i w) - sqrt(y_i))^2`.
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
/// The simplex method of Barrodale and Roberts (SIAM J. Numer. Anal. 10(5), 1973): exact, and
/// identical on every machine. `x` and `y` must not be negative. The search ends without a result
/// at the first vertex at which it is `cancelled`.
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
        let other = Vertex::nearest(&fit, &weights)
            .map(|vertex| best_vertex(&fit, vertex, cancelled))
            .transpose()?;
        let better =
            other.filter(|other| fit.deviations(&other.weights) < fit.deviations(&best.weights));
        best = better.unwrap_or(best);
    }
    Ok(best
        .weights
        .iter()
        .map(|weight| weight.max(0.0) * scale)
        .collect())
}

/// Follows descending edges to the optimum, then compares all equally good vertices.
fn best_vertex(
    fit: &Fit<'_>,
    start: Vertex,
    cancelled: &dyn Fn() -> bool,
) -> Result<Vertex, FitError> {
    /// Far more than the vertices of a face with few unknowns; limits only the run time.
    const MOST_VERTICES: usize = 300;
    let misfit = |vertex: &Vertex| fit.squared_root_deviations(&vertex.weights);
    let mut best = start.clone();
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

/// Solves the linear program `min sum t` subject to `x w - t <= y`, `-x w - t <= -y`, `w >= 0`.
fn solve_linear_program(x: &[Vec<f64>], y: &[f64], unknowns: usize) -> Result<Vec<f64>, FitError> {
    let rows = x.len();
    let mut i = Vec::new();
    let mut j = Vec::new();
    let mut v = Vec::new();
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
    let b: Vec<f64> = y
        .iter()
        .copied()
        .chain(y.iter().map(|y| -y))
        .chain(vec![0.0; unknowns])
        .collect();
    let q: Vec<f64> = vec![0.0; unknowns]
        .into_iter()
        .chain(vec![1.0; rows])
        .collect();
    // Tight enough that the nearest vertex is optimal or one edge from an optimal vertex.
    let settings = DefaultSettings {
        verbose: false,
        tol_gap_abs: 1e-11,
        tol_gap_rel: 1e-11,
        tol_feas: 1e-11,
        max_iter: 500,
        ..DefaultSettings::default()
    };
    let solution = convex_program(&CscMatrix::zeros((q.len(), q.len())), &q, &a, &b, settings);
    solution
        .map(|x| x[..unknowns].to_vec())
        .map_err(|status| FitError::NotSolved { status })
}

/// Deviations and weights below this count as zero; the right-hand sides are scaled to at most 1.
const ZERO: f64 = 1e-11;
/// Relative change of the sum of deviations along an edge below which the edge counts as flat.
const FLAT: f64 = 1e-10;

/// The constraints `x_i w = y_i` and `w_k = 0`; a vertex is the intersection of as many constraints
/// as there are unknowns.
struct Fit<'a> {
    /// Row by row.
    x: Vec<f64>,
    unknowns: usize,
    y: &'a [f64],
}

/// A vertex: its weights, and the constraints that meet in it.
#[derive(Clone, Debug)]
struct Vertex {
    /// The weights, non-negative up to rounding.
    weights: Vec<f64>,
    /// Indices of the constraints: rows first, then weights.
    basis: Vec<usize>,
}

/// Destinations of the edges of a vertex.
enum Neighbours {
    /// End of an edge along which the deviations decrease.
    Better(Vertex),
    /// Ends of the edges along which the deviations stay the same.
    Equal(Vec<Vertex>),
}

impl<'a> Fit<'a> {
    /// Creates the constraints of the fit of `y` by `x`.
    fn new(x: &[Vec<f64>], y: &'a [f64]) -> Self {
        Self {
            x: x.concat(),
            unknowns: x.first().map_or(0, Vec::len),
            y,
        }
    }

    fn count(&self) -> usize {
        self.y.len() + self.unknowns
    }

    fn row(&self, row: usize) -> &[f64] {
        &self.x[row * self.unknowns..(row + 1) * self.unknowns]
    }

    /// Returns the left-hand side of a constraint at `w`, or its change along a direction `w`.
    fn left(&self, constraint: usize, w: &[f64]) -> f64 {
        if self.is_weight(constraint) {
            return w[constraint - self.y.len()];
        }
        self.row(constraint).iter().zip(w).map(|(x, w)| x * w).sum()
    }

    fn right(&self, constraint: usize) -> f64 {
        self.y.get(constraint).copied().unwrap_or(0.0)
    }

    fn deviation(&self, constraint: usize, w: &[f64]) -> f64 {
        self.left(constraint, w) - self.right(constraint)
    }

    fn is_weight(&self, constraint: usize) -> bool {
        constraint >= self.y.len()
    }

    /// Returns the left-hand sides of some constraints: rows of `x` or of the identity.
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

    /// `sum_i |x_i w - y_i|`.
    fn deviations(&self, w: &[f64]) -> f64 {
        (0..self.y.len())
            .map(|row| self.deviation(row, w).abs())
            .sum()
    }

    /// Returns the least-squares weights with negative values set to zero: close to the optimal
    /// vertex.
    fn least_squares(&self) -> Vec<f64> {
        let x = DMatrix::from_row_slice(self.y.len(), self.unknowns, &self.x);
        let normal = x.tr_mul(&x).cholesky();
        let solution =
            normal.map(|normal| normal.solve(&x.tr_mul(&DVector::from_column_slice(self.y))));
        solution.map_or(vec![0.0; self.unknowns], |w| {
            w.iter().map(|weight| weight.max(0.0)).collect()
        })
    }

    /// `sum_i (sqrt(x_i w) - sqrt(y_i))^2`.
    fn squared_root_deviations(&self, w: &[f64]) -> f64 {
        (0..self.y.len())
            .map(|row| (self.left(row, w).max(0.0).sqrt() - self.y[row].sqrt()).powi(2))
            .sum()
    }
}

/// An edge that leaves a vertex.
struct Edge {
    /// Position of the released constraint in the vertex's basis.
    leaving: usize,
    direction: Vec<f64>,
    /// Rate of change of the sum of deviations along the edge.
    slope: f64,
    /// Largest possible magnitude of that rate.
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

/// Intersection of an edge with a constraint.
struct Crossing {
    constraint: usize,
    /// Distance along the edge.
    step: f64,
    /// Half the change of the rate at this intersection.
    change: f64,
}

/// Returns the constraint of the first crossing at which the doubled accumulated changes reach
/// `rise`: a weighted median, found by bisection rather than by sorting.
fn crossing_at(mut crossings: Vec<Crossing>, rise: f64) -> Option<usize> {
    let by_step = |a: &Crossing, b: &Crossing| {
        a.step
            .total_cmp(&b.step)
            .then(a.constraint.cmp(&b.constraint))
    };
    let mut left = crossings.as_mut_slice();
    let mut risen = 0.0;
    loop {
        if left.len() <= 1 {
            return left
                .first()
                .filter(|last| risen + 2.0 * last.change >= rise)
                .map(|last| last.constraint);
        }
        let (near, _, _) = left.select_nth_unstable_by(left.len() / 2, by_step);
        let middle = near.len();
        let rise_of_near: f64 = near.iter().map(|crossing| 2.0 * crossing.change).sum();
        if risen + rise_of_near >= rise {
            left = &mut left[..middle];
        } else {
            risen += rise_of_near;
            left = &mut left[middle..];
        }
    }
}

impl Vertex {
    /// Returns the vertex of the constraints that `weights` satisfies best; `None` if they define
    /// no vertex, or one with a negative weight.
    fn nearest(fit: &Fit<'_>, weights: &[f64]) -> Option<Self> {
        let deviation = |constraint: usize| (fit.deviation(constraint, weights).abs(), constraint);
        let mut order: Vec<(f64, usize)> = (0..fit.count()).map(deviation).collect();
        order.sort_unstable_by(|(a, first), (b, second)| a.total_cmp(b).then(first.cmp(second)));
        let mut basis = Vec::new();
        for (_, constraint) in order {
            basis.push(constraint);
            // Offsets are scaled to at most 1: a smaller singular value means a redundant
            // constraint.
            if fit.matrix(&basis).rank(1e-6) < basis.len() {
                basis.pop();
            }
            if basis.len() == fit.unknowns {
                break;
            }
        }
        Self::of(fit, basis)
    }

    /// Returns the vertex with all weights zero.
    fn origin(fit: &Fit<'_>) -> Self {
        let basis = (fit.y.len()..fit.count()).collect();
        Self {
            weights: vec![0.0; fit.unknowns],
            basis,
        }
    }

    fn of(fit: &Fit<'_>, basis: Vec<usize>) -> Option<Self> {
        let matrix = fit.matrix(&basis);
        if !matrix.is_square() {
            return None;
        }
        let right = DVector::from_iterator(
            basis.len(),
            basis.iter().map(|&constraint| fit.right(constraint)),
        );
        let weights: Vec<f64> = matrix.lu().solve(&right)?.iter().copied().collect();
        weights
            .iter()
            .all(|&weight| weight > -ZERO)
            .then_some(Self { weights, basis })
    }

    /// Whether two vertices coincide.
    fn is_at(&self, other: &Self) -> bool {
        self.weights
            .iter()
            .zip(&other.weights)
            .all(|(a, b)| (a - b).abs() <= ZERO)
    }

    /// Returns the vertices at the ends of the edges along which the deviations do not grow. Among
    /// descending edges it takes the steepest: with many rows, the first descending edge would need
    /// ten times as many steps.
    fn neighbours(&self, fit: &Fit<'_>) -> Neighbours {
        let deviations = self.all_deviations(fit);
        let mut edges = self.edges(fit, &deviations);
        edges.sort_by(|a, b| a.relative_slope().total_cmp(&b.relative_slope()));
        let mut equal = Vec::new();
        for edge in edges.iter().filter(|edge| edge.relative_slope() <= FLAT) {
            match self.end_of_edge(fit, edge, &deviations) {
                Some(end) if edge.relative_slope() < -FLAT => return Neighbours::Better(end),
                end => equal.extend(end),
            }
        }
        Neighbours::Equal(equal)
    }

    /// Returns the edges of this vertex: one constraint is released, in either direction; a weight
    /// only upwards.
    fn edges(&self, fit: &Fit<'_>, deviations: &[f64]) -> Vec<Edge> {
        let Some(inverse) = fit.matrix(&self.basis).try_inverse() else {
            return Vec::new();
        };
        let mut edges = Vec::with_capacity(2 * self.basis.len());
        for leaving in 0..self.basis.len() {
            let upwards: Vec<f64> = inverse.column(leaving).iter().copied().collect();
            let (slopes, scale) = slopes(fit, deviations, &upwards);
            let sides = if fit.is_weight(self.basis[leaving]) {
                &[1.0][..]
            } else {
                &[1.0, -1.0]
            };
            for (side, slope) in sides.iter().zip(slopes) {
                let direction = upwards.iter().map(|entry| side * entry).collect();
                edges.push(Edge {
                    leaving,
                    direction,
                    slope,
                    scale,
                });
            }
        }
        edges
    }

    /// Returns the deviation of each constraint, exactly zero for those that meet here.
    fn all_deviations(&self, fit: &Fit<'_>) -> Vec<f64> {
        let mut deviations: Vec<f64> = (0..fit.count())
            .map(|constraint| fit.deviation(constraint, &self.weights))
            .collect();
        for &constraint in &self.basis {
            deviations[constraint] = 0.0;
        }
        deviations
    }

    /// Returns the vertex along an edge at which the sum of deviations stops falling.
    ///
    /// Each row whose deviation changes sign along the edge adds twice its change to the rate; a
    /// weight that reaches zero ends the edge.
    fn end_of_edge(&self, fit: &Fit<'_>, edge: &Edge, deviations: &[f64]) -> Option<Self> {
        let met = deviations
            .iter()
            .enumerate()
            .filter(|(constraint, _)| !self.basis.contains(constraint));
        let met = met.filter_map(|(constraint, deviation)| {
            let slope = fit.left(constraint, &edge.direction);
            let step = -deviation / slope;
            // A weight ends the edge, whatever the rate.
            let change = if fit.is_weight(constraint) {
                f64::INFINITY
            } else {
                slope.abs()
            };
            (slope.abs() > ZERO && step > ZERO).then_some(Crossing {
                constraint,
                step,
                change,
            })
        });
        let entering = crossing_at(met.collect(), -FLAT * edge.scale - edge.slope)?;
        let mut basis = self.basis.clone();
        basis[edge.leaving] = entering;
        Self::of(fit, basis)
    }

    /// Whether more constraints meet in this vertex than it needs; its edges may then miss a
    /// descent direction.
    fn is_degenerate(&self, fit: &Fit<'_>) -> bool {
        let meet = |constraint: &usize| fit.deviation(*constraint, &self.weights).abs() <= ZERO;
        (0..fit.count()).filter(meet).count() > fit.unknowns
    }
}

/// Returns the rates of change of the sum of deviations along `direction` and against it, and their
/// largest possible magnitude.
fn slopes(fit: &Fit<'_>, deviations: &[f64], direction: &[f64]) -> ([f64; 2], f64) {
    // A zero deviation grows in either direction.
    let mut growing = 0.0;
    let mut signed = 0.0;
    let mut scale = 0.0;
    for (row, deviation) in deviations[..fit.y.len()].iter().enumerate() {
        let change = fit.left(row, direction);
        if deviation.abs() <= ZERO {
            growing += change.abs();
        } else {
            signed += change * deviation.signum();
        }
        scale += change.abs();
    }
    ([growing + signed, growing - signed], scale)
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
        // A vertex is solved for directly: a few rounding errors of numbers up to 100.
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
    fn of_equally_good_vertices_the_one_nearest_in_square_roots_is_taken() {
        // Every w from 4 to 9 is a median of these. Square roots 0, 2, 3, 4: from 2 the squares add
        // to 9, from 3 to 11; square roots 1, 2, 3, 5: from 2 they add to 11, from 3 to 9. (The
        // tolerance covers a few rounding errors.)
        let fit = |y: &[f64]| {
            let x = [vec![1.0], vec![1.0], vec![1.0], vec![1.0]];
            least_absolute_deviations(&x, y, &|| false).unwrap()[0]
        };
        assert!((fit(&[0.0, 4.0, 9.0, 16.0]) - 4.0).abs() < 1e-13);
        assert!((fit(&[1.0, 4.0, 9.0, 25.0]) - 9.0).abs() < 1e-13);
    }
}
