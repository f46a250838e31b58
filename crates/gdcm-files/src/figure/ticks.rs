//! Where an axis has ticks, and what stands beside them.

use super::axis::{Axis, Range, Scale};

/// Where less than this is shown \[decades\], equal steps may be labelled instead of parts of a decade.
const LINEAR_BELOW: f64 = 0.9;
/// Degrees between ticks, from about one degree on; below, decimal steps.
const DEGREE_STEPS: [f64; 13] = [5.0, 10.0, 15.0, 30.0, 45.0, 60.0, 90.0, 180.0, 360.0, 720.0, 1800.0, 3600.0, 7200.0];

/// A place on an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    /// The value there.
    pub value: f64,
    /// The text beside it; none beside a minor tick.
    pub label: Option<String>,
}

/// How close the ticks of an axis may be \[pt\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TickGaps {
    /// From label to label.
    pub labels: f64,
    /// From label to label where equal steps take the place of parts of a decade.
    pub equal_steps: f64,
    /// From line to line of a decade.
    pub lines: f64,
}

/// From 9 to 10, the narrowest gap between the lines of a decade \[decades\].
const NINE_TO_TEN: f64 = 0.045_757_490_560_675_115;
/// Least distance between two labels where all nine of a decade have one \[pt\]: a row of many close numbers is hard to read.
const NINE_LABELS_GAP: f64 = 44.0;

/// The ticks of `axis` where `range` is shown on `length_pt`, with labels at least `gap_pt` apart.
pub(super) fn ticks(axis: &Axis, range: Range, length_pt: f64, gap_pt: f64) -> Vec<Tick> {
    if let Some(names) = &axis.names {
        let shown: Vec<_> = names.iter().filter(|(at, _)| range.contains(*at)).collect();
        let apart = length_pt / range.width();
        let every = (gap_pt / apart).ceil().max(1.0) as usize;
        return shown.into_iter().step_by(every).map(|(at, name)| labelled(*at, name.clone())).collect();
    }
    ticks_of(axis.scale, range, length_pt, TickGaps { labels: gap_pt, equal_steps: gap_pt, lines: 0.0 })
}

/// The ticks of an axis of numbers where `range` is shown on `length_pt`.
pub fn ticks_of(scale: Scale, range: Range, length_pt: f64, gaps: TickGaps) -> Vec<Tick> {
    let least = gaps.labels * range.width() / length_pt;
    match scale {
        Scale::Linear => equal_steps(range, step_above(least)),
        Scale::Degrees => equal_steps(range, degree_step(least)),
        Scale::Logarithmic => decades(range, length_pt, gaps),
    }
}

fn labelled(value: f64, label: String) -> Tick {
    Tick { value, label: Some(label) }
}

fn equal_steps(range: Range, step: f64) -> Vec<Tick> {
    let slack = 1e-6;
    let indices = (range.min / step - slack).ceil() as i64..=(range.max / step + slack).floor() as i64;
    indices.map(|k| k as f64 * step).map(|value| labelled(value, compact(value))).collect()
}

/// The least part of a turn \[deg\] that is not below `least`.
pub fn degree_step(least: f64) -> f64 {
    match DEGREE_STEPS.into_iter().find(|step| *step >= least) {
        Some(step) if least > 2.0 => step,
        _ => step_above(least),
    }
}

/// The least of 1, 2 and 5 times a power of ten that is not below `least`.
pub fn step_above(least: f64) -> f64 {
    if !(least > 0.0 && least.is_finite()) {
        return 1.0;
    }
    let power = 10f64.powf(least.log10().floor());
    // A step that is meant to be round may come in a rounding error above itself.
    let fits = |factor: f64| factor * power >= least * (1.0 - 1e-9);
    let factor = [1.0, 2.0, 5.0].into_iter().find(|factor| fits(*factor)).unwrap_or(10.0);
    factor * power
}

/// Ticks at 1 to 9 of each decade, labelled at 1, 2 and 5 or at the decades, whichever has room; of a small part of a decade, equal
/// steps.
fn decades(range: Range, length_pt: f64, gaps: TickGaps) -> Vec<Tick> {
    let (low, high) = (range.min.log10(), range.max.log10());
    let decade_pt = length_pt / (high - low);
    let has_two_and_five = decade_pt * 2f64.log10() >= gaps.labels;
    let has_nine = decade_pt * NINE_TO_TEN >= NINE_LABELS_GAP;
    let has_lines = decade_pt * NINE_TO_TEN >= gaps.lines;
    let every = (gaps.labels / decade_pt).ceil().max(1.0) as i64;
    let slack = 1e-9 * (1.0 + high - low);
    let is_labelled = |mantissa: u8, exponent: i64| match mantissa {
        1 => exponent.rem_euclid(every) == 0,
        2 | 5 => has_two_and_five,
        _ => has_nine,
    };
    let is_drawn = |mantissa: u8, exponent: i64| has_lines || mantissa == 1 || is_labelled(mantissa, exponent);
    let all = (low.floor() as i64..=high.floor() as i64)
        .flat_map(|exponent| (1..=9u8).map(move |mantissa| (mantissa, exponent)))
        .filter(|(mantissa, exponent)| is_drawn(*mantissa, *exponent))
        .map(|(mantissa, exponent)| (mantissa, exponent, f64::from(mantissa) * 10f64.powi(exponent as i32)))
        .filter(|(.., value)| (low - slack..=high + slack).contains(&value.log10()));
    let ticks: Vec<Tick> = all
        .map(|(mantissa, exponent, value)| Tick {
            value,
            label: is_labelled(mantissa, exponent).then(|| compact(value)),
        })
        .collect();
    let count = ticks.iter().filter(|tick| tick.label.is_some()).count();
    // The upper end is where equal steps are closest.
    let linear = equal_steps(range, step_above(gaps.equal_steps * range.max * std::f64::consts::LN_10 / decade_pt));
    if high - low < LINEAR_BELOW && linear.len() > count { linear } else { ticks }
}

/// The shortest text of `value` to six significant digits, without trailing zeros, with a true minus sign.
pub fn compact(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return if value == 0.0 { "0".to_owned() } else { value.to_string() };
    }
    let decimals = (5 - value.abs().log10().floor() as i64).clamp(0, 12) as usize;
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    signed(text)
}

/// `value` with so many decimals, with a true minus sign.
pub fn decimals(value: f64, count: usize) -> String {
    signed(&format!("{value:.count$}"))
}

/// A value that rounds to zero has no sign; a negative one has a minus sign, as wide as a plus, instead of a hyphen.
fn signed(text: &str) -> String {
    match text.strip_prefix('-') {
        Some(digits) if digits.chars().all(|c| matches!(c, '0' | '.')) => digits.to_owned(),
        Some(digits) => format!("\u{2212}{digits}"),
        None => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis, range: Range, length_pt: f64) -> Vec<String> {
        ticks(axis, range, length_pt, 14.0).into_iter().filter_map(|tick| tick.label).collect()
    }

    #[test]
    fn a_band_of_comparison_is_labelled_at_one_two_and_five() {
        let axis = Axis::logarithmic("Frequency [rad/s]");
        assert_eq!(labels(&axis, Range::new(0.3, 20.4), 130.0), ["0.5", "1", "2", "5", "10", "20"]);
        assert_eq!(labels(&axis, Range::new(0.3, 20.4), 60.0), ["1", "10"]);
        let minor = ticks(&axis, Range::new(1.0, 10.0), 60.0, 14.0).into_iter().filter(|tick| tick.label.is_none());
        assert_eq!(minor.count(), 6, "3, 4, 6, 7, 8 and 9");
    }

    #[test]
    fn a_small_part_of_a_decade_has_equal_steps() {
        let axis = Axis::logarithmic("Frequency [rad/s]");
        assert_eq!(labels(&axis, Range::new(1.9, 3.1), 130.0), ["2", "2.2", "2.4", "2.6", "2.8", "3"]);
    }

    #[test]
    fn phases_have_ticks_at_parts_of_a_turn_and_magnitudes_at_round_numbers() {
        assert_eq!(labels(&Axis::degrees(""), Range::new(-200.0, 10.0), 60.0), ["−180", "−120", "−60", "0"]);
        assert_eq!(labels(&Axis::linear(""), Range::new(-26.0, 10.0), 60.0), ["−20", "−10", "0", "10"]);
    }

    #[test]
    fn names_stand_at_their_places_and_are_thinned_where_they_have_no_room() {
        let axis = Axis::named("Condition", (1..=11).map(|id| id.to_string()));
        let range = axis.fitted(std::iter::empty());
        assert_eq!(labels(&axis, range, 160.0).len(), 11);
        assert_eq!(labels(&axis, range, 80.0), ["1", "3", "5", "7", "9", "11"]);
    }

    #[test]
    fn a_step_is_the_next_round_number() {
        for (least, step) in [(0.011, 0.02), (0.2, 0.2), (3.0, 5.0), (6.0, 10.0), (1e-7, 1e-7)] {
            assert!((step_above(least) / step - 1.0).abs() < 1e-9, "{least}: {}", step_above(least));
        }
        assert_eq!((degree_step(40.0), degree_step(1.5), degree_step(1e5)), (45.0, 2.0, 1e5));
    }
}

#[cfg(test)]
mod tests2 {
    use super::super::ticks::*;

    #[test]
    fn ticks_have_no_more_digits_than_they_need() {
        for (value, text) in [
            (0.3, "0.3"),
            (1.0 - 1e-12, "1"),
            (20.0, "20"),
            (-25.0, "\u{2212}25"),
            (0.0, "0"),
            (1.25, "1.25"),
            (100_000.0, "100000"),
        ] {
            assert_eq!(compact(value), text);
        }
    }

    #[test]
    fn what_rounds_to_zero_has_no_sign() {
        assert_eq!(decimals(-0.04, 1), "0.0");
        assert_eq!(decimals(-0.06, 1), "\u{2212}0.1");
    }
}
