//! Evidence about the scheduled net gains, as printed: sources of their scatter, differences at
//! equal airspeed, and the need for a second variable.
//!
//! Scatter is the variation of a net gain over the conditions. Trim and identification uncertainty
//! explain a part of it (M13.5); the rest is a physical effect or a fault of the model. The second
//! variable, altitude or mass, is a candidate for the schedule besides airspeed.

use gdcm_method::schedule::SecondVariable;
use gdcm_model::message_text::sanitized;
use gdcm_study::results::uncertainty::Uncertainty;
use gdcm_study::{Analysis, Study};
use gdcm_words::uncertainty::{
    difference_text, differences_summary, scatter_table, second_variable_text,
};

use super::printed_lines::{detail, indented_untitled, line};
use super::terminal::keep_caution;

/// Code for the caution about a second variable that no response needs.
pub(super) const UNNEEDED_VARIABLE: &str = "second-variable-not-needed";

/// Returns the sources of the scatter, the differences at equal airspeed, and the need for a second
/// variable. Empty if the error bars were not computed.
pub(super) fn evidence_section(analysis: &Analysis) -> String {
    let Some(uncertainty) = &analysis.uncertainty else {
        return String::new();
    };
    let mut text = line(
        "Scatter",
        "of the on-axis net gains, and the part explained by trim and identification uncertainty:",
    );
    text += &indented_untitled(scatter_table(&analysis.study.dataset, uncertainty));
    text += &difference_lines(&analysis.study, uncertainty);
    text + &second_variable_lines(&analysis.study, uncertainty)
}

/// Returns the significant differences between conditions at equal airspeed.
fn difference_lines(study: &Study, uncertainty: &Uncertainty) -> String {
    let level = uncertainty.level;
    let words = format!(
        "{} ({:.0} % error bars, Holm's correction for multiple tests)",
        differences_summary(uncertainty).trim_end_matches('.'),
        100.0 * level
    );
    let mut text = line("Differences", &words);
    for difference in &uncertainty.differences {
        if difference.is_significant(level) {
            let pair = sanitized(&study.dataset.pair_name(difference.pair));
            text += &detail(
                "",
                &format!("{pair}: {}", difference_text(difference, level)),
            );
        }
    }
    text
}

/// Returns the responses that need a second variable, and a caution, also added to the JSON object,
/// if the schedule has a variable that no response needs.
fn second_variable_lines(study: &Study, uncertainty: &Uncertainty) -> String {
    let mut text = String::new();
    if let Some(variable) = unneeded_variable(study, uncertainty) {
        let words = format!(
            "the schedule depends on airspeed and {variable}, but no response depends \
            significantly on {variable}"
        );
        keep_caution(UNNEEDED_VARIABLE, &[], &words);
        text += &line("Caution", &words);
    }
    let tests = &uncertainty.second_variables;
    for test in tests.iter().filter(|test| test.needed) {
        let pair = sanitized(&study.dataset.pair_name(test.pair));
        text += &line(
            "Schedule",
            &format!("{pair}: {}", second_variable_text(test)),
        );
    }
    text
}

/// Returns the schedule's second variable if no response needs it; `None` also without error bars.
pub(super) fn unneeded_second_variable(analysis: &Analysis) -> Option<SecondVariable> {
    unneeded_variable(&analysis.study, analysis.uncertainty.as_deref()?)
}

fn unneeded_variable(study: &Study, uncertainty: &Uncertainty) -> Option<SecondVariable> {
    let variable = study.settings.schedule.second?;
    for test in &uncertainty.second_variables {
        if test.needed && test.variable == variable {
            return None;
        }
    }
    Some(variable)
}
