//! Corners of a fit of least absolute deviations, and the edges between them.

use nalgebra::{DMatrix, DVector};

/// A deviation or a weight below this is zero; the right-hand sides are scaled to at most 1.
const ZERO: f64 = 1e-11;
/// A change of the sum of deviations along an edge below this part of what it could be is none.
const FLAT: f64 = 1e-10;

/// The conditions `x_i w = y_i` and `w_k = 0`, of which as many meet in a corner as there are unknowns.
pub struct Rows<'a> {
    /// Row by row.
    x: Vec<f64>,
    unknowns: usize,
    y: &'a [f64],
}

/// A corner: its weights, and the conditions that meet in it.
#[derive(Clone, Debug)]
pub struct Corner {
    /// The weights, none below zero but for rounding.
    pub weights: Vec<f64>,
    /// Indices of the conditions: rows first, then weights.
    active: Vec<usize>,
}

/// Where the edges of a corner lead.
pub struct Neighbours {
    /// The end of an edge along which the deviations become less.
    pub better: Option<Corner>,
    /// The ends of the edges along which they stay the same.
    pub equal: Vec<Corner>,
}

impl<'a> Rows<'a> {
    /// The conditions of the fit of `y` by `x`.
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

    /// Left-hand side of a condition at, or its change along, `w`.
    fn left(&self, condition: usize, w: &[f64]) -> f64 {
        if self.is_weight(condition) {
            return w[condition - self.y.len()];
        }
        self.row(condition).iter().zip(w).map(|(x, w)| x * w).sum()
    }

    fn right(&self, condition: usize) -> f64 {
        self.y.get(condition).copied().unwrap_or(0.0)
    }

    fn deviation(&self, condition: usize, w: &[f64]) -> f64 {
        self.left(condition, w) - self.right(condition)
    }

    fn is_weight(&self, condition: usize) -> bool {
        condition >= self.y.len()
    }

    fn matrix(&self, conditions: &[usize]) -> DMatrix<f64> {
        let unit = |k: usize| DVector::from_fn(self.unknowns(), |row, _| if row == k { 1.0 } else { 0.0 });
        DMatrix::from_fn(conditions.len(), self.unknowns(), |row, column| {
            self.left(conditions[row], unit(column).as_slice())
        })
    }

    /// `sum_i |x_i w - y_i|`.
    pub fn deviations(&self, w: &[f64]) -> f64 {
        (0..self.y.len()).map(|row| self.deviation(row, w).abs()).sum()
    }

    /// The weights of least squares, those below zero set to zero: not far from the corner sought.
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

/// A way out of a corner.
struct Edge {
    /// Which of the corner's conditions is given up.
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

/// Where an edge meets the place of a condition.
struct Crossing {
    condition: usize,
    /// How far along the edge.
    step: f64,
    /// By how much the rate changes there, halved.
    change: f64,
}

/// The condition of the first crossing at which the doubled changes so far come to `rise`: a weighted median, found by halving
/// what is left rather than by sorting it.
fn crossing_at(mut crossings: Vec<Crossing>, rise: f64) -> Option<usize> {
    let by_step = |a: &Crossing, b: &Crossing| a.step.total_cmp(&b.step).then(a.condition.cmp(&b.condition));
    let (mut left, mut risen) = (crossings.as_mut_slice(), 0.0);
    loop {
        if left.len() <= 1 {
            return left.first().filter(|last| risen + 2.0 * last.change >= rise).map(|last| last.condition);
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

impl Corner {
    /// The corner of the conditions that `weights` fulfils best; `None` where they make none, or one with a negative weight.
    pub fn nearest(rows: &Rows<'_>, weights: &[f64]) -> Option<Self> {
        let deviation = |condition: usize| (rows.deviation(condition, weights).abs(), condition);
        let mut order: Vec<(f64, usize)> = (0..rows.count()).map(deviation).collect();
        order.sort_unstable_by(|(a, first), (b, second)| a.total_cmp(b).then(first.cmp(second)));
        let mut active = Vec::new();
        for (_, condition) in order {
            active.push(condition);
            // Offsets are scaled to 1 at most: a smaller singular value means a condition that repeats the others.
            if rows.matrix(&active).rank(1e-6) < active.len() {
                active.pop();
            }
            if active.len() == rows.unknowns() {
                break;
            }
        }
        Self::of(rows, active)
    }

    /// The corner in which every weight is zero.
    pub fn origin(rows: &Rows<'_>) -> Self {
        let active = (rows.y.len()..rows.count()).collect();
        Self { weights: vec![0.0; rows.unknowns()], active }
    }

    fn of(rows: &Rows<'_>, active: Vec<usize>) -> Option<Self> {
        let matrix = rows.matrix(&active);
        if !matrix.is_square() {
            return None;
        }
        let right = DVector::from_iterator(active.len(), active.iter().map(|&condition| rows.right(condition)));
        let weights: Vec<f64> = matrix.lu().solve(&right)?.iter().copied().collect();
        weights.iter().all(|&weight| weight > -ZERO).then_some(Self { weights, active })
    }

    /// Whether two corners are one place.
    pub fn is_at(&self, other: &Self) -> bool {
        self.weights.iter().zip(&other.weights).all(|(a, b)| (a - b).abs() <= ZERO)
    }

    /// The corners at the ends of this one's edges, where the deviations do not grow on the way: of those that fall the
    /// steepest (in many rows the first that falls at all would lead there in ten times the steps).
    pub fn neighbours(&self, rows: &Rows<'_>) -> Neighbours {
        let deviations = self.all_deviations(rows);
        let mut edges = self.edges(rows, &deviations);
        edges.sort_by(|a, b| a.relative_slope().total_cmp(&b.relative_slope()));
        let mut neighbours = Neighbours { better: None, equal: Vec::new() };
        for edge in edges.iter().filter(|edge| edge.relative_slope() <= FLAT) {
            let Some(end) = self.end_of_edge(rows, edge, &deviations) else {
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

    /// The edges that leave this corner: one condition is given up, to either side; a weight only upwards.
    fn edges(&self, rows: &Rows<'_>, deviations: &[f64]) -> Vec<Edge> {
        let Some(inverse) = rows.matrix(&self.active).try_inverse() else {
            return Vec::new();
        };
        let mut edges = Vec::with_capacity(2 * self.active.len());
        for leaving in 0..self.active.len() {
            let upwards: Vec<f64> = inverse.column(leaving).iter().copied().collect();
            let (slopes, scale) = slopes(rows, deviations, &upwards);
            let sides = if rows.is_weight(self.active[leaving]) { &[1.0][..] } else { &[1.0, -1.0] };
            for (side, slope) in sides.iter().zip(slopes) {
                let direction = upwards.iter().map(|entry| side * entry).collect();
                edges.push(Edge { leaving, direction, slope, scale });
            }
        }
        edges
    }

    /// Deviation of each condition, those that meet here exactly zero.
    fn all_deviations(&self, rows: &Rows<'_>) -> Vec<f64> {
        let mut deviations: Vec<f64> =
            (0..rows.count()).map(|condition| rows.deviation(condition, &self.weights)).collect();
        for &condition in &self.active {
            deviations[condition] = 0.0;
        }
        deviations
    }

    /// The corner along an edge at which the sum of deviations stops falling.
    ///
    /// Each row whose deviation changes its sign on the way adds twice its change to the rate; a weight that reaches zero ends
    /// the edge.
    fn end_of_edge(&self, rows: &Rows<'_>, edge: &Edge, deviations: &[f64]) -> Option<Self> {
        let met = deviations.iter().enumerate().filter(|(condition, _)| !self.active.contains(condition));
        let met = met.filter_map(|(condition, deviation)| {
            let slope = rows.left(condition, &edge.direction);
            let step = -deviation / slope;
            // A weight ends the edge, however the rate stands.
            let change = if rows.is_weight(condition) { f64::INFINITY } else { slope.abs() };
            (slope.abs() > ZERO && step > ZERO).then_some(Crossing { condition, step, change })
        });
        let entering = crossing_at(met.collect(), -FLAT * edge.scale - edge.slope)?;
        let mut active = self.active.clone();
        active[edge.leaving] = entering;
        Self::of(rows, active)
    }

    /// Whether more conditions meet in this corner than it takes: then its edges may not show every way down.
    pub fn is_degenerate(&self, rows: &Rows<'_>) -> bool {
        let meet = |condition: &usize| rows.deviation(*condition, &self.weights).abs() <= ZERO;
        (0..rows.count()).filter(meet).count() > rows.unknowns()
    }
}

/// Rates at which the sum of deviations changes along `direction` and against it, and the most it could change.
fn slopes(rows: &Rows<'_>, deviations: &[f64], direction: &[f64]) -> ([f64; 2], f64) {
    // A deviation of zero grows either way.
    let (mut growing, mut signed, mut scale) = (0.0, 0.0, 0.0);
    for (row, deviation) in deviations[..rows.y.len()].iter().enumerate() {
        let change = rows.left(row, direction);
        if deviation.abs() <= ZERO {
            growing += change.abs();
        } else {
            signed += change * deviation.signum();
        }
        scale += change.abs();
    }
    ([growing + signed, growing - signed], scale)
}
