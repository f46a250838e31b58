//! Modes of a model: poles, natural frequency, damping, and participation of the states.
//!
//! ```text
//! 1  balance A; A = Q T Q^H, T triangular with the poles lambda_k on its diagonal
//! 2  for each k: x_k = 1, x_j = -(sum_(j < i <= k) t_ji x_i) / (t_jj - lambda_k), j = k - 1 ... 1;    v = Q x
//! 3              y_k = 1, y_j = -(sum_(k <= i < j) y_i t_ij) / (t_jj - lambda_k), j = k + 1 ... n;    w = y Q^H
//! 4  w v = 1: the pole moves by |w| |v| for each unit by which A changes; beyond a limit it is near defective
//! 5  participation of state i: |w_i v_i| / sum_j |w_j v_j|, whatever the units of the states are
//! 6  residue of output i over the inputs together: (C v)_i |w B|
//! ```
//!
//! Eigenvectors: Golub & Van Loan, "Matrix Computations", 4th ed. 2013, 7.6.4. Participation:
//! Perez-Arriaga, Verghese & Schweppe, "Selective modal analysis", IEEE Trans. Power Apparatus and
//! Systems 101(9), 1982.
//!
//! Poles and zeros of a model in the s-plane, for continuous and discrete time (M2a).
//!
//! Eigenvalues of a real matrix, and the triangular form for its eigenvectors.
//!
//! ```text
//! 1  A = Q T Q', T with blocks of one and two rows on its diagonal: Francis' implicit double shifts
//! 2  for each block of two rows [p q; r s]: mean and half difference m = (p + s) / 2, h = (p - s) / 2
//!       lambda = m +- j sqrt(-(h^2 + q r)), conjugate to the last digit; or two real ones
//! 3     rotate its rows so that the block becomes triangular: first column (lambda - s, r) / norm
//! ```
//!
//! Golub & Van Loan, "Matrix Computations", 4th ed. 2013, 7.4 and 7.5.

use nalgebra::{Complex, DMatrix, DVector, Schur};

use super::hessenberg_form::balance;
use super::prepared_model::LargeEntry;
use crate::dataset::{Dynamics, StateSpace};

/// Pole movement per unit change of the balanced A above which eigenvectors are meaningless: 1e8 in
/// floating point for a double pole with a single eigenvector, below 1e3 for a simple pole.
const NEAR_DEFECTIVE: f64 = 1e6;

/// A pole of a model and the motion it describes.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// The pole `lambda` \[rad/s\].
    pub pole: Complex<f64>,
    /// Undamped natural frequency `|lambda|` \[rad/s\].
    pub frequency_rad_s: f64,
    /// `-Re lambda / |lambda|`, negative for a growing mode; `None` for a pole at zero.
    pub damping_ratio: Option<f64>,
    /// `-1 / Re lambda` \[s\], negative for a growing mode; `None` for a mode that neither grows
    /// nor decays.
    pub time_constant_s: Option<f64>,
    /// Participation of each state (index, share), in descending order, sum 1; or the reason why
    /// there is none.
    pub participation: Result<Vec<(usize, f64)>, NearDefective>,
    /// Residue of each output over all inputs: magnitude is the norm of the output's row of the
    /// residue matrix, phase is relative to the other outputs. `None` for a near-defective pole.
    pub residues: Option<Vec<Complex<f64>>>,
}

/// The error for a pole so close to another that its eigenvectors, and thus the participation of
/// the states, are rounding errors: both share an eigenvector or coincide, as for two identical
/// sensors.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "the pole cannot be told from another next to it: a change of A by 1e-16 of itself moves it {movement:.0e} times as far, so \
     the shares of the states mean nothing"
)]
pub struct NearDefective {
    /// Movement of the pole per unit change of A.
    pub movement: f64,
}

/// Why the modes of a model are unavailable.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ModesError {
    /// An entry is too large to compute with.
    #[error("{0}")]
    TooLarge(LargeEntry),
    /// The eigenvalue iteration did not converge.
    #[error(
        "the eigenvalues of its matrix A were not found: the iteration does not come to an end"
    )]
    NotConverged,
}

impl Mode {
    fn new(
        pole: Complex<f64>,
        participation: Result<Vec<(usize, f64)>, NearDefective>,
        residues: Option<Vec<Complex<f64>>>,
    ) -> Self {
        let frequency_rad_s = pole.norm();
        Self {
            pole,
            frequency_rad_s,
            damping_ratio: (frequency_rad_s > 0.0).then(|| -pole.re / frequency_rad_s),
            time_constant_s: (pole.re != 0.0).then(|| -1.0 / pole.re),
            participation,
            residues,
        }
    }

    /// Returns whether the mode oscillates: a complex pole. In discrete time this includes a sign
    /// that alternates from sample to sample, which is a single pole.
    pub fn oscillates(&self) -> bool {
        self.pole.im != 0.0
    }
}

/// Computes the modes of a model, one per pole, in ascending `|lambda|`; of a conjugate pair, the
/// pole above the real axis comes first, and the other is its exact conjugate. A pole below the
/// rounding of the matrix counts as zero.
///
/// Discrete-time poles are given as `s = ln z / T`; poles at `z = 0`, which vanish within one
/// sample, have no `s` and are left out (M2a). Channel delays do not move poles.
///
/// # Errors
/// [`ModesError`] where the eigenvalues cannot be computed.
pub fn modes(model: &StateSpace) -> Result<Vec<Mode>, ModesError> {
    if let Some(entry) = LargeEntry::of(model) {
        return Err(ModesError::TooLarge(entry));
    }
    let plane = SPlane::of(model);
    let mut a = plane.matrix(model.a());
    let mut b = model.b().clone();
    let mut c = model.c().clone();
    balance(&mut a, &mut b, &mut c);
    let form = SchurForm::of(&a).ok_or(ModesError::NotConverged)?;
    let rounding = 4.0 * f64::EPSILON * a.nrows() as f64 * a.norm();
    let mut modes: Vec<Mode> = Vec::with_capacity(a.nrows());
    let mut last_pair: Option<Mode> = None;
    for (index, eigenvalue) in form.eigenvalues().into_iter().enumerate() {
        if let Some(upper) = last_pair.take() {
            let residues = upper
                .residues
                .map(|residues| residues.iter().map(Complex::conj).collect());
            modes.push(Mode::new(upper.pole.conj(), upper.participation, residues));
            continue;
        }
        let eigenvalue = if eigenvalue.norm() <= rounding {
            Complex::from(0.0)
        } else {
            eigenvalue
        };
        let Some(pole) = plane.value(eigenvalue) else {
            continue;
        };
        let vectors = Eigenvectors::of(&form, index);
        let residues = vectors
            .as_ref()
            .ok()
            .map(|vectors| vectors.residues(&b, &c));
        let mode = Mode::new(
            pole,
            vectors.map(|vectors| vectors.participation()),
            residues,
        );
        last_pair = (eigenvalue.im > 0.0).then(|| mode.clone());
        modes.push(mode);
    }
    modes.sort_by(|a, b| {
        let by_size = a.frequency_rad_s.total_cmp(&b.frequency_rad_s);
        by_size
            .then(a.pole.re.total_cmp(&b.pole.re))
            .then(b.pole.im.total_cmp(&a.pole.im))
    });
    Ok(modes)
}

/// Computes the [`modes`] of a model given by matrices; empty for a measured response, which has no
/// states.
///
/// # Errors
/// As [`modes`].
pub fn modes_of(dynamics: &Dynamics) -> Result<Vec<Mode>, ModesError> {
    match dynamics {
        Dynamics::StateSpace(model) => modes(model),
        Dynamics::Measured(_) => Ok(Vec::new()),
    }
}

/// The eigenvectors of an eigenvalue: `A v = lambda v`, `w A = lambda w` and `w v = 1`.
struct Eigenvectors {
    right: DVector<Complex<f64>>,
    left: DVector<Complex<f64>>,
}

impl Eigenvectors {
    /// Computes the eigenvectors for the eigenvalue at position `index` on the diagonal.
    fn of(form: &SchurForm, index: usize) -> Result<Self, NearDefective> {
        let x = form.right(index);
        let y = form.left(index);
        let movement = x.norm() * y.norm();
        // Also true for NaN, where they overflow.
        if !movement.le(&NEAR_DEFECTIVE) {
            return Err(NearDefective { movement });
        }
        Ok(Self {
            right: &form.q * x,
            left: form.q.conjugate() * y,
        })
    }

    /// Returns the participation of the states, in descending order.
    fn participation(&self) -> Vec<(usize, f64)> {
        let products: Vec<f64> = self
            .right
            .iter()
            .zip(&self.left)
            .map(|(v, w)| (v * w).norm())
            .collect();
        let sum: f64 = products.iter().sum();
        let mut shares: Vec<(usize, f64)> = products
            .into_iter()
            .map(|product| product / sum)
            .enumerate()
            .collect();
        shares.sort_by(|a, b| b.1.total_cmp(&a.1));
        shares
    }

    /// Returns `(C v)_i |w B|` for each output.
    fn residues(&self, b: &DMatrix<f64>, c: &DMatrix<f64>) -> Vec<Complex<f64>> {
        let of_inputs = (b.map(Complex::from).transpose() * &self.left).norm();
        (c.map(Complex::from) * &self.right)
            .iter()
            .map(|output| output * of_inputs)
            .collect()
    }
}

/// Maps eigenvalues of matrices to poles and zeros `s` \[rad/s\]: unchanged in continuous time,
/// `s = ln z / T` in discrete time.
#[derive(Clone, Copy, Debug)]
pub(super) struct SPlane {
    sample_time_s: Option<f64>,
}

/// `|z|` below which a mode vanishes within one sample: it counts as `z = 0`, which has no `s`.
const GONE: f64 = 1e-6;

impl SPlane {
    /// Returns the s-plane of a model.
    pub(super) fn of(model: &StateSpace) -> Self {
        Self {
            sample_time_s: model.timing().sample_time_s,
        }
    }

    /// Returns the matrix for the eigenvalue computation: `A`, or `A - I` in discrete time, which
    /// keeps more digits for fast sampling.
    pub(super) fn matrix(self, a: &DMatrix<f64>) -> DMatrix<f64> {
        match self.sample_time_s {
            None => a.clone(),
            Some(_) => a - DMatrix::identity(a.nrows(), a.ncols()),
        }
    }

    /// Returns the `s` for an eigenvalue of [`SPlane::matrix`]: `lambda`, or the principal value of
    /// `ln(1 + lambda) / T`; `None` where `z = 1 + lambda` is zero.
    pub(super) fn value(self, eigenvalue: Complex<f64>) -> Option<Complex<f64>> {
        let Some(sample_time_s) = self.sample_time_s else {
            return Some(eigenvalue);
        };
        let Complex { re, im } = eigenvalue;
        if (eigenvalue + 1.0).norm() < GONE {
            return None;
        }
        let modulus = 0.5 * (re * (2.0 + re) + im * im).ln_1p();
        Some(Complex::new(modulus, im.atan2(1.0 + re)) / sample_time_s)
    }
}

/// `A = Q T Q^H` with `Q` unitary and `T` upper triangular.
pub struct SchurForm {
    /// Schur vectors.
    pub q: DMatrix<Complex<f64>>,
    /// Triangular, with the eigenvalues on its diagonal.
    pub t: DMatrix<Complex<f64>>,
    /// Smallest difference of two eigenvalues above rounding.
    least: f64,
}

impl SchurForm {
    /// Computes the Schur form of a square matrix; `None` where the iteration does not converge.
    pub fn of(a: &DMatrix<f64>) -> Option<Self> {
        let (q, t) = quasi_triangular(a)?;
        let blocks: Vec<usize> = (1..a.nrows())
            .filter(|&row| t[(row, row - 1)] != 0.0)
            .map(|row| row - 1)
            .collect();
        let mut form = Self {
            q: q.map(Complex::from),
            t: t.map(Complex::from),
            least: 0.0,
        };
        for first in blocks {
            form.split(
                first,
                t.fixed_view::<2, 2>(first, first)
                    .into_owned()
                    .transpose()
                    .data
                    .0,
            );
        }
        form.least = (f64::EPSILON * form.t.camax()).max(f64::MIN_POSITIVE);
        Some(form)
    }

    /// Returns the eigenvalues in the order of the diagonal; pairs are exact conjugates.
    pub(super) fn eigenvalues(&self) -> Vec<Complex<f64>> {
        self.t.diagonal().iter().copied().collect()
    }

    /// Returns the unit eigenvector for the eigenvalue at a position on the diagonal.
    pub fn eigenvector(&self, at: usize) -> DVector<Complex<f64>> {
        (&self.q * self.right(at)).normalize()
    }

    /// Solves `(T - t_kk) x = 0` with `x_k = 1`.
    fn right(&self, k: usize) -> DVector<Complex<f64>> {
        let mut x = self.unit(k);
        for row in (0..k).rev() {
            let sum: Complex<f64> = (row + 1..=k)
                .map(|column| self.t[(row, column)] * x[column])
                .sum();
            x[row] = -sum / self.apart(row, k);
        }
        x
    }

    /// Solves `y (T - t_kk) = 0` with `y_k = 1`.
    fn left(&self, k: usize) -> DVector<Complex<f64>> {
        let mut y = self.unit(k);
        for column in k + 1..self.t.nrows() {
            let sum: Complex<f64> = (k..column).map(|row| y[row] * self.t[(row, column)]).sum();
            y[column] = -sum / self.apart(column, k);
        }
        y
    }

    fn unit(&self, k: usize) -> DVector<Complex<f64>> {
        DVector::from_fn(self.t.nrows(), |row, _| {
            Complex::from(if row == k { 1.0 } else { 0.0 })
        })
    }

    /// Returns the difference of two eigenvalues, at least the rounding error for equal ones.
    fn apart(&self, of: usize, from: usize) -> Complex<f64> {
        let difference = self.t[(of, of)] - self.t[(from, from)];
        if difference.norm() < self.least {
            Complex::from(self.least)
        } else {
            difference
        }
    }

    /// Makes the block in rows `first` and `first + 1` triangular.
    fn split(&mut self, first: usize, block: [[f64; 2]; 2]) {
        let second = first + 1;
        let size = self.t.nrows();
        let eigenvalues = eigenvalues_of_block(block);
        let mu = eigenvalues[0] - block[1][1];
        let below = block[1][0];
        let norm = mu.norm().hypot(below);
        let c = mu / norm;
        let s = below / norm;
        for column in first..size {
            let upper = self.t[(first, column)];
            let lower = self.t[(second, column)];
            self.t[(first, column)] = c.conj() * upper + lower * s;
            self.t[(second, column)] = c * lower - upper * s;
        }
        for row in 0..size {
            if row <= second {
                rotate_columns(&mut self.t, row, first, (c, s));
            }
            rotate_columns(&mut self.q, row, first, (c, s));
        }
        self.t[(second, first)] = Complex::new(0.0, 0.0);
        [self.t[(first, first)], self.t[(second, second)]] = eigenvalues;
    }
}

fn rotate_columns(
    matrix: &mut DMatrix<Complex<f64>>,
    row: usize,
    first: usize,
    (c, s): (Complex<f64>, f64),
) {
    let left = matrix[(row, first)];
    let right = matrix[(row, first + 1)];
    matrix[(row, first)] = left * c + right * s;
    matrix[(row, first + 1)] = right * c.conj() - left * s;
}

/// Returns the eigenvalues of a 2 x 2 block `[p q; r s]`, the one with positive imaginary part
/// first.
fn eigenvalues_of_block([[p, q], [r, s]]: [[f64; 2]; 2]) -> [Complex<f64>; 2] {
    let mean = 0.5 * (p + s);
    let half = 0.5 * (p - s);
    let squared = half * half + q * r;
    if squared < 0.0 {
        let imaginary = (-squared).sqrt();
        return [
            Complex::new(mean, imaginary),
            Complex::new(mean, -imaginary),
        ];
    }
    // The larger distance from s has no cancellation, and the product of both distances is -q r.
    let far = half + squared.sqrt().copysign(half);
    let near = if far == 0.0 { 0.0 } else { -q * r / far };
    [Complex::from(s + far), Complex::from(s + near)]
}

/// Computes `A = Q T Q'`. A stalled iteration (a cyclic permutation is a fixed point) is repeated
/// on a reflection of the matrix, which has the same eigenvalues.
fn quasi_triangular(a: &DMatrix<f64>) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
    const TRIES: i32 = 3;
    /// Three or four are typical.
    const ITERATIONS_FOR_EACH: usize = 60;
    let size = a.nrows();
    let most = ITERATIONS_FOR_EACH * (size + 1);
    (0..TRIES).find_map(|attempt| {
        if attempt == 0 {
            return Schur::try_new(a.clone(), f64::EPSILON, most).map(Schur::unpack);
        }
        let axis = DVector::from_fn(size, |row, _| (1.0 + f64::from(attempt) * row as f64).sin())
            .normalize();
        let reflection = DMatrix::identity(size, size) - 2.0 * &axis * axis.transpose();
        let (q, t) = Schur::try_new(&reflection * a * &reflection, f64::EPSILON, most)?.unpack();
        Some((reflection * q, t))
    })
}

impl SchurForm {
    /// Exchanges neighbours until the eigenvalues selected by `first` come first; returns their
    /// number.
    pub fn order_by(&mut self, first: impl Fn(Complex<f64>) -> bool) -> usize {
        let mut placed = 0;
        for at in 0..self.t.nrows() {
            if first(self.t[(at, at)]) {
                for upper in (placed..at).rev() {
                    self.exchange(upper);
                }
                placed += 1;
            }
        }
        placed
    }

    /// Exchanges the eigenvalues at `upper` and `upper + 1` by one rotation of these two rows and
    /// columns.
    fn exchange(&mut self, upper: usize) {
        let lower = upper + 1;
        let first = self.t[(upper, upper)];
        let second = self.t[(lower, lower)];
        // The eigenvector for `second` in these two rows.
        let x = self.t[(upper, lower)];
        let y = second - first;
        let norm = x.norm().hypot(y.norm());
        if norm == 0.0 {
            return;
        }
        let c = x / norm;
        let s = y / norm;
        for matrix in [&mut self.t, &mut self.q] {
            for row in 0..matrix.nrows() {
                let left = matrix[(row, upper)];
                let right = matrix[(row, lower)];
                matrix[(row, upper)] = left * c + right * s;
                matrix[(row, lower)] = right * c.conj() - left * s.conj();
            }
        }
        for column in 0..self.t.ncols() {
            let above = self.t[(upper, column)];
            let below = self.t[(lower, column)];
            self.t[(upper, column)] = above * c.conj() + below * s.conj();
            self.t[(lower, column)] = below * c - above * s;
        }
        self.t[(lower, upper)] = Complex::new(0.0, 0.0);
        (self.t[(upper, upper)], self.t[(lower, lower)]) = (second, first);
    }
}

/// Returns the eigenvalues of A without balancing \[rad/s for continuous time\], or `None` where
/// the Schur iteration does not converge.
#[must_use]
pub fn poles(model: &StateSpace) -> Option<Vec<Complex<f64>>> {
    let schur =
        nalgebra::Schur::try_new(model.a().clone(), f64::EPSILON, 100 * (model.order() + 1))?;
    Some(schur.complex_eigenvalues().iter().copied().collect())
}

#[cfg(test)]
mod tests {
    use nalgebra::dmatrix;
    use proptest::prelude::*;

    use super::*;
    use crate::dataset::state_space::Timing;

    fn model(a: DMatrix<f64>) -> StateSpace {
        let n = a.nrows();
        StateSpace::new(
            a,
            DMatrix::zeros(n, 1),
            DMatrix::zeros(1, n),
            DMatrix::zeros(1, 1),
        )
        .unwrap()
    }

    #[test]
    fn an_oscillator_and_a_lag_have_the_modes_of_the_textbook() {
        // x'' + 2 0.3 4 x' + 16 x = 0 beside x' = -0.5 x.
        let found = modes(&model(
            dmatrix![0.0, 1.0, 0.0; -16.0, -2.4, 0.0; 0.0, 0.0, -0.5],
        ))
        .unwrap();
        assert_eq!(found.len(), 3);
        assert_eq!(
            (found[0].pole, found[0].time_constant_s),
            (Complex::new(-0.5, 0.0), Some(2.0))
        );
        assert_eq!(found[0].participation.as_ref().unwrap()[0], (2, 1.0));
        assert!((found[1].frequency_rad_s - 4.0).abs() < 1e-14 && found[1].pole.im > 0.0);
        assert!((found[1].damping_ratio.unwrap() - 0.3).abs() < 1e-15);
        assert_eq!(found[2].pole, found[1].pole.conj());
        // |w_i v_i| is the same for position and speed of an oscillator.
        for &(_, share) in &found[1].participation.as_ref().unwrap()[..2] {
            assert!((share - 0.5).abs() < 1e-14);
        }
    }

    #[test]
    fn an_integrator_is_a_pole_at_zero_without_a_time_constant() {
        let found = modes(&model(dmatrix![0.0, 1.0; 0.0, -2.0])).unwrap();
        assert_eq!(
            (found[0].pole, found[0].time_constant_s),
            (Complex::from(0.0), None)
        );
        assert_eq!(
            (found[0].damping_ratio, found[0].frequency_rad_s),
            (None, 0.0)
        );
    }

    #[test]
    fn two_poles_that_share_an_eigenvector_have_no_participation_and_say_why() {
        let found = modes(&model(
            dmatrix![-1.0, 1.0, 0.0; 0.0, -1.0, 0.0; 0.0, 0.0, -3.0],
        ))
        .unwrap();
        let why = found[0].participation.as_ref().unwrap_err();
        assert!(why.movement > 1e15 && why.to_string().contains("cannot be told from another"));
        assert_eq!(
            found[2].participation.as_ref().unwrap()[0],
            (2, 1.0),
            "the third is by itself"
        );
        let apart = modes(&model(dmatrix![-1.0, 1.0; 0.0, -1.001])).unwrap();
        assert!(
            apart[0].participation.is_ok(),
            "poles a thousandth apart can be told from one another"
        );
    }

    #[test]
    fn modes_of_discrete_time_are_those_that_were_sampled() {
        // e^(A T) for the oscillator and the lag above, T = 0.02 s; an alternating sign, and a
        // state that vanishes within a sample.
        let sampled = (dmatrix![0.0, 1.0, 0.0; -16.0, -2.4, 0.0; 0.0, 0.0, -0.5] * 0.02).exp();
        let mut a = DMatrix::zeros(5, 5);
        a.view_mut((0, 0), (3, 3)).copy_from(&sampled);
        a[(3, 3)] = -1.0;
        let timing = Timing {
            sample_time_s: Some(0.02),
            ..Timing::default()
        };
        let found = modes(&model(a).timed(timing).unwrap()).unwrap();
        let imaginary = (16.0_f64 - 1.44).sqrt();
        let alternating = 50.0 * std::f64::consts::PI;
        let expected = [
            (-0.5, 0.0),
            (-1.2, imaginary),
            (-1.2, -imaginary),
            (0.0, alternating),
        ];
        assert_eq!(found.len(), 4, "the pole at z = 0 has no s");
        for (mode, (re, im)) in found.iter().zip(expected) {
            // The exponential rounds by about 1e-16, in s by 50 times as much.
            assert!(
                (mode.pole - Complex::new(re, im)).norm() < 1e-12,
                "{} {re} {im}",
                mode.pole
            );
        }
    }

    #[test]
    fn a_model_without_states_has_no_modes_and_one_too_large_is_refused() {
        assert_eq!(modes(&model(DMatrix::zeros(0, 0))), Ok(Vec::new()));
        assert!(matches!(
            modes(&model(dmatrix![1e80])),
            Err(ModesError::TooLarge(_))
        ));
    }

    proptest! {
        #[test]
        fn units_of_the_states_change_neither_poles_nor_participation(
            entries in prop::collection::vec(-2.0_f64..2.0, 25), exponents in prop::collection::vec(-12_i32..12, 5),
        ) {
            let a = DMatrix::from_vec(5, 5, entries);
            // Powers of two: no rounding.
            let scaled = DMatrix::from_fn(5, 5, |row, column| a[(row, column)] * 2.0_f64.powi(exponents[row] - exponents[column]));
            let plain = modes(&model(a.clone())).unwrap();
            let scaled = modes(&model(scaled)).unwrap();
            for mode in &plain {
                let Ok(shares) = &mode.participation else { continue };
                let near = |other: &&Mode| (other.pole - mode.pole).norm();
                let same = scaled.iter().min_by(|a, b| near(a).total_cmp(&near(b))).unwrap();
                // The movement is at most 1e6; for poles of such matrices it is mostly 1 to 100.
                prop_assert!(near(&same) < 1e-8, "{} {}", same.pole, mode.pole);
                let Ok(others) = &same.participation else { continue };
                let share_of = |state: usize| others.iter().find(|(other, _)| *other == state).map_or(0.0, |(_, share)| *share);
                let alone = plain.iter().all(|other| other.pole == mode.pole || (other.pole - mode.pole).norm() > 1e-3);
                prop_assert!(!alone || shares.iter().all(|(state, share)| (share - share_of(*state)).abs() < 1e-6));
            }
        }
    }
}

#[cfg(test)]
mod s_plane_tests {
    use super::*;

    const SAMPLED: SPlane = SPlane {
        sample_time_s: Some(0.01),
    };

    #[test]
    fn a_sampled_pole_is_found_where_it_was() {
        for s in [
            Complex::new(-0.001, 0.0),
            Complex::new(-2.0, 30.0),
            Complex::new(0.3, -1e-3),
        ] {
            let found = SAMPLED.value((s * 0.01).exp() - 1.0).unwrap();
            // The difference from 1 rounds by 1e-16, a hundred times as much in s.
            assert!((found - s).norm() < 1e-13, "{found} {s}");
        }
    }

    #[test]
    fn what_is_gone_within_a_sample_has_no_s_and_a_constant_has_zero() {
        assert_eq!(SAMPLED.value(Complex::from(-1.0)), None);
        assert_eq!(SAMPLED.value(Complex::from(0.0)), Some(Complex::from(0.0)));
        let alternating = SAMPLED.value(Complex::from(-2.0)).unwrap();
        assert_eq!(alternating, Complex::new(0.0, 100.0 * std::f64::consts::PI));
    }
}

#[cfg(test)]
mod schur_form_tests {
    use nalgebra::dmatrix;

    use super::*;

    fn check(a: &DMatrix<f64>) {
        let form = SchurForm::of(a).unwrap();
        let again = &form.q * &form.t * form.q.adjoint();
        // A few hundred rotations of the whole matrix, each backward stable.
        assert!((again - a.map(Complex::from)).norm() < 1e-13 * a.norm());
        let below = (0..a.nrows()).flat_map(|row| (0..row).map(move |column| (row, column)));
        assert!(
            below
                .into_iter()
                .all(|at| form.t[at].norm() <= 1e-15 * a.norm())
        );
    }

    #[test]
    fn an_eigenvector_is_stretched_by_its_eigenvalue() {
        let a = DMatrix::from_fn(9, 9, |row, column| {
            ((1.0 + 7.3 * row as f64) * (1.0 + 2.9 * column as f64)).sin()
        });
        let form = SchurForm::of(&a).unwrap();
        for at in 0..9 {
            let vector = form.eigenvector(at);
            assert!((a.map(Complex::from) * &vector - &vector * form.t[(at, at)]).norm() < 1e-12);
        }
    }

    #[test]
    fn the_form_gives_the_matrix_again() {
        check(&DMatrix::from_fn(9, 9, |row, column| {
            ((1.0 + 7.3 * row as f64) * (1.0 + 2.9 * column as f64)).sin()
        }));
        check(&dmatrix![0.0, 1.0; -4.0, -0.4]);
        check(&dmatrix![1.0, 1e-9; 1e-9, 1.0]);
    }

    #[test]
    fn a_cyclic_permutation_has_the_roots_of_unity() {
        let shift = DMatrix::from_fn(
            8,
            8,
            |row, column| if row == (column + 1) % 8 { 1.0 } else { 0.0 },
        );
        check(&shift);
        for eigenvalue in SchurForm::of(&shift).unwrap().eigenvalues() {
            // Orthogonal: each eigenvalue has condition number 1.
            assert!((eigenvalue.powi(8) - 1.0).norm() < 1e-12);
        }
    }

    #[test]
    fn two_rows_with_real_eigenvalues_are_told_apart_without_cancellation() {
        let [far, near] = eigenvalues_of_block([[1e8, 1.0], [1.0, 0.0]]);
        // lambda^2 - 1e8 lambda - 1 = 0: the smaller root is -1e-8 (1 - 1e-16).
        assert!(
            (far.re - 1e8).abs() < 1e-7 && (near.re + 1e-8).abs() < 1e-22,
            "{far} {near}"
        );
    }
}
