//! What `gdcm analyze` prints.

use gdcm_core::message_text::{sanitized, sanitized_path};
use std::path::Path;

use gdcm_core::correction::GainSource;
use gdcm_core::schedule::Schedule;
use gdcm_core::study::{Analysis, Assessed, PhaseCorrection};
use gdcm_core::units::number;
use gdcm_files::{LoadedDataset, RESULT_FILES};

use super::evidence_sections::{evidence_section, held_out_lines};
use super::sections::{condition_section, schedule_section};
use super::text_table::labelled;

/// Width of the labels at the left of a section.
pub(super) const LABEL: usize = 14;

/// The results for a person to read: the settings, each condition, the schedule, the assessment, and where the files are.
pub(super) fn summary(analysis: &Analysis, loaded: &LoadedDataset, out: &Path) -> String {
    let mut text = heading(analysis, loaded);
    for condition in analysis.study.dataset.conditions() {
        text.push('\n');
        text.push_str(&condition_section(analysis, condition));
    }
    text.push('\n');
    text.push_str(&schedule_section(analysis));
    text.push_str(&assessment_lines(analysis));
    text.push_str(&held_out_lines(analysis));
    text.push_str(&evidence_section(analysis));
    text.push_str(&labelled(0, "Written", LABEL, &format!("{} in {}", RESULT_FILES.join(", "), sanitized_path(out))));
    text
}

fn heading(analysis: &Analysis, loaded: &LoadedDataset) -> String {
    let (study, settings) = (&analysis.study, &analysis.study.settings);
    let held: Vec<String> =
        settings.constrained.marked().map(|pair| sanitized(&study.dataset.pair_name(pair))).collect();
    let held = if held.is_empty() { "none".to_owned() } else { held.join(", ") };
    let band = format!(
        "{} to {} rad/s, {} frequencies; alpha {} (gains), {} (delays)",
        number(settings.band.min()),
        number(settings.band.max()),
        settings.points,
        number(settings.alpha_gain),
        number(settings.alpha_delay)
    );
    let dataset = format!("{}, {}", sanitized(study.dataset.name()), loaded.origin);
    let phase = match settings.phase {
        PhaseCorrection::None => "left as it is".to_owned(),
        PhaseCorrection::Delay => format!("corrected by delays; D is the {}", settings.delay_from),
        PhaseCorrection::Lead => format!(
            "corrected by a delay or a lead filter a channel: order {}, n {}, R_max {}",
            settings.lead.order.number(),
            number(settings.lead.pole),
            number(settings.lead.limit)
        ),
    };
    let mut text = labelled(0, "Dataset", LABEL, &dataset) + &labelled(0, "Band", LABEL, &band);
    if settings.gain_source != GainSource::default() {
        text.push_str(&labelled(0, "G from", LABEL, &settings.gain_source_words()));
    }
    text + &labelled(0, "Phase", LABEL, &phase) + &labelled(0, "Held", LABEL, &held)
}

/// How far the scheduled correction brings the nominal models, and which conditions it is not judged in.
fn assessment_lines(analysis: &Analysis) -> String {
    let (mut better, mut compared) = (0, 0);
    let mut left_out = Vec::new();
    let measuring = analysis.study.dataset.measuring_pairs();
    for condition in analysis.study.dataset.conditions() {
        match analysis.assessment.get(&condition.id()) {
            None => {}
            Some(Assessed::LeftOut { why }) => {
                left_out.push(format!("condition {}: {}", condition.id(), sanitized(why)))
            }
            Some(Assessed::Nominal(changes)) => {
                let changes = measuring.marked().filter_map(|pair| changes[pair]).map(|change| change.total());
                for change in changes {
                    compared += 1;
                    better += usize::from(change < 0.0);
                }
            }
        }
    }
    let conditions = analysis.conditions.len() - left_out.len();
    let which = if analysis.study.dataset.on_axis().marked().next().is_some() { "on-axis " } else { "" };
    let words = format!(
        "under the schedule J of the nominal models falls in {better} of {compared} {which}responses of {conditions} conditions"
    );
    let fails = analysis.schedule.as_ref().is_ok_and(Schedule::interpolation_fails);
    let words = if fails {
        format!(
            "at the conditions' own airspeeds, {words}; between them the schedule must not be used (see its caution)"
        )
    } else {
        words
    };
    let mut text = labelled(0, "Assessment", LABEL, &words);
    for words in left_out {
        text.push_str(&labelled(0, "Left out", LABEL, &words));
    }
    text
}
