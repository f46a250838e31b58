//! How scores and discontinuity ratios were computed (M5).

use crate::dataset::{BundleKind, ModelId};
use crate::fidelity::SUGGESTION_RATIO;

use super::Derivation;
use super::context::{Context, digits, median_words};

/// Terms of a sum that are written out.
const MOST_TERMS: usize = 8;

/// "a + b + c + … (20 terms)".
fn sum_words(terms: &[f64]) -> String {
    let shown: Vec<String> = terms.iter().take(MOST_TERMS).map(|term| digits(*term)).collect();
    let more = if terms.len() > MOST_TERMS { format!(" + … ({} terms)", terms.len()) } else { String::new() };
    format!("{}{more}", shown.join(" + "))
}

fn distance_rests_on(context: &Context<'_>, models: String) -> Vec<String> {
    vec![models, context.band(), context.measuring()]
}

pub(super) fn score(context: &Context<'_>, model: &ModelId) -> Option<Derivation> {
    let (result, kind) = (context.result, model.bundle);
    let value = result.score(kind, &model.name)?;
    let place = result.condition.position(kind, &model.name)?;
    let scores = &result.representative(kind).scores;
    let others: Vec<usize> = (0..scores.len()).filter(|&other| other != place && scores[other].is_some()).collect();
    let distances: Vec<f64> =
        others.iter().filter_map(|&other| result.figures.bundle(kind).between(place, other)).collect();
    let with_numbers = if distances.is_empty() {
        vec!["s = 0: it is the only model kept".to_owned()]
    } else {
        vec![format!("s = ({}) / {} = {}", sum_words(&distances), distances.len(), digits(value))]
    };
    let representative = result.representative_name(kind);
    let models = format!("{} {kind} models kept; {representative} represents them", distances.len() + 1);
    Some(Derivation {
        title: context.title(&format!("score of {}", model.name)),
        equation: "s_a = mean over b ≠ a of d(a, b), d(a, b)² = mean over the responses of J(a against b)".to_owned(),
        with_numbers,
        rests_on: distance_rests_on(context, models),
        section: "M5",
        value,
    })
}

pub(super) fn ratio(context: &Context<'_>, model: &ModelId) -> Option<Derivation> {
    const EQUATION: &str = "r_a = median over b of d(a, b) / √(Σ_k w_k (p_ak − p_bk)²); each p divided by its largest, w ≥ 0 by \
                            least absolute deviations";
    let result = context.result;
    let value = result.discontinuity_ratio(&model.name)?;
    let fit = result.figures.discontinuity.as_ref().ok()?;
    let models = result.condition.bundle(BundleKind::Physics);
    let place = result.condition.position(BundleKind::Physics, &model.name)?;
    let of_model = models[place].perturbation()?;
    let ratio = |other: usize| {
        let fitted = fit.fitted_distance(of_model, models.get(other)?.perturbation()?);
        let distance = result.figures.physics.between(place, other)?;
        (other != place && fitted > 0.0).then(|| distance / fitted)
    };
    let ratios: Vec<f64> = (0..models.len()).filter_map(ratio).collect();
    let weights =
        fit.weights.iter().map(|of| format!("w_{} = {} over ±{}", of.name, digits(of.weight), digits(of.largest)));
    let mut with_numbers: Vec<String> = weights.collect();
    with_numbers.push(format!("r = {} = {}", median_words(&ratios), digits(value)));
    let models = format!("all {} physics models, whatever is rejected", models.len());
    let mut rests_on = distance_rests_on(context, models);
    rests_on.push(format!("above {SUGGESTION_RATIO} a model is suggested as an outlier"));
    Some(Derivation {
        title: context.title(&format!("discontinuity ratio of {}", model.name)),
        equation: EQUATION.to_owned(),
        with_numbers,
        rests_on,
        section: "M5",
        value,
    })
}
