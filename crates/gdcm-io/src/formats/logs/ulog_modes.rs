//! Flight modes in PX4 logs, from the topic `vehicle_status`.

use gdcm_sysid::records::ModeSpan;

use crate::formats::logs::mode_spans::mode_spans;
use crate::formats::logs::topic_samples::TopicSamples;

/// `ARMING_STATE_ARMED` in `VehicleStatus.msg`, PX4 1.14 to 1.16.
const ARMED: f64 = 2.0;

/// Flight mode names for `NAVIGATION_STATE_…` in `VehicleStatus.msg`, PX4 1.14 to 1.16.
const NAVIGATION: [(u8, &str); 13] = [
    (0, "manual"),
    (1, "altitude"),
    (2, "position"),
    (3, "mission"),
    (4, "loiter"),
    (5, "return"),
    (10, "acro"),
    (12, "descend"),
    (14, "offboard"),
    (15, "stabilized"),
    (17, "take-off"),
    (18, "land"),
    (21, "orbit"),
];

/// Returns the spans in which the vehicle was armed, and the flight mode spans, from
/// `vehicle_status`.
pub(super) fn flight_modes(topics: &[TopicSamples]) -> Vec<ModeSpan> {
    let Some(status) = topics.iter().find(|topic| topic.name == "vehicle_status") else {
        return Vec::new();
    };
    let mut modes = Vec::new();
    if let Some(field) = status.field("arming_state") {
        let states = field.values.iter().copied();
        modes.extend(mode_spans(&status.time_s, states, |state| {
            if state == ARMED {
                Some("armed".to_owned())
            } else {
                None
            }
        }));
    }
    if let Some(field) = status.field("nav_state") {
        let states = field.values.iter().copied();
        modes.extend(mode_spans(&status.time_s, states, navigation_mode));
    }
    modes
}

/// Returns a navigation state's name; `None` for an unknown state.
fn navigation_mode(state: f64) -> Option<String> {
    let (_, name) = NAVIGATION
        .iter()
        .find(|(number, _)| f64::from(*number) == state)?;
    Some((*name).to_owned())
}
