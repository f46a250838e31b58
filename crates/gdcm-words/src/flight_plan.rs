//! The next flight in words: tables with predicted intervals, advice, and ways to a target.
//!
//! The plan predicts by how much further frequency sweeps of an input would narrow the 95 %
//! intervals of the identified model's responses (M14). *Advice* is about the responses that are
//! not identified; a *target* is an interval that the engineer wants in a response, and its *ways*
//! are the smallest changes to the sweeps that reach it.

use gdcm_model::dataset::Pair;
use gdcm_model::number_format::{counted, significant, telling};
use gdcm_sysid::identification::IdentificationCaution;
use gdcm_sysid::planning::flight_information::StandardSweep;
use gdcm_sysid::planning::flight_plan::SweepPlan;
use gdcm_sysid::planning::interval_target::{Need, TargetPlan};
use gdcm_sysid::planning::planned_sweep::PlannedSweep;
use gdcm_sysid::planning::sweep_advice::SweepAdvice;

use crate::table::Table;

/// Half-width \[dB\] above which an interval only says that the response is not identified: a
/// factor of ten.
const NOT_IDENTIFIED_DB: f64 = 20.0;

/// Decimals of intervals in advice \[dB\].
const ADVICE_DECIMALS: usize = 1;
/// Decimals of intervals beside a target \[dB\].
const TARGET_DECIMALS: usize = 2;

/// Names and units of the channels, for sentences about planned flights.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PlannedChannels {
    pub inputs: Vec<PlannedInput>,
    pub outputs: Vec<String>,
}

/// An input's name and unit.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PlannedInput {
    pub name: String,
    /// Empty if unknown.
    pub unit: String,
}

impl PlannedChannels {
    fn input(&self, index: usize) -> &str {
        self.inputs
            .get(index)
            .map_or("", |input| input.name.as_str())
    }

    /// Names a response: `PED → R`.
    pub fn response(&self, pair: Pair) -> String {
        let output = self.outputs.get(pair.output).map_or("", String::as_str);
        format!("{} → {output}", self.input(pair.input))
    }

    /// Returns an amplitude with its input's unit: `5.0 %`.
    fn amplitude(&self, input: usize, amplitude: f64) -> String {
        let unit = self
            .inputs
            .get(input)
            .map_or("", |input| input.unit.as_str());
        format!("{} {unit}", significant(amplitude))
            .trim_end()
            .to_owned()
    }

    /// Describes a sweep: `60 s sweep of PED (amplitude 5.0 %; 0.50 to 16 rad/s)`.
    pub fn sweep(&self, sweep: &StandardSweep) -> String {
        let PlannedSweep {
            input,
            amplitude,
            length_s,
            band: [first, last],
            ..
        } = sweep.sweep;
        let assumed = if sweep.is_assumed {
            ", assumed from the other inputs"
        } else {
            ""
        };
        format!(
            "{length_s:.0} s sweep of {} (amplitude {}{assumed}; {} to {} rad/s)",
            self.input(input),
            self.amplitude(input, amplitude),
            significant(first),
            significant(last)
        )
    }
}

/// Tabulates the 95 % intervals of the responses to an input: now, and predicted for each sweep
/// count.
pub fn sweep_plan_table(plan: &SweepPlan, channels: &PlannedChannels) -> Table {
    let omega = plan.responses.first().map_or(0.0, |first| first.omega);
    let title = format!(
        "{}: 95 % intervals in dB at {} rad/s",
        channels.sweep(&plan.sweep),
        significant(omega)
    );
    let mut headings = vec!["response".to_owned(), "now".to_owned()];
    for repeats in &plan.repeats {
        headings.push(format!("after {}", counted(*repeats, "sweep")));
    }
    let mut table = Table::new(title, headings);
    for response in &plan.responses {
        let mut cells = vec![
            channels.response(response.pair),
            interval_cell(response.now.half_db),
        ];
        for interval in &response.after {
            cells.push(interval_cell(interval.half_db));
        }
        table.row(cells);
    }
    table
}

/// Formats an interval for a table: `± 0.52`, or `not identified`.
fn interval_cell(half_db: f64) -> String {
    if half_db > NOT_IDENTIFIED_DB {
        "not identified".to_owned()
    } else {
        format!("± {}", telling(half_db, 2))
    }
}

/// Formats an interval for a sentence, with this many decimals: `± 0.7 dB`, or `more than ± 20 dB`.
fn interval_text(half_db: f64, decimals: usize) -> String {
    if half_db > NOT_IDENTIFIED_DB {
        format!("more than ± {NOT_IDENTIFIED_DB:.0} dB")
    } else {
        format!("± {} dB", telling(half_db, decimals))
    }
}

/// Returns a number from one to twelve as a word, any other in digits.
fn number_word(number: usize) -> String {
    const WORDS: [&str; 12] = [
        "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven",
        "twelve",
    ];
    match number.checked_sub(1).and_then(|place| WORDS.get(place)) {
        Some(word) => (*word).to_owned(),
        None => number.to_string(),
    }
}

/// Describes further sweeps of an input: `two more 60 s sweeps of PED`.
fn more_sweeps(sweep: &PlannedSweep, repeats: usize, channels: &PlannedChannels) -> String {
    let noun = if repeats == 1 { "sweep" } else { "sweeps" };
    format!(
        "{} more {:.0} s {noun} of {}",
        number_word(repeats),
        sweep.length_s,
        channels.input(sweep.input)
    )
}

/// Returns advice as a sentence: "two more 60 s sweeps of PED with an amplitude of 5.0 % bring PED
/// → R from ± 6.4 dB to ± 3.1 dB at 3.5 rad/s".
pub fn advice_text(advice: &SweepAdvice, channels: &PlannedChannels) -> String {
    let sweep = &advice.sweep.sweep;
    let amplitude = channels.amplitude(sweep.input, sweep.amplitude);
    let assumed = if advice.sweep.is_assumed {
        ", assumed from the other inputs,"
    } else {
        ""
    };
    let sweeps = more_sweeps(sweep, sweep.repeats, channels);
    let response = channels.response(advice.pair);
    let now = interval_text(advice.now.half_db, ADVICE_DECIMALS);
    let then = interval_text(advice.then.half_db, ADVICE_DECIMALS);
    let omega = significant(advice.omega);
    if advice.is_enough {
        let verb = if sweep.repeats == 1 {
            "brings"
        } else {
            "bring"
        };
        format!(
            "{sweeps} with an amplitude of {amplitude}{assumed} {verb} {response} from {now} to \
            {then} at {omega} rad/s"
        )
    } else {
        format!(
            "even {sweeps} with an amplitude of {amplitude}{assumed} would leave {response} at \
            {then} (now {now}) at {omega} rad/s"
        )
    }
}

/// Returns a caution; if it is about responses that are not identified, the advice follows.
pub fn caution_with_advice(
    caution: &IdentificationCaution,
    advice: &[SweepAdvice],
    channels: &PlannedChannels,
) -> String {
    let text = caution.to_string();
    if advice.is_empty() || !matches!(caution, IdentificationCaution::PairsNotIdentified(_)) {
        return text;
    }
    let sentences: Vec<String> = advice
        .iter()
        .map(|advice| advice_text(advice, channels))
        .collect();
    format!("{text}. Predicted: {}", sentences.join("; "))
}

/// Returns the ways to a target, as lines. If the target is already reached, a single line says so;
/// otherwise there are a heading, and a line each for more sweeps, a longer sweep, a larger
/// amplitude, and more sweeps over a narrow band. A last line is added if no number of such flights
/// reaches the target.
pub fn target_lines(plan: &TargetPlan, channels: &PlannedChannels) -> Vec<String> {
    let target = &plan.target;
    let wanted = format!(
        "{} within ± {} dB at {} rad/s",
        channels.response(target.pair),
        telling(target.half_db, 2),
        significant(target.omega)
    );
    let Some(ways) = &plan.ways else {
        return vec![format!(
            "{wanted}: already reached (± {} dB)",
            telling(plan.now.half_db, 2)
        )];
    };
    let sweep = &plan.sweep.sweep;
    let input = sweep.input;
    let now = interval_text(plan.now.half_db, TARGET_DECIMALS);
    let mut lines = vec![format!("{wanted}; now {now}. Alternatives:")];
    lines.push(need_line(&ways.repeats, |repeats| {
        more_sweeps(sweep, repeats, channels)
    }));
    lines.push(need_line(&ways.length_s, |length_s| {
        format!(
            "one more {length_s:.0} s sweep of {}",
            channels.input(input)
        )
    }));
    lines.push(need_line(&ways.amplitude, |amplitude| {
        format!(
            "one more {:.0} s sweep of {} with an amplitude of {}",
            sweep.length_s,
            channels.input(input),
            channels.amplitude(input, amplitude)
        )
    }));
    let [first, last] = ways.narrow_band.map(significant);
    lines.push(need_line(&ways.narrow_repeats, |repeats| {
        format!(
            "{} from {first} to {last} rad/s only",
            more_sweeps(sweep, repeats, channels)
        )
    }));
    if plan.limit.half_db > target.half_db {
        lines.push(format!(
            "no number of such flights is enough: gusts and noise fed back into the inputs leave \
            {}",
            interval_text(plan.limit.half_db, TARGET_DECIMALS)
        ));
    }
    lines
}

/// Returns a line on one way to reach the target interval: the flights needed, in the words of
/// `describe`, and the resulting interval; it begins with "not enough" if even the largest amount
/// misses the target.
fn need_line<T: Copy>(need: &Need<T>, describe: impl Fn(T) -> String) -> String {
    match *need {
        Need::Least { amount, half_db } => {
            format!(
                "{}: {}",
                describe(amount),
                interval_text(half_db, TARGET_DECIMALS)
            )
        }
        Need::NotWithin { most, half_db } => format!(
            "not enough: {} ({})",
            describe(most),
            interval_text(half_db, TARGET_DECIMALS)
        ),
    }
}

#[cfg(test)]
mod tests {
    use gdcm_model::dataset::channel::ChannelSide;
    use gdcm_model::simulation::Signal;
    use gdcm_sysid::planning::flight_plan::PlannedResponse;
    use gdcm_sysid::planning::flight_planner::ResponseInterval;
    use gdcm_sysid::planning::interval_target::{IntervalTarget, TargetWays};

    use super::*;

    fn channels() -> PlannedChannels {
        PlannedChannels {
            inputs: vec![PlannedInput {
                name: "PED".into(),
                unit: "%".into(),
            }],
            outputs: vec!["R".into()],
        }
    }

    fn interval(half_db: f64) -> ResponseInterval {
        ResponseInterval {
            half_db,
            half_deg: 6.6 * half_db,
        }
    }

    fn sweep(repeats: usize, is_assumed: bool) -> StandardSweep {
        StandardSweep {
            sweep: PlannedSweep {
                input: 0,
                amplitude: 5.0,
                length_s: 60.0,
                band: [0.5, 16.0],
                repeats,
            },
            is_assumed,
        }
    }

    fn advice(repeats: usize, is_enough: bool) -> SweepAdvice {
        SweepAdvice {
            sweep: sweep(repeats, false),
            pair: Pair::new(0, 0),
            omega: 3.46,
            now: interval(8.4),
            then: interval(4.2),
            is_enough,
        }
    }

    #[test]
    fn an_advice_names_the_sweeps_and_both_intervals() {
        assert_eq!(
            advice_text(&advice(2, true), &channels()),
            "two more 60 s sweeps of PED with an amplitude of 5.00 % bring PED → R from ± 8.4 dB to \
            ± 4.2 dB at 3.46 rad/s"
        );
        let even = advice_text(&advice(8, false), &channels());
        assert!(
            even.starts_with("even eight more 60 s sweeps of PED"),
            "{even}"
        );
    }

    #[test]
    fn only_the_caution_about_responses_that_are_not_identified_has_an_advice() {
        let signal = |role, name: &str| Signal {
            role,
            index: 0,
            name: name.into(),
        };
        let pairs = vec![[
            signal(ChannelSide::Output, "R"),
            signal(ChannelSide::Input, "PED"),
        ]];
        let caution = IdentificationCaution::PairsNotIdentified(pairs);
        let advised = caution_with_advice(&caution, &[advice(2, true)], &channels());
        assert!(advised.starts_with(&caution.to_string()) && advised.contains("two more"));
        assert_eq!(
            caution_with_advice(&caution, &[], &channels()),
            caution.to_string()
        );
        let other = IdentificationCaution::Reweighed(2.0);
        assert_eq!(
            caution_with_advice(&other, &[advice(2, true)], &channels()),
            other.to_string()
        );
    }

    #[test]
    fn a_table_has_a_column_for_each_number_of_sweeps() {
        let plan = SweepPlan {
            sweep: sweep(1, true),
            repeats: vec![1, 2],
            responses: vec![PlannedResponse {
                pair: Pair::new(0, 0),
                omega: 3.46,
                now: interval(30.0),
                after: vec![interval(1.414), interval(1.0)],
            }],
        };
        let table = sweep_plan_table(&plan, &channels());
        assert_eq!(
            table.columns,
            ["response", "now", "after 1 sweep", "after 2 sweeps"]
        );
        assert_eq!(
            table.rows,
            [["PED → R", "not identified", "± 1.41", "± 1.00"]]
        );
        assert!(table.title.contains("assumed"), "{}", table.title);
    }

    #[test]
    fn a_target_has_a_line_for_each_way() {
        let mut plan = TargetPlan {
            target: IntervalTarget {
                pair: Pair::new(0, 0),
                omega: 1.0,
                half_db: 0.5,
            },
            sweep: sweep(1, false),
            now: interval(1.4),
            limit: interval(0.6),
            ways: Some(TargetWays {
                repeats: Need::NotWithin {
                    most: 16,
                    half_db: 0.7,
                },
                length_s: Need::Least {
                    amount: 240.0,
                    half_db: 0.5,
                },
                amplitude: Need::Least {
                    amount: 12.0,
                    half_db: 0.5,
                },
                narrow_band: [0.5, 2.0],
                narrow_repeats: Need::Least {
                    amount: 2,
                    half_db: 0.48,
                },
            }),
        };
        let lines = target_lines(&plan, &channels());
        assert_eq!(lines.len(), 6, "{lines:?}");
        assert!(lines[1].starts_with("not enough: 16 more 60 s sweeps of PED"));
        assert!(lines[4].contains("0.500 to 2.00 rad/s only"), "{lines:?}");
        plan.limit = interval(0.0);
        assert_eq!(target_lines(&plan, &channels()).len(), 5);
        plan.ways = None;
        assert_eq!(target_lines(&plan, &channels()).len(), 1);
    }
}
