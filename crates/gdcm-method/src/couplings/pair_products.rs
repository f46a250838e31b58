//! Sums of products over frequencies, by pair of factors and pair of inputs in the normal equations
//! (M16.2).
//!
//! The sum of `Re conj(t_a) t_b P_jl` over frequencies is a difference of two matrix products, with
//! a row for each pair `a <= b` and a column for each pair `j <= l`:
//!
//! ```text
//! Re(conj(t_a) t_b P_jl) = Re(conj(t_a) t_b) Re P_jl - Im(conj(t_a) t_b) Im P_jl,   P = F^H q^2 F,   P_lj = conj P_jl
//! ```

use nalgebra::{Complex, DMatrix, DMatrixView};

/// Frequencies whose products are summed at once, so that their factors stay in the processor
/// cache.
pub(super) const CHUNK: usize = 64;

/// Returns the number of pairs `a <= b` among `count` items.
pub(super) fn pair_count(count: usize) -> usize {
    count * (count + 1) / 2
}

/// Returns the index of the pair `a <= b` among `count` items, row by row.
pub(super) fn pair_index(a: usize, b: usize, count: usize) -> usize {
    a * count - a * a.saturating_sub(1) / 2 + b - a
}

/// Sums over frequencies of `Re conj(t_a) t_b P_jl`: a row for each pair of factors `t`, a column
/// for each pair `j <= l` of inputs.
#[derive(Clone)]
pub(super) struct PairProducts {
    inputs: usize,
    /// Sums of the products of real parts.
    real: DMatrix<f64>,
    /// Sums of the products of imaginary parts.
    imaginary: DMatrix<f64>,
}

impl PairProducts {
    pub(super) fn zeros(rows: usize, inputs: usize) -> Self {
        let zeros = DMatrix::zeros(rows, pair_count(inputs));
        Self {
            inputs,
            real: zeros.clone(),
            imaginary: zeros,
        }
    }

    /// Returns the sum for the factor pair `row` and the inputs `j` and `l`, which may be in either
    /// order.
    pub(super) fn entry(&self, row: usize, j: usize, l: usize) -> f64 {
        if j <= l {
            let column = pair_index(j, l, self.inputs);
            self.real[(row, column)] - self.imaginary[(row, column)]
        } else {
            let column = pair_index(l, j, self.inputs);
            self.real[(row, column)] + self.imaginary[(row, column)]
        }
    }

    /// Adds the products of a chunk; `first` is the chunk's row of the first factor pair.
    pub(super) fn add_chunk(&mut self, chunk: &ProductChunk, first: usize) {
        let (rows, columns) = self.real.shape();
        if rows == 0 || chunk.filled == 0 {
            return;
        }
        for (sums, factors, weighted) in [
            (&mut self.real, &chunk.t_re, &chunk.p_re),
            (&mut self.imaginary, &chunk.t_im, &chunk.p_im),
        ] {
            let factors = factors.view((first, 0), (rows, chunk.filled));
            // The transpose, read without copying.
            let weighted = DMatrixView::from_slice_with_strides(
                weighted.as_slice(),
                chunk.filled,
                columns,
                columns,
                1,
            );
            sums.gemm(1.0, &factors, &weighted, 1.0);
        }
    }

    /// Adds the sums over other frequencies.
    pub(super) fn add(&mut self, other: &Self) {
        self.real += &other.real;
        self.imaginary += &other.imaginary;
    }
}

/// Factors of the products, a column for each frequency.
pub(super) struct ProductChunk {
    /// Number of filled columns.
    filled: usize,
    /// `Re conj(t_a) t_b`, a row for each pair `a <= b`.
    t_re: DMatrix<f64>,
    /// `Im conj(t_a) t_b`, in the layout of `t_re`.
    t_im: DMatrix<f64>,
    /// `Re P_jl`, a row for each pair `j <= l`.
    p_re: DMatrix<f64>,
    /// `Im P_jl`, in the layout of `p_re`.
    p_im: DMatrix<f64>,
}

/// A p x m matrix, its real and imaginary parts stored row by row.
pub(super) struct RowParts {
    pub(super) re: Vec<f64>,
    pub(super) im: Vec<f64>,
}

impl ProductChunk {
    pub(super) fn new(inputs: usize, factors: usize) -> Self {
        let t = DMatrix::zeros(pair_count(factors), CHUNK);
        let p = DMatrix::zeros(pair_count(inputs), CHUNK);
        Self {
            filled: 0,
            t_re: t.clone(),
            t_im: t,
            p_re: p.clone(),
            p_im: p,
        }
    }

    pub(super) fn clear(&mut self) {
        self.filled = 0;
    }

    /// Appends a frequency: the factors `t`, the matrix `F`, and the weights `q^2` of its rows.
    pub(super) fn push(&mut self, t: &[Complex<f64>], f: &RowParts, squared_weights: &[f64]) {
        self.push_factors(t);
        self.push_weighted(f, squared_weights);
        self.filled += 1;
    }

    fn push_factors(&mut self, t: &[Complex<f64>]) {
        let pairs = self.t_re.nrows();
        let t_re = &mut self.t_re.as_mut_slice()[self.filled * pairs..][..pairs];
        let t_im = &mut self.t_im.as_mut_slice()[self.filled * pairs..][..pairs];
        let mut pair = 0;
        for (a, left) in t.iter().enumerate() {
            for right in &t[a..] {
                let product = left.conj() * right;
                t_re[pair] = product.re;
                t_im[pair] = product.im;
                pair += 1;
            }
        }
    }

    fn push_weighted(&mut self, f: &RowParts, squared_weights: &[f64]) {
        let inputs = f.re.len() / squared_weights.len();
        let pairs = self.p_re.nrows();
        let p_re = &mut self.p_re.as_mut_slice()[self.filled * pairs..][..pairs];
        let p_im = &mut self.p_im.as_mut_slice()[self.filled * pairs..][..pairs];
        p_re.fill(0.0);
        p_im.fill(0.0);
        for (output, &squared) in squared_weights.iter().enumerate() {
            if squared > 0.0 {
                let row = output * inputs..(output + 1) * inputs;
                add_outer_product(&f.re[row.clone()], &f.im[row], squared, p_re, p_im);
            }
        }
    }
}

/// Adds `q^2 conj(f_j) f_l` for each pair `j <= l` in a row `f` of `F`.
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
