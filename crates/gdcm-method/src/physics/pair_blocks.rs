//! Products in a pass, for each response and third of the grid (step 5 in `physics`, M18.2).
//!
//! A response's residual at a frequency is linear in the parameter values `z`, in the delay sum
//! `tau_o + tau_i` and in the ln gain sum `a_oc + b_ic`:
//!
//! ```text
//! y - sum_k d_k z_k + j omega (tau_o + tau_i) - (a_oc + b_ic),   d_k = (dH/dz_k) / H
//! y = ln(R / H^) + sum_k d_k z_k - j omega (tau_o + tau_i) + (a_oc + b_ic)
//! ```
//!
//! with the present pass's values in `y`. `R` is the identified response, `H` the physics response,
//! `H^` the same with channel gains and delays, `q` the weight of the response at a frequency. With
//! `v = (d_1, ..., d_K, -j omega, 1, y)`, a block is `sum q^2 Re(conj(v) v^T)` over a third's
//! frequencies: all later sums, with or without a condition, output, input or third, are sums of
//! blocks.

use nalgebra::Complex;

use gdcm_model::dataset::PairTable;

/// Number of parts of the frequency grid that are left out one by one for the intervals.
pub(super) const THIRDS: usize = 3;

/// Products for one response in one third of the grid.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Block {
    /// K, the count of fitted parameters.
    parameters: usize,
    /// `sum q^2 Re(conj(v) v^T)`, (K + 3) x (K + 3), row by row.
    products: Vec<f64>,
    /// `sum q^2 |ln(R / H^)|^2`.
    pub(super) squared_error: f64,
    /// `sum q^2`.
    pub(super) weight: f64,
}

impl Block {
    pub(super) fn zeros(parameters: usize) -> Self {
        let size = parameters + 3;
        Self {
            parameters,
            products: vec![0.0; size * size],
            squared_error: 0.0,
            weight: 0.0,
        }
    }

    /// Returns the summed product of two entries in `v`.
    pub(super) fn product(&self, row: usize, column: usize) -> f64 {
        self.products[row * (self.parameters + 3) + column]
    }

    /// Returns the index of `-j omega` in `v`.
    pub(super) fn delay(&self) -> usize {
        self.parameters
    }

    /// Returns the index of the entry 1 in `v`.
    pub(super) fn gain(&self) -> usize {
        self.parameters + 1
    }

    /// Returns the index of `y` in `v`.
    pub(super) fn y(&self) -> usize {
        self.parameters + 2
    }

    /// Adds a frequency with the weight `q^2`; `error` is `ln(R / H^)`.
    pub(super) fn add(&mut self, v: &[Complex<f64>], squared_weight: f64, error: Complex<f64>) {
        let size = self.parameters + 3;
        for (row, row_entry) in v.iter().enumerate() {
            let re = row_entry.re * squared_weight;
            let im = row_entry.im * squared_weight;
            let products = &mut self.products[row * size..][..size];
            for (product, column_entry) in products.iter_mut().zip(v) {
                *product += re * column_entry.re + im * column_entry.im;
            }
        }
        self.squared_error += squared_weight * error.norm_sqr();
        self.weight += squared_weight;
    }
}

/// Blocks for a condition.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ConditionBlocks {
    /// For each response, one block for each third of the grid.
    pub(super) responses: PairTable<[Block; THIRDS]>,
    /// `sum q^2 |ln(R_b / R)|^2 / (2 sum q^2)` for each other identified model b with a response.
    pub(super) other_squares: Vec<f64>,
}

/// Sums over all or some of a condition's blocks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct BlockSums {
    /// `sum q^2 |ln(R / H^)|^2`.
    pub(super) squared_error: f64,
    /// `sum q^2`.
    pub(super) weight: f64,
}

impl BlockSums {
    /// Returns the misfit `sqrt(sum q^2 |ln(R / H^)|^2 / (2 sum q^2))`, ln units; `None` without
    /// any weight.
    pub(super) fn misfit(&self) -> Option<f64> {
        if self.weight > 0.0 {
            Some((self.squared_error / (2.0 * self.weight)).sqrt())
        } else {
            None
        }
    }
}

impl ConditionBlocks {
    /// Returns the sums over all blocks.
    pub(super) fn sums(&self) -> BlockSums {
        let mut sums = BlockSums::default();
        for (_, thirds) in self.responses.iter() {
            for block in thirds {
                sums.squared_error += block.squared_error;
                sums.weight += block.weight;
            }
        }
        sums
    }
}
