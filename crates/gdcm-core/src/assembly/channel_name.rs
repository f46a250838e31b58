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

/// The directions that a name may say its channel is positive in, and those against them.
const DIRECTIONS: [(&str, f64); 9] = [
    ("up", 1.0),
    ("right", 1.0),
    ("forward", 1.0),
    ("fwd", 1.0),
    ("down", -1.0),
    ("dn", -1.0),
    ("left", -1.0),
    ("aft", -1.0),
    ("rearward", -1.0),
];
/// Names of the acceleration along the z axis by the axis, which points down in some programs and up in others; those of the load
/// factor, which is positive up.
const ALONG_Z: [&str; 5] = ["az", "azb", "accz", "verticalacceleration", "vertaccel"];
const LOAD_FACTOR: [&str; 4] = ["nz", "loadfactor", "normalacceleration", "gloadnorml"];

/// A name and the marks of its sign: `-az`, `az (down)`, `az[+down]`.
#[derive(Clone, Debug, PartialEq)]
pub struct SignedName {
    /// The name without the marks.
    pub name: String,
    /// Whether a minus stands before it.
    pub minus: bool,
    /// 1 where it is said to be positive up, right or forward, -1 where it is the other way round.
    pub direction: Option<f64>,
}

impl SignedName {
    /// Reads the marks of a name.
    pub fn of(text: &str) -> Self {
        let text = text.trim();
        let begins_name =
            |rest: &str| rest.trim_start().starts_with(|letter: char| letter.is_alphabetic() || letter == '#');
        let (minus, rest) = match text.strip_prefix(['-', '\u{2212}']).filter(|rest| begins_name(rest)) {
            Some(rest) => (true, rest.trim_start()),
            None => (false, text.strip_prefix('+').filter(|rest| begins_name(rest)).unwrap_or(text)),
        };
        let marked = [('(', ')'), ('[', ']'), ('{', '}')].into_iter().find_map(|(open, close)| {
            let (name, mark) = rest.strip_suffix(close)?.rsplit_once(open)?;
            Some((name.trim(), direction_of(mark)?))
        });
        let (name, direction) = match marked.filter(|(name, _)| !name.is_empty()) {
            Some((name, direction)) => (name, Some(direction)),
            None => (rest, None),
        };
        Self { name: name.to_owned(), minus, direction }
    }

    /// The direction that is said, or that the name stands for.
    fn known_direction(&self) -> Option<f64> {
        self.direction.or(LOAD_FACTOR.contains(&folded_name(&self.name).as_str()).then_some(1.0))
    }
}

/// What "down", "+down", "positive down", "-up" say: 1 where it is positive up, right or forward, -1 where it is the other way round.
pub fn direction_of(mark: &str) -> Option<f64> {
    let mark = mark.trim().to_lowercase();
    let (sign, word) = match mark.strip_prefix(['-', '\u{2212}']) {
        Some(word) => (-1.0, word),
        None => (1.0, mark.trim_start_matches('+')),
    };
    let word = word.trim().trim_start_matches("positive").trim_start_matches("pos").trim_start_matches(['.', ' ']);
    let word = word.trim_end_matches("positive").trim_end_matches('+').trim();
    DIRECTIONS.iter().find(|(known, _)| *known == word).map(|(_, direction)| sign * direction)
}

/// What the numbers of a channel that a file calls `label` are multiplied by to be those of a channel called `channel`: 1 or -1; none
/// where the names leave it open.
///
/// A minus is the sign. Where a direction is said, that of the other has to be known too: a load factor is positive up. `az` and `NZ`
/// are the same but for a sign that neither says.
pub fn sign_between(label: &str, channel: &str) -> Option<f64> {
    if label.trim() == channel.trim() {
        return Some(1.0);
    }
    let (of_label, of_channel) = (SignedName::of(label), SignedName::of(channel));
    let minus = if of_label.minus == of_channel.minus { 1.0 } else { -1.0 };
    match (of_label.direction, of_channel.direction) {
        (None, None) => {
            let family = |name: &SignedName| {
                let name = folded_name(&name.name);
                (ALONG_Z.contains(&name.as_str()), LOAD_FACTOR.contains(&name.as_str()))
            };
            let is_open =
                matches!((family(&of_label), family(&of_channel)), ((true, _), (_, true)) | ((_, true), (true, _)));
            (!is_open || of_label.minus || of_channel.minus).then_some(minus)
        }
        _ => Some(minus * of_label.known_direction()? * of_channel.known_direction()?),
    }
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
    fn a_mark_in_a_name_is_the_sign_and_is_never_dropped() {
        for (label, channel, sign) in [
            ("R", "R", Some(1.0)),
            ("-R", "R", Some(-1.0)),
            ("\u{2212}yaw rate", "R", Some(-1.0)),
            ("-az", "NZ", Some(-1.0)),
            ("az (down)", "NZ", Some(-1.0)),
            ("az[+down]", "NZ", Some(-1.0)),
            ("az (positive up)", "NZ", Some(1.0)),
            ("az [-up]", "NZ", Some(-1.0)),
            ("NZ", "nz", Some(1.0)),
            ("az", "NZ", None),
            ("w (down)", "W", None),
            ("w (down)", "W (up)", Some(-1.0)),
        ] {
            assert_eq!(sign_between(label, channel), sign, "{label} as {channel}");
        }
        assert_eq!(SignedName::of("-az").name, "az");
        assert_eq!(SignedName::of("az (g)").name, "az (g)", "a unit is no direction");
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
