//! A model with a block diagonal `A`: the refinement's parameters (M14.4).
//!
//! ```text
//! A = diag(F_1, F_2, ...),   F = [0 1; -a0 -a1],   and a block [a] with a single row if n is odd
//! B, C, D full
//! (s - F)^-1 = [s + a1, 1; -a0, s] / (s^2 + a1 s + a0)
//! ```
//!
//! A block holds a complex pair *or* two real poles, so that pairs may split and merge.

use nalgebra::{Complex, DMatrix, DVector};

use gdcm_model::dataset::StateSpace;
use gdcm_model::response::schur_form::SchurForm;

use super::linear_model::LinearModel;

/// Maximum ratio of imaginary part to modulus of an eigenvalue that counts as real: the error of
/// the Schur iteration.
const REAL: f64 = 1e-9;

/// The free parameters of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Block {
    /// Two rows: `s^2 + a1 s + a0`.
    Pair {
        /// Product of the poles \[rad^2/s^2\].
        a0: f64,
        /// Negative sum of the poles \[rad/s\].
        a1: f64,
    },
    /// One row: the pole \[rad/s\].
    Single(f64),
}

impl Block {
    /// Returns the number of rows.
    pub(crate) fn size(self) -> usize {
        match self {
            Self::Pair { .. } => 2,
            Self::Single(_) => 1,
        }
    }

    /// Returns the poles; in a complex pair the pole with the positive imaginary part comes first.
    pub(crate) fn poles(self) -> Vec<Complex<f64>> {
        match self {
            Self::Single(pole) => vec![Complex::from(pole)],
            Self::Pair { a0, a1 } => {
                let half = -0.5 * a1;
                let squared = half * half - a0;
                if squared < 0.0 {
                    let imaginary = (-squared).sqrt();
                    return vec![
                        Complex::new(half, imaginary),
                        Complex::new(half, -imaginary),
                    ];
                }
                // The pole of larger modulus is computed without cancellation, the other from the
                // product.
                let far = half + squared.sqrt().copysign(half);
                let near = if far == 0.0 { 0.0 } else { a0 / far };
                vec![Complex::from(far), Complex::from(near)]
            }
        }
    }
}

/// A model with a block diagonal `A`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BlockModel {
    /// Blocks with two rows, then at most one with a single row.
    pub(crate) blocks: Vec<Block>,
    /// `B`, n x inputs.
    pub(crate) b: DMatrix<f64>,
    /// `C`, outputs x n.
    pub(crate) c: DMatrix<f64>,
    /// `D`, outputs x inputs.
    pub(crate) d: DMatrix<f64>,
}

impl BlockModel {
    /// Returns the number of parameters: n (1 + inputs + outputs) + outputs x inputs.
    pub(crate) fn parameters(&self) -> usize {
        self.order() * (1 + self.b.ncols() + self.c.nrows()) + self.d.len()
    }

    /// Returns the blocks, each with the index of its first row.
    pub(crate) fn rows(&self) -> impl Iterator<Item = (usize, Block)> + '_ {
        self.blocks.iter().scan(0, |next, &block| {
            let first = *next;
            *next += block.size();
            Some((first, block))
        })
    }

    /// Transforms a model to blocks with `|B| = |C|` each and real poles paired by modulus.
    ///
    /// Returns `None` for a model without states, and for poles so close that their eigenvectors
    /// cannot be separated.
    pub(crate) fn from_state_space(model: &StateSpace) -> Option<Self> {
        let order = model.order();
        if order == 0 {
            return None;
        }
        let mut blocks = Vec::new();
        let mut basis = DMatrix::zeros(order, order);
        let mut next = 0;
        for modal in modal_blocks(model)? {
            for column in &modal.columns {
                basis.set_column(next, column);
                next += 1;
            }
            blocks.push(modal.block);
        }
        let b = basis.clone().lu().solve(model.b())?;
        let c = model.c() * basis;
        let mut transformed = Self {
            blocks,
            b,
            c,
            d: model.d().clone(),
        };
        transformed.balance();
        let mut entries = transformed.b.iter().chain(transformed.c.iter());
        if entries.all(|entry| entry.is_finite()) {
            Some(transformed)
        } else {
            None
        }
    }

    /// Scales the states of each block so that `|B| = |C|`.
    fn balance(&mut self) {
        let rows: Vec<_> = self.rows().collect();
        for (first, block) in rows {
            let mut b = self.b.rows_mut(first, block.size());
            let mut c = self.c.columns_mut(first, block.size());
            let ratio = (c.norm() / b.norm()).sqrt();
            if ratio.is_finite() && ratio > 0.0 {
                b.scale_mut(ratio);
                c.unscale_mut(ratio);
            }
        }
    }

    /// Returns the poles of all blocks.
    pub(crate) fn poles(&self) -> Vec<Complex<f64>> {
        self.blocks.iter().flat_map(|block| block.poles()).collect()
    }

    /// Returns the four matrices of the model; `None` if they are not finite.
    pub(crate) fn state_space(&self) -> Option<StateSpace> {
        let mut a = DMatrix::zeros(self.order(), self.order());
        for (first, block) in self.rows() {
            match block {
                Block::Single(pole) => a[(first, first)] = pole,
                Block::Pair { a0, a1 } => {
                    a[(first, first + 1)] = 1.0;
                    a[(first + 1, first)] = -a0;
                    a[(first + 1, first + 1)] = -a1;
                }
            }
        }
        StateSpace::new(a, self.b.clone(), self.c.clone(), self.d.clone()).ok()
    }

    /// Returns the model after a step in its parameters: the parameters of the blocks, then `B`,
    /// `C`, `D` row by row.
    pub(crate) fn stepped(&self, step: &DVector<f64>) -> Self {
        let mut stepped = self.clone();
        let mut steps = step.iter();
        for block in &mut stepped.blocks {
            match block {
                Block::Pair { a0, a1 } => add_steps([a0, a1], &mut steps),
                Block::Single(pole) => add_steps([pole], &mut steps),
            }
        }
        for matrix in [&mut stepped.b, &mut stepped.c, &mut stepped.d] {
            for row in 0..matrix.nrows() {
                add_steps(matrix.row_mut(row).iter_mut(), &mut steps);
            }
        }
        stepped
    }

    /// Returns the parameter index of `B[state, input]`.
    pub(crate) fn place_of_b(&self, state: usize, input: usize) -> usize {
        self.order() + state * self.b.ncols() + input
    }

    /// Returns the parameter index of `C[output, state]`.
    pub(crate) fn place_of_c(&self, output: usize, state: usize) -> usize {
        self.order() * (1 + self.b.ncols()) + output * self.order() + state
    }

    /// Returns the parameter index of `D[output, input]`.
    pub(crate) fn place_of_d(&self, output: usize, input: usize) -> usize {
        self.order() * (1 + self.b.ncols() + self.c.nrows()) + output * self.d.ncols() + input
    }
}

impl LinearModel for BlockModel {
    fn b(&self) -> &DMatrix<f64> {
        &self.b
    }

    fn c(&self) -> &DMatrix<f64> {
        &self.c
    }

    fn d(&self) -> &DMatrix<f64> {
        &self.d
    }

    fn resolve(&self, omega: f64, x: &mut [Complex<f64>]) {
        let s = Complex::new(0.0, omega);
        for (first, block) in self.rows() {
            match block {
                Block::Single(pole) => x[first] /= s - pole,
                Block::Pair { a0, a1 } => {
                    let upper = x[first];
                    let lower = x[first + 1];
                    let inverse = 1.0 / (s * s + s * a1 + a0);
                    x[first] = (upper * (s + a1) + lower) * inverse;
                    x[first + 1] = (lower * s - upper * a0) * inverse;
                }
            }
        }
    }

    fn output_resolvent(&self, omega: f64, cr: &mut [Complex<f64>]) {
        let s = Complex::new(0.0, omega);
        let outputs = self.c.nrows();
        let c = self.c.as_slice();
        for (first, block) in self.rows() {
            let at = first * outputs;
            match block {
                Block::Single(pole) => {
                    let inverse = 1.0 / (s - pole);
                    for o in 0..outputs {
                        cr[at + o] = inverse * c[at + o];
                    }
                }
                Block::Pair { a0, a1 } => {
                    let inverse = 1.0 / (s * s + s * a1 + a0);
                    let from_first = (s + a1) * inverse;
                    let from_second = s * inverse;
                    for o in 0..outputs {
                        let first = c[at + o];
                        let second = c[at + outputs + o];
                        cr[at + o] = from_first * first - inverse * (a0 * second);
                        cr[at + outputs + o] = inverse * first + from_second * second;
                    }
                }
            }
        }
    }
}

/// Adds the next values in `steps` to `parameters`.
fn add_steps<'p, 's>(
    parameters: impl IntoIterator<Item = &'p mut f64>,
    steps: &mut impl Iterator<Item = &'s f64>,
) {
    for (parameter, step) in parameters.into_iter().zip(steps) {
        *parameter += step;
    }
}

/// A block, and the basis columns that transform `A` to it.
struct ModalBlock {
    block: Block,
    columns: Vec<DVector<f64>>,
}

/// A mode with a real pole.
struct RealMode {
    pole: f64,
    vector: DVector<f64>,
}

/// The mode of a complex pair that has the positive imaginary part.
struct ComplexMode {
    pole: Complex<f64>,
    vector: DVector<Complex<f64>>,
}

/// Modes of a model, by ascending modulus.
struct Modes {
    complex: Vec<ComplexMode>,
    real: Vec<RealMode>,
}

impl Modes {
    /// Computes the modes; `None` if the Schur iteration does not converge or poles are too close
    /// to be separated.
    fn of_model(model: &StateSpace) -> Option<Self> {
        let order = model.order();
        let schur = SchurForm::new(model.a())?;
        let mut modes = Self {
            complex: Vec::new(),
            real: Vec::new(),
        };
        for at in 0..order {
            let pole = schur.t[(at, at)];
            let vector = schur.eigenvector(at);
            let largest = vector[vector.icamax()];
            // Rotate the vector so that its largest entry is real.
            let vector = vector * (largest.conj() / largest.norm());
            if pole.im.abs() <= REAL * pole.norm() {
                modes.real.push(RealMode {
                    pole: pole.re,
                    vector: vector.map(|entry| entry.re),
                });
            } else if pole.im > 0.0 {
                modes.complex.push(ComplexMode { pole, vector });
            }
        }
        if 2 * modes.complex.len() + modes.real.len() != order {
            return None;
        }
        modes
            .complex
            .sort_by(|a, b| a.pole.norm().total_cmp(&b.pole.norm()));
        modes
            .real
            .sort_by(|a, b| a.pole.abs().total_cmp(&b.pole.abs()));
        Some(modes)
    }

    /// Gives neighbouring real modes outputs with the same sign, so that the difference of their
    /// vectors shows how the modes differ.
    fn align_real_modes(&mut self, c: &DMatrix<f64>) {
        for k in 1..self.real.len() {
            let before = c * &self.real[k - 1].vector;
            let own = c * &self.real[k].vector;
            if before.dot(&own) < 0.0 {
                self.real[k].vector.neg_mut();
            }
        }
    }
}

/// Returns the blocks of a model: pairs, then real poles, each by ascending modulus.
///
/// The columns of a block are `t2` in the invariant subspace and `t1 = A t2 + a1 t2`.
fn modal_blocks(model: &StateSpace) -> Option<Vec<ModalBlock>> {
    let mut modes = Modes::of_model(model)?;
    modes.align_real_modes(model.c());
    let mut blocks = Vec::new();
    for ComplexMode { pole, vector } in &modes.complex {
        let second = vector.map(|entry| entry.im);
        let image = vector.map(|entry| (entry * pole).im);
        blocks.push(ModalBlock {
            block: Block::Pair {
                a0: pole.norm_sqr(),
                a1: -2.0 * pole.re,
            },
            columns: vec![image + &second * (-2.0 * pole.re), second],
        });
    }
    for pair in modes.real.chunks(2) {
        match pair {
            [p, q] => {
                // Columns [upper, lower] map each real mode to a multiple of (1, its pole).
                let lower = (&q.vector - &p.vector) / (q.pole - p.pole);
                let upper = (&p.vector * q.pole - &q.vector * p.pole) / (q.pole - p.pole);
                blocks.push(ModalBlock {
                    block: Block::Pair {
                        a0: p.pole * q.pole,
                        a1: -(p.pole + q.pole),
                    },
                    columns: vec![upper, lower],
                });
            }
            [single] => blocks.push(ModalBlock {
                block: Block::Single(single.pole),
                columns: vec![single.vector.clone()],
            }),
            _ => {}
        }
    }
    Some(blocks)
}

#[cfg(test)]
mod tests {
    use nalgebra::dmatrix;

    use gdcm_model::response::mode::poles;

    use super::*;
    use crate::identification::known_answers_tests::response_at;

    fn model() -> StateSpace {
        StateSpace::new(
            dmatrix![-0.4, 2.1, 0.0, 0.0, 0.1; -2.1, -0.4, 0.0, 0.3, 0.0; 0.0, 0.0, -1.5, 0.0, 0.0; 0.2, 0.0, -1.1, 0.15, 0.0; 1.0, 0.0, 0.0, 1.0, -7.0],
            dmatrix![1.0, 0.2; 0.0, 0.6; 0.5, -1.0; -0.3, 0.8; 3.0, -2.0],
            dmatrix![1.0, 0.0, 0.3, 0.0, 0.4; 0.0, 0.5, 0.0, 1.0, 1.0],
            dmatrix![0.0, 0.05; 0.1, 0.0],
        )
        .unwrap()
    }

    #[test]
    fn a_model_in_blocks_has_the_same_response_and_poles() {
        let blocks = BlockModel::from_state_space(&model()).unwrap();
        assert_eq!(blocks.blocks.len(), 3);
        for omega in [0.1, 1.0, 2.1, 10.0] {
            let expected = response_at(&model(), omega);
            // The condition number of the eigenvectors is below 100.
            assert!((blocks.response(omega) - &expected).camax() < 1e-12);
            assert!(
                (response_at(&blocks.state_space().unwrap(), omega) - expected).camax() < 1e-12
            );
        }
        for pole in poles(&model()).unwrap() {
            let mut poles = blocks.blocks.iter().flat_map(|block| block.poles());
            assert!(poles.any(|found| (found - pole).norm() < 1e-12), "{pole}");
        }
    }

    #[test]
    fn every_parameter_has_its_place() {
        let blocks = BlockModel::from_state_space(&model()).unwrap();
        let stepped = |place: usize| {
            let mut step = DVector::zeros(blocks.parameters());
            step[place] = 1.0;
            blocks.stepped(&step)
        };
        assert_eq!(
            stepped(blocks.place_of_b(3, 1)).b[(3, 1)],
            blocks.b[(3, 1)] + 1.0
        );
        assert_eq!(
            stepped(blocks.place_of_c(1, 2)).c[(1, 2)],
            blocks.c[(1, 2)] + 1.0
        );
        assert_eq!(
            stepped(blocks.place_of_d(1, 0)).d[(1, 0)],
            blocks.d[(1, 0)] + 1.0
        );
        assert_ne!(stepped(4).blocks[2], blocks.blocks[2]);
    }

    #[test]
    fn two_equal_poles_give_no_infinity() {
        let twice = StateSpace::new(
            dmatrix![-1.0, 0.0; 0.0, -1.0],
            dmatrix![1.0; 2.0],
            dmatrix![1.0, 1.0],
            dmatrix![0.0],
        );
        assert!(
            BlockModel::from_state_space(&twice.unwrap())
                .is_none_or(|model| model.state_space().is_some())
        );
    }
}
