//! Embedded reference values, and a reader that names what is missing.

use nalgebra::{Complex, DMatrix};
use serde_json::Value;

use gdcm_model::dataset::{Pair, PairTable};
use gdcm_model::response::FrequencyResponse;

use crate::check::CheckFault;

/// An embedded JSON file with reference values.
#[derive(Clone, Copy)]
pub(crate) struct ReferenceFile {
    pub(crate) name: &'static str,
    pub(crate) text: &'static str,
}

macro_rules! reference_file {
    ($name:literal) => {
        ReferenceFile {
            name: $name,
            text: include_str!(concat!("../../../tests/data/reference/", $name)),
        }
    };
}

pub(crate) const GAIN_INSTANCES: ReferenceFile = reference_file!("gain-instances.json");
pub(crate) const DELAY_INSTANCES: ReferenceFile = reference_file!("delay-instances.json");
pub(crate) const RESPONSES: ReferenceFile = reference_file!("frequency-response-golden.json");
pub(crate) const EXAMPLE: ReferenceFile = reference_file!("example-analysis.json");
pub(crate) const LEADS: ReferenceFile = reference_file!("lead.json");
pub(crate) const MIXING: ReferenceFile = reference_file!("mixing.json");
pub(crate) const MUAD: ReferenceFile = reference_file!("muad-golden.json");
pub(crate) const PHYSICS: ReferenceFile = reference_file!("physics.json");
pub(crate) const REQUIREMENTS: ReferenceFile = reference_file!("requirements.json");
pub(crate) const UNCERTAINTY: ReferenceFile = reference_file!("uncertainty.json");

/// Models from the literature and a nearly defective one, by the names in [`RESPONSES`].
const MODELS: [(&str, ReferenceFile); 5] = [
    (
        "compleib_HE2_AH64_130kt.json",
        reference_file!("published-models/compleib_HE2_AH64_130kt.json"),
    ),
    (
        "compleib_HE3_Bell205_6out.json",
        reference_file!("published-models/compleib_HE3_Bell205_6out.json"),
    ),
    (
        "westland_lynx_hover_6out.json",
        reference_file!("published-models/westland_lynx_hover_6out.json"),
    ),
    (
        "yamaha_R50_hover_mettler.json",
        reference_file!("published-models/yamaha_R50_hover_mettler.json"),
    ),
    (
        "../near-defective-model.json",
        reference_file!("near-defective-model.json"),
    ),
];

/// Returns the file for a model in [`MODELS`], by its name in [`RESPONSES`].
pub(crate) fn model_file(name: &str) -> Result<ReferenceFile, CheckFault> {
    for (known, file) in MODELS {
        if known == name {
            return Ok(file);
        }
    }
    Err(CheckFault::Reference {
        file: RESPONSES.name,
        member: name.to_owned(),
    })
}

impl ReferenceFile {
    pub(crate) fn read(self) -> Result<Reference, CheckFault> {
        match serde_json::from_str(self.text) {
            Ok(value) => Ok(Reference {
                file: self.name,
                path: String::new(),
                value,
            }),
            Err(error) => Err(CheckFault::Reference {
                file: self.name,
                member: error.to_string(),
            }),
        }
    }
}

/// A JSON value in a reference file, with its place in the file for messages. Methods named `as_…`
/// and `elements` read the value itself, the others a member with the given name; a fault names the
/// member that is missing or of the wrong kind.
#[derive(Clone, Debug)]
pub(crate) struct Reference {
    file: &'static str,
    path: String,
    value: Value,
}

impl Reference {
    fn fault(&self, member: &str) -> CheckFault {
        CheckFault::Reference {
            file: self.file,
            member: format!("{}/{member}", self.path),
        }
    }

    pub(crate) fn member(&self, name: &str) -> Result<Self, CheckFault> {
        match self.value.get(name) {
            Some(value) => Ok(Self {
                file: self.file,
                path: format!("{}/{name}", self.path),
                value: value.clone(),
            }),
            None => Err(self.fault(name)),
        }
    }

    /// Returns whether a member exists and is not null.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.value.get(name).is_some_and(|value| !value.is_null())
    }

    pub(crate) fn elements(&self) -> Result<Vec<Self>, CheckFault> {
        let Some(values) = self.value.as_array() else {
            return Err(self.fault("list"));
        };
        let mut elements = Vec::with_capacity(values.len());
        for (index, value) in values.iter().enumerate() {
            elements.push(Self {
                file: self.file,
                path: format!("{}/{index}", self.path),
                value: value.clone(),
            });
        }
        Ok(elements)
    }

    pub(crate) fn list(&self, name: &str) -> Result<Vec<Self>, CheckFault> {
        self.member(name)?.elements()
    }

    pub(crate) fn as_number(&self) -> Result<f64, CheckFault> {
        self.value.as_f64().ok_or_else(|| self.fault("number"))
    }

    pub(crate) fn number(&self, name: &str) -> Result<f64, CheckFault> {
        self.member(name)?.as_number()
    }

    pub(crate) fn as_numbers(&self) -> Result<Vec<f64>, CheckFault> {
        let mut numbers = Vec::new();
        for element in self.elements()? {
            numbers.push(element.as_number()?);
        }
        Ok(numbers)
    }

    pub(crate) fn numbers(&self, name: &str) -> Result<Vec<f64>, CheckFault> {
        self.member(name)?.as_numbers()
    }

    pub(crate) fn integer(&self, name: &str) -> Result<i64, CheckFault> {
        let member = self.member(name)?;
        member.value.as_i64().ok_or_else(|| self.fault(name))
    }

    pub(crate) fn text(&self, name: &str) -> Result<String, CheckFault> {
        let member = self.member(name)?;
        match member.value.as_str() {
            Some(text) => Ok(text.to_owned()),
            None => Err(self.fault(name)),
        }
    }

    pub(crate) fn texts(&self, name: &str) -> Result<Vec<String>, CheckFault> {
        let mut texts = Vec::new();
        for element in self.list(name)? {
            match element.value.as_str() {
                Some(text) => texts.push(text.to_owned()),
                None => return Err(element.fault("text")),
            }
        }
        Ok(texts)
    }

    pub(crate) fn as_flag(&self) -> Result<bool, CheckFault> {
        self.value.as_bool().ok_or_else(|| self.fault("flag"))
    }

    pub(crate) fn flag(&self, name: &str) -> Result<bool, CheckFault> {
        let member = self.member(name)?;
        member.value.as_bool().ok_or_else(|| self.fault(name))
    }

    /// Returns this value, a list with one list per row, as a matrix.
    pub(crate) fn as_matrix(&self) -> Result<DMatrix<f64>, CheckFault> {
        let mut rows = Vec::new();
        for row in self.elements()? {
            rows.push(row.as_numbers()?);
        }
        let columns = rows.first().map_or(0, Vec::len);
        if rows.iter().any(|row| row.len() != columns) {
            return Err(self.fault("matrix"));
        }
        Ok(DMatrix::from_fn(rows.len(), columns, |row, column| {
            rows[row][column]
        }))
    }

    pub(crate) fn matrix(&self, name: &str) -> Result<DMatrix<f64>, CheckFault> {
        self.member(name)?.as_matrix()
    }

    /// Returns a member, a list with one row per output, as a table of numbers.
    pub(crate) fn table(&self, name: &str) -> Result<PairTable<f64>, CheckFault> {
        let matrix = self.matrix(name)?;
        Ok(PairTable::from_fn(
            matrix.nrows(),
            matrix.ncols(),
            |pair: Pair| matrix[(pair.output, pair.input)],
        ))
    }

    /// Returns this response, stored as `[part][frequency][output][input]` with the real part first.
    pub(crate) fn as_response(&self) -> Result<FrequencyResponse, CheckFault> {
        let parts = self.elements()?;
        let [re, im] = parts.as_slice() else {
            return Err(self.fault("two parts"));
        };
        let mut values: Vec<DMatrix<Complex<f64>>> = Vec::new();
        for (re, im) in re.elements()?.iter().zip(im.elements()?) {
            values.push(re.as_matrix()?.zip_map(&im.as_matrix()?, Complex::new));
        }
        let Some((outputs, inputs)) = values.first().map(DMatrix::shape) else {
            return Err(self.fault("frequencies"));
        };
        Ok(FrequencyResponse::new(PairTable::from_fn(
            outputs,
            inputs,
            |pair: Pair| {
                let mut curve = Vec::with_capacity(values.len());
                for value in &values {
                    curve.push(value[(pair.output, pair.input)]);
                }
                curve
            },
        )))
    }

    /// Returns this list, real and imaginary part, as a complex number.
    pub(crate) fn as_complex(&self) -> Result<Complex<f64>, CheckFault> {
        match self.as_numbers()?.as_slice() {
            [re, im] => Ok(Complex::new(*re, *im)),
            _ => Err(self.fault("complex number")),
        }
    }
}
