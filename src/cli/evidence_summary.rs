//! Evidence about the scheduled net gains, as printed: sources of their scatter, differences at
//! equal airspeed, and the need for a second variable.

use gdcm_model::message_text::sanitized;
use gdcm_study::results::uncertainty::Uncertainty;
use gdcm_study::{Analysis, Study};
use gdcm_words::uncertainty::{
    difference_text, differences_summary, scatter_table, second_variable_text,
};

use super::printed_lines::{detail, indented_untitled, line};

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

/// Returns the responses that need a second variable, and a caution if the schedule has a variable
/// that no response needs.
fn second_variable_lines(study: &Study, uncertainty: &Uncertainty) -> String {
    let needed: Vec<_> = uncertainty
        .second_variables
        .iter()
        .filter(|test| test.needed)
        .collect();
    let mut text = String::new();
    if let Some(variable) = study.settings.schedule.second
        && needed.iter().all(|test| test.variable != variable)
    {
        let words = format!(
            "the schedule depends on airspeed and {variable}, but no response depends \
            significantly on {variable}"
        );
        text += &line("Caution", &words);
    }
    for test in needed {
        let pair = sanitized(&study.dataset.pair_name(test.pair));
        text += &line(
            "Schedule",
            &format!("{pair}: {}", second_variable_text(test)),
        );
    }
    text
}
