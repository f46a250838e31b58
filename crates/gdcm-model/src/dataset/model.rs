//! A model of a bundle: its origin, dynamics, uncertainty and content hash.

use std::collections::BTreeMap;
use std::sync::Arc;

use sha2::{Digest, Sha256};

use super::channel::ChannelSide;
use super::measured_response::{
    MeasuredResponse, MeasuredResponseError, check_frequencies, check_values,
};
use super::pair_table::PairTable;
use super::state_space::{StateSpace, Timing};

/// Dynamics of a model: matrices or measured data.
#[derive(Clone, Debug, PartialEq)]
pub enum Dynamics {
    StateSpace(StateSpace),
    /// Measured frequency response (identified models only), interpolated between its frequencies.
    Measured(MeasuredResponse),
}

impl Dynamics {
    /// Returns the output count `p` and the input count `m`.
    pub fn shape(&self) -> (usize, usize) {
        match self {
            Dynamics::StateSpace(model) => (model.outputs(), model.inputs()),
            Dynamics::Measured(response) => {
                (response.values().outputs(), response.values().inputs())
            }
        }
    }
}

/// Origin of a model: linearised at a trim, or identified.
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

/// Source of a model, as far as its author gives it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Provenance {
    /// Path relative to the dataset's file.
    pub file: Option<String>,
    /// SHA-256 of the file, in hexadecimal.
    pub sha256: Option<String>,
    /// Variable in the file, or flight record.
    pub variable: Option<String>,
    /// Creation date, in any format.
    pub made: Option<String>,
    /// Notes added when the file was read.
    pub note: Option<String>,
    /// Names of the flight records from which an identified model was estimated; empty if unknown.
    pub records: Vec<String>,
    /// Unused variables of the file; listed only in the first model of each file.
    pub unused: Vec<String>,
    /// Sides (inputs, outputs) whose channels have no names in the file and were matched by
    /// position.
    pub by_position: Vec<ChannelSide>,
}

impl Provenance {
    /// Describes the provenance: "models/roll+5.mat, variable sys, made 2026-03-01".
    pub fn words(&self) -> String {
        let mut parts: Vec<String> = Vec::new();
        parts.extend(self.file.clone());
        parts.extend(
            self.variable
                .as_ref()
                .map(|name| format!("variable {name}")),
        );
        parts.extend(self.made.as_ref().map(|date| format!("made {date}")));
        parts.extend(self.sha256.as_ref().map(|hash| format!("SHA-256 {hash}")));
        if !self.records.is_empty() {
            parts.push(format!("from the records {}", self.records.join(", ")));
        }
        parts.extend(self.note.clone());
        if !self.unused.is_empty() {
            parts.push(format!("not used: {}", self.unused.join(", ")));
        }
        parts.join(", ")
    }
}

/// A physics model or an identified model: its dynamics, and their origin and source.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// Name, unique in its bundle.
    pub name: String,
    pub origin: Origin,
    pub dynamics: Dynamics,
    /// Source file; `None` if unknown.
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

    /// Returns the name of a state; if it has no name, its index counted from 1: "q", "state 5".
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
    /// from a hash over dynamics, bands, role and trim.
    pub fn fingerprint(&self) -> String {
        let mut hash = Sha256::new();
        hash.update(ContentHash::new(&self.dynamics).bytes());
        hash.update([u8::from(self.is_nominal())]);
        for (coordinate, offset) in self.perturbation().into_iter().flatten() {
            hash.update(coordinate.as_bytes());
            hash.update(offset.to_le_bytes());
        }
        // Absent bands add nothing to the hash, so that fingerprints from before the introduction
        // of bands remain valid.
        if let Some(bands) = &self.bands {
            bands.add_to(&mut hash);
        }
        hash.finalize()[..8]
            .iter()
            .map(|byte| format!("{byte:02x}"))
            .collect()
    }

    /// Returns the state count of a state-space model. For measured data, returns the order stated
    /// by the identification, if any.
    pub fn order(&self) -> Option<usize> {
        match (&self.dynamics, &self.origin) {
            (Dynamics::StateSpace(model), _) => Some(model.order()),
            (Dynamics::Measured(_), Origin::Identified { order, .. }) => *order,
            (Dynamics::Measured(_), _) => None,
        }
    }
}

/// Standard deviation of a model's response over frequency, as estimated by the identification
/// (M14).
///
/// The true magnitude lies between `H_dB - z sd_db` and `H_dB + z sd_db` with probability
/// `1 - 2 Phi(-z)` at each frequency; likewise the phase.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelBands {
    omega: Vec<f64>,
    sd_db: PairTable<Vec<f64>>,
    sd_deg: PairTable<Vec<f64>>,
}

impl ModelBands {
    /// Creates bands from the standard deviations of magnitude \[dB\] and phase \[deg\] at `omega`
    /// \[rad/s\], both p x m tables with `N` values per response.
    ///
    /// # Errors
    /// Frequencies that do not rise, tables of the wrong length, or standard deviations that are
    /// negative or not finite.
    pub fn new(
        omega: Vec<f64>,
        sd_db: PairTable<Vec<f64>>,
        sd_deg: PairTable<Vec<f64>>,
    ) -> Result<Self, MeasuredResponseError> {
        check_frequencies(&omega)?;
        for (array, table) in [("sd_db", &sd_db), ("sd_deg", &sd_deg)] {
            check_values(
                array,
                table,
                omega.len(),
                "a number not below zero",
                |value| value.is_finite() && value >= 0.0,
            )?;
        }
        Ok(Self {
            omega,
            sd_db,
            sd_deg,
        })
    }

    /// Returns the frequencies \[rad/s\], strictly rising.
    pub fn omega(&self) -> &[f64] {
        &self.omega
    }

    /// Returns the standard deviation of the magnitude \[dB\] at each frequency.
    pub fn sd_db(&self) -> &PairTable<Vec<f64>> {
        &self.sd_db
    }

    /// Returns the standard deviation of the phase \[deg\] at each frequency.
    pub fn sd_deg(&self) -> &PairTable<Vec<f64>> {
        &self.sd_deg
    }

    /// Adds frequencies and standard deviations to a hash.
    pub(super) fn add_to(&self, hash: &mut Sha256) {
        hash.update(b"bands");
        add_numbers(hash, &self.omega);
        for table in [&self.sd_db, &self.sd_deg] {
            for (_, deviations) in table.iter() {
                add_numbers(hash, deviations);
            }
        }
    }
}

/// SHA-256 over all values that determine a model's response: equal hashes mean equal responses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ContentHash([u8; 32]);

impl ContentHash {
    /// Computes the hash over matrices and timing, or over measured frequencies, values, coherence
    /// and valid bands; their shapes are included.
    pub fn new(dynamics: &Dynamics) -> Self {
        let mut hash = Sha256::new();
        match dynamics {
            Dynamics::StateSpace(model) => add_state_space(&mut hash, model),
            Dynamics::Measured(response) => add_measured(&mut hash, response),
        }
        Self(hash.finalize().into())
    }

    /// Returns the 32 bytes of the hash.
    pub fn bytes(&self) -> &[u8; 32] {
        &self.0
    }
}

/// Adds the count of values, then the values, to a hash.
pub(super) fn add_numbers(hash: &mut Sha256, numbers: &[f64]) {
    hash.update((numbers.len() as u64).to_le_bytes());
    let bytes: Vec<u8> = numbers
        .iter()
        .flat_map(|number| number.to_le_bytes())
        .collect();
    hash.update(&bytes);
}

fn add_state_space(hash: &mut Sha256, model: &StateSpace) {
    hash.update(b"state space");
    for matrix in [model.a(), model.b(), model.c(), model.d()] {
        hash.update((matrix.nrows() as u64).to_le_bytes());
        add_numbers(hash, matrix.as_slice());
    }
    // A plain timing adds nothing to the hash, so that hashes from before the introduction of
    // timing remain valid.
    if !model.timing().is_plain() {
        let Timing {
            sample_time_s,
            input_delays_s,
            output_delays_s,
        } = model.timing();
        hash.update(b"timing");
        add_numbers(hash, sample_time_s.as_slice());
        add_numbers(hash, input_delays_s.as_deref().unwrap_or_default());
        add_numbers(hash, output_delays_s.as_deref().unwrap_or_default());
    }
}

fn add_measured(hash: &mut Sha256, response: &MeasuredResponse) {
    hash.update(b"measured");
    add_numbers(hash, response.omega());
    hash.update((response.values().outputs() as u64).to_le_bytes());
    for (_, values) in response.values().iter() {
        let parts: Vec<f64> = values
            .iter()
            .flat_map(|value| [value.re, value.im])
            .collect();
        add_numbers(hash, &parts);
    }
    if let Some(coherence) = response.coherence() {
        for (_, coherence) in coherence.iter() {
            add_numbers(hash, coherence);
        }
    }
    if let Some(bands) = response.valid_bands() {
        hash.update(b"valid bands");
        for (_, band) in bands.iter() {
            add_numbers(hash, band);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_negative_deviation_is_an_error_with_its_place() {
        let table = |values: &[f64]| PairTable::filled(1, 1, values.to_vec());
        let bands =
            |sd_deg: &[f64]| ModelBands::new(vec![1.0, 2.0], table(&[0.0, 0.5]), table(sd_deg));
        assert_eq!(
            bands(&[1.0, 2.0]).unwrap().sd_deg()[super::super::pair_table::Pair::new(0, 0)],
            [1.0, 2.0]
        );
        assert!(matches!(
            bands(&[1.0, -2.0]),
            Err(MeasuredResponseError::Value {
                array: "sd_deg",
                output: 1,
                input: 1,
                entry: 2,
                value: -2.0,
                ..
            })
        ));
        assert!(matches!(
            bands(&[1.0]),
            Err(MeasuredResponseError::Length {
                array: "sd_deg",
                ..
            })
        ));
        assert!(bands(&[1.0, f64::INFINITY]).is_err());
    }
}

#[cfg(test)]
mod content_tests {
    use nalgebra::DMatrix;

    use super::*;

    fn model(a: f64, b: &[f64]) -> Dynamics {
        let b = DMatrix::from_row_slice(1, b.len(), b);
        let d = DMatrix::zeros(1, b.ncols());
        Dynamics::StateSpace(
            StateSpace::new(
                DMatrix::from_element(1, 1, a),
                b,
                DMatrix::identity(1, 1),
                d,
            )
            .unwrap(),
        )
    }

    #[test]
    fn the_hash_depends_on_every_number() {
        assert_eq!(
            ContentHash::new(&model(-1.0, &[2.0])),
            ContentHash::new(&model(-1.0, &[2.0]))
        );
        let next = f64::from_bits((-1.0_f64).to_bits() + 1);
        assert_ne!(
            ContentHash::new(&model(-1.0, &[2.0])),
            ContentHash::new(&model(next, &[2.0]))
        );
        assert_ne!(
            ContentHash::new(&model(-1.0, &[2.0, 0.0])),
            ContentHash::new(&model(-1.0, &[2.0]))
        );
    }

    #[test]
    fn the_hash_of_a_model_without_timing_is_stable() {
        let hash = |dynamics: &Dynamics| ContentHash::new(dynamics).bytes()[..4].to_vec();
        let plain = model(-1.0, &[2.0]);
        assert_eq!(hash(&plain), [198, 153, 200, 246]);
        let Dynamics::StateSpace(matrices) = plain.clone() else {
            unreachable!()
        };
        let timed = |sample_time_s, delay_s| {
            let timing = Timing {
                sample_time_s,
                input_delays_s: Some(vec![delay_s]),
                output_delays_s: None,
            };
            Dynamics::StateSpace(matrices.clone().timed(timing).unwrap())
        };
        assert_eq!(hash(&timed(None, 0.0)), hash(&plain));
        let others = [
            timed(Some(0.01), 0.0),
            timed(None, 0.01),
            timed(Some(0.01), 0.01),
        ];
        let mut hashes: Vec<Vec<u8>> = others.iter().chain([&plain]).map(hash).collect();
        hashes.sort();
        hashes.dedup();
        assert_eq!(hashes.len(), 4);
    }
}
