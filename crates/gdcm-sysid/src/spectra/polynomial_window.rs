//! Chooses the window for a local polynomial: the spectral lines around a frequency (M14.12).
//!
//! ```text
//! h = max(0.45, share omega), times 1.2 once and then times 1.05 until the window holds
//!     terms inputs + terms records + outputs + spare lines
//! ```
//!
//! `share` is 0.2, or 0.15 with a reference. Records with no more lines than terms in the window
//! are omitted. There are three terms and six spare lines or, if all lines together are too few,
//! two terms and four spare lines; if they are too few for these also, an error.

use std::ops::Range;

use super::local_polynomial_error::LocalPolynomialError;
use super::response_estimate::TERMS;
use super::spectrum::Spectrum;

/// Number of polynomial terms (1, x) if there are too few lines for three.
const FEWER_TERMS: usize = 2;
/// Minimum window half-width \[rad/s\] (M14.2).
const LEAST_HALF_WIDTH: f64 = 0.45;
/// First factor by which a window with too few lines is widened.
const FIRST_WIDENING: f64 = 1.2;
/// Factor for each further widening.
const FURTHER_WIDENING: f64 = 1.05;
/// Number of lines that a window with three terms needs in addition to one per unknown and output.
const SPARE_LINES: usize = 6;
/// Number of lines that a window with two terms needs in addition to one per unknown and output.
const SPARE_LINES_FEWER_TERMS: usize = 4;

/// The lines around a frequency.
pub(crate) struct Window {
    /// Centre \[rad/s\].
    pub(crate) omega: f64,
    /// Half-width \[rad/s\].
    pub(crate) half_width: f64,
    /// Number of polynomial terms: 3, or 2 with few lines.
    pub(super) terms: usize,
    /// For each spectrum, the range of its lines in the window; empty if there are too few.
    pub(super) lines: Vec<Range<usize>>,
    /// Number of spectral lines in the window, over all spectra with enough lines.
    pub(super) count: usize,
    /// Number of transient columns, over all records.
    pub(super) transients: usize,
}

impl Window {
    /// Returns the window around `omega`, widened until it holds enough lines for three terms or,
    /// if all lines are too few, for two; `share` is the first half-width relative to `omega`.
    pub(super) fn around(
        spectra: &[Spectrum],
        omega: f64,
        share: f64,
    ) -> Result<Self, LocalPolynomialError> {
        match Self::with_terms(spectra, omega, share, TERMS) {
            Ok(window) => Ok(window),
            Err(_) => Self::with_terms(spectra, omega, share, FEWER_TERMS),
        }
    }

    /// Widens the window until it holds enough lines for `terms`; an error once it holds all lines.
    fn with_terms(
        spectra: &[Spectrum],
        omega: f64,
        share: f64,
        terms: usize,
    ) -> Result<Self, LocalPolynomialError> {
        let inputs = spectra[0].inputs.nrows();
        let outputs = spectra[0].outputs.nrows();
        let spare = if terms == TERMS {
            SPARE_LINES
        } else {
            SPARE_LINES_FEWER_TERMS
        };
        let farthest = farthest_line(spectra, omega);
        let mut half_width = LEAST_HALF_WIDTH.max(share * omega);
        let mut widening = FIRST_WIDENING;
        loop {
            let window = Self::with_half_width(spectra, omega, half_width, terms);
            let needed = terms * inputs + window.transients + outputs + spare;
            // At least one record must have enough lines.
            if window.transients > 0 && window.count >= needed {
                return Ok(window);
            }
            if half_width >= farthest {
                return Err(LocalPolynomialError::TooFewLines {
                    lines: window.count,
                    needed,
                });
            }
            half_width *= widening;
            widening = FURTHER_WIDENING;
        }
    }

    fn with_half_width(spectra: &[Spectrum], omega: f64, half_width: f64, terms: usize) -> Self {
        let lines: Vec<Range<usize>> = spectra
            .iter()
            .map(|spectrum| lines_inside(spectrum, omega, half_width, terms))
            .collect();
        let count = lines.iter().map(ExactSizeIterator::len).sum();
        let transients = terms * lines.iter().filter(|range| !range.is_empty()).count();
        Self {
            omega,
            half_width,
            terms,
            lines,
            count,
            transients,
        }
    }
}

/// Returns the distance \[rad/s\] from `omega` to the farthest line.
fn farthest_line(spectra: &[Spectrum], omega: f64) -> f64 {
    let mut farthest = 0.0_f64;
    for spectrum in spectra {
        for line in spectrum
            .omega
            .first()
            .into_iter()
            .chain(spectrum.omega.last())
        {
            farthest = farthest.max((line - omega).abs());
        }
    }
    farthest
}

/// Returns the range of a spectrum's lines within `half_width` of `omega`; empty if there are no
/// more lines than terms.
fn lines_inside(spectrum: &Spectrum, omega: f64, half_width: f64, terms: usize) -> Range<usize> {
    let from = spectrum.omega.partition_point(|&w| w < omega - half_width);
    let to = spectrum
        .omega
        .partition_point(|&w| w <= omega + half_width)
        .max(from);
    if to - from > terms {
        from..to
    } else {
        from..from
    }
}
