//! Derives a channel's scheduled gain (M11).
//!
//! A schedule is fitted to the gains that are optimal in the conditions, `k` or `ln k`: a
//! polynomial in the scaled airspeed `v`, or a table of means over clusters of equal airspeeds.

use gdcm_method::correction::Channel;
use gdcm_method::schedule::{Regression, Schedule, ScheduledQuantity};
use gdcm_model::number_format::five_digits;
use gdcm_model::units::number;
use gdcm_study::Analysis;

use super::Derivation;

/// Powers of the scaled airspeed in a polynomial, up to a schedule's maximum degree.
const POWERS: [&str; 4] = ["", " v", " v²", " v³"];

/// Derives a channel's scheduled gain at an airspeed \[kt\].
pub(super) fn scheduled_gain(
    analysis: &Analysis,
    channel: Channel,
    airspeed_kt: f64,
) -> Option<Derivation> {
    let schedule = analysis.schedule.as_ref().ok()?;
    let regression = schedule.gains.get(channel)?;
    let value = schedule.at(airspeed_kt).gain(channel);
    let name = format!("k_{}", channel.name_in(&analysis.study.dataset));
    let is_logarithm = schedule.settings.quantity == ScheduledQuantity::LnGain;
    let symbol = if is_logarithm {
        format!("ln {name}")
    } else {
        name.clone()
    };
    let mut with_numbers = fit_steps(schedule, regression, &symbol, airspeed_kt);
    if is_logarithm {
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
        rests_on: rests_on(analysis, schedule),
        section: "M11",
        value,
    })
}

fn rests_on(analysis: &Analysis, schedule: &Schedule) -> Vec<String> {
    let ids: Vec<String> = analysis
        .scheduled()
        .iter()
        .map(ToString::to_string)
        .collect();
    let optima = match ids.as_slice() {
        [only] => format!("the optimum of condition {only}"),
        ids => format!("the optima of conditions {}", ids.join(", ")),
    };
    let mut rests_on = vec![
        optima,
        format!(
            "airspeeds {} to {} kt",
            number(schedule.airspeeds.min_kt),
            number(schedule.airspeeds.max_kt)
        ),
    ];
    if let Some(term) = &schedule.second {
        rests_on.push(format!(
            "with {}, here in the middle of its range, {} {}",
            term.variable,
            number(term.middle()),
            term.variable.unit()
        ));
    }
    rests_on
}

fn equation(regression: &Regression, symbol: &str) -> String {
    match regression {
        Regression::Polynomial { .. } => {
            format!(
                "{symbol} = c₀ + c₁ v + c₂ v² + …, by least squares; v = (V − mean V) / (half the \
                 range of V)"
            )
        }
        Regression::Table { .. } => {
            format!("{symbol} is interpolated linearly between the means of the airspeed clusters")
        }
    }
}

/// Writes the scheduled quantity with numbers, step by step.
fn fit_steps(
    schedule: &Schedule,
    regression: &Regression,
    symbol: &str,
    airspeed_kt: f64,
) -> Vec<String> {
    let fitted = five_digits(regression.at(&schedule.airspeeds, airspeed_kt));
    match regression {
        Regression::Polynomial { coefficients } => {
            let terms: Vec<String> = coefficients
                .iter()
                .zip(POWERS)
                .map(|(coefficient, power)| format!("{}{power}", five_digits(*coefficient)))
                .collect();
            vec![
                scaled_airspeed_words(schedule, airspeed_kt),
                format!(
                    "{symbol} = {} = {fitted}",
                    terms.join(" + ").replace("+ −", "− ")
                ),
            ]
        }
        Regression::Table {
            airspeeds_kt,
            values,
        } => {
            let origin = table_origin_words(airspeeds_kt, values, airspeed_kt);
            vec![format!("{symbol} = {fitted}, {origin}")]
        }
    }
}

/// Writes the scaled airspeed: "v = (60 − 45.000) / 40.000 = 0.37500".
fn scaled_airspeed_words(schedule: &Schedule, airspeed_kt: f64) -> String {
    let airspeeds = &schedule.airspeeds;
    let inside_kt = airspeed_kt.clamp(airspeeds.min_kt, airspeeds.max_kt);
    format!(
        "v = ({} − {}) / {} = {}",
        number(inside_kt),
        five_digits(airspeeds.mean_kt),
        five_digits(airspeeds.half_range_kt),
        five_digits(airspeeds.scaled(airspeed_kt))
    )
}

/// Describes how a value follows from the table: interpolated between the points below and above the
/// airspeed, or taken from the first or last point, at its airspeed and beyond.
fn table_origin_words(airspeeds_kt: &[f64], values: &[f64], airspeed_kt: f64) -> String {
    let point = |at: usize| {
        format!(
            "{} at {} kt",
            five_digits(values[at]),
            five_digits(airspeeds_kt[at])
        )
    };
    let after = airspeeds_kt.partition_point(|&at| at < airspeed_kt);
    let last = values.len() - 1;
    if after == 0 {
        format!("the first value of the table, {}", point(0))
    } else if after > last {
        format!("the last value of the table, {}", point(last))
    } else {
        format!(
            "interpolated between {} and {}",
            point(after - 1),
            point(after)
        )
    }
}
