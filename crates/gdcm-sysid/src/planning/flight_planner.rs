//! Predicts standard deviations after further sweeps (M14.25: `docs/identification.md`).
//!
//! ```text
//! Theta = [A B; C D] the entries of the identified model;  R = (j omega I - A)^-1
//! H = C R B + D its response;  H_oi output o, input i;  [..]_o row o, [..]_i column i
//! G, G_j Fisher information about Theta (`normal_equations`) from the flown records and from
//!    planned sweep j, which is flown r_j times
//! phi dispersion: cost per degree of freedom, at least 1; it scales the assumed noise power
//! N changes of the state coordinates, which H does not show, so that G is singular along them
//! sd_now, sd standard deviation of ln H_oi as reported now (`bands`), and after the sweeps
//!
//! 1  G_j: from the spectrum of the sweep, without residual and without transient (the sweep begins
//!    and ends in trim), the other inputs 0, the noise that of the flown records
//! 2  T = G/phi + sum_j r_j G_j/phi + c N N',   c such that c N N' and G/phi have the same trace:
//!    c N N' makes T regular along N
//! 3  h = gradient of ln H_oi in Theta:  dH = [C R, I]_o dTheta [R B; I]_i
//!    var = h' T^-1 h, which N does not change: h is orthogonal to N, and N' G = 0
//!    var_now likewise, without the planned sweeps
//! 4  sd^2 = f^2 + (sd_now^2 - f^2) var / var_now,   f^2 = b^2 / 2,  b the fed-back share (M14.17)
//!    f at most sd_now;  var / var_now at most 1
//! ```
//!
//! Step 4: gusts and noise reach the response through feedback. A visible fed-back share remains,
//! because further flights of the same kind do not change it. The other parts of `sd_now`, from the
//! fit and between neighbouring model orders, are due to noise, and fall with the variance of the
//! fit.

use std::cell::OnceCell;

use nalgebra::{Complex, DMatrix, DVector};

use gdcm_model::dataset::Pair;
use gdcm_model::executor::Executor;
use gdcm_model::units::neper_to_db;

use super::coordinate_changes::coordinate_changes;
use super::flight_information::FlightInformation;
use super::planned_sweep::PlannedSweep;
use crate::diagnostics::bands::TWO_SIDED_95;
use crate::diagnostics::feedback::FeedbackLevel;
use crate::likelihood::cost::{Likelihood, SegmentCost};
use crate::likelihood::normal_equations::{EXACT, NormalEquations};
use crate::likelihood::schur_model::SchurModel;
use crate::likelihood::spectral_lines::SpectralLines;
use crate::spectra::interpolation::Neighbours;
use crate::spectra::spectrum::LineRange;

/// Share of the diagonal added to the information: a direction about which the flights say nothing
/// keeps a large but finite variance.
const FLOOR: f64 = 1e-12;
/// Largest standard deviation of `ln H` \[neper and rad\], as in `bands`.
const UNKNOWN: f64 = 1e3;

/// Half-width of a response's 95 % interval at a frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResponseInterval {
    pub half_db: f64,
    pub half_deg: f64,
}

/// Predicts the 95 % intervals of the responses after further sweeps (steps 1 to 4).
pub struct FlightPlanner<'a> {
    information: &'a FlightInformation,
    model: SchurModel,
    /// `G/phi + c N N'`, whereas [`FlightInformation`] holds `G/phi` alone.
    flown: DMatrix<f64>,
    executor: &'a dyn Executor,
    /// The flown records' factored information, computed at its first use.
    now: OnceCell<Option<FactoredInformation>>,
}

/// Information from a single planned sweep, `G_j/phi`.
#[derive(Clone)]
pub(super) struct SweepInformation(pub(super) DMatrix<f64>);

/// A planned sweep with the number of times that it is flown. A fraction stands for another
/// amplitude: a sweep with a times the amplitude brings `a^2` times the information.
pub(super) struct Repeated<'p> {
    pub(super) information: &'p SweepInformation,
    pub(super) times: f64,
}

/// Variances of `ln H`, real and imaginary part.
#[derive(Clone, Copy, Debug)]
pub(super) struct LogVariance {
    pub(super) re: f64,
    pub(super) im: f64,
}

impl<'a> FlightPlanner<'a> {
    /// Prepares the predictions with the flown records' part of `T` (step 2); `None` if the Schur
    /// iteration for the model does not converge.
    #[must_use]
    pub fn new(information: &'a FlightInformation, executor: &'a dyn Executor) -> Option<Self> {
        let model = SchurModel::from_state_space(&information.model)?;
        let changes = coordinate_changes(&model);
        // c N N'.
        let mut along_changes = &changes * changes.transpose();
        let c = information.flown.trace() / along_changes.trace();
        if c.is_finite() && c > 0.0 {
            along_changes *= c;
        }
        Some(Self {
            information,
            model,
            flown: along_changes + &information.flown,
            executor,
            now: OnceCell::new(),
        })
    }

    /// Returns the flown records' information, to which that from planned sweeps is added.
    #[must_use]
    pub fn information(&self) -> &FlightInformation {
        self.information
    }

    /// Computes the information from a single sweep (step 1); `None` if it has no lines in the
    /// range used, or under the conditions of [`SpectralLines::new`] and [`NormalEquations::new`].
    pub(super) fn sweep_information(&self, sweep: &PlannedSweep) -> Option<SweepInformation> {
        let (outputs, inputs) = self.model.d().shape();
        let scale = *self.information.scales.inputs.get(sweep.input)?;
        let [lowest, highest] = self.information.lines;
        let range = LineRange { lowest, highest };
        let segment = sweep.segment(inputs, outputs, scale);
        let spectra = range.spectra(std::slice::from_ref(&segment), self.executor);
        let lines = SpectralLines::new(spectra.first()?, &self.information.noise)?;
        // Y = H U and tau = 0 leave no residual. The matrix G_j does not depend on the residual,
        // but only on U, on tau and on the values of missing samples, of which a planned sweep has
        // none.
        let part = SegmentCost {
            cost: 0.0,
            transient: DVector::zeros(self.model.order()),
            hat_values: Vec::new(),
            residual: DMatrix::zeros(outputs, lines.omega.len()),
        };
        let likelihood = Likelihood::new(vec![lines], self.executor);
        let system = NormalEquations::new(&likelihood, &self.model, &[part], EXACT)?;
        Some(SweepInformation(
            system.matrix.unscale(self.information.dispersion),
        ))
    }

    /// Factors the information after further sweeps (step 2); `None` if it is not positive
    /// definite.
    pub(super) fn after(&self, sweeps: &[Repeated]) -> Option<FactoredInformation> {
        let mut total = self.flown.clone();
        for Repeated { information, times } in sweeps {
            total += &information.0 * *times;
        }
        FactoredInformation::new(total)
    }

    /// Returns the flown records' factored information; `None` if it is not positive definite.
    fn now(&self) -> Option<&FactoredInformation> {
        self.now.get_or_init(|| self.after(&[])).as_ref()
    }

    /// Returns a response's interval as reported now.
    #[must_use]
    pub fn interval_now(&self, pair: Pair, omega: f64) -> ResponseInterval {
        let bands = &self.information.bands;
        ResponseInterval {
            half_db: TWO_SIDED_95 * interpolated(bands.omega(), &bands.sd_db()[pair], omega),
            half_deg: TWO_SIDED_95 * interpolated(bands.omega(), &bands.sd_deg()[pair], omega),
        }
    }

    /// Predicts a response's interval (steps 3 and 4). Half-widths are 1.96 sd, so that step 4
    /// holds for them as it does for sd.
    pub(super) fn interval(
        &self,
        after: &FactoredInformation,
        pair: Pair,
        omega: f64,
    ) -> Option<ResponseInterval> {
        let gradient = self.log_gradient(pair, omega);
        let variance_now = self.now()?.variance(&gradient)?;
        let variance_after = after.variance(&gradient)?;
        let now = self.interval_now(pair, omega);
        let limit = self.interval_limit(pair, omega);
        let ratio_re = variance_after.re / variance_now.re;
        let ratio_im = variance_after.im / variance_now.im;
        Some(ResponseInterval {
            half_db: reduced(now.half_db, limit.half_db, ratio_re),
            half_deg: reduced(now.half_deg, limit.half_deg, ratio_im),
        })
    }

    /// Returns the interval's limit for infinitely many flights, 1.96 f (step 4): the share visibly
    /// fed back.
    ///
    /// It is 0 without a visible share, and for an input that was not swept: that share was
    /// measured without a sweep, and a planned sweep exceeds what is fed back into the input.
    #[must_use]
    pub fn interval_limit(&self, pair: Pair, omega: f64) -> ResponseInterval {
        let was_swept = self
            .information
            .standard_sweep(pair.input)
            .is_some_and(|standard| !standard.is_assumed);
        let share = match &self.information.feedback {
            Some(feedback) if was_swept && feedback.level() != FeedbackLevel::None => {
                feedback.ratio(omega, (pair.output, pair.input))
            }
            _ => 0.0,
        };
        let half_width = TWO_SIDED_95 * (0.5 * share.powi(2)).sqrt();
        ResponseInterval {
            half_db: neper_to_db(half_width),
            half_deg: half_width.to_degrees(),
        }
    }

    /// Returns `h`, the gradient of `ln H_oi` in all entries of `[[A, B], [C, D]]` (step 3):
    /// columns for its real part (log modulus) and its imaginary part (phase). The entries run
    /// column after column, as in [`NormalEquations`].
    pub(super) fn log_gradient(&self, pair: Pair, omega: f64) -> DMatrix<f64> {
        let order = self.model.order();
        let (outputs, inputs) = self.model.d().shape();
        let mut cr = DMatrix::<Complex<f64>>::zeros(outputs, order);
        self.model.output_resolvent(omega, cr.as_mut_slice());
        let mut unit_input = DMatrix::zeros(inputs, 1);
        unit_input[pair.input] = Complex::from(1.0);
        let no_transient = DVector::zeros(order);
        let states = self.model.states(&[omega], &unit_input, &no_transient);
        // [C R, I]_o, then [R B; I]_i.
        let mut rows: Vec<Complex<f64>> = cr.row(pair.output).iter().copied().collect();
        rows.resize(order + outputs, Complex::default());
        rows[order + pair.output] = Complex::from(1.0);
        let mut columns: Vec<Complex<f64>> = states.iter().copied().collect();
        columns.resize(order + inputs, Complex::default());
        columns[order + pair.input] = Complex::from(1.0);
        let response = self.model.response(omega)[(pair.output, pair.input)];
        let mut gradient = DMatrix::zeros(rows.len() * columns.len(), 2);
        for (c, column) in columns.iter().enumerate() {
            for (r, row) in rows.iter().enumerate() {
                let value = row * column / response;
                gradient[(c * rows.len() + r, 0)] = value.re;
                gradient[(c * rows.len() + r, 1)] = value.im;
            }
        }
        gradient
    }
}

/// The lower Cholesky factor of `T`, with columns scaled to unit length (step 2).
pub(super) struct FactoredInformation {
    /// Factors that scale the columns.
    scales: DVector<f64>,
    lower: DMatrix<f64>,
}

impl FactoredInformation {
    fn new(mut total: DMatrix<f64>) -> Option<Self> {
        let scales = total
            .diagonal()
            .map(|square| 1.0 / square.max(f64::MIN_POSITIVE).sqrt());
        let size = scales.len();
        for (at, entry) in total.iter_mut().enumerate() {
            *entry *= scales[at % size] * scales[at / size];
        }
        for place in 0..size {
            total[(place, place)] += FLOOR;
        }
        Some(Self {
            scales,
            lower: total.cholesky()?.unpack(),
        })
    }

    /// Computes `var` along a gradient with two columns (step 3); `None` if one is not finite.
    pub(super) fn variance(&self, gradient: &DMatrix<f64>) -> Option<LogVariance> {
        let mut scaled = gradient.clone();
        for mut column in scaled.column_iter_mut() {
            column.component_mul_assign(&self.scales);
        }
        let solved = self.lower.solve_lower_triangular(&scaled)?;
        let [re, im] = [0, 1].map(|part| solved.column(part).norm_squared());
        if re.is_finite() && im.is_finite() {
            Some(LogVariance {
                re: re.min(UNKNOWN * UNKNOWN),
                im: im.min(UNKNOWN * UNKNOWN),
            })
        } else {
            None
        }
    }
}

/// Returns an interval's half-width after the sweeps (step 4): `now` is the present half-width,
/// `limit` that for infinitely many flights, `ratio` is `var / var_now`.
fn reduced(now: f64, limit: f64, ratio: f64) -> f64 {
    let fixed = limit.min(now).powi(2);
    (fixed + (now.powi(2) - fixed) * ratio.clamp(0.0, 1.0)).sqrt()
}

/// Interpolates linearly in log frequency; constant beyond the ends.
fn interpolated(omegas: &[f64], values: &[f64], omega: f64) -> f64 {
    let logs: Vec<f64> = omegas.iter().map(|omega| omega.ln()).collect();
    let Neighbours {
        before,
        after,
        share,
    } = Neighbours::find(&logs, omega.ln());
    values[before] * (1.0 - share) + values[after] * share
}
