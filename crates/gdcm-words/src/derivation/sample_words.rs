//! Describes samples by their range and their median.

use gdcm_model::number_format::five_digits;

/// Describes values by their number and range: "12 values from 0.8 to 1.3".
pub(super) fn range_words(values: &[f64]) -> String {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    match sorted.as_slice() {
        [] => "no values".to_owned(),
        [only] => five_digits(*only),
        [least, .., most] => format!(
            "{} values from {} to {}",
            sorted.len(),
            five_digits(*least),
            five_digits(*most)
        ),
    }
}

/// Describes how the median results from the values.
pub(super) fn median_words(values: &[f64]) -> String {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.len() / 2;
    match sorted.len() {
        0 => "no values".to_owned(),
        count if count % 2 == 1 => format!(
            "the middle value of {}: {}",
            range_words(values),
            five_digits(sorted[middle])
        ),
        _ => {
            let below = five_digits(sorted[middle - 1]);
            let above = five_digits(sorted[middle]);
            format!(
                "the mean of the two middle values of {}: ({below} + {above}) / 2",
                range_words(values)
            )
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_median_is_told_from_its_middle_values() {
        assert_eq!(
            median_words(&[3.0, 1.0, 2.0]),
            "the middle value of 3 values from 1.0000 to 3.0000: 2.0000"
        );
        let even = median_words(&[4.0, 1.0, 3.0, 2.0]);
        assert_eq!(
            even,
            "the mean of the two middle values of 4 values from 1.0000 to 4.0000: (2.0000 + 3.0000) / 2"
        );
    }
}
