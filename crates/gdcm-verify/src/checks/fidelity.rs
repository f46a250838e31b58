//! Cost, coherence and envelopes (M4, MUAD).
//!
//! The cost J is the distance between two responses. Envelopes of maximum unnoticeable added
//! dynamics (MUAD) bound the difference of two models that a pilot does not notice.

use gdcm_method::fidelity::coherence_weights::coherence_weight;
use gdcm_method::fidelity::{Cost, CostAverage, Muad};
use gdcm_model::dataset::Band;
use gdcm_model::response::FrequencyGrid;

use crate::check::{CheckFault, Found};
use crate::reference::MUAD;
use crate::reference_study::ReferenceStudy;

/// Phase weight `W_p` as in the paper (M4).
const PHASE_WEIGHT: f64 = 0.0175;

/// Compares J for a gain k with a delay tau with its closed form, which has a magnitude and a phase
/// part: `J = 20 (20 log10 k)^2 + 20 W_p average((omega tau)^2)`, omega tau in degrees.
pub(super) fn cost_of_gain_and_delay(_: &mut ReferenceStudy) -> Result<Found, CheckFault> {
    let band = Band::new(0.5, 12.0).map_err(CheckFault::no_result)?;
    let grid = FrequencyGrid::logarithmic(band, 200);
    let omega = grid.omega();
    let median_square = median_of_rising(omega, |omega| omega * omega);
    let mean_square = omega.iter().map(|omega| omega * omega).sum::<f64>() / omega.len() as f64;
    let mut found = Found::default();
    for gain in [0.5_f64, 0.9, 1.3] {
        for delay_s in [0.01, 0.06] {
            found.instance();
            let error_db = 20.0 * gain.log10();
            let magnitude = 20.0 * error_db * error_db;
            let slope_deg = f64::to_degrees(delay_s);
            for (average, average_square) in [
                (CostAverage::Median, median_square),
                (CostAverage::Mean, mean_square),
            ] {
                let cost = Cost::from_errors(
                    omega.iter().map(|_| error_db),
                    omega.iter().map(|omega| -omega * delay_s),
                    None,
                    average,
                );
                let phase = 20.0 * PHASE_WEIGHT * slope_deg * slope_deg * average_square;
                found.relative(cost.magnitude, magnitude);
                found.relative(cost.phase, phase);
                found.relative(cost.total(), magnitude + phase);
            }
        }
    }
    Ok(found)
}

/// Returns the median over frequency of a rising function, for an even frequency count.
fn median_of_rising(omega: &[f64], function: fn(f64) -> f64) -> f64 {
    let half = omega.len() / 2;
    0.5 * (function(omega[half - 1]) + function(omega[half]))
}

/// Compares coherence weights with the reference.
pub(super) fn coherence_weights(_: &mut ReferenceStudy) -> Result<Found, CheckFault> {
    let mut found = Found::default();
    for row in MUAD.read()?.list("Wgamma")? {
        let [coherence, weight] = row.as_numbers()?[..] else {
            return Err(CheckFault::no_result("two numbers are expected"));
        };
        found.instance();
        found.deviation(coherence_weight(coherence) - weight);
    }
    Ok(found)
}

/// Compares the envelopes for maximum unnoticeable added dynamics (MUAD) with the reference.
pub(super) fn envelopes(_: &mut ReferenceStudy) -> Result<Found, CheckFault> {
    let mut found = Found::default();
    for row in MUAD.read()?.list("rows")? {
        let muad = Muad::at(row.number("w")?);
        found.instance();
        for (own, name) in [
            (muad.magnitude_db[0], "gain_lo_dB"),
            (muad.magnitude_db[1], "gain_up_dB"),
            (muad.phase_deg[0], "phase_lo_deg"),
            (muad.phase_deg[1], "phase_up_deg"),
        ] {
            found.deviation(own - row.number(name)?);
        }
    }
    Ok(found)
}
