//! Quadratic terms: all entries in a least-squares objective that share the same scale difference
//! `u`, combined into a single square.
//!
//! ```text
//! sum w (u_e - u)^2 = W (u - c)^2 + sum w (u_e - c)^2,     W = sum w,   c = sum w u_e / W
//! ```
//!
//! An *entry* is a response of an output to an input, or a channel's deviation from neutral, with
//! weight `w`. Its *target* is the gain's logarithm or the delay that it needs, its *target
//! difference* `u_e` the difference between two scales (the unknowns, see [`super`]) at which it
//! meets its target. The sum is over the entries.

use super::rounded::Rounded;
use super::term::{Function, Term, TermSum};

/// An entry in an objective, whose square is `weight (target - offset - (s_input - s_output))^2`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SquareEntry {
    /// Index of the output's scale; the ground, if the entry is an input's deviation from neutral.
    pub(crate) output: usize,
    /// Index of the input's scale; the ground, if the entry is an output's deviation from neutral.
    pub(crate) input: usize,
    pub(crate) weight: f64,
    /// Coordinate (a gain's logarithm, or a delay) that the entry needs, or neutral coordinate.
    pub(crate) target: f64,
    /// Coordinate of the entry's net value if both scales are 0.
    pub(crate) offset: Rounded,
}

/// Scale difference `s_to - s_from`, `from <= to`, at which an entry meets its target.
#[derive(Clone, Copy)]
struct TargetDifference {
    from: usize,
    to: usize,
    difference: Rounded,
}

impl SquareEntry {
    /// Returns the target difference, with the two scales ordered by index.
    fn target_difference(&self) -> TargetDifference {
        let difference = self.target - self.offset.value;
        let error = self.offset.error + f64::EPSILON * (self.target.abs() + difference.abs());
        if self.output < self.input {
            TargetDifference {
                from: self.output,
                to: self.input,
                difference: Rounded {
                    value: difference,
                    error,
                },
            }
        } else {
            TargetDifference {
                from: self.input,
                to: self.output,
                difference: Rounded {
                    value: -difference,
                    error,
                },
            }
        }
    }
}

/// Sums over the entries that share the same two scales.
#[derive(Clone, Copy, Default)]
struct SquareGroup {
    count: f64,
    /// `W`.
    weight: f64,
    /// `sum weight difference`.
    moment: f64,
    /// Maximum magnitude among the differences.
    size: f64,
    /// Maximum error among the differences.
    error: f64,
}

impl SquareGroup {
    fn add(&mut self, weight: f64, difference: Rounded) {
        self.count += 1.0;
        self.weight += weight;
        self.moment += weight * difference.value;
        self.size = self.size.max(difference.value.abs());
        self.error = self.error.max(difference.error);
    }

    /// Returns the scale difference at the group's minimum. It is a quotient of sums; its error
    /// bound includes the maximum error over the entries.
    fn centre(&self) -> Rounded {
        Rounded {
            value: self.moment / self.weight,
            error: self.error + (self.count + 2.0) * f64::EPSILON * self.size,
        }
    }

    fn function(&self) -> Function {
        Function::Quadratic {
            weight: self.weight,
            centre: self.centre(),
            relative: (self.count + 2.0) * f64::EPSILON,
        }
    }
}

/// Combines the entries into one quadratic term for each pair of scales that share an entry. The
/// constant is the weighted sum of the squared residuals at the terms' minima, and of the entries
/// that no scale changes.
pub(crate) fn quadratic_terms(entries: &[SquareEntry], scales: usize) -> TermSum {
    // The group for the scales `from < to` is at `from * scales + to`.
    let mut groups = vec![SquareGroup::default(); scales * scales];
    for entry in entries {
        let target = entry.target_difference();
        groups[target.from * scales + target.to].add(entry.weight, target.difference);
    }
    let mut constant = Rounded::default();
    for entry in entries {
        let TargetDifference {
            from,
            to,
            difference,
        } = entry.target_difference();
        // Both channels in one component: no scale changes the entry, so that its whole residual is
        // constant.
        let centre = if from == to {
            Rounded::default()
        } else {
            groups[from * scales + to].centre()
        };
        let residual = difference.value - centre.value;
        let error = difference.error + centre.error + f64::EPSILON * residual.abs();
        constant.add(Rounded::square(entry.weight, residual, error, f64::EPSILON));
    }
    let mut terms = Vec::new();
    for from in 0..scales {
        for to in from + 1..scales {
            let group = groups[from * scales + to];
            if group.weight > 0.0 {
                terms.push(Term {
                    from,
                    to,
                    function: group.function(),
                });
            }
        }
    }
    TermSum { terms, constant }
}
