//! The part of `corrections.json` about uncertainty in the results (M13).
//!
//! A *bar* is a scalar result, such as a net gain, with its uncertainty; its standard deviations
//! `u_physics` and `u_identification` are due to the unknown trim and to the identified models, and
//! the inner interval has only the latter. `p_holm` is a probability after Holm's correction for
//! several tests. *Scatter* is the variance of net gains between conditions, split into the part
//! that the bars let expect and the rest; a *schedule band* lies about the schedule, over airspeed,
//! whereas `left_in_band` and the band delay `D_band_s` refer to the frequency band. The *second
//! variable* is altitude or mass.

use serde_json::{Map, Value, json};

use gdcm_method::correction::Channel;
use gdcm_method::schedule::Schedule;
use gdcm_method::uncertainty::scalar::ScalarTable;
use gdcm_method::uncertainty::{Bar, Scalar, VarianceDecomposition};
use gdcm_model::dataset::{ConditionId, Pair};
use gdcm_study::Analysis;
use gdcm_study::results::uncertainty::{
    AirspeedDifference, PairScatter, ScheduleBands, SecondVariableTest, Uncertainty,
};
use gdcm_words::uncertainty::{bar_remark_texts, difference_text, second_variable_text};

use super::labelled_analysis::LabelledAnalysis;
use super::pair_rows::rows_of;
use crate::json_empty_members::{is_empty_value, without_empty};

/// Returns a net gain's confidence interval; `None` if it was not computed.
pub(super) fn net_gain_bar(
    analysis: &Analysis,
    condition: ConditionId,
    pair: Pair,
) -> Option<Value> {
    let uncertainty = analysis.uncertainty.as_ref()?;
    let scalar = Scalar::NetGain(pair);
    let bar = uncertainty.bar(condition, scalar)?;
    let left_in_band = uncertainty.conditions.get(&condition)?.left_in_band[pair];
    Some(bar_json(scalar, bar, uncertainty.level, left_in_band))
}

/// Returns a condition's confidence intervals, except those for net gains; `None` if they were not
/// computed.
pub(super) fn bars(labelled: &LabelledAnalysis<'_>, condition: ConditionId) -> Option<Value> {
    let uncertainty = labelled.analysis.uncertainty.as_ref()?;
    let bars = ConditionBars {
        labelled,
        bars: &uncertainty.conditions.get(&condition)?.bars,
        level: uncertainty.level,
    };
    let band_delays = if labelled.analysis.condition(condition)?.fits_band_delays() {
        bars.by_response(Scalar::BandDelay)
    } else {
        Value::Null
    };
    let members = json!({
        "G": bars.by_response(Scalar::Gain),
        "D_s": bars.by_response(Scalar::Delay),
        "D_band_s": band_delays,
        "gains": bars.by_channel(Scalar::ChannelGain),
        "delays_s": bars.by_channel(Scalar::ChannelDelay),
    });
    Some(without_empty(members, &["D_band_s"]))
}

/// A condition's error bars, from which its confidence intervals at a level are written.
struct ConditionBars<'a> {
    labelled: &'a LabelledAnalysis<'a>,
    bars: &'a ScalarTable<Option<Bar>>,
    level: f64,
}

impl ConditionBars<'_> {
    fn bar(&self, scalar: Scalar) -> Value {
        match &self.bars[scalar] {
            Some(bar) => bar_json(scalar, bar, self.level, None),
            None => Value::Null,
        }
    }

    fn by_response(&self, scalar: fn(Pair) -> Scalar) -> Value {
        let outputs = self.labelled.outputs.len();
        let inputs = self.labelled.inputs.len();
        rows_of(outputs, inputs, |pair| self.bar(scalar(pair)))
    }

    fn by_channel(&self, scalar: fn(Channel) -> Scalar) -> Value {
        self.labelled
            .by_channel(|channel| self.bar(scalar(channel)))
    }
}

/// Returns a confidence interval with its standard deviations and remarks, and `left_in_band`, the
/// mismatch over the band that remains because one gain cannot match every frequency. For a gain,
/// intervals are factors, and standard deviations and `left_in_band` refer to the natural
/// logarithm; for a delay, all are in seconds. Missing values are omitted.
fn bar_json(scalar: Scalar, bar: &Bar, level: f64, left_in_band: Option<f64>) -> Value {
    let interval = bar.interval(level).map(|ends| in_units(scalar, ends));
    let inner_interval = bar.inner_interval(level).map(|ends| in_units(scalar, ends));
    let mut members = Map::new();
    for (name, value) in [
        ("interval", json!(interval)),
        ("interval_identification", json!(inner_interval)),
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
        ("remarks", json!(bar_remark_texts(bar))),
    ] {
        if !is_empty_value(&value) {
            members.insert(name.to_owned(), value);
        }
    }
    Value::Object(members)
}

/// Returns an interval in the file's units: factors for gains, seconds for delays.
fn in_units(scalar: Scalar, ends: [f64; 2]) -> [f64; 2] {
    if scalar.is_delay() {
        ends
    } else {
        ends.map(f64::exp)
    }
}

/// Returns the conclusions from all conditions' confidence intervals; `None` without confidence
/// intervals.
pub(super) fn uncertainty(labelled: &LabelledAnalysis<'_>) -> Option<Value> {
    let uncertainty = labelled.analysis.uncertainty.as_ref()?;
    let level = uncertainty.level;
    let mut differences = Vec::new();
    for difference in &uncertainty.differences {
        let entries = difference_json(difference, level);
        differences.push(labelled.response_entries(difference.pair, entries));
    }
    let mut scatters = Vec::new();
    for scatter in &uncertainty.scatter {
        scatters.push(labelled.response_entries(scatter.pair, scatter_json(scatter, level)));
    }
    let mut second_variables = Vec::new();
    for test in &uncertainty.second_variables {
        second_variables.push(labelled.response_entries(test.pair, second_variable_json(test)));
    }
    Some(json!({
        "level": level,
        "differences": differences,
        "scatter": scatters,
        "schedule_band": schedule_bands(labelled, uncertainty),
        "second_variable": second_variables,
    }))
}

fn difference_json(difference: &AirspeedDifference, level: f64) -> Value {
    json!({
        "conditions": difference.conditions.map(|id| id.0),
        "airspeed_kt": difference.airspeed_kt,
        "delta": difference.difference.delta,
        "u": difference.difference.deviation,
        "degrees_of_freedom": difference.difference.degrees_of_freedom,
        "ratio": difference.difference.ratio(),
        "p": difference.difference.p(),
        "p_holm": difference.p_holm,
        "words": difference_text(difference, level),
    })
}

/// Returns the contributions to a net gain's scatter, at the same airspeed and about the schedule,
/// as standard deviations of the natural logarithm.
fn scatter_json(scatter: &PairScatter, level: f64) -> Value {
    let same_airspeed = scatter.same_airspeed.as_ref();
    let about_schedule = scatter.about_schedule.as_ref();
    json!({
        "same_airspeed": same_airspeed.map(|split| decomposition_json(split, level)),
        "about_schedule": about_schedule.map(|split| decomposition_json(split, level)),
    })
}

fn decomposition_json(split: &VarianceDecomposition, level: f64) -> Value {
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
}

/// Returns scheduled net gains for the on-axis responses (all responses if none is on-axis), with
/// confidence and scatter bands about the schedule, as natural logarithms.
fn schedule_bands(labelled: &LabelledAnalysis<'_>, uncertainty: &Uncertainty) -> Value {
    let (Ok(schedule), Some(bands)) = (&labelled.analysis.schedule, &uncertainty.bands) else {
        return json!([]);
    };
    let pairs = labelled.analysis.study.dataset.measuring_pairs();
    let mut list = Vec::new();
    for pair in pairs.marked() {
        if let Some(band) = schedule_band_json(schedule, bands, pair) {
            list.push(labelled.response_entries(pair, band));
        }
    }
    Value::Array(list)
}

/// Returns a net gain's schedule bands, as half-widths, at the distinct scheduled airspeeds; `None`
/// if any is missing.
fn schedule_band_json(schedule: &Schedule, bands: &ScheduleBands, pair: Pair) -> Option<Value> {
    let airspeeds_kt = schedule.airspeeds.clusters_kt();
    let mut fit = Vec::new();
    let mut confidence = Vec::new();
    let mut scatter = Vec::new();
    for &airspeed_kt in &airspeeds_kt {
        let widths = bands.at(schedule, Scalar::NetGain(pair), airspeed_kt)?;
        fit.push(schedule.at(airspeed_kt).net_gain(pair).ln());
        confidence.push(widths.confidence);
        scatter.push(widths.scatter);
    }
    Some(json!({
        "airspeed_kt": airspeeds_kt,
        "fit": fit,
        "confidence": confidence,
        "scatter": scatter,
    }))
}

/// Returns the result of the test for a second variable in a scheduled net gain.
fn second_variable_json(test: &SecondVariableTest) -> Value {
    let effect = test.effect.as_ref().ok();
    json!({
        "variable": test.variable.name(),
        "effect": effect.map(|effect| effect.effect),
        "visible": effect.map(|effect| effect.detectable),
        "p": effect.map(|effect| effect.p),
        "p_holm": test.p_holm,
        "left_out_without": effect.and_then(|effect| effect.left_out_without),
        "left_out_with": effect.and_then(|effect| effect.left_out_with),
        "needed": test.needed,
        "words": second_variable_text(test),
    })
}
