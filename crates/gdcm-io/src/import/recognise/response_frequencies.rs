//! A measured response's frequencies: their field and their unit.
//!
//! A [`Record`] is a group of fields that may form a model, such as a struct; it marks the fields
//! that are used.

use std::f64::consts::TAU;

use gdcm_model::units::physical_unit::{Dimension, PhysicalUnit};

use super::delays::refuse_other_time_units;
use super::recognition_fault::RecognitionFault;
use super::record::Record;
use super::values::{Field, array_of, first_text_of, list_of};

/// Names for frequencies in rad/s.
const RADIANS: &[&str] = &["omega", "omega_rad_s", "w", "freq_rad_s", "frequency_rad_s"];
/// Names for frequencies in an unspecified unit.
const FREQUENCIES: &[&str] = &["Frequency", "freq", "frequencies", "f"];
/// Names for frequencies in Hz.
const HERTZ: &[&str] = &["f_hz", "freq_hz", "frequency_hz"];
/// Field names for the frequency unit.
const UNITS: &[&str] = &["FrequencyUnit", "FreqUnits", "Units", "frequency_unit"];

/// Returns whether a record has a field with more than one frequency.
pub(super) fn has_several_frequencies(record: &Record<'_>) -> bool {
    let frequencies = record
        .find(RADIANS)
        .or_else(|| record.find(FREQUENCIES))
        .or_else(|| record.find(HERTZ));
    let Some(frequencies) = frequencies else {
        return false;
    };
    array_of(frequencies.value).is_some_and(|array| array.len() > 1)
}

pub(super) struct Frequencies {
    /// Angular frequencies \[rad/s\].
    pub(super) omega: Vec<f64>,
    /// Whether the file gives the frequencies in Hz or a multiple, such as kHz.
    pub(super) is_hertz: bool,
}

impl Frequencies {
    pub(super) fn read(record: &Record<'_>) -> Result<Self, RecognitionFault> {
        let unit = FrequencyUnit::read(record);
        let GivenFrequencies { field, is_hertz } = GivenFrequencies::find(record, &unit)?;
        let values = list_of("frequencies", record.take(field))?;
        let factor = if is_hertz {
            unit.rad_s_per_multiple_of_hertz()
        } else {
            unit.rad_s_per_angular_rate(record)?
        };
        Ok(Self {
            omega: values.into_iter().map(|value| value * factor).collect(),
            is_hertz,
        })
    }
}

/// Field with a response's frequencies.
struct GivenFrequencies<'v> {
    field: Field<'v>,
    is_hertz: bool,
}

impl<'v> GivenFrequencies<'v> {
    /// Finds the field, and whether it is in Hz:
    ///
    /// 1. a name for rad/s: Hz only if the given unit is Hz or a multiple;
    /// 2. else a name without a unit: likewise; without a given unit, rad/s in MATLAB and
    ///    python-control, and an error elsewhere;
    /// 3. else a name for Hz: Hz, or the given multiple.
    ///
    /// # Errors
    /// The reason if there are no frequencies, or neither their name nor a unit tells whether they
    /// are in rad/s or Hz.
    fn find(record: &Record<'v>, unit: &FrequencyUnit) -> Result<Self, RecognitionFault> {
        // Without a unit, MATLAB and python-control use rad/s.
        let has_default = record.class.is_some() || record.get(&["frdata", "fresp"]).is_some();
        if let Some(field) = record.find(RADIANS) {
            Ok(Self {
                field,
                is_hertz: unit.multiple_of_hertz.is_some(),
            })
        } else if let Some(field) = record.find(FREQUENCIES) {
            if unit.text.is_empty() && !has_default {
                return Err(RecognitionFault::NoFrequencyUnit);
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
            Err(RecognitionFault::NoFrequencies)
        }
    }
}

/// Unit that is given beside the frequencies.
struct FrequencyUnit {
    /// Unit name; empty if none is given.
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

    /// Returns the factor from the unit to rad/s; from Hz if the unit is no multiple of Hz.
    fn rad_s_per_multiple_of_hertz(&self) -> f64 {
        match self.multiple_of_hertz {
            Some(unit) => TAU * unit.size,
            None => TAU,
        }
    }

    /// Returns the factor from the unit to rad/s: 1 without a unit, and for rad alone.
    ///
    /// # Errors
    /// The unit is not rad over a time, or it is MATLAB's `rad/TimeUnit` and the record's
    /// `TimeUnit` is not the second.
    fn rad_s_per_angular_rate(&self, record: &Record<'_>) -> Result<f64, RecognitionFault> {
        if let Some(unit) = self.angular_rate {
            return Ok(unit.size);
        }
        match self.text.to_lowercase().as_str() {
            "" | "rad" | "rads" => Ok(1.0),
            "rad/timeunit" => {
                refuse_other_time_units(record)?;
                Ok(1.0)
            }
            other => Err(RecognitionFault::FrequencyUnit {
                unit: other.to_owned(),
            }),
        }
    }
}
