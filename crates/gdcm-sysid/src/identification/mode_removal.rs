//! A model of a lower order out of one of a higher order: the mode that the measured response misses least is taken away (M14.13).
//!
//! ```text
//! H = sum of modes dH + D: real poles, and complex pairs
//! 1  of each mode of the wanted size: the sum of |dH - mean dH|^2 / var G over the points and pairs of the measured response
//! 2  the mode with the least sum goes; the mean of its real part is kept in D
//! ```

use nalgebra::{Complex, DMatrix, dmatrix};

use gdcm_model::dataset::StateSpace;
use gdcm_model::response::eigenvalues::SchurForm;

use super::blocks::{Block, BlockModel};
use super::response_estimate::{EstimatePoint, ResponseEstimate};

impl BlockModel {
    /// The model without the complex pair (`size` 2) or the real pole (`size` 1) that `measured` misses least; none where it has no
    /// such mode, or where the rest cannot be brought to blocks.
    pub(super) fn without_least_mode(
        &self,
        size: usize,
        measured: &ResponseEstimate,
    ) -> Option<Self> {
        let modes = self.modes();
        let losses = modes
            .iter()
            .enumerate()
            .filter(|(_, mode)| mode.order() == size);
        let losses = losses.map(|(at, mode)| (at, mode.loss(measured)));
        let (at, (_, mean)) = losses.min_by(|a, b| a.1.0.total_cmp(&b.1.0))?;
        let kept: Vec<&Self> = modes
            .iter()
            .enumerate()
            .filter(|(other, _)| *other != at)
            .map(|(_, mode)| mode)
            .collect();
        if kept.is_empty() {
            return None;
        }
        let rows: Vec<_> = kept.iter().flat_map(|mode| mode.b.row_iter()).collect();
        let columns: Vec<_> = kept.iter().flat_map(|mode| mode.c.column_iter()).collect();
        let joined = Self {
            blocks: kept
                .iter()
                .flat_map(|mode| mode.blocks.iter().copied())
                .collect(),
            b: DMatrix::from_rows(&rows),
            c: DMatrix::from_columns(&columns),
            d: &self.d + mean,
        };
        // Pairs real poles again.
        Self::of(&joined.state_space()?)
    }

    /// What is lost with this mode, `sum |dH - mean dH|^2 / var G`, and the mean of its real part over frequency, which stays in `D`.
    fn loss(&self, measured: &ResponseEstimate) -> (f64, DMatrix<f64>) {
        let lost: Vec<_> = measured
            .points
            .iter()
            .map(|point| self.response(point.omega))
            .collect();
        let mut mean = self.d.clone();
        lost.iter()
            .for_each(|of| mean += of.map(|value| value.re / lost.len() as f64));
        let at_point = |(lost, point): (&DMatrix<Complex<f64>>, &EstimatePoint)| {
            let left = lost.zip_map(&mean, |lost, mean| (lost - mean).norm_sqr());
            left.zip_map(&point.variance, |left, variance| {
                left / variance.max(f64::MIN_POSITIVE)
            })
            .sum()
        };
        (lost.iter().zip(&measured.points).map(at_point).sum(), mean)
    }

    /// Each mode as a model without `D`: a complex pair, or a real pole.
    fn modes(&self) -> Vec<Self> {
        let nothing = DMatrix::zeros(self.c.nrows(), self.b.ncols());
        let part = |block: Block, b: DMatrix<f64>, c: DMatrix<f64>| Self {
            blocks: vec![block],
            b,
            c,
            d: nothing.clone(),
        };
        let of_block = |(first, block): (usize, Block)| {
            let b = self.b.rows(first, block.size()).into_owned();
            let c = self.c.columns(first, block.size()).into_owned();
            let poles = block.poles();
            match (block, poles.as_slice()) {
                (Block::Pair { .. }, [one, two]) if one.im == 0.0 && one.re != two.re => {
                    // Columns (1, p) are the eigenvectors of [0 1; -a0 -a1].
                    let p = one.re;
                    let q = two.re;
                    let inverse = dmatrix![q, -1.0; -p, 1.0] / (q - p);
                    let b = inverse * b;
                    let c = c * dmatrix![1.0, 1.0; p, q];
                    let single = |row: usize, pole: f64| {
                        part(
                            Block::Single(pole),
                            b.rows(row, 1).into_owned(),
                            c.columns(row, 1).into_owned(),
                        )
                    };
                    vec![single(0, p), single(1, q)]
                }
                _ => vec![part(block, b, c)],
            }
        };
        self.rows().flat_map(of_block).collect()
    }
}

// A model without its modes far above the band, their static part kept.
//
// ```text
// 1  A = Q T Q^H, T upper triangular; neighbours on its diagonal are exchanged until the slow ones stand first
// 2  Q1 an orthonormal real basis of what the first columns of Q span, Q2 of its complement
// 3  [Q1 Q2]' A [Q1 Q2] = [A1 A12; 0 A2];  A1 X - X A2 = -A12 (Sylvester)
// 4  slow: A1, B1 = Q1'B - X Q2'B, C1 = C Q1;   fast: A2, B2 = Q2'B, C2 = C (Q1 X + Q2)
// 5  D + C2 (-A2)^-1 B2
// ```
//
// Golub & Van Loan, "Matrix Computations", 4th ed. 2013, 7.6.

/// The model without the modes with `|lambda| > limit` \[rad/s\], equal to it at omega = 0; none where an iteration does not
/// end, fast and slow modes cannot be told apart, or none is slow.
pub(super) fn without_fast_modes(model: &StateSpace, limit: f64) -> Option<StateSpace> {
    let a = model.a();
    let b = model.b();
    let c = model.c();
    let order = model.order();
    let mut schur = SchurForm::of(a)?;
    let slow = schur.order_by(|eigenvalue| eigenvalue.norm() <= limit);
    if slow == order {
        return Some(model.clone());
    }
    if slow == 0 {
        return None;
    }
    let basis = real_basis(&schur.q, slow);
    let q1 = basis.columns(0, slow);
    let q2 = basis.columns(slow, order - slow);
    let a1 = q1.transpose() * a * q1;
    let a2 = q2.transpose() * a * q2;
    let x = sylvester(&a1, &a2, &(q1.transpose() * a * q2))?;
    let b2 = q2.transpose() * b;
    let c2 = c * (q1 * &x + q2);
    let b1 = q1.transpose() * b - &x * &b2;
    StateSpace::new(a1, b1, c * q1, model.d() - c2 * a2.lu().solve(&b2)?).ok()
}

/// An orthonormal basis whose first `count` columns span the same as the first `count` columns of `q`, which are conjugates of
/// each other or real.
fn real_basis(q: &DMatrix<Complex<f64>>, count: usize) -> DMatrix<f64> {
    let order = q.nrows();
    // The projector on the span is real, with the eigenvalues one and zero.
    let leading = q.columns(0, count);
    let projector = DMatrix::from_fn(order, order, |row, column| {
        leading
            .row(row)
            .iter()
            .zip(leading.row(column).iter())
            .map(|(x, y)| (x * y.conj()).re)
            .sum()
    });
    let eigen = nalgebra::SymmetricEigen::<f64, nalgebra::Dyn>::new(projector);
    let mut by_size: Vec<usize> = (0..order).collect();
    by_size.sort_by(|&i, &j| eigen.eigenvalues[j].total_cmp(&eigen.eigenvalues[i]));
    eigen.eigenvectors.select_columns(&by_size)
}

/// `X` of `A1 X - X A2 = -A12`.
fn sylvester(a1: &DMatrix<f64>, a2: &DMatrix<f64>, a12: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let (rows, columns) = a12.shape();
    let identity = |size| DMatrix::<f64>::identity(size, size);
    let system = identity(columns).kronecker(a1) - a2.transpose().kronecker(&identity(rows));
    let stacked = nalgebra::DVector::from_column_slice((-a12).as_slice());
    Some(DMatrix::from_column_slice(
        rows,
        columns,
        system.lu().solve(&stacked)?.as_slice(),
    ))
}

#[cfg(test)]
mod tests {
    use nalgebra::DVector;

    use gdcm_model::response::frequency_response::log_spaced;

    use super::*;
    use crate::identification::known_answers_tests::*;

    #[test]
    fn the_mode_that_is_missed_least_goes_and_its_mean_stays() {
        let model = StateSpace::new(
            dmatrix![-0.5, 0.0, 0.0, 0.0, 0.0; 0.0, -60.0, 0.0, 0.0, 0.0; 0.0, 0.0, -1.0, 3.0, 0.0; 0.0, 0.0, -3.0, -1.0, 0.0; 0.0, 0.0, 0.0, 0.0, -4.0],
            dmatrix![1.0; 12.0; 2.0; 0.0; 0.8],
            dmatrix![1.0, 1.0, 0.0, 1.0, 1.0],
            dmatrix![0.1],
        );
        let model = BlockModel::of(&model.unwrap()).unwrap();
        let one = DMatrix::from_element(1, 1, 1.0);
        let point = |omega: f64| EstimatePoint {
            omega,
            response: one.map(Complex::from),
            variance: one.clone(),
            noise: one.clone(),
            power: DVector::from_element(1, 1.0),
            coherence: DVector::from_element(1, 1.0),
            partial_coherence: one.clone(),
            condition: 1.0,
            half_width: 0.5,
            freedom: 10,
        };
        let measured = ResponseEstimate {
            points: log_spaced(0.5, 8.0, 20).into_iter().map(point).collect(),
        };
        let less = model.without_least_mode(1, &measured).unwrap();
        assert_eq!(less.order(), 4);
        for omega in [0.5, 2.0, 8.0] {
            // The servo at 60 rad/s turns what it carries, 0.2, by 8/60 at most, and its mean is taken at the points.
            let error = (less.response(omega) - model.response(omega)).camax();
            assert!(error < 0.2 * 10.0 / 60.0, "{omega} rad/s: {error}");
        }
        assert_eq!(model.without_least_mode(2, &measured).unwrap().order(), 3);
        assert!(
            model
                .without_least_mode(2, &measured)
                .unwrap()
                .without_least_mode(2, &measured)
                .is_none()
        );
        let last = less
            .without_least_mode(2, &measured)
            .unwrap()
            .without_least_mode(1, &measured)
            .unwrap();
        assert_eq!(last.order(), 1);
        assert!(
            last.without_least_mode(1, &measured).is_none(),
            "no state would be left"
        );
    }

    fn sample(size: usize) -> DMatrix<f64> {
        DMatrix::from_fn(size, size, |row, column| {
            ((1.0 + 7.3 * row as f64) * (1.0 + 2.9 * column as f64)).sin()
        })
    }

    #[test]
    fn a_model_of_fast_modes_alone_has_no_slow_part() {
        let model = |pole: f64| {
            StateSpace::new(
                sample(2).map(|_| 0.0) + DMatrix::identity(2, 2) * pole,
                sample(2),
                sample(2),
                sample(2),
            )
        };
        assert!(without_fast_modes(&model(-100.0).unwrap(), 50.0).is_none());
        assert_eq!(
            without_fast_modes(&model(-10.0).unwrap(), 50.0)
                .unwrap()
                .order(),
            2
        );
    }

    #[test]
    fn the_form_still_gives_the_matrix_after_its_reordering() {
        let a = sample(9);
        let mut form = SchurForm::of(&a).unwrap();
        let before: Vec<_> = form.t.diagonal().iter().copied().collect();
        let count = form.order_by(|eigenvalue| eigenvalue.re > 0.0);
        assert_eq!(
            count,
            before
                .iter()
                .filter(|eigenvalue| eigenvalue.re > 0.0)
                .count()
        );
        assert!((0..9).all(|at| (form.t[(at, at)].re > 0.0) == (at < count)));
        // A few dozen rotations, each backward stable.
        assert!(
            (&form.q * &form.t * form.q.adjoint() - a.map(Complex::from)).norm() < 1e-13 * a.norm()
        );
    }

    #[test]
    fn what_is_left_is_that_of_independent_code() {
        let known = &answers()["drop_fast"];
        let of = |name: &str| matrix(&known[name]);
        let model = StateSpace::new(of("A"), of("B"), of("C"), of("D")).unwrap();
        let slow = without_fast_modes(&model, number(&known["wmax"])).unwrap();
        assert_eq!(slow.order() as f64, number(&known["order"]));
        for (omega, expected) in numbers(&known["w"]).into_iter().zip(response(&known["H"])) {
            // Independent numpy code; the tolerance stands in its file.
            assert!((response_at(&slow, omega) - expected).camax() < 1e-9);
        }
    }

    #[test]
    fn a_model_without_fast_modes_stays_as_it_is() {
        let known = &answers()["drop_fast"];
        let of = |name: &str| matrix(&known[name]);
        let model = StateSpace::new(of("A"), of("B"), of("C"), of("D")).unwrap();
        assert_eq!(without_fast_modes(&model, 1000.0).unwrap(), model);
    }
}
