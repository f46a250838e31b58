//! Derives J before and after a correction (M4), and its change in an assessment (M12), each as a
//! [`Derivation`]: the equation, the same with numbers, and what the result rests on, as texts.

use gdcm_method::correction::{Channel, ChannelCorrection};
use gdcm_method::fidelity::{Cost, CostAverage};
use gdcm_model::dataset::{BundleKind, Pair};
use gdcm_model::number_format::five_digits;
use gdcm_model::units::{s_to_ms, signed};
use gdcm_study::results::assessment_table::{AssessedModel, AssessmentChoice, assessed};

use super::context::weight_words;
use super::{Context, Derivation};
use crate::assessment::correction_source;

/// Section that defines J in the method description.
const COST_SECTION: &str = "M4, eq. (14) to (19)";

/// Returns the word that an equation uses for the average over frequency.
fn average_word(average: CostAverage) -> &'static str {
    match average {
        CostAverage::Median => "median",
        CostAverage::Mean => "mean",
    }
}

fn cost_equation(average: CostAverage) -> String {
    let word = average_word(average);
    let [per_db, per_deg] = Cost::factors();
    format!("J = {per_db} · {word}_ω(ΔdB²) + {per_deg} · {word}_ω(Δφ²), dB and degrees")
}

/// Writes the steps from a mismatch to J: magnitude part, phase part, and their sum.
fn cost_steps(symbol: &str, cost: Cost, average: CostAverage) -> [String; 3] {
    let word = average_word(average);
    let [per_db, per_deg] = Cost::factors();
    let [db_squared, deg_squared] = cost.averages().map(five_digits);
    let magnitude = five_digits(cost.magnitude);
    let phase = five_digits(cost.phase);
    let total = five_digits(cost.total());
    [
        format!(
            "{symbol}_mag = {per_db} · {db_squared} dB² = {magnitude}   ({word} of the squares)"
        ),
        format!("{symbol}_phase = {per_deg} · {deg_squared} deg² = {phase}"),
        format!("{symbol} = {magnitude} + {phase} = {total}"),
    ]
}

/// Describes a correction's net gain and net delay.
fn correction_words(context: &Context<'_>, pair: Pair, correction: &ChannelCorrection) -> String {
    let [output, input] = Channel::of_pair(pair).map(|channel| context.channel(channel));
    format!(
        "k_{output} k_{input} = {}, τ_{output} + τ_{input} = {} ms",
        five_digits(correction.net_gain(pair)),
        five_digits(s_to_ms(correction.net_delay_s(pair)))
    )
}

/// Derives a response's J before the correction.
pub(super) fn cost_before(context: &Context<'_>, pair: Pair) -> Option<Derivation> {
    let cost = context.result.cost[pair]?.uncorrected;
    let average = context.settings().cost_average;
    Some(Derivation {
        title: context.title(&format!(
            "J of {} before the correction",
            context.pair(pair)
        )),
        equation: cost_equation(average),
        with_numbers: cost_steps("J", cost, average).to_vec(),
        rests_on: context.models_and_frequencies(context.mismatch(pair)?),
        section: COST_SECTION,
        value: cost.total(),
    })
}

/// Derives a response's J under the condition's own correction.
pub(super) fn cost_after(context: &Context<'_>, pair: Pair) -> Option<Derivation> {
    let cost = context.result.cost[pair]?.corrected;
    let average = context.settings().cost_average;
    let corrected = if context.result.compensated.is_some() {
        "k_o k_i L_o H_sim L_i"
    } else {
        "H_sim · k_o k_i e^(−jω(τ_o + τ_i))"
    };
    let mut with_numbers = vec![correction_words(context, pair, &context.result.correction)];
    with_numbers.extend(cost_steps("J", cost, average));
    Some(Derivation {
        title: context.title(&format!("J of {} after the correction", context.pair(pair))),
        equation: format!(
            "{}; for the corrected response {corrected}",
            cost_equation(average)
        ),
        with_numbers,
        rests_on: context.models_and_frequencies(context.mismatch(pair)?),
        section: COST_SECTION,
        value: cost.total(),
    })
}

/// Derives the change in a response's J in an assessment.
pub(super) fn change(
    context: &Context<'_>,
    pair: Pair,
    choice: AssessmentChoice,
) -> Option<Derivation> {
    let id = context.result.condition.id();
    let assessed = assessed(context.analysis, id, choice).ok()?;
    let change = assessed.changes.get(pair)?.as_ref()?;
    let correction = choice
        .correction
        .correction(context.analysis, context.result)
        .ok()?;
    let mut with_numbers = vec![format!(
        "{} ({})",
        correction_words(context, pair, &correction),
        correction_source(choice.correction, assessed.airspeed_kt)
    )];
    with_numbers.extend(cost_steps("J₀", change.uncorrected, choice.average));
    with_numbers.extend(cost_steps("J", change.corrected, choice.average));
    with_numbers.push(format!(
        "ΔJ = {} − {} = {} ({} magnitude, {} phase)",
        five_digits(change.corrected.total()),
        five_digits(change.uncorrected.total()),
        five_digits(change.total()),
        signed(change.magnitude(), 2),
        signed(change.phase(), 2)
    ));
    let role = match choice.model {
        AssessedModel::Nominal => "nominal model",
        AssessedModel::Representative => "physics representative",
    };
    let identified = context.result.representative_name(BundleKind::Identified);
    let mut rests_on = vec![
        format!("{role} {} (H_sim)", assessed.model),
        format!("identified representative {identified} (H_ref)"),
        context.band(),
    ];
    rests_on.extend(context.mismatch(pair).and_then(weight_words));
    Some(Derivation {
        title: context.title(&format!("ΔJ of {}", context.pair(pair))),
        equation: format!(
            "ΔJ = J(corrected) − J(uncorrected), {}",
            cost_equation(choice.average)
        ),
        with_numbers,
        rests_on,
        section: "M12, eq. (14) to (19)",
        value: change.total(),
    })
}
