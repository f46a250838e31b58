//! Edges that leave a vertex: those along which the sum of deviations does not grow, and their
//! ends.
//!
//! ```text
//! 1  slope of the sum along each edge                                                    (EdgeRates)
//! 2  end of an edge: the constraint at which the slope, which only rises, reaches zero    (Crossing)
//! ```

use std::cmp::Ordering;

use super::fit_constraints::{Fit, ZERO};
use super::vertex::Vertex;

/// Slope of the summed deviations, relative to its maximum possible magnitude, below which an edge
/// counts as flat.
const FLAT: f64 = 1e-10;

/// Destinations along a vertex's edges.
pub(super) enum Neighbours {
    /// End vertex of the steepest edge along which the deviations decrease.
    Better(Vertex),
    /// End vertices of the edges along which the deviations do not change.
    Equal(Vec<Vertex>),
}

impl Vertex {
    /// Returns the end vertices of the edges along which the deviations do not grow. Among
    /// descending edges the steepest is taken: with many rows, the first descending edge would need
    /// ten times as many steps.
    pub(super) fn neighbours(&self, fit: &Fit<'_>) -> Neighbours {
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

    /// Returns this vertex's edges. Each releases a constraint in the basis: a row in either
    /// direction, a weight only upwards. Along column `leaving` in the inverse basis matrix, that
    /// constraint's left-hand side changes at rate 1, and no other in the basis changes.
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

    /// Returns the vertex along an edge at which the summed deviations stop falling; `None` if
    /// no constraint stops the fall, or if no vertex is defined there.
    ///
    /// Each row whose deviation changes sign along the edge raises the sum's slope by twice the
    /// row's rate of change; the sum stops falling where the slope is no longer negative.
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
}

/// An edge that leaves a vertex.
struct Edge {
    /// The released constraint's position in the vertex's basis.
    leaving: usize,
    direction: Vec<f64>,
    /// Rate at which the summed deviations change along the edge.
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

/// Rates at which the summed deviations change along a direction and against it: a row whose
/// deviation is zero adds `|change|` in both; another row adds its change times the sign of its
/// deviation, and the opposite against the direction.
struct EdgeRates {
    along: f64,
    against: f64,
    /// Maximum possible magnitude for the rates.
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

/// Where an edge crosses a constraint.
struct Crossing {
    constraint: usize,
    /// Distance along the edge.
    step: f64,
    /// Half the change in the edge's slope at this crossing.
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
/// least `rise` (the slope rises by twice `change` at each crossing): a weighted median, found by
/// bisection rather than by sorting.
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
