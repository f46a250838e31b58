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

/// Origin of bounds that the settings give, instead of the quantiles in the equation.
const SET_BY_HAND: &str = "set by hand for all conditions; the equation is not used";

/// Responses whose mismatches give the bounds: the on-axis responses, or all responses if none is
/// on-axis or no on-axis response has a mismatch.
struct Pool<'a> {
    pairs: Vec<Pair>,
    mismatches: Vec<&'a Mismatch>,
}

impl<'a> Pool<'a> {
    fn new(context: &Context<'a>, mismatch: impl Fn(Pair) -> Option<&'a Mismatch>) -> Self {
        let measuring = context.analysis.study.dataset.measuring_pairs();
        let on_axis = Self::of_pairs(measuring.marked(), &mismatch);
        if on_axis.mismatches.is_empty() {
            Self::of_pairs(measuring.pairs(), &mismatch)
        } else {
            on_axis
        }
    }

    fn of_pairs(
        pairs: impl Iterator<Item = Pair>,
        mismatch: impl Fn(Pair) -> Option<&'a Mismatch>,
    ) -> Self {
        let mut pool = Self {
            pairs: Vec::new(),
            mismatches: Vec::new(),
        };
        for pair in pairs {
            if let Some(found) = mismatch(pair) {
                pool.pairs.push(pair);
                pool.mismatches.push(found);
            }
        }
        pool
    }

    /// Describes the models, the band and the responses.
    fn rests_on(&self, context: &Context<'_>) -> Vec<String> {
        let mut rests_on = context.models();
        rests_on.push(context.band());
        rests_on.push(format!(
            "responses {}",
            context.pairs(self.pairs.iter().copied())
        ));
        rests_on
    }
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
            vec![SET_BY_HAND.to_owned()],
        )
    } else {
        let quantile = context.settings().quantile;
        let pool = Pool::new(context, |pair| context.compensated_mismatch(pair));
        let ratios: Vec<f64> = pool
            .mismatches
            .iter()
            .flat_map(|mismatch| gain_ratios(mismatch))
            .collect();
        let sample = range_words(&ratios);
        let low = percent(quantile);
        let high = percent(1.0 - quantile);
        (
            vec![
                format!("LB = min(1, {low} % quantile of {sample}) = {lower}"),
                format!("UB = max(1, {high} % quantile of {sample}) = {upper}"),
            ],
            pool.rests_on(context),
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
        (format!("UB = {upper} ms"), vec![SET_BY_HAND.to_owned()])
    } else {
        let pool = Pool::new(context, |pair| context.mismatch(pair));
        let delays_ms: Vec<f64> = pool
            .mismatches
            .iter()
            .flat_map(|mismatch| delays_ms(mismatch, context.omega()))
            .collect();
        let high = percent(1.0 - context.settings().quantile);
        (
            format!(
                "UB = max(0, {high} % quantile of {}) = {upper} ms",
                range_words(&delays_ms)
            ),
            pool.rests_on(context),
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
