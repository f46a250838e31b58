//! From what a dataset file says to the draft of a dataset, and back from a fault in it to the file.

use nalgebra::DMatrix;

use crate::file_error::ContentError;
use crate::file_error::ContentFault;
use crate::json_text::Nested;
use gdcm_core::dataset::{
    BandsDraft, BundleKind, Channel, ConditionDraft, ConditionId, ConditionRecord, DatasetDraft, Estimate, FlightState,
    Location, ModelDraft, Origin, Provenance, RecordKind, ResponseArray, ResponseDraft, Timing,
};

use super::schema::{
    BandsText, ChannelText, ConditionText, DatasetText, IdentifiedText, PhysicsText, RecordText, ResponseText,
    SourceText,
};

/// The draft that a file's text holds; of its content only what JSON alone spells is checked: words, not numbers.
pub(super) fn draft_of(text: DatasetText) -> Result<DatasetDraft, ContentError> {
    let band = text.frequency_band;
    if band.unit != "rad/s" {
        let fault = ContentFault::Word { expected: "\"rad/s\"".to_owned(), found: band.unit };
        return Err(ContentError::new(Location::entry("frequency_band, unit"), fault));
    }
    let conditions = text.conditions.into_iter().enumerate();
    Ok(DatasetDraft {
        name: text.name,
        description: text.description.unwrap_or_default(),
        inputs: text.inputs.into_iter().map(channel_of).collect(),
        outputs: text.outputs.into_iter().map(channel_of).collect(),
        on_axis: text.on_axis.unwrap_or_default(),
        band: (band.min, band.max),
        conditions: conditions.map(|(index, text)| condition_of(index + 1, text)).collect::<Result<_, _>>()?,
    })
}

fn channel_of(text: ChannelText) -> Channel {
    Channel { name: text.name, unit: text.unit, description: text.description.unwrap_or_default() }
}

fn condition_of(position: usize, text: ConditionText) -> Result<ConditionDraft, ContentError> {
    let place = Location::condition(position, text.id);
    let flight_state = FlightState {
        id: ConditionId(text.id),
        name: text.name,
        airspeed_kt: text.airspeed_kt,
        altitude: text.altitude,
        altitude_ft: text.altitude_ft,
        weight: text.weight,
        mass_kg: text.mass_kg,
    };
    let records = text.records.unwrap_or_default().into_iter().enumerate();
    let records = records.map(|(index, record)| record_of(&place, index + 1, record)).collect::<Result<_, _>>()?;
    let physics = text.physics_models.into_iter().enumerate();
    let physics = physics.map(|(index, model)| {
        let place = place.model(BundleKind::Physics, index + 1, &model.name);
        physics_model_of(&place, model)
    });
    Ok(ConditionDraft {
        flight_state,
        physics: physics.collect::<Result<_, _>>()?,
        identified: text.identified_models.into_iter().map(identified_model_of).collect(),
        records,
    })
}

/// The record of a text; `condition` is where it stands.
pub(crate) fn record_of(
    condition: &Location,
    position: usize,
    text: RecordText,
) -> Result<ConditionRecord, ContentError> {
    let kind = match text.kind {
        None => RecordKind::Other,
        Some(word) => RecordKind::of(&word).ok_or_else(|| {
            let words = RecordKind::ALL.map(|kind| format!("\"{}\"", kind.word()));
            let fault = ContentFault::Word { expected: format!("one of {}", words.join(", ")), found: word };
            ContentError::new(condition.at(format!("records, entry {position}, kind")), fault)
        })?,
    };
    Ok(ConditionRecord {
        name: text.name,
        file: text.file,
        variable: text.variable,
        sha256: text.sha256,
        kind,
        held_out: text.held_out,
        used: text.used.unwrap_or(true),
        sample_time_s: text.sample_time_s,
        used_s: text.used_s.unwrap_or_default(),
    })
}

fn physics_model_of(place: &Location, text: PhysicsText) -> Result<ModelDraft, ContentError> {
    let perturbation = text.perturbation;
    let origin = match text.role.as_str() {
        "nominal" => Origin::Nominal { perturbation },
        "perturbed" => Origin::Perturbed { perturbation },
        _ => {
            let fault = ContentFault::Word { expected: "\"nominal\" or \"perturbed\"".to_owned(), found: text.role };
            return Err(ContentError::new(place.at("role"), fault));
        }
    };
    let timing = Timing {
        sample_time_s: text.sample_time_s,
        input_delays_s: text.input_delays_s,
        output_delays_s: text.output_delays_s,
    };
    Ok(ModelDraft {
        name: text.name,
        origin,
        timing,
        matrices: [text.a, text.b, text.c, text.d].map(|array| array.map(matrix)),
        response: text.frequency_response.map(response_of),
        states: text.states.unwrap_or_default(),
        source: text.source.map(provenance_of),
        bands: None,
    })
}

/// The draft of an identified model's text.
pub(crate) fn identified_model_of(text: IdentifiedText) -> ModelDraft {
    let timing = Timing {
        sample_time_s: text.sample_time_s,
        input_delays_s: text.input_delays_s,
        output_delays_s: text.output_delays_s,
    };
    ModelDraft {
        name: text.name,
        timing,
        origin: Origin::Identified { method: text.method, order: text.order },
        matrices: [text.a, text.b, text.c, text.d].map(|array| array.map(matrix)),
        response: text.frequency_response.map(response_of),
        states: text.states.unwrap_or_default(),
        source: text.source.map(provenance_of),
        bands: text.bands.map(bands_of),
    }
}

fn bands_of(text: BandsText) -> BandsDraft {
    BandsDraft { omega: text.omega_rad_s, sd_db: array(text.sd_db), sd_deg: array(text.sd_deg) }
}

fn array(nested: Nested<3>) -> ResponseArray {
    ResponseArray { shape: nested.shape, values: nested.values }
}

fn matrix(array: Nested<2>) -> DMatrix<f64> {
    DMatrix::from_row_slice(array.shape[0], array.shape[1], &array.values)
}

fn response_of(text: ResponseText) -> ResponseDraft {
    ResponseDraft {
        omega: text.omega_rad_s,
        re: array(text.re),
        im: array(text.im),
        coherence: text.coherence.map(array),
        valid_bands: text.valid_band_rad_s.map(array),
        estimate: Estimate { averages: text.averages, window_s: text.window_s },
    }
}

fn provenance_of(text: SourceText) -> Provenance {
    let SourceText { file, sha256, variable, made, note, records } = text;
    Provenance { file, sha256, variable, made, note, records: records.unwrap_or_default() }
}
