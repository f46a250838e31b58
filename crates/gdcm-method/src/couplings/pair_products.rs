//! Products summed over frequencies, for each factor pair and each input pair in the normal
//! equations (M16.2).
//!
//! An unknown's column in the design matrix is, at each frequency, column j of the physics response
//! `F` with its loop closed (p x m) times a factor `t_a`: `t_0 = 1` for an entry of the mixing, and
//! for an entry of the feedback `t_1, t_2, ...`, the flight responses of the fed-back outputs to
//! the same input. With the response weights `q`, two unknowns `(a, j)` and `(b, l)` have the
//! normal matrix entry
//!
//! ```text
//! sum over frequencies of Re(conj(t_a) t_b P_jl),   P = F^H q^2 F, m x m,  P_lj = conj P_jl
//! Re(conj(t_a) t_b P_jl) = Re(conj(t_a) t_b) Re P_jl - Im(conj(t_a) t_b) Im P_jl
//! ```
//!
//! Summed over the frequencies, this is a difference between two matrix products, with a row for
//! each pair `a <= b` and a column for each pair `j <= l`. Pairs are ordered by their first, then
//! by their second index: (0,0), (0,1), ... (1,1), (1,2), ... The pairs with `t_0` therefore come
//! before all others.

use nalgebra::{Complex, DMatrix, DMatrixView};

/// Frequencies whose products are summed at once, so that their factors stay in the processor
/// cache.
pub(super) const CHUNK: usize = 64;

/// Counts the pairs `a <= b` among `count` items.
pub(super) fn pair_count(count: usize) -> usize {
    count * (count + 1) / 2
}

/// Returns the index that the pair `a <= b` has among `count` items. Before it are the pairs with a
/// smaller first index, `count + (count - 1) + ...` with `a` terms, and `b - a` pairs with the same
/// first index.
pub(super) fn pair_index(a: usize, b: usize, count: usize) -> usize {
    a * count - a * a.saturating_sub(1) / 2 + b - a
}

/// `Re conj(t_a) t_b P_jl` summed over frequencies: a row for each factor pair, a column for each
/// input pair `j <= l`.
#[derive(Clone)]
pub(super) struct PairProducts {
    inputs: usize,
    /// Summed products of real parts.
    real: DMatrix<f64>,
    /// Summed products of imaginary parts.
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
    /// order: `P_lj` is the conjugate of `P_jl`.
    pub(super) fn entry(&self, row: usize, j: usize, l: usize) -> f64 {
        if j <= l {
            let column = pair_index(j, l, self.inputs);
            self.real[(row, column)] - self.imaginary[(row, column)]
        } else {
            let column = pair_index(l, j, self.inputs);
            self.real[(row, column)] + self.imaginary[(row, column)]
        }
    }

    /// Adds a chunk's products for the factor pairs that contain `t_0`; there is a row for each.
    pub(super) fn add_pairs_with_first(&mut self, chunk: &ProductChunk) {
        self.add_rows_from(chunk, 0);
    }

    /// Adds a chunk's products for the factor pairs without `t_0`; there is a row for each.
    pub(super) fn add_pairs_without_first(&mut self, chunk: &ProductChunk) {
        self.add_rows_from(chunk, chunk.t_re.nrows() - self.real.nrows());
    }

    /// Adds a chunk's products; `first_row` is the chunk's row that belongs to the first row here.
    fn add_rows_from(&mut self, chunk: &ProductChunk, first_row: usize) {
        let (rows, columns) = self.real.shape();
        if rows == 0 || chunk.filled == 0 {
            return;
        }
        for (sums, factors, weighted) in [
            (&mut self.real, &chunk.t_re, &chunk.p_re),
            (&mut self.imaginary, &chunk.t_im, &chunk.p_im),
        ] {
            let factors = factors.view((first_row, 0), (rows, chunk.filled));
            // The transpose, read without copying: rows by frequency, columns by input pair.
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

    /// Adds another condition's sums.
    pub(super) fn add(&mut self, other: &Self) {
        self.real += &other.real;
        self.imaginary += &other.imaginary;
    }
}

/// Factors in the products at up to [`CHUNK`] frequencies, a column for each.
pub(super) struct ProductChunk {
    /// Count of filled columns.
    filled: usize,
    /// `Re conj(t_a) t_b`, a row for each pair `a <= b`.
    t_re: DMatrix<f64>,
    /// `Im conj(t_a) t_b`, laid out like `t_re`.
    t_im: DMatrix<f64>,
    /// `Re P_jl`, a row for each pair `j <= l`.
    p_re: DMatrix<f64>,
    /// `Im P_jl`, laid out like `p_re`.
    p_im: DMatrix<f64>,
}

/// A p x m matrix, its real and imaginary parts stored row by row.
pub(super) struct RowParts {
    re: Vec<f64>,
    im: Vec<f64>,
}

impl RowParts {
    /// Reorders a matrix with `outputs` rows that is stored column by column.
    pub(super) fn from_columns(columns: &[Complex<f64>], outputs: usize) -> Self {
        let inputs = columns.len() / outputs;
        let mut re = Vec::with_capacity(columns.len());
        let mut im = Vec::with_capacity(columns.len());
        for output in 0..outputs {
            for input in 0..inputs {
                let value = columns[input * outputs + output];
                re.push(value.re);
                im.push(value.im);
            }
        }
        Self { re, im }
    }
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

    /// Appends a frequency: the factors `t`, the matrix `F`, and its row weights `q^2`.
    pub(super) fn push(&mut self, t: &[Complex<f64>], f: &RowParts, squared_weights: &[f64]) {
        self.push_factors(t);
        self.push_weighted(f, squared_weights);
        self.filled += 1;
    }

    /// Writes `conj(t_a) t_b` for each pair `a <= b` into the next column.
    fn push_factors(&mut self, t: &[Complex<f64>]) {
        let pairs = self.t_re.nrows();
        let t_re = &mut self.t_re.as_mut_slice()[self.filled * pairs..][..pairs];
        let t_im = &mut self.t_im.as_mut_slice()[self.filled * pairs..][..pairs];
        let mut pair = 0;
        for (a, t_a) in t.iter().enumerate() {
            for t_b in &t[a..] {
                let product = t_a.conj() * t_b;
                t_re[pair] = product.re;
                t_im[pair] = product.im;
                pair += 1;
            }
        }
    }

    /// Writes `P_jl = sum q^2 conj(F_oj) F_ol` over the outputs o, for each pair `j <= l`, into the
    /// next column.
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
    // Index for the pair (j, j); the pairs (j, l) with l > j follow it.
    let mut start = 0;
    for j in 0..re.len() {
        let weighted_re = squared * re[j];
        let weighted_im = squared * im[j];
        // From here on, `re` and `im` begin with `f_j`.
        let re = &re[j..];
        let im = &im[j..];
        let end = start + re.len();
        for (sum, (re, im)) in p_re[start..end].iter_mut().zip(re.iter().zip(im)) {
            *sum += weighted_re * re + weighted_im * im;
        }
        for (sum, (re, im)) in p_im[start..end].iter_mut().zip(re.iter().zip(im)) {
            *sum += weighted_re * im - weighted_im * re;
        }
        start = end;
    }
}
