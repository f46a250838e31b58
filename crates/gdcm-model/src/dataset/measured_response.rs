//! A measured frequency response.

use nalgebra::Complex;

use super::limits::{AVERAGES, WINDOW_S};
use super::pair_table::{Pair, PairTable};
use crate::number_format::number;

/// A frequency response measured (or exported) at `N` frequencies, given instead of a state-space
/// model.
///
/// `omega` \[rad/s\] is positive and strictly rising, `N >= 2`; every response has `N` finite
/// values. A response that was not measured has zeros, or a valid band that ends at 0
/// ([`Self::is_measured`]).
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredResponse {
    omega: Vec<f64>,
    values: PairTable<Vec<Complex<f64>>>,
    coherence: Option<PairTable<Vec<f64>>>,
    valid_bands: Option<PairTable<[f64; 2]>>,
    estimate: Estimate,
}

/// Settings with which a response was estimated, each `None` if the response's author does not give
/// it. With the coherence, the settings determine error bars (M13) and the weight in the coupling
/// fit (M16.2), but not the gains and delays of the condition itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// Number of independent averages.
    pub averages: Option<f64>,
    /// Averaging window length \[s\].
    pub window_s: Option<f64>,
}

/// Error for frequency data that do not form a measured response.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeasuredResponseError {
    #[error("expected at least 2 frequencies, found {0}")]
    TooFewFrequencies(usize),
    #[error("frequency {entry}: expected finite, positive and rising frequencies, found {}", number(*value))]
    Frequency {
        /// Entry, counted from 1.
        entry: usize,
        value: f64,
    },
    #[error("{array}, output {output}, input {input}: expected {expected} values, found {found}")]
    Length {
        /// `re`, `im` or `coherence`.
        array: &'static str,
        /// Output, counted from 1.
        output: usize,
        /// Input, counted from 1.
        input: usize,
        /// Frequency count.
        expected: usize,
        /// Value count.
        found: usize,
    },
    /// Valid band that starts below zero, ends before it starts, or is not finite.
    #[error(
        "valid_band_rad_s, output {output}, input {input}: expected a first and a last frequency, \
        not negative and in ascending order, found {} and {}",
        number(band[0]), number(band[1])
    )]
    ValidBand {
        /// Output, counted from 1.
        output: usize,
        /// Input, counted from 1.
        input: usize,
        band: [f64; 2],
    },
    /// An estimation setting out of range.
    #[error("{key}: expected a number from {} to {}, found {}", number(range[0]), number(range[1]), number(*value))]
    Estimate {
        /// `averages` or `window_s`.
        key: &'static str,
        /// Minimum and maximum permitted value.
        range: [f64; 2],
        value: f64,
    },
    /// A value that is not finite, or a coherence outside 0 to 1.
    #[error("{array}, output {output}, input {input}, entry {entry}: expected {expected}, found {}", number(*value))]
    Value {
        /// `re`, `im` or `coherence`.
        array: &'static str,
        /// Output, counted from 1.
        output: usize,
        /// Input, counted from 1.
        input: usize,
        /// Entry, counted from 1.
        entry: usize,
        /// Permitted values, in words.
        expected: &'static str,
        value: f64,
    },
}

impl MeasuredResponseError {
    /// Returns the stable code by which scripts and tests distinguish the errors.
    pub fn code(&self) -> &'static str {
        match self {
            Self::TooFewFrequencies(..) => "too-few-frequencies",
            Self::Frequency { .. } => "response-frequency",
            Self::Length { .. } => "response-length",
            Self::ValidBand { .. } => "valid-band",
            Self::Estimate { .. } => "response-estimate",
            Self::Value { .. } => "response-value",
        }
    }
}

impl MeasuredResponse {
    /// Creates the response with real parts `re` and imaginary parts `im` at `omega` \[rad/s\],
    /// both p x m tables with `N` values per response.
    ///
    /// # Errors
    /// [`MeasuredResponseError`] for fewer than two frequencies, frequencies that are not positive
    /// and rising, tables of the wrong length, values that are not finite, or a coherence outside 0
    /// to 1.
    pub fn new(
        omega: Vec<f64>,
        re: &PairTable<Vec<f64>>,
        im: &PairTable<Vec<f64>>,
        coherence: Option<PairTable<Vec<f64>>>,
    ) -> Result<Self, MeasuredResponseError> {
        check_frequencies(&omega)?;
        check_values("re", re, omega.len(), "a finite number", f64::is_finite)?;
        check_values("im", im, omega.len(), "a finite number", f64::is_finite)?;
        if let Some(coherence) = &coherence {
            check_values(
                "coherence",
                coherence,
                omega.len(),
                "a number from 0 to 1",
                |value| (0.0..=1.0).contains(&value),
            )?;
        }
        let values = re.map(|pair, re| {
            re.iter()
                .zip(&im[pair])
                .map(|(&re, &im)| Complex::new(re, im))
                .collect()
        });
        Ok(Self {
            omega,
            values,
            coherence,
            valid_bands: None,
            estimate: Estimate::default(),
        })
    }

    /// Returns the response with valid bands: each response's first and last trusted frequency
    /// \[rad/s\] (M4a); both 0 if none is trusted.
    ///
    /// # Errors
    /// [`MeasuredResponseError::ValidBand`] if a band is not finite, negative, or ends before it
    /// begins.
    pub fn with_valid_bands(
        mut self,
        bands: PairTable<[f64; 2]>,
    ) -> Result<Self, MeasuredResponseError> {
        for (pair, &band) in bands.iter() {
            let [low, high] = band;
            if !((0.0..=high).contains(&low) && high.is_finite()) {
                return Err(MeasuredResponseError::ValidBand {
                    output: pair.output + 1,
                    input: pair.input + 1,
                    band,
                });
            }
        }
        self.valid_bands = Some(bands);
        Ok(self)
    }

    /// Returns the response with its estimation settings replaced.
    ///
    /// # Errors
    /// [`MeasuredResponseError::Estimate`] for a setting outside its limits.
    pub fn with_estimate(mut self, estimate: Estimate) -> Result<Self, MeasuredResponseError> {
        for (key, value, range) in [
            ("averages", estimate.averages, AVERAGES),
            ("window_s", estimate.window_s, WINDOW_S),
        ] {
            if let Some(value) = value
                && !(range[0]..=range[1]).contains(&value)
            {
                return Err(MeasuredResponseError::Estimate { key, range, value });
            }
        }
        self.estimate = estimate;
        Ok(self)
    }

    /// Returns the frequencies \[rad/s\], strictly rising.
    pub fn omega(&self) -> &[f64] {
        &self.omega
    }

    /// Returns each response's complex values, one per frequency.
    pub fn values(&self) -> &PairTable<Vec<Complex<f64>>> {
        &self.values
    }

    /// Returns each response's coherence (0 to 1), one value per frequency; `None` if the file does
    /// not give it.
    pub fn coherence(&self) -> Option<&PairTable<Vec<f64>>> {
        self.coherence.as_ref()
    }

    /// Returns each response's first and last trusted frequency \[rad/s\], both 0 if none is
    /// trusted; `None` if the file does not give them.
    pub fn valid_bands(&self) -> Option<&PairTable<[f64; 2]>> {
        self.valid_bands.as_ref()
    }

    /// Returns whether a response has data: at least one nonzero value, and a valid band, if given,
    /// that is not empty.
    pub fn is_measured(&self, pair: Pair) -> bool {
        let has_band = self
            .valid_bands
            .as_ref()
            .is_none_or(|bands| bands[pair][1] > 0.0);
        has_band
            && self.values[pair]
                .iter()
                .any(|value| *value != Complex::new(0.0, 0.0))
    }

    /// Returns the settings with which the response was estimated.
    pub fn estimate(&self) -> Estimate {
        self.estimate
    }
}

/// Checks that there are two or more frequencies, and that they are finite, positive and rising.
pub(super) fn check_frequencies(omega: &[f64]) -> Result<(), MeasuredResponseError> {
    if omega.len() < 2 {
        return Err(MeasuredResponseError::TooFewFrequencies(omega.len()));
    }
    let mut before = 0.0;
    for (index, &value) in omega.iter().enumerate() {
        if !value.is_finite() || value <= before {
            return Err(MeasuredResponseError::Frequency {
                entry: index + 1,
                value,
            });
        }
        before = value;
    }
    Ok(())
}

/// Checks that every response has `length` values and that `accepts` holds for each.
pub(super) fn check_values(
    array: &'static str,
    table: &PairTable<Vec<f64>>,
    length: usize,
    expected: &'static str,
    accepts: impl Fn(f64) -> bool,
) -> Result<(), MeasuredResponseError> {
    for (pair, values) in table.iter() {
        let output = pair.output + 1;
        let input = pair.input + 1;
        if values.len() != length {
            return Err(MeasuredResponseError::Length {
                array,
                output,
                input,
                expected: length,
                found: values.len(),
            });
        }
        for (index, &value) in values.iter().enumerate() {
            if !accepts(value) {
                return Err(MeasuredResponseError::Value {
                    array,
                    output,
                    input,
                    entry: index + 1,
                    expected,
                    value,
                });
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(values: &[f64]) -> PairTable<Vec<f64>> {
        PairTable::filled(1, 1, values.to_vec())
    }

    #[test]
    fn frequencies_that_do_not_rise_are_refused_with_their_place() {
        let error =
            MeasuredResponse::new(vec![1.0, 1.0], &table(&[0.0; 2]), &table(&[0.0; 2]), None)
                .unwrap_err();
        assert_eq!(
            error,
            MeasuredResponseError::Frequency {
                entry: 2,
                value: 1.0
            }
        );
    }

    #[test]
    fn a_response_of_another_length_is_refused_with_its_place() {
        let error =
            MeasuredResponse::new(vec![1.0, 2.0], &table(&[0.0; 2]), &table(&[0.0; 3]), None)
                .unwrap_err();
        assert_eq!(
            error,
            MeasuredResponseError::Length {
                array: "im",
                output: 1,
                input: 1,
                expected: 2,
                found: 3
            }
        );
    }

    #[test]
    fn a_coherence_above_one_is_refused() {
        let result = MeasuredResponse::new(
            vec![1.0, 2.0],
            &table(&[0.0; 2]),
            &table(&[0.0; 2]),
            Some(table(&[0.5, 1.5])),
        );
        assert!(matches!(
            result,
            Err(MeasuredResponseError::Value {
                array: "coherence",
                entry: 2,
                ..
            })
        ));
    }

    #[test]
    fn a_valid_band_that_ends_before_it_begins_is_refused() {
        let response =
            MeasuredResponse::new(vec![1.0, 2.0], &table(&[0.0; 2]), &table(&[0.0; 2]), None)
                .unwrap();
        let with = |band| {
            response
                .clone()
                .with_valid_bands(PairTable::filled(1, 1, band))
        };
        assert_eq!(
            with([0.5, 1.5]).unwrap().valid_bands().unwrap()[Pair::new(0, 0)],
            [0.5, 1.5]
        );
        for band in [
            [2.0, 1.0],
            [-1.0, 1.0],
            [1.0, f64::INFINITY],
            [f64::NAN, 1.0],
        ] {
            assert!(matches!(
                with(band),
                Err(MeasuredResponseError::ValidBand { .. })
            ));
        }
    }
}
