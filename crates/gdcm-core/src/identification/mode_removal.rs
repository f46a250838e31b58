//! A model of a lower order out of one of a higher order: the mode that the measured response misses least is taken away (M14.13).
//!
//! ```text
//! H = sum of modes dH + D: real poles, and complex pairs
//! 1  of each mode of the wanted size: the sum of |dH - mean dH|^2 / var G over the points and pairs of the measured response
//! 2  the mode with the least sum goes; the mean of its real part is kept in D
//! ```

use super::*;
use nalgebra::{Complex, DMatrix, dmatrix};

impl BlockModel {
    /// The model without the complex pair (`size` 2) or the real pole (`size` 1) that `measured` misses least; none where it has no
    /// such mode, or where the rest cannot be brought to blocks.
    pub(super) fn without_least_mode(&self, size: usize, measured: &ResponseEstimate) -> Option<Self> {
        let modes = self.modes();
        let losses = modes.iter().enumerate().filter(|(_, mode)| mode.order() == size);
        let losses = losses.map(|(at, mode)| (at, Loss::of(mode, measured)));
        let (at, loss) = losses.min_by(|a, b| a.1.weighed.total_cmp(&b.1.weighed))?;
        let kept: Vec<&Self> =
            modes.iter().enumerate().filter(|(other, _)| *other != at).map(|(_, mode)| mode).collect();
        let order = self.order() - size;
        let (inputs, outputs) = (self.b.ncols(), self.c.nrows());
        let mut joined = Self {
            blocks: kept.iter().flat_map(|mode| mode.blocks.iter().copied()).collect(),
            b: DMatrix::zeros(order, inputs),
            c: DMatrix::zeros(outputs, order),
            d: &self.d + loss.mean,
        };
        let mut first = 0;
        for mode in kept {
            joined.b.rows_mut(first, mode.order()).copy_from(&mode.b);
            joined.c.columns_mut(first, mode.order()).copy_from(&mode.c);
            first += mode.order();
        }
        // Pairs real poles again.
        Self::of(&joined.state_space()?)
    }

    /// Each mode as a model without `D`: a complex pair, or a real pole.
    fn modes(&self) -> Vec<Self> {
        let nothing = DMatrix::zeros(self.c.nrows(), self.b.ncols());
        let part =
            |block: Block, b: DMatrix<f64>, c: DMatrix<f64>| Self { blocks: vec![block], b, c, d: nothing.clone() };
        let of_block = |(first, block): (usize, Block)| {
            let b = self.b.rows(first, block.size()).into_owned();
            let c = self.c.columns(first, block.size()).into_owned();
            let poles = block.poles();
            match (block, poles.as_slice()) {
                (Block::Pair { .. }, [one, two]) if one.im == 0.0 && one.re != two.re => {
                    // Columns (1, p) are the eigenvectors of [0 1; -a0 -a1].
                    let (p, q) = (one.re, two.re);
                    let inverse = dmatrix![q, -1.0; -p, 1.0] / (q - p);
                    let (b, c) = (inverse * b, c * dmatrix![1.0, 1.0; p, q]);
                    let single = |row: usize, pole: f64| {
                        part(Block::Single(pole), b.rows(row, 1).into_owned(), c.columns(row, 1).into_owned())
                    };
                    vec![single(0, p), single(1, q)]
                }
                _ => vec![part(block, b, c)],
            }
        };
        self.rows().flat_map(of_block).collect()
    }
}

/// What the model loses with a mode.
struct Loss {
    /// Mean of the real part over frequency, which stays in `D`.
    mean: DMatrix<f64>,
    /// `sum |dH - mean dH|^2 / var G`.
    weighed: f64,
}

impl Loss {
    fn of(mode: &BlockModel, measured: &ResponseEstimate) -> Self {
        let lost: Vec<_> = measured.points.iter().map(|point| mode.response(point.omega)).collect();
        let mut mean = mode.d.clone();
        lost.iter().for_each(|of| mean += of.map(|value| value.re / lost.len() as f64));
        let at_point = |(lost, point): (&DMatrix<Complex<f64>>, &EstimatePoint)| {
            let left = lost.zip_map(&mean, |lost, mean| (lost - mean).norm_sqr());
            left.zip_map(&point.variance, |left, variance| left / variance.max(f64::MIN_POSITIVE)).sum()
        };
        let weighed = lost.iter().zip(&measured.points).map(at_point).sum();
        Self { mean, weighed }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DVector;

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
        let measured = ResponseEstimate { points: log_spaced(0.5, 8.0, 20).into_iter().map(point).collect() };
        let less = model.without_least_mode(1, &measured).unwrap();
        assert_eq!(less.order(), 4);
        for omega in [0.5, 2.0, 8.0] {
            // The servo at 60 rad/s turns what it carries, 0.2, by 8/60 at most, and its mean is taken at the points.
            let error = (less.response(omega) - model.response(omega)).camax();
            assert!(error < 0.2 * 10.0 / 60.0, "{omega} rad/s: {error}");
        }
        assert_eq!(model.without_least_mode(2, &measured).unwrap().order(), 3);
        assert!(model.without_least_mode(2, &measured).unwrap().without_least_mode(2, &measured).is_none());
        let last = less.without_least_mode(2, &measured).unwrap().without_least_mode(1, &measured).unwrap();
        assert_eq!(last.order(), 1);
        assert!(last.without_least_mode(1, &measured).is_none(), "no state would be left");
    }
}
