//! The frequency response of a model on a grid.

use nalgebra::Complex;

use crate::dataset::{Dynamics, Pair, PairTable};

use super::frequency_grid::FrequencyGrid;
use super::prepared_model::PreparedModel;

/// `H(j omega)` of every response of a model on a grid of `N` frequencies: a p x m table of curves.
///
/// A value is not finite where the response has none: at a pole on the imaginary axis, or outside the frequencies of
/// measured data.
///
/// All values are in one piece of memory, in the order in which they are computed: as many neighbouring frequencies as a
/// vector of the processor holds, curve by curve, then the next frequencies.
#[derive(Clone, Debug)]
pub struct FrequencyResponse {
    frequencies: usize,
    /// Frequencies that lie together; the last block has some that are not of the grid.
    block: usize,
    /// The place of each curve in a block.
    places: PairTable<usize>,
    values: Vec<Complex<f64>>,
}

impl FrequencyResponse {
    /// The response of a model on one grid; for several grids prepare the model once, see [`PreparedModel`].
    pub fn of(dynamics: &Dynamics, grid: &FrequencyGrid) -> Self {
        PreparedModel::of(dynamics).response(grid)
    }

    /// Blocks of `block` frequencies, in each of which every curve has its place.
    pub(super) fn from_blocks(
        frequencies: usize,
        block: usize,
        places: PairTable<usize>,
        values: Vec<Complex<f64>>,
    ) -> Self {
        Self { frequencies, block, places, values }
    }

    /// Curves of `N` values each.
    pub(super) fn from_curves(frequencies: usize, curves: &PairTable<Vec<Complex<f64>>>) -> Self {
        let inputs = curves.inputs();
        let places = curves.map(|pair, _| pair.output * inputs + pair.input);
        let values = curves.iter().flat_map(|(_, curve)| curve.iter().copied()).collect();
        Self { frequencies, block: frequencies, places, values }
    }

    /// Number of output channels, `p`.
    pub fn outputs(&self) -> usize {
        self.places.outputs()
    }

    /// Number of input channels, `m`.
    pub fn inputs(&self) -> usize {
        self.places.inputs()
    }

    /// The `N` values of one response.
    pub fn curve(&self, pair: Pair) -> Vec<Complex<f64>> {
        let first = self.places[pair] * self.block;
        let mut curve = Vec::with_capacity(self.frequencies.next_multiple_of(self.block.max(1)));
        for values in self.values.chunks_exact(self.stride()) {
            curve.extend_from_slice(&values[first..first + self.block]);
        }
        curve.truncate(self.frequencies);
        curve
    }

    /// The values of every response, `[output, input]`.
    pub fn curves(&self) -> PairTable<Vec<Complex<f64>>> {
        self.places.map(|pair, _| self.curve(pair))
    }

    /// The responses that are not finite at some frequency.
    pub fn not_finite(&self) -> Vec<Pair> {
        // Nearly always: one look at each value.
        if self.values.iter().all(|value| value.is_finite()) {
            return Vec::new();
        }
        self.places.pairs().filter(|pair| self.curve(*pair).iter().any(|value| !value.is_finite())).collect()
    }

    /// Makes a response zero at every frequency.
    pub(super) fn clear(&mut self, pair: Pair) {
        let (first, block, stride) = (self.places[pair] * self.block, self.block, self.stride());
        for values in self.values.chunks_exact_mut(stride) {
            values[first..first + block].fill(Complex::new(0.0, 0.0));
        }
    }

    /// Multiplies a response by a factor at each frequency.
    pub(super) fn multiply(&mut self, pair: Pair, factors: &[Complex<f64>]) {
        let (first, block, stride) = (self.places[pair] * self.block, self.block, self.stride());
        for (values, factors) in self.values.chunks_exact_mut(stride).zip(factors.chunks(block.max(1))) {
            values[first..first + block].iter_mut().zip(factors).for_each(|(value, factor)| *value *= factor);
        }
    }

    /// Values in a block; at least one, for there are no chunks of none.
    fn stride(&self) -> usize {
        (self.outputs() * self.inputs() * self.block).max(1)
    }
}

/// The same values at the same places, however they lie in memory.
impl PartialEq for FrequencyResponse {
    fn eq(&self, other: &Self) -> bool {
        (self.outputs(), self.inputs(), self.frequencies) == (other.outputs(), other.inputs(), other.frequencies)
            && self.places.pairs().all(|pair| self.curve(pair) == other.curve(pair))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2 x 1 curves of three values: 1, 2, 3 and 10, 20, 30.
    fn curves() -> PairTable<Vec<Complex<f64>>> {
        PairTable::from_fn(2, 1, |pair| {
            let factor = if pair.output == 0 { 1.0 } else { 10.0 };
            [1.0, 2.0, 3.0].map(|value| Complex::from(value * factor)).to_vec()
        })
    }

    /// The same in blocks of two frequencies, the second curve first; 0 is not of the grid.
    fn blocks() -> FrequencyResponse {
        let values = [10.0, 20.0, 1.0, 2.0, 30.0, 0.0, 3.0, 0.0].map(Complex::from).to_vec();
        FrequencyResponse::from_blocks(3, 2, PairTable::from_fn(2, 1, |pair| 1 - pair.output), values)
    }

    #[test]
    fn curves_are_the_same_however_they_lie_in_memory() {
        assert_eq!(blocks().curves(), curves());
        assert_eq!(blocks(), FrequencyResponse::from_curves(3, &curves()));
        let mut others = curves();
        others[Pair::new(1, 0)][2].im = 1e-9;
        assert_ne!(blocks(), FrequencyResponse::from_curves(3, &others));
    }

    #[test]
    fn a_cleared_curve_is_zero_and_the_others_stay() {
        let mut response = blocks();
        response.clear(Pair::new(0, 0));
        let mut expected = curves();
        expected[Pair::new(0, 0)].fill(Complex::from(0.0));
        assert_eq!(response.curves(), expected);
    }

    #[test]
    fn a_multiplied_curve_has_its_factor_at_each_frequency_and_the_others_stay() {
        let mut response = blocks();
        response.multiply(Pair::new(1, 0), &[1.0, 0.5, 2.0].map(Complex::from));
        let mut expected = curves();
        expected[Pair::new(1, 0)] = [10.0, 10.0, 60.0].map(Complex::from).to_vec();
        assert_eq!(response.curves(), expected);
    }

    #[test]
    fn no_frequencies_are_no_values() {
        let none = FrequencyResponse::from_curves(0, &PairTable::filled(2, 2, Vec::new()));
        assert_eq!(none.curve(Pair::new(1, 1)), []);
    }
}
