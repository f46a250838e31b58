//! What the numbers of a model are told apart by.

use nalgebra::DMatrix;
use sha2::{Digest, Sha256};

use super::measured_response::MeasuredResponse;
use super::model::Dynamics;
use super::state_space::StateSpace;

/// SHA-256 of every number that the response of a model depends on: models of one hash have one response.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ContentHash([u8; 32]);

impl ContentHash {
    /// The hash of a model's matrices, or of its measured frequencies, values and coherence; shapes included.
    pub fn of(dynamics: &Dynamics) -> Self {
        let mut hash = Sha256::new();
        match dynamics {
            Dynamics::StateSpace(model) => add_state_space(&mut hash, model),
            Dynamics::Measured(response) => add_measured(&mut hash, response),
        }
        Self(hash.finalize().into())
    }

    /// The hash itself.
    pub fn bytes(&self) -> &[u8; 32] {
        &self.0
    }
}

fn add_numbers(hash: &mut Sha256, numbers: &[f64]) {
    hash.update((numbers.len() as u64).to_le_bytes());
    let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
    hash.update(&bytes);
}

fn add_state_space(hash: &mut Sha256, model: &StateSpace) {
    hash.update(b"state space");
    let add = |hash: &mut Sha256, matrix: &DMatrix<f64>| {
        hash.update((matrix.nrows() as u64).to_le_bytes());
        add_numbers(hash, matrix.as_slice());
    };
    [model.a(), model.b(), model.c(), model.d()].into_iter().for_each(|matrix| add(hash, matrix));
}

fn add_measured(hash: &mut Sha256, response: &MeasuredResponse) {
    hash.update(b"measured");
    add_numbers(hash, response.omega());
    hash.update((response.values().outputs() as u64).to_le_bytes());
    for (_, values) in response.values().iter() {
        let parts: Vec<f64> = values.iter().flat_map(|value| [value.re, value.im]).collect();
        add_numbers(hash, &parts);
    }
    for (_, coherence) in response.coherence().into_iter().flat_map(|table| table.iter()) {
        add_numbers(hash, coherence);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn model(a: f64, b: &[f64]) -> Dynamics {
        let b = DMatrix::from_row_slice(1, b.len(), b);
        let d = DMatrix::zeros(1, b.ncols());
        Dynamics::StateSpace(StateSpace::new(DMatrix::from_element(1, 1, a), b, DMatrix::identity(1, 1), d).unwrap())
    }

    #[test]
    fn models_of_the_same_numbers_have_one_hash_and_any_other_number_gives_another() {
        assert_eq!(ContentHash::of(&model(-1.0, &[2.0])), ContentHash::of(&model(-1.0, &[2.0])));
        let next = f64::from_bits((-1.0_f64).to_bits() + 1);
        assert_ne!(ContentHash::of(&model(-1.0, &[2.0])), ContentHash::of(&model(next, &[2.0])));
        assert_ne!(ContentHash::of(&model(-1.0, &[2.0, 0.0])), ContentHash::of(&model(-1.0, &[2.0])));
    }
}
