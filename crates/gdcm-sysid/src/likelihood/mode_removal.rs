//! A model of lower order from one of higher order, without the mode whose removal changes the fit
//! to the measured response least (M14.13).
//!
//! ```text
//! H = sum of modes dH + D: real poles, and complex pairs
//! 1  for each mode of the requested size: sum |dH - mean dH|^2 / var G over the points and
//!    pairs of the measured response
//! 2  the mode with the smallest sum is removed; the mean Re dH is kept in D
//! ```

use nalgebra::{DMatrix, dmatrix};

use super::blocks::{Block, BlockModel};
use super::linear_model::LinearModel;
use crate::spectra::response_estimate::ResponseEstimate;

/// Effect of the removal of a mode.
struct Loss {
    /// `sum |dH - mean dH|^2 / var G`.
    cost: f64,
    /// Mean of `Re dH` over frequency, which is kept in `D`.
    mean: DMatrix<f64>,
}

impl BlockModel {
    /// Removes the complex pair (`size` 2) or the real pole (`size` 1) whose removal changes the
    /// fit to `measured` least.
    ///
    /// Returns `None` if there is no such mode, or if the remaining model cannot be transformed to
    /// blocks.
    pub(crate) fn without_least_mode(
        &self,
        size: usize,
        measured: &ResponseEstimate,
    ) -> Option<Self> {
        let mut modes = self.modes();
        let mut losses = Vec::new();
        for (place, mode) in modes.iter().enumerate() {
            if mode.order() == size {
                losses.push((place, mode.loss(measured)));
            }
        }
        let (place, least) = losses
            .into_iter()
            .min_by(|a, b| a.1.cost.total_cmp(&b.1.cost))?;
        modes.remove(place);
        if modes.is_empty() {
            return None;
        }
        let joined = Self::join(&modes, &self.d + least.mean);
        // Pairs the remaining real poles again.
        Self::from_state_space(&joined.state_space()?)
    }

    /// Joins modes to a model with the given `D`.
    fn join(modes: &[Self], d: DMatrix<f64>) -> Self {
        let rows: Vec<_> = modes.iter().flat_map(|mode| mode.b.row_iter()).collect();
        let columns: Vec<_> = modes.iter().flat_map(|mode| mode.c.column_iter()).collect();
        Self {
            blocks: modes
                .iter()
                .flat_map(|mode| mode.blocks.iter().copied())
                .collect(),
            b: DMatrix::from_rows(&rows),
            c: DMatrix::from_columns(&columns),
            d,
        }
    }

    /// Computes the effect of removing this mode.
    fn loss(&self, measured: &ResponseEstimate) -> Loss {
        let responses: Vec<_> = measured
            .points
            .iter()
            .map(|point| self.response(point.omega))
            .collect();
        let count = responses.len() as f64;
        let mut mean = self.d.clone();
        for response in &responses {
            mean += response.map(|value| value.re / count);
        }
        let mut costs = Vec::with_capacity(responses.len());
        for (response, point) in responses.iter().zip(&measured.points) {
            let left = response.zip_map(&mean, |lost, mean| (lost - mean).norm_sqr());
            let weighed = left.zip_map(&point.variance, |left, variance| {
                left / variance.max(f64::MIN_POSITIVE)
            });
            costs.push(weighed.sum());
        }
        Loss {
            cost: costs.iter().sum(),
            mean,
        }
    }

    /// Returns each mode, a complex pair or a real pole, as a model without `D`.
    fn modes(&self) -> Vec<Self> {
        let mut modes = Vec::new();
        for (first, block) in self.rows() {
            let b = self.b.rows(first, block.size()).into_owned();
            let c = self.c.columns(first, block.size()).into_owned();
            match (block, block.poles().as_slice()) {
                (Block::Pair { .. }, [one, other]) if one.im == 0.0 && one.re != other.re => {
                    // Columns (1, p) and (1, q) are eigenvectors of [0 1; -a0 -a1].
                    let p = one.re;
                    let q = other.re;
                    let inverse = dmatrix![q, -1.0; -p, 1.0] / (q - p);
                    let b = inverse * b;
                    let c = c * dmatrix![1.0, 1.0; p, q];
                    for (row, pole) in [p, q].into_iter().enumerate() {
                        modes.push(Self::mode(
                            Block::Single(pole),
                            b.rows(row, 1).into_owned(),
                            c.columns(row, 1).into_owned(),
                        ));
                    }
                }
                _ => modes.push(Self::mode(block, b, c)),
            }
        }
        modes
    }

    /// Returns the model of a single block, without `D`.
    fn mode(block: Block, b: DMatrix<f64>, c: DMatrix<f64>) -> Self {
        Self {
            blocks: vec![block],
            d: DMatrix::zeros(c.nrows(), b.ncols()),
            b,
            c,
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Complex, DVector};

    use gdcm_model::dataset::StateSpace;
    use gdcm_model::response::frequency_grid::log_spaced;

    use super::*;
    use crate::spectra::response_estimate::EstimatePoint;

    #[test]
    fn the_least_mode_is_removed_and_its_mean_stays() {
        let model = StateSpace::new(
            dmatrix![-0.5, 0.0, 0.0, 0.0, 0.0; 0.0, -60.0, 0.0, 0.0, 0.0; 0.0, 0.0, -1.0, 3.0, 0.0; 0.0, 0.0, -3.0, -1.0, 0.0; 0.0, 0.0, 0.0, 0.0, -4.0],
            dmatrix![1.0; 12.0; 2.0; 0.0; 0.8],
            dmatrix![1.0, 1.0, 0.0, 1.0, 1.0],
            dmatrix![0.1],
        );
        let model = BlockModel::from_state_space(&model.unwrap()).unwrap();
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
            // The servo at 60 rad/s has the gain 0.2, from which its response deviates by at most
            // 8/60 of the gain; the mean is taken over the points.
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
}
