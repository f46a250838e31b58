//! Text about a mode: values, name, participations, and how a discrete-time pole is converted.

use gdcm_method::requirements::{ModeName, NamedBy};
use gdcm_model::dataset::{Dynamics, Model};
use gdcm_model::response::Mode;
use gdcm_model::units::number;

/// Describes a mode: its values, its name, its largest participations and, for a discrete-time
/// model, how its pole is converted to `s`.
pub(super) fn mode_description(mode: &Mode, model: &Model) -> Vec<String> {
    let mut words = vec![mode_values(mode)];
    words.extend(mode_name(mode, model));
    words.extend(participation_words(mode, model, 3));
    words.extend(discrete_time_words(model));
    words
}

/// Formats "|λ| 1.520 rad/s, ζ 0.310, T 2.10 s".
fn mode_values(mode: &Mode) -> String {
    let mut words = vec![format!("|λ| {:.3} rad/s", mode.frequency_rad_s)];
    if let Some(ratio) = shown_damping_ratio(mode) {
        words.push(format!("ζ {ratio:.3}"));
    }
    if let Some(constant_s) = mode.time_constant_s {
        words.push(format!("T {constant_s:.2} s"));
    }
    words.join(", ")
}

/// Returns the damping ratio; `None` unless the mode oscillates.
pub(super) fn shown_damping_ratio(mode: &Mode) -> Option<f64> {
    if mode.oscillates() {
        mode.damping_ratio
    } else {
        None
    }
}

/// Returns a mode's name as determined by the participating states; `None` if the model does not
/// name its states, or if they are inconclusive (M17.3).
pub(super) fn mode_name(mode: &Mode, model: &Model) -> Option<String> {
    match ModeName::determine(mode, &model.states) {
        (Some(name), NamedBy::States) => Some(name.to_string()),
        _ => None,
    }
}

/// Describes how discrete-time poles are converted to `s`; `None` for other models.
fn discrete_time_words(model: &Model) -> Option<String> {
    let Dynamics::StateSpace(system) = &model.dynamics else {
        return None;
    };
    let sample_time_s = system.timing().sample_time_s?;
    Some(format!(
        "s = ln z / Δt, sample time Δt {} s; poles at z = 0 have no s and are not drawn",
        number(sample_time_s)
    ))
}

/// Lists up to `most` states with the largest participation: "w 62 %, q 21 %"; if the
/// participations are unknown, returns the reason.
pub(super) fn participation_words(mode: &Mode, model: &Model, most: usize) -> Option<String> {
    let shares = match &mode.participation {
        Ok(shares) => shares,
        Err(why) => return Some(why.to_string()),
    };
    let mut words = Vec::new();
    for (state, share) in shares.iter().take(most) {
        let name = match model.states.get(*state) {
            Some(name) => name.clone(),
            None => format!("state {}", state + 1),
        };
        words.push(format!("{name} {:.0} %", 100.0 * share));
    }
    let words = words.join(", ");
    if words.is_empty() { None } else { Some(words) }
}
