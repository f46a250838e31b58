//! Derivations of scores and discontinuity ratios (M5).

use gdcm_method::correction::{Channel, ChannelCorrection};
use gdcm_method::fidelity::{Cost, CostAverage, SUGGESTION_RATIO};
use gdcm_model::dataset::model::Origin;
use gdcm_model::dataset::{BundleKind, Dynamics, Model, ModelId, Pair};
use gdcm_model::number_format::five_digits;
use gdcm_model::units::{s_to_ms, signed};
use gdcm_study::results::assessment_table::{AssessedModel, AssessmentChoice, assessed};

use super::{Context, Derivation, average_word, counted_words, median_words};
use crate::assessment::correction_source;

/// Greatest number of terms of a sum that are written out.
const MOST_TERMS: usize = 8;

/// Writes a sum: "a + b + c + … (20 terms)".
fn sum_words(terms: &[f64]) -> String {
    let shown: Vec<String> = terms
        .iter()
        .take(MOST_TERMS)
        .map(|term| five_digits(*term))
        .collect();
    let more = if terms.len() > MOST_TERMS {
        format!(" + … ({} terms)", terms.len())
    } else {
        String::new()
    };
    format!("{}{more}", shown.join(" + "))
}

fn distance_rests_on(context: &Context<'_>, models: String) -> Vec<String> {
    vec![models, context.band(), context.measuring()]
}

/// Describes a model: origin, number of states, sampling, and source.
fn model_words(model: &Model) -> impl Iterator<Item = String> {
    let method = match &model.origin {
        Origin::Identified { method, .. } => method
            .as_ref()
            .map(|method| format!("identified by {method}")),
        Origin::Nominal { .. } | Origin::Perturbed { .. } => None,
    };
    let timing = match &model.dynamics {
        Dynamics::StateSpace(matrices) => {
            Some(matrices.timing()).filter(|timing| !timing.is_plain())
        }
        _ => None,
    };
    let order = model.order().map(|order| format!("{order} states"));
    let source = model
        .source
        .as_ref()
        .map(|source| format!("from {}", source.words()));
    [method, order, timing.map(|timing| timing.words()), source]
        .into_iter()
        .flatten()
}

pub(super) fn score(context: &Context<'_>, model: &ModelId) -> Option<Derivation> {
    let result = context.result;
    let kind = model.bundle;
    let value = result.score(kind, &model.name)?;
    let place = result.condition.position(kind, &model.name)?;
    let scores = &result.representative(kind).scores;
    let others: Vec<usize> = (0..scores.len())
        .filter(|&other| other != place && scores[other].is_some())
        .collect();
    let distances: Vec<f64> = others
        .iter()
        .filter_map(|&other| result.figures.bundle(kind).between(place, other))
        .collect();
    let with_numbers = if distances.is_empty() {
        vec!["s = 0: it is the only model kept".to_owned()]
    } else {
        vec![format!(
            "s = ({}) / {} = {}",
            sum_words(&distances),
            distances.len(),
            five_digits(value)
        )]
    };
    let representative = result.representative_name(kind);
    let models = format!(
        "{} {kind} models kept; {representative} is used as representative",
        distances.len() + 1
    );
    let mut rests_on = distance_rests_on(context, models);
    rests_on.extend(
        result
            .condition
            .bundle(kind)
            .get(place)
            .into_iter()
            .flat_map(model_words),
    );
    Some(Derivation {
        title: context.title(&format!("score of {}", model.name)),
        equation:
            "s_a = mean over b ≠ a of d(a, b), d(a, b)² = mean over the responses of J(a against b)"
                .to_owned(),
        with_numbers,
        rests_on,
        section: "M5",
        value,
    })
}

pub(super) fn ratio(context: &Context<'_>, model: &ModelId) -> Option<Derivation> {
    const EQUATION: &str = "r_a = median over b of d(a, b) / √(Σ_k w_k (p_ak − p_bk)²); each p divided by its largest, w_k ≥ 0 by \
                            least absolute deviations";
    let result = context.result;
    let value = result.discontinuity_ratio(&model.name)?;
    let fit = result.figures.discontinuity.as_ref().ok()?;
    let models = result.condition.bundle(BundleKind::Physics);
    let place = result
        .condition
        .position(BundleKind::Physics, &model.name)?;
    let of_model = models[place].perturbation()?;
    let ratio = |other: usize| {
        let fitted = fit.fitted_distance(of_model, models.get(other)?.perturbation()?);
        let distance = result.figures.physics.between(place, other)?;
        (other != place && fitted > 0.0).then(|| distance / fitted)
    };
    let ratios: Vec<f64> = (0..models.len()).filter_map(ratio).collect();
    let weights = fit.weights.iter().map(|of| {
        format!(
            "w_{} = {} over ±{}",
            of.name,
            five_digits(of.weight),
            five_digits(of.largest)
        )
    });
    let mut with_numbers: Vec<String> = weights.collect();
    with_numbers.push(format!(
        "r = {} = {}",
        median_words(&ratios),
        five_digits(value)
    ));
    let bundle = format!("all {} physics models, whatever is rejected", models.len());
    let mut rests_on = distance_rests_on(context, bundle);
    rests_on.extend(model_words(&models[place]));
    rests_on.push(format!(
        "above {SUGGESTION_RATIO} a model is suggested as an outlier"
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

const SECTION: &str = "M4, eq. (14) to (19)";

fn equation(average: CostAverage) -> String {
    let word = average_word(average);
    let [of_db, of_deg] = Cost::factors();
    format!("J = {of_db} · {word}_ω(ΔdB²) + {of_deg} · {word}_ω(Δφ²), dB and degrees")
}

/// Writes J of a mismatch under a correction as two steps and their sum.
fn steps(symbol: &str, cost: Cost, average: CostAverage) -> Vec<String> {
    let word = average_word(average);
    let [of_db, of_deg] = Cost::factors();
    let [db_squared, deg_squared] = cost.averages().map(five_digits);
    let magnitude = five_digits(cost.magnitude);
    let phase = five_digits(cost.phase);
    let total = five_digits(cost.total());
    vec![
        format!(
            "{symbol}_mag = {of_db} · {db_squared} dB² = {magnitude}   ({word} of the squares)"
        ),
        format!("{symbol}_phase = {of_deg} · {deg_squared} deg² = {phase}"),
        format!("{symbol} = {magnitude} + {phase} = {total}"),
    ]
}

fn correction_words(context: &Context<'_>, pair: Pair, correction: &ChannelCorrection) -> String {
    let [output, input] = Channel::of(pair).map(|channel| context.channel(channel));
    let gain = correction.net_gain(pair);
    let delay_ms = s_to_ms(correction.net_delay_s(pair));
    format!(
        "k_{output} k_{input} = {}, τ_{output} + τ_{input} = {} ms",
        five_digits(gain),
        five_digits(delay_ms)
    )
}

/// Derives J of a response before or after the correction.
pub(super) fn cost(context: &Context<'_>, pair: Pair, is_corrected: bool) -> Option<Derivation> {
    let change = context.result.cost[pair]?;
    let average = context.settings().cost_average;
    let (cost, when, of) = match is_corrected {
        false => (change.uncorrected, "before", ""),
        true => (
            change.corrected,
            "after",
            "; of H_sim · k_o k_i e^(−jω(τ_o + τ_i))",
        ),
    };
    let correction =
        is_corrected.then(|| correction_words(context, pair, &context.result.correction));
    Some(Derivation {
        title: context.title(&format!(
            "J of {} {when} the correction",
            context.pair(pair)
        )),
        equation: format!("{}{of}", equation(average)),
        with_numbers: correction
            .into_iter()
            .chain(steps("J", cost, average))
            .collect(),
        rests_on: context.models_and_frequencies(context.mismatch(pair)?),
        section: SECTION,
        value: cost.total(),
    })
}

pub(super) fn change(
    context: &Context<'_>,
    pair: Pair,
    choice: AssessmentChoice,
) -> Option<Derivation> {
    let id = context.result.condition.id();
    let found = assessed(context.analysis, id, choice).ok()?;
    let change = found.changes.get(pair)?.as_ref()?;
    let average = choice.average;
    let which = context.pair(pair);
    let correction = choice
        .correction
        .of(context.analysis, context.result)
        .ok()?;
    let from = correction_source(choice.correction, found.airspeed_kt);
    let role = match choice.model {
        AssessedModel::Nominal => "nominal model",
        AssessedModel::Representative => "physics representative",
    };
    let after = change.corrected.total();
    let before = change.uncorrected.total();
    let mut with_numbers = vec![format!(
        "{} ({from})",
        correction_words(context, pair, &correction)
    )];
    with_numbers.extend(steps("J₀", change.uncorrected, average));
    with_numbers.extend(steps("J", change.corrected, average));
    let parts = format!(
        "{} magnitude, {} phase",
        signed(change.magnitude(), 2),
        signed(change.phase(), 2)
    );
    with_numbers.push(format!(
        "ΔJ = {} − {} = {} ({parts})",
        five_digits(after),
        five_digits(before),
        five_digits(change.total())
    ));
    let mut rests_on = vec![
        format!("{role} {} (H_sim)", found.model),
        format!(
            "identified representative {} (H_ref)",
            context.result.representative_name(BundleKind::Identified)
        ),
        context.band(),
    ];
    rests_on.extend(context.mismatch(pair).and_then(counted_words));
    Some(Derivation {
        title: context.title(&format!("ΔJ of {which}")),
        equation: format!("ΔJ = J(corrected) − J(uncorrected), {}", equation(average)),
        with_numbers,
        rests_on,
        section: "M12, eq. (14) to (19)",
        value: change.total(),
    })
}
