//! The flown records' Fisher information about a model, and what is needed to predict the
//! information from further flights.
//!
//! ```text
//! G = sum over lines of Re(V^H V (x) conj(S) S'),   phi = max(J / (N - k), 1)     (M14.19, M14.25)
//! information = G / phi,   noise of a line = phi Cv
//!
//! V S: derivative of the whitened model output by the entries of [A B; C D] (`normal_equations`)
//! J cost, N degrees of freedom (`cost`), k parameters;   Cv noise covariance (`noise_covariance`)
//! ```
//!
//! A *standard sweep* is the sweep that predictions start from: as strong and as long as the
//! strongest flown for its input. A *reference* is a recorded signal that drove the loop from
//! outside (M14.15).

use std::f64::consts::TAU;
use std::sync::Arc;

use nalgebra::{Complex, DMatrix};

use gdcm_model::dataset::StateSpace;
use gdcm_model::dataset::model::ModelBands;
use gdcm_model::statistics::median;

use super::planned_sweep::PlannedSweep;
use crate::diagnostics::feedback::Feedback;
use crate::likelihood::balancing::{Gramians, balancing_coordinates};
use crate::likelihood::cost::Likelihood;
use crate::likelihood::noise_covariance::{NoiseCovariance, NoisePoint};
use crate::likelihood::normal_equations::{EXACT, NormalEquations};
use crate::likelihood::schur_model::SchurModel;
use crate::likelihood::spectral_lines::SpectralLines;
use crate::spectra::scales::Scales;
use crate::subspace::tried_orders::parameters_of_order;

/// Minimum distance in ln omega between frequencies at which the noise is stored.
const NOISE_SPACING: f64 = 0.02;
/// Lowest frequency used, in units of a record's first line, as in `spectra::spectrum`.
const FIRST_LINE: f64 = 1.5;

/// The flown records' Fisher information about a model.
#[derive(Clone, Debug, PartialEq)]
pub struct FlightInformation {
    /// The model in scaled units, in balanced coordinates.
    pub(super) model: StateSpace,
    /// Channel scales, from scaled units to record units.
    pub(super) scales: Scales,
    /// `G / phi` in all entries of `[[A, B], [C, D]]`, column after column.
    pub(super) flown: DMatrix<f64>,
    /// `phi`.
    pub(super) dispersion: f64,
    /// `Cv`, in scaled units.
    pub(super) noise: NoiseCovariance,
    /// Lowest and highest line used \[rad/s\].
    pub(super) lines: [f64; 2],
    /// Standard deviations of the model's responses.
    pub(super) bands: Arc<ModelBands>,
    /// Noise and gusts fed back into the responses.
    pub(super) feedback: Option<Feedback>,
    /// For each input, a sweep as strong and as long as the strongest flown.
    pub(super) standard_sweeps: Vec<StandardSweep>,
}

/// A sweep as strong and as long as the strongest flown for its input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StandardSweep {
    pub sweep: PlannedSweep,
    /// Whether amplitude and length are medians over the swept inputs, because this input was not
    /// swept.
    pub is_assumed: bool,
}

/// A fitted model and its lines.
pub(crate) struct FittedModel<'a> {
    /// The model in scaled units.
    pub(crate) model: &'a StateSpace,
    /// The fitted lines; with a reference, the lines as logged.
    pub(crate) likelihood: &'a Likelihood<'a>,
    pub(crate) scales: &'a Scales,
    /// Lowest and highest line used \[rad/s\].
    pub(crate) lines: [f64; 2],
    pub(crate) bands: &'a Arc<ModelBands>,
    pub(crate) feedback: Option<&'a Feedback>,
    /// Indices of inputs that were not swept.
    pub(crate) not_swept: Vec<usize>,
}

impl FlightInformation {
    /// Computes the information at a fitted model; `None` if an iteration does not converge, or if
    /// the parameters leave no degrees of freedom.
    pub(crate) fn new(fitted: &FittedModel) -> Option<Self> {
        let likelihood = fitted.likelihood;
        let model = balanced(likelihood, &SchurModel::from_state_space(fitted.model)?)?;
        let parts = likelihood.parts(&model)?;
        let cost: f64 = parts.iter().map(|part| part.cost).sum();
        let (outputs, inputs) = model.d().shape();
        let parameters = parameters_of_order(model.order(), inputs, outputs);
        let spare = likelihood.freedom(model.order()).checked_sub(parameters)?;
        if spare == 0 {
            return None;
        }
        let dispersion = (cost / spare as f64).max(1.0);
        let system = NormalEquations::new(likelihood, &model, &parts, EXACT)?;
        Some(Self {
            model: model.state_space()?,
            scales: fitted.scales.clone(),
            flown: system.matrix.unscale(dispersion),
            dispersion,
            noise: noise_of_lines(likelihood)?,
            lines: fitted.lines,
            bands: Arc::clone(fitted.bands),
            feedback: fitted.feedback.cloned(),
            standard_sweeps: standard_sweeps(fitted)?,
        })
    }

    /// Returns the number of model inputs, without references.
    #[must_use]
    pub fn inputs(&self) -> usize {
        self.standard_sweeps.len()
    }

    /// Returns an input's standard sweep, flown once; `None` for an input that does not exist.
    #[must_use]
    pub fn standard_sweep(&self, input: usize) -> Option<StandardSweep> {
        self.standard_sweeps.get(input).copied()
    }

    /// Returns the band with which a sweep of this length reaches all lines used \[rad/s\].
    #[must_use]
    pub fn sweep_band(&self, length_s: f64) -> [f64; 2] {
        sweep_band(self.lines, length_s)
    }

    /// Returns a sweep with another length; a band that reaches all lines used still does so.
    #[must_use]
    pub fn with_length(&self, sweep: &PlannedSweep, length_s: f64) -> PlannedSweep {
        let band = if sweep.band == self.sweep_band(sweep.length_s) {
            self.sweep_band(length_s)
        } else {
            sweep.band
        };
        PlannedSweep {
            length_s,
            band,
            ..*sweep
        }
    }
}

/// Transforms a model to balanced coordinates; `None` if an iteration does not converge.
fn balanced(likelihood: &Likelihood, model: &SchurModel) -> Option<SchurModel> {
    let coordinates = balancing_coordinates(&Gramians::sampled(likelihood, model))?;
    model.in_coordinates(&coordinates.transformation, &coordinates.inverse)
}

/// Returns the range of the lines used \[rad/s\]. It begins at the first line that a record of this
/// length has, if that is higher, but at most at half its upper end.
fn sweep_band(lines: [f64; 2], length_s: f64) -> [f64; 2] {
    let first = FIRST_LINE * TAU / length_s;
    [lines[0].max(first).min(0.5 * lines[1]), lines[1]]
}

/// Returns the noise covariance at the lines, without the records' own factors: `Cv = 2 W^-1 W^-H`.
fn noise_of_lines(likelihood: &Likelihood) -> Option<NoiseCovariance> {
    let mut lines: Vec<(f64, &SpectralLines, usize)> = Vec::new();
    for segment in &likelihood.segments {
        for (k, omega) in segment.omega.iter().enumerate() {
            lines.push((*omega, segment, k));
        }
    }
    lines.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut points: Vec<NoisePoint> = Vec::new();
    for (omega, segment, k) in lines {
        let is_near = points
            .last()
            .is_some_and(|point| omega < point.omega * NOISE_SPACING.exp());
        if is_near {
            continue;
        }
        let weight = segment.weights[k].unscale(segment.scale);
        let size = weight.nrows();
        let root = weight.solve_lower_triangular(&DMatrix::identity(size, size))?;
        points.push(NoisePoint {
            omega,
            covariance: (&root * root.adjoint()).scale(2.0),
        });
    }
    NoiseCovariance::new(points)
}

/// A sweep of an input, measured in a record.
#[derive(Clone, Copy)]
struct FlownSweep {
    /// In scaled units as returned by [`flown_sweep`], otherwise in the input's unit.
    amplitude: f64,
    length_s: f64,
}

/// Returns a sweep for each input like the strongest flown; inputs that were not swept get the
/// others' medians, if any input was swept. `None` without lines.
fn standard_sweeps(fitted: &FittedModel) -> Option<Vec<StandardSweep>> {
    let strongest = strongest_sweeps(fitted)?;
    let mut really_swept: Vec<FlownSweep> = Vec::new();
    for (input, sweep) in strongest.iter().enumerate() {
        if !fitted.not_swept.contains(&input) {
            really_swept.push(*sweep);
        }
    }
    let mut sweeps = Vec::with_capacity(strongest.len());
    for (input, own) in strongest.into_iter().enumerate() {
        let is_assumed = fitted.not_swept.contains(&input) && !really_swept.is_empty();
        let flown = if is_assumed {
            FlownSweep {
                amplitude: median_of(&really_swept, |sweep| sweep.amplitude),
                length_s: median_of(&really_swept, |sweep| sweep.length_s),
            }
        } else {
            own
        };
        sweeps.push(StandardSweep {
            sweep: PlannedSweep {
                input,
                amplitude: flown.amplitude,
                length_s: flown.length_s,
                band: sweep_band(fitted.lines, flown.length_s),
                repeats: 1,
            },
            is_assumed,
        });
    }
    Some(sweeps)
}

/// Returns the strongest movement of each input in a segment, measured as a sweep, in the input's
/// unit; `None` without lines.
fn strongest_sweeps(fitted: &FittedModel) -> Option<Vec<FlownSweep>> {
    let mut sweeps = Vec::with_capacity(fitted.scales.inputs.len());
    for (input, scale) in fitted.scales.inputs.iter().enumerate() {
        let mut strongest: Option<FlownSweep> = None;
        for segment in &fitted.likelihood.segments {
            let Some(sweep) = flown_sweep(segment, input, fitted.lines) else {
                continue;
            };
            if strongest.is_none_or(|other| sweep.amplitude > other.amplitude) {
                strongest = Some(sweep);
            }
        }
        let strongest = strongest?;
        sweeps.push(FlownSweep {
            amplitude: strongest.amplitude * scale,
            ..strongest
        });
    }
    Some(sweeps)
}

/// Returns a property's median over sweeps.
fn median_of(sweeps: &[FlownSweep], property: fn(&FlownSweep) -> f64) -> f64 {
    let mut values: Vec<f64> = sweeps.iter().map(property).collect();
    median(&mut values)
}

/// Measures a sweep's amplitude in a segment: a planned sweep with this amplitude and the same
/// length has the same power as the lines, in the median. `None` for fewer than two lines, or if
/// that sweep has no power at any line.
fn flown_sweep(segment: &SpectralLines, input: usize, lines: [f64; 2]) -> Option<FlownSweep> {
    let [first, second, ..] = segment.omega[..] else {
        return None;
    };
    let length_s = TAU / (second - first);
    let unit = PlannedSweep {
        input,
        amplitude: 1.0,
        length_s,
        band: sweep_band(lines, length_s),
        repeats: 1,
    };
    let mut ratios = Vec::with_capacity(segment.omega.len());
    for (k, &omega) in segment.omega.iter().enumerate() {
        let power = unit.power(omega);
        let value: Complex<f64> = segment.inputs[(input, k)];
        if power > 0.0 {
            ratios.push(value.norm_sqr() / power);
        }
    }
    if ratios.is_empty() {
        return None;
    }
    Some(FlownSweep {
        amplitude: median(&mut ratios).sqrt(),
        length_s,
    })
}
