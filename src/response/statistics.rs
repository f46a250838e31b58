//! Order statistics over frequency.

/// Median: the middle value, or the mean of the middle two of an even count (M6).
///
/// Returns NaN for no values. The values must be finite; their order is changed.
pub fn median(values: &mut [f64]) -> f64 {
    let count = values.len();
    if count == 0 {
        return f64::NAN;
    }
    let (below, upper, _) = values.select_nth_unstable_by(count / 2, f64::total_cmp);
    if count % 2 == 1 {
        return *upper;
    }
    let lower = below.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    0.5 * (lower + *upper)
}

/// Arithmetic mean; NaN for no values.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Quantile `q` from 0 to 1, linear between order statistics (numpy's default, Hyndman and Fan's type 7) (M7).
///
/// `h = q (n - 1)`, `x = x_[h] + (h - [h]) (x_[h]+1 - x_[h])`. Returns NaN for no values. The values must be finite; their
/// order is changed.
pub fn quantile(values: &mut [f64], q: f64) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    let position = q.clamp(0.0, 1.0) * (values.len() - 1) as f64;
    let below = position.floor() as usize;
    let (_, lower, above) = values.select_nth_unstable_by(below, f64::total_cmp);
    let lower = *lower;
    let upper = above.iter().copied().fold(f64::INFINITY, f64::min);
    let fraction = position - below as f64;
    if fraction == 0.0 { lower } else { lower + fraction * (upper - lower) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_of_an_even_count_is_the_mean_of_the_middle_two() {
        assert_eq!(median(&mut [4.0, 1.0, 3.0, 2.0]), 2.5);
        assert_eq!(median(&mut [4.0, 1.0, 3.0]), 3.0);
        assert!(median(&mut []).is_nan());
    }

    #[test]
    fn quantiles_interpolate_as_numpy_does() {
        // numpy.quantile([15, 20, 35, 40, 50], 0.4) == 29.0; q = 0.05 gives 16.0.
        let values = [35.0, 20.0, 15.0, 50.0, 40.0];
        assert!((quantile(&mut values.clone(), 0.4) - 29.0).abs() < 1e-12);
        assert!((quantile(&mut values.clone(), 0.05) - 16.0).abs() < 1e-12);
        assert_eq!(quantile(&mut values.clone(), 0.0), 15.0);
        assert_eq!(quantile(&mut values.clone(), 1.0), 50.0);
    }
}
