//! Clock times, with or without a date.

const DAY_S: f64 = 86_400.0;

/// Parses a clock time such as "12:30:01.25", "12:30:01,25", "2026-03-01 12:30:01.25" or
/// "2026-03-01T12:30:01.250Z". Returns the seconds since midnight or, with a date, since
/// 1970-01-01; `None` for any other text.
pub(super) fn clock_s(text: &str) -> Option<f64> {
    let text = text.trim().trim_end_matches('Z').trim();
    let (date, time) = match text.split_once(['T', ' ']) {
        Some((date, time)) => (Some(date), time.trim()),
        None => (None, text),
    };
    let mut parts = time.split(':');
    let hours = parts.next()?;
    let minutes = parts.next()?;
    let seconds = parts.next();
    if parts.next().is_some() {
        return None;
    }
    let hours = two_digits(hours, 24)?;
    let minutes = two_digits(minutes, 59)?;
    let seconds = match seconds {
        Some(text) if text.starts_with(|c: char| c.is_ascii_digit()) => {
            text.replace(',', ".").parse::<f64>().ok()?
        }
        Some(_) => return None,
        None => 0.0,
    };
    let day_s = match date {
        Some(date) => DAY_S * days(date)?,
        None => 0.0,
    };
    // Allow 60 s, which occurs during a leap second.
    if !(0.0..61.0).contains(&seconds) {
        return None;
    }
    // Hour 24 occurs only in 24:00, the end of a day.
    if hours == 24.0 && (minutes > 0.0 || seconds > 0.0) {
        return None;
    }
    Some(day_s + 3600.0 * hours + 60.0 * minutes + seconds)
}

/// Parses an integer with one or two digits, from 0 to `most`; `None` for any other text.
fn two_digits(text: &str, most: u32) -> Option<f64> {
    let is_digits =
        !text.is_empty() && text.len() <= 2 && text.bytes().all(|byte| byte.is_ascii_digit());
    if !is_digits {
        return None;
    }
    let value = text.parse::<u32>().ok()?;
    if value > most {
        return None;
    }
    Some(f64::from(value))
}

/// Returns the number of days from 1970-01-01 to a date "year-month-day" or "year/month/day".
fn days(date: &str) -> Option<f64> {
    let mut parts = date.split(['-', '/']).map(|part| part.parse::<i16>().ok());
    let year = parts.next()??;
    let month = parts.next()??;
    let day = parts.next()??;
    let date = jiff::civil::Date::new(year, month.try_into().ok()?, day.try_into().ok()?).ok()?;
    let since = date.since(jiff::civil::date(1970, 1, 1)).ok()?;
    Some(f64::from(since.get_days()))
}

#[cfg(test)]
mod clock_tests {
    use super::*;

    #[test]
    fn times_with_a_date_and_without_are_seconds() {
        assert_eq!(clock_s("12:30:01.25"), Some(45_001.25));
        assert_eq!(clock_s("00:00:00,5"), Some(0.5));
        assert_eq!(clock_s("24:00"), Some(86_400.0));
        // Reference value from `date -u -d "2026-03-01 12:30:01" +%s`.
        assert_eq!(clock_s("2026-03-01T12:30:01Z"), Some(1_772_368_201.0));
        assert_eq!(clock_s("2026/03/01 12:30:01"), Some(1_772_368_201.0));
        for wrong in [
            "12",
            "12:61:00",
            "24:00:01",
            "24:59:00",
            "a:b:c",
            "1:2:3:4",
            "12:30:nan",
            "2026-13-01 12:00:00",
            "",
        ] {
            assert_eq!(clock_s(wrong), None, "{wrong}");
        }
    }
}
