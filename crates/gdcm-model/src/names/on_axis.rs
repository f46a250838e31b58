//! Standard on-axis responses for a helicopter, by channel name.

use super::channel_alias::same_channel;

/// Standard on-axis responses: output and input.
///
/// Source: Table 2 of "Bridging the Gap: Data Driven Method for Linearized Model Fidelity
/// Enhancement" (`docs/method.md`, M1).
pub const STANDARD_ON_AXIS: [(&str, &str); 5] = [
    ("P", "LAT"),
    ("Q", "LON"),
    ("R", "PED"),
    ("NY", "PED"),
    ("NZ", "COL"),
];

/// Returns whether the response from `input` to `output` is on-axis by the standard list; aliases
/// are recognised.
pub fn is_standard_on_axis(output: &str, input: &str) -> bool {
    STANDARD_ON_AXIS
        .iter()
        .any(|(on_axis_output, on_axis_input)| {
            same_channel(output, on_axis_output) && same_channel(input, on_axis_input)
        })
}
