//! Sentences for the remarks on a condition's result, identical in the window and in a terminal.
//! *Held* responses are the constrained ones; J is the mismatch cost, G and D the gain and the
//! delay that a response needs (M4, M6).

use gdcm_method::correction::solution::Unmatched;
use gdcm_model::dataset::Dataset;
use gdcm_model::number_format::counted;
use gdcm_model::units::{number, s_to_ms, signed, telling, told_apart};
use gdcm_study::results::lead_offer::LeadOffer;
use gdcm_study::results::remark::{
    DelaysApart, FartherResponse, MissedTargets, NeededLead, Remark,
};

use crate::caution::caution_text;
use crate::conflict_text::{agreement_text, conflict_text, miss_text, remedy_text};
use crate::convention_doubt::doubt_text;
use crate::coupling_remark::coupling_remark_text;
use crate::schedule::schedule_caution_text;

/// Returns a remark as one or more sentences.
pub fn remark_text(remark: &Remark, dataset: &Dataset) -> String {
    match remark {
        Remark::ConventionDoubt(doubt) => doubt_text(doubt, dataset),
        Remark::ChannelReversed { channel, role } => format!(
            "The sign of {} is reversed in {}, relative to the file.",
            channel.name_in(dataset),
            role.models()
        ),
        Remark::GainsMatched { held, tolerance_db } => matched_gains_text(*held, *tolerance_db),
        Remark::GainsMissed(missed) | Remark::LeadsMissed(missed) => {
            missed_targets_text(missed, dataset)
        }
        Remark::GainsRemedy(remedy) => {
            let (inputs, outputs) = dataset.input_and_output_names();
            remedy_text(remedy, &inputs, &outputs)
        }
        Remark::DelaysMatched { held, is_exact } => {
            let accuracy = if *is_exact {
                "exactly"
            } else {
                "to the displayed precision"
            };
            if *held == 1 {
                format!("The held delay is matched {accuracy}.")
            } else {
                format!("All {held} held delays are matched {accuracy}.")
            }
        }
        Remark::NeedsLead { needed, held } => needed_lead_text(needed, *held, dataset),
        Remark::DelayMissed {
            miss,
            band_top_rad_s,
        } => named_miss_text(miss, *band_top_rad_s, dataset),
        Remark::CommonLead { lead_s } => format!(
            "All held responses need about {} ms of lead. First check the time alignment of the \
            records, and the integration and sampling delay of the simulation, then the servo and \
            sensor models: a common lag is better removed at its source than corrected.",
            lead_ms_text(*lead_s)
        ),
        Remark::LeadsNegligible => {
            "No phase correction is needed: every delay or lead is below 2 ms.".to_owned()
        }
        Remark::LeadsMatched { held } => matched_leads_text(*held),
        Remark::GainRaised { rise_db, pair } => format!(
            "The lead filters raise the gain within the band by up to {} dB ({}); the channel \
            gains compensate for this.",
            raised_gain_text(*rise_db),
            dataset.pair_name(*pair)
        ),
        Remark::NotADelay {
            responses,
            by_leads,
        } => not_a_delay_text(responses, *by_leads, dataset),
        Remark::LeadsOffered(offer) => {
            let [without, with] = lead_offer_texts(offer);
            format!(
                "All held responses need lead: with a delay or lead in each channel, their mean \
                J would be about {with} instead of {without}."
            )
        }
        Remark::LoopAgrees(conflict) => {
            let (inputs, outputs) = dataset.input_and_output_names();
            agreement_text(conflict, &inputs, &outputs)
        }
        Remark::CoherenceUsed { responses } => {
            format!(
                "Weighted by coherence: J, G and D of {}.",
                counted(*responses, "response")
            )
        }
        Remark::HeldFarther(responses) => held_farther_text(responses, dataset),
        Remark::FreeFarther { farther, compared } => format!(
            "Farther from flight than without a correction: {farther} of the {compared} responses \
            that are not held."
        ),
        Remark::LeftOutOfSchedule => {
            "This condition is left out of the schedule: its gains do not enter the fit.".to_owned()
        }
        Remark::Caution(caution) => caution_text(caution, |pair| dataset.pair_name(pair)),
        Remark::Schedule(caution) => {
            let (inputs, outputs) = dataset.input_and_output_names();
            format!(
                "Schedule: {}.",
                schedule_caution_text(caution, &inputs, &outputs)
            )
        }
        Remark::Coupling(remark) => coupling_remark_text(remark, dataset),
    }
}

fn matched_gains_text(held: usize, tolerance_db: Option<f64>) -> String {
    match (held, tolerance_db) {
        (0, _) => "No gain is held.".to_owned(),
        (1, _) => "The held gain is matched exactly.".to_owned(),
        (count, Some(tolerance_db)) => format!(
            "All {count} held gains are matched within {} dB.",
            number(tolerance_db)
        ),
        (count, None) => format!("All {count} held gains are matched exactly."),
    }
}

fn matched_leads_text(held: usize) -> String {
    match held {
        0 => "No response is held, so no delay or lead is prescribed.".to_owned(),
        1 => "The held response gets the delay or lead that it needs.".to_owned(),
        count => format!("All {count} held responses get the delay or lead that they need."),
    }
}

/// Describes all constrained responses that miss their targets, or a conflict among the constraints
/// that causes this.
fn missed_targets_text(missed: &MissedTargets, dataset: &Dataset) -> String {
    match missed {
        MissedTargets::Responses {
            misses,
            band_top_rad_s,
        } => {
            let texts: Vec<String> = misses
                .iter()
                .map(|miss| named_miss_text(miss, *band_top_rad_s, dataset))
                .collect();
            texts.join(" ")
        }
        MissedTargets::Conflict(conflict) => {
            let (inputs, outputs) = dataset.input_and_output_names();
            conflict_text(conflict, &inputs, &outputs)
        }
    }
}

fn named_miss_text(miss: &Unmatched, band_top_rad_s: f64, dataset: &Dataset) -> String {
    let (inputs, outputs) = dataset.input_and_output_names();
    miss_text(miss, band_top_rad_s, &inputs, &outputs)
}

fn needed_lead_text(needed: &[NeededLead], held: usize, dataset: &Dataset) -> String {
    let subject = match (needed.len(), held) {
        (1, 1) => "The held response needs".to_owned(),
        (1, _) => format!("1 of {held} held responses needs"),
        (count, _) if count == held => format!("All {held} held responses need"),
        (count, _) => format!("{count} of {held} held responses need"),
    };
    let leads: Vec<String> = needed
        .iter()
        .map(|needed| {
            format!(
                "{} {} ms",
                dataset.pair_name(needed.pair),
                lead_ms_text(needed.lead_s)
            )
        })
        .collect();
    format!(
        "{subject} lead, because the physics model lags: {}. A delay cannot provide it.",
        leads.join(", ")
    )
}

fn not_a_delay_text(responses: &[DelaysApart], by_leads: bool, dataset: &Dataset) -> String {
    let apart: Vec<String> = responses
        .iter()
        .map(|response| {
            format!(
                "{}: median delay {} ms (eq. (9)), least-squares delay over the band {} ms",
                dataset.pair_name(response.pair),
                signed(s_to_ms(response.median_s), 0),
                signed(s_to_ms(response.band_s), 0)
            )
        })
        .collect();
    let remedy = if by_leads {
        ", which a lead filter cannot correct"
    } else {
        ""
    };
    format!(
        "The missing phase is not due to a delay, but to a zero or a mode in the band{remedy}: {}.",
        apart.join("; ")
    )
}

fn held_farther_text(responses: &[FartherResponse], dataset: &Dataset) -> String {
    let texts: Vec<String> = responses
        .iter()
        .map(|response| {
            let cost = response.cost;
            let (before, after) = told_apart(cost.uncorrected.total(), cost.corrected.total(), 0);
            format!(
                "{} (J {before} → {after})",
                dataset.pair_name(response.pair)
            )
        })
        .collect();
    format!(
        "Held, but farther from flight than without a correction: {}.",
        texts.join(", ")
    )
}

/// Formats a lead in whole milliseconds.
pub fn lead_ms_text(lead_s: f64) -> String {
    telling(s_to_ms(lead_s), 0)
}

/// Formats a change in gain \[dB\] without its sign.
pub fn raised_gain_text(rise_db: f64) -> String {
    telling(rise_db.abs(), 1)
}

/// Formats J without and with leads.
pub fn lead_offer_texts(offer: &LeadOffer) -> [String; 2] {
    [telling(offer.without, 0), telling(offer.with, 0)]
}
