//! The attitude response to an input, `Theta(j omega)`, from which bandwidth and phase delay are
//! read (M17.1): magnitude and continuous phase.
//!
//! ```text
//! Theta = H / (j omega) for a rate, H for an attitude;  H: response of the output to the input
//! 1  evaluate Theta on the grid; keep the longest run of values without a gap
//! 2  unwrap the phase, and add whole turns so that it is in (-270, 90] deg at the lowest frequency
//!    of the band
//! 3  between grid points: evaluate Theta exactly, on the branch of the neighbouring phases
//! 4  beyond the grid: unwrap from a known phase (`phases_from`)
//! ```

use std::f64::consts::{FRAC_PI_2, TAU};
use std::ops::{Range, RangeInclusive};

use nalgebra::Complex;

use gdcm_model::dataset::{Band, Channel};
use gdcm_model::message_text::quoted;
use gdcm_model::response::frequency_grid::log_spaced;
use gdcm_model::response::interpolation::between;
use gdcm_model::response::phase_unwrapping::unwrap;
use gdcm_model::response::wrap;
use gdcm_model::units::physical_unit::PhysicalUnit;
use gdcm_model::units::{number, ratio_to_db};

/// Number of frequencies on which a model's crossings are searched: more resolve two crossings that
/// lie closer together, but cost more evaluations.
const SEARCH_POINTS: usize = 400;
/// A model is searched from the lower end of the band divided by this factor to the upper end of
/// the band times this factor, because the phase may fall through -180 deg outside the band.
const SEARCH_BEYOND_BAND: f64 = 4.0;
/// Phases \[deg\] at the lowest band frequency that an attitude which follows its input can have:
/// all but 45 to 135 deg, which on the branch (-270, 90] are -270 to -225 deg and 45 to 90 deg. It
/// usually has 0 to -90 deg, and 180 to 90 deg with a reversed sign; near 180 deg, however, the
/// phase can also be a lag.
const FOLLOWING_PHASE_DEG: RangeInclusive<f64> = -225.0..=45.0;

/// Quantity that an output represents: an attitude or its rate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AttitudeOutput {
    /// Angular rate: deg/s, rad/s.
    Rate,
    /// Attitude: deg, rad.
    Attitude,
}

/// Reasons why no attitude response, and hence no bandwidth, is available.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AttitudeResponseError {
    /// The output is neither a rate nor an attitude.
    #[error(
        "{} in {} has no bandwidth: it is neither a rate (deg/s, rad/s) nor an attitude (deg, rad)",
        quoted(output),
        quoted(unit)
    )]
    NotAnAttitude { output: String, unit: String },
    /// The longest run of finite nonzero values without a gap has fewer than two.
    #[error("the response has no two neighbouring values other than zero between {} and {} rad/s", number(*from), number(*to))]
    NoResponse {
        /// Lowest requested frequency \[rad/s\].
        from: f64,
        /// Highest requested frequency \[rad/s\].
        to: f64,
    },
}

impl AttitudeResponseError {
    /// Returns the stable code by which scripts and tests distinguish the errors.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NotAnAttitude { .. } => "not-an-attitude",
            Self::NoResponse { .. } => "no-response",
        }
    }
}

impl AttitudeOutput {
    /// Classifies an output by its unit.
    ///
    /// # Errors
    /// [`AttitudeResponseError::NotAnAttitude`] for any other unit.
    pub fn classify(output: &Channel) -> Result<Self, AttitudeResponseError> {
        match PhysicalUnit::parse(&output.unit).map(|unit| unit.name) {
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

/// A response evaluated at any frequencies \[rad/s\]; NaN where no response is available.
pub type ResponseAt<'a> = dyn Fn(&[f64]) -> Vec<Complex<f64>> + 'a;

/// Returns the frequencies \[rad/s\] on which a model's crossings are searched: 400, spaced
/// logarithmically, from a quarter of the lower end of the band to four times the upper.
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
/// at the lowest band frequency: below it, where records carry no information, slow and unstable
/// modes turn a physics model's phase by whole turns.
pub struct AttitudeResponse<'a> {
    response: &'a ResponseAt<'a>,
    /// Response at many frequencies; may interpolate, for speed.
    samples: &'a ResponseAt<'a>,
    output: AttitudeOutput,
    /// Grid frequencies \[rad/s\] with a finite nonzero response, ascending; at least two.
    pub(super) omega: Vec<f64>,
    /// `20 log10 |Theta|` on the grid, up to a constant that depends on the units.
    pub(super) magnitude_db: Vec<f64>,
    /// Continuous phase \[rad\] on the grid, in (-270, 90] deg at `lowest_of_band`.
    pub(super) phase: Vec<f64>,
    /// The lowest band frequency's grid index, which fixes the phase branch.
    pub(super) lowest_of_band: usize,
}

impl<'a> AttitudeResponse<'a> {
    /// Creates an output's attitude response from `response`, evaluated at the ascending
    /// frequencies `omega` \[rad/s\]: [`search_frequencies`] for a model, the measured frequencies
    /// for a measured response. The attitude response covers the longest run of values without a
    /// gap. The phase branch is chosen at the first frequency in `band`.
    ///
    /// # Errors
    /// [`AttitudeResponseError::NoResponse`] if these are fewer than two values.
    pub fn new(
        response: &'a ResponseAt<'a>,
        output: AttitudeOutput,
        omega: &[f64],
        band: Band,
    ) -> Result<Self, AttitudeResponseError> {
        // Step 1
        let polar = polar(response, output, omega);
        let known = longest_run(&polar);
        if known.len() < 2 {
            return Err(AttitudeResponseError::NoResponse {
                from: omega.first().copied().unwrap_or(f64::NAN),
                to: omega.last().copied().unwrap_or(f64::NAN),
            });
        }
        let mut magnitude_db = Vec::new();
        let mut phase = Vec::new();
        for polar in polar[known.clone()].iter().flatten() {
            magnitude_db.push(polar.magnitude_db);
            phase.push(polar.phase);
        }
        // Step 2
        unwrap(&mut phase);
        let omega = omega[known].to_vec();
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
        for phase in &mut phase {
            *phase += turns;
        }
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

    /// Evaluates many frequencies at once by `samples`, which may interpolate, instead of
    /// `response`.
    #[must_use]
    pub fn sampled_by(self, samples: &'a ResponseAt<'a>) -> Self {
        Self { samples, ..self }
    }

    /// Returns the phase \[deg\] at the lowest band frequency if it indicates an input or an output
    /// with reversed sign, so that the bandwidths are wrong: 45 to 135 deg. An attitude that
    /// follows its input has 0 to -90 deg.
    pub fn reversed_phase_deg(&self) -> Option<f64> {
        let phase_deg = self.phase[self.lowest_of_band].to_degrees();
        if FOLLOWING_PHASE_DEG.contains(&phase_deg) {
            None
        } else {
            Some(phase_deg)
        }
    }

    /// Returns the magnitude \[dB\] at `omega` \[rad/s\]; `None` without a response.
    pub fn magnitude_db_at(&self, omega: f64) -> Option<f64> {
        Some(polar(self.response, self.output, &[omega])[0]?.magnitude_db)
    }

    /// Returns the phase \[rad\] at `omega` \[rad/s\] on the same branch as the surrounding grid
    /// points (step 3); `None` outside the grid or without a response.
    pub fn phase_at(&self, omega: f64) -> Option<f64> {
        let interpolated = between(&self.omega, &self.phase, omega)?;
        let principal = polar(self.response, self.output, &[omega])[0]?.phase;
        Some(interpolated + wrap(principal - interpolated))
    }

    /// Returns the phases \[rad\] at the ascending frequencies `omega` \[rad/s\], unwrapped from
    /// `first`, the phase at the first frequency (step 4); `None` if a response is missing. The
    /// frequencies may extend beyond the grid. The last phase is evaluated exactly, the others from
    /// the samples set by [`Self::sampled_by`], if any.
    pub fn phases_from(&self, first: f64, omega: &[f64]) -> Option<Vec<f64>> {
        let (last, before) = omega.split_last()?;
        let mut found = polar(self.samples, self.output, before);
        found.extend(polar(self.response, self.output, &[*last]));
        let mut phases = Vec::new();
        for polar in found {
            phases.push(polar?.phase);
        }
        unwrap(&mut phases);
        let turns = TAU * ((first - phases.first()?) / TAU).round();
        for phase in &mut phases {
            *phase += turns;
        }
        Some(phases)
    }
}

/// Attitude magnitude \[dB\] and principal phase \[rad\] at a frequency.
#[derive(Clone, Copy)]
struct Polar {
    magnitude_db: f64,
    phase: f64,
}

/// Evaluates the attitude; `None` where it is zero or not finite.
fn polar(response: &ResponseAt<'_>, output: AttitudeOutput, omega: &[f64]) -> Vec<Option<Polar>> {
    let mut polar = Vec::with_capacity(omega.len());
    for (value, &omega) in response(omega).into_iter().zip(omega) {
        let attitude = value * output.factor(omega);
        let magnitude_db = ratio_to_db(attitude.norm());
        let phase = attitude.arg();
        polar.push(if magnitude_db.is_finite() && phase.is_finite() {
            Some(Polar {
                magnitude_db,
                phase,
            })
        } else {
            None
        });
    }
    polar
}

/// Returns the index range of the longest run of values without a gap; the first of equally long
/// runs.
fn longest_run(polar: &[Option<Polar>]) -> Range<usize> {
    let mut longest = 0..0;
    let mut start = 0;
    for run in polar.chunk_by(|a, b| a.is_some() == b.is_some()) {
        let end = start + run.len();
        if run[0].is_some() && run.len() > longest.len() {
            longest = start..end;
        }
        start = end;
    }
    longest
}
