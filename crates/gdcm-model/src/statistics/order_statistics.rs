//! Median, weighted median, mean and quantiles.

/// Returns the median: the middle value, or the mean of the two middle values (M6).
///
/// NaN for no values. The values must be finite; their order changes.
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

/// Returns the weighted median: the smallest value at which the cumulative weight reaches half the
/// total; if it is exactly half, the mean of this value and the next (M4a). Equals [`median`] for
/// equal weights.
///
/// NaN for no values. Values must be finite, weights positive, and their counts equal.
pub fn weighted_median(values: &[f64], weights: &[f64]) -> f64 {
    /// Relative rounding error tolerated in sums of thousands of weights.
    const ROUNDING: f64 = 1e-12;
    let mut sorted: Vec<WeightedValue> = values
        .iter()
        .zip(weights)
        .map(|(&value, &weight)| WeightedValue { value, weight })
        .collect();
    sorted.sort_by(|a, b| a.value.total_cmp(&b.value));
    let total: f64 = sorted.iter().map(|entry| entry.weight).sum();
    let mut cumulative = 0.0;
    for (index, entry) in sorted.iter().enumerate() {
        cumulative += entry.weight;
        let beyond_half = cumulative - 0.5 * total;
        if beyond_half.abs() <= ROUNDING * total {
            return match sorted.get(index + 1) {
                Some(next) => 0.5 * (entry.value + next.value),
                None => entry.value,
            };
        }
        if beyond_half > 0.0 {
            return entry.value;
        }
    }
    f64::NAN
}

struct WeightedValue {
    value: f64,
    weight: f64,
}

/// Returns the arithmetic mean; NaN for no values.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Returns the quantile for a probability `q` from 0 to 1, linear between order statistics (M7):
/// type 7 in Hyndman & Fan, "Sample quantiles in statistical packages", The American Statistician
/// 50(4), 1996, the default in numpy.
///
/// For n sorted values, `x_0` to `x_(n-1)`: `h = q (n - 1)`, `k = floor(h)`, `x = x_k + (h - k)
/// (x_(k+1) - x_k)`. NaN for no values. The values must be finite; their order changes.
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
    if fraction == 0.0 {
        lower
    } else {
        lower + fraction * (upper - lower)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn the_median_of_an_even_count_is_the_mean_of_both_middle_values() {
        assert_eq!(median(&mut [4.0, 1.0, 3.0, 2.0]), 2.5);
        assert_eq!(median(&mut [4.0, 1.0, 3.0]), 3.0);
        assert!(median(&mut []).is_nan());
    }

    #[test]
    fn the_weighted_median_splits_the_weight_in_half() {
        assert_eq!(weighted_median(&[3.0, 1.0, 2.0], &[1.0, 1.0, 3.0]), 2.0);
        assert_eq!(weighted_median(&[3.0, 1.0, 2.0], &[2.0, 1.0, 1.0]), 2.5);
        assert_eq!(weighted_median(&[5.0], &[0.3]), 5.0);
        assert!(weighted_median(&[], &[]).is_nan());
    }

    proptest! {
        #[test]
        fn equal_weights_give_the_median_to_the_last_digit(
            values in prop::collection::vec(-1e3_f64..1e3, 1..300), weight in 0.05_f64..1.0,
        ) {
            let weights = vec![weight; values.len()];
            prop_assert_eq!(weighted_median(&values, &weights), median(&mut values.clone()));
        }
    }

    #[test]
    fn quantiles_interpolate_as_numpy_does() {
        // Reference: numpy.quantile([15, 20, 35, 40, 50], 0.4) == 29.0; q = 0.05 gives 16.0.
        let values = [35.0, 20.0, 15.0, 50.0, 40.0];
        assert!((quantile(&mut values.clone(), 0.4) - 29.0).abs() < 1e-12);
        assert!((quantile(&mut values.clone(), 0.05) - 16.0).abs() < 1e-12);
        assert_eq!(quantile(&mut values.clone(), 0.0), 15.0);
        assert_eq!(quantile(&mut values.clone(), 1.0), 50.0);
    }
}
