//! Corners of a fit of least absolute deviations, and the edges between them.

use nalgebra::{DMatrix, DVector};

/// A deviation or a weight below this is zero; the right-hand sides are scaled to at most 1.
const ZERO: f64 = 1e-11;
/// A change of the sum of deviations along an edge below this part of what it could be is none.
const FLAT: f64 = 1e-10;

/// The conditions `x_i w = y_i` and `w_k = 0`, of which as many meet in a corner as there are unknowns.
pub struct Rows<'a> {
    x: &'a [Vec<f64>],
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
    pub fn new(x: &'a [Vec<f64>], y: &'a [f64]) -> Self {
        Self { x, y }
    }

    fn unknowns(&self) -> usize {
        self.x[0].len()
    }

    fn count(&self) -> usize {
        self.x.len() + self.unknowns()
    }

    /// Left-hand side of a condition at, or its change along, `w`.
    fn left(&self, condition: usize, w: &[f64]) -> f64 {
        match self.x.get(condition) {
            Some(x) => x.iter().zip(w).map(|(x, w)| x * w).sum(),
            None => w[condition - self.x.len()],
        }
    }

    fn right(&self, condition: usize) -> f64 {
        self.y.get(condition).copied().unwrap_or(0.0)
    }

    fn deviation(&self, condition: usize, w: &[f64]) -> f64 {
        self.left(condition, w) - self.right(condition)
    }

    fn is_weight(&self, condition: usize) -> bool {
        condition >= self.x.len()
    }

    fn matrix(&self, conditions: &[usize]) -> DMatrix<f64> {
        let unit = |k: usize| DVector::from_fn(self.unknowns(), |row, _| if row == k { 1.0 } else { 0.0 });
        DMatrix::from_fn(conditions.len(), self.unknowns(), |row, column| {
            self.left(conditions[row], unit(column).as_slice())
        })
    }

    /// `sum_i |x_i w - y_i|`.
    pub fn deviations(&self, w: &[f64]) -> f64 {
        (0..self.x.len()).map(|row| self.deviation(row, w).abs()).sum()
    }

    /// The weights of least squares, those below zero set to zero: not far from the corner sought.
    pub fn least_squares(&self) -> Vec<f64> {
        let x = DMatrix::from_fn(self.x.len(), self.unknowns(), |row, column| self.x[row][column]);
        let normal = x.tr_mul(&x).cholesky();
        let solution = normal.map(|normal| normal.solve(&x.tr_mul(&DVector::from_column_slice(self.y))));
        solution.map_or(vec![0.0; self.unknowns()], |w| w.iter().map(|weight| weight.max(0.0)).collect())
    }

    /// `sum_i (sqrt(x_i w) - sqrt(y_i))^2`.
    pub fn squared_root_deviations(&self, w: &[f64]) -> f64 {
        (0..self.x.len()).map(|row| (self.left(row, w).max(0.0).sqrt() - self.y[row].sqrt()).powi(2)).sum()
    }
}

impl Corner {
    /// The corner of the conditions that `weights` fulfils best; `None` where they make none, or one with a negative weight.
    pub fn nearest(rows: &Rows<'_>, weights: &[f64]) -> Option<Self> {
        let mut order: Vec<usize> = (0..rows.count()).collect();
        order.sort_by(|&a, &b| rows.deviation(a, weights).abs().total_cmp(&rows.deviation(b, weights).abs()));
        let mut active = Vec::new();
        for condition in order {
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
        let active = (rows.x.len()..rows.count()).collect();
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

    /// The corners at the ends of this one's edges, where the deviations do not grow on the way.
    pub fn neighbours(&self, rows: &Rows<'_>) -> Neighbours {
        let mut neighbours = Neighbours { better: None, equal: Vec::new() };
        let Some(inverse) = rows.matrix(&self.active).try_inverse() else {
            return neighbours;
        };
        for (leaving, &condition) in self.active.iter().enumerate() {
            for sign in [1.0, -1.0] {
                if sign < 0.0 && rows.is_weight(condition) {
                    continue;
                }
                let direction: Vec<f64> = inverse.column(leaving).iter().map(|entry| sign * entry).collect();
                let (slope, scale) = self.slope(rows, &direction);
                if slope > FLAT * scale {
                    continue;
                }
                let Some(end) = self.end_of_edge(rows, leaving, &direction, (slope, scale)) else {
                    continue;
                };
                if slope < -FLAT * scale {
                    neighbours.better = Some(end);
                    return neighbours;
                }
                neighbours.equal.push(end);
            }
        }
        neighbours
    }

    /// Rate at which the sum of deviations changes along `direction`, and the most it could change.
    fn slope(&self, rows: &Rows<'_>, direction: &[f64]) -> (f64, f64) {
        let mut slope = 0.0;
        let mut scale = 0.0;
        for row in 0..rows.x.len() {
            let change = rows.left(row, direction);
            let deviation = rows.deviation(row, &self.weights);
            let tight = deviation.abs() <= ZERO || self.active.contains(&row);
            slope += if tight { change.abs() } else { change * deviation.signum() };
            scale += change.abs();
        }
        (slope, scale)
    }

    /// The corner along `direction` at which the sum of deviations, which changes at the rate `slope`, stops falling.
    ///
    /// Each row whose deviation changes its sign on the way adds twice its change to the rate; a weight that reaches zero ends
    /// the edge.
    fn end_of_edge(
        &self,
        rows: &Rows<'_>,
        leaving: usize,
        direction: &[f64],
        (slope, scale): (f64, f64),
    ) -> Option<Self> {
        let others = (0..rows.count()).filter(|condition| !self.active.contains(condition));
        let mut met: Vec<(usize, f64, f64)> = others
            .filter_map(|condition| {
                let change = rows.left(condition, direction);
                let step = -rows.deviation(condition, &self.weights) / change;
                (change.abs() > ZERO && step > ZERO).then_some((condition, step, change.abs()))
            })
            .collect();
        met.sort_by(|(_, a, _), (_, b, _)| a.total_cmp(b));
        let mut rate = slope;
        let (entering, ..) = met.into_iter().find(|&(condition, _, change)| {
            rate += 2.0 * change;
            rows.is_weight(condition) || rate >= -FLAT * scale
        })?;
        let mut active = self.active.clone();
        active[leaving] = entering;
        Self::of(rows, active)
    }

    /// Whether more conditions meet in this corner than it takes: then its edges may not show every way down.
    pub fn is_degenerate(&self, rows: &Rows<'_>) -> bool {
        let meet = |condition: &usize| rows.deviation(*condition, &self.weights).abs() <= ZERO;
        (0..rows.count()).filter(meet).count() > rows.unknowns()
    }
}
