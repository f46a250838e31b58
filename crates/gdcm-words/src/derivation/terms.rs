//! Symbols in the equations, with their meanings.

/// Symbols in the derived equations with their meaning and, if any, their unit (docs/method.md).
const TERMS: [(&str, &str); 30] = [
    (
        "G",
        "delta gain, the gain that the response needs (a ratio)",
    ),
    ("D", "delta delay, the delay that the response needs [s]"),
    ("H_ref", "response of the identified representative"),
    ("H_sim", "response of the physics representative"),
    (
        "Δφ",
        "phase of H_sim minus phase of H_ref, unwrapped [rad]; in J the principal value [deg]",
    ),
    ("ΔdB", "magnitude of H_sim minus magnitude of H_ref [dB]"),
    ("ω", "frequency [rad/s]"),
    (
        "W",
        "weight of a frequency, from its coherence; 1 if coherence is not used",
    ),
    ("k_o", "gain of the output channel"),
    ("k_i", "gain of the input channel"),
    ("τ_o", "delay of the output channel [s]"),
    ("τ_i", "delay of the input channel [s]"),
    ("τ", "delay of a channel [s]"),
    ("k", "gain of a channel"),
    ("L_o", "delay or lead filter of the output channel"),
    ("L_i", "delay or lead filter of the input channel"),
    ("w", "weight of a response; 0 if the response is ignored"),
    ("w_k", "weight of coordinate k of the trim"),
    (
        "α",
        "weight that keeps the gains near 1, or the delays near 0",
    ),
    ("LB", "lower bound on channel values"),
    ("UB", "upper bound on channel values"),
    ("q", "quantile that determines the bounds"),
    (
        "J",
        "cost of a response: weighted magnitude and phase errors",
    ),
    ("ΔJ", "change of J due to the correction"),
    (
        "d",
        "distance between two models: square root of the mean J of one against the other",
    ),
    (
        "s_a",
        "mean distance of model a to the other models in the bundle",
    ),
    (
        "r_a",
        "discontinuity ratio: distance between models, relative to the distance that their trims \
        explain",
    ),
    ("p_ak", "coordinate k of the trim of model a"),
    ("v", "airspeed, scaled from −1 to 1 over the conditions"),
    ("V", "airspeed [kt]"),
];

/// Returns an equation's symbols with their meanings, in order of appearance.
pub(super) fn terms_of(equation: &str) -> Vec<(&'static str, &'static str)> {
    let mut found: Vec<(usize, (&str, &str))> = Vec::new();
    for (symbol, meaning) in TERMS {
        if let Some(place) = place_of(symbol, equation) {
            found.push((place, (symbol, meaning)));
        }
    }
    found.sort_by_key(|(place, _)| *place);
    found.into_iter().map(|(_, term)| term).collect()
}

/// Returns a symbol's position in an equation; `None` if it occurs only inside a longer symbol, or
/// not at all.
fn place_of(symbol: &str, equation: &str) -> Option<usize> {
    for (place, _) in equation.match_indices(symbol) {
        let before = equation[..place].chars().next_back();
        let after = equation[place + symbol.len()..].chars().next();
        if !is_symbol_part(before) && !is_symbol_part(after) {
            return Some(place);
        }
    }
    None
}

/// Returns whether a neighbouring character is part of the same symbol.
fn is_symbol_part(neighbour: Option<char>) -> bool {
    neighbour.is_some_and(|c| c.is_alphabetic() || c == '_')
}

#[cfg(test)]
mod tests {
    use super::*;

    fn terms(equation: &str) -> Vec<&'static str> {
        terms_of(equation)
            .into_iter()
            .map(|(symbol, _)| symbol)
            .collect()
    }

    #[test]
    fn the_symbols_of_an_equation_are_found_and_no_part_of_another() {
        assert_eq!(
            terms("G = median_ω |H_ref| / |L_o H_sim L_i|"),
            ["G", "H_ref", "L_o", "H_sim", "L_i"]
        );
        let gains = terms(
            "min Σ w (G − k_o k_i)² + α Σ (k_o − 1)², subject to k_o k_i = G (held), LB ≤ k ≤ UB",
        );
        assert_eq!(gains, ["w", "G", "k_o", "k_i", "α", "LB", "k", "UB"]);
        assert_eq!(
            terms("D = Σ W ω Δφ(H_sim, H_ref) / Σ W ω²"),
            ["D", "W", "ω", "Δφ", "H_sim", "H_ref"]
        );
        assert_eq!(terms("ΔJ = J(corrected) − J(uncorrected)"), ["ΔJ", "J"]);
    }
}
