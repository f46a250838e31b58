//! Derives the bounds on gains and delays (M7).
//!
//! The bounds `LB` and `UB` apply to all channels. They are quantiles of what the responses need,
//! pooled over responses and frequencies: `|H_ref| / |H_sim|` for gains, `Δφ/ω` for delays.

use gdcm_method::fidelity::Mismatch;
use gdcm_model::dataset::Pair;
use gdcm_model::number_format::five_digits;
use gdcm_model::units::{number, s_to_ms};

use super::deltas::{delays_ms, gain_ratios};
use super::sample_words::range_words;
use super::{Context, Derivation};

/// Collects the mismatches in the on-axis responses, or in all responses if none is on-axis or no
/// on-axis response has a mismatch.
fn pooled<'a>(
    context: &Context<'a>,
    mismatch: impl Fn(Pair) -> Option<&'a Mismatch>,
) -> Vec<&'a Mismatch> {
    let measuring = context.analysis.study.dataset.measuring_pairs();
    let marked: Vec<&Mismatch> = measuring.marked().filter_map(&mismatch).collect();
    if marked.is_empty() {
        measuring.pairs().filter_map(&mismatch).collect()
    } else {
        marked
    }
}

fn pool_rests_on(context: &Context<'_>) -> Vec<String> {
    let mut rests_on = context.models();
    rests_on.push(context.band());
    rests_on.push(context.measured_responses());
    rests_on
}

/// Formats a quantile in percent, without floating-point noise.
fn percent(share: f64) -> String {
    number((1e6 * share).round() / 1e4)
}

/// Derives the bounds on the channel gains.
pub(super) fn gain_bounds(context: &Context<'_>) -> Derivation {
    let bounds = context.result.gain_bounds();
    let lower = five_digits(bounds.lower);
    let upper = five_digits(bounds.upper);
    let (with_numbers, rests_on) = if context.settings().gain_bounds.is_some() {
        (
            vec![format!("LB = {lower}"), format!("UB = {upper}")],
            vec!["set by hand".to_owned()],
        )
    } else {
        let quantile = context.settings().quantile;
        let pool: Vec<f64> = pooled(context, |pair| context.compensated_mismatch(pair))
            .into_iter()
            .flat_map(gain_ratios)
            .collect();
        let pool = range_words(&pool);
        let low = percent(quantile);
        let high = percent(1.0 - quantile);
        (
            vec![
                format!("LB = min(1, {low} % quantile of {pool}) = {lower}"),
                format!("UB = max(1, {high} % quantile of {pool}) = {upper}"),
            ],
            pool_rests_on(context),
        )
    };
    Derivation {
        title: context.title("bounds of the gains"),
        equation: "LB = min(1, q-quantile of |H_ref| / |H_sim|), UB = max(1, (1 − q)-quantile)"
            .to_owned(),
        with_numbers,
        rests_on,
        section: "M7",
        value: bounds.upper,
    }
}

/// Derives the upper bound on the channel delays.
pub(super) fn delay_bound(context: &Context<'_>) -> Derivation {
    let value = s_to_ms(context.result.delay_upper_s());
    let upper = five_digits(value);
    let (step, rests_on) = if context.settings().delay_upper_s.is_some() {
        (format!("UB = {upper} ms"), vec!["set by hand".to_owned()])
    } else {
        let pool: Vec<f64> = pooled(context, |pair| context.mismatch(pair))
            .into_iter()
            .flat_map(|mismatch| delays_ms(mismatch, context.omega()))
            .collect();
        let high = percent(1.0 - context.settings().quantile);
        (
            format!(
                "UB = max(0, {high} % quantile of {}) = {upper} ms",
                range_words(&pool)
            ),
            pool_rests_on(context),
        )
    };
    Derivation {
        title: context.title("upper bound of the delays"),
        equation: "UB = max(0, (1 − q)-quantile of Δφ/ω)".to_owned(),
        with_numbers: vec![step],
        rests_on,
        section: "M7",
        value,
    }
}
