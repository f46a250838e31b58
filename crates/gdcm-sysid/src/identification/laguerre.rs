//! Laguerre projections of a record onto its own future (M14, section 3).
//!
//! ```text
//! s_k(t) = int_0^inf l_k(tau) s(t + tau) dtau,   l_k <-> sqrt(2a)/(s + a) ((a - s)/(a + s))^k,   k = 0 ... p
//!
//! 1  c = 2/dt, g = sqrt(2a)/(a + c), alpha = (a - c)/(a + c)                  (bilinear rule)
//! 2  x = the record less its last sample, from its end to its beginning
//! 3  y_0[n] = g (x[n] + x[n-1]) - alpha y_0[n-1]                              zero initial state
//! 4  y_k[n] = alpha y_{k-1}[n] + y_{k-1}[n-1] - alpha y_k[n-1]                k = 1 ... p
//! 5  each y_k from its end to its beginning
//! ```
//!
//! Bergamasco & Lovera, "Continuous-time predictor-based subspace identification using Laguerre filters", IET Control
//! Theory & Applications 5(7), 2011.

use nalgebra::{DMatrix, DMatrixView, DVector};

use gdcm_model::dataset::StateSpace;
use gdcm_model::executor::{Executor, each};
use gdcm_model::simulation::Segment;

/// The filters of one Laguerre pole at one sample time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LaguerreBank {
    /// Gain of the first filter.
    gain: f64,
    /// Pole of every filter with its sign changed, and zero of the all-pass filters.
    alpha: f64,
}

impl LaguerreBank {
    /// The filters with the pole `-pole` rad/s for samples every `sample_time_s`.
    pub(super) fn new(pole: f64, sample_time_s: f64) -> Self {
        let c = 2.0 / sample_time_s;
        Self {
            gain: (2.0 * pole).sqrt() / (pole + c),
            alpha: (pole - c) / (pole + c),
        }
    }

    /// Projections at every sample of a signal that ends near 0, one column for each of k = 0 ... `past`.
    pub(super) fn projections(self, signal: &[f64], past: usize) -> DMatrix<f64> {
        let samples = signal.len();
        let mut projections = DMatrix::zeros(samples, past + 1);
        let mut before = 0.0;
        let mut state = 0.0;
        for (&now, to) in signal
            .iter()
            .zip(projections.column_mut(0).iter_mut())
            .rev()
        {
            state = self.gain * (now + before) - self.alpha * state;
            before = now;
            *to = state;
        }
        let all = projections.as_mut_slice();
        for k in 1..=past {
            let (done, rest) = all.split_at_mut(k * samples);
            let mut before = 0.0;
            let mut state = 0.0;
            for (&now, to) in done[(k - 1) * samples..]
                .iter()
                .zip(&mut rest[..samples])
                .rev()
            {
                state = self.alpha * (now - state) + before;
                before = now;
                *to = state;
            }
        }
        projections
    }
}

// The data matrix of CT-PBSID, and its triangular factor for one Laguerre pole (M14, section 3, steps 1 and 2).
//
// ```text
// row t_i = [z_0(t_i) | z_1(t_i) | ... | z_p(t_i)],   z_k = [u~_k; y~_k] the projections of inputs and outputs
//
// 1  instants t_i every `spacing` s, but for the last min((2p + 4)/a, 0.3 T) s of a segment
// 2  from each column of a segment what [1, t_i] explains is taken off: trim and drift vanish exactly
// 3  R of the rows of each segment, merged in the order of the segments
// ```

/// Share of a segment that the projections' unfinished ends may cost at most.
const LARGEST_END: f64 = 0.3;

/// Which projections, and how far apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Projections {
    /// Laguerre pole `a` \[rad/s\].
    pub(super) pole: f64,
    /// `p`: projections 0 to `past` of every channel.
    pub(super) past: usize,
    /// Time between two instants \[s\].
    pub(super) spacing_s: f64,
}

impl Projections {
    /// The rows of one segment, with its trim and drift.
    pub(super) fn rows(&self, segment: &Segment) -> DMatrix<f64> {
        let samples = segment.inputs.nrows();
        let duration = samples as f64 * segment.sample_time_s;
        let end = ((2.0 * self.past as f64 + 4.0) / self.pole).min(LARGEST_END * duration);
        let step = ((self.spacing_s / segment.sample_time_s).round() as usize).max(1);
        let last = samples.saturating_sub((end / segment.sample_time_s).ceil() as usize);
        let instants: Vec<usize> = (0..last).step_by(step).collect();
        let inputs = segment.inputs.ncols();
        let outputs = segment.outputs.ncols();
        let channels = inputs + outputs;
        let mut rows = DMatrix::zeros(instants.len(), (self.past + 1) * channels);
        let bank = LaguerreBank::new(self.pole, segment.sample_time_s);
        for (channel, signal) in segment
            .inputs
            .column_iter()
            .chain(segment.outputs.column_iter())
            .enumerate()
        {
            let end = signal.iter().next_back().copied().unwrap_or_default();
            let signal: Vec<f64> = signal.iter().map(|sample| sample - end).collect();
            let projections = bank.projections(&signal, self.past);
            for (k, projection) in projections.column_iter().enumerate() {
                let mut column = rows.column_mut(k * channels + channel);
                column
                    .iter_mut()
                    .zip(&instants)
                    .for_each(|(to, &instant)| *to = projection[instant]);
            }
        }
        rows
    }

    /// The triangular factor of the data matrix of all segments.
    ///
    /// The same to the last bit on any number of threads: which segments are factored together does not depend on it.
    pub(super) fn factor(&self, segments: &[Segment], executor: &dyn Executor) -> TriangularFactor {
        /// Two parts keep two cores busy with three poles; merging a further one costs as much as a segment of 6 s.
        const PARTS: usize = 2;
        let part = |segments: &[Segment]| {
            let channels = segments.first().map_or(0, |segment| {
                segment.inputs.ncols() + segment.outputs.ncols()
            });
            let mut factor = TriangularFactor::empty((self.past + 1) * channels);
            for segment in segments {
                let mut rows = self.rows(segment);
                take_off_trend(&mut rows);
                factor.append(&rows);
            }
            factor
        };
        let mut parts = each(
            executor,
            segments.chunks(segments.len().div_ceil(PARTS).max(1)),
            part,
        )
        .into_iter();
        let Some(mut factor) = parts.next() else {
            return TriangularFactor::empty(0);
        };
        for other in parts {
            factor.append(other.matrix());
        }
        factor
    }
}

/// Takes what `[1, i]` explains off every column.
fn take_off_trend(rows: &mut DMatrix<f64>) {
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

// The law that Laguerre projections obey, and the model in continuous time behind it.

/// The model in continuous time behind the law of Laguerre projections with the pole `pole` \[rad/s\]; none where `Ao` has the
/// eigenvalue -1.
///
/// ```text
/// xi_{k+1} = Ao xi_k + Bo u~_k + Ko e~_k,   y~_k = Co xi_k + Do u~_k + e~_k   for the projections k = 0, 1, ...
/// M = (Ao + I)^-1,   A = a M (Ao - I),   B = sqrt(2a) M Bo,   C = sqrt(2a) Co M,   D = Do - Co M Bo
/// ```
pub(super) fn continuous(pole: f64, law: &StateSpace) -> Option<StateSpace> {
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

// The triangular factor of a tall matrix that arrives in blocks of rows.
//
// ```text
// R <- qr([R; rows]), R upper triangular, for each panel of columns J of the width w:
// 1  for each column j of J: beta = -sign(R_jj) hypot(R_jj, |b_j|), v_j = b_j / (R_jj - beta), tau_j = (beta - R_jj) / beta
//       the reflector is I - tau_j [e_j; v_j] [e_j; v_j]', applied to the columns of J that follow
// 2  T upper triangular: T_jj = tau_j, T_:j = -tau_j T (V' v_j)                     (I - [E; V] T [E; V]')
// 3  columns right of J: W = T' (R_J + V' rows), R_J -= W, rows -= V W              (two products of matrices)
// ```
//
// Nothing is squared. Householder QR in the compact form of Schreiber & Van Loan, SIAM J. Sci. Stat. Comput. 10, 1989; the upper
// part of each reflector is one entry because R is triangular already (Demmel, Grigori, Hoemmen & Langou, SIAM J. Sci.
// Comput. 34, 2012).

/// Columns of a panel.
const PANEL: usize = 16;
/// Rows taken in at once: a block of them and the panel stay in the processor's second cache.
const ROWS: usize = 256;

/// `R` of `A = Q R` for the rows of `A` seen so far: square and upper triangular, signs of its rows arbitrary.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TriangularFactor(DMatrix<f64>);

impl TriangularFactor {
    /// The factor of no rows.
    pub(super) fn empty(columns: usize) -> Self {
        Self(DMatrix::zeros(columns, columns))
    }

    /// The upper triangular matrix.
    pub(super) fn matrix(&self) -> &DMatrix<f64> {
        &self.0
    }

    /// Takes in further rows.
    pub(super) fn append(&mut self, rows: &DMatrix<f64>) {
        for first in (0..rows.nrows()).step_by(ROWS) {
            let count = ROWS.min(rows.nrows() - first);
            self.append_block(rows.rows(first, count).into_owned());
        }
    }

    fn append_block(&mut self, mut rows: DMatrix<f64>) {
        let columns = self.0.ncols();
        for first in (0..columns).step_by(PANEL) {
            let width = PANEL.min(columns - first);
            let t = self.reflect_panel(&mut rows, first, width);
            let rest = columns - first - width;
            if rest == 0 {
                return;
            }
            let (panel, mut right) =
                rows.columns_range_pair_mut(first..first + width, first + width..columns);
            let mut w = self
                .0
                .view((first, first + width), (width, rest))
                .into_owned();
            w.gemm(1.0, &panel.transpose(), &right, 1.0);
            let w = t.transpose() * w;
            let mut upper = self.0.view_mut((first, first + width), (width, rest));
            upper -= &w;
            right.gemm(-1.0, &panel, &w, 1.0);
        }
    }

    /// Leaves the vectors of the reflectors in the panel's columns of `rows`; gives `T`.
    fn reflect_panel(
        &mut self,
        rows: &mut DMatrix<f64>,
        first: usize,
        width: usize,
    ) -> DMatrix<f64> {
        let mut t = DMatrix::zeros(width, width);
        for j in 0..width {
            let column = first + j;
            let below = rows.column(column).norm();
            if below == 0.0 {
                continue;
            }
            let diagonal = self.0[(column, column)];
            let beta = -below.hypot(diagonal).copysign(diagonal);
            rows.column_mut(column).unscale_mut(diagonal - beta);
            let tau = (beta - diagonal) / beta;
            self.0[(column, column)] = beta;
            let (v, mut later) = rows.columns_range_pair_mut(column, column + 1..first + width);
            for (k, mut other) in later.column_iter_mut().enumerate() {
                let entry = &mut self.0[(column, column + 1 + k)];
                let w = tau * (*entry + v.dot(&other));
                *entry -= w;
                other.axpy(-w, &v, 1.0);
            }
            let products =
                DVector::from_fn(j, |k, _| rows.column(first + k).dot(&rows.column(column)));
            let above = t.view((0, 0), (j, j)) * products * -tau;
            t.view_mut((0, j), (j, 1)).copy_from(&above);
            t[(j, j)] = tau;
        }
        t
    }
}

/// `X = argmin |A X - Y|^2 + ridge |N X|^2` from the triangular factor of `[A Y]`, `N` the lengths of the columns of `A`, of which
/// there are `regressors`; none where they depend on each other.
pub(super) fn ridge_solution(
    factor: DMatrixView<'_, f64>,
    regressors: usize,
    ridge: f64,
) -> Option<DMatrix<f64>> {
    let lengths: Vec<f64> = factor
        .column_iter()
        .take(regressors)
        .map(|column| column.norm())
        .collect();
    if lengths.contains(&0.0) {
        return None;
    }
    let mut stacked = TriangularFactor(factor.into_owned());
    for (mut column, length) in stacked.0.column_iter_mut().zip(&lengths) {
        column.unscale_mut(*length);
    }
    if ridge > 0.0 {
        let mut rows = DMatrix::zeros(regressors, factor.ncols());
        rows.fill_diagonal(ridge.sqrt());
        stacked.append(&rows);
    }
    let targets = factor.ncols() - regressors;
    let mut solution = stacked
        .0
        .view((0, regressors), (regressors, targets))
        .into_owned();
    if !stacked
        .0
        .view((0, 0), (regressors, regressors))
        .solve_upper_triangular_mut(&mut solution)
    {
        return None;
    }
    for (mut row, length) in solution.row_iter_mut().zip(&lengths) {
        row.unscale_mut(*length);
    }
    solution
        .iter()
        .all(|entry| entry.is_finite())
        .then_some(solution)
}

/// `X = argmin |A X - Y|^2`, by a triangular factor of the scaled columns; none where those of `A` depend on each other.
pub(super) fn least_squares(a: &DMatrix<f64>, y: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let mut both = DMatrix::zeros(a.nrows(), a.ncols() + y.ncols());
    both.columns_mut(0, a.ncols()).copy_from(a);
    both.columns_mut(a.ncols(), y.ncols()).copy_from(y);
    let mut factor = TriangularFactor::empty(both.ncols());
    factor.append(&both);
    ridge_solution(factor.0.as_view(), a.ncols(), 0.0)
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
                    // Independent numpy code; the tolerance stands in its file.
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
        let of = |name: &str| matrix(&known[name]);
        let matrices = StateSpace::new(of("Ao"), of("Bo"), of("Co"), of("Do")).unwrap();
        let model = continuous(number(&known["a"]), &matrices).unwrap();
        for (found, name) in [
            (model.a(), "A"),
            (model.b(), "B"),
            (model.c(), "C"),
            (model.d(), "D"),
        ] {
            // Independent numpy code; the tolerance stands in its file.
            assert!((found - of(name)).amax() < 1e-12, "{name}");
        }
    }

    #[test]
    fn an_eigenvalue_of_minus_one_has_no_continuous_model() {
        let one = DMatrix::from_element(1, 1, 1.0);
        let matrices = StateSpace::new(-&one, one.clone(), one.clone(), one).unwrap();
        assert_eq!(continuous(2.0, &matrices), None);
    }

    fn sample(rows: usize, columns: usize) -> DMatrix<f64> {
        DMatrix::from_fn(rows, columns, |row, column| {
            ((1.0 + 7.3 * row as f64) * (1.0 + 2.9 * column as f64)).sin()
        })
    }

    #[test]
    fn the_factor_is_that_of_all_rows_at_once() {
        let rows = sample(700, 37);
        let mut factor = TriangularFactor::empty(37);
        factor.append(&rows.rows(0, 300).into_owned());
        factor.append(&rows.rows(300, 400).into_owned());
        let at_once = rows.qr().r();
        for (row, expected) in at_once.row_iter().enumerate() {
            let found = factor.matrix().row(row);
            let sign = if found[row] * expected[row] < 0.0 {
                -1.0
            } else {
                1.0
            };
            // Orthogonal transformations: the error is a few roundings of the norm of the matrix, 100.
            assert!((found * sign - expected).norm() < 1e-11, "row {row}");
        }
    }

    #[test]
    fn a_column_of_zeros_does_no_harm() {
        let mut rows = sample(50, 5);
        rows.column_mut(2).fill(0.0);
        let mut factor = TriangularFactor::empty(5);
        factor.append(&rows);
        assert!(factor.matrix().iter().all(|entry| entry.is_finite()));
        let gram = factor.matrix().transpose() * factor.matrix();
        assert!((gram - rows.transpose() * &rows).norm() < 1e-12 * rows.norm_squared());
    }
}
