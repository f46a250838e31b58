//! From a dataset to what its file says.

use crate::json_text::Nested;
use gdcm_core::dataset::{
    BundleKind, Channel, Condition, ConditionRecord, Dataset, Dynamics, Estimate, MeasuredResponse, Model, ModelBands,
    Origin, PairTable, Provenance, Timing,
};

use super::schema::{
    BandText, BandsText, ChannelText, ConditionText, DatasetText, FORMAT, IdentifiedText, PhysicsText, RecordText,
    ResponseText, SourceText,
};

/// The text of a dataset, entry by entry.
pub(super) fn text_of(dataset: &Dataset) -> DatasetText {
    let on_axis = dataset
        .on_axis()
        .marked()
        .map(|pair| (dataset.outputs()[pair.output].name.clone(), dataset.inputs()[pair.input].name.clone()));
    DatasetText {
        format: FORMAT.name.to_owned(),
        version: FORMAT.version,
        name: dataset.name().to_owned(),
        description: written(dataset.description()),
        inputs: dataset.inputs().iter().map(channel_text).collect(),
        outputs: dataset.outputs().iter().map(channel_text).collect(),
        on_axis: Some(on_axis.collect()),
        frequency_band: BandText { min: dataset.band().min(), max: dataset.band().max(), unit: "rad/s".to_owned() },
        conditions: dataset.conditions().iter().map(|condition| condition_text(condition)).collect(),
    }
}

fn written(text: &str) -> Option<String> {
    (!text.is_empty()).then(|| text.to_owned())
}

fn channel_text(channel: &Channel) -> ChannelText {
    ChannelText { name: channel.name.clone(), unit: channel.unit.clone(), description: written(&channel.description) }
}

fn condition_text(condition: &Condition) -> ConditionText {
    let state = condition.flight_state().clone();
    ConditionText {
        id: state.id.0,
        name: state.name,
        airspeed_kt: state.airspeed_kt,
        altitude: state.altitude,
        altitude_ft: state.altitude_ft,
        weight: state.weight,
        mass_kg: state.mass_kg,
        physics_models: condition.bundle(BundleKind::Physics).iter().map(physics_text).collect(),
        identified_models: condition.bundle(BundleKind::Identified).iter().map(identified_text).collect(),
        records: entries(condition.records()).map(|records| records.iter().map(record_text).collect()),
    }
}

/// A list, where there is anything in it.
fn entries<T>(list: &[T]) -> Option<&[T]> {
    (!list.is_empty()).then_some(list)
}

/// A record, as files say it.
pub(crate) fn record_text(record: &ConditionRecord) -> RecordText {
    let ConditionRecord { name, file, variable, sha256, kind, held_out, used, sample_time_s, used_s } = record.clone();
    let (kind, used) = (Some(kind.word().to_owned()), Some(used));
    let used_s = entries(&used_s).map(<[_]>::to_vec);
    RecordText { name, file, variable, sha256, kind, held_out, used, sample_time_s, used_s }
}

fn physics_text(model: &Model) -> PhysicsText {
    let [a, b, c, d] = matrices(&model.dynamics);
    let Timing { sample_time_s, input_delays_s, output_delays_s } = timing(&model.dynamics);
    PhysicsText {
        name: model.name.clone(),
        role: if model.is_nominal() { "nominal" } else { "perturbed" }.to_owned(),
        perturbation: model.perturbation().cloned(),
        states: state_names(model),
        a,
        b,
        c,
        d,
        sample_time_s,
        input_delays_s,
        output_delays_s,
        frequency_response: None,
        source: model.source.as_ref().map(source_text),
    }
}

/// An identified model, as files say it.
pub(crate) fn identified_text(model: &Model) -> IdentifiedText {
    let (method, order) = match &model.origin {
        Origin::Identified { method, order } => (method.clone(), *order),
        Origin::Nominal { .. } | Origin::Perturbed { .. } => (None, None),
    };
    let [a, b, c, d] = matrices(&model.dynamics);
    let frequency_response = match &model.dynamics {
        Dynamics::StateSpace(_) => None,
        Dynamics::Measured(response) => Some(response_text(response)),
    };
    let Timing { sample_time_s, input_delays_s, output_delays_s } = timing(&model.dynamics);
    IdentifiedText {
        name: model.name.clone(),
        method,
        order,
        states: state_names(model),
        a,
        b,
        c,
        d,
        sample_time_s,
        input_delays_s,
        output_delays_s,
        frequency_response,
        bands: model.bands.as_deref().map(bands_text),
        source: model.source.as_ref().map(source_text),
    }
}

fn timing(dynamics: &Dynamics) -> Timing {
    match dynamics {
        Dynamics::StateSpace(model) => model.timing().clone(),
        Dynamics::Measured(_) => Timing::default(),
    }
}

fn state_names(model: &Model) -> Option<Vec<String>> {
    (!model.states.is_empty()).then(|| model.states.to_vec())
}

fn source_text(provenance: &Provenance) -> SourceText {
    let Provenance { file, sha256, variable, made, note, records } = provenance.clone();
    SourceText { file, sha256, variable, made, note, records: entries(&records).map(<[_]>::to_vec) }
}

fn matrices(dynamics: &Dynamics) -> [Option<Nested<2>>; 4] {
    match dynamics {
        Dynamics::StateSpace(model) => {
            [model.a(), model.b(), model.c(), model.d()].map(|matrix| Some(Nested::of_matrix(matrix)))
        }
        Dynamics::Measured(_) => [const { None }; 4],
    }
}

fn bands_text(bands: &ModelBands) -> BandsText {
    let count = bands.omega().len();
    BandsText {
        omega_rad_s: bands.omega().to_vec(),
        sd_db: nested(bands.sd_db(), count),
        sd_deg: nested(bands.sd_deg(), count),
    }
}

/// A table with so many numbers for each pair.
fn nested(table: &PairTable<Vec<f64>>, count: usize) -> Nested<3> {
    let values = table.iter().flat_map(|(_, values)| values.iter().copied()).collect();
    Nested { shape: [table.outputs(), table.inputs(), count], values }
}

fn response_text(response: &MeasuredResponse) -> ResponseText {
    let count = response.omega().len();
    let values = response.values();
    let shape = [values.outputs(), values.inputs(), count];
    let part = |of: fn(&nalgebra::Complex<f64>) -> f64| Nested {
        shape,
        values: values.iter().flat_map(|(_, values)| values.iter().map(of)).collect(),
    };
    let coherence = response.coherence().map(|table| nested(table, count));
    let valid_band_rad_s = response.valid_bands().map(|bands| Nested {
        shape: [bands.outputs(), bands.inputs(), 2],
        values: bands.iter().flat_map(|(_, band)| band.iter().copied()).collect(),
    });
    let Estimate { averages, window_s } = response.estimate();
    ResponseText {
        omega_rad_s: response.omega().to_vec(),
        re: part(|value| value.re),
        im: part(|value| value.im),
        coherence,
        valid_band_rad_s,
        averages,
        window_s,
    }
}
