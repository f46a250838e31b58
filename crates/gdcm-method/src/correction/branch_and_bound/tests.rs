//! Rounding of the branch and bound: computed objectives are within their error bounds, and lower
//! bounds are below exact values, which are computed with 51 digits.

use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;
use proptest::prelude::*;

use gdcm_model::dataset::PairTable;

use super::convex_bound::tangent_bound;
use super::difference_bounds::DifferenceBounds;
use super::effort::Effort;
use super::expansion::{Curvature, Differentiable, Expansion, ScaleBox};
use super::newton::Newton;
use super::node_exclusion::NodeExclusion;
use super::objective::Objective;
use super::proof_budget::ProofBudget;
use super::rounded::Rounded;
use super::search::search;
use super::underestimator::Underestimator;
use crate::correction::channel_bounds::Bounds;
use crate::correction::components::{Components, Placement};
use crate::correction::constraints::Constraints;
use crate::correction::problem::Problem;
use crate::correction::quantity::{GainObjective, Quantity};
use crate::correction::scaled_objective::{rounding_floor, scaled_objective};

type Exact = FBig<HalfEven, 2>;

/// Converts a value to 170 bits, about 51 digits.
fn exact(value: f64) -> Exact {
    Exact::try_from(value).unwrap().with_precision(170).value()
}

/// Returns the exact value minus the computed value, rounded to double precision.
fn excess(value: &Exact, computed: f64) -> f64 {
    (value - exact(computed)).to_f64().value()
}

/// Exact logarithms of the channel gains, as tests compute them.
struct Logarithms {
    inputs: Vec<Exact>,
    outputs: Vec<Exact>,
}

/// Computes the exact value of a node at the given scales.
fn exact_node(node: &Placement, scales: &[f64]) -> Exact {
    exact(node.offset.value) + exact(scales[node.component])
}

/// A problem with up to three outputs and three inputs, and at most one constrained entry for each
/// output.
#[derive(Clone, Debug)]
struct RandomProblem {
    problem: Problem,
    components: Components,
    objective: Objective,
}

impl RandomProblem {
    fn new(problem: Problem) -> Self {
        let components = Components::new(&Constraints::new(&problem));
        let objective = scaled_objective(&problem, &components);
        Self {
            problem,
            components,
            objective,
        }
    }

    /// Computes the exact logarithms of the gains: an input's from the scale of its component, a
    /// constrained output's from its entry.
    fn logarithms(&self, scales: &[f64]) -> Logarithms {
        let nodes = self.components.nodes();
        let inputs: Vec<Exact> = nodes
            .inputs
            .iter()
            .map(|node| exact_node(node, scales))
            .collect();
        let mut outputs = Vec::new();
        for (index, node) in nodes.outputs.iter().enumerate() {
            let constrained = self
                .problem
                .constrained_entries()
                .find(|entry| entry.pair.output == index);
            outputs.push(match constrained {
                Some(entry) => exact(entry.delta).ln() - &inputs[entry.pair.input],
                None => -exact_node(node, scales),
            });
        }
        Logarithms { inputs, outputs }
    }

    /// Computes the exact square of an entry's residual, a difference of ratios or of dB values.
    fn exact_square(&self, delta: f64, logarithm: &Exact) -> Exact {
        let residual = match self.problem.quantity {
            Quantity::Gain(GainObjective::Ratio) => exact(delta) - logarithm.exp(),
            _ => (exact(delta).ln() - logarithm) * (exact(20.0) / exact(10.0).ln()),
        };
        &residual * &residual
    }

    /// Computes the exact objective: eq. (7), or its counterpart in dB.
    fn exact_objective(&self, scales: &[f64]) -> Exact {
        let Logarithms { inputs, outputs } = self.logarithms(scales);
        let mut sum = exact(0.0);
        for entry in self.problem.fit_entries() {
            let logarithm = &inputs[entry.pair.input] + &outputs[entry.pair.output];
            sum += self.exact_square(entry.delta, &logarithm);
        }
        for output in &outputs {
            sum += self.exact_square(1.0, output) * exact(self.problem.alpha);
        }
        sum
    }

    /// Returns the point in the box at the given shares of its width.
    fn point_at(&self, shares: &[f64]) -> Vec<f64> {
        let ends = self
            .objective
            .lower
            .iter()
            .zip(&self.objective.upper)
            .enumerate();
        ends.map(|(index, (low, high))| low + (high - low) * shares[index])
            .collect()
    }

    /// Returns a point in the box at most half a `width` from `centre` in each scale; the `shares`
    /// of the width place it.
    fn point_near(&self, centre: &[f64], shares: &[f64], width: f64) -> Vec<f64> {
        let ScaleBox { lower, upper } = self.objective.bounds();
        let mut point = Vec::new();
        for (index, scale) in centre.iter().enumerate() {
            let shifted = scale + width * (shares[index] - 0.5);
            point.push(shifted.clamp(lower[index], upper[index]));
        }
        point
    }

    /// Returns a part of the box that contains `inside`; every difference is limited to at most the
    /// share `width` on either side.
    fn region(&self, inside: &[f64], width: f64) -> DifferenceBounds {
        let mut region = DifferenceBounds::from_box(&self.objective.lower, &self.objective.upper);
        for from in 0..inside.len() {
            for to in 0..inside.len() {
                if from == to {
                    continue;
                }
                let difference = inside[to] - inside[from];
                let most = difference + width * (region.range(from, to).high - difference).max(0.0);
                region = region.below(from, to, most).unwrap();
            }
        }
        region
    }
}

/// Creates random problems.
fn random_problems() -> impl Strategy<Value = RandomProblem> {
    // Natural logarithms of the delta gains.
    let gains = prop::collection::vec(-2.0..2.0_f64, 9);
    // Input of each output's constrained entry, if any.
    let held = prop::collection::vec(prop::option::weighted(0.5, 0..3_usize), 3);
    let alpha = prop_oneof![Just(0.0), Just(1e-12), Just(1.0), Just(1e6)];
    let objective = prop_oneof![3 => Just(GainObjective::Ratio), 1 => Just(GainObjective::Decibel)];
    let bounds = (1e-3..0.3_f64, 3.0..1e3_f64);
    (
        (1..=3_usize, 1..=3_usize),
        gains,
        held,
        alpha,
        objective,
        bounds,
    )
        .prop_map(
            |((outputs, inputs), gains, held, alpha, objective, (lower, upper))| {
                let delta = PairTable::from_fn(outputs, inputs, |pair| {
                    Some(gains[3 * pair.output + pair.input].exp())
                });
                let constrained = PairTable::from_fn(outputs, inputs, |pair| {
                    held[pair.output] == Some(pair.input)
                });
                let problem = Problem::gains(delta, constrained, Bounds { lower, upper });
                RandomProblem::new(Problem {
                    quantity: Quantity::Gain(objective),
                    alpha,
                    ..problem
                })
            },
        )
}

/// Creates shares that place a point in a box, more than a problem has scales.
fn shares() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(0.0..1.0_f64, 7)
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 150,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn the_rounding_error_of_the_objective_is_within_its_bound(
        random in random_problems(),
        shares in shares(),
    ) {
        let scales = random.point_at(&shares);
        let mut expansion = Expansion::zero(scales.len());
        random.objective.expand(&scales, Curvature::True, &mut expansion);
        let Rounded { value, error } = expansion.value;
        let off = excess(&random.exact_objective(&scales), value).abs();
        prop_assert!(off <= error, "error {:e} above its bound {:e}", off, error);
        // The error bound is also sharp: at most a few hundred roundings relative to the squares,
        // which exceed their sum if terms cancel.
        let entries = random.problem.fit_entries();
        let squares: f64 = entries.map(|entry| entry.delta.powi(2) + 1.0).sum();
        let size = 1e4 * (value + squares);
        prop_assert!(error <= 1e3 * f64::EPSILON * size * (1.0 + random.problem.alpha));
    }

    #[test]
    fn no_exact_objective_in_a_node_is_below_its_bound(
        random in random_problems(),
        inside in shares(),
        others in prop::collection::vec(shares(), 4),
        // Exponent of the node size, down to sizes at which rounding errors dominate.
        decades in 0.0..16.0_f64,
    ) {
        let inside = random.point_at(&inside);
        let region = random.region(&inside, 10f64.powf(-decades));
        let mut lower = random.objective.lower.clone();
        let mut upper = random.objective.upper.clone();
        region.write_box(&mut lower, &mut upper);
        let underestimator = Underestimator::new(&random.objective, &region, 10.0);
        let effort = Effort::new(&|| false);
        let mut bound = f64::NEG_INFINITY;
        let mut scales = Vec::new();
        for (index, scale) in inside.iter().enumerate() {
            scales.push(scale.clamp(lower[index], upper[index]));
        }
        let mut newton = Newton::new(scales.len(), &effort);
        let node = ScaleBox { lower: &lower, upper: &upper };
        newton.minimise(&underestimator, node, &mut scales, |scales, at| {
            bound = bound.max(tangent_bound(scales, at, node));
            false
        });
        // Points of the node's box that are in the node.
        let mut points = vec![inside.clone()];
        for shares in &others {
            let mut point = Vec::new();
            for index in 0..inside.len() {
                point.push(lower[index] + (upper[index] - lower[index]) * shares[index]);
            }
            if region.contains(&point) {
                points.push(point);
            }
        }
        for point in points {
            let above = excess(&random.exact_objective(&point), bound);
            prop_assert!(above >= 0.0, "{:e} from the bound {:e}", above, bound);
        }
    }

    #[test]
    fn no_exact_objective_is_below_the_bound_of_the_search(
        random in random_problems(),
        others in prop::collection::vec(shares(), 4),
    ) {
        let effort = Effort::new(&|| false);
        let budget = ProofBudget { work: 300_000, listing: 0, bytes: 1_000_000 };
        let start = random.objective.nearest_to_zero();
        let floor = rounding_floor(&random.problem);
        let found = search(&random.objective, &start, budget, floor, &effort).unwrap();
        let minimum = &found.minima[0].scales;
        // Points next to the minimum, where the bound is sharp, and points all over the box.
        let mut points = vec![minimum.clone()];
        for (step, shares) in others.iter().enumerate() {
            points.push(random.point_near(minimum, shares, 10f64.powi(-4 * step as i32 - 2)));
            points.push(random.point_at(shares));
        }
        for point in points {
            let above = excess(&random.exact_objective(&point), found.lower_bound);
            prop_assert!(above >= 0.0, "{:e} from the bound {:e}", above, found.lower_bound);
        }
    }

    #[test]
    fn no_exact_objective_near_a_minimum_is_below_the_bound_from_its_curvature(
        random in random_problems(),
        others in prop::collection::vec(shares(), 6),
    ) {
        let effort = Effort::new(&|| false);
        let mut minimum = random.objective.nearest_to_zero();
        let bounds = random.objective.bounds();
        let mut newton = Newton::new(minimum.len(), &effort);
        newton.minimise(&random.objective, bounds, &mut minimum, |_, _| false);
        let mut at = Expansion::zero(minimum.len());
        random.objective.expand(&minimum, Curvature::True, &mut at);
        if let Some(bound) = NodeExclusion::new(&random.objective).bound_at(&minimum, &at) {
            for (step, shares) in others.iter().enumerate() {
                let nearby = random.point_near(&minimum, shares, 10f64.powi(-3 * step as i32 - 2));
                let above = excess(&random.exact_objective(&nearby), bound);
                prop_assert!(above >= 0.0, "{:e} from the bound {:e}", above, bound);
            }
        }
    }
}
