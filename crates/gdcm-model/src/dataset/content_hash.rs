//! Hash over a model's dynamics.

use sha2::{Digest, Sha256};

use super::dynamics::Dynamics;
use super::measured_response::MeasuredResponse;
use super::state_space::{StateSpace, Timing};

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

    /// Returns the hash's 32 bytes.
    pub fn bytes(&self) -> &[u8; 32] {
        &self.0
    }
}

/// Adds the value count, then the values, to a hash.
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
    // A plain timing adds nothing to the hash, so that hashes from before timing was introduced
    // remain valid.
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
