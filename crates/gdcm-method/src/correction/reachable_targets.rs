//! Stage 1: the feasible sums nearest to the constrained entries' prescribed sums (M8, M9).
//!
//! ```text
//! min sum (x_i + y_o - sum_oi)^2     subject to the box
//! ```
//!
//! The sum is over the constrained entries of infeasible components. `x_i` and `y_o` are the
//! coordinates (logarithms of gains, or delays) of input `i` and output `o`; `sum_oi` is prescribed
//! for the response of `o` to `i` ([`super::constraints`]). A *component* is a group of channels
//! that constrained entries connect; it is infeasible if its entries contradict each other or the
//! box.

use super::branch_and_bound::objective::Objective;
use super::branch_and_bound::rounded::Rounded;
use super::branch_and_bound::term::{Function, Term};
use super::components::Components;
use super::constraints::{ConstrainedSum, Constraints};

/// Result of stage 1.
#[derive(Clone, Debug)]
pub(crate) struct Reached {
    /// The constrained entries with their targets, the feasible sums nearest to the prescribed
    /// sums, ordered as [`Constraints::entries`].
    pub(crate) targets: Vec<ConstrainedSum>,
    /// Components for the constrained entries at their targets.
    pub(crate) components: Components,
    /// A point in the box that attains the targets in the infeasible components, one value per
    /// node; `None` if every entry is feasible.
    pub(crate) point: Option<Vec<f64>>,
}

/// Finds the targets: the feasible sums nearest to the prescribed sums.
///
/// ```text
/// 1  components with the prescribed sums; if all are feasible, these are the targets
/// 2  point: node values in the box that come nearest to the sums of the infeasible components
/// 3  targets: the point's sums in the infeasible components, the prescribed sums in the others
/// 4  components with the targets
/// ```
///
/// `minimise` minimises a sum of squares over a box (step 2).
pub(crate) fn reach<E>(
    constraints: &Constraints,
    minimise: impl FnOnce(&Objective) -> Result<Vec<f64>, E>,
) -> Result<Reached, E> {
    // Step 1
    let prescribed = Components::new(constraints);
    if prescribed.are_possible() {
        return Ok(Reached {
            targets: constraints.entries.clone(),
            components: prescribed,
            point: None,
        });
    }
    // Step 2
    let point = minimise(&nearest_sums(constraints, &prescribed))?;
    // Step 3
    let mut targets = constraints.entries.clone();
    for target in &mut targets {
        if prescribed.is_infeasible(target.pair) {
            let nodes = constraints.nodes_of(target.pair);
            target.sum = point[nodes.input] - point[nodes.output];
        }
    }
    // Step 4
    let components = Components::new(&constraints.with_entries(targets.clone()));
    Ok(Reached {
        targets,
        components,
        point: Some(point),
    })
}

/// Builds stage 1's least-squares problem for the infeasible components. Its variables, scales in
/// [`Objective`], are the node values, followed by the ground.
fn nearest_sums(constraints: &Constraints, prescribed: &Components) -> Objective {
    let mut lower = Vec::new();
    let mut upper = Vec::new();
    for node in 0..constraints.nodes() {
        let range = constraints.node_range(node);
        lower.push(range.low);
        upper.push(range.high);
    }
    lower.push(0.0);
    upper.push(0.0);
    let mut terms = Vec::new();
    for entry in &constraints.entries {
        if prescribed.is_infeasible(entry.pair) {
            let nodes = constraints.nodes_of(entry.pair);
            let centre = Rounded {
                value: entry.sum,
                error: 0.0,
            };
            terms.push(Term {
                from: nodes.output,
                to: nodes.input,
                function: Function::Quadratic {
                    weight: 1.0,
                    centre,
                    relative: 0.0,
                },
            });
        }
    }
    Objective {
        lower,
        upper,
        terms,
        constant: Rounded::default(),
    }
}
