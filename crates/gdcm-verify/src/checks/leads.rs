//! Lead filters, and problems with signed delays (M15: `docs/lead.md`).
//!
//! A channel's delay may be negative: a lead, which a filter gives that rises above the band. Its
//! *band delay* is the delay that fits its phase in the band best, and the *lead time* is its lead
//! at low frequency.
//!
//! A problem seeks channel delays whose sums match the delays D of the *fitted* responses, exactly
//! for the *held* ones (`on` in the reference). A solution is not `matched` if the bounds do not
//! allow this; the held responses are then held at the nearest feasible delays.

use gdcm_method::correction::lead_design::{LeadDesign, LeadSettings};
use gdcm_method::correction::{Bounds, Outcome, Problem};
use gdcm_model::dataset::{Band, Pair, PairTable};
use gdcm_model::response::{FrequencyGrid, LeadOrder};

use super::optimum::solved;
use crate::check::{CheckFault, Found};
use crate::reference::{LEADS, Reference};
use crate::reference_study::ReferenceStudy;

/// Smallest time that matters \[s\].
const TIME_SCALE_S: f64 = 1e-3;
/// Maximum gain of a filter far above the band (`R_max`), as in the reference.
const GREATEST_GAIN: f64 = 10.0;
/// Number of frequencies in the band, as in the reference.
const FREQUENCIES: usize = 200;

/// Returns the lead design with the order and the pole of a reference entry.
fn design(entry: &Reference) -> Result<LeadDesign, CheckFault> {
    let band = Band::new(0.5, 12.0).map_err(CheckFault::no_result)?;
    let grid = FrequencyGrid::logarithmic(band, FREQUENCIES);
    let order = match entry.integer("order")? {
        1 => LeadOrder::First,
        _ => LeadOrder::Second,
    };
    let settings = LeadSettings {
        order,
        pole: entry.number("pole")?,
        limit: GREATEST_GAIN,
    };
    Ok(LeadDesign::new(settings, grid.omega().into()))
}

/// Compares with the reference: filters, their gains at infinity and band delays, and the lead time
/// that a signed delay needs.
pub(super) fn filters(_: &mut ReferenceStudy) -> Result<Found, CheckFault> {
    let reference = LEADS.read()?;
    let mut found = Found::default();
    for entry in reference.list("filters")? {
        let design = design(&entry)?;
        let lead_s = entry.number("lead_s")?;
        let filter = design.filter_for_lead(lead_s);
        found.instance();
        let omegas = entry.numbers("omega")?;
        let re = entry.numbers("re")?;
        let im = entry.numbers("im")?;
        for (index, omega) in omegas.iter().enumerate() {
            let own = filter.at(*omega);
            found.deviation((own.re - re[index]) / own.norm());
            found.deviation((own.im - im[index]) / own.norm());
        }
        found.relative(filter.gain_at_infinity(), entry.number("gain_at_infinity")?);
        found.scaled(
            design.band_delay_s(lead_s),
            entry.number("band_delay_s")?,
            TIME_SCALE_S,
        );
    }
    for entry in reference.list("lead_time")? {
        found.instance();
        let lead_s = design(&entry)?.lead_s(entry.number("tau_s")?);
        found.scaled(lead_s, entry.number("lead_s")?, TIME_SCALE_S);
    }
    Ok(found)
}

/// Compares minima for signed delays with the reference; a minimum disagrees if it is not proven,
/// or if it differs on whether the held delays are feasible.
pub(super) fn signed_delays(_: &mut ReferenceStudy) -> Result<Found, CheckFault> {
    let mut found = Found::default();
    for entry in LEADS.read()?.list("programs")? {
        let delta = entry.table("D_s")?.map(|_, delay_s| Some(*delay_s));
        let mut held = PairTable::filled(delta.outputs(), delta.inputs(), false);
        for on in entry.list("on")? {
            if let [output, input] = on.as_numbers()?[..] {
                held[Pair::new(output as usize, input as usize)] = true;
            }
        }
        let bounds = Bounds {
            lower: entry.number("lower_s")?,
            upper: entry.number("upper_s")?,
        };
        let fitted = entry.table("weight")?.map(|_, weight| *weight != 0.0);
        let solution = solved(&Problem {
            alpha: entry.number("alpha")?,
            fitted,
            ..Problem::signed_delays(delta, held, bounds)
        })?;
        found.instance();
        found.relative(solution.objective, entry.number("objective")?);
        found.agree(solution.matched == entry.flag("matched")?);
        found.agree(matches!(solution.proof.outcome, Outcome::Proven { .. }));
    }
    Ok(found)
}
