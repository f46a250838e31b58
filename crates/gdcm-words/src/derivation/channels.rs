//! Derives channel gains and delays, net gains and delays, and objectives (M8, M9, M11).
//!
//! Output o and input i have the gains `k_o` and `k_i` and the delays `τ_o` and `τ_i`; a response
//! has their product and sum, the net gain and net delay, which approximate its delta gain G and
//! delta delay D (M6). *Held* responses are constrained to them.

use gdcm_method::correction::{Channel, GainObjective, Problem, Quantity, Solution};
use gdcm_model::dataset::Pair;
use gdcm_model::number_format::{counted, five_digits};
use gdcm_model::units::{s_to_ms, six_digits};

use super::{Context, Derivation};
use crate::leads::servo_words;
use crate::solution_details::proof_text;

/// An objective as an equation, and how its value is displayed.
struct Objective {
    equation: &'static str,
    /// The displayed value's unit, with a leading space; empty without a unit.
    unit: &'static str,
    /// Factor from the stored to the displayed value.
    scale: f64,
    /// Section in the method description.
    section: &'static str,
}

impl Objective {
    fn of_gains(context: &Context<'_>) -> Self {
        let (equation, unit) = match context.settings().gain_objective {
            GainObjective::Ratio => ("Σ w (G − k_o k_i)² + α Σ (k_o − 1)²", ""),
            GainObjective::Decibel => (
                "Σ w (20 log10 G − 20 log10 k_o k_i)² + α Σ (20 log10 k_o)²",
                " dB²",
            ),
        };
        Self {
            equation,
            unit,
            scale: 1.0,
            section: "M8, eq. (7)",
        }
    }

    fn of_delays(problem: &Problem) -> Self {
        let (equation, section) = match problem.quantity {
            Quantity::SignedDelay => ("Σ w (D − τ_o − τ_i)² + α (Σ τ_o² + Σ τ_i²)", "M15.4"),
            _ => ("Σ w (D − τ_o − τ_i)² + α Σ τ_o²", "M9, eq. (11)"),
        };
        Self {
            equation,
            unit: " ms²",
            scale: 1e6,
            section,
        }
    }
}

/// Derives a response's net gain `k_o k_i`.
pub(super) fn net_gain(context: &Context<'_>, pair: Pair) -> Derivation {
    let result = context.result;
    let [output, input] = Channel::of_pair(pair);
    let value = result.correction.net_gain(pair);
    let step = format!(
        "k_{} k_{} = {} · {} = {}",
        context.channel(output),
        context.channel(input),
        five_digits(result.correction.gain(output)),
        five_digits(result.correction.gain(input)),
        five_digits(value)
    );
    let delta = Delta {
        name: "delta gain G",
        unit: "",
        value: result.delta_gain(pair),
    };
    Derivation {
        title: context.title(&format!("net gain of {}", context.pair(pair))),
        equation: "k_o k_i".to_owned(),
        with_numbers: vec![step],
        rests_on: vec![constraint_words(context, pair, &result.gains, &delta)],
        section: "M10, eq. (12)",
        value,
    }
}

/// Derives a response's net delay `τ_o + τ_i` \[ms\].
pub(super) fn net_delay(context: &Context<'_>, pair: Pair) -> Derivation {
    let result = context.result;
    let [output, input] = Channel::of_pair(pair);
    let value = s_to_ms(result.correction.net_delay_s(pair));
    let step = format!(
        "τ_{} + τ_{} = {} + {} = {} ms",
        context.channel(output),
        context.channel(input),
        five_digits(s_to_ms(result.correction.delay_s(output))),
        five_digits(s_to_ms(result.correction.delay_s(input))),
        five_digits(value)
    );
    let delta = Delta {
        name: "delta delay D",
        unit: " ms",
        value: result.delta_delay_s(pair).map(s_to_ms),
    };
    Derivation {
        title: context.title(&format!("net delay of {}", context.pair(pair))),
        equation: "τ_o + τ_i".to_owned(),
        with_numbers: vec![step],
        rests_on: vec![constraint_words(context, pair, &result.delays, &delta)],
        section: "M10, eq. (12)",
        value,
    }
}

/// The gain or delay that a response needs.
struct Delta {
    name: &'static str,
    /// The value's unit, with a leading space; empty without a unit.
    unit: &'static str,
    value: Option<f64>,
}

/// Describes whether a response is constrained, and its delta gain or delta delay.
fn constraint_words(
    context: &Context<'_>,
    pair: Pair,
    solution: &Solution,
    delta: &Delta,
) -> String {
    let response = context.pair(pair);
    let name = delta.name;
    let value = match delta.value {
        Some(value) => format!("{}{}", five_digits(value), delta.unit),
        None => "undefined".to_owned(),
    };
    if solution.targets[pair].is_none() {
        format!("{response} is not held; its {name} is {value}")
    } else if solution.unmatched.iter().any(|miss| miss.pair == pair) {
        format!("{response} is held as close as possible to its {name}, {value}")
    } else {
        format!("{response} is held at its {name}, {value}")
    }
}

/// Derives a channel's gain `k`; `None` for a channel that the dataset does not have.
pub(super) fn gain(context: &Context<'_>, channel: Channel) -> Option<Derivation> {
    let result = context.result;
    let value = *result.gains.channels().get(channel)?;
    let name = format!("k_{}", context.channel(channel));
    let optimum = Optimum {
        context,
        problem: &result.gain_problem,
        solution: &result.gains,
    };
    let objective = Objective::of_gains(context);
    Some(Derivation {
        title: context.title(&name),
        equation: format!(
            "min {}, subject to k_o k_i = G (held), LB ≤ k ≤ UB",
            objective.equation
        ),
        with_numbers: optimum.steps(channel, &format!("{name} = {}", five_digits(value))),
        rests_on: optimum.rests_on(),
        section: objective.section,
        value,
    })
}

/// Derives a channel's delay or signed delay `τ` \[ms\]; `None` for a channel that the dataset does
/// not have.
pub(super) fn delay(context: &Context<'_>, channel: Channel) -> Option<Derivation> {
    let result = context.result;
    let value = s_to_ms(*result.delays.channels().get(channel)?);
    let name = format!("τ_{}", context.channel(channel));
    let optimum = Optimum {
        context,
        problem: &result.delay_problem,
        solution: &result.delays,
    };
    let objective = Objective::of_delays(&result.delay_problem);
    let lower = match result.delay_problem.quantity {
        Quantity::SignedDelay => "LB",
        _ => "0",
    };
    let mut with_numbers = optimum.steps(channel, &format!("{name} = {} ms", five_digits(value)));
    if let Some(filter) = result.correction.lead(channel) {
        with_numbers.push(format!(
            "its lead filter provides {} ms of lead at low frequency: {}",
            five_digits(s_to_ms(filter.lead_s())),
            servo_words(filter)
        ));
    }
    Some(Derivation {
        title: context.title(&name),
        equation: format!(
            "min {}, subject to τ_o + τ_i = D (held), {lower} ≤ τ ≤ UB",
            objective.equation
        ),
        with_numbers,
        rests_on: optimum.rests_on(),
        section: objective.section,
        value,
    })
}

/// Derives the objective that the gains minimise.
pub(super) fn gain_objective(context: &Context<'_>) -> Derivation {
    let optimum = Optimum {
        context,
        problem: &context.result.gain_problem,
        solution: &context.result.gains,
    };
    optimum.objective_derivation(&Objective::of_gains(context))
}

/// Derives the objective that the delays minimise.
pub(super) fn delay_objective(context: &Context<'_>) -> Derivation {
    let problem = &context.result.delay_problem;
    let optimum = Optimum {
        context,
        problem,
        solution: &context.result.delays,
    };
    optimum.objective_derivation(&Objective::of_delays(problem))
}

/// A condition's gain or delay problem, with its solution.
struct Optimum<'a> {
    context: &'a Context<'a>,
    problem: &'a Problem,
    solution: &'a Solution,
}

impl Optimum<'_> {
    /// Lists the constrained products or sums that contain the channel, then its bounds with
    /// `name_and_value` between them: "k_LON = 1.0124".
    fn steps(&self, channel: Channel, name_and_value: &str) -> Vec<String> {
        let is_gain = self.problem.quantity.is_gain();
        let (unit, scale) = if is_gain { ("", 1.0) } else { (" ms", 1e3) };
        let mut steps = Vec::new();
        for (pair, target) in self.solution.targets.iter() {
            let Some(target) = target else { continue };
            if !channel.belongs_to(pair) {
                continue;
            }
            let [output, input] =
                Channel::of_pair(pair).map(|channel| self.context.channel(channel));
            let product_or_sum = if is_gain {
                format!("k_{output} k_{input}")
            } else {
                format!("τ_{output} + τ_{input}")
            };
            steps.push(format!(
                "{product_or_sum} = {}{unit} (held)",
                five_digits(scale * target)
            ));
        }
        let bounds = &self.problem.bounds;
        let value = self.solution.channels()[channel];
        let place = if value == bounds.lower {
            ", on the lower bound"
        } else if value == bounds.upper {
            ", on the upper bound"
        } else {
            ""
        };
        steps.push(format!(
            "{} ≤ {name_and_value} ≤ {}{unit}{place}",
            five_digits(scale * bounds.lower),
            five_digits(scale * bounds.upper)
        ));
        steps
    }

    fn rests_on(&self) -> Vec<String> {
        let defined = self
            .problem
            .delta
            .iter()
            .filter(|(pair, delta)| delta.is_some() && self.problem.fitted[*pair])
            .count();
        let mut rests_on = self.context.models();
        rests_on.push(self.context.held());
        rests_on.push(format!(
            "{} fitted, α = {}",
            counted(defined, "response"),
            six_digits(self.problem.alpha)
        ));
        rests_on.push(proof_text(self.solution.proof.outcome));
        rests_on
    }

    /// Derives the objective's value: fit term plus regularisation term.
    fn objective_derivation(&self, objective: &Objective) -> Derivation {
        let Objective { unit, scale, .. } = *objective;
        let value = scale * self.solution.objective;
        let without_alpha = Problem {
            alpha: 0.0,
            ..self.problem.clone()
        };
        let fit = scale * without_alpha.objective_at(&self.solution.inputs, &self.solution.outputs);
        let step = format!(
            "{} (fit) + {} (α = {}) = {}{unit}",
            five_digits(fit),
            five_digits(value - fit),
            six_digits(self.problem.alpha),
            five_digits(value)
        );
        let mut rests_on = self.rests_on();
        rests_on.push(format!(
            "proven lower bound of the objective: {}{unit}",
            five_digits(scale * self.solution.proof.lower_bound)
        ));
        Derivation {
            title: self
                .context
                .title(&format!("objective of the {}s", self.problem.quantity)),
            equation: objective.equation.to_owned(),
            with_numbers: vec![step],
            rests_on,
            section: objective.section,
            value,
        }
    }
}
