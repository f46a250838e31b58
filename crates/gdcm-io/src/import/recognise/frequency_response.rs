//! Recognition of models given by measured frequency responses.

use std::f64::consts::TAU;

use gdcm_model::assembly::FoundModel;
use gdcm_model::dataset::dataset_draft::{ModelDraft, ResponseArray, ResponseDraft};
use gdcm_model::dataset::measured_response::Estimate;
use gdcm_model::dataset::model::Origin;
use gdcm_model::units::physical_unit::{Dimension, PhysicalUnit};

use super::delays::refuse_delays;
use super::flight_condition::{Page, facts_of, origin_of};
use super::labels::{inputs_of, outputs_of};
use super::record::Record;
use super::state_space::source_of;
use super::values::{Field, array_of, first_text_of, list_of};
use crate::files::model_collection::bare_draft;
use crate::formats::variables::Array;

/// Names of complex responses. python-control uses `frdata` and, in earlier versions, `fresp`.
const RESPONSES: &[&str] = &[
    "ResponseData",
    "Response",
    "frdata",
    "fresp",
    "H",
    "G",
    "resp",
    "frf",
];
const REAL_PARTS: &[&str] = &["re", "real", "Hre"];
const IMAGINARY_PARTS: &[&str] = &["im", "imag", "Him"];
/// Names of frequencies in rad/s.
const RADIANS: &[&str] = &["omega", "omega_rad_s", "w", "freq_rad_s", "frequency_rad_s"];
/// Names of frequencies in an unspecified unit.
const FREQUENCIES: &[&str] = &["Frequency", "freq", "frequencies", "f"];
/// Names of frequencies in Hz.
const HERTZ: &[&str] = &["f_hz", "freq_hz", "frequency_hz"];
const UNITS: &[&str] = &["FrequencyUnit", "FreqUnits", "Units", "frequency_unit"];
const COHERENCES: &[&str] = &[
    "coherence",
    "coher",
    "coh",
    "gamma2",
    "gamma_squared",
    "Cxy",
];
/// Names that are used for both γ and γ².
const GAMMAS: &[&str] = &["gamma", "γ"];

/// Returns whether fields form a frequency response: more than one frequency, and either complex
/// values or real and imaginary parts.
pub(super) fn is_response(record: &Record<'_>) -> bool {
    let frequencies = record
        .find(RADIANS)
        .or_else(|| record.find(FREQUENCIES))
        .or_else(|| record.find(HERTZ));
    let Some(frequencies) = frequencies else {
        return false;
    };
    let has_frequencies = array_of(frequencies.value).is_some_and(|array| array.len() > 1);
    has_frequencies && (complex_array(record).is_some() || real_and_imaginary(record).is_some())
}

/// Reads the measured response in `record`.
pub(super) fn response(record: &Record<'_>, variable: &str) -> Result<FoundModel, String> {
    refuse_delays(record)?;
    let frequencies = Frequencies::read(record)?;
    let stored = StoredResponse::find(record)?;
    let layout = ResponseLayout::new(stored.shape, frequencies.omega.len())?;
    let coherence = coherence_of(record, &stored, &layout)?;
    let response = ResponseDraft {
        re: layout.ordered("response", stored.re)?,
        im: layout.ordered("response", stored.im)?,
        omega: frequencies.omega,
        coherence,
        valid_bands: None,
        estimate: Estimate::default(),
    };
    let origin = match origin_of(record) {
        Origin::Identified { method, order } => Origin::Identified { method, order },
        Origin::Nominal { .. } | Origin::Perturbed { .. } => Origin::Identified {
            method: None,
            order: None,
        },
    };
    let mut notes = Vec::new();
    if frequencies.is_hertz {
        notes.push("frequencies in Hz".to_owned());
    }
    Ok(FoundModel {
        draft: ModelDraft {
            response: Some(response),
            source: Some(source_of(variable)),
            ..bare_draft(variable.to_owned(), origin)
        },
        inputs: inputs_of(record, layout.inputs)?,
        outputs: outputs_of(record, layout.outputs)?,
        facts: facts_of(record, Page::ONLY)?,
        notes,
    })
}

/// Returns the array of complex values and marks its field as used; `None` if there is none.
fn complex_array<'v>(record: &Record<'v>) -> Option<&'v Array> {
    let field = record.find(RESPONSES)?;
    let array = array_of(field.value)?;
    array.im.as_ref()?;
    record.mark_used(field.name);
    Some(array)
}

/// Returns the real and the imaginary parts and marks their fields as used; `None` if either is
/// missing.
fn real_and_imaginary<'v>(record: &Record<'v>) -> Option<(&'v Array, &'v Array)> {
    let re = record.find(REAL_PARTS)?;
    let im = record.find(IMAGINARY_PARTS)?;
    let parts = array_of(re.value).zip(array_of(im.value))?;
    record.mark_used(re.name);
    record.mark_used(im.name);
    Some(parts)
}

/// Values of a response, in the order of the file.
struct StoredResponse<'v> {
    re: &'v [f64],
    im: &'v [f64],
    shape: &'v [usize],
}

impl<'v> StoredResponse<'v> {
    fn find(record: &Record<'v>) -> Result<Self, String> {
        // Look up the parts even if there are complex values, so that their fields count as used.
        let parts = real_and_imaginary(record);
        if let Some(array) = complex_array(record) {
            return Ok(Self {
                re: &array.re,
                im: array.im.as_deref().unwrap_or_default(),
                shape: &array.shape,
            });
        }
        match parts {
            Some((re, im)) if re.shape == im.shape => Ok(Self {
                re: &re.re,
                im: &im.re,
                shape: &re.shape,
            }),
            _ => Err("real and imaginary parts have different dimensions".to_owned()),
        }
    }
}

/// Returns the coherence γ²; `None` if the record has none.
///
/// # Errors
/// The reason if the number of values differs from that of the response, or a field may hold γ or
/// γ².
fn coherence_of(
    record: &Record<'_>,
    stored: &StoredResponse<'_>,
    layout: &ResponseLayout,
) -> Result<Option<ResponseArray>, String> {
    if let Some(array) = record.get(COHERENCES).and_then(array_of)
        && !array.is_empty()
    {
        if array.len() != stored.re.len() {
            return Err(format!(
                "coherence: {} numbers for the {} of the response; write one for each output, input and frequency, or leave it out",
                array.len(),
                stored.re.len()
            ));
        }
        return Ok(Some(layout.ordered("coherence", &array.re)?));
    }
    match record.find(GAMMAS) {
        Some(field) => Err(format!(
            "{}: may be γ or γ²; call γ² gamma2 or coherence, and square γ first",
            field.name
        )),
        None => Ok(None),
    }
}

/// Frequencies of a response.
struct Frequencies {
    /// Angular frequencies \[rad/s\].
    omega: Vec<f64>,
    /// Whether the file gives the frequencies in Hz or in a multiple of Hz.
    is_hertz: bool,
}

impl Frequencies {
    fn read(record: &Record<'_>) -> Result<Self, String> {
        let unit = FrequencyUnit::read(record);
        let GivenFrequencies { field, is_hertz } = GivenFrequencies::find(record, &unit)?;
        let values = list_of("frequencies", record.take(field))?;
        let factor = if is_hertz {
            unit.rad_s_per_multiple_of_hertz()
        } else {
            unit.rad_s_per_angular_rate()?
        };
        Ok(Self {
            omega: values.into_iter().map(|value| value * factor).collect(),
            is_hertz,
        })
    }
}

/// Field with the frequencies of a response.
struct GivenFrequencies<'v> {
    field: Field<'v>,
    is_hertz: bool,
}

impl<'v> GivenFrequencies<'v> {
    /// Finds the field; its name decides about the unit, unless a unit is given.
    ///
    /// # Errors
    /// The reason if there are no frequencies, or neither their name nor a unit tells whether they
    /// are in rad/s or Hz.
    fn find(record: &Record<'v>, unit: &FrequencyUnit) -> Result<Self, String> {
        // Without a unit, MATLAB and python-control use rad/s.
        let has_default = record.class.is_some() || record.get(&["frdata", "fresp"]).is_some();
        if let Some(field) = record.find(RADIANS) {
            Ok(Self {
                field,
                is_hertz: unit.multiple_of_hertz.is_some(),
            })
        } else if let Some(field) = record.find(FREQUENCIES) {
            if unit.text.is_empty() && !has_default {
                return Err(
                    "frequencies: unit missing, rad/s or Hz; call them omega_rad_s or f_hz, or give \"rad/s\" or \"Hz\" \
                        beside them as frequency_unit"
                        .to_owned(),
                );
            }
            Ok(Self {
                field,
                is_hertz: unit.multiple_of_hertz.is_some(),
            })
        } else if let Some(field) = record.find(HERTZ) {
            Ok(Self {
                field,
                is_hertz: true,
            })
        } else {
            Err("frequencies are missing".to_owned())
        }
    }
}

/// Unit that is given beside the frequencies.
struct FrequencyUnit {
    /// Name of the unit; empty if none is given.
    text: String,
    /// The unit, if it is Hz, kHz, ...
    multiple_of_hertz: Option<PhysicalUnit>,
    /// The unit, if it is an angle in rad over a time.
    angular_rate: Option<PhysicalUnit>,
}

impl FrequencyUnit {
    fn read(record: &Record<'_>) -> Self {
        let text = record
            .get(UNITS)
            .and_then(first_text_of)
            .unwrap_or_default();
        let unit = PhysicalUnit::parse(&text);
        Self {
            multiple_of_hertz: unit.filter(|unit| unit.dimension == Dimension::Frequency),
            angular_rate: unit.filter(|unit| unit.name.starts_with("rad/")),
            text,
        }
    }

    /// Returns the factor from the unit to rad/s; without a unit, from Hz.
    fn rad_s_per_multiple_of_hertz(&self) -> f64 {
        match self.multiple_of_hertz {
            Some(unit) => TAU * unit.size,
            None => TAU,
        }
    }

    /// Returns the factor from the unit to rad/s; without a unit, 1.
    fn rad_s_per_angular_rate(&self) -> Result<f64, String> {
        if let Some(unit) = self.angular_rate {
            return Ok(unit.size);
        }
        match self.text.to_lowercase().as_str() {
            "" | "rad" | "rads" | "rad/timeunit" => Ok(1.0),
            other => Err(format!(
                "frequencies are in \"{other}\"; expected rad/s or Hz"
            )),
        }
    }
}

/// Dimensions and index order of a stored response.
struct ResponseLayout {
    outputs: usize,
    inputs: usize,
    /// Number of frequencies.
    count: usize,
    // Distances in the file between values whose output, input or frequency index differs by 1. In a
    // file, the first index runs fastest.
    output_stride: usize,
    input_stride: usize,
    frequency_stride: usize,
}

impl ResponseLayout {
    /// Determines the layout of a response with `count` frequencies: the frequency is the last
    /// index, as in MATLAB, or the first, as in NumPy. A single response may be a row or a column.
    fn new(shape: &[usize], count: usize) -> Result<Self, String> {
        match *shape {
            [outputs, inputs, last] if last == count => Ok(Self {
                outputs,
                inputs,
                count,
                output_stride: 1,
                input_stride: outputs,
                frequency_stride: outputs * inputs,
            }),
            [first, outputs, inputs] if first == count => Ok(Self {
                outputs,
                inputs,
                count,
                output_stride: count,
                input_stride: count * outputs,
                frequency_stride: 1,
            }),
            [rows, columns] if rows * columns == count => Ok(Self {
                outputs: 1,
                inputs: 1,
                count,
                output_stride: 0,
                input_stride: 0,
                frequency_stride: 1,
            }),
            _ => {
                let found: Vec<String> = shape.iter().map(usize::to_string).collect();
                Err(format!(
                    "the response: expected outputs x inputs x {count} frequencies, found {}",
                    found.join(" x ")
                ))
            }
        }
    }

    /// Reorders values to outputs x inputs x frequencies, with the frequency index fastest; rejects
    /// values that are not finite.
    fn ordered(&self, name: &str, values: &[f64]) -> Result<ResponseArray, String> {
        let mut ordered = Vec::with_capacity(values.len());
        for output in 0..self.outputs {
            for input in 0..self.inputs {
                let start = output * self.output_stride + input * self.input_stride;
                for frequency in 0..self.count {
                    ordered.push(values[start + frequency * self.frequency_stride]);
                }
            }
        }
        if let Some(at) = ordered.iter().position(|value| !value.is_finite()) {
            return Err(format!(
                "{name}, frequency {}: expected a finite number",
                at % self.count + 1
            ));
        }
        Ok(ResponseArray {
            shape: [self.outputs, self.inputs, self.count],
            values: ordered,
        })
    }
}
