//! Derives delta gain G and delta delay D (M6). They are the gain and the delay that would match a
//! response of the physics representative `H_sim` to that of the identified one, `H_ref`; Δφ is the
//! phase of `H_sim` less that of `H_ref`. Each is a [`Derivation`]: the equation, the same with
//! numbers, and what the result rests on, as texts.
//!
//! With lead filters `L_o` and `L_i`, `H_sim` is *compensated* by them before G is found; D comes
//! from `H_sim` itself, because the filters follow from D (M15.5). The *band delay* is the slope of
//! the straight line through the origin that fits Δφ over the band (M15.2).

use gdcm_method::correction::delta::GainSource;
use gdcm_method::fidelity::Mismatch;
use gdcm_model::dataset::{BundleKind, Pair};
use gdcm_model::number_format::{counted, five_digits};
use gdcm_model::units::{db_to_ratio, s_to_ms};

use super::sample_words::{median_words, range_words};
use super::{Context, Derivation};

/// Returns `|H_ref| / |H_sim|` at each frequency: the inverse of the mismatch in magnitude.
pub(super) fn gain_ratios(mismatch: &Mismatch) -> Vec<f64> {
    mismatch
        .magnitude_db
        .iter()
        .map(|error_db| db_to_ratio(-error_db))
        .collect()
}

/// Returns `Δφ/ω` \[ms\] at each frequency, with Δφ on the turn nearest to the best-fitting pure
/// delay (M6b).
pub(super) fn delays_ms(mismatch: &Mismatch, omega: &[f64]) -> Vec<f64> {
    let phases = mismatch.phase_difference(omega);
    phases
        .iter()
        .zip(mismatch.omega(omega))
        .map(|(phase, omega)| s_to_ms(phase / omega))
        .collect()
}

/// Describes the median of `values`, weighted if coherence is used.
fn weighted_median_words(mismatch: &Mismatch, values: &[f64]) -> String {
    match mismatch.coherence_weights {
        None => median_words(values),
        Some(_) => format!("the weighted median of {}", range_words(values)),
    }
}

/// Derives a response's delta gain `G`: with leads, the median of the representatives' ratio that
/// remains after them (M15.5); else, if the settings ask for it, the mean over all pairs of models
/// that are not rejected; else the median of the representatives' ratio. `None` if the response has
/// no delta gain.
pub(super) fn gain(context: &Context<'_>, pair: Pair) -> Option<Derivation> {
    let value = context.result.delta_gain(pair)?;
    let mismatch = context.compensated_mismatch(pair)?;
    let title = context.title(&format!("G of {}", context.pair(pair)));
    if context.result.compensated.is_none()
        && context.settings().gain_source == GainSource::MeanOfPairs
    {
        return Some(mean_gain(context, title, value));
    }
    let (equation, section) = match context.result.compensated {
        None => ("G = median_ω |H_ref| / |H_sim|", "M6, eq. (5)"),
        Some(_) => ("G = median_ω |H_ref| / |L_o H_sim L_i|", "M15.5, eq. (5)"),
    };
    let median = weighted_median_words(mismatch, &gain_ratios(mismatch));
    Some(Derivation {
        title,
        equation: equation.to_owned(),
        with_numbers: vec![format!("G = {median} = {}", five_digits(value))],
        rests_on: context.models_and_frequencies(mismatch),
        section,
        value,
    })
}

/// Derives a delta gain that is the geometric mean over all pairs of models that are not rejected,
/// not that of the representatives.
fn mean_gain(context: &Context<'_>, title: String, value: f64) -> Derivation {
    let [physics, identified] = BundleKind::BOTH.map(|kind| {
        let scores = &context.result.representative(kind).scores;
        scores.iter().flatten().count()
    });
    let models = format!(
        "{} and {} that are kept",
        counted(physics, "physics model"),
        counted(identified, "identified model")
    );
    Derivation {
        title,
        equation:
            "G = exp mean ln median_ω |H_ref| / |H_sim|, the mean over all pairs of kept models"
                .to_owned(),
        with_numbers: vec![format!("G = {}", five_digits(value))],
        rests_on: vec![models, context.band()],
        section: "M6, eq. (5)",
        value,
    }
}

/// Derives a response's delta delay `D`: the band delay if the delays are fitted to it, otherwise
/// the median; `None` if the response has no delta delay.
pub(super) fn delay(context: &Context<'_>, pair: Pair) -> Option<Derivation> {
    let value = s_to_ms(context.result.delta_delay_s(pair)?);
    let mismatch = context.mismatch(pair)?;
    let mut rests_on = context.models_and_frequencies(mismatch);
    let uses_band_delay = context.result.fits_band_delays();
    let (equation, step, section) = if uses_band_delay {
        (
            "D = Σ W ω Δφ(H_sim, H_ref) / Σ W ω²",
            band_delay_words(context, mismatch),
            "M15.2",
        )
    } else {
        (
            "D = median_ω Δφ(H_sim, H_ref) / ω",
            weighted_median_words(mismatch, &delays_ms(mismatch, context.omega())),
            "M6, eq. (9)",
        )
    };
    if mismatch.leaves_half_a_turn() {
        rests_on.push(
            "at each frequency, the phase is taken on the turn nearest to the best-fitting pure \
            delay (M6b)"
                .to_owned(),
        );
    }
    Some(Derivation {
        title: context.title(&format!("D of {}", context.pair(pair))),
        equation: equation.to_owned(),
        with_numbers: vec![format!("D = {step} = {} ms", five_digits(value))],
        rests_on,
        section,
        value,
    })
}

/// Writes the least-squares slope of Δφ over frequency as a quotient.
fn band_delay_words(context: &Context<'_>, mismatch: &Mismatch) -> String {
    let omega = mismatch.omega(context.omega());
    let phase = mismatch.phase_difference(context.omega());
    format!(
        "{} rad²/s / {} rad²/s²",
        five_digits(weighted_sum(mismatch, omega, &phase)),
        five_digits(weighted_sum(mismatch, omega, omega))
    )
}

/// Returns `Σ W ω x`.
fn weighted_sum(mismatch: &Mismatch, omega: &[f64], x: &[f64]) -> f64 {
    let weights = mismatch.weights();
    (0..omega.len())
        .map(|index| {
            let weight = match weights {
                Some(weights) => weights[index],
                None => 1.0,
            };
            weight * (omega[index] * x[index])
        })
        .sum()
}
