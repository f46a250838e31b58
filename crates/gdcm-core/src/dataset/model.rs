//! One model of a bundle: where it comes from and how its response is known.

use std::collections::BTreeMap;
use std::sync::Arc;

use sha2::{Digest, Sha256};

use super::content::ContentHash;
use super::measured_response::MeasuredResponse;
use super::model_bands::ModelBands;
use super::state_space::StateSpace;

/// How the response of a model is known.
#[derive(Clone, Debug, PartialEq)]
pub enum Dynamics {
    /// By its matrices.
    StateSpace(StateSpace),
    /// By measured frequency data, interpolated (identified models only).
    Measured(MeasuredResponse),
}

impl Dynamics {
    /// `(p, m)`: the number of outputs and of inputs.
    pub fn shape(&self) -> (usize, usize) {
        match self {
            Dynamics::StateSpace(model) => (model.outputs(), model.inputs()),
            Dynamics::Measured(response) => (response.values().outputs(), response.values().inputs()),
        }
    }
}

/// Where a model comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum Origin {
    /// The physics model linearised at the trim of the condition itself.
    Nominal {
        /// Offsets of the trim from the condition's, by coordinate name (all zero, where given).
        perturbation: Option<BTreeMap<String, f64>>,
    },
    /// The physics model linearised at a perturbed trim.
    Perturbed {
        /// Offsets of the trim from the condition's, by coordinate name ("airspeed_kt", "roll_deg").
        perturbation: Option<BTreeMap<String, f64>>,
    },
    /// Identified from flight.
    Identified {
        /// Identification method ("CT-PBSID").
        method: Option<String>,
        /// Order the identification reports.
        order: Option<usize>,
    },
}

/// Which file a model was made from, as far as whoever made it says.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Provenance {
    /// The file, relative to the dataset's.
    pub file: Option<String>,
    /// SHA-256 of the file, in hexadecimal.
    pub sha256: Option<String>,
    /// The variable in it, or the flight record.
    pub variable: Option<String>,
    /// When the model was made, as the maker writes dates.
    pub made: Option<String>,
    /// What else the reader noted.
    pub note: Option<String>,
    /// Names of the flight records that an identified model was made of; none where they are not said.
    pub records: Vec<String>,
}

impl Provenance {
    /// The provenance in words: "models/roll+5.mat, variable sys, made 2026-03-01".
    pub fn words(&self) -> String {
        let named = |name: &str, value: &Option<String>| value.as_ref().map(|value| format!("{name}{value}"));
        let parts = [
            self.file.clone(),
            named("variable ", &self.variable),
            named("made ", &self.made),
            named("SHA-256 ", &self.sha256),
            (!self.records.is_empty()).then(|| format!("from the records {}", self.records.join(", "))),
            self.note.clone(),
        ];
        parts.into_iter().flatten().collect::<Vec<_>>().join(", ")
    }
}

/// One model of a bundle.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// Name, unique in its bundle.
    pub name: String,
    /// Where it comes from.
    pub origin: Origin,
    /// How its response is known.
    pub dynamics: Dynamics,
    /// Which file it was made from, where that is known.
    pub source: Option<Provenance>,
    /// Names of the states, one for each; none where they are not known.
    pub states: Arc<[String]>,
    /// How uncertain its response is, where the identification says so.
    pub bands: Option<Arc<ModelBands>>,
}

impl Model {
    /// A model of this name.
    pub fn new(name: impl Into<String>, origin: Origin, dynamics: Dynamics) -> Self {
        Self { name: name.into(), origin, dynamics, source: None, states: Arc::default(), bands: None }
    }

    /// The name of a state, or its number (from 1) where it has none: "q", "state 5".
    pub fn state_name(&self, state: usize) -> String {
        self.states.get(state).cloned().unwrap_or_else(|| format!("state {}", state + 1))
    }

    /// Whether this is the physics model at the condition's own trim.
    pub fn is_nominal(&self) -> bool {
        matches!(self.origin, Origin::Nominal { .. })
    }

    /// Offsets of the trim from the condition's, where the file gives them.
    pub fn perturbation(&self) -> Option<&BTreeMap<String, f64>> {
        match &self.origin {
            Origin::Nominal { perturbation } | Origin::Perturbed { perturbation } => perturbation.as_ref(),
            Origin::Identified { .. } => None,
        }
    }

    /// What tells this model from another of its name: its numbers, its bands, its role and its trim, as 16 hexadecimal digits.
    pub fn fingerprint(&self) -> String {
        let mut hash = Sha256::new();
        hash.update(ContentHash::of(&self.dynamics).bytes());
        hash.update([u8::from(self.is_nominal())]);
        for (coordinate, offset) in self.perturbation().into_iter().flatten() {
            hash.update(coordinate.as_bytes());
            hash.update(offset.to_le_bytes());
        }
        // Nothing is added where there are none: most models keep the fingerprint that they always had.
        if let Some(bands) = &self.bands {
            bands.add_to(&mut hash);
        }
        hash.finalize()[..8].iter().map(|byte| format!("{byte:02x}")).collect()
    }

    /// Number of states, or the order the identification reports; none for measured data without one.
    pub fn order(&self) -> Option<usize> {
        match (&self.dynamics, &self.origin) {
            (Dynamics::StateSpace(model), _) => Some(model.order()),
            (Dynamics::Measured(_), Origin::Identified { order, .. }) => *order,
            (Dynamics::Measured(_), _) => None,
        }
    }
}
