//! Sentences about constrained responses that miss their targets, the conflicts that cause this, and
//! the remedies. The facts are in [`Unmatched`], [`ConflictKind`] and [`Remedy`].

use gdcm_method::correction::channels::{pair_name, pair_names};
use gdcm_method::correction::conflict::{Conflict, ConflictKind};
use gdcm_method::correction::remedy::Remedy;
use gdcm_method::correction::solution::Unmatched;
use gdcm_method::correction::{Channel, Quantity};
use gdcm_model::units::{s_to_ms, telling, told_apart};

/// Describes the conflict and its possible resolutions, with the given channel names.
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

/// Describes the deviation of a constrained response; for a delay including the phase error that
/// remains at `omega_top` \[rad/s\], the upper end of the band.
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
    let (target, delta) = told_apart(miss.target, miss.delta, 3);
    let sign = if miss.excess > 0.0 { "+" } else { "" };
    let excess = telling(miss.excess, 1);
    format!("{pair} is held at {target} instead of {delta} ({sign}{excess} dB).")
}

fn lead_miss_text(miss: &Unmatched, pair: &str, omega_top: f64) -> String {
    let (target, delta) = told_apart(s_to_ms(-miss.target), s_to_ms(-miss.delta), 1);
    let left = telling(miss.phase_left_deg(omega_top).abs(), 0);
    format!(
        "{pair} gets {target} of the {delta} ms of lead that it needs; a phase error of \
        {left}° remains at {omega_top} rad/s."
    )
}

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
    let left = telling(miss.phase_left_deg(omega_top).abs(), 0);
    format!("{why}; a phase error of {left}° remains at {omega_top} rad/s.")
}

/// Returns the name of the values that are compared around a loop.
fn loop_values(quantity: Quantity) -> &'static str {
    if quantity.is_gain() {
        "ratios"
    } else {
        "delays"
    }
}

/// Formats the deviation of a loop, which is in dB or in seconds; seconds are displayed in ms.
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
    /// Remedies for insufficient lead other than a change of the bounds.
    const MORE_LEAD: &'static str = "increase R_max or reduce n";

    /// Composes the sentence "ENTRIES cannot be held: LIMIT; CHANGE or RELEASE." LIMIT is the limit
    /// of the bounds that the entries exceed, CHANGE a change of the bounds that is sufficient.
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
                    "{entries} needs {} ms of lead, which a delay cannot provide; {release}.",
                    milliseconds(-asked)
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
    /// ends with a sufficient change of the bounds and "or".
    fn maximum_and_change(&self, channels: [Channel; 2], asked: f64, upper: f64) -> String {
        let [first, second] = channels.map(|channel| self.symbol(channel));
        let bound = self.conflict.bounds.upper;
        if self.conflict.quantity.is_gain() {
            let (most, asked) = told_apart(bound.powi(2), asked, 3);
            return format!(
                "with gains <= {bound:.3} the product {first} {second} is at most {most}, but \
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
    /// ends with a sufficient change of the bounds, if there is one, and "or".
    fn minimum_and_change(&self, channels: [Channel; 2], asked: f64, lower: Option<f64>) -> String {
        let [first, second] = channels.map(|channel| self.symbol(channel));
        let bound = self.conflict.bounds.lower;
        match self.conflict.quantity {
            Quantity::Gain(_) => {
                let (least, asked) = told_apart(bound.powi(2), asked, 3);
                let lower = lower.unwrap_or(bound);
                format!(
                    "with gains >= {bound:.3} the product {first} {second} is at least {least}, \
                    but {asked} is required; set the lower bound to {lower} or"
                )
            }
            Quantity::Delay => format!(
                "{first} and {second} together would have to give {} ms of lead, which a delay \
                cannot provide;",
                milliseconds(-asked)
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

    /// Describes a ratio of gains above the ratio of the bounds, without a change.
    fn ratio_limit(&self, greater: Channel, lesser: Channel, asked: f64) -> String {
        let greater = self.symbol(greater);
        let lesser = self.symbol(lesser);
        let low = self.conflict.bounds.lower;
        let high = self.conflict.bounds.upper;
        let (most, asked) = told_apart(high / low, asked, 3);
        format!(
            "with {greater} <= {high:.3} and {lesser} >= {low:.3} their ratio is at most {most}, \
            but {asked} is required"
        )
    }

    /// Describes a difference of delays above the difference of the bounds; ends with a sufficient
    /// change of the bounds and "or".
    fn difference_limit_and_change(
        &self,
        greater: Channel,
        lesser: Channel,
        asked: f64,
        upper: f64,
    ) -> String {
        let greater = self.symbol(greater);
        let lesser = self.symbol(lesser);
        let low = self.conflict.bounds.lower;
        let high = self.conflict.bounds.upper;
        if self.conflict.quantity == Quantity::SignedDelay {
            let (most, asked) = limit_and_asked_ms(high - low, asked);
            return format!(
                "{greater} cannot exceed {lesser} by {asked} ms: with at most {} ms of lead and \
                {} ms of delay in each channel, the difference is at most {most} ms; set the \
                upper bound to {upper} s, {}, or",
                milliseconds(-low),
                milliseconds(high),
                Self::MORE_LEAD
            );
        }
        let (most, asked) = limit_and_asked_ms(high, asked);
        format!(
            "{greater} cannot exceed {lesser} by {asked} ms with delays <= {most} ms; set the \
            upper bound to {upper} s or"
        )
    }

    /// Returns the symbol of a channel's value: "k_LON", "tau_P".
    fn symbol(&self, channel: Channel) -> String {
        let symbol = if self.conflict.quantity.is_gain() {
            "k"
        } else {
            "tau"
        };
        format!("{symbol}_{}", channel.name(self.inputs, self.outputs))
    }
}
