//! Channel aliases: spellings of helicopter inputs and outputs in files.

/// Aliases, one row per channel, as folded by [`folded_name`]; the first name in a row is
/// canonical. Each name appears once. "elevyoke1" and similar names are written by a flight
/// simulator.
const ALIASES: [&str; 16] = [
    "lon long longitudinal longcyc cyclong dlon deltalon dlong deltalong db deltab de deltae xb xlon b1s theta1s \
     pitchstick elevator loncyc lonstick longstick loncyclic cycliclon longitudinalcyclic longitudinalstick elevyoke1",
    "lat lateral latcyc cyclat dlat deltalat da deltaa xa xlat a1s theta1c rollstick aileron latstick latcyclic cycliclat \
     lateralcyclic lateralstick ailrnyoke1",
    "ped pedal pedals dped deltaped dp deltap dr deltar xp xped thetatr thetat rudder tailrotor yawpedal ruddryoke1",
    "col coll collective dcol deltacol dcoll dc deltac xc xcol theta0 theta0m",
    "p rollrate pb pbody omegax",
    "q pitchrate qb qbody omegay",
    "r yawrate rb rbody omegaz",
    "nx ax axb longitudinalacceleration longaccel accx gloadaxial",
    "ny ay ayb lateralacceleration lataccel accy gloadside",
    "nz az azb verticalacceleration vertaccel normalacceleration loadfactor accz gloadnorml",
    "u ub ubody forwardspeed",
    "v vb vbody sidewardspeed sidespeed",
    "w wb wbody heave verticalspeed heavevelocity",
    "phi roll rollangle rollattitude bank bankangle",
    "theta pitch pitchangle pitchattitude",
    "psi yaw heading yawangle",
];

/// Number of leading rows in [`ALIASES`] that list inputs; the other rows list outputs.
const INPUT_ROWS: usize = 4;

/// Folds a name: removes case, marks and blanks, and spells out Greek letters. "δ_a" becomes
/// "deltaa", "Sample_Time" becomes "sampletime".
pub fn folded_name(name: &str) -> String {
    let mut folded = String::with_capacity(name.len());
    for letter in name.chars().flat_map(char::to_lowercase) {
        match letter {
            'δ' | 'Δ' => folded.push_str("delta"),
            'θ' | 'ϑ' => folded.push_str("theta"),
            'φ' | 'ϕ' => folded.push_str("phi"),
            'ψ' => folded.push_str("psi"),
            'ω' => folded.push_str("omega"),
            letter if letter.is_alphanumeric() => folded.push(letter),
            _ => {}
        }
    }
    folded
}

/// Returns a channel's canonical name, or the folded name if it has no row in [`ALIASES`].
pub(super) fn canonical_name(name: &str) -> String {
    let folded = folded_name(name);
    let canonical = alias_row(&folded).and_then(|row| ALIASES[row].split(' ').next());
    match canonical {
        Some(canonical) => canonical.to_owned(),
        None => folded,
    }
}

/// Returns the index of the row in [`ALIASES`] that contains a folded name.
fn alias_row(folded: &str) -> Option<usize> {
    ALIASES
        .iter()
        .position(|row| row.split(' ').any(|alias| alias == folded))
}

/// Returns whether a name is listed among the inputs in [`ALIASES`].
pub(super) fn is_known_input(name: &str) -> bool {
    alias_row(&folded_name(name)).is_some_and(|row| row < INPUT_ROWS)
}

/// Returns whether a name is listed among the outputs in [`ALIASES`].
pub(super) fn is_known_output(name: &str) -> bool {
    alias_row(&folded_name(name)).is_some_and(|row| row >= INPUT_ROWS)
}

/// Returns whether two names denote the same channel: aliases, or equal apart from case and marks.
pub fn same_channel(a: &str, b: &str) -> bool {
    a == b || canonical_name(a) == canonical_name(b)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn aliases_denote_the_same_channel() {
        for (a, b) in [
            ("LAT", "δ_a"),
            ("lat", "Xa"),
            ("P", "roll rate"),
            ("q", "Pitch_Rate"),
            ("PED", "pedals"),
            ("NZ", "az"),
        ] {
            assert!(same_channel(a, b), "{a} {b}");
        }
        for (a, b) in [
            ("LON", "LAT"),
            ("P", "PED"),
            ("roll", "roll rate"),
            ("P", "Q"),
        ] {
            assert!(!same_channel(a, b), "{a} {b}");
        }
    }

    #[test]
    fn each_alias_is_folded_and_unique() {
        let names: Vec<&str> = ALIASES.iter().flat_map(|row| row.split(' ')).collect();
        let unique: BTreeSet<&str> = names.iter().copied().collect();
        assert_eq!(unique.len(), names.len());
        for name in names {
            assert_eq!(folded_name(name), name);
        }
    }
}
