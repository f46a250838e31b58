//! Derivations of G, D and the bounds (M6, M7).

use gdcm_method::correction::Channel;
use gdcm_method::correction::delta::GainSource;
use gdcm_method::fidelity::Mismatch;
use gdcm_method::schedule::{Regression, Schedule, ScheduledQuantity};
use gdcm_method::uncertainty::{Bar, Scalar, VarianceComponent};
use gdcm_model::dataset::{BundleKind, ConditionId, Pair};
use gdcm_model::number_format::five_digits;
use gdcm_model::units::{db_to_ratio, number, s_to_ms};
use gdcm_study::results::model_swap::{ConditionSubstitutions, ModelSwap};
use gdcm_study::results::reported_error::{reports_error, takes_reported_error};
use gdcm_study::{Analysis, ConditionAnalysis};

use super::{Context, Derivation, ExplainTarget, median_words, spread};

/// Returns `|H_ref| / |H_sim|` at each frequency.
fn ratios(mismatch: &Mismatch) -> Vec<f64> {
    mismatch
        .magnitude_db
        .iter()
        .map(|error| db_to_ratio(-error))
        .collect()
}

/// Returns `Δφ/ω` \[ms\] at each frequency, on the branch of M6b.
fn delays_ms(mismatch: &Mismatch, omega: &[f64]) -> Vec<f64> {
    let phases = mismatch.phase_difference(omega);
    phases
        .iter()
        .zip(mismatch.omega(omega))
        .map(|(phase, omega)| s_to_ms(phase / omega))
        .collect()
}

/// Describes the median over the frequencies with weight.
fn middle_words(mismatch: &Mismatch, values: &[f64]) -> String {
    match mismatch.coherence_weights {
        None => median_words(values),
        Some(_) => format!("where half of the weight lies of {}", spread(values)),
    }
}

pub(super) fn gain(context: &Context<'_>, pair: Pair) -> Option<Derivation> {
    let value = context.result.wanted_gain(pair)?;
    let mismatch = context.compensated_mismatch(pair)?;
    let is_mean = context.settings().gain_source == GainSource::MeanOfPairs
        && context.result.compensated.is_none();
    let (equation, section) = match context.result.compensated {
        _ if is_mean => (
            "G = exp mean ln median_ω |H_ref| / |H_sim|, the mean over all pairs of kept models",
            "M6, eq. (5)",
        ),
        None => ("G = median_ω |H_ref| / |H_sim|", "M6, eq. (5)"),
        Some(_) => ("G = median_ω |H_ref| / |L_o H_sim L_i|", "M15.5, eq. (5)"),
    };
    let (step, rests_on) = if is_mean {
        let kept = |kind| {
            context
                .result
                .representative(kind)
                .scores
                .iter()
                .flatten()
                .count()
        };
        let [physics, identified] = BundleKind::BOTH.map(kept);
        let models = format!("{physics} physics and {identified} identified models that are kept");
        ("G".to_owned(), vec![models, context.band()])
    } else {
        let step = format!("G = {}", middle_words(mismatch, &ratios(mismatch)));
        (step, context.models_and_frequencies(mismatch))
    };
    Some(Derivation {
        title: context.title(&format!("G of {}", context.pair(pair))),
        equation: equation.to_owned(),
        with_numbers: vec![format!("{step} = {}", five_digits(value))],
        rests_on,
        section,
        value,
    })
}

pub(super) fn delay(context: &Context<'_>, pair: Pair) -> Option<Derivation> {
    let value = s_to_ms(context.result.wanted_delay_s(pair)?);
    let mismatch = context.mismatch(pair)?;
    let mut rests_on = context.models_and_frequencies(mismatch);
    let (equation, step, section) = if context.result.asks_band_delays() {
        // The least-squares line through the missing phase.
        let omega = mismatch.omega(context.omega());
        let phase = mismatch.phase_difference(context.omega());
        let weight = |place: usize| mismatch.weights().map_or(1.0, |weights| weights[place]);
        let sum = |of: &[f64]| {
            (0..omega.len())
                .map(|place| weight(place) * (omega[place] * of[place]))
                .sum::<f64>()
        };
        let step = format!(
            "{} rad²/s / {} rad²/s²",
            five_digits(sum(&phase)),
            five_digits(sum(omega))
        );
        ("D = Σ W ω Δφ(H_sim, H_ref) / Σ W ω²", step, "M15.2")
    } else {
        if mismatch.leaves_half_a_turn() {
            rests_on.push(
                "at each frequency the turn nearest to the pure delay that fits best (M6b)"
                    .to_owned(),
            );
        }
        let step = middle_words(mismatch, &delays_ms(mismatch, context.omega()));
        ("D = median_ω Δφ(H_sim, H_ref) / ω", step, "M6, eq. (9)")
    };
    Some(Derivation {
        title: context.title(&format!("D of {}", context.pair(pair))),
        equation: equation.to_owned(),
        with_numbers: vec![format!("D = {step} = {} ms", five_digits(value))],
        rests_on,
        section,
        value,
    })
}

/// Returns the pooled mismatches: of the measuring responses, or of all responses where no
/// measuring response is defined.
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
    [context.models(), vec![context.band(), context.measuring()]].concat()
}

pub(super) fn gain_bounds(context: &Context<'_>) -> Derivation {
    let bounds = context.result.gain_bounds();
    let lower = five_digits(bounds.lower);
    let upper = five_digits(bounds.upper);
    let percent = |share: f64| number((1e6 * share).round() / 1e4);
    let quantile = context.settings().quantile;
    let (with_numbers, rests_on) = match context.settings().gain_bounds {
        Some(_) => (
            vec![format!("LB = {lower}"), format!("UB = {upper}")],
            vec!["set by hand".to_owned()],
        ),
        None => {
            let pool = pooled(context, |pair| context.compensated_mismatch(pair));
            let pool: Vec<f64> = pool.into_iter().flat_map(ratios).collect();
            let pool = spread(&pool);
            let steps = vec![
                format!(
                    "LB = min(1, {} % quantile of {pool}) = {lower}",
                    percent(quantile)
                ),
                format!(
                    "UB = max(1, {} % quantile of {pool}) = {upper}",
                    percent(1.0 - quantile)
                ),
            ];
            (steps, pool_rests_on(context))
        }
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

pub(super) fn delay_bound(context: &Context<'_>) -> Derivation {
    let value = s_to_ms(context.result.delay_upper_s());
    let quantile = context.settings().quantile;
    let (with_numbers, rests_on) = match context.settings().delay_upper_s {
        Some(_) => (
            vec![format!("UB = {} ms", five_digits(value))],
            vec!["set by hand".to_owned()],
        ),
        None => {
            let pool = pooled(context, |pair| context.mismatch(pair));
            let pool: Vec<f64> = pool
                .into_iter()
                .flat_map(|mismatch| delays_ms(mismatch, context.omega()))
                .collect();
            let percent = number((1e6 * (1.0 - quantile)).round() / 1e4);
            let step = format!(
                "UB = max(0, {percent} % quantile of {}) = {} ms",
                spread(&pool),
                five_digits(value)
            );
            (vec![step], pool_rests_on(context))
        }
    };
    Derivation {
        title: context.title("upper bound of the delays"),
        equation: "UB = max(0, (1 − q)-quantile of Δφ/ω)".to_owned(),
        with_numbers,
        rests_on,
        section: "M7",
        value,
    }
}

/// Describes the error bar of a figure with its parts, and the figure after every substitution;
/// empty where it has no error bar, or where that was not computed.
pub(super) fn sure(analysis: &Analysis, target: &ExplainTarget) -> Vec<String> {
    let Some((condition, scalar)) = scalar_of(analysis, target) else {
        return Vec::new();
    };
    let Some(uncertainty) = &analysis.uncertainty else {
        return Vec::new();
    };
    let Some(of) = uncertainty.conditions.get(&condition) else {
        return Vec::new();
    };
    let Some(bar) = &of.bars[scalar] else {
        return Vec::new();
    };
    let mut lines = bar_lines(bar, scalar, uncertainty.level);
    let result = analysis
        .condition(condition)
        .filter(|result| !takes_reported_error(result, scalar));
    if result.is_some_and(|result| reports_error(analysis, result)) {
        lines.push(SPREAD_ALONE.to_owned());
    }
    lines.extend(substitution_lines(
        analysis,
        condition,
        &of.substitutions,
        scalar,
    ));
    lines
}

/// For a net gain that is not constrained and for a channel, where the identified models report an
/// error of their own.
const SPREAD_ALONE: &str = "its identification part is the spread of the models alone, too small where they share their records: the error \
     that a model tells of itself counts for G, D and the net gains that are held (M13.2)";

/// Returns the condition and the scalar with the requested error bar.
fn scalar_of(analysis: &Analysis, target: &ExplainTarget) -> Option<(ConditionId, Scalar)> {
    Some(match target {
        ExplainTarget::DeltaGain(id, pair) => (*id, Scalar::Gain(*pair)),
        ExplainTarget::DeltaDelay(id, pair) => (*id, analysis.condition(*id)?.wanted_delay(*pair)),
        ExplainTarget::NetGain(id, pair) => (*id, Scalar::NetGain(*pair)),
        ExplainTarget::Gain(id, channel) => (*id, Scalar::ChannelGain(*channel)),
        ExplainTarget::Delay(id, channel) => (*id, Scalar::ChannelDelay(*channel)),
        _ => return None,
    })
}

fn bar_lines(bar: &Bar, scalar: Scalar, level: f64) -> Vec<String> {
    let told = |deviation: f64| {
        if scalar.is_delay() {
            format!("{:.2} ms", s_to_ms(deviation))
        } else {
            format!("{:.2} %", 100.0 * deviation)
        }
    };
    let part = |name: &str, part: Option<VarianceComponent>| match part {
        Some(part) => {
            format!(
                "{name}: {} ({:.1} degrees of freedom)",
                told(part.variance.sqrt()),
                part.degrees_of_freedom
            )
        }
        None => format!("{name}: not included"),
    };
    let whole = match (bar.half_width(level), bar.degrees_of_freedom()) {
        (Some(half), Some(degrees)) => {
            format!(
                "bar of {:.0} %: ± {} = t({degrees:.1}) · {} (M13)",
                100.0 * level,
                told(half),
                told(bar.deviation())
            )
        }
        _ => "no bar (M13)".to_owned(),
    };
    let mut lines = vec![
        whole,
        part("trim", bar.trim),
        part("identification", bar.identification),
    ];
    lines.extend(bar.remarks().into_iter().map(str::to_owned));
    if bar.left_out > 0 {
        lines.push(format!(
            "{} substitutions have no such figure",
            bar.left_out
        ));
    }
    lines
}

/// Lists the figure with each other model instead of the representative.
fn substitution_lines(
    analysis: &Analysis,
    condition: ConditionId,
    substitutions: &ConditionSubstitutions,
    scalar: Scalar,
) -> Vec<String> {
    let Some(result) = analysis.condition(condition) else {
        return Vec::new();
    };
    substitutions
        .substitutions
        .iter()
        .map(|swap| swap_words(result, swap, scalar))
        .collect()
}

/// Describes a figure after one swap: "with physics model roll+5: 1.0423".
fn swap_words(result: &ConditionAnalysis, swap: &ModelSwap, scalar: Scalar) -> String {
    let kind = swap.bundle;
    let name = &result.condition.bundle(kind)[swap.model].name;
    let figure = swap.figures.as_ref().and_then(|figures| figures[scalar]);
    let words = match figure {
        Some(figure) if scalar.is_delay() => format!("{:.2} ms", s_to_ms(figure)),
        Some(figure) => format!("{:.4}", figure.exp()),
        None => "none".to_owned(),
    };
    format!("with {kind} model {name}: {words}")
}

pub(super) fn scheduled_gain(
    analysis: &Analysis,
    channel: Channel,
    airspeed_kt: f64,
) -> Option<Derivation> {
    let schedule = analysis.schedule.as_ref().ok()?;
    let regression = schedule.gains.get(channel)?;
    let value = schedule.at(airspeed_kt).gain(channel);
    let name = format!("k_{}", channel.name_in(&analysis.study.dataset));
    let symbol = match schedule.settings.quantity {
        ScheduledQuantity::LnGain => format!("ln {name}"),
        ScheduledQuantity::Gain => name.clone(),
    };
    let ids: Vec<String> = analysis
        .scheduled()
        .iter()
        .map(ToString::to_string)
        .collect();
    let mut with_numbers = fit_steps(schedule, regression, &symbol, airspeed_kt);
    if schedule.settings.quantity == ScheduledQuantity::LnGain {
        with_numbers.push(format!(
            "{name} = e^({}) = {}",
            five_digits(value.ln()),
            five_digits(value)
        ));
    }
    Some(Derivation {
        title: format!("scheduled {name} at {} kt", number(airspeed_kt)),
        equation: equation(regression, &symbol),
        with_numbers,
        rests_on: [
            format!("the optima of the conditions {}", ids.join(", ")),
            format!(
                "airspeeds {} to {} kt",
                number(schedule.airspeeds.min_kt),
                number(schedule.airspeeds.max_kt)
            ),
        ]
        .into_iter()
        .chain(schedule.second.as_ref().map(|term| {
            let middle = number(term.middle());
            let unit = term.variable.unit();
            format!(
                "with {}, here in the middle of its range, {middle} {unit}",
                term.variable
            )
        }))
        .collect(),
        section: "M11",
        value,
    })
}

fn equation(regression: &Regression, symbol: &str) -> String {
    match regression {
        Regression::Polynomial { .. } => {
            format!(
                "{symbol} = c₀ + c₁ v + c₂ v² + …, by least squares; v = (V − mean V) / (half the range of V)"
            )
        }
        Regression::Table { .. } => {
            format!("{symbol} linear between the means of each cluster of airspeeds")
        }
    }
}

fn fit_steps(
    schedule: &Schedule,
    regression: &Regression,
    symbol: &str,
    airspeed_kt: f64,
) -> Vec<String> {
    const POWERS: [&str; 4] = ["", " v", " v²", " v³"];
    let airspeeds = &schedule.airspeeds;
    let fitted = five_digits(regression.at(airspeeds, airspeed_kt));
    match regression {
        Regression::Polynomial { coefficients } => {
            let v = airspeeds.scaled(airspeed_kt);
            let terms = coefficients
                .iter()
                .zip(POWERS)
                .map(|(coefficient, power)| format!("{}{power}", five_digits(*coefficient)));
            let inside = airspeed_kt.clamp(airspeeds.min_kt, airspeeds.max_kt);
            let mean_kt = five_digits(airspeeds.mean_kt);
            let half_kt = five_digits(airspeeds.half_range_kt);
            vec![
                format!(
                    "v = ({} − {mean_kt}) / {half_kt} = {}",
                    number(inside),
                    five_digits(v)
                ),
                format!(
                    "{symbol} = {} = {fitted}",
                    terms.collect::<Vec<_>>().join(" + ").replace("+ −", "− ")
                ),
            ]
        }
        Regression::Table {
            airspeeds_kt,
            values,
        } => {
            let after = airspeeds_kt
                .partition_point(|&at| at < airspeed_kt)
                .min(values.len() - 1);
            let point = |at: usize| {
                format!(
                    "{} at {} kt",
                    five_digits(values[at]),
                    five_digits(airspeeds_kt[at])
                )
            };
            let between = if after == 0 {
                point(0)
            } else {
                format!("{} and {}", point(after - 1), point(after))
            };
            vec![format!("{symbol} between {between} = {fitted}")]
        }
    }
}
