//! Options that declare a value for a channel: its sign, unit, factor, amplitude, delay or column.

use std::collections::BTreeSet;

use gdcm_study::decisions::signs::SignRole;

/// Value that an option declares for a channel.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelValue<T> {
    pub channel: String,
    pub value: T,
}

impl<T> ChannelValue<T> {
    /// Parses `CHANNEL=VALUE`; `None` if the channel is empty or `parse` rejects the value.
    fn parse(text: &str, parse: impl FnOnce(&str) -> Option<T>) -> Option<Self> {
        let (channel, value) = text.split_once('=')?;
        let channel = channel.trim();
        if channel.is_empty() {
            return None;
        }
        Some(Self {
            channel: channel.to_owned(),
            value: parse(value.trim())?,
        })
    }
}

/// Returns the first channel that occurs in more than one declaration.
pub(super) fn first_duplicate<'a, T: 'a>(
    declarations: impl IntoIterator<Item = &'a ChannelValue<T>>,
) -> Option<&'a str> {
    let mut seen = BTreeSet::new();
    declarations
        .into_iter()
        .map(|declaration| declaration.channel.as_str())
        .find(|channel| !seen.insert(*channel))
}

/// Channel in a single record, written as "RECORD:CHANNEL".
pub(super) struct RecordChannel<'a> {
    pub(super) record: &'a str,
    pub(super) channel: &'a str,
}

impl<'a> RecordChannel<'a> {
    /// Parses "sweep.csv:P"; `None` for a channel in all records.
    pub(super) fn parse(text: &'a str) -> Option<Self> {
        let (record, channel) = text.rsplit_once(':')?;
        if record.is_empty() || channel.is_empty() {
            return None;
        }
        Some(Self { record, channel })
    }
}

/// Role whose models have the channel's sign inverted; `None` restores the sign in the files.
pub type ChannelSign = ChannelValue<Option<SignRole>>;

/// Parses a channel's sign: "NZ=-1", "NZ=-1:physics", "NZ=1".
pub(super) fn channel_sign(text: &str) -> Result<ChannelSign, String> {
    ChannelValue::parse(text, inverted_role).ok_or_else(|| {
        format!(
            "expected CHANNEL=-1, optionally followed by :identified, :physics or :all, or \
            CHANNEL=1; found \"{text}\""
        )
    })
}

/// Parses a sign and, after a colon, the role of the inverted models: "-1", "-1:physics", "1". The
/// inner `None` is a sign that is not inverted; the outer `None` an invalid text.
fn inverted_role(text: &str) -> Option<Option<SignRole>> {
    let (sign, role) = text
        .split_once(':')
        .unwrap_or((text, SignRole::Identified.word()));
    let sign = sign_factor(sign.trim())?;
    let role = SignRole::EACH
        .into_iter()
        .find(|known| known.word() == role.trim())?;
    Some(if sign < 0.0 { Some(role) } else { None })
}

/// Parses a sign: `-1` or `-`; `1`, `+1` or `+`.
pub(super) fn sign_factor(text: &str) -> Option<f64> {
    match text {
        "-1" | "-" => Some(-1.0),
        "1" | "+1" | "+" => Some(1.0),
        _ => None,
    }
}

/// Parses a finite factor other than 0.
pub(super) fn factor(text: &str) -> Option<f64> {
    let factor: f64 = text.parse().ok()?;
    if factor.is_finite() && factor != 0.0 {
        Some(factor)
    } else {
        None
    }
}

/// Returns a text unless it is empty.
pub(super) fn text_value(text: &str) -> Option<String> {
    if text.is_empty() {
        None
    } else {
        Some(text.to_owned())
    }
}

/// Parses a channel and its samples' unit: "P=rad/s".
pub(super) fn channel_unit(text: &str) -> Result<ChannelValue<String>, String> {
    ChannelValue::parse(text, text_value)
        .ok_or_else(|| format!("expected CHANNEL=UNIT, such as P=rad/s; found \"{text}\""))
}

/// Parses a channel and its samples' factor: "LON=25".
pub(super) fn channel_factor(text: &str) -> Result<ChannelValue<f64>, String> {
    ChannelValue::parse(text, factor).ok_or_else(|| {
        format!(
            "expected CHANNEL=X with a number X other than 0, such as LON=25 or NZ=-1; found \
            \"{text}\""
        )
    })
}

/// Parses an input and its sweeps' amplitude: "LON=5".
pub(super) fn channel_amplitude(text: &str) -> Result<ChannelValue<f64>, String> {
    ChannelValue::parse(text, |value| factor(value).filter(|value| *value > 0.0)).ok_or_else(|| {
        format!("expected INPUT=X with a positive number X, such as LON=5; found \"{text}\"")
    })
}

/// Parses a channel and the location of its samples: topic and field, or a column.
pub(super) fn channel_topic(text: &str) -> Result<ChannelValue<String>, String> {
    ChannelValue::parse(text, |column| text_value(column.trim_matches('"'))).ok_or_else(|| {
        format!(
            "expected CHANNEL=TOPIC.FIELD, such as P=vehicle_angular_velocity.xyz[0]; found \
            \"{text}\""
        )
    })
}

/// Parses a channel and its delay \[s\], positive if the channel is logged late.
pub(super) fn channel_delay(text: &str) -> Result<ChannelValue<f64>, String> {
    /// Maximum plausible delay \[s\] in a sensor or bus.
    const MOST_S: f64 = 2.0;
    let expected = || format!("expected CHANNEL=SECONDS, such as P=0.02; found \"{text}\"");
    let delay = ChannelValue::parse(text, |seconds| seconds.parse().ok()).ok_or_else(expected)?;
    if (-MOST_S..=MOST_S).contains(&delay.value) {
        Ok(delay)
    } else {
        Err(format!(
            "{}; a delay must be between -{MOST_S} and {MOST_S} s",
            expected()
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sign_names_its_channel_and_the_inverted_models() {
        let sign = |channel: &str, value| {
            Ok(ChannelSign {
                channel: channel.to_owned(),
                value,
            })
        };
        assert_eq!(
            channel_sign("NZ=-1"),
            sign("NZ", Some(SignRole::Identified))
        );
        assert_eq!(
            channel_sign("az (down)=-1:all"),
            sign("az (down)", Some(SignRole::All))
        );
        assert_eq!(channel_sign("NZ=1"), sign("NZ", None));
        for wrong in ["NZ", "NZ=-2", "NZ=-1:none", "=-1", " =1"] {
            assert!(channel_sign(wrong).is_err(), "{wrong}");
        }
        assert!(
            channel_sign("NZ=-2")
                .unwrap_err()
                .ends_with("found \"NZ=-2\"")
        );
    }

    #[test]
    fn a_unit_a_factor_or_a_topic_belongs_to_a_channel() {
        assert_eq!(channel_unit("P = rad/s").unwrap().value, "rad/s");
        assert_eq!(channel_factor("NZ=-1").unwrap().value, -1.0);
        for wrong in ["P", "P=", "=1"] {
            assert!(channel_unit(wrong).is_err(), "{wrong}");
        }
        for wrong in ["P", "P=x", "P=0", "P=NaN", "=1"] {
            assert!(channel_factor(wrong).is_err(), "{wrong}");
            assert!(channel_amplitude(wrong).is_err(), "{wrong}");
        }
        assert_eq!(channel_amplitude("LON=5").unwrap().value, 5.0);
        assert!(channel_amplitude("LON=-5").is_err());
        assert_eq!(
            channel_topic("P = a.b[0]"),
            Ok(ChannelValue {
                channel: "P".into(),
                value: "a.b[0]".into()
            })
        );
    }

    #[test]
    fn a_delay_belongs_to_a_channel_and_is_short() {
        assert_eq!(
            channel_delay("P=-0.02"),
            Ok(ChannelValue {
                channel: "P".into(),
                value: -0.02
            })
        );
        for wrong in ["P", "P=x", "P=20", "=0.1", "P=NaN"] {
            assert!(channel_delay(wrong).is_err(), "{wrong}");
        }
    }
}
