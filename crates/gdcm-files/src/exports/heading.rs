//! What an exported file is, for the comment at its start.

use super::number::number;
use super::quoted::comment;
use super::scheduled_correction::ScheduledCorrection;

/// What the file is, line by line.
pub(super) fn heading(correction: &ScheduledCorrection) -> Vec<String> {
    let (least, most) = correction.airspeed_range_kt;
    let mut lines = vec![
        "Gains and delays that correct a model of a helicopter, scheduled with airspeed.".to_owned(),
        "The model gets the input Mi*u(t - tau_i); its output ym gives y(t) = Mo*ym(t - tau_o).".to_owned(),
        "Units: airspeed in knots, delays in seconds, gains without a unit.".to_owned(),
        format!("Airspeeds outside {least} to {most} kt are cut to the ends of this range."),
        format!("Correction: {}", comment(&correction.name)),
        format!("Dataset: {}", comment(&correction.dataset)),
        format!("SHA-256 of the dataset: {}", comment(&correction.sha256)),
        format!("Written by: {}", comment(&correction.software)),
    ];
    if let Some(lead) = correction.lead {
        let filter = match lead.order {
            1 => "L(s) = (1 + a*s)/(1 + b*s)",
            _ => "L(s) = (1 + sqrt(2)*a*s + a^2*s^2)/(1 + sqrt(2)*b*s + b^2*s^2)",
        };
        lines.push(format!(
            "Lead: each input, after its gain and delay, and each output, before them, passes {filter},"
        ));
        lines.push(format!(
            "with b = {} s for all, and a in seconds for each; where a = b there is no lead.",
            number(lead.lag_s)
        ));
        lines.push(format!(
            "In fixed-step code use Tustin's rule and a step of at most {} s.",
            number(0.5 * lead.lag_s)
        ));
    }
    lines.extend(correction.notes.iter().map(|note| format!("Note: {}", comment(note))));
    lines
}
