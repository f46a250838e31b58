//! `physics.csv`: a row for each physics parameter (M18.5).
//!
//! A physics parameter, such as a moment of inertia, moves the physics models; `z` is its change
//! in plausible standard deviations. The diagnosis fits `z` to all conditions, and *names* a
//! parameter as wrong if the evidence suffices. The rows are, in this order:
//!
//! ```text
//! diagnosed       switched on and fitted; with the applied change, if it is applied
//! switched off    only name, unit and plausible standard deviation
//! set by hand     not fitted: no diagnosis, only z and the applied change
//! ```

use std::collections::BTreeSet;
use std::io::{self, Write};

use gdcm_method::physics::OfferedParameter;
use gdcm_model::number_format::full_precision;
use gdcm_study::results::applied_physics::{AppliedPhysics, AppliedValue};
use gdcm_study::results::physics_findings::DiagnosedParameter;

use crate::csv_text::write_records;

/// A row: one parameter.
struct ParameterRow<'a> {
    parameter: &'a OfferedParameter,
    is_on: bool,
    /// `None` for a parameter that is switched off, or set by hand without a fit.
    diagnosed: Option<DiagnosedParameter<'a>>,
    /// `None` if the parameter does not move the models.
    applied: Option<&'a AppliedValue>,
}

/// Column name, with the function that formats its cell.
type ParameterColumn = (&'static str, fn(&ParameterRow<'_>) -> String);

const PARAMETER_COLUMNS: [ParameterColumn; 21] = [
    ("parameter", |row| row.parameter.name.clone()),
    ("unit", |row| row.parameter.unit.clone()),
    ("on", |row| yes_no(row.is_on)),
    ("change", |row| {
        row.diagnosis_cell(|found| Some(found.change()))
    }),
    ("lower", |row| {
        row.diagnosis_cell(|found| found.interval().map(|[lower, _]| lower))
    }),
    ("upper", |row| {
        row.diagnosis_cell(|found| found.interval().map(|[_, upper]| upper))
    }),
    ("z", |row| full_precision(row.z())),
    ("plausible_sd", |row| {
        full_precision(Some(row.parameter.plausible_sd))
    }),
    ("named", |row| match row.diagnosed {
        Some(found) => yes_no(found.diagnosis.is_named()),
        None => String::new(),
    }),
    ("why_not", |row| {
        let why_not = row
            .diagnosed
            .and_then(|found| found.diagnosis.why_not_named);
        match why_not {
            Some(why) => why.code().to_owned(),
            None => String::new(),
        }
    }),
    ("ratio_alone", |row| {
        row.diagnosis_cell(|found| found.diagnosis.ratio_alone)
    }),
    ("step", |row| {
        match row.diagnosed.and_then(|found| found.diagnosis.step) {
            Some(step) => step.to_string(),
            None => String::new(),
        }
    }),
    ("gain", |row| {
        row.diagnosis_cell(|found| found.diagnosis.gain)
    }),
    ("learned", |row| {
        row.diagnosis_cell(|found| found.diagnosis.learned)
    }),
    ("channels_can_take", |row| {
        row.diagnosis_cell(|found| found.diagnosis.channels_can_take)
    }),
    ("variance_condition", |row| {
        row.diagnosis_cell(|found| found.diagnosis.variance?.condition)
    }),
    ("variance_output", |row| {
        row.diagnosis_cell(|found| found.diagnosis.variance?.output)
    }),
    ("variance_input", |row| {
        row.diagnosis_cell(|found| found.diagnosis.variance?.input)
    }),
    ("variance_band", |row| {
        row.diagnosis_cell(|found| found.diagnosis.variance?.band)
    }),
    ("variance_prior", |row| {
        row.diagnosis_cell(|found| Some(found.diagnosis.variance?.prior))
    }),
    ("applied", |row| {
        full_precision(row.applied.map(AppliedValue::change))
    }),
];

impl ParameterRow<'_> {
    /// Returns the cell for a number in the diagnosis; empty without a diagnosis or number.
    fn diagnosis_cell(&self, number: impl Fn(DiagnosedParameter<'_>) -> Option<f64>) -> String {
        full_precision(self.diagnosed.and_then(number))
    }

    /// Returns the fitted change in plausible standard deviations or, without a diagnosis, the
    /// change set by hand.
    fn z(&self) -> Option<f64> {
        match self.diagnosed {
            Some(found) => Some(found.diagnosis.z),
            None => self.applied.map(|value| value.z),
        }
    }
}

/// Writes `physics.csv`; only the headings if no parameters are applied.
pub(crate) fn write_physics_csv(
    applied: Option<&AppliedPhysics>,
    file: &mut dyn Write,
) -> io::Result<()> {
    let mut records = vec![PARAMETER_COLUMNS.map(|(name, _)| name.to_owned())];
    if let Some(applied) = applied {
        for row in parameter_rows(applied) {
            records.push(PARAMETER_COLUMNS.map(|(_, cell)| cell(&row)));
        }
    }
    write_records(file, records.into_iter())
}

fn parameter_rows(applied: &AppliedPhysics) -> Vec<ParameterRow<'_>> {
    let mut rows = Vec::new();
    let mut listed: BTreeSet<&str> = BTreeSet::new();
    if let Some(findings) = &applied.findings {
        for diagnosed in findings.diagnosed() {
            let name = diagnosed.parameter.name.as_str();
            listed.insert(name);
            rows.push(ParameterRow {
                parameter: diagnosed.parameter,
                is_on: true,
                diagnosed: Some(diagnosed),
                applied: applied
                    .values
                    .iter()
                    .find(|value| value.parameter.name == name),
            });
        }
        for parameter in &findings.off {
            listed.insert(&parameter.name);
            rows.push(ParameterRow {
                parameter,
                is_on: false,
                diagnosed: None,
                applied: None,
            });
        }
    }
    for value in &applied.values {
        if !listed.contains(value.parameter.name.as_str()) {
            rows.push(ParameterRow {
                parameter: &value.parameter,
                is_on: true,
                diagnosed: None,
                applied: Some(value),
            });
        }
    }
    rows
}

fn yes_no(is_true: bool) -> String {
    let word = if is_true { "yes" } else { "no" };
    word.to_owned()
}
