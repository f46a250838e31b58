//! Vertices of a fit of least absolute deviations, and the edges between them.

use nalgebra::{DMatrix, DVector};

/// A deviation or a weight below this is zero; the right-hand sides are scaled to at most 1.
const ZERO: f64 = 1e-11;
/// A change of the sum of deviations along an edge below this part of what it could be is none.
const FLAT: f64 = 1e-10;

/// The constraints `x_i w = y_i` and `w_k = 0`, of which as many meet in a vertex as there are unknowns.
pub struct Fit<'a> {
    /// Row by row.
    x: Vec<f64>,
    unknowns: usize,
    y: &'a [f64],
}

/// A vertex: its weights, and the constraints that meet in it.
#[derive(Clone, Debug)]
pub struct Vertex {
    /// The weights, none below zero but for rounding.
    pub weights: Vec<f64>,
    /// Indices of the constraints: rows first, then weights.
    basis: Vec<usize>,
}

/// Where the edges of a vertex lead.
pub struct Neighbours {
    /// The end of an edge along which the deviations become less.
    pub better: Option<Vertex>,
    /// The ends of the edges along which they stay the same.
    pub equal: Vec<Vertex>,
}

impl<'a> Fit<'a> {
    /// The constraints of the fit of `y` by `x`.
    pub fn new(x: &[Vec<f64>], y: &'a [f64]) -> Self {
        Self { x: x.concat(), unknowns: x.first().map_or(0, Vec::len), y }
    }

    fn unknowns(&self) -> usize {
        self.unknowns
    }

    fn count(&self) -> usize {
        self.y.len() + self.unknowns()
    }

    fn row(&self, row: usize) -> &[f64] {
        &self.x[row * self.unknowns..(row + 1) * self.unknowns]
    }

    /// Left-hand side of a constraint at, or its change along, `w`.
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

    fn matrix(&self, constraints: &[usize]) -> DMatrix<f64> {
        let unit = |k: usize| DVector::from_fn(self.unknowns(), |row, _| if row == k { 1.0 } else { 0.0 });
        DMatrix::from_fn(constraints.len(), self.unknowns(), |row, column| {
            self.left(constraints[row], unit(column).as_slice())
        })
    }

    /// `sum_i |x_i w - y_i|`.
    pub fn deviations(&self, w: &[f64]) -> f64 {
        (0..self.y.len()).map(|row| self.deviation(row, w).abs()).sum()
    }

    /// The weights of least squares, those below zero set to zero: not far from the vertex sought.
    pub fn least_squares(&self) -> Vec<f64> {
        let x = DMatrix::from_row_slice(self.y.len(), self.unknowns(), &self.x);
        let normal = x.tr_mul(&x).cholesky();
        let solution = normal.map(|normal| normal.solve(&x.tr_mul(&DVector::from_column_slice(self.y))));
        solution.map_or(vec![0.0; self.unknowns()], |w| w.iter().map(|weight| weight.max(0.0)).collect())
    }

    /// `sum_i (sqrt(x_i w) - sqrt(y_i))^2`.
    pub fn squared_root_deviations(&self, w: &[f64]) -> f64 {
        (0..self.y.len()).map(|row| (self.left(row, w).max(0.0).sqrt() - self.y[row].sqrt()).powi(2)).sum()
    }
}

/// A way out of a vertex.
struct Edge {
    /// Which of the vertex's constraints is given up.
    leaving: usize,
    direction: Vec<f64>,
    /// Rate at which the sum of deviations changes along it.
    slope: f64,
    /// The most that it could change.
    scale: f64,
}

impl Edge {
    fn relative_slope(&self) -> f64 {
        if self.scale > 0.0 { self.slope / self.scale } else { 0.0 }
    }
}

/// Where an edge meets the place of a constraint.
struct Crossing {
    constraint: usize,
    /// How far along the edge.
    step: f64,
    /// By how much the rate changes there, halved.
    change: f64,
}

/// The constraint of the first crossing at which the doubled changes so far come to `rise`: a weighted median, found by halving
/// what is left rather than by sorting it.
fn crossing_at(mut crossings: Vec<Crossing>, rise: f64) -> Option<usize> {
    let by_step = |a: &Crossing, b: &Crossing| a.step.total_cmp(&b.step).then(a.constraint.cmp(&b.constraint));
    let (mut left, mut risen) = (crossings.as_mut_slice(), 0.0);
    loop {
        if left.len() <= 1 {
            return left.first().filter(|last| risen + 2.0 * last.change >= rise).map(|last| last.constraint);
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
    /// The vertex of the constraints that `weights` fulfils best; `None` where they make none, or one with a negative weight.
    pub fn nearest(fit: &Fit<'_>, weights: &[f64]) -> Option<Self> {
        let deviation = |constraint: usize| (fit.deviation(constraint, weights).abs(), constraint);
        let mut order: Vec<(f64, usize)> = (0..fit.count()).map(deviation).collect();
        order.sort_unstable_by(|(a, first), (b, second)| a.total_cmp(b).then(first.cmp(second)));
        let mut basis = Vec::new();
        for (_, constraint) in order {
            basis.push(constraint);
            // Offsets are scaled to 1 at most: a smaller singular value means a constraint that repeats the others.
            if fit.matrix(&basis).rank(1e-6) < basis.len() {
                basis.pop();
            }
            if basis.len() == fit.unknowns() {
                break;
            }
        }
        Self::of(fit, basis)
    }

    /// The vertex in which every weight is zero.
    pub fn origin(fit: &Fit<'_>) -> Self {
        let basis = (fit.y.len()..fit.count()).collect();
        Self { weights: vec![0.0; fit.unknowns()], basis }
    }

    fn of(fit: &Fit<'_>, basis: Vec<usize>) -> Option<Self> {
        let matrix = fit.matrix(&basis);
        if !matrix.is_square() {
            return None;
        }
        let right = DVector::from_iterator(basis.len(), basis.iter().map(|&constraint| fit.right(constraint)));
        let weights: Vec<f64> = matrix.lu().solve(&right)?.iter().copied().collect();
        weights.iter().all(|&weight| weight > -ZERO).then_some(Self { weights, basis })
    }

    /// Whether two vertices are one place.
    pub fn is_at(&self, other: &Self) -> bool {
        self.weights.iter().zip(&other.weights).all(|(a, b)| (a - b).abs() <= ZERO)
    }

    /// The vertices at the ends of this one's edges, where the deviations do not grow on the way: of those that fall the
    /// steepest (in many rows the first that falls at all would lead there in ten times the steps).
    pub fn neighbours(&self, fit: &Fit<'_>) -> Neighbours {
        let deviations = self.all_deviations(fit);
        let mut edges = self.edges(fit, &deviations);
        edges.sort_by(|a, b| a.relative_slope().total_cmp(&b.relative_slope()));
        let mut neighbours = Neighbours { better: None, equal: Vec::new() };
        for edge in edges.iter().filter(|edge| edge.relative_slope() <= FLAT) {
            let Some(end) = self.end_of_edge(fit, edge, &deviations) else {
                continue;
            };
            if edge.relative_slope() < -FLAT {
                neighbours.better = Some(end);
                return neighbours;
            }
            neighbours.equal.push(end);
        }
        neighbours
    }

    /// The edges that leave this vertex: one constraint is given up, to either side; a weight only upwards.
    fn edges(&self, fit: &Fit<'_>, deviations: &[f64]) -> Vec<Edge> {
        let Some(inverse) = fit.matrix(&self.basis).try_inverse() else {
            return Vec::new();
        };
        let mut edges = Vec::with_capacity(2 * self.basis.len());
        for leaving in 0..self.basis.len() {
            let upwards: Vec<f64> = inverse.column(leaving).iter().copied().collect();
            let (slopes, scale) = slopes(fit, deviations, &upwards);
            let sides = if fit.is_weight(self.basis[leaving]) { &[1.0][..] } else { &[1.0, -1.0] };
            for (side, slope) in sides.iter().zip(slopes) {
                let direction = upwards.iter().map(|entry| side * entry).collect();
                edges.push(Edge { leaving, direction, slope, scale });
            }
        }
        edges
    }

    /// Deviation of each constraint, those that meet here exactly zero.
    fn all_deviations(&self, fit: &Fit<'_>) -> Vec<f64> {
        let mut deviations: Vec<f64> =
            (0..fit.count()).map(|constraint| fit.deviation(constraint, &self.weights)).collect();
        for &constraint in &self.basis {
            deviations[constraint] = 0.0;
        }
        deviations
    }

    /// The vertex along an edge at which the sum of deviations stops falling.
    ///
    /// Each row whose deviation changes its sign on the way adds twice its change to the rate; a weight that reaches zero ends
    /// the edge.
    fn end_of_edge(&self, fit: &Fit<'_>, edge: &Edge, deviations: &[f64]) -> Option<Self> {
        let met = deviations.iter().enumerate().filter(|(constraint, _)| !self.basis.contains(constraint));
        let met = met.filter_map(|(constraint, deviation)| {
            let slope = fit.left(constraint, &edge.direction);
            let step = -deviation / slope;
            // A weight ends the edge, however the rate stands.
            let change = if fit.is_weight(constraint) { f64::INFINITY } else { slope.abs() };
            (slope.abs() > ZERO && step > ZERO).then_some(Crossing { constraint, step, change })
        });
        let entering = crossing_at(met.collect(), -FLAT * edge.scale - edge.slope)?;
        let mut basis = self.basis.clone();
        basis[edge.leaving] = entering;
        Self::of(fit, basis)
    }

    /// Whether more constraints meet in this vertex than it takes: then its edges may not show every way down.
    pub fn is_degenerate(&self, fit: &Fit<'_>) -> bool {
        let meet = |constraint: &usize| fit.deviation(*constraint, &self.weights).abs() <= ZERO;
        (0..fit.count()).filter(meet).count() > fit.unknowns()
    }
}

/// Rates at which the sum of deviations changes along `direction` and against it, and the most it could change.
fn slopes(fit: &Fit<'_>, deviations: &[f64], direction: &[f64]) -> ([f64; 2], f64) {
    // A deviation of zero grows either way.
    let (mut growing, mut signed, mut scale) = (0.0, 0.0, 0.0);
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
