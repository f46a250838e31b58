//! The normal equations of one pass, assembled from small blocks, and their solution (M16.2).
//!
//! In input column i of the equations every unknown has the column `F[:,j]` times a number: `v^k`
//! for `M_ji`, `R'_oi` for `K_jo`. With `t = (1, R'_oi ...)` and `P = F^H q^2 F`, m x m, the blocks
//! are
//!
//! ```text
//! G[(a, j), (b, l)] = Re conj(t_a) t_b P_jl = Re(conj(t_a) t_b) Re P_jl - Im(conj(t_a) t_b) Im P_jl
//! b[(a, j)] = Re conj(t_a) z_j,    z = F^H q^2 (S R')[:,i],
//! ```
//!
//! summed over the frequencies of a condition. Over many frequencies the sums of `Re conj(t_a) t_b
//! Re P_jl` and of `Im conj(t_a) t_b Im P_jl` are two matrix products, and `P_lj = conj P_jl`
//! halves the work. No row of the design matrix is kept.
//!
//! An `M_ji` has a column only in the equations of input i, a `K_jo` in those of every input. The
//! normal matrix is therefore an arrow: a block for each input and a border for K, whose part is
//! summed over inputs before anything is substituted:
//!
//! ```text
//! [ A_1            B_1 ]   [ M_1 ]   [ b_1 ]        1  A_i = L_i L_i^T,  W_i = L_i^-1 B_i,  y_i = L_i^-1 b_i  of every input i
//! [      ...       ... ] . [ ... ] = [ ... ]        2  (C - sum W_i^T W_i) K = b_K - sum W_i^T y_i,  by Cholesky's factors
//! [            A_m B_m ]   [ M_m ]   [ b_m ]        3  M_i = L_i^-T (y_i - W_i K)
//! [ B_1^T ... B_m^T C  ]   [ K   ]   [ b_K ]
//! ```
//!
//! Block Cholesky factorisation: Golub & Van Loan, "Matrix Computations", 4th ed. 2013, 4.2.9. The
//! airspeed `v` is the same at all frequencies of a condition and enters afterwards.

use nalgebra::{Cholesky, Complex, DMatrix, DMatrixView, DVector, Dyn};

use gdcm_model::progress::{Cancelled, Progress};

use super::coupling_matrices::{ClosedLoop, CouplingMatrices};
use super::problem::{CouplingError, Unknown};
use super::weighted_condition::WeightedCondition;

/// Frequencies whose products are summed at once, so that their factors stay in the processor
/// cache.
const CHUNK: usize = 64;

/// Returns the number of pairs `a <= b` of `count` items.
fn pair_count(count: usize) -> usize {
    count * (count + 1) / 2
}

/// Returns the index of the pair `a <= b` of `count` items, row by row.
fn pair_place(a: usize, b: usize, count: usize) -> usize {
    a * count - a * a.saturating_sub(1) / 2 + b - a
}

/// Positions of the unknowns in the equations: the entries of `M` by input column, then the entries
/// of `K`.
pub(super) struct UnknownLayout {
    /// The unknowns `M_ji` of each input i.
    mixing: Vec<Vec<MixingPlace>>,
    feedback: Vec<FeedbackPlace>,
}

/// An unknown of `M_ji`.
struct MixingPlace {
    /// Index among the unknowns.
    place: usize,
    /// The input j.
    to: usize,
    /// Power of the scaled airspeed.
    power: i32,
}

/// An unknown `K_jo`.
struct FeedbackPlace {
    /// Index among the unknowns.
    place: usize,
    /// The input j.
    input: usize,
    /// Index of the output o among those fed back.
    number: usize,
}

impl UnknownLayout {
    /// Creates the layout of these unknowns for `inputs` inputs; `fed_back` are the outputs with a
    /// column in `K`.
    pub(super) fn new(unknowns: &[Unknown], inputs: usize, fed_back: &[usize]) -> Self {
        let mut layout = Self {
            mixing: (0..inputs).map(|_| Vec::new()).collect(),
            feedback: Vec::new(),
        };
        for (place, unknown) in unknowns.iter().enumerate() {
            match *unknown {
                Unknown::Mixing { to, from, power } => {
                    layout.mixing[from].push(MixingPlace {
                        place,
                        to,
                        power: power as i32,
                    });
                }
                Unknown::Feedback { input, output } => {
                    if let Some(number) = fed_back.iter().position(|&of| of == output) {
                        layout.feedback.push(FeedbackPlace {
                            place,
                            input,
                            number,
                        });
                    }
                }
            }
        }
        layout
    }
}

/// The couplings of the last pass at one condition.
struct LastPass<'a> {
    /// `M(V)`, m x m.
    mixing: DMatrix<f64>,
    /// `K`, m x p.
    feedback: &'a DMatrix<f64>,
    /// The outputs with a column in `K`.
    fed_back: &'a [usize],
}

/// Sums over frequencies of `Re conj(t_a) t_b P_jl`: a row for each pair of numbers `t`, a column
/// for each pair `j <= l` of inputs.
#[derive(Clone)]
struct Products {
    inputs: usize,
    /// Sums of the products of the real parts.
    real: DMatrix<f64>,
    /// Sums of the products of the imaginary parts.
    imaginary: DMatrix<f64>,
}

impl Products {
    fn zeros(rows: usize, inputs: usize) -> Self {
        let zeros = DMatrix::zeros(rows, pair_count(inputs));
        Self {
            inputs,
            real: zeros.clone(),
            imaginary: zeros,
        }
    }

    /// Returns the sum of one pair of numbers for inputs j, l in any order.
    fn entry(&self, row: usize, j: usize, l: usize) -> f64 {
        if j <= l {
            let column = pair_place(j, l, self.inputs);
            self.real[(row, column)] - self.imaginary[(row, column)]
        } else {
            let column = pair_place(l, j, self.inputs);
            self.real[(row, column)] + self.imaginary[(row, column)]
        }
    }

    /// Adds the products of the frequencies in a chunk; its pairs of numbers are the rows from
    /// `first` on.
    fn add(&mut self, chunk: &Chunk, first: usize) {
        let (rows, columns) = self.real.shape();
        if rows == 0 || chunk.filled == 0 {
            return;
        }
        for (sums, numbers, weighted) in [
            (&mut self.real, &chunk.t_re, &chunk.p_re),
            (&mut self.imaginary, &chunk.t_im, &chunk.p_im),
        ] {
            let numbers = numbers.view((first, 0), (rows, chunk.filled));
            // The transpose, read without copying.
            let weighted = DMatrixView::from_slice_with_strides(
                weighted.as_slice(),
                chunk.filled,
                columns,
                columns,
                1,
            );
            sums.gemm(1.0, &numbers, &weighted, 1.0);
        }
    }
}

/// Contribution of one condition to the normal equations.
pub(super) struct ConditionBlocks {
    /// The blocks with unknowns of M, one for each input column.
    columns: Vec<ColumnBlocks>,
    /// The pairs of two unknowns of K, summed over the input columns.
    feedback: Products,
    /// Right side of the unknowns of K, row by row: number, input.
    right: DMatrix<f64>,
}

/// The unknowns of M in one input column, among themselves and with those of K.
#[derive(Clone)]
struct ColumnBlocks {
    /// A row for each number `t_b` beside `t_0 = 1`.
    products: Products,
    right: DVector<f64>,
}

/// Factors of the products at several frequencies, one column each.
struct Chunk {
    filled: usize,
    /// Real parts of `conj(t_a) t_b`, a row for each pair `a <= b`.
    t_re: DMatrix<f64>,
    t_im: DMatrix<f64>,
    /// Real parts of `P_jl`, a row for each pair `j <= l`.
    p_re: DMatrix<f64>,
    p_im: DMatrix<f64>,
}

/// Work memory for one frequency.
struct Scratch {
    coupled: Vec<Complex<f64>>,
    target: Vec<Complex<f64>>,
    squared: Vec<f64>,
    z: Vec<Complex<f64>>,
    t: Vec<Complex<f64>>,
}

/// `F` at one frequency.
struct Closed {
    k: usize,
    /// Column by column.
    f: Vec<Complex<f64>>,
    /// Real parts, row by row.
    re: Vec<f64>,
    im: Vec<f64>,
}

impl ConditionBlocks {
    /// Computes the blocks of a condition for the couplings of the last pass; `fed_back` are the
    /// outputs with a column in `K`.
    ///
    /// # Errors
    /// [`CouplingError::SingularLoop`] if `I - K H` has no inverse at a frequency that counts,
    /// [`CouplingError::Cancelled`] if `progress` is cancelled.
    pub(super) fn new(
        condition: &WeightedCondition<'_>,
        last: &CouplingMatrices,
        fed_back: &[usize],
        progress: &dyn Progress,
    ) -> Result<Self, CouplingError> {
        let last = LastPass {
            mixing: last.mixing(condition.airspeed_kt),
            feedback: last.feedback(),
            fed_back,
        };
        let (inputs, outputs) = last.feedback.shape();
        let numbers = fed_back.len() + 1;
        let column = ColumnBlocks {
            products: Products::zeros(numbers, inputs),
            right: DVector::zeros(inputs),
        };
        let mut blocks = Self {
            columns: vec![column; inputs],
            feedback: Products::zeros(pair_count(fed_back.len()), inputs),
            right: DMatrix::zeros(fed_back.len(), inputs),
        };
        let mut scratch = Scratch::new(inputs, outputs, numbers);
        let mut chunk = Chunk::new(inputs, numbers);
        let mut closed_loop = ClosedLoop::new(last.feedback);
        let counting: Vec<usize> = (0..condition.omega.len())
            .filter(|&k| condition.counts_at(k))
            .collect();
        for frequencies in counting.chunks(CHUNK) {
            if progress.cancelled() {
                return Err(CouplingError::Cancelled(Cancelled));
            }
            let mut closed = Vec::with_capacity(frequencies.len());
            for &k in frequencies {
                closed.push(Closed::new(condition, k, &mut closed_loop)?);
            }
            for input in 0..inputs {
                chunk.filled = 0;
                for at in &closed {
                    scratch.mix(&at.f, &last, input);
                    if condition.squared_weights(
                        (at.k, input),
                        &scratch.coupled,
                        &mut scratch.squared,
                    ) {
                        scratch.weigh(at, condition.flight(at.k, input), &last, &mut chunk);
                        blocks.add_right(&scratch, input);
                    }
                }
                blocks.columns[input].products.add(&chunk, 0);
                blocks.feedback.add(&chunk, numbers);
            }
        }
        Ok(blocks)
    }

    /// Adds the right sides of an input column at one frequency.
    fn add_right(&mut self, scratch: &Scratch, input: usize) {
        for (j, z) in scratch.z.iter().enumerate() {
            self.columns[input].right[j] += z.re;
            for (number, t) in scratch.t[1..].iter().enumerate() {
                self.right[(number, j)] += t.re * z.re + t.im * z.im;
            }
        }
    }

    /// Returns the memory for the blocks of a condition \[bytes\].
    pub(super) fn bytes(inputs: usize, fed_back: usize) -> usize {
        let rows = inputs * (fed_back + 1) + pair_count(fed_back);
        2 * std::mem::size_of::<f64>() * rows * pair_count(inputs)
    }
}

impl Closed {
    fn new(
        condition: &WeightedCondition<'_>,
        k: usize,
        closed_loop: &mut ClosedLoop<'_>,
    ) -> Result<Self, CouplingError> {
        let mut f = condition.physics(k).to_vec();
        if !closed_loop.close(&mut f) {
            return Err(CouplingError::SingularLoop {
                condition: condition.id,
                omega_rad_s: condition.omega[k],
            });
        }
        let inputs = condition.inputs();
        let outputs = condition.outputs();
        let mut re = Vec::with_capacity(f.len());
        let mut im = Vec::with_capacity(f.len());
        for output in 0..outputs {
            for input in 0..inputs {
                let value = f[input * outputs + output];
                re.push(value.re);
                im.push(value.im);
            }
        }
        Ok(Self { k, f, re, im })
    }
}

impl Chunk {
    fn new(inputs: usize, numbers: usize) -> Self {
        let of_numbers = DMatrix::zeros(pair_count(numbers), CHUNK);
        let of_inputs = DMatrix::zeros(pair_count(inputs), CHUNK);
        Self {
            filled: 0,
            t_re: of_numbers.clone(),
            t_im: of_numbers,
            p_re: of_inputs.clone(),
            p_im: of_inputs,
        }
    }

    /// Appends the next column of each factor, from the numbers `t` and from `F` with its weights.
    fn push(&mut self, t: &[Complex<f64>], at: &Closed, squared: &[f64]) {
        let pairs = self.t_re.nrows();
        let inputs = at.re.len() / squared.len();
        let t_re = &mut self.t_re.as_mut_slice()[self.filled * pairs..][..pairs];
        let t_im = &mut self.t_im.as_mut_slice()[self.filled * pairs..][..pairs];
        let mut place = 0;
        for (a, left) in t.iter().enumerate() {
            for right in &t[a..] {
                let product = left.conj() * right;
                t_re[place] = product.re;
                t_im[place] = product.im;
                place += 1;
            }
        }
        let pairs = self.p_re.nrows();
        let p_re = &mut self.p_re.as_mut_slice()[self.filled * pairs..][..pairs];
        let p_im = &mut self.p_im.as_mut_slice()[self.filled * pairs..][..pairs];
        p_re.fill(0.0);
        p_im.fill(0.0);
        for (output, &squared) in squared.iter().enumerate() {
            if squared > 0.0 {
                let row = output * inputs..(output + 1) * inputs;
                add_outer_product(&at.re[row.clone()], &at.im[row], squared, p_re, p_im);
            }
        }
        self.filled += 1;
    }
}

/// Adds `q^2 conj(f_j) f_l` of one row `f` of `F`, for each pair `j <= l`.
fn add_outer_product(re: &[f64], im: &[f64], squared: f64, p_re: &mut [f64], p_im: &mut [f64]) {
    let mut start = 0;
    for j in 0..re.len() {
        let left_re = squared * re[j];
        let left_im = squared * im[j];
        let re = &re[j..];
        let im = &im[j..];
        let end = start + re.len();
        for (sum, (re, im)) in p_re[start..end].iter_mut().zip(re.iter().zip(im)) {
            *sum += left_re * re + left_im * im;
        }
        for (sum, (re, im)) in p_im[start..end].iter_mut().zip(re.iter().zip(im)) {
            *sum += left_re * im - left_im * re;
        }
        start = end;
    }
}

impl Scratch {
    fn new(inputs: usize, outputs: usize, numbers: usize) -> Self {
        let zeros = |count: usize| vec![Complex::new(0.0, 0.0); count];
        Self {
            coupled: zeros(outputs),
            target: zeros(outputs),
            squared: vec![0.0; outputs],
            z: zeros(inputs),
            t: zeros(numbers),
        }
    }

    /// Computes the input column of `H_c = F M`.
    fn mix(&mut self, f: &[Complex<f64>], last: &LastPass<'_>, input: usize) {
        self.coupled.fill(Complex::new(0.0, 0.0));
        for (of_input, factor) in f
            .chunks_exact(self.coupled.len())
            .zip(last.mixing.column(input).iter())
        {
            for (sum, value) in self.coupled.iter_mut().zip(of_input) {
                *sum += value * *factor;
            }
        }
    }

    /// Computes `t` and `z` of an input column of `R'`, and the factors of its products.
    /// Since `S = I + F K`, the product `S R'` is `R' + F K R'`.
    fn weigh(
        &mut self,
        at: &Closed,
        flight: &[Complex<f64>],
        last: &LastPass<'_>,
        chunk: &mut Chunk,
    ) {
        self.t[0] = Complex::new(1.0, 0.0);
        for (number, &output) in self.t[1..].iter_mut().zip(last.fed_back) {
            *number = flight[output];
        }
        self.target.copy_from_slice(flight);
        let outputs = flight.len();
        for (row, of_input) in at.f.chunks_exact(outputs).enumerate() {
            let fed: Complex<f64> = last
                .fed_back
                .iter()
                .map(|&output| flight[output] * last.feedback[(row, output)])
                .sum();
            for (sum, value) in self.target.iter_mut().zip(of_input) {
                *sum += value * fed;
            }
        }
        for (z, of_input) in self.z.iter_mut().zip(at.f.chunks_exact(outputs)) {
            let terms = of_input.iter().zip(&self.target).zip(&self.squared);
            *z = terms
                .map(|((value, target), squared)| value.conj() * target * *squared)
                .sum();
        }
        chunk.push(&self.t, at, &self.squared);
    }
}

/// `(G + rho diag G) theta = b + rho diag G theta_0` of one pass.
pub(super) struct NormalEquations<'a> {
    layout: &'a UnknownLayout,
    columns: Vec<ColumnEquations>,
    /// The pairs of two unknowns of K.
    feedback: Products,
    /// Right side of the unknowns of K, row by row: number, input.
    right: DMatrix<f64>,
}

/// The rows of the unknowns of M of one input.
struct ColumnEquations {
    /// The columns of these unknowns.
    block: DMatrix<f64>,
    /// The columns of the unknowns of K.
    border: DMatrix<f64>,
    right: DVector<f64>,
}

/// The optimum of one pass.
pub(super) struct PassOptimum {
    /// `theta`, one value per unknown.
    pub(super) coefficients: DVector<f64>,
    /// Largest residual of the normal equations over the largest right side, each divided by the
    /// root of its diagonal entry.
    pub(super) residual: f64,
    /// Indices of the unknowns that no response determines; they keep their uncoupled values.
    pub(super) undetermined: Vec<usize>,
}

impl<'a> NormalEquations<'a> {
    /// Creates empty equations.
    pub(super) fn zeros(layout: &'a UnknownLayout, inputs: usize, fed_back: usize) -> Self {
        let column = |mixing: &Vec<MixingPlace>| ColumnEquations {
            block: DMatrix::zeros(mixing.len(), mixing.len()),
            border: DMatrix::zeros(mixing.len(), layout.feedback.len()),
            right: DVector::zeros(mixing.len()),
        };
        Self {
            layout,
            columns: layout.mixing.iter().map(column).collect(),
            feedback: Products::zeros(pair_count(fed_back), inputs),
            right: DMatrix::zeros(fed_back, inputs),
        }
    }

    /// Adds a condition with scaled airspeed `v`.
    pub(super) fn add(&mut self, blocks: &ConditionBlocks, v: f64) {
        for ((equations, column), mixing) in self
            .columns
            .iter_mut()
            .zip(&blocks.columns)
            .zip(&self.layout.mixing)
        {
            for (row, unknown) in mixing.iter().enumerate() {
                let factor = v.powi(unknown.power);
                equations.right[row] += factor * column.right[unknown.to];
                for (other, by) in mixing.iter().enumerate() {
                    equations.block[(row, other)] +=
                        factor * v.powi(by.power) * column.products.entry(0, unknown.to, by.to);
                }
                for (other, by) in self.layout.feedback.iter().enumerate() {
                    equations.border[(row, other)] +=
                        factor * column.products.entry(by.number + 1, unknown.to, by.input);
                }
            }
        }
        self.feedback.real += &blocks.feedback.real;
        self.feedback.imaginary += &blocks.feedback.imaginary;
        self.right += &blocks.right;
    }

    /// Returns the entry of the normal matrix for two unknowns of K.
    fn feedback_entry(&self, row: &FeedbackPlace, column: &FeedbackPlace) -> f64 {
        let fed_back = self.right.nrows();
        if row.number <= column.number {
            self.feedback.entry(
                pair_place(row.number, column.number, fed_back),
                row.input,
                column.input,
            )
        } else {
            self.feedback.entry(
                pair_place(column.number, row.number, fed_back),
                column.input,
                row.input,
            )
        }
    }

    /// Returns the optimum, regularised towards no couplings by `ridge`.
    ///
    /// Rows and columns are first divided by the root of the diagonal, because the entries of `K`
    /// differ in unit.
    ///
    /// # Errors
    /// [`CouplingError::SingularNormalMatrix`] without Cholesky factors.
    pub(super) fn solve(
        &self,
        unknowns: &[Unknown],
        ridge: f64,
    ) -> Result<PassOptimum, CouplingError> {
        let singular = || CouplingError::SingularNormalMatrix {
            unknowns: unknowns.len(),
        };
        let mut scaling = Scaling::new(unknowns, ridge);
        for (equations, mixing) in self.columns.iter().zip(&self.layout.mixing) {
            for (row, unknown) in mixing.iter().enumerate() {
                scaling.set(unknown.place, equations.block[(row, row)]);
            }
        }
        for unknown in &self.layout.feedback {
            scaling.set(unknown.place, self.feedback_entry(unknown, unknown));
        }
        let scaled = self.scaled(&scaling);
        let solution = scaled.solve().ok_or_else(singular)?;
        let residual = scaled.residual(&solution);
        let mut coefficients = DVector::zeros(unknowns.len());
        for (values, mixing) in solution.mixing.iter().zip(&self.layout.mixing) {
            for (value, unknown) in values.iter().zip(mixing) {
                coefficients[unknown.place] = value * scaling.scale[unknown.place];
            }
        }
        for (value, unknown) in solution.feedback.iter().zip(&self.layout.feedback) {
            coefficients[unknown.place] = value * scaling.scale[unknown.place];
        }
        if !residual.is_finite() || !coefficients.iter().all(|of| of.is_finite()) {
            return Err(singular());
        }
        Ok(PassOptimum {
            coefficients,
            residual,
            undetermined: scaling.undetermined(),
        })
    }

    /// Returns the equations scaled to a unit diagonal and regularised towards no couplings.
    fn scaled(&self, scaling: &Scaling<'_>) -> ScaledEquations {
        let place_of_feedback = |column: usize| self.layout.feedback[column].place;
        let columns = self
            .columns
            .iter()
            .zip(&self.layout.mixing)
            .map(|(equations, mixing)| {
                let scale = |row: usize| scaling.scale[mixing[row].place];
                let mut block = DMatrix::from_fn(mixing.len(), mixing.len(), |row, column| {
                    scale(row) * equations.block[(row, column)] * scale(column)
                });
                for (row, unknown) in mixing.iter().enumerate() {
                    block[(row, row)] += scaling.draw(unknown.place);
                }
                let border =
                    DMatrix::from_fn(mixing.len(), self.layout.feedback.len(), |row, column| {
                        scale(row)
                            * equations.border[(row, column)]
                            * scaling.scale[place_of_feedback(column)]
                    });
                let right = DVector::from_fn(mixing.len(), |row, _| {
                    scaling.right(mixing[row].place, equations.right[row])
                });
                ColumnEquations {
                    block,
                    border,
                    right,
                }
            });
        let feedback = &self.layout.feedback;
        let mut corner = DMatrix::from_fn(feedback.len(), feedback.len(), |row, column| {
            let entry = self.feedback_entry(&feedback[row], &feedback[column]);
            scaling.scale[place_of_feedback(row)] * entry * scaling.scale[place_of_feedback(column)]
        });
        for (row, unknown) in feedback.iter().enumerate() {
            corner[(row, row)] += scaling.draw(unknown.place);
        }
        let right = DVector::from_fn(feedback.len(), |row, _| {
            scaling.right(
                feedback[row].place,
                self.right[(feedback[row].number, feedback[row].input)],
            )
        });
        ScaledEquations {
            columns: columns.collect(),
            corner,
            right,
        }
    }
}

/// Factors that scale the diagonal of the normal matrix to one, and the regularisation towards no
/// couplings.
struct Scaling<'a> {
    unknowns: &'a [Unknown],
    ridge: f64,
    scale: Vec<f64>,
    is_determined: Vec<bool>,
}

impl<'a> Scaling<'a> {
    fn new(unknowns: &'a [Unknown], ridge: f64) -> Self {
        let count = unknowns.len();
        Self {
            unknowns,
            ridge,
            scale: vec![1.0; count],
            is_determined: vec![false; count],
        }
    }

    fn set(&mut self, place: usize, diagonal: f64) {
        if diagonal > 0.0 {
            self.scale[place] = diagonal.sqrt().recip();
            self.is_determined[place] = true;
        }
    }

    /// Returns the regularisation term on the diagonal.
    fn draw(&self, place: usize) -> f64 {
        if self.is_determined[place] {
            self.ridge
        } else {
            1.0
        }
    }

    /// Returns the right side `b`, scaled and regularised.
    fn right(&self, place: usize, right: f64) -> f64 {
        let scale = self.scale[place];
        scale * right + self.draw(place) * self.unknowns[place].uncoupled() / scale
    }

    fn undetermined(&self) -> Vec<usize> {
        (0..self.unknowns.len())
            .filter(|&place| !self.is_determined[place])
            .collect()
    }
}

/// The normal equations with ones on the diagonal.
struct ScaledEquations {
    columns: Vec<ColumnEquations>,
    /// `C`.
    corner: DMatrix<f64>,
    /// `b_K`.
    right: DVector<f64>,
}

/// The scaled unknowns.
struct ScaledSolution {
    /// The unknowns of M, input by input.
    mixing: Vec<DVector<f64>>,
    feedback: DVector<f64>,
}

/// Elimination results of one input, before the unknowns of K are known.
struct EliminatedColumn {
    /// `L_i`.
    factors: Cholesky<f64, Dyn>,
    /// `W_i`.
    border: DMatrix<f64>,
    /// `y_i`.
    right: DVector<f64>,
}

impl ScaledEquations {
    /// Performs steps 1 to 3 of the box above; `None` without Cholesky factors.
    fn solve(&self) -> Option<ScaledSolution> {
        let mut corner = self.corner.clone();
        let mut right = self.right.clone();
        let mut eliminated = Vec::with_capacity(self.columns.len());
        for equations in &self.columns {
            let column = EliminatedColumn::new(equations)?;
            if !corner.is_empty() {
                corner.gemm(-1.0, &column.border.transpose(), &column.border, 1.0);
                right.gemv_tr(-1.0, &column.border, &column.right, 1.0);
            }
            eliminated.push(column);
        }
        let feedback = if corner.is_empty() {
            right
        } else {
            corner.cholesky()?.solve(&right)
        };
        let mixing = eliminated
            .iter()
            .map(|column| column.substitute(&feedback))
            .collect::<Option<_>>()?;
        Some(ScaledSolution { mixing, feedback })
    }

    /// Returns the largest residual over the largest right side.
    fn residual(&self, solution: &ScaledSolution) -> f64 {
        let mut largest = 0.0_f64;
        let mut most_right = self.right.amax();
        let mut of_feedback = &self.corner * &solution.feedback - &self.right;
        for (equations, mixing) in self.columns.iter().zip(&solution.mixing) {
            let left = &equations.block * mixing + &equations.border * &solution.feedback
                - &equations.right;
            of_feedback += equations.border.tr_mul(mixing);
            largest = largest.max(left.amax());
            most_right = most_right.max(equations.right.amax());
        }
        largest.max(of_feedback.amax()) / most_right
    }
}

impl EliminatedColumn {
    fn new(equations: &ColumnEquations) -> Option<Self> {
        let factors = equations.block.clone().cholesky()?;
        let lower = factors.l_dirty();
        let border = lower.solve_lower_triangular(&equations.border)?;
        let right = lower.solve_lower_triangular(&equations.right)?;
        Some(Self {
            factors,
            border,
            right,
        })
    }

    /// Solves for the unknowns of M, given those of K.
    fn substitute(&self, feedback: &DVector<f64>) -> Option<DVector<f64>> {
        let left = &self.right - &self.border * feedback;
        self.factors.l_dirty().tr_solve_lower_triangular(&left)
    }
}
