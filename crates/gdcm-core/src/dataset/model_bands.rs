//! How uncertain the response of an identified model is.

use sha2::{Digest, Sha256};

use super::content::add_numbers;
use super::measured_response::{MeasuredResponseError, check_frequencies, check_values};
use super::pair::PairTable;

/// Standard deviations of a model's response over frequency, as the identification estimates them (M14).
///
/// A curve holds to `1 - 2 Phi(-z)` between `H_dB - z sd_db` and `H_dB + z sd_db`, and the same of its phase.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelBands {
    omega: Vec<f64>,
    sd_db: PairTable<Vec<f64>>,
    sd_deg: PairTable<Vec<f64>>,
}

impl ModelBands {
    /// The standard deviations of magnitude \[dB\] and phase \[deg\] at `omega` \[rad/s\], both p x m tables of `N` values.
    ///
    /// # Errors
    /// Frequencies that do not rise, tables of another length, numbers that are not finite or negative.
    pub fn new(
        omega: Vec<f64>,
        sd_db: PairTable<Vec<f64>>,
        sd_deg: PairTable<Vec<f64>>,
    ) -> Result<Self, MeasuredResponseError> {
        check_frequencies(&omega)?;
        for (array, table) in [("sd_db", &sd_db), ("sd_deg", &sd_deg)] {
            check_values(array, table, omega.len(), "a number not below zero", |value| {
                value.is_finite() && value >= 0.0
            })?;
        }
        Ok(Self { omega, sd_db, sd_deg })
    }

    /// Frequencies \[rad/s\], strictly rising.
    pub fn omega(&self) -> &[f64] {
        &self.omega
    }

    /// Standard deviation of the magnitude \[dB\], one for each frequency.
    pub fn sd_db(&self) -> &PairTable<Vec<f64>> {
        &self.sd_db
    }

    /// Standard deviation of the phase \[deg\], one for each frequency.
    pub fn sd_deg(&self) -> &PairTable<Vec<f64>> {
        &self.sd_deg
    }

    /// Adds every number to a hash.
    pub(super) fn add_to(&self, hash: &mut Sha256) {
        hash.update(b"bands");
        add_numbers(hash, &self.omega);
        for table in [&self.sd_db, &self.sd_deg] {
            table.iter().for_each(|(_, deviations)| add_numbers(hash, deviations));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_negative_deviation_is_refused_with_its_place() {
        let table = |values: &[f64]| PairTable::filled(1, 1, values.to_vec());
        let bands = |sd_deg: &[f64]| ModelBands::new(vec![1.0, 2.0], table(&[0.0, 0.5]), table(sd_deg));
        assert_eq!(bands(&[1.0, 2.0]).unwrap().sd_deg()[crate::dataset::Pair::new(0, 0)], [1.0, 2.0]);
        let words = bands(&[1.0, -2.0]).unwrap_err().to_string();
        assert_eq!(words, "sd_deg, output 1, input 1, entry 2: expected a number not below zero, found -2");
        assert!(matches!(bands(&[1.0]), Err(MeasuredResponseError::Length { array: "sd_deg", .. })));
        assert!(bands(&[1.0, f64::INFINITY]).is_err());
    }
}
