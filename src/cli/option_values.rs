//! Option values: numbers, named values, responses, rejected models and parts of records.

use clap::builder::{PossibleValuesParser, TypedValueParser};

use gdcm_model::units::number;

/// Returns a parser that accepts the names of `values`.
pub(super) fn one_of<T, const N: usize>(
    values: [T; N],
    name: fn(T) -> &'static str,
) -> impl TypedValueParser<Value = T>
where
    T: Copy + Send + Sync + 'static,
{
    PossibleValuesParser::new(values.map(name)).try_map(move |word: String| {
        values
            .into_iter()
            .find(|value| name(*value) == word)
            .ok_or("no such value")
    })
}

pub(super) fn real_number(text: &str) -> Result<f64, String> {
    text.trim()
        .parse()
        .map_err(|_| format!("expected a number, found \"{text}\""))
}

pub(super) fn whole_number<const LEAST: usize, const MOST: usize>(
    text: &str,
) -> Result<usize, String> {
    match text.trim().parse::<usize>() {
        Ok(number) if (LEAST..=MOST).contains(&number) => Ok(number),
        _ => Err(format!(
            "expected a whole number from {LEAST} to {MOST}, found \"{text}\""
        )),
    }
}

/// Parses a sample rate \[Hz\].
pub(super) fn positive_rate(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(rate) if rate.is_finite() && rate > 0.0 => Ok(rate),
        _ => Err(format!(
            "expected a positive number of samples per second, found \"{text}\""
        )),
    }
}

/// Parses a finite number above 0.
pub(super) fn positive_number(text: &str) -> Result<f64, String> {
    match finite_number(text.trim()) {
        Some(number) if number > 0.0 => Ok(number),
        _ => Err(format!("expected a positive number, found \"{text}\"")),
    }
}

/// Airspeeds \[kt\] for a lookup table, increasing.
pub type Breakpoints = Vec<f64>;

pub(super) fn breakpoints(text: &str) -> Result<Breakpoints, String> {
    let airspeeds_kt = text
        .split(',')
        .map(real_number)
        .collect::<Result<Breakpoints, _>>()?;
    let rises = airspeeds_kt.windows(2).all(|pair| pair[0] < pair[1]);
    let is_finite = airspeeds_kt.iter().all(|airspeed| airspeed.is_finite());
    if rises && is_finite {
        Ok(airspeeds_kt)
    } else {
        Err(format!(
            "expected increasing airspeeds, such as 40,60,80; found {text}"
        ))
    }
}

/// A response, given by its channels' names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PairName {
    pub output: String,
    pub input: String,
}

/// Several responses. The alias is necessary because clap would take a `Vec` for an option that can
/// be repeated.
pub type PairList = Vec<PairName>;

/// Parses "P/LAT,Q/LON", or "none".
pub(super) fn pair_list(text: &str) -> Result<PairList, String> {
    if text == "none" {
        Ok(Vec::new())
    } else {
        text.split(',').map(pair_name).collect()
    }
}

pub(super) fn pair_name(text: &str) -> Result<PairName, String> {
    match text.trim().split_once('/') {
        Some((output, input)) if !output.is_empty() && !input.is_empty() => Ok(PairName {
            output: output.to_owned(),
            input: input.to_owned(),
        }),
        _ => Err(format!(
            "expected OUTPUT/INPUT, such as P/LAT; found \"{text}\""
        )),
    }
}

/// Responses chosen for a figure.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PairChoice {
    OnAxis,
    OffAxis,
    All,
    Listed(PairList),
}

pub(super) fn pair_choice(text: &str) -> Result<PairChoice, String> {
    Ok(match text {
        "on-axis" => PairChoice::OnAxis,
        "off-axis" => PairChoice::OffAxis,
        "all" => PairChoice::All,
        list => PairChoice::Listed(pair_list(list)?),
    })
}

/// A rejected model.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rejection {
    /// Id of the model's condition.
    pub condition: i64,
    pub model: String,
}

pub(super) fn rejection(text: &str) -> Result<Rejection, String> {
    let expected = || format!("expected ID:NAME, such as 10:nominal; found \"{text}\"");
    let (id, model) = text.split_once(':').ok_or_else(expected)?;
    Ok(Rejection {
        condition: id.trim().parse().map_err(|_| expected())?,
        model: model.to_owned(),
    })
}

/// A part of a record, selected by time.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordPart {
    /// Record name; `None` selects all records with samples at these times.
    pub record: Option<String>,
    /// First and last time \[s\].
    pub part_s: [f64; 2],
    /// Whether the times count from the record's first sample; otherwise they are on its time axis.
    pub is_from_start: bool,
}

impl RecordPart {
    /// Returns the first and last time \[s\] on the record's time axis, whose first sample is at
    /// `start_s`.
    pub(super) fn on_clock_s(&self, start_s: f64) -> [f64; 2] {
        if self.is_from_start {
            self.part_s.map(|time_s| start_s + time_s)
        } else {
            self.part_s
        }
    }

    /// Formats the times as on the command line: `5:34`, `+5:+34`.
    pub(super) fn words(&self) -> String {
        let sign = if self.is_from_start { "+" } else { "" };
        let [from, to] = self.part_s.map(number);
        format!("{sign}{from}:{sign}{to}")
    }
}

/// Parses "29:58" on the record's time axis, "+5:+34" from its first sample, or either after
/// "RECORD:".
pub(super) fn record_part(text: &str) -> Result<RecordPart, String> {
    valid_part(text).ok_or_else(|| {
        format!(
            "expected A:B, such as 29:58, or +A:+B from the start of a record, or RECORD:A:B, \
            with A less than B; found \"{text}\""
        )
    })
}

/// Parses a part from its end: the last two fields are the times, the rest is the record, whose
/// name may contain colons. Both times have a plus sign, or neither.
fn valid_part(text: &str) -> Option<RecordPart> {
    let (rest, to) = text.rsplit_once(':')?;
    let (record, from) = match rest.rsplit_once(':') {
        Some((record, from)) => (Some(record.trim()), from),
        None => (None, rest),
    };
    let [from, to] = [from, to].map(str::trim);
    let part_s = [finite_number(from)?, finite_number(to)?];
    let is_from_start = from.starts_with('+');
    if part_s[0] >= part_s[1] || record == Some("") || is_from_start != to.starts_with('+') {
        return None;
    }
    Some(RecordPart {
        record: record.map(ToOwned::to_owned),
        part_s,
        is_from_start,
    })
}

fn finite_number(text: &str) -> Option<f64> {
    text.parse::<f64>().ok().filter(|number| number.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_name_may_hold_a_colon() {
        let found = rejection("10:V+5kt: again").unwrap();
        assert_eq!(
            (found.condition, found.model.as_str()),
            (10, "V+5kt: again")
        );
        assert!(rejection("nominal").is_err() && rejection("x:nominal").is_err());
    }

    #[test]
    fn breakpoints_rise() {
        assert_eq!(breakpoints("40, 60,80.5"), Ok(vec![40.0, 60.0, 80.5]));
        for wrong in ["60,40", "40,40", "40,NaN", ""] {
            assert!(breakpoints(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn pairs_are_written_output_first() {
        let pair = |output: &str, input: &str| PairName {
            output: output.to_owned(),
            input: input.to_owned(),
        };
        let list = pair_list("P/LAT, Q/LON").unwrap();
        assert_eq!(list, [pair("P", "LAT"), pair("Q", "LON")]);
        assert!(pair_list("P-LAT").is_err() && pair_list("").is_err());
        assert!(pair_list("none").unwrap().is_empty());
    }

    fn part(record: Option<&str>, part_s: [f64; 2], is_from_start: bool) -> RecordPart {
        RecordPart {
            record: record.map(str::to_owned),
            part_s,
            is_from_start,
        }
    }

    #[test]
    fn a_part_belongs_to_all_records_or_to_a_named_record() {
        assert_eq!(record_part("29:58"), Ok(part(None, [29.0, 58.0], false)));
        assert_eq!(
            record_part("log:1:-1:5"),
            Ok(part(Some("log:1"), [-1.0, 5.0], false))
        );
        let from_start = part(Some("prbs"), [5.0, 34.0], true);
        assert_eq!(record_part("prbs: +5 : +34"), Ok(from_start));
        assert_eq!(
            record_part("+5:+34").unwrap().on_clock_s(42.3),
            [47.3, 76.3]
        );
        for wrong in [
            "29", "58:29", "5:5", ":1:2", "a:b", "0:inf", "+5:34", "5:+34", "++5:+34", "+5:-34",
        ] {
            assert!(record_part(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_positive_number_is_finite() {
        assert_eq!(positive_number(" 0.5 "), Ok(0.5));
        for wrong in ["0", "-1", "inf", "x", ""] {
            assert!(positive_number(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_rate_is_positive() {
        assert_eq!(positive_rate("50"), Ok(50.0));
        for wrong in ["0", "-1", "x"] {
            assert!(positive_rate(wrong).is_err(), "{wrong}");
        }
    }
}
