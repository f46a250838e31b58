//! Cautions about identified models in two short lines, for lists; the full texts are in gdcm-sysid.
//!
//! χ²/dof is the mean squared residual relative to the noise, 1 if the model explains all of the
//! record but the noise; the partial coherence of an input is the share that it explains of what
//! the other inputs leave of an output (M14.2). The *contrast* F says how far a record wants
//! another model than the other records (M14.16).

use gdcm_model::number_format::{counted, decimals, significant};
use gdcm_model::simulation::Signal;
use gdcm_model::units::s_to_ms;
use gdcm_sysid::diagnostics::record_fault::ContradictingRecord;
use gdcm_sysid::identification::{IdentificationCaution, TRUSTED_COHERENCE};
use gdcm_sysid::spectra::record_cautions::RecordCaution;

/// Number of responses that are listed by name.
const LISTED_RESPONSES: usize = 2;

/// A caution in two lines.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShortCaution {
    /// The doubt, in a few words.
    pub title: String,
    /// Numbers, or the record concerned.
    pub detail: String,
}

impl ShortCaution {
    fn new(title: impl Into<String>, detail: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            detail: detail.into(),
        }
    }
}

/// Returns a caution about identified models in two lines.
pub fn short_caution(caution: &IdentificationCaution) -> ShortCaution {
    match caution {
        IdentificationCaution::Records(caution) => short_record_caution(caution),
        IdentificationCaution::Short {
            longest_s,
            lowest,
            better_s,
            ..
        } => ShortCaution::new(
            format!("Records too short for {} rad/s", decimals(*lowest, 2)),
            format!("longest {longest_s:.0} s; {better_s:.0} s recommended"),
        ),
        IdentificationCaution::NotSwept {
            signal,
            partial_coherence,
        } => ShortCaution::new(
            format!("{signal} not swept, or not alone"),
            format!("partial coherence {partial_coherence:.2}"),
        ),
        IdentificationCaution::MovedTogether { condition } => ShortCaution::new(
            "Inputs not moved independently",
            format!("condition number {condition:.0}"),
        ),
        IdentificationCaution::BandNotShown { shown, .. } => ShortCaution::new(
            format!("No coherent response outside {}", band_text(*shown)),
            format!("partial coherence below {TRUSTED_COHERENCE}"),
        ),
        IdentificationCaution::Vibration {
            signal,
            percent,
            cut_off,
        } => ShortCaution::new(
            format!("{signal} vibrates above the band"),
            format!("{percent:.0} % of its variance, above {cut_off:.0} rad/s"),
        ),
        IdentificationCaution::Inadequate {
            cost,
            record,
            signal,
        } => ShortCaution::new(
            "Residual exceeds the noise".to_owned(),
            format!("χ²/dof {cost:.1}, largest in {signal}, {record}"),
        ),
        IdentificationCaution::UnlikeRecord { name, cost, .. } => ShortCaution::new(
            format!("{name} unlike the others"),
            format!("χ²/dof {cost:.1}"),
        ),
        IdentificationCaution::Contradiction { records, contrast } => {
            contradiction(records, *contrast)
        }
        IdentificationCaution::Feedback { share, .. } => ShortCaution::new(
            "Gusts fed back into the inputs",
            format!("{:.0} % of the measured response", 100.0 * share),
        ),
        IdentificationCaution::LeavesPoints {
            output,
            input,
            band,
            ..
        } => ShortCaution::new(
            format!("{input} → {output} off the measured points"),
            band_text(*band),
        ),
        IdentificationCaution::OrderLimit {
            order,
            narrower: [_, upper_end],
        } => ShortCaution::new(
            format!("An order above {order} would fit better"),
            format!("narrow the band, for example to {upper_end:.1} rad/s"),
        ),
        IdentificationCaution::HeldOut {
            raw, normalised, ..
        } => ShortCaution::new(
            "Held-out records not predicted",
            format!("χ²/dof {raw:.1}; {normalised:.1} allowing for the uncertainty of the model"),
        ),
        IdentificationCaution::Reweighed(ratio) => ShortCaution::new(
            "Records weighted by their noise",
            format!("the noise variance differs by a factor of {ratio:.1}"),
        ),
        IdentificationCaution::NotValidated(why) => {
            ShortCaution::new("Held-out records not compared", why.to_string())
        }
        IdentificationCaution::Unstable { pole, highest } => ShortCaution::new(
            format!("Unstable pole of {:.0} rad/s", pole.norm()),
            format!("above the highest frequency used, {highest:.0} rad/s"),
        ),
        IdentificationCaution::PairsNotIdentified(pairs) => ShortCaution::new(
            format!("{} not identified", responses_text(pairs)),
            "standard deviation over 3 dB",
        ),
    }
}

fn short_record_caution(caution: &RecordCaution) -> ShortCaution {
    match caution {
        RecordCaution::Resampled { record, percent } => ShortCaution::new(
            "Uneven sample times, interpolated",
            format!("{record}, the step varies by {percent:.0} %"),
        ),
        RecordCaution::SegmentDropped {
            record,
            start_s,
            length_s,
        } => ShortCaution::new(
            "Short part left out",
            format!("{record}, {length_s:.1} s from {start_s:.2} s on"),
        ),
        RecordCaution::RecordUnused(record) => {
            ShortCaution::new(format!("{record} not used"), "no part of it could be used")
        }
        RecordCaution::SampleHold { signal, hold_s, .. } => ShortCaution::new(
            format!("{signal} changes in steps"),
            format!("every {:.0} ms; state the cause", s_to_ms(*hold_s)),
        ),
        RecordCaution::UnlikelyUnit {
            signal,
            greatest,
            limit,
        } => ShortCaution::new(
            format!("Unit of {signal} in doubt"),
            format!(
                "reaches {}; plausible up to {}",
                significant(*greatest),
                significant(*limit)
            ),
        ),
        RecordCaution::MovedTogether {
            signals: [first, second],
            correlation,
        } => ShortCaution::new(
            format!("{first} and {second} moved together"),
            format!("correlation {correlation:.3}"),
        ),
        RecordCaution::AtLimit {
            record,
            signal,
            percent,
            records,
        } => ShortCaution::new(
            format!("{signal} at its limit"),
            format!("{percent:.1} % of {}", and_others(record, *records)),
        ),
        RecordCaution::Spike {
            record,
            signal,
            times_s,
            ..
        } => ShortCaution::new(
            format!("Spikes in {signal}"),
            format!("{record}, {}", counted(times_s.len(), "spike")),
        ),
        RecordCaution::RateLimited {
            record,
            signal,
            rate,
            records,
            ..
        } => ShortCaution::new(
            format!("{signal} at a rate limit"),
            format!(
                "{} per second, {}",
                significant(*rate),
                and_others(record, *records)
            ),
        ),
        RecordCaution::Stuck {
            record,
            signals,
            seconds,
        } => ShortCaution::new(
            format!("{} stood still", names_text(signals)),
            format!("{record}, {seconds:.1} s"),
        ),
        RecordCaution::Coarse { signal, step_sd } => ShortCaution::new(
            format!("{signal} in coarse steps"),
            format!("steps of {step_sd:.1} standard deviations"),
        ),
        RecordCaution::Copy { copy, of } => ShortCaution::new(
            format!("{copy} is a copy of {of}"),
            "the copy adds no information",
        ),
    }
}

fn contradiction(records: &[ContradictingRecord], contrast: f64) -> ShortCaution {
    let agreement = format!("F = {contrast:.0} (1 means agreement)");
    match records {
        [record] => {
            let detail = match &record.fault {
                Some(fault) => fault.to_string(),
                None => agreement,
            };
            ShortCaution::new(format!("{} contradicts the others", record.name), detail)
        }
        records => {
            let names: Vec<&str> = records.iter().map(|record| record.name.as_str()).collect();
            ShortCaution::new("Records contradict one another", names.join(", "))
        }
    }
}

/// Returns a band: `0.50 to 12.0 rad/s`.
fn band_text(band: [f64; 2]) -> String {
    format!("{:.2} to {:.1} rad/s", band[0], band[1])
}

/// Names a record, and counts the others.
fn and_others(record: &str, records: usize) -> String {
    match records.saturating_sub(1) {
        0 => record.to_owned(),
        others => format!("{record} and {others} more"),
    }
}

fn names_text(signals: &[Signal]) -> String {
    let names: Vec<&str> = signals.iter().map(|signal| signal.name.as_str()).collect();
    names.join(", ")
}

/// Lists responses: `LON → NZ, COL → P and 3 more`.
fn responses_text(pairs: &[[Signal; 2]]) -> String {
    let mut text: Vec<String> = Vec::new();
    for [output, input] in pairs.iter().take(LISTED_RESPONSES) {
        text.push(format!("{input} → {output}"));
    }
    let listed = text.join(", ");
    match pairs.len().saturating_sub(LISTED_RESPONSES) {
        0 => listed,
        more => format!("{listed} and {more} more"),
    }
}

#[cfg(test)]
mod tests {
    use gdcm_model::dataset::channel::ChannelSide;

    use super::*;

    fn signal(role: ChannelSide, name: &str) -> Signal {
        Signal {
            role,
            index: 0,
            name: name.to_owned(),
        }
    }

    #[test]
    fn a_caution_has_a_title_and_its_numbers() {
        let short = short_caution(&IdentificationCaution::Short {
            longest_s: 60.0,
            lowest: 0.5,
            periods: 4.8,
            better_s: 63.0,
        });
        assert!(
            short.title.contains("0.50") && short.detail.contains("63 s"),
            "{short:?}"
        );
    }

    #[test]
    fn many_responses_are_counted() {
        let pairs: Vec<[Signal; 2]> = ["P", "Q", "R", "NZ"]
            .map(|name| {
                [
                    signal(ChannelSide::Output, name),
                    signal(ChannelSide::Input, "LON"),
                ]
            })
            .to_vec();
        let short = short_caution(&IdentificationCaution::PairsNotIdentified(pairs));
        assert!(
            short.title.contains("LON → Q") && short.title.contains("2 more"),
            "{short:?}"
        );
        assert!(!short.title.contains("NZ"), "{short:?}");
    }
}
