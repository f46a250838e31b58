//! Names of channels, of the time and of the sample time, however files write them.

use super::{Dimension, PhysicalUnit};

/// Each channel with its other names, all folded (see [`folded_name`]); those such as "elevyoke1" are a flight simulator's. A name stands in one row only.
const ALIASES: [(&str, &str); 16] = [
    (
        "lon",
        "long longitudinal longcyc cyclong dlon deltalon dlong deltalong db deltab de deltae xb xlon b1s \
         theta1s pitchstick elevator loncyc longstick elevyoke1",
    ),
    (
        "lat",
        "lateral latcyc cyclat dlat deltalat da deltaa xa xlat a1s theta1c rollstick aileron latstick \
         ailrnyoke1",
    ),
    (
        "ped",
        "pedal pedals dped deltaped dp deltap dr deltar xp xped thetatr thetat rudder tailrotor yawpedal \
         ruddryoke1",
    ),
    ("col", "coll collective dcol deltacol dcoll dc deltac xc xcol theta0 theta0m"),
    ("p", "rollrate pb pbody omegax"),
    ("q", "pitchrate qb qbody omegay"),
    ("r", "yawrate rb rbody omegaz"),
    ("nx", "ax axb longitudinalacceleration longaccel accx gloadaxial"),
    ("ny", "ay ayb lateralacceleration lataccel accy gloadside"),
    ("nz", "az azb verticalacceleration vertaccel normalacceleration loadfactor accz gloadnorml"),
    ("u", "ub ubody forwardspeed"),
    ("v", "vb vbody sidewardspeed sidespeed"),
    ("w", "wb wbody heave verticalspeed heavevelocity"),
    ("phi", "roll rollangle rollattitude bank bankangle"),
    ("theta", "pitch pitchangle pitchattitude"),
    ("psi", "yaw heading yawangle"),
];

/// A name without case, marks and blanks, Greek letters spelt out: "δ_a" is "deltaa", "Sample_Time" is "sampletime".
pub fn folded_name(name: &str) -> String {
    let mut words = String::with_capacity(name.len());
    for letter in name.chars().flat_map(char::to_lowercase) {
        match letter {
            'δ' | 'Δ' => words.push_str("delta"),
            'θ' | 'ϑ' => words.push_str("theta"),
            'φ' | 'ϕ' => words.push_str("phi"),
            'ψ' => words.push_str("psi"),
            'ω' => words.push_str("omega"),
            letter if letter.is_alphanumeric() => words.push(letter),
            _ => {}
        }
    }
    words
}

/// The name that stands for all that call the same channel.
fn canonical(name: &str) -> String {
    let name = folded_name(name);
    let row = ALIASES.iter().find(|(first, others)| *first == name || others.split(' ').any(|other| other == name));
    row.map_or(name, |(first, _)| (*first).to_owned())
}

/// Whether two names call the same channel: the same but for case and marks, or names that the field uses for one another.
pub fn same_channel(a: &str, b: &str) -> bool {
    a == b || canonical(a) == canonical(b)
}

/// Names of the time between two samples \[s\], as they are usually written.
pub const SAMPLE_TIME_NAMES: [&str; 7] =
    ["Ts", "dt", "tsam", "sample_time_s", "sample_time", "sampling_time", "Tsample"];

/// How surely a name is that of the time of samples, 0 the surest; none where it is not. A unit of time at its end says nothing more:
/// `time_s`, `t [ms]`.
pub fn time_name_rank(name: &str) -> Option<u8> {
    let words: Vec<String> =
        name.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()).map(str::to_lowercase).collect();
    let mut words: Vec<&str> = words.iter().map(String::as_str).collect();
    let is_time = |unit: PhysicalUnit| unit.dimension == Dimension::Time;
    if words.len() > 1 && words.last().is_some_and(|word| PhysicalUnit::of(word).is_some_and(is_time)) {
        words.pop();
    }
    match words.concat().as_str() {
        "time" | "t" | "times" => Some(0),
        "tout" | "timestamp" | "timestamps" | "elapsed" | "seconds" | "tsec" | "timesec" | "zeit" | "temps"
        | "tempo" => Some(1),
        _ => words.iter().any(|word| matches!(*word, "time" | "timestamp")).then_some(2),
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_time_is_known_by_its_name_with_or_without_marks_and_unit() {
        let ranks = [("t [ms]", 0), ("Time_s", 0), ("time_stamps", 1), ("t_out", 1), ("real,_time", 2)];
        for (name, rank) in ranks {
            assert_eq!(time_name_rank(name), Some(rank), "{name}");
        }
        assert!(["theta", "Ts", "tail rotor"].iter().all(|name| time_name_rank(name).is_none()));
    }

    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn the_names_of_the_field_are_one_another() {
        for (a, b) in
            [("LAT", "δ_a"), ("lat", "Xa"), ("P", "roll rate"), ("q", "Pitch_Rate"), ("PED", "pedals"), ("NZ", "az")]
        {
            assert!(same_channel(a, b), "{a} {b}");
        }
        for (a, b) in [("LON", "LAT"), ("P", "PED"), ("roll", "roll rate"), ("P", "Q")] {
            assert!(!same_channel(a, b), "{a} {b}");
        }
    }

    #[test]
    fn no_name_stands_for_two_channels() {
        let names: Vec<&str> =
            ALIASES.iter().flat_map(|(first, others)| std::iter::once(*first).chain(others.split(' '))).collect();
        let unique: BTreeSet<&str> = names.iter().copied().collect();
        assert_eq!(unique.len(), names.len());
        assert!(names.iter().all(|name| folded_name(name) == **name), "they are folded");
    }
}
