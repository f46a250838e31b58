//! Everything that an analysis found, as one struct of MATLAB.

use super::fields::{Fields, cell_of_texts, column, matrix, records, scalar, text, truth};
use crate::corrections_file::{
    Assessment, BarEntry, ByName, Channels, ConditionAssessment, ConditionCorrections, Corrections, CostTable,
    LeadChannels, LeadEntry, ScheduleUsed, Table, WithoutResult,
};
use crate::variables::{ElementKind, Value, Variable};
use gdcm_core::dataset::{Channel, Dataset};
use gdcm_core::study::{ResponseNames, Settings};

/// The variable `corrections`, with the fields of `corrections.json`. Figures of channels are columns in the order of its `inputs` and
/// `outputs`; matrices have a row for each output and a column for each input, NaN where they are undefined.
pub(super) fn corrections_variable(corrections: &Corrections, dataset: &Dataset) -> Variable {
    let mut fields = Fields::default();
    fields.add("format", text(&corrections.format));
    fields.add("version", scalar(corrections.version as f64));
    fields.add("software", text(&corrections.software));
    let mut label = Fields::default();
    label.add("name", text(&corrections.dataset.name));
    label.add("sha256", text(&corrections.dataset.sha256));
    fields.add("dataset", label.record());
    for (side, channels) in [("input", dataset.inputs()), ("output", dataset.outputs())] {
        let of = |part: fn(&Channel) -> &String| cell_of_texts(channels.iter().map(|channel| part(channel).clone()));
        fields.add(&format!("{side}s"), of(|channel| &channel.name));
        fields.add(&format!("{side}_units"), of(|channel| &channel.unit));
    }
    fields.add("settings", settings(&corrections.settings, dataset));
    fields.add("conditions", records(corrections.conditions.iter().map(|of| condition(of, dataset)).collect()));
    fields.add("failed", without_result(&corrections.failed));
    let schedule = corrections.schedule.as_ref().map(schedule);
    fields.add("schedule", schedule.unwrap_or_else(|| matrix(0, 0, Vec::new())));
    fields.add("assessment", assessment(&corrections.assessment));
    Variable { name: "corrections".to_owned(), value: fields.record() }
}

fn settings(settings: &Settings<ResponseNames>, dataset: &Dataset) -> Value {
    let mut fields = Fields::default();
    fields.add("band_rad_s", row(vec![settings.band.min(), settings.band.max()]));
    fields.add("points", scalar(settings.points as f64));
    fields.add("alpha_gain", scalar(settings.alpha_gain));
    fields.add("alpha_delay", scalar(settings.alpha_delay));
    fields.add("quantile", scalar(settings.quantile));
    fields.add("constrained", marked(&settings.constrained.0, dataset));
    fields.add("ignored", marked(&settings.ignored.0, dataset));
    let json = serde_json::to_value(settings).unwrap_or_default();
    for key in ["cost_average", "gain_objective", "phase", "delay_from"] {
        fields.add(key, text(json[key].as_str().unwrap_or_default()));
    }
    fields.add("coherence_threshold", scalar(settings.coherence_threshold));
    fields.add(
        "gain_bounds",
        row(settings.gain_bounds.map_or(vec![f64::NAN; 2], |bounds| vec![bounds.lower, bounds.upper])),
    );
    fields.add("delay_upper_s", scalar(settings.delay_upper_s));
    fields.add("agreement_db", scalar(settings.agreement_db));
    fields.record()
}

fn condition(of: &ConditionCorrections, dataset: &Dataset) -> Fields {
    let mut fields = Fields::default();
    fields.add("id", scalar(of.id as f64));
    fields.add("name", text(&of.name));
    fields.add("airspeed_kt", scalar(of.airspeed_kt));
    fields.add("physics_representative", text(&of.physics_representative));
    fields.add("identified_representative", text(&of.identified_representative));
    fields.add("rejected", cell_of_texts(of.rejected.iter().cloned()));
    fields.add("suggested_outliers", cell_of_texts(of.suggested_outliers.iter().cloned()));
    fields.add("scheduled", truth(of.scheduled));
    fields.add("held", marked(&of.held, dataset));
    fields.add("G", table(&of.delta_gain));
    fields.add("D_s", table(&of.delta_delay_s));
    fields.add("D_band_s", table(&of.band_delay_s));
    fields.add("gain_bounds", row(of.gain_bounds.to_vec()));
    fields.add("delay_upper_s", scalar(of.delay_upper_s));
    fields.add("gains", channels(&of.gains));
    fields.add("delays_s", channels(&of.delays_s));
    if let Some(lead) = &of.lead {
        fields.add("lead", leads(lead));
    }
    fields.add("gain_objective", scalar(of.gain_solution.objective));
    fields.add("gain_lower_bound", scalar(of.gain_solution.lower_bound));
    fields.add("gain_proven", truth(of.gain_solution.proven));
    fields.add("gain_matched", truth(of.gain_solution.matched));
    fields.add("delay_objective_s2", scalar(of.delay_solution.objective));
    fields.add("delay_matched", truth(of.delay_solution.matched));
    let net = |output: &str, input: &str| {
        let found = of.net_gains.iter().find(|net| net.output == output && net.input == input);
        found.map_or(f64::NAN, |net| net.gain)
    };
    fields.add("net_gains", of_pairs(dataset, net));
    // The bars of those: both ends as factors, both parts as standard deviations of the logarithm.
    let bar = |part: fn(&BarEntry) -> Option<f64>| {
        of_pairs(dataset, |output, input| {
            let found = of.net_gains.iter().find(|net| net.output == output && net.input == input);
            found.and_then(|net| part(&net.bar)).unwrap_or(f64::NAN)
        })
    };
    fields.add("net_gains_low", bar(|bar| bar.interval.map(|[low, _]| low)));
    fields.add("net_gains_high", bar(|bar| bar.interval.map(|[_, high]| high)));
    fields.add("u_physics", bar(|bar| bar.u_physics));
    fields.add("u_identification", bar(|bar| bar.u_identification));
    fields.add("held_out", truth(of.held_out));
    let mut cost = Fields::default();
    cost.add("uncorrected", cost_table(&of.cost.uncorrected));
    cost.add("corrected", cost_table(&of.cost.corrected));
    fields.add("J", cost.record());
    fields.add("cautions", cell_of_texts(of.cautions.iter().cloned()));
    fields
}

fn schedule(of: &ScheduleUsed) -> Value {
    let mut fields = Fields::default();
    fields.add("kind", text(&of.kind));
    fields.add("of", text(&of.of));
    fields.add("degree", scalar(of.degree.map(|degree| degree as f64)));
    fields.add("airspeed_mean_kt", scalar(of.airspeed_mean_kt));
    fields.add("airspeed_half_range_kt", scalar(of.airspeed_half_range_kt));
    fields.add("airspeed_range_kt", row(of.airspeed_range_kt.to_vec()));
    fields.add("inputs", rows(of.inputs.0.iter().map(|(_, figures)| figures.clone())));
    fields.add("outputs", rows(of.outputs.0.iter().map(|(_, figures)| figures.clone())));
    if let Some(delays) = &of.delays_s {
        let mut of_delays = Fields::default();
        of_delays.add("inputs", rows(delays.inputs.0.iter().map(|(_, figures)| figures.clone())));
        of_delays.add("outputs", rows(delays.outputs.0.iter().map(|(_, figures)| figures.clone())));
        of_delays.add("upper_s", column(delays.upper_s.iter().flatten().copied()));
        fields.add("delays_s", of_delays.record());
    }
    if let Some(tau_s) = &of.tau_s {
        let mut of_taus = Fields::default();
        of_taus.add("inputs", rows(tau_s.inputs.0.iter().map(|(_, figures)| figures.clone())));
        of_taus.add("outputs", rows(tau_s.outputs.0.iter().map(|(_, figures)| figures.clone())));
        of_taus.add("bounds_s", row(tau_s.bounds_s.to_vec()));
        fields.add("tau_s", of_taus.record());
    }
    let mut table = Fields::default();
    table.add("airspeed_kt", column(of.table.iter().map(|row| row.airspeed_kt)));
    let figures = |of: &ByName<f64>| of.0.iter().map(|(_, figure)| *figure).collect::<Vec<_>>();
    table.add("inputs", rows(of.table.iter().map(|row| figures(&row.inputs))));
    table.add("outputs", rows(of.table.iter().map(|row| figures(&row.outputs))));
    if of.delays_s.is_some() {
        let delays = || of.table.iter().filter_map(|row| row.delays_s.as_ref());
        table.add("input_delays_s", rows(delays().map(|row| figures(&row.inputs))));
        table.add("output_delays_s", rows(delays().map(|row| figures(&row.outputs))));
    }
    fields.add("table", table.record());
    fields.add("cautions", cell_of_texts(of.cautions.iter().cloned()));
    fields.record()
}

fn assessment(of: &Assessment) -> Value {
    let condition = |of: &ConditionAssessment| {
        let mut fields = Fields::default();
        fields.add("id", scalar(of.id as f64));
        fields.add("model", text(&of.model));
        fields.add("dJ", table(&of.total));
        fields.add("dJ_mag", table(&of.magnitude));
        fields.add("dJ_phase", table(&of.phase));
        fields
    };
    let mut fields = Fields::default();
    fields.add("conditions", records(of.conditions.iter().map(condition).collect()));
    fields.add("left_out", without_result(&of.left_out));
    fields.record()
}

fn without_result(of: &[WithoutResult]) -> Value {
    let record = |of: &WithoutResult| {
        let mut fields = Fields::default();
        fields.add("id", scalar(of.id as f64));
        fields.add("why", text(&of.why));
        fields
    };
    records(of.iter().map(record).collect())
}

fn cost_table(of: &CostTable) -> Value {
    let mut fields = Fields::default();
    fields.add("mag", table(&of.mag));
    fields.add("phase", table(&of.phase));
    fields.record()
}

fn channels(of: &Channels) -> Value {
    let mut fields = Fields::default();
    fields.add("inputs", column(of.inputs.0.iter().map(|(_, figure)| *figure)));
    fields.add("outputs", column(of.outputs.0.iter().map(|(_, figure)| *figure)));
    fields.record()
}

/// A column of each figure of the channels' leads, NaN where there is no filter.
fn leads(of: &LeadChannels) -> Value {
    let side = |entries: &ByName<LeadEntry>| {
        let all = |figure: fn(&LeadEntry) -> Option<f64>| {
            column(entries.0.iter().map(move |(_, entry)| figure(entry).unwrap_or(f64::NAN)))
        };
        let mut fields = Fields::default();
        fields.add("tau_s", all(|entry| Some(entry.tau_s)));
        fields.add("lead_s", all(|entry| entry.lead_s));
        fields.add("zero_rad_s", all(|entry| entry.zero_rad_s));
        fields.add("lag_rad_s", all(|entry| entry.lag_rad_s));
        fields.add("gain_at_infinity_db", all(|entry| entry.gain_at_infinity_db));
        fields.record()
    };
    let mut fields = Fields::default();
    fields.add("inputs", side(&of.inputs));
    fields.add("outputs", side(&of.outputs));
    fields.record()
}

fn row(values: Vec<f64>) -> Value {
    matrix(1, values.len(), values)
}

fn table(of: &Table) -> Value {
    rows(of.iter().map(|row| row.iter().map(|entry| entry.unwrap_or(f64::NAN)).collect()))
}

/// A matrix of rows of the same length.
fn rows(rows: impl Iterator<Item = Vec<f64>>) -> Value {
    let rows: Vec<Vec<f64>> = rows.collect();
    let columns = rows.first().map_or(0, Vec::len);
    let values = (0..columns).flat_map(|column| rows.iter().filter_map(move |row| row.get(column).copied())).collect();
    matrix(rows.len(), columns, values)
}

/// Which responses a list names, `[output, input]`: a matrix of truths.
fn marked(pairs: &[(String, String)], dataset: &Dataset) -> Value {
    let is_named =
        |output: &str, input: &str| pairs.iter().any(|pair| (pair.0.as_str(), pair.1.as_str()) == (output, input));
    let mut value = of_pairs(dataset, |output, input| f64::from(u8::from(is_named(output, input))));
    if let Value::Array(array) = &mut value {
        array.kind = ElementKind::Logical;
    }
    value
}

/// A figure for each response, by the names of its output and input.
fn of_pairs(dataset: &Dataset, figure: impl Fn(&str, &str) -> f64) -> Value {
    let (outputs, inputs) = (dataset.outputs(), dataset.inputs());
    let values = inputs.iter().flat_map(|input| outputs.iter().map(|output| figure(&output.name, &input.name)));
    matrix(outputs.len(), inputs.len(), values.collect())
}
