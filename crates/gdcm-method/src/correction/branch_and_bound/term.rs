//! Terms of the objective, functions of the difference of two scales, with bounds on their
//! rounding.

use std::ops::Neg;

/// One term of the objective, a function of `u = s_to - s_from`.
#[derive(Clone, Debug)]
pub(crate) struct Term {
    /// Index of the subtracted scale.
    pub(crate) from: usize,
    /// Index of the added scale.
    pub(crate) to: usize,
    pub(crate) function: Function,
}

/// A function of one difference of scales.
#[derive(Clone, Debug)]
pub(crate) enum Function {
    /// `weight (u - centre)^2`: gains compared in dB, and delays. The weight is known to
    /// `relative`.
    Quadratic {
        weight: f64,
        centre: Rounded,
        relative: f64,
    },
    /// `forward` in `u` plus `backward` in `-u`: gains compared as ratios.
    Exponential {
        forward: Exponential,
        backward: Exponential,
        concave: Option<(f64, f64)>,
    },
}

impl Function {
    /// The two exponentials, with the interval of `u` on which their sum is concave.
    pub(crate) fn exponential(forward: Exponential, backward: Exponential) -> Self {
        Function::Exponential {
            forward,
            backward,
            concave: concave_interval(&forward, &backward),
        }
    }

    /// Value, slope and curvature at `u`.
    pub(crate) fn at(&self, u: f64) -> Derivatives {
        match self {
            Function::Quadratic {
                weight,
                centre,
                relative,
            } => {
                let away = u - centre.value;
                let error = centre.error + f64::EPSILON * (u.abs() + away.abs());
                let slope = 2.0 * weight * away;
                Derivatives {
                    value: Rounded::square(*weight, away, error, *relative),
                    slope: Rounded {
                        value: slope,
                        error: 2.0 * weight * error + (relative + f64::EPSILON) * slope.abs(),
                    },
                    curvature: 2.0 * weight,
                }
            }
            Function::Exponential {
                forward, backward, ..
            } => {
                let z = u.exp();
                let ahead = forward.at(u, z);
                if backward.is_zero() {
                    ahead
                } else {
                    both(ahead, backward.at(-u, 1.0 / z))
                }
            }
        }
    }

    /// Whether the function is convex over `[low, high]`.
    pub(crate) fn is_convex_over(&self, (low, high): (f64, f64)) -> bool {
        match self {
            Function::Quadratic { .. } => true,
            Function::Exponential { concave, .. } => {
                concave.is_none_or(|(from, to)| high <= from || low >= to)
            }
        }
    }

    /// The end of the concave interval between `u` and that interval, if `u` is outside and the end
    /// is inside `(low, high)`.
    pub(crate) fn concave_end(&self, u: f64, (low, high): (f64, f64)) -> Option<f64> {
        let Function::Exponential {
            concave: Some((from, to)),
            ..
        } = self
        else {
            return None;
        };
        let end = if u < *from {
            *from
        } else if u > *to {
            *to
        } else {
            return None;
        };
        (low < end && end < high).then_some(end)
    }

    /// Range of the slope over `[low, high]`.
    pub(crate) fn slopes(&self, (low, high): (f64, f64)) -> Range {
        match self {
            Function::Quadratic { .. } => {
                let down = self.at(low).slope;
                let up = self.at(high).slope;
                let size = down.value.abs().max(up.value.abs());
                Range {
                    least: down.value - down.error,
                    most: up.value + up.error,
                    size,
                }
            }
            Function::Exponential {
                forward, backward, ..
            } => {
                let ahead = forward.slopes((low, high));
                let behind = backward.slopes((-high, -low));
                let size = ahead.size + behind.size;
                Range {
                    least: ahead.least - behind.most,
                    most: ahead.most - behind.least,
                    size,
                }
            }
        }
    }

    /// Range of the curvature over `[low, high]`, of which only the least is sharp.
    pub(crate) fn curvatures(&self, (low, high): (f64, f64)) -> Range {
        match self {
            Function::Quadratic {
                weight, relative, ..
            } => {
                let size = 2.0 * weight;
                Range {
                    least: size * (1.0 - relative),
                    most: size * (1.0 + relative),
                    size,
                }
            }
            Function::Exponential {
                forward, backward, ..
            } => {
                let ahead = forward.curvatures((low, high));
                let behind = backward.curvatures((-high, -low));
                let least = ahead.least + behind.least;
                let least = if self.is_convex_over((low, high)) {
                    least.max(0.0)
                } else {
                    least
                };
                Range {
                    least,
                    most: ahead.most + behind.most,
                    size: ahead.size + behind.size,
                }
            }
        }
    }
}

/// Sum of a function of `u` and a function of `-u`.
pub(super) fn both(ahead: Derivatives, behind: Derivatives) -> Derivatives {
    let mut value = ahead.value;
    value.add(behind.value);
    let mut slope = ahead.slope;
    slope.add(-behind.slope);
    Derivatives {
        value,
        slope,
        curvature: ahead.curvature + behind.curvature,
    }
}

/// One entry of a least squares objective: `weight (delta - offset - (s_input - s_output))^2`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SquareEntry {
    pub(crate) output: usize,
    /// Index of the input's scale (the ground, for an output's own departure).
    pub(crate) input: usize,
    pub(crate) weight: f64,
    /// Target of the entry.
    pub(crate) delta: f64,
    /// Value of the entry where both scales are 0, with a bound on its rounding.
    pub(crate) offset: Rounded,
}

impl SquareEntry {
    /// The entry ordered by index: from, to, and the difference of their scales that meets the
    /// target.
    fn ordered(&self) -> (usize, usize, Rounded) {
        let difference = self.delta - self.offset.value;
        let error = self.offset.error + f64::EPSILON * (self.delta.abs() + difference.abs());
        if self.output < self.input {
            (
                self.output,
                self.input,
                Rounded {
                    value: difference,
                    error,
                },
            )
        } else {
            (
                self.input,
                self.output,
                Rounded {
                    value: -difference,
                    error,
                },
            )
        }
    }
}

/// The entries that share two scales.
#[derive(Clone, Copy, Default)]
struct SquareGroup {
    count: f64,
    weight: f64,
    moment: f64,
    size: f64,
    error: f64,
}

impl SquareGroup {
    /// Difference of scales at the group's minimum: a quotient of sums, and no more accurate than
    /// the worst of its entries.
    fn centre(&self) -> Rounded {
        Rounded {
            value: self.moment / self.weight,
            error: self.error + (self.count + 2.0) * f64::EPSILON * self.size,
        }
    }
}

/// One quadratic term for each two scales that share an entry, and the remainder of the objective
/// at the minimum of all terms.
pub(crate) fn quadratic_terms(entries: &[SquareEntry], scales: usize) -> (Vec<Term>, Rounded) {
    let mut groups = vec![SquareGroup::default(); scales * scales];
    for entry in entries {
        let (from, to, difference) = entry.ordered();
        let group = &mut groups[from * scales + to];
        group.count += 1.0;
        group.weight += entry.weight;
        group.moment += entry.weight * difference.value;
        group.size = group.size.max(difference.value.abs());
        group.error = group.error.max(difference.error);
    }
    let mut constant = Rounded::default();
    for entry in entries {
        let (from, to, difference) = entry.ordered();
        // Inside a component no scale changes the entry.
        let met = if from == to {
            Rounded::default()
        } else {
            groups[from * scales + to].centre()
        };
        let left = difference.value - met.value;
        let error = difference.error + met.error + f64::EPSILON * left.abs();
        constant.add(Rounded::square(entry.weight, left, error, f64::EPSILON));
    }
    let pairs = (0..scales).flat_map(|from| (from + 1..scales).map(move |to| (from, to)));
    let terms = pairs.filter_map(|(from, to)| {
        let group = groups[from * scales + to];
        let function = Function::Quadratic {
            weight: group.weight,
            centre: group.centre(),
            relative: (group.count + 2.0) * f64::EPSILON,
        };
        (group.weight > 0.0).then_some(Term { from, to, function })
    });
    (terms.collect(), constant)
}

/// The one interval of `u` on which the sum of two exponentials is concave, never too narrow, or
/// `None`.
///
/// With `z = e^u` the curvature times `z^2 / 2` is the quartic `2 R1 z^4 - R1 c1 z^3 - R2 c2 z + 2
/// R2`: two changes of sign, so no or two positive roots (Descartes), and its slope has one
/// positive root.
fn concave_interval(forward: &Exponential, backward: &Exponential) -> Option<(f64, f64)> {
    // Far above the rounding of a logarithm of up to 83 (twice 180 dB, both ways).
    const SLACK: f64 = 1e-11;
    match (forward.is_zero(), backward.is_zero()) {
        (true, true) => return None,
        (false, true) => return Some((f64::NEG_INFINITY, forward.inflection() + SLACK)),
        (true, false) => return Some((-backward.inflection() - SLACK, f64::INFINITY)),
        (false, false) => {}
    }
    // The quartic over z^2, less more than its rounding: positive where the sum is surely convex.
    let surely_convex = |u: f64| {
        let z = u.exp();
        let parts = [
            2.0 * forward.weight * z.powi(2),
            -forward.weight * forward.centre * z,
            -backward.weight * backward.centre / z,
            2.0 * backward.weight / (z * z),
        ];
        let relative = 4.0 * forward.relative(u).max(backward.relative(u));
        parts
            .iter()
            .map(|part| part - relative * part.abs())
            .sum::<f64>()
            > 0.0
    };
    // Outside [-ln(c2 / 2), ln(c1 / 2)] (in either order) both have curvature of the same sign;
    // between them one is concave.
    let ends = (forward.inflection(), -backward.inflection());
    let deepest = quartic_least(forward, backward).ln();
    if surely_convex(deepest) {
        return None;
    }
    let reach = 1.0 + (ends.0 - ends.1).abs();
    let left = convex_end(&surely_convex, deepest - reach, deepest);
    let right = convex_end(&surely_convex, deepest + reach, deepest);
    Some((left - SLACK, right + SLACK))
}

/// The positive `z` where the quartic of [`concave_interval`] is least: the root of `8 R1 z^3 - 3
/// R1 c1 z^2 - R2 c2`, by Newton's method from the right, where the cubic is convex and increasing.
fn quartic_least(forward: &Exponential, backward: &Exponential) -> f64 {
    let square = 3.0 * forward.centre / 8.0;
    let constant = backward.weight * backward.centre / (8.0 * forward.weight);
    let mut z = square + constant.cbrt();
    for _ in 0..60 {
        let step = (z * z * (z - square) - constant) / (z * (3.0 * z - 2.0 * square));
        z -= step;
        if step.abs() <= 1e-15 * z {
            break;
        }
    }
    z
}

/// End of the concave interval, where `is_convex` turns from true (outside) to false at `inside`:
/// the convex side of the bracket. `outside` is moved further away until it is true there.
fn convex_end(is_convex: &impl Fn(f64) -> bool, outside: f64, inside: f64) -> f64 {
    let mut convex = outside;
    let mut other = inside;
    for _ in 0..40 {
        if is_convex(convex) {
            break;
        }
        convex += convex - inside;
    }
    while (convex - other).abs() > 1e-12 * (1.0 + convex.abs()) {
        let middle = 0.5 * (convex + other);
        if is_convex(middle) {
            convex = middle;
        } else {
            other = middle;
        }
    }
    convex
}

/// Value, slope and curvature of a function of one variable at a point.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Derivatives {
    pub(crate) value: Rounded,
    pub(crate) slope: Rounded,
    pub(crate) curvature: f64,
}

/// Least and greatest value of a derivative over an interval, rounded outward, with the size of the
/// summands.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Range {
    pub(crate) least: f64,
    pub(crate) most: f64,
    pub(crate) size: f64,
}

/// `weight (e^v - centre)^2`: the sum of `w (G - A e^v)^2` over the entries that share the
/// logarithm `v`, less its minimum.
///
/// Concave where `e^v < centre / 2`, convex elsewhere (`(G - K)^2` is convex in the logarithm where
/// `K >= G / 2`).
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Exponential {
    weight: f64,
    centre: f64,
    /// Bound on the relative rounding of `weight` and `centre`.
    rounding: f64,
}

/// One entry `weight (gain - product e^v)^2`, with the product known to a relative `error`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ProductEntry {
    weight: f64,
    gain: f64,
    product: f64,
    error: f64,
}

impl ProductEntry {
    /// `weight (gain - e^logarithm e^v)^2`.
    pub(crate) fn new(weight: f64, gain: f64, logarithm: Rounded) -> Self {
        // The error of the logarithm is the relative error of the product, and the exponential is
        // accurate to an epsilon.
        Self {
            weight,
            gain,
            product: logarithm.value.exp(),
            error: logarithm.error + f64::EPSILON,
        }
    }

    /// The square where `v` is 0.
    pub(crate) fn square(&self) -> Rounded {
        let difference = self.gain - self.product;
        let error = self.error * self.product + f64::EPSILON * difference.abs();
        Rounded::square(self.weight, difference, error, 0.0)
    }
}

impl Exponential {
    /// Combines the entries that share a logarithm into one function, and returns it with the
    /// minimum of their sum.
    ///
    /// The minimum is summed from the residuals, not from `P - Q^2 / R`, which would cancel.
    pub(crate) fn of(entries: &[ProductEntry]) -> (Self, Rounded) {
        let total = |term: fn(&ProductEntry) -> f64| entries.iter().map(term).sum::<f64>();
        let weight = total(|entry| entry.weight * entry.product * entry.product);
        if weight <= 0.0 {
            return Default::default();
        }
        let centre = total(|entry| entry.weight * entry.gain * entry.product) / weight;
        let mut least = Rounded::default();
        let mut worst = 0.0_f64;
        for entry in entries {
            let met = ProductEntry {
                product: entry.product * centre,
                error: entry.error + f64::EPSILON,
                ..*entry
            };
            least.add(met.square());
            worst = worst.max(entry.error);
        }
        // A sum of n positive terms is exact to n roundings of half an epsilon; the centre is the
        // quotient of two of them, and contains the product once more than twice.
        let rounding = 3.0 * worst + (entries.len() as f64 + 4.0) * f64::EPSILON;
        (
            Self {
                weight,
                centre,
                rounding,
            },
            least,
        )
    }

    /// Whether the function is zero.
    pub(crate) fn is_zero(&self) -> bool {
        self.weight == 0.0
    }

    /// The logarithm below which the function is concave.
    pub(crate) fn inflection(&self) -> f64 {
        (0.5 * self.centre).ln()
    }

    /// Relative rounding of `weight`, `centre` and `z = e^v`: of the first two, of `v` as a
    /// difference, of the exponential and of its reciprocal.
    pub(super) fn relative(&self, v: f64) -> f64 {
        self.rounding + (v.abs() + 4.0) * f64::EPSILON
    }

    /// The function at `v`, given `z = e^v`.
    pub(crate) fn at(&self, v: f64, z: f64) -> Derivatives {
        let away = z - self.centre;
        let relative = self.relative(v);
        let error = relative * (z + self.centre);
        let slope = 2.0 * self.weight * z * away;
        Derivatives {
            value: Rounded::square(self.weight, away, error, relative),
            slope: Rounded {
                value: slope,
                error: 2.0 * self.weight * z * error + 2.0 * relative * slope.abs(),
            },
            curvature: 2.0 * self.weight * z * (z + away),
        }
    }

    /// The curvature over `v` in `[low, high]`: a parabola in `e^v`, lowest at `centre / 4`. Only
    /// the least is sharp.
    pub(crate) fn curvatures(&self, (low, high): (f64, f64)) -> Range {
        let least = low.exp();
        let most = high.exp();
        let curvature = |z: f64| 2.0 * self.weight * z * (2.0 * z - self.centre);
        let size = 2.0 * self.weight * most * (2.0 * most + self.centre);
        let margin = 4.0 * self.relative(low.abs().max(high.abs())) * size;
        Range {
            least: curvature((0.25 * self.centre).clamp(least, most)) - margin,
            most: size + margin,
            size,
        }
    }

    /// The slope over `v` in `[low, high]`: a parabola in `e^v`, lowest at `centre / 2`.
    pub(crate) fn slopes(&self, (low, high): (f64, f64)) -> Range {
        let least = low.exp();
        let most = high.exp();
        let slope = |z: f64| 2.0 * self.weight * z * (z - self.centre);
        let size = 2.0 * self.weight * most * (most + self.centre);
        let margin = 4.0 * self.relative(low.abs().max(high.abs())) * size;
        let lowest = slope((0.5 * self.centre).clamp(least, most));
        let highest = slope(least).max(slope(most));
        Range {
            least: lowest - margin,
            most: highest + margin,
            size,
        }
    }
}

/// A number with a bound on its rounding: the exact value is no further away than `error`.
///
/// Sums carry a running error bound (Higham, Accuracy and Stability of Numerical Algorithms,
/// section 3.3): each addition rounds its result by at most half an epsilon. A whole epsilon is
/// counted, which covers the rounding of the bound itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Rounded {
    pub(crate) value: f64,
    pub(crate) error: f64,
}

impl Neg for Rounded {
    type Output = Self;

    fn neg(self) -> Self {
        Self {
            value: -self.value,
            ..self
        }
    }
}

impl Rounded {
    /// Adds another number.
    pub(crate) fn add(&mut self, other: Self) {
        self.value += other.value;
        self.error += other.error + f64::EPSILON * self.value.abs();
    }

    /// `weight difference^2`, where the difference is known to `error` and the weight to
    /// `relative`.
    pub(crate) fn square(weight: f64, difference: f64, error: f64, relative: f64) -> Self {
        let value = weight * difference * difference;
        let of_difference = weight * error * (2.0 * difference.abs() + error);
        Self {
            value,
            error: of_difference + (relative + 2.0 * f64::EPSILON) * value,
        }
    }
}
