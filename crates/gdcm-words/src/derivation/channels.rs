//! Derivations of channel gains and delays, net gains and delays, and objectives (M8, M9, M11).

use gdcm_method::correction::{Channel, Problem, Quantity, Solution};
use gdcm_model::dataset::Pair;
use gdcm_model::number_format::five_digits;
use gdcm_model::units::{s_to_ms, six_digits};

use super::{Context, Derivation, gain_objective_equation};
use crate::leads::servo_words;

pub(super) fn net_gain(context: &Context<'_>, pair: Pair) -> Derivation {
    let correction = &context.result.correction;
    let [output, input] = Channel::of(pair);
    let [name_o, name_i] = [output, input].map(|channel| context.channel(channel));
    let gain_o = five_digits(correction.gain(output));
    let gain_i = five_digits(correction.gain(input));
    let value = correction.net_gain(pair);
    Derivation {
        title: context.title(&format!("net gain of {}", context.pair(pair))),
        equation: "k_o k_i".to_owned(),
        with_numbers: vec![format!(
            "k_{name_o} k_{name_i} = {gain_o} · {gain_i} = {}",
            five_digits(value)
        )],
        rests_on: vec![held_at(
            context,
            pair,
            &context.result.gains,
            context.result.wanted_gain(pair),
        )],
        section: "M11, eq. (12)",
        value,
    }
}

pub(super) fn net_delay(context: &Context<'_>, pair: Pair) -> Derivation {
    let correction = &context.result.correction;
    let [output, input] = Channel::of(pair).map(|channel| context.channel(channel));
    let value = s_to_ms(correction.net_delay_s(pair));
    let parts = Channel::of(pair)
        .map(|channel| five_digits(s_to_ms(correction.delay_s(channel))))
        .join(" + ");
    let delta_ms = context.result.wanted_delay_s(pair).map(s_to_ms);
    Derivation {
        title: context.title(&format!("net delay of {}", context.pair(pair))),
        equation: "τ_o + τ_i".to_owned(),
        with_numbers: vec![format!(
            "τ_{output} + τ_{input} = {parts} = {} ms",
            five_digits(value)
        )],
        rests_on: vec![held_at(context, pair, &context.result.delays, delta_ms)],
        section: "M10, eq. (12)",
        value,
    }
}

/// Describes whether a response is constrained, and its value.
fn held_at(context: &Context<'_>, pair: Pair, solution: &Solution, delta: Option<f64>) -> String {
    let delta = delta.map_or("nothing defined".to_owned(), five_digits);
    let name = context.pair(pair);
    match solution.targets[pair] {
        None => format!("{name} is free, its delta is {delta}"),
        Some(_) if solution.unmatched.iter().any(|miss| miss.pair == pair) => {
            format!("{name} is held at the nearest that can be reached, its delta is {delta}")
        }
        Some(_) => format!("{name} is held at its delta {delta}"),
    }
}

pub(super) fn gain(context: &Context<'_>, channel: Channel) -> Option<Derivation> {
    let value = *context.result.gains.channels().get(channel)?;
    let (equation, _) = gain_objective_equation(context.settings().gain_objective);
    let problem = &context.result.gain_problem;
    let name = format!("k_{}", context.channel(channel));
    Some(Derivation {
        title: context.title(&name),
        equation: format!("min {equation}, subject to k_o k_i = G (held), LB ≤ k ≤ UB"),
        with_numbers: steps(
            context,
            channel,
            problem,
            &context.result.gains,
            &format!("{name} = {}", five_digits(value)),
        ),
        rests_on: optimum_rests_on(context, problem, &context.result.gains),
        section: "M8, eq. (7)",
        value,
    })
}

pub(super) fn delay(context: &Context<'_>, channel: Channel) -> Option<Derivation> {
    let value = s_to_ms(*context.result.delays.channels().get(channel)?);
    let problem = &context.result.delay_problem;
    let solution = &context.result.delays;
    let name = format!("τ_{}", context.channel(channel));
    let (objective, section) = delay_equation(problem.quantity);
    let bounds = if problem.quantity == Quantity::SignedDelay {
        "LB"
    } else {
        "0"
    };
    let mut with_numbers = steps(
        context,
        channel,
        problem,
        solution,
        &format!("{name} = {} ms", five_digits(value)),
    );
    with_numbers.extend(context.result.correction.lead(channel).map(|filter| {
        let lead_ms = five_digits(s_to_ms(filter.lead_s()));
        format!(
            "its filter has {lead_ms} ms of lead at low frequency: {}",
            servo_words(filter)
        )
    }));
    Some(Derivation {
        title: context.title(&name),
        equation: format!("min {objective}, subject to τ_o + τ_i = D (held), {bounds} ≤ τ ≤ UB"),
        with_numbers,
        rests_on: optimum_rests_on(context, problem, solution),
        section,
        value,
    })
}

/// Returns the objective of delays or signed delays, and its section.
fn delay_equation(quantity: Quantity) -> (&'static str, &'static str) {
    match quantity {
        Quantity::SignedDelay => ("Σ w (D − τ_o − τ_i)² + α (Σ τ_o² + Σ τ_i²)", "M15.4"),
        _ => ("Σ w (D − τ_o − τ_i)² + α Σ τ_o²", "M9, eq. (11)"),
    }
}

/// Lists the constrained responses that tie the channel to others, the bounds, and the value.
fn steps(
    context: &Context<'_>,
    channel: Channel,
    problem: &Problem,
    solution: &Solution,
    last: &str,
) -> Vec<String> {
    let is_gain = problem.quantity.is_gain();
    let (unit, scale) = if is_gain { ("", 1.0) } else { (" ms", 1e3) };
    let ties = solution
        .targets
        .iter()
        .filter(|(pair, _)| channel.is_of(*pair));
    let tie = |(pair, target): (Pair, &Option<f64>)| {
        let target = (*target)?;
        let [output, input] = Channel::of(pair).map(|channel| context.channel(channel));
        let sum = if is_gain {
            format!("k_{output} k_{input}")
        } else {
            format!("τ_{output} + τ_{input}")
        };
        Some(format!(
            "{sum} = {}{unit} (held)",
            five_digits(scale * target)
        ))
    };
    let mut steps: Vec<String> = ties.filter_map(tie).collect();
    let lower = problem.bounds.lower;
    let upper = problem.bounds.upper;
    let value = solution.channels()[channel];
    let place = match (value == lower, value == upper) {
        (true, _) => ", on the lower bound",
        (_, true) => ", on the upper bound",
        _ => "",
    };
    let lower = five_digits(scale * lower);
    let upper = five_digits(scale * upper);
    steps.push(format!("{lower} ≤ {last} ≤ {upper}{unit}{place}"));
    steps
}

fn optimum_rests_on(context: &Context<'_>, problem: &Problem, solution: &Solution) -> Vec<String> {
    let defined = problem
        .delta
        .iter()
        .filter(|(pair, delta)| delta.is_some() && problem.fitted[*pair])
        .count();
    let mut rests_on = context.models();
    rests_on.extend([
        context.held(),
        format!(
            "{defined} responses fitted, α = {}",
            six_digits(problem.alpha)
        ),
        solution.proof.outcome.words(),
    ]);
    rests_on
}

pub(super) fn gain_objective(context: &Context<'_>) -> Derivation {
    let (equation, unit) = gain_objective_equation(context.settings().gain_objective);
    objective(
        context,
        (equation, unit, 1.0),
        (&context.result.gain_problem, &context.result.gains),
        "M8, eq. (7)",
    )
}

pub(super) fn delay_objective(context: &Context<'_>) -> Derivation {
    let problem = &context.result.delay_problem;
    let solution = &context.result.delays;
    let (equation, section) = delay_equation(problem.quantity);
    objective(
        context,
        (equation, " ms²", 1e6),
        (problem, solution),
        section,
    )
}

fn objective(
    context: &Context<'_>,
    (equation, unit, scale): (&str, &str, f64),
    (problem, solution): (&Problem, &Solution),
    section: &'static str,
) -> Derivation {
    let value = scale * solution.objective;
    let fit = scale
        * Problem {
            alpha: 0.0,
            ..problem.clone()
        }
        .objective_at(&solution.inputs, &solution.outputs);
    let parts = format!(
        "{} (fit) + {} (α = {})",
        five_digits(fit),
        five_digits(value - fit),
        six_digits(problem.alpha)
    );
    let mut rests_on = optimum_rests_on(context, problem, solution);
    rests_on.push(format!(
        "no less than {}{unit} is possible",
        five_digits(scale * solution.proof.lower_bound)
    ));
    Derivation {
        title: context.title(&format!("objective of the {}s", problem.quantity)),
        equation: equation.to_owned(),
        with_numbers: vec![format!("{parts} = {}{unit}", five_digits(value))],
        rests_on,
        section,
        value,
    }
}
