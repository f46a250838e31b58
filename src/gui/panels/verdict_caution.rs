//! Short caution beside the verdict, to be read before the result is used.
//!
//! Couplings mix the inputs and feed outputs back to them (M16: docs/couplings.md). Leads are
//! filters that advance the phase, at the price of gain above the band (M15: docs/lead.md). J is
//! the cost of the mismatch (M4, M12: docs/method.md).

use gdcm_method::correction::LeadPrice;
use gdcm_method::schedule::ScheduleCaution;
use gdcm_model::number_format::{counted, six_digits};
use gdcm_model::units::{signed, told_apart};
use gdcm_study::ConditionAnalysis;
use gdcm_study::results::coupling_remark_search::coupling_cautions;
use gdcm_study::results::remark_kind::RemarkKind;

use crate::gui::state::window_state::State;
use crate::gui::views::used_couplings;
use crate::message::Message;

/// Maximum lead price that needs no caution \[dB\]: it is too small for the caution, which gives
/// whole decibels.
const LEAST_PRICE_DB: f64 = 0.05;

/// Returns the most important caution, by the first rule that applies:
///
/// 1. couplings are requested but not applied, or make poles unstable within the band;
/// 2. physics parameters are requested but not applied;
/// 3. the leads amplify a constrained response above the band by more than [`LEAST_PRICE_DB`];
/// 4. there are other cautions about the couplings;
/// 5. the schedule costs more than the condition's own correction.
pub(super) fn caution(state: &State, shown: &ConditionAnalysis) -> Option<Message> {
    // Rule 1.
    let couplings = coupling_caution(state);
    if let Some(caution) = &couplings
        && caution.kind == RemarkKind::Trouble
    {
        return Some(caution.message.clone());
    }
    // Rule 2.
    if state
        .analysis()
        .is_some_and(|analysis| analysis.requested_physics().is_err())
    {
        let text = "Physics parameters not applied";
        return Some(Message::new("no-physics", text));
    }
    // Rules 3 to 5.
    lead_caution(shown)
        .or(couplings.map(|caution| caution.message))
        .or_else(|| schedule_caution(state, shown))
}

/// Caution about the couplings, in a few words.
struct CouplingCaution {
    kind: RemarkKind,
    message: Message,
}

/// Returns a short caution about the couplings: requested but not applied; otherwise the number of
/// poles unstable in the band; otherwise the number of cautions, which the reasons sheet lists.
/// `None` without any.
fn coupling_caution(state: &State) -> Option<CouplingCaution> {
    if state.analysis()?.requested_couplings().is_err() {
        return Some(CouplingCaution {
            kind: RemarkKind::Trouble,
            message: Message::new("no-couplings", "No couplings"),
        });
    }
    let cautions = coupling_cautions(used_couplings(state)?).len();
    let unstable = unstable_in_band(state);
    if unstable > 0 {
        let poles = counted(unstable, "pole");
        return Some(CouplingCaution {
            kind: RemarkKind::Trouble,
            message: Message::new(
                "unstable-in-band",
                format!("Couplings: {poles} unstable in the band"),
            ),
        });
    }
    if cautions == 0 {
        return None;
    }
    let text = format!("Couplings: {}", counted(cautions, "caution"));
    Some(CouplingCaution {
        kind: RemarkKind::Caution,
        message: Message::new("coupling-cautions", text),
    })
}

/// Counts the poles within the band that the couplings in use make unstable.
pub(super) fn unstable_in_band(state: &State) -> usize {
    match used_couplings(state) {
        Some(used) => used.unstable_in_band(),
        None => 0,
    }
}

/// Returns the lead price: the maximum gain that a constrained response's filters add at ten times
/// the band's upper end (M15.6); `None` without leads, and up to [`LEAST_PRICE_DB`].
fn lead_caution(shown: &ConditionAnalysis) -> Option<Message> {
    let price = LeadPrice::new(&shown.compensated.as_ref()?.leads)?;
    let most_db = shown
        .held()
        .marked()
        .map(|pair| price.of_pair_db(pair))
        .fold(0.0, f64::max);
    if most_db <= LEAST_PRICE_DB {
        return None;
    }
    let top = six_digits(price.limit_rad_s);
    let text = format!("Leads: {} dB above {top} rad/s", signed(most_db, 0));
    Some(Message::new("lead-price", text))
}

/// Returns a caution if J under the schedule is above 1 and more than twice J under the condition's
/// own correction (M12).
fn schedule_caution(state: &State, shown: &ConditionAnalysis) -> Option<Message> {
    let schedule = state.analysis()?.schedule.as_ref().ok()?;
    for caution in &schedule.cautions {
        if let ScheduleCaution::CostsMore(cost) = caution
            && cost.condition == shown.condition.id()
        {
            let (scheduled, own) = told_apart(cost.scheduled, cost.own, 0);
            let text = format!("Schedule: J {scheduled} instead of {own}");
            return Some(Message::new(caution.code(), text));
        }
    }
    None
}
