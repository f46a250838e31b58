//! Sign marks in channel names: `-az`, `az (down)`, `az[+down]`.

use super::channel_alias::folded_name;

/// Names for the acceleration along the z axis, which points down in some programs and up in
/// others.
const Z_ACCELERATION: [&str; 5] = ["az", "azb", "accz", "verticalacceleration", "vertaccel"];

/// Names for the load factor, which is positive up.
const LOAD_FACTOR: [&str; 4] = ["nz", "loadfactor", "normalacceleration", "gloadnorml"];

/// A channel name, separated from its sign marks.
#[derive(Clone, Debug, PartialEq)]
pub struct SignedName {
    /// Name without its sign marks.
    pub name: String,
    /// Whether a minus sign precedes the name.
    pub minus: bool,
    /// 1 if marked as positive up, right or forward, -1 if marked as the opposite; `None` without a
    /// mark.
    pub direction: Option<f64>,
}

/// A name, separated from the direction mark in brackets at its end.
struct MarkedName<'t> {
    name: &'t str,
    direction: Option<f64>,
}

impl SignedName {
    /// Separates a name from its sign marks.
    pub fn parse(text: &str) -> Self {
        let text = text.trim();
        let mut minus = false;
        let mut rest = text;
        if let Some(unsigned) = text.strip_prefix(['-', '\u{2212}']) {
            if begins_name(unsigned) {
                minus = true;
                rest = unsigned.trim_start();
            }
        } else if let Some(unsigned) = text.strip_prefix('+')
            && begins_name(unsigned)
        {
            rest = unsigned;
        }
        let marked = split_direction(rest);
        Self {
            name: marked.name.to_owned(),
            minus,
            direction: marked.direction,
        }
    }

    /// Returns the marked direction; without a mark, 1 for a load factor and `None` for other
    /// names.
    fn known_direction(&self) -> Option<f64> {
        match self.direction {
            Some(direction) => Some(direction),
            None if self.is_load_factor() => Some(1.0),
            None => None,
        }
    }

    fn is_load_factor(&self) -> bool {
        LOAD_FACTOR.contains(&folded_name(&self.name).as_str())
    }

    fn is_z_acceleration(&self) -> bool {
        Z_ACCELERATION.contains(&folded_name(&self.name).as_str())
    }
}

/// Returns whether the text after a sign is a name: a letter or "#", after optional blanks.
fn begins_name(rest: &str) -> bool {
    rest.trim_start()
        .starts_with(|letter: char| letter.is_alphabetic() || letter == '#')
}

/// Separates a direction mark in brackets from a name's end: "az (down)". A unit in brackets
/// remains in the name.
fn split_direction(text: &str) -> MarkedName<'_> {
    for (open, close) in [('(', ')'), ('[', ']'), ('{', '}')] {
        let inside = text.strip_suffix(close);
        let Some((name, mark)) = inside.and_then(|inside| inside.rsplit_once(open)) else {
            continue;
        };
        let direction = parse_direction(mark);
        if direction.is_some() && !name.trim().is_empty() {
            return MarkedName {
                name: name.trim(),
                direction,
            };
        }
    }
    MarkedName {
        name: text,
        direction: None,
    }
}

/// Parses a direction mark such as "down", "+down", "positive down", "-up": 1 for positive up,
/// right or forward, -1 for the opposite; `None` for other words.
pub fn parse_direction(mark: &str) -> Option<f64> {
    let mark = mark.trim().to_lowercase();
    let (sign, word) = match mark.strip_prefix(['-', '\u{2212}']) {
        Some(word) => (-1.0, word),
        None => (1.0, mark.trim_start_matches('+')),
    };
    let word = word
        .trim()
        .trim_start_matches("positive")
        .trim_start_matches("pos")
        .trim_start_matches(['.', ' ']);
    let word = word
        .trim_end_matches("positive")
        .trim_end_matches('+')
        .trim();
    match word {
        "up" | "right" | "forward" | "fwd" => Some(sign),
        "down" | "dn" | "left" | "aft" | "rearward" => Some(-sign),
        _ => None,
    }
}

/// Returns the factor, 1 or -1, that converts the sign of a file channel to that of a dataset
/// channel, given their names; `None` if the names do not determine it.
///
/// 1. Equal names have the same sign.
/// 2. If one name marks a direction, the direction of the other must be known; a load factor is
///    positive up.
/// 3. Without marked directions, a leading minus reverses the sign. If neither name has a minus, a
///    z acceleration and a load factor may differ in sign, and the factor is undetermined.
pub fn sign_between(file_name: &str, dataset_name: &str) -> Option<f64> {
    // Step 1
    if file_name.trim() == dataset_name.trim() {
        return Some(1.0);
    }
    let in_file = SignedName::parse(file_name);
    let in_dataset = SignedName::parse(dataset_name);
    let sign = if in_file.minus == in_dataset.minus {
        1.0
    } else {
        -1.0
    };
    // Step 2
    if in_file.direction.is_some() || in_dataset.direction.is_some() {
        return Some(sign * in_file.known_direction()? * in_dataset.known_direction()?);
    }
    // Step 3
    let has_minus = in_file.minus || in_dataset.minus;
    let may_differ = in_file.is_z_acceleration() && in_dataset.is_load_factor()
        || in_file.is_load_factor() && in_dataset.is_z_acceleration();
    if may_differ && !has_minus {
        None
    } else {
        Some(sign)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_in_names_give_the_sign() {
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
        assert_eq!(SignedName::parse("-az").name, "az");
        assert_eq!(
            SignedName::parse("az (g)").name,
            "az (g)",
            "a unit is no direction"
        );
    }
}
