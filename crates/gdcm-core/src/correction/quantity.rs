//! What a channel has of each (a gain, a delay or a signed delay), and the objective as a function of it.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::*;

/// What "close to G" means.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum GainObjective {
    /// `sum w (G - k_o k_i)^2 + alpha sum (k_o - 1)^2`, equation (7) of the paper.
    #[default]
    #[serde(rename = "ratio")]
    Ratio,
    /// `sum w (20 log10 G - 20 log10 k_o k_i)^2 + alpha sum (20 log10 k_o)^2`: errors up and down count alike, and an entry with
    /// a large `G` counts no more than another. Convex.
    #[serde(rename = "dB")]
    Decibel,
}

/// What is asked of the channels. Of two channels gains multiply and delays add.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Gains, dimensionless, compared as the objective says (equation (7), M8).
    Gain(GainObjective),
    /// Delays in seconds (equation (11), M9).
    Delay,
    /// Signed delays in seconds, of which a negative one is a lead; both sides are regularised (M15.4).
    SignedDelay,
}

/// dB in a natural logarithm.
const DECIBEL: f64 = 20.0 / std::f64::consts::LN_10;

/// `(20 / ln 10)^2`: squared dB in a squared natural logarithm.
pub(crate) const SQUARED_DECIBEL: f64 = DECIBEL * DECIBEL;

impl Quantity {
    /// Whether it is gains, and not delays of either kind.
    pub fn is_gain(self) -> bool {
        matches!(self, Self::Gain(_))
    }

    /// The value of a channel that changes nothing: a gain of 1, a delay of 0.
    pub(crate) fn neutral(self) -> f64 {
        if self.is_gain() { 1.0 } else { 0.0 }
    }

    /// Whether departures of the inputs are regularised besides those of the outputs.
    pub(crate) fn regularises_inputs(self) -> bool {
        self == Quantity::SignedDelay
    }

    /// Whether its lower bound can be moved: a delay's is 0.
    pub(crate) fn has_lower_bound(self) -> bool {
        self != Quantity::Delay
    }

    /// `k_o k_i` or `tau_o + tau_i`.
    pub(crate) fn net(self, output: f64, input: f64) -> f64 {
        if self.is_gain() { output * input } else { output + input }
    }

    /// What an entry misses, whose square the objective sums: a ratio, dB or seconds.
    pub(crate) fn miss(self, delta: f64, output: f64, input: f64) -> f64 {
        match self {
            Quantity::Gain(GainObjective::Ratio) => delta - output * input,
            Quantity::Gain(GainObjective::Decibel) => 20.0 * (delta / (output * input)).log10(),
            Quantity::Delay | Quantity::SignedDelay => delta - output - input,
        }
    }

    /// Slope of the squared miss in the logarithm of a gain or in a delay.
    pub(crate) fn slope(self, delta: f64, output: f64, input: f64) -> f64 {
        let net = self.net(output, input);
        match self {
            Quantity::Gain(GainObjective::Ratio) => 2.0 * net * (net - delta),
            Quantity::Gain(GainObjective::Decibel) => 2.0 * SQUARED_DECIBEL * (net / delta).ln(),
            Quantity::Delay | Quantity::SignedDelay => 2.0 * (net - delta),
        }
    }

    /// A difference of logarithms in dB, of delays in seconds.
    pub(crate) fn difference(self, difference: f64, coordinate: Coordinate) -> f64 {
        if self.is_gain() { difference * DECIBEL } else { coordinate.value(difference) }
    }

    /// A slope for each dB or for each millisecond, from one for each unit of the logarithm or each second.
    pub(crate) fn per_unit(self, slope: f64) -> f64 {
        if self.is_gain() { slope / DECIBEL } else { 1e-3 * slope }
    }

    /// The symbol of a channel's value.
    pub(crate) fn symbol(self) -> &'static str {
        if self.is_gain() { "k" } else { "tau" }
    }

    /// What of the entries of a loop agrees or disagrees.
    pub(crate) fn looped(self) -> &'static str {
        if self.is_gain() { "ratios" } else { "delays" }
    }

    /// What follows a bound in words.
    pub(crate) fn unit(self) -> &'static str {
        if self.is_gain() { "" } else { " s" }
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Quantity::Gain(_) => "gain",
            Quantity::Delay => "delay",
            Quantity::SignedDelay => "signed delay",
        })
    }
}

/// The coordinate in which what two channels have together is a sum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Coordinate {
    /// The natural logarithm of a gain.
    Logarithm,
    /// A delay in this unit.
    Time { unit_s: f64 },
}

impl Coordinate {
    /// The coordinate of a gain or of a delay in seconds.
    pub(crate) fn of(self, value: f64) -> f64 {
        match self {
            Coordinate::Logarithm => value.ln(),
            Coordinate::Time { unit_s } => value / unit_s,
        }
    }

    /// The gain or the delay in seconds at a coordinate.
    pub(crate) fn value(self, coordinate: f64) -> f64 {
        match self {
            Coordinate::Logarithm => coordinate.exp(),
            Coordinate::Time { unit_s } => coordinate * unit_s,
        }
    }

    /// An objective in this coordinate as one of gains, or in s².
    pub(crate) fn objective(self, objective: f64) -> f64 {
        match self {
            Coordinate::Logarithm => objective,
            Coordinate::Time { unit_s } => objective * unit_s * unit_s,
        }
    }
}

/// The least number of three significant digits that is not below `value`.
pub(crate) fn three_digits_up(value: f64) -> f64 {
    three_digits(value, f64::ceil)
}

/// The greatest number of three significant digits that is not above `value`.
pub(crate) fn three_digits_down(value: f64) -> f64 {
    three_digits(value, f64::floor)
}

fn three_digits(value: f64, round: impl Fn(f64) -> f64) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value;
    }
    let exponent = value.abs().log10().floor() as i32 - 2;
    // A value that is three digits up to rounding stays as it is. Negative powers are divided by: 1.87 is 187 / 100 exactly.
    let digits = if exponent < 0 { value * 10f64.powi(-exponent) } else { value / 10f64.powi(exponent) };
    let nearest = digits.round();
    let digits = if (digits - nearest).abs() <= 1e-9 * nearest.abs() { nearest } else { round(digits) };
    if exponent < 0 { digits / 10f64.powi(-exponent) } else { digits * 10f64.powi(exponent) }
}

/// The objective of `problem` over the scales of `components`, in the problem's coordinate.
pub(crate) fn objective(problem: &Problem, components: &Components) -> Objective {
    let ground = components.count();
    let (quantity, coordinate) = (problem.quantity, problem.coordinate());
    let fit = problem.fit_entries().map(|(pair, delta)| {
        let (output, input) = (components.outputs[pair.output], components.inputs[pair.input]);
        let mut offset = output.offset;
        offset.add(input.offset);
        SquareEntry { output: output.component, input: input.component, weight: 1.0, delta, offset }
    });
    let departure = components.outputs.iter().filter(|_| problem.alpha > 0.0).map(|output| SquareEntry {
        output: output.component,
        input: ground,
        weight: problem.alpha,
        delta: quantity.neutral(),
        offset: output.offset,
    });
    let regularised = problem.alpha > 0.0 && quantity.regularises_inputs();
    let departure_of_inputs = components.inputs.iter().filter(|_| regularised).map(|input| SquareEntry {
        output: ground,
        input: input.component,
        weight: problem.alpha,
        delta: quantity.neutral(),
        offset: input.offset,
    });
    let entries: Vec<SquareEntry> = fit.chain(departure).chain(departure_of_inputs).collect();
    let in_coordinate = |factor: f64| -> Vec<SquareEntry> {
        let square = |entry: &SquareEntry| SquareEntry {
            weight: factor * entry.weight,
            delta: coordinate.of(entry.delta),
            ..*entry
        };
        entries.iter().map(square).collect()
    };
    let (terms, constant) = match quantity {
        Quantity::Gain(GainObjective::Ratio) => ratio_terms(&entries, ground + 1),
        Quantity::Gain(GainObjective::Decibel) => quadratic_terms(&in_coordinate(SQUARED_DECIBEL), ground + 1),
        Quantity::Delay | Quantity::SignedDelay => quadratic_terms(&in_coordinate(1.0), ground + 1),
    };
    let (mut lower, mut upper) = (components.lower.clone(), components.upper.clone());
    lower.push(0.0);
    upper.push(0.0);
    Objective { lower, upper, terms, constant }
}

/// One term for each two scales that share an entry: `forward` holds the entries whose input has the greater index.
fn ratio_terms(entries: &[SquareEntry], scales: usize) -> (Vec<Term>, Rounded) {
    let mut groups: Vec<Group> = vec![Group::default(); scales * scales];
    let mut constant = Rounded::default();
    for SquareEntry { output, input, weight, delta, offset } in entries {
        if output == input {
            constant.add(fixed_square(*weight, *delta, product(offset.value, offset.error)));
        } else {
            groups[output * scales + input].add(*weight, *delta, offset.value, offset.error);
        }
    }
    let mut terms = Vec::new();
    for from in 0..scales {
        for to in from + 1..scales {
            let (forward, ahead) = groups[from * scales + to].exponential();
            let (backward, behind) = groups[to * scales + from].exponential();
            constant.add(ahead);
            constant.add(behind);
            if !(forward.is_zero() && backward.is_zero()) {
                terms.push(Term { from, to, function: Function::exponential(forward, backward) });
            }
        }
    }
    (terms, constant)
}

/// The objective below which rounding decides, not the search, in the problem's coordinate: a billionth of the objective without
/// any correction (the rounding of a sum of squares grows with the root of what the squares are taken of), and for the outputs,
/// known to their rounding, its square.
pub(crate) fn floor(problem: &Problem) -> f64 {
    let coordinate = problem.coordinate();
    let square = |delta: f64| match problem.quantity {
        Quantity::Gain(GainObjective::Ratio) => delta * delta,
        Quantity::Gain(GainObjective::Decibel) => SQUARED_DECIBEL * (delta.ln().powi(2) + 1.0),
        Quantity::Delay | Quantity::SignedDelay => coordinate.of(delta).powi(2),
    };
    let energy: f64 = problem.fit_entries().map(|(_, delta)| square(delta)).sum();
    (1e-9 * energy + 1e-20 * problem.alpha * problem.delta.outputs() as f64).max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_is_rounded_to_three_digits_so_that_it_still_suffices() {
        assert_eq!((three_digits_up(1.8681), three_digits_down(1.8681)), (1.87, 1.86));
        assert_eq!((three_digits_up(0.060_801), three_digits_down(0.060_801)), (0.0609, 0.0608));
        assert_eq!((three_digits_up(1234.0), three_digits_down(1234.0)), (1240.0, 1230.0));
        assert_eq!((three_digits_up(0.999_7), three_digits_down(0.999_7)), (1.0, 0.999));
    }

    #[test]
    fn a_figure_of_three_digits_up_to_rounding_stays() {
        assert_eq!((three_digits_up(0.7 * 2.5), three_digits_down(1.4 / 2.5)), (1.75, 0.56));
        assert_eq!((three_digits_up(0.0), three_digits_down(0.0)), (0.0, 0.0));
    }
}
