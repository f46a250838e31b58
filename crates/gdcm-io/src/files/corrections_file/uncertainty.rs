//! The text of `corrections.json` about the uncertainty of the results (M13).

use serde_json::{Value, json};

use gdcm_method::correction::Channel;
use gdcm_method::uncertainty::{Bar, Scalar, VarianceDecomposition};
use gdcm_model::dataset::{ConditionId, Pair};
use gdcm_study::Analysis;
use gdcm_study::results::uncertainty::{
    AirspeedDifference, PairScatter, SecondVariableTest, Uncertainty,
};
use gdcm_words::uncertainty::{difference_text, second_variable_text};

use super::corrections::{ChannelNames, rows_of, says_nothing, without_empty};

/// Returns a confidence interval, with the remaining error in the band after one gain. For a gain
/// the intervals are factors and the standard deviations those of its natural logarithm; for a
/// delay both are in seconds.
fn bar(scalar: Scalar, bar: &Bar, level: f64, left_in_band: Option<f64>) -> Value {
    let told = |interval: Option<[f64; 2]>| {
        interval.map(|ends| ends.map(|end| if scalar.is_delay() { end } else { end.exp() }))
    };
    let members = [
        ("interval", json!(told(bar.interval(level)))),
        (
            "interval_identification",
            json!(told(bar.inner_interval(level))),
        ),
        (
            "u_physics",
            json!(bar.trim.map(|part| part.variance.sqrt())),
        ),
        (
            "u_identification",
            json!(bar.identification.map(|part| part.variance.sqrt())),
        ),
        ("degrees_of_freedom", json!(bar.degrees_of_freedom())),
        ("left_in_band", json!(left_in_band)),
        ("remarks", json!(bar.remarks())),
    ];
    members
        .into_iter()
        .filter(|(_, value)| !says_nothing(value))
        .collect()
}

/// Returns the interval of a net gain.
pub(super) fn net_gain_bar(
    analysis: &Analysis,
    condition: ConditionId,
    pair: Pair,
) -> Option<Value> {
    let uncertainty = analysis.uncertainty.as_ref()?;
    let of = uncertainty.bar(condition, Scalar::NetGain(pair))?;
    let left_in_band = uncertainty.conditions.get(&condition)?.left_in_band[pair];
    Some(bar(
        Scalar::NetGain(pair),
        of,
        uncertainty.level,
        left_in_band,
    ))
}

/// Returns the intervals of the other quantities of a condition.
pub(super) fn bars(names: &ChannelNames, condition: ConditionId) -> Option<Value> {
    let uncertainty = names.analysis.uncertainty.as_ref()?;
    let of = uncertainty.conditions.get(&condition)?;
    let entry = |scalar| {
        of.bars[scalar].as_ref().map_or(Value::Null, |found| {
            bar(scalar, found, uncertainty.level, None)
        })
    };
    let table = |scalar: fn(Pair) -> Scalar| {
        rows_of(names.outputs.len(), names.inputs.len(), |pair| {
            entry(scalar(pair))
        })
    };
    let channels =
        |scalar: fn(Channel) -> Scalar| names.by_channel(|channel| entry(scalar(channel)));
    let asks_band_delays = names.analysis.condition(condition)?.asks_band_delays();
    let bars = json!({
        "G": table(Scalar::Gain),
        "D_s": table(Scalar::Delay),
        "D_band_s": asks_band_delays.then(|| table(Scalar::BandDelay)),
        "gains": channels(Scalar::ChannelGain),
        "delays_s": channels(Scalar::ChannelDelay),
    });
    Some(without_empty(bars, &["D_band_s"]))
}

/// Returns the consequences of the intervals of all conditions, if they are available.
pub(super) fn uncertainty(names: &ChannelNames) -> Option<Value> {
    let uncertainty = names.analysis.uncertainty.as_ref()?;
    let level = uncertainty.level;
    let differences = uncertainty
        .differences
        .iter()
        .map(|of| names.of_pair(of.pair, difference(of, level)));
    let scatter = uncertainty
        .scatter
        .iter()
        .map(|of| names.of_pair(of.pair, scatter(of, level)));
    let tests = uncertainty
        .second_variables
        .iter()
        .map(|of| names.of_pair(of.pair, second_variable(of)));
    Some(json!({
        "level": level,
        "differences": differences.collect::<Value>(),
        "scatter": scatter.collect::<Value>(),
        "schedule_band": bands(names, uncertainty),
        "second_variable": tests.collect::<Value>(),
    }))
}

fn difference(of: &AirspeedDifference, level: f64) -> Value {
    json!({
        "conditions": of.conditions.map(|id| id.0),
        "airspeed_kt": of.airspeed_kt,
        "delta": of.difference.delta,
        "u": of.difference.deviation,
        "degrees_of_freedom": of.difference.degrees_of_freedom,
        "ratio": of.difference.ratio(),
        "p": of.difference.p(),
        "p_holm": of.p_holm,
        "words": difference_text(of, level),
    })
}

/// Returns the contributions to the scatter of a net gain, as standard deviations of the natural
/// logarithm.
fn scatter(of: &PairScatter, level: f64) -> Value {
    let split = |split: &VarianceDecomposition| {
        json!({
            "degrees_of_freedom": split.freedom,
            "scatter": split.scatter.sqrt(),
            "physics": split.trim.sqrt(),
            "identification": split.identification.sqrt(),
            "rest": split.unexplained().sqrt(),
            "rest_interval": split.unexplained_interval(level),
            "shares": split.shares(),
            "ratio": split.ratio(),
            "p": split.p(),
        })
    };
    json!({
        "same_airspeed": of.same_airspeed.as_ref().map(split),
        "about_schedule": of.about_schedule.as_ref().map(split),
    })
}

/// Returns the scheduled net gains of responses that measure a model with their bands, as natural
/// logarithms.
fn bands(names: &ChannelNames, uncertainty: &Uncertainty) -> Value {
    let (Ok(schedule), Some(bands)) = (&names.analysis.schedule, &uncertainty.bands) else {
        return json!([]);
    };
    let airspeed_kt = schedule.airspeeds.clusters_kt();
    let entry = |pair: Pair| {
        let widths = airspeed_kt
            .iter()
            .map(|&airspeed| bands.at(schedule, Scalar::NetGain(pair), airspeed));
        let widths: Vec<_> = widths.collect::<Option<_>>()?;
        let fit = airspeed_kt
            .iter()
            .map(|&airspeed| schedule.at(airspeed).net_gain(pair).ln());
        let band = json!({
            "airspeed_kt": airspeed_kt,
            "fit": fit.collect::<Value>(),
            "confidence": widths.iter().map(|widths| widths.confidence).collect::<Value>(),
            "scatter": widths.iter().map(|widths| widths.scatter).collect::<Value>(),
        });
        Some(names.of_pair(pair, band))
    };
    names
        .analysis
        .study
        .dataset
        .measuring_pairs()
        .marked()
        .filter_map(entry)
        .collect()
}

/// Returns whether the schedule of a net gain needs a second variable.
fn second_variable(of: &SecondVariableTest) -> Value {
    let effect = of.effect.as_ref().ok();
    json!({
        "variable": of.variable.name(),
        "effect": effect.map(|effect| effect.effect),
        "visible": effect.map(|effect| effect.visible),
        "p": effect.map(|effect| effect.p),
        "p_holm": of.p_holm,
        "left_out_without": effect.and_then(|effect| effect.left_out_without),
        "left_out_with": effect.and_then(|effect| effect.left_out_with),
        "needed": of.needed,
        "words": second_variable_text(of),
    })
}
