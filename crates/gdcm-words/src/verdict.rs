//! The verdict on the constrained responses, in words short enough for the narrowest window. The
//! window, the printed summary and the report use the same words.
//!
//! A response is *held* if it is constrained, and *matched* if its channels give it the G (eq. (5))
//! or the D (eq. (9)) that it needs. J is the mismatch cost (M4).

use gdcm_model::dataset::{ConditionId, Dataset};
use gdcm_model::number_format::{NO_VALUE, counted, with_minus_sign};
use gdcm_model::units::{number, six_digits, telling, told_apart};
use gdcm_study::results::verdict::{GainVerdict, MatchCount, MeanCost, PhaseVerdict, RemainingLag};
use gdcm_study::{Analysis, ConditionAnalysis, PhaseCorrection, Study};

use crate::caution::failure_text;
use crate::table::Table;

/// Returns the verdict on the gains: "matched", "LAT → P stops at a bound", "2 responses share
/// PED", "3 responses disagree".
pub fn gain_verdict_text(verdict: GainVerdict, dataset: &Dataset) -> String {
    match verdict {
        GainVerdict::NoneHeld => "fitted, none held".to_owned(),
        GainVerdict::Matched => "matched".to_owned(),
        GainVerdict::StopsAtBound { pair } => {
            format!("{} stops at a bound", unbroken(&dataset.pair_name(pair)))
        }
        GainVerdict::SharedChannel { unmatched, channel } => {
            format!("{unmatched} responses share {}", channel.name_in(dataset))
        }
        GainVerdict::Disagree { entries } => format!("{entries} responses disagree"),
    }
}

/// Returns the verdict on the phases: "matched, 0.5–12 rad/s", "lags by ≈ 66 ms".
pub fn phase_verdict_text(verdict: PhaseVerdict, study: &Study) -> String {
    match verdict {
        PhaseVerdict::NotCorrected => "not corrected".to_owned(),
        PhaseVerdict::NoneHeld => "fitted, none held".to_owned(),
        PhaseVerdict::Matched => format!("matched, {}", band_text(study)),
        PhaseVerdict::LagRemains(lag) => remaining_lag_text(lag),
    }
}

/// Formats a study's band: "0.5–12 rad/s".
pub fn band_text(study: &Study) -> String {
    let band = study.settings.band;
    format!(
        "{}–{} rad/s",
        six_digits(band.min()),
        six_digits(band.max())
    )
}

/// Formats a count: "5 of 5".
pub fn match_count_text(count: MatchCount) -> String {
    format!("{} of {}", count.matched, count.held)
}

/// Replaces the spaces in a name by no-break spaces, so that it is not split at a line end.
pub fn unbroken(name: &str) -> String {
    name.replace(' ', "\u{a0}")
}

/// Describes the lag, which is a lead if negative: "lags by ≈ 66 ms", "lags 20–110 ms", "lags −5 to
/// 60 ms".
fn remaining_lag_text(lag: RemainingLag) -> String {
    match lag {
        RemainingLag::Equal(lag_ms) => {
            format!("{} by {} ms", lag_verb(lag_ms), lag_number(lag_ms.abs()))
        }
        RemainingLag::AboutEqual(lag_ms) => {
            format!("{} by ≈ {} ms", lag_verb(lag_ms), lag_number(lag_ms.abs()))
        }
        RemainingLag::Range([first_ms, last_ms]) => {
            // A range of leads begins with the lag nearest to zero.
            let leads = first_ms > last_ms;
            let verb = if leads { "leads" } else { "lags" };
            let sign = if leads { -1.0 } else { 1.0 };
            // "-5–60" would look like two minus signs.
            let to = if first_ms * last_ms < 0.0 {
                " to "
            } else {
                "–"
            };
            format!(
                "{verb} {}{to}{} ms",
                lag_number(sign * first_ms),
                lag_number(sign * last_ms)
            )
        }
    }
}

fn lag_verb(lag_ms: f64) -> &'static str {
    if lag_ms >= 0.0 { "lags" } else { "leads" }
}

/// Formats a lag in whole milliseconds, with a minus sign.
fn lag_number(lag_ms: f64) -> String {
    with_minus_sign(&telling(lag_ms, 0))
}

/// Returns the verdict on a whole study: "gains of 55 of 55 held responses matched, phases of 0 of
/// 55; 11 of 11 conditions have a result".
pub fn study_verdict_text(analysis: &Analysis) -> String {
    let gains = MatchCount::over_conditions(analysis, MatchCount::of_gains);
    let conditions = analysis.study.dataset.conditions().len();
    let solved = analysis.conditions.values().flatten().count();
    let solved = format!(
        "{solved} of {} a result",
        if conditions == 1 {
            "1 condition has".to_owned()
        } else {
            format!("{} have", counted(conditions, "condition"))
        }
    );
    if gains.held == 0 {
        return format!("no response is held; {solved}");
    }
    let phases = match analysis.study.settings.phase {
        PhaseCorrection::None => "phases not corrected".to_owned(),
        PhaseCorrection::Delay | PhaseCorrection::Lead => {
            let phases = MatchCount::over_conditions(analysis, MatchCount::of_phases);
            format!("phases of {}", match_count_text(phases))
        }
    };
    format!(
        "gains of {} held responses matched, {phases}; {solved}",
        match_count_text(gains)
    )
}

/// Columns of the verdict table without the optional number of suggested outliers. Gains and phases
/// take two each: the count of matched responses, and the verdict.
const VERDICT_COLUMNS: [&str; 7] = ["condition", "gain", "", "phase", "", "J before", "J after"];

/// Tabulates the verdict on each condition, one row each: gains, phases, and mean J over the
/// constrained responses before and after the condition's own correction; if any model is suggested
/// to be rejected, also the number of such models.
pub fn verdict_table(analysis: &Analysis) -> Table {
    let study = &analysis.study;
    let suggests = study
        .dataset
        .ids()
        .any(|id| open_suggestions(analysis, id) > 0);
    let mut columns = VERDICT_COLUMNS.to_vec();
    if suggests {
        columns.push("suggested outliers");
    }
    let mut table = Table::new("", columns);
    for condition in study.dataset.conditions() {
        let state = condition.flight_state();
        let name = format!("{}: {} kt", state.id, number(state.airspeed_kt));
        let mut cells = match analysis.conditions.get(&condition.id()) {
            Some(Ok(result)) => result_cells(study, result, name),
            Some(Err(failure)) => {
                let why = failure_text(failure, &study.dataset);
                without_result_cells(name, why)
            }
            None => without_result_cells(name, "not analysed".to_owned()),
        };
        if suggests {
            cells.push(match open_suggestions(analysis, condition.id()) {
                0 => NO_VALUE.to_owned(),
                count => count.to_string(),
            });
        }
        table.row(cells);
    }
    table
}

fn result_cells(study: &Study, result: &ConditionAnalysis, name: String) -> Vec<String> {
    let (before, after) = match MeanCost::new(study, result) {
        Some(mean) => told_apart(mean.before, mean.after, 1),
        None => (NO_VALUE.to_owned(), NO_VALUE.to_owned()),
    };
    let phase = PhaseVerdict::new(study, result);
    let phases = if phase == PhaseVerdict::NotCorrected {
        NO_VALUE.to_owned()
    } else {
        match_count_text(MatchCount::of_phases(result))
    };
    vec![
        name,
        match_count_text(MatchCount::of_gains(result)),
        gain_verdict_text(GainVerdict::new(result), &study.dataset),
        phases,
        phase_verdict_text(phase, study),
        before,
        after,
    ]
}

fn without_result_cells(name: String, why: String) -> Vec<String> {
    let mut cells = vec![name, NO_VALUE.to_owned(), format!("no result: {why}")];
    cells.resize(VERDICT_COLUMNS.len(), NO_VALUE.to_owned());
    cells
}

/// Counts the physics models that are suggested to be rejected and not yet rejected.
fn open_suggestions(analysis: &Analysis, id: ConditionId) -> usize {
    let Some(result) = analysis.condition(id) else {
        return 0;
    };
    let rejected = &analysis.study.choice(id).physics.rejected;
    let mut suggested = result.suggested();
    suggested.retain(|name| !rejected.contains(name));
    suggested.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lags_and_leads_are_worded_with_their_range() {
        let cases = [
            (RemainingLag::Equal(60.0), "lags by 60 ms"),
            (RemainingLag::AboutEqual(64.0), "lags by ≈ 64 ms"),
            (RemainingLag::Range([40.0, 106.0]), "lags 40–106 ms"),
            (RemainingLag::Range([-5.0, 106.0]), "lags −5 to 106 ms"),
            (RemainingLag::Range([-10.0, -90.0]), "leads 10–90 ms"),
        ];
        for (lag, expected) in cases {
            assert_eq!(remaining_lag_text(lag), expected);
        }
    }
}
