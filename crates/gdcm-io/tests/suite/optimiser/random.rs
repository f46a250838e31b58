//! Random problems of all shapes that the optimiser accepts.

use proptest::prelude::*;

use gdcm_method::correction::{Bounds, GainObjective, Problem, Quantity};
use gdcm_model::dataset::{Pair, PairTable};

/// Pattern of the held entries in a random problem.
#[derive(Clone, Copy, Debug)]
pub enum Pattern {
    /// At most one held entry for each output, without loops; such constraints are always
    /// consistent.
    Forest,
    /// Any entries, with any loops.
    Any,
}

/// Generates the entries of a table, row by row.
fn entries<T: std::fmt::Debug>(
    (outputs, inputs): (usize, usize),
    entry: impl Strategy<Value = T>,
) -> impl Strategy<Value = Vec<T>> {
    prop::collection::vec(entry, outputs * inputs)
}

/// Converts entries, row by row, to a table.
fn fill<T: Clone>((outputs, inputs): (usize, usize), values: &[T]) -> PairTable<T> {
    PairTable::from_fn(outputs, inputs, |pair: Pair| {
        values[pair.output * inputs + pair.input].clone()
    })
}

/// Marks only the first of the marked entries of each output.
fn first_of_each_output(shape: (usize, usize), marks: &[bool]) -> PairTable<bool> {
    let marks = fill(shape, marks);
    marks.map(|pair, mark| {
        *mark && (0..pair.input).all(|input| !marks[Pair::new(pair.output, input)])
    })
}

pub fn shapes(most: (usize, usize)) -> impl Strategy<Value = (usize, usize)> {
    (1..=most.0, 1..=most.1)
}

fn objectives() -> impl Strategy<Value = GainObjective> {
    prop_oneof![3 => Just(GainObjective::Ratio), 1 => Just(GainObjective::Decibel)]
}

pub fn alphas() -> impl Strategy<Value = f64> {
    prop_oneof![
        Just(0.0),
        Just(1e-6),
        Just(0.1),
        Just(1.0),
        Just(10.0),
        Just(1e6)
    ]
}

/// Generates the deltas, held entries and fitted entries of a problem with at most `most` outputs
/// and inputs.
fn tables(
    most: (usize, usize),
    pattern: Pattern,
    deltas: impl Strategy<Value = f64> + Clone + 'static,
) -> impl Strategy<Value = (PairTable<Option<f64>>, PairTable<bool>, PairTable<bool>)> {
    shapes(most).prop_flat_map(move |shape| {
        let deltas = entries(shape, prop::option::weighted(0.95, deltas.clone()));
        let constrained = entries(shape, prop::bool::weighted(0.25));
        let fitted = entries(shape, prop::bool::weighted(0.9));
        (deltas, constrained, fitted).prop_map(move |(deltas, constrained, fitted)| {
            let delta = fill(shape, &deltas);
            let marks = match pattern {
                Pattern::Forest => first_of_each_output(shape, &constrained),
                Pattern::Any => fill(shape, &constrained),
            };
            let constrained = marks.map(|pair, mark| *mark && delta[pair].is_some());
            (delta, constrained, fill(shape, &fitted))
        })
    })
}

/// Generates gain problems with at most `most` outputs and inputs; the natural logarithms of the
/// delta gains are within `spread` of 0.
pub fn gain_problems(
    most: (usize, usize),
    spread: f64,
    pattern: Pattern,
) -> impl Strategy<Value = Problem> {
    let deltas = (-spread..spread)
        .prop_map(f64::exp as fn(f64) -> f64)
        .boxed();
    let bounds = (0.2..1.0_f64, 1.0..5.0_f64, prop::bool::weighted(0.05));
    (
        tables(most, pattern, deltas),
        bounds,
        alphas(),
        objectives(),
    )
        .prop_map(
            |((delta, constrained, fitted), (lower, upper, fixed), alpha, objective)| {
                let bounds = Bounds {
                    lower,
                    upper: if fixed { lower } else { upper },
                };
                Problem {
                    quantity: Quantity::Gain(objective),
                    delta,
                    constrained,
                    fitted,
                    bounds,
                    alpha,
                    agreement: 0.0,
                }
            },
        )
}

/// Generates delay problems with at most `most` outputs and inputs; the delta delays are between
/// -0.1 and 0.1 s.
pub fn delay_problems(most: (usize, usize), pattern: Pattern) -> impl Strategy<Value = Problem> {
    let upper = prop_oneof![1 => Just(0.0), 9 => 0.0..0.2_f64];
    (tables(most, pattern, -0.1..0.1_f64), upper, alphas()).prop_map(
        |((delta, constrained, fitted), upper, alpha)| {
            let bounds = Bounds { lower: 0.0, upper };
            Problem {
                quantity: Quantity::Delay,
                delta,
                constrained,
                fitted,
                bounds,
                alpha,
                agreement: 0.0,
            }
        },
    )
}
