//! A model in a bundle: its dynamics, and their origin and source.

use std::collections::BTreeMap;
use std::sync::Arc;

use sha2::{Digest, Sha256};

pub use super::content_hash::ContentHash;
pub use super::provenance::Provenance;
pub use super::uncertainty_bands::ModelBands;

use super::dynamics::Dynamics;
use super::state_space::StateSpace;

/// A model's origin: linearised at a trim, or identified.
#[derive(Clone, Debug, PartialEq)]
pub enum Origin {
    /// Physics model linearised at the condition's trim.
    Nominal {
        /// Trim offsets from the condition, by coordinate name; all zero, if given.
        perturbation: Option<BTreeMap<String, f64>>,
    },
    /// Physics model linearised at a perturbed trim.
    Perturbed {
        /// Trim offsets from the condition, by coordinate name ("airspeed_kt", "roll_deg").
        perturbation: Option<BTreeMap<String, f64>>,
    },
    /// Identified from flight tests.
    Identified {
        /// Identification method ("CT-PBSID").
        method: Option<String>,
        /// Order stated by the identification.
        order: Option<usize>,
    },
}

/// A physics model or an identified model: its dynamics, and their origin and source.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// Name, unique in its bundle.
    pub name: String,
    pub origin: Origin,
    pub dynamics: Dynamics,
    /// File, variable and flight records from which the model comes; `None` if unknown.
    pub source: Option<Provenance>,
    /// State names; empty if unknown.
    pub states: Arc<[String]>,
    /// Standard deviation of the response over frequency, if the identification gives it.
    pub bands: Option<Arc<ModelBands>>,
}

impl Model {
    /// Creates a model with a name, an origin and dynamics only.
    pub fn new(name: impl Into<String>, origin: Origin, dynamics: Dynamics) -> Self {
        Self {
            name: name.into(),
            origin,
            dynamics,
            source: None,
            states: Arc::default(),
            bands: None,
        }
    }

    /// Returns a state's name; if it has no name, its index counted from 1: "q", "state 5".
    pub fn state_name(&self, state: usize) -> String {
        self.states
            .get(state)
            .cloned()
            .unwrap_or_else(|| format!("state {}", state + 1))
    }

    /// Returns the matrices; `None` for a measured response.
    pub fn state_space(&self) -> Option<&StateSpace> {
        match &self.dynamics {
            Dynamics::StateSpace(model) => Some(model),
            Dynamics::Measured(_) => None,
        }
    }

    /// Returns whether this is the physics model at the condition's trim.
    pub fn is_nominal(&self) -> bool {
        matches!(self.origin, Origin::Nominal { .. })
    }

    /// Returns the trim offsets from the condition; `None` for an identified model, or if the file
    /// gives none.
    pub fn perturbation(&self) -> Option<&BTreeMap<String, f64>> {
        match &self.origin {
            Origin::Nominal { perturbation } | Origin::Perturbed { perturbation } => {
                perturbation.as_ref()
            }
            Origin::Identified { .. } => None,
        }
    }

    /// Returns a fingerprint that distinguishes models with the same name: 16 hexadecimal digits
    /// from a hash over dynamics, bands, trim, and whether the model is nominal.
    pub fn fingerprint(&self) -> String {
        let mut hash = Sha256::new();
        hash.update(ContentHash::new(&self.dynamics).bytes());
        hash.update([u8::from(self.is_nominal())]);
        for (coordinate, offset) in self.perturbation().into_iter().flatten() {
            hash.update(coordinate.as_bytes());
            hash.update(offset.to_le_bytes());
        }
        // Absent bands add nothing to the hash, so that fingerprints from before bands were
        // introduced remain valid.
        if let Some(bands) = &self.bands {
            bands.add_to(&mut hash);
        }
        hash.finalize()[..8]
            .iter()
            .map(|byte| format!("{byte:02x}"))
            .collect()
    }

    /// Returns a state-space model's state count. For measured data, returns the order stated by
    /// the identification, if any.
    pub fn order(&self) -> Option<usize> {
        match (&self.dynamics, &self.origin) {
            (Dynamics::StateSpace(model), _) => Some(model.order()),
            (Dynamics::Measured(_), Origin::Identified { order, .. }) => *order,
            (Dynamics::Measured(_), _) => None,
        }
    }
}
