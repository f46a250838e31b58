//! The problem of the channel values: the quantity (a gain, a delay or a signed delay) of each
//! channel, and the objective as a function of it.

use std::fmt;

use serde::{Deserialize, Serialize};

use gdcm_model::dataset::{Pair, PairTable};

use super::components::Components;
use crate::correction::branch_and_bound::objective::Objective;
use crate::correction::branch_and_bound::search::SearchStopped;
use crate::correction::branch_and_bound::term::{
    Exponential, Function, ProductEntry, Rounded, SquareEntry, Term, quadratic_terms,
};

/// Least and greatest value of every channel (M7): gains `0 < lower <= upper`, delays \[s\] with
/// `lower` zero, signed delays \[s\] `lower <= 0 <= upper` (M15.4).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "[f64; 2]", into = "[f64; 2]")]
pub struct Bounds {
    pub lower: f64,
    pub upper: f64,
}

impl From<[f64; 2]> for Bounds {
    fn from([lower, upper]: [f64; 2]) -> Self {
        Self { lower, upper }
    }
}

impl From<Bounds> for [f64; 2] {
    fn from(bounds: Bounds) -> Self {
        [bounds.lower, bounds.upper]
    }
}

/// Mismatch of a loop of constrained delays that counts as agreement \[s\]: half of the last
/// displayed digit of delays.
pub const DELAY_AGREEMENT_S: f64 = 5e-5;

/// Problem of the gains (eq. (7), M8), the delays \[s\] (eq. (11), M9) or the signed delays \[s\]
/// (M15.4) of a condition's correction.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    pub quantity: Quantity,
    /// Delta gain `G` or delta delay `D` of each response, p x m; an entry with `None` is left out
    /// of the objective.
    pub delta: PairTable<Option<f64>>,
    /// Entries whose net value is constrained to their delta, p x m.
    pub constrained: PairTable<bool>,
    /// Entries that count in the objective (`w = 1`), p x m.
    pub fitted: PairTable<bool>,
    /// Bounds of every channel.
    pub bounds: Bounds,
    /// Weight of the departure of the output gains from 1, of the output delays, or of all signed
    /// delays; `alpha = 0` means the limit `alpha -> 0+`.
    pub alpha: f64,
    /// Greatest mismatch of a loop of constrained entries that counts as agreement: dB of gain, or
    /// seconds of delay.
    pub agreement: f64,
}

/// Reason why gains or delays cannot be computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProblemError {
    /// The shape of a table differs from the shape of the deltas.
    #[error(
        "the table of {table} entries has {} outputs and {} inputs, but the {quantity}s have {} and {}",
        found.0,
        found.1,
        expected.0,
        expected.1
    )]
    Shape {
        quantity: Quantity,
        table: &'static str,
        /// Numbers of outputs and inputs of the table.
        found: (usize, usize),
        /// Numbers of outputs and inputs of the deltas.
        expected: (usize, usize),
    },
    /// A constrained entry has no delta.
    #[error("the response of output {} to input {} has no delta {quantity}, so its {quantity} cannot be held", pair.output + 1, pair.input + 1)]
    ConstrainedUndefined {
        quantity: Quantity,
        /// Constrained entry without a delta.
        pair: Pair,
    },
    /// A delta gain is not a positive number with a representable square.
    #[error("the delta gain of output {} and input {} is {gain}; it must lie between 1e-50 and 1e50", pair.output + 1, pair.input + 1)]
    Gain {
        pair: Pair,
        /// Delta gain (ratio).
        gain: f64,
    },
    /// A delta delay is not a valid time.
    #[error("the delta delay of output {} and input {} is {delay_s} s; it must be a number below 1e50 s", pair.output + 1, pair.input + 1)]
    Delay {
        pair: Pair,
        /// Delta delay \[s\].
        delay_s: f64,
    },
    /// The bounds are not valid for the quantity ([`Bounds`]).
    #[error("{}", bounds_words(*quantity, bounds.lower, bounds.upper))]
    Bounds {
        quantity: Quantity,
        /// The rejected bounds.
        bounds: Bounds,
    },
    /// `alpha` is negative or not a number.
    #[error("alpha is {alpha}; it must be a number from 0 to 1e12")]
    Alpha {
        /// The rejected weight.
        alpha: f64,
    },
    /// The quadratic program of the delays was not solved.
    #[error("the quadratic program of the delays was not solved: {reason}")]
    Program {
        /// Status reported by the solver.
        reason: String,
    },
    /// The search was stopped from outside.
    #[error("the search for the best answer was stopped")]
    Stopped,
}

fn bounds_words(quantity: Quantity, lower: f64, upper: f64) -> String {
    match quantity {
        Quantity::Gain(_) => format!(
            "the gain bounds {lower} and {upper} must be positive (1e-9 to 1e9), the lower one not above the upper one"
        ),
        Quantity::Delay => {
            format!(
                "the delays are bounded by {lower} s and {upper} s; it must be 0 and a number from 0 to 1e50 s"
            )
        }
        Quantity::SignedDelay => format!(
            "the signed delays are bounded by {lower} s and {upper} s; it must be a number from -1e50 to 0 and one from 0 to \
             1e50 s"
        ),
    }
}

impl From<SearchStopped> for ProblemError {
    fn from(_: SearchStopped) -> Self {
        ProblemError::Stopped
    }
}

/// Delta gains outside this range overflow when squared and summed.
const GAINS: std::ops::RangeInclusive<f64> = 1e-50..=1e50;

/// Bounds outside this range (180 dB) overflow in the products of the search for a proof.
const GAIN_BOUNDS: std::ops::RangeInclusive<f64> = 1e-9..=1e9;

impl Problem {
    /// Problem of equation (7) that fits every entry: `alpha = 1`, the paper's objective, no
    /// tolerance on loops.
    pub fn gains(
        delta: PairTable<Option<f64>>,
        constrained: PairTable<bool>,
        bounds: Bounds,
    ) -> Self {
        let fitted = PairTable::filled(delta.outputs(), delta.inputs(), true);
        let quantity = Quantity::Gain(GainObjective::Ratio);
        Self {
            quantity,
            delta,
            constrained,
            fitted,
            bounds,
            alpha: 1.0,
            agreement: 0.0,
        }
    }

    /// Problem of equation (11) that fits every entry, with `alpha = 1`; all times in seconds.
    pub fn delays(
        delta_s: PairTable<Option<f64>>,
        constrained: PairTable<bool>,
        upper_s: f64,
    ) -> Self {
        let bounds = Bounds {
            lower: 0.0,
            upper: upper_s,
        };
        Self {
            quantity: Quantity::Delay,
            ..Self::gains(delta_s, constrained, bounds)
        }
    }

    /// Convex program of M15.4 that fits every entry, with `alpha = 1`; all times in seconds.
    pub fn signed_delays(
        delta_s: PairTable<Option<f64>>,
        constrained: PairTable<bool>,
        bounds: Bounds,
    ) -> Self {
        Self {
            quantity: Quantity::SignedDelay,
            ..Self::gains(delta_s, constrained, bounds)
        }
    }

    /// Checks shapes and values.
    ///
    /// # Errors
    /// The first [`ProblemError`] found.
    pub fn check(&self) -> Result<(), ProblemError> {
        let quantity = self.quantity;
        let expected = (self.delta.outputs(), self.delta.inputs());
        for (table, entries) in [("constrained", &self.constrained), ("fitted", &self.fitted)] {
            let found = (entries.outputs(), entries.inputs());
            if found != expected {
                return Err(ProblemError::Shape {
                    quantity,
                    table,
                    found,
                    expected,
                });
            }
        }
        for (pair, delta) in self.delta.iter() {
            match (*delta, quantity) {
                (None, _) if self.constrained[pair] => {
                    return Err(ProblemError::ConstrainedUndefined { quantity, pair });
                }
                (Some(gain), Quantity::Gain(_)) if !GAINS.contains(&gain) => {
                    return Err(ProblemError::Gain { pair, gain });
                }
                (Some(delay_s), Quantity::Delay | Quantity::SignedDelay)
                    if !(-1e50..=1e50).contains(&delay_s) =>
                {
                    return Err(ProblemError::Delay { pair, delay_s });
                }
                _ => {}
            }
        }
        let Bounds { lower, upper } = self.bounds;
        let times = 0.0..=1e50;
        let are_bounds = match quantity {
            Quantity::Gain(_) => {
                GAIN_BOUNDS.contains(&lower) && GAIN_BOUNDS.contains(&upper) && lower <= upper
            }
            Quantity::Delay => lower == 0.0 && times.contains(&upper),
            Quantity::SignedDelay => times.contains(&-lower) && times.contains(&upper),
        };
        if !are_bounds {
            return Err(ProblemError::Bounds {
                quantity,
                bounds: self.bounds,
            });
        }
        if (0.0..=1e12).contains(&self.alpha) {
            Ok(())
        } else {
            Err(ProblemError::Alpha { alpha: self.alpha })
        }
    }

    /// Objective at these channel values (inputs m, outputs p): in squared ratios, in squared dB,
    /// or in s².
    pub fn objective_at(&self, inputs: &[f64], outputs: &[f64]) -> f64 {
        let miss = |(pair, delta): (Pair, f64)| {
            self.quantity
                .miss(delta, outputs[pair.output], inputs[pair.input])
        };
        let fit: f64 = self.fit_entries().map(|entry| miss(entry).powi(2)).sum();
        // Skipped at alpha = 0, where it would only add rounding.
        if self.alpha == 0.0 {
            return fit;
        }
        let neutral = self.quantity.neutral();
        let departure = |output: &f64| self.quantity.miss(neutral, *output, neutral).powi(2);
        let inputs = if self.quantity.regularises_inputs() {
            inputs
        } else {
            &[]
        };
        fit + self.alpha * outputs.iter().chain(inputs).map(departure).sum::<f64>()
    }

    /// The entries that count in the objective, with their delta.
    pub(crate) fn fit_entries(&self) -> impl Iterator<Item = (Pair, f64)> + '_ {
        let fitted = self.delta.iter().filter(|(pair, _)| self.fitted[*pair]);
        fitted.filter_map(|(pair, delta)| delta.map(|delta| (pair, delta)))
    }

    /// The constrained entries, with their delta.
    pub(crate) fn held_entries(&self) -> impl Iterator<Item = (Pair, f64)> + '_ {
        self.constrained
            .marked()
            .filter_map(|pair| self.delta[pair].map(|delta| (pair, delta)))
    }

    /// Coordinate in which the constrained entries are sums. Delays are homogeneous: in units of
    /// the greatest time of the problem (one second where every time is 0) every number is of order
    /// 1.
    pub(crate) fn coordinate(&self) -> Coordinate {
        if let Quantity::Gain(_) = self.quantity {
            return Coordinate::Logarithm;
        }
        let asked = self
            .delta
            .iter()
            .filter_map(|(_, delay)| *delay)
            .fold(0.0_f64, |most, delay| most.max(delay.abs()));
        // A bound far above any channel's possible target does not indicate the size of the answer.
        let unit_s = if asked > 0.0 {
            asked
        } else {
            self.bounds.upper.max(-self.bounds.lower)
        };
        Coordinate::Time {
            unit_s: if unit_s > 0.0 { unit_s } else { 1.0 },
        }
    }

    /// Least and greatest coordinate of every channel.
    pub(crate) fn range(&self) -> (f64, f64) {
        let coordinate = self.coordinate();
        let low = coordinate.of(self.bounds.lower);
        let high = coordinate.of(self.bounds.upper);
        match coordinate {
            Coordinate::Logarithm => (low, high),
            // No path of constrained entries asks a channel for more than one unit each: a bound
            // above that never acts.
            Coordinate::Time { .. } => {
                let most = (self.delta.outputs() + self.delta.inputs()) as f64;
                (low.max(-most), high.min(most))
            }
        }
    }
}

/// Measure of the distance between `k_o k_i` and G.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum GainObjective {
    /// `sum w (G - k_o k_i)^2 + alpha sum (k_o - 1)^2`, equation (7) of the paper.
    #[default]
    #[serde(rename = "ratio")]
    Ratio,
    /// `sum w (20 log10 G - 20 log10 k_o k_i)^2 + alpha sum (20 log10 k_o)^2`: errors up and down
    /// count alike, and an entry with a large `G` counts no more than another. Convex.
    #[serde(rename = "dB")]
    Decibel,
}

/// Quantity of the channels. The gains of two channels multiply, and delays add.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Gains, dimensionless, compared as the objective says (equation (7), M8).
    Gain(GainObjective),
    /// Delays in seconds (equation (11), M9).
    Delay,
    /// Signed delays in seconds, of which a negative one is a lead; both sides are regularised
    /// (M15.4).
    SignedDelay,
}

/// dB per unit of natural logarithm.
const DECIBEL: f64 = 20.0 / std::f64::consts::LN_10;

/// `(20 / ln 10)^2`: squared dB per unit of squared natural logarithm.
pub(crate) const SQUARED_DECIBEL: f64 = DECIBEL * DECIBEL;

impl Quantity {
    /// Whether the quantity is a gain.
    pub fn is_gain(self) -> bool {
        matches!(self, Self::Gain(_))
    }

    /// Value of a channel without effect: a gain of 1, a delay of 0.
    pub(crate) fn neutral(self) -> f64 {
        if self.is_gain() { 1.0 } else { 0.0 }
    }

    /// Whether departures of the inputs are regularised besides those of the outputs.
    pub(crate) fn regularises_inputs(self) -> bool {
        self == Quantity::SignedDelay
    }

    /// Whether the lower bound is adjustable: a delay's is fixed at 0.
    pub(crate) fn has_lower_bound(self) -> bool {
        self != Quantity::Delay
    }

    /// `k_o k_i` or `tau_o + tau_i`.
    pub(crate) fn net(self, output: f64, input: f64) -> f64 {
        if self.is_gain() {
            output * input
        } else {
            output + input
        }
    }

    /// Residual of an entry, whose square the objective sums: a ratio, dB or seconds.
    pub(crate) fn miss(self, delta: f64, output: f64, input: f64) -> f64 {
        match self {
            Quantity::Gain(GainObjective::Ratio) => delta - output * input,
            Quantity::Gain(GainObjective::Decibel) => 20.0 * (delta / (output * input)).log10(),
            Quantity::Delay | Quantity::SignedDelay => delta - output - input,
        }
    }

    /// Slope of the squared residual in the logarithm of a gain or in a delay.
    pub(crate) fn slope(self, delta: f64, output: f64, input: f64) -> f64 {
        let net = self.net(output, input);
        match self {
            Quantity::Gain(GainObjective::Ratio) => 2.0 * net * (net - delta),
            Quantity::Gain(GainObjective::Decibel) => 2.0 * SQUARED_DECIBEL * (net / delta).ln(),
            Quantity::Delay | Quantity::SignedDelay => 2.0 * (net - delta),
        }
    }

    /// Difference of logarithms in dB, of delays in seconds.
    pub(crate) fn difference(self, difference: f64, coordinate: Coordinate) -> f64 {
        if self.is_gain() {
            difference * DECIBEL
        } else {
            coordinate.value(difference)
        }
    }

    /// Converts a slope per unit of the logarithm or per second to one per dB or per millisecond.
    pub(crate) fn per_unit(self, slope: f64) -> f64 {
        if self.is_gain() {
            slope / DECIBEL
        } else {
            1e-3 * slope
        }
    }

    /// Symbol of a channel's value.
    pub(crate) fn symbol(self) -> &'static str {
        if self.is_gain() { "k" } else { "tau" }
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

/// Coordinate in which the net value of two channels is a sum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Coordinate {
    /// Natural logarithm of a gain.
    Logarithm,
    /// Delay in this unit.
    Time { unit_s: f64 },
}

impl Coordinate {
    /// Coordinate of a gain or of a delay in seconds.
    pub(crate) fn of(self, value: f64) -> f64 {
        match self {
            Coordinate::Logarithm => value.ln(),
            Coordinate::Time { unit_s } => value / unit_s,
        }
    }

    /// Gain or delay in seconds at a coordinate.
    pub(crate) fn value(self, coordinate: f64) -> f64 {
        match self {
            Coordinate::Logarithm => coordinate.exp(),
            Coordinate::Time { unit_s } => coordinate * unit_s,
        }
    }

    /// Converts an objective from this coordinate to the objective of gains, or to s².
    pub(crate) fn objective(self, objective: f64) -> f64 {
        match self {
            Coordinate::Logarithm => objective,
            Coordinate::Time { unit_s } => objective * unit_s * unit_s,
        }
    }
}

/// Rounds `value` to three significant digits in the direction of `round`.
pub(crate) fn three_digits(value: f64, round: fn(f64) -> f64) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value;
    }
    let exponent = value.abs().log10().floor() as i32 - 2;
    // A value of three digits up to rounding stays as it is. Negative powers of ten are applied by
    // division: 187 / 100 is 1.87 exactly.
    let digits = if exponent < 0 {
        value * 10f64.powi(-exponent)
    } else {
        value / 10f64.powi(exponent)
    };
    let nearest = digits.round();
    let digits = if (digits - nearest).abs() <= 1e-9 * nearest.abs() {
        nearest
    } else {
        round(digits)
    };
    if exponent < 0 {
        digits / 10f64.powi(-exponent)
    } else {
        digits * 10f64.powi(exponent)
    }
}

/// Objective of `problem` over the scales of `components`, in the problem's coordinate.
pub(crate) fn objective(problem: &Problem, components: &Components) -> Objective {
    let ground = components.count();
    let quantity = problem.quantity;
    let coordinate = problem.coordinate();
    let (inputs, outputs) = components.sides();
    let fit = problem.fit_entries().map(|(pair, delta)| {
        let output = outputs[pair.output];
        let input = inputs[pair.input];
        let mut offset = -output.offset;
        offset.add(input.offset);
        SquareEntry {
            output: output.component,
            input: input.component,
            weight: 1.0,
            delta,
            offset,
        }
    });
    let departure = |output: usize, input: usize, offset: Rounded| {
        let weight = problem.alpha;
        let delta = quantity.neutral();
        SquareEntry {
            output,
            input,
            weight,
            delta,
            offset,
        }
    };
    let of_outputs = outputs
        .iter()
        .map(|output| departure(output.component, ground, -output.offset));
    let regularised = inputs.iter().filter(|_| quantity.regularises_inputs());
    let of_inputs = regularised.map(|input| departure(ground, input.component, input.offset));
    let departures = of_outputs.chain(of_inputs).filter(|_| problem.alpha > 0.0);
    let entries: Vec<SquareEntry> = fit.chain(departures).collect();
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
        Quantity::Gain(GainObjective::Decibel) => {
            quadratic_terms(&in_coordinate(SQUARED_DECIBEL), ground + 1)
        }
        Quantity::Delay | Quantity::SignedDelay => quadratic_terms(&in_coordinate(1.0), ground + 1),
    };
    let mut lower = components.lower.clone();
    let mut upper = components.upper.clone();
    lower.push(0.0);
    upper.push(0.0);
    Objective {
        lower,
        upper,
        terms,
        constant,
    }
}

/// One term for each two scales that share an entry: `forward` contains the entries whose input has
/// the greater index.
fn ratio_terms(entries: &[SquareEntry], scales: usize) -> (Vec<Term>, Rounded) {
    let mut groups: Vec<Vec<ProductEntry>> = vec![Vec::new(); scales * scales];
    let mut constant = Rounded::default();
    for SquareEntry {
        output,
        input,
        weight,
        delta,
        offset,
    } in entries
    {
        let entry = ProductEntry::new(*weight, *delta, *offset);
        if output == input {
            constant.add(entry.square());
        } else {
            groups[output * scales + input].push(entry);
        }
    }
    let mut terms = Vec::new();
    for from in 0..scales {
        for to in from + 1..scales {
            let (forward, ahead) = Exponential::of(&groups[from * scales + to]);
            let (backward, behind) = Exponential::of(&groups[to * scales + from]);
            constant.add(ahead);
            constant.add(behind);
            if !(forward.is_zero() && backward.is_zero()) {
                terms.push(Term {
                    from,
                    to,
                    function: Function::exponential(forward, backward),
                });
            }
        }
    }
    (terms, constant)
}

/// Objective below which rounding decides, not the search, in the problem's coordinate: a billionth
/// of the objective without any correction (the rounding of a sum of squares grows with the root of
/// what the squares are taken of), and for the outputs, known to their rounding, the square of that
/// rounding.
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
        assert_eq!(
            (
                three_digits(1.8681, f64::ceil),
                three_digits(1.8681, f64::floor)
            ),
            (1.87, 1.86)
        );
        assert_eq!(
            (
                three_digits(0.060_801, f64::ceil),
                three_digits(0.060_801, f64::floor)
            ),
            (0.0609, 0.0608)
        );
        assert_eq!(
            (
                three_digits(1234.0, f64::ceil),
                three_digits(1234.0, f64::floor)
            ),
            (1240.0, 1230.0)
        );
        assert_eq!(
            (
                three_digits(0.999_7, f64::ceil),
                three_digits(0.999_7, f64::floor)
            ),
            (1.0, 0.999)
        );
    }

    #[test]
    fn a_figure_of_three_digits_up_to_rounding_stays() {
        assert_eq!(
            (
                three_digits(0.7 * 2.5, f64::ceil),
                three_digits(1.4 / 2.5, f64::floor)
            ),
            (1.75, 0.56)
        );
        assert_eq!(
            (three_digits(0.0, f64::ceil), three_digits(0.0, f64::floor)),
            (0.0, 0.0)
        );
    }
}
