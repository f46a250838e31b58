//! Recognises models given by measured frequency responses.
//!
//! ```text
//! 1  delays beside the response: a fault, because it already contains them  (refuse_delays)
//! 2  frequencies in rad/s                                                   (Frequencies::read)
//! 3  complex values, or real and imaginary parts                            (StoredResponse::find)
//! 4  which index counts the outputs, the inputs and the frequencies         (ResponseLayout::new)
//! 5  coherence; all values as outputs x inputs x frequencies                (coherence_of)
//! 6  origin, labels and flight condition, from the fields beside the response
//! ```
//!
//! A [`Record`] is a group of fields that may form a model, such as a struct; it marks the fields
//! that are used. Coherence γ² is the share of the output power that the input explains.

use gdcm_model::assembly::FoundModel;
use gdcm_model::dataset::dataset_draft::{ModelDraft, ResponseArray, ResponseDraft};
use gdcm_model::dataset::measured_response::Estimate;
use gdcm_model::dataset::model::Origin;

use super::delays::refuse_delays;
use super::flight_condition::{Page, facts_of, origin_of};
use super::labels::{inputs_of, outputs_of};
use super::recognition_fault::RecognitionFault;
use super::record::Record;
use super::response_frequencies::{Frequencies, has_several_frequencies};
use super::state_space::source_of;
use super::values::array_of;
use crate::files::model_collection::bare_draft;
use crate::formats::reading_note::ReadingNote;
use crate::formats::variables::Array;

/// Names for complex responses. python-control uses `frdata` and, in older versions, `fresp`.
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
const COHERENCES: &[&str] = &[
    "coherence",
    "coher",
    "coh",
    "gamma2",
    "gamma_squared",
    "Cxy",
];
/// Names used for both γ and γ².
const GAMMAS: &[&str] = &["gamma", "γ"];

/// Returns whether fields form a frequency response: more than one frequency, and either complex
/// values or real and imaginary parts. Marks the fields with these values as used.
pub(super) fn is_response(record: &Record<'_>) -> bool {
    has_several_frequencies(record)
        && (complex_array(record).is_some() || real_and_imaginary(record).is_some())
}

/// Reads the measured response in `record`.
pub(super) fn response(
    record: &Record<'_>,
    variable: &str,
) -> Result<FoundModel, RecognitionFault> {
    // Step 1.
    refuse_delays(record)?;
    // Step 2.
    let frequencies = Frequencies::read(record)?;
    // Step 3.
    let stored = StoredResponse::find(record)?;
    // Step 4.
    let layout = ResponseLayout::new(stored.shape, frequencies.omega.len())?;
    // Step 5.
    let coherence = coherence_of(record, &stored, &layout)?;
    let response = ResponseDraft {
        re: layout.ordered("response", stored.re)?,
        im: layout.ordered("response", stored.im)?,
        omega: frequencies.omega,
        coherence,
        valid_bands: None,
        estimate: Estimate::default(),
    };
    // Step 6. A measured response is never a physics model, whatever role the record gives.
    let origin = match origin_of(record) {
        Origin::Identified { method, order } => Origin::Identified { method, order },
        Origin::Nominal { .. } | Origin::Perturbed { .. } => Origin::Identified {
            method: None,
            order: None,
        },
    };
    let mut notes = Vec::new();
    if frequencies.is_hertz {
        notes.push(ReadingNote::FrequenciesInHertz.to_string());
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

/// Returns the complex array and marks its field as used; `None` if there is none.
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

/// A response's values, in file order.
struct StoredResponse<'v> {
    re: &'v [f64],
    im: &'v [f64],
    shape: &'v [usize],
}

impl<'v> StoredResponse<'v> {
    fn find(record: &Record<'v>) -> Result<Self, RecognitionFault> {
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
            _ => Err(RecognitionFault::PartsDiffer),
        }
    }
}

/// Returns the coherence γ² from a field that certainly holds it; `None` without coherence.
///
/// # Errors
/// The reason if the coherence and the response have different value counts, a value is not finite,
/// or the only field may hold γ or γ².
fn coherence_of(
    record: &Record<'_>,
    stored: &StoredResponse<'_>,
    layout: &ResponseLayout,
) -> Result<Option<ResponseArray>, RecognitionFault> {
    if let Some(array) = record.get(COHERENCES).and_then(array_of)
        && !array.is_empty()
    {
        if array.len() != stored.re.len() {
            return Err(RecognitionFault::CoherenceCount {
                found: array.len(),
                expected: stored.re.len(),
            });
        }
        return Ok(Some(layout.ordered("coherence", &array.re)?));
    }
    match record.find(GAMMAS) {
        Some(field) => Err(RecognitionFault::Gamma {
            name: field.name.to_owned(),
        }),
        None => Ok(None),
    }
}

/// A stored response's dimensions and index order.
struct ResponseLayout {
    outputs: usize,
    inputs: usize,
    /// Frequency count.
    count: usize,
    // Distances in the file between values whose output, input or frequency index differs by 1. In
    // a file, the first index runs fastest.
    output_stride: usize,
    input_stride: usize,
    frequency_stride: usize,
}

impl ResponseLayout {
    /// Determines the layout for a response with `count` frequencies: the frequency is the last
    /// index, as in MATLAB, if that fits; else the first, as in NumPy. A single response may be a
    /// row or a column.
    ///
    /// # Errors
    /// The reason if none of these fits.
    fn new(shape: &[usize], count: usize) -> Result<Self, RecognitionFault> {
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
            _ => Err(RecognitionFault::ResponseShape {
                frequencies: count,
                found: shape.to_vec(),
            }),
        }
    }

    /// Reorders values to outputs x inputs x frequencies, with the frequency index fastest; rejects
    /// values that are not finite.
    fn ordered(
        &self,
        name: &'static str,
        values: &[f64],
    ) -> Result<ResponseArray, RecognitionFault> {
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
            return Err(RecognitionFault::ResponseNotFinite {
                name,
                frequency: at % self.count + 1,
                value: ordered[at],
            });
        }
        Ok(ResponseArray {
            shape: [self.outputs, self.inputs, self.count],
            values: ordered,
        })
    }
}
