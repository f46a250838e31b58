//! Laguerre projections of a record onto its own future (M14.3).
//!
//! ```text
//! s_k(t) = int_0^inf l_k(tau) s(t + tau) dtau
//!     l_k <-> sqrt(2a)/(s + a) ((a - s)/(a + s))^k,   k = 0 ... p
//!
//! 1  c = 2/dt, g = sqrt(2a)/(a + c), alpha = (a - c)/(a + c)                  (bilinear rule)
//! 2  x = the record less its last sample, from its end to its beginning
//! 3  y_0[n] = g (x[n] + x[n-1]) - alpha y_0[n-1]                              zero initial state
//! 4  y_k[n] = alpha y_{k-1}[n] + y_{k-1}[n-1] - alpha y_k[n-1]                k = 1 ... p
//! 5  each y_k from its end to its beginning
//! ```
//!
//! M. Bergamasco & M. Lovera, "Continuous-time predictor-based subspace identification using
//! Laguerre filters", IET Control Theory & Applications 5(7), 2011.

use nalgebra::{DMatrix, DVector};

use gdcm_model::dataset::StateSpace;
use gdcm_model::executor::{Executor, each};
use gdcm_model::simulation::Segment;

use super::triangular_factor::TriangularFactor;

/// Maximum share of a segment that is lost to the incomplete projections at its end.
const LARGEST_END: f64 = 0.3;
/// Number of parts whose rows are factored in parallel. Two parts keep two cores busy with three
/// poles; merging a further part costs as much as a segment of 6 s.
const PARTS: usize = 2;

/// The filters for a Laguerre pole at a sample time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LaguerreBank {
    /// Gain of the first filter.
    gain: f64,
    /// Negative pole of every filter, and zero of the all-pass filters.
    alpha: f64,
}

impl LaguerreBank {
    /// Designs the filters with the pole `-pole` rad/s for samples every `sample_time_s` (step 1).
    pub(crate) fn new(pole: f64, sample_time_s: f64) -> Self {
        let c = 2.0 / sample_time_s;
        Self {
            gain: (2.0 * pole).sqrt() / (pole + c),
            alpha: (pole - c) / (pole + c),
        }
    }

    /// Computes the projections at every sample of a signal that ends near 0 (steps 3 to 5), with a
    /// column for each k = 0 ... `past`.
    pub(crate) fn projections(self, signal: &[f64], past: usize) -> DMatrix<f64> {
        let samples = signal.len();
        let mut projections = DMatrix::zeros(samples, past + 1);
        self.first_filter(signal, &mut projections.as_mut_slice()[..samples]);
        for k in 1..=past {
            let (done, rest) = projections.as_mut_slice().split_at_mut(k * samples);
            self.all_pass(&done[(k - 1) * samples..], &mut rest[..samples]);
        }
        projections
    }

    /// Runs the first filter backwards over `input`.
    fn first_filter(self, input: &[f64], output: &mut [f64]) {
        let mut before = 0.0;
        let mut state = 0.0;
        for (&now, to) in input.iter().zip(output).rev() {
            state = self.gain * (now + before) - self.alpha * state;
            before = now;
            *to = state;
        }
    }

    /// Runs an all-pass filter backwards over `input`.
    fn all_pass(self, input: &[f64], output: &mut [f64]) {
        let mut before = 0.0;
        let mut state = 0.0;
        for (&now, to) in input.iter().zip(output).rev() {
            state = self.alpha * (now - state) + before;
            before = now;
            *to = state;
        }
    }
}

/// Settings of the data matrix in CT-PBSID (M14.3).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Projections {
    /// Laguerre pole `a` \[rad/s\].
    pub(crate) pole: f64,
    /// `p`: every channel has the projections 0 to `past`.
    pub(crate) past: usize,
    /// Time between the instants at which rows are taken \[s\].
    pub(crate) spacing_s: f64,
}

impl Projections {
    /// Computes the rows of a segment, including its trim and drift.
    ///
    /// ```text
    /// row t_i = [z_0(t_i) | z_1(t_i) | ... | z_p(t_i)]
    /// z_k = [u~_k; y~_k] the projected inputs and outputs
    /// instants t_i every `spacing_s`, except for the last min((2p + 4)/a, 0.3 T) s
    /// ```
    pub(crate) fn rows(&self, segment: &Segment) -> DMatrix<f64> {
        let instants = self.instants(segment);
        let channels = segment.inputs.ncols() + segment.outputs.ncols();
        let mut rows = DMatrix::zeros(instants.len(), (self.past + 1) * channels);
        let bank = LaguerreBank::new(self.pole, segment.sample_time_s);
        let signals = segment
            .inputs
            .column_iter()
            .chain(segment.outputs.column_iter());
        for (channel, signal) in signals.enumerate() {
            let end = signal.iter().next_back().copied().unwrap_or_default();
            let signal: Vec<f64> = signal.iter().map(|sample| sample - end).collect();
            let projections = bank.projections(&signal, self.past);
            for (k, projection) in projections.column_iter().enumerate() {
                let mut column = rows.column_mut(k * channels + channel);
                for (to, &instant) in column.iter_mut().zip(&instants) {
                    *to = projection[instant];
                }
            }
        }
        rows
    }

    /// Returns the indices of the samples at which the rows of a segment are taken.
    fn instants(&self, segment: &Segment) -> Vec<usize> {
        let samples = segment.inputs.nrows();
        let duration = samples as f64 * segment.sample_time_s;
        let end = ((2.0 * self.past as f64 + 4.0) / self.pole).min(LARGEST_END * duration);
        let step = ((self.spacing_s / segment.sample_time_s).round() as usize).max(1);
        let last = samples.saturating_sub((end / segment.sample_time_s).ceil() as usize);
        (0..last).step_by(step).collect()
    }

    /// Computes the triangular factor of the data matrix of all segments.
    ///
    /// Trim and drift are projected out of each segment first. The result is bit for bit the same
    /// with any number of threads: they do not decide which segments are factored together.
    pub(crate) fn factor(&self, segments: &[Segment], executor: &dyn Executor) -> TriangularFactor {
        let parts = segments.chunks(segments.len().div_ceil(PARTS).max(1));
        let factors = each(executor, parts, |part| self.factor_part(part));
        let mut factors = factors.into_iter();
        let Some(mut factor) = factors.next() else {
            return TriangularFactor::empty(0);
        };
        for other in factors {
            factor.append(other.matrix());
        }
        factor
    }

    /// Computes the triangular factor of the data matrix of some segments.
    fn factor_part(&self, segments: &[Segment]) -> TriangularFactor {
        let channels = segments.first().map_or(0, |segment| {
            segment.inputs.ncols() + segment.outputs.ncols()
        });
        let mut factor = TriangularFactor::empty((self.past + 1) * channels);
        for segment in segments {
            let mut rows = self.rows(segment);
            remove_trend(&mut rows);
            factor.append(&rows);
        }
        factor
    }
}

/// Subtracts the projection on `[1, i]` from every column: trim and drift vanish exactly.
fn remove_trend(rows: &mut DMatrix<f64>) {
    let count = rows.nrows();
    let middle = (count.max(1) - 1) as f64 / 2.0;
    let ramp = DVector::from_fn(count, |row, _| row as f64 - middle);
    let squared = ramp.norm_squared();
    for mut column in rows.column_iter_mut() {
        let mean = column.sum() / count as f64;
        column.add_scalar_mut(-mean);
        if squared > 0.0 {
            let slope = ramp.dot(&column) / squared;
            column.axpy(-slope, &ramp, 1.0);
        }
    }
}

/// Returns the continuous-time model that corresponds to the model `law` of the Laguerre
/// projections with the pole `pole` \[rad/s\]; `None` if `Ao` has the eigenvalue -1.
///
/// ```text
/// xi_{k+1} = Ao xi_k + Bo u~_k + Ko e~_k,   y~_k = Co xi_k + Do u~_k + e~_k,   k = 0, 1, ...
/// M = (Ao + I)^-1
/// A = a M (Ao - I),   B = sqrt(2a) M Bo,   C = sqrt(2a) Co M,   D = Do - Co M Bo
/// ```
pub(crate) fn continuous(pole: f64, law: &StateSpace) -> Option<StateSpace> {
    let a = law.a();
    let b = law.b();
    let c = law.c();
    let d = law.d();
    let identity = DMatrix::identity(a.nrows(), a.nrows());
    let m = (a + &identity).try_inverse()?;
    let mb = &m * b;
    let cm = c * &m;
    let root = (2.0 * pole).sqrt();
    StateSpace::new(
        &m * (a - &identity) * pole,
        &mb * root,
        cm * root,
        d - c * mb,
    )
    .ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identification::known_answers_tests::{answers, matrix, number};

    #[test]
    fn projections_are_those_of_independent_code() {
        let known = &answers()["bank"];
        let signals = matrix(&known["x"]);
        let bank = LaguerreBank::new(number(&known["a"]), number(&known["dt"]));
        let count = number(&known["nk"]) as usize;
        for channel in 0..signals.ncols() {
            let projections = bank.projections(signals.column(channel).as_slice(), count - 1);
            for (sample, expected) in known["expected"].as_array().unwrap().iter().enumerate() {
                for k in 0..count {
                    // Expected values from independent numpy code; their file states the tolerance.
                    assert!(
                        (projections[(sample, k)] - number(&expected[k][channel])).abs() < 1e-12
                    );
                }
            }
        }
    }

    #[test]
    fn the_continuous_model_is_that_of_independent_code() {
        let known = &answers()["laguerre_to_ct"];
        let [a, b, c, d] = ["Ao", "Bo", "Co", "Do"].map(|name| matrix(&known[name]));
        let matrices = StateSpace::new(a, b, c, d).unwrap();
        let model = continuous(number(&known["a"]), &matrices).unwrap();
        for (found, name) in [
            (model.a(), "A"),
            (model.b(), "B"),
            (model.c(), "C"),
            (model.d(), "D"),
        ] {
            // Expected values from independent numpy code; their file states the tolerance.
            assert!((found - matrix(&known[name])).amax() < 1e-12, "{name}");
        }
    }

    #[test]
    fn an_eigenvalue_of_minus_one_has_no_continuous_model() {
        let one = DMatrix::from_element(1, 1, 1.0);
        let matrices = StateSpace::new(-&one, one.clone(), one.clone(), one).unwrap();
        assert_eq!(continuous(2.0, &matrices), None);
    }
}
