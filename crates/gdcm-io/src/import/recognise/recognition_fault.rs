//! Reasons why a model or a flight record among variables cannot be read.

use std::fmt::{self, Display, Formatter};

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::dataset::limits::MOST_STATES;
use gdcm_model::dataset::state_space::GREATEST_CHANNEL_DELAY_S;
use gdcm_model::number_format::counted;
use gdcm_model::units::number;

use crate::variable_fault::VariableFault;
use crate::variable_fault::unread::Unread;

/// Remedy in questions about delays.
const CHANNEL_DELAYS: &str = "call it input_delays_s or output_delays_s (a number for each \
    channel, in s), or rename it if it is not a delay";
/// Remedy for internal delays, and for response delays that are not the sum of an input delay and
/// an output delay.
const APPROXIMATE: &str = "replace them by states first: in continuous time sys = pade(sys, 3), in \
    discrete time sys = absorbDelay(sys)";

/// Reason why a model or a record cannot be read, with the place among the variables.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FoundFault {
    /// Files with the model's matrices, or their common path without the matrix letters; empty if
    /// the model is in a single file.
    pub(crate) files: String,
    /// Path to the variable; empty if a file's variables together form the model.
    pub(crate) variable: String,
    /// Class name if the value is an object that could not be read.
    pub(crate) class: Option<String>,
    pub(crate) fault: RecognitionFault,
}

impl FoundFault {
    pub(crate) fn new(variable: &str, fault: RecognitionFault) -> Self {
        Self {
            files: String::new(),
            variable: variable.to_owned(),
            class: None,
            fault,
        }
    }
}

/// Returns the messages of the faults, for the user.
pub(crate) fn fault_messages(faults: Vec<FoundFault>) -> Vec<String> {
    faults.iter().map(ToString::to_string).collect()
}

impl Display for FoundFault {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        if !self.files.is_empty() {
            write!(out, "{}: ", self.files)?;
        }
        match &self.class {
            Some(class) => write!(out, "{} ({class}): ", self.variable)?,
            None if self.variable.is_empty() => {}
            None => write!(out, "{}: ", self.variable)?,
        }
        write!(out, "{}", self.fault)
    }
}

/// Reason why a model or a record cannot be read; the message contains its remedy. Field `name`
/// names the affected model field, such as "B".
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(crate) enum RecognitionFault {
    #[error("matrix {name} is missing; a model needs A, B and C")]
    MissingMatrix { name: &'static str },
    /// Matrices in separate files do not form a model.
    #[error("matrices are missing; a model needs A, B and C")]
    MissingMatrices,
    /// Two files hold the same matrix of a model.
    #[error(
        "matrix {name} is given twice, in {} and {}; remove or rename one",
        files[0], files[1]
    )]
    DuplicateMatrix { name: String, files: [String; 2] },
    /// Two of the given folders hold a file with the same name, for the same matrix.
    #[error(
        "matrix {name} is given twice, in {} and {}; give the folder that contains both instead, \
        so that each subfolder is a model",
        paths[0], paths[1]
    )]
    DuplicateFile { name: String, paths: [String; 2] },
    #[error("{name}: expected {expected}, found {found}")]
    Kind {
        name: String,
        expected: &'static str,
        /// Description of the found value.
        found: String,
    },
    #[error("{name}, row {row}, column {column}: expected a finite number, found {value}")]
    MatrixNotFinite {
        name: String,
        /// Row, from 1.
        row: usize,
        /// Column, from 1.
        column: usize,
        value: f64,
    },
    #[error("{name}, entry {entry}: expected a finite number, found {}", number(*value))]
    ListNotFinite {
        name: String,
        /// Entry, from 1.
        entry: usize,
        value: f64,
    },
    #[error(
        "{name}, entry {entry}: expected a finite imaginary part, found {}",
        number(*value)
    )]
    ImaginaryNotFinite {
        name: String,
        /// Entry, from 1.
        entry: usize,
        value: f64,
    },
    #[error(
        "{name}, frequency {frequency}: expected a finite number, found {}",
        number(*value)
    )]
    ResponseNotFinite {
        name: &'static str,
        /// Frequency index, from 1.
        frequency: usize,
        value: f64,
    },
    #[error("{name}: expected {expected} matrices as in A, found {found}")]
    PageCount {
        name: String,
        expected: usize,
        /// Description of the found value.
        found: String,
    },
    #[error("{place}: expected at most {MOST_STATES} {counted}, found {count}")]
    TooMany {
        place: String,
        count: usize,
        /// "states", "inputs", "outputs" or "channels".
        counted: &'static str,
    },
    #[error("A: expected a square matrix, found {rows} x {columns}")]
    NotSquare { rows: usize, columns: usize },
    #[error(
        "{name}: expected {} x {}, found {} x {}",
        expected[0], expected[1], found[0], found[1]
    )]
    MatrixShape {
        name: &'static str,
        /// Numbers of rows and columns.
        expected: [usize; 2],
        /// Numbers of rows and columns.
        found: [usize; 2],
    },
    #[error("E: expected {order} x {order}, like A, found {} x {}", found[0], found[1])]
    DescriptorShape {
        order: usize,
        /// Numbers of rows and columns.
        found: [usize; 2],
    },
    #[error(
        "E is singular{}; export the model without algebraic states (in MATLAB: sys = \
        ss(sys,'explicit'))",
        condition_words(*condition)
    )]
    SingularDescriptor {
        /// Condition number; infinite for a singular matrix, `None` if the factorisation failed.
        condition: Option<f64>,
    },
    #[error("expected numerators and denominators, or zeros, poles and gains; found neither")]
    NoTransferFunction,
    #[error("response {response}: {part} missing; give numbers for each response")]
    ResponseWithout {
        /// Response number, from 1.
        response: usize,
        /// "denominator", "poles" or "gain".
        part: &'static str,
    },
    #[error("{place}: the denominator is zero; correct it")]
    ZeroDenominator { place: String },
    #[error(
        "{place}: the numerator is of higher degree than the denominator, so that the response has \
        no state-space form; add poles above the band, or save a frequency response instead"
    )]
    Improper { place: String },
    #[error("real and imaginary parts have different dimensions; save both with the same")]
    PartsDiffer,
    #[error(
        "coherence: {} for the {expected} values of the response; write one for each output, input \
        and frequency, or leave the coherence out",
        counted(*found, "number")
    )]
    CoherenceCount { found: usize, expected: usize },
    #[error("{name}: can mean γ or γ²; save γ² under the name gamma2 or coherence")]
    Gamma { name: String },
    #[error(
        "the response: expected outputs x inputs x {frequencies} frequencies, found {}",
        shape_words(found)
    )]
    ResponseShape {
        frequencies: usize,
        /// Length along each dimension.
        found: Vec<usize>,
    },
    #[error("frequencies are missing; save them as omega_rad_s or f_hz")]
    NoFrequencies,
    #[error(
        "the frequencies have no unit; call them omega_rad_s or f_hz, or save \"rad/s\" or \"Hz\" as \
        frequency_unit"
    )]
    NoFrequencyUnit,
    #[error("frequencies are in \"{unit}\"; expected rad/s or Hz")]
    FrequencyUnit { unit: String },
    #[error("{name}: delay without a model; save it with A, B, C and D, as input_delays_s")]
    DelayWithoutModel { name: String },
    #[error(
        "{name}: a measured response must contain its delays; include them in it (in MATLAB: sys = \
        absorbDelay(sys)), or remove the field"
    )]
    DelayOfResponse { name: String },
    #[error(
        "{name} looks like a delay, but its name gives neither the delayed signals nor the unit: \
        {CHANNEL_DELAYS}"
    )]
    UnclearDelay { name: String },
    #[error("{name}: internal delays are not supported; {APPROXIMATE}")]
    InternalDelay { name: String },
    #[error("{name}: delays of single responses are given twice; remove one")]
    ResponseDelaysTwice { name: String },
    #[error("{name}: these delays are given twice, with different numbers; remove one")]
    ContradictoryDelays { name: String },
    #[error(
        "{name}: expected {}, one for each {side}, found {found}",
        counted(*expected, "delay")
    )]
    DelayCount {
        name: String,
        side: ChannelSide,
        expected: usize,
        found: usize,
    },
    #[error(
        "{name}, output {output}, input {input}: the delays of single responses are not the sum of \
        an output delay and an input delay; {APPROXIMATE}"
    )]
    NotASumOfDelays {
        name: String,
        /// Output number, from 1.
        output: usize,
        /// Input number, from 1.
        input: usize,
    },
    #[error(
        "{name}: expected a delay for each response, {outputs} x {inputs} (outputs x inputs), found \
        {found}; {CHANNEL_DELAYS}"
    )]
    ResponseDelayShape {
        name: String,
        outputs: usize,
        inputs: usize,
        /// Description of the found value.
        found: String,
    },
    #[error(
        "{name}: expected delays from 0 to {GREATEST_CHANNEL_DELAY_S} s, found {}",
        number(*value)
    )]
    DelayRange { name: String, value: f64 },
    #[error("{name}: {unit}; call it {}_s and give it in s", name.trim_end_matches('_'))]
    DelayUnit {
        name: String,
        unit: UnclearDelayUnit,
    },
    #[error(
        "the sample time is {} s: a discrete-time model without a known sample time cannot be \
        compared; set Ts",
        number(*.value)
    )]
    SampleTime { value: f64 },
    #[error("the sample time: expected a number, found {found}")]
    SampleTimeKind {
        /// Description of the found value.
        found: String,
    },
    #[error("its time unit is {unit}, not seconds; in MATLAB: sys = chgTimeUnit(sys, 'seconds')")]
    TimeUnit { unit: String },
    #[error(
        "{name}: contradictory values {} and {} for the same model; correct one",
        number(values[0]), number(values[1])
    )]
    Contradiction {
        name: &'static str,
        values: [f64; 2],
    },
    #[error(
        "{name}: {} for {}; write one for each",
        counted(*found, "number"),
        counted(*models, "model")
    )]
    NumberForEachModel {
        name: String,
        found: usize,
        models: usize,
    },
    #[error(
        "{name}: {found} entries for the {expected} {}s of the model; write one for each, in the \
        order of the matrices",
        side
    )]
    LabelCount {
        name: String,
        side: ChannelSide,
        found: usize,
        expected: usize,
    },
    #[error(
        "{name}: expected a list of channel names in the order of the matrices, such as [\"LON\", \"LAT\"], \
        found {found}"
    )]
    Labels {
        name: String,
        /// Description of the found value.
        found: String,
    },
    #[error(
        "{name}: its channels have no order or no names; write a list of names, or of {{\"name\": …, \
        \"unit\": …}}, in the order of the matrices"
    )]
    LabelOrder { name: String },
    /// Identification data in the frequency domain.
    #[error("frequency-domain data are not a record; save time-domain data")]
    FrequencyDomain,
    #[error(
        "its output data cannot be read; save time, inputs and outputs as the matrices t, u and y"
    )]
    NoOutputData,
    #[error(
        "its inputs and outputs have different numbers of samples; save the same samples of both"
    )]
    SampleCounts,
    /// There are more models than the search reads, or values are nested more deeply.
    #[error("too many values, or values nested too deeply; save the models as separate variables")]
    SearchLimit,
    /// A value that its format reader could not read.
    #[error("{0}")]
    Unread(Box<Unread>),
    /// The memory or the work limit is exhausted.
    #[error("{0}")]
    Variables(VariableFault),
}

/// Reason why a delay's unit is unclear.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub(crate) enum UnclearDelayUnit {
    #[error("in samples, but the model has no sample time")]
    SamplesOfContinuousModel,
    #[error(
        "MATLAB counts the delays of a discrete-time model in samples, but these are not whole \
        numbers"
    )]
    PartsOfSamples,
    #[error("can be seconds or samples of this discrete-time model")]
    SecondsOrSamples,
    #[error("{} can be seconds or milliseconds", number(*.greatest))]
    SecondsOrMilliseconds {
        /// Greatest delay, in the unclear unit.
        greatest: f64,
    },
}

fn condition_words(condition: Option<f64>) -> String {
    match condition {
        Some(condition) if condition.is_finite() => {
            format!(" (condition number {})", number(condition))
        }
        Some(_) => " (infinite condition number)".to_owned(),
        None => String::new(),
    }
}

fn shape_words(shape: &[usize]) -> String {
    let sides: Vec<String> = shape.iter().map(usize::to_string).collect();
    sides.join(" x ")
}
