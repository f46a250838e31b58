//! Changes of physics parameters from their nominal values, in words: "Ixx +4 %".

use gdcm_method::physics::OfferedParameter;
use gdcm_model::number_format::{decimals, signed, six_digits, with_minus_sign};
use gdcm_study::results::applied_physics::{AppliedPhysics, AppliedValue};

/// Formats a change with its half-width in the parameter's unit: "+1.6 ± 0.2 deg".
pub fn change_text(parameter: &OfferedParameter, change: f64, half_width: Option<f64>) -> String {
    let unit = unit_text(&parameter.unit);
    match half_width {
        Some(half_width) if half_width > 0.0 && half_width.is_finite() => {
            let digits = half_width_decimals(half_width);
            format!(
                "{} ± {}{unit}",
                signed(change, digits),
                decimals(half_width, digits)
            )
        }
        _ => format!("{}{unit}", plain_change(change)),
    }
}

/// Formats a change with up to six digits and its sign.
fn plain_change(change: f64) -> String {
    let text = with_minus_sign(&six_digits(change));
    if change > 0.0 {
        format!("+{text}")
    } else {
        text
    }
}

/// Returns the unit after a space; empty for a number without unit ("1").
pub(super) fn unit_text(unit: &str) -> String {
    if unit == "1" || unit.is_empty() {
        String::new()
    } else {
        format!(" {unit}")
    }
}

/// Returns the decimals that a half-width needs for one significant digit, or two if the first is 1:
/// 2.1 has none, 0.17 two.
pub(super) fn half_width_decimals(half_width: f64) -> usize {
    let exponent = half_width.log10().floor();
    let first_digit = half_width / 10_f64.powf(exponent);
    let mut count = -exponent;
    if first_digit < 2.0 {
        count += 1.0;
    }
    count.clamp(0.0, 9.0) as usize
}

/// Names an applied value: "Ixx +4 %".
pub fn applied_value_text(value: &AppliedValue) -> String {
    format!(
        "{} {}",
        value.parameter.name,
        change_text(&value.parameter, value.change(), value.half_width())
    )
}

/// Lists the applied values: "Ixx +4 %", "tail_lift +10 ± 2 %".
pub fn applied_value_list(applied: &AppliedPhysics) -> Vec<String> {
    applied.values.iter().map(applied_value_text).collect()
}

/// Returns a text block to paste into the physics model's input: name, change, unit.
pub fn paste_block(applied: &AppliedPhysics) -> String {
    let mut text = String::from("# parameter  change from nominal  unit\n");
    for value in &applied.values {
        let name = &value.parameter.name;
        let change = plain_change(value.change()).replace('\u{2212}', "-");
        text.push_str(&format!("{name} = {change} {}\n", value.parameter.unit));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameter(unit: &str) -> OfferedParameter {
        OfferedParameter {
            name: "p".to_owned(),
            unit: unit.to_owned(),
            plausible_sd: 1.0,
            description: String::new(),
        }
    }

    #[test]
    fn changes_have_the_digits_of_their_interval() {
        let text = |unit, change, half_width| change_text(&parameter(unit), change, half_width);
        assert_eq!(text("deg", 1.58, Some(0.21)), "+1.6 ± 0.2 deg");
        assert_eq!(text("%", 10.2, Some(2.1)), "+10 ± 2 %");
        assert_eq!(text("1", 0.243, Some(0.17)), "+0.24 ± 0.17");
        assert_eq!(text("%", -12.0, None), "−12 %");
        assert_eq!(text("%", 4.0, Some(0.0)), "+4 %");
    }
}
