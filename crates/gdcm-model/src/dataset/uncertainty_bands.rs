//! Uncertainty bands of a model's response over frequency, as estimated by the identification; not
//! frequency bands (`band.rs`).

use sha2::{Digest, Sha256};

use super::content_hash::add_numbers;
use super::measured_response::{MeasuredResponseError, check_frequencies, check_values};
use super::pair_table::PairTable;

/// Standard deviation of a model's response over frequency, as estimated by the identification
/// (M14).
///
/// At each frequency, the true magnitude lies between `H_dB - z sd_db` and `H_dB + z sd_db` with
/// the probability `1 - 2 Phi(-z)`, where `Phi` is the standard normal distribution function;
/// likewise the phase.
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

    /// Returns the standard deviation in magnitude \[dB\] at each frequency.
    pub fn sd_db(&self) -> &PairTable<Vec<f64>> {
        &self.sd_db
    }

    /// Returns the standard deviation in phase \[deg\] at each frequency.
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
