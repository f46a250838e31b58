//! Checks a model draft: its matrices or measured response against the dataset's channels.
//!
//! 1. A model has either matrices or a measured response. Only an identified model can be measured,
//!    and a measured response has no timing: it includes the delays.
//! 2. The shapes of matrices and tables agree with the channel counts.
//! 3. An order stated by the identification, or a list of state names, that differs from the state
//!    count is a warning.
//!
//! *Valid bands* are frequency intervals of a measured response; *bands* alone are the uncertainty
//! bands of a model's response.

use std::sync::Arc;

use nalgebra::DMatrix;

use super::dataset_draft::{BandsDraft, ModelDraft, ResponseArray, ResponseDraft};
use super::draft_fault::{DraftError, DraftFault, DraftOddity, Warning};
use super::dynamics::Dynamics;
use super::location::Location;
use super::measured_response::MeasuredResponse;
use super::model::{Model, ModelBands, Origin};
use super::model_id::BundleKind;
use super::pair_table::{Pair, PairTable};
use super::state_space::{StateSpace, Timing};

/// Builder that checks models for a dataset with given channel counts.
pub(super) struct ModelBuilder {
    outputs: usize,
    inputs: usize,
    /// Warnings about all models built so far.
    pub warnings: Vec<Warning>,
}

impl ModelBuilder {
    /// Starts without warnings; models must have these channel counts.
    pub fn new(outputs: usize, inputs: usize) -> Self {
        Self {
            outputs,
            inputs,
            warnings: Vec::new(),
        }
    }

    /// Checks a model, and builds it from its draft: checks 1 and 2, then the warnings of check 3.
    ///
    /// # Errors
    /// The first fault, with its place.
    pub fn build(
        &mut self,
        place: Location,
        kind: BundleKind,
        draft: ModelDraft,
    ) -> Result<Model, DraftError> {
        // Checks 1 and 2.
        let dynamics = self.dynamics(&place, kind, draft.matrices, draft.timing, draft.response)?;
        // Check 3 for the order.
        self.check_order(&place, &dynamics, &draft.origin);
        // Check 2 for the uncertainty bands.
        let bands = match &draft.bands {
            Some(bands) => Some(Arc::new(self.bands(&place, bands)?)),
            None => None,
        };
        // Check 3 for the state names.
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
        let has_response = response.is_some();
        let fault = if has_response && kind == BundleKind::Physics {
            Some(DraftFault::MeasuredPhysics)
        } else if has_matrices && has_response {
            Some(DraftFault::BothDynamics)
        } else if !has_matrices && !has_response {
            Some(DraftFault::NoDynamics)
        } else if has_response && !timing.is_plain() {
            Some(DraftFault::TimedResponse)
        } else {
            None
        };
        if let Some(fault) = fault {
            return Err(DraftError::new(place.clone(), fault));
        }
        match response {
            Some(response) => Ok(Dynamics::Measured(self.measured(place, response)?)),
            None => Ok(Dynamics::StateSpace(
                self.state_space(place, matrices, timing)?,
            )),
        }
    }

    /// Adds a warning if the order stated by the identification differs from the state count of a
    /// state-space model.
    fn check_order(&mut self, place: &Location, dynamics: &Dynamics, origin: &Origin) {
        if let Dynamics::StateSpace(model) = dynamics
            && let Origin::Identified {
                order: Some(order), ..
            } = origin
            && model.order() != *order
        {
            let oddity = DraftOddity::Order {
                stated: *order,
                states: model.order(),
            };
            self.warnings.push(Warning {
                place: place.clone(),
                oddity,
            });
        }
    }

    /// Returns the state names if their count equals the order; otherwise no names. A warning is
    /// added if the model has both names and states; names for a measured response, which has no
    /// states, are dropped silently.
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
            let oddity = DraftOddity::StateNames {
                names: names.len(),
                states: order,
            };
            self.warnings.push(Warning { place, oddity });
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
        // Check D first, so that a wrong shape in D is not reported as a fault in B or C.
        if d.shape() != (p, m) {
            let fault = DraftFault::Shape {
                expected: format!("{p} x {m} (outputs x inputs)"),
                found: format!("{} x {}", d.nrows(), d.ncols()),
            };
            return Err(DraftError::new(place.at("matrix D"), fault));
        }
        // Files write B and C without states as empty lists: B then lacks its column count, and C
        // may have any empty shape.
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

    /// Builds the measured response, with its valid bands and estimation settings if given.
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
        let mut response = MeasuredResponse::new(draft.omega, &re, &im, coherence)
            .map_err(|error| DraftError::new(place.at("measured response"), error))?;
        if let Some(valid_bands) = &draft.valid_bands {
            let ends = TableDepth {
                count: 2,
                meaning: "first and last frequency",
            };
            let valid_bands = self.table(
                place,
                valid_bands,
                "measured response, valid_band_rad_s",
                ends,
            )?;
            response = response
                .with_valid_bands(valid_bands.map(|_, band| [band[0], band[1]]))
                .map_err(|error| DraftError::new(place.at("measured response"), error))?;
        }
        response
            .with_estimate(draft.estimate)
            .map_err(|error| DraftError::new(place.at("measured response"), error))
    }

    /// Builds the response's uncertainty bands.
    fn bands(&self, place: &Location, draft: &BandsDraft) -> Result<ModelBands, DraftError> {
        let depth = TableDepth::frequencies(&draft.omega);
        let sd_db = self.table(place, &draft.sd_db, "bands, sd_db", depth)?;
        let sd_deg = self.table(place, &draft.sd_deg, "bands, sd_deg", depth)?;
        ModelBands::new(draft.omega.clone(), sd_db, sd_deg)
            .map_err(|error| DraftError::new(place.at("bands"), error))
    }

    /// Checks a table's shape, and splits it into one value list per response.
    fn table(
        &self,
        place: &Location,
        array: &ResponseArray,
        table_name: &str,
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
            return Err(DraftError::new(place.at(table_name), fault));
        }
        Ok(PairTable::from_fn(
            self.outputs,
            self.inputs,
            |Pair { output, input }| {
                // The last index runs fastest: `count` values for each response.
                let start = (output * self.inputs + input) * count;
                array.values[start..start + count].to_vec()
            },
        ))
    }
}

/// Required length of a table along its third index: frequencies, or the two ends of valid bands.
#[derive(Clone, Copy)]
struct TableDepth {
    count: usize,
    /// Quantity counted by the third index, for messages: "frequencies".
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
