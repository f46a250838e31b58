//! Sentences about the cost of constraints: from their sensitivity, and from solutions in which one
//! entry is released or additionally constrained.
//!
//! A *sensitivity* is the derivative of the objective with respect to a constraint that is active,
//! a held response or a bound, per dB or ms: if `per_unit` is positive, raising the constraint
//! raises the objective. A *toggle* is the objective after a single response is released or held,
//! found by solving again.

use gdcm_method::correction::Quantity;
use gdcm_method::correction::channels::pair_name;
use gdcm_method::correction::sensitivity::{ActiveConstraint, Sensitivity};
use gdcm_method::correction::toggles::Toggle;
use gdcm_model::units::number;

/// Describes the sensitivity: the constraint, a change to it, and how much that would lower the
/// objective.
pub fn sensitivity_text(
    sensitivity: &Sensitivity,
    inputs: &[String],
    outputs: &[String],
) -> String {
    let name = match sensitivity.constraint {
        ActiveConstraint::Held(pair) => pair_name(pair, inputs, outputs),
        ActiveConstraint::LowerBound(channel) | ActiveConstraint::UpperBound(channel) => {
            let symbol = if sensitivity.quantity.is_gain() {
                "k"
            } else {
                "τ"
            };
            format!("{symbol}_{}", channel.name(inputs, outputs))
        }
    };
    // In dB or ms; small enough for the linear prediction.
    let step = sensitivity.step();
    // `min(100.0)`: by the linear prediction, an objective close to zero would become negative even
    // for the minimum step.
    let percent = (100.0 * step * sensitivity.share_per_unit.abs()).min(100.0);
    let change = if sensitivity.quantity.is_gain() {
        gain_change_words(sensitivity, &number(step))
    } else {
        delay_change_words(sensitivity, &number(step))
    };
    format!("{name} is {change} would lower the objective by about {percent:.2} %.")
}

/// Describes the constraint on a gain, and the change by `step` dB that lowers the objective:
/// "held: lowering its gain by 1 dB".
fn gain_change_words(sensitivity: &Sensitivity, step: &str) -> String {
    let change = if sensitivity.per_unit > 0.0 {
        "lowering"
    } else {
        "raising"
    };
    match sensitivity.constraint {
        ActiveConstraint::Held(_) => format!("held: {change} its gain by {step} dB"),
        ActiveConstraint::LowerBound(_) => {
            format!("on its lower bound: {change} the bound by {step} dB")
        }
        ActiveConstraint::UpperBound(_) => {
            format!("on its upper bound: {change} the bound by {step} dB")
        }
    }
}

/// Describes the constraint on a delay, and the change by `step` ms that lowers the objective:
/// "held: 1 ms less delay". A bound is described as widened, because narrowing never lowers the
/// objective.
fn delay_change_words(sensitivity: &Sensitivity, step: &str) -> String {
    match sensitivity.constraint {
        ActiveConstraint::Held(_) if sensitivity.per_unit > 0.0 => {
            format!("held: {step} ms less delay")
        }
        ActiveConstraint::Held(_) => format!("held: {step} ms more delay"),
        ActiveConstraint::LowerBound(_) if sensitivity.quantity == Quantity::Delay => {
            format!("0: {step} ms of lead")
        }
        ActiveConstraint::LowerBound(_) => format!("at its maximum lead: {step} ms more"),
        ActiveConstraint::UpperBound(_) => {
            format!("on its upper bound: raising the bound by {step} ms")
        }
    }
}

/// Describes what constraining the entry costs now or, if it is not constrained, would cost.
pub fn toggle_text(toggle: &Toggle, inputs: &[String], outputs: &[String]) -> String {
    let pair = pair_name(toggle.pair, inputs, outputs);
    // `+ 0.0`: no change would otherwise be formatted as -0.0.
    let percent = 100.0 * toggle.share() + 0.0;
    if toggle.held_now {
        if toggle.after <= toggle.before {
            let saved = 0.0 - percent;
            format!("holding {pair} costs {saved:.1} % of the objective")
        } else {
            format!(
                "releasing {pair} would raise the objective by {percent:.1} %, because other \
                responses could then be held more closely"
            )
        }
    } else if toggle.matched_after {
        format!("holding {pair} would change the objective by {percent:+.1} %")
    } else {
        format!(
            "{pair} cannot be held in addition to the held responses; the attempt would \
            change the objective by {percent:+.1} %"
        )
    }
}

#[cfg(test)]
mod tests {
    use gdcm_method::correction::{Channel, GainObjective};
    use gdcm_model::dataset::Pair;

    use super::*;

    #[test]
    fn the_change_that_lowers_the_objective_is_named() {
        for (per_unit, change) in [(0.01, "lowering"), (-0.01, "raising")] {
            let sensitivity = Sensitivity {
                quantity: Quantity::Gain(GainObjective::Ratio),
                constraint: ActiveConstraint::Held(Pair::new(0, 0)),
                per_unit,
                share_per_unit: per_unit,
            };
            let words = sensitivity_text(&sensitivity, &["LON".to_owned()], &["Q".to_owned()]);
            assert_eq!(
                words,
                format!(
                    "LON → Q is held: {change} its gain by 1 dB would lower the objective by about 1.00 %."
                )
            );
        }
    }

    #[test]
    fn no_constraint_is_said_to_cost_more_than_the_whole_objective() {
        let words = |share_per_unit: f64| {
            let constraint = ActiveConstraint::LowerBound(Channel::Input(0));
            let per_unit = 1e-6 * share_per_unit;
            let sensitivity = Sensitivity {
                quantity: Quantity::Delay,
                constraint,
                per_unit,
                share_per_unit,
            };
            (
                sensitivity.step(),
                sensitivity_text(&sensitivity, &["LON".to_owned()], &[]),
            )
        };
        let (step, of_much) = words(1.2156);
        assert_eq!(step, 0.1);
        assert_eq!(
            of_much,
            "τ_LON is 0: 0.1 ms of lead would lower the objective by about 12.16 %."
        );
        assert_eq!(
            words(0.3).1,
            "τ_LON is 0: 1 ms of lead would lower the objective by about 30.00 %."
        );
        let (least, of_all) = words(1e12);
        assert_eq!(least, 1e-6);
        assert!(of_all.ends_with("by about 100.00 %."), "{of_all}");
    }
}
