//! A model whose `A` is block diagonal: the parameters of the refinement (M14, section 4).
//!
//! ```text
//! A = diag(F_1, F_2, ...),   F = [0 1; -a0 -a1],   and one block [a] of one row where n is odd;   B, C, D full
//! (s - F)^-1 = [s + a1, 1; -a0, s] / (s^2 + a1 s + a0)
//! ```
//!
//! A block holds a complex pair *or* two real poles, so that pairs may split and merge.

use nalgebra::{Complex, DMatrix, DVector};

use gdcm_model::dataset::StateSpace;
use gdcm_model::response::eigenvalues::SchurForm;

/// Imaginary part over modulus below which an eigenvalue is real: what the Schur iteration leaves of it.
const REAL: f64 = 1e-9;

/// One block of `A`, and what of it is free.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Block {
    /// Two rows: `s^2 + a1 s + a0`.
    Pair {
        /// Product of the poles \[rad^2/s^2\].
        a0: f64,
        /// Sum of the poles, its sign changed \[rad/s\].
        a1: f64,
    },
    /// One row: the pole \[rad/s\].
    Single(f64),
}

impl Block {
    /// Rows.
    pub(super) fn size(self) -> usize {
        match self {
            Self::Pair { .. } => 2,
            Self::Single(_) => 1,
        }
    }

    /// The poles; of a complex pair the one with a positive imaginary part first.
    pub(super) fn poles(self) -> Vec<Complex<f64>> {
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
                // The greater in modulus without cancellation, the other from the product.
                let far = half + squared.sqrt().copysign(half);
                vec![
                    Complex::from(far),
                    Complex::from(if far == 0.0 { 0.0 } else { a0 / far }),
                ]
            }
        }
    }
}

/// A model with a block diagonal `A`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct BlockModel {
    /// Blocks of two rows, then at most one of one row.
    pub(super) blocks: Vec<Block>,
    /// `B`, n x inputs.
    pub(super) b: DMatrix<f64>,
    /// `C`, outputs x n.
    pub(super) c: DMatrix<f64>,
    /// `D`, outputs x inputs.
    pub(super) d: DMatrix<f64>,
}

impl BlockModel {
    /// Number of states n.
    pub(super) fn order(&self) -> usize {
        self.b.nrows()
    }

    /// Number of parameters: n + n inputs + n outputs + outputs x inputs.
    pub(super) fn parameters(&self) -> usize {
        self.order() * (1 + self.b.ncols() + self.c.nrows()) + self.d.len()
    }

    /// The blocks, each with its first row.
    pub(super) fn rows(&self) -> impl Iterator<Item = (usize, Block)> + '_ {
        self.blocks.iter().scan(0, |next, &block| {
            let first = *next;
            *next += block.size();
            Some((first, block))
        })
    }

    /// The model in blocks: each block of `|B| = |C|`, real poles in pairs by modulus. None of a model without states, and where poles
    /// are too close for their eigenvectors to be told apart.
    pub(super) fn of(model: &StateSpace) -> Option<Self> {
        let order = model.order();
        if order == 0 {
            return None;
        }
        let mut blocks = Vec::new();
        let mut basis = DMatrix::zeros(order, order);
        let mut next = 0;
        for (block, columns) in modal_blocks(model)? {
            columns
                .iter()
                .enumerate()
                .for_each(|(k, column)| basis.set_column(next + k, column));
            next += block.size();
            blocks.push(block);
        }
        let b = basis.clone().lu().solve(model.b())?;
        let c = model.c() * basis;
        let mut found = Self {
            blocks,
            b,
            c,
            d: model.d().clone(),
        };
        found.balance();
        let finite = found
            .b
            .iter()
            .chain(found.c.iter())
            .all(|entry| entry.is_finite());
        finite.then_some(found)
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

    /// The model by its four matrices; none where they are not finite.
    pub(super) fn state_space(&self) -> Option<StateSpace> {
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

    /// The model after a step in its parameters: those of the blocks, then `B`, `C`, `D` row by row.
    pub(super) fn stepped(&self, step: &DVector<f64>) -> Self {
        let mut steps = step.iter().copied();
        let mut add = |value: &mut f64| *value += steps.next().unwrap_or_default();
        let mut to = self.clone();
        for block in &mut to.blocks {
            match block {
                Block::Pair { a0, a1 } => {
                    add(a0);
                    add(a1);
                }
                Block::Single(pole) => add(pole),
            }
        }
        for matrix in [&mut to.b, &mut to.c, &mut to.d] {
            for row in 0..matrix.nrows() {
                matrix.row_mut(row).iter_mut().for_each(&mut add);
            }
        }
        to
    }

    /// Place of `B[state, input]` among the parameters.
    pub(super) fn place_of_b(&self, state: usize, input: usize) -> usize {
        self.order() + state * self.b.ncols() + input
    }

    /// Place of `C[output, state]` among the parameters.
    pub(super) fn place_of_c(&self, output: usize, state: usize) -> usize {
        self.order() * (1 + self.b.ncols()) + output * self.order() + state
    }

    /// Place of `D[output, input]` among the parameters.
    pub(super) fn place_of_d(&self, output: usize, input: usize) -> usize {
        self.order() * (1 + self.b.ncols() + self.c.nrows()) + output * self.d.ncols() + input
    }

    /// `(j omega - A)^-1 x` in place.
    pub(super) fn resolve(&self, omega: f64, x: &mut [Complex<f64>]) {
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

    /// `C (j omega - A)^-1`, outputs x n, into `cr`, column after column.
    pub(super) fn output_resolvent(&self, omega: f64, cr: &mut [Complex<f64>]) {
        let s = Complex::new(0.0, omega);
        let outputs = self.c.nrows();
        let c = self.c.as_slice();
        for (first, block) in self.rows() {
            let at = first * outputs;
            match block {
                Block::Single(pole) => {
                    let inverse = 1.0 / (s - pole);
                    (0..outputs).for_each(|o| cr[at + o] = inverse * c[at + o]);
                }
                Block::Pair { a0, a1 } => {
                    let inverse = 1.0 / (s * s + s * a1 + a0);
                    let from_first = (s + a1) * inverse;
                    let from_second = s * inverse;
                    for o in 0..outputs {
                        let one = c[at + o];
                        let two = c[at + outputs + o];
                        cr[at + o] = from_first * one - inverse * (a0 * two);
                        cr[at + outputs + o] = inverse * one + from_second * two;
                    }
                }
            }
        }
    }

    /// `C (j omega - A)^-1 B + D`, outputs x inputs.
    pub(super) fn response(&self, omega: f64) -> DMatrix<Complex<f64>> {
        let mut cr = DMatrix::zeros(self.c.nrows(), self.order());
        self.output_resolvent(omega, cr.as_mut_slice());
        cr * self.b.map(Complex::from) + self.d.map(Complex::from)
    }
}

/// The blocks of a model, pairs before real poles and each by modulus, with the columns of the basis in which `A` has them: `t2` of the
/// invariant subspace, `t1 = A t2 + a1 t2`. None where poles are too close to be told apart.
fn modal_blocks(model: &StateSpace) -> Option<Vec<(Block, Vec<DVector<f64>>)>> {
    let order = model.order();
    let schur = SchurForm::of(model.a())?;
    // One of each complex pair, that with a positive imaginary part.
    let mut complex: Vec<(Complex<f64>, DVector<Complex<f64>>)> = Vec::new();
    let mut real: Vec<(f64, DVector<f64>)> = Vec::new();
    for at in 0..order {
        let eigenvalue = schur.t[(at, at)];
        let vector = schur.eigenvector(at);
        let largest = vector[vector.icamax()];
        // Turned so that its largest entry is real.
        let vector = vector * (largest.conj() / largest.norm());
        if eigenvalue.im.abs() <= REAL * eigenvalue.norm() {
            real.push((eigenvalue.re, vector.map(|entry| entry.re)));
        } else if eigenvalue.im > 0.0 {
            complex.push((eigenvalue, vector));
        }
    }
    if 2 * complex.len() + real.len() != order {
        return None;
    }
    complex.sort_by(|(a, _), (b, _)| a.norm().total_cmp(&b.norm()));
    real.sort_by(|(a, _), (b, _)| a.abs().total_cmp(&b.abs()));
    // The outputs of neighbouring real modes with one sign: their difference then says how they differ.
    for k in 1..real.len() {
        if (model.c() * &real[k - 1].1).dot(&(model.c() * &real[k].1)) < 0.0 {
            real[k].1.neg_mut();
        }
    }
    let mut blocks = Vec::new();
    for (eigenvalue, vector) in &complex {
        let block = Block::Pair {
            a0: eigenvalue.norm_sqr(),
            a1: -2.0 * eigenvalue.re,
        };
        let second = vector.map(|entry| entry.im);
        let image = vector.map(|entry| (entry * eigenvalue).im);
        blocks.push((
            block,
            vec![image + &second * (-2.0 * eigenvalue.re), second],
        ));
    }
    for pair in real.chunks(2) {
        match pair {
            [(one, first), (two, second)] => {
                let block = Block::Pair {
                    a0: one * two,
                    a1: -(one + two),
                };
                // Of one on both: a real mode each.
                let lower = (second - first) / (two - one);
                let upper = (first * *two - second * *one) / (two - one);
                blocks.push((block, vec![upper, lower]));
            }
            [(pole, vector)] => blocks.push((Block::Single(*pole), vec![vector.clone()])),
            _ => {}
        }
    }
    Some(blocks)
}

#[cfg(test)]
mod tests {
    use nalgebra::dmatrix;

    use gdcm_model::response::eigenvalues::poles;

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
        let blocks = BlockModel::of(&model()).unwrap();
        assert_eq!(blocks.blocks.len(), 3);
        for omega in [0.1, 1.0, 2.1, 10.0] {
            let expected = response_at(&model(), omega);
            // Eigenvectors of condition below 100.
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
        let blocks = BlockModel::of(&model()).unwrap();
        let step = |place: usize| {
            DVector::from_fn(
                blocks.parameters(),
                |k, _| if k == place { 1.0 } else { 0.0 },
            )
        };
        let stepped = |place| blocks.stepped(&step(place));
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
    fn two_equal_poles_give_a_word_and_no_infinity() {
        let twice = StateSpace::new(
            dmatrix![-1.0, 0.0; 0.0, -1.0],
            dmatrix![1.0; 2.0],
            dmatrix![1.0, 1.0],
            dmatrix![0.0],
        );
        assert!(BlockModel::of(&twice.unwrap()).is_none_or(|model| model.state_space().is_some()));
    }
}
