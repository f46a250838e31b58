//! Checks of a dataset draft; all faults are collected.

use std::sync::Arc;

use nalgebra::DMatrix;

use super::band::Band;
use super::channel::Channel;
use super::condition::Condition;
use super::dataset::{Dataset, DatasetHeader};
use super::dynamics::Dynamics;
use super::limits::{MOST_CHANNELS, MOST_CONDITIONS, MOST_MODELS, MOST_RECORDS};
use super::location::Location;
use super::measured_response::MeasuredResponse;
use super::model::{Model, ModelBands, Origin};
use super::model_id::BundleKind;
use super::pair_table::{Pair, PairTable};
use super::state_space::{StateSpace, Timing};
use super::unchecked_dataset::{
    BandsDraft, ConditionDraft, DatasetDraft, DraftError, DraftFault, ModelDraft, ResponseArray,
    ResponseDraft, Warning,
};
use crate::number_format::counted;

/// Maximum number of collected faults; a file of the wrong kind has a fault in every model.
const MOST_FAULTS: usize = 1000;

impl DatasetDraft {
    /// Checks the draft, and returns the dataset with any warnings.
    ///
    /// # Errors
    /// The first fault.
    pub fn checked(self) -> Result<(Dataset, Vec<Warning>), DraftError> {
        self.check_all().map_err(|mut faults| faults.swap_remove(0))
    }

    /// Returns every fault with its location, in the order of the draft; empty for a valid dataset.
    /// A fault can hide another: duplicate names, for example, are found only once all models are
    /// valid.
    pub fn faults(self) -> Vec<DraftError> {
        self.check_all().err().unwrap_or_default()
    }

    /// Runs all checks. The list of faults is never empty.
    fn check_all(self) -> Result<(Dataset, Vec<Warning>), Vec<DraftError>> {
        let mut checker = Checker::new(self.outputs.len(), self.inputs.len());
        let lists = [
            ("inputs", self.inputs.len(), MOST_CHANNELS),
            ("outputs", self.outputs.len(), MOST_CHANNELS),
            ("conditions", self.conditions.len(), MOST_CONDITIONS),
        ];
        for (list, found, most) in lists {
            checker.check_count(Location::entry(list), found, most);
        }
        let band = Band::new(self.band.0, self.band.1)
            .map_err(|error| DraftError::new(Location::default(), error));
        let band = checker.record_fault(band);
        let on_axis = on_axis_table(&self.outputs, &self.inputs, &self.on_axis);
        let on_axis = checker.record_fault(on_axis);
        let mut conditions = Vec::with_capacity(self.conditions.len());
        let drafts = self.conditions.into_iter().take(MOST_CONDITIONS);
        for (index, draft) in drafts.enumerate() {
            if checker.faults.len() >= MOST_FAULTS {
                break;
            }
            conditions.extend(checker.condition(index + 1, draft));
        }
        let (Some(band), Some(on_axis), true) = (band, on_axis, checker.faults.is_empty()) else {
            return Err(checker.faults);
        };
        let header = DatasetHeader {
            name: self.name,
            description: self.description,
            inputs: self.inputs,
            outputs: self.outputs,
            on_axis,
            band,
        };
        match Dataset::new(header, conditions) {
            Ok(dataset) => Ok((dataset, checker.warnings)),
            // `Location::default()`: the error itself names the list or the condition.
            Err(error) => Err(vec![DraftError::new(Location::default(), error)]),
        }
    }
}

impl Dataset {
    /// Checks a draft as an identified model with this dataset's channels, and returns it with any
    /// warnings.
    ///
    /// # Errors
    /// The first fault, with its location in the model.
    pub fn identified_model(&self, draft: ModelDraft) -> Result<(Model, Vec<Warning>), DraftError> {
        let mut checker = Checker::new(self.outputs().len(), self.inputs().len());
        let model = checker.model(Location::default(), BundleKind::Identified, draft)?;
        Ok((model, checker.warnings))
    }
}

/// Returns the table of on-axis responses, given by the names of output and input.
fn on_axis_table(
    outputs: &[Channel],
    inputs: &[Channel],
    pairs: &[(String, String)],
) -> Result<PairTable<bool>, DraftError> {
    let mut table = PairTable::filled(outputs.len(), inputs.len(), false);
    for (index, (output, input)) in pairs.iter().enumerate() {
        mark_on_axis(&mut table, outputs, inputs, output, input).map_err(|fault| {
            let place = Location::entry(format!("on-axis pair {}", index + 1));
            DraftError::new(place, fault)
        })?;
    }
    Ok(table)
}

fn mark_on_axis(
    table: &mut PairTable<bool>,
    outputs: &[Channel],
    inputs: &[Channel],
    output: &str,
    input: &str,
) -> Result<(), DraftFault> {
    let pair = Pair::new(
        find_channel("output", outputs, output)?,
        find_channel("input", inputs, input)?,
    );
    if table[pair] {
        return Err(DraftFault::DuplicatePair {
            output: output.to_owned(),
            input: input.to_owned(),
        });
    }
    table[pair] = true;
    Ok(())
}

fn find_channel(kind: &'static str, channels: &[Channel], name: &str) -> Result<usize, DraftFault> {
    channels
        .iter()
        .position(|channel| channel.name == name)
        .ok_or_else(|| DraftFault::UnknownChannel {
            kind,
            name: name.to_owned(),
        })
}

/// Channel counts of the dataset, with the faults and warnings found so far.
struct Checker {
    outputs: usize,
    inputs: usize,
    faults: Vec<DraftError>,
    warnings: Vec<Warning>,
}

/// Required length of a table of frequency data along its third index.
#[derive(Clone, Copy)]
struct TableDepth {
    count: usize,
    /// Meaning of the third index, for messages: "frequencies".
    meaning: &'static str,
}

impl TableDepth {
    fn frequencies(omega: &[f64]) -> Self {
        Self {
            count: omega.len(),
            meaning: "frequencies",
        }
    }
}

impl Checker {
    fn new(outputs: usize, inputs: usize) -> Self {
        Self {
            outputs,
            inputs,
            faults: Vec::new(),
            warnings: Vec::new(),
        }
    }

    /// Returns the checked value; otherwise stores the fault and returns `None`.
    fn record_fault<T>(&mut self, checked: Result<T, DraftError>) -> Option<T> {
        match checked {
            Ok(value) => Some(value),
            Err(fault) => {
                self.faults.push(fault);
                None
            }
        }
    }

    /// Returns whether a count is within its limit; adds a fault if not.
    fn check_count(&mut self, place: Location, found: usize, most: usize) -> bool {
        if found > most {
            self.faults
                .push(DraftError::new(place, DraftFault::TooMany { most, found }));
        }
        found <= most
    }

    /// Checks a condition; `position` counts from 1. Returns `None` if it has faults.
    fn condition(&mut self, position: usize, draft: ConditionDraft) -> Option<Condition> {
        let place = Location::condition(position, draft.flight_state.id.0);
        let before = self.faults.len();
        let physics = self.bundle(&place, BundleKind::Physics, draft.physics);
        let identified = self.bundle(&place, BundleKind::Identified, draft.identified);
        self.check_count(place.at("records"), draft.records.len(), MOST_RECORDS);
        if self.faults.len() > before {
            return None;
        }
        let condition = Condition::new(draft.flight_state, physics, identified)
            .and_then(|condition| condition.with_records(draft.records))
            .map_err(|error| DraftError::new(place, error));
        self.record_fault(condition)
    }

    /// Checks a bundle, and returns its valid models.
    fn bundle(
        &mut self,
        condition: &Location,
        kind: BundleKind,
        drafts: Vec<ModelDraft>,
    ) -> Vec<Model> {
        let list = condition.at(format!("{kind} models"));
        if !self.check_count(list, drafts.len(), MOST_MODELS) {
            return Vec::new();
        }
        let mut models = Vec::with_capacity(drafts.len());
        for (index, draft) in drafts.into_iter().enumerate() {
            let place = condition.model(kind, index + 1, &draft.name);
            let model = self.model(place, kind, draft);
            models.extend(self.record_fault(model));
        }
        models
    }

    /// Checks a model, and builds it from its draft.
    fn model(
        &mut self,
        place: Location,
        kind: BundleKind,
        draft: ModelDraft,
    ) -> Result<Model, DraftError> {
        let dynamics = self.dynamics(&place, kind, draft.matrices, draft.timing, draft.response)?;
        self.check_order(&place, &dynamics, &draft.origin);
        let bands = match &draft.bands {
            Some(bands) => Some(Arc::new(self.bands(&place, bands)?)),
            None => None,
        };
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

    /// Checks that a model has either matrices or a measured response, and builds its dynamics.
    fn dynamics(
        &self,
        place: &Location,
        kind: BundleKind,
        matrices: [Option<DMatrix<f64>>; 4],
        timing: Timing,
        response: Option<ResponseDraft>,
    ) -> Result<Dynamics, DraftError> {
        let has_matrices = matrices.iter().any(Option::is_some);
        let fault = match (has_matrices, response) {
            (_, Some(_)) if kind == BundleKind::Physics => DraftFault::MeasuredPhysics,
            (true, Some(_)) => DraftFault::BothDynamics,
            (false, None) => DraftFault::NoDynamics,
            (false, Some(_)) if !timing.is_plain() => DraftFault::TimedResponse,
            (true, None) => {
                let model = self.state_space(place, matrices, timing)?;
                return Ok(Dynamics::StateSpace(model));
            }
            (false, Some(response)) => {
                return Ok(Dynamics::Measured(self.measured(place, response)?));
            }
        };
        Err(DraftError::new(place.clone(), fault))
    }

    /// Adds a warning if the order stated by the identification differs from the state count.
    fn check_order(&mut self, place: &Location, dynamics: &Dynamics, origin: &Origin) {
        if let Dynamics::StateSpace(model) = dynamics
            && let Origin::Identified {
                order: Some(order), ..
            } = origin
            && model.order() != *order
        {
            let words = format!(
                "the stated order is {order}, but the matrices have {}",
                counted(model.order(), "state")
            );
            self.warnings.push(Warning {
                place: place.clone(),
                words,
            });
        }
    }

    /// Returns the state names; empty, with a warning, if their count differs from the order.
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
                "{} for {}; the names are ignored",
                counted(names.len(), "state name"),
                counted(order, "state")
            );
            self.warnings.push(Warning { place, words });
        }
        Arc::default()
    }

    /// Builds the state-space model from the matrices A, B, C and D, in this order.
    fn state_space(
        &self,
        place: &Location,
        matrices: [Option<DMatrix<f64>>; 4],
        timing: Timing,
    ) -> Result<StateSpace, DraftError> {
        let p = self.outputs;
        let m = self.inputs;
        let [a, b, c, d] = matrices;
        let a = required_matrix(place, 'A', a)?;
        let mut b = required_matrix(place, 'B', b)?;
        let mut c = required_matrix(place, 'C', c)?;
        let d = required_matrix(place, 'D', d)?;
        // Check D first, so that a wrong shape of D is not reported as a fault of B or C.
        if d.shape() != (p, m) {
            let fault = DraftFault::Shape {
                expected: format!("{p} x {m} (outputs x inputs)"),
                found: format!("{} x {}", d.nrows(), d.ncols()),
            };
            return Err(DraftError::new(place.at("matrix D"), fault));
        }
        // A file writes B without states as an empty list, which does not give the column count.
        if a.nrows() == 0 && b.nrows() == 0 {
            b = DMatrix::zeros(0, m);
        }
        if a.nrows() == 0 && c.is_empty() {
            c = DMatrix::zeros(p, 0);
        }
        StateSpace::new(a, b, c, d)
            .and_then(|model| model.timed(timing))
            .map_err(|error| DraftError::new(place.clone(), error))
    }

    fn measured(
        &self,
        place: &Location,
        draft: ResponseDraft,
    ) -> Result<MeasuredResponse, DraftError> {
        let depth = TableDepth::frequencies(&draft.omega);
        let re = self.table(place, &draft.re, "measured response, re", depth)?;
        let im = self.table(place, &draft.im, "measured response, im", depth)?;
        let coherence = match &draft.coherence {
            Some(array) => Some(self.table(place, array, "measured response, coherence", depth)?),
            None => None,
        };
        let bands = draft.valid_bands.as_ref();
        let mut response = MeasuredResponse::new(draft.omega, &re, &im, coherence)
            .map_err(|error| DraftError::new(place.at("measured response"), error))?;
        if let Some(bands) = bands {
            let ends = TableDepth {
                count: 2,
                meaning: "first and last frequency",
            };
            let bands = self.table(place, bands, "measured response, valid_band_rad_s", ends)?;
            response = response
                .with_valid_bands(bands.map(|_, band| [band[0], band[1]]))
                .map_err(|error| DraftError::new(place.at("measured response"), error))?;
        }
        response
            .with_estimate(draft.estimate)
            .map_err(|error| DraftError::new(place.at("measured response"), error))
    }

    fn bands(&self, place: &Location, draft: &BandsDraft) -> Result<ModelBands, DraftError> {
        let depth = TableDepth::frequencies(&draft.omega);
        let sd_db = self.table(place, &draft.sd_db, "bands, sd_db", depth)?;
        let sd_deg = self.table(place, &draft.sd_deg, "bands, sd_deg", depth)?;
        ModelBands::new(draft.omega.clone(), sd_db, sd_deg)
            .map_err(|error| DraftError::new(place.at("bands"), error))
    }

    /// Checks the shape of a table, and splits it into one list of values per response.
    fn table(
        &self,
        place: &Location,
        array: &ResponseArray,
        part: &str,
        depth: TableDepth,
    ) -> Result<PairTable<Vec<f64>>, DraftError> {
        let count = depth.count;
        let shape = [self.outputs, self.inputs, count];
        if array.shape != shape {
            let fault = DraftFault::Shape {
                expected: format!(
                    "{} (outputs x inputs x {})",
                    dimensions(shape),
                    depth.meaning
                ),
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

fn required_matrix(
    place: &Location,
    name: char,
    matrix: Option<DMatrix<f64>>,
) -> Result<DMatrix<f64>, DraftError> {
    matrix.ok_or_else(|| DraftError::new(place.clone(), DraftFault::MissingMatrix(name)))
}

/// Formats a shape: "6 x 4 x 200".
fn dimensions(shape: [usize; 3]) -> String {
    shape.map(|length| length.to_string()).join(" x ")
}
