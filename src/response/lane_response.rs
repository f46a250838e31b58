//! The frequency response of a reduced model, a vector of frequencies at a time.

use nalgebra::Complex;
use pulp::{Simd, WithSimd};

use crate::dataset::{Pair, PairTable};

use super::back_substitution::{Sides, substitute_back, subtract_real_products};
use super::complex_lanes::{ComplexLanes, frequencies};
use super::hessenberg_form::HessenbergForm;
use super::lane_elimination::Elimination;

/// `H(j omega) = D - C Y` of a reduced model, to be evaluated with the vectors of an instruction set.
pub struct LaneResponse<'a> {
    /// The model.
    pub form: &'a HessenbergForm,
    /// The frequencies \[rad/s\].
    pub omega: &'a [f64],
    /// Where the values are appended: p x m.
    pub values: &'a mut PairTable<Vec<Complex<f64>>>,
}

impl WithSimd for LaneResponse<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        let form = self.form;
        let mut elimination = Elimination::with_room_for(simd, form);
        let zero = ComplexLanes::real(simd, 0.0);
        let mut four = vec![[zero; 4]; form.order()];
        let mut one = vec![[zero; 1]; form.order()];
        let frequency_scale = simd.splat_f64s(form.frequency_scale());
        for omega in self.omega.chunks(S::F64_LANES) {
            // Lanes past the end of the grid hold zero: they change nothing in the others.
            let lanes = simd.mul_f64s(frequency_scale, frequencies(simd, omega));
            elimination.run(simd, form, lanes);
            let fours = form.sides() / 4 * 4;
            for first in (0..fours).step_by(4) {
                substitute_back(simd, form, &elimination, first, &mut four);
                self.write(simd, first, &four);
            }
            for first in fours..form.sides() {
                substitute_back(simd, form, &elimination, first, &mut one);
                self.write(simd, first, &one);
            }
        }
        // Whole vectors were appended.
        for (_, values) in self.values.iter_mut() {
            values.truncate(self.omega.len());
        }
    }
}

impl LaneResponse<'_> {
    /// Appends `D - C Y` of `R` right-hand sides from `first` on: 2 n p fused operations for each.
    #[inline(always)]
    fn write<S: Simd, const R: usize>(&mut self, simd: S, first: usize, y: &[Sides<S, R>]) {
        let form = self.form;
        let rows = form.outputs();
        for row in (0..rows).step_by(2) {
            // Two rows at a time; an odd number of rows computes its last one twice.
            let pair = [row, (row + 1).min(rows - 1)];
            let mut sums = [[ComplexLanes::real(simd, 0.0); R]; 2];
            for (sum, row) in sums.iter_mut().zip(pair) {
                for (side, sum) in sum.iter_mut().enumerate() {
                    sum.re = simd.splat_f64s(form.d(row, first + side));
                }
            }
            subtract_real_products(simd, &mut sums, [form.c_row(pair[0]), form.c_row(pair[1])], y);
            for (sum, row) in sums.iter().zip(row..rows) {
                self.append::<S, R>(simd, row, first, sum);
            }
        }
    }

    /// Appends the values of one row of C.
    #[inline(always)]
    fn append<S: Simd, const R: usize>(&mut self, simd: S, row: usize, first: usize, values: &Sides<S, R>) {
        for (side, lanes) in values.iter().enumerate() {
            let pair = if self.form.is_dual() { Pair::new(first + side, row) } else { Pair::new(row, first + side) };
            let into = &mut self.values[pair];
            lanes.values(simd, |values| into.extend_from_slice(values));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::StateSpace;
    use nalgebra::{DMatrix, dmatrix};
    use pulp::{Arch, Scalar};

    type Values = PairTable<Vec<Complex<f64>>>;

    fn on<S: Simd>(simd: S, model: &StateSpace, omega: &[f64]) -> Values {
        let mut values = PairTable::filled(model.outputs(), model.inputs(), Vec::new());
        let form = &HessenbergForm::of(Arch::new(), model);
        simd.vectorize(LaneResponse { form, omega, values: &mut values });
        values
    }

    /// The values on every instruction set of this machine with fused multiply-adds, which must have the same bits.
    fn on_vectors(model: &StateSpace, omega: &[f64]) -> Vec<Values> {
        let mut values = Vec::new();
        #[cfg(target_arch = "x86_64")]
        {
            values.extend(pulp::x86::V3::try_new().map(|simd| on(simd, model, omega)));
            values.extend(pulp::x86::V4::try_new().map(|simd| on(simd, model, omega)));
        }
        #[cfg(target_arch = "aarch64")]
        values.extend(pulp::aarch64::Neon::try_new().map(|simd| on(simd, model, omega)));
        values
    }

    /// Entries from a sine: without pattern, and the same everywhere.
    fn matrix(rows: usize, columns: usize, seed: f64) -> DMatrix<f64> {
        DMatrix::from_fn(rows, columns, |row, column| (seed + 7.3 * row as f64 + 2.9 * (column * column) as f64).sin())
    }

    fn model(order: usize, outputs: usize, inputs: usize) -> StateSpace {
        let a = matrix(order, order, 0.3) - DMatrix::identity(order, order) * 2.0;
        let (b, c, d) = (matrix(order, inputs, 1.1), matrix(outputs, order, 2.3), matrix(outputs, inputs, 3.7));
        StateSpace::new(a, b, c, d).unwrap()
    }

    /// From far below the poles, where real rows stay, to far above, where active ones do; lanes differ in between.
    fn wide(count: usize) -> Vec<f64> {
        (0..count).map(|k| 1e-3 * 1e6_f64.powf(k as f64 / count as f64)).collect()
    }

    /// The largest difference, relative to the largest value.
    fn difference(found: &Values, expected: &Values) -> f64 {
        let all = |values: &Values| values.iter().flat_map(|(_, values)| values.clone()).collect::<Vec<_>>();
        let (found, expected) = (all(found), all(expected));
        let largest = expected.iter().map(|value| value.norm()).fold(0.0, f64::max);
        let differences = found.iter().zip(&expected).map(|(found, expected)| (found - expected).norm());
        // NaN must not be lost in a maximum.
        differences.fold(0.0, |worst: f64, next| if next <= worst { worst } else { next }) / largest
    }

    #[test]
    fn vectors_of_every_length_agree_with_scalars_at_every_remainder_length() {
        for count in 0..=17 {
            let (model, omega) = (model(9, 3, 3), wide(count));
            let scalar = on(Scalar::new(), &model, &omega);
            for vectors in on_vectors(&model, &omega) {
                // Two backward stable solutions of order 9: rounding errors of at most 9 tau times 1e-16 each.
                assert!(count == 0 || difference(&vectors, &scalar) < 8e-12, "{count} frequencies");
            }
        }
    }

    #[test]
    fn vectors_of_every_length_give_the_same_bits() {
        for (order, outputs, inputs) in [(1, 1, 1), (2, 6, 4), (12, 6, 4), (30, 6, 4), (17, 3, 5), (8, 7, 6)] {
            let (model, omega) = (model(order, outputs, inputs), wide(61));
            let all = on_vectors(&model, &omega);
            assert!(all.windows(2).all(|pair| pair[0] == pair[1]), "order {order}");
        }
    }

    #[test]
    fn the_value_at_a_frequency_has_the_same_bits_alone() {
        let (model, omega) = (model(14, 6, 4), wide(37));
        let together = on_vectors(&model, &omega);
        for (k, omega) in omega.iter().enumerate() {
            let alone = on_vectors(&model, &[*omega]);
            for (alone, together) in alone.iter().zip(&together) {
                assert!(alone.iter().all(|(pair, values)| values[0] == together[pair][k]), "{omega}");
            }
        }
    }

    #[test]
    fn a_chain_coupled_by_1e_minus_55_neither_overflows_nor_loses_its_coupling() {
        // One over the coupling is 1e55 a step: without shrinking, the fifth step would overflow the square of a pivot.
        let weak = 1e-55;
        let a = DMatrix::from_fn(8, 8, |row, column| match row.abs_diff(column) {
            0 => -1.0,
            1 => weak,
            _ => 0.0,
        });
        let model = StateSpace::new(a, DMatrix::identity(8, 8), DMatrix::identity(8, 8), DMatrix::zeros(8, 8)).unwrap();
        let mut all = on_vectors(&model, &[0.5, 1.0, 2.0]);
        all.push(on(Scalar::new(), &model, &[0.5, 1.0, 2.0]));
        for values in all {
            for (pair, values) in values.iter() {
                let lag = Complex::new(0.5, -0.5);
                let expected = match pair.output.abs_diff(pair.input) {
                    0 => lag,
                    1 => lag * lag * weak,
                    _ => continue,
                };
                // A dozen operations.
                assert!((values[1] - expected).norm() < 1e-14 * expected.norm(), "{pair:?}: {}", values[1]);
            }
        }
    }

    #[test]
    fn a_model_of_two_separate_parts_is_the_sum_of_both() {
        let a = dmatrix![-1.0, 2.0, 0.0, 0.0; -3.0, -0.5, 0.0, 0.0; 0.0, 0.0, -0.2, 4.0; 0.0, 0.0, -5.0, -0.3];
        let (b, c) = (dmatrix![1.0; 0.5; -1.0; 2.0], dmatrix![1.0, -2.0, 0.5, 3.0]);
        let part = |at: usize| {
            let (a, b, c) = (a.view((at, at), (2, 2)), b.rows(at, 2), c.columns(at, 2));
            StateSpace::new(a.into_owned(), b.into_owned(), c.into_owned(), dmatrix![0.0]).unwrap()
        };
        let whole = StateSpace::new(a.clone(), b.clone(), c.clone(), dmatrix![0.0]).unwrap();
        let omega = wide(11);
        let (first, second) = (on(Scalar::new(), &part(0), &omega), on(Scalar::new(), &part(2), &omega));
        let sum = first.map(|pair, values| values.iter().zip(&second[pair]).map(|(a, b)| a + b).collect());
        for values in on_vectors(&whole, &omega) {
            assert!(difference(&values, &sum) < 1e-14);
        }
    }
}
