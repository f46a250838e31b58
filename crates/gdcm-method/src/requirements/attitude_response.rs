//! The attitude response to an input, `Theta(j omega)`, from which bandwidth and phase delay are
//! read (M17.1), and a model's response sampled once on the frequencies of the crossing search.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::Complex;

use gdcm_model::dataset::{Band, Channel, Dynamics, Pair};
use gdcm_model::message_text::quoted;
use gdcm_model::response::curve_values::{between, unwrap};
use gdcm_model::response::frequency_response::log_spaced;
use gdcm_model::response::{FrequencyResponse, GainDelay, PreparedModel, wrap};
use gdcm_model::units::physical_unit::PhysicalUnit;
use gdcm_model::units::{number, ratio_to_db};

/// Number of frequencies searched for sign changes.
const SEARCH_POINTS: usize = 400;
/// The search for a model extends from the lower band end over this to the upper band end times
/// this.
const SEARCH_BEYOND_BAND: f64 = 4.0;

/// Relation of an output to an attitude.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AttitudeOutput {
    /// Angular rate: deg/s, rad/s.
    Rate,
    /// Attitude: deg, rad.
    Attitude,
}

/// Reasons why a response has no attitude to read a bandwidth from.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AttitudeResponseError {
    /// The output is neither a rate nor an attitude.
    #[error(
        "{} in {} has no bandwidth: it is neither a rate (deg/s, rad/s) nor an attitude (deg, rad)",
        quoted(output),
        quoted(unit)
    )]
    NotAnAttitude {
        /// Name of the output.
        output: String,
        unit: String,
    },
    /// No two neighbouring frequencies have a finite nonzero response.
    #[error("there is no response between {} and {} rad/s", number(*from), number(*to))]
    NoResponse {
        /// Lowest requested frequency \[rad/s\].
        from: f64,
        /// Highest requested frequency \[rad/s\].
        to: f64,
    },
}

impl AttitudeOutput {
    /// Classifies an output by its unit.
    ///
    /// # Errors
    /// [`AttitudeResponseError::NotAnAttitude`] for any other unit.
    pub fn of(output: &Channel) -> Result<Self, AttitudeResponseError> {
        match PhysicalUnit::of(&output.unit).map(|unit| unit.name) {
            Some("deg/s" | "rad/s") => Ok(Self::Rate),
            Some("deg" | "rad") => Ok(Self::Attitude),
            _ => Err(AttitudeResponseError::NotAnAttitude {
                output: output.name.clone(),
                unit: output.unit.clone(),
            }),
        }
    }

    /// Returns the factor from `H` to the attitude: `1/(j omega)` for a rate.
    fn factor(self, omega: f64) -> Complex<f64> {
        match self {
            Self::Rate => Complex::new(0.0, -1.0 / omega),
            Self::Attitude => Complex::from(1.0),
        }
    }
}

/// A response evaluated at any frequencies \[rad/s\]; NaN where it is unknown.
pub type ResponseAt<'a> = dyn Fn(&[f64]) -> Vec<Complex<f64>> + 'a;

/// Returns the frequencies \[rad/s\] of the crossing search for a model: 400, logarithmic, from
/// `band / 4` to `4 band`.
pub fn search_frequencies(band: Band) -> Vec<f64> {
    log_spaced(
        band.min() / SEARCH_BEYOND_BAND,
        band.max() * SEARCH_BEYOND_BAND,
        SEARCH_POINTS,
    )
}

/// `Theta(j omega)`: magnitude and continuous phase on a grid and between its points.
///
/// For a rate response H it is `H / (j omega)`. The phase is continuous, and lies in (-270, 90] deg
/// at the lowest frequency of the band: below it, where records carry no information, slow and
/// unstable modes turn a physics model's phase by whole turns.
pub struct AttitudeResponse<'a> {
    response: &'a ResponseAt<'a>,
    /// Source for sequences of many points.
    samples: &'a ResponseAt<'a>,
    output: AttitudeOutput,
    /// Grid frequencies \[rad/s\] with a known response, ascending; at least two.
    pub(super) omega: Vec<f64>,
    /// `20 log10 |Theta|` on the grid, up to a constant that depends on the units.
    pub(super) magnitude_db: Vec<f64>,
    /// Continuous phase \[rad\] on the grid.
    pub(super) phase: Vec<f64>,
    /// Grid index of the lowest frequency of the band, which fixes the branch of the phase.
    pub(super) lowest_of_band: usize,
}

impl<'a> AttitudeResponse<'a> {
    /// Creates the attitude response of an output from `response`, searched on the ascending
    /// frequencies `omega` \[rad/s\]: [`search_frequencies`] for a model, its own frequencies for a
    /// measured response. It ends at the first missing value. The branch of the phase is chosen at
    /// the first frequency in `band`.
    ///
    /// # Errors
    /// [`AttitudeResponseError::NoResponse`] if no two neighbouring frequencies have a value.
    pub fn new(
        response: &'a ResponseAt<'a>,
        output: AttitudeOutput,
        omega: &[f64],
        band: Band,
    ) -> Result<Self, AttitudeResponseError> {
        let polar: Vec<Option<(f64, f64)>> = polar(response, output, omega);
        let from = polar
            .iter()
            .position(Option::is_some)
            .unwrap_or(omega.len());
        let run: Vec<(f64, f64)> = polar[from..].iter().map_while(|polar| *polar).collect();
        if run.len() < 2 {
            let end = |omega: Option<&f64>| omega.copied().unwrap_or(f64::NAN);
            return Err(AttitudeResponseError::NoResponse {
                from: end(omega.first()),
                to: end(omega.last()),
            });
        }
        let (magnitude_db, mut phase): (Vec<f64>, Vec<f64>) = run.into_iter().unzip();
        unwrap(&mut phase);
        let omega = omega[from..from + phase.len()].to_vec();
        let lowest_of_band = omega
            .partition_point(|omega| *omega < band.min())
            .min(omega.len() - 1);
        let principal = wrap(phase[lowest_of_band]);
        let on_branch = if principal > FRAC_PI_2 {
            principal - TAU
        } else {
            principal
        };
        let turns = on_branch - phase[lowest_of_band];
        phase.iter_mut().for_each(|phase| *phase += turns);
        Ok(Self {
            response,
            samples: response,
            output,
            omega,
            magnitude_db,
            phase,
            lowest_of_band,
        })
    }

    /// Uses `samples` of the response to read sequences of many points.
    #[must_use]
    pub fn sampled_by(self, samples: &'a ResponseAt<'a>) -> Self {
        Self { samples, ..self }
    }

    /// Returns the phase \[deg\] at the lowest frequency of the band if it indicates an input or an
    /// output with reversed sign: within 45 deg of +90 deg, where an attitude that follows its
    /// input has 0 to -90 deg. The bandwidths are then wrong.
    pub fn reversed_phase_deg(&self) -> Option<f64> {
        let phase_deg = self.phase[self.lowest_of_band].to_degrees();
        let is_reversed = !(-225.0..=45.0).contains(&phase_deg);
        is_reversed.then_some(phase_deg)
    }

    /// Returns the magnitude \[dB\] at `omega` \[rad/s\]; `None` without a response.
    pub fn magnitude_db_at(&self, omega: f64) -> Option<f64> {
        polar(self.response, self.output, &[omega])[0].map(|(magnitude_db, _)| magnitude_db)
    }

    /// Returns the phase \[rad\] at `omega` \[rad/s\] on the branch of the surrounding grid; `None`
    /// outside the grid or without a response.
    pub fn phase_at(&self, omega: f64) -> Option<f64> {
        let near = between(&self.omega, &self.phase, omega)?;
        let (_, principal) = polar(self.response, self.output, &[omega])[0]?;
        Some(near + wrap(principal - near))
    }

    /// Returns the phases \[rad\] at the ascending frequencies `omega` \[rad/s\], unwrapped from
    /// `first`, the phase at the first of them; `None` if a response is missing. The frequencies
    /// may extend beyond the grid. The last phase is read from the response itself, the others from
    /// its samples, if any.
    pub fn phases_from(&self, first: f64, omega: &[f64]) -> Option<Vec<f64>> {
        let (last, before) = omega.split_last()?;
        let mut found = polar(self.samples, self.output, before);
        found.extend(polar(self.response, self.output, &[*last]));
        let mut phases: Vec<f64> = found
            .into_iter()
            .map(|polar| polar.map(|(_, phase)| phase))
            .collect::<Option<_>>()?;
        unwrap(&mut phases);
        let turns = TAU * ((first - phases.first()?) / TAU).round();
        phases.iter_mut().for_each(|phase| *phase += turns);
        Some(phases)
    }
}

/// Returns magnitude \[dB\] and principal phase \[rad\] of the attitude; `None` where it is zero or
/// not finite.
fn polar(
    response: &ResponseAt<'_>,
    output: AttitudeOutput,
    omega: &[f64],
) -> Vec<Option<(f64, f64)>> {
    let values = response(omega)
        .into_iter()
        .zip(omega)
        .map(|(value, &omega)| value * output.factor(omega));
    let polar = values.map(|value| (ratio_to_db(value.norm()), value.arg()));
    polar
        .map(|(db, phase)| (db.is_finite() && phase.is_finite()).then_some((db, phase)))
        .collect()
}

/// A model with its response on the search frequencies and, at equal ratios, up to twice the
/// highest: a phase delay needs `2 omega_180`.
pub struct SampledModel {
    prepared: PreparedModel,
    omega: Vec<f64>,
    values: FrequencyResponse,
    /// Number of search frequencies.
    searched: usize,
}

impl SampledModel {
    /// Samples a model for a search in and around `band`.
    pub fn of(dynamics: &Dynamics, band: Band) -> Self {
        let prepared = PreparedModel::of(dynamics);
        let mut omega = search_frequencies(band);
        let searched = omega.len();
        let highest = omega[omega.len() - 1];
        let ratio = omega[1] / omega[0];
        let beyond = std::iter::successors(Some(highest * ratio), |omega| Some(omega * ratio));
        // One more than needed, as a neighbour for the interpolation.
        omega.extend(beyond.take(1 + (2f64.ln() / ratio.ln()).ceil() as usize));
        let values = prepared.at(&omega);
        Self {
            prepared,
            omega,
            values,
            searched,
        }
    }

    /// Returns the response under `correction`, exact at any frequency (M2, M10).
    pub fn exact(
        &self,
        pair: Pair,
        correction: GainDelay,
    ) -> impl Fn(&[f64]) -> Vec<Complex<f64>> + '_ {
        move |omega| {
            let corrected = |values: &[Complex<f64>]| {
                values
                    .iter()
                    .zip(omega)
                    .map(|(value, omega)| value * correction.at(*omega))
                    .collect()
            };
            if *omega == self.omega[..self.searched] {
                return corrected(&self.values.curve(pair)[..self.searched]);
            }
            corrected(self.prepared.at(omega).curve(pair))
        }
    }

    /// Returns the same response, interpolated between the samples by a cubic over ln omega; NaN
    /// outside.
    pub fn interpolated(
        &self,
        pair: Pair,
        correction: GainDelay,
    ) -> impl Fn(&[f64]) -> Vec<Complex<f64>> + '_ {
        let curve = self.values.curve(pair);
        let start = self.omega[0].ln();
        let step = (self.omega[1] / self.omega[0]).ln();
        let between = move |omega: f64| {
            let place = (omega.ln() - start) / step;
            let last = (curve.len() - 1) as f64;
            if !(-1e-9..=last + 1e-9).contains(&place) {
                return Complex::new(f64::NAN, f64::NAN);
            }
            let from = (place.floor() - 1.0).clamp(0.0, last - 3.0);
            cubic(&curve[from as usize..][..4], place - from) * correction.at(omega)
        };
        move |omega| omega.iter().map(|omega| between(*omega)).collect()
    }
}

/// Evaluates the cubic through four values at 0, 1, 2, 3 (Lagrange).
fn cubic(values: &[Complex<f64>], at: f64) -> Complex<f64> {
    let [a, b, c, d] = [at, at - 1.0, at - 2.0, at - 3.0];
    values[0] * (-b * c * d / 6.0) + values[1] * (a * c * d / 2.0) - values[2] * (a * b * d / 2.0)
        + values[3] * (a * b * c / 6.0)
}
