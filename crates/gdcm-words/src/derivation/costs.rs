//! Derives J (M4), scores and discontinuity ratios (M5).

use gdcm_method::correction::{Channel, ChannelCorrection};
use gdcm_method::fidelity::{Cost, CostAverage, SUGGESTION_RATIO};
use gdcm_model::dataset::model::Origin;
use gdcm_model::dataset::{BundleKind, Dynamics, Model, ModelId, Pair};
use gdcm_model::number_format::{counted, five_digits};
use gdcm_model::units::{s_to_ms, signed};
use gdcm_study::results::assessment_table::{AssessedModel, AssessmentChoice, assessed};

use super::context::weight_words;
use super::sample_words::median_words;
use super::{Context, Derivation};
use crate::assessment::correction_source;

/// Maximum number of terms that are written out in a sum.
const MOST_TERMS: usize = 8;

/// Section that defines J in the method description.
const COST_SECTION: &str = "M4, eq. (14) to (19)";

/// Writes a sum: "a + b + c + … (20 terms)".
fn sum_words(terms: &[f64]) -> String {
    let shown: Vec<String> = terms
        .iter()
        .take(MOST_TERMS)
        .map(|term| five_digits(*term))
        .collect();
    let sum = shown.join(" + ");
    if terms.len() > MOST_TERMS {
        format!("{sum} + … ({} terms)", terms.len())
    } else {
        sum
    }
}

/// Describes a model: origin, states, sampling, and source.
fn model_words(model: &Model) -> Vec<String> {
    let mut words = Vec::new();
    if let Origin::Identified {
        method: Some(method),
        ..
    } = &model.origin
    {
        words.push(format!("identified by {method}"));
    }
    if let Some(order) = model.order() {
        words.push(format!("{order} states"));
    }
    if let Dynamics::StateSpace(matrices) = &model.dynamics
        && !matrices.timing().is_plain()
    {
        words.push(matrices.timing().words());
    }
    if let Some(source) = &model.source {
        words.push(source.origin_words());
    }
    words
}

/// Derives a model's score: its mean distance to the other kept models.
pub(super) fn score(context: &Context<'_>, model: &ModelId) -> Option<Derivation> {
    let result = context.result;
    let kind = model.bundle;
    let value = result.score(kind, &model.name)?;
    let index = result.condition.position(kind, &model.name)?;
    let scores = &result.representative(kind).scores;
    let distances: Vec<f64> = (0..scores.len())
        .filter(|&other| other != index && scores[other].is_some())
        .filter_map(|other| result.bundle_metrics.bundle(kind).between(index, other))
        .collect();
    let step = if distances.is_empty() {
        "s = 0, because no other model is kept".to_owned()
    } else {
        format!(
            "s = ({}) / {} = {}",
            sum_words(&distances),
            distances.len(),
            five_digits(value)
        )
    };
    let mut rests_on = vec![
        format!(
            "{} kept; {} is used as representative",
            counted(distances.len() + 1, &format!("{kind} model")),
            result.representative_name(kind)
        ),
        context.band(),
        context.measuring(),
    ];
    if let Some(model) = result.condition.bundle(kind).get(index) {
        rests_on.extend(model_words(model));
    }
    Some(Derivation {
        title: context.title(&format!("score of {}", model.name)),
        equation:
            "s_a = mean over b ≠ a of d(a, b), d(a, b)² = mean over the responses of J(a against b)"
                .to_owned(),
        with_numbers: vec![step],
        rests_on,
        section: "M5",
        value,
    })
}

/// Derives a physics model's discontinuity ratio: its distance to other models, relative to the
/// distance that the difference in trim explains (the fitted distance).
pub(super) fn ratio(context: &Context<'_>, model: &ModelId) -> Option<Derivation> {
    const EQUATION: &str = "r_a = median over b of d(a, b) / √(Σ_k w_k (p_ak − p_bk)²); each p \
        divided by its maximum, w_k ≥ 0 by least absolute deviations";
    let result = context.result;
    let value = result.discontinuity_ratio(&model.name)?;
    let fit = result.bundle_metrics.discontinuity.as_ref().ok()?;
    let models = result.condition.bundle(BundleKind::Physics);
    let index = result
        .condition
        .position(BundleKind::Physics, &model.name)?;
    let perturbation = models[index].perturbation()?;
    let mut ratios = Vec::new();
    for (other, other_model) in models.iter().enumerate() {
        let (Some(other_perturbation), Some(distance)) = (
            other_model.perturbation(),
            result.bundle_metrics.physics.between(index, other),
        ) else {
            continue;
        };
        let fitted = fit.fitted_distance(perturbation, other_perturbation);
        if other != index && fitted > 0.0 {
            ratios.push(distance / fitted);
        }
    }
    let mut with_numbers: Vec<String> = fit
        .weights
        .iter()
        .map(|coordinate| {
            format!(
                "w_{} = {}, perturbations up to ±{}",
                coordinate.name,
                five_digits(coordinate.weight),
                five_digits(coordinate.largest)
            )
        })
        .collect();
    with_numbers.push(format!(
        "r = {} = {}",
        median_words(&ratios),
        five_digits(value)
    ));
    let mut rests_on = vec![
        format!(
            "all {} physics models, including rejected models",
            models.len()
        ),
        context.band(),
        context.measuring(),
    ];
    rests_on.extend(model_words(&models[index]));
    rests_on.push(format!(
        "a model above {SUGGESTION_RATIO} is suggested as an outlier"
    ));
    Some(Derivation {
        title: context.title(&format!("discontinuity ratio of {}", model.name)),
        equation: EQUATION.to_owned(),
        with_numbers,
        rests_on,
        section: "M5",
        value,
    })
}

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
    let mut with_numbers = vec![correction_words(context, pair, &context.result.correction)];
    with_numbers.extend(cost_steps("J", cost, average));
    Some(Derivation {
        title: context.title(&format!("J of {} after the correction", context.pair(pair))),
        equation: format!(
            "{}; for the corrected response H_sim · k_o k_i e^(−jω(τ_o + τ_i))",
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
