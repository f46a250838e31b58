//! Sentences about the price of lead filters: the frequency above which the corrected model is
//! invalid, which is the upper end of the band, and the gain that the filters add at ten times this
//! frequency (M15.6).

use gdcm_method::correction::LeadPrice;
use gdcm_model::dataset::Pair;
use gdcm_model::number_format::{signed, six_digits};

/// Gain \[dB\] below which the displayed value, rounded to 0.1 dB, is zero.
const ROUNDS_TO_ZERO_DB: f64 = 0.05;

/// Describes the frequency limit: "not valid above 12 rad/s".
pub fn limit_text(price: &LeadPrice) -> String {
    format!("not valid above {} rad/s", six_digits(price.limit_rad_s))
}

/// Describes the frequency limit, and the gain that each filter adds to its channel: "not valid
/// above 12 rad/s: at 120 rad/s the leads add +9.1 dB on LON, +11.3 dB on Q; the gain of a response
/// increases by the sum of those at its input and output". Only the limit, if no filter adds gain.
pub fn price_text(price: &LeadPrice, inputs: &[String], outputs: &[String]) -> String {
    let mut gains = Vec::new();
    for (channel, &gain_db) in price.gains_db.iter() {
        if gain_db > ROUNDS_TO_ZERO_DB {
            let name = channel.name(inputs, outputs);
            gains.push(format!("{} dB on {name}", signed(gain_db, 1)));
        }
    }
    if gains.is_empty() {
        return limit_text(price);
    }
    format!(
        "{}: at {} rad/s the leads add {}; the gain of a response increases by the sum of those at \
        its input and output",
        limit_text(price),
        six_digits(price.above_rad_s()),
        gains.join(", ")
    )
}

/// Describes the gain added to a response: "+18.9 dB at 120 rad/s"; `None` if it rounds to zero.
pub fn pair_price_text(price: &LeadPrice, pair: Pair) -> Option<String> {
    let gain_db = price.of_pair_db(pair);
    if gain_db > ROUNDS_TO_ZERO_DB {
        let above_rad_s = six_digits(price.above_rad_s());
        Some(format!("{} dB at {above_rad_s} rad/s", signed(gain_db, 1)))
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use gdcm_method::correction::Channels;

    use super::*;

    #[test]
    fn a_price_names_the_limit_and_the_channels_with_a_filter() {
        let price = LeadPrice {
            limit_rad_s: 12.0,
            gains_db: Channels {
                inputs: vec![9.1, 0.0],
                outputs: vec![11.3],
            },
        };
        let inputs = ["LON".to_owned(), "LAT".to_owned()];
        assert_eq!(
            price_text(&price, &inputs, &["Q".to_owned()]),
            "not valid above 12 rad/s: at 120 rad/s the leads add +9.1 dB on LON, +11.3 dB on Q; \
            the gain of a response increases by the sum of those at its input and output"
        );
    }
}
