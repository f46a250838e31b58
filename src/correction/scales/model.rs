//! The quadratic model of a descent's step, minimised over the box.

/// Working memory of a step: `minimise` fills `step`.
#[derive(Clone, Debug)]
pub(crate) struct Model {
    nodes: usize,
    /// The step found.
    pub(crate) step: Vec<f64>,
    slope: Vec<f64>,
    free: Vec<usize>,
    is_free: Vec<bool>,
    factor: Vec<f64>,
    move_to: Vec<f64>,
}

impl Model {
    /// Room for `nodes` scales.
    pub(crate) fn new(nodes: usize) -> Self {
        Self {
            nodes,
            step: vec![0.0; nodes],
            slope: vec![0.0; nodes],
            free: Vec::with_capacity(nodes),
            is_free: vec![false; nodes],
            factor: vec![0.0; nodes * nodes],
            move_to: vec![0.0; nodes],
        }
    }

    /// Minimises `g d + d H d / 2` over `low <= d <= high` (which hold 0) by a primal active-set method: exact, finite.
    ///
    /// Returns the decrease, or `None` where `H` is not positive definite on a face that the method visits. Nodes with
    /// `low == high` stay.
    pub(crate) fn minimise(&mut self, gradient: &[f64], curvature: &[f64], low: &[f64], high: &[f64]) -> Option<f64> {
        self.step.fill(0.0);
        self.slope.copy_from_slice(gradient);
        for node in 0..self.nodes {
            let slope = gradient[node];
            let stopped = (low[node] >= 0.0 && slope >= 0.0) || (high[node] <= 0.0 && slope <= 0.0);
            self.is_free[node] = low[node] < high[node] && !stopped;
        }
        let ridge = 1e-12 * (0..self.nodes).map(|node| curvature[node * self.nodes + node]).fold(0.0, f64::max);
        // Each pass adds a stop or releases one after a decrease; 8 n passes are far above what is ever needed.
        for _ in 0..8 * self.nodes + 8 {
            self.solve_free(curvature, ridge)?;
            let (fraction, blocking) = self.longest_step(low, high);
            for &node in &self.free {
                self.step[node] += fraction * self.move_to[node];
            }
            self.update_slope(gradient, curvature);
            if let Some((node, end)) = blocking {
                self.step[node] = end;
                self.is_free[node] = false;
            } else if let Some(node) = self.worst_stop(low, high) {
                self.is_free[node] = true;
            } else {
                break;
            }
        }
        let change: f64 = (0..self.nodes).map(|node| 0.5 * (gradient[node] + self.slope[node]) * self.step[node]).sum();
        Some(-change)
    }

    /// `move_to = -H_ff^-1 slope_f` over the free nodes, by Cholesky.
    fn solve_free(&mut self, curvature: &[f64], ridge: f64) -> Option<()> {
        self.free.clear();
        self.free.extend((0..self.nodes).filter(|&node| self.is_free[node]));
        let size = self.free.len();
        for row in 0..size {
            for column in 0..=row {
                let mut entry = curvature[self.free[row] * self.nodes + self.free[column]];
                if row == column {
                    entry += ridge;
                }
                for inner in 0..column {
                    entry -= self.factor[row * self.nodes + inner] * self.factor[column * self.nodes + inner];
                }
                self.factor[row * self.nodes + column] = if row > column {
                    entry / self.factor[column * self.nodes + column]
                } else if entry > 0.1 * ridge {
                    entry.sqrt()
                } else if curvature[self.free[row] * self.nodes + self.free[row]] == 0.0 && ridge == 0.0 {
                    // Nothing bends anywhere: the objective does not depend on the scales.
                    1.0
                } else {
                    return None;
                };
            }
        }
        for row in 0..size {
            let mut entry = -self.slope[self.free[row]];
            for inner in 0..row {
                entry -= self.factor[row * self.nodes + inner] * self.move_to[self.free[inner]];
            }
            self.move_to[self.free[row]] = entry / self.factor[row * self.nodes + row];
        }
        for row in (0..size).rev() {
            let mut entry = self.move_to[self.free[row]];
            for inner in row + 1..size {
                entry -= self.factor[inner * self.nodes + row] * self.move_to[self.free[inner]];
            }
            self.move_to[self.free[row]] = entry / self.factor[row * self.nodes + row];
        }
        Some(())
    }

    /// The fraction of the move that the box allows, with the node that stops it and where.
    fn longest_step(&self, low: &[f64], high: &[f64]) -> (f64, Option<(usize, f64)>) {
        let mut fraction = 1.0;
        let mut blocking = None;
        for &node in &self.free {
            let target = self.step[node] + self.move_to[node];
            let end = if target < low[node] {
                low[node]
            } else if target > high[node] {
                high[node]
            } else {
                continue;
            };
            let allowed = ((end - self.step[node]) / self.move_to[node]).max(0.0);
            if allowed < fraction || blocking.is_none() {
                fraction = allowed.min(fraction);
                blocking = Some((node, end));
            }
        }
        (fraction, blocking)
    }

    fn update_slope(&mut self, gradient: &[f64], curvature: &[f64]) {
        for node in 0..self.nodes {
            let row = &curvature[node * self.nodes..(node + 1) * self.nodes];
            self.slope[node] = gradient[node] + row.iter().zip(&self.step).map(|(h, d)| h * d).sum::<f64>();
        }
    }

    /// The stopped node whose release helps most, or `None` at the minimum.
    fn worst_stop(&self, low: &[f64], high: &[f64]) -> Option<usize> {
        let scale = self.slope.iter().fold(0.0_f64, |most, slope| most.max(slope.abs()));
        let mut worst = None;
        let mut greatest = 1e-14 * scale;
        for node in 0..self.nodes {
            if self.is_free[node] || low[node] >= high[node] {
                continue;
            }
            let inward = if self.step[node] <= low[node] { -self.slope[node] } else { self.slope[node] };
            if inward > greatest {
                greatest = inward;
                worst = Some(node);
            }
        }
        worst
    }
}
