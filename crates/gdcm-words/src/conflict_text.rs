//! Sentences about constrained responses whose gain or delay cannot be reached, the conflicts that
//! cause this, and the remedies. The facts are in [`Unmatched`], [`ConflictKind`] and [`Remedy`].
//!
//! A response is *held* if it is constrained: the product of its channels' gains k must equal its
//! G, the sum of their delays τ its D. Held responses may *conflict* with the bounds or with each
//! other; those that share channels can form a *loop*, in which the value of each follows from the
//! others. They are then held at the nearest feasible values.
//!
//! | field | meaning |
//! |---|---|
//! | `delta`, `target` | a response's G or D; the nearest feasible value, at which it is held |
//! | `excess` | how much `target` exceeds `delta` \[dB or s\], negative if it is less |
//! | `entries` | the held responses in a conflict |
//! | `asked` | the product, ratio, sum or difference of channel values that they require |
//! | `upper`, `lower` | a bound on all channel values with which they could be held |

use gdcm_method::correction::channels::{pair_name, pair_names};
use gdcm_method::correction::conflict::{Conflict, ConflictKind};
use gdcm_method::correction::remedy::Remedy;
use gdcm_method::correction::solution::Unmatched;
use gdcm_method::correction::{Channel, Quantity};
use gdcm_model::number_format::with_minus_sign;
use gdcm_model::units::{s_to_ms, telling, told_apart};

/// Describes a conflict and its possible resolutions, with the given channel names.
pub fn conflict_text(conflict: &Conflict, inputs: &[String], outputs: &[String]) -> String {
    ConflictText {
        conflict,
        inputs,
        outputs,
    }
    .sentence()
}

/// Describes a loop whose deviation is within the tolerance; empty for any other conflict.
pub fn agreement_text(conflict: &Conflict, inputs: &[String], outputs: &[String]) -> String {
    let ConflictKind::Loop { mismatch } = conflict.kind else {
        return String::new();
    };
    format!(
        "{} form a loop: their {} agree to {}, which is accepted; each is held at its nearest \
        consistent value.",
        pair_names(&conflict.entries, inputs, outputs),
        loop_values(conflict.quantity),
        mismatch_size(conflict.quantity, mismatch)
    )
}

/// Describes the remedies; empty if there are none.
pub fn remedy_text(remedy: &Remedy, inputs: &[String], outputs: &[String]) -> String {
    let unit = if remedy.quantity.is_gain() { "" } else { " s" };
    let mut ways = Vec::new();
    if let Some(upper) = remedy.upper {
        ways.push(format!("an upper bound of {upper}{unit}"));
    }
    if let Some(lower) = remedy.lower {
        ways.push(format!("a lower bound of {lower}{unit}"));
    }
    for &pair in &remedy.free {
        ways.push(format!("releasing {}", pair_name(pair, inputs, outputs)));
    }
    if ways.is_empty() {
        String::new()
    } else {
        format!(
            "Any one of these changes allows all responses to be held: {}.",
            ways.join("; ")
        )
    }
}

/// Describes a constrained response's deviation in gain, in lead (a signed delay that should be
/// negative) or in delay. For lead and delay, adds the phase error that remains at `omega_top`
/// \[rad/s\], the upper end of the band.
pub fn miss_text(
    miss: &Unmatched,
    omega_top: f64,
    inputs: &[String],
    outputs: &[String],
) -> String {
    let pair = pair_name(miss.pair, inputs, outputs);
    match miss.quantity {
        Quantity::Gain(_) => gain_miss_text(miss, &pair),
        Quantity::SignedDelay if miss.delta < 0.0 => lead_miss_text(miss, &pair, omega_top),
        Quantity::Delay | Quantity::SignedDelay => delay_miss_text(miss, &pair, omega_top),
    }
}

fn gain_miss_text(miss: &Unmatched, pair: &str) -> String {
    // With enough digits to distinguish the two numbers.
    let (target, delta) = told_apart(miss.target, miss.delta, 3);
    let sign = if miss.excess > 0.0 { "+" } else { "" };
    // With enough digits to distinguish the number from 0.
    let excess = with_minus_sign(&telling(miss.excess, 1));
    format!("{pair} is held at a gain of {target} instead of {delta} ({sign}{excess} dB).")
}

fn lead_miss_text(miss: &Unmatched, pair: &str, omega_top: f64) -> String {
    let (target, delta) = told_apart(s_to_ms(-miss.target), s_to_ms(-miss.delta), 1);
    let phase_error_deg = telling(miss.phase_left_deg(omega_top).abs(), 0);
    format!(
        "{pair} gets {target} of the {delta} ms of lead that it needs; a phase error of \
        {phase_error_deg}° remains at {omega_top} rad/s."
    )
}

/// Describes a delay's deviation: a needed lead, if the only conflict is that the response's own
/// delay would be negative; else too much delay (`excess` is positive); else too little.
fn delay_miss_text(miss: &Unmatched, pair: &str, omega_top: f64) -> String {
    let excess_ms = 1e3 * miss.excess;
    let size_ms = telling(excess_ms.abs(), 1);
    let why = if miss.why.is_lone_lead() && miss.why.entries == [miss.pair] {
        let lead_ms = telling(excess_ms, 1);
        format!("{pair} needs {lead_ms} ms of lead, which a delay cannot provide")
    } else if excess_ms > 0.0 {
        format!("{pair} gets {size_ms} ms more delay than it needs")
    } else {
        format!("{pair} lacks {size_ms} ms of delay")
    };
    let phase_error_deg = telling(miss.phase_left_deg(omega_top).abs(), 0);
    format!("{why}; a phase error of {phase_error_deg}° remains at {omega_top} rad/s.")
}

/// Names the values that are compared around a loop.
fn loop_values(quantity: Quantity) -> &'static str {
    if quantity.is_gain() {
        "ratios"
    } else {
        "delays"
    }
}

/// Formats a loop's deviation, which is in dB or in seconds; seconds are displayed in ms.
fn mismatch_size(quantity: Quantity, mismatch: f64) -> String {
    if quantity.is_gain() {
        format!("{} dB", telling(mismatch.abs(), 1))
    } else {
        format!("{} ms", milliseconds(mismatch.abs()))
    }
}

fn milliseconds(time_s: f64) -> String {
    telling(s_to_ms(time_s), 1)
}

/// Formats a limit and a prescribed value, both in s, in milliseconds, with enough digits to
/// distinguish them.
fn limit_and_asked_ms(limit_s: f64, asked_s: f64) -> (String, String) {
    told_apart(s_to_ms(limit_s), s_to_ms(asked_s), 1)
}

/// A conflict and the channel names for its description.
struct ConflictText<'a> {
    conflict: &'a Conflict,
    inputs: &'a [String],
    outputs: &'a [String],
}

impl ConflictText<'_> {
    /// Remedies for insufficient lead, apart from changing the bounds.
    const MORE_LEAD: &'static str = "increase R_max or reduce n";

    /// Remedy for a delay that would have to be a lead.
    const PERMIT_LEAD: &'static str = "set the phase correction to delay or lead (--phase lead)";

    /// Composes the sentence "ENTRIES cannot be held: LIMIT; CHANGE or RELEASE." LIMIT states the
    /// limit that the bounds impose and the value that the entries require, CHANGE a bound that
    /// would suffice.
    ///
    /// Sentences without LIMIT and CHANGE: loops, conflicts of unclear cause, and a single delay
    /// that would have to be a lead.
    fn sentence(&self) -> String {
        let conflict = self.conflict;
        let entries = pair_names(&conflict.entries, self.inputs, self.outputs);
        let release = if conflict.entries.len() == 1 {
            "release it"
        } else {
            "release one of them"
        };
        let cannot = match conflict.entries.len() {
            1 => "cannot be held",
            2 => "cannot both be held",
            _ => "cannot all be held",
        };
        let limit_and_change = match conflict.kind {
            ConflictKind::Loop { mismatch } => {
                return format!(
                    "{entries} form a loop: their {} disagree by {}; {release}.",
                    loop_values(conflict.quantity),
                    mismatch_size(conflict.quantity, mismatch)
                );
            }
            ConflictKind::Unclear => return format!("{entries} {cannot}; {release}."),
            ConflictKind::BelowLower { asked, .. } if conflict.is_lone_lead() => {
                return format!(
                    "{entries} needs {} ms of lead, which a delay cannot provide; {}, or {release}.",
                    milliseconds(-asked),
                    Self::PERMIT_LEAD
                );
            }
            ConflictKind::AboveUpper {
                channels,
                asked,
                upper,
            } => self.maximum_and_change(channels, asked, upper),
            ConflictKind::BelowLower {
                channels,
                asked,
                lower,
            } => self.minimum_and_change(channels, asked, lower),
            ConflictKind::TooFarApart {
                greater,
                lesser,
                asked,
                upper,
                lower,
            } if conflict.quantity.is_gain() => {
                let lower = lower.unwrap_or(conflict.bounds.lower);
                let limit = self.ratio_limit(greater, lesser, asked);
                format!(
                    "{limit}; set the upper bound to {upper}, or the lower bound to {lower}, or"
                )
            }
            ConflictKind::TooFarApart {
                greater,
                lesser,
                asked,
                upper,
                ..
            } => self.difference_limit_and_change(greater, lesser, asked, upper),
        };
        format!("{entries} {cannot}: {limit_and_change} {release}.")
    }

    /// Describes a net value above its maximum: twice the upper bound, or its square for gains;
    /// ends with a sufficient change in the bounds and "or".
    fn maximum_and_change(&self, channels: [Channel; 2], asked: f64, upper: f64) -> String {
        let [first, second] = channels.map(|channel| self.symbol(channel));
        let bound = self.conflict.bounds.upper;
        if self.conflict.quantity.is_gain() {
            let (most, asked) = told_apart(bound.powi(2), asked, 3);
            return format!(
                "with gains ≤ {bound:.3} the product {first} {second} is at most {most}, but \
                {asked} is required; set the upper bound to {upper} or"
            );
        }
        let (most, asked) = limit_and_asked_ms(2.0 * bound, asked);
        let kind = if self.conflict.quantity == Quantity::SignedDelay {
            " of delay"
        } else {
            ""
        };
        format!(
            "{first} and {second} together give at most {most} ms{kind}, but {asked} ms are \
            required; set the upper bound to {upper} s or"
        )
    }

    /// Describes a net value below its minimum: twice the lower bound, or its square for gains;
    /// ends with a sufficient change and "or"; for delays, which have no such change, with a
    /// semicolon.
    fn minimum_and_change(&self, channels: [Channel; 2], asked: f64, lower: Option<f64>) -> String {
        let [first, second] = channels.map(|channel| self.symbol(channel));
        let bound = self.conflict.bounds.lower;
        match self.conflict.quantity {
            Quantity::Gain(_) => {
                let (least, asked) = told_apart(bound.powi(2), asked, 3);
                let lower = lower.unwrap_or(bound);
                format!(
                    "with gains ≥ {bound:.3} the product {first} {second} is at least {least}, \
                    but {asked} is required; set the lower bound to {lower} or"
                )
            }
            Quantity::Delay => format!(
                "{first} and {second} together would have to give {} ms of lead, which a delay \
                cannot provide; {}, or",
                milliseconds(-asked),
                Self::PERMIT_LEAD
            ),
            Quantity::SignedDelay => {
                let (most, asked) = limit_and_asked_ms(-2.0 * bound, -asked);
                format!(
                    "R_max limits {first} and {second} to {most} ms of lead together, but {asked} \
                    ms are required; {}, or",
                    Self::MORE_LEAD
                )
            }
        }
    }

    /// Describes a gain ratio above the ratio of the bounds; proposes no change.
    fn ratio_limit(&self, greater: Channel, lesser: Channel, asked: f64) -> String {
        let greater = self.symbol(greater);
        let lesser = self.symbol(lesser);
        let lower_bound = self.conflict.bounds.lower;
        let upper_bound = self.conflict.bounds.upper;
        let (most, asked) = told_apart(upper_bound / lower_bound, asked, 3);
        format!(
            "with {greater} ≤ {upper_bound:.3} and {lesser} ≥ {lower_bound:.3} their ratio is at \
            most {most}, but {asked} is required"
        )
    }

    /// Describes a delay difference above the bounds' difference; ends with a sufficient change in
    /// the bounds and "or".
    fn difference_limit_and_change(
        &self,
        greater: Channel,
        lesser: Channel,
        asked: f64,
        upper: f64,
    ) -> String {
        let greater = self.symbol(greater);
        let lesser = self.symbol(lesser);
        let lower_bound = self.conflict.bounds.lower;
        let upper_bound = self.conflict.bounds.upper;
        if self.conflict.quantity == Quantity::SignedDelay {
            let (most, asked) = limit_and_asked_ms(upper_bound - lower_bound, asked);
            return format!(
                "{greater} cannot exceed {lesser} by {asked} ms: with at most {} ms of lead and \
                {} ms of delay in each channel, the difference is at most {most} ms; set the \
                upper bound to {upper} s, {}, or",
                milliseconds(-lower_bound),
                milliseconds(upper_bound),
                Self::MORE_LEAD
            );
        }
        let (most, asked) = limit_and_asked_ms(upper_bound, asked);
        format!(
            "{greater} cannot exceed {lesser} by {asked} ms with delays ≤ {most} ms; set the \
            upper bound to {upper} s or"
        )
    }

    /// Returns the symbol for a channel's value: "k_LON", "τ_P".
    fn symbol(&self, channel: Channel) -> String {
        let symbol = if self.conflict.quantity.is_gain() {
            "k"
        } else {
            "τ"
        };
        format!("{symbol}_{}", channel.name(self.inputs, self.outputs))
    }
}

#[cfg(test)]
mod tests {
    use gdcm_method::correction::{Bounds, GainObjective};
    use gdcm_model::dataset::Pair;

    use super::*;

    const GAIN: Quantity = Quantity::Gain(GainObjective::Ratio);
    const BOUNDS: Bounds = Bounds {
        lower: 0.7,
        upper: 1.4,
    };

    fn inputs() -> Vec<String> {
        ["LON", "LAT", "PED", "COL"].map(str::to_owned).to_vec()
    }

    fn outputs() -> Vec<String> {
        ["P", "Q", "R", "NX", "NY", "NZ"]
            .map(str::to_owned)
            .to_vec()
    }

    fn conflict(quantity: Quantity, entries: &[Pair], kind: ConflictKind) -> Conflict {
        Conflict {
            quantity,
            entries: entries.to_vec(),
            bounds: BOUNDS,
            kind,
        }
    }

    fn text(conflict: &Conflict) -> String {
        conflict_text(conflict, &inputs(), &outputs())
    }

    fn loop_conflict(mismatch: f64) -> Conflict {
        let entries =
            [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(output, input)| Pair::new(output, input));
        conflict(GAIN, &entries, ConflictKind::Loop { mismatch })
    }

    #[test]
    fn products_and_ratios_beyond_the_bounds_have_their_limits_and_remedies() {
        let above = ConflictKind::AboveUpper {
            channels: [Channel::Input(1), Channel::Output(0)],
            asked: 2.5,
            upper: 1.59,
        };
        assert_eq!(
            text(&conflict(GAIN, &[Pair::new(0, 1)], above)),
            "LAT → P cannot be held: with gains ≤ 1.400 the product k_LAT k_P is at most 1.960, but 2.500 is required; set \
             the upper bound to 1.59 or release it."
        );
        let little = ConflictKind::AboveUpper {
            channels: [Channel::Input(1), Channel::Output(0)],
            asked: 1.960_1,
            upper: 1.41,
        };
        let words = text(&conflict(GAIN, &[Pair::new(0, 1)], little));
        assert!(
            words.contains("is at most 1.9600, but 1.9601 is required;"),
            "{words}"
        );
        let apart = ConflictKind::TooFarApart {
            greater: Channel::Output(4),
            lesser: Channel::Output(2),
            asked: 2.5,
            upper: 1.75,
            lower: Some(0.56),
        };
        assert_eq!(
            text(&conflict(GAIN, &[Pair::new(2, 2), Pair::new(4, 2)], apart)),
            "PED → R and PED → NY cannot both be held: with k_NY ≤ 1.400 and k_R ≥ 0.700 their ratio is at most 2.000, but 2.500 is \
             required; set the upper bound to 1.75, or the lower bound to 0.56, or release one of them."
        );
    }

    #[test]
    fn loops_have_their_deviation_to_the_digits_that_show_it() {
        let words = text(&loop_conflict(0.06));
        assert!(
            words.contains("form a loop: their ratios disagree by 0.060 dB")
                && words.ends_with("release one of them."),
            "{words}"
        );
        let words = text(&loop_conflict(-0.002));
        assert!(words.contains("disagree by 0.0020 dB"), "{words}");
        let words = agreement_text(&loop_conflict(0.04), &inputs(), &outputs());
        assert!(
            words.contains("form a loop: their ratios agree to 0.040 dB"),
            "{words}"
        );
    }

    #[test]
    fn misses_have_the_value_the_wish_and_what_remains() {
        let miss = |target: f64, delta: f64| Unmatched {
            quantity: GAIN,
            pair: Pair::new(2, 2),
            delta,
            target,
            excess: 20.0 * (target / delta).log10(),
            why: loop_conflict(0.06),
        };
        assert_eq!(
            miss_text(
                &miss(0.6 * 1.25_f64.sqrt(), 0.6),
                12.0,
                &inputs(),
                &outputs()
            ),
            "PED → R is held at a gain of 0.671 instead of 0.600 (+1.0 dB)."
        );
        let words = miss_text(&miss(1.000_06, 1.0), 12.0, &inputs(), &outputs());
        let figures: Vec<&str> = words
            .split(' ')
            .filter(|word| word.starts_with("1.0"))
            .collect();
        assert!(
            figures.len() == 2 && figures[0] != figures[1] && !words.contains("0.0 dB"),
            "{words}"
        );
        let pair = Pair::new(0, 1);
        let lead = ConflictKind::BelowLower {
            channels: [Channel::Input(1), Channel::Output(0)],
            asked: -0.034,
            lower: None,
        };
        let miss = Unmatched {
            quantity: Quantity::Delay,
            pair,
            delta: -0.034,
            target: 0.0,
            excess: 0.034,
            why: conflict(Quantity::Delay, &[pair], lead),
        };
        assert_eq!(
            miss_text(&miss, 12.0, &inputs(), &outputs()),
            "LAT → P needs 34.0 ms of lead, which a delay cannot provide; a phase error of 23° remains at 12 rad/s."
        );
    }

    #[test]
    fn the_limit_of_the_gain_of_the_leads_is_named_with_its_remedies() {
        let pair = Pair::new(0, 1);
        let lead = ConflictKind::BelowLower {
            channels: [Channel::Input(1), Channel::Output(0)],
            asked: -0.25,
            lower: Some(-0.125),
        };
        let conflict = Conflict {
            bounds: Bounds {
                lower: -0.095_6,
                upper: 0.1,
            },
            ..conflict(Quantity::SignedDelay, &[pair], lead)
        };
        let miss = Unmatched {
            quantity: Quantity::SignedDelay,
            pair,
            delta: -0.25,
            target: -0.191_2,
            excess: 0.058_8,
            why: conflict.clone(),
        };
        let words = miss_text(&miss, 12.0, &inputs(), &outputs()) + &text(&conflict);
        for part in [
            "of lead that it needs",
            "R_max limits",
            "191.2 ms of lead together",
            "increase R_max or reduce n",
        ] {
            assert!(words.contains(part), "{words}");
        }
    }

    #[test]
    fn every_remedy_is_listed() {
        let remedy = Remedy {
            quantity: GAIN,
            upper: Some(1.75),
            lower: Some(0.56),
            free: vec![Pair::new(2, 2), Pair::new(4, 2)],
        };
        assert_eq!(
            remedy_text(&remedy, &inputs(), &outputs()),
            "Any one of these changes allows all responses to be held: an upper bound of 1.75; a lower bound of 0.56; releasing PED → R; \
             releasing PED → NY."
        );
    }
}
