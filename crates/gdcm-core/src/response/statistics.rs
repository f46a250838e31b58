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

/// Weighted median: the smallest value at which the cumulated weight reaches half of the whole, or the mean of it and the next
/// where it is half exactly; of equal weights that is [`median`] (M4a).
///
/// Returns NaN for no values. The values must be finite and the weights positive, one for each.
pub fn weighted_median(values: &[f64], weights: &[f64]) -> f64 {
    /// Share of the whole weight by which sums of thousands of weights may be rounded.
    const ROUNDING: f64 = 1e-12;
    let mut sorted: Vec<(f64, f64)> = values.iter().copied().zip(weights.iter().copied()).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let whole: f64 = sorted.iter().map(|(_, weight)| weight).sum();
    let mut cumulated = 0.0;
    for (index, &(value, weight)) in sorted.iter().enumerate() {
        cumulated += weight;
        let beyond_half = cumulated - 0.5 * whole;
        if beyond_half.abs() <= ROUNDING * whole {
            return sorted.get(index + 1).map_or(value, |(next, _)| 0.5 * (value + next));
        }
        if beyond_half > 0.0 {
            return value;
        }
    }
    f64::NAN
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
    use proptest::prelude::*;

    #[test]
    fn the_median_of_an_even_count_is_the_mean_of_the_middle_two() {
        assert_eq!(median(&mut [4.0, 1.0, 3.0, 2.0]), 2.5);
        assert_eq!(median(&mut [4.0, 1.0, 3.0]), 3.0);
        assert!(median(&mut []).is_nan());
    }

    #[test]
    fn the_weighted_median_is_where_half_of_the_weight_lies() {
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
        // numpy.quantile([15, 20, 35, 40, 50], 0.4) == 29.0; q = 0.05 gives 16.0.
        let values = [35.0, 20.0, 15.0, 50.0, 40.0];
        assert!((quantile(&mut values.clone(), 0.4) - 29.0).abs() < 1e-12);
        assert!((quantile(&mut values.clone(), 0.05) - 16.0).abs() < 1e-12);
        assert_eq!(quantile(&mut values.clone(), 0.0), 15.0);
        assert_eq!(quantile(&mut values.clone(), 1.0), 50.0);
    }
}
