//! The attitude that an input makes, over frequency: `Theta(j omega)`, from which bandwidth and phase delay are read (M17.1);
//! and a model's response on the frequencies that are searched for crossings, kept for all that is read from it.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::Complex;

use gdcm_model::assembly::PhysicalUnit;
use gdcm_model::dataset::{Band, Channel, Dynamics, Pair};
use gdcm_model::message_text::quoted;
use gdcm_model::response::curve_values::{between, unwrap};
use gdcm_model::response::frequency_response::log_spaced;
use gdcm_model::response::{FrequencyResponse, GainDelay, PreparedModel, wrap};
use gdcm_model::units::{number, ratio_to_db};

/// Frequencies on which sign changes are looked for.
const SEARCH_POINTS: usize = 400;
/// Models are searched from the lower end of the band over this to its upper end times this.
const SEARCH_BEYOND_BAND: f64 = 4.0;

/// What an output is of an attitude.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AttitudeOutput {
    /// Its rate: deg/s, rad/s.
    Rate,
    /// The attitude itself: deg, rad.
    Attitude,
}

/// Why a response has no attitude to read a bandwidth from.
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
        /// Its unit.
        unit: String,
    },
    /// There are no two neighbouring frequencies at which the response is finite and not zero.
    #[error("there is no response between {} and {} rad/s", number(*from), number(*to))]
    NoResponse {
        /// Lowest frequency asked for \[rad/s\].
        from: f64,
        /// Highest frequency asked for \[rad/s\].
        to: f64,
    },
}

impl AttitudeOutput {
    /// What the unit of an output says that it is.
    ///
    /// # Errors
    /// [`AttitudeResponseError::NotAnAttitude`] of any other unit.
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

    /// What `H` is multiplied by to become the attitude: `1/(j omega)` of a rate.
    fn factor(self, omega: f64) -> Complex<f64> {
        match self {
            Self::Rate => Complex::new(0.0, -1.0 / omega),
            Self::Attitude => Complex::from(1.0),
        }
    }
}

/// A response at any frequencies \[rad/s\]; not a number where it is not known.
pub type ResponseAt<'a> = dyn Fn(&[f64]) -> Vec<Complex<f64>> + 'a;

/// The frequencies \[rad/s\] on which a model is searched for crossings: 400, logarithmic, of `band / 4` to `4 band`.
pub fn search_frequencies(band: Band) -> Vec<f64> {
    log_spaced(
        band.min() / SEARCH_BEYOND_BAND,
        band.max() * SEARCH_BEYOND_BAND,
        SEARCH_POINTS,
    )
}

/// `Theta(j omega)`: magnitude and continuous phase on a grid, and between.
///
/// Of a rate response H it is `H / (j omega)`. The phase is continuous, and lies in (-270, 90] deg at the lowest frequency of the band:
/// below it, where no records say anything, slow and unstable modes turn a physics model's phase by whole turns.
pub struct AttitudeResponse<'a> {
    response: &'a ResponseAt<'a>,
    /// What many points in a row are read from.
    samples: &'a ResponseAt<'a>,
    output: AttitudeOutput,
    /// The frequencies \[rad/s\] of the grid at which it is known, rising; at least two.
    pub(super) omega: Vec<f64>,
    /// `20 log10 |Theta|` on the grid, up to a constant that the units make.
    pub(super) magnitude_db: Vec<f64>,
    /// Continuous phase \[rad\] on the grid.
    pub(super) phase: Vec<f64>,
    /// Index of the lowest frequency of the band on the grid, at which the branch of the phase is decided.
    pub(super) lowest_of_band: usize,
}

impl<'a> AttitudeResponse<'a> {
    /// The attitude that `response` makes of an output, searched on the rising frequencies `omega` \[rad/s\]: [`search_frequencies`]
    /// of a model, its own frequencies of a measured response. It ends where the response first has no value. The branch of the
    /// phase is decided at the first of them in `band`.
    ///
    /// # Errors
    /// [`AttitudeResponseError::NoResponse`] where no two neighbouring frequencies have a value.
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

    /// The same response, of which many points in a row are read from samples of it.
    #[must_use]
    pub fn sampled_by(self, samples: &'a ResponseAt<'a>) -> Self {
        Self { samples, ..self }
    }

    /// The phase \[deg\] at the lowest frequency of the band where it speaks for a stick or an output that counts the other way round:
    /// within 45 deg of +90 deg, where an attitude that follows its stick has 0 to -90 deg. Bandwidths are then wrong.
    pub fn reversed_phase_deg(&self) -> Option<f64> {
        let phase_deg = self.phase[self.lowest_of_band].to_degrees();
        let is_reversed = !(-225.0..=45.0).contains(&phase_deg);
        is_reversed.then_some(phase_deg)
    }

    /// Magnitude \[dB\] at `omega` \[rad/s\]; none where there is no response.
    pub fn magnitude_db_at(&self, omega: f64) -> Option<f64> {
        polar(self.response, self.output, &[omega])[0].map(|(magnitude_db, _)| magnitude_db)
    }

    /// Phase \[rad\] at `omega` \[rad/s\] on the branch of the grid around it; none outside the grid or where there is no response.
    pub fn phase_at(&self, omega: f64) -> Option<f64> {
        let near = between(&self.omega, &self.phase, omega)?;
        let (_, principal) = polar(self.response, self.output, &[omega])[0]?;
        Some(near + wrap(principal - near))
    }

    /// Phases \[rad\] at the rising frequencies `omega` \[rad/s\], unwrapped from `first`, that of the first of them; none where one
    /// has no response. The grid may end before them. The last is that of the response itself, those before it may be of its samples.
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

/// Magnitude \[dB\] and principal phase \[rad\] of the attitude; none where it is zero or not finite.
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

/// A model with its response on the search frequencies and on to twice the highest, at equal ratios: a phase delay needs
/// `2 omega_180`.
pub struct SampledModel {
    prepared: PreparedModel,
    omega: Vec<f64>,
    values: FrequencyResponse,
    /// Number of the search frequencies.
    searched: usize,
}

impl SampledModel {
    /// Samples a model that is searched in and about `band`.
    pub fn of(dynamics: &Dynamics, band: Band) -> Self {
        let prepared = PreparedModel::of(dynamics);
        let mut omega = search_frequencies(band);
        let searched = omega.len();
        let highest = omega[omega.len() - 1];
        let ratio = omega[1] / omega[0];
        let beyond = std::iter::successors(Some(highest * ratio), |omega| Some(omega * ratio));
        // One more than needed, for the interpolation to have a neighbour.
        omega.extend(beyond.take(1 + (2f64.ln() / ratio.ln()).ceil() as usize));
        let values = prepared.at(&omega);
        Self {
            prepared,
            omega,
            values,
            searched,
        }
    }

    /// Its response under `correction`, exact at any frequency (M2, M10).
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

    /// The same, between the samples by the cubic through four of them over ln omega; not a number outside.
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

/// The cubic through four values at 0, 1, 2, 3 (Lagrange).
fn cubic(values: &[Complex<f64>], at: f64) -> Complex<f64> {
    let [a, b, c, d] = [at, at - 1.0, at - 2.0, at - 3.0];
    values[0] * (-b * c * d / 6.0) + values[1] * (a * c * d / 2.0) - values[2] * (a * b * d / 2.0)
        + values[3] * (a * b * c / 6.0)
}
