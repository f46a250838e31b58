//! Random problems of every shape that the optimiser must take.

use gdcm::correction::{DelayProblem, GainBounds, GainObjective, GainProblem};
use gdcm::dataset::{Pair, PairTable};
use proptest::prelude::*;

/// How the entries of a random problem are held.
#[derive(Clone, Copy, Debug)]
pub enum Pattern {
    /// At most one held entry for each output and none that closes a loop: always consistent among themselves.
    Forest,
    /// Any entry, any loops.
    Any,
}

fn entries<T: std::fmt::Debug>(
    (outputs, inputs): (usize, usize),
    entry: impl Strategy<Value = T>,
) -> impl Strategy<Value = Vec<T>> {
    prop::collection::vec(entry, outputs * inputs)
}

fn fill<T: Clone>((outputs, inputs): (usize, usize), values: &[T]) -> PairTable<T> {
    PairTable::from_fn(outputs, inputs, |pair: Pair| values[pair.output * inputs + pair.input].clone())
}

/// Marks at most one entry of each output.
fn one_each(shape: (usize, usize), marks: &[bool]) -> PairTable<bool> {
    let all = fill(shape, marks);
    let first = |pair: Pair| all[pair] && (0..pair.input).all(|input| !all[Pair::new(pair.output, input)]);
    PairTable::from_fn(shape.0, shape.1, first)
}

pub fn shapes(most: (usize, usize)) -> impl Strategy<Value = (usize, usize)> {
    (1..=most.0, 1..=most.1)
}

fn objectives() -> impl Strategy<Value = GainObjective> {
    prop_oneof![3 => Just(GainObjective::Ratio), 1 => Just(GainObjective::Decibel)]
}

pub fn alphas() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), Just(1e-6), Just(0.1), Just(1.0), Just(10.0), Just(1e6)]
}

/// Gain problems of up to `most` outputs and inputs; delta gains within `spread` (natural logarithm) of 1.
pub fn gain_problems(most: (usize, usize), spread: f64, pattern: Pattern) -> impl Strategy<Value = GainProblem> {
    let problem = move |shape: (usize, usize)| {
        let wanted = entries(shape, prop::option::weighted(0.95, (-spread..spread).prop_map(f64::exp)));
        let constrained = entries(shape, prop::bool::weighted(0.25));
        let fitted = entries(shape, prop::bool::weighted(0.9));
        let bounds = (0.2..1.0_f64, 1.0..5.0_f64, prop::bool::weighted(0.05));
        (wanted, constrained, fitted, bounds, alphas(), objectives()).prop_map(
            move |(wanted, constrained, fitted, (lower, upper, fixed), alpha, objective)| {
                let wanted = fill(shape, &wanted);
                let marks = match pattern {
                    Pattern::Forest => one_each(shape, &constrained),
                    Pattern::Any => fill(shape, &constrained),
                };
                GainProblem {
                    constrained: marks.map(|pair, mark| *mark && wanted[pair].is_some()),
                    wanted,
                    fitted: fill(shape, &fitted),
                    bounds: GainBounds { lower, upper: if fixed { lower } else { upper } },
                    alpha,
                    objective,
                }
            },
        )
    };
    shapes(most).prop_flat_map(problem)
}

/// Delay problems of up to `most` outputs and inputs; delta delays of up to a tenth of a second either way.
pub fn delay_problems(most: (usize, usize), pattern: Pattern) -> impl Strategy<Value = DelayProblem> {
    let problem = move |shape: (usize, usize)| {
        let wanted = entries(shape, prop::option::weighted(0.95, -0.1..0.1_f64));
        let constrained = entries(shape, prop::bool::weighted(0.25));
        let fitted = entries(shape, prop::bool::weighted(0.9));
        let upper = prop_oneof![1 => Just(0.0), 9 => 0.0..0.2_f64];
        (wanted, constrained, fitted, upper, alphas()).prop_map(move |(wanted, constrained, fitted, upper_s, alpha)| {
            let wanted_s = fill(shape, &wanted);
            let marks = match pattern {
                Pattern::Forest => one_each(shape, &constrained),
                Pattern::Any => fill(shape, &constrained),
            };
            DelayProblem {
                constrained: marks.map(|pair, mark| *mark && wanted_s[pair].is_some()),
                wanted_s,
                fitted: fill(shape, &fitted),
                upper_s,
                alpha,
            }
        })
    };
    shapes(most).prop_flat_map(problem)
}
