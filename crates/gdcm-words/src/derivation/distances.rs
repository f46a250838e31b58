//! Derives a model's score and its discontinuity ratio (M5), which average its distances from other
//! models in the bundle. Each is a [`Derivation`]: the equation, the same with numbers, and what
//! the result rests on, as texts.

use gdcm_method::fidelity::SUGGESTION_RATIO;
use gdcm_model::dataset::model::Origin;
use gdcm_model::dataset::{BundleKind, Dynamics, Model, ModelId};
use gdcm_model::number_format::{counted, five_digits};

use super::sample_words::median_words;
use super::{Context, Derivation};

/// Maximum number of terms that are written out in a sum.
const MOST_TERMS: usize = 8;

/// Derives a model's score: its mean distance to the other kept models.
pub(super) fn score(context: &Context<'_>, model: &ModelId) -> Option<Derivation> {
    let result = context.result;
    let kind = model.bundle;
    let value = result.score(kind, &model.name)?;
    let distances = result.score_distances(kind, &model.name)?;
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
        context.measured_responses(),
    ];
    if let Some(model) = result.condition.model(kind, &model.name) {
        rests_on.extend(model_words(model));
    }
    Some(Derivation {
        title: context.title(&format!("mean distance of {}", model.name)),
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
    let metrics = &result.bundle_metrics;
    let fit = metrics.discontinuity.as_ref().ok()?;
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
        median_words(&result.pair_ratios(&model.name)?),
        five_digits(value)
    ));
    let compared = metrics.physics.measured().compared_models().len();
    let mut rests_on = vec![
        format!("all {compared} physics models that are not set aside, including rejected models"),
        context.band(),
        context.measured_responses(),
    ];
    if let Some(model) = result.condition.model(BundleKind::Physics, &model.name) {
        rests_on.extend(model_words(model));
    }
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
        words.push(counted(order, "state"));
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
