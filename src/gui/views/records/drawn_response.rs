//! Curves for an identified response: measured points, models and their confidence bands.
//!
//! Unwrapped phases are known up to whole turns. Models' curves are shifted by whole turns, so that
//! they are within half a turn of the measured phase at the *anchor*, the first trusted measured
//! point; without an anchor they are not shifted.
//!
//! The *refined* model is the result of the identification, the *first* model that from which its
//! refinement starts. Standard deviations are drawn as 95 % intervals: as bars of measured points,
//! and as a band about the refined curve. M14 is in docs/identification.md.

use nalgebra::Complex;

use gdcm_model::dataset::{Pair, StateSpace};
use gdcm_model::response::evaluate;
use gdcm_model::response::frequency_grid::log_spaced;
use gdcm_model::response::response_shape::ResponseShape;
use gdcm_model::units::neper_to_db;
use gdcm_sysid::diagnostics::bands::TWO_SIDED_95;
use gdcm_sysid::diagnostics::departure::NARROW_WINDOW;
use gdcm_sysid::identification::{Identification, IdentificationCaution, TRUSTED_COHERENCE};
use gdcm_sysid::spectra::response_estimate::EstimatePoint;

use crate::gui::plot::BodeCurve;

/// Number of points on a model's curve.
const POINTS: usize = 200;
/// Factor by which models' curves extend beyond the band at either end.
const BEYOND: f64 = 2.0;

/// Upper or lower half in a Bode plot.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum BodePart {
    Magnitude,
    Phase,
}

impl BodePart {
    /// Returns the maximum drawn half-width for bars and bands \[dB, deg\]. Wider ones are cut,
    /// because they would hide other curves.
    fn most_half_width(self) -> f64 {
        match self {
            Self::Magnitude => 20.0,
            Self::Phase => 180.0,
        }
    }

    fn value(self, point: CurvePoint) -> f64 {
        match self {
            Self::Magnitude => point.magnitude_db,
            Self::Phase => point.phase_deg,
        }
    }

    /// Returns the 95 % interval's half-width \[dB, deg\].
    pub(super) fn half_interval(self, sd: StandardDeviation) -> f64 {
        TWO_SIDED_95
            * match self {
                Self::Magnitude => sd.db,
                Self::Phase => sd.deg,
            }
    }

    /// Returns the 95 % interval's half-width \[dB, deg\], limited to the maximum drawn width.
    pub(super) fn drawn_half_interval(self, sd: StandardDeviation) -> f64 {
        self.half_interval(sd).min(self.most_half_width())
    }
}

/// Response value; the phase is unwrapped.
#[derive(Clone, Copy, Debug)]
pub(super) struct CurvePoint {
    /// Frequency \[rad/s\].
    pub(super) omega: f64,
    pub(super) magnitude_db: f64,
    pub(super) phase_deg: f64,
}

impl CurvePoint {
    /// Returns frequency \[rad/s\] and value \[dB, deg\].
    pub(super) fn place(self, part: BodePart) -> [f64; 2] {
        [self.omega, part.value(self)]
    }
}

/// Standard deviations of magnitude and phase.
#[derive(Clone, Copy, Debug)]
pub(super) struct StandardDeviation {
    db: f64,
    deg: f64,
}

/// Measured response at a frequency.
#[derive(Clone, Copy, Debug)]
pub(super) struct MeasuredPoint {
    pub(super) point: CurvePoint,
    pub(super) sd: StandardDeviation,
    /// Whether partial coherence and frequency resolution suffice.
    pub(super) is_trusted: bool,
    /// Partial coherence, 0 to 1.
    pub(super) coherence: f64,
    /// Measured phase minus the refined model's phase, in standard deviations of the measured
    /// point; `None` without a model or a standard deviation.
    pub(super) phase_residual: Option<f64>,
}

/// Frequency band and method with which a response was measured.
#[derive(Clone, Copy)]
pub(super) struct Measurement {
    /// Identification band \[rad/s\].
    pub(super) band: [f64; 2],
    /// Whether recorded references served as instrumental variables (M14.15).
    pub(super) uses_references: bool,
}

/// Curves and intervals for a response, to be drawn in both halves of a Bode plot.
#[derive(Clone, Debug, Default)]
pub(super) struct DrawnResponse {
    pub(super) measured: Vec<MeasuredPoint>,
    /// Refined model's curve, over the frequency band and slightly beyond.
    pub(super) refined: Vec<CurvePoint>,
    /// Refined model's curve at the frequencies at which its standard deviation is known.
    pub(super) refined_with_sd: Vec<CurvePoint>,
    /// Standard deviation at each point of `refined_with_sd`.
    pub(super) refined_sds: Vec<StandardDeviation>,
    /// First model's curve, which is drawn while that model is refined.
    pub(super) first: Vec<CurvePoint>,
    /// Frequency ranges in which the refined model deviates from the measured points \[rad/s\]
    /// (M14.17).
    pub(super) deviating: Vec<[f64; 2]>,
    /// Frequency ranges in which the reference did not excite the input \[rad/s\] (M14.15).
    pub(super) unexcited: Vec<[f64; 2]>,
}

impl DrawnResponse {
    /// Returns the curve of the first model, which is drawn while that model is refined.
    pub(super) fn first_model(model: &StateSpace, band: [f64; 2], pair: Pair) -> Self {
        Self {
            first: model_curve(model, band, pair, None),
            ..Self::default()
        }
    }

    /// Returns an identification's curves.
    ///
    /// 1. Measured points, and the anchor.
    /// 2. Frequency ranges in which the model deviates from the points and, with references, in
    ///    which the input was not excited.
    /// 3. Refined model over the band, and at the frequencies of its standard deviations.
    /// 4. Phase residuals of the measured points, with the model at their frequencies.
    pub(super) fn new(
        identification: &Identification,
        measurement: Measurement,
        pair: Pair,
    ) -> Self {
        // Step 1.
        let points = &identification.measured.points;
        let measured = measured_points(points, pair);
        let anchor = first_trusted(&measured);
        // Step 2.
        let mut drawn = Self {
            measured,
            deviating: deviating_ranges(identification, pair),
            ..Self::default()
        };
        if measurement.uses_references {
            drawn.unexcited = unexcited_ranges(points, pair);
        }
        // Step 3.
        let mut omega_of_sds: &[f64] = &[];
        if let Some(bands) = &identification.refined.bands {
            omega_of_sds = bands.omega();
            for (db, deg) in bands.sd_db()[pair].iter().zip(&bands.sd_deg()[pair]) {
                drawn
                    .refined_sds
                    .push(StandardDeviation { db: *db, deg: *deg });
            }
        }
        if let Some(model) = identification.refined.state_space() {
            drawn.refined = model_curve(model, measurement.band, pair, anchor);
            drawn.refined_with_sd = curve(model, omega_of_sds, pair, anchor);
            // Step 4.
            let omega: Vec<f64> = drawn
                .measured
                .iter()
                .map(|measured| measured.point.omega)
                .collect();
            let at_points = curve(model, &omega, pair, anchor);
            for measured in &mut drawn.measured {
                measured.phase_residual = phase_residual(measured, &at_points);
            }
        }
        drawn
    }

    /// Returns the finite points on a curve from another source, with its phase shifted to the
    /// branch of these curves: first that of the anchor, else that of the refined model's first
    /// point.
    pub(super) fn aligned(&self, curve: &BodeCurve) -> Vec<CurvePoint> {
        let anchor = first_trusted(&self.measured).or(self.refined.first().copied());
        let mut omega = Vec::new();
        let mut phase_deg = Vec::new();
        let mut magnitude_db = Vec::new();
        for (index, frequency) in curve.omega.iter().enumerate() {
            if curve.magnitude_db[index].is_finite() && curve.phase_deg[index].is_finite() {
                omega.push(*frequency);
                magnitude_db.push(curve.magnitude_db[index]);
                phase_deg.push(curve.phase_deg[index]);
            }
        }
        let shift_deg = match anchor {
            Some(anchor) => branch_shift_deg(&omega, &phase_deg, anchor),
            None => 0.0,
        };
        let mut points = Vec::with_capacity(omega.len());
        for (index, omega) in omega.into_iter().enumerate() {
            points.push(CurvePoint {
                omega,
                magnitude_db: magnitude_db[index],
                phase_deg: phase_deg[index] + shift_deg,
            });
        }
        points
    }

    /// Returns whether an error bar or the band is cut, because it exceeds its maximum drawn width.
    pub(super) fn has_cut_bars(&self) -> bool {
        let measured = self.measured.iter().map(|measured| measured.sd);
        let mut sds = measured.chain(self.refined_sds.iter().copied());
        sds.any(|sd| {
            [BodePart::Magnitude, BodePart::Phase]
                .iter()
                .any(|part| part.drawn_half_interval(sd) < part.half_interval(sd))
        })
    }
}

/// Returns the first trusted measured point, which is the anchor.
fn first_trusted(measured: &[MeasuredPoint]) -> Option<CurvePoint> {
    let trusted = measured.iter().find(|measured| measured.is_trusted)?;
    Some(trusted.point)
}

/// Returns a measured point's phase residual with respect to a model's curve at the measured
/// frequencies, within half a turn.
fn phase_residual(measured: &MeasuredPoint, at_points: &[CurvePoint]) -> Option<f64> {
    let model = at_points
        .iter()
        .find(|point| point.omega == measured.point.omega)?;
    if measured.sd.deg <= 0.0 {
        return None;
    }
    let difference = measured.point.phase_deg - model.phase_deg;
    let wrapped = difference - 360.0 * (difference / 360.0).round();
    Some(wrapped / measured.sd.deg)
}

/// Returns a pair's measured points. A point is trusted if its partial coherence reaches
/// [`TRUSTED_COHERENCE`] and its window is narrow: at most [`NARROW_WINDOW`] times its frequency on
/// either side.
fn measured_points(points: &[EstimatePoint], pair: Pair) -> Vec<MeasuredPoint> {
    let at = (pair.output, pair.input);
    let omega = points.iter().map(|point| point.omega).collect();
    let values: Vec<Complex<f64>> = points.iter().map(|point| point.response[at]).collect();
    let mut measured = Vec::with_capacity(points.len());
    for (point, estimate) in shape(omega, &values, None).into_iter().zip(points) {
        let mut sd = estimate.sd(at);
        if !sd.is_finite() {
            sd = 0.0;
        }
        let is_narrow = estimate.half_width <= NARROW_WINDOW * estimate.omega;
        measured.push(MeasuredPoint {
            point,
            sd: StandardDeviation {
                db: neper_to_db(sd),
                deg: sd.to_degrees(),
            },
            is_trusted: estimate.partial_coherence[at] >= TRUSTED_COHERENCE && is_narrow,
            coherence: estimate.partial_coherence[at],
            phase_residual: None,
        });
    }
    measured
}

/// Returns the frequency ranges \[rad/s\] in which cautions report that the model deviates from
/// the measured points.
fn deviating_ranges(identification: &Identification, pair: Pair) -> Vec<[f64; 2]> {
    let mut ranges = Vec::new();
    for caution in &identification.cautions {
        if let IdentificationCaution::LeavesPoints {
            output,
            input,
            band,
            ..
        } = caution
            && output.index == pair.output
            && input.index == pair.input
        {
            ranges.push(*band);
        }
    }
    ranges
}

/// Returns the frequency ranges \[rad/s\] in which the coherence between input and reference is too
/// low for a response.
fn unexcited_ranges(points: &[EstimatePoint], pair: Pair) -> Vec<[f64; 2]> {
    let at = (pair.output, pair.input);
    let mut ranges: Vec<[f64; 2]> = Vec::new();
    let mut was_low = false;
    for point in points {
        let is_low = point.partial_coherence[at] < TRUSTED_COHERENCE;
        match ranges.last_mut() {
            Some(range) if is_low && was_low => range[1] = point.omega,
            _ if is_low => ranges.push([point.omega, point.omega]),
            _ => {}
        }
        was_low = is_low;
    }
    ranges
}

/// Computes a model's response over the band and slightly beyond.
fn model_curve(
    model: &StateSpace,
    band: [f64; 2],
    pair: Pair,
    anchor: Option<CurvePoint>,
) -> Vec<CurvePoint> {
    let omega = log_spaced(band[0] / BEYOND, band[1] * BEYOND, POINTS);
    curve(model, &omega, pair, anchor)
}

/// Computes a model's response at frequencies \[rad/s\]; omits values that are not finite.
fn curve(
    model: &StateSpace,
    frequencies: &[f64],
    pair: Pair,
    anchor: Option<CurvePoint>,
) -> Vec<CurvePoint> {
    let response = evaluate(model, frequencies);
    let mut omega = Vec::new();
    let mut values = Vec::new();
    for (&frequency, &value) in frequencies.iter().zip(response.curve(pair)) {
        if value.is_finite() {
            omega.push(frequency);
            values.push(value);
        }
    }
    shape(omega, &values, anchor)
}

/// Returns the curve with magnitude and unwrapped phase, on the branch nearest to `anchor`, a point
/// on another curve.
fn shape(omega: Vec<f64>, values: &[Complex<f64>], anchor: Option<CurvePoint>) -> Vec<CurvePoint> {
    let ResponseShape {
        magnitude_db,
        phase_deg,
    } = ResponseShape::new(values);
    let shift_deg = match anchor {
        Some(anchor) => branch_shift_deg(&omega, &phase_deg, anchor),
        None => 0.0,
    };
    let mut curve = Vec::with_capacity(omega.len());
    for (index, omega) in omega.into_iter().enumerate() {
        curve.push(CurvePoint {
            omega,
            magnitude_db: magnitude_db[index],
            phase_deg: phase_deg[index] + shift_deg,
        });
    }
    curve
}

/// Returns the shift by whole turns \[deg\] that brings the phase closest to the anchor's phase,
/// compared at the nearest frequency.
fn branch_shift_deg(omega: &[f64], phase_deg: &[f64], anchor: CurvePoint) -> f64 {
    let nearest = (0..omega.len()).min_by(|a, b| {
        let distance_a = (omega[*a] / anchor.omega).ln().abs();
        let distance_b = (omega[*b] / anchor.omega).ln().abs();
        distance_a.total_cmp(&distance_b)
    });
    match nearest {
        Some(nearest) => 360.0 * ((anchor.phase_deg - phase_deg[nearest]) / 360.0).round(),
        None => 0.0,
    }
}
