//! One step from vertex to vertex in the simplex method for least absolute deviations (Barrodale
//! and Roberts, SIAM J. Numer. Anal. 10(5), 1973): the edges that leave a vertex, and their ends.
//!
//! The problem is `min sum_i |x_i w - y_i|` over `w >= 0`. A *constraint* is a row, `x_i w = y_i`,
//! or a weight, `w_k = 0`; indices count the rows first. Its *left-hand side* is `x_i w` or `w_k`.
//! A *vertex* is the point at which the constraints in its *basis*, one for each unknown, hold. An
//! *edge* releases one constraint in the basis and keeps the others.
//!
//! Along an edge, a constraint's *rate* is the rate at which its left-hand side changes, and the
//! *slope* is the rate at which the sum changes. The sum is convex and piecewise linear there: its
//! slope changes only where a row's deviation `x_i w - y_i` changes sign.
//!
//! ```text
//! 1  every edge and the sum's slope along it                         (Vertex::edges, EdgeSlopes)
//! 2  keep the edges along which the sum does not rise, steepest first relative to their scale
//! 3  end of an edge: the first crossing of a constraint at which the sum stops falling
//!                                                            (Vertex::crossings, crossing_at)
//! 4  exchange: the crossed constraint replaces the released one      (Vertex::end_of_edge)
//! 5  the first descending edge with an end: go there; otherwise return the ends of all flat edges
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
    /// descending edges the steepest relative to its scale is taken: with many rows, the first
    /// descending edge would need ten times as many steps.
    pub(super) fn neighbours(&self, fit: &Fit<'_>) -> Neighbours {
        let deviations = self.deviations(fit);
        // Step 1
        let mut edges = self.edges(fit, &deviations);
        // Step 2
        edges.retain(|edge| edge.relative_slope() <= FLAT);
        edges.sort_by(|a, b| a.relative_slope().total_cmp(&b.relative_slope()));
        let mut equal = Vec::new();
        // Steps 3 to 5
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

    /// Returns this vertex's edges (step 1). Each releases a constraint in the basis: a row in
    /// either direction, a weight only upwards, because it must not become negative. Along column
    /// `leaving` in the inverse basis matrix, that constraint's rate is 1, and those of the others
    /// in the basis are 0.
    fn edges(&self, fit: &Fit<'_>, deviations: &[f64]) -> Vec<Edge> {
        let Some(inverse) = fit.matrix(&self.basis).try_inverse() else {
            return Vec::new();
        };
        let mut edges = Vec::with_capacity(2 * self.basis.len());
        for leaving in 0..self.basis.len() {
            let direction: Vec<f64> = inverse.column(leaving).iter().copied().collect();
            let opposite: Vec<f64> = direction.iter().map(|entry| -entry).collect();
            let slopes = EdgeSlopes::new(fit, deviations, &direction);
            edges.push(Edge {
                leaving,
                direction,
                slope: slopes.along,
                scale: slopes.scale,
            });
            if !fit.is_weight(self.basis[leaving]) {
                edges.push(Edge {
                    leaving,
                    direction: opposite,
                    slope: slopes.against,
                    scale: slopes.scale,
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

    /// Returns the vertex along an edge at which the summed deviations stop falling (steps 3 and
    /// 4); `None` if no constraint stops the fall, or if no vertex is defined there.
    ///
    /// Each row whose deviation changes sign along the edge raises the sum's slope by twice the
    /// magnitude of the row's rate; the sum stops falling where the slope is no longer negative.
    /// Along a flat edge, that is already so at the start: it ends at its first crossing.
    fn end_of_edge(&self, fit: &Fit<'_>, edge: &Edge, deviations: &[f64]) -> Option<Self> {
        // Step 3: the slope must rise until it counts as flat.
        let crossings = self.crossings(fit, edge, deviations);
        let entering = crossing_at(crossings, -FLAT * edge.scale - edge.slope)?;
        // Step 4
        let mut basis = self.basis.clone();
        basis[edge.leaving] = entering;
        Self::from_basis(fit, basis)
    }

    /// Returns the crossings of an edge with all constraints outside the basis, in any order.
    fn crossings(&self, fit: &Fit<'_>, edge: &Edge, deviations: &[f64]) -> Vec<Crossing> {
        let mut crossings = Vec::new();
        for (constraint, deviation) in deviations.iter().enumerate() {
            if self.basis.contains(&constraint) {
                continue;
            }
            let rate = fit.left_hand_side(constraint, &edge.direction);
            let step = -deviation / rate;
            // A weight that reaches zero ends the edge, whatever the rate.
            let slope_rise = if fit.is_weight(constraint) {
                f64::INFINITY
            } else {
                2.0 * rate.abs()
            };
            // Constraints that hold already have no step and are skipped: `EdgeSlopes` includes the
            // rows among them, and if a weight becomes negative, `from_basis` returns `None`.
            if rate.abs() > ZERO && step > ZERO {
                crossings.push(Crossing {
                    constraint,
                    step,
                    slope_rise,
                });
            }
        }
        crossings
    }
}

/// An edge that leaves a vertex.
struct Edge {
    /// The released constraint's position in the vertex's basis.
    leaving: usize,
    direction: Vec<f64>,
    /// Slope of the summed deviations at the start of the edge.
    slope: f64,
    /// Maximum possible magnitude of `slope`: the sum over the rows of their rates' magnitudes.
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

/// Slopes of the summed deviations along a direction and against it. A row whose deviation is zero
/// adds the magnitude of its rate to both; another row adds its rate times the sign of its
/// deviation, and the opposite against the direction.
struct EdgeSlopes {
    along: f64,
    against: f64,
    /// Maximum possible magnitude of the slopes.
    scale: f64,
}

impl EdgeSlopes {
    fn new(fit: &Fit<'_>, deviations: &[f64], direction: &[f64]) -> Self {
        let mut growing = 0.0;
        let mut signed = 0.0;
        let mut scale = 0.0;
        for (row, deviation) in deviations[..fit.y.len()].iter().enumerate() {
            let rate = fit.left_hand_side(row, direction);
            if deviation.abs() <= ZERO {
                // A zero deviation grows in either direction.
                growing += rate.abs();
            } else {
                signed += rate * deviation.signum();
            }
            scale += rate.abs();
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
    /// Rise in the sum's slope at this crossing: twice the magnitude of the row's rate, or infinity
    /// for a weight.
    slope_rise: f64,
}

impl Crossing {
    /// Orders crossings along the edge; ties by constraint index.
    fn compare(&self, other: &Self) -> Ordering {
        self.step
            .total_cmp(&other.step)
            .then(self.constraint.cmp(&other.constraint))
    }
}

/// Returns the constraint at the first crossing along an edge at which the sum's slope has risen by
/// at least `required_rise` since the start: a weighted median, found by bisection rather than by
/// sorting, in a time proportional to the crossing count. `None` if it never rises that far.
fn crossing_at(mut crossings: Vec<Crossing>, required_rise: f64) -> Option<usize> {
    // `candidates` contains the crossing; the slope has risen by `risen` before them.
    let mut candidates = crossings.as_mut_slice();
    let mut risen = 0.0;
    while candidates.len() > 1 {
        let (nearer, _, _) =
            candidates.select_nth_unstable_by(candidates.len() / 2, Crossing::compare);
        let middle = nearer.len();
        let nearer_rise: f64 = nearer.iter().map(|crossing| crossing.slope_rise).sum();
        if risen + nearer_rise >= required_rise {
            candidates = &mut candidates[..middle];
        } else {
            risen += nearer_rise;
            candidates = &mut candidates[middle..];
        }
    }
    let last = candidates.first()?;
    if risen + last.slope_rise >= required_rise {
        Some(last.constraint)
    } else {
        None
    }
}
