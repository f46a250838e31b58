//! Names for time and sample time in files.

use crate::units::physical_unit::{Dimension, PhysicalUnit};

/// Usual names for the sample time, which is given in seconds.
pub const SAMPLE_TIME_NAMES: [&str; 7] = [
    "Ts",
    "dt",
    "tsam",
    "sample_time_s",
    "sample_time",
    "sampling_time",
    "Tsample",
];

/// Ranks a name by how likely it denotes a record's time stamps: 0 is the most likely, `None` if it
/// does not denote a time. A trailing time unit does not change the rank: `time_s`, `t [ms]`.
pub fn time_name_rank(name: &str) -> Option<u8> {
    let lower_case: Vec<String> = name
        .split(|letter: char| !letter.is_alphanumeric())
        .filter(|word| !word.is_empty())
        .map(str::to_lowercase)
        .collect();
    let mut words: Vec<&str> = lower_case.iter().map(String::as_str).collect();
    if words.len() > 1 && words.last().is_some_and(|word| is_time_unit(word)) {
        words.pop();
    }
    match words.concat().as_str() {
        "time" | "t" | "times" => Some(0),
        "tout" | "timestamp" | "timestamps" | "elapsed" | "seconds" | "tsec" | "timesec"
        | "zeit" | "temps" | "tempo" => Some(1),
        _ if words.contains(&"time") || words.contains(&"timestamp") => Some(2),
        _ => None,
    }
}

fn is_time_unit(word: &str) -> bool {
    PhysicalUnit::parse(word).is_some_and(|unit| unit.dimension == Dimension::Time)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_names_are_ranked_without_marks_and_unit() {
        let ranks = [
            ("t [ms]", 0),
            ("Time_s", 0),
            ("time_stamps", 1),
            ("t_out", 1),
            ("real,_time", 2),
        ];
        for (name, rank) in ranks {
            assert_eq!(time_name_rank(name), Some(rank), "{name}");
        }
        for name in ["theta", "Ts", "tail rotor"] {
            assert_eq!(time_name_rank(name), None, "{name}");
        }
    }
}
