//! A dataset before its checks, filled by any reader from any format; and the checks, which stop at
//! the first fault or collect all of them.

use std::sync::Arc;

use nalgebra::{Complex, DMatrix};

use super::channel::{BundleKind, Channel, Location, Pair, PairTable};
use super::condition::{Condition, ConditionError, ConditionRecord, FlightState};
use super::dataset::{Band, BandError, Dataset, DatasetError, DatasetHeader};
use super::limits::{MOST_CHANNELS, MOST_CONDITIONS, MOST_MODELS, MOST_RECORDS};
use super::measured_response::{Estimate, MeasuredResponse, MeasuredResponseError};
use super::model::{Dynamics, Model, ModelBands, Origin, Provenance};
use super::state_space::{StateSpace, StateSpaceError, Timing};

/// A table with one number per response and frequency, `[output][input][frequency]`, the last index
/// running fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct ResponseArray {
    /// Number of outputs, inputs and frequencies.
    pub shape: [usize; 3],
    pub values: Vec<f64>,
}

/// A measured frequency response, unchecked.
#[derive(Clone, Debug, PartialEq)]
pub struct ResponseDraft {
    /// Frequencies \[rad/s\].
    pub omega: Vec<f64>,
    pub re: ResponseArray,
    pub im: ResponseArray,
    /// Coherence, where given.
    pub coherence: Option<ResponseArray>,
    /// First and last trusted frequency of each response \[rad/s\], where given.
    pub valid_bands: Option<ResponseArray>,
    pub estimate: Estimate,
}

/// Standard deviations of a model's response, unchecked.
#[derive(Clone, Debug, PartialEq)]
pub struct BandsDraft {
    /// Frequencies \[rad/s\].
    pub omega: Vec<f64>,
    /// Standard deviation of the magnitudes \[dB\].
    pub sd_db: ResponseArray,
    /// Standard deviation of the phases \[deg\].
    pub sd_deg: ResponseArray,
}

/// One model, unchecked.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelDraft {
    pub name: String,
    pub origin: Origin,
    /// Matrices A, B, C, D, each where given.
    pub matrices: [Option<DMatrix<f64>>; 4],
    /// Sample time and delays, where given.
    pub timing: Timing,
    /// Measured response, where given.
    pub response: Option<ResponseDraft>,
    /// Source file.
    pub source: Option<Provenance>,
    /// Names of the states, for display; empty where unknown.
    pub states: Vec<String>,
    /// Uncertainty of its response, where given.
    pub bands: Option<BandsDraft>,
}

impl ResponseArray {
    /// Converts a table with equally many numbers for every response.
    fn of<V: AsRef<[f64]>>(table: &PairTable<V>) -> Self {
        let length = table
            .iter()
            .next()
            .map_or(0, |(_, values)| values.as_ref().len());
        let values = table
            .iter()
            .flat_map(|(_, values)| values.as_ref().iter().copied())
            .collect();
        Self {
            shape: [table.outputs(), table.inputs(), length],
            values,
        }
    }
}

impl ModelDraft {
    /// Converts a model to a draft, for writing or merging.
    pub fn of(model: &Model) -> Self {
        let (matrices, timing, response) = match &model.dynamics {
            Dynamics::StateSpace(system) => {
                let matrices = [system.a(), system.b(), system.c(), system.d()]
                    .map(|matrix| Some(matrix.clone()));
                (matrices, system.timing().clone(), None)
            }
            Dynamics::Measured(response) => {
                let part = |of: fn(&Complex<f64>) -> f64| {
                    ResponseArray::of(
                        &response
                            .values()
                            .map(|_, values| values.iter().map(of).collect::<Vec<f64>>()),
                    )
                };
                let draft = ResponseDraft {
                    omega: response.omega().to_vec(),
                    re: part(|value| value.re),
                    im: part(|value| value.im),
                    coherence: response.coherence().map(ResponseArray::of),
                    valid_bands: response.valid_bands().map(ResponseArray::of),
                    estimate: response.estimate(),
                };
                ([None, None, None, None], Timing::default(), Some(draft))
            }
        };
        let bands = model.bands.as_deref().map(|bands| BandsDraft {
            omega: bands.omega().to_vec(),
            sd_db: ResponseArray::of(bands.sd_db()),
            sd_deg: ResponseArray::of(bands.sd_deg()),
        });
        Self {
            name: model.name.clone(),
            origin: model.origin.clone(),
            matrices,
            timing,
            response,
            source: model.source.clone(),
            states: model.states.to_vec(),
            bands,
        }
    }
}

/// One flight condition, unchecked.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionDraft {
    pub flight_state: FlightState,
    pub physics: Vec<ModelDraft>,
    pub identified: Vec<ModelDraft>,
    pub records: Vec<ConditionRecord>,
}

/// A dataset, unchecked.
#[derive(Clone, Debug, PartialEq)]
pub struct DatasetDraft {
    pub name: String,
    /// Content and source of the data.
    pub description: String,
    pub inputs: Vec<Channel>,
    pub outputs: Vec<Channel>,
    /// On-axis responses: output, input.
    pub on_axis: Vec<(String, String)>,
    /// Lower and upper end of the default band \[rad/s\].
    pub band: (f64, f64),
    pub conditions: Vec<ConditionDraft>,
}

/// A fault in a draft.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DraftFault {
    /// A list exceeds its limit.
    #[error("expected at most {most} entries, found {found}")]
    TooMany {
        /// The limit.
        most: usize,
        /// The number of entries.
        found: usize,
    },
    /// A table does not have the shape required by the channels or the states.
    #[error("expected {expected}, found {found}")]
    Shape {
        /// The shape required, in words.
        expected: String,
        /// The shape found, in words.
        found: String,
    },
    /// A pair names a channel that the dataset does not have.
    #[error("the dataset has no {kind} \"{name}\"; a pair is written [output, input]")]
    UnknownChannel {
        /// "output" or "input".
        kind: &'static str,
        name: String,
    },
    /// A pair appears twice in a list.
    #[error("the pair [\"{output}\", \"{input}\"] stands twice; remove one")]
    DuplicatePair {
        /// Name of the output.
        output: String,
        input: String,
    },
    /// A model has some matrices, but not all four.
    #[error("matrix {0} is missing; a model needs A, B, C and D")]
    MissingMatrix(char),
    /// A model has both matrices and frequency data.
    #[error("both matrices and a measured response are given; keep one of them")]
    BothDynamics,
    /// A model has neither matrices nor frequency data.
    #[error("neither matrices A, B, C, D nor a measured response is given; add one of them")]
    NoDynamics,
    /// Frequency data have a sample time or delays.
    #[error(
        "a measured response has its delays in it: take out sample_time_s, input_delays_s and output_delays_s, which go with \
         matrices A, B, C, D"
    )]
    TimedResponse,
    /// A physics model is given by frequency data.
    #[error(
        "a physics model needs matrices A, B, C, D; a measured response is for identified models"
    )]
    MeasuredPhysics,
    /// The ends of the band are invalid.
    #[error(transparent)]
    Band(#[from] BandError),
    /// The matrices do not form a state-space model.
    #[error(transparent)]
    StateSpace(#[from] StateSpaceError),
    /// The frequency data do not form a response.
    #[error(transparent)]
    MeasuredResponse(#[from] MeasuredResponseError),
    /// The models do not form a condition.
    #[error(transparent)]
    Condition(#[from] ConditionError),
    /// The conditions do not form a dataset.
    #[error(transparent)]
    Dataset(#[from] DatasetError),
}

/// A fault in a draft, with its location. Boxed, so that results, which are mostly successful, stay
/// small.
#[derive(Clone, Debug, PartialEq)]
pub struct DraftError {
    pub place: Box<Location>,
    pub fault: Box<DraftFault>,
}

impl DraftError {
    pub(super) fn new(place: Location, fault: impl Into<DraftFault>) -> Self {
        Self {
            place: Box::new(place),
            fault: Box::new(fault.into()),
        }
    }
}

/// An unusual but harmless property of a draft.
#[derive(Clone, Debug, PartialEq)]
pub struct Warning {
    pub place: Location,
    /// Description.
    pub words: String,
}

/// Maximum number of faults collected: a file of the wrong kind has one in every model.
const MOST_FAULTS: usize = 1000;

impl DatasetDraft {
    /// Checks the draft, and returns the dataset with warnings.
    ///
    /// # Errors
    /// The first fault.
    pub fn checked(self) -> Result<(Dataset, Vec<Warning>), DraftError> {
        self.checked_whole()
            .map_err(|mut faults| faults.swap_remove(0))
    }

    /// Returns every fault with its location, in the order of the draft; empty where the draft is a
    /// valid dataset. A fault hidden by another, such as a duplicate name beside invalid models,
    /// appears after the other is repaired.
    pub fn faults(self) -> Vec<DraftError> {
        self.checked_whole().err().unwrap_or_default()
    }

    /// Runs all checks; an error holds at least one fault.
    fn checked_whole(self) -> Result<(Dataset, Vec<Warning>), Vec<DraftError>> {
        let whole = |error: DraftFault| DraftError::new(Location::default(), error);
        let mut checker = Checker {
            outputs: self.outputs.len(),
            inputs: self.inputs.len(),
            ..Checker::default()
        };
        checker.count(Location::entry("inputs"), self.inputs.len(), MOST_CHANNELS);
        checker.count(
            Location::entry("outputs"),
            self.outputs.len(),
            MOST_CHANNELS,
        );
        checker.count(
            Location::entry("conditions"),
            self.conditions.len(),
            MOST_CONDITIONS,
        );
        let band =
            checker.keep(Band::new(self.band.0, self.band.1).map_err(|error| whole(error.into())));
        let on_axis = checker.keep(on_axis_table(&self.outputs, &self.inputs, &self.on_axis));
        let mut conditions = Vec::with_capacity(self.conditions.len());
        for (index, draft) in self
            .conditions
            .into_iter()
            .enumerate()
            .take(MOST_CONDITIONS)
        {
            if checker.faults.len() >= MOST_FAULTS {
                break;
            }
            conditions.extend(checker.condition(index + 1, draft));
        }
        let (Some(band), Some(on_axis), true) = (band, on_axis, checker.faults.is_empty()) else {
            return Err(checker.faults);
        };
        let Self {
            name,
            description,
            inputs,
            outputs,
            ..
        } = self;
        let header = DatasetHeader {
            name,
            description,
            inputs,
            outputs,
            on_axis,
            band,
        };
        // These errors name the list or the condition themselves.
        let dataset =
            Dataset::new(header, conditions).map_err(|error| vec![whole(error.into())])?;
        Ok((dataset, checker.warnings))
    }
}

fn on_axis_table(
    outputs: &[Channel],
    inputs: &[Channel],
    pairs: &[(String, String)],
) -> Result<PairTable<bool>, DraftError> {
    let mut table = PairTable::filled(outputs.len(), inputs.len(), false);
    for (index, (output, input)) in pairs.iter().enumerate() {
        let wrong = |fault| {
            DraftError::new(
                Location::entry(format!("on-axis pair {}", index + 1)),
                fault,
            )
        };
        let find = |channels: &[Channel], kind: &'static str, name: &String| {
            let found = channels.iter().position(|channel| channel.name == *name);
            found.ok_or_else(|| {
                wrong(DraftFault::UnknownChannel {
                    kind,
                    name: name.clone(),
                })
            })
        };
        let pair = Pair::new(
            find(outputs, "output", output)?,
            find(inputs, "input", input)?,
        );
        if std::mem::replace(&mut table[pair], true) {
            return Err(wrong(DraftFault::DuplicatePair {
                output: output.clone(),
                input: input.clone(),
            }));
        }
    }
    Ok(table)
}

impl Dataset {
    /// Checks a draft as an identified model with this dataset's channels, and returns it with
    /// warnings.
    ///
    /// # Errors
    /// The fault that keeps the draft from being a model of the dataset, with its location in the
    /// model.
    pub fn identified_model(&self, draft: ModelDraft) -> Result<(Model, Vec<Warning>), DraftError> {
        let outputs = self.outputs().len();
        let inputs = self.inputs().len();
        let mut checker = Checker {
            outputs,
            inputs,
            ..Checker::default()
        };
        let model = checker.model(Location::default(), BundleKind::Identified, draft)?;
        Ok((model, checker.warnings))
    }
}

/// Context and findings of the model checks.
#[derive(Default)]
struct Checker {
    outputs: usize,
    inputs: usize,
    faults: Vec<DraftError>,
    warnings: Vec<Warning>,
}

impl Checker {
    /// Records a fault, if there is one.
    fn keep<T>(&mut self, checked: Result<T, DraftError>) -> Option<T> {
        checked.map_err(|fault| self.faults.push(fault)).ok()
    }

    /// Checks a list against its limit.
    fn count(&mut self, place: Location, found: usize, most: usize) -> bool {
        if found > most {
            self.faults
                .push(DraftError::new(place, DraftFault::TooMany { most, found }));
        }
        found <= most
    }

    /// Checks the draft of a condition; returns `None` where it has faults.
    fn condition(&mut self, position: usize, draft: ConditionDraft) -> Option<Condition> {
        let place = Location::condition(position, draft.flight_state.id.0);
        let before = self.faults.len();
        let physics = self.bundle(&place, BundleKind::Physics, draft.physics);
        let identified = self.bundle(&place, BundleKind::Identified, draft.identified);
        self.count(place.at("records"), draft.records.len(), MOST_RECORDS);
        if self.faults.len() > before {
            return None;
        }
        let condition = Condition::new(draft.flight_state, physics, identified);
        let condition = condition.and_then(|condition| condition.with_records(draft.records));
        self.keep(condition.map_err(|error| DraftError::new(place, error)))
    }

    fn bundle(
        &mut self,
        condition: &Location,
        kind: BundleKind,
        drafts: Vec<ModelDraft>,
    ) -> Vec<Model> {
        if !self.count(
            condition.at(format!("{kind} models")),
            drafts.len(),
            MOST_MODELS,
        ) {
            return Vec::new();
        }
        let mut models = Vec::with_capacity(drafts.len());
        for (index, draft) in drafts.into_iter().enumerate() {
            let model = self.model(condition.model(kind, index + 1, &draft.name), kind, draft);
            models.extend(self.keep(model));
        }
        models
    }

    /// Checks the draft of a model at a location.
    fn model(
        &mut self,
        place: Location,
        kind: BundleKind,
        draft: ModelDraft,
    ) -> Result<Model, DraftError> {
        let has_matrices = draft.matrices.iter().any(Option::is_some);
        let dynamics = match (has_matrices, draft.response) {
            (_, Some(_)) if kind == BundleKind::Physics => {
                return Err(DraftError::new(place, DraftFault::MeasuredPhysics));
            }
            (true, Some(_)) => return Err(DraftError::new(place, DraftFault::BothDynamics)),
            (false, None) => return Err(DraftError::new(place, DraftFault::NoDynamics)),
            (false, Some(_)) if !draft.timing.is_plain() => {
                return Err(DraftError::new(place, DraftFault::TimedResponse));
            }
            (true, None) => {
                Dynamics::StateSpace(self.state_space(&place, draft.matrices, draft.timing)?)
            }
            (false, Some(response)) => Dynamics::Measured(self.measured(&place, response)?),
        };
        if let (
            Dynamics::StateSpace(model),
            Origin::Identified {
                order: Some(order), ..
            },
        ) = (&dynamics, &draft.origin)
            && model.order() != *order
        {
            let words = format!(
                "order says {order}, the matrices have {} states",
                model.order()
            );
            self.warnings.push(Warning {
                place: place.clone(),
                words,
            });
        }
        let bands = draft
            .bands
            .as_ref()
            .map(|bands| self.bands(&place, bands))
            .transpose()?
            .map(Arc::new);
        let states = self.state_names(place, &dynamics, draft.states);
        Ok(Model {
            name: draft.name,
            origin: draft.origin,
            dynamics,
            source: draft.source,
            states,
            bands,
        })
    }

    /// Checks that there is one name per state.
    fn state_names(
        &mut self,
        place: Location,
        dynamics: &Dynamics,
        names: Vec<String>,
    ) -> Arc<[String]> {
        let order = match dynamics {
            Dynamics::StateSpace(model) => model.order(),
            Dynamics::Measured(_) => 0,
        };
        if names.len() == order {
            return names.into();
        }
        if order > 0 && !names.is_empty() {
            let words = format!(
                "{} names for {order} states: they are left out",
                names.len()
            );
            self.warnings.push(Warning { place, words });
        }
        Arc::default()
    }

    /// Builds the state-space model from four matrices, with `p` outputs and `m` inputs.
    fn state_space(
        &self,
        place: &Location,
        matrices: [Option<DMatrix<f64>>; 4],
        timing: Timing,
    ) -> Result<StateSpace, DraftError> {
        let p = self.outputs;
        let m = self.inputs;
        let [a, b, c, d] = matrices;
        let given = |matrix: char, of: Option<DMatrix<f64>>| {
            of.ok_or_else(|| DraftError::new(place.clone(), DraftFault::MissingMatrix(matrix)))
        };
        let a = given('A', a)?;
        let b = given('B', b)?;
        let c = given('C', c)?;
        let d = given('D', d)?;
        // Checked first, so that the other matrices are not blamed for its shape.
        if d.shape() != (p, m) {
            let fault = DraftFault::Shape {
                expected: format!("{p} x {m} (outputs x inputs)"),
                found: format!("{} x {}", d.nrows(), d.ncols()),
            };
            return Err(DraftError::new(place.at("matrix D"), fault));
        }
        // An empty list does not give the length of its rows.
        let stateless = a.nrows() == 0;
        let b = if stateless && b.nrows() == 0 {
            DMatrix::zeros(0, m)
        } else {
            b
        };
        let c = if stateless && c.is_empty() {
            DMatrix::zeros(p, 0)
        } else {
            c
        };
        let model = StateSpace::new(a, b, c, d).and_then(|model| model.timed(timing));
        model.map_err(|error| DraftError::new(place.clone(), error))
    }

    fn measured(
        &self,
        place: &Location,
        draft: ResponseDraft,
    ) -> Result<MeasuredResponse, DraftError> {
        let count = draft.omega.len();
        let table = |array: &ResponseArray, part: &str| {
            self.table(
                place,
                array,
                &format!("measured response, {part}"),
                (count, "frequencies"),
            )
        };
        let re = table(&draft.re, "re")?;
        let im = table(&draft.im, "im")?;
        let coherence = draft
            .coherence
            .as_ref()
            .map(|array| table(array, "coherence"))
            .transpose()?;
        let wrong = |error| DraftError::new(place.at("measured response"), error);
        let response = MeasuredResponse::new(draft.omega, &re, &im, coherence).map_err(wrong)?;
        let response = match &draft.valid_bands {
            None => response,
            Some(array) => {
                let bands = self.table(
                    place,
                    array,
                    "measured response, valid_band_rad_s",
                    (2, "first and last frequency"),
                )?;
                response
                    .with_valid_bands(bands.map(|_, band| [band[0], band[1]]))
                    .map_err(wrong)?
            }
        };
        response.with_estimate(draft.estimate).map_err(wrong)
    }

    fn bands(&self, place: &Location, draft: &BandsDraft) -> Result<ModelBands, DraftError> {
        let count = draft.omega.len();
        let table = |array, part: &str| {
            self.table(
                place,
                array,
                &format!("bands, {part}"),
                (count, "frequencies"),
            )
        };
        let sd_db = table(&draft.sd_db, "sd_db")?;
        let sd_deg = table(&draft.sd_deg, "sd_deg")?;
        let bands = ModelBands::new(draft.omega.clone(), sd_db, sd_deg);
        bands.map_err(|error| DraftError::new(place.at("bands"), error))
    }

    /// Converts a table of frequency data with `count` numbers per pair.
    fn table(
        &self,
        place: &Location,
        array: &ResponseArray,
        part: &str,
        (count, of): (usize, &str),
    ) -> Result<PairTable<Vec<f64>>, DraftError> {
        let shape = [self.outputs, self.inputs, count];
        if array.shape != shape {
            let fault = DraftFault::Shape {
                expected: format!("{} (outputs x inputs x {of})", dimensions(shape)),
                found: dimensions(array.shape),
            };
            return Err(DraftError::new(place.at(part), fault));
        }
        Ok(PairTable::from_fn(
            self.outputs,
            self.inputs,
            |Pair { output, input }| {
                let start = (output * self.inputs + input) * count;
                array.values[start..start + count].to_vec()
            },
        ))
    }
}

fn dimensions(shape: [usize; 3]) -> String {
    shape.map(|length| length.to_string()).join(" x ")
}
