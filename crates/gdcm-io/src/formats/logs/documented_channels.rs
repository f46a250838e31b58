//! Channels and units for logged columns, according to each logging system's documentation.
//!
//! The channels are the controls LAT, LON, PED and COL (lateral, longitudinal, pedals, collective),
//! the rates P, Q and R, the accelerations NX, NY and NZ, the attitudes PHI and THETA, and TARG,
//! the input of ArduPilot's system identification mode.

use crate::formats::reading_note::{ChannelAssignment, ReadingNote};
use gdcm_sysid::records::RecordColumn;

/// A column whose channel and unit are documented.
struct DocumentedColumn {
    name: &'static str,
    /// Usual name of the channel, by which columns are assigned to a dataset's channels.
    channel: &'static str,
    /// Unit; empty if the documentation gives none.
    unit: &'static str,
}

const fn documented(
    name: &'static str,
    channel: &'static str,
    unit: &'static str,
) -> DocumentedColumn {
    DocumentedColumn {
        name,
        channel,
        unit,
    }
}

/// Documented columns in one system's logs. If several columns measure a channel, the first in this
/// list that is present and varies is used.
pub(super) struct Meanings {
    columns: &'static [DocumentedColumn],
    /// Note for the user about sign conventions.
    signs: &'static str,
}

/// PX4: `VehicleTorqueSetpoint.msg`, `VehicleThrustSetpoint.msg` (normalised, body axes),
/// `VehicleAngularVelocity.msg` \[rad/s\], `VehicleAcceleration.msg` \[m/s²\]; before 1.14
/// `ActuatorControls.msg` (<https://docs.px4.io/main/en/msg_docs/>).
pub(super) const PX4: Meanings = Meanings {
    columns: &[
        documented("vehicle_torque_setpoint.xyz[0]", "LAT", "1"),
        documented("vehicle_torque_setpoint.xyz[1]", "LON", "1"),
        documented("vehicle_torque_setpoint.xyz[2]", "PED", "1"),
        documented("vehicle_thrust_setpoint.xyz[2]", "COL", "1"),
        documented("actuator_controls_0.control[0]", "LAT", "1"),
        documented("actuator_controls_0.control[1]", "LON", "1"),
        documented("actuator_controls_0.control[2]", "PED", "1"),
        documented("actuator_controls_0.control[3]", "COL", "1"),
        documented("vehicle_angular_velocity.xyz[0]", "P", "rad/s"),
        documented("vehicle_angular_velocity.xyz[1]", "Q", "rad/s"),
        documented("vehicle_angular_velocity.xyz[2]", "R", "rad/s"),
        documented("sensor_combined.gyro_rad[0]", "P", "rad/s"),
        documented("sensor_combined.gyro_rad[1]", "Q", "rad/s"),
        documented("sensor_combined.gyro_rad[2]", "R", "rad/s"),
        documented("vehicle_acceleration.xyz[0]", "NX", "m/s^2"),
        documented("vehicle_acceleration.xyz[1]", "NY", "m/s^2"),
        documented("vehicle_acceleration.xyz[2]", "NZ", "m/s^2"),
        documented("sensor_combined.accelerometer_m_s2[0]", "NX", "m/s^2"),
        documented("sensor_combined.accelerometer_m_s2[1]", "NY", "m/s^2"),
        documented("sensor_combined.accelerometer_m_s2[2]", "NZ", "m/s^2"),
    ],
    signs: "signs follow PX4's convention: body axes forward, right and down, so that thrust and \
        acceleration along z are negative upwards (give COL=-COLUMN to reverse a sign)",
};

/// ArduPilot messages: `SIDD` (system identification mode), `RATE` (rate controllers), `IMU`
/// (inertial measurement unit) and `ATT` (attitude)
/// (<https://ardupilot.org/copter/docs/logmessages.html>). In `RATE`, `R`, `P` and `Y` are roll,
/// pitch and yaw; `…Out` goes to the motors, from -1 to 1 (`AOut` from 0 to 1).
pub(super) const ARDUPILOT: Meanings = Meanings {
    columns: &[
        documented("RATE.ROut", "LAT", "1"),
        documented("RATE.POut", "LON", "1"),
        documented("RATE.YOut", "PED", "1"),
        documented("RATE.AOut", "COL", "1"),
        documented("SIDD.Gx", "P", "deg/s"),
        documented("SIDD.Gy", "Q", "deg/s"),
        documented("SIDD.Gz", "R", "deg/s"),
        documented("SIDD.Ax", "NX", "m/s^2"),
        documented("SIDD.Ay", "NY", "m/s^2"),
        documented("SIDD.Az", "NZ", "m/s^2"),
        documented("SIDD.Targ", "TARG", ""),
        documented("RATE.R", "P", "deg/s"),
        documented("RATE.P", "Q", "deg/s"),
        documented("RATE.Y", "R", "deg/s"),
        documented("IMU.GyrX", "P", "rad/s"),
        documented("IMU.GyrY", "Q", "rad/s"),
        documented("IMU.GyrZ", "R", "rad/s"),
        documented("IMU.AccX", "NX", "m/s^2"),
        documented("IMU.AccY", "NY", "m/s^2"),
        documented("IMU.AccZ", "NZ", "m/s^2"),
        documented("ATT.Roll", "PHI", "deg"),
        documented("ATT.Pitch", "THETA", "deg"),
    ],
    signs: "signs follow ArduPilot's convention: body axes forward, right and down, so that the \
        acceleration along z is negative upwards (give NZ=-COLUMN to reverse a sign)",
};

/// Betaflight and relatives: blackbox field names; `axisSum` is the sum of the controller terms,
/// which enters the mixer (<https://betaflight.com/docs/development/Blackbox>).
pub(super) const BETAFLIGHT: Meanings = Meanings {
    columns: &[
        documented("axisSum[0]", "LAT", ""),
        documented("axisSum[1]", "LON", ""),
        documented("axisSum[2]", "PED", ""),
        documented("rcCommand[3]", "COL", ""),
        documented("gyroADC[0]", "P", "deg/s"),
        documented("gyroADC[1]", "Q", "deg/s"),
        documented("gyroADC[2]", "R", "deg/s"),
    ],
    signs: "signs follow the flight controller's convention: check the sign of each channel in a \
        manoeuvre of known direction",
};

/// Assigns the documented channels and units to columns: the unit to every documented column that
/// has none, each channel only to the first of its columns that varies. Returns a note that lists
/// the assigned channels; `None` if there are none.
pub(super) fn assign_documented_meanings(
    columns: &mut [RecordColumn],
    meanings: &Meanings,
) -> Option<ReadingNote> {
    let mut channels: Vec<&str> = Vec::new();
    let mut assignments: Vec<ChannelAssignment> = Vec::new();
    for documented in meanings.columns {
        let DocumentedColumn {
            name,
            channel,
            unit,
        } = *documented;
        let Some(column) = columns.iter_mut().find(|column| column.name == name) else {
            continue;
        };
        if column.unit.is_none() && !unit.is_empty() {
            column.unit = Some(unit.to_owned());
        }
        if varies(column) && !channels.contains(&channel) {
            column.meaning = Some(channel);
            channels.push(channel);
            assignments.push(ChannelAssignment {
                channel,
                column: name,
            });
        }
    }
    if assignments.is_empty() {
        return None;
    }
    Some(ReadingNote::DocumentedChannels {
        assignments,
        signs: meanings.signs,
    })
}

/// Returns whether a column has at least two different values.
fn varies(column: &RecordColumn) -> bool {
    column.range().is_some_and(|(least, most)| least < most)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_channel_is_the_first_column_that_is_present_and_varies() {
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
        let note = assign_documented_meanings(&mut columns, &ARDUPILOT).unwrap();
        let found: Vec<_> = columns.iter().map(|column| column.meaning).collect();
        assert_eq!(found, [Some("Q"), Some("P"), None, None], "{note}");
        assert_eq!(
            columns[3].unit.as_deref(),
            Some("deg"),
            "the unit in the file is kept"
        );
        let ReadingNote::DocumentedChannels { assignments, .. } = note else {
            panic!("{note:?}")
        };
        let assignments: Vec<String> = assignments.iter().map(ToString::to_string).collect();
        assert_eq!(assignments, ["P = RATE.R", "Q = RATE.P"]);
    }
}
