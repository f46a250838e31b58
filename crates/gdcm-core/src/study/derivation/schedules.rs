//! How a scheduled gain was computed (M11).

use crate::correction::Channel;
use crate::schedule::{Regression, Schedule, ScheduledQuantity};
use crate::study::analysis::Analysis;
use crate::units::number;

use super::Derivation;
use super::context::digits;

pub(super) fn gain(analysis: &Analysis, channel: Channel, airspeed_kt: f64) -> Option<Derivation> {
    let schedule = analysis.schedule.as_ref().ok()?;
    let at = schedule.at(airspeed_kt);
    let (regression, value) = match channel {
        Channel::Input(input) => (schedule.inputs.get(input)?, at.input_gains[input]),
        Channel::Output(output) => (schedule.outputs.get(output)?, at.output_gains[output]),
    };
    let (inputs, outputs) = analysis.study.dataset.names_of_channels();
    let name = format!("k_{}", channel.name(&inputs, &outputs));
    let symbol = match schedule.settings.quantity {
        ScheduledQuantity::LnGain => format!("ln {name}"),
        ScheduledQuantity::Gain => name.clone(),
    };
    let ids: Vec<String> = analysis.scheduled().iter().map(ToString::to_string).collect();
    let mut with_numbers = fit_steps(schedule, regression, &symbol, airspeed_kt);
    if schedule.settings.quantity == ScheduledQuantity::LnGain {
        with_numbers.push(format!("{name} = e^({}) = {}", digits(value.ln()), digits(value)));
    }
    Some(Derivation {
        title: format!("scheduled {name} at {} kt", number(airspeed_kt)),
        equation: equation(regression, &symbol),
        with_numbers,
        rests_on: [
            format!("the optima of the conditions {}", ids.join(", ")),
            format!("airspeeds {} to {} kt", number(schedule.airspeeds.min_kt), number(schedule.airspeeds.max_kt)),
        ]
        .into_iter()
        .chain(schedule.second.as_ref().map(|term| {
            let (middle, unit) = (number(term.middle()), term.variable.unit());
            format!("with {}, here in the middle of its range, {middle} {unit}", term.variable)
        }))
        .collect(),
        section: "M11",
        value,
    })
}

fn equation(regression: &Regression, symbol: &str) -> String {
    match regression {
        Regression::Polynomial { .. } => {
            format!("{symbol} = c₀ + c₁ v + c₂ v² + …, by least squares; v = (V − mean V) / (half the range of V)")
        }
        Regression::Table { .. } => format!("{symbol} linear between the means of each cluster of airspeeds"),
    }
}

fn fit_steps(schedule: &Schedule, regression: &Regression, symbol: &str, airspeed_kt: f64) -> Vec<String> {
    const POWERS: [&str; 4] = ["", " v", " v²", " v³"];
    let airspeeds = &schedule.airspeeds;
    let fitted = digits(regression.at(airspeeds, airspeed_kt));
    match regression {
        Regression::Polynomial { coefficients } => {
            let v = airspeeds.scaled(airspeed_kt);
            let terms =
                coefficients.iter().zip(POWERS).map(|(coefficient, power)| format!("{}{power}", digits(*coefficient)));
            let inside = airspeed_kt.clamp(airspeeds.min_kt, airspeeds.max_kt);
            let (mean_kt, half_kt) = (digits(airspeeds.mean_kt), digits(airspeeds.half_range_kt));
            vec![
                format!("v = ({} − {mean_kt}) / {half_kt} = {}", number(inside), digits(v)),
                format!("{symbol} = {} = {fitted}", terms.collect::<Vec<_>>().join(" + ").replace("+ −", "− ")),
            ]
        }
        Regression::Table { airspeeds_kt, values } => {
            let after = airspeeds_kt.partition_point(|&at| at < airspeed_kt).min(values.len() - 1);
            let point = |at: usize| format!("{} at {} kt", digits(values[at]), digits(airspeeds_kt[at]));
            let between = if after == 0 { point(0) } else { format!("{} and {}", point(after - 1), point(after)) };
            vec![format!("{symbol} between {between} = {fitted}")]
        }
    }
}
