//! Ranges of value axes that end at round numbers, so that small changes in the data do not move
//! the axis.

use gdcm_model::number_format::decimals;
use gdcm_plot::figure::Range;

/// Minimum number of steps within the data range.
const LEAST_STEPS: f64 = 6.0;

/// Returns the smallest range around `data` that begins and ends at multiples of a round step, 1, 2
/// or 5 times a power of ten; a range of the width 1 around a single value.
pub(super) fn rounded_range(data: Range) -> Range {
    if data.width() <= 0.0 {
        return Range::new(data.min - 0.5, data.max + 0.5);
    }
    let step = round_step(data.width() / LEAST_STEPS);
    Range::new(
        (data.min / step).floor() * step,
        (data.max / step).ceil() * step,
    )
}

/// Returns the largest round step that is at most `most`.
fn round_step(most: f64) -> f64 {
    let power = 10f64.powf(most.log10().floor());
    for multiple in [5.0, 2.0] {
        if multiple * power <= most {
            return multiple * power;
        }
    }
    power
}

/// Returns how many decimals are needed to separate values in a range: to between a hundredth and a
/// thousandth of its width, but at most six.
pub(super) fn decimals_in(range: Range) -> usize {
    let digit = range.width().max(f64::MIN_POSITIVE).log10().floor();
    (2.0 - digit).clamp(0.0, 6.0) as usize
}

/// Formats a value with `digits` decimals; a missing value becomes a dash.
pub(super) fn value_text(value: Option<f64>, digits: usize) -> String {
    match value {
        Some(value) => decimals(value, digits),
        None => "–".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_ends_at_round_numbers_around_the_data() {
        assert_eq!(
            rounded_range(Range::new(29.3, 46.9)),
            Range::new(28.0, 48.0)
        );
        assert_eq!(
            rounded_range(Range::new(-9.8, 10.1)),
            Range::new(-10.0, 12.0)
        );
        assert_eq!(rounded_range(Range::new(3.0, 3.0)), Range::new(2.5, 3.5));
    }

    #[test]
    fn a_small_change_of_the_data_leaves_the_range() {
        let range = rounded_range(Range::new(-9.8, 10.1));
        assert_eq!(rounded_range(Range::new(-9.6, 10.3)), range);
    }

    #[test]
    fn values_have_the_digits_that_the_range_shows() {
        assert_eq!(decimals_in(Range::new(0.0, 20.0)), 1);
        assert_eq!(decimals_in(Range::new(-2.0, 2.0)), 2);
        assert_eq!(decimals_in(Range::new(0.0, 4000.0)), 0);
    }
}
