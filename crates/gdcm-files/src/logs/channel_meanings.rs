//! What the columns of each system's logs are, by its documentation.

use gdcm_core::records::RecordColumn;

/// A column of a system's logs: its name, the channel that it is, its unit.
type Meaning = (&'static str, &'static str, &'static str);

/// What the columns of a system's logs are: for each channel the first that is there and moves.
pub(super) struct Meanings {
    columns: &'static [Meaning],
    /// What is to be known of their signs.
    signs: &'static str,
}

/// PX4: `VehicleTorqueSetpoint.msg`, `VehicleThrustSetpoint.msg` (normalised, body axes), `VehicleAngularVelocity.msg` \[rad/s\],
/// `VehicleAcceleration.msg` \[m/s²\]; before 1.14 `ActuatorControls.msg` (<https://docs.px4.io/main/en/msg_docs/>).
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

/// ArduPilot: `SIDD` of the system identification mode, `RATE`, `IMU` (<https://ardupilot.org/copter/docs/logmessages.html>). What `R`,
/// `P` and `Y` are there are roll, pitch and yaw; `…Out` goes to the motors, from -1 to 1 (`AOut` from 0 to 1).
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

/// Betaflight and its kin: what the blackbox calls its fields; `axisSum` is the sum of the terms of the controller, which goes to the
/// mixer (<https://betaflight.com/docs/development/Blackbox>).
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

/// Gives columns the channel and the unit that they have by the documentation; says what was given.
pub(super) fn give_meanings(columns: &mut [RecordColumn], meanings: &Meanings) -> Option<String> {
    let mut given: Vec<(&str, &str)> = Vec::new();
    for &(name, channel, unit) in meanings.columns {
        let moves = |column: &&mut RecordColumn| column.range().is_some_and(|(least, most)| least < most);
        let Some(column) = columns.iter_mut().find(|column| column.name == name) else { continue };
        if column.unit.is_none() {
            column.unit = Some(unit.to_owned()).filter(|unit| !unit.is_empty());
        }
        if Some(&mut *column).as_ref().is_some_and(moves) && given.iter().all(|(taken, _)| *taken != channel) {
            column.meaning = Some(channel);
            given.push((channel, name));
        }
    }
    if given.is_empty() {
        return None;
    }
    let words: Vec<String> = given.iter().map(|(channel, name)| format!("{channel} = {name}")).collect();
    Some(format!("by the system's documentation: {}; {}", words.join(", "), meanings.signs))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_channel_is_the_first_column_that_is_there_and_moves() {
        let moving = vec![0.0, 1.0, 2.0];
        let mut columns = vec![
            RecordColumn::new("RATE.P", moving.clone()),
            RecordColumn::new("RATE.R", moving.clone()),
            RecordColumn::new("SIDD.Gx", vec![1.0; 3]),
            RecordColumn { unit: Some("deg".into()), ..RecordColumn::new("IMU.GyrY", moving) },
        ];
        let words = give_meanings(&mut columns, &ARDUPILOT).unwrap();
        let found: Vec<_> = columns.iter().map(|column| column.meaning).collect();
        assert_eq!(found, [Some("Q"), Some("P"), None, None], "{words}");
        assert_eq!(columns[3].unit.as_deref(), Some("deg"), "what the file says stays");
        assert!(words.starts_with("by the system's documentation: P = RATE.R, Q = RATE.P; signs"), "{words}");
    }
}
