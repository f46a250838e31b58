//! Aircraft logs: topics, each with its own clock.
//!
//! ```text
//! bytes -> messages -> topics: stamps, and a column for each field      (ulog, dataflash, blackbox)
//!       -> units and channels by the documentation of the system        (Meanings)
//! ```

mod blackbox;
mod dataflash;
mod ulog;

use std::sync::Arc;

use gdcm_sysid::records::record_table::TopicClock;
use gdcm_sysid::records::{ModeSpan, RecordColumn};

use crate::reading_budget::{ReadingBudget, VariableFault};

pub(crate) use blackbox::BLACKBOX;
pub(crate) use dataflash::{DATAFLASH, DATAFLASH_TEXT};
pub(crate) use ulog::ULOG;

/// A topic with fewer samples is ignored.
const FEWEST: usize = 3;
/// Largest number of mode spans kept for a log.
const MOST_MODES: usize = 1000;

/// A topic during reading.
struct TopicSamples {
    name: String,
    fields: Vec<TopicField>,
    time_s: Vec<f64>,
}

/// A field of a topic, with its samples.
struct TopicField {
    name: String,
    unit: Option<String>,
    values: Vec<f64>,
}

impl TopicSamples {
    /// Creates a topic with these fields and no samples.
    fn new(name: String, fields: impl IntoIterator<Item = (String, Option<String>)>) -> Self {
        let fields = fields.into_iter().map(|(name, unit)| TopicField {
            name,
            unit,
            values: Vec::new(),
        });
        Self {
            name,
            fields: fields.collect(),
            time_s: Vec::new(),
        }
    }

    /// Appends a sample: a value for each field, in order.
    fn push(
        &mut self,
        time_s: f64,
        values: impl IntoIterator<Item = f64>,
        budget: &ReadingBudget<'_>,
    ) -> Result<(), VariableFault> {
        budget.take(self.fields.len() as u64 + 1, 8, &self.name)?;
        self.time_s.push(time_s);
        self.fields
            .iter_mut()
            .zip(values)
            .for_each(|(field, value)| field.values.push(value));
        Ok(())
    }

    /// Returns the columns; none if there are too few samples.
    fn columns(self) -> Vec<RecordColumn> {
        if self.time_s.len() < FEWEST {
            return Vec::new();
        }
        let clock = Arc::new(TopicClock {
            name: self.name,
            time_s: self.time_s,
        });
        let column = |field: TopicField| RecordColumn {
            unit: field.unit,
            topic: Some(Arc::clone(&clock)),
            ..RecordColumn::new(format!("{}.{}", clock.name, field.name), field.values)
        };
        self.fields.into_iter().map(column).collect()
    }
}

/// Returns the spans of equal, named values of a state.
fn mode_spans(
    time_s: &[f64],
    values: impl IntoIterator<Item = f64>,
    name: impl Fn(f64) -> Option<String>,
) -> Vec<ModeSpan> {
    let mut spans: Vec<ModeSpan> = Vec::new();
    let mut last: Option<f64> = None;
    for (&time, value) in time_s.iter().zip(values) {
        let goes_on = last == Some(value);
        let begins = last.is_none() || !goes_on;
        if begins {
            // A state lasts until the next state is logged.
            if let Some(open) = spans.last_mut().filter(|_| last.and_then(&name).is_some()) {
                open.ends_s[1] = time;
            }
            if let Some(name) = name(value).filter(|_| spans.len() < MOST_MODES) {
                spans.push(ModeSpan {
                    name,
                    ends_s: [time, time],
                });
            }
        } else if let Some(open) = spans.last_mut().filter(|_| name(value).is_some()) {
            open.ends_s[1] = time;
        }
        last = Some(value);
    }
    spans
}

/// Describes spans: "armed 3.2 to 88.1 s".
fn modes_note(spans: &[ModeSpan]) -> Option<String> {
    const SHOWN: usize = 8;
    let words = |span: &ModeSpan| {
        format!(
            "{} {:.1} to {:.1} s",
            span.name, span.ends_s[0], span.ends_s[1]
        )
    };
    let shown: Vec<String> = spans.iter().take(SHOWN).map(words).collect();
    let more = spans.len().saturating_sub(SHOWN);
    let more = if more == 0 {
        String::new()
    } else {
        format!(" and {more} more")
    };
    (!shown.is_empty()).then(|| format!("{}{more}", shown.join(", ")))
}

// Little-endian numbers.

/// Returns `N` bytes from an offset on, or nothing if too few are left.
pub(super) fn array<const N: usize>(bytes: &[u8], offset: usize) -> Option<[u8; N]> {
    bytes.get(offset..offset.checked_add(N)?)?.try_into().ok()
}

// Documented meanings of the columns of each system's logs.

/// A documented column: name, channel, unit.
type Meaning = (&'static str, &'static str, &'static str);

/// Documented columns of a system's logs: for each channel the first column that is present and
/// varies.
pub(super) struct Meanings {
    columns: &'static [Meaning],
    /// Remark on the signs.
    signs: &'static str,
}

/// PX4: `VehicleTorqueSetpoint.msg`, `VehicleThrustSetpoint.msg` (normalised, body axes),
/// `VehicleAngularVelocity.msg` \[rad/s\], `VehicleAcceleration.msg` \[m/s²\]; before 1.14
/// `ActuatorControls.msg` (<https://docs.px4.io/main/en/msg_docs/>).
pub(super) const PX4: Meanings = Meanings {
    columns: &[
        ("vehicle_torque_setpoint.xyz[0]", "LAT", "1"),
        ("vehicle_torque_setpoint.xyz[1]", "LON", "1"),
        ("vehicle_torque_setpoint.xyz[2]", "PED", "1"),
        ("vehicle_thrust_setpoint.xyz[2]", "COL", "1"),
        ("actuator_controls_0.control[0]", "LAT", "1"),
        ("actuator_controls_0.control[1]", "LON", "1"),
        ("actuator_controls_0.control[2]", "PED", "1"),
        ("actuator_controls_0.control[3]", "COL", "1"),
        ("vehicle_angular_velocity.xyz[0]", "P", "rad/s"),
        ("vehicle_angular_velocity.xyz[1]", "Q", "rad/s"),
        ("vehicle_angular_velocity.xyz[2]", "R", "rad/s"),
        ("sensor_combined.gyro_rad[0]", "P", "rad/s"),
        ("sensor_combined.gyro_rad[1]", "Q", "rad/s"),
        ("sensor_combined.gyro_rad[2]", "R", "rad/s"),
        ("vehicle_acceleration.xyz[0]", "NX", "m/s^2"),
        ("vehicle_acceleration.xyz[1]", "NY", "m/s^2"),
        ("vehicle_acceleration.xyz[2]", "NZ", "m/s^2"),
        ("sensor_combined.accelerometer_m_s2[0]", "NX", "m/s^2"),
        ("sensor_combined.accelerometer_m_s2[1]", "NY", "m/s^2"),
        ("sensor_combined.accelerometer_m_s2[2]", "NZ", "m/s^2"),
    ],
    signs: "signs are PX4's: body axes forward, right, down, so that thrust and acceleration along z are negative up (say COL=-COLUMN \
            to turn one)",
};

/// ArduPilot: `SIDD` of the system identification mode, `RATE`, `IMU`
/// (<https://ardupilot.org/copter/docs/logmessages.html>). `R`, `P` and `Y` are roll, pitch and
/// yaw; `…Out` goes to the motors, from -1 to 1 (`AOut` from 0 to 1).
pub(super) const ARDUPILOT: Meanings = Meanings {
    columns: &[
        ("RATE.ROut", "LAT", "1"),
        ("RATE.POut", "LON", "1"),
        ("RATE.YOut", "PED", "1"),
        ("RATE.AOut", "COL", "1"),
        ("SIDD.Gx", "P", "deg/s"),
        ("SIDD.Gy", "Q", "deg/s"),
        ("SIDD.Gz", "R", "deg/s"),
        ("SIDD.Ax", "NX", "m/s^2"),
        ("SIDD.Ay", "NY", "m/s^2"),
        ("SIDD.Az", "NZ", "m/s^2"),
        ("SIDD.Targ", "TARG", ""),
        ("RATE.R", "P", "deg/s"),
        ("RATE.P", "Q", "deg/s"),
        ("RATE.Y", "R", "deg/s"),
        ("IMU.GyrX", "P", "rad/s"),
        ("IMU.GyrY", "Q", "rad/s"),
        ("IMU.GyrZ", "R", "rad/s"),
        ("IMU.AccX", "NX", "m/s^2"),
        ("IMU.AccY", "NY", "m/s^2"),
        ("IMU.AccZ", "NZ", "m/s^2"),
        ("ATT.Roll", "PHI", "deg"),
        ("ATT.Pitch", "THETA", "deg"),
    ],
    signs: "signs are ArduPilot's: body axes forward, right, down, so that the acceleration along z is negative up (say NZ=-COLUMN \
            to turn one)",
};

/// Betaflight and relatives: field names of the blackbox; `axisSum` is the sum of the controller's
/// terms, the input of the mixer (<https://betaflight.com/docs/development/Blackbox>).
pub(super) const BETAFLIGHT: Meanings = Meanings {
    columns: &[
        ("axisSum[0]", "LAT", ""),
        ("axisSum[1]", "LON", ""),
        ("axisSum[2]", "PED", ""),
        ("rcCommand[3]", "COL", ""),
        ("gyroADC[0]", "P", "deg/s"),
        ("gyroADC[1]", "Q", "deg/s"),
        ("gyroADC[2]", "R", "deg/s"),
    ],
    signs: "signs are the flight controller's: compare one channel before signs of derivatives are used",
};

/// Assigns the documented channels and units to columns; returns a note of the assignments.
pub(super) fn give_meanings(columns: &mut [RecordColumn], meanings: &Meanings) -> Option<String> {
    let mut given: Vec<(&str, &str)> = Vec::new();
    for &(name, channel, unit) in meanings.columns {
        let moves =
            |column: &&mut RecordColumn| column.range().is_some_and(|(least, most)| least < most);
        let Some(column) = columns.iter_mut().find(|column| column.name == name) else {
            continue;
        };
        if column.unit.is_none() {
            column.unit = Some(unit.to_owned()).filter(|unit| !unit.is_empty());
        }
        if Some(&mut *column).as_ref().is_some_and(moves)
            && given.iter().all(|(taken, _)| *taken != channel)
        {
            column.meaning = Some(channel);
            given.push((channel, name));
        }
    }
    if given.is_empty() {
        return None;
    }
    let words: Vec<String> = given
        .iter()
        .map(|(channel, name)| format!("{channel} = {name}"))
        .collect();
    Some(format!(
        "by the system's documentation: {}; {}",
        words.join(", "),
        meanings.signs
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_lasts_until_the_next_one_is_told() {
        let name = |value: f64| (value == 2.0).then(|| "armed".to_owned());
        let spans = mode_spans(&[0.0, 1.0, 2.0, 5.0, 6.0], [1.0, 2.0, 2.0, 1.0, 2.0], name);
        let ends: Vec<[f64; 2]> = spans.iter().map(|span| span.ends_s).collect();
        assert_eq!(ends, [[1.0, 5.0], [6.0, 6.0]]);
        assert_eq!(modes_note(&spans[..1]).unwrap(), "armed 1.0 to 5.0 s");
    }
}

#[cfg(test)]
mod meaning_tests {
    use super::*;

    #[test]
    fn a_channel_is_the_first_column_that_is_there_and_moves() {
        let moving = vec![0.0, 1.0, 2.0];
        let mut columns = vec![
            RecordColumn::new("RATE.P", moving.clone()),
            RecordColumn::new("RATE.R", moving.clone()),
            RecordColumn::new("SIDD.Gx", vec![1.0; 3]),
            RecordColumn {
                unit: Some("deg".into()),
                ..RecordColumn::new("IMU.GyrY", moving)
            },
        ];
        let words = give_meanings(&mut columns, &ARDUPILOT).unwrap();
        let found: Vec<_> = columns.iter().map(|column| column.meaning).collect();
        assert_eq!(found, [Some("Q"), Some("P"), None, None], "{words}");
        assert_eq!(
            columns[3].unit.as_deref(),
            Some("deg"),
            "what the file says stays"
        );
        assert!(
            words.starts_with("by the system's documentation: P = RATE.R, Q = RATE.P; signs"),
            "{words}"
        );
    }
}
