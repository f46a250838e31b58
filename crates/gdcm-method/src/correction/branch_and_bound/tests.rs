//! Values and lower bounds against the same in 50 digits.

use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;
use proptest::prelude::*;

use gdcm_model::dataset::{Pair, PairTable};

use super::super::components::{Components, Held};
use super::super::problem::{Bounds, GainObjective, Problem, Quantity, floor, objective};
use super::objective::Differentiable;
use crate::correction::branch_and_bound::node_exclusion::NodeExclusion;
use crate::correction::branch_and_bound::objective::{Curvature, Expansion, Newton, Objective};
use crate::correction::branch_and_bound::search::{Effort, ProofBudget, search};
use crate::correction::branch_and_bound::underestimator::{
    DifferenceBounds, Underestimator, tangent_bound,
};

type Exact = FBig<HalfEven, 2>;

/// 170 bits: 51 digits.
fn exact(figure: f64) -> Exact {
    Exact::try_from(figure).unwrap().with_precision(170).value()
}

/// The exact figure less the computed one, in double precision.
fn excess(figure: &Exact, computed: f64) -> f64 {
    (figure - exact(computed)).to_f64().value()
}

/// Problem of up to three outputs and three inputs, with at most one constrained entry for each
/// output.
#[derive(Clone, Debug)]
struct Sample {
    problem: Problem,
    components: Components,
    objective: Objective,
}

impl Sample {
    fn new(problem: Problem) -> Self {
        let components = Components::new(&Held::of(&problem));
        let objective = objective(&problem, &components);
        Self {
            problem,
            components,
            objective,
        }
    }

    /// Exact logarithms of the gains: an input's is its component's scale, a constrained output's
    /// follows from its entry.
    fn logarithms(&self, scales: &[f64]) -> (Vec<Exact>, Vec<Exact>) {
        let node = |placed: &super::super::components::Placement| {
            exact(placed.offset.value) + exact(scales[placed.component])
        };
        let (inputs, outputs) = self.components.sides();
        let inputs: Vec<Exact> = inputs.iter().map(node).collect();
        let output = |(index, placed): (usize, &super::super::components::Placement)| {
            let held = self
                .problem
                .held_entries()
                .find(|(pair, _)| pair.output == index);
            match held {
                Some((pair, delta)) => exact(delta).ln() - &inputs[pair.input],
                None => -node(placed),
            }
        };
        let outputs = outputs.iter().enumerate().map(output).collect();
        (inputs, outputs)
    }

    /// The exact objective: equation (7), or its counterpart in dB.
    fn exact_objective(&self, scales: &[f64]) -> Exact {
        let (inputs, outputs) = self.logarithms(scales);
        let decibel = exact(20.0) / exact(10.0).ln();
        let square = |delta: f64, logarithm: &Exact| {
            let miss = match self.problem.quantity {
                Quantity::Gain(GainObjective::Ratio) => exact(delta) - logarithm.exp(),
                _ => (exact(delta).ln() - logarithm) * &decibel,
            };
            &miss * &miss
        };
        let mut sum = exact(0.0);
        for (pair, delta) in self.problem.fit_entries() {
            sum += square(delta, &(&inputs[pair.input] + &outputs[pair.output]));
        }
        for output in &outputs {
            sum += square(1.0, output) * exact(self.problem.alpha);
        }
        sum
    }

    /// The point of the box at these shares of its width.
    fn at(&self, shares: &[f64]) -> Vec<f64> {
        let ends = self
            .objective
            .lower
            .iter()
            .zip(&self.objective.upper)
            .enumerate();
        ends.map(|(index, (low, high))| low + (high - low) * shares[index])
            .collect()
    }

    /// Part of the box that contains `inside`: every difference is cut at a share of the width on
    /// either side of it.
    fn region(&self, inside: &[f64], width: f64) -> DifferenceBounds {
        let mut region = DifferenceBounds::of_box(&self.objective.lower, &self.objective.upper);
        for from in 0..inside.len() {
            for to in 0..inside.len() {
                let difference = inside[to] - inside[from];
                let most = difference + width * (region.range(from, to).1 - difference).max(0.0);
                region = if from == to {
                    region
                } else {
                    region.below(from, to, most).unwrap()
                };
            }
        }
        region
    }
}

fn samples() -> impl Strategy<Value = Sample> {
    let gains = prop::collection::vec(-2.0..2.0_f64, 9);
    let held = prop::collection::vec(prop::option::weighted(0.5, 0..3_usize), 3);
    let alpha = prop_oneof![Just(0.0), Just(1e-12), Just(1.0), Just(1e6)];
    let kind = prop_oneof![3 => Just(GainObjective::Ratio), 1 => Just(GainObjective::Decibel)];
    let bounds = (1e-3..0.3_f64, 3.0..1e3_f64);
    ((1..=3_usize, 1..=3_usize), gains, held, alpha, kind, bounds).prop_map(
        |((outputs, inputs), gains, held, alpha, kind, (lower, upper))| {
            let delta = PairTable::from_fn(outputs, inputs, |pair| {
                Some(gains[3 * pair.output + pair.input].exp())
            });
            let constrained = PairTable::from_fn(outputs, inputs, |pair| {
                held[pair.output] == Some(pair.input)
            });
            let problem = Problem::gains(delta, constrained, Bounds { lower, upper });
            Sample::new(Problem {
                quantity: Quantity::Gain(kind),
                alpha,
                ..problem
            })
        },
    )
}

fn shares() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(0.0..1.0_f64, 7)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_objective_is_known_to_its_rounding(sample in samples(), shares in shares()) {
        let scales = sample.at(&shares);
        let mut expansion = Expansion::zero(scales.len());
        sample.objective.expand(&scales, Curvature::True, &mut expansion);
        let off = excess(&sample.exact_objective(&scales), expansion.value.value).abs();
        prop_assert!(off <= expansion.value.error, "off by {:e}, not {:e}", off, expansion.value.error);
        // The bound is sharp, too: some hundred roundings of the squares' size, which differs from
        // the sum's where they cancel.
        let delta = |(_, delta): (Pair, f64)| delta.powi(2) + 1.0;
        let size = 1e4 * (expansion.value.value + sample.problem.fit_entries().map(delta).sum::<f64>());
        prop_assert!(expansion.value.error <= 1e3 * f64::EPSILON * size * (1.0 + sample.problem.alpha));
    }

    #[test]
    fn no_exact_value_in_a_node_is_below_its_bound(
        sample in samples(),
        inside in shares(),
        others in prop::collection::vec(shares(), 4),
        // Down to nodes in which rounding decides.
        decades in 0.0..16.0_f64,
    ) {
        let inside = sample.at(&inside);
        let region = sample.region(&inside, 10f64.powf(-decades));
        let mut lower = sample.objective.lower.clone();
        let mut upper = sample.objective.upper.clone();
        region.write_box(&mut lower, &mut upper);
        let underestimator = Underestimator::new(&sample.objective, &region, 10.0);
        let effort = Effort::new(&|| false);
        let mut bound = f64::NEG_INFINITY;
        let mut scales: Vec<f64> =
            inside.iter().enumerate().map(|(index, scale)| scale.clamp(lower[index], upper[index])).collect();
        let mut newton = Newton::new(scales.len(), &effort);
        newton.minimise(&underestimator, (&lower, &upper), &mut scales, |scales, at| {
            bound = bound.max(tangent_bound(scales, at, (&lower, &upper)));
            false
        });
        let nearby = |shares: &Vec<f64>| -> Vec<f64> {
            let at = |index: usize| lower[index] + (upper[index] - lower[index]) * shares[index];
            (0..inside.len()).map(at).collect()
        };
        let points = others.iter().map(nearby).filter(|point| region.holds(point));
        for point in points.chain([inside.clone()]) {
            let above = excess(&sample.exact_objective(&point), bound);
            prop_assert!(above >= 0.0, "{:e} below {:e}", above, bound);
        }
    }

    #[test]
    fn no_exact_value_is_below_the_bound_of_the_search(sample in samples(), others in prop::collection::vec(shares(), 4)) {
        let effort = Effort::new(&|| false);
        let budget = ProofBudget { work: 300_000, listing: 0, bytes: 1_000_000 };
        let start = sample.objective.nearest_to_zero();
        let found = search(&sample.objective, &start, budget, floor(&sample.problem), &effort).unwrap();
        let minimum = &found.minima[0].0;
        // Next to the minimum, where the bound is sharp, and all over the box.
        let near = others.iter().enumerate().map(|(step, shares)| {
            let width = 10f64.powi(-4 * step as i32 - 2);
            let ends = sample.objective.lower.iter().zip(&sample.objective.upper).enumerate();
            ends.map(|(index, (low, high))| (minimum[index] + width * (shares[index] - 0.5)).clamp(*low, *high)).collect()
        });
        for point in near.chain(others.iter().map(|shares| sample.at(shares))).chain([minimum.clone()]) {
            let above = excess(&sample.exact_objective(&point), found.lower_bound);
            prop_assert!(above >= 0.0, "{:e} below {:e}", above, found.lower_bound);
        }
    }

    #[test]
    fn the_bound_from_the_curvature_at_a_minimum_holds_next_to_it(sample in samples(), others in prop::collection::vec(shares(), 6)) {
        let effort = Effort::new(&|| false);
        let mut minimum = sample.objective.nearest_to_zero();
        let bounds = (sample.objective.lower.as_slice(), sample.objective.upper.as_slice());
        Newton::new(minimum.len(), &effort).minimise(&sample.objective, bounds, &mut minimum, |_, _| false);
        let mut at = Expansion::zero(minimum.len());
        sample.objective.expand(&minimum, Curvature::True, &mut at);
        if let Some(bound) = NodeExclusion::new(&sample.objective).bound_at(&minimum, &at) {
            for (step, shares) in others.iter().enumerate() {
                let width = 10f64.powi(-3 * step as i32 - 2);
                let ends = bounds.0.iter().zip(bounds.1).enumerate();
                let nearby: Vec<f64> = ends
                    .map(|(index, (low, high))| (minimum[index] + width * (shares[index] - 0.5)).clamp(*low, *high))
                    .collect();
                let above = excess(&sample.exact_objective(&nearby), bound);
                prop_assert!(above >= 0.0, "{:e} below {:e}", above, bound);
            }
        }
    }
}
